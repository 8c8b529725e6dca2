//! What fuzzing found stays found: its inputs, and every train that comes with the program, through the checks of the fuzz targets.

#[path = "../../fuzz/checks.rs"]
mod checks;

use std::fs;
use std::path::{Path, PathBuf};

use trainsafe::{Options, consist};

fn files(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let entries = fs::read_dir(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut paths: Vec<PathBuf> = entries.map(|e| e.expect("an entry").path()).filter(|p| p.is_file()).collect();
    paths.sort();
    paths
}

fn each(folder: &str, check: fn(&[u8])) {
    for path in files(folder) {
        eprintln!("{}", path.display());
        check(&fs::read(path).expect("a file"));
    }
}

#[test]
fn inputs_of_text() {
    each("tests/fuzz_found/csv_table", checks::csv_table);
    each("tests/fuzz_found/study_file", checks::study_file);
    each("tests/bad_trains", checks::train_file);
    each("tests/bad_trains", checks::csv_table);
    each("tests/bad_trains", checks::pulse_record);
    checks::study_file(consist::TEMPLATE.as_bytes());
    checks::train_file(consist::TEMPLATE.as_bytes());
}

#[test]
fn analyses() {
    let check = |path: &Path, options: &Options| {
        eprintln!("{}", path.display());
        checks::analysis(&consist::read(path).unwrap_or_else(|e| panic!("{e}")), options, 0.1);
    };
    let verdict_only = Options { verdict_only: true, tolerance: 1e-4, ..Options::default() };
    for path in files("trains").iter().filter(|p| p.extension().is_some_and(|e| e == "toml")) {
        check(path, &verdict_only);
    }
    for path in &files("tests/fuzz_found/trains") {
        check(path, &Options::default());
        check(path, &Options { all_time_bound: true, map: true, ..Options::default() });
    }
}
