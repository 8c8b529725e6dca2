//! A fleet tells the doubts that `analyze` tells: on standard error, in its reports and in each row.

use std::fs;

use crate::fleets::{complaint, fleet, rows, trainsafe};
use tempfile::TempDir;

const COUPLER: &str = "[coupler]\nstiffness = \"11.1 MN/m\"\nrated_load = \"1 MN\"\n";
const CARS: &str = "[[vehicle]]\ncount = 12\nmass = \"120 t\"\n";
const SHORT: &str = "[[scenario]]\nkind = \"break\"\ncoupler = 11\nhorizon = \"0.5 s\"\n";

fn load(force: &str) -> String {
    format!("[load]\nuniform = \"{force}\"\n")
}

/// Train files, and the codes of their doubts in each scenario.
fn trains() -> Vec<(&'static str, String, &'static [&'static str])> {
    let train = |rest: &str| format!("{COUPLER}{CARS}{rest}");
    vec![
        ("a.toml", train(""), &["no-load"]),
        ("b.toml", train(&(load("0.7 MN") + SHORT)), &["short-horizon"]),
        ("c.toml", train(&(load("1.1 MN") + SHORT)), &["load-over-rating short-horizon"]),
        ("d.toml", train(&load("0.5 MN")), &[""]),
        (
            "e.toml",
            train(&(load("0.5 MN") + SHORT + "[[scenario]]\nkind = \"break\"\ncoupler = 3\n")),
            &["short-horizon", ""],
        ),
    ]
}

fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text, _) in trains() {
        fs::write(folder.path().join(name), text).expect("a train");
    }
    folder
}

const SENTENCE: &str = "1 of 5 trains would overload a coupler in some case (1 in the first passage, 0 only later); 1 of 26 cases does (1 in the first passage, 0 only later); 4 trains have doubts (short-horizon: 3, load-over-rating: \
     1, no-load: 1).";

#[test]
fn doubts_stand_in_rows_reports_and_on_standard_error() {
    let folder = folder();
    let output = fleet(folder.path(), &["*.toml", "--out", "out", "--format", "csv,md,html"]);
    assert!(output.status.success(), "{}", complaint(&output));
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(told.starts_with(SENTENCE), "{told}");
    let [report, page] =
        ["fleet.md", "fleet.html"].map(|n| fs::read_to_string(folder.path().join("out").join(n)).expect(n));
    assert!(report.contains(SENTENCE) && page.contains(SENTENCE), "{report}");
    assert!(report.contains("| a | a.toml | no-load | 11 of 11 |"), "{report}");
    assert!(report.contains("| e | e.toml | short-horizon | 1 of 2 |"), "{report}");
    assert!(
        page.contains("<td><bdi>e.toml</bdi></td><td><bdi>short-horizon</bdi></td><td><bdi>1 of 2</bdi></td>"),
        "{page}"
    );
    let rows = rows(&folder.path().join("out/fleet.csv"));
    for (name, _, codes) in trains() {
        let mut found: Vec<&str> = rows.iter().filter(|row| row["file"] == name).map(|row| &*row["doubts"]).collect();
        found.dedup();
        assert_eq!(found, codes, "{name}");
        // The same words as analyze has for the train.
        let analyze = trainsafe(folder.path()).args(["analyze", name, "--out", "one"]).output().expect("it runs");
        let warnings: Vec<String> =
            complaint(&analyze).lines().filter_map(|l| l.strip_prefix("warning: ").map(str::to_owned)).collect();
        let said = complaint(&output);
        for warning in &warnings {
            assert!(said.contains(&format!("warning: {name}: {warning} [")), "{warning} in {said}");
        }
        let kinds: std::collections::BTreeSet<&str> =
            codes.iter().flat_map(|c| c.split(' ')).filter(|c| !c.is_empty()).collect();
        assert_eq!(said.lines().filter(|l| l.starts_with(&format!("warning: {name}: "))).count(), kinds.len());
    }
    let line =
        "warning: e.toml: break of coupler 11: the horizon of 500 ms ends before a wave has crossed the longest part, ";
    assert!(complaint(&output).lines().any(|l| l.starts_with(line) && l.ends_with(" [short-horizon] (1 of 2 cases)")));
}

#[test]
fn rows_of_json_and_joined_parts_have_them_too() {
    let folder = folder();
    let output = fleet(folder.path(), &["a.toml", "d.toml", "--json"]);
    let lines = String::from_utf8_lossy(&output.stdout).into_owned();
    let doubts: Vec<serde_json::Value> =
        lines.lines().map(|l| serde_json::from_str::<serde_json::Value>(l).expect("JSON")["doubts"].clone()).collect();
    assert!(doubts[..11].iter().all(|d| d == "no-load") && doubts[11..].iter().all(serde_json::Value::is_null));
    assert!(complaint(&output).contains("[no-load] (11 of 11 cases)"), "{}", complaint(&output));
    let output = fleet(folder.path(), &["*.toml", "--out", "parts", "--work"]);
    assert!(output.status.success() && complaint(&output).contains("warning: "), "{}", complaint(&output));
    let output = fleet(folder.path(), &["--merge", "--out", "parts"]);
    assert!(String::from_utf8_lossy(&output.stdout).starts_with(SENTENCE));
    let line = "warning: a.toml: no-load, which `trainsafe analyze` explains (11 of 11 cases)\n";
    assert!(complaint(&output).contains(line), "{}", complaint(&output));
}

#[test]
fn of_very_many_the_totals_are_told() {
    let folder = tempfile::tempdir().expect("a folder");
    for i in 0..30 {
        let short = if i < 3 { load("0.5 MN") + SHORT } else { String::new() };
        fs::write(folder.path().join(format!("{i:02}.toml")), format!("{COUPLER}{CARS}{short}")).expect("a train");
    }
    let output = fleet(folder.path(), &[".", "--out", "out"]);
    assert!(output.status.success(), "{}", complaint(&output));
    let warnings = complaint(&output).lines().filter(|line| line.starts_with("warning: ")).count();
    assert_eq!(warnings, 21);
    let line = "warning: 10 more doubts (no-load: 10): the column doubts of fleet.csv has them\n";
    assert!(complaint(&output).contains(line), "{}", complaint(&output));
    let sentence = "0 of 30 trains would overload a coupler in some case; 0 of 300 cases do; 30 trains have doubts (no-load: 27, \
                    short-horizon: 3).";
    assert!(String::from_utf8_lossy(&output.stdout).starts_with(sentence));
}

/// Doubts of a study are those of its variations: here the load passes the rating in one of three.
#[test]
fn doubts_of_variations_are_told_once() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("train.toml"), format!("{COUPLER}{CARS}{}", load("0.5 MN"))).expect("a train");
    let study =
        "trains = [\"train.toml\"]\n[[vary]]\nkey = \"load.uniform\"\nvalues = [\"0.5 MN\", \"1.5 MN\", \"0.6 MN\"]\n";
    fs::write(folder.path().join("study.toml"), study).expect("a study");
    let output = fleet(folder.path(), &["study.toml", "--out", "out"]);
    let line = "warning: train.toml: the load is over the rating of 11 of 11 couplers before anything happens [load-over-rating] (11 \
                of 33 cases)\n";
    assert!(complaint(&output).contains(line), "{}", complaint(&output));
    for row in rows(&folder.path().join("out/fleet.csv")) {
        assert_eq!(row["doubts"], if row["variation"] == "2" { "load-over-rating" } else { "" });
    }
}
