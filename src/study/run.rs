//! From a checked study to its directory: which cases there are to compute, on what, and their
//! rows.

use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use rayon::ThreadPool;

use super::StudyError;
use super::device::on_device;
use super::directory::{EarlierStudy, StudyDirectory};
use super::file::Study;
use super::id::directory_of;
use super::place::{Placed, alone, computed, earlier_results, join};
use super::progress::StudyProgress;
use super::room::at_a_time;
use super::row::{Row, RowStatus, write_table};
use super::schedule::{Finished, in_order, pools, side_by_side};
use super::shard::{Shard, by_descending_cost, cost};
use super::simulate::Simulator;
use crate::case::{Case, Linear};
use crate::compute::select::{DeviceChoice, Devices, PrecisionChoice, Selected, select};
use crate::memory;
use crate::output::{OutputDirectory, Summary, TaskLock};
use crate::simulation::follow::seats;
use crate::simulation::problem::Problem;

/// How a study is to be computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Where the kernels run.
    pub device: DeviceChoice,
    /// Their precision.
    pub precision: PrecisionChoice,
    /// Cores to use: that many cases side by side. Where a device serves them it is twice as many,
    /// or 256 where it solves their linear systems too.
    pub threads: usize,
    /// Only this share of the cases.
    pub shard: Option<Shard>,
    /// Go on in a directory that has results of this study.
    pub resume: bool,
    /// When going on, compute also those cases again that did not converge or outgrew their mesh:
    /// the same program would do the same again, another version may not.
    pub retry: bool,
    /// Replace results that are there.
    pub force: bool,
}

/// What became of the cases that were asked for: all, or those of the share.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Report {
    /// Computed to the end, now or before.
    pub done: usize,
    /// Ended, but not well.
    pub failed: usize,
    /// Still to be computed.
    pub pending: usize,
    /// Of the other shares, still to be computed.
    pub pending_elsewhere: usize,
    /// Why the first of those is that has something to say, that somebody else computes it for
    /// instance.
    pub pending_reason: Option<String>,
    /// Number of the first case that failed, and why.
    pub first_failure: Option<(String, String)>,
}

/// Most cases that share a device at a time.
const LARGEST_BATCH: usize = 256;

/// Computes a study into `dir`: a directory a case, and `study.csv`, which is written anew as cases
/// end.
///
/// Cases that are done are not computed again if `resume` is set, or another share ran here before;
/// a case is done if its `case.toml` is the very case and its `summary.json` says so. Cases that
/// broke off or were interrupted go on from their checkpoint; those that did not converge or
/// outgrew their mesh, only with `retry`. A case that fails is a row with its reason and stops no
/// other. Once `stop` is set, running cases end after their step and no other begins.
///
/// # Errors
/// Before anything is computed: [`StudyError::NotADirectory`], [`StudyError::NotAStudy`],
/// [`StudyError::OtherStudy`], [`StudyError::Directory`], [`StudyError::Compute`] if a GPU was
/// asked for and there is none, [`StudyError::Threads`]. Then only [`StudyError::BrokeOff`]:
/// `study.csv` cannot be written.
pub fn run(
    study: &Study,
    dir: &Path,
    options: &Options,
    progress: Arc<StudyProgress>,
    stop: Arc<AtomicBool>,
) -> Result<Report, StudyError> {
    run_on(&Devices::open(options.device)?, study, dir, options, (progress, stop))
}

