//! A train file's `[[scenario]]` tables.

use std::path::Path;

use super::columns::is_record;
use super::couplers::coupler_list;
use super::keys::SCENARIO;
use super::labels::Labels;
use super::tree::{Found, Read, Table, Value};
use super::{Files, brakes, record};
use crate::error::quoted;
use crate::train::{Doubt, Event, MOST_CASES, MOST_SCENARIOS, Pulse, PulseShape, Response, Rule, Scenario, Train};
use crate::units::{Amount, Dimension, shown};

/// What reading a scenario needs.
pub(super) struct Context<'a, 'v> {
    pub found: &'a Found,
    pub labels: &'a Labels<'v>,
    /// The train without scenarios.
    pub train: &'a Train,
    /// Tractive effort of each vehicle, N.
    pub traction_n: &'a [f64],
    /// The smallest capacity in draft, N.
    pub weakest_n: f64,
    /// The train file.
    pub path: &'a Path,
    pub files: &'a Files,
}

/// The scenarios that the file has.
pub(super) fn read(root: &Table, context: &Context) -> Read<Vec<Scenario>> {
    let tables = root.get("scenario").map_or(Ok(vec![]), |v| v.tables())?;
    let mut cases = 0;
    let mut scenarios = vec![];
    // One more than allowed is enough to refuse them.
    for table in tables.iter().take(MOST_SCENARIOS + 1) {
        let scenario = scenario(table, context).unwrap_or_else(|_| placeholder_scenario());
        if let Event::Break { couplers } = &scenario.event {
            cases += couplers.len();
        }
        scenarios.push(scenario);
        if cases > MOST_CASES {
            break;
        }
    }
    Ok(scenarios)
}

/// Stands in for a scenario that was wrong, so that the others are still looked at.
fn placeholder_scenario() -> Scenario {
    let event = Event::Break { couplers: vec![0] };
    let (name, response) = (String::new(), Response::default());
    Scenario { name, event, horizon_s: None, cascade: Rule::Keep, left_out_in_buff: vec![], response }
}

/// A scenario; without a name where the table gives none.
fn scenario(table: &Table, context: &Context) -> Read<Scenario> {
    let name = table.get("name").map_or(Ok(""), |v| v.name());
    let horizon = table.get("horizon").map(|v| v.quantity()).transpose();
    let kind =
        table.require("kind", "add kind = \"break\", kind = \"pulse\", kind = \"impact\" or kind = \"brake\"")?;
    let kind = kind.word()?;
    only_of(table, kind);
    let breaking = breaking(table, kind);
    let event = match kind {
        // If the flag is wrong, couplers in buff are not reported.
        "break" => break_of(table, context, breaking.as_ref().map_or(true, |(_, in_buff)| *in_buff)),
        "impact" => impact(table, context.labels.count).map(|event| (event, vec![])),
        "brake" => brake(table, context).map(|event| (event, vec![])),
        _ => pulse(table, context).map(|event| (event, vec![])),
    };
    let response = response(table, kind, context);
    let (name, horizon_s, (event, left_out_in_buff), (cascade, buff_breaks)) = (name?, horizon?, event?, breaking?);
    let response = response?;
    if let Event::Break { couplers } = &event
        && buff_breaks
        && cascade == Rule::Keep
        && !couplers.iter().any(|&b| context.train.in_buff(b))
    {
        let what = if name.is_empty() { "a scenario" } else { name };
        let why = match context.train.extras().laws.is_empty() {
            true => "no coupler that breaks in it carries buff, and it has no cascade",
            false => {
                "in a train with slack or gears a coupler that carries buff breaks without it, and it has no cascade"
            }
        };
        let text = format!("buff_breaks of {what} changes nothing: {why}");
        table.doubt(Doubt::of_train("buff-breaks-unused", text));
    }
    let name = name.to_owned();
    Ok(Scenario { name, event, left_out_in_buff, horizon_s, cascade, response })
}

/// The rule for couplers that pass their load, and whether those in buff break.
fn breaking(table: &Table, kind: &str) -> Read<(Rule, bool)> {
    let on = table.get("cascade").map_or(Ok(false), |v| v.flag());
    let buff = table.get("buff_breaks");
    let in_buff = buff.as_ref().map_or(Ok(false), |v| v.flag());
    let (on, in_buff) = (on?, in_buff?);
    if let Some(buff) = buff.filter(|_| !on && kind != "break") {
        let title = format!("buff_breaks without a cascade in {}", with_article(kind));
        return Err(buff.wrong(title, "add cascade = true, or leave it out"));
    }
    let rule = match (on, in_buff) {
        (false, _) => Rule::Keep,
        (true, false) => Rule::InDraft,
        (true, true) => Rule::InBoth,
    };
    Ok((rule, in_buff))
}

