//! Train files drawn at random, of all kinds of scenario, each with the system that the reference plays for it.

use std::fmt::Write as _;

use super::draw::Random;
use trainsafe::accuracy::reference::Real;
use trainsafe::accuracy::reference::march::{Course, March, System, long};

/// A kind of scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    Break,
    Rectangle,
    HalfSine,
    Triangle,
    Trapezoid,
    Record,
    Impact,
    ImpactOnLoad,
    MovingRake,
    Dashpots,
    Ratio,
    Cascade,
    CascadeInBuff,
}

impl Kind {
    /// All of them, in the order of the table.
    pub const ALL: [Kind; 13] = [
        Kind::Break,
        Kind::Rectangle,
        Kind::HalfSine,
        Kind::Triangle,
        Kind::Trapezoid,
        Kind::Record,
        Kind::Impact,
        Kind::ImpactOnLoad,
        Kind::MovingRake,
        Kind::Dashpots,
        Kind::Ratio,
        Kind::Cascade,
        Kind::CascadeInBuff,
    ];

    /// In the table.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Break => "break",
            Kind::Rectangle => "rectangle",
            Kind::HalfSine => "half-sine",
            Kind::Triangle => "triangle",
            Kind::Trapezoid => "trapezoid",
            Kind::Record => "record",
            Kind::Impact => "impact",
            Kind::ImpactOnLoad => "impact on load",
            Kind::MovingRake => "rakes under power",
            Kind::Dashpots => "dashpots",
            Kind::Ratio => "damping ratio",
            Kind::Cascade => "cascade",
            Kind::CascadeInBuff => "cascade, buff",
        }
    }

    /// Whether couplers break on the way.
    pub fn cascades(self) -> bool {
        matches!(self, Kind::Cascade | Kind::CascadeInBuff)
    }
}

/// The event, as it is drawn.
#[derive(Clone, Debug)]
pub enum DrawnEvent {
    /// The coupler that breaks, from 0.
    Break(usize),
    /// Shape, vehicle from 0, force, duration, rise and fall.
    Pulse(&'static str, usize, f64, f64, [f64; 2]),
    /// Vehicle from 0, and rows of time and force.
    Record(usize, Vec<[f64; 2]>),
    /// How many vehicles, whether at the head, and their speed.
    Impact(usize, bool, f64),
}

/// A train before its ratings are drawn.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// Of which kind.
    pub kind: Kind,
    /// The event.
    pub event: DrawnEvent,
    /// What the reference plays.
    pub system: System,
    /// The same force in every coupler before the event, N.
    pub uniform: f64,
    /// Tractive efforts and, negative, brake forces before the event, N; empty for a uniform load.
    pub traction: Vec<f64>,
    /// Grade under each vehicle, percent, uphill positive; as many as `traction`.
    pub grade: Vec<f64>,
    /// The train's grade, percent: vehicles on another one have a grade of their own.
    pub train_grade: f64,
    random: Random,
}

/// Ratings of each coupler in draft and in buff, and its limits: fatigue, proof and ultimate of either sense.
#[derive(Clone, Debug, Default)]
pub struct Rated {
    /// N
    pub rating: Vec<[f64; 2]>,
    /// N
    pub limits: Vec<Option<[[f64; 3]; 2]>>,
}

/// A train with more vehicles than this is a long one.
const LONG: usize = 9;

/// The force along the train that a grade takes from each kilogram, N: `g s / sqrt(1 + s^2)`.
fn downhill(percent: f64) -> Real {
    let slope = long(percent) / long(100.0);
    long(9.806_65) * &slope / (&slope * &slope + long(1.0)).sqrt()
}

/// A number whose decimal form is short enough to read, and is the number.
fn short(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x)
}

