//! One case from its file to its curve: `cargo run --release --example run [CASE.toml] [DIR]`.
//!
//! Without a directory nothing is written; with one the results lie there as `asperity run` leaves
//! them, and Ctrl-C would lose the last seconds only, as `Earlier::Resume` goes on from the last
//! checkpoint.

use std::path::{Path, PathBuf};

use asperity::{Case, Earlier, Options, Simulation};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let file = arguments.next().unwrap_or_else(|| "fixtures/cases/ideal.toml".to_owned());
    let out = arguments.next().map(PathBuf::from);
    // Coarse, so that it takes a second.
    let mut case = Case::load(Path::new(&file), &[])?;
    case.mesh = case.mesh.uniform(5);

    let mut simulation = Simulation::with(&case, Options { out, earlier: Earlier::Resume, ..Options::default() })?;
    println!("step       h   delta_T      F_N      F_T");
    for row in simulation.steps() {
        let row = row?;
        println!("{:4} {:.5}   {:.5} {:8.3} {:8.3}", row.step, row.h, row.delta_t, row.f_n, row.f_t);
    }
    let outcome = simulation.run()?;
    match &outcome.message {
        None => print!("{}", outcome.summary.report()),
        Some(reason) => println!("{}: {reason}", outcome.status),
    }
    Ok(())
}
