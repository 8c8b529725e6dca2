//! Closed forms of trains with slack, gears, stops and brake waves, computed with 40 digits apart from this code. Tolerances are some tens
//! of units in the last place of the largest force, and for instants of a root what that makes of them.

// Reference numbers are given with all their digits.
#![allow(clippy::excessive_precision)]

use crate::gears::{curve, gear, gear_a, let_go, train, wedge};
use trainsafe::forcing::Drive;
use trainsafe::law::{Law, Rest};
use trainsafe::march::{MarchOptions, MarchOutcome, Problem, solve};

const M: f64 = 130e3;
const K: f64 = 17.9e6;
const MPH: f64 = 0.44704;

fn spring(k: f64, slack_m: f64) -> Law {
    Law::Elastic { draft_n_per_m: k, buff_n_per_m: k, slack_m }
}

/// A capacity of next to nothing in both senses: the first instants at which couplers carry a force. Of what is left of an event,
/// a stiffness times 1e-15 m, it is some ten times; the instants are late by the capacity over stiffness and speed.
fn contacts(problem: &Problem, capacity: f64) -> MarchOutcome {
    solve(
        problem,
        &MarchOptions { capacity_n: vec![[capacity; 2]; problem.laws.len()], audit: true, ..MarchOptions::default() },
    )
}

fn forces(problem: &Problem, times: &[f64]) -> Vec<Vec<f64>> {
    let history = (0..problem.laws.len()).collect();
    solve(problem, &MarchOptions { history, times_s: times.to_vec(), ..MarchOptions::default() }).history
}

#[track_caller]
fn near(got: f64, want: f64, tolerance: f64) {
    assert!((got - want).abs() <= tolerance, "{got:.18} for {want:.18}: off by {:.1e}", got - want);
}

/// Two vehicles of given masses, the second arrives at a speed.
fn pair(law: Law, speed: f64, start: Rest, horizon: f64) -> Problem {
    Problem { speed_m_s: vec![0.0, speed], start: vec![start], ..train(vec![M; 2], vec![law], horizon) }
}

#[test]
fn two_cars_close_a_gap() {
    let out = contacts(&pair(spring(K, 0.025), 1.0, Rest::default(), 0.3), 1e-6);
    let buff = out.extremes[0].buff;
    near(buff.force_n, -1078656.5718522276727, 1e-9);
    near(buff.time_s, 0.10715641234294160366, 1e-9);
    near(out.first_over_s[0][1].expect("they meet"), 0.0125, 1e-13);
    near(out.first_over_s[0][0].expect("through the slack"), 0.0125 + 0.18931282468588320731 + 0.025, 1e-13);
}

#[test]
fn bouncing_for_a_minute() {
    let problem = pair(spring(K, 0.025), 1.0, Rest::default(), 60.0);
    let (half, lasts) = (0.21431282468588320731, 0.18931282468588320731);
    let times: Vec<f64> = (0..280).map(|n| 0.0125 + n as f64 * half + 0.5 * lasts).collect();
    let out =
        solve(&problem, &MarchOptions { history: vec![0], times_s: times, audit: true, ..MarchOptions::default() });
    for (n, f) in out.history[0].iter().enumerate() {
        // In the middle of a contact the force is flat.
        near(f.abs(), 1078656.5718522276727, 1e-6);
        assert_eq!(*f < 0.0, n % 2 == 0, "contact {n}");
    }
    // 280 contacts begin within a minute, the last at 59.806 s, and end.
    assert_eq!(out.events, 560);
    assert!(out.energy.expect("asked for").created_j < 1e-9);
}

/// Gear A to 0.6 MN and back: what comes back of the energy.
#[test]
fn one_cycle() {
    let law = gear(2e8, 1.0, gear_a());
    let speed = (2.0 * 10885.714285714285714f64 / M).sqrt();
    let start = Rest { force_n: 0.0, travel_m: 0.5 };
    let problem = Problem {
        held_head: true,
        start: vec![start],
        speed_m_s: vec![0.0, -speed],
        ..train(vec![M; 2], vec![law], 1.0)
    };
    let out = solve(&problem, &MarchOptions { audit: true, ..MarchOptions::default() });
    near(out.extremes[0].draft.force_n, 6e5, 1e-8);
    let energy = out.energy.expect("asked for");
    near(energy.end_j, 5100.7346938775510204, 1e-9);
    near(energy.start_j - energy.end_j, 5784.9795918367346939, 1e-9);
}

