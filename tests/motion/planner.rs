//! What the planner chooses and leaves out, by counted work.

use trainsafe::chain::{Chain, Scene};
use trainsafe::solve::{Ask, Method, Solution, SolveError, estimate_s, solve};

/// Held head, `n` springs, the last mass released; every `stiff`-th spring 1e6 times as stiff, masses unequal by `spread`.
fn release(n: usize, spread: f64, stiff: usize, horizon: f64) -> Scene {
    // Alike as seen from the tail, however long the train.
    let mass = |v: usize| 1.0 + spread * (1.7 * ((n - v) * (n - v)) as f64).sin();
    let stiffness = |i: usize| if stiff > 0 && i % stiff == stiff / 2 { 1e6 } else { 1.0 };
    let chain = Chain {
        mass: (0..=n).map(mass).collect(),
        stiffness: (0..n).map(stiffness).collect(),
        held_head: true,
        held_tail: false,
    };
    Scene {
        chain,
        source: n,
        force: 0.8,
        duration: f64::INFINITY,
        initial: vec![0.8; n],
        rated_draft: vec![1.0; n],
        rated_buff: vec![1.0; n],
        horizon,
    }
}

fn ask() -> Ask {
    Ask { tolerance: 1e-9, ..Ask::default() }
}

fn solved(scene: &Scene, ask: &Ask) -> Solution {
    solve(scene, ask).expect("a solution")
}

#[test]
fn each_method_has_its_scenes() {
    let chosen = |scene: &Scene| solved(scene, &ask()).method;
    assert_eq!(chosen(&release(300, 0.0, 0, 1200.0)), Method::Fronts);
    assert_eq!(chosen(&release(300, 0.5, 0, 1200.0)), Method::Propagator);
    assert_eq!(chosen(&release(60, 0.5, 10, 240.0)), Method::Modal);
    assert_eq!(chosen(&release(10, 0.0, 0, 1e5)), Method::Modal);
}

/// Within the tolerance the bound is; where no method reaches it, the result says so and states the bound that it has.
#[test]
fn an_unreachable_tolerance_is_said() {
    let scene = release(50, 0.5, 0, 200.0);
    assert!(solved(&scene, &ask()).error_bound <= 1e-9);
    let strict = Ask { tolerance: 1e-17, ..ask() };
    let solution = solved(&scene, &strict);
    assert!(solution.error_bound > 1e-17);
    assert!(solution.reason.contains("no method's bound is within the tolerance"), "{}", solution.reason);
}

/// A bound that is missed by less than a factor of ten, or is under a billionth of the force, is not bought at any price.
#[test]
fn a_strict_tolerance_costs_no_more_than_ten_times_the_usual() {
    for spread in [0.0, 0.5] {
        let scene = release(600, spread, 0, 2400.0);
        let seconds = |tolerance| estimate_s(&scene, &Ask { tolerance, ..ask() }).expect("an estimate");
        for tolerance in [1e-10, 1e-11, 1e-12, 1e-13, 1e-15] {
            assert!(seconds(tolerance) <= 10.0 * seconds(1e-9), "{spread} {tolerance:e}");
        }
        let strict = solved(&scene, &Ask { tolerance: 1e-13, ..ask() });
        let says = "its bound is not within the tolerance of 1.0e-13; that of modal would be, for ";
        assert!(strict.error_bound > 1e-13 && strict.reason.starts_with(says), "{}", strict.reason);
    }
}

/// If no spring can exceed at any time, time is not looked at; where some can, only they are reported.
#[test]
fn a_verdict_alone_leaves_out_what_is_safe_for_ever() {
    let verdict = Ask { verdict_only: true, ..ask() };
    let mut scene = release(40, 0.0, 0, 4000.0);
    scene.rated_draft.fill(100.0);
    scene.rated_buff.fill(100.0);
    let safe = solved(&scene, &verdict);
    assert!(safe.springs.iter().all(Option::is_none) && safe.work == Default::default());
    scene.rated_draft[7] = 0.9;
    let one = solved(&scene, &verdict);
    let reported: Vec<usize> = (0..40).filter(|&i| one.springs[i].is_some()).collect();
    assert_eq!(reported, [7]);
    assert_eq!(one.springs[7], solved(&scene, &Ask { method: Some(one.method), ..ask() }).springs[7]);
}

/// The work of four transits of a march grows as the square of the length: doubling it makes four times as much, within a tenth.
/// That of fronts grows as the length, but for windows that widen as its cube root.
#[test]
fn work_grows_as_the_square_or_the_length() {
    for (spread, method, least, most) in [(0.0, Method::Fronts, 1.6, 2.6), (0.5, Method::Propagator, 3.6, 4.4)] {
        let work = |n: usize| {
            let scene = release(n, spread, 0, 4.0 * n as f64);
            solved(&scene, &Ask { method: Some(method), ..ask() }).work.marched as f64
        };
        let ratio = work(800) / work(400);
        assert!((least..most).contains(&ratio), "{method:?} {ratio}");
    }
}

/// Springs that the wave does not reach within the horizon cost nothing: a short horizon on a long train is short work.
#[test]
fn nothing_beyond_the_front_is_touched() {
    let short = |n: usize| solved(&release(n, 0.5, 0, 50.0), &Ask { method: Some(Method::Propagator), ..ask() }).work;
    // The longer train has a slightly larger frequency somewhere, and steps to fit it.
    let (long, short) = (short(2000).marched as f64, short(400).marched as f64);
    assert!((0.98..1.02).contains(&(long / short)), "{long} {short}");
}

#[test]
fn what_cannot_be_done_is_refused_with_a_reason() {
    let by = |scene: &Scene, method| solve(scene, &Ask { method: Some(method), ..ask() }).expect_err("refused");
    assert_eq!(by(&release(9, 0.5, 0, 9.0), Method::Fronts), SolveError::NotEqual("fronts"));
    let mut short = release(9, 0.0, 0, 9.0);
    short.duration = 1e-3;
    assert_eq!(by(&short, Method::Fronts), SolveError::TooShort);
    let mut inside = release(9, 0.0, 0, 9.0);
    inside.source = 4;
    assert_eq!(by(&inside, Method::Fronts), SolveError::NotAtEnd);
    let endless = by(&release(20_000, 0.5, 0, 100.0), Method::Modal);
    assert!(endless.to_string().contains("propagator would take about"), "{endless}");
}

/// The estimate is of the same size as the count of work that it is made from, and is there before any work is done.
#[test]
fn long_work_is_estimated_beforehand() {
    let seconds = |n: usize| estimate_s(&release(n, 0.5, 0, 4.0 * n as f64), &ask()).expect("an estimate");
    assert!(seconds(4000) > 10.0 * seconds(1000));
}
