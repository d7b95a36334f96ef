//! From a study to a law by interpolation, with its errors on materials that were left out.

use std::path::Path;

use rayon::prelude::*;

use super::components::{COMPONENTS, Components, CurveValues};
use super::inputs::{self, INPUTS, inputs};
use super::model::{self, FORMAT, Input, Interpolated, NormalErrors, Source, VERSION, bodies, keeps_its_force};
use super::outputs::{self, NUMBERS, Outputs, outputs};
use super::process::{InputPoint, Process};
use crate::analytical::ElasticSphere;
use crate::case::{Case, Friction, Hold, Material, Opponent, Segment};
use crate::contact_law::{Frame, POINTS};
use crate::law::LawError;
use crate::law::data::{is_known, study_name};
use crate::law::range::Interval;
use crate::law::report::{CaseErrors, by_region};
use crate::law::study_table::StudyTable;
use crate::law::table::{Against, Level, Measured};
use crate::law::variables::yield_lambda;
use crate::output::{OutputDirectory, read_history};

/// Fewest cases: four for each input.
pub const FEWEST_CASES: usize = 4 * INPUTS;
/// Fewest different materials among them.
pub const FEWEST_MATERIALS: usize = 8;
/// Most samples whose likelihood decides on lengths and variances; of more, every second, third,
/// ... material is asked. All of them carry the law.
const TUNED: usize = 500;

/// One contact of the study.
struct FittedContact {
    material: usize,
    sphere: ElasticSphere,
    friction: f64,
    keeps: bool,
    lambda: [f64; 2],
    inputs: [f64; INPUTS],
    measured: Measured,
    outputs: Outputs,
    elements: usize,
    is_raw: bool,
}

/// What of a study can be used, and what not.
struct Data {
    body: Option<Against>,
    samples: Vec<FittedContact>,
    materials: Vec<Material>,
    left_out: Vec<(String, String)>,
}

/// Makes the law of the study in `dir`. A case counts if it was pressed and then sheared to full
/// slip at constant h, with friction, on a rigid plane or an equal sphere; a shear back and a
/// release after it give the stiffness and the sharpness of a reversal and of an unloading.
///
/// # Errors
/// No study there, results that cannot be read, cases on a plane and on equal spheres together,
/// too few cases, values that no process can be made of.
pub fn fit(dir: &Path, reversal: Option<&Interpolated>) -> Result<Interpolated, LawError> {
    let Data { body, samples, materials, left_out } = read(dir, reversal)?;
    let Some(body) = body.filter(|_| samples.len() >= FEWEST_CASES && materials.len() >= FEWEST_MATERIALS) else {
        return Err(LawError::TooFewCases {
            path: dir.to_owned(),
            cases: samples.len(),
            materials: materials.len(),
            needed_cases: FEWEST_CASES,
            needed_materials: FEWEST_MATERIALS,
            skipped: left_out.first().map_or_else(String::new, |(id, reason)| format!("{id} is left out: {reason}. ")),
        });
    };
    let spread = spread(&samples);
    let places: Vec<InputPoint> =
        samples.iter().map(|s| std::array::from_fn(|i| (s.inputs[i] - spread[i].mean) / spread[i].deviation)).collect();
    let curves = |of: fn(&Outputs) -> CurveValues| Components::of(&samples.iter().map(|s| of(&s.outputs)).collect::<Vec<_>>());
    let ((ratio, of_ratio), (normal, of_normal)) = (curves(|o| o.ratio), curves(|o| o.normal));
    let mut columns: Vec<(String, Vec<f64>)> =
        (0..NUMBERS).map(|i| (outputs::NAMES[i].to_owned(), samples.iter().map(|s| s.outputs.numbers[i]).collect())).collect();
    for (name, scores) in [("F_T/F_N", of_ratio), ("F_N", of_normal)] {
        columns.extend((0..COMPONENTS).map(|k| (format!("{name} {}", k + 1), scores.iter().map(|s| s[k]).collect())));
    }
    let groups: Vec<usize> = samples.iter().map(|s| s.material).collect();
    let every = samples.len().div_ceil(TUNED);
    let tuned: Vec<usize> = (0..samples.len()).filter(|&i| groups[i].is_multiple_of(every)).collect();
    let fitted: Vec<(Process, Vec<f64>)> = columns
        .into_par_iter()
        .map(|(name, values)| {
            Process::fit(name, &places, &values, &groups, &tuned)
                .ok_or(LawError::Fit { what: "a Gaussian process", problem: "its covariance has no factors".to_owned() })
        })
        .collect::<Result<_, _>>()?;
    let (processes, unseen): (Vec<Process>, Vec<Vec<f64>>) = fitted.into_iter().unzip();
    let mut law = Interpolated {
        format: FORMAT.to_owned(),
        version: VERSION,
        body,
        frame: (body == Against::EqualSphere).then_some(Frame::LineOfCentres),
        source: Source {
            program: format!("asperity {}", env!("CARGO_PKG_VERSION")),
            study: study_name(dir),
            cases: samples.len(),
            materials: materials.len(),
            reversal: reversal.map(|law| law.source.study.clone()),
            left_out,
            raw: samples.iter().filter(|s| s.is_raw).count(),
            elements_per_contact_radius: samples.iter().map(|s| s.elements).max().unwrap_or(0),
        },
        errors: Vec::new(),
        normal_errors: NormalErrors::default(),
        inputs: spread,
        ratio,
        normal,
        processes,
        samples: places,
        yielding: None,
        pair: None,
    };
    let levels: Vec<Level> = samples
        .iter()
        .enumerate()
        .map(|(i, s)| {
            let values: Vec<f64> = unseen.iter().map(|column| column[i]).collect();
            law.outputs_of(&values).level(&s.sphere, s.friction, s.measured.h, s.keeps)
        })
        .collect();
    let rows: Vec<(f64, f64, f64, CaseErrors)> =
        samples.iter().zip(&levels).map(|(s, level)| (s.lambda[0], s.lambda[1], s.friction, errors(s, level))).collect();
    law.errors = by_region(&rows);
    law.normal_errors = NormalErrors {
        f_n0: both(samples.iter().zip(&levels).map(|(s, level)| level.f_n0 / s.measured.f_n0 - 1.0)),
        a0: both(samples.iter().zip(&levels).map(|(s, level)| level.a0 / s.measured.a0 - 1.0)),
    };
    Ok(law)
}

