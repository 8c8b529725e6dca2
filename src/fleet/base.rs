//! The train file that variations start from: read once, whatever their number.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::consist::Files;
use crate::error::InputError;

/// A train file with the files that it names.
pub struct Base {
    /// Where it stands.
    pub path: PathBuf,
    /// Every file that was read for it so far; each is read once.
    pub files: Files,
    /// Its text.
    pub text: Result<Arc<str>, InputError>,
    /// The same as a tree; `None` if it is no TOML.
    pub tree: Option<toml::Table>,
}

impl Base {
    /// Reads a train file.
    pub fn read(path: &Path) -> Base {
        let files = Files::default();
        let text = files.main(path);
        Base::new(path, files, text)
    }

    /// A train file of this text.
    pub fn of_text(path: &Path, text: &str) -> Base {
        Base::new(path, Files::default(), Ok(text.into()))
    }

    fn new(path: &Path, files: Files, text: Result<Arc<str>, InputError>) -> Base {
        let tree = text.as_ref().ok().and_then(|text| text.parse().ok());
        Base { path: path.to_owned(), files, text, tree }
    }
}
