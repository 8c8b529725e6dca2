use super::*;
use crate::chain::Chain;

fn held(springs: usize, force: f64, duration: f64, initial: f64) -> Scene {
    Scene {
        chain: Chain { mass: vec![4.0; springs + 1], stiffness: vec![1.0; springs], held_head: true, held_tail: false },
        source: springs,
        force,
        duration,
        initial: vec![initial; springs],
        rated_draft: vec![1.0; springs],
        rated_buff: vec![1.0; springs],
        horizon: 8.0 * springs as f64,
    }
}

/// [P] figure 4: the release wave unloads, is mirrored at the held end and loads in compression, to 1 and no more.
#[test]
fn release_of_a_stretched_rod_never_passes_its_initial_force() {
    let scene = held(50, 1.0, f64::INFINITY, 1.0);
    let rod = Rod::new(&scene).expect("equal");
    // Fronts arrive after 50, 51, 151 and 152 springs, two time units each.
    let times = [0.0, 99.9, 100.1, 101.9, 102.1, 301.9, 302.1, 304.1];
    assert_eq!(rod.history(0, &times), [1.0, 1.0, 0.0, 0.0, -1.0, -1.0, 0.0, 1.0]);
    for spring in 0..50 {
        assert_eq!(rod.extremes(spring), (1.0, -1.0));
    }
}

/// [P] figure 5: the pulse passes each place undistorted, and a held end doubles it where the two overlap.
#[test]
fn pulse_travels_undistorted() {
    let scene = held(100, -1.0, 20.0, 0.0);
    let rod = Rod::new(&scene).expect("equal");
    assert_eq!(rod.history(99, &[1.9, 2.1, 21.9, 22.1]), [0.0, 1.0, 1.0, 0.0]);
    assert_eq!(rod.extremes(50), (1.0, -1.0));
    assert_eq!(rod.extremes(0), (2.0, -2.0));
}

/// Against the sum over as many images as the horizon takes.
#[test]
fn long_horizons_follow_from_four_transits() {
    for (held_tail, duration, transits) in [
        (true, f64::INFINITY, 41.3),
        (false, f64::INFINITY, 41.3),
        (true, 31.7, 60.0),
        (false, 29.2, 60.0),
        (false, 3.0, 4.5),
    ] {
        let mut scene = held(5, -1.0, duration, 0.3);
        scene.chain.mass.fill(1.0);
        scene.chain.stiffness.fill(1.0);
        scene.chain.held_tail = held_tail;
        scene.source = 2;
        let period = 2.0 * if held_tail { 5.0 } else { 5.5 };
        scene.duration *= 0.5 * period;
        scene.horizon = 0.5 * period * transits;
        let turn = if held_tail { 1.0 } else { -1.0 };
        let step = |x: f64, t: f64| -> f64 {
            let image = |k: i32| {
                let (sign, shift) = (f64::powi(turn, k), f64::from(k) * period);
                [(2.0 + shift, sign), (shift - 2.0, -sign)].map(|(a, sign)| {
                    let half = if x > a { 0.5 } else { -0.5 };
                    if t >= (x - a).abs() { -half * sign } else { 0.0 }
                })
            };
            (-40..=40).flat_map(image).sum()
        };
        let rod = Rod::new(&scene).expect("a rod");
        for spring in 0..5 {
            let x = spring as f64 + 0.5;
            // Between arrivals, which come at halves.
            let times: Vec<f64> = (0..(4.0 * scene.horizon) as u32).map(|n| 0.25 * f64::from(n) + 0.1).collect();
            let due: Vec<f64> = times.iter().map(|&t| 0.3 + step(x, t) - step(x, t - scene.duration)).collect();
            let found = rod.history(spring, &times);
            assert!(found.iter().zip(&due).all(|(a, b)| (a - b).abs() < 1e-12), "spring {spring}, pulse of {duration}");
            let (high, low) = rod.extremes(spring);
            let [most, least] = [due.iter().copied().fold(0.3, f64::max), due.iter().copied().fold(0.3, f64::min)];
            assert!((high - most).abs() < 1e-12 && (low - least).abs() < 1e-12, "{high} {most} {low} {least}");
        }
    }
}
