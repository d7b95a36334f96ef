//! The exported update against simulations, path by path.

mod protocol;

use std::fmt::Write as _;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use rayon::prelude::*;

use super::{LawError, LawFile};
use crate::case::{Case, check_room};
use crate::contact_law::path::{dissipated, drive_centres};
use crate::contact_law::{Centres, ContactParameters};
use crate::memory;
use crate::output::{Recorder, StepRecord, decimal};
use crate::simulation::drive::Ending;
use crate::simulation::follow::{follow, on_cpu};
use crate::simulation::problem::Problem;

pub use protocol::{Path, materials, protocol};

/// Increments of the update between two steps of a simulation: an engine's steps are short, and an
/// oblique press still depends on them a little.
const INCREMENTS: usize = 64;
/// Aims: root mean square and worst error of a force over the greatest of its path.
pub const AIMS: [f64; 2] = [0.05, 0.12];

/// One path, simulated and followed; in the case's units.
#[derive(Clone, Debug, PartialEq)]
pub struct Checked {
    /// The path's name.
    pub name: &'static str,
    /// The simulated steps.
    pub rows: Vec<StepRecord>,
    /// F_N and F_T of the update at them.
    pub law: Vec<[f64; 2]>,
    /// Work that the simulation and the update have dissipated at the end.
    pub dissipated: [f64; 2],
    /// Why the simulation did not come to the end of the path.
    pub failure: Option<String>,
}

/// Errors of a path, over the greatest size of the force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Root mean square.
    pub rms: f64,
    /// Greatest.
    pub worst: f64,
}

impl Errors {
    /// Whether both are within the aims.
    pub fn within(&self) -> bool {
        self.rms <= AIMS[0] && self.worst <= AIMS[1]
    }
}

impl Checked {
    /// Errors of F_T and of F_N.
    pub fn errors(&self) -> [Errors; 2] {
        [self.errors_of(|row| row.f_t, 1), self.errors_of(|row| row.f_n, 0)]
    }

    fn errors_of(&self, force: fn(&StepRecord) -> f64, component: usize) -> Errors {
        let normal = self.rows.iter().map(|row| row.f_n).fold(0.0, f64::max);
        // A press alone has no tangential force but that of the tolerance.
        let peak = self.rows.iter().map(|row| force(row).abs()).fold(0.01 * normal, f64::max);
        if !(peak > 0.0) {
            return Errors::default();
        }
        let errors: Vec<f64> =
            self.rows.iter().zip(&self.law).map(|(row, law)| (law[component] - force(row)).abs() / peak).collect();
        Errors {
            rms: (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt(),
            worst: errors.iter().copied().fold(0.0, f64::max),
        }
    }

    /// F_N at the end over the greatest of the simulated path, simulated and by the update.
    pub fn left(&self) -> [f64; 2] {
        let peak = self.rows.iter().map(|row| row.f_n).fold(0.0, f64::max);
        match (self.rows.last(), self.law.last()) {
            (Some(row), Some(law)) if peak > 0.0 => [row.f_n / peak, law[0] / peak],
            _ => [0.0; 2],
        }
    }

    /// The simulated steps with the update's forces beside them, as CSV.
    pub fn csv(&self) -> String {
        let mut text = String::from("segment,h,delta_T,F_N,F_T,law_F_N,law_F_T\n");
        for (row, law) in self.rows.iter().zip(&self.law) {
            // Writing to a String cannot fail.
            let numbers = [row.h, row.delta_t, row.f_n, row.f_t, law[0], law[1]].map(decimal);
            let _ = writeln!(text, "{},{}", row.segment, numbers.join(","));
        }
        text
    }
}

/// Simulates the protocol for the material, the friction and the greatest depth of `case`, on so
/// many elements along the contact radius, and drives the update that the law exports along it.
/// Paths side by side.
///
/// # Errors
/// The law says nothing of the case; a simulation cannot be set up.
pub fn check(law: &LawFile, case: &Case, elements: usize) -> Result<Vec<Checked>, LawError> {
    check_until(law, case, elements, &Arc::default())
}

/// As [`check`]; once `stop` is set, the simulations end after their present step, which their
/// `failure` says.
///
/// # Errors
/// Those of [`check`].
pub fn check_until(law: &LawFile, case: &Case, elements: usize, stop: &Arc<AtomicBool>) -> Result<Vec<Checked>, LawError> {
    let parameters = law.contact_parameters(case)?;
    let paths = protocol(case, &parameters, elements);
    let room = memory::room();
    paths.iter().try_for_each(|path| check_room(&path.case, None, &room))?;
    paths.par_iter().with_max_len(1).map(|path| run(path, &parameters, stop)).collect()
}

fn run(path: &Path, parameters: &ContactParameters, stop: &Arc<AtomicBool>) -> Result<Checked, LawError> {
    let mut recorder = Recorder::new(&path.case, Some(stop.clone()));
    let followed = follow(Problem::new(&path.case)?, None, &mut |problem| on_cpu(problem), &mut recorder)?;
    let failure = match followed.ending {
        Ending::Done => None,
        Ending::NotConverged(reason) => Some(reason),
        Ending::Outgrown(outgrowth) => Some(outgrowth.to_string()),
        Ending::Interrupted => Some("interrupted".to_owned()),
    };
    let rows: Vec<StepRecord> = recorder.rows.into_iter().filter(|row| row.step > 0).collect();
    let places: Vec<[f64; 2]> = rows.iter().map(|row| [row.h, row.delta_t]).collect();
    let centres = Centres::of(&path.case);
    let law = drive_centres(parameters, centres, &places, INCREMENTS);
    let simulated = rows.last().map_or(0.0, |row| row.work_plastic + row.work_friction);
    let taken = dissipated(parameters, centres, &places, INCREMENTS);
    Ok(Checked { name: path.name, dissipated: [simulated, taken], rows, law, failure })
}

/// The checked paths as a table, a line each.
pub fn table(checked: &[Checked]) -> String {
    let mut text = format!(
        "{:<30} {:>7} {:>7} {:>7} {:>7}   {:>15}   {:>22}\n",
        "", "F_T rms", "worst", "F_N rms", "worst", "F_N left (law)", "dissipated (law)"
    );
    for one in checked {
        let [t, n] = one.errors().map(|e| [100.0 * e.rms, 100.0 * e.worst]);
        let ([left, left_law], [work, work_law]) = (one.left(), one.dissipated);
        let mark = if one.errors().iter().all(Errors::within) { ' ' } else { '*' };
        let _ = writeln!(
            text,
            "{:<29}{mark} {:>7.1} {:>7.1} {:>7.1} {:>7.1}   {:>6.3} ({:>6.3})   {:>9.3e} ({:>9.3e}){}",
            one.name,
            t[0],
            t[1],
            n[0],
            n[1],
            left,
            left_law,
            work,
            work_law,
            one.failure.as_ref().map_or_else(String::new, |reason| format!("\n  not simulated to its end: {reason}"))
        );
    }
    text
}
