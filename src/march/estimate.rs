//! The error of a march: proven where it can be, and estimated by two more runs where it cannot.
//!
//! The other runs take other steps, with noise of 32 unit roundoffs (u = 2^-53) on every elongation and speed at every
//! step, and the laws' constants changed by 16 u. Their margin past guards is doubled, so that the differences include its
//! effect. Estimate: 10 times the larger difference of the two runs from the reported one, plus 16 u of the largest force. The
//! runs advance together; the results end where the estimate for any force passes the tolerance.

use super::branches::Branches;
use super::proof::U;
use super::record::extremes;
use super::run::{RunSettings, stiffest};
use super::step::March;
use super::{Bound, Extremes, MarchOptions, MarchOutcome, Problem};
use crate::law::{Curve, GearRow, Law, Rest};
use crate::solve::watch::{Watch, bound_of_extremes};

/// Largest step times the largest rate: of the reported run, and of the others.
const PHASE: f64 = 1.0;
const OTHER_PHASES: [f64; 2] = [0.73, 0.81];
/// Sizes of the noise and of the change of constants, in unit roundoffs.
const NOISE: f64 = 32.0;
const CONSTANT_CHANGE: f64 = 16.0;
/// Factor on the margin past guards in the other runs.
const OTHER_MARGIN: f64 = 2.0;
/// Factors of the estimate: on the difference, and on the unit roundoff of the largest force.
const DIFFERENCES: f64 = 10.0;
const UNITS: f64 = 16.0;
/// Instants at which the runs are compared.
const COMPARED: usize = 200;
/// The run that is reported.
const SETTINGS: RunSettings = RunSettings { phase: PHASE, noise: None, margin: 1.0 };
/// Instants between which [`follow`] hands on what it has.
const INSTANTS_PER_CHUNK: usize = 64;

/// Follows the motion of a train.
///
/// The search for extremes needs the proven bound on the forces' error. It is known before the motion where linear couplers do not
/// break; for other problems with a proof a first run without a search finds it. Without a proof the error is estimated.
///
/// # Panics
/// If a list of the problem does not have one entry for each vehicle or coupler, or a law is not valid
/// ([`Law::check`]).
pub fn solve(problem: &Problem, ask: &MarchOptions) -> MarchOutcome {
    check(problem, ask);
    let mut march = March::new(problem, ask, SETTINGS);
    march.start_proof();
    let bound = match march.bound_known_before() {
        None if ask.tolerance_n.is_some() && march.proof.is_some() => {
            let mut first = March::new(problem, &MarchOptions::default(), SETTINGS);
            first.start_proof();
            first.advance_to(problem.horizon_s);
            first.proven_n()
        }
        known => known,
    };
    if ask.tolerance_n.is_some() && bound.is_none() {
        return with_estimate(problem, ask, March::new(problem, ask, SETTINGS));
    }
    march.search(ask, bound.unwrap_or(0.0));
    march.advance_to(problem.mark_s.min(problem.horizon_s));
    march.record.mark(problem.horizon_s);
    march.advance_to(problem.horizon_s);
    match (ask.tolerance_n, march.proven_n()) {
        (Some(_), None) => with_estimate(problem, ask, March::new(problem, ask, SETTINGS)),
        (_, Some(bound_n)) => {
            let bound_n = bound_of_extremes(bound_n);
            let all = vec![[bound_n; 2]; problem.laws.len()];
            finish(march, Bound::Proven(bound_n), [all.clone(), all], None)
        }
        (None, None) => finish(march, Bound::None, [Vec::new(), Vec::new()], None),
    }
}

/// One run without extremes and without an error. The history is not in the outcome: each of its forces is given to `see` as (index
/// in `times_s`, index in `history`, force in N), and none beyond the end of the march.
///
/// # Panics
/// As for [`solve`].
pub fn follow(problem: &Problem, ask: &MarchOptions, see: &mut dyn FnMut(usize, usize, f64)) -> MarchOutcome {
    check(problem, ask);
    let mut march = March::new(problem, ask, SETTINGS);
    march.start_proof();
    for times in ask.times_s.chunks(INSTANTS_PER_CHUNK) {
        march.advance_to(times[times.len() - 1].min(problem.horizon_s));
        march.record.drain(see);
    }
    march.advance_to(problem.horizon_s);
    march.record.drain(see);
    march.record.history.clear();
    finish(march, Bound::None, [Vec::new(), Vec::new()], None)
}

