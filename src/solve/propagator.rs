//! Steps that are exact in time, for any chain: leapfrog with its kick and drift replaced by functions of A.
//!
//! Over a step h a mode of frequency omega turns by theta = omega h. A rotation is three shears (kick, drift, kick):
//!
//! ```text
//! kick    v <- v + (h / 2) [tan(theta/2) / (theta/2)] dv/dt
//! drift   G <- G + h [sin(theta) / theta] dG/dt
//! kick    as above; two kicks in a row are one of twice the size
//! ```
//!
//! With theta^2 = h^2 A both brackets are power series in A, summed by Horner's rule: each term couples a spring to its two
//! neighbours only, so a step costs O(n), and nothing but the present state is stored. At h omega_max = 2 the tangent
//! needs 19 terms and the sine 9 for 1e-17. (Taking 1 for both brackets gives Störmer-Verlet.) Velocity at whole steps is
//! the mean of the velocities before and after the kick.
//!
//! The rotation is orthogonal in the energy norm, so rounding errors add up and are never magnified; the bound below is
//! their sum over all steps. What no wave has reached is exactly zero and is not touched.

use std::sync::OnceLock;

use super::Work;
use super::dd::Dd;
use super::grid::{Motion, Step, energy_radius};
use super::path::Path;
use super::watch::{SpringPeaks, Watch};
use crate::chain::Scene;

/// Largest phase of a step, h omega_max.
const PHASE: f64 = 2.0;
const KICK_TERMS: usize = 19;
const DRIFT_TERMS: usize = 9;
/// Below this share of the force, motion ahead of the front is taken for none.
const SILENCE: f64 = 1e-22;
/// Springs that a step at the largest phase cannot carry more than 1e-16 of a motion across: 2^24 / 24!.
const CARRY: usize = 12;

/// Steps within the horizon at the largest phase.
pub fn steps(scene: &Scene, omega: f64) -> f64 {
    (scene.horizon * omega / PHASE).ceil().max(1.0) + if scene.duration < scene.horizon { 1.0 } else { 0.0 }
}

/// An upper bound on the largest frequency, within 0.2 %.
pub fn omega_max(scene: &Scene) -> f64 {
    Path::new(&scene.chain).omega_max()
}

/// Bound on the error of every force up to the horizon.
///
/// A step's rounding is at most 36 units (18 and 22 of the two halves of the state from Horner's rule with the terms'
/// sizes at the largest phase, 6 of A's own rounding) of the state's energy norm, which is at most twice that of the
/// static share plus the momentum that the force gives a free chain.
pub fn error_bound(scene: &Scene, omega: f64) -> f64 {
    let roundoff = f64::EPSILON / 2.0;
    let force = scene.force.abs();
    let total: f64 = scene.chain.mass.iter().sum();
    let free = !scene.chain.held_head && !scene.chain.held_tail;
    let acting = scene.horizon.min(scene.duration);
    let rigid = if free { acting / total.sqrt() } else { 0.0 };
    let pulses = if scene.duration < scene.horizon { 2.0 } else { 1.0 };
    let energy = force * (2.0 * pulses * energy_radius(scene) + rigid);
    let stiffest = scene.chain.stiffness.iter().fold(0.0f64, |a, &k| a.max(k)).sqrt();
    let marching = stiffest * energy * (36.0 * steps(scene, omega) + 40.0) * roundoff;
    let local = 2e-14 * 2.0 * pulses * force;
    let dropped = steps(scene, omega) * SILENCE * force * 100.0;
    let initial = scene.initial.iter().fold(0.0f64, |a, f| a.max(f.abs())) * 4.0 * roundoff;
    marching + local + dropped + initial
}

/// Extremes of every spring's force in a scene.
pub fn peaks(scene: &Scene, omega: f64) -> (Vec<SpringPeaks>, Work) {
    let mut watch = Watch::new(scene, error_bound(scene, omega));
    let mut work = Work::default();
    let quiet = 0.01 * watch.grain();
    march(scene, omega, quiet, |step, slack, last, rows, range| {
        let at = |end: usize, s: usize| [rows[end].force[s + 1], rows[end].rate[s + 1]];
        work.marched += range.len() as u64;
        let mut open = [0.0; SIFT];
        let mut from = range.start;
        while from < range.end {
            let to = (from + SIFT).min(range.end);
            sift(step, &watch, slack, rows, from..to, &mut open);
            for s in from..to {
                if open[s - from] > 0.0 {
                    work.refinements += u64::from(step.show(&mut watch, s, slack[s], last, at));
                }
            }
            from = to;
        }
    });
    (watch.peaks, work)
}

