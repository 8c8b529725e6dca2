//! A train as it is given.

use super::{Limits, Origin, Scenario};
use crate::law::Law;

/// A train as it is given: plain data, in SI units, which may be anything. [`TrainSpec::build`] tells what is wrong with it.
///
/// ```
/// use trainsafe::train::{CouplerSpec, Load, TrainSpec, VehicleSpec};
/// let spec = TrainSpec {
///     name: "three wagons".to_owned(),
///     vehicles: vec![VehicleSpec { count: 3, ..VehicleSpec::new(80e3) }],
///     couplers: vec![CouplerSpec::linear(20e6, 0.6e6); 2],
///     load: Load::Uniform(0.4e6),
///     ..TrainSpec::default()
/// };
/// let train = spec.clone().build()?;
/// assert_eq!((train.vehicles().len(), train.initial_force_n()), (3, &[0.4e6, 0.4e6][..]));
///
/// let mut wrong = spec;
/// wrong.couplers[1].rated_buff_n = f64::NAN;
/// let told = wrong.build().unwrap_err();
/// assert_eq!(told.to_string(), "coupler[1].rated_buff: rated_buff is not a number; expected a value above zero");
/// # Ok::<(), trainsafe::train::InvalidTrain>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrainSpec {
    /// What reports call it.
    pub name: String,
    /// From the head; groups of vehicles alike count for as many. At least two vehicles in all.
    pub vehicles: Vec<VehicleSpec>,
    /// One fewer than vehicles, from the head.
    pub couplers: Vec<CouplerSpec>,
    /// The steady state before the event.
    pub load: Load,
    /// The largest pull before, from which the train was let down to the load.
    pub pulled_to: PulledTo,
    /// Share of critical damping of every mode, 0 to under 1; beside neither dashpots nor laws that are not linear.
    pub damping_ratio: f64,
    /// Speed before the event, m/s, > 0; brakes need it.
    pub speed_m_per_s: Option<f64>,
    /// What is to be run; if empty, each coupler breaks in turn. A scenario with an empty name gets one.
    pub scenarios: Vec<Scenario>,
    /// Where it comes from; not checked.
    pub origin: Origin,
}

/// A vehicle, or several alike that follow each other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VehicleSpec {
    /// What reports call it, numbered where the train has it more than once; by its place if `None`.
    pub label: Option<String>,
    /// How many alike follow each other, 1 or more.
    pub count: usize,
    /// Mass of each, kg; > 0.
    pub mass_kg: f64,
    /// It keeps its speed whatever the couplers do; the first or the last vehicle of the train only.
    pub held: bool,
    /// Length over couplers, m; > 0.
    pub length_m: Option<f64>,
    /// Full brake force in an emergency application, N; not negative, and 0 for a held vehicle.
    pub emergency_brake_n: f64,
}

impl VehicleSpec {
    /// A free vehicle of this mass, kg, without a label or a length.
    pub fn new(mass_kg: f64) -> VehicleSpec {
        VehicleSpec { count: 1, mass_kg, ..VehicleSpec::default() }
    }
}

/// A coupler.
#[derive(Clone, Debug, PartialEq)]
pub struct CouplerSpec {
    /// Its force over its elongation.
    pub law: Law,
    /// Capacity in tension, N; > 0.
    pub rated_draft_n: f64,
    /// Capacity in compression, N, as a positive number; > 0.
    pub rated_buff_n: f64,
    /// Capacities beside the rating, in rising order; none by default.
    pub limits: Limits,
    /// A dashpot beside the spring, N s/m; not negative. In a train of linear couplers only.
    pub dashpot_n_s_per_m: f64,
}

impl CouplerSpec {
    /// A linear spring of this stiffness, N/m, with the same rating, N, in draft and in buff.
    pub fn linear(stiffness_n_per_m: f64, rated_n: f64) -> CouplerSpec {
        CouplerSpec {
            law: Law::linear(stiffness_n_per_m),
            rated_draft_n: rated_n,
            rated_buff_n: rated_n,
            limits: Limits::default(),
            dashpot_n_s_per_m: 0.0,
        }
    }
}

/// The steady state before the event, N.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Load {
    /// No force.
    #[default]
    None,
    /// This force in every coupler, draft positive.
    Uniform(f64),
    /// A force for each coupler, draft positive.
    InCouplers(Vec<f64>),
    /// A force from outside on each vehicle, forward positive: the couplers' follow, [`steady_forces`]. That of a held vehicle plays
    /// no part.
    OnVehicles(Vec<f64>),
}

/// The largest pull in the couplers before, N, from which they were let down to the load, and not less than that: couplers with
/// friction remember it.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum PulledTo {
    /// The load itself.
    #[default]
    None,
    /// That of the coupler which pulls most: the others pulled as much, or, where the load follows from forces on the vehicles, in
    /// proportion to their load.
    Largest(f64),
    /// That of each coupler.
    InCouplers(Vec<f64>),
}
