//! The rows of a case that is followed in this process, to its end.

use asperity::case::Case;
use asperity::internals::simulation::drive::Ending;
use asperity::internals::simulation::follow::{follow, on_cpu};
use asperity::internals::simulation::problem::Problem;
use asperity::output::{Recorder, StepRecord};

pub fn rows(text: &str, settings: &[&str]) -> Vec<StepRecord> {
    let settings: Vec<String> = settings.iter().map(|set| (*set).to_owned()).collect();
    let case = Case::parse(text, "case.toml", &settings).unwrap_or_else(|error| panic!("{error}"));
    let mut recorder = Recorder::new(&case, None);
    let followed = follow(Problem::new(&case).expect("a problem"), None, &mut |problem| on_cpu(problem), &mut recorder);
    assert_eq!(followed.expect("no failure of the program").ending, Ending::Done, "{text}");
    recorder.rows
}
