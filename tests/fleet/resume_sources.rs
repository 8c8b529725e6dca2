//! A run goes on, and workers take part, only if every file is what it was: train files, tables, records, and what only a study names.

use std::fs;
use std::path::Path;

use crate::fleets::{complaint, fleet, rows, unfinished};
use tempfile::TempDir;

const HEAD: &str = "[coupler]\nstiffness = \"11.1 MN/m\"\nrated_load = \"1.2 MN\"\n";
const CARS: &str = "[[vehicle]]\ncount = 12\nmass = \"120 t\"\n";
const RECORD: &str = "[[scenario]]\nkind = \"pulse\"\nat = \"tail\"\nrecord = \"p.csv\"\n";
const STUDY: &str = "trains = [\"train.toml\"]\n[[vary]]\n";

fn record(force: usize) -> String {
    format!("time_s,force_kn\n0,0\n0.1,{force}\n0.2,0\n")
}

fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        fs::write(folder.path().join(name), text).expect("a file");
    }
    folder
}

const REFUSED: &str = "holds a run of other train files, another study, other options or another version of trainsafe: put back what \
                       it was, or choose another folder with --out DIR\n";

/// Changes a file after a run and in the midst of one: neither goes on until it is put back. A worker, which reads files only as it comes
/// to them, then names the file.
fn goes_on_only_without(folder: &Path, given: &str, changed: &str, text: &str) {
    let run = |more: &[&str]| fleet(folder, &[&[given, "--out"], more].concat());
    let done = |output: std::process::Output| assert!(output.status.success(), "{}", complaint(&output));
    let refused = |output: std::process::Output, dir: &str| {
        assert_eq!(
            (output.status.code(), complaint(&output)),
            (Some(2), format!("error: {dir} {REFUSED}")),
            "{changed}"
        );
    };
    done(run(&["whole"]));
    unfinished(folder, &[given], "parts", |part| part != 0);
    let before = fs::read_to_string(folder.join(changed)).expect("a file");
    fs::write(folder.join(changed), text).expect("a file");
    refused(run(&["whole", "--resume"]), "whole");
    let worker = run(&["parts", "--work"]);
    let expected = format!("error: {changed} has changed since the run started: what is done belongs to the old one\n");
    assert_eq!((worker.status.code(), complaint(&worker)), (Some(2), expected));
    refused(run(&["parts", "--resume"]), "parts");
    fs::write(folder.join(changed), before).expect("a file");
    done(run(&["whole", "--resume"]));
    done(run(&["parts", "--work"]));
    done(fleet(folder, &["--merge", "--out", "parts"]));
    let [whole, parts] = ["whole", "parts"].map(|dir| fs::read(folder.join(dir).join("fleet.csv")).expect("rows"));
    assert_eq!(whole, parts);
}

#[test]
fn a_changed_record_is_noticed() {
    let folder = folder(&[("train.toml", &format!("{HEAD}{CARS}{RECORD}")), ("p.csv", &record(900))]);
    goes_on_only_without(folder.path(), "train.toml", "p.csv", &record(2900));
}

#[test]
fn a_changed_table_is_noticed() {
    let train = format!("vehicles = \"t.csv\"\n{HEAD}[load]\nuniform = \"0.5 MN\"\n");
    let folder = folder(&[("train.toml", &train), ("t.csv", "count,mass [t]\n12,120\n")]);
    goes_on_only_without(folder.path(), "train.toml", "t.csv", "count,mass [t]\n12,121\n");
}

/// The reader of a train without a rating need not come to its record.
#[test]
fn a_record_of_an_incomplete_train_is_noticed() {
    let train = format!("{HEAD}{CARS}{RECORD}").replace("\"1.2 MN\"", "\"TBD\"");
    let study = format!("{STUDY}key = \"coupler.rated_load\"\nvalues = [\"1 MN\", \"2 MN\"]\n");
    let folder = folder(&[("train.toml", &train), ("p.csv", &record(900)), ("study.toml", &study)]);
    goes_on_only_without(folder.path(), "study.toml", "p.csv", &record(901));
    let no_cars = format!("{HEAD}{RECORD}[[vehicle]]\ncount = \"?\"\nmass = \"120 t\"\n");
    fs::write(folder.path().join("train.toml"), no_cars).expect("a train");
    let study = format!("{STUDY}key = \"vehicle[0].count\"\nvalues = [12, 13]\n");
    fs::write(folder.path().join("study.toml"), study).expect("a study");
    fs::remove_dir_all(folder.path().join("whole")).expect("a run");
    fs::remove_dir_all(folder.path().join("parts")).expect("a run");
    goes_on_only_without(folder.path(), "study.toml", "p.csv", &record(902));
}

#[test]
fn files_that_only_a_study_names_are_noticed() {
    let study = format!("{STUDY}key = \"scenario[0].record\"\nvalues = [\"p.csv\", \"q.csv\"]\n");
    let train = format!("{HEAD}{CARS}{RECORD}");
    let folder_of_records =
        folder(&[("train.toml", &train), ("p.csv", &record(900)), ("q.csv", &record(800)), ("study.toml", &study)]);
    goes_on_only_without(folder_of_records.path(), "study.toml", "q.csv", &record(801));
    let study = format!("{STUDY}key = \"vehicles\"\nvalues = [\"a.csv\", \"b.csv\"]\n");
    let train = format!("vehicles = \"a.csv\"\n{HEAD}[load]\nuniform = \"0.5 MN\"\n");
    let [a, b, other] = [120, 110, 111].map(|mass| format!("count,mass [t]\n12,{mass}\n"));
    let folder = folder(&[("train.toml", &train), ("a.csv", &a), ("b.csv", &b), ("study.toml", &study)]);
    goes_on_only_without(folder.path(), "study.toml", "b.csv", &other);
}

/// A folder that an earlier version began has other columns, and its description does not name them.
#[test]
fn a_run_of_an_earlier_version_is_refused() {
    let train = format!("{HEAD}{CARS}[load]\nuniform = \"0.5 MN\"\n");
    let folder = folder(&[("train.toml", &train)]);
    assert!(fleet(folder.path(), &["train.toml", "--out", "out", "--work"]).status.success());
    let path = folder.path().join("out/fleet-run.json");
    let text = fs::read_to_string(&path).expect("a description");
    let mut old: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    old.as_object_mut().expect("an object").retain(|key, _| key != "columns" && key != "notes");
    fs::write(&path, old.to_string()).expect("a description");
    let merge = fleet(folder.path(), &["--merge", "--out", "out"]);
    let expected = "error: out holds a run of another version of trainsafe: merge it with that version, or run it again with this \
                    one\n";
    assert_eq!((merge.status.code(), complaint(&merge)), (Some(2), expected.to_owned()));
    let resume = fleet(folder.path(), &["train.toml", "--out", "out", "--resume"]);
    assert_eq!((resume.status.code(), complaint(&resume)), (Some(2), format!("error: out {REFUSED}")));
    fs::write(&path, text).expect("a description");
    assert!(fleet(folder.path(), &["--merge", "--out", "out"]).status.success());
    assert_eq!(rows(&folder.path().join("out/fleet.csv")).len(), 11);
}
