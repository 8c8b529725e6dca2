//! Error against run time as a log-log figure.
//!
//! This crate's methods are filled markers in colours that colour-blind readers tell apart (M. Okabe, K. Ito, *Color
//! Universal Design*, 2008), each with a bar up to the error it claims at most; marching methods are grey.

use kuva::backend::svg::SvgBackend;
use kuva::plot::legend::{LegendEntry, LegendShape};
use kuva::plot::scatter::MarkerShape;
use kuva::plot::{LinePlot, ScatterPlot};
use kuva::render::annotations::{ReferenceLine, TextAnnotation};
use kuva::render::figure::Figure;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;

use super::{Accuracy, Origin, Row};
use crate::solve::Method;

/// Errors below this share of the rating are drawn at it: no `f64` force of that size tells them from 0.
const FLOOR: f64 = 1e-17;
/// The tolerance at which the planner's choice is marked: that of an analysis that asks for none.
const DEFAULT_TOLERANCE: f64 = 1e-9;

/// One of a row's two errors.
type Measure = fn(&Row) -> f64;

/// How a series looks.
struct Look {
    name: String,
    color: &'static str,
    marker: MarkerShape,
    size: f64,
}

/// The figure as SVG: peak errors on the left, force errors on the right.
pub fn figure(accuracy: &Accuracy) -> String {
    let errors: [(Measure, &str); 2] = [
        (|row| row.peak_error_n, "Largest error of any coupler's peak"),
        (|row| row.force_error_n, "Largest error of any coupler's force at an instant"),
    ];
    let panels = errors.map(|(error_n, _)| panel(accuracy, error_n));
    let layouts = errors.iter().zip(&panels).map(|((error_n, title), plots)| layout(accuracy, plots, *error_n, title));
    let layouts = layouts.collect();
    let scene = Figure::new(1, 2)
        .with_plots(panels.into_iter().collect())
        .with_layouts(layouts)
        .with_cell_size(520.0, 480.0)
        .with_shared_legend_entries(legend(accuracy))
        .with_shared_legend_right_middle()
        .render();
    SvgBackend.render_scene(&scene)
}

/// Rows of one method, in the order of their settings.
fn series(accuracy: &Accuracy) -> Vec<(Look, Vec<&Row>)> {
    let mut all: Vec<(Look, Vec<&Row>)> = Vec::new();
    for row in accuracy.rows.iter().filter(|r| !matches!(r.origin, Origin::Planner(_))) {
        match all.last_mut().filter(|(look, _)| look.name == row.method) {
            Some((_, rows)) => rows.push(row),
            None => all.push((look(row), vec![row])),
        }
    }
    all
}

fn look(row: &Row) -> Look {
    let (color, marker, size) = match row.origin {
        Origin::Ours(Method::ClosedForm) | Origin::Planner(Method::ClosedForm) => ("#0072B2", MarkerShape::Circle, 5.5),
        Origin::Ours(Method::Fronts) | Origin::Planner(Method::Fronts) => ("#D55E00", MarkerShape::Triangle, 6.0),
        Origin::Ours(Method::Modal) | Origin::Planner(Method::Modal) => ("#009E73", MarkerShape::Square, 5.5),
        Origin::Ours(Method::Propagator) | Origin::Planner(Method::Propagator) => {
            ("#CC79A7", MarkerShape::Diamond, 6.0)
        }
        Origin::Peer => match row.method {
            "Newmark" => ("#8c8c8c", MarkerShape::Square, 4.0),
            "Störmer-Verlet" => ("#8c8c8c", MarkerShape::Circle, 4.0),
            "Runge-Kutta 4" => ("#595959", MarkerShape::TriangleDown, 4.5),
            _ => ("#262626", MarkerShape::Cross, 4.5),
        },
    };
    Look { name: row.method.to_owned(), color, marker, size }
}

/// Where a row is drawn: decimal logarithms, because the library's own logarithmic axes end at 1e-10.
fn place(accuracy: &Accuracy, row: &Row, error_n: f64) -> (f64, f64) {
    (row.run_time_s.log10(), (error_n / accuracy.rating_n).max(FLOOR).log10())
}

