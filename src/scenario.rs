//! What happens to the train: a coupler breaks, or a force pulse strikes a vehicle.

/// One named event to run, with how long to watch.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// Unique within the train.
    pub name: String,
    /// What happens at t = 0.
    pub event: Event,
    /// How long forces are followed, s; `None`: four one-way wave transits of the longest part.
    pub horizon_s: Option<f64>,
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
}

impl Event {
    /// The contract's name of the kind: `"break"` or `"pulse"`.
    pub fn kind(&self) -> &'static str {
        match self {
            Event::Break { .. } => "break",
            Event::Pulse { .. } => "pulse",
        }
    }
}
