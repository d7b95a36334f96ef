//! What a fit says of itself: tables of what was compared and of errors by region, for `law.json`
//! and for the terminal.

use std::fmt::Write;

use serde::{Deserialize, Serialize};

use super::data::Sample;

/// Errors over a number of cases. F_T as a share of the peak of F_T, F_N as a share of F_N0; rms
/// over the points of each curve and over the cases, max over all points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Errors {
    /// Cases.
    pub cases: usize,
    /// rms of F_T.
    pub f_t_rms: f64,
    /// Greatest of F_T.
    pub f_t_max: f64,
    /// rms of F_N.
    pub f_n_rms: f64,
    /// Greatest of F_N.
    pub f_n_max: f64,
}

/// Errors of one case: (rms, max) of F_T, (rms, max) of F_N.
pub type CaseErrors = [f64; 4];

impl Errors {
    /// Over the given cases.
    pub fn over<'a>(cases: impl IntoIterator<Item = &'a CaseErrors>) -> Self {
        let mut errors = Self::default();
        for [f_t_rms, f_t_max, f_n_rms, f_n_max] in cases {
            errors.cases += 1;
            errors.f_t_rms += f_t_rms * f_t_rms;
            errors.f_n_rms += f_n_rms * f_n_rms;
            errors.f_t_max = errors.f_t_max.max(*f_t_max);
            errors.f_n_max = errors.f_n_max.max(*f_n_max);
        }
        let count = errors.cases.max(1) as f64;
        errors.f_t_rms = (errors.f_t_rms / count).sqrt();
        errors.f_n_rms = (errors.f_n_rms / count).sqrt();
        errors
    }

    /// One number to rank by: both rms errors together.
    pub fn score(&self) -> f64 {
        self.f_t_rms.hypot(self.f_n_rms)
    }

    fn columns(&self) -> String {
        let percent = |x: f64| format!("{:>7.2}", 100.0 * x);
        let Self { f_t_rms, f_t_max, f_n_rms, f_n_max, .. } = *self;
        format!("{} {} {} {}", percent(f_t_rms), percent(f_t_max), percent(f_n_rms), percent(f_n_max))
    }
}

/// Errors of a curve against a sample's: `model`(delta_T) gives F_T and F_N.
pub fn case_errors(sample: &Sample, model: impl Fn(f64) -> (f64, f64)) -> CaseErrors {
    let peak = sample.peak();
    let (mut squares, mut greatest) = ([0.0; 2], [0.0_f64; 2]);
    for at in &sample.curve {
        let (f_t, f_n) = model(at.delta_t);
        for (i, error) in [(f_t - at.f_t) / peak, (f_n - at.f_n) / sample.f_n0].into_iter().enumerate() {
            squares[i] += error * error;
            greatest[i] = greatest[i].max(error.abs());
        }
    }
    let rms = squares.map(|sum| (sum / sample.curve.len() as f64).sqrt());
    [rms[0], greatest[0], rms[1], greatest[1]]
}

/// A fit, or a baseline, with its errors on cases that it was not fitted to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Candidate {
    /// Where it starts, or what it is.
    pub name: String,
    /// Number of fitted constants.
    pub constants: usize,
    /// Cross-validated errors.
    pub errors: Errors,
    /// Whether it is the law.
    pub kept: bool,
}

/// A fit of the normal problem with its cross-validated relative errors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NormalCandidate {
    /// Where it starts, or what it is.
    pub name: String,
    /// Number of fitted constants.
    pub constants: usize,
    /// rms of a0.
    pub a_rms: f64,
    /// Greatest of a0.
    pub a_max: f64,
    /// rms of F_N0.
    pub f_n_rms: f64,
    /// Greatest of F_N0.
    pub f_n_max: f64,
    /// Whether it is the law's.
    pub kept: bool,
}

/// Errors in one region of Lambda and mu.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RegionError {
    /// The region, in words.
    pub region: String,
    /// Its errors.
    pub errors: Errors,
}

/// One case with its own parameters, by least squares of its own curves: what the correlations are
/// drawn through.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FittedCase {
    /// The case's name in `study.csv`.
    pub case: String,
    /// Lambda.
    pub lambda: f64,
    /// mu.
    pub friction: f64,
    /// c^2.
    pub c_squared: f64,
    /// Hbar.
    pub hardness: f64,
    /// a/R.
    pub relative_radius: f64,
    /// F_N_slip/F_N0.
    pub slip_share: f64,
    /// k_T0 of the simulation over Mindlin's.
    pub stiffness_ratio: f64,
    /// delta_T_end over its elastic value.
    pub slip_factor: f64,
    /// n of f_T.
    pub n: f64,
    /// M of f_N.
    pub m_exponent: f64,
    /// N of f_N.
    pub n_exponent: f64,
    /// Greatest error of F_T of this curve's own fit, as a share of its peak.
    pub own_f_t_max: f64,
    /// Cross-validated greatest error of the law in F_T, as a share of the peak, F_N0 and a0 being
    /// known.
    pub law_f_t_max: f64,
    /// Likewise in F_N, as a share of F_N0.
    pub law_f_n_max: f64,
}