/// The train of a seed.
pub fn draw(seed: u64) -> Drawn {
    let mut r = Random(seed ^ 0x5eed);
    let kind = Kind::ALL[(seed % Kind::ALL.len() as u64) as usize];
    let n = 2 + vehicles(&mut r, kind);
    let decades = r.between(0.0, 3.0);
    let spread = r.one_of(4);
    let vary = |r: &mut Random| match spread {
        0 => 1.0,
        1 | 2 => 4f64.powf(r.between(-0.5, 0.5)),
        _ => 10f64.powf(decades * r.between(-0.5, 0.5)),
    };
    let mass: Vec<f64> = (0..n).map(|_| short(9e4 * vary(&mut r))).collect();
    let stiffness: Vec<f64> = (0..n - 1).map(|_| short(3e7 * vary(&mut r))).collect();
    let held = if kind == Kind::MovingRake || n < 3 { [false; 2] } else { [r.chance(0.3), r.chance(0.15)] };
    let held = if matches!(kind, Kind::Impact | Kind::ImpactOnLoad) { [false, false] } else { held };
    let transit: f64 = (0..n - 1).map(|i| (mass[i] / stiffness[i]).sqrt()).sum();
    let fastest = stiffness.iter().fold(0.0f64, |a, k| a.max(*k)) / mass.iter().fold(f64::INFINITY, |a, m| a.min(*m));
    let phases = if n > LONG { 40.0 } else { 150.0 };
    let horizon = short((transit * r.between(1.0, 4.0)).min(phases / fastest.sqrt()));
    let with_load = !matches!(kind, Kind::Impact | Kind::MovingRake) && (kind == Kind::Break || r.chance(0.6));
    let uniform = if with_load { short(r.sign() * r.between(1e5, 1e6)) } else { 0.0 };
    let uniform = if kind == Kind::Break || kind.cascades() { uniform.abs() } else { uniform };
    let by_vehicle = kind == Kind::MovingRake || with_load && held == [false; 2] && r.chance(0.3);
    let traction = if by_vehicle { (0..n).map(|_| short(r.sign() * r.between(1e4, 4e5))).collect() } else { vec![] };
    let (train_grade, grade) = grades(&mut r, traction.len());
    let ratio = if kind == Kind::Ratio { short(r.between(0.01, 0.4)) } else { 0.0 };
    let mut drawn = Drawn {
        kind,
        event: DrawnEvent::Break(0),
        system: System { mass, held, stiffness, horizon, ratio, ..System::default() },
        uniform: if by_vehicle { 0.0 } else { uniform },
        traction,
        grade,
        train_grade,
        random: r,
    };
    drawn.event = event(&mut drawn, transit);
    let dashpots = kind == Kind::Dashpots || kind.cascades() && drawn.random.chance(0.3);
    let (k, m, r) = (&drawn.system.stiffness, &drawn.system.mass, &mut drawn.random);
    let dashpot =
        (0..n - 1).map(|i| if dashpots { short(2.0 * r.between(0.0, 0.3) * (k[i] * m[i]).sqrt()) } else { 0.0 });
    drawn.system.dashpot = dashpot.collect();
    drawn.set_in_motion();
    if matches!(drawn.event, DrawnEvent::Break(b) if drawn.system.initial[b] < long(0.0)) {
        // A coupler that carries buff does not part: the same forces the other way round.
        drawn.traction.iter_mut().chain(&mut drawn.grade).for_each(|x| *x = -*x);
        drawn.train_grade = -drawn.train_grade;
        drawn.set_in_motion();
    }
    drawn
}

/// Vehicles beyond the first two: few, for the reference is slow; now and then a longer train.
fn vehicles(r: &mut Random, kind: Kind) -> usize {
    match r.chance(0.03) {
        // A damping ratio costs the reference the cube of the vehicles.
        true => LONG + r.one_of(if kind == Kind::Ratio { 6 } else { 20 }),
        false => r.one_of(7) + usize::from(kind == Kind::MovingRake || kind.cascades()),
    }
}

/// The train's grade and that under each vehicle, percent: half of the trains are on the level, and of the others some vehicles
/// are on a grade of their own.
fn grades(r: &mut Random, vehicles: usize) -> (f64, Vec<f64>) {
    let grade = |r: &mut Random| short(r.sign() * r.between(0.05, 3.0));
    let train = if vehicles > 0 && r.chance(0.5) { grade(r) } else { 0.0 };
    (train, (0..vehicles).map(|_| if train != 0.0 && r.chance(0.4) { grade(r) } else { train }).collect())
}

