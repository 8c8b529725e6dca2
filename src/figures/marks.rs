//! What is drawn at points and along them.

use super::tags::{number, paint};
use super::{Color, Point};

/// How a line looks.
#[derive(Clone, Copy, Debug)]
pub struct Stroke {
    /// Its colour.
    pub color: Color,
    /// Its width in pixels.
    pub width: f64,
    /// Lengths of dashes and gaps.
    pub dash: Option<&'static str>,
}

impl Stroke {
    /// A line without gaps.
    pub const fn solid(color: Color, width: f64) -> Stroke {
        Stroke { color, width, dash: None }
    }

    /// A line of dashes.
    pub const fn dashed(color: Color, width: f64, dash: &'static str) -> Stroke {
        Stroke { color, width, dash: Some(dash) }
    }

    pub(super) fn path(&self, points: &[Point]) -> String {
        let dash = self.dash.map_or_else(String::new, |d| format!(" stroke-dasharray=\"{d}\""));
        let (d, width) = (path(points), number(self.width));
        format!("<path d=\"{d}\" {} stroke-width=\"{width}\"{dash}/>", paint(None, Some(self.color)))
    }
}

/// Shapes of marks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    Circle,
    Square,
    Diamond,
    OpenDiamond,
    Up,
    Down,
    Left,
    Cross,
    Ring,
}

impl Shape {
    /// A mark around a point, whose corners are `r` pixels from it.
    pub(super) fn path(self, at: Point, r: f64, color: Color) -> String {
        let p = |x: f64, y: f64| (at.0 + x * r, at.1 + y * r);
        let corners: &[Point] = match self {
            Shape::Square => &[p(-0.8, -0.8), p(0.8, -0.8), p(0.8, 0.8), p(-0.8, 0.8)],
            Shape::Diamond | Shape::OpenDiamond => &[p(0.0, -1.0), p(1.0, 0.0), p(0.0, 1.0), p(-1.0, 0.0)],
            Shape::Up => &[p(0.0, -1.0), p(1.0, 0.8), p(-1.0, 0.8)],
            Shape::Down => &[p(0.0, 1.0), p(1.0, -0.8), p(-1.0, -0.8)],
            Shape::Left => &[p(-1.0, 0.0), p(0.8, -1.0), p(0.8, 1.0)],
            Shape::Cross => {
                let line = |a: Point, b: Point| path(&[p(a.0, a.1), p(b.0, b.1)]);
                let d = line((-0.8, -0.8), (0.8, 0.8)) + &line((-0.8, 0.8), (0.8, -0.8));
                return format!("<path d=\"{d}\" {} stroke-width=\"2.2\"/>", paint(None, Some(color)));
            }
            Shape::Circle | Shape::Ring => {
                let (fill, stroke, width) =
                    if self == Shape::Ring { (None, color, "1.6") } else { (Some(color), Color::Card, "0.7") };
                let [x, y, r] = [at.0, at.1, r].map(number);
                let paint = paint(fill, Some(stroke));
                return format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\" {paint} stroke-width=\"{width}\"/>");
            }
        };
        let d = path(corners) + "Z";
        if self == Shape::OpenDiamond {
            let halo = format!("<path d=\"{d}\" {} stroke-width=\"4.5\"/>", paint(None, Some(Color::Card)));
            return format!("{halo}<path d=\"{d}\" {} stroke-width=\"2.2\"/>", paint(None, Some(color)));
        }
        format!("<path d=\"{d}\" {} stroke-width=\"0.7\"/>", paint(Some(color), Some(Color::Card)))
    }
}

/// A line through points, without those equal to the one before to a tenth of a pixel.
pub fn path(points: &[Point]) -> String {
    let mut d = String::new();
    let mut last = String::new();
    for p in points {
        let here = format!("{} {}", number(p.0), number(p.1));
        if here != last {
            d.push(if last.is_empty() { 'M' } else { 'L' });
            d += &here;
            last = here;
        }
    }
    d
}

/// The attributes of a rectangle from its upper left corner.
pub fn rectangle(at: Point, size: Point) -> String {
    let [x, y, width, height] = [at.0, at.1, size.0, size.1].map(number);
    format!("x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"")
}
