//! How the safe load factors of a fleet are distributed.

use super::{HEIGHT, RATED};
use crate::figures::{Axis, Color, Figure, Sample, Stroke};

/// Points of the line: more than the eye can use.
const MOST: usize = 1000;
const LINE: Stroke = Stroke::solid(Color::Ink, 1.8);

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
    let y = Axis::new(&format!("{what}, %"), (0.0, 104.0));
    let mut panel = figure.panel(HEIGHT, Axis::new("safe load factor", (0.0, right)), y);
    // Left of the load as it is a coupler is overloaded.
    let within = |over: bool| line.iter().copied().filter(|p| (p.0 < 1.0) == over).collect::<Vec<_>>();
    let below = within(true);
    let end = (1.0, below.last().map_or(0.0, |p| p.1));
    let below: Vec<_> = below.into_iter().chain([end]).collect();
    let floor: Vec<_> = below.iter().map(|p| (p.0, 0.0)).collect();
    panel.band(&floor, &below, Color::Over);
    panel.line(&[(1.0, 0.0), (1.0, 104.0)], RATED);
    panel.line(&line, LINE);
    figure.explain("the load as it is", Sample::Line(RATED));
    figure.explain(&format!("share of {what} with a smaller factor"), Sample::Line(LINE));
    figure.add(panel);
    figure.svg()
}
