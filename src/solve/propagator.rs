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
//! is bounded by the conserved energy of the motion's derivative, not of the state, which grows with the train.

use pulp::Simd;

use super::dd::{Dd, two_sum};
use super::lanes::{Aligned, HALO, LANES, Layout, Number, Row, Rows, WithRows, dispatch};
use super::motion::Motion;
use super::path::Path;
use super::series::{PHASE, polynomial, sine_over_root};
use super::view::{Stretch, View};
use crate::chain::Scene;

/// Terms of the full series for P: its error is 1e-17 up to the largest phase.
pub(super) const KICK_TERMS: usize = 7;
/// Terms of the series that converts velocities where the step width changes.
const SWITCH_TERMS: usize = 14;
/// The fewest terms for P, for the coarsest tolerances.
const FEWEST_TERMS: usize = 4;
/// With fewer terms than the full series the error bound is at most this share of the difference that is ignored.
const BOUND_SHARE: f64 = 0.05;
/// This share of the force is added to every pull and subtracted again. In double precision pulls under 1e-38 of the force become zero, as
/// denormal numbers are slow, and those over a millionth of the force stay as they are.
const TINY: f64 = 1e-22;

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
/// derivative: 6 from the forces on the masses, 4 from the series, 3 from the kick, 7 from the drift, 20 together. An error made at
/// one step grows at most by `theta / sin(theta) < 1.51` on the way to another and by `1 / cos(theta / 2) < 1.37` on the way
/// between two: 42. A pulse's end starts a second motion like the first.
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
    let rate = 42.0 * roundoff + if terms < KICK_TERMS { 4.0 * dropped_terms } else { 0.0 };
    let marching = rate * (scene.horizon + 20.0 * width) * acceleration_norm * stiffest;
    // Rounding of the state's and the polynomial's own numbers.
    let size = scene.initial.iter().fold(0.0f64, |a, f| a.max(f.abs())) + 4.0 * pulses * force;
    marching + 8.0 * size * roundoff
}

/// The fewest terms of the series for a search that ignores differences under `min_rise`.
pub(super) fn terms(scene: &Scene, omega: f64, min_rise: f64) -> usize {
    let fits = |&terms: &usize| error_bound_of_terms(scene, omega, terms) <= BOUND_SHARE * min_rise;
    (FEWEST_TERMS..KICK_TERMS).find(fits).unwrap_or(KICK_TERMS)
}

/// What to do with each step of a march in numbers T; compiled into it.
pub(super) trait StepObserver<T: Number = f64> {
    fn see<S: Simd, const H: usize>(&mut self, rows: Rows<S, H, T>, view: &View<T>);
}

/// A scene to be marched through.
#[derive(Clone, Copy, Debug)]
pub(super) struct Marched<'a> {
    pub scene: &'a Scene,
    pub motion: &'a Motion,
    /// An upper bound on the largest frequency.
    pub omega: f64,
}

/// How steps are made.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepKind {
    /// Their largest phase.
    pub phase: f64,
    /// Terms of the series.
    pub terms: usize,
    /// The force is 1 instead of the scene's.
    pub unit: bool,
}

impl StepKind {
    /// Those that [`error_bound_of_terms`] is of.
    pub(super) fn exact(terms: usize) -> StepKind {
        StepKind { phase: PHASE, terms, unit: false }
    }
}

/// Marches to the horizons in numbers T and passes every step to `see`: through one scene, or through at most [`LANES`] side by side. Of
/// several scenes none may have a pulse that ends before its horizon. Lanes whose horizon is passed are marched on with the others.
pub(super) fn march<T: Number>(scenes: &[Marched], kind: StepKind, see: &mut impl StepObserver<T>) {
    let springs: Vec<usize> = scenes.iter().map(|of| of.scene.initial.len()).collect();
    let layout = Layout::new(&springs);
    let mut state = State::<T>::new(scenes, layout, kind);
    let mut number = 0;
    for part in 0..2 {
        let none = [0.0; LANES];
        let more = part == 0 && scenes.iter().any(|of| of.scene.duration < of.scene.horizon);
        let mut stretch = Stretch { number, from: none, width: none, force: none, count: [0; LANES], is_last: !more };
        for lane in 0..LANES {
            let Some(Marched { scene, omega, .. }) = scenes.get(layout.chain(lane)) else { continue };
            let ends = [0.0, scene.duration.min(scene.horizon), scene.horizon];
            let time = ends[part + 1] - ends[part];
            let count = (time * omega / kind.phase).ceil().max(1.0);
            let force = if kind.unit { 1.0 } else { scene.force };
            stretch.from[lane] = ends[part];
            stretch.width[lane] = time / count;
            stretch.force[lane] = if part == 0 { force } else { 0.0 };
            stretch.count[lane] = count as u64;
        }
        number += stretch.count[0];
        dispatch(March { state: &mut state, stretch, see });
        if !more {
            return;
        }
    }
}

