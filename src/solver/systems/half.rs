//! A V-cycle on half of a body, for what is even or odd in x, or under a half turn round z.

use super::tied::clear;
use crate::linalg::fold::{Folding, Parity};
use crate::linalg::{Hierarchy, LinalgError};

/// The preconditioner of one parity, on a body that is folded.
#[derive(Debug)]
pub(super) struct HalfCycle {
    parity: Parity,
    hierarchy: Hierarchy,
    /// Which unknowns of the half are fixed.
    pub fixed: Vec<bool>,
    load: Vec<f32>,
    z: Vec<f32>,
}

impl HalfCycle {
    /// For folded matrices of that many nodes, on the half's `hierarchy`.
    pub fn new(parity: Parity, hierarchy: Hierarchy, nodes: usize) -> Self {
        let n = 3 * nodes;
        Self { parity, hierarchy, fixed: vec![false; n], load: vec![0.0; n], z: vec![0.0; n] }
    }

    /// See [`super::pair::PairSolver::with_rounded_smoothers`].
    pub fn round_smoothers(&mut self) {
        self.hierarchy = self.hierarchy.clone().with_rounded_smoothers();
    }

    /// Fixes what the whole body has `fixed` on both sides, and what the parity has none of where
    /// they meet. What is fixed on one side alone has to be free for the other.
    pub fn fix(&mut self, fold: &impl Folding, fixed: &[bool]) {
        for ((a, folded), nodes) in self.fixed.as_chunks_mut::<3>().0.iter_mut().enumerate().zip(fold.nodes()) {
            let [own, opposite] = nodes.map(|n| 3 * n as usize);
            for (c, folded) in folded.iter_mut().enumerate() {
                *folded = !fold.is_free(self.parity, a, c) || fixed[own + c] && fixed[opposite + c];
            }
        }
    }

    /// Takes over the folded matrix, with what is fixed.
    ///
    /// # Errors
    /// As [`Hierarchy::update`].
    pub fn update(&mut self, fold: &impl Folding) -> Result<(), LinalgError> {
        self.hierarchy.update(fold.matrix(), &self.fixed)
    }

    /// Adds to the whole body's `u` what a V-cycle makes of its forces `f`.
    pub fn add<R: Into<f64> + Copy + Sync>(&mut self, fold: &impl Folding, f: &[R], u: &mut [f64]) {
        fold.fold(self.parity, f, &mut self.load);
        clear(&self.fixed, &mut self.load);
        self.hierarchy.v_cycle(&self.load, &mut self.z);
        fold.unfold_add(self.parity, &self.z, u);
    }
}
