//! Joins the parts of a run to its tables, `fleet.csv` and `errors.csv`, from which everything else is made.

use std::borrow::Cow;
use std::fs;
use std::path::Path;

use super::parts::{self, Run};
use super::rows::{self, ERRORS, Lines};
use super::summary::Summary;
use super::{FleetError, begin, claims};
use crate::report::files::{self, Unnamed};

/// The rows of a run.
pub const ROWS: &str = "fleet.csv";
const BAD: &str = "errors.csv";

/// Writes `fleet.csv` and `errors.csv`, in constant memory but for what the reports sum up.
///
/// # Errors
/// A part that is missing, or a file that cannot be written.
pub fn join(dir: &Path, run: &Run) -> Result<Summary, FleetError> {
    none_is_missing(dir, run)?;
    files::remove_unfinished(dir);
    let mut summary = Summary::new(run.inputs.len());
    let mut all = begin(dir, ROWS, rows::headings(&run.inputs))?;
    let mut bad = begin(dir, BAD, ERRORS.map(str::to_owned).to_vec())?;
    for chunk in 0..run.chunks() {
        let [rows, errors] = parts::content(dir, chunk)?;
        summary.add(&rows, &errors);
        all.append(&rows)?;
        bad.append(&errors)?;
    }
    all.finish()?;
    bad.finish()?;
    summary.close();
    Ok(summary)
}

/// Whether every part is there, or the run is joined already.
///
/// # Errors
/// [`FleetError::Usage`] that names what is missing, and who has it.
pub fn none_is_missing(dir: &Path, run: &Run) -> Result<(), FleetError> {
    const SHOWN: usize = 5;
    let missing: Vec<usize> = (0..run.chunks()).filter(|&chunk| !parts::is_done(dir, chunk)).collect();
    if run.complete || missing.is_empty() {
        return Ok(());
    }
    let named = begin::planned(dir, None)?.map(|begun| begun.trains_of_chunks(&missing[..missing.len().min(SHOWN)]));
    let named = named.unwrap_or_default().into_iter().zip(&missing).map(|(trains, &chunk)| {
        let at_it = claims::owner(dir, &chunk.to_string()).map(|owner| format!("; {owner} has it"));
        format!("{} ({trains}{})", chunk + 1, at_it.unwrap_or_default())
    });
    let mut named: Vec<String> = named.collect();
    if missing.len() > SHOWN {
        named.push(format!("and {} more", missing.len() - SHOWN));
    }
    let are = if missing.len() == 1 { "is" } else { "are" };
    let parts = format!("{} of {} parts of the run {are} missing", missing.len(), run.chunks());
    let help = "let its workers finish, start one with --work, or run it again with --resume";
    Err(FleetError::Usage(format!("{parts}: {}: {help}", named.join(", "))))
}

/// The summary of a complete run.
///
/// # Errors
/// A file that cannot be read.
pub fn summarise(dir: &Path, run: &Run) -> Result<Summary, FleetError> {
    let mut summary = Summary::new(run.inputs.len());
    for (name, is_rows) in [(ROWS, true), (BAD, false)] {
        let path = dir.join(name);
        let file = fs::File::open(&path).map_err(|e| FleetError::unreadable(&path, &e))?;
        let records = csv::ReaderBuilder::new().flexible(true).from_reader(file).into_records();
        for record in records {
            let record = record.map_err(|e| FleetError::unreadable(&path, &e))?;
            if is_rows { summary.row(&record) } else { summary.error(&record) }
        }
    }
    summary.close();
    Ok(summary)
}

fn begin(dir: &Path, name: &str, headings: Vec<String>) -> Result<Unnamed, FleetError> {
    let mut file = Unnamed::new(dir.join(name))?;
    let mut line = Lines::default();
    line.add(headings.into_iter().map(Cow::from));
    file.append(&line.into_bytes())?;
    Ok(file)
}
