//! Tables of vehicles and records as spreadsheets and loggers export them: read to the right numbers, or refused once with the reason.

use std::fs;

use trainsafe::Train;
use trainsafe::consist;
use trainsafe::doubts::doubts;
use trainsafe::train::{Doubt, Event, Pulse};

const FRONT: &str = "name = \"probe\"\n[coupler]\nstiffness = \"11.1 MN/m\"\nrated_load = \"1.78 MN\"\n";

/// The train of a text with files beside it.
fn read(text: &str, files: &[(&str, &[u8])]) -> Result<Train, String> {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, bytes) in files {
        fs::write(folder.path().join(name), bytes).expect("a file");
    }
    let shown = format!("{}/", folder.path().display());
    consist::parse(text, &folder.path().join("train.toml")).map_err(|e| e.to_string().replace(&shown, ""))
}

fn table(bytes: impl AsRef<[u8]>) -> Result<Train, String> {
    let load = "[load]\nuniform = \"0.6 MN\"\n";
    read(&format!("vehicles = \"c.csv\"\n{FRONT}{load}"), &[("c.csv", bytes.as_ref())])
}

fn masses(bytes: impl AsRef<[u8]>) -> Vec<f64> {
    let text = String::from_utf8_lossy(bytes.as_ref()).into_owned();
    table(bytes).unwrap_or_else(|e| panic!("{text}\n{e}")).vehicles().iter().map(|v| v.mass_kg).collect()
}

fn codes(train: &Train) -> Vec<&'static str> {
    train.origin().doubts.iter().map(|doubt| doubt.code).collect()
}

fn record(bytes: impl AsRef<[u8]>) -> Result<Train, String> {
    let rest = "[[vehicle]]\nmass = \"100 t\"\ncount = 10\n[[scenario]]\nkind = \"pulse\"\nat = \"tail\"\nrecord = \"p.csv\"\n";
    read(&format!("{FRONT}{rest}"), &[("p.csv", bytes.as_ref())])
}

/// The record as what it is drawn by, and its doubts.
fn course(bytes: impl AsRef<[u8]>) -> (String, f64, f64, Vec<&'static str>) {
    let text = String::from_utf8_lossy(bytes.as_ref()).into_owned();
    let train = record(bytes).unwrap_or_else(|e| panic!("{text}\n{e}"));
    match &train.scenarios()[0].event {
        Event::Pulse(pulse) => (format!("{:?}", pulse.drive()), pulse.force_n, pulse.duration_s, codes(&train)),
        other => panic!("{other:?}"),
    }
}

fn utf16(text: &str, mark: bool, little: bool) -> Vec<u8> {
    let units = mark.then_some(0xfeff).into_iter().chain(text.encode_utf16());
    units.flat_map(|u| if little { u.to_le_bytes() } else { u.to_be_bytes() }).collect()
}

#[test]
fn headings_have_many_forms() {
    for header in [
        "label,mass [t],rated_load (MN),stiffness (MN/m)",
        "Label,Mass (t),Rated Load [MN],Stiffness_MN/m",
        "LABEL,MASS_T,RATED_LOAD_MN,STIFFNESS [MN/M]",
        "name,weight [t],rating [MN],coupler stiffness (MN/m)",
        "label,\"mass, t\",\"rated-load, MN\",stiffness {MN/m}",
    ] {
        let train = table(format!("{header}\nloco,196,0.5,5\ncar a,130,0.5,5\ncar b,30,0.5,5\n")).expect(header);
        let coupler = train.couplers()[1];
        assert_eq!(
            (train.vehicles()[1].mass_kg, coupler.rated_draft_n, coupler.stiffness_n_per_m),
            (130e3, 5e5, 5e6),
            "{header}"
        );
        assert_eq!((train.vehicles()[1].label.as_str(), codes(&train)), ("car a", vec![]), "{header}");
    }
}

