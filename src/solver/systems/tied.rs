//! What systems in the unknowns of an interface have in common: the equations y = u at fixed
//! unknowns taken out, FGMRES for the rest.

use std::sync::Arc;

use crate::contact::coulomb::{Rows, Status};
use crate::contact::interface::{Interface, Symmetry};
use crate::linalg::fgmres::{Fgmres, System};
use crate::linalg::{BlockMatrix, LinalgError, Pattern, SolveReport};
use crate::mesh::Mesh;

/// Iterations after which FGMRES starts over, and after which it gives up. Half and twice of
/// either: `benches/constants`.
const RESTART: usize = 60;
const MAX_ITERATIONS: usize = 120;
/// A system that stalls is good enough to go on from at this relative residual: the line search
/// judges what it gives. Half and twice of it: `benches/constants`.
const STALLED: f64 = 0.3;

/// What every such solver has: the tangent, the interface, and the part of the system that is left
/// when fixed unknowns are taken out.
///
/// The matrix T^T K T is applied, never formed: patterns, prolongations and coarse matrices stay
/// those of each body, and sliding changes T alone.
#[derive(Debug)]
pub struct Tie<I> {
    /// The tangent along the axes.
    pub matrix: BlockMatrix<f32>,
    /// The state and the step have the bodies' `symmetry`, and so have all corrections.
    pub symmetric: bool,
    /// What each body keeps while it is only pressed: the mirror in x or the half turn round z.
    symmetry: Symmetry,
    /// Nodes of the contact rows.
    pub contact_nodes: Vec<u32>,
    /// What ties the bodies.
    pub interface: Arc<I>,
    /// One a contact node, in their order.
    pub rows: Vec<Rows<f64>>,
    /// Which unknowns are fixed.
    pub fixed: Vec<bool>,
    /// Right-hand side with the fixed unknowns taken over, and the free part of the solution.
    load: Vec<f64>,
    free: Vec<f64>,
    krylov: Fgmres<f32>,
}

impl<I: Interface> Tie<I> {
    /// For the matrices of a mesh, with none of the unknowns fixed.
    pub fn new(mesh: &Mesh, pattern: &Pattern, symmetry: &Symmetry) -> Self {
        let n = 3 * pattern.rows();
        Self {
            matrix: BlockMatrix::zeros(pattern.clone()),
            symmetric: false,
            symmetry: symmetry.clone(),
            contact_nodes: mesh.contact_nodes.clone(),
            interface: Arc::default(),
            rows: Vec::new(),
            fixed: vec![false; n],
            load: vec![0.0; n],
            free: vec![0.0; n],
            krylov: Fgmres::new(n, RESTART),
        }
    }

    /// Takes over the interface, its rows and which unknowns y are fixed; whether all has the
    /// bodies' symmetry.
    pub fn take(&mut self, interface: &Arc<I>, rows: &[Rows<f64>], fixed: &[bool], symmetric: bool) {
        self.interface = interface.clone();
        self.rows.clear();
        self.rows.extend_from_slice(rows);
        self.fixed.copy_from_slice(fixed);
        self.symmetric = symmetric;
    }

    /// Makes f = A y of f = K u. Where all is even, so is f but for rounding and points that it
    /// makes flow on one side alone, which half of a body cannot take away.
    pub fn carry_over(&self, y: &[f64], f: &mut [f64]) {
        if self.symmetric {
            self.symmetry.leave_even(f);
        }
        self.interface.reduce(f);
        self.impose(y, f);
    }