fn event(drawn: &mut Drawn, transit: f64) -> DrawnEvent {
    let (system, r) = (&drawn.system, &mut drawn.random);
    let (n, pulls) = (system.mass.len(), drawn.uniform > 0.0 || !drawn.traction.is_empty());
    let live: Vec<usize> = (0..n).filter(|&v| !(v == 0 && system.held[0] || v + 1 == n && system.held[1])).collect();
    let at = live[r.one_of(live.len())];
    let force = short(r.sign() * r.between(2e5, 2e6));
    let duration = short(transit * 10f64.powf(r.between(-1.5, 0.7)));
    match drawn.kind {
        Kind::Break => DrawnEvent::Break(r.one_of(n - 1)),
        Kind::Impact | Kind::ImpactOnLoad | Kind::MovingRake => {
            DrawnEvent::Impact(1 + r.one_of(n - 1), r.chance(0.5), short(r.between(0.2, 4.0)))
        }
        Kind::Dashpots if r.chance(0.3) => {
            DrawnEvent::Impact(1 + r.one_of(n - 1), r.chance(0.5), short(r.between(0.2, 4.0)))
        }
        Kind::Ratio if pulls && r.chance(0.5) => DrawnEvent::Break(r.one_of(n - 1)),
        Kind::Dashpots | Kind::Cascade | Kind::CascadeInBuff if pulls && r.chance(0.4) => {
            DrawnEvent::Break(r.one_of(n - 1))
        }
        Kind::Record => {
            let (mut t, mut rows) = (0.0, vec![[0.0, short(force * r.share())]]);
            for _ in 0..1 + r.one_of(6) {
                t = short(t + duration * r.between(0.05, 0.6));
                rows.push([t, short(r.sign() * force * r.share())]);
            }
            DrawnEvent::Record(at, rows)
        }
        kind => {
            let shapes = ["rectangle", "half-sine", "triangle", "trapezoid"];
            let own =
                [Kind::Rectangle, Kind::HalfSine, Kind::Triangle, Kind::Trapezoid].iter().position(|k| *k == kind);
            let shape = own.unwrap_or_else(|| if kind == Kind::Ratio { 0 } else { r.one_of(4) });
            let rise = short(duration * r.between(0.05, 0.6));
            DrawnEvent::Pulse(
                shapes[shape],
                at,
                force,
                duration,
                [rise, short((duration - rise) * r.between(0.1, 0.9))],
            )
        }
    }
}

impl Drawn {
    /// Whether forces go on acting that the coupled train is not in balance with.
    pub fn is_unbalanced(&self) -> bool {
        matches!(self.event, DrawnEvent::Impact(..)) && !self.traction.is_empty()
    }

    /// Magnitudes of the forces on the vehicles before the event, N.
    pub fn magnitude_n(&self) -> f64 {
        let of = |((p, percent), m): ((&f64, &f64), &f64)| p.abs() + 0.098_066_5 * percent.abs() * m;
        self.traction.iter().zip(&self.grade).zip(&self.system.mass).map(of).sum()
    }

