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
