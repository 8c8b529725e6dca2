//! When a spring's force can be largest, or pass its rating first: windows, and the cells in them that are worth a look.

use super::forms::{self, Front, LANES, Lanes, Sums, UNSEEN, lanes};
use super::rows::{LOOK, Wave};
use super::stairs::{self, DelayedFront, Segment};
use super::{Images, Scene, Watch};
use crate::solve::local::{Point, hermite_top};

/// Allowed error of cubics between samples, in units of the force, times nu^(2/3) of the nearest front: the curvature
/// of a top is 0.7 nu^(-2/3), and less would hardly narrow the looks.
const CUBIC_ERROR: f64 = 0.02;
const NARROWEST: f64 = 0.4;
const WIDEST: f64 = 2.0;
/// The parts of a cell in which its cubic is looked at: none is wider than a look may be.
const PARTS: usize = 4;
const _: () = assert!(WIDEST / PARTS as f64 <= LOOK);

/// A stretch of time in which a spring's force has to be looked into, and the most that the force and its negative can reach there.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    pub spring: usize,
    pub from: f64,
    pub to: f64,
    /// Minus infinity for a side that needs no look.
    pub upper: [f64; 2],
}

/// The search for windows and cells.
pub struct Windows<'a> {
    scene: &'a Scene,
    images: &'a Images,
    /// When a step of force sends out fronts, and its sign.
    pub steps: &'a [[f64; 2]],
    /// The cube roots of nu at all distances.
    pub roots: &'a [f64],
    /// Cells to look into.
    pub looks: Vec<Look>,
    /// When a side that stood at its rating has certainly left it; infinite for the others.
    pub left: Vec<[f64; 2]>,
    /// What each side certainly reaches.
    pub reached: Vec<[f64; 2]>,
    /// Values of fronts that were computed.
    pub samples: u64,
    /// All springs' fronts, and where each spring's begin.
    pub waves: Vec<Wave>,
    pub firsts: Vec<usize>,
}

/// A spring that is being worked on.
struct Member<'a> {
    spring: usize,
    fronts: &'a [(Front, f64)],
    goals: [Goal; 2],
}

/// A spring's force at an instant.
#[derive(Clone, Copy, Default)]
struct Sample {
    time: f64,
    value: f64,
    slope: f64,
    /// Bound on the fourth derivative over the instants of its group of lanes. Between groups the larger of both is taken: within
    /// the measured margin too.
    fourth: f64,
    /// Bound on the error.
    error_estimate: f64,
    /// No cell begins here.
    last: bool,
}

impl Sample {
    /// What the force and its negative certainly reach.
    #[inline(always)]
    fn lower(&self) -> [f64; 2] {
        [self.value - self.error_estimate, -self.value - self.error_estimate]
    }
}

/// From one sample to the next.
#[derive(Clone, Copy)]
struct Cell {
    from: f64,
    to: f64,
    /// Force and slope at both ends, and how far the force can be from the cubic between them.
    ends: [[f64; 2]; 2],
    margin: f64,
}

/// Lists that are used again for every spring.
#[derive(Default)]
struct Lists {
    samples: Vec<Sample>,
    segments: Vec<Segment>,
    windows: Vec<[f64; 2]>,
    cells: Vec<(Cell, [Point; 2])>,
}

