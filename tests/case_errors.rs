//! Every mistake in a case file ends with exit code 2 and one message that names file, line, key
//! and what is allowed.

mod common;

use std::collections::BTreeSet;
use std::path::Path;

use common::{asperity, stderr};

/// File in `fixtures/cases/bad`, line, key, what is wrong, what is allowed (a part of each).
#[rustfmt::skip]
const MISTAKES: &[(&str, usize, &str, &str, &str)] = &[
    ("duplicate-key", 7, "", "not valid TOML: duplicate key", ""),
    ("flat-on-plane", 4, "sphere.flat", "a flat is pressed by a sphere alone", "[opponent] and its radius, rigid = true or a material"),
    ("friction-negative", 14, "contact.friction", "is -0.1", "a number >= 0, or \"stick\""),
    ("friction-word", 14, "contact.friction", "is \"glue\"", "a number >= 0, or \"stick\""),
    ("hollomon-coefficient", 11, "material.hardening.coefficient", "puts the yield stress", "< 0.2 E"),
    ("hollomon-exponent", 12, "material.hardening.exponent", "is 1.0", "m > 1"),
    ("indentation-negative", 20, "path.1.indentation", "is -0.01", "a length >= 0"),
    ("indentation-too-deep", 17, "path.0.indentation", "is 0.3", "< 0.3 radius = 0.3"),
    ("indentation-zero", 17, "path.0.indentation", "is 0.0", "a length > 0"),
    ("infinite", 6, "material.youngs_modulus", "is inf", "a stress > 0"),
    ("linear-softening", 12, "material.hardening.modulus", "is -10.0", "a stress >= 0 (no softening)"),
    ("mesh-contact-radius", 17, "mesh.contact_radius", "is 1.0", "a length from 0.0005 to 0.65 radius"),
    ("mesh-elements", 17, "mesh.elements_per_contact_radius", "is 3", "a whole number from 4 to 32"),
    ("mesh-fine-zone", 17, "mesh.fine_zone", "is 1.0", "a number from 1.1 to 3"),
    ("mesh-memory", 17, "solver.max_memory_gib", "a mesh of about", "a larger solver.max_memory_gib"),
    ("missing-key", 2, "sphere.radius", "missing", "a length > 0"),
    ("missing-law", 9, "material.hardening.law", "missing", "\"elastic\", \"ideal\""),
    ("missing-table", 1, "contact", "missing", "a table with friction"),
    ("nan", 14, "contact.friction", "is NaN", "a number >= 0, or \"stick\""),
    ("opponent-both", 16, "opponent", "is both equal and rigid", "one of equal = true and rigid = true"),
    ("opponent-deforming-small", 18, "opponent.radius", "is 0.05", "a length from 0.1 to 10.0, 0.1 to 10 sphere.radius"),
    ("opponent-equal-radius", 18, "opponent.radius", "stands beside equal = true", "equal = true alone"),
    ("opponent-flat-radius", 17, "opponent.flat", "is true beside a radius", "one of flat = true and radius"),
    ("opponent-radius-small", 18, "opponent.radius", "is 0.01", "at least 0.05 sphere.radius = 0.05"),
    ("opponent-rigid-material", 18, "opponent.material", "stands beside rigid = true", "no material, or no rigid"),
    ("opponent-stiff", 17, "opponent.material.youngs_modulus", "is 1000000000000.0", "1e-6 to 1e6 times material.youngs_modulus"),
    ("opponent-too-deep", 21, "path.0.indentation", "is 0.02", "< 0.3 effective radius = 0.01698"),
    ("opponent-yield-stress", 17, "opponent.material.hardening.yield_stress", "is -1.0", "a stress > 0"),
    ("output-fields", 17, "output.fields", "is \"some\"", "\"none\", \"contact\", \"segments\", \"all\""),
    ("output-plots", 17, "output.plots", "is the string \"yes\", which is the wrong type", "true or false"),
    ("overflow", 6, "material.youngs_modulus", "is inf", "a stress > 0"),
    (
        "path-direction-alone",
        20,
        "path.1.shear_direction",
        "stands without shear",
        "shear_direction beside shear in the same [[path]]",
    ),
    ("path-direction-far", 21, "path.1.shear_direction", "is 400.0", "degrees from x towards y, -360 to 360"),
    (
        "path-direction-vector",
        21,
        "path.1.shear_direction",
        "stands beside a shear that has both components",
        "shear as a length, or as [x, y] alone",
    ),
    ("path-empty", 2, "path", "is empty", "at least one [[path]] segment"),
    ("path-hold-alone", 18, "path.0.hold", "stands without shear", "hold beside shear"),
    ("path-hold-word", 21, "path.1.hold", "is \"force\"", "\"indentation\", \"normal-force\""),
    ("path-missing", 1, "path", "missing", "at least one [[path]] segment"),
    ("path-neither", 19, "path.1", "has neither indentation nor shear nor release", "one of release and targets of the plate"),
    ("path-oblique-full-slip", 18, "path.0.shear", "is a word beside indentation", "a length"),
    ("path-oblique-hold", 19, "path.0.hold", "stands beside indentation and shear", "no hold"),
    ("path-oblique-release", 18, "path.0.release", "stands beside another target", "one of release and targets of the plate"),
    ("path-oblique-standstill", 18, "path.0.shear", "is where the segment begins", "or no shear here"),
    ("path-release-false", 20, "path.1.release", "is false", "release = true"),
    ("path-release-first", 17, "path.0.release", "releases what is not in contact", "release after a segment that presses"),
    ("path-release-share", 20, "path.1.release", "is 1.0", "the share of F_N that is left, between 0 and 1"),
    ("path-roll-far", 20, "path.1.roll", "is 0.6", "an angle in rad about y, or two of them: [about_x, about_y], -0.5 to 0.5"),
    ("path-roll-flat", 24, "path.1", "rolls a flat, which has nothing to roll on", "no roll in this [[path]], or a sphere"),
    ("path-roll-pair-far", 20, "path.1.roll.1", "is -0.6", "[about_x, about_y], -0.5 to 0.5"),
    ("path-roll-stick", 19, "path.1", "rolls under full stick", "a number for contact.friction, or no roll"),
    ("path-roll-three", 20, "path.1.roll", "has 3 components", "[about_x, about_y], -0.5 to 0.5"),
    ("path-shear-after-release", 23, "path.2.shear", "shears what is not in contact", "shear after a segment with an indentation > 0"),
    ("path-shear-first", 19, "path.0.shear", "shears what is not in contact", "shear after a segment with an indentation > 0"),
    ("path-shear-one", 20, "path.1.shear", "has 1 component.", "a length, or two of them: [x, y]"),
    ("path-shear-unknown-y", 24, "path.2.shear", "has no y, which only the simulation knows here", "shear = [x, y]"),
    ("path-shear-vector-far", 20, "path.1.shear.1", "is 0.5", "a length between -0.5 and 0.5 (0.5 radius)"),
    ("path-standstill", 20, "path.1.indentation", "is 0.02, where the segment begins", "other than the current one"),
    ("path-twist-far", 20, "path.1.twist", "is 200.0", "an angle in rad, -100 to 100"),
    (
        "path-twist-first",
        16,
        "path.0",
        "moves along the surface what is not in contact",
        "a segment with an indentation > 0 before",
    ),
    (
        "path-twist-full-slip",
        21,
        "path.1.twist",
        "stands beside shear = \"full-slip\"",
        "a displacement in place of \"full-slip\"",
    ),
    ("path-twist-hold", 22, "path.1.hold", "stands beside indentation, which moves", "no hold in this [[path]]"),
    ("path-twist-release", 20, "path.1.release", "stands beside another target", "one of release and targets of the plate"),
    (
        "path-twist-standstill",
        19,
        "path.1",
        "ends where it begins",
        "a target other than the current one for shear, twist or roll",
    ),
    (
        "path-twist-word",
        20,
        "path.1.twist",
        "is the string \"full-slip\", which is the wrong type",
        "an angle in rad, -100 to 100",
    ),
    ("poissons-ratio-high", 7, "material.poissons_ratio", "is 0.5", "a number > -1 and < 0.5"),
    ("poissons-ratio-low", 7, "material.poissons_ratio", "is -1.0", "a number > -1 and < 0.5"),
    ("power-coefficient", 12, "material.hardening.coefficient", "is -1.0", "a stress >= 0 (no softening)"),
    ("power-exponent", 13, "material.hardening.exponent", "is 1.5", "n in (0, 1]"),
    ("radius", 3, "sphere.radius", "is 0.0", "a length > 0"),
    ("shear-too-far", 20, "path.1.shear", "is -0.5", "a length between -0.5 and 0.5"),
    ("shear-word", 20, "path.1.shear", "is \"full-stick\"", "\"full-slip\""),
    ("solver-cutbacks", 17, "solver.max_cutbacks", "is -1", "a whole number from 0 to 30"),
    ("solver-linear", 17, "solver.linear", "is \"multgrid\"", "\"multigrid\", \"direct\""),
    ("solver-steps", 17, "solver.press_steps", "is 0", "a whole number from 1 to 100000"),
    ("solver-tolerance", 17, "solver.tolerance", "is 0.1", "a number > 1e-12 and <= 1e-2"),
    ("stick-full-slip", 20, "path.1.shear", "never reaches", "a displacement, or a number for contact.friction"),
    ("syntax", 10, "", "not valid TOML", ""),
    ("table-empty", 11, "material.hardening.points", "has no points", "[[alpha, stress], ...]"),
    ("table-no-start", 9, "material.hardening.yield_stress", "missing", "or a first point at alpha = 0"),
    ("table-order", 14, "material.hardening.points.2.0", "is 0.1", "alpha > 0.1, strictly increasing"),
    ("table-row", 13, "material.hardening.points.1", "has 3 numbers", "[[alpha, stress], ...]"),
    ("table-softening", 13, "material.hardening.points.1.1", "is 390.0", "a stress >= 400.0 (no softening)"),
    ("table-stress", 11, "material.hardening.points.0.1", "is 0.0", "a stress > 0"),
    ("table-two-starts", 11, "material.hardening.yield_stress", "is 350.0", "the stress 400.0 of the point at alpha = 0"),
    ("unknown-key", 11, "material.hardening.yield_stres", "did you mean `yield_stress`?", "law, yield_stress"),
    (
        "unknown-key-in-path",
        21,
        "path.1.holds",
        "did you mean `hold`?",
        "indentation, shear, shear_direction, twist, roll, hold, release",
    ),
    ("unknown-key-of-law", 12, "material.hardening.modulus", "unknown key", "law, yield_stress"),
    ("unknown-law", 10, "material.hardening.law", "is \"swift\"", "\"elastic\", \"ideal\", \"linear\", \"power\", \"hollomon\", \"voce\", \"table\""),
    ("unknown-table", 13, "contacts", "did you mean `contact`?", "sphere, material, contact"),
    ("voce-rate", 13, "material.hardening.rate", "is 0.0", "a number > 0"),
    ("voce-softening", 12, "material.hardening.saturation_stress", "is 300.0", "a stress >= yield_stress = 400.0"),
    ("wrong-type-count", 17, "mesh.elements_per_contact_radius", "is the number 16.5, which is the wrong type", "a whole number from 4 to 32"),
    ("wrong-type-number", 6, "material.youngs_modulus", "is the string \"200e3\", which is the wrong type", "a stress > 0"),
    ("wrong-type-table", 2, "sphere", "is the number 1.0, which is the wrong type", "a table"),
    ("yield-strain", 11, "material.hardening.yield_stress", "is 40000.0", "< 0.2 E = 40000.0"),
    ("yield-stress", 11, "material.hardening.yield_stress", "is 0.0", "a stress > 0"),
    ("youngs-modulus", 6, "material.youngs_modulus", "is -200000.0", "a stress > 0"),
];

