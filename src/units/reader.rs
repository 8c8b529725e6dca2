//! Quantities in the units of a report's reader.

use super::Dimension;

/// The units of a reader: of reports, `check` and doubts, not of the files for programs, which are in SI.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UnitSystem {
    /// kN, t, m, km/h.
    #[default]
    Si,
    /// kip, short tons, feet, mph.
    Us,
}

/// A unit with its size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// What it is called.
    pub name: &'static str,
    /// How many SI units it is.
    pub size: f64,
}

const fn unit(name: &'static str, size: f64) -> Unit {
    Unit { name, size }
}

/// By definition, in N, kg, m.
const LBF: f64 = 4.448_221_615_260_5;
const LB: f64 = 0.453_592_37;
const INCH: f64 = 0.0254;

/// Times, grades and shares have the same units in both systems.
const TIME: &[Unit] = &[unit("µs", 1e-6), unit("ms", 1e-3), unit("s", 1.0)];
const GRADE: &[Unit] = &[unit("\u{2030}", 1e-3), unit("%", 1e-2)];
const SHARE: &[Unit] = &[unit("%", 1e-2)];

impl UnitSystem {
    /// Their names in a train file and on the command line.
    pub const NAMES: [&str; 2] = ["si", "us"];

    /// The system of that name.
    pub fn from_name(name: &str) -> Option<UnitSystem> {
        [UnitSystem::Si, UnitSystem::Us].into_iter().zip(UnitSystem::NAMES).find(|(_, n)| *n == name).map(|(of, _)| of)
    }

    /// The units in which quantities of a kind are written, from the smallest. A speed is one of vehicles.
    pub fn units(self, dimension: Dimension) -> &'static [Unit] {
        match (self, dimension) {
            (_, Dimension::Time) => TIME,
            (_, Dimension::Grade) => GRADE,
            (_, Dimension::Share) => SHARE,
            (UnitSystem::Si, of) => metric(of),
            (UnitSystem::Us, of) => us(of),
        }
    }

    /// The unit of places along a train, and of what a wave covers in a second.
    pub fn long(self) -> Unit {
        if self == UnitSystem::Us { unit("ft", 12.0 * INCH) } else { unit("m", 1.0) }
    }

    /// A speed of waves.
    pub fn wave_speed(self, metres_per_s: f64) -> String {
        format!("{}/s", self.lengths(metres_per_s))
    }

    /// An acceleration.
    pub fn acceleration(self, metres_per_s2: f64) -> String {
        format!("{}/s\u{b2}", self.lengths(metres_per_s2))
    }

    fn lengths(self, metres: f64) -> String {
        written(&[self.long()], metres, 4)
    }

    /// An energy.
    pub fn energy(self, joules: f64) -> String {
        let units: &[Unit] = match self {
            UnitSystem::Si => const { &[unit("J", 1.0), unit("kJ", 1e3), unit("MJ", 1e6)] },
            UnitSystem::Us => const { &[unit("ft\u{b7}lbf", 12.0 * INCH * LBF)] },
        };
        written(units, joules, 4)
    }
}

fn metric(dimension: Dimension) -> &'static [Unit] {
    match dimension {
        Dimension::Mass => const { &[unit("kg", 1.0), unit("t", 1e3)] },
        Dimension::Force => const { &[unit("N", 1.0), unit("kN", 1e3), unit("MN", 1e6)] },
        Dimension::Stiffness => const { &[unit("N/m", 1.0), unit("kN/m", 1e3), unit("MN/m", 1e6)] },
        Dimension::Length => const { &[unit("mm", 1e-3), unit("m", 1.0)] },
        Dimension::Speed => const { &[unit("km/h", 1.0 / 3.6)] },
        Dimension::Damping => const { &[unit("N\u{b7}s/m", 1.0), unit("kN\u{b7}s/m", 1e3), unit("MN\u{b7}s/m", 1e6)] },
        Dimension::Resistance => const { &[unit("N/t", 1e-3), unit("N/kg", 1.0)] },
        Dimension::Time => TIME,
        Dimension::Grade => GRADE,
        Dimension::Share => SHARE,
    }
}

