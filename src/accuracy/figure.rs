//! Error against run time as a log-log figure.
//!
//! This crate's methods are filled markers in colours that colour-blind readers tell apart (M. Okabe, K. Ito, *Color
//! Universal Design*, 2008), each with a bar up to the error it claims at most; marching methods are open grey markers.

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
/// The tolerance at which the planner's choice is marked.
const DEFAULT_SETTING: &str = "tolerance 1e-9";

/// How a series looks.
struct Look {
    name: String,
    color: &'static str,
    marker: MarkerShape,
    size: f64,
}

/// The figure as SVG: peak errors on the left, force errors on the right.
pub fn figure(accuracy: &Accuracy) -> String {
    let peak = |row: &Row| row.peak_error_n / accuracy.rating_n;
    let force = |row: &Row| row.force_error_n / accuracy.rating_n;
    let panels = [panel(accuracy, &peak), panel(accuracy, &force)];
    let layouts = vec![
        layout(accuracy, &panels[0], "Largest error of any coupler's peak"),
        layout(accuracy, &panels[1], "Largest error of any coupler's force at an instant"),
    ];
    let scene = Figure::new(1, 2)
        .with_plots(panels.into_iter().collect())
        .with_layouts(layouts)
        .with_cell_size(560.0, 480.0)
        .with_shared_legend_entries(legend(accuracy))
        .with_shared_legend_bottom()
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

fn panel(accuracy: &Accuracy, error: &dyn Fn(&Row) -> f64) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (look, rows) in series(accuracy) {
        let at = |row: &&Row| (row.run_time_s, error(row).max(FLOOR));
        let points: Vec<(f64, f64)> = rows.iter().map(at).collect();
        let ours = rows[0].origin != Origin::Peer;
        let width = if ours { 1.6 } else { 1.0 };
        plots.push(Plot::Line(
            LinePlot::new().with_data(points.clone()).with_color(look.color).with_stroke_width(width),
        ));
        let mut markers = ScatterPlot::new()
            .with_data(points.clone())
            .with_color(look.color)
            .with_size(look.size)
            .with_marker(look.marker);
        markers = if ours {
            let bars = rows.iter().zip(&points).map(|(row, point)| {
                let bound = row.bound_n.map_or(point.1, |b| b / accuracy.rating_n);
                (0.0, (bound - point.1).max(0.0))
            });
            markers.with_y_err_asymmetric(bars)
        } else {
            markers.with_marker_opacity(0.0).with_marker_stroke_width(1.4)
        };
        plots.push(Plot::Scatter(markers));
    }
    if let Some(row) = planned(accuracy) {
        let star = ScatterPlot::new()
            .with_data(vec![(row.run_time_s, error(row).max(FLOOR))])
            .with_color("#000000")
            .with_size(9.0)
            .with_marker(MarkerShape::Star)
            .with_marker_opacity(0.0)
            .with_marker_stroke_width(1.2);
        plots.push(Plot::Scatter(star));
    }
    plots
}

/// What the planner chose when nothing was asked of it.
fn planned(accuracy: &Accuracy) -> Option<&Row> {
    accuracy.rows.iter().find(|r| matches!(r.origin, Origin::Planner(_)) && r.setting == DEFAULT_SETTING)
}

fn layout(accuracy: &Accuracy, plots: &[Plot], title: &str) -> Layout {
    let times = || accuracy.rows.iter().map(|r| r.run_time_s);
    let decade = |x: f64, up: f64| 10f64.powf((x.log10() + up).floor());
    let (least, most) = (times().fold(f64::INFINITY, f64::min), times().fold(0.0, f64::max));
    let largest =
        accuracy.rows.iter().map(|r| r.peak_error_n.max(r.force_error_n) / accuracy.rating_n).fold(0.0, f64::max);
    let left = decade(least, 0.0);
    Layout::auto_from_plots(plots)
        .with_log_scale()
        .with_title(title)
        .with_x_label("run time, s")
        .with_y_label("error / largest rating")
        .with_x_axis_min(left)
        .with_x_axis_max(decade(most, 1.0))
        .with_y_axis_min(FLOOR / 10.0)
        .with_y_axis_max(decade(largest.clamp(1e-3, 1e3), 1.0))
        .with_tick_format(TickFormat::Custom(std::sync::Arc::new(power_of_ten)))
        .with_grid_line_width(0.5)
        .with_reference_line(ReferenceLine::horizontal(FLOOR).with_color("#8c8c8c").with_dasharray("2 3"))
        .with_annotation(
            TextAnnotation::new("errors this small are drawn here", 2.0 * left, FLOOR)
                .with_color("#595959")
                .with_font_size(10),
        )
}

fn power_of_ten(x: f64) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let exponent = x.log10().round() as i32;
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
    let mut entries: Vec<LegendEntry> = series(accuracy).into_iter().map(|(look, _)| entry(look)).collect();
    if planned(accuracy).is_some() {
        let label = "the planner's choice".to_owned();
        let shape = LegendShape::Marker(MarkerShape::Star);
        entries.push(LegendEntry { label, color: "#000000".to_owned(), shape, dasharray: None });
    }
    entries
}
