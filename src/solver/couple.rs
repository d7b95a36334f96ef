//! The linear systems of two bodies that both deform, in the unknowns of their interface (see
//! [`crate::contact::couple`]).
//!
//! The matrix T^T K T is applied, never formed: patterns, prolongations and coarse matrices stay
//! those of each body, and sliding changes T alone. With the slave's unknowns first it reads
//!
//!   A_ss  A_sm      A_ss = K_s, closed points held; A_sm = K_s M, M the weights of the mortar;
//!   A_ms  A_mm      its Schur complement is K_m + M^T S M, S the slave's stiffness at the interface.
//!
//! K_m stands for the Schur complement, which is at most 1 + E_s/E_m times as stiff if the slave is
//! the softer body: a V-cycle of the master, whose surface is free, and then one of the slave on
//! what that leaves of its equations, its contact points held as over a plane.

use std::ops::Range;
use std::sync::Arc;

use super::half::HalfCycle;
use super::pair::mirror_nodes;
use super::tied::{Reduced, Tied, clear, impose};
use crate::contact::coulomb::{Rows, Status};
use crate::contact::couple::Interface;
use crate::contact::frame::Frame;
use crate::contact::pair::leave_even;
use crate::linalg::fgmres::System;
use crate::linalg::fold::{Fold, Parity};
use crate::linalg::{BlockMatrix, Hierarchy, LinalgError, Pattern};
use crate::mesh::Mesh;
use crate::real::Real;

/// Solves for the unknowns y of two bodies.
#[derive(Debug)]
pub struct CoupleSolver {
    /// The tangent of both, along the axes.
    matrix: BlockMatrix<f32>,
    /// Which body is the slave.
    slave: usize,
    /// The state and the step are even in x, and so are all corrections.
    symmetric: bool,
    /// The node opposite in x of each node; none if the mesh is not its own mirror image.
    mirror: Vec<u32>,
    bodies: [Body; 2],
    contact_nodes: Vec<u32>,
    interface: Arc<Interface>,
    rows: Vec<Rows<f64>>,
    reduced: Reduced,
    work: Work,
}

/// One body's part of the preconditioner.
#[derive(Debug)]
struct Body {
    /// Its unknowns, and its blocks among those of the matrix.
    unknowns: Range<usize>,
    blocks: Range<usize>,
    /// Its tangent; the slave's in the frames of its contact points, with their rows.
    matrix: BlockMatrix<f32>,
    hierarchy: Hierarchy,
    /// What takes its place where all is even in x.
    half: Option<(Fold, HalfCycle)>,
    fixed: Vec<bool>,
    z: Vec<f32>,
}

#[derive(Debug, Default)]
struct Work {
    y: Vec<f64>,
    u: Vec<f64>,
    f: Vec<f64>,
    r: Vec<f64>,
}

impl Body {
    fn new(mesh: &Mesh, body: usize, whole: &Pattern, mirror: Option<&[u32]>) -> Result<Self, LinalgError> {
        let (node, element, prolongations, half) = match &mesh.couple {
            Some(couple) => (couple.node, couple.element, couple.hierarchies[body].as_slice(), &couple.halves[body]),
            None => (mesh.nodes.len(), mesh.elements.len(), mesh.hierarchy.as_slice(), &mesh.half),
        };
        let (nodes, elements) = match body {
            0 => (0..node, 0..element),
            _ => (node..mesh.nodes.len(), element..mesh.elements.len()),
        };
        let own: Vec<[u32; 8]> = mesh.elements[elements].iter().map(|e| e.map(|n| n - nodes.start as u32)).collect();
        let pattern = Pattern::from_elements(nodes.len(), &own);
        let first = if nodes.is_empty() { 0 } else { whole.row(nodes.start).start };
        let unknowns = 3 * nodes.start..3 * nodes.end;
        let half = match (half, mirror) {
            (Some(half), Some(mirror)) => {
                let own: Vec<u32> = mirror[nodes.clone()].iter().map(|n| n - nodes.start as u32).collect();
                match Fold::new(&pattern, &half.node, &own) {
                    Some(fold) => {
                        let hierarchy = Hierarchy::new(&fold.matrix.pattern, &half.hierarchy)?;
                        Some((fold, HalfCycle::new(Parity::Even, hierarchy, half.node.len())))
                    }
                    None => None,
                }
            }
            _ => None,
        };
        Ok(Self {
            half,
            blocks: first..first + pattern.entries(),
            hierarchy: Hierarchy::new(&pattern, prolongations)?,
            matrix: BlockMatrix::zeros(pattern),
            fixed: vec![false; unknowns.len()],
            z: vec![0.0; unknowns.len()],
            unknowns,
        })
    }
}

