//! Where a label stands in a figure so that it covers little of the data.

use super::{HEIGHT, TEXT_SIZE, WIDTH};

/// The part of the picture that the axes leave for the data, roughly, in pixels.
const INNER: (f64, f64) = (WIDTH - 100.0, HEIGHT - 115.0);
/// Mean width of a letter, as a share of the text's size.
const LETTER: f64 = 0.53;
/// Between samples of a line, in pixels.
const STEP: f64 = 5.0;

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

fn half_pixels(text: &str) -> f64 {
    0.5 * LETTER * f64::from(TEXT_SIZE) * text.chars().count() as f64
}

/// Points along the lines, and along the one at zero, a few pixels apart: a steep stretch counts for its length, a dense one for no more.
fn trace(lines: &[Vec<Point>], window: Window) -> Vec<Point> {
    let zero = [(window.x.0, 0.0), (window.x.1, 0.0)];
    let mut all = Vec::new();
    for line in lines.iter().map(Vec::as_slice).chain([&zero[..]]) {
        let mut points = line.iter().map(|&p| window.to_pixels(p));
        let Some(mut last) = points.next() else { continue };
        all.push(last);
        for p in points {
            let pieces = ((p.0 - last.0).hypot(p.1 - last.1) / STEP).min(500.0) as usize;
            let from = last;
            for i in 1..=pieces {
                let share = i as f64 / pieces as f64;
                last = (from.0 + (p.0 - from.0) * share, from.1 + (p.1 - from.1) * share);
                all.push(last);
            }
        }
    }
    all
}

/// The anchor of a label with an arrow to `target`: of a grid of places the one where text and arrow cross least.
///
/// The library centres the text on the anchor, above it when the arrow leads down and below it when it leads up.
pub fn free_place(text: &str, target: Point, lines: &[Vec<Point>], window: Window) -> Point {
    let obstacles = trace(lines, window);
    let target = window.to_pixels(target);
    let half = half_pixels(text);
    let cost = |anchor: Point| {
        let middle = anchor.1 + if target.1 < anchor.1 { 12.0 } else { -12.0 };
        let crosses = |p: &&Point| (p.0 - target.0).hypot(p.1 - target.1) > 14.0 && near(**p, anchor, target);
        let covered = covered(&obstacles, (anchor.0, middle), half);
        let crossed = obstacles.iter().filter(crosses).count() as f64;
        let length = (anchor.0 - target.0).hypot(anchor.1 - target.1);
        // An arrow has to be long enough to be one, and the text must not hide where it points.
        let hides = (target.0 - anchor.0).abs() < half + 10.0 && (target.1 - middle).abs() < 45.0;
        let hidden = if hides { 1e3 } else { 0.0 };
        hidden + 5.0 * covered + 1.5 * crossed + 0.08 * (length - 90.0).abs()
    };
    let across = (0..=12).map(|i| half + 10.0 + (INNER.0 - 2.0 * half - 20.0) * f64::from(i) / 12.0);
    let places = across.flat_map(|x| (2..13).map(move |j| (x, INNER.1 * f64::from(j) / 13.0)));
    let cheapest = places.map(|p| (cost(p), p)).reduce(|a, b| if b.0 < a.0 { b } else { a });
    window.to_data(cheapest.map_or(target, |(_, place)| place))
}

/// The anchor of a label beside a vertical line at `x`, on the side with more room, at the height where it covers least.
pub fn free_beside(text: &str, x: f64, lines: &[Vec<Point>], window: Window) -> Point {
    let obstacles = trace(lines, window);
    let half = half_pixels(text);
    let at = window.to_pixels((x, 0.0)).0;
    let across = if at > 0.5 * INNER.0 { at - half - 12.0 } else { at + half + 12.0 };
    // The library sets the text a little above its anchor. The middle of the figure comes first among equals.
    let cost = |y: f64| covered(&obstacles, (across, y + 12.0), half) + (y / INNER.1 - 0.5).abs();
    let heights = (1..15).map(|j| INNER.1 * f64::from(j) / 16.0);
    let cheapest = heights.map(|y| (cost(y), y)).reduce(|a, b| if b.0 < a.0 { b } else { a });
    window.to_data((across, cheapest.map_or(0.0, |(_, y)| y)))
}

/// How many points a text around a middle covers.
fn covered(obstacles: &[Point], middle: Point, half: f64) -> f64 {
    let covers = |p: &&Point| (p.0 - middle.0).abs() < half + 6.0 && (p.1 - middle.1).abs() < 15.0;
    obstacles.iter().filter(covers).count() as f64
}

/// Whether a point lies within a few pixels of a segment.
fn near(p: Point, from: Point, to: Point) -> bool {
    let along = (to.0 - from.0, to.1 - from.1);
    let square = along.0 * along.0 + along.1 * along.1;
    let share = ((p.0 - from.0) * along.0 + (p.1 - from.1) * along.1) / square.max(1e-9);
    let share = share.clamp(0.0, 1.0);
    (p.0 - from.0 - share * along.0).hypot(p.1 - from.1 - share * along.1) < 4.0
}