/// Boundaries of Lambda between the regions of an error table; the first region ends at first
/// yield.
pub const LAMBDA_BOUNDS: [f64; 2] = [20.0, 160.0];
/// Boundaries of mu likewise.
pub const FRICTION_BOUNDS: [f64; 2] = [0.2, 0.4];

/// The regions of Lambda, and those of mu, in words.
const LEVELS: [&str; 4] = ["elastic", "Lambda < 20", "Lambda 20 to 160", "Lambda > 160"];
const FRICTIONS: [&str; 3] = ["mu < 0.2", "mu 0.2 to 0.4", "mu >= 0.4"];

/// The numbers of the regions of a contact: of Lambda, whose first yield is at `first`, and of mu.
fn numbers(lambda: f64, first: f64, mu: f64) -> (usize, usize) {
    let ([low, high], [weak, strong]) = (LAMBDA_BOUNDS, FRICTION_BOUNDS);
    let level = if lambda <= first {
        0
    } else if lambda < low {
        1
    } else {
        2 + usize::from(lambda > high)
    };
    (level, usize::from(mu >= weak) + usize::from(mu >= strong))
}

/// The region of a contact, as [`by_region`] calls it.
pub fn region(lambda: f64, first: f64, mu: f64) -> String {
    let (level, friction) = numbers(lambda, first, mu);
    format!("{}, {}", LEVELS[level], FRICTIONS[friction])
}

/// Errors by region of Lambda and mu, regions without cases left out; the last row is for all.
/// `cases`: (Lambda, Lambda_Y, mu, errors).
pub fn by_region(cases: &[(f64, f64, f64, CaseErrors)]) -> Vec<RegionError> {
    let mut rows = Vec::new();
    for (i, level_name) in LEVELS.iter().enumerate() {
        for (j, friction_name) in FRICTIONS.iter().enumerate() {
            let inside = cases.iter().filter(|(lambda, first, mu, _)| numbers(*lambda, *first, *mu) == (i, j));
            let errors = Errors::over(inside.map(|(_, _, _, errors)| errors));
            if errors.cases > 0 {
                rows.push(RegionError { region: format!("{level_name}, {friction_name}"), errors });
            }
        }
    }
    rows.push(RegionError { region: "all".to_owned(), errors: Errors::over(cases.iter().map(|(_, _, _, errors)| errors)) });
    rows
}

/// The table of fits, errors in per cent.
pub fn candidate_table(candidates: &[Candidate]) -> String {
    let mut text = String::from(
        "Shear, cross-validated errors in per cent (F_T of its peak, F_N of F_N0)\n\
         fitted from                         constants  F_T rms     max F_N rms     max\n",
    );
    for candidate in candidates {
        let kept = if candidate.kept { " *" } else { "" };
        let _ = writeln!(text, "{:<35} {:>9}  {}{kept}", candidate.name, candidate.constants, candidate.errors.columns());
    }
    text
}

/// The table of fits of the normal problem, errors in per cent.
pub fn normal_table(candidates: &[NormalCandidate]) -> String {
    let mut text = String::from(
        "Normal problem (weights for a0 and F_N0), cross-validated errors in per cent\n\
         fitted from                   constants   a0 rms     max F_N0 rms    max\n",
    );
    for c in candidates {
        let kept = if c.kept { " *" } else { "" };
        let [a_rms, a_max, f_rms, f_max] = [c.a_rms, c.a_max, c.f_n_rms, c.f_n_max].map(|x| 100.0 * x);
        let _ = writeln!(text, "{:<29} {:>9} {a_rms:>8.2} {a_max:>7.2} {f_rms:>8.2} {f_max:>6.2}{kept}", c.name, c.constants);
    }
    text
}

/// A table of errors by region, in per cent.
pub fn region_table(title: &str, regions: &[RegionError]) -> String {
    let mut text = format!("{title}\n{:<34} {:>5}  F_T rms     max F_N rms     max\n", "region", "cases");
    for region in regions {
        let _ = writeln!(text, "{:<34} {:>5}  {}", region.region, region.errors.cases, region.errors.columns());
    }
    text
}
