//! Force against time of one coupler, with the elastic rod's beside it, as in [P] figures 4 and 5.

use super::reach::Reach;
use super::{HEIGHT, RATED, ROD};
use crate::figures::{Axis, Color, Figure, Panel, Point, Sample, Stroke};
use crate::findings::{self, CaseFindings, CouplerFindings};
use crate::report::numbers::{force_unit, time, time_unit};
use crate::report::words::time_axis;
use crate::scenario;
use crate::train::Train;

/// Instants in a figure per unit of time sqrt(m / k): about eight in the period of the fastest vibration of equal vehicles.
const PER_UNIT: f64 = 2.5;
/// Instants in a figure: enough for a line, and no more than the eye can use.
const FEWEST: usize = 600;
const MOST: usize = 3000;
/// Width of the line, in pixels.
const LINE: f64 = 2.0;

/// The stretch of time that a figure shows, s: all of it, or, where that is too long to resolve, a window.
///
/// The window begins at t = 0 when it reaches the peak so, and else lies around the peak.
pub fn window(train: &Train, case: &CaseFindings, coupler: &CouplerFindings) -> (f64, f64) {
    let longest = MOST as f64 / PER_UNIT * scenario::wave(train).time_unit_s;
    let horizon = case.horizon_s;
    if horizon <= longest || !longest.is_normal() {
        return (0.0, horizon);
    }
    let from = if coupler.peak_time_s < 0.9 * longest { 0.0 } else { coupler.peak_time_s - 0.5 * longest };
    let from = from.min(horizon - longest);
    (from, from + longest)
}

/// Evenly spaced instants, and those that the text names.
fn instants(train: &Train, case: &CaseFindings, coupler: &CouplerFindings) -> Vec<f64> {
    let (from, to) = window(train, case, coupler);
    let count = ((to - from) / scenario::wave(train).time_unit_s * PER_UNIT) as usize;
    let count = count.clamp(FEWEST, MOST);
    let even = (0..=count).map(|i| from + (to - from) * i as f64 / count as f64);
    let named = [Some(coupler.peak_time_s), coupler.first_exceeds_s].into_iter().flatten();
    let mut all: Vec<f64> = even.chain(named.filter(|t| (from..=to).contains(t))).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// The force in a coupler of a case over time, as SVG; `index` is that of the scenario in the train.
pub fn history(train: &Train, index: usize, case: &CaseFindings, c: &CouplerFindings, name: &str) -> String {
    let broken = case.broken_coupler.map(|b| b - 1);
    let times = instants(train, case, c);
    let chain = findings::history(train, index, broken, c.coupler - 1, &times);
    let rod = findings::rod_history(train, index, broken, c.coupler - 1, &times).unwrap_or_default();
    let reach = Reach::new(chain.iter().chain(&rod).copied(), &[c.rated_draft_n], &[c.rated_buff_n]);
    let unit = force_unit(train.origin().units, reach.largest());
    let clock = time_unit(times.last().copied().unwrap_or(1.0));
    let points = |forces: &[f64]| -> Vec<Point> {
        times.iter().zip(forces).map(|(t, f)| (t / clock.size, f / unit.size)).collect()
    };
    let chain = points(&chain);
    let x = (chain.first().map_or(0.0, |p| p.0), chain.last().map_or(1.0, |p| p.0));
    let x_axis = Axis::new(&format!("{}, {}", time_axis(case), clock.name), x);
    let y_label = format!("force in coupler {}, {} (draft +, buff −)", c.coupler, unit.name);
    let y_axis = Axis::new(&y_label, (reach.range.0 / unit.size, reach.range.1 / unit.size));
    let mut figure = Figure::new(name);
    let mut panel = figure.panel(HEIGHT, x_axis, y_axis);
    let rated = [c.rated_draft_n, -c.rated_buff_n];
    for r in rated.into_iter().filter(|&r| reach.shows(r)) {
        panel.line(&[(x.0, r / unit.size), (x.1, r / unit.size)], RATED);
    }
    if !rod.is_empty() {
        panel.line(&points(&rod), ROD);
        figure.explain("elastic rod", Sample::Line(ROD));
    }
    // A line along the rating is not over it.
    let aside = LINE / HEIGHT * (reach.range.1 - reach.range.0);
    draw_chain(&mut figure, &mut panel, &chain, [rated[0] + aside, rated[1] - aside].map(|r| r / unit.size));
    figure.explain("rated", Sample::Line(RATED));
    reach.tell(&mut panel, train.origin().units);
    if let Some(first_s) = c.first_exceeds_s.filter(|t| times.contains(t)) {
        let target = chain.iter().find(|p| p.0 >= first_s / clock.size).copied().unwrap_or((0.0, 0.0));
        let text = match first_s {
            0.0 => "over its rating from the start".to_owned(),
            t => format!("first over its rating at {}", time(t)),
        };
        panel.point_out(&text, target);
    }
    figure.add(panel);
    figure.svg()
}

/// The force, each stretch in the colour of its sense, and over that what is above the first height or below the second.
fn draw_chain(figure: &mut Figure, panel: &mut Panel, chain: &[Point], [draft, buff]: [f64; 2]) {
    const MOST: f64 = f64::MAX;
    let stretches = [
        ("draft", (0.0, MOST), Color::Draft, LINE, "draft"),
        ("buff", (-MOST, 0.0), Color::Buff, LINE, "buff"),
        ("over-draft", (draft, MOST), Color::Over, 1.5 * LINE, "over its rating"),
        ("over-buff", (-MOST, buff), Color::Over, 1.5 * LINE, "over its rating"),
    ];
    let mut said = "";
    for (part, range, color, width, label) in stretches {
        if !said.is_empty() && !chain.iter().any(|p| range.0 < p.1 && p.1 < range.1) {
            continue;
        }
        let stroke = Stroke::solid(color, width);
        panel.line_between(chain, range, stroke, part);
        if label != said {
            figure.explain(label, Sample::Line(stroke));
        }
        said = label;
    }
}
