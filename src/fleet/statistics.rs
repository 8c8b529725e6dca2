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
mod tests;
