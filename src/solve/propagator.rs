//! Steps that are exact in time, for any chain: leapfrog with its kick replaced by a function of A.
//!
//! Over a step h a mode of frequency omega turns by theta = omega h. Kick and drift
//!
//! ```text
//! kick    v <- v + (h / m) [R_{v-1} - R_v + p_v],   R = G + P(X) q,   q = X G - h^2 drive = -h^2 G''
//! drift   G <- G + h k (v_i - v_{i+1})
//! ```
//!
//! with X = h^2 A and `1 + x P(x) = 4 sin^2(sqrt(x) / 2) / x` give G at every whole step exactly: it is the recurrence
//! `G(t + h) = 2 cos(h sqrt A) G(t) - G(t - h)` written with its differences as unknowns (v is a velocity up to a factor near
//! 1). P is a short power series, summed by Horner's rule: each term couples a spring to its two neighbours only, so a step
//! costs O(n), and nothing but the present state is stored. P = 0 would be Störmer-Verlet.
//!
//! Rounding: every increment is a difference of neighbours, and the running sums G and v carry their own rounding along
//! (compensated summation, W. Kahan, *Comm. ACM* 8 (1965) 40). So a step's error is a few units of the *increments*, whose norm
//! is bounded by the conserved energy of the motion's derivative, not of the state, which grows with the train. What no wave
//! has reached is exactly zero and is not touched.

use std::sync::OnceLock;

use super::between::Step;
use super::dd::{Dd, two_sum};
use super::motion::{BLOCK, FAR, MARGIN, Motion, local_norms};
use super::path::Path;
use super::series::{PHASE, polynomial, sine_over_root};
use crate::chain::Scene;

/// Terms of the full series for P: its error is 1e-17 up to the largest phase.
pub(super) const KICK_TERMS: usize = 7;
/// Terms of the series that converts velocities where the step width changes.
const SWITCH_TERMS: usize = 14;
/// The fewest terms for P, for the coarsest tolerances.
const FEWEST_TERMS: usize = 4;
/// With fewer terms than the full series the error bound is at most this share of the difference that is ignored.
const BOUND_SHARE: f64 = 0.05;
/// Below this share of the force, motion ahead of the front is set to zero.
const ZERO_BELOW: f64 = 1e-22;
/// A step at the largest phase carries under 1e-16 of a motion across this many springs: 1.5^24 / 24!.
const CARRY: usize = 12;
/// Springs by which a step can extend the motion.
const REACH: usize = KICK_TERMS + 3;

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
/// A step's rounding, in the energy norm and in units of the increments' norm, which is at most h times that of the motion's
/// derivative: 7 from the forces on the masses, 4 from the series, 2 from the kick, 6 from the drift, 19 together. An error made at
/// one step grows at most by `theta / sin(theta) < 1.51` on the way to another and by `1 / cos(theta / 2) < 1.37` on the way
/// between two: 40. A pulse's end starts a second motion like the first.
pub fn error_bound(scene: &Scene, omega: f64) -> f64 {
    error_bound_of_terms(scene, omega, KICK_TERMS)
}

