//! A commented train file from a table of vehicles or from a consist of Open Rails: for each number where it comes from, and what
//! is missing.

mod openrails;
mod write;

use std::path::{Path, PathBuf};

use super::{Files, columns, table};
use crate::error::InputError;
use crate::train::Doubt;

/// A train file made from something else.
#[derive(Clone, Debug)]
pub struct Imported {
    /// Its text.
    pub text: String,
    /// The keys that are missing in it, with what they are for; it cannot be analysed before they are filled in.
    pub missing: Vec<String>,
    /// What is probably not meant.
    pub doubts: Vec<Doubt>,
}

/// A value with the place where it comes from.
#[derive(Clone, Debug)]
pub(super) struct Given {
    /// The key, as `limits.proof`.
    pub(super) key: String,
    /// As TOML.
    pub(super) value: String,
    pub(super) from: String,
}

/// Vehicles alike that follow each other, and the coupler behind each.
pub(super) struct Group {
    pub(super) count: usize,
    pub(super) vehicle: Vec<Given>,
    pub(super) coupler: Vec<Given>,
    /// Needed keys that are missing, with the reasons.
    pub(super) missing: Vec<[String; 2]>,
}

/// What has been read, before it is written.
pub(super) struct Draft {
    pub(super) source: String,
    pub(super) name: String,
    pub(super) groups: Vec<Group>,
    /// What a reader of the file should know, as sentences.
    pub(super) remarks: Vec<String>,
    pub(super) doubts: Vec<Doubt>,
}

/// Makes a train file from a table of vehicles (CSV, or a sheet of a workbook) or from a consist of Open Rails (`.con`), whose
/// vehicles are looked for beside it and in `trainsets`.
///
/// # Errors
/// A file that cannot be read, and every problem in it, with its place.
pub fn import(path: &Path, trainsets: &[PathBuf]) -> Result<Imported, InputError> {
    let files = Files::default();
    let text = files.beside(path, columns::is_table).map_err(|[title, help]| InputError::of_file(path, title, help))?;
    let is_consist = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("con"));
    let draft = if is_consist { openrails::draft(&text, path, trainsets, &files)? } else { of_table(&text, path)? };
    let (text, missing) = write::write(&draft);
    Ok(Imported { text, missing, doubts: draft.doubts })
}

fn of_table(text: &str, path: &Path) -> Result<Draft, InputError> {
    let (rows, doubts) = table::listed(text, path)?;
    let name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let groups = rows.into_iter().map(|row| {
        let given = |of: Vec<table::ListedCell>| -> Vec<Given> {
            let from = |heading: String| format!("row {}, column {heading}", row.row);
            of.into_iter().map(|c| Given { key: c.key, value: c.value, from: from(c.heading) }).collect()
        };
        let (mut vehicle, coupler) = (given(row.vehicle), given(row.coupler));
        vehicle.retain(|given| given.key != "count");
        Group { count: row.count, vehicle, coupler, missing: vec![] }
    });
    let source = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    Ok(Draft { source, name, groups: groups.collect(), remarks: vec![], doubts })
}