impl<'a> Windows<'a> {
    /// Nothing is known yet.
    pub fn new(scene: &'a Scene, images: &'a Images, steps: &'a [[f64; 2]], roots: &'a [f64]) -> Windows<'a> {
        let left = vec![[f64::INFINITY; 2]; scene.initial.len()];
        let (looks, reached, waves, firsts) = (Vec::new(), Vec::new(), Vec::new(), vec![0]);
        Windows { scene, images, steps, roots, looks, left, reached, samples: 0, waves, firsts }
    }

    /// Finds the cells of all springs that are worth a look.
    pub fn find(&mut self, watch: &Watch) {
        crate::solve::vectors::widest().dispatch(Search { windows: self, watch });
    }

    /// Finds those of one spring.
    #[inline(always)]
    fn find_in_spring(
        &mut self,
        watch: &Watch,
        spring: usize,
        fronts: &mut Vec<(Front, f64)>,
        delayed: &mut Vec<DelayedFront<'static>>,
        lists: &mut Lists,
    ) {
        let Scene { duration, horizon, force, .. } = *self.scene;
        let first = self.waves.len();
        self.images.waves(spring, force, &mut self.waves);
        self.firsts.push(self.waves.len());
        fronts.clear();
        delayed.clear();
        let all = stairs::all();
        for wave in &self.waves[first..] {
            let (order, root) = (2.0 * wave.distance as f64, self.roots[wave.distance]);
            if stairs::start(order, root) > horizon {
                break;
            }
            fronts.push((Front::new(order, root), wave.size));
            let (top, stairs) = (stairs::top(order, root), &all[stairs::place(wave.distance)]);
            for [delay, sign] in self.steps {
                delayed.push(DelayedFront::new(stairs, top + delay, stairs::UNIT * root, sign * wave.size));
            }
        }
        let goals = [false, true].map(|negative| Goal::new(watch, spring, negative));
        let mut member = Member { spring, fronts, goals };
        let Lists { samples, segments, windows, cells } = lists;
        stairs::bound_force(delayed, self.scene.initial[spring], duration, horizon, segments);
        samples.clear();
        for &[delay, _] in self.steps {
            for group in member.fronts.chunks(LANES) {
                let time = |f: &(Front, f64)| stairs::top(f.0.order, f.0.root) + delay;
                let count = group.iter().take_while(|f| time(f) <= horizon).count();
                if count > 0 {
                    let times = lanes(|l| time(&group[l.min(count - 1)]));
                    self.sample(&member, &times, count, samples);
                }
            }
        }
        for sample in samples.iter() {
            member.reach(sample.lower(), sample.time);
        }
        samples.clear();
        self.find_windows(watch, &mut member, segments, windows);
        for window in windows.iter() {
            self.sample_window(&member, *window, samples);
        }
        for sample in samples.iter() {
            member.reach(sample.lower(), sample.time);
        }
        self.find_cells(&mut member, samples, cells);
        self.reached.push([member.goals[0].reached, member.goals[1].reached]);
    }

    /// The force at some instants, in their order, of which the first `count` are wanted.
    #[inline(always)]
    fn sample(&mut self, member: &Member, times: &Lanes, count: usize, out: &mut Vec<Sample>) {
        let mut sums = Sums::default();
        for [delay, sign] in self.steps {
            let x = lanes(|l| 2.0 * (times[l] - delay));
            for (front, size) in member.fronts {
                if !sums.add(front, sign * size, &x) {
                    break;
                }
                self.samples += count as u64;
            }
        }
        let initial = self.scene.initial[member.spring];
        let unseen = UNSEEN * self.steps.len() as f64 * self.scene.force.abs() * member.fronts.len() as f64;
        for (l, &time) in times.iter().enumerate().take(count) {
            out.push(Sample {
                time,
                value: initial + sums.value[l],
                slope: sums.slope[l],
                fourth: sums.fourth,
                error_estimate: unseen + sums.error_estimate,
                last: false,
            });
        }
    }

    /// Finds when a spring's force can matter.
    #[inline(always)]
    fn find_windows(&mut self, watch: &Watch, member: &mut Member, segments: &[Segment], windows: &mut Vec<[f64; 2]>) {
        for (negative, goal) in [false, true].into_iter().zip(&mut member.goals) {
            segments.iter().for_each(|s| goal.reach(signed([s.low, s.high], negative)[0], s.from));
            if watch.at_rating(member.spring, negative) {
                self.find_departure(watch, (member.spring, negative), member.fronts, goal, segments);
            }
        }
        windows.clear();
        let [draft, buff] = &member.goals;
        for &Segment { from, to, low, high } in segments {
            if draft.leaves_open(from, high) | buff.leaves_open(from, -low) {
                match windows.last_mut() {
                    Some(window) if window[1] == from && from != self.scene.duration => window[1] = to,
                    _ => windows.push([from, to]),
                }
            }
        }
    }

    /// A side that stands at its rating: when it has certainly left it, and from when on it matters.
    ///
    /// If the first front relieves it, the force is less than before until that front's top: at any instant fronts that have
    /// further to go are smaller, and images further away come in pairs of opposite sign, or have its sign.
    fn find_departure(
        &mut self,
        watch: &Watch,
        (spring, negative): (usize, bool),
        fronts: &[(Front, f64)],
        goal: &mut Goal,
        segments: &[Segment],
    ) {
        let is_well_below_rating =
            |s: &&Segment| watch.is_well_below_rating(spring, negative, signed([s.low, s.high], negative)[1]);
        let left = segments.iter().find(is_well_below_rating).map_or(f64::INFINITY, |s| s.from);
        self.left[spring][usize::from(negative)] = left;
        let Some((first, size)) = fronts.first() else { return };
        let is_relieved = (*size > 0.0) == negative;
        if is_relieved && left < 0.5 * first.order {
            goal.from = left;
        } else if is_relieved && left == f64::INFINITY {
            // A look at the end shows how far it is from its rating.
            let horizon = self.scene.horizon;
            let upper = if negative { [f64::NEG_INFINITY, f64::MAX] } else { [f64::MAX, f64::NEG_INFINITY] };
            let from = (horizon - LOOK).max(if horizon > self.scene.duration { self.scene.duration } else { 0.0 });
            self.looks.push(Look { spring, from: from.max(0.0), to: horizon, upper });
        }
    }

    /// Samples a window.
    #[inline(always)]
    fn sample_window(&mut self, member: &Member, [from, to]: [f64; 2], out: &mut Vec<Sample>) {
        let cells = ((to - from) / self.width(member.fronts, to)).ceil().max(1.0);
        let marks = cells as usize + 1;
        let time = |n: usize| if n + 1 < marks { from + n as f64 * ((to - from) / cells) } else { to };
        for first in (0..marks).step_by(LANES) {
            let times = lanes(|l| time(first + l));
            self.sample(member, &times, (marks - first).min(LANES), out);
        }
        if let Some(sample) = out.last_mut() {
            sample.last = true;
        }
    }

    /// How wide cells may be in a window up to an instant for cubics to be right to the [`CUBIC_ERROR`].
    #[inline(always)]
    fn width(&self, fronts: &[(Front, f64)], to: f64) -> f64 {
        let mut fourth = 0.0;
        for [delay, _] in self.steps {
            let x = 2.0 * (to - delay);
            for (front, _) in fronts.iter().take_while(|f| x > f.0.order) {
                fourth += forms::fourth_derivative(front.order, front.root, x);
            }
        }
        let root = fronts.iter().rev().find(|f| f.0.order < 2.0 * to).map_or(1.0, |f| f.0.root);
        let cubic_error = CUBIC_ERROR / (root * root);
        (384.0 * cubic_error / fourth).sqrt().sqrt().clamp(NARROWEST, WIDEST)
    }

    /// From the samples of a spring: the cells that are worth a look.
    #[inline(always)]
    fn find_cells(&mut self, member: &mut Member, samples: &[Sample], cells: &mut Vec<(Cell, [Point; 2])>) {
        cells.clear();
        for pair in samples.windows(2).filter(|pair| !pair[0].last) {
            let cell = Cell::new(&pair[0], &pair[1]);
            let tops = member.tops_if_open(&cell);
            for (goal, top) in member.goals.iter_mut().zip(&tops) {
                goal.reached = goal.reached.max(top.value - cell.margin);
            }
            if member.open(&cell, &tops) != CLOSED {
                cells.push((cell, tops));
            }
        }
        for (cell, tops) in cells.iter() {
            let upper = member.open(cell, tops);
            if upper == CLOSED {
                continue;
            }
            if let Some(part) = member.around_top(cell, tops, upper) {
                self.list(member.spring, part, upper);
                continue;
            }
            for part in cell.parts() {
                let upper = member.open(&part, &member.tops_if_open(&part));
                if upper != CLOSED {
                    self.list(member.spring, [part.from, part.to], upper);
                }
                let value = part.ends[1][0];
                member.reach([value - part.margin, -value - part.margin], part.to);
            }
        }
    }

    /// Lists a part of a cell for a look; if it touches the last one listed and both fit in one look, they become one.
    #[inline(always)]
    fn list(&mut self, spring: usize, [from, to]: [f64; 2], upper: [f64; 2]) {
        let starts_anew = from == self.scene.duration;
        match self.looks.last_mut() {
            Some(look) if look.spring == spring && look.to == from && !starts_anew && to - look.from <= LOOK => {
                look.to = to;
                (0..2).for_each(|side| look.upper[side] = look.upper[side].max(upper[side]));
            }
            _ => self.looks.push(Look { spring, from, to, upper }),
        }
    }
}

