//! What a case comes to, however its motion was computed.

use super::{CouplerFindings, Ending};

/// What was found of every coupler.
pub(super) struct Solved {
    pub method: &'static str,
    pub reason: String,
    /// The error that was asked for, N.
    pub tolerance_n: f64,
    /// Infinite where nothing is proven.
    pub error_bound_n: f64,
    /// Where nothing is proven.
    pub error_estimate_n: Option<f64>,
    pub couplers: Vec<CouplerFindings>,
    /// Index of the one with the largest utilisation, of equal ones the first.
    pub worst: Option<usize>,
    /// Couplers that were left out, with their all-time bounds, N.
    pub left_out: Vec<(usize, f64)>,
    /// What was found up to the mark; `None` without one.
    pub to_mark: Option<PeriodFindings>,
    /// What only a march finds; `None` for other methods.
    pub marched: Option<Marched>,
}

/// What was found of every coupler within a part of the horizon.
pub(super) struct PeriodFindings {
    pub couplers: Vec<CouplerFindings>,
    /// As in [`Solved`].
    pub worst: Option<usize>,
}

/// What only a march finds.
pub(super) struct Marched {
    /// Where the march ended before its horizon.
    pub ending: Option<Ending>,
    /// Where gaps of parted couplers closed, and when, s.
    pub closures: Vec<(usize, f64)>,
}
