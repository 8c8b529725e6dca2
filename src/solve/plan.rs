//! Which method a scene needs: the cheapest that reaches the tolerance, by counted work.
//!
//! Every method's work is counted before it is done; a price per unit of work, measured once on one machine and the same
//! for everyone, makes the counts comparable. The choice therefore depends on the scene alone, not on the machine or on what else runs on it.

use super::lanes::LANES;
use super::observers::{MarchAsk, Peaks};
use super::watch::{SpringPeaks, bound_of_extremes, bound_of_pieces};
use super::{
    Ask, Method, Solution, SolveError, Wanted, Work, closed_form, fronts, modal, observers, propagator, search, sums,
};
use crate::chain::Scene;

/// Nanoseconds for one spring in one exact step.
const STEP: f64 = 3.5;
/// Nanoseconds for one spring and one front that passes it.
const FRONT: f64 = 850.0;
/// Nanoseconds for one spring and three fronts: more fronts make more windows in which their sums have to be told apart.
const TRIPLE: f64 = 12.0;
/// Nanoseconds for the Bessel functions of all orders up to the horizon in `sqrt(m / k)`, per square of it.
const ORDERS: f64 = 0.006;
/// Nanoseconds to find one entry of one vibration mode by its formula, for equal chains.
const EQUAL_ENTRY: f64 = 20.0;
/// Nanoseconds to look into one spring's forces between instants.
const LOOK: f64 = 4500.0;
/// A better bound may cost this many times the cheapest method whose bound is within 10 times the tolerance, or within
/// 1e-8 of the force if that is more.
const MAX_WORK_RATIO: f64 = 10.0;
const NEAR_FACTOR: f64 = 10.0;
const FINE_SHARE: f64 = 1e-9;
/// Of a tolerance over 1e-8 of the largest force or rating, the share up to which differences in force are ignored.
const IGNORED_SHARE: f64 = 0.9;
/// The longest that a scene may take, and the memory that its modes may fill.
const MOST_SECONDS: f64 = 3600.0;
const MOST_GIGABYTES: f64 = 4.0;

/// A march through one chain in pieces takes as much work as so many rows more than those of a piece.
const PIECES_ROWS: usize = 5;
/// Longer chains do not fit the fast memory side by side.
pub const MOST_ROWS: usize = 256;

/// What was chosen.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The method.
    pub method: Method,
    /// Why.
    pub reason: String,
    /// Estimated time, s; for a sum over modes, that of the longest search: as if all modes beyond a gap mattered.
    pub seconds: f64,
    /// Largest frequency, for the propagator.
    omega_max: f64,
}

/// A method's estimated work for a scene, and the bound on its error.
#[derive(Clone, Copy, Debug)]
struct Offer {
    method: Method,
    nanoseconds: f64,
    /// A bound on its error known beforehand; for sums over modes an estimate of it.
    bound: f64,
    gigabytes: f64,
}

/// The largest frequency that a sum over modes has to follow in time: modes beyond a wide gap are not summed on its grid.
///
/// Estimated from each spring between its two masses alone, by the rule that [`search`] has for the modes themselves.
fn summed_frequency(scene: &Scene, omega_max: f64) -> f64 {
    let chain = &scene.chain;
    let inverse = |v: usize| if chain.live(v) { 1.0 / chain.mass[v] } else { 0.0 };
    let alone = |(i, k): (usize, &f64)| (k * (inverse(i) + inverse(i + 1))).sqrt();
    let mut frequencies: Vec<f64> = chain.stiffness.iter().enumerate().map(alone).collect();
    frequencies.sort_by(f64::total_cmp);
    let summed = search::resolved_modes(&frequencies);
    if summed == frequencies.len() { omega_max } else { (1.5 * frequencies[summed - 1]).min(omega_max) }
}

