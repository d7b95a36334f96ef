//! The linear systems of two bodies that both deform, in the unknowns of their interface (see
//! [`crate::contact::couple`]).
//!
//! With the slave's unknowns first the matrix T^T K T reads
//!
//!   A_ss  A_sm      A_ss = K_s, closed points held; A_sm = K_s M, M the weights of the mortar;
//!   A_ms  A_mm      its Schur complement is K_m + M^T S M, S the slave's stiffness at the interface.
//!
//! K_m stands for the Schur complement, which is at most 1 + E_s/E_m times as stiff if the slave is
//! the softer body: a V-cycle of the master, whose surface is free, and then one of the slave on
//! what that leaves of its equations, its contact points held as over a plane.

use std::ops::Range;

use super::half::HalfCycle;
use super::tied::{Tie, Tied, clear};
use crate::contact::coulomb::Status;
use crate::contact::couple::CoupleInterface;
use crate::contact::interface::{Interface, Symmetry};
use crate::linalg::fgmres::System;
use crate::linalg::fold::{Fold, Folding, Parity};
use crate::linalg::{BlockMatrix, Hierarchy, LinalgError, Pattern};
use crate::mesh::Mesh;
use crate::solver::contact_rows::{apply_rows, turn_node};

/// Solves for the unknowns y of two bodies.
#[derive(Debug)]
pub struct CoupleSolver {
    tie: Tie<CoupleInterface>,
    /// Which body is the slave.
    slave: usize,
    bodies: [BodyPart; 2],
    work: Work,
}

/// One body's part of the preconditioner.
#[derive(Debug)]
struct BodyPart {
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

impl BodyPart {
    fn new(mesh: &Mesh, body: usize, whole: &Pattern, mirror: &[u32]) -> Result<Self, LinalgError> {
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
        let half = match half {
            Some(half) if !mirror.is_empty() => {
                let own: Vec<u32> = mirror[nodes.clone()].iter().map(|n| n - nodes.start as u32).collect();
                match Fold::new(&pattern, &half.node, &own) {
                    Some(fold) => {
                        let hierarchy = Hierarchy::new(&fold.matrix().pattern, &half.hierarchy)?;
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
    /// the slave; `symmetry` is their mirror in x.
    ///
    /// # Errors
    /// [`LinalgError::Hierarchy`] if prolongations do not fit.
    pub fn new(mesh: &Mesh, pattern: &Pattern, slave: usize, symmetry: &Symmetry) -> Result<Self, LinalgError> {
        let n = 3 * pattern.rows();
        let zero = || vec![0.0; n];
        let body = |body| BodyPart::new(mesh, body, pattern, &symmetry.nodes);
        Ok(Self {
            tie: Tie::new(mesh, pattern, symmetry),
            slave,
            bodies: [body(0)?, body(1)?],
            work: Work { y: zero(), u: zero(), f: zero(), r: zero() },
        })
    }

    /// f = A y, or as much of it as comes from u, of which few numbers are not 0.
    fn apply_to_few(&self, y: &[f64], u: &[f64], f: &mut [f64]) {
        f.fill(0.0);
        self.tie.matrix.subtract_product_of_few(u, f);
        f.iter_mut().for_each(|f| *f = -*f);
        self.tie.carry_over(y, f);
    }

    /// One V-cycle of a body from its part of `r`; the result is in its `z`, and in `y`.
    fn cycle(&mut self, body: usize, r: &mut [f64], y: &mut [f64]) {
        let body = &mut self.bodies[body];
        let range = body.unknowns.clone();
        clear(&body.fixed, &mut r[range.clone()]);
        match &mut body.half {
            Some((fold, cycle)) if self.tie.symmetric => {
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
    type Interface = CoupleInterface;

    fn tie(&self) -> &Tie<CoupleInterface> {
        &self.tie
    }

    fn tie_mut(&mut self) -> &mut Tie<CoupleInterface> {
        &mut self.tie
    }

    fn refresh(&mut self, _prescribed: &[bool]) -> Result<(), LinalgError> {
        let Tie { matrix, interface, rows, contact_nodes, fixed, symmetric, .. } = &self.tie;
        for body in &mut self.bodies {
            body.matrix.blocks.copy_from_slice(&matrix.blocks[body.blocks.clone()]);
            body.fixed.copy_from_slice(&fixed[body.unknowns.clone()]);
        }
        let body = &mut self.bodies[self.slave];
        for (k, &slave) in interface.slaves.iter().enumerate() {
            let node = contact_nodes[slave] as usize - body.unknowns.start / 3;
            turn_node(&mut body.matrix, node, &interface.frames[k]);
        }
        for &slave in interface.slaves.iter().filter(|&&slave| rows[slave].status == Status::Slip) {
            let node = contact_nodes[slave] as usize - body.unknowns.start / 3;
            apply_rows(&mut body.matrix, node, &rows[slave]);
        }
        for body in &mut self.bodies {
            match &mut body.half {
                Some((fold, cycle)) if *symmetric => {
                    fold.update(&body.matrix);
                    cycle.fix(fold, &body.fixed);
                    cycle.update(fold)?;
                }
                _ => body.hierarchy.update(&body.matrix, &body.fixed)?,
            }
        }
        Ok(())
    }

    fn product_of_few(&self, y: &[f64], u: &mut [f64], f: &mut [f64]) {
        u.copy_from_slice(y);
        self.tie.interface.expand(u);
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
        self.tie.interface.expand(u);
        u[self.bodies[master].unknowns.clone()].fill(0.0);
        self.apply_to_few(y, u, f);
        let range = self.bodies[slave].unknowns.clone();
        r[range.clone()].iter_mut().zip(&f[range]).for_each(|(r, f)| *r -= f);
        self.cycle(slave, r, y);
        clear(&self.tie.fixed, y);
        z.iter_mut().zip(&*y).for_each(|(z, y)| *z = *y as f32);
        // Not in the precision of the basis: F_N of exchanged roles was then 0.7 % apart, from a
        // step that one of the two cut.
        self.product(y, u, f);
        clear(&self.tie.fixed, f);
        w.iter_mut().zip(&*f).for_each(|(w, f)| *w = *f as f32);
        self.work = work;
    }

    fn residual(&self, b: &[f64], x: &[f64], r: &mut [f64]) {
        self.remainder(b, x, r);
    }
}
