//! The results of one run in a folder, which replace those of an earlier run together.

use std::fs::{self, File, TryLockError};
use std::io::{Error, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::sleep;
use std::time::Duration;

use super::files::{self, WriteError};

/// Pause and number of tries to lock a folder that another run holds: ten seconds in all; writing takes milliseconds.
const PAUSE: Duration = Duration::from_millis(50);
const TRIES: usize = 200;

/// Locked while files are replaced.
static REPLACING: Mutex<()> = Mutex::new(());

/// Waits until no files are being replaced, and prevents it as long as the guard is held: a program that ends then
/// leaves either the earlier results or the new ones, and no temporary file.
pub fn between_writes() -> MutexGuard<'static, ()> {
    REPLACING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Replaces the results in a folder, made if need be, and returns the paths of the new ones in the same order. Files of an earlier
/// run that `is_ours` knows by their names and that are not among the new ones are then removed, and what a killed run left.
///
/// The new files are written whole beside the earlier ones and then renamed in order, which takes microseconds for
/// each. Each is thus whole at any moment, and all are of one run, except between two renames and where the machine
/// stops there; the last file is the one that names the others. Runs into the same folder take turns.
///
/// # Errors
/// [`WriteError`] with the path that could not be written. What can be seen beforehand to fail leaves the earlier results.
pub fn replace(
    dir: &Path,
    new: &[(String, Vec<u8>)],
    is_ours: impl Fn(&str) -> bool,
) -> Result<Vec<PathBuf>, WriteError> {
    let _whole = between_writes();
    fs::create_dir_all(dir).map_err(|e| WriteError::new(dir, e))?;
    let _turn = turn(dir)?;
    files::remove_unfinished(dir);
    let written = files::write_into(dir, new)?;
    for entry in dir.read_dir().into_iter().flatten().flatten() {
        let name = entry.file_name();
        let stale = |name: &str| is_ours(name) && !new.iter().any(|(n, _)| n == name);
        if name.to_str().is_some_and(stale) {
            // One that stays does no harm: no report shows it.
            let _ = fs::remove_file(entry.path());
        }
    }
    Ok(written)
}

/// Whether files can be made in a folder, or the folder itself where it is not there yet. Leaves nothing.
///
/// # Errors
/// [`WriteError`] with the folder that refuses.
pub fn can_write(dir: &Path) -> Result<(), WriteError> {
    let there = dir.ancestors().find(|d| d.as_os_str().is_empty() || d.symlink_metadata().is_ok()).unwrap_or(dir);
    let there = if there.as_os_str().is_empty() { Path::new(".") } else { there };
    if !there.is_dir() {
        return Err(WriteError::new(there, ErrorKind::NotADirectory.into()));
    }
    let _whole = between_writes();
    files::unfinished(there).map(drop).map_err(|e| WriteError::new(there, e))
}

/// This run's turn to write into a folder, until the file is dropped or the process ends in whatever way. `None` on a system that
/// locks no folders.
fn turn(dir: &Path) -> Result<Option<File>, WriteError> {
    let Ok(folder) = File::open(dir) else { return Ok(None) };
    for _ in 0..TRIES {
        match folder.try_lock() {
            Ok(()) => return Ok(Some(folder)),
            Err(TryLockError::WouldBlock) => sleep(PAUSE),
            Err(TryLockError::Error(_)) => return Ok(None),
        }
    }
    Err(WriteError::new(dir, Error::new(ErrorKind::ResourceBusy, "another run has been writing into it for long")))
}