/// As [`run`], on a device that was opened (or not) by the caller.
///
/// # Errors
/// As [`run`].
pub(crate) fn run_on(
    devices: &Devices,
    study: &Study,
    dir: &Path,
    options: &Options,
    (progress, stop): (Arc<StudyProgress>, Arc<AtomicBool>),
) -> Result<Report, StudyError> {
    study.doubts().iter().for_each(|(id, doubt)| progress.message(id, &format!("note: {doubt}")));
    let directory = &StudyDirectory::new(dir);
    let costs: Vec<f64> = study.cases.iter().map(|case| cost(&case.case)).collect();
    let share = options.shard.map_or_else(|| (0..study.cases.len()).collect(), |shard| shard.of(&costs));
    let done =
        |case: usize| options.resume && Row::read(&study.cases[case].case, &directory.case(&study.cases[case].id)).is_done();
    study.check_room(|case| share.binary_search(&case).is_ok() && !done(case))?;
    let Concurrency { count, short } = Concurrency::of(study, &share, devices.is_there(), options.threads);
    let pools = pools(count)?;
    memory::side_by_side(count);
    let PreparedStudy { study, mut rows, lock } = begin_share(directory, study, options, &share)?;
    let (study, lock) = (&study, &lock);
    let open = |row: &Row| match row.status {
        RowStatus::Done => false,
        RowStatus::Pending | RowStatus::Failed => true,
        RowStatus::NotConverged | RowStatus::Outgrown => options.retry,
    };
    let to_compute: Vec<usize> = share.iter().copied().filter(|&case| open(&rows[case])).collect();
    to_compute.iter().for_each(|&case| rows[case] = Row::pending());

    let before = Report::of(study, &rows, &share);
    progress.begin(
        &(headline(study, options, to_compute.len(), &before, pools.len()) + &short),
        &costs,
        &to_compute,
        before.done,
        before.failed,
    );
    let order: Vec<usize> =
        by_descending_cost(&costs).into_iter().filter(|case| to_compute.binary_search(case).is_ok()).collect();
    let simulator = Simulator {
        cases: &study.cases,
        directory,
        lock,
        progress: progress.clone(),
        stop: stop.clone(),
        resume: options.resume,
        locks: Mutex::default(),
    };
    let mut table = TableWriter { study, directory, lock, rows, written: Instant::now(), took: Duration::ZERO };
    let computed = compute(&simulator, (devices, options.precision), &pools, &order, &mut table);
    progress.end();
    // Another process may have computed other shares in the meantime.
    for (case, found) in read_rows(study, directory).into_iter().enumerate() {
        if share.binary_search(&case).is_err() {
            table.rows[case] = found;
        }
    }
    let broke_off = |source| StudyError::BrokeOff { source: Box::new(source), dir: dir.to_owned() };
    computed.and_then(|()| table.write()).map_err(broke_off)?;
    Ok(Report::of(study, &table.rows, &share))
}

/// How many cases of a share are computed side by side.
struct Concurrency {
    count: usize,
    /// Why they are no more, where memory is what there is too little of.
    short: String,
}

impl Concurrency {
    /// On a device or on so many threads.
    fn of(study: &Study, share: &[usize], device: bool, threads: usize) -> Self {
        // Over a plane the device does nearly all of the work, and the threads of the cases wait
        // for it; the linear systems of two bodies, those that are to be solved directly, and the
        // vectors of a plate that leaves the x axis, turns or widens, take the cores.
        let plain = |case: &Case| case.moves_along_x() && case.sphere.equator.is_clamped();
        let there = |case: &Case| case.opponent.is_none() && case.solver.linear == Linear::Multigrid && plain(case);
        let alone = study.cases.iter().all(|case| there(&case.case));
        let most = match (device, alone) {
            (true, true) => LARGEST_BATCH,
            (true, false) => (2 * threads).clamp(1, LARGEST_BATCH),
            (false, _) => threads.max(1),
        };
        let wanted = most.min(share.len());
        // What the host holds of a case whose linear systems are on a device is small, and how many
        // of those there are is for the device to say.
        if device && alone {
            return Self { count: wanted, short: String::new() };
        }
        let room = memory::room();
        let count = at_a_time(share.iter().map(|&case| &study.cases[case].case), wanted, &room);
        let short =
            if count < wanted { format!(", not {wanted}: there is memory for no more, of {room}") } else { String::new() };
        Self { count, short }
    }
}

