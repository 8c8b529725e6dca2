//! A train is valid by construction: each thing that can be wrong with a spec, through the library, with its exact message.

use crate::common::{breaks, uniform};
use trainsafe::law::{Curve, GearRow, Law};
use trainsafe::train::{
    Application, CouplerSpec, Event, Forcing, Limits, Load, PulledTo, Pulse, PulseShape, Response, Rule, Scenario,
    TrainSpec, VehicleSpec,
};
use trainsafe::{Options, analyze, consist};

/// Five vehicles of 80 t with couplers of 20 MN/m rated at 0.6 MN, pulled by 0.4 MN.
fn five() -> TrainSpec {
    uniform("five", 5, 80e3, 20e6, 0.6e6, 0.4e6)
}

/// What is wrong with five vehicles of which something has been changed, a line for each problem.
fn told(change: impl FnOnce(&mut TrainSpec)) -> String {
    let mut spec = five();
    change(&mut spec);
    spec.build().expect_err("it is no train").to_string()
}

fn scenario(event: Event) -> Scenario {
    Scenario { event, ..breaks("s", vec![], None) }
}

#[test]
fn a_right_spec_is_a_train() {
    let train = five().build().expect("a train");
    assert_eq!((train.vehicles().len(), train.couplers().len()), (5, 4));
    assert_eq!(train.initial_force_n(), [0.4e6; 4]);
    assert_eq!(train.scenarios()[0].name, "each coupler breaks in turn");
    assert_eq!(train.clone().into_spec().build(), Ok(train), "a train is built from its own spec");
}

/// Every train of the folder is built again from its own spec, to the last bit.
#[test]
fn a_train_that_was_read_is_built_from_its_own_spec() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("trains");
    let files = std::fs::read_dir(folder).expect("a folder").flatten().map(|entry| entry.path());
    let mut count = 0;
    for file in files.filter(|file| file.extension().is_some_and(|e| e == "toml")) {
        let train = consist::read(&file).expect("a train");
        let again = train.clone().into_spec().build().unwrap_or_else(|wrong| panic!("{}: {wrong}", file.display()));
        assert_eq!(again, train, "{}", file.display());
        count += 1;
    }
    assert!(count > 10, "{count}");
}

