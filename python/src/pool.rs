//! Work on this package's own threads: Ctrl-C interrupts it, and it goes on after a fork.

use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use trainsafe::findings::Stop;

/// Time between looks for Ctrl-C.
const LOOK: Duration = Duration::from_millis(50);

/// The threads, and the process that started them. Only a thread with the GIL locks it, so no fork finds it locked.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// The threads of this process. After a fork those of the parent do not exist, and new ones are started.
pub fn pool() -> PyResult<Arc<ThreadPool>> {
    let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    match pool.take() {
        Some((owner, threads)) if owner == process => *pool = Some((owner, threads)),
        // To drop it would wait for threads that are not there.
        Some((_, threads)) => std::mem::forget(threads),
        None => {}
    }
    if pool.is_none() {
        // Whoever waits for a thread that has panicked learns of it from the channel.
        let threads = ThreadPoolBuilder::new().panic_handler(|_| {}).build();
        let threads = threads.map_err(|e| PyRuntimeError::new_err(format!("threads cannot be started: {e}")))?;
        *pool = Some((process, Arc::new(threads)));
    }
    let threads = pool.as_ref().map(|(_, threads)| threads.clone());
    threads.ok_or_else(|| PyRuntimeError::new_err("there are no threads"))
}

/// Does work on those threads while other Python threads run. On Ctrl-C `stop` is set, and `KeyboardInterrupt` raised at once: what
/// is under way ends on its own.
pub fn work<T: Send + 'static>(py: Python<'_>, stop: &Stop, work: impl FnOnce() -> T + Send + 'static) -> PyResult<T> {
    let (done, wait) = mpsc::sync_channel(1);
    pool()?.spawn(move || {
        // After Ctrl-C nobody receives it.
        let _ = done.send(work());
    });
    let mut wait = wait;
    loop {
        let (result, again) = py.detach(move || (wait.recv_timeout(LOOK), wait));
        wait = again;
        match result {
            Ok(value) => return Ok(value),
            Err(RecvTimeoutError::Timeout) => py.check_signals().inspect_err(|_| stop.stop())?,
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err(
                    "an internal error of trainsafe; its message is on standard error",
                ));
            }
        }
    }
}
