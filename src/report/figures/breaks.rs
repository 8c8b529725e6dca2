//! The largest utilisation that each break causes, against which coupler breaks.

use kuva::plot::scatter::MarkerShape;

use super::{BLACK, BLUE, Figure, RATED, VERMILLION, count_couplers, marker_size, range_with_air};
use crate::findings::ScenarioFindings;

/// The worst coupler's utilisation by broken coupler, as SVG.
pub fn breaks(scenario: &ScenarioFindings, couplers: usize, name: &str) -> String {
    let point = |case: &crate::findings::CaseFindings| {
        let utilisation = 100.0 * case.worst.as_ref()?.utilisation;
        Some(((case.broken_coupler? as f64, utilisation), case.exceeding > 0))
    };
    let mut points: Vec<_> = scenario.cases.iter().filter_map(point).collect();
    points.sort_by(|a, b| a.0.0.total_cmp(&b.0.0));
    let which = |over: bool| points.iter().filter(|p| p.1 == over).map(|p| p.0).collect::<Vec<_>>();
    let x = (0.5, couplers as f64 + 0.5);
    let mut figure = Figure::new(name);
    figure.line(vec![(x.0, 100.0), (x.1, 100.0)], BLACK, 1.2, Some(RATED), Some("the rating"));
    // Neighbours are joined; between couplers that were not examined there is nothing to see.
    for run in points.chunk_by(|a, b| b.0.0 - a.0.0 < 1.5).filter(|run| run.len() > 1) {
        figure.line(run.iter().map(|p| p.0).collect(), BLUE, 1.0, None, None);
    }
    figure.markers(which(false), BLUE, MarkerShape::Circle, 3.0, Some("no coupler exceeds"));
    figure.markers(
        which(true),
        VERMILLION,
        MarkerShape::Diamond,
        marker_size(points.len()),
        Some("some coupler exceeds"),
    );
    let y = range_with_air(points.iter().map(|p| p.0.1).chain([100.0]));
    let layout =
        figure.layout(x, y, "coupler that breaks, counted from the head", "utilisation of the worst coupler, %");
    figure.svg(count_couplers(layout, couplers))
}
