//! The case file: what one simulation is told, its defaults and its checks.
//!
//! A [`Case`] is read from TOML with [`Case::load`], which refuses anything that could not be
//! simulated and names the file, the line and the key. It is in the user's units until
//! [`Case::scaled`] divides lengths by the sphere's radius and stresses by Young's modulus.

mod bodies;
mod constants;
mod document;
mod error;
mod estimate;
mod hardening;
mod hints;
pub mod keys;
mod likeness;
mod material;
mod mistakes;
mod motion;
mod opponent;
mod orientation;
mod path;
mod pictures;
mod plausible;
mod read;
mod reader;
mod scale;
mod schema;
mod segment;
mod settings;
mod starter;
mod targets;
mod write;

#[cfg(test)]
mod tests;

pub use bodies::{Contact, Equator, Friction, Material, Opponent, Sphere};
pub use document::{Document, Entry, Value};
pub use error::{CaseError, Place, short};
pub(crate) use estimate::check_room;
#[cfg(feature = "law")]
pub(crate) use estimate::fits;
pub use estimate::{BYTES_PER_ELEMENT, estimated_elements, estimated_memory};
pub use hardening::Hardening;
pub(crate) use likeness::nearest;
pub use mistakes::mistakes;
pub use orientation::Orientation;
pub use pictures::{PictureFormat, PictureWidth, UnitLabels, WIDTHS, WidthUnit};
pub use plausible::Doubt;
pub use reader::{Field, Reader};
pub use scale::Scaled;
pub use schema::{case_schema, study_schema};
pub use segment::{Hold, Motion, Segment, ShearTarget, unit};
pub(crate) use settings::CONTACT_RADII;
pub use settings::{Fields, Linear, Mesh, Output, Solver};
pub use starter::{short_case, starter_case};

use serde::Serialize;

use crate::contact::pair::Image;

/// One simulation: a sphere, its material, its friction, and the path it is taken along. Any one
/// consistent system of units.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Case {
    /// The body.
    pub sphere: Sphere,
    /// What it is made of.
    pub material: Material,
    /// How it meets the plane.
    pub contact: Contact,
    /// What it is pressed against; a rigid plane if nothing is said.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub opponent: Option<Opponent>,
    /// How it is meshed.
    pub mesh: Mesh,
    /// How the equations are solved.
    pub solver: Solver,
    /// What is written.
    pub output: Output,
    /// What the user's units are called, in pictures.
    #[serde(skip_serializing_if = "UnitLabels::is_empty")]
    pub units: UnitLabels,
    /// The segments, in order; the first one presses.
    pub path: Vec<Segment>,
}

impl Case {
    /// Number of bodies of which only one is simulated: two in an equal pair that is simulated by
    /// an image, where each has half of h, of delta_T, of the angles and of the energies.
    pub fn bodies(&self) -> f64 {
        if self.image().is_some() { 2.0 } else { 1.0 }
    }

    /// Where the other one of an equal pair is, of which one body is simulated; `None` where both
    /// are, and of everything that is no equal pair.
    ///
    /// An image moves and turns as it must (see [`Image`]). The half turn has the relative motions
    /// of a press, a shear along x, a twist and a roll about x; what is even in y it has on half of
    /// a mesh. The inversion has any shear, and no turn. A roll about y, or a turn with a shear
    /// across the x axis, neither has.
    pub(crate) fn image(&self) -> Option<Image> {
        if self.opponent != Some(Opponent::Equal) || self.path.iter().any(Segment::rolls_along_x) {
            return None;
        }
        match (self.path.iter().any(Segment::leaves_x), self.turns()) {
            (false, _) => Some(Image::HalfTurn),
            (true, false) => Some(Image::Inversion),
            (true, true) => None,
        }
    }

    /// Whether the plate moves along x and the normal alone.
    pub fn moves_along_x(&self) -> bool {
        self.is_even() && !self.turns()
    }

    /// How much more than the sphere alone both bodies give way: along the normal (1/E* over (1 -
    /// nu^2)/E) and along the surface ((2 - nu)/G likewise). Ones against what is rigid, and in an
    /// equal pair, of which one body is simulated.
    pub fn compliance(&self) -> [f64; 2] {
        let Some(Opponent::Deforming { material, .. }) = &self.opponent else { return [1.0; 2] };
        let of = |m: &Material| {
            let (e, nu) = (m.youngs_modulus, m.poissons_ratio);
            [(1.0 - nu * nu) / e, 2.0 * (1.0 + nu) * (2.0 - nu) / e]
        };
        let (own, other) = (of(&self.material), of(material));
        [0, 1].map(|i| 1.0 + other[i] / own[i])
    }

    /// Radius of what the sphere is pressed against; none of what is flat.
    pub fn opponent_radius(&self) -> Option<f64> {
        match self.opponent {
            None | Some(Opponent::Deforming { radius: None, .. }) => None,
            Some(Opponent::Equal) => Some(self.sphere.radius),
            Some(Opponent::Rigid { radius } | Opponent::Deforming { radius: Some(radius), .. }) => Some(radius),
        }
    }

    /// The effective radius R*, 1/R* = 1/R_1 + 1/R_2: that of the sphere which, pressed onto a
    /// plane, meets it as closely as these two surfaces meet.
    pub fn effective_radius(&self) -> f64 {
        let Some(other) = self.opponent_radius() else { return self.sphere.radius };
        // The quotient, and not the radii, is what stays of the order of one.
        if self.sphere.flat { other } else { self.sphere.radius / (1.0 + self.sphere.radius / other) }
    }

    /// The first segment of the path that presses to its greatest indentation, by its number, and
    /// that indentation, a length; `None` where nothing presses.
    pub fn deepest_press(&self) -> Option<(usize, f64)> {
        let presses = self.path.iter().enumerate().filter_map(|(i, segment)| match *segment {
            Segment::Indentation { indentation } | Segment::Oblique { indentation, .. } => Some((i, indentation)),
            Segment::Motion { to, .. } => Some((i, to.indentation?)),
            Segment::Shear { .. } | Segment::Slip { .. } | Segment::Release { .. } => None,
        });
        presses.reduce(|most, next| if next.1 > most.1 { next } else { most })
    }

    /// Whether all of the path is even in y: half of the sphere is meshed then, and all of it if
    /// not.
    pub fn is_even(&self) -> bool {
        self.path.iter().all(Segment::is_even)
    }

    /// Whether the plate turns somewhere on the path.
    pub fn turns(&self) -> bool {
        self.path.iter().any(Segment::turns)
    }

    /// The greatest indentation of the path, a length; 0 where nothing presses.
    pub fn greatest_indentation(&self) -> f64 {
        self.deepest_press().map_or(0.0, |(_, indentation)| indentation)
    }

    /// The least that the greatest indentation of a path may be: an elastic contact there, of which
    /// a^2 = R* h (Hertz), has the smallest radius that is meshed for.
    pub(crate) fn least_indentation(&self) -> f64 {
        let radius = self.effective_radius();
        (CONTACT_RADII.0 * self.sphere.radius / radius).powi(2) * radius
    }

    /// Radius of the sphere over a plane that one body of this case is pressed like: R* against
    /// another body; R in an equal pair too, of which each body is pressed by its share of h.
    pub fn body_radius(&self) -> f64 {
        self.bodies() * self.effective_radius()
    }
}
