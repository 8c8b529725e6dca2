//! The motion of a train through time, from event to event: dashpots, speeds at the start, forces of any shape, couplers with slack and
//! friction, couplers that break on the way.
//!
//! Between events every coupler's force is linear in its elongation ([`crate::law`]), so that the motion is a Taylor
//! series. A step ends at each event: a gear that locks or unlocks, a gap that closes, a coupler that breaks, a kink
//! of an outside force. Speeds are relative to the common motion at t = 0, forward positive; forces are positive in
//! draft.
//!
//! ```text
//! q_i' = v_i - v_{i+1}       m_j v_j' = F_{j-1} - F_j + f_j(t)       F_i = law of coupler i (q_i, its travel) + c_i q_i'
//! ```
//!
//! The derivatives follow from one another, each from its neighbours: a step costs O(n), its series is the force at every
//! instant of it, and nothing but the present state is kept. Only the part of the train that moves is computed.
//!
//! [`solve`] solves a [`Problem`], in SI units. The error is proven for linear couplers, across breaks as well where parted vehicles
//! do not push each other, and for constant friction (`proof.rs`); elsewhere it is estimated by two more runs (`estimate.rs`). Which
//! couplers certainly break is proven in `certain.rs`. The search for peaks and first exceedances is that of
//! [`crate::solve::watch`].

mod branches;
mod breaks;
mod certain;
mod energy;
mod estimate;
mod events;
mod forces;
mod gaps;
mod mode;
mod proof;
mod record;
mod roots;
mod run;
mod series;
mod step;
#[cfg(test)]
mod tests;

use crate::forcing::Drive;
use crate::law::{Law, Rest};

/// A train and what happens to it.
#[derive(Clone, Debug)]
pub struct Problem {
    /// Mass of each vehicle, kg, from the head.
    pub mass_kg: Vec<f64>,
    /// The first vehicle keeps its speed.
    pub held_head: bool,
    /// The last vehicle keeps its speed.
    pub held_tail: bool,
    /// Coupler `i` lies between vehicles `i` and `i + 1`.
    pub laws: Vec<Law>,
    /// Dashpot beside each coupler, N s/m, until the coupler parts. Empty for none; not with slack.
    pub dashpot_n_s_per_m: Vec<f64>,
    /// Each coupler at t = 0.
    pub start: Vec<Rest>,
    /// Speed of each vehicle at t = 0 relative to the common motion.
    pub speed_m_s: Vec<f64>,
    /// Speed of the common motion at t = 0 relative to the track, where brakes act: brake forces oppose it, and the march ends when
    /// a braked vehicle would stop. `None`: the train runs forward, and no vehicle stops.
    pub common_speed_m_s: Option<f64>,
    /// Acceleration of the common motion relative to the track, beside the one that `steady_n` causes.
    pub common_m_s2: f64,
    /// Steady outside force on each vehicle. Without a held vehicle the common acceleration that these forces cause is
    /// subtracted, so they may include it or not. A remainder under 1e-12 of the largest force counts as 0.
    pub steady_n: Vec<f64>,
    /// Further forces over time, each on a vehicle; one that does not end needs a last point beyond the horizon.
    pub forcing: Vec<(usize, Drive)>,
    /// Couplers that part at t = 0. A parted coupler carries no draft.
    pub gone: Vec<usize>,
    /// If true, a parted coupler carries buff by its law once its gap closes. If false it carries no force from then on, as if the
    /// vehicles could pass through each other: for linear couplers, where the error bound then holds across breaks.
    pub contact: bool,
    /// Force in draft and in buff, both positive, above which each coupler parts; infinite for never. Empty for none.
    pub break_at_n: Vec<[f64; 2]>,
    /// Emergency brakes that every parting sets off.
    pub emergency: Option<Brakes>,
    /// Brakes that are applied at t = 0, and the places from which, m from the front of the train.
    pub application: Option<(Brakes, Vec<f64>)>,
    /// The motion is followed up to here.
    pub horizon_s: f64,
    /// Extremes are given up to here as well.
    pub mark_s: f64,
}

impl Problem {
    /// Free vehicles at rest under no outside force, their couplers at no load in the middle of their slack.
    pub fn at_rest(mass_kg: Vec<f64>, laws: Vec<Law>, horizon_s: f64) -> Problem {
        let vehicles = mass_kg.len();
        Problem {
            start: vec![Rest::default(); laws.len()],
            mass_kg,
            laws,
            held_head: false,
            held_tail: false,
            dashpot_n_s_per_m: Vec::new(),
            speed_m_s: vec![0.0; vehicles],
            common_speed_m_s: None,
            common_m_s2: 0.0,
            steady_n: vec![0.0; vehicles],
            forcing: Vec::new(),
            gone: Vec::new(),
            contact: true,
            break_at_n: Vec::new(),
            emergency: None,
            application: None,
            horizon_s,
            mark_s: horizon_s,
        }
    }

    /// The full brake forces of all vehicles that may brake, N.
    pub(crate) fn brakes_n(&self) -> impl Iterator<Item = f64> {
        let applied = self.application.iter().map(|(brakes, _)| brakes);
        self.emergency.iter().chain(applied).flat_map(|brakes| brakes.full_n.iter().copied())
    }

    /// The direction in which the train runs, 1 or -1: brakes act against it.
    pub(crate) fn direction(&self) -> f64 {
        if self.common_speed_m_s.is_some_and(|speed| speed < 0.0) { -1.0 } else { 1.0 }
    }
}

