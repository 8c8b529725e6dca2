//! How does the time of a scene grow with the number of vehicles? Four transits of an equal chain behind a held head, one
//! break; every method's time, and the exponent of the power of n that fits it best.
//!
//! ```text
//! cargo run --release --example growth            n = 100 to 3,000
//! GROWTH_TO=10000 cargo run --release --example growth
//! ```

use std::time::Instant;

use trainsafe::chain::{Chain, Scene};
use trainsafe::solve::{Ask, Method, solve};

const RUNS: usize = 3;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let most: usize = std::env::var("GROWTH_TO").map_or(Ok(3000), |text| text.parse())?;
    let sizes: Vec<usize> =
        [100, 200, 500, 1000, 2000, 3000, 5000, 10_000].into_iter().filter(|n| *n <= most).collect();
    for method in [Method::Fronts, Method::Propagator] {
        println!("{}", method.name());
        let mut points = Vec::new();
        for &n in &sizes {
            let seconds = median_seconds(&scene(n), method)?;
            println!("  n = {n:6}  {:10.3} ms  {:8.3} ns per n^2", 1e3 * seconds, 1e9 * seconds / (n * n) as f64);
            points.push(((n as f64).ln(), seconds.ln()));
        }
        println!("  time grows as n^{:.2}", slope(&points));
    }
    Ok(())
}

fn scene(n: usize) -> Scene {
    Scene {
        chain: Chain { mass: vec![1.0; n + 1], stiffness: vec![1.0; n], held_head: true, held_tail: false },
        source: n,
        force: 0.8,
        duration: f64::INFINITY,
        initial: vec![0.8; n],
        rated_draft: vec![1.0; n],
        rated_buff: vec![1.0; n],
        horizon: 4.0 * n as f64,
    }
}

fn median_seconds(scene: &Scene, method: Method) -> Result<f64, trainsafe::solve::SolveError> {
    let ask = Ask { tolerance: 1e-9, method: Some(method), ..Ask::default() };
    let mut seconds = Vec::with_capacity(RUNS);
    for _ in 0..RUNS {
        let start = Instant::now();
        std::hint::black_box(solve(scene, &ask)?);
        seconds.push(start.elapsed().as_secs_f64());
    }
    seconds.sort_by(f64::total_cmp);
    Ok(seconds[RUNS / 2])
}

/// Of the straight line nearest to the points (least squares).
fn slope(points: &[(f64, f64)]) -> f64 {
    let count = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / count, y + p.1 / count));
    let cross: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    cross / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}
