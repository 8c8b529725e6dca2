//! Sheets of workbooks (xlsx, ods) as the text of a CSV file, so that they are read as CSV files are.
//!
//! Rows stay where they are: row 7 of the sheet is row 7 of the text. A cell that shows a percentage holds a hundredth of the number, and
//! is written with its `%`. Dates and errors become words that are no numbers, so that nothing is computed from them.

mod ods;
mod xlsx;

use std::io::{Cursor, Read as _};

use zip::ZipArchive;

use super::numbers::{cell_of_number, cell_of_text};
use crate::error::quoted;

/// Bytes unpacked, and bytes of a sheet's text, at most.
const UNPACKED: u64 = 256 << 20;
const LONGEST_TEXT: usize = 16 << 20;
/// As many rows and columns as the programs have that write workbooks.
const MOST_ROWS: usize = 1 << 20;
const MOST_COLUMNS: usize = 1 << 14;

/// What is wrong, and what would be right.
type Wrong = [String; 2];

const AS_CSV: &str = "save the sheet as CSV, and give the path of that file";

/// What a cell holds.
enum CellContent {
    Number(f64),
    /// A hundredth of what is shown.
    Percentage(f64),
    Text(String),
    /// Something that is no number and no text: a date, an error.
    Other(String),
}

/// A sheet under way: its text, and the place of the last cell.
#[derive(Default)]
struct Sheet {
    text: String,
    row: usize,
    column: usize,
}

impl Sheet {
    /// Adds a cell; cells come by rows, from the left, counted from 0.
    fn add(&mut self, row: usize, column: usize, cell_content: &CellContent) -> Result<(), Wrong> {
        if row >= MOST_ROWS || column >= MOST_COLUMNS || (row, column) < (self.row, self.column) {
            return Err(["the workbook is damaged: its cells are not in order".into(), AS_CSV.into()]);
        }
        for _ in self.row..row {
            self.text.push('\n');
            self.column = 0;
        }
        for _ in self.column..column {
            self.text.push(',');
        }
        (self.row, self.column) = (row, column);
        self.text += &cell(cell_content);
        if self.text.len() > LONGEST_TEXT {
            let title = format!("the sheet holds more than {} MiB of text", LONGEST_TEXT >> 20);
            return Err([title, "keep the vehicles alone, in a sheet of their own".into()]);
        }
        Ok(())
    }
}

fn cell(cell_content: &CellContent) -> String {
    match cell_content {
        CellContent::Number(number) => cell_of_number(number.to_string()),
        CellContent::Percentage(share) => format!("{} %", percent(*share)),
        CellContent::Text(text) => cell_of_text(text),
        CellContent::Other(text) => format!("\"{}\"", text.replace('"', "'")),
    }
}

/// 100 times a share, without the digits that rounding adds: 0.07 gives 7.
fn percent(share: f64) -> f64 {
    let text = format!("{share:e}");
    let shifted = text.split_once('e').and_then(|(digits, power)| {
        let power: i32 = power.parse().ok()?;
        format!("{digits}e{}", power + 2).parse().ok()
    });
    shifted.unwrap_or(share * 100.0)
}

/// The text of a sheet: the one of that name, or else the only one with a table of the expected kind.
///
/// # Errors
/// A file that is no workbook, is too large or has no such sheet.
pub(super) fn text(bytes: &[u8], name: Option<&str>, is_wanted: fn(&str) -> bool) -> Result<String, Wrong> {
    let damaged = |why: String| [format!("the workbook cannot be read: {why}"), AS_CSV.to_owned()];
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|e| damaged(e.to_string()))?;
    check_unpacked_size(&mut archive)?;
    let is_ods = archive.index_for_name("content.xml").is_some();
    let sheets = if is_ods {
        let mut content = String::new();
        let mut file = archive.by_name("content.xml").map_err(|e| damaged(e.to_string()))?;
        file.read_to_string(&mut content).map_err(|e| damaged(e.to_string()))?;
        ods::sheets(&content, name)?
    } else {
        xlsx::sheets(bytes, name)?
    };
    choose(sheets, name, is_wanted)
}

/// Refuses a workbook whose parts unpack to too many bytes.
fn check_unpacked_size(archive: &mut ZipArchive<Cursor<&[u8]>>) -> Result<(), Wrong> {
    let mut unpacked = 0;
    for i in 0..archive.len() {
        // A damaged part is reported when it is needed.
        let Ok(file) = archive.by_index(i) else { continue };
        unpacked += std::io::copy(&mut file.take(UNPACKED + 1 - unpacked), &mut std::io::sink()).unwrap_or(0);
        if unpacked > UNPACKED {
            let title = format!("the workbook unpacks to more than {} MiB", UNPACKED >> 20);
            return Err([title, AS_CSV.to_owned()]);
        }
    }
    Ok(())
}

/// A sheet's name and its text; `None` for one that was not asked for by name.
type Named = (String, Option<String>);

fn choose(sheets: Vec<Named>, name: Option<&str>, is_wanted: fn(&str) -> bool) -> Result<String, Wrong> {
    let names: Vec<String> = sheets.iter().map(|(name, _)| quoted(name)).collect();
    let all = names.iter().take(12).cloned().collect::<Vec<_>>().join(", ");
    if let Some(name) = name {
        let found = sheets.into_iter().find(|(sheet, _)| sheet == name).and_then(|(_, text)| text);
        let title = format!("the workbook has no sheet {}", quoted(name));
        return found.ok_or_else(|| [title, format!("its sheets are {all}")]);
    }
    let only = sheets.len() == 1;
    let mut wanted = sheets.into_iter().filter(|(_, text)| text.as_deref().is_some_and(|t| only || is_wanted(t)));
    match (wanted.next(), wanted.next()) {
        (Some((_, Some(text))), None) => Ok(text),
        (Some((first, _)), Some((second, _))) => {
            let title = format!("sheets {} and {} could both be meant", quoted(&first), quoted(&second));
            Err([title, "name the sheet behind a #, as in \"consist.xlsx#Sheet1\"".into()])
        }
        _ => {
            let help =
                format!("its sheets are {all}; name the one that is meant behind a # to be told what is wrong with it");
            Err(["no sheet of the workbook holds such a table".into(), help])
        }
    }
}
