//! The nonlinear system of one step: residual, merit and the linearised system with its contact
//! rows.

use rayon::prelude::*;

use super::Control;
use super::boundary::Boundary;
use super::opponent::Opponent;
use super::phases::{Lap, Phase, PhaseTimes};
use super::trial::Trial;
use crate::compute::handle::CaseHandle;
use crate::compute::{ComputeError, Evaluated, Fault};
use crate::contact::coulomb::Rows;
use crate::linalg::bsr::BlockMatrix;
use crate::mesh::Mesh;
use crate::real::Real;

impl Trial {
    /// Evaluates forces, contact, residual and merit at `self.u`; what it takes is added to
    /// `times`.
    pub fn evaluate(
        &mut self,
        case: &mut CaseHandle<'_>,
        boundary: &Boundary,
        opponent: &dyn Opponent,
        control: &Control,
        times: &mut PhaseTimes,
    ) -> Result<Evaluated, ComputeError> {
        let mut lap = Lap::start();
        let outcome = case.internal_force(&self.u, &mut self.force)?;
        lap.end(times, Phase::Force);
        if outcome != Evaluated::Valid {
            self.merit = f64::INFINITY;
            return Ok(outcome);
        }
        self.assess(case, boundary, opponent, control, times)
    }

    /// Evaluates contact, residual and merit at `self.u`, taking `self.force` to be the forces
    /// there.
    pub fn assess(
        &mut self,
        case: &mut CaseHandle<'_>,
        boundary: &Boundary,
        opponent: &dyn Opponent,
        control: &Control,
        times: &mut PhaseTimes,
    ) -> Result<Evaluated, ComputeError> {
        let mut lap = Lap::start();
        let mesh = case.model().mesh.clone();
        opponent.meet(self, case, boundary)?;
        self.finish(boundary, control);
        lap.end(times, Phase::Contact);
        Ok(self.finite(&mesh))
    }

    /// Whether all numbers are that decide on the trial or are recorded of it. The forces at points
    /// in contact are looked at one by one: where contact prescribes displacements, they are in no
    /// residual.
    fn finite(&self, mesh: &Mesh) -> Evaluated {
        let at_contact = mesh.contact_nodes.iter().flat_map(|&n| &self.force[3 * n as usize..3 * n as usize + 3]);
        let mut decisive = [self.merit, self.force_scale, self.plate_force].into_iter().chain(at_contact.copied());
        if decisive.all(f64::is_finite) {
            return Evaluated::Valid;
        }
        let first = |numbers: &[f64]| numbers.iter().position(|x| !x.is_finite());
        let at = first(&self.residual).or_else(|| first(&self.force)).map(|i| (i / 3, i % 3));
        Evaluated::Invalid(Fault::Residual { at })
    }

    /// The residual of what is prescribed, the plate's force and the merit.
    fn finish(&mut self, boundary: &Boundary, control: &Control) {
        for (i, &p) in boundary.prescribed.iter().enumerate() {
            if p {
                // Symmetry nodes are at u_y = 0; the plate is handled below.
                self.residual[i] = self.u[i];
            }
        }
        self.plate_force = 0.0;
        for (&n, from_centre) in boundary.plate.iter().zip(&boundary.from_centre) {
            let base = 3 * n as usize;
            let target = control.pose.displacement(self.h, from_centre);
            for i in 0..3 {
                self.residual[base + i] = self.u[base + i] - target[i];
            }
            self.plate_force -= self.force[base + 2];
        }
        let sum: f64 = chunked_sum(self.residual.len(), |i| {
            let r = self.residual[i] * if boundary.prescribed[i] { boundary.weight } else { 1.0 };
            r * r
        });
        let missing = control.normal_force.map_or(0.0, |f| f - self.plate_force);
        self.merit = (sum + missing * missing).sqrt();
    }

    /// Tangential and normal force of the contact on the meshed half of the sphere, [x, y, z].
    pub fn contact_force(&self, mesh: &Mesh, boundary: &Boundary, opponent: &dyn Opponent) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for force in opponent.forces(self, mesh).into_iter().take(boundary.own_contacts) {
            for (s, f) in sum.iter_mut().zip(force) {
                *s += f;
            }
        }
        sum
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
pub fn plate_functional<T: Real>(matrix: &BlockMatrix<T>, plate: &[u32], w: &mut [f64]) {
    w.fill(0.0);
    for &n in plate {
        for k in matrix.pattern.row(n as usize) {
            let base = 3 * matrix.pattern.column[k] as usize;
            for j in 0..3 {
                w[base + j] += matrix.blocks[k][6 + j].to_f64();
            }
        }
    }
}

/// Says which unknowns are prescribed, by boundary or contact.
pub fn fixed_unknowns(mesh: &Mesh, boundary: &Boundary, rows: &[Rows<f64>], fixed: &mut [bool]) {
    fixed.copy_from_slice(&boundary.prescribed);
    for (rows, &node) in rows.iter().zip(&mesh.contact_nodes) {
        let n = node as usize;
        for i in 0..3 {
            fixed[3 * n + i] |= rows.fixed[i];
        }
    }
}

/// Right-hand side of the linear system: minus the residual, and for prescribed unknowns the
/// displacement that is missing.
pub fn right_hand_side(trial: &Trial, mesh: &Mesh, boundary: &Boundary, rhs: &mut [f64]) {
    for (b, r) in rhs.iter_mut().zip(&trial.residual) {
        *b = -r;
    }
    for (rows, &node) in trial.rows.iter().zip(&mesh.contact_nodes) {
        for i in 0..3 {
            let k = 3 * node as usize + i;
            // Contact residuals of prescribed unknowns are stated as forces c g; as displacements
            // they are g.
            if rows.fixed[i] && !boundary.prescribed[k] {
                rhs[k] = -rows.residual[i] / rows.weight;
            }
        }
    }
}
