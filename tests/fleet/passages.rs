//! A fleet tells what exceeds in the first passage apart from what exceeds only later, and a gap that closes; results have their date.

use std::fs;
use std::path::Path;

use crate::fleets::{complaint, fleet, trainsafe};

/// Seven vehicles free at both ends: a pulse, and each coupler in turn.
const LONG: &str = r#"
[coupler]
stiffness = "11 MN/m"
rated_load = "0.8 MN"
[[vehicle]]
mass = "190 t"
[[vehicle]]
count = 6
mass = "90 t"
[load]
uniform = "0.7 MN"
[[scenario]]
kind = "pulse"
at = "tail"
force = "-3 MN"
duration = "100 ms"
[[scenario]]
kind = "break"
coupler = "each"
horizon = "20 s"
"#;

/// Limits and a cascade are in the rows and in the verdict; a study of them has an effect.
#[test]
fn limits_and_cascades_are_told() {
    const TRAIN: &str = r#"
[coupler]
stiffness = "30 MN/m"
rated_load = "0.7 MN"
limits = { fatigue = "0.65 MN", ultimate = "0.71 MN" }
[[vehicle]]
mass = "100 t"
[[vehicle]]
count = 4
mass = "90 t"
[load]
uniform = "0.6 MN"
[[scenario]]
kind = "break"
coupler = 1
cascade = true
"#;
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("train.toml"), TRAIN).expect("a train");
    let study =
        "trains = [\"train.toml\"]\n[[vary]]\nkey = \"coupler.limits.ultimate\"\nvalues = [\"0.71 MN\", \"0.9 MN\"]\n";
    fs::write(folder.path().join("study.toml"), study).expect("a study");
    let output = fleet(folder.path(), &["study.toml", "--out", "out"]);
    assert!(output.status.success(), "{}", complaint(&output));
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    let rows = crate::fleets::rows(&folder.path().join("out/fleet.csv"));
    let of = |column: &str| rows.iter().map(|row| row[column].clone()).collect::<Vec<_>>();
    // With 0.71 MN a second coupler breaks, with 0.9 MN none does.
    assert_eq!((of("further_breaks"), of("pieces")), (vec!["1".into(), "0".into()], vec!["3".into(), "2".into()]));
    let ultimate = of("passing_ultimate");
    assert!(ultimate[0] != "0" && ultimate[1] == "0", "{ultimate:?}");
    assert!(of("passing_fatigue").iter().all(|n| n == "2") && of("passing_proof").iter().all(String::is_empty));
    for sentence in [
        "In 2 cases some coupler passes its fatigue load.",
        "In 1 case some coupler passes its ultimate load.",
        "In 1 case more couplers break after the event, up to 1 in one case.",
    ] {
        assert!(printed.contains(sentence), "{printed}");
    }
}

/// Two vehicles are pulled apart until their coupler breaks, and pushed together again.
const GAP: &str = r#"
[coupler]
stiffness = "10 MN/m"
rated_load = "300 kN"
rated_buff = "9 MN"
[[vehicle]]
count = 2
mass = "100 t"
[[scenario]]
kind = "pulse"
at = "tail"
record = "pulse.csv"
cascade = true
horizon = "20 s"
"#;

fn rows(path: &Path) -> Vec<std::collections::HashMap<String, String>> {
    let mut reader = csv::Reader::from_path(path).expect("fleet.csv");
    reader.deserialize().map(|row| row.expect("a row")).collect()
}

