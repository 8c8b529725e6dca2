//! Reading a spanned TOML tree: every getter reports where its value stands and what would be right there.

use std::borrow::Cow;
use std::cell::{Cell, RefCell};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::Files;
use crate::error::{InputError, Problem, Problems, controls_display, printable_path, quoted};
use crate::keys::{Key, Kind, LONGEST_NAME, Shape, Sign};
use crate::train::Doubt;
use crate::units::{self, Amount, Dimension, UnitSystem, one_of};

/// What to do about a path of Windows between double quotes.
pub(crate) const BACKSLASH: &str = "write / between folders, as in \"data/consist.csv\": a backslash between double quotes starts an \
     escape, such as \\t for a tab, and only on Windows does one stand between folders";

/// What was found wrong with a text so far.
#[derive(Default)]
pub(crate) struct Found {
    problems: RefCell<Problems>,
    doubts: RefCell<Vec<Doubt>>,
    /// Quantities in metric units, and in US units; units that both have are not counted.
    written_in: [Cell<usize>; 2],
}

/// Proof that a problem has been noted: whoever holds one need not note it again.
#[derive(Debug)]
pub(crate) struct Reported(());

/// A value, or a problem that has been noted.
pub(crate) type Read<T> = Result<T, Reported>;

impl Reported {
    /// Of a problem that has been noted for something else at the same place.
    pub(super) fn again() -> Reported {
        Reported(())
    }
}

impl Found {
    /// The units in which most quantities are written.
    pub(crate) fn units(&self) -> UnitSystem {
        let [metric, us] = &self.written_in;
        if us.get() > metric.get() { UnitSystem::Us } else { UnitSystem::Si }
    }

    pub(crate) fn note(&self, problem: Problem) -> Reported {
        self.problems.borrow_mut().note(problem);
        Reported(())
    }

    /// Something that is probably not meant, and no error.
    pub(crate) fn doubt(&self, doubt: Doubt) {
        let mut doubts = self.doubts.borrow_mut();
        if !doubts.contains(&doubt) {
            doubts.push(doubt);
        }
    }

    /// What is wrong, and what is doubtful.
    pub(crate) fn into_parts(self) -> (Problems, Vec<Doubt>) {
        (self.problems.into_inner(), self.doubts.into_inner())
    }
}

/// A table with the keys that it may have, and the place of its header.
#[derive(Clone)]
pub(crate) struct Table<'s> {
    found: &'s Found,
    shape: &'static Shape,
    table: &'s DeTable<'s>,
    span: Range<usize>,
}

impl<'s> Table<'s> {
    /// The whole file.
    pub(crate) fn root(found: &'s Found, table: &'s DeTable<'s>, shape: &'static Shape) -> Self {
        Table { found, shape, table, span: 0..0 }.checked()
    }

