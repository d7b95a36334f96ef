//! Isotropic hardening: the flow stress sigma against the equivalent plastic strain alpha.
//!
//! Every law answers the same four questions: [`flow_stress`](FlowStress::flow_stress),
//! [`slope`](FlowStress::slope), [`plastic_work`](FlowStress::plastic_work) and
//! [`plastic_strain_increment`](FlowStress::plastic_strain_increment). The last one is the scalar
//! equation of the radial return,
//! ```text
//! q_trial - sigma(alpha_n + da) - 3 mu_bar da = 0,        q = sqrt(3/2) |s|,    da = sqrt(2/3) d_gamma,
//! ```
//! solved in the variable in which it is convex (or concave) and smooth, so that Newton's iteration
//! from the right end is monotone: the plastic strain for Voce, alpha^n for a power law, the stress
//! for Hollomon's. A bracket guards it all the same.
//!
//! Stresses are in one unit throughout (inside the program: scaled by E).

// `!(x > 0)` is true for a NaN, which is what it is written for.

use super::{HardeningLaw, MaterialError, hollomon_yield_stress};
use crate::lanes::Number;
use crate::real::Real;

/// The flow stress sigma(alpha) of an isotropically hardening solid.
///
/// Build it with the constructors, which check the parameters.
#[derive(Clone, Debug, PartialEq)]
pub enum FlowStress<R> {
    /// Never yields.
    Elastic,
    /// sigma = sigma_Y.
    Ideal {
        /// sigma_Y, stress.
        yield_stress: R,
    },
    /// sigma = sigma_Y + H alpha.
    Linear {
        /// sigma_Y, stress.
        yield_stress: R,
        /// H, stress.
        modulus: R,
    },
    /// sigma = sigma_Y + K alpha^n.
    Power {
        /// sigma_Y, stress.
        yield_stress: R,
        /// K, stress.
        coefficient: R,
        /// 0 < n <= 1.
        exponent: R,
    },
    /// sigma = sigma_0 eps^(1/m), eps = alpha + sigma/E: a power law in the total logarithmic
    /// strain that starts where it meets Hooke's line (Olsson & Larsson 2016, Int. J. Solids
    /// Struct. 81, 23-32).
    Hollomon {
        /// sigma_0, stress.
        coefficient: R,
        /// m > 1.
        exponent: R,
        /// E, stress.
        youngs_modulus: R,
        /// sigma_Y = (sigma_0^m / E)^(1/(m - 1)), stress.
        yield_stress: R,
    },
    /// sigma = sigma_Y + (sigma_sat - sigma_Y)(1 - exp(-rate alpha)) (Voce 1955).
    Voce {
        /// sigma_Y, stress.
        yield_stress: R,
        /// sigma_sat, stress.
        saturation_stress: R,
        /// Dimensionless.
        rate: R,
    },
    /// Piecewise linear, constant beyond the last point.
    Table {
        /// alpha, sigma and the plastic work density up to there; at least one, the first at
        /// alpha = 0.
        points: Vec<[R; 3]>,
    },
}

/// The end of a plastic step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlasticStep<R> {
    /// Increment of the equivalent plastic strain, >= 0.
    pub increment: R,
    /// sigma(alpha + increment), stress.
    pub flow_stress: R,
    /// d sigma/d alpha there, stress.
    pub slope: R,
}

impl FlowStress<f64> {
    /// The same law in another precision, each number rounded once.
    pub fn cast<R: Real>(&self) -> FlowStress<R> {
        let of = |x: &f64| R::of(*x);
        match self {
            Self::Elastic => FlowStress::Elastic,
            Self::Ideal { yield_stress } => FlowStress::Ideal { yield_stress: of(yield_stress) },
            Self::Linear { yield_stress, modulus } => FlowStress::Linear { yield_stress: of(yield_stress), modulus: of(modulus) },
            Self::Power { yield_stress, coefficient, exponent } => {
                FlowStress::Power { yield_stress: of(yield_stress), coefficient: of(coefficient), exponent: of(exponent) }
            }
            Self::Hollomon { coefficient, exponent, youngs_modulus, yield_stress } => FlowStress::Hollomon {
                coefficient: of(coefficient),
                exponent: of(exponent),
                youngs_modulus: of(youngs_modulus),
                yield_stress: of(yield_stress),
            },
            Self::Voce { yield_stress, saturation_stress, rate } => {
                FlowStress::Voce { yield_stress: of(yield_stress), saturation_stress: of(saturation_stress), rate: of(rate) }
            }
            Self::Table { points } => FlowStress::Table { points: points.iter().map(|p| p.map(R::of)).collect() },
        }
    }
}

