//! A shared backend against one's own, bit by bit; rows; directories.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use super::batch::{Guest, share};
use super::directory::{EarlierStudy, StudyDirectory};
use super::file::Study;
use super::row::{Row, RowStatus, write_table};
use crate::compute::cpu::Cpu;
use crate::compute::{About, Answer, Call, CaseFields, CaseModel, Compute, ComputeError};
use crate::output::{OutputDirectory, RunStatus, Summary};
use crate::simulation::drive::{Drive, Ending, Observer, StepView};
use crate::simulation::error::ObserverError;
use crate::simulation::problem::Problem;
use crate::simulation::record::StepRecord;

const STUDY: &str = r#"
[base.sphere]
radius = 2.0
[base.material]
youngs_modulus = 200e3
poissons_ratio = 0.3
[base.material.hardening]
law = "ideal"
yield_stress = 800.0
[base.contact]
friction = 0.3
[base.mesh]
elements_per_contact_radius = 4
contact_radius = 0.2
[base.solver]
press_steps = 2
shear_steps = 2
[[base.path]]
indentation = 0.01
[[base.path]]
shear = 0.0005
[grid]
"material.hardening.yield_stress" = [400.0, 800.0]
"contact.friction" = [0.1, "stick"]
"#;

fn study() -> Study {
    Study::parse(STUDY, "study.toml").expect("a study")
}

/// Counts calls and their requests; fails from the given call for forces on.
struct Watched {
    inner: Cpu<f64>,
    calls: Arc<AtomicUsize>,
    largest: Arc<AtomicUsize>,
    fails_from: usize,
    note: Arc<Mutex<Vec<String>>>,
}

impl Compute for Watched {
    fn models(&self) -> &[CaseModel] {
        self.inner.models()
    }
    fn about(&self) -> About {
        self.inner.about()
    }
    fn call(&mut self, calls: Vec<(usize, Call)>) -> Result<Vec<Answer>, ComputeError> {
        match calls[0].1 {
            Call::Force { .. } => {
                if self.calls.fetch_add(1, Ordering::Relaxed) >= self.fails_from {
                    return Err(ComputeError::Device("lost".to_owned()));
                }
                self.largest.fetch_max(calls.len(), Ordering::Relaxed);
            }
            // It has no room for other cases.
            Call::Replace(_) => return Ok(vec![Answer::Replaced(false)]),
            _ => {}
        }
        self.inner.call(calls)
    }
    fn take_notes(&mut self) -> Vec<String> {
        std::mem::take(&mut self.note.lock().unwrap())
    }
}

fn watched(models: Vec<CaseModel>, fails_from: usize) -> (Box<Watched>, Arc<AtomicUsize>, Arc<AtomicUsize>) {
    let (calls, largest) = (Arc::new(AtomicUsize::new(0)), Arc::new(AtomicUsize::new(0)));
    let inner = Cpu::new(models).expect("a batch");
    let watched = Watched { inner, calls: calls.clone(), largest: largest.clone(), fails_from, note: Arc::default() };
    (Box::new(watched), calls, largest)
}

fn problems() -> Vec<Problem> {
    study().cases.iter().map(|case| Problem::new(&case.case).expect("a problem")).collect()
}

fn models(problems: &[Problem]) -> Vec<CaseModel> {
    problems.iter().map(|problem| problem.model.clone()).collect()
}

/// Remembers what a run shows.
#[derive(Default)]
struct Seen {
    rows: Vec<StepRecord>,
    fields: Vec<CaseFields>,
    notes: Vec<String>,
}

impl Observer for Seen {
    fn step(&mut self, view: &mut StepView<'_>) -> Result<(), ObserverError> {
        self.rows.push(view.record.0);
        Ok(())
    }
    fn segment_end(&mut self, view: &mut StepView<'_>) -> Result<(), ObserverError> {
        self.fields.push(view.fields()?);
        Ok(())
    }
    fn note(&mut self, text: &str) {
        self.notes.push(text.to_owned());
    }
}

