//! The figures, as SVG.
//!
//! Colours are from the palette of M. Okabe and K. Ito, *Color Universal Design* (2008), which colour-blind readers can tell
//! apart; in print without colour the lines differ by dashes and the markers by shape. The same findings give the same bytes.

mod breaks;
mod envelope;
mod history;
mod map;
mod place;
mod raster;
mod safe_load;
mod wave;

pub use breaks::breaks;
pub use envelope::{couplers_per_place, envelope};
pub use history::{history, window};
pub use map::map;
pub use safe_load::safe_load;
pub use wave::{Marks, wave};

use kuva::plot::legend::{LegendEntry, LegendPosition, LegendShape};
use kuva::plot::line::{LinePlot, LineStyle};
use kuva::plot::scatter::{MarkerShape, ScatterPlot};
use kuva::render::annotations::ReferenceLine;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;

const BLACK: &str = "#000000";
const GREY: &str = "#7f7f7f";
const BLUE: &str = "#0072b2";
const GREEN: &str = "#009e73";
const ORANGE: &str = "#e69f00";
const VERMILLION: &str = "#d55e00";

const WIDTH: f64 = 860.0;
const HEIGHT: f64 = 480.0;
const TEXT_SIZE: u32 = 15;
/// Dashes of a rating's line, twice over so that the legend shows two of them.
const RATED: &str = "4 3 4 3";

/// A figure under way: what is drawn, and the legend that says what it is.
struct Figure {
    name: String,
    plots: Vec<Plot>,
    legend: Vec<LegendEntry>,
    /// Every line drawn, for labels to keep clear of.
    lines: Vec<Vec<(f64, f64)>>,
}

impl Figure {
    fn new(name: &str) -> Figure {
        Figure { name: name.to_owned(), plots: Vec::new(), legend: Vec::new(), lines: Vec::new() }
    }

    /// A line; one without a label has no place in the legend.
    fn line(&mut self, points: Vec<(f64, f64)>, color: &str, width: f64, dash: Option<&str>, label: Option<&str>) {
        let style = dash.map_or(LineStyle::Solid, |d| LineStyle::Custom(d.to_owned()));
        self.lines.push(points.clone());
        let line = LinePlot::new().with_data(points).with_color(color).with_stroke_width(width).with_line_style(style);
        self.plots.push(line.into());
        self.explain(label, color, LegendShape::Line, dash);
    }

    fn markers(&mut self, points: Vec<(f64, f64)>, color: &str, shape: MarkerShape, size: f64, label: Option<&str>) {
        if points.is_empty() {
            return;
        }
        self.plots
            .push(ScatterPlot::new().with_data(points).with_color(color).with_marker(shape).with_size(size).into());
        self.explain(label, color, LegendShape::Marker(shape), None);
    }

    fn explain(&mut self, label: Option<&str>, color: &str, shape: LegendShape, dash: Option<&str>) {
        let entry = |label: &str| LegendEntry {
            label: label.to_owned(),
            color: color.to_owned(),
            shape,
            dasharray: dash.map(str::to_owned),
        };
        self.legend.extend(label.map(entry));
    }

    /// Axes over given ranges, with the house's sizes and a thin line at zero.
    fn layout(&self, x: (f64, f64), y: (f64, f64), x_label: &str, y_label: &str) -> Layout {
        let zero = ReferenceLine::horizontal(0.0).with_color(GREY).with_stroke_width(0.6).with_dasharray("none");
        let layout = Layout::new(x, y)
            .with_width(WIDTH)
            .with_height(HEIGHT)
            .with_x_label(x_label)
            .with_y_label(y_label)
            .with_font_family("Arial, Helvetica, Liberation Sans, DejaVu Sans, sans-serif")
            .with_label_size(TEXT_SIZE)
            .with_tick_size(14)
            .with_body_size(14)
            .with_box_axes()
            .with_show_grid(false)
            .with_ticks(7)
            .with_x_axis_min(x.0)
            .with_x_axis_max(x.1)
            .with_y_axis_min(y.0)
            .with_y_axis_max(y.1)
            .with_y_tick_format(minus_signs())
            .with_legend_position(LegendPosition::OutsideBottomColumns)
            .with_legend_entries(self.legend.clone())
            .with_legend_box(false);
        if y.0 < 0.0 && y.1 > 0.0 { layout.with_reference_line(zero) } else { layout }
    }

    fn svg(self, layout: Layout) -> String {
        let svg = kuva::render_to_svg(self.plots, layout);
        name_clip_path(&svg, &self.name)
    }
}

/// Tick labels of the library with a true minus sign.
fn minus_signs() -> TickFormat {
    TickFormat::Custom(std::sync::Arc::new(|v| TickFormat::Auto.format(v).replacen('-', "\u{2212}", 1)))
}

/// The SVG with its clip path named after the figure.
///
/// The library numbers clip paths by a counter of the whole process; a name of the figure's own keeps the bytes the same
/// from run to run, and two figures apart when a page inlines both.
fn name_clip_path(svg: &str, name: &str) -> String {
    let mut out = String::with_capacity(svg.len());
    let mut rest = svg;
    while let Some(at) = rest.find("kuva-clip-") {
        out.push_str(&rest[..at]);
        out.push_str("clip-");
        out.push_str(name);
        rest = rest[at + "kuva-clip-".len()..].trim_start_matches(|c: char| c.is_ascii_digit());
    }
    out.push_str(rest);
    out
}

/// Ticks of an axis that counts couplers: never between two of them.
fn count_couplers(layout: Layout, couplers: usize) -> Layout {
    if couplers < 10 { layout.with_x_tick_step(1.0) } else { layout }
}

/// Size of a marker that does not hide its neighbours when there are so many.
fn marker_size(count: usize) -> f64 {
    (300.0 / count.max(1) as f64).clamp(3.2, 4.5)
}

/// The range of the values, zero included, with some air at both ends.
fn range_with_air(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values.fold((0.0f64, 0.0f64), |(l, h), v| (l.min(v), h.max(v)));
    if low == high {
        return (-1.0, 1.0);
    }
    let air = 0.08 * (high - low);
    (if low < 0.0 { low - air } else { low }, if high > 0.0 { high + air } else { high })
}

/// A value per place as a line of steps, each as wide as so many couplers; a place without a value is a gap.
fn steps(values: &[Option<f64>], width: f64) -> Vec<Vec<(f64, f64)>> {
    let runs = values.chunk_by(|a, b| a.is_some() == b.is_some());
    let mut at = 0.5;
    runs.filter_map(|run| {
        let from = at;
        at += width * run.len() as f64;
        let steps: Vec<_> = run
            .iter()
            .flatten()
            .enumerate()
            .flat_map(|(i, &v)| [(from + width * i as f64, v), (from + width * (i as f64 + 1.0), v)])
            .collect();
        (!steps.is_empty()).then_some(steps)
    })
    .collect()
}
