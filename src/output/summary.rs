//! `summary.json`: one run in some numbers, and how they are read off its history.

use super::first_shear::{SLIP_DISPLACEMENT_RATIOS, first_shear, reaches};
use super::units::coefficient;
use super::{ErrorEstimate, OutputError, StepRecord, TimeByPhase, plain_json, write_atomically};
use crate::bounded;
use crate::case::{Case, Segment};
use crate::compute::traffic::DeviceTraffic;
use serde::{Deserialize, Serialize};
use std::io;
use std::path::Path;

/// Full slip counts as reached when no point in contact sticks or |F_T|/F_N is at least this share
/// of mu. It stays below 1 where points slip in slightly different directions or a few at the edge,
/// which carry next to nothing, do not settle.
pub const FULL_SLIP_RATIO: f64 = 0.997;

/// How a run ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RunStatus {
    /// To the end of the path.
    Done,
    /// A step failed; what was computed is kept.
    NotConverged,
    /// The contact came to the edge of the finely meshed zone; what was computed is kept.
    ContactOutgrewMesh,
    /// Stopped from outside, by a signal or because results could not be written; what was computed
    /// is kept.
    #[default]
    Interrupted,
    /// Broke off for another reason: the device failed, say; what was computed is kept.
    Failed,
}

impl std::fmt::Display for RunStatus {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            RunStatus::Done => "done",
            RunStatus::NotConverged => "not converged",
            RunStatus::ContactOutgrewMesh => "the contact outgrew the mesh",
            RunStatus::Interrupted => "interrupted",
            RunStatus::Failed => "failed",
        })
    }
}

/// What [`Summary::from_history`] has to know beside the history, in the same units.
#[derive(Clone, Debug, PartialEq)]
pub struct SummaryInputs {
    /// Radius R.
    pub radius: f64,
    /// Young's modulus E.
    pub youngs_modulus: f64,
    /// Coulomb's coefficient mu; `None` for full stick.
    pub friction: Option<f64>,
    /// Segments of the path in which h and delta_T move together: none of them is a shear.
    pub oblique: Vec<usize>,
}

impl SummaryInputs {
    /// Those of a case in the user's units.
    pub fn of(case: &Case) -> Self {
        Self {
            radius: case.sphere.radius,
            youngs_modulus: case.material.youngs_modulus,
            friction: coefficient(case.contact.friction),
            oblique: (0..case.path.len()).filter(|&i| does_more_than_shear(&case.path[i])).collect(),
        }
    }
}

/// Whether a segment shears and does something else as well.
fn does_more_than_shear(segment: &Segment) -> bool {
    match segment {
        Segment::Oblique { .. } => true,
        Segment::Motion { to, .. } => to.turns() || to.indentation.is_some(),
        Segment::Indentation { .. } | Segment::Shear { .. } | Segment::Slip { .. } | Segment::Release { .. } => false,
    }
}

/// The forces over E R^2, the lengths over R, the stiffness over E R.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
#[allow(missing_docs)] // the names are those of Summary
pub struct NormalizedResults {
    #[serde(rename = "F_N0")]
    pub f_n0: Option<f64>,
    pub a0: Option<f64>,
    pub h0: Option<f64>,
    #[serde(rename = "F_N_slip")]
    pub f_n_slip: Option<f64>,
    #[serde(rename = "F_T_max")]
    pub f_t_max: Option<f64>,
    #[serde(rename = "delta_T_90")]
    pub delta_t_90: Option<f64>,
    #[serde(rename = "delta_T_95")]
    pub delta_t_95: Option<f64>,
    #[serde(rename = "delta_T_slip")]
    pub delta_t_slip: Option<f64>,
    #[serde(rename = "k_T0")]
    pub k_t0: Option<f64>,
}

