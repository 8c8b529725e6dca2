//! Steps by Taylor series, for any chain: dashpots, initial speeds, forces of any shape, couplers that break on the way.
//!
//! Spring forces F and speeds v obey a linear system of first order,
//!
//! ```text
//! F_i' = k_i (v_i - v_{i+1})     m_j v_j' = T_{j-1} - T_j + f     T_i = F_i + c_i (v_i - v_{i+1})
//! ```
//!
//! in which F and v are counted from the steady state under the steady forces p_j from outside, `Fs_{j-1} - Fs_j + p_j = m_j a`,
//! with one acceleration a for the whole chain (0 where a mass is held). A coupler's force is `Fs_i + T_i`. The motion starts at
//! given speeds and at `F_i(0) = initial_i - Fs_i`. This is 0 unless the forces at t = 0 do not balance p: after an impact of two
//! parts whose accelerations before it differ. The derivatives follow from one another, each from its neighbours: a step costs O(n), its series is the force at every
//! instant of it, and nothing but the present state is kept. A step is no longer than `1 / W`, W = largest frequency and damping
//! rate together, so that the terms fall as `1 / k!`.
//!
//! **Error.** In the norm `|z|^2 = sum F^2 / k + sum m v^2` (twice the energy) springs only turn a deviation and dashpots only
//! shorten it. A step's own rounding is, in that norm and in units of half a last place:
//!
//! - first terms: 6 roundings of differences, products and sums, each of at most `h S`, `S = (1 + 2 r) D + J sup|f|`; D bounds
//!   the norm of z' (constant but for the drive's own changes: `D(0) + J TV(f)`, D(0) from the speeds and forces F at t = 0), r = max c / sqrt(k m) the dashpots' share,
//!   J = 1 / sqrt(m) of the source. The later terms carry them on, `e - 1` times in all;
//! - later terms: 5 roundings each, `sum (k - 1) / k! = 1` times `h S`;
//! - the sum of the terms from the last to the first: at most `1.72 + 0.72 + 0.22 + ... < 2.8` times; the compensated sum with the
//!   state `1.72`; the instant of the step's end, `u t`, another 1.
//!
//! That is less than 24 units of `h S` a step; the first term left out is `1 / 21! = 2e-20`. Errors add up without growing:
//! `|error| <= 24 u S t`, and beside that, where F(0) is not 0, the rounding of F(0). A coupler's force is at most `sqrt(k + c^2 (1 / m + 1 / m'))` times the norm off.
//!
//! **Breaks.** A coupler whose force passes its rating breaks. Its instant is known to within delta, the time in which its computed
//! force is within the bound of the rating; over that time the computed and the true train differ by that coupler's force T on both
//! its masses, so that the error's norm grows by at most `delta T sqrt(1 / m + 1 / m')`. This supposes that it breaks in the true
//! train too, whatever else may break there before it: `certain.rs` proves that, or leaves the sequence undecided. D grows by
//! `T sqrt(1 / m + 1 / m')` at each break. Parts never touch again in this model: `gaps.rs` tells when they would.

mod certain;
mod gaps;
mod search;
mod series;

use super::dd::Dd;
use super::path::Path;
use super::watch::{SpringPeaks, Watch, bound_of_extremes};
use super::{SolveError, Work};
use crate::play::{Play, Rule, Stretch};
use series::{Series, State, centred, reach};

pub use search::Breakage;
use search::Breaks;

/// The series' last power.
const DEGREE: usize = 20;
/// Largest step times the largest rate.
const PHASE: f64 = 1.0;
/// Roundings of a step; see above.
const ROUNDINGS: f64 = 24.0;
/// Nanoseconds for one spring in one step.
const SPRING_STEP: f64 = 150.0;
/// The longest that a play may take, s.
const MOST_SECONDS: f64 = 3600.0;
/// `u`, half a unit in the last place.
const U: f64 = f64::EPSILON / 2.0;

/// The result of a play.
#[derive(Clone, Debug)]
pub struct TaylorOutcome {
    /// Extremes of every spring's force, until it breaks.
    pub springs: Vec<SpringPeaks>,
    /// The same up to a mark; empty without one.
    pub to_mark: Vec<SpringPeaks>,
    /// What broke, in order; those of t = 0 first.
    pub breakages: Vec<Breakage>,
    /// The first coupler that came within the bound of its rating and was not seen to pass it, and when: from then on what
    /// breaks is not decided.
    pub open: Option<(usize, f64)>,
    /// The first gap at a broken coupler that closes, and when: the pieces would push each other from then on, which is not
    /// computed. Looked for with a rule of breaking only.
    pub gap_closes: Option<(usize, f64)>,
    /// No force is further than this from the exact one.
    pub error_bound: f64,
    /// The work done.
    pub work: Work,
}

