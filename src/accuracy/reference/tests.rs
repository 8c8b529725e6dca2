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

/// `J_1(2t) / t` as its power series: until the other end is heard, a backward step of force 1 on a free end brings the
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

/// Forty springs: the held end answers with J_160(2t), under 1e-200 at t = 2. Both sides are right to 2^-256 times the
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
