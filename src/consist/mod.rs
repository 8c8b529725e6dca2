//! Files that describe trains: the train file (TOML), tables of vehicles (CSV, workbooks), gears and records; all of them end in
//! [`TrainSpec::build`](crate::train::TrainSpec::build).

mod brakes;
mod columns;
mod couplers;
mod describe;
mod describe_laws;
mod file;
mod gears;
mod heading;
mod import;
pub(crate) mod keys;
mod kinds;
mod labels;
mod laws;
mod loads;
mod numbers;
mod record;
mod scenarios;
mod sheet;
mod sums;
mod table;
mod text;
pub(crate) mod tree;
mod vehicles;
#[cfg(feature = "xlsx")]
mod workbook;

use std::path::Path;

use toml::de::DeTable;

use crate::error::{InputError, Problem};
use crate::train::{Origin, Train};

pub(crate) use brakes::application_table;
pub use describe::describe;
pub(crate) use describe::of_parts;
pub(crate) use describe_laws::{application, laws, place, response_sentences as response};
pub use import::{Imported, import};
pub(crate) use kinds::is_study;
pub use numbers::{cell_of_number, cell_of_text};
pub use text::Files;

/// A commented train file to start from, with every key explained; it runs as it is.
pub const TEMPLATE: &str = include_str!("template.toml");

/// Reads a train file.
///
/// # Errors
/// A file that cannot be read, is no text or is over 8 MiB, and all that [`parse`] refuses.
pub fn read(path: &Path) -> Result<Train, InputError> {
    let files = Files::default();
    parse_with(&files.main(path)?, path, &files)
}

/// What messages call a train that comes from standard input; files that it names stand in the current folder.
pub const STDIN: &str = "<stdin>";

/// Reads a train file's text from a stream, such as standard input; `path` is what messages call it, and files that it names
/// stand beside it.
///
/// # Errors
/// As for [`read`].
pub fn read_from(input: &mut dyn std::io::Read, path: &Path) -> Result<Train, InputError> {
    let files = Files::default();
    parse_with(&files.stream(input, path)?, path, &files)
}

/// Reads the text of a train file; `path` is what messages call it.
///
/// # Errors
/// Every problem in the text that can be seen at once, with its place and what would be right.
///
/// ```
/// use std::path::Path;
/// let text = r#"
///     [coupler]
///     stiffness = "30 MN/m"
///     rated_load = "1.5 MN"
///     [[vehicle]]
///     count = 3
///     mass = "160 t"
///     [load]
///     uniform = "40 %"
/// "#;
/// let train = trainsafe::consist::parse(text, Path::new("three.toml"))?;
/// assert_eq!(train.couplers()[0].stiffness_n_per_m, 30e6);
/// assert_eq!(train.initial_force_n(), [0.6e6, 0.6e6]);
///
/// let wrong = trainsafe::consist::parse(&text.replace("MN/m", "MN"), Path::new("three.toml")).unwrap_err();
/// assert!(wrong.to_string().contains("stiffness has \"MN\", a unit of force"));
/// # Ok::<(), trainsafe::error::InputError>(())
/// ```
pub fn parse(text: &str, path: &Path) -> Result<Train, InputError> {
    parse_with(text, path, &Files::default())
}

/// The same with the files that the train file names taken from `files`, and noted there.
///
/// # Errors
/// As for [`parse`].
pub(crate) fn parse_with(text: &str, path: &Path, files: &Files) -> Result<Train, InputError> {
    if text.trim().is_empty() {
        let help = "`trainsafe new` prints one to start from";
        return Err(InputError::of_file(path, "the train file is empty", help));
    }
    let parsed = DeTable::parse(text).map_err(|e| not_train(text, path).unwrap_or_else(|| not_toml(e, text, path)))?;
    if is_study(parsed.get_ref()) {
        return Err(not_train(text, path).unwrap_or_else(|| InputError::of_file(path, "this is a study", "")));
    }
    read_tree(parsed.get_ref(), text, path, files, None)
}

/// Gives a function a tree with a `[coupler]` for each of so many couplers.
pub(crate) type EachCoupler<'a> = &'a dyn Fn(usize, &mut dyn FnMut(&DeTable));