/// A spring and a slider in series: yields, slips, stops, leaves.
#[test]
fn elastic_and_plastic() {
    let law = gear(20e6, 0.0, curve(&[[0., 200., -200.], [900., 200., -200.]]));
    let problem =
        Problem { held_head: true, speed_m_s: vec![0.0, 0.5], ..train(vec![M; 2], vec![law], 0.46169390427909194217) };
    let times = [0.01, 0.020211025883458079246, 0.2, 0.33505225571208138244, 0.46169390427909194217];
    let force = &forces(&problem, &times)[0];
    near(force[0], -2e5 * (0.01 * (20e6 / M).sqrt()).sin() * 0.5 * (20e6 * M).sqrt() / 2e5, 1e-9);
    for (n, want) in [(1, -2e5), (2, -2e5), (3, -2e5), (4, 0.0)] {
        near(force[n], want, 1e-8);
    }
    let out = solve(&problem, &MarchOptions::default());
    near(out.end_speed_m_s[1], -0.12403473458920845619, 1e-15);
}

/// A car on a wall, let go: every turn of a spring beside a slider.
#[test]
fn hardening_with_friction() {
    let law = gear(2e8, 0.0, curve(&[[0., 100., -100.], [100., 1900., 1700.]]));
    let problem = let_go(1, M, &law, &[1.18e6], 1.65);
    let times = [
        0.27690944421322482651,
        0.55321353991467393027,
        0.82848678425012907547,
        1.1017256841790329063,
        1.3697250508315814297,
        1.6120336024582500143,
    ];
    let want = [
        998032.92769860163659,
        816404.530124528774,
        635307.49390198880087,
        455162.05331702769974,
        277196.3136746383086,
        108681.30547144665669,
    ];
    for (n, (f, want)) in forces(&problem, &times)[0].iter().zip(want).enumerate() {
        near(*f, if n % 2 == 0 { -want } else { want }, 1e-7);
    }
}

#[test]
fn wedge_restitution() {
    let slack = 0.1;
    let law = Law::Gear { solid_n_per_m: 2e8, slack_m: slack, draft: wedge_curve(), buff: wedge_curve() };
    let out = contacts(&pair(law, 1.0, Rest { force_n: 0.0, travel_m: -0.05 }, 0.6), 1e-6);
    near(out.extremes[0].buff.force_n, -1033402.6633934044193, 1e-8);
    near(out.extremes[0].buff.time_s, 0.098801527089541981232, 1e-8);
    let (parts, rebound) = (0.25057918855256270096, 0.55822113060709583053);
    near(out.first_over_s[0][0].expect("through the slack"), parts + slack / rebound, 2e-13);
}

fn wedge_curve() -> trainsafe::law::Curve {
    curve(&[[0., 0., 0.], [1000., 17900., 4475.]])
}

#[test]
fn bottoming() {
    let speeds = [
        (2.0, 815543.374211429561),
        (4.0, 1536597.2509891355461),
        (6.0, 5518455.2574792159857),
        (8.0, 10158584.628342670848),
    ];
    for (mph, want) in speeds {
        let law = gear(2e8, 0.1, gear_a());
        let out = solve(&pair(law, mph * MPH, Rest { force_n: 0.0, travel_m: -0.05 }, 0.5), &MarchOptions::default());
        near(-out.extremes[0].buff.force_n / want, 1.0, 1e-14);
    }
}

