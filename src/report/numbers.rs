//! Numbers as an engineer writes them: three or four significant digits and a unit, never more than the error allows.

/// A unit of force, chosen by size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// What it is called.
    pub name: &'static str,
    /// How many SI units it is.
    pub size: f64,
}

const FORCE: [Unit; 3] =
    [Unit { name: "N", size: 1.0 }, Unit { name: "kN", size: 1e3 }, Unit { name: "MN", size: 1e6 }];
const TIME: [Unit; 3] =
    [Unit { name: "µs", size: 1e-6 }, Unit { name: "ms", size: 1e-3 }, Unit { name: "s", size: 1.0 }];
const MASS: [Unit; 2] = [Unit { name: "kg", size: 1.0 }, Unit { name: "t", size: 1e3 }];

/// The largest unit that the value reaches, or the smallest there is.
fn unit_for(units: &[Unit], value: f64) -> Unit {
    units.iter().rev().find(|u| value.abs() >= u.size).copied().unwrap_or(units[0])
}

/// The unit in which a largest force is at least 1.
pub fn force_unit(largest_n: f64) -> Unit {
    unit_for(&FORCE, largest_n)
}

/// The unit in which a time axis of this length reads well.
pub fn time_unit(longest_s: f64) -> Unit {
    unit_for(&TIME, longest_s)
}

/// A force without its sign, with unit; no more digits than `error_n` allows.
pub fn force(value_n: f64, error_n: f64) -> String {
    let unit = force_unit(value_n);
    format!("{} {}", digits(value_n.abs() / unit.size, error_n / unit.size, 4), unit.name)
}

/// A time with unit.
pub fn time(value_s: f64) -> String {
    let unit = unit_for(&TIME, value_s);
    let unit = if value_s == 0.0 { TIME[2] } else { unit };
    format!("{} {}", digits(value_s / unit.size, 0.0, 4), unit.name)
}

/// A force that was given, not computed, without its sign: up to six digits, no trailing zeros.
pub fn given_force(value_n: f64) -> String {
    given(&FORCE, value_n.abs())
}

/// A time that was given.
pub fn given_time(value_s: f64) -> String {
    given(&TIME, value_s)
}

/// A mass that was given.
pub fn given_mass(value_kg: f64) -> String {
    given(&MASS, value_kg)
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

    #[test]
    fn forces_take_the_unit_of_their_size() {
        assert_eq!(force(-1.47279e6, 1e-6), "1.473 MN");
        assert_eq!(force(881_234.0, 1e-6), "881.2 kN");
        assert_eq!(force(1.4727934, 1e-12), "1.473 N");
        assert_eq!(force(0.0, 1e-12), "0 N");
        assert_eq!(force(1e300, 1e280), "1.000e294 MN");
    }

    #[test]
    fn given_numbers_have_no_trailing_zeros() {
        assert_eq!(given_force(-600e3), "600 kN");
        assert_eq!(given_force(1.5e6), "1.5 MN");
        assert_eq!(given_time(0.06), "60 ms");
        assert_eq!(given_mass(16.8e6), "16800 t");
        assert_eq!(given_mass(1e300), "1e297 t");
    }

    #[test]
    fn no_digit_is_finer_than_the_error() {
        assert_eq!(force(1.47279e6, 4e3), "1.47 MN");
        assert_eq!(force(1.47279e6, 6e3), "1.5 MN");
        assert_eq!(force(1.47279e6, 1e9), "1 MN");
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
