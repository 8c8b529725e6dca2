//! Extremes between the instants of a march: what a method that knows every spring's force at equal steps shows the watch.
//!
//! With X = h^2 A a spring's force over a step obeys, mode by mode with theta^2 an eigenvalue of X,
//!
//! ```text
//! G(z) = cos(z theta/2) / cos(theta/2) (G_0 + G_1) / 2 + sin(z theta/2) / sin(theta/2) (G_1 - G_0) / 2,   -1 <= z <= 1
//! ```
//!
//! and both functions are power series in X: forces around a spring at both ends of a step give its force at every instant
//! between them, to rounding. That is only worth its price where an extreme may be: steps whose upper bound ([`super::motion`])
//! lies below another step's lower bound are dropped; the few that are left are looked into at the end.

use super::Wanted;
use super::lead::Lead;
use super::local::{COEFFICIENTS, Local};
use super::motion::{BLOCK, FROM_OUTSIDE, GROWTH, Motion, bracket, least_slope};
use super::series::{DEGREE, POWERS, table};
use super::watch::Watch;
use crate::chain::Scene;

/// Largest phase of a step, h omega_max.
pub const PHASE: f64 = 1.5;
/// Springs around the one in question that the series need, and its place among them; two more than needed, for whole
/// vectors.
const WINDOW: usize = 32;
const CENTRE: usize = 15;
/// Steps of one side of one spring kept open before they are looked into.
const MOST_OPEN: usize = 48;

/// One step of a march.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Counted from 0 through the whole march.
    pub number: u64,
    /// Its beginning.
    pub from: f64,
    /// Its length.
    pub width: f64,
    /// Outside force on the source during the step.
    pub force: f64,
}

/// A step in which one side of a spring may have its extreme, or pass its rating first.
#[derive(Clone, Copy, Debug)]
struct Open {
    step: Step,
    upper: f64,
    /// Forces around the spring at both ends: a place in the search's store.
    window: usize,
}

/// One sign of one spring.
#[derive(Clone, Debug)]
struct Side {
    /// What the force certainly reaches.
    reached: f64,
    /// The step in which it has certainly passed its rating, and when that ends.
    over_in: Option<(u64, f64)>,
    /// It stood at its rating before the event, and has not left it.
    at_rating: bool,
    open: Vec<Open>,
}

/// The search for extremes along a march.
#[derive(Clone)]
pub struct Search<'a> {
    scene: &'a Scene,
    motion: &'a Motion,
    watch: Watch,
    /// What springs have certainly reached so far, where only the worst is asked for; and the same when levels were last computed from it.
    lead: Option<[Lead; 2]>,
    sides: Vec<[Side; 2]>,
    /// Per sign and spring: what G, or -G, has to pass to matter; whole blocks of springs.
    pub levels: [Vec<f64>; 2],
    /// Per sign and spring: what G, or -G, has to pass for a first exceedance; infinite once there is one.
    pub crossings: [Vec<f64>; 2],
    /// Steps looked into.
    pub looked: u64,
    /// Windows of the open steps, and the places in it that are free.
    store: Vec<[[f64; WINDOW]; 2]>,
    free: Vec<usize>,
    /// Sides that stood at their rating and have not left it, and the lowest they were seen at.
    at_rating: Vec<(usize, bool, f64)>,
}

