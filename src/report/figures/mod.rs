//! What the figures of a report show. How they are drawn is in [`crate::figures`].

mod breaks;
mod envelope;
mod history;
mod hysteresis;
mod influences;
mod map;
mod raster;
pub mod reach;
mod regions;
mod safe_factors;
mod wave;

pub use breaks::breaks;
pub use envelope::{couplers_per_place, envelope};
pub use history::history;
pub use hysteresis::hysteresis;
pub use influences::influences;
pub use map::map;
pub use regions::{over_rating, rows_over};
pub use safe_factors::safe_factors;
pub use wave::{Marks, wave};

use crate::figures::{Axis, Color, Point, Stroke};

/// Height of the axes of a figure with one panel, in pixels.
const HEIGHT: f64 = 330.0;
const RATED: Stroke = Stroke::dashed(Color::Ink, 1.2, "5 3");
const ROD: Stroke = Stroke::dashed(Color::Rod, 1.8, "7 3");

/// The axis along the train.
fn along(label: &str, couplers: usize) -> Axis {
    Axis::counting(label, (0.5, couplers as f64 + 0.5))
}

/// A size for so many marks: smaller where they are many, and never so small that they are overlooked.
fn mark_size(count: usize) -> f64 {
    (600.0 / count.max(1) as f64).clamp(4.5, 6.0)
}

/// The range of positive values with some air, from zero on unless that would make them look equal.
fn range_of_shares(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values.fold((f64::INFINITY, 0.0f64), |(l, h), v| (l.min(v), h.max(v)));
    if high <= 0.0 {
        return (0.0, 1.0);
    }
    let air = (0.1 * (high - low)).max(0.02 * high);
    (if low < 0.5 * high { 0.0 } else { low - air }, high + air)
}

/// A value per place as a line of steps, each as wide as so many couplers; a place without a value is a gap.
fn steps(values: &[Option<f64>], width: f64) -> Vec<Vec<Point>> {
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
