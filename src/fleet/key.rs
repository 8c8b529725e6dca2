//! The path of a key in a train file, such as `coupler.stiffness` or `vehicle[2].mass`.

use std::fmt;

use crate::consist::{self, keys::TRAIN};
use crate::error::quoted;
use crate::keys::{Kind, Shape, Sign};
use crate::units::{self, Amount, Dimension, one_of};

/// A key of a train file that is no table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Key {
    /// The table's name; `None` for a key before all tables.
    pub table: Option<&'static str>,
    /// Which of several tables of that name, from 0.
    pub index: Option<usize>,
    /// The tables within that table, as of `coupler.limits.draft.proof`.
    pub inner: Vec<&'static str>,
    /// The key in it.
    pub leaf: &'static str,
    measure: Option<Measure>,
}

/// What a quantity is, and what it can be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Measure {
    /// What it measures.
    pub of: Dimension,
    /// The signs that it can have.
    pub sign: Sign,
    /// It may be a share.
    pub share: bool,
}

/// What is wrong with a path, and what would be right.
#[derive(Clone, Debug)]
pub struct BadKey {
    /// What is wrong.
    pub title: String,
    /// What would be right.
    pub help: String,
}

/// Tables of a train file, and whether there can be several.
fn tables() -> impl Iterator<Item = (&'static str, bool, &'static Shape)> {
    TRAIN.keys.iter().filter_map(|key| match key.kind {
        Kind::Table(shape) => Some((key.name, false, shape)),
        Kind::Tables(shape) => Some((key.name, true, shape)),
        _ => None,
    })
}

/// A key that is no table: the tables that it is in, its name, and what it measures.
type Leaf = (Vec<&'static str>, &'static str, Option<Measure>);

/// A table's keys that are no tables, each with the tables within it that it is in.
fn leaves(shape: &'static Shape) -> impl Iterator<Item = Leaf> {
    let measure = |kind| match kind {
        Kind::Quantity { of, sign, share } => Some(Measure { of, sign, share }),
        // Rows over time are varied by a factor on their times.
        Kind::Rows { .. } => Some(Measure { of: Dimension::Share, sign: Sign::Positive, share: false }),
        _ => None,
    };
    let within = |name, (mut inner, leaf, of): Leaf| {
        inner.insert(0, name);
        (inner, leaf, of)
    };
    shape.keys.iter().flat_map(move |key| match key.kind {
        Kind::Table(shape) => leaves(shape).map(|leaf| within(key.name, leaf)).collect(),
        Kind::Tables(_) => Vec::new(),
        // Of a table that a word may stand for, what can be measured; and the whole.
        Kind::Either([_, Kind::Table(shape)]) => {
            let quantities = leaves(shape).filter(|leaf| leaf.2.is_some()).map(|leaf| within(key.name, leaf));
            quantities.chain([(Vec::new(), key.name, None)]).collect()
        }
        kind => vec![(Vec::new(), key.name, measure(kind))],
    })
}

fn path((inner, leaf, _): &Leaf) -> String {
    inner.iter().chain([leaf]).copied().collect::<Vec<_>>().join(".")
}

impl Key {
    /// Reads a path.
    ///
    /// # Errors
    /// A path that no train file can have.
    pub fn parse(text: &str) -> Result<Key, BadKey> {
        let bad = |title: String, help: String| BadKey { title, help };
        let unknown = || {
            let table = |(name, many, _): (&str, bool, _)| format!("{name}{}", if many { "[0]" } else { "" });
            let fronts = one_of(tables().map(table));
            let help =
                format!("expected a key of {fronts}, such as coupler.stiffness; the train file's schema has all");
            bad(format!("no train file has a key {}", quoted(text)), help)
        };
        let Some((front, rest)) = text.split_once('.') else {
            let known = leaves(&TRAIN).find(|(inner, leaf, _)| inner.is_empty() && *leaf == text);
            let (inner, leaf, measure) = known.ok_or_else(unknown)?;
            return Ok(Key { table: None, index: None, inner, leaf, measure });
        };
        let (name, index) = match front.split_once('[') {
            None => (front, None),
            Some((name, rest)) => {
                (name, Some(rest.strip_suffix(']').and_then(|n| n.parse().ok()).ok_or_else(unknown)?))
            }
        };
        let (table, many, shape) = tables().find(|(known, ..)| *known == name).ok_or_else(unknown)?;
        let (inner, leaf, measure) = leaves(shape).find(|known| path(known) == rest).ok_or_else(|| {
            let right = format!("expected {}", one_of(leaves(shape).map(|leaf| path(&leaf))));
            bad(format!("[{table}] has no key {} to vary", quoted(rest)), right)
        })?;
        match (many, index) {
            (true, None) => {
                let help = format!(
                    "write {table}[0].{rest} for the first [[{table}]] of the file, {table}[1].{rest} for the second"
                );
                Err(bad(format!("a train file has several [[{table}]]"), help))
            }
            (false, Some(_)) => Err(bad(format!("a train file has one [{table}]"), format!("write {table}.{rest}"))),
            _ => Ok(Key { table: Some(table), index, inner, leaf, measure }),
        }
    }

