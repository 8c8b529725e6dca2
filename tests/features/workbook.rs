//! Tables of vehicles in workbooks: the same train as from CSV, the same messages, and no harm from a hostile one.

#![cfg(feature = "xlsx")]

use std::fs;
use std::path::Path;
use std::time::Instant;

use trainsafe::consist;
use trainsafe::error::InputError;
use trainsafe::train::Train;

fn read(vehicles: &str) -> Result<Train, InputError> {
    let coupler = "[coupler]\nstiffness = \"30 MN/m\"\nrated_load = \"1 MN\"\nrated_buff = \"110 %\"\n";
    consist::parse(&format!("vehicles = \"{vehicles}\"\n{coupler}"), Path::new("tests/workbooks/train.toml"))
}

/// Titles, percentages, notes, dates, sheets beside it, quotation marks, repeated empty cells: nothing differs from the CSV.
#[test]
fn xlsx_ods_and_csv_are_the_same_train() {
    let expected = read("consist.csv").expect("a train");
    assert_eq!(expected.vehicles()[0].mass_kg, 195e3);
    assert_eq!(expected.vehicles()[1].label, "car, \"long\"");
    for name in ["consist.xlsx", "consist.xlsx#Consist", "consist.ods", "consist.ods#Consist"] {
        let train = read(name).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!((train.vehicles(), train.couplers()), (expected.vehicles(), expected.couplers()), "{name}");
        // The grades, of which one is a percentage that binary numbers do not hold.
        assert_eq!(train.initial_force_n(), expected.initial_force_n(), "{name}");
        assert!(train.initial_force_n().iter().any(|f| *f != 0.0));
        let doubts: Vec<String> = train.origin().doubts.iter().map(ToString::to_string).collect();
        assert_eq!(doubts, [format!("the column \"Loaded on\" of {name} is not read")]);
        let [source] = train.origin().sources.as_slice() else { panic!("{:?}", train.origin().sources) };
        assert!(source.path.ends_with(name));
    }
}

#[test]
fn the_sheet_that_is_meant_is_asked_for() {
    let message = |vehicles: &str| read(vehicles).expect_err(vehicles).to_string();
    let two = message("two-tables.xlsx");
    assert!(two.contains("sheets \"Winter\" and \"Summer\" could both be meant"), "{two}");
    assert!(two.contains("help: name the sheet behind a #, as in \"consist.xlsx#Sheet1\""), "{two}");
    assert_eq!(read("two-tables.xlsx#Summer").expect("a train").vehicles().len(), 4);
    let none = message("consist.ods#Sheet1");
    assert!(none.contains("the workbook has no sheet \"Sheet1\"") && none.contains("\"Notes\", \"Consist\""), "{none}");
    let gear =
        "[coupler]\ngear = \"two-tables.xlsx\"\nrated_load = \"1 MN\"\n[[vehicle]]\nmass = \"80 t\"\ncount = 3\n";
    let other =
        consist::parse(gear, Path::new("tests/workbooks/train.toml")).expect_err("no table of a gear").to_string();
    assert!(other.contains("no sheet of the workbook holds such a table"), "{other}");
    assert!(other.contains("name the one that is meant behind a # to be told what is wrong with it"), "{other}");
    assert!(message("consist.xlsx#Notes").contains("this is no table of vehicles"));
    assert!(message("consist.csv#Sheet1").contains("this is no workbook, so it has no sheets"));
}

/// Rows and columns are those of the sheet.
#[test]
fn cells_that_are_no_numbers_are_told_with_their_place() {
    let message = read("bad-cells.xlsx").expect_err("a date is no mass").to_string();
    assert!(message.contains("row 5, column Mass (t): mass"), "{message}");
    assert!(message.contains("a date or time"), "{message}");
    assert!(message.contains("row 6, column Mass (t): there is no mass"), "{message}");
}

/// 17 thousand million cells in 400 bytes, and an archive that unpacks to far more than it holds.
#[test]
fn a_hostile_workbook_is_refused_at_once() {
    let start = Instant::now();
    let message = read("repeated.ods").expect_err("refused").to_string();
    assert!(message.contains("the sheet holds more than 16 MiB of text"), "{message}");
    assert!(start.elapsed().as_secs_f64() < 20.0);
    let folder = tempfile::tempdir().expect("a folder");
    let whole = fs::read("tests/workbooks/consist.xlsx").expect("the workbook");
    for cut in [30, 200, whole.len() / 2, whole.len() - 1] {
        let path = folder.path().join("cut.xlsx");
        fs::write(&path, &whole[..cut]).expect("written");
        consist::import(&path, &[]).expect_err("it is cut");
    }
    for at in (0..whole.len()).step_by(41) {
        let mut broken = whole.clone();
        broken[at] ^= 0x55;
        let path = folder.path().join("broken.xlsx");
        fs::write(&path, &broken).expect("written");
        // It is read or refused.
        let _ = consist::import(&path, &[]);
    }
}

/// `import` says where in the sheet a number stands, a percentage as it is shown.
#[test]
fn import_reads_a_sheet() {
    let imported = consist::import(Path::new("tests/workbooks/consist.xlsx"), &[]).expect("a train file");
    assert!(imported.text.contains("grade = \"7 %\""), "{}", imported.text);
    assert!(imported.text.contains("# row 5, column Grade [%]"), "{}", imported.text);
}
