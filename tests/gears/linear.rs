//! Linear trains through the march of gears and through the march of linear couplers: dashpots, pulses of any shape, cascades, and
//! the proven bounds of both.

use crate::gears::train;
use trainsafe::chain::{Chain, Scene};
use trainsafe::law::Law;
use trainsafe::march::{Bound, MarchOptions, Problem, solve};
use trainsafe::play::{Drive, Play, Rule};
use trainsafe::solve::taylor;

fn wave(i: usize, f: f64) -> f64 {
    1.0 + 0.6 * (f * (i * i) as f64).sin()
}

/// Unequal masses and springs under unequal forces, damped, kicked and driven.
fn play(drive: Drive, damping: f64, rule: Rule, held_head: bool) -> Play {
    let masses = 16;
    let springs = masses - 1;
    let scene = Scene {
        chain: Chain {
            mass: (0..masses).map(|v| wave(v + 1, 1.7)).collect(),
            stiffness: (0..springs).map(|i| wave(i + 1, 2.3)).collect(),
            held_head,
            held_tail: false,
        },
        source: 9,
        force: 0.0,
        duration: 0.0,
        initial: (0..springs).map(|i| 0.8 * wave(i + 1, 0.9)).collect(),
        rated_draft: (0..springs).map(|i| 2.0 * wave(i + 2, 0.9)).collect(),
        rated_buff: vec![f64::INFINITY; springs],
        horizon: 30.0,
    };
    Play {
        drive,
        dashpot: (0..springs).map(|i| damping * wave(i + 5, 1.1)).collect(),
        start: vec![0.0; springs],
        velocity: (0..masses).map(|v| if v == 0 { 0.0 } else { 0.3 * (wave(v, 0.4) - 1.0) }).collect(),
        broken: Vec::new(),
        rule,
        break_at: Vec::new(),
        scene,
    }
}

/// The same for the march of gears.
fn problem(play: &Play) -> Problem {
    let scene = &play.scene;
    let law = |k: &f64| Law::Elastic { draft_n_per_m: *k, buff_n_per_m: *k, slack_m: 0.0 };
    let laws: Vec<Law> = scene.chain.stiffness.iter().map(law).collect();
    let n = laws.len() + 1;
    let tension = |i: usize| scene.initial.get(i).copied().unwrap_or(0.0);
    let steady = |v: usize| tension(v) - if v > 0 { tension(v - 1) } else { 0.0 };
    let limits = scene.rated_draft.iter().map(|r| [*r, f64::INFINITY]).collect();
    Problem {
        start: laws.iter().zip(&scene.initial).map(|(l, f)| l.rest(&[*f])).collect(),
        held_head: scene.chain.held_head,
        dashpot_n_s_per_m: play.dashpot.clone(),
        speed_m_s: play.velocity.clone(),
        steady_n: (0..n).map(steady).collect(),
        forcing: vec![(scene.source, play.drive.clone())],
        gone: play.broken.clone(),
        break_at_n: if play.rule == Rule::Keep { Vec::new() } else { limits },
        ..train(scene.chain.mass.clone(), laws, scene.horizon)
    }
}

#[track_caller]
fn agree(play: &Play) {
    let linear = taylor::solve(play).expect("short");
    let ours = solve(&problem(play), &MarchOptions::default());
    let ours_bound = match ours.bound {
        Bound::Proven(bound) => bound,
        _ => 1e-12,
    };
    assert!(ours_bound < 1e-11 && linear.error_bound < 1e-11, "{ours_bound} {}", linear.error_bound);
    let bound = ours_bound + linear.error_bound;
    for (i, (peaks, e)) in linear.springs.iter().zip(&ours.extremes).enumerate() {
        for (theirs, mine) in [(peaks.draft.best.value, e.draft.force_n), (peaks.buff.best.value, -e.buff.force_n)] {
            // After it breaks a coupler carries nothing, which counts here and not there.
            assert!((theirs.max(0.0) - mine.max(0.0)).abs() <= bound, "coupler {i}: {theirs} {mine}, within {bound:e}");
        }
    }
    let broken = linear.breakages.iter().flat_map(|b| b.springs.iter().map(|s| (*s, b.time)));
    let broken: Vec<(usize, f64)> = broken.collect();
    assert_eq!(broken.len(), ours.partings.len());
    for ((spring, time), parting) in broken.into_iter().zip(&ours.partings) {
        assert_eq!(spring, parting.coupler);
        assert!((time - parting.time_s).abs() < 1e-11, "{time} {}", parting.time_s);
    }
}

/// A half sine and a trapezoid on a damped and an undamped chain, free and held: within both bounds.
#[test]
fn pulses_and_dashpots() {
    let lines = Drive::Lines(vec![[1.0, 0.0], [2.0, -3.0], [4.0, -3.0], [4.0, 1.0], [5.0, 0.0]]);
    for drive in [Drive::HalfSine { peak: 2.5, duration: 3.7 }, lines, Drive::rectangle(1.3, 2.0)] {
        for damping in [0.0, 0.2] {
            for held in [false, true] {
                agree(&play(drive.clone(), damping, Rule::Keep, held));
            }
        }
    }
}

/// Couplers that break in draft, one after the other, up to the first gap that closes; both marches tell when that is.
#[test]
fn cascades() {
    for damping in [0.0, 0.1] {
        let mut p = play(Drive::rectangle(-4.0, 6.0), damping, Rule::InDraft, true);
        let linear = taylor::solve(&p).expect("short");
        let (coupler, closes) = linear.gap_closes.expect("one closes");
        let ours = solve(&problem(&p), &MarchOptions::default());
        assert_eq!(ours.closures[0].0, coupler);
        // The other march counts a gap as closed where it is so by more than its bound.
        let late = closes - ours.closures[0].1;
        assert!((0.0..2e-9).contains(&late), "{late}");
        p.scene.horizon = 0.999 * closes;
        assert!(taylor::solve(&p).expect("short").breakages.len() >= 2);
        agree(&p);
    }
}
