//! Dormand and Prince's method of order 8 with error estimates of orders 5 and 3, as E. Hairer and G. Wanner's DOP853
//! made it known; the implementation is the crate `differential-equations`.
//!
//! P. J. Prince, J. R. Dormand, *J. Comput. Appl. Math.* 7 (1981) 67-75; E. Hairer, S. P. Nørsett, G. Wanner, *Solving
//! Ordinary Differential Equations I*, 2nd ed., Springer 1993, sections II.5 and II.6. The tolerance limits the
//! estimated error of one step, in the mean over the state; errors of many steps add up, and the state is displacements
//! and velocities, not forces. Each instant asked for ends a step: the crate's interpolation between steps is of order 5 only.

use std::cell::Cell;

use differential_equations::prelude::*;

use super::Marched;
use super::equations::{Equations, Recorder};
use crate::chain::Scene;

/// More steps than this are given up.
const MOST_STEPS: usize = 20_000_000;

/// Marches a scene to its horizon with the relative tolerance `tolerance`.
///
/// Displacements and velocities smaller than the force gives to the stiffest spring count as of that size.
///
/// # Errors
/// Why the solver gave up: too many steps, a step too small, or a chain too stiff for it.
pub fn march(scene: &Scene, tolerance: f64, times: &[f64]) -> Result<Marched, String> {
    let equations = Equations::new(scene);
    let stiffest = scene.chain.stiffness.iter().fold(0.0f64, |a, &k| a.max(k));
    let smallest = scene.force.abs() / stiffest;
    let accelerations = Cell::new(0);
    let mut seen =
        LastStep { recorder: Recorder::new(scene, times), time: 0.0, state: vec![0.0; 2 * scene.chain.mass.len()] };
    for (from, to, force) in equations.stretches() {
        let motion = Motion { equations: &equations, force, accelerations: &accelerations };
        let mut begin = from;
        while begin < to {
            let end = seen.recorder.next_until(to).unwrap_or(to);
            if end > begin {
                run(&motion, tolerance, tolerance * smallest, begin, end, &mut seen)?;
            }
            seen.take_until(end);
            begin = end;
        }
    }
    let masses = seen.state.len() / 2;
    Ok(seen.recorder.finish(&seen.state[..masses], accelerations.get()))
}

fn run(motion: &Motion, rtol: f64, atol: f64, from: f64, to: f64, seen: &mut LastStep) -> Result<(), String> {
    let method = ExplicitRungeKutta::dop853().max_steps(MOST_STEPS).rtol(rtol).atol(atol);
    let start = seen.state.clone();
    let outcome = IVP::ode(motion, from, to, start).method(method).solout(&mut *seen).solve();
    // The solver can end a rounding error short of `to`, and calls the rest too small a step.
    let arrived = (to - seen.time).abs() <= 1e-14 * to;
    match outcome {
        Err(error) if !arrived => Err(in_short(&error)),
        _ => Ok(()),
    }
}

fn in_short(error: &Error<f64, Vec<f64>>) -> String {
    match error {
        Error::MaxSteps { t, .. } => format!("{MOST_STEPS} steps had been taken at t = {t}"),
        Error::StepSize { t, .. } => format!("the step became too small at t = {t}"),
        Error::Stiffness { t, .. } => format!("the chain was found too stiff at t = {t}"),
        _ => "the solver rejected the problem".to_owned(),
    }
}

struct Motion<'a> {
    equations: &'a Equations<'a>,
    force: f64,
    accelerations: &'a Cell<u64>,
}

impl ODE<f64, Vec<f64>> for Motion<'_> {
    fn diff(&self, _t: f64, y: &Vec<f64>, rate: &mut Vec<f64>) {
        let masses = y.len() / 2;
        let (moving, accelerating) = rate.split_at_mut(masses);
        moving.copy_from_slice(&y[masses..]);
        self.equations.accelerate(&y[..masses], self.force, accelerating);
        self.accelerations.set(self.accelerations.get() + masses as u64);
    }
}

/// Sees every step and keeps the last.
struct LastStep<'a> {
    recorder: Recorder<'a>,
    time: f64,
    state: Vec<f64>,
}

impl LastStep<'_> {
    fn take_until(&mut self, end: f64) {
        let masses = self.state.len() / 2;
        while self.recorder.next_until(end).is_some() {
            self.recorder.take(&self.state[..masses]);
        }
    }
}

impl Solout<f64, Vec<f64>> for &mut LastStep<'_> {
    fn solout<I>(
        &mut self,
        now: f64,
        _before: f64,
        state: &Vec<f64>,
        _state_before: &Vec<f64>,
        _interpolator: &mut I,
        _solution: &mut Solution<f64, Vec<f64>>,
    ) -> ControlFlag<f64, Vec<f64>>
    where
        I: Interpolation<f64, Vec<f64>> + ?Sized,
    {
        let masses = state.len() / 2;
        self.recorder.add_to_extremes(&state[..masses]);
        self.time = now;
        self.state.clone_from(state);
        ControlFlag::Continue
    }
}