const SIFT: usize = 64;

/// How far each spring's quick bound over the step passes the level that matters, in either sign.
#[inline(always)]
fn sift(
    step: &Step,
    watch: &Watch,
    slack: &[f64],
    rows: &[Row; 2],
    range: std::ops::Range<usize>,
    open: &mut [f64; SIFT],
) {
    let slope = step.width * (4.0 / 27.0);
    let count = range.len();
    let padded = range.start + 1..range.end + 1;
    let (f0, f1) = (&rows[0].force[padded.clone()], &rows[1].force[padded.clone()]);
    let (d0, d1) = (&rows[0].rate[padded.clone()], &rows[1].rate[padded]);
    let (slack, levels) = (&slack[range.clone()], &watch.levels()[range]);
    for l in 0..count {
        let up = f0[l].max(f1[l]) + slope * (d0[l].max(0.0) - d1[l].min(0.0));
        let down = f0[l].min(f1[l]) + slope * (d0[l].min(0.0) - d1[l].max(0.0));
        open[l] = (up + slack[l] - levels[l][0]).max(slack[l] - down - levels[l][1]);
    }
}

/// Forces of one spring at given times, by cubics between the steps.
pub fn history(scene: &Scene, omega: f64, spring: usize, times: &[f64]) -> Vec<f64> {
    let mut out = vec![scene.initial[spring]; times.len()];
    march(scene, omega, 0.0, |step, _, _, rows, range| {
        if !range.contains(&spring) {
            return;
        }
        let ends = [0, 1].map(|e| [rows[e].force[spring + 1], step.width * rows[e].rate[spring + 1]]);
        for (t, f) in times.iter().zip(&mut out) {
            let x = (t - step.from) / step.width;
            if (0.0..=1.0).contains(&x) {
                let [[f0, d0], [f1, d1]] = ends;
                let rise = f1 - f0;
                let cubic = f0 + x * (d0 + x * (3.0 * rise - 2.0 * d0 - d1 + x * (d0 + d1 - 2.0 * rise)));
                *f = scene.initial[spring] + cubic;
            }
        }
    });
    out
}

/// Forces since the event, and their rates, at one instant; spring i at i + 1, and a zero at either end.
#[derive(Clone)]
struct Row {
    force: Vec<f64>,
    rate: Vec<f64>,
}

/// Runs through the horizon and shows `see` every step: its slack per spring, whether it is the last, the two rows, and
/// the springs that a wave has reached.
fn march(
    scene: &Scene,
    omega: f64,
    quiet: f64,
    mut see: impl FnMut(&Step, &[f64], bool, &[Row; 2], std::ops::Range<usize>),
) {
    let mut state = State::new(scene, quiet);
    let ends = if scene.duration < scene.horizon {
        vec![(0.0, scene.duration, scene.force), (scene.duration, scene.horizon, 0.0)]
    } else {
        vec![(0.0, scene.horizon, scene.force)]
    };
    for (k, &(from, to, force)) in ends.iter().enumerate() {
        let count = ((to - from) * omega / PHASE).ceil().max(1.0);
        let width = (to - from) / count;
        let last_stretch = k + 1 == ends.len();
        let count = count as u64;
        pulp::Arch::new().dispatch(Stretch {
            state: &mut state,
            from,
            width,
            count,
            force,
            last_stretch,
            see: &mut see,
        });
    }
}

/// Steps of equal width under constant force, compiled for the widest vector unit at hand.
struct Stretch<'s, 'a, F> {
    state: &'s mut State<'a>,
    from: f64,
    width: f64,
    count: u64,
    force: f64,
    last_stretch: bool,
    see: &'s mut F,
}

impl<F: FnMut(&Step, &[f64], bool, &[Row; 2], std::ops::Range<usize>)> pulp::WithSimd for Stretch<'_, '_, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        self.state.stretch(self.from, self.width, self.count, self.force, self.last_stretch, self.see);
    }
}

