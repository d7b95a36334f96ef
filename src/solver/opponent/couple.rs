//! Another body that deforms (see [`crate::contact::couple`]): two bodies are one mesh, one of them
//! the slave.

use std::ops::Range;

use super::joint::{Bodies, Series};
use crate::contact::couple::CoupleInterface;
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
    pub series: Series,
}

impl TwoBodies {
    /// A sphere of Young's modulus 1 and an opponent of this one. The softer body is the slave, of
    /// equal ones the sphere; if they are `exchanged`, the other one.
    pub fn new(opponent: f64, exchanged: bool) -> Self {
        let (slave, series) = if opponent < 1.0 { (1, Series::new(opponent, 1.0)) } else { (0, Series::new(1.0, opponent)) };
        if exchanged {
            return Self { slave: 1 - slave, series: Series { master_share: 1.0 - series.master_share, ..series } };
        }
        Self { slave, series }
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

    fn series(&self) -> Series {
        self.series
    }

    fn contacts(&self, mesh: &Mesh) -> Range<usize> {
        let (own, all) = (mesh.own_contacts(), mesh.contact_nodes.len());
        if self.slave == 1 { own..all } else { 0..own }
    }

    fn gap_of_unfaced(&self, height: f64) -> f64 {
        height.abs()
    }

    fn plan(&self, mesh: &Mesh, pattern: &Pattern, mirror: &[u32]) -> Result<Option<Systems>, LinalgError> {
        Ok(Some(Systems::Couple(Box::new(CoupleSolver::new(mesh, pattern, self.slave, mirror)?))))
    }

    fn solver(systems: &mut Systems) -> Option<&mut CoupleSolver> {
        match systems {
            Systems::Couple(solver) => Some(solver),
            _ => None,
        }
    }
}
