//! A look at each train before a run: the files that it is read from, its cases, and what the study's inputs change in it.

use std::path::Path;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::base::Base;
use super::key::Key;
use super::names;
use super::study::{Input, Per, Study};
use super::variation::{Reached, probe, vary};
use crate::consist;
use crate::doubts::doubts;
use crate::error::printable_path;
use crate::findings::{Options, cases, idle_options};
use crate::train::{CouplerSpec, Doubt, Load, Origin, PulledTo, Scenario, Source, Train, TrainSpec, VehicleSpec};

/// What is known of a train file before the run.
#[derive(Serialize, Deserialize)]
pub struct Survey {
    /// Every file that some variation is read from, in the order of their paths.
    #[serde(with = "names::sources")]
    pub sources: Vec<Source>,
    /// Cases of each variation, or of all of them alike.
    counts: Vec<u32>,
    /// The couplers that take what is drawn for each of them; `None` where that differs from variation to variation.
    pub reached: Option<Reached>,
    /// An input of the study that changes nothing in this train, and why.
    pub without_effect: Option<String>,
    /// Inputs that reach some couplers or vehicles and not others, as sentences.
    #[serde(skip)]
    pub notes: Vec<String>,
    /// The doubts about its first variation that can be read.
    #[serde(skip)]
    pub doubts: Vec<Doubt>,
    /// Options without effect on it, as sentences.
    #[serde(skip)]
    pub idle: Vec<String>,
}

impl Survey {
    /// Looks at a train file.
    pub fn of(path: &Path, study: Option<&Study>, options: &Options) -> Survey {
        let base = Base::read(path);
        let mut survey = Survey {
            sources: vec![],
            counts: vec![1],
            reached: Some(Reached::new()),
            without_effect: None,
            notes: vec![],
            doubts: vec![],
            idle: vec![],
        };
        match study {
            None => {
                let text = base.text.as_ref().ok();
                if let Some(train) = text.and_then(|text| consist::parse_with(text, path, &base.files).ok()) {
                    survey.counts = vec![case_count(&train)];
                    survey.tell(&train, options);
                }
            }
            Some(study) => survey.look(study, &base, options),
        }
        survey.sources = base.files.list();
        survey.sources.sort_by(|a, b| a.path.cmp(&b.path).then(a.sha256.cmp(&b.sha256)));
        // Variations that are read at the same time may each have opened a file.
        survey.sources.dedup();
        survey
    }

    /// How many cases a variation has, from 0; a train that cannot be read has one, and one without effect has one in all.
    pub fn count(&self, variation: usize) -> u32 {
        match (&self.without_effect, self.counts.as_slice()) {
            (Some(_), _) => u32::from(variation == 0),
            (None, [all]) => *all,
            (None, counts) => counts[variation],
        }
    }

    fn tell(&mut self, train: &Train, options: &Options) {
        self.doubts = doubts(train);
        self.idle = idle_options(train, options);
    }

    fn look(&mut self, study: &Study, base: &Base, options: &Options) {
        let train = |variation: usize| vary(study, variation, base, &Reached::new()).train.ok();
        let variations = 0..study.variations();
        let found = if study.inputs.iter().all(|input| keeps_cases(&input.key)) {
            let found = variations.into_iter().find_map(|variation| Some((variation, train(variation)?)));
            self.counts = vec![found.as_ref().map_or(1, |(_, train)| case_count(train))];
            found.map(|(variation, _)| variation)
        } else {
            let count = |variation: usize| train(variation).as_ref().map(case_count);
            let counts: Vec<Option<u32>> = variations.into_par_iter().map(count).collect();
            self.counts = counts.iter().map(|count| count.unwrap_or(1)).collect();
            counts.iter().position(Option::is_some)
        };
        self.without_effect = study.inputs.iter().find_map(|input| missing(input, base));
        let Some(variation) = found.filter(|_| self.without_effect.is_none()) else { return };
        if let Some(train) = train(variation) {
            self.tell(&train, options);
        }
        let reach = reach(study, variation, base);
        self.without_effect = reach.without_effect;
        self.notes = reach.notes;
        self.reached = study.inputs.iter().all(|input| keeps_couplers(&input.key)).then_some(reach.reached);
    }
}

