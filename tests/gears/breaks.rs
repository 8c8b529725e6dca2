//! Partings, gaps that close again, brakes that bring a vehicle to a stand, and until when a motion can be told.

use crate::gears::{gear, gear_a_dash, let_go, train};
use trainsafe::forcing::Drive;
use trainsafe::law::{Law, Rest};
use trainsafe::march::{Bound, Brakes, MarchOptions, Problem, solve};

const M: f64 = 130e3;
const K: f64 = 17.9e6;

fn spring(slack_m: f64) -> Law {
    Law::Elastic { draft_n_per_m: K, buff_n_per_m: K, slack_m }
}

#[track_caller]
fn near(got: f64, want: f64, tolerance: f64) {
    assert!((got - want).abs() <= tolerance, "{got:.17} for {want:.17}: off by {:.1e}", got - want);
}

/// Two cars move apart until their coupler breaks; the rear one is pushed, the gap closes, and the heads push each other.
#[test]
fn breaks_and_meets_again() {
    let (mu, limit, push) = (M / 2.0, 4e5, 1e5);
    let omega = (K / mu).sqrt();
    let peak = (K * mu).sqrt();
    let at = (limit / peak).asin() / omega;
    // From 1 s on the rear car is pushed; apart at 1 m/s sqrt(1 - (limit / peak)^2).
    let apart = (1.0 - (limit / peak).powi(2)).sqrt();
    let gap = limit / K + apart * (1.0 - at);
    let a = push / M;
    let closes = 1.0 + (apart + (apart * apart + 2.0 * a * gap).sqrt()) / a;
    let speed = (apart * apart + 2.0 * a * gap).sqrt();
    let problem = Problem {
        speed_m_s: vec![1.0, 0.0],
        break_at_n: vec![[limit, f64::INFINITY]],
        forcing: vec![(1, Drive::Lines(vec![[1.0, 0.0], [1.0, push], [99.0, push]]))],
        ..train(vec![M; 2], vec![spring(0.0)], closes + 0.2)
    };
    let out = solve(&problem, &MarchOptions { audit: true, ..MarchOptions::default() });
    assert_eq!((out.partings.len(), out.partings[0].coupler), (1, 0));
    near(out.partings[0].time_s, at, 1e-15);
    near(out.partings[0].force_n, limit, 1e-9);
    near(out.extremes[0].draft.force_n, limit, 1e-9);
    near(out.closures[0].1, closes, 1e-13);
    // Pushed by a constant force as well: k (x - x0)^2 = mu v^2 + k x0^2, with k x0 = push mu / m.
    let rest = push * mu / M;
    near(out.extremes[0].buff.force_n, -(rest + (rest * rest + K * mu * speed * speed).sqrt()), 1e-7);
    let energy = out.energy.expect("asked for");
    near(energy.released_j, limit * limit / 2.0 / K, 1e-9);
    assert!(energy.created_j < 1e-9, "{energy:?}");
}

/// A coupler that parts under compression goes on pushing: nothing happens at all.
#[test]
fn parted_under_compression() {
    for law in [spring(0.0), spring(0.02), gear(2e8, 0.02, gear_a_dash())] {
        let start = vec![law.rest(&[-3e5]); 3];
        let steady_n = vec![-3e5, 0.0, 0.0, 3e5];
        let problem = Problem { start, steady_n, gone: vec![1], ..train(vec![M; 4], vec![law; 3], 10.0) };
        let out = solve(
            &problem,
            &MarchOptions { history: vec![0, 1, 2], times_s: vec![5.0, 10.0], ..MarchOptions::default() },
        );
        for values in &out.history {
            values.iter().for_each(|f| near(*f, -3e5, 1e-9));
        }
        assert!(out.closures.is_empty());
    }
}

