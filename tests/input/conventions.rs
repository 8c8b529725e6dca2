//! What is usual on a command line: standard input, many files, JSON for editors, quiet, threads, colour.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::{Value, json};

const GOOD: &str = "\
[coupler]
stiffness = \"30 MN/m\"
rated_load = \"1.5 MN\"
[[vehicle]]
count = 3
mass = \"80 t\"
[load]
uniform = \"0.5 MN\"
";

/// Two slips; the second line has characters of several bytes before its problem.
const BAD: &str = "\
[coupler]
stiffness = \"30 MN/m\"
rated_load = \"1.5 t\"
[[vehicle]]
mass = \"80 t\"
[[vehicle]]
label = \"Gr\u{fc}n\", mass = \"80 t\"
";

fn run(folder: &Path, args: &[&str], input: &str) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_trainsafe"))
        .args(args)
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut pipe = child.stdin.take().expect("a pipe");
    pipe.write_all(input.as_bytes()).expect("written");
    drop(pipe);
    child.wait_with_output().expect("it ends")
}

/// Exit status, standard output, standard error.
fn told(folder: &Path, args: &[&str], input: &str) -> (i32, String, String) {
    let out = run(folder, args, input);
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
    (out.status.code().expect("a status"), text(out.stdout), text(out.stderr))
}

fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        fs::write(folder.path().join(name), text).expect("written");
    }
    folder
}

/// `-` is a train like one in a file: named "train", its files beside the current folder, its problems in `<stdin>`.
#[test]
fn standard_input_is_read() {
    let folder = folder(&[("consist.csv", "mass [t]\n80\n80\n80\n")]);
    let by_table = GOOD.replace("[[vehicle]]\ncount = 3\nmass = \"80 t\"\n", "");
    let (status, out, err) = told(folder.path(), &["check", "-"], &format!("vehicles = \"consist.csv\"\n{by_table}"));
    assert_eq!((status, err.as_str()), (0, ""));
    assert!(out.starts_with("train\n3 vehicles, 2 couplers, 240 t\n"), "{out}");
    let (status, out, _) = told(folder.path(), &["analyze", "-", "--json"], GOOD);
    let json: Value = serde_json::from_str(&out).expect("JSON");
    assert_eq!((status, &json["train"], &json["inputs"][0]["path"]), (0, &json!("train"), &json!("<stdin>")));
    let (status, _, err) = told(folder.path(), &["analyze", "-", "-o", "out"], &GOOD.replace("80 t", "80 MN"));
    assert_eq!(status, 2);
    assert!(err.contains("--> <stdin>:6:8"), "{err}");
    let (status, out, err) = told(folder.path(), &["analyze", "-"], GOOD);
    assert_eq!((status, err.as_str()), (0, ""));
    assert!(out.contains("reports/train/report.md"), "{out}");
    let (status, _, err) = told(folder.path(), &["check", "-"], "");
    assert_eq!(
        (status, err.as_str()),
        (2, "error: the train file is empty\n--> <stdin>\n = help: `trainsafe new` prints one to start from\n")
    );
}

#[test]
fn many_files_are_checked_at_once() {
    let folder = folder(&[("a.toml", GOOD), ("b.toml", BAD), ("c.toml", GOOD)]);
    let (status, out, err) = told(folder.path(), &["check", "a.toml", "b.toml", "c.toml"], "");
    assert_eq!(status, 2);
    assert!(out.starts_with("a.toml:\na\n3 vehicles") && out.contains("\n\nc.toml:\nc\n3 vehicles"), "{out}");
    assert!(err.contains("b.toml:7:15") && !err.contains("a.toml"), "{err}");
    let (status, out, _) = told(folder.path(), &["check", "a.toml", "c.toml", "-q"], "");
    assert_eq!((status, out.as_str()), (0, ""));
}

/// To the letter: an editor goes by it.
#[test]
fn problems_as_json_have_places_and_keys() {
    let wrong = "[coupler]\nstiffness = \"30 MN/m\"\nrated_load = \"1.5 t\"\n[[vehicle]]\nmass = \"80 t\"\n[[vehicle]]\n\
                 label = \"Gr\u{fc}n\"\nmass = { gross = \"\u{fc}\", net = 1 }\nheld = 2\n";
    let folder = folder(&[("a.toml", GOOD), ("b.toml", wrong)]);
    let (status, out, err) = told(folder.path(), &["check", "--json", "a.toml", "b.toml"], "");
    assert_eq!((status, err.as_str()), (2, ""));
    let json: Value = serde_json::from_str(&out).expect("JSON");
    let good = json!({
        "path": "a.toml", "ok": true, "problems": [], "more_problems": 0, "doubts": [],
        "train": "a", "vehicles": 3, "couplers": 2, "scenarios": ["each coupler breaks in turn"],
    });
    assert_eq!(json["files"][0], good);
    let bad = &json["files"][1];
    assert_eq!((&bad["ok"], &bad["more_problems"]), (&json!(false), &json!(0)));
    let problem = |line: usize, column: usize, marked: &str, key: &str, message: &str, help: &str| {
        let at = wrong.find(marked).expect("it is there");
        json!({
            "path": "b.toml", "line": line, "column": column, "span": [at, at + marked.len()], "key": key,
            "message": message, "help": help, "related": [],
        })
    };
    let expected = [
        problem(
            3,
            14,
            "\"1.5 t\"",
            "coupler.rated_load",
            "rated_load has \"t\", a unit of mass",
            "a force is in N, kN, MN, lbf or kip",
        ),
        problem(
            8,
            8,
            "{ gross = \"\u{fc}\", net = 1 }",
            "vehicle[1].mass",
            "mass is a table",
            "expected a string with a number and its unit: kg, t, lb, klb or ton_us",
        ),
        problem(9, 8, "2", "vehicle[1].held", "held is a number", "expected true or false, without quotes"),
    ];
    assert_eq!(bad["problems"], json!(expected));
}

