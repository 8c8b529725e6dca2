//! Headings of columns: `mass [t]`, `Mass (t)`, `mass_t`, `MASS, t` are the same column.

use crate::error::quoted;
use crate::units::{self, Dimension, one_of};

/// What the cells of a column are.
#[derive(Clone, Copy)]
pub(super) enum Content {
    Quantity { of: Dimension, share: bool },
    Number,
    Text,
}

/// A column that is looked for.
pub(super) struct Wanted {
    /// The names that it may have, as [`normal`] writes them; the key's own name first.
    pub(super) names: Vec<String>,
    pub(super) content: Content,
    /// Where no heading has one of the names, the only column with a fitting unit is meant.
    pub(super) by_unit: bool,
}

/// What a heading means.
pub(super) enum Heading {
    Is {
        wanted: usize,
        synonym: bool,
        unit: Option<String>,
    },
    /// A column that is looked for, in a unit that does not fit.
    BadUnit {
        wanted: usize,
        found: String,
        right: String,
    },
    Unknown,
}

impl Heading {
    pub(super) fn wanted(&self) -> Option<usize> {
        match self {
            Heading::Is { wanted, .. } | Heading::BadUnit { wanted, .. } => Some(*wanted),
            Heading::Unknown => None,
        }
    }
}

/// Characters between words, and between name and unit.
const BETWEEN: [char; 11] = [' ', '_', '-', '.', ',', '/', ':', '\u{a0}', '\n', '\r', '\t'];
/// Longer headings are not looked at.
const LONGEST: usize = 100;

/// A name in small letters, with `_` between its words.
pub(super) fn normal(name: &str) -> String {
    let lower = name.to_lowercase();
    lower.split(BETWEEN).filter(|word| !word.is_empty()).collect::<Vec<_>>().join("_")
}

/// What a heading means among the columns that are looked for.
pub(super) fn heading(text: &str, wanted: &[Wanted]) -> Heading {
    let text = text.trim();
    if text.len() > LONGEST {
        return Heading::Unknown;
    }
    let find = |name: &str| {
        let name = normal(name);
        wanted.iter().enumerate().find_map(|(w, want)| Some((w, want.names.iter().position(|n| *n == name)? > 0)))
    };
    if let Some((wanted, synonym)) = find(text) {
        return Heading::Is { wanted, synonym, unit: None };
    }
    let with_unit = |(w, synonym): (usize, bool), written: &str| match unit(written, wanted[w].content) {
        Ok(unit) => Heading::Is { wanted: w, synonym, unit },
        Err([found, right]) => Heading::BadUnit { wanted: w, found, right },
    };
    if let Some((name, written)) = bracketed(text) {
        return find(name).map_or(Heading::Unknown, |known| with_unit(known, written));
    }
    for (i, _) in text.char_indices().rev().filter(|(_, c)| BETWEEN.contains(c)) {
        let written = text[i..].trim_start_matches(BETWEEN);
        let Some(known) = find(&text[..i]).filter(|_| !written.is_empty()) else { continue };
        let Content::Quantity { of, .. } = wanted[known.0].content else { continue };
        // A last word that is no unit is part of the name: mass_empty.
        if unit(written, wanted[known.0].content).is_ok() || is_some_unit(written, of) {
            return with_unit(known, written);
        }
    }
    Heading::Unknown
}

/// The unit of a heading whatever its name, if it is one of the quantity.
pub(super) fn only_unit(text: &str, content: Content) -> Option<String> {
    let text = text.trim();
    let written = bracketed(text).map(|(_, written)| written);
    let written = written.or_else(|| Some(text.rsplit_once(['_', ' ', ','])?.1))?;
    unit(written, content).ok().flatten()
}

/// A heading's name, and what stands in the brackets at its end.
fn bracketed(text: &str) -> Option<(&str, &str)> {
    let inside = text.strip_suffix([']', ')', '}'])?;
    let open = inside.rfind(['[', '(', '{'])?;
    Some((text[..open].trim_end_matches(BETWEEN), inside[open + 1..].trim()))
}

/// Whether a word is a unit of some quantity, or one that is refused because it has several meanings.
fn is_some_unit(written: &str, of: Dimension) -> bool {
    let known = |u: &str| u.eq_ignore_ascii_case(written);
    // The 1 of `force_1_kn` belongs to the name.
    let refused = !written.starts_with(|c: char| c.is_ascii_digit())
        && units::parse(&format!("1 {written}"), of, false).is_err_and(|bad| !bad.found.contains("unknown unit"));
    refused || Dimension::ALL.into_iter().any(|d| d.units().any(known))
}

/// The unit that a heading gives, as the reader of quantities writes it; `None` where it gives none.
///
/// Capital and small letters are the same as long as only one unit can be meant: `mn` is not `MN`, for m is milli and M is mega.
///
/// # Errors
/// What is found and what would be right; the first completes a sentence that starts with the column.
pub(super) fn unit(written: &str, content: Content) -> Result<Option<String>, [String; 2]> {
    let Content::Quantity { of, share } = content else { return Ok(None) };
    let written = written.trim().trim_start_matches("in ").trim();
    if written.is_empty() || written == "-" {
        return Ok(None);
    }
    let bad = match units::parse(&format!("1 {written}"), of, share) {
        Ok(_) => return Ok(Some(written.to_owned())),
        Err(bad) => bad,
    };
    let alike: Vec<&str> = of.units().filter(|u| u.eq_ignore_ascii_case(written)).collect();
    match alike.as_slice() {
        [] => {
            let right = format!("a {of} is in {}", of.choices());
            let found = if bad.found.contains("unknown unit") { "has an unknown unit".to_owned() } else { bad.found };
            Err([found, right])
        }
        [one] if !(one.starts_with('M') && written.starts_with('m')) => Ok(Some((*one).to_owned())),
        some => {
            let first = written.chars().next().unwrap_or_default();
            let choices = one_of(some);
            let meaning = if first == 'm' { ", for m is milli and M is mega" } else { "" };
            Err([
                format!("has the unit {}, which is not {choices}{meaning}", quoted(written)),
                format!("write {choices} if that is meant"),
            ])
        }
    }
}
