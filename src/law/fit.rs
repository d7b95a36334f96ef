//! Determines the constants of every candidate by least squares of whole curves, compares them by
//! cross-validation, and keeps the best.
//!
//! A candidate's constants are found in three steps, each with what the one before it found: the
//! fall of F_N from F_N_slip/F_N0; n and delta_T_slip from F_T(delta_T), as a share of its peak;
//! the exponents of f_N from F_N(delta_T), as a share of F_N0. Cross-validation leaves out whole
//! materials: a case is predicted by constants that saw nothing of its hardening law, at no mu and
//! no h.

use std::path::Path;

use rayon::prelude::*;

use super::LawError;
use super::data::{Sample, StudyData};
use super::forms::{self, Constants, Forms, NormalCurve, Plasticity, SlipForm, Variable};
use super::least_squares::{PULL, Sign, minimize};
use super::model::{self, Axisymmetric, FORMAT, Interval, Law, Parameters, PriorUse, Provenance, VERSION, Validity};
use super::normal::{self, NormalForm, NormalModel};
use super::own_fit::own_fit;
use super::prior::{Prior, WEIGHTS};
use super::report::{Candidate, CaseErrors, Errors, FittedCase, NormalCandidate, by_region, case_errors};
use super::variables::yield_lambda;
use super::{baseline, folds};

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
    at(sample, sample.a0, sample.f_n0)
}

/// The inputs of a sample, with the given contact radius and force.
fn at(sample: &Sample, a: f64, f_n: f64) -> Axisymmetric {
    let sphere = sample.body.sphere;
    Axisymmetric {
        youngs_modulus: sphere.youngs_modulus,
        poissons_ratio: sphere.poissons_ratio,
        radius: sphere.radius,
        friction: sample.friction,
        sigma_rep: sample.body.representative_stress(a),
        h: sample.h0,
        a,
        f_n,
    }
}

