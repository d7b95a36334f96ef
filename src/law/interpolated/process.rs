//! Gaussian-process regression (Rasmussen & Williams, Gaussian Processes for Machine Learning,
//! 2006): a smooth function of several inputs from scattered values that carry noise.
//!
//! The covariance is Matern's with nu = 5/2 (eq. 4.17) over inputs that each have a length of
//! their own, a linear part, a constant and noise. Lengths and variances are those of the greatest
//! marginal likelihood (eq. 5.8 and 5.9), found by resilient propagation (Riedmiller & Braun 1993):
//! signs of the gradient alone, which no scale of a length can mislead.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use serde::{Deserialize, Serialize};

use super::inputs::INPUTS;

/// Variance of the constant: no limit, where values have a variance of 1.
const CONSTANT: f64 = 10.0;
/// Where the search starts: logarithms of the lengths, of the variances of the smooth part, of the
/// noise and of the linear part.
const START: [f64; 4] = [1.0, 0.0, -4.0, -1.0];
/// Bounds of each.
const BOUNDS: [[f64; 2]; 4] = [[-2.0, 5.0], [-8.0, 5.0], [-14.0, 0.0], [-8.0, 3.0]];
/// How strongly they are drawn to 0, per sample: a length that says nothing stays finite.
const PULL: f64 = 1e-3;
/// Steps of the search; the first, the least and the greatest change of a logarithm.
const SEARCHES: usize = 60;
const STEPS: [f64; 3] = [0.2, 1e-3, 1.0];
/// Number of logarithms.
const UNKNOWNS: usize = INPUTS + 3;

/// A point in the inputs, each over its deviation.
pub type InputPoint = [f64; INPUTS];

/// One function.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Process {
    /// What it is of.
    pub name: String,
    /// Mean and deviation of its values.
    pub mean: f64,
    /// See `mean`.
    pub deviation: f64,
    /// Lengths over which it changes, of each input in its deviation.
    pub lengths: [f64; INPUTS],
    /// Variances of the smooth part, the noise and the linear part, over deviation^2.
    pub variances: [f64; 3],
    /// A weight for each sample.
    pub weights: Vec<f64>,
}

/// Matern's covariance of two points at this square of their distance, over its variance; and its
/// derivative for that square.
fn matern(square: f64) -> [f64; 2] {
    let r = (5.0 * square).sqrt();
    let decay = (-r).exp();
    [(1.0 + r + r * r / 3.0) * decay, -5.0 / 6.0 * (1.0 + r) * decay]
}

fn square(a: &InputPoint, b: &InputPoint, lengths: &InputPoint) -> f64 {
    (0..INPUTS).map(|i| ((a[i] - b[i]) / lengths[i]).powi(2)).sum()
}

fn dot(a: &InputPoint, b: &InputPoint) -> f64 {
    (0..INPUTS).map(|i| a[i] * b[i]).sum()
}

/// Lengths and variances of their logarithms.
fn of_logarithms(p: &[f64; UNKNOWNS]) -> (InputPoint, [f64; 3]) {
    (std::array::from_fn(|i| p[i].exp()), std::array::from_fn(|i| p[INPUTS + i].exp()))
}

fn factor(places: &[InputPoint], lengths: &InputPoint, variances: [f64; 3]) -> Option<Cholesky<f64, Dyn>> {
    let [smooth, noise, linear] = variances;
    let n = places.len();
    let mut k = DMatrix::zeros(n, n);
    for j in 0..n {
        for i in j..n {
            let (a, b) = (&places[i], &places[j]);
            k[(i, j)] = smooth * matern(square(a, b, lengths))[0] + linear * dot(a, b) + CONSTANT;
        }
        k[(j, j)] += noise;
    }
    Cholesky::new(k)
}

