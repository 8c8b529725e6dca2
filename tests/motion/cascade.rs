//! Cascades and impacts from the train file to the report.

use std::fs;
use std::path::Path;

use trainsafe::findings::CouplerFindings;
use trainsafe::{Analysis, Options, Train, analyze, consist, report};

fn run(text: &str) -> (Train, Analysis) {
    let train = consist::parse(text, Path::new("a.toml")).unwrap_or_else(|e| panic!("{e}"));
    let analysis = analyze(&train, &Options::default()).expect("sound");
    (train, analysis)
}

fn two_cars(more: &str) -> String {
    format!(
        "[coupler]\nstiffness = \"11.1 MN/m\"\nrated_load = \"1 MN\"\nrated_buff = \"1.9 MN\"\n[[vehicle]]\nlabel = \"car\"\n
         mass = \"130 t\"\ncount = 2\n[[scenario]]\nname = \"they meet\"\nkind = \"impact\"\nat = \"tail\"\nvehicles = 1\n
         speed = \"6 mph\"\nhorizon = \"1 s\"\n{more}"
    )
}

/// Two 130 t cars that meet at 6 mph on 11.1 MN/m press with v sqrt(k m / 2) = 2.28 MN a quarter of a period after they meet; at
/// which share of the speed they would bear it; and they part in draft, or already in buff if that is said to part them.
#[test]
fn two_cars_meet_and_part() {
    let (v, k, m) = (6.0 * 0.44704, 11.1e6, 130e3);
    let force = v * f64::sqrt(k * m / 2.0);
    let swing = f64::sqrt(2.0 * k / m);
    let (_, kept) = run(&two_cars(""));
    let case = &kept.scenarios[0].cases[0];
    assert_eq!((kept.scenarios[0].kind, case.method, case.exceeding), ("impact", "taylor", 1));
    assert!((case.couplers[0].peak_buff_n.expect("pressed") + force).abs() < case.error_bound_n + 1e-9);
    // The same force in draft half a swing later, where the rating is lower.
    assert!((case.safe_load_factor.expect("bounded") - 1e6 / force).abs() < 1e-12);
    assert!(case.cascade.is_none());
    for (more, rating, from) in
        [("cascade = true", 1e6, std::f64::consts::PI / swing), ("cascade = true\nbuff_breaks = true", -1.9e6, 0.0)]
    {
        let (_, parted) = run(&two_cars(more));
        let cascade = parted.scenarios[0].cases[0].cascade.as_ref().expect("a cascade");
        let [only] = &cascade.breaks[..] else { panic!("{cascade:?}") };
        let expected = from + (f64::abs(rating) / force).asin() / swing;
        // The expected time rounds a few times itself.
        assert!((only.time_s - expected).abs() <= only.time_uncertainty_s + 1e-15, "{only:?} {expected}");
        assert!((only.force_n - rating).abs() < cascade.error_bound_n + 1e-9);
        assert!((only.energy_j / (rating * rating / (2.0 * k)) - 1.0).abs() < 1e-12);
        assert_eq!((cascade.pieces.as_slice(), cascade.undecided_from_s), (&[[1, 1], [2, 2]][..], None));
    }
}

/// A coupler over its rating in buff is kept by default, and the report says so; without a cascade it says nothing of one.
#[test]
fn what_is_kept_in_buff_is_said() {
    let strong = two_cars("cascade = true").replace("\"1 MN\"", "\"9 MN\"");
    let (train, analysis) = run(&strong);
    let cascade = analysis.scenarios[0].cases[0].cascade.as_ref().expect("a cascade");
    assert_eq!((cascade.breaks.len(), cascade.kept_in_buff.as_slice()), (0, &[1][..]));
    let text = markdown(&train, &analysis);
    let expected = "**What breaks next.** No further coupler breaks; the train stays whole. 1 coupler of what is left passes the \
                    rating in buff on the way, which does not part a coupler here.";
    assert!(text.contains(expected), "{text}");
    assert!(
        !text.contains("is reported and does not break: the calculation goes on with it")
            && !text.contains("figure-1-cascade")
    );
    let (train, analysis) = run(&two_cars(""));
    let text = markdown(&train, &analysis);
    assert!(
        text.contains("is reported and does not break: the calculation goes on with it")
            && !text.contains("What breaks next")
    );
}

