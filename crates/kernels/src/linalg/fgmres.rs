//! Flexible GMRES with restarts (Saad, SIAM J. Sci. Comput. 14, 1993, Algorithm 2.2): right
//! preconditioning by anything, here a multigrid cycle in f32.
//!
//! The basis may be f32 or f64. In f32 each restart is a step of iterative refinement: residuals
//! and solution stay in f64.

use rayon::prelude::*;

use super::vector::{CHUNK, chunk_dot, norm, parallel};
use crate::real::Real;

/// What FGMRES needs to know of a linear system A x = b, its basis in precision `T`.
pub trait System<T> {
    /// z, about A^-1 v, and w = A z. The approximation may differ from call to call. `v` has unit
    /// norm.
    fn step(&mut self, v: &[T], z: &mut [f32], w: &mut [T]);
    /// r = b - A x, to full accuracy.
    fn residual(&self, b: &[f64], x: &[f64], r: &mut [f64]);
}

/// In units of the basis' precision: where a cycle goes no lower than this share of where it began,
/// its recurrence is good to better than the 2 % that the iteration aims below the tolerance.
const FAR_FROM_ROUNDING: f64 = 1e4;

/// How an iteration ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FgmresReport {
    /// Preconditioned matrix products spent.
    pub iterations: usize,
    /// |b - A x| / |b|, recomputed from x; by the recurrence where its rounding is too small to
    /// matter beside the tolerance.
    pub residual: f64,
    /// The tolerance was met.
    pub converged: bool,
    /// The iteration gave up: no progress over a whole restart, or not a number.
    pub stagnated: bool,
}

/// The workspace of FGMRES, kept between solves: nothing is allocated in an iteration.
#[derive(Clone, Debug)]
pub struct Fgmres<T> {
    restart: usize,
    residual: Vec<f64>,
    /// Orthonormal basis, `restart + 1` vectors one after another.
    basis: Vec<T>,
    /// Preconditioned basis, `restart` vectors.
    preconditioned: Vec<f32>,
    /// Upper triangle left of the Hessenberg matrix by Givens rotations: column j starts at j (j +
    /// 1) / 2.
    triangle: Vec<f64>,
    rotations: Vec<[f64; 2]>,
    /// Rotated right-hand side of the least-squares problem.
    target: Vec<f64>,
    column: Vec<f64>,
    partial: Vec<f64>,
}

impl<T: Real> Fgmres<T> {
    /// A workspace for systems of `unknowns` unknowns and restarts after `restart` (at least 1)
    /// iterations. Basis vectors are only allocated once they are reached.
    pub fn new(unknowns: usize, restart: usize) -> Self {
        let restart = restart.max(1);
        Self {
            restart,
            residual: vec![0.0; unknowns],
            basis: Vec::new(),
            preconditioned: Vec::new(),
            triangle: vec![0.0; restart * (restart + 1) / 2],
            rotations: vec![[0.0; 2]; restart],
            target: vec![0.0; restart + 1],
            column: vec![0.0; restart + 1],
            partial: vec![0.0; unknowns.div_ceil(CHUNK) * (restart + 1)],
        }
    }

    /// Improves `x` until |b - A x| <= tolerance |b| or `max_iterations` are spent. Never panics on
    /// numbers that are not finite: it stops and says stagnated.
    pub fn solve(
        &mut self,
        system: &mut impl System<T>,
        b: &[f64],
        x: &mut [f64],
        tolerance: f64,
        max_iterations: usize,
    ) -> FgmresReport {
        let n = b.len();
        let b_norm = norm(b);
        let mut report = FgmresReport { iterations: 0, residual: 0.0, converged: true, stagnated: false };
        if b_norm == 0.0 {
            x.fill(0.0);
            return report;
        }
        loop {
            if report.iterations == 0 && x.iter().all(|x| *x == 0.0) {
                self.residual.copy_from_slice(b);
            } else {
                system.residual(b, x, &mut self.residual);
            }
            let r_norm = norm(&self.residual);
            let before = report.residual;
            report.residual = r_norm / b_norm;
            report.converged = report.residual <= tolerance;
            // A restart that gains less than 10 % will not get there; rounding may also put the
            // tolerance out of reach.
            let stuck = report.iterations > 0 && report.residual > 0.9 * before;
            report.stagnated = !report.converged && (stuck || !report.residual.is_finite());
            if report.converged || report.stagnated || report.iterations >= max_iterations {
                return report;
            }
            self.basis.resize(self.basis.len().max(n), T::ZERO);
            self.basis.iter_mut().zip(&self.residual).for_each(|(v, r)| *v = T::of(r / r_norm));
            self.target[0] = r_norm;
            // Aim a little lower than asked, so that rounding in the recurrence does not cost a
            // restart; but not below what the basis can resolve.
            let goal = (0.98 * tolerance * b_norm).max(100.0 * T::EPSILON.to_f64() * r_norm);
            let cycle = self.restart.min(max_iterations - report.iterations);
            let steps = self.cycle(system, n, goal, cycle);
            report.iterations += steps;
            if steps == 0 {
                report.stagnated = true;
                return report;
            }
            self.back_substitute(steps);
            add_combination(x, &self.preconditioned, &self.column[..steps]);
            // Rounding moves what the recurrence says by a few epsilon of where it began; without a
            // new direction it says 0, whatever is left.
            let told = self.target[steps].abs();
            if told > 0.0 && told <= goal && goal >= FAR_FROM_ROUNDING * T::EPSILON.to_f64() * r_norm {
                return FgmresReport { residual: told / b_norm, converged: true, ..report };
            }
        }
    }

