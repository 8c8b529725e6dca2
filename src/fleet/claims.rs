//! Who computes which chunk: workers that share a folder, and may come, go and be killed.
//!
//! A claim is a file that only one worker can make; it stays until the run is joined. A worker writes a file of its own every few
//! seconds, and the claims of one that has not done so for a while may be taken. All times are those that the file
//! system gave, so the machines' clocks may differ. Two workers that compute the same chunk write the same bytes: a
//! worker that was only suspended costs time, and changes no result.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::JoinHandle;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use super::parts;
use crate::report::files::{self, WriteError};

/// Time between two signs of life of a worker.
const SIGN: Duration = Duration::from_secs(5);

/// A worker without a sign of life for so long is taken for dead.
const STALE: Duration = Duration::from_secs(30);

/// The claim on making the plan.
pub const PLAN: &str = "plan";

const CLAIM: &str = "claim";
const ALIVE: &str = "alive";

/// The unique name under which a process takes chunks.
#[derive(Clone, Debug)]
pub struct Worker(String);

impl Worker {
    /// The machine, the process and the time.
    #[allow(clippy::new_without_default)] // Each is unique.
    pub fn new() -> Worker {
        let machine = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
        let plain: String = machine.trim().chars().filter(|c| c.is_ascii_alphanumeric() || *c == '-').collect();
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        Worker(format!("{plain}-{}-{:x}", std::process::id(), since.as_nanos()))
    }

    /// Gives up its unfinished chunks in a folder.
    pub fn leave(&self, dir: &Path) {
        // A sign that stays is stale in half a minute.
        let _ = fs::remove_file(self.sign(&parts::folder(dir)));
    }

    fn sign(&self, folder: &Path) -> PathBuf {
        folder.join(format!("{}.{ALIVE}", self.0))
    }
}

/// A worker in a folder, alive until it is dropped.
pub struct Claims {
    folder: PathBuf,
    worker: Worker,
    /// Ends the thread if dropped.
    sign_thread: Option<(Sender<()>, JoinHandle<()>)>,
}

impl Claims {
    /// Enters a worker in the folder of a run's parts, made if need be.
    ///
    /// # Errors
    /// [`WriteError`] with the path.
    pub fn enter(dir: &Path, worker: &Worker) -> Result<Claims, WriteError> {
        let folder = parts::folder(dir);
        fs::create_dir_all(&folder).map_err(|e| WriteError::new(&folder, e))?;
        let (sign, name) = (worker.sign(&folder), worker.0.clone());
        fs::write(&sign, &name).map_err(|e| WriteError::new(&sign, e))?;
        let (sender, end) = mpsc::channel();
        let thread = std::thread::spawn(move || {
            while let Err(RecvTimeoutError::Timeout) = end.recv_timeout(SIGN) {
                // If it fails, the next one follows.
                let _ = fs::write(&sign, &name);
            }
        });
        Ok(Claims { folder, worker: worker.clone(), sign_thread: Some((sender, thread)) })
    }

    /// Takes what no live worker has; whether it is this worker's now.
    ///
    /// # Errors
    /// [`WriteError`] with the path.
    pub fn take(&self, what: &str) -> Result<bool, WriteError> {
        let path = claim(&self.folder, what);
        match File::options().write(true).create_new(true).open(&path) {
            Ok(mut file) => {
                file.write_all(self.worker.0.as_bytes()).map_err(|e| WriteError::new(&path, e))?;
                Ok(true)
            }
            Err(e) if e.kind() != io::ErrorKind::AlreadyExists => Err(WriteError::new(&path, e)),
            Err(_) if !self.is_stale(&path) => Ok(false),
            Err(_) => {
                let name = format!("{what}.{CLAIM}");
                files::write_into(&self.folder, &[(name, self.worker.0.clone().into_bytes())])?;
                // Of several that take it at the same time the last one has it.
                Ok(fs::read(&path).is_ok_and(|owner| owner == self.worker.0.as_bytes()))
            }
        }
    }

    /// Lets others take it at once.
    pub fn release(&self, what: &str) {
        let _ = fs::remove_file(claim(&self.folder, what));
    }

    /// Whether the worker that made a claim has shown no sign of life for long.
    fn is_stale(&self, path: &Path) -> bool {
        let Ok(owner) = fs::read_to_string(path) else { return false };
        // Empty: its owner was killed before it wrote its name, or is about to.
        let last = if owner.is_empty() { time(path) } else { time(&Worker(owner).sign(&self.folder)) };
        match (last, time(&self.worker.sign(&self.folder))) {
            (Ok(last), Ok(own)) => own.duration_since(last).is_ok_and(|age| age > STALE),
            (Err(e), _) => e.kind() == io::ErrorKind::NotFound,
            _ => false,
        }
    }
}

impl Drop for Claims {
    fn drop(&mut self) {
        if let Some((sender, thread)) = self.sign_thread.take() {
            drop(sender);
            let _ = thread.join();
        }
        let _ = fs::remove_file(self.worker.sign(&self.folder));
        // Only an empty folder is removed: a late worker leaves a finished run as it was.
        let _ = fs::remove_dir(&self.folder);
    }
}

/// When a file was last written. It is opened for that: some network file systems look at a file anew only then.
fn time(path: &Path) -> io::Result<SystemTime> {
    File::open(path)?.metadata()?.modified()
}

fn claim(folder: &Path, what: &str) -> PathBuf {
    folder.join(format!("{what}.{CLAIM}"))
}

/// The worker that holds a claim which has not expired.
pub fn owner(dir: &Path, what: &str) -> Option<String> {
    let folder = parts::folder(dir);
    let owner = fs::read_to_string(claim(&folder, what)).ok().filter(|owner| !owner.is_empty())?;
    Worker(owner.clone()).sign(&folder).exists().then_some(owner)
}

/// Whether a file in the folder of parts is a worker's sign of life or the claim on the plan.
pub fn is_sign(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == ALIVE) || path.ends_with(format!("{PLAN}.{CLAIM}"))
}

#[cfg(test)]
mod tests;