fn follow(problem: &Problem, backend: &mut dyn Compute, slot: usize) -> (Result<Ending, String>, Seen) {
    let mut seen = Seen::default();
    let newton = problem.newton().expect("a solver");
    let ending = Drive::new(problem, backend, slot, newton).run(&mut seen).map_err(|error| error.to_string());
    (ending, seen)
}

#[test]
fn cases_that_share_a_backend_get_what_they_would_get_alone() {
    let problems = problems();
    let (backend, calls, largest) = watched(models(&problems), usize::MAX);
    let note = backend.note.clone();
    note.lock().unwrap().push("a note of the device".to_owned());
    let (host, places) = share(backend);
    let guests: Vec<Guest> = places.iter().zip(models(&problems)).map(|(place, model)| place.first(model)).collect();
    drop(places);
    let shared: Vec<_> = std::thread::scope(|scope| {
        let drives: Vec<_> =
            problems.iter().zip(guests).map(|(problem, mut guest)| scope.spawn(move || follow(problem, &mut guest, 0))).collect();
        host.serve();
        drives.into_iter().map(|drive| drive.join().expect("no panic")).collect()
    });
    let mut evaluations = 0;
    for (problem, (ending, seen)) in problems.iter().zip(&shared) {
        let (mut alone, calls, _) = watched(vec![problem.model.clone()], usize::MAX);
        let (own_ending, own) = follow(problem, alone.as_mut(), 0);
        assert_eq!((ending, &own_ending), (&Ok(Ending::Done), &Ok(Ending::Done)));
        assert_eq!(seen.rows, own.rows);
        assert_eq!(seen.fields, own.fields);
        assert_eq!(seen.notes, ["a note of the device"]);
        evaluations += calls.load(Ordering::Relaxed);
    }
    // Drives that wait together were served together.
    let (calls, largest) = (calls.load(Ordering::Relaxed), largest.load(Ordering::Relaxed));
    assert!(calls < evaluations && (2..=4).contains(&largest), "{calls} calls for {evaluations}, {largest} at once");
}

/// Takes its time for each call, and notes how many requests it had.
struct Slow {
    inner: Cpu<f64>,
    sizes: Arc<Mutex<Vec<usize>>>,
}

const CALL: Duration = Duration::from_millis(100);

impl Compute for Slow {
    fn models(&self) -> &[CaseModel] {
        self.inner.models()
    }
    fn about(&self) -> About {
        self.inner.about()
    }
    fn call(&mut self, calls: Vec<(usize, Call)>) -> Result<Vec<Answer>, ComputeError> {
        self.sizes.lock().unwrap().push(calls.len());
        std::thread::sleep(CALL);
        self.inner.call(calls)
    }
}

/// Two of four begin while the first two are served. Each asks again as soon as it has its answer,
/// so that they would take turns for ever; a call waits for them instead.
#[test]
fn cases_that_are_out_of_step_fall_into_it() {
    let problems = problems();
    let sizes = Arc::new(Mutex::new(Vec::new()));
    let backend = Slow { inner: Cpu::new(models(&problems)).expect("a batch"), sizes: sizes.clone() };
    let (host, places) = share(Box::new(backend));
    let guests: Vec<Guest> = places.iter().zip(models(&problems)).map(|(place, model)| place.first(model)).collect();
    drop(places);
    const TIMES: usize = 6;
    std::thread::scope(|scope| {
        for (i, mut guest) in guests.into_iter().enumerate() {
            scope.spawn(move || {
                std::thread::sleep(if i < 2 { Duration::ZERO } else { CALL / 2 });
                let displacement: Arc<[f64]> = vec![0.0; 3 * guest.models()[0].mesh.nodes.len()].into();
                for _ in 0..TIMES {
                    guest.call(vec![(0, Call::Force { displacement: displacement.clone() })]).expect("forces");
                }
            });
        }
        host.serve();
    });
    let sizes = sizes.lock().unwrap().clone();
    assert_eq!(sizes.iter().sum::<usize>(), 4 * TIMES, "{sizes:?}");
    // By turns it would be twice as many. Nobody waits for guests that have gone.
    assert!(sizes.len() <= TIMES + 3 && sizes.iter().filter(|&&size| size == 4).count() >= TIMES - 2, "{sizes:?}");
}

