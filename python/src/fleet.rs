//! Fleets: rows as they are computed.

use std::io::{self, Write};
use std::path::PathBuf;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use trainsafe::findings::Stop;
use trainsafe::fleet::{self, Count, FleetError, ProgressTarget, Request};

use crate::analysis::options;
use crate::errors;
use crate::pool::pool;

/// What a run sends: lines of JSON, or its end.
enum Message {
    Lines(String),
    End(Result<Vec<String>, FleetError>),
}

/// A run under way.
#[pyclass(frozen, module = "trainsafe._native")]
pub struct FleetRun {
    messages: Mutex<Receiver<Message>>,
    stop: Stop,
    count: Arc<Mutex<Count>>,
    process: u32,
}

struct Sender(mpsc::SyncSender<Message>);

impl Write for Sender {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let text = String::from_utf8_lossy(bytes).into_owned();
        // Nobody reads any more: the run ends.
        self.0.send(Message::Lines(text)).map_err(|_| io::ErrorKind::BrokenPipe)?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[pymethods]
impl FleetRun {
    #[new]
    fn start(paths: Vec<PathBuf>, tolerance: f64, method: Option<&str>) -> PyResult<FleetRun> {
        let count = Arc::new(Mutex::new(Count { done: 0, failed: 0, total: 0 }));
        let seen = count.clone();
        let told = move |now: Count| {
            let mut seen = seen.lock().unwrap_or_else(PoisonError::into_inner);
            // Threads may report in another order than they count.
            if now.done >= seen.done {
                *seen = now;
            }
        };
        let options = options(tolerance, method)?;
        let stop = options.stop.clone();
        let request = Request { paths, options, progress: ProgressTarget::Call(Arc::new(told)), ..Request::default() };
        let (sender, messages) = mpsc::sync_channel(64);
        pool()?.spawn(move || {
            let done = fleet::stream(&request, &mut Sender(sender.clone()));
            let told = done.map(|outcome| outcome.notes.into_iter().chain(outcome.warnings).collect());
            let _ = sender.send(Message::End(told));
        });
        Ok(FleetRun { messages: Mutex::new(messages), stop, count, process: std::process::id() })
    }

    /// The next lines, or `None` if there are none within so many seconds; at the end the notes of the run.
    fn next(&self, py: Python<'_>, seconds: f64) -> PyResult<(Option<String>, Option<Vec<String>>)> {
        if self.process != std::process::id() {
            return Err(PyRuntimeError::new_err("a fleet run does not go on in another process"));
        }
        py.check_signals()?;
        let received = py.detach(|| {
            let messages = self.messages.lock().unwrap_or_else(PoisonError::into_inner);
            messages.recv_timeout(Duration::from_secs_f64(seconds.clamp(0.0, 1.0)))
        });
        match received {
            Ok(Message::Lines(lines)) => Ok((Some(lines), None)),
            Ok(Message::End(Ok(notes))) => Ok((None, Some(notes))),
            Ok(Message::End(Err(error))) => Err(errors::fleet(py, &error)),
            Err(RecvTimeoutError::Timeout) => Ok((None, None)),
            Err(RecvTimeoutError::Disconnected) => {
                Err(PyRuntimeError::new_err("an internal error of trainsafe; its message is on standard error"))
            }
        }
    }

    /// Cases that are done, that failed, and in all.
    fn count(&self) -> (u64, u64, u64) {
        let Count { done, failed, total } = *self.count.lock().unwrap_or_else(PoisonError::into_inner);
        (done, failed, total)
    }

    /// No further case is started.
    fn stop(&self) {
        self.stop.stop();
    }
}
