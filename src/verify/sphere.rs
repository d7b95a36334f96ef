//! The checks' sphere, its cases, and the history of one.

use crate::case::{
    Case, Contact, Equator, Fields, Friction, Hardening, Hold, Material, Mesh, Output, Segment, ShearTarget, Solver, Sphere,
    UnitLabels,
};
use crate::output::{ContactPoint, StepRecord};

/// Radius and Young's modulus of the checks' sphere: lengths in radii, stresses in MPa.
pub const RADIUS: f64 = 1.0;
/// See [`RADIUS`].
pub const YOUNGS_MODULUS: f64 = 200e3;

/// The accepted steps of a case, in the case's units; forces and energies of the whole sphere.
#[derive(Clone, Debug, Default)]
pub struct History {
    /// All rows, the undeformed state first.
    pub rows: Vec<StepRecord>,
    /// The whole contact at the end of the path.
    pub contact: Vec<ContactPoint>,
}

impl History {
    /// The rows of one segment of the path, in order.
    pub fn segment(&self, segment: usize) -> impl Iterator<Item = &StepRecord> {
        self.rows.iter().filter(move |row| row.segment == segment && row.step > 0)
    }

    /// The last row of a segment; all zero if it has none.
    pub fn end(&self, segment: usize) -> StepRecord {
        self.segment(segment).last().copied().unwrap_or_default()
    }

    /// The last row.
    pub fn last(&self) -> StepRecord {
        self.rows.last().copied().unwrap_or_default()
    }
}

/// A case on the checks' sphere, with default numerics; nothing is written.
pub fn sphere(poissons_ratio: f64, hardening: Hardening, friction: f64, elements: usize, path: Vec<Segment>) -> Case {
    Case {
        opponent: None,
        sphere: Sphere { radius: RADIUS, flat: false, equator: Equator::Clamped },
        material: Material { youngs_modulus: YOUNGS_MODULUS, poissons_ratio, hardening },
        contact: Contact { friction: Friction::Coefficient(friction) },
        mesh: Mesh::default().uniform(elements),
        solver: Solver::default(),
        output: Output { fields: Fields::None, plots: false, ..Output::default() },
        units: UnitLabels::default(),
        path,
    }
}

/// A segment that presses, or unloads, to `h`.
pub fn press(h: f64) -> Segment {
    Segment::Indentation { indentation: h }
}

/// A segment that shears to `d`.
pub fn shear(d: f64, hold: Hold) -> Segment {
    Segment::Shear { shear: ShearTarget::Displacement(d), hold }
}

/// A segment that shears to full slip at constant h.
pub fn full_slip() -> Segment {
    Segment::Shear { shear: ShearTarget::FullSlip, hold: Hold::Indentation }
}
