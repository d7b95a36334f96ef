//! `asperity plot`: the pictures of a run and of a study, the report, and directories that are
//! neither.

#[path = "law/synthetic.rs"]
mod synthetic;

use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use quick_xml::events::Event;

/// About a second.
const CASE: &str = r#"
[sphere]
radius = 1.0
[material]
youngs_modulus = 200e3
poissons_ratio = 0.3
[material.hardening]
law = "ideal"
yield_stress = 400.0
[contact]
friction = 0.3
[mesh]
elements_per_contact_radius = 4
[solver]
press_steps = 4
shear_steps = 5
[output]
fields = "all"
plots = false
[[path]]
indentation = 0.01
[[path]]
shear = "full-slip"
"#;

fn asperity(args: &[&str]) -> assert_cmd::assert::Assert {
    Command::cargo_bin("asperity").expect("the program").args(args).assert()
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a path in UTF-8")
}

fn stdout(assert: &assert_cmd::assert::Assert) -> String {
    String::from_utf8(assert.get_output().stdout.clone()).expect("text is UTF-8")
}

fn stderr(assert: &assert_cmd::assert::Assert) -> String {
    String::from_utf8(assert.get_output().stderr.clone()).expect("messages are UTF-8")
}

/// What there is in a well-formed document: its words, the names of its elements, and its
/// attributes.
#[derive(Default)]
struct Parsed {
    words: String,
    elements: Vec<String>,
    attributes: Vec<(String, String)>,
}

impl Parsed {
    /// Fails where the file is not well-formed.
    fn of(path: &Path) -> Self {
        let content = fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let mut reader = quick_xml::Reader::from_str(&content);
        reader.config_mut().check_end_names = true;
        let mut parsed = Self::default();
        let mut depth = 0_i32;
        loop {
            let event = reader.read_event().unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            match &event {
                Event::Eof => break,
                Event::Text(text) => parsed.words.push_str(text),
                Event::Start(tag) | Event::Empty(tag) => {
                    depth += i32::from(matches!(event, Event::Start(_)));
                    parsed.elements.push(tag.name().as_ref().to_owned());
                    for attribute in tag.attributes() {
                        let attribute = attribute.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
                        parsed.attributes.push((attribute.key.as_ref().to_owned(), attribute.value.to_string()));
                    }
                }
                Event::End(_) => depth -= 1,
                _ => {}
            }
        }
        assert_eq!(depth, 0, "{}: elements are left open", path.display());
        parsed
    }

    fn count(&self, element: &str) -> usize {
        self.elements.iter().filter(|name| *name == element).count()
    }
}

/// The names of the pictures that were written, each of which parses, is where it was said to be
/// and has a white card below dark text.
fn pictures(printed: &str) -> Vec<String> {
    let mut names = Vec::new();
    for path in printed.lines().map(PathBuf::from).filter(|path| path.extension().is_some_and(|end| end == "svg")) {
        let parsed = Parsed::of(&path);
        assert_eq!(parsed.elements[0], "svg");
        assert_eq!(parsed.elements[1], "rect", "{}: the card comes first", path.display());
        let card = parsed.attributes.iter().find(|(key, _)| key == "fill").map(|(_, value)| value.as_str());
        assert_eq!(card, Some("#FFFFFF"), "{}", path.display());
        assert!(parsed.count("text") > 5, "{}", path.display());
        assert!(!parsed.words.contains("NaN") && !parsed.words.contains("inf"), "{}: {}", path.display(), parsed.words);
        names.push(path.file_stem().expect("a name").to_string_lossy().into_owned());
    }
    names
}