impl CoupleSolver {
    /// Plans a solver for a mesh of two bodies of which `slave` (0 the sphere, 1 the opponent) is
    /// the slave.
    ///
    /// # Errors
    /// [`LinalgError::Hierarchy`] if prolongations do not fit.
    pub fn new(mesh: &Mesh, pattern: &Pattern, slave: usize) -> Result<Self, LinalgError> {
        let n = 3 * pattern.rows();
        let zero = || vec![0.0; n];
        let mirror = mirror_nodes(mesh);
        let body = |body| Body::new(mesh, body, pattern, mirror.as_deref());
        Ok(Self {
            matrix: BlockMatrix::zeros(pattern.clone()),
            slave,
            symmetric: false,
            bodies: [body(0)?, body(1)?],
            mirror: mirror.unwrap_or_default(),
            contact_nodes: mesh.contact_nodes.clone(),
            interface: Arc::default(),
            rows: Vec::new(),
            reduced: Reduced::new(n),
            work: Work { y: zero(), u: zero(), f: zero(), r: zero() },
        })
    }

    /// The tangent of both bodies, to be written in place before [`CoupleSolver::refresh`].
    pub fn matrix_mut(&mut self) -> &mut BlockMatrix<f32> {
        &mut self.matrix
    }

    /// Says whether the state and the step are even in x: so is then their solution, and half of
    /// each body is enough for what preconditions.
    pub fn set_symmetric(&mut self, symmetric: bool) {
        self.symmetric = symmetric;
    }

    /// Takes over the tangent, the interface, its rows and which unknowns y are fixed.
    ///
    /// # Errors
    /// As [`Hierarchy::update`].
    pub fn refresh(&mut self, interface: &Arc<Interface>, rows: &[Rows<f64>], fixed: &[bool]) -> Result<(), LinalgError> {
        self.interface = interface.clone();
        self.rows.clear();
        self.rows.extend_from_slice(rows);
        self.reduced.fixed.copy_from_slice(fixed);
        for body in &mut self.bodies {
            body.matrix.blocks.copy_from_slice(&self.matrix.blocks[body.blocks.clone()]);
            body.fixed.copy_from_slice(&fixed[body.unknowns.clone()]);
        }
        let body = &mut self.bodies[self.slave];
        for (k, &slave) in interface.slaves.iter().enumerate() {
            let node = self.contact_nodes[slave] as usize - body.unknowns.start / 3;
            turn_node(&mut body.matrix, node, &interface.frames[k]);
        }
        for &slave in interface.slaves.iter().filter(|&&slave| rows[slave].status == Status::Slip) {
            let node = self.contact_nodes[slave] as usize - body.unknowns.start / 3;
            apply_rows(&mut body.matrix, node, &rows[slave]);
        }
        for body in &mut self.bodies {
            match &mut body.half {
                Some((fold, cycle)) if self.symmetric => {
                    fold.update(&body.matrix);
                    cycle.fix(fold, &body.fixed);
                    cycle.update(fold)?;
                }
                _ => body.hierarchy.update(&body.matrix, &body.fixed)?,
            }
        }
        Ok(())
    }

    /// f = A y, or as much of it as comes from u, of which few numbers are not 0.
    fn apply_to_few(&self, y: &[f64], u: &[f64], f: &mut [f64]) {
        f.fill(0.0);
        self.matrix.subtract_product_of_few(u, f);
        f.iter_mut().for_each(|f| *f = -*f);
        self.carry_over(y, f);
    }

    /// Makes f = A y of f = K u. Where all is even, so is f but for rounding and points that it
    /// makes flow on one side alone, which half of a body cannot take away.
    fn carry_over(&self, y: &[f64], f: &mut [f64]) {
        if self.symmetric {
            leave_even(&self.mirror, f);
        }
        self.interface.reduce(f);
        impose(&self.rows, &self.interface.slaves, &self.contact_nodes, y, f);
    }

