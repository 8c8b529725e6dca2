//! The files that a train is read from: each is opened once, its kind and size looked at before anything is read.

use std::fs::{self, File};
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use encoding_rs::{UTF_16BE, UTF_16LE, WINDOWS_1252};
use sha2::{Digest, Sha256};

use crate::error::{InputError, printable_path};
use crate::train::Source;

/// Larger train files and studies, and larger tables and records, are refused unread: the tree of a file takes up to
/// 75 times its memory, what is read of a table little more than its own.
const LARGEST: u64 = 8 << 20;
const LARGEST_TABLE: u64 = 16 << 20;

/// Names in a folder that are compared with a missing one.
const MOST_LISTED: usize = 10_000;

const GIVE_TRAIN: &str = "give the path of a train file; `trainsafe new` prints one to start from";

/// A text, or what is wrong with the file and what would be right.
type Text = Result<Arc<str>, [String; 2]>;

/// The files that one train is read from: the train file, its table of vehicles, its records.
///
/// Whatever reads a file for a train reads it here, so that this list is complete: a run is resumed only if none of them has changed.
/// A file that is asked for again is not read again.
#[derive(Debug, Default)]
pub struct Files {
    read: Mutex<Vec<(Source, Text)>>,
    /// The only folder from which a train file's tables and records are read, without symbolic links; `None`: any.
    folder: Option<PathBuf>,
}

impl Files {
    /// Reads tables and records in this folder and those below only; names and links that lead out of it are refused.
    ///
    /// # Errors
    /// A folder that is not there.
    pub fn within(folder: &Path) -> io::Result<Files> {
        Ok(Files { read: Mutex::default(), folder: Some(folder.canonicalize()?) })
    }

    /// Notes the bytes of a train file that were not read from the disk.
    #[cfg(feature = "serve")]
    pub(crate) fn given(&self, path: &Path, text: &str) {
        let source = Source { path: path.to_owned(), sha256: Sha256::digest(text).into() };
        self.lock().push((source, Ok(text.into())));
    }

    /// The text of a train file or study, which may come through a pipe.
    pub(crate) fn main(&self, path: &Path) -> Result<Arc<str>, InputError> {
        self.train_file(path, || bytes(path, "a train file", GIVE_TRAIN, LARGEST))
    }

    /// The text of a train file that comes through a stream.
    pub(super) fn stream(&self, input: &mut dyn io::Read, path: &Path) -> Result<Arc<str>, InputError> {
        self.train_file(path, || all_bytes(input, GIVE_TRAIN, LARGEST))
    }

    fn train_file(
        &self,
        path: &Path,
        bytes: impl FnOnce() -> Result<Vec<u8>, [String; 2]>,
    ) -> Result<Arc<str>, InputError> {
        let text = self.text(path, || {
            let bytes = bytes()?;
            if let Some((what, workbook)) = of_bytes(&bytes) {
                let sheet =
                    "save the sheet with the vehicles as CSV, and name it in a train file: vehicles = \"consist.csv\"";
                let help = if workbook { sheet } else { GIVE_TRAIN };
                return Err([format!("this is {what}, and no train file"), help.into()]);
            }
            read(bytes, utf8)
        });
        text.map_err(|[title, help]| InputError::of_file(path, title, help))
    }

    /// The text of a file that a train file names, or of a sheet of a workbook: `consist.xlsx#Sheet1`, or the only sheet
    /// with a table of the expected kind.
    /// Pipes and devices are refused: the train file may come from somebody else, and reading them may never end.
    pub(super) fn beside(&self, path: &Path, is_wanted: fn(&str) -> bool) -> Text {
        let give = "give the path of a CSV file";
        self.text(path, || {
            let (file, sheet) = sheet(path);
            let file = self.allowed(&file)?;
            let about = fs::metadata(&file).map_err(|e| unreadable(&e, &file, give))?;
            if !about.is_file() && !about.is_dir() {
                return Err(["this is a pipe or a device".into(), give.into()]);
            }
            let bytes = bytes(&file, "a CSV file", give, LARGEST_TABLE)?;
            match of_bytes(&bytes) {
                Some((what, true)) => {
                    let sha256 = Sha256::digest(&bytes).into();
                    Ok((workbook_text(what, &bytes, sheet.as_deref(), is_wanted)?.into(), sha256))
                }
                Some((what, false)) => Err([format!("this is {what}, and no CSV file"), give.into()]),
                None if sheet.is_some() => {
                    let title = "this is no workbook, so it has no sheets".to_owned();
                    Err([title, "leave out the # and what follows it".into()])
                }
                None => read(bytes, decoded),
            }
        })
    }

