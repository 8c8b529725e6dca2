//! Error against run time as a log-log figure.
//!
//! This crate's methods are filled marks in colours, each with a bar up to the error it claims at most, or estimates; marching methods are
//! grey, but for those that follow another train.

use super::{Accuracy, MethodRow, RowOrigin};
use crate::figures::{Axis, Color, Figure, Panel, Sample, Shape, Stroke};
use crate::solve::Method;

/// Errors below this share of the rating are drawn at it: no `f64` force of that size tells them from 0.
const FLOOR: f64 = 1e-17;
/// The tolerance at which the planner's choice is marked: that of an analysis that asks for none.
const DEFAULT_TOLERANCE: f64 = 1e-9;

/// One of a row's two errors.
type Measure = fn(&MethodRow) -> f64;

/// Height of each of the two pairs of axes, in pixels.
const HEIGHT: f64 = 320.0;

/// The line at [`FLOOR`].
const UNSEEN: Stroke = Stroke::dashed(Color::Quiet, 1.0, "2 3");

/// How a series looks.
struct Look {
    name: String,
    color: Color,
    shape: Shape,
    size: f64,
}

/// The figure as SVG: peak errors above, force errors below, over the same run times.
pub fn figure(accuracy: &Accuracy) -> String {
    let errors: [(Measure, &str); 2] = [
        (|row| row.peak_error_n, "largest error of any coupler's peak / largest rating"),
        (|row| row.force_error_n, "largest error of any coupler's force at an instant / largest rating"),
    ];
    let mut figure = Figure::new("error-against-time");
    for (error_n, label) in errors {
        let (x, y) = ranges(accuracy);
        let mut panel = figure.panel(HEIGHT, Axis::log("run time, s", x), Axis::log(label, y));
        draw(&mut panel, accuracy, error_n, x);
        figure.add(panel);
    }
    for (look, _) in series(accuracy) {
        figure.explain(&look.name, Sample::Mark(look.shape, look.color));
    }
    let claimed = if accuracy.is_march { "up to the claimed bound or estimate" } else { "up to the claimed bound" };
    figure.explain(claimed, Sample::Line(Stroke::solid(Color::Ink, 1.2)));
    figure.explain("no error to be seen in an f64", Sample::Line(UNSEEN));
    figure.svg()
}

/// Rows of one method, in the order of their settings.
fn series(accuracy: &Accuracy) -> Vec<(Look, Vec<&MethodRow>)> {
    let mut all: Vec<(Look, Vec<&MethodRow>)> = Vec::new();
    for row in accuracy.rows.iter().filter(|r| !matches!(r.origin, RowOrigin::Planner(_))) {
        match all.last_mut().filter(|(look, _)| look.name == row.method) {
            Some((_, rows)) => rows.push(row),
            None => all.push((look(row), vec![row])),
        }
    }
    all
}

fn look(row: &MethodRow) -> Look {
    let (color, shape, size) = match row.origin {
        RowOrigin::Ours(method) | RowOrigin::Planner(method) => match method {
            Method::Fronts => (Color::Buff, Shape::Up, 6.0),
            Method::Modal => (Color::Rod, Shape::Square, 6.0),
            Method::Propagator => (Color::Other, Shape::Diamond, 6.5),
        },
        RowOrigin::March => (Color::Draft, Shape::Circle, 5.5),
        RowOrigin::Peer => match row.method {
            "Verlet with a clamp" => (Color::Quiet, Shape::Circle, 4.0),
            "Runge-Kutta 4 with a clamp" => (Color::Quiet, Shape::Down, 5.0),
            "friction smoothed by speed" => (Color::Buff, Shape::Up, 5.0),
            "softened lock" => (Color::Other, Shape::Diamond, 5.5),
            "Newmark" => (Color::Quiet, Shape::Square, 4.5),
            "Störmer-Verlet" => (Color::Quiet, Shape::Circle, 4.0),
            "Runge-Kutta 4" => (Color::Quiet, Shape::Down, 5.0),
            _ => (Color::Quiet, Shape::Cross, 5.0),
        },
    };
    Look { name: row.method.to_owned(), color, shape, size }
}

/// Where a row is drawn.
fn place(accuracy: &Accuracy, row: &MethodRow, error_n: f64) -> (f64, f64) {
    (row.run_time_s, (error_n / accuracy.rating_n).max(FLOOR))
}

fn draw(panel: &mut Panel, accuracy: &Accuracy, error_n: Measure, x: (f64, f64)) {
    panel.line(&[(x.0, FLOOR), (x.1, FLOOR)], UNSEEN);
    for (look, rows) in series(accuracy) {
        let points: Vec<(f64, f64)> = rows.iter().map(|row| place(accuracy, row, error_n(row))).collect();
        panel.line(&points, Stroke::solid(look.color, 1.2));
        for (row, point) in rows.iter().zip(&points) {
            let bound = row.bound_n.or(row.estimate_n).map(|b| place(accuracy, row, b).1);
            if let Some(bound) = bound.filter(|b| *b > point.1) {
                panel.bar(point.0, point.1, bound, look.color);
            }
        }
        panel.marks(&points, look.shape, look.size, look.color);
    }
    if let Some(row) = planned(accuracy) {
        let at = place(accuracy, row, error_n(row));
        panel.marks(&[at], Shape::Ring, 10.0, Color::Ink);
        panel.point_out("chosen by default", at);
    }
}

/// What the planner chose at the tolerance that is used when none is asked for.
fn planned(accuracy: &Accuracy) -> Option<&MethodRow> {
    let default = |[loosest, tightest]: [f64; 2]| (tightest..=loosest).contains(&DEFAULT_TOLERANCE);
    accuracy.rows.iter().find(|r| matches!(r.origin, RowOrigin::Planner(_)) && r.tolerances.is_some_and(default))
}

/// Whole decades around all rows, the same for both errors.
fn ranges(accuracy: &Accuracy) -> ((f64, f64), (f64, f64)) {
    let power = |p: f64| 10f64.powf(p);
    let points = || accuracy.rows.iter().map(|r| place(accuracy, r, r.peak_error_n.max(r.force_error_n)));
    let left = points().map(|p| p.0).fold(f64::INFINITY, f64::min).log10().floor();
    let right = points().map(|p| p.0).fold(f64::MIN_POSITIVE, f64::max).log10().ceil();
    let top = points().map(|p| p.1.log10()).fold(0.0, f64::max).min(3.0).floor() + 1.0;
    ((power(left), power(right.max(left + 1.0))), (0.1 * FLOOR, power(top)))
}
