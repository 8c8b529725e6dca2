//! Place against time: force in every coupler, in colours of its utilisation, and the elastic rod's below on the same scale.

use kuva::plot::scatter::MarkerShape;
use kuva::render::layout::TickFormat;

use super::raster::{BUFF, DRAFT, mixed, png_base64};
use super::{BLACK, Figure, TEXT_SIZE, VERMILLION, WIDTH, count_couplers, marker_size};
use crate::findings::{CascadeBreak, Field};
use crate::report::numbers::time_unit;

/// Room beyond the ends of the train, as a share of it.
const MARGIN: f64 = 0.02;

/// What is marked over the picture, in couplers from 1 at the head and seconds.
#[derive(Default)]
pub struct Marks<'a> {
    /// Where the event is: a coupler, or half a place beside it for a vehicle.
    pub event: Option<f64>,
    /// How long a force acts there, s.
    pub acts_s: f64,
    /// The coupler that is gone from t = 0 on.
    pub broken: Option<usize>,
    /// Couplers that break on the way.
    pub breaks: &'a [CascadeBreak],
}

/// A picture of the wave, as SVG, with the rod's below it where there is one.
pub fn wave(field: &Field, rod: Option<&Field>, marks: &Marks, since: &str, couplers: usize, name: &str) -> String {
    let most = rod.into_iter().chain([field]).map(|f| f64::from(f.largest())).fold(0.0, f64::max);
    let high = if rod.is_some() { 300.0 } else { 380.0 };
    let titles = ["the chain: every coupler", "the elastic rod, at the couplers' places"];
    let panels: Vec<(&Field, Option<&str>)> = match rod {
        Some(rod) => vec![(field, Some(titles[0])), (rod, Some(titles[1]))],
        None => vec![(field, None)],
    };
    let mut body = String::new();
    let mut top = 0.0;
    for (i, (field, title)) in panels.iter().enumerate() {
        let last = i + 1 == panels.len();
        let high = high + if last { 30.0 } else { 0.0 };
        if let Some(title) = title {
            body += &format!(
                "<text x=\"430\" y=\"{}\" font-size=\"{TEXT_SIZE}\" text-anchor=\"middle\">{title}</text>",
                top + 15.0
            );
            top += 22.0;
        }
        let panel = panel(field, marks, since, couplers, (high, last), &format!("{name}-{i}"), most);
        body += &panel.replacen("<svg ", &format!("<svg y=\"{top}\" "), 1);
        top += high;
    }
    body += &color_bar(top, most, name);
    let height = top + 52.0;
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height}\" viewBox=\"0 0 {WIDTH} {height}\" \
         font-family=\"Arial, Helvetica, Liberation Sans, DejaVu Sans, sans-serif\" fill=\"black\">\
         <rect width=\"100%\" height=\"100%\" fill=\"white\" />{body}</svg>\n"
    )
}

fn panel(
    field: &Field,
    marks: &Marks,
    since: &str,
    couplers: usize,
    (high, last): (f64, bool),
    name: &str,
    most: f64,
) -> String {
    let until = field.times_s[field.times_s.len() - 1];
    let clock = time_unit(until);
    let x = (0.0, until / clock.size);
    // The head on top: places run downward. A margin beyond both ends has room for what is marked there.
    let margin = MARGIN * couplers as f64;
    let y = (-(couplers as f64) - 0.5 - margin, -0.5 + margin);
    let mut figure = Figure::new(name);
    let gone = marks.broken.map(|b| (b as f64, 0.0)).into_iter();
    let gone: Vec<_> = gone.chain(marks.breaks.iter().map(|b| (b.coupler as f64, b.time_s))).collect();
    for (i, (place, from)) in gone.into_iter().enumerate() {
        let line = vec![(from / clock.size, -place), (x.1, -place)];
        figure.line(line, BLACK, 1.2, Some("2 3"), (last && i == 0).then_some("parted"));
    }
    let label = |text| last.then_some(text);
    if let Some(place) = marks.event.filter(|_| marks.acts_s > 0.0) {
        let end = marks.acts_s.min(until) / clock.size;
        figure.line(vec![(0.0, -place), (end, -place)], BLACK, 5.0, None, label("the force acts"));
    }
    let event = marks.event.map(|p| (0.0, -p)).into_iter().collect();
    figure.markers(event, BLACK, MarkerShape::Square, 5.0, label("the event"));
    let broken: Vec<_> = marks.breaks.iter().map(|b| (b.time_s / clock.size, -(b.coupler as f64))).collect();
    let size = marker_size(broken.len());
    figure.markers(broken, VERMILLION, MarkerShape::Diamond, size, label("a coupler breaks"));
    let x_label = if last { format!("{since}, {}", clock.name) } else { String::new() };
    // There is no coupler 0.
    let downward = |v: f64| if v < 0.0 { TickFormat::Auto.format(-v) } else { String::new() };
    let downward = TickFormat::Custom(std::sync::Arc::new(downward));
    let layout = count_couplers(figure.layout(x, y, &x_label, "coupler, from the head"), couplers)
        .with_height(high)
        .with_y_tick_format(downward);
    let layout = if couplers < 10 { layout.with_y_tick_step(1.0) } else { layout };
    let layout = if last { layout } else { layout.with_force_margins_y(6.0, 26.0) };
    with_image(&figure.svg(layout), &png_base64(field, most))
}

