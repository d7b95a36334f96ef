//! Smoothers: block Gauss-Seidel by colours and Chebyshev acceleration of block Jacobi.

use super::bsr::{BlockMatrix, Pattern, for_rows};
use super::vector::norm;

/// How the levels of the hierarchy are smoothed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Smoother {
    /// Block Gauss-Seidel: `sweeps` forward sweeps through the colours before the coarse correction, as many backward ones after it.
    GaussSeidel {
        /// Sweeps on either side of the coarse correction, at least 1.
        sweeps: usize,
    },
    /// Chebyshev polynomial of block Jacobi on `[0.05, 1.1]` times the largest eigenvalue (Adams et al., J. Comput. Phys. 188, 2003).
    Chebyshev {
        /// Degree of the polynomial, at least 1.
        degree: usize,
    },
}

impl Default for Smoother {
    fn default() -> Self {
        Self::GaussSeidel { sweeps: 1 }
    }
}

/// Rows in an order in which nodes of one colour, none coupled with another of it, follow each other. Greedy in the given order.
///
/// Returns the node of each row.
pub(super) fn color_order(pattern: &Pattern) -> Vec<u32> {
    const NONE: u32 = u32::MAX;
    let rows = pattern.rows();
    let mut color = vec![NONE; rows];
    let mut used = Vec::new();
    let mut colors = 0;
    for i in 0..rows {
        used.clear();
        used.resize(colors + 1, false);
        for &j in &pattern.column[pattern.row(i)] {
            if color[j as usize] != NONE {
                used[color[j as usize] as usize] = true;
            }
        }
        let free = used.iter().position(|used| !used).unwrap_or(colors);
        color[i] = free as u32;
        colors = colors.max(free + 1);
    }
    let mut order: Vec<u32> = (0..rows as u32).collect();
    order.sort_by_key(|&i| color[i as usize]);
    order
}

/// The rows at which runs of rows begin that are not coupled with each other, and the end of the last.
fn runs(pattern: &Pattern) -> Vec<usize> {
    let mut start = vec![0];
    for i in 0..pattern.rows() {
        let before = pattern.diagonal[i] as usize;
        if before > pattern.row_start[i] as usize && pattern.column[before - 1] as usize >= start[start.len() - 1] {
            start.push(i);
        }
    }
    start.push(pattern.rows());
    start
}

/// The inverse of a 3x3 block. Components whose row and column vanish are left alone (their inverse is 0, so they receive no
/// correction); a block that is singular to rounding is shifted first.
pub(super) fn invert(block: &[f32; 9]) -> [f32; 9] {
    let mut a = block.map(f64::from);
    let scale = a.iter().fold(0.0_f64, |s, x| s.max(x.abs()));
    if scale == 0.0 || !scale.is_finite() {
        return [0.0; 9];
    }
    let empty: [bool; 3] = std::array::from_fn(|c| (0..3).all(|k| a[3 * c + k].abs().max(a[3 * k + c].abs()) <= 1e-12 * scale));
    for c in 0..3 {
        if empty[c] {
            a[4 * c] = scale;
        }
    }
    let cofactors = |a: &[f64; 9]| {
        [
            a[4] * a[8] - a[5] * a[7],
            a[2] * a[7] - a[1] * a[8],
            a[1] * a[5] - a[2] * a[4],
            a[5] * a[6] - a[3] * a[8],
            a[0] * a[8] - a[2] * a[6],
            a[2] * a[3] - a[0] * a[5],
            a[3] * a[7] - a[4] * a[6],
            a[1] * a[6] - a[0] * a[7],
            a[0] * a[4] - a[1] * a[3],
        ]
    };
    let mut c = cofactors(&a);
    let mut determinant = a[0] * c[0] + a[1] * c[3] + a[2] * c[6];
    if determinant.abs() < 1e-7 * scale * scale * scale {
        for k in 0..3 {
            a[4 * k] += 0.01 * scale * a[4 * k].signum();
        }
        c = cofactors(&a);
        determinant = a[0] * c[0] + a[1] * c[3] + a[2] * c[6];
    }
    let mut inverse = c.map(|x| (x / determinant) as f32);
    if inverse.iter().any(|x| !x.is_finite()) {
        inverse = std::array::from_fn(|m| if m % 4 == 0 { (1.0 / scale) as f32 } else { 0.0 });
    }
    for k in 0..3 {
        if empty[k] {
            inverse[4 * k] = 0.0;
        }
    }
    inverse
}

