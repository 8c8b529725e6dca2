//! `fleet.html`: the trains as a table to sort and search, and the worst cases of each, in one file that needs nothing else.
//!
//! Of a large fleet it has as much as a browser can carry, and says so.

use std::collections::HashMap;

use minijinja::syntax::SyntaxConfig;
use minijinja::{AutoEscape, Environment, Error, value::Serde};
use serde::Serialize;

use super::parts::Run;
use super::sections::{self, Section};
use super::summary::{CAUSES, Case, Factors, KEPT, Summary, TrainSummary};
use crate::error::harmless;
use crate::figures::css;
use crate::report::html::inline;
use crate::report::numbers::{digits, percent};
use crate::report::words::count;

/// Trains in the table, and trains with their worst cases, at most.
const LISTED: usize = 10_000;
const DETAILED: usize = 1000;
/// Bytes of each of the two at most.
const MOST_BYTES: usize = 10 << 20;
/// Characters of a name at most.
const LONGEST: usize = 200;

const TEMPLATES: [(&str, &str); 6] = [
    ("section", include_str!("page/section.jinja")),
    ("head", include_str!("page/head.jinja")),
    ("row", include_str!("page/row.jinja")),
    ("middle", include_str!("page/middle.jinja")),
    ("train", include_str!("page/train.jinja")),
    ("foot", include_str!("page/foot.jinja")),
];

#[derive(Serialize)]
struct Page {
    title: String,
    state: &'static str,
    verdict: Vec<String>,
    /// Before the trains, and after them.
    before: Vec<Part>,
    after: Vec<Part>,
    notes: Vec<String>,
    /// What the safe factors multiply, a column each.
    causes: Vec<&'static str>,
    kept: usize,
    detailed: usize,
    style: String,
    script: &'static str,
}

/// A section as HTML.
#[derive(Serialize)]
struct Part {
    title: &'static str,
    text: Vec<String>,
    /// An SVG and its caption.
    figure: Option<[String; 2]>,
    head: Vec<Cell>,
    rows: Vec<Vec<Cell>>,
}

/// A cell, and whether its column has numbers.
#[derive(Serialize)]
struct Cell {
    text: String,
    number: bool,
}

#[derive(Serialize)]
struct Train<'a> {
    number: usize,
    state: &'static str,
    detailed: bool,
    name: String,
    file: String,
    report: Option<&'a String>,
    vehicles: &'a str,
    cases: usize,
    exceed: usize,
    later: usize,
    safe: Vec<Shown>,
    causes: Vec<&'static str>,
    worst: Vec<Row<'a>>,
}

#[derive(Serialize)]
struct Row<'a> {
    case: String,
    broken: &'a str,
    coupler: &'a str,
    utilisation: Shown,
    margin: Shown,
    force: String,
    time: String,
    seconds: f64,
    exceeding: &'a str,
    safe: Vec<Shown>,
}

/// A number as it is read and as it sorts.
#[derive(Serialize)]
struct Shown {
    text: String,
    number: String,
}

/// The page; `reports` has the links to the reports of some trains, by their files.
///
/// # Errors
/// None are known: templates and facts are this crate's own.
pub fn page(
    run: &Run,
    summary: &Summary,
    before: &[Section],
    reports: &HashMap<String, String>,
) -> Result<String, Error> {
    let pages = templates()?;
    let trains = summary.worst_first();
    let causes = sections::causes(summary);
    let written = |template: &str, most: usize, detailed: usize| {
        let (mut text, mut count) = (String::new(), 0);
        for (number, train) in trains.iter().take(most).enumerate() {
            let facts = Train::new(number, train, number < detailed, &causes, reports);
            let one = pages.get_template(template)?.render(Serde(facts))?;
            if text.len() + one.len() > MOST_BYTES {
                break;
            }
            text += &one;
            count += 1;
        }
        Ok::<_, Error>((text, count))
    };
    let (details, detailed) = written("train", DETAILED, DETAILED)?;
    let (rows, listed) = written("row", LISTED, detailed)?;
    let page = Page::new(run, summary, before, &causes, [listed, detailed]);
    let part = |name: &str| pages.get_template(name)?.render(Serde(&page));
    Ok([part("head")?, rows, part("middle")?, details, part("foot")?].concat())
}

fn templates() -> Result<Environment<'static>, Error> {
    let mut pages = Environment::new();
    pages
        .set_syntax(SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).keep_trailing_newline(true).build()?);
    pages.set_auto_escape_callback(|_| AutoEscape::Html);
    for (name, text) in TEMPLATES {
        pages.add_template(name, text)?;
    }
    Ok(pages)
}

