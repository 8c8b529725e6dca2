//! Puts a value into the text of a train file; all else stays as it is written.
//!
//! [`Key::put`] gives the content to expect, as for a study. The text is then changed where the value stands or
//! belongs, and is used only if it parses to that content.

use std::ops::Range;

use serde::Deserialize;
use toml::de::{DeTable, DeValue};
use toml::{Table, Value};

use crate::fleet::key::Key;

/// The table of a train file for single couplers.
const OVERRIDE: &str = "coupler_override";

/// A value for a key.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Change {
    /// Its path as a study names it; of one coupler the key alone, such as `rated_load`.
    key: String,
    /// The coupler that is to have it, from 1; absent: as the path says.
    coupler: Option<usize>,
    value: Value,
}

/// The text with a value put into it.
///
/// # Errors
/// A sentence: the text is no TOML, no train file has such a key, or it stands in a way that is not changed here.
pub(super) fn put(text: &str, change: &Change) -> Result<String, String> {
    let parsed = || text.parse::<Table>().map_err(|_| "the text is not TOML: put that right first".to_owned());
    let (text, path) = match change.coupler {
        None => (text.to_owned(), change.key.clone()),
        Some(coupler) => {
            let (text, index) = with_override(text, &parsed()?, coupler, &change.key);
            (text, format!("{OVERRIDE}[{index}].{}", change.key))
        }
    };
    let key = Key::parse(&path).map_err(|bad| bad.title)?;
    let mut wanted = parsed()?;
    if change.coupler.is_some() {
        wanted = text.parse().map_err(|_| by_hand(&key))?;
    }
    key.put(&mut wanted, change.value.clone())?;
    let changed =
        written(&text, &key, &change.value).filter(|text| text.parse().is_ok_and(|read: Table| read == wanted));
    changed.ok_or_else(|| by_hand(&key))
}

fn by_hand(key: &Key) -> String {
    format!("{key} stands in the text in a way that is not changed from here: write it by hand")
}

/// The text with the value in the place of the one there, or else in a line of its own.
fn written(text: &str, key: &Key, value: &Value) -> Option<String> {
    let root = DeTable::parse(text).ok()?;
    let mut at: &DeTable = root.get_ref();
    let mut header: Option<Range<usize>> = None;
    if let Some(table) = key.table {
        match at.get(table) {
            // Tables come in any order.
            None => return Some(format!("{}\n[{table}]\n{} = {value}\n", ended(text), key.leaf)),
            Some(found) => {
                let found = match key.index {
                    None => found,
                    Some(index) => found.get_ref().as_array()?.get(index)?,
                };
                header = Some(found.span());
                at = found.get_ref().as_table()?;
            }
        }
    }
    if !key.inner.is_empty() {
        return None;
    }
    if let Some(old) = at.get(key.leaf) {
        return Some(replaced(text, old.span(), &value.to_string()));
    }
    // Below the last of its neighbours, or the header.
    let plain = |v: &&toml::Spanned<DeValue>| !matches!(v.get_ref(), DeValue::Table(_) | DeValue::Array(_));
    let above = at.values().filter(plain).map(|v| v.span().end).max().or(header.map(|header| header.end));
    let line_end = above.map_or(0, |end| text[end..].find('\n').map_or(text.len(), |n| end + n + 1));
    let (before, after) = text.split_at(line_end);
    let before = if before.is_empty() { String::new() } else { ended(before) };
    Some(format!("{before}{} = {value}\n{after}", key.leaf))
}

fn replaced(text: &str, span: Range<usize>, by: &str) -> String {
    format!("{}{by}{}", &text[..span.start], &text[span.end..])
}

/// The text with its last line ended.
fn ended(text: &str) -> String {
    if text.ends_with('\n') { text.to_owned() } else { format!("{text}\n") }
}

/// A text in which a `[[coupler_override]]` is of this coupler alone and can have this key, and its index.
fn with_override(text: &str, tree: &Table, coupler: usize, key: &str) -> (String, usize) {
    let none = Vec::new();
    let all = tree.get(OVERRIDE).and_then(Value::as_array).unwrap_or(&none);
    let of_it = |o: &&Value| o.get("at").is_some_and(|at| numbers(at).any(|n| n == coupler));
    let alone = |o: &Value| o.get("at").is_some_and(|at| at.as_array().is_none_or(|list| list.len() == 1));
    let position = |found: Option<&Value>| found.and_then(|f| all.iter().position(|o| std::ptr::eq(o, f)));
    let with_key = all.iter().filter(of_it).find(|o| o.get(key).is_some());
    let own = with_key.or_else(|| all.iter().filter(of_it).find(|o| alone(o)));
    match own.filter(|o| alone(o)) {
        Some(own) => (text.to_owned(), position(Some(own)).unwrap_or(0)),
        None => {
            // A shared one loses this coupler, and its keys are copied to the coupler's own.
            let shared = with_key.and_then(Value::as_table).cloned();
            let without = position(with_key).and_then(|k| without(text, k, coupler)).unwrap_or_else(|| text.to_owned());
            let mut own = shared.unwrap_or_default();
            own.insert("at".into(), Value::Integer(coupler as i64));
            let keys: String = own.iter().map(|(key, value)| format!("{key} = {value}\n")).collect();
            (format!("{}\n[[{OVERRIDE}]]\n{keys}", ended(&without)), all.len())
        }
    }
}

/// The couplers of an override that are given by number.
fn numbers(at: &Value) -> impl Iterator<Item = usize> {
    let list = at.as_array().map_or(std::slice::from_ref(at), Vec::as_slice);
    list.iter().filter_map(|n| usize::try_from(n.as_integer()?).ok())
}

/// The text without a coupler in the list of an override.
fn without(text: &str, index: usize, coupler: usize) -> Option<String> {
    let root = DeTable::parse(text).ok()?;
    let at = root.get_ref().get(OVERRIDE)?.get_ref().as_array()?.get(index)?.get_ref().as_table()?.get("at")?;
    let tree: Table = text.parse().ok()?;
    let list = tree.get(OVERRIDE)?.as_array()?.get(index)?.get("at")?.as_array()?;
    let left: Vec<Value> = list.iter().filter(|n| n.as_integer() != Some(coupler as i64)).cloned().collect();
    Some(replaced(text, at.span(), &Value::Array(left).to_string()))
}
