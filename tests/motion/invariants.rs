//! What no computation may break: conservation, symmetry, units, proportion.

use crate::scenes::*;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use trainsafe::chain::{Chain, Scene};
use trainsafe::solve::{closed_form, modal, sums};

const CASES: u32 = 24;

/// The same cases at every run.
fn run<S: Strategy>(strategy: S, test: impl Fn(S::Value)) {
    let config = Config { cases: CASES, failure_persistence: None, ..Config::default() };
    let rng = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    let checked = TestRunner::new_with_rng(config, rng).run(&strategy, |value| {
        test(value);
        Ok(())
    });
    if let Err(failure) = checked {
        panic!("{failure}");
    }
}

/// Scenes of 2 to 12 masses, ratios up to 100, any ends, a step or a pulse on any live mass.
fn any_scene() -> impl Strategy<Value = Scene> {
    let size = (2usize..=12, any::<bool>(), any::<bool>(), any::<bool>());
    size.prop_flat_map(|(n, head, tail, equal)| {
        // Two held masses and none between would leave nothing to move.
        let tail = tail && !(head && n == 2);
        let spread = if equal { 1.0 } else { 10.0f64 };
        let value = move || (-1.0..1.0f64).prop_map(move |x| spread.powf(x));
        let masses = proptest::collection::vec(value(), n);
        let springs = proptest::collection::vec(value(), n - 1);
        let loads = proptest::collection::vec(-1.0..1.0f64, n - 1);
        let live = usize::from(head)..n - usize::from(tail);
        let event = (live, prop_oneof![-2.0..-0.1f64, 0.1..2.0f64], prop_oneof![Just(f64::INFINITY), 0.05..9.0f64]);
        (masses, springs, loads, event).prop_map(move |(mass, stiffness, initial, (source, force, duration))| Scene {
            chain: Chain { mass, stiffness, held_head: head, held_tail: tail },
            source,
            force,
            duration,
            initial,
            rated_draft: vec![1.0; n - 1],
            rated_buff: vec![0.8; n - 1],
            horizon: 15.0,
        })
    })
}

/// Forces of every spring at the times, by the scene's own modes (the closed form where there is one).
fn forces(scene: &Scene, times: &[f64]) -> Vec<Vec<f64>> {
    let modes = closed_form::modes(scene).unwrap_or_else(|| modal::modes(scene));
    (0..scene.initial.len()).map(|i| sums::history(scene, &modes, i, times)).collect()
}

/// Weights of the ninth-order rule for an integral over [0, 1] from 10 Gauss-Legendre points, and the points.
const GAUSS: [(f64, f64); 5] = [
    (0.148_874_338_981_631_22, 0.295_524_224_714_752_87),
    (0.433_395_394_129_247_2, 0.269_266_719_309_996_35),
    (0.679_409_568_299_024_4, 0.219_086_362_515_982_04),
    (0.865_063_366_688_984_5, 0.149_451_349_150_580_6),
    (0.973_906_528_517_171_7, 0.066_671_344_308_688_14),
];

/// Points and weights of Gauss-Legendre quadrature over [from, to], panel by panel.
fn quadrature(from: f64, to: f64, panels: usize) -> Vec<(f64, f64)> {
    let width = (to - from) / panels as f64;
    let panel = |p: usize| {
        let middle = from + (p as f64 + 0.5) * width;
        GAUSS.into_iter().flat_map(move |(x, w)| {
            [(middle - 0.5 * width * x, 0.5 * width * w), (middle + 0.5 * width * x, 0.5 * width * w)]
        })
    };
    (0..panels).flat_map(panel).collect()
}

/// Of every spring, the integral of G = F - F(0) from the event to `to`.
fn impulses(scene: &Scene, to: f64) -> Vec<f64> {
    // Frequencies are under 2 sqrt(10 / 0.1) = 20: ten points a quarter of a unit of time apart integrate cos(20 t) over a
    // panel's half width of 1/8, a phase of 2.5, to (2.5)^20 / 20! / 2^20 < 1e-16.
    let acting = to.min(scene.duration);
    let mut nodes = quadrature(0.0, acting, (4.0 * acting).ceil() as usize);
    if to > acting {
        nodes.extend(quadrature(acting, to, (4.0 * (to - acting)).ceil() as usize));
    }
    let times: Vec<f64> = nodes.iter().map(|n| n.0).collect();
    let sum = |(f, initial): (&Vec<f64>, &f64)| f.iter().zip(&nodes).map(|(f, n)| (f - initial) * n.1).sum();
    forces(scene, &times).iter().zip(&scene.initial).map(sum).collect()
}

