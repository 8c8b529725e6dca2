//! How a train as it is given becomes a [`Train`].

use super::labels::numbered;
use super::steady::steady_forces;
use super::{
    Coupler, CouplerSpec, Extras, InvalidTrain, Limits, Load, PulledTo, SpecProblem, Steady, Train, TrainSpec, Vehicle,
    checks,
};
use crate::law::{GearRow, Law};

impl TrainSpec {
    /// The train.
    ///
    /// # Errors
    /// Everything that is wrong with the spec, each with the key that it is about.
    pub fn build(mut self) -> Result<Train, InvalidTrain> {
        let scenarios = std::mem::take(&mut self.scenarios);
        let (train, mut problems) = self.examine();
        let Some(mut train) = train else { return Err(InvalidTrain { problems }) };
        problems.extend(train.set_scenarios(scenarios));
        if problems.is_empty() { Ok(train) } else { Err(InvalidTrain { problems }) }
    }

    /// The train without scenarios, to check these, and what is wrong with it; `None` where vehicles and couplers do
    /// not fit together. It must not be computed while something is wrong with it.
    pub(crate) fn examine(self) -> (Option<Train>, Vec<SpecProblem>) {
        let mut problems = checks::structure(&self);
        let fits = problems.is_empty();
        problems.extend(checks::numbers(&self));
        let sound = fits && problems.is_empty();
        problems.extend(checks::held(&self.vehicles));
        if !fits {
            return (None, problems);
        }
        let pulled_to = self.pulled_to.clone();
        let train = self.derived(sound);
        if sound {
            problems.extend(checks::combinations(&train, &pulled_to));
        }
        (Some(train), problems)
    }

    /// What follows from the spec; if it is not sound, without what needs valid numbers.
    fn derived(self, sound: bool) -> Train {
        let brakes: Vec<f64> =
            self.vehicles.iter().flat_map(|v| std::iter::repeat_n(v.emergency_brake_n, v.count)).collect();
        let (vehicles, renumbered) = numbered(&self.vehicles);
        let mut couplers: Vec<Coupler> = self.couplers.iter().map(CouplerSpec::as_linear).collect();
        let (initial_force_n, steady) = self.load.forces(&vehicles, &couplers, sound);
        let specs = self.couplers;
        let limited = specs.iter().any(|c| c.limits != Limits::default());
        let damped = specs.iter().any(|c| c.dashpot_n_s_per_m > 0.0);
        let limits = specs.iter().filter(|_| limited).map(|c| c.limits).collect();
        let dashpot_n_s_per_m = specs.iter().filter(|_| damped).map(|c| c.dashpot_n_s_per_m).collect();
        let linear = specs.iter().all(|c| c.law.is_linear());
        let laws: Vec<Law> = if linear { vec![] } else { specs.into_iter().map(|c| c.law).collect() };
        if sound {
            let largest_n = initial_force_n.iter().copied().map(f64::abs).fold(0.0, f64::max);
            for (coupler, law) in couplers.iter_mut().zip(&laws) {
                coupler.stiffness_n_per_m = secant_n_per_m(law, largest_n);
            }
        }
        let pulled_to_n = self.pulled_to.in_couplers(&initial_force_n, steady.is_some());
        let extras = Extras {
            steady,
            dashpot_n_s_per_m,
            damping_ratio: self.damping_ratio,
            limits,
            laws,
            pulled_to_n,
            emergency_brake_n: if brakes.iter().any(|n| *n > 0.0) { brakes } else { vec![] },
            speed_m_per_s: self.speed_m_per_s,
        };
        let (name, scenarios, mut origin) = (self.name, vec![], self.origin);
        origin.doubts.extend(renumbered);
        Train { name, vehicles, couplers, initial_force_n, scenarios, extras, origin }
    }
}

impl CouplerSpec {
    /// Its ratings, with the stiffness in draft; 1 N/m in the place of a gear's.
    fn as_linear(&self) -> Coupler {
        let stiffness_n_per_m = match self.law {
            Law::Elastic { draft_n_per_m, .. } => draft_n_per_m,
            Law::Gear { .. } => 1.0,
        };
        Coupler { stiffness_n_per_m, rated_draft_n: self.rated_draft_n, rated_buff_n: self.rated_buff_n }
    }
}

impl Load {
    /// The couplers' forces, N, and what they come from unless they are given themselves.
    fn forces(self, vehicles: &[Vehicle], couplers: &[Coupler], sound: bool) -> (Vec<f64>, Option<Steady>) {
        match self {
            Load::None => (vec![0.0; couplers.len()], None),
            Load::Uniform(n) => (vec![n; couplers.len()], None),
            Load::InCouplers(forces) => (forces, None),
            Load::OnVehicles(outside_n) => {
                let (forces, error_n, acceleration_m_per_s2) = match sound {
                    true => steady_forces(vehicles, couplers, &outside_n),
                    false => (vec![0.0; couplers.len()], vec![0.0; couplers.len()], 0.0),
                };
                (forces, Some(Steady { outside_n, error_n, acceleration_m_per_s2 }))
            }
        }
    }
}

impl PulledTo {
    fn in_couplers(self, load_n: &[f64], in_proportion: bool) -> Vec<f64> {
        match self {
            PulledTo::None => vec![],
            PulledTo::InCouplers(pulled_n) => pulled_n,
            PulledTo::Largest(pulled_n) if in_proportion => {
                let factor = pulled_n / load_n.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                load_n.iter().map(|f| f.max(0.0) * factor).collect()
            }
            PulledTo::Largest(pulled_n) => vec![pulled_n; load_n.len()],
        }
    }
}

/// Stiffness that stands for a coupler's law where one number is asked for, N/m: the secant of loading up to a force in draft, without
/// the slack; up to the last row of its table where the force is 0.
fn secant_n_per_m(law: &Law, force_n: f64) -> f64 {
    match law {
        Law::Elastic { draft_n_per_m, .. } => *draft_n_per_m,
        Law::Gear { draft, slack_m, .. } => {
            let last_n = draft.rows().last().map_or(1.0, |row: &GearRow| row.loading_n);
            // Near a preload the secant is that of the parts in series only.
            let preload_n = draft.rows().first().map_or(0.0, |row| row.loading_n);
            let force_n = if force_n > 0.0 { force_n.max(2.0 * preload_n) } else { last_n };
            force_n / (law.elongation_m(&law.rest(&[force_n])) - 0.5 * slack_m)
        }
    }
}
