//! What happens to the train: a coupler breaks, a force strikes a vehicle, or vehicles run into it.

pub(crate) mod brakes;
mod marches;
mod motion;
mod start;

use crate::chain::{Chain, Scene};
use crate::train::{Event, Scenario, Train, Vehicle};

pub use marches::march;
pub(crate) use motion::{Motion, is_proportional};
pub use start::initial_force_n;
pub(crate) use start::{break_loads, unbalanced_n};

/// A part of the train that stays together after the event, in the solvers' units.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Its chain and event.
    pub scene: Scene,
    /// Index in the train of the scene's first coupler.
    pub first_coupler: usize,
}

/// The solvers' units in SI. All are powers of two, and the square of the time is exactly mass over stiffness: scaling
/// rounds no number of the train.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// kg
    pub mass_kg: f64,
    /// N/m
    pub stiffness_n_per_m: f64,
    /// s
    pub time_s: f64,
    /// N
    pub force_n: f64,
}

impl Scales {
    /// Scales at the size of the train's own numbers.
    pub fn of(train: &Train) -> Scales {
        let exponent = |x: f64| x.log2().floor() as i32;
        let mass = exponent(train.vehicles().iter().find(|v| !v.held).map_or(1.0, |v| v.mass_kg));
        let stiffness = exponent(train.couplers().first().map_or(1.0, |c| c.stiffness_n_per_m));
        let half = (mass - stiffness).div_euclid(2);
        let force = train.couplers().iter().map(|c| c.rated_draft_n.max(c.rated_buff_n)).fold(0.0, f64::max);
        Scales {
            mass_kg: f64::exp2(f64::from(stiffness + 2 * half)),
            stiffness_n_per_m: f64::exp2(f64::from(stiffness)),
            time_s: f64::exp2(f64::from(half)),
            force_n: f64::exp2(f64::from(exponent(force))),
        }
    }
}

/// The parts after a break, or the train under a rectangular pulse, each with its step or pulse of force; without
/// parts that have no coupler.
///
/// A break of coupler b removes its force F_b: `+F_b` acts on the last vehicle of the front part, `-F_b` on the first
/// of the rear part, and all other forces stay (superposition on the steady state).
pub fn parts(train: &Train, event: &Event, broken: Option<usize>, horizon_s: f64) -> Vec<Part> {
    let scales = Scales::of(train);
    let last = train.vehicles().len() - 1;
    let cut = |vehicles: std::ops::RangeInclusive<usize>, source: usize, force_n: f64, duration_s: f64| {
        let (from, to) = (*vehicles.start(), *vehicles.end());
        let couplers = &train.couplers()[from..to];
        let force = |n: f64| n / scales.force_n;
        let chain = chain_of(train, from, to, &scales);
        let scene = Scene {
            chain,
            source: source - from,
            force: force(force_n),
            duration: duration_s / scales.time_s,
            initial: train.initial_force_n()[from..to].iter().map(|&f| force(f)).collect(),
            rated_draft: couplers.iter().map(|c| force(c.rated_draft_n)).collect(),
            rated_buff: couplers.iter().map(|c| force(c.rated_buff_n)).collect(),
            horizon: horizon_s / scales.time_s,
        };
        Part { scene, first_coupler: from }
    };
    let parts = match (event, broken) {
        (Event::Pulse(p), None) if !event.beyond_steps() => vec![cut(0..=last, p.vehicle, p.force_n, p.duration_s)],
        (Event::Break { .. }, Some(b)) => {
            let lost = train.initial_force_n()[b];
            vec![cut(0..=b, b, lost, f64::INFINITY), cut(b + 1..=last, b + 1, -lost, f64::INFINITY)]
        }
        // The others are no steps of force from rest: see [`play`].
        (Event::Break { .. } | Event::Pulse(_) | Event::Impact { .. } | Event::Brake { .. }, _) => vec![],
    };
    parts.into_iter().filter(|p| !p.scene.initial.is_empty()).collect()
}

fn chain_of(train: &Train, from: usize, to: usize, scales: &Scales) -> Chain {
    Chain {
        mass: train.vehicles()[from..=to].iter().map(|v| v.mass_kg / scales.mass_kg).collect(),
        stiffness: train.couplers()[from..to].iter().map(|c| c.stiffness_n_per_m / scales.stiffness_n_per_m).collect(),
        held_head: train.vehicles()[from].held,
        held_tail: train.vehicles()[to].held,
    }
}

