//! More than one capacity: which of them each coupler passes.

use std::path::Path;

use trainsafe::{Options, analyze, consist};

/// One vehicle behind a held head under a force step P: its coupler carries P (1 - cos t), at most 2 P.
#[test]
fn the_largest_force_of_either_sense_counts() {
    let passed = |limits: &str, load: &str| {
        let text = format!(
            "[coupler]\nstiffness = \"1 N/m\"\nrated_load = \"9 N\"\nlimits = {limits}\n[[vehicle]]\nmass = \"1 kg\"\n
             held = true\n[[vehicle]]\nmass = \"1 kg\"\n[load]\nuniform = \"{load}\"\n[[scenario]]\nkind = \"pulse\"\n
             at = 2\nforce = \"-1 N\"\nduration = \"100 s\"\nhorizon = \"20 s\""
        );
        let train = consist::parse(&text, Path::new("a.toml")).unwrap_or_else(|e| panic!("{e}"));
        let analysis = analyze(&train, &Options::default()).expect("sound");
        let limits = analysis.scenarios[0].cases[0].couplers[0].limits.clone().expect("limits");
        (limits.passed, limits.undecided)
    };
    let limits = "{ fatigue = \"1.5 N\", proof = \"1.999 N\", ultimate = \"2.001 N\" }";
    assert_eq!(passed(limits, "0 N"), (vec!["fatigue", "proof"], vec![]));
    // Preloaded with -2 N it swings between -2 and 0.
    assert_eq!(passed(limits, "-2.0005 N"), (vec!["fatigue", "proof"], vec![]));
    assert_eq!(passed("{ proof = \"2 N\" }", "0 N"), (vec![], vec!["proof"]), "within the error bound of the peak");
    // It comes back to the -2 N that it had before, as near as can be told.
    assert_eq!(passed("{ proof = \"2 N\" }", "-2 N"), (vec![], vec!["proof"]));
}

/// An override replaces the limits that it names and keeps the others.
#[test]
fn overrides_of_limits() {
    let text = "[coupler]\nstiffness = \"1 N/m\"\nrated_load = \"9 N\"\nlimits = { fatigue = \"1 N\", proof = \"2 N\" }
        [[vehicle]]\ncount = 3\nmass = \"1 kg\"\n[[coupler_override]]\nat = 2\nlimits = { proof = \"3 N\" }";
    let train = consist::parse(text, Path::new("a.toml")).unwrap_or_else(|e| panic!("{e}"));
    let limits = [[Some(1.0), Some(2.0), None], [Some(1.0), Some(3.0), None]].map(trainsafe::train::Limits::both);
    assert_eq!(train.extras().limits, limits);
}
