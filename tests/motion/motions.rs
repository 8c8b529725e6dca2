//! Damped, struck and breaking trains against 40-digit arithmetic; `tests/reference/motions.py` made the numbers.

use crate::linear::{Linear, bound, breakages, sides};
use serde_json::Value;
use trainsafe::chain::Chain;
use trainsafe::march::{MarchOptions, solve};
use trainsafe::train::Rule;

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

fn linear(case: &Value) -> Linear {
    let flag = |key: &str| case[key].as_bool().expect("a flag");
    let chain = Chain {
        mass: numbers(&case["mass"]),
        stiffness: numbers(&case["stiffness"]),
        held_head: flag("held_head"),
        held_tail: flag("held_tail"),
    };
    let rated = numbers(&case["rated_draft"]).into_iter().zip(numbers(&case["rated_buff"])).map(|(d, b)| [d, b]);
    let mut linear = Linear::new(&chain, &numbers(&case["initial"]), rated.collect(), number(&case["horizon"]));
    linear.problem.dashpot_n_s_per_m = numbers(&case["dashpot"]);
    linear.problem.speed_m_s = numbers(&case["velocity"]);
    linear.problem.gone = numbers(&case["broken"]).into_iter().map(|b| b as usize).collect();
    linear
}

fn rule(case: &Value) -> Rule {
    match case["rule"].as_str() {
        Some("draft") => Rule::InDraft,
        Some("both") => Rule::InBoth,
        _ => Rule::Keep,
    }
}

/// Forces, peaks and the instants of breaks are as far from the exact ones as they may be and no further. The numbers in
/// doubles cost half a last place each.
#[test]
fn forces_and_breaks_are_within_their_bounds() {
    let mut tightest = f64::INFINITY;
    for case in cases() {
        let name = case["name"].as_str().unwrap_or_default();
        let p = linear(&case).breaking(rule(&case));
        let out = p.run();
        let bound = bound(&out) + 1e-15;
        // A rating that is passed slowly is passed at an uncertain instant, which costs two digits.
        assert!(bound < 1e-9, "{name}: {bound:e}");
        let events = case["events"].as_array().expect("events");
        let broken = &out.partings[p.problem.gone.len()..];
        assert_eq!(broken.len(), events.len(), "{name}: {broken:?}");
        for (found, exact) in broken.iter().zip(events) {
            assert_eq!(found.coupler, number(&exact["spring"]) as usize, "{name}");
            let apart = (found.time_s - number(&exact["time"])).abs();
            assert!(apart <= found.uncertainty_s && found.uncertainty_s < 1e-10, "{name}: {apart:e} {found:?}");
            assert!((found.force_n - number(&exact["force"])).abs() < bound, "{name}");
        }
        let mut worst = 0.0f64;
        for (i, exact) in
            case["peaks"].as_array().expect("peaks").iter().enumerate().filter(|(i, _)| !p.problem.gone.contains(i))
        {
            let exact = numbers(exact);
            for (side, exact) in sides(&out, i).iter().zip(exact) {
                // The reference counts what is never in that sense as zero.
                let found = side.0.max(0.0);
                worst = worst.max((found - exact).abs());
                assert!((found - exact).abs() < bound, "{name}: spring {i}: {found} is not {exact} within {bound:e}");
            }
        }
        let times = numbers(&case["times"]);
        for i in 0..p.rated.len() {
            let forces = p.history(i, &times);
            for (row, f) in case["samples"].as_array().expect("samples").iter().zip(forces) {
                worst = worst.max((f - number(&row[i])).abs());
                assert!((f - number(&row[i])).abs() < bound, "{name}: spring {i}: {f} is not {}", row[i]);
            }
        }
        println!("{name}: error {worst:e}, bound {bound:e}");
        tightest = tightest.min(bound / worst);
    }
    assert!(tightest < 1e4, "a bound {tightest:e} times the error says little");
}

/// What a break's instant is worth: breaks at ratings a millionth higher come later, and no force afterwards differs by more than
/// the bound makes of that delay, the coupler's force on both its masses over the delay, carried on without growth.
#[test]
fn a_delayed_break_changes_forces_no_more_than_its_bound_says() {
    for case in cases().iter().filter(|c| c["name"].as_str().is_some_and(|n| n.starts_with("cascade"))) {
        let (early, mut late) = (linear(case).breaking(rule(case)), linear(case));
        late.rated.iter_mut().flatten().for_each(|r| *r *= 1.0 + 1e-6);
        let late = late.breaking(rule(case));
        let (a, b) = (early.run(), late.run());
        let gone = early.problem.gone.len();
        let masses = |i: usize| early.inverse_mass(i) + early.inverse_mass(i + 1);
        let jolt = |i: usize| masses(i).sqrt();
        let couplers = || 0..early.rated.len();
        let worth = |delay: f64, i: usize, force: f64| delay * force.abs() * jolt(i);
        let mut norm = 0.0;
        for (x, y) in a.partings[gone..].iter().zip(&b.partings[gone..]) {
            assert_eq!(x.coupler, y.coupler);
            norm += worth((x.time_s - y.time_s).abs(), x.coupler, y.force_n);
            // The bound of the run holds what the uncertainty of each instant is worth, on the stiffest spring.
            let stiffest = couplers().map(|i| early.stiffness(i)).fold(0.0, f64::max).sqrt();
            assert!(bound(&a) >= stiffest * worth(x.uncertainty_s, x.coupler, x.force_n));
        }
        let from = a.partings.iter().chain(&b.partings).map(|x| x.time_s).fold(0.0, f64::max);
        let times: Vec<f64> = (0..400).map(|n| from + 0.01 + 0.02 * f64::from(n)).filter(|t| *t < 20.0).collect();
        let mut largest = 0.0f64;
        for i in couplers() {
            let reach = (early.stiffness(i) + early.problem.dashpot_n_s_per_m[i].powi(2) * masses(i)).sqrt();
            let (f, g) = (early.history(i, &times), late.history(i, &times));
            for apart in f.iter().zip(&g).map(|(x, y)| (x - y).abs()) {
                assert!(apart <= reach * norm + bound(&a), "{}: {apart:e} {norm:e}", case["name"]);
                largest = largest.max(apart / reach);
            }
        }
        assert!(largest > 0.01 * norm, "a delay that changes nothing shows nothing: {largest:e} {norm:e}");
    }
}

