//! What an analysis found: utilisations, exceedances, safe load factors, in SI units, named as in `result.json`.

mod cascade;
mod case;
mod damped;
pub(crate) mod date;
mod doubts_found;
mod estimate;
mod evidence;
mod field;
mod first_passage;
mod history;
mod idle_options;
pub(crate) mod limits;
mod load_search;
mod map;
mod march;
mod safe_factor;
mod safe_speed;
mod solved;
mod stop;
pub(crate) mod variants;

pub use cascade::{CascadeBreak, CascadeFindings, CascadeWorst};
pub(crate) use case::{cases_at_once, cases_findings};
pub(crate) use doubts_found::found;
pub(crate) use estimate::case_estimate_s;
pub use estimate::{estimate_s, memory_bytes};
pub use evidence::Evidence;
pub(crate) use field::larger;
pub use field::{Field, Of, field};
pub use first_passage::PeakForces;
pub use history::{history, rod_history};
pub use idle_options::idle_options;
pub use limits::{LimitFindings, LimitInSense};
pub use load_search::LoadSearch;
pub use map::{MapFindings, MapPoint};
use std::sync::OnceLock;

use rayon::prelude::*;
use serde::Serialize;
pub use stop::{Stop, Stopped};
pub use variants::{Changed, DampingFindings, Variant, VariantFindings};

use crate::doubts;
use crate::scenario::Scales;
use crate::solve::responses::Shared;
use crate::solve::watch::{Side, SpringPeaks};
use crate::solve::{Ask, Method, SolveError, Wanted};
use crate::train::{Doubt, Event, Scenario, Source, Train, hex};
use crate::units::UnitSystem;

/// How an analysis is to be done.
#[derive(Clone, Debug)]
pub struct Options {
    /// The error each reported force may have, as a share of the train's largest rating. Default 1e-9.
    pub tolerance: f64,
    /// A method to use even where another needs less work; `None` lets the planner choose.
    pub method: Option<Method>,
    /// Only this scenario, by its name; `None` runs all.
    pub scenario: Option<String>,
    /// Leave out couplers whose all-time bound lies under their rating; of no use where a limit lies under a rating.
    pub verdict_only: bool,
    /// Report the all-time bound of every coupler's force.
    pub all_time_bound: bool,
    /// Which couplers' forces are to be exact. [`Wanted::Worst`] is less work, where it makes a difference: after breaks. Couplers that
    /// are neither the worst nor over their ratings may then be left out.
    pub wanted: Wanted,
    /// Add a map to every scenario: overloading force by duration, or safe load by broken coupler.
    pub map: bool,
    /// For another thread to stop it.
    pub stop: Stop,
    /// Add what the worst case of each scenario would be with dashpots in every coupler, for a train without losses.
    pub damping: bool,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            tolerance: 1e-9,
            method: None,
            scenario: None,
            verdict_only: false,
            all_time_bound: false,
            wanted: Wanted::Everything,
            map: false,
            stop: Stop::default(),
            damping: false,
        }
    }
}

/// All scenarios of one train.
#[derive(Clone, Debug, Serialize)]
pub struct Analysis {
    /// Version of this format.
    pub schema_version: u32,
    /// The program that found them.
    pub program: Program,
    /// The day in UTC, such as `2026-12-01`; `SOURCE_DATE_EPOCH` sets it.
    pub date: String,
    /// Every file that the train was read from.
    pub inputs: Vec<InputFile>,
    /// How the analysis was done.
    pub options: OptionFindings,
    /// Doubts about the train and the scenarios that were run.
    pub doubts: Vec<Doubt>,
    /// The units of its reports.
    #[serde(skip)]
    pub units: UnitSystem,
    /// The train's name.
    pub train: String,
    /// Number of vehicles.
    pub vehicles: usize,
    /// Number of couplers.
    pub couplers: usize,
    /// One entry per scenario that was run, in the file's order.
    pub scenarios: Vec<ScenarioFindings>,
}

/// A program and its version.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Program {
    /// Its name.
    pub name: &'static str,
    /// Its version.
    pub version: &'static str,
}

/// A file that was read.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InputFile {
    /// Its path, as it was given.
    pub path: String,
    /// SHA-256 of its bytes, in hexadecimal.
    pub sha256: String,
}

