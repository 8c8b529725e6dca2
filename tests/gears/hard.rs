//! Hard cases: events at one instant, contacts that graze, masses and stiffnesses of very different size, no slack, slack without end.

use crate::gears::{curve, gear, gear_a, gear_a_dash, let_go, train, wedge};
use trainsafe::law::{Law, Rest};
use trainsafe::march::{MarchOptions, MarchOutcome, Problem, estimate_s, solve};

const M: f64 = 130e3;

fn run(problem: &Problem) -> MarchOutcome {
    let out = solve(problem, &MarchOptions { audit: true, ..MarchOptions::default() });
    let energy = out.energy.expect("asked for");
    let all = energy.start_j.abs() + energy.work_j.abs();
    assert!(energy.created_j <= 1e-12 * all, "{energy:?}");
    out
}

/// A train symmetric about its middle, pulled from both ends and let go: mirror images to the last bits, all events in pairs.
#[test]
fn events_at_one_instant() {
    let law = gear(2e8, 0.01, gear_a_dash());
    let problem = Problem { start: vec![law.rest(&[6e5]); 20], ..train(vec![M; 21], vec![law; 20], 10.0) };
    let out = run(&problem);
    for i in 0..10 {
        let (a, b) = (out.extremes[i], out.extremes[19 - i]);
        assert!((a.buff.force_n - b.buff.force_n).abs() < 1e-3, "{i}: {} {}", a.buff.force_n, b.buff.force_n);
        assert!((a.draft.force_n - b.draft.force_n).abs() < 1e-3);
    }
    assert!(out.events > 100);
}

/// A car that comes to a stand just at the end of the slack, short of it or past it by little, touches or does not.
#[test]
fn contacts_that_graze() {
    let law = Law::Elastic { draft_n_per_m: 17.9e6, buff_n_per_m: 17.9e6, slack_m: 0.02 };
    // Pushed back by a constant force: the farthest place is v^2 m / 2 f.
    for (more, touches) in [(-1e-9, false), (1e-9, true)] {
        let f = 1e4;
        let speed = (2.0 * f * 0.01f64 / M).sqrt() * (1.0 + more);
        let drive = trainsafe::forcing::Drive::rectangle(-f, 5.0);
        let problem = Problem {
            held_head: true,
            speed_m_s: vec![0.0, speed],
            forcing: vec![(1, drive)],
            ..train(vec![M; 2], vec![law.clone()], 0.6)
        };
        let out = run(&problem);
        assert_eq!(out.extremes[0].buff.force_n < -1e-6, touches, "{:?}", out.extremes[0]);
        assert!(out.extremes[0].buff.force_n > -10.0);
    }
}

/// A gear so tightly locked that it is a spring: the march of its solid stiffness.
#[test]
fn locked_for_good() {
    let law = gear(2e8, 0.0, curve(&[[0., 9000., -9000.], [100., 9900., -9000.]]));
    let spring = Law::Elastic { draft_n_per_m: 2e8, buff_n_per_m: 2e8, slack_m: 0.0 };
    let (a, b) = (run(&let_go(20, M, &law, &[6e5], 5.0)), run(&let_go(20, M, &spring, &[6e5], 5.0)));
    for (x, y) in a.extremes.iter().zip(&b.extremes) {
        assert!((x.buff.force_n - y.buff.force_n).abs() < 1e-6 && (x.draft.force_n - y.draft.force_n).abs() < 1e-6);
    }
}

/// Slack that no motion gets through is no coupler; next to none is none.
#[test]
fn slack_without_end_and_of_nothing() {
    let wide = Law::Elastic { draft_n_per_m: 17.9e6, buff_n_per_m: 17.9e6, slack_m: 1e6 };
    let out = run(&Problem { speed_m_s: vec![1.0, 0.0], ..train(vec![M; 2], vec![wide], 60.0) });
    assert_eq!((out.events, out.extremes[0].draft.force_n, out.end_speed_m_s[0]), (0, 0.0, 1.0));
    let last = |slack| run(&let_go(20, M, &wedge(17.9e6, 2e8, 0.5, slack, 1.0), &[6e5], 5.0)).extremes[3].buff.force_n;
    assert!((last(0.0) - last(1e-12)).abs() < 1.0, "{} {}", last(0.0), last(1e-12));
}

/// One vehicle of 1 kg, solid stiffnesses ten thousand times the gear's, a stop hit at 8 mph, an elastic rattle.
#[test]
fn unlike_sizes() {
    let light = |law: &Law| {
        let mut p = let_go(12, M, law, &[4e5], 0.5);
        p.mass_kg[6] = 1.0;
        p
    };
    run(&light(&gear(2e8, 0.01, gear_a_dash())));
    run(&let_go(6, M, &gear(18e10, 0.01, gear_a_dash()), &[4e5], 0.5));
    let law = gear(2e8, 0.01, gear_a());
    let speed_m_s = (0..12).map(|v| if v < 6 { 0.0 } else { 8.0 * 0.44704 }).collect();
    let out = run(&Problem { speed_m_s, ..train(vec![M; 12], vec![law.clone(); 11], 2.0) });
    assert!(out.extremes[5].buff.force_n < -5e6, "it bottoms");
    let kicked = (0..12).map(|v| 0.02 * f64::from(v % 2)).collect();
    let out = run(&Problem { speed_m_s: kicked, ..train(vec![M; 12], vec![law; 11], 20.0) });
    assert!(out.events > 100 && out.energy.is_some_and(|e| (e.start_j - e.end_j).abs() < 1e-9 * e.start_j));
}

