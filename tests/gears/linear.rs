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

/// Temporary: random problems through both marches.
#[test]
fn temporary_random_comparison() {
    let mut seed = 11u64;
    let mut random = move || {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (seed >> 11) as f64 / (1u64 << 53) as f64
    };
    let (mut ratio, mut breaks, mut open) = (0.0f64, 0, [0, 0]);
    for round in 0..400 {
        let n = 2 + (random() * 30.0) as usize;
        let springs = n - 1;
        let held_head = random() < 0.4;
        let scene = Scene {
            chain: Chain {
                mass: (0..n).map(|_| 0.3 + 3.0 * random()).collect(),
                stiffness: (0..springs).map(|_| 0.3 + 3.0 * random()).collect(),
                held_head,
                held_tail: random() < 0.3 && n > 2,
            },
            source: (n - 1).min(1 + (random() * springs as f64) as usize).min(if n > 2 { n - 2 } else { 1 }),
            force: 0.0,
            duration: 0.0,
            initial: (0..springs).map(|_| random()).collect(),
            rated_draft: (0..springs).map(|_| 1.0 + random()).collect(),
            rated_buff: (0..springs).map(|_| 0.5 + random()).collect(),
            horizon: 4.0 * n as f64,
        };
        let mut scene = scene;
        if n == 2 { scene.chain.held_tail = false; }
        let damping = if random() < 0.5 { 0.0 } else { 0.4 * random() };
        let drives = [Drive::none(), Drive::rectangle(random() - 0.5, 3.0), Drive::HalfSine { peak: 1.5, duration: 2.0 },
            Drive::Lines(vec![[0.5, 0.0], [1.0, -1.0], [4.0, 0.7]])];
        let unbalanced = random() < 0.3;
        let p = Play {
            drive: drives[(random() * 4.0) as usize].clone(),
            dashpot: (0..springs).map(|_| damping * random()).collect(),
            start: (0..springs).map(|_| if unbalanced { 0.5 * (random() - 0.5) } else { 0.0 }).collect(),
            velocity: (0..n).map(|v| if scene.chain.live(v) { 0.3 * (random() - 0.5) } else { 0.0 }).collect(),
            broken: if random() < 0.5 { vec![(random() * springs as f64) as usize] } else { vec![] },
            rule: [Rule::Keep, Rule::InDraft, Rule::InBoth][(random() * 3.0) as usize],
            break_at: Vec::new(),
            scene,
        };
        let linear = taylor::solve(&p).expect("short");
        let scene = &p.scene;
        let mut q = problem(&p);
        q.held_tail = scene.chain.held_tail;
        q.contact = false;
        let steady = |i: usize| scene.initial.get(i).map_or(0.0, |f| f - p.start[i]);
        q.steady_n = (0..n).map(|v| steady(v) - if v > 0 { steady(v - 1) } else { 0.0 }).collect();
        let limit = |i: usize| [scene.rated_draft[i], if p.rule == Rule::InBoth { scene.rated_buff[i] } else { f64::INFINITY }];
        q.break_at_n = if p.rule == Rule::Keep { vec![] } else { (0..springs).map(limit).collect() };
        let capacity_n: Vec<[f64; 2]> = (0..springs).map(|i| [scene.rated_draft[i], scene.rated_buff[i]]).collect();
        let ours = solve(&q, &MarchOptions { capacity_n, tolerance_n: Some(1e-6), ..MarchOptions::default() });
        let Bound::Proven(mine) = ours.bound else { panic!("{round}: {:?}", ours.bound) };
        ratio = ratio.max(mine / linear.error_bound);
        if mine / linear.error_bound > 1.3 { println!("{round} {} n {n} unb {unbalanced} damping {damping} rule {:?} breaks {}", mine / linear.error_bound, p.rule, linear.breakages.len()); }
        let bound = mine + linear.error_bound;
        for i in (0..springs).filter(|i| !p.broken.contains(i)) {
            let peaks = linear.springs[i];
            for (side, mine) in [(peaks.draft, ours.extremes[i].draft), (peaks.buff, ours.extremes[i].buff)] {
                assert!((side.best.value - mine.force_n.abs().copysign(side.best.value)).abs() <= bound, "{round} {i}: {side:?} {mine:?} {bound:e}");
            }
            assert_eq!([peaks.draft.exceeds(), peaks.buff.exceeds()], ours.exceeds[i], "{round} {i}");
            for (a, b) in [peaks.draft.first_over, peaks.buff.first_over].iter().zip(ours.first_over_s[i]) {
                assert_eq!(a.is_some(), b.is_some());
                assert!(a.zip(b).is_none_or(|(a, b)| (a - b).abs() < 1e-7), "{round} {i} {a:?} {b:?}");
            }
        }
        let broken: Vec<(usize, f64, f64)> = linear.breakages.iter().flat_map(|b| b.springs.iter().map(|s| (*s, b.time, b.uncertainty))).collect();
        let mine: Vec<_> = ours.partings.iter().skip(p.broken.len()).collect();
        assert_eq!(broken.len(), mine.len(), "{round}");
        for ((spring, time, off), m) in broken.iter().zip(&mine) {
            assert_eq!(*spring, m.coupler);
            assert!((time - m.time_s).abs() <= off + m.uncertainty_s, "{round} {time} {m:?}");
        }
        breaks += broken.len();
        open[0] += usize::from(linear.open.is_some());
        open[1] += usize::from(ours.undecided.is_some());
        let apart = match (linear.gap_closes, ours.closures.first()) {
            (Some(a), Some(b)) => { assert_eq!(a.0, b.0, "{round}"); (a.1 - b.1).abs() }
            (None, None) => 0.0,
            _ if p.rule == Rule::Keep => 0.0,
            (a, b) => panic!("{round} {a:?} {b:?}"),
        };
        assert!(apart < 1e-5, "{round} {apart}");
    }
    println!("ratio {ratio} breaks {breaks} open {open:?}");
}