/// Between two held ends nothing does work: kinetic and elastic energy together change at breaks alone, by what the broken
/// coupler had in it.
#[test]
fn energy_is_accounted_across_breaks() {
    let case = cases().into_iter().find(|c| c["name"] == "dashpots, both held, break").expect("the case");
    let mut p = linear(&case);
    p.problem.dashpot_n_s_per_m.clear();
    p.rated.fill([0.82, 0.4]);
    // Forces that need nothing from outside: the same in all couplers.
    p.load(&[0.8125; 5]);
    let p = p.breaking(Rule::InBoth);
    let out = solve(&p.problem, &MarchOptions { audit: true, ..MarchOptions::default() });
    assert!(out.partings.len() >= 3, "{:?}", out.partings);
    let energy = out.energy.expect("asked for");
    let all: f64 = (0..5).map(|i| 0.5 * 0.8125f64.powi(2) / p.stiffness(i)).sum();
    assert!((energy.start_j - all).abs() < 1e-14);
    let mut lost = 0.0;
    for at in &out.partings {
        let own = 0.5 * at.force_n * at.force_n / p.stiffness(at.coupler);
        assert!((at.energy_j - own).abs() < 1e-12, "{at:?}");
        lost += own;
    }
    assert!((energy.released_j - lost).abs() < 1e-12 && (energy.end_j - (all - lost)).abs() < 1e-12, "{energy:?}");
}

/// What no force from outside acts on keeps its momentum whatever breaks in it, dashpots and all.
#[test]
fn momentum_is_kept_across_breaks() {
    for case in cases().iter().filter(|c| c["name"].as_str().is_some_and(|n| n.contains("struck"))) {
        let p = linear(case).breaking(rule(case));
        let total = |v: &[f64]| v.iter().zip(&p.problem.mass_kg).map(|(v, m)| v * m).sum::<f64>();
        let out = p.run();
        assert!(rule(case) == Rule::Keep || !out.partings.is_empty());
        assert!((total(&out.end_speed_m_s) - total(&p.problem.speed_m_s)).abs() < 1e-13, "{:?}", out.end_speed_m_s);
    }
}

/// Equal vehicles that separate from their middle outwards: symmetry makes two couplers reach their rating at one instant, and
/// they break together.
#[test]
fn symmetric_couplers_break_together() {
    let chain = Chain { mass: vec![1.0; 6], stiffness: vec![1.0; 5], held_head: false, held_tail: false };
    // Apart by less than can be told, so that it is not the same bits that decide.
    let rated = [0.25, 0.25, 9.0, 0.25 + 1e-14, 0.25 + 1e-14].map(|r| [r, 9.0]);
    let mut p = Linear::new(&chain, &[0.0; 5], rated.to_vec(), 20.0);
    p.problem.dashpot_n_s_per_m = vec![0.25; 5];
    p.problem.speed_m_s = vec![0.75, 0.5, 0.25, -0.25, -0.5, -0.75];
    let found = breakages(&p.breaking(Rule::InDraft).run(), 0);
    assert!(!found.is_empty());
    for at in &found {
        let springs: Vec<usize> = at.iter().map(|p| p.coupler).collect();
        let mirrored: Vec<usize> = springs.iter().rev().map(|i| 4 - i).collect();
        assert_eq!(springs, mirrored, "{found:?}");
    }
}

/// A load over the rating breaks its coupler before anything else happens; one at the rating does not.
#[test]
fn a_load_over_the_rating_breaks_at_once() {
    let case = &cases()[0];
    let mut p = linear(case);
    p.rated = [0.875, 0.75, 9.0, 0.374, 9.0].iter().zip(&p.rated).map(|(draft, [_, buff])| [*draft, *buff]).collect();
    let found = breakages(&p.breaking(Rule::InDraft).run(), p.problem.gone.len());
    assert_eq!((found[0][0].time_s, found[0].len(), found[0][0].coupler), (0.0, 1, 3), "{found:?}");
}