/// Trains of one vehicle, and of nothing that moves.
#[test]
fn next_to_no_train() {
    let out = run(&train(vec![M], Vec::new(), 10.0));
    assert!(out.extremes.is_empty() && out.steps < 10);
    let law = gear(2e8, 0.01, gear_a_dash());
    let out = run(&train(vec![M; 3], vec![law.clone(); 2], 10.0));
    assert_eq!((out.events, out.extremes[1].draft.force_n), (0, 0.0));
    let held = Problem {
        held_head: true,
        held_tail: true,
        start: vec![law.rest(&[1e5])],
        ..train(vec![M; 2], vec![law], 10.0)
    };
    assert_eq!(run(&held).extremes[0].draft.force_n, 1e5);
    assert_eq!(Rest::default().force_n, 0.0);
}

/// The estimated time is that of the march to a factor of some ten.
#[test]
fn estimated_time() {
    let problem = let_go(60, M, &gear(2e8, 0.01, gear_a_dash()), &[6e5], 10.0);
    let ask = MarchOptions { tolerance_n: Some(1.0), ..MarchOptions::default() };
    assert!(estimate_s(&problem, &ask) > 2.9 * estimate_s(&problem, &MarchOptions::default()));
    let steps = solve(&problem, &MarchOptions::default()).steps as f64;
    let estimated = estimate_s(&problem, &MarchOptions::default()) / 61.0 / 100e-9;
    assert!(estimated > steps && estimated < 10.0 * steps, "{estimated} steps for {steps}");
}

/// A force on the middle vehicle of a train at rest moves both neighbours from the first step on: mirror images, and in a linear train
/// what the closed form of three vehicles says, `F = P / 3 (1 - cos(omega t))`, omega = sqrt(3 k / m), on either side.
#[test]
fn a_force_on_the_middle_of_a_train() {
    let k = 17.9e6;
    let law = Law::Elastic { draft_n_per_m: k, buff_n_per_m: k, slack_m: 0.0 };
    let push = 1e5;
    let forcing = vec![(1, trainsafe::forcing::Drive::rectangle(push, 9.0))];
    let problem = Problem { forcing, ..train(vec![M; 3], vec![law.clone(); 2], 1.0) };
    let times_s: Vec<f64> = (1..=20).map(|n| 0.05 * f64::from(n)).collect();
    let out =
        solve(&problem, &MarchOptions { history: vec![0, 1], times_s: times_s.clone(), ..MarchOptions::default() });
    for (n, t) in times_s.iter().enumerate() {
        let want = push / 3.0 * (1.0 - ((3.0 * k / M).sqrt() * t).cos());
        assert!((out.history[0][n] + want).abs() < 1e-9 && (out.history[1][n] - want).abs() < 1e-9, "{t}");
    }
    let forcing = vec![(20, trainsafe::forcing::Drive::Lines(vec![[0.0, 0.0], [0.2, push], [0.4, 0.0]]))];
    let problem = Problem { forcing, ..train(vec![M; 41], vec![gear(2e8, 0.0, gear_a_dash()); 40], 3.0) };
    let out = run(&problem);
    for i in 0..20 {
        let (ahead, behind) = (out.extremes[i], out.extremes[39 - i]);
        assert!((ahead.buff.force_n + behind.draft.force_n).abs() < 1e-6, "{i}: {ahead:?} {behind:?}");
        assert!((ahead.draft.force_n + behind.buff.force_n).abs() < 1e-6, "{i}: {ahead:?} {behind:?}");
    }
}

/// A load that is small beside the pulse: the motion is a thousand times as wide as what the couplers are stretched at rest, and every
/// contact is met in double precision of that. The report's variants are computed too.
#[test]
fn a_large_pulse_on_a_small_load() {
    for load in ["1 N", "1 kN", "-1 kN", "1157.85 N", "5 kN"] {
        for masses in ["25 t,42 t", "100 t,100 t", "25 t,42 t,30 t"] {
            let mut text =
                format!("[coupler]\nstiffness = \"30 MN/m\"\nrated_load = \"1 MN\"\n[load]\nuniform = \"{load}\"\n");
            masses.split(',').for_each(|mass| text += &format!("[[vehicle]]\nmass = \"{mass}\"\n"));
            text += "[[scenario]]\nkind = \"pulse\"\nat = \"tail\"\nforce = \"1 MN\"\nduration = \"5 s\"\nhorizon = \"1 s\"\n";
            let train = trainsafe::consist::parse(&text, "train.toml".as_ref()).expect("a train");
            let options = trainsafe::Options { damping: true, ..trainsafe::Options::default() };
            let analysis = trainsafe::analyze(&train, &options).expect("sound");
            assert!(!analysis.scenarios[0].variants.is_empty(), "{load}, {masses}");
        }
    }
}

/// Couplers that begin where two parts of their law meet: closed gears, and gears at the end of their slack. The runs with moved
/// constants begin there too, so that the estimate is no larger than the tolerance.
#[test]
fn couplers_begin_at_a_knot() {
    for file in ["closed.toml", "preload.toml"] {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/gears/at_knots").join(file);
        let train = trainsafe::consist::read(&path).expect("a train");
        let analysis = trainsafe::analyze(&train, &trainsafe::Options::default()).expect("sound");
        let case = &analysis.scenarios[0].cases[0];
        assert_eq!(case.undecided, 0, "{file}");
        for coupler in &case.couplers {
            assert!(coupler.error_estimate_n.is_some_and(|n| n <= case.tolerance_n), "{file}: {coupler:?}");
        }
    }
}
