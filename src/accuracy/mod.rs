//! Error against run time: this crate's methods beside those that engineers march trains with, on one part of a train.
//!
//! Every method runs the same scene: the longest part that the event leaves (for several broken couplers, of the case with
//! the longest part of all). Two errors are measured against a reference:
//!
//! - *peak*: the largest error in any coupler's largest tension or compression over the horizon, which is what an
//!   assessment needs. A marching method's peak is the best of its steps, as simulators report it.
//! - *force*: the largest error in a coupler's force at an instant: for a marching method at `INSTANTS` instants spread
//!   over the horizon, for this crate's at the instants of the extremes that it reports; of all couplers, or of
//!   `WATCHED` spread over a longer part.
//!
//! Trains with slack, gears or brakes, which the march follows from event to event, are compared as a whole, with the methods that
//! simulators use for them (module [`gears`]); forces at instants are compared for all methods alike.
//!
//! Run times are medians and cover the extremes of all couplers, from the scene to the result.

mod bench;
mod figure;
pub mod gears;
pub mod peers;
pub mod reference;
pub mod stress;
mod table;

use std::time::Duration;

use crate::report::WriteError;
use crate::scenario::{self, Motion, Part, Scales};
use crate::solve::{Method, SolveError, Work};
use crate::train::{Event, Rule, Scenario, Train};
use bench::Bench;
use reference::ReferenceError;

pub use figure::figure;
pub use table::{csv, markdown, terminal, write};

/// Instants at which a marching method's forces are compared.
pub(crate) const INSTANTS: usize = 64;
/// Couplers whose forces at instants are compared, at most.
pub(crate) const WATCHED: usize = 128;

/// A march ends where its estimate passes this share of the largest rating, as in an analysis.
const MARCH_TOLERANCE: f64 = 1e-6;

/// How much effort a comparison may take.
#[derive(Clone, Copy, Debug)]
pub struct AccuracyOptions {
    /// Timed runs of each method at each setting.
    pub runs: usize,
    /// No further run is begun after this time in one row.
    pub row_time: Duration,
    /// A march that would compute more accelerations than this is left out.
    pub most_accelerations: f64,
    /// The same of a march that looks forces up in a gear's curves, which costs ten times as much.
    pub most_look_ups: f64,
}

impl Default for AccuracyOptions {
    fn default() -> Self {
        AccuracyOptions { runs: 5, row_time: Duration::from_secs(2), most_accelerations: 3e9, most_look_ups: 3e8 }
    }
}

/// A method's origin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowOrigin {
    /// One of this crate's.
    Ours(Method),
    /// One of this crate's, chosen by its planner.
    Planner(Method),
    /// This crate's march from event to event.
    March,
    /// A marching method.
    Peer,
}

/// One method at one setting.
#[derive(Clone, Debug)]
pub struct MethodRow {
    /// Its origin.
    pub origin: RowOrigin,
    /// Its name.
    pub method: &'static str,
    /// Its setting in words.
    pub setting: String,
    /// The largest and the smallest tolerance, as shares of the largest rating, at which this crate's method does just this.
    pub tolerances: Option<[f64; 2]>,
    /// Median run time, s.
    pub run_time_s: f64,
    /// Timed runs.
    pub runs: usize,
    /// Counted work.
    pub work: Effort,
    /// Largest error in any coupler's peak, N.
    pub peak_error_n: f64,
    /// Largest error in any coupler's force at an instant, N.
    pub force_error_n: f64,
    /// What the method says its error is at most, N; `None` from a method that does not say.
    pub bound_n: Option<f64>,
    /// What it estimates its error to be, N; an estimate and no bound.
    pub estimate_n: Option<f64>,
}

impl MethodRow {
    /// The row of a method of simulators: its name and setting, its run time, s, with the number of runs, and its errors in peaks and
    /// in forces at instants, N.
    fn of_peer(
        (method, setting): (&'static str, String),
        marched: &peers::Marched,
        (run_time_s, runs): (f64, usize),
        [peak_error_n, force_error_n]: [f64; 2],
    ) -> MethodRow {
        MethodRow {
            origin: RowOrigin::Peer,
            method,
            setting,
            tolerances: None,
            run_time_s,
            runs,
            work: Effort::Accelerations(marched.accelerations),
            peak_error_n,
            force_error_n,
            bound_n: None,
            estimate_n: None,
        }
    }
}

/// Counted work; its unit depends on the method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// Accelerations of masses.
    Accelerations(u64),
    /// This crate's counts.
    Counted(Work),
    /// Steps of the march, and the events that ended them.
    Steps {
        /// Steps.
        steps: u64,
        /// Events.
        events: u64,
    },
}

/// A comparison.
#[derive(Clone, Debug)]
pub struct Accuracy {
    /// The train's name.
    pub train: String,
    /// The scenario's name.
    pub scenario: String,
    /// Followed by the march from event to event: all couplers, up to where forces can be predicted or a vehicle stops.
    pub is_march: bool,
    /// The coupler that breaks, counted from 1; `None` for another event.
    pub broken_coupler: Option<usize>,
    /// First and last coupler of the part, counted from 1.
    pub couplers: [usize; 2],
    /// How long forces were followed, s.
    pub horizon_s: f64,
    /// The largest rating in the train, N: what errors are given as shares of.
    pub rating_n: f64,
    /// The reference's own peaks could be larger by this at most, N; of a march, the largest difference of two references.
    pub doubt_n: f64,
    /// From coarse to fine, method by method.
    pub rows: Vec<MethodRow>,
    /// What was left out, and why.
    pub left_out: Vec<String>,
}