    /// A table that was made from one row of a table of vehicles.
    pub(super) fn of_row(
        found: &'s Found,
        table: &'s DeTable<'s>,
        shape: &'static Shape,
        span: Range<usize>,
    ) -> Table<'s> {
        Table { found, shape, table, span }
    }

    /// The same, with every key noted that it cannot have.
    fn checked(self) -> Self {
        let name = self.shape.name;
        for key in self.table.keys().filter(|key| self.shape.key(key.get_ref()).is_none()) {
            let title = format!("unknown key {} in {name}", quoted(key.get_ref()));
            let all = format!("the keys of {name} are {}", self.shape.names().collect::<Vec<_>>().join(", "));
            let help =
                self.nearest(key.get_ref()).map_or(all.clone(), |near| format!("did you mean \"{near}\"? {all}"));
            self.note_at(key.span(), title, help);
        }
        self
    }

    /// The key that was probably meant.
    fn nearest(&self, key: &str) -> Option<&'static str> {
        // A long key is near no known one, and in a table of very many keys a hint is not worth the time.
        if key.len() > 40 || self.table.len() > 100 {
            return None;
        }
        let distance = |known: &str| strsim::damerau_levenshtein(&key.to_lowercase(), known);
        let near = self.shape.names().min_by_key(|known| distance(known));
        near.filter(|known| distance(known) <= (known.len() / 3).max(1))
    }

    /// The value of a key of its shape, if it is there.
    pub(crate) fn get(&self, key: &str) -> Option<Value<'s>> {
        let (_, value) = self.table.get_key_value(key)?;
        let Some(key) = self.shape.key(key) else { unreachable!("{key} is no key of {}", self.shape.name) };
        Some(Value { found: self.found, key, value: value.get_ref(), span: value.span() })
    }

    /// Whether it has no key at all.
    pub(super) fn is_empty(&self) -> bool {
        self.table.is_empty()
    }

    /// Whether keys have been noted that it cannot have.
    pub(super) fn has_unknown_keys(&self) -> bool {
        self.table.keys().any(|key| self.shape.key(key.get_ref()).is_none())
    }

    /// The place of a key, if it is there.
    pub(crate) fn key_span(&self, key: &str) -> Option<Range<usize>> {
        self.table.get_key_value(key).map(|(k, _)| k.span())
    }

    /// The place of what a path names, such as `vehicle[3].mass`, or else of the innermost table on its way.
    pub(crate) fn place(&self, path: &str) -> Option<Range<usize>> {
        let mut table = self.table;
        let mut at = None;
        for step in path.split('.') {
            let (name, index) = step.split_once('[').map_or((step, None), |(name, index)| (name, Some(index)));
            let Some(value) = table.get(name) else { break };
            let index = index.and_then(|index| index.strip_suffix(']')?.parse::<usize>().ok());
            let item = match (value.get_ref(), index) {
                (DeValue::Array(items), Some(index)) => items.get(index).unwrap_or(value),
                _ => value,
            };
            at = Some(item.span());
            let DeValue::Table(inner) = item.get_ref() else { break };
            table = inner;
        }
        at
    }

    /// The value of a key that must be there.
    pub(crate) fn require(&self, key: &str, right: &str) -> Read<Value<'s>> {
        let misspelt = || self.table.keys().any(|k| *k.get_ref() != key && self.nearest(k.get_ref()) == Some(key));
        match self.get(key) {
            Some(value) => Ok(value),
            None if misspelt() => Err(Reported(())),
            None => Err(self.wrong(format!("{} has no {key}", self.shape.name), right)),
        }
    }

    /// Notes a problem with this table as a whole.
    pub(crate) fn wrong(&self, title: impl Into<String>, help: impl Into<String>) -> Reported {
        if self.span.is_empty() {
            return self.found.note(Problem::of_file(title, help));
        }
        self.note_at(self.span.clone(), title, help)
    }

    /// Notes a problem at a place within it.
    pub(crate) fn note_at(&self, span: Range<usize>, title: impl Into<String>, help: impl Into<String>) -> Reported {
        self.found.note(Problem::at(span, title, Some(help.into())))
    }

    /// Notes something that is probably not meant, and no error.
    pub(crate) fn doubt(&self, doubt: Doubt) {
        self.found.doubt(doubt);
    }

    /// Notes a problem at a place within it, with a second place that causes it.
    pub(crate) fn note_because(
        &self,
        span: Range<usize>,
        title: impl Into<String>,
        help: impl Into<String>,
        other: Range<usize>,
        label: &'static str,
    ) -> Reported {
        let problem = Problem::at(span, title, Some(help.into()));
        self.found.note(problem.and(other, label))
    }
}

/// A value with its key and place.
#[derive(Clone)]
pub(crate) struct Value<'s> {
    found: &'s Found,
    key: &'static Key,
    value: &'s DeValue<'s>,
    span: Range<usize>,
}

impl<'s> Value<'s> {
    /// Notes that this value is wrong.
    pub(crate) fn wrong(&self, title: impl Into<String>, help: impl Into<String>) -> Reported {
        self.found.note(Problem::at(self.span.clone(), title, Some(help.into())))
    }

    /// Notes that this value is wrong because of another place.
    pub(crate) fn wrong_because(
        &self,
        title: impl Into<String>,
        help: impl Into<String>,
        other: Range<usize>,
        label: &'static str,
    ) -> Reported {
        let problem = Problem::at(self.span.clone(), title, Some(help.into()));
        self.found.note(problem.and(other, label))
    }

    /// Notes that this value is of the wrong type.
    pub(crate) fn wrong_type(&self, right: impl Into<String>) -> Reported {
        self.wrong(format!("{} is {}", self.key.name, type_name(self.value)), right)
    }

    /// Notes that this is a word that has no meaning here.
    pub(crate) fn wrong_word(&self, text: &str, right: impl Into<String>) -> Reported {
        self.wrong(format!("{} is {}", self.key.name, quoted(text)), right)
    }

