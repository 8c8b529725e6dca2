//! Studies: what is varied is what the train file would say, and probabilities are those of closed forms.

use std::collections::HashSet;
use std::fs;
use std::path::Path;

use crate::fleets::{complaint, fleet, rows};
use tempfile::TempDir;
use trainsafe::fleet::spread::Distribution;

/// One car between a held locomotive and the coupler that breaks: the force in coupler 1 is then `load * cos(w t)`, which
/// within half a period goes from the load in draft to the load in buff and no further.
const ONE_CAR: &str = r#"
name = "one car"
[coupler]
stiffness = "30 MN/m"
rated_load = "9 MN"
rated_buff = "9 MN"
[[vehicle]]
mass = "100 t"
held = true
[[vehicle]]
mass = "80 t"
[[vehicle]]
mass = "80 t"
[load]
uniform = "600 kN"
[[scenario]]
kind = "break"
coupler = 2
horizon = "1 s"
"#;

fn folder_with(train: &str, study: &str) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("train.toml"), train).expect("a train file");
    fs::write(folder.path().join("study.toml"), study).expect("a study file");
    folder
}

/// How many of a study's variations have an exceedance, and how many there are, no two of them alike.
fn exceedances(folder: &Path) -> (usize, usize) {
    let output = fleet(folder, &["study.toml", "--out", "out"]);
    assert!(output.status.success(), "{}", complaint(&output));
    let rows = rows(&folder.join("out/fleet.csv"));
    let draws: HashSet<&str> =
        rows.iter().flat_map(|row| row.iter().filter(|(k, _)| k.contains('[')).map(|c| &**c.1)).collect();
    assert_eq!(draws.len(), rows.len());
    (rows.iter().filter(|row| row["exceeding"] != "0").count(), rows.len())
}

