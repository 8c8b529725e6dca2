//! What breaks next: couplers that pass the load that breaks them break, and the computation goes on with the pieces.

use std::collections::BTreeSet;

use serde::Serialize;

use super::{CouplerFindings, CouplerPeaks, GapClosure, Options, PeakForces, coupler_findings, of_number, worst};
use crate::march;
use crate::play::Rule;
use crate::scenario::{self, Motion, Scales};
use crate::solve::watch::SpringPeaks;
use crate::solve::{SolveError, taylor};
use crate::train::{LIMITS, Scenario, Train};

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
    /// When vehicles at parted couplers come together again and push each other, which is computed: couplers with slack or gears, or
    /// brakes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub gap_closures: Vec<GapClosure>,
    /// Couplers that exceed their rating before they break, or at any time if they do not.
    pub exceeding: usize,
    /// The coupler with the largest utilisation of all but the one that the event breaks.
    pub worst: Option<CascadeWorst>,
    /// No force is further than this from the exact one, N, the instants of the breaks included; infinite where nothing is proven.
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

    /// From when on forces are not those of the train, s: the sequence is not decided, or a gap closed whose vehicles would push each other.
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
    /// When, s after the event; 0 if the load alone is over its rating.
    pub time_s: f64,
    /// Error bound of this instant, s; of a march an estimate, like that of its forces.
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
    /// Elastic energy that it releases, J, not negative; of a gear that of its unloading. Of a march 0 in buff, where
    /// the vehicles still push each other.
    pub energy_j: f64,
}

/// Follows a cascade; `None` if the scenario has none.
///
/// # Errors
/// [`SolveError::TooMuch`].
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
    if Motion::of(train, scenario) == Motion::Events {
        return Ok(Some(marched(train, scenario, broken, horizon_s, options)));
    }
    let scales = Scales::of(train);
    let mut play = scenario::play(train, scenario, broken, horizon_s, scenario.cascade);
    // Couplers kept in buff are judged by their breaking load.
    play.scene.rated_buff = play.break_at.iter().map(|[_, buff]| *buff).collect();
    let outcome = taylor::solve(&play)?;
    let loads = |i: usize| scenario::break_loads(train, i);
    let breaks: Vec<CascadeBreak> = outcome
        .breakages
        .iter()
        .flat_map(|at| at.springs.iter().zip(&at.force).map(move |(&i, force)| (at, i, force * scales.force_n)))
        .map(|(at, i, force_n)| CascadeBreak {
            time_s: at.time * scales.time_s,
            time_uncertainty_s: at.uncertainty * scales.time_s,
            coupler: i + 1,
            between: [train.vehicles()[i].label.clone(), train.vehicles()[i + 1].label.clone()],
            force_n,
            breaks_at: loads(i)[usize::from(force_n < 0.0)].1,
            together: at.springs.len() > 1,
            energy_j: at.energy[at.springs.iter().position(|s| *s == i).unwrap_or(0)]
                * scales.force_n
                * (scales.force_n / scales.stiffness_n_per_m),
        })
        .collect();
    let gone = |i: usize| Some(i) == broken || breaks.iter().any(|b| b.coupler == i + 1);
    let at_its_load = at_breaking_load(train, scenario, broken).map(|i| (i, 0.0));
    let open = at_its_load.or(outcome.open);
    // Once the sequence is undecided, nothing is certain.
    let certain = open.map_or(f64::INFINITY, |(_, t)| t);
    let over = |i: &usize| !gone(*i) && outcome.springs[*i].buff.first_over.is_some_and(|t| t < certain);
    let kept_in_buff = (0..train.couplers().len()).filter(over).map(|i| i + 1).collect();
    let error_bound_n = outcome.error_bound * scales.force_n;
    let seen = |(i, peaks): (usize, &SpringPeaks)| {
        let CouplerPeaks { largest, error_n, .. } = CouplerPeaks::new(peaks, &scales, error_bound_n);
        let ratings = [train.couplers()[i].rated_draft_n, train.couplers()[i].rated_buff_n];
        let exceeds = [0, 1].map(|side| {
            let (at_s, over_n) = (largest[side].1, largest[side].0 - ratings[side]);
            // The force before the event is known as it is given.
            let is_known = over_n.abs() > error_bound_n || at_s == 0.0;
            is_known.then_some(over_n > 0.0)
        });
        coupler_findings(train, i, &CouplerPeaks { largest, exceeds, first_over_s: [None; 2], error_n }, None)
    };
    let couplers = outcome.springs.iter().enumerate().filter(|(i, _)| Some(*i) != broken).map(seen).collect();
    let found = CascadeFindings {
        buff_breaks: scenario.cascade == Rule::InBoth,
        breaks_at: breaks_at(train, scenario.cascade),
        pieces: pieces(train.vehicles().len(), gone),
        breaks,
        kept_in_buff,
        undecided_from_s: open.map(|(_, t)| t * scales.time_s),
        undecided_coupler: open.map(|(i, _)| i + 1),
        gap_closes_s: outcome.gap_closes.map(|(_, t)| t * scales.time_s),
        gap_coupler: outcome.gap_closes.map(|(i, _)| i + 1),
        gap_closures: vec![],
        exceeding: 0,
        worst: None,
        error_estimate_n: None,
        error_bound_n,
    };
    Ok(Some(Found::new(found, couplers)))
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

/// A cascade that is marched: what has parted pushes again where a gap closes.
fn marched(train: &Train, scenario: &Scenario, broken: Option<usize>, horizon_s: f64, options: &Options) -> Found {
    let problem = scenario::march(train, scenario, broken, [horizon_s; 2], scenario.cascade);
    let outcome = march::solve(&problem, &super::march::ask(train, options));
    let (error_bound_n, error_estimate_n) = super::march::errors(&outcome.bound);
    let margin_n = super::march::margin_n(error_bound_n, error_estimate_n);
    let loads = |i: usize| scenario::break_loads(train, i);
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
    let whole = || (0..train.couplers().len()).filter(|i| !gone(*i));
    let over_n = |i: usize, side: usize| {
        let peaks = &outcome.extremes[i];
        [(peaks.draft.force_n, peaks.draft.time_s), (-peaks.buff.force_n, peaks.buff.time_s)][side].0 - loads(i)[side].0
    };
    let senses: &[usize] = if scenario.cascade == Rule::InBoth { &[0, 1] } else { &[0] };
    let near = whole().filter(|&i| senses.iter().any(|&side| over_n(i, side).abs() <= margin_n));
    let at_s = |i: usize| outcome.extremes[i].draft.time_s.min(outcome.extremes[i].buff.time_s);
    let open = near.min_by(|a, b| at_s(*a).total_cmp(&at_s(*b)));
    let found = CascadeFindings {
        buff_breaks: scenario.cascade == Rule::InBoth,
        breaks_at: breaks_at(train, scenario.cascade),
        pieces: pieces(train.vehicles().len(), gone),
        kept_in_buff: whole().filter(|&i| over_n(i, 1) > margin_n).map(|i| i + 1).collect(),
        undecided_from_s: open.map(at_s).or(super::march::ending(&outcome).map(|end| end.at_s)),
        undecided_coupler: open.map(|i| i + 1),
        gap_closes_s: None,
        gap_coupler: None,
        gap_closures: outcome.closures.iter().map(|&(i, time_s)| GapClosure { coupler: i + 1, time_s }).collect(),
        exceeding: 0,
        worst: None,
        error_bound_n,
        error_estimate_n,
        breaks,
    };
    Found::new(found, super::march::of_couplers(train, scenario, broken, &outcome, false))
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