/// What breaks in compression keeps pushing; only a pull opens it.
#[test]
fn breaks_in_buff() {
    let problem = Problem {
        speed_m_s: vec![0.0, 1.0],
        break_at_n: vec![[1e9, 4e5]],
        ..train(vec![M; 2], vec![spring(0.01)], 1.0)
    };
    let out = solve(&problem, &MarchOptions::default());
    let whole = solve(&Problem { break_at_n: Vec::new(), ..problem }, &MarchOptions::default());
    near(out.extremes[0].buff.force_n, whole.extremes[0].buff.force_n, 1e-9);
    assert_eq!((out.partings.len(), out.extremes[0].draft.force_n), (1, 0.0));
    assert!(whole.extremes[0].draft.force_n > 1e6);
}

/// Two cars roll at 2 m/s; the pipe opens between them, and the whole brake acts as the wave is there.
#[test]
fn brakes_to_a_stand() {
    for sign in [1.0, -1.0] {
        let brakes = Brakes {
            wave_m_s: 250.0,
            build_up: vec![[0.0, 1.0], [1.0, 1.0]],
            full_n: vec![30e3, 45e3],
            length_m: vec![10.0, 8.0],
        };
        let problem = Problem {
            gone: vec![0],
            emergency: Some(brakes),
            common_speed_m_s: Some(2.0 * sign),
            ..train(vec![M; 2], vec![spring(0.0)], 60.0)
        };
        let out = solve(&problem, &MarchOptions::default());
        // Moving forward the front car runs away from the rear one, and brakes less: the rear one stops first.
        let (vehicle, time) = out.stopped.expect("one stops");
        if sign > 0.0 {
            near(time, 4.0 / 250.0 + 2.0 * M / 45e3, 1e-13);
            assert_eq!((vehicle, out.closures.len()), (1, 0));
        } else {
            // Backward the front car follows the rear one, which brakes more: they meet.
            assert!(!out.closures.is_empty());
        }
    }
}

/// Slack alone is chaotic; with gears the same train can be told to the end.
#[test]
fn until_when_it_can_be_told() {
    let ask = MarchOptions { tolerance_n: Some(6e5 * 1e-6), ..MarchOptions::default() };
    let problem = |law: &Law| Problem { mark_s: 10.0, ..let_go(105, M, law, &[6e5], 40.0) };
    let out = solve(&problem(&spring(0.025)), &ask);
    let until = out.predictable_until_s.expect("it is lost");
    assert!((20.0..39.0).contains(&until), "{until}");
    let latest = out.extremes.iter().flat_map(|e| [e.draft.time_s, e.buff.time_s]).fold(0.0, f64::max);
    assert!(latest <= until);
    assert!(matches!(out.bound, Bound::Estimated(e) if e < 1.0), "{:?}", out.bound);
    let to_mark = out.error_to_mark_n.iter().flatten().copied().fold(0.0, f64::max);
    assert!(to_mark < 1e-3, "{to_mark}");
    let out = solve(&problem(&gear(2e8, 0.025, gear_a_dash())), &ask);
    assert_eq!(out.predictable_until_s, None);
    assert!(matches!(out.bound, Bound::Estimated(e) if e < 1e-2), "{:?}", out.bound);
}

/// A slider without slack is proven: another run with other couplers' memory moved by a unit stays within.
#[test]
fn proven_with_constant_friction() {
    let h = 18e6;
    let row = |w: f64| trainsafe::law::GearRow { travel_m: w, loading_n: h * w + 5e4, unloading_n: h * w - 5e4 };
    let curve = trainsafe::law::Curve::new(vec![row(0.0), row(0.3)]).expect("a slider");
    let law = gear(2e8, 0.0, curve);
    let out =
        solve(&let_go(50, M, &law, &[6e5], 20.0), &MarchOptions { tolerance_n: Some(1.0), ..MarchOptions::default() });
    let Bound::Proven(bound) = out.bound else { panic!("{:?}", out.bound) };
    assert!(bound < 1e-2 && out.events > 500, "{bound} {}", out.events);
    // A start that is not at rest on the curve by some units: sqrt(W) of it, 1e-6 N on every coupler, is far over the rounding.
    let start: Vec<Rest> = (0..50).map(|i| law.rest(&[6e5 + 1e-6 * (i % 3) as f64, 6e5])).collect();
    let near = solve(&Problem { start, ..let_go(50, M, &law, &[6e5], 20.0) }, &MarchOptions::default());
    let apart = |(a, b): (&trainsafe::march::Extremes, &trainsafe::march::Extremes)| {
        (a.draft.force_n - b.draft.force_n).abs().max((a.buff.force_n - b.buff.force_n).abs())
    };
    let off = out.extremes.iter().zip(&near.extremes).map(apart).fold(0.0, f64::max);
    println!("bound {bound:e}, apart {off:e}");
    assert!(off < 1e-5 + 2.0 * bound, "{off}");
}

