//! Units as people write them: every spelling has its value, every text that is no unit has its message, and what the program
//! prints can be read again. The values are ratios of whole numbers, computed apart and rounded once to a double.

use std::path::Path;

use trainsafe::units::{Amount, Dimension, UnitSystem, parse, shown};
use trainsafe::{consist, schema};

/// Last places that a value may be off: a metric unit moves the decimal point, others multiply and divide once each.
const EXACT: u64 = 0;
const ROUNDED: u64 = 2;

const SPELLINGS: &[(&str, Dimension, f64, u64)] = &[
    ("1 tonne", Dimension::Mass, 1000.0, EXACT),
    ("1 tonnes", Dimension::Mass, 1000.0, EXACT),
    ("1 Tonnes", Dimension::Mass, 1000.0, EXACT),
    ("1 metric ton", Dimension::Mass, 1000.0, EXACT),
    ("1 metric tons", Dimension::Mass, 1000.0, EXACT),
    ("1000 kgs", Dimension::Mass, 1000.0, EXACT),
    ("1000 KG", Dimension::Mass, 1000.0, EXACT),
    ("1000 kilograms", Dimension::Mass, 1000.0, EXACT),
    ("432000 lbs", Dimension::Mass, 195951.90384, ROUNDED),
    ("432000 lb", Dimension::Mass, 195951.90384, ROUNDED),
    ("432000 LBS", Dimension::Mass, 195951.90384, ROUNDED),
    ("432000 lbm", Dimension::Mass, 195951.90384, ROUNDED),
    ("432000 pounds", Dimension::Mass, 195951.90384, ROUNDED),
    ("432 klb", Dimension::Mass, 195951.90384, ROUNDED),
    ("432 klbs", Dimension::Mass, 195951.90384, ROUNDED),
    ("432 klbm", Dimension::Mass, 195951.90384, ROUNDED),
    ("432KLB", Dimension::Mass, 195951.90384, ROUNDED),
    ("143 ton_us", Dimension::Mass, 129727.41782, ROUNDED),
    ("143 short tons", Dimension::Mass, 129727.41782, ROUNDED),
    ("143 Short Ton", Dimension::Mass, 129727.41782, ROUNDED),
    ("143 US tons", Dimension::Mass, 129727.41782, ROUNDED),
    ("390 kips", Dimension::Force, 1734806.429951595, ROUNDED),
    ("390 kip", Dimension::Force, 1734806.429951595, ROUNDED),
    ("390 Kips", Dimension::Force, 1734806.429951595, ROUNDED),
    ("390 klbf", Dimension::Force, 1734806.429951595, ROUNDED),
    ("390 klb", Dimension::Force, 1734806.429951595, ROUNDED),
    ("390 klbs", Dimension::Force, 1734806.429951595, ROUNDED),
    ("390 KLB", Dimension::Force, 1734806.429951595, ROUNDED),
    ("390000 lbs", Dimension::Force, 1734806.429951595, ROUNDED),
    ("390000 lb", Dimension::Force, 1734806.429951595, ROUNDED),
    ("390000 LBF", Dimension::Force, 1734806.429951595, ROUNDED),
    ("390000 pounds", Dimension::Force, 1734806.429951595, ROUNDED),
    ("1500 daN", Dimension::Force, 15000.0, EXACT),
    ("15000000 mN", Dimension::Force, 15000.0, EXACT),
    ("0.015 MN", Dimension::Force, 15000.0, EXACT),
    ("15kN", Dimension::Force, 15000.0, EXACT),
    ("1.5e4 N", Dimension::Force, 15000.0, EXACT),
    ("15\u{a0}kN", Dimension::Force, 15000.0, EXACT),
    ("1000 kgf", Dimension::Force, 9806.65, ROUNDED),
    ("1 tf", Dimension::Force, 9806.65, ROUNDED),
    ("1 mN", Dimension::Force, 0.001, EXACT),
    ("1e-3 N", Dimension::Force, 0.001, EXACT),
    ("97 kips/in", Dimension::Stiffness, 16987303.01890821, ROUNDED),
    ("97 kip/in", Dimension::Stiffness, 16987303.01890821, ROUNDED),
    ("97 klbf/in", Dimension::Stiffness, 16987303.01890821, ROUNDED),
    ("97 klb/in", Dimension::Stiffness, 16987303.01890821, ROUNDED),
    ("97000 lb/in", Dimension::Stiffness, 16987303.01890821, ROUNDED),
    ("97000 lbs/in", Dimension::Stiffness, 16987303.01890821, ROUNDED),
    ("97000 lbf/in", Dimension::Stiffness, 16987303.01890821, ROUNDED),
    ("97000 LB/IN", Dimension::Stiffness, 16987303.01890821, ROUNDED),
    ("97000 lbf/inch", Dimension::Stiffness, 16987303.01890821, ROUNDED),
    ("97 kips per inch", Dimension::Stiffness, 16987303.01890821, ROUNDED),
    ("97 kips / in", Dimension::Stiffness, 16987303.01890821, ROUNDED),
    ("97 kips/ft", Dimension::Stiffness, 1415608.5849090174, ROUNDED),
    ("97000 lb/ft", Dimension::Stiffness, 1415608.5849090174, ROUNDED),
    ("17200 N/mm", Dimension::Stiffness, 17200000.0, EXACT),
    ("172 kN/cm", Dimension::Stiffness, 17200000.0, EXACT),
    ("17.2 kN/mm", Dimension::Stiffness, 17200000.0, EXACT),
    ("17200 kN/m", Dimension::Stiffness, 17200000.0, EXACT),
    ("17.2 MN/m", Dimension::Stiffness, 17200000.0, EXACT),
    ("17200000 N/m", Dimension::Stiffness, 17200000.0, EXACT),
    ("1720000 daN/m", Dimension::Stiffness, 17200000.0, EXACT),
    ("17.2 kN / mm", Dimension::Stiffness, 17200000.0, EXACT),
    ("12 sec", Dimension::Time, 12.0, EXACT),
    ("12 secs", Dimension::Time, 12.0, EXACT),
    ("12 second", Dimension::Time, 12.0, EXACT),
    ("12 seconds", Dimension::Time, 12.0, EXACT),
    ("12 s", Dimension::Time, 12.0, EXACT),
    ("12 Sec", Dimension::Time, 12.0, EXACT),
    ("12000 msec", Dimension::Time, 12.0, EXACT),
    ("12000 ms", Dimension::Time, 12.0, EXACT),
    ("12000 milliseconds", Dimension::Time, 12.0, EXACT),
    ("12000000 us", Dimension::Time, 12.0, EXACT),
    ("12000000 \u{b5}s", Dimension::Time, 12.0, EXACT),
    ("12000000 \u{3bc}s", Dimension::Time, 12.0, EXACT),
    ("3 minutes", Dimension::Time, 180.0, ROUNDED),
    ("3 mins", Dimension::Time, 180.0, ROUNDED),
    ("0.05 h", Dimension::Time, 180.0, ROUNDED),
    ("0.05 hours", Dimension::Time, 180.0, ROUNDED),
    ("1090 cm", Dimension::Length, 10.9, EXACT),
    ("10900 mm", Dimension::Length, 10.9, EXACT),
    ("10.9 m", Dimension::Length, 10.9, EXACT),
    ("10.9 metres", Dimension::Length, 10.9, EXACT),
    ("10.9 meters", Dimension::Length, 10.9, EXACT),
    ("0.0109 km", Dimension::Length, 10.9, EXACT),
    ("53 feet", Dimension::Length, 16.1544, ROUNDED),
    ("53 foot", Dimension::Length, 16.1544, ROUNDED),
    ("53 ft", Dimension::Length, 16.1544, ROUNDED),
    ("53 FT", Dimension::Length, 16.1544, ROUNDED),
    ("636 inches", Dimension::Length, 16.1544, ROUNDED),
    ("636 inch", Dimension::Length, 16.1544, ROUNDED),
    ("636 in", Dimension::Length, 16.1544, ROUNDED),
    ("25 kmh", Dimension::Speed, 6.944444444444445, ROUNDED),
    ("25 kph", Dimension::Speed, 6.944444444444445, ROUNDED),
    ("25 km/h", Dimension::Speed, 6.944444444444445, ROUNDED),
    ("25 km/hr", Dimension::Speed, 6.944444444444445, ROUNDED),
    ("25 KPH", Dimension::Speed, 6.944444444444445, ROUNDED),
    ("25 kmph", Dimension::Speed, 6.944444444444445, ROUNDED),
    ("25 km per hour", Dimension::Speed, 6.944444444444445, ROUNDED),
    ("6 mph", Dimension::Speed, 2.68224, ROUNDED),
    ("6 MPH", Dimension::Speed, 2.68224, ROUNDED),
    ("6 mi/h", Dimension::Speed, 2.68224, ROUNDED),
    ("6 miles/hour", Dimension::Speed, 2.68224, ROUNDED),
    ("6 miles per hour", Dimension::Speed, 2.68224, ROUNDED),
    ("8.8 ft/s", Dimension::Speed, 2.68224, ROUNDED),
    ("528 ft/min", Dimension::Speed, 2.68224, ROUNDED),
    ("2.5 m/sec", Dimension::Speed, 2.5, EXACT),
    ("2.5 m/s", Dimension::Speed, 2.5, EXACT),
    ("2.5 m/second", Dimension::Speed, 2.5, EXACT),
    ("250 cm/s", Dimension::Speed, 2.5, EXACT),
    ("115.4 kN·s/m", Dimension::Damping, 115400.0, EXACT),
    ("115.4 kNs/m", Dimension::Damping, 115400.0, EXACT),
    ("115.4 kN s/m", Dimension::Damping, 115400.0, EXACT),
    ("115.4 kN.s/m", Dimension::Damping, 115400.0, EXACT),
    ("115.4 kN*s/m", Dimension::Damping, 115400.0, EXACT),
    ("115.4 kN-s/m", Dimension::Damping, 115400.0, EXACT),
    ("115.4 kN⋅s/m", Dimension::Damping, 115400.0, EXACT),
    ("115.4 kN•s/m", Dimension::Damping, 115400.0, EXACT),
    ("115.4 kN sec/m", Dimension::Damping, 115400.0, EXACT),
    ("115.4 kN·sec/m", Dimension::Damping, 115400.0, EXACT),
    ("115.4 kN/(m/s)", Dimension::Damping, 115400.0, EXACT),
    ("115.4 kN / (m/s)", Dimension::Damping, 115400.0, EXACT),
    ("115.4 kN · s / m", Dimension::Damping, 115400.0, EXACT),
    ("0.1154 kN s/mm", Dimension::Damping, 115400.0, EXACT),
    ("115.4 N s/mm", Dimension::Damping, 115400.0, EXACT),
    ("115400 Ns/m", Dimension::Damping, 115400.0, EXACT),
    ("115400 N·s/m", Dimension::Damping, 115400.0, EXACT),
    ("0.1154 MN·s/m", Dimension::Damping, 115400.0, EXACT),
    ("659 lbf*s/in", Dimension::Damping, 115408.58442742794, ROUNDED),
    ("659 lb*s/in", Dimension::Damping, 115408.58442742794, ROUNDED),
    ("659 lb-s/in", Dimension::Damping, 115408.58442742794, ROUNDED),
    ("659 lbf-sec/in", Dimension::Damping, 115408.58442742794, ROUNDED),
    ("659 lbs-sec/in", Dimension::Damping, 115408.58442742794, ROUNDED),
    ("659 lbf s/in", Dimension::Damping, 115408.58442742794, ROUNDED),
    ("0.659 kip*s/in", Dimension::Damping, 115408.58442742794, ROUNDED),
    ("0.659 kips-s/in", Dimension::Damping, 115408.58442742794, ROUNDED),
    ("0.659 kip·s/in", Dimension::Damping, 115408.58442742794, ROUNDED),
    ("7908 lbf-s/ft", Dimension::Damping, 115408.58442742794, ROUNDED),
    ("659 lbf/(in/s)", Dimension::Damping, 115408.58442742794, ROUNDED),
    ("4 lb/ton", Dimension::Resistance, 0.0196133, ROUNDED),
    ("4 lbs/ton", Dimension::Resistance, 0.0196133, ROUNDED),
    ("4 lbf/ton", Dimension::Resistance, 0.0196133, ROUNDED),
    ("4 lb per ton", Dimension::Resistance, 0.0196133, ROUNDED),
    ("4 lbf/ton_us", Dimension::Resistance, 0.0196133, ROUNDED),
    ("4 LB/TON", Dimension::Resistance, 0.0196133, ROUNDED),
    ("4 lb/tons", Dimension::Resistance, 0.0196133, ROUNDED),
    ("4 lbs/short ton", Dimension::Resistance, 0.0196133, ROUNDED),
    ("15 N/t", Dimension::Resistance, 0.015, EXACT),
    ("15 N/tonne", Dimension::Resistance, 0.015, EXACT),
    ("0.015 kN/t", Dimension::Resistance, 0.015, EXACT),
    ("0.015 N/kg", Dimension::Resistance, 0.015, EXACT),
    ("15 N per tonne", Dimension::Resistance, 0.015, EXACT),
    ("1 in 100", Dimension::Grade, 0.01, EXACT),
    ("1:100", Dimension::Grade, 0.01, EXACT),
    ("1 : 100", Dimension::Grade, 0.01, EXACT),
    ("1/100", Dimension::Grade, 0.01, EXACT),
    ("1 %", Dimension::Grade, 0.01, EXACT),
    ("1 percent", Dimension::Grade, 0.01, EXACT),
    ("1 per cent", Dimension::Grade, 0.01, EXACT),
    ("1 pct", Dimension::Grade, 0.01, EXACT),
    ("10 ‰", Dimension::Grade, 0.01, EXACT),
    ("75 %", Dimension::Share, 0.75, EXACT),
    ("75 percent", Dimension::Share, 0.75, EXACT),
    ("10 per mille", Dimension::Grade, 0.01, EXACT),
    ("10 permille", Dimension::Grade, 0.01, EXACT),
    ("10 mm/m", Dimension::Grade, 0.01, EXACT),
    ("10 m/km", Dimension::Grade, 0.01, EXACT),
    ("1 cm/m", Dimension::Grade, 0.01, EXACT),
    ("1 in 80", Dimension::Grade, 0.0125, ROUNDED),
    ("1:80", Dimension::Grade, 0.0125, ROUNDED),
    ("1 in  80.0", Dimension::Grade, 0.0125, ROUNDED),
    ("-1 in 40", Dimension::Grade, -0.025, ROUNDED),
    ("-2.5 %", Dimension::Grade, -0.025, ROUNDED),
    ("-25 o/oo", Dimension::Grade, -0.025, ROUNDED),
    ("58.08 ft/mi", Dimension::Grade, 0.011, ROUNDED),
    ("58.08 feet/mile", Dimension::Grade, 0.011, ROUNDED),
];

