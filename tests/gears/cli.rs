//! Trains with slack, gears and brakes through the command line: published tables, words of `check`, studies, cascades.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

const GEAR: &str =
    "travel [mm];loading [kN];unloading [kN]\n0,0;0;0\n7,0;120;60\n38,0;680;172\n114,0;1350;300\n149,0;2520;360\n";
const GEARS: &str = "gear = \"gear.csv\"\nsolid_stiffness = \"200 MN/m\"";

/// Half a unit of the eighth digit after the point, and a little.
const EIGHT: f64 = 0.51e-8;

fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("gear.csv"), GEAR).expect("a file");
    for (name, text) in files {
        fs::write(folder.path().join(name), text).expect("a file");
    }
    folder
}

fn run(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_trainsafe")).current_dir(folder).args(args).output().expect("trainsafe runs")
}

fn text(folder: &Path, args: &[&str]) -> String {
    let output = run(folder, args);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

/// The cases of the first scenario of a train file.
fn analyzed(train: &str) -> Value {
    let folder = folder(&[("train.toml", train)]);
    let json: Value = serde_json::from_str(&text(folder.path(), &["analyze", "train.toml", "--json"])).expect("JSON");
    json["scenarios"][0]["cases"][0].clone()
}

/// Largest force of some couplers in one sense, N, positive; couplers count from 1.
fn largest(case: &Value, key: &str, of: impl Fn(u64) -> bool) -> f64 {
    let couplers = case["couplers"].as_array().expect("couplers");
    let some = couplers.iter().filter(|c| of(c["coupler"].as_u64().expect("a number")));
    some.filter_map(|c| c[key].as_f64()).fold(0.0, |a, f| a.max(f.abs()))
}

/// 105 cars of 130 t behind a held head, pulled by 0.6 MN; one more lets go of them.
fn let_go(coupler: &str, load: &str) -> String {
    format!(
        "[coupler]\n{coupler}\nrated_load = \"2 MN\"\n[[vehicle]]\nmass = \"130 t\"\nheld = true\n[[vehicle]]\ncount = 106\nmass = \"130 t\"\n\
         [load]\nuniform = \"0.6 MN\"\n{load}\n[[scenario]]\nkind = \"break\"\ncoupler = 106\nhorizon = \"40 s\"\n"
    )
}

#[test]
fn trains_let_go_reach_the_published_shares() {
    let gears = |slack: &str| format!("{GEARS}\n{slack}");
    let slack = |mm: u32| gears(&format!("slack = \"{mm} mm\""));
    let spring = "stiffness = \"17.9 MN/m\"\nslack = \"0 mm\"\nstiffness_in_buff = \"17.900001 MN/m\"".to_owned();
    let rows = [
        (gears(""), 0.86782652, EIGHT),
        (slack(10), 0.85415364, EIGHT),
        (slack(25), 0.65792147, EIGHT),
        (slack(50), 0.65599648, EIGHT),
        // A millionth more in buff: a law that is not linear, and the linear train's force but for that.
        (spring, 1.52875604, 1e-6),
    ];
    for (coupler, share, tolerance) in rows {
        let case = analyzed(&let_go(&coupler, ""));
        let all = |_| true;
        let found = largest(&case, "peak_buff_n", all).max(largest(&case, "peak_draft_n", all)) / 6e5;
        let found = if share < 1.0 { largest(&case, "peak_buff_n", all) / 6e5 } else { found };
        assert!((found - share).abs() < tolerance, "{coupler}: {found:.12} for {share}");
        assert_eq!(case["method"], "march");
        assert!(
            case["error_bound_n"].is_null() && case["error_estimate_n"].as_f64().is_some_and(|n| n < 1.0),
            "{case}"
        );
        assert_eq!((&case["predictable_until_s"], &case["safe_load_factor"]), (&Value::Null, &Value::Null));
    }
}

#[test]
fn a_train_let_down_from_a_larger_pull_presses_harder() {
    for (pulled, share) in [("0.8 MN", 0.916), ("1.2 MN", 1.364)] {
        let coupler = format!("{GEARS}\nslack = \"25 mm\"");
        let case = analyzed(&let_go(&coupler, &format!("pulled_to = \"{pulled}\"")));
        let found = largest(&case, "peak_buff_n", |_| true) / 6e5;
        assert!((found - share).abs() < 0.51e-3, "{pulled}: {found}");
    }
}

/// [P] figure 4 with friction: 50 unit masses, loading stiffness 1, 18 in series, half a unit of slack.
#[test]
fn figure_4_with_slack_and_friction() {
    let train = "[coupler]\ngear = [[\"0 m\", \"0 N\"], [\"1000 m\", \"1058.8235294117646 N\"]]\nsolid_stiffness = \"18 N/m\"\n\
         friction = \"50 %\"\nslack = \"0.5 m\"\nrated_load = \"2 N\"\n[[vehicle]]\nmass = \"1 kg\"\nheld = true\n[[vehicle]]\n\
         count = 51\nmass = \"1 kg\"\n[load]\nuniform = \"1 N\"\n[[scenario]]\nkind = \"break\"\ncoupler = 51\nhorizon = \"400 s\"\n";
    let case = analyzed(train);
    let found = largest(&case, "peak_buff_n", |_| true);
    assert!((found - 0.77741065).abs() < EIGHT, "{found}");
}

/// A hauled train that parts behind car 30, with more keys of the break.
fn hauled(coupler: &str, of_break: &str) -> String {
    format!(
        "speed = \"72 km/h\"\n[coupler]\n{coupler}\nrated_load = \"2 MN\"\n[[vehicle]]\nlabel = \"locomotives\"\nmass = \"392 t\"\n\
         length = \"16.2 m\"\ntractive_effort = \"600 kN\"\n[[vehicle]]\nlabel = \"car\"\ncount = 105\nmass = \"130 t\"\nlength = \"16.2 m\"\n\
         brake_force = \"5.714285714285714 kN\"\nemergency_brake = \"45 kN\"\n[[scenario]]\nkind = \"break\"\n\
         coupler = {{ behind = \"car 30\" }}\nhorizon = \"40 s\"\n{of_break}"
    )
}

#[test]
fn emergency_brakes_load_a_parted_train_more_than_the_break() {
    let sample = "emergency = { wave = \"290 m/s\", build_up = [[\"0 s\", \"0 %\"], [\"1.5 s\", \"30 %\"], [\"8 s\", \"100 %\"]] }\n";
    let slow = sample.replace("290", "250");
    let cut = format!("{sample}cut_power = {{ after = \"3 s\", over = \"2 s\" }}\n");
    let gears = format!("{GEARS}\nslack = \"25 mm\"");
    let spring = "stiffness = \"17.9 MN/m\"";
    let dashpot = format!("{spring}\ndamping = \"427.1247 kN*s/m\"");
    let (front, rear) = (|c| c < 31, |c| c > 31);
    let rows: [(&str, &str, [f64; 2]); 6] = [
        (&gears, "", [1.007, 0.452]),
        (&gears, sample, [1.152, 1.370]),
        (&gears, &slow, [f64::NAN, 1.432]),
        (&gears, &cut, [1.080, f64::NAN]),
        (spring, sample, [1.448, 1.233]),
        (&dashpot, sample, [1.223, 1.180]),
    ];
    for (coupler, of_break, [draft, buff]) in rows {
        let case = analyzed(&hauled(coupler, of_break));
        let found = [largest(&case, "peak_draft_n", front), largest(&case, "peak_buff_n", rear)].map(|n| n / 6e5);
        let right = |found: f64, share: f64| share.is_nan() || (found - share).abs() < 0.51e-3;
        assert!(right(found[0], draft) && right(found[1], buff), "{coupler} {of_break}: {found:?}");
    }
}

#[test]
fn check_tells_slack_travel_and_losses() {
    let train = let_go(&format!("{GEARS}\nslack = \"25 mm\""), "pulled_to = \"0.8 MN\"");
    let folder = folder(&[("train.toml", &train)]);
    let told = text(folder.path(), &["check", "train.toml"]);
    for part in [
        "every coupler: a gear in series with 200 MN/m (it closes after 149 mm at 2.52 MN, and a full stroke takes 157.7 kJ, of which \
         79 % is lost), slack 25 mm",
        "at 600 kN in draft, let down from 800 kN, the connection is 54.61 mm beyond the slack",
    ] {
        assert!(told.contains(part), "{told}");
    }
}

#[test]
fn a_study_varies_gears_slack_and_friction() {
    let train = let_go(
        "gear = [[\"0 mm\", \"0 kN\"], [\"149 mm\", \"2520 kN\"]]\nsolid_stiffness = \"200 MN/m\"\nfriction = \"50 %\"",
        "",
    );
    let train = train.replace("count = 106", "count = 11").replace("= 106", "= 11").replace("40 s", "8 s");
    let with_file = train.replace("gear = [[\"0 mm\", \"0 kN\"], [\"149 mm\", \"2520 kN\"]]", "gear = \"wedge.csv\"");
    let study = "trains = \"train.toml\"\n[[vary]]\nkey = \"coupler.slack\"\nvalues = [\"0 mm\", \"20 mm\"]\n[[vary]]\n\
                 key = \"coupler.friction\"\nfrom = \"20 %\"\nto = \"80 %\"\nsteps = 2\n";
    let folder = folder(&[
        ("train.toml", &with_file),
        ("wedge.csv", "travel [mm],loading [kN]\n0,0\n149,2520\n"),
        ("study.toml", study),
    ]);
    text(folder.path(), &["fleet", "study.toml", "--out", "out"]);
    let rows = fs::read_to_string(folder.path().join("out/fleet.csv")).expect("rows");
    let mut reader = csv::Reader::from_reader(rows.as_bytes());
    let headings = reader.headers().expect("headings").clone();
    let column = |name: &str| headings.iter().position(|h| h == name).expect("a column");
    let (peak, bound, estimate) = (column("peak_force_n"), column("error_bound_n"), column("error_estimate_n"));
    let records: Vec<csv::StringRecord> = reader.records().map(|r| r.expect("a row")).collect();
    assert_eq!(records.len(), 4, "{rows}");
    assert!(records.iter().all(|r| r[bound].is_empty() && !r[estimate].is_empty()), "{rows}");
    let peaks: std::collections::BTreeSet<&str> = records.iter().map(|r| &r[peak]).collect();
    assert!(peaks.len() > 1, "{rows}");
    // The gear's file is one of those that the run depends on.
    let fingerprint = |out: &str| {
        text(folder.path(), &["fleet", "study.toml", "--out", out]);
        let run = fs::read_to_string(folder.path().join(out).join("fleet-run.json")).expect("the run");
        run.lines().find(|line| line.contains("fingerprint")).map(str::to_owned)
    };
    let before = fingerprint("again");
    fs::write(folder.path().join("wedge.csv"), "travel [mm],loading [kN]\n0,0\n149,2500\n").expect("a file");
    assert_ne!(before, fingerprint("other"));
}

/// A study varies how fast an application runs and, as a factor on its times, how fast it builds up, of a named one as well; each
/// row is the analysis of the train with those values. What changes nothing is refused.
#[test]
fn a_study_varies_a_brake_application() {
    let shorter = |train: String| train.replace("count = 105", "count = 40").replace("40 s", "12 s");
    let train = shorter(hauled(GEARS, "emergency = \"AAR\"\n"));
    let inputs = "trains = \"train.toml\"\n[[vary]]\nkey = \"scenario[0].emergency.wave\"\nvalues = [\"290 m/s\", \"200 m/s\"]\n[[vary]]\n\
                  key = \"scenario[0].emergency.build_up\"\nvalues = [\"50 %\", \"100 %\"]\n";
    let folder = folder(&[("train.toml", &train), ("study.toml", inputs)]);
    text(folder.path(), &["fleet", "study.toml", "--out", "out"]);
    let rows = fs::read_to_string(folder.path().join("out/fleet.csv")).expect("rows");
    let mut reader = csv::Reader::from_reader(rows.as_bytes());
    let headings = reader.headers().expect("headings").clone();
    let column = |name: &str| headings.iter().position(|h| h == name).unwrap_or_else(|| panic!("{name}: {headings:?}"));
    let (peak, wave, factor) = (
        column("peak_force_n"),
        column("scenario[0].emergency.wave [m/s]"),
        column("scenario[0].emergency.build_up [%]"),
    );
    let records: Vec<csv::StringRecord> = reader.records().map(|r| r.expect("a row")).collect();
    let inputs: Vec<_> = records.iter().map(|r| [r[wave].to_owned(), r[factor].to_owned()]).collect();
    assert_eq!(inputs, [["290.0", "50.0"], ["290.0", "100.0"], ["200.0", "50.0"], ["200.0", "100.0"]]);
    let of = |wave: &str, factor: f64| {
        let [first, last] = [1.5 * factor, 8.0 * factor];
        let application = format!(
            "emergency = {{ wave = \"{wave}\", build_up = [[\"0 s\", \"0 %\"], [\"{first} s\", \"30 %\"], [\"{last} s\", \"100 %\"]] }}"
        );
        let case = analyzed(&train.replace("emergency = \"AAR\"", &application));
        case["worst"]["peak_force_n"].as_f64().expect("a force")
    };
    let expected = [of("290 m/s", 0.5), of("290 m/s", 1.0), of("200 m/s", 0.5), of("200 m/s", 1.0)];
    for (row, expected) in records.iter().zip(expected) {
        assert_eq!(row[peak].parse::<f64>().expect("a force"), expected);
    }
    assert!(expected.windows(2).all(|w| (w[0] - w[1]).abs() > 100.0), "{expected:?}");
    let refused = |train: &str, key: &str, values: &str| {
        let study = format!("trains = \"train.toml\"\n[[vary]]\nkey = \"scenario[0].{key}\"\nvalues = [{values}]\n");
        fs::write(folder.path().join("train.toml"), train).expect("a train");
        fs::write(folder.path().join("study.toml"), study).expect("a study");
        let output = run(folder.path(), &["fleet", "study.toml", "--dry-run"]);
        assert_eq!(output.status.code(), Some(2), "{key}");
        String::from_utf8(output.stderr).expect("text")
    };
    let without = refused(&hauled(GEARS, ""), "emergency.wave", "\"290 m/s\", \"200 m/s\"");
    assert!(
        without.contains("scenario[0].emergency.wave reaches nothing in train.toml: its scenario[0] has no emergency"),
        "{without}"
    );
    let other = refused(&train, "service.build_up", "\"50 %\", \"100 %\"");
    assert!(
        other.contains("scenario[0].service.build_up reaches nothing in train.toml: its scenario[0] has no service"),
        "{other}"
    );
    assert!(refused(&train, "emergency.build_up", "\"2 s\"").contains("a unit of time"));
}

/// A gap at a parted coupler closes again, and the parts push each other.
#[test]
fn parted_pieces_meet_again() {
    let train = hauled(&format!("{GEARS}\nslack = \"25 mm\""), "").replace(
        "brake_force = \"5.714285714285714 kN\"",
        "brake_force = \"5.714285714285714 kN\"\ntractive_effort = \"0 kN\"",
    );
    let throttle = "time [s],force [kN]\n0,600\n0,-900\n";
    let folder =
        folder(&[("train.toml", &format!("{train}throttle = \"throttle.csv\"\n")), ("throttle.csv", throttle)]);
    let json = text(folder.path(), &["analyze", "train.toml", "--json"]);
    let json: Value = serde_json::from_str(&json).expect("JSON");
    let closure = &json["scenarios"][0]["cases"][0]["gap_closures"][0];
    assert_eq!(closure["coupler"], 31, "{json}");
    assert!(closure["time_s"].as_f64().is_some_and(|t| t > 0.0 && t < 40.0));
    let told = text(folder.path(), &["analyze", "train.toml", "--out", "out"]);
    assert!(told.replace('\n', " ").contains("The vehicles that part at coupler 31 meet again at"), "{told}");
}

/// A throttle schedule on a logger's clock changes nothing for a long time, and is told.
#[test]
fn a_throttle_schedule_that_starts_late_is_told() {
    let train = hauled(GEARS, "emergency = \"UIC P\"\n");
    for (start, late) in [("0", false), ("59", false), ("61", true), ("5000", true)] {
        let throttle = format!("time [s],force [kN]\n{start},600\n{start}.5,0\n");
        let files = [("train.toml", &*format!("{train}throttle = \"throttle.csv\"\n")), ("throttle.csv", &*throttle)];
        let said = text(folder(&files).path(), &["check", "train.toml"]);
        let expected =
            format!("warning: the schedule throttle.csv starts at {start} s, and tractive efforts stay as they are");
        assert_eq!(said.contains(&expected), late, "{said}");
    }
}

/// What brakes bring to a stand ends the report, and is told.
#[test]
fn a_vehicle_that_stops_ends_the_report() {
    let train = hauled(&format!("{GEARS}\nslack = \"25 mm\""), "emergency = \"UIC P\"\n").replace("72 km/h", "18 km/h");
    let folder = folder(&[("train.toml", &train)]);
    let json: Value = serde_json::from_str(&text(folder.path(), &["analyze", "train.toml", "--json"])).expect("JSON");
    let case = &json["scenarios"][0]["cases"][0];
    let at = case["stopped_at_s"].as_f64().expect("a time");
    assert!(at > 5.0 && at < 40.0 && case["horizon_s"] == at, "{case}");
    assert_eq!(json["doubts"][0]["code"], "vehicle-stops", "{}", json["doubts"]);
    let number = case["stopped_vehicle"].as_u64().expect("a vehicle");
    let named = format!("vehicle {number} (car {}) would come to a stand", number - 1);
    assert!(json["doubts"][0]["text"].as_str().is_some_and(|text| text.starts_with(&named)), "{}", json["doubts"]);
    text(folder.path(), &["analyze", "train.toml", "--out", "out"]);
    let report = fs::read_to_string(folder.path().join("out/report.md")).expect("a report");
    assert!(
        report.contains(&format!("{named} then")) && report.contains("This is an estimate, not a bound"),
        "{report}"
    );
}

/// Brakes that are applied everywhere at once stop every vehicle, of equal mass and brake force, after v m / B.
#[test]
fn a_brake_application_stops_the_train() {
    let train = "speed = \"5 km/h\"\n[coupler]\nstiffness = \"30 MN/m\"\nslack = \"10 mm\"\nrated_load = \"1 MN\"\n[[vehicle]]\ncount = 20\n\
                 mass = \"80 t\"\nlength = \"15 m\"\nemergency_brake = \"60 kN\"\n[[scenario]]\nkind = \"brake\"\nat = \"head\"\n\
                 horizon = \"60 s\"\nemergency = { wave = \"300 km/s\", build_up = [[\"0 s\", \"0 %\"], [\"1 us\", \"100 %\"]] }\n";
    let stops = |train: &str| {
        let folder = folder(&[("train.toml", train)]);
        let json: Value =
            serde_json::from_str(&text(folder.path(), &["analyze", "train.toml", "--json"])).expect("JSON");
        json["scenarios"][0]["cases"][0]["stopped_at_s"].as_f64().expect("it stops")
    };
    let due_s = 5.0 / 3.6 * 80e3 / 60e3;
    assert!((stops(train) - due_s).abs() < 1e-5, "{} {due_s}", stops(train));
    // Forces that slow or drive the train before the application take part: a = -0.2 m/s2 and 0.5 m/s2 beside the brakes' -0.75.
    for (key, a) in [("rolling_resistance = \"200 N/t\"", -0.2), ("tractive_effort = \"40 kN\"", 0.5)] {
        let train = train.replace("emergency_brake = \"60 kN\"", &format!("emergency_brake = \"60 kN\"\n{key}"));
        let due_s = 5.0 / 3.6 / (60e3 / 80e3 - a);
        assert!((stops(&train) - due_s).abs() < 1e-4, "{key}: {} {due_s}", stops(&train));
    }
}

#[test]
fn sample_gears_are_read() {
    let files = fs::read_dir("trains/gears").expect("the folder of gears").map(|f| f.expect("an entry").path());
    let mut count = 0;
    for path in files {
        let gear = path.display().to_string();
        let friction = if gear.contains("mt-2") { "friction = \"82 %\"\n" } else { "" };
        let text = format!(
            "[coupler]\ngear = {gear:?}\nsolid_stiffness = \"200 MN/m\"\n{friction}rated_load = \"2 MN\"\n[[vehicle]]\ncount = 3\n\
             mass = \"90 t\"\n[load]\nuniform = \"0.2 MN\"\n"
        );
        let train = trainsafe::consist::parse(&text, Path::new("a.toml")).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(train.origin().doubts, [], "{gear}");
        count += 1;
    }
    assert_eq!(count, 5);
}

/// Shares of 1 in a column of per cent, and springs without loss in an impact.
#[test]
fn shares_of_one_and_springs_that_rebound_are_told() {
    let train = hauled(GEARS, "throttle = \"throttle.csv\"\n");
    for (rows, told) in
        [("0,1\n2.5,0.5\n", true), ("0,100\n2.5,50\n", false), ("0,100\n2.5,0\n", false), ("0,0\n", false)]
    {
        let throttle = format!("time [s],share [%]\n{rows}");
        let folder = folder(&[("train.toml", &train), ("throttle.csv", &throttle)]);
        let said = text(folder.path(), &["check", "train.toml"]);
        assert_eq!(said.contains("were shares of 1 meant"), told, "{said}");
    }
    let impact = "[[vehicle]]\nmass = \"80 t\"\ncount = 6\n[[scenario]]\nkind = \"impact\"\nat = \"tail\"\nvehicles = 2\nspeed = \"5 km/h\"\n";
    for (coupler, told) in
        [("stiffness = \"30 MN/m\"\nslack = \"16 mm\"", true), (GEARS, false), ("stiffness = \"30 MN/m\"", false)]
    {
        let train = format!("[coupler]\n{coupler}\nrated_load = \"2 MN\"\n{impact}");
        let folder = folder(&[("train.toml", &train)]);
        let said = text(folder.path(), &["check", "train.toml"]);
        assert_eq!(said.contains("the whole rebound of the springs"), told, "{coupler}: {said}");
    }
}

/// A schedule whose first row is not the effort before the event, which jumps there.
#[test]
fn a_throttle_schedule_that_jumps_is_told() {
    let train = hauled(GEARS, "throttle = \"throttle.csv\"\n");
    for (rows, told) in [
        ("time [s],share [%]\n0,60\n2.5,50\n", true),
        ("time [s],share [%]\n0,99.5\n2.5,0\n", false),
        ("time [s],share [%]\n0,100\n0,60\n", false),
        ("time [s],force [kN]\n3,550\n4,0\n", true),
        ("time [s],force [kN]\n0,600\n4,0\n", false),
    ] {
        let folder = folder(&[("train.toml", &train), ("throttle.csv", rows)]);
        let said = text(folder.path(), &["check", "train.toml"]);
        let at = if rows.contains("\n3,") { "3 s" } else { "0 s" };
        let expected = format!("than that before the event: that of locomotives jumps at {at}; begin it with a row");
        assert_eq!(said.contains(&expected), told, "{said}");
    }
}

/// Parts in series with a gear that are softer than the gear; a gear without force; a map of an impact on gears.
#[test]
fn odd_gears_and_maps_are_told() {
    let train = |gear: &str, solid: &str| {
        format!(
            "[coupler]\ngear = {gear}\nsolid_stiffness = \"{solid}\"\nfriction = \"50 %\"\nrated_load = \"2 MN\"\n[[vehicle]]\ncount = 3\nmass = \"80 t\"\n\
             [[scenario]]\nname = \"they meet\"\nkind = \"impact\"\nat = \"tail\"\nvehicles = 1\nspeed = \"5 km/h\"\nhorizon = \"1 s\"\n"
        )
    };
    let wedge = "[[\"0 mm\", \"100 kN\"], [\"100 mm\", \"1100 kN\"]]";
    let folder = folder(&[("soft.toml", &train(wedge, "9 MN/m")), ("stiff.toml", &train(wedge, "11 MN/m"))]);
    let soft = "warning: the solid_stiffness of coupler 1 (and 1 more coupler) is 9 MN/m, softer than its gear, 10 MN/m over the whole stroke";
    assert!(
        text(folder.path(), &["check", "soft.toml"]).contains(soft),
        "{}",
        text(folder.path(), &["check", "soft.toml"])
    );
    assert!(!text(folder.path(), &["check", "stiff.toml"]).contains("solid_stiffness of coupler"));
    let flat = train("[[\"0 mm\", \"0 kN\"], [\"100 mm\", \"0 kN\"]]", "200 MN/m");
    let refused = trainsafe::consist::parse(&flat, Path::new("flat.toml")).expect_err("no force").to_string();
    assert!(refused.contains("gear: its loading force is 0 in every row, so that it moves without force"), "{refused}");
    assert!(
        refused.contains("help: give the forces of loading with their unit; travel without force is slack"),
        "{refused}"
    );
    let output = run(folder.path(), &["analyze", "stiff.toml", "--map", "--json"]);
    let said = String::from_utf8(output.stderr).expect("text");
    let expected = "note: they meet: --map does nothing for an impact: the factor on its speed from which couplers exceed, which is searched for, \
                    says all that a map would";
    assert!(said.contains(expected), "{said}");
}

/// A warning names a gear that closes in an impact, and none that does not.
#[test]
fn closing_gears_are_told() {
    let codes = |speed: &str| {
        let text = format!(
            "[coupler]\ngear = \"trains/gears/aar-friction-pair.csv\"\nsolid_stiffness = \"200 MN/m\"\nslack = \"25 mm\"\nrated_load = \
             \"1.7 MN\"\n[[vehicle]]\ncount = 12\nmass = \"130 t\"\n[[scenario]]\nname = \"impact\"\nkind = \"impact\"\nat = \
             \"head\"\nvehicles = 3\nspeed = \"{speed}\"\nhorizon = \"5 s\"\n"
        );
        let train = trainsafe::consist::parse(&text, Path::new("a.toml")).unwrap_or_else(|e| panic!("{e}"));
        let analysis = trainsafe::analyze(&train, &trainsafe::Options::default()).expect("sound");
        let largest_n = analysis.scenarios[0].cases[0].worst.as_ref().expect("a coupler").peak_force_n.abs();
        (analysis.doubts.iter().map(|d| d.code).collect::<Vec<_>>(), largest_n > 2.52e6)
    };
    assert_eq!(codes("4 mph"), (vec![], false));
    assert_eq!(codes("6 mph"), (vec!["gear-closes"], true));
}
