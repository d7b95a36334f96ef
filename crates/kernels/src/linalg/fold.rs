//! A body that is its own mirror image in x, folded at x = 0: what moves evenly in x, or oddly, is
//! known from half of its nodes.
//!
//! An even field has `u(-x) = S u(x)` with S = diag(-1, 1, 1), and no u_x at x = 0; an odd one has
//! -S, and u_x alone there. If E makes the whole field of the half, the half has the matrix
//! `E^T A E` and the forces `E^T f`. An A that is not its own mirror image also makes odd forces of
//! even fields: a folded matrix leaves them out.

use super::bsr::{BlockMatrix, Pattern};
use super::parallel::{each, each_row};

/// How a field is carried over to the other side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parity {
    /// As by the mirror, or the half turn, that takes one side to the other.
    Even,
    /// The opposite of that.
    Odd,
}

impl Parity {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Even, Self::Odd];

    /// Sign that a component has on the other side of the mirror.
    fn sign(self, component: usize) -> f32 {
        if (component == 0) == (self == Self::Even) { -1.0 } else { 1.0 }
    }

    /// Whether a component is free on the mirror.
    fn is_free_on_mirror(self, component: usize) -> bool {
        (component != 0) == (self == Self::Even)
    }
}

/// A body folded to half of its nodes.
pub trait Folding {
    /// The folded matrix.
    fn matrix(&self) -> &BlockMatrix<f32>;

    /// Nodes of the whole mesh of a node of the half: its own, and that on the other side.
    fn nodes(&self) -> &[[u32; 2]];

    /// Whether a component of a node of the half is free in fields of a parity.
    fn is_free(&self, parity: Parity, node: usize, component: usize) -> bool;

    /// Folds a matrix.
    fn update(&mut self, whole: &BlockMatrix<f32>);

    /// The forces `E^T f` of a whole body's `f` (three a node).
    fn fold<R: Into<f64> + Copy + Sync>(&self, parity: Parity, f: &[R], folded: &mut [f32]);

    /// Adds the whole body's displacements `E z` of a half's `z` to `u`.
    fn unfold_add<R: Into<f64> + Copy>(&self, parity: Parity, z: &[R], u: &mut [f64]);
}

/// Sign that a component of a node gets when it is folded, if it is to the `left`. Coupled to a
/// component of a node on the mirror it has the parity in which that one is free; else either will
/// do.
fn sign(left: bool, component: usize, on_mirror: Option<usize>) -> f32 {
    match (left, on_mirror) {
        (false, _) => 1.0,
        (true, Some(0)) => Parity::Odd.sign(component),
        (true, _) => Parity::Even.sign(component),
    }
}

/// Blocks differ by whether row and column lie to the left, and at x = 0: a bit each.
const KINDS: usize = 16;

/// The signs that the entries of each kind of block get.
fn signs() -> [[f32; 9]; KINDS] {
    std::array::from_fn(|kind| {
        let [left_row, left_column, row_at_zero, column_at_zero] = [1, 2, 4, 8].map(|bit| kind & bit != 0);
        std::array::from_fn(|m| {
            let (r, c) = (m / 3, m % 3);
            let by_row = sign(left_row, r, column_at_zero.then_some(c));
            by_row * sign(left_column, c, row_at_zero.then_some(r))
        })
    })
}

/// A matrix folded at x = 0, and the plan by which it is.
///
/// One matrix serves both parities. Two nodes off x = 0, or two at it, are coupled alike in both.
/// Between a node at x = 0 and one off it, each component of the former is free in one parity only,
/// and has that parity's sign; in the other it is fixed, and no use is made of it.
#[derive(Clone, Debug)]
pub struct Fold {
    matrix: BlockMatrix<f32>,
    /// Whole-mesh nodes of each node of the half: at x >= 0 and opposite; the same at x = 0.
    nodes: Vec<[u32; 2]>,
    /// Per block of the whole matrix, its place in the row of the half, and which of the `signs`
    /// it gets.
    place: Vec<u16>,
    kind: Vec<u8>,
    /// Of each kind of block, the signs of its entries.
    signs: [[f32; 9]; KINDS],
}

