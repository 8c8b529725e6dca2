//! Impacts on a train that carries a load: each part starts from its own, and the forces that make it go on acting.

use std::path::Path;

use trainsafe::doubts::doubts;
use trainsafe::findings::{CaseFindings, history};
use trainsafe::{Options, Train, analyze, consist};

const COUPLER: &str = "[coupler]\nstiffness = \"11.1 MN/m\"\nrated_load = \"1.5 MN\"\nrated_buff = \"1.5 MN\"\n";

/// A locomotive, 20 cars and a cut of 3 that arrives at 5 mph.
fn struck(load: &str, held: bool, rest: &str) -> String {
    format!(
        "{COUPLER}[[vehicle]]\nmass = \"196 t\"\nheld = {held}\n[[vehicle]]\ncount = 23\nmass = \"100 t\"\n{load}
         [[scenario]]\nkind = \"impact\"\nat = \"tail\"\nvehicles = 3\nspeed = \"5 mph\"\nhorizon = \"2 s\"\n{rest}"
    )
}

fn parse(text: &str) -> Train {
    consist::parse(text, Path::new("train.toml")).unwrap_or_else(|e| panic!("{e}"))
}

fn case(train: &Train) -> CaseFindings {
    analyze(train, &Options::default()).expect("sound").scenarios.remove(0).cases.remove(0)
}

fn codes(train: &Train) -> Vec<&'static str> {
    doubts(train).iter().map(|d| d.code).collect()
}

/// Under uniform loads forces are those of the unloaded train and the load, but for the joining coupler, number 21, which
/// carries none of it.
#[test]
fn a_uniform_load_is_added_in_both_parts() {
    let unloaded = case(&parse(&struck("", true, "")));
    assert!((unloaded.couplers[20].peak_buff_n.expect("buff") + 1.731e6).abs() < 1e3);
    for load_n in [-0.9e6, -0.3e6, 0.45e6] {
        let train = parse(&struck(&format!("[load]\nuniform = \"{load_n} N\""), true, ""));
        let loaded = case(&train);
        let rounding = 1e-4 + loaded.error_bound_n + unloaded.error_bound_n;
        for (with, without) in loaded.couplers.iter().zip(&unloaded.couplers) {
            let own_n = if with.coupler == 21 { 0.0 } else { load_n };
            assert_eq!(with.initial_force_n, own_n);
            let expected = |peak: Option<f64>| peak.unwrap_or(0.0) + own_n;
            let buff = expected(without.peak_buff_n);
            assert!((with.peak_buff_n.unwrap_or(0.0) - buff.min(0.0)).abs() < rounding, "{with:?} {buff}");
            let draft = expected(without.peak_draft_n);
            assert!((with.peak_draft_n.unwrap_or(0.0) - draft.max(0.0)).abs() < rounding, "{with:?} {draft}");
        }
        // The load stays and the rest grows with the speed.
        let factor = |c: &trainsafe::findings::CouplerFindings| {
            let room = c.rated_buff_n + c.initial_force_n;
            c.peak_buff_n.map(|peak| room / (c.initial_force_n - peak))
        };
        let least = loaded.couplers.iter().filter_map(factor).fold(f64::INFINITY, f64::min);
        assert!((loaded.safe_load_factor.expect("bounded") / least - 1.0).abs() < 1e-9);
    }
    // A coupler in the standing part: 1.617 MN of the blow and 0.9 MN of load.
    let loaded = case(&parse(&struck("[load]\nuniform = \"-0.9 MN\"", true, "")));
    let worst = loaded.worst.expect("couplers");
    assert_eq!(worst.coupler, 20);
    assert!((worst.peak_force_n + 2.517e6).abs() < 1e3);
    assert_eq!(worst.between, ["vehicle 20", "vehicle 21"]);
}

