//! Tables of text as spreadsheets and loggers export them: where the header is, what separates cells, which mark stands before decimals,
//! and which columns are those that are looked for. Vehicles and records are both read through it.
//!
//! Above the header there may be a line `sep=;`, comments that start with `#`, and lines of titles or metadata; below it a row of units.
//! What has several meanings is refused with the reason, once for the file or the column.

use std::borrow::Cow;
use std::ops::Range;

use super::heading::{Content, Heading, Wanted, heading, unit};
use super::numbers::{Decimal, canonical, number_run};
use crate::error::{Problem, Problems, quoted};
use crate::train::Doubt;

/// Columns of a table, and bytes of its header, at most.
const MOST_COLUMNS: usize = 1000;
const LONGEST_HEADER: usize = 64 << 10;
/// Rows in which the header is looked for, and rows below it that are compared to find the separator of cells.
pub(super) const HEADER_ROWS: usize = 100;
const COMPARED_ROWS: usize = 20;

/// A cell: its place without the space and the quotation marks around it.
struct Cell {
    span: Range<usize>,
    quoted: bool,
}

/// A row of cells.
pub(super) struct Record {
    /// As a spreadsheet counts it.
    pub(super) row: usize,
    pub(super) span: Range<usize>,
    cells: Vec<Cell>,
    /// How many cells it has; those beyond a limit are not kept.
    count: usize,
    /// A quotation mark that nothing closes.
    open_quote: Option<usize>,
}

/// The rows of a text from a byte on.
struct Records<'t> {
    text: &'t str,
    separator: u8,
    at: usize,
    row: usize,
}

impl Iterator for Records<'_> {
    type Item = Record;

    fn next(&mut self) -> Option<Record> {
        let bytes = self.text.as_bytes();
        let start = self.at;
        if start >= bytes.len() {
            return None;
        }
        self.row += 1;
        let mut record = Record { row: self.row, span: start..start, cells: vec![], count: 0, open_quote: None };
        loop {
            let cell = self.cell(&mut record.open_quote);
            record.count += 1;
            if record.count <= MOST_COLUMNS {
                record.cells.push(cell);
            }
            if self.at < bytes.len() && bytes[self.at] == self.separator {
                self.at += 1;
                continue;
            }
            record.span.end = self.at;
            let line_end = if bytes[self.at..].starts_with(b"\r\n") { 2 } else { 1 };
            self.at = (self.at + line_end).min(bytes.len());
            return Some(record);
        }
    }
}

impl Records<'_> {
    /// Reads a cell up to the separator or the end of the line.
    fn cell(&mut self, open_quote: &mut Option<usize>) -> Cell {
        let bytes = self.text.as_bytes();
        let ends = |b: u8| b == self.separator || b == b'\n' || b == b'\r';
        let to_end = |from: usize| from + bytes[from..].iter().take_while(|b| !ends(**b)).count();
        let start = self.at;
        let blank = |b: &&u8| **b == b' ' || **b == b'\t' && self.separator != b'\t';
        let first = start + bytes[start..].iter().take_while(blank).count();
        if bytes.get(first) != Some(&b'"') {
            self.at = to_end(first);
            return Cell { span: trimmed(self.text, start..self.at), quoted: false };
        }
        let mut close = first + 1;
        while close < bytes.len() && (bytes[close] != b'"' || bytes.get(close + 1) == Some(&b'"')) {
            close += if bytes[close] == b'"' { 2 } else { 1 };
        }
        if close >= bytes.len() {
            *open_quote = open_quote.or(Some(first));
            self.at = bytes.len();
            return Cell { span: trimmed(self.text, first + 1..self.at), quoted: true };
        }
        self.at = to_end(close + 1);
        if self.text[close + 1..self.at].trim().is_empty() {
            return Cell { span: trimmed(self.text, first + 1..close), quoted: true };
        }
        Cell { span: trimmed(self.text, first..self.at), quoted: false }
    }
}

fn trimmed(text: &str, span: Range<usize>) -> Range<usize> {
    let inside = &text[span.clone()];
    let start = span.start + inside.len() - inside.trim_start().len();
    start..start + inside.trim().len()
}

