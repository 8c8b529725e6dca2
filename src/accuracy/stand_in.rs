//! A reference of the crate's own modal sums.

use crate::chain::Scene;
use crate::solve::local::Point;
use crate::solve::sums::{self, Modes};
use crate::solve::{closed_form, modal};

pub struct Reference<'a> {
    scene: &'a Scene,
    modes: Modes,
    extremes: Vec<[Point; 2]>,
}

impl<'a> Reference<'a> {
    pub fn new(scene: &'a Scene) -> Reference<'a> {
        let modes = closed_form::modes(scene).unwrap_or_else(|| modal::modes(scene));
        let (peaks, _) = sums::peaks(scene, &modes);
        let extremes = peaks.iter().map(|p| [p.draft.best, p.buff.best]).collect();
        Reference { scene, modes, extremes }
    }

    pub fn error_of(&self, spring: usize, t: f64, claimed: f64) -> f64 {
        claimed - sums::history(self.scene, &self.modes, spring, &[t])[0]
    }

    pub fn extremes(&self) -> &[[Point; 2]] {
        &self.extremes
    }
}
