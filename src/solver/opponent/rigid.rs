//! A rigid plane or sphere: the rows of a plane, each contact node's in the frame of the surface
//! where it is (see [`crate::contact::rigid`]). Backends state them.
//!
//! Residual, corrections and tangent are in these frames at contact nodes and along the axes
//! elsewhere. The tangent is turned block by block, so that whatever solves its systems finds what
//! it finds over a plane. There all frames are the axes, and none are kept.

use super::dissipation::dissipated;
use super::{Opponent, StepTaken, needed};
use crate::compute::ComputeError;
use crate::compute::handle::CaseHandle;
use crate::contact::coulomb::{Friction, Point, Status, contact_rows};
use crate::contact::frame::{AXES, ContactFrame, from_frame, to_frame};
use crate::contact::rigid::Rigid;
use crate::mesh::Mesh;
use crate::solver::boundary::Boundary;
use crate::solver::trial::Trial;

/// A rigid body; the default is the plane.
#[derive(Clone, Copy, Debug, Default)]
pub struct RigidBody {
    /// Its surface.
    pub surface: Rigid,
}

/// Position of a node.
fn position(mesh: &Mesh, u: &[f64], node: u32) -> [f64; 3] {
    let n = node as usize;
    std::array::from_fn(|i| mesh.nodes[n][i] + u[3 * n + i])
}

/// The frame of a contact point.
fn frame_at(trial: &Trial, point: usize) -> &ContactFrame {
    trial.frames.get(point).unwrap_or(&AXES)
}

/// Turns contact nodes' components of a vector by their frames.
fn turn(trial: &Trial, mesh: &Mesh, x: &mut [f64], by: fn(&ContactFrame, &[f64; 3]) -> [f64; 3]) {
    for (frame, &node) in trial.frames.iter().zip(&mesh.contact_nodes) {
        let v = &mut x[3 * node as usize..][..3];
        v.copy_from_slice(&by(frame, &[v[0], v[1], v[2]]));
    }
}

impl Opponent for RigidBody {
    fn is_rigid(&self) -> bool {
        true
    }

    fn first_gap(&self, x: &[f64; 3]) -> f64 {
        self.surface.gap(x)
    }

    fn contact_point(&self, centre: &[f64; 3]) -> [f64; 3] {
        let ([_, _, n], gap) = (self.surface.frame(centre), self.surface.gap(centre));
        std::array::from_fn(|k| centre[k] - gap * n[k])
    }

    fn separate(&self, mesh: &Mesh, guess: &mut [f64]) {
        for &node in &mesh.contact_nodes {
            let out = self.surface.push_out(&position(mesh, guess, node));
            (0..3).for_each(|c| guess[3 * node as usize + c] += out[c]);
        }
    }

    fn meet(&self, trial: &mut Trial, case: &mut CaseHandle<'_>, boundary: &Boundary) -> Result<(), ComputeError> {
        case.contact(&trial.u, &trial.force, &mut trial.rows)?;
        let mesh = &case.model().mesh;
        trial.frames.clear();
        if !self.surface.is_plane() {
            trial.frames.extend(mesh.contact_nodes.iter().map(|&node| self.surface.frame(&position(mesh, &trial.u, node))));
        }
        self.take_rows(trial, mesh, boundary);
        Ok(())
    }

    fn expand(&self, trial: &Trial, mesh: &Mesh, x: &mut [f64]) {
        turn(trial, mesh, x, from_frame);
    }

    fn contract(&self, trial: &Trial, mesh: &Mesh, x: &mut [f64]) {
        turn(trial, mesh, x, to_frame);
    }

    fn forces(&self, trial: &Trial, mesh: &Mesh) -> Vec<[f64; 3]> {
        let force = |i: usize| {
            let (rows, node) = (&trial.rows[i], mesh.contact_nodes[i]);
            if rows.status == Status::Open {
                return [0.0; 3];
            }
            let frame = frame_at(trial, i);
            let [t1, t2, n] = to_frame(frame, &trial.force_at(node));
            let across = if mesh.is_on_symmetry_plane(node) { 0.0 } else { t2 - rows.residual[1] };
            from_frame(frame, &[t1 - rows.residual[0], across, n.max(0.0)])
        };
        (0..trial.rows.len()).map(force).collect()
    }

    fn gaps(&self, trial: &Trial, mesh: &Mesh) -> Vec<f64> {
        mesh.contact_nodes.iter().map(|&n| self.surface.gap(&position(mesh, &trial.u, n))).collect()
    }

    fn needed_forces(&self, trial: &Trial, mesh: &Mesh) -> Vec<([f64; 3], Status)> {
        // There are no rows before the first step.
        let nodes = mesh.contact_nodes.iter().zip(&trial.rows).enumerate();
        let force = |i: usize, node: u32| to_frame(frame_at(trial, i), &trial.force_at(node));
        nodes.map(|(i, (&node, rows))| needed(rows, force(i, node), !mesh.is_on_symmetry_plane(node))).collect()
    }

    fn friction_work(&self, _trial: &Trial, step: &StepTaken<'_>) -> f64 {
        let mut work = 0.0;
        for ((after, &status), &node) in step.after.iter().zip(step.statuses).zip(&step.mesh.contact_nodes) {
            let base = 3 * node as usize;
            let [from, to] = step.displacements.map(|u| [u[base], u[base + 1], u[base + 2]]);
            // Along the surface half-way: across it points come down, and nothing is dissipated.
            let reference = step.mesh.nodes[node as usize];
            let frame = self.surface.frame(&std::array::from_fn(|i| reference[i] + 0.5 * (from[i] + to[i])));
            let [along, across, _] = to_frame(&frame, &std::array::from_fn(|i| to[i] - from[i]));
            let before = to_frame(&frame, &[step.before[base], step.before[base + 1], step.before[base + 2]]);
            work += dissipated(step.friction, status, &before, &to_frame(&frame, after), [along, across]);
        }
        work
    }
}

impl RigidBody {
    /// Takes over the rows that the backend has stated: those of points that slide without
    /// friction, or stick whatever the case says, are stated here, and all stand in the residual.
    fn take_rows(&self, trial: &mut Trial, mesh: &Mesh, boundary: &Boundary) {
        for (i, _) in boundary.frictionless.iter().enumerate().filter(|(_, free)| **free || boundary.stuck) {
            let node = mesh.contact_nodes[i];
            let point = Point {
                force: to_frame(frame_at(trial, i), &trial.force_at(node)),
                gap: self.surface.gap(&position(mesh, &trial.u, node)),
                slip: [0.0; 2],
                weight: trial.rows[i].weight,
                on_symmetry_plane: boundary.prescribed[3 * node as usize + 1],
            };
            trial.rows[i] = contact_rows(boundary.friction_at(i, Friction::Coulomb(0.0)), &point);
        }
        trial.residual.copy_from_slice(&trial.force);
        for (rows, &node) in trial.rows.iter().zip(&mesh.contact_nodes) {
            trial.residual[3 * node as usize..][..3].copy_from_slice(&rows.residual);
        }
        let closed = trial.rows.iter().zip(&mesh.contact_nodes).enumerate().filter(|(_, (rows, _))| rows.status != Status::Open);
        trial.force_scale = closed.map(|(i, (_, &n))| to_frame(frame_at(trial, i), &trial.force_at(n))[2].abs()).sum();
    }
}
