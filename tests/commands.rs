//! The commands around a run: init, explain, schema, check, compare, completions, man; JSON and
//! standard input.

mod common;

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Output, Stdio};

use asperity::case::Case;
use asperity::case::keys::{KEYS, LAWS};
use common::{Scratch, asperity, program, stderr, stdout};
use serde_json::Value;

/// Coarse and short, as options.
const QUICK: [&str; 14] = [
    "--set",
    "mesh.elements_per_contact_radius=4",
    "--set",
    "solver.press_steps=4",
    "--set",
    "solver.shear_steps=3",
    "--set",
    "solver.error_estimate=false",
    "--set",
    "path.1.shear=0.001",
    "--set",
    "output.plots=false",
    "--device",
    "cpu",
];

fn json(output: &Output) -> Value {
    assert_eq!(output.status.code(), Some(0), "{}", stderr(output));
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {}", stdout(output)))
}

fn refused(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(2), "{}", stderr(output));
    let message = stderr(output);
    // Below a mistake of a file stands its line.
    let lines = message.lines().count();
    assert!(message.starts_with("error: ") && (lines == 1 || message.contains('^')), "{message}");
    message
}

/// With text on standard input.
fn piped(arguments: &[&str], text: &str) -> Output {
    let mut child = program()
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program runs");
    // One that refuses its arguments closes the pipe.
    let _ = child.stdin.take().expect("a pipe").write_all(text.as_bytes());
    child.wait_with_output().expect("it ends")
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a path in UTF-8")
}

