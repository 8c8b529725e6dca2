//! A train, valid by construction: [`TrainSpec::build`] is the only way to a [`Train`], for files, studies, the library and Python.
//!
//! Vehicles and couplers are indexed from 0 in the code and numbered from 1, from the head, wherever a user sees them:
//! coupler `i` joins vehicle `i` and vehicle `i + 1`. Forces are positive in tension (draft), negative in compression
//! (buff).

mod build;
mod checks;
mod doubt;
mod event;
mod extras;
mod labels;
mod scenarios;
mod spec;
mod steady;

use std::path::PathBuf;
use std::sync::Arc;

use crate::law::Law;
use crate::units::UnitSystem;

pub use checks::{InvalidTrain, SpecProblem};
pub(crate) use checks::{held, many, of_held};
pub use doubt::Doubt;
pub(crate) use doubt::{count, more};
pub use event::{Application, Event, Forcing, Pulse, PulseShape, Response, Rule, Scenario};
pub use extras::{Extras, LIMITS, Limits, SENSES, Steady};
pub(crate) use labels::numbered;
pub(crate) use scenarios::{MOST_CASES, MOST_SCENARIOS};
pub use spec::{CouplerSpec, Load, PulledTo, TrainSpec, VehicleSpec};
pub use steady::steady_forces;
pub(crate) use steady::without_noise;

/// More vehicles than this are refused.
pub(crate) const MOST_VEHICLES: usize = 1_000_000;

/// A vehicle: a rigid mass between couplers.
#[derive(Clone, Debug, PartialEq)]
pub struct Vehicle {
    /// What a report calls it: its own label, numbered where the train has it more than once (`"ore car 7"`), or
    /// `"vehicle 12"` by its place.
    pub label: String,
    /// Mass, kg; finite and > 0.
    pub mass_kg: f64,
    /// Keeps its speed whatever the couplers do; only ever the first or the last vehicle. Its mass plays no part.
    pub held: bool,
    /// Length over couplers, m, where it is given.
    pub length_m: Option<f64>,
}

/// A coupler: the whole connection between two vehicles, as one linear spring with two ratings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupler {
    /// Stiffness, N/m; finite and > 0. Of a coupler whose law is not linear ([`Extras::laws`]) the secant of loading at the train's
    /// largest load, which gives scales of time and no force.
    pub stiffness_n_per_m: f64,
    /// Capacity in tension, N; finite and > 0.
    pub rated_draft_n: f64,
    /// Capacity in compression, N (a positive number); finite and > 0.
    pub rated_buff_n: f64,
}

/// A valid train with what is to be run on it. It can be read and not changed: [`Train::into_spec`] gives what it is built from.
#[derive(Clone, Debug, PartialEq)]
pub struct Train {
    name: String,
    vehicles: Vec<Vehicle>,
    couplers: Vec<Coupler>,
    initial_force_n: Vec<f64>,
    scenarios: Vec<Scenario>,
    extras: Extras,
    origin: Origin,
}

/// Where a train comes from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Origin {
    /// Every file that was read for it.
    pub sources: Vec<Source>,
    /// What its reader found that is probably not meant; part of [`doubts`](crate::doubts::doubts).
    pub doubts: Vec<Doubt>,
    /// What the file names by a label, with its number: `coupler 41 is behind "coal car 40"`.
    pub by_label: Vec<String>,
    /// The text of the train file.
    pub text: Arc<str>,
    /// The units of reports: those that the file asks for, or in which most of its quantities are written.
    pub units: UnitSystem,
}

/// A file that was read, or that could not be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// Its path, as the train file or the user names it.
    pub path: PathBuf,
    /// SHA-256 of its bytes; of the error's text, where it could not be read.
    pub sha256: [u8; 32],
}

/// Bytes in hexadecimal digits, as checksums are written.
pub(crate) fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

impl Train {
    /// What reports call it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The vehicles from the head; at least two.
    pub fn vehicles(&self) -> &[Vehicle] {
        &self.vehicles
    }

    /// A vehicle by its number, from 1, with its label where that says more: `vehicle 9 (car 8)`.
    pub(crate) fn place_of(&self, number: usize) -> String {
        let (place, label) = (format!("vehicle {number}"), &self.vehicles[number - 1].label);
        if *label == place { place } else { format!("{place} ({label})") }
    }

    /// Length over couplers, m, and whether held vehicles without a length are left out of it; `None` where one that is not held has none.
    pub(crate) fn length_m(&self) -> Option<(f64, bool)> {
        let counted = |v: &&Vehicle| !v.held || v.length_m.is_some();
        let length: Option<f64> = self.vehicles.iter().filter(counted).map(|v| v.length_m).sum();
        length.filter(|m| *m > 0.0).map(|m| (m, !self.vehicles.iter().all(|v| counted(&v))))
    }

    /// The couplers from the head, one fewer than vehicles.
    pub fn couplers(&self) -> &[Coupler] {
        &self.couplers
    }

    /// Force in each coupler in the steady state before the event, N, draft positive.
    pub fn initial_force_n(&self) -> &[f64] {
        &self.initial_force_n
    }

