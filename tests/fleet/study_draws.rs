//! Draws: a distribution that lies where its key cannot be is refused, a probability says how many draws it rests on, and vehicles of
//! a group have draws of their own.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;

use crate::fleets::{complaint, fleet, rows};
use tempfile::TempDir;

const TRAIN: &str = r#"
name = "plain"
[coupler]
stiffness = "11.1 MN/m"
rated_load = "1.2 MN"
[[vehicle]]
label = "loco"
mass = "196 t"
held = true
[[vehicle]]
label = "car"
count = 3
mass = "120 t"
brake_force = "10 kN"
[[vehicle]]
mass = "100 t"
[[scenario]]
kind = "pulse"
at = "tail"
force = "700 kN"
duration = "0.2 s"
"#;

fn folder(train: &str, head: &str, vary: &str) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("train.toml"), train).expect("a train file");
    let study = format!("trains = [\"train.toml\"]\n{head}[[vary]]\n{vary}");
    fs::write(folder.path().join("study.toml"), study).expect("a study file");
    folder
}

/// The first line and the help of what is said of a study that is refused.
fn refusal(head: &str, vary: &str) -> [String; 2] {
    let folder = folder(TRAIN, head, vary);
    let output = fleet(folder.path(), &["study.toml", "--out", "out"]);
    assert_eq!(output.status.code(), Some(2), "{vary}: {}", complaint(&output));
    assert!(!folder.path().join("out").exists());
    let text = complaint(&output);
    let help = text.lines().find_map(|line| line.split_once("= help: "));
    [text.lines().next().unwrap_or_default().to_owned(), help.map_or(String::new(), |(_, help)| help.to_owned())]
}

#[test]
fn a_distribution_that_lies_where_its_key_cannot_be_is_refused_with_the_share() {
    // The normal distribution function at -4/3 and -4.7: 0.091211 and 1.3008e-6 (Abramowitz and Stegun, table 26.1 and 26.2).
    let cases = [
        (
            "coupler.rated_load",
            "\"normal\"\nmean = \"1.2 MN\"\nsd = \"0.9 MN\"",
            "9.12 %",
            "zero or below",
            "rated_load",
        ),
        ("vehicle[1].mass", "\"normal\"\nmean = \"94 t\"\nsd = \"20 t\"", "0.000130 %", "zero or below", "mass"),
        (
            "coupler.stiffness",
            "\"uniform\"\nlow = \"-1 MN/m\"\nhigh = \"9 MN/m\"",
            "10.0 %",
            "zero or below",
            "stiffness",
        ),
        // Below zero lies 1 / (4 * 2) of it.
        (
            "coupler.rated_buff",
            "\"triangular\"\nlow = \"-1 MN\"\nmode = \"1 MN\"\nhigh = \"3 MN\"",
            "12.5 %",
            "zero or below",
            "rated_buff",
        ),
        (
            "vehicle[1].brake_force",
            "\"triangular\"\nlow = \"-3 kN\"\nmode = \"-1 kN\"\nhigh = \"1 kN\"",
            "87.5 %",
            "below zero",
            "brake_force",
        ),
        // 1 - exp(-(1/2)^2)
        (
            "vehicle[1].length",
            "\"weibull\"\nlocation = \"-5 m\"\nscale = \"10 m\"\nshape = 2",
            "22.1 %",
            "zero or below",
            "length",
        ),
    ];
    for (key, law, share, what, leaf) in cases {
        let [title, help] = refusal("samples = 200\n", &format!("key = \"{key}\"\ndistribution = {law}\n"));
        assert_eq!(title, format!("error: {share} of this distribution is {what}, where no {leaf} can be"));
        assert_eq!(help, "use one that stays above zero: lognormal, weibull, or triangular with low above zero");
    }
}

