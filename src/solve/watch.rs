//! A record of every spring's force as far as computed: its extremes, and when it first exceeds its rating, in draft and in buff.
//!
//! Every method passes pieces of the forces to the watch, as polynomials in time. The watch gives the level that a piece has to reach
//! for its extremes to matter, so that the other pieces need not be passed.

use super::dd::Dd;
use super::local::{Local, Point};
use crate::chain::Scene;

/// Differences in force under this share of the error bound are not resolved.
const MIN_RISE: f64 = 0.125;
/// How far a piece that is passed may be from the force, as a share of the same bound.
const PIECE_TOLERANCE: f64 = 0.1;
/// Least rise of a force above the rating at which it stood that counts, as a share of the error bound: rounding ahead of the wave
/// front is far smaller.
pub(crate) const PUSH: f64 = 1e-8;

/// Bound on the error of an extreme of forces that are within `bound` of the truth: a value that is larger than the
/// best by less than `MIN_RISE` of the bound is not taken.
pub(crate) fn bound_of_extremes(bound: f64) -> f64 {
    (1.0 + MIN_RISE) * bound
}

/// Error bound of a watch whose pieces omit modes that are too fast for them; `bound` is that of values at single
/// instants.
///
/// With s the most that a piece omits: it is within `bound + s` of the truth. Where its largest value is, the force is
/// at most s less, and nowhere is it more than s over it: a value there is at most `2 s` under the largest one.
/// `bound + 2 s` covers both, and s is a tenth of that sum.
pub(crate) fn bound_of_pieces(bound: f64) -> f64 {
    bound / (1.0 - 2.0 * PIECE_TOLERANCE)
}

/// One sign of one spring's force: of F (draft), or of -F (buff).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Side {
    /// Largest value and its time; at t = 0 if nothing later is larger by more than an eighth of the error bound.
    pub best: Point,
    /// The first time over the rating, if the force is ever over it by more than the error bound: that of the first
    /// such rise, even if earlier ones are within the error bound.
    pub first_over: Option<f64>,
    /// The true force may be over the rating: it comes within the error bound of it, or stood there and was pushed
    /// further.
    pub near: bool,
    left_rating: bool,
}

impl Side {
    /// Before the event. A force that stands at its rating and is pushed further may exceed it by any small amount.
    fn at_rest(value: f64, rating: f64, bound: f64, pushed_on: bool) -> Side {
        let first_over = (value > rating).then_some(0.0);
        let left_rating = value < rating - 4.0 * bound;
        let near = pushed_on && bound > 0.0 && value > rating - bound;
        Side { best: Point { at: 0.0, value }, first_over, near, left_rating }
    }

    /// Of a force that did not stand at its rating before the event.
    pub fn known(best: Point, first_over: Option<f64>, near: bool) -> Side {
        Side { best, first_over, near, left_rating: true }
    }

    /// Over its rating, not over it, or not decided (`None`): the rating lies within the error bound of the peak.
    ///
    /// The force before the event is known exactly, so a coupler that stands just at its rating and is relieved does
    /// not exceed it, unless its force returns.
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
    pub(crate) fn scale_time(&mut self, unit: f64) {
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
    min_rise: f64,
}

impl Watch {
    /// Before the event, with the error bound of the forces to come.
    pub fn new(scene: &Scene, bound: f64) -> Watch {
        let ratings = (0..scene.initial.len()).map(|i| [scene.rated_draft[i], scene.rated_buff[i]]).collect();
        // A forward force first pushes what is before it together and pulls at what is behind it.
        let pushes =
            |i: usize, negative: bool| scene.force != 0.0 && ((i >= scene.source) == (scene.force > 0.0)) != negative;
        Watch::with_pushes(&scene.initial, ratings, scene.horizon, bound, pushes)
    }

    /// The same from forces and ratings alone: which way a spring is first pushed is not known, and the caller notes it
    /// ([`Watch::note_push`]).
    pub(crate) fn of_forces(initial: &[f64], ratings: Vec<[f64; 2]>, horizon: f64, bound: f64) -> Watch {
        Watch::with_pushes(initial, ratings, horizon, bound, |_, _| false)
    }

    fn with_pushes(
        initial: &[f64],
        ratings: Vec<[f64; 2]>,
        horizon: f64,
        bound: f64,
        pushes: impl Fn(usize, bool) -> bool,
    ) -> Watch {
        let at_rest = |(i, r): (usize, &[f64; 2])| SpringPeaks {
            draft: Side::at_rest(initial[i], r[0], bound, pushes(i, false)),
            buff: Side::at_rest(-initial[i], r[1], bound, pushes(i, true)),
        };
        let peaks = ratings.iter().enumerate().map(at_rest).collect();
        Watch { peaks, ratings, horizon, bound, min_rise: MIN_RISE * bound }
    }

