//! Contact with another body that deforms: the rows of a plane, at the slave nodes of the interface
//! in their frames (see [`crate::contact::couple`]).

use std::sync::Arc;

use crate::contact::couple::Interface;
use crate::mesh::Mesh;

/// The interface of two bodies in one step, and where it starts from.
#[derive(Clone, Debug)]
pub struct Encounter {
    /// The interface.
    pub interface: Arc<Interface>,
    /// Relative positions of the undeformed bodies, per slave in its frame.
    pub(super) reference: Vec<[f64; 3]>,
    /// Relative displacements at the start of the step.
    pub(super) start: Vec<[f64; 3]>,
    /// Stiffness of the two bodies in series.
    pub(super) series: Series,
    /// All is even in x.
    pub symmetric: bool,
}

/// Young's moduli of two bodies as springs in series.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Series {
    /// Modulus of both together, E_1 E_2/(E_1 + E_2).
    pub modulus: f64,
    /// The master's share of what both give way.
    pub master_share: f64,
}

impl Series {
    /// Of the slave's and the master's modulus.
    pub fn new(slave: f64, master: f64) -> Self {
        Self { modulus: slave * master / (slave + master), master_share: slave / (slave + master) }
    }

    /// How many times as stiff as the other the stiffer body is.
    pub fn contrast(&self) -> f64 {
        let other = 1.0 - self.master_share;
        self.master_share.max(other) / self.master_share.min(other)
    }
}

impl Encounter {
    /// The interface of a step that starts from displacement `start` and is expected to lead to
    /// `expected` (three a node), with body `slave` (0 the sphere, 1 the opponent) as the slave;
    /// both displacements and the step are even in x if it is `symmetric`.
    pub fn new(mesh: &Mesh, (slave, series): (usize, Series), start: &[f64], expected: &[f64], symmetric: bool) -> Self {
        // What bends less says where the interface goes.
        let interface = Arc::new(Interface::new(mesh, expected, slave, 1.0 - series.master_share));
        let reference = interface.relative(mesh.nodes.as_flattened());
        Self { reference, start: interface.relative(start), interface, series, symmetric }
    }

    /// Moves points of a guess that have passed the other body back to it, each side by its share
    /// of what both give way.
    pub fn separate(&self, mesh: &Mesh, guess: &mut [f64]) {
        let gap = |w: &[[f64; 3]], k: usize| (self.reference[k][2] + w[k][2]).min(0.0);
        let before = self.interface.relative(guess);
        for (i, k) in self.interface.facing.iter().enumerate() {
            let Some(k) = *k else { continue };
            if self.interface.slaves[k] != i {
                guess[3 * mesh.contact_nodes[i] as usize + 2] -= self.series.master_share * gap(&before, k);
            }
        }
        let between = self.interface.relative(guess);
        self.interface.contract(guess);
        for (k, &slave) in self.interface.slaves.iter().enumerate() {
            guess[3 * mesh.contact_nodes[slave] as usize + 2] -= gap(&between, k);
        }
        self.interface.expand(guess);
    }

    /// Gap at each contact node of both bodies, at a master that of the slave that it has most to
    /// do with. A node at the rim that nothing faces has its height over the plane between them.
    pub fn gaps(&self, mesh: &Mesh, u: &[f64]) -> Vec<f64> {
        let w = self.interface.relative(u);
        let height = |i: usize| {
            let node = mesh.contact_nodes[i] as usize;
            (mesh.nodes[node][2] + u[3 * node + 2]).abs()
        };
        let facing = self.interface.facing.iter().enumerate();
        facing.map(|(i, k)| k.map_or_else(|| height(i), |k| self.reference[k][2] + w[k][2])).collect()
    }
}
