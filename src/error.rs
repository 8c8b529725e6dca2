//! What can be wrong with an input, and where: a message with file, line, column and the text underlined.

mod diagnostic;

use std::fmt;
use std::ops::Range;
use std::path::Path;

use annotate_snippets::{AnnotationKind, Group, Level, Origin, Renderer, Snippet};
use toml::de::DeTable;

pub use diagnostic::{Diagnostic, Position, Related};

/// More problems than this in one file are counted, not shown.
const MOST_SHOWN: usize = 20;
/// More problems than this in one file are counted, not kept: a hostile file has one in every few bytes.
const MOST_KEPT: usize = 1000;
/// So many bytes of a line are kept; of a place beyond them only the numbers are shown.
const MOST_LINE_BYTES: usize = 20_000;
/// Quoted text longer than this is cut.
const MOST_QUOTED: usize = 60;

/// A train file that cannot be used, with every problem found in it; `Display` is [`InputError::render`] without colour.
#[derive(Clone, Debug)]
pub struct InputError {
    path: String,
    shown: Vec<Shown>,
    /// How many more there are.
    more: usize,
}

/// What is wrong with a text so far.
#[derive(Default)]
pub(crate) struct Problems {
    kept: Vec<Problem>,
    beyond: usize,
}

/// One thing that is wrong, with its place in bytes of the text, if it has one, and a related place.
pub(crate) struct Problem {
    title: String,
    help: Option<String>,
    place: Option<Range<usize>>,
    other: Option<(Range<usize>, &'static str)>,
}

/// A problem with the lines that it concerns, so that the text is needed no more.
#[derive(Clone, Debug)]
struct Shown {
    title: String,
    help: Option<String>,
    key: Option<String>,
    places: Vec<Place>,
}

/// A line of the file with a part of it marked; the problem's own place has no label, for the title is its label.
#[derive(Clone, Debug)]
struct Place {
    span: Range<usize>,
    line_number: usize,
    column: usize,
    line: String,
    in_view: bool,
    marked: Range<usize>,
    label: Option<&'static str>,
}

impl Problem {
    /// A problem with the file as a whole.
    pub(crate) fn of_file(title: impl Into<String>, help: impl Into<String>) -> Self {
        Problem { title: title.into(), help: Some(help.into()), place: None, other: None }
    }

    /// A problem at a place in the text.
    pub(crate) fn at(place: Range<usize>, title: impl Into<String>, help: Option<String>) -> Self {
        Problem { title: title.into(), help, place: Some(place), other: None }
    }

    /// The same with words before its title.
    pub(crate) fn after(self, words: &str) -> Self {
        Problem { title: format!("{words}{}", self.title), ..self }
    }

    /// Where in the text it starts, if it has a place.
    pub(crate) fn start(&self) -> Option<usize> {
        self.place.as_ref().map(|place| place.start)
    }

    /// The same with a related place.
    pub(crate) fn and(self, place: Range<usize>, label: &'static str) -> Self {
        Problem { other: Some((place, label)), ..self }
    }

    fn shown(&self, text: &str) -> Shown {
        let own = self.place.iter().map(|span| Place::new(text, span, None));
        let other = self.other.iter().map(|(span, label)| Place::new(text, span, Some(label)));
        let help = self.help.as_deref().map(printable);
        Shown { title: printable(&self.title), help, key: None, places: own.chain(other).collect() }
    }
}

impl Problems {
    pub(crate) fn note(&mut self, problem: Problem) {
        if self.kept.len() < MOST_KEPT {
            self.kept.push(problem);
        } else {
            self.beyond += 1;
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.kept.is_empty()
    }

    /// Adds those of another list, each changed by `change`.
    pub(crate) fn append(&mut self, others: Problems, change: impl Fn(Problem) -> Problem) {
        others.kept.into_iter().for_each(|problem| self.note(change(problem)));
        self.beyond += others.beyond;
    }
}

impl Place {
    /// Keeps the line where the span starts, up to a limit; what the span has beyond that is not marked.
    fn new(text: &str, span: &Range<usize>, label: Option<&'static str>) -> Self {
        let (start, end) = (floor(text, span.start), floor(text, span.end));
        // A place between the two characters of one line end belongs to the line that they end.
        let start = if text[..start].ends_with('\r') && text[start..].starts_with('\n') { start - 1 } else { start };
        let line_start = text[..start].rfind(['\n', '\r']).map_or(0, |i| i + 1);
        let line_end = start + text[start..].find(['\n', '\r']).unwrap_or(text.len() - start);
        let line = text[line_start..floor(text, line_end.min(line_start + MOST_LINE_BYTES))].trim_end_matches('\r');
        let mark = |at: usize| shown(&line[..(at - line_start).min(line.len())]).len();
        Place {
            span: start..end.max(start),
            line_number: 1 + line_ends(&text[..line_start]),
            column: 1 + text[line_start..start].chars().count(),
            in_view: start <= line_start + line.len(),
            line: shown(line),
            marked: mark(start)..mark(end.max(start)),
            label,
        }
    }
}

/// How many lines a text ends: by LF, by CR and LF, or by CR alone.
fn line_ends(text: &str) -> usize {
    let bytes = text.as_bytes();
    (0..bytes.len()).filter(|&i| bytes[i] == b'\n' || bytes[i] == b'\r' && bytes.get(i + 1) != Some(&b'\n')).count()
}

/// A line of a file with a sign for characters that control a terminal; the renderer replaces those of ASCII.
fn shown(line: &str) -> String {
    line.chars().map(|c| if controls_display(c) && !c.is_ascii() { '\u{fffd}' } else { c }).collect()
}

/// The start of the character that byte `at` of the text belongs to.
fn floor(text: &str, at: usize) -> usize {
    (0..=at.min(text.len())).rev().find(|&i| text.is_char_boundary(i)).unwrap_or(0)
}

impl InputError {
    /// Problems of one text, put in its order.
    pub(crate) fn new(path: &Path, text: &str, mut problems: Problems) -> Self {
        problems.kept.sort_by_key(|p| p.place.as_ref().map(|span| span.start));
        let shown: Vec<Shown> = problems.kept.iter().take(MOST_SHOWN).map(|p| p.shown(text)).collect();
        let more = problems.kept.len() - shown.len() + problems.beyond;
        InputError { path: printable_path(path), shown, more }
    }

