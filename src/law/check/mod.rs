//! The exported update against simulations, path by path.
//!
//! The simulations have companions ([`crate::simulation::scout`]), and what counts are the curves
//! at the limit of fine meshes, where they are known.

mod path;
mod protocol;
mod random;
mod turning;

use std::fmt::Write as _;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use rayon::prelude::*;

use super::{LawError, LawFile};
use crate::case::{Case, Friction, Segment, check_room};
use crate::contact_law::path::drive_turning;
use crate::contact_law::{Centres, ContactParameters};
use crate::law::data::at_the_limit;
use crate::memory;
use crate::output::{Limits, Recorder, StepLimits, StepRecord, decimal};
use crate::simulation::drive::Ending;
use crate::simulation::follow::{follow, on_cpu};
use crate::simulation::problem::Problem;
use crate::simulation::scout::{first_zone, scout};

pub use path::{Path, meshed};
pub use protocol::{materials, protocol};
pub use random::{KINDS, Ranges, drawn, opponent_of, random_paths};
pub use turning::turning_paths;

/// Increments of the update between two steps of a simulation: an engine's steps are short, and an
/// oblique press still depends on them a little.
const INCREMENTS: usize = 64;
/// Aims: root mean square and worst error of a force over the greatest of its path.
pub const AIMS: [f64; 2] = [0.05, 0.12];

/// Mesh error, over the greatest size of the force, from which on a path says nothing about a law.
pub const MOST_MESH_ERROR: f64 = 0.025;
/// Share of what the extrapolation to the limit adds that may still be missing: on three contacts
/// on 5 and 10 elements F_T at the limit lacks 0.3 to 0.5 of it, root mean square
/// (`benches/limits/measure.py OUT --meshes 5/10 --reference 12/24 --cases 3`).
const STILL_MISSING: f64 = 0.5;

/// One path, simulated and followed; in the case's units.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckedPath {
    /// The path's name.
    pub name: &'static str,
    /// Its case.
    pub case: Case,
    /// The simulated steps, with F_N and F_T at the limit of fine meshes where that is known.
    pub rows: Vec<StepRecord>,
    /// What F_T and F_N may lack of the limit, root mean square over the greatest size of each;
    /// `None` where a part of the path has no limit.
    pub mesh: Option<[f64; 2]>,
    /// F_N, F_T along x and y, and the moments about z, x and y of the update at them.
    pub law: Vec<[f64; 6]>,
    /// Work that the simulation and the update have dissipated at the end.
    pub dissipated: [f64; 2],
    /// Why the simulation did not come to the end of the path.
    pub failure: Option<String>,
}

/// Errors of a path, over the greatest size of the force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathErrors {
    /// Root mean square.
    pub rms: f64,
    /// Greatest.
    pub worst: f64,
}

impl PathErrors {
    /// Whether both are within the aims.
    pub fn within(&self) -> bool {
        self.rms <= AIMS[0] && self.worst <= AIMS[1]
    }
}

impl CheckedPath {
    /// Errors of F_T, as a vector, and of F_N.
    pub fn errors(&self) -> [PathErrors; 2] {
        let tangential = self.errors_of(|row| row.f_n, tangential, |row, law| (law[1] - row.f_t).hypot(law[2] - row.f_t_y));
        [tangential, self.errors_of(|row| row.f_n, |row| row.f_n, |row, law| (law[0] - row.f_n).abs())]
    }

    /// Whether the simulation is good enough to judge by: it came to its end, and its mesh's error
    /// is known and small.
    pub fn counts(&self) -> bool {
        self.failure.is_none() && self.mesh.is_some_and(|mesh| mesh.iter().all(|&error| error <= MOST_MESH_ERROR))
    }

    /// Whether a sphere twists or rolls on the path.
    pub fn turns(&self) -> bool {
        self.case.turns()
    }

    /// Errors of M_twist, and of M_roll as a vector; of nothing where the sphere does not turn so.
    pub fn errors_of_moments(&self) -> [PathErrors; 2] {
        let twists = self.rows.iter().any(|row| row.twist != 0.0);
        let rolls = self.rows.iter().any(|row| row.roll_x != 0.0 || row.roll_y != 0.0);
        let couple = |row: &StepRecord| row.f_n * row.a;
        let twist = self.errors_of(couple, |row| row.m_twist, |row, law| (law[3] - row.m_twist).abs());
        let roll = |row: &StepRecord, law: &[f64; 6]| (law[4] - row.m_roll_x).hypot(law[5] - row.m_roll_y);
        let roll = self.errors_of(couple, |row| row.m_roll_x.hypot(row.m_roll_y), roll);
        [if twists { twist } else { PathErrors::default() }, if rolls { roll } else { PathErrors::default() }]
    }

