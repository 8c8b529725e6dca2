//! Many trains and what-ifs: every case of every variation of every train, one row each.
//!
//! ```text
//! inputs (+ study) -> plan: numbered chunks of cases -> part files -> fleet.csv, errors.csv -> fleet.md, fleet.html, ...
//! ```
//!
//! The chunks depend on the inputs alone, never on threads, workers or attempts. A chunk's rows appear in a part file whole
//! or not at all, so a run may be killed at any moment, and another may do what is missing; the parts in order are the
//! result. Only the rows of chunks under way are in memory. Workers on any number of machines that share the folder take the next
//! chunk that nobody has, by the plan that the first of them has made.

pub mod base;
mod begin;
mod claims;
mod compute;
#[cfg(feature = "parquet")]
mod couplers;
mod doubts;
mod estimate;
mod find;
mod fleet_md;
mod inputs;
mod join;
pub mod key;
mod lock;
mod names;
mod outputs;
mod page;
#[cfg(feature = "parquet")]
mod parquet_file;
mod parts;
mod plan;
mod probability;
mod progress;
mod reports;
mod rows;
mod section;
mod sections;
pub mod spread;
mod statistics;
pub mod study;
pub(crate) mod study_keys;
mod summary;
mod survey;
pub mod variation;

use std::io::Write;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

pub use claims::Worker;
pub use outputs::FleetFormat;
pub use progress::{Count, ProgressTarget};

use crate::error::{InputError, printable_path};
use crate::findings::{Options, Stopped};
use crate::report::files::WriteError;
use crate::solve::responses::Responses;
use crate::units::UnitSystem;
use begin::{Begun, description, shown};
use claims::Claims;
use compute::{compute, work};
use inputs::{DoubtTexts, Inputs};
use parts::Run;
use plan::Plan;
use progress::Progress;
use reports::Reports;
use summary::Summary;

/// Memory for responses that a run may use again, bytes.
const REMEMBERED: usize = 320 << 20;

/// Why a run could not be made.
#[derive(Debug, thiserror::Error)]
pub enum FleetError {
    /// The study file is wrong.
    #[error("{}", .0.render(false))]
    Study(#[from] InputError),
    /// What was asked makes no sense here.
    #[error("{0}")]
    Usage(String),
    /// A train file, or a file that it names, is no longer what it was when the run started.
    #[error("{} has changed since the run started: what is done belongs to the old one", printable_path(.0))]
    Changed(PathBuf),
    /// The caller asked it to stop; parts that are done are kept.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// A result could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Standard output could not be written.
    #[error("cannot write to standard output: {0}")]
    Output(std::io::Error),
}

impl FleetError {
    /// A file that this program has written, and cannot read now.
    fn unreadable(path: &Path, why: &dyn std::fmt::Display) -> FleetError {
        FleetError::Usage(format!("{} cannot be read: {why}", printable_path(path)))
    }
}

/// How a run is to be made.
#[derive(Clone, Debug, Default)]
pub struct Request {
    /// Train files, folders and globs, or one study file.
    pub paths: Vec<PathBuf>,
    /// Tolerance and method of each case.
    pub options: Options,
    /// Compute what no other worker does, under this name, and leave the parts to be joined by [`merge`].
    pub worker: Option<Worker>,
    /// Go on with the run that the folder holds.
    pub resume: bool,
    /// Files to write, besides `fleet.csv` and `errors.csv`.
    pub formats: Vec<FleetFormat>,
    /// Trains, the worst, whose full reports are written as well.
    pub reports: usize,
    /// Units of the page and of full reports; `None`: SI in the page, and each train's own in its report.
    pub units: Option<UnitSystem>,
    /// Keep every coupler of every case too, in `couplers/`.
    pub couplers: bool,
    /// Bytes of memory for responses that were found; `None`: 320 MiB. Results do not depend on it.
    pub response_bytes: Option<usize>,
    /// Where progress is reported.
    pub progress: ProgressTarget,
}

/// What a run came to.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// The verdict, as sentences; empty for a worker.
    pub verdict: Vec<String>,
    /// The report; `None` for a worker, and where none was asked for.
    pub report: Option<PathBuf>,
    /// Trains with a result, counted in this run.
    pub computed: usize,
    /// Trains or cases without.
    pub failed: usize,
    /// Cases with an exceedance, or not decided.
    pub exceeding: usize,
    /// Warnings, as sentences.
    pub warnings: Vec<String>,
    /// Notes, as sentences.
    pub notes: Vec<String>,
    /// Scenes whose response was known, and scenes that were solved.
    pub scenes: (u64, u64),
}

