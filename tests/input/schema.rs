//! The JSON Schemas: they refuse what the reader refuses as far as they can see, and never what it takes.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use jsonschema::Validator;
use proptest::prelude::*;
use serde_json::{Value, json};
use trainsafe::units::{self, Dimension};
use trainsafe::{consist, schema};

fn train_files() -> Validator {
    jsonschema::draft202012::new(&schema::train()).expect("a schema")
}

/// A TOML text as the JSON that editors see in it; `None` if it is not TOML.
fn json_of(text: &str) -> Option<Value> {
    serde_json::to_value(text.parse::<toml::Table>().ok()?).ok()
}

fn refusal(validator: &Validator, text: &str) -> Option<String> {
    let json = json_of(text).expect("TOML");
    let errors: Vec<String> = validator.iter_errors(&json).map(|e| format!("{}: {e}", e.instance_path())).collect();
    (!errors.is_empty()).then(|| errors.join("\n"))
}

fn reader_takes(text: &str) -> bool {
    // Records and tables that these texts name stand beside the bad trains.
    consist::parse(text, Path::new("tests/bad_trains/a.toml")).is_ok()
}

/// The template with the optional keys that its first and its second mark stand for, and those that its comments name.
fn full_templates() -> [String; 2] {
    let all = consist::TEMPLATE.replace("\n#: ", "\n");
    let stand_ins = consist::TEMPLATE.replace("\n#+ ", "\n").replace("\nuniform", "\n#");
    [
        all.replace("\nat = [53]", "\nat = [53]\ndamping = \"1 kN*s/m\"\nlimits = { proof = \"2 MN\" }"),
        stand_ins.replace("\ncount = 104", "\ncount = 104\ngrade = \"1 %\"\nrolling_resistance = \"1 N/t\""),
    ]
}

/// The keys of a schema and of its tables: `scenario.at`.
fn keys_of(schema: &Value, within: &str, into: &mut BTreeSet<String>) {
    for (key, property) in schema["properties"].as_object().expect("properties") {
        let name = format!("{within}{key}");
        for table in [property, &property["items"]].into_iter().filter(|t| t["properties"].is_object()) {
            keys_of(table, &format!("{name}."), into);
        }
        into.insert(name);
    }
}

#[test]
fn both_are_schemas() {
    for schema in [schema::train(), schema::study()] {
        jsonschema::meta::validate(&schema).unwrap_or_else(|e| panic!("{}: {e}", e.instance_path()));
        jsonschema::draft202012::new(&schema).unwrap_or_else(|e| panic!("{e}"));
    }
}

#[test]
fn good_trains_are_taken() {
    let validator = train_files();
    let files = fs::read_dir("trains").expect("the folder of trains").map(|f| f.expect("an entry").path());
    let files = files.filter(|path| path.extension().is_some_and(|e| e == "toml"));
    let mut texts: Vec<String> = files.map(|path| fs::read_to_string(path).expect("a train")).collect();
    assert!(texts.len() >= 10);
    texts.push(consist::TEMPLATE.to_owned());
    texts.extend(full_templates());
    for text in texts {
        assert_eq!(refusal(&validator, &text), None, "{text}");
    }
}

/// Bad trains that no schema can tell from good ones: what is wrong with them lies in other keys, other files, or sizes.
const UNSEEN: &[&str] = &[
    "both-held",
    // JSON Schema has no other type for 2.0.
    "count-fraction",
    "count-huge",
    "coupler-out-of-range",
    "cut-power-of-none",
    "damping-ratio-cascade",
    "damping-twice",
    "duplicate-names",
    "effort-of-held",
    "emergency-of-held",
    "emergency-without-brakes",
    "emergency-without-length",
    "emergency-without-speed",
    "empty-vehicles",
    "gear-columns",
    "gear-friction-over",
    "gear-friction-twice",
    "gear-gives-more",
    "gear-keys-of-spring",
    "gear-pulls-beside-slack",
    "gear-stiffness-in-buff",
    "gear-without-solid",
    "gear-without-unloading",
    "held-group",
    "held-in-the-middle",
    "huge",
    "limits-order",
    "limits-order-in-buff",
    "limits-order-override",
    "limits-thrice",
    "listed-twice",
    "load-empty",
    "load-twice",
    "one-vehicle",
    "override-out-of-range",
    "override-twice",
    "pulled-to-less",
    "pulled-to-of-none",
    "pulse-on-held",
    "record-wrong",
    "slack-between-held-ends",
    "slack-with-damping",
    "slack-with-damping-ratio",
    "subnormal",
    "throttle-wrong",
    "trapezoid-wrong",
    "underflow",
    "vehicle-out-of-range",
];

