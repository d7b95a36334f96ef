//! What a job costs: the main job by phase, and the cost of a Newton iteration against the number
//! of unknowns.
//!
//! `cargo bench --bench whole_job [-- --only job|size]`; with `--test` on coarse meshes alone.
//! Processor seconds are of the whole process, `RAYON_NUM_THREADS` sets the threads.

use std::path::Path;

use asperity::case::Case;
use asperity::internals::compute::cpu::Cpu;
use asperity::internals::simulation::drive::{Drive, Ending, Observer, StepView};
use asperity::internals::simulation::problem::Problem;
use asperity::internals::solver::phases::{Phase, PhaseTimes};
use asperity::output::{Clock, OutsideSteps, TimeByPhase};

type Failed = Box<dyn std::error::Error + Send + Sync>;

/// The cost of an iteration may grow with this power of the unknowns.
const LARGEST_EXPONENT: f64 = 1.15;
/// Elements per radius of the cost table: about 11, 20, 46, 112 and 197 thousand unknowns.
const SIZES: [usize; 5] = [8, 10, 16, 22, 29];
/// For the cost table the press is cut into so many steps, of which the first few are made.
const PRESS_STEPS: usize = 12;
const STEPS_MADE: usize = 5;

/// Counts what Newton did.
#[derive(Default)]
struct Tally {
    steps: usize,
    newton: usize,
    krylov: usize,
    times: PhaseTimes,
    stop_after: Option<usize>,
}

impl Observer for Tally {
    fn step(&mut self, view: &mut StepView<'_>) -> Result<(), Failed> {
        self.steps = view.record.0.step;
        self.newton += view.record.0.newton_iterations;
        self.krylov += view.record.0.krylov_iterations;
        self.times += view.report.times;
        Ok(())
    }

    fn segment_end(&mut self, view: &mut StepView<'_>) -> Result<(), Failed> {
        self.times += view.unfinished;
        Ok(())
    }

    fn note(&mut self, text: &str) {
        eprintln!("{text}");
    }

    fn stop_requested(&self) -> bool {
        self.stop_after.is_some_and(|steps| self.steps >= steps)
    }
}

/// A run: what it did, and what it cost on the wall and of the processor, set-up apart.
struct Run {
    unknowns: usize,
    tally: Tally,
    setup_s: f64,
    wall_s: f64,
    cpu_s: f64,
}

fn run(keys: &[String], stop_after: Option<usize>) -> Result<Run, Failed> {
    let clock = Clock::start();
    let file = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/cases/ideal.toml"));
    let problem = Problem::new(&Case::load(file, keys)?)?;
    let mut backend = Cpu::<f64>::new(vec![problem.model.clone()])?;
    let newton = problem.newton()?;
    let unknowns = newton.free_unknowns();
    let setup_s = clock.wall_seconds();
    let cpu = || clock.cpu_seconds().ok_or("this system does not tell the processor time of a process");
    let before = cpu()?;
    let mut tally = Tally { stop_after, ..Tally::default() };
    let ending = Drive::new(&problem, &mut backend, 0, newton).run(&mut tally)?;
    match ending {
        Ending::Done | Ending::Interrupted => {
            Ok(Run { unknowns, tally, setup_s, wall_s: clock.wall_seconds(), cpu_s: cpu()? - before })
        }
        other => Err(format!("{keys:?}: {other:?}").into()),
    }
}

fn main() -> Result<(), Failed> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let quick = arguments.iter().any(|a| a == "--test");
    let only = arguments.iter().position(|a| a == "--only").and_then(|i| arguments.get(i + 1)).map(String::as_str);
    println!("{} threads", rayon::current_num_threads());
    match only {
        None => {
            job(quick)?;
            size(quick)
        }
        Some("job") => job(quick),
        Some("size") => size(quick),
        Some(other) => Err(format!("--only {other}: there is job and size").into()),
    }
}

/// The main job, from first touch to full slip.
fn job(quick: bool) -> Result<(), Failed> {
    let run = run(&[format!("mesh.elements_per_contact_radius={}", if quick { 4 } else { 16 })], None)?;
    let Tally { steps, newton, krylov, times, .. } = &run.tally;
    println!("main job: {} unknowns, {steps} steps, {newton} Newton and {krylov} Krylov iterations", run.unknowns);
    let outside = OutsideSteps { setup: run.setup_s, ..OutsideSteps::default() };
    print!("{}", TimeByPhase::new(times, &outside, run.wall_s).table(run.wall_s, Some(run.cpu_s)));
    Ok(())
}

/// The cost of an iteration on meshes of 10 to 200 thousand unknowns: the first steps of the press.
fn size(quick: bool) -> Result<(), Failed> {
    let sizes = if quick { &[4, 6] } else { &SIZES[..] };
    let steps = if quick { 2 } else { STEPS_MADE };
    println!(
        "\n| elements per radius | unknowns | Newton | Krylov / Newton | CPU s / Newton | of it tangent and force | linear update | linear solve |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    let mut points = Vec::new();
    for &epr in sizes {
        let keys = [format!("mesh.elements_per_contact_radius={epr}"), format!("solver.press_steps={PRESS_STEPS}")];
        let Run { unknowns, tally, cpu_s, .. } = run(&keys, Some(steps))?;
        let (newton, total) = (tally.newton as f64, tally.times.total());
        let share = |phases: &[Phase]| 100.0 * phases.iter().map(|&phase| tally.times.seconds(phase)).sum::<f64>() / total;
        println!(
            "| {epr} | {unknowns} | {} | {:.1} | {:.4} | {:.0} % | {:.0} % | {:.0} % |",
            tally.newton,
            tally.krylov as f64 / newton,
            cpu_s / newton,
            share(&[Phase::Tangent, Phase::Force]),
            share(&[Phase::LinearUpdate]),
            share(&[Phase::LinearSolve]),
        );
        points.push(((unknowns as f64).ln(), (cpu_s / newton).ln()));
    }
    let exponent = slope(&points);
    println!("\nCPU s / Newton grows as unknowns^{exponent:.2} (at most {LARGEST_EXPONENT} is asked for)");
    if !quick && exponent > LARGEST_EXPONENT {
        return Err(format!("an iteration's cost grows as n^{exponent:.2}").into());
    }
    Ok(())
}

/// Slope of the straight line through the points, by least squares.
fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let (xx, xy) = points.iter().fold((0.0, 0.0), |(xx, xy), p| (xx + (p.0 - x) * (p.0 - x), xy + (p.0 - x) * (p.1 - y)));
    xy / xx
}
