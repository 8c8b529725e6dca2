//! Train files that are right: what they become, and what is said of them.

use std::fs;
use std::path::Path;

use proptest::prelude::*;
use trainsafe::consist::{self, TEMPLATE, describe};
use trainsafe::doubts::doubts;
use trainsafe::train::{Event, Pulse, Train};

/// What is doubtful about a train, as it is told.
fn warnings(train: &Train) -> Vec<String> {
    doubts(train).iter().map(ToString::to_string).collect()
}

fn parse(text: &str) -> Train {
    consist::parse(text, Path::new("a.toml")).unwrap_or_else(|e| panic!("{e}"))
}

/// Ten vehicles with a coupler of these keys, and more tables after them.
fn ten(coupler: &str, more: &str) -> Train {
    parse(&format!("[coupler]\n{coupler}\n[[vehicle]]\ncount = 10\nmass = \"160 t\"\n{more}"))
}

const COUPLER: &str = "stiffness = \"30 MN/m\"\nrated_load = \"1.5 MN\"";

const ORE_TRAIN: &str = r#"
name = "Ore train"

[coupler]
stiffness  = "30 MN/m"
rated_load = "1.5 MN"
rated_buff = "2.0 MN"

[[vehicle]]
label = "locomotive"
mass  = "195 t"
held  = true

[[vehicle]]
label = "ore car"
count = 104
mass  = "160 t"
length = "10.9 m"

[[coupler_override]]
at = [53]
rated_load = "0.9 MN"

[load]
uniform = "0.6 MN"

[[scenario]]
name    = "knuckle breaks"
kind    = "break"
coupler = 53
horizon = "8 s"

[[scenario]]
name     = "the rear is hit"
kind     = "pulse"
at       = "tail"
force    = "-1.2 MN"
duration = "60 ms"
shape    = "rectangle"
"#;

#[test]
fn an_ore_train() {
    let train = parse(ORE_TRAIN);
    assert_eq!(train.name(), "Ore train");
    assert_eq!((train.vehicles().len(), train.couplers().len(), train.initial_force_n().len()), (105, 104, 104));
    assert_eq!(
        (train.vehicles()[0].label.as_str(), train.vehicles()[104].label.as_str()),
        ("locomotive", "ore car 104")
    );
    assert_eq!((train.vehicles()[0].mass_kg, train.vehicles()[1].mass_kg), (195e3, 160e3));
    assert_eq!((train.vehicles()[0].held, train.vehicles()[1].held), (true, false));
    assert_eq!((train.vehicles()[0].length_m, train.vehicles()[1].length_m), (None, Some(10.9)));
    let drafts: Vec<f64> = train.couplers().iter().map(|c| c.rated_draft_n).collect();
    assert!(drafts.iter().enumerate().all(|(i, &n)| n == if i == 52 { 0.9e6 } else { 1.5e6 }));
    assert!(train.couplers().iter().all(|c| c.rated_buff_n == 2e6 && c.stiffness_n_per_m == 30e6));
    assert!(train.initial_force_n().iter().all(|&n| n == 0.6e6));
    assert_eq!(train.scenarios()[0].event, Event::Break { couplers: vec![52] });
    assert_eq!((train.scenarios()[0].horizon_s, train.scenarios()[1].horizon_s), (Some(8.0), None));
    assert_eq!(train.scenarios()[1].event, Event::Pulse(Pulse::rectangle(104, -1.2e6, 0.06)));
}

#[test]
fn an_ore_train_in_words() {
    let expected = "Ore train
105 vehicles, 104 couplers, 16640 t, not counting held vehicles, 1133.6 m long without held vehicles
  1 x locomotive (held) of 195 t
  104 x ore car of 160 t, 10.9 m
couplers: stiffness 30 MN/m; rated 900 kN to 1.5 MN in draft, 2 MN in buff
load before the event: 600 kN in draft
to be run:
  knuckle breaks: coupler 53 between ore car 52 and ore car 53 breaks; 1 case, horizon 8 s
  the rear is hit: 1.2 MN backward on ore car 104 for 60 ms; 1 case, horizon 30.44 s
";
    assert_eq!(describe(&parse(ORE_TRAIN)), expected);
}

