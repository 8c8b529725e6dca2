//! Numbers as an engineer writes them: three or four significant digits and a unit, never more than the error allows.

use crate::units::UnitSystem;

/// A unit of force, chosen by size.
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

/// By definition: N, kg and m.
const LBF: f64 = 4.448_221_615_260_5;
const LB: f64 = 0.453_592_37;
const INCH: f64 = 0.0254;

const TIME: [Unit; 3] = [unit("µs", 1e-6), unit("ms", 1e-3), unit("s", 1.0)];

/// Units of forces, from the smallest.
fn forces(system: UnitSystem) -> &'static [Unit] {
    match system {
        UnitSystem::Si => const { &[unit("N", 1.0), unit("kN", 1e3), unit("MN", 1e6)] },
        UnitSystem::Us => const { &[unit("lbf", LBF), unit("kip", 1e3 * LBF)] },
    }
}

fn masses(system: UnitSystem) -> &'static [Unit] {
    match system {
        UnitSystem::Si => const { &[unit("kg", 1.0), unit("t", 1e3)] },
        UnitSystem::Us => const { &[unit("lb", LB), unit("US tons", 2000.0 * LB)] },
    }
}

fn stiffnesses(system: UnitSystem) -> &'static [Unit] {
    match system {
        UnitSystem::Si => const { &[unit("N/m", 1.0), unit("kN/m", 1e3), unit("MN/m", 1e6)] },
        UnitSystem::Us => const { &[unit("lbf/in", LBF / INCH), unit("kip/in", 1e3 * LBF / INCH)] },
    }
}

fn dampings(system: UnitSystem) -> &'static [Unit] {
    match system {
        UnitSystem::Si => const { &[unit("N\u{b7}s/m", 1.0), unit("kN\u{b7}s/m", 1e3), unit("MN\u{b7}s/m", 1e6)] },
        UnitSystem::Us => const { &[unit("lbf\u{b7}s/in", LBF / INCH), unit("kip\u{b7}s/in", 1e3 * LBF / INCH)] },
    }
}

/// The largest unit that the value reaches, or the smallest there is.
fn unit_for(units: &[Unit], value: f64) -> Unit {
    units.iter().rev().find(|u| value.abs() >= u.size).copied().unwrap_or(units[0])
}

/// The unit in which a largest force is at least 1.
pub fn force_unit(system: UnitSystem, largest_n: f64) -> Unit {
    unit_for(forces(system), largest_n)
}

/// The unit in which a time axis of this length reads well.
pub fn time_unit(longest_s: f64) -> Unit {
    unit_for(&TIME, longest_s)
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
    let unit = forces(system)[0];
    format!("{} {}", digits(value_n / unit.size, 0.0, 2), unit.name)
}

/// A time with unit.
pub fn time(value_s: f64) -> String {
    let unit = unit_for(&TIME, value_s);
    let unit = if value_s == 0.0 { TIME[2] } else { unit };
    format!("{} {}", digits(value_s / unit.size, 0.0, 4), unit.name)
}

/// A force that was given, not computed, without its sign: up to six digits, no trailing zeros.
pub fn given_force(system: UnitSystem, value_n: f64) -> String {
    given(forces(system), value_n.abs())
}

/// The same in a unit that others beside it have.
pub fn given_force_in(unit: Unit, value_n: f64) -> String {
    given(&[unit], value_n.abs())
}

/// A stiffness that was given.
pub fn given_stiffness(system: UnitSystem, value_n_per_m: f64) -> String {
    given(stiffnesses(system), value_n_per_m)
}

/// A dashpot that was given.
pub fn given_damping(system: UnitSystem, value_n_s_per_m: f64) -> String {
    given(dampings(system), value_n_s_per_m)
}

/// A length that was given.
pub fn given_length(system: UnitSystem, value_m: f64) -> String {
    given(&[if system == UnitSystem::Us { unit("ft", 12.0 * INCH) } else { unit("m", 1.0) }], value_m)
}

/// The unit of gaps and travels of couplers.
pub fn gap_unit(system: UnitSystem) -> Unit {
    if system == UnitSystem::Us { unit("in", INCH) } else { unit("mm", 1e-3) }
}

/// A gap between couplers that was given.
pub fn given_gap(system: UnitSystem, value_m: f64) -> String {
    given(&[gap_unit(system)], value_m)
}

/// A speed of a vehicle that was given.
pub fn given_speed(system: UnitSystem, value_m_per_s: f64) -> String {
    given(
        &[if system == UnitSystem::Us { unit("mph", 63_360.0 * INCH / 3600.0) } else { unit("m/s", 1.0) }],
        value_m_per_s,
    )
}

/// A length or a speed of waves in m or m/s as a number of m or ft.
pub fn metres(system: UnitSystem, value: f64) -> (f64, &'static str) {
    if system == UnitSystem::Us { (value / (12.0 * INCH), "ft") } else { (value, "m") }
}

/// A time that was given.
pub fn given_time(value_s: f64) -> String {
    given(&TIME, value_s)
}

/// A mass that was given.
pub fn given_mass(system: UnitSystem, value_kg: f64) -> String {
    given(masses(system), value_kg)
}

