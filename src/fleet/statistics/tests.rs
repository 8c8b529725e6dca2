use super::*;

/// With no event in n samples the upper end solves (1 - p)^n = alpha / 2, with all the lower end p^n = alpha / 2.
#[test]
fn interval_at_the_ends_has_a_closed_form() {
    let closed = 1.0 - 0.025f64.powf(1.0 / 30.0);
    let ((low, high), (from, to)) = (clopper_pearson(0, 30, 0.05), clopper_pearson(30, 30, 0.05));
    // The incomplete beta function is good to about 1e-14, and its slope there is near 1.
    assert!(low == 0.0 && (high - closed).abs() < 1e-12, "{high} {closed}");
    assert!(to == 1.0 && (from - (1.0 - closed)).abs() < 1e-12, "{from} {closed}");
}

/// Summed binomial probabilities at both ends of the interval are alpha / 2.
#[test]
fn interval_in_the_middle_leaves_alpha_half_on_each_side() {
    let (k, n) = (7, 40);
    let (low, high) = clopper_pearson(k, n, 0.05);
    let mass = |p: f64, i: usize| {
        let choose: f64 = (0..i).map(|j| (n - j) as f64 / (j + 1) as f64).product();
        choose * p.powi(i as i32) * (1.0 - p).powi((n - i) as i32)
    };
    let at_least: f64 = (k..=n).map(|i| mass(low, i)).sum();
    let at_most: f64 = (0..=k).map(|i| mass(high, i)).sum();
    // Sums of forty rounded products.
    assert!((at_least - 0.025).abs() < 1e-12 && (at_most - 0.025).abs() < 1e-12, "{at_least} {at_most}");
}

#[test]
fn ranks_forget_the_scale_and_share_ties() {
    assert_eq!(rank_correlation(&[1.0, 2.0, 3.0, 10.0], &[1.0, 8.0, 27.0, 1000.0]), Some(1.0));
    assert_eq!(rank_correlation(&[1.0, 2.0, 3.0], &[5.0, 5.0, 5.0]), None);
    // By hand: ranks 0.5 0.5 2 and 0 1 2 give 1.5 / sqrt(1.5 * 2).
    let tied = rank_correlation(&[4.0, 4.0, 9.0], &[1.0, 2.0, 3.0]).unwrap_or_default();
    assert!((tied - 0.75f64.sqrt()).abs() < 1e-15, "{tied}");
}