fn si(text: &str, dimension: Dimension) -> f64 {
    match parse(text, dimension, false) {
        Ok(Amount::Si(value)) => value,
        other => panic!("{text}: {other:?}"),
    }
}

#[test]
fn every_spelling_has_its_value() {
    for &(text, dimension, expected, places) in SPELLINGS {
        let value = si(text, dimension);
        assert!(value.to_bits().abs_diff(expected.to_bits()) <= places, "{text} is {value:e}, not {expected:e}");
    }
}

/// The pattern that editors check by takes each of them as well.
#[test]
fn the_schema_takes_every_spelling() {
    let schema = schema::train();
    let place = |dimension| match dimension {
        Dimension::Mass => "/properties/vehicle/items/properties/mass",
        Dimension::Force => "/properties/coupler/properties/rated_load",
        Dimension::Stiffness => "/properties/coupler/properties/stiffness",
        Dimension::Time => "/properties/scenario/items/properties/horizon",
        Dimension::Length => "/properties/vehicle/items/properties/length",
        Dimension::Speed => "/properties/scenario/items/properties/speed",
        Dimension::Damping => "/properties/coupler/properties/damping",
        Dimension::Resistance => "/properties/load/properties/rolling_resistance",
        Dimension::Grade => "/properties/load/properties/grade",
        Dimension::Share => "/properties/coupler/properties/friction",
    };
    for dimension in Dimension::ALL {
        let property = schema.pointer(place(dimension)).expect("a key");
        let validator = jsonschema::draft202012::new(property).expect("a schema");
        let takes = |text: &str| validator.is_valid(&serde_json::json!(text));
        for (text, ..) in SPELLINGS.iter().filter(|s| s.1 == dimension) {
            assert!(takes(text), "{text}");
        }
        for &(text, of, ..) in REFUSED {
            assert!(of != dimension || !takes(text), "{text}");
        }
    }
}

