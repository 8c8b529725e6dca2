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
fn forces_are_in_the_reader_s_units_without_sign() {
    assert_eq!(given_force(SI, -600e3), "600 kN");
    assert_eq!(given_force(SI, 0.0), "0 N");
    assert_eq!(force(US, -1.47279e6, 1e-6), "331.1 kip");
    assert_eq!(force(US, 2000.0, 1e-6), "449.6 lbf");
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
fn what_has_to_be_reached_is_rounded_up() {
    assert_eq!(up(1.508_01), "1.509");
    assert_eq!(up(1.508), "1.508");
    assert_eq!(up(567.63), "567.7");
    assert_eq!(up(1.0 + 1e-9), "1.001");
    assert_eq!(up(0.0), "0");
}

#[test]
fn the_ends_of_an_interval_differ() {
    assert_eq!(interval(884_750.0, 90e3), ["794750", "974750"]);
    assert_eq!(interval(1.0, 2e-7), ["0.9999998", "1.0000002"]);
}
