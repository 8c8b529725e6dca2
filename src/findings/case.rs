//! One case of a train: what an event, or the break of one coupler, does to every coupler.

use std::borrow::Cow;
use std::time::Instant;

use super::damped;
use super::solved::{Marched, PeriodFindings, Solved};
use super::{
    CaseFindings, CouplerFindings, CouplerPeaks, GapClosure, Options, RodFindings, ask, cascade, coupler_findings,
    first_passage, largest_rating_n, limits, load_search, march, safe_factor, safe_speed, worst,
};
use crate::chain::Scene;
use crate::rod::Rod;
use crate::scenario::{self, Motion, Part, Scales};
use crate::solve::responses::Shared;
use crate::solve::watch::{Side, SpringPeaks};
use crate::solve::{self, Ask, Solution, SolveError, Wanted};
use crate::train::{Event, Pulse, PulseShape, Rule, Scenario, Train};

/// Why a march has no safe load factor.
const NO_FACTOR: &str = "with slack, friction or brakes forces do not grow in proportion to their cause";

/// What is to be solved.
pub(super) struct Case<'a> {
    pub train: &'a Train,
    pub scenario: &'a Scenario,
    /// The coupler that breaks, from 0.
    pub broken: Option<usize>,
    pub horizon_s: f64,
    /// End of the first passage, s.
    passage_s: f64,
    pub options: Cow<'a, Options>,
    shared: Shared<'a>,
}

impl<'a> Case<'a> {
    pub fn new(
        train: &'a Train,
        scenario: &'a Scenario,
        broken: Option<usize>,
        options: &'a Options,
        shared: Shared<'a>,
    ) -> Case<'a> {
        // After a break the coupler of the largest utilisation bounds the load; under a pulse another one may, and
        // another one may pass a limit.
        let only_worst = broken.is_some() && train.extras().limits.is_empty();
        let wanted = if only_worst { options.wanted } else { Wanted::Everything };
        let [horizon_s, passage_s] = scenario::ends_s(train, scenario, broken);
        let own = || Cow::Owned(Options { wanted, ..options.clone() });
        let options = if wanted == options.wanted { Cow::Borrowed(options) } else { own() };
        Case { train, scenario, broken, horizon_s, passage_s, options, shared }
    }

    fn motion(&self) -> Motion {
        Motion::of(self.train, self.scenario)
    }

    /// Extremes of every coupler up to the horizon, and to the end of the first passage if that is before it.
    ///
    /// # Errors
    /// A method that does not fit, or one that would take too long.
    pub fn solve(&self) -> Result<Solved, SolveError> {
        self.solve_on(self.train, [self.horizon_s, self.passage_s], &self.options)
    }

    /// What the solver is asked up to a time, and up to a mark if that is before it; the train may have other ratings than the case's.
    fn asked_parts(&self, train: &Train, [until_s, mark_s]: [f64; 2], options: &Options) -> AskedParts {
        let parts = scenario::parts(train, &self.scenario.event, self.broken, until_s);
        let scales = Scales::of(train);
        AskedParts { scales, parts, ask: ask(train, &scales, options, (mark_s < until_s).then_some(mark_s)) }
    }

    /// Extremes of every coupler of a train up to a time, and up to a mark if that is before it; the train may have other ratings
    /// than the case's.
    fn solve_on(&self, train: &Train, [until_s, mark_s]: [f64; 2], options: &Options) -> Result<Solved, SolveError> {
        match self.motion() {
            Motion::March => march::solved(train, self.scenario, self.broken, [until_s, mark_s], options),
            Motion::Steps => {
                let asked_parts = self.asked_parts(train, [until_s, mark_s], options);
                let solutions = self.shared.solve_all(&asked_parts.scenes());
                solved_by_parts(train, &asked_parts, solutions, options)
            }
            Motion::DampedModes(ratio) => {
                let asked_parts = self.asked_parts(train, [until_s, mark_s], options);
                let solved = |(scene, ask): (&Scene, Ask)| damped::solved(scene, ratio, &ask);
                let solutions = asked_parts.scenes().into_iter().map(solved).collect();
                solved_by_parts(train, &asked_parts, solutions, options)
            }
        }
    }

    /// The largest factor on the load, the force or the speed at which no coupler exceeds; `solved` is up to the horizon. A march
    /// of gears has none: forces do not grow in proportion to their cause.
    pub fn safe_load_factor(&self, solved: &Solved) -> Option<f64> {
        let Case { train, scenario, broken, horizon_s, .. } = *self;
        if !scenario::is_proportional(train, scenario) {
            return None;
        }
        if scenario::unbalanced_n(train, &scenario.event).iter().all(|f| *f == 0.0) {
            return safe_factor::safe_load_factor(train, &scenario.event, &solved.couplers, &solved.left_out);
        }
        let problem = scenario::march(train, scenario, broken, [horizon_s; 2], Rule::Keep);
        Some(safe_speed::find(&problem, &march::ratings_n(train)))
    }
}

