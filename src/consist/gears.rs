//! Gears as tables of force over travel: a CSV file beside the train file, as makers' data sheets are exported, or rows in the file.
//!
//! ```text
//! travel [mm];loading [kN];unloading [kN]
//! 0;0;0
//! 38,5;680;172
//! ```
//!
//! Loading is the force while the travel grows, unloading that while it shrinks; both of the whole connection between two
//! vehicles, from the end of the slack on.

use std::path::Path;
use std::sync::Arc;

use super::Files;
use super::columns::open_gear;
use super::keys::GEAR_COLUMNS;
use super::sheet::{Record, Sheet};
use super::tree::{Read, Value};
use crate::error::{InputError, Problem, Problems, printable_path, quoted};
use crate::keys::Sign;
use crate::law::{Curve, CurveProblem, GearRow};
use crate::train::Doubt;
use crate::units::{self, Amount};

/// More rows than this are refused.
const MOST_ROWS: usize = 1000;

/// A gear's table as it was read.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Gear {
    /// Travel, m, and force of loading, N.
    rows: Vec<[f64; 2]>,
    /// Force of unloading, N, in each row; `None` where the table has none.
    unloading_n: Option<Vec<f64>>,
    /// Numbers of the rows as the file has them.
    numbers: Vec<usize>,
    /// What messages call it.
    name: String,
}

impl Gear {
    /// Whether the table has forces of unloading.
    pub(super) fn has_unloading(&self) -> bool {
        self.unloading_n.is_some()
    }

    /// Its curves; without forces of unloading these are the loading forces less the share `friction`.
    ///
    /// # Errors
    /// What is wrong, and what would be right.
    pub(super) fn curve(&self, friction: Option<f64>) -> Result<Curve, [String; 2]> {
        let unloading: Vec<f64> = match (&self.unloading_n, friction) {
            (Some(given), _) => given.clone(),
            (None, Some(share)) => self.rows.iter().map(|row| row[1] * (1.0 - share)).collect(),
            (None, None) => {
                let help = "add friction = \"75 %\", the share by which unloading lies under loading, or a third column, unloading [kN]";
                return Err([format!("{} has no forces of unloading", self.name), help.to_owned()]);
            }
        };
        let row = |(row, unloading_n): (&[f64; 2], f64)| GearRow { travel_m: row[0], loading_n: row[1], unloading_n };
        Curve::new(self.rows.iter().zip(unloading).map(row).collect()).map_err(|bad| self.problem_text(bad))
    }

    fn problem_text(&self, bad: CurveProblem) -> [String; 2] {
        let help = match bad {
            CurveProblem::NoForce => {
                "give the forces of loading with their unit; travel without force is slack = \"25 mm\""
            }
            _ => "travel begins at 0 and rises from row to row, forces do not fall, and unloading is at most loading",
        };
        [format!("{}: {}", self.name, bad.renumbered(|row| self.numbers[row - 1])), help.to_owned()]
    }
}

/// Reads the value of `gear`: the name of a file beside the train file, or rows.
pub(super) fn read(value: &Value, path: &Path, files: &Files) -> Read<Arc<Gear>> {
    let gear = if value.as_text().is_some() {
        let (file, text) = value.text_beside(path, files, |text| parse(text, Path::new("")).is_ok())?;
        let (gear, doubts) = parse(&text, &file).map_err(|bad| value.refer(&bad))?;
        doubts.into_iter().for_each(|doubt| value.doubt(doubt));
        gear
    } else {
        inline(value)?
    };
    // Without friction only the loading is checked, which is the same with any friction.
    let checked = gear.curve(Some(0.0));
    checked.map_err(|[title, help]| value.wrong(title, help))?;
    Ok(Arc::new(gear))
}

