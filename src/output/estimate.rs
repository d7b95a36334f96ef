//! The discretisation error of a run, estimated from the same case on its scout's coarser mesh and
//! from the ripple of its own press curve.
//!
//! Mesh and load steps are refined together, and what they leave is taken to fall as 1/n with n
//! elements along the contact radius: the difference of two runs then tells what is missing from
//! either (Roache, J. Fluids Eng. 116, 1994). Where the error falls faster the estimate is too
//! large, not too small. By chance two runs may agree although both are wrong, because nodes come
//! into contact one after another and the force ripples about its smooth curve; so the ripple's
//! size is added.

use super::{StepRecord, Summary};

/// Press steps from this share of the greatest indentation on show the ripple.
const RIPPLE_FROM: f64 = 0.25;
/// Fewest steps by which a ripple is told from a trend.
const RIPPLE_STEPS: usize = 6;

/// Estimated errors, sizes, in the units of the values.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorEstimate {
    /// Elements along the contact radius of the coarse run that was compared with.
    pub coarse_elements: usize,
    /// Of F_N0.
    pub f_n0: Option<f64>,
    /// Of a0.
    pub a0: Option<f64>,
    /// Of F_T_max.
    pub f_t_max: Option<f64>,
}

impl ErrorEstimate {
    /// Compares a run whose elements are of size `spacing` with one on `coarse_spacing`, for which
    /// `coarse_elements` along the contact radius were asked.
    pub fn new(
        rows: &[StepRecord],
        run: &Summary,
        spacing: f64,
        coarse: &Summary,
        coarse_spacing: f64,
        coarse_elements: usize,
    ) -> Self {
        // e = C spacing on either mesh gives e of the fine one from the difference.
        let factor = spacing / (coarse_spacing - spacing).abs();
        let ripple = ripple(rows).unwrap_or(0.0);
        let error = |q: fn(&Summary) -> Option<f64>, ripple: f64| {
            let (fine, coarse) = (q(run)?, q(coarse)?);
            Some(factor * (fine - coarse).abs() + ripple * fine.abs())
        };
        Self {
            coarse_elements,
            f_n0: error(|s| s.f_n0, ripple),
            // F_N goes as a^2 where the pressure is given.
            a0: error(|s| s.a0, 0.5 * ripple),
            f_t_max: error(|s| s.f_t_max, ripple),
        }
    }
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

    #[test]
    fn an_error_of_first_order_is_told_exactly() {
        let at = |n: f64| Summary { f_n0: Some(150.0 + 8.0 / n), a0: Some(0.2 - 0.1 / n), f_t_max: None, ..Summary::default() };
        for (n, m) in [(16, 6), (8, 4), (4, 2), (5, 2), (6, 3)] {
            let estimate = ErrorEstimate::new(&[], &at(n as f64), 0.2 / n as f64, &at(m as f64), 0.2 / m as f64, m);
            assert!((estimate.f_n0.unwrap() - 8.0 / n as f64).abs() < 1e-12, "{n} {m}");
            assert!((estimate.a0.unwrap() - 0.1 / n as f64).abs() < 1e-12);
            assert_eq!(estimate.f_t_max, None);
        }
    }
}
