//! Cells of the CSV files.

/// The shortest decimal that reads back as the same number; empty where it is not finite.
pub fn number(x: f64) -> String {
    if x.is_finite() { format!("{x:?}") } else { String::new() }
}

/// The same, or empty where there is no value.
pub fn optional(x: Option<f64>) -> String {
    x.map(number).unwrap_or_default()
}

/// A text, made harmless for spreadsheets: one that begins like a formula gets an apostrophe before it.
pub fn text(s: &str) -> String {
    let formula = s.starts_with(|c: char| "=+-@＝＋－＠".contains(c) || c.is_control());
    if formula { format!("'{s}") } else { s.to_owned() }
}
