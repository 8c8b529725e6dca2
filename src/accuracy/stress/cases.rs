//! The extreme cases by name.

use std::f64::consts::{PI, TAU};

use super::super::reference::Reference;
use crate::chain::{Chain, Scene};
use crate::scenario;
use crate::train::{CouplerSpec, Event, Load, TrainSpec, VehicleSpec};

/// A named extreme scene.
#[derive(Clone, Debug)]
pub struct Case {
    /// What is extreme about it.
    pub name: &'static str,
    /// The scene.
    pub scene: Scene,
}

/// All of them.
pub fn cases() -> Vec<Case> {
    let lists = [sizes(), ratios(), times(), verdicts(), units()];
    lists.into_iter().flatten().map(|(name, scene)| Case { name, scene }).collect()
}

type Named = (&'static str, Scene);

fn sizes() -> Vec<Named> {
    let mut short = mixed(99_999);
    short.horizon = 100.0;
    let mut endless = mixed(99_999);
    endless.horizon *= 1000.0;
    vec![
        ("1 coupler", equal(1)),
        ("2 couplers", equal(2)),
        ("3,000 vehicles, equal", equal(2999)),
        ("3,000 vehicles, mixed", mixed(2999)),
        ("100,000 vehicles, near the break", short),
        ("100,000 vehicles, 4,000 transits", endless),
    ]
}

/// Ratios of 1e12. The slowest mode would need horizons of 1e6 time units, full of fast oscillations: horizons are cut
/// to what a minute can compute.
fn ratios() -> Vec<Named> {
    let masses = |at: &dyn Fn(usize) -> bool, value: f64| {
        let mut scene = mixed(24);
        scene.chain.mass.iter_mut().enumerate().filter(|(v, _)| at(*v)).for_each(|(_, m)| *m *= value);
        four_transits(scene)
    };
    let stiffnesses = |springs: usize, at: &dyn Fn(usize) -> bool, value: f64| {
        let mut scene = mixed(springs);
        scene.chain.stiffness.iter_mut().enumerate().filter(|(i, _)| at(*i)).for_each(|(_, k)| *k *= value);
        four_transits(scene)
    };
    let within = |horizon: f64, scene: Scene| Scene { horizon: scene.horizon.min(horizon), ..scene };
    let mut twins = equal(40);
    (twins.chain.mass[10], twins.chain.mass[30]) = (1e-6, 1e-6);
    vec![
        ("masses 1 and 1e-12 in turn", within(10.0, masses(&|v| v % 2 == 0, 1e-12))),
        ("one mass of 1e-12", masses(&|v| v == 12, 1e-12)),
        ("one mass of 1e12", within(1e5, masses(&|v| v == 12, 1e12))),
        ("stiffnesses 1 and 1e12 in turn", stiffnesses(24, &|i| i % 2 == 0, 1e12)),
        ("one stiffness of 1e12", stiffnesses(24, &|i| i == 12, 1e12)),
        ("one stiffness of 1e-12", within(1e5, stiffnesses(24, &|i| i == 12, 1e-12))),
        ("a nearly rigid drawbar in every tenth place", stiffnesses(100, &|i| i % 10 == 5, 1e6)),
        ("two light vehicles of one frequency", four_transits(twins)),
    ]
}

fn times() -> Vec<Named> {
    let long = |mut scene: Scene| {
        scene.horizon = 1e6;
        scene
    };
    let pulse = |duration: f64, horizon: f64| Scene { duration, horizon, initial: vec![0.1; 30], ..equal(30) };
    // [P] eq. (10): the third mode's period.
    let period = TAU / (2.0 * (PI * 5.0 / (2.0 * 61.0)).sin());
    vec![
        ("horizon of 1e6 time units, equal", long(equal(20))),
        ("horizon of 1e6 time units, mixed", long(mixed(20))),
        ("pulse of 1e-9 of the shortest period", pulse(1e-9 * PI, 120.0)),
        ("pulse of exactly a mode's period", pulse(period, 120.0)),
        ("pulse longer than the horizon", pulse(1e3, 120.0)),
    ]
}

/// Loads at, and a peak next to, the rating. The last two need the reference to know the peak.
fn verdicts() -> Vec<Named> {
    // Up to one transit couplers are only relieved, then pushed: never above the rating in draft.
    let at_rating = |load: f64| {
        let horizon = 40.0;
        Scene { horizon, force: load, initial: vec![load; 40], rated_buff: vec![3.0; 40], ..equal(40) }
    };
    let mut list = vec![
        ("load exactly at the rating", at_rating(1.0)),
        ("load at the next float above the rating", at_rating(1.0f64.next_up())),
    ];
    let mut close = mixed(20);
    let reference = Reference::new(&close).and_then(|r| r.extremes());
    if let Ok(extremes) = reference {
        let peaks = |side: usize| extremes.iter().map(move |e| e[side].value.to_f64().value().abs());
        close.rated_draft = peaks(0).collect();
        close.rated_buff = peaks(1).collect();
        list.push(("every peak at its rating to the last bit", close.clone()));
        close.rated_draft = peaks(0).map(|p| p * (1.0 - 1e-12)).collect();
        close.rated_buff = peaks(1).map(|p| p * (1.0 - 1e-12)).collect();
        list.push(("every peak 1e-12 over its rating", close));
    }
    list
}

/// Trains whose numbers lie at the ends of the range of an `f64`.
fn units() -> Vec<Named> {
    let part = |mass_kg: &dyn Fn(usize) -> f64, stiffness: f64, force_n: f64| {
        let vehicle = |v: usize| VehicleSpec { held: v == 0, ..VehicleSpec::new(mass_kg(v)) };
        let spec = TrainSpec {
            vehicles: (0..101).map(vehicle).collect(),
            couplers: vec![CouplerSpec::linear(stiffness, force_n); 100],
            load: Load::Uniform(0.8 * force_n),
            ..TrainSpec::default()
        };
        let train = spec.build().ok()?;
        let event = Event::Break { couplers: vec![99] };
        scenario::parts(&train, &event, Some(99), 1.0).into_iter().next().map(|p| four_transits(p.scene))
    };
    let named = [
        ("a 1 kg vehicle in a 10,000 t train", part(&|v| if v == 50 { 1.0 } else { 1e5 }, 3e7, 1.5e6)),
        ("vehicles of 1e-300 kg", part(&|_| 1e-300, 3e7, 1.5e6)),
        ("vehicles of 1e-310 kg on couplers of 1e-310 N/m", part(&|_| 1e-310, 1e-310, 1.5e6)),
        ("forces of 1e300 N", part(&|_| 1e5, 3e7, 1e300)),
    ];
    named.into_iter().filter_map(|(name, scene)| Some((name, scene?))).collect()
}

/// A uniformly loaded train, held at the head, which breaks behind its last vehicle; rated at 1.
fn train(mass: Vec<f64>, stiffness: Vec<f64>) -> Scene {
    let springs = stiffness.len();
    four_transits(Scene {
        chain: Chain { mass, stiffness, held_head: true, held_tail: false },
        source: springs,
        force: 0.8,
        duration: f64::INFINITY,
        initial: vec![0.8; springs],
        rated_draft: vec![1.0; springs],
        rated_buff: vec![1.0; springs],
        horizon: 0.0,
    })
}

fn four_transits(mut scene: Scene) -> Scene {
    scene.horizon = 4.0 * scene.chain.transit();
    scene
}

fn equal(springs: usize) -> Scene {
    train(vec![1.0; springs + 1], vec![1.0; springs])
}

/// Masses and stiffnesses that differ without a pattern, within a ratio of 4.
fn mixed(springs: usize) -> Scene {
    let wave = |v: usize, turn: f64| (turn * (v * v) as f64).sin();
    let mass = (1..=springs + 1).map(|v| 1.0 + 0.6 * wave(v, 1.7)).collect();
    let stiffness = (1..=springs).map(|i| 1.0 + 0.4 * wave(i, 2.3)).collect();
    train(mass, stiffness)
}
