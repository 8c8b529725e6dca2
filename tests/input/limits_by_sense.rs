//! Limits in draft and in buff, a limit at the load, and the load that breaks a coupler in a cascade.

use std::fs;
use std::path::Path;

use trainsafe::doubts::doubts;
use trainsafe::train::Limits;
use trainsafe::{Analysis, Options, Train, analyze, consist, report};

/// No limit.
const NONE: Vec<&str> = Vec::new();

fn run(text: &str) -> (Train, Analysis) {
    let train = consist::parse(text, Path::new("a.toml")).unwrap_or_else(|e| panic!("{e}"));
    let analysis = analyze(&train, &Options::default()).expect("sound");
    (train, analysis)
}

fn markdown(train: &Train, analysis: &Analysis) -> String {
    let dir = tempfile::tempdir().expect("a folder");
    report::write(train, analysis, dir.path(), &report::Format::ALL).expect("written");
    fs::read_to_string(dir.path().join("report.md")).expect("a report")
}

/// One vehicle of 1 kg on 1 N/m behind a held head, pulled backward by a force step of 1 N: its coupler carries
/// `load + 1 - cos t`, from the load to 2 N above it, and is back at the load after 2 pi s.
fn swing(limits: &str, load: &str, horizon: &str) -> String {
    format!(
        "[coupler]\nstiffness = \"1 N/m\"\nrated_load = \"9 N\"\nlimits = {limits}\n[[vehicle]]\nmass = \"1 kg\"\nheld = true\n
         [[vehicle]]\nmass = \"1 kg\"\n[load]\nuniform = \"{load}\"\n[[scenario]]\nkind = \"pulse\"\nat = 2\nforce = \"-1 N\"\n
         duration = \"100 s\"\nhorizon = \"{horizon}\"\n"
    )
}

/// `passed` and `undecided` of the one coupler.
fn verdicts(text: &str) -> [Vec<&'static str>; 2] {
    let limits = run(text).1.scenarios[0].cases[0].couplers[0].limits.clone().expect("limits");
    [limits.passed, limits.undecided]
}

#[test]
fn each_sense_is_held_against_its_own_limit() {
    // From -1.5 N to 0.5 N.
    let limits =
        "{ proof = \"1 N\", ultimate = \"3 N\", draft = { proof = \"0.4 N\" }, buff = { ultimate = \"1.6 N\" } }";
    let (_, analysis) = run(&swing(limits, "-1.5 N", "20 s"));
    let found = analysis.scenarios[0].cases[0].couplers[0].limits.clone().expect("limits");
    assert_eq!((found.largest_n, found.passed), (1.5, vec!["proof"]));
    let told: Vec<_> = found.by_sense.iter().map(|l| (l.limit, l.sense, l.limit_n, l.passed)).collect();
    let expected = [
        ("proof", "draft", 0.4, Some(true)),
        ("ultimate", "draft", 3.0, Some(false)),
        ("proof", "buff", 1.0, Some(true)),
        ("ultimate", "buff", 1.6, Some(false)),
    ];
    assert_eq!(told, expected);
    for (l, expected) in found.by_sense.iter().zip([-0.25, 1.0 - 0.5 / 3.0, -0.5, 1.0 - 1.5 / 1.6]) {
        assert!((l.margin - expected).abs() < 1e-9, "{l:?}");
    }
}

/// What the load pushes on from a limit that it equals passes the limit, by however little; what it relieves does not, until
/// it comes back as near to it as can be told.
#[test]
fn a_limit_at_the_load() {
    let proof = vec!["proof"];
    let pushed = verdicts(&swing("{ proof = \"2 N\" }", "2 N", "20 s"));
    assert_eq!(pushed, [proof.clone(), NONE]);
    let relieved = verdicts(&swing("{ proof = \"2 N\" }", "-2 N", "3 s"));
    assert_eq!(relieved, [NONE, NONE]);
    let back_at_it = verdicts(&swing("{ proof = \"2 N\" }", "-2 N", "20 s"));
    assert_eq!(back_at_it, [NONE, proof.clone()]);
    // In the other sense nothing is near.
    let other = verdicts(&swing("{ buff = { proof = \"2 N\" } }", "2 N", "20 s"));
    assert_eq!(other, [NONE, NONE]);
    // Several limits at the load, each told.
    let all = verdicts(&swing("{ fatigue = \"2 N\", proof = \"2 N\", ultimate = \"2 N\" }", "-2 N", "20 s"));
    assert_eq!(all, [NONE, vec!["fatigue", "proof", "ultimate"]]);
}

