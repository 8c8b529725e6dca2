//! Computes the missing chunks of a run that this process can claim, on all threads, until none is left.

use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use rayon::prelude::*;

use super::claims::Claims;
use super::plan::{Computed, Plan};
use super::progress::{Progress, ProgressTarget};
use super::{FleetError, parts};

/// Time between looks at chunks that other workers have.
const LOOK: Duration = Duration::from_millis(500);

/// Computes what is missing in a folder, or as one of several workers what nobody else does; how many trains or cases failed in it.
/// A worker waits until every chunk is done, its own and those of others, because another worker may be killed before its chunk is done.
///
/// # Errors
/// As for [`Plan::compute`]; a part that cannot be written.
pub fn compute(
    dir: &Path,
    plan: &Plan,
    claims: Option<&Claims>,
    telling: &ProgressTarget,
) -> Result<usize, FleetError> {
    parts::prepare(dir)?;
    let mut missing: Vec<usize> = (0..plan.chunks()).filter(|&chunk| !parts::is_done(dir, chunk)).collect();
    let cases = |chunk: usize| plan.range(chunk).end - plan.range(chunk).start;
    let progress = Progress::new(missing.iter().map(|&chunk| cases(chunk)).sum(), telling);
    let mut failed = 0;
    while !missing.is_empty() {
        let held = Mutex::new(Vec::new());
        let turn = |chunk: usize| {
            if parts::is_done(dir, chunk) {
                progress.add(cases(chunk) as usize, 0);
                return None;
            }
            match claims.map_or(Ok(true), |claims| claims.take(&chunk.to_string())) {
                Ok(true) => Some(Ok(chunk)),
                Ok(false) => {
                    held.lock().unwrap_or_else(PoisonError::into_inner).push(chunk);
                    None
                }
                Err(error) => Some(Err(FleetError::from(error))),
            }
        };
        let one = |chunk: Result<usize, FleetError>| {
            let chunk = chunk?;
            let done = work(plan, chunk, &progress)?;
            #[cfg(feature = "parquet")]
            if let Some(couplers) = done.couplers {
                couplers.write(&parts::couplers(dir), chunk)?;
            }
            let failed = done.rows.failed;
            parts::keep(dir, chunk, done.rows.into_bytes())?;
            Ok::<usize, FleetError>(failed)
        };
        let done: Result<Vec<usize>, FleetError> = missing.into_iter().filter_map(turn).par_bridge().map(one).collect();
        failed += done?.into_iter().sum::<usize>();
        missing = held.into_inner().unwrap_or_else(PoisonError::into_inner);
        if !missing.is_empty() {
            plan.options.stop.check()?;
            std::thread::sleep(LOOK);
        }
    }
    progress.finish();
    Ok(failed)
}

/// A chunk's cases.
///
/// # Errors
/// As for [`Plan::compute`].
pub fn work(plan: &Plan, chunk: usize, progress: &Progress) -> Result<Computed, FleetError> {
    let done = plan.compute(chunk)?;
    let range = plan.range(chunk);
    progress.add((range.end - range.start) as usize, done.rows.failed);
    Ok(done)
}
