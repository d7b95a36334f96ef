//! The sectors of the sliders of a contact that twists: each quarter of an annulus is pulled in its
//! own direction, and slips at the limit of all.

use super::sliders::{Forces, Held, Limits};
use super::table::{SLIDERS, WEIGHTS};
use super::turning_constants::{LEVERS, TWIST_LEVER, TWIST_STIFF, TurningConstants};

/// Sectors of a slider, around the normal from the first axis on.
pub const SECTORS: usize = 4;

/// Forces of the sectors of the sliders along the two axes: their mean is the slider's.
pub(super) type Sectors = [[[f64; SLIDERS]; 2]; SECTORS];

/// Where a twist pulls them.
const AROUND: [[f64; 2]; SECTORS] = [[0.0, 1.0], [-1.0, 0.0], [0.0, -1.0], [1.0, 0.0]];

/// A twist within a step.
#[derive(Clone)]
pub(super) struct Twist {
    /// Displacement at the contact's radius.
    pub(super) along: f64,
    /// The part of the moment in yield, over F_N, and its vertex;
    pub(super) ratio: f64,
    pub(super) vertex: f64,
    /// the ratio were nothing to flow, and by how much slip takes from it.
    pub(super) trial: f64,
    pub(super) gives: f64,
    /// What a roll leaves of the yield force and of the flow.
    pub(super) kept: f64,
    pub(super) flows: f64,
    pub(super) sectors: Sectors,
}

impl Twist {
    /// The displacement that is left beside the steady flow `flow` and that at the vertex `sudden`,
    /// both over the ratio, the ratio that goes with it, and 1 over the share that flow leaves. By
    /// the ratio of before flow would overshoot.
    pub(super) fn beside(&self, flow: f64, sudden: f64) -> [f64; 3] {
        let per = 1.0 / (1.0 + self.gives * (flow + sudden));
        let turned = (self.trial + self.gives * sudden * self.vertex) * per;
        let slips = TurningConstants::FITTED.twist_flow / TWIST_LEVER * (flow * turned + sudden * (turned - self.vertex));
        [self.along - slips, turned, per]
    }
}

/// Moves the sectors of the sliders by `along` (two axes, radial) and the turn `turn`; otherwise as
/// [`slide`](super::sliders::slide) moves the sliders. A radial force is the same in all.
pub(super) fn slide_sectors(
    sectors: &Sectors,
    radial_from: &[f64; SLIDERS],
    (along, turn): ([f64; 3], f64),
    stiff: f64,
    most: f64,
    limits: &Limits,
    radial_most: f64,
) -> (Held, Box<Sectors>) {
    let (mut o, mut after) = (Held::default(), Box::new(*sectors));
    let (scale, share) = (most / limits.sum, 1.0 / SECTORS as f64);
    for i in 0..SLIDERS {
        let k = stiff * WEIGHTS[i];
        let of_all = WEIGHTS[i] * most * limits.by_worn[i];
        let most = WEIGHTS[i] * limits.limit[i] * scale;
        let most_eta = WEIGHTS[i] * scale * (limits.opening[i] - limits.limit[i] * limits.open / limits.sum);
        let radial = radial_from[i] + k * along[2];
        let held = radial > radial_most * most;
        let radial = if held { radial_most * most } else { radial };
        let (mut left, turns) = (1.0_f64, TWIST_STIFF * LEVERS[i]);
        for (j, around) in AROUND.iter().enumerate() {
            let d: [f64; 2] = std::array::from_fn(|c| along[c] + turns * turn * around[c]);
            let f: [f64; 2] = std::array::from_fn(|c| sectors[j][c][i] + k * d[c]);
            let square = f[0] * f[0] + f[1] * f[1] + radial * radial;
            let (mut keep, mut u) = (1.0, [0.0; 3]);
            if square > most * most {
                let per = 1.0 / square.sqrt();
                keep = most * per;
                u = [f[0] * per, f[1] * per, radial * per];
            }
            left = left.min(keep);
            let grows = if held { 1.0 - keep * u[2] * radial_most } else { 1.0 };
            let moved = u[0] * d[0] + u[1] * d[1] + if held { 0.0 } else { u[2] * along[2] };
            let kept = keep * share * WEIGHTS[i];
            o.by_move[0] += kept * stiff * (1.0 - u[0] * u[0]);
            o.by_move[1] -= kept * stiff * u[0] * u[1];
            o.by_move[2] += kept * stiff * (1.0 - u[1] * u[1]);
            for c in 0..2 {
                after[j][c][i] = keep * f[c];
                o.forces[c][i] += share * keep * f[c];
                o.by_radial[c] -= if held { 0.0 } else { kept * stiff * u[c] * u[2] };
                o.by_stiffness[c] += kept * (d[c] - u[c] * moved);
                let pushed = share * u[c] * grows;
                o.by_force[c] += pushed * most;
                o.by_eta[c] += pushed * most_eta;
                o.by_worn[c] += pushed * of_all;
                o.by_turn[c] += kept * stiff * turns * (around[c] - u[c] * (u[0] * around[0] + u[1] * around[1]));
            }
        }
        // What the sector that gives way most leaves, so that none is beyond its limit.
        o.forces[2][i] = left * radial;
        (0..2).for_each(|c| o.f_t[c] += o.forces[c][i]);
    }
    (o, after)
}

/// M_twist over the contact's radius.
pub(super) fn twisting(sectors: &Sectors) -> f64 {
    let around = |i: usize| -> f64 { sectors.iter().zip(&AROUND).map(|(f, e)| f[0][i] * e[0] + f[1][i] * e[1]).sum() };
    (0..SLIDERS).map(|i| LEVERS[i] * around(i)).sum::<f64>() / SECTORS as f64
}

/// Elastic energy of what the sectors hold beside their mean, at the stiffness `stiff`.
pub(super) fn energy(sectors: &Sectors, stiff: f64) -> f64 {
    let mut sum = 0.0;
    for i in 0..SLIDERS {
        for c in 0..2 {
            let mean = sectors.iter().map(|f| f[c][i]).sum::<f64>() / SECTORS as f64;
            let squares = sectors.iter().map(|f| f[c][i] * f[c][i]).sum::<f64>() / SECTORS as f64;
            sum += (squares - mean * mean) / WEIGHTS[i];
        }
    }
    0.5 * sum / (TWIST_STIFF * stiff)
}

/// The sectors of sliders that have not yet turned.
pub(super) fn alike([x, y, _]: &Forces) -> Sectors {
    [[*x, *y]; SECTORS]
}
