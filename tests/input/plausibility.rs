//! Doubts about numbers that no railway has, loads that are rounding, and options that do nothing.

use std::path::Path;

use trainsafe::doubts::doubts;
use trainsafe::findings::idle_options;
use trainsafe::units::UnitSystem;
use trainsafe::{Options, Train, analyze, consist};

fn parse(text: &str) -> Train {
    consist::parse(text, Path::new("train.toml")).unwrap_or_else(|e| panic!("{e}"))
}

fn codes(train: &Train) -> Vec<&'static str> {
    doubts(train).iter().map(|d| d.code).collect()
}

/// A sound train: a held locomotive and 60 cars.
const SOUND: &str = "damping_ratio = 0
[coupler]
stiffness = \"11.1 MN/m\"
rated_load = \"1.2 MN\"
[[vehicle]]
label = \"loco\"
mass = \"196 t\"
length = \"22 m\"
held = true
[[vehicle]]
label = \"car\"
count = 60
mass = \"120 t\"
length = \"16 m\"
[load]
uniform = \"0.7 MN\"
[[scenario]]
kind = \"break\"
coupler = 5
";

/// Newtons or millinewtons in the place of meganewtons, and shares of 1 in a column of per cent.
#[test]
fn sizes_that_no_train_notices() {
    let faint = SOUND.replace("0.7 MN", "0.7 mN");
    assert!(codes(&parse(&faint)).contains(&"faint-load"));
    let pulse = |force: &str| {
        let pulse = format!("kind = \"pulse\"\nat = \"tail\"\nforce = \"{force}\"\nduration = \"1 s\"\n");
        codes(&parse(&SOUND.replace("kind = \"break\"\ncoupler = 5\n", &pulse)))
    };
    assert!(pulse("800 mN").contains(&"faint-pulse") && pulse("-900 N").contains(&"faint-pulse"));
    assert!(!pulse("-800 kN").contains(&"faint-pulse") && !pulse("-800 kN").contains(&"faint-load"));
    let grade = |percent: &str| {
        let train = SOUND.replace("uniform = \"0.7 MN\"", &format!("grade = \"{percent} %\""));
        let train = parse(&train.replace("coupler = 5", "coupler = \"each\""));
        doubts(&train).into_iter().find(|d| d.code == "flat-grade").map(|d| d.text)
    };
    let told = "the steepest grade is 0.012 %: was 1.2 % meant, given as a share of 1?";
    assert_eq!(grade("-0.012").as_deref(), Some(told));
    assert_eq!((grade("1.2"), grade("0.06")), (None, None));
}

/// The sound train with one line changed.
fn with(from: &str, to: &str) -> Train {
    assert!(SOUND.contains(from), "{from}");
    parse(&SOUND.replace(from, to))
}