/// A wrong number of any key: what it is called, how it is put into a spec, and what is right.
#[test]
fn no_number_can_be_what_it_cannot_be() {
    type Put = fn(&mut TrainSpec, f64);
    let positive: [(&str, Put); 13] = [
        ("vehicle[3].mass", |s, x| s.vehicles[3].mass_kg = x),
        ("vehicle[1].length", |s, x| s.vehicles[1].length_m = Some(x)),
        ("coupler[2].stiffness", |s, x| s.couplers[2].law = Law::linear(x)),
        ("coupler[2].stiffness_in_buff", |s, x| {
            s.couplers[2].law = Law::Elastic { draft_n_per_m: 1e7, buff_n_per_m: x, slack_m: 0.0 };
        }),
        ("coupler[0].rated_load", |s, x| s.couplers[0].rated_draft_n = x),
        ("coupler[3].rated_buff", |s, x| s.couplers[3].rated_buff_n = x),
        ("coupler[1].limits.draft.proof", |s, x| s.couplers[1].limits.draft_n[1] = Some(x)),
        ("coupler[1].limits.buff.ultimate", |s, x| s.couplers[1].limits.buff_n[2] = Some(x)),
        ("speed", |s, x| s.speed_m_per_s = Some(x)),
        ("load.pulled_to", |s, x| s.pulled_to = PulledTo::Largest(x)),
        ("scenario[0].horizon", |s, x| s.scenarios = vec![breaks("s", vec![0], Some(x))]),
        ("scenario[0].duration", |s, x| {
            s.scenarios = vec![scenario(Event::Pulse(Pulse::rectangle(0, 1e5, x)))];
        }),
        ("scenario[0].speed", |s, x| {
            s.scenarios = vec![scenario(Event::Impact { vehicles: 2, at_head: true, speed_m_per_s: x })];
        }),
    ];
    let not_negative: [(&str, Put); 3] = [
        ("coupler[1].slack", |s, x| {
            s.couplers[1].law = Law::Elastic { draft_n_per_m: 1e7, buff_n_per_m: 1e7, slack_m: x };
        }),
        ("coupler[0].damping", |s, x| s.couplers[0].dashpot_n_s_per_m = x),
        ("vehicle[4].emergency_brake", |s, x| s.vehicles[4].emergency_brake_n = x),
    ];
    let any: [(&str, Put); 3] = [
        ("load.uniform", |s, x| s.load = Load::Uniform(x)),
        ("load[2]", |s, x| s.load = Load::InCouplers(vec![0.0, 0.0, x, 0.0])),
        ("load[4]", |s, x| s.load = Load::OnVehicles(vec![0.0, 0.0, 0.0, 0.0, x])),
    ];
    let wrong = [(f64::NAN, "is not a number"), (f64::INFINITY, "is infinite"), (f64::NEG_INFINITY, "is infinite")];
    let below = [(-1.0, "is negative")];
    let zero = [(0.0, "is zero"), (-0.0, "is zero")];
    let check = |keys: &[(&str, Put)], values: &[(f64, &str)], right: &str| {
        for (key, put) in keys {
            for (value, found) in values {
                let leaf = key.rsplit('.').next().unwrap_or(key);
                let message = told(|spec| put(spec, *value));
                assert_eq!(message, format!("{key}: {leaf} {found}; {right}"), "{key} of {value}");
            }
        }
    };
    check(&positive, &[&wrong[..], &below, &zero].concat(), "expected a value above zero");
    check(&not_negative, &[&wrong[..], &below].concat(), "expected zero or more");
    check(&any, &wrong, "expected a finite number");
}

#[test]
fn a_train_has_the_vehicles_and_couplers_that_fit_each_other() {
    let right = "give it a row or a [[vehicle]] for each vehicle or group alike, from the head: at least two vehicles";
    assert_eq!(
        TrainSpec::default().build().expect_err("empty").to_string(),
        format!("vehicle: the train has no vehicles; {right}")
    );
    let one = |s: &mut TrainSpec| s.vehicles.truncate(1);
    assert_eq!(told(one), format!("vehicle[0]: the train has one vehicle, so no coupler; {right}"));
    let missing = |s: &mut TrainSpec| s.couplers.truncate(3);
    assert_eq!(told(missing), "coupler: the train has 5 vehicles and 3 couplers; expected 4");
    let none = |s: &mut TrainSpec| s.vehicles[2].count = 0;
    assert_eq!(told(none), "vehicle[2].count: count is 0; expected how many of them follow each other, 1 or more");
    let short = |s: &mut TrainSpec| s.load = Load::InCouplers(vec![1.0]);
    assert_eq!(told(short), "load: the train has 5 vehicles and 1 forces in couplers; expected 4");
    let short = |s: &mut TrainSpec| s.load = Load::OnVehicles(vec![1.0]);
    assert_eq!(told(short), "load: the train has 5 vehicles and 1 forces on vehicles; expected 5");
    let many = |s: &mut TrainSpec| s.vehicles[1].count = usize::MAX;
    assert_eq!(
        told(many),
        "vehicle[1]: the train has more than 1000000 vehicles up to here; a train has at most that many"
    );
}

