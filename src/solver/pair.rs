//! The linear systems of an equal pair, in the unknowns of its interface (see
//! [`crate::contact::pair`]).
//!
//! The matrix T^T K T is applied, never formed: patterns, prolongations and coarse matrices stay
//! those of the one body. What preconditions it knows of a pair that has not slid: a field that is
//! even in x touches its image along the normal alone and slides freely, an odd one is held along
//! the plane alone. So the right-hand side is split into its even and odd parts, and each goes
//! through a V-cycle of its own. Up to the first shear all is even.

use std::sync::Arc;

use super::couple::CoupleSolver;
use crate::contact::coulomb::{Rows, Status};
use crate::contact::pair::{Interface, leave_even};
use crate::linalg::bsr::Widen;
use crate::linalg::fgmres::{Fgmres, System};
use crate::linalg::{BlockMatrix, DEFAULT_FALLBACK_LIMIT, Hierarchy, LinalgError, LinearSolver, Pattern, SolveReport};
use crate::mesh::Mesh;
use crate::real::Real;

/// Iterations after which FGMRES starts over, and after which it gives up.
pub(super) const RESTART: usize = 60;
pub(super) const MAX_ITERATIONS: usize = 120;
/// A system that stalls is good enough to go on from at this relative residual: the line search
/// judges what it gives.
pub(super) const STALLED: f64 = 0.3;

/// The solver of one body's systems, of an equal pair's, or of two bodies'.
#[derive(Debug)]
pub enum Systems {
    /// Over a plane.
    Plane(Box<LinearSolver>),
    /// Against its own image.
    Pair(Box<PairSolver>),
    /// Against another body.
    Couple(Box<CoupleSolver>),
}

impl From<CoupleSolver> for Systems {
    fn from(solver: CoupleSolver) -> Self {
        Self::Couple(Box::new(solver))
    }
}

impl From<LinearSolver> for Systems {
    fn from(solver: LinearSolver) -> Self {
        Self::Plane(Box::new(solver))
    }
}

impl From<PairSolver> for Systems {
    fn from(solver: PairSolver) -> Self {
        Self::Pair(Box::new(solver))
    }
}

impl Systems {
    /// The tangent, to be written in place.
    pub fn matrix_mut(&mut self) -> &mut BlockMatrix<f64> {
        match self {
            Self::Plane(solver) => solver.matrix_mut(),
            Self::Pair(solver) => solver.matrix_mut(),
            Self::Couple(solver) => solver.matrix_mut(),
        }
    }

    /// Solves for the correction of the unknowns; without `fallback` never by the direct solver.
    ///
    /// # Errors
    /// As [`LinearSolver::solve`].
    pub fn solve(&mut self, rhs: &[f64], tolerance: f64, x: &mut [f64], fallback: bool) -> Result<SolveReport, LinalgError> {
        match self {
            Self::Plane(solver) => {
                solver.set_fallback_limit(if fallback { DEFAULT_FALLBACK_LIMIT } else { 0 });
                solver.solve(rhs, tolerance, x)
            }
            Self::Pair(solver) => solver.solve(rhs, tolerance, x),
            Self::Couple(solver) => solver.solve(rhs, tolerance, x),
        }
    }

    /// The norm of what is left of the free unknowns' equations.
    ///
    /// # Errors
    /// As [`LinearSolver::residual_norm`].
    pub fn residual_norm(&mut self, rhs: &[f64], x: &[f64]) -> Result<f64, LinalgError> {
        match self {
            Self::Plane(solver) => solver.residual_norm(rhs, x),
            Self::Pair(solver) => Ok(solver.residual_norm(rhs, x)),
            Self::Couple(solver) => Ok(solver.residual_norm(rhs, x)),
        }
    }
}

