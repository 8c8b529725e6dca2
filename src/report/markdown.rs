//! `report.md`: the facts of an analysis, filled into the template.

use minijinja::syntax::SyntaxConfig;
use minijinja::value::{Serde, Value};
use minijinja::{AutoEscape, Environment, Error, Output, State};
use serde::Serialize;

use super::assumptions;
use super::groups::{self, Groups};
use super::section::{Section, overview_row, section};
use super::train_facts::train_facts;
use super::words;
use crate::error::is_obeyed;
use crate::findings::Analysis;
use crate::scenario::Motion;
use crate::train::Train;

const TEMPLATE: &str = include_str!("report.md.jinja");

/// A figure of the report: its file's name, what it shows, and the SVG.
pub struct Picture {
    /// Name of the file, beside `report.md`.
    pub file: String,
    /// What it shows.
    pub caption: String,
    /// The file's content.
    pub svg: String,
}

/// A scenario's place in the report: its index in the analysis, and its pictures.
pub type Pictures = Vec<Vec<Picture>>;

#[derive(Serialize)]
struct Report {
    name: String,
    several: bool,
    /// `"dashpots"`, `"modes"`, `"laws"` of slack and gears, or nothing.
    damped: &'static str,
    cascades: bool,
    /// Some scenario is followed from event to event.
    marched: bool,
    sections: Vec<Section>,
    /// The verdict on each of several scenarios in one row.
    overview: Vec<Vec<String>>,
    train: Vec<[String; 2]>,
    /// The same by groups: vehicles, couplers.
    groups: [Groups; 2],
    assumptions: Vec<assumptions::Row>,
    program: String,
    date: String,
    options: String,
    /// Every file that was read: path and SHA-256.
    inputs: Vec<[String; 2]>,
    /// What a reader should know beforehand: loads over ratings, horizons that end before a wave has crossed the train.
    warnings: Vec<String>,
}

/// The report as Markdown.
///
/// # Errors
/// None are known: the template and the facts are this crate's own.
pub fn markdown(train: &Train, analysis: &Analysis, pictures: &Pictures) -> Result<String, Error> {
    let of = |i: usize| pictures.get(i).map_or(&[][..], |p| p);
    let ran: Vec<_> = analysis.scenarios.iter().filter_map(|s| words::source(train, s)).map(|(_, s)| s).collect();
    let report = Report {
        name: train.name().to_owned(),
        several: analysis.scenarios.len() > 1,
        damped: match train.extras() {
            extras if !extras.dashpot_n_s_per_m.is_empty() => "dashpots",
            extras if extras.damping_ratio > 0.0 => "modes",
            extras if !extras.laws.is_empty() => "laws",
            _ => "",
        },
        cascades: analysis.scenarios.iter().flat_map(|s| &s.cases).any(|c| c.cascade.is_some()),
        marched: ran.iter().any(|s| Motion::of(train, s) == Motion::Events),
        sections: analysis.scenarios.iter().enumerate().map(|(i, s)| section(train, s, of(i))).collect(),
        overview: analysis.scenarios.iter().map(|s| overview_row(train, s)).collect(),
        groups: [groups::vehicles(train), groups::couplers(train)],
        program: format!("{} {}", analysis.program.name, analysis.program.version),
        date: analysis.date.clone(),
        options: options(analysis),
        inputs: analysis.inputs.iter().map(|f| [f.path.clone(), f.sha256.clone()]).collect(),
        assumptions: assumptions::rows(train, &ran),
        train: train_facts(train),
        warnings: analysis.doubts.iter().map(ToString::to_string).collect(),
    };
    render(TEMPLATE, report)
}

/// The options that decide the numbers.
fn options(analysis: &Analysis) -> String {
    let method = analysis.options.method.map_or("chosen by the program".to_owned(), |m| format!("{m}, as asked for"));
    let tolerance = analysis.options.tolerance;
    format!(
        "tolerance {tolerance:e} of the largest rating, method {method}, results of schema {}",
        analysis.schema_version
    )
}

/// A template filled with facts, every text in them escaped.
///
/// # Errors
/// None are known: templates and facts are this crate's own.
pub fn render(template: &str, facts: impl Serialize) -> Result<String, Error> {
    let mut environment = Environment::new();
    environment
        .set_syntax(SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).keep_trailing_newline(true).build()?);
    environment.set_auto_escape_callback(|_| AutoEscape::Custom("markdown".into()));
    environment.set_formatter(write_escaped);
    environment.add_filter("join", join);
    environment.render_str(template, Serde(facts))
}

/// The cells of a row, each escaped, with the separator left as it is.
fn join(cells: Vec<String>, separator: &str) -> Value {
    Value::from_safe_string(cells.iter().map(|c| escape(c)).collect::<Vec<_>>().join(separator))
}

fn write_escaped(out: &mut Output, _state: &mut State, value: &Value) -> Result<(), Error> {
    let plain = if value.is_undefined() || value.is_none() { String::new() } else { value.to_string() };
    let text = if value.is_safe() { plain } else { escape(&plain) };
    out.write_str(&text).map_err(|e| Error::new(minijinja::ErrorKind::WriteFailure, e.to_string()))
}

/// The text with nothing in it that Markdown, or the HTML within it, would take for markup.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for (i, c) in text.char_indices() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '\\' | '`' | '*' | '_' | '[' | ']' | '|' | '~' | '#' | '$' => out.extend(['\\', c]),
            // Keep a bare address from becoming a link.
            '.' if text[..i].ends_with("www") => out.push_str("\\."),
            ':' if text[i..].starts_with("://") => out.push_str("\\:"),
            c if is_obeyed(c) => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::escape;

    #[test]
    fn names_are_text_whatever_they_hold() {
        assert_eq!(escape("<img src=x> | *a*_b_"), "&lt;img src=x&gt; \\| \\*a\\*\\_b\\_");
        assert_eq!(escape("[x](http://a)\nb"), "\\[x\\](http\\://a) b");
        assert_eq!(escape("Zürich – 木"), "Zürich – 木");
    }
}