impl Fold {
    /// Plans the fold of matrices with a `pattern` to the nodes `half` (at x >= 0); `mirror` is the
    /// node opposite of each node. `None` if they do not fit each other, or if blocks couple the
    /// two sides.
    pub fn new(pattern: &Pattern, half: &[u32], mirror: &[u32]) -> Option<Self> {
        let mut folded = vec![u32::MAX; pattern.rows()];
        let mut nodes = Vec::with_capacity(half.len());
        for (a, &node) in half.iter().enumerate() {
            let opposite = *mirror.get(node as usize)?;
            *folded.get_mut(node as usize)? = a as u32;
            *folded.get_mut(opposite as usize)? = a as u32;
            nodes.push([node, opposite]);
        }
        if mirror.len() != pattern.rows() || folded.contains(&u32::MAX) {
            return None;
        }
        let side = |node: u32| {
            let [own, opposite] = nodes[folded[node as usize] as usize];
            i32::from(node == own) - i32::from(node == opposite)
        };
        let columns = |node: u32| pattern.row(node as usize).map(|at| pattern.column[at]);
        if (0..pattern.rows() as u32).any(|i| columns(i).any(|j| side(i) * side(j) < 0)) {
            return None;
        }
        let rows = nodes.iter().map(|&[own, opposite]| {
            let mut row: Vec<u32> = columns(own).chain(columns(opposite)).map(|j| folded[j as usize]).collect();
            row.sort_unstable();
            row.dedup();
            row
        });
        let matrix = BlockMatrix::zeros(Pattern::from_rows(rows));
        let mut place = Vec::with_capacity(pattern.entries());
        let mut kind = Vec::with_capacity(pattern.entries());
        for i in 0..pattern.rows() as u32 {
            let row = &matrix.pattern.column[matrix.pattern.row(folded[i as usize] as usize)];
            for j in columns(i) {
                place.push(row.binary_search(&folded[j as usize]).ok()? as u16);
                let at_zero = [i, j].map(|n| u8::from(side(n) == 0));
                let left = [i, j].map(|n| u8::from(side(n) < 0));
                kind.push(left[0] | left[1] << 1 | at_zero[0] << 2 | at_zero[1] << 3);
            }
        }
        Some(Self { matrix, nodes, place, kind, signs: signs() })
    }

    /// Per block of the folded matrix, the blocks of the whole one (places in its `pattern`) that
    /// it sums, with a bit for each of their entries that changes its sign.
    pub fn sources(&self, pattern: &Pattern) -> Vec<Vec<(u32, u32)>> {
        let mut out = vec![Vec::new(); self.matrix.pattern.entries()];
        for (a, &[own, opposite]) in self.nodes.iter().enumerate() {
            let first = self.matrix.pattern.row(a).start;
            let sides = if own == opposite { 1 } else { 2 };
            for at in [own, opposite].into_iter().take(sides).flat_map(|node| pattern.row(node as usize)) {
                let signs = &self.signs[self.kind[at] as usize];
                let bits = (0..9).filter(|&m| signs[m] < 0.0).fold(0, |bits, m| bits | 1 << m);
                out[first + self.place[at] as usize].push((at as u32, bits));
            }
        }
        out
    }
}

impl Folding for Fold {
    fn matrix(&self) -> &BlockMatrix<f32> {
        &self.matrix
    }

    fn nodes(&self) -> &[[u32; 2]] {
        &self.nodes
    }

    fn is_free(&self, parity: Parity, node: usize, component: usize) -> bool {
        let [own, opposite] = self.nodes[node];
        own != opposite || parity.is_free_on_mirror(component)
    }

    fn update(&mut self, whole: &BlockMatrix<f32>) {
        let (nodes, place, kind, signs) = (&self.nodes, &self.place, &self.kind, &self.signs);
        let BlockMatrix { pattern, blocks } = &mut self.matrix;
        let mut nothing = vec![(); nodes.len()];
        each_row(blocks, &pattern.row_start, &mut nothing, |a, row, ()| {
            row.as_flattened_mut().fill(0.0);
            let [own, opposite] = nodes[a];
            let sides = if own == opposite { 1 } else { 2 };
            for &node in &nodes[a][..sides] {
                let range = whole.pattern.row(node as usize);
                for ((block, &b), &kind) in whole.blocks[range.clone()].iter().zip(&place[range.clone()]).zip(&kind[range]) {
                    let (folded, signs) = (&mut row[b as usize], &signs[kind as usize]);
                    for m in 0..9 {
                        folded[m] += signs[m] * block[m];
                    }
                }
            }
        });
    }

