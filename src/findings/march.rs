//! Cases that are marched: dashpots, impacts, forces of any shape, couplers with slack or gears, brakes, changing tractive efforts.

use super::solved::{Marched, PeriodFindings, Solved};
use super::{CouplerFindings, CouplerPeaks, Ending, Options, coupler_findings, largest_rating_n, worst};
use crate::march::{self, Bound, MarchOptions, MarchOutcome, Problem};
use crate::scenario;
use crate::solve::SolveError;
use crate::train::{Event, PulseShape, Rule, Scenario, Train};

/// The smallest tolerance of a march, as a share of the largest rating: with a smaller one it would end earlier, because it ends
/// where its estimate passes the tolerance.
pub(super) const TOLERANCE: f64 = 1e-6;

/// The longest that a march may take, s.
const MOST_SECONDS: f64 = 3600.0;

/// Where the error is estimated, a verdict is left open if peak and rating differ by at most this number of estimated errors.
const MARGIN: f64 = 10.0;

/// The error that is asked for, N.
pub(super) fn tolerance_n(train: &Train, options: &Options) -> f64 {
    options.tolerance.max(TOLERANCE) * largest_rating_n(train)
}

/// The options of a march: the tolerance that the options give, and the ratings whose first passing is to be found.
pub(super) fn ask(train: &Train, options: &Options) -> MarchOptions {
    MarchOptions {
        capacity_n: ratings_n(train),
        tolerance_n: Some(tolerance_n(train, options)),
        ..MarchOptions::default()
    }
}

/// Ratings in draft and in buff, N.
pub(super) fn ratings_n(train: &Train) -> Vec<[f64; 2]> {
    train.couplers().iter().map(|c| [c.rated_draft_n, c.rated_buff_n]).collect()
}

/// Extremes of every coupler but the broken one, up to a time and up to a mark if that is before it.
///
/// # Errors
/// [`SolveError::StepsOnly`] when a method for steps is asked for; [`SolveError::TooMuch`].
pub(super) fn solved(
    train: &Train,
    scenario: &Scenario,
    broken: Option<usize>,
    [until_s, mark_s]: [f64; 2],
    options: &Options,
) -> Result<Solved, SolveError> {
    if let Some(method) = options.method {
        return Err(SolveError::StepsOnly(method.name()));
    }
    let proportional = scenario::is_proportional(train, scenario);
    let method = method(proportional);
    let problem = scenario::march(train, scenario, broken, [until_s, mark_s], Rule::Keep);
    let outcome = within_an_hour(&problem, &ask(train, options), method)?;
    let (error_bound_n, error_estimate_n) = errors(&outcome.bound);
    let within = |period: Period| {
        let couplers = of_couplers(train, scenario, broken, &outcome, period);
        let error_n = error_n(error_bound_n, error_estimate_n);
        PeriodFindings { worst: worst(&couplers, 0..couplers.len(), error_n), couplers }
    };
    let PeriodFindings { couplers, worst } = within(Period::Whole);
    Ok(Solved {
        method,
        reason: if proportional { reason_of(&scenario.event).to_owned() } else { reason(train, options) },
        tolerance_n: if proportional {
            options.tolerance * largest_rating_n(train)
        } else {
            tolerance_n(train, options)
        },
        error_bound_n,
        error_estimate_n,
        worst,
        couplers,
        left_out: Vec::new(),
        to_mark: (mark_s < until_s).then(|| within(Period::ToMark)),
        marched: (!proportional).then(|| Marched { ending: ending(&outcome), closures: outcome.closures.clone() }),
    })
}

/// The outcome of a march that takes up to [`MOST_SECONDS`] by its estimate.
///
/// # Errors
/// [`SolveError::TooMuch`] if it would take longer.
pub(super) fn within_an_hour(
    problem: &Problem,
    ask: &MarchOptions,
    method: &'static str,
) -> Result<MarchOutcome, SolveError> {
    let seconds = march::estimate_s(problem, ask);
    if seconds > MOST_SECONDS {
        let advice = "a shorter horizon takes less, in proportion".to_owned();
        return Err(SolveError::TooMuch { method, seconds, gigabytes: 0.0, advice });
    }
    Ok(march::solve(problem, ask))
}

/// The name in results: `taylor` where couplers are linear and nothing but the event acts, which is proven and in proportion to the
/// event, and `march` elsewhere. Both are [`crate::march`]; results had two names when they were two programs, and readers know
/// from them what to expect.
pub(super) fn method(proportional: bool) -> &'static str {
    if proportional { "taylor" } else { "march" }
}

/// Where a march ended before its horizon, and why.
pub(super) fn ending(outcome: &MarchOutcome) -> Option<Ending> {
    let stop = outcome.stopped.map(|(vehicle, at_s)| Ending { at_s, stopped_vehicle: Some(vehicle + 1) });
    let lost = outcome.predictable_until_s.map(|at_s| Ending { at_s, stopped_vehicle: None });
    [stop, lost].into_iter().flatten().reduce(|a, b| if b.at_s < a.at_s { b } else { a })
}

