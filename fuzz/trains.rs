//! Random trains that are right, as train files.

use std::fmt::{self, Write};
use std::path::Path;

use arbitrary::Arbitrary;
use trainsafe::consist;
use trainsafe::findings::Options;

use crate::checks;

/// A train and how it is analysed. `Debug` prints the train file.
#[derive(Arbitrary)]
pub struct Random {
    /// Decades over which quantities spread.
    spread: Spread,
    coupler: Coupler,
    groups: Vec<Group>,
    overrides: Vec<Override>,
    held: [bool; 2],
    load: Load,
    damping: Damping,
    scenarios: Vec<Scenario>,
    verdict_only: bool,
    all_time_bound: bool,
    map: bool,
    loose: bool,
    long: bool,
}

#[derive(Arbitrary, Clone, Copy)]
enum Spread {
    Equal,
    Near,
    Wide,
    Wild,
}

/// A number about 1.
#[derive(Arbitrary, Clone, Copy)]
struct Number {
    decade: i8,
    digits: u8,
}

#[derive(Arbitrary)]
struct Coupler {
    stiffness: Number,
    rating: Number,
    buff: Option<Number>,
    limits: [Option<Number>; 3],
}

#[derive(Arbitrary)]
struct Group {
    mass: Number,
    count: u8,
    label: u8,
    length: Option<u8>,
    traction: Option<i8>,
    brake: Option<u8>,
    grade: Option<i8>,
}

#[derive(Arbitrary)]
struct Override {
    at: u8,
    stiffness: Option<Number>,
    rating: Option<Number>,
    buff: Option<Number>,
}

#[derive(Arbitrary)]
enum Load {
    None,
    /// In % of the weakest coupler's rating.
    Share(i8),
    Exact(Number, bool),
    /// Resistance and grade; the vehicles' own forces count only here.
    Forces(u8, i8),
}

#[derive(Arbitrary)]
enum Damping {
    None,
    Ratio(u8),
    Dashpots(Number),
}

#[derive(Arbitrary)]
struct Scenario {
    event: Event,
    horizon: Option<Number>,
    cascade: Option<bool>,
}

#[derive(Arbitrary)]
enum Event {
    Break(u8),
    Several(u8, u8),
    Each,
    Pulse { at: u8, share: i16, duration: Number, shape: u8 },
    Impact { head: bool, vehicles: u8, speed: Number },
}

const LABELS: [&str; 8] = [
    "car",
    "locomotive",
    "=cmd()|'/c calc'!A1",
    "<script>alert(1)</script>",
    "../../x",
    "[a](b) | *c*",
    "עגלה",
    "木 ‰",
];
const SHAPES: [&str; 4] = ["rectangle", "half-sine", "triangle", "trapezoid"];

impl Spread {
    /// About 1, within the decades of the spread.
    fn of(self, number: Number) -> f64 {
        let decades = match self {
            Spread::Equal => return 1.0,
            Spread::Near => 1.0,
            Spread::Wide => 4.0,
            Spread::Wild => 12.0,
        };
        (1.0 + f64::from(number.digits) / 255.0) * 10f64.powf(f64::from(number.decade) / 128.0 * decades)
    }
}

/// About 1, over eight decades.
fn factor(number: Number) -> f64 {
    Spread::Wide.of(number)
}

impl Random {
    /// Analyses the train.
    pub fn check(&self) {
        let text = self.text();
        let train = consist::parse(&text, Path::new("random.toml")).unwrap_or_else(|e| panic!("{e}\n{text}"));
        let options = Options {
            verdict_only: self.verdict_only,
            all_time_bound: self.all_time_bound,
            map: self.map,
            tolerance: if self.loose { 1e-4 } else { 1e-9 },
            ..Options::default()
        };
        checks::analysis(&train, &options, if self.long { 0.3 } else { 0.05 });
    }

    /// Vehicles alike; the first and the last stand alone, so that they can be held, and are not the only ones.
    fn groups(&self) -> Vec<(usize, Option<&Group>)> {
        let most = if self.long { 40 } else { 9 };
        let inner = self.groups.iter().take(6).map(|g| (1 + usize::from(g.count) % most, Some(g)));
        std::iter::once((1, None)).chain(inner).chain([(1, None), (1, None)]).collect()
    }