    /// The name of its key.
    pub(super) fn name_of_key(&self) -> &'static str {
        self.key.name
    }

    pub(crate) fn span(&self) -> Range<usize> {
        self.span.clone()
    }

    /// The string itself, if it is one.
    pub(crate) fn as_text(&self) -> Option<&'s str> {
        self.value.as_str()
    }

    /// One of the words that its key has.
    pub(crate) fn word(&self) -> Read<&'static str> {
        match self.key.kind {
            Kind::Word(words) => self.word_of(words),
            _ => unreachable!("{} is no word", self.key.name),
        }
    }

    /// One of several fixed words.
    pub(crate) fn word_of(&self, words: &[&'static str]) -> Read<&'static str> {
        let right = || format!("expected {}", one_of(words.iter().map(|w| format!("\"{w}\""))));
        let text = self.as_text().ok_or_else(|| self.wrong_type(right()))?;
        let known = words.iter().find(|w| **w == text).copied();
        known.ok_or_else(|| self.wrong_word(text, right()))
    }

    /// A string to show: neither empty nor longer than 200 characters, and of one line.
    pub(crate) fn name(&self) -> Read<&'s str> {
        let right = format!("expected a string of 1 to {LONGEST_NAME} characters");
        let text = self.as_text().ok_or_else(|| self.wrong_type(&*right))?;
        if text.trim().is_empty() {
            return Err(self.wrong(format!("{} is empty", self.key.name), right));
        }
        let length = text.chars().count();
        if length > LONGEST_NAME {
            return Err(self.wrong(format!("{} has {length} characters", self.key.name), right));
        }
        if text.chars().any(controls_display) {
            let title = format!("{} has a control character: {}", self.key.name, quoted(text));
            return Err(self.wrong(title, "expected plain text"));
        }
        Ok(text)
    }

    /// The name of a file, in which a backslash between double quotes may have made a control character.
    pub(crate) fn file_name(&self) -> Read<&'s str> {
        match self.as_text() {
            Some(text) if text.chars().any(char::is_control) => {
                let title = format!("{} has a control character in it: {}", self.key.name, quoted(text));
                Err(self.wrong(title, BACKSLASH))
            }
            _ => self.name(),
        }
    }

    /// The text of a file that this value names, which stands beside the train file `path`, with its path. Of a workbook it is that
    /// of the sheet behind a `#`, or else of the only one with a table of the expected kind.
    pub(super) fn text_beside(
        &self,
        path: &Path,
        files: &Files,
        is_wanted: fn(&str) -> bool,
    ) -> Read<(PathBuf, Arc<str>)> {
        let name = self.file_name()?;
        let beside = path.parent().unwrap_or(Path::new("")).join(name);
        match files.beside(&beside, is_wanted) {
            Ok(text) => Ok((beside, text)),
            Err([what, right]) => {
                let help = if name.contains('\\') && !beside.exists() { BACKSLASH.to_owned() } else { right };
                Err(self.wrong(format!("{}: {what}", printable_path(&beside)), help))
            }
        }
    }

    /// The value as a table of this shape, if it is one.
    pub(super) fn table_if(&self, shape: &'static Shape) -> Option<Read<Table<'s>>> {
        matches!(self.value, DeValue::Table(_)).then(|| self.table_of(shape))
    }

    /// The value as it stands.
    pub(crate) fn raw(&self) -> &'s DeValue<'s> {
        self.value
    }

    /// Notes the problems of another text that this value names.
    pub(super) fn refer(&self, beside: &InputError) -> Reported {
        self.wrong(beside.brief(), beside.help())
    }

    /// Notes something that is probably not meant, and no error.
    pub(super) fn doubt(&self, doubt: Doubt) {
        self.found.doubt(doubt);
    }

    /// A list of rows of quantities, each of at least `least` of these; `right` says what is expected.
    pub(super) fn rows(&self, of: &[(&str, Dimension, Sign)], least: usize, right: &str) -> Read<Vec<Vec<f64>>> {
        let DeValue::Array(rows) = self.value else { return Err(self.wrong_type(right)) };
        let row = |row: &'s Spanned<DeValue<'s>>| {
            let row = self.item(row);
            let DeValue::Array(cells) = row.value else { return Err(row.wrong_type(right)) };
            if !(least..=of.len()).contains(&cells.len()) {
                let title = format!("a row of {} has {} values", self.key.name, cells.len());
                return Err(row.wrong(title, right));
            }
            let cell = |(cell, (_, of, sign)): (&'s Spanned<DeValue<'s>>, &(&str, Dimension, Sign))| {
                row.item(cell).amount_of(*of, *sign, false).map(|(Amount::Si(value) | Amount::Share(value))| value)
            };
            cells.iter().zip(of).map(cell).collect()
        };
        rows.iter().map(row).collect()
    }

    /// A number without a unit, more than 0.
    pub(crate) fn positive(&self) -> Read<f64> {
        let right = "expected a number without a unit, more than zero";
        let text = self.bare_number(right)?;
        let number = text.parse().ok().filter(|x: &f64| *x > 0.0 && x.is_finite());
        number.ok_or_else(|| self.wrong(format!("{} is {text}", self.key.name), right))
    }

    /// A number without quotes, as it is written.
    fn bare_number(&self, right: &str) -> Read<String> {
        match self.value {
            DeValue::Integer(number) => Ok(number.to_string()),
            DeValue::Float(number) => Ok(number.to_string()),
            _ => Err(self.wrong_type(right)),
        }
    }

    pub(crate) fn flag(&self) -> Read<bool> {
        self.value.as_bool().ok_or_else(|| self.wrong_type("expected true or false, without quotes"))
    }

    /// A whole number from 1 to `largest`; `title` says what is wrong with another, `right` what is expected.
    pub(crate) fn number(&self, largest: usize, title: impl Fn(&str) -> String, right: &str) -> Read<usize> {
        let integer = self.value.as_integer().ok_or_else(|| self.wrong_type(right))?;
        let number = usize::from_str_radix(integer.as_str(), integer.radix()).ok();
        let number = number.filter(|n| (1..=largest).contains(n));
        number.ok_or_else(|| self.wrong(title(&integer.to_string().chars().take(40).collect::<String>()), right))
    }

    /// A plain number from 0 to under 1.
    pub(super) fn ratio(&self) -> Read<f64> {
        let right = "expected a number from 0 to under 1, without quotes and unit: 0.2";
        let text = self.bare_number(right)?;
        let ratio = text.parse::<f64>().ok().filter(|r| (0.0..1.0).contains(r));
        ratio.ok_or_else(|| self.wrong(format!("{} is {}", self.key.name, quoted(&text)), right))
    }

    /// A quantity such as its key has, in SI units.
    pub(crate) fn quantity(&self) -> Read<f64> {
        match self.amount()? {
            Amount::Si(value) | Amount::Share(value) => Ok(value),
        }
    }

    /// A quantity such as its key has, in SI units or, where the key has shares, in %.
    pub(crate) fn amount(&self) -> Read<Amount> {
        match self.key.kind {
            Kind::Quantity { of, sign, share } => self.read_amount(of, sign, share),
            _ => unreachable!("{} is no quantity", self.key.name),
        }
    }

    /// A quantity of this kind, in SI units or, with `share`, in %.
    pub(crate) fn amount_of(&self, dimension: Dimension, sign: Sign, share: bool) -> Read<Amount> {
        self.read_amount(dimension, sign, share)
    }

    fn read_amount(&self, dimension: Dimension, sign: Sign, share: bool) -> Read<Amount> {
        let right = || {
            let share = if share { ", or a share in %" } else { "" };
            format!("expected a string with a number and its unit: {}{share}", dimension.choices())
        };
        let bare = match self.value {
            DeValue::Integer(number) => Some(number.to_string()),
            DeValue::Float(number) => Some(number.to_string()),
            _ => None,
        };
        let text = match (&bare, self.as_text()) {
            (Some(number), _) => number.as_str(),
            (None, Some(text)) => text,
            (None, None) => return Err(self.wrong_type(right())),
        };
        if let Some(us) = units::is_us(text, dimension) {
            let count = &self.found.written_in[usize::from(us)];
            count.set(count.get() + 1);
        }
        let amount = units::parse(text, dimension, share)
            .map_err(|bad| self.wrong(format!("{} {}", self.key.name, bad.found), bad.right))?;
        let (Amount::Si(value) | Amount::Share(value)) = amount;
        match sign.refuses(value) {
            Some([found, right]) => Err(self.wrong(format!("{} {found}", self.key.name), right)),
            None => Ok(amount),
        }
    }

    /// The items of a list, or the value itself as the only one.
    pub(crate) fn items(&self) -> impl Iterator<Item = Value<'s>> {
        let (list, alone) = match self.value {
            DeValue::Array(items) => (Some(items), None),
            _ => (None, Some(self.clone())),
        };
        list.into_iter().flat_map(|items| items.iter()).map(|item| self.item(item)).chain(alone)
    }

    fn item(&self, item: &'s Spanned<DeValue<'s>>) -> Value<'s> {
        Value { found: self.found, key: self.key, value: item.get_ref(), span: item.span() }
    }

    /// A table such as its key has.
    pub(crate) fn table(&self) -> Read<Table<'s>> {
        let Kind::Table(shape) = self.key.kind else { unreachable!("{} is no table", self.key.name) };
        self.table_of(shape)
    }

    fn table_of(&self, shape: &'static Shape) -> Read<Table<'s>> {
        match self.value {
            DeValue::Table(table) => Ok(Table { found: self.found, shape, table, span: self.span.clone() }.checked()),
            _ => Err(self.wrong_type(format!("expected {}, a table with keys of its own", shape.name))),
        }
    }

    /// A list of tables such as its key has.
    pub(crate) fn tables(&self) -> Read<Vec<Table<'s>>> {
        let Kind::Tables(shape) = self.key.kind else { unreachable!("{} is no list of tables", self.key.name) };
        let right = || format!("write {}, with two brackets on each side, above each of them", shape.name);
        match self.value {
            DeValue::Array(items) => items.iter().map(|item| self.item(item).table_of(shape)).collect(),
            _ => Err(self.wrong_type(right())),
        }
    }
}

