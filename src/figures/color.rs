//! The colours of all figures, the static ones and those of the page's script: one meaning a colour.
//!
//! They are from the palette of M. Okabe and K. Ito, *Color Universal Design* (2008), which colour-blind readers can tell apart,
//! made lighter for dark pages. In print without colour the lines differ by dashes and the marks by shape.

use std::fmt::Write;

/// What a colour stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Color {
    /// What the figure is drawn on.
    Card,
    /// Text, axes, ratings.
    Ink,
    /// What matters less: the load before the event, help lines, other programs' methods.
    Quiet,
    /// Forces in draft.
    Draft,
    /// Forces in buff.
    Buff,
    /// Over the rating.
    Over,
    /// The elastic rod.
    Rod,
    /// A coupler that passes its slack.
    Slack,
    /// A series without a meaning of its own.
    Other,
}

/// Every colour with its name in style sheets, for light pages and for dark ones.
const ALL: [(Color, &str, &str, &str); 9] = [
    (Color::Card, "card", "#ffffff", "#1e242b"),
    (Color::Ink, "ink", "#1b1f24", "#e8eaed"),
    (Color::Quiet, "quiet", "#6b7480", "#9aa5b1"),
    (Color::Draft, "draft", "#0072b2", "#56b4e9"),
    (Color::Buff, "buff", "#d55e00", "#f08c3a"),
    (Color::Over, "over", "#b0125b", "#ff7ab0"),
    (Color::Rod, "rod", "#00805d", "#3fcf9f"),
    // Light and dark as a picture on a dark page turns it.
    (Color::Slack, "slack", "#8c8c8c", "#767676"),
    (Color::Other, "other", "#8a4f9e", "#cf9fe0"),
];

/// The mark of a figure's root element, so that its style touches nothing else of a page.
pub const CLASS: &str = "trainsafe-figure";
/// Sizes of text in pixels of the figure, on a wide screen and on a narrow one.
pub const TEXT_SIZE: f64 = 15.0;
pub const LARGE_TEXT: f64 = 20.0;
/// Colours of utilisations from the largest buff through zero to the largest draft, darker toward both ends.
const RAMP: [[u8; 3]; 7] =
    [[110, 36, 0], [213, 94, 0], [250, 196, 110], [255, 255, 255], [134, 196, 236], [0, 114, 178], [0, 50, 92]];
/// Turns a light picture into one for a dark page: the lightness is inverted, the hue stays.
const DARK_PICTURE: &str = "filter:invert(.88) hue-rotate(180deg)";

impl Color {
    fn entry(self) -> (Color, &'static str, &'static str, &'static str) {
        ALL[self as usize]
    }

    pub(super) fn name(self) -> &'static str {
        self.entry().1
    }

    /// On a light page, as red, green, blue.
    pub fn rgb(self) -> [u8; 3] {
        let number = u32::from_str_radix(&self.light()[1..], 16).unwrap_or_default();
        [16, 8, 0].map(|shift| (number >> shift) as u8)
    }

    /// On a light page, as `#rrggbb`.
    pub fn light(self) -> &'static str {
        self.entry().2
    }
}

/// The figure's own style: the card's colour around letters, the colours of dark pages, and larger text on narrow screens.
pub fn style() -> String {
    let (_, _, light_card, dark_card) = Color::Card.entry();
    let mut dark = format!(".{CLASS} .picture{{{DARK_PICTURE}}}");
    for (_, name, _, color) in ALL {
        let _ =
            write!(dark, ".{CLASS}.f-{name},.{CLASS} .f-{name}{{fill:{color}}}.{CLASS} .s-{name}{{stroke:{color}}}");
    }
    format!(
        "<style>.{CLASS} text{{paint-order:stroke;stroke:{light_card};stroke-width:4px;stroke-linejoin:round}}\
         @media screen and (prefers-color-scheme:dark){{{dark}.{CLASS} text{{stroke:{dark_card}}}}}\
         @media (max-width:480px){{.{CLASS} text{{font-size:{LARGE_TEXT}px}}}}</style>"
    )
}

/// A colour of the scale of utilisations: 0 is the largest buff, 1 the largest draft.
pub fn ramp(share: f64) -> [u8; 3] {
    let at = share.clamp(0.0, 1.0) * (RAMP.len() - 1) as f64;
    let i = (at as usize).min(RAMP.len() - 2);
    let part = at - i as f64;
    std::array::from_fn(|c| (f64::from(RAMP[i][c]) * (1.0 - part) + f64::from(RAMP[i + 1][c]) * part).round() as u8)
}

/// What [`DARK_PICTURE`] makes of a colour.
fn on_dark(color: [u8; 3]) -> [u8; 3] {
    let [r, g, b] = color.map(|c| 0.88 * 255.0 - 0.76 * f64::from(c));
    let turned =
        [-0.574 * r + 1.43 * g + 0.144 * b, 0.426 * r + 0.43 * g + 0.144 * b, 0.426 * r + 1.43 * g - 0.856 * b];
    turned.map(|c| c.round().clamp(0.0, 255.0) as u8)
}

/// The colours as variables of a page's style sheet (`--draft` and so on), light and dark. `--ramp` lists the scale of
/// utilisations.
pub fn css() -> String {
    let shared = [Color::Draft, Color::Buff, Color::Over, Color::Rod, Color::Slack];
    let list = |dark: bool| {
        let one = |c: &Color| format!(" --{}: {};", c.name(), if dark { c.entry().3 } else { c.light() });
        let ramp = RAMP.map(|c| {
            let [r, g, b] = if dark { on_dark(c) } else { c };
            format!("#{r:02x}{g:02x}{b:02x}")
        });
        format!("{} --ramp: {};", shared.iter().map(one).collect::<String>(), ramp.join(" "))
    };
    format!(
        ":root {{{} }}\n@media screen and (prefers-color-scheme: dark) {{ :root {{{} }} }}\n",
        list(false),
        list(true)
    )
}

#[cfg(test)]
mod tests;
