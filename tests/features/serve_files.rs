//! `trainsafe serve`: what it reads and writes, what controls change in the text, and how it ends.

use std::fs;
use std::process::Command;
use std::time::{Duration, Instant};

use crate::served::{Served, TRAIN};
use serde_json::{Value, json};

const TABLE: &str = "mass_t,count\n160,5\n";
const RECORD: &str = "time_ms,force_kn\n0,0\n30,-1200\n60,0\n";

fn problems(reply: &Value) -> String {
    reply["problems"].to_string()
}

#[test]
fn files_are_read_in_the_trains_folder_alone() {
    let served = Served::new(TRAIN);
    let root = served.folder.path();
    fs::create_dir(root.join("trains/in")).expect("a folder");
    for folder in ["", "trains", "trains/in"] {
        fs::write(root.join(folder).join("consist.csv"), TABLE).expect("written");
        fs::write(root.join(folder).join("pulse.csv"), RECORD).expect("written");
    }
    let vehicles = "[[vehicle]]\ncount = 5\nmass  = \"160 t\"\n";
    let of = |table: &str| format!("vehicles = '{table}'\n{}", TRAIN.replace(vehicles, ""));
    let force = "force    = \"-1.2 MN\"\nduration = \"60 ms\"\n";
    let by = |record: &str| TRAIN.replace(force, &format!("record = '{record}'\n"));
    let asked = |text: &str| served.analyze(&json!({ "text": text, "scenario": 1 }));
    for good in ["consist.csv", "in/consist.csv", "in/../consist.csv", "../trains/consist.csv"] {
        let reply = asked(&of(good));
        assert_eq!((problems(&reply).as_str(), &reply["couplers"]), ("[]", &json!(4)), "{good}");
        assert_eq!(problems(&asked(&by(&good.replace("consist", "pulse")))), "[]", "{good}");
    }
    let absolute = root.join("consist.csv").display().to_string();
    let mut outside =
        vec!["../consist.csv", "in/../../consist.csv", &absolute, "/etc/passwd", "../missing.csv", "/dev/zero"];
    if cfg!(unix) {
        #[cfg(unix)]
        for (link, to) in [("link.csv", "../consist.csv"), ("up", "..")] {
            std::os::unix::fs::symlink(to, root.join("trains").join(link)).expect("a link");
        }
        outside.extend(["link.csv", "up/consist.csv"]);
    }
    for bad in outside {
        for text in [of(bad), by(bad), by(&bad.replace("consist", "pulse"))] {
            let reply = asked(&text);
            assert!(
                problems(&reply).contains("no such file in the train's folder, and no other is read"),
                "{bad}: {reply}"
            );
            assert_eq!(reply["body"], "");
        }
    }
}

#[test]
fn problems_have_their_places_as_the_page_counts() {
    let served = Served::new(TRAIN);
    // Two bytes and one unit of UTF-16, and four bytes and two units, before the place.
    let text = TRAIN.replace("Five", "Zü\u{1f682}").replace("\"0.6 MN\"", "\"0.6 kg\"");
    let reply = served.analyze(&json!({ "text": text }));
    let problem = &reply["problems"][0];
    let units: Vec<u16> = text.encode_utf16().collect();
    let mark: Vec<usize> = serde_json::from_value(problem["marks"][0].clone()).expect("two numbers");
    assert_eq!(String::from_utf16_lossy(&units[mark[0]..mark[1]]), "\"0.6 kg\"");
    assert_eq!((&problem["line"], &problem["column"]), (&json!(13), &json!(11)), "{reply}");
    // Controls stay, so that the value can be mended by them.
    assert!(reply["controls"].to_string().contains("0.6 kg"));
    // One in a file that the train names is told with that file, and marks nothing in the text.
    fs::write(served.folder.path().join("trains/bad.csv"), "mass_t\n160\n-1\n").expect("written");
    let table = format!("vehicles = 'bad.csv'\n{}", TRAIN.replace("[[vehicle]]\ncount = 5\nmass  = \"160 t\"\n", ""));
    let reply = served.analyze(&json!({ "text": table }));
    let problem = &reply["problems"][0];
    assert!(
        problem["path"].as_str().is_some_and(|p| p.ends_with("bad.csv")) && problem["marks"] == json!([]),
        "{reply}"
    );
}

