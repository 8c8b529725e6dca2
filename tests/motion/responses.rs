//! Scenes from responses: within the bounds of their own solutions, the same bits remembered or not, and no more work than chains.

use crate::campaign::scene;
use crate::scenes::EVERYTHING;
use proptest::prelude::*;
use trainsafe::chain::{Chain, Scene};
use trainsafe::solve::responses::{Responses, Shared};
use trainsafe::solve::watch::SpringPeaks;
use trainsafe::solve::{Ask, Method, Solution, Wanted, solve};

/// An equal chain whose last mass is pulled.
fn equal(masses: usize, held_head: bool, rating: f64) -> Scene {
    let springs = masses - 1;
    Scene {
        chain: Chain { mass: vec![1.3; masses], stiffness: vec![0.7; springs], held_head, held_tail: false },
        source: springs,
        force: 0.9,
        duration: f64::INFINITY,
        initial: (0..springs).map(|i| 0.4 + 0.05 * (i % 7) as f64).collect(),
        rated_draft: vec![rating; springs],
        rated_buff: vec![0.9 * rating; springs],
        horizon: 6.0 * masses as f64,
    }
}

fn mirror(scene: &Scene) -> Scene {
    let mut mirror = scene.clone();
    let lists = [&mut mirror.chain.mass, &mut mirror.chain.stiffness, &mut mirror.initial];
    lists.into_iter().chain([&mut mirror.rated_draft, &mut mirror.rated_buff]).for_each(|list| list.reverse());
    (mirror.chain.held_head, mirror.chain.held_tail) = (scene.chain.held_tail, scene.chain.held_head);
    mirror.source = scene.chain.mass.len() - 1 - scene.source;
    mirror.force = -scene.force;
    mirror
}

fn peaks(springs: &[Option<SpringPeaks>]) -> Vec<SpringPeaks> {
    springs.iter().map(|s| s.expect("every spring was asked for")).collect()
}

/// Another load and other ratings of a scene: by the peaks that the load brings, a part of them near these in the measure of the bound.
fn loaded(bare: &Scene, ask: &Ask, [load, share]: [f64; 2], kind: usize) -> Scene {
    let mut scene = bare.clone();
    scene.force *= load;
    scene.initial.iter_mut().for_each(|f| *f *= load * 0.8);
    let solution = solve(&scene, ask).expect("a solution");
    let (all, to_mark) = (peaks(&solution.springs), peaks(&solution.to_mark));
    let bound = solution.error_bound;
    for i in 0..all.len() {
        let rating = |negative: bool| {
            let before = if negative { -scene.initial[i] } else { scene.initial[i] };
            let (peak, marked) = (all[i].side(negative).best.value, to_mark[i].side(negative).best.value);
            let rating = match (kind, (i + usize::from(negative)) % 6) {
                (0, _) => share * peak,
                (1, 0) => peak + 3.0 * bound,
                (1, 1) => peak - 3.0 * bound,
                (1, 2) => marked + 3.0 * bound,
                (1, 3) => marked - 3.0 * bound,
                (2, 0) => before,
                (2, 1) => before + 2.0 * bound,
                (2, 2) => before - 2.0 * bound,
                (3, _) => before + share * 1e-3 * (peak - before),
                _ => before + share * (peak - before),
            };
            if rating > 0.0 { rating } else { 0.1 }
        };
        (scene.rated_draft[i], scene.rated_buff[i]) = (rating(false), rating(true));
    }
    scene
}

