//! What tests that follow a path share: every accepted step with its whole contact.

use asperity::case::Case;
use asperity::internals::compute::cpu::Cpu;
use asperity::internals::simulation::drive::{Drive, Ending, Observer, StepView};
use asperity::internals::simulation::problem::Problem;
use asperity::output::{ContactPoint, StepRecord, Units};

/// The steps of a path, in the case's units.
pub type Steps = Vec<(StepRecord, Vec<ContactPoint>)>;

struct Recorder {
    units: Units,
    taken: Steps,
}

impl Observer for Recorder {
    fn step(&mut self, view: &mut StepView<'_>) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        self.taken.push((view.record.in_units(&self.units), ContactPoint::whole_of(view.points, &self.units)));
        Ok(())
    }
    fn segment_end(&mut self, _: &mut StepView<'_>) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        Ok(())
    }
    fn note(&mut self, _: &str) {}
}

/// Follows the path of a case to its end, on the mesh that it asks for.
pub fn follow(case: &Case) -> Steps {
    follow_problem(case, &Problem::new(case).expect("a problem"))
}

/// The same for a problem that was made of the case.
pub fn follow_problem(case: &Case, problem: &Problem) -> Steps {
    let mut backend = Cpu::<f64>::new(vec![problem.model.clone()]).expect("a backend");
    let mut recorder = Recorder { units: Units::of(case), taken: Vec::new() };
    let newton = problem.newton().expect("a solver");
    let ending = Drive::new(problem, &mut backend, 0, newton).run(&mut recorder).expect("no failure of the program");
    assert_eq!(ending, Ending::Done, "{}", case.to_toml());
    recorder.taken
}
