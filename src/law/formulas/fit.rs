//! Determines the constants of the formulas by least squares of whole curves, and their errors by
//! cross-validation.
//!
//! The constants are found in three steps, each with what the one before it found: the fall of F_N
//! from F_N_slip/F_N0; n and delta_T_end from F_T(delta_T), as a share of its peak; the exponents
//! of f_N from F_N(delta_T), as a share of F_N0. Cross-validation leaves out whole materials: a
//! case is predicted by constants that saw nothing of its hardening law, at no mu and no h. It also
//! decides how strongly a small study is drawn to the constants of another law.

use std::path::Path;

use rayon::prelude::*;

use super::baseline;
use super::least_squares::{PULL, minimize};
use super::model::{self, Axisymmetric, FORMAT, Law, Parameters, PriorUse, Provenance, VERSION, Validity};
use super::normal::{self, NormalModel, NormalState};
use super::own_fit::own_fit;
use super::prior::{Prior, WEIGHTS};
use super::shear::{self, Plasticity, ShearConstants};
use crate::law::LawError;
use crate::law::data::{Sample, StudyData, study_name};
use crate::law::folds;
use crate::law::range::Interval;
use crate::law::report::{Candidate, CaseErrors, Errors, FittedCase, NormalCandidate, by_region, case_errors};
use crate::law::variables::yield_lambda;

/// Fewest usable cases for a law.
pub const FEWEST_CASES: usize = 8;
/// Fewest different materials among them.
pub const FEWEST_MATERIALS: usize = 2;
/// Most folds of the cross-validation.
const FOLDS: usize = 5;
/// Seed of the folds.
const SEED: u64 = 2014;

/// The normal data of a sample, as simulated.
pub fn inputs(sample: &Sample) -> Axisymmetric {
    at(sample, NormalState { a: sample.a0, f_n: sample.f_n0 })
}

/// The inputs of a sample, with the given contact radius and force.
fn at(sample: &Sample, state: NormalState) -> Axisymmetric {
    Axisymmetric::of(&sample.body, sample.friction, sample.h0, state)
}

/// What the correlations see of a sample.
fn plasticity(sample: &Sample) -> Plasticity {
    let v = &sample.variables;
    let sphere = &sample.body.sphere;
    let first = yield_lambda(sphere.poissons_ratio);
    Plasticity::new(sample.friction, sample.a0 / sphere.radius, v.lambda, first, v.c_squared)
}

fn array<const N: usize>(constants: &[f64]) -> [f64; N] {
    std::array::from_fn(|i| constants[i])
}

fn failed(what: &'static str) -> impl Fn(String) -> LawError {
    move |problem| LawError::Fit { what, problem }
}

/// Where a fit starts and how strongly it is drawn there: to another law's constants, or weakly to
/// constants of order one.
#[derive(Clone, Copy, Debug)]
struct FitStart<T, W> {
    constants: T,
    pull: W,
    /// Whether `constants` are another law's.
    prior: bool,
}

impl<T, W: Copy> FitStart<T, W> {
    /// The weight, if it is another law's.
    fn weight(&self) -> Option<W> {
        self.prior.then_some(self.pull)
    }

    /// How a table calls it.
    fn name(&self, words: impl Fn(W) -> String) -> String {
        self.weight().map_or_else(|| "the study alone".to_owned(), |weight| format!("prior {}", words(weight)))
    }
}

/// A start of the shear.
type ShearStart = FitStart<ShearConstants, f64>;
/// A start of the normal problem, with the pull of a0 and of F_N0: they are fitted one after the
/// other, and a small study may know one of them better than its prior, but not the other.
type NormalStart = FitStart<NormalModel, [f64; 2]>;

