//! Scenes solved once: the same bits remembered or not, mirrored or not, and within the bound of the scene's own solution.

use proptest::prelude::*;
use trainsafe::chain::{Chain, Scene};
use trainsafe::solve::memo::Memo;
use trainsafe::solve::watch::SpringPeaks;
use trainsafe::solve::{Ask, Solution, Wanted, solve};

const ASK: Ask = Ask {
    tolerance: 1e-9,
    method: None,
    verdict_only: false,
    all_time_bound: true,
    wanted: Wanted::Everything,
    mark: None,
};

/// A chain of equal or unequal masses with its last mass pulled; `seed` sets the numbers.
fn scene(masses: usize, equal: bool, held_head: bool, seed: u32, rating: f64) -> Scene {
    let number = |i: usize, k: u32| 0.5 + f64::from((i as u32 * 37 + seed * 101 + k * 13) % 64) / 64.0;
    let mass = |i: usize| if equal { number(0, 1) } else { number(i, 1) };
    let stiffness = |i: usize| if equal { number(0, 2) } else { number(i, 2) };
    let springs = masses - 1;
    Scene {
        chain: Chain {
            mass: (0..masses).map(mass).collect(),
            stiffness: (0..springs).map(stiffness).collect(),
            held_head,
            held_tail: false,
        },
        source: springs,
        force: number(3, 3),
        duration: f64::INFINITY,
        initial: (0..springs).map(|i| 0.4 * number(i, 4)).collect(),
        rated_draft: vec![rating; springs],
        rated_buff: vec![0.9 * rating; springs],
        horizon: 6.0 * masses as f64,
    }
}

fn mirror(scene: &Scene) -> Scene {
    let mut mirror = scene.clone();
    let lists = [&mut mirror.chain.mass, &mut mirror.chain.stiffness, &mut mirror.initial];
    lists.into_iter().for_each(|list| list.reverse());
    (mirror.chain.held_head, mirror.chain.held_tail) = (scene.chain.held_tail, scene.chain.held_head);
    mirror.source = scene.chain.mass.len() - 1 - scene.source;
    mirror.force = -scene.force;
    mirror
}

fn peaks(solution: &Solution) -> Vec<SpringPeaks> {
    solution.springs.iter().map(|s| s.expect("every spring was asked for")).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn remembered_and_mirrored_scenes_are_the_same_to_the_bit(
        masses in 2usize..20, equal: bool, held: bool, seed in 0u32..1000, rating in 0.3..4.0
    ) {
        let scene = scene(masses, equal, held, seed, rating);
        let memo = Memo::new(1 << 20);
        let first = peaks(&memo.solve(&scene, &ASK).expect("a solution"));
        let (_, solved) = memo.counts();
        let again = peaks(&memo.solve(&scene, &ASK).expect("a solution"));
        let mut mirrored = peaks(&memo.solve(&mirror(&scene), &ASK).expect("a solution"));
        mirrored.reverse();
        let never = peaks(&Memo::new(0).solve(&scene, &ASK).expect("a solution"));
        prop_assert_eq!(memo.counts(), (2 * solved, solved));
        prop_assert_eq!(&first, &again);
        prop_assert_eq!(&first, &mirrored);
        prop_assert_eq!(&first, &never);
    }

    /// Both solutions are within their bounds of the truth, and their peaks within as much of each other.
    #[test]
    fn the_canonical_form_keeps_the_forces(
        masses in 2usize..20, equal: bool, held: bool, seed in 0u32..1000, rating in 0.3..4.0
    ) {
        let scene = scene(masses, equal, held, seed, rating);
        let own = solve(&scene, &ASK).expect("a solution");
        let through = Memo::new(0).solve(&scene, &ASK).expect("a solution");
        let apart = own.error_bound + through.error_bound;
        for (a, b) in peaks(&own).iter().zip(peaks(&through)) {
            for (a, b) in [(a.draft, b.draft), (a.buff, b.buff)] {
                prop_assert_eq!(a.first_over.is_some(), b.first_over.is_some());
                // A crossing is found on a curve that is right to within the bound, and none here is flatter than a
                // thousandth of it per unit of time.
                let crossings = (a.first_over.unwrap_or(0.0), b.first_over.unwrap_or(0.0));
                prop_assert!((crossings.0 - crossings.1).abs() < 1e3 * apart.max(1e-13), "{:?}", crossings);
                prop_assert!((a.best.value - b.best.value).abs() <= apart, "{:?} {:?} {apart:e}", a, b);
                prop_assert_eq!(a.exceeds(), b.exceeds());
            }
        }
    }
}

/// Masses, stiffnesses and forces in other units, 3 and 7 being no powers of two, are the same scene.
#[test]
fn a_scene_in_other_units_is_known() {
    let memo = Memo::new(1 << 20);
    let mut scene = scene(9, true, true, 5, 1.0);
    scene.initial.fill(0.5);
    scene.force = 0.5;
    (scene.rated_draft, scene.rated_buff) = (vec![1.0; 8], vec![1.0; 8]);
    scene.chain.mass.fill(1.0);
    scene.chain.stiffness.fill(1.0);
    let first = memo.solve(&scene, &ASK).expect("a solution");
    let mut other = scene.clone();
    other.chain.mass.fill(3.0);
    other.chain.stiffness.fill(3.0);
    // A held mass plays no part.
    other.chain.mass[0] = 77.0;
    for list in [&mut other.initial, &mut other.rated_draft, &mut other.rated_buff] {
        list.iter_mut().for_each(|f| *f *= 7.0);
    }
    other.force *= 7.0;
    let ask = Ask { tolerance: 7.0 * ASK.tolerance, ..ASK };
    let second = memo.solve(&other, &ask).expect("a solution");
    let larger = |s: &SpringPeaks| 7.0 * s.buff.best.value;
    let (a, b): (Vec<f64>, Vec<f64>) =
        (peaks(&first).iter().map(larger).collect(), peaks(&second).iter().map(|s| s.buff.best.value).collect());
    assert_eq!(memo.counts(), (1, 1), "the scene was not known");
    assert_eq!(a, b);
}

/// Trains that differ in their ratings alone share a solution where no rating is reached, and have their own where one is.
#[test]
fn ratings_out_of_reach_do_not_matter() {
    let memo = Memo::new(1 << 20);
    let mut scene = scene(12, true, false, 7, 5.0);
    scene.initial.fill(scene.force);
    memo.solve(&scene, &ASK).expect("a solution");
    for rating in [4.0, 4.7, 5.5] {
        scene.rated_draft.fill(rating);
        let solution = memo.solve(&scene, &ASK).expect("a solution");
        assert!(peaks(&solution).iter().all(|s| s.draft.exceeds() == Some(false)));
    }
    assert_eq!(memo.counts(), (3, 1));
    scene.rated_draft.fill(0.99 * scene.force);
    let solution = memo.solve(&scene, &ASK).expect("a solution");
    assert!(peaks(&solution).iter().all(|s| s.draft.exceeds() == Some(true) && s.draft.first_over == Some(0.0)));
    assert_eq!(memo.counts(), (3, 2));
}
