//! Problems as data, for editors and other programs.

use std::ops::Range;

use serde::Serialize;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// One problem of an input.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Diagnostic {
    /// The file that it is in, as it was given.
    pub path: String,
    /// Where in the file; `None` for a problem with the file as a whole.
    #[serde(flatten)]
    pub place: Option<Position>,
    /// The key of a train or study file that it is about, such as `vehicle[0].mass`, counted from 0 as in a study.
    pub key: Option<String>,
    /// What is wrong.
    pub message: String,
    /// What would be right.
    pub help: Option<String>,
    /// Related places.
    pub related: Vec<Related>,
}

/// A place in a text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Position {
    /// Line, counted from 1.
    pub line: usize,
    /// Character in the line, counted from 1.
    pub column: usize,
    /// First byte in the text, counted from 0, and the one after the last; of a table in another encoding, in the text as UTF-8.
    pub span: [usize; 2],
}

/// A place that is related to a problem.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Related {
    /// Where.
    #[serde(flatten)]
    pub place: Position,
    /// How.
    pub message: String,
}

/// The path of the innermost key that a place belongs to.
pub(super) fn key_path(root: &DeTable, place: &Range<usize>) -> Option<String> {
    let mut search = Search { at: place.start, best: None };
    search.table(root, "");
    search.best.map(|(_, path)| path)
}

struct Search {
    at: usize,
    /// Length of the span, and path.
    best: Option<(usize, String)>,
}

impl Search {
    fn table(&mut self, table: &DeTable, within: &str) {
        for (key, value) in table {
            let dot = if within.is_empty() { "" } else { "." };
            let path = format!("{within}{dot}{}", key.get_ref());
            self.consider(key.span(), &path);
            self.value(value, &path);
        }
    }

    fn value(&mut self, value: &Spanned<DeValue>, path: &str) {
        self.consider(value.span(), path);
        match value.get_ref() {
            DeValue::Table(table) => self.table(table, path),
            DeValue::Array(items) => {
                for (i, item) in items.iter().enumerate() {
                    self.value(item, &format!("{path}[{i}]"));
                }
            }
            _ => {}
        }
    }

    fn consider(&mut self, span: Range<usize>, path: &str) {
        let inner = self.best.as_ref().is_none_or(|(length, _)| span.len() <= *length);
        if span.contains(&self.at) && inner {
            self.best = Some((span.len(), path.to_owned()));
        }
    }
}
