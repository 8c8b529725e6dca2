//! Force against time of one coupler, with the elastic rod's beside it, as in [P] figures 4 and 5.

use kuva::render::annotations::TextAnnotation;

use super::place::{Window, free_place};
use super::{BLACK, BLUE, Figure, ORANGE, TEXT_SIZE, range_with_air};
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
pub fn window(train: &Train, case: &CaseFindings, coupler: &CouplerFindings) -> (f64, f64) {
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
    // min and max in this order also make something of a time unit that is 0.
    let count = ((to - from) / scenario::wave(train).time_unit_s * PER_UNIT).min(MOST).max(FEWEST) as usize;
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
    let all = chain.clone().into_iter().chain(rod.clone().into_iter().flatten());
    let reach = range_with_air(all.clone());
    // A rating far beyond any force would press the curve flat.
    let shown: Vec<f64> = ratings.into_iter().filter(|&r| r > 3.0 * reach.0 && r < 3.0 * reach.1).collect();
    let unit = force_unit(all.clone().chain(shown.iter().copied()).fold(0.0, |m: f64, f| m.max(f.abs())));
    let clock = time_unit(times.last().copied().unwrap_or(1.0));
    let points = |forces: &[f64]| -> Vec<(f64, f64)> {
        times.iter().zip(forces).map(|(t, f)| (t / clock.size, f / unit.size)).collect()
    };

    let mut figure = Figure::new(name);
    let curve = points(&chain);
    let rod = rod.map(|forces| points(&forces)).unwrap_or_default();
    let x = (curve.first().map_or(0.0, |p| p.0), curve.last().map_or(1.0, |p| p.0));
    let y = range_with_air(all.chain(shown.iter().copied()).map(|f| f / unit.size));
    let across = |force_n: f64| vec![(x.0, force_n / unit.size), (x.1, force_n / unit.size)];
    for (i, &r) in shown.iter().enumerate() {
        figure.line(across(r), BLACK, 0.9, Some("2 3"), (i == 0).then_some("rated"));
    }
    if !rod.is_empty() {
        figure.line(rod.clone(), ORANGE, 1.8, Some("8 4"), Some("elastic rod"));
    }
    let label = format!("coupler {}", c.coupler);
    figure.line(curve.clone(), BLUE, 1.8, None, Some(&label));

    let since = if broken.is_some() { "time after the break" } else { "time since the force set in" };
    let y_label = format!("force in coupler {}, {} (draft +, buff −)", c.coupler, unit.name);
    let layout = figure.layout(x, y, &format!("{since}, {}", clock.name), &y_label);
    let Some(first) = c.first_exceeds_s.filter(|t| times.contains(t)) else { return figure.svg(layout) };
    let text = match first {
        0.0 => "over its rating from the start".to_owned(),
        t => format!("first over its rating at {}", time(t)),
    };
    let target = curve.iter().find(|p| p.0 >= first / clock.size).copied().unwrap_or((0.0, 0.0));
    let rated: Vec<_> = shown.iter().chain(&[0.0]).map(|&r| across(r)).collect();
    let lines: Vec<&[(f64, f64)]> = [&curve[..], &rod[..]].into_iter().chain(rated.iter().map(|l| &l[..])).collect();
    let place = free_place(&text, target, &lines, Window { x, y });
    let arrow = TextAnnotation::new(text, place.0, place.1).with_arrow(target.0, target.1).with_arrow_padding(2.0);
    figure.svg(layout.with_annotation(arrow.with_font_size(TEXT_SIZE)))
}