#[test]
fn a_backend_that_fails_or_goes_is_an_error_of_every_case_and_no_deadlock() {
    let problems = problems();
    let (backend, _, _) = watched(models(&problems), 3);
    let (host, places) = share(backend);
    let guests: Vec<Guest> = places.iter().zip(models(&problems)).map(|(place, model)| place.first(model)).collect();
    drop(places);
    let endings: Vec<_> = std::thread::scope(|scope| {
        let drives: Vec<_> = problems
            .iter()
            .zip(guests)
            .map(|(problem, mut guest)| scope.spawn(move || follow(problem, &mut guest, 0).0))
            .collect();
        host.serve();
        drives.into_iter().map(|drive| drive.join().expect("no panic")).collect()
    });
    for ending in endings {
        assert!(ending.unwrap_err().contains("the compute device failed: lost"));
    }
    let (host, places) = share(watched(models(&problems), 0).0);
    drop(host);
    let (ending, _) = follow(&problems[0], &mut places[0].first(problems[0].model.clone()), 0);
    assert!(ending.unwrap_err().contains("has gone"));
    assert!(places[0].next(&problems[1].model).is_err());
}

#[test]
fn a_case_that_takes_the_place_of_another_goes_as_alone() {
    let problems = problems();
    let (host, mut places) = share(Box::new(Cpu::<f64, f32>::with_tangents(vec![problems[0].model.clone()]).expect("a batch")));
    let place = places.remove(0);
    let shared: Vec<_> = std::thread::scope(|scope| {
        let drives = scope.spawn(|| {
            let place = place;
            let mut first = place.first(problems[0].model.clone());
            let mut all = vec![follow(&problems[0], &mut first, 0)];
            drop(first);
            for problem in &problems[1..] {
                let mut guest = place.next(&problem.model).expect("a host").expect("a place");
                all.push(follow(problem, &mut guest, 0));
            }
            all
        });
        host.serve();
        drives.join().expect("no panic")
    });
    for (problem, (ending, seen)) in problems.iter().zip(&shared) {
        let mut alone = Cpu::<f64, f32>::with_tangents(vec![problem.model.clone()]).expect("a batch");
        let (own_ending, own) = follow(problem, &mut alone, 0);
        assert_eq!((ending, &own_ending), (&Ok(Ending::Done), &Ok(Ending::Done)));
        assert_eq!((&seen.rows, &seen.fields), (&own.rows, &own.fields));
    }
    // What a device does not take is left to others, and so are cases of another mesh.
    let (host, places) = share(watched(models(&problems), usize::MAX).0);
    let (refused, other) = std::thread::scope(|scope| {
        let places = places;
        scope.spawn(|| host.serve());
        let coarse = STUDY.replace("elements_per_contact_radius = 4", "elements_per_contact_radius = 5");
        let coarse = Study::parse(&coarse, "study.toml").expect("a study");
        let coarse = Problem::new(&coarse.cases[0].case).expect("a problem");
        let mut cpu = Cpu::<f64>::new(vec![problems[0].model.clone()]).expect("a batch");
        let refused = places[0].next(&problems[1].model).expect("a host").is_none();
        drop(places);
        (refused, cpu.call(vec![(0, Call::Replace(Box::new(coarse.model)))]))
    });
    assert!(refused && matches!(other, Err(ComputeError::Connectivity { case: 0 })));
}

