//! Damped, struck and breaking trains against 40-digit arithmetic; `tests/reference/motions.py` made the numbers.

use serde_json::Value;
use trainsafe::chain::{Chain, Scene};
use trainsafe::play::{Drive, Play, Rule};
use trainsafe::solve::taylor;

fn cases() -> Vec<Value> {
    let text = include_str!("../reference/motions.json");
    serde_json::from_str(text).expect("JSON")
}

fn number(value: &Value) -> f64 {
    value.as_f64().or_else(|| value.as_str()?.parse().ok()).expect("a number")
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(number).collect()
}

fn play(case: &Value) -> Play {
    let flag = |key: &str| case[key].as_bool().expect("a flag");
    Play {
        scene: Scene {
            chain: Chain {
                mass: numbers(&case["mass"]),
                stiffness: numbers(&case["stiffness"]),
                held_head: flag("held_head"),
                held_tail: flag("held_tail"),
            },
            source: 1,
            force: 0.0,
            duration: 0.0,
            initial: numbers(&case["initial"]),
            rated_draft: numbers(&case["rated_draft"]),
            rated_buff: numbers(&case["rated_buff"]),
            horizon: number(&case["horizon"]),
        },
        drive: Drive::none(),
        dashpot: numbers(&case["dashpot"]),
        start: vec![0.0; numbers(&case["initial"]).len()],
        velocity: numbers(&case["velocity"]),
        broken: numbers(&case["broken"]).into_iter().map(|b| b as usize).collect(),
        break_at: Vec::new(),
        rule: match case["rule"].as_str() {
            Some("draft") => Rule::InDraft,
            Some("both") => Rule::InBoth,
            _ => Rule::Keep,
        },
    }
}

/// Forces, peaks and the instants of breaks are as far from the exact ones as they may be and no further. The numbers in
/// doubles cost half a last place each.
#[test]
fn forces_and_breaks_are_within_their_bounds() {
    let mut tightest = f64::INFINITY;
    for case in cases() {
        let name = case["name"].as_str().unwrap_or_default();
        let p = play(&case);
        let out = taylor::solve(&p).expect("short");
        let bound = out.error_bound + 1e-15;
        // A rating that is passed slowly is passed at an uncertain instant, which costs two digits.
        assert!(bound < 1e-9, "{name}: {bound:e}");
        let events = case["events"].as_array().expect("events");
        assert_eq!(out.breakages.len(), events.len(), "{name}: {:?}", out.breakages);
        for (found, exact) in out.breakages.iter().zip(events) {
            assert_eq!(found.springs, [number(&exact["spring"]) as usize], "{name}");
            let apart = (found.time - number(&exact["time"])).abs();
            assert!(apart <= found.uncertainty && found.uncertainty < 1e-10, "{name}: {apart:e} {found:?}");
            assert!((found.force[0] - number(&exact["force"])).abs() < bound, "{name}");
        }
        let mut worst = 0.0f64;
        for (i, exact) in
            case["peaks"].as_array().expect("peaks").iter().enumerate().filter(|(i, _)| !p.broken.contains(i))
        {
            let exact = numbers(exact);
            for (side, exact) in [out.springs[i].draft, out.springs[i].buff].iter().zip(exact) {
                // The reference counts what is never in that sense as zero.
                let found = side.best.value.max(0.0);
                worst = worst.max((found - exact).abs());
                assert!((found - exact).abs() < bound, "{name}: spring {i}: {found} is not {exact} within {bound:e}");
            }
        }
        let times = numbers(&case["times"]);
        for i in 0..p.scene.initial.len() {
            let forces = taylor::history(&p, i, &times);
            for (row, f) in case["samples"].as_array().expect("samples").iter().zip(forces) {
                worst = worst.max((f - number(&row[i])).abs());
                assert!((f - number(&row[i])).abs() < bound, "{name}: spring {i}: {f} is not {}", row[i]);
            }
        }
        println!("{name}: error {worst:e}, bound {:e}", out.error_bound);
        tightest = tightest.min(out.error_bound / worst);
    }
    assert!(tightest < 1e4, "a bound {tightest:e} times the error says little");
}

