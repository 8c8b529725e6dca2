//! Extremes between the instants of a march: what a method that knows every spring's force at equal steps shows the watch.
//!
//! With X = h^2 A a spring's force over a step obeys, mode by mode with theta^2 an eigenvalue of X,
//!
//! ```text
//! G(z) = cos(z theta/2) / cos(theta/2) (G_0 + G_1) / 2 + sin(z theta/2) / sin(theta/2) (G_1 - G_0) / 2,   -1 <= z <= 1
//! ```
//!
//! and both functions are power series in X: forces around a spring at both ends of a step give its force at every instant
//! between them, to rounding. That is only worth its price where an extreme may be. Before it, the first terms of the same
//! series (G. J. Lidstone, *Proc. Edinb. Math. Soc.* 2 (1929) 16-19) with their remainders bound the force from both sides:
//!
//! ```text
//! linear + G''            |remainder| <=  5 h^4 / 384   max |G''''|
//! linear + G'' + G''''    |remainder| <= 61 h^6 / 46080 max |G^(6)|
//! ```
//!
//! whose maxima follow from the equations of motion: `h^2 G''` at any instant of the step is the same mix of its values at both
//! ends as G is, so its norm over the springs around is at most `1 / cos(theta/2)` times the larger of theirs, and
//! `h^4 G'''' = -X h^2 G''`, `h^6 G^(6) = X^2 h^2 G''`. Steps whose upper bound lies below another step's lower bound are
//! dropped; the few that are left are looked into at the end.

use std::sync::OnceLock;

use super::dd::Dd;
use super::local::{COEFFICIENTS, Local, hermite_top};
use super::watch::Watch;
use crate::chain::Scene;

/// Largest phase of a step, h omega_max.
pub const PHASE: f64 = 1.5;
/// Powers of X, from the zeroth, that carry both functions over that phase to 1e-16.
const POWERS: usize = 14;
/// Coefficients of z, even and odd, that do.
const DEGREE: usize = 10;
/// Springs around the one in question that they need, and its place among them; two more than needed, for whole vectors.
const WINDOW: usize = 32;
const CENTRE: usize = 15;
/// Steps of one side of one spring kept open before they are looked into.
const MOST_OPEN: usize = 48;
/// Largest value of Lidstone's second polynomial `(3 x^5 - 10 x^3 + 7 x) / 360` on [0, 1].
const SECOND: f64 = 0.006_53;

/// The equations of motion of a scene's springs: `G_i'' = -a_i (G_i - G_{i-1}) - b_i (G_i - G_{i+1}) + drive_i`.
#[derive(Clone, Debug)]
pub struct Motion {
    /// `k_i / m_i`; 0 for a held mass.
    pub ahead: Vec<f64>,
    /// `k_i / m_{i+1}`; 0 for a held mass.
    pub behind: Vec<f64>,
    /// `k_i (p_i / m_i - p_{i+1} / m_{i+1})` for a unit outside force p on the source.
    pub drive: Vec<f64>,
    /// `1 / k_i`
    compliance: Vec<f64>,
    /// Bounds on `(A G)_i` and `(A^2 G)_i` per unit of the norm of `G_i / sqrt(k_i)`.
    row: Vec<[f64; 2]>,
    /// `1 / sqrt(m_source)`: the norm of accelerations and rates of extension that a unit step of force starts and keeps up.
    pub jolt: f64,
}

impl Motion {
    /// The motion of a scene.
    pub fn new(scene: &Scene) -> Motion {
        let chain = &scene.chain;
        let springs = chain.stiffness.len();
        let inverse = |v: usize| if chain.live(v) { 1.0 / chain.mass[v] } else { 0.0 };
        let ahead: Vec<f64> = (0..springs).map(|i| chain.stiffness[i] * inverse(i)).collect();
        let behind: Vec<f64> = (0..springs).map(|i| chain.stiffness[i] * inverse(i + 1)).collect();
        let mut drive = vec![0.0; springs];
        if scene.source < springs {
            drive[scene.source] = ahead[scene.source];
        }
        if scene.source > 0 {
            drive[scene.source - 1] = -behind[scene.source - 1];
        }
        let first: Vec<f64> = (0..springs).map(|i| row_norm(&ahead, &behind, &chain.stiffness, i)).collect();
        let neighbour = |i: Option<usize>| i.and_then(|i| first.get(i)).copied().unwrap_or(0.0);
        let second = |i: usize| {
            let (before, after) = (neighbour(i.checked_sub(1)), neighbour(Some(i + 1)));
            (ahead[i] + behind[i]) * first[i] + ahead[i] * before + behind[i] * after
        };
        let row = (0..springs).map(|i| [first[i], second(i)]).collect();
        let compliance = chain.stiffness.iter().map(|k| 1.0 / k).collect();
        Motion { ahead, behind, drive, compliance, row, jolt: inverse(scene.source).sqrt() }
    }

