//! Forces of every spring at many instants, for pictures: right to a line's width, and no error bound.

use super::{closed_form, damped_modes::Damped, modal, observers, propagator, sums};
use crate::chain::Scene;

/// Most springs times steps, or products, for a picture: under a second.
const MOST: f64 = 2e8;
/// A step of fewer springs takes as long as one of this many.
const FEWEST: f64 = 32.0;
/// Steps are so many times finer than the method needs, as far as they are affordable: the cubic between their ends is then
/// right to 5 / 384 (1.5 / 3)^4 = 8e-4 of the fastest mode's amplitude.
const FINER: [f64; 3] = [3.0, 2.0, 1.0];

/// Receives an instant's index, a spring and its force.
pub type Sink<'a> = &'a mut dyn FnMut(usize, usize, f64);

/// Forces in all springs of a scene at times that ascend from 0 to its horizon; false if that takes too long.
pub(crate) fn of_scene(scene: &Scene, damping_ratio: f64, times: &[f64], see: Sink) -> bool {
    let springs = scene.initial.len() as f64;
    let by_modes = springs * springs * times.len() as f64 <= MOST;
    if damping_ratio > 0.0 {
        if by_modes {
            Damped::new(scene, damping_ratio).field(times, see);
        }
        return by_modes;
    }
    if scene.force == 0.0 {
        (0..times.len()).for_each(|n| scene.initial.iter().enumerate().for_each(|(s, &steady)| see(n, s, steady)));
        return true;
    }
    let omega = propagator::omega_max(scene);
    let march = springs.max(FEWEST) * propagator::steps(scene, omega);
    if let Some(finer) = FINER.into_iter().find(|f| f * march <= MOST) {
        observers::field(scene, finer * omega, times, see);
        return true;
    }
    if by_modes {
        let modes = closed_form::modes(scene).unwrap_or_else(|| modal::modes(scene));
        sums::field(scene, &modes, times, see);
    }
    by_modes
}