/// Each slip has its doubt, and the sound train has none.
#[test]
fn implausible_numbers_are_doubted() {
    assert!(codes(&parse(SOUND)).is_empty());
    for (from, to, expected) in [
        ("11.1 MN/m", "11.1 kN/m", &["soft-coupler", "stretch"][..]),
        ("11.1 MN/m", "0.9 MN/m", &["soft-coupler", "stretch"]),
        ("11.1 MN/m", "1.2 MN/m", &["stretch"]),
        ("11.1 MN/m", "1.5 MN/m", &[]),
        ("length = \"16 m\"", "length = \"60 mm\"", &["length", "stretch"]),
        ("length = \"16 m\"", "length = \"16 km\"", &["length"]),
        ("11.1 MN/m", "11100 MN/m", &["stiff-coupler"]),
        ("11.1 MN/m\"", "11.1 MN/m\"\nslack = \"20 m\"", &["slack", "slack-without-friction"]),
        ("length = \"22 m\"\n", "", &[]),
        ("length = \"16 m\"\n", "", &["some-lengths"]),
        ("damping_ratio = 0\n", "speed = \"320 km/h\"\n", &["speed", "speed-unused"]),
        ("120 t", "120 kg", &["mass"]),
        ("120 t", "4.9 t", &["mass"]),
        ("1.2 MN", "1.2 mN", &["load-over-rating", "rating"]),
        ("1.2 MN", "1.200 kN", &["load-over-rating", "rating"]),
        ("1.2 MN", "1200 MN", &["rating"]),
        ("1.2 MN", "10 MN", &[]),
        ("1.2 MN\"", "1.2 MN\"\nrated_buff = \"12 MN\"", &["rating"]),
        ("120 t", "401 t", &["mass"]),
        ("120 t", "5 t", &[]),
        ("196 t", "900 t", &[]),
        ("damping_ratio = 0\n", "damping_ratio = 0.05\n", &["modal-damping"]),
        ("damping_ratio = 0\n", "damping_ratio = 0.14\n", &["modal-damping"]),
        ("damping_ratio = 0\n", "damping_ratio = 0.9\n", &["modal-damping"]),
        ("uniform = \"0.7 MN\"", "grade = \"12 %\"", &["load-over-rating", "grade", "stretch"]),
        ("uniform = \"0.7 MN\"", "grade = \"10 %\"", &["load-over-rating", "stretch"]),
    ] {
        let train = with(from, to);
        let mut found = codes(&train);
        let mut expected = expected.to_vec();
        found.sort_unstable();
        expected.sort_unstable();
        assert_eq!(found, expected, "{to}: {:?}", doubts(&train));
    }
    // A vehicle's own grade.
    let text = SOUND.replace("length = \"16 m\"\n", "length = \"16 m\"\ngrade = \"-11 %\"\n");
    let text = text
        .replace("[load]\nuniform = \"0.7 MN\"\n", "")
        .replace("coupler = 5\n", "coupler = 5\nbuff_breaks = true\n");
    assert!(codes(&parse(&text)).contains(&"grade"));
    // The published ratio is a dashpot's: c = 2 z sqrt(k m).
    let told = doubts(&with("damping_ratio = 0\n", "damping_ratio = 0.05\n"))[0].to_string();
    assert!(told.contains("damping = \"115.4 kN\u{b7}s/m\""), "{told}");
    // One doubt for all alike.
    let told = doubts(&with("11.1 MN/m", "11.1 kN/m"))[1].to_string();
    assert!(told.contains("coupler 1 (and 59 more couplers) by 63.06 m, more than 500 mm"), "{told}");
}