#[test]
fn each_mistake_is_named_with_its_place_and_remedy() {
    for (name, line, key, what, allowed) in MISTAKES {
        let file = format!("fixtures/cases/bad/{name}.toml");
        let output = asperity(&["check", &file]);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{file}: {message}");
        assert!(output.stdout.is_empty(), "{file}: a case was printed");
        let place = if key.is_empty() { format!("error: {file}:{line}: ") } else { format!("error: {file}:{line}: {key}: ") };
        assert!(message.starts_with(&place), "{file}: expected {place:?} in front of {message}");
        let (wrong, remedy) = message.split_once(" Allowed: ").unwrap_or((&message, ""));
        assert!(wrong.contains(what), "{file}: expected {what:?} in {message}");
        assert!(remedy.contains(allowed), "{file}: expected {allowed:?} after `Allowed:` in {message}");
        // One mistake, and below it the line with a caret, except where a table is missing as a
        // whole.
        assert_eq!(message.matches("error: ").count(), 1, "{file}: {message}");
        assert_eq!(message.contains('^'), *line > 1, "{file}: {message}");
    }
}

#[test]
fn every_mistake_of_a_file_is_told_with_its_line_and_a_caret() {
    let scratch = tempfile::tempdir().expect("a scratch directory");
    let good = std::fs::read_to_string("fixtures/cases/ideal.toml").expect("a case");
    let bad = good.replace("poissons_ratio = 0.3", "poissons_ratio = 0.5").replace("yield_stress", "yield_stres");
    let bad = bad.replace("friction = 0.3", "friction = \"glue\"");
    let file = scratch.path().join("bad.toml");
    std::fs::write(&file, bad).expect("a case");
    let name = file.to_string_lossy();
    let message = stderr(&asperity(&["check", &name]));
    let expected = format!(
        "\
error: {name}:7: material.poissons_ratio: is 0.5. Allowed: a number > -1 and < 0.5
 --> {name}:7:18
  |
7 | poissons_ratio = 0.5
  |                  ^^^

error: {name}:11: material.hardening.yield_stres: unknown key, did you mean `yield_stress`? Allowed: law, yield_stress
  --> {name}:11:1
   |
11 | yield_stres = 400.0
   | ^^^^^^^^^^^

error: {name}:14: contact.friction: is \"glue\". Allowed: a number >= 0, or \"stick\"
  --> {name}:14:12
   |
14 | friction = \"glue\"
   |            ^^^^^^

3 mistakes; `asperity explain KEY` says more about a key
"
    );
    assert_eq!(message, expected);
}