/// The methods that fit the scene.
fn offers(scene: &Scene, mark: Option<f64>, omega_max: f64) -> Vec<Offer> {
    let springs = scene.initial.len() as f64;
    let equal = closed_form::equal(&scene.chain).is_some();
    let look = LOOK * springs * if mark.is_some() { 2.0 } else { 1.0 };
    let cells = (scene.horizon * summed_frequency(scene, omega_max) / 1.5).ceil() + 1.0;
    let sums = search::MODE_SUM * springs * springs * cells + look;
    let swing = scene.force.abs() * (omega_max * scene.duration).min(2.0);
    let bound_of_sums =
        bound_of_extremes(bound_of_pieces(0.5 * f64::EPSILON * swing * (20.0 + springs.log2()) * (2.0 + springs.ln())));
    let memory_of_modes = |bytes: f64| bytes * springs * springs / 1e9;
    let mut offers = vec![Offer {
        method: Method::Propagator,
        nanoseconds: STEP * springs * propagator::steps(scene, omega_max) + look,
        bound: bound_of_extremes(propagator::error_bound(scene, omega_max)),
        gigabytes: 0.0,
    }];
    if fronts::fits(scene) {
        let price = |scene: &Scene| {
            let passing = fronts::passing(scene);
            let horizon = scene.horizon * omega_max / 2.0;
            springs * passing * (FRONT + TRIPLE * passing * passing) + ORDERS * horizon * horizon
        };
        offers.push(Offer {
            method: Method::Fronts,
            nanoseconds: price(scene) + mark.map_or(0.0, |mark| price(&until(scene, mark))),
            bound: bound_of_extremes(fronts::error_bound(scene)),
            gigabytes: 0.0,
        });
    }
    offers.push(Offer {
        method: Method::Modal,
        nanoseconds: price_of_modes(scene) + sums,
        bound: bound_of_sums,
        gigabytes: memory_of_modes(if equal { 16.0 } else { 64.0 }),
    });
    offers
}

/// A scene up to a mark.
fn until(scene: &Scene, mark: f64) -> Scene {
    Scene { horizon: mark, ..scene.clone() }
}

/// The plan for a scene.
///
/// # Errors
/// See [`super::solve`].
pub fn choose(scene: &Scene, ask: &Ask) -> Result<Plan, SolveError> {
    let omega_max = propagator::omega_max(scene);
    let offers = offers(scene, ask.mark, omega_max);
    if let Some(method) = ask.method {
        let unfit = if closed_form::equal(&scene.chain).is_none() {
            SolveError::NotEqual(method.name())
        } else if fronts::at_free_end(scene) {
            SolveError::TooShort
        } else {
            SolveError::NotAtEnd
        };
        let offer = offers.iter().find(|o| o.method == method).ok_or(unfit)?;
        affordable(offer, &offers)?;
        let (reason, seconds) = ("asked for".to_owned(), seconds(scene, omega_max, offer));
        return Ok(Plan { method, reason, seconds, omega_max });
    }
    let cheapest =
        |of: &mut dyn Iterator<Item = &Offer>| of.min_by(|a, b| a.nanoseconds.total_cmp(&b.nanoseconds)).copied();
    let fitting = || offers.iter().filter(|o| o.gigabytes <= MOST_GIGABYTES);
    // A bound near the tolerance, or a billionth of the force, is improved for at most [`MAX_WORK_RATIO`] times its
    // work.
    let near_bound = ask.tolerance.max(FINE_SHARE * scene.force.abs()) * NEAR_FACTOR;
    let usual = cheapest(&mut fitting().filter(|o| o.bound <= near_bound));
    let most = usual.map_or(f64::INFINITY, |o| MAX_WORK_RATIO * o.nanoseconds);
    let affordable_offers = || fitting().filter(|o| o.nanoseconds <= most);
    let within = cheapest(&mut affordable_offers().filter(|o| o.bound <= ask.tolerance));
    let best = within.or_else(|| affordable_offers().min_by(|a, b| a.bound.total_cmp(&b.bound)).copied());
    let chosen = best.unwrap_or(offers[0]);
    affordable(&chosen, &offers)?;
    let reason = reason(&chosen, &offers, ask, within.is_some());
    Ok(Plan { method: chosen.method, reason, seconds: seconds(scene, omega_max, &chosen), omega_max })
}

/// Estimated time of what was chosen, s.
fn seconds(scene: &Scene, omega_max: f64, chosen: &Offer) -> f64 {
    let search = match chosen.method {
        Method::Modal => search::most_nanoseconds(scene, [summed_frequency(scene, omega_max), omega_max]),
        Method::Fronts | Method::Propagator => 0.0,
    };
    1e-9 * (chosen.nanoseconds + search)
}

fn affordable(offer: &Offer, offers: &[Offer]) -> Result<(), SolveError> {
    let seconds = offer.nanoseconds * 1e-9;
    if seconds <= MOST_SECONDS && offer.gigabytes <= MOST_GIGABYTES {
        return Ok(());
    }
    let other = offers
        .iter()
        .filter(|o| o.method != offer.method && o.gigabytes <= MOST_GIGABYTES)
        .min_by(|a, b| a.nanoseconds.total_cmp(&b.nanoseconds));
    let advice = match other {
        Some(o) if o.nanoseconds < 0.5 * offer.nanoseconds => {
            format!("{} would take about {:.0} s", o.method.name(), (o.nanoseconds * 1e-9).ceil())
        }
        _ => "a shorter horizon takes less, in proportion".to_owned(),
    };
    Err(SolveError::TooMuch { method: offer.method.name(), seconds, gigabytes: offer.gigabytes, advice })
}

