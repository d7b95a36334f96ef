//! The solver of a sequence of systems: FGMRES with multigrid, and where that stalls or has no
//! hierarchy the direct one.

use super::bsr::{BlockMatrix, Pattern, Widen};
use super::direct::DirectSolver;
use super::fgmres::{Fgmres, System};
use super::fixed::Fixed;
use super::multigrid::Hierarchy;
use super::outcome::{LinalgError, SolveReport, size};
use super::vector::norm;
use crate::mesh::Prolongation;
use crate::real::Real;

/// Iterations after which FGMRES starts over.
const RESTART: usize = 60;
/// Memory that the direct fallback may take unless told otherwise, bytes.
pub const DEFAULT_FALLBACK_LIMIT: usize = 2 << 30;
/// Iterations after which FGMRES gives up.
const MAX_ITERATIONS: usize = 120;

/// Which solver [`LinearSolver::new`] makes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SolverKind {
    /// FGMRES preconditioned by multigrid; direct where the mesh has no hierarchy.
    #[default]
    Multigrid,
    /// Sparse LU.
    Direct,
}

/// A solver for a sequence of systems on one pattern, whose matrix is held in `T`. Right-hand
/// sides, solutions and residuals are in f64 whatever `T` is.
#[derive(Debug)]
pub struct LinearSolver<T = f64> {
    method: Method,
    matrix: BlockMatrix<T>,
    fixed: Fixed,
    updated: bool,
    fallback_limit: usize,
    /// Right-hand side with the fixed unknowns taken over, and the free part of the solution.
    reduced: Vec<f64>,
    free: Vec<f64>,
}

#[derive(Debug)]
enum Method {
    Multigrid {
        hierarchy: Box<Hierarchy>,
        krylov: Box<Fgmres<f32>>,
        /// Made at the first stall of a matrix; the flag says that it is factorised for the present
        /// one.
        fallback: Option<Box<DirectSolver>>,
        factorised: bool,
    },
    Direct(Box<DirectSolver>),
}

impl<T: Real + Widen<f64>> LinearSolver<T> {
    /// Plans a solver: everything that depends on the pattern alone. `prolongations` is the mesh's
    /// chain, finest first; if it is empty the solver is direct.
    ///
    /// # Errors
    /// [`LinalgError::Hierarchy`] if the chain does not fit the pattern.
    pub fn new(kind: SolverKind, pattern: &Pattern, prolongations: &[Prolongation]) -> Result<Self, LinalgError> {
        let unknowns = 3 * pattern.rows();
        let method = if kind == SolverKind::Direct || prolongations.is_empty() {
            Method::Direct(Box::new(DirectSolver::new(pattern)))
        } else {
            Method::Multigrid {
                hierarchy: Box::new(Hierarchy::new(pattern, prolongations)?),
                krylov: Box::new(Fgmres::new(unknowns, RESTART)),
                fallback: None,
                factorised: false,
            }
        };
        Ok(Self {
            method,
            matrix: BlockMatrix::zeros(pattern.clone()),
            fixed: Fixed::default(),
            updated: false,
            fallback_limit: DEFAULT_FALLBACK_LIMIT,
            reduced: vec![0.0; unknowns],
            free: vec![0.0; unknowns],
        })
    }

    /// What the solver is after all: [`SolverKind::Direct`] where there is no hierarchy.
    pub fn kind(&self) -> SolverKind {
        match self.method {
            Method::Multigrid { .. } => SolverKind::Multigrid,
            Method::Direct(_) => SolverKind::Direct,
        }
    }

    /// Sets the memory in bytes that a direct solution may take after FGMRES has stalled; 0 forbids
    /// it.
    pub fn set_fallback_limit(&mut self, bytes: usize) {
        self.fallback_limit = bytes;
    }

    /// Takes over a matrix and the mask of its fixed unknowns (one flag an unknown; their rows
    /// count as rows of the identity whatever the matrix holds there). The matrix must lie on the
    /// pattern given to [`LinearSolver::new`].
    ///
    /// # Errors
    /// [`LinalgError::Size`], [`LinalgError::NotFinite`]; from the direct solver also
    /// [`LinalgError::TooLarge`] and [`LinalgError::Singular`].
    pub fn update(&mut self, matrix: &BlockMatrix<T>, fixed: &[bool]) -> Result<(), LinalgError> {
        self.updated = false;
        size("the matrix", matrix.blocks.len(), self.matrix.blocks.len())?;
        size("the matrix's pattern", matrix.pattern.rows(), self.matrix.unknowns() / 3)?;
        self.matrix.blocks.copy_from_slice(&matrix.blocks);
        self.refresh(fixed)
    }

    /// The matrix, to be written in place before [`LinearSolver::refresh`].
    pub fn matrix_mut(&mut self) -> &mut BlockMatrix<T> {
        self.updated = false;
        &mut self.matrix
    }

    /// [`LinearSolver::update`] with the solver's own matrix, as [`LinearSolver::matrix_mut`] left
    /// it.
    ///
    /// # Errors
    /// As [`LinearSolver::update`].
    pub fn refresh(&mut self, fixed: &[bool]) -> Result<(), LinalgError> {
        self.updated = false;
        size("the mask of fixed unknowns", fixed.len(), self.matrix.unknowns())?;
        self.fixed.set(fixed);
        let matrix = &self.matrix;
        match &mut self.method {
            Method::Multigrid { hierarchy, factorised, .. } => {
                *factorised = false;
                in_pool(|| hierarchy.update(matrix, fixed))?;
            }
            Method::Direct(direct) => direct.update(&self.matrix, &self.fixed)?,
        }
        self.updated = true;
        Ok(())
    }

