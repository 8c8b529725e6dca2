//! The README's field table names every field that is written, and the unit and sign of every number.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

/// Fields by name, and whether a number was seen in them.
type Fields = BTreeMap<String, bool>;

fn add(name: &str, number: bool, into: &mut Fields) {
    *into.entry(name.to_owned()).or_default() |= number;
}

fn json_fields(name: &str, value: &Value, into: &mut Fields) {
    match value {
        Value::Object(map) => map.iter().for_each(|(key, inner)| {
            add(key, false, into);
            json_fields(key, inner, into);
        }),
        Value::Array(list) => list.iter().for_each(|inner| json_fields(name, inner, into)),
        other => add(name, other.is_number(), into),
    }
}

fn csv_fields(path: &Path, into: &mut Fields) {
    let mut reader = csv::Reader::from_path(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let names = reader.headers().expect("a header").clone();
    for row in reader.records() {
        for (name, cell) in names.iter().zip(row.expect("a row").iter()) {
            add(name, cell.parse::<f64>().is_ok(), into);
        }
    }
}

/// Everything that `analyze` writes for a few trains that have all of it.
fn written() -> Fields {
    let root = env!("CARGO_MANIFEST_DIR");
    let dir = tempfile::tempdir().expect("a folder");
    let mut fields = Fields::new();
    // Maps of long trains take long.
    let map = Some("--map");
    for (train, map) in [
        ("paper-figure-4", map),
        ("paper-figure-5", map),
        ("european-freight-train", map),
        ("mixed-manifest-train", None),
        ("hauled-train-on-a-grade", None),
        ("unit-train-emergency", None),
    ] {
        let out = dir.path().join(train);
        let run = Command::new(env!("CARGO_BIN_EXE_trainsafe"))
            .args(["analyze", &format!("{root}/trains/{train}.toml"), "--all-time-bound"])
            .args(map)
            .arg("--out")
            .arg(&out)
            .output()
            .expect("it runs");
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        let json = std::fs::read_to_string(out.join("result.json")).expect("JSON");
        json_fields("", &serde_json::from_str(&json).expect("JSON"), &mut fields);
        for file in std::fs::read_dir(&out).expect("the report") {
            let path = file.expect("an entry").path();
            if path.extension().is_some_and(|e| e == "csv") {
                csv_fields(&path, &mut fields);
            }
        }
    }
    fields
}

/// What the tables of a section say of units and signs, by field; a field may stand in several rows.
fn documented(section: &str) -> BTreeMap<String, Vec<String>> {
    let readme = std::fs::read_to_string(format!("{}/README.md", env!("CARGO_MANIFEST_DIR"))).expect("the README");
    let table = readme.split(section).nth(1).and_then(|t| t.split("\n## ").next()).expect("the section");
    let mut rows: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for line in table.lines().filter(|line| line.starts_with("| ")) {
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        for name in cells[0].split('`').skip(1).step_by(2) {
            rows.entry(name.to_owned()).or_default().push(cells[1].to_owned());
        }
    }
    rows
}

/// Whether a cell tells the unit that a number of this name has, and for forces and energies its sign beside it.
fn tells(cell: &str, name: &str) -> bool {
    cell.split(';').any(|part| part_tells(part, name))
}

fn part_tells(cell: &str, name: &str) -> bool {
    let word = |unit: &str| cell.split([',', ' ']).any(|w| w == unit);
    let sign = ["draft +", "forward +", "\u{2265} 0", "> 0", "\u{2264} 0"].iter().any(|sign| cell.contains(sign));
    match name.rsplit_once('_').map(|(_, suffix)| suffix) {
        Some("n") => word("N") && sign,
        Some("j") => word("J") && sign,
        Some("s") => word("s"),
        _ => ["count", "counts", "share", "factor", "from 1"].iter().any(|unit| cell.contains(unit)),
    }
}

#[test]
fn every_field_is_documented_with_its_unit_and_sign() {
    let (written, documented) = (written(), documented("## Fields of"));
    let missing: Vec<&String> = written.keys().filter(|name| !documented.contains_key(*name)).collect();
    assert!(missing.is_empty(), "fields without a line in the README: {missing:?}");
    let of_a_unit = |name: &str| ["_n", "_s", "_j"].iter().any(|suffix| name.ends_with(suffix));
    let numbers: Vec<&String> =
        written.iter().filter(|(name, number)| **number || of_a_unit(name)).map(|(n, _)| n).collect();
    assert!(numbers.len() > 30, "{numbers:?}");
    let told = |name: &String| match &documented[name] {
        cells if of_a_unit(name) => cells.iter().all(|cell| tells(cell, name)),
        // A name without a unit may be of a number in one row and of something else in another.
        cells => cells.iter().any(|cell| tells(cell, name)),
    };
    let untold: Vec<&&String> = numbers.iter().filter(|name| !told(name)).collect();
    assert!(untold.is_empty(), "numbers without a unit, or a force without a sign, in the README: {untold:?}");
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
    let (own, shared) = (documented("## Fleets"), documented("## Fields of"));
    for name in ["fleet.csv", "errors.csv"] {
        let csv = std::fs::read_to_string(dir.path().join(name)).expect("CSV");
        let columns = csv.lines().next().expect("a header").split(',');
        let missing: Vec<&str> = columns.filter(|c| !own.contains_key(*c) && !shared.contains_key(*c)).collect();
        assert!(missing.is_empty(), "columns of {name} without a line in the README: {missing:?}");
    }
}
