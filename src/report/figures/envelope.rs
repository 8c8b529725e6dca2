//! The largest draft and buff of every coupler along the train, against the ratings.

use kuva::plot::BandPlot;
use kuva::plot::scatter::MarkerShape;
use kuva::render::annotations::{ReferenceLine, TextAnnotation};
use kuva::render::layout::Layout;

use super::place::{Window, free_beside};
use super::{
    BLACK, BLUE, Figure, GREEN, GREY, ORANGE, RATED, TEXT_SIZE, VERMILLION, count_couplers, marker_size,
    range_with_air, steps,
};
use crate::consist::{Coupler, Train};
use crate::findings::ScenarioFindings;
use crate::report::numbers::{Unit, force_unit};
use crate::report::words;
use crate::scenario::initial_force_n;

/// Places that a figure has room for; of more couplers several share one.
const PLACES: usize = 800;

/// How many couplers share a place in the envelope of a train.
pub fn couplers_per_place(couplers: usize) -> usize {
    couplers.div_ceil(PLACES)
}

/// Extremes of a place's couplers over all cases of a scenario, N; `None` where there are no findings.
#[derive(Clone, Copy, Default)]
struct Extremes {
    draft: Option<f64>,
    buff: Option<f64>,
    over_draft: bool,
    over_buff: bool,
}

fn extremes(train: &Train, scenario: &ScenarioFindings) -> Vec<Extremes> {
    let share = couplers_per_place(train.couplers.len());
    let mut all = vec![Extremes::default(); train.couplers.len().div_ceil(share)];
    for c in scenario.cases.iter().flat_map(|case| &case.couplers) {
        let Some(e) = all.get_mut((c.coupler - 1) / share) else { continue };
        let (draft, buff) = (c.peak_draft_n.unwrap_or(0.0), c.peak_buff_n.unwrap_or(0.0));
        e.draft = Some(e.draft.map_or(draft, |d| d.max(draft)));
        e.buff = Some(e.buff.map_or(buff, |b| b.min(buff)));
        let over = c.exceeds == Some(true);
        e.over_draft |= over && draft > c.rated_draft_n;
        e.over_buff |= over && -buff > c.rated_buff_n;
    }
    all
}

/// The envelope of a scenario, over all its cases, as SVG: of couplers that share a place the extremes, and the weakest's rating.
pub fn envelope(train: &Train, scenario: &ScenarioFindings, name: &str) -> String {
    let all = extremes(train, scenario);
    let share = couplers_per_place(train.couplers.len());
    let width = share as f64;
    let forces = || {
        let ratings = train.couplers.iter().flat_map(|c| [c.rated_draft_n, -c.rated_buff_n]);
        ratings.chain(all.iter().flat_map(|e| [e.draft, e.buff]).flatten())
    };
    let unit = force_unit(forces().fold(0.0, |m: f64, f| m.max(f.abs())));
    let mut figure = Figure::new(name);
    draw_extremes(&mut figure, &all, unit, width);
    if let Some((_, source)) = words::source(train, scenario).filter(|_| train.extras.steady.is_some()) {
        let before = initial_force_n(train, &source.event);
        let largest = |of: &[f64]| of.iter().copied().reduce(|a, b| if b.abs() > a.abs() { b } else { a });
        let before: Vec<_> = before.chunks(share).map(|c| largest(c).map(|f| f / unit.size)).collect();
        figure.line(steps(&before, width).concat(), ORANGE, 1.4, None, Some("before the event"));
    }
    draw_ratings(&mut figure, train, unit, share);
    let over = |(i, e): (usize, &Extremes)| {
        let sides = [e.draft.filter(|_| e.over_draft), e.buff.filter(|_| e.over_buff)];
        sides.into_iter().flatten().map(move |f| (width * (i as f64 + 0.5) + 0.5, f / unit.size))
    };
    let over: Vec<_> = all.iter().enumerate().flat_map(over).collect();
    let size = marker_size(over.len());
    figure.markers(over, VERMILLION, MarkerShape::Diamond, size, Some("exceeds its rating"));

    let x = (0.5, train.couplers.len() as f64 + 0.5);
    let y = range_with_air(forces().map(|f| f / unit.size));
    let y_label = format!("force, {} (draft +, buff −)", unit.name);
    let layout = count_couplers(figure.layout(x, y, "coupler, counted from the head", &y_label), train.couplers.len());
    let broken = if let [case] = &scenario.cases[..] { case.broken_coupler } else { None };
    let layout = match broken {
        Some(broken) => mark_broken(layout, broken, &figure.lines, Window { x, y }),
        None => layout,
    };
    figure.svg(layout)
}

/// Largest draft and buff as lines of steps, and the forces between them as a pale band.
fn draw_extremes(figure: &mut Figure, all: &[Extremes], unit: Unit, width: f64) {
    let draft = steps(&all.iter().map(|e| e.draft.map(|f| f / unit.size)).collect::<Vec<_>>(), width);
    let buff = steps(&all.iter().map(|e| e.buff.map(|f| f / unit.size)).collect::<Vec<_>>(), width);
    for (high, low) in draft.iter().zip(&buff) {
        let x = high.iter().map(|p| p.0);
        let band = BandPlot::new(x, low.iter().map(|p| p.1), high.iter().map(|p| p.1));
        figure.plots.push(band.with_color(GREY).with_opacity(0.12).into());
    }
    for (runs, color, label) in [(draft, BLUE, "largest draft"), (buff, GREEN, "largest buff")] {
        for (i, run) in runs.into_iter().enumerate() {
            figure.line(run, color, 2.0, None, (i == 0).then_some(label));
        }
    }
}

fn draw_ratings(figure: &mut Figure, train: &Train, unit: Unit, share: usize) {
    let line = |value: fn(&Coupler) -> f64, sign: f64| {
        let weakest = |of: &[Coupler]| of.iter().map(value).reduce(f64::min).map(|f| sign * f / unit.size);
        let values: Vec<_> = train.couplers.chunks(share).map(weakest).collect();
        steps(&values, share as f64).concat()
    };
    figure.line(line(|c| c.rated_draft_n, 1.0), BLACK, 1.2, Some(RATED), Some("rated"));
    figure.line(line(|c| c.rated_buff_n, -1.0), BLACK, 1.2, Some(RATED), None);
}

/// A line where the broken coupler was, with its label.
fn mark_broken(layout: Layout, broken: usize, lines: &[Vec<(f64, f64)>], window: Window) -> Layout {
    let at = broken as f64;
    let label = format!("coupler {broken} breaks");
    let place = free_beside(&label, at, lines, window);
    let line = ReferenceLine::vertical(at).with_color(GREY).with_stroke_width(1.4).with_dasharray("2 3");
    layout
        .with_reference_line(line)
        .with_annotation(TextAnnotation::new(label, place.0, place.1).with_font_size(TEXT_SIZE))
}
