use super::*;

/// sqrt(2)^2 - 2 and (1/3) * 3 - 1 in double-double are below 2^-102, where f64 leaves 2^-52.
#[test]
fn keeps_over_thirty_digits() {
    let root = Dd::from(2.0).sqrt();
    assert!((root * root - Dd::from(2.0)).abs().hi < 2f64.powi(-102));
    let third = Dd::quotient(1.0, 3.0);
    assert!((third * Dd::from(3.0) - Dd::ONE).abs().hi < 2f64.powi(-102));
}

/// sin(pi/6) = 1/2, sin(pi/4)^2 = 1/2, sin^2(3 pi/7) + cos^2(3 pi/7) = 1, signs by quadrant.
#[test]
fn sine_of_fractions_of_pi() {
    let close = |a: Dd, b: f64| (a - Dd::from(b)).abs().hi < 1e-31;
    assert!(close(sin_pi(1, 6), 0.5) && close(sin_pi(5, 6), 0.5) && close(sin_pi(7, 6), -0.5));
    assert!(close(sin_pi(1, 4) * sin_pi(3, 4), 0.5) && close(sin_pi(1, 1), 0.0) && close(sin_pi(1, 2), 1.0));
    let (s, c) = (sin_pi(6, 14), sin_pi(6 + 7, 14));
    assert!(close(s * s + c * c, 1.0));
}

/// The phase of 1e9 radians, by a 40-digit reduction: 1e9 mod 2 pi = 0.5773954235013851...
#[test]
fn reduces_large_phases() {
    assert!((Dd::ONE.phase(1e9) - 0.577_395_423_501_385_2).abs() < 2e-15);
}