impl<'a> Search<'a> {
    /// Before the event; `bound` is the error bound of all forces to come.
    pub fn new(scene: &'a Scene, motion: &'a Motion, bound: f64, wanted: Wanted) -> Search<'a> {
        let watch = Watch::new(scene, bound);
        let side = |spring: usize, negative: bool| {
            let initial = watch.peaks[spring].side(negative);
            Side {
                reached: initial.best.value + watch.grain(),
                over_in: initial.first_over.map(|t| (0, t)),
                at_rating: watch.at_rating(spring, negative),
                open: Vec::new(),
            }
        };
        let springs = scene.initial.len();
        let sides: Vec<[Side; 2]> = (0..springs).map(|s| [side(s, false), side(s, true)]).collect();
        let both = (0..springs).flat_map(|s| [(s, false), (s, true)]);
        let at_rating = both
            .filter(|&(s, negative)| sides[s][usize::from(negative)].at_rating)
            .map(|(s, negative)| (s, negative, watch.peaks[s].side(negative).best.value))
            .collect();
        let [levels, crossings] = [0, 1].map(|_| [0, 1].map(|_| vec![f64::INFINITY; springs.next_multiple_of(BLOCK)]));
        let lead = (wanted == Wanted::Worst).then(|| {
            let lead = Lead::new(bound);
            [lead.clone(), lead]
        });
        let mut search = Search {
            scene,
            motion,
            watch,
            lead,
            sides,
            levels,
            crossings,
            looked: 0,
            store: Vec::new(),
            free: Vec::new(),
            at_rating,
        };
        for (spring, negative) in search.watch.sides() {
            let initial = search.watch.peaks[spring].side(negative);
            let (value, over) = (initial.best.value, initial.first_over.is_some());
            let rating = search.watch.rating(spring, negative);
            if let Some([lead, _]) = &mut search.lead {
                lead.reach(value, rating);
                lead.crossed = if over { 0.0 } else { lead.crossed };
            }
        }
        search.watch.sides().for_each(|(s, negative)| search.set_level(s, negative));
        search
    }

    /// The same search, to go on up to an earlier instant than the horizon: the step that contains it is cut there.
    pub fn until(&self, mark: f64) -> Search<'a> {
        Search { watch: self.watch.until(mark), ..self.clone() }
    }

    /// A change of force too small to matter.
    pub fn quiet(&self) -> f64 {
        0.01 * self.watch.grain()
    }

    fn set_level(&mut self, spring: usize, negative: bool) {
        let side = &self.sides[spring][usize::from(negative)];
        let rating = self.watch.rating(spring, negative);
        let largest = self.worth(side, rating);
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
    }

    /// What a side's force has to pass for its largest value to matter.
    #[inline]
    fn worth(&self, side: &Side, rating: f64) -> f64 {
        self.lead.as_ref().map_or(side.reached, |[lead, _]| lead.level(rating).max(side.reached))
    }

    /// After a step, or some: levels anew where others have reached much more than when they were made.
    #[inline]
    pub fn keep_up(&mut self) {
        if let Some([lead, last]) = &mut self.lead
            && lead.is_far_from(last)
        {
            *last = lead.clone();
            self.watch.sides().for_each(|(s, negative)| self.set_level(s, negative));
        }
    }

    /// Whether no step like this one follows: the last one, or the last before a pulse ends.
    pub fn is_last(&self, step: &Step) -> bool {
        let next = step.from + 1.5 * step.width;
        next > self.watch.horizon() || (self.scene.duration > step.from && self.scene.duration < next)
    }

    /// Whether a step's end lies behind the horizon.
    fn is_cut(&self, step: &Step) -> bool {
        step.from + step.width > self.watch.horizon()
    }

    /// A step of which a quick bound says that a spring may matter. `at(end, s)` is G of spring s at the beginning (0) or end
    /// (1) of the step, for any s in the chain; `factor` is the spring's second remainder per unit of norm, and `norm` that of
    /// the blocks around.
    #[inline]
    pub fn consider(&mut self, step: &Step, spring: usize, factor: f64, norm: f64, at: impl Fn(usize, usize) -> f64) {
        let ends = [jet(self.motion, step, spring, |s| at(0, s)), jet(self.motion, step, spring, |s| at(1, s))];
        let mut remainder = factor * norm;
        let mut narrowed = false;
        for negative in [false, true] {
            let sign = if negative { -1.0 } else { 1.0 };
            let level = self.levels[usize::from(negative)][spring];
            let [[a, b, c], [d, e, f]] = ends;
            let ends = [[sign * a, sign * b, sign * c], [sign * d, sign * e, sign * f]];
            if bracket(ends, remainder)[1] <= level {
                continue;
            }
            if !narrowed {
                narrowed = true;
                let near = self.norm(step, spring, |s| at(0, s)).max(self.norm(step, spring, |s| at(1, s)));
                remainder = factor * (GROWTH * near + FROM_OUTSIDE * norm).min(norm);
            }
            let [mut lower, upper] = bracket(ends, remainder);
            if self.is_cut(step) {
                // What lies behind the horizon does not count.
                lower = ends[0][0];
            }
            if upper <= level || self.other_steps_have_it(step, spring, negative, ends, remainder) {
                continue;
            }
            let initial = sign * self.scene.initial[spring];
            // Rounding can turn a narrow bracket over.
            let mut open = Open { step: *step, upper: upper.max(lower) + initial, window: 0 };
            if self.reach(spring, negative, lower + initial, &open) {
                let springs = self.sides.len();
                open.window = self.put([window(springs, spring, |s| at(0, s)), window(springs, spring, |s| at(1, s))]);
                self.keep(spring, negative, open);
            }
        }
    }

    /// Whether the force certainly falls, so that it is largest where the step before ended, or certainly rises, so that the
    /// next step holds whatever this one does, and no rating can be passed before.
    #[inline]
    fn other_steps_have_it(
        &self,
        step: &Step,
        spring: usize,
        negative: bool,
        ends: [[f64; 3]; 2],
        remainder: f64,
    ) -> bool {
        if least_slope(ends.map(|e| e.map(|x| -x)), remainder) > 0.0 {
            return true;
        }
        let side = &self.sides[spring][usize::from(negative)];
        let initial = self.scene.initial[spring];
        let end = ends[1][0] + if negative { -initial } else { initial };
        let may_cross = side.over_in.is_none() && end > self.watch.cautious_rating(spring, negative);
        !may_cross && !self.is_last(step) && least_slope(ends, remainder) > 0.0
    }

    /// Puts a window into the store.
    fn put(&mut self, window: [[f64; WINDOW]; 2]) -> usize {
        if let Some(place) = self.free.pop() {
            self.store[place] = window;
            return place;
        }
        self.store.push(window);
        self.store.len() - 1
    }

    /// Norm of `h^2 G''` over the block's length on either side of a spring.
    #[inline]
    fn norm(&self, step: &Step, spring: usize, at: impl Fn(usize) -> f64) -> f64 {
        let range = spring.saturating_sub(BLOCK)..(spring + BLOCK + 1).min(self.sides.len());
        let mut before = if range.start > 0 { at(range.start - 1) } else { 0.0 };
        let mut here = at(range.start);
        let mut sum = 0.0;
        for s in range {
            let after = if s + 1 < self.sides.len() { at(s + 1) } else { 0.0 };
            let pull = self.motion.ahead[s] * (here - before) + self.motion.behind[s] * (here - after);
            let bend = step.force * self.motion.drive[s] - pull;
            sum += bend * bend * self.motion.compliance[s];
            (before, here) = (here, after);
        }
        step.width * step.width * sum.sqrt()
    }

    /// Takes note of what a side certainly reaches in a step; whether the step still matters then.
    fn reach(&mut self, spring: usize, negative: bool, lower: f64, open: &Open) -> bool {
        let rating = self.watch.rating(spring, negative);
        // What is not looked into later must be over the rating beyond what rounding makes of the bracket.
        let room = if self.lead.is_some() { self.watch.grain() } else { 0.0 };
        let over = self.watch.certainly_over(spring, negative, lower - room);
        let side = &mut self.sides[spring][usize::from(negative)];
        let rises = lower > side.reached;
        side.reached = side.reached.max(lower);
        if over && side.over_in.is_none() {
            side.over_in = Some((open.step.number, open.step.from + open.step.width));
        }
        if let Some([lead, _]) = &mut self.lead {
            lead.reach(lower, rating);
            if over {
                lead.cross(&open.step);
            }
        }
        if rises {
            self.forget(spring, negative);
        }
        let side = &self.sides[spring][usize::from(negative)];
        let matters = self.matters(spring, negative, side, open);
        if !matters {
            self.set_level(spring, negative);
        }
        matters
    }

    /// Drops open steps that no longer matter.
    fn forget(&mut self, spring: usize, negative: bool) {
        let mut all = std::mem::take(&mut self.sides[spring][usize::from(negative)].open);
        let side = &self.sides[spring][usize::from(negative)];
        let mut freed = std::mem::take(&mut self.free);
        all.retain(|o| {
            let matters = self.matters(spring, negative, side, o);
            if !matters {
                freed.push(o.window);
            }
            matters
        });
        self.free = freed;
        self.sides[spring][usize::from(negative)].open = all;
    }

    /// Whether a step may hold a side's largest force, or the instant at which it passes its rating, or whether it does.
    fn matters(&self, spring: usize, negative: bool, side: &Side, open: &Open) -> bool {
        let rating = self.watch.rating(spring, negative);
        let may_cross = open.upper > self.watch.cautious_rating(spring, negative);
        // For a side that may be the worst, the same steps are kept as where everything is asked for.
        let asked = |[lead, _]: &[Lead; 2]| open.step.from < lead.crossed || open.upper >= lead.level(rating);
        let is_first = |over_in: u64| open.step.number <= over_in && self.lead.as_ref().is_none_or(asked);
        let may_be_first = side.over_in.is_none_or(|(over_in, _)| is_first(over_in));
        open.upper >= self.worth(side, rating) || may_cross && may_be_first || side.at_rating
    }

    /// Keeps a step open.
    fn keep(&mut self, spring: usize, negative: bool, open: Open) {
        let side = &mut self.sides[spring][usize::from(negative)];
        side.open.push(open);
        if side.at_rating || side.open.len() >= MOST_OPEN {
            self.look(spring, negative);
        }
        self.set_level(spring, negative);
    }

    /// After a step: springs that stood at their rating and have left it; `at` as for [`Search::consider`].
    pub fn departures(&mut self, step: &Step, at: impl Fn(usize, usize) -> f64) {
        let mut left = std::mem::take(&mut self.at_rating);
        left.retain_mut(|(spring, negative, lowest)| {
            let end = [self.watch.horizon()];
            let g = if self.is_cut(step) { self.values(step, *spring, &end, &at)[0] } else { at(1, *spring) };
            self.mind_push(*spring, *negative, g);
            let value = self.value(*spring, *negative, g);
            *lowest = lowest.min(value);
            !self.departs(*spring, *negative, value)
        });
        self.at_rating = left;
    }

    /// Before a step is considered: whether the spring has left its rating at one of the instants since the event.
    pub fn departures_of(&mut self, spring: usize, forces: &[f64]) {
        for negative in [false, true] {
            for &g in forces {
                if self.departs(spring, negative, self.value(spring, negative, g)) {
                    break;
                }
                self.mind_push(spring, negative, g);
            }
        }
    }

    /// A side's force from G, what the event has added.
    fn value(&self, spring: usize, negative: bool, g: f64) -> f64 {
        let value = g + self.scene.initial[spring];
        if negative { -value } else { value }
    }

    /// A side that stood at its rating and has not left it: G, what the event has added, may push it on.
    fn mind_push(&mut self, spring: usize, negative: bool, g: f64) {
        let value = self.value(spring, negative, g);
        self.watch.mind_push(spring, negative, if negative { -g } else { g }, value);
    }

    /// Whether a side that stood at its rating is well below it; if so it is marked.
    fn departs(&mut self, spring: usize, negative: bool, value: f64) -> bool {
        if !self.sides[spring][usize::from(negative)].at_rating {
            return true;
        }
        let departed = self.watch.departs(spring, negative, value);
        if departed {
            self.sides[spring][usize::from(negative)].at_rating = false;
            self.set_level(spring, negative);
        }
        departed
    }

    /// Looks into the open steps of a side, in the order of time.
    fn look(&mut self, spring: usize, negative: bool) {
        if self.lead.is_some() {
            self.forget(spring, negative);
        }
        let mut all = std::mem::take(&mut self.sides[spring][usize::from(negative)].open);
        for open in all.drain(..) {
            self.free.push(open.window);
            if open.upper <= self.watch.level(spring, negative) {
                continue;
            }
            self.looked += 1;
            let mut local = local(self.motion, &open.step, spring, &self.store[open.window]);
            local.coefficient[0] += self.scene.initial[spring];
            let end = ((self.watch.horizon() - local.center) / local.radius).min(1.0);
            self.watch.note(spring, negative, &local, end, |t| local.value_at(t));
        }
        let best = self.watch.peaks[spring].side(negative).best.value;
        let side = &mut self.sides[spring][usize::from(negative)];
        side.open = all;
        side.reached = side.reached.max(best);
        if let Some([lead, _]) = &mut self.lead {
            lead.reach(best, self.watch.rating(spring, negative));
        }
    }

    /// Looks into all that is still open, the most promising first; what has been found.
    pub fn finish(mut self) -> (Watch, u64) {
        let promise = |&(s, negative): &(usize, bool)| {
            let uppers = self.sides[s][usize::from(negative)].open.iter().map(|o| o.upper);
            uppers.fold(f64::NEG_INFINITY, f64::max) / self.watch.rating(s, negative)
        };
        let mut sides: Vec<(f64, (usize, bool))> = self.watch.sides().map(|side| (promise(&side), side)).collect();
        sides.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (_, (spring, negative)) in sides {
            self.look(spring, negative);
            let over_in = self.sides[spring][usize::from(negative)].over_in;
            if let Some((_, until)) = over_in.filter(|_| self.lead.is_some()) {
                self.watch.mark_over(spring, negative, until);
            }
        }
        for (spring, negative, lowest) in std::mem::take(&mut self.at_rating) {
            self.watch.settle(spring, negative, lowest);
        }
        (self.watch, self.looked)
    }

    /// Values of one spring's force since the event at times within a step.
    pub fn values(&self, step: &Step, spring: usize, times: &[f64], at: impl Fn(usize, usize) -> f64) -> Vec<f64> {
        let local = piece(self.motion, step, spring, at);
        times.iter().map(|t| local.value_and_slope((t - local.center) / local.radius).0).collect()
    }
}

