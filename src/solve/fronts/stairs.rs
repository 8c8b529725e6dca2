//! Lower and upper step functions of a front, and from their sums bounds on a spring's force.
//!
//! A front P of distance d rises to its top at the first zero of J_nu, nu = 2d, and then swings about 1 with falling extremes, at the
//! zeros j_k of J_nu. Three facts, all proved, bound it from both sides:
//!
//! - Up to the top it rises: J_nu is positive before its first zero.
//! - At its extremes `|P - 1| <= sqrt(2 / pi) nu (x^2 - nu^2)^(-3/4)`. With J = M cos theta and `d theta / dx = 2 / (pi x M^2)`,
//!   `1 - P = nu ∫_x^∞ J / s ds = nu ∫_theta^∞ g cos theta d theta`, g = (pi / 2) M^3. For nu > 1/2 both `p = x M^2` and 1 / x are
//!   completely monotonic in x (L. Lorch and P. Szego, *Acta Math.* 109 (1963) 55-73), `d / d theta = (pi / 2) p d / dx`, and
//!   `p p'' >= p'^2`: g falls, its first derivative rises and its second falls, in theta. Where cos theta = 0, two integrations by
//!   parts leave `nu g` less an alternating integral of the same sign: `|1 - P| <= nu g`; and
//!   `M^2 < (2 / pi) (x^2 - nu^2)^(-1/2)` (G. N. Watson, *Theory of Bessel Functions*, 13.74).
//! - Between zeros P is monotonic, so behind any x the extreme before x bounds it. From one zero to the next
//!   `w - nu acos(nu / x)`, w = sqrt(x^2 - nu^2), grows by less than pi. With q = 2 pi x^2 / w^3 <= 0.31 the last zero
//!   therefore lies where w^2 has at least 1 - 1.3 q of its value at x, and the envelope is larger there by that to the power -3/4.
//!
//! Not proved are the heights on the flank and around the top, which are values of [`super::forms`] with a margin over the errors
//! found; those far ahead ([`PRECURSOR`]); and the allowance for shared steps ([`BETWEEN`]): in units of d^(1/3) from the top the
//! heights hardly depend on the distance, so fronts of nearly the same distance share their steps.

use std::sync::OnceLock;

use super::forms::{Front, LANES, Sums, UNSEEN};

/// Where the steps of a front begin, but for the first: in units of d^(1/3) from the top. First far ahead, where the front is under
/// the [`PRECURSOR`]; then around the top; then behind, where the envelope holds.
const BEGINS: [f64; STEPS - 1] = [
    -9.0, -7.5, -6.0, -4.4, -3.0, -2.0, -1.4, -1.0, -0.7, -0.45, -0.25, -0.1, 0.1, 0.25, 0.5, 1.5, 2.1, 3.2, 5.0, 9.0,
    18.0, 40.0, 90.0, 200.0, 500.0, 1500.0, 5000.0,
];
const STEPS: usize = 28;
/// The first steps whose heights are values around the top; that which holds the top; and the first behind.
const AROUND: usize = 5;
const TOP: usize = 12;
const BEHIND: usize = 16;
/// Twice the integral of Ai from xi = 15.6, 12.6, 9.6 and 6.4 on, where the first four steps end: there xi is at least that much by
/// the tangent of zeta at the front, which zeta lies above. The integral alone is the uniform form's first term; that a front is
/// under twice of it is not proved.
const PRECURSOR: [f64; 4] = [1e-19, 1e-14, 4e-10, 4e-6];
/// What the second and the third extreme cannot pass: the envelope at `x - nu >= 3.244 nu^(1/3)` and `4.381 nu^(1/3)`, which the
/// zeros lie beyond (C. K. Qu and R. Wong, *Trans. Amer. Math. Soc.* 351 (1999) 2833-2859).
const AFTER: [f64; 2] = [0.80, 1.16];
/// The first extreme is less than this over 1: the envelope at 1.855 nu^(1/3).
const HIGHEST: f64 = 0.3;
/// Distances up to this have steps of their own; from there on those of an eighth of an octave share theirs.
const SINGLE: usize = 32;
/// How far the heights of a distance within such a range may lie beyond those of both its ends. Not proved: the heights are nearly
/// linear in nu^(-2/3), of which a range spans 0.004 at most, and none is found beyond (the test below holds without it).
const BETWEEN: f64 = 1e-4;

