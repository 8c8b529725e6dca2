//! Many trains and what-ifs: every case of every variation of every train, one row each.
//!
//! ```text
//! inputs (+ study) -> plan: numbered chunks of cases -> part files -> fleet.csv, errors.csv -> fleet.md, fleet.html, ...
//! ```
//!
//! The chunks depend on the inputs alone, never on threads, shards or attempts. A chunk's rows appear in a part file whole
//! or not at all, so a run may be killed at any moment, and another may do what is missing; the parts in order are the
//! result. Only the rows of chunks under way are in memory.

pub mod base;
mod doubts;
mod estimate;
mod find;
mod fleet_md;
mod inputs;
mod join;
pub mod key;
mod lock;
mod outputs;
mod page;
#[cfg(feature = "parquet")]
mod parquet_file;
mod parts;
mod plan;
mod progress;
mod reports;
mod rows;
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

pub use outputs::FleetFormat;
pub use plan::Shard;
pub use progress::{Count, Telling};

use crate::error::{InputError, printable_path};
use crate::findings::{Options, Stopped};
use crate::report::files::WriteError;
use crate::solve::memo::Memo;
use inputs::Inputs;
use parts::Run;
use plan::{Plan, Words};
use progress::Progress;
use reports::Reports;
use summary::Summary;

/// What a run may remember of scenes that it has solved, bytes.
const REMEMBERED: usize = 160 << 20;

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
    /// Only this share of the chunks; the parts are joined by [`merge`].
    pub shard: Option<Shard>,
    /// Go on with the run that the folder holds.
    pub resume: bool,
    /// Files to write, besides `fleet.csv` and `errors.csv`.
    pub formats: Vec<FleetFormat>,
    /// Trains, the worst, whose full reports are written as well.
    pub reports: usize,
    /// Bytes of memory for scenes that have been solved; `None`: 160 MiB. Results do not depend on it.
    pub memo_bytes: Option<usize>,
    /// Who is told how far the run is.
    pub progress: Telling,
}

/// What a run came to.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// The verdict, as sentences; empty for a shard.
    pub verdict: Vec<String>,
    /// The report; `None` for a shard, and where none was asked for.
    pub report: Option<PathBuf>,
    /// Trains with a result, as far as this run knows.
    pub computed: usize,
    /// Trains or cases without.
    pub failed: usize,
    /// Cases with an exceedance, or not decided.
    pub exceeding: usize,
    /// What else there is to say, as sentences.
    pub warnings: Vec<String>,
    /// What is no reason for a warning, as sentences.
    pub notes: Vec<String>,
    /// Scenes found already solved, and scenes solved.
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
    /// How many those are.
    pub threads: usize,
    /// What else there is to say, as sentences.
    pub notes: Vec<String>,
}

/// Runs what the request asks for and writes the results into a folder, made if need be.
///
/// # Errors
/// [`FleetError`]; what has been computed until then stays, for a run that resumes.
pub fn run(request: &Request, dir: &Path) -> Result<Outcome, FleetError> {
    outputs::can_write(&request.formats)?;
    let inputs = Inputs::find(&request.paths, &request.options)?;
    let memo = Memo::new(request.memo_bytes.unwrap_or(REMEMBERED));
    let plan = Plan::new(&inputs, &request.options, &memo);
    let description = description(&inputs, &plan, &request.options);
    let _lock = lock::hold(dir, request.shard.is_some())?;
    if start(request, dir, &description)? {
        let failed = compute(request, dir, &plan)?;
        if request.shard.is_some() {
            let warnings = doubts::lines_of_share(&plan.doubts());
            let notes = [inputs.passed_over.clone(), description.notes].concat();
            let outcome = Outcome { failed, computed: 1, scenes: memo.counts(), warnings, notes, ..Outcome::default() };
            return Ok(outcome);
        }
    }
    let reports = |summary: &Summary| match request.reports {
        0 => Ok(Reports::default()),
        most => reports::write(dir, &inputs, &request.options, summary, most),
    };
    // What was computed before has no words any more.
    let mut words = inputs.words();
    words.extend(plan.doubts());
    let mut outcome = finish(dir, &description, &request.formats, &reports, &words)?;
    outcome.notes.splice(..0, inputs.passed_over.clone());
    Ok(Outcome { scenes: memo.counts(), ..outcome })
}

/// Joins the parts that shards have written into the same files that one run would have.
///
/// # Errors
/// [`FleetError`] where the folder holds no run, or parts are missing.
pub fn merge(dir: &Path, formats: &[FleetFormat]) -> Result<Outcome, FleetError> {
    outputs::can_write(formats)?;
    let none = || FleetError::Usage(format!("{} holds no run of shards to merge", printable_path(dir)));
    parts::read(dir)?.ok_or_else(none)?;
    let _lock = lock::hold(dir, false)?;
    let run = parts::read(dir)?.ok_or_else(none)?;
    if run.trainsafe != env!("CARGO_PKG_VERSION") || run.columns != rows::columns() {
        let why = format!("{} holds a run of another version of trainsafe", printable_path(dir));
        return Err(FleetError::Usage(format!("{why}: merge it with that version, or run it again with this one")));
    }
    finish(dir, &run, formats, &|_| Ok(Reports::default()), &Words::new())
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
    outputs::can_write(&request.formats)?;
    let inputs = Inputs::find(&request.paths, &request.options)?;
    let memo = Memo::new(REMEMBERED);
    let plan = Plan::new(&inputs, &request.options, &memo);
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
    let memo = Memo::new(request.memo_bytes.unwrap_or(REMEMBERED));
    let plan = Plan::new(&inputs, &request.options, &memo);
    let run = description(&inputs, &plan, &request.options);
    let mut summary = Summary::new(run.inputs.len());
    let progress = Progress::new(plan.cases(), &request.progress);
    let headings = join::headings(&run);
    let chunks: Vec<usize> = (0..plan.chunks()).collect();
    for together in chunks.chunks(4 * rayon::current_num_threads()) {
        let done: Vec<_> = together.par_iter().with_max_len(1).map(|&c| work(&plan, c, &progress)).collect();
        for rows in done {
            let [rows, errors] = rows?.into_bytes();
            summary.add(&rows, &errors);
            let lines = rows::json(&headings, &rows) + &rows::json(&rows::ERRORS, &errors);
            out.write_all(lines.as_bytes()).map_err(FleetError::Output)?;
        }
    }
    summary.close();
    progress.finish();
    let notes = [inputs.passed_over.clone(), run.notes.clone()].concat();
    Ok(Outcome { scenes: memo.counts(), notes, ..outcome(&run, &summary, None, &plan.doubts()) })
}

