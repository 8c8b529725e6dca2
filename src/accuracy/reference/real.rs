//! Long binary floating point: conversions, and sine and cosine.

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;

use crate::solve::dd::Dd;

/// A binary floating-point number of as many bits as it was made with.
pub type Real = FBig<HalfEven, 2>;

/// Halvings before the sine's series, and doublings after it.
const HALVINGS: isize = 8;

/// An `f64` with `bits` bits; 0 for what is not finite, which `Reference::new` refuses before.
pub fn real(x: f64, bits: usize) -> Real {
    Real::try_from(x).unwrap_or_default().with_precision(bits).value()
}

/// The nearest `f64`.
pub fn rounded(x: &Real) -> f64 {
    x.to_f64().value()
}

/// The nearest double-double.
pub fn dd(x: &Real) -> Dd {
    let hi = rounded(x);
    Dd { hi, lo: rounded(&(x - real(hi, x.precision()))) }
}

/// `|claimed - exact|`, subtracted in long arithmetic and rounded once.
pub fn difference(claimed: f64, exact: &Real) -> f64 {
    if claimed.is_finite() { rounded(&(real(claimed, exact.precision()) - exact)).abs() } else { f64::INFINITY }
}

/// Sines and cosines at one precision.
#[derive(Clone, Debug)]
pub struct Circle {
    bits: usize,
    turn: Real,
    /// `1 / ((2q)(2q + 1))`, q = 1, 2, ...
    ratio: Vec<Real>,
}

impl Circle {
    /// For numbers of `bits` bits; 32 more are used within, which covers halvings, doublings and the series' sum.
    pub fn new(bits: usize) -> Circle {
        let inner = bits + 32;
        let one = real(1.0, inner);
        let turn = real(-1.0, inner).acos() << 1;
        // After q terms the next is under (pi / 2^8)^(2q) / (2q + 1)!: 17 bits a term are more than due.
        let ratio = (1..=inner / 12).map(|q| &one / real((2 * q * (2 * q + 1)) as f64, inner)).collect();
        Circle { bits, turn, ratio }
    }

    /// Sine of x and 1 - cos x, right to 2^-bits times (1 + |x|).
    ///
    /// ```text
    /// sin 2y = 2 sin y (1 - v),    1 - cos 2y = 2 sin^2 y,    v = 1 - cos y
    /// ```
    pub fn sine_and_versine(&self, x: &Real) -> (Real, Real) {
        let inner = self.bits + 32;
        let x = x.clone().with_precision(inner).value();
        let turns = rounded(&(&x / &self.turn)).round();
        let y = (x - real(turns, inner) * &self.turn) >> HALVINGS;
        let mut sine = self.series(&y);
        // Of the smallest angle: v = sin^2 y / (1 + cos y).
        let square = &sine * &sine;
        let one = real(1.0, inner);
        let mut versine = &square / (&one + (&one - &square).sqrt());
        for _ in 0..HALVINGS {
            let double = (&sine * (&one - &versine)) << 1;
            versine = (&sine * &sine) << 1;
            sine = double;
        }
        (sine.with_precision(self.bits).value(), versine.with_precision(self.bits).value())
    }

    fn series(&self, y: &Real) -> Real {
        let square = y * y;
        let mut term = y.clone();
        let mut sum = y.clone();
        for ratio in &self.ratio {
            term = -(term * &square * ratio);
            sum += &term;
            if rounded(&term).abs() < 0.5f64.powi(self.bits as i32 + 40) {
                break;
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests;
