//! How far the force axis of a figure reaches, and what is said of ratings that lie beyond it.

use super::HEIGHT;
use crate::figures::Panel;
use crate::report::numbers::{digits, force_unit, without_zeros};
use crate::units::UnitSystem;

/// Share of the axis that the forces must still fill if a rating is put on it: a rating of the sense that is nearer to
/// its rating, and one of the other.
const LEAST: [f64; 2] = [0.4, 0.75];
/// Share of the axis that stays free at an end: usually, and where it says what lies beyond.
const AIR: f64 = 0.06;
const STRIP: f64 = 30.0 / HEIGHT;

/// A force axis.
pub struct ForceAxis {
    /// Its ends, N.
    pub range: (f64, f64),
    /// Smallest and largest rating in draft that lies above it, N.
    draft: Option<(f64, f64)>,
    /// The same in buff, below it; magnitudes.
    buff: Option<(f64, f64)>,
}

impl ForceAxis {
    /// An axis for all forces, N, zero, and those ratings in draft and in buff that leave them visible.
    pub fn new(forces: impl Iterator<Item = f64>, draft: &[f64], buff: &[f64]) -> ForceAxis {
        let forces = forces.filter(|f| f.is_finite()).fold((0.0f64, 0.0f64), |(l, h), f| (l.min(f), h.max(f)));
        let least = |of: &[f64]| of.iter().copied().fold(f64::INFINITY, f64::min);
        let draft_is_nearer = forces.1 / least(draft) >= -forces.0 / least(buff);
        let mut reach = ForceAxis { range: forces, draft: None, buff: None };
        let mut ratings: Vec<f64> = draft.iter().copied().chain(buff.iter().map(|r| -r)).collect();
        let outside = |r: f64| (forces.0 - r).max(r - forces.1);
        ratings.sort_by(|a, b| outside(*a).total_cmp(&outside(*b)));
        for rating in ratings {
            let (low, high) = (reach.range.0.min(rating), reach.range.1.max(rating));
            let least = LEAST[usize::from((rating > 0.0) != draft_is_nearer)];
            let nothing = forces.0 == forces.1;
            if nothing || forces.1 - forces.0 >= least * (high - low) {
                reach.range = (low, high);
                continue;
            }
            let beyond = if rating > 0.0 { &mut reach.draft } else { &mut reach.buff };
            let size = rating.abs();
            *beyond = Some(beyond.map_or((size, size), |(l, h)| (l.min(size), h.max(size))));
        }
        reach.add_air();
        reach
    }

    fn add_air(&mut self) {
        let (low, high) = self.range;
        let room = |beyond: Option<(f64, f64)>, end: f64| match beyond {
            Some(_) => STRIP,
            None if end == 0.0 => 0.0,
            None => AIR,
        };
        let (below, above) = (room(self.buff, low), room(self.draft, high));
        let whole = (high - low) / (1.0 - below - above);
        self.range =
            if whole > 0.0 && whole.is_finite() { (low - below * whole, high + above * whole) } else { (-1.0, 1.0) };
    }

    /// The magnitude that decides the axis' unit, N.
    pub fn largest(&self) -> f64 {
        self.range.1.max(-self.range.0)
    }

    /// Whether a rating, N, negative in buff, is on the axis.
    pub fn shows(&self, rating: f64) -> bool {
        (self.range.0..=self.range.1).contains(&rating)
    }

    /// Says in the panel what lies beyond its ends.
    pub fn tell(&self, panel: &mut Panel, units: UnitSystem) {
        for (beyond, above) in [(self.draft, true), (self.buff, false)] {
            let Some((low, high)) = beyond else { continue };
            let to = if low < high { format!(" to {}", four_digits(units, high)) } else { String::new() };
            panel.beyond(&format!("rated {}{to}", four_digits(units, low)), above);
        }
    }
}

/// A force in a figure.
pub fn four_digits(units: UnitSystem, force_n: f64) -> String {
    let unit = force_unit(units, force_n);
    format!("{} {}", without_zeros(&digits(force_n / unit.size, 0.0, 4)), unit.name)
}

#[cfg(test)]
mod tests;
