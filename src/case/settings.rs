//! How a case is meshed and solved, and what is written: the tables that may be left out, with what
//! stands where nothing is said.

use serde::Serialize;

use super::pictures::{PictureFormat, PictureWidth};
use crate::mesh::LARGEST_CONTACT;

/// Smallest and largest a/R that the sphere is meshed for.
pub(crate) const CONTACT_RADII: (f64, f64) = (0.0005, LARGEST_CONTACT);

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
    /// Steps of the first part of a shear segment, in which points come to slip; by default 24.
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