/// A table of the train file that an input names and that is not there.
fn missing(input: &Input, base: &Base) -> Option<String> {
    let why = input.key.put(&mut base.tree.clone()?, toml::Value::Boolean(true)).err()?;
    Some(format!("{} reaches nothing in {}: {why}", input.key, printable_path(&base.path)))
}

/// What a study's inputs change in a train.
#[derive(Default)]
pub struct Reach {
    /// The couplers that take what is drawn for each of them.
    pub reached: Reached,
    without_effect: Option<String>,
    notes: Vec<String>,
}

/// Changes each input of a variation by itself, and compares the trains.
pub fn reach(study: &Study, variation: usize, base: &Base) -> Reach {
    let mut reach = Reach::default();
    let file = printable_path(&base.path);
    for (k, input) in study.inputs.iter().enumerate() {
        let probes = input.spread.probes(input.key.dimension());
        if probes.iter().all(|value| *value == probes[0]) {
            continue;
        }
        let mut trains = probes.iter().filter_map(|value| probe(study, variation, base, k, value).ok().map(effective));
        let Some(first) = trains.next() else { continue };
        let mut alike = 1;
        let mut uniform = false;
        let seen = |other: &TrainSpec| (alike, uniform) = (alike + 1, uniform || *other != first);
        let differs = |other: &TrainSpec| *other != first && !moves_alike(&first, other);
        let Some(other) = trains.by_ref().inspect(seen).find(differs) else {
            if alike > 1 {
                let why = if uniform { UNIFORM } else { why_none(&input.key) };
                reach.without_effect.get_or_insert(format!("{} reaches {} {file}: {}", input.key, why.0, why.1));
            }
            continue;
        };
        let (what, changed) = match input.key.table {
            Some("coupler") => ("couplers", changed_couplers(&first, &other)),
            Some("load") => ("vehicles", changed_vehicles(&first, &other)),
            _ => continue,
        };
        let count = changed.iter().filter(|changed| **changed).count();
        if count > 0 && count < changed.len() {
            let some = format!("{} is varied in {count} of {} {what} of {file}", input.key, changed.len());
            reach.notes.push(format!("{some}: the others keep a value of their own"));
        }
        if input.per == Per::Coupler && count > 0 {
            reach.reached.insert(k, changed);
        }
    }
    reach
}

/// The train without what no result depends on: its origin and the masses of held vehicles; unless brakes are applied,
/// lengths, the train's speed and emergency brakes; unless gears have friction, an earlier pull.
fn effective(train: Train) -> TrainSpec {
    let has_brakes = train.scenarios().iter().any(Scenario::applies_brakes);
    let mut spec = TrainSpec { origin: Origin::default(), ..train.into_spec() };
    spec.vehicles.iter_mut().filter(|v| v.held).for_each(|v| v.mass_kg = 1.0);
    if !has_brakes {
        spec.vehicles.iter_mut().for_each(|v| (v.length_m, v.emergency_brake_n) = (None, 0.0));
        spec.speed_m_per_s = None;
    }
    if !spec.couplers.iter().any(|c| c.law.has_friction()) {
        spec.pulled_to = PulledTo::None;
    }
    spec
}