/// A load over the rating is over it at t = 0, in both parts but not between them, and nothing says that no coupler exceeds.
#[test]
fn a_load_over_the_rating_exceeds_before_the_blow() {
    for load in ["-1.6 MN", "-2 MN", "1.51 MN"] {
        let train = parse(&struck(&format!("[load]\nuniform = \"{load}\""), true, ""));
        let found = case(&train);
        for c in &found.couplers {
            assert_eq!(c.first_exceeds_s == Some(0.0), c.coupler != 21, "{c:?}");
        }
        assert_eq!(found.safe_load_factor, Some(0.0));
        assert!(codes(&train).contains(&"load-over-rating"));
        let analysis = analyze(&train, &Options::default()).expect("sound");
        let told = trainsafe::report::terminal(&analysis, &[]);
        assert!(told.contains("before anything happens, under the load alone"), "{told}");
    }
    // Over the rating in the whole train's statics, but in neither part: the pull of the head stops at the gap.
    let text = format!(
        "{COUPLER}[[vehicle]]\nmass = \"100 t\"\ntractive_effort = \"1.8 MN\"\n[[vehicle]]\ncount = 8\nmass = \"100 t\"\n
         [[scenario]]\nkind = \"impact\"\nat = \"tail\"\nvehicles = 7\nspeed = \"0.1 m/s\""
    );
    let train = parse(&text);
    assert!(train.initial_force_n()[0] > 1.5e6);
    let found = case(&train);
    assert_eq!(found.couplers[0].initial_force_n, 0.9e6, "1.8 MN over two cars");
    assert!(!codes(&train).contains(&"load-over-rating"));
}

/// Two vehicles that nothing but outside forces p moves, m1 standing and m2 arriving at v, and what they do once coupled:
///
/// ```text
/// F = F* (1 - cos w t) - (k v / w) sin w t      w^2 = k (1/m1 + 1/m2)      F* = (p1/m1 - p2/m2) / (1/m1 + 1/m2)
/// ```
#[test]
fn two_vehicles_under_forces_by_the_closed_form() {
    let (m1, m2, k): (f64, f64, f64) = (100e3, 60e3, 11.1e6);
    for (p1, p2, v) in [(300e3, 0.0, 0.8), (-250e3, -90e3, 1.1), (0.0, 400e3, 0.5), (500e3, -500e3, 0.05)] {
        let text = format!(
            "[coupler]\nstiffness = \"{k} N/m\"\nrated_load = \"1.5 MN\"\nrated_buff = \"1.2 MN\"\n
             [[vehicle]]\nmass = \"{m1} kg\"\ntractive_effort = \"{p1} N\"\n
             [[vehicle]]\nmass = \"{m2} kg\"\ntractive_effort = \"{p2} N\"\n
             [[scenario]]\nkind = \"impact\"\nat = \"tail\"\nvehicles = 1\nspeed = \"{v} m/s\"\nhorizon = \"1 s\""
        );
        let found = case(&parse(&text));
        let per_mass = 1.0 / m1 + 1.0 / m2;
        let (omega, steady) = ((k * per_mass).sqrt(), (p1 / m1 - p2 / m2) / per_mass);
        let swing = |factor: f64| steady.hypot(factor * k * v / omega);
        let [only] = &found.couplers[..] else { panic!("{found:?}") };
        assert_eq!(only.initial_force_n, 0.0);
        // 1 mN in 1 MN: the comparison's own rounding.
        let near = |found: Option<f64>, right: f64| (found.unwrap_or(0.0) - right).abs() < 1e-3;
        assert!(near(only.peak_draft_n, steady + swing(1.0)), "{only:?}");
        assert!(near(only.peak_buff_n, steady - swing(1.0)), "{only:?}");
        // steady + swing = 1.5 MN or swing - steady = 1.2 MN, whichever comes first.
        let factor = |level: f64| (level * level - steady * steady).max(0.0).sqrt() / (k * v / omega);
        let right = factor(1.5e6 - steady).min(factor(1.2e6 + steady));
        let safe = found.safe_load_factor.expect("bounded");
        assert!((safe / right - 1.0).abs() < 1e-8, "{safe}, right {right}");
    }
    // At rest the pull alone is too much: 2 F* = 2 MN.
    let text = format!(
        "{COUPLER}[[vehicle]]\nmass = \"100 t\"\ntractive_effort = \"2 MN\"\n[[vehicle]]\nmass = \"100 t\"\n
         [[scenario]]\nkind = \"impact\"\nat = \"tail\"\nvehicles = 1\nspeed = \"0.1 m/s\"\nhorizon = \"1 s\""
    );
    assert_eq!(case(&parse(&text)).safe_load_factor, Some(0.0));
}

