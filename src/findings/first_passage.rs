//! What happens before reflections of the wave come back a second time.
//!
//! Without losses a train rings for ever, and a largest force late in the horizon is often a third or fourth reflection. The first
//! passage ends when the wave has run to the far end and back once:
//!
//! ```text
//! first passage = min(horizon, last change of the forces from outside + two one-way transits of the longest part)
//! ```

use serde::Serialize;

use super::CouplerFindings;
use crate::consist::Train;
use crate::scenario::{self, Scenario};

/// One coupler's largest forces over the first passage, t = 0 included.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FirstPassage {
    /// Largest tension, N, positive; `None` if it is not in tension.
    pub peak_draft_n: Option<f64>,
    /// When, s after the event.
    pub peak_draft_time_s: Option<f64>,
    /// Largest compression, N, negative; `None` if it is not in compression.
    pub peak_buff_n: Option<f64>,
    /// When, s after the event.
    pub peak_buff_time_s: Option<f64>,
    /// Over its rating in either sign; `None`: not decided.
    pub exceeds: Option<bool>,
}

impl FirstPassage {
    pub(super) fn of(c: &CouplerFindings) -> FirstPassage {
        FirstPassage {
            peak_draft_n: c.peak_draft_n,
            peak_draft_time_s: c.peak_draft_time_s,
            peak_buff_n: c.peak_buff_n,
            peak_buff_time_s: c.peak_buff_time_s,
            exceeds: c.exceeds,
        }
    }
}

/// When the first passage of a case ends, s.
pub(super) fn end_s(train: &Train, scenario: &Scenario, broken: Option<usize>, horizon_s: f64) -> f64 {
    let transit_s = scenario::longest_transit_s(train, broken);
    horizon_s.min(scenario::last_change_s(&scenario.event) + 2.0 * transit_s)
}

/// Whether all of a coupler's extremes lie in the first passage, so that the larger part of the horizon adds nothing.
pub(super) fn has_all(c: &CouplerFindings, end_s: f64) -> bool {
    [c.peak_draft_time_s, c.peak_buff_time_s].into_iter().flatten().all(|t| t <= end_s)
}
