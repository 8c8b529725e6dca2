//! What has been seen so far of every spring's force: its extremes, and its first exceedance in either sign.
//!
//! Every method passes pieces of the forces to the watch, as polynomials in time. The watch gives the level that a piece has to reach
//! for its extremes to matter, so that the other pieces need not be passed.

use super::dd::Dd;
use super::local::{Local, Point};
use crate::chain::Scene;

/// Differences in force under this share of the error bound are not resolved.
const GRAIN: f64 = 0.125;
/// How far a piece that is passed may be from the force, as a share of the same bound.
const FINENESS: f64 = 0.1;
/// A push from the rating, in bounds, that counts: ahead of the front rounding is far smaller than the bound.
const PUSH: f64 = 1e-8;

/// Bound on the error of an extreme that is found among forces which are themselves within `bound` of the truth: one that is
/// larger than the best by less than the grain is not taken.
pub fn searched(bound: f64) -> f64 {
    (1.0 + GRAIN) * bound
}

/// What the forces that are shown are within, where pieces leave out motion of up to the fineness (modes too fast for them) and
/// `bound` is that of the values at single instants.
///
/// With s the fineness: a piece is within `bound + s` of the truth. Where its largest value is, the force is at most s less, and
/// nowhere is it more than s over it: a value there is at most `2 s` under the largest one. `bound + 2 s` covers both, and
/// s is a tenth of that sum.
pub fn hazy(bound: f64) -> f64 {
    bound / (1.0 - 2.0 * FINENESS)
}

/// One sign of one spring's force: of F (draft), or of -F (buff).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Side {
    /// Largest value and its time; at t = 0 if nothing later is larger by more than an eighth of the error bound.
    pub best: Point,
    /// The first time over the rating, if the force is ever certainly (by more than the error bound) over it: of the first rise
    /// that is certain, be there earlier ones within the error bound or not.
    pub first_over: Option<f64>,
    /// The true force may be over the rating: it comes within the error bound of it, or stood there and was pushed on.
    pub near: bool,
    departed: bool,
}

impl Side {
    /// Before the event. A force that stands at its rating and is first pushed on may exceed it by as little as one likes.
    fn at_rest(value: f64, rating: f64, bound: f64, pushed_on: bool) -> Side {
        let first_over = (value > rating).then_some(0.0);
        let departed = value < rating - 4.0 * bound;
        let near = pushed_on && bound > 0.0 && value > rating - bound;
        Side { best: Point { at: 0.0, value }, first_over, near, departed }
    }

    /// Of a force that did not stand at its rating before the event.
    pub fn known(best: Point, first_over: Option<f64>, near: bool) -> Side {
        Side { best, first_over, near, departed: true }
    }

    /// Over its rating, not over it, or not decided (`None`): the rating lies within the error bound of the peak.
    ///
    /// The force before the event is known exactly, so a coupler that stands just at its rating and is relieved, until it comes
    /// back if ever, does not exceed it.
    pub fn exceeds(&self) -> Option<bool> {
        match (self.first_over, self.near) {
            (Some(_), _) => Some(true),
            (None, true) => None,
            (None, false) => Some(false),
        }
    }
}

/// Extremes of one spring's force over 0 <= t <= horizon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringPeaks {
    /// Of F.
    pub draft: Side,
    /// Of -F.
    pub buff: Side,
}

impl SpringPeaks {
    /// One side: of -F if `negative`.
    #[inline]
    pub fn side(&self, negative: bool) -> &Side {
        if negative { &self.buff } else { &self.draft }
    }
}

impl SpringPeaks {
    /// Times in other units.
    pub fn scale_time(&mut self, unit: f64) {
        for side in [&mut self.draft, &mut self.buff] {
            side.best.at *= unit;
            side.first_over = side.first_over.map(|t| t * unit);
        }
    }
}

/// The springs of a scene under watch.
#[derive(Clone, Debug)]
pub struct Watch {
    /// What has been seen.
    pub peaks: Vec<SpringPeaks>,
    ratings: Vec<[f64; 2]>,
    horizon: f64,
    /// No force shown is further than this from the truth.
    bound: f64,
    grain: f64,
}

