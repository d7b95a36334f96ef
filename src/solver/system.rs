//! The nonlinear system of one step: residual, merit and the linearised system with its contact rows.

use rayon::prelude::*;

use super::phases::{Lap, Phase, PhaseTimes};
use super::{Control, Worst};
use crate::compute::handle::Evaluate;
use crate::compute::{ComputeError, Outcome};
use crate::contact::coulomb::{Friction, Point, Rows, Status, contact_rows};
use crate::contact::plane::gap;
use crate::linalg::bsr::BlockMatrix;
use crate::mesh::Mesh;

/// Which displacements are prescribed, whatever the contact does.
#[derive(Clone, Debug)]
pub struct Boundary {
    /// Nodes of the rigid plate.
    pub plate: Vec<u32>,
    /// Per unknown: prescribed by the plate or by symmetry.
    pub prescribed: Vec<bool>,
    /// Per contact point: slides without friction in the present step, whatever the case says. For points that come into contact within a step
    /// under full stick: where they touch down, and so what they stick to, is not known before its end.
    pub frictionless: Vec<bool>,
    /// Per unknown: a typical stiffness by which a missing prescribed displacement enters the merit.
    pub weight: f64,
}

impl Boundary {
    /// Plate and symmetry plane of a mesh.
    pub fn new(mesh: &Mesh) -> Self {
        let mut prescribed = vec![false; 3 * mesh.nodes.len()];
        for &n in &mesh.symmetry_nodes {
            prescribed[3 * n as usize + 1] = true;
        }
        for &n in &mesh.plate_nodes {
            prescribed[3 * n as usize..3 * n as usize + 3].fill(true);
        }
        let mean_size = mesh.contact_size.iter().sum::<f64>() / mesh.contact_size.len().max(1) as f64;
        let frictionless = vec![false; mesh.contact_nodes.len()];
        Self { plate: mesh.plate_nodes.clone(), prescribed, frictionless, weight: 0.1 * mean_size }
    }

    /// Writes the plate's position into a displacement.
    pub fn place_plate(&self, u: &mut [f64], h: f64, delta_t: f64) {
        for &n in &self.plate {
            u[3 * n as usize..3 * n as usize + 3].copy_from_slice(&[delta_t, 0.0, -h]);
        }
    }
}

/// Everything known at one trial displacement.
#[derive(Clone, Debug)]
pub struct Trial {
    /// Displacement, three a node.
    pub u: Vec<f64>,
    /// Internal force, three a node.
    pub force: Vec<f64>,
    /// Contact conditions of each contact node.
    pub rows: Vec<Rows<f64>>,
    /// Residual: a force; for a prescribed unknown the displacement in excess.
    pub residual: Vec<f64>,
    /// Indentation (an unknown when the normal force is held).
    pub h: f64,
    /// Normal force by which merits are scaled: the sum of f_z over the closed points.
    pub force_scale: f64,
    /// Norm of the residual (free forces, contact residuals, missing normal force), a force.
    pub merit: f64,
    /// Normal force that the plate feels, minus its f_z.
    pub plate_force: f64,
}

impl Trial {
    /// An empty trial for a mesh.
    pub fn new(mesh: &Mesh) -> Self {
        let open = contact_rows(
            Friction::Coulomb(0.0),
            &Point { force: [0.0; 3], gap: 1.0, slip: [0.0; 2], weight: 1.0, on_symmetry_plane: false },
        );
        let n = 3 * mesh.nodes.len();
        Self {
            u: vec![0.0; n],
            force: vec![0.0; n],
            rows: vec![open; mesh.contact_nodes.len()],
            residual: vec![0.0; n],
            h: 0.0,
            force_scale: 0.0,
            merit: f64::INFINITY,
            plate_force: 0.0,
        }
    }

    /// Evaluates forces, contact, residual and merit at `self.u`; what it takes is added to `times`.
    pub fn evaluate(
        &mut self,
        case: &mut dyn Evaluate,
        boundary: &Boundary,
        control: &Control,
        times: &mut PhaseTimes,
    ) -> Result<Outcome, ComputeError> {
        let mut lap = Lap::start();
        let outcome = case.internal_force(&self.u, &mut self.force)?;
        lap.end(times, Phase::Force);
        if outcome != Outcome::Valid {
            self.merit = f64::INFINITY;
            return Ok(outcome);
        }
        self.assess(case, boundary, control, times)
    }

