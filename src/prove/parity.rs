//! Nine whole cases, of every hardening law and kind of friction and path, on a device and on the
//! CPU: `fixtures/studies/parity.toml`, as a study computes it.

use std::fs;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use serde::Serialize;

use super::Options;
use super::progress::ProveProgress;
use crate::bench::whole_job::ScratchFolder;
use crate::compute::select::{DeviceChoice, Devices, PrecisionChoice};
use crate::output::{StepRecord, Summary, read_history};
use crate::study::{self, Study, StudyDirectory, StudyError, StudyProgress, run_on};

const STUDY: &str = include_str!("../../fixtures/studies/parity.toml");

/// The tolerance of a study and how far forces and radii may be from the CPU's.
struct ParityBounds {
    tolerance: f64,
    in_f64: f64,
    mixed: f64,
}

/// At the default tolerance Newton may end at another iterate: the CPU's own two linear solvers are
/// up to 4.2e-4 apart there. Solved tightly, what is left is the device's.
const BOUNDS: [ParityBounds; 2] =
    [ParityBounds { tolerance: 1e-3, in_f64: 5e-4, mixed: 5e-4 }, ParityBounds { tolerance: 1e-8, in_f64: 3e-7, mixed: 1e-7 }];
/// How far the sum of Newton's iterations may be from the CPU's at the default tolerance.
const ITERATIONS: f64 = 0.05;
/// The cases that the quick run computes alone too.
const ALONE: [usize; 1] = [5];
/// Steps of a shear in the study, and in the quick run.
const SHEAR_STEPS: [usize; 2] = [8, 4];

/// A case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OfCase {
    /// Its number, from 1.
    pub case: usize,
    /// The largest difference of F_N, F_T, moments and a over the steps; forces by the largest F_N,
    /// radii by the largest, moments by both. None where the numbers of steps differ.
    pub difference: Option<f64>,
    /// Newton iterations on the device.
    pub newton_device: usize,
    /// Newton iterations on the CPU.
    pub newton_cpu: usize,
    /// Whether the same batch again has the same bits; none where it was not tried.
    pub repeated: Option<bool>,
    /// Whether the case alone has the same bits; none where it was not tried.
    pub alone: Option<bool>,
}

/// The cases in one precision at one tolerance.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParityRow {
    /// `f64`, or `mixed`: steps in f32 that the CPU holds to f64.
    pub precision: &'static str,
    /// The tolerance of Newton's method.
    pub tolerance: f64,
    /// How large a difference may be.
    pub bound: f64,
    /// The cases.
    pub cases: Vec<OfCase>,
    /// Why there are none.
    pub failed: Option<String>,
}

/// All rows.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct DeviceParity {
    /// By precision and tolerance.
    pub rows: Vec<ParityRow>,
    /// Kernels that took part.
    pub kernels: Vec<&'static str>,
}

impl ParityRow {
    fn disagreements(&self) -> Vec<String> {
        let row = format!("parity.toml, {}, tolerance {:e}", self.precision, self.tolerance);
        let mut said: Vec<String> = self.failed.iter().map(|why| format!("{row}: {why}")).collect();
        for of in &self.cases {
            let case = of.case;
            match of.difference {
                None => said.push(format!("{row}: case {case} has another number of steps than on the CPU")),
                Some(difference) if !(difference <= self.bound) => {
                    said.push(format!("{row}: case {case} is {difference:.1e} from the CPU, more than {:e}", self.bound));
                }
                Some(_) => {}
            }
            for (same, what) in [(of.repeated, "again"), (of.alone, "alone")] {
                if same == Some(false) {
                    said.push(format!("{row}: case {case} has other bits {what}"));
                }
            }
        }
        let sum = |of: fn(&OfCase) -> usize| self.cases.iter().map(of).sum::<usize>() as f64;
        let (ours, theirs) = (sum(|of| of.newton_device), sum(|of| of.newton_cpu));
        if self.tolerance == BOUNDS[0].tolerance && (ours - theirs).abs() > ITERATIONS * theirs {
            said.push(format!("{row}: {ours} Newton iterations, {theirs} on the CPU"));
        }
        said
    }
}

impl DeviceParity {
    /// A sentence for everything that disagrees.
    pub fn disagreements(&self) -> Vec<String> {
        self.rows.iter().flat_map(ParityRow::disagreements).collect()
    }
}

/// Steps, of so many one, in which another number of points may touch.
const STEPS_ELSEWHERE: usize = 10;

