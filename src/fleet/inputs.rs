//! What a fleet run is given: train files and, where there is one, a study; and what is known of them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::FleetError;
use super::base::Base;
use super::find::{Found, is_study_file};
use super::names;
use super::study::{self, Study};
use super::survey::{self, Survey};
use super::variation::{self, Reached, Varied};
use crate::consist::{self, Files};
use crate::error::printable_path;
use crate::findings::Options;
use crate::report::cells::text;
use crate::train::{Doubt, Source};

/// Doubts by train file and code, each of a variation from 0.
pub type DoubtTexts = BTreeMap<(String, String), (usize, Doubt)>;

/// The train files and the study, as they were found at the start. A plan file leaves out what only the first worker
/// reports.
#[derive(Serialize, Deserialize)]
pub struct Inputs {
    /// Train files, in the order in which they are run.
    #[serde(with = "names::paths")]
    pub files: Vec<PathBuf>,
    /// What is varied.
    #[serde(skip)]
    pub study: Option<Study>,
    /// What was passed over among the paths, as sentences.
    #[serde(skip)]
    pub passed_over: Vec<String>,
    /// What is known of each file.
    surveys: Vec<Survey>,
    /// Text of the study file; empty without one.
    study_text: String,
    /// The train file that was asked for last: the variations of a train follow each other.
    #[serde(skip)]
    latest: Mutex<Option<(usize, Arc<Base>)>>,
}

impl Inputs {
    /// Finds the train files, or reads the study file and finds its trains; and looks at each train.
    ///
    /// # Errors
    /// A study file that is wrong, a path that does not exist, a folder or a glob without a train file, a study with an input that
    /// changes nothing in any of its trains.
    pub fn find(paths: &[PathBuf], options: &Options) -> Result<Inputs, FleetError> {
        let (mut study, mut study_text) = (None, String::new());
        let mut found = Found::default();
        if let Some(path) = paths.iter().find(|path| is_study_file(path)) {
            if paths.len() > 1 {
                let title = format!("{} is a study, which names its own trains", printable_path(path));
                return Err(FleetError::Usage(format!("{title}: give it alone")));
            }
            let text = Files::default().main(path)?;
            let read = study::parse(&text, path)?;
            let folder = path.parent().unwrap_or(Path::new(""));
            for trains in &read.trains {
                found.add(&folder.join(trains), Some(path))?;
            }
            (study, study_text) = (Some(read), text.to_string());
        } else {
            for path in paths {
                found.add(path, None)?;
            }
        }
        let Found { files, notes: passed_over, .. } = found;
        let surveys: Vec<Survey> = files.par_iter().map(|file| Survey::of(file, study.as_ref(), options)).collect();
        let mut without = surveys.iter().filter_map(|survey| survey.without_effect.as_ref());
        if let Some(first) = without.next()
            && without.count() + 1 == files.len()
        {
            let others = if files.len() == 1 { "" } else { ", and each of the other trains has such a key" };
            return Err(FleetError::Usage(format!("{first}{others}")));
        }
        Ok(Inputs { files, study, passed_over, surveys, study_text, latest: Mutex::default() })
    }

    /// Variations of each train.
    pub fn variations(&self) -> usize {
        self.study.as_ref().map_or(1, Study::variations)
    }

    /// Notes on the study's inputs and on options, as sentences: what inputs do not reach, draws below zero that are
    /// replaced, options that do nothing for a train.
    pub fn notes(&self) -> Vec<String> {
        let inputs = self.study.iter().flat_map(|study| &study.inputs);
        let traces = inputs.filter_map(|input| {
            let share = input.spread.impossible();
            let text = format!(
                "{:.1e} of the distribution of {} is below zero, where it cannot be: its lowest {:.1e} is drawn as one value \
                 above zero",
                share,
                input.key,
                2.0 * share
            );
            // A smaller share does not occur in as many draws as a study can have.
            (share > 1e-14).then_some(text)
        });
        let idle = |(file, survey): (&PathBuf, &Survey)| {
            let file = printable_path(file);
            survey.idle.iter().map(|text| format!("{file}: {text}")).collect::<Vec<_>>()
        };
        let idle = self.files.iter().zip(&self.surveys).flat_map(idle);
        traces.chain(self.surveys.iter().flat_map(|survey| survey.notes.clone())).chain(idle).collect()
    }