#[test]
fn forces_on_the_vehicles_are_read_from_a_table() {
    let csv = "label,mass [t],tractive_effort [kN],brake force (kN),grade [%],Rolling_Resistance_N/t\n\
               loco,196,400,,1,20\ncar a,130,,10.5,,\ncar b,130,,16.34,,\n";
    let tabled = read(&format!("vehicles = \"c.csv\"\n{FRONT}"), &[("c.csv", csv.as_bytes())]).expect("a table");
    let spelt = "[[vehicle]]\nlabel = \"loco\"\nmass = \"196 t\"\ntractive_effort = \"400 kN\"\ngrade = \"1 %\"\nrolling_resistance = \
                 \"20 N/t\"\n[[vehicle]]\nlabel = \"car a\"\nmass = \"130 t\"\nbrake_force = \"10.5 kN\"\n[[vehicle]]\nlabel = \"car \
                 b\"\nmass = \"130 t\"\nbrake_force = \"16.34 kN\"\n";
    let spelt = read(&format!("{FRONT}{spelt}"), &[]).expect("a train");
    assert_eq!((tabled.initial_force_n(), tabled.extras()), (spelt.initial_force_n(), spelt.extras()));
}

/// Every column gets a value that matters: the train changes, or a doubt says that it is not read.
#[test]
fn no_column_is_passed_over_in_silence() {
    let plain = table("label,mass [t]\na,100\nb,100\nc,100\n").expect("a table");
    let columns = [
        ("label", "x"),
        ("count", "2"),
        ("held", "yes"),
        ("mass [t]", "50"),
        ("length [m]", "12"),
        ("tractive_effort [kN]", "100"),
        ("brake_force [kN]", "100"),
        ("rolling_resistance [N/t]", "15"),
        ("grade [%]", "1"),
        ("stiffness [MN/m]", "5"),
        ("rated_load [MN]", "0.5"),
        ("rated_load [%]", "50"),
        ("rated_buff [MN]", "0.5"),
        ("rated_buff [%]", "80"),
        ("damping [kN*s/m]", "200"),
        ("emergency_brake [kN]", "45"),
        ("stiffness_in_buff [MN/m]", "20"),
        ("slack [mm]", "10"),
        ("gear", "no-such-gear.csv"),
        ("gear_in_buff", "no-such-gear.csv"),
        ("friction [%]", "50"),
        ("solid_stiffness [MN/m]", "200"),
        ("limits.fatigue [MN]", "0.9"),
        ("limits proof (MN)", "0.9"),
        ("ultimate [MN]", "0.9"),
        ("fatigue [kN]", "900"),
        ("pos", "7"),
        ("owner", "me"),
        ("mass_empty [t]", "20"),
        ("", "a note"),
    ];
    // Each key of a vehicle and of a coupler is among them.
    let schema = trainsafe::schema::train();
    let keys = |table: &str| schema["properties"][table]["items"]["properties"].as_object().expect("keys").clone();
    for key in keys("vehicle").keys().chain(keys("coupler_override").keys()).filter(|key| *key != "at") {
        assert!(columns.iter().any(|(heading, _)| heading.starts_with(key.as_str())), "{key} is no column here");
    }
    for (heading, value) in columns {
        // The forces on vehicles and a uniform load exclude each other.
        let with = match heading {
            "label" => format!("label,mass [t]\n{value},100\nb,100\nc,100\n"),
            "mass [t]" => format!("label,mass [t]\na,{value}\nb,100\nc,100\n"),
            _ => format!("label,mass [t],{heading}\na,100,{value}\nb,100,\nc,100,\n"),
        };
        let told = match read(&format!("vehicles = \"c.csv\"\n{FRONT}"), &[("c.csv", with.as_bytes())]) {
            Ok(train) => {
                let changed = train.vehicles() != plain.vehicles() || train.couplers() != plain.couplers();
                let loaded = train.extras() != plain.extras();
                changed || loaded || !train.origin().doubts.is_empty() || heading == "pos"
            }
            Err(_) => true,
        };
        assert!(told, "{heading}");
    }
    let error = table("pos,mass [t]\n7,100\n6,100\n5,100\n").expect_err("a column out of order");
    assert!(error.contains("row 3, column pos: 6 comes after 7"), "{error}");
}

