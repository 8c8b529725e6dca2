//! A spring's force between the two ends of a step, as a polynomial in time, from the forces around it at both ends.
//!
//! With X = h^2 A, and G less its static value under the step's outside force, a step obeys, mode by mode with theta^2 an eigenvalue of X,
//!
//! ```text
//! G(z) = cos(z theta/2) / cos(theta/2) (G_0 + G_1) / 2 + sin(z theta/2) / sin(theta/2) (G_1 - G_0) / 2,   -1 <= z <= 1
//! ```
//!
//! and both functions are power series in X: forces around a spring at both ends of a step give its force at every instant
//! between them, to rounding.

use std::ops::Range;

use super::local::{COEFFICIENTS, Local};
use super::motion::Motion;
use super::series::{DEGREE, POWERS, table};

/// Springs around the one in question that the series need, and its place among them.
pub(super) const WINDOW: usize = 2 * POWERS - 1;
const CENTRE: usize = POWERS - 1;
/// Coefficients of a force over a step.
pub(super) const TERMS: usize = 2 * DEGREE;
/// One step of a march.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Counted from 0 through the whole march.
    pub number: u64,
    /// Its beginning.
    pub from: f64,
    /// Its length.
    pub width: f64,
    /// Outside force on the source during the step.
    pub force: f64,
}

impl Step {
    /// Its end.
    pub fn end(&self) -> f64 {
        self.from + self.width
    }
}

/// Forces of the springs around at both ends of a step; `at` as for [`piece`].
#[inline(always)]
pub(crate) fn windows(springs: usize, spring: usize, at: impl Fn(usize, usize) -> f64) -> [[f64; WINDOW]; 2] {
    let mut windows = [[0.0; WINDOW]; 2];
    let (places, springs) = around(springs, spring);
    for (end, window) in windows.iter_mut().enumerate() {
        window[places.clone()].iter_mut().zip(springs.clone()).for_each(|(w, s)| *w = at(end, s));
    }
    windows
}

/// Places of a window round a spring that lie in the chain, and the springs there.
#[inline(always)]
pub(super) fn around(springs: usize, spring: usize) -> (Range<usize>, Range<usize>) {
    let from = CENTRE.saturating_sub(spring);
    let until = WINDOW.min(springs + CENTRE - spring);
    (from..until, from + spring - CENTRE..until + spring - CENTRE)
}

/// The force since the event of one spring over a step; `at(end, s)` is G of spring s at the beginning (0) or end (1) of the step, for
/// any s in the chain.
pub fn piece(motion: &Motion, step: &Step, spring: usize, at: impl Fn(usize, usize) -> f64) -> Local {
    let window = windows(motion.ahead.len(), spring, at);
    let mut one = Windows::<1>::NONE;
    one.set(0, motion, step, spring, &window, 1.0);
    local(&super::vectors::widest().dispatch(&mut one), 0, step)
}

/// One lane's polynomial over a step.
pub(super) fn local<const L: usize>(series: &[[f64; L]; TERMS], lane: usize, step: &Step) -> Local {
    let mut coefficient = [0.0; COEFFICIENTS];
    coefficient.iter_mut().zip(series).for_each(|(c, lanes)| *c = lanes[lane]);
    let radius = 0.5 * step.width;
    Local { coefficient, terms: TERMS, center: step.from + radius, radius }
}

/// Springs around those in question, one in each lane: `X` by its parts, the outside force's share, and forces at both ends.
#[derive(Clone)]
pub(super) struct Windows<const L: usize> {
    ahead: [[f64; L]; WINDOW],
    behind: [[f64; L]; WINDOW],
    drive: [[f64; L]; WINDOW],
    /// Mean of both ends, and half their difference.
    sum: [[f64; L]; WINDOW],
    difference: [[f64; L]; WINDOW],
}

impl<const L: usize> Windows<L> {
    pub(super) const NONE: Windows<L> = {
        let none = [[0.0; L]; WINDOW];
        Windows { ahead: none, behind: none, drive: none, sum: none, difference: none }
    };

    /// Sets one lane, with the forces' sign turned or not.
    #[inline]
    pub(super) fn set(
        &mut self,
        lane: usize,
        motion: &Motion,
        step: &Step,
        spring: usize,
        window: &[[f64; WINDOW]; 2],
        sign: f64,
    ) {
        let square = step.width * step.width;
        let pull = sign * step.force * square;
        for (l, (from, to)) in window[0].iter().zip(&window[1]).enumerate() {
            self.sum[l][lane] = 0.5 * sign * (from + to);
            self.difference[l][lane] = 0.5 * sign * (to - from);
        }
        let (places, springs) = around(motion.ahead.len(), spring);
        for (row, of, factor) in [
            (&mut self.ahead, &motion.ahead, square),
            (&mut self.behind, &motion.behind, square),
            (&mut self.drive, &motion.drive, pull),
        ] {
            row[..places.start].iter_mut().for_each(|lanes| lanes[lane] = 0.0);
            row[places.end..].iter_mut().for_each(|lanes| lanes[lane] = 0.0);
            let row = row[places.clone()].iter_mut();
            row.zip(&of[springs.clone()]).for_each(|(lanes, x)| lanes[lane] = factor * x);
        }
    }

    /// Coefficients of the two series at the centres, of the mean and of half the difference in turn.
    #[inline(always)]
    pub(super) fn series(&mut self) -> [[f64; L]; TERMS] {
        // X's powers at the centres.
        let mut powers = [[[0.0; L]; 2]; POWERS];
        for (power, out) in powers.iter_mut().enumerate() {
            *out = [self.sum[CENTRE], self.difference[CENTRE]];
            // Each application makes one more place at the edges invalid.
            for r in [&mut self.sum, &mut self.difference] {
                let mut here = r[power + 1];
                let mut fall = r[power];
                (0..L).for_each(|l| fall[l] -= here[l]);
                for place in power + 1..WINDOW - 1 - power {
                    let after = r[place + 1];
                    let (ahead, behind) = (self.ahead[place], self.behind[place]);
                    for l in 0..L {
                        let next = here[l] - after[l];
                        r[place][l] = behind[l].mul_add(next, -(ahead[l] * fall[l]));
                        fall[l] = next;
                    }
                    here = after;
                }
            }
            if power == 0 {
                for (sum, drive) in self.sum.iter_mut().zip(&self.drive) {
                    (0..L).for_each(|l| sum[l] -= drive[l]);
                }
            }
        }
        let table = table();
        let mut out = [[0.0; L]; TERMS];
        for (m, out) in out.iter_mut().enumerate() {
            let of = if m % 2 == 0 { &table.even } else { &table.odd };
            let mut sum = [0.0_f64; L];
            for (factor, power) in of[m / 2].iter().zip(&powers) {
                (0..L).for_each(|l| sum[l] = factor.mul_add(power[m % 2][l], sum[l]));
            }
            *out = sum;
        }
        out
    }
}

/// Compiled for the widest vector unit at hand.
impl<const L: usize> pulp::WithSimd for &mut Windows<L> {
    type Output = [[f64; L]; TERMS];

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Self::Output {
        self.series()
    }
}