fn positive(law: &'static str, parameter: &'static str, value: f64) -> Result<f64, MaterialError> {
    if value > 0.0 && value.is_finite() {
        return Ok(value);
    }
    Err(MaterialError::Parameter { law, parameter, value, remedy: "give a finite number above 0" })
}

fn not_negative(law: &'static str, parameter: &'static str, value: f64) -> Result<f64, MaterialError> {
    if value >= 0.0 && value.is_finite() {
        return Ok(value);
    }
    Err(MaterialError::Parameter { law, parameter, value, remedy: "give a finite number, 0 or more" })
}

impl<R: Real> FlowStress<R> {
    /// No hardening: sigma = sigma_Y > 0.
    pub fn ideal(yield_stress: f64) -> Result<Self, MaterialError> {
        Ok(Self::Ideal { yield_stress: R::of(positive("ideal", "yield_stress", yield_stress)?) })
    }

    /// sigma_Y + H alpha; sigma_Y > 0, H >= 0.
    pub fn linear(yield_stress: f64, modulus: f64) -> Result<Self, MaterialError> {
        Ok(Self::Linear {
            yield_stress: R::of(positive("linear", "yield_stress", yield_stress)?),
            modulus: R::of(not_negative("linear", "modulus", modulus)?),
        })
    }

    /// sigma_Y + K alpha^n; sigma_Y > 0, K >= 0, 0 < n <= 1.
    pub fn power(yield_stress: f64, coefficient: f64, exponent: f64) -> Result<Self, MaterialError> {
        if !(exponent > 0.0 && exponent <= 1.0) {
            let remedy = "give n of sigma_Y + K alpha^n, above 0 and at most 1";
            return Err(MaterialError::Parameter { law: "power", parameter: "exponent", value: exponent, remedy });
        }
        Ok(Self::Power {
            yield_stress: R::of(positive("power", "yield_stress", yield_stress)?),
            coefficient: R::of(not_negative("power", "coefficient", coefficient)?),
            exponent: R::of(exponent),
        })
    }

    /// sigma_0 eps^(1/m), eps = alpha + sigma/E; sigma_0 > 0, m > 1, E > 0.
    pub fn hollomon(coefficient: f64, exponent: f64, youngs_modulus: f64) -> Result<Self, MaterialError> {
        let law = "hollomon";
        let coefficient = positive(law, "coefficient", coefficient)?;
        let youngs_modulus = positive(law, "youngs_modulus", youngs_modulus)?;
        if !(exponent > 1.0 && exponent.is_finite()) {
            let remedy = "give m of sigma = sigma_0 eps^(1/m), a finite number above 1";
            return Err(MaterialError::Parameter { law, parameter: "exponent", value: exponent, remedy });
        }
        let yield_stress = hollomon_yield_stress(coefficient, exponent, youngs_modulus);
        let yield_stress = positive(law, "yield stress that follows from coefficient and exponent", yield_stress)?;
        Ok(Self::Hollomon {
            coefficient: R::of(coefficient),
            exponent: R::of(exponent),
            youngs_modulus: R::of(youngs_modulus),
            yield_stress: R::of(yield_stress),
        })
    }

    /// sigma_Y + (sigma_sat - sigma_Y)(1 - exp(-rate alpha)); sigma_sat >= sigma_Y > 0, rate > 0.
    pub fn voce(yield_stress: f64, saturation_stress: f64, rate: f64) -> Result<Self, MaterialError> {
        let yield_stress = positive("voce", "yield_stress", yield_stress)?;
        if !(saturation_stress >= yield_stress && saturation_stress.is_finite()) {
            let remedy = "give a finite stress not below yield_stress";
            let (law, parameter) = ("voce", "saturation_stress");
            return Err(MaterialError::Parameter { law, parameter, value: saturation_stress, remedy });
        }
        Ok(Self::Voce {
            yield_stress: R::of(yield_stress),
            saturation_stress: R::of(saturation_stress),
            rate: R::of(positive("voce", "rate", rate)?),
        })
    }

