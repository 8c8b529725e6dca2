//! A coupler's force near one instant as a polynomial, and its largest value and first crossing there.
//!
//! Branch and bound: on every piece the cubic through both ends' values and slopes (Hermite) is off by at most
//! `h^4 / 384 * max |f''''|`, and the fourth derivative is bounded by the sum of its coefficients' sizes. Pieces whose
//! bound cannot matter are dropped; none is dropped on a guess. A piece that is certainly concave is not split any more:
//! Newton's steps lead to its only maximum, and the last slope bounds their error.

use super::dd::Dd;

/// Number of coefficients: degree 24 gives `cos` over two radians to 1e-17.
pub(crate) const COEFFICIENTS: usize = 25;

/// `f(t) = sum_q coefficient[q] x^q`, x = (t - center) / radius in [-1, 1].
#[derive(Clone, Debug)]
pub struct Local {
    /// Taylor coefficients in x.
    pub coefficient: [f64; COEFFICIENTS],
    /// How many of them there are; the others are zero.
    pub terms: usize,
    /// Instant of x = 0.
    pub center: f64,
    /// Time of a unit of x.
    pub radius: f64,
}

/// A value and where it is taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// x for a [`Local`], time elsewhere.
    pub at: f64,
    /// Value there.
    pub value: f64,
}

/// A piece of the line with values and slopes at both ends.
#[derive(Clone, Copy)]
struct Piece {
    a: f64,
    b: f64,
    fa: f64,
    fb: f64,
    da: f64,
    db: f64,
}

impl Local {
    /// A polynomial over a step from 0 to 1, lowest power first, about the middle of the step.
    pub fn of_step(c: &[f64], from: f64, width: f64) -> Local {
        let mut shifted = [0.0; COEFFICIENTS];
        shifted[..c.len()].copy_from_slice(c);
        for j in 0..c.len() {
            for k in (j..c.len() - 1).rev() {
                shifted[k] += 0.5 * shifted[k + 1];
            }
        }
        let mut half = 1.0;
        for s in &mut shifted {
            *s *= half;
            half *= 0.5;
        }
        Local { coefficient: shifted, terms: c.len(), center: from + 0.5 * width, radius: 0.5 * width }
    }

    /// The same with the sign turned: its largest value is minus the smallest of `self`.
    pub(crate) fn negated(&self) -> Local {
        Local { coefficient: self.coefficient.map(|c| -c), ..*self }
    }

    /// Time of x, never negative.
    #[inline]
    pub fn time(&self, x: f64) -> f64 {
        (self.center + self.radius * x).max(0.0)
    }

    /// Value at a time that is a sum of two numbers.
    #[inline]
    pub(crate) fn value_at(&self, time: Dd) -> f64 {
        self.value_and_slope((time - Dd::from(self.center)).to_f64() / self.radius).0
    }

    /// Value and slope (per unit of x) at x.
    #[inline]
    pub(crate) fn value_and_slope(&self, x: f64) -> (f64, f64) {
        let (mut value, mut slope) = (0.0, 0.0);
        for &c in self.coefficient[..self.terms].iter().rev() {
            slope = slope * x + value;
            value = value * x + c;
        }
        (value, slope)
    }

    /// Bounds on the third and the fourth derivative over |x| <= 1.
    fn third_and_fourth(&self) -> [f64; 2] {
        let (mut third, mut fourth) = (0.0, 0.0);
        for q in 3..self.terms {
            let size = (q * (q - 1) * (q - 2)) as f64 * self.coefficient[q].abs();
            third += size;
            fourth += (q - 3) as f64 * size;
        }
        [third, fourth]
    }

    /// An upper bound on the value over each of `pieces` equal pieces of [-1, 1], from values and slopes at their ends.
    pub(crate) fn upper_bounds(&self, pieces: usize) -> impl Iterator<Item = f64> {
        let [_, fourth] = self.third_and_fourth();
        let h = 2.0 / pieces as f64;
        let margin = h.powi(4) / 384.0 * fourth;
        let end = move |k: usize| -1.0 + h * k as f64;
        (0..pieces).map(move |k| self.piece(end(k), end(k + 1)).hermite_top().value + margin)
    }

    fn piece(&self, a: f64, b: f64) -> Piece {
        let ((fa, da), (fb, db)) = (self.value_and_slope(a), self.value_and_slope(b));
        Piece { a, b, fa, fb, da, db }
    }

    fn split(&self, p: &Piece, x: f64) -> [Piece; 2] {
        let (f, d) = self.value_and_slope(x);
        [Piece { b: x, fb: f, db: d, ..*p }, Piece { a: x, fa: f, da: d, ..*p }]
    }

