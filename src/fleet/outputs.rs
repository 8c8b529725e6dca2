//! Writes the files that were asked for from a complete run's rows, in constant memory but for the summary.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use super::parts::Run;
use super::summary::Summary;
use super::{FleetError, Request, fleet_md, page, probability, sections};
use crate::findings::date;
use crate::report::block::Block;
use crate::report::files;

const MARKDOWN: &str = "fleet.md";
const PARQUET: &str = "fleet.parquet";
const HTML: &str = "fleet.html";

/// A kind of file that a run can write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FleetFormat {
    /// `fleet.csv` and `errors.csv`, which are always written: the others are made from them.
    Csv,
    /// `fleet.md` and its figures.
    Md,
    /// `fleet.parquet`, with the columns of `fleet.csv`.
    Parquet,
    /// `fleet.html`, one page that needs nothing else.
    Html,
}

impl FleetFormat {
    /// All of them.
    pub const ALL: [FleetFormat; 4] = [FleetFormat::Csv, FleetFormat::Md, FleetFormat::Parquet, FleetFormat::Html];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            FleetFormat::Csv => "csv",
            FleetFormat::Md => "md",
            FleetFormat::Parquet => "parquet",
            FleetFormat::Html => "html",
        }
    }

    /// The one of that name.
    pub fn from_name(name: &str) -> Option<FleetFormat> {
        FleetFormat::ALL.into_iter().find(|f| f.name() == name)
    }

    /// Files of its own, without the tables.
    fn files(self) -> &'static [&'static str] {
        match self {
            FleetFormat::Csv => &[],
            FleetFormat::Md => &[MARKDOWN, sections::SAFE_FACTORS, probability::INFLUENCES],
            FleetFormat::Parquet => &[PARQUET],
            FleetFormat::Html => &[HTML],
        }
    }
}

/// Whether this build can write what is asked for.
///
/// # Errors
/// [`FleetError::Usage`] with how to build one that can.
pub fn can_write(request: &Request) -> Result<(), FleetError> {
    if (request.couplers || request.formats.contains(&FleetFormat::Parquet)) && !cfg!(feature = "parquet") {
        let why = "this trainsafe was built without Parquet: build it with `cargo install --path . --features parquet`";
        return Err(FleetError::Usage(why.to_owned()));
    }
    // Reports state the date: a SOURCE_DATE_EPOCH that is no date is refused before anything is computed.
    date::today().map(|_| ()).map_err(FleetError::Usage)
}

/// Writes the files that were asked for beside the tables of a complete run; the report among them, if there is one.
/// `links` are those to reports of single trains, by the trains' files.
///
/// # Errors
/// A file that cannot be written.
pub fn write(
    dir: &Path,
    run: &Run,
    summary: &Summary,
    request: &Request,
    links: &HashMap<String, String>,
) -> Result<Option<PathBuf>, FleetError> {
    let formats = &request.formats;
    #[cfg(feature = "parquet")]
    if formats.contains(&FleetFormat::Parquet) {
        super::parquet_file::write(&dir.join(super::join::ROWS), run, summary, &dir.join(PARQUET))?;
    }
    let before = sections::before(run, summary);
    let date = date::today().map_err(FleetError::Usage)?;
    let mut report = None;
    if formats.contains(&FleetFormat::Md) {
        let figures = before.iter().filter_map(|block| match block {
            Block::Figure(_, picture) => Some((picture.file.as_str(), picture.svg.clone())),
            _ => None,
        });
        report = Some(put(dir, figures.chain([(MARKDOWN, fleet_md::fleet_md(run, summary, &before, &date))]))?);
    }
    if formats.contains(&FleetFormat::Html) {
        report = Some(put(
            dir,
            [(HTML, page::page(run, summary, &before, links, request.units.unwrap_or_default(), &date))].into_iter(),
        )?);
    }
    Ok(report)
}

/// Writes files; the path of the last.
fn put<'a>(dir: &Path, files: impl Iterator<Item = (&'a str, String)>) -> Result<PathBuf, FleetError> {
    let all: Vec<_> = files.map(|(name, text)| (name.to_owned(), text.into_bytes())).collect();
    let written = files::write_into(dir, &all)?;
    Ok(written.into_iter().next_back().unwrap_or_else(|| dir.to_owned()))
}

/// Removes files of an earlier run that this one does not write anew.
pub fn remove_others(dir: &Path, formats: &[FleetFormat]) {
    for format in FleetFormat::ALL.into_iter().filter(|f| !formats.contains(f)) {
        for name in format.files() {
            // Most often there is none.
            let _ = fs::remove_file(dir.join(name));
        }
    }
}
