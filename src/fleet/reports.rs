//! Full reports of the worst trains of a fleet, in `trains/` beside its own.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use super::inputs::Inputs;
use super::summary::Summary;
use super::{FleetError, Request};
use crate::findings;
use crate::report;

const FOLDER: &str = "trains";

/// Reports that were written, and those that could not be.
#[derive(Debug, Default)]
pub struct Reports {
    /// Links to them, from the fleet's own folder, by the trains' files.
    pub links: HashMap<String, String>,
    /// Why others are missing, as sentences.
    pub missing: Vec<String>,
}

/// Analyses the worst trains anew and writes their reports; of a train that a study varies, the worst variation.
///
/// # Errors
/// A train file that has changed, a report that cannot be written.
pub fn write(
    dir: &Path,
    inputs: &Inputs,
    request: &Request,
    summary: &Summary,
    most: usize,
) -> Result<Reports, FleetError> {
    let mut reports = Reports::default();
    let mut taken = HashSet::new();
    let files: HashMap<String, usize> =
        inputs.files.iter().enumerate().map(|(i, file)| (super::inputs::file_cell(file), i)).collect();
    for worst in summary.worst_first().into_iter().take(most) {
        let Some(&file) = files.get(&worst.file) else { continue };
        let variation = worst.worst[0].variation.parse::<usize>().ok();
        let varied = inputs.load(file, variation.map_or(0, |v| v - 1))?;
        // It was valid in the run.
        let Ok(train) = varied.train else { continue };
        // A table that was read can be written.
        let text = varied.tree.and_then(|tree| toml::to_string(&tree).ok());
        let train = match text {
            Some(text) => train.with_text(&text),
            None => train,
        };
        let train = match request.units {
            Some(units) => train.with_units(units),
            None => train,
        };
        let analysis = match findings::analyze(&train, &request.options) {
            Ok(analysis) => analysis,
            Err(e) => {
                reports.missing.push(format!("no report of {}: {e}", worst.file));
                continue;
            }
        };
        let name = folder(&inputs.files[file], variation, &mut taken);
        let written = report::write(&train, &analysis, &dir.join(FOLDER).join(&name), &report::Format::ALL)?;
        let page = written.iter().find(|path| path.ends_with("report.html")).or(written.last());
        if let Some(page) = page.and_then(|path| path.file_name()) {
            reports.links.insert(worst.file.clone(), format!("{FOLDER}/{name}/{}", page.to_string_lossy()));
        }
    }
    Ok(reports)
}

/// A unique name for the folder of a train file, in letters that a link can have as they are.
fn folder(file: &Path, variation: Option<usize>, taken: &mut HashSet<String>) -> String {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let plain = |c: char| if c.is_ascii_alphanumeric() || "-_".contains(c) { c } else { '_' };
    let mut name: String = stem.chars().take(100).map(plain).collect();
    if let Some(variation) = variation {
        name += &format!("-variation-{variation}");
    }
    let first = name.clone();
    let mut number = 1;
    while !taken.insert(name.to_ascii_lowercase()) {
        number += 1;
        name = format!("{first}-{number}");
    }
    name
}

#[cfg(test)]
mod tests;
