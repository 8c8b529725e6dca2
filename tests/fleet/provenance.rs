//! What the reports of a run say they were made from: program, date, options, study and every file with its checksum.

use std::fs;
use std::path::Path;
use std::process::Output;

use sha2::{Digest, Sha256};

use crate::fleets::{complaint, trainsafe, write_fleet};

const EPOCH: &str = "1796083200";

/// Runs a fleet on a day that is set.
fn run(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = trainsafe(folder);
    command.env("SOURCE_DATE_EPOCH", EPOCH).arg("fleet").args(arguments).output().expect("trainsafe runs")
}

fn done(folder: &Path, arguments: &[&str]) {
    let output = run(folder, arguments);
    assert!(output.status.success(), "{}", complaint(&output));
}

fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

fn reports(out: &Path) -> [String; 2] {
    ["fleet.md", "fleet.html"].map(|name| fs::read_to_string(out.join(name)).expect("a report"))
}

#[test]
fn a_study_s_reports_repeat_its_inputs_and_name_every_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let dir = folder.path();
    write_fleet(&dir.join("trains"), 2, 4);
    let gear = "travel [mm],loading [kN],unloading [kN]\n0,0,0\n80,2000,500\n";
    fs::write(dir.join("trains/gear.csv"), gear).expect("a gear");
    let path = dir.join("trains/train-0001.toml");
    let text = fs::read_to_string(&path).expect("a train");
    let geared = "gear = \"gear.csv\"\nsolid_stiffness = \"200 MN/m\"";
    fs::write(&path, text.replace("stiffness = \"30 MN/m\"", geared)).expect("a train");
    let study = "trains = [\"trains\"]\nsamples = 6\nseed = 11\nlatin_hypercube = true\n\
                 [[vary]]\nkey = \"coupler.rated_load\"\ndistribution = \"normal\"\nmean = \"1.5 MN\"\nsd = \"0.1 MN\"\nper = \"coupler\"\n\
                 [[vary]]\nkey = \"load.uniform\"\nvalues = [\"500 kN\", \"0.6 MN\"]\n";
    fs::write(dir.join("study.toml"), study).expect("a study");
    done(dir, &["study.toml", "--out", "whole", "--format", "md,html"]);
    let [markdown, page] = reports(&dir.join("whole"));
    let version = env!("CARGO_PKG_VERSION");
    for text in [&markdown, &page] {
        let made = format!("Made by trainsafe {version} on 2026-12-01; tolerance 1e-9 of the largest rating");
        assert!(text.contains(&made), "{text}");
        assert!(text.contains("6 samples of each train, with the seed 11, a Latin hypercube."), "{text}");
        for name in ["study.toml", "trains/gear.csv", "trains/train-0000.toml", "trains/train-0001.toml"] {
            assert!(
                text.contains(name) && text.contains(&sha256(&fs::read(dir.join(name)).expect("a file"))),
                "{name}"
            );
        }
    }
    let normal = "| coupler.rated\\_load | distribution normal; mean 1.5 MN; sd 0.1 MN | coupler |";
    assert!(markdown.contains(normal), "{markdown}");
    assert!(markdown.contains("| load.uniform | values 500 kN, 0.6 MN | train |"), "{markdown}");
    assert!(!markdown.contains("sha256sum"), "all files are listed: {markdown}");
    // The same of workers, and of a run that goes on where all is done.
    done(dir, &["study.toml", "--out", "parts", "--work"]);
    done(dir, &["--merge", "--out", "parts", "--format", "md,html"]);
    assert_eq!(reports(&dir.join("parts")), [markdown.clone(), page.clone()]);
    done(dir, &["study.toml", "--out", "whole", "--resume", "--format", "md,html"]);
    assert_eq!(reports(&dir.join("whole")), [markdown, page]);
}

/// Of many files the first are listed, and the list of all has a checksum that `sha256sum` reproduces.
#[test]
fn many_files_are_named_by_the_checksum_of_their_list() {
    let folder = tempfile::tempdir().expect("a folder");
    let dir = folder.path();
    write_fleet(&dir.join("trains"), 23, 3);
    done(dir, &["trains", "--out", "out", "--format", "md,html"]);
    let line = |number: usize| {
        let name = format!("trains/train-{number:04}.toml");
        format!("{}  {name}\n", sha256(&fs::read(dir.join(&name)).expect("a train")))
    };
    let list: String = (0..23).map(line).collect();
    for text in reports(&dir.join("out")) {
        assert!(text.contains("The first 20 of 23 files that were read"), "{text}");
        assert!(text.contains(&sha256(list.as_bytes())), "{text}");
        let sums = (0..23).map(|n| text.contains(&line(n)[..64]));
        assert_eq!(sums.collect::<Vec<_>>(), (0..23).map(|n| n < 20).collect::<Vec<_>>());
    }
}

#[test]
fn a_wrong_date_is_told_before_anything_is_computed() {
    let folder = tempfile::tempdir().expect("a folder");
    write_fleet(&folder.path().join("trains"), 1, 3);
    let mut command = trainsafe(folder.path());
    let output = command.env("SOURCE_DATE_EPOCH", "today").args(["fleet", "trains", "--out", "out"]).output();
    let output = output.expect("trainsafe runs");
    assert_eq!(output.status.code(), Some(2));
    assert!(complaint(&output).contains("SOURCE_DATE_EPOCH"), "{}", complaint(&output));
    assert!(!folder.path().join("out").exists());
}