/// `G`, `h^2 G''` and `h^4 G''''` of a spring at one end of a step.
#[inline(always)]
pub fn jet(motion: &Motion, step: &Step, spring: usize, at: impl Fn(usize) -> f64) -> [f64; 3] {
    let square = step.width * step.width;
    let springs = motion.ahead.len();
    // Springs from two before to two behind; those that do not exist are at rest.
    let mut g = [0.0; 5];
    for (l, g) in g.iter_mut().enumerate() {
        let s = (spring + l).wrapping_sub(2);
        if s < springs {
            *g = at(s);
        }
    }
    let mut bend = [0.0; 3];
    for (l, bend) in bend.iter_mut().enumerate() {
        let s = (spring + l).wrapping_sub(1);
        if s < springs {
            let pull = motion.ahead[s] * (g[l + 1] - g[l]) + motion.behind[s] * (g[l + 1] - g[l + 2]);
            *bend = square * (step.force * motion.drive[s] - pull);
        }
    }
    let (ahead, behind) = (motion.ahead[spring], motion.behind[spring]);
    [g[2], bend[1], -square * (ahead * (bend[1] - bend[0]) + behind * (bend[1] - bend[2]))]
}

/// Forces of the springs around.
#[inline(always)]
fn window(springs: usize, spring: usize, at: impl Fn(usize) -> f64) -> [f64; WINDOW] {
    let mut window = [0.0; WINDOW];
    for (l, w) in window.iter_mut().enumerate() {
        let s = (spring + l).wrapping_sub(CENTRE);
        if s < springs {
            *w = at(s);
        }
    }
    window
}

