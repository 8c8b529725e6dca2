//! Numbers as spreadsheets write them: with a decimal point or comma, and with or without separators of thousands.

use std::ops::Range;

use crate::error::{Problem, quoted};

/// The mark before the decimals; the other one of point and comma may separate thousands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Decimal {
    Point,
    Comma,
}

/// Characters that separate thousands beside point and comma.
const GROUPING: [char; 5] = [' ', '\'', '\u{2019}', '\u{a0}', '\u{202f}'];

/// The number at the start of a text, with all marks in it.
pub(super) fn number_run(text: &str) -> &str {
    let chars: Vec<(usize, char)> = text.char_indices().take(64).collect();
    let digit = |i: usize| chars.get(i).is_some_and(|(_, c)| c.is_ascii_digit());
    let mut i = usize::from(chars.first().is_some_and(|(_, c)| matches!(c, '+' | '-')));
    let start = i;
    while let Some((_, c)) = chars.get(i) {
        let groups = || i > start && digit(i - 1) && digit(i + 1) && digit(i + 2) && digit(i + 3) && !digit(i + 4);
        if !(c.is_ascii_digit() || matches!(c, '.' | ',') || GROUPING.contains(c) && groups()) {
            break;
        }
        i += 1;
    }
    if i > start && chars.get(i).is_some_and(|(_, c)| matches!(c, 'e' | 'E')) {
        let sign = usize::from(chars.get(i + 1).is_some_and(|(_, c)| matches!(c, '+' | '-')));
        let mut end = i + 1 + sign;
        while digit(end) {
            end += 1;
        }
        i = if end > i + 1 + sign { end } else { i };
    }
    &text[..chars.get(i).map_or(chars.last().map_or(0, |(at, c)| at + c.len_utf8()), |(at, _)| *at)]
}

/// A number with a point before its decimals and no other marks; `None` if the text is no number with this decimal mark.
pub(super) fn canonical(run: &str, decimal: Decimal) -> Option<String> {
    let (mark, thousands) = if decimal == Decimal::Point { ('.', ',') } else { (',', '.') };
    let (body, exponent) = run.find(['e', 'E']).map_or((run, ""), |at| run.split_at(at));
    let (sign, body) = body.split_at(usize::from(body.starts_with(['+', '-'])));
    let body: String = body.chars().filter(|c| !GROUPING.contains(c)).collect();
    let (whole, decimals) = body.split_once(mark).map_or((&*body, None), |(whole, decimals)| (whole, Some(decimals)));
    let digits = |text: &str| text.bytes().all(|b| b.is_ascii_digit());
    let mut groups = whole.split(thousands);
    let first = groups.next().unwrap_or_default();
    let grouped = whole.contains(thousands);
    let good = digits(first)
        && groups.all(|group| group.len() == 3 && digits(group))
        && (!grouped || (1..=3).contains(&first.len()) && !first.starts_with('0'))
        && decimals.is_none_or(digits)
        && whole.len() + decimals.map_or(0, str::len) > 0;
    let point = if decimals.is_some() { "." } else { "" };
    good.then(|| format!("{sign}{}{point}{}{exponent}", whole.replace(thousands, ""), decimals.unwrap_or_default()))
}

/// A number, written with a point and no separators of thousands, as a cell of CSV. Three decimals get a zero: they
/// could be taken for thousands where another cell has a decimal comma.
pub fn cell_of_number(number: String) -> String {
    let three = number.split_once('.').is_some_and(|(_, decimals)| decimals.len() == 3);
    if three { number + "0" } else { number }
}

/// A text as such a cell, in one line.
pub fn cell_of_text(text: &str) -> String {
    let line = text.replace(['\n', '\r'], " ");
    let plain = !line.contains(['"', ',', ';', '\t']);
    if plain { line } else { format!("\"{}\"", line.replace('"', "\"\"")) }
}

/// What a file's numbers show of its decimal mark.
#[derive(Default)]
pub(super) struct Marks {
    /// The first number that must have a decimal point, the first that must have a comma, the first that can have
    /// either.
    point: Option<(String, Range<usize>)>,
    comma: Option<(String, Range<usize>)>,
    either: Option<(String, Range<usize>)>,
}

impl Marks {
    /// Takes a cell into account.
    pub(super) fn add_cell(&mut self, text: &str, span: Range<usize>) {
        let run = number_run(text);
        if !run.contains(['.', ',']) {
            return;
        }
        let seen = match (canonical(run, Decimal::Point), canonical(run, Decimal::Comma)) {
            (Some(point), Some(comma)) if point != comma => &mut self.either,
            (Some(_), None) => &mut self.point,
            (None, Some(_)) => &mut self.comma,
            _ => return,
        };
        seen.get_or_insert_with(|| (run.to_owned(), span));
    }

    /// The decimal mark of the file.
    ///
    /// # Errors
    /// Numbers that contradict each other, or that have two meanings.
    pub(super) fn decide(self, separator: u8) -> Result<Decimal, Problem> {
        match (self.point, self.comma, self.either) {
            (Some((point, other)), Some((comma, span)), _) => {
                let title = format!("{} has a decimal comma, and {} a decimal point", quoted(&comma), quoted(&point));
                let help = "write all numbers of the file in the same way";
                Err(Problem::at(span, title, Some(help.into())).and(other, "a decimal point"))
            }
            (None, Some(_), _) => Ok(Decimal::Comma),
            (Some(_), None, _) | (None, None, None) => Ok(Decimal::Point),
            // Where commas separate the cells, a point stands before decimals.
            (None, None, Some((number, _))) if separator == b',' && !number.contains(',') => Ok(Decimal::Point),
            (None, None, Some((number, span))) => {
                let [a, b] = [Decimal::Point, Decimal::Comma].map(|d| canonical(&number, d).unwrap_or_default());
                let title = format!("{} is {a} or {b}: nothing in the file tells which", quoted(&number));
                let whole = if a.contains('.') { b } else { a };
                let help =
                    format!("write all numbers without separators of thousands: {whole}, or with one more decimal");
                Err(Problem::at(span, title, Some(help)))
            }
        }
    }
}
