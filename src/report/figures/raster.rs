//! A field of utilisations as an image: colours, outlines of what is over its rating, PNG.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use crate::figures::{Color, ramp};
use crate::findings::{Field, larger};

/// Steps of colour in each sense.
const STEPS: usize = 60;
/// Indices of the palette beyond the colours: where there is no coupler, the outline, and open couplers.
const NONE: u8 = 2 * STEPS as u8 + 1;
const OUTLINE: u8 = NONE + 1;
const OPEN: u8 = OUTLINE + 1;
/// No image has more pixels to a side, and no file is larger (before it is written in base64).
const WIDE: usize = 1000;
const TALL: usize = 300;
const LARGEST: usize = 100_000;

/// The whole scale from the largest buff to the largest draft.
pub fn scale() -> Vec<[u8; 3]> {
    (0..=2 * STEPS).map(|step| ramp(step as f64 / (2 * STEPS) as f64)).collect()
}

fn palette() -> Vec<u8> {
    scale().into_iter().chain([[200, 200, 200], [0, 0, 0], Color::Slack.rgb()]).flatten().collect()
}

/// The field as a PNG, head on top, in base64; `most` is the utilisation of the strongest colour.
///
/// A pixel that stands for several couplers or instants has the utilisation of largest magnitude among them, never a mean. The
/// outline lies just outside of what is over its rating.
pub fn png_base64(field: &Field, most: f64) -> String {
    let rows = field.rows();
    let mut size = (field.times_s.len().clamp(WIDE / 2, WIDE), TALL.min(rows * (TALL / rows).clamp(1, 24)));
    loop {
        let image = encode(&pixels(field, most, size), size);
        if image.len() <= LARGEST || size.0 < 100 {
            return STANDARD.encode(image);
        }
        size = (size.0 * 4 / 5, size.1 * 4 / 5);
    }
}

/// Indices into the palette, by rows from the head.
fn pixels(field: &Field, most: f64, (width, height): (usize, usize)) -> Vec<u8> {
    let (rows, columns) = (field.rows(), field.times_s.len());
    // The cells that a pixel covers; at least one, and no more where there are fewer of them than pixels.
    let cells = |pixel: usize, pixels: usize, cells: usize| {
        let from = pixel * cells / pixels;
        from..if cells <= pixels { from + 1 } else { ((pixel + 1) * cells).div_ceil(pixels) }
    };
    let mut share = vec![f32::NAN; width * height];
    for y in 0..height {
        for row in cells(y, height, rows) {
            let row = field.row(row);
            for x in 0..width {
                for &value in &row[cells(x, width, columns)] {
                    let kept = &mut share[y * width + x];
                    *kept = larger(*kept, value);
                }
            }
        }
    }
    let over = |x: usize, y: usize| share[y * width + x].abs() > 1.0;
    let beside_over = |x: usize, y: usize| {
        (x > 0 && over(x - 1, y))
            || (x + 1 < width && over(x + 1, y))
            || (y > 0 && over(x, y - 1))
            || (y + 1 < height && over(x, y + 1))
    };
    let index = |i: usize| {
        let (x, y) = (i % width, i / width);
        match share[i] {
            s if !over(x, y) && beside_over(x, y) && !s.is_nan() => OUTLINE,
            s if s.is_nan() => NONE,
            s if field.is_open(cells(y, height, rows), s) => OPEN,
            s => (STEPS as f64 * (1.0 + (f64::from(s) / most).clamp(-1.0, 1.0))).round() as u8,
        }
    };
    (0..width * height).map(index).collect()
}

fn encode(pixels: &[u8], (width, height): (usize, usize)) -> Vec<u8> {
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, width as u32, height as u32);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_palette(palette());
    encoder.set_filter(png::Filter::NoFilter);
    encoder.set_compression(png::Compression::Balanced);
    let written = encoder.write_header().and_then(|mut w| w.write_image_data(pixels));
    // Writing to memory does not fail, and the size is that of the pixels.
    written.map_or_else(|_| Vec::new(), |()| out)
}
