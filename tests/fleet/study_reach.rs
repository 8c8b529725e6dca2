//! What a study's inputs reach: a value of its own is kept, an input without effect is refused, and every case of every variation
//! is run.

use std::fs;
use std::path::Path;

use crate::fleets::{complaint, fleet, rows};
use tempfile::TempDir;

const COUPLER: &str = "[coupler]\nstiffness = \"11.1 MN/m\"\nrated_load = \"1.2 MN\"\n";
const VEHICLES: &str = "[[vehicle]]\nmass = \"196 t\"\nheld = true\n[[vehicle]]\ncount = 12\nmass = \"120 t\"\n";
const LOAD: &str = "[load]\nuniform = \"0.7 MN\"\n";
const BREAK_5: &str = "[[scenario]]\nkind = \"break\"\ncoupler = 5\n";
const WEIBULL: &str = "distribution = \"weibull\"\nscale = \"2.0 MN\"\nshape = 12\n";

fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        fs::write(folder.path().join(name), text).expect("a file");
    }
    folder
}

fn study(inputs: &str) -> String {
    format!("trains = [\"train.toml\"]\nsamples = 20\n{inputs}")
}

fn vary(key: &str, rest: &str) -> String {
    format!("[[vary]]\nkey = \"{key}\"\n{rest}")
}

/// Standard error of a study that is refused.
fn refusal(folder: &Path) -> String {
    let output = fleet(folder, &["study.toml", "--out", "out"]);
    assert_eq!(output.status.code(), Some(2), "{}", complaint(&output));
    let dry = fleet(folder, &["study.toml", "--dry-run"]);
    assert_eq!((dry.status.code(), complaint(&dry)), (Some(2), complaint(&output)));
    assert!(!folder.join("out").exists());
    complaint(&output)
}

const OWN_COUPLERS: &str = "error: coupler.rated_load reaches no coupler of train.toml: each has a value of its own, from the \
                            table of vehicles or a [[coupler_override]], and keeps it\n";

#[test]
fn ratings_of_a_table_are_kept_by_either_way_of_drawing() {
    let train = format!("vehicles = \"consist.csv\"\n{COUPLER}{LOAD}{BREAK_5}");
    let table = "label,count,mass [t],held,rated_load [MN]\nloco,1,196,yes,0.9\ncar,12,120,,0.9\n";
    for per in ["", "per = \"coupler\"\n", "per = \"train\"\n"] {
        let study = study(&(vary("coupler.rated_load", per) + WEIBULL));
        let folder = folder(&[("train.toml", &train), ("consist.csv", table), ("study.toml", &study)]);
        assert_eq!(refusal(folder.path()), OWN_COUPLERS, "{per}");
    }
}

#[test]
fn inputs_without_effect_are_refused_with_the_reason() {
    let all = (1..=12).map(|i| i.to_string()).collect::<Vec<_>>().join(", ");
    let overridden =
        format!("{COUPLER}{VEHICLES}{LOAD}{BREAK_5}[[coupler_override]]\nat = [{all}]\nrated_load = \"0.9 MN\"\n");
    let own_grade =
        format!("{COUPLER}{}{BREAK_5}[load]\ngrade = \"0.5 %\"\n", VEHICLES.to_owned() + "grade = \"1 %\"\n");
    let plain = format!("{COUPLER}{VEHICLES}{LOAD}{BREAK_5}");
    let free = VEHICLES.replace("held = true", "tractive_effort = \"300 kN\"");
    let free = format!("{COUPLER}{free}{BREAK_5}[load]\ngrade = \"0.5 %\"\n");
    let buff = format!("vehicles = \"consist.csv\"\n{COUPLER}{LOAD}{BREAK_5}");
    let range = |from: &str, to: &str| format!("distribution = \"uniform\"\nlow = \"{from}\"\nhigh = \"{to}\"\n");
    let cases = [
        (&overridden, vary("coupler.rated_load", &("per = \"coupler\"\n".to_owned() + WEIBULL)), OWN_COUPLERS.to_owned()),
        (
            &own_grade,
            vary("load.grade", &range("0.5 %", "1 %")),
            "error: load.grade reaches no vehicle of train.toml: each has a value of its own, and keeps it\n".to_owned(),
        ),
        (
            &free,
            vary("load.grade", &range("0.5 %", "1 %")),
            "error: load.grade reaches nothing in train.toml: it accelerates all vehicles alike, and no force in a coupler depends on \
             that; hold an end to keep its speed\n"
                .to_owned(),
        ),
        (
            &plain,
            vary("vehicle[0].mass", &range("100 t", "200 t")),
            "error: vehicle[0].mass reaches no vehicle of train.toml: it is held, and the mass of a held vehicle plays no \
             part\n"
                .to_owned(),
        ),
        (
            &plain,
            vary("vehicle[7].mass", &range("100 t", "200 t")),
            "error: vehicle[7].mass reaches nothing in train.toml: the train file has no vehicle[7] (counted from 0)\n".to_owned(),
        ),
        (
            &plain,
            vary("vehicle[1].length", &range("10 m", "20 m")),
            "error: vehicle[1].length reaches nothing in train.toml: no force depends on it in a train whose scenarios apply no brakes\n"
                .to_owned(),
        ),
        (
            &plain,
            vary("speed", &range("10 km/h", "20 km/h")),
            "error: speed reaches nothing in train.toml: no force depends on it in a train whose scenarios apply no brakes\n".to_owned(),
        ),
        (
            &plain,
            vary("load.pulled_to", &range("0.9 MN", "1 MN")),
            "error: load.pulled_to reaches nothing in train.toml: only the force in a gear with friction depends on an earlier pull\n"
                .to_owned(),
        ),
        // One value only: what the key reaches can be seen all the same.
        (&buff, vary("coupler.rated_buff", "values = [\"2 MN\"]\n"), OWN_COUPLERS.replace("rated_load", "rated_buff")),
        (
            &buff,
            vary("vehicle[1].mass", &("per = \"vehicle\"\n".to_owned() + &range("100 t", "200 t"))),
            "error: vehicle[1].mass reaches nothing in train.toml: the train file has no vehicle[1] (counted from 0): its \
             vehicles are rows of a table, which keep their own values; to vary them, write them as [[vehicle]]\n"
                .to_owned(),
        ),
    ];
    let table = "count,mass [t],rated_buff [MN]\n1,196,0.9\n12,120,0.9\n";
    for (train, vary, expected) in cases {
        let folder = folder(&[("train.toml", train), ("consist.csv", table), ("study.toml", &study(&vary))]);
        assert_eq!(refusal(folder.path()), expected);
    }
}

