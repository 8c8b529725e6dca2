//! Extremes along a march, from every spring's force at equal steps.
//!
//! Between their ends forces are known as well ([`super::pieces`]). They are found only where an extreme may be: in steps whose upper bound
//! ([`super::motion`]) passes what is certainly reached elsewhere, or expected to be. Several such steps are looked into side by side.

use super::local::{Local, Locals, Point, Tops};
use super::motion::{Motion, brackets, slopes};
use super::pieces::{Step, TERMS, WINDOW, Windows, local, piece};
use super::watch::{SpringPeaks, Watch};
use super::{Wanted, Work};
use crate::chain::Scene;

/// Steps looked into side by side.
const LANES: usize = 8;

/// A step in which one side of a spring may have its extreme, or pass its rating first.
#[derive(Clone, Copy, Debug)]
struct Open {
    spring: usize,
    negative: bool,
    step: Step,
    upper: f64,
    /// Near its largest value, from -1 to 1.
    near: f64,
}

/// Per spring, what F and -F are expected to pass; minus infinity for nothing.
pub type Levels = Vec<[f64; 2]>;

/// One sign of one spring.
#[derive(Clone, Debug)]
struct Side {
    /// What a later force must exceed to matter: a lower bound on the largest force so far, or that with the ignored difference added.
    reached: f64,
    /// The step in which it has certainly passed its rating, and when that ends.
    over_in: Option<(u64, f64)>,
    /// It stood at its rating before the event, and has not left it.
    at_rating: bool,
}

/// The search for extremes along a march.
#[derive(Clone)]
pub struct Search<'a> {
    scene: &'a Scene,
    pub(super) motion: &'a Motion,
    watch: Watch,
    /// What every side is expected to pass; and the largest utilisation expected, where only the worst is wanted.
    expected: Levels,
    expected_utilisation: Option<f64>,
    /// Number of the last step in which a first exceedance matters: where only the worst is wanted, the step after the first in which some
    /// side has certainly passed its rating.
    last_to_cross: u64,
    sides: Vec<[Side; 2]>,
    /// Steps to look into together, in the order of time: at most as many as there are lanes; and the forces around their springs.
    open: Vec<Open>,
    windows: Box<Windows<LANES>>,
    /// Per sign and spring: what G, or -G, has to pass to matter.
    pub levels: [Vec<f64>; 2],
    /// Per sign and spring: what G, or -G, has to pass for a first exceedance; infinite once there is one.
    pub crossings: [Vec<f64>; 2],
    /// Springs of which one of these has changed.
    pub changed: Vec<usize>,
    /// What was done.
    pub work: Work,
    /// Sides that stood at their rating and have not left it, and the lowest they were seen at.
    at_rating: Vec<(usize, bool, f64)>,
}

