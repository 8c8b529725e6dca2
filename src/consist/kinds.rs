//! What a file is if it is not what was expected, for messages.

use toml::de::DeTable;

use super::columns::{is_gear, is_record, is_table};

/// Whether a text that has been parsed is a study rather than a train.
pub(crate) fn is_study(root: &DeTable) -> bool {
    ["trains", "vary"].iter().any(|key| root.contains_key(*key))
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
    if is_table(text) {
        return Some("a table of vehicles");
    }
    if is_gear(text) {
        return Some("a gear's table of force over travel");
    }
    if is_record(text) {
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
