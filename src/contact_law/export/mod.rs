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
use super::turning_constants::{LEVERS, LEVERS_SQUARED, TWIST_FOLLOWS, TWIST_LEVER, TWIST_STIFF, TurningConstants};

const HEADER: &str = include_str!("asperity_contact.h");
/// What it and others are made of: the update's files are in it twice, for one contact and for
/// several.
const PARTS: [(&str, &str); 11] = [
    ("asperity_series.h", include_str!("asperity_series.h")),
    ("asperity_numbers.h", include_str!("asperity_numbers.h")),
    ("asperity_sliders.h", include_str!("asperity_sliders.h")),
    ("asperity_guess.h", include_str!("asperity_guess.h")),
    ("asperity_move.h", include_str!("asperity_move.h")),
    ("asperity_wide.h", include_str!("asperity_wide.h")),
    ("asperity_wide_names.h", NAMES),
    ("asperity_advance.h", include_str!("asperity_advance.h")),
    ("asperity_several.h", include_str!("asperity_several.h")),
    ("asperity_file.h", include_str!("asperity_file.h")),
    ("asperity_many.h", include_str!("asperity_many.h")),
];
const HEADER_TURNING: &str = include_str!("asperity_turning.h");
const HEADER_COHESION: &str = include_str!("asperity_cohesion.h");
const HEADER_FRAME: &str = include_str!("asperity_frame.h");
const HEADER_3D: &str = include_str!("asperity_contact3d.h");
const CHECK: &str = include_str!("asperity_contact_check.c");

/// What the update's files call things for several contacts.
const NAMES: &str = include_str!("asperity_wide_names.h");

/// Name of the update's header, by which others include it.
pub const HEADER_NAME: &str = "asperity_contact.h";
/// Name of what twists and rolls a contact.
pub const TURNING_NAME: &str = "asperity_turning.h";
/// Name of what holds surfaces together.
pub const COHESION_NAME: &str = "asperity_cohesion.h";
/// Name of what turns a contact's frame.
pub const FRAME_NAME: &str = "asperity_frame.h";

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
    let version = [("VERSION", env!("CARGO_PKG_VERSION").to_owned())];
    let renamed = NAMES.lines().filter_map(|line| line.strip_prefix("#define ")?.split_once(' '));
    let end = renamed.map(|(name, _)| format!("#undef {name}")).collect::<Vec<_>>().join("\n");
    let wide_end = [("WIDE_END", end)];
    fill(&whole(HEADER), wide_end.into_iter().chain(version).chain(sizes).chain(numbers).chain(of_a_twist()))
}

/// A header with the parts that it includes.
fn whole(header: &str) -> String {
    PARTS.iter().fold(header.to_owned(), |text, (name, part)| text.replace(&format!("#include \"{name}\"\n"), part))
}

/// What the update needs of a twist.
fn of_a_twist() -> [(&'static str, String); 7] {
    let constants = TurningConstants::FITTED;
    let number = |value: f64| format!("{value:?}");
    [
        ("LEVERS", LEVERS.map(number).join(", ")),
        ("TWIST_STIFF", number(TWIST_STIFF)),
        ("TWIST_LEVER", number(TWIST_LEVER)),
        ("TWIST_YIELD", number(constants.twist_yield)),
        ("TWIST_FLOW", number(constants.twist_flow)),
        ("TWIST_WORN", number(constants.twist_worn)),
        ("TWIST_MOST", number(constants.twist_most)),
    ]
}

/// Its use for a contact that twists and rolls.
pub fn header_turning() -> String {
    let constants = TurningConstants::FITTED;
    let numbers = [
        ("LEVERS_SQUARED", LEVERS_SQUARED),
        ("TWIST_FOLLOWS", TWIST_FOLLOWS),
        ("ROLL_WAY", constants.roll_way),
        ("ROLL_TRACTION", constants.roll_traction),
        ("ROLL_LEAVES", constants.roll_leaves),
        ("ROLL_MOMENT", constants.roll_moment),
        ("ROLL_FADES", constants.roll_fades),
        ("ROLL_STIFF", constants.roll_stiff),
        ("ROLL_SOFTENS", constants.roll_softens),
        ("ROLL_LOSS_FADES", constants.roll_loss_fades),
        ("ROLL_LOSS", constants.roll_loss),
        ("ROLL_SLIP", constants.roll_slip),
        ("ROLL_PRESS", constants.roll_press),
        ("ROLL_FLOW", constants.roll_flow),
    ];
    fill(HEADER_TURNING, numbers.map(|(name, value)| (name, format!("{value:?}"))))
}

/// Its use for a contact whose surfaces attract each other.
pub fn header_cohesion() -> String {
    HEADER_COHESION.to_owned()
}

/// The memory of a contact in three dimensions, and its frame.
pub fn header_frame() -> String {
    HEADER_FRAME.to_owned()
}

/// Its use in three dimensions.
pub fn header_3d() -> String {
    whole(HEADER_3D)
}

/// The program that compares a C export with the test vectors, under a name.
pub fn check_program(name: &str) -> String {
    fill(CHECK, [("NAME", name.to_owned())])
}

/// A template with its places filled.
pub(crate) fn fill<'a>(template: &str, values: impl IntoIterator<Item = (&'a str, String)>) -> String {
    values.into_iter().fold(template.to_owned(), |text, (name, value)| text.replace(&format!("@{name}@"), &value))
}
