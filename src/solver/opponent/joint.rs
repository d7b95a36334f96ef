//! Another body that deforms, or the body's own image: the rows of a plane at the slave nodes of an
//! interface, in their frames (see [`crate::contact::interface`]).
//!
//! An equal pair and two bodies differ in the mortar, in what solves their systems, and in what
//! there is of a step that has the bodies' symmetry; [`Bodies`] is that, and the rest is here.

use std::fmt::Debug;
use std::ops::Range;
use std::sync::Arc;

use super::dissipation::dissipated;
use super::{Opponent, StepTaken, needed};
use crate::compute::ComputeError;
use crate::compute::handle::CaseHandle;
use crate::compute::linear::PairTie;
use crate::contact::coulomb::{CONTACT_WEIGHT, Friction, Point, Rows, Status, contact_rows};
use crate::contact::interface::{Interface, Symmetry};
use crate::linalg::{LinalgError, SolverKind};
use crate::mesh::Mesh;
use crate::mesh::pattern::Pattern;
use crate::solver::boundary::Boundary;
use crate::solver::outcome::Halt;
use crate::solver::systems::tied::Tied;
use crate::solver::systems::{Systems, of_another_opponent};
use crate::solver::trial::Trial;

/// Two bodies that deform, as an equal pair and two unlike ones differ.
pub trait Bodies: Debug + Send + Sync {
    /// Their interface.
    type Interface: Interface;
    /// What solves their systems.
    type Solver: Tied<Interface = Self::Interface>;

    /// Sum of the forces on one body's contact nodes, over that of the slaves' forces.
    const SIDES: f64;
    /// Where all has the bodies' symmetry nothing slips, and friction has nothing to do.
    const STICKS_IF_EVEN: bool;
    /// Where all has the bodies' symmetry, corrections are in the unknowns too.
    const CORRECTS_EVENLY: bool;

    /// The interface of a step that is expected to lead to displacement `u`.
    fn interface(&self, mesh: &Mesh, u: &[f64]) -> Self::Interface;

    /// Stiffness of the two as springs in series.
    fn series(&self) -> SpringsInSeries;

    /// See [`Opponent::contacts`].
    fn contacts(&self, mesh: &Mesh) -> Range<usize> {
        0..mesh.own_contacts()
    }

    /// See [`Opponent::contact_point`].
    fn contact_point(&self, centre: &[f64; 3]) -> [f64; 3];

    /// Gap of a contact node at the rim that nothing faces, from its height over the plane between
    /// the undeformed bodies.
    fn gap_of_unfaced(&self, height: f64) -> f64;

    /// Where all has the bodies' symmetry they meet as over the plane between them, which is z = 0,
    /// without friction.
    fn meets_in_a_plane(&self) -> bool {
        false
    }

    /// The symmetry that each body keeps while it is only pressed: the mirror in x, or another one.
    fn symmetry(&self, mesh: &Mesh) -> Symmetry {
        Symmetry::mirror(mesh)
    }

    /// Plans the linear systems of bodies with this symmetry.
    ///
    /// # Errors
    /// As [`Opponent::systems`].
    fn plan(&self, mesh: &Mesh, pattern: &Pattern, symmetry: &Symmetry) -> Result<Option<Systems>, LinalgError>;

    /// See [`Opponent::tied`].
    fn tied(
        &self,
        systems: &mut Systems,
        interface: &Self::Interface,
        rows: &[Rows<f64>],
        prescribed: &[bool],
    ) -> Option<PairTie> {
        let _ = (systems, interface, rows, prescribed);
        None
    }

    /// See [`Opponent::has_known_systems`].
    fn has_known_systems(&self) -> bool {
        false
    }

    /// Their solver, if these are their systems.
    fn solver(systems: &mut Systems) -> Option<&mut Self::Solver>;
}

/// Young's moduli of two bodies as springs in series.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpringsInSeries {
    /// Modulus of both together, E_1 E_2/(E_1 + E_2).
    pub modulus: f64,
    /// The master's share of what both give way.
    pub master_share: f64,
}

impl SpringsInSeries {
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

/// Two bodies and their interface in one step.
#[derive(Debug)]
pub struct Joint<B: Bodies> {
    bodies: B,
    interface: Arc<B::Interface>,
    /// Relative positions of the undeformed bodies, per slave in its frame.
    reference: Vec<[f64; 3]>,
    /// Relative displacements at the start of the step.
    start: Vec<[f64; 3]>,
    /// See [`Bodies::symmetry`].
    symmetry: Symmetry,
    symmetric: bool,
}

impl<B: Bodies> Joint<B> {
    /// The bodies, before any step.
    pub fn new(mesh: &Mesh, bodies: B) -> Self {
        let symmetry = bodies.symmetry(mesh);
        Self { bodies, interface: Arc::default(), reference: Vec::new(), start: Vec::new(), symmetry, symmetric: false }
    }

