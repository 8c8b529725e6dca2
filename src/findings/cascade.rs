//! What breaks next: couplers that pass the load that breaks them break, and the computation goes on with the pieces.

use std::collections::BTreeSet;

use serde::Serialize;

use super::march::Period;
use super::{CouplerFindings, GapClosure, Options, PeakForces, of_number, worst};
use crate::march::{self, MarchOptions, MarchOutcome};
use crate::scenario;
use crate::solve::SolveError;
use crate::train::{LIMITS, Rule, Scenario, Train};

/// The course of a cascade.
#[derive(Clone, Debug, Serialize)]
pub struct CascadeFindings {
    /// Whether a coupler also breaks in buff; if not, one that passes its breaking load there is kept.
    pub buff_breaks: bool,
    /// Which keys give the loads that break couplers, each once: `ultimate`, `rated_load`, `rated_buff`.
    pub breaks_at: Vec<&'static str>,
    /// Couplers that break after the event, in order.
    pub breaks: Vec<CascadeBreak>,
    /// First and last vehicle of each piece that is left, counted from 1.
    pub pieces: Vec<[usize; 2]>,
    /// Couplers that certainly pass their breaking load in buff and are kept, counted from 1.
    pub kept_in_buff: Vec<usize>,
    /// From when on the sequence is not decided, s: a coupler came within the error bound of its breaking load, or was
    /// there before the event, and whether it breaks, or breaks before another, is not known. Later breaks are those
    /// of a train in which it holds until it is certainly over that load.
    pub undecided_from_s: Option<f64>,
    /// That coupler, counted from 1.
    pub undecided_coupler: Option<usize>,
    /// When the gap at a broken coupler first closes, s: its vehicles would push each other from then on, which is not computed,
    /// so that nothing here holds of later times.
    pub gap_closes_s: Option<f64>,
    /// That coupler, counted from 1.
    pub gap_coupler: Option<usize>,
    /// When vehicles at parted couplers come together again and push each other, where that is computed: with slack, gears, brakes or
    /// changing tractive efforts.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub gap_closures: Vec<GapClosure>,
    /// Couplers that exceed their rating before they break, or at any time if they do not.
    pub exceeding: usize,
    /// The coupler with the largest utilisation of all but the one that the event breaks.
    pub worst: Option<CascadeWorst>,
    /// No force is further than this from the exact one, N, the errors of the breaks' instants included; infinite where nothing is
    /// proven.
    pub error_bound_n: f64,
    /// An estimate of that error, N, where nothing is proven.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error_estimate_n: Option<f64>,
}

impl CascadeFindings {
    /// Error of every force, N: proven, or else estimated.
    pub fn error_n(&self) -> f64 {
        super::march::error_n(self.error_bound_n, self.error_estimate_n)
    }

    /// From when on forces are not those of the train, s: the sequence is undecided, or a gap has closed whose vehicles would push
    /// each other.
    pub fn certain_until_s(&self) -> f64 {
        self.undecided_from_s.into_iter().chain(self.gap_closes_s).fold(f64::INFINITY, f64::min)
    }
}

/// The coupler with the largest utilisation in a cascade.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CascadeWorst {
    /// Counted from 1.
    pub coupler: usize,
    /// Its force of the largest utilisation, N, draft positive.
    pub peak_force_n: f64,
    /// When, s after the event.
    pub peak_time_s: f64,
    /// That force over the rating in its sign, a share.
    pub utilisation: f64,
}

/// A cascade with the largest forces of every coupler but the one that the event breaks.
pub(super) struct Found {
    cascade: CascadeFindings,
    couplers: Vec<CouplerFindings>,
}

impl Found {
    fn new(mut cascade: CascadeFindings, mut couplers: Vec<CouplerFindings>) -> Found {
        let until_s = cascade.certain_until_s();
        let at_rating = |b: &&CascadeBreak| b.breaks_at != LIMITS[2] && b.time_s < until_s;
        let broken: Vec<usize> = cascade.breaks.iter().filter(at_rating).map(|b| b.coupler).collect();
        for c in &mut couplers {
            // What breaks at its rating has passed it; elsewhere a larger force may follow in another sequence.
            let over = c.exceeds == Some(true) && c.peak_time_s < until_s || broken.contains(&c.coupler);
            c.exceeds = if over { Some(true) } else { c.exceeds.filter(|_| until_s == f64::INFINITY) };
        }
        cascade.exceeding = couplers.iter().filter(|c| c.exceeds == Some(true)).count();
        let of = |i: usize| {
            let CouplerFindings { coupler, peak_force_n, peak_time_s, utilisation, .. } = couplers[i];
            CascadeWorst { coupler, peak_force_n, peak_time_s, utilisation }
        };
        cascade.worst = worst(&couplers, 0..couplers.len(), cascade.error_n()).map(of);
        Found { cascade, couplers }
    }

