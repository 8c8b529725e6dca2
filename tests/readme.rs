//! The README's field table names every field that is written.

use std::collections::BTreeSet;
use std::process::Command;

use serde_json::Value;

fn keys(value: &Value, into: &mut BTreeSet<String>) {
    match value {
        Value::Object(map) => map.iter().for_each(|(key, inner)| {
            into.insert(key.clone());
            keys(inner, into);
        }),
        Value::Array(list) => list.iter().for_each(|inner| keys(inner, into)),
        _ => {}
    }
}

/// What stands in backquotes in the first column of the tables of a section.
fn documented(readme: &str, section: &str) -> BTreeSet<String> {
    let table = readme.split(section).nth(1).and_then(|t| t.split("\n## ").next()).expect("the section");
    table
        .lines()
        .filter_map(|line| line.strip_prefix("| ")?.split(" | ").next())
        .flat_map(|cell| cell.split('`').skip(1).step_by(2))
        .map(str::to_owned)
        .collect()
}

fn readme() -> String {
    std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/README.md")).expect("the README")
}

#[test]
fn every_column_of_a_fleet_is_documented() {
    let root = env!("CARGO_MANIFEST_DIR");
    let dir = tempfile::tempdir().expect("a folder");
    let run = Command::new(env!("CARGO_BIN_EXE_trainsafe"))
        .args(["fleet", &format!("{root}/trains/paper-figure-4.toml"), "--out"])
        .arg(dir.path())
        .output()
        .expect("it runs");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let (own, shared) = (documented(&readme(), "## Fleets"), documented(&readme(), "## Fields of"));
    for name in ["fleet.csv", "errors.csv"] {
        let csv = std::fs::read_to_string(dir.path().join(name)).expect("CSV");
        let columns = csv.lines().next().expect("a header").split(',');
        let missing: Vec<&str> = columns.filter(|c| !own.contains(*c) && !shared.contains(*c)).collect();
        assert!(missing.is_empty(), "columns of {name} without a line in the README: {missing:?}");
    }
}

#[test]
fn every_field_is_documented() {
    let root = env!("CARGO_MANIFEST_DIR");
    let documented = documented(&readme(), "## Fields of");
    let dir = tempfile::tempdir().expect("a folder");
    let mut written = BTreeSet::new();
    for train in ["paper-figure-4", "mixed-manifest-train", "hauled-train-on-a-grade"] {
        let out = dir.path().join(train);
        let run = Command::new(env!("CARGO_BIN_EXE_trainsafe"))
            .args(["analyze", &format!("{root}/trains/{train}.toml"), "--all-time-bound", "--map", "--out"])
            .arg(&out)
            .output()
            .expect("it runs");
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        let json = std::fs::read_to_string(out.join("result.json")).expect("JSON");
        keys(&serde_json::from_str(&json).expect("JSON"), &mut written);
        let csv = std::fs::read_to_string(out.join("couplers.csv")).expect("CSV");
        written.extend(csv.lines().next().expect("a header").split(',').map(str::to_owned));
    }
    let missing: Vec<&String> = written.iter().filter(|w| !documented.contains(*w)).collect();
    assert!(missing.is_empty(), "fields without a line in the README: {missing:?}");
}
