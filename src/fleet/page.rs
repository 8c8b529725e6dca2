//! `fleet.html`: the trains as a table to sort and search, and the worst cases of each, in one file that needs nothing else.
//!
//! Of a large fleet it shows what a browser can handle, and says so.

use std::collections::HashMap;

use super::parts::Run;
use super::sections;
use super::summary::{CAUSES, Case, Factors, KEPT, Summary, TrainSummary};
use crate::error::harmless;
use crate::figures::{css, escaped};
use crate::report::block::{Block, Table};
use crate::report::html::{inline, spans};
use crate::report::numbers::{Unit, digits, force_unit, percent};
use crate::report::words::count;
use crate::units::UnitSystem;

/// Trains in the table, and trains with their worst cases, at most.
const LISTED: usize = 10_000;
const DETAILED: usize = 1000;
/// Bytes of each of the two at most.
const MOST_BYTES: usize = 10 << 20;
/// A force, N, in whose unit those of a table are written, from the smallest train to the largest: kN or kip.
const LARGE_N: f64 = 1e5;
/// Characters of a name at most.
const LONGEST: usize = 200;

const STYLE: &str = concat!(include_str!("../report/page.css"), include_str!("page/style.css"));
const SCRIPT: &str = include_str!("page/sort.js");

/// Columns of the table of trains before and after those of the safe factors: how a column is sorted first, whether it has numbers,
/// and its name.
const BEFORE: [(&str, &str, &str); 3] = [
    ("ascending", "", "train"),
    ("descending", " class=\"number\" aria-sort=\"descending\"", "utilisation, %"),
    ("ascending", NUMBER, "margin, %"),
];
const AFTER: [(&str, &str, &str); 7] = [
    ("ascending", "", "worst case"),
    ("ascending", NUMBER, "worst coupler"),
    ("ascending", NUMBER, "when, s"),
    ("descending", NUMBER, "cases that exceed"),
    ("descending", NUMBER, "only after the first passage"),
    ("descending", NUMBER, "cases"),
    ("descending", NUMBER, "vehicles"),
];
const NUMBER: &str = " class=\"number\"";

/// The trains of a page.
struct Trains<'a> {
    /// Indices of what the safe factors multiply, a column each.
    causes: &'a [usize],
    /// Links to the reports of some, by their files.
    reports: &'a HashMap<String, String>,
    /// Of forces.
    unit: Unit,
}

/// The page; `reports` has the links to the reports of some trains, by their files.
pub fn page(
    run: &Run,
    summary: &Summary,
    before: &[Block],
    reports: &HashMap<String, String>,
    units: UnitSystem,
    date: &str,
) -> String {
    let trains = summary.worst_first();
    let all = Trains { causes: &sections::causes(summary), reports, unit: force_unit(units, LARGE_N) };
    let (details, detailed) = written(trains.iter().take(DETAILED).enumerate().map(|(i, t)| all.details(i, t)));
    let rows = trains.iter().take(LISTED).enumerate().map(|(i, t)| all.row(i, t, i < detailed));
    let (rows, listed) = written(rows);
    let doubtful = summary.trains.iter().filter(|train| !train.doubts.is_empty()).count();
    let factors = all.causes.iter().map(|&i| format!("safe factor on the {}", CAUSES[i].1));
    let column = |(first, class, name): (&str, &str, &str)| {
        format!("<th scope=\"col\" data-first=\"{first}\"{class}>{name}</th>\n")
    };
    let head: String = BEFORE
        .into_iter()
        .map(column)
        .chain(factors.map(|name| column(("ascending", NUMBER, &name))))
        .chain(AFTER.into_iter().map(column))
        .collect();
    let mut notes: Vec<String> = run.notes.iter().map(|note| clean(note) + ".").collect();
    if listed < summary.trains.len() {
        notes.push(format!("The {listed} worst of {} trains; fleet.csv has all.", summary.trains.len()));
    }
    if detailed < listed {
        notes.push(format!("The {detailed} worst trains have their worst cases below; fleet.csv has those of all."));
    }
    let paragraphs = |of: &[String], class: &str| -> String {
        of.iter().map(|sentence| format!("<p{class}>{}</p>\n", escaped(sentence))).collect()
    };
    let below = if detailed > 0 {
        format!(
            "<h2>Worst cases of each train</h2>\n\
             <p class=\"note\">Forces are positive in draft and negative in buff; times count from the event. At most {KEPT} cases of \
             each train are listed, the worst first.</p>\n"
        )
    } else {
        String::new()
    };
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'\">\n\
         <title>{title}</title>\n<style>\n{colors}{STYLE}</style>\n</head>\n<body>\n<main>\n<h1>{title}</h1>\n\
         <div class=\"verdict {state}\">\n{verdict}</div>\n\
         <p>Every case is a row of <a href=\"fleet.csv\">fleet.csv</a>; {failed}.</p>\n\
         {before}<h2>Trains, worst first</h2>\n{notes}\
         <div class=\"filter\" id=\"filter\" hidden>\n\
         <label>Find <input type=\"search\" id=\"search\" autocomplete=\"off\"></label>\n\
         <label><input type=\"checkbox\" id=\"only\"> only trains with an exceedance</label>\n\
         <output id=\"count\" aria-live=\"polite\"></output>\n</div>\n\
         <div class=\"table\" role=\"region\" aria-label=\"Trains\" tabindex=\"0\">\n<table id=\"trains\">\n<thead>\n<tr>\n{head}</tr>\n</thead>\n\
         <tbody>\n{rows}</tbody>\n</table>\n</div>\n{below}{details}{after}</main>\n<script>\n{SCRIPT}</script>\n</body>\n</html>\n",
        title = format_args!("Fleet of {}", count(run.trains, "train")),
        colors = css(),
        state = state(summary.harmful, summary.undecided_trains() + doubtful),
        verdict = paragraphs(&sections::verdict(run, summary), ""),
        failed = match summary.failed {
            0 => "no case failed",
            _ => "what could not be computed is in <a href=\"errors.csv\">errors.csv</a>",
        },
        before = blocks(before),
        notes = paragraphs(&notes, " class=\"note\""),
        after = blocks(&sections::after(summary)) + &blocks(&sections::made_from(run, date)),
    )
}

