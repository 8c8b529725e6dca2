//! A train file's `[[scenario]]` tables.

use std::collections::HashMap;
use std::ops::Range;

use super::Vehicle;
use super::file::coupler_list;
use super::tree::{Read, Sign, Table, Value};
use crate::error::quoted;
use crate::scenario::{Event, Scenario};
use crate::units::{Amount, Dimension};

/// More breaks than this, over all scenarios, are refused.
const MOST_CASES: usize = 1_000_000;

const KEYS: [&str; 8] = ["name", "kind", "coupler", "at", "force", "duration", "shape", "horizon"];
const BREAK_KEYS: [&str; 1] = ["coupler"];
const PULSE_KEYS: [&str; 4] = ["at", "force", "duration", "shape"];

/// The scenarios, or each coupler in turn if there are none.
pub(super) fn read(root: &Table, vehicles: &[Vehicle], weakest_n: f64) -> Read<Vec<Scenario>> {
    let each = || Event::Break { couplers: (0..vehicles.len() - 1).collect() };
    let tables = root.get("scenario").map_or(Ok(vec![]), |v| v.tables("[[scenario]]", &KEYS))?;
    if tables.is_empty() {
        let event = each();
        return Ok(vec![Scenario { name: default_name(&event, vehicles.len()), event, horizon_s: None }]);
    }
    let (mut scenarios, mut cases) = (vec![], 0);
    for table in &tables {
        let scenario = scenario(table, vehicles, weakest_n);
        if let Ok(Unnamed { event: Event::Break { couplers }, .. }) = &scenario {
            cases += couplers.len();
        }
        if cases > MOST_CASES {
            let title = format!("the scenarios have more than {MOST_CASES} breaks up to here");
            return Err(table.wrong(title, "a train file has at most that many"));
        }
        scenarios.push(scenario);
    }
    named(scenarios.into_iter().collect::<Read<_>>()?, vehicles.len())
}

/// A scenario that may have no name yet.
struct Unnamed<'s> {
    name: Option<(&'s str, Value<'s>)>,
    event: Event,
    horizon_s: Option<f64>,
}

fn scenario<'s>(table: &Table<'s>, vehicles: &[Vehicle], weakest_n: f64) -> Read<Unnamed<'s>> {
    let name = table.get("name").map(|v| v.name().map(|text| (text, v.clone()))).transpose();
    let horizon = table.get("horizon").map(|v| v.quantity(Dimension::Time, Sign::Positive)).transpose();
    let kind = table.require("kind", "add kind = \"break\" or kind = \"pulse\"")?;
    let event = match kind.word(&["break", "pulse"])? {
        "break" => {
            only_of(table, "break", &BREAK_KEYS, "pulse", &PULSE_KEYS);
            break_of(table, vehicles.len() - 1)
        }
        _ => {
            only_of(table, "pulse", &PULSE_KEYS, "break", &BREAK_KEYS);
            pulse(table, vehicles, weakest_n)
        }
    };
    Ok(Unnamed { name: name?, event: event?, horizon_s: horizon? })
}

/// Notes keys that belong to the other kind.
fn only_of(table: &Table, kind: &str, own: &[&str], other_kind: &str, other: &[&str]) {
    for key in other {
        if let Some(span) = table.key_span(key) {
            let help = format!("the keys of a {kind} are name, kind, {}, horizon", own.join(", "));
            table.note_at(span, format!("{key} is a key of a {other_kind}, and this scenario is a {kind}"), help);
        }
    }
}

fn break_of(table: &Table, count: usize) -> Read<Event> {
    let right = format!("expected a coupler's number from 1 to {count}, a list of them, or \"each\"");
    let value = table.require("coupler", &right)?;
    let couplers = match value.as_text() {
        Some("each") => (0..count).collect(),
        Some(text) => return Err(value.wrong_word(text, right)),
        None => coupler_list(&value, count, &right)?,
    };
    Ok(Event::Break { couplers })
}

