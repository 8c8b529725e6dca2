//! `fleet.md`: the sections of a run's report as Markdown.

use super::parts::Run;
use super::sections;
use super::summary::Summary;
use crate::report::block::{Block, Span, lines};
use crate::report::markdown;
use crate::report::words::count;

/// The report; its figures are files beside it.
pub fn fleet_md(run: &Run, summary: &Summary, before: &[Block], date: &str) -> String {
    let title = Block::Title(format!("Fleet of {}", count(run.trains, "train")));
    let verdict = Block::Paragraph("", lines(&sections::verdict(run, summary).join("\n")));
    let notes = run.notes.iter().map(|note| Block::plain(format!("Note: {note}.")));
    let first: Vec<Block> = [title, verdict].into_iter().chain(notes).collect();
    let (trains, after) = (sections::trains(summary), sections::after(summary));
    let mut files = vec![Span::Plain("Every case is in ".to_owned()), Span::Link("fleet.csv")];
    files.extend(match summary.failed {
        0 => vec![Span::Plain(", one row each; no case failed.".to_owned())],
        _ => vec![
            Span::Plain(", one row each; what could not be computed is in ".to_owned()),
            Span::Link("errors.csv"),
            Span::Plain(".".to_owned()),
        ],
    });
    let files = Block::Paragraph("", files);
    let made_from = sections::made_from(run, date);
    markdown::markdown(first.iter().chain(before).chain(&trains).chain(&after).chain([&files]).chain(&made_from))
}