/// The options that decide the numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OptionFindings {
    /// The error each force may have, as a share of the largest rating.
    pub tolerance: f64,
    /// The method that was asked for; `None`: the program chose.
    pub method: Option<&'static str>,
}

/// One scenario: a single event, or each coupler of a list in turn.
#[derive(Clone, Debug, Serialize)]
pub struct ScenarioFindings {
    /// The scenario's name.
    pub name: String,
    /// `"break"`, `"pulse"` or `"impact"`.
    pub kind: &'static str,
    /// One per broken coupler, or one for a pulse or an impact.
    pub cases: Vec<CaseFindings>,
    /// Couplers, counted from 1, that would break in turn but carry buff, so that nothing parts: they have no case.
    pub left_out_in_buff: Vec<usize>,
    /// Its map, where asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub map: Option<MapFindings>,
    /// The worst case with dashpots in every coupler, by damping ratio; empty for a train that has losses, and where not asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub damping: Vec<DampingFindings>,
    /// The worst case on a train with other couplers, without brakes, or let down from a larger pull; those that fit
    /// the train, and none where not asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub variants: Vec<VariantFindings>,
    /// For the figures.
    #[serde(skip)]
    pub(crate) evidence: OnceLock<Option<Evidence>>,
}

/// What one event does to every coupler.
#[derive(Clone, Debug, Serialize)]
pub struct CaseFindings {
    /// The kind of its scenario.
    #[serde(skip)]
    pub kind: &'static str,
    /// The coupler that breaks, counted from 1; `None` for a pulse or an impact.
    pub broken_coupler: Option<usize>,
    /// The method that found the forces of the largest part, or of one whose error bound misses the tolerance.
    pub method: &'static str,
    /// Why this method, in one sentence.
    pub method_reason: String,
    /// How long forces were followed, s.
    pub horizon_s: f64,
    /// No reported force is further than this from the exact solution of the model, N, not negative.
    pub error_bound_n: f64,
    /// An estimate of that error, N, where there is no proof; `None` where the bound is one.
    pub error_estimate_n: Option<f64>,
    /// From when on small changes of the train change forces by more than the tolerance, s; `None`: not before the
    /// horizon. Nothing is reported of later times.
    pub predictable_until_s: Option<f64>,
    /// The braked vehicle that would stop first, counted from 1; nothing is reported from then on. `None`: none before the horizon.
    pub stopped_vehicle: Option<usize>,
    /// When, s.
    pub stopped_at_s: Option<f64>,
    /// When vehicles at a parted coupler come together again and push each other: coupler, counted from 1, and s.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub gap_closures: Vec<GapClosure>,
    /// The error that was asked for, N.
    pub tolerance_n: f64,
    /// Time spent computing this case, s.
    pub run_time_s: f64,
    /// Couplers that exceed their rating; the broken one is not counted.
    pub exceeding: usize,
    /// Couplers whose rating lies within the error bound of their peak.
    pub undecided: usize,
    /// Largest factor on the load (break), the force (pulse) or the speed (impact) at which no coupler exceeds; `None` where
    /// none bounds it.
    pub safe_load_factor: Option<f64>,
    /// Why there is no such factor, where it is not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub no_safe_load_factor: Option<&'static str>,
    /// Where it is not known, a search for the factor at which couplers begin to exceed; else `None`, and so for
    /// scenarios with several cases, for brakes, and where it would take too long.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub load_factor_search: Option<LoadSearch>,
    /// End of the first passage, s: the wave has run to the far end of the longest part and back once.
    pub first_passage_s: f64,
    /// Whether the event is a record of force over time: times count from its start, which may be before its force sets in.
    #[serde(skip)]
    pub(crate) is_record: bool,
    /// Couplers that exceed their rating in the first passage.
    pub exceeding_first_passage: usize,
    /// The coupler with the largest utilisation in the first passage, with its forces there.
    pub worst_first_passage: Option<CouplerFindings>,
    /// The coupler with the largest utilisation; `None` where no coupler is left.
    pub worst: Option<CouplerFindings>,
    /// Every coupler but the broken one, from the head.
    pub couplers: Vec<CouplerFindings>,
    /// Couplers left out because their all-time bound is under their rating (only with `verdict_only`).
    pub left_out: usize,
    /// Result of the elastic rod; equal-mass trains only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rod: Option<RodFindings>,
    /// What breaks next, where the scenario asks for it; all other fields are of the event alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cascade: Option<CascadeFindings>,
}

