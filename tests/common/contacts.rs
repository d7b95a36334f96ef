//! The nine contacts of fixtures/paths: their tables and the cases that these are of.

use std::path::{Path, PathBuf};

use asperity::case::Case;
use asperity::law::LawFile;

/// Three materials at three coefficients of friction.
pub const NAMES: [&str; 9] = [
    "ideal-200-mu-0.1",
    "ideal-200-mu-0.3",
    "ideal-200-mu-0.6",
    "ideal-3200-mu-0.1",
    "ideal-3200-mu-0.3",
    "ideal-3200-mu-0.6",
    "power-300-mu-0.1",
    "power-300-mu-0.3",
    "power-300-mu-0.6",
];

/// Increments of the update between two simulated places, as `law check` has them.
pub const INCREMENTS: usize = 64;

/// Where they are.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/paths")
}

/// The table of a contact, and its case.
pub fn law(name: &str) -> (LawFile, Case) {
    let law = LawFile::read(&folder().join(format!("{name}.json"))).unwrap();
    let LawFile::Table(table) = &law else { panic!("{name} is no table") };
    let case = Case::parse(&table.case, name, &[]).unwrap();
    (law, case)
}
