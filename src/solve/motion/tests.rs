use super::super::dd::{Dd, sin_pi};
use super::super::series::PHASE;
use super::super::series::cosine_of_root;
use super::*;

/// The rests of the Chebyshev series of `1 / cos(theta/2)`, whose terms are sums over Chebyshev's points.
#[test]
fn rests_of_the_series_are_rounded_up() {
    let points = 48;
    // The cosine of pi n / (2 points).
    let cosine = |n: usize| sin_pi((n + points) % (4 * points), 2 * points);
    let value = |j: usize| {
        let x = (Dd::ONE + cosine(2 * j + 1)) * Dd::from(PHASE * PHASE / 2.0);
        Dd::ONE / cosine_of_root(x * Dd::from(0.25))
    };
    let values: Vec<Dd> = (0..points).map(value).collect();
    let term = |k: usize| {
        let sum = (0..points).fold(Dd::ZERO, |sum, j| sum + values[j] * cosine(k * (2 * j + 1)));
        (sum * Dd::from(if k == 0 { 1.0 } else { 2.0 }) / Dd::from(points as f64)).to_f64()
    };
    let rest = |from: usize| (from..30).rev().map(term).sum::<f64>();
    let afar = std::iter::once((15, &FROM_AFAR));
    for (from, bound) in FROM_SPRINGS.iter().enumerate().chain(afar) {
        assert!(rest(from) <= *bound && *bound < 1.01 * rest(from), "{from}: {:e} {bound:e}", rest(from));
    }
}

/// For G = sin(theta x + phase) the bracket holds its largest value over 0 <= x <= 1, and is as narrow as its remainder says.
#[test]
fn bracket_holds() {
    for n in 0..200 {
        let (theta, phase) = (PHASE * f64::from(n % 10 + 1) / 10.0, 0.11 * f64::from(n));
        let even_derivatives = |x: f64| {
            let g = (theta * x + phase).sin();
            [g, -theta.powi(2) * g, theta.powi(4) * g]
        };
        let remainder = 61.0 / 46_080.0 * theta.powi(6);
        let [lower, upper, _] = bracket([even_derivatives(0.0), even_derivatives(1.0)], remainder);
        let top = (0..=1000).map(|k| even_derivatives(f64::from(k) / 1000.0)[0]).fold(-1.0, f64::max);
        assert!(lower <= top + 1e-15 && top <= upper, "{lower} {top} {upper}");
        assert!(upper - lower <= 2.0 * remainder + 2.0 * SECOND * theta.powi(4));
        let slope = |k: i32| theta * (theta * f64::from(k) / 1000.0 + phase).cos();
        let least = (0..=1000).map(slope).fold(9.0, f64::min);
        let [bound, other] = slopes([even_derivatives(0.0), even_derivatives(1.0)], remainder);
        assert!(bound <= least && least - bound < 0.1 * theta.powi(4), "{bound} {least}");
        assert!(other >= (0..=1000).map(slope).fold(-9.0, f64::max));
        let turned = [even_derivatives(0.0), even_derivatives(1.0)].map(|end| end.map(|x| -x));
        assert_eq!(brackets(turned, remainder)[0], brackets(turned.map(|end| end.map(|x| -x)), remainder)[1]);
    }
}
