//! The command line end to end: what is printed where, exit statuses, files.

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;

fn trainsafe(args: &[&str]) -> Output {
    command(args).output().expect("the program starts")
}

fn command(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_trainsafe"));
    command.args(args);
    command
}

fn train(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("trains").join(name).display().to_string()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

fn json_of(args: &[&str]) -> Value {
    let out = trainsafe(args);
    assert_eq!(out.status.code(), Some(0), "{}", text(&out.stderr));
    assert!(out.stderr.is_empty());
    serde_json::from_slice(&out.stdout).expect("JSON and nothing else")
}

/// Figure 4's numbers as the theory gives them, to 1e-10: the first exceedance and the extremum over four transits.
#[test]
fn figure_4_by_the_command_line() {
    let json = json_of(&["analyze", &train("paper-figure-4.toml"), "--json"]);
    let case = &json["scenarios"][0]["cases"][0];
    let link_1 = &case["couplers"][0];
    let close = |value: &Value, exact: f64| (value.as_f64().expect("a number") - exact).abs() < 1e-10;
    assert!(close(&link_1["first_exceeds_s"], 53.152_089_806_626_6));
    assert!(close(&link_1["peak_force_n"], 1.508_352_695_662_44));
    // The peak is flat: its place is only as good as the square root of its height.
    assert!((link_1["peak_time_s"].as_f64().expect("a number") - 157.917_356_441_113).abs() < 1e-6);
    assert_eq!(case["broken_coupler"], 51);
    assert_eq!(case["couplers"].as_array().expect("a list").len(), 50);
    assert!(case["error_bound_n"].as_f64().expect("a number") < 1e-9);
}

/// Figure 5's are Bessel zeros: j11 / 2 and j21 / 2.
#[test]
fn figure_5_by_the_command_line() {
    let json = json_of(&["analyze", &train("paper-figure-5.toml"), "--json"]);
    let link_n = &json["scenarios"][0]["cases"][0]["couplers"][99];
    assert!((link_n["first_exceeds_s"].as_f64().expect("a number") - 1.915_852_985_103_76).abs() < 1e-10);
}

/// A report appears in the named folder, with everything that it points to; the terminal says where.
#[test]
fn analyze_writes_a_report_that_holds_together() {
    let dir = tempfile::tempdir().expect("a folder");
    let out = dir.path().join("a report");
    let run = trainsafe(&["analyze", &train("ore-train.toml"), "--out", &out.display().to_string()]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    assert!(text(&run.stdout).contains("report.md"));
    let report = fs::read_to_string(out.join("report.md")).expect("a report");
    let links = report.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    let figures: Vec<&str> = links.filter(|l| l.ends_with(".svg")).collect();
    assert!(!figures.is_empty());
    for figure in figures {
        let svg = fs::read_to_string(out.join(figure)).unwrap_or_else(|e| panic!("{figure}: {e}"));
        assert!(svg.starts_with("<svg") || svg.starts_with("<?xml"), "{figure}");
    }
    assert!(out.join("couplers.csv").is_file() && out.join("result.json").is_file());
    let left_behind = fs::read_dir(&out).expect("the folder").filter_map(Result::ok);
    assert!(left_behind.into_iter().all(|f| !f.file_name().to_string_lossy().ends_with(".tmp")));
}

/// `--fail-on-exceed` turns a finding into exit status 1, and only then.
#[test]
fn exit_status_tells_a_finding_only_when_asked() {
    let (safe, unsafe_) = (train("ore-train.toml"), train("paper-figure-4.toml"));
    assert_eq!(trainsafe(&["analyze", &unsafe_, "--json"]).status.code(), Some(0));
    assert_eq!(trainsafe(&["analyze", &unsafe_, "--json", "--fail-on-exceed"]).status.code(), Some(1));
    assert_eq!(trainsafe(&["analyze", &safe, "--json", "--fail-on-exceed"]).status.code(), Some(0));
}

/// Bad usage and bad input: status 2, the reason on standard error, nothing on standard output.
#[test]
fn bad_input_is_status_2_and_says_why() {
    let dir = tempfile::tempdir().expect("a folder");
    let file = dir.path().join("bad.toml");
    fs::write(&file, "[coupler]\nstiffness = \"30 furlong\"\nrated_load = \"1 MN\"\n").expect("written");
    let ore = train("ore-train.toml");
    let cases: [(&[&str], &str); 6] = [
        (&["analyze", "nowhere.toml"], "there is no such file"),
        (&["check", &file.display().to_string()], "furlong"),
        (
            &["analyze", &ore, "--scenario", "no such"],
            "no scenario is named \"no such\"; the train has \"knuckle breaks",
        ),
        (&["analyze", &ore, "--json", "--method", "fronts"], "for equal masses and stiffnesses"),
        (&["analyze", &ore, "--tolerance", "0"], "a number between 0 and 1"),
        (&["frobnicate"], "unrecognized subcommand"),
    ];
    let ore_is_unequal = trainsafe(&["analyze", &ore, "--json", "--method", "fronts"]).status.code() == Some(2);
    for (args, reason) in cases {
        if reason.contains("equal masses") && !ore_is_unequal {
            continue;
        }
        let out = trainsafe(args);
        assert_eq!(out.status.code(), Some(2), "{args:?}");
        assert!(out.stdout.is_empty(), "{args:?}");
        assert!(text(&out.stderr).contains(reason), "{args:?}: {}", text(&out.stderr));
    }
}

/// A place that cannot be written to: status 4.
#[test]
fn an_unwritable_place_is_status_4() {
    let dir = tempfile::tempdir().expect("a folder");
    let file = dir.path().join("a file");
    fs::write(&file, "").expect("written");
    let out = trainsafe(&["analyze", &train("ore-train.toml"), "--out", &file.display().to_string()]);
    assert_eq!(out.status.code(), Some(4));
    assert!(text(&out.stderr).contains("a file stands where a folder is needed"), "{}", text(&out.stderr));
}

/// A reader that has seen enough is no failure.
#[test]
fn a_closed_pipe_is_no_panic() {
    let mut child = command(&["analyze", &train("paper-figure-4.toml"), "--json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    drop(child.stdout.take());
    let mut errors = String::new();
    child.stderr.take().expect("a pipe").read_to_string(&mut errors).expect("read");
    assert_eq!(child.wait().expect("it ends").code(), Some(0), "{errors}");
    assert!(errors.is_empty(), "{errors}");
}

/// What `new` prints is right as it is, and runs.
#[test]
fn new_prints_a_file_that_runs() {
    let dir = tempfile::tempdir().expect("a folder");
    let file: PathBuf = dir.path().join("mine.toml");
    fs::write(&file, trainsafe(&["new"]).stdout).expect("written");
    let path = file.display().to_string();
    let check = trainsafe(&["check", &path]);
    assert_eq!(check.status.code(), Some(0), "{}", text(&check.stderr));
    assert!(text(&check.stdout).contains("vehicles"));
    json_of(&["analyze", &path, "--json"]);
}

/// Without `--out` the report goes to `reports/<file stem>` where the program is run.
#[test]
fn the_default_place_is_named_after_the_file() {
    let dir = tempfile::tempdir().expect("a folder");
    let run = command(&["analyze", &train("paper-figure-5.toml")]).current_dir(dir.path()).output().expect("it runs");
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    assert!(dir.path().join("reports/paper-figure-5/report.md").is_file());
}

/// No colours where standard error is no terminal.
#[test]
fn messages_into_a_file_have_no_colours() {
    let out = trainsafe(&["check", "nowhere.toml"]);
    assert!(!text(&out.stderr).contains('\u{1b}'));
}

/// Every method that fits agrees with the planner's choice within both bounds.
#[test]
fn methods_agree_within_their_bounds() {
    let file = train("paper-figure-4.toml");
    let peak = |method: &str| {
        let json = json_of(&["analyze", &file, "--json", "--method", method]);
        let case = json["scenarios"][0]["cases"][0].clone();
        assert_eq!(case["method"], method);
        let number = |v: &Value| v.as_f64().expect("a number");
        (number(&case["couplers"][0]["peak_force_n"]), number(&case["error_bound_n"]))
    };
    let (reference, bound) = peak("modal");
    for method in ["fronts", "propagator"] {
        let (force, its_bound) = peak(method);
        assert!((force - reference).abs() <= bound + its_bound, "{method}");
    }
}

/// With `--verdict-only` couplers that can never exceed are left out, and the verdict stays.
#[test]
fn verdict_only_leaves_out_what_cannot_exceed() {
    let file = train("ore-train.toml");
    let all = json_of(&["analyze", &file, "--json"]);
    let verdict = json_of(&["analyze", &file, "--json", "--verdict-only"]);
    for (a, v) in all["scenarios"].as_array().expect("list").iter().zip(verdict["scenarios"].as_array().expect("list"))
    {
        let (a, v) = (&a["cases"][0], &v["cases"][0]);
        assert_eq!(a["exceeding"], v["exceeding"]);
        let left_out = v["left_out"].as_u64().expect("a number");
        assert_eq!(
            left_out + v["couplers"].as_array().expect("list").len() as u64,
            a["couplers"].as_array().expect("list").len() as u64
        );
    }
}

/// A map that is asked for and not drawn is explained, and only then.
#[test]
fn an_impact_has_no_map_and_says_why() {
    let noted =
        |file: &str, args: &[&str]| text(&trainsafe(&[&["analyze", &train(file), "--json"], args].concat()).stderr);
    let why = "note: twelve cars couple to the standing rest at 6 mph: --map does nothing for an impact: its safe factor on the speed";
    let (hauled, impact) =
        ("hauled-train-on-a-grade.toml", ["--scenario", "twelve cars couple to the standing rest at 6 mph"]);
    assert!(noted(hauled, &[&["--map"], &impact[..]].concat()).starts_with(why));
    assert!(!noted(hauled, &impact).contains("note:"));
    assert!(!noted("paper-figure-4.toml", &["--map"]).contains("note:"));
}

/// The same bytes for any number of threads, but for the run times.
#[test]
fn results_do_not_depend_on_threads() {
    let by = |threads: &str| {
        let mut run = command(&["analyze", &train("european-freight-train.toml"), "--json"]);
        let out = run.env("RAYON_NUM_THREADS", threads).output().expect("it runs");
        let lines = text(&out.stdout);
        lines.lines().filter(|l| !l.contains("run_time_s")).map(str::to_owned).collect::<Vec<String>>()
    };
    let alone = by("1");
    assert!(alone.len() > 1000);
    assert_eq!(alone, by("2"));
    assert_eq!(alone, by("7"));
}

/// A report in one form takes the place of one in the other, and nothing else in the folder.
#[test]
fn one_form_of_report_replaces_the_other() {
    let dir = tempfile::tempdir().expect("a folder");
    let files = || {
        let entries = dir.path().read_dir().expect("a folder");
        let mut names: Vec<String> =
            entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    };
    fs::write(dir.path().join("notes.md"), "mine").expect("a file");
    let out = dir.path().display().to_string();
    let run = |form: &str| {
        let run = trainsafe(&["analyze", &train("paper-figure-4.toml"), "--out", &out, "--format", form]);
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
        let of_the_pictures = |name: &String| !name.ends_with(".svg");
        (files().into_iter().filter(of_the_pictures).collect::<Vec<String>>(), files().len())
    };
    let (words, all) = run("md");
    assert_eq!(words, ["couplers.csv", "notes.md", "report.md", "result.json"]);
    assert!(all > words.len(), "the Markdown's pictures are files");
    let (words, all) = run("html");
    assert_eq!(words, ["couplers.csv", "notes.md", "report.html", "result.json"]);
    assert_eq!(all, words.len(), "the page holds its pictures");
    assert_eq!(run("md").0, ["couplers.csv", "notes.md", "report.md", "result.json"]);
}

/// The committed sample reports are what the program writes, but for the run times.
#[test]
fn sample_reports_are_up_to_date() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let dir = tempfile::tempdir().expect("a folder");
    for name in ["paper-figure-4", "mixed-manifest-train"] {
        let out = dir.path().join(name);
        let args = ["analyze", &train(&format!("{name}.toml")), "--out", &out.display().to_string()];
        // The day of the samples.
        let run = command(&args).env("SOURCE_DATE_EPOCH", "1796083200").output().expect("the program starts");
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
        // Words alone: pictures and their data may differ in a last bit from processor to processor.
        let without_times = |path: PathBuf| {
            let report = fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
            // The samples were made from the project's folder, with the train's path from there.
            let report = report.replace(&format!("{}/", root.display()), "");
            let words = report.split("<footer>").next().unwrap_or_default();
            let lines = words
                .lines()
                .filter(|l| !l.starts_with("<svg"))
                .map(|l| l.split("Run time").next().unwrap_or_default().to_owned());
            lines.collect::<Vec<String>>()
        };
        let pages = if name == "paper-figure-4" { &["report.md", "report.html"][..] } else { &["report.md"] };
        for page in pages {
            let kept = without_times(root.join("reports/samples").join(name).join(page));
            assert_eq!(without_times(out.join(page)), kept, "{name}: run tests/samples.sh");
        }
    }
}
