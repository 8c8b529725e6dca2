use super::*;
use crate::chain::Chain;

fn held(springs: usize) -> Scene {
    Scene {
        chain: Chain { mass: vec![1.0; springs + 1], stiffness: vec![1.0; springs], held_head: true, held_tail: false },
        source: springs,
        force: 1.0,
        duration: f64::INFINITY,
        initial: vec![1.0; springs],
        rated_draft: vec![1.0; springs],
        rated_buff: vec![1.0; springs],
        horizon: 4.0,
    }
}

/// `J_1(2t) / t` as its power series: before any reflection, a backward step of force 1 on a free end brings the
/// spring next to it `1 - J_1(2t) / t`.
fn last_spring(t: f64, bits: usize) -> Real {
    let square = real::real(t, bits) * real::real(t, bits);
    let mut term = real::real(1.0, bits);
    let mut sum = term.clone();
    for m in 1..80 {
        // J_1(x) / (x / 2) = sum_m (-x^2 / 4)^m / (m! (m + 1)!), x = 2t
        term = -(term * &square) / real::real(f64::from(m * (m + 1)), bits);
        sum += &term;
    }
    sum
}

/// Forty springs: the held end reflects J_160(2t), under 1e-200 at t = 2. Both sides are right to 2^-256 times the
/// few hundred roundings in each: 1e-70 leaves room, and is 40 digits below what is asked of the reference.
#[test]
fn agrees_with_bessel_functions_to_70_digits() {
    let mut scene = held(40);
    scene.initial.fill(0.0);
    scene.force = -1.0;
    let reference = Reference::new(&scene).expect("an ordinary chain");
    for t in [0.25, 1.0, 2.0] {
        let step = reference.real(1.0) - last_spring(t, reference.bits);
        let off = rounded(&(reference.exact_force(39, t) - step)).abs();
        assert!(off < 1e-70, "t = {t}: off by {off:e}");
    }
}

/// One mass on one spring, released from a pull of 1: F = cos t, largest at rest, -F largest at t = pi, where it is 1.
/// A sine's zero found in `f64` and settled by one long step leaves the cube of 1e-16: 1e-40 is generous.
#[test]
fn extremes_of_one_spring_are_those_of_a_cosine() {
    let reference = Reference::new(&held(1)).expect("an ordinary chain");
    let extremes = reference.extremes().expect("a short search");
    let [draft, buff] = &extremes[0];
    assert_eq!((draft.at, draft.error_of(1.0), draft.doubt), (0.0, 0.0, 0.0));
    assert!((buff.at - std::f64::consts::PI).abs() < 1e-15 && buff.error_of(1.0) < 1e-40);
}

/// Two light vehicles eight places apart: frequencies that agree in 80 digits and more need more than 256 bits, and get them.
#[test]
fn parts_modes_that_nearly_coincide() {
    let mut scene = held(24);
    (scene.chain.mass[8], scene.chain.mass[16]) = (1e-12, 1e-12);
    scene.source = 8;
    let reference = Reference::new(&scene).expect("more bits part them");
    assert!(reference.bits > 256);
}

/// What a scene must not have.
#[test]
fn refuses_what_is_no_scene() {
    let mut scene = held(2);
    scene.chain.mass[1] = 0.0;
    assert!(matches!(Reference::new(&scene), Err(ReferenceError::Scene(_))));
    let mut scene = held(2);
    scene.source = 0;
    assert!(matches!(Reference::new(&scene), Err(ReferenceError::Scene(_))));
}

/// The march in displacements and the sum over modes are two ways to one motion: 25 digits apart from the digits that either has.
#[test]
fn the_march_agrees_with_the_modes() {
    let scene = Scene { horizon: 30.0, duration: 7.0, ..held(6) };
    let reference = Reference::new(&scene).expect("an ordinary chain");
    let system = march::System {
        mass: scene.chain.mass.clone(),
        held: [true, false],
        stiffness: scene.chain.stiffness.clone(),
        dashpot: vec![0.0; 6],
        initial: vec![march::long(1.0); 6],
        outside: [vec![march::long(0.0); 6], vec![march::long(-1.0)]].concat(),
        velocity: vec![0.0; 7],
        source: 6,
        drive: vec![march::Course::Line([0.0, 1.0], [7.0, 1.0])],
        horizon: 30.0,
        ..march::System::default()
    };
    let motion = march::march(&system, &[[f64::INFINITY; 2]; 6]);
    for (spring, t) in [(0, 3.3), (5, 6.9), (2, 29.5), (5, 17.0)] {
        let (force, _) = motion.force(spring, t).expect("whole");
        let off = force - reference.exact_force(spring, t).with_precision(144).value();
        assert!(rounded(&off).abs() < 1e-25, "spring {spring} at {t}: {:e}", rounded(&off));
    }
    let extremes = reference.extremes().expect("a short search");
    for (spring, sides) in extremes.iter().enumerate() {
        for (side, extreme) in sides.iter().enumerate() {
            let largest = motion.largest(spring, side, 30.0).1;
            assert!(extreme.error_of(rounded(&largest)) < 1e-15, "spring {spring}");
        }
    }
}

/// Two vehicles that run into each other: `F = -v sqrt(k m / 2) e^(-z w t) sin(d t) / sqrt(1 - z^2)` in the spring, with the damping
/// ratio, and the dashpot's `c v e^(-z w t) (cos - z / sqrt(1 - z^2) sin)` beside it with the dashpot of the same ratio. Doubles
/// carry these to a few 1e-16.
#[test]
fn the_march_knows_both_kinds_of_damping() {
    let (z, w) = (0.2f64, 2f64.sqrt());
    let d = w * (1.0 - z * z).sqrt();
    for (dashpot, ratio) in [(0.0, z), (z * w, 0.0)] {
        let system = march::System {
            mass: vec![1.0; 2],
            stiffness: vec![1.0],
            dashpot: vec![dashpot],
            ratio,
            initial: vec![march::long(0.0)],
            outside: vec![march::long(0.0); 2],
            velocity: vec![-1.0, 0.0],
            horizon: 9.0,
            ..march::System::default()
        };
        let motion = march::march(&system, &[[f64::INFINITY; 2]]);
        for t in [0.0, 0.7, 4.1, 8.8] {
            let (sin, cos) = (d * t).sin_cos();
            let apart = -(-z * w * t).exp() * (cos - z / (1.0 - z * z).sqrt() * sin);
            let due = -(-z * w * t).exp() * sin / d + dashpot * apart;
            let (force, _) = motion.force(0, t).expect("whole");
            assert!((rounded(&force) - due).abs() < 2e-15, "{dashpot} {t}: {} {due}", rounded(&force));
        }
    }
}

/// A coupler breaks when it passes its load, to the digits of a sine's inverse, and one that stands at its load at once.
#[test]
fn the_march_breaks_couplers() {
    let system = march::System {
        mass: vec![1.0; 2],
        stiffness: vec![1.0],
        dashpot: vec![0.0],
        initial: vec![march::long(0.5)],
        outside: vec![march::long(0.5), march::long(-0.5)],
        velocity: vec![1.0, 0.0],
        horizon: 9.0,
        ..march::System::default()
    };
    let at = |load: f64| march::march(&system, &[[load, f64::INFINITY]]).broke.first().map(|b| b.at);
    // F = 1/2 + sin(sqrt 2 t) / sqrt 2
    let due = (0.3 * 2f64.sqrt()).asin() / 2f64.sqrt();
    assert!((at(0.8).expect("it breaks") - due).abs() < 1e-15);
    assert_eq!((at(0.5), at(1.3)), (Some(0.0), None));
}
