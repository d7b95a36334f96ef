//! The shapes f_T(x) and f_N(x) of the virgin curves, of formulas or by numbers, their derivatives
//! and inverses.

use super::virgin::{BY_NUMBERS, ContactParameters, POINTS, Virgin};

/// x at point `j` of a shape that is given by numbers.
fn point_x(j: usize) -> f64 {
    let share = j as f64 / POINTS as f64;
    share * share
}

/// A shape that is given by numbers and its derivative, straight from point to point, 0 <= x <= 1.
fn given(shape: &[f64; POINTS], x: f64) -> [f64; 2] {
    if x >= 1.0 {
        return [shape[POINTS - 1], 0.0];
    }
    let mut j = (POINTS as f64 * x.sqrt()) as usize;
    if j > POINTS - 1 {
        j = POINTS - 1;
    }
    let below = if j == 0 { 0.0 } else { shape[j - 1] };
    let slope = (shape[j] - below) / (point_x(j + 1) - point_x(j));
    [below + slope * (x - point_x(j)), slope]
}

/// The least x at which a shape that is given by numbers has the value `f`, or that of its peak;
/// and the point before it.
fn given_inverse(shape: &[f64; POINTS], f: f64) -> (f64, usize) {
    if f <= 0.0 {
        return (0.0, 0);
    }
    let (mut peak, mut place) = (0.0, (0.0, 0));
    for (j, &here) in shape.iter().enumerate() {
        if here >= f {
            return (given_between(shape, f, j), j);
        }
        if here > peak {
            (peak, place) = (here, (point_x(j + 1), j));
        }
    }
    place
}

/// The x between point `j` and the next at which a shape that is given by numbers has the value
/// `f`.
fn given_between(shape: &[f64; POINTS], f: f64, j: usize) -> f64 {
    let below = if j == 0 { 0.0 } else { shape[j - 1] };
    point_x(j) + (f - below) / (shape[j] - below) * (point_x(j + 1) - point_x(j))
}

/// As [`given_inverse`] of a lesser `f`, back along the curve from after point `j`.
fn given_back(shape: &[f64; POINTS], f: f64, mut j: usize) -> f64 {
    if f <= 0.0 {
        return 0.0;
    }
    while j > 0 && shape[j - 1] >= f {
        j -= 1;
    }
    given_between(shape, f, j)
}

/// f_T(x) = 1 - (1 - x)^n and its derivative, 0 <= x <= 1.
pub(super) fn tangential_shape(p: &ContactParameters, virgin: &Virgin, x: f64) -> [f64; 2] {
    if p.form == BY_NUMBERS {
        return given(&virgin.shapes[0], x);
    }
    let n = virgin.point.n;
    let rest = 1.0 - x;
    if rest <= 0.0 {
        return [1.0, 0.0];
    }
    let power = rest.powf(n - 1.0);
    [1.0 - power * rest, n * power]
}

/// The x at which f_T has the value `f`, and the point before it of a shape by numbers.
pub(super) fn tangential_shape_inverse(p: &ContactParameters, virgin: &Virgin, f: f64) -> (f64, usize) {
    if p.form == BY_NUMBERS {
        return given_inverse(&virgin.shapes[0], f);
    }
    (if f >= 1.0 { 1.0 } else { 1.0 - (1.0 - f).powf(1.0 / virgin.point.n) }, 0)
}

/// As [`tangential_shape_inverse`] of a lesser `f`, back along the curve from after point `j`.
pub(super) fn tangential_shape_back(p: &ContactParameters, virgin: &Virgin, f: f64, j: usize) -> f64 {
    if p.form == BY_NUMBERS { given_back(&virgin.shapes[0], f, j) } else { tangential_shape_inverse(p, virgin, f).0 }
}

/// f_N(x) and its derivative, 0 <= x <= 1; the derivative is 0 at both ends.
pub(super) fn normal_shape(p: &ContactParameters, virgin: &Virgin, x: f64) -> [f64; 2] {
    if x <= 0.0 {
        return [0.0, 0.0];
    }
    if x >= 1.0 {
        return [1.0, 0.0];
    }
    if p.form == BY_NUMBERS {
        return given(&virgin.shapes[1], x);
    }
    let (m, n) = (virgin.point.m_exponent, virgin.point.n_exponent);
    if p.form == 0.0 {
        let rest = (1.0 - x).powf(m);
        let risen = 1.0 - rest;
        let power = risen.powf(n - 1.0);
        [power * risen, n * power * m * rest / (1.0 - x)]
    } else {
        let risen = x.powf(m);
        let rest = 1.0 - risen;
        let power = rest.powf(n - 1.0);
        [1.0 - power * rest, n * power * m * risen / x]
    }
}

/// The x at which f_N has the value `f`.
pub(super) fn normal_shape_inverse(p: &ContactParameters, virgin: &Virgin, f: f64) -> f64 {
    if f <= 0.0 {
        return 0.0;
    }
    if f >= 1.0 {
        return 1.0;
    }
    if p.form == BY_NUMBERS {
        return given_inverse(&virgin.shapes[1], f).0;
    }
    let (m, n) = (virgin.point.m_exponent, virgin.point.n_exponent);
    if p.form == 0.0 { 1.0 - (1.0 - f.powf(1.0 / n)).powf(1.0 / m) } else { (1.0 - (1.0 - f).powf(1.0 / n)).powf(1.0 / m) }
}
