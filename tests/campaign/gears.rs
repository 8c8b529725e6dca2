//! Random trains with slack, gears and brakes: does the march's estimate, or its bound, cover the error of every coupler's peaks?

mod trains;

use std::collections::BTreeMap;

use rayon::prelude::*;

pub use trains::{GearKind, draw};
use trainsafe::accuracy::gears::exact::GearReference;
use trainsafe::march::{Bound, MarchOptions, MarchOutcome, Problem, solve};
use trainsafe::solve::dd::Dd;

/// A march ends where its estimate passes this share of the train's largest force.
const TOLERANCE: f64 = 1e-6;
/// A reference is good enough where it is known to this share of the estimate.
const KNOWN: f64 = 0.01;

/// What was found of one kind of train.
#[derive(Clone, Debug, Default)]
pub struct GearTally {
    /// Trains.
    pub trains: usize,
    /// Peaks compared: two of each coupler.
    pub peaks: usize,
    /// Peaks whose error is larger than stated: seed, coupler from 1, error over estimate.
    pub missed: Vec<(u64, usize, f64)>,
    /// The largest error over estimate, and its seed.
    pub worst: (f64, u64),
    /// The largest error over a proven bound, and its seed.
    pub worst_proven: (f64, u64),
    /// Trains with a proven bound.
    pub proven: usize,
    /// Marches that ended where nothing could be predicted any more.
    pub lost: usize,
    /// Couplers that parted after t = 0.
    pub parted: usize,
    /// Trains in which others parted, or at instants that differ by more than an estimate explains.
    pub other_order: Vec<u64>,
    /// Trains whose reference is not good enough.
    pub without_reference: Vec<u64>,
    /// Error over what was stated, of every peak.
    ratios: Vec<f64>,
}

impl GearTally {
    /// Adds another one's counts.
    pub fn add(&mut self, other: &GearTally) {
        self.trains += other.trains;
        self.peaks += other.peaks;
        self.missed.extend(&other.missed);
        self.proven += other.proven;
        self.lost += other.lost;
        self.parted += other.parted;
        self.other_order.extend(&other.other_order);
        self.without_reference.extend(&other.without_reference);
        self.ratios.extend(&other.ratios);
        for (worst, of_other) in [(&mut self.worst, other.worst), (&mut self.worst_proven, other.worst_proven)] {
            if of_other.0 > worst.0 {
                *worst = of_other;
            }
        }
    }

    /// The ratio of error to what was stated that a share of the peaks is under.
    pub fn quantile(&self, share: f64) -> f64 {
        let mut sorted = self.ratios.clone();
        sorted.sort_by(f64::total_cmp);
        sorted.get((share * sorted.len() as f64) as usize).copied().unwrap_or(f64::NAN)
    }

    /// Share of the peaks whose error is covered.
    pub fn coverage(&self) -> f64 {
        1.0 - self.missed.len() as f64 / self.peaks.max(1) as f64
    }
}

/// Compares the trains of many seeds, in parallel.
pub fn run(seeds: &[u64]) -> BTreeMap<GearKind, GearTally> {
    let all: Vec<(GearKind, GearTally)> = seeds.par_iter().map(|seed| train(*seed)).collect();
    let mut tallies: BTreeMap<GearKind, GearTally> = BTreeMap::new();
    all.iter().for_each(|(kind, tally)| tallies.entry(*kind).or_default().add(tally));
    tallies
}

/// Compares one train.
pub fn train(seed: u64) -> (GearKind, GearTally) {
    let (kind, problem) = draw(seed);
    (kind, compared(seed, &problem))
}

/// The march of a problem with its error, and up to where it can be predicted.
pub fn marched(problem: &Problem) -> (MarchOutcome, Problem) {
    let forces = problem.start.iter().map(|r| r.force_n.abs());
    let drives = problem.forcing.iter().map(|f| f.1.measures()[0]);
    let scale_n = forces.chain(drives).fold(1e5, f64::max);
    let outcome = solve(problem, &MarchOptions { tolerance_n: Some(TOLERANCE * scale_n), ..MarchOptions::default() });
    let horizon_s = outcome.predictable_until_s.unwrap_or(problem.horizon_s);
    let horizon_s = outcome.stopped.map_or(horizon_s, |s| horizon_s.min(s.1));
    (outcome, Problem { horizon_s, mark_s: horizon_s, ..problem.clone() })
}

fn compared(seed: u64, problem: &Problem) -> GearTally {
    let (outcome, problem) = marched(problem);
    let proven = matches!(outcome.bound, Bound::Proven(_));
    let mut tally = GearTally {
        trains: 1,
        proven: usize::from(proven),
        lost: usize::from(outcome.predictable_until_s.is_some()),
        ..GearTally::default()
    };
    let least = outcome.error_n.iter().flatten().copied().fold(f64::INFINITY, f64::min);
    let reference = match GearReference::new(&problem, &[]) {
        Ok(reference) if reference.doubt_n <= KNOWN * least => reference,
        _ => {
            tally.without_reference.push(seed);
            return tally;
        }
    };
    let parted: Vec<usize> = outcome.partings.iter().filter(|p| p.time_s > 0.0).map(|p| p.coupler).collect();
    tally.parted = parted.len();
    if parted != reference.found.parted.iter().map(|p| p.0).collect::<Vec<_>>() {
        tally.other_order.push(seed);
    }
    for (i, (exact, found)) in reference.found.largest.iter().zip(&outcome.extremes).enumerate() {
        for (side, found) in [found.draft.force_n, -found.buff.force_n].into_iter().enumerate() {
            let error = if found.is_finite() { (Dd::from(found) - exact[side]).abs().hi } else { f64::INFINITY };
            let ratio = error / outcome.error_n[i][side];
            tally.peaks += 1;
            tally.ratios.push(ratio);
            if ratio > 1.0 {
                tally.missed.push((seed, i + 1, ratio));
            }
            let worst = if proven { &mut tally.worst_proven } else { &mut tally.worst };
            if ratio > worst.0 {
                *worst = (ratio, seed);
            }
        }
    }
    tally
}
