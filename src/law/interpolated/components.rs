//! Curves as a mean and a few principal components, by NIPALS (Wold 1966): power iterations, one
//! component after the other.

use serde::{Deserialize, Serialize};

use crate::contact_law::POINTS;

/// Number of components: what is left out is below 0.3 % of the curves.
pub const COMPONENTS: usize = 5;
/// Most iterations of a component, and the change at which it stands.
const ITERATIONS: usize = 2000;
const STANDS: f64 = 1e-12;

/// Values of a curve at its points.
pub type CurveValues = [f64; POINTS];

/// The mean of many curves and the directions in which they differ most, of length 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Components {
    /// The mean.
    pub mean: CurveValues,
    /// The directions, the one with the greatest variance first.
    pub directions: [CurveValues; COMPONENTS],
}

fn dot(a: &CurveValues, b: &CurveValues) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl Components {
    /// Those of `curves`, and how far each curve goes in each direction.
    pub fn of(curves: &[CurveValues]) -> (Self, Vec<[f64; COMPONENTS]>) {
        let n = curves.len() as f64;
        let mean: CurveValues = std::array::from_fn(|j| curves.iter().map(|curve| curve[j]).sum::<f64>() / n);
        let mut rest: Vec<CurveValues> = curves.iter().map(|curve| std::array::from_fn(|j| curve[j] - mean[j])).collect();
        let mut directions = [[0.0; POINTS]; COMPONENTS];
        let mut scores = vec![[0.0; COMPONENTS]; curves.len()];
        for (k, direction) in directions.iter_mut().enumerate() {
            *direction = greatest(&rest);
            for (curve, scores) in rest.iter_mut().zip(&mut scores) {
                scores[k] = dot(curve, direction);
                for j in 0..POINTS {
                    curve[j] -= scores[k] * direction[j];
                }
            }
        }
        (Self { mean, directions }, scores)
    }

    /// The curve that goes so far in each direction.
    pub fn curve(&self, scores: &[f64; COMPONENTS]) -> CurveValues {
        std::array::from_fn(|j| self.mean[j] + (0..COMPONENTS).map(|k| scores[k] * self.directions[k][j]).sum::<f64>())
    }
}

/// The direction of the greatest variance.
fn greatest(curves: &[CurveValues]) -> CurveValues {
    // From the curve that is farthest from the mean.
    let start = curves.iter().max_by(|a, b| dot(a, a).total_cmp(&dot(b, b)));
    let unit = |curve: CurveValues| {
        let length = dot(&curve, &curve).sqrt();
        if length > 0.0 { curve.map(|x| x / length) } else { std::array::from_fn(|j| if j == 0 { 1.0 } else { 0.0 }) }
    };
    let mut direction = unit(start.copied().unwrap_or([0.0; POINTS]));
    for _ in 0..ITERATIONS {
        let mut next = [0.0; POINTS];
        for curve in curves {
            let score = dot(curve, &direction);
            for j in 0..POINTS {
                next[j] += score * curve[j];
            }
        }
        let next = unit(next);
        let change: f64 = (0..POINTS).map(|j| (next[j] - direction[j]).abs()).fold(0.0, f64::max);
        direction = next;
        if change < STANDS {
            break;
        }
    }
    direction
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_of_three_parameters_come_back() {
        let curve = |i: usize| -> CurveValues {
            let t = i as f64;
            std::array::from_fn(|j| {
                let x = j as f64 / 24.0;
                1.0 + (0.3 * t).sin() * x + (0.7 * t).cos() * x * x + 0.2 * (1.1 * t).sin() * (3.0 * x).sin()
            })
        };
        let curves: Vec<CurveValues> = (0..40).map(curve).collect();
        let (components, scores) = Components::of(&curves);
        for (curve, scores) in curves.iter().zip(&scores) {
            let again = components.curve(scores);
            for j in 0..POINTS {
                assert!((again[j] - curve[j]).abs() < 1e-9);
            }
            assert!(scores[3].abs() < 1e-9 && scores[4].abs() < 1e-9, "{scores:?}");
        }
        for (i, a) in components.directions.iter().enumerate().take(3) {
            for (j, b) in components.directions.iter().enumerate().take(3) {
                assert!((dot(a, b) - f64::from(u8::from(i == j))).abs() < 1e-9);
            }
        }
    }
}