struct Search<'a, 'b> {
    windows: &'b mut Windows<'a>,
    watch: &'b Watch,
}

impl pulp::WithSimd for Search<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let (mut fronts, mut delayed, mut lists) = (Vec::new(), Vec::new(), Lists::default());
        for spring in 0..self.windows.scene.initial.len() {
            self.windows.find_in_spring(self.watch, spring, &mut fronts, &mut delayed, &mut lists);
        }
    }
}

/// No side can matter.
const CLOSED: [f64; 2] = [f64::NEG_INFINITY; 2];

impl Member<'_> {
    /// Takes note of what the force and its negative certainly reach by some time.
    #[inline(always)]
    fn reach(&mut self, lower: [f64; 2], by: f64) {
        self.goals[0].reach(lower[0], by);
        self.goals[1].reach(lower[1], by);
    }

    /// The top of a cell's cubic, and that of its negative, on sides where they can matter.
    #[inline(always)]
    fn tops_if_open(&self, cell: &Cell) -> [Point; 2] {
        let ([[a, da], [b, db]], h) = (cell.ends, cell.to - cell.from);
        let mut tops = [Point { at: 0.0, value: f64::NEG_INFINITY }; 2];
        for (top, (goal, sign)) in tops.iter_mut().zip(self.goals.iter().zip([1.0, -1.0])) {
            let (left, right) = ([sign * a, sign * da], [sign * b, sign * db]);
            // The cubic's two slope terms are at most 4/27 of the slopes each.
            let quick = left[0].max(right[0]) + SLOPE_SHARE * h * (left[1].max(0.0) + (-right[1]).max(0.0));
            if goal.leaves_open(cell.from, quick + cell.margin) {
                *top = hermite_top(h, left, right);
            }
        }
        tops
    }

    /// What the force can reach in a cell with these tops, on sides where that can matter; elsewhere minus infinity.
    #[inline(always)]
    fn open(&self, cell: &Cell, tops: &[Point; 2]) -> [f64; 2] {
        let mut upper = CLOSED;
        for side in 0..2 {
            let top = tops[side].value + cell.margin;
            upper[side] = if self.goals[side].leaves_open(cell.from, top) { top } else { f64::NEG_INFINITY };
        }
        upper
    }

    /// Where a cell can matter that is open on one side, only for the largest value, and has a concave cubic there: around its top.
    #[inline(always)]
    fn around_top(&self, cell: &Cell, tops: &[Point; 2], upper: [f64; 2]) -> Option<[f64; 2]> {
        let (side, sign) = if upper[0] > upper[1] { (0, 1.0) } else { (1, -1.0) };
        let goal = &self.goals[side];
        let may_pass = upper[side] > goal.rating && cell.from < goal.over_by;
        if may_pass || upper[1 - side] > f64::NEG_INFINITY {
            return None;
        }
        let ([[a, da], [b, db]], h) = (cell.ends.map(|end| end.map(|v| sign * v)), cell.to - cell.from);
        // The larger of the second derivatives at both ends.
        let bend = (6.0 * (b - a) / h - 4.0 * da - 2.0 * db).max(6.0 * (a - b) / h + 2.0 * da + 4.0 * db) / h;
        if bend >= 0.0 {
            return None;
        }
        let at = cell.from + tops[side].at;
        let width = (2.0 * (upper[side] - goal.reached) / -bend).sqrt();
        let [from, to] = [(at - width).max(cell.from), (at + width).min(cell.to)];
        (to - from <= LOOK).then_some([from, to])
    }
}

