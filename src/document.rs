//! A train file in memory, with the files that it names: to change its keys, and to read it again without the disk.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use sha2::{Digest, Sha256};

use crate::consist::{self, Files};
use crate::error::InputError;
use crate::fleet::key::Key;
use crate::train::{Source, Train};

/// The text of a train file and of every file that has been read for it.
#[derive(Debug)]
pub struct Document {
    path: PathBuf,
    text: Arc<str>,
    files: Files,
}

impl Document {
    /// Reads a train file and what it names.
    ///
    /// # Errors
    /// As for [`consist::read`].
    pub fn read(path: &Path) -> Result<(Document, Train), InputError> {
        let files = Files::default();
        let text = files.main(path)?;
        Document { path: path.to_owned(), text, files }.with_train()
    }

    /// A train file of this text; `path` is its name in messages. Files that it names are read beside it, except those
    /// `given`, each with its path as seen from the train file.
    ///
    /// # Errors
    /// As for [`consist::parse`].
    pub fn of_text(text: &str, path: &Path, given: Vec<(Source, Arc<str>)>) -> Result<(Document, Train), InputError> {
        let own = Source { path: path.to_owned(), sha256: Sha256::digest(text).into() };
        let text: Arc<str> = text.into();
        let files = Files::holding(std::iter::once((own, text.clone())).chain(given));
        Document { path: path.to_owned(), text, files }.with_train()
    }

    fn with_train(self) -> Result<(Document, Train), InputError> {
        let train = consist::parse_with(&self.text, &self.path, &self.files)?;
        Ok((self, train))
    }

    /// What messages call it.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The train file's text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The other files that were read for it.
    pub fn other_files(&self) -> Vec<(Source, Arc<str>)> {
        self.files.contents().into_iter().filter(|(source, _)| source.path != self.path).collect()
    }

    /// The same with another value of a key, as `coupler.stiffness` or `vehicle[0].mass`, counted from 0.
    ///
    /// # Errors
    /// A sentence if no train file has such a key, or this one has no such table; else as for [`consist::parse`].
    pub fn replace(&self, key: &str, value: toml::Value) -> Result<(Document, Train), ReplaceError> {
        let known = Key::parse(key).map_err(|bad| ReplaceError::Key(format!("{}: {}", bad.title, bad.help)))?;
        let mut tree: toml::Table = self.text.parse().map_err(|e: toml::de::Error| ReplaceError::Key(e.to_string()))?;
        known.put(&mut tree, value).map_err(ReplaceError::Key)?;
        let text = toml::to_string(&tree).map_err(|e| ReplaceError::Key(e.to_string()))?;
        Ok(Document::of_text(&text, &self.path, self.other_files())?)
    }
}

/// Why a key cannot have that value.
#[derive(Debug, thiserror::Error)]
pub enum ReplaceError {
    /// There is no such key.
    #[error("{0}")]
    Key(String),
    /// The train is wrong with it.
    #[error(transparent)]
    Input(#[from] InputError),
}
