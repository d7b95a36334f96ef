//! A study in one's own program: friction and yield stress varied, a case a core: `cargo
//! run --release --example parallel_study`.
//!
//! `asperity::study` does this for a study file, with a directory and a row of a table for each
//! case; here the results stay in memory.

use asperity::case::{Friction, Hardening};
use asperity::{Case, Options, Simulation};
use rayon::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut base = Case::load("fixtures/cases/ideal.toml".as_ref(), &[])?;
    base.mesh = base.mesh.uniform(4);
    base.solver.error_estimate = false;
    let mut cases = Vec::new();
    for yield_stress in [200.0, 800.0] {
        for friction in [0.1, 0.3] {
            let mut case = base.clone();
            case.material.hardening = Hardening::Ideal { yield_stress };
            case.contact.friction = Friction::Coefficient(friction);
            cases.push((yield_stress, friction, case));
        }
    }
    // A pool of one thread for each, so that a case is not split up among the cores that the others
    // use.
    let options = Options { threads: std::num::NonZeroUsize::new(1), ..Options::default() };
    let outcomes: Vec<_> = cases
        .par_iter()
        .map(|(yield_stress, friction, case)| {
            let outcome = Simulation::with(case, options.clone()).and_then(|mut simulation| simulation.run());
            (yield_stress, friction, outcome)
        })
        .collect();
    println!("sigma_Y   mu      F_N0   F_N_slip/F_N0");
    for (yield_stress, friction, outcome) in outcomes {
        let summary = outcome?.summary;
        if let (Some(before), Some(slip)) = (summary.f_n0, summary.f_n_slip) {
            println!("{yield_stress:7} {friction:4} {before:9.2}   {:13.3}", slip / before);
        }
    }
    Ok(())
}
