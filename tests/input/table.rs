//! Trains as tables: the same train as spelt out, and mistakes with row and column.

use std::fs;
use std::path::Path;

use trainsafe::Train;
use trainsafe::consist;
use trainsafe::law::Law;
use trainsafe::train::{Origin, TrainSpec};

const FRONT: &str =
    "name = \"tabled\"\n[coupler]\nstiffness = \"30 MN/m\"\nrated_load = \"1 MN\"\n[load]\nuniform = \"60 %\"\n";

/// The train whose vehicles are this table.
fn read(table: &str, rest: &str) -> Result<Train, String> {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("consist.csv"), table).expect("a table");
    let text = format!("vehicles = \"consist.csv\"\n{FRONT}{rest}");
    let shown = folder.path().display().to_string();
    let train = consist::parse(&text, &folder.path().join("train.toml"));
    // Where it comes from is not compared.
    train.map(of_itself).map_err(|e| e.to_string().replace(&shown, "HERE"))
}

fn of_itself(train: Train) -> Train {
    TrainSpec { origin: Origin::default(), ..train.into_spec() }.build().expect("it was one")
}

fn spelt_out(vehicles: &str) -> Train {
    let train = consist::parse(&format!("{FRONT}{vehicles}"), Path::new("train.toml"));
    of_itself(train.unwrap_or_else(|e| panic!("{e}")))
}

#[test]
fn a_table_is_the_train_spelt_out() {
    let table = "\u{feff}Wagon no;label;mass [t];length [ft];held;count;stiffness [kN/mm];rated_load [kip];rated_buff [MN]\r\n\
                 1;locomotive;195;72;yes;;;;\r\n2;\"ore; car\";160;35;;3;;337;1.2\r\n;;;;;;;;\r\n3;caboose;2.5;10;no;1;25;;\r\n";
    let overrides = "[[coupler_override]]\nat = 2\nrated_load = \"0.9 MN\"\n";
    let expected = spelt_out(&format!(
        "[[vehicle]]\nlabel = \"locomotive\"\nmass = \"195 t\"\nlength = \"72 ft\"\nheld = true\n[[vehicle]]\nlabel = \"ore; \
         car\"\nmass = \"160 t\"\nlength = \"35 ft\"\ncount = 3\n[[vehicle]]\nlabel = \"caboose\"\nmass = \"2.5 \
         t\"\nlength = \"10 ft\"\n{}[[coupler_override]]\nat = [3, 4]\nrated_load = \"337 kip\"\nrated_buff = \"1.2 \
         MN\"\n[[coupler_override]]\nat = 2\nrated_buff = \"1.2 MN\"\n",
        overrides
    ));
    assert_eq!(read(table, overrides), Ok(expected));
}

#[test]
fn units_may_stand_in_the_cells_and_without_a_label_a_vehicle_has_its_number() {
    let expected = spelt_out("[[vehicle]]\nmass = \"80 t\"\n[[vehicle]]\nmass = \"90 klb\"\n");
    assert_eq!(read("mass\n80 t\n90 klb\n", ""), Ok(expected));
}

