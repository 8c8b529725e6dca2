//! The parts of a run into its final files.

use std::fs;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use super::parts::{self, Run};
use super::rows::{self, BACK, ERRORS, FRONT};
use super::summary::Summary;
use super::{FleetError, fleet_md};
use crate::report::files::{self, WriteError};

const ROWS: &str = "fleet.csv";
const BAD: &str = "errors.csv";
const REPORT: &str = "fleet.md";
const FIGURE: &str = "figure-safe-load.svg";

/// Headings of `fleet.csv`.
pub fn headings(run: &Run) -> Vec<String> {
    FRONT.map(str::to_owned).into_iter().chain(run.inputs.clone()).chain(BACK.map(str::to_owned)).collect()
}

/// Writes `fleet.csv`, `errors.csv`, `fleet.md` and its figure, in constant memory but for what the report sums up.
///
/// # Errors
/// A part that is missing, or a file that cannot be written.
pub fn join(dir: &Path, run: &Run) -> Result<Summary, FleetError> {
    let missing = (0..run.chunks()).filter(|&chunk| !parts::is_done(dir, chunk)).count();
    if missing > 0 {
        let share = format!("{missing} of {} parts of the run are missing", run.chunks());
        return Err(FleetError::Usage(format!("{share}: let every shard finish, or run it again with --resume")));
    }
    files::remove_unfinished(dir);
    let mut summary = Summary::new(run.inputs.len());
    let mut all = Joined::new(dir, ROWS, headings(run))?;
    let mut bad = Joined::new(dir, BAD, ERRORS.map(str::to_owned).to_vec())?;
    for chunk in 0..run.chunks() {
        let [rows, errors] = parts::paths(dir, chunk);
        let (rows, errors) = (read(&rows)?, read(&errors)?);
        summary.add(&rows, &errors);
        all.append(&rows)?;
        bad.append(&errors)?;
    }
    all.finish()?;
    bad.finish()?;
    summary.close();
    let figure = fleet_md::figure(&summary, FIGURE.trim_end_matches(".svg"));
    let text = fleet_md::markdown(run, &summary, figure.as_ref().map(|_| FIGURE));
    let text = text.map_err(|e| WriteError::new(&dir.join(REPORT), std::io::Error::other(e)))?;
    let figure = figure.map(|svg| (FIGURE.to_owned(), svg.into_bytes()));
    let report = [(REPORT.to_owned(), text.into_bytes())];
    files::write_all(dir, &figure.into_iter().chain(report).collect::<Vec<_>>())?;
    Ok(summary)
}

/// What the rows of a complete run come to.
///
/// # Errors
/// A file that cannot be read.
pub fn summarise(dir: &Path, run: &Run) -> Result<Summary, FleetError> {
    let mut summary = Summary::new(run.inputs.len());
    for (name, is_rows) in [(ROWS, true), (BAD, false)] {
        let path = dir.join(name);
        let file = fs::File::open(&path).map_err(|e| unreadable(&path, &e))?;
        let records = csv::ReaderBuilder::new().flexible(true).from_reader(file).into_records();
        for record in records {
            let record = record.map_err(|e| unreadable(&path, &e))?;
            if is_rows { summary.row(&record) } else { summary.error(&record) }
        }
    }
    summary.close();
    Ok(summary)
}

/// Where the report of a run in this folder is.
pub fn report(dir: &Path) -> PathBuf {
    dir.join(REPORT)
}

/// A final file under way.
struct Joined {
    file: BufWriter<NamedTempFile>,
    path: PathBuf,
}

impl Joined {
    fn new(dir: &Path, name: &str, headings: Vec<String>) -> Result<Joined, FleetError> {
        let path = dir.join(name);
        let file = files::unfinished(dir).map_err(|e| WriteError::new(&path, e))?;
        let mut joined = Joined { file: BufWriter::new(file), path };
        let mut line = Vec::new();
        rows::line(&mut line, headings.into_iter());
        joined.append(&line)?;
        Ok(joined)
    }

    fn append(&mut self, bytes: &[u8]) -> Result<(), FleetError> {
        Ok(self.file.write_all(bytes).map_err(|e| WriteError::new(&self.path, e))?)
    }

    fn finish(self) -> Result<(), FleetError> {
        let Joined { file, path } = self;
        let file = file.into_inner().map_err(|e| WriteError::new(&path, e.into_error()))?;
        file.persist(&path).map_err(|e| WriteError::new(&path, e.error))?;
        Ok(())
    }
}

fn read(path: &Path) -> Result<Vec<u8>, FleetError> {
    fs::read(path).map_err(|e| unreadable(path, &e))
}

fn unreadable(path: &Path, why: &dyn std::fmt::Display) -> FleetError {
    FleetError::Usage(format!("{} cannot be read: {why}", path.display()))
}
