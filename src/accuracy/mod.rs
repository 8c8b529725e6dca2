//! Error against run time: this crate's methods beside those that engineers march trains with, on one part of a train.
//!
//! Every method runs the same scene: the longest part that the event leaves (for several broken couplers, of the case with
//! the longest part of all). Two errors are measured against a reference:
//!
//! - *peak*: the largest error in any coupler's largest tension or compression over the horizon, which is what an
//!   assessment needs. A marching method's peak is the best of its steps, as simulators report it.
//! - *force*: the largest error in any coupler's force at an instant: for a marching method at [`INSTANTS`] instants
//!   spread over the horizon, for this crate's at the instants of the extremes that it reports.
//!
//! Run times are medians and cover the extremes of all couplers, from the scene to the result.

pub mod campaign;
mod figure;
pub mod peers;
pub mod reference;
mod stand_in;
mod table;

use std::time::{Duration, Instant};

use crate::chain::Scene;
use crate::consist::Train;
use crate::scenario::{self, Event, Part, Scales, Scenario};
use crate::solve::{Ask, Method, Solution, SolveError, Work, solve};
use peers::Peer;
use stand_in::Reference;

pub use figure::figure;
pub use table::{csv, markdown, terminal, write};

/// Instants at which a marching method's forces are compared.
pub const INSTANTS: usize = 64;
/// Shares of the largest rating that this crate's methods are asked for.
const TOLERANCES: [f64; 4] = [1e-3, 1e-6, 1e-9, 1e-12];

/// How much effort a comparison may take.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Timed runs of each method at each setting.
    pub runs: usize,
    /// No further run is begun after this time in one row.
    pub row_time: Duration,
    /// A march that would compute more accelerations than this is left out.
    pub most_accelerations: f64,
}

impl Default for Options {
    fn default() -> Self {
        Options { runs: 5, row_time: Duration::from_secs(2), most_accelerations: 3e9 }
    }
}

/// Whose a method is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// One of this crate's.
    Ours(Method),
    /// One of this crate's, chosen by its planner.
    Planner(Method),
    /// A marching method.
    Peer,
}

/// One method at one setting.
#[derive(Clone, Debug)]
pub struct Row {
    /// Whose it is.
    pub origin: Origin,
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
}

/// Counted work, each in the method's own coin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// Accelerations of masses.
    Accelerations(u64),
    /// This crate's counts.
    Counted(Work),
}

/// A comparison.
#[derive(Clone, Debug)]
pub struct Accuracy {
    /// The train's name.
    pub train: String,
    /// The scenario's name.
    pub scenario: String,
    /// The coupler that breaks, counted from 1; `None` for a pulse.
    pub broken_coupler: Option<usize>,
    /// First and last coupler of the part, counted from 1.
    pub couplers: [usize; 2],
    /// How long forces were followed, s.
    pub horizon_s: f64,
    /// The largest rating in the train, N: what errors are given as shares of.
    pub rating_n: f64,
    /// From coarse to fine, method by method.
    pub rows: Vec<Row>,
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
    /// A method refused the scene.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// The results could not be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// Where.
        path: std::path::PathBuf,
        /// Why.
        source: std::io::Error,
    },
}

/// Compares all methods on a train's scenario, the first one if none is named.
///
/// # Errors
/// [`AccuracyError`] for an unknown scenario, or one that leaves no coupler.
pub fn run(train: &Train, scenario: Option<&str>, options: &Options) -> Result<Accuracy, AccuracyError> {
    let chosen = choose(train, scenario)?;
    let Some((broken, part)) = longest_part(train, chosen) else {
        return Err(AccuracyError::NothingToWatch { scenario: chosen.name.clone() });
    };
    let scales = Scales::of(train);
    let mut bench = Bench::new(&part.scene, scales.force_n, largest_rating(train), *options);
    bench.ours()?;
    bench.peers();
    let first = part.first_coupler + 1;
    Ok(Accuracy {
        train: train.name.clone(),
        scenario: chosen.name.clone(),
        broken_coupler: broken.map(|b| b + 1),
        couplers: [first, first + part.scene.initial.len() - 1],
        horizon_s: part.scene.horizon * scales.time_s,
        rating_n: bench.rating_n,
        rows: bench.rows,
        left_out: bench.left_out,
    })
}