/// Couplers 1 to 8 have 0.9 MN by the table, the four behind take the draws, in either way; the broken one is 5.
#[test]
fn an_input_that_reaches_some_couplers_says_how_many() {
    let train = format!("vehicles = \"consist.csv\"\n{COUPLER}{LOAD}{BREAK_5}");
    let table = "count,mass [t],held,rated_load [MN]\n1,196,yes,0.9\n7,120,,0.9\n5,120,,\n";
    for per in ["", "per = \"coupler\"\n"] {
        let vary = vary("coupler.rated_load", &(per.to_owned() + "values = [\"0.1 MN\", \"0.2 MN\", \"0.3 MN\"]\n"));
        let folder = folder(&[("train.toml", &train), ("consist.csv", table), ("study.toml", &study(&vary))]);
        let output = fleet(folder.path(), &["study.toml", "--out", "out"]);
        assert!(output.status.success(), "{}", complaint(&output));
        let note =
            "coupler.rated_load is varied in 4 of 12 couplers of train.toml: the others keep a value of their own";
        assert!(complaint(&output).contains(&format!("note: {note}\n")), "{}", complaint(&output));
        let report = fs::read_to_string(folder.path().join("out/fleet.md")).expect("a report");
        assert!(report.replace('\\', "").contains(&format!("Note: {note}.")), "{report}");
        for row in rows(&folder.path().join("out/fleet.csv")) {
            // Behind the break the load goes on as a step of 0.7 MN: the weakest coupler, all but always, is the worst.
            let worst: usize = row["worst_coupler"].parse().expect("a number");
            let heading = if per.is_empty() { "coupler.rated_load [N]" } else { "coupler.rated_load [N], smallest" };
            assert!(worst > 8 && row["rated_draft_n"] == row[heading], "{row:?}");
        }
    }
}

/// A share in an override is of the value that the coupler would else have had, drawn for the train or for the coupler.
#[test]
fn a_share_of_the_common_rating_follows_the_draw() {
    let share = "[[coupler_override]]\nat = 1\nrated_load = \"10 %\"\n";
    let train = format!("{COUPLER}{VEHICLES}{LOAD}{BREAK_5}{share}");
    for per in ["", "per = \"coupler\"\n"] {
        let vary = vary("coupler.rated_load", &(per.to_owned() + "values = [\"5 MN\"]\n"));
        let folder = folder(&[("train.toml", &train), ("study.toml", &study(&vary))]);
        let output = fleet(folder.path(), &["study.toml", "--out", "out"]);
        assert!(output.status.success(), "{}", complaint(&output));
        for row in rows(&folder.path().join("out/fleet.csv")) {
            assert_eq!((&*row["worst_coupler"], &*row["rated_draft_n"]), ("1", "500000.0"), "{per}");
        }
    }
}