/// Prepares the folder of a study of which a share is to be computed, and tidies after those cases
/// of it that are done.
fn begin_share(
    directory: &StudyDirectory,
    study: &Study,
    options: &Options,
    share: &[usize],
) -> Result<PreparedStudy, StudyError> {
    let earlier = match (options.resume || options.shard.is_some(), options.force) {
        // Shares run into one directory, side by side or one after the other: what the others left
        // stays.
        (true, _) => EarlierStudy::Keep,
        (false, true) => EarlierStudy::Replace,
        (false, false) => EarlierStudy::Refuse,
    };
    let begun = begin(directory, study, earlier, |study, rows| {
        let there = |&case: &usize| Some(directory.case(&study.cases[case].id)).filter(OutputDirectory::holds_result);
        let computed: Vec<_> = share.iter().filter_map(|case| computed(&there(case)?)).collect();
        if !options.resume && !options.force && !computed.is_empty() {
            return Err(earlier_results(directory, &computed));
        }
        if !options.resume {
            share.iter().for_each(|&case| rows[case] = Row::pending());
        }
        Ok(())
    })?;
    for &case in share.iter().filter(|&&case| begun.rows[case].status == RowStatus::Done) {
        // Killed just before its checkpoint was removed; what cannot be removed does no harm.
        let _ = directory.case(&begun.study.cases[case].id).tidy(false, false);
    }
    Ok(begun)
}

/// Computes cases in an order, and puts the row of each that ends into the table.
fn compute(
    simulator: &Simulator<'_>,
    on: (&Devices, PrecisionChoice),
    pools: &[ThreadPool],
    order: &[usize],
    table: &mut TableWriter<'_>,
) -> Result<(), StudyError> {
    let mut finished = |case: usize, result: Result<Summary, String>| {
        let fault = |what| format!("the program panicked: {what}. This is a fault of the program, please report it");
        let row = Row::of(result.unwrap_or_else(|what| simulator.broke_off(case, &fault(what))));
        simulator.release(case);
        simulator.progress.finished(case, &simulator.cases[case].id, &row);
        table.rows[case] = row;
        table.write_if_due()
    };
    if on.0.is_there() {
        on_device(simulator, on, pools, order, &mut finished)
    } else {
        on_cores(simulator, on, pools, order, &mut finished)
    }
}

/// A study whose folder is prepared.
pub(super) struct PreparedStudy {
    /// With the names of the directories of its cases.
    pub study: Study,
    /// How they stand.
    pub rows: Vec<Row>,
    /// To be kept as long as it is worked on.
    pub lock: TaskLock,
}

/// Prepares the folder of a study, several processes one after the other: where its cases are, how
/// they stand, what `adjust` makes of that, and the table and the study's copy, from which the
/// others know it too.
pub(super) fn begin(
    directory: &StudyDirectory,
    study: &Study,
    earlier: EarlierStudy,
    adjust: impl FnOnce(&Study, &mut Vec<Row>) -> Result<(), StudyError>,
) -> Result<PreparedStudy, StudyError> {
    let mut made = None;
    if !directory.root().exists() {
        let failed = |source| StudyError::Directory { dir: directory.root().to_owned(), what: "be created", source };
        std::fs::create_dir_all(directory.root()).map_err(failed)?;
        made = Some(directory.root());
    }
    let begun = (|| {
        // A folder of the user's own is refused before anything is written to it.
        directory.recognise()?;
        let _alone = alone(directory)?;
        let lock = join(directory, study, earlier != EarlierStudy::Keep)?;
        let Placed { study, strangers, begun } = directory.prepare(study, earlier)?;
        let mut rows = read_rows(&study, directory);
        adjust(&study, &mut rows)?;
        write_table(&directory.table(), &study, &rows)?;
        directory.write_study(&study)?;
        if !strangers.is_empty() {
            let names: Vec<String> = strangers.iter().take(10).map(|id| directory_of(id)).collect();
            let more = if strangers.len() > names.len() { ", ..." } else { "" };
            log::warn!(
                "{} of the cases in {} do not belong to this study any more and are left as they are: {}{more}; {begun} do",
                strangers.len(),
                directory.root().display(),
                names.join(", ")
            );
        }
        Ok(PreparedStudy { study, rows, lock })
    })();
    if let (Err(_), Some(root)) = (&begun, made) {
        // A folder in which there is something is not removed.
        let _ = std::fs::remove_dir(root);
    }
    begun
}

