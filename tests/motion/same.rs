//! What a train file may have beyond the paper changes nothing where it is absent, or zero.

use std::path::Path;

use trainsafe::{Options, analyze, consist, report};

fn result(text: &str) -> String {
    let train = consist::parse(text, Path::new("a.toml")).unwrap_or_else(|e| panic!("{e}"));
    let mut analysis = analyze(&train, &Options::default()).expect("sound");
    for case in analysis.scenarios.iter_mut().flat_map(|s| &mut s.cases) {
        case.run_time_s = 0.0;
    }
    report::json(&analysis).expect("JSON")
}

/// No dashpot and no cascade, said or left unsaid, are the same to the last bit: the same text with all digits.
#[test]
fn damping_of_zero_and_no_cascade_change_no_bit() {
    let text = |coupler: &str, scenario: &str| {
        format!(
            "[coupler]\nstiffness = \"30 MN/m\"\nrated_load = \"1.5 MN\"\n{coupler}\n[[vehicle]]\nmass = \"195 t\"\n
             [[vehicle]]\nmass = \"80 t\"\ncount = 30\n[load]\nuniform = \"0.6 MN\"\n[[scenario]]\nkind = \"break\"\n
             coupler = [3, 17]\n{scenario}\n[[scenario]]\nkind = \"pulse\"\nat = \"tail\"\nforce = \"1 MN\"\n
             duration = \"80 ms\"\n{scenario}"
        )
    };
    let plain = result(&text("", ""));
    assert_eq!(plain, result(&text("damping = \"0 kN*s/m\"", "cascade = false")));
    assert_ne!(plain, result(&text("damping = \"1 N*s/m\"", "")), "a dashpot does");
    // A cascade adds its own findings and leaves the others as they are.
    let cascade = result(&text("", "cascade = true"));
    let without: Vec<&str> = plain.lines().map(|l| l.trim_end_matches(',')).collect();
    let mut lines = cascade.lines().map(|l| l.trim_end_matches(','));
    assert!(without.iter().all(|line| lines.any(|l| l == *line)));
}