#[test]
fn controls_change_the_text_where_the_value_stands() {
    let served = Served::new(TRAIN);
    let change = |text: &str, key: &str, value: Value| served.changed(text, json!({ "key": key, "value": value }));
    let (text, reply) = change(TRAIN, "load.uniform", json!("0.5 MN"));
    assert_eq!(text, TRAIN.replace("\"0.6 MN\"", "\"0.5 MN\""));
    assert!(reply["body"] != "");
    let (text, _) = change(TRAIN, "coupler.damping", json!("200 kN*s/m"));
    assert_eq!(text, TRAIN.replace("\"1.5 MN\"\n", "\"1.5 MN\"\ndamping = \"200 kN*s/m\"\n"));
    let (text, _) = change(TRAIN, "damping_ratio", json!(0.2));
    assert_eq!(text, TRAIN.replace("name = \"Five\"\n", "name = \"Five\"\ndamping_ratio = 0.2\n"));
    let (text, _) = change(TRAIN, "scenario[1].force", json!("-1 MN"));
    assert_eq!(text, TRAIN.replace("-1.2 MN", "-1 MN"));
    let bare = &TRAIN[..TRAIN.find("\n[load]").expect("a load")];
    let (text, reply) = change(bare.trim_end(), "load.uniform", json!("40 %"));
    assert_eq!(text, format!("{}\n\n[load]\nuniform = \"40 %\"\n", bare.trim_end()));
    assert!(reply["body"] != "");
    // The reader judges what is put.
    let (_, reply) = change(TRAIN, "coupler.rated_load", json!("-1 kg"));
    assert!(problems(&reply).contains("\"line\":6"), "{reply}");
    for (text, key, why) in [
        (TRAIN, "coupler.colour", "no key"),
        (TRAIN, "scenario[7].force", "no scenario[7]"),
        (TRAIN, "", "no train file has a key"),
        ("[", "load.uniform", "not TOML"),
    ] {
        let (after, reply) = change(text, key, json!("1 MN"));
        assert_eq!(after, text);
        assert!(reply["messages"][0].as_str().is_some_and(|m| m.contains(why)), "{key}: {reply}");
    }
    // Also in tables that are written in one line, and dotted.
    for (text, after) in [
        ("load = { uniform = \"1 kN\" }\n", Some("load = { uniform = \"2 kN\" }\n")),
        ("load.uniform = '1 kN'\n", Some("load.uniform = \"2 kN\"\n")),
        ("load = { grade = \"1 %\" }\n", None),
    ] {
        let (read, reply) = change(text, "load.uniform", json!("2 kN"));
        assert_eq!(read, after.unwrap_or(text));
        assert_eq!(reply["messages"].to_string().contains("by hand"), after.is_none(), "{reply}");
    }
}

#[test]
fn one_coupler_gets_a_rating_of_its_own() {
    let served = Served::new(TRAIN);
    let rate = |text: &str, coupler: usize, value: &str| {
        let change = json!({ "key": "rated_load", "coupler": coupler, "value": value });
        let (text, reply) = served.changed(text, change);
        let data: Value = serde_json::from_str(reply["data"].as_str().expect("data")).unwrap_or_default();
        let couplers = data[0]["couplers"].as_array().cloned().unwrap_or_default();
        let rated: Vec<f64> = couplers.iter().filter_map(|c| c["rated_draft_n"].as_f64()).collect();
        (text, rated)
    };
    // Coupler 2 breaks and is not among them.
    let (text, rated) = rate(TRAIN, 3, "0.9 MN");
    assert_eq!(rated, [1.5e6, 0.9e6, 1.5e6]);
    assert_eq!(text, format!("{TRAIN}\n[[coupler_override]]\nat = 3\nrated_load = \"0.9 MN\"\n"));
    let (again, rated) = rate(&text, 3, "0.8 MN");
    assert_eq!((again, rated), (text.replace("0.9 MN", "0.8 MN"), vec![1.5e6, 0.8e6, 1.5e6]));
    // One that it shares goes on for the others, with all that it says.
    let shared =
        format!("{TRAIN}\n[[coupler_override]]\nat = [1, 3]   # worn\nrated_load = \"60 %\"\nrated_buff = \"1 MN\"\n");
    let (text, rated) = rate(&shared, 3, "1.2 MN");
    assert_eq!(rated, [0.9e6, 1.2e6, 1.5e6]);
    assert!(text.contains("at = [1]   # worn") && text.matches("rated_buff = \"1 MN\"").count() == 2, "{text}");
}