/// A run in some numbers, in the user's units. What does not exist is null. "The shear" is the
/// first one of the path, as far as it goes in one direction; its numbers are sizes, so that a
/// shear to the left gives the same as one to the right. Where h and delta_T move together there is
/// no shear.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Summary {
    /// Normal force F_N0 just before the shear; without a shear, at the greatest indentation.
    #[serde(rename = "F_N0")]
    pub f_n0: Option<f64>,
    /// Contact radius a0 there.
    pub a0: Option<f64>,
    /// Indentation h0 there.
    pub h0: Option<f64>,
    /// Normal force at the first step in full slip, see [`FULL_SLIP_RATIO`].
    #[serde(rename = "F_N_slip")]
    pub f_n_slip: Option<f64>,
    /// Greatest |F_T| of the shear.
    #[serde(rename = "F_T_max")]
    pub f_t_max: Option<f64>,
    /// Displacement from the start of the shear to |F_T|/F_N = 0.90 mu, on a smooth curve through
    /// the steps.
    #[serde(rename = "delta_T_90")]
    pub delta_t_90: Option<f64>,
    /// The same to 0.95 mu.
    #[serde(rename = "delta_T_95")]
    pub delta_t_95: Option<f64>,
    /// The same to 0.99 mu, [where slip is full](super::first_shear::SLIP_DISPLACEMENT_RATIO).
    #[serde(rename = "delta_T_slip")]
    pub delta_t_slip: Option<f64>,
    /// Initial tangential stiffness: the tangent dF_T/d delta_T at the start of the shear, where no
    /// point slips and what flowed in the press flows on as far as the shear goes on loading it.
    /// The body's own compliance up to the equator is in it.
    #[serde(rename = "k_T0")]
    pub k_t0: Option<f64>,
    /// Estimated discretisation error of F_N0, a size, see [`super::Limits`]; null where none was
    /// made.
    #[serde(rename = "F_N0_error")]
    pub f_n0_error: Option<f64>,
    /// That of a0.
    pub a0_error: Option<f64>,
    /// That of F_T_max.
    #[serde(rename = "F_T_max_error")]
    pub f_t_max_error: Option<f64>,
    /// Greatest |F_T| of the shear in the limit of fine meshes and short steps.
    #[serde(rename = "F_T_max_limit")]
    pub f_t_max_limit: Option<f64>,
    /// That of delta_T_90: what F_T/F_N lacks there, over the slope of its curve.
    #[serde(rename = "delta_T_90_error")]
    pub delta_t_90_error: Option<f64>,
    /// That of delta_T_95.
    #[serde(rename = "delta_T_95_error")]
    pub delta_t_95_error: Option<f64>,
    /// That of delta_T_slip.
    #[serde(rename = "delta_T_slip_error")]
    pub delta_t_slip_error: Option<f64>,
    /// delta_T_90 in the limit of fine meshes and short steps: where F_T/F_N of the limits is 0.90
    /// mu.
    #[serde(rename = "delta_T_90_limit")]
    pub delta_t_90_limit: Option<f64>,
    /// The same of delta_T_95.
    #[serde(rename = "delta_T_95_limit")]
    pub delta_t_95_limit: Option<f64>,
    /// Estimated error of k_T0.
    #[serde(rename = "k_T0_error")]
    pub k_t0_error: Option<f64>,
    /// Root mean square of ln F_N about a smooth curve through the first press: the ripple of nodes
    /// coming into contact.
    #[serde(rename = "F_N_ripple")]
    pub f_n_ripple: Option<f64>,
    /// Elements along the contact radius of the coarse run from which limits and errors were
    /// estimated.
    pub error_companion_elements: Option<usize>,
    /// Steps that were accepted above the tolerance, or under full stick with points that slid.
    pub relaxed_steps: usize,
    /// Steps under full stick in which points came off and down again.
    pub landed_again: usize,
    /// How often the contact left the finely meshed zone and the run started over on a larger one.
    pub remeshed: usize,
    /// |F_T|/F_N at the end of the shear.
    pub mu_at_slip: Option<f64>,
    /// Whether the shear got to full slip.
    pub full_slip_reached: bool,
    /// The same numbers without units.
    pub normalized: NormalizedResults,
    /// Elements of the mesh.
    pub elements: usize,
    /// Unknown displacements, prescribed ones not counted.
    pub unknowns: usize,
    /// Accepted steps.
    pub steps: usize,
    /// Newton iterations of all steps, those of rejected attempts included.
    pub newton_iterations: usize,
    /// Times an increment was halved.
    pub cutbacks: usize,
    /// Iterations of the linear solver.
    pub krylov_iterations: usize,
    /// Linear systems that multigrid left to the direct solver.
    pub linear_fallbacks: usize,
    /// Newton iterations made on the host in f64, after the device had converged the step in f32 or
    /// failed to. Null where no device works so.
    pub confirming_iterations: Option<usize>,
    /// Greatest equivalent plastic strain at the end.
    pub max_alpha: Option<f64>,
    /// Time from start to end, seconds, that of earlier parts of a resumed run included.
    pub wall_s: f64,
    /// Processor time likewise, seconds, all threads; null where the system does not tell.
    pub cpu_s: Option<f64>,
    /// What the time on the wall was spent on.
    pub time_by_phase: TimeByPhase,
    /// Device that ran the kernels.
    pub device: String,
    /// Precision of the residual, f64.
    pub precision: String,
    /// What passed between the host and the device; null where the CPU ran the kernels.
    pub device_traffic: Option<DeviceTraffic>,
    /// How the run ended.
    pub status: RunStatus,
    /// Version of the program.
    pub version: String,
    /// Notes and warnings, in the order in which they came.
    pub messages: Vec<String>,
}

