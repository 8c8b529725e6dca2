//! Bounds and safe factors against values that owe nothing to the solvers: closed forms, rational arithmetic, 60 digits.

use std::path::Path;

use trainsafe::findings::CaseFindings;
use trainsafe::{Options, Train, analyze, consist};

fn train(name: &str) -> Train {
    consist::read(&Path::new("tests/bounds").join(name)).unwrap_or_else(|e| panic!("{e}"))
}

fn case(train: &Train, options: &Options) -> CaseFindings {
    analyze(train, options).expect("a train that can be analysed").scenarios.remove(0).cases.remove(0)
}

fn pulsed(load: &str, force: &str, rest: &str) -> Train {
    let text = format!(
        "[coupler]\nstiffness = \"30 MN/m\"\nrated_load = \"1 MN\"\n[[vehicle]]\ncount = 2\nmass = \"100 t\"\n[load]\nuniform = \
         \"{load}\"\n[[scenario]]\nkind = \"pulse\"\nat = \"head\"\nforce = \"{force}\"\nduration = \"20 s\"\nhorizon = \"1 s\"\n{rest}"
    );
    consist::parse(&text, Path::new("two.toml")).unwrap_or_else(|e| panic!("{e}"))
}

/// Two equal vehicles: `F = F(0) + f P (1 - cos w t) / 2`, whose top is `F(0) + f P`.
#[test]
fn the_safe_factor_counts_a_sense_without_a_peak() {
    let factor = |train: &Train| case(train, &Options::default()).safe_load_factor.expect("bounded");
    let near = |found: f64, due: f64| assert!((found / due - 1.0).abs() < 1e-9, "{found} {due}");
    near(factor(&train("1-safe-factor-of-a-side-not-yet-seen.toml")), 13.0);
    near(factor(&pulsed("-300 kN", "100 kN", "")), 13.0);
    near(factor(&pulsed("300 kN", "-100 kN", "")), 13.0);
    near(factor(&pulsed("-300 kN", "-100 kN", "")), 7.0);
    near(factor(&pulsed("-900 kN", "200 kN", "")), 9.5);
    assert_eq!(case(&pulsed("-300 kN", "1300.01 kN", ""), &Options::default()).exceeding, 1);
    assert_eq!(case(&pulsed("-300 kN", "1299.99 kN", ""), &Options::default()).exceeding, 0);
    // A map's smallest force is the same factor, times the force, at durations over half a period.
    let options = Options { map: true, ..Options::default() };
    let analysis = analyze(&pulsed("-300 kN", "100 kN", ""), &options).expect("a map");
    let points = &analysis.scenarios[0].map.as_ref().expect("a map").points;
    let least = points.iter().filter_map(|p| p.chain).fold(f64::INFINITY, f64::min);
    assert!(least <= 1.3e6 * (1.0 + 1e-9), "{least}");
}

/// The reported bound holds at a loose tolerance: what the search leaves undone is in it.
#[test]
fn the_bound_holds_what_the_search_leaves_undone() {
    let train = train("2-peak-off-by-more-than-the-bound-at-a-loose-tolerance.toml");
    let case = case(&train, &Options { tolerance: 2.017e-4, ..Options::default() });
    let peak = case.couplers[3].peak_draft_n.expect("in draft");
    assert!((peak - 7224.827050712401).abs() <= case.error_bound_n, "{peak} +- {}", case.error_bound_n);
}

/// Of two vehicles the force that a lasting push reaches is `2 P m2 / (m1 + m2)`, and no bound over all time lies below it.
#[test]
fn a_bound_over_all_time_is_never_below_a_force_that_is_reached() {
    let options = Options { verdict_only: true, all_time_bound: true, ..Options::default() };
    let found = case(&train("7-all-time-bound-a-rounding-too-low.toml"), &options);
    assert_eq!(found.left_out, 0, "the rating is the double below the force that is reached");
    let mut number = 20_260_101u64;
    let mut draw = || {
        number = number.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (number >> 11) as f64 * f64::exp2(-53.0)
    };
    for _ in 0..60 {
        let [m1, m2, p] = [10.0 + 90.0 * draw(), 10.0 + 90.0 * draw(), 100.0 + 900.0 * draw()];
        let text = format!(
            "[coupler]\nstiffness = \"20 MN/m\"\nrated_load = \"9 MN\"\n[[vehicle]]\nmass = \"{m1} t\"\n[[vehicle]]\nmass = \
             \"{m2} t\"\n[[scenario]]\nkind = \"pulse\"\nat = \"head\"\nforce = \"{p} kN\"\nduration = \"100 s\"\nhorizon = \"2 s\"\n"
        );
        let train = consist::parse(&text, Path::new("two.toml")).unwrap_or_else(|e| panic!("{e}"));
        let options = Options { all_time_bound: true, ..Options::default() };
        let bound = case(&train, &options).couplers[0].all_time_bound_n.expect("asked for");
        let reached = 2.0 * p * 1e3 * m2 / (m1 + m2);
        assert!(bound >= reached * (1.0 - 4.0 * f64::EPSILON) && bound < reached * (1.0 + 1e-13), "{bound} {reached}");
    }
}