fn choose<'a>(train: &'a Train, scenario: Option<&str>) -> Result<&'a Scenario, AccuracyError> {
    let found = train.scenarios.iter().find(|s| scenario.is_none_or(|name| s.name == name));
    found.ok_or_else(|| AccuracyError::UnknownScenario {
        asked: scenario.unwrap_or_default().to_owned(),
        known: train.scenarios.iter().map(|s| format!("{:?}", s.name)).collect(),
    })
}

/// The longest part of all cases, the first of equals, with the coupler that breaks.
fn longest_part(train: &Train, scenario: &Scenario) -> Option<(Option<usize>, Part)> {
    let cases: Vec<Option<usize>> = match &scenario.event {
        Event::Break { couplers } => couplers.iter().map(|&b| Some(b)).collect(),
        Event::Pulse { .. } => vec![None],
    };
    let parts = cases.into_iter().flat_map(|broken| {
        let horizon_s = scenario::horizon_s(train, scenario, broken);
        scenario::parts(train, &scenario.event, broken, horizon_s).into_iter().map(move |part| (broken, part))
    });
    parts.reduce(|a, b| if b.1.scene.initial.len() > a.1.scene.initial.len() { b } else { a })
}

fn largest_rating(train: &Train) -> f64 {
    train.couplers.iter().map(|c| c.rated_draft_n.max(c.rated_buff_n)).fold(0.0, f64::max)
}

/// One scene on which methods are measured.
struct Bench<'a> {
    scene: &'a Scene,
    reference: Reference<'a>,
    /// The instants at which a march's forces are compared, and the reference's spring forces there.
    times: Vec<f64>,
    force_n: f64,
    rating_n: f64,
    options: Options,
    rows: Vec<Row>,
    left_out: Vec<String>,
}