impl Summary {
    /// Everything that the history tells, its own counts included; the mesh, times, device, status
    /// and messages are left to the caller. The version is set. An empty history gives nulls.
    pub fn from_history(history: &[StepRecord], inputs: &SummaryInputs) -> Self {
        let mut summary = Self {
            steps: history.len(),
            newton_iterations: history.iter().map(|record| record.newton_iterations).sum(),
            cutbacks: history.iter().map(|record| record.cutbacks).sum(),
            relaxed_steps: history.iter().filter(|record| record.relaxed > 0).count(),
            landed_again: history.iter().filter(|record| record.landed_again > 0).count(),
            krylov_iterations: history.iter().map(|record| record.krylov_iterations).sum(),
            max_alpha: history.last().map(|record| record.max_alpha),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            ..Self::default()
        };
        summary.f_n_ripple = super::ripple(history);
        let (start, shear) = first_shear(history, &inputs.oblique);
        if let Some(start) = start {
            (summary.f_n0, summary.a0, summary.h0) = (Some(start.f_n), Some(start.a), Some(start.h));
        }
        if let Some(start) = start.filter(|_| !shear.is_empty()) {
            let points: Vec<ShearPoint> = shear.iter().map(|record| ShearPoint::new(start, record)).collect();
            summary.f_t_max = points.iter().map(|point| point.force).reduce(f64::max);
            summary.k_t0 = shear.first().and_then(|first| first.k_t);
            summary.mu_at_slip = points.last().and_then(|point| point.ratio);
            if let Some(mu) = inputs.friction {
                let slip = shear.iter().zip(&points).find(|(record, point)| in_full_slip(record, point, mu));
                summary.f_n_slip = slip.map(|(record, _)| record.f_n);
                summary.full_slip_reached = slip.is_some();
                let [to_90, to_95, to_slip] = SLIP_DISPLACEMENT_RATIOS.map(|share| displacement_at(&points, share * mu));
                (summary.delta_t_90, summary.delta_t_95, summary.delta_t_slip) = (to_90, to_95, to_slip);
            }
        }
        summary.normalize(inputs);
        summary
    }