/// The parts that a break or a rectangular pulse leaves, and what is asked of each.
struct AskedParts {
    scales: Scales,
    parts: Vec<Part>,
    ask: Ask,
}

impl AskedParts {
    fn scenes(&self) -> Vec<(&Scene, Ask)> {
        self.parts.iter().map(|part| (&part.scene, self.ask)).collect()
    }
}

/// How many cases of a scenario to give [`cases_findings`] at once.
pub(crate) fn cases_at_once(train: &Train, scenario: &Scenario) -> usize {
    if Motion::of(train, scenario) == Motion::Steps { solve::side_by_side(train.couplers().len()) } else { 1 }
}

/// Several cases of a scenario: what the event, or the break of one coupler, does to every coupler. Those that are undamped are solved
/// together.
pub(crate) fn cases_findings(
    train: &Train,
    scenario: &Scenario,
    broken: &[Option<usize>],
    options: &Options,
    shared: Shared,
) -> Vec<Result<CaseFindings, SolveError>> {
    let start = Instant::now();
    let cases: Vec<Case> = broken.iter().map(|&b| Case::new(train, scenario, b, options, shared)).collect();
    if Motion::of(train, scenario) != Motion::Steps {
        let findings = |case: &Case| {
            let start = Instant::now();
            let solved = case.solve()?;
            case_findings(case, solved, None, start.elapsed().as_secs_f64())
        };
        return cases.iter().map(findings).collect();
    }
    let asked_parts = |case: &Case| case.asked_parts(train, [case.horizon_s, case.passage_s], &case.options);
    let asked: Vec<AskedParts> = cases.iter().map(asked_parts).collect();
    let scenes: Vec<(&Scene, Ask)> = asked.iter().flat_map(AskedParts::scenes).collect();
    let mut solutions = shared.solve_all(&scenes).into_iter();
    let seconds = start.elapsed().as_secs_f64() / cases.len().max(1) as f64;
    let findings = |(case, asked_parts): (&Case, &AskedParts)| {
        let solutions = solutions.by_ref().take(asked_parts.parts.len()).collect();
        let solved = solved_by_parts(train, asked_parts, solutions, &case.options)?;
        case_findings(case, solved, rod_findings(&asked_parts.parts), seconds)
    };
    cases.iter().zip(&asked).map(findings).collect()
}

