//! The march of linear chains against closed forms and against the methods for undamped chains.

use crate::linear::{Linear, bound, sides};
use trainsafe::chain::{Chain, Scene};
use trainsafe::forcing::Drive;
use trainsafe::march::{Bound, MarchOutcome};
use trainsafe::solve::{Ask, Method, solve};
use trainsafe::train::Rule;

const PI: f64 = std::f64::consts::PI;

/// Equal unit masses and springs under uniform tension.
fn equal(masses: usize, held_head: bool, held_tail: bool, load: f64) -> Scene {
    let springs = masses - 1;
    Scene {
        chain: Chain { mass: vec![1.0; masses], stiffness: vec![1.0; springs], held_head, held_tail },
        source: usize::from(held_head),
        force: 0.0,
        duration: 0.0,
        initial: vec![load; springs],
        rated_draft: vec![1.0; springs],
        rated_buff: vec![1.0; springs],
        horizon: 4.0 * springs as f64,
    }
}

fn uneven(masses: usize, held_head: bool, held_tail: bool) -> Scene {
    let mut scene = equal(masses, held_head, held_tail, 0.0);
    let wave = |v: usize, f: f64| 1.0 + 0.6 * (f * (v * v) as f64).sin();
    (0..masses).for_each(|v| scene.chain.mass[v] = wave(v + 1, 1.7));
    for i in 0..masses - 1 {
        scene.chain.stiffness[i] = wave(i + 1, 2.3);
        scene.initial[i] = 0.8 * wave(i + 1, 0.9);
    }
    scene.horizon = 3.3 * scene.chain.transit();
    scene
}

fn linear(scene: &Scene) -> Linear {
    let rated = scene.rated_draft.iter().zip(&scene.rated_buff).map(|(d, b)| [*d, *b]).collect();
    Linear::new(&scene.chain, &scene.initial, rated, scene.horizon)
}

/// The largest F and -F of coupler 0, and when.
fn both(out: &MarchOutcome) -> Extremes {
    let [draft, buff] = sides(out, 0);
    Extremes { draft, buff }
}

/// [P] figure 4 as one chain of which a coupler breaks: numbers from the closed form in 40-digit arithmetic.
#[test]
fn the_papers_break() {
    let mut p = linear(&equal(52, true, true, 1.0));
    (p.problem.horizon_s, p.problem.mark_s) = (200.0, 200.0);
    p.problem.gone = vec![50];
    let out = p.run();
    let buff = out.first_over_s[0][1].expect("over");
    assert!((buff - 53.152_089_806_626_6).abs() < 1e-11, "the number's last digits");
    let draft = both(&out).draft;
    assert!((draft.0 - 1.508_352_695_662_44).abs() < bound(&out) + 1e-14, "{draft:?} {buff:?}");
    assert!((draft.1 - 157.917_356_441_113).abs() < 1e-5, "flat: the root of the bound");
    assert!(bound(&out) < 1e-11, "{:e}", bound(&out));
}

