//! A scenario's map: the smallest overloading force against a pulse's duration, or the safe load against what breaks.

use super::{BLUE, Figure, ORANGE, count_couplers, range_with_air};
use crate::findings::MapFindings;
use crate::report::numbers::{force_unit, time_unit};

/// Forces beyond so many times the smallest are left out: a pulse that is over at once may be as large as it likes.
const TALL: f64 = 10.0;

/// A map as SVG.
pub fn map(map: &MapFindings, name: &str) -> String {
    let of_pulse = map.over == "duration_s";
    let values = || map.points.iter().flat_map(|p| [p.chain, p.rod]).flatten().map(f64::abs);
    let least = values().fold(f64::INFINITY, f64::min);
    let tall = if of_pulse { TALL * least } else { f64::INFINITY };
    let size = if of_pulse { force_unit(least) } else { crate::report::numbers::Unit { name: "", size: 1.0 } };
    let longest = map.points.last().map_or(1.0, |p| p.at);
    let clock = time_unit(longest);
    let across = if of_pulse { clock.size } else { 1.0 };
    let line = |value: fn(&crate::findings::MapPoint) -> Option<f64>| {
        let all = map.points.iter().filter_map(|p| Some((p.at / across, value(p)?.abs())));
        all.filter(|p| p.1 <= tall).map(|(x, y)| (x, y / size.size)).collect::<Vec<_>>()
    };
    let (chain, rod) = (line(|p| p.chain), line(|p| p.rod));
    let rod: Vec<_> = rod.into_iter().filter(|p| chain.first().is_none_or(|first| p.0 >= first.0)).collect();
    let y = range_with_air(chain.iter().chain(&rod).map(|p| p.1));
    let first = chain.first().map_or(longest / across, |p| p.0);
    let mut figure = Figure::new(name);
    if !rod.is_empty() {
        figure.line(rod, ORANGE, 1.8, Some("6 3 6 3"), Some("elastic rod"));
    }
    figure.line(chain, BLUE, 2.0, None, Some("chain"));
    if of_pulse {
        let x = (first, longest / across);
        let label = format!("smallest force that overloads a coupler, {}", size.name);
        let layout = figure.layout(x, y, &format!("duration of the pulse, {}", clock.name), &label);
        return figure.svg(layout.with_log_x());
    }
    let couplers = map.points.len();
    let x = (0.5, couplers as f64 + 0.5);
    let layout = figure.layout(x, y, "coupler that breaks, counted from the head", "safe factor on the load");
    figure.svg(count_couplers(layout, couplers))
}
