//! One pair of axes with what is drawn within.

use super::marks::{Shape, Stroke, path, rectangle};
use super::place::{self, Frame, Obstacles};
use super::scale::{Scale, log_ticks, ticks};
use super::tags::{half_width, paint, text};
use super::{Color, Point};

/// Range, label and ticks of an axis; a horizontal axis without a label has no numbers either.
pub struct Axis {
    label: String,
    range: (f64, f64),
    log: bool,
    ticks: Vec<(f64, String)>,
}

impl Axis {
    /// A linear axis.
    pub fn new(label: &str, range: (f64, f64)) -> Axis {
        Axis { label: label.to_owned(), range, log: false, ticks: ticks(range, 7, false) }
    }

    /// Of numbers counted from 1; the range may run downward.
    pub fn counting(label: &str, range: (f64, f64)) -> Axis {
        let mut ticks = ticks(range, 8, true);
        ticks.retain(|t| t.0 >= 1.0);
        Axis { label: label.to_owned(), range, log: false, ticks }
    }

    /// Of names at 1, 2 and so on, downward.
    pub fn named(label: &str, names: &[String]) -> Axis {
        let ticks = names.iter().enumerate().map(|(i, name)| ((i + 1) as f64, name.clone())).collect();
        Axis { label: label.to_owned(), range: (names.len() as f64 + 0.5, 0.5), log: false, ticks }
    }

    /// Of rows, downward from 1, with their names within the frame.
    pub fn rows(count: usize) -> Axis {
        Axis { label: String::new(), range: (count as f64 + 0.5, 0.5), log: false, ticks: Vec::new() }
    }

    /// Logarithmic.
    pub fn log(label: &str, range: (f64, f64)) -> Axis {
        Axis { label: label.to_owned(), range, log: true, ticks: log_ticks(range, 8) }
    }

    pub(super) fn label(&self) -> &str {
        &self.label
    }
}

/// A pair of axes under way.
pub struct Panel {
    name: String,
    frame: Frame,
    x: Scale,
    y: Scale,
    axes: String,
    /// Drawn within the frame and cut off at it.
    inside: String,
    /// Drawn over all that.
    above: String,
    clips: String,
    obstacles: Obstacles,
}

impl Panel {
    pub(super) fn new(name: String, frame: Frame, x: Axis, y: Axis) -> Panel {
        let scales = (
            Scale::new(x.range, (frame.left, frame.right()), x.log),
            Scale::new(y.range, (frame.bottom(), frame.top), y.log),
        );
        let clip = rectangle((frame.left, frame.top), (frame.width, frame.height));
        let clips = format!("<clipPath id=\"clip-{name}\"><rect {clip}/></clipPath>");
        let (inside, above) = (String::new(), String::new());
        let obstacles = Obstacles::new(frame);
        let mut panel =
            Panel { name, frame, x: scales.0, y: scales.1, axes: String::new(), inside, above, clips, obstacles };
        panel.draw_axes(&x, &y);
        panel
    }

    fn draw_axes(&mut self, x: &Axis, y: &Axis) {
        let f = self.frame;
        let mut lines = Vec::new();
        if y.range.0.min(y.range.1) < 0.0 && y.range.0.max(y.range.1) > 0.0 && !y.log {
            let zero = self.y.at(0.0);
            self.axes += &Stroke::solid(Color::Quiet, 0.8).path(&[(f.left, zero), (f.right(), zero)]);
            self.obstacles.add(&[(f.left, zero), (f.right(), zero)]);
        }
        for (value, label) in &x.ticks {
            let at = self.x.at(*value);
            lines.push([(at, f.bottom()), (at, f.bottom() + 5.0)]);
            if !x.label.is_empty() {
                self.axes += &text((at, f.bottom() + 22.0), "middle", label);
            }
        }
        for (value, label) in &y.ticks {
            let at = self.y.at(*value);
            lines.push([(f.left - 5.0, at), (f.left, at)]);
            self.axes += &text((f.left - 9.0, at + 5.0), "end", label);
        }
        let d: String = lines.iter().map(|l| path(l)).collect();
        let frame = rectangle((f.left, f.top), (f.width, f.height));
        self.axes += &format!("<path d=\"{d}\" {}/>", paint(None, Some(Color::Quiet)));
        self.axes += &format!("<rect {frame} {}/>", paint(None, Some(Color::Quiet)));
        self.axes += &text((8.0, f.top - 12.0), "start", &y.label);
        if !x.label.is_empty() {
            self.axes += &text((f.left + 0.5 * f.width, f.bottom() + 48.0), "middle", &x.label);
        }
    }

