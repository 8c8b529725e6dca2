//! One run at a time in a folder.

use std::fs::{self, File, TryLockError};
use std::path::Path;

use super::FleetError;
use crate::report::files::WriteError;

const NAME: &str = ".fleet-run.lock";

/// Holds a folder until it is dropped, or the process ends in whatever way.
pub struct Lock {
    _file: Option<File>,
}

/// Takes a folder, made if need be: for this run alone, or together with other workers.
///
/// The file stays, for one that is removed could be locked by two. On a file system without locks nothing is held.
///
/// # Errors
/// A folder that another run holds, or that cannot be written.
pub fn hold(dir: &Path, with_others: bool) -> Result<Lock, FleetError> {
    fs::create_dir_all(dir).map_err(|e| WriteError::new(dir, e))?;
    let path = dir.join(NAME);
    let file = File::options().read(true).write(true).create(true).truncate(false).open(&path);
    let file = file.map_err(|e| WriteError::new(&path, e))?;
    match if with_others { file.try_lock_shared() } else { file.try_lock() } {
        Ok(()) => Ok(Lock { _file: Some(file) }),
        Err(TryLockError::Error(_)) => Ok(Lock { _file: None }),
        Err(TryLockError::WouldBlock) => {
            let help = "wait until it is done, or choose another folder with --out DIR";
            Err(FleetError::Usage(format!("another run is under way in {}: {help}", crate::error::printable_path(dir))))
        }
    }
}
