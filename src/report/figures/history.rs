//! Force against time of one coupler, with the elastic rod's beside it, as in [P] figures 4 and 5.

use super::reach::ForceAxis;
use super::{HEIGHT, RATED, ROD};
use crate::figures::{Axis, Color, Figure, Panel, Point, Sample, Shape, Stroke};
use crate::findings::{CaseFindings, CouplerFindings, Evidence};
use crate::report::numbers::{force_unit, time, time_unit};
use crate::report::words::time_axis;
use crate::train::Train;

/// Width of the line, in pixels.
const LINE: f64 = 2.0;

/// The force in the worst coupler of a case over time, as SVG.
pub fn history(train: &Train, case: &CaseFindings, c: &CouplerFindings, evidence: &Evidence, name: &str) -> String {
    let Evidence { times_s: times, force_n: chain, rod_force_n: rod, .. } = evidence;
    let reach = ForceAxis::new(chain.iter().chain(rod).copied(), &[c.rated_draft_n], &[c.rated_buff_n]);
    let unit = force_unit(train.origin().units, reach.largest());
    let clock = time_unit(times.last().copied().unwrap_or(1.0));
    let points = |forces: &[f64]| -> Vec<Point> {
        times.iter().zip(forces).map(|(t, f)| (t / clock.size, f / unit.size)).collect()
    };
    let chain = points(chain);
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
        panel.line(&points(rod), ROD);
        figure.explain("elastic rod", Sample::Line(ROD));
    }
    // A line on the rating is not over it.
    let aside = LINE / HEIGHT * (reach.range.1 - reach.range.0);
    draw_chain(&mut figure, &mut panel, &chain, [rated[0] + aside, rated[1] - aside].map(|r| r / unit.size));
    figure.explain("rated", Sample::Line(RATED));
    mark_peaks(&mut figure, &mut panel, c, |(t, f)| (t / clock.size, f / unit.size), evidence.window_s);
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

/// The largest draft and buff, each in the colour of its sense or, where it is over the rating, of that.
fn mark_peaks(
    figure: &mut Figure,
    panel: &mut Panel,
    c: &CouplerFindings,
    at: impl Fn(Point) -> Point,
    shown: (f64, f64),
) {
    let peaks = [
        (c.peak_draft_time_s.zip(c.peak_draft_n), Color::Draft, c.rated_draft_n),
        (c.peak_buff_time_s.zip(c.peak_buff_n), Color::Buff, c.rated_buff_n),
    ];
    let mut told = false;
    for (peak, sense, rated) in peaks {
        let Some(peak) = peak.filter(|p| (shown.0..=shown.1).contains(&p.0)) else { continue };
        let over = c.exceeds == Some(true) && peak.1.abs() > rated;
        let color = if over { Color::Over } else { sense };
        panel.marks(&[at(peak)], Shape::Diamond, 5.5, color);
        if !std::mem::replace(&mut told, true) {
            figure.explain("largest draft and buff", Sample::Mark(Shape::Diamond, color));
        }
    }
}

/// The force, each stretch in the colour of its sense, and in another what is above `draft` or below `buff`.
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