#[test]
fn every_bad_fixture_is_tried() {
    let listed: BTreeSet<String> = MISTAKES.iter().map(|mistake| format!("{}.toml", mistake.0)).collect();
    let files = std::fs::read_dir("fixtures/cases/bad").expect("the fixtures");
    let present = files.map(|file| file.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    assert_eq!(listed, present);
}

#[test]
fn run_refuses_what_check_refuses_and_makes_no_directory() {
    let scratch = tempfile::tempdir().expect("a scratch directory");
    let out = scratch.path().join("out");
    let output = asperity(&["run", "fixtures/cases/bad/nan.toml", "--out", &out.to_string_lossy()]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).starts_with("error: fixtures/cases/bad/nan.toml:"), "{}", stderr(&output));
    assert!(!out.exists());
}

#[test]
fn a_value_from_the_command_line_is_named_as_such() {
    for (argument, place, what) in [
        ("contact.friction=-1", "--set contact.friction: ", "is -1.0. Allowed: a number >= 0"),
        ("contact.friction=glue", "--set contact.friction: ", "is \"glue\""),
        ("contact.friction=stik", "--set contact.friction: ", "is \"stik\" (did you mean \"stick\"?). Allowed"),
        ("contact.friction=0,3", "--set contact.friction: ", "did you mean 0.3? A number has a decimal point, no comma"),
        ("sphere.radius=0,5", "--set sphere.radius: ", "Did you mean 0.5? A number has a decimal point, no comma"),
        ("sphere.radius=.5", "--set sphere.radius: ", "Did you mean 0.5?"),
        ("path=[{indentation=0,01}]", "--set path=[{indentation=0,01}]: ", "did you mean 0.01?"),
        ("friction=0.1", "--set friction: ", "unknown key, did you mean `contact.friction`?"),
        ("frictoin=0.1", "--set frictoin: ", "unknown key, did you mean `contact.friction`?"),
        ("indentation=0.1", "--set indentation: ", "unknown key, did you mean `path.0.indentation`?"),
        ("shear=0.1", "--set shear: ", "unknown key, did you mean `path.1.shear`?"),
        ("hardening.yield_stress=300", "--set hardening.yield_stress: hardening: ", "did you mean `material.hardening`?"),
        ("material.yield_stress=300", "--set material.yield_stress: ", "did you mean `material.hardening.yield_stress`?"),
        ("material.hardening.law=idela", "--set material.hardening.law: ", "(did you mean \"ideal\"?)"),
        ("path.1.shear=full_slip", "--set path.1.shear: ", "(did you mean \"full-slip\"?)"),
        ("path.1.hold=normal_force", "--set path.1.hold: ", "(did you mean \"normal-force\"?)"),
        ("output.fields=segment", "--set output.fields: ", "(did you mean \"segments\"?)"),
        ("output.plot_format=PNG", "--set output.plot_format: ", "(did you mean \"png\"?)"),
        ("output.plots=False", "--set output.plots: ", "Did you mean false?"),
        ("path.2.release=True", "--set path.2.release: ", "(did you mean \"true\"?)"),
        ("solver.press_steps=5.5", "--set solver.press_steps: ", "is the number 5.5, which is the wrong type"),
        ("solver.press_steps=-5.0", "--set solver.press_steps: ", "is -5.0. Allowed: a whole number from 1"),
        ("solver.press_steps=1e300", "--set solver.press_steps: ", "is 1e300. Allowed: a whole number from 1"),
        ("solver.linear=multgrid", "--set solver.linear: ", "is \"multgrid\" (did you mean \"multigrid\"?). Allowed"),
        ("path.0.indentation=0.4", "--set path.0.indentation: ", "is 0.4"),
        ("mesh.elements=8", "--set mesh.elements: ", "unknown key, did you mean `elements_per_contact_radius`?"),
        ("path.2={shear=1.0}", "--set path.2: path.2.shear: ", "is 1.0"),
        ("path.7.indentation=0.1", "--set path.7.indentation=0.1: ", "`path` has 2 items"),
        ("sphere.radius.value=1", "--set sphere.radius.value=1: ", "`sphere.radius` is the number 1.0"),
        ("sphere..radius=1", "--set sphere..radius=1: ", "the key has an empty part"),
        ("sphere.radius", "--set sphere.radius: ", "has no `=`"),
        ("sphere.radius=", "--set sphere.radius=: ", "has no value"),
        ("path=[{indentation=0.1}", "--set path=[{indentation=0.1}: ", "the value is not valid TOML"),
    ] {
        let output = asperity(&["check", "fixtures/cases/ideal.toml", "--set", argument]);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{argument}: {message}");
        assert!(message.starts_with(&format!("error: {place}")), "{argument}: expected {place:?} in front of {message}");
        assert!(message.contains(what), "{argument}: expected {what:?} in {message}");
    }
}

