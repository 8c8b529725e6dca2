//! Sums over modes that all have the same share of critical damping.
//!
//! ```text
//! step     F_i(t) = F0_i + P [ s_i - sum_j a_ij D_j(t) ]
//! D_j(t) = e^(-z w t) [ cos(d t) + z / sqrt(1 - z^2) sin(d t) ]      w = omega_j,  d = w sqrt(1 - z^2)
//! ```
//!
//! with z the damping ratio, and a_ij, s_i as without damping ([`super::sums`]). This damping acts on modes,
//! not as dashpots: the couplers' forces are those of their springs. After a pulse every mode swings on from where it
//! is. Within a cell of time a mode's Taylor series follows from its equation `q'' = -w^2 q - 2 z w q'`; on cells of
//! half width r with `w r <= 1` the 25 terms are exact to rounding, and the springs' series are a matrix product.

use nalgebra::{DMatrix, DVector};

use super::dd::Dd;
use super::local::{COEFFICIENTS, Local};
use super::statics;
use super::sums::{Modes, larger_bound, missed};
use super::watch::{SpringPeaks, Watch, bound_of_extremes};
use super::{Work, closed_form, modal};
use crate::chain::Scene;

const ROUNDOFF: f64 = f64::EPSILON / 2.0;
/// Largest half width of a cell times frequency.
const PHASE: f64 = 1.0;
/// Nanoseconds for a product of the matrix products.
const PRODUCT: f64 = 0.5;

/// A scene whose modes are damped alike.
pub struct Damped<'a> {
    scene: &'a Scene,
    ratio: f64,
    modes: Modes,
    mean: Vec<f64>,
}

/// A stretch of constant force: where the modes stand at its beginning, as q and q' / w.
struct Stretch {
    from: f64,
    to: f64,
    start: Vec<[f64; 2]>,
    /// Forces about which the springs swing.
    mean: Vec<f64>,
}

impl Stretch {
    /// Time since its beginning: one `f64` would be off by half a unit of t's last place, too much for fast modes.
    fn since(&self, t: f64) -> Dd {
        Dd::from(t) - Dd::from(self.from)
    }
}

/// Estimated time, s.
pub fn estimate_s(scene: &Scene) -> f64 {
    let n = scene.initial.len() as f64;
    let cells = scene.horizon * super::propagator::omega_max(scene) / (2.0 * PHASE) + 2.0;
    1e-9 * n * n * (modal::MODE_ENTRY + PRODUCT * cells * COEFFICIENTS as f64)
}

