//! Vehicles as a table (CSV), as yards and spreadsheets export them: one row a vehicle, units in the header.
//!
//! ```text
//! label,mass [t],length [m],held,stiffness [MN/m],rated_load [MN]
//! locomotive,195,22,yes,,
//! ore car,160,10.9,,30,1.5
//! ```
//!
//! A column has the name of a key of `[[vehicle]]`, or of a key of `[coupler]`, which is then that of the coupler behind the vehicle. An
//! empty cell leaves what `[coupler]` or `[load]` says. Each row is read as a `[[vehicle]]` and a `[[coupler_override]]`, by the same code as those tables.

use std::borrow::Cow;
use std::collections::HashSet;
use std::ops::Range;
use std::path::Path;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::Files;
use super::columns::{Of, Slot, all_columns, position, slots, vehicle_columns};
use super::couplers::OwnKeys;
use super::heading::{Content, normal, only_unit};
use super::keys::{OVERRIDE, VEHICLE};
use super::sheet::{HEADER_ROWS, Record, Sheet};
use super::sums::sums;
use super::tree::{Found, Table};
use super::vehicles::{Group, group};
use crate::error::{InputError, Problem, Problems, printable_path, quoted};
use crate::keys::Kind;
use crate::train::{Doubt, MOST_VEHICLES, VehicleSpec, held, many};
use crate::units::Dimension;

/// The vehicles of a table, in groups, and what it says of the coupler behind each.
pub(super) struct Rows {
    pub(super) groups: Vec<Group>,
    pub(super) behind: Vec<OwnKeys>,
    pub(super) doubts: Vec<Doubt>,
}

/// A cell as the value of a key.
enum Entry {
    Text(String),
    Number(String),
    Flag(bool),
}

impl Entry {
    fn toml(self) -> String {
        match self {
            Entry::Text(text) => toml::Value::String(text).to_string(),
            Entry::Number(number) => number,
            Entry::Flag(flag) => flag.to_string(),
        }
    }
}

/// Reads the rows of a table's text; `path` is what messages call it. Files that its cells name stand beside the train file.
///
/// # Errors
/// Every problem with its row and column.
pub(super) fn parse(text: &str, path: &Path, train: &Path, files: &Files) -> Result<Rows, InputError> {
    let mut reader = Reader::open(text, path)?;
    let rows = reader.rows(train, files);
    let Reader { problems, doubts, .. } = reader;
    if problems.is_empty() { Ok(Rows { doubts, ..rows }) } else { Err(InputError::new(path, text, problems)) }
}

/// Where a heading with a unit of mass probably stands, in words that show nothing of the file.
fn masses(text: &str) -> Option<String> {
    let mass = Content::Quantity { of: Dimension::Mass, share: false };
    let is_mass = |cell: &str| cell.trim().ends_with([')', ']']) && only_unit(cell, mass).is_some();
    let column = |line: &str| line.split([';', ',', '\t']).position(is_mass);
    let (row, column) =
        text.lines().take(HEADER_ROWS).enumerate().find_map(|(row, line)| Some((row, column(line)?)))?;
    Some(format!("column {} of row {}", column + 1, row + 1))
}

/// A row with its cells as they are read.
pub(super) struct ListedRow {
    pub(super) row: usize,
    pub(super) count: usize,
    pub(super) vehicle: Vec<ListedCell>,
    pub(super) coupler: Vec<ListedCell>,
}

/// A cell as the value of its key.
pub(super) struct ListedCell {
    /// As `limits.proof`.
    pub(super) key: String,
    /// As TOML.
    pub(super) value: String,
    pub(super) heading: String,
}

