//! How a run begins, or goes on: its plan, made once and kept in the folder, and whether the folder holds another run.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::claims::{self, Claims, PLAN};
use super::inputs::Inputs;
use super::parts::{self, MadeFrom, Run};
use super::plan::Plan;
use super::{FleetError, Request, names, rows, study, variation};
use crate::error::printable_path;
use crate::findings::Options;
use crate::report::files::{self, WriteError};
use crate::solve::Method;
use crate::solve::responses::Responses;
use crate::train::hex;

/// Time between looks at whether another worker has made the plan.
const LOOK: Duration = Duration::from_millis(200);

/// Everything that the results of a run depend on: this is fingerprinted, and nothing else.
#[derive(Serialize, Deserialize)]
struct ResultInputs<I> {
    trainsafe: String,
    columns: String,
    tolerance: f64,
    method: Option<String>,
    couplers: bool,
    inputs: I,
}

/// The plan file: `fleet-parts/plan.json`.
#[derive(Serialize, Deserialize)]
struct PlanFile<I> {
    /// The paths that were given; workers with the same paths compute the same run.
    #[serde(with = "names::paths")]
    paths: Vec<PathBuf>,
    whole: ResultInputs<I>,
}

/// A run that is under way.
pub struct Begun {
    /// Its inputs.
    pub inputs: Inputs,
    /// Its description.
    pub run: Run,
    /// How its cases are solved.
    pub options: Options,
    /// Whether some of it may be left to compute.
    pub left: bool,
}

fn whole<I>(request: &Request, inputs: I) -> ResultInputs<I> {
    ResultInputs {
        trainsafe: env!("CARGO_PKG_VERSION").to_owned(),
        columns: rows::columns(),
        tolerance: request.options.tolerance,
        method: request.options.method.map(|m| m.name().to_owned()),
        couplers: request.couplers,
        inputs,
    }
}

impl<I: Serialize> ResultInputs<I> {
    fn fingerprint(&self) -> String {
        // Nothing of it can fail to be JSON: its maps have numbers as keys, and its numbers are finite.
        hex(&Sha256::digest(serde_json::to_vec(self).unwrap_or_default()))
    }
}

/// What is run with these inputs.
pub fn description(request: &Request, inputs: &Inputs) -> Run {
    let study = inputs.study.as_ref();
    let responses = Responses::new(0);
    let plan = Plan::new(inputs, request, &responses);
    Run {
        trainsafe: env!("CARGO_PKG_VERSION").to_owned(),
        fingerprint: whole(request, inputs).fingerprint(),
        trains: inputs.files.len(),
        variations: study.map(study::Study::variations),
        drawn: study.is_some_and(|s| s.draws.is_some()),
        latin_hypercube: study.and_then(|s| s.draws).is_some_and(|d| d.latin_hypercube),
        inputs: study.map(variation::headings).unwrap_or_default(),
        cases: plan.cases(),
        chunk_cases: plan.chunk_cases,
        notes: shown(inputs.notes()),
        columns: rows::columns(),
        made_from: made_from(request, inputs),
        complete: false,
    }
}

fn made_from(request: &Request, inputs: &Inputs) -> MadeFrom {
    const LISTED: usize = 20;
    // A study is given alone.
    let study = inputs.study_sha256().zip(request.paths.first());
    let sources = inputs.sources().into_iter().map(|source| (source.path.as_path(), source.sha256));
    let all = study.map(|(sha256, path)| (path.as_path(), sha256)).into_iter().chain(sources);
    let mut files: Vec<[String; 2]> = all.map(|(path, sha256)| [printable_path(path), hex(&sha256)]).collect();
    let list: String = files.iter().map(|[path, sha256]| format!("{sha256}  {path}\n")).collect();
    let file_count = files.len();
    files.truncate(LISTED);
    MadeFrom {
        tolerance: format!("{:e}", request.options.tolerance),
        method: request.options.method.map(|m| m.name().to_owned()),
        seed: inputs.study.as_ref().and_then(|study| study.draws).map(|draws| draws.seed),
        inputs: inputs.study_inputs(),
        files,
        file_count,
        list_sha256: hex(&Sha256::digest(list)),
    }
}

/// The first notes and a count.
pub fn shown(mut notes: Vec<String>) -> Vec<String> {
    const SHOWN: usize = 20;
    if notes.len() > SHOWN {
        let more = notes.len() - SHOWN;
        notes.truncate(SHOWN);
        notes.push(format!("and {more} more of this kind"));
    }
    notes
}

