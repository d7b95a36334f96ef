//! Random cases, as `cargo run --release --example random_cases` draws and runs them, here a few:
//! each gets to the end of its path and what it says is true.

#[path = "../examples/random_cases/generator.rs"]
#[expect(dead_code, reason = "other opponents are drawn by the example alone")]
mod generator;
#[path = "../examples/random_cases/measure.rs"]
mod measure;

use generator::Against;
use measure::{Measured, measure, summary};
use rayon::prelude::*;

const SEED: u64 = 7;
const COUNT: usize = 24;

#[test]
fn random_cases_end_by_themselves_and_say_what_is_true() {
    let all: Vec<Measured> =
        (0..COUNT).into_par_iter().with_max_len(1).map(|index| measure(SEED, index, 4, Against::Plane)).collect();
    println!("{}", Measured::HEAD);
    all.iter().for_each(|one| println!("{one}"));
    println!("{}", summary(&all));
    for one in &all {
        let at = format!("case {} of seed {SEED}: {one}", one.index);
        assert_eq!(one.ending, "done", "{at}");
        assert!(one.worst_friction.is_none_or(|ratio| ratio <= 1.0 + 1e-3), "more friction than there can be: {at}");
        assert!(one.held_gap.is_none_or(|gap| gap <= 1e-4), "the normal force is not held: {at}");
        assert!(one.energy_gap < 0.05, "work that is neither stored nor dissipated: {at}");
    }
    let sum = |of: fn(&Measured) -> usize| all.iter().map(of).sum::<usize>();
    assert!(100 * sum(|one| one.relaxed_steps) <= sum(|one| one.steps), "{}", summary(&all));
    // Nine in ten. Full stick sheared far in a very soft material takes more.
    let hard = all.iter().filter(|one| one.per_step() > 6.0).count();
    assert!(10 * hard <= all.len(), "{hard} hard cases: {}", summary(&all));
}