/// One coupler's largest forces over 0 <= t <= horizon, t = 0 included.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CouplerFindings {
    /// Counted from 1 at the head.
    pub coupler: usize,
    /// Labels of the vehicles it joins.
    pub between: [String; 2],
    /// Capacity in tension, N.
    pub rated_draft_n: f64,
    /// Capacity in compression, N, positive.
    pub rated_buff_n: f64,
    /// Force before the event, N, draft positive.
    pub initial_force_n: f64,
    /// The force of the largest utilisation, N, draft positive.
    pub peak_force_n: f64,
    /// When, s after the event.
    pub peak_time_s: f64,
    /// |peak_force_n| over the rating in that sense: a share, 1 at the rating.
    pub utilisation: f64,
    /// Largest tension, N, positive; `None` if it is never in tension.
    pub peak_draft_n: Option<f64>,
    /// When, s after the event.
    pub peak_draft_time_s: Option<f64>,
    /// Largest compression, N, negative; `None` if it is never in compression.
    pub peak_buff_n: Option<f64>,
    /// When, s after the event.
    pub peak_buff_time_s: Option<f64>,
    /// Over its rating in either sense; `None`: not decided, the rating lies within the error bound of the peak.
    pub exceeds: Option<bool>,
    /// The same in draft and in buff alone.
    #[serde(skip)]
    pub exceeds_in: [Option<bool>; 2],
    /// Largest F and largest -F, N, of either sign: a coupler that is never in tension still has a largest F.
    #[serde(skip)]
    pub(crate) extremes_n: [f64; 2],
    /// The first time it is over its rating, s after the event; `None` if it never is.
    pub first_exceeds_s: Option<f64>,
    /// Over which rating it is then, `"draft"` or `"buff"`.
    pub first_exceeds_in: Option<&'static str>,
    /// The same over the first passage.
    pub first_passage: Option<PeakForces>,
    /// The same in the train whose couplers break one after the other, up to the break of this one; where the scenario asks for it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cascade: Option<PeakForces>,
    /// An estimate of the error of its largest forces, N, where there is no proof.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error_estimate_n: Option<f64>,
    /// Bound on |force| over all time, N, where asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub all_time_bound_n: Option<f64>,
    /// Which capacities besides the rating it passes, where the train has any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limits: Option<LimitFindings>,
}

/// A gap that closes at a coupler that has parted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GapClosure {
    /// Counted from 1.
    pub coupler: usize,
    /// When, s after the event.
    pub time_s: f64,
}

/// Why a march ended before its horizon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ending {
    /// When, s.
    pub at_s: f64,
    /// A braked vehicle, counted from 1, would stop; without one forces cannot be told from then on.
    pub stopped_vehicle: Option<usize>,
}

impl CaseFindings {
    /// Error of every reported force, N: proven, or else estimated.
    pub fn error_n(&self) -> f64 {
        march::error_n(self.error_bound_n, self.error_estimate_n)
    }

    /// Ratings this close to a peak are undecided, N: the bound, or ten times the estimate.
    pub fn margin_n(&self) -> f64 {
        march::margin_n(self.error_bound_n, self.error_estimate_n)
    }
}

/// Result of the continuum model for the same case.
#[derive(Clone, Debug, Serialize)]
pub struct RodFindings {
    /// Couplers over their rating in the elastic rod.
    pub exceeding: usize,
    /// The rod's largest utilisation, a share.
    pub utilisation: f64,
}

/// Why an analysis could not be done.
#[derive(Debug, thiserror::Error)]
pub enum AnalyzeError {
    /// The caller stopped it.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// `--scenario` names none of the train's.
    #[error("no scenario is named {asked:?}; the train has {}", known.join(", "))]
    UnknownScenario {
        /// The name asked for.
        asked: String,
        /// The names there are, quoted.
        known: Vec<String>,
    },
    /// No scenario has a case.
    #[error(
        "no case is left: every coupler that would break carries buff, so that nothing parts; buff_breaks = true computes a break \
         of one that is named"
    )]
    NoCase,
    /// The date that the environment sets is none.
    #[error("{0}")]
    Date(String),
    /// All cases together would take too long.
    #[error("this would take about {:.1} hours: name fewer couplers or a shorter horizon", seconds / 3600.0)]
    TooLong {
        /// The estimate.
        seconds: f64,
    },
    /// The results of all cases together would take too much memory.
    #[error(
        "the results would take about {:.1} GB of memory, and at most {} GB are used: name fewer couplers, or run it with \
         `trainsafe fleet`, which keeps one result of each case",
        *bytes as f64 / 1e9, most / 1_000_000_000
    )]
    TooLarge {
        /// The estimate.
        bytes: usize,
        /// The limit.
        most: usize,
    },
    /// A case that the chosen method, or any method, cannot do.
    #[error("{scenario}: {source}")]
    Solve {
        /// The scenario's name.
        scenario: String,
        /// Why not.
        source: SolveError,
    },
}

