//! What a valid train is. Each rule is written once, here or beside its data ([`Law::check`](crate::law::Law::check),
//! [`Limits::disorder`](super::Limits), [`Sign::refuses`]); readers of files give it its place in the text.

use std::fmt;

use super::{Extras, Load, MOST_VEHICLES, PulledTo, Train, TrainSpec, VehicleSpec};
use crate::error::{controls_display, printable, quoted};
use crate::keys::Sign;
use crate::law::{Law, LawProblem};
use crate::units::{Dimension, shown};

/// One thing that is wrong with a spec.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct SpecProblem {
    /// The key that it is about, as a train file names it: `vehicle[3].mass`, counted from 0. Of couplers there is one for each:
    /// `coupler[0].stiffness`.
    pub key: String,
    /// What is wrong.
    pub message: String,
    /// What would be right.
    pub help: String,
    /// A related key, and how it is related.
    pub related: Option<(String, &'static str)>,
}

/// Everything that is wrong with a spec that is no valid train.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct InvalidTrain {
    /// At least one.
    pub problems: Vec<SpecProblem>,
}

impl SpecProblem {
    pub(super) fn new(key: impl Into<String>, message: impl Into<String>, help: impl Into<String>) -> SpecProblem {
        SpecProblem { key: key.into(), message: message.into(), help: help.into(), related: None }
    }
}

impl fmt::Display for SpecProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}; {}", self.key, self.message, self.help)
    }
}

impl fmt::Display for InvalidTrain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lines: Vec<String> = self.problems.iter().map(ToString::to_string).collect();
        f.write_str(&lines.join("\n"))
    }
}

impl std::error::Error for InvalidTrain {}

/// What is wrong with a number; `within` is the table that has it as its `key`.
pub(super) fn number(within: impl fmt::Display, key: &str, value: f64, sign: Sign) -> Option<SpecProblem> {
    let [found, right] = sign.refuses(value)?;
    let within = within.to_string();
    let dot = if within.is_empty() { "" } else { "." };
    let leaf = key.rsplit('.').next().unwrap_or(key);
    Some(SpecProblem::new(format!("{within}{dot}{key}"), format!("{leaf} {found}"), right))
}

/// What is wrong with a text that reports show.
pub(super) fn text(key: impl fmt::Display, text: &str) -> Option<SpecProblem> {
    let has_controls = text.chars().any(controls_display);
    if !has_controls && !text.trim().is_empty() {
        return None;
    }
    let key = key.to_string();
    let leaf = key.rsplit('.').next().unwrap_or(&key);
    if has_controls {
        let message = format!("{leaf} has a control character: {}", quoted(&printable(text)));
        return Some(SpecProblem::new(key, message, "expected plain text"));
    }
    (leaf == "label")
        .then(|| SpecProblem::new(key, "label is empty", "expected what reports call the vehicle, or no label"))
}

/// Problems with the numbers of vehicles, couplers and forces.
pub(super) fn structure(spec: &TrainSpec) -> Vec<SpecProblem> {
    let mut problems = many(&spec.vehicles);
    let vehicles = spec.vehicles.iter().fold(0usize, |sum, v| sum.saturating_add(v.count));
    if !problems.is_empty() {
        return problems;
    }
    let mut fits = |key: &str, what: &str, found: usize, due: usize| {
        if found != due {
            let message = format!("the train has {vehicles} vehicles and {found} {what}");
            problems.push(SpecProblem::new(key, message, format!("expected {due}")));
        }
    };
    fits("coupler", "couplers", spec.couplers.len(), vehicles - 1);
    match &spec.load {
        Load::None | Load::Uniform(_) => {}
        Load::InCouplers(forces) => fits("load", "forces in couplers", forces.len(), vehicles - 1),
        Load::OnVehicles(forces) => fits("load", "forces on vehicles", forces.len(), vehicles),
    }
    if let PulledTo::InCouplers(pulled) = &spec.pulled_to {
        fits("load.pulled_to", "pulls before", pulled.len(), vehicles - 1);
    }
    problems
}

