//! The confidence interval of a share, and rank correlation.

use statrs::function::beta::beta_reg;

/// The interval that holds the probability of an event with confidence `1 - alpha`, `k` of `n` samples having had it.
///
/// C. J. Clopper and E. S. Pearson, *Biometrika* 26 (1934) 404-413, by quantiles of the beta distribution:
///
/// ```text
/// low:  I_low(k, n - k + 1) = alpha / 2        high:  I_high(k + 1, n - k) = 1 - alpha / 2
/// ```
pub fn clopper_pearson(k: usize, n: usize, alpha: f64) -> (f64, f64) {
    let quantile = |p: f64, a: usize, b: usize| {
        let (mut low, mut high) = (0.0, 1.0);
        // Each round halves the interval, down to a double's spacing at 1.
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if beta_reg(a as f64, b as f64, middle) < p { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    };
    let low = if k == 0 { 0.0 } else { quantile(0.5 * alpha, k, n - k + 1) };
    let high = if k == n { 1.0 } else { quantile(1.0 - 0.5 * alpha, k + 1, n - k) };
    (low, high)
}

/// Spearman's rank correlation (*Am. J. Psychol.* 15 (1904) 72-101): Pearson's of the ranks, equal values sharing their mean
/// rank. `None` where either column has one value only.
pub fn rank_correlation(x: &[f64], y: &[f64]) -> Option<f64> {
    let (x, y) = (ranks(x), ranks(y));
    let middle = (x.len() as f64 - 1.0) / 2.0;
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - middle) * (b - middle)).sum::<f64>();
    let scale = (product(&x, &x) * product(&y, &y)).sqrt();
    (scale > 0.0).then(|| product(&x, &y) / scale)
}

fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut ranks = vec![0.0; values.len()];
    let mut from = 0;
    for tied in order.chunk_by(|&a, &b| values[a] == values[b]) {
        let shared = from as f64 + (tied.len() as f64 - 1.0) / 2.0;
        tied.iter().for_each(|&i| ranks[i] = shared);
        from += tied.len();
    }
    ranks
}

#[cfg(test)]
mod tests {
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
}