/// The rows of a table's text with their cells, and the doubts about it.
///
/// # Errors
/// As for [`parse`].
pub(super) fn listed(text: &str, path: &Path) -> Result<(Vec<ListedRow>, Vec<Doubt>), InputError> {
    let mut reader = Reader::open(text, path)?;
    let rows = reader.rows(path, &Files::default());
    if !reader.problems.is_empty() {
        return Err(InputError::new(path, text, reader.problems));
    }
    let records: Vec<Record> = reader.sheet.rows().collect();
    let list = records.iter().zip(&rows.groups).map(|(record, group)| {
        let mut listed = ListedRow { row: record.row, count: group.vehicle.count, vehicle: vec![], coupler: vec![] };
        for (slot, _, entry) in reader.values(record) {
            let heading = reader.sheet.columns[slot].as_ref().map_or_else(String::new, |column| column.heading.clone());
            let cell = ListedCell { key: reader.slots[slot].path.join("."), value: entry.toml(), heading };
            match reader.slots[slot].of {
                Of::Coupler => listed.coupler.push(cell),
                _ => listed.vehicle.push(cell),
            }
        }
        listed
    });
    Ok((list.collect(), std::mem::take(&mut reader.doubts)))
}

struct Reader<'t> {
    sheet: Sheet<'t>,
    slots: Vec<Slot>,
    mass: usize,
    held: usize,
    problems: Problems,
    doubts: Vec<Doubt>,
    /// Columns whose lack of a unit is noted.
    without_unit: HashSet<usize>,
    /// The file's name, in doubts.
    name: String,
}

/// A row with a held vehicle, for the last checks.
struct HeldRow {
    row: usize,
    held: Range<usize>,
    label: String,
}

impl<'t> Reader<'t> {
    /// Finds the header of a table's text.
    fn open(text: &'t str, path: &Path) -> Result<Reader<'t>, InputError> {
        let slots = slots();
        let [mass, held] = ["mass", "held"].map(|name| position(&slots, name));
        let sheet = match Sheet::open(text, &vehicle_columns(&slots), &[mass]) {
            Ok(sheet) => sheet,
            Err(Some(problems)) => return Err(InputError::new(path, text, problems)),
            Err(None) if text.trim_matches(['\u{feff}', ' ', '\n', '\r', '\t']).is_empty() => {
                let help = "give it a header and a row for each vehicle";
                return Err(InputError::of_file(path, "the table is empty", help));
            }
            // Nothing is shown of a file that is no table of vehicles: a train file may come from anyone, and name any file.
            Err(None) => {
                let what = super::kinds::of_text(text).map_or(String::new(), |what| format!(": it is {what}"));
                let help = match masses(text) {
                    Some(place) => format!("{place} is in a unit of mass; if it holds the masses, head it mass [t]"),
                    None => "a row above the vehicles names the columns: mass [t]".to_owned(),
                };
                let help = format!("{help}, and others with any of {}", all_columns(&slots));
                return Err(InputError::of_file(path, format!("this is no table of vehicles{what}"), help));
            }
        };
        Ok(Reader {
            sheet,
            slots,
            mass,
            held,
            problems: Problems::default(),
            doubts: vec![],
            without_unit: HashSet::new(),
            name: path.file_name().map_or_else(|| printable_path(path), |name| printable_path(Path::new(name))),
        })
    }

    fn rows(&mut self, train: &Path, files: &Files) -> Rows {
        let mut rows = Rows { groups: vec![], behind: vec![], doubts: vec![] };
        self.header();
        if !self.problems.is_empty() {
            return rows;
        }
        let has_couplers = self.columns(Of::Coupler).next().is_some();
        // One more than may be: a longer table is refused, and need not be held in memory for that.
        let records: Vec<Record> = self.sheet.rows().take(MOST_VEHICLES + 1).collect();
        let mut seen = vec![];
        for record in &records {
            let found = Found::default();
            let values = self.values(record);
            let [vehicle, coupler] = tables(&self.slots, &values);
            let group = group(&Table::of_row(&found, &vehicle, &VEHICLE, record.span.clone()));
            let own = OwnKeys::read(&Table::of_row(&found, &coupler, &OVERRIDE, record.span.clone()), train, files);
            let (Ok(group), Ok(own)) = (group, own) else {
                self.note_problems(record, found);
                continue;
            };
            self.note_problems(record, found);
            if group.vehicle.held {
                seen.push(HeldRow {
                    row: rows.groups.len(),
                    held: self.sheet.place(record, self.held),
                    label: self.place_of(record, self.held),
                });
            }
            rows.groups.push(group);
            if has_couplers {
                rows.behind.push(own);
            }
        }
        // Not if a row was left out because of a problem.
        if rows.groups.len() == records.len() {
            self.check(&rows, &seen);
        }
        if self.problems.is_empty() {
            self.places(&records, &rows.groups);
            self.doubtful(&records, &rows);
        }
        rows
    }

    /// The columns that are there and belong to one kind of table.
    fn columns(&self, of: Of) -> impl Iterator<Item = usize> + '_ {
        (0..self.slots.len()).filter(move |&s| self.slots[s].of == of && self.sheet.columns[s].is_some())
    }