#[test]
fn a_train_that_an_input_does_not_reach_fails_and_the_others_are_run() {
    let all = (1..=12).map(|i| i.to_string()).collect::<Vec<_>>().join(", ");
    let plain = format!("{COUPLER}{VEHICLES}{LOAD}{BREAK_5}");
    let own = format!("{plain}[[coupler_override]]\nat = [{all}]\nrated_load = \"0.9 MN\"\n");
    let study = study(&vary("coupler.rated_load", WEIBULL)).replace("train.toml", "*.toml");
    let folder = folder(&[("a.toml", &plain), ("b.toml", &own), ("study.toml", &study)]);
    let output = fleet(folder.path(), &["study.toml", "--out", "out"]);
    assert_eq!(output.status.code(), Some(3), "{}", complaint(&output));
    assert_eq!(rows(&folder.path().join("out/fleet.csv")).len(), 20);
    let errors = rows(&folder.path().join("out/errors.csv"));
    let expected = OWN_COUPLERS.replace("train.toml", "b.toml").replace("error: ", "");
    assert_eq!(errors.len(), 1);
    assert_eq!((&*errors[0]["file"], &*errors[0]["variation"], &*errors[0]["error"]), ("b.toml", "", expected.trim()));
}

const SCENARIOS: &str = "[[scenario]]\nname = \"knuckle 12\"\nkind = \"break\"\ncoupler = 12\n[[scenario]]\nname = \"knuckle 5\"\nkind \
                         = \"break\"\ncoupler = 5\n[[scenario]]\nname = \"hit\"\nkind = \"pulse\"\nat = \"tail\"\nforce = \"3 \
                         MN\"\nduration = \"1 s\"\n";

