//! The train and its scales, as rows of a table.

use super::numbers::{brief_time, digits, force_unit, given_force_in, without_zeros};
use super::words::{count, sense};
use crate::consist::{self, of_parts};
use crate::findings::variants::critical_n_s_per_m;
use crate::scenario;
use crate::train::{Train, Vehicle};
use crate::units::{Dimension, Unit, UnitSystem, shown, shown_in, unit_for};

/// What the train is: name and value of each fact that it has.
pub fn train_facts(train: &Train) -> Vec<[String; 2]> {
    let (wave, units) = (scenario::wave(train), train.origin().units);
    let four = |x: f64| without_zeros(&digits(x, 0.0, 4));
    let speed = match wave.metres_per_s {
        Some(v) => format!("{} vehicles/s, {}", four(wave.vehicles_per_s), units.wave_speed(v)),
        None => format!("{} vehicles/s", four(wave.vehicles_per_s)),
    };
    let couplers = train.couplers();
    let live: Vec<&Vehicle> = train.vehicles().iter().filter(|v| !v.held).collect();
    let with_held = if live.len() < train.vehicles().len() { ", with held vehicles" } else { "" };
    let unit = if equal(&live, |v| v.mass_kg) && equal(couplers, |c| c.stiffness_n_per_m) {
        "time unit √(m/k)"
    } else {
        "time unit √(m/k), mean over the couplers"
    };
    let mut rows = vec![
        ["vehicles, couplers".to_owned(), format!("{}, {}", train.vehicles().len(), couplers.len())],
        [
            format!("total mass{with_held}"),
            shown(units, train.vehicles().iter().map(|v| v.mass_kg).sum(), Dimension::Mass),
        ],
        ["mass of a vehicle".to_owned(), span_of(units, train.vehicles().iter().map(|v| v.mass_kg), Dimension::Mass)],
    ];
    rows.extend(train.length_m().map(|(m, without_held)| {
        let Unit { name, size } = units.long();
        let without = if without_held { ", without held vehicles" } else { "" };
        [format!("length over couplers{without}"), format!("{} {name}", four(m / size))]
    }));
    rows.extend(held(train).map(|h| ["held at their speed".to_owned(), h]));
    let stiffness = span_of(units, couplers.iter().map(|c| c.stiffness_n_per_m), Dimension::Stiffness);
    if train.extras().laws.is_empty() {
        rows.push(["stiffness of a coupler".to_owned(), stiffness]);
    } else {
        rows.push(["mean stiffness in loading (used only for wave speed, transit and horizon)".to_owned(), stiffness]);
        rows.extend(consist::laws(train).into_iter().map(|line| ["law of couplers".to_owned(), line]));
    }
    if train.extras().damping_ratio > 0.0 {
        let ratio = format!("{} (not that of a dashpot, for which ratios are published)", train.extras().damping_ratio);
        rows.push(["damping ratio of every mode".to_owned(), ratio]);
    }
    let dashpots = &train.extras().dashpot_n_s_per_m;
    if !dashpots.is_empty() {
        let written = span_of(units, dashpots.iter().copied(), Dimension::Damping);
        rows.push([
            "dashpot of a coupler".to_owned(),
            format!("{written}, damping ratio c / 2\u{221a}(km) {} (of a dashpot)", ratios(train)),
        ]);
    }
    rows.extend([
        ["rated in draft".to_owned(), span_of(units, couplers.iter().map(|c| c.rated_draft_n), Dimension::Force)],
        ["rated in buff".to_owned(), span_of(units, couplers.iter().map(|c| c.rated_buff_n), Dimension::Force)],
        ["load before the event".to_owned(), format!("{}{}", load(train), of_parts(train))],
    ]);
    rows.extend(steady(train));
    rows.extend([
        [unit.to_owned(), brief_time(wave.time_unit_s)],
        ["wave speed".to_owned(), speed],
        ["one-way transit of the train".to_owned(), brief_time(wave.transit_s)],
    ]);
    rows
}

/// The share of critical damping that each coupler would have between its lighter vehicle and a wall.
fn ratios(train: &Train) -> String {
    let all = train.extras().dashpot_n_s_per_m.iter().enumerate().map(|(i, c)| c / critical_n_s_per_m(train, i));
    span(all, |r| without_zeros(&digits(r, 0.0, 3)))
}

fn equal<T>(items: &[T], value: impl Fn(&T) -> f64) -> bool {
    items.windows(2).all(|w| value(&w[0]) == value(&w[1]))
}

fn held(train: &Train) -> Option<String> {
    let held = train.vehicles().iter().enumerate().filter(|(_, v)| v.held);
    let names: Vec<String> = held.map(|(i, v)| format!("vehicle {} ({})", i + 1, v.label)).collect();
    (!names.is_empty()).then(|| names.join(", "))
}

/// "30 MN/m", or "26 to 30 MN/m" where they differ.
fn span(values: impl Iterator<Item = f64>, write: impl Fn(f64) -> String) -> String {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    if low == high { write(low) } else { format!("{} to {}", write(low), write(high)) }
}

/// The same of quantities, in one unit.
fn span_of(units: UnitSystem, values: impl Iterator<Item = f64> + Clone, dimension: Dimension) -> String {
    let unit = unit_for(units.units(dimension), values.clone().fold(0.0, f64::max));
    span(values, |value| shown_in(unit, value))
}

/// Where the load comes from, if the file gives the forces on the vehicles.
fn steady(train: &Train) -> Vec<[String; 2]> {
    let Some(steady) = &train.extras().steady else { return Vec::new() };
    let sum = |sign: f64| steady.outside_n.iter().map(|f| (sign * f).max(0.0)).sum::<f64>();
    let acceleration = match steady.acceleration_m_per_s2 {
        0.0 => "none: the speed is constant".to_owned(),
        a => train.origin().units.acceleration(a),
    };
    vec![
        ["forces on the vehicles, forward and backward".to_owned(), {
            let unit = force_unit(train.origin().units, sum(1.0).max(sum(-1.0)));
            format!("{} and {}", given_force_in(unit, sum(1.0)), given_force_in(unit, sum(-1.0)))
        }],
        ["acceleration before the event".to_owned(), acceleration],
    ]
}

fn load(train: &Train) -> String {
    let forces = || train.initial_force_n().iter().copied();
    if forces().all(|f| f == 0.0) {
        return "none".to_owned();
    }
    let unit = force_unit(train.origin().units, forces().map(f64::abs).fold(0.0, f64::max));
    let one = |f: f64| {
        let force = given_force_in(unit, f);
        if f == 0.0 { force } else { format!("{force} in {}", sense(f)) }
    };
    if equal(train.initial_force_n(), |&f| f) {
        return format!("{} in {}", one(train.initial_force_n()[0]), count(train.couplers().len(), "coupler"));
    }
    let widest = train.initial_force_n().iter().enumerate().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    let largest = widest.map_or(String::new(), |(i, f)| format!(", largest in coupler {}: {}", i + 1, one(*f)));
    format!("{}{largest}", span(forces(), one))
}
