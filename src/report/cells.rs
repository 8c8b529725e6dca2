//! Cells of the CSV files.

use std::borrow::Cow;
use std::fmt::Write;

use crate::error::controls_display;

/// The shortest decimal that reads back as the same number; empty where it is not finite.
pub fn number(x: f64) -> String {
    if !x.is_finite() {
        return String::new();
    }
    // Room for any but the very small and the very large.
    let mut cell = String::with_capacity(24);
    let _ = write!(cell, "{x:?}");
    cell
}

/// The same, or empty where there is no value.
pub fn optional(x: Option<f64>) -> String {
    x.map(number).unwrap_or_default()
}

/// A text, made harmless for spreadsheets: one that begins like a formula, at its start or
/// after a semicolon, gets an apostrophe before it.
pub fn text(s: &str) -> Cow<'_, str> {
    let begins = |cell: &str| {
        cell.trim_start_matches(' ').starts_with(|c: char| "=+-@＝＋－＠".contains(c) || controls_display(c))
    };
    // Where the decimal comma is used, spreadsheets take a semicolon for the end of a cell.
    if !s.split(';').any(begins) {
        return s.into();
    }
    let cells: Vec<String> =
        s.split(';').map(|cell| if begins(cell) { format!("'{cell}") } else { cell.to_owned() }).collect();
    cells.join(";").into()
}
