//! Results are numbers: what is infinite, or none, is a failure and never a result.

use std::path::Path;

use super::{ContactPoint, OutputError, StepRecord, Summary};
use crate::compute::CaseFields;

/// Most of anything that a run counts: far more than it can, and so little that sums of it are
/// still numbers.
pub(super) const MOST: u64 = 1_000_000_000_000;

/// The numbers of a contact point that follow from the state, by their columns.
fn numbers_of_point(point: &ContactPoint) -> [(&'static str, f64); 6] {
    [
        ("x", point.current_x),
        ("y", point.current_y),
        ("gap", point.gap),
        ("pressure", point.pressure),
        ("traction_x", point.traction_x),
        ("traction_y", point.traction_y),
    ]
}

/// Refuses a row of the history with such a number.
///
/// # Errors
/// [`OutputError::NotFinite`] with step and column.
pub fn check_row(path: &Path, row: &StepRecord) -> Result<(), OutputError> {
    row.not_finite().map_or(Ok(()), |(column, value)| refuse(path, row.step, [(column, Some(value))]))
}

/// Of a row that was read, the first column without a number, or with a count that no run can have,
/// in words.
pub fn none_in_row(row: &StepRecord) -> Option<String> {
    let counts = [
        ("step", row.step),
        ("segment", row.segment),
        ("newton_iterations", row.newton_iterations),
        ("cutbacks", row.cutbacks),
        ("krylov_iterations", row.krylov_iterations),
        ("contact_points", row.contact_points),
        ("slipping_points", row.slipping_points),
        ("relaxed", row.relaxed),
        ("landed_again", row.landed_again),
    ];
    let too_many = || {
        let (name, count) = counts.into_iter().find(|(_, count)| *count as u64 > MOST)?;
        Some(format!("column {name}: {count} is more than any run can count"))
    };
    row.not_finite().map(none).or_else(too_many)
}

/// Of a contact point that was read likewise.
pub fn none_in_point(point: &ContactPoint) -> Option<String> {
    let mesh = [("X", point.reference_x), ("Y", point.reference_y), ("area", point.area)];
    none_in(&mesh).or_else(|| none_in(&numbers_of_point(point)))
}

fn none_in(numbers: &[(&str, f64)]) -> Option<String> {
    numbers.iter().find(|(_, value)| !value.is_finite()).copied().map(none)
}

fn none((column, value): (&str, f64)) -> String {
    format!("column {column}: {value} is not a finite number")
}

/// Refuses a summary with such a number, which would be null in the file.
///
/// # Errors
/// [`OutputError::NotFinite`] with the last step and the key.
pub fn check_summary(path: &Path, summary: &Summary) -> Result<(), OutputError> {
    let normalized = &summary.normalized;
    let numbers = [
        ("F_N0", summary.f_n0),
        ("a0", summary.a0),
        ("h0", summary.h0),
        ("F_N_slip", summary.f_n_slip),
        ("F_T_max", summary.f_t_max),
        ("delta_T_90", summary.delta_t_90),
        ("delta_T_95", summary.delta_t_95),
        ("delta_T_slip", summary.delta_t_slip),
        ("k_T0", summary.k_t0),
        ("mu_at_slip", summary.mu_at_slip),
        ("max_alpha", summary.max_alpha),
        ("normalized.F_N0", normalized.f_n0),
        ("normalized.F_T_max", normalized.f_t_max),
        ("normalized.k_T0", normalized.k_t0),
    ];
    refuse(path, summary.steps, numbers)
}

/// Refuses the fields and the contact table of a step with such a number.
///
/// # Errors
/// [`OutputError::NotFinite`] with the step and what it is of.
pub fn check_saved(path: &Path, step: usize, fields: &CaseFields, contact: &[ContactPoint]) -> Result<(), OutputError> {
    for point in contact {
        refuse(path, step, numbers_of_point(point).map(|(name, value)| (name, Some(value))))?;
    }
    for (stress, alpha) in fields.stress.iter().zip(&fields.alpha) {
        let worst = stress.iter().find(|stress| !stress.is_finite()).copied();
        refuse(path, step, [("stress", worst), ("alpha", Some(*alpha))])?;
    }
    Ok(())
}

fn refuse<const N: usize>(path: &Path, step: usize, numbers: [(&str, Option<f64>); N]) -> Result<(), OutputError> {
    let bad = numbers.into_iter().find_map(|(name, value)| Some((name, value.filter(|value| !value.is_finite())?)));
    bad.map_or(Ok(()), |(column, value)| {
        Err(OutputError::NotFinite { path: path.to_path_buf(), step, column: column.to_owned(), value })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_of_a_row_is_looked_at() {
        let path = Path::new("out/history.csv");
        let row = StepRecord { step: 3, f_n: 1.0, ..StepRecord::default() };
        assert!(check_row(path, &row).is_ok());
        let some = Some(1.0);
        let row = StepRecord { k_t: some, f_t_limit: some, f_n_limit: some, f_t_error: some, f_n_error: some, ..row };
        assert!(check_row(path, &row).is_ok());
        let serde_json::Value::Object(columns) = serde_json::to_value(row).unwrap() else { panic!("a struct is an object") };
        let mut refused = 0;
        for column in columns.iter().filter(|(_, value)| value.is_f64()).map(|(name, _)| name) {
            // Through CSV, which has infinities: whoever adds a column finds it here.
            let mut writer = csv::Writer::from_writer(Vec::new());
            writer.serialize(row).unwrap();
            let text = String::from_utf8(writer.into_inner().unwrap()).unwrap();
            let (header, values) = text.trim_end().split_once('\n').unwrap();
            let place = header.split(',').position(|name| name == column).unwrap();
            let values: Vec<&str> = values.split(',').enumerate().map(|(i, v)| if i == place { "inf" } else { v }).collect();
            let text = format!("{header}\n{}\n", values.join(","));
            let bad: StepRecord = csv::Reader::from_reader(text.as_bytes()).deserialize().next().unwrap().unwrap();
            let message = check_row(path, &bad).unwrap_err().to_string();
            assert!(message.starts_with(&format!("step 3: {column} is inf")), "{message}");
            refused += 1;
        }
        assert_eq!(refused, 33);
        let message = check_row(path, &StepRecord { f_n: f64::NAN, ..row }).unwrap_err().to_string();
        assert!(message.starts_with("step 3: F_N is NaN"), "{message}");
    }

    #[test]
    fn fields_and_contact_points_are_looked_at() {
        let path = Path::new("out/fields/step_0003.vtu");
        let fields = CaseFields { stress: vec![[1.0; 6]; 2], alpha: vec![0.0; 2], max_alpha: 0.0 };
        assert!(check_saved(path, 3, &fields, &[]).is_ok());
        let mut bad = fields.clone();
        bad.stress[1][4] = f64::NAN;
        let message = check_saved(path, 3, &bad, &[]).unwrap_err().to_string();
        assert!(message.starts_with("step 3: stress is NaN"), "{message}");
        bad = fields;
        bad.alpha[0] = f64::INFINITY;
        let message = check_saved(path, 3, &bad, &[]).unwrap_err().to_string();
        assert!(message.starts_with("step 3: alpha is inf"), "{message}");
    }

    #[test]
    fn a_summary_without_a_number_is_refused_and_one_that_lacks_it_is_not() {
        let path = Path::new("out/summary.json");
        let good = Summary { f_n0: Some(1.0), steps: 7, ..Summary::default() };
        assert!(check_summary(path, &good).is_ok());
        let message = check_summary(path, &Summary { k_t0: Some(f64::INFINITY), ..good }).unwrap_err().to_string();
        assert!(message.starts_with("step 7: k_T0 is inf"), "{message}");
    }
}