#[test]
fn a_row_is_the_summary_of_the_very_case() {
    let scratch = tempfile::tempdir().expect("a scratch directory");
    let study = study();
    let directory = StudyDirectory::new(scratch.path());
    let (mine, other) = (&study.cases[0].case, &study.cases[1].case);
    let out = OutputDirectory::create(directory.case("c0001").root()).expect("a directory");
    assert_eq!(Row::read(mine, &out), Row::pending());
    let mut summary = Summary { status: RunStatus::Done, f_n0: Some(5.0), a0: Some(0.2), h0: Some(0.01), ..Summary::default() };
    summary.messages.push("note: a note".to_owned());
    out.write_case(&mine.to_toml()).expect("a case");
    assert_eq!(Row::read(mine, &out), Row::pending());
    summary.write(&out.summary()).expect("a summary");
    assert_eq!(Row::read(mine, &out), Row { status: RowStatus::Done, reason: String::new(), summary: Some(summary.clone()) });
    assert_eq!(Row::read(other, &out), Row::pending());
    for (status, expected) in [
        (RunStatus::NotConverged, RowStatus::NotConverged),
        (RunStatus::ContactOutgrewMesh, RowStatus::Outgrown),
        (RunStatus::Interrupted, RowStatus::Pending),
        (RunStatus::Failed, RowStatus::Failed),
    ] {
        let messages = vec!["note: before".to_owned(), "why\nit ended".to_owned(), "note: after".to_owned()];
        let row = Row::of(Summary { status, messages, ..summary.clone() });
        assert_eq!((row.status, row.reason.as_str()), (expected, "why it ended"));
    }
}

#[test]
fn the_table_has_the_promised_columns_and_normalised_variables() {
    let scratch = tempfile::tempdir().expect("a scratch directory");
    let study = study();
    let directory = StudyDirectory::new(scratch.path());
    let (f_n0, a0, h0) = (430.0, 0.2, 0.01);
    let summary = Summary {
        status: RunStatus::Done,
        f_n0: Some(f_n0),
        a0: Some(a0),
        h0: Some(h0),
        newton_iterations: 12,
        ..Summary::default()
    };
    let rows: Vec<Row> = [Row::of(summary), Row::pending(), Row::pending(), Row::pending()].into();
    write_table(&directory.table(), &study, &rows).expect("a table");
    assert!(directory.holds_study());
    let mut reader = csv::Reader::from_path(directory.table()).expect("a table");
    let header: Vec<String> = reader.headers().expect("a header").iter().map(str::to_owned).collect();
    assert_eq!(header[..6], ["case", "directory", "status", "reason", "material.hardening.yield_stress", "contact.friction"]);
    assert_eq!(
        header[6..].join(","),
        "E,nu,sigma_Y,mu,R,h0,a0,F_N0,F_N_slip,F_T_max,delta_T_90,delta_T_95,delta_T_slip,k_T0,sigma_rep,Lambda,Hbar,c2,\
         F_T_max_limit,F_N0_error,F_T_max_error,elements_per_contact_radius,\
         surface_elements_per_contact_radius,newton_iterations,cutbacks,cpu_s"
    );
    let records: Vec<csv::StringRecord> = reader.records().map(|record| record.expect("a row")).collect();
    let column = |row: usize, name: &str| &records[row][header.iter().position(|column| column == name).expect("a column")];
    let number = |name: &str| column(0, name).parse::<f64>().expect("a number");
    assert_eq!(&records[0].iter().take(6).collect::<Vec<_>>().join(","), "c0001,cases/c0001,done,,400.0,0.1");
    assert_eq!([number("E"), number("sigma_Y"), number("R"), number("newton_iterations")], [200e3, 400.0, 2.0, 12.0]);
    // An ideally plastic sphere beyond first yield: sigma_rep = sigma_Y.
    let lambda = 200e3 / (1.0 - 0.09) / 400.0 * a0 / 2.0;
    assert!((number("Lambda") / lambda - 1.0).abs() < 1e-12 && number("sigma_rep") == 400.0);
    assert!((number("Hbar") / (f_n0 / (std::f64::consts::PI * a0 * a0 * 400.0)) - 1.0).abs() < 1e-12);
    assert!((number("c2") / (a0 * a0 / (4.0 * h0)) - 1.0).abs() < 1e-12);
    assert_eq!([column(0, "F_N_slip"), column(1, "mu"), column(1, "F_N0"), column(1, "status")], ["", "", "", "pending"]);
    assert_eq!([column(1, "contact.friction"), column(1, "elements_per_contact_radius")], ["stick", "4"]);
    // A count is a whole number, and every other number shows that it need not be one.
    assert_eq!([column(0, "E"), column(0, "R"), column(0, "newton_iterations")], ["200000.0", "2.0", "12"]);
}

