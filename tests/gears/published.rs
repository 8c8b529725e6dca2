//! The numbers of `reports/published-case.md`.

use std::path::Path;

use trainsafe::law::Law;
use trainsafe::{Options, analyze, consist};

/// Largest buff of each scenario of a train of the report, kN.
fn largest_kn(name: &str) -> Vec<f64> {
    let path = Path::new("reports/published-case").join(name).with_extension("toml");
    let train = consist::read(&path).unwrap_or_else(|e| panic!("{e}"));
    let analysis = analyze(&train, &Options::default()).expect("sound");
    let of = |s: &trainsafe::findings::ScenarioFindings| -s.cases[0].worst.as_ref().expect("a coupler").peak_force_n;
    analysis.scenarios.iter().map(|s| of(s) / 1e3).collect()
}

#[test]
fn ratings_as_impacts() {
    const KIP_KN: f64 = 4.4482216152605;
    let kip = |name: &str| largest_kn(name).into_iter().map(|kn| kn / KIP_KN).collect::<Vec<f64>>();
    for (name, want) in [
        ("tf-880-sample-table", [419.3, 481.4]),
        ("tf-880-rating", [524.0, 625.0]),
        ("tf-880-rating-rigid", [565.6, 6250.3]),
    ] {
        let got = kip(name);
        assert!(got.iter().zip(want).all(|(a, b)| (a - b).abs() < 0.051), "{name}: {got:?}");
    }
    for (name, want) in [("mt-2-sample-table", 1945.0), ("buffers-a-sample-table", 1569.0)] {
        let got = largest_kn(name);
        assert!((got[0] - want).abs() < 0.51, "{name}: {got:?}");
    }
}

/// Work in a full stroke, kJ, as the head of each sample table says.
#[test]
fn sample_tables_take_the_work_that_they_say() {
    for (name, want) in
        [("aar-friction-pair", 158.0), ("mt-2-pair", 102.0), ("elastomer-pair", 107.0), ("uic-buffers", 108.0)]
    {
        let text = format!(
            "[coupler]\ngear = \"trains/gears/{name}.csv\"\nsolid_stiffness = \"200 MN/m\"\nrated_load = \"2 MN\"\n{}[[vehicle]]\ncount = \
             2\nmass = \"90 t\"\n",
            if name == "mt-2-pair" { "friction = \"82 %\"\n" } else { "" }
        );
        let train = consist::parse(&text, Path::new("a.toml")).unwrap_or_else(|e| panic!("{e}"));
        let Law::Gear { draft, .. } = &train.extras().laws[0] else { panic!("{name} is a gear") };
        let work = |p: &[trainsafe::law::GearRow]| {
            0.5e-3 * (p[0].loading_n + p[1].loading_n) * (p[1].travel_m - p[0].travel_m)
        };
        let work_kj: f64 = draft.rows().windows(2).map(work).sum();
        assert!((work_kj - want).abs() < 0.51, "{name}: {work_kj}");
        assert!(
            std::fs::read_to_string(format!("trains/gears/{name}.csv"))
                .expect("a table")
                .contains(&format!("{want} kJ"))
        );
    }
}