/// A time of four digits without trailing zeros.
pub fn brief_time(value_s: f64) -> String {
    let text = time(value_s);
    text.split_once(' ').map_or_else(|| text.clone(), |(number, unit)| format!("{} {unit}", without_zeros(number)))
}

fn given(units: &[Unit], value: f64) -> String {
    let unit = unit_for(units, value);
    format!("{} {}", without_zeros(&digits(value / unit.size, 0.0, 6)), unit.name)
}

/// A number without the zeros that end its fraction.
pub fn without_zeros(number: &str) -> String {
    let (mantissa, power) = number.split_once('e').map_or((number, None), |(m, p)| (m, Some(p)));
    let mantissa = if mantissa.contains('.') { mantissa.trim_end_matches('0').trim_end_matches('.') } else { mantissa };
    power.map_or_else(|| mantissa.to_owned(), |p| format!("{mantissa}e{p}"))
}

/// A share as a percentage of three digits, and as many more as it takes to keep it on its side of 100 %.
pub fn percent(share: f64) -> String {
    let value = 100.0 * share;
    let is_100 = |text: &String| text.parse() == Ok(100.0);
    let shown = (3..18).map(|most| digits(value, 0.0, most)).find(|text| value == 100.0 || !is_100(text));
    shown.unwrap_or_else(|| format!("{value:?}"))
}

/// A number that a user may rely on as a bound from below: rounded down to three digits.
pub fn down(value: f64) -> String {
    if value <= 0.0 || !value.is_finite() {
        return digits(value, 0.0, 3);
    }
    let step = 10f64.powi(2 - value.log10().floor().clamp(-300.0, 2.0) as i32);
    // A number of three digits keeps them all, though its double lies a little under it.
    digits((value * step * (1.0 + 1e-12)).floor() / step, 0.0, 3)
}

/// The interval `value` +- `error`, with as many digits as tell its ends apart.
pub fn interval(value: f64, error: f64) -> [String; 2] {
    let places = if error > 0.0 { (1.0 - error.log10().floor()).clamp(0.0, 20.0) as usize } else { 20 };
    [value - error, value + error].map(|end| without_zeros(&format!("{end:.places$}")))
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

#[cfg(test)]
mod tests {
    use super::*;

    const SI: UnitSystem = UnitSystem::Si;
    const US: UnitSystem = UnitSystem::Us;

    #[test]
    fn forces_take_the_unit_of_their_size() {
        assert_eq!(force(SI, -1.47279e6, 1e-6), "1.473 MN");
        assert_eq!(force(SI, 881_234.0, 1e-6), "881.2 kN");
        assert_eq!(force(SI, 1.4727934, 1e-12), "1.473 N");
        assert_eq!(force(SI, 0.0, 1e-12), "0 N");
        assert_eq!(force(SI, 1e300, 1e280), "1.000e294 MN");
    }

    #[test]
    fn given_numbers_have_no_trailing_zeros() {
        assert_eq!(given_force(SI, -600e3), "600 kN");
        assert_eq!(given_force(SI, 1.5e6), "1.5 MN");
        assert_eq!(given_time(0.06), "60 ms");
        assert_eq!(given_mass(SI, 16.8e6), "16800 t");
        assert_eq!(given_mass(SI, 1e300), "1e297 t");
    }

    #[test]
    fn a_reader_of_us_units_gets_them() {
        assert_eq!(force(US, -1.47279e6, 1e-6), "331.1 kip");
        assert_eq!(force(US, 2000.0, 1e-6), "449.6 lbf");
        assert_eq!(given_mass(US, 286_000.0 * LB), "143 US tons");
        assert_eq!(given_stiffness(US, 16.9173e6), "96.6003 kip/in");
        assert_eq!(given_length(US, 16.1544), "53 ft");
        assert_eq!(given_speed(US, 2.68224), "6 mph");
    }

    #[test]
    fn no_digit_is_finer_than_the_error() {
        assert_eq!(force(SI, 1.47279e6, 4e3), "1.47 MN");
        assert_eq!(force(SI, 1.47279e6, 6e3), "1.5 MN");
        assert_eq!(force(SI, 1.47279e6, 1e9), "1 MN");
    }

    #[test]
    fn a_percentage_stays_on_its_side_of_100() {
        assert_eq!(percent(0.88123), "88.1");
        assert_eq!(percent(1.0), "100");
        assert_eq!(percent(0.999_999_9), "99.99999");
        assert_eq!(percent(1.000_01), "100.001");
        assert_eq!(percent(1.4728), "147");
    }

    #[test]
    fn a_bound_from_below_is_rounded_down() {
        assert_eq!(down(61.99), "61.9");
        assert_eq!(down(100.0 * 0.67899), "67.8");
        assert_eq!(down(100.0 * 0.61), "61.0");
        assert_eq!(down(2.7579), "2.75");
        assert_eq!(down(135.99), "135");
        assert_eq!(down(0.0), "0");
    }

    #[test]
    fn the_ends_of_an_interval_differ() {
        assert_eq!(interval(884_750.0, 90e3), ["794750", "974750"]);
        assert_eq!(interval(1.0, 2e-7), ["0.9999998", "1.0000002"]);
    }
}