/// Breaks in the middle and rectangular pulses on uneven chains, each against a sum over modes with its own bound.
#[test]
fn undamped_chains_agree_with_sums_over_modes() {
    let ask = Ask { tolerance: 1e-9, method: Some(Method::Modal), ..Ask::default() };
    for (held_head, held_tail) in [(false, false), (true, false), (false, true), (true, true)] {
        for pulse in [false, true] {
            let whole = uneven(24, held_head, held_tail);
            let mut p = linear(&whole);
            let initial = whole.initial.clone();
            let part = |from: usize, to: usize, source: usize, force: f64, duration: f64| {
                let mut scene = whole.clone();
                scene.chain.mass = whole.chain.mass[from..=to].to_vec();
                scene.chain.stiffness = whole.chain.stiffness[from..to].to_vec();
                (scene.chain.held_head, scene.chain.held_tail) = (held_head && from == 0, held_tail && to == 23);
                scene.initial = initial[from..to].to_vec();
                (scene.rated_draft, scene.rated_buff) = (vec![1.0; to - from], vec![1.0; to - from]);
                (scene.source, scene.force, scene.duration) = (source - from, force, duration);
                (from, solve(&scene, &ask).expect("small"))
            };
            let others = if pulse {
                p.problem.forcing = vec![(9, Drive::rectangle(-0.7, 6.4))];
                vec![part(0, 23, 9, -0.7, 6.4)]
            } else {
                p.problem.gone = vec![14];
                let lost = initial[14];
                vec![part(0, 14, 14, lost, f64::INFINITY), part(15, 23, 15, -lost, f64::INFINITY)]
            };
            let out = p.run();
            for (from, other) in others {
                let bound = bound(&out) + other.error_bound;
                for (i, peaks) in other.springs.iter().enumerate() {
                    let b = peaks.expect("all are asked for");
                    for (side, b) in [b.draft, b.buff].into_iter().enumerate() {
                        let a = sides(&out, from + i)[side];
                        assert!((a.0 - b.best.value).abs() <= bound, "{i} {a:?} {b:?} {bound:e}");
                        assert_eq!(out.exceeds[from + i][side], b.exceeds());
                        let first = out.first_over_s[from + i][side];
                        let apart = first.zip(b.first_over).map_or(0.0, |(x, y)| (x - y).abs());
                        // Where the slope at the crossing is not small the bound in force is a bound in time.
                        assert!(apart < 1e-9, "{first:?} {b:?}");
                    }
                }
            }
        }
    }
}

/// Two equal vehicles that meet press with v sqrt(k m / 2) for half a period, pi sqrt(m / 2 k), and stay coupled.
#[test]
fn two_vehicles_meet() {
    let (m, k, v) = (3.0, 7.0, 0.2);
    let mut scene = equal(2, false, false, 0.0);
    (scene.chain.mass, scene.chain.stiffness) = (vec![m; 2], vec![k]);
    scene.horizon = 4.0;
    let mut p = linear(&scene);
    p.problem.speed_m_s = vec![-v, 0.0];
    let out = p.run();
    let (force, half) = (v * (k * m / 2.0f64).sqrt(), PI * (m / (2.0 * k)).sqrt());
    let Extremes { draft, buff } = both(&out);
    assert!((buff.0 - force).abs() < bound(&out) && (draft.0 - force).abs() < bound(&out));
    // At a flat peak an error of the bound in force is one of its root in time.
    let flat = (bound(&out) / force).sqrt() * half;
    assert!((buff.1 - 0.5 * half).abs() < flat && (draft.1 - 1.5 * half).abs() < flat);
    let zero = p.history(0, &[half, 2.0 * half]);
    assert!(zero.iter().all(|f| f.abs() < bound(&out)), "{zero:?}");
}

struct Extremes {
    draft: (f64, f64),
    buff: (f64, f64),
}

