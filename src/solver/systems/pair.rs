//! The linear systems of an equal pair, in the unknowns of its interface (see
//! [`crate::contact::pair`]).
//!
//! What preconditions knows of a pair that has not slid: a field that is even in x touches its
//! image along the normal alone and slides freely, an odd one is held along the plane alone. So the
//! right-hand side is split into its even and odd parts, and each goes through a V-cycle of its
//! own, on half of the body (see [`crate::linalg::fold`]). Up to the first shear all is even.

use super::half::HalfCycle;
use super::tied::{InSingle, Tie, Tied, clear};
use crate::contact::coulomb::Status;
use crate::contact::interface::Interface;
use crate::contact::pair::PairInterface;
use crate::linalg::fgmres::System;
use crate::linalg::fold::{Fold, Parity};
use crate::linalg::{Hierarchy, LinalgError, Pattern};
use crate::mesh::Mesh;

/// Solves for the unknowns y of a pair.
#[derive(Debug)]
pub struct PairSolver {
    tie: Tie<PairInterface>,
    fold: Fold,
    even: HalfCycle,
    odd: HalfCycle,
    work: Work,
}

#[derive(Debug, Default)]
struct Work {
    u: Vec<f64>,
    f: Vec<f64>,
    single: InSingle,
}

impl PairSolver {
    /// Plans a solver for a mesh whose nodes have these opposite in x; `None` if it has no mirror
    /// image, or if elements cross x = 0.
    ///
    /// # Errors
    /// [`LinalgError::Hierarchy`] if the prolongations of its half do not fit.
    pub fn new(mesh: &Mesh, pattern: &Pattern, mirror: &[u32]) -> Result<Option<Self>, LinalgError> {
        let Some(half) = mesh.half.as_ref().filter(|_| !mirror.is_empty()) else { return Ok(None) };
        let Some(fold) = Fold::new(pattern, &half.node, mirror) else { return Ok(None) };
        let hierarchy = Hierarchy::new(&fold.matrix.pattern, &half.hierarchy)?;
        let n = 3 * pattern.rows();
        Ok(Some(Self {
            tie: Tie::new(mesh, pattern, mirror),
            even: HalfCycle::new(Parity::Even, hierarchy.clone(), half.node.len()),
            odd: HalfCycle::new(Parity::Odd, hierarchy, half.node.len()),
            fold,
            work: Work { u: vec![0.0; n], f: vec![0.0; n], single: InSingle::default() },
        }))
    }
}

impl Tied for PairSolver {
    type Interface = PairInterface;

    fn tie(&self) -> &Tie<PairInterface> {
        &self.tie
    }

    fn tie_mut(&mut self) -> &mut Tie<PairInterface> {
        &mut self.tie
    }

    fn refresh(&mut self, prescribed: &[bool]) -> Result<(), LinalgError> {
        let Tie { interface, rows, contact_nodes, .. } = &self.tie;
        self.fold.update(&self.tie.matrix);
        self.even.fix(&self.fold, prescribed);
        self.odd.fix(&self.fold, prescribed);
        for (a, nodes) in self.fold.nodes().iter().enumerate() {
            for contact in nodes.map(|node| contact_nodes.binary_search(&node).ok()).into_iter().flatten() {
                let Some(k) = interface.slave_of[contact] else { continue };
                match rows[contact].status {
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
        if self.tie.symmetric { Ok(()) } else { self.odd.update(&self.fold) }
    }
}

impl System<f32> for PairSolver {
    fn step(&mut self, v: &[f32], z: &mut [f32], w: &mut [f32]) {
        let mut work = std::mem::take(&mut self.work);
        work.f.iter_mut().zip(v).for_each(|(f, v)| *f = f64::from(*v));
        self.tie.interface.loads(&work.f, &self.tie.fixed, &mut work.u);
        std::mem::swap(&mut work.u, &mut work.f);
        work.u.fill(0.0);
        self.even.add(&self.fold, &work.f, &mut work.u);
        if !self.tie.symmetric {
            self.odd.add(&self.fold, &work.f, &mut work.u);
        }
        self.tie.interface.contract(&mut work.u);
        clear(&self.tie.fixed, &mut work.u);
        z.iter_mut().zip(&work.u).for_each(|(z, u)| *z = *u as f32);
        let y: Vec<f64> = z.iter().map(|z| f64::from(*z)).collect();
        work.u.copy_from_slice(&y);
        self.tie.interface.expand(&mut work.u);
        work.single.multiply(&self.tie.matrix, &work.u, &mut work.f);
        self.tie.carry_over(&y, &mut work.f);
        clear(&self.tie.fixed, &mut work.f);
        w.iter_mut().zip(&work.f).for_each(|(w, f)| *w = *f as f32);
        self.work = work;
    }

    fn residual(&self, b: &[f64], x: &[f64], r: &mut [f64]) {
        self.remainder(b, x, r);
    }
}