impl March<'_> {
    /// The bound on every force, where it is known before the first step.
    fn bound_known_before(&self) -> Option<f64> {
        self.proof
            .filter(|proof| proof.is_known_before() && self.breaks.is_none())
            .map(|proof| proof.bound_n(&self.run))
    }

    /// The bound on every force at the end, if it is proven.
    fn proven_n(&self) -> Option<f64> {
        self.proof.filter(|proof| proof.has_held(&self.run)).map(|proof| proof.bound_n(&self.run))
    }

    /// Looks for extremes, and instants above the capacities, from here on, up to the mark first; forces are within the bound.
    fn search(&mut self, ask: &MarchOptions, bound: f64) {
        let capacity = if ask.capacity_n.is_empty() {
            vec![[f64::INFINITY; 2]; self.run.couplers.len()]
        } else {
            ask.capacity_n.clone()
        };
        // What parts at t = 0 begins with the force that its vehicles push with.
        let gone = |i: usize| self.run.problem.gone.contains(&i);
        let force = |i: usize| self.run.start[i][1] + if gone(i) { self.run.state.tension(i) } else { 0.0 };
        let forces: Vec<f64> = (0..self.run.couplers.len()).map(force).collect();
        let mark = self.run.problem.mark_s.min(self.run.problem.horizon_s);
        self.record.watch = Some(Watch::of_forces(&forces, capacity, mark, bound));
    }
}

/// Time of one coupler in one step, s.
const COUPLER_STEP_S: f64 = 100e-9;
/// Events of one coupler with slack or friction in a second, many.
const EVENTS: f64 = 8.0;

/// Estimated time of [`solve`] on one core, s.
pub fn estimate_s(problem: &Problem, ask: &MarchOptions) -> f64 {
    let mut march = March::new(problem, &MarchOptions::default(), SETTINGS);
    march.start_proof();
    let linear = problem.laws.iter().filter(|l| l.is_linear()).count();
    let couplers = problem.laws.len();
    let rate = march.run.fastest() / PHASE + EVENTS * (couplers - linear) as f64;
    let runs = match (ask.tolerance_n, march.bound_known_before(), march.proof) {
        (None, ..) | (_, Some(_), _) => 1.0,
        (_, None, Some(_)) => 2.0,
        (_, None, None) => 3.0,
    };
    runs * rate * problem.horizon_s * (couplers + 1) as f64 * COUPLER_STEP_S
}

fn check(problem: &Problem, ask: &MarchOptions) {
    let (n, couplers) = (problem.mass_kg.len(), problem.laws.len());
    assert!(n > 0 && couplers == n - 1 && problem.start.len() == couplers, "one coupler between two vehicles");
    assert!(problem.speed_m_s.len() == n && problem.steady_n.len() == n, "a speed and a force of every vehicle");
    for length in [problem.dashpot_n_s_per_m.len(), problem.break_at_n.len(), ask.capacity_n.len()] {
        assert!(length == 0 || length == couplers, "one of every coupler, or none");
    }
    for law in &problem.laws {
        law.check().expect("a valid law");
    }
}

/// Results up to an instant of comparison, used if it is the last.
#[derive(Clone)]
struct Snapshot {
    at: f64,
    watch: Option<Watch>,
}

impl Snapshot {
    fn of(march: &March) -> Snapshot {
        Snapshot { at: march.run.t, watch: march.record.watch.clone() }
    }

    fn extremes(&self) -> Vec<Extremes> {
        self.watch.as_ref().map_or_else(Vec::new, extremes)
    }
}

