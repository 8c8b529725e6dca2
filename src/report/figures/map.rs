//! A scenario's map: the smallest overloading force against a pulse's duration, or the safe load against what breaks.

use super::{HEIGHT, RATED, ROD, along, range_of_shares};
use crate::figures::{Axis, Color, Figure, Point, Sample, Shape, Stroke};
use crate::findings::{MapFindings, MapPoint};
use crate::report::numbers::{Unit, force_unit, given_force, time_unit};
use crate::train::{Event, Pulse};
use crate::units::UnitSystem;

const CHAIN: Stroke = Stroke::solid(Color::Ink, 2.0);

/// A map as SVG; the scenario's own event is marked in it.
pub fn map(map: &MapFindings, event: &Event, units: UnitSystem, name: &str) -> String {
    let of_pulse = map.over == "duration_s";
    let values = || map.points.iter().flat_map(|p| [p.chain, p.rod]).flatten().map(f64::abs);
    let least = values().fold(f64::INFINITY, f64::min);
    let size = if of_pulse { force_unit(units, least) } else { Unit { name: "", size: 1.0 } };
    let longest = map.points.last().map_or(1.0, |p| p.at);
    let clock = if of_pulse { time_unit(longest) } else { Unit { name: "", size: 1.0 } };
    let line = |value: fn(&MapPoint) -> Option<f64>| {
        map.points.iter().filter_map(|p| Some((p.at / clock.size, value(p)?.abs() / size.size))).collect::<Vec<_>>()
    };
    let lines = Lines { chain: line(|p| p.chain), rod: line(|p| p.rod) };
    let shown = lines.chain.iter().chain(&lines.rod).map(|p| p.1);
    if !of_pulse {
        let y = Axis::new("safe factor on the load", range_of_shares(shown.chain([1.0])));
        let couplers = map.points.len();
        let x = along("coupler that breaks, counted from the head", couplers);
        let threshold = [(0.5, 1.0), (couplers as f64 + 0.5, 1.0)];
        return lines.draw(name, (x, y), &threshold, "the load as it is", None);
    }
    let given = match event {
        Event::Pulse(Pulse { force_n, duration_s, .. }) => {
            Some((duration_s / clock.size, force_n.abs() / size.size, *force_n))
        }
        Event::Break { .. } | Event::Impact { .. } | Event::Brake { .. } => None,
    };
    let top = shown.fold(0.0, f64::max).max(given.map_or(0.0, |g| g.1));
    let bottom = (least / size.size).min(given.map_or(f64::INFINITY, |g| g.1));
    let x = (map.points.first().map_or(longest, |p| p.at) / clock.size, longest / clock.size);
    let x_axis = Axis::log(&format!("duration of the pulse, {}", clock.name), x);
    let label = format!("smallest force that overloads a coupler, {}", size.name);
    // A pulse that is over at once may be very large.
    let tall = bottom > 0.0 && top.is_finite() && top > 0.0;
    let y = if tall { Axis::log(&label, (bottom / 1.3, 1.2 * top)) } else { Axis::new(&label, (0.0, 1.0)) };
    let threshold = given.map_or(Vec::new(), |g| vec![(x.0, g.1), (x.1, g.1)]);
    let (point, label) = match given {
        Some(g) => (
            Some((g.0, g.1)).filter(|p| (x.0..=x.1).contains(&p.0)),
            format!("force of this pulse, {}", given_force(units, g.2)),
        ),
        None => (None, String::new()),
    };
    lines.draw(name, (x_axis, y), &threshold, &label, point)
}

struct Lines {
    chain: Vec<Point>,
    rod: Vec<Point>,
}

impl Lines {
    fn draw(&self, name: &str, axes: (Axis, Axis), threshold: &[Point], means: &str, own: Option<Point>) -> String {
        let mut figure = Figure::new(name);
        let mut panel = figure.panel(HEIGHT, axes.0, axes.1);
        if !threshold.is_empty() {
            panel.line(threshold, RATED);
            figure.explain(means, Sample::Line(RATED));
        }
        if !self.rod.is_empty() {
            // Only breaks that leave equal parts have a rod: a line through so few points is not seen.
            let few = self.rod.len() < 3;
            if few {
                panel.marks(&self.rod, Shape::Square, 5.0, Color::Rod);
            } else {
                panel.line(&self.rod, ROD);
            }
            let sample = if few { Sample::Mark(Shape::Square, Color::Rod) } else { Sample::Line(ROD) };
            figure.explain("elastic rod", sample);
        }
        panel.line(&self.chain, CHAIN);
        figure.explain("chain", Sample::Line(CHAIN));
        if let Some(point) = own {
            panel.point_out("this pulse", point);
        }
        figure.add(panel);
        figure.svg()
    }
}