#[test]
fn a_mistake_of_the_file_keeps_its_line_beside_a_set_value() {
    let arguments = ["check", "fixtures/cases/bad/poissons-ratio-high.toml", "--set", "path.0.indentation=0.01"];
    assert!(
        stderr(&asperity(&arguments))
            .starts_with("error: fixtures/cases/bad/poissons-ratio-high.toml:7: material.poissons_ratio: ")
    );
    // And the value from the command line mends the file.
    let mended = ["check", "fixtures/cases/bad/poissons-ratio-high.toml", "--set", "material.poissons_ratio=0.25"];
    let output = asperity(&mended);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(String::from_utf8_lossy(&output.stdout).contains("poissons_ratio = 0.25"));
}

#[test]
fn a_file_that_cannot_be_read_is_named() {
    let scratch = tempfile::tempdir().expect("a scratch directory");
    let binary = scratch.path().join("binary.toml");
    std::fs::write(&binary, [0xff, 0xfe, 0x00]).expect("a file");
    for file in [Path::new("no/such/case.toml"), scratch.path(), &binary] {
        let output = asperity(&["check", &file.to_string_lossy()]);
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).starts_with(&format!("error: {}: cannot be read: ", file.display())), "{}", stderr(&output));
    }
}

/// The case of the tests as text.
fn good() -> String {
    std::fs::read_to_string("fixtures/cases/ideal.toml").expect("a case")
}

