//! The text of a file, with its kind and size looked at before anything is read. Each file is opened once.

use std::fs::{self, File};
use std::io::{self, Read as _};
use std::path::Path;

use crate::error::InputError;

/// Larger train files and studies are refused unread, and larger tables and records: their trees take up to 75 times the memory, and
/// what is read of a table little more than the table.
const LARGEST: u64 = 8 << 20;
const LARGEST_TABLE: u64 = 16 << 20;

/// The text of a train file or study, which may come through a pipe.
pub(crate) fn text_of(path: &Path) -> Result<String, InputError> {
    let give = "give the path of a train file; `trainsafe new` prints one to start from";
    text(path, "a train file", give, LARGEST).map_err(|[title, help]| InputError::of_file(path, title, help))
}

/// The text of a table that a train file names.
pub(crate) fn table_text(path: &Path) -> Result<String, InputError> {
    beside(path).map_err(|[title, help]| InputError::of_file(path, title, help))
}

/// The text of a file that a train file names; what is wrong, and what would be right. A pipe could wait for ever, and a device
/// has no end: whoever wrote the train file need not be the one who reads it.
pub(super) fn beside(path: &Path) -> Result<String, [String; 2]> {
    let give = "give the path of a CSV file";
    let about = fs::metadata(path).map_err(|e| unreadable(&e, give))?;
    if about.is_file() || about.is_dir() {
        return text(path, "a CSV file", give, LARGEST_TABLE);
    }
    Err(["this is a pipe or a device".into(), give.into()])
}

fn text(path: &Path, kind: &str, give: &str, most: u64) -> Result<String, [String; 2]> {
    let mut file = File::open(path).map_err(|e| unreadable(&e, give))?;
    let about = file.metadata().map_err(|e| unreadable(&e, give))?;
    if about.is_dir() {
        return Err(["this is a folder".into(), format!("give the path of {kind} in it")]);
    }
    let too_large = |size: String| {
        let title = format!("the file has {size}, and at most {} MiB are read", most >> 20);
        [title, "shorten it: in a train file or table, `count` groups vehicles that are alike".into()]
    };
    if about.len() > most {
        return Err(too_large(format!("{} MB", about.len() / 1_000_000)));
    }
    let mut bytes = Vec::new();
    // A device or pipe has no size to look at beforehand, and a file can grow.
    file.by_ref().take(most + 1).read_to_end(&mut bytes).map_err(|e| unreadable(&e, give))?;
    if bytes.len() as u64 > most {
        return Err(too_large("no end in sight".to_owned()));
    }
    decoded(bytes)
}

fn unreadable(error: &io::Error, give: &str) -> [String; 2] {
    let title = match error.kind() {
        io::ErrorKind::NotFound => "there is no such file".to_owned(),
        _ => format!("the file cannot be read: {error}"),
    };
    [title, give.to_owned()]
}

fn decoded(bytes: Vec<u8>) -> Result<String, [String; 2]> {
    let save = || "save it as UTF-8".to_owned();
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err(["the file is UTF-16, not UTF-8 text".into(), save()]);
    }
    String::from_utf8(bytes).map_err(|e| {
        let valid = &e.as_bytes()[..e.utf8_error().valid_up_to()];
        let line = 1 + valid.iter().filter(|&&b| b == b'\n').count();
        [format!("the file is not UTF-8 text: line {line} has a byte that no text has"), save()]
    })
}
