//! A scenario's map: the smallest overloading pulse by duration, or the safe load by broken coupler.

use rayon::prelude::*;
use serde::Serialize;

use super::case::Case;
use super::{Options, safe_factor};
use crate::rod::Rod;
use crate::scenario::{self, Motion, Part};
use crate::solve::SolveError;
use crate::solve::responses::Shared;
use crate::train::{Event, Scenario, Train};

/// Durations in a pulse's map.
const DURATIONS: usize = 33;

/// A scenario's map.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MapFindings {
    /// `"duration_s"` for a pulse, `"broken_coupler"` for a break.
    pub over: &'static str,
    /// `"overloading_force_n"` for a pulse, `"safe_load_factor"` for a break.
    pub value: &'static str,
    /// In rising order.
    pub points: Vec<MapPoint>,
}

/// A point of a map.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MapPoint {
    /// Duration of the pulse, s, or the coupler that breaks, counted from 1.
    pub at: f64,
    /// Smallest force, N, of the scenario's sign, over which a coupler exceeds its rating, or the largest factor on the load at
    /// which none does; `None` where nothing bounds it.
    pub chain: Option<f64>,
    /// What the elastic rod says, in the same unit and sign; `None` where the train has none or nothing bounds it.
    pub rod: Option<f64>,
}

/// The map of a scenario; `None` for an impact, whose one number is its safe speed.
///
/// A pulse's duration runs from a tenth of the time unit to twice the transit, in equal ratios; breaks are those of every
/// coupler that can part. All else stays as the scenario has it: forces are linear in the factor, so that each point costs one case.
///
/// # Errors
/// As for a case.
pub(super) fn find(train: &Train, scenario: &Scenario, options: &Options) -> Result<Option<MapFindings>, SolveError> {
    if !scenario::is_proportional(train, scenario) {
        return Ok(None);
    }
    let alone = Scenario { cascade: crate::train::Rule::Keep, ..scenario.clone() };
    let wave = scenario::wave(train);
    let (over, value, variants): (_, _, Vec<(f64, Option<usize>, Event)>) = match &scenario.event {
        Event::Impact { .. } | Event::Brake { .. } => return Ok(None),
        Event::Break { .. } => {
            let each = mapped_couplers(train, &scenario.event).into_iter();
            let each = each.map(|b| (b as f64 + 1.0, Some(b), scenario.event.clone()));
            ("broken_coupler", "safe_load_factor", each.collect())
        }
        Event::Pulse(pulse) => {
            let (shortest, longest) = (0.1 * wave.time_unit_s, 2.0 * wave.transit_s);
            let at = |i: usize| shortest * (longest / shortest).powf(i as f64 / (DURATIONS - 1) as f64);
            let with_duration =
                (0..DURATIONS).map(|i| (at(i), None, Event::Pulse(pulse.scaled(at(i) / pulse.duration_s, 1.0))));
            ("duration_s", "overloading_force_n", with_duration.collect())
        }
    };
    let points = variants.into_par_iter().map(|(at, broken, event)| {
        let variant = Scenario { event, ..alone.clone() };
        let unit = match &variant.event {
            Event::Pulse(pulse) => pulse.force_n,
            _ => 1.0,
        };
        let case = Case::new(train, &variant, broken, options, Shared::Nothing);
        let chain = case.safe_load_factor(&case.solve()?);
        let rod = rod_factor(train, &variant, broken);
        let scaled = |factor: Option<f64>| factor.map(|f| f * unit);
        Ok(MapPoint { at, chain: scaled(chain), rod: scaled(rod) })
    });
    Ok(Some(MapFindings { over, value, points: points.collect::<Result<_, _>>()? }))
}

/// Couplers in a map of breaks: every one but those in buff, which do not part, unless the event breaks them.
fn mapped_couplers(train: &Train, event: &Event) -> Vec<usize> {
    let mut mapped_couplers: Vec<bool> = train.initial_force_n().iter().map(|force| *force >= 0.0).collect();
    if let Event::Break { couplers } = event {
        couplers.iter().for_each(|&b| mapped_couplers[b] = true);
    }
    (0..mapped_couplers.len()).filter(|&b| mapped_couplers[b]).collect()
}

/// How many cases a map has.
pub(super) fn cases(train: &Train, event: &Event) -> usize {
    match event {
        Event::Impact { .. } | Event::Brake { .. } => 0,
        Event::Break { .. } => mapped_couplers(train, event).len(),
        Event::Pulse(_) => DURATIONS,
    }
}

/// The rod's safe factor: `None` where there is no rod, or nothing bounds it.
fn rod_factor(train: &Train, scenario: &Scenario, broken: Option<usize>) -> Option<f64> {
    if Motion::of(train, scenario) != Motion::Steps {
        return None;
    }
    let horizon_s = scenario::horizon_s(train, scenario, broken);
    let mut least: Option<f64> = None;
    for Part { scene, .. } in &scenario::parts(train, &scenario.event, broken, horizon_s) {
        let rod = Rod::new(scene)?;
        for i in 0..scene.initial.len() {
            let (high, low) = rod.extremes(i);
            // After a break all forces are in proportion to the load; a pulse's load stays as it is.
            let rest = if broken.is_some() { 0.0 } else { scene.initial[i] };
            let sides = [(high - rest, scene.rated_draft[i] - rest), (rest - low, scene.rated_buff[i] + rest)];
            let factors = sides.into_iter().filter_map(|(growth, room)| safe_factor::of_side(growth, room));
            least = factors.chain(least).reduce(f64::min);
        }
    }
    least
}
