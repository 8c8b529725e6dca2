//! Studies and fleets that once left out in silence what they were given: inputs without effect, cases, draws, doubts.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn fleet(folder: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_trainsafe"));
    command.current_dir(folder).arg("fleet").args(args).output().expect("it runs")
}

/// A copy of a folder of cases, with one more file.
fn copied(name: &str) -> tempfile::TempDir {
    let to = tempfile::tempdir().expect("a folder");
    let from = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/study_cases").join(name);
    for entry in fs::read_dir(from).expect("cases").flatten() {
        fs::copy(entry.path(), to.path().join(entry.file_name())).expect("copied");
    }
    to
}

fn rows(folder: &Path, file: &str) -> Vec<csv::StringRecord> {
    let mut reader = csv::Reader::from_path(folder.join(file)).expect("a table");
    let headings = reader.headers().expect("headings").clone();
    let mut rows: Vec<csv::StringRecord> = reader.records().map(|r| r.expect("a row")).collect();
    rows.insert(0, headings);
    rows
}

fn column<'r>(rows: &'r [csv::StringRecord], name: &str) -> Vec<&'r str> {
    let at = rows[0].iter().position(|heading| heading == name).unwrap_or_else(|| panic!("no column {name}"));
    rows[1..].iter().map(|row| &row[at]).collect()
}

fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// All couplers have a rating of their own in the table: the varied rating would reach none, drawn per coupler or for the train.
#[test]
fn an_input_that_reaches_no_coupler_is_an_error_either_way() {
    let folder = copied("study-per-coupler-overrides-table");
    for study in ["study-per-coupler.toml", "study-per-train.toml"] {
        let output = fleet(folder.path(), &[study, "--out", "out"]);
        assert_eq!(output.status.code(), Some(2), "{}", errors(&output));
        let expected = "error: coupler.rated_load reaches no coupler of train.toml: each has a value of its own, from the table of \
                        vehicles or a [[coupler_override]], and keeps it\n";
        assert_eq!(errors(&output), expected);
    }
}

/// With an own rating in some rows only, both ways reach the others and leave those.
#[test]
fn own_values_are_kept_either_way() {
    let folder = copied("study-per-coupler-overrides-table");
    let table = fs::read_to_string(folder.path().join("consist.csv")).expect("a table");
    let kept: Vec<String> = table
        .lines()
        .enumerate()
        .map(|(i, line)| match (i, line.rsplit_once(',')) {
            // Every other row loses its rating.
            (1.., Some((front, _))) if i % 2 == 0 => format!("{front},"),
            _ => line.to_owned(),
        })
        .collect();
    fs::write(folder.path().join("consist.csv"), kept.join("\n") + "\n").expect("written");
    for study in ["study-per-coupler.toml", "study-per-train.toml"] {
        let output = fleet(folder.path(), &[study, "--out", study.trim_end_matches(".toml")]);
        assert_eq!(output.status.code(), Some(0), "{}", errors(&output));
        let rows = rows(&folder.path().join(study.trim_end_matches(".toml")), "fleet.csv");
        // The weakest couplers are those with 0.9 MN of their own.
        assert!(column(&rows, "rated_draft_n").contains(&"900000.0"), "{study}");
    }
}

/// A placeholder that the study fills in hides none of the cases.
#[test]
fn an_incomplete_base_has_all_its_cases() {
    let folder = copied("study-drops-cases-when-base-incomplete");
    let output = fleet(folder.path(), &["study.toml", "--out", "out"]);
    assert_eq!(output.status.code(), Some(0), "{}", errors(&output));
    let rows = rows(&folder.path().join("out"), "fleet.csv");
    assert_eq!(rows.len(), 1 + 6);
    let over = column(&rows, "exceeding").iter().filter(|n| **n == "12").count();
    assert_eq!(over, 2);
    let dry = fleet(folder.path(), &["study.toml", "--dry-run"]);
    assert!(String::from_utf8_lossy(&dry.stdout).contains("6 cases"), "{}", String::from_utf8_lossy(&dry.stdout));
}

/// P(N(1.2, 0.9) <= 0) = 0.0912: the draws that cannot be are not left out of the probability.
#[test]
fn a_distribution_of_values_that_cannot_be_is_refused() {
    let folder = copied("negative-draws-left-out");
    let output = fleet(folder.path(), &["study.toml", "--out", "out"]);
    assert_eq!(output.status.code(), Some(2), "{}", errors(&output));
    assert!(errors(&output).contains("9.12 % of this distribution is zero or below, where no rated_load can be"));
    let study = fs::read_to_string(folder.path().join("study.toml")).expect("a study");
    fs::write(folder.path().join("narrow.toml"), study.replace("0.9 MN", "0.1 MN")).expect("written");
    let output = fleet(folder.path(), &["narrow.toml", "--out", "narrow"]);
    assert_eq!(output.status.code(), Some(0), "{}", errors(&output));
}

/// What `analyze` doubts, `fleet` doubts: in the verdict, on standard error, in the report and in each row.
#[test]
fn a_fleet_tells_the_doubts_of_its_trains() {
    let folder = copied("fleet-drops-warnings");
    let output = fleet(folder.path(), &[".", "--out", "out", "--format", "csv,md,html"]);
    assert_eq!(output.status.code(), Some(0), "{}", errors(&output));
    assert!(String::from_utf8_lossy(&output.stdout).contains("2 trains have doubts ("));
    for code in ["no-load", "short-horizon"] {
        assert!(errors(&output).contains(&format!(" [{code}] (")), "{}", errors(&output));
        for file in ["fleet.md", "fleet.html"] {
            assert!(
                fs::read_to_string(folder.path().join("out").join(file)).expect("a report").contains(code),
                "{file}"
            );
        }
        let rows = rows(&folder.path().join("out"), "fleet.csv");
        assert!(column(&rows, "doubts").iter().any(|cell| cell.split(' ').any(|c| c == code)), "{code}");
    }
}

/// Every wagon of a group has a mass of its own, and another train file's group stays as it is.
#[test]
fn a_quantity_of_each_vehicle_is_drawn() {
    let folder = tempfile::tempdir().expect("a folder");
    let train = "[coupler]\nstiffness = \"20 MN/m\"\nrated_load = \"1 MN\"\n[[vehicle]]\nmass = \"90 t\"\n[[vehicle]]\nlabel = \
                 \"wagon\"\ncount = 5\nmass = \"80 t\"\n[load]\nuniform = \"0.4 MN\"\n[[scenario]]\nkind = \"break\"\ncoupler = 1\n";
    fs::write(folder.path().join("train.toml"), train).expect("written");
    let study = "trains = [\"train.toml\"]\nsamples = 20\n[[vary]]\nkey = \"vehicle[1].mass\"\nper = \"vehicle\"\ndistribution = \
                 \"uniform\"\nlow = \"20 t\"\nhigh = \"120 t\"\n";
    fs::write(folder.path().join("study.toml"), study).expect("written");
    let output = fleet(folder.path(), &["study.toml", "--out", "out"]);
    assert_eq!(output.status.code(), Some(0), "{}", errors(&output));
    let rows = rows(&folder.path().join("out"), "fleet.csv");
    let peaks: std::collections::BTreeSet<&str> = column(&rows, "peak_force_n").into_iter().collect();
    assert_eq!((rows.len(), peaks.len()), (21, 20), "each draw has a motion of its own");
}