impl Record {
    fn text<'t>(&self, text: &'t str, index: usize) -> Cow<'t, str> {
        let Some(cell) = self.cells.get(index) else { return "".into() };
        let inside = &text[cell.span.clone()];
        if cell.quoted && inside.contains('"') { inside.replace("\"\"", "\"").into() } else { inside.into() }
    }

    fn is_blank(&self) -> bool {
        self.cells.iter().all(|cell| cell.span.is_empty())
    }

    fn filled(&self) -> usize {
        self.cells.iter().filter(|cell| !cell.span.is_empty()).count()
    }

    /// The place of a cell; of one that is not there, the row's end.
    fn cell_span(&self, index: usize) -> Range<usize> {
        self.cells.get(index).map_or(self.span.end..self.span.end, |cell| cell.span.clone())
    }

    /// Its first cell starts with `#`, outside quotation marks.
    fn is_comment(&self, text: &str) -> bool {
        self.cells.first().is_some_and(|cell| !cell.quoted && text[cell.span.clone()].starts_with('#'))
    }
}

/// A column that is looked for: where it is, its heading as written, and the unit that its heading or the row of units gives.
pub(super) struct Column {
    index: usize,
    pub(super) heading: String,
    pub(super) unit: Option<String>,
}

/// A table whose header has been found.
pub(super) struct Sheet<'t> {
    pub(super) text: &'t str,
    pub(super) separator: u8,
    decimal: Decimal,
    /// In the order in which they are looked for.
    pub(super) columns: Vec<Option<Column>>,
    header: Record,
    /// Headings of the other columns that have something in them.
    pub(super) unread: Vec<String>,
    /// Rows that start with `#` and have as many cells as the header.
    commented: Vec<usize>,
    /// Where the rows start, and how many are above.
    body: (usize, usize),
}

/// A row that may be the header.
struct Candidate {
    separator: u8,
    header: Record,
    headings: Vec<Heading>,
    /// The candidate of the largest rank is the header: whether it has all that is needed, whether it is no comment,
    /// how many headings are known, how many rows below have as many cells.
    rank: (bool, bool, usize, usize),
    body: (usize, usize),
}

/// Why a text is no such table: `None` where nothing in it looks like a header.
pub(super) type NoSheet = Option<Problems>;

impl<'t> Sheet<'t> {
    /// Finds the header and the columns; a header has one of `needed` at least, if there is a choice.
    ///
    /// # Errors
    /// What is wrong with the table as a whole.
    pub(super) fn open(text: &'t str, wanted: &[Wanted], needed: &[usize]) -> Result<Sheet<'t>, NoSheet> {
        let (separators, start) = separators(text);
        let best = separators.iter().filter_map(|s| candidate(text, *s, start, wanted, needed));
        // Of equals the first one stays.
        let best = best.reduce(|best, next| if next.rank > best.rank { next } else { best });
        let Some(best) = best else { return Err(None) };
        let mut problems = Problems::default();
        let columns = columns(text, &best, wanted, &mut problems);
        let Candidate { separator, header, body, .. } = best;
        let mut sheet = Sheet {
            text,
            separator,
            decimal: Decimal::Point,
            columns,
            header,
            unread: vec![],
            commented: vec![],
            body,
        };
        if problems.is_empty() {
            sheet.units_row(wanted, &mut problems);
            sheet.look_through(wanted, &mut problems);
        }
        if problems.is_empty() { Ok(sheet) } else { Err(Some(problems)) }
    }

    /// The rows below the header that are neither blank nor comments.
    pub(super) fn rows(&self) -> impl Iterator<Item = Record> {
        let records = self.all_rows();
        records.filter(|record| !record.is_blank() && !record.is_comment(self.text))
    }

    fn all_rows(&self) -> Records<'t> {
        Records { text: self.text, separator: self.separator, at: self.body.0, row: self.body.1 }
    }

    /// What stands in a column that is looked for, if anything does.
    pub(super) fn cell(&self, record: &Record, wanted: usize) -> Option<(Cow<'t, str>, Range<usize>)> {
        let column = self.columns[wanted].as_ref()?;
        let text = record.text(self.text, column.index);
        (!text.is_empty()).then(|| (text, record.cell_span(column.index)))
    }

    /// The place where the cell of a column is or would be.
    pub(super) fn place(&self, record: &Record, wanted: usize) -> Range<usize> {
        let column = self.columns[wanted].as_ref();
        column.map_or(record.span.clone(), |column| record.cell_span(column.index))
    }

    /// Where the heading of a column stands.
    pub(super) fn heading_span(&self, wanted: usize) -> Range<usize> {
        self.columns[wanted].as_ref().map_or(0..0, |column| self.header.cell_span(column.index))
    }

