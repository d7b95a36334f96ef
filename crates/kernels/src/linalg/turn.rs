//! A body that is its own image when it is turned half round z, folded at x = 0: what is even or
//! odd under that is known from half of its nodes.
//!
//! An even field has `u(-x, -y) = S u(x, y)` with S = diag(-1, -1, 1), an odd one -S. Unlike a
//! mirror the half turn takes the plane x = 0 to itself, (0, y) to (0, -y). So the half keeps both
//! nodes there, and they are tied to each other (see [`Ties`]): the half has the
//! matrix of what of the body's energy is at x >= 0, on an average of both sides. An A that does
//! not turn into itself also makes odd forces of even fields: a folded matrix leaves them out.

use super::bsr::{BlockMatrix, Pattern};
use super::fold::{Folding, Parity};
use super::parallel::{each, each_row};
use super::ties::Ties;

/// A matrix folded by a half turn, and the plan by which it is. It serves both parities.
#[derive(Clone, Debug)]
pub struct Turn {
    matrix: BlockMatrix<f32>,
    /// Whole-mesh nodes of each node of the half: its own, and where the half turn takes it.
    nodes: Vec<[u32; 2]>,
    /// Per block of the half, its index in the whole matrix, and that of the block turned.
    blocks: Vec<[u32; 2]>,
    /// Nodes of the half that lie at x = 0, by pairs; those on the axis with themselves.
    pairs: Vec<[u32; 2]>,
    /// Per node of the half: it lies at x = 0.
    at_zero: Vec<bool>,
}

/// What the entries of a turned block are multiplied with: S A S, of either parity.
const TURNED: [f32; 9] = [1.0, 1.0, -1.0, 1.0, 1.0, -1.0, -1.0, -1.0, 1.0];

/// Sign that a component has after the half turn.
fn sign(parity: Parity, component: usize) -> f32 {
    if (component == 2) == (parity == Parity::Even) { 1.0 } else { -1.0 }
}

impl Turn {
    /// Plans the fold of matrices with a `pattern` to the nodes `half` (at x >= 0); `turned` is
    /// where the half turn takes each node. `None` if they do not fit each other, or if blocks
    /// couple the two sides.
    pub fn new(pattern: &Pattern, half: &[u32], turned: &[u32]) -> Option<Self> {
        if turned.len() != pattern.rows() {
            return None;
        }
        let mut place = vec![u32::MAX; pattern.rows()];
        for (a, &node) in half.iter().enumerate() {
            *place.get_mut(node as usize)? = a as u32;
        }
        let nodes: Vec<[u32; 2]> = half.iter().map(|&n| [n, turned[n as usize]]).collect();
        let at_zero: Vec<bool> = nodes.iter().map(|n| place[n[1] as usize] != u32::MAX).collect();
        let is_known = |n: usize| place[n] != u32::MAX || place[turned[n] as usize] != u32::MAX;
        if !(0..pattern.rows()).all(is_known) {
            return None;
        }
        let columns = |node: u32| pattern.row(node as usize).map(|at| pattern.column[at]);
        for (&[own, _], _) in nodes.iter().zip(&at_zero).filter(|(_, at_zero)| !**at_zero) {
            if columns(own).any(|j| place[j as usize] == u32::MAX) {
                return None;
            }
        }
        let rows = nodes.iter().map(|&[own, _]| {
            let mut row: Vec<u32> = columns(own).map(|j| place[j as usize]).filter(|&j| j != u32::MAX).collect();
            row.sort_unstable();
            row
        });
        let matrix = BlockMatrix::zeros(Pattern::from_rows(rows));
        let mut blocks = Vec::with_capacity(matrix.blocks.len());
        for (a, row) in nodes.iter().enumerate() {
            for &b in &matrix.pattern.column[matrix.pattern.row(a)] {
                let column = nodes[b as usize];
                let [own, turned] = [0, 1].map(|k| pattern.position(row[k] as usize, column[k] as usize));
                blocks.push([own? as u32, turned? as u32]);
            }
        }
        let pairs = nodes.iter().filter(|[own, turned]| own <= turned).filter_map(|&[own, turned]| {
            let pair = [own, turned].map(|n| place[n as usize]);
            pair.iter().all(|&a| a != u32::MAX).then_some(pair)
        });
        Some(Self { pairs: pairs.collect(), matrix, nodes, blocks, at_zero })
    }

    /// What ties the nodes at x = 0 of fields of a parity.
    pub fn ties(&self, parity: Parity) -> Ties {
        Ties::new(self.pairs.clone(), [0, 1, 2].map(|c| sign(parity, c)), self.nodes.len())
    }
}

impl Folding for Turn {
    fn matrix(&self) -> &BlockMatrix<f32> {
        &self.matrix
    }

    fn nodes(&self) -> &[[u32; 2]] {
        &self.nodes
    }

    fn is_free(&self, parity: Parity, node: usize, component: usize) -> bool {
        let [own, turned] = self.nodes[node];
        own != turned || sign(parity, component) > 0.0
    }

    fn update(&mut self, whole: &BlockMatrix<f32>) {
        let (plan, at_zero) = (&self.blocks, &self.at_zero);
        let BlockMatrix { pattern, blocks } = &mut self.matrix;
        let mut nothing = vec![(); at_zero.len()];
        each_row(blocks, &pattern.row_start, &mut nothing, |a, row, ()| {
            let range = pattern.row(a);
            for ((block, &[own, turned]), &b) in row.iter_mut().zip(&plan[range.clone()]).zip(&pattern.column[range]) {
                // The body has what lies at x = 0 once, the half has it in both nodes of a pair.
                let share = if at_zero[a] && at_zero[b as usize] { 0.5 } else { 1.0 };
                let (own, turned) = (&whole.blocks[own as usize], &whole.blocks[turned as usize]);
                for m in 0..9 {
                    block[m] = share * (own[m] + TURNED[m] * turned[m]);
                }
            }
        });
    }

    fn fold<R: Into<f64> + Copy + Sync>(&self, parity: Parity, f: &[R], folded: &mut [f32]) {
        let signs = [0, 1, 2].map(|c| f64::from(sign(parity, c)));
        each(folded.as_chunks_mut::<3>().0, |a, folded| {
            let [own, turned] = self.nodes[a].map(|n| 3 * n as usize);
            for c in 0..3 {
                folded[c] = match self.at_zero[a] {
                    true if self.is_free(parity, a, c) => f[own + c].into() as f32,
                    true => 0.0,
                    false => (f[own + c].into() + signs[c] * f[turned + c].into()) as f32,
                };
            }
        });
    }

    fn unfold_add<R: Into<f64> + Copy>(&self, parity: Parity, z: &[R], u: &mut [f64]) {
        let signs = [0, 1, 2].map(|c| f64::from(sign(parity, c)));
        for ((a, z), &[own, turned]) in z.as_chunks::<3>().0.iter().enumerate().zip(&self.nodes) {
            let [own, turned] = [own, turned].map(|n| 3 * n as usize);
            for c in (0..3).filter(|&c| self.is_free(parity, a, c)) {
                u[own + c] += z[c].into();
                if !self.at_zero[a] {
                    u[turned + c] += signs[c] * z[c].into();
                }
            }
        }
    }
}
