//! What a train may have beyond linear springs under a given load.

/// All of it is absent by default, and what is absent changes no result.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Extras {
    /// The forces from outside that the steady state comes from; `None` where the file gives the couplers' forces.
    pub steady: Option<Steady>,
    /// Dashpots beside the couplers' springs, N s/m, coupler by coupler; empty if there are none.
    pub dashpot_n_s_per_m: Vec<f64>,
    /// Share of critical damping of every mode, under 1; 0 without. Never together with dashpots.
    pub damping_ratio: f64,
    /// Capacities beside the rating, coupler by coupler; empty if there are none.
    pub limits: Vec<Limits>,
}

/// Names of the capacities beside the rating, in rising order.
pub const LIMITS: [&str; 3] = ["fatigue", "proof", "ultimate"];

/// A coupler's capacities beside its rating, N, in either sense, in the order of [`LIMITS`]; `None` where not given.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits(pub [Option<f64>; 3]);

/// The steady state of a hauled train.
#[derive(Clone, Debug, PartialEq)]
pub struct Steady {
    /// Forces from outside on each vehicle, N, forward positive: traction, running resistance, grade, brakes.
    pub outside_n: Vec<f64>,
    /// Acceleration of the whole train, m/s2, forward positive; 0 where a vehicle is held.
    pub acceleration_m_per_s2: f64,
}