fn panel(accuracy: &Accuracy, error_n: Measure) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (look, rows) in series(accuracy) {
        let points: Vec<(f64, f64)> = rows.iter().map(|row| place(accuracy, row, error_n(row))).collect();
        let line = LinePlot::new().with_data(points.clone()).with_color(look.color).with_stroke_width(1.2);
        let mut markers = ScatterPlot::new()
            .with_data(points.clone())
            .with_color(look.color)
            .with_size(look.size)
            .with_marker(look.marker);
        if rows.iter().all(|row| row.bound_n.is_some()) {
            markers = markers.with_y_err_asymmetric(rows.iter().zip(&points).map(|(row, point)| {
                let bound = row.bound_n.map_or(point.1, |b| place(accuracy, row, b).1);
                (0.0, (bound - point.1).max(0.0))
            }));
        }
        plots.extend([Plot::Line(line), Plot::Scatter(markers)]);
    }
    if let Some(row) = planned(accuracy) {
        let ring = ScatterPlot::new()
            .with_data(vec![place(accuracy, row, error_n(row))])
            .with_color("#000000")
            .with_size(10.0)
            .with_marker_opacity(0.0)
            .with_marker_stroke_width(1.4);
        plots.push(Plot::Scatter(ring));
    }
    plots
}

/// What the planner chose at the tolerance that is used when none is asked for.
fn planned(accuracy: &Accuracy) -> Option<&Row> {
    let default = |[loosest, tightest]: [f64; 2]| (tightest..=loosest).contains(&DEFAULT_TOLERANCE);
    accuracy.rows.iter().find(|r| matches!(r.origin, Origin::Planner(_)) && r.tolerances.is_some_and(default))
}

fn layout(accuracy: &Accuracy, plots: &[Plot], error_n: Measure, title: &str) -> Layout {
    let points: Vec<(f64, f64)> =
        accuracy.rows.iter().map(|r| place(accuracy, r, r.peak_error_n.max(r.force_error_n))).collect();
    let left = points.iter().map(|p| p.0).fold(f64::INFINITY, f64::min).floor();
    let right = points.iter().map(|p| p.0).fold(f64::NEG_INFINITY, f64::max).ceil();
    let top = points.iter().map(|p| p.1).fold(0.0, f64::max).min(3.0).floor() + 1.0;
    let note = |text: &str, x: f64, y: f64| TextAnnotation::new(text, x, y).with_color("#404040").with_font_size(11);
    let layout = Layout::auto_from_plots(plots)
        .with_title(title)
        .with_title_size(15)
        .with_x_label("run time, s")
        .with_y_label("error / largest rating")
        .with_x_axis_min(left)
        .with_x_axis_max(right)
        .with_x_tick_step(1.0)
        .with_y_axis_min(FLOOR.log10() - 1.0)
        .with_y_axis_max(top)
        .with_y_tick_step(2.0)
        .with_tick_format(TickFormat::Custom(std::sync::Arc::new(power_of_ten)))
        .with_grid_line_width(0.5)
        .with_reference_line(ReferenceLine::horizontal(FLOOR.log10()).with_color("#8c8c8c").with_dasharray("2 3"))
        .with_annotation(note("no error to be seen in an f64", left + 0.8, FLOOR.log10()));
    match planned(accuracy) {
        Some(row) => {
            let (x, y) = place(accuracy, row, error_n(row));
            layout.with_annotation(
                note("chosen by default", 0.5 * (x + left), y + 4.0).with_arrow(x, y).with_arrow_padding(12.0),
            )
        }
        None => layout,
    }
}

/// A tick's label, from its decimal logarithm.
fn power_of_ten(x: f64) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let exponent = x.round() as i32;
    let digits = exponent.unsigned_abs().to_string();
    let raised: String = digits.bytes().map(|d| DIGITS[usize::from(d - b'0')]).collect();
    format!("10{}{raised}", if exponent < 0 { "⁻" } else { "" })
}

fn legend(accuracy: &Accuracy) -> Vec<LegendEntry> {
    let entry = |look: Look| LegendEntry {
        label: look.name,
        color: look.color.to_owned(),
        shape: LegendShape::Marker(look.marker),
        dasharray: None,
    };
    let bar = LegendEntry {
        label: "up to the claimed bound".to_owned(),
        color: "#000000".to_owned(),
        shape: LegendShape::Line,
        dasharray: None,
    };
    series(accuracy).into_iter().map(|(look, _)| entry(look)).chain([bar]).collect()
}
