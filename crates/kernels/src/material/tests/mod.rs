//! One file a theme; what they share is here.

mod eight;
mod hardening;
mod invariance;
mod multistep;
mod precision;
mod sweep;
mod tangent;
mod uniaxial;

use super::{Elasticity, FlowStress, Material, PointState};
use crate::real::Real;

/// 3 x 3, rows first.
pub type Matrix = [[f64; 3]; 3];

pub const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

pub fn multiply(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|k| a[i][0] * b[0][k] + a[i][1] * b[1][k] + a[i][2] * b[2][k]))
}

pub fn transpose(a: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|k| a[k][i]))
}

/// Every law, at parameters of the order E = 1.
pub fn laws<R: Real>() -> Vec<(&'static str, FlowStress<R>)> {
    vec![
        ("elastic", FlowStress::Elastic),
        ("ideal", FlowStress::ideal(2e-3).unwrap()),
        ("linear", FlowStress::linear(2e-3, 0.05).unwrap()),
        ("power 0.3", FlowStress::power(2e-3, 5e-3, 0.3).unwrap()),
        ("power 0.1", FlowStress::power(2e-3, 5e-3, 0.1).unwrap()),
        ("power 1", FlowStress::power(2e-3, 5e-3, 1.0).unwrap()),
        ("hollomon 3", FlowStress::hollomon(0.02, 3.0, 1.0).unwrap()),
        ("hollomon 10", FlowStress::hollomon(5e-3, 10.0, 1.0).unwrap()),
        ("voce", FlowStress::voce(2e-3, 5e-3, 20.0).unwrap()),
        ("table", FlowStress::table(&[[0.0, 2e-3], [0.01, 3e-3], [0.05, 3.5e-3], [0.3, 5e-3]]).unwrap()),
    ]
}

pub fn material<R: Real>(hardening: FlowStress<R>) -> Material<R> {
    Material { elasticity: Elasticity::new(1.0, 0.3), hardening }
}

/// d = f - I pushed through the mapping, in f64; panics (in a test) where the mapping reports an
/// error.
pub fn respond(material: &Material<f64>, d: &Matrix, state: &PointState<f64>) -> super::Response<f64> {
    super::return_mapping(material, d, state).unwrap()
}

/// A rotation by `angle` about an axis, Rodrigues' formula.
pub fn rotation(axis: [f64; 3], angle: f64) -> Matrix {
    let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    let [x, y, z] = axis.map(|a| a / length);
    let (sine, cosine) = angle.sin_cos();
    let cross = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    let square = multiply(&cross, &cross);
    std::array::from_fn(|i| std::array::from_fn(|k| IDENTITY[i][k] + sine * cross[i][k] + (1.0 - cosine) * square[i][k]))
}

pub fn full(a: &[f64; 6]) -> Matrix {
    [[a[0], a[3], a[5]], [a[3], a[1], a[4]], [a[5], a[4], a[2]]]
}

pub fn symmetric(a: &Matrix) -> [f64; 6] {
    [a[0][0], a[1][1], a[2][2], a[0][1], a[1][2], a[2][0]]
}

/// det(I + B) - 1 of a symmetric B.
pub fn determinant_excess(be: &[f64; 6]) -> f64 {
    super::j2::determinant_minus_one(&full(be))
}

/// The largest difference between two lists of components.
pub fn distance(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    a.iter().zip(b).fold(0.0, |worst, (x, y)| (x - y).abs().max(worst))
}

/// sqrt(3/2) |s|.
pub fn von_mises(s: &[f64; 6]) -> f64 {
    (1.5 * super::j2::norm_squared(s)).sqrt()
}
