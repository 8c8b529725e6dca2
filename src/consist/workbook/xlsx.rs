//! Sheets of xlsx workbooks.

use std::io::Cursor;

use calamine::{Cell, DataRef, Reader as _, SheetType, SheetVisible, Style, Xlsx, XlsxError};

use super::{AS_CSV, CellContent, Named, Sheet, Wrong};

/// The sheets that are shown, in their order, with the texts of those that may be meant.
pub(super) fn sheets(bytes: &[u8], name: Option<&str>) -> Result<Vec<Named>, Wrong> {
    let damaged = |e: XlsxError| [format!("the workbook cannot be read: {e}"), AS_CSV.to_owned()];
    let mut workbook = Xlsx::new(Cursor::new(bytes)).map_err(damaged)?;
    let named = |sheet: &&calamine::Sheet| name == Some(&sheet.name);
    let of_cells = |sheet: &&calamine::Sheet| sheet.typ == SheetType::WorkSheet;
    let metadata = workbook.sheets_metadata().to_vec();
    let shown = metadata.iter().filter(of_cells).filter(|s| s.visible == SheetVisible::Visible || named(s));
    let mut sheets = vec![];
    for sheet in shown {
        let text = if name.is_none() || named(&sheet) { Some(text(&mut workbook, &sheet.name)?) } else { None };
        sheets.push((sheet.name.clone(), text));
    }
    Ok(sheets)
}

fn text(workbook: &mut Xlsx<Cursor<&[u8]>>, name: &str) -> Result<String, Wrong> {
    let damaged = |e: XlsxError| [format!("the workbook cannot be read: {e}"), AS_CSV.to_owned()];
    let mut cells = workbook.worksheet_cells_reader(name).map_err(damaged)?;
    let mut sheet = Sheet::default();
    while let Some((cell, style)) = cells.next_cell_with_style_id().map_err(damaged)? {
        let percent = cells.styles().get(style).is_some_and(shows_percent);
        if let Some(cell_content) = cell_content(&cell, percent) {
            let (row, column) = cell.get_position();
            sheet.add(row as usize, column as usize, &cell_content)?;
        }
    }
    Ok(sheet.text)
}

fn shows_percent(style: &Style) -> bool {
    let format = style.number_format.as_ref();
    format.is_some_and(|f| matches!(f.format_id, Some(9 | 10)) || unquoted_percent(&f.format_code))
}

/// Whether `%` stands outside quotes.
fn unquoted_percent(code: &str) -> bool {
    let outside = code.split('"').step_by(2);
    outside.flat_map(|part| part.match_indices('%').map(move |(at, _)| !part[..at].ends_with('\\'))).any(|plain| plain)
}

fn cell_content(cell: &Cell<DataRef>, percent: bool) -> Option<CellContent> {
    let number = |x: f64| if percent { CellContent::Percentage(x) } else { CellContent::Number(x) };
    Some(match cell.get_value() {
        DataRef::Empty => return None,
        DataRef::Int(i) => number(*i as f64),
        DataRef::Float(x) => number(*x),
        DataRef::String(text) => CellContent::Text(text.clone()),
        DataRef::SharedString(text) => CellContent::Text((*text).to_owned()),
        DataRef::Bool(flag) => CellContent::Text(flag.to_string()),
        DataRef::DateTime(_) | DataRef::DateTimeIso(_) => CellContent::Other("a date or time".to_owned()),
        DataRef::DurationIso(_) => CellContent::Other("a duration".to_owned()),
        DataRef::Error(error) => CellContent::Other(error.to_string()),
    })
}
