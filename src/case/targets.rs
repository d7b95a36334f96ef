//! The targets of a segment: which there may be, from what is known of the state where it begins.

use super::bodies::{Friction, Opponent, Sphere};
use super::error::CaseError;
use super::reader::{Field, Reader};
use super::segment::{Hold, Segment, ShearTarget};

/// Largest indentation over the radius: beyond it the equator is no longer far from the contact.
const MAX_INDENTATION: f64 = 0.3;
/// Largest tangential displacement over the radius.
const MAX_SHEAR: f64 = 0.5;

/// The lengths that limit a path.
pub(super) struct Lengths {
    /// Largest indentations are shares of this one: the radius, or with another sphere R*.
    press: f64,
    /// Largest displacements along the surface are shares of this one: the radius, or of two the
    /// smaller.
    shear: f64,
    /// How errors call them.
    press_name: &'static str,
    shear_name: &'static str,
}

impl Lengths {
    /// Those of a body and what it is pressed against.
    pub fn of(sphere: &Sphere, opponent: Option<&Opponent>) -> Self {
        let radius = sphere.radius;
        match opponent {
            Some(&Opponent::Rigid { radius: other } | &Opponent::Deforming { radius: Some(other), .. }) => Self {
                press: if sphere.flat { other.min(radius) } else { radius / (1.0 + radius / other) },
                shear: radius.min(other),
                press_name: if sphere.flat { "of the smaller radius" } else { "effective radius" },
                shear_name: "of the smaller radius",
            },
            None | Some(Opponent::Equal | Opponent::Deforming { radius: None, .. }) => {
                Self { press: radius, shear: radius, press_name: "radius", shear_name: "radius" }
            }
        }
    }
}

/// What is known of the state when a segment begins; `None` where only the simulation can know.
pub(super) struct PathState {
    pub in_contact: bool,
    pub indentation: Option<f64>,
    pub shear: Option<ShearTarget>,
    /// delta_T along y.
    pub across: Option<f64>,
    pub roll: [f64; 2],
    pub twist: f64,
}

impl Default for PathState {
    fn default() -> Self {
        let shear = Some(ShearTarget::Displacement(0.0));
        Self { in_contact: false, indentation: Some(0.0), shear, across: Some(0.0), roll: [0.0; 2], twist: 0.0 }
    }
}

/// What a segment keeps constant.
pub(super) fn read_hold(table: &Reader<'_>) -> Result<Hold, CaseError> {
    match table.get("hold") {
        Some(hold) => hold.choice(&[("indentation", Hold::Indentation), ("normal-force", Hold::NormalForce)]),
        None => Ok(Hold::default()),
    }
}

/// A displacement along the plane; `or` is what else stands there.
pub(super) fn displacement(field: &Field<'_>, lengths: &Lengths, or: &str) -> Result<f64, CaseError> {
    let (largest, name) = (MAX_SHEAR * lengths.shear, lengths.shear_name);
    let allowed = format!("a length between {:?} and {largest:?} (0.5 {name}){or}", -largest);
    field.number(&allowed, |shear| (shear / lengths.shear).abs() < MAX_SHEAR)
}

pub(super) fn read_indentation(field: &Field<'_>, state: &mut PathState, lengths: &Lengths) -> Result<Segment, CaseError> {
    // Compared as ratios, so that a case and its copy in other units are accepted alike.
    let (length, name) = (lengths.press, lengths.press_name);
    let below = |h: f64| h / length < MAX_INDENTATION;
    let largest = format!("< {MAX_INDENTATION} {name} = {:?}", MAX_INDENTATION * length);
    let indentation = if !state.in_contact {
        field.number(&format!("a length > 0 and {largest}, to come into contact"), |h| h / length > 0.0 && below(h))?
    } else {
        field.number(&format!("a length >= 0 and {largest}"), |h| h >= 0.0 && below(h))?
    };
    if state.indentation == Some(indentation) {
        return Err(
            field.refuse(&format!("is {indentation:?}, where the segment begins"), "an indentation other than the current one")
        );
    }
    state.shear = state.shear.filter(|shear| matches!(shear, ShearTarget::Displacement(_)));
    (state.in_contact, state.indentation) = (indentation > 0.0, Some(indentation));
    Ok(Segment::Indentation { indentation })
}

/// "full-slip", where there is slip.
pub(super) fn read_full_slip(field: &Field<'_>, friction: Friction) -> Result<ShearTarget, CaseError> {
    let shear = field.choice(&[("full-slip", ShearTarget::FullSlip)])?;
    if friction == Friction::Stick {
        let allowed = "a displacement, or a number for contact.friction";
        return Err(field.refuse("is \"full-slip\", which friction = \"stick\" never reaches", allowed));
    }
    Ok(shear)
}
