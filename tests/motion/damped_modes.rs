//! Modes that are all damped alike, against a closed form and 40-digit arithmetic (`tests/reference/modal_damping.py`).

use std::path::Path;

use serde_json::Value;
use trainsafe::chain::{Chain, Scene};
use trainsafe::solve::damped_modes::Damped;
use trainsafe::{Options, analyze, consist};

fn number(value: &Value) -> f64 {
    value.as_f64().or_else(|| value.as_str()?.parse().ok()).expect("a number")
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(number).collect()
}

/// Every force is within its bound of the exact one; the reference's numbers in doubles cost half a last place each.
#[test]
fn forces_are_within_their_bound() {
    let cases: Vec<Value> = serde_json::from_str(include_str!("../reference/modal_damping.json")).expect("JSON");
    assert_eq!(cases.len(), 4);
    for case in &cases {
        let name = case["name"].as_str().unwrap_or_default();
        let initial = numbers(&case["initial"]);
        let scene = Scene {
            chain: Chain {
                mass: numbers(&case["mass"]),
                stiffness: numbers(&case["stiffness"]),
                held_head: case["held_head"] == true,
                held_tail: false,
            },
            source: number(&case["source"]) as usize,
            force: number(&case["force"]),
            duration: number(&case["duration"]),
            rated_draft: vec![9.0; initial.len()],
            rated_buff: vec![9.0; initial.len()],
            initial,
            horizon: number(&case["horizon"]),
        };
        let damped = Damped::new(&scene, number(&case["ratio"]));
        let bound = damped.error_bound() + 1e-15;
        assert!(bound < 1e-13 * scene.force.abs().max(1.0), "{name}: {bound:e}");
        let ([peaks, _], _) = damped.peaks(None);
        for (i, exact) in case["peaks"].as_array().expect("peaks").iter().enumerate() {
            for (side, exact) in [peaks[i].draft, peaks[i].buff].iter().zip(numbers(exact)) {
                let found = side.best.value.max(0.0);
                assert!((found - exact).abs() < bound, "{name}: {i}: {found} is not {exact} within {bound:e}");
            }
        }
        let times = numbers(&case["times"]);
        for i in 0..scene.initial.len() {
            for (row, f) in case["samples"].as_array().expect("rows").iter().zip(damped.history(i, &times)) {
                assert!((f - number(&row[i])).abs() < bound, "{name}: {i}: {f} is not {}", row[i]);
            }
        }
    }
}

/// One vehicle behind a held head, through the train file: the first overshoot of a step is `1 + e^(-pi z / sqrt(1 - z^2))`.
#[test]
fn overshoot_of_one_spring() {
    for z in [0.02f64, 0.14, 0.26] {
        let text = format!(
            "damping_ratio = {z}\n[coupler]\nstiffness = \"1 N/m\"\nrated_load = \"9 N\"\n[[vehicle]]\nmass = \"1 kg\"\n
             held = true\n[[vehicle]]\nmass = \"1 kg\"\n[[scenario]]\nkind = \"pulse\"\nat = \"tail\"\nforce = \"-1 N\"\n
             duration = \"90 s\"\nhorizon = \"9 s\""
        );
        let train = consist::parse(&text, Path::new("a.toml")).unwrap_or_else(|e| panic!("{e}"));
        let case = &analyze(&train, &Options::default()).expect("sound").scenarios[0].cases[0];
        let root = (1.0 - z * z).sqrt();
        let expected = 1.0 + (-std::f64::consts::PI * z / root).exp();
        let found = case.couplers[0].peak_draft_n.expect("in draft");
        assert!((found - expected).abs() < case.error_bound_n + 4e-16, "{z}: {found} {expected}");
        assert_eq!(case.method, "damped-modes");
    }
}
