//! How a train stands at t = 0: forces in its couplers, speeds of its vehicles, and the loads that would break it.

use std::ops::Range;

use crate::train::{Event, LIMITS, Limits, Train, steady_forces};

/// The loads at which coupler `i` breaks in a cascade, N, in draft and in buff, each with the key that gives it: its ultimate
/// load where it has one in that sense, else its rating.
pub(crate) fn break_loads(train: &Train, i: usize) -> [(f64, &'static str); 2] {
    let coupler = &train.couplers()[i];
    let [draft, buff] = train.extras().limits.get(i).map_or([None; 2], Limits::ultimate_n);
    let or = |ultimate: Option<f64>, rating, key| ultimate.map_or((rating, key), |n| (n, LIMITS[2]));
    [or(draft, coupler.rated_draft_n, "rated_load"), or(buff, coupler.rated_buff_n, "rated_buff")]
}

/// Forces in the couplers before the event, N.
///
/// Before an impact the train is two parts, and the coupler j that will join them carries nothing. Under given forces in the
/// couplers (`uniform`) each part carries its own: outside forces on the part's ends balance them, and go on acting. Under forces
/// on the vehicles each part P is in the steady state of its own vehicles:
///
/// ```text
/// F_{v-1} - F_v + p_v = m_v a_P        F_j = 0        a_P = sum p_v / sum m_v over P, 0 where a vehicle of P is held
/// ```
pub fn initial_force_n(train: &Train, event: &Event) -> Vec<f64> {
    let Some(j) = event.joint(train.vehicles().len()) else { return train.initial_force_n().to_vec() };
    let Some(steady) = &train.extras().steady else {
        let mut given = train.initial_force_n().to_vec();
        given[j] = 0.0;
        return given;
    };
    let part = |vehicles: Range<usize>| {
        let couplers = &train.couplers()[vehicles.start..vehicles.end - 1];
        steady_forces(&train.vehicles()[vehicles.clone()], couplers, &steady.outside_n[vehicles]).0
    };
    [part(0..j + 1), vec![0.0], part(j + 1..train.vehicles().len())].concat()
}

/// Coupler forces just after the event less those of the whole train in one steady motion under its steady forces, N.
///
/// It is 0 for breaks and pulses, which start from that motion, and for impacts under given forces in the couplers, whose forces
/// from outside balance each part by itself. After other impacts the p_v go on acting on the coupled train, whose steady state F*
/// has one acceleration: the rest, `F(0) - F*`, moves the vehicles unless the two parts' accelerations are equal.
pub(crate) fn unbalanced_n(train: &Train, event: &Event) -> Vec<f64> {
    if event.joint(train.vehicles().len()).is_none() || train.extras().steady.is_none() {
        return vec![0.0; train.couplers().len()];
    }
    let before = initial_force_n(train, event);
    before.iter().zip(train.initial_force_n()).map(|(before, steady)| before - steady).collect()
}

/// Speed of a vehicle relative to the standing ones at t = 0, forward positive: arriving ones move toward them.
pub(super) fn speed_m_per_s(event: &Event, vehicle: usize, last: usize) -> f64 {
    match *event {
        Event::Impact { vehicles, at_head: true, speed_m_per_s } if vehicle < vehicles => -speed_m_per_s,
        Event::Impact { vehicles, at_head: false, speed_m_per_s } if vehicle + vehicles > last => speed_m_per_s,
        _ => 0.0,
    }
}