#[test]
fn the_template_parses_with_and_without_its_optional_keys() {
    let plain = parse(TEMPLATE);
    assert_eq!((plain.vehicles().len(), plain.scenarios().len()), (105, 1));
    assert_eq!(warnings(&plain), Vec::<String>::new());
    let all = TEMPLATE.replace("\n#: ", "\n");
    let full = parse(&all);
    assert_eq!((full.vehicles()[0].held, full.vehicles()[104].length_m), (true, Some(10.9)));
    assert_eq!((full.vehicles().len(), full.scenarios().len()), (105, 3));
    assert_eq!((full.couplers()[52].rated_draft_n, full.couplers()[52].rated_buff_n), (0.9e6, 1.5e6));
    let hauled = TEMPLATE.replace("\n#+ ", "\n").replace("\nuniform", "\n#");
    let hauled = parse(&hauled);
    assert!(hauled.extras().steady.as_ref().is_some_and(|s| s.outside_n[0] > 0.0 && s.outside_n[104] < 0.0));
    let all = all.replace("\n#+ ", "\n");
    let keys = "damping_ratio damping rise fall cascade buff_breaks vehicles speed limits tractive_effort brake_force rolling_resistance grade name stiffness rated_load rated_buff label count mass held length at uniform kind coupler horizon force \
                duration shape";
    for key in keys.split(' ') {
        assert!(all.lines().any(|line| line.split(['=', ' ']).next() == Some(key)), "{key} is not in the template");
    }
}

#[test]
fn every_train_in_the_folder_parses_without_a_warning() {
    let files: Vec<_> = fs::read_dir("trains").expect("the folder of trains").collect();
    assert!(files.len() >= 7);
    for file in files {
        let path = file.expect("an entry").path();
        if path.extension().is_none_or(|e| e != "toml") {
            continue;
        }
        let train = consist::read(&path).unwrap_or_else(|e| panic!("{e}"));
        // The one of the hauled train is explained in its file.
        let told = warnings(&train).into_iter().filter(|w| !w.contains("at the instant of contact"));
        assert_eq!(told.collect::<Vec<_>>(), Vec::<String>::new(), "{}", path.display());
    }
}

#[test]
fn the_papers_trains_are_the_papers() {
    let four = consist::read(Path::new("trains/paper-figure-4.toml")).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(four.couplers().len(), 51);
    assert_eq!(four.scenarios()[0].event, Event::Break { couplers: vec![50] });
    let five = consist::read(Path::new("trains/paper-figure-5.toml")).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(five.couplers().len(), 100);
    assert_eq!(five.scenarios()[0].event, Event::Pulse(Pulse::rectangle(100, -1.0, 10.0)));
    for train in [four, five] {
        assert!(train.vehicles().iter().all(|v| v.mass_kg == 1.0));
        assert!(train.couplers().iter().all(|c| c.stiffness_n_per_m == 1.0 && c.rated_draft_n == 1.0));
    }
}

#[test]
fn labels_are_numbered_through_the_train() {
    let group = |label: &str, count: usize| format!("[[vehicle]]\n{label}\ncount = {count}\nmass = \"1 t\"\n");
    let groups = [group("label = \"car\"", 2), group("label = \"van\"", 1), group("", 1), group("label = \"car\"", 1)];
    let train = parse(&format!("[coupler]\n{COUPLER}\n{}", groups.concat()));
    let labels: Vec<&str> = train.vehicles().iter().map(|v| v.label.as_str()).collect();
    assert_eq!(labels, ["car 1", "car 2", "van", "vehicle 4", "car 3"]);
}

#[test]
fn shares_are_of_what_they_say() {
    let coupler = format!("{COUPLER}\nrated_buff = \"120 %\"");
    let more =
        "[[coupler_override]]\nat = 3\nrated_load = \"60%\"\n[[coupler_override]]\nat = 3\nstiffness = \"10 MN/m\"
                [[coupler_override]]\nat = 4\nrated_buff = \"50 %\"\n[load]\nuniform = \"-40 %\"
                [[scenario]]\nkind = \"pulse\"\nat = 2\nforce = \"-80 %\"\nduration = \"1 s\"";
    let train = ten(&coupler, more);
    let ratings = |i: usize| (train.couplers()[i].rated_draft_n, train.couplers()[i].rated_buff_n);
    assert_eq!(ratings(0), (1.5e6, 1.8e6));
    assert_eq!(ratings(2), (0.9e6, 1.08e6), "the buff rating is a share of the coupler's own draft rating");
    assert_eq!(ratings(3), (1.5e6, 0.75e6));
    assert_eq!(train.couplers()[2].stiffness_n_per_m, 10e6);
    assert_eq!(train.initial_force_n()[8], -0.36e6, "of the weakest coupler's rating in draft");
    assert_eq!(train.scenarios()[0].event, Event::Pulse(Pulse::rectangle(1, -0.72e6, 1.0)));
}

#[test]
fn without_a_rating_in_buff_it_is_the_one_in_draft() {
    let train = ten(COUPLER, "[[coupler_override]]\nat = 3\nrated_load = \"1 MN\"");
    assert_eq!((train.couplers()[0].rated_buff_n, train.couplers()[2].rated_buff_n), (1.5e6, 1e6));
}

