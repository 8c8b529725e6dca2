//! How the motion of a scenario is computed: decided here alone.

use crate::train::{Scenario, Train};

/// The kinds of motion that are computed in different ways.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Motion {
    /// Steps of force on undamped linear chains: by one of the methods of [`crate::solve::Method`].
    Steps,
    /// The same with this damping ratio in every mode: by [`crate::solve::damped_modes`].
    DampedModes(f64),
    /// All else, from event to event: by [`crate::march`].
    March,
}

impl Motion {
    /// That of a scenario of a train.
    pub(crate) fn of(train: &Train, scenario: &Scenario) -> Motion {
        let extras = train.extras();
        let damped = extras.dashpot_n_s_per_m.iter().any(|c| *c > 0.0);
        if !is_proportional(train, scenario) || damped || scenario.event.beyond_steps() {
            Motion::March
        } else if extras.damping_ratio > 0.0 {
            Motion::DampedModes(extras.damping_ratio)
        } else {
            Motion::Steps
        }
    }
}

/// Whether the forces that an event adds are proportional to their cause: with linear couplers and without brakes and changing
/// tractive efforts. The error of such forces is proven; the parts of a broken train are then computed as if they never pushed each
/// other.
pub(crate) fn is_proportional(train: &Train, scenario: &Scenario) -> bool {
    train.extras().laws.is_empty() && !scenario.applies_brakes() && scenario.response.efforts.is_empty()
}
