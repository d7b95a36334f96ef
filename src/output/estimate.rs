//! The discretisation errors of the numbers of a summary, as its rows and its companion tell them,
//! and the ripple of the press curve.

use super::first_shear::{SLIP_DISPLACEMENT_RATIOS, first_shear, reaches};
use super::limit::{TANGENTIAL_SHARE, size};
use super::{Limits, StepLimits, StepRecord};

/// Press steps from this share of the greatest indentation on show the ripple.
const RIPPLE_FROM: f64 = 0.25;
/// Rows whose |F_T| is within this share of the greatest one are at the peak, which is flat: which
/// of them is the greatest is up to the tolerance of the steps.
const AT_PEAK: f64 = 1e-3;
/// Fewest steps by which a ripple is told from a trend.
const RIPPLE_STEPS: usize = 6;

/// Estimated errors, sizes, and the limit of the greatest tangential force, in the units of the
/// values.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorEstimate {
    /// Elements along the contact radius of the companion.
    pub coarse_elements: usize,
    /// Of F_N0: that of its row.
    pub f_n0: Option<f64>,
    /// Of a0, made in the same way.
    pub a0: Option<f64>,
    /// Of F_T_max: that of the last row that has one and reaches it to within a thousandth.
    pub f_t_max: Option<f64>,
    /// Greatest |F_T| of the shear in the limit of fine meshes and short steps.
    pub f_t_max_limit: Option<f64>,
    /// Of delta_T_90, delta_T_95 and delta_T_slip.
    pub delta_t: [Option<f64>; 3],
    /// delta_T_90 and delta_T_95 in the limit. That at 0.99 mu has none.
    pub delta_t_limit: [Option<f64>; 2],
    /// Of k_T0.
    pub k_t0: Option<f64>,
}

/// Points of a shear as far as they are known: displacement, F_T/F_N and its limit.
type RatioCurve = [Option<[f64; 3]>];

impl ErrorEstimate {
    /// Of a history, in which segments that are `oblique` are no shear.
    pub fn new(rows: &[StepRecord], oblique: &[usize], limits: &Limits) -> Self {
        let at = |row: &StepRecord| limits.of(&rows[..rows.partition_point(|earlier| earlier.step < row.step)], row);
        let (start, shear) = first_shear(rows, oblique);
        let (start_row, start, points) = (start, start.map(at), shear.iter().map(at));
        let force = |row: &StepRecord| size([row.f_t, row.f_t_y]);
        let force_limit = |of: &StepLimits| Some(size([of.f_t_limit?, of.f_t_y_limit?]));
        let most = shear.iter().map(force).fold(0.0, f64::max);
        let at_peak = shear.iter().zip(points.clone()).filter(|(row, _)| force(row) >= (1.0 - AT_PEAK) * most);
        let curve: Option<Vec<Option<[f64; 3]>>> = start_row.map(|start| {
            let ratio = |f_t: f64, f_n: f64| (f_n > 0.0).then(|| f_t / f_n);
            let point = |(row, of): (&StepRecord, StepLimits)| {
                let limit = force_limit(&of).zip(of.f_n_limit).and_then(|(f_t, f_n)| ratio(f_t, f_n));
                let way = size([row.delta_t - start.delta_t, row.delta_t_y - start.delta_t_y]);
                Some([way, ratio(force(row), row.f_n)?, limit?])
            };
            shear.iter().zip(points.clone()).map(point).collect()
        });
        let over_mu = |of: &dyn Fn(&RatioCurve, f64) -> Option<f64>| {
            curve
                .as_deref()
                .zip(limits.friction)
                .map_or([None; 3], |(curve, mu)| SLIP_DISPLACEMENT_RATIOS.map(|share| of(curve, share * mu)))
        };
        Self {
            coarse_elements: limits.coarse_elements,
            f_n0: start.and_then(|start| start.f_n_error),
            a0: start.and_then(|start| start.a_error),
            f_t_max: at_peak.filter_map(|(_, point)| point.f_t_error).next_back(),
            // Where a part of the shear has none, the largest may lie there.
            f_t_max_limit: points.clone().map(|point| force_limit(&point)).reduce(|most, next| Some(most?.max(next?))).flatten(),
            delta_t: over_mu(&|curve, wanted| displacement_error(curve, wanted)),
            delta_t_limit: {
                let [to_90, to_95, _] = over_mu(&|curve, wanted| limit_reaches(curve, wanted));
                [to_90, to_95]
            },
            k_t0: shear.first().and_then(|first| limits.stiffness_error(first)),
        }
    }
}