/// The image within the axes, under all that is drawn there.
fn with_image(svg: &str, png: &str) -> String {
    let number = |key: &str, of: &str| {
        let rest = of.split_once(&format!("{key}=\""))?.1;
        rest.split('"').next()?.parse::<f64>().ok()
    };
    let frame = svg
        .split("<clipPath")
        .nth(1)
        .and_then(|c| Some([number(" x", c)?, number(" y", c)?, number("width", c)?, number("height", c)?]));
    let Some([x, y, width, height]) = frame else { return svg.to_owned() };
    let (y, height) = (y + height * MARGIN / (1.0 + 2.0 * MARGIN), height / (1.0 + 2.0 * MARGIN));
    let image = format!(
        "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\" \
         style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{png}\" />"
    );
    let at = svg.find("</defs>").map_or(svg.len(), |i| i + "</defs>".len());
    format!("{}{image}{}", &svg[..at], &svg[at..])
}

/// The scale of colours, with the rating marked in both senses.
fn color_bar(top: f64, most: f64, name: &str) -> String {
    let (left, width) = (230.0, 400.0);
    let stop = |i: i32| {
        let share = f64::from(i) / 12.0;
        let [r, g, b] = mixed(if i < 0 { &BUFF } else { &DRAFT }, share.abs());
        format!("<stop offset=\"{}\" stop-color=\"#{r:02x}{g:02x}{b:02x}\"/>", 0.5 + 0.5 * share)
    };
    let stops: String = (-12..=12).map(stop).collect();
    let text = |x: f64, y: f64, anchor: &str, text: &str| {
        format!("<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"14\" text-anchor=\"{anchor}\">{text}</text>")
    };
    let at = |share: f64| left + 0.5 * width * (1.0 + share / most);
    let step = [0.1, 0.25, 0.5, 1.0, 2.0, 5.0].into_iter().find(|s| most / s <= 4.5).unwrap_or(most / 4.0);
    let count = (most / step + 0.01).floor() as i32;
    let mut out = format!(
        "<defs><linearGradient id=\"{name}-scale\">{stops}</linearGradient></defs>\
         <rect x=\"{left}\" y=\"{}\" width=\"{width}\" height=\"14\" fill=\"url(#{name}-scale)\" stroke=\"#000000\" stroke-width=\"0.6\"/>",
        top + 8.0
    );
    for i in -count..=count {
        let share = f64::from(i) * step;
        let label = format!("{} %", (100.0 * share.abs()).round());
        out += &text(at(share), top + 38.0, "middle", &label);
    }
    if most > 0.99 {
        for x in [at(-1.0), at(1.0)] {
            out += &format!("<path d=\"M{x:.1} {}v18\" stroke=\"#000000\" stroke-width=\"2\"/>", top + 6.0);
        }
    }
    out += &text(left - 12.0, top + 20.0, "end", "buff");
    out + &text(left + width + 12.0, top + 20.0, "start", "draft, of the rating")
}