    /// Solves A x = rhs to |rhs - A x| <= tolerance |rhs| over the free unknowns, the fixed ones'
    /// part taken over to the right-hand side. `x` holds the initial guess (zeros are one) and
    /// receives the solution; at fixed unknowns it is set to `rhs` exactly. May be called any
    /// number of times after one update.
    ///
    /// # Errors
    /// [`LinalgError::NotUpdated`], [`LinalgError::Size`], [`LinalgError::NotFinite`];
    /// [`LinalgError::Stalled`] if FGMRES does not get there and the system is too large for, or
    /// has no, direct solution (`x` is then the best iterate).
    pub fn solve(&mut self, rhs: &[f64], tolerance: f64, x: &mut [f64]) -> Result<SolveReport, LinalgError> {
        if !self.updated {
            return Err(LinalgError::NotUpdated);
        }
        size("the right-hand side", rhs.len(), self.matrix.unknowns())?;
        size("the solution", x.len(), self.matrix.unknowns())?;
        for (place, vector) in [("the right-hand side", rhs), ("the initial guess", &*x)] {
            if let Some(at) = vector.iter().position(|v| !v.is_finite()) {
                return Err(LinalgError::NotFinite { place, node: at / 3 });
            }
        }
        in_pool(|| self.solve_free(rhs, tolerance, x))
    }

    /// |rhs - A x| over the free unknowns, the fixed ones at their values in `rhs`.
    ///
    /// # Errors
    /// [`LinalgError::NotUpdated`], [`LinalgError::Size`].
    pub fn residual_norm(&mut self, rhs: &[f64], x: &[f64]) -> Result<f64, LinalgError> {
        if !self.updated {
            return Err(LinalgError::NotUpdated);
        }
        size("the right-hand side", rhs.len(), self.matrix.unknowns())?;
        size("the solution", x.len(), self.matrix.unknowns())?;
        let Self { matrix, fixed, reduced, free, .. } = self;
        free.copy_from_slice(x);
        fixed.copy(rhs, free);
        matrix.residual(free, rhs, reduced);
        fixed.clear(reduced);
        Ok(norm(reduced))
    }

    fn solve_free(&mut self, rhs: &[f64], tolerance: f64, x: &mut [f64]) -> Result<SolveReport, LinalgError> {
        let Self { method, matrix, fixed, reduced, free, fallback_limit, .. } = self;
        free.fill(0.0);
        fixed.copy(rhs, free);
        reduced.copy_from_slice(rhs);
        matrix.subtract_product_of_few(free, reduced);
        fixed.clear(reduced);
        free.copy_from_slice(x);
        fixed.clear(free);
        let report = match method {
            Method::Direct(direct) => direct.solve(matrix, fixed, reduced, free)?,
            Method::Multigrid { hierarchy, krylov, fallback, factorised } => {
                let mut system = Preconditioned { matrix, fixed, hierarchy };
                let got = krylov.solve(&mut system, reduced, free, tolerance, MAX_ITERATIONS);
                let mut report = SolveReport {
                    iterations: got.iterations,
                    residual: got.residual,
                    converged: got.converged,
                    stagnated: !got.converged,
                    fallback: false,
                };
                if !got.converged {
                    let direct = fallback.get_or_insert_with(|| Box::new(DirectSolver::new(&matrix.pattern)));
                    direct.memory_limit = *fallback_limit;
                    let mut factors = Ok(());
                    if !*factorised {
                        factors = direct.update(matrix, fixed);
                        *factorised = factors.is_ok();
                    }
                    let mut solution = vec![0.0; free.len()];
                    match factors.and_then(|()| direct.solve(matrix, fixed, reduced, &mut solution)) {
                        Ok(direct) => {
                            free.copy_from_slice(&solution);
                            report = SolveReport { fallback: true, stagnated: true, iterations: got.iterations, ..direct };
                        }
                        Err(error) => {
                            log::debug!("no direct fallback: {error}");
                            fixed.copy(rhs, free);
                            x.copy_from_slice(free);
                            return Err(LinalgError::Stalled { iterations: got.iterations, residual: got.residual });
                        }
                    }
                }
                report
            }
        };
        fixed.copy(rhs, free);
        x.copy_from_slice(free);
        Ok(report)
    }
}

/// Runs a job inside the thread pool, so that its many short parallel loops do not each have to
/// enter it.
fn in_pool<R: Send>(job: impl FnOnce() -> R + Send) -> R {
    if rayon::current_num_threads() == 1 || rayon::current_thread_index().is_some() { job() } else { rayon::scope(|_| job()) }
}

struct Preconditioned<'a, T> {
    matrix: &'a BlockMatrix<T>,
    fixed: &'a Fixed,
    hierarchy: &'a mut Hierarchy,
}

impl<T: Real + Widen<f64>> System<f32> for Preconditioned<'_, T> {
    fn step(&mut self, v: &[f32], z: &mut [f32], w: &mut [f32]) {
        self.hierarchy.v_cycle_and_product(v, z, w);
    }

    fn residual(&self, b: &[f64], x: &[f64], r: &mut [f64]) {
        self.matrix.residual(x, b, r);
        self.fixed.clear(r);
    }
}
