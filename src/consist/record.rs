//! A measured force over time: a CSV file with two columns beside the train file.
//!
//! The header names the columns and their units, `time_ms,force_kn` or `time [ms],force [kN]`. The force runs in straight lines from row
//! to row; before the first and after the last it is zero. A record whose clock does not start at 0 starts where its force first changes.

use std::path::Path;

use super::columns::{RECORD_COLUMNS, open_record};
use super::heading::{Content, only_unit};
use super::sheet::{HEADER_ROWS, Record, Sheet};
use crate::error::{InputError, Problem, Problems, printable_path, quoted};
use crate::train::Doubt;
use crate::units::{self, Amount, Dimension, shown_time};

/// What a record holds.
pub(super) struct Course {
    /// Times, s, and forces, N.
    pub(super) points: Vec<[f64; 2]>,
    /// What is probably not meant.
    pub(super) doubts: Vec<Doubt>,
}

/// Reads a record's text; `path` is what messages call it.
///
/// # Errors
/// What is wrong with it, and what would be right.
pub(super) fn parse(text: &str, path: &Path) -> Result<Course, InputError> {
    let header =
        "a row above the numbers names two columns and their units, as time_ms,force_kn or time [s];force [N] do";
    let of_file = |title: String, help: &str| InputError::of_file(path, title, help);
    let sheet = match open_record(text) {
        Ok(sheet) => sheet,
        Err(Some(problems)) => return Err(InputError::new(path, text, problems)),
        // Nothing is shown of a file that is no record: a train file may come from anyone, and name any file.
        Err(None) => {
            let what = super::kinds::of_text(text).map(|what| format!("it is {what}")).or_else(|| several(text));
            let what = what.map_or(String::new(), |what| format!(": {what}"));
            return Err(of_file(format!("the record has no columns of time and force with units{what}"), header));
        }
    };
    let mut problems = Problems::default();
    let points = points(&sheet, &mut problems);
    if !problems.is_empty() {
        return Err(InputError::new(path, text, problems));
    }
    if points.last().is_none_or(|last| last[0] <= points[0][0]) {
        let help = "expected two rows or more with rising times";
        return Err(of_file("the record holds no stretch of time".into(), help));
    }
    if points.iter().all(|point| point[1] == 0.0) {
        return Err(of_file("the record holds no force other than zero".into(), "expected a force that acts"));
    }
    let name = path.file_name().map_or_else(|| printable_path(path), |name| printable_path(Path::new(name)));
    let mut doubts = sheet.doubts(&name);
    let (points, shift) = shifted(points, &name);
    doubts.extend(shift);
    Ok(Course { points, doubts })
}

/// Which columns of a text could each be the time or the force, in words that show nothing of the text.
fn several(text: &str) -> Option<String> {
    text.lines().take(HEADER_ROWS).enumerate().find_map(|(row, line)| {
        let fitting = |of: Dimension| {
            let content = Content::Quantity { of, share: false };
            let is_of = |(i, cell): (usize, &str)| only_unit(cell.trim().trim_matches('"'), content).map(|_| i + 1);
            line.split([',', ';', '\t']).enumerate().filter_map(is_of).collect::<Vec<_>>()
        };
        let found = RECORD_COLUMNS.map(|(name, of)| (name, fitting(of)));
        let open = found.iter().find(|(_, columns)| columns.len() > 1)?;
        let which = open.1.iter().map(ToString::to_string).collect::<Vec<_>>().join(" and ");
        let all = found.iter().all(|(_, columns)| !columns.is_empty());
        all.then(|| format!("columns {which} of row {} could each be the {}; give one that heading", row + 1, open.0))
    })
}

fn points(sheet: &Sheet, problems: &mut Problems) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = vec![];
    for record in sheet.rows() {
        let before = points.last().map(|point| point[0]);
        let point = match point(sheet, &record) {
            Ok(point) => point,
            Err(problem) => {
                problems.note(problem);
                // One problem is enough: others are often the same.
                return points;
            }
        };
        if before.is_some_and(|before| point[0] < before) {
            let title = format!("row {} goes back in time", record.row);
            problems.note(Problem::at(
                sheet.place(&record, 0),
                title,
                Some("the time of a row is at least that of the row before".into()),
            ));
            return points;
        }
        points.push(point);
    }
    points
}

fn point(sheet: &Sheet, record: &Record) -> Result<[f64; 2], Problem> {
    let mut point = [0.0; 2];
    for (w, (name, of)) in RECORD_COLUMNS.into_iter().enumerate() {
        let wrong = |found: String, right: String| {
            Problem::at(sheet.place(record, w), format!("row {}: {name} {found}", record.row), Some(right))
        };
        let Some((text, _)) = sheet.cell(record, w) else {
            return Err(wrong("is empty".into(), "expected two numbers in each row".into()));
        };
        if is_clock(&text) {
            let help = format!("a {name} is a number of {}; times count from any start", of.choices());
            return Err(wrong(format!("is a date or a time of day: {}", quoted(&text)), help));
        }
        let (quantity, has_unit) = sheet.quantity(w, &text).map_err(|[found, right]| wrong(found, right))?;
        if !has_unit {
            let help = format!("head the column {name}_{}, or with another of {}", of.si(), of.choices());
            return Err(Problem::at(sheet.heading_span(w), format!("the column of {name} has no unit"), Some(help)));
        }
        point[w] = match units::parse(&quantity, of, false) {
            Ok(Amount::Si(value) | Amount::Share(value)) => value,
            Err(bad) => return Err(wrong(format!("{}: {}", bad.found, quoted(&text)), bad.right)),
        };
    }
    Ok(point)
}

/// Whether a text is written as a date or a time of day: numbers with two or more of `:`, `-` and `/` between.
fn is_clock(text: &str) -> bool {
    let number = |part: &str| part.starts_with(|c: char| c.is_ascii_digit());
    text.matches([':', '-', '/']).count() > 1 && text.split([':', '-', '/', ' ', 'T']).all(number)
}

/// The course with its start at t = 0: if the record starts at another time, that is the last row before the force
/// leaves zero, or the first row if it has a force.
fn shifted(points: Vec<[f64; 2]>, name: &str) -> (Vec<[f64; 2]>, Option<Doubt>) {
    let first = points[0][0];
    if first == 0.0 {
        return (points, None);
    }
    let start = points.iter().position(|point| point[1] != 0.0).unwrap_or(0).saturating_sub(1);
    let zero = points[start][0];
    let [from, by] = [first, zero].map(shown_time);
    let why = if points[0][1] == 0.0 { "where its force starts to change" } else { "where it has a force at once" };
    let what = format!("its clock at {by}, {why}, is taken as t = 0 of the event");
    let doubt = Doubt::of_train("record-shifted", format!("the record {name} starts at {from}: {what}"));
    (points[start..].iter().map(|point| [point[0] - zero, point[1]]).collect(), Some(doubt))
}