    /// Where the heading of a column stands that is not read.
    pub(super) fn unread_span(&self, name: &str) -> Range<usize> {
        let index = (0..self.header.cells.len()).find(|&i| self.header.text(self.text, i) == name);
        index.map_or(self.header.span.clone(), |index| self.header.cell_span(index))
    }

    pub(super) fn header_span(&self) -> Range<usize> {
        self.header.span.clone()
    }

    /// Columns and rows of the table that are filled and not read; `name` is what messages call the table.
    pub(super) fn doubts(&self, name: &str) -> Vec<Doubt> {
        const SHOWN: usize = 12;
        let mut doubts = vec![];
        if !self.unread.is_empty() {
            let all = self.unread.iter().take(SHOWN).map(|name| quoted(name)).collect::<Vec<_>>().join(", ");
            let more = self.unread.len().saturating_sub(SHOWN);
            let more = if more > 0 { format!(" and {more} more") } else { String::new() };
            let [columns, are] = if self.unread.len() == 1 { ["column", "is"] } else { ["columns", "are"] };
            let text = format!("the {columns} {all}{more} of {name} {are} not read");
            doubts.push(Doubt::of_train("column-not-read", text));
        }
        if let Some(row) = self.commented.first() {
            let text =
                format!("row {row} of {name} starts with # and is passed over, though it is filled like the others");
            doubts.push(Doubt::of_train("row-commented", text));
        }
        doubts
    }

    /// A quantity's text with a point before the decimals, without separators of thousands, and with its unit, if it has one.
    ///
    /// # Errors
    /// A unit that is not the column's: what is found and what would be right.
    pub(super) fn quantity(&self, wanted: usize, text: &str) -> Result<(String, bool), [String; 2]> {
        let of_column = self.columns[wanted].as_ref().and_then(|column| column.unit.as_deref());
        let (run, rest) = text.split_at(number_run(text).len());
        let number = canonical(run, self.decimal);
        let own = rest.trim();
        if let (Some(number), Some(unit)) = (&number, of_column.filter(|unit| own.is_empty() || *unit == own)) {
            return Ok((format!("{number} {unit}"), true));
        }
        let same = |unit: &&str| !own.is_empty() && *unit != own && number.is_some();
        if let Some(unit) = of_column.filter(same) {
            let found = format!("{} has {} after the number, and its column is in {unit}", quoted(text), quoted(own));
            return Err([found, format!("write the number alone, in {unit}, or take the unit out of the heading")]);
        }
        let has_unit = !own.is_empty() || number.is_none();
        Ok((format!("{}{rest}", number.as_deref().unwrap_or(run)), has_unit))
    }

    /// A plain number with a point before the decimals, where the text is one.
    pub(super) fn number(&self, text: &str) -> Option<String> {
        (number_run(text).len() == text.len()).then(|| canonical(text, self.decimal))?
    }

    /// Takes the units from a row of units below the header.
    fn units_row(&mut self, wanted: &[Wanted], problems: &mut Problems) {
        let mut records = self.all_rows();
        let Some(row) = records.by_ref().find(|record| !record.is_blank() && !record.is_comment(self.text)) else {
            return;
        };
        let bare = |text: &str| text.trim_matches(['[', ']', '(', ')', ' ']).to_owned();
        let cells: Vec<String> = (0..row.count.min(MOST_COLUMNS)).map(|i| bare(&row.text(self.text, i))).collect();
        let quantity = |w: &usize| matches!(wanted[*w].content, Content::Quantity { .. });
        let present: Vec<usize> = (0..wanted.len()).filter(|w| self.columns[*w].is_some()).filter(quantity).collect();
        let cell = |w: usize| self.columns[w].as_ref().and_then(|c| cells.get(c.index)).map_or("", |s| s.as_str());
        let blank = |text: &str| text.is_empty() || text == "-";
        let is_unit = |w: usize| blank(cell(w)) || unit(cell(w), wanted[w].content).is_ok();
        let no_digits = cells.iter().all(|text| !text.starts_with(|c: char| c.is_ascii_digit()));
        if !no_digits || !present.iter().all(|&w| is_unit(w)) || present.iter().all(|&w| blank(cell(w))) {
            return;
        }
        let units = present.iter().map(|&w| (w, unit(cell(w), wanted[w].content).ok().flatten()));
        for (w, found) in units.collect::<Vec<_>>() {
            let (place, Some(column)) = (self.place(&row, w), self.columns[w].as_mut()) else { continue };
            match (&column.unit, found) {
                (None, found) => column.unit = found,
                (Some(unit), Some(other)) if *unit != other => {
                    let title = format!("the column {} has two units", quoted(&column.heading));
                    problems.note(Problem::at(place, title, Some("keep the right one".into())));
                }
                _ => {}
            }
        }
        self.body = (records.at, records.row);
    }