/// What a run would take.
#[derive(Clone, Debug)]
pub struct Estimate {
    /// Train files.
    pub trains: usize,
    /// Variations of each.
    pub variations: usize,
    /// Cases in all.
    pub cases: u64,
    /// The shortest and the longest time that it will probably take on all threads, s.
    pub seconds: [f64; 2],
    /// Threads used.
    pub threads: usize,
    /// Notes, as sentences.
    pub notes: Vec<String>,
}

/// Runs what the request asks for and writes the results into a folder, made if need be.
///
/// # Errors
/// [`FleetError`]; what has been computed until then stays, for a run that resumes.
pub fn run(request: &Request, dir: &Path) -> Result<Outcome, FleetError> {
    outputs::can_write(request)?;
    if let Some(worker) = &request.worker {
        return take_part(request, dir, worker);
    }
    let inputs = Inputs::find(&request.paths, &request.options)?;
    let responses = responses(request);
    let plan = Plan::new(&inputs, request, &responses);
    let description = description(request, &inputs);
    let _lock = lock::hold(dir, false)?;
    if begin::start(request, dir, &inputs, &description)? {
        compute(dir, &plan, None, &request.progress)?;
    }
    // Earlier doubts are kept as codes only.
    let mut words = inputs.words();
    words.extend(plan.doubts());
    let mut outcome = finish(request, dir, &description, Some(&inputs), &words)?;
    outcome.notes.splice(..0, inputs.passed_over.clone());
    Ok(Outcome { scenes: responses.counts(), ..outcome })
}

/// Computes a worker's part of the run in a folder.
fn take_part(request: &Request, dir: &Path, worker: &Worker) -> Result<Outcome, FleetError> {
    find::exist(&request.paths)?;
    let _lock = lock::hold(dir, true)?;
    let claims = Claims::enter(dir, worker)?;
    let Begun { inputs, run, left, .. } = begin::join(request, dir, &claims)?;
    let responses = responses(request);
    let plan = Plan::new(&inputs, request, &responses);
    if (0..plan.chunks()).all(|chunk| parts::is_done(dir, chunk)) {
        // No train is read again, so no change would show.
        inputs.unchanged()?;
    }
    let failed = if left { compute(dir, &plan, Some(&claims), &request.progress)? } else { 0 };
    let warnings = doubts::lines_of_share(&plan.doubts());
    let notes = [inputs.passed_over, run.notes].concat();
    Ok(Outcome { failed, computed: 1, scenes: responses.counts(), warnings, notes, ..Outcome::default() })
}

fn responses(request: &Request) -> Responses {
    Responses::new(request.response_bytes.unwrap_or(REMEMBERED))
}

/// Joins the parts that workers have written into the same files that one run would have. Of the request only what is to be written
/// counts: the paths and options are those of the run.
///
/// # Errors
/// [`FleetError`] where the folder holds no run, or parts are missing.
pub fn merge(request: &Request, dir: &Path) -> Result<Outcome, FleetError> {
    outputs::can_write(request)?;
    let none = || FleetError::Usage(format!("{} holds no run of workers to merge", printable_path(dir)));
    let run = parts::read(dir)?.ok_or_else(none)?;
    if run.trainsafe != env!("CARGO_PKG_VERSION") || run.columns != rows::columns() {
        let why = format!("{} holds a run of another version of trainsafe", printable_path(dir));
        return Err(FleetError::Usage(format!("{why}: merge it with that version, or run it again with this one")));
    }
    join::none_is_missing(dir, &run)?;
    let _lock = lock::hold(dir, false)?;
    let run = parts::read(dir)?.ok_or_else(none)?;
    let planned = begin::planned(dir, None)?;
    let (inputs, options) = planned.map(|begun| (begun.inputs, begun.options)).unzip();
    let changed = inputs.as_ref().and_then(|inputs| match inputs.unchanged() {
        Err(FleetError::Changed(path)) => Some(path),
        _ => None,
    });
    let request = Request { options: options.unwrap_or_default(), ..request.clone() };
    let mut outcome = finish(&request, dir, &run, inputs.as_ref(), &DoubtTexts::new())?;
    outcome.warnings.extend(changed.map(|path| {
        let file = printable_path(&path);
        format!("{file} has changed since the run was planned: the results are of the file as it was")
    }));
    Ok(outcome)
}

/// Whether a folder holds a run, finished or not.
pub fn is_begun(dir: &Path) -> bool {
    parts::read(dir).is_ok_and(|run| run.is_some())
}

