//! A measured force over time: a CSV file with two columns beside the train file.
//!
//! The header names the columns and their units, `time_ms,force_kn` or `time (ms),force (kN)`. The force runs in straight
//! lines from row to row; before the first and after the last it is zero.

use std::path::Path;

use super::Files;
use crate::units::Dimension;

/// Reads a record: times, s, and forces, N.
///
/// # Errors
/// What is wrong with it, and what would be right.
pub(super) fn read(path: &Path, files: &Files) -> Result<Vec<[f64; 2]>, [String; 2]> {
    let shown = crate::error::printable_path(path);
    let wrong = |what: String, right: &str| [format!("{shown}: {what}"), right.to_owned()];
    let header = "the first line names two columns and their units: time_ms,force_kn";
    let text = files.beside(path).map_err(|[what, right]| wrong(what, &right))?;
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(text.as_bytes());
    let names = reader.headers().map_err(|e| wrong(e.to_string(), header))?.clone();
    let column =
        |name: &str, dimension| names.iter().enumerate().find_map(|(i, n)| Some((i, unit(n, name, dimension)?)));
    let (Some(time), Some(force)) = (column("time", Dimension::Time), column("force", Dimension::Force)) else {
        return Err(wrong("has no columns of time and force with units".to_owned(), header));
    };
    let mut points: Vec<[f64; 2]> = Vec::new();
    for row in reader.records() {
        let row = row.map_err(|e| wrong(e.to_string(), "expected two numbers in each row"))?;
        let line = row.position().map_or(0, csv::Position::line);
        let number = |(i, unit): (usize, f64)| row.get(i).and_then(|t| t.parse::<f64>().ok()).map(|x| x * unit);
        let point = match (number(time), number(force)) {
            (Some(t), Some(f)) if t.abs() <= 1e30 && f.abs() <= 1e30 => [t, f],
            _ => return Err(wrong(format!("line {line} has no time and force"), "expected two numbers in each row")),
        };
        if point[0] < points.last().map_or(0.0, |p| p[0]) {
            return Err(wrong(format!("line {line} goes back in time"), "times start at 0 or later and never fall"));
        }
        points.push(point);
    }
    if points.last().is_none_or(|last| last[0] <= points[0][0]) {
        return Err(wrong("holds no stretch of time".to_owned(), "expected two rows or more with rising times"));
    }
    if points.iter().all(|p| p[1] == 0.0) {
        return Err(wrong("holds no force other than zero".to_owned(), "expected a force that acts"));
    }
    Ok(points)
}

/// What a number in a column so named is in SI, if the column is of that quantity.
fn unit(column: &str, name: &str, dimension: Dimension) -> Option<f64> {
    let rest = column.strip_prefix(name)?.trim_start_matches([' ', '_', '(']).trim_end_matches(')');
    let symbol = dimension.units().find(|u| u.eq_ignore_ascii_case(rest))?;
    match crate::units::parse(&format!("1 {symbol}"), dimension, false) {
        Ok(crate::units::Amount::Si(value)) => Some(value),
        _ => None,
    }
}