/// A push of 4e-10 N over 0.01 s takes a coupler at 1 MN past it by 6e-12 N, which is far within the error bound.
#[test]
fn a_push_too_small_to_tell_is_not_decided() {
    let text = |rating: &str, limit: &str| {
        format!(
            "[coupler]\nstiffness = \"30 MN/m\"\nrated_load = \"{rating}\"\nlimits = {{ {limit} }}\n[[vehicle]]\nmass = \"100 t\"\n
             [[vehicle]]\nmass = \"100 t\"\n[load]\nuniform = \"1 MN\"\n[[scenario]]\nkind = \"pulse\"\nat = 1\nforce = \"4e-10 N\"\n
             duration = \"10 s\"\nhorizon = \"0.01 s\"\n"
        )
    };
    for rating in ["1 MN", "3 MN"] {
        for (limit, name) in [("proof = \"1 MN\"", "proof"), ("draft.fatigue = \"1 MN\"", "fatigue")] {
            let [passed, undecided] = verdicts(&text(rating, limit));
            assert!([passed, undecided].concat() == [name], "{rating} {limit}");
        }
        // One part in 1e9 above the load is not reached.
        assert_eq!(verdicts(&text(rating, "proof = \"1.000000001 MN\"")), [NONE, NONE]);
        assert_eq!(verdicts(&text(rating, "proof = \"0.999999999 MN\"")), [vec!["proof"], NONE]);
    }
}

/// A load at the fatigue limit and a pulse at the other end: the far couplers are reached by a force too small to tell.
#[test]
fn couplers_that_the_front_has_not_reached() {
    let text = "[coupler]\nstiffness = \"30 MN/m\"\nrated_load = \"3 MN\"\nlimits = { fatigue = \"1 MN\" }\n[[vehicle]]\n
                mass = \"100 t\"\ncount = 40\n[load]\nuniform = \"1 MN\"\n[[scenario]]\nkind = \"pulse\"\nat = \"head\"\n
                force = \"200 kN\"\nduration = \"10 s\"\nhorizon = \"0.3 s\"\n";
    let (_, analysis) = run(text);
    let limits = analysis.scenarios[0].cases[0].couplers.iter().map(|c| c.limits.clone().expect("limits"));
    for (i, limits) in limits.enumerate() {
        // In the model every coupler is pushed on at once, the far ones by next to nothing.
        let told = [limits.passed, limits.undecided].concat();
        assert_eq!(told, ["fatigue"], "coupler {}", i + 1);
    }
}

#[test]
fn the_report_tells_sense_and_margin_of_what_was_given() {
    let sentences = |limits: &str, load: &str| {
        let (train, analysis) = run(&swing(limits, load, "20 s"));
        let text = markdown(&train, &analysis);
        let line = text.lines().find_map(|l| l.strip_prefix("**Other limits.** ")).expect("limits").to_owned();
        (line, text)
    };
    // From 1 N to 3 N.
    let (line, _) = sentences("{ ultimate = \"4 N\" }", "1 N");
    assert_eq!(
        line,
        "No coupler passes its ultimate load, in draft or buff. No fatigue or proof load was given. The smallest margin to a \
         ultimate load is 25.0 %: coupler 1, 3.000 N in draft against 4 N."
            .replace("a ultimate", "an ultimate")
    );
    // From -1.5 N to 0.5 N.
    let (line, text) = sentences("{ fatigue = \"1 N\", draft = { proof = \"1 N\" } }", "-1.5 N");
    assert_eq!(
        line,
        "The fatigue load is passed by none in draft and 1 coupler in buff, already under the load before the event. No coupler passes its proof load in draft. No \
         ultimate load was given. No proof load was given in buff. Coupler 1 exceeds its fatigue load most: 1.500 N in buff \
         against 1 N, 50.0 % over. The smallest margin to a proof load is 50.0 %: coupler 1, 500.0 mN in draft against 1 N."
            .replace("500.0 mN", "0.5000 N")
    );
    assert!(text.contains("| 1 | vehicle 1, vehicle 2 | 1.500 N in buff | fatigue 1 N (over by 50.0 %) |"), "{text}");
    let (line, _) = sentences("{ proof = \"2 N\" }", "-2 N");
    assert!(line.starts_with("No coupler certainly passes its proof load, in draft or buff. "), "{line}");
    assert!(line.contains("For 1 coupler it cannot be decided whether the proof load in buff is passed."), "{line}");
    let (line, _) = sentences("{ buff = { proof = \"2 N\", ultimate = \"2.5 N\" } }", "-1 N");
    assert!(
        line.starts_with("No coupler passes its proof load in buff. No coupler passes its ultimate load in buff."),
        "{line}"
    );
    assert!(line.contains("No fatigue load was given. No proof or ultimate load was given in draft."), "{line}");
}