/// Doubts and what `check` prints are in the units that the file or the reader asks for, and in no others.
#[test]
fn doubts_and_descriptions_are_in_the_reader_s_units() {
    let event = |event: &str| SOUND.replace("kind = \"break\"\ncoupler = 5", event);
    let texts = [
        SOUND.replace("11.1 MN/m", "11.1 kN/m"),
        SOUND.replace("120 t", "401 t").replace("1.2 MN", "12 MN"),
        SOUND.replace("damping_ratio = 0\n", "damping_ratio = 0.05\n"),
        SOUND.replace("held = true", "tractive_effort = \"9 MN\"").replace("[load]\nuniform = \"0.7 MN\"\n", ""),
        event("kind = \"impact\"\nat = \"tail\"\nvehicles = 3\nspeed = \"201 km/h\"")
            .replace("rated_load", "damping = \"100 kN*s/m\"\nrated_load"),
        event("kind = \"pulse\"\nat = \"tail\"\nforce = \"1 MN\"\nduration = \"9 min\""),
    ];
    let samples =
        ["trains/unit-train-emergency.toml", "trains/mixed-manifest-brakes.toml", "trains/shunting-european-rake.toml"];
    let read = |path: &&str| consist::read(Path::new(path)).unwrap_or_else(|e| panic!("{e}"));
    let trains: Vec<Train> = texts.iter().map(|text| parse(text)).chain(samples.iter().map(read)).collect();
    let mut kinds: Vec<&str> = trains.iter().flat_map(codes).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let with_numbers =
        ["acceleration", "dashpot-at-contact", "mass", "modal-damping", "rating", "soft-coupler", "speed", "stretch"];
    assert!(with_numbers.iter().all(|code| kinds.contains(code)), "{kinds:?}");
    // A number and, as the next word, one of these units.
    let foreign = |units: &[&str], text: &str| {
        let words: Vec<&str> =
            text.split_whitespace().map(|w| w.trim_matches(['(', ')', ';', ',', ':', '"'])).collect();
        let number = |word: &str| word.parse::<f64>().is_ok();
        words.windows(2).find(|pair| number(pair[0]) && units.contains(&pair[1])).map(|pair| pair.join(" "))
    };
    let si = [
        "N",
        "kN",
        "MN",
        "kN/m",
        "MN/m",
        "kg",
        "t",
        "m",
        "mm",
        "m/s",
        "m/s\u{b2}",
        "km/h",
        "kJ",
        "kN\u{b7}s/m",
        "MN\u{b7}s/m",
    ];
    let us = [
        "lbf",
        "kip",
        "lbf/in",
        "kip/in",
        "lb",
        "US",
        "ft",
        "in",
        "ft/s",
        "ft/s\u{b2}",
        "mph",
        "ft\u{b7}lbf",
        "kip\u{b7}s/in",
    ];
    for train in trains {
        for (units, others) in [(UnitSystem::Us, &si[..]), (UnitSystem::Si, &us[..])] {
            let train = train.clone().with_units(units);
            let mut text = consist::describe(&train).replace(train.name(), "");
            train.scenarios().iter().for_each(|s| text = text.replace(&s.name, ""));
            assert_eq!(foreign(others, &text), None, "{units:?}: {text}");
        }
    }
}

/// A file's own units and `--units` decide what `check` prints.
#[test]
fn check_prints_the_units_asked_for() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("train.toml");
    let check = |text: &str, options: &[&str]| {
        std::fs::write(&path, text).expect("written");
        let done =
            std::process::Command::new(env!("CARGO_BIN_EXE_trainsafe")).arg("check").arg(&path).args(options).output();
        String::from_utf8(done.expect("it runs").stdout).expect("text")
    };
    let us = format!("units = \"us\"\n{SOUND}");
    for (text, options, mass) in [
        (SOUND, &[][..], "7200 t"),
        (SOUND, &["--units", "us"], "7937 US tons"),
        (&us, &[], "7937 US tons"),
        (&us, &["--units", "si"], "7200 t"),
    ] {
        let printed = check(text, options);
        assert!(printed.contains(&format!("60 couplers, {mass}, not counting held vehicles")), "{printed}");
    }
}

/// A train that runs away, vehicles that arrive too fast, a dashpot that is struck.
#[test]
fn implausible_motions_are_doubted() {
    let free = |effort: &str| {
        let text = SOUND.replace("held = true", effort).replace("[load]\nuniform = \"0.7 MN\"\n", "");
        parse(&text.replace("1.2 MN", "9 MN").replace("11.1 MN/m", "100 MN/m"))
    };
    assert_eq!(codes(&free("tractive_effort = \"2.3 MN\"")), ["acceleration"]);
    assert_eq!(codes(&free("tractive_effort = \"2 MN\"")), [""; 0]);
    let impact = |speed: &str, damping: &str| {
        let event = format!("kind = \"impact\"\nat = \"tail\"\nvehicles = 3\nspeed = \"{speed}\"");
        let text = SOUND.replace("kind = \"break\"\ncoupler = 5", &event);
        parse(&text.replace("rated_load", &format!("damping = \"{damping} kN*s/m\"\nrated_load")))
    };
    assert_eq!(codes(&impact("41 km/h", "0")), ["speed"]);
    assert_eq!(codes(&impact("39 km/h", "0")), [""; 0]);
    for (speed, damping, jump) in [("2 m/s", "100", "200 kN"), ("0.5 m/s", "500", "250 kN"), ("3 m/s", "1000", "3 MN")]
    {
        let train = impact(speed, damping);
        let [only] = &doubts(&train)[..] else { panic!("{speed}") };
        assert_eq!(only.code, "dashpot-at-contact");
        assert!(
            only.text.contains(&format!("at the instant of contact the dashpot of coupler 58 carries {jump}")),
            "{only}"
        );
        // The force that is computed begins with that jump.
        let start = trainsafe::findings::history(&train, 0, None, 57, &[0.0])[0];
        let right: f64 = speed.trim_end_matches(" m/s").parse::<f64>().expect("a number")
            * 1e3
            * damping.parse::<f64>().expect("one");
        assert!((start + right).abs() < 1e-6 * right, "{start}, right {right}");
    }
}