/// The constants that fit the samples best.
fn fit_constants(start: &ShearStart, samples: &[&Sample]) -> Result<ShearConstants, LawError> {
    let states: Vec<Plasticity> = samples.iter().map(|sample| plasticity(sample)).collect();
    let FitStart { mut constants, pull, .. } = *start;

    constants.fall = array(
        &minimize(&constants.fall, pull, |c| {
            let c = array(c);
            let fall = |(sample, state): (&&Sample, &Plasticity)| shear::fall(&c, state) - (1.0 - sample.f_n_slip / sample.f_n0);
            samples.iter().zip(&states).map(fall).collect()
        })
        .map_err(failed("F_N_slip/F_N0"))?,
    );

    // Every case weighs the same, however many steps its curve has.
    let points = |sample: &Sample| ((sample.curve.len() - 1) as f64).sqrt();
    let start = [&constants.exponent[..], &constants.slip[..]].concat();
    let normal: Vec<Axisymmetric> = samples.iter().map(|sample| inputs(sample)).collect();
    let weights: Vec<f64> = samples.iter().map(|sample| 1.0 / (sample.peak() * points(sample))).collect();
    let with = |c: &[f64]| ShearConstants { exponent: array(c), slip: array(&c[6..]), ..constants };
    let found = minimize(&start, pull, |c| {
        let trial = with(c);
        let mut residuals = Vec::new();
        for ((sample, inputs), weight) in samples.iter().zip(&normal).zip(&weights) {
            let p = model::contact(&trial, inputs);
            let f_t = |delta_t: f64| model::forces(&p, sample.friction, delta_t).0;
            residuals.extend(sample.curve[1..].iter().map(|at| weight * (f_t(at.delta_t) - at.f_t)));
        }
        residuals
    })
    .map_err(failed("F_T(delta_T)"))?;
    constants = with(&found);

    // Only M and N change in what follows.
    let contacts: Vec<Parameters> = normal.iter().map(|inputs| model::contact(&constants, inputs)).collect();
    let found = minimize(&constants.curve, pull, |c| {
        let c = array(c);
        let mut residuals = Vec::new();
        for (sample, contact) in samples.iter().zip(&contacts) {
            let (m_exponent, n_exponent) = shear::curve_exponents(&c, sample.friction, contact.n);
            let p = Parameters { m_exponent, n_exponent, ..*contact };
            let weight = 1.0 / (sample.f_n0 * points(sample));
            let f_n = |delta_t: f64| model::forces(&p, sample.friction, delta_t).1;
            residuals.extend(sample.curve[1..].iter().map(|at| weight * (f_n(at.delta_t) - at.f_n)));
        }
        residuals
    })
    .map_err(failed("F_N(delta_T)"))?;
    Ok(ShearConstants { curve: array(&found), ..constants })
}

/// The constants of a0 and F_N0 that fit the samples best.
fn fit_normal(start: &NormalStart, samples: &[&Sample]) -> Result<NormalModel, LawError> {
    let ([radius_pull, force_pull], from) = (start.pull, start.constants);
    let radius = minimize(&from.radius, radius_pull, |c| {
        let c = array(c);
        samples.iter().map(|s| (normal::contact_radius(&c, &s.body, s.h0) / s.a0).ln()).collect()
    })
    .map_err(failed("a0(h)"))?;
    let force = minimize(&from.force, force_pull, |c| {
        let c = array(c);
        samples.iter().map(|s| (normal::normal_force(&c, &s.body, s.friction, s.h0) / s.f_n0).ln()).collect()
    })
    .map_err(failed("F_N0(h)"))?;
    Ok(NormalModel::new(array(&radius), array(&force)))
}

fn law_errors(constants: &ShearConstants, sample: &Sample, inputs: &Axisymmetric) -> CaseErrors {
    let parameters = model::contact(constants, inputs);
    case_errors(sample, |delta_t| model::forces(&parameters, sample.friction, delta_t))
}

/// The samples, and which fold leaves out which material.
struct Folded<'a> {
    samples: &'a [Sample],
    fold_of: Vec<usize>,
    folds: usize,
}

impl Folded<'_> {
    /// A fit for each fold, found without it; the last one with all samples.
    fn by_fold<T>(&self, fit: impl Fn(&[&Sample]) -> Result<T, LawError>) -> Result<Vec<T>, LawError> {
        let seen = |fold: usize| self.samples.iter().filter(|sample| self.fold_of[sample.material] != fold).collect::<Vec<_>>();
        (0..=self.folds).map(|fold| fit(&seen(fold))).collect()
    }

    /// What saw nothing of the sample's material.
    fn of<'b, T>(&self, by_fold: &'b [T], sample: &Sample) -> &'b T {
        &by_fold[self.fold_of[sample.material]]
    }
}

/// A start with what came of it: a fit for each fold, the last one with all samples.
struct Compared<S, T, C> {
    start: S,
    by_fold: Vec<T>,
    candidate: C,
}

