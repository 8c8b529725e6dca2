//! Workers that share a folder: the bytes of one run, whoever comes, goes and is killed; one plan; what is missing is named.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::time::{Duration, SystemTime};

use crate::fleets::{complaint, fleet, lose, parts, results, rows, trainsafe, write_fleet};
use tempfile::TempDir;

const WORK: &[&str] = &["trains", "--out", "parts", "--work"];
const MERGE: &[&str] = &["--merge", "--out", "parts"];

/// A folder of trains, and the results of an undisturbed run of them in `whole`.
fn folder(trains: usize, vehicles: usize) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    write_fleet(&folder.path().join("trains"), trains, vehicles);
    assert!(fleet(folder.path(), &["trains", "--out", "whole"]).status.success());
    folder
}

fn started(folder: &Path) -> Child {
    let mut command = trainsafe(folder);
    command.arg("fleet").args(WORK).stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().expect("trainsafe starts")
}

fn done(folder: &Path, arguments: &[&str]) -> String {
    let output = fleet(folder, arguments);
    assert!(output.status.success(), "{}", complaint(&output));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn refused(folder: &Path, arguments: &[&str], expected: &str) {
    let output = fleet(folder, arguments);
    assert_eq!((output.status.code(), complaint(&output)), (Some(2), expected.to_owned()));
}

fn assert_merged(folder: &Path) {
    done(folder, MERGE);
    assert_eq!(results(&folder.join("whole")), results(&folder.join("parts")));
}

fn signs(out: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(out.join("fleet-parts")).expect("the parts");
    let paths = entries.map(|entry| entry.expect("an entry").path());
    paths.filter(|path| path.extension().is_some_and(|e| e == "alive")).collect()
}

#[test]
fn workers_share_a_run_and_merge_to_its_bytes() {
    let folder = folder(25, 4);
    let workers: Vec<Child> = (0..3).map(|_| started(folder.path())).collect();
    for worker in workers {
        let output = worker.wait_with_output().expect("it ends");
        assert!(output.status.success(), "{}", complaint(&output));
        let told = "every part is done; to join them: trainsafe fleet --merge --out parts\n";
        assert_eq!(String::from_utf8_lossy(&output.stdout), told);
    }
    assert!(signs(&folder.path().join("parts")).is_empty());
    assert_merged(folder.path());
    // One that comes late finds nothing to do, and leaves the results as they are.
    done(folder.path(), WORK);
    assert_eq!(results(&folder.path().join("whole")), results(&folder.path().join("parts")));
}

#[test]
fn what_is_missing_is_named_with_who_is_at_it() {
    let folder = folder(25, 4);
    refused(folder.path(), MERGE, "error: parts holds no run of workers to merge\n");
    done(folder.path(), WORK);
    let out = folder.path().join("parts");
    let total = parts(&out).len();
    lose(&out, |part| part == 1 || part == 3);
    fs::write(out.join("fleet-parts/3.claim"), "node7-4711").expect("a claim");
    fs::write(out.join("fleet-parts/node7-4711.alive"), "").expect("a sign");
    let help = "let its workers finish, start one with --work, or run it again with --resume";
    let [two, four] = ["trains/train-0001.toml to trains/train-0002.toml", "trains/train-0004.toml"];
    let names = format!("2 ({two}), 4 ({four}; node7-4711 has it)");
    refused(folder.path(), MERGE, &format!("error: 2 of {total} parts of the run are missing: {names}: {help}\n"));
    fs::remove_file(out.join("fleet-parts/node7-4711.alive")).expect("a sign");
    done(folder.path(), WORK);
    assert_merged(folder.path());
}

/// Killed with `kill -9` it leaves claims and a sign of life; once that is old, another worker does what it had.
#[test]
#[cfg(unix)]
fn what_a_killed_worker_had_is_done_by_another() {
    let folder = folder(40, 20);
    let out = folder.path().join("parts");
    let mut killed = started(folder.path());
    while parts(&out).len() < 3 {
        assert!(killed.try_wait().expect("a status").is_none(), "it ended before it was killed");
        std::thread::yield_now();
    }
    killed.kill().expect("it can be killed");
    killed.wait().expect("it is dead");
    let signs = signs(&out);
    assert_eq!(signs.len(), 1);
    let sign = File::options().write(true).open(&signs[0]).expect("a sign");
    sign.set_modified(SystemTime::now() - Duration::from_secs(60)).expect("a time");
    let kept: Vec<_> =
        parts(&out).into_iter().map(|part| (fs::metadata(&part).expect("a part").modified().ok(), part)).collect();
    done(folder.path(), WORK);
    for (modified, part) in kept {
        assert_eq!(fs::metadata(&part).expect("a part").modified().ok(), modified, "{} is done twice", part.display());
    }
    assert_merged(folder.path());
}

#[test]
fn the_plan_is_made_once_by_a_worker_that_lives() {
    let folder = folder(25, 4);
    let out = folder.path().join("parts");
    // Another had begun to make it, and was killed.
    fs::create_dir_all(out.join("fleet-parts")).expect("a folder");
    fs::write(out.join("fleet-parts/plan.claim"), "gone").expect("a claim");
    done(folder.path(), WORK);
    // By the plan alone: train files that are not needed are not read again.
    lose(&out, |part| part == 0);
    let last = folder.path().join("trains/train-0024.toml");
    let text = fs::read(&last).expect("a train");
    fs::remove_file(&last).expect("a train");
    done(folder.path(), WORK);
    // One that is needed and not there stops the worker, for the plan has it.
    let parts = parts(&out).len();
    lose(&out, |part| part + 1 == parts);
    let changed = "has changed since the run started: what is done belongs to the old one\n";
    refused(folder.path(), WORK, &format!("error: trains/train-0024.toml {changed}"));
    fs::write(&last, text).expect("a train");
    done(folder.path(), WORK);
    assert_merged(folder.path());
}

/// After a finished run a train file changes: a further worker is refused, and joining warns that the results are of the old file.
#[test]
fn a_finished_plan_of_changed_trains_is_told() {
    let folder = folder(6, 4);
    done(folder.path(), WORK);
    let changed = folder.path().join("trains/train-0003.toml");
    let text = fs::read_to_string(&changed).expect("a train");
    fs::write(&changed, text.replace("1 MN", "0.1 MN")).expect("a train");
    let told = "has changed since the run started: what is done belongs to the old one\n";
    refused(folder.path(), WORK, &format!("error: trains/train-0003.toml {told}"));
    let output = fleet(folder.path(), MERGE);
    let told = "trains/train-0003.toml has changed since the run was planned: the results are of the file as it was";
    assert!(output.status.success() && complaint(&output).contains(told), "{}", complaint(&output));
    assert_eq!(results(&folder.path().join("whole")), results(&folder.path().join("parts")));
}

#[test]
fn a_worker_with_another_command_is_refused() {
    let folder = folder(6, 4);
    done(folder.path(), WORK);
    lose(&folder.path().join("parts"), |part| part == 0);
    let other = "error: parts holds a run of other train files, another study, other options or another version of trainsafe: put \
                 back what it was, or choose another folder with --out DIR\n";
    refused(folder.path(), &[WORK, &["--tolerance", "1e-6"]].concat(), other);
    refused(folder.path(), &["trains/train-0001.toml", "--out", "parts", "--work"], other);
    refused(folder.path(), &["gone.toml", "--out", "new", "--work"], "error: gone.toml does not exist\n");
    assert!(!folder.path().join("new").exists());
    done(folder.path(), WORK);
    assert_merged(folder.path());
}

/// A plan holds a study too, and what each of its inputs reaches; errors, and the reports of the worst, come from it as from a run.
#[test]
fn a_study_goes_by_its_plan() {
    let folder = tempfile::tempdir().expect("a folder");
    write_fleet(&folder.path().join("trains"), 5, 6);
    fs::write(folder.path().join("trains/bad.toml"), "name = 1\n").expect("a bad train");
    let study = "trains = [\"trains\"]\nsamples = 20\n[[vary]]\nkey = \"coupler.rated_load\"\ndistribution = \"weibull\"\n\
                 scale = \"1 MN\"\nshape = 12\nper = \"coupler\"\n";
    fs::write(folder.path().join("study.toml"), study).expect("a study");
    let some = |arguments: &[&str]| {
        let output = fleet(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(3), "{}", complaint(&output));
    };
    some(&["study.toml", "--out", "whole", "--reports", "2"]);
    some(&["study.toml", "--out", "parts", "--work"]);
    let out = folder.path().join("parts");
    lose(&out, |part| part % 2 == 0);
    some(&["study.toml", "--out", "parts", "--work"]);
    some(&["--merge", "--out", "parts", "--reports", "2"]);
    for name in ["fleet.csv", "errors.csv", "fleet.md", "fleet-run.json"] {
        let [whole, parts] =
            ["whole", "parts"].map(|dir| fs::read(folder.path().join(dir).join(name)).expect("results"));
        assert_eq!(whole, parts, "{name}");
    }
    assert_eq!(rows(&out.join("errors.csv")).len(), 20);
    let reports = |dir: &str| fs::read_dir(folder.path().join(dir).join("trains")).expect("reports").count();
    assert_eq!((reports("whole"), reports("parts")), (2, 2));
    let gone = "error: parts is joined already, and its plan is gone: for reports give the paths, with --resume and --reports\n";
    refused(folder.path(), &["--merge", "--out", "parts", "--reports", "2"], gone);
}

/// A file name that is no UTF-8 comes through the plan.
#[test]
#[cfg(target_os = "linux")]
fn any_name_comes_through_the_plan() {
    use std::os::unix::ffi::OsStrExt;
    let folder = tempfile::tempdir().expect("a folder");
    write_fleet(&folder.path().join("trains"), 1, 4);
    let name = std::ffi::OsStr::from_bytes(b"trains/G\xfcterzug.toml");
    fs::rename(folder.path().join("trains/train-0000.toml"), folder.path().join(name)).expect("a name");
    assert!(fleet(folder.path(), &["trains", "--out", "whole"]).status.success());
    done(folder.path(), WORK);
    lose(&folder.path().join("parts"), |_| true);
    done(folder.path(), WORK);
    assert_merged(folder.path());
}