    /// The files that some variation is read from, each once, in the order of their paths.
    pub fn sources(&self) -> Vec<&Source> {
        let mut all: Vec<&Source> = self.surveys.iter().flat_map(|survey| &survey.sources).collect();
        all.sort_by(|a, b| a.path.cmp(&b.path).then(a.sha256.cmp(&b.sha256)));
        all.dedup();
        all
    }

    /// SHA-256 of the study file; `None` without a study.
    pub fn study_sha256(&self) -> Option<[u8; 32]> {
        self.study.as_ref().map(|_| Sha256::digest(&self.study_text).into())
    }

    /// Each input of the study: its key, its values or distribution as the study file gives them, and what has a draw of its own.
    pub fn study_inputs(&self) -> Vec<[String; 3]> {
        study::written(&self.study_text)
    }

    /// Texts of the doubts about the first variation of each train.
    pub fn words(&self) -> DoubtTexts {
        let words = |(file, survey): (&PathBuf, &Survey)| {
            let file = file_cell(file);
            survey.doubts.clone().into_iter().rev().map(move |d| ((file.clone(), d.code.to_owned()), (0, d)))
        };
        self.files.iter().zip(&self.surveys).flat_map(words).collect()
    }

    /// Inputs of a plan file with their study.
    ///
    /// # Errors
    /// A study that this program cannot have planned.
    pub fn with_parsed_study(self) -> Result<Inputs, FleetError> {
        let text = Some(self.study_text.as_str()).filter(|text| !text.is_empty());
        let study = text.map(|text| study::parse(text, Path::new("study"))).transpose()?;
        Ok(Inputs { study, ..self })
    }

    /// A train file's variation, both counted from 0.
    ///
    /// # Errors
    /// [`FleetError::Changed`] if a file that it is read from is no longer what it was at the start.
    pub fn load(&self, file: usize, variation: usize) -> Result<Varied, FleetError> {
        let survey = &self.surveys[file];
        if let Some(why) = &survey.without_effect {
            let inputs = self.study.as_ref().map_or(0, |study| study.inputs.len());
            return Ok(Varied { cells: vec![String::new(); inputs], train: Err(why.clone()), tree: None });
        }
        let base = self.base(file);
        let varied = match &self.study {
            Some(study) => {
                let own: Reached;
                let reached = match &survey.reached {
                    Some(reached) => reached,
                    None => {
                        own = survey::reach(study, variation, &base).reached;
                        &own
                    }
                };
                variation::vary(study, variation, &base, reached)
            }
            None => {
                let text = base.text.as_ref().map_err(Clone::clone);
                let train = text.and_then(|text| consist::parse_with(text, &base.path, &base.files));
                Varied { cells: vec![], train: train.map_err(|e| e.brief()), tree: None }
            }
        };
        match base.files.list().into_iter().find(|source| !survey.sources.contains(source)) {
            Some(source) => Err(FleetError::Changed(source.path)),
            None => Ok(varied),
        }
    }

    /// Whether the files that the first variations are read from are what they were at the start.
    ///
    /// # Errors
    /// [`FleetError::Changed`] for one that is not.
    pub fn unchanged(&self) -> Result<(), FleetError> {
        (0..self.files.len()).into_par_iter().try_for_each(|file| self.load(file, 0).map(|_| ()))
    }

    /// How many cases a variation of a train has.
    pub fn cases(&self, file: usize, variation: usize) -> u32 {
        self.surveys[file].count(variation)
    }

    /// Whether a train fails as a whole, whatever the variation.
    pub fn fails_as_a_whole(&self, file: usize) -> bool {
        self.surveys[file].without_effect.is_some()
    }

    /// A train file, read once for variations that follow each other.
    fn base(&self, file: usize) -> Arc<Base> {
        let latest = || self.latest.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, base)) = latest().as_ref().filter(|(number, _)| *number == file) {
            return base.clone();
        }
        let base = Arc::new(Base::read(&self.files[file]));
        if self.variations() > 1 {
            *latest() = Some((file, base.clone()));
        }
        base
    }
}

/// A train file as the rows name it.
pub fn file_cell(file: &Path) -> String {
    text(&file.display().to_string()).into_owned()
}
