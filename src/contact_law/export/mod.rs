//! The update for other programs: its C headers, its part of the Python module, the table of one
//! material and one friction, and what the test vectors follow.
//!
//! Headers, module and [`ContactParameters`](super::ContactParameters) are triplets: the same
//! functions with the same operations. `contact_draft.h` and `contact_conserve.h`, and the three
//! `contact_*.py`, have their places in the header and in the module of a law for all materials,
//! which makes its tables itself.

mod table;
pub(crate) mod vectors;

pub(crate) use table::EngineTable;

use super::{COLUMNS, KNOTS, LEVELS, PIECES, POINTS, ROUNDING, SLIDERS, SPARE};

const HEADER: &str = include_str!("asperity_contact.h");
const HEADER_3D: &str = include_str!("asperity_contact3d.h");
const CHECK: &str = include_str!("asperity_contact_check.c");

/// Name of the update's header, by which others include it.
pub const HEADER_NAME: &str = "asperity_contact.h";

/// The update, which is the same for every law.
pub fn header() -> String {
    fill(HEADER, [("VERSION", env!("CARGO_PKG_VERSION").to_owned())].into_iter().chain(sizes()))
}

/// Its use in three dimensions.
pub fn header_3d() -> String {
    HEADER_3D.to_owned()
}

/// The program that compares a C export with the test vectors, under a name.
pub fn check_program(name: &str) -> String {
    fill(CHECK, [("NAME", name.to_owned())])
}

/// What a header that makes tables has of the update, by the names of its places: the table in the
/// making, and what keeps a press from storing too much.
pub(crate) fn header_parts() -> impl Iterator<Item = (&'static str, String)> {
    [("CONTACT_DRAFT", include_str!("contact_draft.h")), ("CONTACT_CONSERVE", include_str!("contact_conserve.h"))]
        .map(|(name, part)| (name, part.to_owned()))
        .into_iter()
        .chain(sizes())
}

/// What a Python module has of the update, by the names of its places.
pub(crate) fn module_parts() -> impl Iterator<Item = (&'static str, String)> {
    [
        ("CONTACT_TYPES", include_str!("contact_types.py")),
        ("CONTACT_TABLE", include_str!("contact_table.py")),
        ("CONTACT_UPDATE", include_str!("contact_update.py")),
    ]
    .map(|(name, part)| (name, part.to_owned()))
    .into_iter()
    .chain(sizes())
}

/// The sizes of the tables and what else the languages share.
fn sizes() -> impl Iterator<Item = (&'static str, String)> {
    [("KNOTS", KNOTS), ("COLUMNS", COLUMNS), ("SLIDERS", SLIDERS), ("POINTS", POINTS), ("LEVELS", LEVELS), ("PIECES", PIECES)]
        .map(|(name, size)| (name, size.to_string()))
        .into_iter()
        .chain([("SPARE", SPARE), ("ROUNDING", ROUNDING)].map(|(name, value)| (name, format!("{value:?}"))))
}

/// A template with its places filled, one after the other: what is filled in may have places of
/// later ones.
pub(crate) fn fill<'a>(template: &str, values: impl IntoIterator<Item = (&'a str, String)>) -> String {
    values.into_iter().fold(template.to_owned(), |text, (name, value)| text.replace(&format!("@{name}@"), &value))
}
