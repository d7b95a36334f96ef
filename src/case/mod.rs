//! The case file: what one simulation is told, its defaults and its checks.
//!
//! A [`Case`] is read from TOML with [`Case::load`], which refuses anything that could not be
//! simulated and names the file, the line and the key. It is in the user's units until
//! [`Case::scaled`] divides lengths by the sphere's radius and stresses by Young's modulus.

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
mod starter;
mod write;

#[cfg(test)]
mod tests;

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
pub use path::{Hold, Motion, Segment, ShearTarget, unit};
pub use pictures::{PictureFormat, PictureWidth, UnitLabels, WIDTHS, WidthUnit};
pub use plausible::Doubt;
pub(crate) use read::CONTACT_RADII;
pub use reader::{Field, Reader};
pub use scale::Scaled;
pub use schema::{case_schema, study_schema};
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

/// The body.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sphere {
    /// Radius R > 0, the unit of length of the path.
    pub radius: f64,
    /// The body is no sphere but a flat: half a ball of radius 2 R, pressed onto its flat face.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub flat: bool,
    /// Whether the plane of the equator may widen.
    pub equator: Equator,
}

/// Whether the equatorial plane, whose nodes move along its normal as one, may widen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Equator {
    /// They move as a rigid plate.
    #[default]
    Clamped,
    /// It widens as the mid-plane of a sphere does that is pressed equally from both sides.
    Free,
}

impl Equator {
    /// Whether the plate is rigid.
    pub fn is_clamped(&self) -> bool {
        *self == Self::Clamped
    }
}

/// An isotropic elastic-plastic material.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Material {
    /// Young's modulus E > 0, in units of stress.
    pub youngs_modulus: f64,
    /// Poisson's ratio nu in (-1, 0.5).
    pub poissons_ratio: f64,
    /// The yield stress as a function of the equivalent plastic strain.
    pub hardening: Hardening,
}

/// The interface between sphere and plane.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Contact {
    /// Friction.
    pub friction: Friction,
}

/// Friction between sphere and plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Friction {
    /// Coulomb's coefficient mu >= 0: tangential traction at most mu times the pressure, at every
    /// point.
    Coefficient(f64),
    /// A point in contact never slips.
    Stick,
}

/// What the sphere is pressed against, in place of a rigid plane.
#[derive(Clone, Debug, PartialEq)]
pub enum Opponent {
    /// The same sphere. Indentation and shear are then the relative displacements of the two
    /// equators, twice what each of them moves.
    Equal,
    /// A rigid sphere.
    Rigid {
        /// Its radius > 0, a length.
        radius: f64,
    },
    /// Another body that deforms, meshed as the sphere is.
    Deforming {
        /// Its radius > 0, a length; `None` for a flat, half a ball of twice the sphere's radius.
        radius: Option<f64>,
        /// What it is made of.
        material: Material,
    },
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

/// The mesh.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Mesh {
    /// Elements along the contact radius, 4 to 32.
    pub elements_per_contact_radius: usize,
    /// The same at the surface: once, twice, four or eight times as many; `None` for as many.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub surface_elements_per_contact_radius: Option<usize>,
    /// Thickness of the first layer of elements over their width, 0.5 to 1.5; `None` for
    /// [`Mesh::first_layer`]'s own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_layer_thickness: Option<f64>,
    /// Radius of the finely meshed zone over the contact radius, 1.1 to 3.
    pub fine_zone: f64,
    /// Contact radius to mesh for, in the units of the sphere's radius, in place of the predicted
    /// one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact_radius: Option<f64>,
}

/// See [`Mesh::first_layer`]; chosen by `benches/limits/first_layer.py`.
const HALVED_FIRST_LAYER: f64 = 0.85;

impl Mesh {
    /// Elements along the contact radius at the surface.
    pub fn surface_elements(&self) -> usize {
        self.elements_per_contact_radius << self.skin_levels()
    }

    /// Thickness of the first layer of elements over their width. Thinner than wide, the halved
    /// elements of a skin make F_N and F_T more accurate; those of a uniform mesh make contact less
    /// even, and a less accurate (`docs/accuracy.md`).
    pub fn first_layer(&self) -> f64 {
        self.first_layer_thickness.unwrap_or(if self.skin_levels() > 0 { HALVED_FIRST_LAYER } else { 1.0 })
    }