#[test]
fn a_directory_is_kept_only_for_the_very_study_and_never_taken_from_the_user() {
    let scratch = tempfile::tempdir().expect("a scratch directory");
    let directory = StudyDirectory::new(scratch.path().join("a/b"));
    let study = study();
    std::fs::create_dir_all(directory.root()).expect("a directory");
    directory.prepare(&study, EarlierStudy::Refuse).expect("a new directory");
    directory.prepare(&study, EarlierStudy::Keep).expect("an empty directory");
    write_table(&directory.table(), &study, &vec![Row::pending(); 4]).expect("a table");
    directory.prepare(&study, EarlierStudy::Keep).expect("killed early");
    directory.write_study(&study).expect("a copy");
    let spaced = Study::parse(&format!("# the same\n{STUDY}"), "study.toml").expect("a study");
    directory.prepare(&spaced, EarlierStudy::Keep).expect("the same study");
    // Results of a case that another study does not have: it is refused, whatever it is that
    // differs.
    let first = OutputDirectory::create(directory.case("c0001").root()).expect("a directory");
    first.write_case(&study.cases[0].case.to_toml()).expect("a case");
    let friction = "\"contact.friction\" = [0.1, \"stick\"]";
    let ratio = "\"material.poissons_ratio\" = [0.1, 0.2]";
    for (from, to, difference) in [
        (
            friction,
            "\"contact.friction\" = [0.2, \"stick\"]",
            "a case of it is material.hardening.yield_stress = 400.0, contact.friction = 0.1,",
        ),
        (friction, ratio, "its grid is 4 cases"),
        ("poissons_ratio = 0.3", "poissons_ratio = 0.2", "its base gives other cases"),
    ] {
        let other = Study::parse(&STUDY.replace(from, to), "study.toml").expect("a study");
        let error = directory.prepare(&other, EarlierStudy::Keep).expect_err("another study").to_string();
        assert!(error.contains("holds another study") && error.contains("nothing was changed"), "{error}");
        assert!(error.contains(difference), "{error}");
    }
    // One that has it keeps it, under its number; who has it no more is named.
    let grown = STUDY.replace("[0.1, \"stick\"]", "[0.05, 0.1]").replace("[400.0, 800.0]", "[200.0, 400.0]");
    let grown = Study::parse(&grown, "study.toml").expect("a study");
    let second = OutputDirectory::create(directory.case("c0002").root()).expect("a directory");
    second.write_case(&study.cases[1].case.to_toml()).expect("a case");
    let placed = directory.prepare(&grown, EarlierStudy::Keep).expect("a study that has grown");
    let ids: Vec<&str> = placed.study.cases.iter().map(|case| case.id.as_str()).collect();
    assert_eq!((ids, placed.strangers, placed.begun), (vec!["c0005", "c0006", "c0003", "c0001"], vec!["c0002".to_owned()], 1));
    // A case of ours, with a file of the user's beside it, and a directory of the user's.
    let out = OutputDirectory::create(directory.case("c0003").root()).expect("a directory");
    out.write_case(&study.cases[2].case.to_toml()).expect("a case");
    std::fs::write(directory.root().join("notes.txt"), "mine").expect("a file");
    std::fs::create_dir_all(directory.case("c0004").root()).expect("a directory");
    std::fs::write(directory.case("c0004").root().join("notes.txt"), "mine").expect("a file");
    directory.prepare(&study, EarlierStudy::Replace).expect("replaced");
    assert!(!directory.holds_study() && !out.root().exists());
    assert!(directory.root().join("notes.txt").exists() && directory.case("c0004").root().join("notes.txt").exists());
    let error = directory.prepare(&study, EarlierStudy::Refuse).expect_err("not a study").to_string();
    assert!(error.contains("is not an Asperity study") && error.contains("nothing was changed"), "{error}");
    let file = StudyDirectory::new(directory.root().join("notes.txt"));
    assert!(file.prepare(&study, EarlierStudy::Keep).expect_err("a file").to_string().contains("is not a directory"));
}
