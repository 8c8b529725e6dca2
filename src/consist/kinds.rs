//! What a file is if it is not what was expected, for messages.

use toml::de::DeTable;

use super::{gears, record, table};

/// Whether a text that has been parsed is a study rather than a train.
pub(crate) fn is_study(root: &DeTable) -> bool {
    ["trains", "vary"].iter().any(|key| root.contains_key(*key))
}

/// What a binary file is, by its first bytes, and whether it is a workbook.
pub(super) fn of_bytes(bytes: &[u8]) -> Option<(&'static str, bool)> {
    let holds = |part: &[u8]| bytes.windows(part.len()).take(1 << 20).any(|window| window == part);
    let starts: [(&[u8], &str, bool); 7] = [
        (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "an old Excel workbook (xls) or another Office file", true),
        (b"%PDF", "a PDF", false),
        (b"\x89PNG", "a picture", false),
        (b"\xff\xd8\xff", "a picture", false),
        (b"\x1f\x8b", "a compressed file (gzip)", false),
        (b"PAR1", "a Parquet file", false),
        (b"7z\xbc\xaf", "a compressed file (7z)", false),
    ];
    if bytes.starts_with(b"PK\x03\x04") {
        return Some(if holds(b"opendocument.spreadsheet") {
            ("a LibreOffice workbook (ods)", true)
        } else if holds(b"xl/workbook.bin") {
            ("a binary Excel workbook (xlsb)", true)
        } else if holds(b"xl/") {
            ("an Excel workbook (xlsx)", true)
        } else {
            ("a compressed file (zip)", false)
        });
    }
    starts.into_iter().find(|(start, ..)| bytes.starts_with(start)).map(|(_, what, workbook)| (what, workbook))
}

/// What a text is, if it is one of the kinds that are easily taken for another.
pub(super) fn of_text(text: &str) -> Option<&'static str> {
    let start = text.trim_start_matches('\u{feff}').trim_start();
    if start.starts_with('{') {
        let json: serde_json::Value = serde_json::from_str(start).ok()?;
        let result = json.get("scenarios").is_some() && json.get("couplers").is_some();
        return Some(if result { "the result of an analysis (result.json)" } else { "JSON" });
    }
    if start.starts_with("<!") || start.starts_with("<html") || start.starts_with("<?xml") {
        return Some("a web page or XML");
    }
    if let Ok(root) = DeTable::parse(text).map(toml::Spanned::into_inner) {
        let train = ["coupler", "vehicle", "scenario"].iter().any(|key| root.contains_key(*key));
        return match (is_study(&root), train) {
            (true, _) => Some("a study"),
            (_, true) => Some("a train file"),
            _ => None,
        };
    }
    if table::is_table(text) {
        return Some("a table of vehicles");
    }
    if gears::is_gear(text) {
        return Some("a gear's table of force over travel");
    }
    if record::is_record(text) {
        return Some("a record of force over time");
    }
    let blanks = text.lines().take(100).filter(|line| is_row_of_numbers(line)).count() > 1;
    blanks.then_some("a table with blanks between its cells, where commas, semicolons or tabs are needed")
}

/// Whether a line is several numbers with nothing but blanks between them.
fn is_row_of_numbers(line: &str) -> bool {
    let mut words = line.split(' ').filter(|word| !word.is_empty());
    let number = |word: &str| word.trim_end().parse::<f64>().is_ok();
    words.next().is_some_and(number) && words.clone().next().is_some() && words.all(number)
}