    /// The cascade, its forces noted with the couplers.
    pub(super) fn note(self, couplers: &mut [CouplerFindings]) -> CascadeFindings {
        for c in couplers {
            let of = |found: &CouplerFindings| PeakForces {
                error_estimate_n: found.error_estimate_n,
                ..PeakForces::of(found)
            };
            c.cascade = of_number(&self.couplers, c.coupler).map(of);
        }
        self.cascade
    }
}

/// A coupler that breaks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CascadeBreak {
    /// When, s after the event; 0 if the load alone is over its breaking load.
    pub time_s: f64,
    /// Error bound of this instant, s; an estimate where that of the forces is one.
    pub time_uncertainty_s: f64,
    /// Counted from 1.
    pub coupler: usize,
    /// Labels of the vehicles it joins.
    pub between: [String; 2],
    /// Its force when it breaks, N, draft positive.
    pub force_n: f64,
    /// The key that gives the load at which it breaks: `ultimate`, `rated_load` or `rated_buff`.
    pub breaks_at: &'static str,
    /// Others break at the same instant, within its error.
    pub together: bool,
    /// Elastic energy that it releases, J, not negative; of a gear that of its unloading. 0 in buff where the vehicles go on
    /// pushing each other ([`CascadeFindings::gap_closures`]).
    pub energy_j: f64,
}

/// Follows a cascade; `None` if the scenario has none.
///
/// # Errors
/// [`SolveError::TooMuch`] if the march would take over an hour.
pub(super) fn find(
    train: &Train,
    scenario: &Scenario,
    broken: Option<usize>,
    horizon_s: f64,
    options: &Options,
) -> Result<Option<Found>, SolveError> {
    if scenario.cascade == Rule::Keep {
        return Ok(None);
    }
    let proportional = scenario::is_proportional(train, scenario);
    let problem = scenario::march(train, scenario, broken, [horizon_s; 2], scenario.cascade);
    let loads = |i: usize| scenario::break_loads(train, i);
    // Couplers kept in buff are judged by their breaking load.
    let capacity_n = train.couplers().iter().enumerate().map(|(i, c)| [c.rated_draft_n, loads(i)[1].0]).collect();
    let ask = MarchOptions { capacity_n, ..super::march::ask(train, options) };
    let outcome = super::march::within_an_hour(&problem, &ask, super::march::method(proportional))?;
    let (error_bound_n, error_estimate_n) = super::march::errors(&outcome.bound);
    let one = |p: &march::Parting| CascadeBreak {
        time_s: p.time_s,
        time_uncertainty_s: p.uncertainty_s,
        coupler: p.coupler + 1,
        between: [train.vehicles()[p.coupler].label.clone(), train.vehicles()[p.coupler + 1].label.clone()],
        force_n: p.force_n,
        breaks_at: loads(p.coupler)[usize::from(p.force_n < 0.0)].1,
        together: outcome.partings.iter().any(|other| other != p && other.time_s == p.time_s),
        energy_j: p.energy_j,
    };
    let breaks: Vec<CascadeBreak> = outcome.partings.iter().filter(|p| Some(p.coupler) != broken).map(one).collect();
    let gone = |i: usize| Some(i) == broken || breaks.iter().any(|b| b.coupler == i + 1);
    let open = if proportional {
        at_breaking_load(train, scenario, broken).map(|i| (i, 0.0)).or(outcome.undecided)
    } else {
        near_breaking_load(train, scenario, &outcome, gone)
    };
    let ending_s = super::march::ending(&outcome).map(|end| end.at_s);
    let undecided_from_s = open.map(|(_, at_s)| at_s).or(ending_s);
    let kept = |i: &usize| {
        // Once the sequence is undecided, nothing is certain.
        let in_time = outcome.first_over_s[*i][1].is_some_and(|at_s| at_s < undecided_from_s.unwrap_or(f64::INFINITY));
        let over_n = -outcome.extremes[*i].buff.force_n - loads(*i)[1].0;
        !gone(*i) && in_time && (proportional || over_n > super::march::margin_n(error_bound_n, error_estimate_n))
    };
    let closures = || outcome.closures.iter().map(|&(i, time_s)| GapClosure { coupler: i + 1, time_s });
    let closed = closures().next().filter(|_| proportional);
    let couplers = super::march::of_couplers(train, scenario, broken, &outcome, Period::Cascade);
    let found = CascadeFindings {
        buff_breaks: scenario.cascade == Rule::InBoth,
        breaks_at: breaks_at(train, scenario.cascade),
        pieces: pieces(train.vehicles().len(), gone),
        kept_in_buff: (0..train.couplers().len()).filter(kept).map(|i| i + 1).collect(),
        undecided_from_s,
        undecided_coupler: open.map(|(i, _)| i + 1),
        gap_closes_s: closed.map(|gap| gap.time_s),
        gap_coupler: closed.map(|gap| gap.coupler),
        gap_closures: if proportional { Vec::new() } else { closures().collect() },
        exceeding: 0,
        worst: None,
        error_bound_n,
        error_estimate_n,
        breaks,
    };
    Ok(Some(Found::new(found, couplers)))
}

