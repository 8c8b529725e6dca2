//! Fleets: the same bytes however a run is cut, killed or threaded; bad trains in their place.

use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::time::Instant;

use crate::fleets::{complaint, fleet, parts, results, rows, trainsafe, unfinished, write_fleet};
use tempfile::TempDir;
use trainsafe::fleet::Request;
use trainsafe::{Options, analyze, consist};

fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

/// The results of an undisturbed run of `trains/` in a folder.
fn undisturbed(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let output = fleet(folder, &["trains", "--out", "whole"]);
    assert!(output.status.success(), "{}", complaint(&output));
    results(&folder.join("whole"))
}

#[test]
fn rows_are_what_analyze_finds() {
    let folder = folder();
    write_fleet(&folder.path().join("trains"), 4, 5);
    undisturbed(folder.path());
    let found = rows(&folder.path().join("whole/fleet.csv"));
    let mut expected = vec![];
    for number in 0..4 {
        let path = folder.path().join(format!("trains/train-{number:04}.toml"));
        let analysis = analyze(&consist::read(&path).expect("a train"), &Options::default()).expect("an analysis");
        for case in &analysis.scenarios[0].cases {
            let worst = case.worst.as_ref().expect("a worst coupler");
            let times = case.couplers.iter().filter_map(|c| Some((c.first_exceeds_s?, c.coupler)));
            let first = times.min_by(|a, b| a.0.total_cmp(&b.0));
            expected.push([
                analysis.train.clone(),
                format!("{}", case.broken_coupler.expect("a break")),
                worst.coupler.to_string(),
                format!("{:?}", worst.peak_force_n),
                format!("{:?}", worst.peak_time_s),
                format!("{:?}", worst.utilisation),
                first.map_or(String::new(), |(_, coupler)| coupler.to_string()),
                first.map_or(String::new(), |(t, _)| format!("{t:?}")),
                case.exceeding.to_string(),
                case.undecided.to_string(),
                case.safe_load_factor.map_or(String::new(), |f| format!("{f:?}")),
                format!("{:?}", case.error_bound_n),
                case.method.to_owned(),
            ]);
        }
    }
    let columns = [
        "train",
        "broken_coupler",
        "worst_coupler",
        "peak_force_n",
        "peak_time_s",
        "utilisation",
        "first_coupler",
        "first_exceeds_s",
        "exceeding",
        "undecided",
        "safe_load_factor",
        "error_bound_n",
        "method",
    ];
    let found: Vec<_> = found.iter().map(|row| columns.map(|c| row[c].clone())).collect();
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(&expected) {
        // Parts of equal vehicles are judged from responses that trains share: within the bounds of what is found of one alone.
        let value = |row: &[String; 13], at: usize| row[at].parse::<f64>().unwrap_or(-1.0);
        let bounds_n = value(found, 11) + value(expected, 11);
        for (at, column) in columns.iter().enumerate() {
            let apart = (value(found, at) - value(expected, at)).abs();
            let is_near = match *column {
                "peak_force_n" => apart <= bounds_n,
                "utilisation" | "safe_load_factor" => apart <= 10.0 * bounds_n / 0.7e6,
                "peak_time_s" | "first_exceeds_s" => apart < 1e-6,
                "error_bound_n" => value(found, at) < 1e-3,
                "method" => true,
                _ => found[at] == expected[at],
            };
            assert!(found[at] == expected[at] || is_near, "{column}: {found:?} instead of {expected:?}");
        }
    }
}

#[test]
fn one_thread_and_two_write_the_same_bytes() {
    let folder = folder();
    write_fleet(&folder.path().join("trains"), 30, 4);
    let run = |threads: &str| {
        let out = format!("with-{threads}");
        let mut command = trainsafe(folder.path());
        command.env("RAYON_NUM_THREADS", threads).args(["fleet", "trains", "--out", &out]);
        assert!(command.output().expect("trainsafe runs").status.success());
        results(&folder.path().join(out))
    };
    let one = run("1");
    let names: Vec<&str> = one.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(
        names,
        [".fleet-run.lock", "errors.csv", "figure-safe-factors.svg", "fleet-run.json", "fleet.csv", "fleet.md"]
    );
    assert_eq!(one, run("2"));
}

