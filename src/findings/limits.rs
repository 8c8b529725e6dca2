//! Which capacities besides its rating each coupler passes.

use serde::Serialize;

use super::CouplerFindings;
use crate::consist::{LIMITS, Train};

/// A coupler's largest force, of either sense, against its other capacities.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LimitFindings {
    /// |force|, N.
    pub largest_n: f64,
    /// Names of those that it certainly passes.
    pub passed: Vec<&'static str>,
    /// Names of those that lie within the error bound of it.
    pub undecided: Vec<&'static str>,
}

/// Notes them where the train has any; a force before the event is exact, every other one within `error_bound_n`.
pub(super) fn find(train: &Train, couplers: &mut [CouplerFindings], error_bound_n: f64) {
    for c in couplers {
        let Some(limits) = train.extras.limits.get(c.coupler - 1) else { return };
        let largest_n = c.peak_draft_n.unwrap_or(0.0).max(-c.peak_buff_n.unwrap_or(0.0));
        let error = if largest_n == c.initial_force_n.abs() { 0.0 } else { error_bound_n };
        let named = |test: &dyn Fn(f64) -> bool| -> Vec<&'static str> {
            let given = LIMITS.iter().zip(limits.0).filter(|(_, n)| n.is_some_and(test));
            given.map(|(name, _)| *name).collect()
        };
        let passed = named(&|n| largest_n > n + error);
        let undecided = named(&|n| error > 0.0 && (largest_n - n).abs() <= error);
        c.limits = Some(LimitFindings { largest_n, passed, undecided });
    }
}
