//! `study.csv`: a row a case, made from the case and its `summary.json` alone, so that it can be
//! made again from the directories.

use std::io;
use std::path::Path;

use super::StudyError;
use super::file::{Study, StudyCase};
use super::id::directory_of;
use crate::case::keys::takes_decimals;
use crate::case::{Case, Friction};
use crate::law::variables::{Body, Variables};
use crate::output::{OutputDirectory, RunStatus, Summary, decimal, read_history, write_atomically};

/// A column of text by its name, and how it is read.
type TextColumn = (&'static str, fn(&StudyCase, &Row) -> String);

const TEXTS: [TextColumn; 4] = [
    ("case", |case, _| case.id.clone()),
    ("directory", |case, _| directory_of(&case.id)),
    ("status", |_, row| row.status.to_string()),
    ("reason", |_, row| row.reason.clone()),
];

/// First columns of `study.csv`; the grid's keys follow, and then [`NUMBERS`].
pub const FIRST_COLUMNS: [&str; TEXTS.len()] = {
    let (mut names, mut i) = ([""; TEXTS.len()], 0);
    while i < names.len() {
        names[i] = TEXTS[i].0;
        i += 1;
    }
    names
};

/// What the last columns are made of.
struct RowNumbers<'a> {
    case: &'a Case,
    summary: Option<&'a Summary>,
    /// Those just before the shear.
    variables: Option<Variables>,
}

impl RowNumbers<'_> {
    fn friction(&self) -> Option<f64> {
        match self.case.contact.friction {
            Friction::Coefficient(mu) => Some(mu),
            Friction::Stick => None,
        }
    }
}