    fn place(&self, p: Point) -> Point {
        (self.x.at(p.0), self.y.at(p.1))
    }

    fn pixels(&self, points: &[Point]) -> Vec<Point> {
        points.iter().filter(|p| !p.0.is_nan() && !p.1.is_nan()).map(|&p| self.place(p)).collect()
    }

    /// A line through points.
    pub fn line(&mut self, points: &[Point], stroke: Stroke) {
        let points = self.pixels(points);
        self.obstacles.add(&points);
        if points.len() > 1 {
            self.inside += &stroke.path(&points);
        }
    }

    /// The part of a line that lies between two heights, over what is there; `suffix` tells its clip from others.
    pub fn line_between(&mut self, points: &[Point], heights: (f64, f64), stroke: Stroke, suffix: &str) {
        let (top, bottom) = (self.y.at(heights.1), self.y.at(heights.0));
        let (top, bottom) = (top.max(self.frame.top), bottom.min(self.frame.bottom()));
        let name = format!("clip-{}-{suffix}", self.name);
        let before = self.inside.len();
        self.line(points, stroke);
        let line = self.inside.split_off(before);
        if bottom > top && !line.is_empty() {
            let size = (self.frame.width, bottom - top);
            self.clips +=
                &format!("<clipPath id=\"{name}\"><rect {}/></clipPath>", rectangle((self.frame.left, top), size));
            self.inside += &format!("<g clip-path=\"url(#{name})\">{line}</g>");
        }
    }

    /// A pale band between two lines of as many points.
    pub fn band(&mut self, low: &[Point], high: &[Point], color: Color) {
        let around: Vec<Point> = self.pixels(low).into_iter().chain(self.pixels(high).into_iter().rev()).collect();
        self.inside += &format!("<path d=\"{}Z\" {} fill-opacity=\"0.14\"/>", path(&around), paint(Some(color), None));
    }

    /// Marks around points, with corners `size` pixels from them.
    pub fn marks(&mut self, points: &[Point], shape: Shape, size: f64, color: Color) {
        for p in self.pixels(points) {
            self.above += &shape.path(p, size, color);
            self.obstacles.add(&[(p.0 - size, p.1), (p.0 + size, p.1)]);
        }
    }

    /// Marks in the right margin at heights of the axis.
    pub fn margin_marks(&mut self, heights: &[f64], color: Color) {
        let x = self.frame.right() + 8.0;
        for &y in heights {
            self.above += &Shape::Left.path((x, self.y.at(y)), 6.0, color);
        }
    }

    /// A mark's bar: from one height to another.
    pub fn bar(&mut self, x: f64, from: f64, to: f64, color: Color) {
        let ends = [self.place((x, from)), self.place((x, to))];
        self.inside += &Stroke::solid(color, 1.2).path(&ends);
        let cap = [(ends[1].0 - 4.0, ends[1].1), (ends[1].0 + 4.0, ends[1].1)];
        self.inside += &Stroke::solid(color, 1.2).path(&cap);
    }

    /// A picture, a PNG in base64, over a part of the axes, under all else.
    pub fn picture(&mut self, x: (f64, f64), y: (f64, f64), png: &str) {
        let (from, to) = (self.place((x.0, y.0)), self.place((x.1, y.1)));
        let place = rectangle((from.0, from.1.min(to.1)), (to.0 - from.0, (to.1 - from.1).abs()));
        let image = format!(
            "<image {place} preserveAspectRatio=\"none\" class=\"picture\" style=\"image-rendering:pixelated\" \
             href=\"data:image/png;base64,{png}\"/>"
        );
        self.inside.insert_str(0, &image);
    }