/// Counts of cases and of cases that exceed, as the run and the dry run have them.
fn counts(train: &str, study: &str, dry: &str) -> [usize; 2] {
    let folder = folder(&[("train.toml", train), ("study.toml", study)]);
    let output = fleet(folder.path(), &["study.toml", "--dry-run"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(text.lines().next(), Some(dry), "{}", complaint(&output));
    let output = fleet(folder.path(), &["study.toml", "--out", "out"]);
    assert!(output.status.success(), "{}", complaint(&output));
    assert!(rows(&folder.path().join("out/errors.csv")).is_empty());
    let rows = rows(&folder.path().join("out/fleet.csv"));
    [rows.len(), rows.iter().filter(|row| row["exceeding"] != "0").count()]
}

/// A file that is no train until the study fills it in, by a word, a gap, a missing table or a wrong number in the place of a value.
#[test]
fn every_case_of_an_incomplete_train_is_run() {
    let whole = format!("{COUPLER}{VEHICLES}{LOAD}{SCENARIOS}");
    let ratings =
        "trains = [\"train.toml\"]\n[[vary]]\nkey = \"coupler.rated_load\"\nvalues = [\"1.1 MN\", \"1.2 MN\"]\n";
    let dry = "1 train, 2 variations of each, 6 cases";
    for gap in ["rated_load = \"TBD\"", "", "rated_load = 1.2", "rated_load = \"-1 MN\""] {
        let train = whole.replace("rated_load = \"1.2 MN\"", gap);
        assert_eq!(counts(&train, ratings, dry), [6, 2], "{gap}");
    }
    let masses = "trains = [\"train.toml\"]\n[[vary]]\nkey = \"vehicle[1].mass\"\nvalues = [\"110 t\", \"120 t\"]\n";
    assert_eq!(counts(&whole.replace("mass = \"120 t\"", "mass = \"?\""), masses, dry), [6, 2]);
    let loads = "trains = [\"train.toml\"]\n[[vary]]\nkey = \"load.uniform\"\nvalues = [\"0.1 MN\", \"0.2 MN\"]\n";
    assert_eq!(counts(&whole.replace(LOAD, "[load]\n"), loads, dry)[0], 6);
    // By the default scenario each of twelve couplers breaks.
    let each = whole.replace(SCENARIOS, "").replace("\"1.2 MN\"", "\"?\"");
    assert_eq!(counts(&each, ratings, "1 train, 2 variations of each, 24 cases")[0], 24);
    let weibull = study(&(vary("coupler.rated_load", "per = \"coupler\"\n") + WEIBULL));
    let folder = folder(&[("train.toml", &whole.replace("\"1.2 MN\"", "\"TBD\"")), ("study.toml", &weibull)]);
    let output = fleet(folder.path(), &["study.toml", "--out", "out"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        text.contains("Probability of an exceedance: 100 % (20 of 20 draws; 95 % confidence: 83.2 to 100 %)."),
        "{text}{}",
        complaint(&output)
    );
}

/// The couplers that `"each"` breaks carry draft, so that the sign of the load decides how many there are.
#[test]
fn cases_are_counted_in_every_variation() {
    let train = format!("{COUPLER}{VEHICLES}{LOAD}[[scenario]]\nkind = \"break\"\ncoupler = \"each\"\n");
    let lists = "trains = [\"train.toml\"]\n[[vary]]\nkey = \"scenario[0].coupler\"\nvalues = [1, \"each\", [2, 3]]\n";
    assert_eq!(counts(&train, lists, "1 train, 3 variations of each, 15 cases")[0], 15);
    let groups = "trains = [\"train.toml\"]\n[[vary]]\nkey = \"vehicle[1].count\"\nvalues = [3, 12, 4]\n";
    assert_eq!(counts(&train, groups, "1 train, 3 variations of each, 19 cases")[0], 19);
    // A tail that pushes with 1 kN against cars that brake with 0.5 or 1 kN each: two couplers or one carry buff.
    let hauled = train.replace(LOAD, "") + "[[vehicle]]\nmass = \"100 t\"\ntractive_effort = \"1 kN\"\n";
    let brakes =
        "trains = [\"train.toml\"]\n[[vary]]\nkey = \"vehicle[1].brake_force\"\nvalues = [\"0.5 kN\", \"1 kN\"]\n";
    assert_eq!(counts(&hauled, brakes, "1 train, 2 variations of each, 23 cases")[0], 23);
}

/// A train none of whose couplers can be broken apart is no train without an exceedance.
#[test]
fn a_train_without_a_case_is_told() {
    let train = format!("{COUPLER}{VEHICLES}[load]\nuniform = \"-0.7 MN\"\n");
    let folder = folder(&[("train.toml", &train)]);
    let output = fleet(folder.path(), &["train.toml", "--out", "out"]);
    let expected = "error: train.toml: no case is left: every coupler that would break carries buff, so that nothing parts; buff_breaks = true computes a break of one that is named\n";
    assert_eq!((output.status.code(), complaint(&output)), (Some(2), expected.to_owned()));
}

#[test]
fn a_study_in_a_folder_is_left_out_and_said_to_be_one() {
    let train = format!("{COUPLER}{VEHICLES}{LOAD}{BREAK_5}");
    let study = study(&vary("coupler.rated_load", WEIBULL));
    let folder = folder(&[("train.toml", &train), ("study.toml", &study)]);
    let run = |arguments: &[&str]| fleet(folder.path(), &[arguments, &["--out", "out"]].concat());
    let note = |path: &str| {
        format!("{path} is a study and no train, so it is left out: to run it, type trainsafe fleet {path}")
    };
    for (given, path) in [(".", "./study.toml"), ("*.toml", "study.toml"), ("./*", "study.toml")] {
        let output = run(&[given]);
        assert!(output.status.success(), "{}", complaint(&output));
        assert!(complaint(&output).contains(&format!("note: {}\n", note(path))), "{}", complaint(&output));
        assert_eq!(rows(&folder.path().join("out/fleet.csv")).len(), 1);
        fs::remove_dir_all(folder.path().join("out")).expect("it was written");
    }
    // Its own file is no news to a study.
    fs::write(folder.path().join("study.toml"), study.replace("train.toml", "*.toml")).expect("a study");
    let output = run(&["study.toml"]);
    assert!(output.status.success() && !complaint(&output).contains("note"), "{}", complaint(&output));
    let both = run(&["train.toml", "study.toml"]);
    assert_eq!(both.status.code(), Some(2));
    assert_eq!(complaint(&both), "error: study.toml is a study, which names its own trains: give it alone\n");
    fs::remove_file(folder.path().join("train.toml")).expect("it was there");
    let none = run(&["."]);
    let expected = format!("error: . has no train file (*.toml) in it or below; {}\n", note("./study.toml"));
    assert_eq!((none.status.code(), complaint(&none)), (Some(2), expected));
}

#[test]
fn a_path_of_another_kind_says_what_it_is() {
    let result = "{\"train\": \"x\", \"couplers\": 3, \"scenarios\": []}";
    let folder = folder(&[("consist.csv", "label,mass [t]\nloco,196\ncar,120\n"), ("result.json", result)]);
    let consist = "error: consist.csv: this is a table of vehicles, and no train file\n";
    let json = "error: result.json: this is the result of an analysis (result.json), and no train file\n";
    for (path, expected) in [("consist.csv", consist), ("result.json", json)] {
        let output = fleet(folder.path(), &[path, "--out", "out"]);
        assert_eq!((output.status.code(), complaint(&output)), (Some(2), expected.to_owned()));
    }
}