/// Forces of a chain of vehicles by Runge and Kutta's fourth-order steps from Newton's law and nothing else.
///
/// ```text
/// m_v x_v'' = F_{v-1} - F_v + p_v      F_i = F_i(0) + k_i (x_i - x_{i+1})      x = 0 at contact; a held vehicle keeps its speed
/// ```
fn newton(mass: &[f64], held: [bool; 2], k: f64, p: &[f64], before: &[f64], speed: &[f64], until_s: f64) -> Vec<f64> {
    let (n, steps) = (mass.len(), 40_000);
    let h = until_s / f64::from(steps);
    let force = |x: &[f64], i: usize| before[i] + k * (x[i] - x[i + 1]);
    let rate = |s: &[f64]| -> Vec<f64> {
        let (x, v) = s.split_at(n);
        let accelerate = |j: usize| {
            let [ahead, behind] =
                [j.checked_sub(1).map_or(0.0, |i| force(x, i)), if j + 1 < n { force(x, j) } else { 0.0 }];
            let live = !(j == 0 && held[0] || j + 1 == n && held[1]);
            if live { (ahead - behind + p[j]) / mass[j] } else { 0.0 }
        };
        v.iter().copied().chain((0..n).map(accelerate)).collect()
    };
    let mut s: Vec<f64> = vec![0.0; n].into_iter().chain(speed.iter().copied()).collect();
    for _ in 0..steps {
        let ahead = |r: &[f64], h: f64| s.iter().zip(r).map(|(s, r)| s + h * r).collect::<Vec<f64>>();
        let a = rate(&s);
        let b = rate(&ahead(&a, 0.5 * h));
        let c = rate(&ahead(&b, 0.5 * h));
        let d = rate(&ahead(&c, h));
        s = (0..2 * n).map(|i| s[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i])).collect();
    }
    (0..n - 1).map(|i| force(&s[..n], i)).collect()
}