impl Page {
    fn new(run: &Run, summary: &Summary, before: &[Section], causes: &[usize], shown: [usize; 2]) -> Page {
        let [listed, detailed] = shown;
        let all = summary.trains.len();
        let doubtful = summary.trains.iter().filter(|train| !train.doubts.is_empty()).count();
        let mut notes: Vec<String> = run.notes.iter().map(|note| clean(note) + ".").collect();
        if listed < all {
            notes.push(format!("The {listed} worst of {all} trains; fleet.csv has all."));
        }
        if detailed < listed {
            notes
                .push(format!("The {detailed} worst trains have their worst cases below; fleet.csv has those of all."));
        }
        Page {
            title: format!("Fleet of {}", count(run.trains, "train")),
            state: state(summary.harmful, summary.undecided_trains() + doubtful),
            verdict: sections::verdict(run, summary),
            before: before.iter().map(Part::new).collect(),
            after: sections::after(summary).iter().map(Part::new).collect(),
            notes,
            causes: causes.iter().map(|&i| CAUSES[i].1).collect(),
            kept: KEPT,
            detailed,
            style: css() + concat!(include_str!("../report/page.css"), include_str!("page/style.css")),
            script: include_str!("page/sort.js"),
        }
    }
}

impl<'a> Train<'a> {
    fn new(
        number: usize,
        train: &'a TrainSummary,
        detailed: bool,
        causes: &[usize],
        reports: &'a HashMap<String, String>,
    ) -> Train<'a> {
        Train {
            number: number + 1,
            state: state(train.unsafe_variations, train.undecided_variations),
            detailed,
            name: clean(&train.name),
            file: clean(&train.file),
            report: reports.get(&train.file),
            vehicles: &train.vehicles,
            cases: train.cases[0],
            exceed: train.cases[1],
            later: train.cases[2],
            safe: Shown::factors(&train.safe, causes),
            causes: causes.iter().map(|&i| CAUSES[i].1).collect(),
            worst: train.worst.iter().map(|case| Row::new(case, causes)).collect(),
        }
    }
}

impl<'a> Row<'a> {
    fn new(case: &'a Case, causes: &[usize]) -> Row<'a> {
        Row {
            case: clean(&sections::case_words(case)),
            broken: &case.broken,
            coupler: &case.coupler,
            utilisation: Shown { text: percent(case.utilisation), number: case.utilisation.to_string() },
            margin: Shown { text: percent(1.0 - case.utilisation), number: (1.0 - case.utilisation).to_string() },
            force: digits(case.force_n / 1e3, 0.0, 4),
            time: digits(case.time_s, 0.0, 4),
            seconds: case.time_s,
            exceeding: &case.exceeding,
            safe: Shown::factors(&case.safe, causes),
        }
    }
}

impl Shown {
    /// The safe factors on some causes; nothing where there is none, or where nothing bounds it.
    fn factors(safe: &Factors, causes: &[usize]) -> Vec<Shown> {
        let finite = |i: usize| safe[i].filter(|f| f.is_finite());
        let number = |i: usize| finite(i).map_or_else(String::new, |f| f.to_string());
        causes.iter().map(|&i| Shown { text: sections::factor(safe, i), number: number(i) }).collect()
    }
}

impl Part {
    fn new(section: &Section) -> Part {
        let is_number = |cell: &str| cell.is_empty() || cell.parse::<f64>().is_ok();
        let numbers: Vec<bool> =
            (0..section.head.len()).map(|i| section.rows.iter().all(|row| is_number(&row[i]))).collect();
        let cells = |row: &Vec<String>| -> Vec<Cell> {
            row.iter().zip(&numbers).map(|(cell, &number)| Cell { text: clean(cell), number }).collect()
        };
        Part {
            title: section.title,
            text: section.text.clone(),
            figure: section.figure.as_ref().map(|f| [inline(&f.svg, f.alt), f.caption.clone()]),
            head: cells(&section.head),
            rows: section.rows.iter().map(cells).collect(),
        }
    }
}

/// The class of what has so many exceedances, and so many cases that are not decided.
fn state(over: usize, open: usize) -> &'static str {
    match (over, open) {
        (1.., _) => "over",
        (0, 1..) => "open",
        (0, 0) => "",
    }
}

/// A text of a bounded length with nothing in it that is obeyed rather than shown.
fn clean(text: &str) -> String {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => harmless(&text[..end]) + "…",
        None => harmless(text),
    }
}
