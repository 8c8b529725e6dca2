//! Lower and upper step functions of a front, and from their sums bounds on a spring's force.
//!
//! A front P of distance d rises to its top at the first zero of J_nu, nu = 2d, and then swings about 1 with falling extremes, at the
//! zeros j_k of J_nu. Three facts bound it from both sides; the first two are proved:
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
//! On the flank the steps' heights are values of [`super::forms`], with a margin over the errors found, not proved.

use super::forms::{Points, Shape, UNSEEN};

/// Breakpoints around the top, in units of d^(1/3) from it, and where the forms need not be asked: far ahead, where the front is
/// under the [`PRECURSOR`].
const FAR_AHEAD: [f64; 4] = [-9.0, -7.5, -6.0, -4.4];
const AROUND: [f64; 11] = [-3.0, -2.0, -1.4, -1.0, -0.7, -0.45, -0.25, -0.1, 0.1, 0.25, 0.5];
/// Place in [`AROUND`] of the step that holds the top.
const TOP: usize = 7;
/// Behind, where the envelope holds.
const BEHIND: [f64; 12] = [1.5, 2.1, 3.2, 5.0, 9.0, 18.0, 40.0, 90.0, 200.0, 500.0, 1500.0, 5000.0];
/// Twice the integral of Ai from where the uniform variable is at least 15.6, 12.6, 9.6 and 6.4 on: those are the breakpoints of
/// [`FAR_AHEAD`] by the tangent of zeta at the front, which zeta lies above.
const PRECURSOR: [f64; 4] = [1e-19, 1e-14, 4e-10, 4e-6];
/// What the second and the third extreme cannot pass: the envelope at `x - nu >= 3.244 nu^(1/3)` and `4.381 nu^(1/3)`, which the
/// zeros lie beyond (C. K. Qu and R. Wong, *Trans. Amer. Math. Soc.* 351 (1999) 2833-2859).
const AFTER: [f64; 2] = [0.80, 1.16];
/// The first extreme is less than this over 1: the envelope at 1.855 nu^(1/3).
const HIGHEST: f64 = 0.3;
/// Steps of a front.
pub const STEPS: usize = 1 + FAR_AHEAD.len() + AROUND.len() + BEHIND.len();
/// Values of the forms that the steps of a front need, the top among them.
pub const ASKED: usize = AROUND.len() + 1;

/// Bounds on a front: from each breakpoint to the next it is between `low` and `high`.
#[derive(Clone, Copy)]
pub struct Stairs {
    /// Times since the front set out.
    pub from: [f64; STEPS],
    pub low: [f64; STEPS],
    pub high: [f64; STEPS],
}

impl Default for Stairs {
    fn default() -> Stairs {
        Stairs { from: [0.0; STEPS], low: [0.0; STEPS], high: [0.0; STEPS] }
    }
}

/// Time at which the front of order nu has its first top: half of the first zero of J_nu (DLMF 10.21.40), to 0.5 % of nu^(1/3).
pub fn top(order: f64, root: f64) -> f64 {
    0.5 * (order + 1.855_757_1 * root + 1.033_15 / root)
}

/// Asks for the values that [`Stairs::new`] needs.
pub fn ask(points: &mut Points, order: f64, root: f64) {
    let (top, unit) = (top(order, root), root * UNIT);
    for c in AROUND {
        points.push(order, root, 2.0 * (top + c * unit));
    }
    points.push(order, root, 2.0 * top);
}

/// d^(1/3) / nu^(1/3)
const UNIT: f64 = 0.793_700_525_984_099_8;

/// Where the front of order nu first matters.
pub fn start(order: f64, root: f64) -> f64 {
    top(order, root) + FAR_AHEAD[0] * UNIT * root
}

impl Stairs {
    /// The steps of a front of order nu, from the values asked for with [`ask`].
    /// Those that begin behind the horizon are left out.
    pub fn new(order: f64, root: f64, shapes: &[Shape], horizon: f64) -> Stairs {
        let (top, unit) = (top(order, root), root * UNIT);
        let value = |k: usize| shapes[k].value;
        let error_estimate = shapes.iter().fold(0.0f64, |a, s| a.max(s.error_estimate)).max(UNSEEN);
        let mut stairs = Stairs::default();
        stairs.high[0] = PRECURSOR[0];
        let around = 1 + FAR_AHEAD.len();
        let behind = around + AROUND.len();
        for (k, c) in FAR_AHEAD.into_iter().enumerate() {
            stairs.from[1 + k] = top + c * unit;
            stairs.high[1 + k] = PRECURSOR.get(k + 1).copied().unwrap_or(value(0) + error_estimate);
        }
        for (k, c) in AROUND.into_iter().enumerate() {
            let here = value(k);
            let (low, high) = if k < TOP {
                (here, value(k + 1))
            } else if k == TOP {
                (here.min(value(k + 1)), value(AROUND.len()) + error_estimate)
            } else {
                (AFTER[0], here.max(AFTER[1]))
            };
            stairs.from[around + k] = top + c * unit;
            stairs.low[around + k] = (low - error_estimate).max(0.0);
            stairs.high[around + k] = high + error_estimate;
        }
        for (k, c) in BEHIND.into_iter().enumerate() {
            let t = top + c * unit;
            stairs.from[behind + k] = t;
            if t > horizon {
                stairs.from[behind + k..].fill(f64::INFINITY);
                break;
            }
            let swing = envelope(order, 2.0 * t);
            stairs.low[behind + k] = AFTER[0].max(1.0 - swing);
            stairs.high[behind + k] = 1.0 + swing.min(HIGHEST);
        }
        stairs.from.iter_mut().for_each(|t| *t = t.max(0.0));
        stairs
    }
}

