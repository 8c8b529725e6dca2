//! What happens to a train: a coupler breaks, a force strikes a vehicle, vehicles run into it, brakes are applied.

use crate::forcing::Drive;

/// Which couplers break when they pass the force that breaks them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// None.
    Keep,
    /// Those in draft; one that passes that force in buff is kept.
    InDraft,
    /// All.
    InBoth,
}

/// One named event to run, with how long to watch.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// Unique within the train.
    pub name: String,
    /// What happens at t = 0.
    pub event: Event,
    /// How long forces are followed, s; `None`: to the last change of the forces from outside and four one-way wave transits of the
    /// longest part beyond it.
    pub horizon_s: Option<f64>,
    /// What breaks after the event: nothing, unless the file says `cascade = true`.
    pub cascade: Rule,
    /// Couplers, from 0, that would break in turn but carry buff, so that their vehicles stay pressed together: they are not
    /// among those of the event.
    pub left_out_in_buff: Vec<usize>,
    /// Brakes and tractive efforts after the event; none by default.
    pub response: Response,
}

impl Scenario {
    /// Whether brakes are applied in it, by a parting or as its event.
    pub(crate) fn applies_brakes(&self) -> bool {
        self.applications().next().is_some()
    }

    /// The brake applications in it: that of its event, and that which partings set off.
    pub(crate) fn applications(&self) -> impl Iterator<Item = &Application> {
        let of_event = if let Event::Brake { application, .. } = &self.event { Some(application) } else { None };
        of_event.into_iter().chain(&self.response.emergency)
    }
}

/// Brakes and tractive efforts after an event.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Response {
    /// The emergency application that each parting sets off, both ways.
    pub emergency: Option<Application>,
    /// Tractive efforts that change.
    pub efforts: Vec<Forcing>,
}

/// A brake application: it runs along the train, and builds up in each vehicle that it has reached.
#[derive(Clone, Debug, PartialEq)]
pub struct Application {
    /// The name of a kind of brake that stands for the numbers, where the file gives one.
    pub name: Option<&'static str>,
    /// How fast it runs, m/s.
    pub wave_m_per_s: f64,
    /// Time since it reached the vehicle, s, and share of its full emergency brake force; straight lines between, from `[0, 0]` on,
    /// neither ever falls.
    pub build_up: Vec<[f64; 2]>,
}

impl Application {
    /// When it is fully built up where it is, s.
    pub fn full_after_s(&self) -> f64 {
        self.build_up.last().map_or(0.0, |last| last[0])
    }

    /// What is wrong with its build-up, and what would be right.
    pub(crate) fn disorder(&self) -> Option<[&'static str; 2]> {
        let points = &self.build_up;
        let fall = points.windows(2).any(|pair| pair[1][1] < pair[0][1]);
        let right = "expected rows of a time and a share: [[\"0 s\", \"0 %\"], [\"8 s\", \"100 %\"]]";
        if points.len() < 2 {
            Some(["build_up has fewer than two rows", right])
        } else if points.iter().flatten().any(|x| !x.is_finite()) {
            Some(["build_up has a value that is not a finite number", right])
        } else if points[0] != [0.0, 0.0] {
            Some(["build_up does not start with no force at 0 s", "its first row is [\"0 s\", \"0 %\"]"])
        } else if points.windows(2).any(|pair| pair[1][0] <= pair[0][0]) {
            Some(["the times of build_up do not rise", "each row is later than the one before"])
        } else if points.iter().any(|p| p[1] > 1.0) {
            Some(["build_up has a share over 100 %", "100 % is the vehicle's emergency_brake"])
        } else if fall {
            Some(["the shares of build_up fall", "brakes that release are not computed"])
        } else if points.last().is_some_and(|last| last[1] == 0.0) {
            Some(["build_up holds no brake force", "its last row is the largest share: [\"8 s\", \"100 %\"]"])
        } else {
            None
        }
    }
}

/// A change of the outside force on one vehicle.
#[derive(Clone, Debug, PartialEq)]
pub struct Forcing {
    /// Index from 0; never a held vehicle.
    pub vehicle: usize,
    /// Time, s, and change of the force, N, forward positive: straight lines between, no change before the first and that of the last
    /// after it. Two at one time are a jump.
    pub points: Vec<[f64; 2]>,
}

/// An outside force on one vehicle from t = 0 on, and none after its end.
#[derive(Clone, Debug, PartialEq)]
pub struct Pulse {
    /// Index from 0; never a held vehicle.
    pub vehicle: usize,
    /// Largest force of either sign, N, forward positive; finite and not 0.
    pub force_n: f64,
    /// From t = 0 to its end, s; finite and > 0.
    pub duration_s: f64,
    /// Its course over time.
    pub shape: PulseShape,
}