    /// A regular expression of the paths that [`parse`](Key::parse) takes.
    pub(crate) fn pattern() -> String {
        let words = |shape| leaves(shape).map(|leaf| path(&leaf)).collect::<Vec<_>>().join("|").replace('.', "\\.");
        let table =
            |(name, many, shape)| format!("{name}{}\\.({})", if many { "\\[\\+?[0-9]+\\]" } else { "" }, words(shape));
        let top = leaves(&TRAIN).filter(|leaf| leaf.0.is_empty()).map(|leaf| path(&leaf));
        format!("^({})$", top.chain(tables().map(table)).collect::<Vec<_>>().join("|"))
    }

    /// What it measures; `None` for a key without a unit.
    pub fn dimension(&self) -> Option<Dimension> {
        self.measure.map(|measure| measure.of)
    }

    /// The same with sign and share.
    pub(super) fn measure(&self) -> Option<Measure> {
        self.measure
    }

    /// Whether every coupler can have its own value.
    pub(crate) fn of_every_coupler(&self) -> bool {
        self.table == Some("coupler")
    }

    /// Whether every vehicle of a group can have its own value.
    pub(crate) fn of_every_vehicle(&self) -> bool {
        self.table == Some("vehicle") && self.measure.is_some()
    }

    /// Puts a value there.
    ///
    /// # Errors
    /// A sentence where the train file has no such table.
    pub fn put<'t>(&self, train: &'t mut toml::Table, value: toml::Value) -> Result<(), String> {
        let empty = || toml::Value::Table(toml::Table::new());
        let table = self.table.unwrap_or_default();
        let tabled = train.get("vehicles").is_some() && table == "vehicle";
        let at = match (self.table, self.index) {
            (None, _) => Some(train),
            (Some(_), None) => train.entry(table).or_insert_with(empty).as_table_mut(),
            (Some(_), Some(index)) => {
                train.get_mut(table).and_then(|v| v.as_array_mut()?.get_mut(index)?.as_table_mut())
            }
        };
        let within = |table: &'t mut toml::Table, inner: &&str| {
            let entry = table.entry(*inner).or_insert_with(empty);
            if let Some(named) = entry.as_str().and_then(|name| consist::application_table(inner, name)) {
                *entry = toml::Value::Table(named);
            }
            entry.as_table_mut()
        };
        let at = at.and_then(|table| self.inner.iter().try_fold(table, within));
        let missing = || {
            let index = self.index.unwrap_or(0);
            let rows = if tabled {
                ": its vehicles are rows of a table, which keep their own values; to vary them, write them as [[vehicle]]"
            } else {
                ""
            };
            format!("the train file has no {table}[{index}] (counted from 0){rows}")
        };
        let at = at.ok_or_else(missing)?;
        let of_application = self.inner.first().filter(|inner| APPLICATIONS.contains(inner));
        if let Some(application) = of_application.filter(|_| at.is_empty()) {
            return Err(format!("its {table}[{}] has no {application}", self.index.unwrap_or(0)));
        }
        let factor = value.as_str().filter(|_| self.leaf == "build_up").and_then(share);
        match (factor, at.get_mut(self.leaf)) {
            (Some(factor), Some(rows)) => scale_times(rows, factor),
            _ => {
                at.insert(self.leaf.to_owned(), value);
            }
        }
        Ok(())
    }
}

/// Keys of a scenario whose table a word may stand for.
const APPLICATIONS: [&str; 2] = ["emergency", "service"];

fn share(text: &str) -> Option<f64> {
    match units::parse(text, Dimension::Share, false).ok()? {
        Amount::Si(share) | Amount::Share(share) => Some(share),
    }
}

/// Multiplies the times of rows, which stand first in each; what is no time is left for the reader to refuse.
fn scale_times(rows: &mut toml::Value, factor: f64) {
    for time in rows.as_array_mut().into_iter().flatten().filter_map(|row| row.as_array_mut()?.first_mut()) {
        if let Some(Ok(Amount::Si(time_s))) = time.as_str().map(|text| units::parse(text, Dimension::Time, false)) {
            *time = super::spread::written(factor * time_s, Dimension::Time, false);
        }
    }
}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(table) = self.table {
            write!(f, "{table}")?;
        }
        if let Some(index) = self.index {
            write!(f, "[{index}]")?;
        }
        let dot = if self.table.is_some() { "." } else { "" };
        write!(f, "{dot}{}", path(&(self.inner.clone(), self.leaf, None)))
    }
}