#[test]
fn what_is_done_is_not_done_again() {
    let folder = folder();
    write_fleet(&folder.path().join("trains"), 25, 4);
    unfinished(folder.path(), &["trains"], "out", |part| part % 3 == 0);
    let out = folder.path().join("out");
    let mut marked = 0;
    for part in parts(&out) {
        let text = fs::read_to_string(&part).expect("a part");
        // The first line says how many bytes the rows have: they stay as many.
        marked += text.lines().count() - 1;
        fs::write(&part, text.replace(",break,", ",known,")).expect("a marked part");
    }
    let output = fleet(folder.path(), &["trains", "--out", "out", "--resume"]);
    assert!(output.status.success(), "{}", complaint(&output));
    let found = rows(&out.join("fleet.csv"));
    assert!(marked > 0 && marked < found.len(), "{marked} of {}", found.len());
    assert_eq!(found.iter().filter(|row| row["kind"] == "known").count(), marked);
}

#[test]
fn killed_at_any_moment_and_resumed_it_ends_in_the_same_bytes() {
    let folder = folder();
    write_fleet(&folder.path().join("trains"), 60, 24);
    let start = Instant::now();
    let whole = undisturbed(folder.path());
    let takes = start.elapsed();
    let out = folder.path().join("killed");
    let (mut hits, mut done) = (0, 0);
    for attempt in 0..50 {
        let mut command = trainsafe(folder.path());
        command.args(["fleet", "trains", "--out", "killed", "--resume"]);
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("trainsafe starts");
        // From a start that has hardly begun to a third of the whole run, in no order.
        std::thread::sleep(takes.mul_f64(0.01 + 0.3 * (0.618 * f64::from(attempt)).fract()));
        let over = child.try_wait().expect("a status").is_some();
        child.kill().expect("it can be killed");
        child.wait().expect("it is dead");
        if over || out.join("fleet.csv").exists() {
            break;
        }
        hits += 1;
        let now = parts(&out);
        assert!(now.len() >= done, "a part is gone");
        done = now.len();
        for part in now {
            let text = fs::read_to_string(&part).expect("a part");
            assert!(text.is_empty() || text.ends_with('\n'), "{} ends within a row", part.display());
        }
    }
    assert!(hits >= 3 && done > 0, "only {hits} of the kills met a running program: a longer run is needed");
    let output = fleet(folder.path(), &["trains", "--out", "killed", "--resume"]);
    assert!(output.status.success(), "{}", complaint(&output));
    assert_eq!(whole, results(&out));
}

#[test]
fn ten_bad_files_of_a_hundred_are_ten_errors_with_their_places() {
    let folder = folder();
    let trains = folder.path().join("trains");
    write_fleet(&trains, 100, 3);
    for bad in 0..10 {
        let path = trains.join(format!("train-{:04}.toml", 7 + 9 * bad));
        let text = fs::read_to_string(&path).expect("a train");
        let wrong = ["rated_load = \"1 m\"", "rated_lode = \"1 MN\""][bad % 2];
        fs::write(&path, text.replace("rated_load = \"1 MN\"", wrong)).expect("a bad train");
    }
    let output = fleet(folder.path(), &["trains", "--out", "out"]);
    assert_eq!(output.status.code(), Some(3), "{}", complaint(&output));
    let found = rows(&folder.path().join("out/fleet.csv"));
    let mut names: Vec<&String> = found.iter().map(|row| &row["file"]).collect();
    names.dedup();
    assert_eq!(names.len(), 90);
    let errors = rows(&folder.path().join("out/errors.csv"));
    assert_eq!(errors.len(), 10);
    for (bad, row) in errors.iter().enumerate() {
        let file = format!("trains/train-{:04}.toml", 7 + 9 * bad);
        assert_eq!(row["file"], file);
        let says =
            ["4:14: rated_load has \"m\", a unit of length", "4:1: unknown key \"rated_lode\" in [coupler]"][bad % 2];
        assert_eq!(row["error"], format!("{file}:{says}"));
    }
}