    /// The same with what is estimated of its errors.
    pub fn with_errors(self, estimate: Option<ErrorEstimate>) -> Self {
        let errors = estimate.unwrap_or_default();
        let [delta_t_90_error, delta_t_95_error, delta_t_slip_error] = errors.delta_t;
        let [delta_t_90_limit, delta_t_95_limit] = errors.delta_t_limit;
        Self {
            f_n0_error: errors.f_n0,
            a0_error: errors.a0,
            f_t_max_error: errors.f_t_max,
            f_t_max_limit: errors.f_t_max_limit,
            delta_t_90_error,
            delta_t_95_error,
            delta_t_slip_error,
            delta_t_90_limit,
            delta_t_95_limit,
            k_t0_error: errors.k_t0,
            error_companion_elements: estimate.map(|estimate| estimate.coarse_elements),
            ..self
        }
    }

    fn normalize(&mut self, inputs: &SummaryInputs) {
        let length = |value: Option<f64>| value.map(|value| value / inputs.radius);
        let force = |value: Option<f64>| value.map(|value| value / (inputs.youngs_modulus * inputs.radius * inputs.radius));
        self.normalized = NormalizedResults {
            f_n0: force(self.f_n0),
            a0: length(self.a0),
            h0: length(self.h0),
            f_n_slip: force(self.f_n_slip),
            f_t_max: force(self.f_t_max),
            delta_t_90: length(self.delta_t_90),
            delta_t_95: length(self.delta_t_95),
            delta_t_slip: length(self.delta_t_slip),
            k_t0: self.k_t0.map(|value| value / (inputs.youngs_modulus * inputs.radius)),
        };
    }

    /// Writes `summary.json`, whole or not at all.
    pub fn write(&self, path: &Path) -> Result<(), OutputError> {
        write_atomically(path, |out| {
            serde_json::to_writer_pretty(&mut *out, self).map_err(io::Error::from)?;
            out.write_all(b"\n")
        })
    }

    /// Reads it back; keys that are missing get their defaults.
    pub fn read(path: &Path) -> Result<Self, OutputError> {
        let text = bounded::result_to_string(path, bounded::RESULT).map_err(OutputError::reading(path))?;
        plain_json::from_str(&text).map_err(|flaw| OutputError::Malformed {
            path: path.to_path_buf(),
            line: flaw.line as u64,
            problem: flaw.to_string(),
        })
    }
}

/// A point of the shear as sizes.
struct ShearPoint {
    /// Displacement from the start.
    displacement: f64,
    /// |F_T|.
    force: f64,
    /// |F_T|/F_N, where there is a normal force.
    ratio: Option<f64>,
}

impl ShearPoint {
    fn new(start: &StepRecord, record: &StepRecord) -> Self {
        let [x, y] = record.tangential_force();
        Self {
            displacement: (record.delta_t - start.delta_t).hypot(record.delta_t_y - start.delta_t_y),
            force: x.hypot(y),
            ratio: (record.f_n > 0.0).then(|| x.hypot(y) / record.f_n),
        }
    }
}

fn in_full_slip(record: &StepRecord, point: &ShearPoint, mu: f64) -> bool {
    let all_slip = record.contact_points > 0 && record.slipping_points >= record.contact_points;
    all_slip || point.ratio.is_some_and(|ratio| ratio >= FULL_SLIP_RATIO * mu)
}