/// Counts the work, does a little of it to see how long that takes, and writes nothing.
///
/// # Errors
/// As for [`run`].
pub fn estimate(request: &Request) -> Result<Estimate, FleetError> {
    outputs::can_write(request)?;
    let inputs = Inputs::find(&request.paths, &request.options)?;
    let responses = Responses::new(REMEMBERED);
    let plan = Plan::new(&inputs, request, &responses);
    Ok(Estimate {
        trains: inputs.files.len(),
        variations: inputs.variations(),
        cases: plan.cases(),
        seconds: estimate::seconds(&plan)?,
        threads: rayon::current_num_threads(),
        notes: [inputs.passed_over.clone(), shown(inputs.notes())].concat(),
    })
}

/// Writes every row as a line of JSON, in order, and every error too; no files.
///
/// # Errors
/// As for [`run`].
///
/// ```
/// use trainsafe::fleet::{Request, stream};
/// let request = Request { paths: vec!["trains/paper-figure-4.toml".into()], ..Request::default() };
/// let mut rows = Vec::new();
/// let outcome = stream(&request, &mut rows)?;
/// assert_eq!((outcome.computed, outcome.failed, outcome.exceeding), (1, 0, 1));
/// let row: serde_json::Value = serde_json::from_slice(&rows)?;
/// assert_eq!((&row["broken_coupler"], &row["worst_coupler"]), (&51.into(), &1.into()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn stream(request: &Request, out: &mut dyn Write) -> Result<Outcome, FleetError> {
    let inputs = Inputs::find(&request.paths, &request.options)?;
    let responses = responses(request);
    let plan = Plan::new(&inputs, request, &responses);
    let run = description(request, &inputs);
    let mut summary = Summary::new(run.inputs.len());
    let progress = Progress::new(plan.cases(), &request.progress);
    let headings = rows::headings(&run.inputs);
    let chunks: Vec<usize> = (0..plan.chunks()).collect();
    for together in chunks.chunks(4 * rayon::current_num_threads()) {
        let done: Vec<_> = together.par_iter().with_max_len(1).map(|&c| work(&plan, c, &progress)).collect();
        for done in done {
            let [rows, errors] = done?.rows.into_bytes();
            summary.add(&rows, &errors);
            let lines = rows::json(&headings, &rows) + &rows::json(&rows::ERRORS, &errors);
            out.write_all(lines.as_bytes()).map_err(FleetError::Output)?;
        }
    }
    summary.close();
    progress.finish();
    let notes = [inputs.passed_over.clone(), run.notes.clone()].concat();
    Ok(Outcome { scenes: responses.counts(), notes, ..outcome(&run, &summary, None, &plan.doubts()) })
}

/// Joins the parts, unless that is done, and writes what is asked for.
fn finish(
    request: &Request,
    dir: &Path,
    run: &Run,
    inputs: Option<&Inputs>,
    words: &DoubtTexts,
) -> Result<Outcome, FleetError> {
    let known = parts::read(dir)?.is_some_and(|found| found.complete);
    let summary = if known { join::summarise(dir, run)? } else { join::join(dir, run)? };
    let reports = match (request.reports, inputs) {
        (0, _) => Reports::default(),
        (most, Some(inputs)) => reports::write(dir, inputs, request, &summary, most)?,
        (_, None) => {
            let why = format!("{} is joined already, and its plan is gone", printable_path(dir));
            return Err(FleetError::Usage(format!("{why}: for reports give the paths, with --resume and --reports")));
        }
    };
    let report = outputs::write(dir, run, &summary, request, &reports.links)?;
    if !known {
        outputs::remove_others(dir, &request.formats);
        parts::describe(dir, &Run { complete: true, ..run.clone() })?;
    }
    parts::remove(dir);
    let mut outcome = outcome(run, &summary, report, words);
    outcome.warnings.extend(reports.missing);
    Ok(outcome)
}

fn outcome(run: &Run, summary: &Summary, report: Option<PathBuf>, words: &DoubtTexts) -> Outcome {
    let open: usize = summary.trains.iter().map(|t| t.undecided_variations).sum();
    Outcome {
        verdict: sections::verdict(run, summary),
        report,
        computed: summary.trains.len(),
        failed: summary.failed,
        exceeding: summary.harmful + open,
        warnings: if summary.trains.is_empty() { failures(summary) } else { doubts::lines(summary, words) },
        notes: run.notes.clone(),
        scenes: (0, 0),
    }
}

/// Why no train has a result.
fn failures(summary: &Summary) -> Vec<String> {
    const SHOWN: usize = 3;
    let error = |[file, what, error]: &[String; 3]| match what.as_str() {
        "" if error.starts_with(file) => error.clone(),
        "" => format!("{file}: {error}"),
        what => format!("{file}, {what}: {error}"),
    };
    summary.errors.iter().take(SHOWN).map(error).collect()
}