/// The same with fewer terms of the series.
///
/// An error e of `x (1 + x P) = 4 sin^2(theta / 2)` changes frequencies by at most `e / 2 * theta / sin(theta)` of themselves:
/// the march follows a chain whose frequencies are off by under 0.76 e, and forces by that share of the time and the norm of their
/// rates, in the energy norm; on the way between two steps, 1.37 times as much. Where a pulse ends, velocities are converted
/// twice with the chain's own frequencies: 2 e of their norm, which grows with the time at most. 4 e together. The
/// polynomial of K terms through P at Chebyshev points is off by at most `2 (X / 4)^K max |P^(K)| / K!` over 0 <= x <= X, and the
/// last factor is P's coefficient `2 / (2K + 4)!`, since its series alternates.
pub(super) fn error_bound_of_terms(scene: &Scene, omega: f64, terms: usize) -> f64 {
    let square = PHASE * PHASE;
    let coefficient = (1..=2 * terms + 4).fold(2.0, |all, n| all / n as f64);
    let dropped_terms = square * 2.0 * (square / 4.0).powi(terms as i32) * coefficient;
    let roundoff = f64::EPSILON / 2.0;
    let force = scene.force.abs();
    let pulses = if scene.duration < scene.horizon { 2.0 } else { 1.0 };
    let stiffest = scene.chain.stiffness.iter().fold(0.0f64, |a, &k| a.max(k)).sqrt();
    // The norm of accelerations and rates of extension that the force starts and keeps up; the source is never held.
    let acceleration_norm = (1.0 / scene.chain.mass[scene.source]).sqrt() * force * pulses;
    let width = (PHASE / omega).min(scene.horizon);
    // The error of the full series is within the 4 roundoffs that are counted for the series.
    let rate = 40.0 * roundoff + if terms < KICK_TERMS { 4.0 * dropped_terms } else { 0.0 };
    let marching = rate * (scene.horizon + 20.0 * width) * acceleration_norm * stiffest;
    // Rounding of the state's and the polynomial's own numbers, and the series' last terms.
    let size = scene.initial.iter().fold(0.0f64, |a, f| a.max(f.abs())) + 4.0 * pulses * force;
    let dropped = steps(scene, omega) * ZERO_BELOW * force * 100.0;
    marching + 8.0 * size * roundoff + dropped
}

/// The fewest terms of the series for a search that ignores differences under `min_rise`.
pub(super) fn terms(scene: &Scene, omega: f64, min_rise: f64) -> usize {
    let fits = |&terms: &usize| error_bound_of_terms(scene, omega, terms) <= BOUND_SHARE * min_rise;
    (FEWEST_TERMS..KICK_TERMS).find(fits).unwrap_or(KICK_TERMS)
}

/// What to do with each step of a march; compiled into it.
pub(super) trait StepObserver {
    fn see(&mut self, view: &View);
}

#[inline(always)]
fn total([a, b, c, d, e, f, g, h]: [f64; BLOCK]) -> f64 {
    ((a + b) + (c + d)) + ((e + f) + (g + h))
}

/// `BLOCK` numbers of a row from a place on.
#[inline(always)]
pub(super) fn block(row: &[f64], from: usize) -> [f64; BLOCK] {
    let mut out = [0.0; BLOCK];
    out.copy_from_slice(&row[from..from + BLOCK]);
    out
}

/// The first `count` of `BLOCK` numbers into a row from a place on.
#[inline(always)]
fn put(row: &mut [f64], from: usize, values: [f64; BLOCK], count: usize) {
    if count >= BLOCK {
        row[from..from + BLOCK].copy_from_slice(&values);
    } else {
        row[from..from + count].iter_mut().zip(values).for_each(|(r, v)| *r = v);
    }
}

