//! The body's own image: an equal pair (see [`crate::contact::pair`]). Of the two bodies one is
//! simulated, whose surface has slaves and masters.

use super::joint::{Bodies, SpringsInSeries};
use crate::compute::linear::PairTie;
use crate::contact::coulomb::Rows;
use crate::contact::interface::Symmetry;
use crate::contact::pair::{Image, PairInterface};
use crate::linalg::LinalgError;
use crate::mesh::Mesh;
use crate::mesh::pattern::Pattern;
use crate::solver::systems::Systems;
use crate::solver::systems::pair::PairSolver;

/// Two equal bodies.
#[derive(Clone, Copy, Debug)]
pub struct EqualPair {
    /// Where the other one is.
    pub image: Image,
}

impl Bodies for EqualPair {
    type Interface = PairInterface;
    type Solver = PairSolver;

    /// The master side of the body carries as much again.
    const SIDES: f64 = 2.0;
    const STICKS_IF_EVEN: bool = true;
    const CORRECTS_EVENLY: bool = false;

    fn interface(&self, mesh: &Mesh, u: &[f64]) -> PairInterface {
        PairInterface::new(mesh, u, self.image)
    }

    fn series(&self) -> SpringsInSeries {
        SpringsInSeries::new(1.0, 1.0)
    }

    /// Half-way to the image of the centre.
    fn contact_point(&self, centre: &[f64; 3]) -> [f64; 3] {
        match self.image {
            Image::HalfTurn => [0.0, centre[1], 0.0],
            Image::Inversion => [0.0; 3],
        }
    }

    /// The gap to the node's own image.
    fn gap_of_unfaced(&self, height: f64) -> f64 {
        2.0 * height
    }

    /// The image of a body that is even in x, turned half round y, is its mirror image in the
    /// plane. An inverted one's mortar joins no node to its own mirror image where it has its seam.
    fn meets_in_a_plane(&self) -> bool {
        self.image == Image::HalfTurn
    }

    fn symmetry(&self, mesh: &Mesh) -> Symmetry {
        match self.image {
            Image::HalfTurn => Symmetry::mirror(mesh),
            Image::Inversion => Symmetry::turn(mesh),
        }
    }

    fn plan(&self, mesh: &Mesh, pattern: &Pattern, symmetry: &Symmetry) -> Result<Option<Systems>, LinalgError> {
        Ok(PairSolver::new(mesh, pattern, symmetry, self.image)?.map(|solver| Systems::Pair(Box::new(solver))))
    }

    fn tied(&self, systems: &mut Systems, interface: &PairInterface, rows: &[Rows<f64>], prescribed: &[bool]) -> Option<PairTie> {
        let halves = Self::solver(systems)?.halves(interface, rows, prescribed)?;
        Some(PairTie { maps: interface.maps(), halves })
    }

    /// By the mirror's halves, which an inverted image has not.
    fn has_known_systems(&self) -> bool {
        self.image == Image::HalfTurn
    }

    fn solver(systems: &mut Systems) -> Option<&mut PairSolver> {
        match systems {
            Systems::Pair(solver) => Some(solver),
            _ => None,
        }
    }
}
