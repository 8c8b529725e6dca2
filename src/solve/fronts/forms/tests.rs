use super::*;

const TIMES: [f64; 12] = [3.3, 17.1, 32.1, 33.0, 40.7, 57.3, 90.9, 150.2, 333.3, 1000.1, 2500.7, 9000.3];

/// What the forms say of all fronts at a time, and the exact values and slopes.
fn forms_and_values(t: f64) -> Vec<(Sums, [f64; 2])> {
    let form = |(k, exact): (usize, [f64; 2])| {
        let order = 2.0 * (k + 1) as f64;
        let mut sums = Sums::default();
        sums.add(&Front::new(order, order.cbrt()), 1.0, &[2.0 * t; LANES]);
        (sums, exact)
    };
    rows::values_and_slopes(t).into_iter().skip(1).enumerate().map(form).collect()
}

/// The errors of all forms are half of the assumed ones, or less.
#[test]
fn forms_are_within_their_assumed_errors() {
    for t in TIMES {
        for (k, (sums, [value, slope])) in forms_and_values(t).into_iter().enumerate() {
            let (off, assumed) =
                ((sums.value[0] - value).abs().max((sums.slope[0] - slope).abs()), sums.error_estimate);
            assert!(off <= 0.5 * (assumed + UNSEEN), "t {t} distance {}: {off:e} of {assumed:e}", k + 1);
        }
    }
}

/// dP/dt is J_{nu-1} + J_{nu+1} at 2t, and two more derivatives are its second difference over the distances; the last is taken by
/// a difference in time.
#[test]
fn fourth_derivatives_are_within_their_bound() {
    let third = |t: f64, d: usize| {
        let exact = rows::values_and_slopes(t);
        let slope = |d: usize| exact.get(d).map_or(0.0, |e| e[1]);
        slope(d - 1) - 2.0 * slope(d) + slope(d + 1)
    };
    for t in TIMES {
        let step = 1e-3;
        let forms = forms_and_values(t);
        for d in (2..forms.len()).step_by(1 + forms.len() / 300) {
            let fourth = (third(t + step, d) - third(t - step, d)).abs() / (2.0 * step);
            let bound = fourth_derivative(2.0 * d as f64, (2.0 * d as f64).cbrt(), 2.0 * t);
            let ahead = (d as f64) - t > 4.0 * t.cbrt();
            assert!(fourth <= bound || ahead && fourth < 1e-6, "t {t} distance {d}: {fourth:e}, bound {bound:e}");
        }
    }
}