/// Notes keys that belong to other kinds alone.
fn only_of(table: &Table, kind: &str) {
    let foreign = |key: &str| SCENARIO.foreign(kind).any(|(other, _)| other == key);
    let all = SCENARIO.names().filter(|key| !foreign(key)).collect::<Vec<_>>().join(", ");
    for (key, other) in SCENARIO.foreign(kind) {
        if let Some(span) = table.key_span(key) {
            let (one, kind) = (with_article(other.word), with_article(kind));
            let title = format!("{key} is a key of {one}, and this scenario is {kind}");
            let own = if key == "speed" { "; the train's speed stands at the top of the file" } else { "" };
            table.note_at(span, title, format!("the keys of {kind} are {all}{own}"));
        }
    }
}

fn with_article(word: &str) -> String {
    format!("{} {word}", if word.starts_with('i') { "an" } else { "a" })
}

/// The couplers that break, and those of "each" that are left out because they carry buff.
fn break_of(table: &Table, context: &Context, buff_breaks: bool) -> Read<(Event, Vec<usize>)> {
    let labels = context.labels;
    let count = labels.count - 1;
    let right = format!("expected a coupler's number from 1 to {count}, a list of them, or \"each\"");
    let value = table.require("coupler", &right)?;
    let couplers = match value.as_text() {
        Some("each") => return Ok(context.train.each(buff_breaks)),
        Some(text) => return Err(value.wrong_word(text, right)),
        None => coupler_list(&value, labels, &right)?,
    };
    let pressed = |(item, &i): (Value, &usize)| {
        let force = shown(context.train.origin().units, -context.train.initial_force_n()[i], Dimension::Force);
        let title =
            format!("coupler {} carries {force} in buff, so its vehicles stay pressed together when it breaks", i + 1);
        let help = "choose a coupler in draft, or add buff_breaks = true to compute it as if the parts could pass through each other";
        item.wrong(title, help)
    };
    let in_buff = |(_, i): &(Value, &usize)| !buff_breaks && context.train.in_buff(**i);
    match value.items().zip(&couplers).filter(in_buff).map(pressed).last() {
        Some(reported) => Err(reported),
        None => Ok((Event::Break { couplers }, vec![])),
    }
}

fn pulse(table: &Table, context: &Context) -> Read<Event> {
    let vehicle = place(table, context, "").map(|(_, vehicle)| vehicle);
    if let Some(record) = table.get("record") {
        return recorded(table, &record, vehicle?, context);
    }
    let force = table
        .require("force", "add force = \"-1.2 MN\", the outside force on that vehicle, forward positive")
        .and_then(|v| v.amount());
    let duration =
        table.require("duration", "add duration = \"60 ms\", how long the force acts").and_then(|v| v.quantity());
    let shape = table.get("shape").map_or(Ok("rectangle"), |v| v.word());
    let (shape, duration_s) = (shape?, duration?);
    let ramps = ramps(table, shape)?;
    let force_n = match force? {
        Amount::Si(value) => value,
        Amount::Share(share) => share * context.weakest_n,
    };
    let vehicle = vehicle?;
    let shape = match shape {
        "rectangle" => PulseShape::Rectangle,
        "half-sine" => PulseShape::HalfSine,
        "triangle" => PulseShape::Triangle,
        _ => PulseShape::Trapezoid { rise_s: ramps[0], fall_s: ramps[1] },
    };
    Ok(Event::Pulse(Pulse { vehicle, force_n, duration_s, shape }))
}

/// A trapezoid's times of rise and fall, s.
fn ramps(table: &Table, shape: &str) -> Read<[f64; 2]> {
    let quantity = |key| table.get(key).map(|v| v.quantity()).transpose();
    let (rise, fall) = (quantity("rise"), quantity("fall"));
    if shape != "trapezoid" {
        for key in ["rise", "fall"] {
            if let Some(span) = table.key_span(key) {
                let help = "add shape = \"trapezoid\", or leave it out";
                return Err(table.note_at(span, format!("{key} of a pulse that is no trapezoid"), help));
            }
        }
        return Ok([0.0; 2]);
    }
    let rises = table.require("rise", "add rise = \"10 ms\", the time until the force is full");
    let rise_s = rise?.unwrap_or_default();
    rises?;
    let fall_s = fall?.unwrap_or(rise_s);
    Ok([rise_s, fall_s])
}

