//! Brake applications on a train: when they reach each vehicle, and the forces that they bring.
//!
//! ```text
//! B_v(t) = -full_v share(t - |x_v - x| / wave)          x: where the application starts, x_v: the middle of vehicle v
//! ```

use crate::march::Brakes;
use crate::train::{Application, Event, Scenario, Train};

/// Distance of each vehicle's middle from the front of the train, m; `None` where a vehicle has no length.
pub(crate) fn middles_m(train: &Train) -> Option<Vec<f64>> {
    let mut front = 0.0;
    let middle = |v: &crate::train::Vehicle| {
        let length = v.length_m?;
        front += length;
        Some(front - 0.5 * length)
    };
    train.vehicles().iter().map(middle).collect()
}

/// Distance of the coupler behind each vehicle but the last from the front of the train, m.
pub(crate) fn couplers_m(train: &Train) -> Option<Vec<f64>> {
    let lengths: Option<Vec<f64>> = train.vehicles().iter().map(|v| v.length_m).collect();
    let ends = |lengths: Vec<f64>| {
        let mut front = 0.0;
        let mut end = |length: f64| {
            front += length;
            front
        };
        lengths[..lengths.len() - 1].iter().map(|&l| end(l)).collect()
    };
    lengths.map(ends)
}

/// The brakes of every vehicle.
fn brakes(train: &Train, application: &Application) -> Brakes {
    Brakes {
        wave_m_s: application.wave_m_per_s,
        build_up: application.build_up.clone(),
        full_n: train.extras().emergency_brake_n.clone(),
        length_m: train.vehicles().iter().map(|v| v.length_m.unwrap_or(0.0)).collect(),
    }
}

/// The brakes that each parting sets off: those of a break, or of an emergency application.
pub(super) fn of_partings(train: &Train, scenario: &Scenario) -> Option<Brakes> {
    let applied = match &scenario.event {
        Event::Brake { emergency: true, application, .. } => Some(application),
        _ => scenario.response.emergency.as_ref(),
    };
    applied.map(|application| brakes(train, application))
}

/// The brakes of a brake application, and the places from which they are applied, m.
pub(super) fn of_event(train: &Train, scenario: &Scenario) -> Option<(Brakes, Vec<f64>)> {
    let Event::Brake { from, application, .. } = &scenario.event else { return None };
    let middles = middles_m(train)?;
    Some((brakes(train, application), from.iter().map(|&v| middles[v]).collect()))
}

/// When an application that starts at places, m, has built up in every vehicle, s; 0 where there are no places.
fn built_up_s(train: &Train, application: &Application, from_m: &[f64]) -> f64 {
    let Some(middles) = middles_m(train) else { return 0.0 };
    let distance_m = |x: f64| from_m.iter().map(|s| (x - s).abs()).fold(f64::INFINITY, f64::min);
    let farthest_m = middles.iter().map(|x| distance_m(*x)).fold(0.0, f64::max);
    if farthest_m.is_finite() { farthest_m / application.wave_m_per_s + application.full_after_s() } else { 0.0 }
}

/// When brakes and tractive efforts last change after an event, s; `broken` is the coupler that parts, where one does.
pub(super) fn last_change_s(train: &Train, scenario: &Scenario, broken: Option<usize>) -> f64 {
    let efforts = scenario.response.efforts.iter().filter_map(|f| f.points.last()).map(|p| p[0]).fold(0.0, f64::max);
    let parting = broken.and_then(|b| Some(vec![couplers_m(train)?[b]]));
    let emergency = scenario.response.emergency.as_ref().zip(parting).map(|(a, from)| built_up_s(train, a, &from));
    let applied = match &scenario.event {
        Event::Brake { from, application, .. } => {
            let from_m = |middles: Vec<f64>| from.iter().map(|&v| middles[v]).collect::<Vec<_>>();
            middles_m(train).map(|middles| built_up_s(train, application, &from_m(middles)))
        }
        _ => None,
    };
    [Some(efforts), emergency, applied].into_iter().flatten().fold(0.0, f64::max)
}
