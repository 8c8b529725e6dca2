//! How long an analysis will take, from the count of its work.

use rayon::prelude::*;

use super::{AnalyzeError, Options, ask, cases, chosen, load_search, map, march, safe_speed};
use crate::scenario::{self, Motion, Scales};
use crate::solve::{self, SolveError, damped_modes};
use crate::train::{Rule, Scenario, Train};

/// The longest that an analysis may take by its estimate, s.
const MOST_SECONDS: f64 = 3600.0;

/// The memory that results and their report may take, bytes.
const MOST_BYTES: usize = 6_000_000_000;

/// Memory of a coupler in a case, measured and rounded up: on one case of a million couplers, all in `result.json`,
/// and on 1400 cases of 1399, not all in it.
const BYTES_ALONE: usize = 4200;
const BYTES_OF_SEVERAL: usize = 500;

/// Cases of a scenario whose work is counted for an estimate, at most.
const SAMPLE: usize = 200;

/// Estimated memory that the results of [`super::analyze`] and their report take, bytes.
///
/// # Errors
/// [`AnalyzeError::UnknownScenario`].
pub fn memory_bytes(train: &Train, options: &Options) -> Result<usize, AnalyzeError> {
    let of_scenario = |s: &&Scenario| match cases(&s.event).len() {
        1 => BYTES_ALONE,
        several => several.saturating_mul(BYTES_OF_SEVERAL),
    };
    let each: usize = chosen(train, options)?.iter().map(of_scenario).fold(0, usize::saturating_add);
    Ok(each.saturating_mul(train.couplers().len()))
}

/// Estimated time of [`super::analyze`] on one core, s, from the count of its work.
///
/// # Errors
/// As for [`super::analyze`]; [`AnalyzeError::TooLong`] where all cases together would take over an hour,
/// [`AnalyzeError::TooLarge`] where their results would take more than 6 GB of memory.
pub fn estimate_s(train: &Train, options: &Options) -> Result<f64, AnalyzeError> {
    let bytes = memory_bytes(train, options)?;
    if bytes > MOST_BYTES {
        return Err(AnalyzeError::TooLarge { bytes, most: MOST_BYTES });
    }
    let mut total = 0.0;
    for scenario in chosen(train, options)? {
        let cases = cases(&scenario.event);
        // Of very many cases a sample is enough.
        let sample: Vec<_> = cases.iter().step_by(cases.len().div_ceil(SAMPLE).max(1)).collect();
        let seconds: Result<f64, _> = sample.par_iter().map(|&&b| case_estimate_s(train, scenario, b, options)).sum();
        let seconds = seconds.map_err(|source| AnalyzeError::Solve { scenario: scenario.name.clone(), source })?;
        let mapped = if options.map && scenario::is_proportional(train, scenario) {
            map::cases(train, &scenario.event)
        } else {
            0
        };
        total += seconds * (cases.len() + mapped) as f64 / sample.len().max(1) as f64;
    }
    if total > MOST_SECONDS { Err(AnalyzeError::TooLong { seconds: total }) } else { Ok(total) }
}

/// Estimated time of one case on one core, s.
pub(crate) fn case_estimate_s(
    train: &Train,
    scenario: &Scenario,
    broken: Option<usize>,
    options: &Options,
) -> Result<f64, SolveError> {
    let ends_s = scenario::ends_s(train, scenario, broken);
    let once = solved_s(train, scenario, broken, ends_s, options)?;
    if !scenario::is_proportional(train, scenario) {
        return Ok(once);
    }
    let mut seconds = once;
    if scenario.cascade != Rule::Keep {
        seconds += march::estimate_s(train, scenario, broken, ends_s[0], scenario.cascade, options);
    }
    if scenario::unbalanced_n(train, &scenario.event).iter().any(|f| *f != 0.0) {
        seconds += once * safe_speed::USUAL_FACTORS;
    }
    Ok(seconds)
}

/// Estimated time of solving a case up to an instant, and up to a mark if that is before it, s; of gears and brakes with
/// a cascade and the search for a load.
pub(super) fn solved_s(
    train: &Train,
    scenario: &Scenario,
    broken: Option<usize>,
    [until_s, mark_s]: [f64; 2],
    options: &Options,
) -> Result<f64, SolveError> {
    let parts = || scenario::parts(train, &scenario.event, broken, until_s);
    match Motion::of(train, scenario) {
        Motion::March => {
            let once = march::estimate_s(train, scenario, broken, until_s, Rule::Keep, options);
            if scenario::is_proportional(train, scenario) {
                return Ok(once);
            }
            let search_s = load_search::estimate_s(train, scenario, broken, until_s, options).unwrap_or(0.0);
            Ok(search_s + if scenario.cascade == Rule::Keep { once } else { 2.0 * once })
        }
        Motion::DampedModes(_) => Ok(parts().iter().map(|p| damped_modes::estimate_s(&p.scene)).sum()),
        Motion::Steps => {
            let ask = ask(train, &Scales::of(train), options, (mark_s < until_s).then_some(mark_s));
            parts().iter().map(|p| solve::estimate_s(&p.scene, &ask)).sum()
        }
    }
}
