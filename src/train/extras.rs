//! What a train may have beyond linear springs under a given load.

use crate::law::Law;
use crate::units::{Dimension, UnitSystem, shown};

/// All of it is absent by default, and what is absent changes no result.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Extras {
    /// The forces from outside that the steady state comes from; `None` where the file gives the couplers' forces.
    pub steady: Option<Steady>,
    /// Dashpots beside the couplers' springs, N s/m, coupler by coupler; empty if there are none.
    pub dashpot_n_s_per_m: Vec<f64>,
    /// Share of critical damping of every mode, under 1; 0 without. Never together with dashpots.
    pub damping_ratio: f64,
    /// Capacities beside the rating, coupler by coupler; empty if there are none.
    pub limits: Vec<Limits>,
    /// The law of each coupler's force; empty where every coupler is one linear spring.
    pub laws: Vec<Law>,
    /// The largest pull in each coupler before, N, from which it was let down to the load; empty where there was none but the load.
    pub pulled_to_n: Vec<f64>,
    /// Full brake force of each vehicle in an emergency application, N, not negative; empty if there is none.
    pub emergency_brake_n: Vec<f64>,
    /// Speed before the event, m/s, where the file gives it.
    pub speed_m_per_s: Option<f64>,
}

/// Names of the senses of a force, in the order in which pairs have them: tension and compression.
pub const SENSES: [&str; 2] = ["draft", "buff"];

/// Names of the capacities beside the rating, in rising order.
pub const LIMITS: [&str; 3] = ["fatigue", "proof", "ultimate"];

/// A coupler's capacities beside its rating, N, positive, in each sense in the order of [`LIMITS`]; `None` where not given.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// In tension.
    pub draft_n: [Option<f64>; 3],
    /// In compression.
    pub buff_n: [Option<f64>; 3],
}

impl Limits {
    /// The same capacities in both senses.
    pub const fn both(capacities_n: [Option<f64>; 3]) -> Limits {
        Limits { draft_n: capacities_n, buff_n: capacities_n }
    }

    /// Those of draft and those of buff.
    pub fn in_senses(&self) -> [[Option<f64>; 3]; 2] {
        [self.draft_n, self.buff_n]
    }

    /// The load at which the coupler breaks in draft and in buff.
    pub fn ultimate_n(&self) -> [Option<f64>; 2] {
        self.in_senses().map(|[_, _, ultimate]| ultimate)
    }

    /// These, and those of `other` where these are not given.
    pub fn or(&self, other: &Limits) -> Limits {
        let or = |own: [Option<f64>; 3], other: [Option<f64>; 3]| std::array::from_fn(|l| own[l].or(other[l]));
        Limits { draft_n: or(self.draft_n, other.draft_n), buff_n: or(self.buff_n, other.buff_n) }
    }

    /// Those that are given, with their names: `draft.proof`.
    pub(crate) fn named(&self) -> impl Iterator<Item = (String, f64)> {
        let all = SENSES.into_iter().zip(self.in_senses());
        let of_sense = |(sense, capacities): (&'static str, [Option<f64>; 3])| {
            LIMITS.into_iter().zip(capacities).filter_map(move |(name, n)| n.map(|n| (format!("{sense}.{name}"), n)))
        };
        all.flat_map(of_sense)
    }

    /// What is not in rising order, and what would be right: `proof in draft, 2 MN, is above ultimate, 1.8 MN`.
    pub(crate) fn disorder(&self, units: UnitSystem) -> Option<[String; 2]> {
        let force = |n: f64| shown(units, n, Dimension::Force);
        let in_sense = |(capacities, sense): ([Option<f64>; 3], &str)| {
            let given: Vec<_> = LIMITS.iter().zip(capacities).filter_map(|(name, n)| Some((name, n?))).collect();
            let wrong = given.windows(2).find(|pair| pair[0].1 > pair[1].1)?;
            let [(lower, a), (upper, b)] = [wrong[0], wrong[1]];
            let right = "the order is fatigue, proof, ultimate, and none is above the next";
            Some([format!("{lower} in {sense}, {}, is above {upper}, {}", force(a), force(b)), right.to_owned()])
        };
        self.in_senses().into_iter().zip(SENSES).find_map(in_sense)
    }
}

/// The steady state of a hauled train.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Steady {
    /// Forces from outside on each vehicle, N, forward positive: traction, running resistance, grade, brakes.
    pub outside_n: Vec<f64>,
    /// How far each coupler's force before the event may be from the exact one, N: 0 where a double holds it exactly.
    pub error_n: Vec<f64>,
    /// Acceleration of the whole train, m/s2, forward positive; 0 where a vehicle is held.
    pub acceleration_m_per_s2: f64,
}
