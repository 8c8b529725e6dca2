//! Reads quantities as people write them (`"30 MN/m"`).
//!
//! `spellings` has the units and how they may be written; `reader` writes quantities in the units of a report's reader. A text that means two units is refused, with the choices.
//!
//! Metric units only move the decimal point, and that is done in the text, before the one rounding to a double: `"0.6 MN"`
//! and `"600 kN"` are the same double. The others have exact integer factors (1 lb = 45 359 237e-8 kg,
//! 1 lbf = 44 482 216 152 605e-13 N, 1 in = 254e-4 m, all by definition) and cost one rounding more, per inch two.

mod reader;
mod refusal;
mod spellings;

use std::fmt;

pub use reader::{
    Unit, UnitSystem, digits, rounded, shown, shown_in, shown_time, shown_time_up, unit_for, up, without_zeros,
};

/// Standard gravity, m/s2 (CGPM 1901).
pub(crate) const GRAVITY_M_PER_S2: f64 = 9.806_65;

use refusal::{bad, no_number, right_units, with_units, wrong_unit};

/// Smallest magnitude that is taken, in SI units.
///
/// Between this and [`LARGEST`] the square of any frequency squared, `(k/m)^2`, is a normal double, whatever masses and
/// stiffnesses meet in one train, and so is every ratio of forces.
pub(crate) const SMALLEST: f64 = 1e-30;
/// Largest magnitude that is taken, in SI units; see [`SMALLEST`].
pub(crate) const LARGEST: f64 = 1e30;

/// What a quantity measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// kg
    Mass,
    /// N
    Force,
    /// N/m
    Stiffness,
    /// s
    Time,
    /// m
    Length,
    /// m/s
    Speed,
    /// N s/m
    Damping,
    /// N/kg: a force on a vehicle in proportion to its mass
    Resistance,
    /// Rise over run
    Grade,
    /// A share of something that the key names
    Share,
}

/// A quantity as read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amount {
    /// A value in SI units.
    Si(f64),
    /// A share of something else; 1 is all of it.
    Share(f64),
}

/// A text that is no quantity of the expected kind: what it is, and what would be right.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BadQuantity {
    /// Completes a sentence that starts with the quantity's name: `has no unit`.
    pub found: String,
    /// What would be right.
    pub right: String,
}

impl Dimension {
    /// All of them.
    pub const ALL: [Dimension; 10] = [
        Dimension::Mass,
        Dimension::Force,
        Dimension::Stiffness,
        Dimension::Time,
        Dimension::Length,
        Dimension::Speed,
        Dimension::Damping,
        Dimension::Resistance,
        Dimension::Grade,
        Dimension::Share,
    ];

    /// The units it may have, as they are written in messages; the reader takes more spellings and more units.
    pub fn units(self) -> impl Iterator<Item = &'static str> {
        self.listed().iter().copied()
    }

    /// The unit of [`Self::si`] first.
    fn listed(self) -> &'static [&'static str] {
        match self {
            Dimension::Mass => &["kg", "t", "lb", "klb", "ton_us"],
            Dimension::Force => &["N", "kN", "MN", "lbf", "kip"],
            Dimension::Stiffness => &["N/m", "kN/m", "MN/m", "kN/mm", "lbf/in", "kip/in"],
            Dimension::Time => &["s", "ms", "min"],
            Dimension::Length => &["m", "mm", "ft", "in"],
            Dimension::Speed => &["m/s", "km/h", "mph"],
            Dimension::Damping => &["N*s/m", "kN*s/m", "MN*s/m", "lbf*s/in", "kip*s/in"],
            Dimension::Resistance => &["N/kg", "N/t", "kN/t", "lbf/ton_us"],
            Dimension::Grade => &["%", "\u{2030}"],
            Dimension::Share => &["%"],
        }
    }

    /// A regular expression of all that may follow a number as its unit.
    pub(crate) fn pattern(self) -> String {
        spellings::pattern(self)
    }

    /// The SI unit, in which it is reported.
    pub fn si(self) -> &'static str {
        self.listed()[0]
    }

    /// The size of that unit: 0.01 for a grade or a share, which are reported in per cent, else 1.
    pub(crate) fn si_size(self) -> f64 {
        if self.is_in_per_cent() { 0.01 } else { 1.0 }
    }

    /// Whether its own unit is the per cent.
    pub(crate) fn is_in_per_cent(self) -> bool {
        matches!(self, Dimension::Grade | Dimension::Share)
    }

    /// The units it may have, as a phrase: `kg, t, lb, klb or ton_us`.
    pub fn choices(self) -> String {
        one_of(self.units())
    }
}

/// A regular expression of the per cent, which a share has as its unit.
pub(crate) fn per_cent_pattern() -> String {
    spellings::per_cent_pattern()
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Dimension::Mass => "mass",
            Dimension::Force => "force",
            Dimension::Stiffness => "stiffness",
            Dimension::Time => "time",
            Dimension::Length => "length",
            Dimension::Speed => "speed",
            Dimension::Damping => "damping",
            Dimension::Resistance => "resistance",
            Dimension::Grade => "grade",
            Dimension::Share => "share",
        })
    }
}