#[test]
fn the_verdict_counts_the_first_passage_and_what_comes_only_later() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("long.toml"), LONG).expect("a train");
    let output = fleet(folder.path(), &["long.toml", "--out", "out", "--format", "csv,md,html"]);
    assert_eq!(output.status.code(), Some(0), "{}", complaint(&output));
    let rows = rows(&folder.path().join("out/fleet.csv"));
    let exceeding = |row: &&std::collections::HashMap<String, String>| row["exceeding"] != "0";
    let all = rows.iter().filter(exceeding).count();
    let first = rows.iter().filter(|row| row["exceeding_first_passage"] != "0").count();
    assert!(0 < first && first < all, "{first} of {all}");
    let later = all - first;
    let counts = format!(
        "1 of 1 train would overload a coupler in some case (1 in the first passage, 0 only later); {all} of 7 cases do ({first} in the \
         first passage, {later} only later)."
    );
    let why = "means that a rating is exceeded only after the first passage, by reflected waves";
    let read = |name: &str| fs::read_to_string(folder.path().join("out").join(name)).expect("a report");
    for text in [String::from_utf8_lossy(&output.stdout).into_owned(), read("fleet.md"), read("fleet.html")] {
        assert!(text.contains(&counts) && text.contains(why), "{counts}\n{text}");
    }
    assert!(read("fleet.md").contains(&format!("| {all} of 7 | {later} |")));
    assert!(
        read("fleet.html").contains(&format!("{all} of 7 cases exceed, {later} of them only after the first passage."))
    );
}

#[test]
fn a_gap_that_closes_is_told_by_analyze_and_fleet() {
    let folder = tempfile::tempdir().expect("a folder");
    let record = "time_s,force_kn\n0,-400\n0.2,-400\n0.2,500\n30,500\n30,0\n";
    for (name, text) in [("gap.toml", GAP), ("pulse.csv", record)] {
        fs::write(folder.path().join(name), text).expect("a file");
    }
    let text = "the gap at coupler 1 closes at ";
    let output = fleet(folder.path(), &["gap.toml", "--out", "out"]);
    assert!(complaint(&output).contains(text) && complaint(&output).contains("[gap-closes]"), "{}", complaint(&output));
    assert!(rows(&folder.path().join("out/fleet.csv"))[0]["doubts"].split(' ').any(|code| code == "gap-closes"));
    let alone = trainsafe(folder.path()).args(["analyze", "gap.toml", "--json"]).output().expect("it runs");
    assert_eq!(complaint(&alone).matches(text).count(), 1, "{}", complaint(&alone));
    let json: serde_json::Value = serde_json::from_slice(&alone.stdout).expect("JSON");
    let closes_s = json["scenarios"][0]["cases"][0]["cascade"]["gap_closes_s"].as_f64().expect("it closes");
    let doubt = json["doubts"].as_array().expect("a list").iter().find(|d| d["code"] == "gap-closes").expect("a doubt");
    let told = doubt["text"].as_str().expect("a text").strip_prefix(text).expect("the same");
    let told: f64 = told.split(' ').next().and_then(|n| n.parse().ok()).expect("a time");
    // It is shown in s or ms, with five digits.
    assert!([closes_s, 1e3 * closes_s].iter().any(|t| (t - told).abs() < 1e-4 * t), "{told} of {closes_s}");
}

#[test]
fn the_date_is_that_of_the_environment() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("long.toml"), LONG).expect("a train");
    let run = |epoch: &str| {
        let mut run = trainsafe(folder.path());
        run.args(["analyze", "long.toml", "--json"]).env("SOURCE_DATE_EPOCH", epoch).output().expect("it runs")
    };
    let json: serde_json::Value = serde_json::from_slice(&run("951782400").stdout).expect("JSON");
    assert_eq!(json["date"], "2000-02-29");
    for wrong in ["yesterday", "-1", "", "1e9"] {
        let output = run(wrong);
        assert_eq!(output.status.code(), Some(2), "{wrong}");
        let message =
            format!("error: long.toml: SOURCE_DATE_EPOCH is {wrong:?}, not a whole number of seconds since 1970\n");
        assert!(complaint(&output).ends_with(&message), "{}", complaint(&output));
    }
}