#[test]
fn only_the_ends_can_be_held() {
    let right = "only the first and the last vehicle of the train can be held";
    assert_eq!(
        told(|s| s.vehicles[2].held = true),
        format!("vehicle[2].held: a vehicle in the middle of the train is held; {right}")
    );
    let group = |s: &mut TrainSpec| {
        s.vehicles.truncate(1);
        s.vehicles[0] = VehicleSpec { count: 5, held: true, ..VehicleSpec::new(1e5) };
    };
    let own = "give it a row or a [[vehicle]] of its own, without count";
    assert_eq!(told(group), format!("vehicle[0].held: a group of 5 vehicles is held; {right}: {own}"));
    let both = |s: &mut TrainSpec| {
        s.vehicles.truncate(2);
        s.couplers.truncate(1);
        s.vehicles.iter_mut().for_each(|v| v.held = true);
    };
    assert_eq!(
        told(both),
        "vehicle[1].held: both vehicles of the train are held, so nothing in it moves; hold one of them, or none"
    );
    let braked =
        |s: &mut TrainSpec| s.vehicles[0] = VehicleSpec { held: true, emergency_brake_n: 1.0, ..VehicleSpec::new(1.0) };
    assert_eq!(
        told(braked),
        "vehicle[0].emergency_brake: emergency_brake of a held vehicle; a held vehicle takes whatever force it needs to keep \
         its speed: leave the key out"
    );
}

#[test]
fn everything_is_told_at_once() {
    let message = told(|s| {
        s.vehicles[1].mass_kg = f64::NAN;
        s.vehicles[2].held = true;
        s.couplers[3].law = Law::linear(-20e6);
        s.scenarios = vec![breaks("a", vec![9], None), breaks("a", vec![1, 1], None)];
    });
    let keys: Vec<&str> = message.lines().filter_map(|line| line.split(": ").next()).collect();
    let all = [
        "vehicle[1].mass",
        "coupler[3].stiffness",
        "vehicle[2].held",
        "scenario[1].name",
        "scenario[0].coupler",
        "scenario[1].coupler",
    ];
    assert_eq!(keys, all, "{message}");
}

#[test]
fn couplers_have_laws_and_limits_that_can_be() {
    let limits = |s: &mut TrainSpec| s.couplers[1].limits = Limits::both([None, Some(2e6), Some(1.8e6)]);
    assert_eq!(
        told(limits),
        "coupler[1].limits: proof in draft, 2 MN, is above ultimate, 1.8 MN; the order is fatigue, proof, ultimate, and none \
         is above the next"
    );
    let row = |travel_m, loading_n, unloading_n| GearRow { travel_m, loading_n, unloading_n };
    let curve = |first: f64| Curve::new(vec![row(0.0, 1e4, first), row(0.05, 9e5, 2e5)]).expect("a curve");
    let gear =
        |solid_n_per_m, slack_m, first| Law::Gear { solid_n_per_m, slack_m, draft: curve(first), buff: curve(0.0) };
    assert_eq!(
        told(|s| s.couplers[0].law = gear(0.0, 0.0, 0.0)),
        "coupler[0].solid_stiffness: solid_stiffness is zero; expected a value above zero"
    );
    assert_eq!(
        told(|s| s.couplers[0].law = gear(2e8, 0.01, -1e3)),
        "coupler[0].gear: with slack the unloading force of the first row cannot be negative, and here it is -1000 N; give it \
         0 or more, or leave slack out"
    );
    let damped = |s: &mut TrainSpec| {
        s.couplers[0].law = gear(2e8, 0.0, 0.0);
        s.couplers[2].dashpot_n_s_per_m = 1e5;
    };
    assert_eq!(
        told(damped),
        "coupler[2].damping: coupler 3 has damping in a train whose couplers are not all linear; damping is for trains of \
         linear couplers: leave it out, or slack, gears and stiffness_in_buff"
    );
}