    /// Forces before the event, speeds and the force over time, from the event.
    fn set_in_motion(&mut self) {
        let n = self.system.mass.len();
        let system = &mut self.system;
        system.velocity = vec![0.0; n];
        let push = |((p, percent), m): ((&f64, &f64), &f64)| long(*p) - long(*m) * downhill(*percent);
        system.outside = self.traction.iter().zip(&self.grade).zip(&system.mass).map(push).collect();
        let mut joint = n;
        let mut carry = vec![self.uniform; n - 1];
        match &self.event {
            DrawnEvent::Break(b) => system.broken = Some(*b),
            DrawnEvent::Pulse(shape, at, force, duration, ramps) => {
                (system.source, system.drive) = (*at, courses(shape, *force, *duration, *ramps));
            }
            DrawnEvent::Record(at, rows) => {
                system.source = *at;
                system.drive = rows.windows(2).map(|w| Course::Line(w[0], w[1])).collect();
            }
            DrawnEvent::Impact(count, at_head, speed) => {
                joint = if *at_head { *count } else { n - count };
                carry[joint - 1] = 0.0;
                let moves = |v: usize| (v < joint) == *at_head;
                let signed = if *at_head { -speed } else { *speed };
                system.velocity = (0..n).map(|v| if moves(v) { signed } else { 0.0 }).collect();
            }
        }
        system.initial = carry.iter().map(|f| long(*f)).collect();
        let zero = long(0.0);
        if system.outside.is_empty() {
            // What keeps each vehicle where it is: F_{v-1} - F_v + p_v = 0.
            let force = |i: Option<usize>| i.and_then(|i| system.initial.get(i)).unwrap_or(&zero).clone();
            system.outside = (0..n).map(|v| force(Some(v)) - force(v.checked_sub(1))).collect();
            return;
        }
        // F_v = F_{v-1} + p_v - m_v a, with one acceleration in each part.
        for part in [0..joint, joint..n].into_iter().filter(|part| !part.is_empty()) {
            let sum = |of: &dyn Fn(usize) -> Real| part.clone().fold(zero.clone(), |s, v| s + of(v));
            let a = sum(&|v| system.outside[v].clone()) / sum(&|v| long(system.mass[v]));
            let mut force = zero.clone();
            for v in part.start..part.end - 1 {
                force = force + &system.outside[v] - long(system.mass[v]) * &a;
                system.initial[v] = force.clone();
            }
        }
    }

    /// Ratings on both sides of the peaks, far, near, and as near as makes the verdict a hard one.
    pub fn rated(&mut self, march: &March) -> Rated {
        let mut rated = Rated::default();
        let r = &mut self.random;
        let (with_limits, breaks_often) = (r.chance(0.4), self.kind.cascades() && r.chance(0.6));
        for i in 0..self.system.stiffness.len() {
            let initial = self.system.initial[i].to_f64().value();
            let mut rating = [0, 1].map(|side| {
                let peak = march.largest(i, side, self.system.horizon).1.to_f64().value();
                if breaks_often && (side == 0 || self.kind == Kind::CascadeInBuff) {
                    // Over the load, and under what is reached if nothing breaks.
                    let load = (if side == 0 { initial } else { -initial }).max(0.0);
                    let near = load + (peak - load) * r.between(0.02, 0.9);
                    return if near > 1.0 { near } else { short(r.between(1e5, 2e6)) };
                }
                let near = match r.one_of(10) {
                    0 => peak * (1.0 + r.sign() * 1e-9),
                    1 => peak * (1.0 + r.sign() * 10f64.powf(r.between(-15.0, -11.0))),
                    2 => peak,
                    3 => (if side == 0 { 1.0 } else { -1.0 }) * self.uniform,
                    _ => peak * r.between(0.3, 1.3),
                };
                if near > 1.0 { near } else { short(r.between(1e5, 2e6)) }
            });
            if self.kind.cascades() && !breaks_often {
                rating[0] *= r.between(0.6, 1.5);
            }
            let most = if breaks_often { 1.05 } else { 1.5 };
            let limits = |rating: f64, r: &mut Random| {
                let [a, b] = [r.between(0.3, 0.9), r.between(1.0, most)];
                [short(rating * a), short(rating * b), short(rating * b * r.between(1.01, most))]
            };
            rated.limits.push(with_limits.then(|| rating.map(|rating| limits(rating, r))));
            rated.rating.push(rating);
        }
        rated
    }

