//! The `[[path]]` tables: segments of pressing, shearing and releasing.

use super::bodies::{Friction, Opponent, Sphere};
use super::error::CaseError;
use super::motion;
use super::reader::{Field, Reader};
use super::segment::{Hold, Segment, ShearTarget};
use super::targets::{Lengths, PathState, displacement, read_full_slip, read_hold, read_indentation};

const PATH: &str = "at least one [[path]] segment, the first with an indentation > 0";

/// Reads all of `[[path]]`, in the order in which it is followed.
pub(super) fn read(
    root: &Reader<'_>,
    sphere: &Sphere,
    opponent: Option<&Opponent>,
    friction: Friction,
) -> Result<Vec<Segment>, CaseError> {
    let lengths = Lengths::of(sphere, opponent);
    let field = root.require("path", PATH)?;
    let items = field.array(PATH)?;
    if items.is_empty() {
        return Err(field.refuse("is empty", PATH));
    }
    let mut state = PathState::default();
    items
        .iter()
        .map(|item| {
            let table = item.table()?;
            let segment = read_segment(&table, &mut state, &lengths, friction)?;
            motion::check(&segment, &table, sphere, friction)?;
            Ok(segment)
        })
        .collect()
}

fn read_segment(table: &Reader<'_>, state: &mut PathState, lengths: &Lengths, friction: Friction) -> Result<Segment, CaseError> {
    const ONE: &str = "one of release and targets of the plate (indentation, shear, twist, roll, in proportion if there are \
                       several), in each [[path]]";
    table.only(&["indentation", "shear", "shear_direction", "twist", "roll", "hold", "release"])?;
    let (indentation, shear, release) = (table.get("indentation"), table.get("shear"), table.get("release"));
    let turn = table.get("twist").or_else(|| table.get("roll"));
    if let (Some(hold), None, None) = (table.get("hold"), &shear, &turn) {
        return Err(hold.refuse("stands without shear", "hold beside shear, twist or roll in the same [[path]]"));
    }
    if let (Some(direction), None) = (table.get("shear_direction"), &shear) {
        return Err(direction.refuse("stands without shear", "shear_direction beside shear in the same [[path]]"));
    }
    if release.is_none() && motion::is_asked_for(table) {
        return motion::read(table, state, lengths, friction);
    }
    match (indentation, shear, release) {
        (Some(field), None, None) => read_indentation(&field, state, lengths),
        (None, Some(field), None) => {
            let hold = read_hold(table)?;
            let shear = read_shear(&field, state, lengths, friction)?;
            if hold == Hold::NormalForce {
                state.indentation = None;
            }
            Ok(Segment::Shear { shear, hold })
        }
        (Some(indentation), Some(shear), None) => {
            if let Some(hold) = table.get("hold") {
                return Err(hold.refuse("stands beside indentation and shear, of which none is held", "no hold in this [[path]]"));
            }
            read_oblique(&indentation, &shear, state, lengths)
        }
        (None, None, None) => Err(table.refuse("has neither indentation nor shear nor release", ONE)),
        (None, None, Some(field)) if turn.is_none() => read_release(&field, state),
        (_, _, Some(field)) => Err(field.refuse("stands beside another target", ONE)),
    }
}

fn read_release(field: &Field<'_>, state: &mut PathState) -> Result<Segment, CaseError> {
    const ALLOWED: &str = "release = true, or the share of F_N that is left, between 0 and 1";
    let share = if field.truth() == Some(true) {
        0.0
    } else if field.truth() == Some(false) {
        return Err(field.refuse("is false", ALLOWED));
    } else if let Some(text) = field.text() {
        return Err(field.unknown_word(text, &["true"], ALLOWED));
    } else {
        field.number(ALLOWED, |share| share > 0.0 && share < 1.0)?
    };
    if !state.in_contact {
        return Err(field.refuse("releases what is not in contact", "release after a segment that presses"));
    }
    (state.in_contact, state.indentation) = (share > 0.0, None);
    Ok(Segment::Release { share })
}

/// Both targets at once; from where nothing touches too.
fn read_oblique(h: &Field<'_>, delta_t: &Field<'_>, state: &mut PathState, lengths: &Lengths) -> Result<Segment, CaseError> {
    if delta_t.text().is_some() {
        let allowed = "a length: where it ends has to be known";
        return Err(delta_t.refuse("is a word beside indentation", allowed));
    }
    let before = state.shear;
    let Segment::Indentation { indentation } = read_indentation(h, state, lengths)? else {
        return Err(h.refuse("is no indentation", "a length"));
    };
    let shear = displacement(delta_t, lengths, "")?;
    let target = Some(ShearTarget::Displacement(shear));
    if before == target {
        return Err(delta_t.refuse("is where the segment begins", "a target other than the current one, or no shear here"));
    }
    state.shear = target;
    Ok(Segment::Oblique { indentation, shear })
}

fn read_shear(field: &Field<'_>, state: &mut PathState, lengths: &Lengths, friction: Friction) -> Result<ShearTarget, CaseError> {
    if !state.in_contact {
        return Err(field.refuse("shears what is not in contact", "shear after a segment with an indentation > 0"));
    }
    let shear = if field.text().is_some() {
        read_full_slip(field, friction)?
    } else {
        ShearTarget::Displacement(displacement(field, lengths, ", or \"full-slip\"")?)
    };
    if state.shear == Some(shear) {
        return Err(field.refuse("is where the segment begins", "a target other than the current one"));
    }
    state.shear = Some(shear);
    Ok(shear)
}