    /// What is wrong with the header as that of a table of vehicles.
    fn header(&mut self) {
        let unread: Vec<String> = self.sheet.unread.clone();
        for name in &unread {
            // A heading that is nearly a key is a typing error.
            let lower = normal(name.split(['[', '(']).next().unwrap_or_default());
            let near = |known: &&Slot| {
                let known = known.path.last().copied().unwrap_or_default();
                lower.len() < 20 && lower != known && strsim::damerau_levenshtein(&lower, known) <= known.len() / 3
            };
            let missing =
                |(s, slot): (usize, &Slot)| (self.sheet.columns[s].is_none() && slot.of != Of::Place).then_some(s);
            let absent: Vec<usize> = self.slots.iter().enumerate().filter_map(missing).collect();
            if let Some(near) = absent.iter().map(|&s| &self.slots[s]).find(near) {
                let help =
                    format!("did you mean \"{}\"? columns are {}", near.path.join("."), all_columns(&self.slots));
                let span = self.sheet.unread_span(name);
                self.problems.note(Problem::at(span, format!("unknown column {}", quoted(name)), Some(help)));
            }
        }
        if self.sheet.columns[self.mass].is_none() && self.problems.is_empty() {
            let others = unread.iter().take(12).map(|name| quoted(name)).collect::<Vec<_>>().join(", ");
            let others = if others.is_empty() { others } else { format!("; not known are {others}") };
            let help = format!("head the column of masses mass [t], or with another unit of mass{others}");
            let span = self.sheet.header_span();
            self.problems.note(Problem::at(span.start..span.start, "the table has no column of masses", Some(help)));
        }
        self.doubts.extend(self.sheet.doubts(&self.name));
    }

    /// The cells of a row as the values of their keys; one that is wrong is noted and left out.
    fn values(&mut self, record: &Record) -> Vec<(usize, Range<usize>, Entry)> {
        let mut values = vec![];
        // The last one is the place, which is no key.
        for slot in 0..self.slots.len() - 1 {
            let Some((text, span)) = self.sheet.cell(record, slot).map(|(text, span)| (text.into_owned(), span)) else {
                continue;
            };
            match self.entry(slot, &text) {
                Ok(Some(entry)) => values.push((slot, span, entry)),
                Ok(None) => {}
                Err([title, help]) => self.wrong(record, slot, title, help),
            }
        }
        if self.sheet.cell(record, self.mass).is_none() {
            let help = "fill it in, or delete the row if it is no vehicle";
            self.wrong(record, self.mass, "there is no mass".into(), help.into());
        }
        // What is wrong with the mass has been noted.
        if values.iter().all(|(slot, ..)| *slot != self.mass) {
            values.push((self.mass, record.span.clone(), Entry::Text("1 kg".to_owned())));
        }
        values
    }