    /// Whether all of the step has the bodies' symmetry.
    fn is_even(&self) -> bool {
        self.symmetric && !self.symmetry.nodes.is_empty()
    }

    /// What the interface carries at a slave, in its frame, as [`Opponent::forces`] has it.
    fn carried(&self, trial: &Trial) -> Vec<[f64; 3]> {
        let projected = |(k, force): (usize, &[f64; 3])| {
            let rows = &trial.rows[self.interface.slaves()[k]];
            if rows.status == Status::Open {
                return [0.0; 3];
            }
            let across = if self.interface.is_free_along_y(k) { 0.0 } else { force[1] - rows.residual[1] };
            [force[0] - rows.residual[0], across, force[2].max(0.0)]
        };
        trial.interface_force.iter().enumerate().map(projected).collect()
    }

    /// The rows of a slave that carries `force` and is at `w` from what it faces, in its frame.
    fn rows(
        &self,
        k: usize,
        force: [f64; 3],
        w: [f64; 3],
        mesh: &Mesh,
        boundary: &Boundary,
        friction: Friction<f64>,
    ) -> Rows<f64> {
        let slave = self.interface.slaves()[k];
        let on_symmetry_plane = boundary.prescribed[self.interface.base(k) + 1];
        // Where y is free off the symmetry plane, there is no slip along it, nor a force: the row
        // is that of a free node.
        let free_y = self.interface.is_free_along_y(k) && !on_symmetry_plane;
        let slip = |c: usize| w[c] - self.start[k][c];
        let point = Point {
            force: if free_y { [force[0], 0.0, force[2]] } else { force },
            gap: self.reference[k][2] + w[2],
            slip: [slip(0), if free_y { 0.0 } else { slip(1) }],
            weight: CONTACT_WEIGHT * self.bodies.series().modulus * mesh.contact_size[slave],
            on_symmetry_plane,
        };
        let sticks = B::STICKS_IF_EVEN && self.is_even();
        let at_slave = if sticks { Friction::Coulomb(0.0) } else { boundary.friction_at(slave, friction) };
        let mut rows = contact_rows(at_slave, &point);
        if free_y {
            rows.fixed[1] = false;
            rows.residual[1] = force[1];
            rows.force_rows[1] = [0.0, 1.0, 0.0];
            rows.displacement_rows[1] = [0.0; 3];
        }
        if sticks {
            rows.status = even_status(rows.status, friction);
        }
        rows
    }
}

impl<B: Bodies> Opponent for Joint<B> {
    fn systems(&self, mesh: &Arc<Mesh>, _kind: SolverKind) -> Result<Option<Systems>, LinalgError> {
        self.bodies.plan(mesh, &Pattern::from_elements(mesh.nodes.len(), &mesh.elements), &self.symmetry)
    }

    fn refresh(&self, systems: &mut Systems, trial: &Trial, boundary: &Boundary, fixed: &[bool]) -> Result<(), Halt> {
        let solver = B::solver(systems).ok_or_else(of_another_opponent)?;
        solver.tie_mut().take(&self.interface, &trial.rows, fixed, self.is_even());
        Ok(solver.refresh(&boundary.prescribed)?)
    }

    /// Where all is even the host leaves out what rounding adds, and no device does.
    fn tied(&self, systems: &mut Systems, trial: &Trial, boundary: &Boundary) -> Option<PairTie> {
        if self.is_even() {
            return None;
        }
        self.bodies.tied(systems, &self.interface, &trial.rows, &boundary.prescribed)
    }

    fn has_known_systems(&self) -> bool {
        self.bodies.has_known_systems()
    }

    fn contacts(&self, mesh: &Mesh) -> Range<usize> {
        self.bodies.contacts(mesh)
    }

    fn contact_point(&self, centre: &[f64; 3]) -> [f64; 3] {
        self.bodies.contact_point(centre)
    }

    /// The plane between two bodies is the default surface of a case's model.
    fn is_known(&self, even: bool) -> bool {
        even && !self.symmetry.nodes.is_empty() && self.bodies.meets_in_a_plane()
    }

    fn settled(&self, x: &[f64; 3], status: Status, friction: Friction<f64>) -> (Status, f64) {
        (even_status(status, friction), self.bodies.gap_of_unfaced(x[2]))
    }

    fn set_out(&mut self, mesh: &Mesh, start: &[f64], expected: &[f64], symmetric: bool) {
        let interface = self.bodies.interface(mesh, expected);
        (self.reference, self.start) = (interface.relative(mesh.nodes.as_flattened()), interface.relative(start));
        (self.interface, self.symmetric) = (Arc::new(interface), symmetric);
    }

