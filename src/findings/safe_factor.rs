//! The largest factor on the load, force or speed at which no coupler exceeds.

use super::CouplerFindings;
use crate::train::{Event, Train};

/// The factor up to which a force that grows by `growth` stays within its `room` below the rating, in the same unit; `None` where
/// it does not grow.
pub(super) fn of_side(growth: f64, room: f64) -> Option<f64> {
    // A load that is over a rating by itself leaves no safe factor, not even where the event only relieves it.
    if room < 0.0 { Some(0.0) } else { (growth > 0.0).then(|| room / growth) }
}

/// The largest factor at which no coupler exceeds.
///
/// After a break every force, the initial one included, is proportional to the load. Under a pulse, and in an impact whose parts
/// had one acceleration, the load stays and the rest, `F - F(0)`, is proportional to the pulse's force or the speed; for other
/// impacts see [`super::safe_speed`]. `None` where nothing grows with the factor. Couplers left out count by their
/// all-time bounds, N: no coupler exceeds at that factor, but a larger one may be safe too.
pub(super) fn safe_load_factor(
    train: &Train,
    event: &Event,
    couplers: &[CouplerFindings],
    left_out: &[(usize, f64)],
) -> Option<f64> {
    let proportional = matches!(event, Event::Break { .. });
    let factor = |rating: f64, initial: f64, peak: f64| of_side(peak - initial, rating - initial);
    let watched = couplers.iter().flat_map(|c| {
        let initial = if proportional { 0.0 } else { c.initial_force_n };
        let [draft, buff] = c.extremes_n;
        let draft = factor(c.rated_draft_n, initial, draft);
        let buff = factor(c.rated_buff_n, -initial, buff);
        let sides = [(initial, c.rated_draft_n), (-initial, c.rated_buff_n)];
        // A load that may be over its rating counts as over it.
        let over = |(load, rating)| !proportional && train.rounding_decides(c.coupler - 1, load, rating);
        [draft, buff, sides.into_iter().any(over).then_some(0.0)]
    });
    let bounded = left_out.iter().map(|&(index, bound)| {
        let coupler = &train.couplers()[index];
        let initial = if proportional { 0.0 } else { train.initial_force_n()[index].abs() };
        // |F - F(0)| <= bound + |F(0)|
        let grown = factor(coupler.rated_draft_n.min(coupler.rated_buff_n), initial, bound + 2.0 * initial);
        // Up to 1 the force lies between those of before and with the event, and both are under the rating.
        grown.map(|f| f.max(1.0))
    });
    watched.chain(bounded).flatten().reduce(f64::min)
}
