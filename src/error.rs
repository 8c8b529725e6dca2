//! What can be wrong with an input, and where: a message with file, line, column and the text underlined.

use std::fmt;
use std::ops::Range;
use std::path::Path;

use annotate_snippets::{AnnotationKind, Group, Level, Origin, Renderer, Snippet};

/// More problems than this in one file are counted, not shown.
const SHOWN: usize = 20;
/// Quoted text longer than this is cut.
const QUOTED: usize = 60;

/// A train file that cannot be used, with every problem found in it; `Display` is [`InputError::render`] without colour.
#[derive(Clone, Debug)]
pub struct InputError {
    path: String,
    problems: Vec<Problem>,
}

/// One thing that is wrong.
#[derive(Clone, Debug)]
pub(crate) struct Problem {
    title: String,
    help: Option<String>,
    /// The place first, then other places that bear on it.
    places: Vec<Place>,
}

/// A line of the file with a part of it marked.
#[derive(Clone, Debug)]
struct Place {
    line_number: usize,
    line: String,
    marked: Range<usize>,
    label: Option<String>,
}

impl Problem {
    /// A problem with the file as a whole.
    pub(crate) fn of_file(title: impl Into<String>, help: impl Into<String>) -> Self {
        Problem { title: printable(&title.into()), help: Some(printable(&help.into())), places: vec![] }
    }

    /// A problem at a span of bytes of the text.
    pub(crate) fn at(text: &str, span: Range<usize>, title: impl Into<String>, help: Option<String>) -> Self {
        let places = vec![Place::new(text, span, None)];
        Problem { title: printable(&title.into()), help: help.as_deref().map(printable), places }
    }

    /// The same with another place that bears on it.
    pub(crate) fn and(mut self, text: &str, span: Range<usize>, label: &str) -> Self {
        self.places.push(Place::new(text, span, Some(label.to_owned())));
        self
    }

    fn position(&self) -> (usize, usize) {
        self.places.first().map_or((0, 0), |p| (p.line_number, p.marked.start))
    }
}

impl Place {
    /// Keeps the line where the span starts; what the span has beyond that line is not marked.
    fn new(text: &str, span: Range<usize>, label: Option<String>) -> Self {
        let floor = |mut at: usize| {
            at = at.min(text.len());
            while !text.is_char_boundary(at) {
                at -= 1;
            }
            at
        };
        let (start, end) = (floor(span.start), floor(span.end));
        let line_start = text[..start].rfind('\n').map_or(0, |i| i + 1);
        let line = text[line_start..].split('\n').next().unwrap_or("").trim_end_matches('\r');
        let mark = |at: usize| (at - line_start).min(line.len());
        let line_number = 1 + text[..line_start].bytes().filter(|&b| b == b'\n').count();
        Place { line_number, line: line.to_owned(), marked: mark(start)..mark(end.max(start)), label }
    }
}

impl InputError {
    /// Problems of one file, put in the file's order.
    pub(crate) fn new(path: &Path, mut problems: Vec<Problem>) -> Self {
        problems.sort_by_key(Problem::position);
        InputError { path: printable(&path.to_string_lossy()), problems }
    }

    /// A problem with the file as a whole.
    pub(crate) fn of_file(path: &Path, title: impl Into<String>, help: impl Into<String>) -> Self {
        InputError::new(path, vec![Problem::of_file(title, help)])
    }

    /// The full diagnostic, with ANSI colours or plain.
    pub fn render(&self, color: bool) -> String {
        let renderer = if color { Renderer::styled() } else { Renderer::plain() };
        let shown = self.problems.iter().take(SHOWN).map(|problem| renderer.render(&[self.group(problem)]));
        let mut text = shown.collect::<Vec<_>>().join("\n\n");
        if self.problems.len() > SHOWN {
            text.push_str(&format!("\n\nand {} more", self.problems.len() - SHOWN));
        }
        text
    }

    fn group<'a>(&'a self, problem: &'a Problem) -> Group<'a> {
        let mut group = Group::with_title(Level::ERROR.primary_title(problem.title.as_str()));
        if problem.places.is_empty() {
            group = group.element(Origin::path(self.path.as_str()));
        }
        for same_line in problem.places.chunk_by(|a, b| a.line_number == b.line_number) {
            let marks = same_line.iter().map(|place| {
                // What belongs to the title has no label of its own.
                let kind = if place.label.is_none() { AnnotationKind::Primary } else { AnnotationKind::Context };
                kind.span(place.marked.clone()).label(place.label.as_deref())
            });
            let Place { line, line_number, .. } = &same_line[0];
            let snippet = Snippet::source(line.as_str()).line_start(*line_number).path(self.path.as_str());
            group = group.element(snippet.annotations(marks));
        }
        match &problem.help {
            Some(help) => group.element(Level::HELP.message(help.as_str())),
            None => group,
        }
    }
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render(false))
    }
}

impl std::error::Error for InputError {}

/// The text in double quotes, cut if long.
pub(crate) fn quoted(text: &str) -> String {
    let cut: String = text.chars().take(QUOTED).collect();
    let dots = if cut.len() < text.len() { "..." } else { "" };
    format!("\"{cut}{dots}\"")
}

/// The text with control and invisible characters escaped, which a terminal could obey.
pub(crate) fn printable(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\'' | '"' | '\\' => out.push(c),
            _ => out.extend(c.escape_debug()),
        }
    }
    out
}
