//! Another body that deforms (see [`crate::contact::couple`]): two bodies are one mesh, one of them
//! the slave.

use std::ops::Range;

use super::joint::{Bodies, SpringsInSeries};
use crate::contact::couple::CoupleInterface;
use crate::contact::interface::Symmetry;
use crate::linalg::LinalgError;
use crate::mesh::Mesh;
use crate::mesh::pattern::Pattern;
use crate::solver::systems::Systems;
use crate::solver::systems::couple::CoupleSolver;

/// Two bodies that both deform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoBodies {
    /// Which of them is the slave: 0 the sphere, 1 the opponent.
    pub slave: usize,
    /// What they are in series.
    pub series: SpringsInSeries,
    /// Radius of the opponent; `None` of a flat.
    pub radius: Option<f64>,
}

impl TwoBodies {
    /// A sphere of Young's modulus and radius 1 and an opponent of these. The softer body is the
    /// slave, of equal ones the sphere; if they are `exchanged`, the other one.
    pub fn new(opponent: f64, radius: Option<f64>, exchanged: bool) -> Self {
        let (slave, series) =
            if opponent < 1.0 { (1, SpringsInSeries::new(opponent, 1.0)) } else { (0, SpringsInSeries::new(1.0, opponent)) };
        if exchanged {
            return Self {
                slave: 1 - slave,
                series: SpringsInSeries { master_share: 1.0 - series.master_share, ..series },
                radius,
            };
        }
        Self { slave, series, radius }
    }
}

impl Bodies for TwoBodies {
    type Interface = CoupleInterface;
    type Solver = CoupleSolver;

    const SIDES: f64 = 1.0;
    const STICKS_IF_EVEN: bool = false;
    const CORRECTS_EVENLY: bool = true;

    /// What bends less says where the interface goes.
    fn interface(&self, mesh: &Mesh, u: &[f64]) -> CoupleInterface {
        CoupleInterface::new(mesh, u, self.slave, 1.0 - self.series.master_share)
    }

    fn series(&self) -> SpringsInSeries {
        self.series
    }

    fn contacts(&self, mesh: &Mesh) -> Range<usize> {
        let (own, all) = (mesh.own_contacts(), mesh.contact_nodes.len());
        if self.slave == 1 { own..all } else { 0..own }
    }

    /// Of two spheres that divides the line of centres as their radii do.
    fn contact_point(&self, centre: &[f64; 3]) -> [f64; 3] {
        let [x, y, z] = *centre;
        match self.radius {
            Some(radius) => {
                let share = radius / (1.0 + radius);
                [share * x, share * y, share * (z + radius) - radius]
            }
            None => [x, y, 0.0],
        }
    }

    fn gap_of_unfaced(&self, height: f64) -> f64 {
        height.abs()
    }

    fn plan(&self, mesh: &Mesh, pattern: &Pattern, symmetry: &Symmetry) -> Result<Option<Systems>, LinalgError> {
        Ok(Some(Systems::Couple(Box::new(CoupleSolver::new(mesh, pattern, self.slave, symmetry)?))))
    }

    fn solver(systems: &mut Systems) -> Option<&mut CoupleSolver> {
        match systems {
            Systems::Couple(solver) => Some(solver),
            _ => None,
        }
    }
}
