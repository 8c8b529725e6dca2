//! `fleet.md`: the sections of a run's report as Markdown.

use minijinja::Error;
use serde::Serialize;

use super::parts::Run;
use super::sections::{self, Section};
use super::summary::Summary;
use crate::report::markdown::render;
use crate::report::words::count;

const TEMPLATE: &str = include_str!("fleet.md.jinja");

#[derive(Serialize)]
struct Report<'a> {
    title: String,
    verdict: Vec<String>,
    notes: &'a [String],
    sections: Vec<&'a Section>,
}

/// The report; its figures are files beside it.
///
/// # Errors
/// None are known: the template and the facts are this crate's own.
pub fn markdown(run: &Run, summary: &Summary, before: &[Section]) -> Result<String, Error> {
    let after = sections::after(summary);
    let trains = sections::trains(summary);
    let report = Report {
        title: format!("Fleet of {}", count(run.trains, "train")),
        verdict: sections::verdict(run, summary),
        notes: &run.notes,
        sections: before.iter().chain(&trains).chain(&after).collect(),
    };
    Ok(render(TEMPLATE, report)?.trim_end().to_owned() + "\n")
}