/// A slider holds a coupler that is pulled out of compression; one that has parted cannot be held, for its heads only push.
#[test]
fn parted_heads_do_not_pull() {
    let law = gear(2e8, 0.0, crate::gears::curve(&[[0., 200., -200.], [100., 1200., 800.]]));
    let pulled = |gone: Vec<usize>| {
        let start = vec![law.rest(&[-2.5e5])];
        let steady_n = vec![-2.5e5, 2.5e5];
        let apart = Drive::Lines(vec![[0.1, 0.0], [0.5, 3.5e5], [9.0, 3.5e5]]);
        let forcing = vec![(0, apart.clone()), (1, apart.scaled(1.0, -1.0))];
        let problem = Problem { start, steady_n, forcing, gone, ..train(vec![M; 2], vec![law.clone()], 1.0) };
        solve(&problem, &MarchOptions { audit: true, ..MarchOptions::default() })
    };
    assert!(pulled(Vec::new()).extremes[0].draft.force_n > 1e5);
    let parted = pulled(vec![0]);
    assert_eq!(parted.extremes[0].draft.force_n, 0.0);
    assert!(parted.end_speed_m_s[0] > parted.end_speed_m_s[1] + 0.1, "they part: {:?}", parted.end_speed_m_s);
    assert!(parted.energy.is_some_and(|e| e.created_j < 1e-9), "{:?}", parted.energy);
}

/// What a parting gives up, and how well its instant is known: a spring all that it holds, a gear what it would have given back, and
/// nothing where the vehicles go on pushing each other.
#[test]
fn energy_and_instant_of_a_parting() {
    let limit = 4e5;
    let part = |law: Law, speed: f64, break_at_n: [f64; 2]| {
        let speed_m_s = vec![speed, 0.0];
        let problem = Problem { speed_m_s, break_at_n: vec![break_at_n], ..train(vec![M; 2], vec![law], 0.5) };
        solve(&problem, &MarchOptions { tolerance_n: Some(1.0), ..MarchOptions::default() }).partings[0]
    };
    let elastic = part(spring(0.0), 1.0, [limit, f64::INFINITY]);
    let at = (limit / (K * M / 2.0).sqrt()).asin() / (2.0 * K / M).sqrt();
    near(elastic.energy_j, limit * limit / 2.0 / K, 1e-9);
    assert!((elastic.time_s - at).abs() <= elastic.uncertainty_s && elastic.uncertainty_s < 1e-12, "{elastic:?}");
    // Under the unloading curve up to the travel at the breaking load, and in what is in series.
    let gear = part(gear(2e8, 0.0, gear_a_dash()), 1.0, [limit, f64::INFINITY]);
    let travel = 7e-3 + 31e-3 * (limit - 120e3) / 560e3;
    let back = 60e3 + 112e3 * (travel - 7e-3) / 31e-3;
    let given = 0.5 * 60e3 * 7e-3 + 0.5 * (60e3 + back) * (travel - 7e-3) + limit * limit / 2.0 / 2e8;
    near(gear.energy_j, given, 1e-8);
    assert!(gear.uncertainty_s < 1e-12);
    let pushing = part(spring(0.0), -1.0, [f64::INFINITY, limit]);
    assert_eq!((pushing.energy_j, pushing.force_n < 0.0), (0.0, true));
}