/// Why there is no comparison.
#[derive(Debug, thiserror::Error)]
pub enum AccuracyError {
    /// None of the train's scenarios has that name.
    #[error("no scenario is named {asked:?}; the train has {}", known.join(", "))]
    UnknownScenario {
        /// The name asked for.
        asked: String,
        /// The names there are, quoted.
        known: Vec<String>,
    },
    /// The event leaves no part with a coupler in it.
    #[error("{scenario}: no coupler is left to watch")]
    NothingToWatch {
        /// The scenario's name.
        scenario: String,
    },
    /// The event changes no force.
    #[error("{scenario}: the coupler that breaks carries no force, so nothing happens")]
    NothingHappens {
        /// The scenario's name.
        scenario: String,
    },
    /// The methods compared are not made for the train or the event.
    #[error(
        "{scenario}: the comparison is of methods for breaks and rectangular pulses of trains of linear couplers without damping, and for \
         trains with slack, gears or brakes"
    )]
    BeyondSteps {
        /// The scenario's name.
        scenario: String,
    },
    /// No method could be found for the scene.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// There is no reference for the scene.
    #[error(transparent)]
    Reference(#[from] ReferenceError),
    /// The reference would take too long.
    #[error(transparent)]
    TooManySteps(#[from] gears::exact::TooManySteps),
    /// The results could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// Compares all methods on a train's scenario, the first one if none is named.
///
/// # Errors
/// [`AccuracyError`] for an unknown scenario, one that leaves no coupler or changes no force, and a scene that the reference
/// refuses.
pub fn run(train: &Train, scenario_name: Option<&str>, options: &AccuracyOptions) -> Result<Accuracy, AccuracyError> {
    let chosen = choose(train, scenario_name)?;
    if !scenario::is_proportional(train, chosen) {
        return marches(train, chosen, options);
    }
    if Motion::of(train, chosen) != Motion::Steps {
        return Err(AccuracyError::BeyondSteps { scenario: chosen.name.clone() });
    }
    let Some((broken, part)) = longest_part(train, chosen) else {
        return Err(AccuracyError::NothingToWatch { scenario: chosen.name.clone() });
    };
    if part.scene.force == 0.0 {
        return Err(AccuracyError::NothingHappens { scenario: chosen.name.clone() });
    }
    let scales = Scales::of(train);
    let mut bench = Bench::new(&part.scene, scales.force_n, largest_rating(train), *options)?;
    bench.ours()?;
    bench.peers();
    let first = part.first_coupler + 1;
    Ok(Accuracy {
        train: train.name().to_owned(),
        scenario: chosen.name.clone(),
        is_march: false,
        broken_coupler: broken.map(|b| b + 1),
        couplers: [first, first + part.scene.initial.len() - 1],
        horizon_s: part.scene.horizon * scales.time_s,
        rating_n: largest_rating(train),
        doubt_n: bench.extremes.iter().flatten().map(|e| e.doubt).fold(0.0, f64::max) * scales.force_n,
        rows: bench.rows,
        left_out: bench.left_out,
    })
}

/// The comparison of a train that is marched from event to event: nothing breaks later.
fn marches(train: &Train, chosen: &Scenario, options: &AccuracyOptions) -> Result<Accuracy, AccuracyError> {
    let last = train.couplers().len();
    let broken = match &chosen.event {
        // The longest part of all cases, the first of equals.
        Event::Break { couplers } => couplers.iter().copied().reduce(|a, b| {
            let part = |b: usize| b.max(last - 1 - b);
            if part(b) > part(a) { b } else { a }
        }),
        _ => None,
    };
    let horizon_s = scenario::horizon_s(train, chosen, broken);
    let problem = scenario::march(train, chosen, broken, [horizon_s; 2], Rule::Keep);
    let rating_n = largest_rating(train);
    let mut bench = gears::bench::Bench::new(problem, MARCH_TOLERANCE * rating_n, *options)?;
    bench.ours();
    bench.peers();
    Ok(Accuracy {
        train: train.name().to_owned(),
        scenario: chosen.name.clone(),
        is_march: true,
        broken_coupler: broken.map(|b| b + 1),
        couplers: [1, last],
        horizon_s: bench.problem.horizon_s,
        rating_n,
        doubt_n: bench.reference.doubt_n,
        rows: bench.rows,
        left_out: bench.left_out,
    })
}

fn choose<'a>(train: &'a Train, scenario: Option<&str>) -> Result<&'a Scenario, AccuracyError> {
    let found = train.scenarios().iter().find(|s| scenario.is_none_or(|name| s.name == name));
    found.ok_or_else(|| AccuracyError::UnknownScenario {
        asked: scenario.unwrap_or_default().to_owned(),
        known: train.scenarios().iter().map(|s| format!("{:?}", s.name)).collect(),
    })
}

/// The longest part of all cases, the first of equals, with the coupler that breaks.
fn longest_part(train: &Train, scenario: &Scenario) -> Option<(Option<usize>, Part)> {
    let cases: Vec<Option<usize>> = match &scenario.event {
        Event::Break { couplers } => couplers.iter().map(|&b| Some(b)).collect(),
        Event::Pulse(_) | Event::Impact { .. } | Event::Brake { .. } => vec![None],
    };
    let parts = cases.into_iter().flat_map(|broken| {
        let horizon_s = scenario::horizon_s(train, scenario, broken);
        scenario::parts(train, &scenario.event, broken, horizon_s).into_iter().map(move |part| (broken, part))
    });
    parts.reduce(|a, b| if b.1.scene.initial.len() > a.1.scene.initial.len() { b } else { a })
}

fn largest_rating(train: &Train) -> f64 {
    train.couplers().iter().map(|c| c.rated_draft_n.max(c.rated_buff_n)).fold(0.0, f64::max)
}
