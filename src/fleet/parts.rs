//! What a run has written so far: its description, and in a folder its plan, the claims of its workers, and a part file for each
//! chunk that is done.
//!
//! A part file appears whole or not at all, and says that the chunk is done: a line with the number of bytes of its rows, the rows, and
//! the rows of errors.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::FleetError;
use crate::report::files::{self, WriteError};

const DESCRIPTION: &str = "fleet-run.json";
const PARTS: &str = "fleet-parts";

/// What is run, and whether it is done: `fleet-run.json`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Run {
    /// The program's version.
    pub trainsafe: String,
    /// Fingerprint of train files, study and options.
    pub fingerprint: String,
    /// Train files.
    pub trains: usize,
    /// Variations of each, where there is a study.
    pub variations: Option<usize>,
    /// Whether the variations are draws from distributions, which have probabilities.
    pub drawn: bool,
    /// Whether they are a Latin hypercube.
    pub latin_hypercube: bool,
    /// Headings of the study's inputs.
    pub inputs: Vec<String>,
    /// Cases in all.
    pub cases: u64,
    /// Cases in each chunk but the last.
    pub chunk_cases: u64,
    /// What there is to say of the study's inputs, as sentences.
    #[serde(default)]
    pub notes: Vec<String>,
    /// The columns of its rows, but for a study's inputs; empty in a run of an earlier version.
    #[serde(default)]
    pub columns: String,
    /// What its reports say they were made from.
    #[serde(default)]
    pub made_from: MadeFrom,
    /// All rows are in `fleet.csv`.
    pub complete: bool,
}

/// What the results of a run were made from.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MadeFrom {
    /// The tolerance, a share of the largest rating.
    pub tolerance: String,
    /// The method that was asked for.
    pub method: Option<String>,
    /// The seed of a study's draws.
    pub seed: Option<u64>,
    /// Each input of the study: its key, its values or distribution as the study file gives them, and what has a draw of its own.
    pub inputs: Vec<[String; 3]>,
    /// The first files that were read, in the order of their paths, the study first: path and SHA-256 of each.
    pub files: Vec<[String; 2]>,
    /// How many files were read.
    pub file_count: usize,
    /// SHA-256 of the list of all files: a line `SHA-256  path` of each, as `sha256sum` writes it.
    pub list_sha256: String,
}

impl Run {
    /// How many chunks there are.
    pub fn chunks(&self) -> usize {
        self.cases.div_ceil(self.chunk_cases.max(1)) as usize
    }
}

/// The run in a folder, if there is one.
///
/// # Errors
/// An invalid description.
pub fn read(dir: &Path) -> Result<Option<Run>, FleetError> {
    let path = dir.join(DESCRIPTION);
    match fs::read(&path) {
        Ok(bytes) => serde_json::from_slice(&bytes).map(Some).map_err(|e| FleetError::unreadable(&path, &e)),
        Err(e) if matches!(e.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => Ok(None),
        Err(e) => Err(FleetError::unreadable(&path, &e)),
    }
}

/// Writes the run's description.
///
/// # Errors
/// [`WriteError`] with the path.
pub fn describe(dir: &Path, run: &Run) -> Result<(), FleetError> {
    let text = serde_json::to_vec_pretty(run).map_err(|e| WriteError::new(&dir.join(DESCRIPTION), e.into()))?;
    files::write_all(dir, &[(DESCRIPTION.to_owned(), text)])?;
    Ok(())
}

/// The folder of the dataset of couplers, where there is one.
pub fn couplers(dir: &Path) -> PathBuf {
    dir.join("couplers")
}

/// The folder of a run's parts.
pub fn folder(dir: &Path) -> PathBuf {
    dir.join(PARTS)
}

fn name(chunk: usize) -> String {
    format!("{chunk:08}.csv")
}

/// Whether a chunk is done.
pub fn is_done(dir: &Path, chunk: usize) -> bool {
    folder(dir).join(name(chunk)).exists()
}

/// The rows and errors of a chunk that is done.
///
/// # Errors
/// A part file that cannot be read, or is not whole.
pub fn content(dir: &Path, chunk: usize) -> Result<[Vec<u8>; 2], FleetError> {
    let path = folder(dir).join(name(chunk));
    let mut rest = fs::read(&path).map_err(|e| FleetError::unreadable(&path, &e))?;
    let head = rest.iter().position(|byte| *byte == b'\n').and_then(|end| {
        let bytes: usize = std::str::from_utf8(&rest[..end]).ok()?.parse().ok()?;
        let [begin, end] = [end + 1, (end + 1).checked_add(bytes)?];
        (end <= rest.len()).then_some([begin, end])
    });
    let [begin, end] = head.ok_or_else(|| {
        FleetError::unreadable(&path, &"it is no whole part; remove it, and its cases are computed again")
    })?;
    let errors = rest.split_off(end);
    Ok([rest.split_off(begin), errors])
}

/// Makes the folder of the parts.
///
/// # Errors
/// [`WriteError`] with the path.
pub fn prepare(dir: &Path) -> Result<(), FleetError> {
    let parts = folder(dir);
    Ok(fs::create_dir_all(&parts).map_err(|e| WriteError::new(&parts, e))?)
}

/// Writes a chunk's rows and errors. A folder removed during the run is not made again: its other parts are missing.
///
/// # Errors
/// [`WriteError`] with the path.
pub fn keep(dir: &Path, chunk: usize, [rows, errors]: [Vec<u8>; 2]) -> Result<(), FleetError> {
    let head = format!("{}\n", rows.len()).into_bytes();
    files::write_into(&folder(dir), &[(name(chunk), [head, rows, errors].concat())])?;
    Ok(())
}

/// Removes the parts; those that stay do no harm to a complete run.
pub fn remove(dir: &Path) {
    let _ = fs::remove_dir_all(folder(dir));
}
