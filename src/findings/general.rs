//! Cases that steps of force on an undamped chain at rest cannot represent: the whole train by Taylor series.

use super::solved::{PeriodFindings, Solved};
use super::{CouplerFindings, CouplerPeaks, Options, coupler_findings, worst};
use crate::chain::Scene;
use crate::play::Rule;
use crate::scenario::{self, Scales};
use crate::solve::watch::SpringPeaks;
use crate::solve::{Ask, Method, Solution, SolveError, damped_modes, taylor};
use crate::train::{Event, Pulse, PulseShape, Scenario, Train};

/// Extremes of every coupler but the broken one.
///
/// # Errors
/// [`SolveError::StepsOnly`] when a method for steps is asked for; [`SolveError::TooMuch`].
pub(super) fn solved(
    train: &Train,
    scenario: &Scenario,
    broken: Option<usize>,
    [horizon_s, mark_s]: [f64; 2],
    options: &Options,
) -> Result<Solved, SolveError> {
    if let Some(method) = options.method {
        return Err(SolveError::StepsOnly(method.name()));
    }
    let scales = Scales::of(train);
    let play = scenario::play(train, scenario, broken, horizon_s, Rule::Keep);
    let mark = (mark_s < horizon_s).then_some(mark_s / scales.time_s);
    let outcome = taylor::solve_to_mark(&play, mark)?;
    let before_n = scenario::initial_force_n(train, &scenario.event);
    let error_bound_n = outcome.error_bound * scales.force_n;
    let within = |springs: &[SpringPeaks]| {
        let others = springs.iter().enumerate().filter(|(i, _)| Some(*i) != broken);
        let couplers = others.map(|(i, peaks)| CouplerFindings {
            initial_force_n: before_n[i],
            ..coupler_findings(train, i, &CouplerPeaks::new(peaks, &scales, error_bound_n), None)
        });
        let couplers: Vec<CouplerFindings> = couplers.collect();
        PeriodFindings { worst: worst(&couplers, 0..couplers.len(), error_bound_n), couplers }
    };
    let PeriodFindings { couplers, worst } = within(&outcome.springs);
    Ok(Solved {
        method: "taylor",
        reason: reason(train, &scenario.event).to_owned(),
        error_bound_n,
        error_estimate_n: None,
        worst,
        couplers,
        left_out: Vec::new(),
        to_mark: mark.map(|_| within(&outcome.to_mark)),
        marched: None,
    })
}

/// A part whose modes are all damped alike.
///
/// # Errors
/// As for [`solved`].
pub(super) fn damped(scene: &Scene, ratio: f64, ask: &Ask) -> Result<Solution, SolveError> {
    if let Some(method) = ask.method {
        return Err(SolveError::StepsOnly(method.name()));
    }
    let seconds = damped_modes::estimate_s(scene);
    let gigabytes = 64e-9 * (scene.initial.len() as f64).powi(2);
    if seconds > 3600.0 || gigabytes > 4.0 {
        let advice = "dashpots instead of a damping ratio take less".to_owned();
        return Err(SolveError::TooMuch { method: "damped-modes", seconds, gigabytes, advice });
    }
    let damped = damped_modes::Damped::new(scene, ratio);
    let ([springs, to_mark], work) = damped.peaks(ask.mark);
    Ok(Solution {
        method: Method::Modal,
        reason: "every mode has the same damping ratio".to_owned(),
        error_bound: damped.error_bound(),
        springs: springs.into_iter().map(Some).collect(),
        to_mark: to_mark.into_iter().map(Some).collect(),
        only_worst: false,
        all_time_bounds: None,
        work,
    })
}

/// Estimated time, s.
pub(super) fn estimate_s(train: &Train, scenario: &Scenario, broken: Option<usize>, until_s: f64, rule: Rule) -> f64 {
    taylor::estimate_s(&scenario::play(train, scenario, broken, until_s, rule))
}

fn reason(train: &Train, event: &Event) -> &'static str {
    match event {
        Event::Impact { .. } => "the train is set in motion by speeds, not by a force",
        Event::Pulse(Pulse { shape, .. }) if *shape != PulseShape::Rectangle => "the force changes while it acts",
        _ if !train.extras().dashpot_n_s_per_m.is_empty() => "dashpots couple the modes",
        _ => "nothing else fits",
    }
}