    /// The train file.
    pub fn text(&self) -> String {
        let mut out = String::new();
        self.write(&mut out).expect("a string takes everything");
        out
    }

    fn write(&self, out: &mut String) -> fmt::Result {
        let (mass, stiffness, rating) =
            (1e5, 3e7 * self.spread.of(self.coupler.stiffness), 1e6 * factor(self.coupler.rating));
        let steps_only = matches!(self.damping, Damping::Ratio(_));
        if let Damping::Ratio(r) = self.damping {
            writeln!(out, "damping_ratio = {}", f64::from(r) / 256.0)?;
        }
        writeln!(out, "[coupler]\nstiffness = \"{stiffness:e} N/m\"\nrated_load = \"{rating:e} N\"")?;
        if let Some(buff) = self.coupler.buff {
            writeln!(out, "rated_buff = \"{:e} %\"", 100.0 * factor(buff))?;
        }
        if let Damping::Dashpots(d) = self.damping {
            writeln!(out, "damping = \"{:e} N*s/m\"", (stiffness * mass).sqrt() * factor(d) * 0.1)?;
        }
        if self.coupler.limits.iter().any(Option::is_some) {
            let mut rising: Vec<f64> = self.coupler.limits.into_iter().flatten().map(|l| rating * factor(l)).collect();
            rising.sort_by(f64::total_cmp);
            let given = ["fatigue", "proof", "ultimate"].into_iter().zip(self.coupler.limits);
            let given = given.filter_map(|(name, l)| l.map(|_| name)).zip(rising);
            let given = given.map(|(name, n)| format!("{name} = \"{n:e} N\""));
            writeln!(out, "limits = {{ {} }}", given.collect::<Vec<_>>().join(", "))?;
        }
        let groups = self.groups();
        let couplers = groups.iter().map(|g| g.0).sum::<usize>() - 1;
        let last = groups.len() - 1;
        for (i, (count, group)) in groups.iter().enumerate() {
            let held = (i == 0 && self.held[0]) || (i == last && self.held[1]);
            writeln!(out, "[[vehicle]]\ncount = {count}")?;
            match group {
                Some(g) => {
                    writeln!(out, "mass = \"{:e} kg\"", mass * self.spread.of(g.mass))?;
                    writeln!(out, "label = \"{}\"", LABELS[usize::from(g.label) % LABELS.len()])?;
                    if let Some(length) = g.length {
                        writeln!(out, "length = \"{} m\"", 1 + u16::from(length))?;
                    }
                    if matches!(self.load, Load::Forces(..)) {
                        g.traction.map_or(Ok(()), |x| {
                            writeln!(out, "tractive_effort = \"{:e} N\"", rating * f64::from(x) / 50.0)
                        })?;
                        g.brake.map_or(Ok(()), |x| {
                            writeln!(out, "brake_force = \"{:e} N\"", rating * f64::from(x) / 900.0)
                        })?;
                        g.grade.map_or(Ok(()), |x| writeln!(out, "grade = \"{} %\"", f64::from(x) / 40.0))?;
                    }
                }
                None => writeln!(out, "mass = \"{mass:e} kg\"")?,
            }
            if held {
                writeln!(out, "held = true")?;
            }
        }
        self.write_overrides(out, couplers, stiffness)?;
        match &self.load {
            Load::None => {}
            Load::Share(percent) => writeln!(out, "[load]\nuniform = \"{percent} %\"")?,
            Load::Exact(x, buff) => writeln!(
                out,
                "[load]\nuniform = \"{}{:e} N\"",
                if *buff { "-" } else { "" },
                rating * self.spread.of(*x)
            )?,
            Load::Forces(resistance, grade) => {
                writeln!(
                    out,
                    "[load]\nrolling_resistance = \"{resistance} N/t\"\ngrade = \"{} %\"",
                    f64::from(*grade) / 40.0
                )?;
            }
        }
        let unit_s = (mass / stiffness).sqrt();
        for scenario in self.scenarios.iter().take(3) {
            self.write_scenario(out, scenario, couplers, unit_s, rating / (mass * stiffness).sqrt(), steps_only)?;
        }
        Ok(())
    }