#[inline(always)]
fn times(a: &[f32; 9], x: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|r| a[3 * r] * x[0] + a[3 * r + 1] * x[1] + a[3 * r + 2] * x[2])
}

#[inline(always)]
fn minus(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|c| a[c] - b[c])
}

/// A level's matrix with what its smoother needs.
#[derive(Clone, Debug)]
pub(super) struct Smoothed {
    pub matrix: BlockMatrix<f32>,
    /// Inverses of the diagonal blocks.
    inverse: Vec<[f32; 9]>,
    /// Rows at which colours start.
    colors: Vec<usize>,
    /// Largest eigenvalue of D^-1 A, by power iteration, and the vector it was found with (Chebyshev only).
    largest: f32,
    vector: Vec<[f32; 3]>,
    /// Work: the step of Chebyshev's recurrence and the next iterate.
    step: Vec<[f32; 3]>,
    next: Vec<[f32; 3]>,
}

impl Smoothed {
    /// On a pattern whose rows are sorted by colour.
    pub fn new(pattern: Pattern) -> Self {
        let rows = pattern.rows();
        let colors = runs(&pattern);
        Self {
            matrix: BlockMatrix::zeros(pattern),
            inverse: vec![[0.0; 9]; rows],
            colors,
            largest: 0.0,
            vector: Vec::new(),
            step: vec![[0.0; 3]; rows],
            next: vec![[0.0; 3]; rows],
        }
    }

    pub fn rows(&self) -> usize {
        self.inverse.len()
    }

    /// After the matrix changed.
    pub fn update(&mut self, smoother: Smoother) {
        let (blocks, diagonal) = (&self.matrix.blocks, &self.matrix.pattern.diagonal);
        for_rows(&mut self.inverse, |i, inverse| *inverse = invert(&blocks[diagonal[i] as usize]));
        if let Smoother::Chebyshev { .. } = smoother {
            self.find_largest_eigenvalue();
        }
    }

    fn find_largest_eigenvalue(&mut self) {
        let mut iterations = 3;
        if self.vector.is_empty() {
            // A fixed sequence without structure (the golden ratio's multiples modulo 1).
            let value = |k: usize| ((k as f64 * 0.618_033_988_749_894_9).fract() - 0.5) as f32;
            self.vector = (0..self.rows()).map(|i| [value(3 * i + 1), value(3 * i + 2), value(3 * i + 3)]).collect();
            iterations = 12;
        }
        let mut largest = 0.0;
        for _ in 0..iterations {
            let length = norm(self.vector.as_flattened()) as f32;
            if !(length > 0.0 && length.is_finite()) {
                self.vector.clear();
                break;
            }
            let (matrix, inverse, vector) = (&self.matrix, &self.inverse, &self.vector);
            for_rows(&mut self.next, |i, y| {
                *y = times(&inverse[i], matrix.part_times(matrix.pattern.row(i), vector)).map(|y| y / length);
            });
            std::mem::swap(&mut self.vector, &mut self.next);
            largest = norm(self.vector.as_flattened()) as f32;
        }
        self.largest = if largest > 0.0 { largest } else { 1.0 };
    }

    /// x = the smoother applied to b from x = 0, r = b - A x.
    pub fn smooth_from_zero(&mut self, smoother: Smoother, b: &[[f32; 3]], x: &mut [[f32; 3]], r: &mut [[f32; 3]]) {
        match smoother {
            Smoother::GaussSeidel { sweeps: 1 } => {
                self.forward_from_zero(b, x);
                let (matrix, end) = (&self.matrix, &self.matrix.pattern.row_start);
                // Rows are satisfied with later colours at 0: what is left is what later colours changed.
                for_rows(r, |i, r| {
                    let later = matrix.pattern.diagonal[i] as usize + 1..end[i + 1] as usize;
                    *r = matrix.part_times(later, x).map(|y: f32| -y);
                });
            }
            Smoother::GaussSeidel { sweeps } => {
                self.forward_from_zero(b, x);
                for _ in 1..sweeps {
                    self.sweep(b, x, false);
                }
                self.residual(b, x, r);
            }
            Smoother::Chebyshev { degree } => {
                self.chebyshev(degree, b, x, true);
                self.residual(b, x, r);
            }
        }
    }

