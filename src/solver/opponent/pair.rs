//! The body's own image, turned half round y: an equal pair (see [`crate::contact::pair`]). Of the
//! two bodies one is simulated, whose surface has slaves and masters.

use super::joint::{Bodies, Series};
use crate::contact::pair::PairInterface;
use crate::linalg::LinalgError;
use crate::mesh::Mesh;
use crate::mesh::pattern::Pattern;
use crate::solver::systems::Systems;
use crate::solver::systems::pair::PairSolver;

/// Two equal bodies.
#[derive(Clone, Copy, Debug)]
pub struct EqualPair;

impl Bodies for EqualPair {
    type Interface = PairInterface;
    type Solver = PairSolver;

    /// The master side of the body carries as much again.
    const SIDES: f64 = 2.0;
    const STICKS_IF_EVEN: bool = true;
    const CORRECTS_EVENLY: bool = false;

    fn interface(&self, mesh: &Mesh, u: &[f64]) -> PairInterface {
        PairInterface::new(mesh, u)
    }

    fn series(&self) -> Series {
        Series::new(1.0, 1.0)
    }

    /// The gap to the node's own mirror image.
    /// Half-way to the image of the centre, which is turned half round y.
    fn contact_point(&self, centre: &[f64; 3]) -> [f64; 3] {
        [0.0, centre[1], 0.0]
    }

    fn gap_of_unfaced(&self, height: f64) -> f64 {
        2.0 * height
    }

    fn plan(&self, mesh: &Mesh, pattern: &Pattern, mirror: &[u32]) -> Result<Option<Systems>, LinalgError> {
        Ok(PairSolver::new(mesh, pattern, mirror)?.map(|solver| Systems::Pair(Box::new(solver))))
    }

    fn solver(systems: &mut Systems) -> Option<&mut PairSolver> {
        match systems {
            Systems::Pair(solver) => Some(solver),
            _ => None,
        }
    }
}