impl Watch {
    /// Before the event, with the error bound of the forces to come.
    pub fn new(scene: &Scene, bound: f64) -> Watch {
        let ratings: Vec<[f64; 2]> =
            (0..scene.initial.len()).map(|i| [scene.rated_draft[i], scene.rated_buff[i]]).collect();
        // A forward force pushes what is before it together and pulls at what is behind it, before anything comes back. Without a
        // force nothing is known of the first push: who shows the forces minds it ([`Watch::mind_push`]).
        let pushes =
            |i: usize, negative: bool| scene.force != 0.0 && ((i >= scene.source) == (scene.force > 0.0)) != negative;
        let at_rest = |(i, r): (usize, &[f64; 2])| SpringPeaks {
            draft: Side::at_rest(scene.initial[i], r[0], bound, pushes(i, false)),
            buff: Side::at_rest(-scene.initial[i], r[1], bound, pushes(i, true)),
        };
        let peaks = ratings.iter().enumerate().map(at_rest).collect();
        Watch { peaks, ratings, horizon: scene.horizon, bound, grain: GRAIN * bound }
    }

    /// What has been seen so far, to be watched up to an earlier instant than the horizon.
    pub fn until(&self, mark: f64) -> Watch {
        Watch { horizon: mark, ..self.clone() }
    }

    /// Nothing later counts.
    #[inline]
    pub fn horizon(&self) -> f64 {
        self.horizon
    }

    /// Every side of every spring.
    pub fn sides(&self) -> impl Iterator<Item = (usize, bool)> + use<> {
        (0..self.peaks.len()).flat_map(|s| [(s, false), (s, true)])
    }

    /// The rating in one sign.
    #[inline]
    pub fn rating(&self, spring: usize, negative: bool) -> f64 {
        self.ratings[spring][usize::from(negative)]
    }

    /// No force shown is further than this from the truth.
    #[inline]
    pub fn bound(&self) -> f64 {
        self.bound
    }

    /// Whether a side stood at its rating before the event, as near as can be told, and has not left it.
    #[inline]
    pub fn at_rating(&self, spring: usize, negative: bool) -> bool {
        !self.peaks[spring].side(negative).departed
    }

    /// Whether a value is so far under the rating that a force which takes it has left it.
    #[inline]
    pub fn is_low(&self, spring: usize, negative: bool, value: f64) -> bool {
        value < self.rating(spring, negative) - 4.0 * self.bound
    }

    /// Takes note of one value of a force, at time t.
    pub fn take(&mut self, spring: usize, negative: bool, t: f64, value: f64) {
        let (over, cautious) = (self.certainly_over(spring, negative, value), self.cautious_rating(spring, negative));
        let side = self.side_mut(spring, negative);
        if over && side.first_over.is_none() {
            side.first_over = Some(t);
        }
        if value > side.best.value {
            side.best = Point { at: t, value };
            side.near |= value > cautious;
        }
    }

    /// Notes a force that is certainly under the rating; returns whether it is.
    pub fn departs(&mut self, spring: usize, negative: bool, value: f64) -> bool {
        let departed = self.is_low(spring, negative, value);
        if departed {
            self.side_mut(spring, negative).departed = true;
        }
        departed
    }

    /// At the end: a side that stood at its rating, and the lowest it was seen at. If it was never certainly
    /// below, it is not decided whether it passed the rating.
    pub fn settle(&mut self, spring: usize, negative: bool, lowest: f64) {
        let undecided = self.bound > 0.0 && !self.departs(spring, negative, lowest);
        let largest = self.peaks[spring].side(negative).best.value + self.grain();
        let near = largest > self.cautious_rating(spring, negative);
        self.side_mut(spring, negative).near |= undecided && near;
    }

    /// A side that stood at its rating and is pushed on by `push` to a value before it has left it: it may pass the rating by less
    /// than can be told, if the value comes within the bound of it.
    pub fn mind_push(&mut self, spring: usize, negative: bool, push: f64, value: f64) {
        if push > PUSH * self.bound {
            self.leave_open(spring, negative, value);
        }
    }

    /// At the end, where every instant at which a side was certainly under its rating has been noted ([`Watch::departs`]).
    pub fn settle_all(&mut self) {
        for (spring, negative) in self.sides() {
            if self.at_rating(spring, negative) {
                self.settle(spring, negative, self.rating(spring, negative));
            }
        }
    }

    /// What could not be looked into leaves it open whether a side passes its rating.
    pub fn leave_open(&mut self, spring: usize, negative: bool, upper: f64) {
        let near = upper > self.cautious_rating(spring, negative);
        self.side_mut(spring, negative).near |= near;
    }

    /// A side that has certainly passed its rating by a time, be the first such instant known or not.
    pub fn mark_over(&mut self, spring: usize, negative: bool, until: f64) {
        let until = until.min(self.horizon);
        self.side_mut(spring, negative).first_over.get_or_insert(until);
    }

    fn side_mut(&mut self, spring: usize, negative: bool) -> &mut Side {
        let peaks = &mut self.peaks[spring];
        if negative { &mut peaks.buff } else { &mut peaks.draft }
    }

