//! Where a label stands in a figure so that it covers little of the data.

use super::{HEIGHT, TEXT_SIZE, WIDTH};

/// The part of the picture that the axes leave for the data, roughly, in pixels.
const INNER: (f64, f64) = (WIDTH - 100.0, HEIGHT - 115.0);
/// Mean width of a letter, as a share of the text's size.
const LETTER: f64 = 0.53;
/// Between samples of a line, in pixels.
const STEP: f64 = 3.0;

type Point = (f64, f64);

/// The window of a figure in the data's units.
#[derive(Clone, Copy)]
pub struct Window {
    /// Range across.
    pub x: (f64, f64),
    /// Range upward.
    pub y: (f64, f64),
}

impl Window {
    fn to_pixels(self, p: Point) -> Point {
        let share = |v: f64, range: (f64, f64)| (v - range.0) / (range.1 - range.0);
        (share(p.0, self.x) * INNER.0, share(p.1, self.y) * INNER.1)
    }

    fn to_data(self, p: Point) -> Point {
        let value = |pixels: f64, inner: f64, range: (f64, f64)| range.0 + pixels / inner * (range.1 - range.0);
        (value(p.0, INNER.0, self.x), value(p.1, INNER.1, self.y))
    }
}

/// Half the width of a text on one line, in the data's units.
pub fn half_width(text: &str, window: Window) -> f64 {
    half_pixels(text) / INNER.0 * (window.x.1 - window.x.0)
}

fn half_pixels(text: &str) -> f64 {
    0.5 * LETTER * f64::from(TEXT_SIZE) * text.chars().count() as f64
}

/// Points along the lines, no further apart than a few pixels: a steep stretch counts for its length.
fn trace(lines: &[&[Point]], window: Window) -> Vec<Point> {
    let mut all = Vec::new();
    for pair in lines.iter().flat_map(|line| line.windows(2)) {
        let (a, b) = (window.to_pixels(pair[0]), window.to_pixels(pair[1]));
        let pieces = ((b.0 - a.0).hypot(b.1 - a.1) / STEP).clamp(1.0, 500.0) as usize;
        let at = |i: usize| i as f64 / pieces as f64;
        all.extend((0..pieces).map(|i| (a.0 + (b.0 - a.0) * at(i), a.1 + (b.1 - a.1) * at(i))));
    }
    all
}

/// The anchor of a label with an arrow to `target`: of a grid of places the one where text and arrow cross least.
///
/// The library centres the text on the anchor, above it when the arrow leads down and below it when it leads up.
pub fn free_place(text: &str, target: Point, lines: &[&[Point]], window: Window) -> Point {
    let obstacles = trace(lines, window);
    let target = window.to_pixels(target);
    let half = half_pixels(text);
    let cost = |anchor: Point| {
        let middle = anchor.1 + if target.1 < anchor.1 { 12.0 } else { -12.0 };
        let covers = |p: &&Point| (p.0 - anchor.0).abs() < half + 6.0 && (p.1 - middle).abs() < 15.0;
        let crosses = |p: &&Point| (p.0 - target.0).hypot(p.1 - target.1) > 14.0 && near(**p, anchor, target);
        let covered = obstacles.iter().filter(covers).count() as f64;
        let crossed = obstacles.iter().filter(crosses).count() as f64;
        let length = (anchor.0 - target.0).hypot(anchor.1 - target.1);
        3.0 * covered + crossed + 0.05 * (length - 90.0).abs()
    };
    let across = (0..=16).map(|i| half + 10.0 + (INNER.0 - 2.0 * half - 20.0) * f64::from(i) / 16.0);
    let places = across.flat_map(|x| (2..16).map(move |j| (x, INNER.1 * f64::from(j) / 16.0)));
    let cheapest = places.map(|p| (cost(p), p)).reduce(|a, b| if b.0 < a.0 { b } else { a });
    window.to_data(cheapest.map_or(target, |(_, place)| place))
}

/// Whether a point lies within a few pixels of a segment.
fn near(p: Point, from: Point, to: Point) -> bool {
    let along = (to.0 - from.0, to.1 - from.1);
    let square = along.0 * along.0 + along.1 * along.1;
    let share = ((p.0 - from.0) * along.0 + (p.1 - from.1) * along.1) / square.max(1e-9);
    let share = share.clamp(0.0, 1.0);
    (p.0 - from.0 - share * along.0).hypot(p.1 - from.1 - share * along.1) < 4.0
}