/// Each mass's velocity from its own equation of motion alone: m v' = G_{v-1} - G_v + p, integrated.
fn velocities(scene: &Scene, to: f64) -> Vec<f64> {
    let impulse = impulses(scene, to);
    let of = |v: usize| {
        let ahead = if v > 0 { impulse[v - 1] } else { 0.0 };
        let behind = impulse.get(v).copied().unwrap_or(0.0);
        let outside = if v == scene.source { scene.force * to.min(scene.duration) } else { 0.0 };
        if scene.chain.live(v) { (ahead - behind + outside) / scene.chain.mass[v] } else { 0.0 }
    };
    (0..scene.chain.mass.len()).map(of).collect()
}

/// The rate of every spring's force, by central differences; `None` too near the end of a pulse.
///
/// Order 8: off by h^8 / 630 times the ninth derivative, under 2 * 20^9, which at h = 1/1000 is 2e-15; rounding of the forces
/// over h is 1e-12.
fn rates(scene: &Scene, t: f64) -> Option<Vec<f64>> {
    const H: f64 = 1e-3;
    const WEIGHTS: [(f64, f64); 4] = [(1.0, 4.0 / 5.0), (2.0, -1.0 / 5.0), (3.0, 4.0 / 105.0), (4.0, -1.0 / 280.0)];
    let times: Vec<f64> = WEIGHTS.iter().flat_map(|w| [t + w.0 * H, t - w.0 * H]).collect();
    let rate = |f: &Vec<f64>| WEIGHTS.iter().zip(f.chunks(2)).map(|(w, f)| w.1 * (f[0] - f[1]) / H).sum();
    ((scene.duration - t).abs() > 5.0 * H).then(|| forces(scene, &times).iter().map(rate).collect())
}

/// Strain and kinetic energy of the motion since the event.
fn energy(scene: &Scene, t: f64) -> f64 {
    let v = velocities(scene, t);
    let kinetic: f64 = v.iter().zip(&scene.chain.mass).map(|(v, m)| 0.5 * m * v * v).sum();
    let force = forces(scene, &[t]);
    let strain = |i: usize| 0.5 * (force[i][0] - scene.initial[i]).powi(2) / scene.chain.stiffness[i];
    kinetic + (0..force.len()).map(strain).sum::<f64>()
}

/// Displacement of the source at `t`: the double integral of its acceleration, by parts.
fn travel(scene: &Scene, t: f64) -> f64 {
    let nodes = quadrature(0.0, t, (4.0 * t).ceil() as usize);
    let times: Vec<f64> = nodes.iter().map(|n| n.0).collect();
    let s = scene.source;
    let all = forces(scene, &times);
    let off = |i: usize, k: usize| all[i][k] - scene.initial[i];
    let push = |k: usize| {
        let ahead = if s > 0 { off(s - 1, k) } else { 0.0 };
        let behind = if s < all.len() { off(s, k) } else { 0.0 };
        ahead - behind + scene.force
    };
    nodes.iter().enumerate().map(|(k, n)| push(k) * (t - n.0) * n.1).sum::<f64>() / scene.chain.mass[s]
}

/// Tolerances below are relative to the sizes at play: forces up to 2 and a few tens of springs, velocities up to 40 / 0.1,
/// each a sum of 600 rounded products. 1e-11 of the sum of sizes is a thousand roundings.
const ROUNDING: f64 = 1e-11;

/// While the force acts, energy is what it has done along the source's way; after it, energy stays.
#[test]
fn energy_is_the_work_of_the_outside_force() {
    run(any_scene(), |scene| {
        let early = scene.duration.min(7.0);
        let (done, held) = (scene.force * travel(&scene, early), energy(&scene, early));
        assert!((done - held).abs() <= ROUNDING * (1.0 + held), "work {done}, energy {held} in {scene:?}");
        if scene.duration.is_finite() {
            let later = energy(&scene, scene.duration + 5.3);
            let at_end = energy(&scene, scene.duration);
            assert!((later - at_end).abs() <= ROUNDING * (1.0 + at_end), "{at_end} then {later} in {scene:?}");
        }
    });
}

