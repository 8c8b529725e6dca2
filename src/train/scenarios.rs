//! The scenarios of a train: their names, and what has to hold of each.

use std::collections::HashMap;

use super::checks::{number, text};
use super::{Application, Event, Forcing, Pulse, PulseShape, Response, Rule, Scenario, SpecProblem, Train};
use crate::error::quoted;
use crate::keys::Sign;

/// More breaks than this, over all scenarios, are refused.
pub(crate) const MOST_CASES: usize = 1_000_000;

/// More scenarios than this are refused: each has figures of its own.
pub(crate) const MOST_SCENARIOS: usize = 1000;

impl Train {
    /// Takes scenarios, or each coupler in turn if there are none, and says what is wrong with them.
    pub(crate) fn set_scenarios(&mut self, scenarios: Vec<Scenario>) -> Vec<SpecProblem> {
        let mut problems = vec![];
        self.scenarios = if scenarios.is_empty() { vec![self.each_in_turn()] } else { scenarios };
        if self.scenarios.len() > MOST_SCENARIOS {
            let message = format!("the train has more than {MOST_SCENARIOS} scenarios");
            let help = format!("it has at most {MOST_SCENARIOS}; a list of couplers breaks each in turn");
            return vec![SpecProblem::new(format!("scenario[{MOST_SCENARIOS}]"), message, help)];
        }
        problems.extend(self.name_scenarios());
        let mut cases = 0usize;
        for (i, scenario) in self.scenarios.iter().enumerate() {
            let within = format!("scenario[{i}]");
            let before = cases;
            cases = cases.saturating_add(match &scenario.event {
                Event::Break { couplers } => couplers.len(),
                _ => 0,
            });
            if before <= MOST_CASES && cases > MOST_CASES {
                let message = format!("the scenarios have more than {MOST_CASES} breaks up to here");
                problems.push(SpecProblem::new(within, message, "a train has at most that many"));
                continue;
            }
            problems.extend(Check { train: self, scenario, within }.all());
        }
        problems
    }

    /// Every coupler in turn, and those that are left out because they carry buff.
    pub(crate) fn each(&self, buff_breaks: bool) -> (Event, Vec<usize>) {
        let (left_out, couplers) = (0..self.couplers.len()).partition(|&i| !buff_breaks && self.in_buff(i));
        (Event::Break { couplers }, left_out)
    }

    /// Whether a coupler carries buff, so that its vehicles stay pressed together when it breaks, and that is not computed. In a train
    /// with slack or gears it is.
    pub(crate) fn in_buff(&self, coupler: usize) -> bool {
        self.extras.laws.is_empty() && self.initial_force_n[coupler] < 0.0
    }

    fn each_in_turn(&self) -> Scenario {
        let (event, left_out_in_buff) = self.each(false);
        let (name, response) = (String::new(), Response::default());
        Scenario { name, event, horizon_s: None, cascade: Rule::Keep, left_out_in_buff, response }
    }

    /// Gives names to scenarios without one, and tells those that are given twice.
    fn name_scenarios(&mut self) -> Vec<SpecProblem> {
        let vehicles = self.vehicles.len();
        let mut taken: HashMap<String, usize> = HashMap::new();
        let mut problems = vec![];
        for (i, scenario) in self.scenarios.iter().enumerate().filter(|(_, s)| !s.name.is_empty()) {
            if let Some(earlier) = taken.insert(scenario.name.clone(), i) {
                let message = format!("two scenarios are named {}", quoted(&scenario.name));
                let help = "give each scenario a name of its own";
                problems.push(SpecProblem {
                    related: Some((format!("scenario[{earlier}].name"), "named here before")),
                    ..SpecProblem::new(format!("scenario[{i}].name"), message, help)
                });
            }
        }
        for (i, scenario) in self.scenarios.iter_mut().enumerate().filter(|(_, s)| s.name.is_empty()) {
            let plain = default_name(&scenario.event, &scenario.left_out_in_buff, vehicles);
            let again = (2..).map(|n| format!("{plain} ({n})"));
            let mut candidates = std::iter::once(plain.clone()).chain(again);
            scenario.name = candidates.find(|name| !taken.contains_key(name)).unwrap_or(plain);
            taken.insert(scenario.name.clone(), i);
        }
        problems
    }
}

/// What the breaks of every coupler are called.
const EACH: &str = "each coupler breaks in turn";