/// What the correlations see of a sample.
fn plasticity(variable: Variable, sample: &Sample) -> Plasticity {
    let v = &sample.variables;
    let sphere = &sample.body.sphere;
    let first = yield_lambda(sphere.poissons_ratio);
    Plasticity::new(variable, sample.friction, sample.a0 / sphere.radius, v.lambda, first, v.hardness, v.c_squared)
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
struct Start<T> {
    constants: T,
    pull: f64,
    /// Whether `constants` are another law's.
    prior: bool,
}

impl<T: Copy> Start<T> {
    /// The weight, if it is another law's.
    fn weight(&self) -> Option<f64> {
        self.prior.then_some(self.pull)
    }

    fn suffix(&self) -> String {
        self.weight().map_or_else(String::new, |weight| format!(", prior {weight}"))
    }
}

/// The constants of one combination of forms that fit the samples best.
fn fit_constants(forms: &Forms, start: &Start<Constants>, samples: &[&Sample]) -> Result<Constants, LawError> {
    let states: Vec<Plasticity> = samples.iter().map(|sample| plasticity(forms.variable, sample)).collect();
    let Start { mut constants, pull, .. } = *start;

    constants.fall = array(
        &minimize(Sign::Positive, &constants.fall, pull, |c| {
            let c = array(c);
            let fall =
                |(sample, state): (&&Sample, &Plasticity)| forms::fall(forms, &c, state) - (1.0 - sample.f_n_slip / sample.f_n0);
            samples.iter().zip(&states).map(fall).collect()
        })
        .map_err(failed("F_N_slip/F_N0"))?,
    );

    // Every case weighs the same, however many steps its curve has.
    let points = |sample: &Sample| ((sample.curve.len() - 1) as f64).sqrt();
    let start = [&constants.exponent[..], &constants.slip[..]].concat();
    let normal: Vec<Axisymmetric> = samples.iter().map(|sample| inputs(sample)).collect();
    let weights: Vec<f64> = samples.iter().map(|sample| 1.0 / (sample.peak() * points(sample))).collect();
    let with = |c: &[f64]| Constants { exponent: array(c), slip: array(&c[6..]), ..constants };
    let found = minimize(Sign::Positive, &start, pull, |c| {
        let trial = with(c);
        let mut residuals = Vec::new();
        for ((sample, inputs), weight) in samples.iter().zip(&normal).zip(&weights) {
            let p = model::contact(forms, &trial, inputs);
            let f_t = |delta_t: f64| model::forces(forms, &p, sample.friction, delta_t).0;
            residuals.extend(sample.curve[1..].iter().map(|at| weight * (f_t(at.delta_t) - at.f_t)));
        }
        residuals
    })
    .map_err(failed("F_T(delta_T)"))?;
    constants = with(&found);

    // Only M and N change in what follows.
    let contacts: Vec<Parameters> = normal.iter().map(|inputs| model::contact(forms, &constants, inputs)).collect();
    let found = minimize(Sign::Positive, &constants.curve, pull, |c| {
        let c = array(c);
        let mut residuals = Vec::new();
        for (sample, contact) in samples.iter().zip(&contacts) {
            let (steep, gentle) = forms::curve_exponents(&c, sample.friction, contact.n);
            let (m_exponent, n_exponent) = forms.normal_curve.exponents(steep, gentle);
            let p = Parameters { m_exponent, n_exponent, ..*contact };
            let weight = 1.0 / (sample.f_n0 * points(sample));
            let f_n = |delta_t: f64| model::forces(forms, &p, sample.friction, delta_t).1;
            residuals.extend(sample.curve[1..].iter().map(|at| weight * (f_n(at.delta_t) - at.f_n)));
        }
        residuals
    })
    .map_err(failed("F_N(delta_T)"))?;
    Ok(Constants { curve: array(&found), ..constants })
}

fn law_errors(forms: &Forms, constants: &Constants, sample: &Sample, inputs: &Axisymmetric) -> CaseErrors {
    let parameters = model::contact(forms, constants, inputs);
    case_errors(sample, |delta_t| model::forces(forms, &parameters, sample.friction, delta_t))
}

/// Splits the samples by whether they are in the fold.
fn split(samples: &[Sample], fold_of: &[usize], fold: usize) -> (Vec<usize>, Vec<usize>) {
    (0..samples.len()).partition(|&i| fold_of[samples[i].material] != fold)
}

/// Constants for each fold, found without it; the last ones with all samples.
fn constants_by_fold(
    forms: &Forms,
    start: &Start<Constants>,
    samples: &[Sample],
    fold_of: &[usize],
    folds: usize,
) -> Result<Vec<Constants>, LawError> {
    let fold = |fold: usize| {
        let (seen, _) = split(samples, fold_of, fold);
        fit_constants(forms, start, &seen.iter().map(|&i| &samples[i]).collect::<Vec<_>>())
    };
    (0..=folds).map(fold).collect()
}

/// As [`Start`]; no prior model means the form's own start. The pull is that of the force, the
/// other that of the radius: a0 and F_N0 are fitted one after the other, and a small study may know
/// one of them better than its prior, but not the other.
type NormalStart<'a> = (Start<Option<&'a NormalModel>>, f64);

/// Fits one form of the normal problem.
fn fit_normal(form: NormalForm, (start, radius_pull): &NormalStart, samples: &[&Sample]) -> Result<NormalModel, LawError> {
    let pull = start.pull;
    let (radius_start, force_start) = match start.constants {
        Some(prior) => (prior.radius.clone(), prior.force.clone()),
        None => (form.radius_start(), form.force_start()),
    };
    let radius = minimize(form.sign(), &radius_start, *radius_pull, |c| {
        samples.iter().map(|s| (normal::contact_radius(form, c, &s.body, s.h0) / s.a0).ln()).collect()
    })
    .map_err(failed("a0(h)"))?;
    let radii: Vec<f64> = samples.iter().map(|s| normal::contact_radius(form, &radius, &s.body, s.h0)).collect();
    let force = minimize(form.sign(), &force_start, pull, |c| {
        let force = |(s, &a): (&&Sample, &f64)| (normal::normal_force(form, c, &s.body, s.friction, s.h0, a) / s.f_n0).ln();
        samples.iter().zip(&radii).map(force).collect()
    })
    .map_err(failed("F_N0(h)"))?;
    Ok(NormalModel { form, radius, force })
}