#[test]
fn a_value_that_its_key_cannot_have_is_refused_at_its_place() {
    let cases = [
        ("samples = 9\n", "key = \"coupler.rated_load\"\nvalues = [\"1 MN\", \"-1 MN\"]\n", "values is negative"),
        ("", "key = \"vehicle[1].mass\"\nvalues = [\"0 t\"]\n", "values is zero"),
        ("", "key = \"coupler.damping\"\nfrom = \"-1 kN*s/m\"\nto = \"9 kN*s/m\"\nsteps = 3\n", "from is negative"),
    ];
    for (head, vary, expected) in cases {
        assert_eq!(refusal(head, vary)[0], format!("error: {expected}"));
    }
    let [title, _] = refusal("", "key = \"coupler.rated_load\"\nvalues = [\"80 %\"]\n");
    assert!(title.starts_with("error: values "), "{title}");
}

/// Signed quantities may be negative; a trace below zero is told, and its draws are possible ones.
#[test]
fn a_trace_is_drawn_as_a_possible_value_and_told() {
    let vary = "key = \"coupler.rated_load\"\ndistribution = \"normal\"\nmean = \"1 MN\"\nsd = \"0.2 MN\"\n";
    let folder_of_trace = folder(TRAIN, "samples = 50\n", vary);
    let output = fleet(folder_of_trace.path(), &["study.toml", "--out", "out"]);
    assert!(output.status.success(), "{}", complaint(&output));
    // The normal distribution function at -5 is 2.87e-7.
    let note = "note: 2.9e-7 of the distribution of coupler.rated_load is below zero, where it cannot be: its lowest 5.7e-7 is \
                drawn as one value above zero\n";
    assert!(complaint(&output).contains(note), "{}", complaint(&output));
    let signed = "key = \"vehicle[1].tractive_effort\"\ndistribution = \"normal\"\nmean = \"0 N\"\nsd = \"5 kN\"\n";
    let folder = folder(TRAIN, "samples = 50\n", signed);
    let output = fleet(folder.path(), &["study.toml", "--out", "out"]);
    assert!(output.status.success() && !complaint(&output).contains("note"), "{}", complaint(&output));
}

/// A trapezoid of 100 ms with 80 ms for rise and fall together is none if it is drawn shorter than that: one draw in four of a Latin
/// hypercube from 60 ms to 140 ms.
#[test]
fn a_probability_says_how_many_draws_it_rests_on() {
    let train = TRAIN
        .replace("duration = \"0.2 s\"", "duration = \"100 ms\"\nshape = \"trapezoid\"\nrise = \"40 ms\"")
        .replace("700 kN", "90 MN");
    let vary = "key = \"scenario[0].duration\"\ndistribution = \"uniform\"\nlow = \"60 ms\"\nhigh = \"140 ms\"\n";
    let folder = folder(&train, "samples = 40\nlatin_hypercube = true\n", vary);
    let output = fleet(folder.path(), &["study.toml", "--out", "out", "--format", "csv,md,html"]);
    assert_eq!(output.status.code(), Some(3), "{}", complaint(&output));
    assert_eq!(rows(&folder.path().join("out/errors.csv")).len(), 10);
    let sentence = "Probability of an exceedance: 75.0 to 100 % (30 of 40 draws, 30 of which could be computed; 95 % confidence: \
                    58.8 to 100 %).";
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(told.contains(sentence), "{told}");
    let [report, page] = ["fleet.md", "fleet.html"]
        .map(|name| fs::read_to_string(folder.path().join("out").join(name)).expect("a report"));
    assert!(report.contains(sentence) && page.contains(sentence), "{report}");
    assert!(report.contains("| plain | 75.0 to 100 % | 58.8 to 100 % | 30 | 30 of 40 |"), "{report}");
}

