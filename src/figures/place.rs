//! Where a label stands so that it covers little of what is drawn. All in pixels.

use super::Point;

/// Where a panel's axes are, in pixels.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
}

impl Frame {
    pub fn right(self) -> f64 {
        self.left + self.width
    }

    pub fn bottom(self) -> f64 {
        self.top + self.height
    }
}

/// Distance of a line's samples.
const STEP: f64 = 5.0;
/// Half the height of a label with some room.
const HALF_HEIGHT: f64 = 13.0;

/// Points along what is drawn, a few pixels apart: a line counts by its length, not by its data points.
pub struct Obstacles {
    frame: Frame,
    points: Vec<Point>,
}

impl Obstacles {
    /// None yet.
    pub fn new(frame: Frame) -> Obstacles {
        Obstacles { frame, points: Vec::new() }
    }

    /// A line.
    pub fn add(&mut self, line: &[Point]) {
        let Some(&(mut last)) = line.first() else { return };
        self.points.push(last);
        for &p in line {
            let from = last;
            let pieces = ((p.0 - from.0).hypot(p.1 - from.1) / STEP).min(500.0) as usize;
            for i in 1..=pieces {
                let share = i as f64 / pieces as f64;
                last = (from.0 + (p.0 - from.0) * share, from.1 + (p.1 - from.1) * share);
                self.points.push(last);
            }
        }
    }

    /// How many points a text around a middle covers; far more if it leaves the frame.
    fn covered(&self, middle: Point, half: f64) -> f64 {
        let covers = |p: &&Point| (p.0 - middle.0).abs() < half + 6.0 && (p.1 - middle.1).abs() < HALF_HEIGHT;
        let f = self.frame;
        let inside = middle.0 - half > f.left
            && middle.0 + half < f.right()
            && middle.1 - HALF_HEIGHT > f.top
            && middle.1 + HALF_HEIGHT < f.bottom();
        self.points.iter().filter(covers).count() as f64 + if inside { 0.0 } else { 1e4 }
    }
}

fn cheapest(places: impl Iterator<Item = Point>, cost: impl Fn(Point) -> f64) -> Option<Point> {
    places.map(|p| (cost(p), p)).reduce(|a, b| if b.0 < a.0 { b } else { a }).map(|(_, place)| place)
}

/// The middle of a label with an arrow to `target`: of a grid of places the one where text and arrow cross least.
pub fn with_arrow(half: f64, target: Point, drawn: &Obstacles) -> Point {
    let f = drawn.frame;
    let cost = |middle: Point| {
        let crosses = |p: &&Point| (p.0 - target.0).hypot(p.1 - target.1) > 14.0 && near(**p, middle, target);
        let crossed = drawn.points.iter().filter(crosses).count() as f64;
        let length = (middle.0 - target.0).hypot(middle.1 - target.1);
        // An arrow has to be long enough to be one, and the text must not hide where it points.
        let hides = (target.0 - middle.0).abs() < half + 10.0 && (target.1 - middle.1).abs() < 45.0;
        let hidden = if hides { 1e3 } else { 0.0 };
        hidden + 5.0 * drawn.covered(middle, half) + 1.5 * crossed + 0.25 * (length - 70.0).abs()
    };
    let across = (0..=12).map(|i| f.left + half + 10.0 + (f.width - 2.0 * half - 20.0) * f64::from(i) / 12.0);
    let places = across.flat_map(|x| (1..20).map(move |j| (x, f.top + f.height * f64::from(j) / 20.0)));
    cheapest(places, cost).unwrap_or(target)
}

/// The middle of a label beside a vertical line, on the side with more room, at the height where it covers least.
pub fn beside_line(half: f64, x: f64, drawn: &Obstacles) -> Point {
    let f = drawn.frame;
    let x = if x > f.left + 0.5 * f.width { x - half - 8.0 } else { x + half + 8.0 };
    // The middle of the figure comes first among equals.
    let cost = |p: Point| drawn.covered(p, half) + ((p.1 - f.top) / f.height - 0.5).abs();
    cheapest((1..24).map(|j| (x, f.top + f.height * f64::from(j) / 24.0)), cost).unwrap_or((x, f.top))
}

/// The middle of a label beside a point: right, left, above or below, and further off where there is no room.
pub fn beside_point(half: f64, at: Point, drawn: &Obstacles) -> Point {
    let offsets = [12.0, 24.0, 40.0].into_iter().flat_map(|d| {
        let side = half + d;
        [(side, 0.0), (-side, 0.0), (0.0, 6.0 + d), (0.0, -6.0 - d), (side, d), (side, -d), (-side, d), (-side, -d)]
    });
    let cost = |p: Point| drawn.covered(p, half) + 0.15 * (p.0 - at.0).hypot(p.1 - at.1);
    cheapest(offsets.map(|o| (at.0 + o.0, at.1 + o.1)), cost).unwrap_or(at)
}

/// Whether a point lies within a few pixels of a segment.
fn near(p: Point, from: Point, to: Point) -> bool {
    let along = (to.0 - from.0, to.1 - from.1);
    let square = along.0 * along.0 + along.1 * along.1;
    let share = ((p.0 - from.0) * along.0 + (p.1 - from.1) * along.1) / square.max(1e-9);
    let share = share.clamp(0.0, 1.0);
    (p.0 - from.0 - share * along.0).hypot(p.1 - from.1 - share * along.1) < 4.0
}

#[cfg(test)]
mod tests;
