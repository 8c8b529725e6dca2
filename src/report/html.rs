//! `report.html`: the words of `report.md` with the figures in them, one file that asks for nothing from outside.
//!
//! Both are written from the same blocks. The static figures stand inline as SVG; where scripts run, interactive ones take their
//! place on the screen.
//!
//! Those are drawn by Plotly.js, which every report carries (0.7 MB of base64; the page unpacks it): it has lines, pictures by
//! place and time and hover labels in one schema. Its origin is in `assets/README.md`.
//!
//! A policy in the page's head forbids everything but its own scripts, by their digests: whatever a train file's names hold,
//! nothing else runs and nothing is fetched.

use std::sync::LazyLock;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest, Sha256};

use super::block::{Block, Picture, Side, Span, Table};
use super::words;
use crate::error::harmless;
use crate::figures::{css, escaped};
use crate::findings::{Analysis, ScenarioFindings};
use crate::train::Train;

const STYLE: &str = concat!(include_str!("page.css"), include_str!("report.css"));
/// Rows of a table that is shown unfolded, at most.
const LONG: usize = 40;
const SCRIPT: &str = include_str!("report.js");
/// Plotly.js, packed with gzip, in base64; and the digest of its text.
static LIBRARY: LazyLock<String> = LazyLock::new(|| STANDARD.encode(include_bytes!("../../assets/plotly.min.js.gz")));
const LIBRARY_DIGEST: &str = include_str!("../../assets/plotly.min.js.sha256");

/// A page with the script that draws the figures.
pub(crate) struct Frame<'a> {
    /// Plain text.
    pub title: &'a str,
    /// CSS beyond that of a report.
    pub style: &'a str,
    /// What stands in the body, as HTML.
    pub body: &'a str,
    /// What the figures are drawn from, as JSON.
    pub data: &'a str,
    /// A script that runs after the one that draws.
    pub script: Option<&'a str>,
}

impl Frame<'_> {
    /// The page, whose policy lets nothing else run; with a script of its own it may ask the server that it came from.
    pub(crate) fn page(&self) -> String {
        let Frame { style, body, .. } = self;
        let scripts: Vec<&str> = std::iter::once(SCRIPT).chain(self.script).collect();
        let digest = |script: &&str| format!("'sha256-{}'", STANDARD.encode(Sha256::digest(script.as_bytes())));
        let digests: String = scripts.iter().map(digest).map(|digest| digest + " ").collect();
        let elements: String = scripts.iter().map(|script| format!("<script>{script}</script>\n")).collect();
        let connect = if self.script.is_some() { "connect-src 'self'; " } else { "" };
        format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; img-src \
             data: blob:; {connect}script-src {digests}'sha256-{LIBRARY_DIGEST}'; base-uri 'none'; form-action 'none'\">\n\
             <title>{title}</title>\n<style>\n{colors}{STYLE}{style}</style>\n</head>\n<body>\n\
             <a class=\"skip\" href=\"#main\">Skip to the report</a>\n{body}\
             <script type=\"application/json\" id=\"data\">{data}</script>\n\
             <script type=\"text/plain\" id=\"library\">{library}</script>\n{elements}</body>\n</html>\n",
            title = escaped(self.title),
            colors = css(),
            data = in_script(self.data),
            library = LIBRARY.as_str(),
        )
    }
}

/// JSON as the text of a script element, which only "<" could end or turn into a comment.
pub(crate) fn in_script(json: &str) -> String {
    json.replace('<', "\\u003c")
}

/// The report as a page: its blocks, and what the script draws from.
pub fn html(train: &Train, analysis: &Analysis, blocks: &[Block], data: &str) -> String {
    let body = format!(
        "<main id=\"main\">\n{body}{file}</main>\n\
         <footer><p>Written by trainsafe {version}. Interactive figures: Plotly.js, MIT licence, within this file.</p></footer>\n",
        body = body(analysis, blocks),
        file = train_file(&train.origin().text),
        version = env!("CARGO_PKG_VERSION"),
    );
    Frame { title: &analysis.train, style: "", body: &body, data, script: None }.page()
}

/// The same without scripts and what they draw from.
pub fn light(analysis: &Analysis, blocks: &[Block]) -> String {
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; img-src data:\">\n\
         <title>{title}</title>\n<style>\n{colors}{STYLE}</style>\n</head>\n<body>\n<main id=\"main\">\n{body}</main>\n</body>\n\
         </html>\n",
        title = escaped(&analysis.train),
        colors = css(),
        body = body(analysis, blocks),
    )
}

/// The train file's text, folded; nothing for a train that was not read from a text.
fn train_file(text: &str) -> String {
    if text.is_empty() {
        return String::new();
    }
    let lines: Vec<String> = text.lines().map(|line| escaped(&harmless(line))).collect();
    format!("<details>\n<summary>The train file</summary>\n<pre>{}</pre>\n</details>\n", lines.join("\n"))
}