/// Whether two trains differ in their forces from outside alone, and these only in what gives all vehicles one acceleration, while none
/// is held and no brakes are applied: forces in couplers depend on nothing else.
fn moves_alike(a: &TrainSpec, b: &TrainSpec) -> bool {
    let is_free = a.vehicles.iter().all(|v| !v.held) && !a.scenarios.iter().any(Scenario::applies_brakes);
    let (Load::OnVehicles(x), Load::OnVehicles(y), true) = (&a.load, &b.load, is_free) else { return false };
    let mass_kg: f64 = a.vehicles.iter().map(|v| v.mass_kg).sum();
    let acceleration = |outside_n: &[f64]| outside_n.iter().sum::<f64>() / mass_kg;
    let (ax, ay) = (acceleration(x), acceleration(y));
    // Rounding is no difference.
    let room_n = 1e-12 * x.iter().chain(y).fold(0.0f64, |most, p| most.max(p.abs()));
    let alike = |((x, y), v): ((&f64, &f64), &VehicleSpec)| ((x - y) - (ax - ay) * v.mass_kg).abs() <= room_n;
    x.iter().zip(y).zip(&a.vehicles).all(alike) && TrainSpec { load: a.load.clone(), ..b.clone() } == *a
}

/// Why a key that only accelerates the train has no effect.
const UNIFORM: (&str, &str) = (
    "nothing in",
    "it accelerates all vehicles alike, and no force in a coupler depends on that; hold an end to keep its speed",
);

/// Whether each coupler differs.
fn changed_couplers(a: &TrainSpec, b: &TrainSpec) -> Vec<bool> {
    let differs = |(i, coupler): (usize, &CouplerSpec)| b.couplers.get(i).is_some_and(|other| other != coupler);
    a.couplers.iter().enumerate().map(differs).collect()
}

/// Whether the force from outside differs, of each vehicle that is not held.
fn changed_vehicles(a: &TrainSpec, b: &TrainSpec) -> Vec<bool> {
    let (Load::OnVehicles(x), Load::OnVehicles(y)) = (&a.load, &b.load) else { return vec![] };
    let free = a.vehicles.iter().zip(x.iter().zip(y)).filter(|(v, _)| !v.held);
    free.map(|(_, (x, y))| x != y).collect()
}

/// What a key without effect does not reach, and why.
fn why_none(key: &Key) -> (&'static str, &'static str) {
    match (key.table, key.leaf) {
        (Some("coupler"), _) => (
            "no coupler of",
            "each has a value of its own, from the table of vehicles or a [[coupler_override]], and keeps it",
        ),
        (Some("load"), "pulled_to") => {
            ("nothing in", "only the force in a gear with friction depends on an earlier pull")
        }
        (Some("load"), _) => ("no vehicle of", "each has a value of its own, and keeps it"),
        (None, "speed") | (Some("vehicle"), "length" | "emergency_brake") => {
            ("nothing in", "no force depends on it in a train whose scenarios apply no brakes")
        }
        (Some("vehicle"), "mass") => ("no vehicle of", "it is held, and the mass of a held vehicle plays no part"),
        _ => ("nothing in", "none of its values changes the train"),
    }
}

/// Whether no value of a key changes how many cases a train has, or which files it is read from. The couplers that `"each"` breaks
/// depend on the sign of the load.
fn keeps_cases(key: &Key) -> bool {
    match key.table {
        None => key.leaf != "vehicles",
        Some("coupler" | "coupler_override") => !["stiffness", "at"].contains(&key.leaf),
        Some("vehicle") => ["label", "length"].contains(&key.leaf),
        Some("scenario") => {
            ["name", "horizon", "force", "duration", "rise", "fall", "speed", "wave", "build_up"].contains(&key.leaf)
        }
        _ => false,
    }
}

/// Whether no value of a key changes which couplers have values of their own.
fn keeps_couplers(key: &Key) -> bool {
    match key.table {
        None => key.leaf != "vehicles",
        Some("coupler_override") => key.leaf != "at",
        Some("vehicle") => key.leaf != "count",
        _ => true,
    }
}

fn case_count(train: &Train) -> u32 {
    let count: usize = train.scenarios().iter().map(|s| cases(&s.event).len()).sum();
    // A train without a case counts as one. A train file has at most a million breaks, and at most a thousand
    // scenarios.
    u32::try_from(count.max(1)).unwrap_or(u32::MAX)
}
