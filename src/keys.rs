//! What the keys of a file are: one table for the reader, which takes names, kinds and limits from it, and for the JSON
//! Schema that editors check by ([`schema`](crate::schema)).

use crate::units::Dimension;

/// Which signs a quantity may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sign {
    Positive,
    NonZero,
    NotNegative,
    Any,
}

impl Sign {
    /// What is wrong with a number, and what would be right.
    pub(crate) fn refuses(self, value: f64) -> Option<[&'static str; 2]> {
        let right = match self {
            Sign::Positive => "expected a value above zero",
            Sign::NotNegative => "expected zero or more",
            Sign::NonZero => "expected a force other than zero",
            Sign::Any => "expected a finite number",
        };
        let found = match self {
            _ if value.is_nan() => "is not a number",
            _ if value.is_infinite() => "is infinite",
            Sign::Positive | Sign::NotNegative if value < 0.0 => "is negative",
            Sign::Positive | Sign::NonZero if value == 0.0 => "is zero",
            _ => return None,
        };
        Some([found, right])
    }
}

/// What the value of a key is.
#[derive(Clone, Copy)]
pub(crate) enum Kind {
    /// A string with a number and its unit; also a percentage if `share`.
    Quantity { of: Dimension, sign: Sign, share: bool },
    /// A quantity of whatever another key measures, or a percentage.
    AnyQuantity(Sign),
    /// A number without a unit, more than 0.
    Positive,
    /// A number without a unit, from 0 to under 1.
    Ratio,
    /// A whole number.
    Whole { from: usize, to: usize },
    /// A string of one line, up to [`LONGEST_NAME`] characters.
    Name,
    /// A string that a regular expression describes.
    Pattern(fn() -> String),
    /// true or false.
    Flag,
    /// One of these strings.
    Word(&'static [&'static str]),
    /// Any value in a train file except a table.
    AnyValue,
    /// One of these.
    Either(&'static [Kind]),
    /// Such a value, or a list of at least one of them.
    OneOrMore(&'static Kind),
    /// A list of rows of quantities, each of at least so many of these.
    Rows { of: &'static [(&'static str, Dimension, Sign)], least: usize },
    /// A table.
    Table(&'static Shape),
    /// A list of tables.
    Tables(&'static Shape),
}

/// Names of more characters are refused.
pub(crate) const LONGEST_NAME: usize = 200;

/// A key that a table may have.
pub(crate) struct Key {
    pub(crate) name: &'static str,
    pub(crate) kind: Kind,
    pub(crate) required: bool,
    /// What it means, for the person who writes the file.
    pub(crate) about: &'static str,
    /// As a TOML value, or a string without its quotes.
    pub(crate) example: &'static str,
    /// The default, written in the same way; empty where no value equals an absent key.
    pub(crate) default: &'static str,
}

impl Key {
    pub(crate) const fn required(name: &'static str, kind: Kind, about: &'static str, example: &'static str) -> Key {
        Key { name, kind, required: true, about, example, default: "" }
    }

    pub(crate) const fn optional(name: &'static str, kind: Kind, about: &'static str, example: &'static str) -> Key {
        Key { name, kind, required: false, about, example, default: "" }
    }

    pub(crate) const fn or(self, default: &'static str) -> Key {
        Key { default, ..self }
    }
}

/// A table of fixed keys.
pub(crate) struct Shape {
    /// As it is written: `[coupler]`.
    pub(crate) name: &'static str,
    pub(crate) about: &'static str,
    pub(crate) keys: &'static [Key],
    /// Of these keys exactly one is there; empty where there is no such choice.
    pub(crate) exactly_one: &'static [&'static str],
    /// Of these keys at most one is there.
    pub(crate) at_most_one: &'static [&'static str],
    /// It has at least so many keys.
    pub(crate) least: usize,
    /// The key whose word decides which others the table has, and the words.
    pub(crate) variants: Option<(&'static str, &'static [Variant])>,
}

/// What belongs to one word of a key.
pub(crate) struct Variant {
    pub(crate) word: &'static str,
    /// Of the keys that belong to some word, those that belong to this one.
    pub(crate) own: &'static [&'static str],
    /// Sets of keys, exactly one of which is there in full.
    pub(crate) needs: &'static [&'static [&'static str]],
}

impl Shape {
    pub(crate) const fn new(name: &'static str, about: &'static str, keys: &'static [Key]) -> Shape {
        Shape { name, about, keys, exactly_one: &[], at_most_one: &[], least: 0, variants: None }
    }

    pub(crate) fn key(&self, name: &str) -> Option<&'static Key> {
        self.keys.iter().find(|key| key.name == name)
    }

    pub(crate) fn names(&self) -> impl Iterator<Item = &'static str> + Clone {
        self.keys.iter().map(|key| key.name)
    }

    /// What belongs to the words of its key of variants.
    pub(crate) fn variants(&self) -> &'static [Variant] {
        self.variants.map_or(&[], |(_, variants)| variants)
    }

    /// The keys that belong to other words but not to this one, each with the first of those.
    pub(crate) fn foreign(&self, word: &str) -> impl Iterator<Item = (&'static str, &'static Variant)> {
        let variants = self.variants();
        let own = variants.iter().find(|v| v.word == word).map_or(&[][..], |v| v.own);
        let others = self.names().filter(|key| !own.contains(key));
        others.filter_map(|key| Some((key, variants.iter().find(|v| v.own.contains(&key))?)))
    }
}
