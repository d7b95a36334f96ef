//! The product on which the speed of the preconditioner rests: f32 blocks, vectors padded to four
//! numbers a node, whole vector registers.

use wide::{f32x4, f32x8};

use super::bsr::BlockMatrix;

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

/// The inverse of a block times r.
#[inline(always)]
pub(super) fn inverse_times(inverse: &Inverse, r: f32x4) -> f32x4 {
    let r = r.to_array();
    let column = |c: usize| f32x4::new(inverse[c]) * f32x4::splat(r[c]);
    column(0) + column(1) + column(2)
}
