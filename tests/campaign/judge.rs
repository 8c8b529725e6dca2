//! One method's extremes held against the reference.

use trainsafe::accuracy::reference::{Extreme, Reference, ReferenceError};
use trainsafe::chain::Scene;
use trainsafe::solve::local::Point;
use trainsafe::solve::watch::{Side, SpringPeaks};

/// Springs of a scene whose times are checked too: each costs several evaluations in long arithmetic.
const TIMED: usize = 3;

/// A way in which a result can be against the truth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fault {
    /// An extreme further from the exact one than the bound.
    Peak,
    /// "Exceeds" or "does not exceed", and it is not so.
    Verdict,
    /// The same for a coupler that stands at its rating before the event.
    VerdictAtRest,
    /// A peak's or first exceedance's time at which the force is another one.
    Time,
    /// An exceedance by more than twice the bound before the first one.
    Earlier,
    /// A row of a fleet that says something else.
    Row,
}

impl Fault {
    /// All of them.
    pub const ALL: [Fault; 6] =
        [Fault::Peak, Fault::Verdict, Fault::VerdictAtRest, Fault::Time, Fault::Earlier, Fault::Row];

    /// In a word, for a table's head.
    pub fn name(self) -> &'static str {
        match self {
            Fault::Peak => "peak",
            Fault::Verdict => "verdict",
            Fault::VerdictAtRest => "at rest",
            Fault::Time => "time",
            Fault::Earlier => "earlier",
            Fault::Row => "row",
        }
    }
}

/// What the reference says of one method's results on one scene.
#[derive(Clone, Debug, Default)]
pub struct Verdict {
    /// Largest error of any reported extreme.
    pub error: f64,
    /// Couplers' sides left undecided.
    pub undecided: usize,
    /// Of those, sides whose peak is further from the rating than twice the bound.
    pub needless: usize,
    /// What is against the truth: spring, sign, and what was claimed.
    pub wrong: Vec<(Fault, String)>,
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
            let rating = if negative { scene.rated_buff[spring] } else { scene.rated_draft[spring] };
            let initial = scene.initial[spring];
            let judged = Judged {
                reference,
                spring,
                negative,
                side: claim.side(negative),
                truth: &truth[usize::from(negative)],
                rating,
                at_rest: (if negative { -initial } else { initial } - rating).abs() <= bound,
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
    /// Before the event the force is within the bound of the rating.
    at_rest: bool,
    bound: f64,
}

impl Judged<'_> {
    fn sign(&self) -> f64 {
        if self.negative { -1.0 } else { 1.0 }
    }

    fn blame(&self, verdict: &mut Verdict, fault: Fault, what: String) {
        let what = format!("spring {} {}: {what}", self.spring, if self.negative { "buff" } else { "draft" });
        verdict.wrong.push((fault, what));
    }

    fn extreme(&self, verdict: &mut Verdict) {
        let error = (self.truth.error_of(self.side.best.value) - self.truth.doubt).max(0.0);
        verdict.error = verdict.error.max(error);
        if error > self.bound {
            let Point { at, value } = self.side.best;
            let truth = self.truth.value.to_f64().value();
            self.blame(
                verdict,
                Fault::Peak,
                format!("peak {value:e} at {at}, truth {truth:e} at {}, error {error:e}", self.truth.at),
            );
        }
    }

    /// "Exceeds" and "does not" must be true; "not decided" must have a reason.
    fn decision(&self, verdict: &mut Verdict) {
        let from_rating = self.truth.error_of(self.rating);
        let over = self.truth.is_over(self.rating);
        match self.side.exceeds() {
            Some(claimed) if claimed != over && from_rating > self.truth.doubt => {
                let fault = if self.at_rest { Fault::VerdictAtRest } else { Fault::Verdict };
                self.blame(
                    verdict,
                    fault,
                    format!("exceeds = {claimed}, peak - rating = {}{from_rating:e}", if over { "" } else { "-" }),
                );
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
        let off = self.off(best.at, best.value, self.bound);
        if off > 0.0 {
            self.blame(
                verdict,
                Fault::Time,
                format!("force at the peak's time {} is off by {off:e} more than it may", best.at),
            );
        }
        let Some(first) = self.side.first_over.filter(|&t| t > 0.0) else { return Ok(()) };
        // An exceedance counts once the computed force is over the rating by the bound, and that force is right to the bound.
        let off = self.off(first, self.rating, 2.0 * self.bound);
        if off > 0.0 {
            self.blame(
                verdict,
                Fault::Time,
                format!("force at the first exceedance {first} is off by {off:e} more than it may"),
            );
        }
        let before = first * (1.0 - 8.0 * f64::EPSILON);
        let earlier = self.reference.largest_until(self.spring, self.negative, before)?;
        let over = earlier.value.to_f64().value() - self.rating;
        if over > 2.0 * self.bound {
            self.blame(
                verdict,
                Fault::Earlier,
                format!("exceeds by {over:e} at {}, before the first exceedance {first}", earlier.at),
            );
        }
        Ok(())
    }

    /// By how much the force at `t` differs from `claimed`, beyond `bound` and what rounding the time explains.
    fn off(&self, t: f64, claimed: f64, bound: f64) -> f64 {
        let [_, rate] = self.reference.force_and_rate(self.spring, t);
        let explained = bound + 4.0 * f64::EPSILON * t * rate.abs();
        self.reference.error_of(self.spring, t, self.sign() * claimed) - explained
    }
}