/// Solves for the unknowns y of a pair.
#[derive(Debug)]
pub struct PairSolver {
    matrix: BlockMatrix<f64>,
    /// The same in f32, for the products of the Krylov iteration.
    single: BlockMatrix<f32>,
    /// The state and the step are even in x, and so are all corrections.
    symmetric: bool,
    even: Hierarchy,
    odd: Hierarchy,
    krylov: Fgmres<f32>,
    /// The node opposite in x.
    mirror: Vec<u32>,
    contact_nodes: Vec<u32>,
    interface: Arc<Interface>,
    rows: Vec<Rows<f64>>,
    fixed: Vec<bool>,
    even_fixed: Vec<bool>,
    odd_fixed: Vec<bool>,
    /// Right-hand side with the fixed unknowns taken over, and the free part of the solution.
    reduced: Vec<f64>,
    free: Vec<f64>,
    work: Work,
}

#[derive(Debug, Default)]
struct Work {
    load: Vec<f32>,
    even: Vec<f32>,
    odd: Vec<f32>,
    z_even: Vec<f32>,
    z_odd: Vec<f32>,
    u: Vec<f64>,
    f: Vec<f64>,
}

/// The node opposite in x of each node of a mesh that is its own mirror image; `None` if it is not.
pub fn mirror_nodes(mesh: &Mesh) -> Option<Vec<u32>> {
    // + 0: no -0 among the keys.
    let key = |n: usize, sign: f64| {
        let x = mesh.nodes[n];
        (mesh.couple.as_ref().map_or(0, |couple| couple.body_of(n)), [sign * x[0] + 0.0, x[1], x[2]].map(f64::to_bits))
    };
    let all = 0..mesh.nodes.len();
    let nodes: std::collections::HashMap<(usize, [u64; 3]), u32> = all.clone().zip(0..).map(|(n, i)| (key(n, 1.0), i)).collect();
    all.map(|n| nodes.get(&key(n, -1.0)).copied()).collect()
}

impl PairSolver {
    /// Plans a solver for a mesh.
    ///
    /// # Errors
    /// [`LinalgError::Hierarchy`] if its prolongations do not fit, or if it has none.
    pub fn new(mesh: &Mesh, pattern: &Pattern, mirror: Vec<u32>) -> Result<Self, LinalgError> {
        let n = 3 * pattern.rows();
        let hierarchy = Hierarchy::new(pattern, &mesh.hierarchy)?;
        let zero = || vec![0.0; n];
        let small = || vec![0.0; n];
        Ok(Self {
            matrix: BlockMatrix::zeros(pattern.clone()),
            single: BlockMatrix::zeros(pattern.clone()),
            symmetric: false,
            odd: hierarchy.clone(),
            even: hierarchy,
            krylov: Fgmres::new(n, RESTART),
            mirror,
            contact_nodes: mesh.contact_nodes.clone(),
            interface: Arc::default(),
            rows: Vec::new(),
            fixed: vec![false; n],
            even_fixed: vec![false; n],
            odd_fixed: vec![false; n],
            reduced: zero(),
            free: zero(),
            work: Work { load: small(), even: small(), odd: small(), z_even: small(), z_odd: small(), u: zero(), f: zero() },
        })
    }

    /// The tangent of the body, to be written in place before [`PairSolver::refresh`].
    pub fn matrix_mut(&mut self) -> &mut BlockMatrix<f64> {
        &mut self.matrix
    }

    /// Says whether the state and the step are even in x: so is then their solution. Rounding is
    /// not, nor the points that it makes flow on one side alone: what they add is left out.
    pub fn set_symmetric(&mut self, symmetric: bool) {
        self.symmetric = symmetric;
    }

    /// The node opposite in x of each node.
    pub fn mirror(&self) -> &[u32] {
        &self.mirror
    }

    /// Leaves the even part of displacements or forces (three a node), if all is even.
    pub fn symmetrise(&self, u: &mut [f64]) {
        if !self.symmetric {
            return;
        }
        leave_even(&self.mirror, u);
    }