/// The same as the base of a study.
fn study() -> String {
    let base = good().replace("\n[", "\n[base.").replace("[base.[path]]", "[[base.path]]");
    format!("{base}\n[grid]\n\"contact.friction\" = [0.1, 0.3]\n")
}

/// Runs a command of the program on a file with these bytes: its exit code and what it said,
/// without the name of the file.
fn said(command: &[&str], bytes: &[u8]) -> (Option<i32>, String) {
    let scratch = tempfile::tempdir().expect("a scratch directory");
    let file = scratch.path().join("a b.toml");
    std::fs::write(&file, bytes).expect("a file");
    let output = common::program().args(command).arg(&file).output().expect("it runs");
    (output.status.code(), stderr(&output).replace(&*file.to_string_lossy(), "FILE"))
}

#[test]
fn whole_numbers_may_be_written_with_a_point() {
    let whole = asperity(&["check", "fixtures/cases/ideal.toml", "--set", "solver.press_steps=5"]);
    for argument in ["solver.press_steps=5.0", "solver.press_steps=0.5e1"] {
        let output = asperity(&["check", "fixtures/cases/ideal.toml", "--set", argument]);
        assert_eq!(output.status.code(), Some(0), "{argument}: {}", stderr(&output));
        assert_eq!(output.stdout, whole.stdout, "{argument}");
    }
    let text = format!("{}[mesh]\nelements_per_contact_radius = 8.0\n", good());
    assert_eq!(said(&["check"], text.as_bytes()).0, Some(0));
    let text = study() + "\"mesh.elements_per_contact_radius\" = [8.0, 9]\n";
    assert_eq!(said(&["check"], text.as_bytes()), (Some(0), String::new()));
}