/// The last coupler of a long train: locked, and the instant at which it unlocks; with slack, and the instant at which it is slack.
#[test]
fn let_go_of_long_trains() {
    let problem = let_go(60, M, &gear(2e8, 0.0, gear_a()), &[6e5], 0.04);
    let t = 0.036383339050231599883;
    near(forces(&problem, &[t])[59][0] / 6e5, 0.27428571428571428571, 1e-14);
    let problem = let_go(60, 1.0, &spring(1.0, 0.5), &[1.0], 1.9158529851037561578);
    near(forces(&problem, &[1.9158529851037561578])[59][0], 0.0, 1e-15);
    let out = solve(&problem, &MarchOptions::default());
    near(out.end_speed_m_s[60], 1.0922000673310430172, 1e-15);
}

#[test]
fn hard_contacts() {
    let law = spring(1e10, 0.025);
    let three = |masses: [f64; 3]| Problem {
        speed_m_s: vec![0.0, 0.0, 1.0],
        ..train(masses.to_vec(), vec![law.clone(); 2], 0.07)
    };
    let out = contacts(&three([M; 3]), 1e-3);
    near(out.first_over_s[1][1].expect("first"), 0.0125, 2e-13);
    near(out.first_over_s[0][1].expect("second"), 0.029004760561103523422, 2e-13);
    near(out.first_over_s[0][0].expect("third, in draft"), 0.062014281683310570266, 2e-13);
    for (force, want) in [(out.extremes[0].buff, -1.0), (out.extremes[1].buff, -1.0), (out.extremes[0].draft, 1.0)] {
        near(force.force_n, want * 25495097.56796392415, 1e-6);
    }
    let out = contacts(&Problem { horizon_s: 0.035, ..three([130e3, 80e3, 200e3]) }, 1e-3);
    near(out.first_over_s[0][1].expect("second"), 0.025004921418445276032, 2e-13);
    near(out.extremes[1].buff.force_n, -23904572.186687872799, 1e-6);
    near(out.extremes[0].buff.force_n, -31791350.872239245199, 1e-6);
}

#[test]
fn brake_ramp_on_one_of_two() {
    let ramp = Drive::Lines(vec![[0.0, 0.0], [1.5, -13500.0], [9.0, -13500.0]]);
    let problem = Problem { forcing: vec![(1, ramp)], ..train(vec![M; 2], vec![spring(K, 0.0)], 2.0) };
    let force = &forces(&problem, &[1.0, 1.5])[0];
    near(force[0], 4710.1637847407681903, 1e-10);
    near(force[1], 6814.6335138964503327, 1e-10);
}

/// Three cars behind a held head, by matrix exponentials and a march of 113 bits: 15 events up to t = 12, 48 up to t = 40.
#[test]
fn sequence_of_events() {
    let problem = let_go(3, 1.0, &wedge(1.0, 18.0, 0.5, 0.5, 100.0), &[1.0], 40.0);
    let history = forces(&problem, &[12.0, 40.0]);
    let at_12 = [-0.32120696395859405864, -0.24544023974424768514, -0.1110785466292290856];
    let at_40 = [0.20237234374275118232, 0.15605554949119171759, 0.0];
    for i in 0..3 {
        near(history[i][0], at_12[i], 1e-14);
        near(history[i][1], at_40[i], 1e-14);
    }
    let out = contacts(&Problem { horizon_s: 12.0, ..problem.clone() }, 1e-12);
    assert_eq!((out.events, contacts(&problem, 1e-12).events), (15, 48));
    let buff = [6.0380753213538145993, 5.836163223569648614, 5.8183326920767104191];
    let turn = [9.1599985491302309875, 9.4165738301311210757, 9.8301622402403062899];
    for i in 0..3 {
        // Late by the capacity over a closing speed of some tenths.
        near(out.first_over_s[i][1].expect("buff"), buff[i], 1e-11);
        // The turn is where the largest buff is.
        near(out.extremes[i].buff.time_s, turn[i], 1e-13);
    }
    let speeds = [-0.17159422853058475664, -0.41001020372035659971, -0.53449427518300938506];
    speeds.iter().zip(&out.end_speed_m_s[1..]).for_each(|(want, got)| near(*got, *want, 1e-14));
}