/// Brakes along a train: a brake wave runs both ways from each place where they are applied, or where a coupler parts and opens
/// the brake pipe.
#[derive(Clone, Debug)]
pub struct Brakes {
    /// Speed of the wave.
    pub wave_m_s: f64,
    /// Share of the full force against the time since the wave came to the middle of the vehicle, straight between points; the
    /// last holds.
    pub build_up: Vec<[f64; 2]>,
    /// Full brake force of each vehicle, positive.
    pub full_n: Vec<f64>,
    /// Length of each vehicle over its couplers.
    pub length_m: Vec<f64>,
}

/// Options of a march.
#[derive(Clone, Debug, Default)]
pub struct MarchOptions {
    /// Capacity of each coupler in draft and buff, for the first instants above it. Empty for none.
    pub capacity_n: Vec<[f64; 2]>,
    /// Couplers whose force over time is asked for.
    pub history: Vec<usize>,
    /// Instants of the history, in order.
    pub times_s: Vec<f64>,
    /// A coupler whose force and elongation are wanted at instants of its own, in order.
    pub watched: Option<(usize, Vec<f64>)>,
    /// Largest error of a force: the march ends where the estimate for any coupler passes it. `None`: one run, no
    /// estimate.
    pub tolerance_n: Option<f64>,
    /// Compute the energy.
    pub audit: bool,
}

/// A force and its instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peak {
    /// Force, draft positive, N.
    pub force_n: f64,
    /// Instant, s.
    pub time_s: f64,
}

/// Largest draft and largest buff of a coupler: the largest and the smallest force, whatever their signs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extremes {
    /// The largest force.
    pub draft: Peak,
    /// The smallest.
    pub buff: Peak,
}

/// A coupler that parted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parting {
    /// Which, from 0.
    pub coupler: usize,
    /// When.
    pub time_s: f64,
    /// Its force just before.
    pub force_n: f64,
    /// Energy that it releases, J; 0 while its vehicles still push each other.
    pub energy_j: f64,
    /// Error of the instant: proven, or estimated from the same runs as for forces; infinite without either, or if it parted in
    /// some runs only.
    pub uncertainty_s: f64,
}

/// Error of the forces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// Proven: no force is further than this from the exact motion's, N.
    Proven(f64),
    /// Estimated by three runs: the largest of [`MarchOutcome::error_n`].
    Estimated(f64),
    /// Not asked for, and not proven.
    None,
}

/// Result of a march.
#[derive(Clone, Debug)]
pub struct MarchOutcome {
    /// Of each coupler up to the horizon, or up to where the march ended; one that parts at t = 0 starts with the
    /// force that its vehicles push with.
    pub extremes: Vec<Extremes>,
    /// The same up to the mark.
    pub to_mark: Vec<Extremes>,
    /// First instants above the capacity, in draft and in buff, of a rise that certainly passes it.
    pub first_over_s: Vec<[Option<f64>; 2]>,
    /// Whether each force passes the capacity, in draft and in buff: `None` where the largest force is within the proven bound of the
    /// capacity. Without a bound before the search, the verdict on the computed forces.
    pub exceeds: Vec<[Option<bool>; 2]>,
    /// The same up to the mark.
    pub exceeds_to_mark: Vec<[Option<bool>; 2]>,
    /// Error of the extremes.
    pub bound: Bound,
    /// Bound or estimate of the error of each coupler's largest draft and buff, up to the horizon; empty where there is none.
    pub error_n: Vec<[f64; 2]>,
    /// The same up to the mark.
    pub error_to_mark_n: Vec<[f64; 2]>,
    /// Couplers that parted, in order.
    pub partings: Vec<Parting>,
    /// Gaps of parted couplers that closed: which, and when. Without contact the first alone, and only where couplers may break:
    /// the vehicles would push each other from then on.
    pub closures: Vec<(usize, f64)>,
    /// The first coupler that came within the bound of the force that breaks it and did not certainly pass it, and when: from then
    /// on what breaks is not decided. Only where a bound is proven across breaks.
    pub undecided: Option<(usize, f64)>,
    /// The braked vehicle that would stop, and when; the march ends there.
    pub stopped: Option<(usize, f64)>,
    /// Forces are known up to here only; `None`: to the horizon.
    pub predictable_until_s: Option<f64>,
    /// Forces of the couplers of the history at its instants; not a number beyond the end of the march.
    pub history: Vec<Vec<f64>>,
    /// Elongation, m from the middle of the slack, and force, N, of the coupler watched at its instants; not a number beyond the end.
    pub watched: Vec<[f64; 2]>,
    /// Speed of each vehicle at the end of the march, relative to the common motion.
    pub end_speed_m_s: Vec<f64>,
    /// Energy over the march, if asked for.
    pub energy: Option<Energy>,
    /// Events that ended steps.
    pub events: u64,
    /// Steps.
    pub steps: u64,
}

/// Energy relative to the common motion: kinetic, and stored in couplers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// At t = 0, before anything parts, J.
    pub start_j: f64,
    /// At the end.
    pub end_j: f64,
    /// Work of the outside forces.
    pub work_j: f64,
    /// Released at partings.
    pub released_j: f64,
    /// Largest growth of energy in a step beyond the work in it: rounding.
    pub created_j: f64,
}

pub use estimate::{estimate_s, follow, solve};