/// The displacement at which the curve of |F_T|/F_N over it, which begins at the origin, first
/// reaches `wanted`; `None` if it does not, or at a point without a ratio before.
fn displacement_at(points: &[ShearPoint], wanted: f64) -> Option<f64> {
    reaches(points.iter().map_while(|point| Some([point.displacement, point.ratio?])), wanted)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytical::ElasticSphere;
    use crate::analytical::cattaneo_mindlin::CattaneoMindlin;
    use std::fs;

    const MU: f64 = 0.3;
    const INPUTS: SummaryInputs = SummaryInputs { radius: 2.0, youngs_modulus: 200e3, friction: Some(MU), oblique: Vec::new() };

    fn contact() -> CattaneoMindlin {
        CattaneoMindlin::at_indentation(ElasticSphere { radius: 2.0, youngs_modulus: 200e3, poissons_ratio: 0.3 }, MU, 1e-3)
    }

    /// Press in four steps, then Cattaneo-Mindlin in increments growing as i^1.3 up to `reach` d_s,
    /// with F_N falling by `fall` over d_s.
    fn synthetic(direction: f64, reach: f64, fall: f64) -> Vec<StepRecord> {
        let contact = contact();
        let slip = contact.slip_displacement();
        let mut rows: Vec<StepRecord> = (1..=4)
            .map(|i| StepRecord {
                step: i,
                h: 1e-3 * i as f64 / 4.0,
                f_n: contact.normal_force * (i as f64 / 4.0).powf(1.5),
                a: contact.contact_radius * (i as f64 / 4.0).sqrt(),
                newton_iterations: 5,
                krylov_iterations: 40,
                contact_points: 100,
                ..StepRecord::default()
            })
            .collect();
        rows.extend((1..=20).map(|i| {
            let x = reach * (i as f64 / 20.0).powf(2.3);
            let f_n = contact.normal_force * (1.0 - fall * x.min(1.0));
            StepRecord {
                step: 4 + i,
                segment: 1,
                h: 1e-3,
                delta_t: direction * x * slip,
                f_n,
                f_t: direction * contact.force(x * slip) * f_n / contact.normal_force,
                a: contact.contact_radius,
                newton_iterations: 3,
                cutbacks: usize::from(i == 7),
                k_t: (i == 1).then(|| contact.initial_stiffness()),
                contact_points: 100,
                slipping_points: (100.0 * x.min(1.0)) as usize,
                max_alpha: 0.1,
                ..StepRecord::default()
            }
        }));
        rows
    }

    fn close(value: Option<f64>, expected: f64, tolerance: f64) {
        let value = value.expect("a number");
        assert!((value / expected - 1.0).abs() < tolerance, "{value} instead of {expected}");
    }

    #[test]
    fn reads_cattaneo_mindlin_off() {
        let contact = contact();
        for direction in [1.0, -1.0] {
            let summary = Summary::from_history(&synthetic(direction, 1.4, 0.0), &INPUTS);
            close(summary.f_n0, contact.normal_force, 1e-14);
            close(summary.a0, contact.contact_radius, 1e-14);
            close(summary.h0, 1e-3, 1e-14);
            close(summary.f_n_slip, contact.normal_force, 1e-14);
            close(summary.f_t_max, MU * contact.normal_force, 1e-12);
            close(summary.k_t0, contact.initial_stiffness(), 1e-14);
            // 1 - (1 - x)^1.5 is 0.90, 0.95 and 0.99 there; steps of 0.1 d_s.
            close(summary.delta_t_90, 0.7846 * contact.slip_displacement(), 0.02);
            close(summary.delta_t_95, 0.8643 * contact.slip_displacement(), 0.02);
            close(summary.delta_t_slip, 0.9536 * contact.slip_displacement(), 0.02);
            close(summary.mu_at_slip, MU, 1e-12);
            assert!(summary.full_slip_reached);
            assert_eq!((summary.newton_iterations, summary.cutbacks, summary.krylov_iterations), (80, 1, 160));
            close(summary.normalized.f_n0, contact.normal_force / 800e3, 1e-14);
            close(summary.normalized.k_t0, summary.k_t0.unwrap() / 400e3, 1e-14);
            close(summary.normalized.delta_t_90, summary.delta_t_90.unwrap() / 2.0, 1e-14);
            close(summary.normalized.delta_t_slip, summary.delta_t_slip.unwrap() / 2.0, 1e-14);
        }
    }

    #[test]
    fn a_falling_normal_force_is_read_at_slip_and_the_greatest_tangential_one_before() {
        let contact = contact();
        let summary = Summary::from_history(&synthetic(1.0, 1.4, 0.3), &INPUTS);
        close(summary.f_n_slip, 0.7 * contact.normal_force, 1e-12);
        assert!(summary.f_t_max.unwrap() > MU * 0.7 * contact.normal_force);
        close(summary.f_n0, contact.normal_force, 1e-14);
    }

    #[test]
    fn a_shear_that_stops_early_has_no_slip() {
        let summary = Summary::from_history(&synthetic(1.0, 0.6, 0.0), &INPUTS);
        assert!(!summary.full_slip_reached && summary.f_n_slip.is_none() && summary.delta_t_slip.is_none());
        assert!(summary.f_t_max.is_some() && summary.mu_at_slip.unwrap() < MU);
    }

    #[test]
    fn only_the_first_stroke_counts() {
        let mut rows = synthetic(-1.0, 0.8, 0.0);
        let expected = Summary::from_history(&rows, &INPUTS);
        for (i, x) in [0.5, 0.0, -2.0].into_iter().enumerate() {
            rows.push(StepRecord {
                step: 25 + i,
                segment: 2,
                delta_t: -x * contact().slip_displacement(),
                f_n: contact().normal_force,
                f_t: 1e3,
                ..rows[23]
            });
        }
        let summary = Summary::from_history(&rows, &INPUTS);
        assert_eq!(summary.f_t_max, expected.f_t_max);
        assert_eq!(summary.f_n_slip, None);
    }

    #[test]
    fn stick_no_friction_press_only_and_nothing() {
        let rows = synthetic(1.0, 1.4, 0.0);
        let stick = Summary::from_history(&rows, &SummaryInputs { friction: None, ..INPUTS });
        assert!(stick.k_t0.is_some() && stick.delta_t_slip.is_none() && !stick.full_slip_reached);
        let smooth: Vec<StepRecord> = rows.iter().map(|row| StepRecord { f_t: 0.0, k_t: row.k_t.map(|_| 0.0), ..*row }).collect();
        let smooth = Summary::from_history(&smooth, &SummaryInputs { friction: Some(0.0), ..INPUTS });
        assert_eq!((smooth.delta_t_slip, smooth.k_t0, smooth.f_t_max), (Some(0.0), Some(0.0), Some(0.0)));
        // Pressed and released: the numbers are those of the greatest load.
        let mut released = rows[..4].to_vec();
        released.push(StepRecord { step: 5, segment: 1, h: 5e-4, f_n: 1.0, ..rows[3] });
        let press = Summary::from_history(&released, &INPUTS);
        assert_eq!((press.f_n0, press.h0), (Some(rows[3].f_n), Some(1e-3)));
        assert_eq!((press.f_t_max, press.k_t0, press.mu_at_slip), (None, None, None));
        assert_eq!(Summary::from_history(&[], &INPUTS).f_n0, None);
    }

    #[test]
    fn json_has_the_promised_keys_and_nulls() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("summary.json");
        let mut summary = Summary::from_history(&synthetic(1.0, 0.5, 0.0), &INPUTS);
        summary.status = RunStatus::NotConverged;
        summary.device = "cpu".into();
        summary.messages.push("note".into());
        // A number that a hasty reader of decimals gets wrong in its last bit.
        summary.a0 = Some(0.123_877_429_705_042_23);
        summary.write(&path).unwrap();
        assert_eq!(Summary::read(&path).unwrap(), summary);
        let json: serde_json::Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
        for key in [
            "F_N0",
            "a0",
            "h0",
            "F_N_slip",
            "F_T_max",
            "delta_T_slip",
            "delta_T_90",
            "delta_T_95",
            "delta_T_90_error",
            "k_T0",
            "elements",
            "unknowns",
            "newton_iterations",
            "wall_s",
            "device",
            "precision",
            "status",
            "cutbacks",
            "krylov_iterations",
            "cpu_s",
            "version",
            "normalized",
            "mu_at_slip",
            "full_slip_reached",
            "remeshed",
            "relaxed_steps",
            "landed_again",
            "messages",
        ] {
            assert!(json.get(key).is_some(), "{key} is missing");
        }
        assert!(json["F_N_slip"].is_null() && json["normalized"]["F_N_slip"].is_null());
        assert_eq!(json["status"], "not-converged");
        fs::write(&path, "{\n\"F_N0\": wrong}").unwrap();
        assert!(Summary::read(&path).unwrap_err().to_string().contains("line 2"));
    }
}
