//! Names: vehicles and couplers by label, and files that are of another kind or named in the way of Windows.

use std::collections::HashSet;
use std::fs;
use std::path::Path;
use std::process::Command;

use trainsafe::Train;
use trainsafe::consist;
use trainsafe::train::{Event, Pulse};

const FRONT: &str = "[coupler]\nstiffness = \"11.1 MN/m\"\nrated_load = \"0.5 MN\"\n[load]\nuniform = \"0.4 MN\"\n";

fn read(rest: &str) -> Result<Train, String> {
    consist::parse(&format!("{FRONT}{rest}"), Path::new("train.toml")).map_err(|e| e.to_string())
}

fn vehicles(groups: &[(&str, usize)]) -> String {
    let label = |label: &str| if label.is_empty() { String::new() } else { format!("label = \"{label}\"\n") };
    groups.iter().map(|(l, n)| format!("[[vehicle]]\n{}mass = \"50 t\"\ncount = {n}\n", label(l))).collect()
}

fn labels(groups: &[(&str, usize)]) -> Vec<String> {
    let train = read(&vehicles(groups)).expect("a train");
    train.vehicles().iter().map(|v| v.label.clone()).collect()
}

#[test]
fn no_two_vehicles_have_the_same_name() {
    assert_eq!(labels(&[("car 1", 1), ("car", 2), ("car 2", 1)]), ["car 1", "car 3", "car 4", "car 2"]);
    assert_eq!(labels(&[("loco", 1), ("car", 1), ("car", 2)]), ["loco", "car 1", "car 2", "car 3"]);
    // A number that is left out because another vehicle has that label gives a doubt.
    let told = |groups: &[(&str, usize)]| {
        let doubts = read(&vehicles(groups)).expect("a train").origin().doubts.clone();
        doubts.into_iter().filter(|d| d.code == "label-numbers").map(|d| d.text).collect::<Vec<_>>()
    };
    let text = "vehicles with the label \"w\" are numbered without 2, because another vehicle is called \"w 2\"; check which is meant \
                where it is named";
    assert_eq!(told(&[("w", 3), ("w 2", 1)]), [text]);
    assert!(told(&[("w", 3), ("w 4", 1)]).is_empty());
    // A label is kept where it is that of a place; numbers behind a number stand in brackets.
    assert_eq!(labels(&[("vehicle 2", 1), ("", 2)]), ["vehicle 2", "vehicle 2 (no label)", "vehicle 3"]);
    assert_eq!(labels(&[("car 7", 2), ("car", 1)]), ["car 7 (1)", "car 7 (2)", "car"]);
    let of_two =
        read(&(vehicles(&[("car 7", 2)]) + "[[scenario]]\nkind = \"break\"\ncoupler = { behind = \"car 7\" }\n"));
    let refused = of_two.expect_err("two of that label");
    assert!(refused.contains("give one with its number, from \"car 7 (1)\" to \"car 7 (2)\""), "{refused}");
    for groups in [
        &[("vehicle 2", 1), ("", 3)][..],
        &[("vehicle 2 (no label)", 1), ("vehicle 2", 1), ("", 1), ("vehicle 2", 1)],
        &[("vehicle 2", 1), ("", 1), ("vehicle 2 (no label)", 1), ("a 1 (1)", 1), ("a 1", 2)],
        &[("", 2), ("vehicle", 3), ("", 1)],
        &[("a", 2), ("a 1", 2), ("a 1 1", 1)],
        &[("car ", 1), ("car", 1), ("car 1", 2)],
        &[("vehicle 3", 2), ("", 2), ("vehicle 3 1", 1)],
    ] {
        let names = labels(groups);
        assert_eq!(names.iter().collect::<HashSet<_>>().len(), names.len(), "{names:?}");
    }
}

#[test]
fn couplers_and_vehicles_are_named_by_label() {
    let train = vehicles(&[("loco", 1), ("coal car", 50), ("caboose", 1)]);
    let rest = "[[coupler_override]]\nat = [2, { behind = \"coal car 39\" }]\nrated_load = \"0.45 MN\"\n\
                [[scenario]]\nkind = \"break\"\ncoupler = { behind = \"coal car 40\" }\n\
                [[scenario]]\nkind = \"break\"\ncoupler = [{ behind = \"loco\" }, 7]\n\
                [[scenario]]\nkind = \"pulse\"\nat = \"caboose\"\nforce = \"1 kN\"\nduration = \"1 s\"\n";
    let train = read(&(train + rest)).expect("a train");
    assert_eq!(train.couplers()[39].rated_draft_n, 0.45e6);
    assert_eq!(train.scenarios()[0].event, Event::Break { couplers: vec![40] });
    assert_eq!(train.scenarios()[1].event, Event::Break { couplers: vec![0, 6] });
    assert!(matches!(train.scenarios()[2].event, Event::Pulse(Pulse { vehicle: 51, .. })));
    let said = consist::describe(&train);
    for line in [
        "by label: coupler 40 is behind \"coal car 39\"\n",
        "by label: coupler 41 is behind \"coal car 40\"\n",
        "by label: coupler 1 is behind \"loco\"\n",
        "by label: \"caboose\" is vehicle 52\n",
        "couplers 1 and 7 of 51 break, one at a time; 2 cases",
    ] {
        assert!(said.contains(line), "{said}");
    }
}

