//! Force against time of one coupler, with the elastic rod's beside it, as in [P] figures 4 and 5.

use kuva::render::annotations::TextAnnotation;

use super::place::{Window, free_place};
use super::{BLACK, BLUE, Figure, ORANGE, TEXT_SIZE, range_with_air};
use crate::consist::Train;
use crate::findings::{self, CaseFindings, CouplerFindings};
use crate::report::numbers::{Unit, force_unit, time, time_unit};
use crate::report::words::time_axis;
use crate::scenario;

/// Instants in a figure per unit of time sqrt(m / k): about eight in the period of the fastest vibration of equal vehicles.
const PER_UNIT: f64 = 2.5;
/// Instants in a figure: enough for a line, and no more than the eye can use.
const FEWEST: usize = 600;
const MOST: usize = 3000;

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

type Points = Vec<(f64, f64)>;

/// What there is to draw, in the units of the axes.
struct Curves {
    chain: Points,
    rod: Points,
    rated: Vec<Points>,
    clock: Unit,
    unit: Unit,
    window: Window,
}

fn curves(train: &Train, index: usize, broken: Option<usize>, c: &CouplerFindings, times: &[f64]) -> Curves {
    let chain = findings::history(train, index, broken, c.coupler - 1, times);
    let rod = findings::rod_history(train, index, broken, c.coupler - 1, times).unwrap_or_default();
    let reach = range_with_air(chain.iter().chain(&rod).copied());
    // A rating far beyond any force would press the curve flat.
    let ratings = [c.rated_draft_n, -c.rated_buff_n];
    let rated: Vec<f64> = ratings.into_iter().filter(|&r| r > 3.0 * reach.0 && r < 3.0 * reach.1).collect();
    let all = || chain.iter().chain(&rod).chain(&rated).copied();
    let unit = force_unit(all().fold(0.0, |m: f64, f| m.max(f.abs())));
    let clock = time_unit(times.last().copied().unwrap_or(1.0));
    let points = |forces: &[f64]| times.iter().zip(forces).map(|(t, f)| (t / clock.size, f / unit.size)).collect();
    let chain_points: Points = points(&chain);
    let x = (chain_points.first().map_or(0.0, |p| p.0), chain_points.last().map_or(1.0, |p| p.0));
    let across = |r: &f64| vec![(x.0, r / unit.size), (x.1, r / unit.size)];
    let window = Window { x, y: range_with_air(all().map(|f| f / unit.size)) };
    let rated = rated.iter().map(across).collect();
    Curves { rod: points(&rod), chain: chain_points, rated, clock, unit, window }
}

/// The force in a coupler of a case over time, as SVG; `index` is that of the scenario in the train.
pub fn history(train: &Train, index: usize, case: &CaseFindings, c: &CouplerFindings, name: &str) -> String {
    let broken = case.broken_coupler.map(|b| b - 1);
    let times = instants(train, case, c);
    let curves = curves(train, index, broken, c, &times);
    let mut figure = Figure::new(name);
    for (i, rated) in curves.rated.iter().enumerate() {
        figure.line(rated.clone(), BLACK, 0.9, Some("2 3"), (i == 0).then_some("rated"));
    }
    if !curves.rod.is_empty() {
        figure.line(curves.rod.clone(), ORANGE, 1.8, Some("6 3 6 3"), Some("elastic rod"));
    }
    let label = format!("coupler {}", c.coupler);
    figure.line(curves.chain.clone(), BLUE, 1.8, None, Some(&label));
    let since = time_axis(case);
    let x_label = format!("{since}, {}", curves.clock.name);
    let y_label = format!("force in coupler {}, {} (draft +, buff −)", c.coupler, curves.unit.name);
    let layout = figure.layout(curves.window.x, curves.window.y, &x_label, &y_label);
    match c.first_exceeds_s.filter(|t| times.contains(t)) {
        Some(first_s) => {
            let arrow = arrow(&curves, &figure.lines, first_s);
            figure.svg(layout.with_annotation(arrow))
        }
        None => figure.svg(layout),
    }
}

/// An arrow to the first exceedance, with its time.
fn arrow(curves: &Curves, lines: &[Points], first_s: f64) -> TextAnnotation {
    let text = match first_s {
        0.0 => "over its rating from the start".to_owned(),
        t => format!("first over its rating at {}", time(t)),
    };
    let target = curves.chain.iter().find(|p| p.0 >= first_s / curves.clock.size).copied().unwrap_or((0.0, 0.0));
    let place = free_place(&text, target, lines, curves.window);
    TextAnnotation::new(text, place.0, place.1)
        .with_arrow(target.0, target.1)
        .with_arrow_padding(2.0)
        .with_font_size(TEXT_SIZE)
}
