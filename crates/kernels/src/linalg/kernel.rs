//! The products and inverses of 3x3 blocks on which the speed of the preconditioner rests: f32
//! blocks, vectors padded to four numbers a node, whole vector registers.

use wide::{f32x4, f32x8};

use super::bsr::BlockMatrix;
use super::parallel::each;
use crate::lanes::array;

/// Three components and a fourth number that is always 0.
pub(super) type Node = [f32; 4];

/// The inverse of a diagonal block, by padded columns.
pub(super) type Inverse = [Node; 3];

#[inline(always)]
fn eight(a: &[f32; 9]) -> f32x8 {
    f32x8::new([a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7]])
}

#[inline(always)]
fn repeated(x: Node) -> f32x8 {
    f32x8::new([x[0], x[1], x[2], x[0], x[1], x[2], x[0], x[1]])
}

/// Row `i` of A times x. Even and odd entries are summed apart, to hide the latency of the
/// additions.
#[inline(always)]
pub(super) fn row_times(a: &BlockMatrix<f32>, i: usize, x: &[Node]) -> f32x4 {
    let range = a.pattern.row(i);
    let (pairs, last) = a.blocks[range.clone()].as_chunks::<2>();
    let (columns, last_column) = a.pattern.column[range].as_chunks::<2>();
    let (mut even, mut odd) = (f32x8::ZERO, f32x8::ZERO);
    // Eight of a block's nine places fill a register; the ninth goes by itself.
    let (mut even_ninth, mut odd_ninth) = (0.0, 0.0);
    for ([a, b], &[j, k]) in pairs.iter().zip(columns) {
        let (x, y) = (x[j as usize], x[k as usize]);
        even = eight(a).mul_add(repeated(x), even);
        even_ninth += a[8] * x[2];
        odd = eight(b).mul_add(repeated(y), odd);
        odd_ninth += b[8] * y[2];
    }
    for (a, &j) in last.iter().zip(last_column) {
        let x = x[j as usize];
        even = eight(a).mul_add(repeated(x), even);
        even_ninth += a[8] * x[2];
    }
    let s = (even + odd).to_array();
    f32x4::new([s[0] + s[1] + s[2], s[3] + s[4] + s[5], s[6] + s[7] + (even_ninth + odd_ninth), 0.0])
}

impl BlockMatrix<f32> {
    /// y = A x in f32, as fast as the preconditioner's products; `room` is for x with a fourth
    /// number a node.
    pub fn multiply_in_single(&self, x: &[f32], room: &mut Vec<[f32; 4]>, y: &mut [f32]) {
        room.clear();
        room.extend(x.as_chunks::<3>().0.iter().map(|x| [x[0], x[1], x[2], 0.0]));
        let room = room.as_slice();
        each(&mut y.as_chunks_mut::<3>().0[..self.rows()], |i, y| {
            let sum = row_times(self, i, room).to_array();
            *y = [sum[0], sum[1], sum[2]];
        });
    }
}

/// The inverse of a block times r.
#[inline(always)]
pub(super) fn inverse_times(inverse: &Inverse, r: f32x4) -> f32x4 {
    let r = r.to_array();
    let column = |c: usize| f32x4::new(inverse[c]) * f32x4::splat(r[c]);
    column(0) + column(1) + column(2)
}

/// The inverse of a 3x3 block. Components whose row and column vanish are left alone (their inverse
/// is 0, so they receive no correction); a block that is singular to rounding is shifted first.
pub(super) fn invert(block: &[f32; 9]) -> Inverse {
    let mut a = block.map(f64::from);
    let scale = a.iter().fold(0.0_f64, |s, x| s.max(x.abs()));
    let (c, determinant) = cofactors(&a);
    // Nearly always.
    if determinant.abs() >= 1e-7 * scale * scale * scale && determinant.is_normal() {
        let reciprocal = 1.0 / determinant;
        let inverse: [f32; 9] = array(0.0, |m| (c[m] * reciprocal) as f32);
        // A finite number times 0 is 0, all others give NaN.
        if inverse.iter().map(|x| x * 0.0).sum::<f32>() == 0.0 {
            return array([0.0; 4], |c| [inverse[c], inverse[3 + c], inverse[6 + c], 0.0]);
        }
    }
    if scale == 0.0 || !scale.is_finite() {
        return [[0.0; 4]; 3];
    }
    let empty: [bool; 3] = std::array::from_fn(|c| (0..3).all(|k| a[3 * c + k].abs().max(a[3 * k + c].abs()) <= 1e-12 * scale));
    for c in 0..3 {
        if empty[c] {
            a[4 * c] = scale;
        }
    }
    let (mut c, mut determinant) = cofactors(&a);
    if determinant.abs() < 1e-7 * scale * scale * scale {
        for k in 0..3 {
            a[4 * k] += 0.01 * scale.copysign(a[4 * k]);
        }
        (c, determinant) = cofactors(&a);
    }
    let inverse = c.map(|x| (x / determinant) as f32);
    let usable = inverse.iter().all(|x| x.is_finite());
    let entry = |r: usize, c: usize| match (empty[r] || empty[c], usable) {
        (true, _) => 0.0,
        (false, true) => inverse[3 * r + c],
        (false, false) => f32::from(r == c) / scale as f32,
    };
    std::array::from_fn(|c| [entry(0, c), entry(1, c), entry(2, c), 0.0])
}

/// The adjugate and the determinant.
fn cofactors(a: &[f64; 9]) -> ([f64; 9], f64) {
    let c = [
        a[4] * a[8] - a[5] * a[7],
        a[2] * a[7] - a[1] * a[8],
        a[1] * a[5] - a[2] * a[4],
        a[5] * a[6] - a[3] * a[8],
        a[0] * a[8] - a[2] * a[6],
        a[2] * a[3] - a[0] * a[5],
        a[3] * a[7] - a[4] * a[6],
        a[1] * a[6] - a[0] * a[7],
        a[0] * a[4] - a[1] * a[3],
    ];
    (c, a[0] * c[0] + a[1] * c[3] + a[2] * c[6])
}
