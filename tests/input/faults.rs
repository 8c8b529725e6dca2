//! What can go wrong around `analyze`, end to end: folders that cannot be written, signals, several runs at once, readers that
//! leave. Whatever happens, a file under its final name is whole, and an earlier report stays until a new one replaces it.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

const PROGRAM: &str = env!("CARGO_BIN_EXE_trainsafe");

fn analyze(train: &Path, out: &Path) -> Command {
    let mut command = Command::new(PROGRAM);
    command.arg("analyze").arg(train).arg("--out").arg(out);
    command
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Two trains whose reports have other numbers, and not even the same figures.
fn trains(dir: &Path) -> [PathBuf; 2] {
    let file = |name: &str, cars: usize, scenario: &str| {
        let path = dir.join(format!("{name}.toml"));
        let content = format!(
            "name = \"{name}\"\n[coupler]\nstiffness = \"30 MN/m\"\nrated_load = \"1 MN\"\n[load]\nuniform = \"70 %\"\n\
             [[vehicle]]\nmass = \"195 t\"\n[[vehicle]]\nmass = \"160 t\"\ncount = {cars}\n[[scenario]]\n{scenario}\n"
        );
        fs::write(&path, content).expect("a train file");
        path
    };
    [file("first", 20, "kind = \"break\"\ncoupler = \"each\""), file("second", 27, "kind = \"break\"\ncoupler = 27")]
}

/// The name of the train that a folder's report is of, all of whose files must be of the same run and nothing else be there.
fn report_in(dir: &Path) -> String {
    let read = |name: &str| fs::read_to_string(dir.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
    let report = read("report.md");
    let json: serde_json::Value = serde_json::from_str(&read("result.json")).expect("JSON");
    let name = json["train"].as_str().expect("a name").to_owned();
    assert!(
        report.starts_with(&format!("# {name}\n")),
        "the report is of {}, the JSON of {name}",
        report.lines().next().unwrap_or_default()
    );
    let cases = json["scenarios"][0]["cases"].as_array().expect("cases").len();
    let couplers = json["couplers"].as_u64().expect("a number") as usize;
    assert_eq!(read("couplers.csv").lines().count(), 1 + cases * (couplers - 1), "rows of {name}");
    let shown =
        report.split("](").skip(1).filter_map(|rest| rest.split(')').next()).filter(|link| link.ends_with(".svg"));
    let shown: BTreeSet<String> = shown.map(str::to_owned).collect();
    for figure in &shown {
        assert!(read(figure).trim_end().ends_with("</svg>"), "{figure} is not whole");
    }
    let others = ["report.md", "report.html", "result.json", "couplers.csv"].map(str::to_owned);
    assert_eq!(names_in(dir), shown.into_iter().chain(others).collect(), "files of {name}");
    name
}

fn names_in(dir: &Path) -> BTreeSet<String> {
    let entries = fs::read_dir(dir).expect("a folder");
    entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect()
}

#[test]
fn a_missing_folder_is_made_with_those_above_it() {
    let dir = tempfile::tempdir().expect("a folder");
    let [first, _] = trains(dir.path());
    let out = dir.path().join("a/b/c");
    assert!(analyze(&first, &out).status().expect("it runs").success());
    assert_eq!(report_in(&out), "first");
}

/// Seen before the work is done, said with what would help, and nothing is touched.
#[test]
fn a_file_in_the_folder_s_place_is_left_alone() {
    let dir = tempfile::tempdir().expect("a folder");
    let [first, _] = trains(dir.path());
    let file = dir.path().join("file");
    fs::write(&file, "mine").expect("written");
    for (command, out) in [("analyze", file.clone()), ("analyze", file.join("below")), ("accuracy", file.clone())] {
        let run = Command::new(PROGRAM).arg(command).arg(&first).arg("--out").arg(&out).output().expect("it runs");
        assert_eq!(run.status.code(), Some(4), "{}", text(&run.stderr));
        assert!(text(&run.stderr).contains("a file stands where a folder is needed"), "{}", text(&run.stderr));
        assert_eq!(fs::read_to_string(&file).expect("still there"), "mine");
    }
}

/// A folder in the place of one of the files: none of the others is replaced.
#[test]
fn a_folder_in_a_file_s_place_leaves_the_earlier_report() {
    let dir = tempfile::tempdir().expect("a folder");
    let [first, second] = trains(dir.path());
    let out = dir.path().join("out");
    assert!(analyze(&first, &out).status().expect("it runs").success());
    let before = fs::read(out.join("couplers.csv")).expect("rows");
    fs::remove_file(out.join("report.md")).expect("removed");
    fs::create_dir(out.join("report.md")).expect("a folder");
    let run = analyze(&second, &out).output().expect("it runs");
    assert_eq!(run.status.code(), Some(4));
    assert!(text(&run.stderr).contains("a folder stands where the file must go"), "{}", text(&run.stderr));
    assert_eq!(fs::read(out.join("couplers.csv")).expect("rows"), before);
    assert!(names_in(&out).iter().all(|n| !n.starts_with(".trainsafe")));
}

/// Runs a shell script in a mount namespace of its own, `$1` the program, `$2` a folder to mount on, `$3` and `$4` trains; `None`
/// with a reason printed where that is not allowed.
#[cfg(target_os = "linux")]
fn with_mounts(script: &str) -> Option<Output> {
    let dir = tempfile::tempdir().expect("a folder");
    let [first, second] = trains(dir.path());
    let place = dir.path().join("place");
    fs::create_dir(&place).expect("a folder");
    let script = format!("mount -t tmpfs -o size=24m none \"$2\" || exit 99\n{script}");
    let run = Command::new("unshare")
        .args(["-rm", "sh", "-c", &script, "sh", PROGRAM])
        .args([&place, &first, &second])
        .output();
    match run {
        Ok(run) if run.status.code() != Some(99) && !text(&run.stderr).contains("unshare") => Some(run),
        Ok(run) => {
            eprintln!("skipped: no file system can be mounted here: {}", text(&run.stderr));
            None
        }
        Err(e) => {
            eprintln!("skipped: there is no unshare: {e}");
            None
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_read_only_folder_is_status_4_and_keeps_the_earlier_report() {
    let script = "\"$1\" analyze \"$3\" --out \"$2/out\" >&2 && cp -r \"$2/out\" \"$2/before\" && mount -o remount,bind,ro \"$2\" || exit 98
        \"$1\" analyze \"$4\" --out \"$2/out\" >&2; echo status $?
        \"$1\" analyze \"$4\" --out \"$2/new\" >&2; echo status $?
        diff -r \"$2/out\" \"$2/before\" && echo same";
    let Some(run) = with_mounts(script) else { return };
    assert_eq!(text(&run.stdout), "status 4\nstatus 4\nsame\n", "{}", text(&run.stderr));
    assert!(
        text(&run.stderr).contains("choose a folder on a disk that can be written to with --out DIR"),
        "{}",
        text(&run.stderr)
    );
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_status_4_and_keeps_the_earlier_report() {
    let script = "\"$1\" analyze \"$3\" --out \"$2/out\" >&2 && cp -r \"$2/out\" \"$2/before\" || exit 98
        dd if=/dev/zero of=\"$2/filling\" bs=1k 2>/dev/null
        \"$1\" analyze \"$4\" --out \"$2/out\" >&2; echo status $?
        diff -r \"$2/out\" \"$2/before\" && echo same
        rm \"$2/filling\"; \"$1\" analyze \"$4\" --out \"$2/out\" >&2; echo status $?";
    let Some(run) = with_mounts(script) else { return };
    assert_eq!(text(&run.stdout), "status 4\nsame\nstatus 0\n", "{}", text(&run.stderr));
    assert!(text(&run.stderr).contains("free some space"), "{}", text(&run.stderr));
}

/// Without permission, as a user who is not root; where root runs the tests, as nobody.
#[cfg(unix)]
#[test]
fn a_folder_without_permission_is_status_4() {
    use std::os::unix::fs::PermissionsExt;
    let dir = tempfile::tempdir().expect("a folder");
    let [first, _] = trains(dir.path());
    let (out, copy) = (dir.path().join("out"), dir.path().join("trainsafe"));
    fs::create_dir(&out).expect("a folder");
    let allow = |path: &Path, mode| fs::set_permissions(path, fs::Permissions::from_mode(mode)).expect("permissions");
    let probe = |command: &mut Command| command.output().ok().filter(|run| run.status.code() != Some(127));
    allow(&out, 0o555);
    let run = if tempfile::tempfile_in(&out).is_err() {
        analyze(&first, &out).output().ok()
    } else {
        fs::copy(PROGRAM, &copy).expect("a copy that everyone may run");
        [dir.path(), &copy].iter().for_each(|path| allow(path, 0o755));
        let nobody = ["--reuid=65534", "--regid=65534", "--clear-groups"];
        let reaches = Command::new("setpriv").args(nobody).arg(&copy).arg("new").output();
        match reaches.is_ok_and(|run| run.status.success()) {
            true => {
                probe(Command::new("setpriv").args(nobody).arg(&copy).arg("analyze").arg(&first).arg("--out").arg(&out))
            }
            false => None,
        }
    };
    let Some(run) = run else {
        return eprintln!("skipped: root may write everywhere, and nobody else can be had here");
    };
    assert_eq!(run.status.code(), Some(4), "{}", text(&run.stderr));
    assert!(
        text(&run.stderr).contains("choose a folder that you may write to with --out DIR"),
        "{}",
        text(&run.stderr)
    );
    allow(&out, 0o755);
}

/// The folder vanishes at some moment: the report is written anew, or it is said that it could not be.
#[test]
fn a_folder_removed_meanwhile_is_made_again_or_said() {
    let dir = tempfile::tempdir().expect("a folder");
    let [first, second] = trains(dir.path());
    let out = dir.path().join("out");
    for delay in [0, 4, 12, 24] {
        assert!(analyze(&second, &out).status().expect("it runs").success());
        let run = analyze(&first, &out).stderr(Stdio::piped()).stdout(Stdio::null()).spawn().expect("it starts");
        sleep(Duration::from_millis(delay));
        // Whether this comes too early or too late.
        let removed = fs::remove_dir_all(&out);
        let run = run.wait_with_output().expect("it ends");
        match run.status.code() {
            Some(0) => assert!(!out.exists() || removed.is_err() || report_in(&out) == "first"),
            status => assert!(status == Some(4) && text(&run.stderr).contains("cannot write"), "{}", text(&run.stderr)),
        }
        let _ = fs::remove_dir_all(&out);
    }
}

/// A pipe gives its text once: a train file is opened and read once, so that a report is of one version of it.
#[cfg(unix)]
#[test]
fn a_train_file_is_read_once() {
    let dir = tempfile::tempdir().expect("a folder");
    let [first, _] = trains(dir.path());
    let (pipe, out) = (dir.path().join("pipe.toml"), dir.path().join("out"));
    if !Command::new("mkfifo").arg(&pipe).status().is_ok_and(|s| s.success()) {
        return eprintln!("skipped: there is no mkfifo");
    }
    let mut run = analyze(&pipe, &out).stdout(Stdio::null()).spawn().expect("it starts");
    let content = fs::read(&first).expect("the train");
    let writer = std::thread::spawn(move || fs::write(pipe, content));
    let status = ends(&mut run);
    assert!(status.is_some_and(|s| s.success()), "{status:?}");
    writer.join().expect("the writer").expect("written");
    assert_eq!(report_in(&out), "first");
}

/// The child's status; `None`, and its end, if it takes longer than a minute.
fn ends(child: &mut std::process::Child) -> Option<ExitStatus> {
    let start = Instant::now();
    while start.elapsed() < Duration::from_secs(60) {
        if let Some(status) = child.try_wait().expect("a child") {
            return Some(status);
        }
        sleep(Duration::from_millis(5));
    }
    child.kill().expect("killed");
    None
}

/// The train file is replaced again and again meanwhile: each report is of one version.
#[test]
fn a_train_file_that_changes_is_analysed_as_it_once_was() {
    let dir = tempfile::tempdir().expect("a folder");
    let versions = trains(dir.path()).map(|path| fs::read(path).expect("a train"));
    let (file, beside) = (dir.path().join("train.toml"), dir.path().join("beside.toml"));
    let put =
        |i: usize| fs::write(&beside, &versions[i % 2]).and_then(|()| fs::rename(&beside, &file)).expect("replaced");
    put(0);
    for i in 1..8 {
        let out = dir.path().join(i.to_string());
        let mut run = analyze(&file, &out).stdout(Stdio::null()).spawn().expect("it starts");
        let mut n = 0;
        while run.try_wait().expect("a child").is_none() {
            n += 1;
            put(n);
        }
        assert!(["first", "second"].contains(&report_in(&out).as_str()));
    }
}

#[cfg(unix)]
fn send(signal: &str, pid: u32) {
    let sent = Command::new("kill").args([format!("-{signal}"), pid.to_string()]).stderr(Stdio::null()).status();
    // The process may have ended before.
    sent.expect("kill");
}

/// Signals at some moment of a run: then the folder holds the earlier report or the new one, all of it, and nothing else.
#[cfg(unix)]
#[test]
fn a_signal_leaves_the_earlier_report_or_the_new_one() {
    let dir = tempfile::tempdir().expect("a folder");
    let (both, out) = (trains(dir.path()), dir.path().join("out"));
    assert!(analyze(&both[1], &out).status().expect("it runs").success());
    for (i, delay) in (0..36).map(|i| (i, i)) {
        let before = report_in(&out);
        let mut run = analyze(&both[i % 2], &out).stdout(Stdio::null()).spawn().expect("it starts");
        sleep(Duration::from_millis(delay as u64));
        let (signal, number) = if i % 4 < 2 { ("INT", 2) } else { ("TERM", 15) };
        send(signal, run.id());
        let status = ends(&mut run).expect("it ends");
        use std::os::unix::process::ExitStatusExt;
        let told = status.code() == Some(128 + number) || status.signal() == Some(number);
        let after = report_in(&out);
        assert!(told || status.success(), "{status:?}");
        assert!(after == before || after == ["first", "second"][i % 2]);
    }
}

/// After a kill every file is whole, and the next run tidies up.
#[cfg(unix)]
#[test]
fn a_kill_leaves_whole_files_and_the_next_run_tidies_up() {
    let dir = tempfile::tempdir().expect("a folder");
    let (both, out) = (trains(dir.path()), dir.path().join("out"));
    assert!(analyze(&both[1], &out).status().expect("it runs").success());
    for delay in 0..24 {
        let mut run = analyze(&both[delay % 2], &out).stdout(Stdio::null()).spawn().expect("it starts");
        sleep(Duration::from_millis(delay as u64));
        send("KILL", run.id());
        ends(&mut run).expect("it ends");
        for name in names_in(&out).iter().filter(|n| !n.starts_with('.')) {
            let content = fs::read_to_string(out.join(name)).expect("text");
            let whole = match name.rsplit('.').next() {
                Some("json") => serde_json::from_str::<serde_json::Value>(&content).is_ok(),
                Some("svg") => content.trim_end().ends_with("</svg>"),
                _ => content.ends_with('\n'),
            };
            assert!(whole, "{name} is not whole");
        }
    }
    // What a kill in the middle of writing leaves; held by nobody.
    fs::write(out.join(".trainsafe-abcdef.tmp"), "half").expect("written");
    assert!(analyze(&both[0], &out).status().expect("it runs").success());
    assert_eq!(report_in(&out), "first");
}

#[test]
fn runs_into_one_folder_at_once_leave_the_report_of_one() {
    let dir = tempfile::tempdir().expect("a folder");
    let (both, out) = (trains(dir.path()), dir.path().join("out"));
    for _ in 0..4 {
        let start = |i: usize| analyze(&both[i % 2], &out).stdout(Stdio::null()).spawn().expect("it starts");
        let mut runs: Vec<_> = (0..6).map(start).collect();
        for run in &mut runs {
            assert!(ends(run).is_some_and(|status| status.success()));
        }
        report_in(&out);
    }
}

/// What is printed can be cut off anywhere; what cannot be printed for want of space is told.
#[cfg(unix)]
#[test]
fn standard_output_that_closes_or_is_full() {
    let dir = tempfile::tempdir().expect("a folder");
    let [first, _] = trains(dir.path());
    let first = first.display().to_string();
    let out = dir.path().join("out").display().to_string();
    let commands: [&[&str]; 4] =
        [&["new"], &["check", &first], &["analyze", &first, "--json"], &["analyze", &first, "--out", &out]];
    for args in commands {
        let mut run =
            Command::new(PROGRAM).args(args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
        drop(run.stdout.take());
        let run = run.wait_with_output().expect("it ends");
        assert!(run.status.success() && run.stderr.is_empty(), "{args:?}: {}", text(&run.stderr));
        let Ok(full) = fs::File::options().write(true).open("/dev/full") else { continue };
        let run = Command::new(PROGRAM).args(args).stdout(full).stderr(Stdio::piped()).spawn().expect("it starts");
        let run = run.wait_with_output().expect("it ends");
        assert_eq!(run.status.code(), Some(4), "{args:?}: {}", text(&run.stderr));
        assert!(text(&run.stderr).contains("cannot write to standard output"), "{args:?}: {}", text(&run.stderr));
    }
}

/// A link or a pipe in a file's place is replaced, never followed or opened.
#[cfg(unix)]
#[test]
fn what_stands_in_a_file_s_place_is_replaced_not_followed() {
    let dir = tempfile::tempdir().expect("a folder");
    let [first, _] = trains(dir.path());
    let (out, elsewhere) = (dir.path().join("out"), dir.path().join("elsewhere"));
    fs::create_dir(&out).expect("a folder");
    fs::write(&elsewhere, "mine").expect("written");
    std::os::unix::fs::symlink(&elsewhere, out.join("report.md")).expect("a link");
    let piped = Command::new("mkfifo").arg(out.join("result.json")).status().is_ok_and(|s| s.success());
    let mut run = analyze(&first, &out).stdout(Stdio::null()).spawn().expect("it starts");
    assert!(ends(&mut run).is_some_and(|status| status.success()), "a pipe in the way: {piped}");
    assert_eq!(fs::read_to_string(&elsewhere).expect("still there"), "mine");
    assert_eq!(report_in(&out), "first");
}