#[test]
fn a_column_that_is_not_read_is_named() {
    let train = table("Wagon no;mass [t];Owner;empty\n4711;100;me;\n4712;90;you;\n").expect("a table");
    let text = "the columns \"Wagon no\", \"Owner\" of c.csv are not read";
    assert_eq!(doubts(&train)[0], Doubt::of_train("column-not-read", text));
    assert!(consist::describe(&train).contains(&format!("warning: {text}")));
    // A second sense of a name is another column, not a second one.
    let train = table("label,name,mass [t]\na,b,100\nc,d,90\n").expect("a table");
    assert_eq!(codes(&train), ["column-not-read"]);
}

#[test]
fn spreadsheets_export_in_many_ways() {
    let comma = "label;mass [t];length [m]\nLok;87,5;19,0\nWagen;90,0;14,04\nWagen;22,1;14,04\n";
    assert_eq!(masses(comma), [87.5e3, 90e3, 22.1e3]);
    assert_eq!(table(comma).expect("a table").vehicles()[1].length_m, Some(14.04));
    assert_eq!(masses(format!("sep=;\r\n{}", comma.replace('\n', "\r\n"))), [87.5e3, 90e3, 22.1e3]);
    assert_eq!(masses(comma.replace(';', "\t")), [87.5e3, 90e3, 22.1e3]);
    assert_eq!(masses(comma.replace('\n', "\r")), [87.5e3, 90e3, 22.1e3]);
    for (mark, little) in [(true, true), (true, false), (false, true), (false, false)] {
        assert_eq!(masses(utf16(comma, mark, little)), [87.5e3, 90e3, 22.1e3]);
    }
    let train = table(b"label;mass [t]\nG\xfcterwagen;87,5\nb;90\n").expect("Windows-1252");
    assert_eq!(train.vehicles()[0].label, "G\u{fc}terwagen");
    // Titles, comments, metadata and blank rows above; a row of units below.
    let all = [
        "# consist 2026-01-01\n",
        "Consist of train 7\n\n",
        "Yard,North\nDate,2026-01-01\nmass,total\n",
        "\"a title, in quotes\"\n",
    ];
    for above in all {
        assert_eq!(
            masses(format!("{above}label,mass [t],length [m]\nloco,196,22\ncar a,130,16\n")),
            [196e3, 130e3],
            "{above}"
        );
    }
    assert_eq!(masses("label,mass,length\n,[t],[m]\nloco,196,22\ncar a,130,16\n"), [196e3, 130e3]);
    assert_eq!(
        masses("Label;Mass;Length\n-;klb;ft\nloco;432;72\ncar;286;53\n"),
        [432.0 * 453.59237, 286.0 * 453.59237]
    );
    assert_eq!(masses("# label,mass [t]\nloco,196\ncar a,130\n"), [196e3, 130e3]);
    // Thousands where there is one meaning.
    assert_eq!(masses("mass [kg]\n\"1,234,567.5\"\n\"432,000\"\n"), [1_234_567.5, 432e3]);
    assert_eq!(masses("label;mass [kg]\na;432'000\nb;80 000\n"), [432e3, 80e3]);
    assert_eq!(masses("label;mass [kg]\na;1.234.567\nb;432.000,5\n"), [1_234_567.0, 432_000.5]);
    assert_eq!(masses("mass [t]\n87,5\n90\n"), [87.5e3, 90e3]);
    // A point is before decimals where commas separate cells.
    assert_eq!(masses("label,mass [t]\na,30.125\nb,16.500\n"), [30.125e3, 16.5e3]);
}