#[test]
fn bad_trains_are_refused_as_far_as_a_schema_sees() {
    let validator = train_files();
    let (mut unseen, mut refused) = (vec![], 0);
    for file in fs::read_dir("tests/bad_trains").expect("the folder of bad trains") {
        let path = file.expect("an entry").path();
        let Some(text) = fs::read_to_string(&path).ok().filter(|_| path.extension().is_some_and(|e| e == "toml"))
        else {
            continue;
        };
        match json_of(&text) {
            None => {}
            Some(_) if refusal(&validator, &text).is_some() => refused += 1,
            Some(_) => unseen.push(path.file_stem().expect("a name").to_string_lossy().into_owned()),
        }
    }
    unseen.sort();
    assert_eq!(unseen, UNSEEN);
    assert!(refused > 40, "{refused}");
}

/// Where a TOML value stands: keys and places in lists.
type Place = Vec<Step>;

#[derive(Clone, Debug)]
enum Step {
    Key(String),
    Item(usize),
}

fn leaves(value: &toml::Value, at: &Place, into: &mut Vec<Place>) {
    let below = |step: Step| at.iter().cloned().chain([step]).collect::<Place>();
    match value {
        toml::Value::Table(table) => table.iter().for_each(|(key, v)| leaves(v, &below(Step::Key(key.clone())), into)),
        toml::Value::Array(list) => list.iter().enumerate().for_each(|(i, v)| leaves(v, &below(Step::Item(i)), into)),
        _ => {}
    }
    if matches!(at.last(), Some(Step::Key(_))) {
        into.push(at.clone());
    }
}

/// The table with another value at a place, or with none there.
fn changed(table: &toml::Table, at: &[Step], value: Option<&toml::Value>) -> toml::Table {
    let mut whole = toml::Value::Table(table.clone());
    let (last, way) = at.split_last().expect("a place");
    let mut parent = &mut whole;
    for step in way {
        parent = match step {
            Step::Key(key) => &mut parent[key.as_str()],
            Step::Item(i) => &mut parent[*i],
        };
    }
    let Step::Key(key) = last else { panic!("a key") };
    let parent = parent.as_table_mut().expect("a table");
    match value {
        Some(value) => parent.insert(key.clone(), value.clone()),
        None => parent.remove(key),
    };
    let toml::Value::Table(table) = whole else { panic!("a table") };
    table
}

fn shown(at: &Place) -> String {
    let step = |step: &Step| match step {
        Step::Key(key) => format!(".{key}"),
        Step::Item(i) => format!("[{i}]"),
    };
    at.iter().map(step).collect::<String>().split_off(1)
}

/// What is wrong with these lies in what another key says (any text at `at` may be a label, and is left out here), and `vehicle = []` in TOML's way to write none.
const ONLY_BY_READER: &[&str] = &[
    "coupler.limits.proof \".5 kN\"",
    "coupler.limits.proof \"1 kN\"",
    "coupler.limits.proof \"5. kN\"",
    "coupler.limits.ultimate \".5 kN\"",
    "coupler.limits.ultimate \"1 kN\"",
    "coupler.limits.ultimate \"5. kN\"",
    // Needed where some coupler has none of its own.
    "coupler.stiffness left out",
    "coupler_override[0].limits.proof \".5 kN\"",
    "coupler_override[0].limits.proof \"1 kN\"",
    "coupler_override[0].limits.proof \"5. kN\"",
    "load {}",
    // Couplers in buff do not part, which depends on the scenarios.
    "load.uniform \"-1 kN\"",
    "load.uniform \"-50%\"",
    "load.uniform left out",
    // The break that is asked for would be of a coupler in buff.
    "load.uniform \"-1 kN\"",
    "load.uniform \"-50%\"",
    "scenario[1].at 1",
    "scenario[1].cascade left out",
    "scenario[1].fall \"1 s\"",
    "scenario[1].rise \"1 s\"",
    "scenario[1].rise left out",
    "scenario[1].shape left out",
    "scenario[2].at 1",
    "vehicle []",
    "vehicle[1].count 1",
    "vehicle[1].count left out",
    // Beside damping, which is of linear couplers.
    "coupler.slack \"1 m\"",
    // Less than the load.
    "load.pulled_to \".5 kN\"",
    "load.pulled_to \"1 kN\"",
    "load.pulled_to \"1e-3 %\"",
    "load.pulled_to \"5. kN\"",
    "load.pulled_to \"50 %\"",
];

