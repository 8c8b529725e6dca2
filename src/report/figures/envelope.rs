//! The largest draft and buff of every coupler along the train, against the ratings.

use super::reach::{ForceAxis, four_digits};
use super::{HEIGHT, RATED, along, mark_size, steps};
use crate::figures::{Axis, Color, Figure, Panel, Point, Sample, Shape, Stroke};
use crate::findings::ScenarioFindings;
use crate::report::numbers::{Unit, force_unit};
use crate::report::words;
use crate::scenario::initial_force_n;
use crate::train::{Coupler, Train};

/// Places in a figure; if there are more couplers, several share one.
const PLACES: usize = 800;
/// Steps of a rating narrower than this are drawn as a stroke of this width, in pixels; up to so many of them are
/// labelled.
const NARROW: f64 = 14.0;
const NUMBERED: usize = 4;

const DRAFT: Stroke = Stroke::solid(Color::Draft, 2.0);
const BUFF: Stroke = Stroke::solid(Color::Buff, 2.0);
const BEFORE: Stroke = Stroke::dashed(Color::Ink, 1.4, "1.5 3");

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
    let share = couplers_per_place(train.couplers().len());
    let mut all = vec![Extremes::default(); train.couplers().len().div_ceil(share)];
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
    let couplers = train.couplers().len();
    let share = couplers_per_place(couplers);
    let ratings = |value: fn(&Coupler) -> f64| train.couplers().iter().map(value).collect::<Vec<_>>();
    let source = words::source(train, scenario).filter(|_| train.extras().steady.is_some());
    let before = source.map_or_else(Vec::new, |(_, source)| initial_force_n(train, &source.event));
    let forces = all.iter().flat_map(|e| [e.draft, e.buff]).flatten().chain(before.iter().copied());
    let reach = ForceAxis::new(forces, &ratings(|c| c.rated_draft_n), &ratings(|c| c.rated_buff_n));
    let unit = force_unit(train.origin().units, reach.largest());
    let mut figure = Figure::new(name);
    let y_label = format!("force, {} (draft +, buff −)", unit.name);
    let range = (reach.range.0 / unit.size, reach.range.1 / unit.size);
    let x = along("coupler, counted from the head", couplers);
    let mut panel = figure.panel(HEIGHT, x, Axis::new(&y_label, range));
    draw_extremes(&mut panel, &all, unit, share as f64);
    figure.explain("largest draft", Sample::Line(DRAFT));
    figure.explain("largest buff", Sample::Line(BUFF));
    if !before.is_empty() {
        let largest = |of: &[f64]| of.iter().copied().reduce(|a, b| if b.abs() > a.abs() { b } else { a });
        let before: Vec<_> = before.chunks(share).map(|c| largest(c).map(|f| f / unit.size)).collect();
        panel.line(&steps(&before, share as f64).concat(), BEFORE);
        figure.explain("before the event", Sample::Line(BEFORE));
    }
    let marked = mark_exceedances(&mut panel, &all, unit, share as f64);
    let narrow = draw_ratings(&mut panel, train, &reach, unit);
    figure.explain("rated", Sample::Line(RATED));
    if marked {
        figure.explain("over its rating", Sample::Mark(Shape::Diamond, Color::Over));
    }
    reach.tell(&mut panel, train.origin().units);
    if let [case] = &scenario.cases[..]
        && let Some(broken) = case.broken_coupler
    {
        let stroke = Stroke::dashed(Color::Quiet, 1.6, "2 3");
        panel.name_line(&format!("coupler {broken} breaks"), broken as f64, stroke);
    }
    for (label, at) in narrow {
        panel.name_point(&label, at);
    }
    figure.add(panel);
    figure.svg()
}

/// Largest draft and buff as lines of steps, and the forces between each and zero as a pale band.
fn draw_extremes(panel: &mut Panel, all: &[Extremes], unit: Unit, width: f64) {
    let line = |value: fn(&Extremes) -> Option<f64>| {
        steps(&all.iter().map(|e| value(e).map(|f| f / unit.size)).collect::<Vec<_>>(), width)
    };
    for (runs, stroke) in [(line(|e| e.draft), DRAFT), (line(|e| e.buff), BUFF)] {
        for run in runs {
            let zero: Vec<Point> = run.iter().map(|p| (p.0, 0.0)).collect();
            panel.band(&zero, &run, stroke.color);
            panel.line(&run, stroke);
        }
    }
}

/// Marks what exceeds, in each sense; whether anything does.
fn mark_exceedances(panel: &mut Panel, all: &[Extremes], unit: Unit, width: f64) -> bool {
    let over = |(i, e): (usize, &Extremes)| {
        let sides = [e.draft.filter(|_| e.over_draft), e.buff.filter(|_| e.over_buff)];
        sides.into_iter().flatten().map(move |f| (width * (i as f64 + 0.5) + 0.5, f / unit.size))
    };
    let over: Vec<_> = all.iter().enumerate().flat_map(over).collect();
    panel.marks(&over, Shape::Diamond, mark_size(over.len()), Color::Over);
    !over.is_empty()
}

/// Draws the ratings that are on the axis; returns the labels of those of a few couplers, with their places.
fn draw_ratings(panel: &mut Panel, train: &Train, reach: &ForceAxis, unit: Unit) -> Vec<(String, Point)> {
    let share = couplers_per_place(train.couplers().len());
    let mut named = Vec::new();
    for sign in [1.0, -1.0] {
        let value = |c: &Coupler| if sign > 0.0 { c.rated_draft_n } else { c.rated_buff_n };
        let weakest = |of: &[Coupler]| of.iter().map(value).fold(f64::INFINITY, f64::min);
        let values: Vec<f64> = train.couplers().chunks(share).map(weakest).collect();
        let mut at = 0.5;
        let several = values.iter().any(|v| *v != values[0]);
        for run in values.chunk_by(|a, b| a == b) {
            let x = (at, at + (share * run.len()) as f64);
            at = x.1;
            let y = sign * run[0] / unit.size;
            if !reach.shows(sign * run[0]) {
                continue;
            }
            if several && panel.width_of(x) < NARROW {
                panel.cap(x, y, NARROW, Color::Ink);
                named.push((four_digits(train.origin().units, run[0]), (0.5 * (x.0 + x.1), y)));
            } else {
                panel.line(&[(x.0, y), (x.1, y)], RATED);
            }
        }
    }
    if named.len() > NUMBERED { Vec::new() } else { named }
}