    /// The two remainders of every spring over steps of `width`, per unit of the local norm of `h^2 G''`; whole blocks of springs.
    pub fn remainders(&self, width: f64) -> [Vec<f64>; 2] {
        let square = width * width;
        let factor = [5.0 / 384.0 * square, 61.0 / 46_080.0 * square * square];
        let padding = self.row.len().next_multiple_of(BLOCK) - self.row.len();
        [0, 1].map(|d| self.row.iter().map(|r| factor[d] * r[d]).chain(std::iter::repeat_n(0.0, padding)).collect())
    }
}

/// `sqrt(k_i)` times the norm of row i of A in the coordinates `G_i / sqrt(k_i)`.
fn row_norm(ahead: &[f64], behind: &[f64], stiffness: &[f64], i: usize) -> f64 {
    let side = |c: f64, j: Option<usize>| j.and_then(|j| stiffness.get(j)).map_or(0.0, |k| c * k.sqrt());
    let middle = (ahead[i] + behind[i]) * stiffness[i].sqrt();
    middle.hypot(side(ahead[i], i.checked_sub(1))).hypot(side(behind[i], Some(i + 1)))
}

/// Springs whose norms are taken together.
pub const BLOCK: usize = 8;
/// Blocks on either side that a step can bring more than 1e-5, and more than 1e-15, of a motion from: beyond 8 powers of X the
/// series of `1 / cos(theta/2)` sums to 3e-6 at the largest phase, beyond 16 to 2e-11 of what has decayed as much again.
const NEAR: usize = 1;
const FROM_OUTSIDE: f64 = 1e-5;
const FAR: usize = 3;
const FROM_AFAR: f64 = 1e-15;
/// `1 / cos(PHASE / 2)`, rounded up.
const GROWTH: f64 = 1.37;

/// Per block: a bound on the norm of `h^2 G''` around it during a step, from the squared norms of all blocks at its ends.
#[inline(always)]
pub fn local_norms(energy: [&[f64]; 2], norms: &mut Vec<f64>) {
    let blocks = energy[0].len();
    let total: f64 = energy[0].iter().sum::<f64>() + energy[1].iter().sum::<f64>();
    let from_afar = FROM_AFAR * total.sqrt();
    norms.clear();
    for b in 0..blocks {
        let sum = |reach: usize, end: usize| {
            let around = b.saturating_sub(reach)..(b + reach + 1).min(blocks);
            energy[end][around].iter().sum::<f64>()
        };
        let (near, far) = (sum(NEAR, 0).max(sum(NEAR, 1)), sum(FAR, 0).max(sum(FAR, 1)));
        norms.push(GROWTH * near.sqrt() + FROM_OUTSIDE * far.sqrt() + from_afar);
    }
}

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
    /// The step in which it has certainly passed its rating.
    over_in: Option<u64>,
    /// It stood at its rating before the event, and has not left it.
    at_rating: bool,
    open: Vec<Open>,
}

