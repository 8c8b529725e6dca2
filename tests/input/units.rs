//! Quantities with units against values that owe nothing to the code.

use proptest::prelude::*;
use trainsafe::units::{Amount, Dimension, UnitSystem, parse, shown};

fn si(text: &str, dimension: Dimension) -> f64 {
    match parse(text, dimension, false) {
        Ok(Amount::Si(value)) => value,
        other => panic!("{text}: {other:?}"),
    }
}

/// What is found wrong, and what would be right.
fn refusal(text: &str, dimension: Dimension, share: bool) -> (String, String) {
    match parse(text, dimension, share) {
        Err(bad) => (bad.found, bad.right),
        Ok(amount) => panic!("{text}: {amount:?}"),
    }
}

/// One of every unit, in SI: the definitions of the international pound and inch and of standard gravity, multiplied out
/// in 40 decimal digits.
#[test]
fn one_of_every_unit() {
    let values = [
        ("1 kg", Dimension::Mass, 1.0),
        ("1 t", Dimension::Mass, 1000.0),
        ("1 lb", Dimension::Mass, 0.45359237),
        ("1 klb", Dimension::Mass, 453.59237),
        ("1 ton_us", Dimension::Mass, 907.18474),
        ("1 N", Dimension::Force, 1.0),
        ("1 kN", Dimension::Force, 1000.0),
        ("1 MN", Dimension::Force, 1e6),
        ("1 lbf", Dimension::Force, 4.4482216152605),
        ("1 kip", Dimension::Force, 4448.2216152605),
        ("1 N/m", Dimension::Stiffness, 1.0),
        ("1 kN/m", Dimension::Stiffness, 1000.0),
        ("1 MN/m", Dimension::Stiffness, 1e6),
        ("1 mph", Dimension::Speed, 0.44704),
        ("18 km/h", Dimension::Speed, 5.0),
        ("1 m/s", Dimension::Speed, 1.0),
        ("1 N*s/m", Dimension::Damping, 1.0),
        ("1 kN*s/m", Dimension::Damping, 1000.0),
        ("1 MN*s/m", Dimension::Damping, 1e6),
        ("1 lbf*s/in", Dimension::Damping, 175.126_835_246_476_4),
        ("1 kip*s/in", Dimension::Damping, 175_126.835_246_476_4),
        ("1 N/kg", Dimension::Resistance, 1.0),
        ("1 N/t", Dimension::Resistance, 1e-3),
        ("1 kN/t", Dimension::Resistance, 1.0),
        ("2000 lbf/ton_us", Dimension::Resistance, 9.80665),
        ("1 %", Dimension::Grade, 0.01),
        ("1 \u{2030}", Dimension::Grade, 0.001),
        ("1 %", Dimension::Share, 0.01),
        ("1 kN/mm", Dimension::Stiffness, 1e6),
        ("1 lbf/in", Dimension::Stiffness, 175.126_835_246_476_4),
        ("1 kip/in", Dimension::Stiffness, 175_126.835_246_476_37),
        ("1 s", Dimension::Time, 1.0),
        ("1 ms", Dimension::Time, 0.001),
        ("1 min", Dimension::Time, 60.0),
        ("1 m", Dimension::Length, 1.0),
        ("1 mm", Dimension::Length, 0.001),
        ("1 ft", Dimension::Length, 0.3048),
        ("1 in", Dimension::Length, 0.0254),
    ];
    for (text, dimension, expected) in values {
        // Three roundings at most: the shifted number, the factor, the inch. Each is half of the last digit.
        let apart = si(text, dimension).to_bits().abs_diff(f64::to_bits(expected));
        assert!(apart <= 1, "{text} is {:e}", si(text, dimension));
    }
    let tested = |d: Dimension| values.iter().filter(|v| v.1 == d).count();
    for d in Dimension::ALL {
        assert_eq!(tested(d), d.units().count(), "every unit of {d}");
    }
}

#[test]
fn metric_units_move_the_decimal_point() {
    // As products of doubles, 1.005 * 1e6 and 1.001 * 1e3 are 1004999.9999999999 and 1000.9999999999999.
    assert_eq!(si("1.005 MN", Dimension::Force), 1_005_000.0);
    assert_eq!(si("1.001 t", Dimension::Mass), 1001.0);
    assert_eq!(si("60 ms", Dimension::Time), 0.06);
    assert_eq!(parse("60 %", Dimension::Force, true), Ok(Amount::Share(0.6)));
}

#[test]
fn numbers_and_spaces_as_people_write_them() {
    for text in ["1200 N", "1200N", " 1200   N ", "+1200 N", "1.2e3 N", "1.2E+3N", "1200. N", "12000e-1 N", "1.2\tkN"] {
        assert_eq!(si(text, Dimension::Force), 1200.0, "{text}");
    }
    assert_eq!(si(".5 m", Dimension::Length), 0.5);
    assert_eq!(si("-0 N", Dimension::Force), 0.0);
    assert_eq!(parse("-40%", Dimension::Force, true), Ok(Amount::Share(-0.4)));
}

