//! Quantities as people write them (`"30 MN/m"`) into SI.
//!
//! Metric units only move the decimal point, and that is done in the text, before the one rounding to a double: `"0.6 MN"`
//! and `"600 kN"` are the same double. The others have exact integer factors (1 lb = 45 359 237e-8 kg,
//! 1 lbf = 44 482 216 152 605e-13 N, 1 in = 254e-4 m, all by definition) and cost one rounding more, per inch two.

use std::fmt;

/// Smallest magnitude that is taken, in SI units.
///
/// Between this and [`LARGEST`] the square of any frequency squared, `(k/m)^2`, is a normal double, whatever masses and
/// stiffnesses meet in one train, and so is every ratio of forces.
pub const SMALLEST: f64 = 1e-30;
/// Largest magnitude that is taken, in SI units; see [`SMALLEST`].
pub const LARGEST: f64 = 1e30;

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
}

/// A quantity as read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amount {
    /// A value in SI units.
    Si(f64),
    /// A share of something else; 1 is all of it.
    Share(f64),
}

/// A text that is no quantity of the wanted kind: what it is, and what would be right.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BadQuantity {
    /// Completes a sentence that starts with the quantity's name: `has no unit`.
    pub found: String,
    /// What would be right.
    pub right: String,
}

/// `value in SI = number * 10^exponent * factor / divisor`.
struct Unit {
    symbol: &'static str,
    exponent: i32,
    factor: f64,
    divisor: f64,
}

const fn metric(symbol: &'static str, exponent: i32) -> Unit {
    Unit { symbol, exponent, factor: 1.0, divisor: 1.0 }
}

const fn divided(symbol: &'static str, factor: f64, exponent: i32, divisor: f64) -> Unit {
    Unit { symbol, exponent, factor, divisor }
}

const fn exact(symbol: &'static str, factor: f64, exponent: i32) -> Unit {
    Unit { symbol, exponent, factor, divisor: 1.0 }
}

const POUND: f64 = 45_359_237.0;
const POUND_FORCE: f64 = 44_482_216_152_605.0;

const MASSES: &[Unit] = &[
    metric("kg", 0),
    metric("t", 3),
    exact("lb", POUND, -8),
    exact("klb", POUND, -5),
    exact("ton_us", 2.0 * POUND, -5),
];
const FORCES: &[Unit] =
    &[metric("N", 0), metric("kN", 3), metric("MN", 6), exact("lbf", POUND_FORCE, -13), exact("kip", POUND_FORCE, -10)];
const STIFFNESSES: &[Unit] = &[
    metric("N/m", 0),
    metric("kN/m", 3),
    metric("MN/m", 6),
    metric("kN/mm", 6),
    divided("lbf/in", POUND_FORCE, -9, 254.0),
    divided("kip/in", POUND_FORCE, -6, 254.0),
];
const TIMES: &[Unit] = &[metric("s", 0), metric("ms", -3), exact("min", 60.0, 0)];
const LENGTHS: &[Unit] = &[metric("m", 0), metric("mm", -3), exact("ft", 3048.0, -4), exact("in", 254.0, -4)];
const SPEEDS: &[Unit] = &[metric("m/s", 0), divided("km/h", 5.0, 0, 18.0), exact("mph", 44_704.0, -5)];
const DAMPINGS: &[Unit] = &[
    metric("N*s/m", 0),
    metric("kN*s/m", 3),
    metric("MN*s/m", 6),
    divided("lbf*s/in", POUND_FORCE, -9, 254.0),
    divided("kip*s/in", POUND_FORCE, -6, 254.0),
];
const RESISTANCES: &[Unit] =
    &[metric("N/kg", 0), metric("N/t", -3), metric("kN/t", 0), divided("lbf/ton_us", POUND_FORCE, -8, 2.0 * POUND)];
const GRADES: &[Unit] = &[metric("%", -2), metric("\u{2030}", -3)];

impl Dimension {
    /// All of them.
    pub const ALL: [Dimension; 9] = [
        Dimension::Mass,
        Dimension::Force,
        Dimension::Stiffness,
        Dimension::Time,
        Dimension::Length,
        Dimension::Speed,
        Dimension::Damping,
        Dimension::Resistance,
        Dimension::Grade,
    ];

