//! The phases of one Newton iteration at the default mesh, in the middle of the main job's press:
//! element forces and tangents, contact, multigrid, Krylov.
//!
//! `cargo bench --bench phases`: processor time of the whole process, whatever else the machine
//! does (time on the wall where the system does not tell). With `--test` on the coarsest mesh, each
//! once.

use std::path::Path;

use asperity::case::Case;
use asperity::internals::compute::Evaluated;
use asperity::internals::compute::cpu::Cpu;
use asperity::internals::compute::handle::CaseHandle;
use asperity::internals::linalg::{BlockMatrix, Hierarchy, LinearSolver, Pattern, SolverKind};
use asperity::internals::simulation::drive::{Drive, Observer, StepView};
use asperity::internals::simulation::problem::Problem;
use asperity::internals::solver::Control;
use asperity::internals::solver::boundary::Boundary;
use asperity::internals::solver::contact_rows::apply_contact;
use asperity::internals::solver::opponent::rigid::RigidBody;
use asperity::internals::solver::phases::PhaseTimes;
use asperity::internals::solver::system::{fixed_unknowns, right_hand_side};
use asperity::internals::solver::trial::Trial;
use criterion::{BatchSize, Criterion};
use processor::Processor;

mod processor;

type Failed = Box<dyn std::error::Error + Send + Sync>;

/// The press is cut into so many steps, of which all but the last are made: the bench's iteration
/// is on the way to the last.
const PRESS_STEPS: usize = 8;
const LINEAR_TOLERANCE: f64 = 1e-2;

/// Displacements of the last two steps, and the indentation; asks to stop one step before the press
/// ends.
#[derive(Default)]
struct Pressed {
    last: Vec<f64>,
    before: Vec<f64>,
    h: f64,
    steps: usize,
}

impl Observer for Pressed {
    fn step(&mut self, view: &mut StepView<'_>) -> Result<(), Failed> {
        self.before = std::mem::replace(&mut self.last, view.displacement()?.to_vec());
        (self.h, self.steps) = (view.record.0.h, view.record.0.step);
        Ok(())
    }

    fn segment_end(&mut self, _: &mut StepView<'_>) -> Result<(), Failed> {
        Ok(())
    }

    fn note(&mut self, text: &str) {
        eprintln!("{text}");
    }

    fn stop_requested(&self) -> bool {
        self.steps + 1 >= PRESS_STEPS
    }
}

fn main() -> Result<(), Failed> {
    let quick = std::env::args().any(|argument| argument == "--test");
    let mut criterion = Criterion::default().with_measurement(Processor).sample_size(20).configure_from_args();
    phases(&mut criterion, if quick { 4 } else { 16 })?;
    criterion.final_summary();
    Ok(())
}

fn phases(criterion: &mut Criterion<Processor>, elements_per_contact_radius: usize) -> Result<(), Failed> {
    let file = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/cases/ideal.toml"));
    let mesh_key = format!("mesh.elements_per_contact_radius={elements_per_contact_radius}");
    let case = Case::load(file, &[mesh_key, format!("solver.press_steps={PRESS_STEPS}")])?;
    let problem = Problem::new(&case)?;
    let mesh = problem.model.mesh.clone();
    let mut backend = Cpu::<f64>::new(vec![problem.model.clone()])?;
    let newton = problem.newton()?;
    let unknowns = newton.free_unknowns();
    let mut pressed = Pressed::default();
    Drive::new(&problem, &mut backend, 0, newton).run(&mut pressed)?;

    // Half of the last step again: the elements that flowed go on flowing.
    let boundary = Boundary::new(&mesh);
    let mut trial = Trial::new(&mesh);
    for ((u, last), before) in trial.u.iter_mut().zip(&pressed.last).zip(&pressed.before) {
        *u = last + 0.5 * (last - before);
    }
    let plate = boundary.plate.first().map_or(0, |&node| 3 * node as usize + 2);
    trial.h = -trial.u[plate];
    let control = Control { h: trial.h, pose: Default::default(), normal_force: None };
    let mut handle = CaseHandle { backend: &mut backend, case: 0 };
    handle.begin_step(0.0)?;
    let outcome = trial.evaluate(&mut handle, &boundary, &RigidBody::default(), &control, &mut PhaseTimes::default())?;
    let pattern = Pattern::from_elements(mesh.nodes.len(), &mesh.elements);
    let mut matrix = BlockMatrix::<f32>::zeros(pattern.clone());
    handle.tangent(&trial.u, &mut matrix.blocks)?;
    let raw = matrix.clone();
    let mut fixed = vec![false; trial.u.len()];
    fixed_unknowns(&mesh, &boundary, &trial.rows, &mut fixed);
    apply_contact(&mut matrix, &mesh, &trial.rows);
    let mut rhs = vec![0.0; trial.u.len()];
    right_hand_side(&trial, &mesh, &boundary, &mut rhs);
    if outcome != Evaluated::Valid {
        return Err(format!("the iteration to be timed cannot be evaluated: {outcome:?}").into());
    }

    let name = format!("phases, {unknowns} unknowns, {} elements, {} threads", mesh.elements.len(), rayon::current_num_threads());
    let mut group = criterion.benchmark_group(name);
    let mut force = vec![0.0; trial.u.len()];
    group.bench_function("force", |b| b.iter(|| handle.internal_force(&trial.u, &mut force)));
    let mut blocks = vec![[0.0_f32; 9]; matrix.blocks.len()];
    group.bench_function("tangent, formed and gathered", |b| b.iter(|| handle.tangent(&trial.u, &mut blocks)));
    group.bench_function("contact, residual, merit", |b| {
        b.iter(|| trial.assess(&mut handle, &boundary, &RigidBody::default(), &control, &mut PhaseTimes::default()))
    });
    group.bench_function("contact rows, right-hand side", |b| {
        b.iter_batched_ref(
            || raw.clone(),
            |matrix| {
                fixed_unknowns(&mesh, &boundary, &trial.rows, &mut fixed);
                apply_contact(matrix, &mesh, &trial.rows);
                right_hand_side(&trial, &mesh, &boundary, &mut rhs);
            },
            BatchSize::LargeInput,
        )
    });
    let mut solver = LinearSolver::new(SolverKind::Multigrid, &pattern, &mesh.hierarchy)?;
    group.bench_function("multigrid update", |b| b.iter(|| solver.update(&matrix, &fixed)));
    solver.update(&matrix, &fixed)?;
    let mut hierarchy = Hierarchy::new(&pattern, &mesh.hierarchy)?;
    hierarchy.update(&matrix, &fixed)?;
    let free: Vec<f64> = rhs.iter().zip(&fixed).map(|(b, fixed)| if *fixed { 0.0 } else { *b }).collect();
    let mut correction = vec![0.0_f32; free.len()];
    group.bench_function("V-cycle", |b| b.iter(|| hierarchy.v_cycle(&free, &mut correction)));
    let mut x = vec![0.0; rhs.len()];
    x.fill(0.0);
    let iterations = solver.solve(&rhs, LINEAR_TOLERANCE, &mut x)?.iterations;
    group.bench_function(format!("FGMRES to {LINEAR_TOLERANCE}, {iterations} iterations"), |b| {
        b.iter(|| {
            x.fill(0.0);
            solver.solve(&rhs, LINEAR_TOLERANCE, &mut x)
        })
    });
    group.finish();
    Ok(())
}
