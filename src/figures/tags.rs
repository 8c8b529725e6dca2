//! Tags and texts of SVG.

use super::color::LARGE_TEXT;
use super::{Color, Point};
use crate::error::controls_display;

/// Mean width of a letter, as a share of the text's size.
const LETTER: f64 = 0.57;

/// Attributes of fill and outline, each drawn only if it has a colour.
pub fn paint(fill: Option<Color>, stroke: Option<Color>) -> String {
    let value = |color: Option<Color>| color.map_or("none", Color::light);
    let class = |prefix: &str, color: Option<Color>| color.map(|c| format!("{prefix}-{}", c.name()));
    let classes: Vec<String> = [class("f", fill), class("s", stroke)].into_iter().flatten().collect();
    let stroke = stroke.map_or_else(String::new, |c| format!(" stroke=\"{}\"", value(Some(c))));
    format!("fill=\"{}\"{stroke} class=\"{}\"", value(fill), classes.join(" "))
}

/// A text from, around or up to a point of its base line.
pub fn text(at: Point, anchor: &str, content: &str) -> String {
    let [x, y] = [at.0, at.1].map(number);
    format!("<text x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\">{}</text>", escaped(content))
}

/// Half the width of a text where letters are large.
pub fn half_width(text: &str) -> f64 {
    0.5 * LETTER * LARGE_TEXT * text.chars().count() as f64
}

/// A coordinate, to a tenth of a pixel.
pub fn number(value: f64) -> String {
    let text = format!("{value:.1}");
    let text = text.strip_suffix(".0").unwrap_or(&text);
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// Text with nothing in it that XML or HTML would take for markup, in elements and in quoted attributes.
pub fn escaped(plain: &str) -> String {
    let mut out = String::with_capacity(plain.len());
    for c in plain.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c if controls_display(c) => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests;
