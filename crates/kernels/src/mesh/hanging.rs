//! Hanging nodes, eliminated element by element.
//!
//! Where a cell that is split in eight meets one that is not, some corners of the eight lie in the
//! middle of an edge or a face of the other: they hang, and are the mean of its two or four corners
//! there. Such a corner is no node. Its element names the corner of the split cell on the same side
//! in its place, its *carrier*. All corners from which the mean is taken are then named by the
//! element (see [`Hanging::members`]), so x = T x_carriers at its corners, T^T f at its carriers,
//! and T^T K T in the same 36 blocks: lists, patterns and matrices know nothing of it. Its twin
//! `shaders/element/hanging.wgsl` gives the named nodes' shape functions T^T N instead.

use crate::real::Real;

/// Corners of an element, in VTK_HEXAHEDRON order.
const CORNERS: usize = 8;

/// Which corners of an element hang.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Hanging {
    /// Which of the eight children of a split cell the element is: the corner that it has in common
    /// with it.
    octant: u8,
    /// A bit for each corner that hangs.
    corners: u8,
}

/// The sides of a corner along the element's three directions, one bit each.
const fn sides(corner: usize) -> usize {
    // VTK_HEXAHEDRON runs round its faces: 0, 1, 3, 2.
    let [x, y] = [[0, 0], [1, 0], [1, 1], [0, 1]][corner % 4];
    x | y << 1 | (corner / 4) << 2
}

impl Hanging {
    /// No corner hangs.
    pub const NONE: Self = Self { octant: 0, corners: 0 };

    /// Of the child `octant` of a cell, those for which `hangs` says so.
    pub fn new(octant: usize, hangs: impl Fn(usize) -> bool) -> Self {
        let corners = (0..CORNERS).filter(|&a| hangs(a)).fold(0, |bits, a| bits | 1 << a);
        if corners == 0 { Self::NONE } else { Self { octant: octant as u8, corners } }
    }

    /// The same of an element that names its corners in another order: `from[a]` is the corner that
    /// is now `a`.
    pub fn renamed(self, from: [usize; CORNERS]) -> Self {
        let octant = from.iter().position(|&corner| corner == self.octant()).unwrap_or(0);
        Self::new(octant, |a| self.hangs(from[a]))
    }

    /// No corner hangs.
    #[inline(always)]
    pub fn is_none(self) -> bool {
        self.corners == 0
    }

    /// Which of the eight children of a split cell the element is; 0 where no corner hangs.
    #[inline]
    pub fn octant(self) -> usize {
        self.octant.into()
    }

    /// Whether a corner hangs.
    #[inline(always)]
    pub fn hangs(self, corner: usize) -> bool {
        self.corners >> corner & 1 != 0
    }

    /// The corners whose names are those of the nodes from which a corner takes the mean; itself
    /// where it does not hang.
    #[inline]
    pub fn members(self, corner: usize) -> impl Iterator<Item = usize> {
        // Those between the common corner and it.
        let (from, to) = (sides(self.octant as usize), sides(corner));
        let (fixed, hangs) = (!(from ^ to) & 7, self.hangs(corner));
        (0..CORNERS).filter(move |&c| if hangs { (sides(c) ^ from) & fixed == 0 } else { c == corner })
    }

    /// T: the share of each named node in each corner.
    #[inline]
    pub fn shares<R: Real>(self) -> [[R; CORNERS]; CORNERS] {
        let mut shares = [[R::ZERO; CORNERS]; CORNERS];
        for (corner, row) in shares.iter_mut().enumerate() {
            let share = R::of(1.0 / self.members(corner).count() as f64);
            self.members(corner).for_each(|c| row[c] = share);
        }
        shares
    }

    /// The values at the corners, in place of those of the named nodes.
    #[inline]
    pub fn to_corners<R: Real>(self, x: &mut [[R; 3]; CORNERS]) {
        let (shares, named) = (self.shares::<R>(), *x);
        for (out, row) in x.iter_mut().zip(&shares) {
            *out = [0, 1, 2].map(|i| row.iter().zip(&named).fold(R::ZERO, |sum, (&w, x)| sum + w * x[i]));
        }
    }

    /// The forces at the named nodes, in place of those at the corners.
    #[inline]
    pub fn to_named<R: Real>(self, f: &mut [[R; 3]; CORNERS]) {
        let (shares, own) = (self.shares::<R>(), *f);
        for (named, out) in f.iter_mut().enumerate() {
            *out = [0, 1, 2].map(|i| shares.iter().zip(&own).fold(R::ZERO, |sum, (row, f)| sum + row[named] * f[i]));
        }
    }

