//! `checkpoint.bin`: from where an interrupted or killed run goes on.
//!
//! A line of text with the version of format and program, the state in postcard's encoding (which
//! keeps every number to the bit), and the CRC-32 of all that, four bytes, little-endian. It is
//! replaced whole or not at all. That of a run that is done stays, if the case says so, and a
//! longer path goes on from it; any other is removed when the run has ended.

use std::collections::BTreeMap;
use std::io::{self, ErrorKind, Write};
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::atomic::replace_atomically;
use super::ledger::Ledger;
use super::{Limits, OutputDirectory, OutputError, StepRecord, sound};
use crate::bounded;
use crate::case::Case;
use crate::compute::Description;
use crate::simulation::checkpoint::Snapshot;
use crate::simulation::scout::Scout;
use crate::simulation::zone::Zone;

/// First words of the file.
const NAME: &str = "asperity checkpoint";
/// To be raised with every change of what is stored, and of the order and the steps in which a run
/// goes on from it. The version of the program is compared as well.
const FORMAT: u32 = 22;

/// An unfinished run: its case, what it depends on, and what it has written.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// The resolved case, in TOML.
    case: String,
    /// Device of the part of the run that wrote this.
    device: String,
    /// Precision in which the run began.
    precision: String,
    pub(super) ledger: Ledger,
    run: Snapshot,
}

impl Checkpoint {
    /// Of a run of `case` (resolved, in TOML) on `computed_on`.
    pub(super) fn new(case: &str, computed_on: &Description, ledger: Ledger, run: Snapshot) -> Self {
        let Description { device, precision } = computed_on;
        Self { case: case.to_owned(), device: device.clone(), precision: (*precision).to_owned(), ledger, run }
    }

    /// Number of the last step that is in it.
    pub fn step(&self) -> usize {
        self.run.step()
    }

    /// The state that [`crate::simulation::drive::Drive::resume`] takes.
    pub fn snapshot(&self) -> Snapshot {
        self.run.clone()
    }

    /// The finely meshed zone of the run.
    pub fn zone(&self) -> Option<Zone> {
        self.ledger.zone
    }

    /// What the coarse run before the run has found.
    pub fn scout(&self) -> Option<&Scout> {
        self.ledger.scout.as_ref()
    }

    /// Whether it is of this case.
    pub fn is_of(&self, case: &Case) -> bool {
        case_difference(&self.case, &case.to_toml()).is_none()
    }

    /// Segments of its path, if `case` is the same with a longer path that begins with it.
    ///
    /// # Errors
    /// Why it is not.
    pub fn extended_by(&self, case: &Case) -> Result<usize, String> {
        shared_path(&self.case, &case.to_toml())
    }

    /// The same state as that of a run of `case`, whose longer path has been scouted in so many
    /// seconds.
    pub fn extended(mut self, case: &Case, scout: Option<Scout>, seconds: f64) -> Self {
        let found = std::mem::replace(&mut self.case, case.to_toml());
        let Ledger { outside, messages, .. } = &mut self.ledger;
        // What is odd about the shorter path may not be about the longer one.
        let doubts = |case: &Case| case.doubts().iter().map(|doubt| format!("note: {doubt}")).collect::<Vec<_>>();
        let before = Case::parse(&found, "case.toml", &[]).map(|case| doubts(&case)).unwrap_or_default();
        messages.retain(|message| !before.contains(message));
        messages.splice(0..0, doubts(case));
        outside.error_estimate += seconds;
        outside.setup -= seconds;
        let failed = scout.as_ref().and_then(no_estimate).map(|text| format!("note: {text}"));
        messages.extend(failed.filter(|text| !messages.contains(text)));
        // As if the longer path had been scouted from the beginning.
        let zone = self.ledger.zone.as_ref();
        let spacing = zone.map(|zone| zone.contact_radius / case.mesh.surface_elements() as f64);
        if let Some(limits) = scout.as_ref().zip(spacing).and_then(|(scout, spacing)| Limits::new(case, scout, spacing)) {
            limits.write_into(&mut self.ledger.rows);
        } else {
            self.ledger.rows.iter_mut().for_each(StepRecord::forget_limits);
        }
        self.ledger.scout = scout;
        self
    }