    /// The train file, and the record beside it.
    pub fn text(&self, rated: &Rated) -> (String, String) {
        let System { mass, held, stiffness, dashpot, horizon, .. } = &self.system;
        let mut text = String::new();
        if self.system.ratio > 0.0 {
            let _ = writeln!(text, "damping_ratio = {}", self.system.ratio);
        }
        text += "[coupler]\nstiffness = \"1 N/m\"\nrated_load = \"1 N\"\n";
        for (v, m) in mass.iter().enumerate() {
            let is_held = v == 0 && held[0] || v + 1 == mass.len() && held[1];
            let _ = writeln!(text, "[[vehicle]]\nmass = \"{m} kg\"\nheld = {is_held}");
            match self.traction.get(v) {
                Some(p) if *p > 0.0 => text += &format!("tractive_effort = \"{p} N\"\n"),
                Some(p) => text += &format!("brake_force = \"{} N\"\n", -p),
                None => {}
            }
            if let Some(own) = self.grade.get(v).filter(|own| **own != self.train_grade) {
                let _ = writeln!(text, "grade = \"{own} %\"");
            }
        }
        for (i, k) in stiffness.iter().enumerate() {
            let [draft, buff] = rated.rating[i];
            let _ = writeln!(
                text,
                "[[coupler_override]]\nat = {}\nstiffness = \"{k} N/m\"\nrated_load = \"{draft} N\"",
                i + 1
            );
            let _ = writeln!(text, "rated_buff = \"{buff} N\"");
            if dashpot[i] > 0.0 {
                let _ = writeln!(text, "damping = \"{} N*s/m\"", dashpot[i]);
            }
            for (sense, limits) in ["draft", "buff"].into_iter().zip(rated.limits[i].iter().flatten()) {
                let [fatigue, proof, ultimate] = limits;
                let _ = writeln!(
                    text,
                    "limits.{sense} = {{ fatigue = \"{fatigue} N\", proof = \"{proof} N\", ultimate = \"{ultimate} N\" }}"
                );
            }
        }
        if self.uniform != 0.0 {
            let _ = writeln!(text, "[load]\nuniform = \"{} N\"", self.uniform);
        }
        if self.train_grade != 0.0 {
            let _ = writeln!(text, "[load]\ngrade = \"{} %\"", self.train_grade);
        }
        let _ = writeln!(text, "[[scenario]]\nname = \"s\"\nhorizon = \"{horizon} s\"\n{}", self.event.text());
        if self.kind.cascades() {
            let _ = writeln!(text, "cascade = true\nbuff_breaks = {}", self.kind == Kind::CascadeInBuff);
        }
        let mut record = "time_s,force_N\n".to_owned();
        if let DrawnEvent::Record(_, rows) = &self.event {
            rows.iter().for_each(|[t, f]| record += &format!("{t},{f}\n"));
        }
        (text, record)
    }
}

impl DrawnEvent {
    fn text(&self) -> String {
        match self {
            DrawnEvent::Break(b) => format!("kind = \"break\"\ncoupler = {}", b + 1),
            DrawnEvent::Record(at, _) => format!("kind = \"pulse\"\nat = {}\nrecord = \"record.csv\"", at + 1),
            DrawnEvent::Impact(count, at_head, speed) => {
                let at = if *at_head { "head" } else { "tail" };
                format!("kind = \"impact\"\nat = \"{at}\"\nvehicles = {count}\nspeed = \"{speed} m/s\"")
            }
            DrawnEvent::Pulse(shape, at, force, duration, [rise, fall]) => {
                let ramps = if *shape == "trapezoid" {
                    format!("\nrise = \"{rise} s\"\nfall = \"{fall} s\"")
                } else {
                    String::new()
                };
                format!(
                    "kind = \"pulse\"\nat = {}\nforce = \"{force} N\"\nduration = \"{duration} s\"\nshape = \"{shape}\"{ramps}",
                    at + 1
                )
            }
        }
    }
}

/// A pulse's force over time.
pub fn courses(shape: &str, force: f64, duration: f64, [rise, fall]: [f64; 2]) -> Vec<Course> {
    let through = |points: &[[f64; 2]]| points.windows(2).map(|w| Course::Line(w[0], w[1])).collect();
    match shape {
        "rectangle" => through(&[[0.0, force], [duration, force]]),
        "half-sine" => vec![Course::HalfSine(force, duration)],
        "triangle" => through(&[[0.0, 0.0], [0.5 * duration, force], [duration, 0.0]]),
        _ => through(&[[0.0, 0.0], [rise, force], [duration - fall, force], [duration, 0.0]]),
    }
}
