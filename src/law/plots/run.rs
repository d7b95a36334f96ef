//! A law beside the simulation of one case.

use crate::case::Case;
use crate::contact_law::Centres;
use crate::contact_law::path::{PathPoint, drive_in_the_plane};
use crate::law::file::refuse_turns;
use crate::law::formulas::normal::NormalState;
use crate::law::formulas::predict::{NormalSource, Prediction, predict};
use crate::law::range::OutOfRange;
use crate::law::variables::Body;
use crate::law::{Axisymmetric, Law, LawError, LawFile, Parameters};
use crate::output::plots::{Picture, View, plot_law};
use crate::output::{StepRecord, Summary, SummaryInputs};

/// A law of any kind beside a run, and what of the case lies outside of the law's range.
///
/// # Errors
/// Those of [`law_beside_run`] and [`table_beside_run`].
pub fn beside_run(
    law: &LawFile,
    case: &Case,
    history: &[StepRecord],
    view: &View,
) -> Result<(Picture, Vec<OutOfRange>), LawError> {
    match law {
        LawFile::Formulas(law) => {
            law_beside_run(law, case, history, view).map(|(picture, prediction)| (picture, prediction.out_of_range))
        }
        LawFile::Table(_) | LawFile::Interpolated(_) => table_beside_run(law, case, history, view),
    }
}

/// A point of a law's path as a step of a run: a law knows one point of contact, which slips or
/// does not.
pub fn as_step(point: &PathPoint) -> StepRecord {
    let PathPoint { segment, h, delta_t, delta_t_y, f_n, f_t, f_t_y, slips, .. } = *point;
    let record = StepRecord { segment, h, delta_t, delta_t_y, f_n, f_t, f_t_y, ..StepRecord::default() };
    StepRecord { contact_points: 1, slipping_points: usize::from(slips), ..record }
}

/// The forces of a run with those of the contact update along the same places, whatever the path.
///
/// # Errors
/// The law says nothing of the case; a drawing fails.
pub fn table_beside_run(
    law: &LawFile,
    case: &Case,
    history: &[StepRecord],
    view: &View,
) -> Result<(Picture, Vec<OutOfRange>), LawError> {
    refuse_turns(case)?;
    let parameters = law.contact_parameters(case)?;
    let places: Vec<[f64; 3]> = history.iter().map(|record| [record.h, record.delta_t, record.delta_t_y]).collect();
    let (forces, _) = drive_in_the_plane(&parameters, Centres::of(case), &places, 8);
    let points = places.iter().zip(forces).map(|(place, [f_n, f_t, _])| [place[1], f_t, f_n]);
    // From where the shear begins, as the simulation is drawn.
    let pressed = places.windows(2).take_while(|pair| pair[1][1..] == pair[0][1..]).count();
    let curve: Vec<[f64; 3]> = points.skip(pressed).collect();
    let deepest = places.iter().map(|place| place[0]).fold(0.0, f64::max);
    let picture = plot_law(history, &[("law, from h and δ_T".to_owned(), curve)], view)?;
    Ok((picture, law.out_of_range(case, deepest)?))
}

/// The forces of a run with the law's: from the case alone, and given the F_N0 and a0 of the run.
/// The prediction is returned for its range.
///
/// # Errors
/// [`LawError::NotCovered`] for a case that the law says nothing about; a drawing fails.
pub fn law_beside_run(law: &Law, case: &Case, history: &[StepRecord], view: &View) -> Result<(Picture, Prediction), LawError> {
    let prediction = predict(law, case, NormalSource::Formulas)?;
    let direction = if prediction.curve.last().is_some_and(|point| point.delta_t < 0.0) { -1.0 } else { 1.0 };
    let friction = prediction.inputs.friction;
    let reached = history.iter().map(|record| record.delta_t.abs()).fold(0.0, f64::max);
    let curve = |parameters: &Parameters| -> Vec<[f64; 3]> {
        // Dense where it is steep.
        let displacements = (0..=150).map(|i| reached * (f64::from(i) / 150.0).powi(2));
        displacements
            .map(|d| {
                let (f_t, f_n) = law.forces(parameters, friction, direction * d);
                [direction * d, f_t, f_n]
            })
            .collect()
    };
    let mut laws = Vec::new();
    let summary = Summary::from_history(history, &SummaryInputs::of(case));
    if let (Some(h), Some(a), Some(f_n)) = (summary.h0, summary.a0, summary.f_n0) {
        let body = Body::from_case(case)?;
        let known = law.contact(&Axisymmetric::of(&body, friction, h, NormalState { a, f_n }));
        laws.push(("law, F_N0 and a_0 known".to_owned(), curve(&known)));
    }
    laws.push(("law from the case alone".to_owned(), curve(&prediction.parameters)));
    Ok((plot_law(history, &laws, view)?, prediction))
}