/// What a break's instant is worth: breaks at ratings a millionth higher come later, and no force afterwards differs by more than
/// the bound makes of that delay, the coupler's force on both its masses over the delay, carried on without growth.
#[test]
fn a_delayed_break_changes_forces_no_more_than_its_bound_says() {
    for case in cases().iter().filter(|c| c["name"].as_str().is_some_and(|n| n.starts_with("cascade"))) {
        let (early, mut late) = (play(case), play(case));
        late.scene.rated_draft.iter_mut().chain(&mut late.scene.rated_buff).for_each(|r| *r *= 1.0 + 1e-6);
        let (a, b) = (taylor::solve(&early).expect("short"), taylor::solve(&late).expect("short"));
        let chain = &early.scene.chain;
        let inverse = |v: usize| if chain.live(v) { 1.0 / chain.mass[v] } else { 0.0 };
        let jolt = |i: usize| (inverse(i) + inverse(i + 1)).sqrt();
        let worth = |delay: f64, i: usize, force: f64| delay * force.abs() * jolt(i);
        let mut norm = 0.0;
        for (x, y) in a.breakages.iter().zip(&b.breakages) {
            assert_eq!(x.springs, y.springs);
            norm += worth((x.time - y.time).abs(), x.springs[0], y.force[0]);
            // The bound of the run holds what the uncertainty of each instant is worth, on the stiffest spring.
            let stiffest = chain.stiffness.iter().fold(0.0f64, |a, k| a.max(*k)).sqrt();
            assert!(a.error_bound >= stiffest * worth(x.uncertainty, x.springs[0], x.force[0]));
        }
        let from = a.breakages.iter().chain(&b.breakages).map(|x| x.time).fold(0.0, f64::max);
        let times: Vec<f64> = (0..400).map(|n| from + 0.01 + 0.02 * f64::from(n)).filter(|t| *t < 20.0).collect();
        let mut largest = 0.0f64;
        for i in 0..chain.stiffness.len() {
            let reach = (chain.stiffness[i] + early.dashpot[i].powi(2) * (inverse(i) + inverse(i + 1))).sqrt();
            let (f, g) = (taylor::history(&early, i, &times), taylor::history(&late, i, &times));
            for apart in f.iter().zip(&g).map(|(x, y)| (x - y).abs()) {
                assert!(apart <= reach * norm + a.error_bound, "{}: {apart:e} {norm:e}", case["name"]);
                largest = largest.max(apart / reach);
            }
        }
        assert!(largest > 0.01 * norm, "a delay that changes nothing shows nothing: {largest:e} {norm:e}");
    }
}

/// Between two held ends nothing does work: kinetic and elastic energy together change at breaks alone, by what the broken
/// coupler had in it; and what is left at the last break is what the motion after it shows.
#[test]
fn energy_is_accounted_across_breaks() {
    let case = cases().into_iter().find(|c| c["name"] == "dashpots, both held, break").expect("the case");
    let mut p = play(&case);
    p.dashpot.fill(0.0);
    p.rule = Rule::InBoth;
    p.scene.rated_draft.fill(0.82);
    p.scene.rated_buff.fill(0.4);
    // Forces that need nothing from outside: the same in all couplers.
    p.scene.initial.fill(0.8125);
    let out = taylor::solve(&p).expect("short");
    assert!(out.breakages.len() >= 2, "{:?}", out.breakages);
    let elastic = |i: usize| 0.5 * 0.8125f64.powi(2) / p.scene.chain.stiffness[i];
    let mut energy: f64 = [0, 2, 3, 4].iter().map(|&i| elastic(i)).sum();
    for at in &out.breakages {
        assert!((at.kinetic + at.strain[0] - energy).abs() < 1e-12, "{energy}: {at:?}");
        let lost: f64 = at.springs.iter().zip(&at.force).map(|(&i, f)| 0.5 * f * f / p.scene.chain.stiffness[i]).sum();
        assert!((at.strain[0] - at.strain[1] - lost).abs() < 1e-12);
        assert!((at.energy.iter().sum::<f64>() - lost).abs() < 1e-12);
        energy -= lost;
    }
}

/// What no force from outside acts on keeps its momentum whatever breaks in it, dashpots and all.
#[test]
fn momentum_is_kept_across_breaks() {
    for case in cases().iter().filter(|c| c["name"].as_str().is_some_and(|n| n.contains("struck"))) {
        let p = play(case);
        let total = |v: &[f64]| v.iter().zip(&p.scene.chain.mass).map(|(v, m)| v * m).sum::<f64>();
        let out = taylor::solve(&p).expect("short");
        for at in &out.breakages {
            assert!((total(&at.velocity) - total(&p.velocity)).abs() < 1e-13, "{at:?}");
        }
    }
}

/// Equal vehicles that separate from their middle outwards: symmetry makes two couplers reach their rating at one instant, and
/// they break together.
#[test]
fn symmetric_couplers_break_together() {
    let case = &cases()[0];
    let mut p = play(case);
    p.scene.chain.mass.fill(1.0);
    p.scene.chain.stiffness.fill(1.0);
    p.dashpot.fill(0.25);
    p.scene.initial.fill(0.0);
    p.broken.clear();
    p.rule = Rule::InDraft;
    p.velocity = vec![0.75, 0.5, 0.25, -0.25, -0.5, -0.75];
    // Apart by less than can be told, so that it is not the same bits that decide.
    p.scene.rated_draft = vec![0.25, 0.25, 9.0, 0.25 + 1e-14, 0.25 + 1e-14];
    let out = taylor::solve(&p).expect("short");
    assert!(!out.breakages.is_empty());
    for at in &out.breakages {
        let mirrored: Vec<usize> = at.springs.iter().rev().map(|i| 4 - i).collect();
        assert_eq!(at.springs, mirrored, "{:?}", out.breakages);
    }
}

/// A load over the rating breaks its coupler before anything else happens; one at the rating does not.
#[test]
fn a_load_over_the_rating_breaks_at_once() {
    let mut p = play(&cases()[0]);
    p.rule = Rule::InDraft;
    p.scene.rated_draft = vec![0.875, 0.75, 9.0, 0.374, 9.0];
    let out = taylor::solve(&p).expect("short");
    assert_eq!((out.breakages[0].time, out.breakages[0].springs.as_slice()), (0.0, &[3][..]), "{:?}", out.breakages);
}
