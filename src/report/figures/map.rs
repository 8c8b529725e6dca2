//! A scenario's map: the smallest overloading force against a pulse's duration, or the safe load against what breaks.

use super::{BLUE, Figure, ORANGE, count_couplers, range_with_air};
use crate::findings::MapFindings;
use crate::report::numbers::{force_unit, time_unit};

/// A map as SVG.
pub fn map(map: &MapFindings, name: &str) -> String {
    let of_pulse = map.over == "duration_s";
    let values = || map.points.iter().flat_map(|p| [p.chain, p.rod]).flatten().map(f64::abs);
    let least = values().fold(f64::INFINITY, f64::min);
    let size = if of_pulse { force_unit(least) } else { crate::report::numbers::Unit { name: "", size: 1.0 } };
    let longest = map.points.last().map_or(1.0, |p| p.at);
    let clock = time_unit(longest);
    let across = if of_pulse { clock.size } else { 1.0 };
    let line = |value: fn(&crate::findings::MapPoint) -> Option<f64>| {
        map.points.iter().filter_map(|p| Some((p.at / across, value(p)?.abs() / size.size))).collect::<Vec<_>>()
    };
    let (chain, rod) = (line(|p| p.chain), line(|p| p.rod));
    let y = range_with_air(chain.iter().chain(&rod).map(|p| p.1));
    let mut figure = Figure::new(name);
    if !rod.is_empty() {
        figure.line(rod, ORANGE, 1.8, Some("6 3 6 3"), Some("elastic rod"));
    }
    figure.line(chain, BLUE, 2.0, None, Some("chain"));
    if of_pulse {
        // A pulse that is over at once may be very large.
        let x = (map.points.first().map_or(longest, |p| p.at) / across, longest / across);
        let tall = least > 0.0 && least.is_finite();
        let y = if tall { (least / size.size / 1.3, 1.08 * y.1) } else { y };
        let label = format!("smallest force that overloads a coupler, {}", size.name);
        let layout = figure.layout(x, y, &format!("duration of the pulse, {}", clock.name), &label).with_log_x();
        return figure.svg(if tall { layout.with_log_y() } else { layout });
    }
    let couplers = map.points.len();
    let x = (0.5, couplers as f64 + 0.5);
    let layout = figure.layout(x, y, "coupler that breaks, counted from the head", "safe factor on the load");
    figure.svg(count_couplers(layout, couplers))
}
