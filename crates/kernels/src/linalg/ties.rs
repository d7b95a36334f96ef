//! Nodes of a level that are tied in pairs: where one goes, the other goes with it but for signs.

use wide::f32x4;

use super::bsr::BlockMatrix;
use super::kernel::{Inverse, Node, inverse_times, invert};
use crate::mesh::Prolongation;

/// Which nodes of a level are tied. A node may be tied to itself: components whose sign is -1 are
/// then none.
///
/// A matrix, a load or a residual stays that of both nodes. What is tied is the displacement: of
/// the equations of two nodes the sum counts, with the signs.
#[derive(Clone, Debug, Default)]
pub struct Ties {
    pairs: Vec<[u32; 2]>,
    signs: [f32; 3],
    /// Per node; empty where none is.
    is_tied: Vec<bool>,
}

impl Ties {
    /// Ties the nodes of each pair, by one sign a component, on a level of so many `nodes`.
    pub fn new(pairs: Vec<[u32; 2]>, signs: [f32; 3], nodes: usize) -> Self {
        let mut is_tied = vec![false; if pairs.is_empty() { 0 } else { nodes }];
        pairs.iter().flatten().for_each(|&node| is_tied[node as usize] = true);
        Self { pairs, signs, is_tied }
    }

    /// The ties of the next level: of coarse nodes which are nodes of this one, and are all that
    /// these take from.
    pub(super) fn coarser(&self, prolongation: &Prolongation) -> Self {
        let only = |node: u32| {
            let entries = prolongation.row_start[node as usize] as usize..prolongation.row_start[node as usize + 1] as usize;
            if let [only] = prolongation.column[entries] { Some(only) } else { None }
        };
        let mut pairs: Vec<[u32; 2]> = self.pairs.iter().filter_map(|&[a, b]| Some([only(a)?, only(b)?])).collect();
        pairs.sort_unstable();
        pairs.dedup();
        Self::new(pairs, self.signs, prolongation.coarse_nodes)
    }

    #[inline(always)]
    pub(super) fn is_tied(&self, node: usize) -> bool {
        self.is_tied.get(node).is_some_and(|tied| *tied)
    }

    /// Inverses of the diagonal blocks of what is tied, with the first node of each pair, whose
    /// rows `changed`.
    pub(super) fn invert(&self, matrix: &BlockMatrix<f32>, changed: &[bool], inverse: &mut [Inverse]) {
        let diagonal = |node: u32| &matrix.blocks[matrix.pattern.diagonal[node as usize] as usize];
        for &[a, b] in self.pairs.iter().filter(|pair| pair.iter().any(|&node| changed[node as usize])) {
            let (own, other) = (diagonal(a), diagonal(b));
            let sum = std::array::from_fn(|m| own[m] + self.signs[m / 3] * self.signs[m % 3] * other[m]);
            inverse[a as usize] = invert(&sum);
        }
    }

    /// A step of the smoother's recurrence from `now` (from 0 if that is none), whose last step
    /// counts by `keep`. Of what is tied `next` has the residuals.
    pub(super) fn smooth(
        &self,
        inverse: &[Inverse],
        now: Option<&[Node]>,
        [keep, add]: [f32; 2],
        (step, next): (&mut [Node], &mut [Node]),
    ) {
        let [x, y, z] = self.signs;
        let signs = f32x4::new([x, y, z, 0.0]);
        for &[a, other] in &self.pairs {
            let [a, other] = [a, other].map(|node| node as usize);
            let r = f32x4::new(next[a]) + signs * f32x4::new(next[other]);
            let mut by = f32x4::splat(add) * inverse_times(&inverse[a], r);
            if keep != 0.0 {
                by += f32x4::splat(keep) * f32x4::new(step[a]);
            }
            let to = now.map_or(by, |x| f32x4::new(x[a]) + by);
            step[a] = by.to_array();
            next[a] = to.to_array();
            next[other] = (signs * to).to_array();
        }
    }
}