#[test]
fn each_mistake_in_a_table_has_its_row_and_column() {
    let cases = [
        (
            "label,mass [t]\na,80\n\"b, c\",  8O \nd,-3\n",
            "error: row 3, column mass [t]: \"8O\" has \"O\" after the number, and its column is in t
 --> HERE/consist.csv:3:10
  |
3 | \"b, c\",  8O 
  |          ^^
  |
  = help: write the number alone, in t, or take the unit out of the heading

error: row 4, column mass [t]: mass is negative
 --> HERE/consist.csv:4:3
  |
4 | d,-3
  |   ^^
  |
  = help: expected a value above zero",
        ),
        (
            "label,mas [t]\na,80\nb,80\n",
            "error: unknown column \"mas [t]\"
 --> HERE/consist.csv:1:7
  |
1 | label,mas [t]
  |       ^^^^^^^
  |
  = help: did you mean \"mass\"? columns are label, count, mass, held, length, tractive_effort, \
             rolling_resistance, grade, brake_force, emergency_brake, stiffness, rated_load, rated_buff, limits.fatigue, limits.proof, limits.ultimate, limits.draft.fatigue, limits.draft.proof, limits.draft.ultimate, limits.buff.fatigue, limits.buff.proof, limits.buff.ultimate, damping, stiffness_in_buff, slack, gear, gear_in_buff, friction or solid_stiffness",
        ),
        (
            "mass [MN]\n80\n80\n",
            "error: the column \"mass [MN]\" has \"MN\", a unit of force
 --> HERE/consist.csv:1:1
  |
1 | mass [MN]
  | ^^^^^^^^^
  |
  = help: a mass is in kg, t, lb, klb or ton_us",
        ),
        (
            "mass [t],held\n80,\n80,maybe\n80,yes\n,\n80\n",
            "error: row 3, column held: held is \"maybe\"
 --> HERE/consist.csv:3:4
  |
3 | 80,maybe
  |    ^^^^^
  |
  = help: expected yes or no, or nothing for no

error: row 4, column held: a vehicle in the middle of the train is held
 --> HERE/consist.csv:4:4
  |
4 | 80,yes
  |    ^^^
  |
  = help: only the first and the last vehicle of the train can be held",
        ),
        (
            "label,mass [t]\na,80\nb\n",
            "error: row 3, column mass [t]: there is no mass
 --> HERE/consist.csv:3:2
  |
3 | b
  |  ^
  |
  = help: fill it in, or delete the row if it is no vehicle",
        ),
        (
            "mass [t]\n80\n",
            "error: the train has one vehicle, so no coupler
--> HERE/consist.csv
 = help: give it a row or a [[vehicle]] for each vehicle or group alike, from the head: at least two vehicles",
        ),
    ];
    for (table, expected) in cases {
        assert_eq!(read(table, "").expect_err(table), expected);
    }
}

/// A table with the columns of every coupler does not spare `[coupler]`, and the message says which goes before which.
#[test]
fn a_table_has_a_coupler_table_beside_it() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("consist.csv"), "mass [t],stiffness [MN/m],rated_load [MN]\n80,30,1\n80,30,1\n")
        .expect("a table");
    let said = |text: &str| consist::parse(text, &folder.path().join("train.toml")).expect_err(text).to_string();
    let own = "; what a coupler's row of the table has goes before it";
    let none = said("vehicles = \"consist.csv\"\n");
    assert!(none.contains(&format!("add a [coupler] table with stiffness and rated_load{own}")), "{none}");
    let half = said("vehicles = \"consist.csv\"\n[coupler]\nstiffness = \"30 MN/m\"\n");
    assert!(half.contains(&format!("the capacity in draft{own}")), "{half}");
}

/// Where every coupler has a stiffness or a gear of its own, `[coupler]` needs neither; else the message names one that has none.
#[test]
fn stiffness_is_asked_for_where_a_coupler_has_none_of_its_own() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("gear.csv"), "travel [mm],loading [kN]\n0,0\n90,900\n").expect("a gear");
    let read = |rows: &str, rest: &str| {
        let table = format!("mass [t],gear,stiffness [MN/m],slack [mm]\n{rows}");
        fs::write(folder.path().join("consist.csv"), table).expect("a table");
        let text = format!("vehicles = \"consist.csv\"\n[coupler]\nrated_load = \"1 MN\"\n{rest}");
        consist::parse(&text, &folder.path().join("train.toml")).map_err(|e| e.to_string())
    };
    let of_gears = "solid_stiffness = \"200 MN/m\"\nfriction = \"50 %\"\n";
    let train = read("80,gear.csv,,\n80,,30,\n80,,,\n", of_gears).expect("each coupler has its own");
    let couplers = train.into_spec().couplers;
    assert!(matches!(couplers[0].law, Law::Gear { solid_n_per_m: 200e6, .. }));
    assert_eq!(couplers[1].law, Law::linear(30e6));
    let overridden = format!("{of_gears}[[coupler_override]]\nat = [1, 2]\ngear = \"gear.csv\"\n");
    read("80,,,\n80,,,\n80,,,\n", &overridden).expect("overrides have gears");
    let second = read("80,gear.csv,,\n80,,,10\n80,,,\n", of_gears).expect_err("coupler 2 has none");
    assert!(
        second.contains("error: [coupler] has no stiffness")
            && second.contains("or give coupler 2 a stiffness or a gear"),
        "{second}"
    );
    let none = read("80,,,\n80,,,\n", of_gears).expect_err("no coupler has one");
    assert!(none.contains("between two vehicles; what a coupler's row of the table has goes before it"), "{none}");
}

