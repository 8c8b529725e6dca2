//! Fleets of train files in a temporary folder, and the program run on them.

#![allow(dead_code)] // Each test binary uses its own part.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Writes a train file of `vehicles` vehicles with a load and masses that follow from its number; every third is of equal
/// masses and held nowhere.
pub fn write_train(folder: &Path, number: usize, vehicles: usize) -> PathBuf {
    let load = 300 + 17 * (number % 23);
    let mut text = format!(
        "name = \"train {number}\"\n[coupler]\nstiffness = \"30 MN/m\"\nrated_load = \"1 MN\"\nrated_buff = \"0.7 MN\"\n\
         [load]\nuniform = \"{load} kN\"\n"
    );
    for v in 0..vehicles {
        let mass = if number.is_multiple_of(3) { 80 } else { 60 + (7 * v + 11 * number) % 50 };
        text += &format!("[[vehicle]]\nmass = \"{mass} t\"\n");
        if v == 0 && number % 3 == 1 {
            text += "held = true\n";
        }
    }
    let path = folder.join(format!("train-{number:04}.toml"));
    fs::write(&path, text).expect("a train file");
    path
}

/// A folder of small trains.
pub fn write_fleet(folder: &Path, trains: usize, vehicles: usize) {
    fs::create_dir_all(folder).expect("a folder");
    for number in 0..trains {
        write_train(folder, number, vehicles + number % 5);
    }
}

/// The program, to be run in a folder.
pub fn trainsafe(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_trainsafe"));
    command.current_dir(folder).env("NO_COLOR", "1");
    command
}

/// Runs `trainsafe fleet` in a folder.
pub fn fleet(folder: &Path, arguments: &[&str]) -> Output {
    trainsafe(folder).arg("fleet").args(arguments).output().expect("trainsafe runs")
}

/// Standard error as text.
pub fn complaint(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The results in a folder: every file's name and bytes, in the order of names.
pub fn results(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(folder).expect("the results");
    let mut all: Vec<(String, Vec<u8>)> = entries
        .map(|entry| {
            let path = entry.expect("an entry").path();
            let name = path.file_name().expect("a name").to_string_lossy().into_owned();
            (name.clone(), fs::read(&path).unwrap_or_else(|e| panic!("{name}: {e}")))
        })
        .collect();
    all.sort();
    all
}

/// Rows of a CSV file as maps from headings to cells.
pub fn rows(path: &Path) -> Vec<std::collections::BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    reader.deserialize().map(|row| row.expect("a row")).collect()
}

/// Part files, whole ones, in the order of their names.
pub fn parts(out: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(out.join("fleet-parts")) else { return vec![] };
    let mut all: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    // A killed run may leave files under their temporary names.
    all.retain(|path| path.extension().is_some_and(|e| e == "csv"));
    all.sort();
    all
}

/// A run of paths that has some of its parts, as a worker leaves it that is killed: those whose number is kept.
pub fn unfinished(folder: &Path, paths: &[&str], out: &str, kept: impl Fn(usize) -> bool) {
    let output = fleet(folder, &[paths, &["--out", out, "--work"]].concat());
    assert!(output.status.success(), "{}", complaint(&output));
    lose(&folder.join(out), |part| !kept(part));
}

/// Removes parts by their number, and the claims on them.
pub fn lose(out: &Path, lost: impl Fn(usize) -> bool) {
    for (number, part) in parts(out).into_iter().enumerate().filter(|(number, _)| lost(*number)) {
        fs::remove_file(part).expect("a part");
        fs::remove_file(out.join(format!("fleet-parts/{number}.claim"))).expect("a claim");
    }
}
