//! The elastic rod: what a continuum model gives, [P] section 3, eqs (30) and (31).
//!
//! Long waves in a chain of equal masses and springs travel one spring in `sqrt(mass / stiffness)` and keep their shape. In
//! the rod all waves do, so a step of force stays a step: by d'Alembert's method the force at a place is a sum of steps,
//!
//! ```text
//! F(x, t) = F(x, 0) + P sum over images a of  +-1/2 H(t - |x - a|),
//! ```
//!
//! plus behind an image, minus before it, and a second set of opposite sign from the end of a pulse. An end of the rod
//! that is free mirrors the force, a held one mirrors it and turns its sign. The rod that stands for the chain reaches
//! half a spring beyond a free end's mass, to a held end's mass itself; a force on an end mass acts on the rod's end.
//! A coupler's place is its middle. Every level is a whole multiple of half the force, and none passes what the loads
//! make at rest: the overloads of [P] figures 4 and 5 occur in the chain only.
//!
//! Under a constant force the motion of a rod of length L repeats every `T = 4 L / c` (four transits), and so does the
//! motion after the force ends: later times are mapped to the first period, however long the horizon.

use crate::chain::Scene;
use crate::solve::closed_form::equal;

/// The rod that stands for an equal chain, with its scene.
#[derive(Clone, Debug)]
pub struct Rod<'a> {
    scene: &'a Scene,
    /// `sqrt(mass / stiffness)`
    unit: f64,
    /// Place and sign of each image of the force, in springs from the first mass; half a unit of force each.
    images: Vec<(f64, f64)>,
    /// T
    recurrence: f64,
    /// The force's duration less whole periods T, and the time up to which arrivals are needed.
    duration: f64,
    horizon: f64,
}

impl Rod<'_> {
    /// The rod of a scene; `None` if the chain's masses or stiffnesses differ.
    pub fn new(scene: &Scene) -> Option<Rod<'_>> {
        let (mass, stiffness) = equal(&scene.chain)?;
        let unit = (mass / stiffness).sqrt();
        let last = scene.chain.mass.len() - 1;
        let (head, tail) = (scene.chain.held_head, scene.chain.held_tail);
        let (front, rear) = (if head { 0.0 } else { -0.5 }, last as f64 + if tail { 0.0 } else { 0.5 });
        let (front_sign, rear_sign) = (if head { -1.0 } else { 1.0 }, if tail { -1.0 } else { 1.0 });
        let place = match scene.source {
            0 => front,
            s if s == last => rear,
            s => s as f64,
        };
        let period = 2.0 * (rear - front);
        let recurrence = 2.0 * period * unit;
        let duration = match scene.duration {
            long if long > 2.0 * recurrence && long < scene.horizon => recurrence + long % recurrence,
            short => short,
        };
        let horizon = match scene.duration < scene.horizon {
            true => (duration + recurrence).min(scene.horizon - (scene.duration - duration)),
            false => recurrence.min(scene.horizon),
        };
        let rounds = (horizon / unit / period).ceil() as i64 + 1;
        let image = |k: i64| {
            let sign = if k % 2 == 0 { 1.0 } else { front_sign * rear_sign };
            let shift = k as f64 * period;
            [(place + shift, sign), (2.0 * front - place + shift, front_sign * sign)]
        };
        let images = (-rounds..=rounds).flat_map(image).collect();
        Some(Rod { scene, unit, images, recurrence, duration, horizon })
    }

    /// Arrivals at a spring's place: times and changes of force, ascending, up to `self.horizon`.
    fn arrivals(&self, spring: usize) -> Vec<(f64, f64)> {
        let x = spring as f64 + 0.5;
        let step = |&(a, sign): &(f64, f64)| {
            let half = if x > a { 0.5 } else { -0.5 };
            (self.unit * (x - a).abs(), sign * half * self.scene.force)
        };
        let begun: Vec<(f64, f64)> = self.images.iter().map(step).collect();
        let ended = begun.iter().map(|&(t, f)| (t + self.duration, -f));
        let mut all: Vec<(f64, f64)> = begun.iter().copied().chain(ended).filter(|a| a.0 <= self.horizon).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all
    }

    /// Largest and smallest force at a spring's place over 0 <= t <= horizon, t = 0 included.
    pub fn extremes(&self, spring: usize) -> (f64, f64) {
        let initial = self.scene.initial[spring];
        let arrivals = self.arrivals(spring);
        let (mut change, mut high, mut low) = (0.0, initial, initial);
        for (n, &(time, step)) in arrivals.iter().enumerate() {
            change += step;
            // Arrivals at one instant, up to rounding, count as one.
            let alone = arrivals.get(n + 1).is_none_or(|next| next.0 - time > 1e-12 * self.horizon);
            if alone {
                (high, low) = (high.max(initial + change), low.min(initial + change));
            }
        }
        (high, low)
    }

    /// Force at a spring's place at given times.
    pub fn history(&self, spring: usize, times: &[f64]) -> Vec<f64> {
        let arrivals = self.arrivals(spring);
        let mapped_time = |t: f64| match t < self.scene.duration {
            true if t > self.recurrence => t % self.recurrence,
            true => t,
            false => self.duration + (t - self.scene.duration) % self.recurrence,
        };
        let change = |t: f64| arrivals.iter().take_while(|a| a.0 <= t).map(|a| a.1).sum::<f64>();
        let at = |&t: &f64| self.scene.initial[spring] + change(mapped_time(t));
        times.iter().map(at).collect()
    }
}

#[cfg(test)]
mod tests;