/// The search for extremes along a march.
pub struct Search<'a> {
    scene: &'a Scene,
    motion: &'a Motion,
    watch: Watch,
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
    pub fn new(scene: &'a Scene, motion: &'a Motion, bound: f64) -> Search<'a> {
        let watch = Watch::new(scene, bound);
        let side = |spring: usize, negative: bool| {
            let initial = watch.peaks[spring].side(negative);
            Side {
                reached: initial.best.value + watch.grain(),
                over_in: initial.first_over.map(|_| 0),
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
        let mut search = Search {
            scene,
            motion,
            watch,
            sides,
            levels,
            crossings,
            looked: 0,
            store: Vec::new(),
            free: Vec::new(),
            at_rating,
        };
        (0..springs).for_each(|s| [false, true].into_iter().for_each(|n| search.set_level(s, n)));
        search
    }

    /// A change of force too small to matter.
    pub fn quiet(&self) -> f64 {
        0.01 * self.watch.grain()
    }

    fn set_level(&mut self, spring: usize, negative: bool) {
        let side = &self.sides[spring][usize::from(negative)];
        let rating = self.watch.rating(spring, negative);
        let level = match side {
            Side { over_in: Some(_), .. } => side.reached,
            Side { at_rating: true, .. } => side.reached.min(rating + self.watch.bound()),
            _ => side.reached.min(self.watch.cautious_rating(spring, negative)),
        };
        let crossing = if side.over_in.is_some() { f64::INFINITY } else { level.max(rating - self.watch.bound()) };
        let initial = self.scene.initial[spring];
        let before = if negative { -initial } else { initial };
        self.levels[usize::from(negative)][spring] = level - before;
        self.crossings[usize::from(negative)][spring] = crossing - before;
    }

    /// Whether no step like this one follows: the last one, or the last before a pulse ends.
    pub fn is_last(&self, step: &Step) -> bool {
        let next = step.from + 1.5 * step.width;
        next > self.scene.horizon || (self.scene.duration > step.from && self.scene.duration < next)
    }

    /// A step of which a quick bound says that a spring may matter. `at(end, s)` is G of spring s at the beginning (0) or end
    /// (1) of the step, for any s in the chain; `factor` is the spring's second remainder per unit of norm, and `norm` that of
    /// the blocks around.
    #[inline]
    pub fn consider(&mut self, step: &Step, spring: usize, factor: f64, norm: f64, at: impl Fn(usize, usize) -> f64) {
        let ends = [self.jet(step, spring, |s| at(0, s)), self.jet(step, spring, |s| at(1, s))];
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
            if step.from + step.width > self.scene.horizon {
                // What lies behind the horizon does not count.
                lower = ends[0][0];
            }
            if upper <= level || self.other_steps_have_it(step, spring, negative, ends, remainder) {
                continue;
            }
            let window = self.put([self.window(spring, |s| at(0, s)), self.window(spring, |s| at(1, s))]);
            let initial = sign * self.scene.initial[spring];
            self.keep(spring, negative, lower + initial, Open { step: *step, upper: upper + initial, window });
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

    /// Forces of the springs around.
    #[inline(always)]
    fn window(&self, spring: usize, at: impl Fn(usize) -> f64) -> [f64; WINDOW] {
        let mut window = [0.0; WINDOW];
        for (l, w) in window.iter_mut().enumerate() {
            let s = (spring + l).wrapping_sub(CENTRE);
            if s < self.sides.len() {
                *w = at(s);
            }
        }
        window
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

    fn keep(&mut self, spring: usize, negative: bool, lower: f64, open: Open) {
        let over = self.watch.certainly_over(spring, negative, lower);
        let cautious = self.watch.cautious_rating(spring, negative);
        let side = &mut self.sides[spring][usize::from(negative)];
        if over && side.over_in.is_none() {
            side.over_in = Some(open.step.number);
        }
        if lower > side.reached {
            side.reached = lower;
            let (reached, last) = (side.reached, side.over_in.unwrap_or(u64::MAX));
            let free = &mut self.free;
            side.open.retain(|o| {
                let matters = o.upper >= reached || (o.upper > cautious && o.step.number <= last);
                if !matters {
                    free.push(o.window);
                }
                matters
            });
        }
        side.open.push(open);
        if side.at_rating || side.open.len() >= MOST_OPEN {
            self.look(spring, negative);
        }
        self.set_level(spring, negative);
    }

    /// After a step: springs that stood at their rating and have left it.
    pub fn departures(&mut self, force: impl Fn(usize) -> f64) {
        let mut left = std::mem::take(&mut self.at_rating);
        left.retain_mut(|(spring, negative, lowest)| {
            let value = self.value(*spring, *negative, force(*spring));
            *lowest = lowest.min(value);
            !self.departs(*spring, *negative, value)
        });
        self.at_rating = left;
    }

    /// Before a step is considered: whether the spring has left its rating at one of the instants since the event.
    pub fn departures_of(&mut self, spring: usize, forces: &[f64]) {
        for negative in [false, true] {
            let _ = forces.iter().any(|&g| self.departs(spring, negative, self.value(spring, negative, g)));
        }
    }

    /// A side's force from G, what the event has added.
    fn value(&self, spring: usize, negative: bool, g: f64) -> f64 {
        let value = g + self.scene.initial[spring];
        if negative { -value } else { value }
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
        let mut all = std::mem::take(&mut self.sides[spring][usize::from(negative)].open);
        for open in all.drain(..) {
            self.free.push(open.window);
            if open.upper <= self.watch.level(spring, negative) {
                continue;
            }
            self.looked += 1;
            let mut local = self.local(&open.step, spring, &self.store[open.window]);
            local.coefficient[0] += self.scene.initial[spring];
            let end = ((self.scene.horizon - local.center) / local.radius).min(1.0);
            let exact = |t: f64| local.value_and_slope((t - local.center) / local.radius).0;
            self.watch.note(spring, negative, &local, end, exact);
        }
        let best = self.watch.peaks[spring].side(negative).best.value;
        let side = &mut self.sides[spring][usize::from(negative)];
        side.open = all;
        side.reached = side.reached.max(best);
    }

    /// Looks into all that is still open; what has been found.
    pub fn finish(mut self) -> (Watch, u64) {
        for spring in 0..self.sides.len() {
            self.look(spring, false);
            self.look(spring, true);
        }
        for (spring, negative, lowest) in std::mem::take(&mut self.at_rating) {
            self.watch.settle(spring, negative, lowest);
        }
        (self.watch, self.looked)
    }

    /// `G`, `h^2 G''` and `h^4 G''''` of a spring at one end of a step.
    #[inline(always)]
    fn jet(&self, step: &Step, spring: usize, at: impl Fn(usize) -> f64) -> [f64; 3] {
        let square = step.width * step.width;
        let springs = self.sides.len();
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
                let motion = self.motion;
                let pull = motion.ahead[s] * (g[l + 1] - g[l]) + motion.behind[s] * (g[l + 1] - g[l + 2]);
                *bend = square * (step.force * motion.drive[s] - pull);
            }
        }
        let (ahead, behind) = (self.motion.ahead[spring], self.motion.behind[spring]);
        [g[2], bend[1], -square * (ahead * (bend[1] - bend[0]) + behind * (bend[1] - bend[2]))]
    }

    /// The force since the event over a step, from the forces around the spring at both ends.
    fn local(&self, step: &Step, spring: usize, window: &[[f64; WINDOW]; 2]) -> Local {
        let square = step.width * step.width;
        let around = |x: &[f64]| self.window(spring, |s| square * x[s]);
        let (ahead, behind, drive) =
            (around(&self.motion.ahead), around(&self.motion.behind), around(&self.motion.drive));
        let mut sum: [f64; WINDOW] = std::array::from_fn(|l| 0.5 * (window[0][l] + window[1][l]));
        let mut difference: [f64; WINDOW] = std::array::from_fn(|l| 0.5 * (window[1][l] - window[0][l]));
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

    /// Values of one spring's force since the event at times within a step.
    pub fn values(&self, step: &Step, spring: usize, times: &[f64], at: impl Fn(usize, usize) -> f64) -> Vec<f64> {
        let window = [self.window(spring, |s| at(0, s)), self.window(spring, |s| at(1, s))];
        let local = self.local(step, spring, &window);
        times.iter().map(|t| local.value_and_slope((t - local.center) / local.radius).0).collect()
    }
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

/// How far a quick bound of a spring's force over a step passes what matters in either sign; negative if it does not.
///
/// `f` is G and `q` is `-h^2 G''` at both ends, `remainder` the first one. A force that certainly rises (or falls) through the
/// step leaves its largest value to the next (or previous) one, unless it may pass its rating. The remainder's slope is at most
/// half the largest second derivative of the remainder, which is an eighth of that of the force: 4.8 remainders.
#[inline(always)]
pub fn opening(f: [f64; 2], q: [f64; 2], remainder: f64, level: [f64; 2], crossing: [f64; 2], last: bool) -> f64 {
    let more = |a: f64, b: f64| if a > b { a } else { b };
    let less = |a: f64, b: f64| if a < b { a } else { b };
    let up = more(f[0], f[1]) + 0.125 * more(more(q[0], q[1]), 0.0) - level[0];
    let down = -less(f[0], f[1]) - 0.125 * less(less(q[0], q[1]), 0.0) - level[1];
    let rise = f[1] - f[0];
    let steep = rise.abs() - 0.5 * more(q[0].abs(), q[1].abs()) - 4.8 * remainder > 0.0;
    let (rises, falls) = (steep & (rise > 0.0), steep & (rise < 0.0));
    let no_up = falls | (rises & !last & (f[1] <= crossing[0]));
    let no_down = rises | (falls & !last & (-f[1] <= crossing[1]));
    let (up, down) = (if no_up { -1.0 } else { up + remainder }, if no_down { -1.0 } else { down + remainder });
    more(up, down)
}

/// Lower and upper bound of the largest value over a step, from `G`, `h^2 G''`, `h^4 G''''` at both ends and the remainder.
#[inline]
fn bracket([left, right]: [[f64; 3]; 2], remainder: f64) -> [f64; 2] {
    let rise = right[0] - left[0];
    // Slopes of the cubic that has these values and second derivatives.
    let slopes = [rise - left[1] / 3.0 - right[1] / 6.0, rise + left[1] / 6.0 + right[1] / 3.0];
    let top = hermite_top(1.0, [left[0], slopes[0]], [right[0], slopes[1]]);
    let second = |x: f64| x * (7.0 + x * x * (3.0 * x * x - 10.0)) / 360.0;
    let there = top.value + second(1.0 - top.at) * left[2] + second(top.at) * right[2] - remainder;
    let lower = there.max(left[0]).max(right[0]);
    [lower, top.value + SECOND * (left[2].max(0.0) + right[2].max(0.0)) + remainder]
}

/// Lower bound of the slope over a step.
///
/// The remainder's second derivative is that of the shorter series for `h^2 G''`, `5 / 384` of the same maximum, and the
/// remainder vanishes at both ends: its slope is at most half of that.
#[inline]
fn least_slope([left, right]: [[f64; 3]; 2], remainder: f64) -> f64 {
    let first = right[0] - left[0] - left[1] / 3.0 - right[1] / 6.0;
    let last = first + 0.5 * (left[1] + right[1]);
    let turns = left[1] < 0.0 && right[1] > 0.0;
    let between = if turns { first - 0.5 * left[1] * left[1] / (right[1] - left[1]) } else { first };
    let of_remainder = 0.5 * (5.0 / 384.0) / (61.0 / 46_080.0) * remainder;
    // The slope of Lidstone's second polynomial lies between -8 / 360 and 7 / 360.
    first.min(last).min(between) - 8.0 / 360.0 * (left[2].abs() + right[2].abs()) - of_remainder
}

/// Coefficients of z in both functions, for each power of X.
struct Table {
    even: [[f64; DEGREE]; POWERS],
    odd: [[f64; DEGREE]; POWERS],
}

fn table() -> &'static Table {
    static TABLE: OnceLock<Table> = OnceLock::new();
    TABLE.get_or_init(|| {
        // With phi = theta / 2: (-1)^m phi^2m / (2m)! / cos(phi), and (-1)^m phi^2m / (2m+1)! phi / sin(phi).
        let quarter = Dd::from(0.25);
        let fit = |m: usize, odd: usize| {
            let power =
                |x: Dd| (1..=2 * m + odd).fold(Dd::ONE, |p, q| p / Dd::from(q as f64)) * signed_power(x * quarter, m);
            let over = |x: Dd| if odd == 1 { sine_over_root(x * quarter) } else { cosine_of_root(x * quarter) };
            polynomial(POWERS, |x| power(x) / over(x))
        };
        let by_power = |odd: usize| {
            let fits: Vec<Vec<f64>> = (0..DEGREE).map(|m| fit(m, odd)).collect();
            std::array::from_fn(|p| std::array::from_fn(|m| fits[m][p]))
        };
        Table { even: by_power(0), odd: by_power(1) }
    })
}

fn signed_power(x: Dd, m: usize) -> Dd {
    (0..m).fold(Dd::ONE, |p, _| -(p * x))
}

/// `cos(sqrt x)`
pub fn cosine_of_root(x: Dd) -> Dd {
    (0..16).rev().fold(Dd::ONE, |sum, k| Dd::ONE - x * sum / Dd::from(f64::from((2 * k + 1) * (2 * k + 2))))
}

/// `sin(sqrt x) / sqrt x`
pub fn sine_over_root(x: Dd) -> Dd {
    (0..16).rev().fold(Dd::ONE, |sum, k| Dd::ONE - x * sum / Dd::from(f64::from((2 * k + 2) * (2 * k + 3))))
}

/// The polynomial of `terms` terms through `f` at the Chebyshev points of 0 <= x <= PHASE^2, in powers of x.
pub fn polynomial(terms: usize, f: impl Fn(Dd) -> Dd) -> Vec<f64> {
    let top = PHASE * PHASE;
    let point = |k: usize| {
        let angle = std::f64::consts::PI * (2 * k + 1) as f64 / (2 * terms) as f64;
        Dd::from(0.5 * top * (1.0 + angle.cos()))
    };
    let x: Vec<Dd> = (0..terms).map(point).collect();
    let mut difference: Vec<Dd> = x.iter().map(|&x| f(x)).collect();
    for order in 1..terms {
        for k in (order..terms).rev() {
            difference[k] = (difference[k] - difference[k - 1]) / (x[k] - x[k - order]);
        }
    }
    // Newton's form to powers of x.
    let mut power = vec![Dd::ZERO; terms];
    for k in (0..terms).rev() {
        for m in (0..terms).rev() {
            let lower = if m > 0 { power[m - 1] } else { difference[k] };
            power[m] = lower - x[k] * power[m];
        }
    }
    power.into_iter().map(Dd::to_f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both functions to rounding over the whole range of phases and the whole step.
    #[test]
    fn series_are_exact_to_rounding() {
        let table = table();
        for (n, z) in (1..=150).flat_map(|n| [-1.0, -0.7, 0.0, 0.3, 0.9].map(|z| (n, z))) {
            let theta = PHASE * f64::from(n) / 150.0;
            let sum = |t: &[[f64; DEGREE]; POWERS]| {
                t.iter().rev().fold(0.0, |s, row| s * theta * theta + row.iter().rev().fold(0.0, |r, c| r * z * z + c))
            };
            // Sums near 1.4: two units of rounding, twice.
            assert!((sum(&table.even) - (z * theta / 2.0).cos() / (theta / 2.0).cos()).abs() < 9e-16);
            assert!((z * sum(&table.odd) - (z * theta / 2.0).sin() / (theta / 2.0).sin()).abs() < 9e-16);
        }
    }

    /// For G = sin(theta x + phase) the bracket holds its largest value over 0 <= x <= 1, and is as narrow as its remainder says.
    #[test]
    fn bracket_holds() {
        for n in 0..200 {
            let (theta, phase) = (PHASE * f64::from(n % 10 + 1) / 10.0, 0.11 * f64::from(n));
            let jet = |x: f64| {
                let g = (theta * x + phase).sin();
                [g, -theta.powi(2) * g, theta.powi(4) * g]
            };
            let remainder = 61.0 / 46_080.0 * theta.powi(6);
            let [lower, upper] = bracket([jet(0.0), jet(1.0)], remainder);
            let top = (0..=1000).map(|k| jet(f64::from(k) / 1000.0)[0]).fold(-1.0, f64::max);
            assert!(lower <= top + 1e-15 && top <= upper, "{lower} {top} {upper}");
            assert!(upper - lower <= 2.0 * remainder + 2.0 * SECOND * theta.powi(4));
            let slope = |k: i32| theta * (theta * f64::from(k) / 1000.0 + phase).cos();
            let least = (0..=1000).map(slope).fold(9.0, f64::min);
            let bound = least_slope([jet(0.0), jet(1.0)], remainder);
            assert!(bound <= least && least - bound < 0.1 * theta.powi(4), "{bound} {least}");
        }
    }
}