/// Prepares the folder of a study that others will compute: its table, and its copy.
///
/// # Errors
/// As [`run`], before anything is computed.
pub fn prepare(study: &Study, dir: &Path) -> Result<(), StudyError> {
    begin(&StudyDirectory::new(dir), study, EarlierStudy::Keep, |_, _| Ok(())).map(drop)
}

impl Report {
    pub(super) fn of(study: &Study, rows: &[Row], share: &[usize]) -> Self {
        let count = |wanted: &dyn Fn(&Row) -> bool| share.iter().filter(|&&case| wanted(&rows[case])).count();
        let pending = count(&|row| row.status == RowStatus::Pending);
        let failure = share.iter().find(|&&case| rows[case].has_failed());
        Self {
            done: count(&|row| row.status == RowStatus::Done),
            failed: count(&Row::has_failed),
            pending,
            pending_elsewhere: rows.iter().filter(|row| row.status == RowStatus::Pending).count() - pending,
            pending_reason: share
                .iter()
                .filter(|&&case| rows[case].status == RowStatus::Pending)
                .find_map(|&case| Some(rows[case].reason.clone()).filter(|reason| !reason.is_empty())),
            first_failure: failure.map(|&case| (study.cases[case].id.clone(), rows[case].reason.clone())),
        }
    }
}

fn headline(study: &Study, options: &Options, to_compute: usize, before: &Report, side_by_side: usize) -> String {
    let mut text = study.size();
    if let Some(Shard { index, count }) = options.shard {
        text += &format!("; share {index}/{count}");
    }
    if before.done + before.failed > 0 {
        text += &format!("; {} done and {} failed before", before.done, before.failed);
    }
    text + &format!("; {to_compute} to compute, {side_by_side} at a time")
}

pub(super) fn read_rows(study: &Study, directory: &StudyDirectory) -> Vec<Row> {
    study.cases.iter().map(|case| Row::read(&case.case, &directory.case(&case.id))).collect()
}

/// Writes `study.csv` as cases end, but spends no more than a few per cent of the time on it,
/// however long it is.
struct TableWriter<'a> {
    study: &'a Study,
    directory: &'a StudyDirectory,
    lock: &'a TaskLock,
    rows: Vec<Row>,
    written: Instant,
    took: Duration,
}

impl TableWriter<'_> {
    /// Not where the folder was removed or moved in the meantime: a table without its cases would
    /// be of no use.
    fn write(&self) -> Result<(), StudyError> {
        self.lock.check_there()?;
        write_table(&self.directory.table(), self.study, &self.rows)
    }

    fn write_if_due(&mut self) -> Result<(), StudyError> {
        if self.written.elapsed() >= 20 * self.took {
            let begun = Instant::now();
            self.write()?;
            (self.written, self.took) = (Instant::now(), begun.elapsed());
        }
        Ok(())
    }
}

/// Every case on a core of its own.
fn on_cores(
    simulator: &Simulator<'_>,
    (devices, precision): (&Devices, PrecisionChoice),
    pools: &[ThreadPool],
    order: &[usize],
    finished: &mut Finished<'_>,
) -> Result<(), StudyError> {
    let compute = |case: usize| -> Result<Summary, StudyError> {
        simulator.begin(case)?;
        if let Some(summary) = simulator.done_meanwhile(case) {
            return Ok(summary);
        }
        let problem = simulator.problem(case)?;
        let open = |problem: &Problem| select(DeviceChoice::Cpu, precision, vec![problem.model.clone()]);
        let Selected { backend, notes } = open(&problem)?;
        let computed_on = backend.about().description;
        let mut seat = seats((backend, 0), problem.zone, open);
        simulator.follow(case, problem, &mut seat, computed_on, &[devices.notes(), &notes].concat())
    };
    let work = |case: usize| {
        simulator.progress.started();
        Some(compute(case).unwrap_or_else(|error| simulator.broke_off(case, &error.to_string())))
    };
    side_by_side(pools, in_order(order), &simulator.stop, |_, case| work(case), finished)
}
