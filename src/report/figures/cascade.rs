//! Time against place: where and when couplers break.

use kuva::plot::scatter::MarkerShape;

use super::{BLACK, Figure, GREEN, GREY, VERMILLION, count_couplers, marker_size};
use crate::findings::{CascadeFindings, CaseFindings};
use crate::report::numbers::time_unit;

/// The breaks of a cascade over the train, as SVG; each leaves a gap from its instant on. `struck` is the coupler at which
/// vehicles meet in an impact.
pub fn cascade(
    case: &CaseFindings,
    cascade: &CascadeFindings,
    struck: Option<usize>,
    couplers: usize,
    name: &str,
) -> String {
    let last = cascade.breaks.last().map_or(0.0, |b| b.time_s);
    // What follows the last break needs no more room than the eye does.
    let top = case.horizon_s.min(if last > 0.0 { 1.3 * last } else { case.horizon_s });
    let clock = time_unit(top);
    let mut figure = Figure::new(name);
    let event = case.broken_coupler.map(|b| (b as f64, 0.0));
    let all = || cascade.breaks.iter().map(|b| (b.coupler as f64, b.time_s / clock.size));
    for (i, (x, t)) in event.into_iter().chain(all()).enumerate() {
        let gap = vec![(x, t), (x, top / clock.size)];
        figure.line(gap, GREY, 1.2, Some("2 3"), (i == 0).then_some("parted"));
    }
    let in_sense = |draft: bool| {
        let of = cascade.breaks.iter().filter(|b| (b.force_n > 0.0) == draft);
        of.map(|b| (b.coupler as f64, b.time_s / clock.size)).collect::<Vec<_>>()
    };
    let begun = event.or(struck.map(|c| (c as f64, 0.0)));
    let size = marker_size(couplers).max(3.5);
    figure.markers(begun.into_iter().collect(), BLACK, MarkerShape::Square, size, Some("the event"));
    figure.markers(in_sense(true), VERMILLION, MarkerShape::Diamond, size, Some("breaks in draft"));
    figure.markers(in_sense(false), GREEN, MarkerShape::Circle, size, Some("breaks in buff"));
    let y = (-0.03 * top / clock.size, top / clock.size);
    let x = (0.5, couplers as f64 + 0.5);
    let layout =
        figure.layout(x, y, "coupler, counted from the head", &format!("time after the event, {}", clock.name));
    figure.svg(count_couplers(layout, couplers))
}