struct State<'a> {
    scene: &'a Scene,
    motion: Motion,
    /// `k`, `1 / m` (0 where held), padded as the rows are.
    stiffness: Vec<f64>,
    inverse_mass: Vec<f64>,
    rows: [Row; 2],
    /// Velocity of mass v at v + 1, so that spring i lies between i + 1 and i + 2.
    velocity: Vec<f64>,
    kick: Vec<f64>,
    scratch: [Vec<f64>; 3],
    /// A change of force too small to look at: a hundredth of what the watch would take note of.
    quiet: f64,
    /// Springs that may differ from their initial force.
    reached: std::ops::Range<usize>,
}

impl<'a> State<'a> {
    fn new(scene: &'a Scene, quiet: f64) -> State<'a> {
        let springs = scene.initial.len();
        let zero = vec![0.0; springs + 2];
        let row = Row { force: zero.clone(), rate: zero.clone() };
        let source = scene.source;
        let mut stiffness = zero.clone();
        stiffness[1..=springs].copy_from_slice(&scene.chain.stiffness);
        let inverse = |v: usize| if scene.chain.live(v) { 1.0 / scene.chain.mass[v] } else { 0.0 };
        State {
            scene,
            motion: Motion::new(scene),
            stiffness,
            inverse_mass: std::iter::once(0.0).chain((0..=springs).map(inverse)).collect(),
            rows: [row.clone(), row],
            velocity: zero.clone(),
            kick: zero.clone(),
            scratch: [zero.clone(), zero.clone(), zero],
            quiet,
            reached: source.saturating_sub(1)..(source + 1).min(springs),
        }
    }

    #[inline(always)]
    fn stretch(
        &mut self,
        from: f64,
        width: f64,
        count: u64,
        force: f64,
        last_stretch: bool,
        see: &mut impl FnMut(&Step, &[f64], bool, &[Row; 2], std::ops::Range<usize>),
    ) {
        let series = Series::new(width, &self.motion);
        let jolt = self.jolt(force);
        let slack: Vec<f64> = self.motion.fourth.iter().map(|f| f * jolt * width.powi(4) / 384.0).collect();
        self.find_kick(&series, force);
        for n in 0..count {
            self.half_kick();
            self.rows.swap(0, 1);
            self.drift(&series);
            self.find_kick(&series, force);
            // At the whole step the velocity is that between two half kicks.
            self.half_kick();
            self.find_rates();
            self.trim();
            let step = Step {
                from: from + n as f64 * width,
                width,
                until: self.scene.horizon,
                force,
                motion: &self.motion,
                initial: &self.scene.initial,
            };
            see(&step, &slack, last_stretch && n + 1 == count, &self.rows, self.loud());
        }
    }

    /// Norm of the state's own derivative, which the motion conserves while the outside force is constant.
    fn jolt(&self, force: f64) -> f64 {
        let row = &self.rows[1];
        let springs = self.scene.initial.len();
        let stretching: f64 = (1..=springs).map(|i| row.rate[i].powi(2) / self.stiffness[i]).sum();
        let accelerating = (0..=springs).map(|v| {
            let outside = if v == self.scene.source { force } else { 0.0 };
            (row.force[v] - row.force[v + 1] + outside).powi(2) * self.inverse_mass[v + 1]
        });
        (stretching + accelerating.sum::<f64>()).sqrt() * (1.0 + 1e-9)
    }

    /// Springs that a step can move: each term of a series reaches one further.
    fn reach(&self) -> std::ops::Range<usize> {
        let margin = KICK_TERMS + DRIFT_TERMS + 2;
        let springs = self.scene.initial.len();
        self.reached.start.saturating_sub(margin)..(self.reached.end + margin).min(springs)
    }

    /// `(h / m_v) [R_{v-1} - R_v + p_v]` with `R = G + (T(X) - 1)(G - G_static)`, X = h^2 A.
    #[inline(always)]
    fn find_kick(&mut self, series: &Series, force: f64) {
        let range = self.reach();
        let [q, r, spare] = &mut self.scratch;
        let g = &self.rows[1].force;
        series.apply(range.clone(), g, 0.0, g, q);
        for i in self.scene.source.saturating_sub(1)..(self.scene.source + 1).min(self.scene.initial.len()) {
            q[i + 1] -= series.width * series.width * force * self.motion.drive[i];
        }
        series.sum(range.clone(), &KICK_SERIES.get_or_init(kick_series)[1..], q, r, spare);
        for i in range.start + 1..range.end + 1 {
            r[i] += g[i];
        }
        // Masses before, between and behind these springs.
        for v in range.start..range.end + 1 {
            self.kick[v + 1] = series.width * self.inverse_mass[v + 1] * (r[v] - r[v + 1]);
        }
        let source = self.scene.source;
        self.kick[source + 1] += series.width * self.inverse_mass[source + 1] * force;
    }

    #[inline(always)]
    fn half_kick(&mut self) {
        let range = self.reach();
        for (v, k) in self.velocity[range.start + 1..range.end + 2].iter_mut().zip(&self.kick[range.start + 1..]) {
            *v += 0.5 * k;
        }
    }

    /// `G <- G + h S(X) k (v_i - v_{i+1})`
    #[inline(always)]
    fn drift(&mut self, series: &Series) {
        let range = self.reach();
        let [q, r, spare] = &mut self.scratch;
        q[range.start] = 0.0;
        q[range.end + 1] = 0.0;
        for i in range.start + 1..range.end + 1 {
            q[i] = series.width * self.stiffness[i] * (self.velocity[i] - self.velocity[i + 1]);
        }
        series.sum(range.clone(), DRIFT_SERIES.get_or_init(drift_series), q, r, spare);
        let [before, after] = &mut self.rows;
        for i in range.start + 1..range.end + 1 {
            after.force[i] = before.force[i] + r[i];
        }
        self.reached = range;
    }

    #[inline(always)]
    fn find_rates(&mut self) {
        let range = self.reach();
        let rate = &mut self.rows[1].rate;
        for i in range.start + 1..range.end + 1 {
            rate[i] = self.stiffness[i] * (self.velocity[i] - self.velocity[i + 1]);
        }
    }

    /// Springs whose force may have changed during the step by more than `quiet`.
    fn loud(&self) -> std::ops::Range<usize> {
        let loud = |i: &usize| {
            self.rows.iter().any(|row| row.force[i + 1].abs() > self.quiet || row.rate[i + 1].abs() > self.quiet)
        };
        let first = self.reached.clone().find(loud).unwrap_or(self.reached.end);
        let last = self.reached.clone().rev().find(loud).map_or(first, |l| l + 1);
        first.saturating_sub(CARRY)..(last + CARRY).min(self.scene.initial.len())
    }

    /// Takes back what lies ahead of the front and is nothing.
    fn trim(&mut self) {
        let silence = SILENCE * self.scene.force.abs();
        let row = &self.rows[1];
        let silent = |i: usize| row.force[i + 1].abs() <= silence && row.rate[i + 1].abs() <= silence;
        let mut range = self.reached.clone();
        while range.end > self.scene.source + 1 && silent(range.end - 1) {
            range.end -= 1;
        }
        while range.start + 1 < self.scene.source && silent(range.start) {
            range.start += 1;
        }
        for i in (self.reached.start..range.start).chain(range.end..self.reached.end) {
            for row in &mut self.rows {
                row.force[i + 1] = 0.0;
                row.rate[i + 1] = 0.0;
            }
        }
        for v in (self.reach().start..range.start).chain(range.end + 1..self.reach().end + 1) {
            self.velocity[v + 1] = 0.0;
        }
        self.reached = range;
    }
}

/// A step's `h^2 A`, and sums of its powers.
struct Series {
    width: f64,
    ahead: Vec<f64>,
    behind: Vec<f64>,
}

impl Series {
    fn new(width: f64, motion: &Motion) -> Series {
        let padded = |x: &[f64]| {
            let inner = x.iter().map(|c| c * width * width);
            std::iter::once(0.0).chain(inner).chain([0.0]).collect()
        };
        Series { width, ahead: padded(&motion.ahead), behind: padded(&motion.behind) }
    }

