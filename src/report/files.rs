//! Files that appear whole or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::{NamedTempFile, TempPath};

use crate::error::printable_path;

/// What the names of unfinished files begin and end with.
const PREFIX: &str = ".trainsafe-";
const SUFFIX: &str = ".tmp";

/// Why a report could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {source}; {help}", printable_path(path))]
pub struct WriteError {
    /// The file or folder.
    pub path: PathBuf,
    /// What would help.
    pub help: &'static str,
    /// What the system said.
    pub source: io::Error,
}

impl WriteError {
    /// An error at a path, with what would help against it.
    pub(crate) fn new(path: &Path, source: io::Error) -> WriteError {
        let help = match source.kind() {
            io::ErrorKind::PermissionDenied => "choose a folder that you may write to with --out DIR",
            io::ErrorKind::StorageFull => "free some space, or choose a folder on another disk with --out DIR",
            io::ErrorKind::ReadOnlyFilesystem => "choose a folder on a disk that can be written to with --out DIR",
            io::ErrorKind::AlreadyExists | io::ErrorKind::NotADirectory => {
                "a file stands where a folder is needed: move it, or choose another folder with --out DIR"
            }
            io::ErrorKind::IsADirectory => {
                "a folder stands where the file must go: move it, or choose another folder with --out DIR"
            }
            io::ErrorKind::NotFound => "the folder is gone or takes no new files: choose another folder with --out DIR",
            io::ErrorKind::ResourceBusy => "wait until it is done, or choose another folder with --out DIR",
            _ => "choose another folder with --out DIR",
        };
        WriteError { path: path.to_owned(), help, source }
    }
}

/// Writes all files into a folder, made if need be, and returns their paths in the same order.
///
/// Every file is first written whole under a temporary name beside its place; only when all are there is each renamed, in
/// order. So nothing half-written ever has a final name, and if the disk fills up an earlier report stays as it was. A
/// file that holds the same bytes already is left alone: some file systems flush a file to the disk when it is replaced,
/// which takes longer than all the rest.
///
/// # Errors
/// [`WriteError`] with the path that could not be written.
pub fn write_all(dir: &Path, files: &[(String, Vec<u8>)]) -> Result<Vec<PathBuf>, WriteError> {
    fs::create_dir_all(dir).map_err(|e| WriteError::new(dir, e))?;
    write_into(dir, files)
}

/// The same where the folder is there.
///
/// # Errors
/// As for [`write_all`].
pub fn write_into(dir: &Path, files: &[(String, Vec<u8>)]) -> Result<Vec<PathBuf>, WriteError> {
    let staged = files.iter().map(|(name, content)| {
        let path = dir.join(name);
        if holds(&path, content) {
            return Ok((None, path));
        }
        let file = stage(dir, content).map_err(|e| WriteError::new(&path, e))?;
        Ok((Some(file), path))
    });
    let staged = staged.collect::<Result<Vec<_>, WriteError>>()?;
    if let Some((_, path)) = staged.iter().find(|(_, path)| path.is_dir()) {
        return Err(WriteError::new(path, io::ErrorKind::IsADirectory.into()));
    }
    staged
        .into_iter()
        .map(|(file, path)| match file.map(|f| f.persist(&path)) {
            Some(Err(e)) => Err(WriteError::new(&path, e.error)),
            _ => Ok(path),
        })
        .collect()
}

/// Whether a file holds these bytes already.
fn holds(path: &Path, content: &[u8]) -> bool {
    // Only a file of the same length is read; a pipe would block.
    let alike = |about: fs::Metadata| about.is_file() && about.len() == content.len() as u64;
    path.symlink_metadata().is_ok_and(alike) && fs::read(path).is_ok_and(|old| old == content)
}

/// The content in a file under a temporary name, to be renamed.
pub(crate) fn stage(dir: &Path, content: &[u8]) -> io::Result<NamedTempFile> {
    let mut file = unfinished(dir)?;
    // Through the file itself, so that no error names the temporary file.
    file.as_file_mut().write_all(content)?;
    Ok(file)
}

/// An empty file under a temporary name, to be renamed once it is whole.
pub(super) fn unfinished(dir: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX);
    // Temporary files are for their owner alone unless asked otherwise; a report is as readable as any other new file.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let file = builder.tempfile_in(dir)?;
    // The lock marks it as in use: other files are of killed runs. Without locks none of them is removed.
    let _ = file.as_file().try_lock();
    Ok(file)
}

/// A large file under way, which has its name only once it is whole and on the disk.
pub struct Unnamed {
    file: BufWriter<File>,
    place: TempPath,
    path: PathBuf,
}

impl Unnamed {
    /// Begins a file that is to stand at this path.
    ///
    /// # Errors
    /// [`WriteError`] with the path.
    pub fn new(path: PathBuf) -> Result<Unnamed, WriteError> {
        let dir = path.parent().unwrap_or(Path::new(""));
        let (file, place) = unfinished(dir).map_err(|e| WriteError::new(&path, e))?.into_parts();
        Ok(Unnamed { file: BufWriter::new(file), place, path })
    }

    /// Appends bytes.
    ///
    /// # Errors
    /// [`WriteError`] with the path.
    pub fn append(&mut self, bytes: &[u8]) -> Result<(), WriteError> {
        self.file.write_all(bytes).map_err(|e| WriteError::new(&self.path, e))
    }

    /// Lets a writer append to the file.
    ///
    /// # Errors
    /// [`WriteError`] with the path and what the writer said.
    #[cfg(feature = "parquet")]
    pub fn with(&mut self, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> Result<(), WriteError> {
        write(&mut self.file).map_err(|e| WriteError::new(&self.path, e))
    }

    /// Gives the file its name.
    ///
    /// # Errors
    /// [`WriteError`] with the path.
    pub fn finish(self) -> Result<(), WriteError> {
        let Unnamed { file, place, path } = self;
        let file = file.into_inner().map_err(|e| WriteError::new(&path, e.into_error()))?;
        // Its sources are removed afterwards: its bytes must be on the disk before it has its name.
        file.sync_all().map_err(|e| WriteError::new(&path, e))?;
        place.persist(&path).map_err(|e| WriteError::new(&path, e.error))
    }
}

/// Removes the temporary files of runs that were killed: those that no process has locked.
pub fn remove_unfinished(dir: &Path) {
    let Ok(entries) = dir.read_dir() else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let unfinished = name.to_str().is_some_and(|n| n.starts_with(PREFIX) && n.ends_with(SUFFIX));
        if unfinished && entry.file_type().is_ok_and(|kind| kind.is_file()) {
            let left = File::options().write(true).open(entry.path()).is_ok_and(|file| file.try_lock().is_ok());
            // One that stays does no harm.
            let _ = if left { fs::remove_file(entry.path()) } else { Ok(()) };
        }
    }
}
