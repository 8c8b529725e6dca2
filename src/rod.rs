//! The elastic rod: what a continuum model would have said, [P] section 3, eqs (30) and (31).

use crate::consist::Train;

/// Force in one coupler's place in the rod at given times, N; `None` where there is no rod.
pub fn history(
    _train: &Train,
    _scenario: usize,
    _broken: Option<usize>,
    _coupler: usize,
    _times_s: &[f64],
) -> Option<Vec<f64>> {
    None
}