    /// Piecewise linear through `[alpha, sigma]`, constant beyond the last point; alpha from 0 and
    /// increasing, sigma > 0 and not decreasing.
    pub fn table(points: &[[f64; 2]]) -> Result<Self, MaterialError> {
        let fail = |index, remedy| Err(MaterialError::Table { index, remedy });
        if points.is_empty() {
            return fail(0, "is missing: give at least one [alpha, stress]");
        }
        let mut rows: Vec<[R; 3]> = Vec::with_capacity(points.len());
        let mut work = 0.0;
        for (index, &[alpha, stress]) in points.iter().enumerate() {
            if !(alpha.is_finite() && stress.is_finite() && stress > 0.0) {
                return fail(index, "needs a finite plastic strain and a finite stress above 0");
            }
            if index == 0 {
                if alpha != 0.0 {
                    return fail(index, "has to be at plastic strain 0, where its stress is the yield stress");
                }
            } else {
                let [alpha_before, stress_before] = points[index - 1];
                if R::of(alpha) <= R::of(alpha_before) {
                    return fail(index, "has to lie at a larger plastic strain than the one before");
                }
                if stress < stress_before {
                    return fail(index, "softens: give a stress not below the one before");
                }
                work += 0.5 * (stress + stress_before) * (alpha - alpha_before);
            }
            rows.push([R::of(alpha), R::of(stress), R::of(work)]);
        }
        Ok(Self::Table { points: rows })
    }

    /// Which law it is.
    pub fn law(&self) -> HardeningLaw {
        match self {
            Self::Elastic => HardeningLaw::Elastic,
            Self::Ideal { .. } => HardeningLaw::Ideal,
            Self::Linear { .. } => HardeningLaw::Linear,
            Self::Power { .. } => HardeningLaw::Power,
            Self::Hollomon { .. } => HardeningLaw::Hollomon,
            Self::Voce { .. } => HardeningLaw::Voce,
            Self::Table { .. } => HardeningLaw::Table,
        }
    }

    /// sigma(alpha), stress; infinite for the elastic law.
    #[inline]
    pub fn flow_stress<T: Number<Scalar = R>>(&self, alpha: T) -> T {
        match self {
            Self::Elastic => T::of(f64::INFINITY),
            Self::Ideal { yield_stress } => T::splat(*yield_stress),
            Self::Linear { yield_stress, modulus } => T::splat(*yield_stress) + T::splat(*modulus) * alpha,
            _ => T::from_fn(|i| self.curved_flow_stress(alpha.lane(i))),
        }
    }

    /// [`FlowStress::flow_stress`] of the laws that are evaluated point by point.
    fn curved_flow_stress(&self, alpha: R) -> R {
        match self {
            Self::Power { yield_stress, coefficient, exponent } => *yield_stress + *coefficient * power(alpha, *exponent),
            Self::Hollomon { coefficient, exponent, youngs_modulus, yield_stress } => {
                hollomon_flow_stress(*coefficient, *exponent, *youngs_modulus, *yield_stress, alpha)
            }
            Self::Voce { yield_stress, saturation_stress, rate } => {
                *yield_stress - (*saturation_stress - *yield_stress) * (-(*rate * alpha)).exp_m1()
            }
            Self::Table { points } => {
                let i = segment(points, alpha);
                points[i][1] + table_slope(points, i) * (alpha - points[i][0])
            }
            Self::Elastic | Self::Ideal { .. } | Self::Linear { .. } => self.flow_stress(alpha),
        }
    }

    /// d sigma/d alpha, stress, given sigma(alpha); at a kink of a table the slope to its right.
    /// Infinite for a power law with n < 1 at alpha = 0.
    #[inline]
    pub fn slope(&self, alpha: R, flow_stress: R) -> R {
        match self {
            Self::Elastic | Self::Ideal { .. } => R::ZERO,
            Self::Linear { modulus, .. } => *modulus,
            Self::Power { coefficient, exponent, .. } => *coefficient * *exponent * power(alpha, *exponent - R::ONE),
            Self::Hollomon { exponent, youngs_modulus, .. } => hollomon_slope(*exponent, *youngs_modulus, alpha, flow_stress),
            Self::Voce { saturation_stress, rate, .. } => *rate * (*saturation_stress - flow_stress),
            Self::Table { points } => table_slope(points, segment(points, alpha)),
        }
    }