/// A fit of the shear with the errors of each case.
type ComparedShear = Compared<ShearStart, ShearConstants, Vec<CaseErrors>>;
/// A fit of the normal problem.
type ComparedNormal = Compared<NormalStart, NormalModel, NormalCandidate>;

/// The starts of the shear compared, best first.
fn compare_shears(prior: Option<&Law>, folded: &Folded) -> Result<Vec<ComparedShear>, LawError> {
    let mut starts = vec![FitStart { constants: ShearConstants::START, pull: PULL, prior: false }];
    if let Some(Law { constants, .. }) = prior {
        starts.extend(WEIGHTS.map(|pull| FitStart { constants: *constants, pull, prior: true }));
    }
    let mut compared: Vec<_> = starts
        .into_par_iter()
        .map(|start| {
            let by_fold = folded.by_fold(|seen| fit_constants(&start, seen))?;
            let errors = folded.samples.iter().map(|s| law_errors(folded.of(&by_fold, s), s, &inputs(s))).collect();
            Ok(Compared { start, by_fold, candidate: errors })
        })
        .collect::<Result<_, LawError>>()?;
    compared.sort_by(|a, b| Errors::over(&a.candidate).score().total_cmp(&Errors::over(&b.candidate).score()));
    Ok(compared)
}

/// The starts of the normal problem compared, best first.
fn compare_normals(prior: Option<&Law>, folded: &Folded) -> Result<Vec<ComparedNormal>, LawError> {
    let mut starts = vec![FitStart { constants: NormalModel::START, pull: [PULL; 2], prior: false }];
    if let Some(Law { normal, .. }) = prior {
        let start = |pull| FitStart { constants: *normal, pull, prior: true };
        starts.extend(WEIGHTS.into_iter().flat_map(|a| WEIGHTS.map(|f| start([a, f]))));
    }
    let mut compared: Vec<_> = starts
        .into_par_iter()
        .map(|start| {
            let by_fold = folded.by_fold(|seen| fit_normal(&start, seen))?;
            let error = |s: &Sample| {
                let state = folded.of(&by_fold, s).state(&s.body, s.friction, s.h0);
                let (a, f_n) = ((state.a / s.a0 - 1.0).abs(), (state.f_n / s.f_n0 - 1.0).abs());
                [a, a, f_n, f_n]
            };
            let errors = Errors::over(&folded.samples.iter().map(error).collect::<Vec<_>>());
            let candidate = NormalCandidate {
                name: start.name(|[a, f]| format!("{a}, {f}")),
                constants: start.constants.radius.len() + start.constants.force.len(),
                a_rms: errors.f_t_rms,
                a_max: errors.f_t_max,
                f_n_rms: errors.f_n_rms,
                f_n_max: errors.f_n_max,
                kept: false,
            };
            Ok(Compared { start, by_fold, candidate })
        })
        .collect::<Result<_, LawError>>()?;
    let score = |c: &NormalCandidate| c.a_rms.hypot(c.f_n_rms);
    compared.sort_by(|a, b| score(&a.candidate).total_cmp(&score(&b.candidate)));
    if let Some(best) = compared.first_mut() {
        best.candidate.kept = true;
    }
    Ok(compared)
}