    /// A copy that ends at another instant, earlier or later.
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

    /// Whether a side stood at its rating before the event, within the bound, and has not left it.
    #[inline]
    pub(crate) fn at_rating(&self, spring: usize, negative: bool) -> bool {
        !self.peaks[spring].side(negative).left_rating
    }

    /// Whether a value is so far under the rating that its force has left the rating.
    #[inline]
    pub(crate) fn is_well_below_rating(&self, spring: usize, negative: bool, value: f64) -> bool {
        value < self.rating(spring, negative) - 4.0 * self.bound
    }

    /// Takes note of one value of a force, at time t.
    pub(crate) fn note_value(&mut self, spring: usize, negative: bool, t: f64, value: f64) {
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

    /// Takes note of a value that a force certainly reaches; the first time over its rating is noted elsewhere.
    pub(crate) fn note_reached(&mut self, spring: usize, negative: bool, reached: Point) {
        let cautious = self.cautious_rating(spring, negative);
        let side = self.side_mut(spring, negative);
        if reached.value > side.best.value {
            side.best = reached;
            side.near |= reached.value > cautious;
        }
    }

    /// Notes a force that is certainly under the rating; returns whether it is.
    pub(crate) fn note_left_rating(&mut self, spring: usize, negative: bool, value: f64) -> bool {
        let left_rating = self.is_well_below_rating(spring, negative, value);
        if left_rating {
            self.side_mut(spring, negative).left_rating = true;
        }
        left_rating
    }

    /// At the end: decides on a side that stood at its rating, by the lowest value seen. If that is not certainly
    /// below, it is undecided whether it passed the rating.
    pub(crate) fn decide_at_rating(&mut self, spring: usize, negative: bool, lowest: f64) {
        let undecided = self.bound > 0.0 && !self.note_left_rating(spring, negative, lowest);
        let largest = self.peaks[spring].side(negative).best.value + self.min_rise();
        let near = largest > self.cautious_rating(spring, negative);
        self.side_mut(spring, negative).near |= undecided && near;
    }

    /// Notes that the force of a side that still stands at its rating has changed by `push` to `value`: if that is within the bound
    /// of the rating or over it, the force may pass the rating by less than can be computed.
    pub(crate) fn note_push(&mut self, spring: usize, negative: bool, push: f64, value: f64) {
        if push > PUSH * self.bound {
            self.note_upper_bound(spring, negative, value);
        }
    }

    /// At the end, when every instant with a side certainly under its rating is noted ([`Watch::note_left_rating`]).
    pub(crate) fn decide_all_at_rating(&mut self) {
        for (spring, negative) in self.sides() {
            if self.at_rating(spring, negative) {
                self.decide_at_rating(spring, negative, self.rating(spring, negative));
            }
        }
    }

    /// Notes an upper bound on values that were not examined: if it is near the rating, the verdict may stay undecided.
    pub(crate) fn note_upper_bound(&mut self, spring: usize, negative: bool, upper: f64) {
        let near = upper > self.cautious_rating(spring, negative);
        self.side_mut(spring, negative).near |= near;
    }

    /// A side that has certainly passed its rating by a time, even if the first such instant is not known.
    pub(crate) fn note_over_by(&mut self, spring: usize, negative: bool, until: f64) {
        let until = until.min(self.horizon);
        self.side_mut(spring, negative).first_over.get_or_insert(until);
    }

    fn side_mut(&mut self, spring: usize, negative: bool) -> &mut Side {
        let peaks = &mut self.peaks[spring];
        if negative { &mut peaks.buff } else { &mut peaks.draft }
    }

    /// Below this a force is certainly not over the rating.
    #[inline]
    pub(crate) fn cautious_rating(&self, spring: usize, negative: bool) -> f64 {
        self.rating(spring, negative) - self.bound
    }

    /// Whether a computed value is over the rating whatever its error.
    #[inline]
    pub(crate) fn certainly_over(&self, spring: usize, negative: bool, value: f64) -> bool {
        value > self.rating(spring, negative) + self.bound
    }

    /// How far a piece that is passed may be from the force without changing a verdict.
    #[inline]
    pub(crate) fn piece_tolerance(&self) -> f64 {
        PIECE_TOLERANCE * self.bound
    }

    /// Smaller differences in force are ignored: an eighth of the bound, or more after [`Watch::coarsen`].
    #[inline]
    pub(crate) fn min_rise(&self) -> f64 {
        self.min_rise
    }

    /// From here on differences under `min_rise` are ignored. Verdicts do not depend on it.
    pub(crate) fn coarsen(&mut self, min_rise: f64) {
        self.min_rise = self.min_rise.max(min_rise);
    }

    /// A piece of this force matters only if it can pass this level.
    #[inline]
    pub fn level(&self, spring: usize, negative: bool) -> f64 {
        let side = self.peaks[spring].side(negative);
        let rating = self.rating(spring, negative);
        let best = side.best.value + self.min_rise();
        if side.first_over.is_some() {
            best
        } else if side.near || !side.left_rating {
            best.min(rating + self.bound)
        } else {
            best.min(rating - self.bound)
        }
    }

    /// Takes note of a force over -1 <= x <= `end`, whose polynomial is right to well within the bound.
    /// `exact` gives the force at one instant, a sum of two numbers, as well as the method can.
    pub fn note(&mut self, spring: usize, negative: bool, local: &Local, end: f64, exact: impl Fn(Dd) -> f64) {
        let level = self.level(spring, negative);
        let over = self.note_largest(spring, negative, local, [end, level], exact);
        if over && self.peaks[spring].side(negative).first_over.is_none() {
            self.note_crossing(spring, negative, local);
        }
    }

    /// The same for pieces that are not in the order of time: first exceedances are not noted.
    pub(crate) fn note_peak(
        &mut self,
        spring: usize,
        negative: bool,
        local: &Local,
        end: f64,
        exact: impl Fn(Dd) -> f64,
    ) {
        let level = self.peaks[spring].side(negative).best.value.min(self.cautious_rating(spring, negative));
        self.note_largest(spring, negative, local, [end, level], exact);
    }

    /// Takes note of where the force passes its rating, if no earlier instant is known and it certainly does so here.
    pub(crate) fn note_crossing(&mut self, spring: usize, negative: bool, local: &Local) -> bool {
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
    fn note_largest(
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
        let horizon = self.horizon;
        let was_departed = self.note_end(spring, negative, local.value_and_slope(end).0);
        let Some(top) = local.largest(-1.0, end, level) else { return false };
        // A piece that ends at the horizon ends there to the last bit, however its own times round. Elsewhere the
        // force is taken at the exact instant: with fast modes it differs at the nearest `f64`.
        let at = Dd::from(local.center) + Dd::product(local.radius, top.at);
        let ends = top.at >= end && at.hi > horizon * (1.0 - 8.0 * f64::EPSILON);
        let at = if ends || at > Dd::from(horizon) { Dd::from(horizon) } else { at };
        self.note_best(spring, negative, Point { at: at.hi.max(0.0), value: sign * exact(at) }, was_departed)
    }

    /// Takes note of a piece by its value at the end and its largest value (at a time, not an x), if that may matter. `over` gives the
    /// time at which the piece passes a given rating first.
    pub(crate) fn note_top(
        &mut self,
        spring: usize,
        negative: bool,
        at_end: f64,
        top: Option<Point>,
        over: impl FnOnce(f64) -> Option<f64>,
    ) {
        let level = self.level(spring, negative);
        let was_departed = self.note_end(spring, negative, at_end);
        let Some(top) = top.filter(|top| top.value > level) else { return };
        let is_over = self.note_best(spring, negative, top, was_departed);
        let (rating, horizon) = (self.rating(spring, negative), self.horizon);
        let side = self.side_mut(spring, negative);
        if is_over && side.first_over.is_none() {
            side.first_over = over(rating).map(|t| t.min(horizon));
        }
    }

    /// Takes note of a piece's value at its end; whether the force had left its rating before.
    fn note_end(&mut self, spring: usize, negative: bool, value: f64) -> bool {
        let left_rating = self.is_well_below_rating(spring, negative, value);
        let side = self.side_mut(spring, negative);
        let had_left = side.left_rating;
        side.left_rating |= left_rating;
        had_left
    }

    /// Takes note of the largest value of a piece; whether it is certainly over the rating.
    fn note_best(&mut self, spring: usize, negative: bool, top: Point, was_departed: bool) -> bool {
        let (rating, bound, min_rise) = (self.rating(spring, negative), self.bound, self.min_rise());
        let side = self.side_mut(spring, negative);
        // A value past a limit of the verdict counts, by however little.
        let passes = |limit: f64| top.value > limit && side.best.value <= limit;
        if top.value > side.best.value + min_rise || passes(rating - bound) || passes(rating + bound) {
            side.best = top;
            side.near |= top.value > rating - bound;
        }
        side.near |= was_departed && top.value > rating - bound;
        top.value > rating + bound
    }
}
