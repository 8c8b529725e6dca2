//! A search for the factor on a march's load, force or speed at which couplers begin to exceed.
//!
//! With slack and friction forces do not grow in proportion to their cause, and a larger cause can even give smaller
//! ones: no factor below which none exceeds follows from one march. Marches are made at the factors of a grid, and
//! then between the first of them at which a coupler exceeds and the one before. The result holds for the factors that
//! were tried, and proves nothing about those between.

use rayon::prelude::*;
use serde::Serialize;

use super::Options;
use crate::march::{self, MarchOptions};
use crate::scenario;
use crate::solve::Wanted;
use crate::train::{Event, Rule, Scenario, Train};

/// Factors of the grid: number, and distance.
const GRID: usize = 8;
const GRID_STEP: f64 = 0.25;
/// Halvings after it: to 0.4 % of the cause.
const HALVINGS: usize = 6;
/// A search that would take more than this on one core, s, is not made; the time is that of the counted work, not a measured one.
const MOST_S: f64 = 10.0;

/// What a search found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LoadSearch {
    /// The largest factor tried at which no coupler exceeds, below every factor tried at which one does; 0 where one exceeds at the
    /// smallest.
    pub none_exceeds_at: f64,
    /// The smallest factor tried at which a coupler exceeds; `None` where none does up to the largest tried.
    pub exceeds_at: Option<f64>,
    /// How many factors were tried.
    pub tried: usize,
}

/// Estimated time of the search of a case up to a time on one core, s; `None` where none is made: of scenarios with several cases, of
/// brakes, where only the worst coupler is wanted, and where it would take too long.
pub(super) fn estimate_s(
    train: &Train,
    scenario: &Scenario,
    broken: Option<usize>,
    until_s: f64,
    options: &Options,
) -> Option<f64> {
    let alone = super::cases(&scenario.event).len() == 1 && options.wanted == Wanted::Everything;
    if !alone || matches!(scenario.event, Event::Brake { .. }) {
        return None;
    }
    let problem = scenario::march(train, scenario, broken, [until_s; 2], Rule::Keep);
    let all_s = (GRID + HALVINGS) as f64 * march::estimate_s(&problem, &MarchOptions::default());
    (all_s <= MOST_S).then_some(all_s)
}

/// The search of a case up to a time, where one is made.
pub(super) fn find(
    train: &Train,
    scenario: &Scenario,
    broken: Option<usize>,
    until_s: f64,
    options: &Options,
) -> Option<LoadSearch> {
    estimate_s(train, scenario, broken, until_s, options)?;
    let ask = MarchOptions { capacity_n: super::march::ratings_n(train), ..MarchOptions::default() };
    let problem = |factor: f64| {
        let (train, scenario) = multiplied(train, scenario, factor);
        scenario::march(&train, &scenario, broken, [until_s; 2], Rule::Keep)
    };
    let exceeds = |factor: f64| {
        let first = march::solve(&problem(factor), &ask).first_over_s;
        first.iter().enumerate().any(|(i, first)| Some(i) != broken && first.iter().any(Option::is_some))
    };
    let grid: Vec<bool> = (1..=GRID).into_par_iter().map(|n| exceeds(GRID_STEP * n as f64)).collect();
    let Some(first) = grid.iter().position(|over| *over) else {
        return Some(LoadSearch { none_exceeds_at: GRID_STEP * GRID as f64, exceeds_at: None, tried: GRID });
    };
    let (mut low, mut high) = (GRID_STEP * first as f64, GRID_STEP * (first + 1) as f64);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if exceeds(middle) { high = middle } else { low = middle }
    }
    Some(LoadSearch { none_exceeds_at: low, exceeds_at: Some(high), tried: GRID + HALVINGS })
}

/// The train and the scenario with the load before a break, the force of a pulse, or the speed of an impact so many times as large.
/// The load is multiplied with the tractive efforts that make it, so that an effort that is cut is as well; brakes are what they are.
fn multiplied(train: &Train, scenario: &Scenario, factor: f64) -> (Train, Scenario) {
    let mut scenario = scenario.clone();
    let is_break = matches!(scenario.event, Event::Break { .. });
    let train = if is_break { train.with_load_times(factor) } else { train.clone() };
    match &mut scenario.event {
        Event::Break { .. } => {
            let points = scenario.response.efforts.iter_mut().flat_map(|f| &mut f.points);
            points.for_each(|p| p[1] *= factor);
        }
        Event::Pulse(pulse) => *pulse = pulse.scaled(1.0, factor),
        Event::Impact { speed_m_per_s, .. } => *speed_m_per_s *= factor,
        Event::Brake { .. } => {}
    }
    (train, scenario)
}