    /// Each side by its share of what both give way.
    fn separate(&self, mesh: &Mesh, guess: &mut [f64]) {
        let (interface, share) = (&self.interface, self.bodies.series().master_share);
        let gap = |w: &[[f64; 3]], k: usize| (self.reference[k][2] + w[k][2]).min(0.0);
        let before = interface.relative(guess);
        for (i, k) in interface.facing().iter().enumerate() {
            let Some(k) = *k else { continue };
            if interface.slaves()[k] != i {
                guess[3 * mesh.contact_nodes[i] as usize + 2] -= share * gap(&before, k);
            }
        }
        let between = interface.relative(guess);
        interface.contract(guess);
        for k in 0..interface.slaves().len() {
            guess[interface.base(k) + 2] -= gap(&between, k);
        }
        interface.expand(guess);
    }

    fn leave_even(&self, x: &mut [f64]) {
        if self.is_even() {
            self.symmetry.leave_even(x);
        }
    }

    fn leave_even_correction(&self, delta: &mut [f64], correction: &mut [f64]) {
        self.leave_even(delta);
        if B::CORRECTS_EVENLY && self.is_even() {
            correction.copy_from_slice(delta);
            self.interface.contract(correction);
        }
    }

    /// At the slave nodes; the residual is that of the unknowns y.
    fn meet(&self, trial: &mut Trial, case: &mut CaseHandle<'_>, boundary: &Boundary) -> Result<(), ComputeError> {
        let model = case.model();
        trial.residual.copy_from_slice(&trial.force);
        self.leave_even(&mut trial.residual);
        self.interface.reduce(&mut trial.residual);
        trial.open_all();
        for (k, w) in self.interface.relative(&trial.u).into_iter().enumerate() {
            let base = self.interface.base(k);
            let force = [trial.residual[base], trial.residual[base + 1], trial.residual[base + 2]];
            let rows = self.rows(k, force, w, &model.mesh, boundary, model.friction);
            if rows.status != Status::Open {
                trial.force_scale += B::SIDES * force[2].abs();
            }
            trial.residual[base..base + 3].copy_from_slice(&rows.residual);
            trial.interface_force.push(force);
            trial.rows[self.interface.slaves()[k]] = rows;
        }
        Ok(())
    }

    fn is_in_matrix(&self) -> bool {
        false
    }

    fn expand(&self, _trial: &Trial, _mesh: &Mesh, x: &mut [f64]) {
        self.interface.expand(x);
    }

    fn contract(&self, _trial: &Trial, _mesh: &Mesh, x: &mut [f64]) {
        self.interface.contract(x);
    }

    /// What the interface's forces come to at the nodes of both sides.
    fn forces(&self, trial: &Trial, _mesh: &Mesh) -> Vec<[f64; 3]> {
        self.interface.nodal(&self.carried(trial))
    }

    fn statuses(&self, trial: &Trial) -> Vec<Status> {
        let of = |k: &Option<usize>| k.map_or(Status::Open, |k| trial.rows[self.interface.slaves()[k]].status);
        self.interface.facing().iter().map(of).collect()
    }

    /// At a master that of the slave that it has most to do with.
    fn gaps(&self, trial: &Trial, mesh: &Mesh) -> Vec<f64> {
        let w = self.interface.relative(&trial.u);
        let alone = |i: usize| {
            let node = mesh.contact_nodes[i] as usize;
            self.bodies.gap_of_unfaced(mesh.nodes[node][2] + trial.u[3 * node + 2])
        };
        let facing = self.interface.facing().iter().enumerate();
        facing.map(|(i, k)| k.map_or_else(|| alone(i), |k| self.reference[k][2] + w[k][2])).collect()
    }

    fn needed_forces(&self, trial: &Trial, _mesh: &Mesh) -> Vec<([f64; 3], Status)> {
        let slaves = self.interface.slaves().iter().zip(&trial.interface_force).enumerate();
        slaves.map(|(k, (&i, force))| needed(&trial.rows[i], *force, !self.interface.is_free_along_y(k))).collect()
    }

    /// All that is dissipated between two bodies; of one of an equal pair's, half of it.
    fn friction_work(&self, trial: &Trial, step: &StepTaken<'_>) -> f64 {
        if B::STICKS_IF_EVEN && self.is_even() {
            return 0.0;
        }
        let (interface, after, w) = (&self.interface, self.carried(trial), self.interface.relative(&trial.u));
        let mut before = step.before.to_vec();
        interface.reduce(&mut before);
        let mut work = 0.0;
        for (k, after) in after.iter().enumerate() {
            let base = interface.base(k);
            let before = [before[base], before[base + 1], before[base + 2]];
            let slip = |c: usize| w[k][c] - self.start[k][c];
            // Where y is free nothing slips along it, and the number there is no relative one.
            let across = if interface.is_free_along_y(k) { 0.0 } else { slip(1) };
            work += dissipated(step.friction, trial.rows[interface.slaves()[k]].status, &before, after, [slip(0), across]);
        }
        work
    }
}

/// What a point does whose rows are those without friction, as nothing slips where all is even.
fn even_status(status: Status, friction: Friction<f64>) -> Status {
    if status == Status::Slip && friction != Friction::Coulomb(0.0) { Status::Stick } else { status }
}