/// How a column of numbers is read.
enum ColumnKind {
    /// A count, written as a whole number.
    Count(fn(&RowNumbers<'_>) -> Option<usize>),
    /// A number of [`decimal`].
    Decimal(fn(&RowNumbers<'_>) -> Option<f64>),
}

use ColumnKind::{Count, Decimal};

/// A column by its name, and how it is read.
type Column = (&'static str, ColumnKind);

const COLUMNS: [Column; 26] = [
    ("E", Decimal(|n| Some(n.case.material.youngs_modulus))),
    ("nu", Decimal(|n| Some(n.case.material.poissons_ratio))),
    ("sigma_Y", Decimal(|n| n.case.material.hardening.yield_stress(n.case.material.youngs_modulus))),
    ("mu", Decimal(|n| n.friction())),
    ("R", Decimal(|n| Some(n.case.sphere.radius))),
    ("h0", Decimal(|n| n.summary?.h0)),
    ("a0", Decimal(|n| n.summary?.a0)),
    ("F_N0", Decimal(|n| n.summary?.f_n0)),
    ("F_N_slip", Decimal(|n| n.summary?.f_n_slip)),
    ("F_T_max", Decimal(|n| n.summary?.f_t_max)),
    ("delta_T_90", Decimal(|n| n.summary?.delta_t_90)),
    ("delta_T_95", Decimal(|n| n.summary?.delta_t_95)),
    ("delta_T_slip", Decimal(|n| n.summary?.delta_t_slip)),
    ("k_T0", Decimal(|n| n.summary?.k_t0)),
    ("sigma_rep", Decimal(|n| Some(n.variables?.sigma_rep))),
    ("Lambda", Decimal(|n| Some(n.variables?.lambda))),
    ("Hbar", Decimal(|n| Some(n.variables?.hardness))),
    ("c2", Decimal(|n| Some(n.variables?.c_squared))),
    ("F_T_max_limit", Decimal(|n| n.summary?.f_t_max_limit)),
    ("F_N0_error", Decimal(|n| n.summary?.f_n0_error)),
    ("F_T_max_error", Decimal(|n| n.summary?.f_t_max_error)),
    ("elements_per_contact_radius", Count(|n| Some(n.case.mesh.elements_per_contact_radius))),
    ("surface_elements_per_contact_radius", Count(|n| Some(n.case.mesh.surface_elements()))),
    ("newton_iterations", Count(|n| Some(n.summary?.newton_iterations))),
    ("cutbacks", Count(|n| Some(n.summary?.cutbacks))),
    ("cpu_s", Decimal(|n| n.summary?.cpu_s)),
];

/// Last columns of `study.csv`, in the case's own units; the four normalised variables are those
/// just before the shear. What does not exist is empty: mu of full stick, sigma_Y and sigma_rep of
/// an elastic sphere, the slip of a shear that stopped early, limit and errors of a case that was
/// computed without a companion, as a study does.
pub const NUMBERS: [&str; COLUMNS.len()] = {
    let (mut names, mut i) = ([""; COLUMNS.len()], 0);
    while i < names.len() {
        names[i] = COLUMNS[i].0;
        i += 1;
    }
    names
};

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
            RunStatus::Done => RowStatus::Done,
            RunStatus::NotConverged => RowStatus::NotConverged,
            RunStatus::ContactOutgrewMesh => RowStatus::Outgrown,
            RunStatus::Interrupted => RowStatus::Pending,
            RunStatus::Failed => RowStatus::Failed,
        };
        let told = summary.messages.iter().rev().find(|message| !message.starts_with("note: "));
        let reason = told.filter(|_| status != RowStatus::Done).map(|text| one_line(text)).unwrap_or_default();
        Self { status, reason, summary: Some(summary) }
    }

    /// The case as its directory shows it: pending, unless `case.toml` there is this very case,
    /// there is a summary, and the history has the steps that it counts.
    pub fn read(case: &Case, out: &OutputDirectory) -> Self {
        let same = |found: Case| found.identity() == case.identity();
        let this = out.holds_result() && out.load_case().is_ok_and(same);
        match this.then(|| Summary::read(&out.summary())) {
            Some(Ok(summary)) if summary.status != RunStatus::Interrupted => {
                let found = read_history(&out.history()).map_or(0, |rows| rows.len());
                if found == summary.steps {
                    return Self::of(summary);
                }
                let reason = format!("history.csv is missing or cut: {found} of {} steps", summary.steps);
                Self { reason, ..Self::pending() }
            }
            Some(Ok(summary)) => Self::of(summary),
            _ => Self::pending(),
        }
    }

    /// Whether it was computed to the end.
    pub fn is_done(&self) -> bool {
        self.status == RowStatus::Done
    }

    /// Whether it ended, but not well.
    pub fn has_failed(&self) -> bool {
        !matches!(self.status, RowStatus::Done | RowStatus::Pending)
    }

    /// The cells of [`NUMBERS`] for a case, in its own units; empty where there is no number.
    fn numbers(&self, case: &Case) -> [String; COLUMNS.len()] {
        let summary = self.summary.as_ref();
        let state = summary.and_then(|s| Some((s.h0?, s.a0?, s.f_n0?)));
        let variables = state.and_then(|(h, a, force)| Some(Body::from_case(case).ok()?.variables(h, a, force)));
        let numbers = RowNumbers { case, summary, variables };
        COLUMNS.map(|(_, read)| match read {
            Count(read) => read(&numbers).map_or(String::new(), |count| count.to_string()),
            Decimal(read) => read(&numbers).filter(|x| x.is_finite()).map_or(String::new(), decimal),
        })
    }
}

/// Writes `study.csv`, whole or not at all.
///
/// # Errors
/// [`StudyError::Output`].
pub fn write_table(table: &Path, study: &Study, rows: &[Row]) -> Result<(), StudyError> {
    let write = |out: &mut dyn io::Write| {
        let mut writer = csv::Writer::from_writer(out);
        let keys = study.keys.iter().map(String::as_str);
        writer.write_record(FIRST_COLUMNS.into_iter().chain(keys).chain(NUMBERS)).map_err(io::Error::other)?;
        for (case, row) in study.cases.iter().zip(rows) {
            writer.write_record(fields(&study.keys, case, row)).map_err(io::Error::other)?;
        }
        writer.flush()
    };
    Ok(write_atomically(table, write)?)
}

fn fields(keys: &[String], case: &StudyCase, row: &Row) -> Vec<String> {
    let mut fields: Vec<String> = TEXTS.iter().map(|(_, read)| read(case, row)).collect();
    fields.extend(keys.iter().zip(&case.values).map(|(key, value)| cell(key, value)));
    fields.extend(row.numbers(&case.case));
    fields
}

/// The cell of a key of the study: its value, where whole numbers stand for any as those.
pub(super) fn cell(key: &str, value: &str) -> String {
    match value.parse::<i64>() {
        // As the case reads it.
        Ok(number) if takes_decimals(key) => decimal(number as f64),
        _ => value.to_owned(),
    }
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
