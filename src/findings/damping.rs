//! The worst case of a scenario again, with dashpots in every coupler: how far its verdict rests on couplers without losses.

use rayon::prelude::*;
use serde::Serialize;

use super::{CaseFindings, Options, general};
use crate::play::Rule;
use crate::scenario;
use crate::solve::SolveError;
use crate::train::{Scenario, Train};

/// Damping ratios of a dashpot, c / (2 √(k m)): the range that is published for draft gears, and a value between.
const RATIOS: [f64; 3] = [0.05, 0.14, 0.26];

/// The longest that one ratio may take by its estimate, s.
const MOST_SECONDS: f64 = 5.0;

/// The worst case of a scenario, with dashpots of one damping ratio in every coupler.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DampingFindings {
    /// c / (2 √(k m)) of every coupler, k its stiffness and m the lighter of its vehicles that is not held.
    pub damping_ratio: f64,
    /// Couplers that exceed their rating.
    pub exceeding: usize,
    /// The coupler of the largest utilisation, counted from 1.
    pub coupler: usize,
    /// Its force of the largest utilisation, N, draft positive.
    pub peak_force_n: f64,
    /// When, s after the event.
    pub peak_time_s: f64,
    /// |peak_force_n| over the rating in that sign.
    pub utilisation: f64,
    /// No force is further than this from the exact one, N.
    pub error_bound_n: f64,
}

/// The sweep over the ratios; empty for a train that has losses of its own, without a coupler to watch, or where it takes too long.
///
/// # Errors
/// As for a case.
pub(super) fn sweep(
    train: &Train,
    scenario: &Scenario,
    cases: &[CaseFindings],
    options: &Options,
) -> Result<Vec<DampingFindings>, SolveError> {
    let used = |case: &CaseFindings| case.worst.as_ref().map_or(-1.0, |w| w.utilisation);
    let worst = cases.iter().filter(|c| c.worst.is_some()).reduce(|a, b| if used(b) > used(a) { b } else { a });
    let Some(worst) = worst.filter(|_| !has_losses(train) && !scenario::is_march(train, scenario)) else {
        return Ok(Vec::new());
    };
    let found = RATIOS.par_iter().map(|&ratio| with_ratio(train, scenario, worst, ratio, options));
    found.filter_map(Result::transpose).collect()
}

fn has_losses(train: &Train) -> bool {
    train.extras().damping_ratio > 0.0 || !train.extras().dashpot_n_s_per_m.is_empty()
}

/// The case with dashpots of one ratio; `None` where that would take too long.
fn with_ratio(
    train: &Train,
    scenario: &Scenario,
    case: &CaseFindings,
    ratio: f64,
    options: &Options,
) -> Result<Option<DampingFindings>, SolveError> {
    let dashpot_n_s_per_m = (0..train.couplers().len()).map(|i| ratio * critical_n_s_per_m(train, i)).collect();
    let damped = train.with_dashpots(dashpot_n_s_per_m);
    let broken = case.broken_coupler.map(|b| b - 1);
    if general::estimate_s(&damped, scenario, broken, case.horizon_s, Rule::Keep) > MOST_SECONDS {
        return Ok(None);
    }
    let options = Options { method: None, ..options.clone() };
    let solved = general::solved(&damped, scenario, broken, case.horizon_s, &options)?;
    let exceeding = solved.couplers.iter().filter(|c| c.exceeds == Some(true)).count();
    Ok(solved.worst.map(|i| &solved.couplers[i]).map(|c| DampingFindings {
        damping_ratio: ratio,
        exceeding,
        coupler: c.coupler,
        peak_force_n: c.peak_force_n,
        peak_time_s: c.peak_time_s,
        utilisation: c.utilisation,
        error_bound_n: solved.error_bound_n,
    }))
}

/// Critical damping of a coupler between its lighter vehicle and a wall, 2 √(k m), N s/m; 0 between two held vehicles.
pub(crate) fn critical_n_s_per_m(train: &Train, coupler: usize) -> f64 {
    let live = [coupler, coupler + 1].into_iter().map(|v| &train.vehicles()[v]).filter(|v| !v.held);
    let mass = live.map(|v| v.mass_kg).fold(f64::INFINITY, f64::min);
    if mass.is_finite() { 2.0 * (train.couplers()[coupler].stiffness_n_per_m * mass).sqrt() } else { 0.0 }
}