#[test]
fn damping_ratios_fit_the_train() {
    for ratio in [f64::NAN, -0.1, 1.0, f64::INFINITY] {
        assert_eq!(
            told(|s| s.damping_ratio = ratio),
            format!("damping_ratio: damping_ratio is {ratio}; expected a number from 0 to under 1")
        );
    }
    let beside = |s: &mut TrainSpec| (s.damping_ratio, s.couplers[0].dashpot_n_s_per_m) = (0.1, 1.0);
    assert!(told(beside).starts_with("damping_ratio: damping_ratio beside dashpots; keep one of them"));
    let cascade = |s: &mut TrainSpec| {
        s.damping_ratio = 0.1;
        s.scenarios = vec![Scenario { cascade: Rule::InDraft, ..breaks("s", vec![1], None) }];
    };
    assert_eq!(
        told(cascade),
        "damping_ratio: damping_ratio is for breaks and rectangular pulses without a cascade; give [coupler] a damping = \
         \"200 kN*s/m\" instead, for scenario \"s\""
    );
}

#[test]
fn loads_before_are_not_less_than_the_load() {
    assert_eq!(
        told(|s| s.pulled_to = PulledTo::Largest(0.3e6)),
        "load.pulled_to: pulled_to is less than the load, 400 kN; it is the largest pull before the event, \
         which was then reduced to the load: it cannot be less than the load"
    );
    let pushed = |s: &mut TrainSpec| {
        (s.load, s.pulled_to) = (Load::OnVehicles(vec![-4.0, 1.0, 1.0, 1.0, 1.0]), PulledTo::Largest(9.0));
    };
    assert!(told(pushed).starts_with("load.pulled_to: pulled_to of a train in which no coupler is pulled; "));
    let slack = Law::Elastic { draft_n_per_m: 1e7, buff_n_per_m: 1e7, slack_m: 0.01 };
    let held = |s: &mut TrainSpec| {
        s.couplers.iter_mut().for_each(|c| c.law = slack.clone());
        (s.vehicles[0].held, s.vehicles[4].held, s.load) = (true, true, Load::OnVehicles(vec![1.0; 5]));
    };
    assert_eq!(
        told(held),
        "load: forces on the vehicles between two held ends need linear couplers, which share them by their stiffness; hold \
         one end, or give the couplers' force with [load] uniform"
    );
}

#[test]
fn scenarios_are_of_vehicles_and_couplers_that_are_there() {
    let of = |event: Event| told(|s| s.scenarios = vec![scenario(event)]);
    let right = "expected a coupler's number from 1 to 4";
    assert_eq!(
        of(Event::Break { couplers: vec![] }),
        format!("scenario[0].coupler: the list of couplers is empty; {right}")
    );
    assert_eq!(
        of(Event::Break { couplers: vec![4] }),
        format!("scenario[0].coupler: the train has no coupler 5; {right}")
    );
    assert_eq!(
        of(Event::Break { couplers: vec![2, 2] }),
        "scenario[0].coupler: coupler 3 is listed twice; list it once"
    );
    let pulse = |vehicle, force_n| Event::Pulse(Pulse::rectangle(vehicle, force_n, 0.1));
    assert_eq!(
        of(pulse(5, 1.0)),
        "scenario[0].at: the train has no vehicle 6; expected a vehicle's number from 1 to 5"
    );
    assert_eq!(of(pulse(1, 0.0)), "scenario[0].force: force is zero; expected a force other than zero");
    let held = |s: &mut TrainSpec| {
        s.vehicles[0].held = true;
        s.scenarios = vec![scenario(pulse(0, 1.0))];
    };
    assert_eq!(
        told(held),
        "scenario[0].at: the pulse acts on a held vehicle, which no force can move; choose a vehicle that is not held"
    );
    let course = |points: Vec<[f64; 2]>| {
        let shape = PulseShape::Record(points);
        of(Event::Pulse(Pulse { vehicle: 1, shape, force_n: 1.0, duration_s: 1.0 }))
    };
    let falls = "scenario[0].record: the times of record fall; no time is less than the one before";
    assert_eq!(course(vec![[0.0, 1.0], [1.0, 0.0], [0.5, 0.0]]), falls);
    let nan = "scenario[0].record: record is not a number; expected a finite number";
    assert_eq!(course(vec![[0.0, 1.0], [1.0, f64::NAN]]), nan);
    let ramps = |rise_s, fall_s| {
        let shape = PulseShape::Trapezoid { rise_s, fall_s };
        of(Event::Pulse(Pulse { vehicle: 1, shape, force_n: 1.0, duration_s: 1.0 }))
    };
    let long = "scenario[0].rise: rise and fall are longer than the pulse; together they may be as long as the duration, not longer";
    assert_eq!(ramps(0.6, 0.5), long);
    assert!(ramps(0.6, -0.5).starts_with("scenario[0].fall: fall is negative"), "{}", ramps(0.6, -0.5));
    let impact = |vehicles| Event::Impact { vehicles, at_head: false, speed_m_per_s: 1.0 };
    for vehicles in [0, 5] {
        let right = "expected a whole number from 1 to 4: at least one vehicle stands";
        assert_eq!(of(impact(vehicles)), format!("scenario[0].vehicles: vehicles is {vehicles}; {right}"));
    }
}

