//! How the safe load factors of a fleet are distributed.

use super::{BLACK, BLUE, Figure, RATED};

/// Points of the line: more than the eye can use.
const MOST: usize = 1000;

/// The share of trains (or variations) whose safe load factor is at most x, over x, as SVG; infinite factors count, but lie
/// off the figure.
pub fn safe_load(factors: &[f64], what: &str, name: &str) -> String {
    let mut sorted = factors.to_vec();
    sorted.sort_by(f64::total_cmp);
    let count = sorted.len();
    let finite = sorted.partition_point(|f| f.is_finite());
    let right = 1.08 * sorted[..finite].last().copied().unwrap_or(1.0).max(1.0);
    let share = |i: usize| 100.0 * i as f64 / count as f64;
    let mut line = vec![(0.0, 0.0)];
    for i in (0..finite).filter(|i| i % count.div_ceil(MOST) == 0 || i + 1 == finite) {
        line.push((sorted[i], line[line.len() - 1].1));
        line.push((sorted[i], share(i + 1)));
    }
    line.push((right, share(finite)));
    let mut figure = Figure::new(name);
    figure.line(vec![(1.0, 0.0), (1.0, 104.0)], BLACK, 1.2, Some(RATED), Some("the load as it is"));
    figure.line(line, BLUE, 1.8, None, Some(&format!("share of {what} with a smaller factor")));
    let layout = figure.layout((0.0, right), (0.0, 104.0), "safe load factor", &format!("{what}, %"));
    figure.svg(layout)
}
