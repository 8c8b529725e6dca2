//! What a fleet run is given: paths into train files and, where there is one, a study; and a fingerprint of it all.

use std::fs;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use sha2::{Digest, Sha256};

use super::FleetError;
use super::study::{self, Study};
use super::variation::{self, Varied};
use crate::consist::{self, Files, Train};
use crate::error::{InputError, printable_path};
use crate::findings::{Options, cases};

/// Keys that never change how many cases a train has: all others can, for a coupler that carries buff is none of "each".
const NOT_COUNTING: [&str; 10] = [
    "rated_load",
    "rated_buff",
    "fatigue",
    "proof",
    "ultimate",
    "damping",
    "damping_ratio",
    "horizon",
    "length",
    "speed",
];

/// The train files and the study, as they were found at the start.
pub struct Inputs {
    /// Train files, in the order in which they are run.
    pub files: Vec<PathBuf>,
    /// What is varied.
    pub study: Option<Study>,
    /// Content of each file and of the table that it refers to.
    digests: Vec<[u8; 32]>,
    /// Text of the study file.
    study_text: String,
}

impl Inputs {
    /// Finds the train files, or reads the study file and finds its trains.
    ///
    /// # Errors
    /// A study file that is wrong, a path that does not exist, a folder or a glob without a train file.
    pub fn find(paths: &[PathBuf]) -> Result<Inputs, FleetError> {
        let (mut study, mut study_text) = (None, String::new());
        let mut wanted = paths.to_vec();
        for path in paths.iter().filter(|p| p.is_file()) {
            // What cannot be read is a bad train, and told as such later.
            let Ok(text) = Files::default().main(path) else { continue };
            if study::is_study(&text) {
                if paths.len() > 1 {
                    let title = format!("{} is a study, which names its own trains", printable_path(path));
                    return Err(FleetError::Usage(format!("{title}: give it alone")));
                }
                let read = study::parse(&text, path)?;
                let folder = path.parent().unwrap_or(Path::new(""));
                wanted = read.trains.iter().map(|t| folder.join(t)).collect();
                (study, study_text) = (Some(read), text.to_string());
            }
        }
        let mut files = Vec::new();
        for path in &wanted {
            expand(path, &mut files)?;
        }
        let mut seen = std::collections::HashSet::new();
        files.retain(|file| seen.insert(file.clone()));
        let digests = files.par_iter().map(|file| digest(&base(file).0)).collect();
        let inputs = Inputs { files, study, digests, study_text };
        inputs.check_effects()?;
        Ok(inputs)
    }

    /// Refuses a study with an input that changes nothing in any of its trains.
    fn check_effects(&self) -> Result<(), FleetError> {
        let Some(study) = &self.study else { return Ok(()) };
        let effect = |k: usize, path: &PathBuf| {
            let files = Files::default();
            let text = files.main(path).ok()?;
            variation::has_effect(study, k, &text, path, &files)
        };
        for (k, input) in study.inputs.iter().enumerate() {
            let effects: Vec<bool> = self.files.par_iter().filter_map(|path| effect(k, path)).collect();
            if !effects.is_empty() && !effects.contains(&true) {
                let why = match input.key.table {
                    Some("coupler") => {
                        "reaches no coupler: all have a value of their own, from the table of vehicles or from [[coupler_override]]"
                    }
                    Some("vehicle") => "reaches no vehicle",
                    _ => "changes nothing in any train of the study",
                };
                return Err(FleetError::Usage(format!(
                    "the varied key {} {why}; leave it out of the study",
                    input.key
                )));
            }
        }
        Ok(())
    }

    /// Variations of each train.
    pub fn variations(&self) -> usize {
        self.study.as_ref().map_or(1, Study::variations)
    }

    /// A fingerprint of everything that the results depend on, in hexadecimal.
    pub fn fingerprint(&self, options: &Options) -> String {
        let mut all = Sha256::new();
        let mut add = |bytes: &[u8]| {
            all.update((bytes.len() as u64).to_le_bytes());
            all.update(bytes);
        };
        add(env!("CARGO_PKG_VERSION").as_bytes());
        add(&options.tolerance.to_le_bytes());
        add(options.method.map_or("", |m| m.name()).as_bytes());
        add(self.study_text.as_bytes());
        for (file, digest) in self.files.iter().zip(&self.digests) {
            add(file.as_os_str().as_encoded_bytes());
            add(digest);
        }
        all.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
    }

