//! A train, and what will be run on it, in words.

use std::fmt::Write as _;

use super::describe_laws;
use crate::doubts::doubts;
use crate::scenario::{break_loads, longest_horizon_s, shortest_horizon_s};
use crate::train::{Event, LIMITS, Pulse, PulseShape, Rule, Scenario, Train, Vehicle, count};
use crate::units::{Dimension, UnitSystem, shown, shown_time};

/// Groups of vehicles, or else kinds of vehicles, that are listed at most.
const LISTED: usize = 12;

/// The train, what will be run on it, and the doubts about it, as lines of plain text.
pub fn describe(train: &Train) -> String {
    let mut text = format!("{}\n{}\n", train.name(), size(train));
    for line in vehicles(train) {
        let _ = writeln!(text, "  {line}");
    }
    let _ = writeln!(text, "{}", couplers(train));
    for line in describe_laws::laws(train) {
        let _ = writeln!(text, "  {line}");
    }
    let _ = writeln!(text, "{}\nto be run:", load(train));
    for scenario in train.scenarios() {
        let _ = writeln!(text, "  {}: {}", scenario.name, scenario_line(train, scenario));
    }
    for named in &train.origin().by_label {
        let _ = writeln!(text, "by label: {named}");
    }
    for doubt in doubts(train) {
        let _ = writeln!(text, "warning: {doubt}");
    }
    text
}

fn size(train: &Train) -> String {
    let units = train.origin().units;
    let free = train.vehicles().iter().filter(|v| !v.held);
    let mass = shown(units, free.map(|v| v.mass_kg).sum(), Dimension::Mass);
    let held = if train.vehicles().iter().any(|v| v.held) { ", not counting held vehicles" } else { "" };
    let length = train.length_m().map_or(String::new(), |(m, without_held)| {
        let without = if without_held { " without held vehicles" } else { "" };
        format!(", {} long{without}", shown(units, m, Dimension::Length))
    });
    let [vehicles, couplers] = [count(train.vehicles().len(), "vehicle"), count(train.couplers().len(), "coupler")];
    format!("{vehicles}, {couplers}, {mass}{held}{length}")
}

/// Groups of equal neighbours, from the head; of many groups the kinds of vehicle.
fn vehicles(train: &Train) -> Vec<String> {
    let line = |group| group_line(group, train.origin().units);
    let mut groups: Vec<(usize, &Vehicle)> = vec![];
    for vehicle in train.vehicles() {
        match groups.last_mut() {
            Some((count, first)) if alike(first, vehicle) => *count += 1,
            _ => groups.push((1, vehicle)),
        }
    }
    if groups.len() <= LISTED {
        return groups.into_iter().map(line).collect();
    }
    let in_groups = format!("in {} groups from the head, of these kinds:", groups.len());
    let mut kinds: Vec<(usize, &Vehicle)> = vec![];
    let mut other = 0;
    for (count, vehicle) in groups {
        match kinds.iter().position(|(_, first)| alike(first, vehicle)) {
            Some(known) => kinds[known].0 += count,
            None if kinds.len() < LISTED => kinds.push((count, vehicle)),
            None => other += count,
        }
    }
    let rest = (other > 0).then(|| format!("{} of other kinds", count(other, "vehicle")));
    std::iter::once(in_groups).chain(kinds.into_iter().map(line)).chain(rest).collect()
}

fn alike(a: &Vehicle, b: &Vehicle) -> bool {
    (a.mass_kg, a.held, a.length_m) == (b.mass_kg, b.held, b.length_m) && unnumbered(&a.label) == unnumbered(&b.label)
}

/// A label without its number: "ore car" of "ore car 12".
fn unnumbered(label: &str) -> &str {
    label.rsplit_once(' ').filter(|(_, n)| n.bytes().all(|b| b.is_ascii_digit())).map_or(label, |(name, _)| name)
}

fn group_line((count, vehicle): (usize, &Vehicle), units: UnitSystem) -> String {
    let held = if vehicle.held { " (held)" } else { "" };
    let length = vehicle.length_m.map_or(String::new(), |l| format!(", {}", shown(units, l, Dimension::Length)));
    let label = if count == 1 { &*vehicle.label } else { unnumbered(&vehicle.label) };
    format!("{count} x {label}{held} of {}{length}", shown(units, vehicle.mass_kg, Dimension::Mass))
}

fn couplers(train: &Train) -> String {
    let units = train.origin().units;
    let range = |values: Vec<f64>, dimension: Dimension| {
        let low = shown(units, values.iter().copied().fold(f64::INFINITY, f64::min), dimension);
        let high = shown(units, values.iter().copied().fold(0.0, f64::max), dimension);
        if low == high { low } else { format!("{low} to {high}") }
    };
    let stiffness = range(train.couplers().iter().map(|c| c.stiffness_n_per_m).collect(), Dimension::Stiffness);
    let draft = range(train.couplers().iter().map(|c| c.rated_draft_n).collect(), Dimension::Force);
    let buff = range(train.couplers().iter().map(|c| c.rated_buff_n).collect(), Dimension::Force);
    let damping = match train.extras().dashpot_n_s_per_m.clone() {
        _ if train.extras().damping_ratio > 0.0 => {
            format!("; damping ratio {} of every mode", train.extras().damping_ratio)
        }
        none if none.is_empty() => String::new(),
        some => format!("; dashpots {}", range(some, Dimension::Damping)),
    };
    let stiffness = match train.extras().laws.is_empty() {
        true => format!("stiffness {stiffness}"),
        false => format!("mean stiffness in loading {stiffness} (used only for wave speed, transit and horizon)"),
    };
    format!("couplers: {stiffness}; rated {draft} in draft, {buff} in buff{damping}")
}

