//! How strongly each input of a study is correlated with the largest utilisation.

use crate::figures::{Axis, Color, Figure, Stroke};

/// Height of an input's row, in pixels.
const ROW: f64 = 30.0;
const BAR: Stroke = Stroke::solid(Color::Ink, 9.0);
const NONE: Stroke = Stroke::solid(Color::Quiet, 1.0);

/// A bar for each input, from 0 to its rank correlation, with the name on the other side of 0, as SVG.
pub fn influences(inputs: &[(String, f64)], name: &str) -> String {
    let mut figure = Figure::new(name);
    let rows = inputs.len() as f64;
    let x = Axis::new("rank correlation with the largest utilisation", (-1.0, 1.0));
    let mut panel = figure.panel(ROW * rows, x, Axis::rows(inputs.len()));
    panel.line(&[(0.0, 0.5), (0.0, rows + 0.5)], NONE);
    for (i, (input, correlation)) in inputs.iter().enumerate() {
        let at = (i + 1) as f64;
        panel.line(&[(0.0, at), (*correlation, at)], BAR);
        let (x, anchor) = if *correlation < 0.0 { (0.03, "start") } else { (-0.03, "end") };
        panel.write((x, at), anchor, input);
    }
    figure.add(panel);
    figure.svg()
}
