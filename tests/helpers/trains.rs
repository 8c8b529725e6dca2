//! Trains built by hand, for tests that start after the train file.

#![allow(dead_code)] // Each test binary uses its own part.

use trainsafe::train::{CouplerSpec, Event, Load, Pulse, Rule, Scenario, Train, TrainSpec, VehicleSpec};

/// The train of a spec that is right.
pub fn built(spec: &TrainSpec) -> Train {
    spec.clone().build().unwrap_or_else(|wrong| panic!("{wrong}"))
}

/// [P] figure 4: 50 unit masses between a held head and a held tail, pulled by 1; coupler 51 breaks.
pub fn figure_4() -> TrainSpec {
    let mut train = uniform("Paper, figure 4", 52, 1.0, 1.0, 1.0, 1.0);
    train.vehicles[0].held = true;
    train.vehicles[51].held = true;
    train.scenarios = vec![breaks("the last link breaks", vec![50], Some(200.0))];
    train
}

/// [P] figure 5: 100 unit masses behind a held head, pulled at the free end with 1 for 10 time units.
pub fn figure_5() -> TrainSpec {
    let mut train = uniform("Paper, figure 5", 101, 1.0, 1.0, 1.0, 0.0);
    train.vehicles[0].held = true;
    let event = Event::Pulse(Pulse::rectangle(100, -1.0, 10.0));
    train.scenarios = vec![Scenario {
        name: "the free end is pulled".to_owned(),
        event,
        horizon_s: Some(200.0),
        cascade: Rule::Keep,
        left_out_in_buff: vec![],
        response: trainsafe::train::Response::default(),
    }];
    train
}

/// An ore train of a locomotive and 104 cars that pulls uniformly; the scenarios are the caller's.
pub fn ore_train(scenarios: Vec<Scenario>) -> TrainSpec {
    let mut train = uniform("Ore train, 1 locomotive and 104 cars", 105, 160e3, 30e6, 1.5e6, 0.6e6);
    train.vehicles[0] = vehicle("locomotive", 195e3);
    train.vehicles[0].held = true;
    for v in &mut train.vehicles {
        v.length_m = Some(10.9);
    }
    for c in &mut train.couplers {
        c.rated_buff_n = 0.8e6;
    }
    train.scenarios = scenarios;
    train
}

/// `n` equal vehicles, equally coupled and equally pulled, held nowhere, with no scenario.
pub fn uniform(name: &str, n: usize, mass_kg: f64, stiffness_n_per_m: f64, rated_n: f64, load_n: f64) -> TrainSpec {
    TrainSpec {
        name: name.to_owned(),
        vehicles: (1..=n).map(|i| vehicle(&format!("car {i}"), mass_kg)).collect(),
        couplers: vec![CouplerSpec::linear(stiffness_n_per_m, rated_n); n - 1],
        load: Load::Uniform(load_n),
        ..TrainSpec::default()
    }
}

/// A free vehicle without a length.
pub fn vehicle(label: &str, mass_kg: f64) -> VehicleSpec {
    VehicleSpec { label: Some(label.to_owned()), ..VehicleSpec::new(mass_kg) }
}

/// A scenario in which each of these couplers, counted from 0, breaks.
pub fn breaks(name: &str, couplers: Vec<usize>, horizon_s: Option<f64>) -> Scenario {
    Scenario {
        name: name.to_owned(),
        event: Event::Break { couplers },
        horizon_s,
        cascade: Rule::Keep,
        left_out_in_buff: vec![],
        response: trainsafe::train::Response::default(),
    }
}
