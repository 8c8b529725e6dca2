//! The engineers' methods are what they are called, and the comparison measures what it says.

use trainsafe::accuracy::peers::Peer;
use trainsafe::chain::{Chain, Scene};

/// A held head and one vehicle whose coupler's force falls from 1 to a mean of 0.25: `F = 1 - 0.75 (1 - cos omega t)`.
fn one_live_vehicle() -> Scene {
    Scene {
        chain: Chain { mass: vec![1.0, 2.5], stiffness: vec![0.7], held_head: true, held_tail: false },
        source: 1,
        force: 0.75,
        duration: f64::INFINITY,
        initial: vec![1.0],
        rated_draft: vec![1.0],
        rated_buff: vec![1.0],
        horizon: 40.0,
    }
}

fn exact(scene: &Scene, t: f64) -> f64 {
    let omega = (scene.chain.stiffness[0] / scene.chain.mass[1]).sqrt();
    let swing = |t: f64| if t > 0.0 { 1.0 - (omega * t).cos() } else { 0.0 };
    scene.initial[0] - scene.force * (swing(t) - swing(t - scene.duration))
}

fn times(scene: &Scene) -> Vec<f64> {
    (1..=37).map(|i| scene.horizon * f64::from(i) / 37.0).collect()
}

fn worst_error(scene: &Scene, peer: Peer) -> f64 {
    let times = times(scene);
    let marched = peer.march(scene, &times).expect("no method gives up on one vehicle");
    assert_eq!(marched.forces.len(), times.len());
    let errors = times.iter().zip(&marched.forces).map(|(&t, f)| (f[0] - exact(scene, t)).abs());
    errors.fold(0.0, f64::max)
}

/// Slope of a straight line through log error against log step (least squares).
fn observed_order(scene: &Scene, phases: &[f64], peer: fn(f64) -> Peer) -> f64 {
    let points: Vec<(f64, f64)> = phases.iter().map(|&p| (p.ln(), worst_error(scene, peer(p)).ln())).collect();
    let count = points.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let cross: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    cross / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

/// Over 21 radians the phase error is small against a radian at these steps, so what is left of higher orders bends the
/// line by less than 0.05; an order that is wrong is wrong by 1 at least.
#[test]
fn orders_of_convergence() {
    let mut pulse = one_live_vehicle();
    pulse.duration = 7.3;
    for scene in [one_live_vehicle(), pulse] {
        let fine = [0.08, 0.04, 0.02, 0.01];
        let orders = [
            (2.0, observed_order(&scene, &fine, |phase| Peer::Newmark { phase })),
            (2.0, observed_order(&scene, &fine, |phase| Peer::Verlet { phase })),
            (4.0, observed_order(&scene, &fine, |phase| Peer::RungeKutta4 { phase })),
        ];
        for (expected, observed) in orders {
            assert!((observed - expected).abs() < 0.05, "{expected}: {orders:?}");
        }
    }
}

/// A mode runs slow by (h omega)^2 / 12 with average acceleration and fast by (h omega)^2 / 24 with leapfrog: after t the
/// force is off by that share of omega t, times the amplitude, to leading order. A tenth covers the next order, (h omega)^2.
#[test]
fn second_order_methods_have_their_known_phase_error() {
    let scene = one_live_vehicle();
    let (phase, omega) = (0.05f64, (0.7f64 / 2.5).sqrt());
    let largest = |share: f64| {
        let error = |t: &f64| (scene.force * share * omega * t * (omega * t).sin()).abs();
        times(&scene).iter().map(error).fold(0.0, f64::max)
    };
    for (peer, share) in
        [(Peer::Newmark { phase }, phase * phase / 12.0), (Peer::Verlet { phase }, phase * phase / 24.0)]
    {
        let ratio = worst_error(&scene, peer) / largest(share);
        assert!((ratio - 1.0).abs() < 0.1, "{peer:?}: {ratio}");
    }
}

/// Each step's estimated error is under the tolerance of displacements of up to 2, and there are a hundred steps at most.
#[test]
fn dormand_prince_keeps_its_tolerance() {
    let mut pulse = one_live_vehicle();
    pulse.duration = 7.3;
    for scene in [one_live_vehicle(), pulse] {
        for tolerance in [1e-6, 1e-9, 1e-12] {
            let error = worst_error(&scene, Peer::DormandPrince8 { tolerance });
            assert!(error < 100.0 * tolerance, "{tolerance:e}: {error:e}");
        }
    }
}
