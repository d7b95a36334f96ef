//! Segments of the path in which the plate moves in any of its six degrees of freedom.

use super::bodies::{Friction, Sphere};
use super::error::CaseError;
use super::reader::{Field, Reader};
use super::segment::{Hold, Motion, Segment, ShearTarget, unit};
use super::targets::{Lengths, PathState, displacement, read_full_slip, read_hold, read_indentation};

/// Largest angle of a twist, in rad, and of a roll, by which the contact travels along the sphere.
const MAX_TWIST: f64 = 100.0;
const MAX_ROLL: f64 = 0.5;

/// Whether a segment asks for more than a press and a shear along x.
pub(super) fn is_asked_for(table: &Reader<'_>) -> bool {
    let is_vector = table.get("shear").is_some_and(|shear| shear.is_array());
    is_vector || ["shear_direction", "twist", "roll"].iter().any(|key| table.get(key).is_some())
}

/// Reads such a segment; one along x alone as what it is.
pub(super) fn read(
    table: &Reader<'_>,
    state: &mut PathState,
    lengths: &Lengths,
    friction: Friction,
) -> Result<Segment, CaseError> {
    let hold = read_hold(table)?;
    let indentation = table.get("indentation");
    if let (Some(hold), Some(_)) = (table.get("hold"), &indentation) {
        return Err(hold.refuse("stands beside indentation, which moves", "no hold in this [[path]]"));
    }
    if indentation.is_none() && !state.in_contact {
        let allowed = "a segment with an indentation > 0 before, or indentation in this one";
        return Err(table.refuse("moves along the surface what is not in contact", allowed));
    }
    if let Some(field) = table.get("shear").filter(|field| field.text().is_some()) {
        return read_slip(table, &field, state, hold, friction);
    }
    let before = (state.indentation, state.shear, state.across, state.roll, state.twist);
    let shear = table.get("shear").map(|field| read_shear(table, &field, state, lengths)).transpose()?;
    let roll = table.get("roll").map(|field| read_roll(&field)).transpose()?;
    let twist = table.get("twist").map(|field| read_twist(&field)).transpose()?;
    if let Some([x, y]) = shear {
        (state.shear, state.across) = (Some(ShearTarget::Displacement(x)), Some(y));
    }
    (state.roll, state.twist) = (roll.unwrap_or(state.roll), twist.unwrap_or(state.twist));
    let moves_along = before.1 != state.shear || before.2 != state.across || before.3 != state.roll || before.4 != state.twist;
    if !moves_along && shear.is_none_or(|_| before.1.is_some() && before.2.is_some()) {
        let allowed = "a target other than the current one for shear, twist or roll";
        return Err(table.refuse("ends where it begins", allowed));
    }
    let indentation = match indentation {
        None => None,
        Some(field) => match read_indentation(&field, state, lengths)? {
            Segment::Indentation { indentation } => Some(indentation),
            _ => None,
        },
    };
    if hold == Hold::NormalForce {
        state.indentation = None;
    }
    // Along x alone it is a segment that others know.
    let is_along_x = before.2 == Some(0.0) && roll.is_none() && twist.is_none();
    Ok(match (shear, indentation) {
        (Some([x, y]), None) if is_along_x && y == 0.0 => Segment::Shear { shear: ShearTarget::Displacement(x), hold },
        (Some([x, y]), Some(indentation)) if is_along_x && y == 0.0 => Segment::Oblique { indentation, shear: x },
        _ => Segment::Motion { to: Motion { indentation, shear, roll, twist }, hold },
    })
}

/// Along a direction until every point slips.
fn read_slip(
    table: &Reader<'_>,
    field: &Field<'_>,
    state: &mut PathState,
    hold: Hold,
    friction: Friction,
) -> Result<Segment, CaseError> {
    const ALONE: &str = "a displacement in place of \"full-slip\", or no other target in this [[path]]";
    read_full_slip(field, friction)?;
    for other in ["indentation", "twist", "roll"] {
        if let Some(other) = table.get(other) {
            return Err(other.refuse("stands beside shear = \"full-slip\", of which nobody knows where it ends", ALONE));
        }
    }
    let direction = table.get("shear_direction").map(|field| read_direction(&field)).transpose()?.unwrap_or(0.0);
    if hold == Hold::NormalForce {
        state.indentation = None;
    }
    let [x, y] = unit(direction);
    if x != 0.0 {
        state.shear = Some(ShearTarget::FullSlip);
    }
    if y != 0.0 {
        state.across = None;
    }
    Ok(Segment::Slip { direction, hold })
}

/// Both components, of a pair or of a length in a direction; of a length alone y stays as it is.
fn read_shear(table: &Reader<'_>, field: &Field<'_>, state: &PathState, lengths: &Lengths) -> Result<[f64; 2], CaseError> {
    const PAIR: &str = "a length, or two of them: [x, y]";
    if field.is_array() {
        if let Some(direction) = table.get("shear_direction") {
            return Err(
                direction.refuse("stands beside a shear that has both components", "shear as a length, or as [x, y] alone")
            );
        }
        let [x, y] = field.pair(PAIR)?;
        return Ok([displacement(&x, lengths, "")?, displacement(&y, lengths, "")?]);
    }
    let length = displacement(field, lengths, ", or [x, y]")?;
    match table.get("shear_direction") {
        Some(direction) => Ok(unit(read_direction(&direction)?).map(|part| part * length)),
        None => match state.across {
            Some(across) => Ok([length, across]),
            None => Err(field.refuse("has no y, which only the simulation knows here", "shear = [x, y]")),
        },
    }
}

fn read_direction(field: &Field<'_>) -> Result<f64, CaseError> {
    field.number("degrees from x towards y, -360 to 360", |angle| angle.abs() <= 360.0)
}

fn read_twist(field: &Field<'_>) -> Result<f64, CaseError> {
    field.number(&format!("an angle in rad, -{MAX_TWIST} to {MAX_TWIST}"), |angle| angle.abs() <= MAX_TWIST)
}

/// About x and y; a number is about y, by which the sphere rolls along x.
fn read_roll(field: &Field<'_>) -> Result<[f64; 2], CaseError> {
    let allowed = format!("an angle in rad about y, or two of them: [about_x, about_y], -{MAX_ROLL} to {MAX_ROLL}");
    let within = |angle: f64| angle.abs() <= MAX_ROLL;
    if !field.is_array() {
        return Ok([0.0, field.number(&allowed, within)?]);
    }
    let [about_x, about_y] = field.pair(&allowed)?;
    Ok([about_x.number(&allowed, within)?, about_y.number(&allowed, within)?])
}

/// Refuses what is not simulated.
pub(super) fn check(segment: &Segment, table: &Reader<'_>, sphere: &Sphere, friction: Friction) -> Result<(), CaseError> {
    let rolls = matches!(segment, Segment::Motion { to: Motion { roll: Some(_), .. }, .. });
    if rolls && sphere.flat {
        return Err(table.refuse("rolls a flat, which has nothing to roll on", "no roll in this [[path]], or a sphere"));
    }
    if rolls && friction == Friction::Stick {
        let what = "rolls under full stick, where points that come down have nothing to stick to yet";
        return Err(table.refuse(what, "a number for contact.friction, or no roll in this [[path]]"));
    }
    Ok(())
}
