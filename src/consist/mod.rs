//! The train as an engineer describes it, in SI units and validated.
//!
//! Vehicles and couplers are indexed from 0 in the code and numbered from 1, from the head, wherever a user sees them:
//! coupler `i` joins vehicle `i` and vehicle `i + 1`. Forces are positive in tension (draft), negative in compression
//! (buff).

use crate::scenario::Scenario;

/// A vehicle: a rigid mass between couplers.
#[derive(Clone, Debug, PartialEq)]
pub struct Vehicle {
    /// What a report calls it: the file's `label`, numbered where the group has more than one (`"ore car 7"`).
    pub label: String,
    /// Mass, kg; finite and > 0.
    pub mass_kg: f64,
    /// Keeps its speed whatever the couplers do; only ever the first or the last vehicle. Its mass plays no part.
    pub held: bool,
    /// Length over couplers, m, where the file gives one.
    pub length_m: Option<f64>,
}

/// A coupler: the whole connection between two vehicles, as one linear spring with two ratings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupler {
    /// Stiffness, N/m; finite and > 0.
    pub stiffness_n_per_m: f64,
    /// Capacity in tension, N; finite and > 0.
    pub rated_draft_n: f64,
    /// Capacity in compression, N (a positive number); finite and > 0.
    pub rated_buff_n: f64,
}

/// A validated train with what is to be run on it.
#[derive(Clone, Debug, PartialEq)]
pub struct Train {
    /// The file's `name`.
    pub name: String,
    /// From the head; at least two.
    pub vehicles: Vec<Vehicle>,
    /// `vehicles.len() - 1` of them.
    pub couplers: Vec<Coupler>,
    /// Force in each coupler in the steady state before the event, N, draft positive.
    pub initial_force_n: Vec<f64>,
    /// At least one.
    pub scenarios: Vec<Scenario>,
}