    /// A train file's variation, both counted from 0.
    ///
    /// # Errors
    /// [`FleetError::Changed`] if the file is no longer what it was at the start.
    pub fn load(&self, file: usize, variation: usize) -> Result<Varied, FleetError> {
        let path = &self.files[file];
        let (files, train) = base(path);
        if digest(&files) != self.digests[file] {
            return Err(FleetError::Changed(path.clone()));
        }
        let varied = match (&self.study, files.main(path)) {
            (Some(study), Ok(text)) => variation::vary(study, variation, &text, path, &files),
            (None, Ok(_)) => Varied { cells: vec![], train: train.map_err(|e| e.brief()) },
            (study, Err(e)) => {
                let inputs = study.as_ref().map_or(0, |s| s.inputs.len());
                Varied { cells: vec![String::new(); inputs], train: Err(e.brief()) }
            }
        };
        Ok(varied)
    }

    /// How many cases each variation of each train has, in order; a train that cannot be read has one.
    ///
    /// # Errors
    /// As for [`Inputs::load`].
    pub fn case_counts(&self) -> Result<Vec<u32>, FleetError> {
        let variations = self.variations();
        let fixed = self.study.as_ref().is_none_or(|s| s.inputs.iter().all(|i| NOT_COUNTING.contains(&i.key.leaf)));
        let one = |file: usize, variation: usize| {
            let varied = self.load(file, variation)?;
            Ok(varied.train.map_or(1, |train| case_count(&train)))
        };
        if fixed {
            // Those of the first variation that makes a train: the file may be incomplete without its inputs.
            let counts = (0..self.files.len()).into_par_iter().map(|file| {
                for variation in 0..variations {
                    if let Ok(train) = self.load(file, variation)?.train {
                        return Ok(case_count(&train));
                    }
                }
                Ok(1)
            });
            let counts: Vec<u32> = counts.collect::<Result<_, FleetError>>()?;
            return Ok(counts.into_iter().flat_map(|count| std::iter::repeat_n(count, variations)).collect());
        }
        let units = self.files.len() * variations;
        (0..units).into_par_iter().map(|unit| one(unit / variations, unit % variations)).collect()
    }
}

fn case_count(train: &Train) -> u32 {
    let count: usize = train.scenarios.iter().map(|s| cases(&s.event).len()).sum();
    // A train file has at most a million breaks, and at most a thousand scenarios.
    u32::try_from(count).unwrap_or(u32::MAX)
}

/// The train files that a path stands for: itself, those in a folder and below, those that a glob matches; each sorted.
///
/// # Errors
/// A path that stands for none.
fn expand(path: &Path, files: &mut Vec<PathBuf>) -> Result<(), FleetError> {
    let none = |why: &str| Err(FleetError::Usage(format!("{} {why}", printable_path(path))));
    let before = files.len();
    if path.is_dir() {
        in_folder(path, files)?;
        return if files.len() == before { none("has no train file (*.toml) in it or below") } else { Ok(()) };
    }
    let text = path.to_string_lossy();
    if path.exists() {
        files.push(path.to_owned());
        return Ok(());
    }
    if !text.contains(['*', '?', '[']) {
        return none("does not exist");
    }
    let matches = glob::glob(&text).map_err(|e| FleetError::Usage(format!("{text} is no glob: {}", e.msg)))?;
    files.extend(matches.flatten().filter(|found| found.is_file()));
    if files.len() == before { none("matches no file") } else { Ok(()) }
}

fn in_folder(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), FleetError> {
    let unreadable = |e| FleetError::Usage(format!("the folder {} cannot be read: {e}", printable_path(folder)));
    let mut entries = fs::read_dir(folder).map_err(unreadable)?.flatten().map(|e| e.path()).collect::<Vec<_>>();
    entries.sort();
    for entry in entries {
        // A link to a folder above would lead round for ever.
        if entry.is_dir() && !entry.is_symlink() {
            in_folder(&entry, files)?;
        } else if entry.extension().is_some_and(|e| e == "toml") && entry.is_file() {
            files.push(entry);
        }
    }
    Ok(())
}

/// Content of every file that a train was read from.
fn digest(files: &Files) -> [u8; 32] {
    let mut all = Sha256::new();
    for source in files.list() {
        all.update(source.path.as_os_str().as_encoded_bytes());
        all.update([0]);
        all.update(source.sha256);
    }
    all.finalize().into()
}

/// The train as its file has it, and the files that it was read from.
fn base(path: &Path) -> (Files, Result<Train, InputError>) {
    let files = Files::default();
    let train = files.main(path).and_then(|text| consist::parse_with(&text, path, &files));
    (files, train)
}