fn load(train: &Train) -> String {
    let units = train.origin().units;
    let low = train.initial_force_n().iter().copied().fold(f64::INFINITY, f64::min);
    let high = train.initial_force_n().iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let force = |n: f64| match n {
        0.0 => "none".to_owned(),
        n if n > 0.0 => format!("{} in draft", shown(units, n, Dimension::Force)),
        n => format!("{} in buff", shown(units, -n, Dimension::Force)),
    };
    let range = if low == high { force(low) } else { format!("{} to {}", force(low), force(high)) };
    let from = train.extras().steady.as_ref().map_or(String::new(), |steady| match steady.acceleration_m_per_s2 {
        0.0 => ", from the forces on the vehicles at constant speed".to_owned(),
        a => format!(", from the forces on the vehicles, which accelerate the train by {}", units.acceleration(a)),
    });
    format!("load before the event: {range}{from}{}", of_parts(train))
}

/// The clause that follows the load of a train with an impact.
pub(crate) fn of_parts(train: &Train) -> &'static str {
    let impact = train.scenarios().iter().any(|s| s.event.kind() == "impact");
    let loaded = train.initial_force_n().iter().any(|f| *f != 0.0) || train.extras().steady.is_some();
    if impact && loaded {
        "; before an impact each part carries its own load, and the coupler that joins them none"
    } else {
        ""
    }
}

/// The load that breaks couplers in a cascade; `senses`: 1 is draft, 2 both.
fn breaking_loads(train: &Train, senses: usize) -> &'static str {
    let all = || (0..train.couplers().len()).flat_map(|i| break_loads(train, i).into_iter().take(senses));
    let ultimate = |(_, key): (f64, &str)| key == LIMITS[2];
    match (all().all(ultimate), all().any(ultimate)) {
        (true, _) => "their ultimate load",
        (false, true) => "their ultimate load, or their rating where none is given,",
        (false, false) => "their rating (no ultimate load is given)",
    }
}

fn scenario_line(train: &Train, scenario: &Scenario) -> String {
    let units = train.origin().units;
    let (event, cases) = match &scenario.event {
        Event::Break { couplers } => match couplers.as_slice() {
            [b] => {
                let [ahead, behind] = [&train.vehicles()[*b].label, &train.vehicles()[*b + 1].label];
                (format!("coupler {} between {ahead} and {behind} breaks", b + 1), 1)
            }
            [some @ .., last] if some.len() < 6 && some.len() + 1 < train.couplers().len() => {
                let some: Vec<String> = some.iter().map(|b| (b + 1).to_string()).collect();
                let which = format!("couplers {} and {}", some.join(", "), last + 1);
                (format!("{which} of {} break, one at a time", train.couplers().len()), some.len() + 1)
            }
            many => {
                let left_out = match scenario.left_out_in_buff.len() {
                    0 => String::new(),
                    n => format!(", and {n} in buff are left out"),
                };
                let total = train.couplers().len();
                (format!("{} of {total} couplers break, one at a time{left_out}", many.len()), many.len())
            }
        },
        Event::Pulse(Pulse { vehicle, force_n, duration_s, shape }) => {
            let direction = if *force_n > 0.0 { "forward" } else { "backward" };
            let [force, lasting] = [shown(units, force_n.abs(), Dimension::Force), shown_time(*duration_s)];
            let on = format!("{direction} on {}", train.vehicles()[*vehicle].label);
            let text = match shape {
                PulseShape::Rectangle => format!("{force} {on} for {lasting}"),
                shape => format!("{} of up to {force} {on}, over after {lasting}", shape.name()),
            };
            (text, 1)
        }
        Event::Impact { vehicles, at_head, speed_m_per_s } => {
            let end = if *at_head { "head" } else { "tail" };
            let arrive =
                format!("{} at {}", count(*vehicles, "vehicle"), shown(units, *speed_m_per_s, Dimension::Speed));
            (format!("{arrive} run into the {end} of the others, which stand, and couple"), 1)
        }
        Event::Brake { from, emergency, application } => {
            let what = if *emergency { "emergency" } else { "service" };
            let (place, course) = (describe_laws::place(train, from), describe_laws::application(application, units));
            (format!("{what} brakes are applied from {place} ({course})"), 1)
        }
    };
    let event = event + &describe_laws::response(train, scenario);
    let event = match scenario.cascade {
        Rule::Keep => event,
        Rule::InDraft => format!("{event}; couplers that pass {} in draft break", breaking_loads(train, 1)),
        Rule::InBoth => format!("{event}; couplers that pass {} in draft or buff break", breaking_loads(train, 2)),
    };
    let [from, to] = [shortest_horizon_s(train, scenario), longest_horizon_s(train, scenario)].map(shown_time);
    let horizon = if from == to { to } else { format!("{from} to {to}") };
    format!("{event}; {}, horizon {horizon}", count(cases, "case"))
}
