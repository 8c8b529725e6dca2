//! Findings into text and figures: Markdown, CSV, JSON, SVG, and the short table on a terminal.
//!
//! | file | what it holds |
//! | --- | --- |
//! | `report.md` | the verdict first, then what it rests on |
//! | `report.html` | the same as one page, with interactive figures |
//! | `couplers.csv` | every coupler of every case |
//! | `result.json` | the same for programs |
//! | `figure-N-envelope.svg` | largest draft and buff along the train; N is the scenario's place in the train file |
//! | `figure-N-force.svg` | the worst coupler's force over time |
//! | `figure-N-wave.svg` | force in every coupler by place and time, and the elastic rod's |
//! | `figure-N-cascade.svg` | the same when couplers break one after the other, where a scenario follows that |
//! | `figure-N-map.svg`, `map-N.csv` | overloading force by duration, or safe load by broken coupler, where asked for |
//! | `figure-N-breaks.svg` | the worst utilisation by broken coupler, where several breaks were examined |

mod cascade;
pub(crate) mod cells;
mod couplers_csv;
pub(crate) mod figures;
pub(crate) mod files;
mod html;
mod interactive;
mod limits;
mod map_csv;
pub(crate) mod markdown;
pub(crate) mod numbers;
mod pictures;
mod result_json;
mod section;
mod terminal_table;
mod train_facts;
pub(crate) mod words;

use std::io;
use std::path::{Path, PathBuf};

pub use couplers_csv::csv;
pub use files::{WriteError, write_all};
pub use result_json::json;
pub use terminal_table::terminal;

use crate::consist::Train;
use crate::findings::Analysis;
use markdown::Pictures;
use pictures::Shown;

/// A form of the report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// `report.md`, with its figures as SVG beside it.
    Markdown,
    /// `report.html`, with its figures in it.
    Html,
}

impl Format {
    /// Both.
    pub const ALL: [Format; 2] = [Format::Markdown, Format::Html];

    fn file(self) -> &'static str {
        if self == Format::Markdown { "report.md" } else { "report.html" }
    }
}

/// Writes the whole report into a folder, made if need be, and returns the files' paths, the reports last and `report.md` as the
/// very last.
///
/// No file ever stands half-written under its own name, and an earlier report is replaced only once the new one is
/// complete on the disk. What an earlier report left and the new one does not have is then removed: a report in the other form, and
/// figures named as in the table above; nothing else.
///
/// # Errors
/// [`WriteError`] with the path that could not be written.
pub fn write(train: &Train, analysis: &Analysis, dir: &Path, formats: &[Format]) -> Result<Vec<PathBuf>, WriteError> {
    let shown: Vec<Option<Shown>> = analysis.scenarios.iter().map(|s| Shown::new(train, s)).collect();
    let pictures: Pictures = shown.iter().map(|s| s.as_ref().map_or_else(Vec::new, Shown::pictures)).collect();
    let failed = |name: &str| {
        let path = dir.join(name);
        move |source: io::Error| files::WriteError::new(&path, source)
    };
    let wanted = |format: Format| formats.contains(&format).then(|| format.file());
    let mut rows = Vec::new();
    csv(analysis, &mut rows).map_err(io::Error::other).map_err(failed("couplers.csv"))?;
    let json = json(analysis).map_err(io::Error::other).map_err(failed("result.json"))?;
    let report =
        markdown::markdown(train, analysis, &pictures).map_err(io::Error::other).map_err(failed("report.md"))?;
    let page = wanted(Format::Html).map(|name| {
        let data = interactive::data(&shown).map_err(io::Error::other).map_err(failed(name))?;
        Ok((name.to_owned(), html::html(analysis, &report, &pictures, &data).into_bytes()))
    });
    let markdown = wanted(Format::Markdown).map(|name| (name.to_owned(), report.into_bytes()));
    let mut all: Vec<(String, Vec<u8>)> = Vec::new();
    if markdown.is_some() {
        all.extend(pictures.into_iter().flatten().map(|p| (p.file, p.svg.into_bytes())));
    }
    for scenario in &analysis.scenarios {
        if let (Some(map), Some((index, _))) = (&scenario.map, words::source(train, scenario)) {
            let name = format!("map-{}.csv", index + 1);
            let rows = map_csv::map_csv(map).map_err(io::Error::other).map_err(failed(&name))?;
            all.push((name, rows));
        }
    }
    all.push(("couplers.csv".to_owned(), rows));
    all.push(("result.json".to_owned(), json.into_bytes()));
    all.extend(page.transpose()?);
    all.extend(markdown);
    let written = files::write_all(dir, &all)?;
    remove_stale(dir, &all);
    Ok(written)
}

/// Removes what an earlier report left; a figure that stays does no harm, for no report shows it.
fn remove_stale(dir: &Path, written: &[(String, Vec<u8>)]) {
    let Ok(entries) = dir.read_dir() else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let Some(name) = name.to_str() else { continue };
        let ours = is_figure(name) || Format::ALL.iter().any(|f| f.file() == name);
        if ours && !written.iter().any(|(w, _)| w == name) {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// Whether a file's name is one that only a report's figure has.
fn is_figure(name: &str) -> bool {
    let parts = name.strip_prefix("figure-").and_then(|n| n.strip_suffix(".svg")).and_then(|n| n.split_once('-'));
    parts.is_some_and(|(number, kind)| {
        number.bytes().all(|b| b.is_ascii_digit())
            && ["breaks", "cascade", "envelope", "force", "map", "wave"].contains(&kind)
    })
}
