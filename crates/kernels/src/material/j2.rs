//! Finite-strain J2 plasticity at one point: radial return of the deviatoric Kirchhoff stress and
//! its tangent.
//!
//! Simo & Hughes, *Computational Inelasticity* (1998), Box 9.1 (return mapping) and Box 9.2
//! (moduli), with two changes.
//!
//! **Differences from the identity.** With `d = f - I` and `B = b_e_bar - I`, the trial state is
//! formed as `M = d + d^T + d d^T + f B f^T`, `B_trial = M + r (I + M)`, `r = det(f)^(-2/3) - 1`.
//! Neither `f` nor `b_e_bar` is ever rounded next to 1, which in single precision would leave a
//! strain of 1e-4 with three digits.
//!
//! **The trace after plastic flow.** Box 9.1 keeps the trial trace, so that det b_e_bar drifts away
//! from 1 with every plastic step. Here the trace is the root t of `det(dev b_e_bar + t I) = 1`:
//! plastic flow is isochoric to rounding.
//!
//! The kernels are written for a [`Number`]: one point, or eight side by side in vector
//! instructions, with the same bits.

// Index loops are how tensor formulas read; `!(x > 0)` is true for a NaN, which is what it is
// written for.
#![allow(clippy::needless_range_loop, clippy::neg_cmp_op_on_partial_ord)]

use super::{Elasticity, Material, PointError, PointState};
use crate::lanes::{Lanes, Number, array};
use crate::real::Real;

/// The answer of a point (or of eight) to one increment: the trial state that the caller commits
/// when it accepts the step, the stress, and what [`deviatoric_tangent`] needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response<R: Number> {
    /// Deviatoric Kirchhoff stress, `mu dev b_e_bar`, stress.
    pub stress: [R; 6],
    /// The state after the increment.
    pub state: PointState<R>,
    /// Whether plastic strain grew.
    pub yielding: R::Mask,
    /// By how much the flow stress before the increment exceeds the von Mises stress of the trial,
    /// stress; negative where it yields, infinite in an elastic material.
    pub reserve: R,
    /// mu_bar = mu tr(b_e_bar_trial)/3, stress.
    pub mu_bar: R,
    /// |s_trial|, the Frobenius norm of the trial deviator, stress.
    pub norm: R,
    /// n = s_trial/|s_trial|; 0 where the trial deviator is 0.
    pub normal: [R; 6],
    /// 2 mu_bar delta_gamma/|s_trial|; 0 for an elastic step (Simo & Hughes 1998, Box 9.2, for this
    /// and the next two).
    pub beta_1: R,
    /// Factor of n (x) n.
    pub beta_3: R,
    /// Factor of n (x) dev n^2.
    pub beta_4: R,
    /// Increment of the consistency parameter, sqrt(3/2) times that of alpha.
    pub delta_gamma: R,
    /// Increment of the plastic work per reference volume, the integral of sigma d alpha, stress;
    /// of a committed step what the flow rule dissipates (see `multistep`).
    pub plastic_work: R,
}

impl<T: Number> Response<T> {
    /// The answer of the `i`-th point.
    #[inline(always)]
    pub fn point(&self, i: usize) -> Response<T::Scalar> {
        let six = |a: &[T; 6]| a.map(|x| x.lane(i));
        Response {
            stress: six(&self.stress),
            state: PointState { be: six(&self.state.be), alpha: self.state.alpha.lane(i) },
            yielding: T::is_set(self.yielding, i),
            reserve: self.reserve.lane(i),
            mu_bar: self.mu_bar.lane(i),
            norm: self.norm.lane(i),
            normal: six(&self.normal),
            beta_1: self.beta_1.lane(i),
            beta_3: self.beta_3.lane(i),
            beta_4: self.beta_4.lane(i),
            delta_gamma: self.delta_gamma.lane(i),
            plastic_work: self.plastic_work.lane(i),
        }
    }
}

/// det(I + d) - 1, summed from the invariants of d: no digits are lost next to 1.
#[inline(always)]
pub fn determinant_minus_one<R: Number>(d: &[[R; 3]; 3]) -> R {
    let [[a, b, c], [e, f, g], [h, i, j]] = *d;
    let minors = (a * f - b * e) + (f * j - g * i) + (a * j - c * h);
    a + f + j + minors + a * (f * j - g * i) - b * (e * j - g * h) + c * (e * i - f * h)
}

