//! Every spring's largest forces in a scene, with a bound on their error: one method a file, and the planner.
//!
//! | method | what it does | equal chains only | work |
//! | --- | --- | --- | --- |
//! | [`Method::Fronts`] | sums of travelling Bessel fronts, a force on a free end | yes | springs x passing fronts; the cube of many |
//! | [`Method::Modal`] | sums over modes, by the paper's formula or found numerically | no | springs x modes x instants, and the modes |
//! | [`Method::Propagator`] | steps that are exact in time | no | springs that waves reach x steps |
//!
//! Beyond steps of force on undamped chains [`damped_modes`] sums modes that all have the same damping ratio; all else is marched, by
//! [`crate::march`]. Many loads and ratings of a chain are judged from its [`response`] to a unit force, marched once.

pub mod between;
pub mod closed_form;
pub mod damped_modes;
pub mod dd;
pub mod field;
pub mod foresee;
pub mod fronts;
mod lanes;
pub mod local;
pub mod modal;
pub mod motion;
pub mod observers;
pub mod path;
pub mod pieces;
pub mod plan;
pub mod propagator;
pub mod response;
pub mod responses;
pub mod search;
pub mod series;
pub mod statics;
pub mod sums;
pub mod vectors;
mod view;
pub mod watch;

use crate::chain::Scene;
use watch::SpringPeaks;

/// A way to compute coupler forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Method {
    /// Sums of travelling Bessel fronts for equal masses and stiffnesses.
    Fronts,
    /// A sum over vibration modes, any chain.
    Modal,
    /// Time steps that are exact in time, any chain.
    Propagator,
}

impl Method {
    /// All of them.
    pub const ALL: [Method; 3] = [Method::Fronts, Method::Modal, Method::Propagator];

    /// The method of that name, if there is one.
    pub fn from_name(name: &str) -> Option<Method> {
        Method::ALL.into_iter().find(|m| m.name() == name)
    }

    /// The name on the command line and in results.
    pub fn name(self) -> &'static str {
        match self {
            Method::Fronts => "fronts",
            Method::Modal => "modal",
            Method::Propagator => "propagator",
        }
    }
}

/// Counted work, the same on every machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Products in sums over modes.
    pub mode_sums: u64,
    /// Spring values computed while marching through time.
    pub marched: u64,
    /// Steps of a spring in which a march's quick bounds leave open whether its force matters there.
    pub considered: u64,
    /// Those that were kept to be looked into, of each sense.
    pub kept: u64,
    /// Pieces of time examined closely.
    pub refinements: u64,
}

/// Which results must be exact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wanted {
    /// All.
    #[default]
    Everything,
    /// The largest utilisation with its spring and time, those that differ from it by less than the error bound, whether each
    /// spring exceeds its rating, and the earliest instant at which one does. These are identical to those of
    /// [`Wanted::Everything`], except where a spring has peaks that differ by less than the error bound: then another of
    /// these peaks may be given. Other extremes are at most the true ones, or left out where they are under the rating, and other
    /// first exceedances may be late. Ratings are finite.
    Worst,
}

/// What is asked of a solution.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ask {
    /// The error that each force may have, in the scene's unit of force.
    pub tolerance: f64,
    /// A method to use even where another needs less work.
    pub method: Option<Method>,
    /// Leave out springs whose all-time bound is under their ratings, where the bounds take less work than the search.
    pub verdict_only: bool,
    /// Give every spring's all-time bound.
    pub all_time_bound: bool,
    /// Which springs' extremes are to be exact.
    pub wanted: Wanted,
    /// An instant before the horizon up to which extremes are wanted as well, in the scene's unit of time.
    pub mark: Option<f64>,
}

/// Extremes of every spring of a scene.
#[derive(Clone, Debug)]
pub struct Solution {
    /// How they were found.
    pub method: Method,
    /// Why that method.
    pub reason: String,
    /// No extreme is further than this from the exact one, in the scene's unit of force.
    pub error_bound: f64,
    /// One per spring; `None` where it was left out.
    pub springs: Vec<Option<SpringPeaks>>,
    /// The same up to the mark; empty without one.
    pub to_mark: Vec<Option<SpringPeaks>>,
    /// Only what [`Wanted::Worst`] promises is exact; of the worst spring only the extreme in the sense, draft or buff, that gives its
    /// largest utilisation.
    pub only_worst: bool,
    /// Bound on |F| over all time, in the scene's unit of force, where asked for or used to leave springs out.
    pub all_time_bounds: Option<Vec<f64>>,
    /// The work done.
    pub work: Work,
}

