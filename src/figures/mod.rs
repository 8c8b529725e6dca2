//! Figures as SVG text: axes with round ticks, lines, bands, marks, pictures, labels, and a legend below the axes.
//!
//! What a figure shows is decided by its callers (`report::figures`, `accuracy::figure`); here it is drawn. The same input gives
//! the same bytes. A figure stands alone in a file or inline in a page, and follows a reader's dark mode in both; on a screen of
//! a telephone's width its text grows. Text is measured at that size, so that nothing overlaps there either.

mod color;
mod document;
mod marks;
mod panel;
mod place;
mod scale;
mod tags;

pub use color::{Color, css, ramp};
pub use document::{Figure, Sample};
pub use marks::{Shape, Stroke};
pub use panel::{Axis, Panel};
pub use scale::ticks;
pub use tags::escaped;

/// A point, in the data's units or in pixels.
pub type Point = (f64, f64);