    /// Takes over the tangent, the interface, its rows and which unknowns y are fixed, and which
    /// displacements are `prescribed` whatever the contact does.
    ///
    /// # Errors
    /// As [`Hierarchy::update`].
    pub fn refresh(
        &mut self,
        interface: &Arc<Interface>,
        rows: &[Rows<f64>],
        fixed: &[bool],
        prescribed: &[bool],
    ) -> Result<(), LinalgError> {
        self.interface = interface.clone();
        self.rows.clear();
        self.rows.extend_from_slice(rows);
        self.fixed.copy_from_slice(fixed);
        self.even_fixed.copy_from_slice(prescribed);
        self.odd_fixed.copy_from_slice(prescribed);
        for (i, &node) in self.contact_nodes.iter().enumerate() {
            let Some(k) = interface.facing[i] else { continue };
            let base = 3 * node as usize;
            // Two masters opposite each other move each by itself.
            let is_slave = |node: u32| self.contact_nodes.binary_search(&node).is_ok_and(|at| interface.slave_of[at].is_some());
            if !is_slave(node) && !is_slave(self.mirror[node as usize]) {
                continue;
            }
            match rows[interface.slaves[k]].status {
                Status::Open => {}
                status => {
                    self.even_fixed[base + 2] = true;
                    if status == Status::Stick {
                        self.odd_fixed[base] = true;
                        self.odd_fixed[base + 1] |= !interface.is_free_along_y(k);
                    }
                }
            }
        }
        self.single.blocks.iter_mut().zip(&self.matrix.blocks).for_each(|(s, b)| *s = b.map(|b| b as f32));
        self.even.update(&self.matrix, &self.even_fixed)?;
        if self.symmetric { Ok(()) } else { self.odd.update(&self.matrix, &self.odd_fixed) }
    }

    /// Solves for y to |rhs - A y| <= tolerance |rhs| over the free unknowns, as
    /// [`crate::linalg::LinearSolver::solve`].
    ///
    /// # Errors
    /// [`LinalgError::Stalled`]; `y` is then the best iterate.
    pub fn solve(&mut self, rhs: &[f64], tolerance: f64, y: &mut [f64]) -> Result<SolveReport, LinalgError> {
        self.take_over(rhs);
        self.free.copy_from_slice(y);
        clear(&self.fixed, &mut self.free);
        let (mut free, reduced) = (std::mem::take(&mut self.free), std::mem::take(&mut self.reduced));
        let mut krylov = std::mem::replace(&mut self.krylov, Fgmres::new(0, 1));
        let got = krylov.solve(self, &reduced, &mut free, tolerance, MAX_ITERATIONS);
        (self.free, self.reduced, self.krylov) = (free, reduced, krylov);
        for (i, y) in y.iter_mut().enumerate() {
            *y = if self.fixed[i] { rhs[i] } else { self.free[i] };
        }
        if !got.converged && !(got.residual <= STALLED) {
            return Err(LinalgError::Stalled { iterations: got.iterations, residual: got.residual });
        }
        Ok(SolveReport {
            iterations: got.iterations,
            residual: got.residual,
            converged: got.converged,
            stagnated: !got.converged,
            fallback: false,
        })
    }

    /// |rhs - A y| over the free unknowns, the fixed ones at their values in `rhs`.
    pub fn residual_norm(&mut self, rhs: &[f64], y: &[f64]) -> f64 {
        self.take_over(rhs);
        let mut free = y.to_vec();
        clear(&self.fixed, &mut free);
        let mut r = vec![0.0; free.len()];
        System::<f32>::residual(self, &self.reduced, &free, &mut r);
        r.iter().map(|r| r * r).sum::<f64>().sqrt()
    }

    /// Takes what the fixed unknowns contribute over to the right-hand side.
    fn take_over(&mut self, rhs: &[f64]) {
        let mut y = vec![0.0; rhs.len()];
        (0..y.len()).filter(|&i| self.fixed[i]).for_each(|i| y[i] = rhs[i]);
        let mut reduced = std::mem::take(&mut self.reduced);
        reduced.copy_from_slice(rhs);
        if y.iter().any(|y| *y != 0.0) {
            let (mut u, mut f) = (vec![0.0; y.len()], vec![0.0; y.len()]);
            self.apply(&self.matrix, &y, &mut u, &mut f);
            reduced.iter_mut().zip(&f).for_each(|(r, f)| *r -= f);
        }
        clear(&self.fixed, &mut reduced);
        self.reduced = reduced;
    }

