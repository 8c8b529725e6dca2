//! Sheets of ods workbooks (OpenDocument), read here so that cells which are repeated a million times take no memory, and
//! percentages are told from other numbers.

use quick_xml::XmlVersion;
use quick_xml::events::{BytesStart, Event};
use quick_xml::reader::Reader;

use super::{AS_CSV, CellContent, MOST_COLUMNS, MOST_ROWS, Named, Sheet, Wrong};

/// All sheets, in their order, with the texts of those that may be meant.
pub(super) fn sheets(content: &str, name: Option<&str>) -> Result<Vec<Named>, Wrong> {
    let mut reader = Reader::from_str(content);
    let mut sheets = vec![];
    loop {
        match event(&mut reader)? {
            Event::Start(start) if start.name().as_ref() == "table:table" => {
                let own = attribute(&start, "table:name")?.unwrap_or_default();
                let text = table(&mut reader)?;
                let meant = name.is_none() || name == Some(&own);
                sheets.push((own, meant.then_some(text)));
            }
            Event::Empty(start) if start.name().as_ref() == "table:table" => {
                let own = attribute(&start, "table:name")?.unwrap_or_default();
                let meant = name.is_none() || name == Some(&own);
                sheets.push((own, meant.then(String::new)));
            }
            Event::Eof => return Ok(sheets),
            _ => {}
        }
    }
}

fn damaged(why: &dyn std::fmt::Display) -> Wrong {
    [format!("the workbook cannot be read: {why}"), AS_CSV.to_owned()]
}

fn event<'c>(reader: &mut Reader<&'c [u8]>) -> Result<Event<'c>, Wrong> {
    reader.read_event().map_err(|e| damaged(&e))
}

fn attribute(start: &BytesStart, name: &str) -> Result<Option<String>, Wrong> {
    let found = start.try_get_attribute(name).map_err(|e| damaged(&e))?;
    let text = found.map(|a| a.normalized_value(XmlVersion::Implicit1_0).map(std::borrow::Cow::into_owned)).transpose();
    text.map_err(|e| damaged(&e))
}

/// How often a row or cell is repeated.
fn repeats(start: &BytesStart, name: &str) -> Result<usize, Wrong> {
    let text = attribute(start, name)?;
    text.map_or(Ok(1), |text| text.parse().map_err(|_| damaged(&format!("{name} is {text}"))))
}

/// A table's cells up to its end; tables within cells are passed over with them.
fn table(reader: &mut Reader<&[u8]>) -> Result<String, Wrong> {
    let mut sheet = Sheet::default();
    let mut row = 0usize;
    loop {
        match event(reader)? {
            Event::Start(start) if start.name().as_ref() == "table:table-row" => {
                let times = repeats(&start, "table:number-rows-repeated")?;
                let cells = cells(reader)?;
                let last = if cells.is_empty() { 0 } else { times };
                for at in row..row.saturating_add(last).min(MOST_ROWS + 1) {
                    for (from, count, cell_content) in &cells {
                        for column in *from..from.saturating_add(*count).min(MOST_COLUMNS + 1) {
                            sheet.add(at, column, cell_content)?;
                        }
                    }
                }
                row = row.saturating_add(times);
            }
            Event::Empty(start) if start.name().as_ref() == "table:table-row" => {
                row = row.saturating_add(repeats(&start, "table:number-rows-repeated")?);
            }
            Event::End(end) if end.name().as_ref() == "table:table" => return Ok(sheet.text),
            Event::Eof => return Err(damaged(&"it ends within a table")),
            _ => {}
        }
    }
}

/// The filled cells of a row: first column, repeats and content.
fn cells(reader: &mut Reader<&[u8]>) -> Result<Vec<(usize, usize, CellContent)>, Wrong> {
    let is_cell =
        |start: &BytesStart| ["table:table-cell", "table:covered-table-cell"].contains(&start.name().as_ref());
    let mut cells = vec![];
    let mut column = 0usize;
    loop {
        let (start, text) = match event(reader)? {
            Event::Start(start) if is_cell(&start) => {
                let text = text(reader, &start)?;
                (start, text)
            }
            Event::Empty(start) if is_cell(&start) => (start, String::new()),
            Event::End(end) if end.name().as_ref() == "table:table-row" => return Ok(cells),
            Event::Eof => return Err(damaged(&"it ends within a row")),
            _ => continue,
        };
        let times = repeats(&start, "table:number-columns-repeated")?;
        if let Some(cell_content) = cell_content(&start, text)? {
            cells.push((column, times, cell_content));
        }
        column = column.saturating_add(times);
    }
}

fn cell_content(start: &BytesStart, text: String) -> Result<Option<CellContent>, Wrong> {
    let number = || -> Result<f64, Wrong> {
        let value = attribute(start, "office:value")?.unwrap_or_default();
        value.parse().map_err(|_| damaged(&format!("a number is {value}")))
    };
    Ok(match attribute(start, "office:value-type")?.as_deref() {
        None if text.is_empty() => None,
        None | Some("string") => {
            let own = attribute(start, "office:string-value")?;
            Some(CellContent::Text(own.unwrap_or(text)))
                .filter(|cell_content| !matches!(cell_content, CellContent::Text(t) if t.is_empty()))
        }
        Some("float" | "currency") => Some(CellContent::Number(number()?)),
        Some("percentage") => Some(CellContent::Percentage(number()?)),
        Some("boolean") => Some(CellContent::Text(attribute(start, "office:boolean-value")?.unwrap_or(text))),
        Some("date") => Some(CellContent::Other("a date or time".to_owned())),
        Some("time") => Some(CellContent::Other("a duration".to_owned())),
        Some(other) => Some(CellContent::Other(other.to_owned())),
    })
}

/// The text within a cell, without that of notes on it.
fn text(reader: &mut Reader<&[u8]>, cell: &BytesStart) -> Result<String, Wrong> {
    let end = cell.name().as_ref().to_owned();
    let (mut text, mut notes, mut within) = (String::new(), 0, 0);
    loop {
        match event(reader)? {
            Event::Start(start) => {
                notes += usize::from(start.name().as_ref() == "office:annotation");
                within += usize::from(start.name().as_ref() == end);
                let paragraph = notes == 0 && start.name().as_ref() == "text:p" && !text.is_empty();
                text += if paragraph { " " } else { "" };
            }
            Event::Empty(start) if notes == 0 && start.name().as_ref() == "text:s" => text.push(' '),
            Event::Text(part) if notes == 0 => {
                text += &quick_xml::escape::unescape(&part).map_err(|e| damaged(&e))?;
            }
            Event::GeneralRef(name) if notes == 0 => {
                let whole = format!("&{};", &*name);
                text += &quick_xml::escape::unescape(&whole).map_err(|e| damaged(&e))?;
            }
            Event::CData(part) if notes == 0 => text += &part,
            Event::End(of) if of.name().as_ref() == "office:annotation" => notes = notes.saturating_sub(1),
            Event::End(of) if of.name().as_ref() == end && within == 0 => return Ok(text.trim().to_owned()),
            Event::End(of) if of.name().as_ref() == end => within -= 1,
            Event::Eof => return Err(damaged(&"it ends within a cell")),
            _ => {}
        }
    }
}
