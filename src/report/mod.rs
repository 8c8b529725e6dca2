//! Findings as text and figures: Markdown, CSV, JSON, SVG, and the short table on a terminal.
//!
//! | file | what it holds |
//! | --- | --- |
//! | `report.md` | the verdict first, then what it rests on |
//! | `report.html` | the same as one page, with interactive figures |
//! | `couplers.csv` | every coupler of every case |
//! | `result.json` | the same for programs |
//! | `figure-N-envelope.svg` | largest draft and buff along the train; N is the scenario's place in the train file |
//! | `figure-N-force.svg` | the worst coupler's force over time |
//! | `figure-N-loop.svg` | its force against its elongation, of a coupler with slack or a gear |
//! | `figure-N-wave.svg` | force in every coupler by place and time, and the elastic rod's |
//! | `figure-N-cascade.svg` | the same when couplers break one after the other, where a scenario follows that |
//! | `figure-N-map.svg`, `map-N.csv` | overloading force by duration, or safe load by broken coupler, where asked for |
//! | `figure-N-breaks.svg` | the worst utilisation by broken coupler, where several breaks were examined |

mod assumptions;
pub(crate) mod block;
mod cascade;
pub(crate) mod cells;
mod content;
pub(crate) mod couplers_csv;
mod events;
pub(crate) mod figures;
pub(crate) mod files;
pub(crate) mod folder;
mod groups;
pub(crate) mod html;
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
mod variants;
mod verdict;
pub(crate) mod words;

use std::io;
use std::path::{Path, PathBuf};

pub use couplers_csv::{Cells, Column, CouplerRow, coupler_columns, coupler_rows, csv};
pub use files::{WriteError, write_all};
pub use folder::{between_writes, can_write};
pub use result_json::json;
pub use terminal_table::terminal;

use crate::findings::Analysis;
use crate::train::Train;
use block::Block;
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

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        if self == Format::Markdown { "md" } else { "html" }
    }

    fn file(self) -> &'static str {
        if self == Format::Markdown { "report.md" } else { "report.html" }
    }
}

/// Writes the whole report into a folder, made if need be, and returns the files' paths, the reports last and `report.md` as the
/// very last.
///
/// No file ever stands half-written under its own name, and an earlier report is replaced only once the new one is
/// complete on the disk. What an earlier report left and the new one does not have is then removed: a report in the other form, and
/// figures and maps named as in the table above; nothing else. Runs into the same folder take turns.
///
/// # Errors
/// [`WriteError`] with the path that could not be written.
pub fn write(train: &Train, analysis: &Analysis, dir: &Path, formats: &[Format]) -> Result<Vec<PathBuf>, WriteError> {
    let all = documents(train, analysis, formats).map_err(|e| WriteError::new(dir, e))?;
    folder::replace(dir, &all, is_ours)
}

/// The report's files, each with its name and content, in the order in which [`write`] names them.
///
/// # Errors
/// None are known: all is written into memory.
pub fn documents(train: &Train, analysis: &Analysis, formats: &[Format]) -> io::Result<Vec<(String, Vec<u8>)>> {
    let (shown, blocks) = shown_and_blocks(train, analysis);
    let wanted = |format: Format| formats.contains(&format).then(|| format.file().to_owned());
    let mut rows = Vec::new();
    csv(analysis, &mut rows).map_err(io::Error::other)?;
    let json = json(analysis).map_err(io::Error::other)?;
    let page = wanted(Format::Html).map(|name| {
        let data = interactive::data(&shown).map_err(io::Error::other)?;
        Ok::<_, io::Error>((name, html::html(train, analysis, &blocks, &data).into_bytes()))
    });
    let markdown = wanted(Format::Markdown).map(|name| (name, markdown::markdown(&blocks).into_bytes()));
    let mut all: Vec<(String, Vec<u8>)> = Vec::new();
    if markdown.is_some() {
        all.extend(blocks.into_iter().filter_map(|block| match block {
            Block::Figure(_, picture) => Some((picture.file, picture.svg.into_bytes())),
            _ => None,
        }));
    }
    for scenario in &analysis.scenarios {
        if let (Some(map), Some((index, _))) = (&scenario.map, words::source(train, scenario)) {
            all.push((format!("map-{}.csv", index + 1), map_csv::map_csv(map).map_err(io::Error::other)?));
        }
    }
    all.push(("couplers.csv".to_owned(), rows));
    all.push(("result.json".to_owned(), json.into_bytes()));
    all.extend(page.transpose()?);
    all.extend(markdown);
    Ok(all)
}

/// What is drawn of each scenario, and the report.
fn shown_and_blocks<'a>(train: &'a Train, analysis: &'a Analysis) -> (Vec<Option<Shown<'a>>>, Vec<Block>) {
    let shown = Shown::all(train, &analysis.scenarios);
    let blocks = content::content(train, analysis, &shown);
    (shown, blocks)
}

/// What a page shows of an analysis, as HTML, and what its figures are drawn from, as JSON.
#[cfg(feature = "serve")]
pub(crate) fn shown_live(train: &Train, analysis: &Analysis) -> io::Result<(String, String)> {
    let (shown, blocks) = shown_and_blocks(train, analysis);
    let data = interactive::data(&shown).map_err(io::Error::other)?;
    Ok((html::body(analysis, &blocks), data))
}

/// The report as a page for a notebook: what `report.html` says, with its static figures and without scripts.
pub fn light_page(train: &Train, analysis: &Analysis) -> String {
    html::light(analysis, &shown_and_blocks(train, analysis).1)
}

/// Whether a file's name is one that only a report, its figures and its maps have.
fn is_ours(name: &str) -> bool {
    let number = |n: &str| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit());
    let figure = name.strip_prefix("figure-").and_then(|n| n.strip_suffix(".svg")).and_then(|n| n.split_once('-'));
    let kinds = ["breaks", "cascade", "envelope", "force", "loop", "map", "wave"];
    let map = name.strip_prefix("map-").and_then(|n| n.strip_suffix(".csv"));
    figure.is_some_and(|(n, kind)| number(n) && kinds.contains(&kind))
        || map.is_some_and(number)
        || Format::ALL.iter().any(|format| format.file() == name)
}