/// Springs stretch as the masses beside them part: F_i' = k_i (v_i - v_{i+1}).
#[test]
fn springs_follow_their_masses() {
    run(any_scene(), |scene| {
        let Some(rates) = rates(&scene, 3.7) else { return };
        let v = velocities(&scene, 3.7);
        for (i, rate) in rates.iter().enumerate() {
            let due = scene.chain.stiffness[i] * (v[i] - v[i + 1]);
            let size = scene.chain.stiffness[i] * (v[i].abs() + v[i + 1].abs());
            assert!((rate - due).abs() <= ROUNDING * (1.0 + size), "spring {i}: {rate}, due {due} in {scene:?}");
        }
    });
}

/// A train's momentum is the impulse of the outside force, and of the springs at held ends.
///
/// One mass's velocity is from its own equation of motion, the others' from the rates of the springs between: nothing
/// cancels by construction.
#[test]
fn momentum_follows_the_outside_force() {
    run(any_scene(), |scene| {
        let (t, s) = (6.1, scene.source);
        let Some(rates) = rates(&scene, t) else { return };
        let (mut v, impulse) = (velocities(&scene, t), impulses(&scene, t));
        let parting = |i: usize| rates[i] / scene.chain.stiffness[i];
        for u in s + 1..v.len() {
            v[u] = v[u - 1] - parting(u - 1);
        }
        for u in (0..s).rev() {
            v[u] = v[u + 1] + parting(u);
        }
        let live = (0..v.len()).filter(|&u| scene.chain.live(u));
        let [momentum, size] = live.fold([0.0, 1.0], |[p, size], u| {
            let own = scene.chain.mass[u] * v[u];
            [p + own, size + own.abs()]
        });
        let head = if scene.chain.held_head { impulse[0] } else { 0.0 };
        let tail = if scene.chain.held_tail { impulse[impulse.len() - 1] } else { 0.0 };
        let due = scene.force * t.min(scene.duration) + head - tail;
        // Differences over soft springs and heavy masses: 1e-12 times up to 10 / 0.1, twelve times over.
        assert!((momentum - due).abs() <= 100.0 * ROUNDING * size, "{momentum}, due {due} in {scene:?}");
    });
}

/// The train seen from its other end: places and outside forces turn, spring forces keep.
fn mirrored(scene: &Scene) -> Scene {
    let turn = |x: &Vec<f64>| x.iter().rev().copied().collect::<Vec<f64>>();
    Scene {
        chain: Chain {
            mass: turn(&scene.chain.mass),
            stiffness: turn(&scene.chain.stiffness),
            held_head: scene.chain.held_tail,
            held_tail: scene.chain.held_head,
        },
        source: scene.chain.mass.len() - 1 - scene.source,
        force: -scene.force,
        initial: turn(&scene.initial),
        rated_draft: turn(&scene.rated_draft),
        rated_buff: turn(&scene.rated_buff),
        ..scene.clone()
    }
}

/// Two solutions of the same scene, springs of the second in the order `place`, its forces and times in units of its own.
fn agree(one: &Found, other: &Found, place: impl Fn(usize) -> usize, [force, time]: [f64; 2], scene: &Scene) {
    // Each is within its own bound of the same truth.
    let bound = one.bound + other.bound / force;
    for (i, spring) in one.springs.iter().enumerate() {
        for negative in [false, true] {
            let (a, b) = (spring.side(negative), other.springs[place(i)].side(negative));
            let what = || format!("{} spring {i}: {a:?}, {b:?} in {scene:?}", one.method.name());
            assert!((a.best.value - b.best.value / force).abs() <= bound, "{}", what());
            assert_eq!(a.exceeds(), b.exceeds(), "{}", what());
            if let (Some(a), Some(b)) = (a.first_over, b.first_over) {
                // Slopes at random crossings are over 1e-3 and bounds under 1e-11.
                assert!((a - b / time).abs() <= 1e-7, "{}", what());
            }
        }
    }
}

/// Solutions of a changed scene, by every method, beside those of the scene itself.
fn both<'a>(scene: &'a Scene, changed: &'a Scene) -> impl Iterator<Item = (Found, Found)> + 'a {
    by_all(scene).into_iter().map(|found| {
        let again = by(found.method, changed).expect("the same method is for the changed scene");
        (found, again)
    })
}

#[test]
fn a_train_and_its_mirror_image_agree() {
    run(any_scene(), |scene| {
        let last = scene.initial.len() - 1;
        for (one, other) in both(&scene, &mirrored(&scene)) {
            agree(&one, &other, |i| last - i, [1.0, 1.0], &scene);
        }
    });
}

