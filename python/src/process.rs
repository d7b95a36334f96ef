//! Threads of this process. A process that `fork` has made has none of the threads of its parent,
//! so a pool that was made there would wait for ever: each process makes its own.

use std::num::NonZeroUsize;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, PoisonError};

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::errors::failed;

/// Results and meshes of a thousand elements are on the heap, but the parser and the direct solver
/// recurse.
pub const STACK: usize = 16 << 20;

/// What is said of a panic.
pub const PANICKED: &str = "the computation panicked; this is a fault of the program, please report it";

/// The pool and the process that it is of.
///
/// It is locked only by a thread that has the interpreter, and never beyond that: no `fork` of
/// Python finds it locked.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// A pool of so many threads; without a number, of as many as the machine has.
pub fn new_pool(threads: Option<NonZeroUsize>) -> PyResult<ThreadPool> {
    let builder = ThreadPoolBuilder::new().thread_name(|_| "asperity".to_owned()).stack_size(STACK);
    let builder = builder.num_threads(threads.map_or(0, NonZeroUsize::get));
    builder.build().map_err(|error| failed(format!("no threads can be started: {error}. Free some, or use fewer")))
}

fn pool(_py: Python<'_>) -> PyResult<Arc<ThreadPool>> {
    let mut kept = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    if let Some((owner, pool)) = kept.as_ref()
        && *owner == process
    {
        return Ok(pool.clone());
    }
    let pool = Arc::new(new_pool(None)?);
    // Dropped, that of the parent would try to end its threads.
    std::mem::forget(kept.replace((process, pool.clone())));
    Ok(pool)
}

/// Does `work` on the threads of this process, while other threads of Python go on.
pub fn compute<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    let pool = pool(py)?;
    py.detach(|| catch_unwind(AssertUnwindSafe(|| pool.install(work)))).map_err(|_| failed(PANICKED))
}