/// Parts whose accelerations differ: one held and one free, two free, the held one arriving, and both held. The loads before
/// are from each part's own balance, by hand.
#[test]
fn parts_of_different_acceleration_by_newtons_law() {
    struct Sample {
        at: &'static str,
        held: [bool; 2],
        effort_n: [f64; 5],
        before_n: [f64; 4],
        speed: [f64; 5],
    }
    // Vehicles of 80 t; two arrive at 1.5 m/s.
    let samples = [
        // Held head; cars 2 and 3 braked by 50 and 30 kN: the head pulls 80 kN. The two that arrive: 60 kN at the first, none at
        // the second, so that the coupler between them drags 30 kN.
        Sample {
            at: "tail",
            held: [true, false],
            effort_n: [0.0, -50e3, -30e3, 60e3, 0.0],
            before_n: [80e3, 30e3, 0.0, 30e3],
            speed: [0.0, 0.0, 0.0, 1.5, 1.5],
        },
        // Free: 90 kN on the first of three that stand; -40 kN on the last of two that arrive.
        Sample {
            at: "tail",
            held: [false, false],
            effort_n: [90e3, 0.0, 0.0, 0.0, -40e3],
            before_n: [60e3, 30e3, 0.0, 20e3],
            speed: [0.0, 0.0, 0.0, 1.5, 1.5],
        },
        // The held head arrives, backward, with a car that is pushed on by 70 kN backward.
        Sample {
            at: "head",
            held: [true, false],
            effort_n: [0.0, -70e3, 0.0, 45e3, 0.0],
            before_n: [70e3, 0.0, -15e3, 15e3],
            speed: [-1.5, -1.5, 0.0, 0.0, 0.0],
        },
        // Both ends held.
        Sample {
            at: "tail",
            held: [true, true],
            effort_n: [0.0, 20e3, -10e3, 35e3, 0.0],
            before_n: [-10e3, 10e3, 0.0, 35e3],
            speed: [0.0, 0.0, 0.0, 1.5, 1.5],
        },
    ];
    for Sample { at, held, effort_n, before_n, speed } in samples {
        let vehicle = |v: usize| {
            let held = v == 0 && held[0] || v == 4 && held[1];
            let own = if held { "held = true".to_owned() } else { format!("tractive_effort = \"{} N\"", effort_n[v]) };
            format!("[[vehicle]]\nmass = \"80 t\"\n{own}\n")
        };
        let vehicles: String = (0..5).map(vehicle).collect();
        let train = parse(&format!(
            "{COUPLER}{vehicles}[[scenario]]\nkind = \"impact\"\nat = \"{at}\"\nvehicles = 2\nspeed = \"1.5 m/s\"\nhorizon = \"1 s\""
        ));
        let found = case(&train);
        for (c, before) in found.couplers.iter().zip(before_n) {
            assert!((c.initial_force_n - before).abs() < 1e-9, "{at} {held:?}: {} for {before}", c.initial_force_n);
        }
        for until_s in [0.1, 0.37, 0.9] {
            let right = newton(&[80e3; 5], held, 11.1e6, &effort_n, &before_n, &speed, until_s);
            for (i, right) in right.into_iter().enumerate() {
                let ours = history(&train, 0, None, i, &[until_s])[0];
                // Fourth-order steps of at most 2.3e-5 s at 24 rad/s: 1e-14 a step; rounding of 4e4 steps.
                assert!((ours - right).abs() < 1e-2, "{at} {held:?} coupler {}: {ours}, right {right}", i + 1);
                let c = &found.couplers[i];
                let [low, high] = [c.peak_buff_n.unwrap_or(0.0), c.peak_draft_n.unwrap_or(0.0)];
                assert!(low - 1e-2 <= right && right <= high + 1e-2, "{c:?} {right}");
            }
        }
        assert!(found.error_bound_n < 1e-3, "{}", found.error_bound_n);
    }
}

/// Cars that roll freely on one grade have one acceleration: no coupler carries a force, and the impact is that of level track.
#[test]
fn a_free_train_on_a_grade_is_struck_as_on_the_level() {
    let (level, graded) =
        (case(&parse(&struck("", false, ""))), case(&parse(&struck("[load]\ngrade = \"1 %\"", false, ""))));
    for (a, b) in level.couplers.iter().zip(&graded.couplers) {
        assert_eq!(
            (a.initial_force_n, a.peak_force_n, a.peak_time_s),
            (b.initial_force_n, b.peak_force_n, b.peak_time_s)
        );
    }
    assert_eq!(level.safe_load_factor, graded.safe_load_factor);
}

/// In a cascade the load over a rating breaks its coupler at t = 0; under it, it counts from the start.
#[test]
fn a_cascade_starts_from_the_load() {
    let weak = "cascade = true\n[[coupler_override]]\nat = 5\nrated_load = \"0.3 MN\"";
    for (load, at_once) in [("0.4 MN", true), ("0.29 MN", false)] {
        let found = case(&parse(&struck(&format!("[load]\nuniform = \"{load}\""), true, weak)));
        let cascade = found.cascade.expect("asked for");
        let first = cascade.breaks.first();
        assert_eq!(first.is_some_and(|b| b.coupler == 5 && b.time_s == 0.0), at_once, "{first:?}");
    }
}

/// What is told of the load names the parts.
#[test]
fn the_load_of_an_impact_is_told_by_parts() {
    let train = parse(&struck("[load]\nuniform = \"-0.9 MN\"", true, ""));
    let told = consist::describe(&train);
    assert!(
        told.contains("before an impact each part carries its own load, and the coupler that joins them none"),
        "{told}"
    );
    let analysis = analyze(&train, &Options::default()).expect("sound");
    let report = trainsafe::report::json(&analysis).expect("JSON");
    assert!(report.contains("\"initial_force_n\": -900000.0"));
}
