//! A part whose modes all have the same damping ratio.

use crate::chain::Scene;
use crate::solve::{Ask, Method, Solution, SolveError, damped_modes};

/// Extremes of every coupler of the part.
///
/// # Errors
/// [`SolveError::StepsOnly`] when a method for steps is asked for; [`SolveError::TooMuch`].
pub(super) fn solved(scene: &Scene, ratio: f64, ask: &Ask) -> Result<Solution, SolveError> {
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