/// A text, what it should have been, what is found, and what would be right.
const REFUSED: &[(&str, Dimension, &str, &str)] = &[
    (
        "5 ton",
        Dimension::Mass,
        "has \"ton\", which means more than one unit",
        "write \"5 t\" (metric, 1000 kg) or \"5 ton_us\" (US, 2000 lb)",
    ),
    (
        "143 Tons",
        Dimension::Mass,
        "has \"Tons\", which means more than one unit",
        "write \"143 t\" (metric, 1000 kg) or \"143 ton_us\" (US, 2000 lb)",
    ),
    ("130 mt", Dimension::Mass, "has the unknown unit \"mt\"", "write \"130 t\" (metric, 1000 kg)"),
    ("286 kips", Dimension::Mass, "has \"kips\", a unit of force", "write \"286 klb\" (1000 lb of mass)"),
    ("286 kip", Dimension::Mass, "has \"kip\", a unit of force", "write \"286 klb\" (1000 lb of mass)"),
    ("9 lbf", Dimension::Mass, "has \"lbf\", a unit of force", "write \"9 lb\" (a pound of mass)"),
    ("3 T", Dimension::Mass, "has the unknown unit \"T\"", "did you mean \"3 t\"?"),
    ("1 mn", Dimension::Force, "has the unknown unit \"mn\"", "did you mean \"1 MN\" or \"1 mN\"?"),
    ("1 KN", Dimension::Force, "has the unknown unit \"KN\"", "did you mean \"1 kN\"?"),
    ("1 kn/MM", Dimension::Stiffness, "has the unknown unit \"kn/MM\"", "did you mean \"1 kN/mm\"?"),
    ("30 mn / m", Dimension::Stiffness, "has the unknown unit \"mn / m\"", "did you mean \"30 MN/m\"?"),
    ("30 mN/m", Dimension::Stiffness, "has the unknown unit \"mN/m\"", "did you mean \"30 MN/m\"?"),
    ("3 tons", Dimension::Force, "has the unknown unit \"tons\"", "a force is in N, kN, MN, lbf or kip"),
    ("3 kg", Dimension::Force, "has \"kg\", a unit of mass", "write \"3 kgf\" (the weight of 1 kg)"),
    (
        "15 N/ton",
        Dimension::Resistance,
        "has \"N/ton\", which means more than one unit",
        "write \"15 N/t\" (metric, 1000 kg) or \"15 N/ton_us\" (US, 2000 lb)",
    ),
    (
        "15 kN/tons",
        Dimension::Resistance,
        "has \"kN/tons\", which means more than one unit",
        "write \"15 kN/t\" (metric, 1000 kg) or \"15 kN/ton_us\" (US, 2000 lb)",
    ),
    (
        "500 lbs/in",
        Dimension::Damping,
        "has \"lbs/in\", a unit of stiffness",
        "a damping is in N*s/m, kN*s/m, MN*s/m, lbf*s/in or kip*s/in",
    ),
    (
        "3 kips/in",
        Dimension::Damping,
        "has \"kips/in\", a unit of stiffness",
        "a damping is in N*s/m, kN*s/m, MN*s/m, lbf*s/in or kip*s/in",
    ),
    ("3 kip/on", Dimension::Stiffness, "has the unknown unit \"kip/on\"", "did you mean \"3 kip/in\"?"),
    ("1 in 100", Dimension::Length, "has \"in 100\", a unit of grade", "a length is in m, mm, ft or in"),
    ("1 in 0", Dimension::Grade, "has the unknown unit \"in 0\"", "a grade is in % or \u{2030}"),
    ("1:", Dimension::Grade, "has the unknown unit \":\"", "a grade is in % or \u{2030}"),
    ("5 mph/s", Dimension::Speed, "has the unknown unit \"mph/s\"", "a speed is in m/s, km/h or mph"),
    (
        "0,6 MN",
        Dimension::Force,
        "is not one number",
        "write it with a point for decimals and no other separators: a force is in N, kN, MN, lbf or kip",
    ),
    (
        "432,000 lbs",
        Dimension::Mass,
        "is not one number",
        "write it with a point for decimals and no other separators: a mass is in kg, t, lb, klb or ton_us",
    ),
    ("10 mS", Dimension::Time, "has the unknown unit \"mS\"", "did you mean \"10 ms\"?"),
];