    /// A horizontal stroke of at least so many pixels around the middle of a range that is too narrow to be seen.
    pub fn cap(&mut self, x: (f64, f64), y: f64, least: f64, color: Color) {
        let (from, to, y) = (self.x.at(x.0), self.x.at(x.1), self.y.at(y));
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from).max(least));
        let line = [(middle - half, y), (middle + half, y)];
        self.above += &Stroke::solid(color, 2.6).path(&line);
        self.obstacles.add(&line);
    }

    /// How many pixels a stretch of the horizontal axis has.
    pub fn width_of(&self, x: (f64, f64)) -> f64 {
        (self.x.at(x.1) - self.x.at(x.0)).abs()
    }

    /// A text that begins or ends at a point.
    pub fn write(&mut self, at: Point, anchor: &str, content: &str) {
        let (x, y) = self.place(at);
        self.above += &text((x, y + 5.0), anchor, content);
    }

    /// A label beside a point, on the side where it covers least.
    pub fn name_point(&mut self, content: &str, at: Point) {
        let place = place::beside_point(half_width(content), self.place(at), &self.obstacles);
        self.label(content, place);
    }

    /// A vertical line with its label.
    pub fn name_line(&mut self, content: &str, x: f64, stroke: Stroke) {
        let at = self.x.at(x);
        self.inside += &stroke.path(&[(at, self.frame.top), (at, self.frame.bottom())]);
        let place = place::beside_line(half_width(content), at, &self.obstacles);
        self.label(content, place);
        self.obstacles.add(&[(at, self.frame.top), (at, self.frame.bottom())]);
    }

    /// A label with an arrow to a point.
    pub fn point_out(&mut self, content: &str, target: Point) {
        let target = self.place(target);
        let half = half_width(content);
        let middle = place::with_arrow(half, target, &self.obstacles);
        let from = (middle.0, middle.1 + if target.1 > middle.1 { 11.0 } else { -11.0 });
        let length = (target.0 - from.0).hypot(target.1 - from.1).max(1.0);
        let along = ((target.0 - from.0) / length, (target.1 - from.1) / length);
        let tip = (target.0 - 4.0 * along.0, target.1 - 4.0 * along.1);
        let wing =
            |side: f64| (tip.0 - 10.0 * along.0 - side * 4.0 * along.1, tip.1 - 10.0 * along.1 + side * 4.0 * along.0);
        self.above += &Stroke::solid(Color::Ink, 1.2).path(&[from, tip]);
        self.obstacles.add(&[from, tip]);
        self.above +=
            &format!("<path d=\"{}Z\" {}/>", path(&[tip, wing(1.0), wing(-1.0)]), paint(Some(Color::Ink), None));
        self.label(content, middle);
    }

    /// Says what lies beyond the upper end of the axis or the lower one, with an arrow.
    pub fn beyond(&mut self, content: &str, above: bool) {
        let middle = if above { self.frame.top + 14.0 } else { self.frame.bottom() - 14.0 };
        let x = self.frame.right() - 14.0;
        let way = if above { -1.0 } else { 1.0 };
        let arrow = Stroke::solid(Color::Ink, 1.6);
        self.above += &arrow.path(&[(x, middle - 8.0 * way), (x, middle + 8.0 * way)]);
        self.above +=
            &arrow.path(&[(x - 4.5, middle + 3.0 * way), (x, middle + 8.5 * way), (x + 4.5, middle + 3.0 * way)]);
        self.above += &text((x - 12.0, middle + 5.0), "end", content);
        self.keep_free((x - 12.0 - half_width(content), middle), half_width(content) + 12.0);
    }

    fn label(&mut self, content: &str, middle: Point) {
        self.above += &text((middle.0, middle.1 + 5.0), "middle", content);
        self.keep_free(middle, half_width(content));
    }

    /// Keeps later labels off one that is there.
    fn keep_free(&mut self, middle: Point, half: f64) {
        for dy in [-8.0, 0.0, 8.0] {
            self.obstacles.add(&[(middle.0 - half, middle.1 + dy), (middle.0 + half, middle.1 + dy)]);
        }
    }

    pub(super) fn finish(self) -> String {
        let Panel { name, axes, inside, above, clips, .. } = self;
        format!("<defs>{clips}</defs><g clip-path=\"url(#clip-{name})\">{inside}</g>{axes}{above}")
    }
}