#[test]
fn scenarios_without_a_name_get_one_of_their_own() {
    let pulse = "[[scenario]]\nkind = \"pulse\"\nforce = \"1 N\"\nduration = \"1 s\"\n";
    let breaks = |what: &str| format!("[[scenario]]\nkind = \"break\"\ncoupler = {what}\n");
    let more = [
        breaks("5"),
        breaks("[9, 1, 4]"),
        breaks("\"each\""),
        breaks("[1, 2, 3, 4, 5, 6, 7, 8]"),
        format!("{pulse}at = \"tail\"\n"),
        format!("{pulse}at = 10\n"),
        format!("{pulse}at = 1\n"),
        format!("{pulse}at = 7\n"),
        format!("{pulse}at = 7\nname = \"pulse at vehicle 7\"\n"),
    ];
    let train = ten(COUPLER, &more.concat());
    let names: Vec<&str> = train.scenarios().iter().map(|s| s.name.as_str()).collect();
    let expected = [
        "break of coupler 5",
        "break of couplers 9, 1 and 4 in turn",
        "each coupler breaks in turn",
        "break of 8 couplers in turn",
        "pulse at the tail",
        "pulse at the tail (2)",
        "pulse at the head",
        "pulse at vehicle 7 (2)",
        "pulse at vehicle 7",
    ];
    assert_eq!(names, expected);
    assert_eq!(train.scenarios()[1].event, Event::Break { couplers: vec![8, 0, 3] }, "in the file's order");
}

#[test]
fn without_a_scenario_each_coupler_breaks_and_without_a_name_the_file_gives_it() {
    let train = ten(COUPLER, "");
    assert_eq!(train.name(), "a");
    assert_eq!(train.scenarios().len(), 1);
    assert_eq!(train.scenarios()[0].event, Event::Break { couplers: (0..9).collect() });
    assert_eq!(train.scenarios()[0].horizon_s, None);
    assert!(train.initial_force_n().iter().all(|&n| n == 0.0));
}

#[test]
fn warnings_say_what_is_likely_not_meant() {
    let warned = |more: &str| warnings(&ten(COUPLER, more));
    let breaks = "[[scenario]]\nname = \"b\"\nkind = \"break\"\ncoupler = 5\n";
    assert_eq!(
        warned(breaks),
        ["b: coupler 5 carries no load, so its break changes nothing; give [load] a uniform force"]
    );
    let over = "the load is over the rating of 9 of 9 couplers before anything happens";
    assert_eq!(warned("[load]\nuniform = \"1.6 MN\""), [over]);
    assert_eq!(warned("[load]\nuniform = \"1.5 MN\""), Vec::<String>::new(), "at the rating is not over it");
    let short =
        "[load]\nuniform = \"1 MN\"\n[[scenario]]\nname = \"b\"\nkind = \"break\"\ncoupler = 9\nhorizon = \"0.58 s\"";
    // Eight couplers in front of the broken one, each sqrt(160e3 / 30e6) s = 73.03 ms: 584.237 ms.
    let expected = "b: the horizon of 580 ms ends before a wave has crossed the longest part, 584.2 ms";
    assert_eq!(warned(short), [expected]);
    let cut = "b: the horizon of 590 ms ends before the first passage does, at 1.168 s: a larger force can follow";
    assert_eq!(warned(&short.replace("0.58", "0.59")), [cut]);
    assert_eq!(warned(&short.replace("0.58", "1.17")), Vec::<String>::new());
    let long =
        "[[scenario]]\nname = \"p\"\nkind = \"pulse\"\nat = 1\nforce = \"1 MN\"\nduration = \"3 s\"\nhorizon = \"2 s\"";
    // Nine couplers, each 73.03 ms: four transits are 2.629 s.
    assert_eq!(
        warned(long),
        [
            "p: the pulse lasts longer than the horizon of 2 s, so the effect of its end is not computed; a horizon of 5.63 s covers it",
            "p: the force does not end within the horizon and no vehicle is held, so the whole train is accelerated all that time; hold an \
             end, or let the force end"
        ]
    );
    let length = "[[vehicle]]\nmass = \"10 t\"\nlength = \"9 m\"\n[load]\nuniform = \"2 kN\"";
    let expected = "no length is given for vehicle 1 (and 9 more vehicles), so the train's length and the wave's speed over the ground are left out";
    assert_eq!(warned(length), [expected]);
    let two = format!("[coupler]\n{COUPLER}\n[[vehicle]]\ncount = 2\nmass = \"10 t\"\n[load]\nuniform = \"2 kN\"");
    let expected = "break of coupler 1: the train has one coupler only: after its break there is none left to examine";
    assert_eq!(warnings(&parse(&two)), [expected]);
}

