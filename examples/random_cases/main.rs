//! Random cases over everything that a case file can say: does each end by itself, at what cost,
//! and is what it says true?
//!
//! ```text
//! cargo run --release --example random_cases -- --seed 1 --count 100 --elements 5
//! cargo run --release --example random_cases -- --seed 1 --only 17 > case.toml    # one of them, as a case file
//! ```
//! Each case is run as `asperity run` would: a scout first, then the case on a mesh that is large
//! enough. Prints what is drawn from where to where, a row a case and a summary; exit code 1 if a
//! case did not get to the end of its path, or said what cannot be true.

mod generator;
mod measure;

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::{AtomicUsize, Ordering};

use clap::Parser;
use rayon::prelude::*;

use generator::{Against, Elements, case_text, ranges};
use measure::{Measured, measure, summary};

#[derive(Parser)]
struct Args {
    /// Which cases: those of a seed are always the same.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// How many.
    #[arg(long, default_value_t = 24)]
    count: usize,
    /// Elements along the contact radius.
    #[arg(long, default_value_t = 5)]
    elements: usize,
    /// The same at the surface: once, twice, four or eight times as many; by default as many.
    #[arg(long)]
    surface: Option<usize>,
    /// Against a plane alone, instead of against all opponents in turn.
    #[arg(long)]
    plane: bool,
    /// Between two equal spheres alone.
    #[arg(long, conflicts_with = "plane")]
    equal: bool,
    /// Against a rigid sphere alone, every second body a flat.
    #[arg(long, conflicts_with_all = ["plane", "equal"])]
    rigid: bool,
    /// Against another body that deforms alone, some of them flats.
    #[arg(long, conflicts_with_all = ["plane", "equal", "rigid"])]
    unlike: bool,
    /// Write the measured numbers to this file, as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Print the case file of one of them, by its number, and run nothing.
    #[arg(long)]
    only: Option<usize>,
    /// Side by side; by default as many as there are cores.
    #[arg(long, default_value_t = 0)]
    threads: usize,
}

fn main() -> Result<ExitCode, Box<dyn std::error::Error>> {
    let args = Args::parse();
    let against = |index: usize| match (args.plane, args.equal, args.rigid, args.unlike) {
        (true, ..) => Against::Plane,
        (_, true, ..) => Against::Equal,
        (_, _, true, _) => Against::Rigid,
        (.., true) => Against::Unlike,
        _ => Against::of(index),
    };
    let elements = Elements { inside: args.elements, at_surface: args.surface.unwrap_or(args.elements) };
    if let Some(index) = args.only {
        print!("{}", case_text(args.seed, index, elements, against(index)));
        return Ok(ExitCode::SUCCESS);
    }
    rayon::ThreadPoolBuilder::new().num_threads(args.threads).build_global()?;
    println!("{}\n{}", ranges(), Measured::HEAD);
    let ready = AtomicUsize::new(0);
    // Side by side: what a case gives does not depend on the others.
    let all: Vec<Measured> = (0..args.count)
        .into_par_iter()
        .with_max_len(1)
        .map(|index| {
            let measured = measure(args.seed, index, elements, against(index));
            println!("{measured}");
            ready.fetch_add(1, Ordering::Relaxed);
            measured
        })
        .collect();
    println!("\n{}", summary(&all));
    if let Some(path) = &args.json {
        std::fs::write(path, serde_json::to_string_pretty(&all)?)?;
    }
    Ok(if all.iter().all(|one| one.ending == "done" && one.wrong().is_none()) { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