const SLOPE_SHARE: f64 = 4.0 / 27.0;

impl Cell {
    #[inline(always)]
    fn new(left: &Sample, right: &Sample) -> Cell {
        let h = right.time - left.time;
        let fourth = left.fourth.max(right.fourth);
        let square = h * h;
        let margin = left.error_estimate.max(right.error_estimate) * (1.0 + 2.0 * SLOPE_SHARE * h)
            + square * square * (1.0 / 384.0) * fourth;
        let ends = [[left.value, left.slope], [right.value, right.slope]];
        Cell { from: left.time, to: right.time, ends, margin }
    }

    /// The same cubic on parts of the cell.
    #[inline(always)]
    fn parts(&self) -> [Cell; PARTS] {
        let [[a, da], [b, db]] = self.ends;
        let h = self.to - self.from;
        let (rise, p, q) = (b - a, h * da, h * db);
        let (c2, c3) = (3.0 * rise - 2.0 * p - q, p + q - 2.0 * rise);
        let mut parts = [*self; PARTS];
        for k in 1..PARTS {
            let s = k as f64 / PARTS as f64;
            let end = [a + s * (p + s * (c2 + s * c3)), (p + s * (2.0 * c2 + s * 3.0 * c3)) / h];
            let time = self.from + s * h;
            (parts[k - 1].to, parts[k - 1].ends[1]) = (time, end);
            (parts[k].from, parts[k].ends[0]) = (time, end);
        }
        parts
    }
}

