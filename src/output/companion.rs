//! The coarser run from which the error of a run is estimated.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::{Recorder, StepRecord, companion_elements};
use crate::case::Case;
use crate::compute::cpu::Cpu;
use crate::simulation::SimulationError;
use crate::simulation::drive::{Drive, Ending};
use crate::simulation::problem::{Problem, press_steps, shear_steps};

/// The case on its companion's mesh, with steps longer in the ratio of the elements: the estimate takes the errors of mesh and steps to fall together.
pub fn companion(case: &Case) -> Case {
    let (from, to) = (case.mesh.elements_per_contact_radius, companion_elements(case.mesh.elements_per_contact_radius));
    let mut companion = case.clone();
    companion.mesh.elements_per_contact_radius = to;
    companion.solver.press_steps = Some((press_steps(case) * to).div_ceil(from));
    companion.solver.shear_steps = Some((shear_steps(case) * to).div_ceil(from));
    companion
}

/// Follows the companion's path on the CPU, whatever the run itself was computed on.
///
/// # Errors
/// Why there is no estimate.
pub fn follow(companion: &Case, stop: Arc<AtomicBool>) -> Result<Vec<StepRecord>, String> {
    let said = |error: SimulationError| error.to_string();
    let problem = Problem::new(companion).map_err(said)?;
    let mut backend = Cpu::<f64>::new(vec![problem.model.clone()]).map_err(|error| error.to_string())?;
    let newton = problem.newton().map_err(said)?;
    let mut recorder = Recorder::new(companion, Some(stop));
    match Drive::new(&problem, &mut backend, 0, newton).run(&mut recorder).map_err(said)? {
        Ending::Done => Ok(recorder.rows.split_off(1)),
        Ending::NotConverged(reason) | Ending::Outgrown(reason) => Err(reason),
        Ending::Interrupted => Err("interrupted".to_owned()),
    }
}