    /// A cell as the value of its key; `None` where the column is wrong as a whole, which has been noted.
    fn entry(&mut self, slot: usize, text: &str) -> Result<Option<Entry>, [String; 2]> {
        let name = self.slots[slot].path.join(".");
        let wrong = |right: &str| Err([format!("{name} is {}", quoted(text)), right.to_owned()]);
        match self.slots[slot].kind {
            Kind::Quantity { of, .. } => {
                let (quantity, has_unit) = self.sheet.quantity(slot, text)?;
                if !has_unit && self.without_unit.insert(slot) {
                    let span = self.sheet.heading_span(slot);
                    let title = format!("the column {name} has no unit, and {} has none", quoted(text));
                    let help = format!("head it {name} [{}], or with another of {}", of.si(), of.choices());
                    self.problems.note(Problem::at(span, title, Some(help)));
                }
                Ok(has_unit.then_some(Entry::Text(quantity)))
            }
            Kind::Flag => match text.to_lowercase().as_str() {
                "yes" | "y" | "true" | "1" | "x" => Ok(Some(Entry::Flag(true))),
                "no" | "n" | "false" | "0" | "-" => Ok(Some(Entry::Flag(false))),
                _ => wrong("expected yes or no, or nothing for no"),
            },
            Kind::Whole { .. } | Kind::Ratio | Kind::Positive => {
                let number = self.sheet.number(text).map(|number| whole(&number));
                match number.filter(|number| DeValue::parse(number).is_ok()) {
                    Some(number) => Ok(Some(Entry::Number(number))),
                    None => wrong("expected a number without a unit"),
                }
            }
            _ => Ok(Some(Entry::Text(text.to_owned()))),
        }
    }

    /// Notes what was found wrong in a row, each with its row and column.
    fn note_problems(&mut self, record: &Record, found: Found) {
        let (problems, doubts) = found.into_parts();
        self.doubts.extend(doubts);
        let places: Vec<(usize, String)> = if problems.is_empty() {
            vec![]
        } else {
            let starts = (0..self.slots.len()).filter(|&s| self.sheet.columns[s].is_some());
            starts.map(|s| (self.sheet.place(record, s).start, self.place_of(record, s))).collect()
        };
        self.problems.append(problems, |problem| {
            let place = problem.start().and_then(|at| places.iter().find(|(start, _)| *start == at));
            let words = place.map_or(format!("row {}: ", record.row), |(_, words)| words.clone());
            problem.after(&words)
        });
    }

    /// What is wrong with the rows as a train.
    fn check(&mut self, rows: &Rows, seen: &[HeldRow]) {
        let vehicles: Vec<VehicleSpec> = rows.groups.iter().map(|group| group.vehicle.clone()).collect();
        many(&vehicles).into_iter().for_each(|bad| self.problems.note(Problem::of_file(bad.message, bad.help)));
        for bad in held(&vehicles) {
            if let Some(seen) = seen.iter().find(|seen| bad.key == format!("vehicle[{}].held", seen.row)) {
                let problem = Problem::at(seen.held.clone(), bad.message, Some(bad.help));
                self.problems.note(problem.after(&seen.label));
            }
        }
    }

    /// Checks the order of the rows by their own numbers.
    fn places(&mut self, records: &[Record], groups: &[Group]) {
        let place = self.slots.len() - 1;
        if self.sheet.columns[place].is_none() {
            return;
        }
        let number = |record: &Record| {
            let text = self.sheet.cell(record, place)?.0;
            let text = text.trim_start_matches('#').trim_end_matches('.').trim();
            Some(text.parse::<i64>().ok())
        };
        let mut given: Vec<(usize, Option<i64>)> =
            records.iter().enumerate().filter_map(|(i, record)| Some((i, number(record)?))).collect();
        // A row of sums has a word as its number.
        given.pop_if(|(row, number)| number.is_none() && *row + 1 == records.len());
        let numbers: Option<Vec<(usize, i64)>> = given.into_iter().map(|(i, n)| Some((i, n?))).collect();
        let numbers = numbers.unwrap_or_default();
        let [low, high] =
            [numbers.iter().map(|n| n.1).min(), numbers.iter().map(|n| n.1).max()].map(Option::unwrap_or_default);
        // Road numbers of vehicles are far apart, row numbers are not.
        let vehicles = groups.iter().map(|group| group.vehicle.count as i64).sum::<i64>();
        let heading = self.sheet.columns[place].as_ref().map_or(String::new(), |c| c.heading.clone());
        if numbers.is_empty() || high.saturating_sub(low) > 2 * vehicles + 10 {
            let text =
                format!("the column {} of {} is not read: it does not number the rows", quoted(&heading), self.name);
            self.doubts.push(Doubt::of_train("column-not-read", text));
            return;
        }
        if let Some(pair) = numbers.windows(2).find(|pair| pair[1].1 <= pair[0].1) {
            let title = format!("{} comes after {}: the rows are not in the order of the train", pair[1].1, pair[0].1);
            let help =
                "sort the rows by this column, from the head; if it is no place in the train, give it another heading";
            self.wrong(&records[pair[1].0], place, title, help.into());
            return;
        }
        let gap = |pair: &&[(usize, i64)]| {
            let ((before, a), (here, b)) = (pair[0], pair[1]);
            here == before + 1 && b != a + 1 && b != a + groups[before].vehicle.count as i64
        };
        if let Some(&[(_, a), (here, b)]) = numbers.windows(2).find(gap) {
            let row = records[here].row;
            let text = format!("row {row} of {} is numbered {b} after {a}: is a row missing?", self.name);
            self.doubts.push(Doubt::of_train("row-numbers", text));
        }
    }