/// A step, or its first part: valid from `from` to `from + end * width`.
struct Piece<'a> {
    from: f64,
    width: f64,
    end: f64,
    state: &'a State,
    series: &'a Series,
}

/// Rates that bound steps and errors.
#[derive(Clone, Copy, Debug)]
struct Rates {
    /// Largest frequency and damping rate together.
    largest: f64,
    /// `max c / sqrt(k m)`
    drag: f64,
    /// A coupler's force per unit of norm.
    force: f64,
    /// `1 / sqrt(m)` of the source.
    root_inverse_mass: f64,
}

impl Rates {
    fn new(play: &Play) -> Rates {
        let chain = &play.scene.chain;
        let inverse = |v: usize| if chain.live(v) { 1.0 / chain.mass[v] } else { 0.0 };
        let springs = chain.stiffness.iter().zip(&play.dashpot).enumerate();
        let (mut drag, mut force) = (0.0f64, 0.0f64);
        let mut damping = vec![0.0; chain.mass.len()];
        for (i, (&k, &c)) in springs {
            let (ahead, behind) = (inverse(i), inverse(i + 1));
            drag = drag.max(c * (ahead.max(behind) / k).sqrt());
            force = force.max((k + c * c * (ahead + behind)).sqrt());
            damping[i] += 2.0 * c * ahead;
            damping[i + 1] += 2.0 * c * behind;
        }
        let largest = Path::new(chain).omega_max() + damping.into_iter().fold(0.0, f64::max);
        Rates { largest, drag, force, root_inverse_mass: inverse(play.scene.source).sqrt() }
    }

    /// Steps of a stretch.
    fn steps(&self, stretch: &Stretch, from: f64) -> f64 {
        ((stretch.to - from) * self.largest.max(stretch.frequency()) / PHASE).ceil().max(1.0)
    }
}

/// Estimated time, s.
pub fn estimate_s(play: &Play) -> f64 {
    let rates = Rates::new(play);
    let steps: f64 = play.drive.stretches(play.scene.horizon).iter().map(|s| rates.steps(s, s.from)).sum();
    let marches = if play.rule == Rule::Keep { 1.0 } else { 2.0 };
    1e-9 * SPRING_STEP * steps * play.scene.initial.len() as f64 * marches
}

/// Extremes of every coupler's force, and what breaks.
///
/// # Errors
/// As for `solve_to_mark`.
pub fn solve(play: &Play) -> Result<TaylorOutcome, SolveError> {
    solve_to_mark(play, None)
}

/// Extremes of every coupler's force, up to a mark before the horizon as well, and what breaks.
///
/// With a rule of breaking the motion is followed twice: the bound that the extremes need is known only when all breaks are.
///
/// # Errors
/// [`SolveError::TooMuch`] when it would run for hours.
pub(crate) fn solve_to_mark(play: &Play, mark: Option<f64>) -> Result<TaylorOutcome, SolveError> {
    let seconds = estimate_s(play);
    if seconds > MOST_SECONDS {
        let advice = "a shorter horizon takes less, in proportion".to_owned();
        return Err(SolveError::TooMuch { method: "taylor", seconds, gigabytes: 0.0, advice });
    }
    let first = if play.rule == Rule::Keep { start(play) } else { march(play, &mut |_| {}) };
    let mut watch = Watch::new(&play.scene, first.bound);
    let mut work = Work::default();
    let mut to_mark = None;
    march(play, &mut |piece| {
        let until = piece.from + piece.end * piece.width;
        if let Some(mark) = mark.filter(|mark| piece.from < *mark && *mark <= until) {
            let mut watch = watch.until(mark);
            look(play, &mut watch, &Piece { end: (mark - piece.from) / piece.width, ..*piece }, &mut work);
            to_mark = Some(watch);
        }
        look(play, &mut watch, piece, &mut work);
    });
    let decided = |mut watch: Watch| {
        watch.decide_all_at_rating();
        watch.peaks
    };
    let March { breakages, open, gap_closes, bound } = first;
    let error_bound = bound_of_extremes(bound);
    // The last step may round to end just before a mark.
    let to_mark = mark.map_or_else(Vec::new, |_| decided(to_mark.unwrap_or_else(|| watch.clone())));
    Ok(TaylorOutcome { springs: decided(watch), to_mark, breakages, open, gap_closes, error_bound, work })
}