/// Factors on the load, on the force of a pulse and on the speed of an impact are in columns and panels of their own, and safe trains
/// have their margin.
#[test]
fn safe_factors_of_different_causes_are_told_apart() {
    let folder = tempfile::tempdir().expect("a folder");
    let safe = LONG.replace("0.8 MN", "8 MN").replace("-3 MN", "-0.1 MN");
    let impact = "[[scenario]]\nkind = \"impact\"\nvehicles = 2\nat = \"tail\"\nspeed = \"0.1 m/s\"\n";
    fs::write(folder.path().join("safe.toml"), safe.clone() + impact).expect("a train");
    let output = fleet(folder.path(), &["safe.toml", "--out", "out", "--format", "csv,md,html"]);
    assert_eq!(output.status.code(), Some(0), "{}", complaint(&output));
    let rows = rows(&folder.path().join("out/fleet.csv"));
    let number =
        |row: &std::collections::HashMap<String, String>, column: &str| row[column].parse::<f64>().expect("a number");
    let report = fs::read_to_string(folder.path().join("out/fleet.md")).expect("a report");
    let line = |start: &str| report.lines().find(|l| l.starts_with(start)).unwrap_or_default().to_owned();
    let cells = |line: String| line.split('|').map(|c| c.trim().to_owned()).collect::<Vec<_>>();
    let (head, train) = (cells(line("| train | file | largest")), cells(line("| safe")));
    let cell = |name: &str| {
        let at = head.iter().position(|h| h == name).unwrap_or_else(|| panic!("{name}: {head:?}"));
        train[at].parse::<f64>().expect("a number")
    };
    let most = rows.iter().map(|r| number(r, "utilisation")).fold(0.0, f64::max);
    assert!(most < 1.0 && (cell("margin, %") - 100.0 * (1.0 - most)).abs() < 0.1, "{train:?}");
    for (kind, cause) in [("break", "load"), ("pulse", "force of the pulse"), ("impact", "speed of the impact")] {
        let of_kind = rows.iter().filter(|r| r["kind"] == kind);
        let least = of_kind.map(|r| number(r, "safe_load_factor")).fold(f64::INFINITY, f64::min);
        let told = cell(&format!("safe factor on the {cause}"));
        assert!(told <= least && told > 0.99 * least, "{kind}: {told} for {least}");
        let figure = fs::read_to_string(folder.path().join("out/figure-safe-factors.svg")).expect("a figure");
        assert!(figure.contains(&format!("safe factor on the {cause}")));
    }
}

/// What a row tells of the first passage is what an analysis tells of its worst coupler there: of a mixed train, whose rows come from
/// searches for the worst alone.
#[test]
fn rows_tell_the_first_passage_as_analyses_do() {
    let folder = tempfile::tempdir().expect("a folder");
    let train = fs::read_to_string("trains/mixed-manifest-train.toml").expect("a sample");
    let breaks = train.find("[[scenario]]").map_or(train.as_str(), |at| &train[..at]).to_owned()
        + "[[scenario]]\nname = \"each\"\nkind = \"break\"\ncoupler = \"each\"\n";
    fs::write(folder.path().join("train.toml"), breaks).expect("a train");
    assert!(fleet(folder.path(), &["train.toml", "--out", "out"]).status.success());
    let rows = crate::fleets::rows(&folder.path().join("out/fleet.csv"));
    let output = trainsafe(folder.path()).args(["analyze", "train.toml", "--json"]).output().expect("it runs");
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let cases = json["scenarios"][0]["cases"].as_array().expect("cases");
    assert_eq!(rows.len(), cases.len());
    for (row, case) in rows.iter().zip(cases) {
        let worst = &case["worst_first_passage"];
        assert_eq!(row["first_passage_worst_coupler"], worst["coupler"].to_string(), "{row:?}");
        for (column, field) in
            [("first_passage_utilisation", "utilisation"), ("first_passage_peak_force_n", "peak_force_n")]
        {
            let (told, due): (f64, f64) =
                (row[column].parse().expect("a number"), worst[field].as_f64().expect("a number"));
            assert!((told - due).abs() <= 1e-9 * due.abs(), "{column} {told} {due}");
        }
        // The other sense is exact or left out.
        for sense in ["draft", "buff"] {
            let told = &row[&format!("first_passage_peak_{sense}_n")];
            let due = worst["first_passage"][format!("peak_{sense}_n")].as_f64();
            let near = |n: f64| due.is_some_and(|due| (n - due).abs() <= 1e-9 * due.abs());
            assert!(told.is_empty() || near(told.parse().expect("a number")), "{sense} {told} {due:?}");
        }
    }
}