    /// Goes through all rows once, to tell the decimal mark, columns that are not read and rows that do not fit the header.
    fn look_through(&mut self, wanted: &[Wanted], problems: &mut Problems) {
        let numbers: Vec<usize> = (0..wanted.len())
            .filter(|w| !matches!(wanted[*w].content, Content::Text))
            .filter_map(|w| self.columns[w].as_ref().map(|column| column.index))
            .collect();
        let width = self.header.count.min(MOST_COLUMNS);
        let named = (0..width).rev().find(|&i| !self.header.text(self.text, i).is_empty()).map_or(0, |i| i + 1);
        // Digits alone behind the last heading may be decimals after a comma.
        let is_decimals =
            |text: &str| self.separator == b',' && !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
        let mut marks = super::numbers::Marks::default();
        let mut filled = vec![false; width];
        let (mut commented, mut too_wide) = (vec![], None);
        for record in self.all_rows().filter(|record| !record.is_blank()) {
            if let Some(at) = record.open_quote {
                let help = "close it, or write two of them for one in a text";
                problems.note(Problem::at(
                    at..at + 1,
                    "a quotation mark is opened and never closed",
                    Some(help.into()),
                ));
                return;
            }
            if record.is_comment(self.text) {
                let like_others = record.filled() >= self.header.filled().max(2);
                commented.extend(like_others.then_some(record.row));
                continue;
            }
            let beyond = (named..record.cells.len())
                .find(|&i| !record.cells[i].span.is_empty() && (i >= width || is_decimals(&record.text(self.text, i))));
            if let (None, Some(beyond)) = (&too_wide, beyond) {
                too_wide = Some((record.row, record.cells.len(), record.cell_span(beyond)));
            }
            for (filled, cell) in filled.iter_mut().zip(&record.cells) {
                *filled |= !cell.span.is_empty();
            }
            for &index in &numbers {
                marks.add_cell(&record.text(self.text, index), record.cell_span(index));
            }
        }
        if let Some((row, cells, span)) = too_wide {
            let title = format!("row {row} has {cells} cells, and the header has {named}");
            let help = "give each column a heading; a number with a decimal comma is put in quotes, or the cells are separated by ;";
            problems.note(Problem::at(span, title, Some(help.into())));
            return;
        }
        match marks.decide(self.separator) {
            Ok(decimal) => self.decimal = decimal,
            Err(problem) => problems.note(problem),
        }
        let read: Vec<usize> = self.columns.iter().flatten().map(|column| column.index).collect();
        let unread = (0..width).filter(|i| filled[*i] && !read.contains(i));
        let name = |i| Some(self.header.text(self.text, i).into_owned()).filter(|n| !n.is_empty());
        self.unread =
            unread.map(|i| name(i).unwrap_or_else(|| format!("number {}, without a heading", i + 1))).collect();
        self.commented = commented;
    }
}

/// The separators to try, and where the text starts behind a line `sep=;`.
fn separators(text: &str) -> (Vec<u8>, usize) {
    let start = if text.starts_with('\u{feff}') { 3 } else { 0 };
    let line = text[start..].split(['\n', '\r']).next().unwrap_or_default();
    let said = line.trim().trim_matches('"').to_ascii_lowercase();
    match said.strip_prefix("sep=").map(str::as_bytes) {
        Some(&[separator]) if !separator.is_ascii_alphanumeric() && separator != b'"' => {
            let after = start + line.len();
            let end = if text[after..].starts_with("\r\n") { 2 } else { usize::from(after < text.len()) };
            (vec![separator], after + end)
        }
        // A tab at the end of a line is trimmed.
        Some([]) if line.contains('\t') => (vec![b'\t'], start + line.len()),
        _ => (vec![b',', b';', b'\t', b'|'], start),
    }
}