#[test]
fn a_label_that_names_none_or_several_is_refused() {
    let refused = |scenario: &str, title: &str, help: &str| {
        let train = vehicles(&[("loco", 1), ("coal car", 50), ("caboose", 1)]);
        let error = read(&format!("{train}[[scenario]]\n{scenario}\n")).expect_err(scenario);
        assert!(error.contains(title) && error.contains(help), "{error}");
    };
    let of = |label: &str| format!("kind = \"break\"\ncoupler = {{ behind = \"{label}\" }}");
    refused(&of("coal car 51"), "no vehicle has the label \"coal car 51\"", "the nearest labels are \"coal car 1\",");
    refused(&of("coal car"), "50 vehicles have the label \"coal car\"", "from \"coal car 1\" to \"coal car 50\"");
    refused(&of("caboose"), "no coupler is behind \"caboose\", the last vehicle", "name the vehicle ahead");
    refused("kind = \"break\"\ncoupler = [1, { behind = \"loco\" }]", "coupler 1 is listed twice", "list it once");
    refused("kind = \"break\"\ncoupler = { ahead = \"loco\" }", "unknown key \"ahead\"", "behind");
    let pulse = "kind = \"pulse\"\nforce = \"1 kN\"\nduration = \"1 s\"\nat = ";
    refused(&format!("{pulse}\"cabose\""), "no vehicle has the label \"cabose\"", "the nearest labels are \"caboose\"");
    // The end of the train goes before a label, and a doubt says so.
    let train = vehicles(&[("tail", 1), ("car", 2)]);
    let train = read(&format!("{train}[[scenario]]\n{pulse}\"tail\"\n")).expect("a train");
    assert!(matches!(train.scenarios()[0].event, Event::Pulse(Pulse { vehicle: 2, .. })));
    assert_eq!(train.origin().doubts[0].code, "label-head-or-tail");
}

/// What a command says of a file with this name and content, on standard error; it is refused.
fn refused(command: &str, name: &str, bytes: &[u8]) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join(name), bytes).expect("a file");
    let run = Command::new(env!("CARGO_BIN_EXE_trainsafe")).args([command, name]).current_dir(folder.path()).output();
    let run = run.expect("a run");
    assert_eq!(run.status.code(), Some(2));
    String::from_utf8(run.stderr).expect("text")
}

#[test]
fn a_study_is_no_train() {
    let study = "trains = [\"base.toml\"]\nsamples = 50\nseed = 4\n[[vary]]\nkey = \"load.uniform\"\ndistribution = \"uniform\"\nlow = \
                 \"0.4 MN\"\nhigh = \"0.9 MN\"\n";
    for command in ["analyze", "check", "accuracy"] {
        for text in [
            study,
            "trains = \"*.toml\"\n",
            "[[vary]]\nkey = \"load.uniform\"\nvalues = [\"1 MN\"]\n",
            "vary = []\ntrains = []\n",
        ] {
            let said = refused(command, "study.toml", text.as_bytes());
            assert!(said.starts_with("error: this is a study, and no train file"), "{said}");
            assert!(said.contains("type `trainsafe fleet study.toml`"), "{said}");
        }
    }
}