/// Force of one coupler at given times, ascending; zero once it is broken.
pub fn history(play: &Play, spring: usize, times: &[f64]) -> Vec<f64> {
    let mut values = Vec::with_capacity(times.len());
    let steady = play.steady(spring);
    march(play, &mut |piece| {
        let until = piece.from + piece.end * piece.width;
        let whole = piece.state.whole(spring);
        let coefficient = piece.series.coupler(spring, steady);
        while let Some(&t) = times.get(values.len()).filter(|t| **t <= until) {
            let s = (t - piece.from) / piece.width;
            values.push(if whole { coefficient.iter().rev().fold(0.0, |sum, c| sum * s + c) } else { 0.0 });
        }
    });
    // The horizon may round to just before the last time asked for.
    let last = values.last().copied().unwrap_or(play.scene.initial[spring]);
    values.resize(times.len(), last);
    values
}

/// Forces of every coupler at given times, ascending; NaN once it is broken.
pub fn field(play: &Play, times: &[f64], see: &mut dyn FnMut(usize, usize, f64)) {
    let mut next = 0;
    march(play, &mut |piece| {
        let until = piece.from + piece.end * piece.width;
        // The horizon may round to just before the last time.
        let last = until + 0.5 * piece.width > play.scene.horizon;
        let from = next;
        next += times[from..].iter().take_while(|t| last || **t <= until).count();
        for i in (0..play.scene.initial.len()).filter(|_| next > from) {
            let coefficient = piece.series.coupler(i, play.steady(i));
            for (n, t) in times.iter().enumerate().take(next).skip(from) {
                let s = (t - piece.from) / piece.width;
                let force = coefficient.iter().rev().fold(0.0, |sum, c| sum * s + c);
                see(n, i, if piece.state.whole(i) { force } else { f64::NAN });
            }
        }
    });
}

/// Shows a piece of every whole coupler's force to the watch.
fn look(play: &Play, watch: &mut Watch, piece: &Piece, work: &mut Work) {
    let springs = play.scene.initial.len();
    work.marched += springs as u64;
    for i in (0..springs).filter(|&i| piece.state.whole(i)) {
        let coefficient = piece.series.coupler(i, play.steady(i));
        let at = |s: f64| coefficient.iter().rev().fold(0.0, |sum, c| sum * s + c);
        for negative in [false, true] {
            let sign = if negative { -1.0 } else { 1.0 };
            if watch.at_rating(i, negative) {
                let force = at(piece.end);
                watch.note_push(i, negative, sign * (force - play.scene.initial[i]), sign * force);
            }
            if reach(&coefficient, sign) > watch.level(i, negative) {
                work.refinements += 1;
                let local = centred(&coefficient, piece.from, piece.width);
                let exact = |t: Dd| at((t - Dd::from(piece.from)).to_f64() / piece.width);
                watch.note(i, negative, &local, 2.0 * piece.end - 1.0, exact);
            } else if watch.at_rating(i, negative) {
                watch.note_left_rating(i, negative, sign * at(piece.end));
            }
        }
    }
}

/// The result of a march.
struct March {
    breakages: Vec<Breakage>,
    open: Option<(usize, f64)>,
    gap_closes: Option<(usize, f64)>,
    bound: f64,
}

/// What is known before the first step.
fn start(play: &Play) -> March {
    let mut state = State::new(play);
    let mut series = Series::new(play.scene.chain.mass.len());
    let breaks = Breaks::new(play, Rates::new(play), &mut state, &mut series);
    March { bound: breaks.bound(), open: None, gap_closes: None, breakages: Vec::new() }
}

/// Runs through the horizon and shows every step.
fn march(play: &Play, see: &mut dyn FnMut(&Piece)) -> March {
    let rates = Rates::new(play);
    let mut state = State::new(play);
    let mut series = Series::new(play.scene.chain.mass.len());
    let mut breaks = Breaks::new(play, rates, &mut state, &mut series);
    for stretch in play.drive.stretches(play.scene.horizon) {
        let mut from = stretch.from;
        while from < stretch.to {
            // Again after each break; after one at the very end nothing is left of the stretch.
            let count = rates.steps(&stretch, from);
            let width = (stretch.to - from) / count;
            let start = from;
            from = stretch.to;
            for n in 0..count as u64 {
                let at = start + n as f64 * width;
                series.expand(&state, width, |out| stretch.taylor(at, width, out));
                let found = breaks.find(&state, &series, at, width);
                let end = found.as_ref().map_or(1.0, |f| f.share);
                see(&Piece { from: at, width, end, state: &state, series: &series });
                breaks.follow_gaps(&state, &series, at, width, end);
                series.advance(&mut state, end);
                if let Some(found) = found {
                    from = at + end * width;
                    breaks.apply(found, from, &mut state, &mut series);
                    break;
                }
            }
        }
    }
    let (bound, open) = (breaks.bound(), breaks.open());
    March { bound, open, gap_closes: breaks.gaps.closes, breakages: breaks.breakages }
}