    /// One V-cycle of a body from its part of `r`; the result is in its `z`, and in `y`.
    fn cycle(&mut self, body: usize, r: &mut [f64], y: &mut [f64]) {
        let body = &mut self.bodies[body];
        let range = body.unknowns.clone();
        clear(&body.fixed, &mut r[range.clone()]);
        match &mut body.half {
            Some((fold, cycle)) if self.symmetric => {
                y[range.clone()].fill(0.0);
                cycle.add(fold, &r[range.clone()], &mut y[range]);
            }
            _ => {
                body.hierarchy.v_cycle(&r[range.clone()], &mut body.z);
                y[range].iter_mut().zip(&body.z).for_each(|(y, z)| *y = f64::from(*z));
            }
        }
    }
}

impl Tied for CoupleSolver {
    fn reduced(&mut self) -> &mut Reduced {
        &mut self.reduced
    }

    fn fixed(&self) -> &[bool] {
        &self.reduced.fixed
    }

    fn product(&self, y: &[f64], u: &mut [f64], f: &mut [f64]) {
        u.copy_from_slice(y);
        self.interface.expand(u);
        self.matrix.multiply(u, f);
        self.carry_over(y, f);
    }

    fn product_of_few(&self, y: &[f64], u: &mut [f64], f: &mut [f64]) {
        u.copy_from_slice(y);
        self.interface.expand(u);
        self.apply_to_few(y, u, f);
    }
}

impl System<f32> for CoupleSolver {
    fn step(&mut self, v: &[f32], z: &mut [f32], w: &mut [f32]) {
        let mut work = std::mem::take(&mut self.work);
        let Work { y, u, f, r } = &mut work;
        let (slave, master) = (self.slave, 1 - self.slave);
        y.fill(0.0);
        r.iter_mut().zip(v).for_each(|(r, v)| *r = f64::from(*v));
        self.cycle(master, r, y);
        // What the master's part leaves of the slave's equations. Of the slave it moves the surface
        // alone.
        u.copy_from_slice(y);
        self.interface.expand(u);
        u[self.bodies[master].unknowns.clone()].fill(0.0);
        self.apply_to_few(y, u, f);
        let range = self.bodies[slave].unknowns.clone();
        r[range.clone()].iter_mut().zip(&f[range]).for_each(|(r, f)| *r -= f);
        self.cycle(slave, r, y);
        clear(&self.reduced.fixed, y);
        z.iter_mut().zip(&*y).for_each(|(z, y)| *z = *y as f32);
        // Not in the precision of the basis: F_N of exchanged roles was then 0.7 % apart, from a
        // step that one of the two cut.
        self.product(y, u, f);
        clear(&self.reduced.fixed, f);
        w.iter_mut().zip(&*f).for_each(|(w, f)| *w = *f as f32);
        self.work = work;
    }

    fn residual(&self, b: &[f64], x: &[f64], r: &mut [f64]) {
        self.remainder(b, x, r);
    }
}

/// Turns the row and the column of a node into a frame.
pub(super) fn turn_node<T: Real>(matrix: &mut BlockMatrix<T>, node: usize, q: &Frame) {
    for k in matrix.pattern.row(node) {
        let column = matrix.pattern.column[k] as usize;
        let a = matrix.blocks[k].map(T::to_f64);
        matrix.blocks[k] = std::array::from_fn(|m| T::of((0..3).map(|i| q[m / 3][i] * a[3 * i + m % 3]).sum()));
        // The pattern is symmetric.
        if let Some(k) = matrix.pattern.position(column, node) {
            let a = matrix.blocks[k].map(T::to_f64);
            matrix.blocks[k] = std::array::from_fn(|m| T::of((0..3).map(|j| a[3 * (m / 3) + j] * q[m % 3][j]).sum()));
        }
    }
}

/// Replaces the rows of a node by the conditions of its contact.
pub(super) fn apply_rows<T: Real>(matrix: &mut BlockMatrix<T>, node: usize, rows: &Rows<f64>) {
    let diagonal = matrix.pattern.diagonal[node] as usize;
    for k in matrix.pattern.row(node) {
        let old = matrix.blocks[k].map(T::to_f64);
        matrix.blocks[k] = std::array::from_fn(|m| {
            let (i, j) = (m / 3, m % 3);
            let sum: f64 = (0..3).map(|m| rows.force_rows[i][m] * old[3 * m + j]).sum();
            T::of(if k == diagonal { sum + rows.displacement_rows[i][j] } else { sum })
        });
    }
}