#[test]
fn a_text_is_saved_if_the_file_is_still_the_one_that_was_read() {
    let served = Served::new(TRAIN);
    #[cfg(unix)]
    fs::set_permissions(served.file(), std::os::unix::fs::PermissionsExt::from_mode(0o640)).expect("allowed");
    let digest = served.on_disk()["digest"].clone();
    let save = |text: &str, digest: &Value| served.post("save", &json!({ "text": text, "digest": digest }).to_string());
    let newer = TRAIN.replace("0.6 MN", "0.7 MN");
    let saved = save(&newer, &digest);
    assert_eq!((served.text(), saved.status), (newer.clone(), 200), "{}", saved.body);
    #[cfg(unix)]
    assert_eq!(
        std::os::unix::fs::PermissionsExt::mode(&fs::metadata(served.file()).expect("it").permissions()) & 0o777,
        0o640
    );
    assert_eq!(
        fs::read_dir(served.folder.path().join("trains")).expect("the folder").count(),
        1,
        "nothing else is left"
    );
    // By the digest of before it is another file.
    let refused = save(TRAIN, &digest);
    assert_eq!((refused.status, served.text()), (409, newer));
    let digest = saved.json()["digest"].clone();
    assert_eq!(digest, served.on_disk()["digest"]);
    let other = "# of somebody else\n";
    fs::write(served.file(), other).expect("written");
    let refused = save(TRAIN, &digest);
    assert_eq!((refused.status, served.text().as_str()), (409, other));
    assert!(refused.body.contains("has changed on the disk since it was read"), "{}", refused.body);
    fs::remove_file(served.file()).expect("removed");
    assert_eq!(save(TRAIN, &digest).status, 409);
    assert!(!served.file().exists());
}

#[test]
fn line_ends_of_windows_stay() {
    let windows = TRAIN.replace('\n', "\r\n");
    let served = Served::new(&windows);
    let digest = served.on_disk()["digest"].clone();
    // As a text field of a page has it.
    let saved = served.post("save", &json!({ "text": TRAIN, "digest": digest }).to_string());
    assert_eq!((saved.status, served.text()), (200, windows));
    assert_eq!(saved.json()["digest"], digest);
}

#[test]
fn long_analyses_are_refused() {
    let long = TRAIN.replace("count = 5", "count = 20000").replace("coupler = 2", "coupler = \"each\"");
    let served = Served::new(&long);
    let start = Instant::now();
    let reply = served.analyze(&json!({ "text": long }));
    assert!(!reply["messages"][0].as_str().unwrap_or_default().is_empty() && reply["body"] == "", "{reply}");
    let medium = long.replace("20000", "1500");
    let reply = served.analyze(&json!({ "text": medium }));
    assert!(
        reply["messages"][0].as_str().is_some_and(|m| m.contains("at most 10 s are spent")),
        "{}",
        reply["messages"]
    );
    assert!(start.elapsed() < Duration::from_secs(120), "{:?}", start.elapsed());
    // One of its breaks is not long.
    assert_eq!(served.analyze(&json!({ "text": medium, "break": 700 }))["messages"], json!([]));
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_it() {
    let mut served = Served::new(TRAIN);
    let open = served.connect();
    assert_eq!(served.get().status, 200);
    let sent = Command::new("kill").args(["-INT", &served.child.id().to_string()]).status().expect("kill");
    assert!(sent.success());
    assert_eq!(served.child.wait().expect("its end").code(), Some(130));
    drop(open);
    assert!(std::net::TcpStream::connect(("127.0.0.1", served.port)).is_err());
}

#[test]
fn what_cannot_be_served_is_said() {
    let trainsafe = |args: &[&str]| Command::new(env!("CARGO_BIN_EXE_trainsafe")).args(args).output().expect("it runs");
    let missing = trainsafe(&["serve", "missing.toml"]);
    assert_eq!(missing.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&missing.stderr).contains("there is no such file"));
    let taken = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let port = taken.local_addr().expect("its number").port().to_string();
    let refused = trainsafe(&["serve", "trains/ore-train.toml", "--no-open", "--port", &port]);
    assert_eq!(refused.status.code(), Some(4));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("choose another port"));
}
