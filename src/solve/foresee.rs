//! Every spring's peaks after a step or pulse of force, guessed in single precision: levels from which a search along a march
//! may start.
//!
//! The march is that of [`super::propagator`] with longer steps and without compensated summation; only the largest and smallest values
//! at the ends of steps are kept.
//! A guess need not be proven: a search that ends below the expected levels is repeated without them.

use pulp::Simd;

use super::between::Levels;
use super::lanes::{Aligned, Layout, Rows};
use super::propagator::{Marched, StepKind, StepObserver, march};
use super::view::View;
use crate::chain::Scene;

/// Phase of a step, and terms of its series.
const PHASE: f64 = 2.5;
const TERMS: usize = 5;
/// A guess is lower than the largest value by this share of the force, far more than what single precision loses.
pub(super) const MARGIN: f64 = 1e-4;

/// What forces are expected to pass up to a mark and up to the horizon, in each scene.
pub(super) fn levels(scenes: &[Marched], marks: &[f64]) -> Vec<[Levels; 2]> {
    let springs: Vec<usize> = scenes.iter().map(|of| of.scene.initial.len()).collect();
    let layout = Layout::new(&springs);
    let zero = Aligned::new(layout.len(), 0.0);
    let levels = vec![Default::default(); scenes.len()];
    let mut guess = Guess { scenes, marks, extremes: [zero.clone(), zero], levels };
    // A unit force: the numbers are neither too large nor too small for single precision.
    march(scenes, StepKind { phase: PHASE, terms: TERMS, unit: true }, &mut guess);
    for [to_mark, to_horizon] in &mut guess.levels {
        if to_mark.is_empty() {
            to_mark.clone_from(to_horizon);
        }
    }
    guess.levels
}

/// Keeps the largest and the smallest forces.
struct Guess<'a> {
    scenes: &'a [Marched<'a>],
    marks: &'a [f64],
    extremes: [Aligned<f32>; 2],
    /// What forces are expected to pass, as far as marks and horizons are reached.
    levels: Vec<[Levels; 2]>,
}

impl Guess<'_> {
    /// What F and -F of a chain have passed, less the margin; minus infinity where that is not known.
    #[cold]
    fn level(&self, layout: Layout, chain: usize) -> Levels {
        let Scene { initial, force, .. } = self.scenes[chain].scene;
        let level = |s: usize, negative: bool| {
            let extreme = self.extremes[usize::from(negative != (*force < 0.0))][layout.place(chain, s)];
            let before = if negative { -initial[s] } else { initial[s] };
            let level = before + force.abs() * (f64::from(extreme.abs()) - MARGIN);
            if level.is_finite() { level } else { f64::NEG_INFINITY }
        };
        (0..initial.len()).map(|s| [level(s, false), level(s, true)]).collect()
    }
}

impl StepObserver<f32> for Guess<'_> {
    #[inline(always)]
    fn see<S: Simd, const H: usize>(&mut self, v: Rows<S, H, f32>, view: &View<f32>) {
        for chain in 0..self.scenes.len() {
            let step = view.step(chain);
            if self.levels[chain][0].is_empty() && step.end() > self.marks[chain] {
                self.levels[chain][0] = self.level(view.layout, chain);
            }
        }
        let [largest, smallest] = &mut self.extremes;
        for ((largest, smallest), force) in
            v.of_mut(largest).iter_mut().zip(v.of_mut(smallest)).zip(v.of(view.force[1]))
        {
            *largest = v.max(*largest, *force);
            *smallest = v.min(*smallest, *force);
        }
        // A scene's last step ends at its horizon; a mark there has no level of its own yet.
        for chain in (0..self.scenes.len()).filter(|&chain| view.is_last(chain)) {
            self.levels[chain][1] = self.level(view.layout, chain);
        }
    }
}