#[test]
fn a_file_of_another_kind_is_called_what_it_is() {
    let cases: [(&[u8], &str, &str); 8] = [
        (
            b"PK\x03\x04....xl/workbook.xml",
            "this is an Excel workbook (xlsx)",
            "save the sheet with the vehicles as CSV",
        ),
        (
            b"PK\x03\x04....mimetypeapplication/vnd.oasis.opendocument.spreadsheet",
            "this is a LibreOffice workbook",
            "as CSV",
        ),
        (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1...", "this is an old Excel workbook (xls)", "as CSV"),
        (b"%PDF-1.7 ...", "this is a PDF", "give the path of a train file"),
        (
            b"{\"train\": \"x\", \"couplers\": 3, \"scenarios\": []}",
            "this is the result of an analysis (result.json)",
            "a train file",
        ),
        (b"<!doctype html>\n<html></html>", "this is a web page or XML", "a train file"),
        (b"label,mass [t]\na,80\nb,90\n", "this is a table of vehicles", "vehicles = \"f.dat\""),
        (b"time_s,force_kn\n0,0\n1,5\n", "this is a record of force over time", "record = \"f.dat\""),
    ];
    for (bytes, what, help) in cases {
        let said = refused("check", "f.dat", bytes);
        assert!(said.starts_with(&format!("error: {what}")) && said.contains(help), "{said}");
    }
    // The same as a table of vehicles.
    let folder = tempfile::tempdir().expect("a folder");
    let as_table = |bytes: &[u8]| {
        fs::write(folder.path().join("c.csv"), bytes).expect("a file");
        let text = format!("vehicles = \"c.csv\"\n{FRONT}");
        consist::parse(&text, &folder.path().join("t.toml")).expect_err("no table").to_string()
    };
    let train = format!("{FRONT}[[vehicle]]\nmass = \"1 t\"\n");
    let workbook = if cfg!(feature = "xlsx") {
        "the workbook cannot be read: "
    } else {
        "this is an Excel workbook (xlsx), and no CSV file; this trainsafe was built without the feature xlsx"
    };
    assert!(as_table(cases[0].0).contains(workbook));
    assert!(as_table(cases[3].0).contains("this is a PDF, and no CSV file"));
    assert!(as_table(train.as_bytes()).contains("this is no table of vehicles: it is a train file"));
    assert!(as_table(cases[4].0).contains("it is the result of an analysis (result.json)"));
    assert!(as_table(cases[7].0).contains("it is a record of force over time"));
}

#[test]
fn paths_of_windows_get_a_hint() {
    let hint = "write / between folders";
    for line in [
        r#"vehicles = "data\temp.csv""#,
        r#"vehicles = "data\consist.csv""#,
        r#"vehicles = "C:\Users\me\consist.csv""#,
        r#"vehicles = "data\new\bulk.csv""#,
        r"vehicles = 'data\consist.csv'",
    ] {
        let error = consist::parse(&format!("{line}\n{FRONT}"), Path::new("t.toml")).expect_err(line).to_string();
        assert!(error.contains(hint) && error.contains("t.toml:1:"), "{error}");
        let record = line.replace("vehicles", "record");
        let pulse = format!("{}[[scenario]]\nkind = \"pulse\"\nat = \"tail\"\n{record}\n", vehicles(&[("car", 3)]));
        let error = read(&pulse).expect_err(line);
        assert!(error.contains(hint), "{error}");
    }
    for trains in [r#"trains = ["data\temp.toml"]"#, r#"trains = ["data\consist.toml"]"#] {
        let study = format!("{trains}\n[[vary]]\nkey = \"load.uniform\"\nvalues = [\"1 MN\"]\n");
        let error = trainsafe::fleet::study::parse(&study, Path::new("s.toml")).expect_err(trains).to_string();
        assert!(error.contains(hint), "{error}");
    }
}

/// Ramps that are the whole pulse, in decimals: a triangle whose top is where they meet.
#[test]
fn rise_and_fall_may_be_the_whole_duration() {
    let pulse = |rise: &str, fall: &str, duration: &str| {
        let keys = format!("shape = \"trapezoid\"\nrise = \"{rise}\"\nfall = \"{fall}\"\nduration = \"{duration}\"");
        let pulse = format!("[[scenario]]\nkind = \"pulse\"\nat = 1\nforce = \"100 kN\"\n{keys}\n");
        read(&(vehicles(&[("car", 4)]) + &pulse))
    };
    for (rise, fall, duration) in [
        ("100 ms", "200 ms", "300 ms"),
        ("0.7 s", "0.1 s", "0.8 s"),
        ("1.1 s", "2.2 s", "3.3 s"),
        ("50 ms", "50 ms", "0.1 s"),
    ] {
        let train = pulse(rise, fall, duration).expect("a triangle");
        let Event::Pulse(pulse) = &train.scenarios()[0].event else { panic!("no pulse") };
        let trainsafe::forcing::Drive::Lines(points) = pulse.drive() else { panic!("no lines") };
        assert!(points.windows(2).all(|p| p[0][0] <= p[1][0]), "{points:?}");
    }
    for total in 2..300 {
        for rise in (1..total).step_by(7) {
            let [rise, fall, total] = [rise, total - rise, total].map(|t: i32| format!("{t} ms"));
            assert!(pulse(&rise, &fall, &total).is_ok(), "{rise} {fall} {total}");
        }
    }
    assert!(pulse("100 ms", "200.001 ms", "300 ms").is_err());
}
