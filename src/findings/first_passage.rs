//! What happens before reflections of the wave come back a second time.
//!
//! Without losses a train rings for ever, and a largest force late in the horizon is often a third or fourth reflection. The first
//! passage ends when the wave has run to the far end and back once:
//!
//! ```text
//! first passage = min(horizon, last change of the forces from outside + two one-way transits of the longest part)
//! ```

use serde::Serialize;

use super::case::Case;
use super::march::Marched;
use super::{CouplerFindings, of_number, worst};
use crate::scenario;
use crate::solve::{SolveError, Wanted};
use crate::train::{Scenario, Train};

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
    fn of(c: &CouplerFindings) -> FirstPassage {
        FirstPassage {
            peak_draft_n: c.peak_draft_n,
            peak_draft_time_s: c.peak_draft_time_s,
            peak_buff_n: c.peak_buff_n,
            peak_buff_time_s: c.peak_buff_time_s,
            exceeds: c.exceeds,
        }
    }
}

/// The first passage of a case.
pub(super) struct Passage {
    /// When it ends, s.
    pub end_s: f64,
    /// Couplers that exceed in it.
    pub exceeding: usize,
    /// The coupler with the largest utilisation in it, with its forces there.
    pub worst: Option<CouplerFindings>,
}

/// When the first passage ends, s.
pub(super) fn end_s(train: &Train, scenario: &Scenario, broken: Option<usize>, horizon_s: f64) -> f64 {
    let transit_s = scenario::longest_transit_s(train, broken);
    horizon_s.min(scenario::last_change_s(train, scenario, broken) + 2.0 * transit_s)
}

/// Finds it for couplers that are known up to the horizon, `worst` among them, and notes it with each of them.
///
/// The case is solved again up to its end, unless the horizon ends there or no extreme lies beyond it.
///
/// # Errors
/// As for [`Case::solve`].
pub(super) fn find(case: &Case, couplers: &mut [CouplerFindings], worst: Option<usize>) -> Result<Passage, SolveError> {
    let end_s = end_s(case.train, case.scenario, case.broken, case.horizon_s);
    if end_s >= case.horizon_s || has_all(case.options.wanted, couplers, worst, end_s) {
        couplers.iter_mut().for_each(|c| c.first_passage = Some(FirstPassage::of(c)));
        return Ok(passage(end_s, couplers, worst));
    }
    let mut within = case.solve(end_s)?;
    within.couplers.iter_mut().for_each(|c| c.first_passage = Some(FirstPassage::of(c)));
    for c in couplers {
        c.first_passage = of_number(&within.couplers, c.coupler).and_then(|c| c.first_passage.clone());
    }
    Ok(passage(end_s, &within.couplers, within.worst))
}

/// The first passage of a march, which has followed it on its way to the horizon.
pub(super) fn of_march(marched: &Marched, couplers: &mut [CouplerFindings], end_s: f64, error_n: f64) -> Passage {
    let within = &marched.to_mark;
    for c in couplers {
        c.first_passage = of_number(within, c.coupler).map(FirstPassage::of);
    }
    passage(end_s, within, worst(within, 0..within.len(), error_n))
}

fn passage(end_s: f64, within: &[CouplerFindings], worst: Option<usize>) -> Passage {
    let exceeding = within.iter().filter(|c| c.exceeds == Some(true)).count();
    Passage { end_s, exceeding, worst: worst.map(|i| within[i].clone()) }
}

/// Whether no extreme that is asked for lies beyond a time.
fn has_all(wanted: Wanted, couplers: &[CouplerFindings], worst: Option<usize>, end_s: f64) -> bool {
    let peaks =
        |c: &CouplerFindings| [c.peak_draft_time_s, c.peak_buff_time_s].into_iter().flatten().all(|t| t <= end_s);
    match wanted {
        // Extremes of other couplers than the worst are not exact then, and first exceedances may be late.
        Wanted::Worst => {
            couplers.iter().all(|c| c.exceeds == Some(false)) && worst.is_none_or(|i| couplers[i].peak_time_s <= end_s)
        }
        Wanted::Everything => couplers.iter().all(peaks),
    }
}
