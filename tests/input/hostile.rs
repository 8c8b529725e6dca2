//! Files that nobody checked, end to end: each is refused with a message that names the limit, or its names are text in every
//! format. `trainsafe check` and `analyze` read them; nothing is written outside the output folder.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

const FRONT: &str = "[coupler]\nstiffness = \"30 MN/m\"\nrated_load = \"1 MN\"\n[load]\nuniform = \"90 %\"\n";
const VEHICLES: &str = "[[vehicle]]\nmass = \"100 t\"\n[[vehicle]]\nmass = \"100 t\"\ncount = 3\n";

fn trainsafe(dir: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_trainsafe")).args(args).current_dir(dir).output().expect("it runs")
}

/// What `check` says against a train file, beside which there may be others.
fn refused(text: &str, beside: &[(&str, &[u8])]) -> String {
    let dir = tempfile::tempdir().expect("a folder");
    fs::write(dir.path().join("train.toml"), text).expect("a train file");
    for (name, content) in beside {
        fs::write(dir.path().join(name), content).expect("a file beside it");
    }
    let run = trainsafe(dir.path(), &["check", "train.toml"]);
    let said = String::from_utf8(run.stderr).expect("UTF-8");
    assert_eq!(run.status.code(), Some(2), "{said}");
    assert!(said.len() < 20_000, "{} bytes of message", said.len());
    said
}

fn refused_table(table: &[u8]) -> String {
    refused(&format!("vehicles = \"table.csv\"\n{FRONT}"), &[("table.csv", table)])
}

fn refused_record(record: &str) -> String {
    refused(&format!("{FRONT}{VEHICLES}[[scenario]]\nkind = \"pulse\"\nat = \"tail\"\nrecord = \"{record}\"\n"), &[])
}

#[test]
fn nesting_has_a_limit() {
    for text in [
        format!("a = {}", "[".repeat(10_000)),
        format!("a = {}", "{a=".repeat(10_000)),
        format!("{}a = 1", "a.".repeat(10_000)),
        format!("[{}a]", "a.".repeat(10_000)),
        format!("[[{}a]]", "a.".repeat(10_000)),
    ] {
        let said = refused(&text, &[]);
        assert!(said.contains("recursion") || said.contains("recurse"), "{said}");
    }
}

#[test]
fn quantities_of_any_length_are_read_or_refused() {
    let with = |rating: &str| format!("{FRONT}{VEHICLES}").replace("1 MN", rating);
    for wrong in [&format!("{} MN", "9".repeat(400)), "1e400 MN", "1e-400 MN", "-0 MN", "4.9e-324 N"] {
        let said = refused(&with(wrong), &[]);
        assert!(["too large", "too small", "is zero"].iter().any(|w| said.contains(w)), "{said}");
    }
    let dir = tempfile::tempdir().expect("a folder");
    let long = format!("0.{}1{} MN", "0".repeat(5), "0".repeat(400));
    fs::write(dir.path().join("long.toml"), with(&long)).expect("a train file");
    assert!(trainsafe(dir.path(), &["check", "long.toml"]).status.success());
}

/// A million vehicles are a train; what is more than can be done is said with its limit before it is begun.
#[test]
fn a_million_vehicles_are_told_their_limits() {
    let dir = tempfile::tempdir().expect("a folder");
    let put = |name: &str, count: usize, scenario: &str| {
        let text = format!("{FRONT}[[vehicle]]\nmass = \"100 t\"\ncount = {count}\n{scenario}");
        fs::write(dir.path().join(name), text).expect("a train file");
    };
    put("million.toml", 1_000_000, "");
    put("more.toml", 1_000_001, "");
    put("each.toml", 5_000, "[[scenario]]\nkind = \"break\"\ncoupler = \"each\"\nhorizon = \"1 ms\"\n");
    put("long.toml", 1_000_000, "[[scenario]]\nkind = \"break\"\ncoupler = 500000\nhorizon = \"1000 h\"\n");
    assert!(trainsafe(dir.path(), &["check", "million.toml"]).status.success());
    for (args, limit) in [
        (["check", "more.toml"], "expected a whole number from 1 to 1000000"),
        (["analyze", "million.toml"], "at most 6 GB are used"),
        (["analyze", "each.toml"], "at most 6 GB are used"),
        (["analyze", "long.toml"], "would take"),
    ] {
        let run = trainsafe(dir.path(), &args);
        assert_eq!(run.status.code(), Some(2), "{args:?}");
        assert!(String::from_utf8_lossy(&run.stderr).contains(limit), "{}", String::from_utf8_lossy(&run.stderr));
    }
    assert!(!dir.path().join("reports").exists());
}