/// Minus the logarithm of the marginal likelihood, a sample, and its gradient.
fn misfit(places: &[InputPoint], values: &DVector<f64>, p: &[f64; UNKNOWNS]) -> Option<(f64, [f64; UNKNOWNS])> {
    let (lengths, variances) = of_logarithms(p);
    let factor = factor(places, &lengths, variances)?;
    let n = places.len() as f64;
    let weights = factor.solve(values);
    let inverse = factor.inverse();
    let determinant: f64 = factor.l_dirty().diagonal().iter().map(|x| x.ln()).sum();
    let mut value = (0.5 * values.dot(&weights) + determinant) / n;
    let mut gradient = [0.0; UNKNOWNS];
    let [smooth, noise, linear] = variances;
    for j in 0..places.len() {
        for i in j..places.len() {
            // Both triangles at once.
            let share = (weights[i] * weights[j] - inverse[(i, j)]) * if i == j { 0.5 } else { 1.0 };
            let (a, b) = (&places[i], &places[j]);
            let [k, slope] = matern(square(a, b, &lengths));
            for d in 0..INPUTS {
                gradient[d] += share * smooth * slope * 2.0 * ((a[d] - b[d]) / lengths[d]).powi(2);
            }
            gradient[INPUTS] -= share * smooth * k;
            gradient[INPUTS + 2] -= share * linear * dot(a, b);
            if i == j {
                gradient[INPUTS + 1] -= share * noise;
            }
        }
    }
    for (slope, p) in gradient.iter_mut().zip(p) {
        *slope = *slope / n + PULL * p;
        value += 0.5 * PULL * p * p;
    }
    Some((value, gradient))
}

/// The logarithms of lengths and variances that are the most likely.
fn most_likely(places: &[InputPoint], values: &DVector<f64>) -> [f64; UNKNOWNS] {
    let kind = |i: usize| if i < INPUTS { 0 } else { i - INPUTS + 1 };
    let mut p: [f64; UNKNOWNS] = std::array::from_fn(|i| START[kind(i)]);
    let [first, least, greatest] = STEPS;
    let (mut step, mut before) = ([first; UNKNOWNS], [0.0; UNKNOWNS]);
    let mut best = (f64::INFINITY, p);
    for _ in 0..SEARCHES {
        let Some((value, mut gradient)) = misfit(places, values, &p) else { break };
        if value < best.0 {
            best = (value, p);
        }
        for i in 0..UNKNOWNS {
            let turn = gradient[i] * before[i];
            if turn > 0.0 {
                step[i] = (1.2 * step[i]).min(greatest);
            } else if turn < 0.0 {
                step[i] = (0.5 * step[i]).max(least);
                gradient[i] = 0.0;
            }
            let [from, to] = BOUNDS[kind(i)];
            if gradient[i] != 0.0 {
                p[i] = (p[i] - gradient[i].signum() * step[i]).clamp(from, to);
            }
        }
        before = gradient;
    }
    best.1
}

