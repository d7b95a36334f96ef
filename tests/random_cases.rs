//! Random cases, as `cargo run --release --example random_cases` draws and runs them, here a few of
//! every opponent: each gets to the end of its path and what it says is true.

#[path = "../examples/random_cases/generator.rs"]
mod generator;
#[path = "../examples/random_cases/measure.rs"]
mod measure;

use generator::{Against, Elements, ranges};
use measure::{Measured, measure, summary};
use rayon::prelude::*;

const SEED: u64 = 7;
const COUNT: usize = 40;
/// Half of the cases have a surface that is finer than the inside.
fn mesh(index: usize) -> Elements {
    Elements { inside: 4, at_surface: if (index / 8).is_multiple_of(2) { 4 } else { 8 } }
}

#[test]
fn random_cases_end_by_themselves_and_say_what_is_true() {
    let all: Vec<Measured> =
        (0..COUNT).into_par_iter().with_max_len(1).map(|index| measure(SEED, index, mesh(index), Against::of(index))).collect();
    println!("{}\n{}", ranges(), Measured::HEAD);
    all.iter().for_each(|one| println!("{one}"));
    println!("{}", summary(&all));
    for one in &all {
        assert_eq!(one.ending, "done", "case {} of seed {SEED}: {one}", one.index);
        assert_eq!(one.wrong(), None, "case {} of seed {SEED}: {one}", one.index);
    }
    let sum = |of: fn(&Measured) -> usize| all.iter().map(of).sum::<usize>();
    assert!(100 * sum(|one| one.relaxed_steps) <= sum(|one| one.steps), "{}", summary(&all));
    // Nine in ten. Full stick sheared far in a very soft material takes more.
    let hard = all.iter().filter(|one| one.per_step() > 6.0).count();
    assert!(10 * hard <= all.len(), "{hard} hard cases: {}", summary(&all));
}