#[test]
fn init_writes_a_case_of_every_law_that_is_taken_and_one_runs() {
    let scratch = Scratch::new("", &[]);
    for law in LAWS {
        let file = scratch.path(format!("{law}.toml"));
        let output = asperity(&["init", text(&file), "--material", law]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        assert!(stdout(&output).contains("asperity run"), "{}", stdout(&output));
        let printed = stdout(&asperity(&["check", text(&file)]));
        assert!(printed.contains(&format!("law = {law:?}")), "{printed}");
    }
    let (voce, out) = (scratch.path("voce.toml"), scratch.path("out"));
    let run = [&["run", text(&voce), "--out", text(&out), "-q"][..], &QUICK].concat();
    let output = asperity(&run);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}

#[test]
fn a_short_case_has_twenty_lines_at_most_and_its_results_the_name_of_its_file() {
    let scratch = Scratch::new("", &[]);
    let here = |arguments: &[&str]| program().args(arguments).current_dir(scratch.dir.path()).output().expect("the program runs");
    for law in LAWS {
        let output = here(&["init", "--short", "--material", law, law]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let short = fs::read_to_string(scratch.path(format!("{law}.toml"))).expect("a case");
        assert!(short.lines().count() <= 20, "{short}");
        // It is the long one less its comments.
        let long = stdout(&here(&["init", "--material", law, "-"]));
        let [short, long] = [short, long].map(|text| Case::parse(&text, "a case", &[]).expect("a case"));
        assert_eq!(short, long);
    }
    let run = [&["run", "ideal.toml", "-q"][..], &QUICK].concat();
    let output = here(&run);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(scratch.path("ideal/history.csv").exists());
    // Nothing is replaced by that name either.
    assert!(refused(&here(&run)).contains("--force"));
    assert!(stderr(&here(&["run", "-"])).contains("--out"));
    assert!(stderr(&here(&["study", "--merge", "ideal"])).contains("--out"));
}

#[test]
fn a_law_predicts_a_contact_that_is_given_by_options() {
    let scratch = Scratch::new("", &[]);
    let case = |opponent: &str| {
        format!(
            "[sphere]\nradius = 1.0\n[material]\nyoungs_modulus = 70e3\npoissons_ratio = 0.34\n[material.hardening]\n\
             law = \"ideal\"\nyield_stress = 95.0\n[contact]\nfriction = 0.45\n{opponent}[[path]]\nindentation = 0.013\n\
             [[path]]\nshear = \"full-slip\"\n"
        )
    };
    let options = ["--E", "70e3", "--nu", "0.34", "--yield", "95", "--mu", "0.45", "--h", "0.013"];
    let predict = |more: &[&str]| asperity(&[&["law", "predict", "built-in"], more].concat());
    for (opponent, more) in [("", &[][..]), ("[opponent]\nequal = true\n", &["--equal"])] {
        fs::write(scratch.path("case.toml"), case(opponent)).expect("a file");
        let [by_file, by_options] =
            [predict(&[text(&scratch.path("case.toml"))]), predict(&[&options[..], more].concat())].map(|output| stdout(&output));
        assert!(by_file.lines().count() > 20 && by_file == by_options, "{by_options}");
    }
    assert!(stderr(&predict(&options[..8])).contains("--h"));
    assert!(stderr(&predict(&[])).contains("CASE.toml"));
    assert!(refused(&predict(&[&options[..9], &["-0.01"]].concat())).contains("--h: is -0.01"));
    let both = predict(&[&[text(&scratch.path("case.toml"))], &options[..]].concat());
    assert!(both.status.code() == Some(2) && stderr(&both).contains("cannot be used"), "{}", stderr(&both));
}

#[test]
fn init_adds_the_ending_and_replaces_nothing_unasked() {
    let scratch = Scratch::new("", &[]);
    let init = |arguments: &[&str]| {
        program().arg("init").args(arguments).current_dir(scratch.dir.path()).output().expect("the program runs")
    };
    assert_eq!(init(&["mine"]).status.code(), Some(0));
    fs::write(scratch.path("mine.toml"), "# mine").expect("a file");
    assert!(refused(&init(&["mine"])).contains("mine.toml: is there already"));
    assert_eq!(fs::read_to_string(scratch.path("mine.toml")).expect("still there"), "# mine");
    assert_eq!(init(&["mine", "--force", "--material", "linear"]).status.code(), Some(0));
    assert!(Case::load(&scratch.path("mine.toml"), &[]).is_ok());
    assert_eq!(init(&["--material", "rubber"]).status.code(), Some(2));
    let printed = stdout(&init(&["-"]));
    assert!(Case::parse(&printed, "printed", &[]).is_ok(), "{printed}");
}

#[test]
fn explain_says_of_every_key_its_range_and_what_it_means() {
    let said = |key: &str| stdout(&asperity(&["explain", key]));
    for key in KEYS {
        let dotted = key.dotted();
        let said = said(&dotted);
        let meaning: Vec<&str> = said.split_whitespace().collect();
        for part in [&dotted, key.range, key.unit] {
            assert!(said.contains(part), "{dotted}: {said}");
        }
        assert!(meaning.join(" ").contains(key.meaning) && said.lines().all(|line| line.len() <= 120), "{said}");
    }
    assert_eq!(said("path.0.shear"), said("path.N.shear"));
    assert!(said("exponent").contains("hollomon") && said("exponent").contains("power"));
    assert!(said("grid").contains("Every combination") && said("base").contains("[base.sphere]"));
    let list = stdout(&asperity(&["explain"]));
    assert!(KEYS.iter().all(|key| list.contains(key.name)), "{list}");
    assert!(refused(&asperity(&["explain", "frictoin"])).contains("did you mean `friction`?"));
}

/// The keys of the file, each with the schema of its value, `None` for a key that the schema lacks.
fn schemas<'s>(schema: &'s Value, file: &toml::Table, at: &str) -> Vec<(String, Option<&'s Value>)> {
    let mut found = Vec::new();
    for (key, value) in file {
        let name = format!("{at}.{key}");
        let own = &schema["properties"][key];
        let laws = schema["oneOf"].as_array().into_iter().flatten();
        let of_law = laws.filter(|one| Some(&one["properties"]["law"]["const"]) == json_of(file.get("law")).as_ref());
        let own = if own.is_null() { of_law.map(|one| &one["properties"][key]).next() } else { Some(own) };
        match (value, own) {
            (toml::Value::Table(table), Some(own)) => found.extend(schemas(own, table, &name)),
            (toml::Value::Array(items), Some(own)) if key == "path" => {
                let segments = items.iter().filter_map(toml::Value::as_table);
                segments.for_each(|segment| found.extend(schemas(&own["items"], segment, &name)));
            }
            (_, own) => found.push((name, own.filter(|own| !own.is_null()))),
        }
    }
    found
}

fn json_of(value: Option<&toml::Value>) -> Option<Value> {
    value.and_then(toml::Value::as_str).map(Value::from)
}

#[test]
fn the_schemas_know_every_key_of_the_fixtures() {
    let schema = json(&asperity(&["schema", "case"]));
    assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
    let mut keys = 0;
    for entry in fs::read_dir("fixtures/cases").expect("the fixtures") {
        let path = entry.expect("an entry").path();
        let Some(file) = fs::read_to_string(&path).ok().filter(|_| path.extension().is_some()) else { continue };
        for (key, found) in schemas(&schema, &file.parse().expect("TOML"), "") {
            assert!(found.is_some_and(|found| found["description"].is_string()), "{}: {key}", path.display());
            keys += 1;
        }
    }
    assert!(keys > 60, "{keys}");
    // What is missing, unknown or of another type is refused by what every validator knows.
    assert_eq!(schema["required"], serde_json::json!(["sphere", "material", "contact", "path"]));
    assert_eq!(schema["additionalProperties"], false);
    assert_eq!(schema["properties"]["mesh"]["properties"]["elements_per_contact_radius"]["maximum"], 32);
    assert_eq!(schema["properties"]["solver"]["properties"]["tolerance"]["default"], 1e-4);
    let study = json(&asperity(&["schema", "study"]));
    assert_eq!(study["required"], serde_json::json!(["base"]));
    for sweep in ["grid", "zip", "list"] {
        assert!(study["properties"][sweep]["description"].is_string() || sweep == "zip", "{sweep}");
        assert!(study["anyOf"].as_array().expect("one of them").contains(&serde_json::json!({ "required": [sweep] })), "{sweep}");
    }
    assert!(study["properties"]["base"]["required"].is_null());
}

#[test]
fn check_tells_the_size_and_gives_json() {
    let printed = stdout(&asperity(&["check", "fixtures/cases/ideal.toml"]));
    let head: Vec<&str> = printed.lines().take(2).collect();
    assert!(
        head[0].starts_with("# about ") && head[0].contains(" elements, ") && head[0].contains(" of processor time"),
        "{printed}"
    );
    assert_eq!(head[1], "# press_steps = 25 and shear_steps = 24");
    let case = json(&asperity(&["check", "fixtures/cases/ideal.toml", "--json"]));
    assert_eq!((&case["kind"], &case["case"]["contact"]["friction"]), (&"case".into(), &0.3.into()));
    let number = |key: &str| case[key].as_f64().expect("a number");
    assert!((10_000.0..25_000.0).contains(&number("estimated_elements")), "{case}");
    assert!((5.0..80.0).contains(&number("estimated_seconds")) && number("estimated_memory_gib") > 0.05, "{case}");
    let study = json(&asperity(&["check", "fixtures/studies/small.toml", "--json"]));
    assert_eq!((&study["kind"], &study["cases"]), (&"study".into(), &27.into()));
    assert_eq!(study["first"]["case"]["output"]["plots"], false);
}

#[test]
fn a_case_comes_from_standard_input_as_well() {
    let scratch = Scratch::new("", &[]);
    let case = fs::read_to_string("fixtures/cases/ideal.toml").expect("a case");
    let study = fs::read_to_string("fixtures/studies/small.toml").expect("a study");
    let checked = piped(&["check", "-"], &case);
    assert_eq!(stdout(&checked), stdout(&asperity(&["check", "fixtures/cases/ideal.toml"])));
    assert!(stdout(&piped(&["check", "-"], &study)).starts_with("# 27 cases: "));
    let out = scratch.path("out");
    let output = piped(&[&["run", "-", "--out", text(&out), "-q"][..], &QUICK].concat(), &case);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(Case::load(&out.join("case.toml"), &[]).is_ok());
    let bad = piped(&["check", "-"], &case.replace("0.3", "-0.3"));
    assert!(refused(&bad).starts_with("error: <stdin>:"), "{}", stderr(&bad));
    let predicted = piped(&["law", "predict", "fixtures/law/law.json", "-"], &case);
    assert!(stdout(&predicted).starts_with("segment,h,delta_T,F_N,F_T\n"), "{}", stderr(&predicted));
}

#[test]
fn a_study_and_a_case_in_each_others_place_name_the_right_command() {
    let scratch = Scratch::new("", &[]);
    let out = scratch.path("out");
    let message = refused(&asperity(&["run", "fixtures/studies/small.toml", "--out", text(&out)]));
    assert!(message.contains("small.toml: is a study") && message.contains("`asperity study fixtures/"), "{message}");
    let message = refused(&asperity(&["study", "fixtures/cases/ideal.toml", "--out", text(&out)]));
    assert!(message.contains("ideal.toml: is a case") && message.contains("`asperity run fixtures/"), "{message}");
    assert!(!out.exists());
}

#[test]
fn runs_are_compared_in_a_table_and_a_picture() {
    let scratch = Scratch::new("", &[]);
    let (one, two, picture) = (scratch.path("one"), scratch.path("two"), scratch.path("both.svg"));
    for (dir, friction) in [(&one, "contact.friction=0.3"), (&two, "contact.friction=0.1")] {
        let run = [&["run", "fixtures/cases/ideal.toml", "--out", text(dir), "-q", "--set", friction][..], &QUICK].concat();
        let output = asperity(&run);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    }
    let dirs = ["compare", text(&one), text(&two), "--out", text(&picture)];
    let output = asperity(&dirs);
    assert_eq!((output.status.code(), stderr(&output).as_str()), (Some(0), ""));
    let table = stdout(&output);
    for line in ["F_N0 ", "F_T_max ", "k_T0 ", "elements "] {
        assert!(table.lines().any(|row| row.starts_with(line)), "{line}: {table}");
    }
    let json = json(&asperity(&[&dirs[..], &["--json"]].concat()));
    let quantity = &json["quantities"]["F_T_max"];
    let value = |run: usize| quantity["value"][run].as_f64().expect("a number");
    let told = quantity["relative_difference"][1].as_f64().expect("a number");
    assert!((told - (value(1) / value(0) - 1.0)).abs() < 1e-12 && value(1) < value(0), "{quantity}");
    assert!(table.contains(&format!("{:+.2} %", 100.0 * told)), "{table}");
    assert_eq!((&json["normalized"], &json["status"][0]), (&false.into(), &"done".into()));
    let svg = fs::read_to_string(&picture).expect("a picture");
    assert!(svg.contains("<svg") && svg.contains(text(&one)) && svg.contains(text(&two)), "{svg}");

    // In other units the numbers without units are the same.
    let scaled = scratch.path("scaled");
    let output = stdout(&asperity(&["check", text(&one.join("case.toml"))])).replace("radius = 1.0", "radius = 2.0");
    let output = output.replace("indentation = 0.02", "indentation = 0.04").replace("shear = 0.001", "shear = 0.002");
    let output = piped(&["run", "-", "--out", text(&scaled), "-q", "--device", "cpu"], &output);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let table = stdout(&asperity(&["compare", text(&one), text(&scaled), "--out", text(&picture)]));
    let row = table.lines().find(|row| row.starts_with("F_N0 ")).expect("a row");
    assert!(table.starts_with("without units") && row.contains("+0.00 %") || row.contains("-0.00 %"), "{table}");

    let message = refused(&asperity(&["compare", text(&one), "fixtures"]));
    assert!(message.contains("fixtures: is not a run"), "{message}");
}

#[test]
fn devices_and_laws_give_json() {
    let devices = json(&asperity(&["devices", "--json"]));
    assert!(devices["adapters"].is_array() && devices["chosen"]["auto"]["device"].is_string(), "{devices}");
    let case = "fixtures/cases/ideal.toml";
    let predicted = json(&asperity(&["law", "predict", "fixtures/law/law.json", case, "--json"]));
    let column = |name: &str| predicted["curve"][name].as_array().expect("a column").len();
    assert!(column("delta_T") > 50 && column("delta_T") == column("F_T") && column("F_T") == column("F_N"));
    assert!(column("segment") == column("F_T") && column("h") == column("F_T"));
}

#[test]
fn shells_and_man_know_every_subcommand() {
    let scratch = Scratch::new("", &[]);
    for shell in ["bash", "zsh", "fish"] {
        let script = stdout(&asperity(&["completions", shell]));
        assert!(["compare", "predict", "explain"].iter().all(|word| script.contains(word)), "{shell}: {script}");
    }
    let dir = scratch.path("man");
    let output = asperity(&["man", text(&dir)]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    for page in ["asperity.1", "asperity-run.1", "asperity-law-predict.1"] {
        let page = fs::read_to_string(dir.join(page)).unwrap_or_else(|error| panic!("{page}: {error}"));
        assert!(page.contains(".TH"), "{page}");
    }
}

/// E in MPa and sigma_Y in GPa: allowed, computed, and said to be odd.
#[test]
fn units_that_do_not_fit_together_are_noted_by_every_command() {
    let text = fs::read_to_string("fixtures/cases/ideal.toml").expect("the fixture");
    let text = text.replace("yield_stress = 400.0", "yield_stress = 0.4");
    let scratch = Scratch::new(&text, &[]);
    let file = scratch.path("case.toml").display().to_string();
    let note = "material.hardening.yield_stress: puts E/sigma_Y at 5.000e5; known materials have 10 to 10,000";
    let output = asperity(&["check", &file]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stdout(&output).starts_with(&format!("# note: {note}")), "{}", stdout(&output));
    assert!(Case::parse(&stdout(&output), "checked", &[]).is_ok(), "a note is a comment");
    let checked = json(&asperity(&["check", "--json", &file]));
    assert!(checked["notes"][0].as_str().is_some_and(|told| told.starts_with(note)), "{checked}");
    let sound = json(&asperity(&["check", "--json", "fixtures/cases/ideal.toml"]));
    assert_eq!(sound["notes"], serde_json::json!([]));

    // A run tells of it, and its summary keeps it.
    let note = "path.0.indentation: is 8e-6, the greatest of the path, and the sphere yields first at about ";
    let short = ["--set", "material.hardening.yield_stress=400.0", "--set", "path=[{indentation=8e-6}]"];
    let output = scratch.run("out", &[&QUICK[..8], &short, &QUICK[10..]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains(&format!("note: {note}")), "{}", stderr(&output));
    let summary = fs::read_to_string(scratch.path("out/summary.json")).expect("a summary");
    let summary: Value = serde_json::from_str(&summary).expect("JSON");
    let messages = summary["messages"].as_array().expect("messages");
    assert_eq!(messages.iter().filter(|told| told.as_str().is_some_and(|told| told.contains(note))).count(), 1, "{summary}");

    let note = "material.hardening.yield_stress: puts E/sigma_Y at 5.000e5";
    // Of a study each key once, with the first case that it is odd in.
    let base = text.replace("[[path]]", "[[base.path]]").replace("\n[", "\n[base.").replace("[base.[base.", "[[base.");
    let base = if base.starts_with('[') { base.replacen('[', "[base.", 1) } else { base };
    let study = format!("{base}\n[grid]\n\"material.hardening.yield_stress\" = [400.0, 0.4, 0.2]\n");
    fs::write(scratch.path("study.toml"), study).expect("a study");
    let file = scratch.path("study.toml").display().to_string();
    let checked = json(&asperity(&["check", "--json", &file]));
    let notes = checked["notes"].as_array().expect("notes");
    let told = notes[0].as_str().expect("text");
    assert!(notes.len() == 1 && told.starts_with(&format!("case c0002: {note}")), "{checked}");
    assert!(told.ends_with("(and 1 more cases)"), "{told}");
}