fn pulse(table: &Table, vehicles: &[Vehicle], weakest_n: f64) -> Read<Event> {
    let vehicle = struck(table, vehicles);
    let force = table
        .require("force", "add force = \"-1.2 MN\", the outside force on that vehicle, forward positive")
        .and_then(|v| v.amount(Dimension::Force, Sign::NonZero));
    let duration = table
        .require("duration", "add duration = \"60 ms\", how long the force acts")
        .and_then(|v| v.quantity(Dimension::Time, Sign::Positive));
    let shape = table.get("shape").map(|v| v.word(&["rectangle"])).transpose();
    shape?;
    let force_n = match force? {
        Amount::Si(value) => value,
        Amount::Share(share) => share * weakest_n,
    };
    Ok(Event::Pulse { vehicle: vehicle?, force_n, duration_s: duration? })
}

/// The vehicle that a pulse strikes, as an index from 0.
fn struck(table: &Table, vehicles: &[Vehicle]) -> Read<usize> {
    let right = format!("expected \"head\", \"tail\" or a vehicle's number from 1 to {}", vehicles.len());
    let value = table.require("at", &right)?;
    let vehicle = match value.as_text() {
        Some("head") => 0,
        Some("tail") => vehicles.len() - 1,
        Some(text) => return Err(value.wrong_word(text, right)),
        None => value.number(vehicles.len(), |n| format!("the train has no vehicle {n}"), &right)? - 1,
    };
    if vehicles[vehicle].held {
        return Err(
            value.wrong("the pulse strikes a held vehicle, which no force moves", "choose a vehicle that is not held")
        );
    }
    Ok(vehicle)
}

/// Gives names to those without one and notes those that are given twice.
fn named(scenarios: Vec<Unnamed>, vehicles: usize) -> Read<Vec<Scenario>> {
    let mut taken: HashMap<String, Range<usize>> = HashMap::new();
    for (name, value) in scenarios.iter().filter_map(|s| s.name.as_ref()) {
        if let Some(earlier) = taken.insert((*name).to_owned(), value.span()) {
            let title = format!("two scenarios are named {}", quoted(name));
            return Err(value.wrong_because(
                title,
                "give each scenario a name of its own",
                earlier,
                "named here before",
            ));
        }
    }
    let name_one = |scenario: Unnamed| {
        let name = match scenario.name {
            Some((name, _)) => name.to_owned(),
            None => {
                let plain = default_name(&scenario.event, vehicles);
                let again = (2..).map(|i| format!("{plain} ({i})"));
                let mut candidates = std::iter::once(plain.clone()).chain(again);
                let free = candidates.find(|name| !taken.contains_key(name)).unwrap_or(plain);
                taken.insert(free.clone(), 0..0);
                free
            }
        };
        Scenario { name, event: scenario.event, horizon_s: scenario.horizon_s }
    };
    Ok(scenarios.into_iter().map(name_one).collect())
}

/// What a scenario is called that has no name.
fn default_name(event: &Event, vehicles: usize) -> String {
    match event {
        Event::Break { couplers } => match couplers.as_slice() {
            [one] => format!("break of coupler {}", one + 1),
            all if all.len() + 1 == vehicles => "each coupler breaks in turn".to_owned(),
            [some @ .., last] if some.len() < 6 => {
                let some: Vec<String> = some.iter().map(|c| (c + 1).to_string()).collect();
                format!("break of couplers {} and {} in turn", some.join(", "), last + 1)
            }
            many => format!("break of {} couplers in turn", many.len()),
        },
        Event::Pulse { vehicle: 0, .. } => "pulse at the head".to_owned(),
        Event::Pulse { vehicle, .. } if vehicle + 1 == vehicles => "pulse at the tail".to_owned(),
        Event::Pulse { vehicle, .. } => format!("pulse at vehicle {}", vehicle + 1),
    }
}