impl<'a> Damped<'a> {
    /// Modes by the closed form where there is one; `ratio` is over 0 and under 1.
    pub fn new(scene: &'a Scene, ratio: f64) -> Damped<'a> {
        let modes = closed_form::modes(scene).unwrap_or_else(|| modal::modes(scene));
        Damped { scene, ratio, modes, mean: statics::unit_force(&scene.chain, scene.source) }
    }

    /// Bound on the error of every extreme up to the horizon.
    pub fn error_bound(&self) -> f64 {
        bound_of_extremes(self.bound_of_values())
    }

    /// Bound on the error of every force up to the horizon.
    ///
    /// A mode's coordinate is at most `1 / sqrt(1 - z^2)`, counted as `1 / (1 - z^2)`, and is wrong by 16 roundings of an exponential, a
    /// cosine and their factors; a sum over m modes by m roundings of its terms. Residuals of numerical modes count as without
    /// damping, which makes their effect no larger. Times since the beginning of a stretch are double-double, without error.
    fn bound_of_values(&self) -> f64 {
        let m = self.modes.omega.len() as f64;
        let swing = 1.0 / (1.0 - self.ratio * self.ratio);
        let stretches = if self.scene.duration < self.scene.horizon { 2.0 } else { 1.0 };
        let force = stretches * self.scene.force.abs();
        let spring = |i: usize| {
            let size: f64 = self.modes.share.row(i).iter().map(|a| a.abs()).sum();
            let mean = self.scene.initial[i].abs() + 4.0 * force;
            (force * size * swing * (16.0 + m) + mean) * ROUNDOFF + missed(self.scene, &self.modes, i)
        };
        (0..self.scene.initial.len()).map(spring).fold(0.0, larger_bound)
    }

    /// A mode's q and q' / w after a time, from those at its beginning.
    fn swing(&self, omega: Dd, [q, p]: [f64; 2], time: Dd) -> [f64; 2] {
        let z = self.ratio;
        let root = (Dd::ONE - Dd::product(z, z)).sqrt();
        let (sin, cos) = (omega * root).phase_of(time).sin_cos();
        let decay = (-z * omega.hi * time.hi).exp();
        let sine = sin / root.hi;
        [decay * (q * cos + (p + z * q) * sine), decay * (p * cos - (q + z * p) * sine)]
    }

    /// `1 - D` and `-D' / w` after a step has acted for a time, accurate for short ones.
    fn step_response(&self, omega: Dd, time: f64) -> [f64; 2] {
        let z = self.ratio;
        let root = (Dd::ONE - Dd::product(z, z)).sqrt();
        let phase = (omega * root).phase_of(Dd::from(time));
        let decay = -z * omega.hi * time;
        let sine = phase.sin() / root.hi;
        let half = (0.5 * phase).sin();
        let q = -decay.exp_m1() + decay.exp() * (2.0 * half * half - z * sine);
        [q, decay.exp() * sine]
    }

    fn stretches(&self) -> Vec<Stretch> {
        let Scene { force, duration, horizon, .. } = *self.scene;
        let mean = self.mean.iter().zip(&self.scene.initial).map(|(s, f)| f + force * s).collect();
        let start = vec![[-force, 0.0]; self.modes.omega.len()];
        let step = Stretch { from: 0.0, to: horizon.min(duration), start, mean };
        if duration >= horizon {
            return vec![step];
        }
        let step_response = |w: &Dd| self.step_response(*w, duration).map(|x| force * x);
        let start = self.modes.omega.iter().map(step_response).collect();
        vec![step, Stretch { from: duration, to: horizon, start, mean: self.scene.initial.clone() }]
    }

    /// Extremes of every spring's force, up to the horizon and up to a mark before it.
    pub fn peaks(&self, mark: Option<f64>) -> ([Vec<SpringPeaks>; 2], Work) {
        let mut watch = Watch::new(self.scene, self.bound_of_values());
        let mut to_mark = None;
        let mut work = Work::default();
        let fastest = self.modes.omega.last().map_or(1.0, |w| w.hi);
        for stretch in self.stretches() {
            let count = ((stretch.to - stretch.from) * fastest / (2.0 * PHASE)).ceil().max(1.0);
            let radius = 0.5 * (stretch.to - stretch.from) / count;
            let edge = |n: u64| if n == count as u64 { stretch.to } else { stretch.from + 2.0 * n as f64 * radius };
            for n in 0..count as u64 {
                // Edges and centre are rounded: the cell reaches to both edges, and ends at the second one.
                let (a, b) = (edge(n), edge(n + 1));
                let center = 0.5 * (a + b);
                let radius = (b - center).max(center - a);
                let end = |until: f64| (until - center) / radius;
                let cut = mark.filter(|mark| a < *mark && *mark <= b);
                to_mark = cut.map(|mark| watch.until(mark)).or(to_mark);
                let series = &self.modes.share * self.series(&stretch, center, radius);
                work.mode_sums += (series.len() * self.modes.omega.len()) as u64;
                for i in 0..stretch.mean.len() {
                    let mut coefficient = [0.0; COEFFICIENTS];
                    coefficient.iter_mut().enumerate().for_each(|(k, c)| *c = series[(i, k)]);
                    coefficient[0] += stretch.mean[i];
                    let local = Local { coefficient, terms: COEFFICIENTS, center, radius };
                    show(&mut watch, i, &local, end(b), &mut work);
                    if let (Some(mark), Some(watch)) = (cut, &mut to_mark) {
                        show(watch, i, &local, end(mark), &mut work);
                    }
                }
            }
        }
        let decided = |mut watch: Watch| {
            watch.decide_all_at_rating();
            watch.peaks
        };
        ([decided(watch), to_mark.map_or_else(Vec::new, decided)], work)
    }

    /// Every mode's Taylor coefficients about an instant: modes x coefficients.
    fn series(&self, stretch: &Stretch, center: f64, radius: f64) -> DMatrix<f64> {
        let mut all = DMatrix::zeros(self.modes.omega.len(), COEFFICIENTS);
        for (j, (w, start)) in self.modes.omega.iter().zip(&stretch.start).enumerate() {
            let [q, p] = self.swing(*w, *start, stretch.since(center));
            let turn = w.hi * radius;
            (all[(j, 0)], all[(j, 1)]) = (q, turn * p);
            for k in 0..COEFFICIENTS - 2 {
                let pull = turn * turn * all[(j, k)] + 2.0 * self.ratio * turn * (k + 1) as f64 * all[(j, k + 1)];
                all[(j, k + 2)] = -pull / ((k + 1) * (k + 2)) as f64;
            }
        }
        all
    }

    /// Forces of one spring at given times.
    pub fn history(&self, spring: usize, times: &[f64]) -> Vec<f64> {
        let stretches = self.stretches();
        let at = |&t: &f64| {
            let stretch = stretches.iter().rev().find(|s| t >= s.from).unwrap_or(&stretches[0]);
            let mode = |j: usize| {
                self.modes.share[(spring, j)] * self.swing(self.modes.omega[j], stretch.start[j], stretch.since(t))[0]
            };
            stretch.mean[spring] + (0..self.modes.omega.len()).map(mode).sum::<f64>()
        };
        times.iter().map(at).collect()
    }

    /// Forces of every spring at given times, ascending: calls `see(index of the time, spring, force)` for each.
    pub fn field(&self, times: &[f64], see: &mut dyn FnMut(usize, usize, f64)) {
        let stretches = self.stretches();
        for (n, &t) in times.iter().enumerate() {
            let stretch = stretches.iter().rev().find(|s| t >= s.from).unwrap_or(&stretches[0]);
            let modes = self.modes.omega.iter().zip(&stretch.start);
            let swings = modes.map(|(w, start)| self.swing(*w, *start, stretch.since(t))[0]);
            let change = &self.modes.share * DVector::from_iterator(self.modes.omega.len(), swings);
            stretch.mean.iter().zip(&change).enumerate().for_each(|(s, (mean, c))| see(n, s, mean + c));
        }
    }
}

/// Shows a cell of a spring's force to the watch, where it may matter.
fn show(watch: &mut Watch, spring: usize, local: &Local, end: f64, work: &mut Work) {
    let ends = [local.value_and_slope(-1.0).0, local.value_and_slope(1.0).0];
    let bend: f64 = (2..local.terms).map(|k| (k * (k - 1)) as f64 * local.coefficient[k].abs()).sum();
    for negative in [false, true] {
        let sign = if negative { -1.0 } else { 1.0 };
        if (sign * ends[0]).max(sign * ends[1]) + 0.5 * bend > watch.level(spring, negative) {
            work.refinements += 1;
            watch.note(spring, negative, local, end, |t| local.value_at(t));
        } else if watch.at_rating(spring, negative) {
            watch.note_left_rating(spring, negative, sign * local.value_and_slope(end).0);
        }
    }
}
