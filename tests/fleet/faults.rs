//! Fleets in trouble: what is not there, a full disk, signals, two runs at once, a folder that goes; rows stay whole.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use crate::fleets::{complaint, fleet, parts, results, trainsafe, write_fleet};
use tempfile::TempDir;

fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

/// Starts a run in a folder that takes seconds, and waits until it has kept a few parts.
fn started(folder: &Path, out: &str) -> Child {
    write_fleet(&folder.join("trains"), 60, 60);
    let mut command = trainsafe(folder);
    command.args(["fleet", "trains", "--out", out]).stdout(Stdio::null()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("trainsafe starts");
    while parts(&folder.join(out)).len() < 3 {
        assert!(child.try_wait().expect("a status").is_none(), "it ended before it was disturbed");
        std::thread::yield_now();
    }
    child
}

fn ended(child: Child) -> (Option<i32>, String) {
    let output = child.wait_with_output().expect("it ends");
    (output.status.code(), complaint(&output))
}

fn assert_whole(out: &Path) {
    for part in parts(out) {
        let text = fs::read_to_string(&part).expect("a part");
        assert!(text.is_empty() || text.ends_with('\n'), "{} ends within a row", part.display());
    }
}

#[test]
fn what_is_not_there_is_told_before_anything_is_written() {
    let folder = folder();
    write_fleet(&folder.path().join("trains"), 1, 3);
    fs::create_dir(folder.path().join("empty")).expect("a folder");
    fs::write(
        folder.path().join("study.toml"),
        "trains = [\"trains\", \"gone.toml\"]\n[[vary]]\nkey = \"load.uniform\"\nvalues = [\"1 kN\"]\n",
    )
    .expect("a study");
    let cases = [
        (&["trains", "no-such.toml"][..], "error: no-such.toml does not exist\n"),
        (&["trains", "empty"], "error: empty has no train file (*.toml) in it or below\n"),
        (&["trains", "*.tom"], "error: *.tom matches no file\n"),
        (&["study.toml"], "error: gone.toml does not exist\n"),
    ];
    for (paths, expected) in cases {
        let output = fleet(folder.path(), &[paths, &["--out", "out"]].concat());
        assert_eq!(output.status.code(), Some(2), "{paths:?}");
        assert_eq!(complaint(&output), expected);
        assert!(!folder.path().join("out").exists());
    }
}

/// A disk of its own, which is really full, in a namespace of its own, so that nothing is left mounted.
#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_status_4_and_with_room_again_the_run_goes_on() {
    let folder = folder();
    let apart = |script: &str| {
        let mut command = Command::new("unshare");
        command.args(["--mount", "--map-root-user", "sh", "-euc", script]).current_dir(folder.path());
        command.env("TRAINSAFE", env!("CARGO_BIN_EXE_trainsafe")).env("NO_COLOR", "1").output()
    };
    let mount = "mkdir -p disk && mount -t tmpfs -o size=64k tmpfs disk";
    if !apart(mount).is_ok_and(|output| output.status.success()) {
        println!("skipped: a disk of one's own cannot be mounted here");
        return;
    }
    write_fleet(&folder.path().join("trains"), 30, 24);
    assert!(fleet(folder.path(), &["trains", "--out", "whole", "--format", "csv"]).status.success());
    let script = format!(
        "{mount}
        \"$TRAINSAFE\" fleet trains --out disk/out --format csv || echo $? > status
        cp -r disk/out full
        mount -o remount,size=8m disk
        \"$TRAINSAFE\" fleet trains --out disk/out --format csv --resume
        cp -r disk/out resumed"
    );
    let output = apart(&script).expect("sh runs");
    let said = complaint(&output);
    assert!(output.status.success(), "{said}");
    assert_eq!(fs::read_to_string(folder.path().join("status")).expect("a status"), "4\n");
    assert!(said.contains("No space left on device (os error 28); free some space, or"), "{said}");
    assert!(said.contains("cases that are done are kept: to go on, give the same command with --resume"), "{said}");
    assert!(!parts(&folder.path().join("full")).is_empty());
    assert_whole(&folder.path().join("full"));
    assert_eq!(results(&folder.path().join("whole")), results(&folder.path().join("resumed")));
}

#[test]
#[cfg(unix)]
fn a_signal_stops_a_run_at_once_and_says_how_to_go_on() {
    for (signal, status) in [("-INT", 130), ("-TERM", 143)] {
        let folder = folder();
        let child = started(folder.path(), "out");
        let kill = Command::new("kill").args([signal, &child.id().to_string()]).status();
        assert!(kill.expect("kill runs").success());
        let (code, said) = ended(child);
        assert_eq!(code, Some(status));
        assert_eq!(said, "stopped; cases that are done are kept: to go on, give the same command with --resume\n");
        assert_whole(&folder.path().join("out"));
    }
}

#[test]
fn a_folder_has_one_run_at_a_time() {
    let folder = folder();
    let mut first = started(folder.path(), "out");
    for second in [&["trains", "--out", "out", "--resume"][..], &["trains", "--out", "out", "--work"]] {
        let output = fleet(folder.path(), second);
        assert_eq!(output.status.code(), Some(2));
        let expected =
            "error: another run is under way in out: wait until it is done, or choose another folder with --out DIR\n";
        assert_eq!(complaint(&output), expected);
    }
    assert!(first.try_wait().expect("a status").is_none(), "the first run ended too early to tell");
    // Its death, whatever the cause, lets others in.
    first.kill().expect("it can be killed");
    first.wait().expect("it is dead");
    let next = fleet(folder.path(), &["trains", "--out", "out", "--work"]);
    assert!(next.status.success(), "{}", complaint(&next));
}

#[test]
#[cfg(unix)]
fn a_folder_that_goes_while_the_program_runs_is_status_4() {
    let folder = folder();
    let child = started(folder.path(), "out");
    fs::rename(folder.path().join("out"), folder.path().join("elsewhere")).expect("it can be moved");
    let (code, said) = ended(child);
    assert_eq!(code, Some(4), "{said}");
    assert!(said.contains("the folder is gone or takes no new files: choose another folder with --out DIR"), "{said}");
    assert!(!said.contains("are kept") && !folder.path().join("out").exists(), "{said}");
}

#[test]
fn a_reader_that_leaves_early_is_no_failure() {
    let folder = folder();
    write_fleet(&folder.path().join("trains"), 3, 20);
    for arguments in [&["trains", "--json"][..], &["trains", "--out", "out"]] {
        let mut command = trainsafe(folder.path());
        command.arg("fleet").args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().expect("trainsafe starts");
        let mut first = BufReader::with_capacity(1, child.stdout.take().expect("its output"));
        if arguments[1] == "--json" {
            first.read_line(&mut String::new()).expect("a line");
        }
        drop(first);
        let (code, said) = ended(child);
        assert_eq!(code, Some(0), "{said}");
        assert!(!said.contains("panicked") && !said.contains("error"), "{said}");
    }
    assert!(folder.path().join("out/fleet.md").exists());
}