/// What a march shows of a step. Spring i is at index i + 1, with a zero at either end.
pub(super) struct View<'a> {
    pub step: Step,
    /// G at both ends.
    pub force: [&'a [f64]; 2],
    /// `q = -h^2 G''` at both ends.
    pub bend: [&'a [f64]; 2],
    pub remainders: &'a [Vec<f64>; 2],
    /// `|q| / sqrt(k)` at both ends, spring i at i + MARGIN.
    pub sizes: [&'a [f64]; 2],
    /// The bounds of [`local_norms`], per block of springs.
    pub norms: [&'a [f64]; 2],
    /// Springs whose force may have changed by more than `negligible`; elsewhere G counts as 0.
    pub range: std::ops::Range<usize>,
}

/// Marches to the horizon, with so many terms of the series, and passes every step to `see`. `omega` is an upper bound on the largest
/// frequency, `negligible` a change of force too small to matter.
pub(super) fn march(
    scene: &Scene,
    motion: &Motion,
    [omega, negligible]: [f64; 2],
    terms: usize,
    see: &mut impl StepObserver,
) {
    let mut state = State::new(scene, motion, negligible, terms);
    let stretches = if scene.duration < scene.horizon {
        vec![(0.0, scene.duration, scene.force), (scene.duration, scene.horizon, 0.0)]
    } else {
        vec![(0.0, scene.horizon, scene.force)]
    };
    let mut number = 0;
    for (from, to, force) in stretches {
        let count = ((to - from) * omega / PHASE).ceil().max(1.0) as u64;
        let step = Step { number, from, width: (to - from) / count as f64, force };
        number += count;
        pulp::Arch::new().dispatch(Stretch { state: &mut state, step, count, see });
    }
}

/// Steps of equal width under constant force, compiled for the widest vector unit at hand.
struct Stretch<'s, 'a, F> {
    state: &'s mut State<'a>,
    step: Step,
    count: u64,
    see: &'s mut F,
}

impl<F: StepObserver> pulp::WithSimd for Stretch<'_, '_, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        self.state.stretch(self.step, self.count, self.see);
    }
}

/// The present state. Spring i is at index i + 1, mass v at v + 1; spring i lies between those at i + 1 and i + 2.
///
/// Rows are long enough to read a whole block from any index in a range. Loops read a block before they write it: so
/// the compiler sees that rows do not overlap, and vectorises.
struct State<'a> {
    scene: &'a Scene,
    motion: &'a Motion,
    stiffness: Vec<f64>,
    /// `1 / sqrt(k)`
    root: Vec<f64>,
    inverse_mass: Vec<f64>,
    /// G at the beginning and the end of a step, and its rounding error.
    force: [Vec<f64>; 2],
    force_rest: Vec<f64>,
    /// Velocities, half a step ahead (between stretches: at the whole step), and their rounding errors.
    velocity: Vec<f64>,
    velocity_rest: Vec<f64>,
    /// `(h / m) (G_{v-1} - G_v + p_v)`
    pull: Vec<f64>,
    bend: [Vec<f64>; 2],
    /// `|q_i| / sqrt(k_i)` at the beginning and the end of a step, the first at MARGIN; the sums of their squares over blocks of springs, the
    /// first at FAR; and the norms from them.
    sizes: [Vec<f64>; 2],
    energy: [Vec<f64>; 2],
    norms: [Vec<f64>; 2],
    scratch: [Vec<f64>; 2],
    /// Coefficients of P.
    series: &'static [f64],
    /// A change of force too small to matter.
    negligible: f64,
    /// Springs that may differ from their initial force.
    reached: std::ops::Range<usize>,
}

/// The chain's coefficients for a step width.
struct Coefficients {
    ahead: Vec<f64>,
    behind: Vec<f64>,
    /// `h / m` and `h k`
    kick: Vec<f64>,
    drift: Vec<f64>,
}

