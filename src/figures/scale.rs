//! From values to pixels, and the round values that an axis is marked with.

/// From values to pixels, linear or logarithmic.
#[derive(Clone, Copy, Debug)]
pub struct Scale {
    range: (f64, f64),
    pixels: (f64, f64),
    log: bool,
}

impl Scale {
    /// The ends of the range lie at the ends of the pixels; both may run downward.
    pub fn new(range: (f64, f64), pixels: (f64, f64), log: bool) -> Scale {
        let range = if log { (range.0.log10(), range.1.log10()) } else { range };
        Scale { range, pixels, log }
    }

    /// Where a value lies; one far outside of the axis is kept near the figure.
    pub fn at(self, value: f64) -> f64 {
        let value = if self.log { value.log10() } else { value };
        // Halves, so that the width of no range overflows.
        let share = (0.5 * value - 0.5 * self.range.0) / (0.5 * self.range.1 - 0.5 * self.range.0);
        self.pixels.0 + share.clamp(-2.0, 3.0) * (self.pixels.1 - self.pixels.0)
    }
}

/// Values of 1, 2 or 5 times a power of ten within a range, at most about so many, each with its label.
pub fn ticks(range: (f64, f64), most: usize, whole: bool) -> Vec<(f64, String)> {
    let (low, high) = (range.0.min(range.1), range.0.max(range.1));
    let rough = high / most as f64 - low / most as f64;
    if !rough.is_finite() || rough <= 0.0 {
        return Vec::new();
    }
    let power = 10f64.powi(rough.log10().floor() as i32);
    let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|s| *s >= rough).unwrap_or(rough);
    let step = if whole { step.max(1.0) } else { step };
    let (from, to) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
    // A range far from zero and narrower than its numbers' last digits has no ticks.
    if !step.is_normal() || to - from > 4.0 * most as f64 {
        return Vec::new();
    }
    let at = |i: i32| (from + f64::from(i)) * step;
    (0..=(to - from) as i32).map(|i| (at(i), label(at(i), step))).collect()
}

/// A value in as many digits as its axis' step has; with a true minus sign.
fn label(value: f64, step: f64) -> String {
    let step_power = (step * 1.000_001).log10().floor() as i32;
    let text = if value == 0.0 {
        "0".to_owned()
    } else if (-4..6).contains(&step_power) && value.abs() < 1e7 {
        format!("{value:.*}", (-step_power).max(0) as usize)
    } else {
        let power = value.abs().log10().floor() as i32;
        format!("{value:.*e}", (power - step_power).clamp(0, 15) as usize)
    };
    text.replace('-', "\u{2212}")
}

/// Ticks of a logarithmic axis: powers of ten, no more than about `most`; over less than two decades 2 and 5 times those too.
pub fn log_ticks(range: (f64, f64), most: usize) -> Vec<(f64, String)> {
    let decades = (range.1 / range.0).log10();
    if !decades.is_finite() || decades <= 0.0 {
        return Vec::new();
    }
    let stride = (decades / most as f64).ceil().max(1.0) as i32;
    let (first, last) = (range.0.log10().floor() as i32, range.1.log10().ceil() as i32);
    let between: &[f64] = if decades < 2.2 { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let powers = (first..=last).filter(|p| p.rem_euclid(stride) == 0);
    let values = powers.flat_map(|p| between.iter().map(move |m| m * 10f64.powi(p)));
    let within = |v: &f64| (range.0 * (1.0 - 1e-9)..=range.1 * (1.0 + 1e-9)).contains(v);
    let values: Vec<f64> = values.filter(within).collect();
    // All as numbers, or all as powers of ten.
    let plain = values.iter().all(|v| (1e-3..1e5).contains(v));
    let name = |v: f64| if plain { label(v, 10f64.powf(v.log10().floor())) } else { power_of_ten(v) };
    values.into_iter().map(|v| (v, name(v))).collect()
}

/// 10 raised to the nearest power, as it is written by hand.
fn power_of_ten(value: f64) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let exponent = value.log10().round() as i32;
    if exponent == 0 {
        return "1".to_owned();
    }
    let digits = exponent.unsigned_abs().to_string();
    let raised: String = digits.bytes().map(|d| DIGITS[usize::from(d - b'0')]).collect();
    format!("10{}{raised}", if exponent < 0 { "⁻" } else { "" })
}

#[cfg(test)]
mod tests;
