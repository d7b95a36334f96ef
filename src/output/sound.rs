//! What a checkpoint has to be besides undamaged: the sum at its end tells of bits that fell over,
//! not of numbers that no run can have. Whoever goes on from it counts on with its counts, cuts
//! steps by its places and meshes its zone.

use serde::Serialize;
use serde_json::Value;

use super::finite::{MOST, none_in_point, none_in_row};
use super::ledger::Ledger;
use crate::simulation::zone::Zone;

/// What no run can have written into its ledger.
pub(super) fn flaw(ledger: &Ledger) -> Option<String> {
    let Ledger { rows, tables, zone, wall_before, cpu_before, scout, .. } = ledger;
    let pressed = tables.pressed.as_ref();
    let scouted = scout.iter().flat_map(|scout| scout.rows.iter().map(|row| &row.0));
    let mut all_rows = rows.iter().chain(pressed.map(|(row, _)| row)).chain(scouted);
    let panels = tables.shear.iter().flat_map(|panel| &panel.points);
    let mut points = pressed.iter().flat_map(|(_, points)| points.iter()).chain(panels).chain(&tables.last);
    let time = |seconds: f64| seconds.is_finite() && seconds >= 0.0;
    all_rows
        .find_map(none_in_row)
        .map(|flaw| format!("a row of its history has {flaw}"))
        .or_else(|| points.find_map(none_in_point).map(|flaw| format!("a contact table has {flaw}")))
        .or_else(|| zone.and_then(Zone::flaw))
        .or_else(|| (!time(*wall_before) || !cpu_before.is_none_or(time)).then(|| "its time so far is no time".to_owned()))
        .or_else(|| counts(ledger))
}

/// A count in a part of the checkpoint that is beyond [`MOST`].
fn counts(part: &impl Serialize) -> Option<String> {
    let value = serde_json::to_value(part).ok()?;
    let (count, key) = greatest(&value, "")?;
    (count > MOST).then(|| format!("{key} is {count}"))
}

/// The greatest whole number in a value, and its key.
fn greatest(value: &Value, key: &str) -> Option<(u64, String)> {
    match value {
        Value::Number(number) => Some((number.as_u64()?, key.to_owned())),
        Value::Array(values) => values.iter().filter_map(|value| greatest(value, key)).max_by_key(|found| found.0),
        // A device moves more bytes than anything else is counted, and their sums saturate.
        Value::Object(values) => values
            .iter()
            .filter(|(name, _)| *name != "traffic")
            .filter_map(|(name, value)| greatest(value, name))
            .max_by_key(|found| found.0),
        Value::Null | Value::Bool(_) | Value::String(_) => None,
    }
}