/// Bounds on the fronts of some distances: from each breakpoint to the next they are between `low` and `high`.
#[derive(Clone, Copy, Debug)]
pub struct Stairs {
    low: [f64; STEPS],
    high: [f64; STEPS],
}

/// The steps of all fronts at distances under 2^32, by their [`place`].
pub fn all() -> &'static [Stairs] {
    static ALL: OnceLock<Vec<Stairs>> = OnceLock::new();
    struct All;
    impl pulp::WithSimd for All {
        type Output = Vec<Stairs>;

        #[inline(always)]
        fn with_simd<S: pulp::Simd>(self, _: S) -> Vec<Stairs> {
            let mut all = Vec::new();
            for place in 0..place(1 << 32) {
                all.push(Stairs::between(distances(place)));
            }
            all
        }
    }
    ALL.get_or_init(|| crate::solve::vectors::widest().dispatch(All))
}

/// Place of a distance's steps among those of all.
pub fn place(distance: usize) -> usize {
    if distance < SINGLE {
        return distance.max(1) - 1;
    }
    let octave = distance.ilog2();
    SINGLE - 1 + 8 * (octave - SINGLE.ilog2()) as usize + (distance >> (octave - 3)) - 8
}

/// The least and the largest distance of a place.
fn distances(place: usize) -> [usize; 2] {
    if place < SINGLE - 1 {
        return [place + 1; 2];
    }
    let (octave, eighth) = ((place + 1 - SINGLE) / 8, (place + 1 - SINGLE) % 8);
    let scale = (SINGLE / 8) << octave;
    [(8 + eighth) * scale, (9 + eighth) * scale - 1]
}

/// Time at which the front of order nu has its first top: half of the first zero of J_nu (DLMF 10.21.40), to 0.9 % of nu^(1/3).
pub fn top(order: f64, root: f64) -> f64 {
    0.5 * (order + 1.855_757_1 * root + 1.033_15 / root)
}

/// d^(1/3) / nu^(1/3)
pub const UNIT: f64 = 0.793_700_525_984_099_8;

/// Where the front of order nu first matters.
pub fn start(order: f64, root: f64) -> f64 {
    top(order, root) + BEGINS[0] * UNIT * root
}

impl Stairs {
    /// The steps of the fronts of all distances from one to another.
    #[inline(always)]
    fn between(distances: [usize; 2]) -> Stairs {
        let orders = [2.0 * distances[0] as f64, 2.0 * distances[1] as f64];
        let [first, last] = [Stairs::around_top(orders[0]), Stairs::around_top(orders[1])];
        let margin = if orders[0] < orders[1] { BETWEEN } else { 0.0 };
        let mut stairs = first;
        for k in PRECURSOR.len()..BEHIND {
            stairs.low[k] = (first.low[k].min(last.low[k]) - margin).max(0.0);
            stairs.high[k] = first.high[k].max(last.high[k]) + margin;
        }
        for k in BEHIND..STEPS {
            let [first, last] = orders.map(|order| envelope(order, BEGINS[k - 1]));
            let swing = first[0].max(last[0]) * first[1].max(last[1]);
            stairs.low[k] = AFTER[0].max(1.0 - swing);
            stairs.high[k] = 1.0 + swing.min(HIGHEST);
        }
        stairs
    }

    /// The steps of the front of order nu up to those behind.
    #[inline(always)]
    fn around_top(order: f64) -> Stairs {
        let root = order.cbrt();
        let (front, top) = (Front::new(order, root), top(order, root));
        // At the breakpoints up to the top, at the top, and at those after it.
        let (mut values, mut error_estimate) = ([0.0; 16], UNSEEN);
        for (chunk, values) in values.chunks_mut(LANES).enumerate() {
            let mut x = [0.0; LANES];
            for (l, x) in x.iter_mut().enumerate() {
                let offset = match chunk * LANES + l + AROUND - 1 {
                    k if k < TOP => BEGINS[k],
                    TOP => 0.0,
                    k => BEGINS[(k - 1).min(BEHIND - 2)],
                };
                *x = 2.0 * (top + offset * UNIT * root);
            }
            let mut sums = Sums::default();
            sums.add(&front, 1.0, &x);
            values.copy_from_slice(&sums.value);
            error_estimate = error_estimate.max(sums.error_estimate);
        }
        let mut stairs = Stairs { low: [0.0; STEPS], high: [0.0; STEPS] };
        stairs.high[..PRECURSOR.len()].copy_from_slice(&PRECURSOR);
        let value = |k: usize| values[k - AROUND];
        for k in PRECURSOR.len()..BEHIND {
            let (low, high) = match k {
                k if k < AROUND => (0.0, value(AROUND)),
                k if k < TOP => (value(k), value(k + 1)),
                TOP => (value(TOP).min(value(TOP + 2)), value(TOP + 1) + error_estimate),
                k => (AFTER[0], value(k + 1).max(AFTER[1])),
            };
            stairs.low[k] = (low - error_estimate).max(0.0);
            stairs.high[k] = high + error_estimate;
        }
        stairs
    }
}