/// The course of a pulse over time.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum PulseShape {
    /// Constant.
    Rectangle,
    /// `force sin(pi t / duration)`
    HalfSine,
    /// Up to the force at half the duration, and down again.
    Triangle,
    /// Up to the force, constant, and down again.
    Trapezoid {
        /// How long it rises, s.
        rise_s: f64,
        /// How long it falls, s.
        fall_s: f64,
    },
    /// Straight lines between points of a time, s, and a force, N; two at one time are a jump.
    Record(Vec<[f64; 2]>),
}

impl PulseShape {
    /// As the file names it: `"rectangle"`, `"half-sine"`, `"triangle"`, `"trapezoid"` or `"record"`.
    pub fn name(&self) -> &'static str {
        match self {
            PulseShape::Rectangle => "rectangle",
            PulseShape::HalfSine => "half-sine",
            PulseShape::Triangle => "triangle",
            PulseShape::Trapezoid { .. } => "trapezoid",
            PulseShape::Record(_) => "record",
        }
    }
}

impl Pulse {
    /// A constant force, N, that lasts some seconds.
    pub fn rectangle(vehicle: usize, force_n: f64, duration_s: f64) -> Pulse {
        Pulse { vehicle, force_n, duration_s, shape: PulseShape::Rectangle }
    }

    /// The force over time, in s and N.
    pub fn drive(&self) -> Drive {
        let Pulse { force_n, duration_s, .. } = *self;
        let lines =
            |from: f64, to: f64| Drive::Lines(vec![[0.0, 0.0], [from, force_n], [to, force_n], [duration_s, 0.0]]);
        match &self.shape {
            PulseShape::Rectangle => Drive::rectangle(force_n, duration_s),
            PulseShape::HalfSine => Drive::HalfSine { peak: force_n, duration: duration_s },
            PulseShape::Triangle => lines(0.5 * duration_s, 0.5 * duration_s),
            // Where the ramps meet, rounding must not put the end of the rise behind the start of the fall.
            PulseShape::Trapezoid { rise_s, fall_s } => {
                let full_s = rise_s.min(duration_s);
                lines(full_s, (duration_s - fall_s).max(full_s))
            }
            PulseShape::Record(points) => Drive::Lines(points.clone()),
        }
    }

    /// The same course with times and forces multiplied.
    pub(crate) fn scaled(&self, time: f64, force: f64) -> Pulse {
        let shape = match &self.shape {
            PulseShape::Trapezoid { rise_s, fall_s } => {
                PulseShape::Trapezoid { rise_s: rise_s * time, fall_s: fall_s * time }
            }
            PulseShape::Record(points) => {
                PulseShape::Record(points.iter().map(|p| [p[0] * time, p[1] * force]).collect())
            }
            same => same.clone(),
        };
        let (force_n, duration_s) = (self.force_n * force, self.duration_s * time);
        Pulse { vehicle: self.vehicle, force_n, duration_s, shape }
    }
}

/// The event at t = 0.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Event {
    /// Couplers that break, each in a case of its own, each from the intact train.
    Break {
        /// Indices from 0, in the file's order.
        couplers: Vec<usize>,
    },
    /// An outside force on one vehicle that ends.
    Pulse(Pulse),
    /// Vehicles at one end arrive at a speed and couple to the standing ones.
    Impact {
        /// How many arrive; at least one stands.
        vehicles: usize,
        /// At the head; at the tail if not.
        at_head: bool,
        /// Speed toward the standing ones, m/s; finite and > 0.
        speed_m_per_s: f64,
    },
    /// Brakes are applied.
    Brake {
        /// Vehicles, from 0, at which the application starts at t = 0.
        from: Vec<usize>,
        /// An emergency application; a service one if not.
        emergency: bool,
        /// Its course.
        application: Application,
    },
}

impl Event {
    /// The kind as the file names it: `"break"`, `"pulse"`, `"impact"` or `"brake"`.
    pub fn kind(&self) -> &'static str {
        match self {
            Event::Break { .. } => "break",
            Event::Pulse(_) => "pulse",
            Event::Impact { .. } => "impact",
            Event::Brake { .. } => "brake",
        }
    }

    /// Whether it is an impact, or a pulse that is not rectangular: no step or rectangular pulse of force represents it. Brake
    /// applications are excluded elsewhere.
    pub fn beyond_steps(&self) -> bool {
        match self {
            Event::Impact { .. } => true,
            Event::Pulse(pulse) => pulse.shape != PulseShape::Rectangle,
            Event::Break { .. } | Event::Brake { .. } => false,
        }
    }

    /// Of an impact, the coupler that joins the two parts, as an index from 0, in a train of so many vehicles.
    pub fn joint(&self, count: usize) -> Option<usize> {
        match *self {
            Event::Impact { vehicles, at_head: true, .. } => Some(vehicles - 1),
            Event::Impact { vehicles, at_head: false, .. } => Some(count - vehicles - 1),
            _ => None,
        }
    }
}