/// What a report says, as HTML.
pub(crate) fn body(analysis: &Analysis, blocks: &[Block]) -> String {
    let scenarios = &analysis.scenarios;
    let (mut out, mut heading, mut drawn) = (String::new(), "", None);
    for block in blocks {
        if let Block::Title(text) | Block::Heading(text, _) = block {
            heading = text;
        }
        out += &match block {
            Block::Title(text) => format!("<h1>{}</h1>\n", escaped(text)),
            Block::Heading(text, None) => format!("<h2>{}</h2>\n", escaped(text)),
            Block::Heading(text, Some(i)) => {
                let contents = if *i == 0 { contents(scenarios) } else { String::new() };
                format!("{contents}<h2 id=\"scenario-{}\">{}</h2>\n", i + 1, escaped(text))
            }
            Block::Verdict(i, verdict, more) => {
                let class = state(&scenarios[*i]).0;
                format!("<p class=\"verdict {class}\"><strong>{}</strong>{}</p>\n", escaped(verdict), escaped(more))
            }
            Block::Note(text) => format!("<p><em>Note: {}.</em></p>\n", escaped(text)),
            Block::Paragraph("", text) => format!("<p>{}</p>\n", spans(text)),
            Block::Paragraph(title, text) => {
                format!("<p><strong>{}.</strong> {}</p>\n", escaped(title), spans(text))
            }
            Block::List(points) => {
                let points: String = points.iter().map(|text| format!("<li>{}</li>\n", spans(text))).collect();
                format!("<ul>\n{points}</ul>\n")
            }
            Block::Table(of) => table(of, heading),
            Block::Figure(of, picture) => {
                // Interactive figures replace all of a scenario.
                let live = of
                    .filter(|_| drawn != *of)
                    .map_or_else(String::new, |i| format!("<div class=\"live\" data-scenario=\"{i}\" hidden></div>\n"));
                drawn = *of;
                live + &figure(*of, picture)
            }
        };
    }
    out
}

/// Sentences as HTML.
pub(crate) fn spans(text: &[Span]) -> String {
    let one = |span: &Span| match span {
        Span::Plain(text) => escaped(text),
        Span::Link(file) => format!("<a href=\"{file}\">{file}</a>"),
        Span::LineEnd => "\n".to_owned(),
    };
    text.iter().map(one).collect()
}

fn figure(scenario: Option<usize>, picture: &Picture) -> String {
    let kind = picture.file.trim_end_matches(".svg").rsplit('-').next().unwrap_or_default();
    let of = scenario.map_or_else(String::new, |i| format!("data-scenario=\"{i}\" "));
    let svg = inline(&picture.svg, &escaped(&picture.alt));
    let caption = escaped(&picture.caption);
    format!("<figure {of}data-kind=\"{kind}\" tabindex=\"0\">\n{svg}\n<figcaption>{caption}</figcaption>\n</figure>\n")
}

/// A table with a caption, in a frame that scrolls where it is wider than the page; a long one is folded.
fn table(table: &Table, heading: &str) -> String {
    let heading = escaped(heading);
    let caption = match (table.title, table.caption.as_str()) {
        ("", caption) => escaped(caption),
        (title, caption) => escaped(&format!("{title}. {caption}")),
    };
    // It differs from that of another scenario's table.
    let label = if caption.is_empty() { heading.clone() } else { format!("{heading}: {caption}") };
    let class = |column: usize| match table.head.get(column) {
        Some((_, Side::Right)) => " class=\"right\"",
        _ => "",
    };
    let name =
        |(i, (name, _)): (usize, &(String, Side))| format!("<th scope=\"col\"{}>{}</th>", class(i), escaped(name));
    let names: String = table.head.iter().enumerate().map(name).collect();
    let head = if names.is_empty() { names } else { format!("<thead><tr>{names}</tr></thead>\n") };
    let cell = |(i, text): (usize, &String)| match i {
        0 => format!("<th scope=\"row\"{}>{}</th>", class(i), escaped(text)),
        _ => format!("<td{}>{}</td>", class(i), escaped(text)),
    };
    let row = |cells: &Vec<String>| format!("<tr>{}</tr>\n", cells.iter().enumerate().map(cell).collect::<String>());
    let rows: String = table.rows.iter().map(row).collect();
    let titled =
        if caption.is_empty() { String::new() } else { format!("<caption><span>{caption}</span></caption>\n") };
    let framed = format!(
        "<div class=\"table\" role=\"region\" aria-label=\"{label}\" tabindex=\"0\">\n<table>\n{titled}\
         {head}<tbody>\n{rows}</tbody>\n</table>\n</div>\n"
    );
    match table.rows.len() > LONG {
        true => format!(
            "<details>\n<summary>{}</summary>\n{framed}</details>\n",
            if caption.is_empty() { heading } else { caption }
        ),
        false => framed,
    }
}

/// A scenario's state, as a class and in words.
fn state(scenario: &ScenarioFindings) -> (&'static str, String) {
    let over = scenario.cases.iter().filter(|c| c.exceeding > 0).count();
    let open = scenario.cases.iter().any(|c| c.undecided > 0);
    match (&scenario.cases[..], over) {
        ([case], 1..) => ("exceeds", format!("{} over the rating", words::count(case.exceeding, "coupler"))),
        (cases, 1..) => ("exceeds", format!("{over} of {} overload a coupler", words::count(cases.len(), "break"))),
        _ if open => ("open", "not decided".to_owned()),
        _ => ("safe", "no coupler over its rating".to_owned()),
    }
}

/// Links to the scenarios, with the state of each.
fn contents(scenarios: &[ScenarioFindings]) -> String {
    let entry = |(i, s): (usize, &ScenarioFindings)| {
        let (class, words) = state(s);
        format!(
            "<li><a href=\"#scenario-{}\">{}</a>: <strong class=\"{class}\">{words}</strong></li>\n",
            i + 1,
            escaped(&s.name)
        )
    };
    let entries: String = scenarios.iter().enumerate().map(entry).collect();
    format!("<nav aria-label=\"Scenarios\">\n<ol>\n{entries}</ol>\n</nav>\n")
}

/// A figure's SVG within a page, labelled for screen readers; `label` is HTML.
pub(crate) fn inline(svg: &str, label: &str) -> String {
    svg.trim().replacen("<svg ", &format!("<svg role=\"img\" aria-label=\"{label}\" "), 1)
}