/// Peaks within both bounds of each other, verdicts the same unless the rating is within them, first exceedances on curves that are
/// within them.
fn agrees(
    scene: &Scene,
    until: f64,
    own: &[SpringPeaks],
    other: &[SpringPeaks],
    apart: f64,
) -> Result<(), TestCaseError> {
    for (i, (a, b)) in own.iter().zip(other).enumerate() {
        for negative in [false, true] {
            let rating = if negative { scene.rated_buff[i] } else { scene.rated_draft[i] };
            let (a, b) = (a.side(negative), b.side(negative));
            prop_assert!((a.best.value - b.best.value).abs() <= apart, "{i}: {a:?} {b:?} {apart:e}");
            if (a.best.value - rating).abs() > apart {
                prop_assert_eq!(a.exceeds(), b.exceeds(), "{}: {:?} {:?} {}", i, a, b, rating);
            }
            prop_assert!(a.exceeds().is_none() || b.exceeds().is_none() || a.exceeds() == b.exceeds(), "{a:?} {b:?}");
            prop_assert!(
                b.best.at <= until * (1.0 + 1e-15) && b.first_over.is_none_or(|at| at <= b.best.at),
                "{b:?} {until}"
            );
        }
    }
    Ok(())
}

/// The force of a side at a time.
fn force(scene: &Scene, spring: usize, negative: bool, at: f64) -> f64 {
    let force = trainsafe::solve::history(scene, spring, &[at])[0];
    if negative { -force } else { force }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(30) })]

    #[test]
    fn loads_and_ratings_are_judged_as_by_their_own_solutions(
        seed in 0u64..1_000_000, load in -2.0..2.0f64, share in 0.02..1.1f64, kind in 0usize..5, part in 0.1..0.9f64
    ) {
        let bare = scene(seed);
        let ask = Ask { mark: Some(part * bare.horizon), ..EVERYTHING };
        let scene = loaded(&bare, &ask, [load, share], kind);
        let responses = Responses::new(1 << 26);
        let shared = |ask: &Ask| solved(Shared::EveryChain(&responses), &scene, ask);
        let (own, other) = (solve(&scene, &ask).expect("a solution"), shared(&ask));
        let apart = own.error_bound + other.error_bound;
        prop_assert!(other.error_bound <= ask.tolerance);
        let springs = [&own, &other].map(|s| peaks(&s.springs));
        agrees(&scene, scene.horizon, &springs[0], &springs[1], apart)?;
        agrees(&scene, part * scene.horizon, &peaks(&own.to_mark), &peaks(&other.to_mark), apart)?;
        // Just before the first exceedance the force is under the rating, or the certain rise began there; at it, not under.
        for (i, peaks) in springs[1].iter().enumerate().step_by(3) {
            for negative in [false, true] {
                let rating = if negative { scene.rated_buff[i] } else { scene.rated_draft[i] };
                let Some(at) = peaks.side(negative).first_over.filter(|at| *at > 0.0) else { continue };
                let slack = apart + 1e-9 * scene.force.abs();
                prop_assert!(force(&scene, i, negative, at) >= rating - slack, "{i} {at}");
                let first = springs[0][i].side(negative).first_over;
                prop_assert!(first.is_none_or(|first| (first - at).abs() <= 1e-6 * at
                    || force(&scene, i, negative, first) >= rating - slack), "{i} {at} {first:?}");
            }
        }
        // Of the worst alone the earliest exceedance is the same.
        let worst = shared(&Ask { wanted: Wanted::Worst, ..ask });
        let earliest = |of: &Solution| {
            let sides = peaks(&of.springs).into_iter().enumerate().flat_map(|(i, p)| [(i, p.draft), (i, p.buff)]);
            sides.filter_map(|(i, side)| Some((side.first_over?, i))).min_by(|a, b| a.0.total_cmp(&b.0))
        };
        prop_assert_eq!(earliest(&other), earliest(&worst));
    }

    #[test]
    fn known_and_mirrored_scenes_are_the_same_to_the_bit(masses in 2usize..30, held: bool, rating in 0.3..4.0f64) {
        let scene = equal(masses, held, rating);
        let responses = Responses::new(1 << 22);
        let solved = |of: &Responses, scene: &Scene| {
            let solution = solved(Shared::EqualChains(of), scene, &EVERYTHING);
            (peaks(&solution.springs), solution.error_bound)
        };
        let first = solved(&responses, &scene);
        prop_assert_eq!(&first, &solved(&responses, &scene));
        prop_assert_eq!(&first, &solved(&Responses::new(0), &scene));
        let (mut mirrored, bound) = solved(&responses, &mirror(&scene));
        mirrored.reverse();
        prop_assert_eq!(&first, &(mirrored, bound));
        prop_assert_eq!(responses.counts(), (2, 1));
    }
}