#[test]
fn scenarios_have_a_limit() {
    let text = format!("{FRONT}{VEHICLES}{}", "[[scenario]]\nkind = \"break\"\ncoupler = 1\n".repeat(1001));
    assert!(refused(&text, &[]).contains("it has at most 1000"));
}

#[test]
fn tables_have_limits() {
    let wide = format!("mass [t],{}\n1\n2\n", "mas,".repeat(1_000_000));
    assert!(refused_table(wide.as_bytes()).contains("a table has at most 1000"));
    let long = format!("mass [t],{}\n1\n2\n", "x".repeat(100_000));
    assert!(refused_table(long.as_bytes()).contains("65536 bytes"));
    let rows = format!("mass [t]\n{}", "1\n".repeat(1_000_001));
    assert!(refused_table(rows.as_bytes()).contains("more than 1000000 vehicles"));
    let cells = format!("mass [t],held,note\n1,perhaps,{}\n1\n", "z".repeat(1_000_000));
    assert!(refused_table(cells.as_bytes()).contains("held is"));
}

#[test]
fn other_encodings_are_told_or_read() {
    let table = "mass [t]\r\n100\r\n100\r\n";
    let utf16: Vec<u8> = [0xff, 0xfe].into_iter().chain(table.bytes().flat_map(|b| [b, 0])).collect();
    assert!(refused_table(&utf16[..utf16.len() - 1]).contains("the file is no text in UTF-16LE"));
    assert!(refused_table(b"mass [t]\n1\0\n1\n").contains("after the number"));
    assert!(refused_table(b"label,mass [t]\n\x81,1\n").contains("line 2 has a byte that none of them has"));
    let dir = tempfile::tempdir().expect("a folder");
    let put = |name: &str, content: String| fs::write(dir.path().join(name), content).expect("written");
    put("table.csv", format!("\u{feff}{table}"));
    put("train.toml", format!("\u{feff}vehicles = \"table.csv\"\n{FRONT}").replace('\n', "\r\n"));
    assert!(trainsafe(dir.path(), &["check", "train.toml"]).status.success());
}

/// A train file may come from anyone: nothing of a file that it names is shown, unless that is a table of vehicles.
#[cfg(unix)]
#[test]
fn files_that_a_train_file_names_are_not_given_away() {
    let secret = b"root:x:0:0:the secret,of this file:/:\n1,2,3\n";
    let said = refused("vehicles = \"../secret\"\n".replace("../", "").as_str(), &[("secret", secret)]);
    assert!(said.contains("this is no table of vehicles") && !said.contains("the secret"), "{said}");
    for (name, what) in
        [("/dev/zero", "a pipe or a device"), (".", "this is a folder"), ("no.csv", "there is no such file")]
    {
        let said = refused(&format!("vehicles = \"{name}\"\n{FRONT}"), &[]);
        assert!(said.contains(what), "{said}");
        let said = refused_record(name);
        assert!(said.contains(what), "{said}");
    }
    let said = refused_record("/etc/passwd");
    assert!(!said.contains("root:"), "{said}");
}

/// A pipe that nobody writes to would be waited for without end.
#[cfg(unix)]
#[test]
fn a_pipe_named_by_a_train_file_is_not_opened() {
    let dir = tempfile::tempdir().expect("a folder");
    if !Command::new("mkfifo").arg(dir.path().join("pipe")).status().is_ok_and(|s| s.success()) {
        return eprintln!("skipped: there is no mkfifo");
    }
    fs::write(dir.path().join("train.toml"), format!("vehicles = \"pipe\"\n{FRONT}")).expect("written");
    let run = trainsafe(dir.path(), &["check", "train.toml"]);
    assert_eq!(run.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&run.stderr).contains("a pipe or a device"));
}

/// Names that a terminal, a Markdown viewer, a browser, a spreadsheet or a file system would take for more than text.
const NAMES: [&str; 9] = [
    "=cmd()|'/c calc'!A1",
    "x;@SUM(A1)",
    "+1",
    "-1",
    "@here",
    "../../outside",
    "/absolute",
    "CON",
    "<script>alert(1)</script> [a](javascript:b) | ![c](d) `e` www.f.example",
];