/// Every way of being wrong that this project knows, among trains that are right.
#[test]
fn bad_files_of_every_kind_are_errors_with_their_places() {
    let folder = folder();
    let trains = folder.path().join("trains");
    write_fleet(&trains, 5, 3);
    let known = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_trains");
    let mut bad = vec![];
    for entry in fs::read_dir(known).expect("bad trains") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        fs::copy(&path, trains.join(&name)).expect("a copy");
        // The place that the message for one train names.
        let Ok(message) = fs::read_to_string(path.with_extension("txt")) else { continue };
        let place = message.lines().find_map(|l| l.trim_start().strip_prefix("--> ")).expect("a place").to_owned();
        if name.ends_with(".toml") {
            bad.push((format!("trains/{name}"), place));
        }
    }
    let output = fleet(folder.path(), &["trains", "--out", "out"]);
    assert_eq!(output.status.code(), Some(3), "{}", complaint(&output));
    let errors = rows(&folder.path().join("out/errors.csv"));
    bad.sort();
    assert!(bad.len() > 50 && errors.len() == bad.len(), "{} of {}", errors.len(), bad.len());
    for (row, (file, place)) in errors.iter().zip(&bad) {
        assert_eq!(&row["file"], file);
        let place = place.rsplit('/').next().unwrap_or_default();
        assert!(row["error"].starts_with(&format!("trains/{place}: ")), "{}: expected {place}", row["error"]);
    }
    let mut names: Vec<String> = rows(&folder.path().join("out/fleet.csv")).iter().map(|r| r["file"].clone()).collect();
    names.dedup();
    assert_eq!(names.len(), 5);
}

#[test]
fn none_but_bad_files_is_bad_input() {
    let folder = folder();
    fs::write(folder.path().join("bad.toml"), "").expect("a bad train");
    let output = fleet(folder.path(), &["bad.toml", "--out", "out"]);
    assert_eq!(output.status.code(), Some(2), "{}", complaint(&output));
    let errors = rows(&folder.path().join("out/errors.csv"));
    assert!(errors[0]["error"].starts_with("bad.toml: "), "{:?}", errors[0]);
}

#[test]
fn a_run_goes_on_only_with_what_it_began_with() {
    let folder = folder();
    let trains = folder.path().join("trains");
    write_fleet(&trains, 6, 4);
    unfinished(folder.path(), &["trains"], "out", |part| part % 2 == 0);
    let again = fleet(folder.path(), &["trains", "--out", "out"]);
    assert_eq!(again.status.code(), Some(2));
    assert!(complaint(&again).contains("holds a run that is not finished"), "{}", complaint(&again));
    let other = fleet(folder.path(), &["trains", "--out", "out", "--resume", "--tolerance", "1e-6"]);
    assert_eq!(other.status.code(), Some(2));
    assert!(complaint(&other).contains("other options"), "{}", complaint(&other));
    let train = trains.join("train-0002.toml");
    let text = fs::read_to_string(&train).expect("a train");
    fs::write(&train, text.replace("30 MN/m", "31 MN/m")).expect("another train");
    let changed = fleet(folder.path(), &["trains", "--out", "out", "--resume"]);
    assert_eq!(changed.status.code(), Some(2));
    assert!(complaint(&changed).contains("holds a run of other train files"), "{}", complaint(&changed));
    fs::write(&train, text).expect("the train");
    let resumed = fleet(folder.path(), &["trains", "--out", "out", "--resume"]);
    assert!(resumed.status.success(), "{}", complaint(&resumed));
}

#[test]
fn what_is_remembered_changes_no_byte() {
    let folder = folder();
    write_fleet(&folder.path().join("trains"), 12, 7);
    let run = |name: &str, response_bytes: Option<usize>| {
        let paths = vec![folder.path().join("trains")];
        let request = Request { paths, response_bytes, ..Request::default() };
        let out = folder.path().join(name);
        let outcome = trainsafe::fleet::run(&request, &out).expect("a run");
        (outcome.scenes, results(&out))
    };
    let ((hits, solved), with) = run("with", None);
    let ((none, all), without) = run("without", Some(0));
    assert_eq!(with, without);
    // Equal trains held nowhere are their own mirror images: half of their scenes are known already.
    assert!(none == 0 && hits > 0 && hits + solved == all, "{hits} + {solved} of {all}");
    let ((_, _), little) = run("little", Some(20_000));
    assert_eq!(with, little);
}

