//! The pictures of a run made again from what its directory holds.

use super::run::{PANELS, run_pictures, spread};
use super::{Picture, PlotInputs, Tables, View};
use crate::case::Case;
use crate::output::tables::{shears, split};
use crate::output::{OutputDirectory, OutputError, StepRecord, read_contact};

/// Draws the pictures of a run of `case` from its history and the contact tables in its directory;
/// the run may be unfinished.
///
/// # Errors
/// A table cannot be read, or a drawing fails.
pub fn replot(out: &OutputDirectory, case: &Case, history: &[StepRecord], view: &View) -> Result<Vec<Picture>, OutputError> {
    run_pictures(history, &read_tables(out, history)?, &PlotInputs::of(case), view)
}

/// Reads the tables that are shown: those of the press, and some of the shear.
fn read_tables(out: &OutputDirectory, history: &[StepRecord]) -> Result<Tables, OutputError> {
    // Tables of steps that the history does not have are not this run's.
    let saved: Vec<usize> = {
        let steps = out.contact_steps()?;
        (1..=history.len()).filter(|&count| steps.binary_search(&history[count - 1].step).is_ok()).collect()
    };
    let (press, shear): (Vec<usize>, Vec<usize>) = saved.into_iter().partition(|&count| count <= split(history).0.len());
    let (shear, rest): (Vec<usize>, Vec<usize>) = shear.into_iter().partition(|&count| shears(&history[..count]));
    // What is unloaded after the last shear, for the last table in contact.
    let rest = rest.into_iter().filter(|count| shear.last().is_none_or(|last| count > last));
    let mut tables = Tables::default();
    for count in press.into_iter().chain(spread(&shear, PANELS)).chain(rest) {
        tables.add(&history[..count], read_contact(&out.contact(history[count - 1].step))?);
    }
    Ok(tables)
}
