//! Findings into text and figures: Markdown, CSV, JSON, SVG, and the short table on a terminal.
//!
//! | file | what it holds |
//! | --- | --- |
//! | `report.md` | the verdict first, then what it rests on |
//! | `couplers.csv` | every coupler of every case |
//! | `result.json` | the same for programs |
//! | `figure-N-envelope.svg` | largest draft and buff along the train; N is the scenario's place in the train file |
//! | `figure-N-force.svg` | the worst coupler's force over time |
//! | `figure-N-cascade.svg` | where and when couplers break one after the other, where a scenario follows that |
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
use crate::findings::{Analysis, ScenarioFindings};
use crate::scenario::Event;
use markdown::Picture;

/// Writes the whole report into a folder, made if need be, and returns the files' paths, `report.md` last.
///
/// No file ever stands half-written under its own name, and an earlier report is replaced only once the new one is
/// complete on the disk. Figures of an earlier report that the new one does not show are removed: files named as in the
/// table above, and nothing else.
///
/// # Errors
/// [`WriteError`] with the path that could not be written.
pub fn write(train: &Train, analysis: &Analysis, dir: &Path) -> Result<Vec<PathBuf>, WriteError> {
    let pictures: Vec<Vec<Picture>> = analysis.scenarios.iter().map(|s| pictures(train, s)).collect();
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

/// The figures of a scenario that has something to show.
fn pictures(train: &Train, scenario: &ScenarioFindings) -> Vec<Picture> {
    let (Some((index, source)), Some((case, worst))) = (words::source(train, scenario), words::worst_case(scenario))
    else {
        return Vec::new();
    };
    let number = index + 1;
    let picture = |kind: &str, caption: String, draw: &dyn Fn(&str) -> String| {
        let name = format!("figure-{number}-{kind}");
        Picture { svg: draw(&name), file: format!("{name}.svg"), caption }
    };
    let several = scenario.cases.len() > 1;
    let mut all = Vec::new();
    let struck = match source.event {
        Event::Impact { vehicles, at_head: true, .. } => Some(vehicles),
        Event::Impact { vehicles, .. } => Some(train.vehicles.len() - vehicles),
        _ => None,
    };
    if let Some(cascade) = case.cascade.as_ref().filter(|c| !several && !c.breaks.is_empty()) {
        let caption = "Where and when couplers break: time against place.".to_owned();
        all.push(picture("cascade", caption, &|n| figures::cascade(case, cascade, struck, train.couplers.len(), n)));
    }
    if several {
        let caption = "Utilisation of the worst coupler, by which coupler breaks.".to_owned();
        all.push(picture("breaks", caption, &|n| figures::breaks(scenario, train.couplers.len(), n)));
    }
    if scenario.cases.iter().any(|c| !c.couplers.is_empty()) {
        let over = if several { ", over all breaks" } else { "" };
        let caption = format!("Largest draft and buff of every coupler{over}, against the ratings.");
        all.push(picture("envelope", caption, &|n| figures::envelope(train, scenario, n)));
    }
    if let Some(map) = &scenario.map {
        let what = if map.over == "duration_s" {
            "The smallest force, of this pulse's shape and sense, that overloads a coupler, against its duration"
        } else {
            "The factor on the load up to which no coupler exceeds, against which coupler breaks"
        };
        let caption = format!("{what}; the numbers are in map-{number}.csv.");
        all.push(picture("map", caption, &|n| figures::map(map, n)));
    }
    let when = match case.broken_coupler.filter(|_| several) {
        Some(b) => format!(", when coupler {b} breaks"),
        None => String::new(),
    };
    let shown = match figures::window(train, case, worst) {
        (from, to) if to - from < case.horizon_s => format!(
            ", from {} to {} of {}",
            numbers::brief_time(from),
            numbers::brief_time(to),
            numbers::brief_time(case.horizon_s)
        ),
        _ => String::new(),
    };
    let caption = format!("Force in the worst coupler, {}{when}{shown}.", words::place(worst));
    all.push(picture("force", caption, &|n| figures::history(train, index, case, worst, n)));
    all
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
        number.bytes().all(|b| b.is_ascii_digit()) && ["breaks", "cascade", "envelope", "force", "map"].contains(&kind)
    })
}
