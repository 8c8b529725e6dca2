use super::*;

fn cosine(center: f64, radius: f64) -> Local {
    let mut coefficient = [0.0; COEFFICIENTS];
    let mut power = 1.0;
    for (q, c) in coefficient.iter_mut().enumerate() {
        let phase = center + q as f64 * std::f64::consts::FRAC_PI_2;
        *c = phase.cos() * power;
        power *= radius / (q + 1) as f64;
    }
    Local { coefficient, terms: COEFFICIENTS, center, radius }
}

/// cos has its maximum at 0 and passes 0.5 upward at -pi/3.
#[test]
fn finds_peak_and_crossing_of_a_cosine() {
    let f = cosine(-0.3, 1.6);
    let top = f.largest(-1.0, 1.0, 0.0).expect("a maximum");
    assert!((top.value - 1.0).abs() < 1e-15 && (top.at * 1.6 - 0.3).abs() < 1e-8);
    let x = f.first_over(-1.0, 1.0, 0.5).expect("a crossing");
    assert!((x * 1.6 - 0.3 + std::f64::consts::FRAC_PI_3).abs() < 1e-14);
    assert_eq!(f.largest(-1.0, 1.0, 1.0 + 1e-12), None);
    assert_eq!(f.first_over(-1.0, 1.0, 1.0 + 1e-12), None);
}

/// Side by side, largest values and crossings are those of one polynomial, and most are certain.
#[test]
fn lanes_agree_with_one() {
    let (mut tops_found, mut crossings_found) = (0, 0);
    for n in 0..100 {
        let some: [Local; 4] = std::array::from_fn(|l| cosine(0.13 * f64::from(4 * n + l as i32) - 26.0, 0.75));
        let locals = Locals::<COEFFICIENTS, 4> {
            coefficient: std::array::from_fn(|q| std::array::from_fn(|l| some[l].coefficient[q])),
        };
        let (near, end) = ([0.1, 0.2, -0.95, -1.0], [1.0, 0.3, -0.9, 1.0]);
        let tops = locals.tops(near, end);
        let level: [f64; 4] = std::array::from_fn(|l| tops.value[l] - 0.02 * f64::from(n % 5));
        let asked = std::array::from_fn(|l| tops.is_certain[l] && tops.value[l] > level[l]);
        let crossings = locals.crossings(level, tops.at, asked);
        for (l, local) in some.iter().enumerate() {
            // Nothing depends on the other lanes.
            let alone = Locals::<COEFFICIENTS, 1> { coefficient: local.coefficient.map(|c| [c]) };
            let top = alone.tops([near[l]], [end[l]]);
            assert_eq!((top.at[0], top.value[0]), (tops.at[l], tops.value[l]));
            let crossing = alone.crossings([level[l]], [tops.at[l]], [asked[l]]);
            assert_eq!(crossing[0].to_bits(), crossings[l].to_bits());
            if tops.is_certain[l] {
                tops_found += 1;
                let top = local.largest(-1.0, end[l], -2.0).expect("a largest value");
                assert!((top.value - tops.value[l]).abs() < 4e-16, "{top:?} {}", tops.value[l]);
            }
            assert!(asked[l] || crossings[l].is_nan());
            if !crossings[l].is_nan() {
                crossings_found += 1;
                let x = local.first_over(-1.0, end[l], level[l]).expect("a crossing");
                let slope = local.value_and_slope(x).1;
                assert!((x - crossings[l]).abs() <= 1e-15 / slope.abs() + 1e-15, "{x} {}", crossings[l]);
            }
        }
    }
    assert!(tops_found > 250 && crossings_found > 200, "{tops_found} {crossings_found}");
}

/// The cubic 3s - 4s^3 on [0, 1] has its largest value 1 at s = 1/2.
#[test]
fn hermite_maximum_of_a_cubic() {
    let top = hermite_top(1.0, [0.0, 3.0], [-1.0, -9.0]);
    assert!((top.at - 0.5).abs() < 1e-15 && (top.value - 1.0).abs() < 1e-15);
}
