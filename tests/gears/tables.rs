//! Largest forces of trains let go, in shares of their pull: published digits of two marches of 53 and one of 64 bits with other steps.

// Reference numbers are given with all their digits.
#![allow(clippy::excessive_precision)]

use crate::gears::{gear, gear_a, gear_a_dash, let_go, train, verlet, wedge};
use trainsafe::forcing::Drive;
use trainsafe::law::{Curve, GearRow, Law};
use trainsafe::march::{Bound, Brakes, MarchOptions, MarchOutcome, Problem, solve};

/// The largest force after the break in shares of the pull, negative in buff.
fn worst(problem: &Problem, pull: f64) -> f64 {
    let out = solve(problem, &MarchOptions::default());
    let of = |e: &trainsafe::march::Extremes| [e.draft.force_n, e.buff.force_n];
    let largest = out.extremes.iter().flat_map(of).filter(|f| f.abs() > pull * (1.0 + 1e-9) || *f < 0.0);
    largest.fold(0.0f64, |a, b| if b.abs() > a.abs() { b } else { a }) / pull
}

#[track_caller]
fn row(wanted: &[f64], digits: f64, problem: impl Fn(usize) -> (Problem, f64)) {
    for (n, want) in wanted.iter().enumerate().filter(|(_, w)| !w.is_nan()) {
        let (problem, pull) = problem(n);
        let got = worst(&problem, pull);
        println!("{want} {got:.12}");
        assert!((got.abs() - want).abs() <= digits, "{got:.12} for {want} in column {n}");
    }
}

const FRICTION: [f64; 6] = [0.0, 0.1, 0.25, 0.5, 0.75, 0.87];
/// Half a unit of the eighth digit after the point.
const EIGHT: f64 = 0.51e-8;

fn figure_4(slack: f64, wanted: &[f64]) {
    row(wanted, EIGHT, |n| {
        let horizon = if FRICTION[n] == 0.0 { 200.0 } else { 400.0 };
        (let_go(50, 1.0, &wedge(1.0, 18.0, FRICTION[n], slack, 1e3), &[1.0], horizon), 1.0)
    });
}

#[test]
fn figure_4_with_friction() {
    figure_4(0.0, &[1.50835270, 1.35712243, 1.16298186, 0.98542227, 0.81490943, 0.67197181]);
}

#[test]
#[ignore = "takes long: --ignored runs all tables"]
fn figure_4_with_slack() {
    figure_4(0.25, &[1.85120274, 1.32163698, 0.91996974, 0.80286021, 0.72164222, 0.64751126]);
    figure_4(0.5, &[1.88766100, 1.56698370, 1.15767705, 0.77741065, 0.60958304, 0.58246973]);
    figure_4(1.0, &[1.73611485, 1.38981665, 1.18126842, 0.91277490, 0.57205311, 0.47216430]);
    figure_4(2.0, &[f64::NAN, 1.17185751, 1.15867306, 0.93977966, 0.71186693, 0.44056347]);
}

/// The present figure through the new march, without slack and friction: 14 digits.
#[test]
fn figure_4_itself() {
    let law = Law::Elastic { draft_n_per_m: 1.0, buff_n_per_m: 1.0, slack_m: 0.0 };
    for law in [law, wedge(1.0, 18.0, 0.0, 0.0, 1e3)] {
        let out = solve(&let_go(50, 1.0, &law, &[1.0], 60.0), &MarchOptions::default());
        let buff =
            out.extremes.iter().map(|e| e.buff).min_by(|a, b| a.force_n.total_cmp(&b.force_n)).expect("50 couplers");
        assert!((buff.force_n + 1.47279347663338).abs() < 1e-14, "{:.16}", buff.force_n);
        assert!((buff.time_s - 54.9374086688489).abs() < 1e-13, "{:.16}", buff.time_s);
        assert!(matches!(out.bound, Bound::Proven(b) if b < 3e-11), "{:?}", out.bound);
    }
}

fn cars(law: &Law, pulls: &[f64], horizon: f64) -> (Problem, f64) {
    (let_go(105, 130e3, law, pulls, horizon), *pulls.last().expect("a pull"))
}

/// Unloading a share under the loading curve.
fn with_friction(c: &Curve, share: f64) -> Curve {
    let row = |r: &GearRow| GearRow { unloading_n: (1.0 - share) * r.loading_n, ..*r };
    Curve::new(c.rows().iter().map(row).collect()).expect("a table")
}

fn of_gear(c: &Curve, slacks: [f64; 3], wanted: [f64; 3]) {
    row(&wanted, EIGHT, |n| cars(&gear(2e8, slacks[n], c.clone()), &[6e5], 40.0));
}