    /// The integral of sigma d alpha from 0 to alpha, given sigma(alpha): the plastic work per
    /// reference volume, stress.
    #[inline]
    pub fn plastic_work<T: Number<Scalar = R>>(&self, alpha: T, flow_stress: T) -> T {
        match self {
            Self::Elastic => T::of(0.0),
            Self::Ideal { yield_stress } => T::splat(*yield_stress) * alpha,
            Self::Linear { yield_stress, .. } => T::of(0.5) * (T::splat(*yield_stress) + flow_stress) * alpha,
            _ => T::from_fn(|i| self.curved_plastic_work(alpha.lane(i), flow_stress.lane(i))),
        }
    }

    /// [`FlowStress::plastic_work`] of the laws that are evaluated point by point.
    fn curved_plastic_work(&self, alpha: R, flow_stress: R) -> R {
        let half = R::of(0.5);
        match self {
            Self::Power { yield_stress, exponent, .. } => {
                (*yield_stress + (flow_stress - *yield_stress) / (R::ONE + *exponent)) * alpha
            }
            // The integral of sigma d eps less sigma^2/2E from the yield point on, m/(m + 1) [sigma
            // eps] - [sigma^2]/2E, sorted so that no difference is taken but that of the stresses.
            Self::Hollomon { exponent, youngs_modulus, yield_stress, .. } => {
                let share = *exponent / (*exponent + R::ONE);
                let rise = (flow_stress - *yield_stress) * (flow_stress + *yield_stress) / *youngs_modulus;
                share * flow_stress * alpha + (share - half) * rise
            }
            Self::Voce { yield_stress, saturation_stress, rate } => {
                *saturation_stress * alpha - (flow_stress - *yield_stress) / *rate
            }
            Self::Table { points } => {
                let i = segment(points, alpha);
                points[i][2] + half * (points[i][1] + flow_stress) * (alpha - points[i][0])
            }
            Self::Elastic | Self::Ideal { .. } | Self::Linear { .. } => self.plastic_work(alpha, flow_stress),
        }
    }

    /// Solves `trial - sigma(alpha + da) - stiffness da = 0` for the increment `da` of the
    /// equivalent plastic strain.
    ///
    /// `trial` is the von Mises stress of the trial state, above `flow_stress` = sigma(alpha);
    /// `stiffness` is 3 mu_bar > 0.
    #[inline]
    pub fn plastic_strain_increment(&self, alpha: R, flow_stress: R, trial: R, stiffness: R) -> PlasticStep<R> {
        self.plastic_step(true, alpha, flow_stress, trial, stiffness)
    }

    /// [`FlowStress::plastic_strain_increment`] of one point or of eight, for those that `yielding`
    /// says; the others get what is meaningless, with an increment that is finite.
    #[inline(always)]
    pub(super) fn plastic_step<T: Number<Scalar = R>>(
        &self,
        yielding: T::Mask,
        alpha: T,
        flow_stress: T,
        trial: T,
        stiffness: T,
    ) -> PlasticStep<T> {
        let (zero, excess) = (T::of(0.0), trial - flow_stress);
        match self {
            Self::Elastic => PlasticStep { increment: zero, flow_stress, slope: zero },
            Self::Ideal { yield_stress } => {
                PlasticStep { increment: excess / stiffness, flow_stress: T::splat(*yield_stress), slope: zero }
            }
            Self::Linear { modulus, .. } => {
                let modulus = T::splat(*modulus);
                let increment = excess / (stiffness + modulus);
                PlasticStep { increment, flow_stress: flow_stress + modulus * increment, slope: modulus }
            }
            _ => {
                let mut steps = [PlasticStep { increment: R::ZERO, flow_stress: R::ZERO, slope: R::ZERO }; 8];
                for (i, step) in steps.iter_mut().enumerate().take(T::COUNT) {
                    if T::is_set(yielding, i) {
                        *step = self.curved_step(alpha.lane(i), flow_stress.lane(i), trial.lane(i), stiffness.lane(i));
                    }
                }
                PlasticStep {
                    increment: T::from_fn(|i| steps[i].increment),
                    flow_stress: T::from_fn(|i| steps[i].flow_stress),
                    slope: T::from_fn(|i| steps[i].slope),
                }
            }
        }
    }