/// Looks at what the folder holds, and writes the plan and the description of a new run; whether something is left to compute.
///
/// # Errors
/// A folder with another run, or with one that is not to be continued; a file that cannot be written.
pub fn start(request: &Request, dir: &Path, inputs: &Inputs, new: &Run) -> Result<bool, FleetError> {
    let goes_on = request.resume || request.worker.is_some();
    let found = parts::read(dir)?;
    let same = found.as_ref().is_some_and(|old| Run { complete: false, ..old.clone() } == *new);
    match &found {
        Some(old) if !old.complete && !goes_on => {
            let why = format!("{} holds a run that is not finished", printable_path(dir));
            let help = "go on with it by --resume or --work, or choose another folder with --out DIR";
            return Err(FleetError::Usage(format!("{why}: {help}")));
        }
        Some(old) if !same && (request.resume || !old.complete) => return Err(another(dir)),
        Some(old) if old.complete && same && goes_on => return Ok(false),
        Some(old) if !old.complete => {}
        _ => clear(dir)?,
    }
    parts::prepare(dir)?;
    let plan = PlanFile { paths: request.paths.clone(), whole: whole(request, inputs) };
    let path = plan_path(dir);
    let text = serde_json::to_vec(&plan).map_err(|e| WriteError::new(&path, e.into()))?;
    files::write_into(&parts::folder(dir), &[(plan_name(), text)])?;
    // Last: the description of an unfinished run means that its plan is there.
    parts::describe(dir, new)?;
    Ok(true)
}

/// The run of a folder for a worker: the plan that is there, or one that this worker makes while others wait.
///
/// # Errors
/// As for [`start`]; a request for another run than the folder's.
pub fn join(request: &Request, dir: &Path, claims: &Claims) -> Result<Begun, FleetError> {
    loop {
        if let Some(begun) = planned(dir, Some(request))? {
            return Ok(begun);
        }
        if claims.take(PLAN)? {
            let made = Inputs::find(&request.paths, &request.options).and_then(|inputs| {
                let run = description(request, &inputs);
                let left = start(request, dir, &inputs, &run)?;
                Ok(Begun { inputs, run, options: request.options.clone(), left })
            });
            claims.release(PLAN);
            return made;
        }
        request.options.stop.check()?;
        std::thread::sleep(LOOK);
    }
}

/// The unfinished run of a folder, from its plan; with a request, only if that is for this run.
///
/// # Errors
/// A plan that cannot be read; a run of other paths or options than the request's.
pub fn planned(dir: &Path, request: Option<&Request>) -> Result<Option<Begun>, FleetError> {
    let Some(run) = parts::read(dir)?.filter(|run| !run.complete) else { return Ok(None) };
    let path = plan_path(dir);
    let Ok(bytes) = fs::read(&path) else { return Ok(None) };
    let unreadable = |e: &dyn std::fmt::Display| FleetError::unreadable(&path, e);
    let PlanFile { paths, whole: kept } =
        serde_json::from_slice::<PlanFile<Inputs>>(&bytes).map_err(|e| unreadable(&e))?;
    if kept.fingerprint() != run.fingerprint {
        return Err(unreadable(&"it is the plan of another run"));
    }
    let method = kept.method.as_deref().and_then(Method::from_name);
    let options = Options { tolerance: kept.tolerance, method, ..Options::default() };
    let inputs = kept.inputs.with_parsed_study()?;
    if let Some(request) = request
        && (paths != request.paths || whole(request, &inputs).fingerprint() != run.fingerprint)
    {
        return Err(another(dir));
    }
    Ok(Some(Begun { inputs, run, options, left: true }))
}

impl Begun {
    /// The train files that each of some chunks is about.
    pub fn trains_of_chunks(&self, chunks: &[usize]) -> Vec<String> {
        let responses = Responses::new(0);
        let plan = Plan::new(&self.inputs, &Request::default(), &responses);
        let file = |case: u64| printable_path(&self.inputs.files[plan.place(case).0 / self.inputs.variations()]);
        let trains = |&chunk: &usize| [plan.range(chunk).start, plan.range(chunk).end - 1].map(file);
        chunks.iter().map(trains).map(|[a, b]| if a == b { a } else { format!("{a} to {b}") }).collect()
    }
}

fn another(dir: &Path) -> FleetError {
    let why = "holds a run of other train files, another study, other options or another version of trainsafe";
    let help = "put back what it was, or choose another folder with --out DIR";
    FleetError::Usage(format!("{} {why}: {help}", printable_path(dir)))
}

fn plan_name() -> String {
    format!("{PLAN}.json")
}

fn plan_path(dir: &Path) -> PathBuf {
    parts::folder(dir).join(plan_name())
}

/// Removes what an earlier run left, but for the signs of workers that wait for the new one.
///
/// # Errors
/// [`WriteError`] with the path of what would be taken for a part of the new run.
fn clear(dir: &Path) -> Result<(), FleetError> {
    let files = |folder: PathBuf| folder.read_dir().into_iter().flatten().flatten().map(|entry| entry.path());
    let couplers = files(parts::couplers(dir)).filter(|path| path.extension().is_some_and(|e| e == "parquet"));
    for path in files(parts::folder(dir)).filter(|path| !claims::is_sign(path)).chain(couplers) {
        fs::remove_file(&path).map_err(|e| WriteError::new(&path, e))?;
    }
    let _ = fs::remove_dir(parts::couplers(dir));
    Ok(())
}