/// Strengths in buff by each law, with the probability that one is under 600 kN.
fn laws() -> [(&'static str, f64); 5] {
    // The normal distribution function at -1 and 0.5, from tables of ten digits (M. Abramowitz and I. A. Stegun, *Handbook of
    // Mathematical Functions* (1964), table 26.1).
    let (below_minus_one, below_half) = (0.158_655_253_9, 0.691_462_461_3);
    // The lognormal law whose logarithm has mean ln(600 kN) - 0.05 and deviation 0.1.
    [
        ("distribution = \"normal\"\nmean = \"700 kN\"\nsd = \"100 kN\"", below_minus_one),
        ("distribution = \"uniform\"\nlow = \"500 kN\"\nhigh = \"900 kN\"", 0.25),
        ("distribution = \"triangular\"\nlow = \"500 kN\"\nmode = \"700 kN\"\nhigh = \"1 MN\"", 0.1),
        ("distribution = \"weibull\"\nscale = \"800 kN\"\nshape = 4", 1.0 - (-(0.75f64.powi(4))).exp()),
        ("distribution = \"lognormal\"\nmean = \"573.592437 kN\"\nsd = \"57.50312 kN\"", below_half),
    ]
}

/// A Latin hypercube puts one draw in each of n strata of equal probability, so a share p of a single input is hit to within
/// one of n p, whatever the seed.
#[test]
fn each_law_has_its_share_below_the_peak() {
    for (seed, (law, p)) in laws().into_iter().enumerate() {
        let n = 1000;
        let study = format!(
            "trains = [\"train.toml\"]\nsamples = {n}\nseed = {}\nlatin_hypercube = true\n[[vary]]\nkey = \
             \"coupler.rated_buff\"\n{law}\n",
            seed + 1
        );
        let folder = folder_with(ONE_CAR, &study);
        let (k, all) = exceedances(folder.path());
        assert_eq!(all, n, "{law}");
        assert!((k as f64 - n as f64 * p).abs() <= 1.0, "{law}: {k} of {n}, {p} is due");
    }
}

/// The lognormal case above is made for a logarithm of mean ln(600 kN) - 0.05 and deviation 0.1.
#[test]
fn a_lognormal_law_has_the_mean_and_deviation_that_are_asked_for() {
    let (mu, sigma) = (600e3f64.ln() - 0.05, 0.1f64);
    let mean = (mu + 0.5 * sigma * sigma).exp();
    let sd = mean * (sigma * sigma).exp_m1().sqrt();
    let Distribution::LogNormal { mu: found, sigma: spread } = Distribution::lognormal(mean, sd) else {
        panic!("no lognormal law")
    };
    // A few roundings of numbers near 13.
    assert!((found - mu).abs() < 1e-13 && (spread - sigma).abs() < 1e-13, "{found} {spread}");
}

/// Independent draws of twenty seeds. The counts together are binomial and lie within four deviations of their mean but for
/// one choice of seeds in 16 000; of twenty intervals of 95 % more than four miss for one choice in 400.
#[test]
fn independent_draws_find_the_probability_and_its_interval() {
    let (law, p) = laws()[0];
    let (n, seeds) = (300, 20);
    let (mut together, mut missed) = (0, 0);
    for seed in 1..=seeds {
        let vary = format!("[[vary]]\nkey = \"coupler.rated_buff\"\n{law}\n");
        let study = format!("trains = [\"train.toml\"]\nsamples = {n}\nseed = {seed}\n{vary}");
        let folder = folder_with(ONE_CAR, &study);
        let (k, _) = exceedances(folder.path());
        together += k;
        let report = fs::read_to_string(folder.path().join("out/fleet.md")).expect("a report");
        let line = report.lines().find(|line| line.starts_with("| one car")).expect("the train's line");
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        assert_eq!(cells[4], k.to_string(), "{line}");
        let (low, high) = cells[3].split_once(" to ").expect("an interval");
        let [low, high] = [low, high].map(|x| x.trim_end_matches(" %").parse::<f64>().expect("a number") / 100.0);
        assert!(low * f64::from(n) < k as f64 && (k as f64) < high * f64::from(n) && high - low < 0.1, "{line}");
        missed += usize::from(!(low < p && p < high));
        // The stronger, the less used: the rank correlation of strength and utilisation is exactly -1 where buff rules.
        assert!(report.contains("| coupler.rated\\_buff \\[N\\] | \u{2212}1.000 |"), "{report}");
    }
    let all = f64::from(n * seeds);
    let deviation = (all * p * (1.0 - p)).sqrt();
    assert!((together as f64 - all * p).abs() < 4.0 * deviation, "{together} of {all}, {p} is due");
    assert!(missed <= 4, "{missed} of {seeds} intervals miss {p}");
}

/// Four cars stand under 600 kN in draft while a force of 1 N hardly stirs them: an exceedance is a strength under 600 kN in
/// any of four couplers, 1 - (1 - p)^4.
#[test]
fn strengths_of_each_coupler_are_independent() {
    let train = ONE_CAR.replace("mass = \"80 t\"\n[load]", "count = 3\nmass = \"80 t\"\n[load]");
    let train = train.replace(
        "kind = \"break\"\ncoupler = 2",
        "kind = \"pulse\"\nat = \"tail\"\nforce = \"1 N\"\nduration = \"1 ms\"",
    );
    let (law, p) = laws()[1];
    let n = 2000;
    let study = format!(
        "trains = [\"train.toml\"]\nsamples = {n}\n[[vary]]\nkey = \"coupler.rated_load\"\nper = \"coupler\"\n{law}\n"
    );
    let folder = folder_with(&train, &study);
    let (k, _) = exceedances(folder.path());
    let any = 1.0 - (1.0 - p).powi(4);
    let deviation = (n as f64 * any * (1.0 - any)).sqrt();
    // As above; one draw for the whole train would give p = 0.25 instead of 0.68, forty deviations away.
    assert!((k as f64 - n as f64 * any).abs() < 4.0 * deviation, "{k} of {n}, {any} is due");
}

#[test]
fn a_grid_is_what_the_train_files_themselves_would_say() {
    let study = r#"
trains = ["train.toml"]
[[vary]]
key = "coupler.stiffness"
values = ["20 MN/m", "30 MN/m"]
[[vary]]
key = "vehicle[1].mass"
from = "60 t"
to = "80 t"
steps = 3
[[vary]]
key = "scenario[0].coupler"
values = [1, "each"]
"#;
    let folder = folder_with(ONE_CAR, study);
    let output = fleet(folder.path(), &["study.toml", "--out", "out"]);
    assert!(output.status.success(), "{}", complaint(&output));
    let found = rows(&folder.path().join("out/fleet.csv"));
    let mut expected = vec![];
    for stiffness in ["20 MN/m", "30 MN/m"] {
        for mass in ["60 t", "70 t", "80 t"] {
            for coupler in ["1", "\"each\""] {
                let text = ONE_CAR
                    .replace("30 MN/m", stiffness)
                    .replacen("mass = \"80 t\"", &format!("mass = \"{mass}\""), 1)
                    .replace("coupler = 2", &format!("coupler = {coupler}"));
                let path = folder.path().join(format!("by-hand-{:02}.toml", expected.len()));
                fs::write(&path, text).expect("a train file");
                expected.push(path);
            }
        }
    }
    let output = fleet(folder.path(), &["by-hand-*.toml", "--out", "by-hand"]);
    assert!(output.status.success(), "{}", complaint(&output));
    let by_hand = rows(&folder.path().join("by-hand/fleet.csv"));
    assert_eq!((found.len(), by_hand.len()), (18, 18));
    for (a, b) in found.iter().zip(&by_hand) {
        for column in ["scenario", "broken_coupler", "worst_coupler", "peak_force_n", "peak_time_s", "safe_load_factor"]
        {
            assert_eq!(a[column], b[column], "{column}: {a:?}");
        }
    }
    assert_eq!(found[0]["coupler.stiffness [N/m]"], "20000000.0");
    assert_eq!(found[17]["vehicle[1].mass [kg]"], "80000.0");
    assert_eq!(found[17]["scenario[0].coupler"], "each");
    assert_eq!(found[17]["variation"], "12");
}

#[test]
fn overridden_couplers_keep_what_the_file_says() {
    let train = ONE_CAR.to_owned() + "[[coupler_override]]\nat = 1\nrated_load = \"7 MN\"\n";
    let study = "trains = [\"train.toml\"]\nsamples = 5\n[[vary]]\nkey = \"coupler.rated_load\"\nper = \
                 \"coupler\"\ndistribution = \"uniform\"\nlow = \"1 MN\"\nhigh = \"2 MN\"\n";
    let folder = folder_with(&train, study);
    exceedances(folder.path());
    let found = rows(&folder.path().join("out/fleet.csv"));
    assert!(found.iter().all(|row| row["worst_coupler"] == "1" && row["rated_draft_n"] == "7000000.0"));
}

/// Values that no coupler takes are not among those whose smallest is told.
#[test]
fn draws_of_overridden_couplers_are_not_told() {
    let train = |at: &str| ONE_CAR.to_owned() + "[[coupler_override]]\nat = " + at + "\nrated_load = \"7 MN\"\n";
    let study = "trains = [\"train.toml\"]\nsamples = 20\n[[vary]]\nkey = \"coupler.rated_load\"\nper = \
                 \"coupler\"\ndistribution = \"uniform\"\nlow = \"1 MN\"\nhigh = \"2 MN\"\n";
    let smallest = |at: &str| {
        let folder = folder_with(&train(at), study);
        assert!(fleet(folder.path(), &["study.toml", "--out", "out"]).status.success());
        let rows = rows(&folder.path().join("out/fleet.csv"));
        rows.into_iter().map(|row| row["coupler.rated_load [N], smallest"].clone()).collect::<Vec<String>>()
    };
    let (first, second) = (smallest("2"), smallest("1"));
    assert!(first.iter().zip(&second).all(|(a, b)| a != b && !a.is_empty()));
    let folder = folder_with(ONE_CAR, study);
    assert!(fleet(folder.path(), &["study.toml", "--out", "out"]).status.success());
    for (row, (a, b)) in rows(&folder.path().join("out/fleet.csv")).iter().zip(first.iter().zip(&second)) {
        let number = |text: &str| text.parse::<f64>().expect("a number");
        assert_eq!(number(&row["coupler.rated_load [N], smallest"]), number(a).min(number(b)));
    }
}

/// Keys at the top, in tables within tables, and with units of their own are varied like any other.
#[test]
fn every_key_can_be_varied() {
    const TRAIN: &str = r#"
damping_ratio = 0.05
[coupler]
stiffness = "30 MN/m"
rated_load = "1 MN"
limits = { proof = "1.5 MN" }
[[vehicle]]
mass = "100 t"
held = true
[[vehicle]]
mass = "80 t"
brake_force = "1 kN"
[[vehicle]]
mass = "80 t"
[load]
grade = "0.5 %"
[[scenario]]
kind = "pulse"
at = "tail"
force = "100 kN"
duration = "1 s"
"#;
    let study = r#"
trains = ["train.toml"]
[[vary]]
key = "damping_ratio"
values = [0.05, 0.1]
[[vary]]
key = "vehicle[1].brake_force"
values = ["1 kN", "20 kN"]
[[vary]]
key = "load.grade"
from = "0.5 %"
to = "1.5 %"
steps = 2
[[vary]]
key = "coupler.limits.proof"
values = ["1.5 MN"]
"#;
    let folder = folder_with(TRAIN, study);
    let output = fleet(folder.path(), &["study.toml", "--out", "out"]);
    assert!(output.status.success(), "{}", complaint(&output));
    let found = rows(&folder.path().join("out/fleet.csv"));
    let mut number = 0;
    for ratio in ["0.05", "0.1"] {
        for brake in ["1 kN", "20 kN"] {
            for grade in ["0.5 %", "1.5 %"] {
                let text = TRAIN
                    .replace("damping_ratio = 0.05", &format!("damping_ratio = {ratio}"))
                    .replace("brake_force = \"1 kN\"", &format!("brake_force = \"{brake}\""))
                    .replace("grade = \"0.5 %\"", &format!("grade = \"{grade}\""));
                fs::write(folder.path().join(format!("by-hand-{number}.toml")), text).expect("a train file");
                number += 1;
            }
        }
    }
    assert!(fleet(folder.path(), &["by-hand-*.toml", "--out", "by-hand"]).status.success());
    let by_hand = rows(&folder.path().join("by-hand/fleet.csv"));
    assert_eq!((found.len(), by_hand.len()), (8, 8));
    let forces: HashSet<&str> = found.iter().map(|row| &*row["peak_force_n"]).collect();
    assert_eq!(forces.len(), 8, "each variation is another train");
    for (a, b) in found.iter().zip(&by_hand) {
        for column in ["worst_coupler", "peak_force_n", "peak_time_s", "safe_load_factor"] {
            assert_eq!(a[column], b[column], "{column}: {a:?}");
        }
    }
    let last = &found[7];
    assert_eq!((&*last["damping_ratio"], &*last["load.grade [%]"]), ("0.1", "1.5"));
    assert_eq!((&*last["vehicle[1].brake_force [N]"], &*last["coupler.limits.proof [N]"]), ("20000.0", "1500000.0"));
    let study = "trains = [\"train.toml\"]\nsamples = 50\n[[vary]]\nkey = \"load.grade\"\ndistribution = \
                 \"uniform\"\nlow = \"0.5 %\"\nhigh = \"1.5 %\"\n";
    fs::write(folder.path().join("study.toml"), study).expect("a study file");
    assert!(fleet(folder.path(), &["study.toml", "--out", "drawn"]).status.success());
    for row in rows(&folder.path().join("drawn/fleet.csv")) {
        let [grade, steady] =
            ["load.grade [%]", "initial_force_n"].map(|key| row[key].parse::<f64>().expect("a number"));
        assert!((0.5..1.5).contains(&grade) && (7e3..3e4).contains(&steady.abs()), "{row:?}");
    }
}

#[test]
fn a_dry_run_counts_and_writes_nothing() {
    let study = "trains = [\"train.toml\"]\nsamples = 12345\n[[vary]]\nkey = \"load.uniform\"\nvalues = [\"1 kN\"]\n";
    let folder = folder_with(ONE_CAR, study);
    let output = fleet(folder.path(), &["study.toml", "--dry-run"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let (counts, time) = text.split_once('\n').expect("two lines");
    assert_eq!(counts, "1 train, 12345 variations of each, 12345 cases");
    assert!(time.contains(" s on ") && time.ends_with("threads\n") || time.ends_with("thread\n"), "{time}");
    assert!(!folder.path().join("reports").exists());
}

#[test]
fn each_mistake_in_a_study_has_its_message() {
    let head = "trains = [\"train.toml\"]\nsamples = 10\n[[vary]]\n";
    let cases = [
        (
            format!("{head}key = \"coupler.stifness\"\nvalues = [\"1 MN/m\"]\n"),
            "error: [coupler] has no key \"stifness\" to vary
 --> study.toml:4:7
  |
4 | key = \"coupler.stifness\"
  |       ^^^^^^^^^^^^^^^^^^
  |
  = help: expected stiffness, rated_load, rated_buff, limits.fatigue, limits.proof, limits.ultimate, limits.draft.fatigue, limits.draft.proof, limits.draft.ultimate, limits.buff.fatigue, limits.buff.proof, limits.buff.ultimate, damping, stiffness_in_buff, slack, gear, gear_in_buff, friction or solid_stiffness
",
        ),
        (
            format!("{head}key = \"vehicle.mass\"\nvalues = [\"1 t\"]\n"),
            "error: a train file has several [[vehicle]]
 --> study.toml:4:7
  |
4 | key = \"vehicle.mass\"
  |       ^^^^^^^^^^^^^^
  |
  = help: write vehicle[0].mass for the first [[vehicle]] of the file, vehicle[1].mass for the second
",
        ),
        (
            format!("{head}key = \"load.uniform\"\ndistribution = \"normal\"\nmean = \"1 MN\"\nsd = \"3 t\"\n"),
            "error: sd has \"t\", a unit of mass
 --> study.toml:7:6
  |
7 | sd = \"3 t\"
  |      ^^^^^
  |
  = help: a force is in N, kN, MN, lbf or kip, or a share in %
",
        ),
        (
            format!("{head}key = \"load.uniform\"\ndistribution = \"uniform\"\nlow = \"2 MN\"\nhigh = \"1 MN\"\n"),
            "error: the limits of the distribution are not in order
 --> study.toml:5:16
  |
5 | distribution = \"uniform\"
  |                ^^^^^^^^^
  |
  = help: low is below high, and mode between
",
        ),
        (
            "trains = [\"train.toml\"]\n[[vary]]\nkey = \"load.uniform\"\ndistribution = \"uniform\"\n".to_owned(),
            "error: a distribution has no combinations to run
 --> study.toml:4:16
  |
4 | distribution = \"uniform\"
  |                ^^^^^^^^^
  |
  = help: add samples = 10000 at the top of the file
",
        ),
        (
            format!("{head}key = \"load.uniform\"\nper = \"coupler\"\nvalues = [\"1 MN\"]\n"),
            "error: load.uniform is no key of every coupler
 --> study.toml:5:7
  |
5 | per = \"coupler\"
  |       ^^^^^^^^^
  |
  = help: only keys of [coupler] have per = \"coupler\"
",
        ),
    ];
    for (study, expected) in cases {
        let folder = folder_with(ONE_CAR, &study);
        let output = fleet(folder.path(), &["study.toml", "--out", "out"]);
        assert_eq!(output.status.code(), Some(2), "{study}");
        assert_eq!(complaint(&output), expected);
    }
}