/// What a scenario is called that has no name.
fn default_name(event: &Event, left_out: &[usize], vehicles: usize) -> String {
    match event {
        Event::Break { .. } if !left_out.is_empty() => EACH.to_owned(),
        Event::Break { couplers } => match couplers.as_slice() {
            [one] => format!("break of coupler {}", one + 1),
            all if all.len() + 1 == vehicles => EACH.to_owned(),
            [some @ .., last] if some.len() < 6 => {
                let some: Vec<String> = some.iter().map(|c| (c + 1).to_string()).collect();
                format!("break of couplers {} and {} in turn", some.join(", "), last + 1)
            }
            many => format!("break of {} couplers in turn", many.len()),
        },
        Event::Pulse(pulse) => match pulse.vehicle + 1 {
            1 => "pulse at the head".to_owned(),
            last if last == vehicles => "pulse at the tail".to_owned(),
            number => format!("pulse at vehicle {number}"),
        },
        Event::Impact { at_head, .. } => format!("impact at the {}", if *at_head { "head" } else { "tail" }),
        Event::Brake { from, emergency, .. } => {
            let what = if *emergency { "emergency brakes" } else { "service brakes" };
            match from.as_slice() {
                [0] => format!("{what} from the head"),
                [v] if v + 1 == vehicles => format!("{what} from the tail"),
                [v] => format!("{what} from vehicle {}", v + 1),
                _ => format!("{what} from both ends"),
            }
        }
    }
}

/// A scenario that is looked at.
struct Check<'t> {
    train: &'t Train,
    scenario: &'t Scenario,
    within: String,
}