/// The findings of one case, from its solution, the rod's result where there is one, and the time that solving took, s.
fn case_findings(
    case: &Case,
    solved: Solved,
    rod: Option<RodFindings>,
    solved_s: f64,
) -> Result<CaseFindings, SolveError> {
    let start = Instant::now();
    let Case { train, scenario, broken, horizon_s, passage_s, ref options, .. } = *case;
    let safe_load_factor = case.safe_load_factor(&solved);
    let Solved {
        method,
        reason,
        tolerance_n,
        error_bound_n,
        error_estimate_n,
        mut couplers,
        worst,
        left_out,
        to_mark,
        marched,
    } = solved;
    let ending = marched.as_ref().and_then(|m| m.ending);
    let horizon_s = ending.map_or(horizon_s, |end| end.at_s);
    let cascade = cascade::find(train, scenario, broken, horizon_s, options)?.map(|found| found.note(&mut couplers));
    let search = || load_search::find(train, scenario, broken, horizon_s, options);
    let load_factor_search = marched.as_ref().and_then(|_| search());
    let margin_n = march::margin_n(error_bound_n, error_estimate_n);
    limits::find(train, &mut couplers, margin_n, |rated| {
        // The tolerance, a share of the largest rating, stays the same in N.
        let tolerance = options.tolerance * largest_rating_n(train) / largest_rating_n(rated);
        let wanted = Wanted::Everything;
        let options = Options { tolerance, wanted, verdict_only: false, ..Options::clone(options) };
        Ok(case.solve_on(rated, [horizon_s; 2], &options)?.couplers)
    })?;
    let error_n = march::error_n(error_bound_n, error_estimate_n);
    let passage = first_passage::note(&mut couplers, worst, horizon_s.min(passage_s), to_mark, error_n);
    Ok(CaseFindings {
        first_passage_s: passage.end_s,
        is_record: matches!(scenario.event, Event::Pulse(Pulse { shape: PulseShape::Record(_), .. })),
        exceeding_first_passage: passage.exceeding,
        worst_first_passage: passage.worst,
        kind: scenario.event.kind(),
        broken_coupler: broken.map(|b| b + 1),
        method,
        method_reason: reason,
        horizon_s,
        error_bound_n,
        error_estimate_n,
        predictable_until_s: ending.filter(|end| end.stopped_vehicle.is_none()).map(|end| end.at_s),
        stopped_vehicle: ending.and_then(|end| end.stopped_vehicle),
        stopped_at_s: ending.filter(|end| end.stopped_vehicle.is_some()).map(|end| end.at_s),
        gap_closures: closures(marched.as_ref()),
        tolerance_n,
        run_time_s: solved_s + start.elapsed().as_secs_f64(),
        exceeding: couplers.iter().filter(|c| c.exceeds == Some(true)).count(),
        undecided: couplers.iter().filter(|c| c.exceeds.is_none()).count(),
        safe_load_factor,
        no_safe_load_factor: marched.as_ref().map(|_| NO_FACTOR),
        load_factor_search,
        worst: worst.map(|i| couplers[i].clone()),
        couplers,
        left_out: left_out.len(),
        rod,
        cascade,
    })
}

fn closures(marched: Option<&Marched>) -> Vec<GapClosure> {
    let one = |&(coupler, time_s): &(usize, f64)| GapClosure { coupler: coupler + 1, time_s };
    marched.map_or_else(Vec::new, |m| m.closures.iter().map(one).collect())
}

