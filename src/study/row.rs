//! `study.csv`: a row a case, made from the case and its `summary.json` alone, so that it can be made again from the directories.

use std::io;

use super::StudyError;
use super::directory::StudyDirectory;
use super::file::{Study, StudyCase};
use crate::case::{Case, Friction};
use crate::law::variables::{Body, Variables};
use crate::output::{OutputDirectory, Status, Summary, write_atomically};

/// First columns of `study.csv`; the grid's keys follow, and then [`NUMBERS`].
pub const FIRST_COLUMNS: [&str; 4] = ["case", "directory", "status", "reason"];

/// Last columns of `study.csv`, in the case's own units; the four normalised variables are those just before the shear. What does not exist
/// is empty: mu of full stick, sigma_Y and sigma_rep of an elastic sphere, the slip of a shear that stopped early.
pub const NUMBERS: [&str; 20] = [
    "E",
    "nu",
    "sigma_Y",
    "mu",
    "R",
    "h0",
    "a0",
    "F_N0",
    "F_N_slip",
    "F_T_max",
    "delta_T_slip",
    "k_T0",
    "sigma_rep",
    "Lambda",
    "Hbar",
    "c2",
    "elements_per_contact_radius",
    "newton_iterations",
    "cutbacks",
    "cpu_s",
];

/// How a case of a study stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowStatus {
    /// Computed to the end of its path.
    Done,
    /// Broke off: an error or a fault of the program.
    Failed,
    /// A step did not converge.
    NotConverged,
    /// The contact outgrew the finely meshed zone.
    Outgrown,
    /// Not computed, or not to its end.
    Pending,
}

impl std::fmt::Display for RowStatus {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            RowStatus::Done => "done",
            RowStatus::Failed => "failed",
            RowStatus::NotConverged => "not-converged",
            RowStatus::Outgrown => "outgrown",
            RowStatus::Pending => "pending",
        })
    }
}

/// How a case stands, and its summary if it has one.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// How it stands.
    pub status: RowStatus,
    /// Why it is not done; empty if it is, or has not begun.
    pub reason: String,
    /// Its numbers.
    pub summary: Option<Summary>,
}

impl Row {
    /// A case that has not begun.
    pub fn pending() -> Self {
        Self { status: RowStatus::Pending, reason: String::new(), summary: None }
    }

    /// A case that ended with this summary.
    pub fn of(summary: Summary) -> Self {
        let status = match summary.status {
            Status::Done => RowStatus::Done,
            Status::NotConverged => RowStatus::NotConverged,
            Status::ContactOutgrewMesh => RowStatus::Outgrown,
            Status::Interrupted => RowStatus::Pending,
            Status::Failed => RowStatus::Failed,
        };
        let told = summary.messages.iter().rev().find(|message| !message.starts_with("note: "));
        let reason = told.filter(|_| status != RowStatus::Done).map(|text| one_line(text)).unwrap_or_default();
        Self { status, reason, summary: Some(summary) }
    }

    /// The case as its directory shows it: pending, unless `case.toml` there is this very case and there is a summary.
    pub fn read(case: &Case, out: &OutputDirectory) -> Self {
        let this = out.holds_result() && Case::load(&out.case(), &[]).is_ok_and(|found| found == *case);
        match this.then(|| Summary::read(&out.summary())) {
            Some(Ok(summary)) => Self::of(summary),
            _ => Self::pending(),
        }
    }

    /// Whether it ended, but not well.
    pub fn has_failed(&self) -> bool {
        !matches!(self.status, RowStatus::Done | RowStatus::Pending)
    }

    /// The numbers of [`NUMBERS`] for a case, in its own units.
    fn numbers(&self, case: &Case) -> [Option<f64>; 20] {
        let material = &case.material;
        let mu = match case.contact.friction {
            Friction::Coefficient(mu) => Some(mu),
            Friction::Stick => None,
        };
        let of = |read: &dyn Fn(&Summary) -> Option<f64>| self.summary.as_ref().and_then(read);
        let [sigma_rep, lambda, hardness, c_squared] = self.normalised(case);
        [
            Some(material.youngs_modulus),
            Some(material.poissons_ratio),
            material.hardening.yield_stress(material.youngs_modulus),
            mu,
            Some(case.sphere.radius),
            of(&|s| s.h0),
            of(&|s| s.a0),
            of(&|s| s.f_n0),
            of(&|s| s.f_n_slip),
            of(&|s| s.f_t_max),
            of(&|s| s.delta_t_slip),
            of(&|s| s.k_t0),
            sigma_rep,
            lambda,
            hardness,
            c_squared,
            Some(case.mesh.elements_per_contact_radius as f64),
            of(&|s| Some(s.newton_iterations as f64)),
            of(&|s| Some(s.cutbacks as f64)),
            of(&|s| s.cpu_s),
        ]
    }

    /// sigma_rep, Lambda, Hbar and c^2 just before the shear.
    fn normalised(&self, case: &Case) -> [Option<f64>; 4] {
        let state = self.summary.as_ref().and_then(|s| Some((s.h0?, s.a0?, s.f_n0?)));
        let (Some((h, a, force)), Ok(body)) = (state, Body::from_case(case)) else {
            return [None; 4];
        };
        let Variables { sigma_rep, lambda, hardness, c_squared } = body.variables(h, a, force);
        [sigma_rep, lambda, hardness, c_squared].map(Some)
    }
}

/// Writes `study.csv`, whole or not at all.
///
/// # Errors
/// [`StudyError::Output`].
pub fn write_table(directory: &StudyDirectory, study: &Study, rows: &[Row]) -> Result<(), StudyError> {
    let write = |out: &mut dyn io::Write| {
        let mut writer = csv::Writer::from_writer(out);
        let keys = study.keys.iter().map(String::as_str);
        writer.write_record(FIRST_COLUMNS.into_iter().chain(keys).chain(NUMBERS)).map_err(io::Error::other)?;
        for (case, row) in study.cases.iter().zip(rows) {
            writer.write_record(fields(case, row)).map_err(io::Error::other)?;
        }
        writer.flush()
    };
    Ok(write_atomically(&directory.table(), write)?)
}

fn fields(case: &StudyCase, row: &Row) -> Vec<String> {
    let mut fields = vec![case.id.clone(), StudyDirectory::relative(&case.id), row.status.to_string(), row.reason.clone()];
    fields.extend(case.values.iter().cloned());
    // The shortest digits that give the same number back.
    let text =
        |number: f64| if number.fract() == 0.0 && number.abs() < 1e15 { format!("{number}") } else { format!("{number:?}") };
    fields.extend(row.numbers(&case.case).into_iter().map(|number| number.filter(|x| x.is_finite()).map_or(String::new(), text)));
    fields
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