#[test]
fn a_decimal_comma_and_a_typographic_quote_are_told_as_such() {
    for (there, here, parts) in [
        (
            "friction = 0.3",
            "friction = 0,3",
            &["FILE:14: not valid TOML", "did you mean 0.3? A number has a decimal point, no comma"][..],
        ),
        ("radius = 1.0", "radius = 1.000,5", &["FILE:3: not valid TOML", "did you mean 1000.5?"]),
        ("friction = 0.3", "friction = .3", &["FILE:14: not valid TOML", "did you mean 0.3?"]),
        ("friction = 0.3", "friction = \u{201c}stick\u{201d}", &["FILE:14: not valid TOML", "a quote is \""]),
        ("friction = 0.3", "friction = \"0,3\"", &["contact.friction: is \"0,3\"", "did you mean 0.3?"]),
    ] {
        // A material alone is not asked for its friction, and the study's grid has another.
        let quoted = here.contains("\"0,3\"");
        for (command, text) in
            [("check", good()), ("point", good()), ("check", study())].into_iter().take(if quoted { 1 } else { 3 })
        {
            let text = text.replacen(there, here, 1);
            let (code, message) = said(&[command], text.as_bytes());
            assert_eq!(code, Some(2), "{message}");
            assert!(parts.iter().all(|part| message.contains(part)), "{command} {here}: {message}");
        }
    }
}