/// What one side of a spring has to pass to be worth a look.
#[derive(Clone, Copy)]
struct Goal {
    /// What the force certainly reaches.
    reached: f64,
    /// A difference that does not matter.
    min_rise: f64,
    /// To be passed for a first exceedance.
    rating: f64,
    /// Over this it has certainly exceeded.
    over: f64,
    /// By when it has certainly exceeded, minus infinity if before the event; and the time before which nothing matters.
    over_by: f64,
    from: f64,
}

impl Goal {
    fn new(watch: &Watch, spring: usize, negative: bool) -> Goal {
        let side = watch.peaks[spring].side(negative);
        let cautious = watch.cautious_rating(spring, negative);
        let at_rating = watch.at_rating(spring, negative);
        Goal {
            reached: side.best.value,
            min_rise: watch.min_rise(),
            rating: if at_rating { cautious.max(side.best.value + watch.min_rise()) } else { cautious },
            over: watch.rating(spring, negative) + watch.bound(),
            over_by: if side.first_over.is_some() { f64::NEG_INFINITY } else { f64::INFINITY },
            from: 0.0,
        }
    }

    #[inline(always)]
    fn reach(&mut self, lower: f64, by: f64) {
        self.reached = self.reached.max(lower);
        if lower > self.over {
            self.over_by = self.over_by.min(by);
        }
    }

    #[inline(always)]
    fn leaves_open(&self, from: f64, upper: f64) -> bool {
        let is_first = (upper > self.rating) & (from < self.over_by);
        (from >= self.from) & ((upper > self.reached + self.min_rise) | is_first)
    }
}

#[inline(always)]
fn signed([low, high]: [f64; 2], negative: bool) -> [f64; 2] {
    if negative { [-high, -low] } else { [low, high] }
}
