//! What happens to the train: a coupler breaks, a force strikes a vehicle, or vehicles run into it.

pub mod brakes;
mod marches;
mod plays;

use crate::chain::{Chain, Scene};
use crate::consist::Train;
use crate::play::{Drive, Rule};

pub use marches::{is_march, march};
pub use plays::{beyond_steps, break_loads, initial_force_n, play, unbalanced_n};

/// One named event to run, with how long to watch.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// Unique within the train.
    pub name: String,
    /// What happens at t = 0.
    pub event: Event,
    /// How long forces are followed, s; `None`: to the last change of the forces from outside and four one-way wave transits of the
    /// longest part beyond it.
    pub horizon_s: Option<f64>,
    /// What breaks after the event: nothing, unless the file says `cascade = true`.
    pub cascade: Rule,
    /// Couplers, from 0, that would break in turn but carry buff, so that their vehicles stay pressed together: they are not
    /// among those of the event.
    pub left_out_in_buff: Vec<usize>,
    /// What brakes and drives do after the event; nothing by default.
    pub response: Response,
}

/// What brakes and drives do after an event.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Response {
    /// The emergency application that each parting sets off, both ways.
    pub emergency: Option<Application>,
    /// Tractive efforts that change.
    pub efforts: Vec<Forcing>,
}

/// A brake application: it runs along the train, and builds up in each vehicle that it has reached.
#[derive(Clone, Debug, PartialEq)]
pub struct Application {
    /// The name of a kind of brake that stands for the numbers, where the file gives one.
    pub name: Option<&'static str>,
    /// How fast it runs, m/s.
    pub wave_m_per_s: f64,
    /// Time since it reached the vehicle, s, and share of its full emergency brake force; straight lines between, from `[0, 0]` on,
    /// neither ever falls.
    pub build_up: Vec<[f64; 2]>,
}

impl Application {
    /// When it is fully built up where it is, s.
    pub fn full_after_s(&self) -> f64 {
        self.build_up.last().map_or(0.0, |last| last[0])
    }
}

/// A change of the outside force on one vehicle.
#[derive(Clone, Debug, PartialEq)]
pub struct Forcing {
    /// Index from 0; never a held vehicle.
    pub vehicle: usize,
    /// Time, s, and change of the force, N, forward positive: straight lines between, no change before the first and that of the last
    /// after it. Two at one time are a jump.
    pub points: Vec<[f64; 2]>,
}

/// The event at t = 0.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// Couplers that break, each in a case of its own, each from the intact train.
    Break {
        /// Indices from 0, in the file's order.
        couplers: Vec<usize>,
    },
    /// A rectangular pulse of outside force on one vehicle.
    Pulse {
        /// Index from 0; never a held vehicle.
        vehicle: usize,
        /// Outside force on that vehicle, N, forward positive; finite and not 0.
        force_n: f64,
        /// How long it acts, s; finite and > 0.
        duration_s: f64,
    },
    /// An outside force of any other course on one vehicle.
    Shaped {
        /// Index from 0; never a held vehicle.
        vehicle: usize,
        /// `"half-sine"`, `"triangle"`, `"trapezoid"` or `"record"`.
        shape: &'static str,
        /// Largest force of either sign, with its sign, N.
        force_n: f64,
        /// From t = 0 to its end, s.
        duration_s: f64,
        /// Its course, in s and N.
        drive: Drive,
    },
    /// Vehicles at one end arrive at a speed and couple to the standing rest.
    Impact {
        /// How many arrive; at least one stands.
        vehicles: usize,
        /// At the head; at the tail if not.
        at_head: bool,
        /// How fast they come toward the rest, m/s; finite and > 0.
        speed_m_per_s: f64,
    },
    /// Brakes are applied.
    Brake {
        /// Vehicles, from 0, at which the application starts at t = 0.
        from: Vec<usize>,
        /// An emergency application; a service one if not.
        emergency: bool,
        /// Its course.
        application: Application,
    },
}

impl Event {
    /// The kind as the file names it: `"break"`, `"pulse"`, `"impact"` or `"brake"`.
    pub fn kind(&self) -> &'static str {
        match self {
            Event::Break { .. } => "break",
            Event::Pulse { .. } | Event::Shaped { .. } => "pulse",
            Event::Impact { .. } => "impact",
            Event::Brake { .. } => "brake",
        }
    }

    /// Of an impact, the coupler that joins the two parts, as an index from 0, in a train of so many vehicles.
    pub fn joint(&self, count: usize) -> Option<usize> {
        match *self {
            Event::Impact { vehicles, at_head: true, .. } => Some(vehicles - 1),
            Event::Impact { vehicles, at_head: false, .. } => Some(count - vehicles - 1),
            _ => None,
        }
    }
}

/// A part of the train that stays together after the event, in the solvers' units.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// What is played on it.
    pub scene: Scene,
    /// Index in the train of the scene's first coupler.
    pub first_coupler: usize,
}

/// What one unit of the solvers is in SI. All are powers of two, and the time's square is exactly mass over stiffness: no
/// number of the train changes a bit when it is scaled.
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
        let mass = exponent(train.vehicles.iter().find(|v| !v.held).map_or(1.0, |v| v.mass_kg));
        let stiffness = exponent(train.couplers.first().map_or(1.0, |c| c.stiffness_n_per_m));
        let half = (mass - stiffness).div_euclid(2);
        let force = train.couplers.iter().map(|c| c.rated_draft_n.max(c.rated_buff_n)).fold(0.0, f64::max);
        Scales {
            mass_kg: f64::exp2(f64::from(stiffness + 2 * half)),
            stiffness_n_per_m: f64::exp2(f64::from(stiffness)),
            time_s: f64::exp2(f64::from(half)),
            force_n: f64::exp2(f64::from(exponent(force))),
        }
    }
}

