//! Double-double numbers: an unevaluated sum of two `f64`, about 32 significant digits.
//!
//! Algorithms: T. J. Dekker, *Numer. Math.* 18 (1971) 224-242, with a fused multiply-add for the exact product;
//! addition is the accurate variant (relative error < 3 * 2^-106: M. Joldes, J.-M. Muller, V. Popescu, *ACM Trans. Math.
//! Softw.* 44 (2017) 15res, algorithms 6, 12 and 17).

use std::ops::{Add, Div, Mul, Neg, Sub};

/// `hi + lo` with `|lo| <= ulp(hi) / 2`.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Dd {
    /// The nearest `f64`.
    pub hi: f64,
    /// The remainder.
    pub lo: f64,
}

/// What the algorithms are made of: an `f64`, or several side by side.
pub(crate) trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    fn mul_add(self, factor: Self, term: Self) -> Self;
}

impl Real for f64 {
    #[inline(always)]
    fn mul_add(self, factor: f64, term: f64) -> f64 {
        f64::mul_add(self, factor, term)
    }
}

/// `a + b` and its rounding error, any order of magnitudes (Knuth).
#[inline(always)]
pub(crate) fn two_sum<T: Real>(a: T, b: T) -> [T; 2] {
    let s = a + b;
    let t = s - a;
    [s, (a - (s - t)) + (b - t)]
}

/// `a + b` and its rounding error for `|a| >= |b|` (Dekker).
#[inline(always)]
fn fast_two_sum<T: Real>(a: T, b: T) -> [T; 2] {
    let s = a + b;
    [s, b - (s - a)]
}

/// `a * b` and its rounding error.
#[inline(always)]
fn two_product<T: Real>(a: T, b: T) -> [T; 2] {
    let p = a * b;
    [p, a.mul_add(b, -p)]
}

#[inline(always)]
fn sum<T: Real>([a, a_rest]: [T; 2], [b, b_rest]: [T; 2]) -> [T; 2] {
    let [s, e] = two_sum(a, b);
    let [t, f] = two_sum(a_rest, b_rest);
    let [s, e] = fast_two_sum(s, e + t);
    fast_two_sum(s, e + f)
}

#[inline(always)]
fn product<T: Real>([a, a_rest]: [T; 2], [b, b_rest]: [T; 2]) -> [T; 2] {
    let [p, e] = two_product(a, b);
    let e = a_rest.mul_add(b_rest, e);
    let cross = a.mul_add(b_rest, a_rest * b);
    fast_two_sum(p, e + cross)
}

/// `a - b q`
#[inline(always)]
fn remainder<T: Real>(a: [T; 2], [b, b_rest]: [T; 2], q: T) -> [T; 2] {
    let [p, e] = two_product(b, -q);
    sum(a, fast_two_sum(p, b_rest.mul_add(-q, e)))
}

#[inline(always)]
fn quotient<T: Real>(a: [T; 2], b: [T; 2]) -> [T; 2] {
    let first = a[0] / b[0];
    let rest = remainder(a, b, first);
    let second = rest[0] / b[0];
    let rest = remainder(rest, b, second);
    let [hi, lo] = fast_two_sum(first, second);
    fast_two_sum(hi, lo + rest[0] / b[0])
}

impl Dd {
    /// Zero.
    pub(crate) const ZERO: Dd = Dd { hi: 0.0, lo: 0.0 };
    /// One.
    pub(crate) const ONE: Dd = Dd { hi: 1.0, lo: 0.0 };
    /// 2 pi.
    pub(crate) const TWO_PI: Dd = Dd { hi: std::f64::consts::TAU, lo: 2.449_293_598_294_706_4e-16 };

    #[inline(always)]
    fn of([hi, lo]: [f64; 2]) -> Dd {
        Dd { hi, lo }
    }

    /// The product of two `f64`, exactly.
    #[inline(always)]
    pub(crate) fn product(a: f64, b: f64) -> Dd {
        Dd::of(two_product(a, b))
    }

    /// The quotient of two `f64`.
    #[inline(always)]
    pub fn quotient(a: f64, b: f64) -> Dd {
        Dd::from(a) / Dd::from(b)
    }

    /// Square root; 0 for 0 and for negative numbers.
    #[inline(always)]
    pub fn sqrt(self) -> Dd {
        if self.hi <= 0.0 {
            return Dd::ZERO;
        }
        let root = self.hi.sqrt();
        let rest = self - Dd::product(root, root);
        Dd::of(fast_two_sum(root, rest.hi / (2.0 * root)))
    }

    /// Magnitude.
    #[inline(always)]
    pub fn abs(self) -> Dd {
        if self.hi < 0.0 { -self } else { self }
    }

    /// The nearest `f64`.
    #[inline(always)]
    pub fn to_f64(self) -> f64 {
        self.hi
    }

    /// `self * time` reduced to [-pi, pi], exact to about 1e-32 of the unreduced phase.
    #[inline(always)]
    pub fn phase(self, time: f64) -> f64 {
        self.phase_of(Dd::from(time))
    }

    /// The same for a time that is itself a sum of two numbers.
    #[inline(always)]
    pub(crate) fn phase_of(self, time: Dd) -> f64 {
        let phase = self * time;
        let turns = (phase.hi / Dd::TWO_PI.hi).round();
        (phase - Dd::TWO_PI * Dd::from(turns)).hi
    }
}

impl From<f64> for Dd {
    #[inline(always)]
    fn from(hi: f64) -> Dd {
        Dd { hi, lo: 0.0 }
    }
}