/// Why a scene cannot be solved.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum SolveError {
    /// The method needs equal masses and equal stiffnesses.
    #[error("the method {0} is for equal masses and stiffnesses, and this train's differ: use modal or propagator")]
    NotEqual(&'static str),
    /// The method is for steps of force on undamped chains.
    #[error(
        "the method {0} is for breaks and rectangular pulses of linear couplers, without dashpots and brakes: leave the choice to the program"
    )]
    StepsOnly(&'static str),
    /// The pulse is too short for fronts.
    #[error("fronts need a pulse of a fifth of sqrt(mass / stiffness) or longer: use modal or propagator")]
    TooShort,
    /// Fronts start at a free end.
    #[error("fronts need the force on a free end of the train: use modal or propagator")]
    NotAtEnd,
    /// The method would take too long or too much memory.
    #[error("the method {method} would take about {seconds:.0} s and {gigabytes:.1} GB here: {advice}")]
    TooMuch {
        /// Its name.
        method: &'static str,
        /// Estimated time.
        seconds: f64,
        /// Estimated memory.
        gigabytes: f64,
        /// What to do instead.
        advice: String,
    },
}

/// Extremes of every spring of a scene, by the requested method or the cheapest that reaches the tolerance.
///
/// # Errors
/// [`SolveError::NotEqual`], [`SolveError::NotAtEnd`] or [`SolveError::TooShort`] when the method that is asked for does not fit the
/// scene; [`SolveError::TooMuch`] when it, or else the cheapest method, would take over an hour or over 4 GB.
///
/// A mass on a spring from a wall, pulled away by a unit step of force, `F(t) = 1 - cos t`:
///
/// ```
/// use trainsafe::chain::{Chain, Scene};
/// use trainsafe::solve::{Ask, solve};
/// let chain = Chain { mass: vec![1.0; 2], stiffness: vec![1.0], held_head: true, held_tail: false };
/// let (source, force, duration, horizon) = (1, -1.0, f64::INFINITY, 10.0);
/// let (initial, rated_draft, rated_buff) = (vec![0.0], vec![1.5], vec![1.5]);
/// let scene = Scene { chain, source, force, duration, initial, rated_draft, rated_buff, horizon };
/// let solution = solve(&scene, &Ask { tolerance: 1e-12, ..Ask::default() })?;
/// let draft = &solution.springs[0].as_ref().expect("not left out").draft;
/// assert!((draft.best.value - 2.0).abs() <= solution.error_bound && solution.error_bound <= 1e-12);
/// assert!((draft.first_over.expect("2 is over 1.5") - (-0.5f64).acos()).abs() < 1e-9);
/// # Ok::<(), trainsafe::solve::SolveError>(())
/// ```
pub fn solve(scene: &Scene, ask: &Ask) -> Result<Solution, SolveError> {
    // One scene has one result.
    solve_all(&[(scene, *ask)]).pop().unwrap_or_else(|| Ok(at_rest(scene, ask)))
}

/// [`solve`] for several scenes. Breaks of chains of similar length that are marched take less time together; their results may differ from
/// those of [`solve`] within the error bound, as other bounds decide which steps are looked into.
pub fn solve_all(scenes: &[(&Scene, Ask)]) -> Vec<Result<Solution, SolveError>> {
    let mut solved = Vec::with_capacity(scenes.len());
    let mut planned = Vec::with_capacity(scenes.len());
    for &(scene, ask) in scenes {
        let plan = if scene.force == 0.0 { None } else { Some(plan::choose(scene, &ask)) };
        solved.push(match plan {
            None => Some(Ok(at_rest(scene, &ask))),
            Some(Err(error)) => Some(Err(error)),
            Some(Ok(plan)) => {
                planned.push(plan::Planned { scene, ask, plan });
                None
            }
        });
    }
    let mut solutions = plan::run_all(&planned).into_iter();
    solved.into_iter().filter_map(|solved| solved.or_else(|| solutions.next().map(Ok))).collect()
}

/// Of how many breaks of a train with so many couplers to give [`solve_all`] the scenes at once.
pub fn side_by_side(springs: usize) -> usize {
    if springs <= plan::MOST_ROWS { lanes::LANES } else { 1 }
}

/// Estimated time of [`solve`], s, from the count of its work.
///
/// # Errors
/// As for [`solve`].
pub fn estimate_s(scene: &Scene, ask: &Ask) -> Result<f64, SolveError> {
    if scene.force == 0.0 {
        return Ok(0.0);
    }
    Ok(plan::choose(scene, ask)?.seconds)
}

/// Nothing happens: every spring keeps its force.
fn at_rest(scene: &Scene, ask: &Ask) -> Solution {
    let springs: Vec<_> = watch::Watch::new(scene, 0.0).peaks.into_iter().map(Some).collect();
    Solution {
        method: Method::Propagator,
        reason: "the event brings no force: nothing changes".to_owned(),
        error_bound: 0.0,
        only_worst: false,
        to_mark: ask.mark.map_or_else(Vec::new, |_| springs.clone()),
        springs,
        all_time_bounds: ask.all_time_bound.then(|| scene.initial.iter().map(|f| f.abs()).collect()),
        work: Work::default(),
    }
}

/// Forces in one spring at given times.
pub fn history(scene: &Scene, spring: usize, times: &[f64]) -> Vec<f64> {
    if scene.force == 0.0 {
        return vec![scene.initial[spring]; times.len()];
    }
    plan::history(scene, spring, times)
}
