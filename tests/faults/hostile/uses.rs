//! What a file that was taken is for: a law is followed and exported, a history drawn, a run
//! resumed. Faults of what was read show there.

use asperity::case::{Case, Segment, ShearTarget};
use asperity::contact_law::{ContactParameters, ContactState};
use asperity::law::LawFile;
use asperity::law::data::StudyData;
use asperity::law::export::{Language, law_files, law_source};
use asperity::law::plots::{law_beside_run, study_pictures, table_beside_run};
use asperity::law::table::compose;
use asperity::output::plots::{PlotInputs, Sheet, SlipPanel, Tables, View, run_pictures};
use asperity::output::{ContactPoint, StepRecord, Summary, SummaryInputs};

/// Some contacts of any depth and any displacement. Those that a contact can have get numbers; the
/// others no panic.
fn update(parameters: &ContactParameters) {
    let radius = parameters.first_loading().radius;
    let mut state = ContactState::default();
    let mut go = |h: f64, delta: f64| {
        let (next, response) = parameters.update(&state, h * radius, [delta * radius, 0.3 * delta * radius]);
        state = next;
        (response, parameters.stored_energy(&state))
    };
    for (h, delta) in [
        (0.0, 0.0),
        (1e-12, 1e-12),
        (1e-4, 0.0),
        (1e-3, 1e-5),
        (0.01, 1e-3),
        (0.008, -1e-3),
        (0.02, 0.02),
        (0.02, -0.1),
        (0.3, 0.0),
        (0.1, 0.01),
        (-0.1, 0.01),
        (0.01, 1e-3),
    ] {
        let (response, energy) = go(h, delta);
        let forces = [response.f_n, response.f_t[0], response.f_t[1], response.a, energy];
        assert!(forces.iter().all(|x| x.is_finite()), "h/R {h}, delta_T/R {delta}: {response:?}, energy {energy}");
    }
    for (h, delta) in [(10.0, 1.0), (1e300, 1e300), (-1e300, 0.0), (0.01, 1e-3), (f64::NAN, 0.0), (0.01, f64::INFINITY)] {
        go(h, delta);
    }
}

/// Everything that a law is used for, with one case. What it refuses is refused with an error.
fn use_with(law: &LawFile, case: &Case) {
    if let Ok(parameters) = law.contact_parameters(case) {
        update(&parameters);
    }
    if let Ok((points, _)) = law.follow(case) {
        let wrong = points.iter().find(|point| !(point.f_n.is_finite() && point.f_t.is_finite()));
        assert!(wrong.is_none(), "{wrong:?}");
    }
    for h in [1e-9, 0.01, 0.3] {
        drop(law.out_of_range(case, h * case.sphere.radius));
    }
}

/// A law, with cases on a plane and between spheres; `whole` exports all files too, and puts tables
/// in series, which takes longer than the rest.
pub fn law(law: &LawFile, cases: &[Case], whole: bool) {
    let mut cases = cases.to_vec();
    if let LawFile::Table(table) = law {
        let mut own = table.deepest_case().expect("its case was checked");
        own.path.push(Segment::Shear { shear: ShearTarget::FullSlip, hold: asperity::case::Hold::Indentation });
        for case in cases.iter().filter(|_| whole) {
            drop(compose(case, [table, table]));
        }
        cases = vec![own];
    }
    for case in &cases {
        use_with(law, case);
        for language in [Language::C, Language::Python] {
            drop(law_source(law, language, Some(case)));
            if whole {
                drop(law_files(law, language, Some(case)));
            }
        }
    }
    if let LawFile::Formulas(formulas) = law {
        drop(law_source(law, Language::C, None));
        let _ = formulas.formulas();
        let nothing = StudyData { samples: Vec::new(), skipped: Vec::new() };
        drop(study_pictures(&[], &nothing, Some(formulas), Sheet::default()));
    }
}

/// A history, drawn and summed up, by itself and beside laws.
pub fn history(rows: &[StepRecord], case: &Case, laws: &[LawFile]) {
    let _ = Summary::from_history(rows, &SummaryInputs::of(case));
    let view = View::of(case);
    drop(run_pictures(rows, &Tables::default(), &PlotInputs::of(case), &view));
    for law in laws {
        match law {
            LawFile::Formulas(law) => drop(law_beside_run(law, case, rows, &view)),
            law => drop(table_beside_run(law, case, rows, &view)),
        }
    }
}

/// A contact table, drawn as that of the press, of a shear and of the end.
pub fn contact(points: Vec<ContactPoint>, history: &[StepRecord], case: &Case) {
    let last = *history.last().expect("a row");
    let panel = SlipPanel { step: last.step, delta_t: last.delta_t, ratio: Some(0.2), points: points.clone() };
    let tables = Tables { pressed: Some((last, points.clone())), shear: vec![panel.clone(), panel], last: points };
    drop(run_pictures(history, &tables, &PlotInputs::of(case), &View::of(case)));
}