    /// The largest value over [a, b] if it is over `floor`; otherwise `None`. Right to a few units of rounding.
    pub fn largest(&self, a: f64, b: f64, floor: f64) -> Option<Point> {
        let [third, fourth] = self.third_and_fourth();
        let first = self.piece(a, b);
        let mut best = Point { at: a, value: first.fa };
        if first.fb > best.value {
            best = Point { at: b, value: first.fb };
        }
        // The stack is only allocated if the first piece is not enough.
        let (mut next, mut open) = (Some(first), Vec::new());
        while let Some(p) = next.take().or_else(|| open.pop()) {
            let h = p.b - p.a;
            let top = p.hermite_top();
            let margin = h.powi(4) / 384.0 * fourth;
            let bound = top.value + margin;
            if bound <= floor || bound <= best.value + 1e-16 * best.value.abs() || h < 1e-9 {
                continue;
            }
            // The second derivative is nowhere further than h times the third's bound from its mean over the piece.
            let bend = (p.db - p.da) / h + h * third;
            if bend < 0.0 && self.top_of(&p, top.at, bend, &mut best) {
                continue;
            }
            let x = top.at.clamp(p.a + 0.1 * h, p.b - 0.1 * h);
            let halves = self.split(&p, x);
            if halves[0].fb > best.value {
                best = Point { at: x, value: halves[0].fb };
            }
            let [left, right] = halves;
            open.push(left);
            open.push(right);
        }
        let best = self.polish(best, a, b);
        (best.value > floor).then_some(best)
    }

    /// The top of a piece whose second derivative is at most `bend` < 0, from a point near it; whether it is right to rounding.
    fn top_of(&self, p: &Piece, near: f64, bend: f64, best: &mut Point) -> bool {
        // A monotonic piece has its top at an end, which is known.
        if p.da <= 0.0 || p.db >= 0.0 {
            return true;
        }
        let top = self.polish(Point { at: near, value: f64::NEG_INFINITY }, p.a, p.b);
        let (value, slope) = self.value_and_slope(top.at);
        if value > best.value {
            *best = Point { at: top.at, value };
        }
        slope * slope / (-2.0 * bend) <= 1e-16 * value.abs()
    }

    /// Newton steps to the nearest zero of the slope, kept only where they do not lower the value.
    fn polish(&self, mut best: Point, a: f64, b: f64) -> Point {
        for _ in 0..4 {
            let (mut value, mut slope, mut bend) = (0.0, 0.0, 0.0);
            for &c in self.coefficient[..self.terms].iter().rev() {
                bend = bend * best.at + 2.0 * slope;
                slope = slope * best.at + value;
                value = value * best.at + c;
            }
            let x = best.at - slope / bend;
            if !(bend < 0.0 && x > a && x < b) {
                break;
            }
            let (value_there, _) = self.value_and_slope(x);
            if value_there < best.value - 4e-16 * best.value.abs() {
                break;
            }
            // Newton's steps square the distance from the top.
            let is_there = (x - best.at).abs() < 1e-8;
            best = Point { at: x, value: value_there.max(best.value) };
            if is_there {
                break;
            }
        }
        best
    }

    /// The first x in [a, b] at which the value passes over `level`; `None` if it never does.
    pub fn first_over(&self, a: f64, b: f64, level: f64) -> Option<f64> {
        let [third, fourth] = self.third_and_fourth();
        let (mut next, mut open) = (Some(self.piece(a, b)), Vec::new());
        while let Some(p) = next.take().or_else(|| open.pop()) {
            if p.fa > level {
                return Some(p.a);
            }
            let h = p.b - p.a;
            // Within the piece the slope is at most h^2 / 8 max |f'''| under the smaller of its end values: it is positive here.
            if p.fb > level && p.da.min(p.db) > 0.125 * h * h * third {
                return Some(self.root(&p, level));
            }
            if p.hermite_top().value + h.powi(4) / 384.0 * fourth <= level {
                continue;
            }
            if h < 1e-7 {
                if p.fb > level {
                    return Some(self.root(&p, level));
                }
                continue;
            }
            let [left, right] = self.split(&p, 0.5 * (p.a + p.b));
            open.push(right);
            open.push(left);
        }
        None
    }

    /// The crossing in a piece whose ends lie on both sides of the level: by Newton's steps, or by bisection where one
    /// leaves the bracket.
    fn root(&self, p: &Piece, level: f64) -> f64 {
        let (mut a, mut b) = (p.a, p.b);
        let mut x = p.a + (p.b - p.a) * ((level - p.fa) / (p.fb - p.fa));
        for _ in 0..60 {
            let (value, slope) = self.value_and_slope(x);
            if value > level {
                b = x;
            } else {
                a = x;
            }
            let step = x - (value - level) / slope;
            let next = if step >= a && step <= b { step } else { 0.5 * (a + b) };
            if (next - x).abs() < 1e-15 {
                break;
            }
            x = next;
        }
        x
    }
}

