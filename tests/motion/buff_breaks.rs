//! A coupler that carries buff does not part, and a gap that closes is told.

use std::path::Path;

use trainsafe::doubts::doubts;
use trainsafe::{Options, Train, analyze, consist};

/// A held locomotive and twelve cars.
fn train(load: &str, scenario: &str) -> String {
    format!(
        "[coupler]\nstiffness = \"11.1 MN/m\"\nrated_load = \"0.8 MN\"\n
         [[vehicle]]\nlabel = \"loco\"\nmass = \"196 t\"\nheld = true\n[[vehicle]]\nlabel = \"car\"\ncount = 12\nmass = \"120 t\"\n
         {load}\n{scenario}"
    )
}

fn parse(text: &str) -> Train {
    consist::parse(text, Path::new("train.toml")).unwrap_or_else(|e| panic!("{e}"))
}

fn refused(text: &str) -> String {
    consist::parse(text, Path::new("train.toml")).expect_err("refused").render(false)
}

fn codes(train: &Train) -> Vec<&'static str> {
    doubts(train).iter().map(|d| d.code).collect()
}

const BUNCHED: &str = "[load]\nuniform = \"-0.7 MN\"";
/// Twelve cars on a grade, pulled by the loco and pushed by another behind: the last couplers are in buff.
const PUSHED: &str =
    "[load]\ngrade = \"1 %\"\n[[vehicle]]\nlabel = \"pusher\"\nmass = \"100 t\"\ntractive_effort = \"40 kN\"";

/// A coupler that is asked for by number is refused, at its place, with its force and the way out.
#[test]
fn a_coupler_in_buff_is_refused() {
    let scenario = |coupler: &str| format!("[[scenario]]\nkind = \"break\"\ncoupler = {coupler}");
    let one = refused(&train(BUNCHED, &scenario("5")));
    assert!(one.contains("coupler 5 carries 700 kN in buff") && one.contains("buff_breaks = true"), "{one}");
    assert!(one.contains("coupler = 5"), "underlined: {one}");
    let list = refused(&train(PUSHED, &scenario("[2, 12, 7]")));
    assert!(list.contains("coupler 12 carries") && !list.contains("coupler 2 carries"), "{list}");
    let all = refused(&train(BUNCHED, &scenario("[1, 2, 3]")));
    assert_eq!(all.matches("in buff, so its vehicles stay pressed together").count(), 3, "{all}");
    let cascade = refused(&train(BUNCHED, &(scenario("5") + "\ncascade = true")));
    assert!(cascade.contains("coupler 5 carries"), "{cascade}");
    let pulse =
        "[[scenario]]\nkind = \"pulse\"\nat = \"tail\"\nforce = \"1 kN\"\nduration = \"1 s\"\nbuff_breaks = true";
    assert!(refused(&train(BUNCHED, pulse)).contains("buff_breaks without a cascade"));
}

/// With "each", and without a scenario, couplers in buff are left out and counted, everywhere alike.
#[test]
fn couplers_in_buff_are_left_out_of_each() {
    for scenario in ["", "[[scenario]]\nkind = \"break\"\ncoupler = \"each\""] {
        let train = parse(&train(PUSHED, scenario));
        let in_buff: Vec<usize> = (0..train.couplers().len()).filter(|&i| train.initial_force_n()[i] < 0.0).collect();
        assert!(!in_buff.is_empty() && in_buff.len() < 13, "{:?}", train.initial_force_n());
        let numbers: Vec<usize> = in_buff.iter().map(|i| i + 1).collect();
        assert_eq!(codes(&train), ["breaks-in-buff-left-out"]);
        let options = Options { map: true, ..Options::default() };
        let found = analyze(&train, &options).expect("sound").scenarios.remove(0);
        assert_eq!(found.name, "each coupler breaks in turn");
        assert_eq!(found.left_out_in_buff, numbers);
        assert_eq!(found.cases.len() + numbers.len(), train.couplers().len());
        assert!(found.cases.iter().all(|c| !numbers.contains(&c.broken_coupler.expect("a break"))));
        assert_eq!(found.map.expect("asked for").points.len(), found.cases.len());
        let checked = consist::describe(&train);
        assert!(
            checked.contains(&format!("{} in buff are left out; {} cases", numbers.len(), found.cases.len())),
            "{checked}"
        );
    }
    // All in draft: nothing is left out.
    let draft = parse(&train("[load]\nuniform = \"0.2 MN\"", ""));
    assert!(draft.scenarios()[0].left_out_in_buff.is_empty() && codes(&draft).is_empty());
}

/// In a train all in buff no break can be computed: an error if that is its only scenario, else a sentence of the report.
#[test]
fn a_train_all_in_buff_has_no_breaks() {
    let train = parse(&train(BUNCHED, ""));
    assert_eq!(codes(&train), ["breaks-in-buff-left-out"]);
    let why = "no case is left: every coupler that would break carries buff, so that nothing parts; buff_breaks = true computes a break \
               of one that is named";
    assert_eq!(analyze(&train, &Options::default()).expect_err("no case").to_string(), why);
    assert_eq!(trainsafe::findings::require_case(train.scenarios()).expect_err("no case").to_string(), why);
    let pulse = "[[scenario]]\nkind = \"break\"\ncoupler = \"each\"\n\
                 [[scenario]]\nkind = \"pulse\"\nat = \"tail\"\nforce = \"1 MN\"\nduration = \"1 s\"";
    let train = parse(&self::train(BUNCHED, pulse));
    let analysis = analyze(&train, &Options::default()).expect("sound");
    assert_eq!((analysis.scenarios[0].cases.len(), analysis.scenarios[0].left_out_in_buff.len()), (0, 12));
    let told = trainsafe::report::terminal(&analysis, &[]);
    assert!(told.contains("No break is computed: 12 couplers would break in turn, but carry buff"), "{told}");
    let dir = tempfile::tempdir().expect("a folder");
    trainsafe::report::write(&train, &analysis, dir.path(), &trainsafe::report::Format::ALL).expect("a report");
}