#[test]
fn friction_gears() {
    let slacks = [0.0, 0.01, 0.025];
    of_gear(&gear_a_dash(), slacks, [0.86782652, 0.85415364, 0.65792147]);
    of_gear(&gear_a_dash(), [0.05; 3], [0.65599648, f64::NAN, f64::NAN]);
    of_gear(&gear_a(), slacks, [0.83408166, 0.83638773, 0.84746905]);
}

#[test]
#[ignore = "takes long: --ignored runs all tables"]
fn shares_of_friction() {
    let (shares, slacks) = ([0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8], [0.0, 0.01, 0.025]);
    let none = [1.34300224, 1.19138934, 1.07672046, 1.02782926, 1.00540512, 0.95286516, 0.77718756];
    let mm_25 = [1.49541322, 1.31791479, 1.14604950, 1.01266416, 0.83109957, 0.70602908, 0.57563577];
    for ((share, none), mm_25) in shares.into_iter().zip(none).zip(mm_25) {
        let law = |slack| wedge(17.9e6, 2e8, share, slack, 1.0);
        row(&[none, mm_25], EIGHT, |n| cars(&law([0.0, 0.025][n]), &[6e5], 40.0));
    }
    let half =
        gear_a().rows().iter().map(|r| GearRow { unloading_n: 0.5 * (r.loading_n + r.unloading_n), ..*r }).collect();
    of_gear(&Curve::new(half).expect("a table"), slacks, [1.29763475, f64::NAN, 1.11515227]);
}

#[test]
#[ignore = "takes long: --ignored runs all tables"]
fn without_friction() {
    let spring = |slack_m| Law::Elastic { draft_n_per_m: 17.9e6, buff_n_per_m: 17.9e6, slack_m };
    row(&[1.52875604], EIGHT, |_| cars(&spring(0.0), &[6e5], 40.0));
    row(&[1.99786483], EIGHT, |_| cars(&spring(0.01), &[6e5], 16.5));
    let elastic = with_friction(&gear_a(), 0.0);
    row(&[1.27657239], EIGHT, |_| cars(&gear(2e8, 0.0, elastic.clone()), &[6e5], 40.0));
    row(&[1.60442563], EIGHT, |_| cars(&gear(2e8, 0.025, elastic.clone()), &[6e5], 20.5));
    // The last digit is one of those that a chaotic motion has lost.
    row(&[1.87995382], 2e-8, |_| cars(&spring(0.025), &[6e5], 30.0));
}

#[test]
fn damped() {
    for (share, want) in [(0.05, 1.02554796), (0.14, 1.0), (0.26, 1.0)] {
        let law = Law::Elastic { draft_n_per_m: 17.9e6, buff_n_per_m: 17.9e6, slack_m: 0.0 };
        let dashpot = 2.0 * share * (17.9e6f64 * 130e3).sqrt();
        let (problem, pull) = cars(&law, &[6e5], 40.0);
        let out = solve(&Problem { dashpot_n_s_per_m: vec![dashpot; 105], ..problem }, &MarchOptions::default());
        let largest = out.extremes.iter().flat_map(|e| [e.draft.force_n, -e.buff.force_n]).fold(0.0, f64::max) / pull;
        assert!((largest - want).abs() < EIGHT, "{largest:.12} for {want}");
    }
}

/// A preload of 60 kN in each gear: its first row loads at 60 kN, and unloads at a force that published digits for this train, 0.69442373,
/// do not name. By what that force is the largest force after the break goes from 0.650 to 0.719; no reading that was tried gives theirs
/// (the first row unloading at 0, 5, ... 60 kN; all forces 60 kN larger, or those of loading; forces at least 60 kN; the table cut
/// below 60 kN; the preload in draft or in buff alone). Verlet with a clamp, which shares nothing with the march, agrees with it to the
/// thousandth that its steps allow.
#[test]
fn a_preload() {
    for (unloading_n, want) in [(0.0, 0.6630497244), (30e3, 0.6496348983), (60e3, 0.7191731733)] {
        let mut rows = gear_a_dash().rows().to_vec();
        (rows[0].loading_n, rows[0].unloading_n) = (60e3, unloading_n);
        let (problem, pull) = cars(&gear(2e8, 0.025, Curve::new(rows).expect("a table")), &[6e5], 40.0);
        let got = worst(&problem, pull);
        assert!((got + want).abs() < EIGHT, "{got:.12} for {want}");
        if unloading_n == 60e3 {
            let by_verlet = verlet(&problem, 400_000).iter().map(|e| e[1]).fold(0.0, f64::min) / pull;
            assert!((by_verlet - got).abs() < 1e-3, "{by_verlet:.6} by Verlet, {got:.6}");
        }
    }
}

