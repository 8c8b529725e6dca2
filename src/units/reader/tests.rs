use super::*;

const SI: UnitSystem = UnitSystem::Si;
const US: UnitSystem = UnitSystem::Us;

#[test]
fn given_numbers_have_no_trailing_zeros() {
    assert_eq!(shown(SI, 600e3, Dimension::Force), "600 kN");
    assert_eq!(shown(SI, 0.06, Dimension::Time), "60 ms");
    assert_eq!(shown(SI, 0.0, Dimension::Time), "0 s");
    assert_eq!(shown(SI, 16.8e6, Dimension::Mass), "16800 t");
    assert_eq!(shown(SI, 1e300, Dimension::Mass), "1e297 t");
    assert_eq!(shown(SI, 25.0 / 3.6, Dimension::Speed), "25 km/h");
    assert_eq!(shown(SI, 0.0125, Dimension::Grade), "1.25 %");
    assert_eq!(SI.wave_speed(290.0), "290 m/s");
}

#[test]
fn a_reader_of_us_units_gets_them() {
    assert_eq!(shown(US, 286_000.0 * LB, Dimension::Mass), "143 US tons");
    assert_eq!(shown(US, 16.9173e6, Dimension::Stiffness), "96.6 kip/in");
    assert_eq!(shown(US, 16.1544, Dimension::Length), "53 ft");
    assert_eq!(shown(US, 0.0254, Dimension::Length), "1 in");
    assert_eq!(shown(US, 2.68224, Dimension::Speed), "6 mph");
    assert_eq!(US.wave_speed(304.8), "1000 ft/s");
    assert_eq!(US.acceleration(0.3048), "1 ft/s\u{b2}");
    assert_eq!(US.energy(48_809.0), "36000 ft\u{b7}lbf");
    assert_eq!(rounded(US, 5e3, Dimension::Mass), "5.51 US tons");
}

/// What is shown can be written into a file: the reader of files takes it for the same quantity.
#[test]
fn every_unit_can_be_read() {
    for system in [SI, US] {
        for dimension in Dimension::ALL {
            for unit in system.units(dimension) {
                let read = crate::units::parse(&format!("1 {}", unit.name), dimension, false);
                let Ok(crate::units::Amount::Si(size)) = read else { panic!("{}: {read:?}", unit.name) };
                assert!((size / unit.size - 1.0).abs() < 1e-14, "{}: {size}", unit.name);
            }
        }
    }
}