/// What the load alone breaks, and what the event breaks, leaves no doubt about the sequence; nor does a load that is a rating.
#[test]
fn what_is_gone_at_once_is_decided() {
    let train = |rated: &str, load: &str, event: &str| {
        let text = format!(
            "[coupler]\nstiffness = \"15 MN/m\"\nrated_load = \"700 kN\"\n[[vehicle]]\nmass = \"120 t\"\n[[vehicle]]\ncount = 8\n\
             mass = \"80 t\"\n[load]\nuniform = \"{load}\"\n[[coupler_override]]\nat = 4\nrated_load = \"{rated}\"\n[[scenario]]\n\
             {event}\ncascade = true\n"
        );
        let case = run(&text).1.scenarios.remove(0).cases.remove(0);
        let cascade = case.cascade.expect("a cascade");
        let breaks: Vec<(usize, f64)> = cascade.breaks.iter().map(|b| (b.coupler, b.time_s)).collect();
        (breaks, cascade.undecided_from_s)
    };
    let pulse = "kind = \"pulse\"\nat = \"tail\"\nforce = \"-1 kN\"\nduration = \"1 s\"";
    let impact = "kind = \"impact\"\nat = \"tail\"\nvehicles = 2\nspeed = \"1 km/h\"";
    let of = |coupler: usize| format!("kind = \"break\"\ncoupler = {coupler}");
    assert_eq!(train("300 kN", "400 kN", &of(4)), (vec![], None));
    for event in [&of(2), pulse, impact] {
        assert_eq!(train("300 kN", "400 kN", event), (vec![(4, 0.0)], None), "{event}");
    }
    // All stand at their rating; only those beside the break, or at the ends of the parts, are pushed on later.
    let (breaks, undecided_s) = train("700 kN", "700 kN", &of(4));
    assert_eq!((breaks.iter().map(|b| b.0).collect::<Vec<_>>(), undecided_s), (vec![1, 8], None));
    assert!((breaks[0].1 - 0.493_411_9).abs() < 1e-6 && (breaks[1].1 - 0.533_862_9).abs() < 1e-6, "{breaks:?}");
}

/// Every coupler's largest forces in a cascade, of springs by Taylor series and of gears by the march: a coupler that its load breaks
/// at once, under a pulse of next to nothing, leaves the forces that its break as the event leaves.
#[test]
fn forces_of_the_pieces_are_told() {
    let gear =
        "gear = [[\"0 mm\", \"0 kN\", \"0 kN\"], [\"1 m\", \"30 MN\", \"30 MN\"]]\nsolid_stiffness = \"30 MN/m\"";
    let mut chained: Vec<Vec<[f64; 2]>> = vec![];
    for law in ["stiffness = \"15 MN/m\"", gear] {
        let text = |event: &str| {
            format!(
                "[coupler]\n{law}\nrated_load = \"2 MN\"\n[[vehicle]]\nmass = \"120 t\"\n[[vehicle]]\ncount = 8\nmass = \"80 t\"\n[load]\n\
                 uniform = \"400 kN\"\n[[coupler_override]]\nat = 4\nrated_load = \"300 kN\"\n[[scenario]]\nhorizon = \"1.5 s\"\n{event}\n"
            )
        };
        let pulse = "kind = \"pulse\"\nat = \"tail\"\nforce = \"-1e-9 N\"\nduration = \"0.1 s\"\ncascade = true";
        let (train, analysis) = run(&text(pulse));
        let case = &analysis.scenarios[0].cases[0];
        let cascade = case.cascade.as_ref().expect("a cascade");
        assert_eq!(cascade.breaks.iter().map(|b| (b.coupler, b.time_s)).collect::<Vec<_>>(), [(4, 0.0)], "{law}");
        let broken = run(&text("kind = \"break\"\ncoupler = 4")).1.scenarios.remove(0).cases.remove(0);
        assert_eq!(broken.couplers.len(), 7);
        let within_n = 1e-6 + 2.0 * (cascade.error_n() + broken.error_n());
        for b in &broken.couplers {
            let c = &case.couplers[b.coupler - 1];
            let found = c.cascade.as_ref().expect("its forces in the cascade");
            let near = |a: Option<f64>, b: Option<f64>| (a.unwrap_or(0.0) - b.unwrap_or(0.0)).abs() < within_n;
            assert!(
                near(found.peak_buff_n, b.peak_buff_n) && near(found.peak_draft_n, b.peak_draft_n),
                "{b:?} {found:?}"
            );
            assert_eq!(c.peak_buff_n, None, "the event alone brings no buff");
            assert_eq!(found.exceeds, b.exceeds);
            assert_eq!(found.error_estimate_n.is_some(), law == gear);
        }
        assert!(broken.couplers.iter().filter(|b| b.peak_buff_n.is_some()).count() >= 4, "{broken:?}");
        let of_4 = case.couplers[3].cascade.as_ref().expect("up to its break");
        assert_eq!((of_4.peak_draft_n, of_4.peak_draft_time_s, of_4.exceeds), (Some(4e5), Some(0.0), Some(true)));
        let worst = broken.worst.expect("a worst coupler");
        let [told, most] = [cascade.worst.map(|w| w.utilisation), Some(4.0 / 3.0)];
        assert!(
            told == most && worst.utilisation < 4.0 / 3.0 && cascade.exceeding == broken.exceeding + 1,
            "{cascade:?}"
        );
        let shown = markdown(&train, &analysis);
        assert!(
            shown.contains("| 4 | vehicle 4, vehicle 5 | 400.0 kN in draft | 300 kN | 133 % (breaks) | 0 s | 133 % |"),
            "{shown}"
        );
        let mut csv = vec![];
        report::csv(&analysis, &mut csv).expect("written");
        let csv = String::from_utf8(csv).expect("text");
        assert!(
            csv.starts_with("scenario,")
                && csv.contains(",cascade_peak_buff_n,cascade_peak_buff_time_s,cascade_exceeds"),
            "{csv}"
        );
        let weak =
            run(&text(pulse).replace("2 MN", "450 kN").replace("1.5 s", "0.8 s")).1.scenarios.remove(0).cases.remove(0);
        let cascade = weak.cascade.expect("a cascade");
        assert_eq!(cascade.breaks.iter().map(|b| b.coupler).collect::<Vec<_>>(), [4, 1, 8], "{law}");
        assert_eq!((cascade.gap_coupler, cascade.gap_closures.len()), (None, 0));
        let peaks = |c: &CouplerFindings| {
            let found = c.cascade.as_ref().expect("its forces in the cascade");
            [found.peak_draft_n, found.peak_buff_n].map(|n| n.unwrap_or(0.0))
        };
        chained.push(weak.couplers.iter().map(peaks).collect());
    }
    // The gear's law is that of the spring.
    let off =
        chained[0].iter().flatten().zip(chained[1].iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-6, "{off}");
}