/// J^(-2/3) - 1 from j = J - 1 > -1, without a power.
///
/// q = J^(1/3) - 1 is the root of q (3 + q (3 + q)) = j by Halley's iteration, which converges from
/// any q > -1; its first step from q = 0 is j/(3 + j).
#[inline(always)]
pub fn isochoric_factor_minus_one<R: Number>(j_minus_1: R) -> R {
    let three = R::of(3.0);
    let j = j_minus_1;
    let one = R::of(1.0);
    let jacobian = one + j;
    let mut q = j / (three + j);
    // Cubic convergence: a relative correction below 3e-6 was the last but one that f64 can see.
    let tolerance = R::of(if R::Scalar::EPSILON.to_f64() < 1e-10 { 3e-6 } else { 3e-3 });
    let mut going = q.finite();
    for _ in 0..40 {
        let root = one + q;
        let cube = root * root * root;
        let step = root * (j - q * (three + q * (three + q))) / (cube + cube + jacobian);
        q = R::select(going, q + step, q);
        going = R::and(going, R::not(step.abs().at_most(tolerance * q.abs())));
        if !R::any(going) {
            break;
        }
    }
    let root = one + q;
    -(q * (one + root)) / (root * root)
}

/// The deviator of a symmetric tensor, and its mean (a third of the trace).
#[inline(always)]
pub fn deviator<R: Number>(a: &[R; 6]) -> ([R; 6], R) {
    let mean = (a[0] + a[1] + a[2]) * R::of(1.0 / 3.0);
    ([a[0] - mean, a[1] - mean, a[2] - mean, a[3], a[4], a[5]], mean)
}

/// a : a of a symmetric tensor.
#[inline(always)]
pub fn norm_squared<R: Number>(a: &[R; 6]) -> R {
    let shear = a[3] * a[3] + a[4] * a[4] + a[5] * a[5];
    a[0] * a[0] + a[1] * a[1] + a[2] * a[2] + shear + shear
}

/// a . a of a symmetric tensor.
#[inline(always)]
fn square<R: Number>(a: &[R; 6]) -> [R; 6] {
    let [xx, yy, zz, xy, yz, zx] = *a;
    [
        xx * xx + xy * xy + zx * zx,
        xy * xy + yy * yy + yz * yz,
        zx * zx + yz * yz + zz * zz,
        xx * xy + xy * yy + zx * yz,
        xy * zx + yy * yz + yz * zz,
        xx * zx + xy * yz + zx * zz,
    ]
}

/// The determinant of a symmetric tensor.
#[inline(always)]
pub(super) fn determinant<R: Number>(a: &[R; 6]) -> R {
    let [xx, yy, zz, xy, yz, zx] = *a;
    xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * zx) + zx * (xy * yz - yy * zx)
}

/// W = mu/2 (tr b_e_bar - 3) from b_e_bar - I, energy per reference volume, >= 0 (Simo & Hughes
/// 1998, eq. 9.2.6).
///
/// The trace is of second order in the strain while the entries of `be` are of first order, so
/// summing the diagonal would lose the digits. It is taken from the deviator instead, as the root
/// of det(dev + t I) = 1.
#[inline]
pub fn elastic_energy_deviatoric<R: Real>(elasticity: &Elasticity<R>, be: &[R; 6]) -> R {
    let (deviator, mean) = deviator(be);
    R::of(1.5) * elasticity.shear * isochoric_mean(&deviator, mean)
}

/// u = t - 1 where t is the largest root of det(D + t I) = 1 for a deviator D: a third of tr
/// b_e_bar - 3 from dev b_e_bar.
///
/// With p = D:D/2 the equation is g(u) = u (3 + u (3 + u)) - p (1 + u) + det D = 0, convex, so that
/// Newton's iteration from a `guess` at or above the root falls onto it. A trial trace is such a
/// guess: shrinking the deviator at fixed trace raises the determinant.
#[inline(always)]
pub fn isochoric_mean<R: Number>(deviator: &[R; 6], guess: R) -> R {
    let three = R::of(3.0);
    let p = R::of(0.5) * norm_squared(deviator);
    let determinant = determinant(deviator);
    let newton_step = |u: R| {
        let t = R::of(1.0) + u;
        (u * (three + u * (three + u)) - p * t + determinant) / (three * t * t - p)
    };
    let tolerance = R::splat(R::Scalar::EPSILON).sqrt() * R::of(0.0625);
    let mut u = guess;
    let mut step = newton_step(u);
    for _ in 0..60 {
        u = u - step;
        // Written so that a NaN ends it.
        let going = step.abs().above(tolerance * u.abs());
        if !R::any(going) {
            break;
        }
        step = R::select(going, newton_step(u), R::of(0.0));
    }
    u
}

