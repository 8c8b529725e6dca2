//! `fleet.parquet` holds what `fleet.csv` holds, with types, whatever the run went through.

use crate::fleets::{complaint, fleet, write_fleet};

#[cfg(not(feature = "parquet"))]
#[test]
fn a_build_without_parquet_says_so_before_it_computes() {
    let folder = tempfile::tempdir().expect("a folder");
    write_fleet(&folder.path().join("trains"), 2, 3);
    for arguments in [&["trains", "--out", "out"][..], &["trains", "--dry-run"], &["--merge", "--out", "out"]] {
        let output = fleet(folder.path(), &[arguments, &["--format", "csv,parquet"]].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(complaint(&output).contains("cargo install --path . --features parquet"), "{}", complaint(&output));
    }
    assert!(!folder.path().join("out").exists());
}

#[cfg(feature = "parquet")]
mod with_the_feature {
    use std::fs;
    use std::path::Path;

    use parquet::basic::Type;
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;

    use super::*;
    use crate::fleets::{results, trainsafe, unfinished};

    /// A cell as the CSV has it.
    fn cell(field: &Field) -> String {
        match field {
            Field::Null => String::new(),
            Field::Str(text) => text.clone(),
            Field::Long(n) => n.to_string(),
            Field::Double(x) => format!("{x:?}"),
            other => panic!("no such type: {other:?}"),
        }
    }

    /// The names and types of the columns, and every row as cells.
    fn read(path: &Path) -> (Vec<(String, Type)>, Vec<Vec<String>>) {
        let reader = SerializedFileReader::new(fs::File::open(path).expect("a file")).expect("Parquet");
        let schema = reader.metadata().file_metadata().schema_descr();
        let columns = schema.columns().iter().map(|c| (c.name().to_owned(), c.physical_type())).collect();
        let rows = reader.get_row_iter(None).expect("rows");
        let rows = rows.map(|row| row.expect("a row").get_column_iter().map(|(_, field)| cell(field)).collect());
        (columns, rows.collect())
    }

    fn csv_cells(path: &Path) -> (Vec<String>, Vec<Vec<String>>) {
        let mut reader = csv::Reader::from_path(path).expect("a CSV");
        let cells = |record: csv::StringRecord| record.iter().map(str::to_owned).collect();
        let headings = cells(reader.headers().expect("headings").clone());
        (headings, reader.records().map(|record| cells(record.expect("a row"))).collect())
    }

    fn assert_same(out: &Path) -> Vec<(String, Type)> {
        let (columns, rows) = read(&out.join("fleet.parquet"));
        let (headings, expected) = csv_cells(&out.join("fleet.csv"));
        assert!(columns.iter().map(|(name, _)| name).eq(&headings));
        assert_eq!(rows, expected);
        columns
    }

    #[test]
    fn every_cell_is_that_of_the_csv_and_has_its_type() {
        let folder = tempfile::tempdir().expect("a folder");
        write_fleet(&folder.path().join("trains"), 6, 4);
        // A name like a formula, one that is a number, and one pulse: no coupler breaks in it, and no rod is told of.
        let train = folder.path().join("trains/train-0001.toml");
        let text = fs::read_to_string(&train).expect("a train").replace("train 1", "=1+1, \\\"so\\\"");
        let pulse =
            "[[scenario]]\nname = \"17\"\nkind = \"pulse\"\nat = \"tail\"\nforce = \"1 MN\"\nduration = \"9 ms\"\n";
        fs::write(&train, text + pulse).expect("another train");
        let output = fleet(folder.path(), &["trains", "--out", "out", "--format", "parquet"]);
        assert!(output.status.success(), "{}", complaint(&output));
        let columns = assert_same(&folder.path().join("out"));
        let of = |kind: Type| columns.iter().filter(|(_, k)| *k == kind).map(|(n, _)| n.as_str()).collect::<Vec<_>>();
        assert_eq!(
            of(Type::BYTE_ARRAY),
            [
                "file",
                "train",
                "scenario",
                "kind",
                "between_front",
                "between_rear",
                "first_passage_exceeds",
                "method",
                "doubts"
            ]
        );
        assert_eq!(
            of(Type::INT64),
            [
                "vehicles",
                "variation",
                "broken_coupler",
                "worst_coupler",
                "first_coupler",
                "exceeding",
                "undecided",
                "exceeding_first_passage",
                "first_passage_worst_coupler",
                "passing_fatigue",
                "passing_proof",
                "passing_ultimate",
                "undecided_limits",
                "further_breaks",
                "pieces",
                "rod_exceeding"
            ]
        );
        let (_, rows) = read(&folder.path().join("out/fleet.parquet"));
        assert!(
            rows.iter().any(|row| row[4] == "17" && row[6].is_empty())
                && rows.iter().any(|row| row[1] == "'=1+1, \"so\"")
        );
        assert!(!folder.path().join("out/fleet.md").exists());
    }

    #[test]
    fn inputs_of_a_study_are_numbers_where_all_of_them_are() {
        let folder = tempfile::tempdir().expect("a folder");
        write_fleet(&folder.path().join("trains"), 2, 3);
        let study = "trains = [\"trains\"]\n[[vary]]\nkey = \"coupler.stiffness\"\nvalues = [\"20 MN/m\", \"30 MN/m\"]\n\
                     [[vary]]\nkey = \"vehicle[1].label\"\nvalues = [\"7\", \"a\"]\n";
        fs::write(folder.path().join("study.toml"), study).expect("a study");
        let output = fleet(folder.path(), &["study.toml", "--out", "out", "--format", "parquet,md"]);
        assert!(output.status.success(), "{}", complaint(&output));
        let columns = assert_same(&folder.path().join("out"));
        assert_eq!(columns[4], ("coupler.stiffness [N/m]".to_owned(), Type::DOUBLE));
        assert_eq!(columns[5], ("vehicle[1].label".to_owned(), Type::BYTE_ARRAY));
    }

    #[test]
    fn workers_and_a_run_that_resumes_write_the_same_bytes() {
        let folder = tempfile::tempdir().expect("a folder");
        write_fleet(&folder.path().join("trains"), 25, 4);
        let run = |arguments: &[&str]| {
            let output = fleet(folder.path(), &[arguments, &["--format", "csv,md,parquet"]].concat());
            assert!(output.status.success(), "{}", complaint(&output));
        };
        run(&["trains", "--out", "whole"]);
        unfinished(folder.path(), &["trains"], "parts", |part| part % 2 == 0);
        unfinished(folder.path(), &["trains"], "resumed", |part| part % 2 == 1);
        assert!(fleet(folder.path(), &["trains", "--out", "parts", "--work"]).status.success());
        run(&["--merge", "--out", "parts"]);
        let mut one_thread = trainsafe(folder.path());
        one_thread.env("RAYON_NUM_THREADS", "1").args(["fleet", "trains", "--out", "resumed", "--resume"]);
        assert!(one_thread.output().expect("it runs").status.success());
        // What is asked for later is made of the rows that are there.
        assert!(!folder.path().join("resumed/fleet.parquet").exists());
        run(&["trains", "--out", "resumed", "--resume"]);
        let whole = results(&folder.path().join("whole"));
        assert!(whole.iter().any(|(name, _)| name == "fleet.parquet"));
        assert_eq!(whole, results(&folder.path().join("parts")));
        assert_eq!(whole, results(&folder.path().join("resumed")));
    }

    /// A run of other trains leaves nothing of the one before.
    #[test]
    fn an_older_parquet_file_does_not_outlive_its_run() {
        let folder = tempfile::tempdir().expect("a folder");
        write_fleet(&folder.path().join("trains"), 2, 4);
        assert!(fleet(folder.path(), &["trains", "--out", "out", "--format", "parquet"]).status.success());
        write_fleet(&folder.path().join("trains"), 3, 4);
        assert!(fleet(folder.path(), &["trains", "--out", "out"]).status.success());
        assert!(!folder.path().join("out/fleet.parquet").exists());
    }
}
