//! Extreme trains against references of 120 digits and more: each bound holds, and is small.

use crate::scenes::*;
use nalgebra::{DMatrix, SymmetricEigen};
use serde::Deserialize;
use trainsafe::chain::{Chain, Scene};
use trainsafe::solve::observers::{self, MarchAsk};
use trainsafe::solve::path::Path;
use trainsafe::solve::{Ask, Method, propagator, solve};

/// Holds every scene whose name begins so against its reference, by every method that is for it.
fn hold(beginning: &str) {
    let all = references(include_str!("../reference/extremes.json"));
    let chosen: Vec<&Reference> = all.iter().filter(|r| r.name.starts_with(beginning)).collect();
    assert!(!chosen.is_empty(), "no reference begins with {beginning:?}");
    let found: Vec<String> = chosen.into_iter().flat_map(all_departures).collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn one_coupler() {
    hold("one coupler");
}

#[test]
fn two_couplers() {
    hold("two couplers");
}

#[test]
fn mass_ratio_1e12_alternating() {
    hold("mass ratio 1e12, alternating");
}

#[test]
fn mass_ratio_1e12_one_light() {
    hold("one mass of 1e-12");
}

#[test]
fn mass_ratio_1e12_one_heavy() {
    hold("one mass of 1e12");
}

#[test]
fn stiffness_ratio_1e12_alternating() {
    hold("stiffness ratio 1e12, alternating");
}

#[test]
fn stiffness_ratio_1e12_one_stiff() {
    hold("one spring of 1e12");
}

#[test]
fn stiffness_ratio_1e12_one_soft() {
    hold("one spring of 1e-12");
}

#[test]
fn one_kg_in_10000_t() {
    hold("1 kg in 10000 t");
}

#[test]
fn drawbars_ten_thousand_times_as_stiff() {
    hold("drawbars 1e+04");
}

#[test]
fn drawbars_a_billion_times_as_stiff() {
    hold("drawbars 1e+09");
}

#[test]
fn horizon_of_a_million_time_units() {
    hold("horizon 1e6");
}

#[test]
fn pulse_of_1e_9_of_a_period() {
    hold("pulse of 1e-9 of a period");
}

#[test]
fn pulse_of_a_period_of_a_mode() {
    hold("pulse of a period of a mode");
    hold("pulse of the fastest mode's period");
}

#[test]
fn pulse_as_long_as_the_horizon_and_longer() {
    hold("pulse longer than the horizon");
    hold("pulse as long as the horizon");
}

#[test]
fn equal_frequencies() {
    hold("equal halves");
    hold("equal blocks");
}

/// By the methods that are for long trains, on a few springs.
#[test]
fn three_thousand_vehicles() {
    for reference in references(include_str!("../reference/long.json")) {
        let scene = reference.scene();
        let found = by(Method::Fronts, &scene).unwrap_or_else(|| marched(&scene));
        let departures = departures(&reference, &scene, &found);
        assert!(departures.is_empty(), "{}", departures.join("\n"));
        assert!(found.bound < TOLERANCE, "{} {:e}", reference.name, found.bound);
    }
}

fn marched(scene: &Scene) -> Found {
    let omega = propagator::omega_max(scene);
    let springs = observers::peaks(&[MarchAsk::all(scene, omega)])[0].0[0].clone();
    Found { method: Method::Propagator, springs, bound: propagator::error_bound(scene, omega) }
}

/// A scene that rests under no load, with a step of force at one mass.
fn pushed(mass: &[f64], stiffness: &[f64], held_tail: bool, source: usize, force: f64, horizon: f64) -> Scene {
    let springs = stiffness.len();
    Scene {
        chain: Chain { mass: mass.to_vec(), stiffness: stiffness.to_vec(), held_head: true, held_tail },
        source,
        force,
        duration: f64::INFINITY,
        initial: vec![0.0; springs],
        rated_draft: vec![1e3; springs],
        rated_buff: vec![1e3; springs],
        horizon,
    }
}

/// Light vehicles among heavy ones swing a hundred thousand times within the horizon, at few frequencies, and pass their
/// largest force again and again. No reference goes so far: two methods that share nothing agree within their bounds, and the
/// search looks into few of the many peaks.
#[test]
fn recurring_peaks_of_few_light_vehicles() {
    for (mass, stiffness) in [
        (vec![1e4, 2.0, 1e4, 3.0, 1e4], vec![1.0; 4]),
        (vec![1e5, 1.0, 2.5, 1e5, 1.5, 1e5], vec![1.0, 2.0, 1.0, 3.0, 1.0]),
        (vec![1.0, 3e4, 1.0, 7e4, 2.0, 1e5], vec![1.0; 5]),
        (vec![2.0, 1e6, 1.0], vec![1.0, 50.0]),
    ] {
        let springs = stiffness.len();
        let mut scene = pushed(&mass, &stiffness, false, springs, -1.0, 0.0);
        scene.horizon = 400.0 * scene.chain.transit();
        let omega = propagator::omega_max(&scene);
        let ask = Ask { tolerance: 1e-9, method: Some(Method::Modal), ..Ask::default() };
        let by_modes = solve(&scene, &ask).expect("a solution");
        let by_steps = observers::peaks(&[MarchAsk::all(&scene, omega)])[0].0[0].clone();
        let bound = by_modes.error_bound + propagator::error_bound(&scene, omega);
        assert!(by_modes.error_bound <= ask.tolerance);
        for (modes, steps) in by_modes.springs.iter().map(|s| s.expect("asked for")).zip(by_steps) {
            for negative in [false, true] {
                let difference = (modes.side(negative).best.value - steps.side(negative).best.value).abs();
                assert!(difference <= bound, "{difference:e} {bound:e}");
            }
        }
        let cells = propagator::steps(&scene, omega) * springs as f64;
        assert!((by_modes.work.refinements as f64) < 1e-3 * cells);
    }
}

/// A swing that first passes its rating long before its largest one does: where the sum over modes has to look among fast
/// modes for it, it looks as long as it takes.
#[test]
fn a_first_exceedance_among_fast_modes_is_the_first() {
    let mut scene = pushed(&[1.0, 1.25e-3, 0.927], &[0.739, 1.206], false, 2, 1.0, 49.0);
    for share in [0.656, 0.8, 0.95, 0.99] {
        let found = |method| {
            let ask = Ask { tolerance: 1e-9, method: Some(method), ..Ask::default() };
            let springs = solve(&scene, &ask).expect("a solution").springs;
            springs.into_iter().map(|s| s.expect("asked for").buff).collect::<Vec<_>>()
        };
        let (modal, marched) = (found(Method::Modal), found(Method::Propagator));
        for (modal, marched) in modal.iter().zip(&marched) {
            assert_eq!(modal.exceeds(), marched.exceeds());
            if let (Some(a), Some(b)) = (modal.first_over, marched.first_over) {
                assert!((a - b).abs() < 1e-9, "{share}: {a} {b}");
            }
        }
        scene.rated_buff = marched.iter().map(|side| share * side.best.value).collect();
    }
}

/// A slow swing of 1 - cos t, beside one 3e4 times as fast that carries next to nothing, has its top of 2 at the very end of a
/// step: the slopes over the steps on either side of it are lost to rounding.
#[test]
fn a_peak_at_the_end_of_a_step_is_not_lost() {
    const LIGHT: f64 = 1e-9;
    let scene = |horizon: f64| pushed(&[1.0, 1.0, LIGHT], &[1.0, 1.0], false, 1, -1.0, horizon);
    // The slower root of LIGHT x^2 - (1 + 2 LIGHT) x + 1 = 0, x = omega^2.
    let b = 1.0 + 2.0 * LIGHT;
    let top = std::f64::consts::PI * (0.5 * (b + (b * b - 4.0 * LIGHT).sqrt())).sqrt();
    let until_top = propagator::steps(&scene(top), propagator::omega_max(&scene(top)));
    let mut aligned = 0;
    for part in 0..200 {
        let count = (until_top * (1.1 + 0.01 * f64::from(part))).floor();
        let scene = scene(top * count / until_top + 1e-15 * f64::from(part % 8));
        let omega = propagator::omega_max(&scene);
        if propagator::steps(&scene, omega) != count || aligned == 20 {
            continue;
        }
        aligned += 1;
        let peaks = observers::peaks(&[MarchAsk::all(&scene, omega)])[0].0[0].clone();
        let largest = peaks[0].draft.best.value;
        // A light mass's own swing is of the order of its share.
        assert!((largest - 2.0).abs() < 4.0 * LIGHT, "{count} steps: {largest}");
    }
    assert!(aligned > 5, "{aligned}");
}

/// A horizon a little behind the end of a step counts as well.
#[test]
fn nothing_before_the_horizon_is_left_out() {
    for steps in 2..12 {
        for behind in [0.0, 1e-15, 5e-10, 1e-6] {
            let horizon = 0.75 * f64::from(steps) + behind;
            let mut scene = pushed(&[1.0; 12], &[1.0; 11], false, 11, -1.0, horizon);
            scene.duration = 3.0;
            let by = |method| {
                let found = by(method, &scene).expect("a scene for it");
                (found.springs, found.bound)
            };
            let ((fronts, a), (marched, b)) = (by(Method::Fronts), by(Method::Propagator));
            for (fronts, marched) in fronts.iter().zip(&marched) {
                for negative in [false, true] {
                    let values = [fronts, marched].map(|side| side.side(negative).best.value);
                    assert!((values[0] - values[1]).abs() <= a + b, "{horizon}: {values:?}");
                }
            }
        }
    }
}

/// A rating set a little over or under a peak: never the wrong verdict, and none at all within the bound.
#[test]
fn a_peak_near_the_rating_is_decided_rightly_or_not_at_all() {
    let all = references(include_str!("../reference/unequal.json"));
    let reference = all.iter().find(|r| r.name.starts_with("60 vehicles, held head")).expect("reference");
    let mut undecided = 0;
    for spring in [0, 13, 40, 58] {
        let due = &reference.springs[spring].buff;
        assert!(due.time.0 > 0.0);
        for distance in [1e-6, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14, 1e-15, 0.0] {
            for side in [-1.0, 1.0] {
                let mut scene = reference.scene();
                scene.rated_buff[spring] = due.peak.0 * (1.0 + side * distance);
                let margin = due.peak.0 - scene.rated_buff[spring];
                for found in by_all(&scene) {
                    let verdict = found.springs[spring].buff.exceeds();
                    let what =
                        format!("{} spring {spring} margin {margin:e} bound {:e}", found.method.name(), found.bound);
                    // The peak as computed is within the bound of the truth, so that beyond twice the bound it is decided.
                    let certain = margin.abs() > 2.0 * found.bound;
                    match verdict {
                        Some(over) => assert!(over == (margin > 0.0) && margin.abs() > 0.0, "{what}"),
                        None => assert!(!certain, "{what}"),
                    }
                    undecided += u32::from(verdict.is_none());
                }
            }
        }
    }
    assert!(undecided > 0);
}

/// u = 1 at t = 0 does not exceed when it is only relieved; the next float does; and it does when it is pulled further.
#[test]
fn a_load_just_at_the_rating() {
    let scene = |initial: f64, force: f64, equal: bool| Scene {
        chain: Chain {
            mass: vec![1.0, if equal { 1.0 } else { 1.5 }, 1.0],
            stiffness: vec![1.0; 2],
            held_head: true,
            held_tail: false,
        },
        source: 2,
        force,
        duration: f64::INFINITY,
        initial: vec![initial; 2],
        rated_draft: vec![1.0; 2],
        rated_buff: vec![10.0; 2],
        // Before the spring swings back: 0.6 of its fastest half period.
        horizon: 1.0,
    };
    for equal in [true, false] {
        for found in by_all(&scene(1.0, 1.0, equal)) {
            for spring in &found.springs {
                let draft = spring.draft;
                assert_eq!((draft.exceeds(), draft.first_over), (Some(false), None), "{}", found.method.name());
                assert_eq!((draft.best.at, draft.best.value), (0.0, 1.0), "{}", found.method.name());
            }
        }
        for found in by_all(&scene(1.0f64.next_up(), 1.0, equal)) {
            for spring in &found.springs {
                assert_eq!((spring.draft.exceeds(), spring.draft.first_over), (Some(true), Some(0.0)));
            }
        }
        for found in by_all(&scene(1.0, -0.1, equal)) {
            let draft = found.springs[1].draft;
            // F - 1 = 0.05 t^2 at first: over by the bound of 1e-13 at 1e-6.
            assert!(draft.exceeds() == Some(true) && draft.first_over.is_some_and(|t| t < 1e-5), "{draft:?}");
        }
    }
}

#[derive(Deserialize)]
struct Frequencies {
    name: String,
    mass: Vec<f64>,
    stiffness: Vec<f64>,
    held_head: bool,
    held_tail: bool,
    omega: Vec<Digits>,
}

/// Every frequency to 1e-14 of itself; a dense symmetric eigensolver on B B^T is printed beside it.
#[test]
fn frequencies_at_ratio_1e12() {
    let all: Vec<Frequencies> = serde_json::from_str(include_str!("../reference/frequencies.json")).expect("data");
    for f in all {
        let chain = Chain { mass: f.mass, stiffness: f.stiffness, held_head: f.held_head, held_tail: f.held_tail };
        let found: Vec<f64> = Path::new(&chain).frequencies().iter().map(|w| w.hi).collect();
        assert_eq!(found.len(), f.omega.len(), "{}", f.name);
        let worst = |found: &[f64]| found.iter().zip(&f.omega).map(|(w, d)| (w / d.0 - 1.0).abs()).fold(0.0, f64::max);
        let (ours, [dense, slowest], negative) = (worst(&found), dense(&chain, &f.omega), negative(&chain));
        println!(
            "{}: {ours:.1e}; dense symmetric: worst {dense:.1e}, slowest {slowest:.1e}, {negative} eigenvalues < 0",
            f.name
        );
        assert!(ours <= 1e-14, "{}: {ours:e}", f.name);
    }
}

/// Eigenvalues of B B^T by a dense symmetric solver, ascending.
fn dense_eigenvalues(chain: &Chain) -> Vec<f64> {
    let springs = chain.stiffness.len();
    let inverse = |v: usize| if chain.live(v) { 1.0 / chain.mass[v] } else { 0.0 };
    let entry = |i: usize, j: usize| match i.abs_diff(j) {
        0 => chain.stiffness[i] * (inverse(i) + inverse(i + 1)),
        1 => -(chain.stiffness[i] * chain.stiffness[j]).sqrt() * inverse(i.max(j)),
        _ => 0.0,
    };
    let mut values: Vec<f64> =
        SymmetricEigen::new(DMatrix::from_fn(springs, springs, entry)).eigenvalues.iter().copied().collect();
    values.sort_by(f64::total_cmp);
    // Between two held ends one of them is zero.
    values.split_off(usize::from(chain.held_head && chain.held_tail))
}

fn negative(chain: &Chain) -> usize {
    dense_eigenvalues(chain).iter().filter(|l| **l < 0.0).count()
}

/// Worst relative error of the dense solver's frequencies, and that of the slowest.
fn dense(chain: &Chain, omega: &[Digits]) -> [f64; 2] {
    let off = |(l, d): (&f64, &Digits)| (l.max(0.0).sqrt() / d.0 - 1.0).abs();
    let all: Vec<f64> = dense_eigenvalues(chain).iter().zip(omega).map(off).collect();
    [all.iter().fold(0.0, |a: f64, &b| a.max(b)), all[0]]
}
