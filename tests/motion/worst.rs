//! Asked for the worst alone: what a row of a fleet says is the same to the bit, for a small part of the looks.

use crate::campaign::{row::WorstRow, scene};
use crate::scenes::EVERYTHING;
use proptest::prelude::*;
use trainsafe::chain::{Chain, Scene};
use trainsafe::solve::responses::{Responses, Shared};
use trainsafe::solve::watch::SpringPeaks;
use trainsafe::solve::{Ask, Method, Solution, Wanted, solve};

const WORST: Ask = Ask { wanted: Wanted::Worst, ..EVERYTHING };

fn solved(scene: &Scene, ask: &Ask) -> Solution {
    solve(scene, ask).expect("a solution")
}

fn solved_from(shared: Shared, scene: &Scene, ask: &Ask) -> Solution {
    shared.solve_all(&[(scene, *ask)]).swap_remove(0).expect("a solution")
}

/// Equal masses and couplers under an even load, whose end is let go.
fn uniform(springs: usize, held_head: bool, rating: f64) -> Scene {
    Scene {
        chain: Chain { mass: vec![1.0; springs + 1], stiffness: vec![1.0; springs], held_head, held_tail: false },
        source: springs,
        force: 1.0,
        duration: f64::INFINITY,
        initial: vec![1.0; springs],
        rated_draft: vec![rating; springs],
        rated_buff: vec![rating; springs],
        horizon: 4.0 * springs as f64,
    }
}

/// Ratings by what the forces come to: far from it, at it to the last bits, at the load, or one for all.
fn rated(mut scene: Scene, peaks: &[SpringPeaks], kind: usize, share: f64) -> Scene {
    let largest = peaks.iter().map(|p| p.draft.best.value.max(p.buff.best.value)).fold(0.0, f64::max);
    for (i, peaks) in peaks.iter().enumerate() {
        let rating = |negative: bool| {
            let initial = if negative { -scene.initial[i] } else { scene.initial[i] };
            let peak = peaks.side(negative).best.value;
            let wanted = match (kind, (i + usize::from(negative)) % 5) {
                (0, _) => share * largest,
                (1, _) => share * if negative { 0.8 } else { 1.0 } * largest,
                (2, 0) => peak,
                (2, 1) => peak * (1.0 + 1e-13),
                (2, 2) => initial,
                (2, 3) => peak * (1.0 - 1e-9),
                (3, 0) => 0.7 * share * largest,
                (_, place) => share * largest * (1.0 + 0.1 * place as f64),
            };
            if wanted > 0.0 { wanted } else { largest.max(0.1) }
        };
        (scene.rated_draft[i], scene.rated_buff[i]) = (rating(false), rating(true));
    }
    scene
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(60) })]

    #[test]
    fn a_row_is_the_same_to_the_bit(seed in 0u64..1_000_000, kind in 0usize..4, share in 0.3..1.5) {
        let bare = scene(seed);
        let peaks: Option<Vec<SpringPeaks>> = solved(&bare, &EVERYTHING).springs.into_iter().collect();
        let scene = rated(bare, &peaks.expect("every spring"), kind, share);
        for method in [None, Some(Method::Fronts), Some(Method::Propagator)] {
            let by = |ask: Ask| solve(&scene, &Ask { method, ..ask }).ok().map(|s| (WorstRow::of(&scene, &s), s));
            let (Some((all, everything)), Some((row, worst))) = (by(EVERYTHING), by(WORST)) else { continue };
            prop_assert!(row.agrees(&all, &scene), "{:?}: {:?} instead of {:?}", method, row, all);
            // What is not wanted is a lower bound; the same rounding goes into both.
            let both = everything.springs.iter().zip(&worst.springs);
            for (of_all, of_worst) in both.filter_map(|(all, worst)| all.as_ref().zip(worst.as_ref())) {
                prop_assert!(of_worst.draft.best.value <= of_all.draft.best.value + everything.error_bound);
                prop_assert!(of_worst.buff.best.value <= of_all.buff.best.value + everything.error_bound);
            }
        }
        let responses = Responses::new(1 << 20);
        let [all, row] = [EVERYTHING, WORST].map(|ask| {
            let solution = solved_from(Shared::EveryChain(&responses), &scene, &ask);
            WorstRow::of(&scene, &solution)
        });
        prop_assert!(row.agrees(&all, &scene), "{:?} instead of {:?}", row, all);
    }

    /// Of springs that symmetry makes alike the first is the worst, whatever is asked for.
    #[test]
    fn alike_springs_and_shared_solutions(half in 1usize..20, held: bool, rating in 0.9..3.0f64, buff in 0.5..1.5f64) {
        let mut scene = uniform(2 * half, held, rating);
        scene.rated_buff.fill(buff * rating);
        if !held {
            (scene.source, scene.duration) = (half, 0.7 * half as f64);
        }
        let responses = Responses::new(1 << 20);
        for rating in [scene.rated_draft[0], 5.0, 7.0] {
            scene.rated_draft.fill(rating);
            scene.rated_buff.fill(buff * rating);
            let [all, row] = [EVERYTHING, WORST].map(|ask| {
                let solution = solved_from(Shared::EqualChains(&responses), &scene, &ask);
                WorstRow::of(&scene, &solution)
            });
            prop_assert_eq!(row, all);
        }
    }
}

/// Of hundreds of steps of a march a few are left: a tenth of them would be far more.
#[test]
fn few_steps_are_looked_into() {
    for (held, rating) in [(true, 3.0), (true, 1.2), (false, 1.05)] {
        let scene = uniform(100, held, rating);
        let looks = |ask: Ask| solved(&scene, &Ask { method: Some(Method::Propagator), ..ask }).work.refinements;
        let (all, few) = (looks(EVERYTHING), looks(WORST));
        assert!(all > 100 && 10 * few <= all, "{few} of {all} at a rating of {rating}");
    }
}
