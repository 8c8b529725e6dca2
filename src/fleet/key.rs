//! The path of a key in a train file, such as `coupler.stiffness` or `vehicle[2].mass`.

use std::fmt;

use crate::consist::keys::TRAIN;
use crate::error::quoted;
use crate::keys::{Kind, Shape, Sign};
use crate::units::{Dimension, one_of};

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
    dimension: Option<Dimension>,
    /// Its quantity is more than 0, or at least not less.
    one_sign: bool,
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
type Leaf = (Vec<&'static str>, &'static str, Option<(Dimension, bool)>);

/// A table's keys that are no tables, each with the tables within it that it is in.
fn leaves(shape: &'static Shape) -> impl Iterator<Item = Leaf> {
    let dimension = |kind| match kind {
        Kind::Quantity { of, sign, .. } => Some((of, matches!(sign, Sign::Positive | Sign::NotNegative))),
        _ => None,
    };
    let within = |name, (mut inner, leaf, of): Leaf| {
        inner.insert(0, name);
        (inner, leaf, of)
    };
    shape.keys.iter().flat_map(move |key| match key.kind {
        Kind::Table(shape) => leaves(shape).map(|leaf| within(key.name, leaf)).collect(),
        Kind::Tables(_) => Vec::new(),
        kind => vec![(Vec::new(), key.name, dimension(kind))],
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
            let (inner, leaf, of) = known.ok_or_else(unknown)?;
            let (dimension, one_sign) = (of.map(|o| o.0), of.is_some_and(|o| o.1));
            return Ok(Key { table: None, index: None, inner, leaf, dimension, one_sign });
        };
        let (name, index) = match front.split_once('[') {
            None => (front, None),
            Some((name, rest)) => {
                (name, Some(rest.strip_suffix(']').and_then(|n| n.parse().ok()).ok_or_else(unknown)?))
            }
        };
        let (table, many, shape) = tables().find(|(known, ..)| *known == name).ok_or_else(unknown)?;
        let (inner, leaf, of) = leaves(shape).find(|known| path(known) == rest).ok_or_else(|| {
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
            _ => {
                let (dimension, one_sign) = (of.map(|o| o.0), of.is_some_and(|o| o.1));
                Ok(Key { table: Some(table), index, inner, leaf, dimension, one_sign })
            }
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
        self.dimension
    }

    /// Whether its quantity cannot be negative.
    pub fn has_one_sign(&self) -> bool {
        self.one_sign
    }

    /// Whether every vehicle of its group can have its own value.
    pub fn of_every_vehicle(&self) -> bool {
        self.table == Some("vehicle") && self.inner.is_empty() && self.dimension.is_some()
    }

    /// Whether every coupler can have its own value.
    pub fn of_every_coupler(&self) -> bool {
        self.table == Some("coupler") && self.inner.is_empty()
    }

    /// Puts a value there.
    ///
    /// # Errors
    /// A sentence where the train file has no such table.
    pub fn put<'t>(&self, train: &'t mut toml::Table, value: toml::Value) -> Result<(), String> {
        let empty = || toml::Value::Table(toml::Table::new());
        let table = self.table.unwrap_or_default();
        let at = match (self.table, self.index) {
            (None, _) => Some(train),
            (Some(_), None) => train.entry(table).or_insert_with(empty).as_table_mut(),
            (Some(_), Some(index)) => {
                train.get_mut(table).and_then(|v| v.as_array_mut()?.get_mut(index)?.as_table_mut())
            }
        };
        let within =
            |table: &'t mut toml::Table, inner: &&str| table.entry(*inner).or_insert_with(empty).as_table_mut();
        let at = at.and_then(|table| self.inner.iter().try_fold(table, within));
        let missing = || format!("the train file has no {table}[{}] (counted from 0)", self.index.unwrap_or(0));
        at.ok_or_else(missing)?.insert(self.leaf.to_owned(), value);
        Ok(())
    }

    /// Gives couplers values of their own; `None` leaves one as it is.
    pub fn put_each(&self, train: &mut toml::Table, values: impl Iterator<Item = Option<toml::Value>>) {
        let overrides = train.entry("coupler_override").or_insert_with(|| toml::Value::Array(vec![]));
        let Some(overrides) = overrides.as_array_mut() else { return };
        for (value, number) in values.zip(1i64..) {
            let Some(value) = value else { continue };
            let entries = [("at".to_owned(), toml::Value::Integer(number)), (self.leaf.to_owned(), value)];
            overrides.push(toml::Value::Table(entries.into_iter().collect()));
        }
    }

    /// How many vehicles its `[[vehicle]]` table stands for; `None` where there is no such table.
    pub fn vehicles(&self, train: &toml::Table) -> Option<usize> {
        let group = train.get("vehicle")?.as_array()?.get(self.index?)?.as_table()?;
        let count = group.get("count").map_or(Some(1), toml::Value::as_integer)?;
        usize::try_from(count).ok()
    }

    /// Spells its `[[vehicle]]` table out, with a value of its own for each vehicle.
    pub fn put_each_vehicle(&self, train: &mut toml::Table, values: Vec<toml::Value>) {
        let Some(groups) = train.get_mut("vehicle").and_then(toml::Value::as_array_mut) else { return };
        let Some(index) = self.index.filter(|i| *i < groups.len()) else { return };
        let one = |value: toml::Value| {
            let mut vehicle = groups[index].clone();
            if let Some(table) = vehicle.as_table_mut() {
                table.remove("count");
                table.insert(self.leaf.to_owned(), value);
            }
            vehicle
        };
        let spelt: Vec<toml::Value> = values.into_iter().map(one).collect();
        groups.splice(index..=index, spelt);
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