/// Forces that cancel but for their rounding leave none: in the load, in the acceleration, and in what is told.
#[test]
fn rounding_of_a_cancellation_is_no_load() {
    let probe = |first: &str, others: &str, load: &str| {
        parse(&format!(
            "[coupler]\nstiffness = \"11.1 MN/m\"\nrated_load = \"390 kip\"\n[[vehicle]]\nmass = \"196 t\"\n{first}\n
             [[vehicle]]\ncount = 7\nmass = \"130.3 t\"\n{others}\n{load}"
        ))
    };
    for (first, others, load) in [
        ("", "", "[load]\ngrade = \"1.0 %\""),
        ("", "", "[load]\ngrade = \"-0.7 %\"\nrolling_resistance = \"13 N/t\""),
        ("held = true", "tractive_effort = \"1.9545 kN\"\nrolling_resistance = \"15 N/t\"", ""),
        ("tractive_effort = \"0.3 kN\"\nbrake_force = \"0.3 kN\"", "brake_force = \"0 N\"", ""),
        (
            "",
            "rolling_resistance = \"11 N/t\"\ngrade = \"2 %\"",
            "[load]\ngrade = \"2 %\"\nrolling_resistance = \"11 N/t\"",
        ),
    ] {
        let train = probe(first, others, load);
        assert!(
            train.initial_force_n().iter().all(|f| *f == 0.0),
            "{first} {others} {load}: {:?}",
            train.initial_force_n()
        );
        assert_eq!(codes(&train), ["no-load"]);
        assert!(consist::describe(&train).contains("load before the event: none"));
        let cases = &analyze(&train, &Options::default()).expect("sound").scenarios[0].cases;
        assert!(cases.iter().all(|c| c.safe_load_factor.is_none()));
    }
    // A small force that is real stays: 1 N from the one vehicle that is different.
    let train = probe("", "", "[load]\ngrade = \"1.0 %\"");
    let mut outside_n = train.extras().steady.clone().expect("forces").outside_n;
    outside_n[0] += 1.0;
    let (forces, _, _) = trainsafe::train::steady_forces(train.vehicles(), train.couplers(), &outside_n);
    assert!((forces[0] - 0.823).abs() < 1e-3, "{forces:?}");
}

/// Options that change nothing for a scenario are told, and only they.
#[test]
fn idle_options_are_told() {
    let all = Options { all_time_bound: true, verdict_only: true, map: true, tolerance: 1e-6, ..Options::default() };
    let idle = |train: &Train, options: &Options| -> Vec<String> {
        idle_options(train, options)
            .iter()
            .map(|t| t.split(" does nothing").next().unwrap_or_default().to_owned())
            .collect()
    };
    assert!(idle(&parse(SOUND), &all).is_empty());
    assert!(idle(&with("rated_load", "damping = \"100 kN*s/m\"\nrated_load"), &Options::default()).is_empty());
    let name = "break of coupler 5";
    let some = ["--all-time-bound", "--verdict-only", "--tolerance"].map(|o| format!("{name}: {o}"));
    assert_eq!(idle(&with("rated_load", "damping = \"100 kN*s/m\"\nrated_load"), &all), some);
    assert_eq!(idle(&with("damping_ratio = 0\n", "damping_ratio = 0.05\n"), &all), some);
    let event = "kind = \"impact\"\nat = \"tail\"\nvehicles = 3\nspeed = \"2 m/s\"";
    assert_eq!(idle(&with("kind = \"break\"\ncoupler = 5", event), &all).len(), 4);
    let pulse = "kind = \"pulse\"\nat = \"tail\"\nforce = \"1 kN\"\nduration = \"1 s\"\nshape = \"half-sine\"";
    assert_eq!(idle(&with("kind = \"break\"\ncoupler = 5", pulse), &all).len(), 3);
    // Only of the scenario that is run.
    let two = parse(&format!("{SOUND}[[scenario]]\n{event}"));
    let options = |scenario: &str| Options { scenario: Some(scenario.to_owned()), ..all.clone() };
    assert!(idle(&two, &options(name)).is_empty());
    assert_eq!(idle(&two, &options("impact at the tail")).len(), 4);
}