fn us(dimension: Dimension) -> &'static [Unit] {
    match dimension {
        Dimension::Mass => const { &[unit("lb", LB), unit("US tons", 2000.0 * LB)] },
        Dimension::Force => const { &[unit("lbf", LBF), unit("kip", 1e3 * LBF)] },
        Dimension::Stiffness => const { &[unit("lbf/in", LBF / INCH), unit("kip/in", 1e3 * LBF / INCH)] },
        Dimension::Length => const { &[unit("in", INCH), unit("ft", 12.0 * INCH)] },
        Dimension::Speed => const { &[unit("mph", 63_360.0 * INCH / 3600.0)] },
        Dimension::Damping => const { &[unit("lbf\u{b7}s/in", LBF / INCH), unit("kip\u{b7}s/in", 1e3 * LBF / INCH)] },
        Dimension::Resistance => const { &[unit("lbf/ton_us", LBF / (2000.0 * LB))] },
        same => metric(same),
    }
}

/// The largest unit that the value reaches, or else the smallest; for 0 the first of at least one SI unit.
pub fn unit_for(units: &[Unit], value: f64) -> Unit {
    let fits = |u: &&Unit| if value == 0.0 { u.size >= 1.0 } else { value.abs() >= u.size };
    let found = if value == 0.0 { units.iter().find(fits) } else { units.iter().rev().find(fits) };
    found.copied().unwrap_or(units[0])
}

/// A quantity that was given, from SI, as its reader writes it, without trailing zeros: up to six digits where they are all of it,
/// and four of one that was converted from another unit or computed.
///
/// ```
/// use trainsafe::units::{Dimension, UnitSystem, shown};
/// assert_eq!(shown(UnitSystem::Si, 1.5e6, Dimension::Force), "1.5 MN");
/// assert_eq!(shown(UnitSystem::Us, 129_727.4, Dimension::Mass), "143 US tons");
/// ```
pub fn shown(system: UnitSystem, value: f64, dimension: Dimension) -> String {
    shown_in(unit_for(system.units(dimension), value), value)
}

/// The same in a unit that others beside it have.
pub fn shown_in(unit: Unit, value: f64) -> String {
    let value = value / unit.size;
    let six = digits(value, 0.0, 6);
    let whole = six.parse().is_ok_and(|shown: f64| (shown - value).abs() <= 1e-9 * value.abs());
    format!("{} {}", without_zeros(&if whole { six } else { digits(value, 0.0, 4) }), unit.name)
}

/// The same of a time, which needs no system.
pub fn shown_time(value_s: f64) -> String {
    shown_in(unit_for(TIME, value_s), value_s)
}

/// The same, rounded up to four digits, of a time that is to suffice.
pub fn shown_time_up(value_s: f64) -> String {
    let unit = unit_for(TIME, value_s);
    format!("{} {}", without_zeros(&up(value_s / unit.size)), unit.name)
}

/// The same to three digits, of a limit that is a round number in SI.
pub fn rounded(system: UnitSystem, value: f64, dimension: Dimension) -> String {
    written(system.units(dimension), value, 3)
}

fn written(units: &[Unit], value: f64, most: i32) -> String {
    let unit = unit_for(units, value);
    format!("{} {}", without_zeros(&digits(value / unit.size, 0.0, most)), unit.name)
}

/// A number that has to be reached, rounded up to four digits.
pub fn up(value: f64) -> String {
    if value <= 0.0 || !value.is_finite() {
        return digits(value, 0.0, 4);
    }
    let step = 10f64.powi((3.0 - value.log10().floor()).clamp(0.0, 300.0) as i32);
    // A number of four digits keeps them, though its double lies a little over it.
    digits((value * step * (1.0 - 1e-12)).ceil() / step, 0.0, 4)
}

/// At most `most` significant digits, none finer than the error; whole digits are never rounded away.
///
/// Very large and very small numbers are written with a power of ten.
pub fn digits(value: f64, error: f64, most: i32) -> String {
    if !value.is_finite() {
        return "not finite".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let exponent = value.abs().log10().floor() as i32;
    let finest = if error > 0.0 { -(2.0 * error).log10().ceil() } else { f64::INFINITY };
    if !(-4..7).contains(&exponent) {
        let places = (finest + f64::from(exponent)).clamp(0.0, f64::from(most - 1));
        return format!("{value:.*e}", places as usize);
    }
    let places = finest.clamp(0.0, f64::from((most - 1 - exponent).max(0)));
    format!("{value:.*}", places as usize)
}

/// A number without the zeros that end its fraction.
pub fn without_zeros(number: &str) -> String {
    let (mantissa, power) = number.split_once('e').map_or((number, None), |(m, p)| (m, Some(p)));
    let mantissa = if mantissa.contains('.') { mantissa.trim_end_matches('0').trim_end_matches('.') } else { mantissa };
    power.map_or_else(|| mantissa.to_owned(), |p| format!("{mantissa}e{p}"))
}

#[cfg(test)]
mod tests;