/// Problems with the number of vehicles.
pub(crate) fn many(groups: &[VehicleSpec]) -> Vec<SpecProblem> {
    let right = "give it a row or a [[vehicle]] for each vehicle or group alike, from the head: at least two vehicles";
    if let Some(i) = groups.iter().position(|group| group.count == 0) {
        let help = "expected how many of them follow each other, 1 or more";
        return vec![SpecProblem::new(format!("vehicle[{i}].count"), "count is 0", help)];
    }
    let mut total = 0usize;
    for (i, group) in groups.iter().enumerate() {
        total = total.saturating_add(group.count);
        if total > MOST_VEHICLES {
            let message = format!("the train has more than {MOST_VEHICLES} vehicles up to here");
            return vec![SpecProblem::new(format!("vehicle[{i}]"), message, "a train has at most that many")];
        }
    }
    match total {
        0 => vec![SpecProblem::new("vehicle", "the train has no vehicles", right)],
        1 => vec![SpecProblem::new("vehicle[0]", "the train has one vehicle, so no coupler", right)],
        _ => vec![],
    }
}

/// Vehicles that cannot be held.
pub(crate) fn held(groups: &[VehicleSpec]) -> Vec<SpecProblem> {
    let right = "only the first and the last vehicle of the train can be held";
    let wrong = |i: usize, message: String, help: &str| SpecProblem::new(format!("vehicle[{i}].held"), message, help);
    let mut all = vec![];
    for (i, group) in groups.iter().enumerate().filter(|(_, group)| group.held) {
        if i > 0 && i + 1 < groups.len() {
            all.push(wrong(i, "a vehicle in the middle of the train is held".to_owned(), right));
        } else if group.count > 1 {
            let own = format!("{right}: give it a row or a [[vehicle]] of its own, without count");
            all.push(wrong(i, format!("a group of {} vehicles is held", group.count), &own));
        }
    }
    if let ([VehicleSpec { held: true, count: 1, .. }, VehicleSpec { held: true, count: 1, .. }], true) =
        (groups, all.is_empty())
    {
        let message = "both vehicles of the train are held, so nothing in it moves".to_owned();
        all.push(wrong(1, message, "hold one of them, or none"));
    }
    all
}

/// Every number and text by itself.
pub(super) fn numbers(spec: &TrainSpec) -> Vec<SpecProblem> {
    let mut all: Vec<SpecProblem> = text("name", &spec.name).into_iter().collect();
    for (i, v) in spec.vehicles.iter().enumerate() {
        let within = format_args!("vehicle[{i}]");
        all.extend(v.label.as_ref().and_then(|label| text(format_args!("{within}.label"), label)));
        all.extend(number(within, "mass", v.mass_kg, Sign::Positive));
        all.extend(v.length_m.and_then(|m| number(within, "length", m, Sign::Positive)));
        all.extend(number(within, "emergency_brake", v.emergency_brake_n, Sign::NotNegative));
        if v.held && v.emergency_brake_n > 0.0 {
            all.push(of_held(within, "emergency_brake"));
        }
    }
    for (i, c) in spec.couplers.iter().enumerate() {
        let within = format_args!("coupler[{i}]");
        all.extend(law(within, &c.law));
        all.extend(number(within, "rated_load", c.rated_draft_n, Sign::Positive));
        all.extend(number(within, "rated_buff", c.rated_buff_n, Sign::Positive));
        all.extend(number(within, "damping", c.dashpot_n_s_per_m, Sign::NotNegative));
        for (name, n) in c.limits.named() {
            all.extend(number(within, &format!("limits.{name}"), n, Sign::Positive));
        }
        let disorder = c.limits.disorder(spec.origin.units);
        all.extend(disorder.map(|[message, help]| SpecProblem::new(format!("{within}.limits"), message, help)));
    }
    match &spec.load {
        Load::None => {}
        Load::Uniform(n) => all.extend(number("load", "uniform", *n, Sign::Any)),
        Load::InCouplers(forces) | Load::OnVehicles(forces) => {
            let one = |(i, n): (usize, &f64)| number("", &format!("load[{i}]"), *n, Sign::Any);
            all.extend(forces.iter().enumerate().filter_map(one));
        }
    }
    match &spec.pulled_to {
        PulledTo::None => {}
        PulledTo::Largest(n) => all.extend(number("load", "pulled_to", *n, Sign::Positive)),
        PulledTo::InCouplers(pulled) => {
            all.extend(pulled.iter().find_map(|n| number("load", "pulled_to", *n, Sign::NotNegative)));
        }
    }
    all.extend(spec.speed_m_per_s.and_then(|v| number("", "speed", v, Sign::Positive)));
    if !(0.0..1.0).contains(&spec.damping_ratio) {
        let message = format!("damping_ratio is {}", spec.damping_ratio);
        all.push(SpecProblem::new("damping_ratio", message, "expected a number from 0 to under 1"));
    }
    all
}