#[test]
fn what_is_no_quantity_is_told_what_it_is() {
    let found = |text: &str| refusal(text, Dimension::Mass, false).0;
    for text in ["", "  ", "+", "-", ".", "e5 kg", "1.2.3 kg", "..5 kg", "\u{2212}5 kg", "t", "NaN kg", "-inf kg"] {
        assert!(!found(text).is_empty(), "{text}");
    }
    assert_eq!(found("12"), "has no unit");
    assert_eq!(found("12 e"), "has the unknown unit \"e\"");
    assert_eq!(found("12e kg"), "has the unknown unit \"e kg\"");
    assert_eq!(found("infinity kg"), "is not a finite number");
    for text in ["1,5 kg", "1 500 kg", "1_500 kg", "1'500 kg", "1.500,0 kg"] {
        assert_eq!(found(text), "is not one number", "{text}");
    }
    let right = |text: &str, dimension| refusal(text, dimension, false).1;
    assert_eq!(right("30 KN / m", Dimension::Stiffness), "did you mean \"30 kN/m\"?");
    assert_eq!(right("3 T", Dimension::Mass), "did you mean \"3 t\"?");
    assert_eq!(refusal("3 MN/m", Dimension::Force, true).0, "has \"MN/m\", a unit of stiffness");
    assert_eq!(refusal("3 s", Dimension::Force, true).1, "a force is in N, kN, MN, lbf or kip, or a share in %");
}

#[test]
fn magnitudes_out_of_range_are_refused_and_zero_is_not() {
    let found = |text: &str| refusal(text, Dimension::Force, true).0;
    for text in ["1e-31 N", "5e-324 N", "1e-400 N", "-1e-99999999999999999999 MN", "0.99e-30 N", "1e-29 %"] {
        assert_eq!(found(text), "is too small to compute with", "{text}");
    }
    for text in ["1.01e30 N", "1e300 N", "1e400 N", "-1e25 MN", "1e99999999999999999999 N", "1e33 %"] {
        assert_eq!(found(text), "is too large to compute with", "{text}");
    }
    assert_eq!(si("1e-30 N", Dimension::Force), 1e-30);
    assert_eq!(si("-1e24 MN", Dimension::Force), -1e30);
    assert_eq!(si("0e999 N", Dimension::Force), 0.0);
}

#[test]
fn values_are_shown_as_an_engineer_writes_them() {
    let shown_as = [
        (160e3, Dimension::Mass, "160 t"),
        (1.0, Dimension::Mass, "1 kg"),
        (16_640e3, Dimension::Mass, "16640 t"),
        (999.9996, Dimension::Mass, "1000 kg"),
        (-900e3, Dimension::Force, "-900 kN"),
        (1.5e6, Dimension::Force, "1.5 MN"),
        (0.25, Dimension::Force, "0.25 N"),
        (0.0, Dimension::Force, "0 N"),
        (30e6, Dimension::Stiffness, "30 MN/m"),
        (0.06, Dimension::Time, "60 ms"),
        (0.0, Dimension::Time, "0 s"),
        (30.379_816, Dimension::Time, "30.38 s"),
        (10.9, Dimension::Length, "10.9 m"),
        (0.012, Dimension::Grade, "1.2 %"),
        (0.015, Dimension::Resistance, "15 N/t"),
        (2.682_24, Dimension::Speed, "9.656 km/h"),
        (5e5, Dimension::Damping, "500 kN\u{b7}s/m"),
        (1e30, Dimension::Force, "1e24 MN"),
        (1e-30, Dimension::Force, "1e-30 N"),
    ];
    for (value, dimension, expected) in shown_as {
        assert_eq!(shown(UnitSystem::Si, value, dimension), expected);
    }
}

proptest! {
    /// A whole number of pounds is a ratio of whole numbers, and dividing those rounds once.
    #[test]
    fn pounds_are_right_to_a_rounding(n in 1u64..190_000_000) {
        let exact = (n * 45_359_237) as f64 / 1e8;
        let read = si(&format!("{n} lb"), Dimension::Mass);
        prop_assert!(read.to_bits().abs_diff(exact.to_bits()) <= 1);
    }

    /// Whatever the text, there is a number within the limits or a refusal.
    #[test]
    fn any_text_is_a_quantity_or_a_refusal(text in "[-+]?[0-9.eE]{0,6} ?(\\PC{0,4}|kg|%|,)") {
        match parse(&text, Dimension::Mass, true) {
            Ok(Amount::Si(x) | Amount::Share(x)) => prop_assert!(x == 0.0 || (1e-30..=1e30).contains(&x.abs()), "{x}"),
            Err(bad) => prop_assert!(!bad.found.is_empty() && !bad.right.is_empty()),
        }
    }
}
