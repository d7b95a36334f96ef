//! The mesh study of docs/accuracy.md: one case on meshes of increasing fineness, as a table.
//!
//! `cargo bench --bench mesh_study [-- CASE.toml] [-- --epr 4,6,8]`; with `--test` (as the test
//! script runs it) on the coarsest mesh alone.

use std::path::Path;

use asperity::case::Case;
use asperity::internals::compute::cpu::Cpu;
use asperity::internals::simulation::drive::{Drive, Ending};
use asperity::internals::simulation::problem::Problem;
use asperity::output::{Clock, Recorder, Summary, SummaryInputs};

type Failed = Box<dyn std::error::Error + Send + Sync>;

fn main() -> Result<(), Failed> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let quick = arguments.iter().any(|a| a == "--test");
    let meshes = arguments.iter().position(|a| a == "--epr").and_then(|i| arguments.get(i + 1));
    let meshes: Vec<usize> = match meshes {
        Some(list) => list.split(',').map(str::parse).collect::<Result<_, _>>()?,
        None if quick => vec![4],
        None => vec![4, 6, 8, 12, 16],
    };
    let default = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/cases/ideal.toml").to_owned();
    let file = arguments.iter().find(|a| a.ends_with(".toml")).unwrap_or(&default);
    println!(
        "| elements per radius | elements | unknowns | F_N(h0) | a0 | F_N slip | max F_T | F_T/F_N | delta_T slip | steps | Newton | Krylov | CPU s |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    for mesh in meshes {
        let clock = Clock::start();
        let before = clock.cpu_seconds().unwrap_or(f64::NAN);
        let case = Case::load(Path::new(file), &[format!("mesh.elements_per_contact_radius={mesh}")])?;
        let problem = Problem::new(&case)?;
        let mut backend = Cpu::<f64>::new(vec![problem.model.clone()])?;
        let newton = problem.newton()?;
        let unknowns = newton.free_unknowns();
        let mut records = Recorder::new(&case, None);
        let ending = Drive::new(&problem, &mut backend, 0, newton).run(&mut records)?;
        if ending != Ending::Done {
            eprintln!("{mesh} elements per radius: {ending:?}");
        }
        let s = Summary::from_history(&records.rows, &SummaryInputs::of(&case));
        let show = |x: Option<f64>, digits: usize| x.map_or("-".to_owned(), |x| format!("{x:.digits$}"));
        println!(
            "| {mesh} | {} | {unknowns} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {:.1} |",
            problem.model.mesh.elements.len(),
            show(s.f_n0, 2),
            show(s.a0, 4),
            show(s.f_n_slip, 2),
            show(s.f_t_max, 2),
            show(s.mu_at_slip, 4),
            show(s.delta_t_slip, 5),
            records.rows.len() - 1,
            s.newton_iterations,
            records.rows.iter().map(|r| r.krylov_iterations).sum::<usize>(),
            clock.cpu_seconds().unwrap_or(f64::NAN) - before,
        );
    }
    Ok(())
}