fn reason(chosen: &Offer, offers: &[Offer], ask: &Ask, within: bool) -> String {
    if !within {
        let other = offers.iter().filter(|o| o.bound <= ask.tolerance).map(|o| (o.method, o.nanoseconds));
        return match other.min_by(|a, b| a.1.total_cmp(&b.1)) {
            Some((method, nanoseconds)) => format!(
                "its bound is not within the tolerance of {:.1e}; that of {} would be, for {:.0} times the work",
                ask.tolerance,
                method.name(),
                nanoseconds / chosen.nanoseconds
            ),
            None => format!(
                "no method's bound is within the tolerance of {:.1e}; this one's is the smallest that is worth its work",
                ask.tolerance
            ),
        };
    }
    let faster = |o: &&Offer| o.nanoseconds < chosen.nanoseconds;
    let mut others: Vec<String> = offers
        .iter()
        .filter(|o| o.method != chosen.method)
        .map(|o| format!("{} {:.1} times as much", o.method.name(), o.nanoseconds / chosen.nanoseconds))
        .collect();
    let dropped: Vec<&str> = offers.iter().filter(faster).map(|o| o.method.name()).collect();
    others.sort();
    let mut text = format!("the cheapest that reaches the tolerance (work of the others: {})", others.join(", "));
    if !dropped.is_empty() {
        text += &format!("; cheaper, but not accurate enough here: {}", dropped.join(", "));
    }
    text
}

/// A scene, what is asked of it, and the plan for it.
#[derive(Clone, Debug)]
pub(super) struct Planned<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// What is asked.
    pub ask: Ask,
    /// The plan.
    pub plan: Plan,
}

/// Carries plans out. Breaks that are planned to be marched are marched side by side where that is less work.
#[inline(never)]
pub(super) fn run_all(all: &[Planned]) -> Vec<Solution> {
    let asks: Vec<MarchAsk> = all.iter().map(march_ask).collect();
    let can_join = |of: &Planned| {
        let is_free = !of.ask.verdict_only && !of.ask.all_time_bound;
        is_free && of.plan.method == Method::Propagator && of.scene.duration >= of.scene.horizon
    };
    let mut joined: Vec<usize> = (0..all.len()).filter(|&n| can_join(&all[n])).collect();
    joined.sort_by_key(|&n| (asks[n].terms, all[n].scene.initial.len()));
    let mut found: Vec<Option<Peaks>> = vec![None; all.len()];
    for some in joined.chunk_by(|&a, &b| asks[a].terms == asks[b].terms).flat_map(|some| some.chunks(LANES)) {
        let of: Vec<MarchAsk> = some.iter().map(|&n| asks[n]).collect();
        if are_less_work_together(&of) {
            some.iter().zip(observers::peaks(&of)).for_each(|(&n, peaks)| found[n] = Some(peaks));
        }
    }
    all.iter().zip(asks).zip(found).map(|((of, march_ask), found)| run(of, march_ask, found)).collect()
}

/// Whether a march through chains side by side is less work than one through each of them in pieces.
fn are_less_work_together(of: &[MarchAsk]) -> bool {
    let springs = || of.iter().map(|of| of.scene.initial.len());
    let rows = springs().fold(0, usize::max);
    let in_pieces: usize = springs().map(|springs| springs / LANES + PIECES_ROWS).sum();
    of.len() > 1 && rows <= MOST_ROWS && rows < in_pieces
}

/// What a march has to find.
fn march_ask<'a>(Planned { scene, ask, plan }: &Planned<'a>) -> MarchAsk<'a> {
    let coarse = coarse_min_rise(scene, ask);
    let terms = propagator::terms(scene, plan.omega_max, coarse);
    let min_rise = coarse.min(ask.tolerance - propagator::error_bound_of_terms(scene, plan.omega_max, terms));
    MarchAsk { scene, omega: plan.omega_max, terms, min_rise, wanted: ask.wanted, mark: ask.mark }
}

