//! Applies a law to a case: F_T and F_N over delta_T without any simulation of the shear.

use super::model::{Axisymmetric, Law, Parameters};
use super::normal::NormalState;
use crate::case::{Case, Friction, Hold, Segment, ShearTarget};
use crate::contact_law::path::PathPoint;
use crate::law::LawError;
use crate::law::data::ShearPoint;
use crate::law::range::{OutOfRange, clamped};
use crate::law::variables::Body;
use crate::output::Recorder;
use crate::simulation::drive::Ending;
use crate::simulation::follow::{follow, on_cpu};
use crate::simulation::problem::Problem;

/// Where F_N0 and a0 come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NormalSource {
    /// The law's own formulas in h.
    Formulas,
    /// A simulation of the press alone, on a coarse mesh.
    Press,
}

/// What a law says of a case, in the case's units.
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// The normal data that the law was given.
    pub inputs: Axisymmetric,
    /// The law of this contact.
    pub parameters: Parameters,
    /// The curve, from delta_T = 0 on; delta_T and F_T have the sign of the shear.
    pub curve: Vec<ShearPoint>,
    /// What lies outside of the law's range.
    pub out_of_range: Vec<OutOfRange>,
}

impl Prediction {
    /// The curve as points of the case's path, whose second segment it is.
    pub fn points(&self) -> Vec<PathPoint> {
        let point = |p: &ShearPoint| PathPoint {
            segment: 1,
            h: self.inputs.h,
            delta_t: p.delta_t,
            f_n: p.f_n,
            f_t: p.f_t,
            ..PathPoint::default()
        };
        self.curve.iter().map(point).collect()
    }
}

/// Intervals of a curve up to full slip, finer where it is steep.
const INTERVALS: usize = 100;
/// Elements along the contact radius of a press.
const PRESS_ELEMENTS: usize = 8;

/// The law of a case that presses once and shears once at constant h.
///
/// # Errors
/// [`LawError::NotCovered`] for another path, another hold or full stick; what goes wrong in a
/// press.
pub fn predict(law: &Law, case: &Case, source: NormalSource) -> Result<Prediction, LawError> {
    let (indentation, target, friction) = covered(case)?;
    let body = Body::from_case(case)?;
    let normal = match source {
        NormalSource::Formulas => law.normal.state(&body, friction, indentation),
        NormalSource::Press => press(case)?,
    };
    let inputs = Axisymmetric::of(&body, friction, indentation, normal);
    let parameters = law.contact(&inputs);
    let slip = parameters.delta_t_end;
    let (end, direction) = match target {
        ShearTarget::FullSlip => (slip, 1.0),
        ShearTarget::Displacement(d) => (d.abs(), d.signum()),
    };
    let curve = displacements(slip, end)
        .into_iter()
        .map(|d| {
            let (f_t, f_n) = law.forces(&parameters, friction, direction * d);
            ShearPoint { delta_t: direction * d, f_t, f_n }
        })
        .collect();
    let out_of_range = law.body_out_of_range(&body, &inputs);
    Ok(Prediction { inputs, parameters, curve, out_of_range })
}

/// Refuses a case with an opponent: formulas are of a sphere on a rigid plane.
///
/// # Errors
/// [`LawError::NotCovered`].
pub fn over_a_plane(case: &Case) -> Result<(), LawError> {
    clamped(case)?;
    match case.opponent {
        None => Ok(()),
        Some(_) => Err(LawError::NotCovered {
            problem: "the case has an [opponent], and a law of formulas is of a sphere on a rigid plane",
            remedy: "Take the built-in law, whose name is `built-in`, or tabulate the case with `asperity law tabulate`",
        }),
    }
}

/// Indentation, target of the shear and mu of a case of the kind that the law describes.
fn covered(case: &Case) -> Result<(f64, ShearTarget, f64), LawError> {
    let refuse = |problem, remedy| Err(LawError::NotCovered { problem, remedy });
    over_a_plane(case)?;
    let Friction::Coefficient(friction) = case.contact.friction else {
        return refuse(
            "the case has friction = \"stick\", and the law describes slip",
            "Give contact.friction a number, or simulate the case with `asperity run`",
        );
    };
    match case.path.as_slice() {
        [Segment::Indentation { indentation }, Segment::Shear { shear, hold: Hold::Indentation }] => {
            Ok((*indentation, *shear, friction))
        }
        [Segment::Indentation { .. }, Segment::Shear { hold: Hold::NormalForce, .. }] => refuse(
            "the case holds the normal force, and the law describes a shear at constant indentation",
            "set hold = \"indentation\", or simulate the case with `asperity run`",
        ),
        [Segment::Indentation { .. }, Segment::Shear { .. }, ..] => refuse(
            "the case goes on after its first shear, and the law's closed form describes one shear",
            "leave one [[path]] with an indentation and one with a shear; `asperity law export` has the law for any path",
        ),
        path if !path.iter().any(|segment| matches!(segment, Segment::Shear { .. })) => {
            refuse("the case has no shear", "add a [[path]] with shear = \"full-slip\"")
        }
        _ => refuse(
            "the case presses more than once before its shear, and the law describes a sphere that was only pressed",
            "leave one [[path]] with an indentation and one with a shear",
        ),
    }
}

/// Displacements from 0 to `end`, growing as i^2 up to `slip`; beyond it nothing changes.
fn displacements(slip: f64, end: f64) -> Vec<f64> {
    let to = slip.min(end);
    let mut all = vec![0.0];
    if to > 0.0 {
        all.extend((1..INTERVALS).map(|i| to * (i as f64 / INTERVALS as f64).powi(2)));
        all.push(to);
    }
    if end > to {
        all.push(end);
    }
    all
}

/// Simulates the press alone.
fn press(case: &Case) -> Result<NormalState, LawError> {
    let mut case = case.clone();
    case.path.truncate(1);
    case.mesh = case.mesh.uniform(case.mesh.elements_per_contact_radius.min(PRESS_ELEMENTS));
    let mut recorder = Recorder::new(&case, None);
    match follow(Problem::new(&case)?, None, &mut |problem| on_cpu(problem), &mut recorder)?.ending {
        Ending::Done => {}
        Ending::NotConverged(reason) => return Err(LawError::Press(reason)),
        Ending::Outgrown(outgrowth) => return Err(LawError::Press(outgrowth.to_string())),
        Ending::Interrupted => return Err(LawError::Press("it was interrupted".to_owned())),
    }
    let last = recorder.rows.last().copied().unwrap_or_default();
    Ok(NormalState { a: last.a, f_n: last.f_n })
}