/// What came of every value of every kind at each key of a file.
#[derive(Default)]
struct Tried {
    taken: usize,
    refused: usize,
    only_by_reader: BTreeSet<String>,
    keys: BTreeSet<String>,
}

impl Tried {
    /// Gives each key of a file values of every kind, and leaves it out: the schema refuses no file that the reader takes.
    fn file(&mut self, validator: &Validator, text: &str) {
        let odd = "a = [1, 1.5, 0, -3, true, 'zzz', '', ' ', [], [2], [1, 'x'], {}, {zzz = 1}, 1979-05-27, 'each', 'head', 'break',
            '1', '1 zzz', '1 t', '1 kN', '-1 kN', '0 kN', '-0 kN', '1 MN/m', '1 s', '1 m', '1 mph', '1 kN*s/m', '1 N/t', '50 %',
            '-50%', '1e-3 %', '.5 kN', '5. kN']";
        let odd = odd.parse::<toml::Table>().expect("TOML")["a"].as_array().expect("a list").clone();
        let table: toml::Table = text.parse().expect("TOML");
        assert!(reader_takes(text), "{text}");
        let mut places = vec![];
        leaves(&toml::Value::Table(table.clone()), &vec![], &mut places);
        for at in places {
            let keys = at.iter().filter_map(|step| if let Step::Key(key) = step { Some(key.as_str()) } else { None });
            self.keys.insert(keys.collect::<Vec<_>>().join("."));
            for value in odd.iter().map(Some).chain([None]) {
                let text = toml::to_string(&changed(&table, &at, value)).expect("TOML");
                match (reader_takes(&text), refusal(validator, &text)) {
                    (true, None) => self.taken += 1,
                    (false, Some(_)) => self.refused += 1,
                    (false, None) => {
                        let value = value.map_or("left out".to_owned(), toml::Value::to_string);
                        self.only_by_reader.insert(format!("{} {value}", shown(&at)));
                    }
                    (true, Some(why)) => panic!("{why}\n{text}"),
                }
            }
        }
    }
}

/// Files with gears, slack, brakes and drives, which the template names in its comments alone.
const GEARS_AND_BRAKES: [&str; 3] = [
    "speed = '50 km/h'\n[coupler]\ngear = [['0 mm', '0 kN'], ['90 mm', '900 kN']]\nsolid_stiffness = '200 MN/m'\nfriction = '50 %'\n\
     slack = '10 mm'\nrated_load = '1.5 MN'\n[[vehicle]]\nmass = '90 t'\nlength = '12 m'\ntractive_effort = '200 kN'\n[[vehicle]]\ncount = 9\n\
     mass = '90 t'\nlength = '12 m'\nemergency_brake = '40 kN'\n[[coupler_override]]\nat = 2\nslack = '20 mm'\nsolid_stiffness = '150 MN/m'\n\
     friction = '60 %'\n[[coupler_override]]\nat = 3\ngear = [['0 mm', '0 kN'], ['90 mm', '800 kN']]\n\
     gear_in_buff = [['0 mm', '0 kN'], ['80 mm', '800 kN']]\n[[scenario]]\nkind = 'break'\ncoupler = 4\n\
     emergency = { wave = '290 m/s', build_up = [['0 s', '0 %'], ['8 s', '100 %']] }\ncut_power = { after = '1 s', over = '1 s' }\n",
    "speed = '50 km/h'\n[coupler]\ngear = [['0 mm', '0 kN', '0 kN'], ['90 mm', '900 kN', '90 kN']]\nsolid_stiffness = '200 MN/m'\n\
     gear_in_buff = [['0 mm', '0 kN', '0 kN'], ['80 mm', '800 kN', '80 kN']]\nrated_load = '1.5 MN'\n[[vehicle]]\ncount = 9\nmass = '90 t'\n\
     length = '12 m'\nemergency_brake = '40 kN'\n[load]\nuniform = '0.2 MN'\npulled_to = '0.4 MN'\n[[scenario]]\nkind = 'brake'\n\
     at = 'head'\nservice = 'AAR'\n",
    "[coupler]\nstiffness = '30 MN/m'\nstiffness_in_buff = '40 MN/m'\nslack = '10 mm'\nrated_load = '1.5 MN'\n[[vehicle]]\ncount = 9\n\
     mass = '90 t'\n[[coupler_override]]\nat = 2\nstiffness_in_buff = '50 MN/m'\nslack = '0 mm'\n",
];