/// Words joined as a choice: `a, b or c`.
pub fn one_of<S: AsRef<str>>(words: impl IntoIterator<Item = S>) -> String {
    let words: Vec<S> = words.into_iter().collect();
    let mut text = String::new();
    for (i, word) in words.iter().enumerate() {
        let last = i + 1 == words.len();
        text.push_str(if i == 0 {
            ""
        } else if last {
            " or "
        } else {
            ", "
        });
        text.push_str(word.as_ref());
    }
    text
}

/// Reads a number with its unit; with `share`, also a percentage.
///
/// Whitespace between number and unit is free. The magnitude is 0 or between `SMALLEST` and `LARGEST`.
///
/// # Errors
/// What the text is instead, and what would be right.
///
/// ```
/// use trainsafe::units::{Amount, Dimension, parse};
/// assert_eq!(parse("0.6 MN", Dimension::Force, true), Ok(Amount::Si(6e5)));
/// assert_eq!(parse("60 %", Dimension::Force, true), Ok(Amount::Share(0.6)));
/// assert_eq!(parse("0.6 t", Dimension::Force, true).unwrap_err().found, "has \"t\", a unit of mass");
/// ```
pub fn parse(text: &str, dimension: Dimension, share: bool) -> Result<Amount, BadQuantity> {
    let text = text.trim();
    let (number, unit) = split(text);
    let Some((mantissa, exponent)) = decimal(number) else { return Err(no_number(text, dimension)) };
    if unit.is_empty() {
        return Err(bad("has no unit", with_units(number, dimension, share)));
    }
    if spellings::is_per_cent(unit) && !dimension.is_in_per_cent() {
        if !share {
            return Err(bad("is a percentage, which is not allowed here", right_units(dimension, share)));
        }
        return in_range(mantissa, shifted(mantissa, exponent - 2), "100 %").map(Amount::Share);
    }
    let Some(scale) = spellings::find(dimension, unit) else {
        return Err(wrong_unit(number, unit, dimension, share));
    };
    let value = shifted(mantissa, exponent.saturating_add(scale.exponent.into())) * scale.factor / scale.divisor;
    in_range(mantissa, value, dimension.si()).map(Amount::Si)
}

/// Whether a quantity that [`parse`] takes has a unit of US practice, such as kip or ft; `None` where units do not
/// show it.
pub(crate) fn is_us(text: &str, dimension: Dimension) -> Option<bool> {
    if !matches!(dimension, Dimension::Mass | Dimension::Force | Dimension::Stiffness | Dimension::Length) {
        return None;
    }
    spellings::find(dimension, split(text.trim()).1).map(|scale| !scale.is_decimal())
}

/// The longest start that looks like a number, and the rest without the whitespace between.
fn split(text: &str) -> (&str, &str) {
    let bytes = text.as_bytes();
    let run = |from: usize, ok: fn(&u8) -> bool| from + bytes[from..].iter().take_while(|b| ok(b)).count();
    let sign = usize::from(bytes.first().is_some_and(|b| matches!(b, b'+' | b'-')));
    let mut end = run(sign, |b| b.is_ascii_digit() || *b == b'.');
    if end > sign && bytes.get(end).is_some_and(|b| matches!(b, b'e' | b'E')) {
        let digits = end + 1 + usize::from(bytes.get(end + 1).is_some_and(|b| matches!(b, b'+' | b'-')));
        let exponent_end = if digits <= bytes.len() { run(digits, u8::is_ascii_digit) } else { digits };
        end = if exponent_end > digits { exponent_end } else { end };
    }
    (&text[..end], text[end..].trim_start())
}

/// Mantissa and exponent of a decimal number; `None` if it is none.
fn decimal(number: &str) -> Option<(&str, i64)> {
    number.parse::<f64>().ok()?;
    let Some((mantissa, exponent)) = number.split_once(['e', 'E']) else { return Some((number, 0)) };
    // An exponent too long for an integer is out of range, as these are.
    let beyond = if exponent.starts_with('-') { -1_000_000_000 } else { 1_000_000_000 };
    Some((mantissa, exponent.parse().unwrap_or(beyond)))
}

/// `mantissa * 10^exponent`, rounded once.
fn shifted(mantissa: &str, exponent: i64) -> f64 {
    format!("{mantissa}e{exponent}").parse().unwrap_or(f64::NAN)
}

fn in_range(mantissa: &str, value: f64, unit: &str) -> Result<f64, BadQuantity> {
    let zero = !mantissa.bytes().any(|b| matches!(b, b'1'..=b'9'));
    if zero || (SMALLEST..=LARGEST).contains(&value.abs()) {
        return Ok(value);
    }
    let found = if value.abs() < SMALLEST { "is too small to compute with" } else { "is too large to compute with" };
    Err(bad(found, format!("expected a magnitude from {SMALLEST:e} to {LARGEST:e} {unit}")))
}