    /// What is probably not meant: a row of sums, and a coupler behind the last vehicle.
    fn doubtful(&mut self, records: &[Record], rows: &Rows) {
        let (Some(last), Some(record)) = (rows.groups.last(), records.last()) else { return };
        for (at, why) in sums(&rows.groups) {
            let row = records[at].row;
            let text =
                format!("{why} (row {row} of {}), and it is computed as a vehicle: delete it if it is none", self.name);
            self.doubts.push(Doubt::of_train("total-row", text));
        }
        let row = record.row;
        let behind = rows.behind.len().checked_sub(2).map(|at| (&rows.behind[at], &rows.behind[at + 1]));
        if behind.is_some_and(|(before, last)| last.gives_anything() && before != last) && last.vehicle.count == 1 {
            let text = format!(
                "row {row} of {} is the last vehicle's: what it says of the coupler behind is not used",
                self.name
            );
            self.doubts.push(Doubt::of_train("no-coupler-behind", text));
        }
    }

    fn place_of(&self, record: &Record, slot: usize) -> String {
        let heading = self.sheet.columns[slot].as_ref().map_or("", |column| &column.heading);
        format!("row {}, column {heading}: ", record.row)
    }

    fn wrong(&mut self, record: &Record, slot: usize, title: String, help: String) {
        let title = self.place_of(record, slot) + &title;
        self.problems.note(Problem::at(self.sheet.place(record, slot), title, Some(help)));
    }
}

/// A number as TOML writes it: a whole one without decimals, and without leading zeros.
fn whole(number: &str) -> String {
    let (digits, decimals) = number.split_once('.').unwrap_or((number, ""));
    let digits = digits.trim_start_matches('+').trim_start_matches('0');
    let digits = if digits.is_empty() { "0" } else { digits };
    if decimals.bytes().all(|b| b == b'0') { digits.to_owned() } else { format!("{digits}.{decimals}") }
}

/// A row as a `[[vehicle]]` and as the keys of a coupler.
fn tables<'v>(slots: &[Slot], values: &'v [(usize, Range<usize>, Entry)]) -> [DeTable<'v>; 2] {
    let mut tables = [DeTable::new(), DeTable::new()];
    for (slot, span, entry) in values {
        let value = match entry {
            Entry::Text(text) => DeValue::String(Cow::Borrowed(text)),
            Entry::Flag(flag) => DeValue::Boolean(*flag),
            Entry::Number(number) => match DeValue::parse(number) {
                Ok(value) => value.into_inner(),
                Err(_) => continue,
            },
        };
        let table = &mut tables[usize::from(slots[*slot].of == Of::Coupler)];
        put(table, &slots[*slot].path, Spanned::new(span.clone(), value));
    }
    tables
}

/// Puts a value where its path leads.
fn put<'v>(table: &mut DeTable<'v>, path: &[&'static str], value: Spanned<DeValue<'v>>) {
    let Some((first, rest)) = path.split_first() else { return };
    let key = Spanned::new(value.span(), Cow::Borrowed(*first));
    if rest.is_empty() {
        table.insert(key, value);
        return;
    }
    if !table.contains_key(*first) {
        table.insert(key, Spanned::new(value.span(), DeValue::Table(DeTable::new())));
    }
    if let Some(DeValue::Table(inner)) = table.get_mut(*first).map(Spanned::get_mut) {
        put(inner, rest, value);
    }
}