impl Neg for Dd {
    type Output = Dd;
    #[inline(always)]
    fn neg(self) -> Dd {
        Dd { hi: -self.hi, lo: -self.lo }
    }
}

impl Add for Dd {
    type Output = Dd;
    #[inline(always)]
    fn add(self, other: Dd) -> Dd {
        Dd::of(sum([self.hi, self.lo], [other.hi, other.lo]))
    }
}

impl Sub for Dd {
    type Output = Dd;
    #[inline(always)]
    fn sub(self, other: Dd) -> Dd {
        self + -other
    }
}

impl Mul for Dd {
    type Output = Dd;
    #[inline(always)]
    fn mul(self, other: Dd) -> Dd {
        Dd::of(product([self.hi, self.lo], [other.hi, other.lo]))
    }
}

impl Div for Dd {
    type Output = Dd;
    #[inline(always)]
    fn div(self, other: Dd) -> Dd {
        Dd::of(quotient([self.hi, self.lo], [other.hi, other.lo]))
    }
}

/// Numbers side by side, one in each lane of the widest vector unit.
pub(crate) const LANES: usize = 8;

/// `f64` numbers side by side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row(pub(crate) [f64; LANES]);

impl Row {
    #[inline(always)]
    fn zip(self, other: Row, f: impl Fn(f64, f64) -> f64) -> Row {
        let mut out = self;
        for l in 0..LANES {
            out.0[l] = f(self.0[l], other.0[l]);
        }
        out
    }
}

macro_rules! operators {
    ($type:ident: $($operator:ident $method:ident ($a:ident, $b:ident) $body:expr;)*) => {$(
        impl $operator for $type {
            type Output = $type;
            #[inline(always)]
            fn $method(self, $b: $type) -> $type {
                let $a = self;
                $body
            }
        }
    )*};
}

operators! { Row:
    Add add (a, b) a.zip(b, |a, b| a + b);
    Sub sub (a, b) a.zip(b, |a, b| a - b);
    Mul mul (a, b) a.zip(b, |a, b| a * b);
    Div div (a, b) a.zip(b, |a, b| a / b);
}

operators! { Lanes:
    Add add (a, b) Lanes(sum(a.0, b.0));
    Sub sub (a, b) a + -b;
    Mul mul (a, b) Lanes(product(a.0, b.0));
    Div div (a, b) Lanes(quotient(a.0, b.0));
}

impl Neg for Row {
    type Output = Row;
    #[inline(always)]
    fn neg(self) -> Row {
        Row(self.0.map(|x| -x))
    }
}

impl Real for Row {
    #[inline(always)]
    fn mul_add(self, factor: Row, term: Row) -> Row {
        let mut out = term;
        for l in 0..LANES {
            out.0[l] = self.0[l].mul_add(factor.0[l], term.0[l]);
        }
        out
    }
}

/// Double-double numbers side by side: the nearest `f64`, and the remainders.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lanes(pub(crate) [Row; 2]);

impl Lanes {
    pub(crate) const ZERO: Lanes = Lanes([Row([0.0; LANES]); 2]);

    /// The same number in every lane.
    #[inline(always)]
    pub(crate) fn splat(x: Dd) -> Lanes {
        Lanes([Row([x.hi; LANES]), Row([x.lo; LANES])])
    }

    /// The number in a lane.
    #[inline(always)]
    pub(crate) fn get(&self, lane: usize) -> Dd {
        Dd { hi: self.0[0].0[lane], lo: self.0[1].0[lane] }
    }

    /// Puts a number into a lane.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, x: Dd) {
        (self.0[0].0[lane], self.0[1].0[lane]) = (x.hi, x.lo);
    }

    /// These numbers in the lanes where `is_own` holds, `other` in the rest.
    #[inline(always)]
    pub(crate) fn where_or(self, other: Lanes, is_own: impl Fn(usize) -> bool) -> Lanes {
        let mut out = self;
        for part in 0..2 {
            for l in 0..LANES {
                out.0[part].0[l] = if is_own(l) { self.0[part].0[l] } else { other.0[part].0[l] };
            }
        }
        out
    }
}

impl Neg for Lanes {
    type Output = Lanes;
    #[inline(always)]
    fn neg(self) -> Lanes {
        Lanes(self.0.map(|part| -part))
    }
}

/// sin(pi p / q) for any whole p, q > 0, to about 31 digits.
pub(crate) fn sin_pi(p: usize, q: usize) -> Dd {
    let p = p % (2 * q);
    if p > q {
        return -sin_pi(p - q, q);
    }
    let p = p.min(q - p);
    // Up to an eighth of a turn by the sine's series, beyond it by the cosine's; 2p <= q here.
    let half_pi = Dd::TWO_PI * Dd::from(0.25);
    if 4 * p <= q {
        series(half_pi * Dd::quotient(2.0 * p as f64, q as f64), 1)
    } else {
        series(half_pi * Dd::quotient((q - 2 * p) as f64, q as f64), 0)
    }
}

/// The sine's (odd = 1) or cosine's (odd = 0) Taylor series for |x| <= pi / 4.
fn series(x: Dd, odd: usize) -> Dd {
    let square = x * x;
    let mut term = if odd == 1 { x } else { Dd::ONE };
    let mut sum = term;
    let mut n = odd as f64;
    while term.abs().hi > 1e-34 {
        term = -(term * square) / Dd::from((n + 1.0) * (n + 2.0));
        sum = sum + term;
        n += 2.0;
    }
    sum
}

#[cfg(test)]
mod tests;