/// One vehicle behind a held head, forces of any shape: the convolution with sin in closed form, at resonance and off it.
#[test]
fn shapes_of_pulse_on_one_spring() {
    let scene = |horizon: f64| Scene { horizon, ..equal(2, true, false, 0.0) };
    let times: Vec<f64> = (1..200).map(|i| 0.1 * f64::from(i)).collect();
    let check = |drive: Drive, expected: &dyn Fn(f64) -> f64| {
        let mut p = linear(&scene(20.0));
        p.problem.forcing = vec![(1, drive)];
        let bound = bound(&p.run());
        for (t, f) in times.iter().zip(p.history(0, &times)) {
            // The closed forms below round a few times themselves.
            assert!((f - expected(*t)).abs() < bound + 4e-15, "{t}: {f} is not {}", expected(*t));
        }
    };
    // Ramps: x'' + x = t gives t - sin t; a polygon is a sum of ramps and steps. A forward force is a negative one here.
    let ramp = |t: f64| if t > 0.0 { t - t.sin() } else { 0.0 };
    let step = |t: f64| if t > 0.0 { 1.0 - t.cos() } else { 0.0 };
    let triangle = Drive::Lines(vec![[0.0, 0.0], [2.0, 1.0], [4.0, 0.0]]);
    check(triangle, &|t| -(0.5 * ramp(t) - ramp(t - 2.0) + 0.5 * ramp(t - 4.0)));
    let saw = Drive::Lines(vec![[1.0, 0.5], [3.0, 2.5], [3.0, -1.0], [7.0, -1.0]]);
    check(saw, &|t| -(0.5 * step(t - 1.0) + ramp(t - 1.0) - ramp(t - 3.0) - 3.5 * step(t - 3.0) + step(t - 7.0)));
    // Half sine of frequency w: (sin w t - w sin t) / (1 - w^2), and the same again from its end on.
    let sine = |w: f64| move |t: f64| if t > 0.0 { ((w * t).sin() - w * t.sin()) / (1.0 - w * w) } else { 0.0 };
    for w in [0.3, 2.5, 40.0] {
        let (end, f) = (PI / w, sine(w));
        check(Drive::HalfSine { peak: 1.0, duration: end }, &|t| -(f(t) + f(t - end)));
    }
    // At resonance, w = 1: (sin t - t cos t) / 2.
    let f = |t: f64| if t > 0.0 { 0.5 * (t.sin() - t * t.cos()) } else { 0.0 };
    check(Drive::HalfSine { peak: 1.0, duration: PI }, &|t| -(f(t) + f(t - PI)));
    // Of vanishing duration it is an impulse of 2 / pi times peak and duration.
    let brief = 1e-9;
    check(Drive::HalfSine { peak: PI / (2.0 * brief), duration: brief }, &|t| -(t - 0.5 * brief).sin());
}

/// One vehicle on a spring and dashpot: x'' + 2 z x' + x = 1 from rest, under, at and over critical damping.
#[test]
fn one_damped_spring() {
    for z in [0.05, 0.2, 1.0, 6.0] {
        let mut p = linear(&Scene { horizon: 30.0, ..equal(2, true, false, 0.0) });
        p.problem.dashpot_n_s_per_m = vec![2.0 * z];
        p.problem.forcing = vec![(1, Drive::rectangle(-1.0, 40.0))];
        let bound = bound(&p.run());
        let times: Vec<f64> = (0..300).map(|i| 0.1 * f64::from(i)).collect();
        for (t, f) in times.iter().zip(p.history(0, &times)) {
            // F = x + 2 z x'; x = 1 - e^(-z t) (C + z S), x' = e^(-z t) S with C, S of sqrt(|1 - z^2|) t.
            let d = (1.0 - z * z).abs().sqrt();
            let (c, s) = match z {
                1.0 => ((-t).exp(), t * (-t).exp()),
                z if z < 1.0 => ((-z * t).exp() * (d * t).cos(), (-z * t).exp() * (d * t).sin() / d),
                z => {
                    let (a, b) = (((d - z) * t).exp(), ((-d - z) * t).exp());
                    (0.5 * (a + b), 0.5 * (a - b) / d)
                }
            };
            let expected = 1.0 - (c + z * s) + 2.0 * z * s;
            assert!((f - expected).abs() < bound + 1e-14, "{z} {t}: {f} is not {expected} within {bound:e}");
        }
    }
}

/// Two vehicles that meet faster than their coupler bears: it breaks at asin(r / F) of its swing, and each goes on at the speed
/// that it has then.
#[test]
fn a_coupler_breaks_in_its_swing() {
    let swing = 2f64.sqrt();
    let mut p = linear(&equal(2, false, false, 0.0));
    p.problem.speed_m_s = vec![0.0, 3.0];
    let force = 3.0 / swing;
    p.rated = vec![[1.5, 1.0]];
    for (rule, rating, from) in [(Rule::InBoth, 1.0, 0.0), (Rule::InDraft, 1.5, PI / swing)] {
        let p = p.breaking(rule);
        let out = p.run();
        let broken = &out.partings[0];
        let phase = (rating / force).asin();
        let time = from + phase / swing;
        let slope = force * swing * phase.cos();
        assert!((broken.time_s - time).abs() <= broken.uncertainty_s, "{time} {broken:?}");
        assert!(broken.uncertainty_s < 3.0 * bound(&out) / slope + 1e-13, "{broken:?}");
        assert_eq!((broken.coupler, out.partings.len(), out.undecided), (0, 1, None));
        assert!((broken.force_n.abs() - rating).abs() < bound(&out));
        // Of all energy, 9/2, the spring's is lost. Rounding of a few squares.
        assert!((broken.energy_j - 0.5 * rating * rating).abs() < 1e-12);
        let speeds = [1.5 * (1.0 - (swing * time).cos()), 1.5 * (1.0 + (swing * time).cos())];
        for (v, speed) in out.end_speed_m_s.iter().zip(speeds) {
            assert!((v - speed).abs() < 1e-12, "{v} {speed}");
        }
        let after = p.history(0, &[broken.time_s + 0.1, 4.0]);
        assert_eq!(after, [0.0, 0.0]);
    }
}

