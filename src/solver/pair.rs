//! The linear systems of an equal pair, in the unknowns of its interface (see
//! [`crate::contact::pair`]).
//!
//! The matrix T^T K T is applied, never formed: patterns, prolongations and coarse matrices stay
//! those of the one body. What preconditions it knows of a pair that has not slid: a field that is
//! even in x touches its image along the normal alone and slides freely, an odd one is held along
//! the plane alone. So the right-hand side is split into its even and odd parts, and each goes
//! through a V-cycle of its own, on half of the body (see [`crate::linalg::fold`]). Up to the first
//! shear all is even.

use std::sync::Arc;

use super::half::HalfCycle;
use super::tied::{InSingle, Reduced, Tied, clear, impose};
use crate::contact::coulomb::{Rows, Status};
use crate::contact::pair::{Interface, leave_even};
use crate::linalg::fgmres::System;
use crate::linalg::fold::{Fold, Parity};
use crate::linalg::{BlockMatrix, Hierarchy, LinalgError, Pattern};
use crate::mesh::Mesh;

/// Solves for the unknowns y of a pair.
#[derive(Debug)]
pub struct PairSolver {
    matrix: BlockMatrix<f32>,
    /// The state and the step are even in x, and so are all corrections.
    symmetric: bool,
    fold: Fold,
    even: HalfCycle,
    odd: HalfCycle,
    /// The node opposite in x.
    mirror: Vec<u32>,
    contact_nodes: Vec<u32>,
    interface: Arc<Interface>,
    rows: Vec<Rows<f64>>,
    reduced: Reduced,
    work: Work,
}

#[derive(Debug, Default)]
struct Work {
    u: Vec<f64>,
    f: Vec<f64>,
    single: InSingle,
}

/// The node opposite in x of each node of a mesh that is its own mirror image; `None` if it is not.
pub(super) fn mirror_nodes(mesh: &Mesh) -> Option<Vec<u32>> {
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
    /// Plans a solver for a mesh that is its own mirror image; `None` if it is not, or if elements
    /// cross x = 0.
    ///
    /// # Errors
    /// [`LinalgError::Hierarchy`] if the prolongations of its half do not fit.
    pub fn new(mesh: &Mesh, pattern: &Pattern) -> Result<Option<Self>, LinalgError> {
        let (Some(mirror), Some(half)) = (mirror_nodes(mesh), &mesh.half) else { return Ok(None) };
        let Some(fold) = Fold::new(pattern, &half.node, &mirror) else { return Ok(None) };
        let hierarchy = Hierarchy::new(&fold.matrix.pattern, &half.hierarchy)?;
        let n = 3 * pattern.rows();
        Ok(Some(Self {
            matrix: BlockMatrix::zeros(pattern.clone()),
            symmetric: false,
            even: HalfCycle::new(Parity::Even, hierarchy.clone(), half.node.len()),
            odd: HalfCycle::new(Parity::Odd, hierarchy, half.node.len()),
            fold,
            mirror,
            contact_nodes: mesh.contact_nodes.clone(),
            interface: Arc::default(),
            rows: Vec::new(),
            reduced: Reduced::new(n),
            work: Work { u: vec![0.0; n], f: vec![0.0; n], single: InSingle::default() },
        }))
    }

    /// The tangent of the body, to be written in place before [`PairSolver::refresh`].
    pub fn matrix_mut(&mut self) -> &mut BlockMatrix<f32> {
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
        self.reduced.fixed.copy_from_slice(fixed);
        self.fold.update(&self.matrix);
        self.even.fix(&self.fold, prescribed);
        self.odd.fix(&self.fold, prescribed);
        for (a, nodes) in self.fold.nodes().iter().enumerate() {
            for contact in nodes.map(|node| self.contact_nodes.binary_search(&node).ok()).into_iter().flatten() {
                let Some(k) = interface.slave_of[contact] else { continue };
                match rows[interface.slaves[k]].status {
                    Status::Open => {}
                    status => {
                        self.even.fixed[3 * a + 2] = true;
                        if status == Status::Stick {
                            self.odd.fixed[3 * a] = true;
                            self.odd.fixed[3 * a + 1] |= !interface.is_free_along_y(k);
                        }
                    }
                }
            }
        }
        self.even.update(&self.fold)?;
        if self.symmetric { Ok(()) } else { self.odd.update(&self.fold) }
    }

    /// Makes f = A y of f = K u.
    fn carry_over(&self, y: &[f64], f: &mut [f64]) {
        self.symmetrise(f);
        self.interface.reduce(f);
        impose(&self.rows, &self.interface.slaves, &self.contact_nodes, y, f);
    }
}

impl Tied for PairSolver {
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
}

impl System<f32> for PairSolver {
    fn step(&mut self, v: &[f32], z: &mut [f32], w: &mut [f32]) {
        let mut work = std::mem::take(&mut self.work);
        work.f.iter_mut().zip(v).for_each(|(f, v)| *f = f64::from(*v));
        self.interface.loads(&work.f, &self.reduced.fixed, &mut work.u);
        std::mem::swap(&mut work.u, &mut work.f);
        work.u.fill(0.0);
        self.even.add(&self.fold, &work.f, &mut work.u);
        if !self.symmetric {
            self.odd.add(&self.fold, &work.f, &mut work.u);
        }
        self.interface.contract(&mut work.u);
        clear(&self.reduced.fixed, &mut work.u);
        z.iter_mut().zip(&work.u).for_each(|(z, u)| *z = *u as f32);
        let y: Vec<f64> = z.iter().map(|z| f64::from(*z)).collect();
        work.u.copy_from_slice(&y);
        self.interface.expand(&mut work.u);
        work.single.multiply(&self.matrix, &work.u, &mut work.f);
        self.carry_over(&y, &mut work.f);
        clear(&self.reduced.fixed, &mut work.f);
        w.iter_mut().zip(&work.f).for_each(|(w, f)| *w = *f as f32);
        self.work = work;
    }

    fn residual(&self, b: &[f64], x: &[f64], r: &mut [f64]) {
        self.remainder(b, x, r);
    }
}