    /// One problem of a text.
    pub(crate) fn one(path: &Path, text: &str, problem: Problem) -> Self {
        InputError::new(path, text, Problems { kept: vec![problem], beyond: 0 })
    }

    /// A problem with the file as a whole.
    pub fn of_file(path: &Path, title: impl Into<String>, help: impl Into<String>) -> Self {
        InputError::one(path, "", Problem::of_file(title, help))
    }

    /// The same with the keys that the problems are about; `root` is the text as TOML.
    pub(crate) fn with_keys(mut self, root: &DeTable) -> Self {
        for shown in &mut self.shown {
            shown.key = shown.places.first().and_then(|place| diagnostic::key_path(root, &place.span));
        }
        self
    }

    /// The problems as data, in the order of the text: those that [`render`](InputError::render) shows, and how many more there are.
    pub fn problems(&self) -> (Vec<Diagnostic>, usize) {
        let position = |p: &Place| Position { line: p.line_number, column: p.column, span: [p.span.start, p.span.end] };
        let one = |shown: &Shown| {
            let own = shown.places.iter().find(|place| place.label.is_none());
            let others = shown.places.iter().filter_map(|p| p.label.map(|label| (p, label)));
            Diagnostic {
                path: self.path.clone(),
                place: own.map(position),
                key: shown.key.clone(),
                message: shown.title.clone(),
                help: shown.help.clone().filter(|help| !help.is_empty()),
                related: others.map(|(p, label)| Related { place: position(p), message: label.to_owned() }).collect(),
            }
        };
        (self.shown.iter().map(one).collect(), self.more)
    }

    /// The full diagnostic, with ANSI colours or plain.
    pub fn render(&self, color: bool) -> String {
        let renderer = if color { Renderer::styled() } else { Renderer::plain() };
        let shown = self.shown.iter().map(|problem| renderer.render(&[self.group(problem)]));
        let more = (self.more > 0).then(|| format!("and {} more problems", self.more));
        shown.chain(more).collect::<Vec<_>>().join("\n\n")
    }

    /// The first problem with its place, and how many more there are, on one line.
    pub fn brief(&self) -> String {
        let place = self.shown.first().and_then(|s| s.places.first());
        let place = place.map_or(String::new(), |p| format!(":{}:{}", p.line_number, p.column));
        format!("{}{place}: {}", self.path, self.titles())
    }

    /// What would be right instead of the first problem.
    pub(crate) fn help(&self) -> String {
        self.shown.first().and_then(|first| first.help.clone()).unwrap_or_default()
    }

    /// The first problem without its place, and how many more there are, on one line.
    pub(crate) fn titles(&self) -> String {
        let more = self.more + self.shown.len().saturating_sub(1);
        let more = if more > 0 { format!(" (and {more} more)") } else { String::new() };
        self.shown.first().map_or(String::new(), |first| first.title.clone()) + &more
    }

    fn group<'a>(&'a self, problem: &'a Shown) -> Group<'a> {
        let mut group = Group::with_title(Level::ERROR.primary_title(problem.title.as_str()));
        if problem.places.is_empty() {
            group = group.element(Origin::path(self.path.as_str()));
        }
        for same_line in problem.places.chunk_by(|a, b| a.line_number == b.line_number) {
            let Place { line, line_number, column, .. } = &same_line[0];
            if same_line.iter().any(|place| !place.in_view) {
                group = group.element(Origin::path(self.path.as_str()).line(*line_number).char_column(*column));
                continue;
            }
            let marks = same_line.iter().map(|place| {
                let kind = if place.label.is_none() { AnnotationKind::Primary } else { AnnotationKind::Context };
                kind.span(place.marked.clone()).label(place.label)
            });
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
    let cut: String = text.chars().take(MOST_QUOTED).collect();
    let dots = if cut.len() < text.len() { "..." } else { "" };
    format!("\"{cut}{dots}\"")
}

/// Whether a character controls the display: control characters, line ends, changes of the reading direction.
pub(crate) fn controls_display(c: char) -> bool {
    c.is_control() || matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// The text with spaces for characters that control the display.
pub(crate) fn harmless(text: &str) -> String {
    text.chars().map(|c| if controls_display(c) { ' ' } else { c }).collect()
}

/// The text with control and invisible characters escaped.
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

/// The same of a path, as a message shows it.
pub fn printable_path(path: &Path) -> String {
    printable(&path.to_string_lossy())
}
