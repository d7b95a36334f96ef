//! Long work beside Python: the interpreter is free while it goes on, hears of its steps, and can
//! end it with Ctrl-C.

use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::Duration;

use asperity::Canceller;
use asperity::output::{Position, Progress};
use pyo3::prelude::*;

use crate::errors::failed;

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
pub struct Told(pub Sender<News>);

impl Progress for Told {
    fn step(&mut self, position: &Position) {
        // Nobody listens any more: the work goes on.
        let _ = self.0.send(News::Step(position.fraction, position.step, position.detail.clone()));
    }

    fn message(&mut self, text: &str) {
        let _ = self.0.send(News::Message(text.to_owned()));
    }

    fn finish(&mut self, _: &str) {}
}

/// Does `work` in a thread of its own. Meanwhile `listener` is called with the share that is
/// behind, the number of the step and a text (a message has the share -1). An exception of the
/// listener, or of a signal handler of Python (Ctrl-C), cancels the work; once that has ended it is
/// given beside the result.
pub fn wait<T: Send>(
    py: Python<'_>,
    listener: Option<&Py<PyAny>>,
    canceller: &Canceller,
    work: impl FnOnce(Sender<News>) -> T + Send,
) -> PyResult<(T, Option<PyErr>)> {
    let (sender, news) = channel();
    py.detach(move || {
        std::thread::scope(|scope| {
            // Results and meshes of a thousand elements are on the heap, but the parser and the
            // direct solver recurse.
            let worker = std::thread::Builder::new().name("asperity".to_owned()).stack_size(16 << 20);
            let worker = worker.spawn_scoped(scope, move || work(sender)).map_err(failed)?;
            let raised = listen(&news, listener, canceller);
            let result = worker
                .join()
                .map_err(|_| failed("the computation panicked; this is a fault of the program, please report it"))?;
            Ok((result, raised))
        })
    })
}

/// Until the work has let go of its sender.
fn listen(news: &Receiver<News>, listener: Option<&Py<PyAny>>, canceller: &Canceller) -> Option<PyErr> {
    let mut raised = None;
    loop {
        let received = news.recv_timeout(TICK);
        let heard = Python::attach(|py| {
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
        if let Err(error) = heard {
            canceller.cancel();
            raised.get_or_insert(error);
        }
        if matches!(received, Err(RecvTimeoutError::Disconnected)) {
            return raised;
        }
    }
}