/// b_e_bar_trial - I from the relative displacement gradient d = f - I and B = b_e_bar - I (Box
/// 9.1, steps 1 and 2).
#[inline(always)]
fn trial<R: Number>(d: &[[R; 3]; 3], be: &[R; 6], r: R) -> [R; 6] {
    let [xx, yy, zz, xy, yz, zx] = *be;
    let b = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]];
    // g = f B + d, so that d + d^T + d d^T + f B f^T = g + d^T + g d^T.
    let mut g = [[R::of(0.0); 3]; 3];
    for i in 0..3 {
        for k in 0..3 {
            g[i][k] = d[i][k] + b[i][k] + d[i][0] * b[0][k] + d[i][1] * b[1][k] + d[i][2] * b[2][k];
        }
    }
    let m = |i: usize, k: usize| g[i][k] + d[k][i] + (g[i][0] * d[k][0] + g[i][1] * d[k][1] + g[i][2] * d[k][2]);
    let scale = R::of(1.0) + r;
    [m(0, 0) * scale + r, m(1, 1) * scale + r, m(2, 2) * scale + r, m(0, 1) * scale, m(1, 2) * scale, m(2, 0) * scale]
}

/// The deviatoric Kirchhoff stress and the new state after the relative deformation f = F F_n^-1,
/// given as `relative` = f - I (rows are components, columns the direction of the derivative).
///
/// `state` is the committed state. A step that stays within a few roundings of the yield surface is
/// elastic, so that a state returned onto it and evaluated again is not plastic by accident.
///
/// # Errors
/// [`PointError::Inverted`] where det f is not above 0 (or not a number), [`PointError::NotFinite`]
/// where the stress is not finite.
#[inline]
pub fn return_mapping<R: Real>(
    material: &Material<R>,
    relative: &[[R; 3]; 3],
    state: &PointState<R>,
) -> Result<Response<R>, PointError> {
    respond(material, relative, state).ok_or_else(|| {
        let jacobian = (R::ONE + determinant_minus_one(relative)).to_f64();
        // Written so that a NaN is not inverted.
        if jacobian <= 0.0 { PointError::Inverted { jacobian } } else { PointError::NotFinite }
    })
}

/// [`return_mapping`] of eight points side by side, each with the bits that it gets alone.
///
/// # Errors
/// The first point that has no answer, and why.
#[inline]
pub fn return_mapping_of_eight<R: Real>(
    material: &Material<R>,
    relative: &[[Lanes<R>; 3]; 3],
    state: &PointState<Lanes<R>>,
) -> Result<Response<Lanes<R>>, (usize, PointError)> {
    respond(material, relative, state).ok_or_else(|| first_refused(material, relative, state))
}

/// The first of eight points that has no answer, found by asking each.
#[cold]
fn first_refused<R: Real>(
    material: &Material<R>,
    relative: &[[Lanes<R>; 3]; 3],
    state: &PointState<Lanes<R>>,
) -> (usize, PointError) {
    let alone = |q: usize| {
        let state = PointState { be: state.be.map(|x| x.0[q]), alpha: state.alpha.0[q] };
        return_mapping(material, &relative.map(|row| row.map(|x| x.0[q])), &state)
    };
    (0..8).find_map(|q| alone(q).err().map(|error| (q, error))).unwrap_or((0, PointError::NotFinite))
}