/// Three cars with one of two masses each are one of eight trains, which are written by hand.
#[test]
fn each_vehicle_of_a_group_has_a_draw_of_its_own() {
    let vary = "key = \"vehicle[1].mass\"\nper = \"vehicle\"\nvalues = [\"60 t\", \"90 t\"]\n[[vary]]\nkey = \
                \"vehicle[2].mass\"\nvalues = [\"50 t\"]\n";
    let folder = folder(TRAIN, "samples = 100\nseed = 3\n", vary);
    let output = fleet(folder.path(), &["study.toml", "--out", "out"]);
    assert!(output.status.success(), "{}", complaint(&output));
    let mut by_hand = BTreeMap::new();
    for mask in 0..8 {
        let car = |i: usize| {
            let mass = if mask & (1 << i) == 0 { 60 } else { 90 };
            format!("[[vehicle]]\nlabel = \"car\"\nmass = \"{mass} t\"\nbrake_force = \"10 kN\"\n")
        };
        let (before, rest) = TRAIN.split_once("[[vehicle]]\nlabel = \"car\"").expect("the cars");
        let (_, after) = rest.split_once("[[vehicle]]").expect("the last vehicle");
        let text = before.to_owned() + &car(0) + &car(1) + &car(2) + "[[vehicle]]" + &after.replace("100 t", "50 t");
        fs::write(folder.path().join(format!("hand-{mask}.toml")), text).expect("a train");
    }
    let output = fleet(folder.path(), &["hand-*.toml", "--out", "hand"]);
    assert!(output.status.success(), "{}", complaint(&output));
    for (mask, row) in rows(&folder.path().join("hand/fleet.csv")).into_iter().enumerate() {
        let smallest = if mask == 7 { "90000.0" } else { "60000.0" };
        by_hand
            .insert((row["peak_force_n"].clone(), row["peak_time_s"].clone(), row["between_front"].clone()), smallest);
    }
    assert_eq!(by_hand.len(), 8);
    let mut met = BTreeSet::new();
    for row in rows(&folder.path().join("out/fleet.csv")) {
        let key = (row["peak_force_n"].clone(), row["peak_time_s"].clone(), row["between_front"].clone());
        assert_eq!(by_hand.get(&key), Some(&&*row["vehicle[1].mass [kg], smallest"]), "{row:?}");
        met.insert(key);
    }
    assert_eq!(met.len(), 8, "a hundred draws of eight trains miss one in 80 000 times");
}

/// The brakes of three cars, drawn apart, add up to the force in the coupler behind the locomotive.
#[test]
fn forces_and_masses_are_drawn_apart_together() {
    let vary = "key = \"vehicle[1].brake_force\"\nper = \"vehicle\"\ndistribution = \"uniform\"\nlow = \"10 kN\"\nhigh = \"20 \
                kN\"\n[[vary]]\nkey = \"vehicle[1].mass\"\nper = \"vehicle\"\nvalues = [\"80 t\", \"82 t\"]\n";
    let train = TRAIN.replace(
        "kind = \"pulse\"\nat = \"tail\"\nforce = \"700 kN\"\nduration = \"0.2 s\"",
        "kind = \"break\"\ncoupler = 4",
    );
    let folder = folder(&train, "samples = 60\n", vary);
    let output = fleet(folder.path(), &["study.toml", "--out", "out"]);
    assert!(output.status.success(), "{}", complaint(&output));
    let mut sums = BTreeSet::new();
    for row in rows(&folder.path().join("out/fleet.csv")) {
        let [force, least] = ["initial_force_n", "vehicle[1].brake_force [N], smallest"]
            .map(|c| row[c].parse::<f64>().expect("a number"));
        assert_eq!(row["worst_coupler"], "1");
        assert!(3.0 * least < force && force < least + 40e3, "{row:?}");
        sums.insert(row["initial_force_n"].clone());
    }
    assert_eq!(sums.len(), 60);
}

#[test]
fn draws_per_vehicle_of_other_keys_are_refused() {
    let right = "only quantities of a [[vehicle]] have per = \"vehicle\", such as vehicle[1].mass";
    let draws = "per = \"vehicle\"\nvalues = [\"1 kN\"]\n";
    for key in ["load.uniform", "coupler.rated_load", "scenario[0].force"] {
        let found = refusal("samples = 9\n", &format!("key = \"{key}\"\n{draws}"));
        assert_eq!(found, [format!("error: {key} is no key of every vehicle"), right.to_owned()]);
    }
    let found = refusal("", &format!("key = \"vehicle[1].brake_force\"\n{draws}"));
    assert_eq!(found, ["error: every vehicle has its own value only in draws", "add samples = 10000"]);
}
