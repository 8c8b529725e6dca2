//! Place against time: force in every coupler, in colours of its utilisation, and the elastic rod's below on the same scale.

use super::raster::{png_base64, scale};
use super::regions::{over_rating, rows_over};
use super::{RATED, mark_size};
use crate::figures::{Axis, Color, Figure, Panel, Point, Sample, Shape, Stroke, ticks};
use crate::findings::{CascadeBreak, Field};
use crate::report::numbers::{Unit, time_unit};

/// Room beyond the ends of the train, as a share of it.
const MARGIN: f64 = 0.02;

/// Heights of the axes, in pixels: of one picture, and of each of two.
const ALONE: f64 = 350.0;
const EACH: f64 = 250.0;
/// Marks of regions over the rating are no nearer to each other than this, in pixels.
const APART: f64 = 14.0;
const FORCE: Stroke = Stroke::solid(Color::Ink, 5.0);
const OPEN: Stroke = Stroke::solid(Color::Slack, 12.0);

/// What is marked over the picture, in couplers from 1 at the head and seconds.
#[derive(Default)]
pub struct Marks<'a> {
    /// Where the event is: a coupler, or half a place beside it for a vehicle.
    pub event: Option<f64>,
    /// How long a force acts there, s.
    pub acts_s: f64,
    /// The coupler that is gone from t = 0 on.
    pub broken: Option<usize>,
    /// Couplers that break on the way.
    pub breaks: &'a [CascadeBreak],
}

/// A picture of the wave, as SVG, with the rod's below it where there is one; `most` is the utilisation of the strongest colour.
pub fn wave(
    (field, rod): (&Field, Option<&Field>),
    most: f64,
    marks: &Marks,
    since: &str,
    couplers: usize,
    name: &str,
) -> String {
    let until = field.times_s[field.times_s.len() - 1];
    let clock = time_unit(until);
    let since = format!("{since}, {}", clock.name);
    let mut figure = Figure::new(name);
    let place = "coupler, from the head";
    let parts = match rod {
        Some(rod) => {
            vec![(field, format!("the chain: {place}"), EACH), (rod, format!("the elastic rod: {place}"), EACH)]
        }
        None => vec![(field, place.to_owned(), ALONE)],
    };
    let last = parts.len() - 1;
    let mut over = false;
    for (i, (field, label, high)) in parts.into_iter().enumerate() {
        // The head on top: places run downward. A margin beyond both ends has room for what is marked there.
        let margin = MARGIN * couplers as f64;
        let y = Axis::counting(&label, (couplers as f64 + 0.5 + margin, 0.5 - margin));
        let x = Axis::new(if i == last { &since } else { "" }, (0.0, until / clock.size));
        let mut panel = figure.panel(high, x, y);
        panel.picture((0.0, until / clock.size), (couplers as f64 + 0.5, 0.5), &png_base64(field, most));
        draw_marks(&mut panel, marks, until, clock);
        over |= mark_exceedances(&mut panel, field, marks, clock, high);
        figure.add(panel);
    }
    explain(&mut figure, marks, over);
    if field.opens() {
        figure.explain("open: passing its slack, without force", Sample::Line(OPEN));
    }
    color_bar(&mut figure, most);
    figure.svg()
}

/// The event, what it breaks and for how long it acts.
fn draw_marks(panel: &mut Panel, marks: &Marks, until: f64, clock: Unit) {
    let gone = marks.broken.map(|b| (b as f64, 0.0)).into_iter();
    for (place, from) in gone.chain(marks.breaks.iter().map(|b| (b.coupler as f64, b.time_s))) {
        panel.line(&[(from / clock.size, place), (until / clock.size, place)], RATED);
    }
    if let Some(place) = marks.event.filter(|_| marks.acts_s > 0.0) {
        panel.line(&[(0.0, place), (marks.acts_s.min(until) / clock.size, place)], FORCE);
    }
    let event: Vec<Point> = marks.event.map(|p| (0.0, p)).into_iter().collect();
    panel.marks(&event, Shape::Square, 6.0, Color::Ink);
    let breaks: Vec<Point> = marks.breaks.iter().map(|b| (b.time_s / clock.size, b.coupler as f64)).collect();
    panel.marks(&breaks, Shape::Diamond, mark_size(breaks.len()), Color::Over);
}

/// Marks couplers over their ratings at the right, and in the picture where and when, as an outline one coupler high is not seen;
/// whether there is any.
fn mark_exceedances(panel: &mut Panel, field: &Field, marks: &Marks, clock: Unit, high: f64) -> bool {
    let place = |row: usize| (row as f64 + 0.5) * field.couplers_per_row as f64 + 0.5;
    let rows: Vec<f64> = rows_over(field).into_iter().map(place).collect();
    panel.margin_marks(&rows, Color::Over);
    let pixels = |p: Point| (panel.width_of((0.0, p.0)), p.1 * high / (field.rows() * field.couplers_per_row) as f64);
    let mut all: Vec<Point> = marks.breaks.iter().map(|b| (b.time_s / clock.size, b.coupler as f64)).collect();
    let taken = all.len();
    for (row, column) in over_rating(field) {
        let at = (field.times_s[column] / clock.size, place(row));
        let here = pixels(at);
        let near = |p: &Point| {
            let there = pixels(*p);
            (here.0 - there.0).hypot(here.1 - there.1) < APART
        };
        if !all.iter().any(near) {
            all.push(at);
        }
    }
    panel.marks(&all[taken..], Shape::OpenDiamond, 6.0, Color::Over);
    !rows.is_empty()
}

fn explain(figure: &mut Figure, marks: &Marks, over: bool) {
    if marks.event.is_some() {
        figure.explain("the event", Sample::Mark(Shape::Square, Color::Ink));
    }
    if marks.event.is_some() && marks.acts_s > 0.0 {
        figure.explain("the force acts", Sample::Line(FORCE));
    }
    if marks.broken.is_some() || !marks.breaks.is_empty() {
        figure.explain("parted", Sample::Line(RATED));
    }
    if !marks.breaks.is_empty() {
        figure.explain("a coupler breaks", Sample::Mark(Shape::Diamond, Color::Over));
    }
    if over {
        figure.explain("coupler over its rating", Sample::Mark(Shape::Left, Color::Over));
        figure.explain("where and when", Sample::Mark(Shape::OpenDiamond, Color::Over));
    }
}

/// The scale of colours, in percent of the rating.
fn color_bar(figure: &mut Figure, most: f64) {
    let end = 100.0 * most;
    let numbers = ticks((-end, end), 8, false);
    let share = |(value, label): (f64, String)| {
        (0.5 + 0.5 * value / end, format!("{} %", label.trim_start_matches('\u{2212}')))
    };
    let ticks: Vec<(f64, String)> = numbers.into_iter().map(share).collect();
    figure.color_bar(&scale(), &ticks, ["buff", "draft"]);
}
