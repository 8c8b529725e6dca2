//! Findings into text and figures: Markdown, CSV, JSON, SVG, and the short table on a terminal.
//!
//! | file | what it holds |
//! | --- | --- |
//! | `report.md` | the verdict first, then what it rests on |
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
mod limits;
mod map_csv;
pub(crate) mod markdown;
pub(crate) mod numbers;
mod pictures;
mod result_json;
mod section;
mod terminal_table;
mod train_facts;
mod words;

use std::io;
use std::path::{Path, PathBuf};

pub use couplers_csv::csv;
pub use files::WriteError;
pub use result_json::json;
pub use terminal_table::terminal;

use crate::consist::Train;
use crate::findings::Analysis;
use markdown::Pictures;
use pictures::Shown;

/// Writes the whole report into a folder, made if need be, and returns the files' paths, `report.md` last.
///
/// No file ever stands half-written under its own name, and an earlier report is replaced only once the new one is
/// complete on the disk. Figures of an earlier report that the new one does not show are removed: files named as in the
/// table above, and nothing else.
///
/// # Errors
/// [`WriteError`] with the path that could not be written.
pub fn write(train: &Train, analysis: &Analysis, dir: &Path) -> Result<Vec<PathBuf>, WriteError> {
    let shown: Vec<Option<Shown>> = analysis.scenarios.iter().map(|s| Shown::new(train, s)).collect();
    let pictures: Pictures = shown.iter().map(|s| s.as_ref().map_or_else(Vec::new, Shown::pictures)).collect();
    let failed = |name: &str| {
        let path = dir.join(name);
        move |source: io::Error| files::WriteError::new(&path, source)
    };
    let mut rows = Vec::new();
    csv(analysis, &mut rows).map_err(io::Error::other).map_err(failed("couplers.csv"))?;
    let json = json(analysis).map_err(io::Error::other).map_err(failed("result.json"))?;
    let report =
        markdown::markdown(train, analysis, &pictures).map_err(io::Error::other).map_err(failed("report.md"))?;
    let mut all: Vec<(String, Vec<u8>)> =
        pictures.into_iter().flatten().map(|p| (p.file, p.svg.into_bytes())).collect();
    let shown: Vec<String> = all.iter().map(|(name, _)| name.clone()).collect();
    for scenario in &analysis.scenarios {
        if let (Some(map), Some((index, _))) = (&scenario.map, words::source(train, scenario)) {
            let name = format!("map-{}.csv", index + 1);
            let rows = map_csv::map_csv(map).map_err(io::Error::other).map_err(failed(&name))?;
            all.push((name, rows));
        }
    }
    all.push(("couplers.csv".to_owned(), rows));
    all.push(("result.json".to_owned(), json.into_bytes()));
    all.push(("report.md".to_owned(), report.into_bytes()));
    let written = files::write_all(dir, &all)?;
    remove_stale_figures(dir, &shown);
    Ok(written)
}

/// Removes figures of an earlier report; one that stays does no harm, for no report shows it.
fn remove_stale_figures(dir: &Path, shown: &[String]) {
    let Ok(entries) = dir.read_dir() else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let Some(name) = name.to_str() else { continue };
        if is_figure(name) && !shown.iter().any(|s| s == name) {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// Whether a file's name is one that only a report's figure has.
fn is_figure(name: &str) -> bool {
    let parts = name.strip_prefix("figure-").and_then(|n| n.strip_suffix(".svg")).and_then(|n| n.split_once('-'));
    parts.is_some_and(|(number, kind)| {
        number.bytes().all(|b| b.is_ascii_digit()) && ["breaks", "cascade", "envelope", "force", "map", "wave"].contains(&kind)
    })
}