/// The force since the event over a step, from the forces around the spring at both ends.
fn local(motion: &Motion, step: &Step, spring: usize, around: &[[f64; WINDOW]; 2]) -> Local {
    let square = step.width * step.width;
    let squared = |x: &[f64]| window(motion.ahead.len(), spring, |s| square * x[s]);
    let (ahead, behind, drive) = (squared(&motion.ahead), squared(&motion.behind), squared(&motion.drive));
    let mut sum: [f64; WINDOW] = std::array::from_fn(|l| 0.5 * (around[0][l] + around[1][l]));
    let mut difference: [f64; WINDOW] = std::array::from_fn(|l| 0.5 * (around[1][l] - around[0][l]));
    let mut coefficient = [0.0; COEFFICIENTS];
    let table = table();
    for power in 0..POWERS {
        for m in 0..DEGREE {
            coefficient[2 * m] += table.even[power][m] * sum[CENTRE];
            coefficient[2 * m + 1] += table.odd[power][m] * difference[CENTRE];
        }
        sum = times_x(&ahead, &behind, &sum);
        difference = times_x(&ahead, &behind, &difference);
        if power == 0 {
            (0..WINDOW).for_each(|l| sum[l] -= step.force * drive[l]);
        }
    }
    let radius = 0.5 * step.width;
    Local { coefficient, terms: 2 * DEGREE, center: step.from + radius, radius }
}

/// The force since the event of one spring over a step; `at` as for [`Search::consider`].
pub fn piece(motion: &Motion, step: &Step, spring: usize, at: impl Fn(usize, usize) -> f64) -> Local {
    let springs = motion.ahead.len();
    let around = [window(springs, spring, |s| at(0, s)), window(springs, spring, |s| at(1, s))];
    local(motion, step, spring, &around)
}

/// X r on a window; its edges lose their meaning, one place with each application.
#[inline]
fn times_x(ahead: &[f64; WINDOW], behind: &[f64; WINDOW], r: &[f64; WINDOW]) -> [f64; WINDOW] {
    let mut out = [0.0; WINDOW];
    for l in 1..WINDOW - 1 {
        out[l] = ahead[l] * (r[l] - r[l - 1]) + behind[l] * (r[l] - r[l + 1]);
    }
    out
}