/// Carries a plan out, as far as it is not yet: `found` along a march.
fn run(Planned { scene, ask, plan }: &Planned, march_ask: MarchAsk, found: Option<Peaks>) -> Solution {
    let by_modes = plan.method == Method::Modal;
    let bounds_pay = ask.verdict_only && 1e9 * plan.seconds > price_of_modes(scene);
    let mut modes = (by_modes || ask.all_time_bound || bounds_pay).then(|| modes(scene));
    let bounds = modes.as_ref().filter(|_| ask.all_time_bound || bounds_pay).map(|m| sums::all_time_bounds(scene, m));
    let safe = |i: usize| {
        let bound = bounds.as_ref().filter(|_| ask.verdict_only).map(|b| b[i]);
        // With room for the rounding of scaled units.
        bound.is_some_and(|b| (1.0 + 16.0 * f64::EPSILON) * b <= scene.rated_draft[i].min(scene.rated_buff[i]))
    };
    let springs = 0..scene.initial.len();
    let all_safe = springs.clone().all(safe);
    let mut reason = plan.reason.clone();
    let (peaks, work, error_bound) = match (plan.method, &mut modes) {
        _ if all_safe => ([Vec::new(), Vec::new()], Work::default(), 0.0),
        (Method::Modal, Some(modes)) => {
            // Where a coupler stands at its rating, the verdict depends on the smallest change of its force: no mode is left out.
            let allowed = if stands_at_rating(scene) { 0.0 } else { 0.1 * ask.tolerance };
            let left_out = sums::leave_out(scene, modes, allowed);
            let bound = sums::error_bound(scene, modes) + left_out;
            let found = search::peaks(scene, modes, [bound, ask.tolerance], ask.mark);
            if found.given_up {
                reason += "; its search among millions of fast swings was given up: the bound is widened, and first exceedances \
                           may be earlier than reported";
            }
            (found.peaks, found.work, bound + found.missed)
        }
        (Method::Fronts, _) => {
            let (peaks, mut work) = fronts::peaks(scene);
            let to_mark = ask.mark.map(|mark| fronts::peaks(&until(scene, mark)));
            work.marched += to_mark.as_ref().map_or(0, |(_, more)| more.marched);
            work.refinements += to_mark.as_ref().map_or(0, |(_, more)| more.refinements);
            let peaks = [peaks, to_mark.map_or_else(Vec::new, |(peaks, _)| peaks)];
            (peaks, work, bound_of_extremes(fronts::error_bound(scene)))
        }
        _ => {
            let bound = propagator::error_bound_of_terms(scene, plan.omega_max, march_ask.terms);
            let found = found.or_else(|| observers::peaks(&[march_ask]).pop());
            let (peaks, work) = found.unwrap_or_default();
            (peaks, work, bound_of_extremes(bound).max(bound + march_ask.min_rise))
        }
    };
    let kept = |peaks: &[SpringPeaks]| springs.clone().map(|i| peaks.get(i).copied().filter(|_| !safe(i))).collect();
    Solution {
        method: plan.method,
        reason,
        error_bound,
        springs: kept(&peaks[0]),
        to_mark: ask.mark.map_or_else(Vec::new, |_| kept(&peaks[1])),
        only_worst: ask.wanted == Wanted::Worst && plan.method == Method::Propagator && !all_safe,
        all_time_bounds: bounds,
        work,
    }
}

/// A difference in force that is ignored besides the error bound: 0 unless the tolerance is over 1e-8 of the largest force or rating.
fn coarse_min_rise(scene: &Scene, ask: &Ask) -> f64 {
    let ratings = scene.rated_draft.iter().chain(&scene.rated_buff);
    let largest = ratings.fold(scene.force.abs(), |largest, &rating| largest.max(rating));
    if ask.tolerance > NEAR_FACTOR * FINE_SHARE * largest { IGNORED_SHARE * ask.tolerance } else { 0.0 }
}

/// Whether a spring stands at its rating before the event, or within a millionth under it, where the error bound may not decide.
fn stands_at_rating(scene: &Scene) -> bool {
    let ratings = scene.rated_draft.iter().zip(&scene.rated_buff);
    let near = |f: f64, rating: f64| f <= rating && f > (1.0 - 1e-6) * rating;
    scene.initial.iter().zip(ratings).any(|(&f, (&draft, &buff))| near(f, draft) || near(-f, buff))
}

/// Nanoseconds to find all modes, and every spring's share of them.
fn price_of_modes(scene: &Scene) -> f64 {
    let springs = scene.initial.len() as f64;
    let entry = if closed_form::equal(&scene.chain).is_some() { EQUAL_ENTRY } else { modal::MODE_ENTRY };
    entry * springs * springs
}

/// Modes of a scene: by the paper's formula for equal chains.
fn modes(scene: &Scene) -> sums::Modes {
    closed_form::modes(scene).unwrap_or_else(|| modal::modes(scene))
}

/// Forces in one spring at given times, by the cheapest method.
pub fn history(scene: &Scene, spring: usize, times: &[f64]) -> Vec<f64> {
    let omega_max = propagator::omega_max(scene);
    let springs = scene.initial.len() as f64;
    let step = STEP * springs * propagator::steps(scene, omega_max);
    let sums = 20.0 * springs * times.len() as f64 + price_of_modes(scene);
    if step < sums {
        return observers::history(scene, omega_max, spring, times);
    }
    sums::history(scene, &modes(scene), spring, times)
}