#[test]
fn overrides_merge_each_capacity_in_each_sense() {
    let text = "[coupler]\nstiffness = \"1 N/m\"\nrated_load = \"2 N\"\nlimits = { fatigue = \"1 N\", draft = { proof = \"2 N\" } }
        [[vehicle]]\ncount = 5\nmass = \"1 kg\"\n[[coupler_override]]\nat = 2\nlimits = { proof = \"3 N\" }
        [[coupler_override]]\nat = 3\nlimits = { buff = { ultimate = \"5 N\" } }
        [[coupler_override]]\nat = 4\nlimits = { fatigue = \"0.5 N\", draft = { fatigue = \"0.7 N\" } }";
    let train = consist::parse(text, Path::new("a.toml")).unwrap_or_else(|e| panic!("{e}"));
    let limits = |draft_n, buff_n| Limits { draft_n, buff_n };
    let (one, two, three) = (Some(1.0), Some(2.0), Some(3.0));
    let expected = [
        limits([one, two, None], [one, None, None]),
        limits([one, three, None], [one, three, None]),
        limits([one, two, None], [one, None, Some(5.0)]),
        limits([Some(0.7), two, None], [Some(0.5), None, None]),
    ];
    assert_eq!(train.extras().limits, expected);
}

/// A rating above the load that breaks the coupler is told; at most it equals it.
#[test]
fn a_rating_above_the_ultimate_load_is_a_doubt() {
    let told = |limits: &str| {
        let text = swing(limits, "1 N", "20 s");
        let train = consist::parse(&text, Path::new("a.toml")).unwrap_or_else(|e| panic!("{e}"));
        doubts(&train).into_iter().filter(|d| d.code == "limit-order").map(|d| d.text).collect::<Vec<_>>()
    };
    let in_sense = |sense: &str| {
        vec![format!(
            "the rating of coupler 1 in {sense} is above its ultimate load in {sense}: a coupler would break before it reaches \
             its rating; check both, or give limits.draft and limits.buff apart"
        )]
    };
    assert_eq!(told("{ ultimate = \"8.9 N\" }"), in_sense("draft"));
    assert_eq!(told("{ ultimate = \"9.5 N\", buff = { ultimate = \"8 N\" } }"), in_sense("buff"));
    assert_eq!(told("{ ultimate = \"9 N\" }"), Vec::<String>::new());
    assert_eq!(told("{ proof = \"1 N\" }"), Vec::<String>::new());
}

/// Two 130 t cars that meet at 6 mph on 11.1 MN/m press with 2.28 MN and pull as much half a swing later.
fn two_cars(coupler: &str, scenario: &str) -> String {
    format!(
        "[coupler]\nstiffness = \"11.1 MN/m\"\nrated_load = \"1 MN\"\nrated_buff = \"1.9 MN\"\n{coupler}\n[[vehicle]]\n
         mass = \"130 t\"\ncount = 2\n[[scenario]]\nname = \"they meet\"\nkind = \"impact\"\nat = \"tail\"\nvehicles = 1\n
         speed = \"6 mph\"\nhorizon = \"1 s\"\ncascade = true\n{scenario}"
    )
}

#[test]
fn a_cascade_breaks_at_the_ultimate_load_where_one_is_given() {
    let (both, draft) = ("buff_breaks = true", "");
    let cases = [
        ("", draft, Some(1e6), "rated_load"),
        ("limits = { proof = \"1.2 MN\" }", draft, Some(1e6), "rated_load"),
        ("limits = { ultimate = \"2 MN\" }", draft, Some(2e6), "ultimate"),
        ("limits = { ultimate = \"2.5 MN\" }", draft, None, "ultimate"),
        ("limits = { draft = { ultimate = \"1.5 MN\" } }", draft, Some(1.5e6), "ultimate"),
        ("limits = { buff = { ultimate = \"2 MN\" } }", draft, Some(1e6), "rated_load"),
        ("limits = { buff = { ultimate = \"2 MN\" } }", both, Some(-2e6), "ultimate"),
        ("limits = { draft = { ultimate = \"1.5 MN\" } }", both, Some(-1.9e6), "rated_buff"),
    ];
    for (coupler, scenario, force, key) in cases {
        let (_, analysis) = run(&two_cars(coupler, scenario));
        let cascade = analysis.scenarios[0].cases[0].cascade.clone().expect("a cascade");
        assert_eq!(cascade.breaks.len(), usize::from(force.is_some()), "{coupler} {scenario}");
        assert!(cascade.breaks_at.contains(&key), "{coupler} {scenario}: {:?}", cascade.breaks_at);
        for (b, force) in cascade.breaks.iter().zip(force) {
            assert!((b.force_n - force).abs() < cascade.error_bound_n + 1e-9, "{coupler} {scenario}: {b:?}");
            assert_eq!(b.breaks_at, key);
        }
    }
}

/// An override of the ultimate load counts for its coupler alone.
#[test]
fn the_worn_coupler_breaks() {
    let text = "[coupler]\nstiffness = \"11.1 MN/m\"\nrated_load = \"0.5 MN\"\nlimits = { ultimate = \"9 MN\" }\n[[vehicle]]\n
                mass = \"130 t\"\ncount = 12\n[[coupler_override]]\nat = 7\nlimits = { ultimate = \"0.9 MN\" }\n[[scenario]]\n
                kind = \"impact\"\nat = \"tail\"\nvehicles = 3\nspeed = \"6 mph\"\ncascade = true\n[[scenario]]\n
                name = \"a push\"\nkind = \"pulse\"\nat = \"tail\"\nforce = \"2 kN\"\nduration = \"1 s\"\n";
    let (train, analysis) = run(text);
    let case = &analysis.scenarios[0].cases[0];
    let cascade = case.cascade.clone().expect("a cascade");
    assert!(case.exceeding > 5, "many exceed their rating and do not break");
    assert_eq!(cascade.breaks.iter().map(|b| b.coupler).collect::<Vec<_>>(), [7]);
    assert_eq!(cascade.pieces, [[1, 7], [8, 12]]);
    // The verdict and the overview say so too.
    let report = markdown(&train, &analysis);
    let supposed =
        "**1 further coupler breaks (see \"What breaks next\"); the forces given here are computed as if none did. ";
    assert!(report.contains(supposed), "{report}");
    let rows: Vec<&str> = report.lines().filter(|l| l.starts_with('|')).take(4).collect();
    assert!(rows[0].ends_with("| limits passed | further couplers break |"), "{rows:?}");
    assert!(rows[2].ends_with("| ultimate by 1 coupler | 1 |") && rows[3].ends_with("|  |  |"), "{rows:?}");
}

#[test]
fn report_and_check_say_which_load_breaks() {
    let told = |coupler: &str, scenario: &str| {
        let (train, analysis) = run(&two_cars(coupler, scenario));
        (markdown(&train, &analysis), consist::describe(&train))
    };
    let (report, check) = told("limits = { ultimate = \"2 MN\" }", "");
    assert!(
        report.contains("A coupler breaks at its ultimate load.") && report.contains("in draft | ultimate load |"),
        "{report}"
    );
    let (kept, _) = told("limits = { ultimate = \"2 MN\", draft = { ultimate = \"9 MN\" } }", "");
    assert!(kept.contains("1 coupler of what is left passes the ultimate load in buff on the way"), "{kept}");
    assert!(check.contains("couplers that pass their ultimate load in draft break"), "{check}");
    let (report, check) = told("", "");
    assert!(report.contains("A coupler breaks at its rating, because no ultimate load was given."), "{report}");
    assert!(check.contains("couplers that pass their rating (no ultimate load is given) in draft break"), "{check}");
    let (report, check) = told("limits = { buff = { ultimate = \"2 MN\" } }", "buff_breaks = true");
    assert!(
        report.contains("breaks at its ultimate load, or at its rating where no ultimate load was given."),
        "{report}"
    );
    assert!(
        check.contains("their ultimate load, or their rating where none is given, in draft or buff break"),
        "{check}"
    );
}

/// No coupler of the shipped trains breaks below the ultimate load that its own limits give.
#[test]
fn the_shipped_trains_do_not_contradict_themselves() {
    for file in fs::read_dir("trains").expect("the folder of trains").map(|f| f.expect("an entry").path()) {
        let Some("toml") = file.extension().and_then(|e| e.to_str()) else { continue };
        let train = consist::read(&file).unwrap_or_else(|e| panic!("{e}"));
        assert!(doubts(&train).iter().all(|d| d.code != "limit-order"), "{}", file.display());
    }
}