/// Runs the train's scenarios, or the one that the options name.
///
/// Cases run in parallel; the result does not depend on how many threads there are.
///
/// # Errors
/// [`AnalyzeError`] for an unknown scenario, a method that does not fit the train, or a `SOURCE_DATE_EPOCH` that is no date.
///
/// ```
/// use trainsafe::{Options, analyze, consist};
/// let train = consist::read("trains/ore-train.toml".as_ref())?;
/// let options = Options { scenario: Some("the rear is hit".to_owned()), ..Options::default() };
/// let case = &analyze(&train, &options)?.scenarios[0].cases[0];
/// // Every coupler has its largest forces in either sense, N, each right to the bound.
/// assert_eq!(case.couplers.len(), train.couplers().len());
/// assert!(case.error_bound_n <= case.tolerance_n);
/// let most_used = case.couplers.iter().map(|c| c.utilisation).fold(0.0, f64::max);
/// assert_eq!(case.worst.as_ref().map(|w| w.utilisation), Some(most_used));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn analyze(train: &Train, options: &Options) -> Result<Analysis, AnalyzeError> {
    let date = date::today().map_err(AnalyzeError::Date)?;
    let chosen = chosen(train, options)?;
    require_case(chosen.iter().copied())?;
    let about = |d: &Doubt| d.scenario.as_ref().is_none_or(|name| chosen.iter().any(|s| s.name == *name));
    let mut doubts: Vec<Doubt> = doubts::doubts(train).into_iter().filter(about).collect();
    let file = |source: &Source| InputFile { path: source.path.display().to_string(), sha256: hex(&source.sha256) };
    let inputs = train.origin().sources.iter().map(file).collect();
    let scenarios = chosen.iter().map(|s| scenario_findings(train, s, options));
    let scenarios: Vec<ScenarioFindings> = scenarios.collect::<Result<_, _>>()?;
    doubts.extend(chosen.iter().zip(&scenarios).flat_map(|(s, found)| doubts_found::found(train, s, &found.cases)));
    let (vehicles, couplers) = (train.vehicles().len(), train.couplers().len());
    Ok(Analysis {
        schema_version: 2,
        program: Program { name: env!("CARGO_PKG_NAME"), version: env!("CARGO_PKG_VERSION") },
        date,
        inputs,
        options: OptionFindings { tolerance: options.tolerance, method: options.method.map(Method::name) },
        doubts,
        units: train.origin().units,
        train: train.name().to_owned(),
        vehicles,
        couplers,
        scenarios,
    })
}

/// Checks that there is a case to run.
///
/// # Errors
/// [`AnalyzeError::NoCase`].
pub fn require_case<'s>(scenarios: impl IntoIterator<Item = &'s Scenario>) -> Result<(), AnalyzeError> {
    let has_case = scenarios.into_iter().any(|s| !cases(&s.event).is_empty());
    has_case.then_some(()).ok_or(AnalyzeError::NoCase)
}

/// The scenarios to run.
fn chosen<'a>(train: &'a Train, options: &Options) -> Result<Vec<&'a Scenario>, AnalyzeError> {
    let wanted = |s: &&Scenario| options.scenario.as_ref().is_none_or(|name| *name == s.name);
    let chosen: Vec<&Scenario> = train.scenarios().iter().filter(wanted).collect();
    match &options.scenario {
        Some(asked) if chosen.is_empty() => {
            let known = train.scenarios().iter().map(|s| format!("{:?}", s.name)).collect();
            Err(AnalyzeError::UnknownScenario { asked: asked.clone(), known })
        }
        _ => Ok(chosen),
    }
}