impl Process {
    /// The function through `values` at `places`, and what it would be at each if the samples of
    /// the same group were not known. Lengths and variances are those of the samples `tuned`.
    /// `None` if the covariance cannot be factored.
    pub fn fit(
        name: String,
        places: &[InputPoint],
        values: &[f64],
        groups: &[usize],
        tuned: &[usize],
    ) -> Option<(Self, Vec<f64>)> {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let deviation = (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt().max(1e-12);
        let scaled = DVector::from_iterator(values.len(), values.iter().map(|x| (x - mean) / deviation));
        let some: Vec<InputPoint> = tuned.iter().map(|&i| places[i]).collect();
        let logarithms = most_likely(&some, &DVector::from_iterator(tuned.len(), tuned.iter().map(|&i| scaled[i])));
        let (lengths, variances) = of_logarithms(&logarithms);
        let factor = factor(places, &lengths, variances)?;
        let weights = factor.solve(&scaled);
        let unseen = unseen(&factor.inverse(), &weights, &scaled, groups)?;
        let unseen = unseen.iter().map(|x| mean + deviation * x).collect();
        let weights = weights.iter().copied().collect();
        Some((Self { name, mean, deviation, lengths, variances, weights }, unseen))
    }

    /// The value at `place`, the samples being at `places`.
    pub fn at(&self, places: &[InputPoint], place: &InputPoint) -> f64 {
        let [smooth, _, linear] = self.variances;
        let sum: f64 = places
            .iter()
            .zip(&self.weights)
            .map(|(known, weight)| {
                weight * (smooth * matern(square(known, place, &self.lengths))[0] + linear * dot(known, place) + CONSTANT)
            })
            .sum();
        self.mean + self.deviation * sum
    }
}

/// The prediction at each sample from the samples of other groups: y_g less (K^-1)_gg^-1 (K^-1 y)_g
/// (after Rasmussen & Williams 2006, eq. 5.12, for groups).
fn unseen(inverse: &DMatrix<f64>, weights: &DVector<f64>, values: &DVector<f64>, groups: &[usize]) -> Option<DVector<f64>> {
    let mut predicted = values.clone();
    for group in 0..=groups.iter().copied().max().unwrap_or(0) {
        let own: Vec<usize> = (0..groups.len()).filter(|&i| groups[i] == group).collect();
        let block = DMatrix::from_fn(own.len(), own.len(), |i, j| inverse[(own[i], own[j])]);
        let part = DVector::from_iterator(own.len(), own.iter().map(|&i| weights[i]));
        let rest = Cholesky::new(block)?.solve(&part);
        for (i, &place) in own.iter().enumerate() {
            predicted[place] -= rest[i];
        }
    }
    Some(predicted)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points that fill the inputs evenly (R2 of Roberts).
    fn places(n: usize) -> Vec<InputPoint> {
        let base: f64 = 1.0 / 1.1;
        (0..n).map(|i| std::array::from_fn(|d| 4.0 * ((i + 1) as f64 * base.powi(d as i32 + 1)).fract() - 2.0)).collect()
    }

    fn function(p: &InputPoint) -> f64 {
        3.0 + p[0].sin() + 0.5 * p[1] * p[2] - 0.3 * p[5]
    }

    #[test]
    fn it_finds_a_smooth_function_and_the_inputs_that_matter() {
        let places = places(160);
        let values: Vec<f64> = places.iter().map(function).collect();
        let all: Vec<usize> = (0..places.len()).collect();
        let (process, _) = Process::fit("f".to_owned(), &places, &values, &all, &all).unwrap();
        let error = |at: InputPoint| (process.at(&places, &at) - function(&at)).abs();
        assert!(error([0.3, -0.4, 0.9, 0.1, 0.0, 1.0, -0.2, 0.5]) < 0.05);
        assert!(error([-1.3, 0.4, -0.9, 0.7, 0.3, -1.0, 0.2, -0.5]) < 0.05);
        assert!(process.lengths[3] > 4.0 * process.lengths[0], "{:?}", process.lengths);
    }

    #[test]
    fn what_is_left_out_is_predicted_as_if_it_had_never_been_there() {
        let places = places(40);
        let values: Vec<f64> = places.iter().enumerate().map(|(i, p)| function(p) + 0.1 * (i % 3) as f64).collect();
        let groups: Vec<usize> = (0..40).map(|i| i / 4).collect();
        let all: Vec<usize> = (0..40).collect();
        let (process, unseen) = Process::fit("f".to_owned(), &places, &values, &groups, &all).unwrap();
        // The same lengths, variances, mean and deviation without the group 3.
        let rest: Vec<usize> = (0..40).filter(|&i| groups[i] != 3).collect();
        let kept: Vec<InputPoint> = rest.iter().map(|&i| places[i]).collect();
        let known = DVector::from_iterator(rest.len(), rest.iter().map(|&i| (values[i] - process.mean) / process.deviation));
        let weights = factor(&kept, &process.lengths, process.variances).unwrap().solve(&known);
        let without = Process { weights: weights.iter().copied().collect(), ..process };
        for i in 12..16 {
            let direct = without.at(&kept, &places[i]);
            assert!((unseen[i] - direct).abs() < 1e-7, "{} and {direct}", unseen[i]);
        }
    }

    #[test]
    fn the_gradient_is_that_of_the_likelihood() {
        let places = places(30);
        let values = DVector::from_iterator(30, places.iter().map(|p| function(p) - 3.0));
        let p: [f64; UNKNOWNS] = std::array::from_fn(|i| 0.3 + 0.1 * i as f64 - if i > INPUTS { 2.0 } else { 0.0 });
        let (_, gradient) = misfit(&places, &values, &p).unwrap();
        for i in 0..UNKNOWNS {
            let at = |step: f64| {
                let mut moved = p;
                moved[i] += step;
                misfit(&places, &values, &moved).unwrap().0
            };
            let slope = (at(1e-5) - at(-1e-5)) / 2e-5;
            assert!((slope - gradient[i]).abs() < 1e-6 * (1.0 + slope.abs()), "{i}: {slope} and {}", gradient[i]);
        }
    }
}