#[test]
fn every_refusal_says_what_would_be_right() {
    for &(text, dimension, found, right) in REFUSED {
        match parse(text, dimension, false) {
            Err(bad) => assert_eq!((bad.found.as_str(), bad.right.as_str()), (found, right), "{text}"),
            Ok(amount) => panic!("{text}: {amount:?}"),
        }
    }
}

/// A share is per cent in the same words as a grade.
#[test]
fn shares_in_words() {
    for text in ["60 %", "60 percent", "60 per cent", "60 pct"] {
        assert_eq!(parse(text, Dimension::Force, true), Ok(Amount::Share(0.6)), "{text}");
    }
}

/// A quantity as `check` prints it is read back as the same number, to the digits that are printed: all in its own unit, four in another.
#[test]
fn what_is_shown_is_read_again() {
    for (system, dimension) in [UnitSystem::Si, UnitSystem::Us].into_iter().flat_map(|s| Dimension::ALL.map(|d| (s, d)))
    {
        for exponent in -12..13 {
            let value = 1.2345 * 10f64.powi(exponent);
            let text = shown(system, value, dimension);
            let read = si(&text, dimension);
            // In SI the number is 12345 with the point moved, but for km/h.
            let exact = system == UnitSystem::Si && dimension != Dimension::Speed;
            let most = if exact { 1e-15 } else { 5.001e-4 };
            assert!((read - value).abs() <= most * value, "{text} is {read:e}, not {value:e}");
        }
    }
}