impl<'a> Bench<'a> {
    fn new(scene: &'a Scene, force_n: f64, rating_n: f64, options: Options) -> Bench<'a> {
        let times = (1..=INSTANTS).map(|i| scene.horizon * i as f64 / INSTANTS as f64).collect();
        let reference = Reference::new(scene);
        Bench { scene, reference, times, force_n, rating_n, options, rows: vec![], left_out: vec![] }
    }

    /// This crate's methods that fit the scene, and the planner's choice; what a tolerance does not change is one row.
    fn ours(&mut self) -> Result<(), SolveError> {
        let methods = [Method::ClosedForm, Method::Fronts, Method::Modal, Method::Propagator];
        for method in methods.into_iter().map(Some).chain([None]) {
            let from = self.rows.len();
            for tolerance in TOLERANCES {
                match (self.solution(method, tolerance), method) {
                    (Ok(solution), _) => self.add(method, tolerance, &solution, from),
                    // A method for equal chains has no row on another.
                    (Err(SolveError::NotEqual(_)), Some(_)) => break,
                    (Err(error), Some(method)) => {
                        self.left_out.push(format!("{}: {error}", method.name()));
                        break;
                    }
                    (Err(error), None) => return Err(error),
                }
            }
        }
        Ok(())
    }

    fn solution(&self, method: Option<Method>, tolerance: f64) -> Result<Solution, SolveError> {
        let tolerance = tolerance * self.rating_n / self.force_n;
        solve(self.scene, &Ask { tolerance, method, verdict_only: false, all_time_bound: false })
    }

    /// A row for a solution, or a wider range of tolerances for the same one among the rows from `from` on.
    fn add(&mut self, method: Option<Method>, tolerance: f64, solution: &Solution, from: usize) {
        let bound_n = solution.error_bound * self.force_n;
        let same = |row: &&mut Row| {
            row.method == solution.method.name()
                && row.work == Effort::Counted(solution.work)
                && row.bound_n == Some(bound_n)
        };
        if let Some(row) = self.rows[from..].last_mut().filter(same) {
            let loosest = row.tolerances.map_or(tolerance, |t| t[0]);
            row.tolerances = Some([loosest, tolerance]);
            row.setting = format!("tolerance {loosest:e} to {tolerance:e}");
            return;
        }
        let (run_time_s, runs) = self.time(|| drop(self.solution(method, tolerance)));
        let row = self.our_row(method.is_none(), tolerance, solution, run_time_s, runs);
        self.rows.push(row);
    }

    fn our_row(&self, planner: bool, tolerance: f64, solution: &Solution, run_time_s: f64, runs: usize) -> Row {
        let method = solution.method;
        let [mut peak, mut force] = [0.0f64; 2];
        for (i, exact) in self.reference.extremes().iter().enumerate() {
            for (negative, sign) in [(false, 1.0), (true, -1.0)] {
                if let Some(found) = solution.springs[i] {
                    let best = found.side(negative).best;
                    let at_peak = self.reference.error_of(i, exact[usize::from(negative)].at, sign * best.value);
                    peak = peak.max(at_peak.abs());
                    force = force.max(self.reference.error_of(i, best.at, sign * best.value).abs());
                }
            }
        }
        Row {
            origin: if planner { Origin::Planner(method) } else { Origin::Ours(method) },
            method: method.name(),
            setting: format!("tolerance {tolerance:e}"),
            tolerances: Some([tolerance; 2]),
            run_time_s,
            runs,
            work: Effort::Counted(solution.work),
            peak_error_n: peak * self.force_n,
            force_error_n: force * self.force_n,
            bound_n: Some(solution.error_bound * self.force_n),
        }
    }

    /// The marching methods.
    fn peers(&mut self) {
        for peer in Peer::all() {
            let name = format!("{}, {}", peer.name(), peer.setting());
            let expected = peer.estimated_accelerations(self.scene);
            if expected > self.options.most_accelerations {
                self.left_out.push(format!("{name}: it would compute some {expected:.0e} accelerations"));
                continue;
            }
            let marched = match peer.march(self.scene, &self.times) {
                Ok(marched) => marched,
                Err(error) => {
                    self.left_out.push(format!("{name}: {error}"));
                    continue;
                }
            };
            let (run_time_s, runs) = self.time(|| drop(peer.march(self.scene, &[])));
            let row = self.peer_row(peer, &marched, run_time_s, runs);
            self.rows.push(row);
        }
    }

    fn peer_row(&self, peer: Peer, marched: &peers::Marched, run_time_s: f64, runs: usize) -> Row {
        let extremes = self.reference.extremes().iter().zip(&marched.extremes).enumerate();
        let peaks = extremes.flat_map(|(i, (exact, found))| {
            [self.reference.error_of(i, exact[0].at, found[0]), self.reference.error_of(i, exact[1].at, -found[1])]
        });
        let instants =
            self.times.iter().zip(&marched.forces).flat_map(|(&t, forces)| {
                forces.iter().enumerate().map(move |(i, &f)| self.reference.error_of(i, t, f))
            });
        let largest = |errors: &mut dyn Iterator<Item = f64>| errors.map(f64::abs).fold(0.0, f64::max);
        Row {
            origin: Origin::Peer,
            method: peer.name(),
            setting: peer.setting(),
            tolerances: None,
            run_time_s,
            runs,
            work: Effort::Accelerations(marched.accelerations),
            peak_error_n: largest(&mut peaks.into_iter()) * self.force_n,
            force_error_n: largest(&mut instants.into_iter()) * self.force_n,
            bound_n: None,
        }
    }

    /// Median run time, s, and the number of runs.
    fn time(&self, run: impl Fn()) -> (f64, usize) {
        let begin = Instant::now();
        let mut seconds = Vec::with_capacity(self.options.runs);
        while seconds.is_empty() || seconds.len() < self.options.runs && begin.elapsed() < self.options.row_time {
            let start = Instant::now();
            run();
            seconds.push(start.elapsed().as_secs_f64());
        }
        seconds.sort_by(f64::total_cmp);
        (seconds[seconds.len() / 2], seconds.len())
    }
}
