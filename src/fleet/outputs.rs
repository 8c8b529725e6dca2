//! What is made of the rows of a complete run: the files that were asked for, in constant memory but for the summary.

use std::fs;
use std::path::{Path, PathBuf};

use super::parts::Run;
use super::summary::Summary;
use super::{FleetError, fleet_md};
use crate::report::files::{self, WriteError};

const MARKDOWN: &str = "fleet.md";
const FIGURE: &str = "figure-safe-load.svg";
const PARQUET: &str = "fleet.parquet";

/// A kind of file that a run can write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// `fleet.csv` and `errors.csv`, which are always written: the others are made from them.
    Csv,
    /// `fleet.md` and its figure.
    Md,
    /// `fleet.parquet`, with the columns of `fleet.csv`.
    Parquet,
}

impl Format {
    /// All of them.
    pub const ALL: [Format; 3] = [Format::Csv, Format::Md, Format::Parquet];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Format::Csv => "csv",
            Format::Md => "md",
            Format::Parquet => "parquet",
        }
    }

    /// The one of that name.
    pub fn from_name(name: &str) -> Option<Format> {
        Format::ALL.into_iter().find(|f| f.name() == name)
    }

    /// Files of its own, without the tables.
    fn files(self) -> &'static [&'static str] {
        match self {
            Format::Csv => &[],
            Format::Md => &[MARKDOWN, FIGURE],
            Format::Parquet => &[PARQUET],
        }
    }
}

/// Whether this build can write them.
///
/// # Errors
/// [`FleetError::Usage`] with how to build one that can.
pub fn can_write(formats: &[Format]) -> Result<(), FleetError> {
    if formats.contains(&Format::Parquet) && !cfg!(feature = "parquet") {
        let why = "this trainsafe was built without Parquet: build it with `cargo install --path . --features parquet`";
        return Err(FleetError::Usage(why.to_owned()));
    }
    Ok(())
}

/// Writes the files that were asked for beside the tables of a complete run; the report among them, if there is one.
///
/// # Errors
/// A file that cannot be written.
pub fn write(dir: &Path, run: &Run, summary: &Summary, formats: &[Format]) -> Result<Option<PathBuf>, FleetError> {
    #[cfg(feature = "parquet")]
    if formats.contains(&Format::Parquet) {
        super::parquet_file::write(&dir.join(super::join::ROWS), run, summary, &dir.join(PARQUET))?;
    }
    if formats.contains(&Format::Md) {
        return Ok(Some(markdown(dir, run, summary)?));
    }
    Ok(None)
}

/// Removes files of an earlier run that this one does not write anew.
pub fn remove_others(dir: &Path, formats: &[Format]) {
    for format in Format::ALL.into_iter().filter(|f| !formats.contains(f)) {
        for name in format.files() {
            // Most often there is none.
            let _ = fs::remove_file(dir.join(name));
        }
    }
}

fn markdown(dir: &Path, run: &Run, summary: &Summary) -> Result<PathBuf, FleetError> {
    let path = dir.join(MARKDOWN);
    let figure = fleet_md::figure(summary, FIGURE.trim_end_matches(".svg"));
    let text = fleet_md::markdown(run, summary, figure.as_ref().map(|_| FIGURE));
    let text = text.map_err(|e| WriteError::new(&path, std::io::Error::other(e)))?;
    let figure = figure.map(|svg| (FIGURE.to_owned(), svg.into_bytes()));
    let report = [(MARKDOWN.to_owned(), text.into_bytes())];
    files::write_all(dir, &figure.into_iter().chain(report).collect::<Vec<_>>())?;
    Ok(path)
}