/// The march with two other runs.
fn with_estimate(problem: &Problem, ask: &MarchOptions, mut march: March) -> MarchOutcome {
    let moved: Vec<Problem> = (1..=2).map(|seed| moved(problem, seed)).collect();
    let quiet = MarchOptions { capacity_n: ask.capacity_n.clone(), ..MarchOptions::default() };
    march.search(ask, 0.0);
    let other = |(n, p)| {
        let noise = Some((0x9E37_79B9 + n as u64, NOISE));
        let mut other = March::new(p, &quiet, RunSettings { phase: OTHER_PHASES[n], noise, margin: OTHER_MARGIN });
        other.search(&quiet, 0.0);
        other
    };
    let mut others: Vec<March> = moved.iter().enumerate().map(other).collect();
    let (mark, horizon) = (problem.mark_s.min(problem.horizon_s), problem.horizon_s);
    let mut instants: Vec<f64> =
        (1..COMPARED).map(|k| horizon * k as f64 / COMPARED as f64).chain([mark, horizon]).collect();
    instants.sort_by(f64::total_cmp);
    let mut to_mark = Vec::new();
    let mut until = None;
    let mut last: Vec<Snapshot> = [&march].into_iter().chain(&others).map(Snapshot::of).collect();
    for t in instants {
        march.advance_to(t);
        others.iter_mut().for_each(|o| o.advance_to(march.run.t));
        let error = error_now(&march, &others);
        if ask.tolerance_n.is_some_and(|tolerance| error > tolerance) {
            until = Some(last[0].at);
            march.record.rewind(last[0].at, last[0].watch.clone());
            march.run.partings.retain(|p| p.time_s <= last[0].at);
            march.run.closures.retain(|c| c.1 <= last[0].at);
            march.run.stopped = None;
            break;
        }
        last = [&march].into_iter().chain(&others).map(Snapshot::of).collect();
        if t == mark {
            march.record.mark(horizon);
            others.iter_mut().for_each(|other| other.record.mark(horizon));
            to_mark = errors(&last);
        }
        if march.run.stopped.is_some() {
            break;
        }
    }
    let whole = errors(&last);
    if to_mark.is_empty() {
        to_mark = whole.clone();
    }
    let worst = whole.iter().flatten().copied().fold(0.0, f64::max);
    estimate_parting_errors(&mut march, &others);
    finish(march, Bound::Estimated(worst), [whole, to_mark], until)
}

/// The estimate for the forces of this instant, the largest of all couplers.
fn error_now(march: &March, others: &[March]) -> f64 {
    let force = |m: &March, i: usize| m.run.start[i][1] + m.run.state.tension(i);
    let (mut difference, mut largest) = (0.0f64, 0.0f64);
    for i in 0..march.run.couplers.len() {
        let f = force(march, i);
        largest = largest.max(f.abs());
        difference = others.iter().map(|o| (force(o, i) - f).abs()).fold(difference, f64::max);
    }
    // If the runs differ in the number of partings, forces are not known.
    if others.iter().any(|o| o.run.partings.len() != march.run.partings.len()) {
        return f64::INFINITY;
    }
    DIFFERENCES * difference + UNITS * U * largest
}

/// The estimates for the instants at which couplers part.
fn estimate_parting_errors(march: &mut March, others: &[March]) {
    for p in &mut march.run.partings {
        let in_other =
            |o: &March| o.run.partings.iter().find(|other| other.coupler == p.coupler).map(|other| other.time_s);
        let difference = |o: &March| in_other(o).map_or(f64::INFINITY, |at| (at - p.time_s).abs());
        let difference = others.iter().map(difference).fold(0.0, f64::max);
        p.uncertainty_s = DIFFERENCES * difference + UNITS * U * p.time_s;
    }
}

/// The estimates for every coupler's extremes.
fn errors(kept: &[Snapshot]) -> Vec<[f64; 2]> {
    let of = |e: &Extremes| [e.draft.force_n, e.buff.force_n];
    let kept: Vec<Vec<Extremes>> = kept.iter().map(Snapshot::extremes).collect();
    let largest = kept[0].iter().flat_map(of).fold(0.0f64, |a, f| a.max(f.abs()));
    let error = |i: usize| {
        let mine = of(&kept[0][i]);
        [0, 1].map(|sense| {
            let difference = |k: &Vec<Extremes>| (of(&k[i])[sense] - mine[sense]).abs();
            DIFFERENCES * kept[1..].iter().map(difference).fold(0.0, f64::max) + UNITS * U * largest
        })
    };
    (0..kept[0].len()).map(error).collect()
}