#[test]
fn an_encoding_is_told_with_how_to_convert_it_and_a_mark_is_harmless() {
    let wide = |text: &str, bytes: fn(u16) -> [u8; 2]| text.encode_utf16().flat_map(bytes).collect::<Vec<u8>>();
    for (command, text) in [("check", good()), ("check", study()), ("point", good())] {
        let latin: Vec<u8> =
            format!("# K\u{f6}rper\n{text}").chars().map(|c| u8::try_from(u32::from(c)).expect("Latin-1")).collect();
        for (bytes, name, from) in [
            (wide(&format!("\u{feff}{text}"), u16::to_le_bytes), "UTF-16", "UTF-16"),
            (wide(&format!("\u{feff}{text}"), u16::to_be_bytes), "UTF-16", "UTF-16"),
            (wide(&text, u16::to_le_bytes), "UTF-16", "UTF-16LE"),
            (wide(&text, u16::to_be_bytes), "UTF-16", "UTF-16BE"),
            (latin, "Latin-1", "ISO-8859-1"),
        ] {
            let (code, message) = said(&[command], &bytes);
            assert_eq!(code, Some(2), "{message}");
            assert!(message.starts_with("error: FILE: cannot be read: it is not text in UTF-8"), "{message}");
            let advice = format!("it looks like {name}");
            let convert = format!("`iconv -f {from} -t UTF-8 'FILE' > ");
            assert!(message.contains(&advice) && message.contains(&convert), "{message}");
            assert!(!message.contains("Give the path"), "{message}");
        }
        let marked = format!("\u{feff}{text}");
        assert_eq!(said(&[command], marked.as_bytes()), said(&[command], text.as_bytes()));
        // Carets are below what is wrong.
        let wrong = |text: &str| said(&[command], text.replacen("poissons_ratio = 0.3", "poissons_ratio = 0.5", 1).as_bytes());
        assert_eq!(wrong(&marked), wrong(&text));
        assert_eq!(wrong(&text).0, Some(2));
    }
}

#[test]
fn a_key_in_a_wrong_table_is_told_by_its_whole_name() {
    for (text, part) in [
        (
            format!("friction = 0.3\n{}", good().replace("friction = 0.3\n", "")),
            "friction: unknown key, did you mean `contact.friction`?",
        ),
        (
            good().replace("poissons_ratio = 0.3", "yield_stress = 300.0\npoissons_ratio = 0.3"),
            "did you mean `material.hardening.yield_stress`?",
        ),
        (good().replace("[material.hardening]", "[hardening]"), "hardening: unknown key, did you mean `material.hardening`?"),
        (study().replace("[base.contact]", "[contact]"), "contact: unknown key, did you mean `base.contact`?"),
        (study().replace("\"contact.friction\"", "friction"), "friction: unknown key, did you mean `contact.friction`?"),
    ] {
        let (code, message) = said(&["check"], text.as_bytes());
        assert_eq!(code, Some(2), "{message}");
        assert!(message.contains(part) && message.matches("error: ").count() == 1, "{part}: {message}");
    }
    // What is set for a material alone is set.
    let arguments = ["point", "fixtures/cases/ideal.toml", "--set", "yield_stress=300"];
    let output = asperity(&arguments);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("unknown key, did you mean `material.hardening.yield_stress`?"), "{}", stderr(&output));
}

#[test]
fn a_misspelt_law_that_comes_with_the_program_is_told() {
    for (arguments, meant) in [
        (&["law", "predict", "bult-in", "fixtures/cases/voce.toml"][..], "built-in"),
        (&["law", "export", "builtin", "fixtures/cases/voce.toml", "--format", "c"], "built-in"),
        (&["law", "check", "built_in"], "built-in"),
        (&["law", "fit", "fixtures", "--prior", "waer-2014"], "wear-2014"),
    ] {
        let output = asperity(arguments);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(&format!("there is no such file, did you mean `{meant}`?")), "{arguments:?}: {message}");
    }
}