#[test]
fn names_are_text_in_every_format() {
    let dir = tempfile::tempdir().expect("a folder");
    let below = dir.path().join("below");
    fs::create_dir(&below).expect("a folder");
    let mut text = format!("name = '''{}'''\n{FRONT}", NAMES[8]);
    for name in NAMES {
        text += &format!("[[vehicle]]\nmass = \"100 t\"\nlabel = \"\"\"{name}\"\"\"\n");
    }
    for name in NAMES {
        text += &format!("[[scenario]]\nkind = \"break\"\ncoupler = 4\nname = \"\"\"{name}\"\"\"\n");
    }
    fs::write(below.join("...toml"), text).expect("a train file");
    let run = trainsafe(&below, &["analyze", "...toml"]);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    // A file named "...toml" has the stem "..": its report does not go to the folder above.
    let all = |path: &Path| -> BTreeSet<String> {
        let entries = fs::read_dir(path).expect("a folder");
        entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect()
    };
    assert_eq!(all(dir.path()), BTreeSet::from(["below".to_owned()]));
    assert_eq!(all(&below), BTreeSet::from(["...toml", "reports"].map(str::to_owned)));
    let fleet = trainsafe(&below, &["fleet", "...toml"]);
    assert!(fleet.status.success(), "{}", String::from_utf8_lossy(&fleet.stderr));
    assert_eq!(all(&below), BTreeSet::from(["...toml", "reports"].map(str::to_owned)));
    assert_eq!(all(&below.join("reports")), BTreeSet::from(["fleet", "train"].map(str::to_owned)));
    let out = below.join("reports/train");
    let own = |name: &String| name.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b"-.".contains(&b));
    assert!(all(&out).iter().all(own), "{:?}", all(&out));
    let read = |name: &str| fs::read_to_string(out.join(name)).expect("a file of the report");
    for raw in ["<script", "[a](", "![c]", "`e`", " www.f"] {
        assert!(!read("report.md").contains(raw), "{raw} in report.md");
    }
    let json: serde_json::Value = serde_json::from_str(&read("result.json")).expect("JSON");
    assert_eq!(json["scenarios"][0]["name"], NAMES[0]);
    let mut rows = csv::Reader::from_path(out.join("couplers.csv")).expect("rows");
    for row in rows.records() {
        let row = row.expect("a row");
        for cell in [&row[0], &row[3], &row[4]] {
            assert!(cell.split(';').all(|part| !part.starts_with(['=', '+', '-', '@'])), "{cell} is a formula");
        }
    }
}

/// Controls, also those of Latin-1, and what turns the order of reading: refused in names, and shown as signs in messages.
#[test]
fn what_a_terminal_would_obey_is_refused_and_not_repeated() {
    for obeyed in ["\\u001b[31m", "\\u009b31m", "\\u202e", "\\u2066", "\\u2028", "\\t"] {
        let text = format!("name = \"a{obeyed}b\"\n{FRONT}{VEHICLES}");
        assert!(refused(&text, &[]).contains("name has a control character"));
    }
    for raw in ["\u{9b}31m", "\u{202e}", "\u{2066}", "\u{2028}"] {
        let table = format!("label,mass [t]\na{raw}b,1\nc,1\n");
        for said in [refused(&format!("{FRONT}name = a{raw}b\n"), &[]), refused_table(table.as_bytes())] {
            assert!(!said.contains(raw), "{said:?}");
        }
    }
    let dir = tempfile::tempdir().expect("a folder");
    let run = trainsafe(dir.path(), &["check", "no\u{1b}[31m\u{202e}.toml"]);
    let said = String::from_utf8(run.stderr).expect("UTF-8");
    assert!(!said.contains(['\u{1b}', '\u{202e}']), "{said:?}");
}

/// The page of `accuracy` shows the same names.
#[test]
fn names_are_text_in_the_accuracy_page() {
    let accuracy = trainsafe::accuracy::Accuracy {
        train: NAMES[8].to_owned(),
        scenario: NAMES[8].to_owned(),
        is_march: false,
        broken_coupler: None,
        couplers: [1, 2],
        horizon_s: 1.0,
        rating_n: 1.0,
        doubt_n: 0.0,
        rows: vec![],
        left_out: vec![],
    };
    let page = trainsafe::accuracy::markdown(&accuracy);
    assert!(page.contains("&lt;script&gt;"));
    for raw in ["<script", "[a](", "![c]", "`e`", " www.f"] {
        assert!(!page.contains(raw), "{raw}");
    }
}