/// rms and greatest of some errors.
pub(super) fn both(errors: impl Iterator<Item = f64>) -> [f64; 2] {
    let (mut squares, mut greatest, mut count) = (0.0, 0.0f64, 0usize);
    for error in errors {
        squares += error * error;
        greatest = greatest.max(error.abs());
        count += 1;
    }
    [(squares / count.max(1) as f64).sqrt(), greatest]
}

/// Mean, deviation and range of each input. An input that never changes counts for nothing.
fn spread(samples: &[FittedContact]) -> Vec<Input> {
    let n = samples.len() as f64;
    (0..INPUTS)
        .map(|i| {
            let values = || samples.iter().map(|s| s.inputs[i]);
            let mean = values().sum::<f64>() / n;
            let deviation = (values().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt();
            Input {
                name: inputs::NAMES[i].to_owned(),
                mean,
                deviation: if deviation > 1e-9 { deviation } else { 1.0 },
                range: Interval::of(values()).unwrap_or(Interval { from: 0.0, to: 0.0 }),
            }
        })
        .collect()
}

/// Errors of F_T over its peak and of F_N over F_N0 along the shear of a sample.
fn errors(sample: &FittedContact, level: &Level) -> CaseErrors {
    let one = &sample.measured;
    let (mut squares, mut greatest) = ([0.0; 2], [0.0f64; 2]);
    for point in &one.curve {
        let x = (point.delta_t / level.delta_t_end).min(1.0);
        let [f_t, lost] = [&level.tangential, &level.normal].map(|shape| straight(shape, x));
        let f_t = sample.friction * level.slip_share * level.f_n0 * f_t;
        let f_n = level.f_n0 * (1.0 - (1.0 - level.slip_share) * lost);
        for (i, error) in [(f_t - point.f_t) / one.peak(), (f_n - point.f_n) / one.f_n0].into_iter().enumerate() {
            squares[i] += error * error;
            greatest[i] = greatest[i].max(error.abs());
        }
    }
    let [t, n] = squares.map(|sum| (sum / one.curve.len() as f64).sqrt());
    [t, greatest[0], n, greatest[1]]
}

/// A shape between its points, x = (j/24)^2, as the contact update reads it.
fn straight(shape: &[f64], x: f64) -> f64 {
    let place = |j: usize| (j as f64 / POINTS as f64).powi(2);
    let j = ((POINTS as f64 * x.sqrt()) as usize).min(POINTS - 1);
    let below = if j == 0 { 0.0 } else { shape[j - 1] };
    below + (shape[j] - below) * (x - place(j)) / (place(j + 1) - place(j))
}

fn read(dir: &Path, reversal: Option<&Interpolated>) -> Result<Data, LawError> {
    let mut data = Data { body: None, samples: Vec::new(), materials: Vec::new(), left_out: Vec::new() };
    for row in StudyTable::read(&dir.join("study.csv"))?.rows {
        if !row.is_done() {
            data.left_out.push((row.id, row.status));
            continue;
        }
        let directory = OutputDirectory::existing(dir.join(&row.directory));
        let case = directory.load_case()?;
        if let Some(reason) = unusable(&case) {
            data.left_out.push((row.id, reason.to_owned()));
            continue;
        }
        let body = Against::of(&case);
        if *data.body.get_or_insert(body) != body {
            return Err(LawError::Fit {
                what: "a study on a plane and on equal spheres together",
                problem: format!("{} is on {body}", row.id),
            });
        }
        match sample(&case, &directory, reversal, &mut data.materials)? {
            Some(sample) => data.samples.push(sample),
            None => data.left_out.push((row.id, "without full slip".to_owned())),
        }
    }
    Ok(data)
}

/// Why a case says nothing to this law, as the end of "left out: ...".
fn unusable(case: &Case) -> Option<&'static str> {
    if !matches!(case.opponent, None | Some(Opponent::Equal)) || case.sphere.flat {
        return Some("neither on a plane nor on an equal sphere");
    }
    if !case.sphere.equator.is_clamped() {
        return Some("with a free equator");
    }
    match case.contact.friction {
        Friction::Coefficient(mu) if mu > 0.0 => {}
        Friction::Coefficient(_) => return Some("without friction"),
        Friction::Stick => return Some("with full stick"),
    }
    match case.path.as_slice() {
        [Segment::Indentation { .. }, Segment::Shear { hold: Hold::Indentation, .. }, ..] => None,
        _ => Some("not pressed once and then sheared at constant h"),
    }
}