impl<'a> State<'a> {
    fn new(scene: &'a Scene, motion: &'a Motion, negligible: f64, terms: usize) -> State<'a> {
        let springs = scene.initial.len();
        let zero = vec![0.0; springs.next_multiple_of(BLOCK) + BLOCK + 3];
        let mut stiffness = zero.clone();
        stiffness[1..=springs].copy_from_slice(&scene.chain.stiffness);
        let mut inverse_mass = zero.clone();
        for v in (0..=springs).filter(|&v| scene.chain.live(v)) {
            inverse_mass[v + 1] = 1.0 / scene.chain.mass[v];
        }
        let source = scene.source;
        let two = || [zero.clone(), zero.clone()];
        State {
            scene,
            motion,
            root: stiffness.iter().map(|&k| if k > 0.0 { 1.0 / k.sqrt() } else { 0.0 }).collect(),
            stiffness,
            inverse_mass,
            force: two(),
            force_rest: zero.clone(),
            velocity: zero.clone(),
            velocity_rest: zero.clone(),
            pull: zero.clone(),
            bend: two(),
            sizes: [0, 1].map(|_| vec![0.0; springs.next_multiple_of(BLOCK) + 2 * MARGIN + BLOCK]),
            energy: [0, 1].map(|_| vec![0.0; springs.div_ceil(BLOCK).next_multiple_of(BLOCK) + 2 * FAR]),
            norms: [0, 1].map(|_| vec![0.0; springs.div_ceil(BLOCK).next_multiple_of(BLOCK)]),
            scratch: two(),
            series: &KICK_SERIES.get_or_init(|| std::array::from_fn(|k| kick_series(k, PHASE)))[terms],
            negligible,
            reached: source.saturating_sub(1)..(source + 1).min(springs),
        }
    }

    fn coefficients(&self, width: f64) -> Coefficients {
        let padded = |x: &[f64]| {
            let mut row = vec![0.0; self.stiffness.len()];
            row[1..=x.len()].iter_mut().zip(x).for_each(|(r, c)| *r = c * width * width);
            row
        };
        Coefficients {
            ahead: padded(&self.motion.ahead),
            behind: padded(&self.motion.behind),
            kick: self.inverse_mass.iter().map(|m| width * m).collect(),
            drift: self.stiffness.iter().map(|k| width * k).collect(),
        }
    }

    #[inline(always)]
    fn stretch(&mut self, first: Step, count: u64, see: &mut impl StepObserver) {
        let Step { width, force, .. } = first;
        let c = self.coefficients(width);
        let remainders = self.motion.remainders(width);
        self.convert_velocity(&c, sine_over_root);
        self.find_bend(&c, force);
        let mut share = 0.5;
        for n in 0..count {
            self.kick(&c, share);
            share = 1.0;
            self.force.swap(0, 1);
            self.bend.swap(0, 1);
            self.sizes.swap(0, 1);
            self.energy.swap(0, 1);
            self.drift(&c);
            self.find_bend(&c, force);
            self.trim();
            self.find_norms();
            let step = Step { number: first.number + n, from: first.from + n as f64 * width, width, force };
            see.see(&View {
                step,
                force: [&self.force[0], &self.force[1]],
                bend: [&self.bend[0], &self.bend[1]],
                remainders: &remainders,
                sizes: [&self.sizes[0], &self.sizes[1]],
                norms: [&self.norms[0], &self.norms[1]],
                range: self.moving(),
            });
        }
        if first.number == 0 && self.scene.duration < self.scene.horizon {
            self.kick(&c, 0.5);
            self.convert_velocity(&c, |x| Dd::ONE / sine_over_root(x));
        }
    }

    /// Converts velocities at a whole step to the mean of those half a step before and after, or back: `factor` is
    /// `sin(theta) / theta`, or its inverse, as a function of X.
    fn convert_velocity(&mut self, c: &Coefficients, factor: impl Fn(Dd) -> Dd) {
        if self.velocity.iter().all(|v| *v == 0.0) {
            return;
        }
        let springs = self.scene.initial.len();
        let series =
            polynomial(SWITCH_TERMS, PHASE, |x| if x.hi == 0.0 { Dd::ZERO } else { (factor(x) - Dd::ONE) / x });
        // Y = X applied to masses: (h / m) (h k (v_{i-1} - v_i) ...), from velocities to velocities.
        let times = |v: &[f64]| {
            let extension: Vec<f64> = (0..=springs + 1)
                .map(|i| if i == 0 || i > springs { 0.0 } else { c.drift[i] * (v[i] - v[i + 1]) })
                .collect();
            let mut out = vec![0.0; v.len()];
            for v in 1..=springs + 1 {
                out[v] = c.kick[v] * (extension[v] - extension[v - 1]);
            }
            out
        };
        let base = times(&self.velocity);
        let mut sum = vec![0.0; base.len()];
        for coefficient in series.iter().rev() {
            sum = times(&sum);
            sum.iter_mut().zip(&base).for_each(|(s, b)| *s += coefficient * b);
        }
        self.velocity.iter_mut().zip(&sum).for_each(|(v, s)| *v += s);
        self.reached = 0..springs;
    }

    /// Springs that a step can move.
    fn reach(&self) -> std::ops::Range<usize> {
        self.reached.start.saturating_sub(REACH)..(self.reached.end + REACH).min(self.scene.initial.len())
    }

    /// Pulls on the masses, and from them `q = h k (pull_{i+1} - pull_i)`.
    #[inline(always)]
    fn find_bend(&mut self, c: &Coefficients, force: f64) {
        let range = self.reach();
        let (from, to) = (range.start + 1, range.end + 1);
        let (g, rest) = (&self.force[1], &self.force_rest);
        let mut v = from;
        while v <= to {
            let (g, next_g) = (block(g, v - 1), block(g, v));
            let (rest, next_rest) = (block(rest, v - 1), block(rest, v));
            let mut pull = block(&c.kick, v);
            for l in 0..BLOCK {
                pull[l] *= (g[l] - next_g[l]) + (rest[l] - next_rest[l]);
            }
            put(&mut self.pull, v, pull, to + 1 - v);
            v += BLOCK;
        }
        let source = self.scene.source + 1;
        let outside = (g_at(&self.force[1], source) + g_at(&self.force_rest, source)) + force;
        self.pull[source] = c.kick[source] * outside;
        let mut i = from;
        while i < to {
            let (pull, next_pull) = (block(&self.pull, i), block(&self.pull, i + 1));
            let mut bend = block(&c.drift, i);
            for l in 0..BLOCK {
                bend[l] *= next_pull[l] - pull[l];
            }
            put(&mut self.bend[1], i, bend, to - i);
            i += BLOCK;
        }
        for number in range.start / BLOCK..range.end.div_ceil(BLOCK) {
            let (q, root) = (block(&self.bend[1], number * BLOCK + 1), block(&self.root, number * BLOCK + 1));
            let (mut size, mut energy) = ([0.0; BLOCK], [0.0; BLOCK]);
            for l in 0..BLOCK {
                size[l] = q[l].abs() * root[l];
                energy[l] = size[l] * size[l];
            }
            put(&mut self.sizes[1], MARGIN + number * BLOCK, size, BLOCK);
            self.energy[1][FAR + number] = total(energy);
        }
    }

    #[inline(always)]
    fn find_norms(&mut self) {
        let mut all = [[0.0; BLOCK]; 2];
        for (sum, row) in all.iter_mut().zip(&self.energy) {
            let mut sums = [0.0; BLOCK];
            for from in 0..self.norms[0].len() / BLOCK {
                let energy = block(row, FAR + from * BLOCK);
                for l in 0..BLOCK {
                    sums[l] += energy[l];
                }
            }
            *sum = [total(sums); BLOCK];
        }
        for number in 0..self.norms[0].len() / BLOCK {
            let mut around = [[[0.0; BLOCK]; 2 * FAR + 1]; 2];
            for (around, row) in around.iter_mut().zip(&self.energy) {
                for (n, energy) in around.iter_mut().enumerate() {
                    *energy = block(row, number * BLOCK + n);
                }
            }
            let norms = local_norms(around, all);
            self.norms.iter_mut().zip(norms).for_each(|(row, norms)| put(row, number * BLOCK, norms, BLOCK));
        }
    }

    /// `v <- v + share (pull + (h / m) (r_{v-1} - r_v))`, `r = P(X) q`.
    #[inline(always)]
    fn kick(&mut self, c: &Coefficients, share: f64) {
        let range = self.reach();
        let [r, spare] = &mut self.scratch;
        horner(c, range.clone(), self.series, &self.bend[1], r, spare);
        let to = range.end + 1;
        let mut v = range.start + 1;
        while v <= to {
            let (r, next_r) = (block(r, v - 1), block(r, v));
            let (pull, kick) = (block(&self.pull, v), block(&c.kick, v));
            let (mut velocity, mut rest) = (block(&self.velocity, v), block(&self.velocity_rest, v));
            for l in 0..BLOCK {
                let change = share * kick[l].mul_add(r[l] - next_r[l], pull[l]);
                [velocity[l], rest[l]] = two_sum(velocity[l], rest[l] + change);
            }
            put(&mut self.velocity, v, velocity, to + 1 - v);
            put(&mut self.velocity_rest, v, rest, to + 1 - v);
            v += BLOCK;
        }
    }

    /// `G <- G + h k (v_i - v_{i+1})`
    #[inline(always)]
    fn drift(&mut self, c: &Coefficients) {
        let range = self.reach();
        let to = range.end + 1;
        let mut i = range.start + 1;
        while i < to {
            let (v, next_v) = (block(&self.velocity, i), block(&self.velocity, i + 1));
            let (v_rest, next_v_rest) = (block(&self.velocity_rest, i), block(&self.velocity_rest, i + 1));
            let (mut force, mut rest) = (block(&self.force[0], i), block(&self.force_rest, i));
            let drift = block(&c.drift, i);
            for l in 0..BLOCK {
                let change = drift[l] * ((v[l] - next_v[l]) + (v_rest[l] - next_v_rest[l]));
                [force[l], rest[l]] = two_sum(force[l], rest[l] + change);
            }
            put(&mut self.force[1], i, force, to - i);
            put(&mut self.force_rest, i, rest, to - i);
            i += BLOCK;
        }
        self.reached = range;
    }

    /// Springs whose force may have changed during the step by more than `negligible`.
    fn moving(&self) -> std::ops::Range<usize> {
        let moving = |i: &usize| {
            let rows = self.force.iter().zip(&self.bend);
            rows.into_iter().any(|(f, q)| f[i + 1].abs() > self.negligible || q[i + 1].abs() > self.negligible)
        };
        let first = self.reached.clone().find(moving).unwrap_or(self.reached.end);
        let last = self.reached.clone().rev().find(moving).map_or(first, |l| l + 1);
        first.saturating_sub(CARRY)..(last + CARRY).min(self.scene.initial.len())
    }

    /// Sets to zero what is negligible ahead of the front.
    fn trim(&mut self) {
        let zero_below = ZERO_BELOW * self.scene.force.abs();
        let (force, bend) = (&self.force[1], &self.bend[1]);
        let is_zero = |i: usize| force[i + 1].abs() <= zero_below && bend[i + 1].abs() <= zero_below;
        let mut range = self.reached.clone();
        while range.end > self.scene.source + 1 && is_zero(range.end - 1) {
            range.end -= 1;
        }
        while range.start + 1 < self.scene.source && is_zero(range.start) {
            range.start += 1;
        }
        let wide = self.reach();
        for i in (wide.start..range.start).chain(range.end..wide.end) {
            self.force.iter_mut().chain(&mut self.bend).chain([&mut self.force_rest]).for_each(|row| row[i + 1] = 0.0);
        }
        for v in (wide.start..range.start).chain(range.end + 1..wide.end + 1) {
            [&mut self.velocity, &mut self.velocity_rest, &mut self.pull].into_iter().for_each(|row| row[v + 1] = 0.0);
        }
        self.reached = range;
    }
}

