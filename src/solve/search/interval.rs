//! Pieces of time that a search splits, the one with the highest bound first.

use std::cmp::Ordering;

use super::super::local::Local;

/// A piece of time with an upper bound on a side's force.
#[derive(Clone, Debug)]
pub struct Interval {
    /// The bound.
    pub upper: f64,
    /// When it begins.
    pub from: f64,
    /// When it ends.
    pub to: f64,
}

impl Interval {
    /// A piece from one time to another.
    pub fn new(upper: f64, (from, to): (f64, f64)) -> Interval {
        Interval { upper, from, to }
    }

    /// Its quarters, each with its bound: that of the side's polynomial, and `margin` for the other modes.
    pub fn quarters(&self, local: &Local, margin: f64) -> Vec<Interval> {
        let (a, b) = (self.from, self.to);
        let time = |k: usize| if k == 4 { b } else { a + (b - a) * k as f64 / 4.0 };
        let quarter = |(k, top)| Interval { upper: top + margin, from: time(k), to: time(k + 1) };
        local.upper_bounds(4).enumerate().map(quarter).collect()
    }

    /// Its times can no longer be distinguished.
    pub fn is_too_small(&self) -> bool {
        self.to - self.from <= 2e-13 * self.to
    }
}

impl PartialEq for Interval {
    fn eq(&self, other: &Interval) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Interval {}

impl PartialOrd for Interval {
    fn partial_cmp(&self, other: &Interval) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// By bound; of equal ones the earlier is greater.
impl Ord for Interval {
    fn cmp(&self, other: &Interval) -> Ordering {
        self.upper.total_cmp(&other.upper).then(other.from.total_cmp(&self.from))
    }
}