#[test]
fn what_has_two_meanings_is_refused_once() {
    let refused = |csv: &str, title: &str| {
        let error = table(csv).expect_err(csv);
        assert_eq!((error.matches("error: ").count(), error.contains(title)), (1, true), "{error}");
    };
    refused(
        "label,mass [lb]\nloco,\"432,000\"\ncar,\"286,000\"\n",
        "error: \"432,000\" is 432000 or 432.000: nothing in the file tells",
    );
    refused(
        "label;mass [kg]\nloco;1.234\ncar;2.345\n",
        "error: \"1.234\" is 1.234 or 1234: nothing in the file tells which",
    );
    refused(
        "label;mass [t]\nloco;87,5\ncar;90.25\n",
        "error: \"87,5\" has a decimal comma, and \"90.25\" a decimal point",
    );
    refused("label,mass [t]\nLok,87,5\nWagen,90,0\n", "error: row 2 has 3 cells, and the header has 2");
    refused("label,mass\na,80\nb,90\n", "error: the column mass has no unit, and \"80\" has none");
    refused(
        "label,mass [t],rated_load_mn\na,80,1\nb,90,1\n",
        "has the unit \"mn\", which is not MN, for m is milli and M is mega",
    );
    refused("label,mass [t],mass_t\na,80,80\nb,90,90\n", "error: the table has two columns mass");
    refused("label,mass [t]\n\"a,80\nb,90\n", "error: a quotation mark is opened and never closed");
    refused("label,Gross mass [t]\na,80\nb,90\n", "error: the table has no column of masses");
}

#[test]
fn rows_out_of_order_are_refused() {
    for (csv, row, numbers) in [
        ("pos,label,mass [t]\n3,car b,30\n1,loco,196\n2,car a,130\n", 3, "1 comes after 3"),
        ("No.;mass [t]\n1;30\n3;196\n2;130\n", 4, "2 comes after 3"),
        ("#,mass [t]\n3,30\n2,196\n1,130\n", 3, "2 comes after 3"),
        ("Position,mass [t]\n1,30\n1,196\n2,130\n", 3, "1 comes after 1"),
    ] {
        let error = table(csv).expect_err(csv);
        assert!(error.contains(&format!("row {row}, column")) && error.contains(numbers), "{error}");
    }
    let codes_of = |csv: &str| codes(&table(csv).expect(csv));
    assert!(codes_of("pos,mass [t]\n1,30\n2,196\n3,130\n").is_empty());
    assert!(codes_of("pos,count,mass [t]\n1,3,30\n4,1,196\n5,1,130\n").is_empty());
    assert_eq!(codes_of("pos,mass [t]\n1,30\n2,196\n4,130\n"), ["row-numbers"]);
    assert_eq!(codes_of("number,mass [t]\n318045,30\n118046,196\n4711,130\n"), ["column-not-read"]);
}

#[test]
fn a_row_of_sums_is_doubted() {
    for csv in [
        "label,mass [t],length [m]\nloco,196,22\ncar a,130,16\ncar b,30,16\nTotal,356,54\n",
        "label,mass [t]\nloco,196\ncar a,130\ncar b,30\n,356\n",
        "label,count,mass [t]\nloco,1,196\ncar,3,100\nSumme:,,496\n",
        "label,mass [t]\nloco,196\ncar a,130\naverage,163\n",
    ] {
        assert!(codes(&table(csv).expect(csv)).contains(&"total-row"), "{csv}");
    }
    for csv in ["mass [t]\n80\n80\n", "mass [t],length [m]\n40,10\n40,10\n80,10\n", "mass [t]\n196\n130\n30\n"] {
        assert!(codes(&table(csv).expect(csv)).is_empty(), "{csv}");
    }
}

#[test]
fn a_coupler_behind_the_last_vehicle_is_doubted() {
    let csv = |last: &str| format!("mass [t],rated_load [MN]\n80,1\n80,1\n80,{last}\n");
    assert!(
        codes(&table(csv("1")).expect("filled down")).is_empty() && codes(&table(csv("")).expect("empty")).is_empty()
    );
    assert_eq!(codes(&table(csv("0.2")).expect("another")), ["no-coupler-behind"]);
}

