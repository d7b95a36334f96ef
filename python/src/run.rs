//! Runs and studies.

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use asperity::session::{DeviceChoice, PrecisionChoice};
use asperity::study::{Shard, Study, StudyError, StudyProgress};
use asperity::{Canceller, Earlier, Options, SessionError, Simulation};
use pyo3::prelude::*;

use crate::arguments::{check_length, whole};
use crate::case::NativeCase;
use crate::errors::{failed, in_python, refused};
use crate::wait::{News, NewsSender, wait};

fn device(word: &str) -> PyResult<DeviceChoice> {
    match word {
        // As the program does where it has no option.
        "auto" => DeviceChoice::of_environment()
            .map_err(|value| refused(format!("ASPERITY_DEVICE={value}: is no device. Allowed: auto, cpu, gpu"))),
        "cpu" => Ok(DeviceChoice::Cpu),
        "gpu" => Ok(DeviceChoice::Gpu),
        other => Err(refused(format!("device: is {other:?}. Allowed: \"auto\", \"cpu\", \"gpu\""))),
    }
}

fn precision(word: &str) -> PyResult<PrecisionChoice> {
    match word {
        "auto" => Ok(PrecisionChoice::Auto),
        "f32" => Ok(PrecisionChoice::F32),
        "f64" => Ok(PrecisionChoice::F64),
        "mixed" => Ok(PrecisionChoice::Mixed),
        other => Err(refused(format!("precision: is {other:?}. Allowed: \"auto\", \"f32\", \"f64\", \"mixed\""))),
    }
}

/// All of the machine's, unless it is said how many.
fn threads(number: Option<&Bound<'_, PyAny>>) -> PyResult<NonZeroUsize> {
    let all = std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
    let most = all.get().max(256);
    let Some(number) = number else { return Ok(all) };
    let number = whole("threads", number, 1..=most, &format!("a number of threads from 1 to {most}"))?;
    Ok(NonZeroUsize::new(number).unwrap_or(all))
}

/// Simulates a case into a directory; gives the status, the message, and the exception that
/// interrupted it.
#[pyfunction]
#[pyo3(signature = (case, out, device, precision, threads, resume, extend, force, listener))]
#[allow(clippy::too_many_arguments)] // keywords in Python
pub fn run(
    py: Python<'_>,
    case: &NativeCase,
    out: PathBuf,
    device: &str,
    precision: &str,
    threads: Option<&Bound<'_, PyAny>>,
    resume: bool,
    extend: bool,
    force: bool,
    listener: Option<Py<PyAny>>,
) -> PyResult<(String, Option<String>, Option<PyErr>)> {
    let canceller = Canceller::default();
    let options = Options {
        device: self::device(device)?,
        precision: self::precision(precision)?,
        threads: Some(self::threads(threads)?),
        out: Some(out),
        earlier: match (force, resume, extend) {
            (true, false, false) => Earlier::Replace,
            (false, true, false) => Earlier::Resume,
            (false, false, true) => Earlier::Extend,
            (false, false, false) => Earlier::Keep,
            (false, true, true) => return Err(refused("extend: stands beside resume. Allowed: one of resume, extend and force")),
            (true, false, true) => return Err(refused("force: stands beside extend. Allowed: one of resume, extend and force")),
            (true, true, _) => return Err(refused("force: stands beside resume. Allowed: one of resume and force")),
        },
        canceller: canceller.clone(),
        ..Options::default()
    };
    let case = case.case.clone();
    let work = move |news: std::sync::mpsc::Sender<News>| -> Result<asperity::Outcome, SessionError> {
        let simulation = Simulation::with(&case, options)?;
        simulation.notes().iter().for_each(|note| drop(news.send(News::Message(note.clone()))));
        simulation.watched_by(Box::new(NewsSender(news))).run()
    };
    // The simulation has a pool of its own.
    let (outcome, raised) = wait(py, listener.as_ref(), &canceller, Some(NonZeroUsize::MIN), work)?;
    let outcome = outcome.map_err(|error| match error {
        SessionError::Case(_) => refused(error),
        error => failed(error),
    })?;
    let status = serde_json::to_value(outcome.status).map_err(failed)?;
    Ok((status.as_str().unwrap_or_default().to_owned(), outcome.message.map(in_python), raised))
}

/// Computes a study into a directory; gives the numbers of cases that are done, failed and pending,
/// the first failure, and the exception that interrupted it.
#[pyfunction]
#[pyo3(signature = (text, name, out, device, precision, threads, shard, resume, retry, force, quiet))]
#[allow(clippy::too_many_arguments, clippy::type_complexity)] // keywords in Python
pub fn study(
    py: Python<'_>,
    text: &str,
    name: &str,
    out: PathBuf,
    device: &str,
    precision: &str,
    threads: Option<&Bound<'_, PyAny>>,
    shard: Option<&str>,
    resume: bool,
    retry: bool,
    force: bool,
    quiet: bool,
) -> PyResult<((usize, usize, usize), Option<(String, String)>, Option<PyErr>)> {
    check_length("study", text)?;
    let study = Study::parse(text, name).map_err(refused)?;
    let options = asperity::study::Options {
        device: self::device(device)?,
        precision: self::precision(precision)?,
        threads: self::threads(threads)?.get(),
        shard: shard.map(str::parse::<Shard>).transpose().map_err(|error| refused(format!("shard: {error}")))?,
        resume,
        retry,
        force,
    };
    let stop = Arc::new(AtomicBool::new(false));
    let canceller = Canceller::on_signal(stop.clone());
    let progress = Arc::new(StudyProgress::new(quiet));
    let threads = NonZeroUsize::new(options.threads);
    let work = move |news: std::sync::mpsc::Sender<News>| {
        // Let go of when the work has ended, which is how that is noticed.
        let _news = news;
        asperity::study::run(&study, &out, &options, progress, stop)
    };
    let (report, raised) = wait(py, None, &canceller, threads, work)?;
    let report = report.map_err(|error| match error {
        StudyError::File(_) | StudyError::Combination { .. } => refused(error),
        error => failed(error),
    })?;
    Ok(((report.done, report.failed, report.pending), report.first_failure, raised))
}