    /// Whether rounding alone decides on which side of a capacity, N, a coupler's load before the event lies, N, both in one sense;
    /// `coupler` is an index from 0. A load that is given, or that a double holds exactly, has no rounding.
    pub(crate) fn rounding_decides(&self, coupler: usize, load_n: f64, capacity_n: f64) -> bool {
        let error_n = self.extras.steady.as_ref().map_or(0.0, |steady| steady.error_n[coupler]);
        error_n > 0.0 && (load_n - capacity_n).abs() <= error_n
    }

    /// What is to be run; at least one scenario.
    pub fn scenarios(&self) -> &[Scenario] {
        &self.scenarios
    }

    /// What it has beyond linear springs under a given load; all absent by default.
    pub fn extras(&self) -> &Extras {
        &self.extras
    }

    /// Where it comes from; empty for a train that was not read from files.
    pub fn origin(&self) -> &Origin {
        &self.origin
    }

    /// The forces that a coupler went to, one after the other, before the event, N: the pull from which it was let down, if there
    /// was one, and its load.
    pub(crate) fn history_n(&self, coupler: usize) -> Vec<f64> {
        let pulled = self.extras.pulled_to_n.get(coupler).copied();
        pulled.into_iter().chain([self.initial_force_n[coupler]]).collect()
    }

    /// What it can be built from: a spec of one vehicle each, and with the forces that the load came to.
    pub fn into_spec(self) -> TrainSpec {
        let Train { name, vehicles, couplers, initial_force_n, scenarios, extras, origin } = self;
        let brake_n = |v: usize| extras.emergency_brake_n.get(v).copied().unwrap_or(0.0);
        let vehicle = |(v, vehicle): (usize, Vehicle)| VehicleSpec {
            label: Some(vehicle.label),
            count: 1,
            mass_kg: vehicle.mass_kg,
            held: vehicle.held,
            length_m: vehicle.length_m,
            emergency_brake_n: brake_n(v),
        };
        let coupler = |(i, c): (usize, &Coupler)| CouplerSpec {
            law: extras.laws.get(i).cloned().unwrap_or_else(|| Law::linear(c.stiffness_n_per_m)),
            rated_draft_n: c.rated_draft_n,
            rated_buff_n: c.rated_buff_n,
            limits: extras.limits.get(i).copied().unwrap_or_default(),
            dashpot_n_s_per_m: extras.dashpot_n_s_per_m.get(i).copied().unwrap_or(0.0),
        };
        TrainSpec {
            name,
            vehicles: vehicles.into_iter().enumerate().map(vehicle).collect(),
            couplers: couplers.iter().enumerate().map(coupler).collect(),
            load: match extras.steady {
                Some(Steady { outside_n, .. }) => Load::OnVehicles(outside_n),
                None => Load::InCouplers(initial_force_n),
            },
            pulled_to: match extras.pulled_to_n.is_empty() {
                true => PulledTo::None,
                false => PulledTo::InCouplers(extras.pulled_to_n),
            },
            damping_ratio: extras.damping_ratio,
            speed_m_per_s: extras.speed_m_per_s,
            scenarios,
            origin,
        }
    }

    /// The same in other units of reports.
    #[must_use]
    pub fn with_units(mut self, units: UnitSystem) -> Train {
        self.origin.units = units;
        self
    }

    /// The same with one of its scenarios only.
    #[cfg(feature = "serve")]
    pub(crate) fn with_only(mut self, scenario: usize) -> Train {
        self.scenarios = vec![self.scenarios.swap_remove(scenario)];
        self
    }

    /// The same with laws of its couplers, one for each, or none for linear springs of their stiffness.
    pub(crate) fn with_laws(&self, laws: Vec<Law>) -> Train {
        Train { extras: Extras { laws, ..self.extras.clone() }, ..self.clone() }
    }

    /// The same let down to its load from other pulls, N, one for each coupler, or none for a train that was not pulled before.
    pub(crate) fn with_pulled_to(&self, pulled_to_n: Vec<f64>) -> Train {
        Train { extras: Extras { pulled_to_n, ..self.extras.clone() }, ..self.clone() }
    }

    /// The same with the forces before the event, and those from which it was let down, so many times as large.
    pub(crate) fn with_load_times(&self, factor: f64) -> Train {
        let mut train = self.clone();
        train.initial_force_n.iter_mut().chain(&mut train.extras.pulled_to_n).for_each(|f| *f *= factor);
        train
    }

    /// The same with dashpots beside the couplers, N s/m, one for each, none negative, or none at all.
    pub(crate) fn with_dashpots(&self, dashpot_n_s_per_m: Vec<f64>) -> Train {
        Train { extras: Extras { dashpot_n_s_per_m, ..self.extras.clone() }, ..self.clone() }
    }

    /// The same with other ratings, each > 0.
    pub(crate) fn with_couplers(&self, couplers: Vec<Coupler>) -> Train {
        Train { couplers, ..self.clone() }
    }

    /// The same with the text of its file.
    pub(crate) fn with_text(mut self, text: &str) -> Train {
        self.origin.text = text.into();
        self
    }

    /// The same with where it was read from.
    pub(crate) fn with_origin(self, origin: Origin) -> Train {
        Train { origin, ..self }
    }
}