    /// Smooths x towards A x = b, in the order adjoint to [`Smoothed::smooth_from_zero`].
    pub fn smooth(&mut self, smoother: Smoother, b: &[[f32; 3]], x: &mut [[f32; 3]]) {
        match smoother {
            Smoother::GaussSeidel { sweeps } => (0..sweeps).for_each(|_| self.sweep(b, x, true)),
            Smoother::Chebyshev { degree } => self.chebyshev(degree, b, x, false),
        }
    }

    fn residual(&self, b: &[[f32; 3]], x: &[[f32; 3]], r: &mut [[f32; 3]]) {
        let matrix = &self.matrix;
        for_rows(r, |i, r| *r = minus(b[i], matrix.part_times(matrix.pattern.row(i), x)));
    }

    fn forward_from_zero(&self, b: &[[f32; 3]], x: &mut [[f32; 3]]) {
        let (matrix, diagonal, start) = (&self.matrix, &self.matrix.pattern.diagonal, &self.matrix.pattern.row_start);
        for color in self.colors.windows(2) {
            let (before, rest) = x.split_at_mut(color[0]);
            for_rows(&mut rest[..color[1] - color[0]], |k, x| {
                let i = color[0] + k;
                let sum = matrix.part_times(start[i] as usize..diagonal[i] as usize, before);
                *x = times(&self.inverse[i], minus(b[i], sum));
            });
        }
    }

    /// One Gauss-Seidel sweep through the colours.
    fn sweep(&self, b: &[[f32; 3]], x: &mut [[f32; 3]], backward: bool) {
        let colors = self.colors.len() - 1;
        let (matrix, diagonal, start) = (&self.matrix, &self.matrix.pattern.diagonal, &self.matrix.pattern.row_start);
        for c in 0..colors {
            let c = if backward { colors - 1 - c } else { c };
            let (first, last) = (self.colors[c], self.colors[c + 1]);
            let (before, rest) = x.split_at_mut(first);
            let (mine, after) = rest.split_at_mut(last - first);
            for_rows(mine, |k, x| {
                let i = first + k;
                let earlier = matrix.part_times(start[i] as usize..diagonal[i] as usize, before);
                let later = matrix.part_times_from(diagonal[i] as usize + 1..start[i + 1] as usize, last, after);
                *x = times(&self.inverse[i], minus(minus(b[i], earlier), later));
            });
        }
    }

    /// Chebyshev's recurrence (Saad, Iterative Methods, 2nd ed., Algorithm 12.1) for D^-1 A x = D^-1 b.
    fn chebyshev(&mut self, degree: usize, b: &[[f32; 3]], x: &mut [[f32; 3]], from_zero: bool) {
        let (low, high) = (0.05 * self.largest, 1.1 * self.largest);
        let (center, half) = ((high + low) / 2.0, (high - low) / 2.0);
        let mut rho = half / center;
        let (mut keep, mut add) = (0.0, 1.0 / center);
        for k in 0..degree {
            let (matrix, inverse) = (&self.matrix, &self.inverse);
            if k == 0 && from_zero {
                for_rows(&mut self.step, |i, d| *d = times(&inverse[i], b[i]).map(|z| add * z));
                x.copy_from_slice(&self.step);
            } else {
                let x_now: &[[f32; 3]] = x;
                for_rows(&mut self.step, |i, d| {
                    let r = minus(b[i], matrix.part_times(matrix.pattern.row(i), x_now));
                    let z = times(&inverse[i], r);
                    *d = std::array::from_fn(|c| keep * d[c] + add * z[c]);
                });
                for (x, d) in x.iter_mut().zip(&self.step) {
                    for c in 0..3 {
                        x[c] += d[c];
                    }
                }
            }
            let next = 1.0 / (2.0 * center / half - rho);
            (keep, add) = (next * rho, 2.0 * next / half);
            rho = next;
        }
    }
}