/// Quantities of the report of a train: its numbers with units, put into a train file, make the same train.
#[test]
fn what_the_report_prints_is_read_again() {
    let file = |stiffness: &str, rating: &str, damping: &str, mass: &str, load: &str| {
        format!(
            "[coupler]\nstiffness = \"{stiffness}\"\nrated_load = \"{rating}\"\ndamping = \"{damping}\"\n[[vehicle]]\ncount = 3\n\
             mass = \"{mass}\"\n[load]\nuniform = \"{load}\"\n"
        )
    };
    let parse = |text: &str| consist::parse(text, Path::new("a.toml")).unwrap_or_else(|e| panic!("{e}"));
    let train = parse(&file("17 MN/m", "1.75 MN", "115.4 kN*s/m", "129.7 t", "667 kN"));
    let analysis = trainsafe::analyze(&train, &trainsafe::Options::default()).expect("sound");
    let folder = tempfile::tempdir().expect("a folder");
    trainsafe::report::write(&train, &analysis, folder.path(), &trainsafe::report::Format::ALL).expect("written");
    let report = std::fs::read_to_string(folder.path().join("report.md")).expect("a report");
    let fact = |name: &str| {
        let row = report.lines().find(|line| line.starts_with(&format!("| {name} |"))).expect("a row");
        let value = row.split('|').nth(2).expect("a value").trim();
        value.split(" in ").next().and_then(|v| v.split(',').next()).unwrap_or(value).to_owned()
    };
    assert_eq!(fact("dashpot of a coupler"), "115.4 kN\u{b7}s/m");
    let names = [
        "stiffness of a coupler",
        "rated in draft",
        "dashpot of a coupler",
        "mass of a vehicle",
        "load before the event",
    ];
    let [stiffness, rating, damping, mass, load] = names.map(fact);
    let again = parse(&file(&stiffness, &rating, &damping, &mass, &load));
    assert_eq!(
        (again.couplers(), again.vehicles(), again.extras()),
        (train.couplers(), train.vehicles(), train.extras())
    );
    assert_eq!(again.initial_force_n(), train.initial_force_n());
}

/// A train in the units of a North American car builder's sheet.
#[test]
fn a_train_in_us_units_as_people_write_them() {
    let text = "[coupler]\nstiffness = \"97 kips/in\"\nrated_load = \"390 kips\"\ndamping = \"115.4 kN\u{b7}s/m\"\n[[vehicle]]\n\
                mass = \"432000 lbs\"\n[[vehicle]]\nmass = \"286 klbs\"\n[load]\nuniform = \"150 klb\"\n";
    let train = consist::parse(text, Path::new("a.toml")).unwrap_or_else(|e| panic!("{e}"));
    let near = |value: f64, expected: f64| assert!((value / expected - 1.0).abs() < 1e-15, "{value} {expected}");
    near(train.couplers()[0].stiffness_n_per_m, 16_987_303.018_908_21);
    near(train.couplers()[0].rated_draft_n, 1_734_806.429_951_595);
    near(train.extras().dashpot_n_s_per_m[0], 115_400.0);
    near(train.vehicles()[0].mass_kg, 195_951.903_84);
    near(train.vehicles()[1].mass_kg, 129_727.417_82);
    near(train.initial_force_n()[0], 667_233.242_289_075);
}
