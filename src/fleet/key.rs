//! The path of a key in a train file, such as `coupler.stiffness` or `vehicle[2].mass`.

use std::fmt;

use crate::error::quoted;
use crate::units::{Dimension, one_of};

/// Tables of a train file, whether there can be several, and the keys that can be varied.
const TABLES: [(&str, bool, &[&str]); 5] = [
    ("coupler", false, &["stiffness", "rated_load", "rated_buff"]),
    ("vehicle", true, &["mass", "count", "held", "length", "label"]),
    ("coupler_override", true, &["at", "stiffness", "rated_load", "rated_buff"]),
    ("load", false, &["uniform"]),
    ("scenario", true, &["coupler", "at", "force", "duration", "horizon"]),
];

/// A key of a train file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Key {
    /// The table's name.
    pub table: &'static str,
    /// Which of several tables of that name, from 0.
    pub index: Option<usize>,
    /// The key in it.
    pub leaf: &'static str,
}

/// What is wrong with a path, and what would be right.
#[derive(Clone, Debug)]
pub struct BadKey {
    /// What is wrong.
    pub title: String,
    /// What would be right.
    pub help: String,
}

impl Key {
    /// Reads a path.
    ///
    /// # Errors
    /// A path that no train file can have.
    pub fn parse(text: &str) -> Result<Key, BadKey> {
        let bad = |title: String, help: String| BadKey { title, help };
        let all = || {
            let shown = TABLES.iter().flat_map(|(name, many, leaves)| {
                leaves.iter().map(move |leaf| format!("{name}{}.{leaf}", if *many { "[0]" } else { "" }))
            });
            format!("expected {}", one_of(shown))
        };
        let unknown = || bad(format!("no train file has a key {}", quoted(text)), all());
        let (front, leaf) = text.rsplit_once('.').ok_or_else(unknown)?;
        let (name, index) = match front.split_once('[') {
            None => (front, None),
            Some((name, rest)) => {
                (name, Some(rest.strip_suffix(']').and_then(|n| n.parse().ok()).ok_or_else(unknown)?))
            }
        };
        let &(table, many, leaves) = TABLES.iter().find(|(known, ..)| *known == name).ok_or_else(unknown)?;
        let leaf = leaves.iter().find(|known| **known == leaf).ok_or_else(|| {
            bad(format!("[{table}] has no key {} to vary", quoted(leaf)), format!("expected {}", one_of(leaves)))
        })?;
        match (many, index) {
            (true, None) => {
                let help = format!(
                    "write {table}[0].{leaf} for the first [[{table}]] of the file, {table}[1].{leaf} for the second"
                );
                Err(bad(format!("a train file has several [[{table}]]"), help))
            }
            (false, Some(_)) => Err(bad(format!("a train file has one [{table}]"), format!("write {table}.{leaf}"))),
            _ => Ok(Key { table, index, leaf }),
        }
    }

    /// A regular expression of the paths that [`parse`](Key::parse) takes.
    pub(crate) fn pattern() -> String {
        let table = |(name, many, leaves): &(&str, bool, &[&str])| {
            format!("{name}{}\\.({})", if *many { "\\[\\+?[0-9]+\\]" } else { "" }, leaves.join("|"))
        };
        format!("^({})$", TABLES.iter().map(table).collect::<Vec<_>>().join("|"))
    }

    /// What it measures; `None` for a key without a unit.
    pub fn dimension(&self) -> Option<Dimension> {
        Some(match self.leaf {
            "stiffness" => Dimension::Stiffness,
            "rated_load" | "rated_buff" | "uniform" | "force" => Dimension::Force,
            "mass" => Dimension::Mass,
            "length" => Dimension::Length,
            "duration" | "horizon" => Dimension::Time,
            _ => return None,
        })
    }

    /// Whether every coupler can have its own value.
    pub fn of_every_coupler(&self) -> bool {
        self.table == "coupler"
    }

    /// Puts a value there.
    ///
    /// # Errors
    /// A sentence where the train file has no such table.
    pub fn put(&self, train: &mut toml::Table, value: toml::Value) -> Result<(), String> {
        let at = match self.index {
            None => train.entry(self.table).or_insert_with(|| toml::Value::Table(toml::Table::new())).as_table_mut(),
            Some(index) => train.get_mut(self.table).and_then(|v| v.as_array_mut()?.get_mut(index)?.as_table_mut()),
        };
        let missing = || format!("the train file has no {}[{}] (counted from 0)", self.table, self.index.unwrap_or(0));
        at.ok_or_else(missing)?.insert(self.leaf.to_owned(), value);
        Ok(())
    }

    /// Gives each coupler its own value, but for those that the train file already overrides.
    pub fn put_each(&self, train: &mut toml::Table, values: Vec<toml::Value>) {
        let overrides = train.entry("coupler_override").or_insert_with(|| toml::Value::Array(vec![]));
        let Some(overrides) = overrides.as_array_mut() else { return };
        let of_this_key =
            overrides.iter().filter_map(|o| o.as_table().filter(|t| t.contains_key(self.leaf))?.get("at"));
        let numbers = |at: &toml::Value| match at {
            toml::Value::Array(list) => list.iter().filter_map(toml::Value::as_integer).collect(),
            one => one.as_integer().into_iter().collect::<Vec<_>>(),
        };
        let taken: std::collections::HashSet<i64> = of_this_key.flat_map(numbers).collect();
        for (value, number) in values.into_iter().zip(1i64..).filter(|(_, number)| !taken.contains(number)) {
            let entries = [("at".to_owned(), toml::Value::Integer(number)), (self.leaf.to_owned(), value)];
            overrides.push(toml::Value::Table(entries.into_iter().collect()));
        }
    }
}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.index {
            None => write!(f, "{}.{}", self.table, self.leaf),
            Some(index) => write!(f, "{}[{index}].{}", self.table, self.leaf),
        }
    }
}
