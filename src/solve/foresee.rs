//! Every spring's peaks after a step or pulse of force, guessed in single precision: levels from which a search along a march
//! may start.
//!
//! The steps are those of [`super::propagator`], longer, without compensation, and only the largest values at their ends are kept.
//! A guess need not be proven: a search that ends below the expected levels is repeated without them.

use pulp::Simd;

use super::between::Levels;
use super::lanes::{Aligned, Layout, Rows};
use super::motion::Motion;
use super::propagator::{StepObserver, Steps, View, march};
use crate::chain::Scene;

/// Phase of a step, and terms of its series.
const PHASE: f64 = 2.5;
const TERMS: usize = 5;
/// A guess is lower than the largest value by this share of the force, far more than what single precision loses.
pub(super) const MARGIN: f64 = 1e-4;

/// What forces are expected to pass up to a mark and up to the horizon.
pub(super) fn levels(scene: &Scene, motion: &Motion, omega: f64, mark: f64) -> [Levels; 2] {
    let layout = Layout::new(scene.initial.len());
    let zero = Aligned::new(layout.len(), 0.0);
    let mut guess = Guess { mark, to_mark: None, extremes: [zero.clone(), zero] };
    // A unit force: the numbers are small enough for single precision.
    march(scene, motion, Steps { phase: PHASE, omega, terms: TERMS }, 1.0, &mut guess);
    let Guess { to_mark, extremes, .. } = guess;
    [to_mark.as_ref().unwrap_or(&extremes), &extremes].map(|extremes| levels_of(scene, layout, extremes))
}

/// What F and -F have passed, less the margin; minus infinity where that is not known.
fn levels_of(scene: &Scene, layout: Layout, extremes: &[Aligned<f32>; 2]) -> Levels {
    let level = |s: usize, negative: bool| {
        let extreme = extremes[usize::from(negative != (scene.force < 0.0))][layout.place(s)];
        let initial = if negative { -scene.initial[s] } else { scene.initial[s] };
        let level = initial + scene.force.abs() * (f64::from(extreme.abs()) - MARGIN);
        if level.is_finite() { level } else { f64::NEG_INFINITY }
    };
    (0..scene.initial.len()).map(|s| [level(s, false), level(s, true)]).collect()
}

/// Keeps the largest and the smallest forces.
struct Guess {
    mark: f64,
    /// Those up to the mark, once it is passed.
    to_mark: Option<[Aligned<f32>; 2]>,
    extremes: [Aligned<f32>; 2],
}

impl StepObserver<f32> for Guess {
    #[inline(always)]
    fn see<S: Simd, const H: usize>(&mut self, v: Rows<S, H, f32>, view: &View<f32>) {
        if self.to_mark.is_none() && view.step.from + view.step.width > self.mark {
            self.to_mark = Some(self.extremes.clone());
        }
        let [largest, smallest] = &mut self.extremes;
        for ((largest, smallest), force) in
            v.of_mut(largest).iter_mut().zip(v.of_mut(smallest)).zip(v.of(view.force[1]))
        {
            *largest = v.max(*largest, *force);
            *smallest = v.min(*smallest, *force);
        }
    }
}