/// The parts that a break or a rectangular pulse leaves, each with the step or pulse of force that it feels; parts without a coupler left out.
///
/// A break of coupler b takes its force F_b from both sides: the front part feels `+F_b` on its last vehicle, the rear
/// part `-F_b` on its first, and all else goes on as before (superposition on the steady state).
pub fn parts(train: &Train, event: &Event, broken: Option<usize>, horizon_s: f64) -> Vec<Part> {
    let scales = Scales::of(train);
    let last = train.vehicles.len() - 1;
    let cut = |vehicles: std::ops::RangeInclusive<usize>, source: usize, force_n: f64, duration_s: f64| {
        let (from, to) = (*vehicles.start(), *vehicles.end());
        let couplers = &train.couplers[from..to];
        let force = |n: f64| n / scales.force_n;
        let chain = chain_of(train, from, to, &scales);
        let scene = Scene {
            chain,
            source: source - from,
            force: force(force_n),
            duration: duration_s / scales.time_s,
            initial: train.initial_force_n[from..to].iter().map(|&f| force(f)).collect(),
            rated_draft: couplers.iter().map(|c| force(c.rated_draft_n)).collect(),
            rated_buff: couplers.iter().map(|c| force(c.rated_buff_n)).collect(),
            horizon: horizon_s / scales.time_s,
        };
        Part { scene, first_coupler: from }
    };
    let parts = match (event, broken) {
        (Event::Pulse { vehicle, force_n, duration_s }, _) => vec![cut(0..=last, *vehicle, *force_n, *duration_s)],
        // The others are no steps of force from rest: see [`play`].
        (Event::Break { .. } | Event::Shaped { .. } | Event::Impact { .. } | Event::Brake { .. }, None) => vec![],
        (Event::Shaped { .. } | Event::Impact { .. } | Event::Brake { .. }, Some(_)) => vec![],
        (Event::Break { .. }, Some(b)) => {
            let lost = train.initial_force_n[b];
            vec![cut(0..=b, b, lost, f64::INFINITY), cut(b + 1..=last, b + 1, -lost, f64::INFINITY)]
        }
    };
    parts.into_iter().filter(|p| !p.scene.initial.is_empty()).collect()
}

fn chain_of(train: &Train, from: usize, to: usize, scales: &Scales) -> Chain {
    Chain {
        mass: train.vehicles[from..=to].iter().map(|v| v.mass_kg / scales.mass_kg).collect(),
        stiffness: train.couplers[from..to].iter().map(|c| c.stiffness_n_per_m / scales.stiffness_n_per_m).collect(),
        held_head: train.vehicles[from].held,
        held_tail: train.vehicles[to].held,
    }
}

/// When an outside force changes for the last time after an event, s: 0 for breaks and impacts without brakes. `broken` is the
/// coupler that breaks in a case of a break.
pub fn last_change_s(train: &Train, scenario: &Scenario, broken: Option<usize>) -> f64 {
    let of_event = match &scenario.event {
        Event::Break { .. } | Event::Impact { .. } | Event::Brake { .. } => 0.0,
        Event::Pulse { duration_s, .. } => *duration_s,
        Event::Shaped { drive, .. } => drive.last_change(),
    };
    of_event.max(brakes::last_change_s(train, scenario, broken))
}

/// One-way transit of a wave through the longest part that a case leaves, s.
pub fn longest_transit_s(train: &Train, broken: Option<usize>) -> f64 {
    let scales = Scales::of(train);
    let last = train.vehicles.len() - 1;
    let transit = |from: usize, to: usize| scales.time_s * chain_of(train, from, to, &scales).transit();
    match broken {
        None => transit(0, last),
        Some(b) => transit(0, b).max(transit(b + 1, last)),
    }
}

/// The horizon of a scenario's case, s: the file's, or the last change of the forces from outside and four one-way wave transits
/// of the longest part.
pub fn horizon_s(train: &Train, scenario: &Scenario, broken: Option<usize>) -> f64 {
    let by_itself = || last_change_s(train, scenario, broken) + 4.0 * longest_transit_s(train, broken);
    scenario.horizon_s.unwrap_or_else(by_itself)
}

/// Shortest horizon of a scenario's cases, s.
///
/// From the head to the tail the front part grows and the rear part shrinks, so that the longest part's transit first
/// falls, then rises. Its smallest value is found by halving.
pub fn shortest_horizon_s(train: &Train, scenario: &Scenario) -> f64 {
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
pub fn longest_horizon_s(train: &Train, scenario: &Scenario) -> f64 {
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
    let couplers = train.couplers.len() as f64;
    let transit_s = scales.time_s * chain_of(train, 0, train.vehicles.len() - 1, &scales).transit();
    let time_unit_s = transit_s / couplers;
    let lengths: Option<Vec<f64>> = train.vehicles.iter().map(|v| v.length_m).collect();
    // A wave runs from the middle of one vehicle to the middle of the next.
    let metres = lengths.map(|l| l.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).sum::<f64>());
    Wave { time_unit_s, vehicles_per_s: 1.0 / time_unit_s, metres_per_s: metres.map(|m| m / transit_s), transit_s }
}