/// A coupler whose force over all time stays under its rating may pass a lower limit: it is not left out, and that is told.
#[test]
fn the_verdict_alone_does_not_hide_limits_under_the_ratings() {
    let only = Options { verdict_only: true, all_time_bound: true, ..Options::default() };
    let found = |limits: &str| {
        let train = with("rated_load = \"1.2 MN\"", &format!("rated_load = \"9 MN\"\n{limits}"));
        let case = analyze(&train, &only).expect("sound").scenarios.remove(0).cases.remove(0);
        (case, idle_options(&train, &only))
    };
    for limits in [
        "limits = { fatigue = \"0.5 MN\" }",
        "limits.draft = { proof = \"0.6 MN\" }",
        "limits = { fatigue = \"0.5 MN\", ultimate = \"12 MN\" }",
    ] {
        let (case, told) = found(limits);
        assert_eq!((case.left_out, case.couplers.len()), (0, 59), "{limits}");
        // The load passes each of them.
        assert!(case.couplers.iter().all(|c| c.limits.as_ref().is_some_and(|l| l.passed.len() == 1)), "{limits}");
        let [only] = &told[..] else { panic!("{told:?}") };
        assert!(only.starts_with("break of coupler 5: --verdict-only leaves out no coupler"), "{only}");
    }
    // Limits over the ratings are passed by none that stays under its rating.
    for limits in ["limits = { ultimate = \"12 MN\" }", "limits.buff = { fatigue = \"9 MN\" }", ""] {
        let (case, told) = found(limits);
        assert_eq!((case.left_out, told), (59, vec![]), "{limits}");
    }
}

/// The trains that come with the program have no doubt but one, which its file explains.
#[test]
fn the_sample_trains_have_few_doubts() {
    for entry in std::fs::read_dir("trains").expect("the folder").map(|e| e.expect("an entry").path()) {
        let Some(name) = entry.file_stem().filter(|_| entry.extension().is_some_and(|e| e == "toml")) else { continue };
        let found = codes(&consist::read(&entry).unwrap_or_else(|e| panic!("{e}")));
        match name.to_string_lossy() {
            name if name.starts_with("hauled") => assert_eq!(found, ["dashpot-at-contact"], "{name}"),
            name => assert!(found.is_empty(), "{name}: {found:?}"),
        }
    }
    assert!(codes(&parse(consist::TEMPLATE)).is_empty());
}