    /// Writes it, whole or not at all.
    ///
    /// # Errors
    /// [`OutputError::Write`]; an earlier checkpoint is then still there.
    pub fn write(&self, path: &Path) -> Result<(), OutputError> {
        replace_atomically(path, |out| {
            let mut out = SumWriter { out, sum: crc32fast::Hasher::new(), failed: None };
            out.write_all(head().as_bytes())?;
            if let Err(error) = postcard::to_io(self, &mut out) {
                // postcard keeps no more of an error of the writer than that there was one.
                return Err(out.failed.unwrap_or_else(|| io::Error::other(error)));
            }
            out.out.write_all(&out.sum.finalize().to_le_bytes())
        })
    }

    /// Reads it; `None` if there is none.
    ///
    /// # Errors
    /// [`OutputError::Read`]; [`OutputError::Checkpoint`] if it is damaged or of another version.
    pub fn read(path: &Path) -> Result<Option<Self>, OutputError> {
        let bytes = match bounded::read_result(path, bounded::CHECKPOINT) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            read => read.map_err(OutputError::reading(path))?,
        };
        let refused = |problem: String| OutputError::Checkpoint { path: path.to_path_buf(), problem };
        let damaged = || refused("it is incomplete or damaged; run with --force and without --resume to begin anew".to_owned());
        let line = bytes.iter().position(|&byte| byte == b'\n').and_then(|end| bytes.get(..=end)).ok_or_else(damaged)?;
        if line != head().as_bytes() {
            let version = std::str::from_utf8(line).ok().and_then(|line| line.strip_prefix(NAME)).ok_or_else(damaged)?;
            return Err(refused(format!(
                "it was written by another version ({}, this is {}); go on with that one, or run with --force and without --resume to begin anew",
                version.trim(),
                head().trim_start_matches(NAME).trim()
            )));
        }
        let (stored, sum) = bytes.split_last_chunk::<4>().filter(|(stored, _)| stored.len() >= line.len()).ok_or_else(damaged)?;
        if crc32fast::hash(stored) != u32::from_le_bytes(*sum) {
            return Err(damaged());
        }
        let read: Self = postcard::from_bytes(&stored[line.len()..]).map_err(|_| damaged())?;
        match read.run.flaw().or_else(|| sound::flaw(&read.ledger)) {
            None => Ok(Some(read)),
            Some(flaw) => Err(refused(format!(
                "it holds what no run can have written, {flaw}; restore it, or run with --force and without --resume to begin anew"
            ))),
        }
    }

    /// Refuses a checkpoint of another case.
    ///
    /// # Errors
    /// [`OutputError::Checkpoint`] with a key that differs.
    pub fn check_case(&self, path: &Path, case: &Case) -> Result<(), OutputError> {
        match case_difference(&self.case, &case.to_toml()) {
            None => Ok(()),
            Some(difference) => Err(OutputError::Checkpoint {
                path: path.to_path_buf(),
                problem: format!(
                    "it is of another case: {difference}; restore the case file or --set, choose another --out, or run with --force and without --resume to begin anew"
                ),
            }),
        }
    }

    /// Refuses a checkpoint that tells of files which are gone: the run would end without them.
    ///
    /// # Errors
    /// [`OutputError::Checkpoint`] with the file.
    pub fn check_files(&self, out: &OutputDirectory, case: &Case) -> Result<(), OutputError> {
        let Some(missing) = out.missing(&self.ledger.saved, &self.ledger.panels, case.output.fields.has_vtu()) else {
            return Ok(());
        };
        let problem = format!(
            "{} was written before it and is gone or empty; restore the file, or run with --force and without --resume to begin anew",
            missing.display()
        );
        Err(OutputError::Checkpoint { path: out.checkpoint(), problem })
    }

    /// Refuses a checkpoint of a run in another precision.
    ///
    /// # Errors
    /// [`OutputError::Checkpoint`].
    pub fn check_precision(&self, path: &Path, precision: &str) -> Result<(), OutputError> {
        if self.precision == precision {
            return Ok(());
        }
        let problem = format!(
            "it is of a run in {}, and runs are in {precision} now; run with --force and without --resume to begin anew",
            self.precision
        );
        Err(OutputError::Checkpoint { path: path.to_path_buf(), problem })
    }

    /// What the user should know if the run goes on somewhere else: the bits are then not those of
    /// a run in one place.
    pub(super) fn change_of_device(&self, device: &str) -> Option<String> {
        let cpu = |device: &str| device.starts_with("CPU (") && device.ends_with(')');
        let same = self.device == device || (cpu(&self.device) && cpu(device));
        (!same).then(|| format!("computed up to step {} on {}, from there on {device}", self.step(), self.device))
    }
}

