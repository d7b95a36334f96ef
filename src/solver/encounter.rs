//! Contact with another body that deforms: the rows of a plane, at the slave nodes of the interface
//! in their frames (see [`crate::contact::couple`]).

use std::sync::Arc;

use super::system::{Boundary, Trial};
use crate::compute::CaseModel;
use crate::contact::coulomb::{CONTACT_WEIGHT, Friction, Point, Status, contact_rows};
use crate::contact::couple::Interface;
use crate::contact::frame::to_frame;
use crate::contact::pair::leave_even;
use crate::material::Material;
use crate::mesh::Mesh;

/// The interface of two bodies in one step, and where it starts from.
#[derive(Clone, Debug)]
pub struct Encounter {
    /// The interface.
    pub interface: Arc<Interface>,
    /// Relative positions of the undeformed bodies, per slave in its frame.
    reference: Vec<[f64; 3]>,
    /// Relative displacements at the start of the step.
    start: Vec<[f64; 3]>,
    /// Stiffness of the two bodies in series.
    series: Series,
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
}

/// Young's modulus of a material.
pub fn youngs_modulus(material: &Material<f64>) -> f64 {
    let (bulk, shear) = (material.elasticity.bulk, material.elasticity.shear);
    9.0 * bulk * shear / (3.0 * bulk + shear)
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

    /// See [`super::newton::Newton::interface_friction_work`].
    pub(super) fn friction_work(&self, trial: &Trial, before: &[f64]) -> f64 {
        let (after, w) = (trial.interface_forces(self), self.interface.relative(&trial.u));
        let mut work = 0.0;
        for (k, after) in after.iter().enumerate() {
            let node = self.interface.nodes()[k];
            let before = to_frame(&self.interface.frames[k], &[before[3 * node], before[3 * node + 1], before[3 * node + 2]]);
            for c in 0..2 {
                work -= 0.5 * (before[c] + after[c]) * (w[k][c] - self.start[k][c]);
            }
        }
        work
    }
}

impl Trial {
    /// Contact rows of two bodies at the slave nodes, and the residual of the unknowns y.
    pub(super) fn meet_body(&mut self, model: &CaseModel, boundary: &Boundary, encounter: &Encounter) {
        let (mesh, interface) = (&model.mesh, &encounter.interface);
        self.residual.copy_from_slice(&self.force);
        if boundary.is_even() {
            leave_even(&boundary.mirror, &mut self.residual);
        }
        interface.reduce(&mut self.residual);
        self.open_all();
        for (k, w) in interface.relative(&self.u).into_iter().enumerate() {
            let slave = interface.slaves[k];
            let base = 3 * interface.nodes()[k];
            let force = [self.residual[base], self.residual[base + 1], self.residual[base + 2]];
            let slides = boundary.frictionless[slave];
            let point = Point {
                force,
                gap: encounter.reference[k][2] + w[2],
                slip: if slides { [0.0; 2] } else { [0, 1].map(|c| w[c] - encounter.start[k][c]) },
                weight: CONTACT_WEIGHT * encounter.series.modulus * mesh.contact_size[slave],
                on_symmetry_plane: boundary.prescribed[base + 1],
            };
            let rows = contact_rows(if slides { Friction::Coulomb(0.0) } else { model.friction }, &point);
            if rows.status != Status::Open {
                self.force_scale += force[2].abs();
            }
            self.residual[base..base + 3].copy_from_slice(&rows.residual);
            self.interface_force.push(force);
            self.rows[slave] = rows;
        }
    }

    /// What the interface carries at its slaves, in their frames, as [`Trial::point_force`] has the
    /// force of a plane.
    pub(super) fn interface_forces(&self, encounter: &Encounter) -> Vec<[f64; 3]> {
        let projected = |(&slave, force): (&usize, &[f64; 3])| {
            let rows = &self.rows[slave];
            if rows.status == Status::Open {
                return [0.0; 3];
            }
            // On the symmetry plane the row is that of a prescribed displacement.
            let fixed_by_symmetry = encounter.interface.is_on_symmetry_plane(slave);
            let across = if fixed_by_symmetry { 0.0 } else { force[1] - rows.residual[1] };
            [force[0] - rows.residual[0], across, force[2].max(0.0)]
        };
        encounter.interface.slaves.iter().zip(&self.interface_force).map(projected).collect()
    }
}