/// The couplers that break, each in a case of its own; `None` for a pulse.
pub(crate) fn cases(event: &Event) -> Vec<Option<usize>> {
    match event {
        Event::Break { couplers } => couplers.iter().map(|&b| Some(b)).collect(),
        Event::Pulse(_) | Event::Impact { .. } | Event::Brake { .. } => vec![None],
    }
}

/// The case whose worst coupler has the largest utilisation, with that coupler; of equal ones the first.
pub(crate) fn worst_case(cases: &[CaseFindings]) -> Option<(&CaseFindings, &CouplerFindings)> {
    let worst = cases.iter().filter_map(|case| Some((case, case.worst.as_ref()?)));
    worst.reduce(|a, b| if b.1.utilisation > a.1.utilisation { b } else { a })
}

/// The largest rating of any coupler in either sense.
fn largest_rating_n(train: &Train) -> f64 {
    train.couplers().iter().map(|c| c.rated_draft_n.max(c.rated_buff_n)).fold(0.0, f64::max)
}

/// The options of the solvers, in their units; results up to a mark, s, as well.
fn ask(train: &Train, scales: &Scales, options: &Options, mark_s: Option<f64>) -> Ask {
    Ask {
        tolerance: options.tolerance * largest_rating_n(train) / scales.force_n,
        mark: mark_s.map(|mark_s| mark_s / scales.time_s),
        method: options.method,
        verdict_only: options.verdict_only && !limits::any_below_rating(train),
        all_time_bound: options.all_time_bound,
        // To count the couplers that pass a limit, all are needed.
        wanted: if train.extras().limits.is_empty() { options.wanted } else { Wanted::Everything },
    }
}

fn scenario_findings(train: &Train, scenario: &Scenario, options: &Options) -> Result<ScenarioFindings, AnalyzeError> {
    let solve = |source| AnalyzeError::Solve { scenario: scenario.name.clone(), source };
    let cases = cases(&scenario.event)
        .par_chunks(cases_at_once(train, scenario))
        .map(|some| {
            options.stop.check()?;
            let found = cases_findings(train, scenario, some, options, Shared::Nothing);
            found.into_iter().collect::<Result<Vec<_>, _>>().map_err(solve)
        })
        .collect::<Result<Vec<_>, _>>()?;
    let cases: Vec<CaseFindings> = cases.into_iter().flatten().collect();
    options.stop.check()?;
    let map = if options.map { map::find(train, scenario, options) } else { Ok(None) };
    let map = map.map_err(solve)?;
    let (mut damping, mut variants) = (Vec::new(), Vec::new());
    if options.damping {
        damping = variants::damping(train, scenario, &cases, options).map_err(solve)?;
        variants = variants::variants(train, scenario, &cases, options).map_err(solve)?;
    }
    let left_out_in_buff = scenario.left_out_in_buff.iter().map(|i| i + 1).collect();
    let (name, kind) = (scenario.name.clone(), scenario.event.kind());
    Ok(ScenarioFindings { name, kind, cases, left_out_in_buff, map, damping, variants, evidence: OnceLock::new() })
}

/// The findings of the coupler of that number, if they are among these, which are in order from the head.
fn of_number(couplers: &[CouplerFindings], number: usize) -> Option<&CouplerFindings> {
    couplers.binary_search_by_key(&number, |c| c.coupler).ok().map(|i| &couplers[i])
}

/// The first of some couplers whose utilisation equals the largest within the error: symmetry makes many equal.
fn worst(
    couplers: &[CouplerFindings],
    of: impl IntoIterator<Item = usize, IntoIter: Clone>,
    error_bound_n: f64,
) -> Option<usize> {
    let of = of.into_iter();
    let largest = of.clone().map(|i| couplers[i].utilisation).fold(0.0, f64::max);
    let rating = |c: &CouplerFindings| if c.peak_force_n < 0.0 { c.rated_buff_n } else { c.rated_draft_n };
    let error_n = |c: &CouplerFindings| c.error_estimate_n.unwrap_or(error_bound_n);
    let alike = |c: &CouplerFindings| c.utilisation + error_n(c) / rating(c) >= largest;
    of.into_iter().find(|&i| alike(&couplers[i]))
}

/// A force within its error and under this share of a rating is 0.
const NOTHING: f64 = 1e-9;