#[test]
fn scenarios_have_names_of_their_own() {
    let twice = |s: &mut TrainSpec| s.scenarios = vec![breaks("a", vec![1], None), breaks("a", vec![2], None)];
    assert_eq!(told(twice), "scenario[1].name: two scenarios are named \"a\"; give each scenario a name of its own");
    let mut spec = five();
    spec.scenarios = ["", "break of coupler 2", ""].map(|name| breaks(name, vec![1], None)).to_vec();
    let train = spec.build().expect("a train");
    let names: Vec<&str> = train.scenarios().iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["break of coupler 2 (2)", "break of coupler 2", "break of coupler 2 (3)"]);
}

/// A train with what a brake application needs.
fn braked() -> TrainSpec {
    let mut spec = five();
    spec.vehicles.iter_mut().for_each(|v| (v.length_m, v.emergency_brake_n) = (Some(12.0), 4e4));
    spec.speed_m_per_s = Some(10.0);
    spec.scenarios = vec![scenario(brake(vec![[0.0, 0.0], [8.0, 1.0]]))];
    spec
}

fn brake(build_up: Vec<[f64; 2]>) -> Event {
    Event::Brake {
        from: vec![0],
        emergency: true,
        application: Application { name: None, wave_m_per_s: 250.0, build_up },
    }
}

#[test]
fn brakes_have_what_they_need() {
    assert!(braked().build().is_ok());
    let told = |change: &dyn Fn(&mut TrainSpec)| {
        let mut spec = braked();
        change(&mut spec);
        let told = spec.build().expect_err("it is no train").to_string();
        told.split("; ").next().unwrap_or_default().to_owned()
    };
    let key = "scenario[0].emergency";
    assert_eq!(
        told(&|s| s.vehicles[1].length_m = None),
        format!("{key}: emergency needs the length of every vehicle, and \"car 2\" has none")
    );
    assert_eq!(
        told(&|s| s.vehicles.iter_mut().for_each(|v| v.emergency_brake_n = 0.0)),
        format!("{key}: emergency in a train in which no vehicle has an emergency_brake")
    );
    assert_eq!(told(&|s| s.speed_m_per_s = None), format!("{key}: emergency needs the train's speed"));
    assert_eq!(told(&|s| s.damping_ratio = 0.1), format!("{key}: emergency in a train with a damping_ratio"));
    let built_up =
        |points: Vec<[f64; 2]>| told(&|s: &mut TrainSpec| s.scenarios = vec![scenario(brake(points.clone()))]);
    for (points, message) in [
        (vec![], "build_up has fewer than two rows"),
        (vec![[0.0, 0.0], [f64::NAN, 1.0]], "build_up has a value that is not a finite number"),
        (vec![[0.0, 0.1], [8.0, 1.0]], "build_up does not start with no force at 0 s"),
        (vec![[0.0, 0.0], [0.0, 1.0]], "the times of build_up do not rise"),
        (vec![[0.0, 0.0], [8.0, 1.5]], "build_up has a share over 100 %"),
        (vec![[0.0, 0.0], [8.0, 1.0], [9.0, 0.5]], "the shares of build_up fall"),
        (vec![[0.0, 0.0], [8.0, 0.0]], "build_up holds no brake force"),
    ] {
        assert_eq!(built_up(points), format!("{key}.build_up: {message}"));
    }
    let effort = |vehicle, points| {
        let response = Response { efforts: vec![Forcing { vehicle, points }], ..Response::default() };
        told(&|s: &mut TrainSpec| s.scenarios[0].response = response.clone())
    };
    assert_eq!(effort(7, vec![[0.0, 1.0]]), "scenario[0].at: the train has no vehicle 8");
    assert_eq!(effort(1, vec![[0.0, f64::NAN]]), "scenario[0].throttle: throttle is not a number");
}

