//! Long work beside Python: the interpreter is free while it goes on, hears of its steps, and can
//! end it with Ctrl-C.

use std::num::NonZeroUsize;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::Duration;

use asperity::Canceller;
use asperity::output::{Position, Progress};
use pyo3::prelude::*;

use crate::errors::failed;
use crate::process::{PANICKED, STACK, new_pool};

/// How often Python is asked for signals.
const TICK: Duration = Duration::from_millis(50);

/// What the work tells.
pub enum News {
    /// Share of the path that is behind, number of the step, and a line of text.
    Step(f64, usize, String),
    /// A note for the user.
    Message(String),
}

/// Hands progress on to the thread that waits.
pub struct NewsSender(pub Sender<News>);

impl Progress for NewsSender {
    fn step(&mut self, position: &Position) {
        // Nobody listens any more: the work goes on.
        let _ = self.0.send(News::Step(position.fraction, position.step, position.detail.clone()));
    }

    fn message(&mut self, text: &str) {
        let _ = self.0.send(News::Message(text.to_owned()));
    }

    fn finish(&mut self, _: &str) {}
}

/// How the waiting has ended.
enum Heard {
    /// The work has let go of its sender; an exception may have cancelled it.
    Ended(Option<PyErr>),
    /// The listener has called `fork`, and this is the child, which has no thread that works.
    InChild,
}

/// Does `work` in a thread of its own, with so many threads at hand (without a number, all of the
/// machine's). Meanwhile `listener` is called with the share that is behind, the number of the step
/// and a text (a message has the share -1). An exception of the listener, or of a signal handler of
/// Python (Ctrl-C), cancels the work; once that has ended it is given beside the result.
pub fn wait<T: Send + 'static>(
    py: Python<'_>,
    listener: Option<&Py<PyAny>>,
    canceller: &Canceller,
    threads: Option<NonZeroUsize>,
    work: impl FnOnce(Sender<News>) -> T + Send + 'static,
) -> PyResult<(T, Option<PyErr>)> {
    let pool = new_pool(threads)?;
    let (sender, news) = channel();
    py.detach(move || {
        // Not a scoped one: that could not be left in a child of `fork`.
        let worker = std::thread::Builder::new().name("asperity".to_owned()).stack_size(STACK);
        let worker = worker.spawn(move || pool.install(|| work(sender))).map_err(failed)?;
        match listen(&news, listener, canceller) {
            Heard::Ended(raised) => {
                let result = worker.join().map_err(|_| failed(PANICKED))?;
                Ok((result, raised))
            }
            Heard::InChild => {
                std::mem::forget((worker, news));
                Err(failed("the process was forked while it told of its progress: the computation goes on in the parent alone"))
            }
        }
    })
}

/// Until the work has let go of its sender.
fn listen(news: &Receiver<News>, listener: Option<&Py<PyAny>>, canceller: &Canceller) -> Heard {
    let process = std::process::id();
    let mut raised = None;
    loop {
        let received = news.recv_timeout(TICK);
        let heard = Python::try_attach(|py| {
            match (&received, listener) {
                (Ok(News::Step(share, step, text)), Some(listener)) if raised.is_none() => {
                    listener.call1(py, (*share, *step, text.as_str()))?;
                }
                (Ok(News::Message(text)), Some(listener)) if raised.is_none() => {
                    listener.call1(py, (-1.0, 0, text.as_str()))?;
                }
                _ => {}
            }
            py.check_signals()
        });
        if std::process::id() != process {
            return Heard::InChild;
        }
        match heard {
            Some(Ok(())) => {}
            Some(Err(error)) => {
                canceller.cancel();
                raised.get_or_insert(error);
            }
            None => leave(canceller),
        }
        if matches!(received, Err(RecvTimeoutError::Disconnected)) {
            return Heard::Ended(raised);
        }
    }
}

/// The interpreter is closing, and this thread, a daemon's, must not go back to it: what was
/// computed stays, as after Ctrl-C, and the thread ends with the process.
fn leave(canceller: &Canceller) -> ! {
    canceller.cancel();
    loop {
        std::thread::park();
    }
}
