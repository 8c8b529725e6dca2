//! The default horizon covers the force, and a given one that does not is doubted in the right words.

use std::path::Path;

use trainsafe::doubts::doubts;
use trainsafe::scenario::{horizon_s, last_change_s, wave};
use trainsafe::units::shown_time;
use trainsafe::{Options, Train, analyze, consist};

fn parse(text: &str, dir: &Path) -> Train {
    consist::parse(text, &dir.join("train.toml")).unwrap_or_else(|e| panic!("{e}"))
}

/// Seventy wagons behind a locomotive that is pushed on.
fn wagons(scenario: &str) -> String {
    format!(
        "[coupler]\nstiffness = \"25.7 MN/m\"\nrated_load = \"500 kN\"\nrated_buff = \"1 MN\"\n
         [[vehicle]]\nlabel = \"locomotive\"\nmass = \"184 t\"\n[[vehicle]]\nlabel = \"wagon\"\ncount = 70\nmass = \"85 t\"\n
         [[scenario]]\nkind = \"pulse\"\nat = \"head\"\n{scenario}"
    )
}

const RAMP: &str = "force = \"600 kN\"\nduration = \"120 s\"\nshape = \"trapezoid\"\nrise = \"30 s\"\nfall = \"1 s\"\n";

/// A slow ramp: quasi-statically coupler 1 carries 600 kN times 5,950 t over 6,134 t, 582 kN.
#[test]
fn a_slow_ramp_is_followed_to_its_end() {
    let train = parse(&wagons(RAMP), Path::new(""));
    let case = analyze(&train, &Options::default()).expect("sound").scenarios.remove(0).cases.remove(0);
    assert!((case.horizon_s - 120.0 - 4.0 * wave(&train).transit_s).abs() < 1e-9);
    assert_eq!(case.exceeding, 13);
    let worst = case.worst.expect("couplers");
    assert_eq!((worst.coupler, (100.0 * worst.utilisation).round()), (1, 117.0));
    assert!((582e3..600e3).contains(&worst.peak_force_n));
    assert!((case.safe_load_factor.expect("bounded") - 0.853).abs() < 1e-3);
    assert!(doubts(&train).is_empty());
}

/// The last change is the end of every shape; of a record, where it becomes 0 for good.
#[test]
fn every_shape_is_covered() {
    let dir = tempfile::tempdir().expect("a folder");
    let record = |name: &str, rows: &str| std::fs::write(dir.path().join(name), format!("time_s,force_kn\n{rows}"));
    record("quiet.csv", "0,0\n2,300\n7,300\n9,0\n60,0\n").expect("written");
    record("cut.csv", "0,0\n2,300\n40,250\n").expect("written");
    record("late.csv", "0,0\n50,0\n50.1,600\n52,600\n52.1,0\n").expect("written");
    for (scenario, change_s) in [
        ("force = \"100 kN\"\nduration = \"33 s\"", 33.0),
        ("force = \"100 kN\"\nduration = \"21 s\"\nshape = \"half-sine\"", 21.0),
        ("force = \"100 kN\"\nduration = \"18 s\"\nshape = \"triangle\"", 18.0),
        (RAMP, 120.0),
        ("record = \"quiet.csv\"", 9.0),
        ("record = \"cut.csv\"", 40.0),
        ("record = \"late.csv\"", 52.1),
    ] {
        let train = parse(&wagons(scenario), dir.path());
        let only = &train.scenarios()[0];
        assert_eq!(last_change_s(&train, only, None), change_s, "{scenario}");
        let beyond = horizon_s(&train, only, None) - change_s;
        assert!((beyond / (4.0 * wave(&train).transit_s) - 1.0).abs() < 1e-12, "{scenario}");
        let codes: Vec<&str> = doubts(&train).iter().map(|d| d.code).collect();
        let expected: &[&str] = if scenario.contains("cut") { &["record-ends-at-a-force"] } else { &[] };
        assert_eq!(codes, expected, "{scenario}");
    }
    let event = "[[scenario]]\nkind = \"impact\"\nat = \"tail\"\nvehicles = 2\nspeed = \"1 m/s\"";
    let train = parse(&(wagons(RAMP) + event + "\n[[scenario]]\nkind = \"break\"\ncoupler = 3"), dir.path());
    assert_eq!([1, 2].map(|i| last_change_s(&train, &train.scenarios()[i], None)), [0.0, 0.0]);
}