#[test]
fn a_run_is_drawn_from_its_directory() {
    let folder = tempfile::tempdir().expect("a folder");
    let (case, out) = (folder.path().join("case.toml"), folder.path().join("run"));
    fs::write(&case, CASE).expect("the case");
    asperity(&["run", text(&case), "--out", text(&out), "--device", "cpu", "--quiet"]).code(0);
    assert!(!out.join("plots").exists());

    let drawn = asperity(&["plot", text(&out)]).code(0);
    let all = ["indentation", "pressure", "forces", "ratio", "stick", "slip", "contact"];
    assert_eq!(pictures(&stdout(&drawn)), all);
    let slip = Parsed::of(&out.join("plots/slip.svg")).words;
    assert_eq!(slip.matches("along the shear").count(), 3, "the lowest of each column: {slip}");
    let pressure = Parsed::of(&out.join("plots/pressure.svg")).words;
    // An elastic contact's pressure would be far above the scale, and what is not drawn has no
    // entry in the legend.
    assert!(pressure.contains("Hertz's shape, same") && !pressure.contains("Hertz, elastic"), "{pressure}");

    prints(&out, folder.path());

    // With a law beside it.
    let study = folder.path().join("study");
    synthetic::write_study(&study, 0.0);
    asperity(&["law", "fit", text(&study)]).code(0);
    let law = study.join("law.json");
    let drawn = asperity(&["plot", text(&out), "--law", text(&law)]).code(0);
    assert_eq!(pictures(&stdout(&drawn)).last().map(String::as_str), Some("law"));
    let words = Parsed::of(&out.join("plots/law.svg")).words;
    assert!(words.contains("law from the case alone") && words.contains("known"), "{words}");

    // A run of which only the history is left, and one that has nothing.
    fs::remove_dir_all(out.join("contact")).expect("no tables");
    fs::remove_dir_all(out.join("plots")).expect("no pictures");
    fs::remove_file(out.join("summary.json")).expect("no summary");
    let drawn = asperity(&["plot", text(&out)]).code(0);
    assert_eq!(pictures(&stdout(&drawn)), ["indentation", "forces", "ratio", "stick"]);
    fs::remove_file(out.join("history.csv")).expect("no history");
    let refused = asperity(&["plot", text(&out)]).code(2);
    assert!(stderr(&refused).contains("history.csv"), "{}", stderr(&refused));
}

/// The path of F_T in its plane, and moments over angles: a point for each step in contact.
#[test]
fn a_run_that_turns_shows_its_force_in_the_plane_and_its_moments() {
    let folder = tempfile::tempdir().expect("a folder");
    let (case, out) = (folder.path().join("case.toml"), folder.path().join("run"));
    let moved = "shear = [0.001, 0.0015]\ntwist = 0.01\nroll = [0.0, -0.003]";
    fs::write(&case, CASE.replace("shear = \"full-slip\"", moved)).expect("the case");
    asperity(&["run", text(&case), "--out", text(&out), "--device", "cpu", "--quiet"]).code(0);
    let drawn = asperity(&["plot", text(&out)]).code(0);
    let names = pictures(&stdout(&drawn));
    assert!(names.iter().any(|name| name == "plane") && names.iter().any(|name| name == "moments"), "{names:?}");
    let history = fs::read_to_string(out.join("history.csv")).expect("the history");
    let column = |name: &str| -> Vec<f64> {
        let at = history.lines().next().expect("a header").split(',').position(|column| column == name).expect("the column");
        history.lines().skip(1).map(|row| row.split(',').nth(at).expect("a value").parse().expect("a number")).collect()
    };
    let (force, angle) = (column("F_N"), column("twist"));
    let in_contact = force.iter().filter(|f| **f > 0.0).count();
    let turning = angle.iter().filter(|angle| **angle != 0.0).count();
    assert!(in_contact > 8 && turning > 4 && in_contact > turning + 1, "{in_contact}, {turning}");

    let plane = Parsed::of(&out.join("plots/plane.svg"));
    // F_N falls by more than 2 % while the force turns, so that there are two circles.
    for label in ["Tangential force in its plane", "103 FT,x / (E R2)", "103 FT,y / (E R2)", "greatest FN (μ = 0.3)", "last FN"]
    {
        assert!(plane.words.contains(label), "{label} is missing in {}", plane.words);
    }
    // And one in the legend.
    assert_eq!(plane.count("circle"), in_contact + 1);
    assert_eq!(plane.attributes.iter().filter(|(key, _)| key == "stroke-dasharray").count(), 4, "two circles, and their samples");
    // The last point is where the table ends: up and to the right, as far from the middle along y
    // as along x over the range of the axis.
    let (x, y) = (*column("F_T").last().expect("a row"), *column("F_T_y").last().expect("a row"));
    let of = |key: &str| -> Vec<f64> {
        plane.attributes.iter().filter(|(name, _)| name == key).map(|(_, value)| value.parse().expect("a number")).collect()
    };
    let (cx, cy) = (of("cx"), of("cy"));
    // After the sample of the legend come the steps; the first have no tangential force.
    let moved = [cx[in_contact] - cx[1], cy[1] - cy[in_contact]];
    assert!(moved[0] > 30.0 && moved[1] > 30.0 && x > 0.0 && y > 0.0, "{moved:?} for {x}, {y}");

    let moments = Parsed::of(&out.join("plots/moments.svg"));
    for label in ["Moments", "M / (FN a)", "angle in rad", "twist, Mtwist", "roll about y, Mroll,y"] {
        assert!(moments.words.contains(label), "{label} is missing in {}", moments.words);
    }
    assert!(!moments.words.contains("about x"), "{}", moments.words);
    // Each angle's steps with the one from which it sets out, and a sample in the legend.
    assert_eq!(moments.count("circle"), 2 * (turning + 2));
}