/// With buff_breaks they are computed as before, and doubted; where it changes nothing, that is told.
#[test]
fn buff_breaks_computes_them_with_a_doubt() {
    let scenario = "[[scenario]]\nkind = \"break\"\ncoupler = 5\nbuff_breaks = true";
    let train_in_buff = parse(&train(BUNCHED, scenario));
    assert_eq!(codes(&train_in_buff), ["breaks-in-buff"]);
    let case = analyze(&train_in_buff, &Options::default()).expect("sound").scenarios.remove(0).cases.remove(0);
    assert_eq!((case.broken_coupler, case.exceeding), (Some(5), 8), "as the linear model has it");
    let each = parse(&train(PUSHED, "[[scenario]]\nkind = \"break\"\ncoupler = \"each\"\nbuff_breaks = true"));
    assert_eq!(codes(&each), ["breaks-in-buff"]);
    assert_eq!(analyze(&each, &Options::default()).expect("sound").scenarios[0].cases.len(), each.couplers().len());
    assert_eq!(codes(&parse(&train("[load]\nuniform = \"0.2 MN\"", scenario))), ["buff-breaks-unused"]);
}

/// Two vehicles, m each, on a spring k. The second is pulled back by P from t = 0, so that `F = P / 2 (1 - cos w t)`,
/// `w^2 = 2 k / m`; the coupler breaks at F = R with the opening R / k and the speed F' / k. From then on P / m pulls the
/// vehicles apart, and from T on a push of Q brings them together again: the gap closes at the root of a parabola.
#[test]
fn a_gap_that_closes_in_a_cascade_by_the_closed_form() {
    let (m, k, pull, rating): (f64, f64, f64, f64) = (100e3, 10e6, 400e3, 300e3);
    let dir = tempfile::tempdir().expect("a folder");
    for (until_s, push) in [(0.2, 500e3f64), (0.15, 900e3), (0.4, 2e6)] {
        let rows = format!("time_s,force_kn\n0,{0}\n{until_s},{0}\n{until_s},{1}\n30,{1}\n", -pull / 1e3, push / 1e3);
        std::fs::write(dir.path().join("pulse.csv"), rows).expect("written");
        let text = format!(
            "[coupler]\nstiffness = \"{k} N/m\"\nrated_load = \"{rating} N\"\nrated_buff = \"9 MN\"\n
             [[vehicle]]\ncount = 2\nmass = \"{m} kg\"\n
             [[scenario]]\nkind = \"pulse\"\nat = \"tail\"\nrecord = \"pulse.csv\"\ncascade = true\nhorizon = \"20 s\""
        );
        let train = consist::parse(&text, &dir.path().join("train.toml")).unwrap_or_else(|e| panic!("{e}"));
        let analysis = analyze(&train, &Options::default()).expect("sound");
        let cascade = analysis.scenarios[0].cases[0].cascade.as_ref().expect("asked for");
        let omega = (2.0 * k / m).sqrt();
        let broken_s = (1.0 - 2.0 * rating / pull).acos() / omega;
        assert!((cascade.breaks[0].time_s - broken_s).abs() < 1e-9);
        let speed = 0.5 * pull * omega * (omega * broken_s).sin() / k;
        let lasting = until_s - broken_s;
        let opening = rating / k + speed * lasting + 0.5 * pull / m * lasting * lasting;
        let (apart, brake) = (speed + pull / m * lasting, push / m);
        let closes_s = until_s + (apart + (apart * apart + 2.0 * brake * opening).sqrt()) / brake;
        let found = cascade.gap_closes_s.expect("it closes");
        assert!((found - closes_s).abs() < 1e-8, "{found}, right {closes_s}");
        assert_eq!(cascade.gap_coupler, Some(1));
        let told = trainsafe::report::terminal(&analysis, &[]);
        assert!(told.contains("the gap at coupler 1 closes then"), "{told}");
    }
}

/// In buff a gap is closed from the start; after a break in draft alone it never closes.
#[test]
fn gaps_of_breaks_alone() {
    let cascade = |load: &str, more: &str| {
        let scenario = format!("[[scenario]]\nkind = \"break\"\ncoupler = 5\ncascade = true\n{more}");
        let train = parse(&train(load, &scenario));
        analyze(&train, &Options::default())
            .expect("sound")
            .scenarios
            .remove(0)
            .cases
            .remove(0)
            .cascade
            .expect("asked for")
    };
    let closed = cascade(BUNCHED, "buff_breaks = true");
    assert_eq!((closed.gap_closes_s, closed.gap_coupler), (Some(0.0), Some(5)));
    for load in ["0.3 MN", "0.05 MN", "0 N"] {
        let open = cascade(&format!("[load]\nuniform = \"{load}\""), "");
        assert!(open.breaks.is_empty() && open.gap_closes_s.is_none(), "{load}: {open:?}");
    }
}