    /// `out = c q + X r` over springs of `range`; what lies outside is zero.
    #[inline(always)]
    fn apply(&self, range: std::ops::Range<usize>, r: &[f64], c: f64, q: &[f64], out: &mut [f64]) {
        out[range.start] = 0.0;
        out[range.end + 1] = 0.0;
        let count = range.len();
        let from = range.start + 1;
        let here = &r[from..from + count];
        let (left, right) = (&r[from - 1..from - 1 + count], &r[from + 1..from + 1 + count]);
        let (ahead, behind) = (&self.ahead[from..from + count], &self.behind[from..from + count]);
        let (q, out) = (&q[from..from + count], &mut out[from..from + count]);
        for i in 0..count {
            let pull = ahead[i] * (here[i] - left[i]);
            out[i] = c.mul_add(q[i], behind[i].mul_add(here[i] - right[i], pull));
        }
    }

    /// `out = sum_k coefficient[k] X^k q` by Horner's rule.
    #[inline(always)]
    fn sum(
        &self,
        range: std::ops::Range<usize>,
        coefficient: &[f64],
        q: &[f64],
        out: &mut Vec<f64>,
        spare: &mut Vec<f64>,
    ) {
        let (first, rest) = coefficient.split_last().unwrap_or((&0.0, &[]));
        for i in range.start..range.end + 2 {
            out[i] = first * q[i];
        }
        for &c in rest.iter().rev() {
            self.apply(range.clone(), out, c, q, spare);
            std::mem::swap(out, spare);
        }
    }
}

static KICK_SERIES: OnceLock<Vec<f64>> = OnceLock::new();
static DRIFT_SERIES: OnceLock<Vec<f64>> = OnceLock::new();

/// `tan(theta/2) / (theta/2)` as a polynomial in theta^2.
fn kick_series() -> Vec<f64> {
    let quarter = Dd::from(0.25);
    polynomial(KICK_TERMS, |x| sine_over_root(x * quarter) / cosine_of_root(x * quarter))
}

/// `sin(theta) / theta` as a polynomial in theta^2.
fn drift_series() -> Vec<f64> {
    polynomial(DRIFT_TERMS, sine_over_root)
}

/// `cos(sqrt x)`
fn cosine_of_root(x: Dd) -> Dd {
    (0..24).rev().fold(Dd::ONE, |sum, k| Dd::ONE - x * sum / Dd::from(f64::from((2 * k + 1) * (2 * k + 2))))
}

/// `sin(sqrt x) / sqrt x`
fn sine_over_root(x: Dd) -> Dd {
    (0..24).rev().fold(Dd::ONE, |sum, k| Dd::ONE - x * sum / Dd::from(f64::from((2 * k + 2) * (2 * k + 3))))
}

/// The polynomial of `terms` terms through `f` at the Chebyshev points of 0 <= x <= PHASE^2, in powers of x.
fn polynomial(terms: usize, f: impl Fn(Dd) -> Dd) -> Vec<f64> {
    let top = PHASE * PHASE;
    let point = |k: usize| {
        let angle = std::f64::consts::PI * (2 * k + 1) as f64 / (2 * terms) as f64;
        Dd::from(0.5 * top * (1.0 + angle.cos()))
    };
    let x: Vec<Dd> = (0..terms).map(point).collect();
    let mut difference: Vec<Dd> = x.iter().map(|&x| f(x)).collect();
    for order in 1..terms {
        for k in (order..terms).rev() {
            difference[k] = (difference[k] - difference[k - 1]) / (x[k] - x[k - order]);
        }
    }
    // Newton's form to powers of x.
    let mut power = vec![Dd::ZERO; terms];
    for k in (0..terms).rev() {
        for m in (0..terms).rev() {
            let lower = if m > 0 { power[m - 1] } else { difference[k] };
            power[m] = lower - x[k] * power[m];
        }
    }
    power.into_iter().map(Dd::to_f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both series to rounding over the whole range of phases.
    #[test]
    fn series_are_exact_to_rounding() {
        let (kick, drift) = (kick_series(), drift_series());
        for n in 1..=200 {
            let theta = PHASE * f64::from(n) / 200.0;
            let sum = |c: &[f64]| c.iter().rev().fold(0.0, |s, &c| s * theta * theta + c);
            assert!((sum(&kick) - (theta / 2.0).tan() / (theta / 2.0)).abs() < 4e-16);
            assert!((sum(&drift) - theta.sin() / theta).abs() < 3e-16);
        }
    }
}