impl CouplerFindings {
    /// Removes the largest force in the sense that has not the largest utilisation.
    fn keep_one_sense(&mut self) {
        if self.peak_force_n < 0.0 {
            (self.peak_draft_n, self.peak_draft_time_s) = (None, None);
        } else {
            (self.peak_buff_n, self.peak_buff_time_s) = (None, None);
        }
    }
}

/// Peaks and verdicts of a coupler, in draft and in buff.
struct CouplerPeaks {
    /// The largest F and the largest -F, N, of either sign, and when, s.
    largest: [(f64, f64); 2],
    /// Over the rating; `None`: not decided.
    exceeds: [Option<bool>; 2],
    /// When it is first over it, s.
    first_over_s: [Option<f64>; 2],
    /// Error of each of the largest, N.
    error_n: [f64; 2],
}

impl CouplerPeaks {
    fn new(peaks: &SpringPeaks, scales: &Scales, error_n: f64) -> CouplerPeaks {
        let sides = [&peaks.draft, &peaks.buff];
        CouplerPeaks {
            largest: sides.map(|side| (side.best.value * scales.force_n, side.best.at * scales.time_s)),
            exceeds: sides.map(Side::exceeds),
            first_over_s: sides.map(|side| side.first_over.map(|t| t * scales.time_s)),
            error_n: [error_n; 2],
        }
    }
}

fn coupler_findings(
    train: &Train,
    index: usize,
    coupler_peaks: &CouplerPeaks,
    all_time_bound_n: Option<f64>,
) -> CouplerFindings {
    let coupler = &train.couplers()[index];
    let ratings = [coupler.rated_draft_n, coupler.rated_buff_n];
    let extreme = |side: usize, sign: f64| {
        let (value, at) = coupler_peaks.largest[side];
        // A force after t = 0 may be only error; a large error must hide no force.
        let least_n = if at > 0.0 { coupler_peaks.error_n[side].min(NOTHING * ratings[side]) } else { 0.0 };
        (value > least_n).then_some((sign * value, at))
    };
    let (draft, buff) = (extreme(0, 1.0), extreme(1, -1.0));
    let use_of = |peak: Option<(f64, f64)>, rating: f64| peak.map_or(0.0, |(f, _)| f.abs() / rating);
    let (in_draft, in_buff) = (use_of(draft, coupler.rated_draft_n), use_of(buff, coupler.rated_buff_n));
    // If equal up to rounding, the earlier one.
    let equal = (in_buff - in_draft).abs() <= 1e-12 * in_buff;
    let buff_first = buff.zip(draft).is_some_and(|(b, d)| b.1 < d.1);
    let from_buff = if equal { buff_first } else { in_buff > in_draft };
    let (peak_force_n, peak_time_s) = if from_buff { buff } else { draft }.unwrap_or((0.0, 0.0));
    let exceeds_in = coupler_peaks.exceeds;
    let extremes_n = coupler_peaks.largest.map(|(value, _)| value);
    let exceeds = match exceeds_in {
        [Some(true), _] | [_, Some(true)] => Some(true),
        [Some(false), Some(false)] => Some(false),
        _ => None,
    };
    let firsts = [(coupler_peaks.first_over_s[0], "draft"), (coupler_peaks.first_over_s[1], "buff")];
    let firsts = firsts.into_iter().filter_map(|(at, sense)| Some((at?, sense)));
    let first = firsts.reduce(|a, b| if b.0 < a.0 { b } else { a });
    CouplerFindings {
        coupler: index + 1,
        between: [train.vehicles()[index].label.clone(), train.vehicles()[index + 1].label.clone()],
        rated_draft_n: coupler.rated_draft_n,
        rated_buff_n: coupler.rated_buff_n,
        initial_force_n: train.initial_force_n()[index],
        peak_force_n,
        peak_time_s,
        utilisation: in_draft.max(in_buff),
        peak_draft_n: draft.map(|p| p.0),
        peak_draft_time_s: draft.map(|p| p.1),
        peak_buff_n: buff.map(|p| p.0),
        peak_buff_time_s: buff.map(|p| p.1),
        exceeds,
        exceeds_in,
        extremes_n,
        first_exceeds_s: first.map(|(t, _)| t),
        first_exceeds_in: first.map(|(_, sense)| sense),
        first_passage: None,
        cascade: None,
        error_estimate_n: None,
        all_time_bound_n,
        limits: None,
    }
}