/// The best header with this separator.
fn candidate(text: &str, separator: u8, start: usize, wanted: &[Wanted], needed: &[usize]) -> Option<Candidate> {
    let mut records = Records { text, separator, at: start, row: 0 };
    let mut best: Option<Candidate> = None;
    let mut first = true;
    for _ in 0..HEADER_ROWS {
        let Some(header) = records.next() else { break };
        let headings = headings(text, &header, wanted);
        let known = |w: usize| headings.iter().any(|h| h.wanted() == Some(w));
        let count = (0..wanted.len()).filter(|w| known(*w)).count();
        let complete = needed.iter().all(|w| known(*w));
        let comment = header.is_comment(text) && header.text(text, 0) != "#";
        // Far down in a file, one word that is known does not make a header.
        let header_like = complete || !comment && (count > 1 || count == 1 && first);
        first &= header.is_blank() || comment;
        if !header_like {
            continue;
        }
        let rank = (complete, !comment, count, 0);
        if best.as_ref().is_none_or(|best| rank > best.rank) {
            best = Some(Candidate { separator, header, headings, rank, body: (records.at, records.row) });
        }
    }
    let mut best = best?;
    let below = Records { text, separator, at: best.body.0, row: 0 };
    let fits = below
        .filter(|r| !r.is_blank() && !r.is_comment(text))
        .take(COMPARED_ROWS)
        .filter(|r| r.count == best.header.count);
    best.rank.3 = fits.count();
    Some(best)
}

/// What each cell of a row means as a heading. Where no column has a wanted name, the only one with a fitting unit is
/// taken, if a unit is enough for it.
fn headings(text: &str, header: &Record, wanted: &[Wanted]) -> Vec<Heading> {
    let cells: Vec<Cow<str>> = (0..header.cells.len()).map(|i| header.text(text, i)).collect();
    let uncommented = |(i, cell): (usize, &Cow<str>)| match cell.strip_prefix('#') {
        Some(rest) if i == 0 && !rest.trim().is_empty() => rest.trim().to_owned(),
        _ => cell.to_string(),
    };
    let mut found: Vec<Heading> = cells.iter().enumerate().map(|cell| heading(&uncommented(cell), wanted)).collect();
    for (w, want) in wanted.iter().enumerate().filter(|(_, want)| want.by_unit) {
        if found.iter().any(|h| h.wanted() == Some(w)) {
            continue;
        }
        let units =
            cells.iter().enumerate().map(uncommented).map(|cell| super::heading::only_unit(&cell, want.content));
        let mut fitting = units.enumerate().filter_map(|(i, unit)| Some((i, unit?)));
        if let (Some((i, unit)), None) = (fitting.next(), fitting.next())
            && matches!(found[i], Heading::Unknown)
        {
            found[i] = Heading::Is { wanted: w, synonym: true, unit: Some(unit) };
        }
    }
    found
}

/// Where each column that is looked for is; notes what is wrong with the headings.
fn columns(text: &str, best: &Candidate, wanted: &[Wanted], problems: &mut Problems) -> Vec<Option<Column>> {
    let header = &best.header;
    let mut found: Vec<Option<Column>> = wanted.iter().map(|_| None).collect();
    if header.count > MOST_COLUMNS || header.span.len() > LONGEST_HEADER {
        let title =
            format!("the table has {} columns, with {} bytes in their headings", header.count, header.span.len());
        let help =
            format!("a table has at most {MOST_COLUMNS}, with {LONGEST_HEADER} bytes: leave out what is not read");
        problems.note(Problem::of_file(title, help));
        return found;
    }
    let exact = |w: usize| {
        best.headings.iter().any(|h| matches!(h, Heading::Is { wanted, synonym: false, .. } if *wanted == w))
    };
    for (index, is) in best.headings.iter().enumerate() {
        let heading = header.text(text, index).into_owned();
        match is {
            Heading::Unknown => {}
            Heading::BadUnit { found, right, .. } => {
                let title = format!("the column {} {found}", quoted(&heading));
                problems.note(Problem::at(header.cell_span(index), title, Some(right.clone())));
            }
            // Beside a column with the key's own name a synonym does not count.
            Heading::Is { wanted, synonym: true, .. } if exact(*wanted) => {}
            Heading::Is { wanted: w, unit, .. } => {
                if let Some(first) = &found[*w] {
                    let name = &wanted[*w].names[0];
                    let title = format!("the table has two columns {name}");
                    let both = format!("keep one of {} and {}", quoted(&first.heading), quoted(&heading));
                    problems.note(Problem::at(header.cell_span(index), title, Some(both)));
                }
                found[*w] = Some(Column { index, heading, unit: unit.clone() });
            }
        }
    }
    found
}