/// The solution of one scene.
fn solved(shared: Shared, scene: &Scene, ask: &Ask) -> Solution {
    shared.solve_all(&[(scene, *ask)]).swap_remove(0).expect("a solution")
}

/// One march for all loads and ratings of a chain and a source; another for each other source, duration and horizon.
#[test]
fn a_chain_is_marched_once_for_each_source() {
    let mut scene = equal(40, true, 1.4);
    scene.chain.mass[7] = 2.0;
    let responses = Responses::new(1 << 26);
    let solve = |scene: &Scene| solved(Shared::EveryChain(&responses), scene, &EVERYTHING);
    for step in 1..=100 {
        let load = 0.013 * f64::from(step);
        let of_load = |f: &f64| load * f;
        let loaded = Scene {
            force: -load,
            initial: scene.initial.iter().map(of_load).collect(),
            rated_draft: scene.rated_draft.iter().map(|r| r + 0.001 * f64::from(step)).collect(),
            ..scene.clone()
        };
        assert_eq!(solve(&loaded).method, Method::Propagator);
    }
    assert_eq!(responses.counts(), (99, 1));
    for other in [
        Scene { source: 5, ..scene.clone() },
        Scene { duration: 3.0, ..scene.clone() },
        Scene { horizon: 30.0, ..scene.clone() },
    ] {
        solve(&other);
        solve(&Scene { force: 0.5, ..other });
    }
    assert_eq!(responses.counts(), (102, 4));
    // Where only equal chains are shared it has its own solution.
    solved(Shared::EqualChains(&responses), &scene, &EVERYTHING);
    assert_eq!(responses.counts(), (102, 5));
}

/// Masses, stiffnesses and forces in other units, 3 and 7 being no powers of two, have the same response.
#[test]
fn an_equal_chain_in_other_units_is_known() {
    let responses = Responses::new(1 << 20);
    let solve = |scene: &Scene, tolerance: f64| {
        solved(Shared::EqualChains(&responses), scene, &Ask { tolerance, ..EVERYTHING })
    };
    let scene = equal(9, true, 1.0);
    let first = solve(&scene, 1e-9);
    let mut other = scene.clone();
    other.chain.mass.fill(3.0 * 1.3);
    other.chain.stiffness.fill(3.0 * 0.7);
    // A held mass plays no part.
    other.chain.mass[0] = 77.0;
    let lists = [&mut other.initial, &mut other.rated_draft, &mut other.rated_buff];
    lists.into_iter().flatten().for_each(|f| *f *= 7.0);
    other.force *= 7.0;
    let second = solve(&other, 7e-9);
    assert_eq!(responses.counts(), (1, 1), "the response was not known");
    for (a, b) in peaks(&first.springs).iter().zip(peaks(&second.springs)) {
        assert!((7.0 * a.buff.best.value - b.buff.best.value).abs() <= 7.0 * first.error_bound + second.error_bound);
    }
}

/// A coupler that stands at its rating has no verdict from a response: whether it is pushed on or relieved first decides.
#[test]
fn a_spring_at_its_rating_is_solved_by_itself() {
    let mut scene = equal(12, false, 3.0);
    scene.rated_draft[4] = scene.initial[4];
    let responses = Responses::new(1 << 20);
    let shared = solved(Shared::EqualChains(&responses), &scene, &EVERYTHING);
    let own = solve(&scene, &EVERYTHING).expect("a solution");
    assert_eq!((peaks(&shared.springs), shared.error_bound), (peaks(&own.springs), own.error_bound));
    // A bound over the tolerance is no reason to give less than the best method can.
    let strict = Ask { tolerance: 1e-18, ..EVERYTHING };
    scene.rated_draft[4] = 3.0;
    let of = |solution: Solution| (solution.method, solution.error_bound);
    let shared = solved(Shared::EqualChains(&responses), &scene, &strict);
    assert_eq!(of(shared), of(solve(&scene, &strict).expect("a solution")));
}