impl<'a> Search<'a> {
    /// Before the event; `bound` is the error bound of all forces to come, and differences under `min_rise` are ignored.
    pub fn new(scene: &'a Scene, motion: &'a Motion, [bound, min_rise]: [f64; 2]) -> Search<'a> {
        let mut watch = Watch::new(scene, bound);
        watch.coarsen(min_rise);
        let side = |spring: usize, negative: bool| {
            let initial = watch.peaks[spring].side(negative);
            Side {
                reached: initial.best.value + watch.min_rise(),
                over_in: initial.first_over.map(|t| (0, t)),
                at_rating: watch.at_rating(spring, negative),
            }
        };
        let springs = scene.initial.len();
        let sides: Vec<[Side; 2]> = (0..springs).map(|s| [side(s, false), side(s, true)]).collect();
        let both = (0..springs).flat_map(|s| [(s, false), (s, true)]);
        let at_rating = both
            .filter(|&(s, negative)| sides[s][usize::from(negative)].at_rating)
            .map(|(s, negative)| (s, negative, watch.peaks[s].side(negative).best.value))
            .collect();
        let [levels, crossings] = [0, 1].map(|_| [0, 1].map(|_| vec![f64::INFINITY; springs]));
        let mut search = Search {
            scene,
            motion,
            watch,
            expected: vec![[f64::NEG_INFINITY; 2]; springs],
            expected_utilisation: None,
            last_to_cross: u64::MAX,
            sides,
            open: Vec::with_capacity(LANES),
            windows: Box::new(Windows::NONE),
            levels,
            crossings,
            changed: Vec::new(),
            work: Work::default(),
            at_rating,
        };
        search.set_levels();
        search
    }

    /// Sets what forces are expected to pass from here on. Steps that stay below are dropped; [`Search::finish`]
    /// checks whether forces did pass it.
    ///
    /// For the worst spring: forces that the error bound cannot distinguish count as equal, and the first of them is taken.
    pub fn expect(&mut self, levels: &Levels, wanted: Wanted) {
        self.expected = levels.clone();
        if wanted == Wanted::Worst {
            let expected_utilisation = self.largest_utilisation(|s, negative| levels[s][usize::from(negative)]);
            let margin = 4.0 * (self.watch.bound() + self.watch.min_rise());
            let level = |s: usize, negative: bool| expected_utilisation * self.watch.rating(s, negative) - margin;
            self.expected = (0..self.sides.len()).map(|s| [level(s, false), level(s, true)]).collect();
            self.expected_utilisation = Some(expected_utilisation);
            let over = self.sides.iter().flatten().filter_map(|side| side.over_in);
            self.last_to_cross = over.map(|(number, _)| number + 1).min().unwrap_or(u64::MAX);
        }
        self.set_levels();
    }

    /// The largest utilisation.
    fn largest_utilisation(&self, value: impl Fn(usize, bool) -> f64) -> f64 {
        let utilisation = |(s, negative): (usize, bool)| value(s, negative) / self.watch.rating(s, negative);
        self.watch.sides().map(utilisation).fold(0.0, f64::max)
    }

    /// Whether forces have not passed what was expected, so that steps were dropped which may hold the largest.
    fn falls_short(&self) -> bool {
        let best = |s: usize, negative: bool| self.watch.peaks[s].side(negative).best.value;
        if let Some(expected_utilisation) = self.expected_utilisation {
            return self.largest_utilisation(best) < expected_utilisation;
        }
        let min_rise = self.watch.min_rise();
        self.watch.sides().any(|(s, negative)| best(s, negative) + min_rise < self.expected[s][usize::from(negative)])
    }

    /// The same search, up to an instant before the horizon: the step that contains it is cut there.
    pub fn until(&self, mark: f64) -> Search<'a> {
        Search { watch: self.watch.until(mark), ..self.clone() }
    }

    pub(super) fn set_levels(&mut self) {
        self.watch.sides().for_each(|(s, negative)| self.set_level(s, negative));
    }

    fn set_level(&mut self, spring: usize, negative: bool) {
        let side = &self.sides[spring][usize::from(negative)];
        let rating = self.watch.rating(spring, negative);
        let largest = self.peak_level(spring, negative);
        let level = match side {
            Side { over_in: Some(_), .. } => largest,
            Side { at_rating: true, .. } => side.reached.min(rating + self.watch.bound()),
            _ => largest.min(self.watch.cautious_rating(spring, negative)),
        };
        let crossing = if side.over_in.is_some() { f64::INFINITY } else { level.max(rating - self.watch.bound()) };
        let initial = self.scene.initial[spring];
        let before = if negative { -initial } else { initial };
        self.levels[usize::from(negative)][spring] = level - before;
        self.crossings[usize::from(negative)][spring] = crossing - before;
        self.changed.push(spring);
    }

    /// What a side's force has to pass for its largest value to matter.
    #[inline]
    fn peak_level(&self, spring: usize, negative: bool) -> f64 {
        let negative = usize::from(negative);
        self.sides[spring][negative].reached.max(self.expected[spring][negative])
    }

    /// Whether no step like this one follows: the last one, or the last before a pulse ends.
    pub(crate) fn is_last(&self, step: &Step) -> bool {
        let next = step.from + 1.5 * step.width;
        next > self.watch.horizon() || (self.scene.duration > step.from && self.scene.duration < next)
    }

    /// Whether a step's end lies behind the horizon.
    fn is_cut(&self, step: &Step) -> bool {
        step.end() > self.watch.horizon()
    }

    /// Examines a spring in a step where it may matter, from `G`, `h^2 G''` and `h^4 G''''` at both ends and the spring's second remainder;
    /// `window` gives the forces of the springs around at both ends ([`windows`]), and is asked for only if the step is kept.
    #[inline(never)]
    pub(crate) fn consider(
        &mut self,
        step: &Step,
        spring: usize,
        remainder: f64,
        ends: [[f64; 3]; 2],
        window: impl FnOnce() -> [[f64; WINDOW]; 2],
    ) {
        self.work.considered += 1;
        let window = std::cell::LazyCell::new(window);
        let brackets = brackets(ends, remainder);
        let [least, greatest] = slopes(ends, remainder);
        for negative in [false, true] {
            let sign = if negative { -1.0 } else { 1.0 };
            let level = self.levels[usize::from(negative)][spring];
            let [mut lower, upper, at] = brackets[usize::from(negative)];
            if self.is_cut(step) {
                // What lies behind the horizon does not count.
                lower = sign * ends[0][0];
            }
            let slopes = if negative { [-greatest, -least] } else { [least, greatest] };
            if upper <= level || self.extreme_is_elsewhere(step, spring, negative, sign * ends[1][0], slopes) {
                continue;
            }
            let initial = sign * self.scene.initial[spring];
            // Rounding can make the lower bound the larger one.
            let [lower, upper] = [lower, upper.max(lower)].map(|bound| bound + initial);
            if self.is_narrow(spring, negative, step, [lower, upper]) {
                self.take(spring, negative, Point { at: step.from + at * step.width, value: lower });
            } else if self.reach(spring, negative, step, [lower, upper]) {
                let near = 2.0 * at - 1.0;
                self.keep(Open { spring, negative, step: *step, upper, near }, &window);
            }
        }
    }

    /// Whether the force certainly falls, so that it was largest at the end of the step before, or certainly rises, so
    /// that the next step begins with its largest value, and no rating can be passed here.
    #[inline]
    fn extreme_is_elsewhere(
        &self,
        step: &Step,
        spring: usize,
        negative: bool,
        end: f64,
        [least, greatest]: [f64; 2],
    ) -> bool {
        if greatest < 0.0 {
            return true;
        }
        let side = &self.sides[spring][usize::from(negative)];
        let initial = self.scene.initial[spring];
        let end = end + if negative { -initial } else { initial };
        let may_cross = side.over_in.is_none() && end > self.watch.cautious_rating(spring, negative);
        !may_cross && !self.is_last(step) && least > 0.0
    }

    /// Takes note of what a side certainly reaches in a step; whether the step still matters then.
    fn reach(&mut self, spring: usize, negative: bool, step: &Step, [lower, upper]: [f64; 2]) -> bool {
        if self.watch.certainly_over(spring, negative, lower) {
            self.note_over(spring, negative, step);
        }
        self.raise(spring, negative, lower);
        let matters = self.matters(spring, negative, step, upper);
        if !matters {
            self.set_level(spring, negative);
        }
        matters
    }

    /// Takes note that a side certainly passes its rating in a step.
    fn note_over(&mut self, spring: usize, negative: bool, step: &Step) {
        let side = &mut self.sides[spring][usize::from(negative)];
        if side.over_in.is_none() {
            side.over_in = Some((step.number, step.end()));
            if self.expected_utilisation.is_some() {
                // The next step still counts: its beginning is rounded.
                self.last_to_cross = self.last_to_cross.min(step.number + 1);
            }
        }
    }

    /// Raises what a side's largest force certainly passes.
    #[inline]
    fn raise(&mut self, spring: usize, negative: bool, reached: f64) {
        let side = &mut self.sides[spring][usize::from(negative)];
        side.reached = side.reached.max(reached);
    }

    /// Whether the bounds on a side's largest force in a step differ by no more than is ignored, and no verdict depends on the step.
    fn is_narrow(&self, spring: usize, negative: bool, step: &Step, [lower, upper]: [f64; 2]) -> bool {
        let min_rise = self.watch.min_rise();
        min_rise > self.watch.bound()
            && upper - lower <= min_rise
            && !self.may_cross(spring, negative, step, upper)
            && !self.sides[spring][usize::from(negative)].at_rating
            && !self.is_cut(step)
    }

    /// Takes the lower bound on a side's largest force in a step as its value. From here on only forces that are larger by more than the
    /// ignored difference matter.
    fn take(&mut self, spring: usize, negative: bool, reached: Point) {
        self.watch.note_reached(spring, negative, reached);
        self.raise(spring, negative, reached.value + self.watch.min_rise());
        self.set_level(spring, negative);
    }

    /// Whether a step may decide a side's largest force, or when or whether it passes its rating.
    fn matters(&self, spring: usize, negative: bool, step: &Step, upper: f64) -> bool {
        let is_at_rating = self.sides[spring][usize::from(negative)].at_rating;
        upper >= self.peak_level(spring, negative) || self.may_cross(spring, negative, step, upper) || is_at_rating
    }

    /// Whether a side may first pass its rating in a step, and that is of interest.
    fn may_cross(&self, spring: usize, negative: bool, step: &Step, upper: f64) -> bool {
        let side = &self.sides[spring][usize::from(negative)];
        let [of_all, own] = [step.number <= self.last_to_cross, upper >= self.expected[spring][usize::from(negative)]];
        let may_be_first = side.over_in.is_none_or(|(over_in, _)| step.number <= over_in && (of_all || own));
        upper > self.watch.cautious_rating(spring, negative) && may_be_first
    }

    /// Keeps a step to look into it together with others. Steps of a side that stands at its rating are looked into at once, before it can
    /// be noted that the side has left it.
    fn keep(&mut self, open: Open, window: &[[f64; WINDOW]; 2]) {
        let Open { spring, negative, step, .. } = open;
        let sign = if negative { -1.0 } else { 1.0 };
        self.windows.set(self.open.len(), self.motion, &step, spring, window, sign);
        self.open.push(open);
        self.work.kept += 1;
        if self.open.len() == LANES || self.sides[spring][usize::from(negative)].at_rating {
            self.look();
        }
        self.set_level(spring, negative);
    }

    /// After a step: notes which springs have left their rating; `at(end, s)` is G of spring s at its beginning (0) or
    /// end (1).
    pub(crate) fn note_all_left_rating(&mut self, step: &Step, at: impl Fn(usize, usize) -> f64) {
        let mut left = std::mem::take(&mut self.at_rating);
        left.retain_mut(|(spring, negative, lowest)| {
            let end = [self.watch.horizon()];
            let g = if self.is_cut(step) { self.values(step, *spring, &end, &at)[0] } else { at(1, *spring) };
            self.note_push(*spring, *negative, g);
            let value = self.value(*spring, *negative, g);
            *lowest = lowest.min(value);
            !self.note_left_rating(*spring, *negative, value)
        });
        self.at_rating = left;
    }

    /// A side's force from G, what the event has added.
    fn value(&self, spring: usize, negative: bool, g: f64) -> f64 {
        let value = g + self.scene.initial[spring];
        if negative { -value } else { value }
    }

    /// Notes that G may push a side over the rating at which it still stands.
    fn note_push(&mut self, spring: usize, negative: bool, g: f64) {
        let value = self.value(spring, negative, g);
        self.watch.note_push(spring, negative, if negative { -g } else { g }, value);
    }

    /// Whether a side does not stand at its rating any more; notes it.
    fn note_left_rating(&mut self, spring: usize, negative: bool, value: f64) -> bool {
        if !self.sides[spring][usize::from(negative)].at_rating {
            return true;
        }
        let left_rating = self.watch.note_left_rating(spring, negative, value);
        if left_rating {
            self.sides[spring][usize::from(negative)].at_rating = false;
            self.set_level(spring, negative);
        }
        left_rating
    }

    /// Looks into the steps that are kept.
    fn look(&mut self) {
        let mut open = std::mem::take(&mut self.open);
        if open.iter().any(|open| self.is_open(open)) {
            let mut look = Look { windows: &mut self.windows, lanes: [Lane::NONE; LANES] };
            for (lane, open) in look.lanes.iter_mut().zip(&open) {
                *lane = lane_of(self.scene, &self.watch, open);
            }
            let found = super::vectors::widest().dispatch(&mut look);
            open.iter().enumerate().for_each(|(lane, open)| self.note(open, lane, &found));
        }
        open.clear();
        self.open = open;
    }

    /// Whether a step that was kept still matters.
    fn is_open(&self, &Open { spring, negative, step, upper, .. }: &Open) -> bool {
        // A later step may certainly reach more, but not by so much that it would be taken instead of this one.
        let with_rise = upper + self.watch.min_rise();
        upper > self.watch.level(spring, negative) && self.matters(spring, negative, &step, with_rise)
    }

    /// Takes note of what was found in a step, if it still matters.
    fn note(&mut self, open: &Open, lane: usize, found: &Found) {
        let &Open { spring, negative, step, .. } = open;
        if !self.is_open(open) {
            return;
        }
        self.work.refinements += 1;
        let local = || found.local(lane, &step);
        let horizon = self.watch.horizon();
        let end = end_of(&step, horizon);
        let top = if found.tops.is_certain[lane] {
            Some(Point { at: found.tops.at[lane], value: found.tops.value[lane] })
        } else {
            local().largest(-1.0, end, self.watch.level(spring, negative))
        };
        let time = |x: f64| (step.from + 0.5 * step.width * (1.0 + x)).clamp(0.0, horizon);
        let top = top.map(|top| {
            // A step that ends at the horizon ends there to the last bit.
            let at = time(top.at);
            let ends = top.at >= end && at > horizon * (1.0 - 8.0 * f64::EPSILON);
            Point { at: if ends { horizon } else { at }, value: top.value }
        });
        let over = |rating: f64| match found.crossings[lane] {
            x if x.is_nan() => local().first_over(-1.0, 1.0, rating).map(time),
            x => Some(time(x)),
        };
        self.watch.note_top(spring, negative, found.tops.at_end[lane], top, over);
        let side = self.watch.peaks[spring].side(negative);
        let (best, is_over) = (side.best.value, side.first_over.is_some());
        self.raise(spring, negative, best);
        if is_over {
            self.note_over(spring, negative, &step);
        }
        self.set_level(spring, negative);
    }

    /// Looks into all that is still open.
    pub(crate) fn look_into_all(&mut self) {
        self.look();
        self.set_levels();
    }

    /// Looks into all that is still open. Returns the peaks, or `None` if forces did not pass what was expected, and the work.
    pub fn finish(mut self) -> (Option<Vec<SpringPeaks>>, Work) {
        self.look_into_all();
        let short = self.falls_short();
        for (spring, negative) in self.watch.sides() {
            if let Some((_, until)) = self.sides[spring][usize::from(negative)].over_in {
                self.watch.note_over_by(spring, negative, until);
            }
        }
        for (spring, negative, lowest) in std::mem::take(&mut self.at_rating) {
            self.watch.decide_at_rating(spring, negative, lowest);
        }
        ((!short).then_some(self.watch.peaks), self.work)
    }

    /// Values of one spring's force since the event at times within a step; `at` as for [`piece`].
    pub fn values(&self, step: &Step, spring: usize, times: &[f64], at: impl Fn(usize, usize) -> f64) -> Vec<f64> {
        let local = piece(self.motion, step, spring, at);
        times.iter().map(|t| local.value_and_slope((t - local.center) / local.radius).0).collect()
    }
}