/// Rows that stand in the train file.
fn inline(value: &Value) -> Read<Gear> {
    let right = "expected the name of a CSV file, or rows: [[\"0 mm\", \"0 kN\", \"0 kN\"], [\"40 mm\", \"700 kN\", \"150 kN\"]]";
    let rows = value.rows(&GEAR_COLUMNS, 2, right)?;
    if rows.len() > MOST_ROWS {
        return Err(value.wrong(format!("{} has {} rows", value.name_of_key(), rows.len()), most()));
    }
    let columns = rows.first().map_or(2, Vec::len);
    if rows.iter().any(|row| row.len() != columns) {
        let title = format!("some rows of {} have an unloading force, and others have none", value.name_of_key());
        return Err(value.wrong(title, "give it in every row, or in none and add friction = \"75 %\""));
    }
    Ok(Gear {
        unloading_n: (columns == 3).then(|| rows.iter().map(|row| row[2]).collect()),
        numbers: (1..=rows.len()).collect(),
        rows: rows.iter().map(|row| [row[0], row[1]]).collect(),
        name: value.name_of_key().to_owned(),
    })
}

fn most() -> String {
    format!("a gear's table has at most {MOST_ROWS} rows")
}

/// Reads a table's text; `path` is what messages call it.
fn parse(text: &str, path: &Path) -> Result<(Gear, Vec<Doubt>), InputError> {
    let help = "a row above the numbers names the columns and their units: travel [mm],loading [kN],unloading [kN]";
    let sheet = match open_gear(text) {
        Ok(sheet) => sheet,
        Err(Some(problems)) => return Err(InputError::new(path, text, problems)),
        // Nothing is shown of a file that is no such table: a train file may come from anyone, and name any file.
        Err(None) => {
            let what = super::kinds::of_text(text).map_or(String::new(), |what| format!(": it is {what}"));
            return Err(InputError::of_file(
                path,
                format!("the gear has no columns of travel and loading{what}"),
                help,
            ));
        }
    };
    let name = path.file_name().map_or_else(|| printable_path(path), |name| printable_path(Path::new(name)));
    let mut gear = Gear { rows: vec![], unloading_n: sheet.columns[2].as_ref().map(|_| vec![]), numbers: vec![], name };
    let mut problems = Problems::default();
    for record in sheet.rows() {
        let read = [0, 1, 2].map(|w| sheet.columns[w].as_ref().map(|_| cell(&sheet, &record, w)).transpose());
        match read {
            _ if gear.rows.len() >= MOST_ROWS => problems.note(Problem::at(record.span, most(), None)),
            [Ok(travel), Ok(loading), Ok(unloading)] => {
                gear.rows.push([travel.unwrap_or_default(), loading.unwrap_or_default()]);
                gear.numbers.push(record.row);
                gear.unloading_n.iter_mut().for_each(|all| all.push(unloading.unwrap_or_default()));
                continue;
            }
            // One problem is enough: others are often the same.
            some => some.into_iter().filter_map(Result::err).take(1).for_each(|problem| problems.note(problem)),
        }
        return Err(InputError::new(path, text, problems));
    }
    let doubts = sheet.doubts(&gear.name);
    Ok((gear, doubts))
}

fn cell(sheet: &Sheet, record: &Record, w: usize) -> Result<f64, Problem> {
    let (name, of, sign) = GEAR_COLUMNS[w];
    let wrong = |found: String, right: String| {
        Problem::at(sheet.place(record, w), format!("row {}: {name} {found}", record.row), Some(right))
    };
    let Some((text, _)) = sheet.cell(record, w) else {
        return Err(wrong("is empty".into(), "expected a number in each column of each row".into()));
    };
    let (quantity, has_unit) = sheet.quantity(w, &text).map_err(|[found, right]| wrong(found, right))?;
    if !has_unit {
        let help = format!("head the column {name} [{}], or with another of {}", of.si(), of.choices());
        return Err(Problem::at(sheet.heading_span(w), format!("the column of {name} has no unit"), Some(help)));
    }
    match units::parse(&quantity, of, false) {
        Ok(Amount::Si(value) | Amount::Share(value)) if value < 0.0 && sign == Sign::NotNegative => {
            Err(wrong(format!("is negative: {}", quoted(&text)), "expected zero or more".into()))
        }
        Ok(Amount::Si(value) | Amount::Share(value)) => Ok(value),
        Err(bad) => Err(wrong(format!("{}: {}", bad.found, quoted(&text)), bad.right)),
    }
}