fn head() -> String {
    format!("{NAME}, format {FORMAT}, version {}\n", env!("CARGO_PKG_VERSION"))
}

/// Bytes from which on the text of a case is long.
const LONG: usize = 4 << 20;

/// The first key in which two cases in TOML differ, with both values; `None` if they are the same
/// case.
pub fn case_difference(there: &str, here: &str) -> Option<String> {
    // What is much longer is another one: to read it takes twenty times its length in memory.
    if there.len() > LONG && there.len() / 2 > here.len() {
        return Some(format!("its text there is {} MiB long", there.len() >> 20));
    }
    let (found, wanted) = (flat(there), flat(here));
    // How pictures look changes no result, nor does what is kept for later, nor how much memory
    // there may be.
    let matters = |key: &&String| {
        let without_effect = matches!(key.as_str(), "output.keep_checkpoint" | "solver.max_memory_gib");
        !(key.starts_with("units.") || key.starts_with("output.plot_") || without_effect)
    };
    let keys: std::collections::BTreeSet<&String> = found.keys().chain(wanted.keys()).filter(matters).collect();
    let told = |values: &BTreeMap<String, String>, key| values.get(key).map_or("absent", String::as_str).to_owned();
    let differs = keys.into_iter().find(|key| found.get(*key) != wanted.get(*key));
    differs.map(|key| format!("{key} is {} there and {} here", told(&found, key), told(&wanted, key)))
}

/// Segments of the path of `there`, if `here` is the same case with a longer path that begins with
/// it.
///
/// # Errors
/// Why it is not: a key in which they differ, or a path that is no longer.
pub fn shared_path(there: &str, here: &str) -> Result<usize, String> {
    let (Ok(found), Ok(mut wanted)) = (there.parse::<toml::Table>(), here.parse::<toml::Table>()) else {
        return Err("the case there is unreadable".to_owned());
    };
    let segments = |case: &toml::Table| case.get("path").and_then(toml::Value::as_array).map_or(0, Vec::len);
    let (shorter, longer) = (segments(&found), segments(&wanted));
    if let Some(path) = wanted.get_mut("path").and_then(toml::Value::as_array_mut) {
        path.truncate(shorter);
    }
    match case_difference(there, &wanted.to_string()) {
        Some(difference) => Err(difference),
        None if longer > shorter => Ok(shorter),
        None => Err(format!("the path has {shorter} segments there and no more here")),
    }
}

/// What the user is told where the coarse run says nothing of the errors.
pub(super) fn no_estimate(scout: &Scout) -> Option<String> {
    let reason = scout.failure.as_ref()?;
    Some(format!("no error estimate: the coarse run before this one ended early: {reason}"))
}

