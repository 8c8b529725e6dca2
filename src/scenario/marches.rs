//! A scenario as a problem for [`crate::march`], which also covers what steps of force on an undamped linear chain at rest cannot
//! represent.

use super::start::speed_m_per_s;
use super::{brakes, break_loads, initial_force_n, is_proportional};
use crate::forcing::Drive;
use crate::law::{Law, Rest};
use crate::march::Problem;
use crate::train::{Event, Forcing, Rule, Scenario, Train};

/// The problem of a case; `until_s`: horizon, and mark for the first passage; `broken`: the coupler that the event breaks, if any;
/// `rule`: which couplers may break afterwards.
pub fn march(train: &Train, scenario: &Scenario, broken: Option<usize>, until_s: [f64; 2], rule: Rule) -> Problem {
    let [horizon_s, mark_s] = until_s;
    let last = train.vehicles().len() - 1;
    let event = &scenario.event;
    let breaks = |i: usize| {
        let [(draft, _), (buff, _)] = break_loads(train, i);
        [draft, if rule == Rule::InBoth { buff } else { f64::INFINITY }]
    };
    Problem {
        mass_kg: train.vehicles().iter().map(|v| v.mass_kg).collect(),
        held_head: train.vehicles()[0].held,
        held_tail: train.vehicles()[last].held,
        laws: laws(train),
        dashpot_n_s_per_m: train.extras().dashpot_n_s_per_m.clone(),
        start: start(train, event),
        speed_m_s: (0..=last).map(|v| speed_m_per_s(event, v, last)).collect(),
        common_speed_m_s: train.extras().speed_m_per_s.filter(|_| scenario.applies_brakes()),
        common_m_s2: train.extras().steady.as_ref().map_or(0.0, |steady| steady.acceleration_m_per_s2),
        steady_n: steady_n(train, event),
        forcing: forcing(scenario, horizon_s),
        gone: broken.into_iter().collect(),
        contact: !is_proportional(train, scenario),
        break_at_n: if rule == Rule::Keep { vec![] } else { (0..last).map(breaks).collect() },
        emergency: brakes::of_partings(train, scenario),
        application: brakes::of_event(train, scenario),
        horizon_s,
        mark_s: mark_s.min(horizon_s),
    }
}

/// The law of each coupler.
fn laws(train: &Train) -> Vec<Law> {
    if !train.extras().laws.is_empty() {
        return train.extras().laws.clone();
    }
    let linear = |k: f64| Law::Elastic { draft_n_per_m: k, buff_n_per_m: k, slack_m: 0.0 };
    train.couplers().iter().map(|c| linear(c.stiffness_n_per_m)).collect()
}

/// Each coupler before the event. Vehicles that meet in an impact touch at t = 0: their coupler stands at the end of its slack.
fn start(train: &Train, event: &Event) -> Vec<Rest> {
    let before_n = initial_force_n(train, event);
    let joint = event.joint(train.vehicles().len());
    let rest = |(i, law): (usize, &Law)| match joint {
        Some(j) if j == i => Rest { force_n: 0.0, travel_m: -0.5 * law.slack_m() },
        _ => {
            let pulled = train.extras().pulled_to_n.get(i).copied();
            law.rest(&pulled.into_iter().chain([before_n[i]]).collect::<Vec<_>>())
        }
    };
    laws(train).iter().enumerate().map(rest).collect()
}

/// The steady force on each vehicle less mass times acceleration, N:
///
/// ```text
/// p_v - m_v a = F_v - F_{v-1}
/// ```
///
/// with the coupler forces F of the whole train's steady state: after an impact of parts with different accelerations
/// these are not the forces before it.
fn steady_n(train: &Train, event: &Event) -> Vec<f64> {
    let kept = match train.extras().steady {
        Some(_) => train.initial_force_n().to_vec(),
        None => initial_force_n(train, event),
    };
    let force = |i: Option<usize>| i.and_then(|i| kept.get(i)).copied().unwrap_or(0.0);
    (0..train.vehicles().len()).map(|v| force(Some(v)) - force(v.checked_sub(1))).collect()
}

/// Forces from outside that change: of a pulse, of tractive efforts.
fn forcing(scenario: &Scenario, horizon_s: f64) -> Vec<(usize, Drive)> {
    let pulse = match &scenario.event {
        Event::Pulse(pulse) => Some((pulse.vehicle, pulse.drive())),
        _ => None,
    };
    let held = |f: Forcing| {
        let mut points = f.points;
        // The last value holds.
        points.extend(points.last().map(|last| [last[0].max(horizon_s) + 1.0, last[1]]));
        (f.vehicle, Drive::Lines(points))
    };
    pulse.into_iter().chain(scenario.response.efforts.iter().cloned().map(held)).collect()
}
