//! The march against Verlet with a clamp, an independent method of second order: the difference falls as the square of its step.

use crate::gears::{gear, gear_a, gear_a_dash, let_go, train, verlet, wedge};
use trainsafe::law::Law;
use trainsafe::march::{MarchOptions, Problem, solve};

/// Largest difference of any coupler's extremes, in shares of the largest force.
fn apart(problem: &Problem, steps: usize) -> f64 {
    let ours = solve(problem, &MarchOptions::default());
    let theirs = verlet(problem, steps);
    let largest = ours.extremes.iter().flat_map(|e| [e.draft.force_n, -e.buff.force_n]).fold(0.0, f64::max);
    let off = |(e, t): (&trainsafe::march::Extremes, &[f64; 2])| {
        (e.draft.force_n - t[0]).abs().max((e.buff.force_n - t[1]).abs())
    };
    ours.extremes.iter().zip(&theirs).map(off).fold(0.0, f64::max) / largest
}

#[track_caller]
fn converges(problem: &Problem, steps: usize, small: f64) {
    let (coarse, fine) = (apart(problem, steps), apart(problem, 8 * steps));
    println!("{coarse:.2e} {fine:.2e}");
    assert!(fine < small && fine < coarse / 20.0, "{coarse:.2e} {fine:.2e}");
}

#[test]
fn gears_let_go() {
    for law in [gear(2e8, 0.025, gear_a_dash()), gear(2e8, 0.0, gear_a()), wedge(17.9e6, 2e8, 0.5, 0.01, 1.0)] {
        converges(&let_go(20, 130e3, &law, &[9e5, 6e5], 4.0), 8000, 1e-6);
    }
}

/// Mixed laws, masses and stiffnesses; one coupler parts, the rest under steady forces.
#[test]
fn a_mixed_train() {
    let two = Law::Elastic { draft_n_per_m: 12e6, buff_n_per_m: 25e6, slack_m: 0.02 };
    let laws: Vec<Law> = (0..15)
        .map(|i| match i % 3 {
            0 => gear(2e8, 0.02, gear_a_dash()),
            1 => two.clone(),
            _ => gear(9e7, 0.0, gear_a()),
        })
        .collect();
    let mass: Vec<f64> = (0..16).map(|i| 60e3 + 11e3 * (i * 7 % 5) as f64).collect();
    let pull = |i: usize| 3e5 * (15 - i) as f64 / 15.0;
    let steady: Vec<f64> = (0..16)
        .map(|v| {
            if v == 0 {
                pull(0)
            } else if v == 15 {
                -pull(14)
            } else {
                pull(v) - pull(v - 1)
            }
        })
        .collect();
    let start = laws.iter().enumerate().map(|(i, l)| l.rest(&[1.5 * pull(i), pull(i)])).collect();
    let problem = Problem { start, steady_n: steady, gone: vec![6], ..train(mass, laws, 4.0) };
    converges(&problem, 8000, 1e-6);
}

/// A shunting impact of five cars on five that stand.
#[test]
fn an_impact() {
    let law = gear(2e8, 0.03, gear_a());
    let speed_m_s = (0..10).map(|v| if v < 5 { 0.0 } else { 2.0 }).collect();
    converges(&Problem { speed_m_s, ..train(vec![90e3; 10], vec![law; 9], 1.5) }, 6000, 1e-6);
}
