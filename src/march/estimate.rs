//! One run, or three that tell the error.

use super::step::{Manner, March};
use super::{Ask, Bound, Outcome, Problem};

/// The phase of a step of the run that counts.
const PHASE: f64 = 1.0;

/// Follows the motion of a train.
pub fn solve(problem: &Problem, ask: &Ask) -> Outcome {
    let mut march = March::new(problem, ask, Manner { phase: PHASE, noise: None });
    march.advance_to(problem.mark_s.min(problem.horizon_s));
    march.record.to_mark = Some(march.record.extremes.clone());
    march.advance_to(problem.horizon_s);
    finish(march, Bound::None, None)
}

fn finish(mut march: March, bound: Bound, predictable_until_s: Option<f64>) -> Outcome {
    march.record.finish();
    let record = march.record;
    Outcome {
        extremes: record.extremes,
        to_mark: record.to_mark.unwrap_or_default(),
        first_over_s: record.first_over_s,
        bound,
        partings: march.partings,
        closures: march.closures,
        stopped: march.stopped,
        predictable_until_s,
        history: record.history,
        energy: march.audit.map(|a| a.energy),
        events: march.events,
        steps: march.steps,
    }
}
