//! The part of a scene's results that a row of a fleet needs: the worst spring, every verdict, the earliest exceedance.
//!
//! A spring is examined only where it may pass the level that another spring has certainly reached. Whether it passes its
//! rating is always examined; the time at which it does is not, once another spring has passed its own rating earlier.

use super::between::Step;

/// What the springs of a scene have certainly reached.
#[derive(Clone, Debug)]
pub struct Lead {
    /// The largest utilisation.
    utilisation: f64,
    /// Some spring has passed its rating before this time.
    pub crossed: f64,
    /// How far below the level reached a force may be and still be the worst, or one that the error bound cannot distinguish from it.
    margin: f64,
}

impl Lead {
    /// Before the event; `bound` is the error bound of all forces to come.
    ///
    /// Forces that the error bound cannot distinguish count as equal, and the first of them is taken.
    pub fn new(bound: f64) -> Lead {
        Lead { utilisation: 0.0, crossed: f64::INFINITY, margin: 4.0 * bound }
    }

    /// A force that is certainly reached.
    #[inline]
    pub fn reach(&mut self, force: f64, rating: f64) {
        self.utilisation = self.utilisation.max(force / rating);
    }

    /// Some spring passes its rating within a step. The next step still counts: where it begins is rounded.
    pub fn cross(&mut self, step: &Step) {
        self.crossed = self.crossed.min(step.from + 1.5 * step.width);
    }

    /// A force must pass this to be the worst, or like it.
    #[inline]
    pub fn level(&self, rating: f64) -> f64 {
        self.utilisation * rating - self.margin
    }

    /// Whether levels that were made for another lead are out of date by more than a thousandth.
    pub fn is_far_from(&self, other: &Lead) -> bool {
        self.utilisation > 1.001 * other.utilisation || self.crossed != other.crossed
    }
}