    /// The stiffness of the named nodes, in place of that of the corners. Blocks row by row, those
    /// of two corners a <= b at `pair(a, b)`.
    pub fn to_named_tangent<R: Real>(self, tangent: &mut [[R; 9]], pair: impl Fn(usize, usize) -> usize) {
        let shares = self.shares::<R>();
        let transposed = |k: [R; 9]| [k[0], k[3], k[6], k[1], k[4], k[7], k[2], k[5], k[8]];
        let own = |a: usize, b: usize| if a <= b { tangent[pair(a, b)] } else { transposed(tangent[pair(b, a)]) };
        let add = |sum: &mut [R; 9], w: R, k: &[R; 9]| sum.iter_mut().zip(k).for_each(|(s, &k)| *s += w * k);
        // K T, by columns of T.
        let mut product = [[[R::ZERO; 9]; CORNERS]; CORNERS];
        for (a, row) in product.iter_mut().enumerate() {
            for b in 0..CORNERS {
                let block = own(a, b);
                (0..CORNERS).filter(|&d| shares[b][d] != R::ZERO).for_each(|d| add(&mut row[d], shares[b][d], &block));
            }
        }
        for c in 0..CORNERS {
            for d in c..CORNERS {
                let mut sum = [R::ZERO; 9];
                (0..CORNERS).filter(|&a| shares[a][c] != R::ZERO).for_each(|a| add(&mut sum, shares[a][c], &product[a][d]));
                tangent[pair(c, d)] = sum;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::hex8::{PAIRS, pair};
    use crate::mesh::quality::CORNERS as NATURAL;

    /// A corner of a child in the coordinates of its parent, which run from -1 to 1.
    fn in_parent(octant: usize, corner: usize) -> [f64; 3] {
        [0, 1, 2].map(|k| 0.5 * (NATURAL[octant][k] + NATURAL[corner][k]))
    }

    /// Every set of corners of a child that can hang: those on edges and faces of its parent.
    fn all() -> Vec<(usize, Hanging)> {
        let mut all = Vec::new();
        for octant in 0..CORNERS {
            for corners in 0..256usize {
                let hanging = Hanging::new(octant, |a| corners >> a & 1 != 0);
                let sound = (0..CORNERS).filter(|&a| hanging.hangs(a)).all(|a| {
                    let middle = in_parent(octant, a).iter().filter(|x| **x == 0.0).count();
                    // With a face's middle its edges' hang too.
                    (1..=2).contains(&middle) && (middle == 1 || hanging.members(a).all(|c| c == octant || hanging.hangs(c)))
                });
                if sound {
                    all.push((octant, hanging));
                }
            }
        }
        all
    }

    #[test]
    fn a_corner_that_hangs_is_the_mean_of_nodes_that_its_element_names() {
        let all = all();
        assert!(all.len() > 8 * 10);
        for (octant, hanging) in all {
            // What the element names: corners of its parent for those that hang, its own for the
            // rest.
            let mut x: [[f64; 3]; CORNERS] =
                std::array::from_fn(|a| if hanging.hangs(a) { NATURAL[a] } else { in_parent(octant, a) });
            hanging.to_corners(&mut x);
            let own: [[f64; 3]; CORNERS] = std::array::from_fn(|a| in_parent(octant, a));
            assert_eq!(x, own, "{octant} {hanging:?}");
            for row in hanging.shares::<f64>() {
                assert_eq!(row.iter().sum::<f64>(), 1.0);
            }
        }
    }

    #[test]
    fn forces_and_stiffnesses_go_with_the_work_that_they_do() {
        for (_, hanging) in all() {
            let number = |a: usize, i: usize| ((7 * a + 3 * i) as f64 * 0.61).sin();
            let named: [[f64; 3]; CORNERS] = std::array::from_fn(|a| [0, 1, 2].map(|i| number(a, i)));
            let force: [[f64; 3]; CORNERS] = std::array::from_fn(|a| [0, 1, 2].map(|i| number(a + 9, i)));
            let work = |f: &[[f64; 3]; 8], x: &[[f64; 3]; 8]| -> f64 {
                f.iter().flatten().zip(x.iter().flatten()).map(|(f, x)| f * x).sum()
            };
            let (mut x, mut f) = (named, force);
            hanging.to_corners(&mut x);
            hanging.to_named(&mut f);
            assert!((work(&force, &x) - work(&f, &named)).abs() < 1e-13);

            let mut tangent = [[0.0; 9]; PAIRS];
            for a in 0..CORNERS {
                for b in a..CORNERS {
                    tangent[pair(a, b)] = std::array::from_fn(|m| {
                        // Symmetric on the diagonal.
                        let m = if a == b { (m / 3).min(m % 3) * 3 + (m / 3).max(m % 3) } else { m };
                        number(8 * a + b, m)
                    });
                }
            }
            let times = |k: &[[f64; 9]; PAIRS], x: &[[f64; 3]; 8]| -> [[f64; 3]; 8] {
                std::array::from_fn(|a| {
                    [0, 1, 2].map(|i| {
                        let entry = |b: usize, j: usize| if a <= b { k[pair(a, b)][3 * i + j] } else { k[pair(b, a)][3 * j + i] };
                        (0..8).flat_map(|b| (0..3).map(move |j| (b, j))).map(|(b, j)| entry(b, j) * x[b][j]).sum()
                    })
                })
            };
            let mut expected = times(&tangent, &x);
            hanging.to_named(&mut expected);
            hanging.to_named_tangent(&mut tangent, pair);
            let got = times(&tangent, &named);
            assert!(got.iter().flatten().zip(expected.iter().flatten()).all(|(g, e)| (g - e).abs() < 1e-12), "{hanging:?}");
        }
    }
}