/// Error of the displacement at which F_T/F_N reaches `wanted`: what the ratio lacks at the ends of
/// that step, whichever is more, over the slope of the curve in it.
fn displacement_error(curve: &RatioCurve, wanted: f64) -> Option<f64> {
    let mut before = [0.0; 3];
    for point in curve {
        let now = (*point)?;
        if now[1] >= wanted {
            let rise = now[1] - before[1];
            let missing = |[_, found, limit]: [f64; 3]| (limit - found).abs();
            let most = missing(before).max(missing(now));
            return Some(if rise > 0.0 { TANGENTIAL_SHARE * most * (now[0] - before[0]) / rise } else { 0.0 });
        }
        before = now;
    }
    None
}

/// The displacement at which the limit of F_T/F_N reaches `wanted`.
fn limit_reaches(curve: &RatioCurve, wanted: f64) -> Option<f64> {
    reaches(curve.iter().map_while(|point| point.map(|[displacement, _, limit]| [displacement, limit])), wanted)
}

/// Root mean square of ln F_N about a quadratic in ln h fitted to the first press, from a quarter
/// of its indentation on: the relative ripple of the force. `None` for fewer than six steps.
pub fn ripple(rows: &[StepRecord]) -> Option<f64> {
    let press: Vec<&StepRecord> = rows.iter().take_while(|r| r.segment == 0 && r.f_n > 0.0 && r.h > 0.0).collect();
    let last = press.last()?.h;
    let points: Vec<[f64; 2]> =
        press.iter().filter(|r| r.h >= RIPPLE_FROM * last).map(|r| [(r.h / last).ln(), r.f_n.ln()]).collect();
    if points.len() < RIPPLE_STEPS {
        return None;
    }
    let residuals = quadratic_residuals(&points)?;
    // Three constants were fitted.
    Some((residuals.iter().map(|r| r * r).sum::<f64>() / (points.len() - 3) as f64).sqrt())
}

/// What a least-squares quadratic leaves of the points (x, y); `None` where the points do not
/// determine it.
fn quadratic_residuals(points: &[[f64; 2]]) -> Option<Vec<f64>> {
    // Orthogonal polynomials on the points themselves (Forsythe, J. Soc. Indust. Appl. Math. 5,
    // 1957): no normal equations.
    let mut residuals: Vec<f64> = points.iter().map(|p| p[1]).collect();
    let (mut before, mut now) = (vec![0.0; points.len()], vec![1.0; points.len()]);
    let mut norm_before = f64::INFINITY;
    for _ in 0..3 {
        let norm: f64 = now.iter().map(|p| p * p).sum();
        if !(norm > 1e-20) {
            return None;
        }
        let share = residuals.iter().zip(&now).map(|(r, p)| r * p).sum::<f64>() / norm;
        residuals.iter_mut().zip(&now).for_each(|(r, p)| *r -= share * p);
        let shift = points.iter().zip(&now).map(|(x, p)| x[0] * p * p).sum::<f64>() / norm;
        // None before the first one: norm_before is infinite.
        let back = norm / norm_before;
        let next = (0..points.len()).map(|i| (points[i][0] - shift) * now[i] - back * before[i]).collect();
        (before, now, norm_before) = (now, next, norm);
    }
    Some(residuals)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn press(f: impl Fn(f64) -> f64) -> Vec<StepRecord> {
        (1..=30)
            .map(|i| {
                let h = 0.02 * f64::from(i * i) / 900.0;
                StepRecord { h, f_n: f(h), ..StepRecord::default() }
            })
            .collect()
    }

    #[test]
    fn a_smooth_curve_has_no_ripple() {
        let smooth = press(|h| 100.0 * h.powf(1.2) * (1.0 + 0.1 * h.ln()).exp());
        assert!(ripple(&smooth).unwrap() < 1e-12, "{:?}", ripple(&smooth));
        // A quadratic in ln h is one in ln(h / h0).
        let quadratic = press(|h| (0.3 * h.ln() - 0.1 * h.ln().powi(2)).exp());
        assert!(ripple(&quadratic).unwrap() < 1e-11);
        assert_eq!(ripple(&smooth[..8]), None);
    }

    #[test]
    fn a_ripple_is_measured() {
        let rippled = press(|h| 100.0 * h.powf(1.2) * (1.0 + 0.01 * (400.0 * h.sqrt()).sin()));
        let found = ripple(&rippled).unwrap();
        assert!((0.005..0.009).contains(&found), "0.01/sqrt 2 is {:.4}, found {found}", 0.01 / 2.0_f64.sqrt());
    }
}