/// Let down to 0.6 MN from an earlier pull.
#[test]
#[ignore = "takes long: --ignored runs all tables"]
fn history() {
    let pulls = [0.6, 0.7, 0.8, 0.9, 1.0, 1.2];
    let with_slack = [0.658, 0.740, 0.916, 1.050, 1.062, 1.364];
    let without = [0.868, 0.978, 1.118, 1.219, 1.289, 1.412];
    for (slack, wanted) in [(0.025, with_slack), (0.0, without)] {
        row(&wanted, 0.51e-3, |n| cars(&gear(2e8, slack, gear_a_dash()), &[pulls[n] * 1e6, 6e5], 40.0));
    }
}

/// Locomotives of 392 t pull 105 cars that resist equally; the coupler behind car 30 parts.
fn hauled(law: &Law, dashpot: f64, emergency: bool) -> Problem {
    let mass: Vec<f64> = [392e3].into_iter().chain([130e3; 105]).collect();
    let pull = |i: usize| 6e5 * (105 - i) as f64 / 105.0;
    let brakes = Brakes {
        wave_m_s: 290.0,
        build_up: vec![[0.0, 0.0], [1.5, 0.3], [8.0, 1.0]],
        full_n: [0.0].into_iter().chain([45e3; 105]).collect(),
        length_m: vec![16.2; 106],
    };
    Problem {
        start: (0..105).map(|i| law.rest(&[pull(i)])).collect(),
        steady_n: [6e5].into_iter().chain([-6e5 / 105.0; 105]).collect(),
        gone: vec![30],
        dashpot_n_s_per_m: vec![dashpot; 105],
        emergency: emergency.then_some(brakes),
        ..train(mass, vec![law.clone(); 105], 40.0)
    }
}

/// Largest draft of the front part, largest buff and draft of the rear part, after the break.
fn parts(out: &MarchOutcome) -> [f64; 3] {
    let largest = |r: std::ops::Range<usize>, f: &dyn Fn(usize) -> f64| r.map(f).fold(0.0, f64::max) / 6e5;
    let draft = |i: usize| out.extremes[i].draft.force_n;
    [largest(0..30, &draft), largest(31..105, &|i| -out.extremes[i].buff.force_n), largest(31..105, &draft)]
}

/// Front draft, rear buff without brakes; the same with brakes.
#[test]
fn parting_of_a_hauled_train() {
    let spring = |slack_m| Law::Elastic { draft_n_per_m: 17.9e6, buff_n_per_m: 17.9e6, slack_m };
    let dashpot = 2.0 * 0.14 * (17.9e6f64 * 130e3).sqrt();
    let trains = [
        (spring(0.0), 0.0, [1.263, 0.846, 1.448, 1.233]),
        (spring(0.0), dashpot, [1.001, 0.599, 1.223, 1.180]),
        (gear(2e8, 0.0, gear_a_dash()), 0.0, [1.006, 0.365, 1.150, 1.074]),
        (gear(2e8, 0.025, gear_a_dash()), 0.0, [1.007, 0.452, 1.152, 1.370]),
    ];
    for (law, dashpot, want) in trains {
        let quiet = solve(&hauled(&law, dashpot, false), &MarchOptions::default());
        let braked = solve(&hauled(&law, dashpot, true), &MarchOptions::default());
        let got = [parts(&quiet), parts(&braked)];
        let got = [got[0][0], got[0][1], got[1][0], got[1][1]];
        assert!(got.iter().zip(want).all(|(g, w)| (g - w).abs() < 0.51e-3), "{got:?} for {want:?}");
    }
}

/// Slower waves, faster and slower cylinders, and locomotives that cut their power, with gears and 25 mm of slack.
#[test]
#[ignore = "takes long: --ignored runs all tables"]
fn variants_of_the_brake_wave() {
    let law = gear(2e8, 0.025, gear_a_dash());
    let rear = |wave_m_s: f64, third_s: f64, full_s: f64| {
        let problem = hauled(&law, 0.0, true);
        let build_up = vec![[0.0, 0.0], [third_s, 0.3], [full_s, 1.0]];
        let emergency = problem.emergency.clone().map(|e| Brakes { wave_m_s, build_up, ..e });
        parts(&solve(&Problem { emergency, ..problem }, &MarchOptions::default()))[1]
    };
    assert!((rear(250.0, 1.5, 8.0) - 1.432).abs() < 0.51e-3);
    assert!((rear(290.0, 1.5, 18.0) - 1.129).abs() < 0.51e-3);
    // The published figure does not tell when the cylinders are at 30 %: here at the same share of the time.
    assert!((rear(290.0, 0.75, 4.0) - 1.736).abs() < 1e-3);
    let cut = Drive::Lines(vec![[3.0, 0.0], [5.0, -6e5], [99.0, -6e5]]);
    let front =
        parts(&solve(&Problem { forcing: vec![(0, cut)], ..hauled(&law, 0.0, true) }, &MarchOptions::default()))[0];
    assert!((front - 1.080).abs() < 0.51e-3);
}