/// When an outside force changes for the last time after an event, s: 0 for breaks and impacts without brakes. `broken` is the
/// coupler that breaks in a case of a break.
pub fn last_change_s(train: &Train, scenario: &Scenario, broken: Option<usize>) -> f64 {
    let of_event = match &scenario.event {
        Event::Break { .. } | Event::Impact { .. } | Event::Brake { .. } => 0.0,
        Event::Pulse(pulse) => pulse.drive().last_change(),
    };
    of_event.max(brakes::last_change_s(train, scenario, broken))
}

/// One-way transit of a wave through the longest part that a case leaves, s.
pub(crate) fn longest_transit_s(train: &Train, broken: Option<usize>) -> f64 {
    let scales = Scales::of(train);
    let last = train.vehicles().len() - 1;
    let transit = |from: usize, to: usize| scales.time_s * chain_of(train, from, to, &scales).transit();
    match broken {
        None => transit(0, last),
        Some(b) => transit(0, b).max(transit(b + 1, last)),
    }
}

/// The horizon of a scenario's case, s: the file's, or the last change of the forces from outside and four one-way wave transits
/// of the longest part.
pub fn horizon_s(train: &Train, scenario: &Scenario, broken: Option<usize>) -> f64 {
    scenario.horizon_s.unwrap_or_else(|| ends_s(train, scenario, broken)[0])
}

/// The horizon of a scenario's case, and the end of its first passage, s: the last change of the forces from outside and two one-way
/// transits of the longest part, if that is before the horizon.
pub(crate) fn ends_s(train: &Train, scenario: &Scenario, broken: Option<usize>) -> [f64; 2] {
    let (changed_s, transit_s) = (last_change_s(train, scenario, broken), longest_transit_s(train, broken));
    let horizon_s = scenario.horizon_s.unwrap_or(changed_s + 4.0 * transit_s);
    [horizon_s, horizon_s.min(changed_s + 2.0 * transit_s)]
}

/// Shortest horizon of a scenario's cases, s.
///
/// From the head to the tail the front part grows and the rear part shrinks, so that the longest part's transit first
/// falls, then rises. Its smallest value is found by halving.
pub(crate) fn shortest_horizon_s(train: &Train, scenario: &Scenario) -> f64 {
    let Event::Break { couplers } = &scenario.event else { return horizon_s(train, scenario, None) };
    let mut couplers = couplers.clone();
    couplers.sort_unstable();
    let at = |i: usize| horizon_s(train, scenario, couplers.get(i).copied());
    let (mut low, mut high) = (0, couplers.len().saturating_sub(1));
    while low < high {
        let middle = (low + high) / 2;
        if at(middle + 1) < at(middle) { low = middle + 1 } else { high = middle }
    }
    at(low)
}

/// Longest horizon of a scenario's cases, s: that of a break nearest to an end.
pub(crate) fn longest_horizon_s(train: &Train, scenario: &Scenario) -> f64 {
    let Event::Break { couplers } = &scenario.event else { return horizon_s(train, scenario, None) };
    let ends = [couplers.iter().min(), couplers.iter().max()];
    ends.into_iter().map(|b| horizon_s(train, scenario, b.copied())).fold(0.0, f64::max)
}

/// How fast long waves run through a train.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// `sqrt(mass / stiffness)`, the model's unit of time, s: the mean over the train's couplers where they differ.
    pub time_unit_s: f64,
    /// Vehicles that a wave passes in a second, 1/s.
    pub vehicles_per_s: f64,
    /// Speed of a long wave, m/s, where every vehicle has a length.
    pub metres_per_s: Option<f64>,
    /// From one end of the train to the other, s.
    pub transit_s: f64,
}

/// The wave scales of a whole train.
pub fn wave(train: &Train) -> Wave {
    let scales = Scales::of(train);
    let couplers = train.couplers().len() as f64;
    let transit_s = scales.time_s * chain_of(train, 0, train.vehicles().len() - 1, &scales).transit();
    let time_unit_s = transit_s / couplers;
    // A wave runs from the middle of one vehicle to the middle of the next; held vehicles play no part, as in the transit.
    let spacing = |pair: &[Vehicle]| {
        let live: Option<Vec<f64>> = pair.iter().filter(|v| !v.held).map(|v| v.length_m).collect();
        live.map(|l| l.iter().sum::<f64>() / l.len().max(1) as f64)
    };
    let metres: Option<f64> = train.vehicles().windows(2).map(spacing).sum();
    Wave { time_unit_s, vehicles_per_s: 1.0 / time_unit_s, metres_per_s: metres.map(|m| m / transit_s), transit_s }
}