/// A rating as near to the peak as can be told: whether the coupler breaks is not decided, and from when on is said.
#[test]
fn a_rating_at_the_peak_is_not_decided() {
    let mut p = linear(&equal(2, false, false, 0.0));
    p.problem.speed_m_s = vec![0.0, 3.0];
    let (swing, force) = (2f64.sqrt(), 3.0 / 2f64.sqrt());
    p.rated = vec![[9.0, force]];
    let out = p.breaking(Rule::InBoth).run();
    assert_eq!((out.exceeds[0][1], out.partings.len()), (None, 0));
    let (spring, since) = out.undecided.expect("open");
    // Within the bound of the peak since sqrt(2 bound / force) of a radian before it, twice over for the rounded rating.
    let early = 2.0 * (2.0 * bound(&out) / force).sqrt() / swing;
    assert!(spring == 0 && (since - 0.5 * PI / swing).abs() < early, "{since}");
    for (rating, breaks) in [(1.0 - 1e-9, 1), (1.0 + 1e-9, 0)] {
        p.rated = vec![[9.0, force * rating]];
        let out = p.breaking(Rule::InBoth).run();
        assert_eq!((out.partings.len(), out.undecided), (breaks, None));
    }
}

/// Chains of any shape with dashpots of any strength: the bound holds against the exponential of the whole system's matrix, which
/// rounds more than the steps do.
#[test]
fn random_chains_agree_with_a_matrix_exponential() {
    let mut seed = 7u64;
    let mut random = move || {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (seed >> 11) as f64 / (1u64 << 53) as f64
    };
    for round in 0..120 {
        let masses = 2 + round % 7;
        let (held_head, held_tail) = (round % 3 == 1, round % 5 == 2 && masses > 2);
        let mut scene = equal(masses, held_head, held_tail, 0.0);
        let mut between = |low: f64, high: f64| low * (high / low).powf(random());
        scene.chain.mass.iter_mut().for_each(|m| *m = between(0.1, 10.0));
        scene.chain.stiffness.iter_mut().for_each(|k| *k = between(0.1, 10.0));
        scene.horizon = 6.0;
        let mut p = linear(&scene);
        p.problem.dashpot_n_s_per_m = scene.initial.iter().map(|_| between(1e-3, 5.0)).collect();
        for v in (0..masses).filter(|&v| scene.chain.live(v)) {
            p.problem.speed_m_s[v] = between(1.0, 4.0) - 2.0;
        }
        p.problem.forcing = vec![(scene.source, Drive::rectangle(between(0.5, 2.0), 7.0))];
        let out = p.run();
        let bound = bound(&out);
        let times = [0.7, 3.1, 5.9];
        for (t, exact) in times.iter().map(|t| (t, exponential(&scene.chain, &p, *t))) {
            for (i, exact) in exact.iter().enumerate() {
                let found = p.history(i, &[*t])[0];
                // Scaling and squaring of a matrix of norm 100 or so loses three digits or four.
                assert!((found - exact).abs() < bound + 1e-11, "{round} {i} {t}: {found} {exact}");
                let [draft, buff] = sides(&out, i);
                assert!(found <= draft.0 + bound, "{round} {i} {t}");
                assert!(-found <= buff.0 + bound, "{round} {i} {t}");
            }
        }
    }
}