/// Reads the tree of a train file, whose places are those of the text. `each` replaces the file's `[coupler]` by one
/// for each coupler; a table of vehicles and `[[coupler_override]]` override these as they do the common one.
///
/// # Errors
/// As for [`parse`].
pub(crate) fn read_tree(
    tree: &DeTable,
    text: &str,
    path: &Path,
    files: &Files,
    each: Option<EachCoupler>,
) -> Result<Train, InputError> {
    let found = tree::Found::default();
    let root = tree::Table::root(&found, tree, &keys::TRAIN);
    let named = root.get("vehicles").filter(|value| value.as_text().is_some());
    let rows = match named.map(|value| value.text_beside(path, files, columns::is_table)) {
        Some(Ok((beside, text))) => Ok(Some(table::parse(&text, &beside, path, files)?)),
        Some(Err(reported)) => Err(reported),
        None => Ok(None),
    };
    let train = rows.and_then(|rows| file::train(&found, &root, rows, each, path, files));
    let (problems, doubts) = found.into_parts();
    match train {
        Ok(train) if problems.is_empty() => {
            let doubts = [doubts, train.origin().doubts.clone()].concat();
            let origin = Origin { sources: files.list(), doubts, text: text.into(), ..train.origin().clone() };
            Ok(train.with_origin(origin))
        }
        _ => Err(InputError::new(path, text, problems).with_keys(tree)),
    }
}

/// The message for a text that is known to be another kind of file.
fn not_train(text: &str, path: &Path) -> Option<InputError> {
    let what = kinds::of_text(text).filter(|what| *what != "a train file")?;
    let shown = crate::error::printable_path(path);
    let shown = if shown.contains(' ') { format!("\"{shown}\"") } else { shown };
    let file = path.file_name().map_or_else(|| shown.clone(), |name| name.to_string_lossy().into_owned());
    let help = match what {
        "a study" => {
            format!("type `trainsafe fleet {shown}`; a [[vary]] table has its place in a study, and no other file")
        }
        "a table of vehicles" => format!("name it in a train file: vehicles = \"{file}\"; `trainsafe new` prints one"),
        "a gear's table of force over travel" => {
            format!("name it in the [coupler] table of a train file: gear = \"{file}\"")
        }
        "a record of force over time" => format!("name it in a pulse of a train file: record = \"{file}\""),
        _ => "give the path of a train file; `trainsafe new` prints one to start from".to_owned(),
    };
    Some(InputError::of_file(path, format!("this is {what}, and no train file"), help))
}

/// A text that TOML's grammar refuses.
pub(crate) fn not_toml(error: toml::de::Error, text: &str, path: &Path) -> InputError {
    let at = error.span().unwrap_or(0..0);
    let title = format!("not TOML: {}", error.message());
    let help = escaped(text, at.start).or_else(|| unquoted(text, at.start));
    InputError::one(path, text, Problem::at(at, title, help))
}

/// Help for a backslash in double quotes that starts no escape, as in a path of Windows.
fn escaped(text: &str, at: usize) -> Option<String> {
    let before = text.get(..at)?;
    let line_start = before.rfind(['\n', '\r']).map_or(0, |i| i + 1);
    let line = text.get(line_start..)?.lines().next()?;
    let quote = line.find('"')?;
    let slash = quote + line[quote..].find('\\')?;
    (line_start + slash <= at + 1).then(|| tree::BACKSLASH.to_owned())
}

/// Help for the commonest error, a quantity without quotes.
fn unquoted(text: &str, at: usize) -> Option<String> {
    let before = text.get(..at)?;
    let line = text.get(before.rfind('\n').map_or(0, |i| i + 1)..)?.lines().next()?;
    let (key, value) = line.split_once('=')?;
    let value = value.split('#').next()?.trim();
    let number_first = value.trim_start_matches(['+', '-', '.']).starts_with(|c: char| c.is_ascii_digit());
    let short = value.chars().count() < 40 && !value.contains('"');
    let plain = key.trim().bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
    (number_first && short && plain).then(|| format!("a quantity is a string: write {} = \"{value}\"", key.trim()))
}