    /// f = A y with the tangent in `matrix`; rows of fixed unknowns mean nothing.
    fn apply<T: Real + Widen<f64>>(&self, matrix: &BlockMatrix<T>, y: &[f64], u: &mut [f64], f: &mut [f64]) {
        u.copy_from_slice(y);
        self.interface.expand(u);
        matrix.multiply(u, f);
        self.symmetrise(f);
        self.interface.reduce(f);
        for &slave in &self.interface.slaves {
            let (rows, base) = (&self.rows[slave], 3 * self.contact_nodes[slave] as usize);
            if rows.status == Status::Open {
                continue;
            }
            let force = [f[base], f[base + 1], f[base + 2]];
            let w = &y[base..base + 3];
            for i in 0..3 {
                f[base + i] = (0..3).map(|j| rows.force_rows[i][j] * force[j] + rows.displacement_rows[i][j] * w[j]).sum::<f64>();
            }
        }
    }
}

impl System<f32> for PairSolver {
    fn step(&mut self, v: &[f32], z: &mut [f32], w: &mut [f32]) {
        let mut work = std::mem::take(&mut self.work);
        work.f.iter_mut().zip(v).for_each(|(f, v)| *f = f64::from(*v));
        self.interface.loads(&work.f, &self.fixed, &mut work.u);
        work.load.iter_mut().zip(&work.u).for_each(|(load, u)| *load = *u as f32);
        for (n, &opposite) in self.mirror.iter().enumerate() {
            for c in 0..3 {
                let sign = if c == 0 { -1.0 } else { 1.0 };
                let (own, other) = (work.load[3 * n + c], sign * work.load[3 * opposite as usize + c]);
                work.even[3 * n + c] = 0.5 * (own + other);
                work.odd[3 * n + c] = 0.5 * (own - other);
            }
        }
        clear(&self.even_fixed, &mut work.even);
        clear(&self.odd_fixed, &mut work.odd);
        self.even.v_cycle(&work.even, &mut work.z_even);
        if self.symmetric {
            work.z_odd.fill(0.0);
        } else {
            self.odd.v_cycle(&work.odd, &mut work.z_odd);
        }
        for (n, &opposite) in self.mirror.iter().enumerate() {
            for c in 0..3 {
                let sign = if c == 0 { -1.0 } else { 1.0 };
                let (i, j) = (3 * n + c, 3 * opposite as usize + c);
                let even = work.z_even[i] + sign * work.z_even[j];
                let odd = work.z_odd[i] - sign * work.z_odd[j];
                work.u[i] = 0.5 * (f64::from(even) + f64::from(odd));
            }
        }
        self.interface.contract(&mut work.u);
        clear(&self.fixed, &mut work.u);
        z.iter_mut().zip(&work.u).for_each(|(z, u)| *z = *u as f32);
        let y: Vec<f64> = z.iter().map(|z| f64::from(*z)).collect();
        self.apply(&self.single, &y, &mut work.u, &mut work.f);
        clear(&self.fixed, &mut work.f);
        w.iter_mut().zip(&work.f).for_each(|(w, f)| *w = *f as f32);
        self.work = work;
    }

    fn residual(&self, b: &[f64], x: &[f64], r: &mut [f64]) {
        let mut u = vec![0.0; x.len()];
        self.apply(&self.matrix, x, &mut u, r);
        r.iter_mut().zip(b).for_each(|(r, b)| *r = b - *r);
        clear(&self.fixed, r);
    }
}

pub(super) fn clear<T: Default>(fixed: &[bool], x: &mut [T]) {
    x.iter_mut().zip(fixed).filter(|(_, fixed)| **fixed).for_each(|(x, _)| *x = T::default());
}
