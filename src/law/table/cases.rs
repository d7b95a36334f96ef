//! What is simulated for a table.

use crate::case::{Case, Friction, Hold, Segment, ShearTarget};

/// Share of F_N that the release at the end leaves.
const LEFT: f64 = 0.5;

/// The case of the study at one of its depths: pressed, sheared to full slip and back, and released
/// by half; on so many elements along the contact radius and twice as many at the surface, with a
/// companion, so that its curves are those of the limit of fine meshes.
pub fn case_of(case: &Case, elements: usize) -> Case {
    let mut case = case.clone();
    case.mesh = case.mesh.refined(elements);
    case.mesh.contact_radius = None;
    case.solver.error_estimate = true;
    case.output.fields = crate::case::Fields::None;
    case.output.plots = false;
    case.path = vec![Segment::Indentation { indentation: 0.01 * case.effective_radius() }];
    if case.contact.friction != Friction::Coefficient(0.0) {
        let shear = |shear| Segment::Shear { shear, hold: Hold::Indentation };
        case.path.extend([shear(ShearTarget::FullSlip), shear(ShearTarget::Displacement(0.0))]);
    }
    case.path.push(Segment::Release { share: LEFT });
    case
}