/// What was compared, the weights of the prior for a0 and F_N0 that were chosen (none for a free
/// fit), and the models by fold.
type ChosenNormal = (Vec<NormalCandidate>, Option<[f64; 2]>, Vec<NormalModel>);

/// How a table calls a start of the normal problem.
fn suffix((start, radius_pull): &NormalStart) -> String {
    start.weight().map_or_else(String::new, |weight| format!(", prior {radius_pull}, {weight}"))
}

/// The normal forms compared; the best one's weight of the prior and its models by fold, the last
/// one fitted to all.
fn choose_normal(
    prior: Option<&NormalModel>,
    samples: &[Sample],
    fold_of: &[usize],
    folds: usize,
) -> Result<ChosenNormal, LawError> {
    let mut starts: Vec<(NormalForm, NormalStart)> =
        NormalForm::ALL.into_iter().map(|form| (form, (Start { constants: None, pull: PULL, prior: false }, PULL))).collect();
    if let Some(prior) = prior.filter(|prior| prior.form != NormalForm::Published) {
        let start = |pull| Start { constants: Some(prior), pull, prior: true };
        starts.extend(WEIGHTS.into_iter().flat_map(|a| WEIGHTS.map(|f| (prior.form, (start(f), a)))));
    }
    let fitted: Vec<(NormalCandidate, Vec<NormalModel>)> = starts
        .par_iter()
        .map(|&(form, start)| {
            let models: Vec<NormalModel> = (0..=folds)
                .map(|fold| {
                    let (seen, _) = split(samples, fold_of, fold);
                    fit_normal(form, &start, &seen.iter().map(|&i| &samples[i]).collect::<Vec<_>>())
                })
                .collect::<Result<_, _>>()?;
            let errors: Vec<CaseErrors> = samples
                .iter()
                .map(|s| {
                    let state = models[fold_of[s.material]].state(&s.body, s.friction, s.h0);
                    let (a, f_n) = ((state.a / s.a0 - 1.0).abs(), (state.f_n / s.f_n0 - 1.0).abs());
                    [a, a, f_n, f_n]
                })
                .collect();
            let errors = Errors::over(&errors);
            let candidate = NormalCandidate {
                name: format!("{}{}", form.label(), suffix(&start)),
                constants: form.radius_start().len() + form.force_start().len(),
                a_rms: errors.f_t_rms,
                a_max: errors.f_t_max,
                f_n_rms: errors.f_n_rms,
                f_n_max: errors.f_n_max,
                kept: false,
            };
            Ok((candidate, models))
        })
        .collect::<Result<_, LawError>>()?;
    let (mut candidates, models): (Vec<_>, Vec<_>) = fitted.into_iter().unzip();
    let score = |c: &NormalCandidate| c.a_rms.hypot(c.f_n_rms);
    let best = (0..candidates.len()).min_by(|&i, &j| score(&candidates[i]).total_cmp(&score(&candidates[j]))).unwrap_or(0);
    candidates[best].kept = true;
    candidates.sort_by(|a, b| score(a).total_cmp(&score(b)));
    let weight = starts.get(best).and_then(|(_, (start, radius_pull))| Some([*radius_pull, start.weight()?]));
    Ok((candidates, weight, models.into_iter().nth(best).unwrap_or_default()))
}

/// One combination of forms, compared.
struct Compared {
    forms: Forms,
    start: Start<Constants>,
    by_fold: Vec<Constants>,
    errors: Vec<CaseErrors>,
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
    let fold_of = folds::assign(materials, folds, SEED);