impl Check<'_> {
    fn wrong(&self, key: &str, message: impl Into<String>, help: impl Into<String>) -> SpecProblem {
        SpecProblem::new(format!("{}.{key}", self.within), message, help)
    }

    fn number(&self, key: &str, value: f64, sign: Sign) -> Option<SpecProblem> {
        number(&self.within, key, value, sign)
    }

    fn all(&self) -> Vec<SpecProblem> {
        let Scenario { name, event, horizon_s, cascade, left_out_in_buff, response } = self.scenario;
        let mut all: Vec<SpecProblem> = text(format!("{}.name", self.within), name).into_iter().collect();
        all.extend(horizon_s.and_then(|s| self.number("horizon", s, Sign::Positive)));
        all.extend(self.couplers(left_out_in_buff));
        all.extend(self.event(event));
        all.extend(self.response(response, event));
        if self.train.extras.damping_ratio > 0.0 && (*cascade != Rule::Keep || event.beyond_steps()) {
            let message = "damping_ratio is for breaks and rectangular pulses without a cascade";
            let help = "give [coupler] a damping = \"200 kN*s/m\" instead, for scenario";
            all.push(SpecProblem::new("damping_ratio", message, format!("{help} {}", quoted(name))));
        }
        all
    }

    fn event(&self, event: &Event) -> Vec<SpecProblem> {
        match event {
            Event::Break { couplers } => {
                let left_out = !self.scenario.left_out_in_buff.is_empty();
                let right = format!("expected a coupler's number from 1 to {}", self.train.couplers.len());
                let empty = couplers.is_empty() && !left_out;
                let empty = empty.then(|| self.wrong("coupler", "the list of couplers is empty", right));
                empty.into_iter().chain(self.couplers(couplers)).collect()
            }
            Event::Pulse(Pulse { vehicle, force_n, duration_s, shape }) => {
                let of_shape = match shape {
                    PulseShape::Trapezoid { rise_s, fall_s } => {
                        vec![("rise", *rise_s, Sign::NotNegative), ("fall", *fall_s, Sign::NotNegative)]
                    }
                    _ => vec![],
                };
                let numbers = [("force", *force_n, Sign::NonZero), ("duration", *duration_s, Sign::Positive)];
                let numbers = numbers.into_iter().chain(of_shape);
                let numbers = numbers.filter_map(|(key, value, sign)| self.number(key, value, sign));
                let mut all: Vec<SpecProblem> = self.struck(*vehicle).into_iter().chain(numbers).collect();
                if all.is_empty() {
                    all.extend(self.course(shape, *duration_s));
                }
                all
            }
            Event::Impact { vehicles, speed_m_per_s, .. } => {
                let most = self.train.couplers.len();
                let right = format!("expected a whole number from 1 to {most}: at least one vehicle stands");
                let many = !(1..=most).contains(vehicles);
                let many = many.then(|| self.wrong("vehicles", format!("vehicles is {vehicles}"), right));
                many.into_iter().chain(self.number("speed", *speed_m_per_s, Sign::Positive)).collect()
            }
            Event::Brake { from, emergency, application } => {
                let key = if *emergency { "emergency" } else { "service" };
                let mut all: Vec<SpecProblem> = from.iter().filter_map(|v| self.vehicle(*v)).take(1).collect();
                if from.is_empty() {
                    all.push(self.wrong("at", "the brake application starts nowhere", "expected a vehicle"));
                }
                all.extend(self.braked(key, application));
                all
            }
        }
    }

    fn response(&self, response: &Response, event: &Event) -> Vec<SpecProblem> {
        let Response { emergency, efforts } = response;
        let kind = event.kind();
        let mut all: Vec<SpecProblem> = emergency.iter().flat_map(|a| self.braked("emergency", a)).collect();
        if emergency.is_some() && kind != "break" {
            let help = "it is what a parting sets off";
            all.push(self.wrong("emergency", "the response of a scenario without a break has brakes", help));
        }
        if !efforts.is_empty() {
            if !["break", "brake"].contains(&kind) {
                let help = "they change after breaks and brake applications";
                all.push(self.wrong("throttle", format!("tractive efforts change in a scenario of kind {kind}"), help));
            }
            all.extend(efforts.iter().find_map(|forcing| self.forcing(forcing)));
            all.extend(self.undamped("throttle"));
        }
        all
    }

    fn forcing(&self, forcing: &Forcing) -> Option<SpecProblem> {
        let held = self.train.vehicles.get(forcing.vehicle).is_some_and(|v| v.held);
        let held =
            held.then(|| self.wrong("throttle", "a tractive effort of a held vehicle", "choose another vehicle"));
        self.vehicle(forcing.vehicle).or(held).or_else(|| self.points("throttle", &forcing.points))
    }

    /// What is wrong with the course of a pulse whose numbers are right.
    fn course(&self, shape: &PulseShape, duration_s: f64) -> Option<SpecProblem> {
        match shape {
            PulseShape::Record(points) => self.points("record", points),
            // Times written in decimals whose sum is the duration can be a few roundings longer as doubles.
            PulseShape::Trapezoid { rise_s, fall_s } if rise_s + fall_s > duration_s * (1.0 + 8.0 * f64::EPSILON) => {
                let help = "together they may be as long as the duration, not longer";
                Some(self.wrong("rise", "rise and fall are longer than the pulse", help))
            }
            _ => None,
        }
    }

    /// Points of a time, s, and a force, N: the times never fall.
    fn points(&self, key: &str, points: &[[f64; 2]]) -> Option<SpecProblem> {
        let number = |p: &[f64; 2]| self.number(key, p[0], Sign::NotNegative).or(self.number(key, p[1], Sign::Any));
        let falls = points.windows(2).any(|pair| pair[1][0] < pair[0][0]);
        let falls =
            falls.then(|| self.wrong(key, format!("the times of {key} fall"), "no time is less than the one before"));
        points.iter().find_map(number).or(falls)
    }

    /// Couplers that the train has, each once.
    fn couplers(&self, couplers: &[usize]) -> Option<SpecProblem> {
        let right = format!("expected a coupler's number from 1 to {}", self.train.couplers.len());
        let unknown = couplers.iter().find(|i| **i >= self.train.couplers.len());
        if let Some(i) = unknown {
            return Some(self.wrong("coupler", format!("the train has no coupler {}", i.saturating_add(1)), right));
        }
        let mut listed = vec![false; self.train.couplers.len()];
        let twice = couplers.iter().find(|i| std::mem::replace(&mut listed[**i], true));
        twice.map(|i| self.wrong("coupler", format!("coupler {} is listed twice", i + 1), "list it once"))
    }

    fn vehicle(&self, vehicle: usize) -> Option<SpecProblem> {
        let count = self.train.vehicles.len();
        let message = format!("the train has no vehicle {}", vehicle.saturating_add(1));
        let right = format!("expected a vehicle's number from 1 to {count}");
        (vehicle >= count).then(|| self.wrong("at", message, right))
    }

    fn struck(&self, vehicle: usize) -> Option<SpecProblem> {
        let held = self.train.vehicles.get(vehicle).is_some_and(|v| v.held);
        let message = "the pulse acts on a held vehicle, which no force can move";
        let held = held.then(|| self.wrong("at", message, "choose a vehicle that is not held"));
        self.vehicle(vehicle).or(held)
    }

    /// What is wrong with a brake application, and what it needs that the train does not have.
    fn braked(&self, key: &str, application: &Application) -> Vec<SpecProblem> {
        let mut all: Vec<SpecProblem> =
            self.number(&format!("{key}.wave"), application.wave_m_per_s, Sign::Positive).into_iter().collect();
        let rows = application.disorder();
        all.extend(rows.map(|[message, help]| self.wrong(&format!("{key}.build_up"), message, help)));
        let Train { vehicles, extras, .. } = self.train;
        if let Some(v) = vehicles.iter().find(|v| v.length_m.is_none()) {
            let message = format!("{key} needs the length of every vehicle, and {} has none", quoted(&v.label));
            let help = "add length = \"17.6 m\" to it: an application takes its time along the train";
            all.push(self.wrong(key, message, help));
        } else if extras.emergency_brake_n.is_empty() {
            let message = format!("{key} in a train in which no vehicle has an emergency_brake");
            let help = "add emergency_brake = \"45 kN\", the full brake force, to the vehicles";
            all.push(self.wrong(key, message, help));
        } else if extras.speed_m_per_s.is_none() {
            let help = "add speed = \"50 km/h\" at the top of the file: brakes act as long as a vehicle runs";
            all.push(self.wrong(key, format!("{key} needs the train's speed"), help));
        } else {
            all.extend(self.undamped(key));
        }
        all
    }

    /// A damping ratio, with which forces that change over time on several vehicles are not computed.
    fn undamped(&self, key: &str) -> Option<SpecProblem> {
        let help = "give [coupler] a damping = \"200 kN*s/m\" in its place, or a gear with friction";
        let damped = self.train.extras.damping_ratio > 0.0;
        damped.then(|| self.wrong(key, format!("{key} in a train with a damping_ratio"), help))
    }
}