fn description(inputs: &Inputs, plan: &Plan, options: &Options) -> Run {
    let study = inputs.study.as_ref();
    Run {
        trainsafe: env!("CARGO_PKG_VERSION").to_owned(),
        fingerprint: inputs.fingerprint(options),
        trains: inputs.files.len(),
        variations: study.map(study::Study::variations),
        drawn: study.is_some_and(|s| s.draws.is_some()),
        latin_hypercube: study.and_then(|s| s.draws).is_some_and(|d| d.latin_hypercube),
        inputs: study.map(variation::headings).unwrap_or_default(),
        cases: plan.cases(),
        chunk_cases: plan.chunk_cases,
        notes: shown(inputs.notes()),
        columns: rows::columns(),
        complete: false,
    }
}

/// As many notes as anybody reads.
fn shown(mut notes: Vec<String>) -> Vec<String> {
    const SHOWN: usize = 20;
    if notes.len() > SHOWN {
        let more = notes.len() - SHOWN;
        notes.truncate(SHOWN);
        notes.push(format!("and {more} more of this kind"));
    }
    notes
}

/// Looks at what the folder holds; whether something is left to compute.
fn start(request: &Request, dir: &Path, new: &Run) -> Result<bool, FleetError> {
    let goes_on = request.resume || request.shard.is_some();
    let found = parts::read(dir)?;
    let same = found.as_ref().is_some_and(|old| Run { complete: false, ..old.clone() } == *new);
    let refuse = |why: &str, help: &str| Err(FleetError::Usage(format!("{} {why}: {help}", printable_path(dir))));
    match &found {
        Some(old) if !old.complete && !goes_on => refuse(
            "holds a run that is not finished",
            "go on with it by --resume, or choose another folder with --out DIR",
        ),
        Some(old) if !same && (request.resume || !old.complete) => refuse(
            "holds a run of other train files, another study, other options or another version of trainsafe",
            "put back what it was, or choose another folder with --out DIR",
        ),
        Some(old) if old.complete && same && goes_on => Ok(false),
        Some(old) if !old.complete => Ok(true),
        _ => {
            parts::remove(dir);
            parts::describe(dir, new)?;
            Ok(true)
        }
    }
}

/// Computes the chunks that are missing; how many trains or cases failed in them.
fn compute(request: &Request, dir: &Path, plan: &Plan) -> Result<usize, FleetError> {
    let mine = |chunk: &usize| request.shard.is_none_or(|shard| shard.has(*chunk));
    parts::prepare(dir)?;
    let missing: Vec<usize> = (0..plan.chunks()).filter(mine).filter(|&c| !parts::is_done(dir, c)).collect();
    let cases = |chunk: &usize| plan.range(*chunk).end - plan.range(*chunk).start;
    let progress = Progress::new(missing.iter().map(cases).sum(), &request.progress);
    let one = |&chunk: &usize| {
        let rows = work(plan, chunk, &progress)?;
        let failed = rows.failed;
        parts::keep(dir, chunk, rows)?;
        Ok(failed)
    };
    let failed: Result<Vec<usize>, FleetError> = missing.par_iter().with_max_len(1).map(one).collect();
    progress.finish();
    Ok(failed?.into_iter().sum())
}

fn work(plan: &Plan, chunk: usize, progress: &Progress) -> Result<rows::Chunk, FleetError> {
    let rows = plan.compute(chunk)?;
    let range = plan.range(chunk);
    progress.add((range.end - range.start) as usize, rows.failed);
    Ok(rows)
}

/// Joins the parts, unless that has been done, and makes of them what is asked for.
fn finish(
    dir: &Path,
    run: &Run,
    formats: &[FleetFormat],
    reports: &dyn Fn(&Summary) -> Result<Reports, FleetError>,
    words: &Words,
) -> Result<Outcome, FleetError> {
    let known = parts::read(dir)?.is_some_and(|found| found.complete);
    let summary = if known { join::summarise(dir, run)? } else { join::join(dir, run)? };
    let reports = reports(&summary)?;
    let report = outputs::write(dir, run, &summary, formats, &reports.links)?;
    if !known {
        outputs::remove_others(dir, formats);
        parts::describe(dir, &Run { complete: true, ..run.clone() })?;
    }
    parts::remove(dir);
    let mut outcome = outcome(run, &summary, report, words);
    outcome.warnings.extend(reports.missing);
    Ok(outcome)
}

fn outcome(run: &Run, summary: &Summary, report: Option<PathBuf>, words: &Words) -> Outcome {
    let open: usize = summary.trains.iter().map(|t| t.undecided_variations).sum();
    Outcome {
        verdict: fleet_md::verdict(run, summary),
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