#[test]
fn a_train_has_its_vehicles_once() {
    let error = read("mass [t]\n80\n80\n", "[[vehicle]]\nmass = \"80 t\"\n").expect_err("two lists of vehicles");
    assert!(error.starts_with("error: the train has its vehicles twice"), "{error}");
}

#[test]
fn hostile_tables_are_errors() {
    for table in [
        "",
        "\n\n",
        "\"",
        "mass [t]\n\"80\n80",
        "mass [t],mass [t]\n1,1\n",
        "mass [t],count\n1,99999999\n",
        "[\n]",
        "mass [\n1",
    ] {
        assert!(read(table, "").is_err(), "{table:?}");
    }
}

/// What the file to start from says of a table is so: its line taken, and the vehicles from a table with all those columns.
#[test]
fn the_template_s_table_can_be_used() {
    let columns = "label,count,held,mass [t],length [m],stiffness [MN/m],rated_load [MN],rated_buff [MN]";
    let line = "# vehicles = \"vehicles.csv\"";
    assert!(consist::TEMPLATE.contains(line));
    assert!(columns.split(',').all(|column| consist::TEMPLATE.contains(column)));
    let folder = tempfile::tempdir().expect("a folder");
    let table = format!("{columns}\nlocomotive,1,true,195,22,30,1.5,2\ncar,104,,160,,,,\n");
    fs::write(folder.path().join("vehicles.csv"), table).expect("a table");
    let (front, rest) = consist::TEMPLATE.split_once("\n[[vehicle]]").expect("a vehicle");
    let (_, load) = rest.split_once("\n[load]").expect("a load");
    let text = format!("{}\n[load]{load}", front.replace(line, line.trim_start_matches("# ")));
    let train = consist::parse(&text, &folder.path().join("train.toml")).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!((train.vehicles().len(), train.vehicles()[0].held, train.couplers()[0].rated_buff_n), (105, true, 2e6));
}

/// A row of sums whose word stands among the numbers of the rows does not hide that these are out of order.
#[test]
fn numbers_of_rows_are_read_above_a_row_of_sums() {
    let table = "Pos;Label;Mass (t)\n1;a;80\n3;b;70\n2;c;60\nSum;;210\n";
    let refused = read(table, "").expect_err("out of order");
    assert!(refused.starts_with("error: row 4, column Pos: 2 comes after 3"), "{refused}");
    let in_order = table.replace("3;b", "2;b").replace("2;c", "3;c");
    assert_eq!(codes(&in_order), ["total-row"]);
    assert_eq!(codes(&in_order.replace("2;b", "x;b")), ["column-not-read", "total-row"]);
}

/// Headings in another language: the message says where the masses may be, and shows nothing of the file.
#[test]
fn a_table_without_known_headings_is_told_where_its_masses_may_be() {
    let refused =
        read("Zug 1;;\nBezeichnung;Masse (t);Länge (m)\nLok;84,0;19\nWagen;80,0;14\n", "").expect_err("no heading");
    assert!(
        refused.contains("column 2 of row 2 is in a unit of mass; if it holds the masses, head it mass [t]"),
        "{refused}"
    );
    assert!(!refused.contains("Masse") && !refused.contains("Lok"), "{refused}");
    let refused = read("secret;other\n1;2\n", "").expect_err("no heading");
    assert!(refused.contains("a row above the vehicles names the columns: mass [t], and others"), "{refused}");
}

/// A label that counts vehicles stands for one, unless count says the same.
#[test]
fn a_count_in_a_label_is_a_doubt() {
    assert_eq!(codes("label,mass [t]\nloco,84\n3 x car,80\n"), ["count-in-label"]);
    assert_eq!(codes("label,mass [t],count\nloco,84,1\n3 x car,80,3\n"), [""; 0]);
    assert_eq!(codes("label,mass [t]\nloco,84\n1 x car,80\n3x4 wagon,80\n2 xenon tanks,80\n"), [""; 0]);
}

/// Codes of the doubts about the train of a table, without those about its load.
fn codes(table: &str) -> Vec<&'static str> {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("consist.csv"), table).expect("a table");
    let text = format!("vehicles = \"consist.csv\"\n{FRONT}");
    let train = consist::parse(&text, &folder.path().join("train.toml")).unwrap_or_else(|e| panic!("{e}"));
    let doubts = trainsafe::doubts::doubts(&train);
    doubts.into_iter().filter(|d| d.scenario.is_none()).map(|d| d.code).collect()
}