/// How far from 1 the front of order nu can be from x on, beyond its first top; infinite where that is not known.
fn envelope(order: f64, x: f64) -> f64 {
    let square = (x - order) * (x + order);
    let w = square.sqrt();
    let q = std::f64::consts::TAU * x * x / (square * w);
    if q.is_nan() || q > 0.31 {
        return f64::INFINITY;
    }
    let zero = square * (1.0 - 1.3 * q);
    let root = zero.sqrt();
    std::f64::consts::FRAC_2_PI.sqrt() * order / (root * root.sqrt())
}

/// Bounds on a spring's force from one instant to the next.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    pub from: f64,
    pub to: f64,
    pub low: f64,
    pub high: f64,
}

/// A front on its way to a spring: its steps begin `delay` later, and count `size` times.
pub struct DelayedFront<'a> {
    stairs: &'a Stairs,
    delay: f64,
    size: f64,
    step: usize,
    /// When the next step begins.
    next: f64,
    ends: [f64; 2],
}

impl<'a> DelayedFront<'a> {
    /// At time 0.
    pub fn new(stairs: &'a Stairs, delay: f64, size: f64) -> DelayedFront<'a> {
        let mut delayed = DelayedFront { stairs, delay, size, step: 0, next: 0.0, ends: [0.0; 2] };
        delayed.set_step(0);
        delayed
    }

    fn set_step(&mut self, step: usize) {
        let (low, high) = (self.size * self.stairs.low[step], self.size * self.stairs.high[step]);
        self.step = step;
        self.ends = if self.size > 0.0 { [low, high] } else { [high, low] };
        self.next = self.stairs.from.get(step + 1).map_or(f64::INFINITY, |t| t + self.delay);
    }
}

/// Bounds on a spring's force up to the horizon: sums of its fronts' steps. `also` is one more breakpoint.
pub fn bound_force(delayed_fronts: &mut [DelayedFront], initial: f64, also: f64, horizon: f64, out: &mut Vec<Segment>) {
    out.clear();
    let mut from = 0.0;
    loop {
        let mut to = if also > from { also.min(horizon) } else { horizon };
        let (mut low, mut high) = (initial, initial);
        for delayed in delayed_fronts.iter_mut() {
            while delayed.next <= from {
                delayed.set_step(delayed.step + 1);
            }
            low += delayed.ends[0];
            high += delayed.ends[1];
            to = to.min(delayed.next);
        }
        out.push(Segment { from, to, low, high });
        if to >= horizon {
            return;
        }
        from = to;
    }
}

#[cfg(test)]
mod tests {
    use super::super::rows;
    use super::*;

    /// Every front lies between its steps at all times.
    #[test]
    fn fronts_are_between_their_steps() {
        let horizon = 3000.0;
        let orders: Vec<f64> = (1..1200).map(|d| 2.0 * d as f64).collect();
        let mut points = Points::default();
        orders.iter().for_each(|&order| ask(&mut points, order, order.cbrt()));
        points.evaluate();
        let stairs: Vec<Stairs> = orders
            .iter()
            .zip(points.shape.chunks(ASKED))
            .map(|(&order, shapes)| Stairs::new(order, order.cbrt(), shapes, horizon))
            .collect();
        let times = (1..160).map(|k| 0.3 * k as f64).chain((1..160).map(|k| 18.7 * k as f64));
        for t in times {
            let exact = rows::values_and_slopes(t);
            for (k, stairs) in stairs.iter().enumerate() {
                let value = exact.get(k + 1).map_or(0.0, |e| e[0]);
                let step = stairs.from.partition_point(|&from| from <= t).max(1) - 1;
                let (low, high) = (stairs.low[step], stairs.high[step]);
                // Rows are right to rounding.
                assert!(
                    low - 1e-13 <= value && value <= high + 1e-13,
                    "t {t} distance {}: {value} {low} {high}",
                    k + 1
                );
            }
        }
    }
}
