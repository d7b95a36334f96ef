//! The coarse run that goes before a run, its companion: it finds how far the contact will reach,
//! and with it the limits of the curves and their errors are estimated.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use serde::{Deserialize, Serialize};

use super::SimulationError;
use super::drive::{Ending, Observer, StepView};
use super::error::ObserverError;
use super::follow::{follow, on_cpu};
use super::problem::{Problem, press_steps, shear_steps};
use super::record::StepRecord;
use super::zone::{LARGEST_FINE_ZONE, MARGIN, Zone};
use crate::case::{Case, Scaled};

/// What a scout has found; scaled, lengths by R, forces by E R^2.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Scout {
    /// Its accepted steps.
    pub rows: Vec<Scaled<StepRecord>>,
    /// Size of its elements in the contact.
    pub spacing: f64,
    /// Elements along the contact radius for which its mesh was made at first.
    pub elements: usize,
    /// Elements of its mesh.
    pub mesh_elements: usize,
    /// Why it did not get to the end of the path.
    pub failure: Option<String>,
}

/// Elements along the contact radius of the scout of a run on `elements`: half of them, of an odd
/// number the smaller half.
pub fn scout_elements(elements: usize) -> usize {
    (elements / 2).max(1)
}

/// The case on its scout's mesh, with steps longer in the ratio of the elements: what is of first
/// order in either, mesh or steps, is then in the scout about twice of what it is in the run.
pub fn scout_case(case: &Case) -> Case {
    let (from, to) = (case.mesh.elements_per_contact_radius, scout_elements(case.mesh.elements_per_contact_radius));
    let mut scout = case.clone();
    scout.mesh.elements_per_contact_radius = to;
    scout.mesh.surface_elements_per_contact_radius =
        scout.mesh.surface_elements_per_contact_radius.map(|_| to << case.mesh.skin_levels());
    scout.solver.press_steps = Some((press_steps(case) * to).div_ceil(from));
    scout.solver.shear_steps = Some((shear_steps(case) * to).div_ceil(from));
    scout
}

/// Follows the path of a case on its scout's mesh, on the CPU, whatever the run itself will be
/// computed on. `None` if `stop` was set before its end.
///
/// # Errors
/// [`SimulationError`] if the case cannot be set up.
pub fn scout(case: &Case, stop: &Arc<AtomicBool>) -> Result<Option<Scout>, SimulationError> {
    let finer = case.mesh.elements_per_contact_radius;
    let case = scout_case(case);
    let elements = case.mesh.elements_per_contact_radius;
    let asked = Problem::zone_of(&case)?;
    // Elements at the edge are larger here than in the run: a contact that fits there has to fit
    // here.
    let roomy =
        Zone { fine_zone: (asked.fine_zone + ROOM / case.mesh.surface_elements() as f64).min(LARGEST_FINE_ZONE), ..asked };
    let mut problem = Problem::on(&case, Some(roomy))?;
    // Releases and what follows the first part of a shear have no number of steps in the case.
    problem.resolution.coarseness = finer as f64 / elements as f64;
    let mut watch = Watch { stop: stop.clone(), ..Watch::default() };
    watch.set_out(&problem);
    let ending = follow(problem, None, &mut |problem| on_cpu(problem), &mut watch);
    if stop.load(Ordering::Relaxed) {
        return Ok(None);
    }
    let failure = match ending.map(|followed| followed.ending) {
        Ok(Ending::Done) => None,
        Ok(Ending::NotConverged(reason)) => Some(reason),
        Ok(Ending::Outgrown(outgrowth)) => Some(outgrowth.to_string()),
        Ok(Ending::Interrupted) => return Ok(None),
        Err(error) => Some(error.to_string()),
    };
    let Watch { rows, spacing, mesh_elements, .. } = watch;
    Ok(Some(Scout { rows, spacing, elements, mesh_elements, failure }))
}

/// The zone that a run of a case (in the user's units) begins with.
///
/// # Errors
/// [`SimulationError::Hardening`].
pub fn first_zone(case: &Case, scout: Option<&Scout>) -> Result<Zone, SimulationError> {
    let asked = Problem::zone_of(case)?;
    let spacing = asked.contact_radius / case.mesh.surface_elements() as f64;
    Ok(scout.map_or(asked, |scout| scout.zone(asked, spacing)))
}

/// Elements by which the scout's zone is wider than the run's. Half and twice of it:
/// `benches/constants`.
const ROOM: f64 = 0.75;

impl Scout {
    /// The zone for a run whose case asks for `asked` and whose elements there are of size
    /// `spacing`: that one, unless the contact leaves it.
    pub fn zone(&self, asked: Zone, spacing: f64) -> Zone {
        let most = |of: fn(&StepRecord) -> f64| self.rows.iter().map(|row| of(&row.0)).fold(0.0, f64::max);
        let (reach, contact_radius) = (most(|row| row.reach), most(|row| row.a));
        // Where its outermost point is known to half an element only, the run itself shall find
        // out.
        let leaves = reach - 0.5 * self.spacing > asked.radius() - 0.5 * spacing;
        if leaves { asked.grown(reach, contact_radius, MARGIN).unwrap_or(asked) } else { asked }
    }
}

/// Keeps the rows of the last start.
#[derive(Default)]
struct Watch {
    rows: Vec<Scaled<StepRecord>>,
    spacing: f64,
    mesh_elements: usize,
    stop: Arc<AtomicBool>,
}

impl Watch {
    fn set_out(&mut self, problem: &Problem) {
        self.rows.clear();
        (self.spacing, self.mesh_elements) = (problem.spacing, problem.model.mesh.elements.len());
    }
}

impl Observer for Watch {
    fn step(&mut self, view: &mut StepView<'_>) -> Result<(), ObserverError> {
        if view.record.0.step > 0 {
            self.rows.push(view.record);
        }
        Ok(())
    }

    fn segment_end(&mut self, _: &mut StepView<'_>) -> Result<(), ObserverError> {
        Ok(())
    }

    fn note(&mut self, text: &str) {
        log::info!("scout: {text}");
    }

    fn starts_over(&mut self, problem: &Problem, _: usize) -> Result<(), ObserverError> {
        self.set_out(problem);
        Ok(())
    }

    fn stop_requested(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}