/// Gives a tree of values to `read`, without places.
pub(crate) fn without_places<R>(table: &toml::Table, read: impl FnOnce(&DeTable) -> R) -> R {
    let mut numbers = vec![];
    table.values().for_each(|value| note_numbers(value, &mut numbers));
    read(&table_without_places(table, &mut numbers.iter()))
}

/// The numbers of a value in its order, as TOML writes them.
fn note_numbers(value: &toml::Value, numbers: &mut Vec<String>) {
    match value {
        toml::Value::Integer(_) | toml::Value::Float(_) => numbers.push(value.to_string()),
        toml::Value::Array(items) => items.iter().for_each(|item| note_numbers(item, numbers)),
        toml::Value::Table(table) => table.values().for_each(|value| note_numbers(value, numbers)),
        toml::Value::String(_) | toml::Value::Boolean(_) | toml::Value::Datetime(_) => {}
    }
}

fn table_without_places<'t>(table: &'t toml::Table, numbers: &mut std::slice::Iter<'t, String>) -> DeTable<'t> {
    let entry = |(key, value): (&'t String, &'t toml::Value)| {
        (Spanned::new(0..0, Cow::Borrowed(key.as_str())), Spanned::new(0..0, value_without_places(value, numbers)))
    };
    table.iter().map(entry).collect()
}

fn value_without_places<'t>(value: &'t toml::Value, numbers: &mut std::slice::Iter<'t, String>) -> DeValue<'t> {
    match value {
        toml::Value::String(text) => DeValue::String(Cow::Borrowed(text)),
        toml::Value::Integer(_) | toml::Value::Float(_) => match numbers.next().map(|text| DeValue::parse(text)) {
            Some(Ok(number)) => number.into_inner(),
            _ => unreachable!("{value} is a number of TOML"),
        },
        toml::Value::Boolean(flag) => DeValue::Boolean(*flag),
        toml::Value::Datetime(date) => DeValue::Datetime(*date),
        toml::Value::Array(items) => {
            let item = |item: &'t toml::Value| Spanned::new(0..0, value_without_places(item, numbers));
            DeValue::Array(items.iter().map(item).collect())
        }
        toml::Value::Table(table) => DeValue::Table(table_without_places(table, numbers)),
    }
}

fn type_name(value: &DeValue) -> &'static str {
    match value {
        DeValue::String(_) => "a string",
        DeValue::Integer(_) => "a number",
        DeValue::Float(_) => "a number with a decimal point",
        DeValue::Boolean(true) => "true",
        DeValue::Boolean(false) => "false",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
}
