//! What another opponent than a plane does to a trial: the rows of a plane in the frames of a rigid
//! sphere's surface, or of the interface with another body.

use super::dissipation::dissipated;
use super::encounter::Encounter;
use super::rigid::{Against, position};
use super::system::{Boundary, Meeting, Trial};
use crate::compute::CaseModel;
use crate::contact::coulomb::{CONTACT_WEIGHT, Friction, Point, Status, contact_rows};
use crate::contact::frame::{from_frame, to_frame};
use crate::contact::pair::leave_even;
use crate::mesh::Mesh;

fn between(start: &[f64; 3], end: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|c| end[c] - start[c])
}

impl Meeting {
    /// See [`super::newton::Newton::interface_friction_work`]; of one of the two bodies, half of
    /// what is dissipated between them.
    pub(super) fn friction_work(&self, friction: Friction<f64>, trial: &Trial, before: &[f64]) -> f64 {
        let (after, w) = (trial.pair_forces(self), self.interface.relative(&trial.u));
        let mut carried = before.to_vec();
        self.interface.reduce(&mut carried);
        let mut work = 0.0;
        for (k, after) in after.iter().enumerate() {
            let base = self.interface.base(k);
            let before = [carried[base], carried[base + 1], carried[base + 2]];
            let [along, across, _] = between(&self.start[k], &w[k]);
            // On the seam nothing slips along y, and the number there is no relative one.
            let across = if self.interface.is_free_along_y(k) { 0.0 } else { across };
            work += dissipated(friction, trial.rows[self.interface.slaves[k]].status, &before, after, [along, across]);
        }
        work
    }
}

impl Encounter {
    /// See [`super::newton::Newton::interface_friction_work`].
    pub(super) fn friction_work(&self, friction: Friction<f64>, trial: &Trial, before: &[f64]) -> f64 {
        let (after, w) = (trial.interface_forces(self), self.interface.relative(&trial.u));
        let mut work = 0.0;
        for (k, after) in after.iter().enumerate() {
            let node = self.interface.nodes()[k];
            let before = to_frame(&self.interface.frames[k], &[before[3 * node], before[3 * node + 1], before[3 * node + 2]]);
            let [along, across, _] = between(&self.start[k], &w[k]);
            work += dissipated(friction, trial.rows[self.interface.slaves[k]].status, &before, after, [along, across]);
        }
        work
    }
}

impl Trial {
    /// What the interface of an equal pair carries at its slaves, in their frames, as
    /// [`Trial::point_force`] has the force of a plane.
    pub(super) fn pair_forces(&self, pair: &Meeting) -> Vec<[f64; 3]> {
        let interface = &pair.interface;
        let projected = |(k, force): (usize, &[f64; 3])| {
            let rows = &self.rows[interface.slaves[k]];
            if rows.status == Status::Open {
                return [0.0; 3];
            }
            let across = if interface.is_free_along_y(k) { 0.0 } else { force[1] - rows.residual[1] };
            [force[0] - rows.residual[0], across, force[2].max(0.0)]
        };
        self.interface_force.iter().enumerate().map(projected).collect()
    }

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

impl Trial {
    /// See [`super::newton::Newton::needed_forces`].
    pub(super) fn needed_forces(&self, mesh: &Mesh, boundary: &Boundary) -> Vec<([f64; 3], Status)> {
        if self.rows.is_empty() {
            return Vec::new();
        }
        let of = |i: usize, [x, y, n]: [f64; 3], y_is_free: bool| ([x, if y_is_free { y } else { 0.0 }, n], self.rows[i].status);
        if let Some(encounter) = &boundary.encounter {
            let slaves = encounter.interface.slaves.iter().zip(&self.interface_force);
            return slaves.map(|(&i, force)| of(i, *force, !encounter.interface.is_on_symmetry_plane(i))).collect();
        }
        if let Some(pair) = &boundary.pair {
            let slaves = pair.interface.slaves.iter().zip(&self.interface_force).enumerate();
            return slaves.map(|(k, (&i, force))| of(i, *force, !pair.interface.is_free_along_y(k))).collect();
        }
        let nodes = mesh.contact_nodes.iter().enumerate();
        let force = |node: usize| [0, 1, 2].map(|c| self.force[3 * node + c]);
        let in_frame = |i: usize, force: [f64; 3]| self.frames.get(i).map_or(force, |frame| to_frame(frame, &force));
        nodes.map(|(i, &node)| of(i, in_frame(i, force(node as usize)), mesh.nodes[node as usize][1] != 0.0)).collect()
    }

    /// Contact rows of a rigid sphere, and the residual with them in it.
    pub(super) fn meet_rigid(&mut self, model: &CaseModel, boundary: &Boundary, against: &Against) {
        let mesh = &model.mesh;
        self.residual.copy_from_slice(&self.force);
        self.frames.clear();
        self.force_scale = 0.0;
        for (i, &node) in mesh.contact_nodes.iter().enumerate() {
            let base = 3 * node as usize;
            let x = position(mesh, &self.u, node);
            let frame = against.rigid.frame(&x);
            let force = to_frame(&frame, &[self.force[base], self.force[base + 1], self.force[base + 2]]);
            let moved = to_frame(&frame, &std::array::from_fn(|c| x[c] - against.start[i][c]));
            let slides = boundary.frictionless[i];
            let point = Point {
                force,
                gap: against.rigid.gap(&x),
                slip: if slides { [0.0; 2] } else { [moved[0], moved[1]] },
                weight: CONTACT_WEIGHT * mesh.contact_size[i],
                on_symmetry_plane: boundary.prescribed[base + 1],
            };
            let rows = contact_rows(if slides { Friction::Coulomb(0.0) } else { model.friction }, &point);
            if rows.status != Status::Open {
                self.force_scale += force[2].abs();
            }
            self.residual[base..base + 3].copy_from_slice(&rows.residual);
            self.rows[i] = rows;
            self.frames.push(frame);
        }
    }

    /// Turns contact nodes' components of a vector (three a node) from their frames to the axes.
    pub(super) fn to_axes(&self, mesh: &Mesh, x: &mut [f64]) {
        for (frame, &node) in self.frames.iter().zip(&mesh.contact_nodes) {
            let v = &mut x[3 * node as usize..][..3];
            v.copy_from_slice(&from_frame(frame, &[v[0], v[1], v[2]]));
        }
    }

    /// Turns contact nodes' components of a vector (three a node) from the axes to their frames.
    pub(super) fn to_frames(&self, mesh: &Mesh, x: &mut [f64]) {
        for (frame, &node) in self.frames.iter().zip(&mesh.contact_nodes) {
            let v = &mut x[3 * node as usize..][..3];
            v.copy_from_slice(&to_frame(frame, &[v[0], v[1], v[2]]));
        }
    }

    /// Force of a rigid sphere on a contact point along the axes, as [`Trial::point_force`] has
    /// that of a plane.
    pub(super) fn rigid_point_force(&self, mesh: &Mesh, point: usize) -> [f64; 3] {
        let (rows, node) = (&self.rows[point], mesh.contact_nodes[point] as usize);
        if rows.status == Status::Open {
            return [0.0; 3];
        }
        let frame = &self.frames[point];
        let [t1, t2, n] = to_frame(frame, &[self.force[3 * node], self.force[3 * node + 1], self.force[3 * node + 2]]);
        let across = if mesh.nodes[node][1] == 0.0 { 0.0 } else { t2 - rows.residual[1] };
        from_frame(frame, &[t1 - rows.residual[0], across, n.max(0.0)])
    }
}