/// The part of a march whose largest forces are wanted.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Period {
    /// All of it.
    Whole,
    /// Up to its mark.
    ToMark,
    /// All of it, where couplers break: the capacities of the march are not the ratings.
    Cascade,
}

/// Every coupler but the one that the event breaks.
pub(super) fn of_couplers(
    train: &Train,
    scenario: &Scenario,
    broken: Option<usize>,
    outcome: &MarchOutcome,
    period: Period,
) -> Vec<CouplerFindings> {
    let estimated = matches!(outcome.bound, Bound::Estimated(_));
    let before_n = scenario::initial_force_n(train, &scenario.event);
    let to_mark = period == Period::ToMark;
    let error_n = if to_mark { &outcome.error_to_mark_n } else { &outcome.error_n };
    let one = |i: usize| CouplerFindings {
        initial_force_n: before_n[i],
        error_estimate_n: error_n.get(i).filter(|_| estimated).map(|n| n[0].max(n[1])),
        ..coupler_findings(train, i, &coupler_peaks(train, outcome, i, period, error_n.get(i)), None)
    };
    (0..before_n.len()).filter(|i| Some(*i) != broken).map(one).collect()
}

/// Peaks and verdicts of one coupler.
fn coupler_peaks(
    train: &Train,
    outcome: &MarchOutcome,
    i: usize,
    period: Period,
    error_n: Option<&[f64; 2]>,
) -> CouplerPeaks {
    let proven = matches!(outcome.bound, Bound::Proven(_));
    let (extremes, decided) = match period {
        Period::ToMark => (&outcome.to_mark[i], &outcome.exceeds_to_mark[i]),
        Period::Whole | Period::Cascade => (&outcome.extremes[i], &outcome.exceeds[i]),
    };
    let factor = if proven { 1.0 } else { MARGIN };
    let margins = error_n.map_or([f64::INFINITY; 2], |of| of.map(|n| factor * n));
    let largest = [(extremes.draft.force_n, extremes.draft.time_s), (-extremes.buff.force_n, extremes.buff.time_s)];
    let c = &train.couplers()[i];
    let by_margin = |side: usize| {
        let over_n = largest[side].0 - [c.rated_draft_n, c.rated_buff_n][side];
        // The force before the event is exact.
        let exact = largest[side].1 == 0.0 && (proven || over_n > 0.0);
        (exact || over_n.abs() > margins[side]).then_some(over_n > 0.0)
    };
    let exceeds = if proven && period != Period::Cascade { *decided } else { [by_margin(0), by_margin(1)] };
    let first = outcome.first_over_s.get(i).copied().unwrap_or_default();
    let peak_s = largest.map(|(_, at)| at);
    let over = |side: usize| first[side].filter(|at| exceeds[side] == Some(true) && *at <= peak_s[side]);
    CouplerPeaks { largest, exceeds, first_over_s: [over(0), over(1)], error_n: margins }
}

/// The proven bound, infinite without one, and the largest estimate.
pub(super) fn errors(bound: &Bound) -> (f64, Option<f64>) {
    match bound {
        Bound::Proven(bound_n) => (*bound_n, None),
        Bound::Estimated(estimate_n) => (f64::INFINITY, Some(*estimate_n)),
        Bound::None => (f64::INFINITY, None),
    }
}

/// Error of every force, N: proven, or else estimated.
pub(super) fn error_n(bound_n: f64, estimate_n: Option<f64>) -> f64 {
    estimate_n.unwrap_or(bound_n)
}

/// Ratings this close to a peak, N, are undecided.
pub(super) fn margin_n(bound_n: f64, estimate_n: Option<f64>) -> f64 {
    estimate_n.map_or(bound_n, |n| MARGIN * n)
}

/// Estimated time of a march with all of its runs, s.
pub(super) fn estimate_s(
    train: &Train,
    scenario: &Scenario,
    broken: Option<usize>,
    horizon_s: f64,
    rule: Rule,
    options: &Options,
) -> f64 {
    march::estimate_s(&scenario::march(train, scenario, broken, [horizon_s; 2], rule), &ask(train, options))
}

/// Why a case of linear couplers is marched.
fn reason_of(event: &Event) -> &'static str {
    match event {
        Event::Impact { .. } => "the train is set in motion by speeds, not by a force",
        Event::Pulse(pulse) if pulse.shape != PulseShape::Rectangle => "the force changes while it acts",
        _ => "dashpots couple the modes",
    }
}

fn reason(train: &Train, options: &Options) -> String {
    let why = if train.extras().laws.is_empty() {
        "forces from outside change on several vehicles"
    } else {
        "couplers with slack or gears change their stiffness while they move"
    };
    let share = options.tolerance.max(TOLERANCE);
    format!("{why}; forces are reported while their error is under {share:e} of the largest rating")
}