/// The first texts, as [`MOST_BYTES`] allow, and their number.
fn written(texts: impl Iterator<Item = String>) -> (String, usize) {
    let (mut all, mut count) = (String::new(), 0);
    for text in texts {
        if all.len() + text.len() > MOST_BYTES {
            break;
        }
        all += &text;
        count += 1;
    }
    (all, count)
}

impl Trains<'_> {
    /// A train in the table.
    fn row(&self, index: usize, train: &TrainSummary, detailed: bool) -> String {
        let worst = &train.worst[0];
        let name = match (clean_html(&train.name), index + 1) {
            (name, number) if detailed => format!("<a href=\"#train-{number}\">{name}</a>"),
            (name, _) => name,
        };
        let report = self.link(train, "report").map_or_else(String::new, |link| format!(" ({link})"));
        let broken = match worst.broken.as_str() {
            "" => String::new(),
            broken => format!(" data-n=\"{}\"", escaped(broken)),
        };
        let margin = 1.0 - worst.utilisation;
        let sorted =
            |class: &str, number: &str, text: &str| format!("<td class=\"{class}\" data-n=\"{number}\">{text}</td>");
        let safe = self.causes.iter().map(|&i| {
            let number = finite(&train.safe, i).map_or_else(String::new, |f| f.to_string());
            sorted("number", &number, &sections::factor(&train.safe, i))
        });
        [
            format!(
                "<tr{}><th scope=\"row\"><bdi>{name}</bdi>{report}</th>",
                class(state(train.unsafe_variations, train.undecided_variations))
            ),
            sorted("number worst", &worst.utilisation.to_string(), &percent(worst.utilisation)),
            sorted("number", &margin.to_string(), &percent(margin)),
            safe.collect(),
            format!("<td class=\"case\"{broken}><bdi>{}</bdi></td>", clean_html(&sections::case_words(worst))),
            number(&worst.coupler),
            sorted("number", &worst.time_s.to_string(), &digits(worst.time_s, 0.0, 4)),
            [train.cases[1], train.cases[2], train.cases[0]].map(|n| number(&n.to_string())).concat(),
            number(&train.vehicles) + "</tr>\n",
        ]
        .concat()
    }

    /// A train's worst cases.
    fn details(&self, index: usize, train: &TrainSummary) -> String {
        let [cases, exceed, later] = train.cases;
        let later = if later > 0 { format!(", {later} of them only after the first passage") } else { String::new() };
        let report =
            self.link(train, "Report of the worst case's train").map_or_else(String::new, |link| format!(" {link}"));
        let force = format!("force, {}", self.unit.name);
        let names = ["worst coupler", "utilisation, %", &force, "when, s", "couplers that exceed"].map(str::to_owned);
        let factors = self.causes.iter().map(|&i| format!("safe factor on the {}", CAUSES[i].1));
        let head = names.into_iter().chain(factors).map(|name| format!("<th scope=\"col\"{NUMBER}>{name}</th>"));
        format!(
            "<details id=\"train-{number}\"{open}><summary><bdi>{name}</bdi></summary>\n\
             <p><bdi>{file}</bdi>: {exceed} of {cases} cases exceed{later}.{report} <a href=\"#trains\">Back to the table</a></p>\n\
             <div class=\"table\"><table><thead><tr><th scope=\"col\">case</th>{head}</tr></thead><tbody>\n{rows}</tbody></table></div>\n\
             </details>\n",
            number = index + 1,
            open = if index == 0 { " open" } else { "" },
            name = clean_html(&train.name),
            file = clean_html(&train.file),
            head = head.collect::<String>(),
            rows = train.worst.iter().map(|case| self.case(case)).collect::<String>(),
        )
    }

    fn case(&self, case: &Case) -> String {
        let over = if case.exceeding == "0" { "" } else { "over" };
        [
            format!("<tr{}><th scope=\"row\"><bdi>{}</bdi></th>", class(over), clean_html(&sections::case_words(case))),
            number(&case.coupler),
            format!("<td class=\"number worst\">{}</td>", percent(case.utilisation)),
            number(&digits(case.force_n / self.unit.size, 0.0, 4)),
            number(&digits(case.time_s, 0.0, 4)),
            number(&case.exceeding),
            self.causes.iter().map(|&i| number(&sections::factor(&case.safe, i))).collect(),
            "</tr>\n".to_owned(),
        ]
        .concat()
    }

    /// A link to the report of a train that has one.
    fn link(&self, train: &TrainSummary, words: &str) -> Option<String> {
        self.reports.get(&train.file).map(|file| format!("<a href=\"{}\">{}</a>", escaped(file), escaped(words)))
    }
}

