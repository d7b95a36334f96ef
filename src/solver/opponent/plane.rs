//! The rigid plane z = 0: backends state its conditions (see [`crate::contact::plane`]).

use super::dissipation::dissipated;
use super::{Opponent, StepTaken, needed};
use crate::compute::ComputeError;
use crate::compute::handle::CaseHandle;
use crate::contact::coulomb::{Friction, Point, Status, contact_rows};
use crate::contact::plane::gap;
use crate::mesh::Mesh;
use crate::solver::boundary::Boundary;
use crate::solver::trial::Trial;

/// The rigid plane.
#[derive(Clone, Copy, Debug)]
pub struct Plane;

impl Opponent for Plane {
    fn is_plane(&self) -> bool {
        true
    }

    fn separate(&self, mesh: &Mesh, guess: &mut [f64]) {
        for &node in &mesh.contact_nodes {
            let z = 3 * node as usize + 2;
            guess[z] -= gap(mesh.nodes[node as usize][2], guess[z]).min(0.0);
        }
    }

    fn meet(&self, trial: &mut Trial, case: &mut CaseHandle<'_>, boundary: &Boundary) -> Result<(), ComputeError> {
        case.contact(&trial.u, &trial.force, &mut trial.rows)?;
        take_rows(trial, &case.model().mesh, boundary);
        Ok(())
    }

    fn forces(&self, trial: &Trial, mesh: &Mesh) -> Vec<[f64; 3]> {
        let force = |i: usize| {
            let (rows, node) = (&trial.rows[i], mesh.contact_nodes[i] as usize);
            if rows.status == Status::Open {
                return [0.0; 3];
            }
            let tangential = |c: usize| trial.force[3 * node + c] - rows.residual[c];
            let across = if mesh.is_on_symmetry_plane(node as u32) { 0.0 } else { tangential(1) };
            [tangential(0), across, trial.force[3 * node + 2].max(0.0)]
        };
        (0..trial.rows.len()).map(force).collect()
    }

    fn gaps(&self, trial: &Trial, mesh: &Mesh) -> Vec<f64> {
        mesh.contact_nodes.iter().map(|&n| gap(mesh.nodes[n as usize][2], trial.u[3 * n as usize + 2])).collect()
    }

    fn needed_forces(&self, trial: &Trial, mesh: &Mesh) -> Vec<([f64; 3], Status)> {
        let nodes = mesh.contact_nodes.iter().zip(&trial.rows);
        nodes.map(|(&n, rows)| needed(rows, trial.force_at(n), !mesh.is_on_symmetry_plane(n))).collect()
    }

    fn friction_work(&self, _trial: &Trial, step: &StepTaken<'_>) -> f64 {
        let [from, to] = step.displacements;
        let mut work = 0.0;
        for ((after, &status), &node) in step.after.iter().zip(step.statuses).zip(&step.mesh.contact_nodes) {
            let base = 3 * node as usize;
            let slip = [0, 1].map(|i| to[base + i] - from[base + i]);
            let before = [step.before[base], step.before[base + 1], step.before[base + 2]];
            work += dissipated(step.friction, status, &before, after, slip);
        }
        work
    }
}

/// Takes over the rows that the backend has stated over a plane: those of points that slide without
/// friction, or stick whatever the case says, are stated here, and all stand in the residual.
fn take_rows(trial: &mut Trial, mesh: &Mesh, boundary: &Boundary) {
    for (i, _) in boundary.frictionless.iter().enumerate().filter(|(_, free)| **free || boundary.stuck) {
        let node = mesh.contact_nodes[i];
        let base = 3 * node as usize;
        let point = Point {
            force: trial.force_at(node),
            gap: gap(mesh.nodes[base / 3][2], trial.u[base + 2]),
            slip: [0.0; 2],
            weight: trial.rows[i].weight,
            on_symmetry_plane: boundary.prescribed[base + 1],
        };
        trial.rows[i] = contact_rows(boundary.friction_at(i, Friction::Coulomb(0.0)), &point);
    }
    trial.residual.copy_from_slice(&trial.force);
    for (rows, &node) in trial.rows.iter().zip(&mesh.contact_nodes) {
        trial.residual[3 * node as usize..3 * node as usize + 3].copy_from_slice(&rows.residual);
    }
    trial.force_scale = trial
        .rows
        .iter()
        .zip(&mesh.contact_nodes)
        .filter(|(rows, _)| rows.status != Status::Open)
        .map(|(_, &n)| trial.force[3 * n as usize + 2].abs())
        .sum();
}