    /// The path of a table or record, if it may be read.
    fn allowed(&self, path: &Path) -> Result<PathBuf, [String; 2]> {
        let Some(folder) = &self.folder else { return Ok(path.to_owned()) };
        let real = path.canonicalize().ok().filter(|real| real.starts_with(folder));
        let help = "put the file beside the train file, and give its name";
        real.ok_or_else(|| ["there is no such file in the train's folder, and no other is read".into(), help.into()])
    }

    /// Files whose contents are given.
    pub fn holding(contents: impl IntoIterator<Item = (Source, Arc<str>)>) -> Files {
        let read = contents.into_iter().map(|(source, text)| (source, Ok(text)));
        Files { read: Mutex::new(read.collect()), folder: None }
    }

    /// Every file that has been read, with its text: of a table in another encoding as UTF-8, of a workbook that of the sheet.
    pub fn contents(&self) -> Vec<(Source, Arc<str>)> {
        let read = self.lock();
        read.iter().filter_map(|(source, text)| Some((source.clone(), text.clone().ok()?))).collect()
    }

    /// Every file that was asked for, in the order of first use.
    pub fn list(&self) -> Vec<Source> {
        self.lock().iter().map(|(source, _)| source.clone()).collect()
    }

    fn text(&self, path: &Path, read: impl FnOnce() -> Result<(Arc<str>, [u8; 32]), [String; 2]>) -> Text {
        if let Some((_, text)) = self.lock().iter().find(|(source, _)| source.path == path) {
            return text.clone();
        }
        let (text, sha256) = match read() {
            Ok((text, sha256)) => (Ok(text), sha256),
            Err(wrong) => (Err(wrong.clone()), Sha256::digest(wrong.concat()).into()),
        };
        self.lock().push((Source { path: path.to_owned(), sha256 }, text.clone()));
        text
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Vec<(Source, Text)>> {
        self.read.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A path without the name of a sheet, and that name; a file may have a # in its own name.
fn sheet(path: &Path) -> (PathBuf, Option<String>) {
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    match name.split_once('#') {
        Some((file, sheet)) if !path.exists() => (path.with_file_name(file), Some(sheet.to_owned())),
        _ => (path.to_owned(), None),
    }
}

/// The text of a workbook's sheet.
#[cfg(feature = "xlsx")]
fn workbook_text(
    what: &str,
    bytes: &[u8],
    sheet: Option<&str>,
    is_wanted: fn(&str) -> bool,
) -> Result<String, [String; 2]> {
    if what.contains("xls)") || what.contains("xlsb)") {
        let help = "save it as xlsx, or its sheet as CSV, and give the path of that file";
        return Err([format!("this is {what}, which is not read"), help.into()]);
    }
    super::workbook::text(bytes, sheet, is_wanted)
}

/// What to say of a workbook where none is read.
#[cfg(not(feature = "xlsx"))]
fn workbook_text(what: &str, _: &[u8], _: Option<&str>, _: fn(&str) -> bool) -> Result<String, [String; 2]> {
    let title = format!(
        "this is {what}, and no CSV file; this trainsafe was built without the feature xlsx, by which workbooks are read"
    );
    let build = if what.contains("xls)") || what.contains("xlsb)") { "" } else { "; or build with --features xlsx" };
    Err([title, format!("save its sheet as CSV, and give the path of that file{build}")])
}

fn bytes(path: &Path, kind: &str, give: &str, most: u64) -> Result<Vec<u8>, [String; 2]> {
    let mut file = File::open(path).map_err(|e| unreadable(&e, path, give))?;
    let about = file.metadata().map_err(|e| unreadable(&e, path, give))?;
    if about.is_dir() {
        return Err(["this is a folder".into(), format!("give the path of {kind} in it")]);
    }
    if about.len() > most {
        return Err(too_large(format!("{} MB", about.len() / 1_000_000), most));
    }
    all_bytes(&mut file, give, most)
}

/// What is left of a stream. A device or pipe has no size to look at beforehand, and a file can grow.
fn all_bytes(input: &mut dyn io::Read, give: &str, most: u64) -> Result<Vec<u8>, [String; 2]> {
    let mut bytes = Vec::new();
    input.take(most + 1).read_to_end(&mut bytes).map_err(|e| unreadable(&e, Path::new(""), give))?;
    if bytes.len() as u64 > most {
        return Err(too_large("no end in sight".to_owned(), most));
    }
    Ok(bytes)
}

fn too_large(size: String, most: u64) -> [String; 2] {
    let title = format!("the file has {size}, and at most {} MiB are read", most >> 20);
    [title, "shorten it: in a train file or table, `count` groups vehicles that are alike".into()]
}

/// A file's text and digest.
fn read(
    bytes: Vec<u8>,
    decode: fn(Vec<u8>) -> Result<String, [String; 2]>,
) -> Result<(Arc<str>, [u8; 32]), [String; 2]> {
    let sha256 = Sha256::digest(&bytes).into();
    decode(bytes).map(|text| (text.into(), sha256))
}

fn unreadable(error: &io::Error, path: &Path, give: &str) -> [String; 2] {
    match error.kind() {
        io::ErrorKind::NotFound => {
            let meant = meant(path, give == GIVE_TRAIN)
                .map_or(String::new(), |near| format!("did you mean {}? ", printable_path(&near)));
            ["there is no such file".to_owned(), meant + give]
        }
        _ => [format!("the file cannot be read: {error}"), give.to_owned()],
    }
}

/// The file beside a missing one that was probably meant: its name without or with another extension, or with a typing
/// error.
fn meant(missing: &Path, is_train: bool) -> Option<PathBuf> {
    let name = missing.file_name()?.to_str()?;
    let folder = missing.parent()?;
    let listed = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let files = fs::read_dir(listed).ok()?.flatten().take(MOST_LISTED).filter(|entry| entry.path().is_file());
    let lower = name.to_lowercase();
    let stem = Path::new(&lower).file_stem().and_then(|s| s.to_str()).unwrap_or(&lower).to_owned();
    let distance = |found: &str| {
        let found = found.to_lowercase();
        let same_stem = Path::new(&found).file_stem().is_some_and(|s| s == stem.as_str() || s == lower.as_str());
        if same_stem { 1 } else { strsim::damerau_levenshtein(&lower, &found) }
    };
    let names = files.filter_map(|entry| entry.file_name().into_string().ok()).filter(|found| found.len() < 100);
    let names = names.filter(|found| !is_train || found.ends_with(".toml"));
    let near = names.map(|found| (distance(&found), found)).min()?;
    (near.0 <= (lower.len() / 4).clamp(1, 3)).then(|| folder.join(near.1))
}

/// The text of a train file: TOML is UTF-8 only.
fn utf8(bytes: Vec<u8>) -> Result<String, [String; 2]> {
    let save = || "save it as UTF-8".to_owned();
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err(["the file is UTF-16, not UTF-8 text".into(), save()]);
    }
    String::from_utf8(bytes).map_err(|e| {
        let valid = &e.as_bytes()[..e.utf8_error().valid_up_to()];
        let line = 1 + valid.iter().filter(|&&b| b == b'\n').count();
        [format!("the file is not UTF-8 text: line {line} has a byte that is not allowed in UTF-8 text"), save()]
    })
}

/// The text of a table or record: UTF-8, UTF-16, or else Windows-1252, as spreadsheets and loggers write them.
fn decoded(bytes: Vec<u8>) -> Result<String, [String; 2]> {
    let utf16 = match bytes.as_slice() {
        [0xff, 0xfe, ..] => Some(UTF_16LE),
        [0xfe, 0xff, ..] => Some(UTF_16BE),
        // Without a byte order mark: a table starts with an ASCII character, of which one byte is zero.
        [first, 0, ..] if *first != 0 => Some(UTF_16LE),
        [0, second, ..] if *second != 0 => Some(UTF_16BE),
        _ => None,
    };
    let broken = |what: &str| [format!("the file is no text in {what}"), "save it as CSV in UTF-8".to_owned()];
    if let Some(encoding) = utf16 {
        let (text, _, wrong) = encoding.decode(&bytes);
        return if wrong { Err(broken(encoding.name())) } else { Ok(text.into_owned()) };
    }
    let bytes = match String::from_utf8(bytes) {
        Ok(text) => return Ok(text),
        Err(e) => e.into_bytes(),
    };
    // Bytes that Windows-1252 does not use, or uses for control characters, come from other encodings.
    let foreign = |b: &u8| matches!(b, 0x81 | 0x8d | 0x8f | 0x90 | 0x9d | 0..=8 | 14..=31);
    let line = |at: usize| 1 + bytes[..at].iter().filter(|&&b| b == b'\n').count();
    match bytes.iter().position(foreign) {
        Some(at) => {
            Err(broken(&format!("UTF-8, UTF-16 or Windows-1252: line {} has a byte that none of them has", line(at))))
        }
        None => Ok(WINDOWS_1252.decode(&bytes).0.into_owned()),
    }
}

/// What a binary file is, by its first bytes, and whether it is a workbook.
fn of_bytes(bytes: &[u8]) -> Option<(&'static str, bool)> {
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