/// The problem with the constants of its laws moved by some unit roundoffs, each up or down.
fn moved(problem: &Problem, seed: u64) -> Problem {
    let mut bits = seed;
    let mut factor = || {
        // Linear congruential generator; its highest bit is a random sign.
        bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        if bits >> 63 == 0 { 1.0 + CONSTANT_CHANGE * U } else { 1.0 - CONSTANT_CHANGE * U }
    };
    let laws = problem.laws.iter().map(|law| match law {
        Law::Elastic { draft_n_per_m, buff_n_per_m, slack_m } => {
            let same = draft_n_per_m == buff_n_per_m;
            let draft = factor();
            let buff = if same { draft } else { factor() };
            Law::Elastic {
                draft_n_per_m: draft_n_per_m * draft,
                buff_n_per_m: buff_n_per_m * buff,
                slack_m: slack_m * factor(),
            }
        }
        Law::Gear { solid_n_per_m, slack_m, draft, buff } => {
            let mut table = |c: &Curve| {
                // One factor for a column, so that rising, level and equal values stay so.
                let (travel, loading, back) = (factor(), factor(), factor());
                let equal = c.rows().iter().any(|r| r.loading_n == r.unloading_n && r.loading_n != 0.0);
                let back = if equal || back > loading { loading } else { back };
                let row = |r: &GearRow| GearRow {
                    travel_m: r.travel_m * travel,
                    loading_n: r.loading_n * loading,
                    unloading_n: r.unloading_n * back,
                };
                Curve::new(c.rows().iter().map(row).collect()).unwrap_or_else(|_| c.clone())
            };
            let (draft, buff) = (table(draft), table(buff));
            Law::Gear { solid_n_per_m: solid_n_per_m * factor(), slack_m: slack_m * factor(), draft, buff }
        }
    });
    let laws: Vec<Law> = laws.collect();
    let start = problem.start.iter().zip(problem.laws.iter().zip(&laws));
    let start = start.map(|(rest, (law, moved))| at_same_knot(*rest, law, moved)).collect();
    Problem { laws, start, ..problem.clone() }
}

/// Puts a coupler that rests where two intervals of its law meet, or at the end of the last one, at the same point of the moved law:
/// else a closed gear would no longer be closed, and a coupler at the end of its slack would be inside the slack.
fn at_same_knot(rest: Rest, law: &Law, moved: &Law) -> Rest {
    let knots = |law: &Law| -> Vec<f64> {
        Branches::new(law).intervals.iter().flat_map(|interval| [interval.from, interval.to]).collect()
    };
    let knots = knots(law)
        .into_iter()
        .zip(knots(moved))
        .find(|(knot, _)| knot.is_finite() && (rest.travel_m - knot).abs() <= CONSTANT_CHANGE * U * knot.abs());
    Rest { travel_m: knots.map_or(rest.travel_m, |(_, moved)| moved), ..rest }
}

fn finish(
    mut march: March,
    bound: Bound,
    errors: [Vec<[f64; 2]>; 2],
    predictable_until_s: Option<f64>,
) -> MarchOutcome {
    // An event can leave an elongation past its guard by twice the margin: peaks under the force of that at the largest stiffness
    // count as 0.
    let none = |i: usize| 2.0 * march.run.guard_margin * stiffest(&march.run.problem.laws[i]);
    let [to_mark, whole] = march.record.finish();
    let seen = |watch: &Option<Watch>| {
        let mut seen = watch.as_ref().map_or_else(Vec::new, extremes);
        for (i, e) in seen.iter_mut().enumerate() {
            let small = [&mut e.draft, &mut e.buff].into_iter().filter(|p| p.force_n.abs() <= none(i));
            small.for_each(|peak| peak.force_n = 0.0);
        }
        seen
    };
    let sides =
        |watch: &Option<Watch>| watch.iter().flat_map(|w| &w.peaks).map(|p| [p.draft, p.buff]).collect::<Vec<_>>();
    let decided = |watch: &Option<Watch>| sides(watch).iter().map(|of| of.map(|side| side.exceeds())).collect();
    let [error_n, error_to_mark_n] = errors;
    MarchOutcome {
        extremes: seen(&whole),
        to_mark: seen(&to_mark),
        first_over_s: sides(&whole).iter().map(|of| of.map(|side| side.first_over)).collect(),
        exceeds: decided(&whole),
        exceeds_to_mark: decided(&to_mark),
        bound,
        error_n,
        error_to_mark_n,
        undecided: march.breaks.as_ref().and_then(super::breaks::Breaks::first_undecided),
        partings: march.run.partings,
        closures: march.run.closures,
        stopped: march.run.stopped,
        predictable_until_s,
        history: march.record.history,
        watched: march.record.watched.values,
        end_speed_m_s: march.run.state.v[0].clone(),
        energy: march.audit.map(|a| a.energy),
        events: march.events,
        steps: march.steps,
    }
}
