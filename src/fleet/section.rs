//! One section of a fleet's report.

use crate::report::block::{Block, Picture, Side};

/// Rows of a table at most.
pub const LISTED: usize = 50;

/// A section.
pub fn section(
    title: &str,
    text: Vec<String>,
    figure: Option<Picture>,
    head: &[&str],
    rows: Vec<Vec<String>>,
) -> Vec<Block> {
    let head: Vec<_> = head.iter().map(|name| (*name, Side::Left)).collect();
    let mut all = vec![Block::Heading(title.to_owned(), None)];
    all.extend(text.into_iter().map(Block::plain));
    all.extend(figure.map(|figure| Block::Figure(None, figure)));
    all.extend((!rows.is_empty()).then(|| Block::table("", &head, rows)));
    all
}

/// A section with a table, if that has rows.
pub fn listed(title: &str, text: Vec<String>, head: &[&str], rows: Vec<Vec<String>>) -> Vec<Block> {
    if rows.is_empty() { Vec::new() } else { section(title, text, None, head, rows) }
}

/// Says that a table is cut short.
pub fn more(text: &mut Vec<String>, all: usize, shown: usize, what: &str) {
    if all > shown {
        text.push(format!("The first {shown} of {all} {what}; fleet.csv has all."));
    }
}
