//! Many springs' forces at many instants, with each instant's sines found once for all springs.

use rayon::prelude::*;

use super::Reference;
use super::real::{Real, dd};
use crate::solve::dd::Dd;

impl Reference {
    /// Forces of `springs` at each of `times` (>= 0), to 31 digits: one row per instant.
    pub fn forces(&self, springs: &[usize], times: &[f64]) -> Vec<Vec<Dd>> {
        let row = |&t: &f64| {
            let swing = self.swing(t);
            springs.iter().map(|&i| self.force_of(i, &swing)).collect()
        };
        times.par_iter().map(row).collect()
    }

    /// `1 - cos omega_j t` of every mode, less the same since the end of the force.
    fn swing(&self, t: f64) -> Vec<Real> {
        let since = self.real(t) - self.real(self.scene.duration.min(t));
        let versine = |time: &Real, omega: &Real| self.circle.sine_and_versine(&(omega * time)).1;
        let of = |omega: &Real| versine(&self.real(t), omega) - versine(&since, omega);
        self.modes.omega.iter().map(of).collect()
    }

    fn force_of(&self, spring: usize, swing: &[Real]) -> Dd {
        let terms = self.modes.share[spring].iter().zip(swing);
        let response = terms.fold(self.real(0.0), |sum, (share, swing)| sum + share * swing);
        dd(&(response * self.real(self.scene.force) + self.real(self.scene.initial[spring])))
    }
}