#[test]
fn places_in_files_of_windows_are_right() {
    let csv = "label,mass [t]\r\na,80\r\nb,-3\r\nc,80\r\n";
    for text in [csv.to_owned(), csv.replace("\r\n", "\r"), csv.replace("\r\n", "\n")] {
        let error = table(&text).expect_err("a negative mass");
        let expected = "error: row 3, column mass [t]: mass is negative\n --> c.csv:3:3\n  |\n3 | b,-3\n  |   ^^\n";
        assert!(error.starts_with(expected), "{error}");
    }
    let error = record("time_s,force_kn\r\n0,0\r\n1,5\r\n0.5,0\r\n").expect_err("back in time");
    assert!(error.contains("p.csv:4:1: row 4 goes back in time"), "{error}");
}

#[test]
fn loggers_export_in_many_ways() {
    let plain = course("time_s,force_kn\n0,0\n0.05,1500\n0.1,0\n");
    assert_eq!((plain.1, plain.2, plain.3.len()), (1.5e6, 0.1, 0));
    for csv in [
        "time [ms],force [kN]\n0,0\n50,1500\n100,0\n",
        "Time (s);Force (N)\n0;0\n0.05;1500000\n0.1;0\n",
        "TIME_MS\tFORCE_KN\n0\t0\n50\t1500\n100\t0\n",
        "time_s;force_kn\n0;0\n0.05;1500\n0.1;0\n",
        "Zeit [s];Kraft [kN]\n0,00;0,0\n0,05;1500,0\n0,10;0,0\n",
        "sep=;\r\nTime;Force\r\ns;kN\r\n0;0\r\n0,05;1500\r\n0,1;0\r\n",
        "# logger 7\nSample rate,1000 Hz\n\ntime,force\n[ms],[kN]\n0,0\n50,1500\n100,0\n",
        "# time_s,force_kn\n0,0\n0.05,1500\n0.1,0\n",
        "force [MN],time [s]\n0,0\n1.5,0.05\n0,0.1\n",
        "time [s];force [N]\n0;0\n0.05;1 500 000\n1e-1;0\n",
    ] {
        assert_eq!(course(csv), plain, "{csv}");
        assert_eq!(course(utf16(csv, true, true)), plain, "{csv}");
    }
}

#[test]
fn a_record_on_another_clock_is_shifted_and_says_so() {
    let plain = course("time_s,force_kn\n0,0\n0.25,1500\n0.5,0\n").0;
    for csv in [
        "time_s,force_kn\n-0.5,0\n0,0\n0.25,1500\n0.5,0\n",
        "time_s,force_kn\n5000,0\n5000.5,0\n5000.75,1500\n5001,0\n",
        "time_s,force_kn\n-1,0\n-0.75,1500\n-0.5,0\n",
    ] {
        let (drawn, _, duration_s, doubts) = course(csv);
        assert_eq!((&drawn, duration_s, doubts), (&plain, 0.5, vec!["record-shifted"]), "{csv}");
    }
    let codes = |csv: &str| {
        let train = record(csv).unwrap_or_else(|e| panic!("{csv}\n{e}"));
        trainsafe::doubts::doubts(&train).iter().map(|d| d.code).filter(|c| c.starts_with("record")).collect::<Vec<_>>()
    };
    assert_eq!(codes("time_s,force_kn\n0,500\n0.05,1500\n0.1,0\n"), ["record-starts-at-a-force"]);
    assert!(codes("t,F\ns,kN\n0,0\n0.05,1500\n0.1,0\n").is_empty());
    let train = record("time_s,force_kn\n5000,800\n5000.5,0\n").expect("a force at once");
    let text = "the record p.csv starts at 5000 s: its clock at 5000 s, where it has a force at once, is taken as t = 0 of the event";
    assert_eq!(train.origin().doubts, [Doubt::of_train("record-shifted", text)]);
    // One that starts at 0 is taken as it is.
    assert_eq!(course("time_s,force_kn\n0,0\n3,0\n3.5,800\n4,0\n").2, 4.0);
}