/// A key that only vehicles that are not held have.
pub(crate) fn of_held(within: impl fmt::Display, key: &str) -> SpecProblem {
    let help = "a held vehicle takes whatever force it needs to keep its speed: leave the key out";
    SpecProblem::new(format!("{within}.{key}"), format!("{key} of a held vehicle"), help)
}

fn law(within: fmt::Arguments, law: &Law) -> Vec<SpecProblem> {
    let sign = |(key, value, sign)| number(within, key, value, sign);
    let own = match *law {
        Law::Elastic { draft_n_per_m, buff_n_per_m, slack_m } => {
            let linear = draft_n_per_m.to_bits() == buff_n_per_m.to_bits();
            let buff = if linear { 1.0 } else { buff_n_per_m };
            [
                ("stiffness", draft_n_per_m, Sign::Positive),
                ("stiffness_in_buff", buff, Sign::Positive),
                ("slack", slack_m, Sign::NotNegative),
            ]
        }
        Law::Gear { solid_n_per_m, slack_m, .. } => [
            ("solid_stiffness", solid_n_per_m, Sign::Positive),
            ("slack", slack_m, Sign::NotNegative),
            ("slack", 0.0, Sign::Any),
        ],
    };
    let wrong: Vec<SpecProblem> = own.into_iter().filter_map(sign).collect();
    match law.check() {
        Err(bad @ (LawProblem::NegativeBesideSlack(_) | LawProblem::Crossed { .. })) => {
            vec![SpecProblem::new(format!("{within}.gear"), bad.to_string(), bad.help())]
        }
        // Wrong numbers by themselves, found above.
        _ => wrong,
    }
}

/// Problems between keys.
pub(super) fn combinations(train: &Train, pulled_to: &PulledTo) -> Vec<SpecProblem> {
    let Extras { laws, dashpot_n_s_per_m, damping_ratio, steady, pulled_to_n, .. } = &train.extras;
    let mut all = vec![];
    if !laws.is_empty() && *damping_ratio > 0.0 {
        let help =
            "damping_ratio is for trains of linear couplers: leave it out, or slack, gears and stiffness_in_buff";
        let message = "damping_ratio in a train whose couplers are not linear";
        all.push(SpecProblem::new("damping_ratio", message, help));
    }
    if let Some(i) = dashpot_n_s_per_m.iter().position(|c| *c > 0.0) {
        let help = "damping is for trains of linear couplers: leave it out, or slack, gears and stiffness_in_buff";
        let message = format!("coupler {} has damping in a train whose couplers are not all linear", i + 1);
        all.extend((!laws.is_empty()).then(|| SpecProblem::new(format!("coupler[{i}].damping"), message, help)));
        let help = "keep one of them: damping_ratio applies to all modes, damping to each coupler";
        let beside = laws.is_empty() && *damping_ratio > 0.0;
        all.extend(beside.then(|| SpecProblem::new("damping_ratio", "damping_ratio beside dashpots", help)));
    }
    if steady.is_some() && !laws.is_empty() && train.vehicles.iter().filter(|v| v.held).count() > 1 {
        let help = "hold one end, or give the couplers' force with [load] uniform";
        let message =
            "forces on the vehicles between two held ends need linear couplers, which share them by their stiffness";
        all.push(SpecProblem::new("load", message, help));
    }
    let largest_n = train.initial_force_n.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let wrong = |message: String, help: &str| SpecProblem::new("load.pulled_to", message, help);
    let less = match pulled_to {
        PulledTo::Largest(pulled_n) => *pulled_n < largest_n,
        _ => pulled_to_n.iter().zip(&train.initial_force_n).any(|(pulled, load)| pulled < load),
    };
    if less {
        let message =
            format!("pulled_to is less than the load, {}", shown(train.origin.units, largest_n, Dimension::Force));
        all.push(wrong(message, "it is the largest pull before the event, which was then reduced to the load: it cannot be less than the load"));
    } else if matches!(pulled_to, PulledTo::Largest(_)) && steady.is_some() && largest_n <= 0.0 {
        let help = "pulled_to enlarges the load's forces in draft, and this load has none in draft";
        all.push(wrong("pulled_to of a train in which no coupler is pulled".to_owned(), help));
    }
    all
}
