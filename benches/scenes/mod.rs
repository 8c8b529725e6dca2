//! The chains that benches run, and the methods on them.

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion};
use trainsafe::accuracy::peers::Peer;
use trainsafe::chain::{Chain, Scene};
use trainsafe::solve::{Ask, Method, solve};

/// `springs` springs behind a held head, all at 0.8 of their rating; the coupler behind the last mass breaks, and four
/// transits of the wave are followed.
pub fn broken(mass: Vec<f64>, stiffness: Vec<f64>) -> Scene {
    let springs = stiffness.len();
    let chain = Chain { mass, stiffness, held_head: true, held_tail: false };
    let horizon = 4.0 * chain.transit();
    Scene {
        chain,
        source: springs,
        force: 0.8,
        duration: f64::INFINITY,
        initial: vec![0.8; springs],
        rated_draft: vec![1.0; springs],
        rated_buff: vec![1.0; springs],
        horizon,
    }
}

/// Times every method that fits the scene at 1e-9 of the rating, and the marches at a step that leaves some 1e-3.
pub fn every_method(criterion: &mut Criterion, group: &str, methods: &[Method], scene: &Scene) {
    let springs = scene.initial.len();
    let mut group = criterion.benchmark_group(group);
    group.sample_size(10).warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(3));
    for &method in methods {
        let ask = Ask { tolerance: 1e-9, method: Some(method), ..Ask::default() };
        group.bench_function(BenchmarkId::new(method.name(), springs), |b| {
            b.iter(|| black_box(solve(black_box(scene), &ask)));
        });
    }
    let marches = [
        Peer::Newmark { phase: 0.1 },
        Peer::Verlet { phase: 0.1 },
        Peer::RungeKutta4 { phase: 0.3 },
        Peer::DormandPrince8 { tolerance: 1e-6 },
    ];
    for peer in marches {
        group.bench_function(BenchmarkId::new(peer.name(), springs), |b| {
            b.iter(|| black_box(peer.march(black_box(scene), &[])));
        });
    }
    group.finish();
}