#[test]
fn a_record_s_obstacle_is_named_once() {
    for (csv, what) in [
        ("time_s,force_mn\n0,0\n1,5\n2,0\n", "has the unit \"mn\", which is not MN, for m is milli and M is mega"),
        ("time,force\n0,0\n1,5\n2,0\n", "the column of time has no unit"),
        ("time_s,force_kn\n0,0\n1,x\n2,y\n", "row 3: force does not start with a number: \"x\""),
        ("time_s,force_kn\n0,0\n1,\n2,3\n", "row 3: force is empty"),
        ("a,b\n0,0\n1,1\n", "the record has no columns of time and force with units"),
        ("label,mass [t]\na,80\n", "it is a table of vehicles"),
        (
            "time_s force_kn\n0 0\n1 5\n2 0\n",
            "the record has no columns of time and force with units: it is a table with blanks between its cells, where commas, \
             semicolons or tabs are needed",
        ),
        (
            "time_s,force_1_kn,force_2_kn\n0,0,0\n1,5,6\n",
            "the record has no columns of time and force with units: columns 2 and 3 of row 1 could each be the force; give one \
             that heading",
        ),
        ("time_s,force_kn\n1,0\n1,2\n", "the record holds no stretch of time"),
        ("time_s,force_kn\n0,0\n1,0\n", "the record holds no force other than zero"),
    ] {
        let error = record(csv).expect_err(csv);
        assert_eq!((error.matches("error: ").count(), error.contains(what)), (1, true), "{error}");
    }
    // The case of a prefix counts: m is milli.
    let train = record("time_s,force_mN\n0,0\n1,5\n2,0\n").expect("millinewtons");
    assert!(
        matches!(train.scenarios()[0].event, Event::Pulse(Pulse { force_n: 0.005, .. })),
        "{:?}",
        train.scenarios()[0].event
    );
    let train = record("time_s,force_kn,speed_kmh\n0,0,3\n1,5,3\n2,0,3\n").expect("a third column");
    assert_eq!(codes(&train), ["column-not-read"]);
}

/// Sums may stand above the vehicles, or between groups of them.
#[test]
fn a_row_of_sums_above_or_between_the_vehicles_is_doubted() {
    for (csv, row) in [
        ("label,mass [t],length [m]\nTotal,264,47\nLok,84,19\nWagen,90,14\nWagen,90,14\n", 2),
        ("mass [t]\n396\n120\n132\n144\n", 2),
        ("label,mass [t]\nloco,132\ncar,90\nSubtotal,222\ncar,60\ncar,60\n", 4),
        ("label,mass [t]\nloco,132\ncar,90\nmean,111\n", 4),
    ] {
        let found = table(csv).expect(csv);
        let [only] = &found.origin().doubts[..] else { panic!("{csv} {:?}", found.origin().doubts) };
        assert!(only.code == "total-row" && only.text.contains(&format!("(row {row} of c.csv)")), "{only}");
    }
    // A locomotive that weighs as much as its two cars, and a car as much as the two before it.
    for csv in ["mass [t]\n180\n90\n90\n", "mass [t],length [m]\n132,20\n45,12\n45,12\n90,14\n60,14\n"] {
        assert!(codes(&table(csv).expect(csv)).is_empty(), "{csv}");
    }
}

/// A limit is read under its own name, of draft and buff alike; a name that could be of either sense alone is not.
#[test]
fn columns_of_limits_need_no_prefix() {
    let read = table("label,mass [t],Proof (MN),ultimate load [kN],fatigue_MN\na,80,1.6,1900,0.7\nb,80,,,\nc,80,,,\n");
    let train = read.expect("limits");
    assert!(codes(&train).is_empty(), "{:?}", train.origin().doubts);
    assert_eq!(train.extras().limits[0].in_senses(), [[Some(0.7e6), Some(1.6e6), Some(1.9e6)]; 2]);
    assert_eq!(train.extras().limits[1].in_senses(), [[None; 3]; 2]);
}