impl Piece {
    fn hermite_top(&self) -> Point {
        let top = hermite_top(self.b - self.a, [self.fa, self.da], [self.fb, self.db]);
        Point { at: self.a + top.at, value: top.value }
    }
}

#[inline(always)]
fn more(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[inline(always)]
fn less(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// Polynomials in x of `T` terms, lowest power first, one in each of `L` lanes.
pub(crate) struct Locals<const T: usize, const L: usize> {
    pub coefficient: [[f64; L]; T],
}

/// Largest values of polynomials over -1 <= x <= end, where they are taken, and the values at `end`.
pub(crate) struct Tops<const L: usize> {
    pub at: [f64; L],
    pub value: [f64; L],
    /// Whether the largest value is right to rounding and the polynomial rises from -1 up to it; if not, [`Local::largest`] finds it.
    pub is_certain: [bool; L],
    pub at_end: [f64; L],
}

impl<const T: usize, const L: usize> Locals<T, L> {
    #[inline(always)]
    fn value_and_slope(&self, x: [f64; L]) -> [[f64; L]; 2] {
        let (mut value, mut slope) = ([0.0_f64; L], [0.0_f64; L]);
        for c in self.coefficient.iter().rev() {
            for l in 0..L {
                slope[l] = slope[l].mul_add(x[l], value[l]);
                value[l] = value[l].mul_add(x[l], c[l]);
            }
        }
        [value, slope]
    }

    /// Slope and half the second derivative.
    #[inline(always)]
    fn slope_and_bend(&self, x: [f64; L]) -> [[f64; L]; 2] {
        let (mut value, mut slope, mut bend) = (self.coefficient[T - 1], [0.0_f64; L], [0.0_f64; L]);
        for c in self.coefficient[1..T - 1].iter().rev() {
            for l in 0..L {
                bend[l] = bend[l].mul_add(x[l], slope[l]);
                slope[l] = slope[l].mul_add(x[l], value[l]);
                value[l] = value[l].mul_add(x[l], c[l]);
            }
        }
        for l in 0..L {
            bend[l] = bend[l].mul_add(x[l], slope[l]);
            slope[l] = slope[l].mul_add(x[l], value[l]);
        }
        [slope, bend]
    }

    /// Over |x| <= 1, an upper bound on the second derivative, and bounds on the sizes of the second and the third.
    #[inline(always)]
    fn bounds(&self) -> [[f64; L]; 3] {
        let [mut upper, mut second, mut third] = [[0.0; L]; 3];
        for (q, c) in self.coefficient.iter().enumerate().skip(2) {
            let (twice, thrice) = ((q * (q - 1)) as f64, (q * (q - 1) * (q - 2)) as f64);
            for l in 0..L {
                let size = c[l].abs();
                let most = if q == 2 {
                    c[l]
                } else if q % 2 == 0 {
                    c[l].max(0.0)
                } else {
                    size
                };
                upper[l] += twice * most;
                second[l] += twice * size;
                third[l] += thrice * size;
            }
        }
        [upper, second, third]
    }

    /// The largest values over -1 <= x <= `end`, from points near them: where a polynomial is concave or monotonic, by Newton's steps.
    #[inline(always)]
    pub fn tops(&self, near: [f64; L], end: [f64; L]) -> Tops<L> {
        let ([_, rise], [last, fall]) = (self.value_and_slope([-1.0; L]), self.value_and_slope(end));
        let [bend, _, third] = self.bounds();
        let (mut at, mut is_certain, mut turns) = (near, [false; L], [false; L]);
        for l in 0..L {
            let h = end[l] + 1.0;
            // Within the step the slope is at most h^2 / 8 max |f'''| beyond its end values.
            let slack = 0.125 * h * h * third[l];
            let is_concave = bend[l] < 0.0;
            let rises = (less(rise[l], fall[l]) > slack) | (is_concave & (fall[l] >= 0.0));
            let falls = (more(rise[l], fall[l]) < -slack) | (is_concave & (rise[l] <= 0.0));
            is_certain[l] = rises | falls;
            turns[l] = is_concave & !(rises | falls);
            at[l] = if falls { -1.0 } else { at[l] };
            at[l] = if rises { end[l] } else { at[l] };
        }
        // A lane that has arrived stays, whatever the others do.
        let mut moves = turns;
        for _ in 0..6 {
            let [slope, half_bend] = self.slope_and_bend(at);
            for l in 0..L {
                let next = less(more(at[l] - 0.5 * slope[l] / half_bend[l], -1.0), end[l]);
                let moved = next - at[l];
                at[l] = if moves[l] { next } else { at[l] };
                moves[l] &= moved.abs() > 1e-8;
            }
            if !moves.contains(&true) {
                break;
            }
        }
        let [value, slope] = self.value_and_slope(at);
        for l in 0..L {
            // The last slope bounds what is left.
            is_certain[l] |= turns[l] & (slope[l] * slope[l] <= -2e-16 * bend[l] * value[l].abs());
        }
        Tops { at, value, is_certain, at_end: last }
    }

    /// Where polynomials that rise from -1 to `until` pass a level that lies below their values there, in the lanes asked for: by Newton's
    /// steps, or by bisection where one leaves the bracket. NaN in other lanes and where it is not found to rounding.
    #[inline(always)]
    pub fn crossings(&self, level: [f64; L], until: [f64; L], asked: [bool; L]) -> [f64; L] {
        if !asked.contains(&true) {
            return [f64::NAN; L];
        }
        let ([first, rise], [last, _], [_, second, _]) =
            (self.value_and_slope([-1.0; L]), self.value_and_slope(until), self.bounds());
        let (mut a, mut b, mut x) = ([-1.0; L], until, [-1.0; L]);
        for l in 0..L {
            // By the parabola through both ends.
            let (h, missing) = (until[l] + 1.0, level[l] - first[l]);
            let curve = (last[l] - first[l] - rise[l] * h) / (h * h);
            let root = more(rise[l] * rise[l] + 4.0 * curve * missing, 0.0).sqrt();
            x[l] = less(more(2.0 * missing / (rise[l] + root) - 1.0, -1.0), until[l]);
        }
        let mut is_there = [false; L];
        for _ in 0..16 {
            let [value, slope] = self.value_and_slope(x);
            let mut left = false;
            for l in 0..L {
                let over = value[l] > level[l];
                b[l] = if over { x[l] } else { b[l] };
                a[l] = if over { a[l] } else { x[l] };
                let step = x[l] - (value[l] - level[l]) / slope[l];
                let is_inside = (step >= a[l]) & (step <= b[l]);
                let next = if is_inside { step } else { 0.5 * (a[l] + b[l]) };
                let moved = next - x[l];
                x[l] = if is_there[l] { x[l] } else { next };
                // Newton's steps square the distance.
                is_there[l] |= is_inside & (moved * moved * second[l] <= 1e-16 * slope[l]) | (a[l] == b[l]);
                left |= asked[l] & !is_there[l];
            }
            if !left {
                break;
            }
        }
        (0..L).for_each(|l| x[l] = if asked[l] & is_there[l] { x[l] } else { f64::NAN });
        x
    }
}

/// A quick bound from above on `sign` times a polynomial over a step from 0 to 1, lowest power first.
pub(crate) fn reach(c: &[f64], sign: f64) -> f64 {
    let end: f64 = c.iter().rev().sum();
    let bend: f64 = c.iter().enumerate().skip(2).map(|(k, c)| (k * (k - 1)) as f64 * c.abs()).sum();
    (sign * c[0]).max(sign * end) + 0.125 * bend
}

/// The largest value over [0, h] of the cubic with value and slope `left` at 0 and `right` at h.
#[inline(always)]
pub(crate) fn hermite_top(h: f64, left: [f64; 2], right: [f64; 2]) -> Point {
    hermite_extremes(h, left, right)[0]
}

/// The largest and the smallest value of that cubic.
#[inline(always)]
pub(crate) fn hermite_extremes(h: f64, left: [f64; 2], right: [f64; 2]) -> [Point; 2] {
    let (d0, d1) = (left[1] * h, right[1] * h);
    let rise = right[0] - left[0];
    let c3 = d0 + d1 - 2.0 * rise;
    let c2 = 3.0 * rise - 2.0 * d0 - d1;
    // Roots of 3 c3 s^2 + 2 c2 s + d0, written without cancellation; NaN if there are none.
    let sum = (c2 * c2 - 3.0 * c3 * d0).sqrt() + c2.abs();
    let (small, large) = (d0 / sum, sum / (3.0 * c3));
    let [top, bottom] = if c2 <= 0.0 { [small, large] } else { [-large, -small] };
    let point = |s: f64, sign: f64| {
        let is_right = sign * right[0] > sign * left[0];
        let [at, value] = if is_right { [h, right[0]] } else { [0.0, left[0]] };
        let inside = left[0] + s * (d0 + s * (c2 + s * c3));
        let is_inside = (s > 0.0) & (s < 1.0) & (sign * inside > sign * value);
        Point { at: if is_inside { s * h } else { at }, value: if is_inside { inside } else { value } }
    };
    [point(top, 1.0), point(bottom, -1.0)]
}

#[cfg(test)]
mod tests;