    /// Below this a force is certainly not over the rating.
    #[inline]
    pub fn cautious_rating(&self, spring: usize, negative: bool) -> f64 {
        self.rating(spring, negative) - self.bound
    }

    /// Whether a computed value is over the rating whatever its error.
    #[inline]
    pub fn certainly_over(&self, spring: usize, negative: bool, value: f64) -> bool {
        value > self.rating(spring, negative) + self.bound
    }

    /// How far a piece that is passed may be from the force without changing a verdict.
    #[inline]
    pub fn fineness(&self) -> f64 {
        FINENESS * self.bound
    }

    /// A difference in force that is not worth more work: an eighth of the bound, unless [`Watch::ease`] said otherwise.
    #[inline]
    pub fn grain(&self) -> f64 {
        self.grain
    }

    /// From here on a difference of `grain` is not worth more work. Verdicts do not depend on it.
    pub fn ease(&mut self, grain: f64) {
        self.grain = self.grain.max(grain);
    }

    /// A piece of this force matters only if it can pass this level.
    #[inline]
    pub fn level(&self, spring: usize, negative: bool) -> f64 {
        let side = self.peaks[spring].side(negative);
        let rating = self.rating(spring, negative);
        let best = side.best.value + self.grain();
        if side.first_over.is_some() {
            best
        } else if side.near || !side.departed {
            best.min(rating + self.bound)
        } else {
            best.min(rating - self.bound)
        }
    }

    /// Takes note of a force over -1 <= x <= `end`, whose polynomial is right to well within the bound.
    /// `exact` gives the force at one instant, a sum of two numbers, as well as the method can.
    pub fn note(&mut self, spring: usize, negative: bool, local: &Local, end: f64, exact: impl Fn(Dd) -> f64) {
        let level = self.level(spring, negative);
        let over = self.see(spring, negative, local, [end, level], exact);
        if over && self.peaks[spring].side(negative).first_over.is_none() {
            self.note_crossing(spring, negative, local);
        }
    }

    /// The same where pieces do not come in the order of time: nothing is said of the first exceedance.
    pub fn note_peak(&mut self, spring: usize, negative: bool, local: &Local, end: f64, exact: impl Fn(Dd) -> f64) {
        let level = self.peaks[spring].side(negative).best.value.min(self.cautious_rating(spring, negative));
        self.see(spring, negative, local, [end, level], exact);
    }

    /// Takes note of where the force passes its rating, if no earlier instant is known and it certainly does so here.
    pub fn note_crossing(&mut self, spring: usize, negative: bool, local: &Local) -> bool {
        let turned;
        let local = if negative {
            turned = local.negated();
            &turned
        } else {
            local
        };
        let (rating, horizon) = (self.rating(spring, negative), self.horizon);
        let over = local.largest(-1.0, 1.0, rating + self.bound).is_some();
        let side = self.side_mut(spring, negative);
        if over && side.first_over.is_none() {
            side.first_over = local.first_over(-1.0, 1.0, rating).map(|x| local.time(x).min(horizon));
        }
        over
    }

    /// Takes note of the largest value of a piece, if it passes the level; whether it is certainly over the rating.
    fn see(
        &mut self,
        spring: usize,
        negative: bool,
        local: &Local,
        [end, level]: [f64; 2],
        exact: impl Fn(Dd) -> f64,
    ) -> bool {
        let turned;
        let (local, sign) = if negative {
            turned = local.negated();
            (&turned, -1.0)
        } else {
            (local, 1.0)
        };
        let (rating, bound, grain, horizon) = (self.rating(spring, negative), self.bound, self.grain(), self.horizon);
        let side = self.side_mut(spring, negative);
        let was_departed = side.departed;
        side.departed |= local.value_and_slope(end).0 < rating - 4.0 * bound;
        let Some(top) = local.largest(-1.0, end, level) else { return false };
        // A piece that ends at the horizon ends there to the last bit, whatever its own times round to. Anywhere else the force is
        // taken at the instant itself, which for fast modes is not that of the nearest number.
        let at = Dd::from(local.center) + Dd::product(local.radius, top.at);
        let ends = top.at >= end && at.hi > horizon * (1.0 - 8.0 * f64::EPSILON);
        let at = if ends || at > Dd::from(horizon) { Dd::from(horizon) } else { at };
        let (t, value) = (at.hi.max(0.0), sign * exact(at));
        // However small the step past a limit of the verdict, it counts.
        let passes = |limit: f64| value > limit && side.best.value <= limit;
        if value > side.best.value + grain || passes(rating - bound) || passes(rating + bound) {
            side.best = Point { at: t, value };
            side.near |= value > rating - bound;
        }
        side.near |= was_departed && value > rating - bound;
        value > rating + bound
    }
}
