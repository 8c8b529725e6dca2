//! Numbers as an engineer writes them: three or four significant digits and a unit, never more than the error allows.

use crate::units::{Dimension, UnitSystem, shown, shown_in, unit_for};
pub use crate::units::{Unit, digits, up, without_zeros};

/// The unit in which a largest force is at least 1.
pub fn force_unit(system: UnitSystem, largest_n: f64) -> Unit {
    unit_for(system.units(Dimension::Force), largest_n)
}

/// The unit in which a time axis of this length reads well.
pub fn time_unit(longest_s: f64) -> Unit {
    unit_for(UnitSystem::Si.units(Dimension::Time), longest_s)
}

/// A force without its sign, with unit; no more digits than `error_n` allows.
pub fn force(system: UnitSystem, value_n: f64, error_n: f64) -> String {
    force_in(force_unit(system, value_n), value_n, error_n)
}

/// The same in a unit that others beside it have.
pub fn force_in(unit: Unit, value_n: f64, error_n: f64) -> String {
    format!("{} {}", digits(value_n.abs() / unit.size, error_n / unit.size, 4), unit.name)
}

/// A force as small as an error, to two digits.
pub fn small_force(system: UnitSystem, value_n: f64) -> String {
    let unit = system.units(Dimension::Force)[0];
    format!("{} {}", digits(value_n / unit.size, 0.0, 2), unit.name)
}

/// A time with unit.
pub fn time(value_s: f64) -> String {
    let unit = time_unit(value_s);
    format!("{} {}", digits(value_s / unit.size, 0.0, 4), unit.name)
}

/// A force that was given, not computed, without its sign and trailing zeros.
pub fn given_force(system: UnitSystem, value_n: f64) -> String {
    shown(system, value_n.abs(), Dimension::Force)
}

/// The same in a unit that others beside it have.
pub fn given_force_in(unit: Unit, value_n: f64) -> String {
    shown_in(unit, value_n.abs())
}

/// The unit of gaps and travels of couplers.
pub fn gap_unit(system: UnitSystem) -> Unit {
    system.units(Dimension::Length)[0]
}

/// A time of four digits without trailing zeros.
pub fn brief_time(value_s: f64) -> String {
    let text = time(value_s);
    text.split_once(' ').map_or_else(|| text.clone(), |(number, unit)| format!("{} {unit}", without_zeros(number)))
}

/// A share as a percentage of three digits, and more where it would else be rounded to 100 %.
pub fn percent(share: f64) -> String {
    let value = 100.0 * share;
    let is_100 = |text: &String| text.parse() == Ok(100.0);
    let shown = (3..18).map(|most| digits(value, 0.0, most)).find(|text| value == 100.0 || !is_100(text));
    shown.unwrap_or_else(|| format!("{value:?}"))
}

/// A number that a user may rely on as a bound from below: rounded down to three digits.
pub fn down(value: f64) -> String {
    down_to(value, 3)
}

/// The same to so many digits.
pub fn down_to(value: f64, most: i32) -> String {
    if value <= 0.0 || !value.is_finite() {
        return digits(value, 0.0, most);
    }
    let step = 10f64.powi((f64::from(most - 1) - value.log10().floor()).clamp(0.0, 300.0) as i32);
    // A number of that many digits keeps them all, though its double lies a little under it.
    digits((value * step * (1.0 + 1e-12)).floor() / step, 0.0, most)
}

/// The interval `value` +- `error`, with as many digits as tell its ends apart, rounded outward.
pub fn interval(value: f64, error: f64) -> [String; 2] {
    let places = if error > 0.0 { (1.0 - error.log10().floor()).clamp(0.0, 20.0) as usize } else { 20 };
    let step = 10f64.powi(places as i32);
    // A number of so many digits keeps them, though its double lies a little beside it.
    let beside = 1e-12 * (value.abs() + error) * step;
    let ends = [((value - error) * step + beside).floor(), ((value + error) * step - beside).ceil()];
    ends.map(|end| without_zeros(&format!("{:.places$}", end / step)))
}

#[cfg(test)]
mod tests;
