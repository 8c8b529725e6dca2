//! Force against time of one coupler, with the elastic rod's beside it, as in [P] figures 4 and 5.

use kuva::render::annotations::TextAnnotation;

use super::{BLACK, BLUE, Figure, INNER, ORANGE, TEXT_SIZE, range_with_air};
use crate::consist::Train;
use crate::findings::{self, CaseFindings, CouplerFindings};
use crate::report::numbers::{force_unit, time, time_unit};
use crate::{rod, scenario};

/// Instants in a figure per unit of time sqrt(m / k): about eight in the period of the fastest vibration of equal vehicles.
const PER_UNIT: f64 = 2.5;
/// Instants in a figure: enough for a line, and no more than the eye can use.
const FEWEST: f64 = 600.0;
const MOST: f64 = 3000.0;

/// The stretch of time that a figure shows, s: all of it, or, where that is too long to resolve, a window.
///
/// The window begins at t = 0 when it reaches the peak so, and else lies around the peak.
fn window(train: &Train, case: &CaseFindings, coupler: &CouplerFindings) -> (f64, f64) {
    let longest = MOST / PER_UNIT * scenario::wave(train).time_unit_s;
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
    let count = ((to - from) / scenario::wave(train).time_unit_s * PER_UNIT).clamp(FEWEST, MOST) as usize;
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
    let rod = rod::history(train, index, broken, c.coupler - 1, &times);
    let ratings = [c.rated_draft_n, -c.rated_buff_n];
    let all = || chain.iter().chain(rod.iter().flatten()).copied();
    let reach = range_with_air(all());
    // A rating far beyond any force would press the curve flat.
    let shown: Vec<f64> = ratings.into_iter().filter(|&r| r > 3.0 * reach.0 && r < 3.0 * reach.1).collect();
    let unit = force_unit(all().chain(shown.iter().copied()).fold(0.0, |m: f64, f| m.max(f.abs())));
    let clock = time_unit(times.last().copied().unwrap_or(1.0));
    let points = |forces: &[f64]| -> Vec<(f64, f64)> {
        times.iter().zip(forces).map(|(t, f)| (t / clock.size, f / unit.size)).collect()
    };

    let mut figure = Figure::new(name);
    let curve = points(&chain);
    let x = (curve.first().map_or(0.0, |p| p.0), curve.last().map_or(1.0, |p| p.0));
    for (i, r) in shown.iter().map(|r| r / unit.size).enumerate() {
        figure.line(vec![(x.0, r), (x.1, r)], BLACK, 0.9, Some("2 3"), (i == 0).then_some("rated"));
    }
    if let Some(forces) = &rod {
        figure.line(points(forces), ORANGE, 1.8, Some("8 4"), Some("elastic rod"));
    }
    let label = format!("coupler {}", c.coupler);
    figure.line(curve.clone(), BLUE, 1.8, None, Some(&label));

    let y = range_with_air(all().chain(shown).map(|f| f / unit.size));
    let since = if broken.is_some() { "time after the break" } else { "time since the force set in" };
    let y_label = format!("force in coupler {}, {} (draft +, buff −)", c.coupler, unit.name);
    let mut layout = figure.layout(x, y, &format!("{since}, {}", clock.name), &y_label);
    if let Some(first) = c.first_exceeds_s.filter(|t| times.contains(t)) {
        let target = curve.iter().find(|p| p.0 >= first / clock.size).copied().unwrap_or((0.0, 0.0));
        let text = if first == 0.0 {
            "over its rating from the start".to_owned()
        } else {
            format!("first over its rating at {}", time(first))
        };
        let place = free_place(&curve, text.chars().count(), target, x, y);
        layout = layout.with_annotation(
            TextAnnotation::new(text, place.0, place.1).with_arrow(target.0, target.1).with_font_size(TEXT_SIZE),
        );
    }
    figure.svg(layout)
}

/// Where a text covers the least of a curve, and is near to what it points at.
fn free_place(curve: &[(f64, f64)], letters: usize, target: (f64, f64), x: (f64, f64), y: (f64, f64)) -> (f64, f64) {
    let (width, height) = (x.1 - x.0, y.1 - y.0);
    let half = (0.5 * letters as f64 * 7.8 / INNER.0 * width, 26.0 / INNER.1 * height);
    let covered = |place: (f64, f64)| {
        let inside = |p: &&(f64, f64)| (p.0 - place.0).abs() < half.0 && (p.1 - place.1).abs() < half.1;
        curve.iter().filter(inside).count() as f64
    };
    let far = |p: (f64, f64)| ((p.0 - target.0) / width).hypot((p.1 - target.1) / height);
    let across = (0..9).map(|i| x.0 + half.0 + 0.02 * width + (0.96 * width - 2.0 * half.0) * f64::from(i) / 8.0);
    let places = across.flat_map(|px| (1..9).map(move |j| (px, y.0 + height * f64::from(j) / 9.0)));
    let cost = |p: (f64, f64)| covered(p) + 40.0 * (far(p) - 0.2).abs();
    let cheapest = places.map(|p| (cost(p), p)).reduce(|a, b| if b.0 < a.0 { b } else { a });
    cheapest.map_or(target, |(_, place)| place)
}