    fn write_overrides(&self, out: &mut String, couplers: usize, stiffness: f64) -> fmt::Result {
        let mut seen = Vec::new();
        for o in self.overrides.iter().take(4) {
            let at = 1 + usize::from(o.at) % couplers;
            if seen.contains(&at) || (o.stiffness.is_none() && o.rating.is_none() && o.buff.is_none()) {
                continue;
            }
            seen.push(at);
            writeln!(out, "[[coupler_override]]\nat = {at}")?;
            o.stiffness.map_or(Ok(()), |x| writeln!(out, "stiffness = \"{:e} N/m\"", stiffness * self.spread.of(x)))?;
            o.rating.map_or(Ok(()), |x| writeln!(out, "rated_load = \"{:e} %\"", 100.0 * factor(x)))?;
            o.buff.map_or(Ok(()), |x| writeln!(out, "rated_buff = \"{:e} %\"", 100.0 * factor(x)))?;
        }
        Ok(())
    }

    fn write_scenario(
        &self,
        out: &mut String,
        s: &Scenario,
        couplers: usize,
        unit_s: f64,
        unit_speed: f64,
        steps_only: bool,
    ) -> fmt::Result {
        let vehicles = couplers + 1;
        writeln!(out, "[[scenario]]")?;
        match &s.event {
            Event::Each => writeln!(out, "kind = \"break\"\ncoupler = \"each\"")?,
            Event::Break(b) => writeln!(out, "kind = \"break\"\ncoupler = {}", 1 + usize::from(*b) % couplers)?,
            Event::Several(a, b) => {
                let (a, b) = (1 + usize::from(*a) % couplers, 1 + usize::from(*b) % couplers);
                let list = if a == b { format!("[{a}]") } else { format!("[{a}, {b}]") };
                writeln!(out, "kind = \"break\"\ncoupler = {list}")?;
            }
            Event::Impact { head, vehicles: arriving, speed } if !steps_only => {
                let end = if *head { "head" } else { "tail" };
                let (arriving, speed) = (1 + usize::from(*arriving) % couplers, unit_speed * factor(*speed));
                writeln!(out, "kind = \"impact\"\nat = \"{end}\"\nvehicles = {arriving}\nspeed = \"{speed:e} m/s\"")?;
            }
            Event::Impact { .. } => writeln!(out, "kind = \"break\"\ncoupler = 1")?,
            Event::Pulse { at, share, duration, shape } => {
                let free: Vec<usize> =
                    (1..=vehicles).filter(|&v| !(v == 1 && self.held[0] || v == vehicles && self.held[1])).collect();
                let (at, share) = (free[usize::from(*at) % free.len()], if *share == 0 { 1 } else { *share });
                let duration = unit_s * factor(*duration);
                let shape = SHAPES[if steps_only { 0 } else { usize::from(*shape) % SHAPES.len() }];
                writeln!(
                    out,
                    "kind = \"pulse\"\nat = {at}\nforce = \"{share} %\"\nduration = \"{duration:e} s\"\nshape = \"{shape}\""
                )?;
                if shape == "trapezoid" {
                    writeln!(out, "rise = \"{:e} s\"", 0.25 * duration)?;
                }
            }
        }
        if let Some(horizon) = s.horizon {
            writeln!(out, "horizon = \"{:e} s\"", unit_s * factor(horizon))?;
        }
        match s.cascade.filter(|_| !steps_only) {
            Some(in_buff) => writeln!(out, "cascade = true\nbuff_breaks = {in_buff}"),
            None => Ok(()),
        }
    }
}

impl fmt::Debug for Random {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(
            f,
            "# verdict_only {}, all_time_bound {}, map {}, loose {}\n{}",
            self.verdict_only,
            self.all_time_bound,
            self.map,
            self.loose,
            self.text()
        )
    }
}