/// The steps of a stretch.
struct March<'s, 'a, T: Number, F> {
    state: &'s mut State<'a, T>,
    stretch: Stretch,
    see: &'s mut F,
}

impl<T: Number, F: StepObserver<T>> WithRows<T> for March<'_, '_, T, F> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd, const H: usize>(self, rows: Rows<S, H, T>) {
        self.state.march(rows, &self.stretch, self.see);
    }
}

/// The present state, in rows ([`super::lanes`]). Spring i lies between masses i and i + 1.
struct State<'a, T: Number> {
    scenes: &'a [Marched<'a>],
    layout: Layout,
    kind: StepKind,
    /// [`TINY`] of the force, lane by lane.
    tiny: Aligned<T>,
    /// `1 / sqrt(k)`
    root: Aligned<T>,
    /// G at the beginning and the end of a step, and its rounding error.
    force: [Aligned<T>; 2],
    force_rest: Aligned<T>,
    /// Velocities, half a step ahead (between stretches: at the whole step), and their rounding errors.
    velocity: Aligned<T>,
    velocity_rest: Aligned<T>,
    /// `(h / m) (G_{v-1} - G_v + p_v)`
    pull: Aligned<T>,
    bend: [Aligned<T>; 2],
    /// Sums of `q_i^2 / k_i` over the blocks of rows, lane by lane, at the end of a step; and the larger ones of both ends, with halos.
    energy: Aligned<T>,
    larger_energy: Aligned<T>,
    scratch: [Aligned<T>; 2],
    /// Coefficients of P, highest power first: the leading one, and two for each pass.
    series: Vec<f64>,
    /// Places of the masses on which the outside forces act, ascending, and their chains; a copy in a halo has a place of its own.
    sources: Vec<(usize, usize)>,
}

/// `h / m` and `h k` of every mass and spring, and h.
struct Coefficients<T> {
    kick: Aligned<T>,
    drift: Aligned<T>,
    width: Aligned<T>,
}