    /// [`FlowStress::plastic_strain_increment`] of the laws that are solved point by point.
    fn curved_step(&self, alpha: R, flow_stress: R, trial: R, stiffness: R) -> PlasticStep<R> {
        match self {
            Self::Elastic | Self::Ideal { .. } | Self::Linear { .. } => {
                self.plastic_step(true, alpha, flow_stress, trial, stiffness)
            }
            Self::Power { yield_stress, coefficient, exponent } => {
                power_step(*yield_stress, *coefficient, *exponent, alpha, flow_stress, trial, stiffness)
            }
            Self::Hollomon { coefficient, exponent, youngs_modulus, .. } => {
                hollomon_step(*coefficient, *exponent, *youngs_modulus, alpha, flow_stress, trial, stiffness)
            }
            Self::Voce { saturation_stress, rate, .. } => voce_step(*saturation_stress, *rate, flow_stress, trial, stiffness),
            Self::Table { points } => table_step(points, alpha, flow_stress, trial, stiffness),
        }
    }
}

/// x^y for x >= 0 through exp(y ln x), the form that the device has; 0^y is 0, 1 or infinite as y
/// is above, at or below 0.
#[inline]
fn power<R: Real>(x: R, y: R) -> R {
    x.powf(y)
}

/// The root of an increasing function in [low, high]: Newton's iteration kept inside a shrinking
/// bracket by bisection.
///
/// `function` returns the value and the derivative. Newton's error after a relative step e is about
/// C e^2: the iteration stops at e = sqrt(epsilon)/16, which leaves C epsilon/256.
#[inline]
pub(super) fn increasing_root<R: Real>(low: R, high: R, start: R, function: impl Fn(R) -> (R, R)) -> R {
    let tolerance = R::EPSILON.sqrt() * R::of(0.0625);
    let (mut low, mut high, mut x) = (low, high, start);
    // Bisection alone would be done after 2 digits x 53 halvings; Newton's takes three to six.
    for _ in 0..120 {
        let (value, derivative) = function(x);
        if value > R::ZERO {
            high = x;
        } else {
            low = x;
        }
        let next = x - value / derivative;
        // Written so that a NaN bisects.
        if next >= low && next <= high {
            if (next - x).abs() <= tolerance * next.abs() {
                return next;
            }
            x = next;
        } else {
            let middle = R::of(0.5) * (low + high);
            if (high - low).abs() <= R::EPSILON * middle.abs() || !(middle > low && middle < high) {
                return middle;
            }
            x = middle;
        }
    }
    x
}

/// Unknown u = alpha^n, in which the equation `K u + 3 mu_bar u^(1/n) = load` is convex and free of
/// the infinite slope at 0.
#[inline]
fn power_step<R: Real>(
    yield_stress: R,
    coefficient: R,
    exponent: R,
    alpha: R,
    flow_stress: R,
    trial: R,
    stiffness: R,
) -> PlasticStep<R> {
    if coefficient <= R::ZERO {
        return PlasticStep { increment: (trial - flow_stress) / stiffness, flow_stress, slope: R::ZERO };
    }
    let load = trial - yield_stress + stiffness * alpha;
    let inverse = R::ONE / exponent;
    let low = (flow_stress - yield_stress) / coefficient;
    // Each of the two terms alone bounds u from above.
    let high = (load / coefficient).min(power(load / stiffness, exponent)).max(low);
    let u = increasing_root(low, high, high, |u| {
        let strain = power(u, inverse);
        (coefficient * u + stiffness * strain - load, coefficient + stiffness * inverse * strain / u)
    });
    let strain = power(u, inverse);
    let stress = yield_stress + coefficient * u;
    let slope = coefficient * exponent * u / strain;
    // Of the two ways to the increment the better conditioned one.
    let increment = if slope <= stiffness { (trial - stress) / stiffness } else { strain - alpha };
    PlasticStep { increment: increment.max(R::ZERO), flow_stress: stress, slope }
}

