//! The parameters of one case by least squares of its own curves: delta_T_end and n from F_T, M
//! and N from F_N.
//!
//! Where F_T approaches mu F_N_slip as an exponential, n and delta_T_end grow together without
//! bound; n is kept below 3/2 + 8.5 as in the law.

use super::least_squares::{PULL, minimize};
use super::shear::{self, EXPONENT_SPAN};
use crate::analytical::cattaneo_mindlin;
use crate::law::data::Sample;

/// One case's own parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OwnFit {
    /// delta_T_end over its elastic value.
    pub slip_factor: f64,
    /// n.
    pub n: f64,
    /// M.
    pub m_exponent: f64,
    /// N.
    pub n_exponent: f64,
    /// The simulation's k_T0 over Mindlin's.
    pub stiffness_ratio: f64,
    /// Greatest error of F_T as a share of its peak.
    pub f_t_max: f64,
}

/// Fits one case; the error is what the least squares say.
pub fn own_fit(sample: &Sample) -> Result<OwnFit, String> {
    let mindlin = cattaneo_mindlin::initial_stiffness(&sample.body.sphere, sample.a0);
    let elastic_slip = 1.5 * sample.friction * sample.f_n0 / mindlin;
    let limit = sample.friction * sample.f_n_slip;
    let points = &sample.curve[1..];
    // Of the two constants n is 1 + (span + 1/2) s/(1 + s): between 1 and its bound for any s > 0.
    let exponent = |s: f64| 1.0 + (EXPONENT_SPAN + 0.5) * s / (1.0 + s);
    let f_t = |c: &[f64], delta_t: f64| limit * shear::f_t(delta_t / (c[0] * elastic_slip), exponent(c[1]));
    let peak = sample.peak();
    let found = minimize(&[1.5, 0.1], PULL, |c| points.iter().map(|at| (f_t(c, at.delta_t) - at.f_t) / peak).collect())?;
    let f_t_max = points.iter().map(|at| (f_t(&found, at.delta_t) - at.f_t).abs() / peak).fold(0.0, f64::max);
    let slip = found[0] * elastic_slip;
    let fall = sample.f_n0 - sample.f_n_slip;
    let exponents = minimize(&[1.5, 1.5], PULL, |c| {
        let fallen = |delta_t: f64| fall * shear::f_n(delta_t / slip, c[0], c[1]);
        points.iter().map(|at| (sample.f_n0 - fallen(at.delta_t) - at.f_n) / sample.f_n0).collect()
    })?;
    Ok(OwnFit {
        slip_factor: found[0],
        n: exponent(found[1]),
        m_exponent: exponents[0],
        n_exponent: exponents[1],
        stiffness_ratio: sample.k_t0 / mindlin,
        f_t_max,
    })
}