/// Every key of some full files gets values of every kind, and is left out: the schema refuses no file that the reader takes,
/// and all that are wrong in the one value alone.
#[test]
fn schema_and_reader_agree_on_every_key() {
    let validator = train_files();
    let mut unseen = BTreeSet::new();
    keys_of(&schema::train(), "", &mut unseen);
    let (mut tried, mut of_gears) = (Tried::default(), Tried::default());
    full_templates().iter().for_each(|text| tried.file(&validator, text));
    // How values of these keys go together is a long list; none that the reader takes is refused.
    GEARS_AND_BRAKES.iter().for_each(|text| of_gears.file(&validator, text));
    assert!(of_gears.taken > 50 && of_gears.refused > 1500, "{} {}", of_gears.taken, of_gears.refused);
    unseen.retain(|key| !tried.keys.contains(key) && !of_gears.keys.contains(key));
    let Tried { taken, refused, mut only_by_reader, .. } = tried;
    assert!(taken > 200 && refused > 1500, "{taken} {refused}");
    // Limits of one sense have the keys of limits of both.
    unseen.retain(|key| !key.contains(".limits.draft") && !key.contains(".limits.buff"));
    let elsewhere = [
        "coupler_override.limits.fatigue",
        "coupler_override.limits.ultimate",
        "scenario.record",
        "scenario.throttle",
        "vehicles",
    ];
    assert_eq!(unseen, elsewhere.map(str::to_owned).into(), "keys that no file here has");
    only_by_reader.retain(|one| !one.contains(".at \""));
    let expected = ONLY_BY_READER.iter().map(|s| (*s).to_owned()).collect();
    assert_eq!(only_by_reader, expected);
}

/// The keys that a message lists are those of the schema.
#[test]
fn the_readers_own_lists_of_keys_are_the_schemas() {
    let schema = schema::train();
    let head = "[coupler]\nstiffness = \"1 N/m\"\nrated_load = \"1 N\"\n";
    let tables = [
        ("", "zzz = 1\n", "/properties"),
        ("coupler", "", "/properties/coupler/properties"),
        ("vehicle", "[[vehicle]]", "/properties/vehicle/items/properties"),
        ("coupler_override", "[[coupler_override]]", "/properties/coupler_override/items/properties"),
        ("load", "[load]", "/properties/load/properties"),
        ("limits", "[coupler.limits]", "/properties/coupler/properties/limits/properties"),
        ("scenario", "[[scenario]]", "/properties/scenario/items/properties"),
    ];
    for (name, header, pointer) in tables {
        let text = if name.is_empty() { format!("{header}{head}") } else { format!("{head}{header}\nzzz = 1\n") };
        let text = format!("{text}[[vehicle]]\ncount = 2\nmass = \"1 t\"\n");
        let message = consist::parse(&text, Path::new("a.toml")).expect_err("a key that is not known").to_string();
        let list =
            message.lines().find_map(|l| l.split_once("help: the keys of ")?.1.split_once(" are ")).expect("a list").1;
        let properties = schema.pointer(pointer).and_then(Value::as_object).expect("properties");
        assert_eq!(list.split(", ").collect::<Vec<_>>(), properties.keys().collect::<Vec<_>>(), "{name}");
        for (key, property) in properties {
            for entry in ["title", "description", "examples"] {
                assert!(property.get(entry).is_some_and(|e| e.as_str() != Some("")), "{name} {key} has no {entry}");
            }
            let validator = jsonschema::draft202012::new(property).expect("a schema");
            for value in [&property["examples"][0]].into_iter().chain(property.get("default")) {
                assert!(validator.is_valid(value), "{name} {key}: {value}");
            }
        }
    }
}

