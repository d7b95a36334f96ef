//! The path: segments of pressing, shearing and releasing.

use super::error::CaseError;
use super::motion;
use super::reader::{Field, Reader};
use super::{Friction, Opponent, Sphere};

/// One segment of the path. Targets are totals from the undeformed sphere, not increments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Segment {
    /// Move the plate to the indentation h; one smaller than the current unloads to it.
    Indentation {
        /// Target h >= 0, a length.
        indentation: f64,
    },
    /// Move the plate along the plane to delta_T.
    Shear {
        /// Where to.
        shear: ShearTarget,
        /// What is constant meanwhile.
        hold: Hold,
    },
    /// Move the plate to both in a straight line, h and delta_T in proportion: oblique loading and
    /// rebound.
    Oblique {
        /// Target h >= 0, a length.
        indentation: f64,
        /// Target delta_T, a length of either sign.
        shear: f64,
    },
    /// Move the plate in several of its degrees of freedom at once, in proportion.
    Motion {
        /// Where to.
        to: Motion,
        /// What is constant meanwhile, if `to` has no indentation.
        hold: Hold,
    },
    /// Move the plate along the plane, in any direction, until every point in contact slips.
    Slip {
        /// In degrees from x towards y.
        direction: f64,
        /// What is constant meanwhile.
        hold: Hold,
    },
    /// Unload.
    Release {
        /// Until F_N has fallen to this share of what it was when the segment began, 0 <= share <
        /// 1; with 0 until contact is lost.
        share: f64,
    },
}

/// Where the plate goes to; what is `None` stays as it is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Target h >= 0, a length.
    pub indentation: Option<f64>,
    /// Target delta_T along x and y, lengths of either sign.
    pub shear: Option<[f64; 2]>,
    /// How far it is to have rolled about x and y, in rad. The centre goes along, so that delta_T,
    /// the displacement of one surface on the other, stays as it is.
    pub roll: Option<[f64; 2]>,
    /// How far it is to have turned about the normal, z, in rad.
    pub twist: Option<f64>,
}

impl Motion {
    /// Whether the plate turns.
    pub fn turns(&self) -> bool {
        self.roll.is_some() || self.twist.is_some()
    }
}

impl Segment {
    /// Whether all of it is even in y, for a plate that so far was: half of the body then tells of
    /// all of it.
    pub fn is_even(&self) -> bool {
        match self {
            Self::Motion { to, .. } => {
                to.twist.is_none() && to.shear.is_none_or(|[_, y]| y == 0.0) && to.roll.is_none_or(|[about_x, _]| about_x == 0.0)
            }
            Self::Slip { direction, .. } => unit(*direction)[1] == 0.0,
            Self::Indentation { .. } | Self::Shear { .. } | Self::Oblique { .. } | Self::Release { .. } => true,
        }
    }

    /// Whether the plate is sheared across the x axis in it.
    pub fn leaves_x(&self) -> bool {
        match self {
            Self::Motion { to, .. } => to.shear.is_some_and(|[_, y]| y != 0.0),
            Self::Slip { direction, .. } => unit(*direction)[1] != 0.0,
            Self::Indentation { .. } | Self::Shear { .. } | Self::Oblique { .. } | Self::Release { .. } => false,
        }
    }

    /// Whether the plate rolls about y in it.
    pub fn rolls_along_x(&self) -> bool {
        matches!(self, Self::Motion { to: Motion { roll: Some([_, about_y]), .. }, .. } if *about_y != 0.0)
    }

    /// Whether the plate turns in it.
    pub fn turns(&self) -> bool {
        matches!(self, Self::Motion { to, .. } if to.turns())
    }
}

/// The unit vector in a direction, in degrees from x towards y; along the axes exactly.
pub fn unit(direction: f64) -> [f64; 2] {
    let quarters = direction / 90.0;
    if quarters.fract() == 0.0 {
        return [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]][quarters.rem_euclid(4.0) as usize % 4];
    }
    let (sin, cos) = direction.to_radians().sin_cos();
    [cos, sin]
}

/// Where a shear segment ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ShearTarget {
    /// At this delta_T, a length, of either sign.
    Displacement(f64),
    /// When every point in contact slips.
    FullSlip,
}

/// What a shear segment keeps constant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hold {
    /// The indentation h.
    #[default]
    Indentation,
    /// The normal force F_N.
    NormalForce,
}

/// Largest indentation over the radius: beyond it the equator is no longer far from the contact.
pub(super) const MAX_INDENTATION: f64 = 0.3;
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
    let mut state = State::default();
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

/// What is known of the state when a segment begins; `None` where only the simulation can know.
pub(super) struct State {
    pub in_contact: bool,
    pub indentation: Option<f64>,
    pub shear: Option<ShearTarget>,
    /// delta_T along y.
    pub across: Option<f64>,
    pub roll: [f64; 2],
    pub twist: f64,
}

impl Default for State {
    fn default() -> Self {
        let shear = Some(ShearTarget::Displacement(0.0));
        Self { in_contact: false, indentation: Some(0.0), shear, across: Some(0.0), roll: [0.0; 2], twist: 0.0 }
    }
}

fn read_segment(table: &Reader<'_>, state: &mut State, lengths: &Lengths, friction: Friction) -> Result<Segment, CaseError> {
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

/// What a segment keeps constant.
pub(super) fn read_hold(table: &Reader<'_>) -> Result<Hold, CaseError> {
    match table.get("hold") {
        Some(hold) => hold.choice(&[("indentation", Hold::Indentation), ("normal-force", Hold::NormalForce)]),
        None => Ok(Hold::default()),
    }
}

fn read_release(field: &Field<'_>, state: &mut State) -> Result<Segment, CaseError> {
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
fn read_oblique(h: &Field<'_>, delta_t: &Field<'_>, state: &mut State, lengths: &Lengths) -> Result<Segment, CaseError> {
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

/// A displacement along the plane; `or` is what else stands there.
pub(super) fn displacement(field: &Field<'_>, lengths: &Lengths, or: &str) -> Result<f64, CaseError> {
    let (largest, name) = (MAX_SHEAR * lengths.shear, lengths.shear_name);
    let allowed = format!("a length between {:?} and {largest:?} (0.5 {name}){or}", -largest);
    field.number(&allowed, |shear| (shear / lengths.shear).abs() < MAX_SHEAR)
}

pub(super) fn read_indentation(field: &Field<'_>, state: &mut State, lengths: &Lengths) -> Result<Segment, CaseError> {
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

fn read_shear(field: &Field<'_>, state: &mut State, lengths: &Lengths, friction: Friction) -> Result<ShearTarget, CaseError> {
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
