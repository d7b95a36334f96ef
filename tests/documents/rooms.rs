//! The rooms of ARCHITECTURE.md: each folder of the source has its place in the list, and uses only
//! what stands below it there. Rooms of one row may use each other.

use std::fs;
use std::path::{Path, PathBuf};

/// The rows of the list, from the top: the rooms of each, and whether they are of the kernels.
fn list() -> Vec<(Vec<String>, bool)> {
    let page = fs::read_to_string("ARCHITECTURE.md").expect("the page");
    let rows = page.lines().skip_while(|line| !line.starts_with("| room |")).skip(2).take_while(|line| line.starts_with('|'));
    let mut kernels = false;
    let rows = rows.filter_map(|line| {
        let cell = line.split('|').nth(1)?;
        kernels |= cell.contains("crates/kernels");
        let names = cell.split('`').skip(1).step_by(2).map(|name| name.trim_end_matches(".rs").to_owned());
        let names: Vec<String> = names.filter(|name| !name.contains('/')).collect();
        (!names.is_empty()).then_some((names, kernels))
    });
    rows.collect()
}

/// The names after each `crate::` of a line, those in braces too, as `use crate::{a, b}` has them.
fn used(line: &str) -> Vec<String> {
    let head = |text: &str| text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let mut names = Vec::new();
    for rest in line.split("crate::").skip(1) {
        match rest.strip_prefix('{') {
            Some(group) => names.extend(group.split(',').map(|part| head(part.trim()))),
            None => names.push(head(rest)),
        }
    }
    names
}

/// The source files of a room; its tests may use anything.
fn files(room: &Path) -> Vec<PathBuf> {
    if room.is_file() {
        return vec![room.to_owned()];
    }
    let (mut folders, mut files) = (vec![room.to_owned()], Vec::new());
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            let tests = path.file_stem().is_some_and(|stem| stem == "tests");
            match path.is_dir() {
                _ if tests => {}
                true => folders.push(path),
                false if path.extension().is_some_and(|extension| extension == "rs") => files.push(path),
                false => {}
            }
        }
    }
    files
}

#[test]
fn a_room_uses_only_what_is_below_it() {
    let list = list();
    let row = |name: &str| list.iter().position(|(names, _)| names.iter().any(|listed| listed == name));
    let (mut arrows, mut rooms) = (0, 0);
    for (place, (names, kernels)) in list.iter().enumerate() {
        let folder = Path::new(if *kernels { "crates/kernels/src" } else { "src" });
        for name in names {
            let room = if folder.join(name).is_dir() { folder.join(name) } else { folder.join(format!("{name}.rs")) };
            assert!(room.exists(), "ARCHITECTURE.md lists {name}, and there is no {}", room.display());
            rooms += 1;
            for path in files(&room) {
                let text = fs::read_to_string(&path).expect("source");
                let code = text.lines().take_while(|line| *line != "mod tests {").enumerate();
                for (number, line) in code.filter(|(_, line)| !line.trim_start().starts_with("//")) {
                    for other in used(line).iter().filter(|other| *other != name) {
                        // What is no room is an item that lib.rs hands on.
                        let Some(there) = row(other) else { continue };
                        let rule = format!("{name} uses {other}, which does not stand below it in ARCHITECTURE.md");
                        assert!(there >= place, "{}:{}: {rule}", path.display(), number + 1);
                        arrows += 1;
                    }
                }
            }
        }
    }
    assert!(rooms > 20 && arrows > 300, "{rooms} rooms, {arrows} arrows");
}

#[test]
fn every_folder_is_a_room() {
    let list = list();
    for (folder, kernels) in [("src", false), ("crates/kernels/src", true)] {
        for entry in fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
            let entrance = ["lib", "main", "internals"].contains(&name.as_str());
            let listed = list.iter().any(|(names, of)| *of == kernels && names.contains(&name));
            assert!(listed || entrance, "ARCHITECTURE.md does not list {}", path.display());
        }
    }
}