/// Where a step is left or the horizon reached, from -1 to 1.
fn end_of(step: &Step, horizon: f64) -> f64 {
    let radius = 0.5 * step.width;
    ((horizon - (step.from + radius)) / radius).min(1.0)
}

/// Kept steps, one in each lane.
struct Look<'a> {
    windows: &'a mut Windows<LANES>,
    lanes: [Lane; LANES],
}

/// What is asked about one step.
#[derive(Clone, Copy)]
struct Lane {
    /// The force before the event.
    initial: f64,
    near: f64,
    end: f64,
    /// A first exceedance is wanted over the rating, if the force certainly passes it.
    rating: f64,
    certainly_over: f64,
}

impl Lane {
    const NONE: Lane = Lane { initial: 0.0, near: 0.0, end: 1.0, rating: 0.0, certainly_over: f64::INFINITY };
}

/// What is asked about a kept step.
fn lane_of(scene: &Scene, watch: &Watch, open: &Open) -> Lane {
    let &Open { spring, negative, step, near, .. } = open;
    let (initial, rating) = (scene.initial[spring], watch.rating(spring, negative));
    let is_over = watch.peaks[spring].side(negative).first_over.is_some();
    let end = end_of(&step, watch.horizon());
    Lane {
        initial: if negative { -initial } else { initial },
        near: near.min(end),
        end,
        rating,
        certainly_over: if is_over { f64::INFINITY } else { rating + watch.bound() },
    }
}

/// What was found in steps, one in each lane.
struct Found {
    locals: Locals<TERMS, LANES>,
    tops: Tops<LANES>,
    /// Where a rating is passed first; NaN if it is not, or if that is not certain.
    crossings: [f64; LANES],
}

impl Found {
    /// One lane's force over a step.
    fn local(&self, lane: usize, step: &Step) -> Local {
        local(&self.locals.coefficient, lane, step)
    }
}

impl pulp::WithSimd for &mut Look<'_> {
    type Output = Found;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Found {
        let mut locals = Locals { coefficient: self.windows.series() };
        (0..LANES).for_each(|l| locals.coefficient[0][l] += self.lanes[l].initial);
        let tops = locals.tops(self.lanes.map(|lane| lane.near), self.lanes.map(|lane| lane.end));
        let mut crosses = [false; LANES];
        (0..LANES).for_each(|l| crosses[l] = tops.is_certain[l] & (tops.value[l] > self.lanes[l].certainly_over));
        let crossings = locals.crossings(self.lanes.map(|lane| lane.rating), tops.at, crosses);
        Found { locals, tops, crossings }
    }
}