/// `G_{v-1} - G_v` at mass position v.
fn g_at(g: &[f64], v: usize) -> f64 {
    g[v - 1] - g[v]
}

/// `out = sum_k coefficient[k] X^k q` over the springs of `range`; what lies outside is zero.
#[inline(always)]
fn horner(
    c: &Coefficients,
    range: std::ops::Range<usize>,
    coefficient: &[f64],
    q: &[f64],
    out: &mut Vec<f64>,
    spare: &mut Vec<f64>,
) {
    let (from, count) = (range.start + 1, range.len());
    let (first, rest) = coefficient.split_last().unwrap_or((&0.0, &[]));
    for row in [&mut *out, &mut *spare] {
        row[from - 1] = 0.0;
        row[from + count] = 0.0;
    }
    out[from..from + count].iter_mut().zip(&q[from..from + count]).for_each(|(o, q)| *o = first * q);
    for &factor in rest.iter().rev() {
        let mut i = from;
        while i < from + count {
            let (before, here, after) = (block(out, i - 1), block(out, i), block(out, i + 1));
            let (ahead, behind, mut next) = (block(&c.ahead, i), block(&c.behind, i), block(q, i));
            for l in 0..BLOCK {
                let pull = behind[l].mul_add(here[l] - after[l], ahead[l] * (here[l] - before[l]));
                next[l] = factor.mul_add(next[l], pull);
            }
            put(spare, i, next, from + count - i);
            i += BLOCK;
        }
        std::mem::swap(out, spare);
    }
}

