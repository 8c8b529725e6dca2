//! Messages about a text that is no quantity of the expected kind.

use super::{BadQuantity, Dimension, one_of, spellings};
use crate::error::quoted;

/// Words that mean several units, or a unit of something else that is often written for this one: what to write instead.
const INSTEAD: &[(&[&str], &[[&str; 2]])] = &[
    (&["ton", "tons"], &[["t", "metric, 1000 kg"], ["ton_us", "US, 2000 lb"]]),
    (&["mt", "mton", "mtons"], &[["t", "metric, 1000 kg"]]),
    (&["kip", "kips", "klbf"], &[["klb", "1000 lb of mass"]]),
    (&["lbf"], &[["lb", "a pound of mass"]]),
    (&["kg"], &[["kgf", "the weight of 1 kg"]]),
];

pub(super) fn bad(found: impl Into<String>, right: impl Into<String>) -> BadQuantity {
    BadQuantity { found: found.into(), right: right.into() }
}

/// The number with each unit that it could have; one below 1 may be a share of 1, not of 100.
pub(super) fn with_units(number: &str, dimension: Dimension, share: bool) -> String {
    let below_1 = number.parse().ok().filter(|n: &f64| *n != 0.0 && n.abs() < 1.0);
    if let Some(share_of_1) = below_1.filter(|_| dimension.is_in_per_cent()) {
        let per_cent = format!("{:.6}", 100.0 * share_of_1);
        let per_cent = per_cent.trim_end_matches('0').trim_end_matches('.');
        return format!("write \"{per_cent} %\" if {number} is a share of 1, or \"{number} %\" if it is in per cent");
    }
    let units = dimension.units().chain(share.then_some("%"));
    format!("write {}", one_of(units.map(|unit| format!("\"{number} {unit}\""))))
}

/// The units that a quantity may have, as a phrase.
pub(super) fn right_units(dimension: Dimension, share: bool) -> String {
    format!("a {dimension} is in {}{}", dimension.choices(), if share { ", or a share in %" } else { "" })
}

pub(super) fn wrong_unit(number: &str, unit: &str, dimension: Dimension, share: bool) -> BadQuantity {
    let shown = quoted(unit);
    let rest_of_number = |c: char| c.is_ascii_digit() || matches!(c, ',' | '.' | '_' | '\'');
    if unit.starts_with(rest_of_number) {
        let right = "write it with a point for decimals and no other separators";
        return bad("is not one number", format!("{right}: {}", right_units(dimension, share)));
    }
    let unknown = format!("has the unknown unit {shown}");
    let near = nearest(dimension, unit);
    if !near.is_empty() {
        let near = near.iter().map(|unit| format!("\"{number} {unit}\""));
        return bad(unknown, format!("did you mean {}?", one_of(near)));
    }
    let other = Dimension::ALL.into_iter().find(|d| *d != dimension && spellings::find(*d, unit).is_some());
    let instead = instead(dimension, unit);
    let found = match other {
        Some(other) => format!("has {shown}, a unit of {other}"),
        None if instead.len() > 1 => format!("has {shown}, which means more than one unit"),
        None => unknown,
    };
    if instead.is_empty() {
        return bad(found, right_units(dimension, share));
    }
    let choices = instead.into_iter().map(|(unit, meaning)| format!("\"{number} {unit}\" ({meaning})"));
    bad(found, format!("write {}", one_of(choices)))
}

/// Units that differ from the text in the case of letters and in blanks only; else the one that differs in one letter.
fn nearest(dimension: Dimension, unit: &str) -> Vec<String> {
    let compact: String = unit.split_whitespace().collect();
    let same = spellings::in_any_case(dimension, unit);
    if !same.is_empty() {
        return same;
    }
    let same = spellings::in_any_case(dimension, &compact);
    let elsewhere = || Dimension::ALL.iter().any(|d| spellings::find(*d, unit).is_some());
    // A short unit with one letter changed may be another.
    if !same.is_empty() || !(6..=20).contains(&compact.len()) || elsewhere() {
        return same;
    }
    let near = dimension.units().find(|known| strsim::damerau_levenshtein(known, &compact) == 1);
    near.map(str::to_owned).into_iter().collect()
}

/// The units that a text with a word of [`INSTEAD`] may mean in this dimension, each with its meaning.
fn instead(dimension: Dimension, unit: &str) -> Vec<(String, &'static str)> {
    let in_a_word = |c: char| c.is_alphanumeric() || c == '_';
    let words: Vec<&str> = unit.split(|c| !in_a_word(c)).collect();
    let is = |known: &[&str]| words.iter().any(|w| known.iter().any(|k| k.eq_ignore_ascii_case(w)));
    let Some((known, meanings)) = INSTEAD.iter().find(|(known, _)| is(known)).filter(|_| unit.len() <= 40) else {
        return Vec::new();
    };
    let word = words.into_iter().find(|w| known.iter().any(|k| k.eq_ignore_ascii_case(w))).unwrap_or_default();
    let replaced = meanings.iter().map(|[unit_of, meaning]| (unit.replacen(word, unit_of, 1), *meaning));
    replaced.filter(|(unit, _)| spellings::find(dimension, unit).is_some()).collect()
}

pub(super) fn no_number(text: &str, dimension: Dimension) -> BadQuantity {
    let right = format!("expected a number and its unit: {}", dimension.choices());
    let word = text.trim_start_matches(['+', '-']).to_ascii_lowercase();
    if text.is_empty() {
        return bad("is empty", right);
    }
    if word.starts_with("nan") || word.starts_with("inf") {
        return bad("is not a finite number", right);
    }
    if text.starts_with(['\u{2212}', '\u{2013}', '\u{2014}']) {
        return bad("starts with a dash that is not a minus sign", "write a negative number with the hyphen \"-\"");
    }
    bad("does not start with a number", right)
}
