//! The map: overloading force against duration, safe load against the coupler that breaks.

use std::fs;
use std::path::Path;

use trainsafe::findings::MapFindings;
use trainsafe::{Analysis, Options, Train, analyze, consist, report};

fn mapped(text: &str) -> (Train, Analysis) {
    let train = consist::parse(text, Path::new("a.toml")).unwrap_or_else(|e| panic!("{e}"));
    let analysis = analyze(&train, &Options { map: true, ..Options::default() }).expect("sound");
    (train, analysis)
}

fn map(analysis: &Analysis) -> &MapFindings {
    analysis.scenarios[0].map.as_ref().expect("a map")
}

/// One vehicle behind a held head, k = m = 1: a rectangle of P and T makes at most 2 P sin(T / 2), and 2 P from T = pi on. A half
/// sine of the same spring in the limit of short ones is an impulse of 2 / pi P T.
#[test]
fn of_one_spring() {
    let text = |shape: &str| {
        format!(
            "[coupler]\nstiffness = \"1 N/m\"\nrated_load = \"1 N\"\n[[vehicle]]\nmass = \"1 kg\"\nheld = true\n[[vehicle]]\n
             mass = \"1 kg\"\n[[scenario]]\nkind = \"pulse\"\nat = \"tail\"\nforce = \"-3 N\"\nduration = \"1 s\"\n
             shape = \"{shape}\"\nhorizon = \"9 s\""
        )
    };
    let (_, rectangle) = mapped(&text("rectangle"));
    let points = &map(&rectangle).points;
    assert!((points[0].at - 0.1).abs() < 1e-15 && (points.last().map(|p| p.at) == Some(2.0)));
    for p in points {
        let expected = -1.0 / (2.0 * (0.5 * p.at).sin());
        let found = p.chain.expect("bounded");
        // The peaks are within 1e-12 of a force of 1.
        assert!((found / expected - 1.0).abs() < 1e-11, "{p:?} {expected}");
    }
    let (_, sine) = mapped(&text("half-sine"));
    let first = map(&sine).points[0];
    let impulse = -std::f64::consts::PI / (2.0 * first.at);
    // The next term of sin over a duration of 0.1 is under its square.
    assert!((first.chain.expect("bounded") / impulse - 1.0).abs() < 0.01, "{first:?} {impulse}");
}

/// Of each break the map gives the case's own safe factor, whichever couplers the scenario names; and the report shows it.
#[test]
fn of_breaks() {
    let text = |coupler: &str| {
        format!(
            "[coupler]\nstiffness = \"30 MN/m\"\nrated_load = \"1.5 MN\"\n[[vehicle]]\nmass = \"160 t\"\ncount = 9\n[load]\n
             uniform = \"0.6 MN\"\n[[scenario]]\nkind = \"break\"\ncoupler = {coupler}"
        )
    };
    let (_, each) = mapped(&text("\"each\""));
    let (train, one) = mapped(&text("3"));
    assert_eq!(map(&one), map(&each));
    for (p, case) in map(&one).points.iter().zip(&each.scenarios[0].cases) {
        assert_eq!((p.at, p.chain), (case.broken_coupler.unwrap_or(0) as f64, case.safe_load_factor));
        // A rod's forces never pass what the load makes at rest.
        assert_eq!(p.rod, Some(2.5));
    }
    let dir = tempfile::tempdir().expect("a folder");
    report::write(&train, &one, dir.path(), &report::Format::ALL).expect("written");
    let rows = fs::read_to_string(dir.path().join("map-1.csv")).expect("the map");
    assert_eq!(rows.lines().count(), 9);
    assert!(rows.starts_with("broken_coupler,safe_load_factor,rod\n1,"), "{rows}");
    let text = fs::read_to_string(dir.path().join("report.md")).expect("the report");
    assert!(text.contains("](figure-1-map.svg)") && dir.path().join("figure-1-map.svg").exists());
}