fn number(text: &str) -> String {
    format!("<td{NUMBER}>{}</td>", escaped(text))
}

fn class(class: &str) -> String {
    if class.is_empty() { String::new() } else { format!(" class=\"{class}\"") }
}

/// A safe factor, if it is finite.
fn finite(safe: &Factors, cause: usize) -> Option<f64> {
    safe[cause].filter(|f| f.is_finite())
}

/// Sections as HTML; they have no blocks of other kinds.
fn blocks(blocks: &[Block]) -> String {
    let (mut out, mut heading) = (String::new(), "");
    for block in blocks {
        out += &match block {
            Block::Heading(text, _) => {
                heading = text;
                format!("<h2>{}</h2>\n", escaped(text))
            }
            Block::Paragraph(_, text) => format!("<p class=\"note\">{}</p>\n", spans(text)),
            Block::Figure(_, of) => format!(
                "<figure tabindex=\"0\">\n{}\n<figcaption>{}</figcaption>\n</figure>\n",
                inline(&of.svg, &escaped(&of.alt)),
                escaped(&of.caption)
            ),
            Block::Table(of) => table(of, heading),
            _ => String::new(),
        };
    }
    out
}

fn table(table: &Table, heading: &str) -> String {
    let is_number = |cell: &str| cell.is_empty() || cell.replace('\u{2212}', "-").parse::<f64>().is_ok();
    let class = |i: usize| if table.rows.iter().all(|row| is_number(&row[i])) { NUMBER } else { "" };
    let classes: Vec<&str> = (0..table.head.len()).map(class).collect();
    let names = table.head.iter().zip(&classes);
    let head: String =
        names.map(|((name, _), class)| format!("<th scope=\"col\"{class}>{}</th>", clean_html(name))).collect();
    let cell = |(text, class): (&String, &&str)| format!("<td{class}><bdi>{}</bdi></td>", clean_html(text));
    let row = |cells: &Vec<String>| format!("<tr>{}</tr>\n", cells.iter().zip(&classes).map(cell).collect::<String>());
    format!(
        "<div class=\"table\" role=\"region\" aria-label=\"{label}\" tabindex=\"0\"><table><thead><tr>{head}</tr></thead><tbody>\n\
         {rows}</tbody></table></div>\n",
        label = escaped(heading),
        rows = table.rows.iter().map(row).collect::<String>(),
    )
}

/// The CSS class for so many exceedances and undecided cases.
fn state(over: usize, open: usize) -> &'static str {
    match (over, open) {
        (1.., _) => "over",
        (0, 1..) => "open",
        (0, 0) => "",
    }
}

/// A text of limited length without control characters.
fn clean(text: &str) -> String {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => harmless(&text[..end]) + "…",
        None => harmless(text),
    }
}

/// The same as HTML.
fn clean_html(text: &str) -> String {
    escaped(&clean(text))
}
