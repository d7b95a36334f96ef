//! Cases side by side: one thread a case, each with a pool of one thread, so that a case has one
//! core and its results cannot depend on how many run.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;

use rayon::{ThreadPool, ThreadPoolBuilder};

use super::StudyError;
use crate::output::Summary;

/// Hears of a case that has ended.
pub type Finished<'a> = dyn FnMut(usize, Result<Summary, String>) -> Result<(), StudyError> + 'a;

/// `count` pools of one thread each.
///
/// # Errors
/// [`StudyError::Threads`].
pub fn pools(count: usize) -> Result<Vec<ThreadPool>, StudyError> {
    let threads = |error: &dyn std::fmt::Display| StudyError::Threads { threads: count, what: error.to_string() };
    (0..count).map(|_| ThreadPoolBuilder::new().num_threads(1).build().map_err(|error| threads(&error))).collect()
}

/// Gives out the jobs of `order`, the first ones first, whoever asks.
pub fn in_order(order: &[usize]) -> impl Fn(usize) -> Option<usize> + Sync {
    let next = AtomicUsize::new(0);
    move |_| order.get(next.fetch_add(1, Ordering::Relaxed)).copied()
}

/// Does jobs, a worker in each pool: worker w does `work(w, job)` with what `next(w)` says, up to
/// when that is nothing. `finished` hears of each, in this thread, as it ends: its result, or what
/// it said when it panicked. A job of which `work` makes nothing is left to others, and its worker
/// does no more. Once `stop` is set no job is begun; an error of `finished` sets it.
///
/// # Errors
/// The first error of `finished`; [`StudyError::Threads`].
pub fn side_by_side<T: Send>(
    pools: &[ThreadPool],
    next: impl Fn(usize) -> Option<usize> + Sync,
    stop: &AtomicBool,
    work: impl Fn(usize, usize) -> Option<T> + Sync,
    mut finished: impl FnMut(usize, Result<T, String>) -> Result<(), StudyError>,
) -> Result<(), StudyError> {
    let (tell, results) = mpsc::channel();
    let worker = |index: usize, pool: &ThreadPool, tell: mpsc::Sender<(usize, Result<T, String>)>| {
        while !stop.load(Ordering::Relaxed)
            && let Some(job) = next(index)
        {
            // What a panicked job leaves behind is its own: nobody looks at it again.
            let done = catch_unwind(AssertUnwindSafe(|| pool.install(|| work(index, job))));
            let result = match done {
                Ok(None) => break,
                Ok(Some(result)) => Ok(result),
                Err(panic) => Err(words(panic.as_ref())),
            };
            if tell.send((job, result)).is_err() {
                break;
            }
        }
    };
    std::thread::scope(|scope| {
        let mut outcome = Ok(());
        for (index, pool) in pools.iter().enumerate() {
            let (tell, worker) = (tell.clone(), &worker);
            let spawned = std::thread::Builder::new().spawn_scoped(scope, move || worker(index, pool, tell));
            if let Err(error) = spawned {
                stop.store(true, Ordering::Relaxed);
                outcome = Err(StudyError::Threads { threads: pools.len(), what: error.to_string() });
            }
        }
        drop(tell);
        for (job, result) in results {
            if let Err(error) = finished(job, result) {
                stop.store(true, Ordering::Relaxed);
                outcome = outcome.and(Err(error));
            }
        }
        outcome
    })
}

/// What a panic said.
fn words(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned()).or_else(|| panic.downcast_ref::<String>().cloned());
    text.unwrap_or_else(|| "without a word".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_job_is_done_once_in_its_own_single_thread() {
        let (pools, stop) = (pools(3).unwrap(), AtomicBool::new(false));
        let order: Vec<usize> = (0..20).rev().collect();
        let mut seen = Vec::new();
        let work = |_, job| Some((job * job, rayon::current_num_threads()));
        side_by_side(&pools, in_order(&order), &stop, work, |job, result| {
            assert_eq!(result, Ok((job * job, 1)));
            seen.push(job);
            Ok(())
        })
        .unwrap();
        seen.sort_unstable();
        assert_eq!(seen, (0..20).collect::<Vec<_>>());
    }

    #[test]
    fn a_panic_is_a_result_like_any_other() {
        let (pools, stop) = (pools(2).unwrap(), AtomicBool::new(false));
        let mut failed = Vec::new();
        let work = |_, job| {
            assert!(job != 2, "job {job} is bad");
            Some(job)
        };
        side_by_side(&pools, in_order(&[0, 1, 2, 3, 4]), &stop, work, |job, result| {
            failed.extend(result.err().map(|what| (job, what)));
            Ok(())
        })
        .unwrap();
        assert_eq!(failed, [(2, "job 2 is bad".to_owned())]);
    }

    #[test]
    fn a_worker_that_makes_nothing_of_a_job_leaves_it_and_does_no_more() {
        let (pools, stop) = (pools(2).unwrap(), AtomicBool::new(false));
        let asked = [AtomicUsize::new(0), AtomicUsize::new(0)];
        let next = |worker: usize| Some(asked[worker].fetch_add(1, Ordering::Relaxed)).filter(|job| *job < 5);
        let mut heard = Vec::new();
        let work = |worker, job| (worker == 0 || job < 2).then_some(worker);
        side_by_side(&pools, next, &stop, work, |job, result| {
            heard.push((result.unwrap(), job));
            Ok(())
        })
        .unwrap();
        heard.sort_unstable();
        assert_eq!(heard, [(0, 0), (0, 1), (0, 2), (0, 3), (0, 4), (1, 0), (1, 1)]);
    }

    #[test]
    fn an_error_of_the_listener_stops_the_rest() {
        let (pools, stop) = (pools(1).unwrap(), AtomicBool::new(false));
        let mut heard = 0;
        let failing = |_, _| {
            heard += 1;
            Err(StudyError::Threads { threads: 1, what: "test".to_owned() })
        };
        let slow = |_, job| {
            std::thread::sleep(std::time::Duration::from_millis(20));
            Some(job)
        };
        assert!(side_by_side(&pools, in_order(&(0..100).collect::<Vec<_>>()), &stop, slow, failing).is_err());
        assert!(stop.load(Ordering::Relaxed) && heard < 50, "{heard}");
    }
}