    /// Greatest simulated moments about the normal and about the axes in the plane, over the
    /// greatest mu F_N a (F_N a in full stick).
    pub fn moments(&self) -> [f64; 2] {
        let mu = match self.case.contact.friction {
            Friction::Coefficient(mu) => mu,
            Friction::Stick => 1.0,
        };
        let most = |of: fn(&StepRecord) -> f64| self.rows.iter().map(of).fold(0.0, f64::max);
        let limit = mu * most(|row| row.f_n * row.a);
        let moments = [most(|row| row.m_twist.abs()), most(|row| row.m_roll_x.hypot(row.m_roll_y))];
        if limit > 0.0 { moments.map(|moment| moment / limit) } else { [0.0; 2] }
    }

    /// Whether F_T and F_N are within the aims, and the moments of a sphere that turns.
    pub fn within(&self) -> bool {
        self.errors().iter().chain(&self.errors_of_moments()).all(PathErrors::within)
    }

    /// Errors over the greatest size of a force, or a hundredth of the greatest of what is `whole`.
    fn errors_of(
        &self,
        whole: fn(&StepRecord) -> f64,
        force: fn(&StepRecord) -> f64,
        error: fn(&StepRecord, &[f64; 6]) -> f64,
    ) -> PathErrors {
        let peak = peak(&self.rows, whole, force);
        if !(peak > 0.0) {
            return PathErrors::default();
        }
        let errors: Vec<f64> = self.rows.iter().zip(&self.law).map(|(row, law)| error(row, law) / peak).collect();
        PathErrors {
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
        let mut text = String::from("segment,h,delta_T,F_N,F_T,law_F_N,law_F_T,delta_T_y,F_T_y,law_F_T_y");
        text += if self.turns() {
            ",twist,roll_x,roll_y,M_twist,M_roll_x,M_roll_y,law_M_twist,law_M_roll_x,law_M_roll_y\n"
        } else {
            "\n"
        };
        for (row, law) in self.rows.iter().zip(&self.law) {
            // Writing to a String cannot fail.
            let along = [row.h, row.delta_t, row.f_n, row.f_t, law[0], law[1]];
            let turned = [row.twist, row.roll_x, row.roll_y, row.m_twist, row.m_roll_x, row.m_roll_y, law[3], law[4], law[5]];
            let turned = if self.turns() { &turned[..] } else { &[] };
            let numbers = [&along[..], &[row.delta_t_y, row.f_t_y, law[2]], turned].concat();
            let numbers: Vec<String> = numbers.into_iter().map(decimal).collect();
            let _ = writeln!(text, "{},{}", row.segment, numbers.join(","));
        }
        text
    }
}

/// |F_T|.
fn tangential(row: &StepRecord) -> f64 {
    if row.f_t_y == 0.0 { row.f_t.abs() } else { row.f_t.hypot(row.f_t_y) }
}

/// The greatest size of a force. A press alone has no tangential force but that of the tolerance.
fn peak(rows: &[StepRecord], whole: impl Fn(&StepRecord) -> f64, force: impl Fn(&StepRecord) -> f64) -> f64 {
    let whole = rows.iter().map(whole).fold(0.0, f64::max);
    rows.iter().map(|row| force(row).abs()).fold(0.01 * whole, f64::max)
}

/// Simulates paths and drives the update that the law exports along them, paths side by side; once
/// `stop` is set, the simulations end after their present step, which their `failure` says.
///
/// # Errors
/// The law says nothing of a case; a simulation cannot be set up.
pub fn check(law: &LawFile, paths: &[Path], stop: &Arc<AtomicBool>) -> Result<Vec<CheckedPath>, LawError> {
    let room = memory::room();
    paths.iter().try_for_each(|path| check_room(&path.case, None, &room))?;
    let parameters = paths.iter().map(|path| law.contact_parameters(&pressed(&path.case))).collect::<Result<Vec<_>, _>>()?;
    paths.par_iter().zip(&parameters).with_max_len(1).map(|(path, parameters)| run(path, parameters, stop)).collect()
}

/// The case with nothing but its deepest press, where a sphere twists or rolls: a law has the
/// contact of such a case, and refuses its path.
fn pressed(case: &Case) -> Case {
    let path = vec![Segment::Indentation { indentation: case.greatest_indentation() }];
    if case.turns() { Case { path, ..case.clone() } } else { case.clone() }
}

fn run(path: &Path, parameters: &ContactParameters, stop: &Arc<AtomicBool>) -> Result<CheckedPath, LawError> {
    let case = &path.case;
    let companion = scout(case, stop)?;
    let problem = Problem::on(case, Some(first_zone(case, companion.as_ref())?))?;
    let mut recorder = Recorder::new(case, Some(stop.clone()));
    let spacing = problem.spacing;
    let followed = follow(problem, None, &mut |problem| on_cpu(problem), &mut recorder)?;
    let failure = match followed.ending {
        Ending::Done => None,
        Ending::NotConverged(reason) => Some(reason),
        Ending::Outgrown(outgrowth) => Some(outgrowth.to_string()),
        Ending::Interrupted => Some("interrupted".to_owned()),
    };
    let mut rows: Vec<StepRecord> = recorder.rows.into_iter().filter(|row| row.step > 0).collect();
    let spacing = recorder.spacing.unwrap_or(spacing);
    let mut known = vec![StepLimits::default(); rows.len()];
    if let Some(limits) = companion.and_then(|companion| Limits::new(case, &companion, spacing)) {
        limits.write_into(&mut rows);
        known = (0..rows.len()).map(|i| limits.of(&rows[..i], &rows[i])).collect();
    }
    let mesh = mesh_errors(&rows, &known);
    let rows = with_limits_across(&at_the_limit(&rows), &rows, &known);
    let place = |row: &StepRecord| [row.h, row.delta_t, row.delta_t_y, row.twist, row.roll_x, row.roll_y];
    let places: Vec<[f64; 6]> = rows.iter().map(place).collect();
    let (law, taken) = drive_turning(parameters, Centres::of(case), &places, INCREMENTS);
    let simulated = rows.last().map_or(0.0, |row| row.work_plastic + row.work_friction);
    Ok(CheckedPath { name: path.name, case: case.clone(), dissipated: [simulated, taken], rows, mesh, law, failure })
}

/// The rows at the limit with F_T along y at its limit too, where the others are.
fn with_limits_across(limits: &[StepRecord], raw: &[StepRecord], known: &[StepLimits]) -> Vec<StepRecord> {
    let across = |((row, raw), known): ((&StepRecord, &StepRecord), &StepLimits)| {
        let is_at_the_limit = Some(row.f_n) == raw.f_n_limit && Some(row.f_t) == raw.f_t_limit;
        let f_t_y = known.f_t_y_limit.filter(|_| is_at_the_limit).unwrap_or(row.f_t_y);
        StepRecord { f_t_y, ..*row }
    };
    limits.iter().zip(raw).zip(known).map(across).collect()
}

/// See [`CheckedPath::mesh`].
fn mesh_errors(rows: &[StepRecord], known: &[StepLimits]) -> Option<[f64; 2]> {
    let share = |peak: f64, missing: Option<Vec<f64>>| {
        let squares: f64 = missing?.iter().map(|error| (STILL_MISSING * error / peak).powi(2)).sum();
        Some((squares / rows.len().max(1) as f64).sqrt())
    };
    let tangential_missing =
        |(row, known): (&StepRecord, &StepLimits)| Some((row.f_t_limit? - row.f_t).hypot(known.f_t_y_limit? - row.f_t_y));
    let along = share(peak(rows, |row| row.f_n, tangential), rows.iter().zip(known).map(tangential_missing).collect());
    let normal = share(peak(rows, |row| row.f_n, |row| row.f_n), rows.iter().map(|row| Some(row.f_n_limit? - row.f_n)).collect());
    Some([along?, normal?])
}

/// The checked paths as a table, a line each.
pub fn table(checked: &[CheckedPath]) -> String {
    let mut text = format!(
        "{:<38} {:>7} {:>7} {:>7} {:>7} {:>11}   {:>15}   {:>22}\n",
        "", "F_T rms", "worst", "F_N rms", "worst", "mesh F_T, N", "F_N left (law)", "dissipated (law)"
    );
    for one in checked {
        let [t, n] = one.errors().map(|e| [100.0 * e.rms, 100.0 * e.worst]);
        let ([left, left_law], [work, work_law]) = (one.left(), one.dissipated);
        let mark = if one.within() { ' ' } else { '*' };
        let mesh = one.mesh.map_or_else(|| "unknown".to_owned(), |[t, n]| format!("{:.1}, {:.1}", 100.0 * t, 100.0 * n));
        let left_out = match (one.turns(), one.counts()) {
            (true, _) => {
                let [most_twist, most_roll] = one.moments();
                let [twist, roll] = one.errors_of_moments().map(|e| [100.0 * e.rms, 100.0 * e.worst]);
                format!(
                    " not counted: M_twist {:.1} ({:.1}) of {most_twist:.2}, M_roll {:.1} ({:.1}) of {most_roll:.2} mu F_N a",
                    twist[0], twist[1], roll[0], roll[1]
                )
            }
            (false, true) => String::new(),
            (false, false) => " not counted".to_owned(),
        };
        let _ = writeln!(
            text,
            "{:<37}{mark} {:>7.1} {:>7.1} {:>7.1} {:>7.1} {mesh:>11}   {:>6.3} ({:>6.3})   {:>9.3e} ({:>9.3e}){left_out}{}",
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