/// A pulse whose course stands in a file of its own, beside the train file.
fn recorded(table: &Table, record: &Value, vehicle: usize, context: &Context) -> Read<Event> {
    for key in ["force", "duration", "shape", "rise", "fall"] {
        if let Some(span) = table.key_span(key) {
            return Err(table.note_at(span, format!("{key} beside a record"), "the record gives the force over time"));
        }
    }
    let (file, text) = record.text_beside(context.path, context.files, is_record)?;
    let record::Course { points, doubts } = record::parse(&text, &file).map_err(|bad| record.refer(&bad))?;
    doubts.into_iter().for_each(|doubt| context.found.doubt(doubt));
    let force_n = points.iter().map(|p| p[1]).fold(0.0f64, |a, f| if f.abs() > a.abs() { f } else { a });
    let duration_s = points.last().map_or(0.0, |p| p[0]);
    Ok(Event::Pulse(Pulse { vehicle, force_n, duration_s, shape: PulseShape::Record(points) }))
}

fn impact(table: &Table, count: usize) -> Read<Event> {
    let right = "add at = \"tail\" or at = \"head\": the end that is struck";
    let at = table.require("at", right).and_then(|v| v.word_of(&["head", "tail"]));
    let most = format!("expected a whole number from 1 to {}: at least one vehicle stands", count - 1);
    let vehicles = table
        .require("vehicles", "add vehicles = 3, how many arrive together")
        .and_then(|v| v.number(count - 1, |n| format!("vehicles is {n}"), &most));
    let speed = table.require("speed", "add speed = \"6 mph\", how fast they arrive").and_then(|v| v.quantity());
    Ok(Event::Impact { at_head: at? == "head", vehicles: vehicles?, speed_m_per_s: speed? })
}

/// What brakes and drives do after the event.
fn response(table: &Table, kind: &str, context: &Context) -> Read<Response> {
    if !["break", "brake"].contains(&kind) {
        // Keys that belong to other kinds have been noted.
        return Ok(Response::default());
    }
    let emergency = match table.get("emergency").filter(|_| kind == "break") {
        Some(value) => brakes::application(&value, true).map(Some),
        None => Ok(None),
    };
    let Context { train, traction_n, path, files, .. } = context;
    let efforts = brakes::efforts(table, train.vehicles(), traction_n, path, files);
    Ok(Response { emergency: emergency?, efforts: efforts? })
}

/// A brake application and where it starts.
fn brake(table: &Table, context: &Context) -> Read<Event> {
    let vehicles = context.labels.count;
    let both = table.get("at").filter(|at| at.as_text() == Some("both ends"));
    let from = match both {
        Some(_) => Ok(vec![0, vehicles - 1]),
        None => place(table, context, "\"both ends\", ").map(|(_, vehicle)| vec![vehicle]),
    };
    let (emergency, service) = (table.get("emergency"), table.get("service"));
    let value = match (emergency, service) {
        (Some(emergency), Some(service)) => {
            let help = "keep one of them";
            return Err(service.wrong_because(
                "service beside emergency",
                help,
                emergency.span(),
                "the emergency application",
            ));
        }
        (None, None) => {
            let help = "add service = \"AAR\" or emergency = \"AAR\", or its wave and build-up";
            let help = match table.get("coupler") {
                Some(_) => {
                    "a coupler breaks with kind = \"break\"; brakes need service = \"AAR\" or emergency = \"AAR\""
                }
                None => help,
            };
            return Err(table.wrong("the brake application gives neither service nor emergency", help));
        }
        (emergency, service) => emergency.map(|v| (v, true)).or(service.map(|v| (v, false))),
    };
    let Some((value, emergency)) = value else { unreachable!("one of the two is there") };
    let application = brakes::application(&value, emergency);
    Ok(Event::Brake { from: from?, emergency, application: application? })
}

/// The vehicle that `at` names, as an index from 0; `more`: other right values.
fn place<'s>(table: &Table<'s>, context: &Context, more: &str) -> Read<(Value<'s>, usize)> {
    let Context { labels, found, train, .. } = context;
    let vehicles = train.vehicles();
    let right =
        format!("expected {more}\"head\", \"tail\", a vehicle's number from 1 to {} or its label", vehicles.len());
    let value = table.require("at", &right)?;
    let vehicle = match value.as_text() {
        Some(end @ ("head" | "tail")) => {
            let vehicle = if end == "head" { 0 } else { vehicles.len() - 1 };
            if let Some(other) = vehicles.iter().position(|v| v.label == end).filter(|other| *other != vehicle) {
                let text = format!(
                    "at = \"{end}\" is the {end} of the train, not vehicle {}, which has that label",
                    other + 1
                );
                found.doubt(Doubt::of_train("label-head-or-tail", text));
            }
            vehicle
        }
        Some(_) => {
            let label = value.name()?;
            let vehicle = labels.vehicle(&value, label, "\"head\", \"tail\" or a vehicle's number")?;
            labels.note(format!("{} is vehicle {}", quoted(label), vehicle + 1));
            vehicle
        }
        None => value.number(vehicles.len(), |n| format!("the train has no vehicle {n}"), &right)? - 1,
    };
    Ok((value, vehicle))
}