    let without = Start { constants: Constants::START, pull: PULL, prior: false };
    let mut combinations: Vec<(Forms, Start<Constants>)> = Variable::ALL
        .into_iter()
        .flat_map(|variable| SlipForm::ALL.into_iter().map(move |slip| (variable, slip)))
        .flat_map(|(variable, slip_displacement)| {
            NormalCurve::ALL.into_iter().map(move |normal_curve| (Forms { variable, slip_displacement, normal_curve }, without))
        })
        .collect();
    if let Some(Law { forms, constants, .. }) = prior {
        combinations.extend(WEIGHTS.map(|pull| (forms, Start { constants, pull, prior: true })));
    }
    let mut compared: Vec<Compared> = combinations
        .into_par_iter()
        .map(|(forms, start)| {
            let by_fold = constants_by_fold(&forms, &start, samples, &fold_of, folds)?;
            let error = |s: &Sample| law_errors(&forms, &by_fold[fold_of[s.material]], s, &inputs(s));
            Ok(Compared { forms, start, errors: samples.iter().map(error).collect(), by_fold })
        })
        .collect::<Result<_, LawError>>()?;
    let score = |c: &Compared| Errors::over(&c.errors).score();
    compared.sort_by(|a, b| score(a).total_cmp(&score(b)));
    let mut candidates: Vec<Candidate> = compared
        .iter()
        .enumerate()
        .map(|(rank, c)| Candidate {
            name: format!(
                "{}, {}, {}{}",
                c.forms.variable.label(),
                c.forms.slip_displacement.label(),
                c.forms.normal_curve.label(),
                c.start.suffix()
            ),
            constants: c.forms.constants(),
            errors: Errors::over(&c.errors),
            kept: rank == 0,
        })
        .collect();
    candidates.extend(baseline::candidates(samples));

    let (normal_candidates, normal_weight, normal_models) =
        choose_normal(prior.as_ref().map(|law| &law.normal), samples, &fold_of, folds)?;
    let Compared { forms, start, by_fold, errors } = compared.swap_remove(0);
    let (Some(constants), Some(normal)) = (by_fold.last().copied(), normal_models.last().cloned()) else {
        return Err(failed("the law")("there are no folds".to_owned()));
    };
    // The whole way from the case alone: normal data predicted, by models that saw nothing of the
    // material either.
    let predicted: Vec<CaseErrors> = samples
        .iter()
        .map(|s| {
            let fold = fold_of[s.material];
            let state = normal_models[fold].state(&s.body, s.friction, s.h0);
            law_errors(&forms, &by_fold[fold], s, &at(s, state.a, state.f_n))
        })
        .collect();
    let regions = |errors: &[CaseErrors]| {
        let first = |s: &Sample| yield_lambda(s.body.sphere.poissons_ratio);
        let rows: Vec<_> = samples.iter().zip(errors).map(|(s, e)| (s.variables.lambda, first(s), s.friction, *e)).collect();
        by_region(&rows)
    };
    Ok(Law {
        format: FORMAT.to_owned(),
        version: VERSION,
        forms,
        constants,
        normal,
        validity: validity(samples)?,
        provenance: Provenance {
            program: format!("asperity {}", env!("CARGO_PKG_VERSION")),
            study: study_name(dir),
            cases: samples.len(),
            left_out: data.skipped.iter().map(|skipped| (skipped.id.clone(), skipped.reason.clone())).collect(),
            materials,
            elements_per_contact_radius: (
                samples.iter().map(|s| s.elements_per_contact_radius).min().unwrap_or(0),
                samples.iter().map(|s| s.elements_per_contact_radius).max().unwrap_or(0),
            ),
            folds,
            seed: SEED,
            prior: prior.filter(|_| start.prior || normal_weight.is_some()).map(|law| PriorUse {
                study: law.provenance.study,
                shear: start.weight(),
                normal: normal_weight,
            }),
        },
        errors: regions(&errors),
        errors_predicted: regions(&predicted),
        candidates,
        normal_candidates,
        cases: samples.iter().zip(&errors).map(|(s, e)| fitted_case(&forms, s, e)).collect::<Result<_, _>>()?,
    })
}

/// Name of the directory, even if it was given as `.`.
pub(super) fn study_name(dir: &Path) -> String {
    let dir = dir.canonicalize().unwrap_or_else(|_| dir.to_owned());
    dir.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
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

fn fitted_case(forms: &Forms, sample: &Sample, errors: &CaseErrors) -> Result<FittedCase, LawError> {
    let own = own_fit(forms.normal_curve, sample).map_err(failed("the curves of one case"))?;
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