    /// Evaluates contact, residual and merit at `self.u`, taking `self.force` to be the forces there.
    pub fn assess(
        &mut self,
        case: &mut dyn Evaluate,
        boundary: &Boundary,
        control: &Control,
        times: &mut PhaseTimes,
    ) -> Result<Outcome, ComputeError> {
        let mut lap = Lap::start();
        case.contact(&self.u, &self.force, &mut self.rows)?;
        let mesh = case.model().mesh.clone();
        for (i, _) in boundary.frictionless.iter().enumerate().filter(|(_, free)| **free) {
            let base = 3 * mesh.contact_nodes[i] as usize;
            let point = Point {
                force: [self.force[base], self.force[base + 1], self.force[base + 2]],
                gap: gap(mesh.nodes[base / 3][2], self.u[base + 2]),
                slip: [0.0; 2],
                weight: self.rows[i].weight,
                on_symmetry_plane: boundary.prescribed[base + 1],
            };
            self.rows[i] = contact_rows(Friction::Coulomb(0.0), &point);
        }
        self.residual.copy_from_slice(&self.force);
        for (rows, &node) in self.rows.iter().zip(&mesh.contact_nodes) {
            self.residual[3 * node as usize..3 * node as usize + 3].copy_from_slice(&rows.residual);
        }
        for (i, &p) in boundary.prescribed.iter().enumerate() {
            if p {
                // Symmetry nodes are at u_y = 0; the plate is handled below.
                self.residual[i] = self.u[i];
            }
        }
        let target = [control.delta_t, 0.0, -self.h];
        self.plate_force = 0.0;
        for &n in &boundary.plate {
            let base = 3 * n as usize;
            for i in 0..3 {
                self.residual[base + i] = self.u[base + i] - target[i];
            }
            self.plate_force -= self.force[base + 2];
        }
        self.force_scale = self
            .rows
            .iter()
            .zip(&mesh.contact_nodes)
            .filter(|(rows, _)| rows.status != Status::Open)
            .map(|(_, &n)| self.force[3 * n as usize + 2].abs())
            .sum();
        let sum: f64 = chunked_sum(self.residual.len(), |i| {
            let r = self.residual[i] * if boundary.prescribed[i] { boundary.weight } else { 1.0 };
            r * r
        });
        let missing = control.normal_force.map_or(0.0, |f| f - self.plate_force);
        self.merit = (sum + missing * missing).sqrt();
        lap.end(times, Phase::Contact);
        Ok(if self.merit.is_finite() { Outcome::Valid } else { Outcome::Inverted { element: 0, point: 0 } })
    }

    /// Force of the plane on the meshed half, \[x, y, z\]: the sum over the closed points. Along y those on the symmetry plane are left out, whose internal
    /// force balances the other half of the body.
    pub fn contact_force(&self, mesh: &Mesh) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (rows, &n) in self.rows.iter().zip(&mesh.contact_nodes) {
            if rows.status != Status::Open {
                let base = 3 * n as usize;
                sum[0] += self.force[base];
                sum[1] += if mesh.symmetry_nodes.binary_search(&n).is_ok() { 0.0 } else { self.force[base + 1] };
                sum[2] += self.force[base + 2];
            }
        }
        sum
    }

    /// The unknown with the largest residual, over the force `scale`.
    pub fn worst(&self, mesh: &Mesh, boundary: &Boundary, scale: f64) -> Worst {
        let mut worst = Worst::default();
        for (i, &r) in self.residual.iter().enumerate() {
            let r = if boundary.prescribed[i] { r * boundary.weight } else { r } / scale.max(f64::MIN_POSITIVE);
            if r.abs() > worst.residual.abs() {
                worst = Worst { node: i / 3, direction: i % 3, position: mesh.nodes[i / 3], residual: r };
            }
        }
        worst
    }
}

/// A sum over an index range with a fixed order of additions at any thread count.
pub fn chunked_sum(n: usize, term: impl Fn(usize) -> f64 + Sync) -> f64 {
    const CHUNK: usize = 4096;
    let parts: Vec<f64> =
        (0..n.div_ceil(CHUNK)).into_par_iter().map(|c| (c * CHUNK..((c + 1) * CHUNK).min(n)).map(&term).sum()).collect();
    parts.iter().sum()
}

/// Rows of the plate's normal reaction: `w . du` is the change of the plate's summed f_z.
pub fn plate_functional(matrix: &BlockMatrix<f64>, plate: &[u32], w: &mut [f64]) {
    w.fill(0.0);
    for &n in plate {
        for k in matrix.pattern.row(n as usize) {
            let base = 3 * matrix.pattern.column[k] as usize;
            for j in 0..3 {
                w[base + j] += matrix.blocks[k][6 + j];
            }
        }
    }
}

/// Replaces the contact nodes' rows by their contact conditions and says which unknowns are prescribed, by boundary or contact.
///
/// Rows of prescribed unknowns are left as they are: the linear solver takes `fixed` and never reads them.
pub fn apply_contact(matrix: &mut BlockMatrix<f64>, mesh: &Mesh, boundary: &Boundary, rows: &[Rows<f64>], fixed: &mut [bool]) {
    fixed.copy_from_slice(&boundary.prescribed);
    for (rows, &node) in rows.iter().zip(&mesh.contact_nodes) {
        let n = node as usize;
        for i in 0..3 {
            fixed[3 * n + i] |= rows.fixed[i];
        }
        if rows.status != Status::Slip {
            continue;
        }
        let diagonal = matrix.pattern.diagonal[n] as usize;
        for k in matrix.pattern.row(n) {
            let old = matrix.blocks[k];
            let new = &mut matrix.blocks[k];
            for i in 0..3 {
                for j in 0..3 {
                    new[3 * i + j] = (0..3).map(|m| rows.force_rows[i][m] * old[3 * m + j]).sum();
                    if k == diagonal {
                        new[3 * i + j] += rows.displacement_rows[i][j];
                    }
                }
            }
        }
    }
}

/// Right-hand side of the linear system: minus the residual, and for prescribed unknowns the displacement that is missing.
pub fn right_hand_side(trial: &Trial, mesh: &Mesh, boundary: &Boundary, rhs: &mut [f64]) {
    for (b, r) in rhs.iter_mut().zip(&trial.residual) {
        *b = -r;
    }
    for (rows, &node) in trial.rows.iter().zip(&mesh.contact_nodes) {
        for i in 0..3 {
            let k = 3 * node as usize + i;
            // Contact residuals of prescribed unknowns are stated as forces c g; as displacements they are g.
            if rows.fixed[i] && !boundary.prescribed[k] {
                rhs[k] = -rows.residual[i] / rows.weight;
            }
        }
    }
}