    /// Puts the conditions of contact in the place of the forces `f` at slaves that are in contact,
    /// at unknowns `y`.
    fn impose(&self, y: &[f64], f: &mut [f64]) {
        for &slave in self.interface.slaves() {
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

/// The product of an iteration: in the precision of FGMRES' basis.
#[derive(Debug, Default)]
pub(super) struct InSingle {
    u: Vec<f32>,
    f: Vec<f32>,
    room: Vec<[f32; 4]>,
}

impl InSingle {
    /// f = K u.
    pub fn multiply(&mut self, matrix: &BlockMatrix<f32>, u: &[f64], f: &mut [f64]) {
        self.u.clear();
        self.u.extend(u.iter().map(|u| *u as f32));
        self.f.resize(f.len(), 0.0);
        matrix.multiply_in_single(&self.u, &mut self.room, &mut self.f);
        f.iter_mut().zip(&self.f).for_each(|(f, single)| *f = f64::from(*single));
    }
}

/// A system A y = b that is applied and never formed, in unknowns of which some are fixed.
pub trait Tied: System<f32> + Sized {
    /// Its interface.
    type Interface: Interface;

    /// What it shares with others.
    fn tie(&self) -> &Tie<Self::Interface>;
    /// The same, to be changed.
    fn tie_mut(&mut self) -> &mut Tie<Self::Interface>;

    /// Forms what preconditions, once tangent, interface and rows are taken over; `prescribed` are
    /// the unknowns that are fixed whatever the contact does.
    ///
    /// # Errors
    /// As [`crate::linalg::Hierarchy::update`].
    fn refresh(&mut self, prescribed: &[bool]) -> Result<(), LinalgError>;

    /// f = A y in f64, with `u` to work in; rows of fixed unknowns mean nothing.
    fn product(&self, y: &[f64], u: &mut [f64], f: &mut [f64]) {
        let tie = self.tie();
        u.copy_from_slice(y);
        tie.interface.expand(u);
        tie.matrix.multiply(u, f);
        tie.carry_over(y, f);
    }

    /// The same where few numbers of y are not 0.
    fn product_of_few(&self, y: &[f64], u: &mut [f64], f: &mut [f64]) {
        self.product(y, u, f);
    }

    /// Solves for y to |rhs - A y| <= tolerance |rhs| over the free unknowns, as
    /// [`crate::linalg::LinearSolver::solve`].
    ///
    /// # Errors
    /// [`LinalgError::Stalled`]; `y` is then the best iterate.
    fn solve(&mut self, rhs: &[f64], tolerance: f64, y: &mut [f64]) -> Result<SolveReport, LinalgError> {
        self.take_over(rhs);
        let tie = self.tie_mut();
        tie.free.copy_from_slice(y);
        clear(&tie.fixed, &mut tie.free);
        let (mut free, load) = (std::mem::take(&mut tie.free), std::mem::take(&mut tie.load));
        let mut krylov = std::mem::replace(&mut tie.krylov, Fgmres::new(0, 1));
        let got = krylov.solve(self, &load, &mut free, tolerance, MAX_ITERATIONS);
        let tie = self.tie_mut();
        (tie.free, tie.load, tie.krylov) = (free, load, krylov);
        for (i, y) in y.iter_mut().enumerate() {
            *y = if tie.fixed[i] { rhs[i] } else { tie.free[i] };
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
    fn residual_norm(&mut self, rhs: &[f64], y: &[f64]) -> f64 {
        self.take_over(rhs);
        let mut free = y.to_vec();
        clear(&self.tie().fixed, &mut free);
        let mut r = vec![0.0; free.len()];
        let load = std::mem::take(&mut self.tie_mut().load);
        self.remainder(&load, &free, &mut r);
        self.tie_mut().load = load;
        r.iter().map(|r| r * r).sum::<f64>().sqrt()
    }

    /// Takes what the fixed unknowns contribute over to the right-hand side.
    fn take_over(&mut self, rhs: &[f64]) {
        let mut y = vec![0.0; rhs.len()];
        y.iter_mut().zip(rhs).zip(&self.tie().fixed).filter(|(_, fixed)| **fixed).for_each(|((y, value), _)| *y = *value);
        let mut load = std::mem::take(&mut self.tie_mut().load);
        load.copy_from_slice(rhs);
        if y.iter().any(|y| *y != 0.0) {
            let (mut u, mut f) = (vec![0.0; y.len()], vec![0.0; y.len()]);
            self.product_of_few(&y, &mut u, &mut f);
            load.iter_mut().zip(&f).for_each(|(load, f)| *load -= f);
        }
        clear(&self.tie().fixed, &mut load);
        self.tie_mut().load = load;
    }

    /// r = b - A x over the free unknowns.
    fn remainder(&self, b: &[f64], x: &[f64], r: &mut [f64]) {
        let mut u = vec![0.0; x.len()];
        self.product(x, &mut u, r);
        r.iter_mut().zip(b).for_each(|(r, b)| *r = b - *r);
        clear(&self.tie().fixed, r);
    }
}

/// Sets what is fixed to zero.
pub(super) fn clear<T: Default>(fixed: &[bool], x: &mut [T]) {
    x.iter_mut().zip(fixed).filter(|(_, fixed)| **fixed).for_each(|(x, _)| *x = T::default());
}
