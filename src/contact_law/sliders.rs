//! The tangential sliders in parallel (Iwan 1967): their limits, what a displacement makes of them,
//! their force and their stiffness.

use super::update::ContactState;
use super::virgin::{ContactParameters, SLIDERS, Virgin};

/// Share of a bound up to which a force counts as within it, so that a contact at rest answers with
/// its elastic stiffness.
pub(super) const AT_BOUND: f64 = 1.0 + 1e-10;

/// What is left of the contact's extent as it is released: eta of the sliders, 1 at its reach. What
/// shear takes of F_N leaves it as wide as it was.
pub(super) fn extent(virgin: &Virgin, state: &ContactState) -> f64 {
    if state.approach <= 0.0 {
        return 0.0;
    }
    if state.approach < state.reach { (state.approach / state.reach).powf(virgin.gamma / virgin.backbone) } else { 1.0 }
}

/// Greatest deflection of each slider under the normal force `f_n` at the [`extent`] `eta`: their
/// forces then add up to mu F_N.
pub(super) fn slider_limits(p: &ContactParameters, virgin: &Virgin, f_n: f64, eta: f64) -> [f64; SLIDERS] {
    let mut limit = [0.0; SLIDERS];
    if f_n <= 0.0 {
        return limit;
    }
    let mut sum = 0.0;
    for i in 0..SLIDERS {
        limit[i] = if eta > virgin.lost[i] { eta - virgin.lost[i] } else { 0.0 };
        if i == 0 && limit[i] < 0.1 * eta {
            limit[i] = 0.1 * eta; // the innermost carries what little force there is
        }
        sum += virgin.weight[i] * limit[i];
    }
    let scale = p.friction * f_n / (virgin.point.k_t * sum);
    for i in 0..SLIDERS {
        limit[i] *= scale;
    }
    limit
}

/// An increment in the same direction, of at most 1e150: far beyond full slip, and its square is
/// still finite.
pub(super) fn bounded(increment: [f64; 2]) -> [f64; 2] {
    let size = if increment[0].abs() > increment[1].abs() { increment[0].abs() } else { increment[1].abs() };
    if size > 1e150 { [increment[0] / size * 1e150, increment[1] / size * 1e150] } else { increment }
}

/// Moves the sliders by `increment` and holds each to its limit.
pub(super) fn slide(deflection: &mut [[f64; 2]; SLIDERS], limit: &[f64; SLIDERS], increment: [f64; 2]) {
    for i in 0..SLIDERS {
        let q = [deflection[i][0] + increment[0], deflection[i][1] + increment[1]];
        let size = (q[0] * q[0] + q[1] * q[1]).sqrt();
        let keep = if size > limit[i] { limit[i] / size } else { 1.0 };
        deflection[i] = [keep * q[0], keep * q[1]];
    }
}

/// Tangential force of the sliders.
pub(super) fn slider_force(virgin: &Virgin, deflection: &[[f64; 2]; SLIDERS]) -> [f64; 2] {
    let mut sum = [0.0, 0.0];
    for i in 0..SLIDERS {
        sum[0] += virgin.weight[i] * deflection[i][0];
        sum[1] += virgin.weight[i] * deflection[i][1];
    }
    [virgin.point.k_t * sum[0], virgin.point.k_t * sum[1]]
}

/// Stiffness of the sliders after [`slide`]: a slider at its limit only turns.
pub(super) fn slider_stiffness(
    virgin: &Virgin,
    before: &[[f64; 2]; SLIDERS],
    limit: &[f64; SLIDERS],
    increment: [f64; 2],
) -> [[f64; 2]; 2] {
    let mut sum = [0.0, 0.0, 0.0];
    for i in 0..SLIDERS {
        let q = [before[i][0] + increment[0], before[i][1] + increment[1]];
        let size = (q[0] * q[0] + q[1] * q[1]).sqrt();
        let k = virgin.point.k_t * virgin.weight[i];
        if size > AT_BOUND * limit[i] {
            let k = k * limit[i] / size;
            let m = [q[0] / size, q[1] / size];
            sum[0] += k * m[1] * m[1];
            sum[1] -= k * m[0] * m[1];
            sum[2] += k * m[0] * m[0];
        } else {
            sum[0] += k;
            sum[2] += k;
        }
    }
    [[sum[0], sum[1]], [sum[1], sum[2]]]
}

/// Length of a vector.
pub(super) fn length(v: [f64; 2]) -> f64 {
    (v[0] * v[0] + v[1] * v[1]).sqrt()
}