#[test]
fn names_are_plain_text() {
    assert_eq!(
        told(|s| s.name = "a\u{1b}[2J".to_owned()),
        "name: name has a control character: \"a\\u{1b}[2J\"; expected plain text"
    );
    assert_eq!(
        told(|s| s.vehicles[1].label = Some("\tcar".to_owned())),
        "vehicle[1].label: label has a control character: \"\\tcar\"; expected plain text"
    );
    assert_eq!(
        told(|s| s.vehicles[1].label = Some(" ".to_owned())),
        "vehicle[1].label: label is empty; expected what reports call the vehicle, or no label"
    );
}

/// The readers refuse what the library refuses, in the same words: rules are not written twice.
#[test]
fn a_file_is_told_the_same_as_the_library() {
    let text = |held: &str, rest: &str| {
        format!(
            "[coupler]\nstiffness = \"20 MN/m\"\nrated_load = \"0.6 MN\"\n[[vehicle]]\nmass = \"80 t\"\n[[vehicle]]\nmass = \
             \"80 t\"\n{held}[[vehicle]]\nmass = \"80 t\"\ncount = 3\n{rest}"
        )
    };
    let of_file = |text: &str| {
        let wrong = consist::parse(text, "t.toml".as_ref()).expect_err("it is no train");
        let problems = wrong.problems().0;
        problems
            .iter()
            .map(|p| (p.key.clone(), p.message.clone(), p.place.as_ref().map(|p| p.line)))
            .collect::<Vec<_>>()
    };
    let one = |key: &str, message: &str, line| vec![(Some(key.to_owned()), message.to_owned(), Some(line))];
    let middle = "a vehicle in the middle of the train is held";
    assert_eq!(of_file(&text("held = true\n", "")), one("vehicle[1].held", middle, 8));
    let twice = "[[scenario]]\nname = \"a\"\nkind = \"break\"\ncoupler = 1\n".repeat(2);
    assert_eq!(of_file(&text("", &twice)), one("scenario[1].name", "two scenarios are named \"a\"", 16));
    let low = "[load]\nuniform = \"0.4 MN\"\npulled_to = \"0.3 MN\"\n";
    assert_eq!(of_file(&text("", low)), one("load.pulled_to", "pulled_to is less than the load, 400 kN", 13));
}

/// What the library answered before it looked at a train: forces, with a bound, of a train that cannot be.
#[test]
fn nothing_is_computed_of_a_wrong_train() {
    let right = analyze(&five().build().expect("a train"), &Options::default()).expect("sound");
    assert!(right.scenarios[0].cases.iter().all(|c| c.couplers.iter().all(|c| c.peak_force_n.is_finite())));
    let wrong = |c: &mut CouplerSpec| c.law = Law::linear(f64::NAN);
    assert!(told(|s| s.couplers.iter_mut().for_each(wrong)).lines().count() == 4);
}