/// Coupler forces from the exponential of the matrix of displacements, speeds and a constant.
fn exponential(chain: &Chain, p: &Linear, time: f64) -> Vec<f64> {
    let p = &p.problem;
    let n = chain.mass.len();
    let row = |i: usize| {
        let mut row = nalgebra::RowDVector::zeros(2 * n + 1);
        (row[i], row[i + 1]) = (chain.stiffness[i], -chain.stiffness[i]);
        (row[n + i], row[n + i + 1]) = (p.dashpot_n_s_per_m[i], -p.dashpot_n_s_per_m[i]);
        row
    };
    let mut rates = nalgebra::DMatrix::zeros(2 * n + 1, 2 * n + 1);
    for v in 0..n {
        rates[(v, n + v)] = 1.0;
        if chain.live(v) {
            let ahead = v.checked_sub(1).map(row);
            let behind = (v + 1 < n).then(|| row(v));
            for j in 0..2 * n {
                let pull = ahead.as_ref().map_or(0.0, |r| r[j]) - behind.as_ref().map_or(0.0, |r| r[j]);
                rates[(n + v, j)] = pull / chain.mass[v];
            }
        }
    }
    let (source, drive) = &p.forcing[0];
    rates[(n + source, 2 * n)] = drive.value(0.0) / chain.mass[*source];
    let mut start = nalgebra::DVector::zeros(2 * n + 1);
    start.rows_mut(n, n).copy_from_slice(&p.speed_m_s);
    start[2 * n] = 1.0;
    let now = (rates * time).exp() * start;
    (0..n - 1).map(|i| (row(i) * &now)[0]).collect()
}

/// Couplers that break one after the other under a pulse: up to the first gap that closes it is all the same whether vehicles
/// push each other where they meet again, and both marches tell when that is.
#[test]
fn contact_makes_a_difference_once_a_gap_closes() {
    let wave = |i: usize, f: f64| 1.0 + 0.6 * (f * (i * i) as f64).sin();
    for damping in [0.0, 0.1] {
        let mut scene = uneven(16, true, false);
        scene.horizon = 30.0;
        scene.rated_draft = (0..15).map(|i| 2.0 * wave(i + 2, 0.9)).collect();
        let mut p = linear(&scene);
        p.problem.dashpot_n_s_per_m = (0..15).map(|i| damping * wave(i + 5, 1.1)).collect();
        p.problem.speed_m_s = (0..16).map(|v| if v == 0 { 0.0 } else { 0.3 * (wave(v, 0.4) - 1.0) }).collect();
        p.problem.forcing = vec![(9, Drive::rectangle(-4.0, 6.0))];
        let mut p = p.breaking(Rule::InDraft);
        let proven = p.run();
        let (coupler, closes) = proven.closures[0];
        let mut touching = p.clone();
        touching.problem.contact = true;
        let touched = touching.run();
        assert_eq!(touched.closures[0].0, coupler);
        // Without contact a gap counts as closed where it is so by more than its bound.
        let late = closes - touched.closures[0].1;
        assert!((0.0..2e-9).contains(&late), "{late}");
        for q in [&mut p, &mut touching] {
            (q.problem.horizon_s, q.problem.mark_s) = (0.999 * closes, 0.999 * closes);
        }
        let (proven, touched) = (p.run(), touching.run());
        assert!(matches!(touched.bound, Bound::Estimated(n) if n < 1e-9));
        assert!(proven.partings.len() >= 2 && proven.partings.len() == touched.partings.len());
        for (a, b) in proven.partings.iter().zip(&touched.partings) {
            assert_eq!(a.coupler, b.coupler);
            assert!((a.time_s - b.time_s).abs() <= a.uncertainty_s + b.uncertainty_s, "{a:?} {b:?}");
        }
        for i in 0..15 {
            for (a, b) in sides(&proven, i).iter().zip(sides(&touched, i)) {
                // What has parted carries nothing, which counts with contact and not without.
                assert!((a.0.max(0.0) - b.0.max(0.0)).abs() <= bound(&proven) + 1e-10, "{i} {a:?} {b:?}");
            }
        }
    }
}
