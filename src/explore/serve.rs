//! The server: a listener on the loopback address, a fixed number of threads that answer, and the
//! rules by which it ends.

use std::io;
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::answer::{HttpAnswer, HttpStatus};
use super::request::{Gate, HttpMethod, HttpRequest};

/// Threads that answer. Browsers open connections beforehand and say nothing on them for a while;
/// so there are more threads than cores.
const THREADS: usize = 8;
/// Connections that wait for one of them; more of them wait in the system's own queue.
const WAITING: usize = 64;
/// How often it is looked at whether to end.
const BEAT: Duration = Duration::from_millis(50);

/// Answers requests that may be answered.
pub trait Service: Send + Sync + 'static {
    /// The answer.
    fn answer(&self, request: &HttpRequest) -> HttpAnswer;
}

/// Why the server has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// It was told to.
    Stopped,
    /// Nobody has asked anything for so long.
    Idle,
}

/// A server that listens and does not answer yet.
pub struct Server {
    listener: TcpListener,
    gate: Gate,
}

impl Server {
    /// Listens on a port of the loopback address, 0 for any that is free. Who may ask has to know
    /// `token`.
    ///
    /// # Errors
    /// What the system says: the port is taken.
    pub fn bind(port: u16, token: String) -> io::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        let port = listener.local_addr()?.port();
        Ok(Self { listener, gate: Gate::new(token, port) })
    }

    /// The address that opens the page.
    pub fn address(&self) -> String {
        self.gate.address()
    }

    /// Answers until `stop` is set or nobody has asked for `idle`.
    ///
    /// # Errors
    /// The system gives no threads.
    pub fn run(self, service: &Arc<impl Service>, stop: &AtomicBool, idle: Duration) -> io::Result<End> {
        let begun = Instant::now();
        // Milliseconds from the start to the last request that was answered.
        let last = Arc::new(AtomicU64::new(0));
        let (hand_over, waiting) = sync_channel::<TcpStream>(WAITING);
        let waiting = Arc::new(Mutex::new(waiting));
        for number in 0..THREADS {
            let (service, gate, waiting, last) =
                (Arc::clone(service), self.gate.clone(), Arc::clone(&waiting), Arc::clone(&last));
            let work = move || {
                while let Some(mut stream) = next(&waiting) {
                    if respond(&mut stream, &gate, service.as_ref()) {
                        last.store(millis(begun), Ordering::Relaxed);
                    }
                }
            };
            std::thread::Builder::new().name(format!("answers {number}")).spawn(work)?;
        }
        let listener = self.listener;
        std::thread::Builder::new().name("listens".to_owned()).spawn(move || listen(&listener, &hand_over))?;
        loop {
            if stop.load(Ordering::Relaxed) {
                return Ok(End::Stopped);
            }
            if Duration::from_millis(millis(begun) - last.load(Ordering::Relaxed).min(millis(begun))) >= idle {
                return Ok(End::Idle);
            }
            std::thread::sleep(BEAT);
        }
    }
}

fn millis(begun: Instant) -> u64 {
    u64::try_from(begun.elapsed().as_millis()).unwrap_or(u64::MAX)
}

/// Takes connections for as long as the process lives. Where none of the threads has time, it takes
/// no more until one has.
fn listen(listener: &TcpListener, hand_over: &SyncSender<TcpStream>) {
    loop {
        match listener.accept() {
            Ok((stream, _)) => {
                if hand_over.send(stream).is_err() {
                    return;
                }
            }
            // No more files, or the other side has gone already: it may be otherwise in a moment.
            Err(_) => std::thread::sleep(BEAT),
        }
    }
}

fn next(waiting: &Mutex<Receiver<TcpStream>>) -> Option<TcpStream> {
    waiting.lock().unwrap_or_else(PoisonError::into_inner).recv().ok()
}

/// Answers one connection; whether it was a request that may be answered.
fn respond(stream: &mut TcpStream, gate: &Gate, service: &impl Service) -> bool {
    let _ = stream.set_nodelay(true);
    match gate.receive(stream) {
        None => false,
        Some(Err(refusal)) => {
            refusal.send(stream, true);
            false
        }
        Some(Ok(request)) => {
            // One request that goes wrong is not to take a thread with it.
            let answered = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| service.answer(&request)));
            let broken = "asperity explore: this request has met a fault of the program; please report it with the address.\n";
            let answer = answered.unwrap_or_else(|_| HttpAnswer::plain(HttpStatus::Broken, broken));
            answer.send(stream, request.method != HttpMethod::Head);
            true
        }
    }
}