/// Peaks whose exact values are known to 20 digits and more lie within the stated bound of them.
#[test]
fn peaks_at_hard_instants_are_within_their_bounds() {
    let near = |name: &str, coupler: usize, draft: bool, due: f64| {
        let case = case(&train(name), &Options::default());
        let c = &case.couplers[coupler - 1];
        let peak = if draft { c.peak_draft_n } else { c.peak_buff_n }.expect("a peak");
        // The value that is due is itself rounded to a double.
        let room = case.error_bound_n + 0.5 * f64::EPSILON * due.abs();
        assert!((peak - due).abs() <= room, "{name}: {peak} for {due}, bound {}", case.error_bound_n);
        case.couplers[coupler - 1].exceeds
    };
    // After a pulse with a damping ratio, at two horizons.
    near("3-damping-ratio-after-a-pulse-times-are-rounded.toml", 4, true, 1_399_451.498_810_379);
    near("3-damping-ratio-after-a-pulse-times-are-rounded-long.toml", 3, true, 749_049.922_788_397_5);
    // A rise that ends at the horizon, over the rating by 8e-8 N.
    let exceeds = near("4-modal-misses-what-lies-at-the-horizon.toml", 3, true, 1_999_903.710_604_579_5);
    assert_ne!(exceeds, Some(false));
    // A mode that turns 6e11 times a second.
    near("11-peaks-of-very-fast-modes-are-taken-at-doubles.toml", 1, false, -683_229.367_304_102);
}

/// A rating three bounds above the peak is not "within the bound of the peak".
#[test]
fn a_rating_three_bounds_away_is_decided() {
    let case = case(&train("10-undecided-three-bounds-from-the-rating.toml"), &Options::default());
    assert_eq!(case.couplers[4].exceeds, Some(false), "bound {}", case.error_bound_n);
}

/// A coupler that comes within the bound of its rating and is turned round by the break of another one is not torn with it.
///
/// The instants of the breaks are of modal sums in 40 digits and of a matrix exponential in 75; the coupler that is turned round
/// stays 1.4e-7 N (the first train) and 2e-8 N (the others) under its rating.
#[test]
fn a_coupler_that_another_break_relieves_is_not_torn_with_it() {
    for (name, coupler, other, due_s) in [
        ("5-cascade-breaks-two-together-that-do-not.toml", 2, 3, 0.407_461_287_502_283_1),
        ("5-turned-round-by-a-break-1.toml", 2, 3, 0.168_634_606_111_050_14),
        ("5-turned-round-by-a-break-2.toml", 2, 1, 0.289_775_107_993_981_9),
        ("5-turned-round-by-a-break-3.toml", 2, 1, 0.399_449_448_331_126_46),
        ("5-turned-round-by-a-break-4.toml", 3, 2, 0.285_549_548_369_975_9),
    ] {
        let case = case(&train(name), &Options::default());
        let cascade = case.cascade.expect("a cascade");
        let [only] = &cascade.breaks[..] else { panic!("{name}: {:?}", cascade.breaks) };
        assert_eq!((only.coupler, only.together, cascade.undecided_coupler), (coupler, false, Some(other)), "{name}");
        // The time that is due is itself rounded.
        assert!((only.time_s - due_s).abs() <= only.time_uncertainty_s + f64::EPSILON * due_s, "{name}: {only:?}");
        let from = cascade.undecided_from_s.expect("not decided");
        assert!((from - due_s).abs() < 1e-6, "{name}: {from}");
        assert!(cascade.error_bound_n < 1e-3, "{name}: {}", cascade.error_bound_n);
    }
}

/// Couplers at their rating that are pushed on break at once or are told as undecided from the start; one that is relieved breaks
/// when it comes back, and no sooner.
#[test]
fn couplers_at_their_rating_are_in_the_sequence() {
    let from = |train: &Train| case(train, &Options::default()).cascade.expect("a cascade").undecided_from_s;
    for name in ["", "-long"] {
        let found = case(
            &train(&format!("6-cascade-says-nothing-of-couplers-at-their-rating{name}.toml")),
            &Options::default(),
        );
        let cascade = found.cascade.expect("a cascade");
        let at_once = cascade.breaks.len() == found.couplers.len() && cascade.breaks.iter().all(|b| b.time_s < 1e-3);
        assert!(cascade.undecided_from_s == Some(0.0) || at_once, "{cascade:?}");
    }
    assert_eq!(from(&pulsed("1 MN", "1e-10 N", "cascade = true")), Some(0.0));
    assert_eq!(from(&pulsed("-1 MN", "-1e-9 N", "cascade = true\nbuff_breaks = true")), Some(0.0));
    assert_eq!(from(&pulsed("1 MN", "1e-9 N", "cascade = true\nshape = \"half-sine\"")), Some(0.0));
    // It swings to 800 kN and comes back to just its rating.
    let relieved = pulsed("1 MN", "-200 kN", "cascade = true");
    let period_s = std::f64::consts::TAU / f64::sqrt(2.0 * 30e6 / 100e3);
    let back = from(&relieved).expect("it comes back");
    assert!((back - period_s).abs() < 1e-6, "{back} {period_s}");
    // Pushed on by as much as can be told, it breaks at once.
    let pushed = case(&pulsed("1 MN", "200 kN", "cascade = true"), &Options::default()).cascade.expect("a cascade");
    assert_eq!((pushed.breaks.len(), pushed.undecided_from_s), (1, None));
    assert!(pushed.breaks[0].time_s < 1e-6 && pushed.breaks[0].time_uncertainty_s < 1e-6);
}
