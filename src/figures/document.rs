//! The document around the panels: the card, the legend, the text.

use super::Color;
use super::color::{CLASS, TEXT_SIZE, style};
use super::marks::{Shape, Stroke};
use super::panel::{Axis, Panel};
use super::place::Frame;
use super::tags::{half_width, number, paint, text};

/// Width of every figure, and what its frames leave free on the left and on the right: the same in all, so that figures of the
/// same time lie under each other.
const WIDTH: f64 = 720.0;
const LEFT: f64 = 74.0;
const RIGHT: f64 = 24.0;
/// Heights of a line of text above a frame, of the numbers below it, and of a line of text below those.
const TITLE: f64 = 34.0;
const NUMBERS: f64 = 30.0;
const LINE: f64 = 27.0;
/// Width of a legend's sample with the room beside it.
const SAMPLE: f64 = 38.0;
/// The typeface of the pages too.
const FONT: &str = "system-ui, 'Segoe UI', 'Helvetica Neue', Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif";

/// What a legend shows beside its words.
#[derive(Clone, Copy)]
pub enum Sample {
    /// A stretch of a line.
    Line(Stroke),
    /// A mark.
    Mark(Shape, Color),
}

/// A line of the legend.
type Entry = (String, Sample);

/// A figure under way: panels below each other, then the legend.
pub struct Figure {
    name: String,
    body: String,
    legend: Vec<Entry>,
    height: f64,
}

impl Figure {
    /// An empty figure. The name sets its identifiers apart from those of other figures in a page.
    pub fn new(name: &str) -> Figure {
        Figure { name: name.to_owned(), body: String::new(), legend: Vec::new(), height: 0.0 }
    }

    /// A panel below what is there, its frame so high; the label of `y` stands above it. [`Figure::add`] puts it in.
    pub fn panel(&mut self, height: f64, x: Axis, y: Axis) -> Panel {
        let top = self.height + TITLE;
        let below = if x.label().is_empty() { NUMBERS } else { NUMBERS + LINE };
        self.height = top + height + below;
        let frame = Frame { left: LEFT, top, width: WIDTH - LEFT - RIGHT, height };
        Panel::new(format!("{}-{}", self.name, self.height.round()), frame, x, y)
    }

    /// Puts a panel into the figure.
    pub fn add(&mut self, panel: Panel) {
        self.body += &panel.finish();
    }

    /// Adds to the legend.
    pub fn explain(&mut self, label: &str, sample: Sample) {
        self.legend.push((label.to_owned(), sample));
    }

    /// A scale of colours from one end of the range to the other, below what is there, with numbers below it.
    pub fn color_bar(&mut self, colors: &[[u8; 3]], ticks: &[(f64, String)], ends: [&str; 2]) {
        let (left, width, top) = (0.5 * (WIDTH - 400.0), 400.0, self.height + 8.0);
        let stop = |(i, [r, g, b]): (usize, &[u8; 3])| {
            let at = number(i as f64 / (colors.len() - 1).max(1) as f64 * 100.0);
            format!("<stop offset=\"{at}%\" stop-color=\"#{r:02x}{g:02x}{b:02x}\"/>")
        };
        let stops: String = colors.iter().enumerate().map(stop).collect();
        let name = format!("{}-scale", self.name);
        self.body += &format!(
            "<defs><linearGradient id=\"{name}\">{stops}</linearGradient></defs>\
             <rect class=\"picture\" x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"14\" fill=\"url(#{name})\"/>\
             <rect x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"14\" {}/>",
            paint(None, Some(Color::Quiet))
        );
        for (share, label) in ticks {
            self.body += &text((left + share * width, top + 34.0), "middle", label);
        }
        self.body += &text((left - 12.0, top + 13.0), "end", ends[0]);
        self.body += &text((left + width + 12.0, top + 13.0), "start", ends[1]);
        self.height = top + 44.0;
    }

    /// The finished text, one line.
    pub fn svg(mut self) -> String {
        let (mut x, mut y) = (LEFT, self.height + 6.0);
        for (label, sample) in &self.legend {
            let width = SAMPLE + 2.0 * half_width(label);
            if x > LEFT && x + width > WIDTH {
                (x, y) = (LEFT, y + LINE);
            }
            let middle = y + 0.5 * LINE;
            self.body += &match sample {
                Sample::Line(stroke) => stroke.path(&[(x, middle), (x + 28.0, middle)]),
                Sample::Mark(shape, color) => shape.path((x + 14.0, middle), 5.5, *color),
            };
            self.body += &text((x + SAMPLE, middle + 5.0), "start", label);
            x += width + 22.0;
        }
        let height = if self.legend.is_empty() { self.height + 8.0 } else { y + LINE + 8.0 };
        let ink = Color::Ink;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height}\" viewBox=\"0 0 {WIDTH} {height}\" \
             font-family=\"{FONT}\" font-size=\"{TEXT_SIZE}\" fill=\"{}\" class=\"{CLASS} f-{}\">{}\
             <rect width=\"100%\" height=\"100%\" {}/>{}</svg>\n",
            ink.light(),
            ink.name(),
            style(),
            paint(Some(Color::Card), None),
            self.body
        )
    }
}

#[cfg(test)]
mod tests;