/// Extremes of every coupler in the parts that a break or a rectangular pulse leaves.
fn solved_by_parts(
    train: &Train,
    AskedParts { scales, parts, ask }: &AskedParts,
    solutions: Vec<Result<Solution, SolveError>>,
    options: &Options,
) -> Result<Solved, SolveError> {
    let mut within = [(); 2].map(|()| (Vec::new(), Vec::new()));
    let (mut method, mut reason, mut telling) = ("none", "no coupler is left to watch".to_owned(), (false, 0));
    let (mut error_bound_n, mut left_out, mut only_worst) = (0.0f64, Vec::new(), false);
    for (part, solution) in parts.iter().zip(solutions) {
        let solution = solution?;
        let tells = (solution.error_bound > ask.tolerance, part.scene.initial.len());
        if tells > telling {
            telling = tells;
            method = if train.extras().damping_ratio > 0.0 { "damped-modes" } else { solution.method.name() };
            reason = solution.reason.clone();
        }
        let error_n = solution.error_bound * scales.force_n;
        error_bound_n = error_bound_n.max(error_n);
        only_worst |= solution.only_worst;
        let bound = |i: usize| solution.all_time_bounds.as_ref().map(|b| b[i] * scales.force_n);
        let left = solution.springs.iter().enumerate().filter(|(_, spring)| spring.is_none());
        left_out.extend(left.filter_map(|(i, _)| Some((part.first_coupler + i, bound(i)?))));
        let ratings = part.scene.rated_draft.iter().chain(&part.scene.rated_buff);
        let least_rating = ratings.fold(f64::INFINITY, |least, rating| least.min(*rating));
        for ((couplers, worst_of_parts), springs) in within.iter_mut().zip([&solution.springs, &solution.to_mark]) {
            let first = couplers.len();
            let matters = ReportedCouplers::new(&part.scene, springs, ask.wanted, solution.error_bound / least_rating);
            let all = springs.iter().enumerate().filter_map(|(i, peaks)| Some((i, peaks.as_ref()?)));
            let reported = all.filter(|(i, peaks)| matters.has(*i, peaks));
            couplers.reserve_exact(reported.clone().count());
            couplers.extend(reported.map(|(i, peaks)| {
                let bound = bound(i).filter(|_| options.all_time_bound);
                coupler_findings(train, part.first_coupler + i, &CouplerPeaks::new(peaks, scales, error_n), bound)
            }));
            worst_of_parts.extend(worst(couplers, first..couplers.len(), error_n));
        }
    }
    let [to_horizon, to_mark] = within.map(|(couplers, worst_of_parts)| {
        let worst = worst(&couplers, worst_of_parts, error_bound_n);
        PeriodFindings { couplers, worst }
    });
    let PeriodFindings { couplers, worst } = to_horizon;
    let mut to_mark = ask.mark.map(|_| to_mark);
    if let Some(within) = to_mark.as_mut().filter(|_| only_worst) {
        within.couplers.iter_mut().for_each(CouplerFindings::keep_one_sense);
    }
    let (tolerance_n, error_estimate_n, marched) = (ask.tolerance * scales.force_n, None, None);
    Ok(Solved {
        method,
        reason,
        tolerance_n,
        error_bound_n,
        error_estimate_n,
        couplers,
        worst,
        left_out,
        to_mark,
        marched,
    })
}

/// Which of a part's couplers are in the result.
struct ReportedCouplers<'a> {
    scene: &'a Scene,
    /// Below this utilisation a coupler is certainly not the worst.
    least: f64,
}

impl ReportedCouplers<'_> {
    /// `error` is the most that a utilisation may be off.
    fn new<'a>(scene: &'a Scene, springs: &[Option<SpringPeaks>], wanted: Wanted, error: f64) -> ReportedCouplers<'a> {
        let mut matters = ReportedCouplers { scene, least: f64::NEG_INFINITY };
        if wanted == Wanted::Worst {
            let uses =
                springs.iter().enumerate().filter_map(|(i, peaks)| Some(matters.utilisation(i, peaks.as_ref()?)));
            matters.least = uses.fold(0.0, f64::max) - 2.0 * error;
        }
        matters
    }

    fn utilisation(&self, i: usize, peaks: &SpringPeaks) -> f64 {
        let [draft, buff] = [&peaks.draft, &peaks.buff].map(|side| side.best.value);
        (draft / self.scene.rated_draft[i]).max(buff / self.scene.rated_buff[i])
    }

    /// Those that are wanted: all, or those that may be the worst or over their rating.
    fn has(&self, i: usize, peaks: &SpringPeaks) -> bool {
        let is_under = |side: &Side| side.exceeds() == Some(false);
        !(is_under(&peaks.draft) && is_under(&peaks.buff)) || self.utilisation(i, peaks) >= self.least
    }
}

/// The rod's result of all couplers; `None` if a part's vehicles or couplers differ, or none is left.
fn rod_findings(parts: &[Part]) -> Option<RodFindings> {
    let mut findings = RodFindings { exceeding: 0, utilisation: 0.0 };
    for Part { scene, .. } in parts {
        let rod = Rod::new(scene)?;
        for (i, (draft, buff)) in scene.rated_draft.iter().zip(&scene.rated_buff).enumerate() {
            let (high, low) = rod.extremes(i);
            let utilisation = (high / draft).max(-low / buff);
            findings.exceeding += usize::from(utilisation > 1.0);
            findings.utilisation = findings.utilisation.max(utilisation);
        }
    }
    (!parts.is_empty()).then_some(findings)
}