/// The number of a material among those that are known, which it joins.
pub(super) fn material_number(materials: &mut Vec<Material>, own: Material) -> usize {
    materials.iter().position(|known| *known == own).unwrap_or_else(|| {
        materials.push(own);
        materials.len() - 1
    })
}

fn sample(
    case: &Case,
    directory: &OutputDirectory,
    reversal: Option<&Interpolated>,
    materials: &mut Vec<Material>,
) -> Result<Option<FittedContact>, LawError> {
    let friction = model::friction(case);
    let history = read_history(&directory.history())?;
    let Some(measured) = Measured::of(case, &history) else { return Ok(None) };
    let (body, sphere) = bodies(case)?;
    let Some(mut outputs) = outputs(&sphere, friction, &measured, Against::of(case)) else { return Ok(None) };
    let inputs = inputs(&body, &sphere, friction, measured.h);
    if let Some(other) = reversal.map(|law| law.outputs(&inputs)) {
        if measured.back.is_empty() {
            outputs.reverse_as(&other);
        }
        if measured.release.len() < 2 {
            outputs.unload_as(&other);
        }
    }
    let own = case.scaled().0.material;
    let material = material_number(materials, own);
    Ok(Some(FittedContact {
        material,
        sphere,
        friction,
        keeps: keeps_its_force(&body, Against::of(case)),
        lambda: [body.lambda(measured.a0), yield_lambda(body.sphere.poissons_ratio)],
        inputs,
        measured,
        outputs,
        elements: case.mesh.elements_per_contact_radius,
        is_raw: !is_known(&history, 1),
    }))
}