/// Where breaks are not proven: the first unbroken coupler with a peak so near to its breaking load that it may break, and the earlier
/// of its peaks in draft and buff.
fn near_breaking_load(
    train: &Train,
    scenario: &Scenario,
    outcome: &MarchOutcome,
    gone: impl Fn(usize) -> bool,
) -> Option<(usize, f64)> {
    let (error_bound_n, error_estimate_n) = super::march::errors(&outcome.bound);
    let margin_n = super::march::margin_n(error_bound_n, error_estimate_n);
    let senses = if scenario.cascade == Rule::InBoth { 2 } else { 1 };
    let near = |&i: &usize| {
        let peaks = &outcome.extremes[i];
        let largest_n = [peaks.draft.force_n, -peaks.buff.force_n].into_iter().zip(scenario::break_loads(train, i));
        !gone(i) && largest_n.take(senses).any(|(largest_n, (load_n, _))| (largest_n - load_n).abs() <= margin_n)
    };
    let at_s = |i: usize| outcome.extremes[i].draft.time_s.min(outcome.extremes[i].buff.time_s);
    let all = (0..outcome.extremes.len()).filter(near).map(|i| (i, at_s(i)));
    all.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// The first coupler whose load before the event equals the load that breaks it, to the rounding of the load: it may break at t = 0.
fn at_breaking_load(train: &Train, scenario: &Scenario, broken: Option<usize>) -> Option<usize> {
    let load_n = scenario::initial_force_n(train, &scenario.event);
    let sides = if scenario.cascade == Rule::InBoth { 2 } else { 1 };
    let may_break = |&i: &usize| {
        let of_sides = [load_n[i], -load_n[i]].into_iter().zip(scenario::break_loads(train, i)).take(sides);
        Some(i) != broken && of_sides.into_iter().any(|(load, (at, _))| train.rounding_decides(i, load, at))
    };
    (0..load_n.len()).find(may_break)
}

/// The keys that give the loads that break couplers.
fn breaks_at(train: &Train, rule: Rule) -> Vec<&'static str> {
    let senses = if rule == Rule::InBoth { 2 } else { 1 };
    let loads = (0..train.couplers().len()).flat_map(|i| scenario::break_loads(train, i).into_iter().take(senses));
    let keys: BTreeSet<_> = loads.map(|l| l.1).collect();
    keys.into_iter().rev().collect()
}

/// First and last vehicle, counted from 1, of each piece.
fn pieces(vehicles: usize, gone: impl Fn(usize) -> bool) -> Vec<[usize; 2]> {
    let mut first = 1;
    let mut pieces = Vec::new();
    for last in 1..=vehicles {
        if last == vehicles || gone(last - 1) {
            pieces.push([first, last]);
            first = last + 1;
        }
    }
    pieces
}