    fn table(self) -> &'static [Unit] {
        match self {
            Dimension::Mass => MASSES,
            Dimension::Force => FORCES,
            Dimension::Stiffness => STIFFNESSES,
            Dimension::Time => TIMES,
            Dimension::Length => LENGTHS,
            Dimension::Speed => SPEEDS,
            Dimension::Damping => DAMPINGS,
            Dimension::Resistance => RESISTANCES,
            Dimension::Grade => GRADES,
        }
    }

    /// The units it may have, as they are written.
    pub fn units(self) -> impl Iterator<Item = &'static str> {
        self.table().iter().map(|u| u.symbol)
    }

    /// The SI unit, in which it is reported.
    pub fn si(self) -> &'static str {
        self.table()[0].symbol
    }

    /// How much of SI's own that is: a hundredth for a grade, in which per cent are reported, else 1.
    pub fn si_size(self) -> f64 {
        if self == Dimension::Grade { 0.01 } else { 1.0 }
    }

    /// The units it may have, as a phrase: `kg, t, lb, klb or ton_us`.
    pub fn choices(self) -> String {
        one_of(self.units())
    }
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

/// A value in SI units as an engineer writes it: in the metric unit that fits its size, to five digits.
pub fn shown(value: f64, dimension: Dimension) -> String {
    let metric = dimension.table().iter().filter(|u| u.factor == 1.0 && u.divisor == 1.0);
    let scaled = metric.map(|u| (u.symbol, value / f64::powi(10.0, u.exponent)));
    // The first unit is SI's own; of those in which the number is at least 1, the one with the smallest number reads best.
    let best = scaled.reduce(|best, next| {
        let (a, b) = (best.1.abs(), next.1.abs());
        if b >= 1.0 && (a < 1.0 || b < a) { next } else { best }
    });
    let (symbol, number) = best.unwrap_or((dimension.si(), value));
    let rounded: f64 = format!("{number:.4e}").parse().unwrap_or(number);
    let plain = rounded == 0.0 || (1e-4..1e7).contains(&rounded.abs());
    if plain { format!("{rounded} {symbol}") } else { format!("{rounded:e} {symbol}") }
}

/// Reads a number with its unit; with `share`, also a percentage.
///
/// Whitespace between number and unit is free. The magnitude is 0 or between [`SMALLEST`] and [`LARGEST`].
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
    if unit == "%" && dimension != Dimension::Grade {
        if !share {
            return Err(bad("is a share, but of what?", with_units(number, dimension, share)));
        }
        return in_range(mantissa, shifted(mantissa, exponent - 2), "100 %").map(Amount::Share);
    }
    let Some(known) = dimension.table().iter().find(|u| u.symbol == unit) else {
        return Err(wrong_unit(number, unit, dimension, share));
    };
    let value = shifted(mantissa, exponent.saturating_add(known.exponent.into())) * known.factor / known.divisor;
    in_range(mantissa, value, dimension.si()).map(Amount::Si)
}

fn bad(found: impl Into<String>, right: impl Into<String>) -> BadQuantity {
    BadQuantity { found: found.into(), right: right.into() }
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
    // An exponent too long for an integer is out of range on the side of its sign, as these are.
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

/// The number with each unit that it could have.
fn with_units(number: &str, dimension: Dimension, share: bool) -> String {
    let units = dimension.units().chain(share.then_some("%"));
    format!("write {}", one_of(units.map(|unit| format!("\"{number} {unit}\""))))
}

/// The units that a quantity may have, as a phrase.
fn right_units(dimension: Dimension, share: bool) -> String {
    format!("a {dimension} is in {}{}", dimension.choices(), if share { ", or a share in %" } else { "" })
}

fn wrong_unit(number: &str, unit: &str, dimension: Dimension, share: bool) -> BadQuantity {
    let shown = crate::error::quoted(unit);
    let rest_of_number = |c: char| c.is_ascii_digit() || matches!(c, ',' | '.' | '_' | '\'');
    if unit.starts_with(rest_of_number) {
        return bad(
            "is not one number",
            format!("write it with a point for decimals and no other separators: {}", right_units(dimension, share)),
        );
    }
    let compact: String = unit.split_whitespace().collect();
    if let Some(near) = dimension.units().find(|u| u.eq_ignore_ascii_case(&compact)) {
        return bad(format!("has the unknown unit {shown}"), format!("did you mean \"{number} {near}\"?"));
    }
    let others = Dimension::ALL.into_iter().filter(|d| *d != dimension);
    for other in others {
        if other.units().any(|u| u == unit) {
            return bad(format!("has {shown}, a unit of {other}"), right_units(dimension, share));
        }
    }
    bad(format!("has the unknown unit {shown}"), right_units(dimension, share))
}

fn no_number(text: &str, dimension: Dimension) -> BadQuantity {
    let right = format!("expected a number and its unit: {}", dimension.choices());
    let word = text.trim_start_matches(['+', '-']).to_ascii_lowercase();
    if text.is_empty() {
        return bad("is empty", right);
    }
    if word.starts_with("nan") || word.starts_with("inf") {
        return bad("is not a finite number", right);
    }
    if text.starts_with(['\u{2212}', '\u{2013}', '\u{2014}']) {
        return bad("starts with a dash that is not a minus sign", "write a negative number with the hyphen \"-\"");
    }
    bad("does not start with a number", right)
}