/// The return mapping; nothing if a point has no answer.
#[inline(always)]
fn respond<T: Number>(material: &Material<T::Scalar>, relative: &[[T; 3]; 3], state: &PointState<T>) -> Option<Response<T>> {
    let (zero, one) = (T::of(0.0), T::of(1.0));
    let j = determinant_minus_one(relative);
    if !T::all((one + j).above(zero)) {
        return None;
    }
    let mu = T::splat(material.elasticity.shear);
    let be = trial(relative, &state.be, isochoric_factor_minus_one(j));
    let (deviator, mean) = deviator(&be);
    let strain_norm = norm_squared(&deviator).sqrt();
    let norm = mu * strain_norm;
    let mu_bar = mu * (one + mean);
    if !T::all(T::and(norm.finite(), mu_bar.above(zero))) {
        return None;
    }
    // A deviator whose square underflows has no direction; what it lacks is below rounding next to
    // mu_bar.
    let inverse = T::select(strain_norm.above(zero), one / strain_norm, zero);
    let normal = array(zero, |c| deviator[c] * inverse);
    let hardening = &material.hardening;
    let flow_stress = hardening.flow_stress(state.alpha);
    let von_mises = T::of(1.224_744_871_391_589) * norm;
    let nearly = one + T::of(8.0) * T::splat(T::Scalar::EPSILON);
    let mut response = Response {
        stress: array(zero, |c| mu * deviator[c]),
        state: PointState { be, alpha: state.alpha },
        yielding: zero.above(zero),
        reserve: flow_stress - von_mises,
        mu_bar,
        norm,
        normal,
        beta_1: zero,
        beta_3: zero,
        beta_4: zero,
        delta_gamma: zero,
        plastic_work: zero,
    };
    let yielding = T::not(von_mises.at_most(flow_stress * nearly));
    if !T::any(yielding) {
        return Some(response);
    }

    let stiffness = T::of(3.0) * mu_bar;
    let step = hardening.plastic_step(yielding, state.alpha, flow_stress, von_mises, stiffness);
    let keep = T::select(yielding, step.flow_stress / von_mises, one);
    let alpha = state.alpha + step.increment;
    if T::any(T::and(yielding, T::not(alpha.finite()))) {
        return None;
    }
    let deviator: [T; 6] = array(zero, |c| keep * deviator[c]);
    let mean = isochoric_mean(&deviator, mean);
    response.stress = array(zero, |c| mu * deviator[c]);
    let [xx, yy, zz, xy, yz, zx] = deviator;
    let returned = [xx + mean, yy + mean, zz + mean, xy, yz, zx];
    response.state = PointState {
        be: array(zero, |c| T::select(yielding, returned[c], be[c])),
        alpha: T::select(yielding, alpha, state.alpha),
    };
    response.yielding = yielding;
    let plastic = |x: T| T::select(yielding, x, zero);
    response.delta_gamma = plastic(T::of(1.224_744_871_391_589) * step.increment);
    response.plastic_work =
        plastic((hardening.plastic_work(alpha, step.flow_stress) - hardening.plastic_work(state.alpha, flow_stress)).max(zero));
    // Box 9.2; an infinite slope leaves 1/beta_0 = 0.
    let inverse_beta_0 = stiffness / (stiffness + step.slope);
    let ratio = norm / mu_bar;
    response.beta_1 = plastic((von_mises - step.flow_stress) / von_mises);
    let beta_2 = (one - inverse_beta_0) * T::of(2.0 / 3.0) * ratio * response.delta_gamma;
    response.beta_3 = plastic(inverse_beta_0 - response.beta_1 + beta_2);
    response.beta_4 = plastic((inverse_beta_0 - response.beta_1) * ratio);
    Some(response)
}

/// The spatial moduli c of the deviatoric Kirchhoff stress s, `L_v s = ds/dt - l s - s l^T = c :
/// d`, symmetrised (Simo & Hughes 1998, Box 9.2):
/// ```text
/// c   = (1 - beta_1) c_trial - 2 mu_bar beta_3 n (x) n - 2 mu_bar beta_4 sym[n (x) dev n^2]
/// c_trial = 2 mu_bar (I - 1/3 1 (x) 1) - 2/3 |s_trial| (n (x) 1 + 1 (x) n)
/// ```
/// The moduli of the exact linearisation have `n (x) dev n^2` in the place of its symmetric part.
///
/// Entry `[a][b]` is the component c_ijkl of the pairs a = ij and b = kl in the order xx, yy, zz,
/// xy, yz, zx, with no factor in it (the fourth-order identity has 1/2 at `[3][3]`). The stress
/// rate is therefore `L_v s_a = sum_(b < 3) c_ab d_b + sum_(b >= 3) c_ab 2 d_b` with tensor
/// components d_b: the usual 6 x 6 matrix for a strain vector with engineering shears 2 d_xy, 2
/// d_yz, 2 d_zx.
#[inline]
pub fn deviatoric_tangent<R: Number>(response: &Response<R>) -> [[R; 6]; 6] {
    let n = &response.normal;
    let elastic = R::of(1.0) - response.beta_1;
    let modulus = elastic * (response.mu_bar + response.mu_bar);
    // Everything but the isotropic part is n (x) x + x (x) n.
    let coupling = elastic * R::of(2.0 / 3.0) * response.norm;
    let mut x = [-coupling, -coupling, -coupling, R::of(0.0), R::of(0.0), R::of(0.0)];
    if R::any(response.yielding) {
        // Where nothing yields both factors are 0.
        let (square, _) = deviator(&square(n));
        let (third, fourth) = (response.mu_bar * response.beta_3, response.mu_bar * response.beta_4);
        for a in 0..6 {
            x[a] = x[a] - third * n[a] - fourth * square[a];
        }
    }
    let mut c = [[R::of(0.0); 6]; 6];
    for a in 0..6 {
        for b in 0..6 {
            c[a][b] = n[a] * x[b] + x[a] * n[b];
        }
    }
    let third = modulus * R::of(1.0 / 3.0);
    let half = modulus * R::of(0.5);
    for a in 0..3 {
        for b in 0..3 {
            c[a][b] = c[a][b] - third;
        }
        c[a][a] += modulus;
        c[a + 3][a + 3] += half;
    }
    c
}
