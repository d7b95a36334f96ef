//! Nonlinear least squares: Levenberg-Marquardt (the `levenberg-marquardt` crate, a port of
//! MINPACK), of positive constants in their logarithms.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt, TerminationReason};
use nalgebra::{DMatrix, DVector, Dyn, storage::Owned};

/// Weight of the pull of a constant's logarithm towards its start. Residuals are shares of a
/// force, a per cent or so each: the pull decides only what the data leave open, and keeps a small
/// study's constants finite.
pub const PULL: f64 = 0.01;
/// Range of a logarithm beyond which nothing changes any more, but overflows do.
const LARGEST_LOGARITHM: f64 = 12.0;

/// A constant from its logarithm.
fn constant(unknown: f64) -> f64 {
    unknown.clamp(-LARGEST_LOGARITHM, LARGEST_LOGARITHM).exp()
}

struct LeastSquares<'a, F> {
    residuals: &'a F,
    pull: f64,
    start: DVector<f64>,
    unknowns: DVector<f64>,
}

impl<F: Fn(&[f64]) -> Vec<f64>> LeastSquares<'_, F> {
    /// Residuals of the data, then the pull.
    fn evaluate(&self, unknowns: &DVector<f64>) -> DVector<f64> {
        let constants: Vec<f64> = unknowns.iter().map(|&x| constant(x)).collect();
        let mut all = (self.residuals)(&constants);
        all.extend((unknowns - &self.start).iter().map(|x| self.pull * x));
        DVector::from_vec(all)
    }
}

impl<F: Fn(&[f64]) -> Vec<f64>> LeastSquaresProblem<f64, Dyn, Dyn> for LeastSquares<'_, F> {
    type ParameterStorage = Owned<f64, Dyn>;
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;

    fn set_params(&mut self, x: &DVector<f64>) {
        self.unknowns.copy_from(x);
    }

    fn params(&self) -> DVector<f64> {
        self.unknowns.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        let residuals = self.evaluate(&self.unknowns);
        residuals.iter().all(|r| r.is_finite()).then_some(residuals)
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        // Central differences: the residuals are smooth to rounding.
        let step = 1e-5;
        let columns: Vec<DVector<f64>> = (0..self.unknowns.len())
            .map(|i| {
                let shifted = |by: f64| {
                    let mut x = self.unknowns.clone();
                    x[i] += by;
                    self.evaluate(&x)
                };
                (shifted(step) - shifted(-step)) / (2.0 * step)
            })
            .collect();
        let jacobian = DMatrix::from_columns(&columns);
        jacobian.iter().all(|x| x.is_finite()).then_some(jacobian)
    }
}

/// The constants > 0 that minimise the sum of squares of `residuals`(constants), from `start`, to
/// which they are drawn with the weight `pull`: the residual of one whose logarithm is 1 away.
///
/// # Errors
/// What the library says, where the residuals are not finite or it makes no way.
pub fn minimize(start: &[f64], pull: f64, residuals: impl Fn(&[f64]) -> Vec<f64>) -> Result<Vec<f64>, String> {
    let unknowns = DVector::from_iterator(start.len(), start.iter().map(|x| x.ln()));
    let problem = LeastSquares { residuals: &residuals, pull, start: unknowns.clone(), unknowns };
    let (problem, report) =
        LevenbergMarquardt::new().with_ftol(1e-10).with_xtol(1e-8).with_gtol(1e-10).with_patience(40).minimize(problem);
    // An exhausted patience is an answer as good as its last digit; anything else without success
    // is none.
    if !report.termination.was_successful() && report.termination != TerminationReason::LostPatience {
        return Err(format!("{:?}", report.termination));
    }
    Ok(problem.unknowns.iter().map(|&x| constant(x)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recovers_the_constants_of_exact_data() {
        let model = |c: &[f64], x: f64| c[0] * (-c[1] * x).exp() + c[2];
        let data: Vec<(f64, f64)> = (0..200).map(|i| f64::from(i) * 0.02).map(|x| (x, model(&[2.0, 1.5, 0.3], x))).collect();
        let residuals = |c: &[f64]| data.iter().map(|&(x, y)| 10.0 * (model(c, x) - y)).collect();
        let found = minimize(&[1.0, 1.0, 1.0], PULL, residuals).unwrap();
        for (found, exact) in found.iter().zip([2.0, 1.5, 0.3]) {
            assert!((found / exact - 1.0).abs() < 1e-3, "{found} instead of {exact}");
        }
    }

    #[test]
    fn what_the_data_leave_open_stays_where_it_was() {
        let residuals = |c: &[f64]| vec![c[0] - 3.0; 100];
        let found = minimize(&[1.0, 0.7], PULL, residuals).unwrap();
        assert!((found[0] - 3.0).abs() < 1e-3 && (found[1] / 0.7 - 1.0).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn residuals_that_are_no_numbers_are_an_error() {
        assert!(minimize(&[1.0], PULL, |c| vec![(c[0] - 5.0).sqrt()]).is_err());
    }
}
