//! Runs against a reference, and the errors that they estimate of themselves: the accuracy tables
//! of docs/accuracy.md.
//!
//! `cargo bench --bench accuracy [-- --meshes 8 --reference 16 --cases 10]`: the first so many of
//! ten cases on the given meshes, with the default steps, against the reference mesh with twice the
//! default steps. With `--test` (as the test script runs it) one case on coarse meshes.

use std::path::Path;
use std::sync::Arc;

use asperity::case::Case;
use asperity::internals::simulation::drive::Ending;
use asperity::internals::simulation::follow::{follow, on_cpu};
use asperity::internals::simulation::problem::Problem;
use asperity::internals::simulation::scout::scout;
use asperity::output::{ErrorEstimate, Limits, Recorder, StepRecord, Summary, SummaryInputs, ripple};

type Failed = Box<dyn std::error::Error + Send + Sync>;

/// Name and settings on top of `fixtures/cases/ideal.toml`: from elastic to deeply plastic, all
/// hardening laws, shallow and deep.
const CASES: [(&str, &[&str]); 10] = [
    ("ideal 400, mu 0.3, h 0.02", &[]),
    (
        "power 300 + 1000 alpha^0.4, mu 0.4, h 0.02",
        &[r#"material.hardening={law="power",yield_stress=300.0,coefficient=1000.0,exponent=0.4}"#, "contact.friction=0.4"],
    ),
    (
        "ideal 1600, mu 0.2, h 0.01",
        &["material.hardening.yield_stress=1600.0", "contact.friction=0.2", "path.0.indentation=0.01"],
    ),
    ("ideal 100, mu 0.3, h 0.02", &["material.hardening.yield_stress=100.0"]),
    (
        "linear 300 + 5000 alpha, mu 0.3, h 0.01",
        &[r#"material.hardening={law="linear",yield_stress=300.0,modulus=5000.0}"#, "path.0.indentation=0.01"],
    ),
    (
        "Hollomon 1000 eps^(1/5), mu 0.2, h 0.01",
        &[
            r#"material.hardening={law="hollomon",coefficient=1000.0,exponent=5.0}"#,
            "contact.friction=0.2",
            "path.0.indentation=0.01",
        ],
    ),
    (
        "Voce 250 to 600, mu 0.3, h 0.03",
        &[r#"material.hardening={law="voce",yield_stress=250.0,saturation_stress=600.0,rate=20.0}"#, "path.0.indentation=0.03"],
    ),
    (
        "ideal 800, mu 0.1, h 0.005",
        &["material.hardening.yield_stress=800.0", "contact.friction=0.1", "path.0.indentation=0.005"],
    ),
    ("elastic, mu 0.3, h 0.005", &[r#"material.hardening={law="elastic"}"#, "path.0.indentation=0.005"]),
    ("ideal 3200, mu 0.3, h 0.01", &["material.hardening.yield_stress=3200.0", "path.0.indentation=0.01"]),
];

/// A run's rows, without the undeformed state, and what they sum up to.
fn run(case: &Case) -> Result<(Vec<StepRecord>, Summary), Failed> {
    let mut recorder = Recorder::new(case, None);
    let followed = follow(Problem::new(case)?, None, &mut |problem| on_cpu(problem), &mut recorder)?;
    if followed.ending != Ending::Done {
        return Err(format!("{:?}", followed.ending).into());
    }
    let rows: Vec<StepRecord> = recorder.rows.into_iter().filter(|row| row.step > 0).collect();
    let summary = Summary::from_history(&rows, &SummaryInputs::of(case));
    Ok((rows, summary))
}

/// F_N at half the indentation of the press, interpolated between steps as a power of h.
fn half_way(rows: &[StepRecord], h0: f64) -> f64 {
    let h = 0.5 * h0;
    rows.windows(2)
        .find(|w| w[0].h <= h && h <= w[1].h)
        .map_or(f64::NAN, |w| w[0].f_n * (w[1].f_n / w[0].f_n).powf((h / w[0].h).ln() / (w[1].h / w[0].h).ln()))
}

fn main() -> Result<(), Failed> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let quick = arguments.iter().any(|a| a == "--test");
    let option = |name: &str| arguments.iter().position(|a| a == name).and_then(|i| arguments.get(i + 1));
    let number = |name: &str, default: usize| option(name).map_or(Ok(default), |x| x.parse());
    let meshes: Vec<usize> = match option("--meshes") {
        Some(list) => list.split(',').map(str::parse).collect::<Result<_, _>>()?,
        None => vec![if quick { 4 } else { 8 }],
    };
    let reference_mesh = number("--reference", if quick { 5 } else { 16 })?;
    let count = number("--cases", if quick { 1 } else { CASES.len() })?;
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/cases/ideal.toml");
    println!(
        "Errors in per cent against {reference_mesh} elements per radius and twice the steps; in brackets those that the run estimates.\n"
    );
    println!("| case | elements per radius | F_N(h0) | F_N(h0/2) | a0 | largest F_T | ripple of F_N(h) | Newton |");
    println!("|---|---|---|---|---|---|---|---|");
    let (mut held, mut all) = (0, 0);
    for (name, settings) in CASES.iter().take(count) {
        let load = |mesh: usize, more: &[String]| -> Result<Case, Failed> {
            let mut set: Vec<String> = settings.iter().map(|s| (*s).to_owned()).collect();
            set.push(format!("mesh.elements_per_contact_radius={mesh}"));
            set.extend_from_slice(more);
            Ok(Case::load(&file, &set)?)
        };
        let usual = Problem::new(&load(reference_mesh, &[])?)?.resolution;
        let twice =
            [("press", usual.press_steps), ("shear", usual.shear_steps)].map(|(s, n)| format!("solver.{s}_steps={}", 2 * n));
        let exact_case = load(reference_mesh, &twice)?;
        let (exact_rows, exact) = run(&exact_case)?;
        for &mesh in &meshes {
            let case = load(mesh, &[])?;
            let (rows, summary) = run(&case)?;
            let companion = scout(&case, &Arc::default())?.ok_or("the companion was stopped")?;
            let limits = Limits::new(&case, &companion, Problem::new(&case)?.spacing).ok_or("the companion failed")?;
            let estimate = ErrorEstimate::new(&rows, &[], &limits);
            let mut cell = |value: Option<f64>, exact: Option<f64>, estimated: Option<f64>| match (value, exact, estimated) {
                (Some(value), Some(exact), Some(estimated)) => {
                    all += 1;
                    held += usize::from((value - exact).abs() <= estimated);
                    format!("{:+.2} ({:.1})", 100.0 * (value / exact - 1.0), 100.0 * estimated / exact)
                }
                _ => "-".to_owned(),
            };
            let h0 = exact.h0.unwrap_or(f64::NAN);
            println!(
                "| {name} | {mesh} | {} | {:+.2} | {} | {} | {:.2} | {} |",
                cell(summary.f_n0, exact.f_n0, estimate.f_n0),
                100.0 * (half_way(&rows, h0) / half_way(&exact_rows, h0) - 1.0),
                cell(summary.a0, exact.a0, estimate.a0),
                cell(summary.f_t_max, exact.f_t_max, estimate.f_t_max),
                100.0 * ripple(&rows).unwrap_or(f64::NAN),
                summary.newton_iterations,
            );
        }
    }
    println!("\n{held} of {all} errors are within their estimates.");
    Ok(())
}