#[test]
fn a_study_of_loads_and_ratings_marches_each_chain_once() {
    let folder = folder();
    write_fleet(&folder.path().join("trains"), 3, 6);
    let vary = |key: &str, low: &str, high: &str| {
        format!("[[vary]]\nkey = {key:?}\ndistribution = \"uniform\"\nlow = {low:?}\nhigh = {high:?}\n")
    };
    let loads = vary("load.uniform", "0.2 MN", "0.8 MN") + &vary("coupler.rated_load", "0.9 MN", "1.4 MN");
    let study = format!("trains = [\"trains/train-0001.toml\"]\nsamples = 30\n{loads}");
    let run = |name: &str, study: &str, response_bytes: Option<usize>| {
        let path = folder.path().join(format!("{name}.toml"));
        fs::write(&path, study).expect("a study");
        let request = Request { paths: vec![path], response_bytes, ..Request::default() };
        let out = folder.path().join(name);
        let outcome = trainsafe::fleet::run(&request, &out).expect("a run");
        (outcome.scenes, fs::read(out.join("fleet.csv")).expect("rows"))
    };
    // Seven vehicles: six breaks, of which the first and the last leave one part with a coupler.
    let ((known, marched), with) = run("with", &study, None);
    assert_eq!((known, marched), (29 * 10, 10));
    let ((none, all), without) = run("without", &study, Some(0));
    assert_eq!((none, all), (0, 300));
    assert_eq!(with, without);
    // Another stiffness is another chain; but one vehicle behind a held one is an equal chain, the same in its own unit of time.
    let stiffness = vary("coupler.stiffness", "20 MN/m", "40 MN/m");
    let ((known, solved), _) = run("other", &format!("{study}{stiffness}"), None);
    assert_eq!((known, solved), (29, 271));
    // Alone, each variation is the same within the bounds.
    let few = format!("trains = [\"trains/train-0001.toml\"]\nsamples = 5\n{loads}");
    let (_, alone) = run("few", &few, None);
    let number = |row: &csv::StringRecord, at: usize| row[at].parse::<f64>().expect("a number");
    let table = |bytes: &[u8]| {
        let mut reader = csv::Reader::from_reader(bytes);
        let headings = reader.headers().expect("headings").clone();
        let place = |name: &str| headings.iter().position(|h| h == name).expect("a column");
        (["peak_force_n", "error_bound_n", "exceeding"].map(place), reader.records().flatten().collect::<Vec<_>>())
    };
    let (([peak, bound, exceeding], shared), (_, alone)) = (table(&with), table(&alone));
    assert_eq!(alone.len(), 30);
    for (a, b) in shared.iter().zip(&alone) {
        assert!((number(a, peak) - number(b, peak)).abs() <= number(a, bound) + number(b, bound), "{a:?} {b:?}");
        assert_eq!(a[exceeding], b[exceeding]);
    }
}

#[test]
fn json_has_a_line_for_every_case_and_writes_no_file() {
    let folder = folder();
    write_fleet(&folder.path().join("trains"), 3, 4);
    fs::write(folder.path().join("trains/z.toml"), "x").expect("a bad train");
    let output = fleet(folder.path(), &["trains", "--json"]);
    assert_eq!(output.status.code(), Some(3));
    let lines: Vec<serde_json::Value> = String::from_utf8(output.stdout)
        .expect("text")
        .lines()
        .map(|line| serde_json::from_str(line).expect("a line of JSON"))
        .collect();
    assert_eq!(lines.len(), 3 + 4 + 5 + 1);
    assert_eq!(lines[0]["train"], "train 0");
    assert!(lines[0]["utilisation"].is_f64() && lines[0]["variation"].is_null());
    assert!(lines[12]["error"].as_str().is_some_and(|e| e.contains("not TOML")), "{}", lines[12]);
    assert!(!folder.path().join("reports").exists());
}

#[test]
fn globs_folders_and_files_name_each_train_once() {
    let folder = folder();
    write_fleet(&folder.path().join("a/b"), 3, 3);
    fs::write(folder.path().join("a/notes.txt"), "no train").expect("a file");
    let output = fleet(folder.path(), &["a/b/train-0002.toml", "a", "a/*/train-000[01].toml", "--out", "out"]);
    assert!(output.status.success(), "{}", complaint(&output));
    let found = rows(&folder.path().join("out/fleet.csv"));
    let mut names: Vec<&str> = found.iter().map(|row| row["file"].as_str()).collect();
    names.dedup();
    assert_eq!(names, ["a/b/train-0002.toml", "a/b/train-0000.toml", "a/b/train-0001.toml"]);
}

#[test]
fn a_place_that_cannot_be_written_is_status_4() {
    let folder = folder();
    write_fleet(&folder.path().join("trains"), 1, 3);
    fs::write(folder.path().join("out"), "a file").expect("a file");
    let output = fleet(folder.path(), &["trains", "--out", "out/here"]);
    assert_eq!(output.status.code(), Some(4), "{}", complaint(&output));
}