/// The sequence stands in the report in its order, with its figure.
#[test]
fn the_sequence_is_told() {
    let (train, analysis) = run(&two_cars("cascade = true"));
    let text = markdown(&train, &analysis);
    assert!(text.contains("| 1 | car 1, car 2 | 1.000 MN in draft | rating | 45.05 kJ |"), "{text}");
    assert!(text.contains("](figure-1-cascade.svg)") && text.contains("vehicles 1, 2."), "{text}");
}

fn markdown(train: &Train, analysis: &Analysis) -> String {
    let dir = tempfile::tempdir().expect("a folder");
    report::write(train, analysis, dir.path(), &report::Format::ALL).expect("written");
    assert_eq!(
        dir.path().join("figure-1-cascade.svg").exists(),
        analysis.scenarios[0].cases[0].cascade.as_ref().is_some_and(|c| !c.breaks.is_empty())
    );
    fs::read_to_string(dir.path().join("report.md")).expect("a report")
}

/// A force that a file gives over time is the trapezoid that it draws; both and a rectangle of the same force are told apart.
#[test]
fn a_record_is_what_it_draws() {
    let dir = tempfile::tempdir().expect("a folder");
    fs::write(dir.path().join("pulse.csv"), "time (ms),force (kN)\n0,0\n20,-500\n80,-500\n120,0\n").expect("written");
    let text = |pulse: &str| {
        format!(
            "[coupler]\nstiffness = \"30 MN/m\"\nrated_load = \"1 MN\"\n[[vehicle]]\nmass = \"80 t\"\ncount = 12\n[[scenario]]\n
             kind = \"pulse\"\nat = \"tail\"\n{pulse}"
        )
    };
    let peaks = |pulse: &str| {
        let train = consist::parse(&text(pulse), &dir.path().join("a.toml")).unwrap_or_else(|e| panic!("{e}"));
        let analysis = analyze(&train, &Options::default()).expect("sound");
        let case = &analysis.scenarios[0].cases[0];
        case.couplers.iter().map(|c| (c.peak_force_n, c.peak_time_s)).collect::<Vec<_>>()
    };
    let drawn = "force = \"-500 kN\"\nduration = \"120 ms\"\nshape = \"trapezoid\"\nrise = \"20 ms\"\nfall = \"40 ms\"";
    let (record, drawn) = (peaks("record = \"pulse.csv\""), peaks(drawn));
    for (a, b) in record.iter().zip(&drawn) {
        // Times in ms and in s round differently; a peak is flat, so that its time knows half of the digits.
        assert!((a.0 - b.0).abs() < 1e-7 && (a.1 - b.1).abs() < 1e-6, "{a:?} {b:?}");
    }
    let rectangle = peaks("force = \"-500 kN\"\nduration = \"120 ms\"");
    assert!(record.iter().zip(&rectangle).all(|(a, b)| (a.0 - b.0).abs() > 1e3));
}

/// Where sums over modes solve the break at once and the march of its cascade would take over an hour, the analysis is refused.
#[test]
fn a_cascade_of_hours_is_refused() {
    let text = "[coupler]\nstiffness = \"30 MN/m\"\nrated_load = \"9 MN\"\n[[vehicle]]\nmass = \"100 t\"\ncount = 60\n\
                [[coupler_override]]\nat = 30\nstiffness = \"3e19 N/m\"\n[load]\nuniform = \"0.1 MN\"\n[[scenario]]\nkind = \"break\"\n\
                coupler = 59\ncascade = true\n";
    let train = consist::parse(text, Path::new("a.toml")).unwrap_or_else(|e| panic!("{e}"));
    let refused = analyze(&train, &Options::default()).expect_err("hours").to_string();
    assert!(
        refused.contains("the method taylor would take about") && refused.contains("a shorter horizon"),
        "{refused}"
    );
}