/// Which columns a record could mean, and what its times are, where they are no numbers.
#[test]
fn a_record_with_two_channels_or_dates_is_refused_with_the_reason() {
    for (csv, what) in [
        (
            "time_s,channel 1 [kN],channel 2 [kN]\n0,0,0\n1,5,6\n2,0,0\n",
            "columns 2 and 3 of row 1 could each be the force; give one",
        ),
        (
            "logger 7\nt1 [ms];t2 [ms];F [kN]\n0;0;0\n1;1;5\n2;2;0\n",
            "columns 1 and 2 of row 2 could each be the time; give one",
        ),
        (
            "time_s,force_kn\n2026-01-03 12:00:00.000,0\n2026-01-03 12:00:00.050,5\n",
            "row 2: time is a date or a time of day",
        ),
        ("time_s,force_kn\n12:00:00.05,0\n12:00:00.10,5\n", "row 2: time is a date or a time of day"),
        ("time_s,force_kn\n3/1/2026,0\n3/1/2026,5\n", "row 2: time is a date or a time of day"),
    ] {
        let error = record(csv).expect_err(csv);
        assert_eq!((error.matches("error: ").count(), error.contains(what)), (1, true), "{error}");
    }
}

/// Times of a record count from its start, where no force may act yet, and the report does not say that one does.
#[test]
fn times_of_a_record_count_from_its_start() {
    let told = |csv: &str| {
        let train = record(csv).expect(csv);
        let analysis = trainsafe::analyze(&train, &trainsafe::Options::default()).expect("sound");
        trainsafe::report::terminal(&analysis, &[])
    };
    for csv in ["time_s,force_kn\n0,0\n3,0\n3.05,5000\n3.1,0\n", "time_s,force_kn\n0,0\n0.05,5000\n0.1,0\n"] {
        let told = told(csv);
        assert!(told.contains("after the record starts") && !told.contains("sets in"), "{told}");
    }
}

/// Efforts, brakes and resistance of a table: `a = 373.16 kN / 456 t`, and each coupler carries what is behind it.
#[test]
fn a_hauled_train_of_a_table_carries_what_is_behind_each_coupler() {
    let csv = "label,mass [t],tractive_effort [kN],brake_force [kN],rolling_resistance [N/t]\n\
               loco,196,400,,15\ncar a,130,,10,15\ncar b,130,,10,15\n";
    let train = read(&format!("vehicles = \"c.csv\"\n{FRONT}"), &[("c.csv", csv.as_bytes())]).expect("a table");
    let a = 373.16e3 / 456e3;
    for (found, due) in train.initial_force_n().iter().zip([2.0, 1.0].map(|cars| cars * (130e3 * a + 11.95e3))) {
        assert!((found - due).abs() < 1e-9 * due, "{found} {due}");
    }
    assert_eq!(train.initial_force_n().iter().map(|f| (f / 100.0).round() / 10.0).collect::<Vec<_>>(), [236.7, 118.3]);
}

/// A record on a logger's clock overloads what the same record from 0 does.
#[test]
fn a_late_record_has_the_verdict_of_the_early_one() {
    let found = |start: i64| {
        let rows = [(0, 0), (100, -5000), (400, -5000), (500, 0)].map(|(t, f)| format!("{},{f}\n", start + t));
        let train = record(format!("time_ms,force_kn\n{}", rows.concat())).expect("a record");
        let analysis = trainsafe::analyze(&train, &trainsafe::Options::default()).expect("sound");
        let case = &analysis.scenarios[0].cases[0];
        (case.exceeding, case.horizon_s, case.worst.as_ref().expect("couplers").peak_force_n)
    };
    let early = found(0);
    assert_eq!(early.0, 9);
    for start in [5_000_000, -700] {
        let late = found(start);
        // Times after the shift are those of the clock to its last place.
        let near = |a: f64, b: f64| (a - b).abs() < 1e-9 * b.abs();
        assert!(late.0 == 9 && near(late.1, early.1) && near(late.2, early.2), "{start}: {late:?}, early {early:?}");
    }
}
