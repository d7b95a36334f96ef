//! The update for other programs: its C headers, the table of one material and one friction, and
//! what the test vectors follow.
//!
//! The header and [`ContactParameters`](super::ContactParameters) are twins: the same functions
//! with the same operations.

mod table;
pub(crate) mod vectors;

pub(crate) use table::EngineTable;

use super::Constants;
use super::table::{LEVELS, PLACES, ROWS};

const HEADER: &str = include_str!("asperity_contact.h");
const HEADER_3D: &str = include_str!("asperity_contact3d.h");
const CHECK: &str = include_str!("asperity_contact_check.c");

/// Name of the update's header, by which others include it.
pub const HEADER_NAME: &str = "asperity_contact.h";

/// The update, which is the same for every law.
pub fn header() -> String {
    let constants = Constants::FITTED;
    let sizes = [("ROWS", ROWS), ("LEVELS", LEVELS), ("PLACES", PLACES)].map(|(name, size)| (name, size.to_string()));
    let numbers = [
        ("VERTEX_LENGTH", constants.vertex_length),
        ("VERTEX_ROUND", constants.vertex_round),
        ("RADIAL_MOST", constants.radial_most),
        ("NARROWS", constants.narrows),
        ("RECOVERS", constants.recovers),
        ("FORGETS", constants.forgets),
        ("FOLLOWS", constants.follows),
    ];
    let numbers = numbers.map(|(name, value)| (name, format!("{value:?}")));
    fill(HEADER, [("VERSION", env!("CARGO_PKG_VERSION").to_owned())].into_iter().chain(sizes).chain(numbers))
}

/// Its use in three dimensions.
pub fn header_3d() -> String {
    HEADER_3D.to_owned()
}

/// The program that compares a C export with the test vectors, under a name.
pub fn check_program(name: &str) -> String {
    fill(CHECK, [("NAME", name.to_owned())])
}

/// A template with its places filled.
pub(crate) fn fill<'a>(template: &str, values: impl IntoIterator<Item = (&'a str, String)>) -> String {
    values.into_iter().fold(template.to_owned(), |text, (name, value)| text.replace(&format!("@{name}@"), &value))
}