proptest! {
    /// A string has the pattern of a quantity exactly if it is one that can be computed with.
    #[test]
    fn patterns_are_the_readers_grammar(
        space in " {0,2}", number in "[+-]?[0-9.]{0,5}([eE][+-]?[0-9]{0,2})?", unit in "(k|M)?[a-zN%]{0,2}(/m)?",
        known in any::<proptest::sample::Index>(), odd in 0..4
    ) {
        let mass = &schema::train()["properties"]["vehicle"]["items"]["properties"]["mass"];
        let load = &schema::train()["properties"]["load"]["properties"]["uniform"];
        for (property, dimension, share) in [(mass, Dimension::Mass, false), (load, Dimension::Force, true)] {
            let units: Vec<&str> = dimension.units().chain(["%"]).collect();
            let unit = if odd == 0 { unit.as_str() } else { units[known.index(units.len())] };
            let text = format!("{space}{number}{space}{unit}{space}");
            let read = units::parse(&text, dimension, share);
            let beyond = read.as_ref().is_err_and(|bad| bad.found.ends_with(" to compute with"));
            let positive = |amount: &units::Amount| {
                let (units::Amount::Si(x) | units::Amount::Share(x)) = *amount;
                share || x > 0.0
            };
            let right = beyond && (share || !number.starts_with('-')) || read.as_ref().is_ok_and(positive);
            let validator = jsonschema::draft202012::new(property).expect("a schema");
            prop_assert_eq!(validator.is_valid(&json!(text)), right, "{} {:?}", text, read);
        }
    }
}

/// A study is taken or refused before it is run.
#[test]
fn no_study_that_the_reader_takes_is_refused() {
    let validator = jsonschema::draft202012::new(&schema::study()).expect("a schema");
    let readme = fs::read_to_string("README.md").expect("the README");
    let blocks = readme.split("```toml\n").skip(1).filter_map(|rest| rest.split("```").next());
    let study = blocks.into_iter().find(|block| block.contains("[[vary]]")).expect("a study in the README");
    let list = "trains = \"ore-train.toml\"\n[[vary]]\nkey = \"vehicle[1].mass\"\nvalues = [\"90 t\", \"100 t\"]\n";
    let folder = tempfile::tempdir().expect("a folder");
    fs::copy("trains/ore-train.toml", folder.path().join("ore-train.toml")).expect("a train");
    let takes = |text: &str| {
        fs::write(folder.path().join("study.toml"), text).expect("written");
        let run = crate::fleets::fleet(folder.path(), &["study.toml", "--dry-run"]);
        assert!(matches!(run.status.code(), Some(0 | 2)), "{}", crate::fleets::complaint(&run));
        run.status.success()
    };
    let odd = "a = [1, 1.5, true, 'zzz', [], {}, '1 t', '-1 MN', '50 %', 'normal', 'coupler', 'load.uniform', 'load[0].uniform']";
    let odd = odd.parse::<toml::Table>().expect("TOML")["a"].as_array().expect("a list").clone();
    let mut refused = 0;
    for text in [study, list] {
        assert!(takes(text) && refusal(&validator, text).is_none(), "{text}");
        let table: toml::Table = text.parse().expect("TOML");
        let mut places = vec![];
        leaves(&toml::Value::Table(table.clone()), &vec![], &mut places);
        for at in places {
            for value in odd.iter().map(Some).chain([None]) {
                let text = toml::to_string(&changed(&table, &at, value)).expect("TOML");
                if let Some(why) = refusal(&validator, &text) {
                    refused += 1;
                    assert!(!takes(&text), "{why}\n{text}");
                }
            }
        }
    }
    assert!(refused > 100, "{refused}");
}

#[test]
fn the_program_prints_them() {
    for (args, schema) in [(&["schema"][..], schema::train()), (&["schema", "--study"], schema::study())] {
        let run = crate::fleets::trainsafe(Path::new(".")).args(args).output().expect("it runs");
        assert!(run.status.success() && run.stderr.is_empty());
        assert_eq!(serde_json::from_slice::<Value>(&run.stdout).expect("JSON and nothing else"), schema);
    }
}