/// The largest difference of F_N, F_T, moments and a over the steps; forces by the largest F_N,
/// moments by that times the largest a. A point that is about to touch or to come off may do so on
/// one side alone, at a loose tolerance: a, which jumps with it, is compared in the steps in which
/// as many points touch. Infinite where those are not nine in ten, and where the numbers of steps
/// differ.
pub fn difference(ours: &[StepRecord], theirs: &[StepRecord]) -> f64 {
    type Of = fn(&StepRecord) -> f64;
    let as_many = |ours: &StepRecord, theirs: &StepRecord| ours.contact_points == theirs.contact_points;
    let elsewhere = ours.iter().zip(theirs).filter(|(ours, theirs)| !as_many(ours, theirs)).count();
    if ours.len() != theirs.len() || elsewhere * STEPS_ELSEWHERE > ours.len() {
        return f64::INFINITY;
    }
    let largest = |of: Of| theirs.iter().fold(0.0_f64, |m, row| m.max(of(row).abs()));
    let (force, radius) = (largest(|row| row.f_n), largest(|row| row.a));
    let compared: [(Of, f64); 6] = [
        (|row| row.f_n, force),
        (|row| row.f_t, force),
        (|row| row.f_t_y, force),
        (|row| row.m_twist, force * radius),
        (|row| row.m_roll_x, force * radius),
        (|row| row.m_roll_y, force * radius),
    ];
    let of_step = |(ours, theirs): (&StepRecord, &StepRecord)| {
        let of_radius = if as_many(ours, theirs) { (ours.a - theirs.a).abs() / radius } else { 0.0 };
        compared.map(|(of, scale)| (of(ours) - of(theirs)).abs() / scale).into_iter().chain([of_radius])
    };
    let differences = ours.iter().zip(theirs).flat_map(of_step);
    // A number that is none is no small one.
    differences.fold(0.0_f64, |m, found| if found.is_finite() { m.max(found) } else { f64::INFINITY })
}

/// What a case left.
struct Left {
    /// `history.csv`, byte by byte.
    text: Vec<u8>,
    history: Vec<StepRecord>,
    newton: usize,
}

/// How the cases are computed.
fn options(device: DeviceChoice, precision: PrecisionChoice, threads: usize) -> study::Options {
    study::Options { device, precision, threads, shard: None, resume: false, retry: false, force: false }
}

/// What is computed of the study.
#[derive(Clone, Copy, Debug)]
struct Of {
    /// The tolerance of Newton's method.
    tolerance: f64,
    /// With fewer steps.
    quick: bool,
    /// One case alone.
    only: Option<usize>,
}

fn text_of(Of { tolerance, quick, only }: Of) -> String {
    let steps = |of: usize| format!("shear_steps = {}\nerror_estimate", SHEAR_STEPS[of]);
    let text = STUDY.replace("[base.solver]", &format!("[base.solver]\ntolerance = {tolerance:e}"));
    let text = text.replace(&steps(0), &steps(usize::from(quick)));
    let mut parts = text.split("[[list]]");
    let base = parts.next().unwrap_or_default().to_owned();
    parts
        .enumerate()
        .filter(|(case, _)| only.is_none_or(|only| only == *case))
        .fold(base, |text, (_, part)| text + "[[list]]" + part)
}

fn computed(devices: &Devices, how: &study::Options, of: Of) -> Result<Vec<Left>, StudyError> {
    let study = Study::parse(&text_of(of), "parity.toml")?;
    let dir = ScratchFolder::new("parity");
    let watched = (Arc::new(StudyProgress::new(true)), Arc::new(AtomicBool::new(false)));
    run_on(devices, &study, dir.path(), how, watched)?;
    let left = |case: &study::StudyCase| -> Result<Left, StudyError> {
        let directory = StudyDirectory::new(dir.path()).case(&case.id);
        let path = directory.history();
        let history = read_history(&path)?;
        let text = fs::read(&path).unwrap_or_default();
        Ok(Left { text, history, newton: Summary::read(&directory.summary())?.newton_iterations })
    };
    study.cases.iter().map(left).collect()
}

/// What the quick run leaves out.
pub fn left_out(has_double: bool) -> Vec<String> {
    let alone = ALONE.map(|case| (case + 1).to_string()).join(", ");
    let [all, quick] = SHEAR_STEPS;
    let mut said = vec![
        format!("The whole cases shear in {quick} steps in place of {all}."),
        format!("They are not solved to a tolerance of {:e}, and only case {alone} is computed alone.", BOUNDS[1].tolerance),
    ];
    if has_double {
        said.push("Nor are they computed with steps in f32.".to_owned());
    }
    said
}