/// PDF and PNG of the asked size, with text, and axes in the units that are asked for.
fn prints(out: &Path, folder: &Path) {
    let listed = |drawn: &assert_cmd::assert::Assert, ending: &str| {
        let files: Vec<PathBuf> = stdout(drawn).lines().map(PathBuf::from).collect();
        assert!(files.len() == 7 && files.iter().all(|file| file.extension().is_some_and(|end| end == ending)), "{files:?}");
        files
    };
    let drawn = asperity(&["plot", text(out), "--format", "pdf", "--width", "85mm"]).code(0);
    for file in listed(&drawn, "pdf") {
        let pdf = fs::read(&file).expect("a PDF");
        let words = String::from_utf8_lossy(&pdf);
        let page = words.split("/MediaBox").nth(1).and_then(|rest| rest.split(']').next()).expect("a page");
        let width: f64 = page.split_whitespace().nth(2).expect("a width").parse().expect("a number");
        assert!((width - 85.0 / 25.4 * 72.0).abs() < 0.1, "{}: {width}", file.display());
        assert!(words.starts_with("%PDF-") && words.contains("/FontFile"), "{}", file.display());
    }
    let drawn = asperity(&["plot", text(out), "--format", "png", "--width", "640px"]).code(0);
    for file in listed(&drawn, "png") {
        let png = resvg::tiny_skia::Pixmap::load_png(&file).expect("a PNG");
        assert_eq!(png.width(), 640, "{}", file.display());
        // Dark text on the white card.
        let dark = png.pixels().iter().filter(|pixel| pixel.red() < 0x60 && pixel.alpha() == 255).count();
        assert!(dark > 500, "{}: {dark}", file.display());
    }
    // A narrow picture is laid out anew: the same words, all of them on the card.
    asperity(&["plot", text(out), "--width", "85mm"]).code(0);
    let narrow = Parsed::of(&out.join("plots/forces.svg"));
    let head: Vec<&str> = narrow.attributes.iter().take(3).map(|(_, value)| value.as_str()).collect();
    assert!(head[0] == "85.0000mm" && head[2].starts_with("0 0 361 "), "{head:?}");
    assert!(narrow.words.contains("tangential displacement, 103 δT / R") && narrow.words.contains("force, 103 F / (E R2)"));

    // In the units of the case, by the names that it gives them.
    asperity(&["plot", text(out), "--units", "case"]).code(0);
    assert!(Parsed::of(&out.join("plots/pressure.svg")).words.contains("contact pressure p (case's unit of stress)"));
    let labelled = folder.join("labelled");
    fs::create_dir_all(&labelled).expect("a folder");
    for file in ["history.csv", "summary.json"] {
        fs::copy(out.join(file), labelled.join(file)).expect("a copy");
    }
    let case = fs::read_to_string(out.join("case.toml")).expect("the case");
    fs::write(labelled.join("case.toml"), case + "\n[units]\nlength = \"mm\"\nforce = \"N\"\n").expect("the case");
    asperity(&["plot", text(&labelled)]).code(0);
    let words = Parsed::of(&labelled.join("plots/forces.svg")).words;
    assert!(words.contains("tangential displacement δT (mm)") && words.contains("force F (N)"), "{words}");
    let refused = asperity(&["plot", text(out), "--width", "85"]).code(2);
    assert!(stderr(&refused).contains("as in \"85mm\""), "{}", stderr(&refused));
    asperity(&["plot", text(out)]).code(0);
}

