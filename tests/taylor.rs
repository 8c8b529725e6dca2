//! Steps by Taylor series against closed forms and against the methods for undamped chains.

use trainsafe::chain::{Chain, Scene};
use trainsafe::play::{Drive, Play, Rule};
use trainsafe::solve::taylor::{self, Outcome};
use trainsafe::solve::{Ask, Method, solve};

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

fn play(scene: Scene) -> Play {
    let (springs, masses) = (scene.initial.len(), scene.chain.mass.len());
    Play {
        scene,
        drive: Drive::none(),
        dashpot: vec![0.0; springs],
        velocity: vec![0.0; masses],
        broken: Vec::new(),
        rule: Rule::Keep,
    }
}

fn run(play: &Play) -> Outcome {
    taylor::solve(play).expect("short")
}

/// [P] figure 4 as one chain of which a coupler breaks: numbers from the closed form in 40-digit arithmetic.
#[test]
fn the_papers_break() {
    let mut p = play(equal(52, true, true, 1.0));
    p.scene.horizon = 200.0;
    p.broken = vec![50];
    let out = run(&p);
    let buff = out.springs[0].buff;
    assert!((buff.first_over.expect("over") - 53.152_089_806_626_6).abs() < 1e-11, "the number's last digits");
    let draft = out.springs[0].draft.best;
    assert!((draft.value - 1.508_352_695_662_44).abs() < out.error_bound + 1e-14, "{draft:?} {buff:?}");
    assert!((draft.at - 157.917_356_441_113).abs() < 1e-5, "flat: the root of the bound");
    assert!(out.error_bound < 1e-11, "{:e}", out.error_bound);
}

/// Breaks in the middle and rectangular pulses on uneven chains, each against a sum over modes with its own bound.
#[test]
fn undamped_chains_agree_with_sums_over_modes() {
    let ask = Ask { tolerance: 1e-9, method: Some(Method::Modal), verdict_only: false, all_time_bound: false };
    for (held_head, held_tail) in [(false, false), (true, false), (false, true), (true, true)] {
        for pulse in [false, true] {
            let mut p = play(uneven(24, held_head, held_tail));
            let whole = p.scene.clone();
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
                p.scene.source = 9;
                p.drive = Drive::rectangle(-0.7, 6.4);
                vec![part(0, 23, 9, -0.7, 6.4)]
            } else {
                p.broken = vec![14];
                let lost = initial[14];
                vec![part(0, 14, 14, lost, f64::INFINITY), part(15, 23, 15, -lost, f64::INFINITY)]
            };
            let out = run(&p);
            for (from, other) in others {
                let bound = out.error_bound + other.error_bound;
                for (i, peaks) in other.springs.iter().enumerate() {
                    let (a, b) = (out.springs[from + i], peaks.expect("all are asked for"));
                    for negative in [false, true] {
                        let (a, b) = (a.side(negative), b.side(negative));
                        assert!((a.best.value - b.best.value).abs() <= bound, "{i} {a:?} {b:?} {bound:e}");
                        assert_eq!(a.exceeds(), b.exceeds());
                        let apart = a.first_over.zip(b.first_over).map_or(0.0, |(x, y)| (x - y).abs());
                        // Where the slope at the crossing is not small the bound in force is a bound in time.
                        assert!(apart < 1e-9, "{a:?} {b:?}");
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
    let mut p = play(scene);
    p.velocity = vec![-v, 0.0];
    let out = run(&p);
    let (force, half) = (v * (k * m / 2.0f64).sqrt(), PI * (m / (2.0 * k)).sqrt());
    let Extremes { draft, buff } = both(&out);
    assert!((buff.0 - force).abs() < out.error_bound && (draft.0 - force).abs() < out.error_bound);
    // At a flat peak an error of the bound in force is one of its root in time.
    let flat = (out.error_bound / force).sqrt() * half;
    assert!((buff.1 - 0.5 * half).abs() < flat && (draft.1 - 1.5 * half).abs() < flat);
    let zero = taylor::history(&p, 0, &[half, 2.0 * half]);
    assert!(zero.iter().all(|f| f.abs() < out.error_bound), "{zero:?}");
}

struct Extremes {
    draft: (f64, f64),
    buff: (f64, f64),
}

fn both(out: &Outcome) -> Extremes {
    let side = |negative: bool| {
        let best = out.springs[0].side(negative).best;
        (best.value, best.at)
    };
    Extremes { draft: side(false), buff: side(true) }
}

/// One vehicle behind a held head, forces of any shape: the convolution with sin in closed form, at resonance and off it.
#[test]
fn shapes_of_pulse_on_one_spring() {
    let scene = |horizon: f64| Scene { horizon, ..equal(2, true, false, 0.0) };
    let times: Vec<f64> = (1..200).map(|i| 0.1 * f64::from(i)).collect();
    let check = |drive: Drive, expected: &dyn Fn(f64) -> f64| {
        let mut p = play(scene(20.0));
        p.drive = drive;
        let bound = taylor::solve(&p).expect("short").error_bound;
        for (t, f) in times.iter().zip(taylor::history(&p, 0, &times)) {
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
        let mut p = play(Scene { horizon: 30.0, ..equal(2, true, false, 0.0) });
        p.dashpot = vec![2.0 * z];
        p.drive = Drive::rectangle(-1.0, 40.0);
        let bound = run(&p).error_bound;
        let times: Vec<f64> = (0..300).map(|i| 0.1 * f64::from(i)).collect();
        for (t, f) in times.iter().zip(taylor::history(&p, 0, &times)) {
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
    let mut p = play(equal(2, false, false, 0.0));
    p.velocity = vec![0.0, 3.0];
    let force = 3.0 / swing;
    p.scene.rated_draft = vec![1.5];
    for (rule, rating, from) in [(Rule::InBoth, 1.0, 0.0), (Rule::InDraft, 1.5, PI / swing)] {
        p.rule = rule;
        let out = run(&p);
        let broken = &out.breakages[0];
        let phase = (rating / force).asin();
        let time = from + phase / swing;
        let slope = force * swing * phase.cos();
        assert!((broken.time - time).abs() <= broken.uncertainty, "{} {time} {:e}", broken.time, broken.uncertainty);
        assert!(broken.uncertainty < 3.0 * out.error_bound / slope + 1e-13, "{:e}", broken.uncertainty);
        assert_eq!((broken.springs.as_slice(), out.breakages.len(), out.open), (&[0][..], 1, None));
        assert!((broken.force[0].abs() - rating).abs() < out.error_bound);
        // Energy: all of 9/2 is in the speeds and the spring; the spring's is lost. Rounding of a few squares.
        assert!((broken.kinetic + broken.strain[0] - 4.5).abs() < 1e-12);
        assert!((broken.strain[0] - 0.5 * rating * rating).abs() < 1e-12 && broken.strain[1] == 0.0);
        let speeds = [1.5 * (1.0 - (swing * time).cos()), 1.5 * (1.0 + (swing * time).cos())];
        assert!((broken.kinetic - 0.5 * (speeds[0].powi(2) + speeds[1].powi(2))).abs() < 1e-12);
        let after = taylor::history(&p, 0, &[broken.time + 0.1, 4.0]);
        assert_eq!(after, [0.0, 0.0]);
    }
}