/// By the number of terms.
static KICK_SERIES: OnceLock<[Vec<f64>; KICK_TERMS + 1]> = OnceLock::new();

/// `(4 sin^2(theta / 2) / theta^2 - 1) / theta^2` as a polynomial in theta^2: `2 sum_k (-1)^(k+1) x^k / (2k + 4)!`.
pub(crate) fn kick_series(terms: usize, phase: f64) -> Vec<f64> {
    polynomial(terms, phase, |x| {
        let terms = (0..16).rev().fold(Dd::ZERO, |sum, k| {
            let over = Dd::from(f64::from((2 * k + 5) * (2 * k + 6)));
            Dd::ONE - x * sum / over
        });
        -(terms / Dd::from(12.0))
    })
}

#[cfg(test)]
mod tests {
    use super::super::series::cosine_of_root;
    use super::*;

    /// The kick's factor to rounding over the whole range of phases.
    #[test]
    fn kick_is_exact_to_rounding() {
        let series = kick_series(KICK_TERMS, PHASE);
        for n in 1..=200 {
            let theta = PHASE * f64::from(n) / 200.0;
            let x = theta * theta;
            let sum = series.iter().rev().fold(0.0, |s, &c| s * x + c);
            let exact = 4.0 * (0.5 * theta).sin().powi(2) / x;
            assert!((1.0 + x * sum - exact).abs() < 4e-16, "{theta}");
        }
    }

