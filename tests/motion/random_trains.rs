//! A sample of the campaign: stated bounds against a reference of 30 digits and more, on random trains and scenes.
//!
//! All 2,000 scenes: `cargo run --release --example campaign -- 2000`, and with `--kinds` beside it.

use crate::campaign::{self, Fault};
use trainsafe::chain::Scene;
use trainsafe::solve::path::Path;
use trainsafe::solve::{Ask, Method, observers, propagator, solve};

/// Every extreme is within its stated bound of the truth, every verdict is true, every time is the right one.
#[test]
fn bounds_and_verdicts_hold_on_a_sample() {
    // Everything is slow without optimisation: short trains here, of all kinds, over not too many periods.
    let short = |&seed: &u64| {
        let scene = campaign::scene(seed);
        scene.initial.len() <= 6 && scene.horizon * Path::new(&scene.chain).omega_max() < 500.0
    };
    // And some hard ones: a sixfold frequency, modes left out under a short pulse, pushes from the rating.
    let hard = [164, 742, 981, 1465];
    let seeds: Vec<u64> = (0..1000).filter(short).take(40).chain(hard).collect();
    let outcome = campaign::run(&seeds);
    assert!(outcome.refused.is_empty(), "no reference: {:?}", outcome.refused);
    for row in &outcome.rows {
        assert!(row.scenes > 5, "{} was run on {} scenes only", row.name(), row.scenes);
        assert!(row.worst <= 1.0, "{}: error {} times the bound on seed {}", row.name(), row.worst, row.worst_seed);
        let wrong: Vec<_> = row.wrong.iter().map(|(fault, seeds)| (Fault::name(*fault), seeds)).collect();
        assert!(wrong.is_empty(), "{}: {wrong:?}", row.name());
    }
}

/// What analyses say of trains with every kind of scenario, on a sample: nothing is further from the truth than it may be.
#[test]
fn analyses_hold_on_a_sample_of_every_kind() {
    // Three of each kind, of short trains: the reference is slow without optimisation.
    let short = |seed: &u64| campaign::trains::draw(*seed).system.mass.len() < 10;
    let kinds = campaign::trains::Kind::ALL;
    let of_kind = |kind: usize| (0..).map(move |n| kind as u64 + n * kinds.len() as u64).filter(short).take(3);
    // And some with a load that is its rating, or the load that breaks a coupler, but for the rounding of the load.
    let seeds: Vec<u64> = (0..kinds.len()).flat_map(of_kind).chain([307, 60267, 60318, 60500, 60583, 60631]).collect();
    let (scenes, tallies) = campaign::kinds::run(&seeds);
    assert!(kinds.iter().all(|kind| scenes[kind] >= 3));
    let compared: usize = tallies.values().map(|t| t.compared).sum();
    assert!(compared > 1000, "{compared}");
    let wrong: Vec<_> = tallies.values().flat_map(|t| &t.wrong).collect();
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// One in 40 of the 400 trains with slack, gears and brakes: `cargo run --release --example campaign -- --gears 400 1000`.
#[test]
fn the_estimate_of_a_march_covers_its_error() {
    let seeds: Vec<u64> = (1000..1014).collect();
    let tallies = campaign::gears::run(&seeds);
    assert!(campaign::gears::GearKind::ALL.iter().all(|kind| tallies[kind].trains == 2));
    for (kind, tally) in &tallies {
        // Two trains of eight vehicles at least.
        assert!(tally.peaks >= 28, "{kind:?}");
        assert_eq!(tally.missed, [], "{kind:?}");
        assert_eq!((&tally.other_order, &tally.without_reference), (&vec![], &vec![]), "{kind:?}");
        assert!(tally.worst_proven.0 <= 1.0, "{kind:?}");
    }
}

/// Marched to coarse tolerances, 200 chains: extremes are as near those of a fine march as both bounds say, and are reached at the times given;
/// verdicts are the same, or undecided in few cases.
#[test]
fn coarse_marches_hold_their_bounds() {
    let steps = |scene: &Scene| propagator::steps(scene, propagator::omega_max(scene));
    let scenes = (0..).map(campaign::scene).filter(|scene| steps(scene) * (scene.initial.len() as f64) < 2e4).take(200);
    let (mut ignored, mut decided, mut undecided, mut looks) = (0, 0, 0, [0; 2]);
    for scene in scenes {
        let solved = |tolerance: f64| {
            let ask = Ask { tolerance, method: Some(Method::Propagator), ..Ask::default() };
            solve(&scene, &ask).expect("a solution")
        };
        let ratings = scene.rated_draft.iter().chain(&scene.rated_buff);
        let largest = ratings.fold(scene.force.abs(), |largest, &rating| largest.max(rating));
        let fine = solved(0.0);
        for share in [1e-3, 1e-6] {
            let coarse = solved(share * largest);
            assert!(coarse.error_bound <= (share * largest).max(fine.error_bound));
            looks[0] += coarse.work.refinements;
            looks[1] += fine.work.refinements;
            for (spring, (a, b)) in coarse.springs.iter().flatten().zip(fine.springs.iter().flatten()).enumerate() {
                for negative in [false, true] {
                    let (a, b) = (a.side(negative), b.side(negative));
                    let below = b.best.value - a.best.value;
                    assert!(below.abs() <= coarse.error_bound + fine.error_bound, "{below:e}");
                    ignored += usize::from(below > 1e-9 * largest);
                    if let (Some(a), Some(b)) = (a.exceeds(), b.exceeds()) {
                        assert_eq!(a, b);
                        decided += 1;
                    }
                    undecided += usize::from(a.exceeds().is_none() && b.exceeds().is_some());
                    let apart = a.first_over.zip(b.first_over).map_or(0.0, |(a, b)| (a - b).abs());
                    assert!(apart <= 1e-3 * scene.horizon, "{apart:e}");
                    if a.best.at > 0.0 {
                        let there = observers::history(&scene, propagator::omega_max(&scene), spring, &[a.best.at])[0];
                        let there = if negative { -there } else { there };
                        assert!((there - a.best.value).abs() <= coarse.error_bound, "{there} {}", a.best.value);
                    }
                }
            }
        }
    }
    assert!(ignored > 100, "{ignored} extremes are not the largest");
    assert!(100 * undecided < decided, "{undecided} verdicts are decided by fine marches alone, {decided} by both");
    assert!(looks[0] < looks[1], "{looks:?}");
}
