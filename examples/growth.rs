//! How do the time and the work of a scene grow with the number of couplers? Four transits behind a held head, one break; chains of equal
//! and of unequal vehicles; without vectors up to n = 210, and with the vectors that the program uses here. Of each: the time, the time per
//! coupler and step that was marched, how many steps were considered, kept and looked into for each coupler and sense, and the exponent
//! of the power of n that fits the times best.
//!
//! ```text
//! cargo run --release --example growth            n = 25 to 3,000
//! GROWTH_TO=10000 cargo run --release --example growth
//! ```

use std::time::Instant;

use trainsafe::chain::{Chain, Scene};
use trainsafe::solve::{Ask, Method, SolveError, Work, solve, vectors};

const RUNS: usize = 3;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let most: usize = std::env::var("GROWTH_TO").map_or(Ok(3000), |text| text.parse())?;
    let sizes = [25, 50, 100, 210, 500, 1000, 2000, 3000, 5000, 10_000];
    let cases = [("equal", Method::Fronts), ("equal", Method::Propagator), ("unequal", Method::Propagator)];
    for ((chain, method), scalars) in cases.into_iter().flat_map(|case| [(case, true), (case, false)]) {
        vectors::use_scalars(scalars);
        println!("{chain} chain, {}, {}", method.name(), vectors::name());
        let most = if scalars { most.min(210) } else { most };
        let mut points = Vec::new();
        for n in sizes.into_iter().filter(|n| *n <= most) {
            let (seconds, work) = median_seconds(&scene(n, chain == "unequal"), method)?;
            let step = match work.marched {
                0 => String::new(),
                marched => format!("{:8.2} ns per coupler and step", 1e9 * seconds / marched as f64),
            };
            let [considered, kept, looked] =
                [work.considered, work.kept, work.refinements].map(|count| count as f64 / (2 * n) as f64);
            println!(
                "  n = {n:6}  {:10.3} ms  per coupler and sense {considered:6.2} considered {kept:6.2} kept {looked:6.2} looked into {step}",
                1e3 * seconds
            );
            points.push(((n as f64).ln(), seconds.ln()));
        }
        println!("  time grows as n^{:.2}", slope(&points));
    }
    Ok(())
}

fn scene(n: usize, unequal: bool) -> Scene {
    let spread = |size: f64, angle: f64| if unequal { 1.0 + size * angle.sin() } else { 1.0 };
    let mass = (0..=n).map(|v| spread(0.6, 1.7 * (v * v) as f64)).collect();
    let stiffness = (0..n).map(|i| spread(0.4, 2.3 * (i * i) as f64)).collect();
    let chain = Chain { mass, stiffness, held_head: true, held_tail: false };
    let horizon = 4.0 * chain.transit();
    Scene {
        chain,
        source: n,
        force: 0.8,
        duration: f64::INFINITY,
        initial: vec![0.8; n],
        rated_draft: vec![1.0; n],
        rated_buff: vec![1.0; n],
        horizon,
    }
}

fn median_seconds(scene: &Scene, method: Method) -> Result<(f64, Work), SolveError> {
    let ask = Ask { tolerance: 1e-9, method: Some(method), ..Ask::default() };
    let mut seconds = Vec::with_capacity(RUNS);
    let mut work = Work::default();
    for _ in 0..RUNS {
        let start = Instant::now();
        work = std::hint::black_box(solve(scene, &ask)?).work;
        seconds.push(start.elapsed().as_secs_f64());
    }
    seconds.sort_by(f64::total_cmp);
    Ok((seconds[RUNS / 2], work))
}

/// Of the straight line nearest to the points (least squares).
fn slope(points: &[(f64, f64)]) -> f64 {
    let count = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / count, y + p.1 / count));
    let cross: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    cross / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}