    /// Arnoldi steps until the residual estimate meets `goal` or `steps` are done; returns how many
    /// are usable.
    fn cycle(&mut self, system: &mut impl System<T>, n: usize, goal: f64, steps: usize) -> usize {
        for j in 0..steps {
            self.basis.resize(self.basis.len().max((j + 2) * n), T::ZERO);
            self.preconditioned.resize(self.preconditioned.len().max((j + 1) * n), 0.0);
            let (basis, rest) = self.basis.split_at_mut((j + 1) * n);
            let w = &mut rest[..n];
            let z = &mut self.preconditioned[j * n..(j + 1) * n];
            system.step(&basis[j * n..], z, w);
            let h = &mut self.column[..j + 2];
            let norm_before = norm(w);
            if !norm_before.is_finite() {
                return j;
            }
            h.fill(0.0);
            h[j + 1] = orthogonalise(basis, w, h, &mut self.partial);
            // Classical Gram-Schmidt loses orthogonality where most of w is cancelled: once more
            // then ("twice is enough").
            if h[j + 1] < 0.1 * norm_before {
                h[j + 1] = orthogonalise(basis, w, h, &mut self.partial);
            }
            let independent = h[j + 1] > 10.0 * T::EPSILON.to_f64() * norm_before;
            if independent {
                scale(w, 1.0 / h[j + 1]);
            } else {
                h[j + 1] = 0.0;
            }
            for (i, &[c, s]) in self.rotations[..j].iter().enumerate() {
                (h[i], h[i + 1]) = (c * h[i] + s * h[i + 1], c * h[i + 1] - s * h[i]);
            }
            let length = h[j].hypot(h[j + 1]);
            if length == 0.0 {
                return j; // A z = 0 to rounding: this direction is of no use
            }
            let [c, s] = [h[j] / length, h[j + 1] / length];
            self.rotations[j] = [c, s];
            h[j] = length;
            self.triangle[j * (j + 1) / 2..][..=j].copy_from_slice(&h[..=j]);
            (self.target[j], self.target[j + 1]) = (c * self.target[j], -s * self.target[j]);
            if self.target[j + 1].abs() <= goal || !independent {
                return j + 1;
            }
        }
        steps
    }

    /// Solves the triangular least-squares system; leaves its solution in `column`.
    fn back_substitute(&mut self, steps: usize) {
        for i in (0..steps).rev() {
            let mut y = self.target[i];
            for j in i + 1..steps {
                y -= self.triangle[j * (j + 1) / 2 + i] * self.column[j];
            }
            self.column[i] = y / self.triangle[i * (i + 1) / 2 + i];
        }
    }
}

/// One pass of classical Gram-Schmidt: takes w's components along the basis out of w, adds them to
/// `h`, returns the norm left.
fn orthogonalise<T: Real>(basis: &[T], w: &mut [T], h: &mut [f64], partial: &mut [f64]) -> f64 {
    let n = w.len();
    let vectors = basis.len() / n;
    let (chunks, parallel) = (n.div_ceil(CHUNK), parallel(n));
    let partial = &mut partial[..chunks * vectors];
    let dots = |chunk: usize, w: &[T], dots: &mut [f64]| {
        for (v, dot) in basis.chunks_exact(n).zip(dots) {
            *dot = chunk_dot(&v[chunk * CHUNK..][..w.len()], w);
        }
    };
    if parallel {
        partial.par_chunks_mut(vectors).zip(w.par_chunks(CHUNK)).enumerate().for_each(|(c, (p, w))| dots(c, w, p));
    } else {
        partial.chunks_mut(vectors).zip(w.chunks(CHUNK)).enumerate().for_each(|(c, (p, w))| dots(c, w, p));
    }
    let mut coefficients = [0.0; 256];
    let coefficients: &mut [f64] = if vectors <= 256 { &mut coefficients[..vectors] } else { &mut vec![0.0; vectors] };
    for p in partial.chunks_exact(vectors) {
        for (c, p) in coefficients.iter_mut().zip(p) {
            *c += p;
        }
    }
    let subtract = |chunk: usize, w: &mut [T], square: &mut f64| {
        for (v, &c) in basis.chunks_exact(n).zip(coefficients.iter()) {
            let c = T::of(-c);
            for (w, &v) in w.iter_mut().zip(&v[chunk * CHUNK..]) {
                *w += c * v;
            }
        }
        *square = chunk_dot(w, w);
    };
    let squares = &mut partial[..chunks];
    if parallel {
        w.par_chunks_mut(CHUNK).zip(squares.par_iter_mut()).enumerate().for_each(|(c, (w, s))| subtract(c, w, s));
    } else {
        w.chunks_mut(CHUNK).zip(squares.iter_mut()).enumerate().for_each(|(c, (w, s))| subtract(c, w, s));
    }
    for (h, c) in h.iter_mut().zip(coefficients.iter()) {
        *h += c;
    }
    partial[..chunks].iter().sum::<f64>().sqrt()
}

/// x += sum_j c_j v_j over the vectors that lie one after another in `vectors`.
fn add_combination(x: &mut [f64], vectors: &[f32], c: &[f64]) {
    let n = x.len();
    let add = |chunk: usize, x: &mut [f64]| {
        for (v, &c) in vectors.chunks_exact(n).zip(c) {
            for (x, &v) in x.iter_mut().zip(&v[chunk * CHUNK..]) {
                *x += c * f64::from(v);
            }
        }
    };
    if parallel(n) {
        x.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, x)| add(chunk, x));
    } else {
        x.chunks_mut(CHUNK).enumerate().for_each(|(chunk, x)| add(chunk, x));
    }
}

fn scale<T: Real>(x: &mut [T], factor: f64) {
    let factor = T::of(factor);
    for x in x {
        *x *= factor;
    }
}
