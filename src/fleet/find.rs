//! The train files of a path: itself, those in a folder and below, those that a glob matches.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

use super::FleetError;
use super::study::is_study;
use crate::consist::Files;
use crate::consist::tree::BACKSLASH;
use crate::error::printable_path;

/// Train files, each once, and what was passed over, as sentences.
#[derive(Default)]
pub struct Found {
    /// In the order in which they are run.
    pub files: Vec<PathBuf>,
    /// Studies that stand among them.
    pub notes: Vec<String>,
    seen: HashSet<PathBuf>,
}

impl Found {
    /// Adds the train files that a path stands for, in the order of their names; `study` is the file that names the path.
    ///
    /// # Errors
    /// A path that stands for none.
    pub fn add(&mut self, path: &Path, study: Option<&Path>) -> Result<(), FleetError> {
        let none = |why: &str| Err(FleetError::Usage(format!("{} {why}", printable_path(path))));
        if path.is_dir() {
            let mut files = Vec::new();
            in_folder(path, &mut files)?;
            return match self.trains(files, study) {
                0 => none(&format!("has no train file (*.toml) in it or below{}", self.hint())),
                _ => Ok(()),
            };
        }
        if path.exists() {
            if study.is_some() && is_study_file(path) {
                return none("is a study, which names its own trains: name train files");
            }
            self.push(path.to_owned());
            return Ok(());
        }
        let text = path.to_string_lossy();
        if !text.contains(['*', '?', '[']) {
            let written_on_windows = if text.contains('\\') { format!("; {BACKSLASH}") } else { String::new() };
            return none(&format!("does not exist{written_on_windows}"));
        }
        let matches = glob::glob(&text).map_err(|e| FleetError::Usage(format!("{text} is no glob: {}", e.msg)))?;
        let matches: Vec<PathBuf> = matches.flatten().filter(|found| found.is_file()).collect();
        if matches.is_empty() {
            return none("matches no file");
        }
        match self.trains(matches, study) {
            0 => none(&format!("matches no train file{}", self.hint())),
            _ => Ok(()),
        }
    }

    /// Adds all but studies; how many it added.
    fn trains(&mut self, files: Vec<PathBuf>, study: Option<&Path>) -> usize {
        let mut count = 0;
        for file in files {
            if !is_study_file(&file) {
                self.push(file);
                count += 1;
            } else if study.is_none_or(|own| !same(own, &file)) {
                let shown = printable_path(&file);
                let note = format!(
                    "{shown} is a study and no train, so it is left out: to run it, type trainsafe fleet {shown}"
                );
                if !self.notes.contains(&note) {
                    self.notes.push(note);
                }
            }
        }
        count
    }

    fn push(&mut self, file: PathBuf) {
        if self.seen.insert(file.clone()) {
            self.files.push(file);
        }
    }

    fn hint(&self) -> String {
        self.notes.first().map_or(String::new(), |note| format!("; {note}"))
    }
}

/// Whether paths that are no globs exist: a wrong one is reported before anything is written.
///
/// # Errors
/// The first that is not.
pub fn exist(paths: &[PathBuf]) -> Result<(), FleetError> {
    let is_glob = |path: &Path| path.to_string_lossy().contains(['*', '?', '[']);
    match paths.iter().find(|path| !path.exists() && !is_glob(path)) {
        Some(gone) => Err(FleetError::Usage(format!("{} does not exist", printable_path(gone)))),
        None => Ok(()),
    }
}

/// Whether two paths lead to the same file.
fn same(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

/// Whether a file is a study. One that cannot be read counts as a train.
pub fn is_study_file(path: &Path) -> bool {
    // Most trains have neither word, and need not be parsed twice. A pipe can be read once only.
    let may_be = |text: &str| text.contains("trains") || text.contains("vary");
    path.is_file() && Files::default().main(path).is_ok_and(|text| may_be(&text) && is_study(&text))
}

fn in_folder(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), FleetError> {
    let unreadable = |e| FleetError::Usage(format!("the folder {} cannot be read: {e}", printable_path(folder)));
    let mut entries = fs::read_dir(folder).map_err(unreadable)?.flatten().map(|e| e.path()).collect::<Vec<_>>();
    entries.sort();
    for entry in entries {
        // A link to a folder above would never end.
        if entry.is_dir() && !entry.is_symlink() {
            in_folder(&entry, files)?;
        } else if entry.extension().is_some_and(|e| e == "toml") && entry.is_file() {
            files.push(entry);
        }
    }
    Ok(())
}