/// A hauled train with gears whose brakes and tractive efforts change.
const BRAKED: &str = "speed = \"60 km/h\"
[coupler]
gear = [[\"0 mm\", \"0 kN\", \"0 kN\"], [\"80 mm\", \"2 MN\", \"0.5 MN\"]]
solid_stiffness = \"200 MN/m\"
slack = \"10 mm\"
rated_load = \"1.7 MN\"
[[vehicle]]
mass = \"196 t\"
length = \"20 m\"
tractive_effort = \"400 kN\"
[[vehicle]]
count = 10
mass = \"130 t\"
length = \"16 m\"
emergency_brake = \"45 kN\"
[load]
pulled_to = \"0.8 MN\"
[[scenario]]
kind = \"break\"
coupler = 5
emergency = \"UIC P\"
cut_power = { after = \"3 s\", over = \"2 s\" }
horizon = \"20 s\"
";

/// A warning names brakes, tractive efforts and an earlier pull that change nothing, or go on changing after the horizon.
#[test]
fn changes_that_are_not_seen_are_doubted() {
    assert!(codes(&parse(BRAKED)).is_empty());
    for (from, to, expected) in [
        // Brakes are full 4 s after the wave at 250 m/s has reached the farther end, and power is gone after 5 s.
        ("20 s", "6 s", &[][..]),
        ("20 s", "4.5 s", &["changes-beyond-horizon"]),
        ("UIC P", "UIC G", &["changes-beyond-horizon"]),
        ("after = \"3 s\"", "after = \"30 s\"", &["changes-beyond-horizon"]),
        ("\"0.5 MN\"", "\"2 MN\"", &["pulled-to-unused", "slack-without-friction"]),
        ("\"0.5 MN\"", "\"1.985 MN\"", &["faint-friction"]),
        ("80 mm", "550 mm", &["gear-travel"]),
        ("80 mm", "3 mm", &["gear-travel", "soft-solid-stiffness"]),
        ("0.8 MN", "1.8 MN", &["pull-over-rating"]),
        (
            "\"UIC P\"",
            "{ wave = \"250 m/s\", build_up = [[\"0 s\", \"0 %\"], [\"4 s\", \"1 %\"]] }",
            &["faint-build-up"],
        ),
        ("emergency = \"UIC P\"\n", "", &["emergency-brake-unused", "speed-unused"]),
    ] {
        assert!(BRAKED.contains(from), "{from}");
        let mut found = codes(&parse(&BRAKED.replace(from, to)));
        found.sort_unstable();
        assert_eq!(found, expected, "{to}");
    }
    let folder = tempfile::tempdir().expect("a folder");
    let scheduled = BRAKED.replace("cut_power = { after = \"3 s\", over = \"2 s\" }", "throttle = \"level.csv\"");
    for (schedule, expected) in [
        ("time [s],share [%]\n0,100\n10,100\n", &["efforts-unchanged"][..]),
        ("time [s],share [%]\n0,1\n10,0.5\n", &["throttle-jumps", "faint-throttle"]),
        ("time [s],force [N]\n0,400\n10,0\n", &["throttle-jumps", "faint-throttle"]),
        ("time [s],force [kN]\n0,400\n10,0\n", &[]),
    ] {
        std::fs::write(folder.path().join("level.csv"), schedule).expect("a file");
        let train = consist::parse(&scheduled, &folder.path().join("train.toml")).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(codes(&train), expected, "{schedule}");
    }
}

/// Brake forces beside the weight, and the speed of a brake application's wave.
#[test]
fn implausible_brakes_are_doubted() {
    let codes_of = |force: &str, wave: &str| {
        let application =
            format!("emergency = {{ wave = \"{wave}\", build_up = [[\"0 s\", \"0 %\"], [\"4 s\", \"100 %\"]] }}");
        let text = SOUND
            .replace("damping_ratio = 0\n", "speed = \"60 km/h\"\n")
            .replace("length = \"16 m\"\n", &format!("length = \"16 m\"\nemergency_brake = \"{force}\"\n"))
            .replace("coupler = 5\n", &format!("coupler = 5\n{application}\n"));
        codes(&parse(&text))
    };
    assert!(codes_of("30 kN", "290 m/s").is_empty());
    for force in ["30 N", "1.2 MN"] {
        assert_eq!(codes_of(force, "290 m/s"), ["brake-force"], "{force}");
    }
    for wave in ["0.29 m/s", "290000 m/s"] {
        assert!(codes_of("30 kN", wave).contains(&"brake-wave"), "{wave}");
    }
}
