//! The documents: their commands and snippets are run, their references made from the code, their
//! links followed.
#![cfg(unix)]

#[path = "documents/case_reference.rs"]
mod case_reference;
#[path = "documents/command_reference.rs"]
mod command_reference;
mod common;
#[path = "documents/imports.rs"]
mod imports;
#[path = "documents/page.rs"]
mod page;
#[path = "documents/results.rs"]
mod results;
#[path = "documents/rooms.rs"]
mod rooms;
#[path = "documents/shell.rs"]
mod shell;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use asperity::case::Case;
use asperity::study::Study;
use page::{Page, pages, records};

/// Holds a generated page to what it would be made to now; ASPERITY_BLESS=1 rewrites it.
fn held(path: &str, text: &str) {
    if std::env::var_os("ASPERITY_BLESS").is_some() {
        fs::write(path, text).expect("the page");
    }
    let stands = fs::read_to_string(path).unwrap_or_default();
    assert!(stands == text, "{path} is out of date: ASPERITY_BLESS=1 cargo test --test documents rewrites it");
}

#[test]
fn the_case_reference_is_that_of_the_keys() {
    held("docs/cases.md", &case_reference::text());
}

#[test]
fn the_command_reference_is_that_of_the_command_line() {
    held("docs/commands.md", &command_reference::text());
}

#[test]
fn every_link_leads_somewhere() {
    let pages = pages();
    for page in pages.iter().chain(&records()) {
        for link in page.links() {
            if link.contains("://") {
                continue;
            }
            let (file, anchor) = link.split_once('#').unwrap_or((&link, ""));
            let path = if file.is_empty() { page.path.clone() } else { page.path.parent().expect("a folder").join(file) };
            assert!(path.exists(), "{}: no {link}", page.path.display());
            if !anchor.is_empty() {
                let anchors = Page::read(&path).anchors();
                assert!(anchors.contains(anchor), "{}: no {link}; there are {anchors:?}", page.path.display());
            }
        }
    }
    let links = Page::read(Path::new("docs/SUMMARY.md")).links();
    let listed: BTreeSet<&str> = links.iter().map(String::as_str).collect();
    for page in pages.iter().filter(|page| page.path.starts_with("docs") && !page.path.ends_with("SUMMARY.md")) {
        let name = page.path.file_name().expect("a name").to_string_lossy();
        assert!(listed.contains(name.as_ref()), "docs/SUMMARY.md lacks {name}");
    }
}

/// Files of the repository that the documents name in backticks.
#[test]
fn every_file_that_is_named_is_there() {
    for page in pages().into_iter().chain(records()) {
        for (number, line) in page.prose() {
            for name in line.split('`').skip(1).step_by(2) {
                let folder = name.split('/').next().unwrap_or_default();
                let ours = ["src", "crates", "tests", "docs", "shaders", "examples", "benches", "fixtures"].contains(&folder);
                // Patterns such as src/law/export/asperity_law.{h,py} name several.
                if ours && name.contains('/') && !name.contains(['{', '*', ' ']) {
                    assert!(Path::new(name).exists(), "{}:{number}: no {name}", page.path.display());
                }
            }
        }
    }
}

/// A row of figures has one place: where it stands twice, one of the two rots.
#[test]
fn no_row_of_numbers_stands_twice() {
    let mut places: BTreeMap<String, String> = BTreeMap::new();
    for page in pages().into_iter().chain(records()) {
        let lines = page.prose();
        for (index, (number, line)) in lines.iter().enumerate() {
            let heading = lines.get(index + 1).is_some_and(|(_, next)| next.starts_with("|---"));
            let words = line.split(|c: char| c.is_whitespace() || "|/(),".contains(c));
            let numbers = words.filter(|word| word.trim_end_matches('%').parse::<f64>().is_ok()).count();
            if line.starts_with('|') && !heading && numbers > 2 {
                let place = format!("{}:{number}", page.path.display());
                let before = places.insert((*line).to_owned(), place.clone());
                assert!(before.is_none(), "{place} is a row that stands at {} too: {line}", before.unwrap_or_default());
            }
        }
    }
    assert!(places.len() > 200, "{} rows of numbers", places.len());
}

/// mdBook takes along what lies below docs/.
#[test]
fn pictures_of_the_book_lie_in_it() {
    for page in pages().iter().filter(|page| page.path.starts_with("docs")) {
        let pictures = page.text.split("![").skip(1).filter_map(|rest| rest.split("](").nth(1)?.split(')').next());
        pictures.for_each(|picture| assert!(!picture.starts_with(".."), "{}: {picture}", page.path.display()));
    }
    for name in ["collapse-normal.svg", "collapse-tangential.svg"] {
        let [here, there] =
            ["docs/gallery", "fixtures/law"].map(|folder| fs::read(Path::new(folder).join(name)).expect("a picture"));
        assert!(here == there, "docs/gallery/{name} is not that of fixtures/law");
    }
}