    /// The same mesh with so many elements along the contact radius, inside and at the surface.
    pub fn uniform(&self, elements: usize) -> Self {
        Self { elements_per_contact_radius: elements, surface_elements_per_contact_radius: None, ..self.clone() }
    }

    /// The same mesh with so many elements along the contact radius inside, and twice as many at
    /// the surface.
    pub fn refined(&self, elements: usize) -> Self {
        Self { surface_elements_per_contact_radius: Some(2 * elements), ..self.uniform(elements) }
    }

    /// How many times the elements at the surface are halved.
    pub fn skin_levels(&self) -> usize {
        let at_surface = self.surface_elements_per_contact_radius.unwrap_or(self.elements_per_contact_radius);
        (at_surface / self.elements_per_contact_radius.max(1)).max(1).ilog2() as usize
    }
}

/// The solution of the equations.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Solver {
    /// The solver of the linear systems.
    pub linear: Linear,
    /// Contact merit at which a step is accepted, relative to the sum of normal forces; in (1e-12,
    /// 1e-2].
    pub tolerance: f64,
    /// Steps of a press from first touch; one that goes on takes its share and two more. By default
    /// as many as the mesh asks for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub press_steps: Option<usize>,
    /// Steps of the first part of a shear segment, in which points come to slip; by default 15.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shear_steps: Option<usize>,
    /// Newton iterations of a step before it is cut in half.
    pub max_iterations: usize,
    /// How often a step may be cut in half.
    pub max_cutbacks: usize,
    /// Whether a coarser run goes before a run, for an eighth of its work: it finds how far the
    /// contact reaches, and limits and errors of the run's curves are estimated from it.
    pub error_estimate: bool,
    /// Memory that the mesh and the linear systems may take, in GiB, whatever the machine has; by
    /// default its share of what the machine has for this process.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_memory_gib: Option<f64>,
}

/// The solver of the linear systems.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Linear {
    /// Multigrid-preconditioned FGMRES.
    Multigrid,
    /// A sparse direct factorisation: the reference, slower.
    Direct,
}

/// What is written besides history and summary.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Output {
    /// When to write the fields.
    pub fields: Fields,
    /// Whether to draw plots.
    pub plots: bool,
    /// In which format they are written.
    #[serde(skip_serializing_if = "is_default")]
    pub plot_format: PictureFormat,
    /// How wide they are; by default as wide as each is laid out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plot_width: Option<PictureWidth>,
    /// Whether the history is written as `history.parquet` too.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub parquet: bool,
    /// Whether the last checkpoint of a run that is done is kept, for a longer path.
    #[serde(skip_serializing_if = "Clone::clone")]
    pub keep_checkpoint: bool,
}

/// The steps after which fields are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Fields {
    /// Never, nor contact tables.
    None,
    /// Never, but contact tables at the end of each segment.
    Contact,
    /// At the end of each segment, with contact tables.
    Segments,
    /// After every step, with contact tables.
    All,
}

impl Fields {
    /// Every value by its name in a case file.
    pub const ALL: [(&'static str, Self); 4] =
        [("none", Self::None), ("contact", Self::Contact), ("segments", Self::Segments), ("all", Self::All)];

    /// Whether there are `fields/*.vtu`; contact tables go with them.
    pub fn has_vtu(self) -> bool {
        matches!(self, Self::Segments | Self::All)
    }
}

impl Default for Mesh {
    fn default() -> Self {
        Self {
            elements_per_contact_radius: 10,
            surface_elements_per_contact_radius: Some(20),
            first_layer_thickness: None,
            fine_zone: 1.3,
            contact_radius: None,
        }
    }
}

impl Default for Solver {
    fn default() -> Self {
        Self {
            linear: Linear::Multigrid,
            tolerance: 1e-4,
            press_steps: None,
            shear_steps: None,
            max_iterations: 25,
            max_cutbacks: 8,
            error_estimate: true,
            max_memory_gib: None,
        }
    }
}

impl Default for Output {
    fn default() -> Self {
        Self {
            fields: Fields::Segments,
            plots: true,
            plot_format: PictureFormat::Svg,
            plot_width: None,
            parquet: false,
            keep_checkpoint: true,
        }
    }
}

/// What is as it would be without a word is not written out: a case file of before stays what it
/// was.
fn is_default(format: &PictureFormat) -> bool {
    *format == PictureFormat::default()
}
