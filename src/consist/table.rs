//! Vehicles as a table (CSV), as yards and spreadsheets export them: one row a vehicle, units in the header.
//!
//! ```text
//! label,mass [t],length [m],held,stiffness [MN/m],rated_load [MN]
//! locomotive,195,22,yes,,
//! ore car,160,10.9,,30,1.5
//! ```
//!
//! `stiffness`, `rated_load` and `rated_buff` are those of the coupler behind the vehicle; an empty cell leaves what
//! `[coupler]` says, and the last vehicle's mean nothing. Columns with other names are passed over, unless they look like a
//! slip of one of these.

use std::ops::Range;
use std::path::{Path, PathBuf};

use super::MOST_VEHICLES;
use crate::error::{InputError, Problem, Problems, is_obeyed, quoted};
use crate::units::{self, Amount, Dimension, one_of};

/// Wider tables are refused, and so are longer headers, in bytes: what a message says of a cell takes a walk to it.
const MOST_COLUMNS: usize = 1000;
const LONGEST_HEADER: usize = 64 << 10;

/// A row: vehicles alike, and the coupler behind each of them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Row {
    pub(super) label: Option<String>,
    pub(super) count: usize,
    pub(super) mass_kg: f64,
    pub(super) held: bool,
    pub(super) length_m: Option<f64>,
    pub(super) stiffness_n_per_m: Option<f64>,
    pub(super) rated_draft_n: Option<f64>,
    pub(super) rated_buff_n: Option<f64>,
}

/// A column that is read, and what its cells are.
const COLUMNS: [(&str, Option<Dimension>); 8] = [
    ("label", None),
    ("count", None),
    ("held", None),
    ("mass", Some(Dimension::Mass)),
    ("length", Some(Dimension::Length)),
    ("stiffness", Some(Dimension::Stiffness)),
    ("rated_load", Some(Dimension::Force)),
    ("rated_buff", Some(Dimension::Force)),
];

/// A known column's place in the rows, its heading as written, and the unit in it.
struct Column {
    index: usize,
    heading: String,
    unit: Option<String>,
}

/// Reads the rows of a table's text; `path` is what messages call it.
///
/// # Errors
/// Every problem with its row and column.
pub(super) fn parse(text: &str, path: &Path) -> Result<Vec<Row>, InputError> {
    let mut reader = Reader { text, delimiter: delimiter(text), problems: Problems::default() };
    let rows = reader.rows();
    if reader.problems.is_empty() { Ok(rows) } else { Err(InputError::new(path, text, reader.problems)) }
}

/// Where a train file's table stands: beside the train file, unless its path says otherwise.
pub(super) fn place(train: &Path, table: &str) -> PathBuf {
    train.parent().unwrap_or(Path::new("")).join(table)
}

/// What separates the cells: whichever of `,`, `;` and tab the header has most of.
fn delimiter(text: &str) -> u8 {
    let header = text.lines().next().unwrap_or_default();
    let count = |d: &u8| header.bytes().filter(|b| b == d).count();
    // Of equals the last counts as the largest.
    [b'\t', b';', b','].into_iter().max_by_key(count).unwrap_or(b',')
}

struct Reader<'s> {
    text: &'s str,
    delimiter: u8,
    problems: Problems,
}

/// A record with its place, its row as a spreadsheet counts it, and what is read of it.
struct Record {
    start: usize,
    row: usize,
    cells: csv::StringRecord,
}