/// (sigma/sigma_0)^m - sigma/E = alpha solved for the total strain eps, in which it is convex:
/// eps - sigma_0 eps^(1/m)/E = alpha.
#[inline]
fn hollomon_flow_stress<R: Real>(coefficient: R, exponent: R, youngs_modulus: R, yield_stress: R, alpha: R) -> R {
    if !(alpha > R::ZERO) {
        return yield_stress;
    }
    let inverse = R::ONE / exponent;
    // sigma/E >= sigma_Y/E bounds eps from below; the tangent at the yield point, above the concave
    // curve, from above.
    let yield_strain = yield_stress / youngs_modulus;
    let low = alpha + yield_strain;
    let high = yield_strain + alpha / (R::ONE - inverse);
    let strain = increasing_root(low, high, low, |strain| {
        let ratio = coefficient * power(strain, inverse) / youngs_modulus;
        (strain - ratio - alpha, R::ONE - inverse * ratio / strain)
    });
    coefficient * power(strain, inverse)
}

/// d sigma/d alpha = 1/(m eps/sigma - 1/E).
#[inline]
fn hollomon_slope<R: Real>(exponent: R, youngs_modulus: R, alpha: R, flow_stress: R) -> R {
    // m eps/sigma - 1/E = m alpha/sigma + (m - 1)/E, a sum of two positive terms.
    R::ONE / (exponent * alpha / flow_stress + (exponent - R::ONE) / youngs_modulus)
}

/// Unknown sigma: alpha(sigma) = (sigma/sigma_0)^m - sigma/E is explicit, and the equation convex.
#[inline]
fn hollomon_step<R: Real>(
    coefficient: R,
    exponent: R,
    youngs_modulus: R,
    alpha: R,
    flow_stress: R,
    trial: R,
    stiffness: R,
) -> PlasticStep<R> {
    let strain_at_most = alpha + (trial - flow_stress) / stiffness + trial / youngs_modulus;
    let high = trial.min(coefficient * power(strain_at_most, R::ONE / exponent)).max(flow_stress);
    let stress = increasing_root(flow_stress, high, high, |stress| {
        let strain = power(stress / coefficient, exponent);
        let value = stress - trial + stiffness * (strain - stress / youngs_modulus - alpha);
        (value, R::ONE + stiffness * (exponent * strain / stress - R::ONE / youngs_modulus))
    });
    let increment = ((trial - stress) / stiffness).max(R::ZERO);
    PlasticStep { increment, flow_stress: stress, slope: hollomon_slope(exponent, youngs_modulus, alpha + increment, stress) }
}

/// Unknown da: the equation is concave, and starts from below.
#[inline]
fn voce_step<R: Real>(saturation_stress: R, rate: R, flow_stress: R, trial: R, stiffness: R) -> PlasticStep<R> {
    let excess = trial - flow_stress;
    let rest = saturation_stress - flow_stress;
    let low = ((trial - saturation_stress) / stiffness).max(R::ZERO);
    let high = excess / stiffness;
    let start = low.max(excess / (stiffness + rate * rest)).min(high);
    let increment = increasing_root(low.min(high), high, start, |increment| {
        let decay = (-(rate * increment)).exp_m1();
        (stiffness * increment - rest * decay - excess, stiffness + rate * rest * (decay + R::ONE))
    });
    let stress = flow_stress - rest * (-(rate * increment)).exp_m1();
    PlasticStep { increment, flow_stress: stress, slope: rate * (saturation_stress - stress) }
}

/// The last point at or below alpha.
#[inline]
fn segment<R: Real>(points: &[[R; 3]], alpha: R) -> usize {
    let mut i = 0;
    while i + 1 < points.len() && points[i + 1][0] <= alpha {
        i += 1;
    }
    i
}

/// The slope to the right of point i; 0 beyond the last.
#[inline]
fn table_slope<R: Real>(points: &[[R; 3]], i: usize) -> R {
    if i + 1 < points.len() { (points[i + 1][1] - points[i][1]) / (points[i + 1][0] - points[i][0]) } else { R::ZERO }
}

/// Marches over the segments, each solved exactly.
#[inline]
fn table_step<R: Real>(points: &[[R; 3]], alpha: R, flow_stress: R, trial: R, stiffness: R) -> PlasticStep<R> {
    let mut i = segment(points, alpha);
    let (mut done, mut stress) = (R::ZERO, flow_stress);
    loop {
        let slope = table_slope(points, i);
        let increment = ((trial - stress - stiffness * done) / (stiffness + slope)).max(R::ZERO);
        if i + 1 >= points.len() || alpha + done + increment < points[i + 1][0] {
            return PlasticStep { increment: done + increment, flow_stress: stress + slope * increment, slope };
        }
        i += 1;
        done = points[i][0] - alpha;
        stress = points[i][1];
    }
}
