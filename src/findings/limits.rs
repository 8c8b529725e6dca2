//! Which capacities besides its rating each coupler passes, in draft and in buff.

use serde::Serialize;

use super::{CouplerFindings, of_number};
use crate::solve::SolveError;
use crate::train::{LIMITS, SENSES, Train};

/// A coupler's largest forces against its other capacities.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LimitFindings {
    /// Largest |force| in either sense, N.
    pub largest_n: f64,
    /// Names of those that it certainly passes, in draft or in buff.
    pub passed: Vec<&'static str>,
    /// Names of those that it certainly passes in neither sense, and for which it is not decided in at least one.
    pub undecided: Vec<&'static str>,
    /// Each capacity that was given, in each sense in which it was.
    pub by_sense: Vec<LimitInSense>,
}

/// Whether a coupler may pass one of its limits while it is under its rating: a bound under the rating then decides no
/// limit.
pub(crate) fn any_below_rating(train: &Train) -> bool {
    train.couplers().iter().zip(&train.extras().limits).any(|(coupler, limits)| {
        let ratings = [coupler.rated_draft_n, coupler.rated_buff_n];
        let below =
            |(rating, limits): (f64, [Option<f64>; 3])| limits.into_iter().flatten().any(|limit| limit < rating);
        ratings.into_iter().zip(limits.in_senses()).any(below)
    })
}

/// A coupler's largest force in one sense against one capacity.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LimitInSense {
    /// `fatigue`, `proof` or `ultimate`.
    pub limit: &'static str,
    /// `draft` or `buff`.
    pub sense: &'static str,
    /// The capacity, N, positive.
    pub limit_n: f64,
    /// Largest |force| in this sense, N; 0 if there never is one.
    pub largest_n: f64,
    /// What is left of the capacity, a share of it: `1 - largest_n / limit_n`; negative where it is passed.
    pub margin: f64,
    /// Whether the largest force is above the capacity; `None`: not decided.
    pub passed: Option<bool>,
}

impl LimitFindings {
    fn new(by_sense: Vec<LimitInSense>) -> LimitFindings {
        let some = |name: &str, passed: Option<bool>| by_sense.iter().any(|l| l.limit == name && l.passed == passed);
        let passed = |name: &&str| some(name, Some(true));
        LimitFindings {
            largest_n: 0.0,
            passed: LIMITS.into_iter().filter(passed).collect(),
            undecided: LIMITS.into_iter().filter(|name| !passed(name) && some(name, None)).collect(),
            by_sense,
        }
    }
}

/// A capacity that equals the load before the event within the error: whether it is passed depends on how the force
/// changes from there.
struct AtTheLoad {
    /// Index of the coupler in the findings.
    place: usize,
    /// Index in its capacities.
    entry: usize,
}

/// Adds limits to the findings, if any; every force after t = 0 is exact to `error_bound_n`.
///
/// A capacity at the load is judged as a rating at the load is: `solve` solves the same case of a train in which such
/// capacities are the ratings, and gives their verdicts.
///
/// # Errors
/// As for the case itself.
pub(super) fn find(
    train: &Train,
    couplers: &mut [CouplerFindings],
    error_bound_n: f64,
    solve: impl Fn(&Train) -> Result<Vec<CouplerFindings>, SolveError>,
) -> Result<(), SolveError> {
    if train.extras().limits.is_empty() {
        return Ok(());
    }
    let (mut all, mut open): (Vec<Vec<LimitInSense>>, Vec<AtTheLoad>) = (Vec::new(), Vec::new());
    for (place, c) in couplers.iter().enumerate() {
        let entries = against(train, c, error_bound_n);
        let before = |sense| if sense == SENSES[0] { c.initial_force_n } else { -c.initial_force_n };
        let at_the_load = |l: &LimitInSense| l.passed.is_none() && (before(l.sense) - l.limit_n).abs() <= error_bound_n;
        let at = entries.iter().enumerate().filter(|(_, l)| at_the_load(l));
        open.extend(at.map(|(entry, _)| AtTheLoad { place, entry }));
        all.push(entries);
    }
    while !open.is_empty() {
        decide_open_limits(train, couplers, &mut all, &mut open, &solve)?;
    }
    for (c, entries) in couplers.iter_mut().zip(all) {
        let [draft, buff] = largest_n(c);
        c.limits = Some(LimitFindings { largest_n: draft.max(buff), ..LimitFindings::new(entries) });
    }
    Ok(())
}

/// Largest |force| in draft and in buff, N; 0 where there never is one.
fn largest_n(c: &CouplerFindings) -> [f64; 2] {
    [c.peak_draft_n.unwrap_or(0.0), c.peak_buff_n.map_or(0.0, f64::abs)]
}

/// A coupler's largest forces against each of its capacities.
fn against(train: &Train, c: &CouplerFindings, error_bound_n: f64) -> Vec<LimitInSense> {
    let largest = largest_n(c);
    let limits = train.extras().limits.get(c.coupler - 1).copied().unwrap_or_default();
    let mut entries = Vec::new();
    for (sense, capacities) in limits.in_senses().into_iter().enumerate() {
        for (limit, limit_n) in LIMITS.into_iter().zip(capacities).filter_map(|(name, n)| Some((name, n?))) {
            let largest_n = largest[sense];
            let over = largest_n - limit_n;
            let passed = (over > error_bound_n || over < -error_bound_n || error_bound_n == 0.0).then_some(over > 0.0);
            let margin = 1.0 - largest_n / limit_n;
            entries.push(LimitInSense { limit, sense: SENSES[sense], limit_n, largest_n, margin, passed });
        }
    }
    entries
}

/// Solves with one open capacity of each side of each coupler as its rating, and stores the verdicts.
fn decide_open_limits(
    train: &Train,
    couplers: &[CouplerFindings],
    all: &mut [Vec<LimitInSense>],
    open: &mut Vec<AtTheLoad>,
    solve: &impl Fn(&Train) -> Result<Vec<CouplerFindings>, SolveError>,
) -> Result<(), SolveError> {
    let mut rated = train.couplers().to_vec();
    let mut asked: Vec<(AtTheLoad, usize)> = Vec::new();
    let mut later = Vec::new();
    for at in open.drain(..) {
        let limit = &all[at.place][at.entry];
        let side = usize::from(limit.sense != SENSES[0]);
        if asked.iter().rev().take(2).any(|(other, s)| other.place == at.place && *s == side) {
            later.push(at);
            continue;
        }
        let coupler = &mut rated[couplers[at.place].coupler - 1];
        *[&mut coupler.rated_draft_n, &mut coupler.rated_buff_n][side] = limit.limit_n;
        asked.push((at, side));
    }
    let found = solve(&train.with_couplers(rated))?;
    for (at, side) in asked {
        let number = couplers[at.place].coupler;
        all[at.place][at.entry].passed = of_number(&found, number).and_then(|c| c.exceeds_in[side]);
    }
    *open = later;
    Ok(())
}