/// The two factors of how far from 1 the front of order nu can be from `top + c d^(1/3)` on: its envelope there, which rises with
/// nu, and by how much it is larger at the zero before, which falls with nu; infinite where that is not known.
#[inline(always)]
fn envelope(order: f64, c: f64) -> [f64; 2] {
    let root = order.cbrt();
    let x = 2.0 * (top(order, root) + c * UNIT * root);
    let square = (x - order) * (x + order);
    let power = |a: f64| 1.0 / (a.sqrt() * a.sqrt().sqrt());
    let q = std::f64::consts::TAU * x * x / (square * square.sqrt());
    let widening = if q <= 0.31 { power(1.0 - 1.3 * q) } else { f64::INFINITY };
    [std::f64::consts::FRAC_2_PI.sqrt() * order * power(square), widening]
}

/// Bounds on a spring's force from one instant to the next.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    pub from: f64,
    pub to: f64,
    pub low: f64,
    pub high: f64,
}

/// A front on its way to a spring: its steps count `size` times.
pub struct DelayedFront<'a> {
    stairs: &'a Stairs,
    /// When its top is there, and d^(1/3).
    top: f64,
    unit: f64,
    size: f64,
    step: usize,
    /// When the next step begins.
    next: f64,
    low: f64,
    high: f64,
}

impl<'a> DelayedFront<'a> {
    /// At its first step, long before its top.
    #[inline(always)]
    pub fn new(stairs: &'a Stairs, top: f64, unit: f64, size: f64) -> DelayedFront<'a> {
        let mut delayed = DelayedFront { stairs, top, unit, size, step: 0, next: 0.0, low: 0.0, high: 0.0 };
        delayed.set_step(0);
        delayed
    }

    #[inline(always)]
    fn set_step(&mut self, step: usize) {
        let (low, high) = (self.size * self.stairs.low[step], self.size * self.stairs.high[step]);
        self.step = step;
        (self.low, self.high) = (low.min(high), low.max(high));
        self.next = BEGINS.get(step).map_or(f64::INFINITY, |c| self.top + c * self.unit);
    }
}

/// Bounds on a spring's force up to the horizon: `initial` and the sums of its fronts' steps. A front is left out before its first
/// breakpoint, where it is under 1e-19. `also` is an instant at which a segment ends in any case.
#[inline(always)]
pub fn bound_force(delayed_fronts: &mut [DelayedFront], initial: f64, also: f64, horizon: f64, out: &mut Vec<Segment>) {
    out.clear();
    delayed_fronts.sort_unstable_by(|a, b| a.next.total_cmp(&b.next));
    let (mut from, mut arrived) = (0.0, 0);
    loop {
        let mut to = if also > from { also.min(horizon) } else { horizon };
        let (mut low, mut high) = (initial, initial);
        while delayed_fronts.get(arrived).is_some_and(|d| d.next <= from) {
            arrived += 1;
        }
        if let Some(coming) = delayed_fronts.get(arrived) {
            to = to.min(coming.next);
        }
        for delayed in delayed_fronts[..arrived].iter_mut() {
            while delayed.next <= from {
                delayed.set_step(delayed.step + 1);
            }
            low += delayed.low;
            high += delayed.high;
            to = if delayed.next < to { delayed.next } else { to };
        }
        out.push(Segment { from, to, low, high });
        if to >= horizon {
            return;
        }
        from = to;
    }
}

#[cfg(test)]
mod tests;