    fn fold<R: Into<f64> + Copy + Sync>(&self, parity: Parity, f: &[R], folded: &mut [f32]) {
        let signs = [0, 1, 2].map(|c| f64::from(parity.sign(c)));
        each(folded.as_chunks_mut::<3>().0, |a, folded| {
            let [own, opposite] = self.nodes[a].map(|n| 3 * n as usize);
            for c in 0..3 {
                folded[c] = match own == opposite {
                    true if parity.is_free_on_mirror(c) => f[own + c].into() as f32,
                    true => 0.0,
                    false => (f[own + c].into() + signs[c] * f[opposite + c].into()) as f32,
                };
            }
        });
    }

    fn unfold_add<R: Into<f64> + Copy>(&self, parity: Parity, z: &[R], u: &mut [f64]) {
        let signs = [0, 1, 2].map(|c| f64::from(parity.sign(c)));
        for (z, nodes) in z.as_chunks::<3>().0.iter().zip(&self.nodes) {
            let [own, opposite] = nodes.map(|n| 3 * n as usize);
            for c in 0..3 {
                if own != opposite {
                    u[own + c] += z[c].into();
                    u[opposite + c] += signs[c] * z[c].into();
                } else if parity.is_free_on_mirror(c) {
                    u[own + c] += z[c].into();
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{SphereSpec, sphere_mesh};

    /// Numbers between -1 and 1 that have no pattern.
    fn scattered(i: usize) -> f64 {
        (1.7 * i as f64 + 0.3).sin() * 43758.5453 % 1.0
    }

    #[test]
    fn a_folded_matrix_gives_what_is_even_or_odd_of_the_whole_ones_forces() {
        let mesh = sphere_mesh(&SphereSpec {
            contact_radius: 0.2,
            elements_per_contact_radius: 3,
            fine_zone: 1.3,
            skin_levels: 0,
            first_layer: 1.0,
        })
        .unwrap();
        let half = mesh.half.as_ref().unwrap();
        let opposite = |x: [f64; 3]| mesh.nodes.iter().position(|y| *y == [0.0 - x[0], x[1], x[2]]).unwrap() as u32;
        let mirror: Vec<u32> = mesh.nodes.iter().map(|&x| opposite(x)).collect();
        let pattern = Pattern::from_elements(mesh.nodes.len(), &mesh.elements);
        let mut whole = BlockMatrix::<f32>::zeros(pattern);
        whole.blocks.as_flattened_mut().iter_mut().enumerate().for_each(|(i, a)| *a = scattered(i) as f32);
        let mut fold = Fold::new(&whole.pattern, &half.node, &mirror).unwrap();
        // Twice: nothing is left of the matrix before.
        for _ in 0..2 {
            fold.update(&whole);
        }
        for parity in [Parity::Even, Parity::Odd] {
            let free: Vec<bool> = (0..fold.matrix.unknowns()).map(|i| fold.is_free(parity, i / 3, i % 3)).collect();
            let z: Vec<f32> = (0..free.len()).map(|i| if free[i] { scattered(7 * i) as f32 } else { 0.0 }).collect();
            let mut u = vec![0.0; whole.unknowns()];
            fold.unfold_add(parity, &z, &mut u);
            for (n, &opposite) in mirror.iter().enumerate() {
                for c in 0..3 {
                    assert_eq!(u[3 * n + c], f64::from(parity.sign(c)) * u[3 * opposite as usize + c]);
                }
            }
            let mut f = vec![0.0; u.len()];
            whole.multiply(&u, &mut f);
            let (mut expected, mut got) = (vec![0.0; z.len()], vec![0.0f64; z.len()]);
            fold.fold(parity, &f, &mut expected);
            fold.matrix.multiply(&z, &mut got);
            for i in (0..z.len()).filter(|&i| free[i]) {
                assert!((got[i] - f64::from(expected[i])).abs() < 1e-5, "{parity:?} {i}: {} {}", got[i], expected[i]);
            }
            assert!(expected.iter().zip(&free).all(|(f, free)| *free || *f == 0.0), "nothing drives what is fixed at x = 0");
        }
        // Sides that touch cannot be folded.
        let mut coupled: Vec<Vec<u32>> =
            (0..mesh.nodes.len()).map(|i| whole.pattern.column[whole.pattern.row(i)].to_vec()).collect();
        let right = (0..mirror.len()).find(|&n| mesh.nodes[n][0] > 0.0).unwrap();
        coupled[right].push(mirror[right]);
        coupled[right].sort_unstable();
        assert!(Fold::new(&Pattern::from_rows(coupled.into_iter()), &half.node, &mirror).is_none());
    }
}
