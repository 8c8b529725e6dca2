//! How the safe factors of a fleet are distributed.

use super::{HEIGHT, RATED};
use crate::figures::{Axis, Color, Figure, Panel, Sample, Stroke};

/// Points of the line at most.
const MOST: usize = 1000;
const LINE: Stroke = Stroke::solid(Color::Ink, 1.8);
/// Height of one of several panels, in pixels.
const LOW: f64 = 200.0;

/// The share of trains (or variations) whose safe factor is at most x, over x, in a panel for each cause: what the factors multiply,
/// and the factors. Infinite ones count, but lie off the figure.
pub fn safe_factors(causes: &[(&str, Vec<f64>)], what: &str, name: &str) -> String {
    let mut figure = Figure::new(name);
    let height = if causes.len() > 1 { LOW } else { HEIGHT };
    for (cause, factors) in causes {
        let mut sorted = factors.clone();
        sorted.sort_by(f64::total_cmp);
        let finite = sorted.partition_point(|f| f.is_finite());
        let right = 1.08 * sorted[..finite].last().copied().unwrap_or(1.0).max(1.0);
        let y = Axis::new(&format!("{what}, %"), (0.0, 104.0));
        let x = Axis::new(&format!("safe factor on the {cause}"), (0.0, right));
        let mut panel = figure.panel(height, x, y);
        distribution(&mut panel, &sorted, finite, right);
        figure.add(panel);
    }
    figure.explain("the cause as it is given", Sample::Line(RATED));
    figure.explain(&format!("share of {what} with a smaller factor"), Sample::Line(LINE));
    figure.svg()
}

/// The line of a sorted sample of which so many values are finite.
fn distribution(panel: &mut Panel, sorted: &[f64], finite: usize, right: f64) {
    let count = sorted.len();
    let share = |i: usize| 100.0 * i as f64 / count as f64;
    let mut line = vec![(0.0, 0.0)];
    for i in (0..finite).filter(|i| i % count.div_ceil(MOST) == 0 || i + 1 == finite) {
        line.push((sorted[i], line[line.len() - 1].1));
        line.push((sorted[i], share(i + 1)));
    }
    line.push((right, share(finite)));
    // Below factor 1 a coupler is overloaded.
    let below = line.iter().copied().filter(|p| p.0 < 1.0);
    let end = (1.0, below.clone().next_back().map_or(0.0, |p| p.1));
    let below: Vec<_> = below.chain([end]).collect();
    let floor: Vec<_> = below.iter().map(|p| (p.0, 0.0)).collect();
    panel.band(&floor, &below, Color::Over);
    panel.line(&[(1.0, 0.0), (1.0, 104.0)], RATED);
    panel.line(&line, LINE);
}
