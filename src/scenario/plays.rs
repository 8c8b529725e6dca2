//! A scenario as it is played on the whole train, in the solvers' units.

use super::{Event, Scales, Scenario, chain_of};
use crate::chain::Scene;
use crate::consist::{LIMITS, Limits, Train};
use crate::play::{Drive, Play, Rule};

/// Whether dashpots or the event are what steps of force on a chain at rest cannot stand for.
pub fn beyond_steps(dashpots: &[f64], event: &Event) -> bool {
    dashpots.iter().any(|c| *c > 0.0) || matches!(event, Event::Impact { .. } | Event::Shaped { .. })
}

/// The loads at which coupler `i` breaks in a cascade, N, in draft and in buff, each with the key that gives it: its ultimate
/// load where it has one in that sense, else its rating.
pub fn break_loads(train: &Train, i: usize) -> [(f64, &'static str); 2] {
    let coupler = &train.couplers[i];
    let [draft, buff] = train.extras.limits.get(i).map_or([None; 2], Limits::ultimate_n);
    let or = |ultimate: Option<f64>, rating, key| ultimate.map_or((rating, key), |n| (n, LIMITS[2]));
    [or(draft, coupler.rated_draft_n, "rated_load"), or(buff, coupler.rated_buff_n, "rated_buff")]
}

/// Forces in the couplers before the event, N: none in an impact, whose vehicles roll and stand freely before they meet.
pub fn initial_force_n(train: &Train, event: &Event) -> Vec<f64> {
    match event {
        Event::Impact { .. } => vec![0.0; train.couplers.len()],
        _ => train.initial_force_n.clone(),
    }
}

/// The whole train with an event; `broken` is the coupler that breaks in a case of a break.
pub fn play(train: &Train, scenario: &Scenario, broken: Option<usize>, horizon_s: f64, rule: Rule) -> Play {
    let scales = Scales::of(train);
    let last = train.vehicles.len() - 1;
    let force = |n: f64| n / scales.force_n;
    let time = |s: f64| s / scales.time_s;
    let (source, drive) = match &scenario.event {
        Event::Pulse { vehicle, force_n, duration_s } => {
            (*vehicle, Drive::rectangle(force(*force_n), time(*duration_s)))
        }
        Event::Shaped { vehicle, drive, .. } => (*vehicle, drive.scaled(1.0 / scales.time_s, 1.0 / scales.force_n)),
        _ => (usize::from(train.vehicles[0].held), Drive::none()),
    };
    let unit = scales.force_n * scales.time_s / scales.mass_kg;
    let velocity = (0..=last).map(|v| speed_m_per_s(&scenario.event, v, last) / unit).collect();
    let damping = scales.stiffness_n_per_m * scales.time_s;
    let dashpot = train.extras.dashpot_n_s_per_m.iter().map(|c| c / damping);
    let mut dashpot: Vec<f64> = dashpot.collect();
    dashpot.resize(last, 0.0);
    Play {
        scene: Scene {
            chain: chain_of(train, 0, last, &scales),
            source,
            force: 0.0,
            duration: 0.0,
            initial: initial_force_n(train, &scenario.event).into_iter().map(force).collect(),
            rated_draft: train.couplers.iter().map(|c| force(c.rated_draft_n)).collect(),
            rated_buff: train.couplers.iter().map(|c| force(c.rated_buff_n)).collect(),
            horizon: time(horizon_s),
        },
        drive,
        dashpot,
        velocity,
        broken: broken.into_iter().collect(),
        rule,
        break_at: (0..last).map(|i| break_loads(train, i).map(|(n, _)| force(n))).collect(),
    }
}

/// Speed of a vehicle against the standing rest at t = 0, forward positive: what arrives comes toward the rest.
fn speed_m_per_s(event: &Event, vehicle: usize, last: usize) -> f64 {
    match *event {
        Event::Impact { vehicles, at_head: true, speed_m_per_s } if vehicle < vehicles => -speed_m_per_s,
        Event::Impact { vehicles, at_head: false, speed_m_per_s } if vehicle + vehicles > last => speed_m_per_s,
        _ => 0.0,
    }
}