/// Compares the cases: at the default tolerance, and where there is time tightly, and with steps in
/// f32 as well.
pub fn compare(options: &Options, has_double: bool, progress: &mut ProveProgress) -> DeviceParity {
    let precisions: &[(&str, PrecisionChoice)] = match (has_double, options.quick) {
        (true, true) => &[("f64", PrecisionChoice::F64)],
        (true, false) => &[("f64", PrecisionChoice::F64), ("mixed", PrecisionChoice::Mixed)],
        (false, _) => &[("mixed", PrecisionChoice::Mixed)],
    };
    let mut parity = DeviceParity::default();
    for (number, bounds) in BOUNDS.iter().enumerate().take(if options.quick { 1 } else { 2 }) {
        progress.begins(&format!("nine cases on the CPU, tolerance {:e}", bounds.tolerance), 2.0);
        let on_cpu = Devices::open(DeviceChoice::Cpu).map_err(StudyError::from).and_then(|devices| {
            let how = self::options(DeviceChoice::Cpu, PrecisionChoice::Auto, options.threads);
            computed(&devices, &how, Of { tolerance: bounds.tolerance, quick: options.quick, only: None })
        });
        for &(name, precision) in precisions {
            let bound = if name == "f64" { bounds.in_f64 } else { bounds.mixed };
            let mut row = ParityRow { precision: name, tolerance: bounds.tolerance, bound, cases: Vec::new(), failed: None };
            let how = self::options(DeviceChoice::Gpu, precision, options.threads);
            let cases = match &on_cpu {
                Ok(on_cpu) => {
                    let ran = &mut parity.kernels;
                    against((on_cpu, ran), &how, bounds.tolerance, (options.quick, number == 0), progress)
                }
                Err(error) => Err(error.to_string()),
            };
            match cases {
                Ok(cases) => row.cases = cases,
                Err(why) => row.failed = Some(why),
            }
            parity.rows.push(row);
        }
    }
    parity.kernels.sort_unstable();
    parity.kernels.dedup();
    parity
}

/// The cases on the device beside those of the CPU; at the default tolerance also again and alone.
fn against(
    (on_cpu, ran): (&[Left], &mut Vec<&'static str>),
    how: &study::Options,
    tolerance: f64,
    (quick, again): (bool, bool),
    progress: &mut ProveProgress,
) -> Result<Vec<OfCase>, String> {
    // A profile tells which kernels ran.
    let devices = Devices::profiled(how.device).map_err(|error| error.to_string())?;
    let run = |only: Option<usize>| computed(&devices, how, Of { tolerance, quick, only }).map_err(|error| error.to_string());
    progress.begins(&format!("nine cases on the device, tolerance {tolerance:e}"), 6.0);
    let together = run(None)?;
    let mut cases = Vec::new();
    for (number, (ours, theirs)) in together.iter().zip(on_cpu).enumerate() {
        let difference = difference(&ours.history, &theirs.history);
        cases.push(OfCase {
            case: number + 1,
            difference: difference.is_finite().then_some(difference),
            newton_device: ours.newton,
            newton_cpu: theirs.newton,
            repeated: None,
            alone: None,
        });
    }
    if again {
        progress.begins("the same again", 6.0);
        for (of, (first, second)) in cases.iter_mut().zip(together.iter().zip(run(None)?)) {
            of.repeated = Some(first.text == second.text);
        }
        for number in (0..cases.len()).filter(|number| !quick || ALONE.contains(number)) {
            progress.begins(&format!("case {} alone", number + 1), 1.0);
            cases[number].alone = Some(run(Some(number))?.first().is_some_and(|alone| alone.text == together[number].text));
        }
    }
    ran.extend(devices.kernel_times().unwrap_or_default().kernels.iter().map(|of| of.kernel));
    Ok(cases)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_study_has_nine_cases_and_each_is_one_alone() {
        for (quick, steps) in [(false, 8), (true, 4)] {
            let of = |only| Study::parse(&text_of(Of { tolerance: 1e-3, quick, only }), "parity.toml").unwrap();
            let all = of(None);
            assert!(all.cases.len() == 9 && all.cases[1].case.solver.shear_steps == Some(steps));
            for (number, case) in all.cases.iter().enumerate() {
                let alone = of(Some(number));
                assert!(alone.cases.len() == 1 && alone.cases[0].case == case.case, "case {}", number + 1);
            }
        }
    }

    #[test]
    fn what_disagrees_is_told() {
        let case =
            OfCase { case: 3, difference: Some(1e-9), newton_device: 40, newton_cpu: 41, repeated: Some(true), alone: None };
        let row = |case: OfCase| ParityRow { precision: "f64", tolerance: 1e-3, bound: 5e-4, cases: vec![case], failed: None };
        assert_eq!(row(case.clone()).disagreements(), Vec::<String>::new());
        for (wrong, words) in [
            (OfCase { difference: Some(6e-4), ..case.clone() }, "case 3 is 6.0e-4 from the CPU"),
            (OfCase { difference: None, ..case.clone() }, "case 3 has another number of steps"),
            (OfCase { repeated: Some(false), ..case.clone() }, "case 3 has other bits again"),
            (OfCase { alone: Some(false), ..case.clone() }, "case 3 has other bits alone"),
            (OfCase { newton_device: 50, ..case.clone() }, "50 Newton iterations, 41 on the CPU"),
        ] {
            let said = row(wrong).disagreements();
            assert!(said.len() == 1 && said[0].contains(words), "{said:?}");
        }
    }
}