impl<'a, T: Number> State<'a, T> {
    fn new(scenes: &'a [Marched], layout: Layout, kind: StepKind) -> State<'a, T> {
        let zero = Aligned::new(layout.len(), T::default());
        let blocks = Aligned::new((layout.blocks() + 2 * HALO) * LANES, T::default());
        let two = || [zero.clone(), zero.clone()];
        let mut root = zero.clone();
        let mut tiny = Aligned::new(LANES, T::default());
        for (chain, Marched { scene, .. }) in scenes.iter().enumerate() {
            layout.put(&mut root, chain, scene.chain.stiffness.iter().map(|k| 1.0 / k.sqrt()));
            let size = TINY * if kind.unit { 1.0 } else { scene.force.abs() };
            (0..LANES).filter(|&l| layout.chain(l) == chain).for_each(|l| tiny[l] = T::from_f64(size));
        }
        let series = kick_series(kind.terms, kind.phase);
        let mut sources: Vec<(usize, usize)> =
            scenes.iter().enumerate().map(|(chain, of)| (layout.place(chain, of.scene.source), chain)).collect();
        if layout.is_cut && sources[0].0 / LANES == HALO && !sources[0].0.is_multiple_of(LANES) {
            // The copy in the halo of the piece before.
            sources.push((sources[0].0 + layout.rows * LANES - 1, 0));
        }
        sources.sort_unstable();
        State {
            scenes,
            layout,
            kind,
            tiny,
            root,
            force: two(),
            force_rest: zero.clone(),
            velocity: zero.clone(),
            velocity_rest: zero.clone(),
            pull: zero.clone(),
            bend: two(),
            energy: blocks.clone(),
            larger_energy: blocks,
            scratch: two(),
            series: std::iter::repeat_n(0.0, (kind.terms + 1) % 2).chain(series.into_iter().rev()).collect(),
            sources,
        }
    }

    fn coefficients<S: Simd, const H: usize>(&self, rows: Rows<S, H, T>, stretch: &Stretch) -> Coefficients<T> {
        let layout = self.layout;
        let zero = Aligned::new(layout.len(), T::default());
        let mut c = Coefficients { kick: zero.clone(), drift: zero, width: Aligned::new(LANES, T::default()) };
        for (number, Marched { scene, .. }) in self.scenes.iter().enumerate() {
            let (chain, width) = (&scene.chain, stretch.width[number]);
            let inverse = |v: usize| if chain.live(v) { 1.0 / chain.mass[v] } else { 0.0 };
            layout.put(&mut c.kick, number, (0..chain.mass.len()).map(|v| width * inverse(v)));
            layout.put(&mut c.drift, number, chain.stiffness.iter().map(|k| width * k));
        }
        layout.fill_halos(rows, &mut c.kick);
        layout.fill_halos(rows, &mut c.drift);
        stretch.width.iter().zip(&mut *c.width).for_each(|(width, of)| *of = T::from_f64(*width));
        c
    }

    #[inline(always)]
    fn march<S: Simd, const H: usize>(
        &mut self,
        rows: Rows<S, H, T>,
        stretch: &Stretch,
        see: &mut impl StepObserver<T>,
    ) {
        let layout = self.layout;
        let c = self.coefficients(rows, stretch);
        let mut remainders = [0, 1].map(|_| Aligned::new(layout.len(), T::default()));
        for (chain, Marched { motion, .. }) in self.scenes.iter().enumerate() {
            let of_chain = motion.remainders(stretch.width[chain]);
            remainders.iter_mut().zip(of_chain).for_each(|(row, of_chain)| layout.put(row, chain, of_chain));
        }
        let mut block_remainder = Aligned::new(layout.blocks() * LANES, T::default());
        for block in 0..layout.blocks() {
            let largest = &mut rows.of_mut(&mut block_remainder)[block];
            rows.of(&remainders[0])[layout.block(block)].iter().for_each(|row| *largest = rows.max(*largest, *row));
        }
        self.convert_velocity(rows, &c, sine_over_root);
        self.find_bend(rows, &c, stretch);
        for done in 0..stretch.count.into_iter().fold(0, u64::max) {
            let share = if done == 0 { 0.5 } else { 1.0 };
            self.sum_series(rows, &c);
            self.force.swap(0, 1);
            self.bend.swap(0, 1);
            self.kick_and_drift(rows, &c, share);
            self.find_bend(rows, &c, stretch);
            let view = View {
                stretch,
                done,
                layout,
                force: [&self.force[0], &self.force[1]],
                bend: [&self.bend[0], &self.bend[1]],
                kick: &c.kick,
                drift: &c.drift,
                remainders: &remainders,
                block_remainder: &block_remainder,
                root: &self.root,
                energy: &self.larger_energy,
            };
            see.see(rows, &view);
        }
        if !stretch.is_last {
            self.sum_series(rows, &c);
            self.half_kick(&c);
            self.convert_velocity(rows, &c, |x| Dd::ONE / sine_over_root(x));
        }
    }

    /// Converts velocities at a whole step to the mean of those half a step before and after, or back: `factor` is
    /// `sin(theta) / theta`, or its inverse, as a function of X.
    fn convert_velocity<S: Simd, const H: usize>(
        &mut self,
        rows: Rows<S, H, T>,
        c: &Coefficients<T>,
        factor: impl Fn(Dd) -> Dd,
    ) {
        if self.velocity.iter().all(|v| *v == T::default()) {
            return;
        }
        // Only one scene may have a second stretch.
        let masses = self.scenes[0].scene.chain.mass.len();
        let [kick, drift, mut velocity] =
            [&c.kick, &c.drift, &self.velocity].map(|row| self.layout.gather(row, 0, masses));
        let series =
            polynomial(
                SWITCH_TERMS,
                self.kind.phase,
                |x| if x.hi == 0.0 { Dd::ZERO } else { (factor(x) - Dd::ONE) / x },
            );
        // X applied to masses: (h / m) (h k (v_{i-1} - v_i) ...), from velocities to velocities.
        let times = |v: &[f64]| -> Vec<f64> {
            let extension = |i: usize| drift[i] * (v[i] - v[i + 1]);
            let before = |v: usize| v.checked_sub(1).map_or(0.0, extension);
            let behind = |v: usize| if v + 1 < masses { extension(v) } else { 0.0 };
            (0..masses).map(|v| kick[v] * (behind(v) - before(v))).collect()
        };
        let base = times(&velocity);
        let mut sum = vec![0.0; masses];
        for coefficient in series.iter().rev() {
            sum = times(&sum);
            sum.iter_mut().zip(&base).for_each(|(s, b)| *s += coefficient * b);
        }
        velocity.iter_mut().zip(&sum).for_each(|(v, s)| *v += s);
        self.layout.put(&mut self.velocity, 0, velocity);
        self.layout.fill_halos(rows, &mut self.velocity);
        self.layout.fill_halos(rows, &mut self.velocity_rest);
    }

    /// `r = P(X) q`, into the first of `scratch`, with its halo.
    ///
    /// By Horner's rule, two powers a pass: `X r = h k_i (w_{i+1} - w_i)`, `w_v = h / m_v (r_{v-1} - r_v)`.
    #[inline(always)]
    fn sum_series<S: Simd, const H: usize>(&mut self, rows: Rows<S, H, T>, c: &Coefficients<T>) {
        let [r, next] = &mut self.scratch;
        let (leading, rest) = self.series.split_first().unwrap_or((&0.0, &[]));
        let q = &self.bend[1];
        for (number, pair) in rest.as_chunks::<2>().0.iter().enumerate() {
            if number == 0 {
                two_powers::<S, H, T, true>(rows, c, [q, q], next, [*leading, pair[0], pair[1]]);
            } else {
                two_powers::<S, H, T, false>(rows, c, [q, r], next, [1.0, pair[0], pair[1]]);
            }
            self.layout.fill_halos(rows, next);
            std::mem::swap(r, next);
        }
    }

    /// `v <- v + share (pull + (h / m) (r_{v-1} - r_v))`, `G <- G + h k (v_i - v_{i+1})`
    #[inline(always)]
    fn kick_and_drift<S: Simd, const H: usize>(&mut self, v: Rows<S, H, T>, c: &Coefficients<T>, share: f64) {
        let end = self.layout.rows + 2 * HALO;
        let (kick, drift, pull) = (&v.of(&c.kick)[..end], &v.of(&c.drift)[..end], &v.of(&self.pull)[..end]);
        let r: &[Row<S, H, T>] = &v.of(&self.scratch[0])[..end];
        let [before, after] = &mut self.force;
        let (before, after) = (&v.of(before)[..end], &mut v.of_mut(after)[..end]);
        let force_rest = &mut v.of_mut(&mut self.force_rest)[..end];
        let velocity = &mut v.of_mut(&mut self.velocity)[..end];
        let velocity_rest = &mut v.of_mut(&mut self.velocity_rest)[..end];
        let share = v.splat(share);
        let mut last_r = r[HALO - 1];
        let mut last = [v.splat(0.0); 2];
        for p in HALO..end - HALO + 1 {
            let change = v.mul(share, v.mul_add(kick[p], v.sub(last_r, r[p]), pull[p]));
            last_r = r[p];
            // The first row of forces is in the halo, which is written below.
            if T::COMPENSATED {
                let [speed, rest] = v.two_sum(velocity[p], v.add(velocity_rest[p], change));
                velocity[p] = speed;
                velocity_rest[p] = rest;
                let apart = v.add(v.sub(last[0], speed), v.sub(last[1], rest));
                last = [speed, rest];
                let change = v.mul_add(drift[p - 1], apart, force_rest[p - 1]);
                [after[p - 1], force_rest[p - 1]] = v.two_sum(before[p - 1], change);
            } else {
                let speed = v.add(velocity[p], change);
                after[p - 1] = v.mul_add(drift[p - 1], v.sub(last[0], speed), before[p - 1]);
                velocity[p] = speed;
                last[0] = speed;
            }
        }
        self.layout.fill_halos(v, &mut self.force[1]);
        if T::COMPENSATED {
            self.layout.fill_halos(v, &mut self.force_rest);
        }
    }

    /// The second half of a step's kick, where a stretch ends.
    fn half_kick(&mut self, c: &Coefficients<T>) {
        let r = &self.scratch[0];
        for place in HALO * LANES..self.layout.len() - HALO * LANES {
            let apart = r[place - LANES].to_f64() - r[place].to_f64();
            let change = 0.5 * c.kick[place].to_f64().mul_add(apart, self.pull[place].to_f64());
            let [speed, rest] = two_sum(self.velocity[place].to_f64(), self.velocity_rest[place].to_f64() + change);
            (self.velocity[place], self.velocity_rest[place]) = (T::from_f64(speed), T::from_f64(rest));
        }
    }

    /// Pulls on the masses, and from them `q = h k (pull_{i+1} - pull_i)`.
    #[inline(always)]
    fn find_bend<S: Simd, const H: usize>(&mut self, v: Rows<S, H, T>, c: &Coefficients<T>, stretch: &Stretch) {
        let end = self.layout.rows + 2 * HALO;
        let (kick, drift) = (&v.of(&c.kick)[..end], &v.of(&c.drift)[..end]);
        let (force, rest) = (&v.of(&self.force[1])[..end], &v.of(&self.force_rest)[..end]);
        let (tiny, width) = (v.of(&self.tiny)[0], v.of(&c.width)[0]);
        let mut sources = &*self.sources;
        let mut done = HALO;
        for block in 0..self.layout.blocks() {
            let inner = self.layout.block(block);
            let to = inner.end;
            let pull = &mut v.of_mut(&mut self.pull)[..end];
            for p in done..to + 1 {
                let mut apart = v.sub(force[p - 1], force[p]);
                if T::COMPENSATED {
                    apart = v.add(apart, v.sub(rest[p - 1], rest[p]));
                }
                pull[p] = v.sub(v.mul_add(kick[p], apart, tiny), tiny);
            }
            while let Some((&(place, chain), rest)) = sources.split_first().filter(|of| of.0.0 < (to + 1) * LANES) {
                let apart = |g: &[T]| g[place - LANES].to_f64() - g[place].to_f64();
                let outside = (apart(&self.force[1]) + apart(&self.force_rest)) + stretch.force[chain];
                self.pull[place] = T::from_f64(c.kick[place].to_f64() * outside);
                sources = rest;
            }
            done = to + 1;
            let pull = &v.of(&self.pull)[..end];
            let bend = &mut v.of_mut(&mut self.bend[1])[..end];
            let mut energy = v.splat(0.0);
            for p in inner {
                let apart = v.sub(pull[p + 1], pull[p]);
                let q = v.mul(drift[p], apart);
                bend[p] = q;
                energy = v.mul_add(q, apart, energy);
            }
            let energy = v.mul(energy, width);
            let last = &mut v.of_mut(&mut self.energy)[HALO + block];
            v.of_mut(&mut self.larger_energy)[HALO + block] = v.max(*last, energy);
            *last = energy;
        }
        self.layout.fill_halos(v, &mut self.larger_energy);
        self.layout.fill_halos(v, &mut self.bend[1]);
    }
}

/// `next = (second + X first) q + X^2 from`, where `IS_FIRST` with `scale X^2 from` as its last term. `q` and `from` have filled halos;
/// those of `next` are to be filled.
#[inline(always)]
fn two_powers<S: Simd, const H: usize, T: Number, const IS_FIRST: bool>(
    v: Rows<S, H, T>,
    c: &Coefficients<T>,
    [q, from]: [&[T]; 2],
    next: &mut [T],
    [scale, first, second]: [f64; 3],
) {
    let end = c.kick.len() / LANES;
    let (kick, drift) = (&v.of(&c.kick)[..end], &v.of(&c.drift)[..end]);
    let (q, from) = (&v.of(q)[..end], &v.of(from)[..end]);
    let next = &mut v.of_mut(next)[..end];
    let [scale, first, second] = [scale, first, second].map(|x| v.splat(x));
    let scaled = |row: Row<S, H, T>| if IS_FIRST { v.mul(scale, row) } else { row };
    // r and w of the row before; the same of the first sum, one row later.
    let mut r = scaled(from[HALO - 1]);
    let mut w = v.mul(kick[HALO - 1], v.sub(scaled(from[HALO - 2]), r));
    let (mut sum, mut w_of_sum) = (v.splat(0.0), v.splat(0.0));
    let mut last_q = v.splat(0.0);
    for p in HALO - 1..end - HALO + 1 {
        let next_r = scaled(from[p + 1]);
        let next_w = v.mul(kick[p + 1], v.sub(r, next_r));
        let next_sum = v.mul_add(drift[p], v.sub(next_w, w), v.mul(first, q[p]));
        (r, w) = (next_r, next_w);
        let next_w = v.mul(kick[p], v.sub(sum, next_sum));
        // The first two rows are in the halo, which is written later.
        next[p - 1] = v.mul_add(drift[p - 1], v.sub(next_w, w_of_sum), v.mul(second, last_q));
        (sum, w_of_sum, last_q) = (next_sum, next_w, q[p]);
    }
}

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
mod tests;
