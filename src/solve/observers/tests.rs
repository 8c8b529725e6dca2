use super::super::propagator::{error_bound, omega_max};
use super::super::{modal, sums};
use super::*;

/// An unequal chain with a held head, pulled at its tail, by a step or a pulse.
fn unequal(duration: f64) -> Scene {
    let mass: Vec<f64> = (0..40).map(|v| 1.0 + 0.6 * f64::from(v * v).sin()).collect();
    let stiffness: Vec<f64> = (0..39).map(|i| 1.0 + 0.4 * f64::from(i * i).cos()).collect();
    let chain = crate::chain::Chain { mass, stiffness, held_head: true, held_tail: false };
    let (initial, rated) = (vec![0.5; 39], vec![1.2; 39]);
    let (rated_draft, rated_buff) = (rated.clone(), rated);
    Scene { chain, source: 39, force: -0.5, duration, initial, rated_draft, rated_buff, horizon: 150.0 }
}

fn march_ask(scene: &Scene) -> MarchAsk<'_> {
    MarchAsk { mark: Some(60.0), ..MarchAsk::all(scene, omega_max(scene)) }
}

/// Foreseen levels are just under the peaks of a search without them, and do not change these; a search that
/// expects more than the peaks gives `None`.
#[test]
fn foreseen_levels_change_nothing() {
    for duration in [f64::INFINITY, 20.0] {
        let scene = unequal(duration);
        let (motion, omega) = (Motion::new(&scene), omega_max(&scene));
        let scenes = [Marched { scene: &scene, motion: &motion, omega }];
        let find = |expected| peaks_from(&[march_ask(&scene)], &scenes, vec![expected]).swap_remove(0);
        let levels = foresee::levels(&scenes, &[60.0]).swap_remove(0);
        let ([plain, to_mark], _) = find(None).expect("nothing was expected");
        for (found, levels) in [(&to_mark, &levels[0]), (&plain, &levels[1])] {
            for (peaks, level) in found.iter().zip(levels) {
                for negative in [false, true] {
                    let below = peaks.side(negative).best.value - level[usize::from(negative)];
                    assert!((0.0..0.2).contains(&below), "{below}");
                }
            }
        }
        let ([with, _], _) = find(Some(levels.clone())).expect("no more than there is was expected");
        let bound = error_bound(&scene, omega);
        for (a, b) in with.iter().zip(&plain) {
            assert!((a.draft.best.value - b.draft.best.value).abs() <= bound);
            assert_eq!((a.draft.exceeds(), a.buff.exceeds()), (b.draft.exceeds(), b.buff.exceeds()));
        }
        let mut more = levels;
        more[1][7][0] = plain[7].draft.best.value + 1e-6;
        assert!(find(Some(more)).is_none());
    }
}

/// Scenes side by side have the same peaks as one by one, to the last bit: horizons and steps differ, and so do lengths.
#[test]
fn side_by_side_is_as_one_by_one() {
    let scene = |springs: usize| {
        let mut scene = unequal(f64::INFINITY);
        scene.chain.mass.truncate(springs + 1);
        [&mut scene.chain.stiffness, &mut scene.initial, &mut scene.rated_draft, &mut scene.rated_buff]
            .into_iter()
            .for_each(|row| row.truncate(springs));
        scene.source = springs;
        scene.horizon = 100.0 + 3.7 * springs as f64;
        scene
    };
    let scenes: Vec<Scene> = [39, 12, 1, 30, 38, 7].map(scene).into();
    for wanted in [Wanted::Everything, Wanted::Worst] {
        let asks: Vec<MarchAsk> = scenes.iter().map(|scene| MarchAsk { wanted, ..march_ask(scene) }).collect();
        let together = peaks(&asks);
        for (march_ask, (found, work)) in asks.iter().zip(&together) {
            let (alone, work_alone) = peaks(&[*march_ask]).swap_remove(0);
            assert_eq!(*found, alone);
            assert_eq!(work.marched, work_alone.marched);
        }
    }
}

/// The force stops to act soon before the horizon, by less than half a step of its own: forces at times behind that are those of the sum
/// over modes.
#[test]
fn a_pulse_may_end_just_before_the_horizon() {
    let mut scene = unequal(149.7);
    scene.horizon = 150.0;
    let times = [140.0, 149.65, 149.7, 149.8, 150.0];
    let modes = modal::modes(&scene);
    for spring in [0, 20, 38] {
        let marched = history(&scene, omega_max(&scene), spring, &times);
        let summed = sums::history(&scene, &modes, spring, &times);
        for (a, b) in marched.iter().zip(&summed) {
            assert!((a - b).abs() < 1e-9, "{spring}: {a} {b}");
        }
    }
}

/// Without vectors all is the same to the last bit, of one chain and of several side by side, and so is the work.
#[test]
fn vectors_change_nothing() {
    let scenes = [unequal(f64::INFINITY), Scene { horizon: 110.0, ..unequal(f64::INFINITY) }];
    let pulse = unequal(20.0);
    let find = || {
        let together = peaks(&scenes.each_ref().map(march_ask));
        format!("{together:?} {:?}", peaks(&[march_ask(&pulse)]))
    };
    let with = find();
    super::super::vectors::use_scalars(true);
    let without = find();
    super::super::vectors::use_scalars(false);
    assert_eq!(with, without);
}
