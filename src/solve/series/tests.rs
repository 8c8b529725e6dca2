use super::*;

/// Both functions to rounding over the whole range of phases and the whole step.
#[test]
fn series_are_exact_to_rounding() {
    let table = table();
    for (n, z) in (1..=150).flat_map(|n| [-1.0, -0.7, 0.0, 0.3, 0.9].map(|z| (n, z))) {
        let theta = PHASE * f64::from(n) / 150.0;
        let sum = |t: &[[f64; POWERS]; DEGREE]| {
            t.iter().rev().fold(0.0, |s, row| s * z * z + row.iter().rev().fold(0.0, |r, c| r * theta * theta + c))
        };
        // Sums near 1.4: two units of rounding, twice.
        assert!((sum(&table.even) - (z * theta / 2.0).cos() / (theta / 2.0).cos()).abs() < 9e-16);
        assert!((z * sum(&table.odd) - (z * theta / 2.0).sin() / (theta / 2.0).sin()).abs() < 9e-16);
    }
}