    /// With fewer terms it is off by no more than the error bound says, and by a good share of that.
    #[test]
    fn fewer_terms_are_off_by_what_the_bound_says() {
        for terms in FEWEST_TERMS..KICK_TERMS {
            let (few, all) = (kick_series(terms, PHASE), kick_series(KICK_TERMS + 3, PHASE));
            let sum = |series: &[f64], x: f64| series.iter().rev().fold(0.0, |s, &c| s * x + c);
            let off = |n: i32| PHASE * PHASE * f64::from(n) / 200.0;
            let most = (1..=200).map(off).map(|x| x * (sum(&few, x) - sum(&all, x)).abs()).fold(0.0, f64::max);
            let square: f64 = PHASE * PHASE;
            let factorial = (1..=2 * terms + 4).fold(1.0, |all, n| all * n as f64);
            let bound = 4.0 * square * (square / 4.0).powi(terms as i32) / factorial;
            assert!(most < bound + 1e-15 && most > 0.3 * bound - 1e-15, "{terms}: {most:e} {bound:e}");
        }
    }

    /// cos^2 + sin^2 = 1 for the two series that the switch of steps is made of, to double-double rounding.
    #[test]
    fn series_of_cosine_and_sine_agree() {
        let x = Dd::from(2.0);
        let (c, s) = (cosine_of_root(x), sine_over_root(x));
        assert!((c * c + x * s * s - Dd::ONE).abs().hi < 1e-30);
    }
}
