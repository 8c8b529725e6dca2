//! Roughly how long a run will take, from a few of its cases.
//!
//! Of a random sample of the cases the work is counted; as many of them as take little time are solved, on all threads as the
//! run itself would. With `c` the counted and `t` the measured time of a case, the run takes
//!
//! ```text
//! cases * mean(c) * sum(t) / sum(c) / threads
//! ```
//!
//! where the mean is over all that were counted and the sums over those that were solved: the counts say how cases differ,
//! the measurements what a count takes on this machine. A case is solved together with those of its train that the run solves with it, and
//! its c and t are their means. That other trains may have the same scenes is left out.

use std::time::Instant;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use rayon::prelude::*;

use super::FleetError;
use super::plan::Plan;
use crate::findings;
use crate::solve::responses::Shared;

/// Cases whose work is counted, at most.
const COUNTED: u64 = 300;
/// Time for solving some of them, s; one that will take longer by its count is not begun.
const SOLVING_S: f64 = 1.5;

/// What is known of a case, s.
struct SampledCase {
    /// To read its train.
    load: f64,
    /// By the counted work, in the mean of the cases that are solved together.
    counted: f64,
    /// Measured, in the mean of the same cases; `None` if they were not solved.
    solved: Option<f64>,
}

/// The shortest and the longest time that the run will probably take on all threads, s.
///
/// # Errors
/// A train file that has changed.
pub fn seconds(plan: &Plan) -> Result<[f64; 2], FleetError> {
    let cases = plan.cases();
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut sample: Vec<u64> = (0..cases.min(COUNTED)).collect();
    if cases > COUNTED {
        sample.iter_mut().for_each(|case| *case = random.next_u64() % cases);
    } else {
        // Which of them are solved must not depend on the order of the trains.
        sample.sort_by_cached_key(|_| random.next_u64());
    }
    let start = Instant::now();
    let looked = sample.par_iter().with_max_len(1).map(|&case| sample_case(plan, case, start));
    // Trains that cannot be read take no time.
    let looked: Vec<SampledCase> = looked.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect();
    let count = looked.len() as f64;
    if count == 0.0 {
        return Ok([0.0, 0.0]);
    }
    let mean = |of: fn(&SampledCase) -> f64| looked.iter().map(of).sum::<f64>() / count;
    let (load, counted) = (mean(|l| l.load), mean(|l| l.counted));
    let solved: Vec<(f64, f64)> = looked.iter().filter_map(|l| Some((l.counted, l.solved?))).collect();
    let (sum_counted, sum_solved) = solved.iter().fold((0.0, 0.0), |(c, t), one| (c + one.0, t + one.1));
    let worth = if sum_counted > 0.0 { sum_solved / sum_counted } else { 1.0 };
    // Variances of the mean of the counts and of the ratio, relative to their squares.
    let of_mean = looked.iter().map(|l| (l.counted / counted - 1.0).powi(2)).sum::<f64>() / (count * count);
    let of_mean = if cases > COUNTED { of_mean } else { 0.0 };
    let of_ratio = solved.iter().map(|(c, t)| (t - worth * c).powi(2)).sum::<f64>() / sum_solved.powi(2);
    // Two standard deviations; a handful gives no deviation.
    let spread = if solved.len() < 5 { 1.0 } else { (2.0 * (of_mean + of_ratio).sqrt()).clamp(0.1, 1.0) };
    let loads = (plan.chunks() + plan.units()) as f64;
    let threads = rayon::current_num_threads() as f64;
    let about = (cases as f64 * worth * counted + loads * load) / threads;
    Ok([about / (1.0 + spread), about * (1.0 + spread)])
}

/// Counts the work of the cases that are solved together with one, and solves them if there is time; the mean of these cases.
fn sample_case(plan: &Plan, case: u64, start: Instant) -> Result<Option<SampledCase>, FleetError> {
    let (unit, index) = plan.place(case);
    let from = Instant::now();
    let Ok(train) = plan.load(unit)?.train else { return Ok(None) };
    let load = from.elapsed().as_secs_f64();
    let mut before = 0;
    for scenario in train.scenarios() {
        let all = findings::cases(&scenario.event);
        if index - before < all.len() {
            let some = findings::cases_at_once(&train, scenario);
            let some = all.chunks(some).nth((index - before) / some).unwrap_or_default();
            let count = |b: &Option<usize>| findings::case_estimate_s(&train, scenario, *b, &plan.options);
            let each = 1.0 / some.len().max(1) as f64;
            let counted = each * some.iter().filter_map(|b| count(b).ok()).sum::<f64>();
            let is_time = start.elapsed().as_secs_f64() < SOLVING_S && counted < each * SOLVING_S;
            let solved = is_time.then(|| {
                let shared = plan.shared(&train);
                // Those that cannot be computed take their time too.
                let solve = || findings::cases_findings(&train, scenario, some, &plan.options, shared);
                // Untimed: the run finds a response once.
                if matches!(shared, Shared::EveryChain(_)) {
                    drop(solve());
                }
                let begun = Instant::now();
                drop(solve());
                each * begun.elapsed().as_secs_f64()
            });
            return Ok(Some(SampledCase { load, counted, solved }));
        }
        before += all.len();
    }
    Ok(None)
}