/// A given horizon that ends too early: what is not seen is named, with a horizon that covers it.
#[test]
fn what_a_short_horizon_does_not_see_is_told() {
    let dir = tempfile::tempdir().expect("a folder");
    let rows = "time_s,force_kn\n0,0\n50,0\n60,600\n70,600\n71,0\n";
    std::fs::write(dir.path().join("late.csv"), rows).expect("written");
    for (scenario, told) in [
        ("record = \"late.csv\"\nhorizon = \"20 s\"", "begins after the horizon of 20 s"),
        ("record = \"late.csv\"\nhorizon = \"59 s\"", "has not reached its largest value at the horizon of 59 s"),
        ("record = \"late.csv\"\nhorizon = \"70.5 s\"", "lasts longer than the horizon of 70.5 s"),
        (&format!("{RAMP}horizon = \"20 s\""), "has not reached its largest value"),
        (&format!("{RAMP}horizon = \"100 s\""), "lasts longer than the horizon"),
        (
            "force = \"1 kN\"\nduration = \"50 s\"\nshape = \"half-sine\"\nhorizon = \"24 s\"",
            "has not reached its largest",
        ),
        ("force = \"1 kN\"\nduration = \"50 s\"\nhorizon = \"24 s\"", "lasts longer than the horizon"),
    ] {
        let free = parse(&wagons(scenario), dir.path());
        let found = doubts(&free);
        let [beyond, endless] = &found[..] else { panic!("{scenario}: {found:?}") };
        assert_eq!((beyond.code, endless.code), ("pulse-beyond-horizon", "force-never-ends"));
        assert!(beyond.text.contains(told) && beyond.text.contains("covers it"), "{beyond}");
        let held = wagons(scenario).replace("\"head\"", "\"tail\"").replacen(
            "mass = \"184 t\"",
            "mass = \"184 t\"\nheld = true",
            1,
        );
        let codes: Vec<&str> = doubts(&parse(&held, dir.path())).iter().map(|d| d.code).collect();
        assert_eq!(codes, ["pulse-beyond-horizon"], "{scenario}");
    }
}

/// A given horizon that ends before the first passage does gives one doubt, which names the end of the passage; other horizons give none.
#[test]
fn a_horizon_within_the_first_passage_is_told() {
    let pulse = "force = \"1 kN\"\nduration = \"2 s\"\n";
    let free = parse(&wagons(pulse), Path::new(""));
    let passage_s = 2.0 + 2.0 * wave(&free).transit_s;
    let found = |horizon_s: f64| {
        let train = parse(&wagons(&format!("{pulse}horizon = \"{horizon_s} s\"\n")), Path::new(""));
        doubts(&train)
    };
    let only = found(passage_s - 0.01);
    let [only] = &only[..] else { panic!("{only:?}") };
    assert_eq!(only.code, "horizon-in-first-passage");
    let told = format!("ends before the first passage does, at {}: a larger force can follow", shown_time(passage_s));
    assert!(only.text.ends_with(&told), "{only}");
    assert!(found(passage_s + 0.01).is_empty());
    let short = found(0.9 * wave(&free).transit_s);
    assert!(short.iter().any(|d| d.code == "short-horizon"), "{short:?}");
    assert!(short.iter().all(|d| d.code != "horizon-in-first-passage"), "{short:?}");
    assert!(doubts(&free).is_empty());
}