/// A place that another place has a part in; a table's problem is the table's; a file's has no place; doubts are there too.
#[test]
fn json_tells_the_related_place_the_table_and_doubts() {
    let twice = format!(
        "{GOOD}[[coupler_override]]\nat = 1\nrated_load = \"1 MN\"\n[[coupler_override]]\nat = 1\nrated_load = \"2 MN\"\n"
    );
    let table = GOOD.replace("[[vehicle]]\ncount = 3\nmass = \"80 t\"\n", "");
    let folder = folder(&[
        ("twice.toml", &twice),
        ("table.toml", &format!("vehicles = \"c.csv\"\n{table}")),
        ("c.csv", "mass [t],length [m]\n80,10\n80,x\n"),
        ("idle.toml", &GOOD.replace("[load]\nuniform = \"0.5 MN\"\n", "")),
    ]);
    let (_, out, _) =
        told(folder.path(), &["check", "--json", "twice.toml", "table.toml", "idle.toml", "none.toml"], "");
    let json: Value = serde_json::from_str(&out).expect("JSON");
    let first = |i: usize| &json["files"][i]["problems"][0];
    let at = twice.rfind("rated_load").expect("it is there");
    assert_eq!(first(0)["span"], json!([at, at + "rated_load".len()]));
    assert_eq!(first(0)["key"], "coupler_override[1].rated_load");
    assert_eq!(first(0)["related"][0]["line"], 11);
    assert_eq!(first(0)["related"][0]["message"], "overridden here before");
    assert_eq!((&first(1)["path"], &first(1)["line"], &first(1)["column"]), (&json!("c.csv"), &json!(3), &json!(4)));
    assert_eq!(json["files"][2]["doubts"][0]["code"], "no-load");
    assert_eq!((first(3).get("line"), &first(3)["message"]), (None, &json!("there is no such file")));
}

/// Quiet: what is asked for is written, nothing is said; errors are.
#[test]
fn quiet_says_nothing_but_errors() {
    let folder = folder(&[("a.toml", &GOOD.replace("[load]\nuniform = \"0.5 MN\"\n", ""))]);
    let nothing = (0, String::new(), String::new());
    let (_, out, err) = told(folder.path(), &["analyze", "a.toml"], "");
    assert!(!out.is_empty() && err.starts_with("warning: "), "{err}");
    assert_eq!(told(folder.path(), &["analyze", "a.toml", "--quiet"], ""), nothing);
    assert!(folder.path().join("reports/a/report.md").is_file());
    assert_eq!(told(folder.path(), &["-q", "fleet", "a.toml", "--out", "f"], ""), nothing);
    assert!(folder.path().join("f/fleet.csv").is_file());
    let (status, out, _) = told(folder.path(), &["analyze", "a.toml", "-q", "--json"], "");
    assert!(status == 0 && out.starts_with('{'));
    let (status, _, err) = told(folder.path(), &["analyze", "-q", "b.toml"], "");
    assert!(status == 2 && err.contains("there is no such file"), "{err}");
}

#[test]
fn threads_and_colour_are_as_asked() {
    let folder = folder(&[("a.toml", GOOD)]);
    let (_, out, _) = told(folder.path(), &["fleet", "a.toml", "--dry-run", "-j", "1"], "");
    assert!(out.contains("on 1 thread\n"), "{out}");
    let (_, out, _) = told(folder.path(), &["fleet", "a.toml", "--dry-run", "--threads", "3"], "");
    assert!(out.contains("on 3 threads\n"), "{out}");
    let (status, _, err) = told(folder.path(), &["fleet", "a.toml", "-j", "0"], "");
    assert!(status == 2 && err.contains("a number from 1 to 1024 is needed"), "{err}");
    let coloured = |when: &str| told(folder.path(), &["check", "none.toml", "--color", when], "").2.contains('\u{1b}');
    assert_eq!([coloured("always"), coloured("never"), coloured("auto")], [true, false, false]);
}

/// The file that was meant is named.
#[test]
fn slips_are_answered_with_the_file_that_was_meant() {
    let table = GOOD.replace("[[vehicle]]\ncount = 3\nmass = \"80 t\"\n", "");
    let folder = folder(&[
        ("ore-train.toml", GOOD),
        ("consist.csv", "mass [t]\n80\n80\n"),
        ("by-table.toml", &format!("vehicles = \"consits.csv\"\n{table}")),
    ]);
    let err = |args: &[&str]| told(folder.path(), args, "").2;
    for slip in ["ore-trian.toml", "ore-train", "Ore-train.TOML", "ore-train.csv"] {
        let found = err(&["check", slip]);
        assert!(found.contains(&format!("--> {slip}\n = help: did you mean ore-train.toml? ")), "{found}");
    }
    assert!(!err(&["check", "freight.toml"]).contains("did you mean"));
    let found = err(&["check", "by-table.toml"]);
    assert!(found.contains("did you mean consist.csv?"), "{found}");
    let (status, _, found) = told(folder.path(), &["ore-train.toml"], "");
    let expected =
        "error: ore-train.toml is a file and no command: type trainsafe analyze ore-train.toml, or check or fleet\n";
    assert_eq!((status, found.as_str()), (2, expected));
}
