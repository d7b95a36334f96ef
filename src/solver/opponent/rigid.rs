//! A rigid sphere: the rows of a plane, each contact node's in the frame of the sphere's surface
//! where it is (see [`crate::contact::rigid`]).
//!
//! Residual, corrections and tangent are in these frames at contact nodes and along the axes
//! elsewhere. The tangent is turned block by block, so that whatever solves its systems finds what
//! it finds over a plane.

use super::dissipation::dissipated;
use super::{Opponent, StepTaken, needed};
use crate::compute::ComputeError;
use crate::compute::handle::CaseHandle;
use crate::contact::coulomb::{CONTACT_WEIGHT, Point, Status, contact_rows};
use crate::contact::frame::{from_frame, to_frame};
use crate::contact::rigid::Rigid;
use crate::mesh::Mesh;
use crate::solver::boundary::Boundary;
use crate::solver::trial::Trial;

/// A rigid sphere, and where the step started.
#[derive(Clone, Debug)]
pub struct RigidSphere {
    surface: Rigid,
    /// Positions of the contact nodes when the step began.
    start: Vec<[f64; 3]>,
}

impl RigidSphere {
    /// The sphere, before any step.
    pub fn new(surface: Rigid) -> Self {
        Self { surface, start: Vec::new() }
    }
}

/// Position of a node.
fn position(mesh: &Mesh, u: &[f64], node: u32) -> [f64; 3] {
    let n = node as usize;
    std::array::from_fn(|i| mesh.nodes[n][i] + u[3 * n + i])
}

/// Turns contact nodes' components of a vector by their frames.
fn turn(trial: &Trial, mesh: &Mesh, x: &mut [f64], by: fn(&[[f64; 3]; 3], &[f64; 3]) -> [f64; 3]) {
    for (frame, &node) in trial.frames.iter().zip(&mesh.contact_nodes) {
        let v = &mut x[3 * node as usize..][..3];
        v.copy_from_slice(&by(frame, &[v[0], v[1], v[2]]));
    }
}

impl Opponent for RigidSphere {
    fn first_gap(&self, x: &[f64; 3]) -> f64 {
        self.surface.gap(x)
    }

    fn contact_point(&self, centre: &[f64; 3]) -> [f64; 3] {
        let ([_, _, n], gap) = (self.surface.frame(centre), self.surface.gap(centre));
        std::array::from_fn(|k| centre[k] - gap * n[k])
    }

    fn set_out(&mut self, mesh: &Mesh, start: &[f64], _expected: &[f64], _symmetric: bool) {
        self.start = mesh.contact_nodes.iter().map(|&node| position(mesh, start, node)).collect();
    }

    fn separate(&self, mesh: &Mesh, guess: &mut [f64]) {
        for &node in &mesh.contact_nodes {
            let x = self.surface.push_out(&position(mesh, guess, node));
            let reference = mesh.nodes[node as usize];
            (0..3).for_each(|c| guess[3 * node as usize + c] = x[c] - reference[c]);
        }
    }

    fn meet(&self, trial: &mut Trial, case: &mut CaseHandle<'_>, boundary: &Boundary) -> Result<(), ComputeError> {
        let (mesh, friction) = (&case.model().mesh, case.model().friction);
        trial.residual.copy_from_slice(&trial.force);
        trial.frames.clear();
        trial.force_scale = 0.0;
        for (i, &node) in mesh.contact_nodes.iter().enumerate() {
            let base = 3 * node as usize;
            let x = position(mesh, &trial.u, node);
            let frame = self.surface.frame(&x);
            let force = to_frame(&frame, &trial.force_at(node));
            let moved = to_frame(&frame, &std::array::from_fn(|c| x[c] - self.start[i][c]));
            let slides = boundary.frictionless[i];
            let point = Point {
                force,
                gap: self.surface.gap(&x),
                slip: if slides { [0.0; 2] } else { [moved[0], moved[1]] },
                weight: CONTACT_WEIGHT * mesh.contact_size[i],
                on_symmetry_plane: boundary.prescribed[base + 1],
            };
            let rows = contact_rows(boundary.friction_at(i, friction), &point);
            if rows.status != Status::Open {
                trial.force_scale += force[2].abs();
            }
            trial.residual[base..base + 3].copy_from_slice(&rows.residual);
            trial.rows[i] = rows;
            trial.frames.push(frame);
        }
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
            let frame = &trial.frames[i];
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
        let nodes = mesh.contact_nodes.iter().zip(&trial.rows).zip(&trial.frames);
        let force = |n: u32, frame| to_frame(frame, &trial.force_at(n));
        nodes.map(|((&n, rows), frame)| needed(rows, force(n, frame), !mesh.is_on_symmetry_plane(n))).collect()
    }

    fn friction_work(&self, _trial: &Trial, step: &StepTaken<'_>) -> f64 {
        let mut work = 0.0;
        for ((after, &status), &node) in step.after.iter().zip(step.statuses).zip(&step.mesh.contact_nodes) {
            let base = 3 * node as usize;
            // Along the surface half-way: across it points come down, and nothing is dissipated.
            let [from, to] = step.displacements.map(|u| position(step.mesh, u, node));
            let frame = self.surface.frame(&std::array::from_fn(|i| 0.5 * (from[i] + to[i])));
            let [along, across, _] = to_frame(&frame, &std::array::from_fn(|i| to[i] - from[i]));
            let before = to_frame(&frame, &[step.before[base], step.before[base + 1], step.before[base + 2]]);
            work += dissipated(step.friction, status, &before, &to_frame(&frame, after), [along, across]);
        }
        work
    }
}