#[test]
fn lines_are_at_most_110_wide_and_the_readme_is_short() {
    let mut wide = Vec::new();
    for page in pages() {
        for (number, line) in page.prose() {
            // A table or a picture cannot be broken.
            if !line.starts_with(['|', '!']) && line.chars().count() > 110 {
                wide.push(format!("{}:{number}", page.path.display()));
            }
        }
    }
    assert!(wide.is_empty(), "{wide:#?}");
    let readme = Page::read(Path::new("README.md"));
    assert!(readme.text.lines().count() <= 110);
    // What a newcomer copies first.
    for command in ["cargo run --release -- run fixtures/cases/ideal.toml --out out\n", "bash tests/run.sh\n"] {
        assert!(readme.text.contains(command), "{command}");
    }
}

/// Comments of the source are read in terminals, side by side and in reviews.
#[test]
fn comments_are_at_most_100_wide() {
    let mut folders: Vec<PathBuf> = ["src", "crates", "tests", "benches", "examples", "python/src"].map(PathBuf::from).into();
    let (mut files, mut wide) = (0, Vec::new());
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs" || extension == "wgsl") {
                files += 1;
                // Formulas, in fences or indented, and tables are as wide as they are.
                let mut fenced = false;
                for (number, line) in fs::read_to_string(&path).expect("source").lines().enumerate() {
                    let comment = line.trim_start().starts_with("//");
                    fenced ^= comment && line.trim_start_matches(['/', '!', ' ']).starts_with("```");
                    let table = line.trim_start_matches(['/', '!', ' ']).starts_with('|') || line.contains("//!   ");
                    if comment && !fenced && !table && line.chars().count() > 100 {
                        wide.push(format!("{}:{}", path.display(), number + 1));
                    }
                }
            }
        }
    }
    assert!(files > 300, "{files} files");
    assert!(wide.is_empty(), "{wide:#?}");
}

#[test]
fn every_case_and_study_is_taken() {
    let mut seen = 0;
    for page in pages() {
        for block in page.blocks.iter().filter(|block| block.language == "toml") {
            let place = format!("{}:{}", page.path.display(), block.line);
            if block.text.contains("[grid]") {
                Study::parse(&block.text, &place).unwrap_or_else(|error| panic!("{error}"));
            } else if block.text.contains("[sphere]") {
                Case::parse(&block.text, &place, &[]).unwrap_or_else(|error| panic!("{error}"));
            } else {
                with_fragment(&block.text).unwrap_or_else(|error| panic!("{place}: {error}"));
            }
            seen += 1;
        }
    }
    assert!(seen > 5, "{seen} blocks of TOML");
}

/// The main case with these tables in place of its own.
fn with_fragment(text: &str) -> Result<Case, Box<dyn std::error::Error>> {
    let mut case: toml::Table = fs::read_to_string("fixtures/cases/ideal.toml")?.parse()?;
    case.extend(text.parse::<toml::Table>()?);
    Ok(Case::from_table(&case)?)
}

#[test]
fn the_result_reference_has_every_column() {
    results::check();
}

/// A test for each page, so that they run side by side and a failure names its page.
macro_rules! commands_of {
    ($($name:ident: $path:literal;)+) => {
        $(
            #[test]
            fn $name() {
                shell::run(&Page::read(Path::new($path)));
            }
        )+

        const RUN: &[&str] = &[$($path),+];
    };
}

commands_of! {
    commands_of_the_readme: "README.md";
    commands_of_contributing: "CONTRIBUTING.md";
    commands_of_accuracy: "docs/accuracy.md";
    commands_of_clusters: "docs/clusters.md";
    commands_of_dem: "docs/dem.md";
    commands_of_the_page_to_look_at: "docs/explore.md";
    commands_of_installation: "docs/installation.md";
    commands_of_laws: "docs/laws.md";
    commands_of_the_errors_of_laws: "docs/law-errors.md";
    commands_of_other_codes: "docs/other-codes.md";
    commands_of_performance: "docs/performance.md";
    commands_of_tables_of_pairs: "docs/unlike-bodies.md";
    commands_of_rust: "docs/rust.md";
    commands_of_studies: "docs/studies.md";
    commands_of_troubleshooting: "docs/troubleshooting.md";
    commands_of_the_tutorial: "docs/tutorial.md";
}

#[test]
fn every_page_with_commands_is_run() {
    for page in pages() {
        let path = page.path.to_string_lossy().into_owned();
        let listed = RUN.contains(&path.as_str());
        assert_eq!(page.blocks.iter().any(|block| block.language == "sh"), listed, "{path} and the list above");
    }
}
