//! Cases that are marched from event to event: couplers with slack or gears, brakes, changing tractive efforts.

use super::solved::{Marched, PeriodFindings, Solved};
use super::{
    CouplerFindings, CouplerPeaks, Ending, Options, coupler_findings, first_passage, largest_rating_n, load_search,
    worst,
};
use crate::march::{self, Bound, Extremes, MarchOptions, MarchOutcome, Problem};
use crate::play::Rule;
use crate::scenario;
use crate::solve::SolveError;
use crate::train::{Scenario, Train};

/// The smallest tolerance of a march, as a share of the largest rating: with a smaller one it would end earlier, because it ends
/// where its estimate passes the tolerance.
pub(super) const TOLERANCE: f64 = 1e-6;

/// A rating that lies so many estimated errors from a peak, or less, is not decided.
const MARGIN: f64 = 10.0;

/// The error that is asked for, N.
pub(super) fn tolerance_n(train: &Train, options: &Options) -> f64 {
    options.tolerance.max(TOLERANCE) * largest_rating_n(train)
}

/// The options of a march: the tolerance that the options give, and the ratings whose first passing is to be found.
pub(super) fn ask(train: &Train, options: &Options) -> MarchOptions {
    MarchOptions {
        capacity_n: train.couplers().iter().map(|c| [c.rated_draft_n, c.rated_buff_n]).collect(),
        tolerance_n: Some(tolerance_n(train, options)),
        ..MarchOptions::default()
    }
}

/// The march of a case without a cascade.
pub(super) fn problem(train: &Train, scenario: &Scenario, broken: Option<usize>, horizon_s: f64) -> Problem {
    let mark_s = first_passage::end_s(train, scenario, broken, horizon_s);
    scenario::march(train, scenario, broken, [horizon_s, mark_s], Rule::Keep)
}

/// Extremes of every coupler but the broken one.
///
/// # Errors
/// [`SolveError::StepsOnly`] when a method for steps is asked for.
pub(super) fn solved(
    train: &Train,
    scenario: &Scenario,
    broken: Option<usize>,
    horizon_s: f64,
    options: &Options,
) -> Result<Solved, SolveError> {
    if let Some(method) = options.method {
        return Err(SolveError::StepsOnly(method.name()));
    }
    let problem = problem(train, scenario, broken, horizon_s);
    let outcome = march::solve(&problem, &ask(train, options));
    let couplers = of_couplers(train, scenario, broken, &outcome, false);
    let (error_bound_n, error_estimate_n) = errors(&outcome.bound);
    let error_n = error_n(error_bound_n, error_estimate_n);
    let to_mark = of_couplers(train, scenario, broken, &outcome, true);
    let to_mark = PeriodFindings { worst: worst(&to_mark, 0..to_mark.len(), error_n), couplers: to_mark };
    Ok(Solved {
        method: "march",
        reason: reason(train, options),
        error_bound_n,
        error_estimate_n,
        worst: worst(&couplers, 0..couplers.len(), error_n),
        couplers,
        left_out: Vec::new(),
        to_mark: Some(to_mark),
        marched: Some(Marched { ending: ending(&outcome), closures: outcome.closures }),
    })
}

/// Where a march ended before its horizon, and why.
pub(super) fn ending(outcome: &MarchOutcome) -> Option<Ending> {
    let stop = outcome.stopped.map(|(vehicle, at_s)| Ending { at_s, stopped_vehicle: Some(vehicle + 1) });
    let lost = outcome.predictable_until_s.map(|at_s| Ending { at_s, stopped_vehicle: None });
    [stop, lost].into_iter().flatten().reduce(|a, b| if b.at_s < a.at_s { b } else { a })
}

/// Every coupler but the one that the event breaks, over all of a march or up to its mark.
pub(super) fn of_couplers(
    train: &Train,
    scenario: &Scenario,
    broken: Option<usize>,
    outcome: &MarchOutcome,
    to_mark: bool,
) -> Vec<CouplerFindings> {
    let estimated = matches!(outcome.bound, Bound::Estimated(_));
    let before_n = scenario::initial_force_n(train, &scenario.event);
    let (extremes, error_n) = match to_mark {
        true => (&outcome.to_mark, &outcome.error_to_mark_n),
        false => (&outcome.extremes, &outcome.error_n),
    };
    let one = |i: usize| CouplerFindings {
        initial_force_n: before_n[i],
        error_estimate_n: error_n.get(i).filter(|_| estimated).map(|n| n[0].max(n[1])),
        ..coupler_findings(train, i, &coupler_peaks(train, outcome, i, extremes[i], error_n.get(i)), None)
    };
    (0..extremes.len()).filter(|i| Some(*i) != broken).map(one).collect()
}

/// Peaks and verdicts of one coupler.
fn coupler_peaks(
    train: &Train,
    outcome: &MarchOutcome,
    i: usize,
    extremes: Extremes,
    error_n: Option<&[f64; 2]>,
) -> CouplerPeaks {
    let factor = if matches!(outcome.bound, Bound::Estimated(_)) { MARGIN } else { 1.0 };
    let margins = error_n.map_or([f64::INFINITY; 2], |of| of.map(|n| factor * n));
    let c = &train.couplers()[i];
    let largest = [(extremes.draft.force_n, extremes.draft.time_s), (-extremes.buff.force_n, extremes.buff.time_s)];
    let ratings = [c.rated_draft_n, c.rated_buff_n];
    let exceeds = |side: usize| {
        let over_n = largest[side].0 - ratings[side];
        // The force before the event is exact.
        let exact = largest[side].1 == 0.0 && over_n > 0.0;
        (exact || over_n.abs() > margins[side]).then_some(over_n > 0.0)
    };
    let exceeds = [exceeds(0), exceeds(1)];
    let first = outcome.first_over_s.get(i).copied().unwrap_or_default();
    let last_s = largest.map(|(_, at)| at);
    let over = |side: usize| first[side].filter(|at| exceeds[side] == Some(true) && *at <= last_s[side]);
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

/// Estimated time of a case, s: its march, a second one where couplers break one after the other, and the search for the load.
pub(super) fn estimate_s(
    train: &Train,
    scenario: &Scenario,
    broken: Option<usize>,
    horizon_s: f64,
    options: &Options,
) -> f64 {
    let once = march::estimate_s(&problem(train, scenario, broken, horizon_s), &ask(train, options));
    let search_s = load_search::estimate_s(train, scenario, broken, horizon_s, options).unwrap_or(0.0);
    search_s + if scenario.cascade == Rule::Keep { once } else { 2.0 * once }
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
