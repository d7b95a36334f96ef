//! The sliders: annuli in parallel that hold forces along the two axes and in the radial direction,
//! each up to its share of mu F_N (Iwan 1967; Jaeger 1998).

use super::table::{SLIDERS, WEIGHTS};

/// Forces of the sliders along the two axes and radial, innermost (last to slip) first.
pub(super) type Forces = [[f64; SLIDERS]; 3];

/// Shares of mu F_N that the sliders may hold, before they are divided by their sum.
pub(super) struct Limits {
    pub(super) limit: [f64; SLIDERS],
    pub(super) opening: [f64; SLIDERS],
    pub(super) sum: f64,
    pub(super) open: f64,
    /// Slopes by how far it was sheared of each slider's share of what all hold.
    pub(super) by_worn: [f64; SLIDERS],
}

impl Limits {
    /// With `eta` left of the contact as it is released, and what each slider is lost at.
    pub(super) fn new(eta: f64, lost: &[f64; SLIDERS]) -> Self {
        let (mut limit, mut opening) = ([0.0; SLIDERS], [0.0; SLIDERS]);
        let (mut sum, mut open) = (0.0, 0.0);
        for i in 0..SLIDERS {
            opening[i] = if eta > lost[i] { 1.0 } else { 0.0 };
            limit[i] = opening[i] * (eta - lost[i]);
            if i == 0 && limit[0] < 0.1 * eta {
                // The innermost carries what little force there is.
                limit[0] = 0.1 * eta;
                opening[0] = 0.1;
            }
            sum += WEIGHTS[i] * limit[i];
            open += WEIGHTS[i] * opening[i];
        }
        Self { limit, opening, sum, open, by_worn: [0.0; SLIDERS] }
    }

    /// With slopes by how far it was sheared, from the limits where that is less by `less`.
    pub(super) fn worn(mut self, before: &Self, less: f64) -> Self {
        self.by_worn = std::array::from_fn(|i| (before.limit[i] / before.sum - self.limit[i] / self.sum) / less);
        self
    }
}

/// What the sliders hold after a displacement, and how it changes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Held {
    pub(super) forces: Forces,
    /// Their sum along the two axes.
    pub(super) f_t: [f64; 2],
    /// Slopes of the sum: xx, xy, yy by displacement,
    pub(super) by_move: [f64; 3],
    /// by the radial displacement, by k_T, by ln F_N, by eta.
    pub(super) by_radial: [f64; 2],
    pub(super) by_stiffness: [f64; 2],
    pub(super) by_force: [f64; 2],
    pub(super) by_eta: [f64; 2],
    /// By how far it was sheared.
    pub(super) by_worn: [f64; 2],
    /// By the turn of a twist.
    pub(super) by_turn: [f64; 2],
}

/// Moves the sliders from the forces `from` by `along` (two axes, radial) at the stiffness `stiff`,
/// where together they hold `most` = mu F_N. The radial force of a slider is at most `radial_most`
/// of its limit, and gives way first.
pub(super) fn slide(from: &Forces, along: [f64; 3], stiff: f64, most: f64, limits: &Limits, radial_most: f64) -> Held {
    let mut o = Held::default();
    let scale = most / limits.sum;
    for i in 0..SLIDERS {
        let k = stiff * WEIGHTS[i];
        let of_all = WEIGHTS[i] * most * limits.by_worn[i];
        let most = WEIGHTS[i] * limits.limit[i] * scale;
        let most_eta = WEIGHTS[i] * scale * (limits.opening[i] - limits.limit[i] * limits.open / limits.sum);
        let mut f: [f64; 3] = std::array::from_fn(|j| from[j][i] + k * along[j]);
        let held = f[2] > radial_most * most;
        if held {
            f[2] = radial_most * most;
        }
        let square = f[0] * f[0] + f[1] * f[1] + f[2] * f[2];
        let slides = square > most * most;
        let size = square.sqrt();
        let keep = if slides { most / size } else { 1.0 };
        for j in 0..3 {
            o.forces[j][i] = keep * f[j];
        }
        o.f_t[0] += o.forces[0][i];
        o.f_t[1] += o.forces[1][i];
        if !slides {
            o.by_move[0] += k;
            o.by_move[2] += k;
            o.by_stiffness[0] += WEIGHTS[i] * along[0];
            o.by_stiffness[1] += WEIGHTS[i] * along[1];
            continue;
        }
        let u = f.map(|f| f / size);
        o.by_move[0] += keep * k * (1.0 - u[0] * u[0]);
        o.by_move[1] -= keep * k * u[0] * u[1];
        o.by_move[2] += keep * k * (1.0 - u[1] * u[1]);
        // The force goes by the limit: dF = u dL.
        let grows = if held { 1.0 - keep * u[2] * radial_most } else { 1.0 };
        let moved = u[0] * along[0] + u[1] * along[1] + if held { 0.0 } else { u[2] * along[2] };
        for j in 0..2 {
            o.by_radial[j] -= if held { 0.0 } else { keep * k * u[j] * u[2] };
            o.by_stiffness[j] += keep * WEIGHTS[i] * (along[j] - u[j] * moved);
            o.by_force[j] += u[j] * grows * most;
            o.by_eta[j] += u[j] * grows * most_eta;
            o.by_worn[j] += u[j] * grows * of_all;
        }
    }
    o
}

/// Elastic energy of the sliders at the stiffness `stiff`. The radial forces give no work back.
pub(super) fn energy([x, y, _]: &Forces, stiff: f64) -> f64 {
    let square = |i: usize| x[i] * x[i] + y[i] * y[i];
    (0..SLIDERS).map(|i| 0.5 * square(i) / (stiff * WEIGHTS[i])).sum()
}