#[test]
fn a_study_is_drawn_into_one_report() {
    let folder = tempfile::tempdir().expect("a folder");
    let study = folder.path().join("a <small> study & more");
    synthetic::write_study(&study, 0.01);
    fs::write(study.join("study.toml"), "# <E/sigma_Y> & mu\n").expect("study.toml");

    // Without a law.
    let drawn = asperity(&["plot", text(&study)]).code(0);
    let plain = ["johnson", "area", "fall", "collapse-tangential", "collapse-normal"];
    assert_eq!(pictures(&stdout(&drawn)), plain);
    let report = Parsed::of(&study.join("report.html"));
    assert_eq!(report.count("svg"), plain.len());
    assert!(report.words.contains("determines one"), "the report says how to get a law");

    // With the study's own.
    asperity(&["law", "fit", text(&study)]).code(0);
    let drawn = asperity(&["plot", text(&study)]).code(0);
    let all = ["johnson", "area", "fall", "parameters", "collapse-tangential", "collapse-normal", "cases", "errors"];
    assert_eq!(pictures(&stdout(&drawn)), all);
    assert!(stdout(&drawn).ends_with("report.html\n"));
    let report = Parsed::of(&study.join("report.html"));
    assert_eq!(report.count("svg"), all.len());
    // Self-contained: nothing is fetched, and no script runs.
    for element in ["script", "link", "img", "iframe", "object", "embed", "image", "use", "foreignObject"] {
        assert_eq!(report.count(element), 0, "{element}");
    }
    for (key, value) in &report.attributes {
        assert!(!["src", "href", "xlink:href", "srcset", "data"].contains(&key.as_str()), "{key} = {value}");
        assert!(key.starts_with("xmlns") || !value.contains("://"), "{key} = {value}");
    }
    let style = fs::read_to_string(study.join("report.html")).expect("the report");
    // A colour that goes over into another is named by its place in the same file.
    assert!(!style.contains("@import") && !style.replace("url(#", "").contains("url("), "the style fetches nothing");
    assert!(style.contains("text-decoration=\"overline\">H<"), "H with its bar");
    // A row a case and the one that failed with its reason, the formulas, the errors, the range,
    // the study.
    for told in [
        "37 cases: 36 done, 1 failed",
        "Cases that failed",
        "a step did not converge",
        "Where it holds",
        "Cross-validated",
        "Jaeger-Ciavarella",
        "elastic",
    ] {
        assert!(report.words.contains(told), "{told} is missing");
    }
    assert!(style.contains("# &lt;E/sigma_Y&gt; &amp; mu"));
    assert!(style.contains("δ<sub>T,slip</sub>") && style.contains("tanh("), "the formulas are there");

    // The same data, the same bytes.
    let first = fs::read(study.join("report.html")).expect("the report");
    asperity(&["plot", text(&study)]).code(0);
    assert!(fs::read(study.join("report.html")).expect("the report") == first);

    // A law from elsewhere, told apart from a fitted one.
    let other = folder.path().join("other");
    synthetic::write_study(&other, 0.0);
    fs::copy(study.join("law.json"), folder.path().join("elsewhere.json")).expect("the law");
    asperity(&["plot", text(&other), "--law", text(&folder.path().join("elsewhere.json"))]).code(0);
    assert!(Parsed::of(&other.join("report.html")).words.contains("The law was not fitted to these cases"));
}

#[test]
fn what_is_neither_is_refused_by_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let dir = folder.path();
    let refused = |args: &[&str], told: &[&str]| {
        let assert = asperity(args).code(2);
        let said = stderr(&assert);
        assert!(told.iter().all(|told| said.contains(told)) && said.lines().count() == 1, "{args:?}: {said}");
    };
    refused(&["plot", text(dir)], &["neither a run nor a study", "there is no case.toml", "there is no study.csv", "--out"]);
    refused(&["plot", text(&dir.join("nowhere"))], &["nowhere", "cannot be read"]);
    let file = dir.join("file");
    fs::write(&file, "mine").expect("a file");
    refused(&["plot", text(&file)], &["file", "is not a directory"]);
    // The user's own files of those names.
    fs::write(dir.join("case.toml"), CASE).expect("a case");
    fs::write(dir.join("study.csv"), "a,b\n1,2\n").expect("a table");
    refused(&["plot", text(dir)], &["case.toml is not one that a run wrote", "study.csv is not the table of a study"]);
    assert!(!dir.join("plots").exists() && !dir.join("report.html").exists());

    let study = dir.join("study");
    synthetic::write_study(&study, 0.0);
    refused(&["plot", text(&study), "--law", text(&file)], &["file", "not a law"]);
    fs::write(study.join("law.json"), "{}").expect("a broken law");
    refused(&["plot", text(&study)], &["law.json", "not a law"]);
    fs::remove_file(study.join("law.json")).expect("no law");
    fs::remove_file(study.join("cases/c0003/history.csv")).expect("a case without history");
    refused(&["plot", text(&study)], &["cases/c0003/history.csv"]);
    assert!(!study.join("report.html").exists() && !study.join("plots").exists(), "nothing is half done");
}
