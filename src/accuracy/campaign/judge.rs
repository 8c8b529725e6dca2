//! One method's extremes held against the reference.

use super::super::reference::{Extreme, Reference, ReferenceError};
use crate::chain::Scene;
use crate::solve::local::Point;
use crate::solve::watch::{Side, SpringPeaks};

/// Springs of a scene whose times are checked too: each costs several evaluations in long arithmetic.
const TIMED: usize = 3;

/// What the reference says of one method's results on one scene.
#[derive(Clone, Debug, Default)]
pub struct Verdict {
    /// Largest error of any reported extreme.
    pub error: f64,
    /// Couplers' sides left undecided.
    pub undecided: usize,
    /// Of those, sides whose peak is further from the rating than twice the bound.
    pub needless: usize,
    /// What is against the truth, in words: spring, sign, and what was claimed.
    pub wrong: Vec<String>,
}

/// Judges the extremes that a method found, with the bound that it states.
///
/// # Errors
/// [`ReferenceError::TooLong`] where the truth about a first exceedance could not be found.
pub fn judge(
    scene: &Scene,
    reference: &Reference,
    extremes: &[[Extreme; 2]],
    peaks: &[SpringPeaks],
    bound: f64,
) -> Result<Verdict, ReferenceError> {
    let mut verdict = Verdict::default();
    let every = (peaks.len() / TIMED).max(1);
    for (spring, (truth, claim)) in extremes.iter().zip(peaks).enumerate() {
        for negative in [false, true] {
            let judged = Judged {
                reference,
                spring,
                negative,
                side: claim.side(negative),
                truth: &truth[usize::from(negative)],
                rating: if negative { scene.rated_buff[spring] } else { scene.rated_draft[spring] },
                bound,
            };
            judged.extreme(&mut verdict);
            judged.decision(&mut verdict);
            if spring % every == 0 {
                judged.times(&mut verdict)?;
            }
        }
    }
    Ok(verdict)
}

/// One sign of one spring.
struct Judged<'a> {
    reference: &'a Reference,
    spring: usize,
    negative: bool,
    side: &'a Side,
    truth: &'a Extreme,
    rating: f64,
    bound: f64,
}

impl Judged<'_> {
    fn sign(&self) -> f64 {
        if self.negative { -1.0 } else { 1.0 }
    }

    fn blame(&self, verdict: &mut Verdict, what: String) {
        verdict.wrong.push(format!("spring {} {}: {what}", self.spring, if self.negative { "buff" } else { "draft" }));
    }

    fn extreme(&self, verdict: &mut Verdict) {
        let error = (self.truth.error_of(self.side.best.value) - self.truth.doubt).max(0.0);
        verdict.error = verdict.error.max(error);
        if error > self.bound {
            let Point { at, value } = self.side.best;
            let truth = self.truth.value.to_f64().value();
            self.blame(verdict, format!("peak {value:e} at {at}, truth {truth:e} at {}, error {error:e}", self.truth.at));
        }
    }

    /// "Exceeds" and "does not" must be true; "not decided" must have a reason.
    fn decision(&self, verdict: &mut Verdict) {
        let from_rating = self.truth.error_of(self.rating);
        let over = self.truth.is_over(self.rating);
        match self.side.exceeds() {
            Some(claimed) if claimed != over && from_rating > self.truth.doubt => {
                self.blame(verdict, format!("exceeds = {claimed}, peak - rating = {}{from_rating:e}", if over { "" } else { "-" }));
            }
            Some(_) => {}
            None => {
                verdict.undecided += 1;
                verdict.needless += usize::from(from_rating > 2.0 * self.bound + self.truth.doubt);
            }
        }
    }

    /// The force at the reported times is the reported one, and no exceedance came before the first.
    fn times(&self, verdict: &mut Verdict) -> Result<(), ReferenceError> {
        let best = self.side.best;
        let off = self.off(best.at, best.value);
        if off > 0.0 {
            self.blame(verdict, format!("force at the peak's time {} is off by {off:e} more than it may", best.at));
        }
        let Some(first) = self.side.first_over.filter(|&t| t > 0.0) else { return Ok(()) };
        let off = self.off(first, self.rating);
        if off > 0.0 {
            self.blame(verdict, format!("force at the first exceedance {first} is off by {off:e} more than it may"));
        }
        let before = first * (1.0 - 8.0 * f64::EPSILON);
        let earlier = self.reference.largest_until(self.spring, self.negative, before)?;
        let over = earlier.value.to_f64().value() - self.rating;
        if over > 2.0 * self.bound {
            self.blame(verdict, format!("exceeds by {over:e} at {}, before the first exceedance {first}", earlier.at));
        }
        Ok(())
    }

    /// By how much the force at `t` differs from `claimed`, beyond the bound and what rounding the time explains.
    fn off(&self, t: f64, claimed: f64) -> f64 {
        let [_, rate] = self.reference.force_and_rate(self.spring, t);
        let explained = self.bound + 4.0 * f64::EPSILON * t * rate.abs();
        self.reference.error_of(self.spring, t, self.sign() * claimed) - explained
    }
}
