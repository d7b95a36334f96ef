//! Smooth curves through few points that carry a ripple: natural cubic splines and their smoothing
//! (Reinsch, Numer. Math. 10, 1967; Green & Silverman, Nonparametric Regression, 1994, ch. 2).

use nalgebra::{DMatrix, DVector};

/// A natural cubic spline; beyond its ends it goes on straight.
#[derive(Clone, Debug, PartialEq)]
pub struct Spline {
    x: Vec<f64>,
    y: Vec<f64>,
    /// Second derivatives at the points.
    bend: Vec<f64>,
}

/// Penalties of the bending that are tried, over the cube of the mean spacing. The least takes
/// three quarters of what alternates from point to point, and half a per cent of what goes up and
/// down within ten of them.
const PENALTIES: [f64; 4] = [0.03, 0.1, 0.3, 1.0];

/// Q and R of the bending: the second derivatives at the inner points are R^-1 Q^T y, and the
/// integral of their square is y^T Q R^-1 Q^T y.
fn bending(x: &[f64]) -> (DMatrix<f64>, DMatrix<f64>) {
    let n = x.len();
    let (mut q, mut r) = (DMatrix::zeros(n, n - 2), DMatrix::zeros(n - 2, n - 2));
    for j in 0..n - 2 {
        let (before, after) = (x[j + 1] - x[j], x[j + 2] - x[j + 1]);
        q[(j, j)] = 1.0 / before;
        q[(j + 1, j)] = -1.0 / before - 1.0 / after;
        q[(j + 2, j)] = 1.0 / after;
        r[(j, j)] = (before + after) / 3.0;
        if j + 1 < n - 2 {
            r[(j, j + 1)] = after / 6.0;
            r[(j + 1, j)] = after / 6.0;
        }
    }
    (q, r)
}

impl Spline {
    /// Through the points, whose x increase.
    pub fn through(x: &[f64], y: &[f64]) -> Self {
        let mut bend = vec![0.0; x.len()];
        if x.len() > 2 {
            let (q, r) = bending(x);
            let inner = r.lu().solve(&(q.transpose() * DVector::from_column_slice(y)));
            // R is diagonally dominant.
            if let Some(inner) = inner {
                bend[1..x.len() - 1].copy_from_slice(inner.as_slice());
            }
        }
        Self { x: x.to_vec(), y: y.to_vec(), bend }
    }

    /// Its value.
    pub fn at(&self, x: f64) -> f64 {
        let n = self.x.len();
        if n < 2 {
            return self.y.first().copied().unwrap_or(0.0);
        }
        let i = self.x.partition_point(|&known| known <= x).clamp(1, n - 1) - 1;
        let width = self.x[i + 1] - self.x[i];
        let u = (x - self.x[i]) / width;
        let straight = self.y[i] + u * (self.y[i + 1] - self.y[i]);
        if !(0.0..=1.0).contains(&u) {
            // The slope at the end, from which it goes on.
            let rise = (self.y[i + 1] - self.y[i]) / width;
            let [m0, m1] = [self.bend[i], self.bend[i + 1]];
            return if u < 0.0 {
                self.y[i] + u * width * (rise - width * (2.0 * m0 + m1) / 6.0)
            } else {
                self.y[i + 1] + (u - 1.0) * width * (rise + width * (m0 + 2.0 * m1) / 6.0)
            };
        }
        let cubic = |u: f64| u * u * u - u;
        straight + width * width / 6.0 * (cubic(1.0 - u) * self.bend[i] + cubic(u) * self.bend[i + 1])
    }
}

/// Values of a smooth curve at the points of one that carries a ripple. How smooth is left to
/// generalised cross-validation (Craven & Wahba, Numer. Math. 31, 1979), over all `columns`
/// together: they are of the same mesh.
pub fn smooth(x: &[f64], columns: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let n = x.len();
    if n < 6 {
        return columns.to_vec();
    }
    let (q, r) = bending(x);
    let Some(inverse) = r.try_inverse() else { return columns.to_vec() };
    let penalty = &q * inverse * q.transpose();
    let spacing = (x[n - 1] - x[0]) / (n - 1) as f64;
    let hats: Vec<DMatrix<f64>> = PENALTIES
        .iter()
        .filter_map(|weight| (DMatrix::identity(n, n) + &penalty * (weight * spacing.powi(3))).try_inverse())
        .collect();
    columns
        .iter()
        .map(|column| {
            let y = DVector::from_column_slice(column);
            let score = |hat: &DMatrix<f64>| {
                let rest = n as f64 - hat.trace();
                (hat * &y - &y).norm_squared() / (rest * rest)
            };
            let best = hats.iter().min_by(|a, b| score(a).total_cmp(&score(b)));
            best.map_or_else(|| column.clone(), |hat| (hat * &y).as_slice().to_vec())
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spline_goes_through_its_points_and_is_exact_for_straight_lines() {
        let x = [0.0, 1.0, 1.5, 3.0, 4.0];
        let y = [1.0, -1.0, 0.0, 2.0, 5.0];
        let spline = Spline::through(&x, &y);
        for (x, y) in x.iter().zip(y) {
            assert!((spline.at(*x) - y).abs() < 1e-12);
        }
        // Continuous in value and slope, at the ends too.
        for at in [0.0, 1.0, 1.5, 3.0, 4.0] {
            let slope = |x: f64| (spline.at(x + 1e-6) - spline.at(x - 1e-6)) / 2e-6;
            assert!((slope(at - 2e-6) - slope(at + 2e-6)).abs() < 1e-4, "{at}");
        }
        let line = Spline::through(&x, &x.map(|x| 2.0 * x - 1.0));
        assert!([-1.0, 0.3, 2.2, 7.0].iter().all(|&x| (line.at(x) - (2.0 * x - 1.0)).abs() < 1e-12));
    }

    #[test]
    fn a_ripple_is_taken_out_and_a_bend_is_kept() {
        let x: Vec<f64> = (0..15).map(f64::from).collect();
        let bend = |x: f64| (0.25 * x).sin();
        let ripple = |i: usize| 0.01 * if i * i % 7 < 3 { 1.0 } else { -1.0 };
        let y: Vec<f64> = x.iter().enumerate().map(|(i, &x)| bend(x) + ripple(i)).collect();
        let smoothed = &smooth(&x, std::slice::from_ref(&y))[0];
        let error = |y: &[f64]| (x.iter().zip(y).map(|(&x, y)| (y - bend(x)).powi(2)).sum::<f64>() / 15.0).sqrt();
        assert!(error(smoothed) < 0.8 * error(&y), "{} of {}", error(smoothed), error(&y));
        let exact: Vec<f64> = x.iter().map(|&x| bend(x)).collect();
        assert!(error(&smooth(&x, &[exact])[0]) < 2e-3);
    }
}