/// The shortest and the longest horizon that `describe` names are those of all cases, looked at one by one.
#[test]
fn horizons_of_many_cases_are_told_from_the_shortest_to_the_longest() {
    let uneven =
        "[[vehicle]]\nmass = \"20 t\"\ncount = 30\n[load]\nuniform = \"1 N\"\n[[scenario]]\nkind = \"break\"\n";
    for list in ["\"each\"", "[7, 39, 2, 5, 11, 3]", "[39, 38, 37]", "[1, 2]"] {
        let train = ten(COUPLER, &format!("{uneven}coupler = {list}"));
        let Event::Break { couplers } = &train.scenarios()[0].event else { panic!("a break") };
        let horizons = couplers.iter().map(|&b| trainsafe::scenario::horizon_s(&train, &train.scenarios()[0], Some(b)));
        let (low, high) = horizons.fold((f64::INFINITY, 0.0f64), |(l, h), t| (l.min(t), h.max(t)));
        let [low, high] = [low, high].map(trainsafe::units::shown_time);
        let told = format!("horizon {low} to {high}\n");
        assert!(describe(&train).contains(&told), "{told} is not in {}", describe(&train));
    }
}

/// How many doubles lie between two positive ones.
fn ulps(a: f64, b: f64) -> u64 {
    a.to_bits().abs_diff(b.to_bits())
}

#[test]
fn the_same_train_in_other_units_is_the_same() {
    let metric = "[coupler]\nstiffness = \"17.5126835246476378 MN/m\"\nrated_load = \"1779.2886461042 kN\"
        [[vehicle]]\ncount = 3\nmass = \"129.72741782 t\"\nlength = \"16154.4 mm\"
        [load]\nuniform = \"444822.16152605 N\"";
    let imperial = "[coupler]\nstiffness = \"100 kip/in\"\nrated_load = \"400 kip\"
        [[vehicle]]\ncount = 3\nmass = \"286 klb\"\nlength = \"53 ft\"
        [load]\nuniform = \"100000 lbf\"";
    let (a, b) = (parse(metric), parse(imperial));
    let pairs = [
        (a.couplers()[1].stiffness_n_per_m, b.couplers()[1].stiffness_n_per_m),
        (a.couplers()[1].rated_draft_n, b.couplers()[1].rated_draft_n),
        (a.vehicles()[2].mass_kg, b.vehicles()[2].mass_kg),
        (a.vehicles()[2].length_m.unwrap_or_default(), b.vehicles()[2].length_m.unwrap_or_default()),
        (a.initial_force_n()[1], b.initial_force_n()[1]),
    ];
    for (a, b) in pairs {
        // A pound costs one rounding more than a kilogram, a pound per inch two more; the metric text one.
        assert!(ulps(a, b) <= 2, "{a:e} and {b:e}");
    }
}

/// A problem far along a line is told by its numbers, and one near its start is underlined however long the line is.
#[test]
fn a_place_far_along_a_line() {
    let list = "1, ".repeat(9_000);
    let text =
        format!("[coupler]\n{COUPLER}\n[[vehicle]]\ncount = 2\nmass = \"1 t\"\n[[scenario]]\nkind = \"break\"\n");
    let refused = |line: &str| match consist::parse(&format!("{text}{line}"), Path::new("a.toml")) {
        Ok(train) => panic!("{train:?}"),
        Err(error) => error.to_string(),
    };
    let far = refused(&format!("horizon = \"1 s\" #{list}\ncoupler = [ {}7]", " ".repeat(30_000)));
    assert!(far.starts_with("error: the train has no coupler 7\n--> a.toml:10:30013\n"), "{far}");
    let near = refused(&format!("coupler = [7] #{list}"));
    assert!(near.contains("a.toml:9:12\n") && near.contains("  ^"), "{near}");
}

proptest! {
    /// Whatever a slip of the hand does to a file, there is a train or an error that says something.
    #[test]
    fn no_file_makes_it_panic(from in 0usize..ORE_TRAIN.len(), len in 0usize..40, with in "(\\PC|[\\[\\]\"'=.,#\n\\x00-\\x1f]){0,12}") {
        let end = (from + len).min(ORE_TRAIN.len());
        let text = format!("{}{with}{}", &ORE_TRAIN[..from], &ORE_TRAIN[end..]);
        match consist::parse(&text, Path::new("a.toml")) {
            Ok(train) => prop_assert!(describe(&train).contains("to be run:")),
            Err(error) => {
                let message = error.to_string();
                prop_assert!(message.starts_with("error: "), "{message}");
                let escape = message.contains('\x1b');
                prop_assert!(!escape, "{message:?}");
            }
        }
    }
}
