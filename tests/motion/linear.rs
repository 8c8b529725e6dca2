//! Linear chains for the march: what its tests have in common.

use trainsafe::chain::Chain;
use trainsafe::law::Law;
use trainsafe::march::{Bound, MarchOptions, MarchOutcome, Parting, Problem, follow, solve};
use trainsafe::train::Rule;

/// A chain whose parted couplers carry nothing, and the ratings of its couplers in draft and in buff.
#[derive(Clone)]
pub struct Linear {
    pub problem: Problem,
    pub rated: Vec<[f64; 2]>,
}

impl Linear {
    /// In the steady state with these forces.
    pub fn new(chain: &Chain, initial: &[f64], rated: Vec<[f64; 2]>, horizon: f64) -> Linear {
        let law = |k: &f64| Law::Elastic { draft_n_per_m: *k, buff_n_per_m: *k, slack_m: 0.0 };
        let laws: Vec<Law> = chain.stiffness.iter().map(law).collect();
        let mut problem = Problem::at_rest(chain.mass.clone(), laws, horizon);
        (problem.held_head, problem.held_tail, problem.contact) = (chain.held_head, chain.held_tail, false);
        let mut linear = Linear { problem, rated };
        linear.load(initial);
        linear
    }

    /// Puts the chain into the steady state with these forces.
    pub fn load(&mut self, initial: &[f64]) {
        let problem = &mut self.problem;
        problem.start = problem.laws.iter().zip(initial).map(|(law, force)| law.rest(&[*force])).collect();
        let force = |i: usize| initial.get(i).copied().unwrap_or(0.0);
        problem.steady_n = (0..=initial.len()).map(|v| force(v) - if v > 0 { force(v - 1) } else { 0.0 }).collect();
    }

    pub fn stiffness(&self, i: usize) -> f64 {
        let Law::Elastic { draft_n_per_m, .. } = self.problem.laws[i] else { panic!("linear") };
        draft_n_per_m
    }

    pub fn inverse_mass(&self, v: usize) -> f64 {
        let p = &self.problem;
        let held = v == 0 && p.held_head || v + 1 == p.mass_kg.len() && p.held_tail;
        if held { 0.0 } else { 1.0 / p.mass_kg[v] }
    }

    /// Couplers break at their ratings.
    pub fn breaking(&self, rule: Rule) -> Linear {
        let limit = |r: &[f64; 2]| [r[0], if rule == Rule::InBoth { r[1] } else { f64::INFINITY }];
        let break_at_n = if rule == Rule::Keep { vec![] } else { self.rated.iter().map(limit).collect() };
        Linear { problem: Problem { break_at_n, ..self.problem.clone() }, rated: self.rated.clone() }
    }

    pub fn run(&self) -> MarchOutcome {
        let capacity_n = self.rated.clone();
        solve(&self.problem, &MarchOptions { capacity_n, tolerance_n: Some(1.0), ..MarchOptions::default() })
    }

    /// The force of a coupler at instants.
    pub fn history(&self, coupler: usize, times: &[f64]) -> Vec<f64> {
        let ask = MarchOptions { history: vec![coupler], times_s: times.to_vec(), ..MarchOptions::default() };
        let mut forces = vec![f64::NAN; times.len()];
        follow(&self.problem, &ask, &mut |n, _, force| forces[n] = force);
        forces
    }
}

/// The proven bound.
#[track_caller]
pub fn bound(out: &MarchOutcome) -> f64 {
    let Bound::Proven(bound) = out.bound else { panic!("{:?}", out.bound) };
    bound
}

/// The largest F and the largest -F of a coupler, and when.
pub fn sides(out: &MarchOutcome, coupler: usize) -> [(f64, f64); 2] {
    let e = &out.extremes[coupler];
    [(e.draft.force_n, e.draft.time_s), (-e.buff.force_n, e.buff.time_s)]
}

/// What breaks after the event, by instants.
pub fn breakages(out: &MarchOutcome, gone: usize) -> Vec<Vec<Parting>> {
    out.partings[gone..].chunk_by(|a, b| a.time_s == b.time_s).map(<[_]>::to_vec).collect()
}
