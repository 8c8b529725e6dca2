//! The largest utilisation that each break causes, against which coupler breaks.

use super::{HEIGHT, RATED, along, mark_size, range_of_shares};
use crate::figures::{Axis, Color, Figure, Panel, Point, Sample, Shape, Stroke};
use crate::findings::{CaseFindings, ScenarioFindings};

const UTILISATION: &str = "utilisation of the worst coupler, %";
/// Up to so many cases are drawn as bars of this height, in pixels.
const FEW: usize = 8;
const BAR: f64 = 36.0;

/// The worst coupler's utilisation by broken coupler, as SVG.
pub fn breaks(scenario: &ScenarioFindings, couplers: usize, name: &str) -> String {
    let point = |case: &CaseFindings| {
        let utilisation = 100.0 * case.worst.as_ref()?.utilisation;
        Some(((case.broken_coupler? as f64, utilisation), case.exceeding > 0))
    };
    let mut points: Vec<_> = scenario.cases.iter().filter_map(point).collect();
    points.sort_by(|a, b| a.0.0.total_cmp(&b.0.0));
    if points.len() <= FEW {
        return few(&points, name);
    }
    let range = range_of_shares(points.iter().map(|p| p.0.1).chain([100.0]));
    let mut figure = Figure::new(name);
    let x = along("coupler that breaks, counted from the head", couplers);
    let mut panel = figure.panel(HEIGHT, x, Axis::new(UTILISATION, range));
    panel.line(&[(0.5, 100.0), (couplers as f64 + 0.5, 100.0)], RATED);
    // Neighbours are joined; between couplers that were not examined there is nothing to see.
    for run in points.chunk_by(|a, b| b.0.0 - a.0.0 < 1.5) {
        panel.line(&run.iter().map(|p| p.0).collect::<Vec<_>>(), Stroke::solid(Color::Quiet, 1.0));
    }
    marked(figure, panel, &points)
}

/// A bar for each of a few cases, in place of points in a wide and empty frame.
fn few(points: &[(Point, bool)], name: &str) -> String {
    let names: Vec<String> = points.iter().map(|p| format!("{:.0}", p.0.0)).collect();
    let most = points.iter().map(|p| p.0.1).fold(100.0, f64::max);
    let mut figure = Figure::new(name);
    let y = Axis::named("coupler that breaks, counted from the head", &names);
    let mut panel = figure.panel(BAR * names.len() as f64, Axis::new(UTILISATION, (0.0, 1.06 * most)), y);
    let ends = |(i, p): (usize, &(Point, bool))| ((p.0.1, (i + 1) as f64), p.1);
    let points: Vec<_> = points.iter().enumerate().map(ends).collect();
    for (end, over) in &points {
        let color = if *over { Color::Over } else { Color::Quiet };
        panel.line(&[(0.0, end.1), *end], Stroke::solid(color, 3.0));
    }
    panel.line(&[(100.0, 0.5), (100.0, names.len() as f64 + 0.5)], RATED);
    marked(figure, panel, &points)
}

/// The figure with marks at the points: those of cases in which a coupler exceeds, and the others.
fn marked(mut figure: Figure, mut panel: Panel, points: &[(Point, bool)]) -> String {
    figure.explain("the rating", Sample::Line(RATED));
    let looks = [
        (false, Shape::Circle, 3.5, Color::Quiet, "no coupler exceeds"),
        (true, Shape::Diamond, mark_size(points.len()), Color::Over, "some coupler exceeds"),
    ];
    for (over, shape, size, color, label) in looks {
        let points: Vec<Point> = points.iter().filter(|p| p.1 == over).map(|p| p.0).collect();
        panel.marks(&points, shape, size, color);
        if !points.is_empty() {
            figure.explain(label, Sample::Mark(shape, color));
        }
    }
    figure.add(panel);
    figure.svg()
}