/// Fits a law to a study.
///
/// `dir` is the directory of the study; `prior` what is known before. The same study gives the same
/// law, to the bit, at any number of threads.
///
/// # Errors
/// No study, too few cases, files that cannot be read, a fit that ends nowhere.
pub fn fit(dir: &Path, prior: &Prior) -> Result<Law, LawError> {
    let data = StudyData::read(dir)?;
    let (samples, materials) = (&data.samples, data.materials());
    if samples.len() < FEWEST_CASES || materials < FEWEST_MATERIALS {
        return Err(LawError::TooFewCases {
            path: dir.to_owned(),
            cases: samples.len(),
            materials,
            needed_cases: FEWEST_CASES,
            needed_materials: FEWEST_MATERIALS,
            skipped: data.skipped_sentence(),
        });
    }
    let prior = prior.law(samples.len())?;
    let folds = FOLDS.min(materials);
    let folded = Folded { samples, fold_of: folds::assign(materials, folds, SEED), folds };
    let (shears, normals) = (compare_shears(prior.as_ref(), &folded)?, compare_normals(prior.as_ref(), &folded)?);
    let (Some(shear), Some(normal)) = (shears.first(), normals.first()) else {
        return Err(failed("the law")("there is nothing to start from".to_owned()));
    };
    // The whole way from the case alone: normal data predicted, by models that saw nothing of the
    // material either.
    let predicted: Vec<CaseErrors> = samples
        .iter()
        .map(|s| {
            let state = folded.of(&normal.by_fold, s).state(&s.body, s.friction, s.h0);
            law_errors(folded.of(&shear.by_fold, s), s, &at(s, state))
        })
        .collect();
    let regions = |errors: &[CaseErrors]| {
        let first = |s: &Sample| yield_lambda(s.body.sphere.poissons_ratio);
        let rows: Vec<_> = samples.iter().zip(errors).map(|(s, e)| (s.variables.lambda, first(s), s.friction, *e)).collect();
        by_region(&rows)
    };
    let used = prior.filter(|_| shear.start.prior || normal.start.prior).map(|law| PriorUse {
        study: law.provenance.study,
        shear: shear.start.weight(),
        normal: normal.start.weight(),
    });
    Ok(Law {
        format: FORMAT.to_owned(),
        version: VERSION,
        constants: shear.by_fold[folds],
        normal: normal.by_fold[folds],
        validity: validity(samples)?,
        provenance: provenance(dir, &data, folds, used),
        errors: regions(&shear.candidate),
        errors_predicted: regions(&predicted),
        candidates: candidates(&shears, samples),
        normal_candidates: normals.iter().map(|compared| compared.candidate.clone()).collect(),
        cases: samples.iter().zip(&shear.candidate).map(|(s, e)| fitted_case(s, e)).collect::<Result<_, _>>()?,
    })
}

/// The fits of the shear, best first, and the baselines.
fn candidates(shears: &[ComparedShear], samples: &[Sample]) -> Vec<Candidate> {
    let fitted = shears.iter().enumerate().map(|(rank, compared)| Candidate {
        name: compared.start.name(|weight| weight.to_string()),
        constants: ShearConstants::COUNT,
        errors: Errors::over(&compared.candidate),
        kept: rank == 0,
    });
    fitted.chain(baseline::candidates(samples)).collect()
}

/// Where a law comes from.
fn provenance(dir: &Path, data: &StudyData, folds: usize, prior: Option<PriorUse>) -> Provenance {
    let elements = || data.samples.iter().map(|sample| sample.elements_per_contact_radius);
    Provenance {
        program: format!("asperity {}", env!("CARGO_PKG_VERSION")),
        study: study_name(dir),
        cases: data.samples.len(),
        raw: data.raw(),
        left_out: data.skipped.iter().map(|skipped| (skipped.id.clone(), skipped.reason.clone())).collect(),
        materials: data.materials(),
        elements_per_contact_radius: (elements().min().unwrap_or(0), elements().max().unwrap_or(0)),
        folds,
        seed: SEED,
        prior,
    }
}

fn validity(samples: &[Sample]) -> Result<Validity, LawError> {
    let range = |value: fn(&Sample) -> f64| {
        Interval::of(samples.iter().map(value)).ok_or_else(|| failed("the range of validity")("there are no cases".to_owned()))
    };
    Ok(Validity {
        lambda: range(|s| s.variables.lambda)?,
        friction: range(|s| s.friction)?,
        relative_radius: range(|s| s.a0 / s.body.sphere.radius)?,
        c_squared: range(|s| s.variables.c_squared)?,
        poissons_ratio: range(|s| s.body.sphere.poissons_ratio)?,
        hardening_exponent: range(|s| s.body.hardening_exponent(s.a0))?,
    })
}

fn fitted_case(sample: &Sample, errors: &CaseErrors) -> Result<FittedCase, LawError> {
    let own = own_fit(sample).map_err(failed("the curves of one case"))?;
    let v = &sample.variables;
    Ok(FittedCase {
        case: sample.id.clone(),
        lambda: v.lambda,
        friction: sample.friction,
        c_squared: v.c_squared,
        hardness: v.hardness,
        relative_radius: sample.a0 / sample.body.sphere.radius,
        slip_share: sample.f_n_slip / sample.f_n0,
        stiffness_ratio: own.stiffness_ratio,
        slip_factor: own.slip_factor,
        n: own.n,
        m_exponent: own.m_exponent,
        n_exponent: own.n_exponent,
        own_f_t_max: own.f_t_max,
        law_f_t_max: errors[1],
        law_f_n_max: errors[3],
    })
}