impl Reader<'_> {
    fn rows(&mut self) -> Vec<Row> {
        let bom = if self.text.starts_with('\u{feff}') { 3 } else { 0 };
        let mut records = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .delimiter(self.delimiter)
            .trim(csv::Trim::All)
            .from_reader(&self.text.as_bytes()[bom..])
            .into_records()
            .enumerate()
            .filter_map(|(i, cells)| {
                // The text is UTF-8 and rows may differ in length, so nothing is left to fail.
                let cells = cells.ok()?;
                let start = bom + cells.position().map_or(0, |p| p.byte() as usize);
                Some(Record { start, row: i + 1, cells })
            });
        let Some(columns) = records.next().and_then(|header| self.header(&header)) else {
            if self.problems.is_empty() {
                self.problems
                    .note(Problem::of_file("the table is empty", "give it a header and a row for each vehicle"));
            }
            return vec![];
        };
        let blank = |record: &Record| record.cells.iter().all(str::is_empty);
        // One more than may be: a longer table is refused, and need not be held in memory for that.
        let records: Vec<Record> = records.filter(|record| !blank(record)).take(MOST_VEHICLES + 1).collect();
        let rows: Vec<Row> = records.iter().map(|record| self.row(record, &columns)).collect();
        self.check(&rows, &records, &columns);
        rows
    }

    /// Where each known column is.
    fn header(&mut self, header: &Record) -> Option<[Option<Column>; COLUMNS.len()]> {
        let (columns, bytes) = (header.cells.len(), header.cells.as_slice().len());
        if columns > MOST_COLUMNS || bytes > LONGEST_HEADER {
            let title = format!("the table has {columns} columns, with {bytes} bytes in their headings");
            let help =
                format!("a table has at most {MOST_COLUMNS}, with {LONGEST_HEADER} bytes: leave out what is not read");
            self.problems.note(Problem::of_file(title, help));
            return None;
        }
        let heading_is_known = |heading: &str| {
            let name = heading.split('[').next().unwrap_or_default().trim();
            COLUMNS.iter().any(|(known, _)| known.eq_ignore_ascii_case(name))
        };
        if !header.cells.iter().any(heading_is_known) {
            // Nothing is shown of a file that is no table of vehicles: a train file may come from anyone, and name any file.
            let help = format!("its first row names columns: mass [t], and any of {}", one_of(COLUMNS.map(|c| c.0)));
            self.problems.note(Problem::of_file("this is no table of vehicles", help));
            return None;
        }
        let mut found = [const { None }; COLUMNS.len()];
        for (index, heading) in header.cells.iter().enumerate() {
            let (name, unit) = match heading.split_once('[') {
                Some((name, unit)) => (name.trim(), Some(unit.trim_end_matches(']').trim().to_owned())),
                None => (heading, None),
            };
            let Some(known) = COLUMNS.iter().position(|(n, _)| n.eq_ignore_ascii_case(name)) else {
                self.misspelt(header, index, name);
                continue;
            };
            let dimension = COLUMNS[known].1;
            let fits = match (&unit, dimension) {
                (Some(unit), Some(dimension)) => dimension.units().any(|u| u == unit),
                (Some(_), None) => false,
                (None, _) => true,
            };
            if !fits {
                let right =
                    dimension.map_or(format!("write the heading {name}"), |d| format!("a {d} is in {}", d.choices()));
                self.wrong(header, index, format!("the column {} has an unknown unit", quoted(heading)), right);
            }
            if found[known].is_some() {
                self.wrong(header, index, format!("the table has two columns {name}"), "keep one of the two".into());
            }
            found[known] = Some(Column { index, heading: heading.to_owned(), unit });
        }
        if found[3].is_none() && self.problems.is_empty() {
            let help = "add a column headed mass [t], or another unit of mass";
            let span = header.start..header.start;
            self.problems.note(Problem::at(span, "the table has no column of masses", Some(help.into())));
        }
        self.problems.is_empty().then_some(found)
    }

    /// Notes a heading that is nearly one of those that are read.
    fn misspelt(&mut self, header: &Record, index: usize, name: &str) {
        let lower = name.to_lowercase();
        let near = COLUMNS
            .iter()
            .map(|c| c.0)
            .find(|known| name.len() < 20 && strsim::damerau_levenshtein(&lower, known) <= known.len() / 3);
        if let Some(near) = near {
            let help = format!("did you mean \"{near}\"? columns are {}", one_of(COLUMNS.map(|c| c.0)));
            self.wrong(header, index, format!("unknown column {}", quoted(name)), help);
        }
    }

    fn row(&mut self, record: &Record, columns: &[Option<Column>; COLUMNS.len()]) -> Row {
        let [label, count, held, mass, length, stiffness, draft, buff] = columns;
        let mut number = |column: &Option<Column>, dimension| self.quantity(record, column, dimension);
        let (mass_kg, length_m) = (number(mass, Dimension::Mass), number(length, Dimension::Length));
        let stiffness_n_per_m = number(stiffness, Dimension::Stiffness);
        let (rated_draft_n, rated_buff_n) = (number(draft, Dimension::Force), number(buff, Dimension::Force));
        if let (None, Some(column)) = (cell(record, mass), mass) {
            self.wrong(record, column.index, place_of(record, column) + "there is no mass", "fill it in".into());
        }
        Row {
            label: self.label(record, label),
            count: self.count(record, count),
            mass_kg: mass_kg.unwrap_or(1.0),
            held: self.held(record, held),
            length_m,
            stiffness_n_per_m,
            rated_draft_n,
            rated_buff_n,
        }
    }

    fn quantity(&mut self, record: &Record, column: &Option<Column>, dimension: Dimension) -> Option<f64> {
        let (column, text) = (column.as_ref()?, cell(record, column)?);
        let with_unit = column.unit.as_ref().map_or(text.to_owned(), |unit| format!("{text} {unit}"));
        let (found, right) = match units::parse(&with_unit, dimension, false) {
            Ok(Amount::Si(value) | Amount::Share(value)) if value > 0.0 => return Some(value),
            Ok(_) => ("is not more than zero".to_owned(), "expected more than zero".to_owned()),
            Err(bad) => (bad.found, bad.right),
        };
        self.wrong(record, column.index, format!("{}{} {found}", place_of(record, column), quoted(text)), right);
        None
    }

    fn label(&mut self, record: &Record, column: &Option<Column>) -> Option<String> {
        let (column, text) = (column.as_ref()?, cell(record, column)?);
        if text.chars().count() > 200 || text.chars().any(is_obeyed) {
            let title = place_of(record, column) + "the label is no line of up to 200 characters";
            self.wrong(record, column.index, title, "expected plain text".into());
        }
        Some(text.to_owned())
    }

    fn count(&mut self, record: &Record, column: &Option<Column>) -> usize {
        let (Some(column), Some(text)) = (column, cell(record, column)) else { return 1 };
        let number = text.parse().ok().filter(|n| (1..=MOST_VEHICLES).contains(n));
        number.unwrap_or_else(|| {
            let right =
                format!("expected a whole number from 1 to {MOST_VEHICLES}, how many of them follow each other");
            self.wrong(record, column.index, format!("{}count is {}", place_of(record, column), quoted(text)), right);
            1
        })
    }

    fn held(&mut self, record: &Record, column: &Option<Column>) -> bool {
        let (Some(column), Some(text)) = (column, cell(record, column)) else { return false };
        match text.to_lowercase().as_str() {
            "yes" | "true" | "1" => true,
            "no" | "false" | "0" => false,
            _ => {
                let title = format!("{}held is {}", place_of(record, column), quoted(text));
                self.wrong(record, column.index, title, "expected yes or no, or nothing for no".into());
                false
            }
        }
    }

    /// What is wrong with the rows as a train.
    fn check(&mut self, rows: &[Row], records: &[Record], columns: &[Option<Column>; COLUMNS.len()]) {
        let total = rows.iter().fold(0usize, |sum, row| sum.saturating_add(row.count));
        let help = "give it a row for each vehicle, at least two";
        match total {
            0 => self.problems.note(Problem::of_file("the table has no vehicles", help)),
            1 => self.problems.note(Problem::of_file("the table has 1 vehicle", help)),
            n if n > MOST_VEHICLES => {
                let title = format!("the table has more than {MOST_VEHICLES} vehicles");
                self.problems.note(Problem::of_file(title, "a train has at most that many"));
            }
            _ => {}
        }
        let Some(held) = &columns[2] else { return };
        let right = "only the first and the last vehicle of the train can be held, and not both of a train of two";
        for (i, (row, record)) in rows.iter().zip(records).enumerate() {
            let at_an_end = i == 0 || i + 1 == rows.len();
            let all = total == 2 && rows.iter().all(|r| r.held);
            if row.held && (!at_an_end || row.count > 1 || all) {
                let title = place_of(record, held) + "this vehicle cannot be held";
                self.wrong(record, held.index, title, right.into());
            }
        }
    }

    fn wrong(&mut self, record: &Record, column: usize, title: String, help: String) {
        let span = cell_span(self.text, record.start, self.delimiter, column);
        self.problems.note(Problem::at(span, title, Some(help)));
    }
}

/// The cell's text, if there is any.
fn cell<'r>(record: &'r Record, column: &Option<Column>) -> Option<&'r str> {
    record.cells.get(column.as_ref()?.index).filter(|text| !text.is_empty())
}

fn place_of(record: &Record, column: &Column) -> String {
    format!("row {}, column {}: ", record.row, column.heading)
}

/// Where a cell of the record that starts at a byte stands, without the space around it.
fn cell_span(text: &str, start: usize, delimiter: u8, column: usize) -> Range<usize> {
    let bytes = text.as_bytes();
    let (mut from, mut at, mut cell, mut in_quotes) = (start, start, 0, false);
    while at < bytes.len() {
        match bytes[at] {
            b'"' => in_quotes = !in_quotes,
            b'\n' | b'\r' if !in_quotes => break,
            b if b == delimiter && !in_quotes && cell == column => break,
            b if b == delimiter && !in_quotes => (cell, from) = (cell + 1, at + 1),
            _ => {}
        }
        at += 1;
    }
    // A row that is too short ends before the cell.
    let inside = if cell == column { &text[from..at] } else { "" };
    let end = if cell == column { from + inside.trim_end().len() } else { at };
    end - inside.trim().len()..end
}
