//! What happens before reflections of the wave come back a second time.
//!
//! Without losses the motion never decays, and a largest force late in the horizon is often a third or fourth reflection. The first
//! passage ends when the wave has run to the far end and back once:
//!
//! ```text
//! first passage = min(horizon, last change of the forces from outside + two one-way transits of the longest part)
//! ```

use serde::Serialize;

use super::solved::PeriodFindings;
use super::{CouplerFindings, of_number};

/// One coupler's largest forces over the first passage, or in a cascade up to its own break; t = 0 included.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PeakForces {
    /// Largest tension, N, positive; `None` if it is not in tension.
    pub peak_draft_n: Option<f64>,
    /// When, s after the event.
    pub peak_draft_time_s: Option<f64>,
    /// Largest compression, N, negative; `None` if it is not in compression.
    pub peak_buff_n: Option<f64>,
    /// When, s after the event.
    pub peak_buff_time_s: Option<f64>,
    /// Over its rating in either sense; `None`: not decided.
    pub exceeds: Option<bool>,
    /// Of a cascade, an estimate of the error of these forces, N, where there is no proof.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error_estimate_n: Option<f64>,
}

impl PeakForces {
    pub(super) fn of(c: &CouplerFindings) -> PeakForces {
        PeakForces {
            peak_draft_n: c.peak_draft_n,
            peak_draft_time_s: c.peak_draft_time_s,
            peak_buff_n: c.peak_buff_n,
            peak_buff_time_s: c.peak_buff_time_s,
            exceeds: c.exceeds,
            error_estimate_n: None,
        }
    }

    /// The force of the largest utilisation, N, when it is, s, and that utilisation; `None` for a coupler that is never loaded.
    pub fn most_used(&self, c: &CouplerFindings) -> Option<(f64, f64, f64)> {
        let draft = self.peak_draft_n.zip(self.peak_draft_time_s).map(|(n, at_s)| (n, at_s, n / c.rated_draft_n));
        let buff = self.peak_buff_n.zip(self.peak_buff_time_s).map(|(n, at_s)| (n, at_s, -n / c.rated_buff_n));
        [draft, buff].into_iter().flatten().reduce(|a, b| if b.2 > a.2 { b } else { a })
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

/// Adds the first passage to the findings of each coupler up to the horizon; `worst` is an index into them, `within`
/// are the findings up to its end, `None` where that is the horizon.
pub(super) fn note(
    couplers: &mut [CouplerFindings],
    worst: Option<usize>,
    end_s: f64,
    within: Option<PeriodFindings>,
    error_n: f64,
) -> Passage {
    let fill = |couplers: &mut [CouplerFindings]| {
        couplers.iter_mut().for_each(|c| c.first_passage = Some(PeakForces::of(c)));
    };
    let Some(mut within) = within else {
        fill(couplers);
        return passage(end_s, couplers, worst);
    };
    for c in &mut within.couplers {
        if let Some(whole) = of_number(couplers, c.coupler) {
            no_larger(c, whole, error_n);
        }
    }
    fill(&mut within.couplers);
    for c in couplers {
        c.first_passage = of_number(&within.couplers, c.coupler).and_then(|c| c.first_passage.clone());
    }
    passage(end_s, &within.couplers, within.worst)
}

/// A peak of the first passage that is also the largest of all was found twice, and the values may differ within their
/// error: the smaller counts. If only the worst coupler is asked for, another one's peak may be unknown up to the
/// horizon, and far smaller.
fn no_larger(c: &mut CouplerFindings, whole: &CouplerFindings, error_n: f64) {
    let is_same = |own: f64, whole: f64| (0.0..=2.0 * error_n).contains(&(own.abs() - whole.abs()));
    let least = |own: Option<f64>, whole: Option<f64>| match (own, whole) {
        (Some(own), Some(whole)) if is_same(own, whole) => Some(whole),
        _ => own,
    };
    let (own_n, whole_n) = (c.peak_force_n, whole.peak_force_n);
    c.peak_draft_n = least(c.peak_draft_n, whole.peak_draft_n);
    c.peak_buff_n = least(c.peak_buff_n, whole.peak_buff_n);
    if own_n.signum() == whole_n.signum() && is_same(own_n, whole_n) {
        (c.peak_force_n, c.utilisation) = (whole_n, whole.utilisation);
    }
}

fn passage(end_s: f64, within: &[CouplerFindings], worst: Option<usize>) -> Passage {
    let exceeding = within.iter().filter(|c| c.exceeds == Some(true)).count();
    Passage { end_s, exceeding, worst: worst.map(|i| within[i].clone()) }
}
