//! Forces over time, for figures.

use crate::chain::Scene;
use crate::march::{self, MarchOptions};
use crate::rod::Rod;
use crate::scenario::{self, Motion, Part, Scales};
use crate::solve::{self, damped_modes};
use crate::train::{Rule, Train};

/// Force in one coupler at given times, N, draft positive: what a figure shows.
///
/// `scenario` is an index into the train's scenarios; `broken` and `coupler` are indices from 0. Accurate to the width of a drawn
/// line.
pub fn history(train: &Train, scenario: usize, broken: Option<usize>, coupler: usize, times_s: &[f64]) -> Vec<f64> {
    let motion = Motion::of(train, &train.scenarios()[scenario]);
    if motion == Motion::March {
        let scenario = &train.scenarios()[scenario];
        let last_s = times_s.iter().copied().fold(0.0, f64::max);
        // A march up to t = 0 takes no step, and so gives no force: it goes on to the horizon.
        let until_s = if last_s > 0.0 { last_s } else { scenario::horizon_s(train, scenario, broken) };
        let problem = scenario::march(train, scenario, broken, [until_s; 2], Rule::Keep);
        let ask = MarchOptions { history: vec![coupler], times_s: times_s.to_vec(), ..MarchOptions::default() };
        let mut forces_n = vec![f64::NAN; times_s.len()];
        march::follow(&problem, &ask, &mut |instant, _, force_n| forces_n[instant] = force_n);
        return forces_n;
    }
    let forces = in_part(train, scenario, broken, coupler, times_s, |scene, i, t| match motion {
        Motion::DampedModes(ratio) => Some(damped_modes::Damped::new(scene, ratio).history(i, t)),
        _ => Some(solve::history(scene, i, t)),
    });
    forces.unwrap_or_else(|| vec![0.0; times_s.len()])
}

/// The force over time in the elastic rod; `None` where the coupler's part has no rod.
pub fn rod_history(
    train: &Train,
    scenario: usize,
    broken: Option<usize>,
    coupler: usize,
    times_s: &[f64],
) -> Option<Vec<f64>> {
    if Motion::of(train, &train.scenarios()[scenario]) != Motion::Steps {
        return None;
    }
    in_part(train, scenario, broken, coupler, times_s, |scene, i, t| Some(Rod::new(scene)?.history(i, t)))
}

/// Forces from the part with this coupler, computed in the solvers' units; `None` for the broken coupler.
fn in_part(
    train: &Train,
    scenario: usize,
    broken: Option<usize>,
    coupler: usize,
    times_s: &[f64],
    ask: impl Fn(&Scene, usize, &[f64]) -> Option<Vec<f64>>,
) -> Option<Vec<f64>> {
    let scenario = &train.scenarios()[scenario];
    let horizon_s = scenario::horizon_s(train, scenario, broken);
    let scales = Scales::of(train);
    let parts = scenario::parts(train, &scenario.event, broken, horizon_s);
    let has_coupler = |p: &&Part| (p.first_coupler..p.first_coupler + p.scene.initial.len()).contains(&coupler);
    let part = parts.iter().find(has_coupler)?;
    let times: Vec<f64> = times_s.iter().map(|t| t / scales.time_s).collect();
    let forces = ask(&part.scene, coupler - part.first_coupler, &times)?;
    Some(forces.into_iter().map(|f| f * scales.force_n).collect())
}
