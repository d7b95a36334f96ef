//! Holds the reference of results to what a small run and a small study write.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use serde_json::Value;

use super::common::{Scratch, asperity, stderr};
use super::page::Page;

const COARSE: [&str; 6] =
    ["--set", "mesh.elements_per_contact_radius=4", "--set", "solver.press_steps=4", "--set", "path.0.indentation=0.005"];

/// Compares both ways: nothing is missing, and nothing is there that is not written.
pub fn check() {
    let scratch = Scratch::new(&fs::read_to_string("fixtures/cases/ideal.toml").expect("a case"), &COARSE);
    let output = scratch.run("out", &[]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let out = scratch.path("out");
    let page = Page::read(Path::new("docs/results.md"));
    let same =
        |section: &str, written: BTreeSet<String>| assert_eq!(listed(&page, section), written, "docs/results.md: {section}");

    same("history.csv", header(&out.join("history.csv")));
    let last = |folder: &str, ending: &str| {
        let files = fs::read_dir(out.join(folder)).expect("a folder").map(|entry| entry.expect("an entry").path());
        files.filter(|file| file.extension().is_some_and(|found| found == ending)).max().expect("a file")
    };
    same("contact/step_NNNN.csv", header(&last("contact", "csv")));
    let vtu = fs::read_to_string(last("fields", "vtu")).expect("fields");
    let names = vtu.split("Name=\"").skip(1).filter_map(|rest| rest.split('"').next());
    let geometry = ["Points", "connectivity", "offsets", "types"];
    same("fields/step_NNNN.vtu", names.filter(|name| !geometry.contains(name)).map(str::to_owned).collect());
    let summary = fs::read_to_string(out.join("summary.json")).expect("a summary");
    same("summary.json", keys(&serde_json::from_str(&summary).expect("JSON")));

    let study = scratch.path("study");
    let grid = scratch.path("study.toml");
    let text = fs::read_to_string("fixtures/studies/small.toml").expect("a study");
    let (base, _) = text.split_once("[grid]").expect("a grid");
    let base = base
        .replace("elements_per_contact_radius = 5\nsurface_elements_per_contact_radius = 10", "elements_per_contact_radius = 4");
    fs::write(&grid, format!("{base}[grid]\n\"contact.friction\" = [0.2]\n")).expect("a study");
    let output = asperity(&["study", &grid.to_string_lossy(), "--out", &study.to_string_lossy(), "-q"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let mut columns = header(&study.join("study.csv"));
    assert!(columns.remove("contact.friction"));
    same("study.csv", columns);

    let mut written: BTreeSet<String> = fs::read_dir(out.join("plots"))
        .expect("plots")
        .map(|entry| entry.expect("an entry").file_name())
        .map(|name| name.to_string_lossy().into_owned())
        .collect();
    let gallery = Page::read(Path::new("docs/gallery.md"));
    written.retain(|name| !gallery.text.contains(&format!("`{name}`")));
    assert!(written.is_empty(), "docs/gallery.md lacks {written:?}");
}

fn header(path: &Path) -> BTreeSet<String> {
    let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    text.lines().next().expect("a header").split(',').map(str::to_owned).collect()
}

/// The keys of an object, those of tables within it dotted. A phase of the time is one key.
fn keys(value: &Value) -> BTreeSet<String> {
    let mut keys = BTreeSet::new();
    for (key, value) in value.as_object().expect("an object") {
        match value {
            Value::Object(below) => keys.extend(below.keys().map(|below| format!("{key}.{below}"))),
            _ => drop(keys.insert(key.clone())),
        }
    }
    keys
}

/// The names in the first column of the table in a section.
fn listed(page: &Page, section: &str) -> BTreeSet<String> {
    let heading = format!("\n## {section}\n");
    let (_, rest) = page.text.split_once(&heading).unwrap_or_else(|| panic!("no section {section}"));
    let section = rest.split("\n## ").next().expect("a section");
    let name = |line: &str| line.strip_prefix("| `").and_then(|rest| rest.split_once('`')).map(|(name, _)| name.to_owned());
    section.lines().filter_map(name).collect()
}