/// The scene with masses, stiffnesses and forces in other units, times in the square root of mass over stiffness.
fn in_units(scene: &Scene, [mass, stiffness, force]: [f64; 3]) -> Scene {
    let times = |x: &Vec<f64>, unit: f64| x.iter().map(|x| x * unit).collect::<Vec<f64>>();
    let time = (mass / stiffness).sqrt();
    Scene {
        chain: Chain {
            mass: times(&scene.chain.mass, mass),
            stiffness: times(&scene.chain.stiffness, stiffness),
            ..scene.chain.clone()
        },
        force: scene.force * force,
        duration: scene.duration * time,
        initial: times(&scene.initial, force),
        rated_draft: times(&scene.rated_draft, force),
        rated_buff: times(&scene.rated_buff, force),
        horizon: scene.horizon * time,
        ..scene.clone()
    }
}

/// Units of 4^k in mass over stiffness, and powers of two in force, move only exponents: the same bits come out, but for the
/// absolute terms of bounds, which are not scaled.
#[test]
fn units_that_are_powers_of_two_change_no_force() {
    run((any_scene(), -20i32..20, -20i32..20), |(scene, a, b)| {
        let units = [2f64.powi(2 * a), 2f64.powi(2 * b), 2f64.powi(a)];
        let time = 2f64.powi(a - b);
        for (one, other) in both(&scene, &in_units(&scene, units)) {
            agree(&one, &other, |i| i, [units[2], time], &scene);
            for (x, y) in one.springs.iter().zip(&other.springs) {
                for negative in [false, true] {
                    let (x, y) = (x.side(negative).best.value, y.side(negative).best.value / units[2]);
                    assert!((x - y).abs() <= 1e-15 * (1.0 + x.abs()), "{}: {x} {y}", one.method.name());
                }
            }
        }
    });
}

#[test]
fn other_units_change_nothing_beyond_rounding() {
    run((any_scene(), 1e-6..1e6f64, 1e-6..1e6f64, 1e-6..1e6f64), |(scene, mass, stiffness, force)| {
        let time = (mass / stiffness).sqrt();
        for (one, other) in both(&scene, &in_units(&scene, [mass, stiffness, force])) {
            agree(&one, &other, |i| i, [force, time], &scene);
        }
    });
}

/// Load and outside force a times larger: forces a times larger, the ratings as they are.
#[test]
fn forces_are_proportional_to_the_load() {
    run((any_scene(), 0.1..10.0f64), |(scene, factor)| {
        let larger = in_units(&scene, [1.0, 1.0, factor]);
        let larger = Scene { rated_draft: scene.rated_draft.clone(), rated_buff: scene.rated_buff.clone(), ..larger };
        for (one, other) in both(&scene, &larger) {
            let bound = factor * one.bound + other.bound;
            for (a, b) in one.springs.iter().zip(&other.springs) {
                for negative in [false, true] {
                    let (a, b) = (a.side(negative).best.value, b.side(negative).best.value);
                    assert!((factor * a - b).abs() <= bound, "{} {a} {b} in {scene:?}", one.method.name());
                }
            }
        }
    });
}

/// A verdict is the peak beside the rating; no peak is under the force before the event; no force seen at any instant is
/// over the peak; before the first exceedance nothing is over the rating.
#[test]
fn verdicts_follow_from_the_forces() {
    run(any_scene(), |scene| {
        let times: Vec<f64> = (0..400).map(|n| scene.horizon * f64::from(n) / 399.0).collect();
        let seen = forces(&scene, &times);
        for found in by_all(&scene) {
            for (i, spring) in found.springs.iter().enumerate() {
                for (negative, sign, rating) in [(false, 1.0, scene.rated_draft[i]), (true, -1.0, scene.rated_buff[i])]
                {
                    let side = spring.side(negative);
                    let what = || format!("{} spring {i} {negative}: {side:?} in {scene:?}", found.method.name());
                    assert!(side.best.value >= sign * scene.initial[i], "{}", what());
                    match side.exceeds() {
                        Some(over) => assert_eq!(over, side.best.value > rating, "{}", what()),
                        None => assert!((side.best.value - rating).abs() <= 2.0 * found.bound, "{}", what()),
                    }
                    for (&t, f) in times.iter().zip(&seen[i]) {
                        // Both come with the method's bound, and the peak with a grain of it.
                        assert!(sign * f <= side.best.value + 3.0 * found.bound, "at {t}: {f}, {}", what());
                        let early = side.first_over.is_none_or(|first| t < first - 1e-7);
                        assert!(!early || sign * f <= rating + 3.0 * found.bound, "at {t}: {f}, {}", what());
                    }
                }
            }
        }
    });
}