/// Every value of a document by its dotted key. A text that is not TOML is one value.
fn flat(text: &str) -> BTreeMap<String, String> {
    fn take(key: String, value: &toml::Value, flat: &mut BTreeMap<String, String>) {
        let below = |name: &str| if key.is_empty() { name.to_owned() } else { format!("{key}.{name}") };
        match value {
            toml::Value::Table(table) => table.iter().for_each(|(name, value)| take(below(name), value, flat)),
            toml::Value::Array(values) => values.iter().enumerate().for_each(|(i, v)| take(below(&i.to_string()), v, flat)),
            value => drop(flat.insert(key, value.to_string())),
        }
    }
    let mut values = BTreeMap::new();
    match text.parse::<toml::Table>() {
        Ok(table) => take(String::new(), &toml::Value::Table(table), &mut values),
        Err(_) => drop(values.insert("the case".to_owned(), "unreadable".to_owned())),
    }
    values
}

/// Sums up what is written, and keeps what went wrong.
struct SumWriter<'a> {
    out: &'a mut dyn Write,
    sum: crc32fast::Hasher,
    failed: Option<io::Error>,
}

impl Write for SumWriter<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.out.write(bytes) {
            Ok(written) => {
                self.sum.update(&bytes[..written]);
                Ok(written)
            }
            Err(error) => {
                let kind = error.kind();
                self.failed = Some(error);
                Err(kind.into())
            }
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_that_is_far_longer_is_of_another_case_unread() {
        let here = "[contact]\nfriction = 0.3\n";
        let there = here.repeat(200_000);
        assert_eq!(case_difference(&there, here).as_deref(), Some("its text there is 4 MiB long"));
        assert_eq!(case_difference(here, here), None);
    }

    #[test]
    fn a_difference_is_told_by_its_key() {
        let case = "[contact]\nfriction = 0.3\n[[path]]\nindentation = 0.02\n[[path]]\nshear = 0.01\n";
        assert_eq!(case_difference(case, &format!("# a comment\n\n{case}")), None);
        for (there, here, expected) in [
            ("friction = 0.3", "friction = \"stick\"", "contact.friction is 0.3 there and \"stick\" here"),
            ("[[path]]\nshear = 0.01\n", "", "path.1.shear is 0.01 there and absent here"),
            ("0.02", "0.020000000000000004", "path.0.indentation is 0.02 there and 0.020000000000000004 here"),
            ("[contact]", "]", "contact.friction is 0.3 there and absent here"),
        ] {
            assert_eq!(case_difference(case, &case.replace(there, here)).as_deref(), Some(expected));
        }
    }

    #[test]
    fn a_longer_path_begins_with_the_shorter_one() {
        let case = "[contact]\nfriction = 0.3\n[[path]]\nindentation = 0.02\n";
        let more = format!("{case}[[path]]\nshear = 0.01\n");
        assert_eq!(shared_path(case, &more), Ok(1));
        assert_eq!(shared_path(case, &format!("{more}[output]\nkeep_checkpoint = false\n")), Ok(1));
        for (there, here, why) in [
            (case, case, "the path has 1 segments there and no more here"),
            (&*more, case, "path.1.shear is 0.01 there and absent here"),
            (case, &*more.replace("0.3", "0.2"), "contact.friction is 0.3 there and 0.2 here"),
            (case, &*more.replace("0.02", "0.03"), "path.0.indentation is 0.02 there and 0.03 here"),
            ("]", &*more, "the case there is unreadable"),
        ] {
            assert_eq!(shared_path(there, here), Err(why.to_owned()));
        }
    }

    #[test]
    fn a_full_disk_is_told_as_what_it_is() {
        struct Full;
        impl Write for Full {
            fn write(&mut self, _: &[u8]) -> io::Result<usize> {
                Err(ErrorKind::StorageFull.into())
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        let mut out = SumWriter { out: &mut Full, sum: crc32fast::Hasher::new(), failed: None };
        assert!(postcard::to_io(&Ledger::default(), &mut out).is_err());
        assert_eq!(out.failed.map(|error| error.kind()), Some(ErrorKind::StorageFull));
    }
}
