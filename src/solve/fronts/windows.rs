//! When a spring's force can be largest, or pass its rating first: windows, and the cells in them that are worth a look.

use std::ops::Range;

use super::forms::{self, AHEAD, Points, UNSEEN};
use super::rows::Wave;
use super::stairs::{self, ASKED, DelayedFront, Segment, Stairs};
use super::{Images, Scene, Watch};
use crate::solve::local::hermite_extremes;

/// Allowed error of cubics between samples, in units of the force, times nu^(2/3) of the nearest front: the curvature
/// of a top is 0.7 nu^(-2/3), and less would hardly narrow the looks.
const CUBIC_ERROR: f64 = 0.012;
const NARROWEST: f64 = 0.4;
const WIDEST: f64 = 2.0;
/// The parts of a cell in which its cubic is looked at, and the widest look.
const PARTS: usize = 4;
const LOOK: f64 = 1.0;

/// A stretch of a spring's force that has to be looked into, and what it can reach there in either sign.
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
    /// When a step of force sends out fronts, and its sign; the pulse's end is at the horizon where none comes before.
    steps: [[f64; 2]; 2],
    /// Cells to look into.
    pub looks: Vec<Look>,
    /// When a side that stood at its rating has certainly left it; infinite for the others.
    pub left: Vec<[f64; 2]>,
    /// Values of fronts that were computed.
    pub samples: u64,
    points: Points,
    /// The factor of each point.
    sizes: Vec<f64>,
    marks: Vec<Mark>,
    waves: Vec<Wave>,
    segments: Vec<Segment>,
    cells: Vec<Cell>,
}

/// A front on its way to a spring.
struct Front {
    order: f64,
    root: f64,
    size: f64,
    stairs: Stairs,
}

/// One sample of a spring's force.
struct Mark {
    time: f64,
    /// Which points of the forms it is made of.
    points: Range<usize>,
    /// No cell begins here.
    last: bool,
}

/// A spring's force at an instant.
#[derive(Clone, Copy, Default)]
struct Sample {
    time: f64,
    value: f64,
    slope: f64,
    /// Bound on the fourth derivative from here to the next sample.
    fourth: f64,
    /// Bound on the error.
    error_estimate: f64,
}

/// From one sample to the next.
struct Cell {
    from: f64,
    to: f64,
    /// Force and slope at both ends, and how far the force can be from the cubic between them.
    ends: [[f64; 2]; 2],
    margin: f64,
}

/// A spring of the group that is being worked on.
struct Member {
    spring: usize,
    fronts: Vec<Front>,
    goals: [Goal; 2],
    /// The sample that all others start from.
    unknown: Sample,
    marks: Range<usize>,
}

impl<'a> Windows<'a> {
    /// Nothing is known yet.
    pub fn new(scene: &'a Scene, images: &'a Images) -> Windows<'a> {
        Windows {
            scene,
            images,
            steps: [[0.0, 1.0], [scene.duration.min(scene.horizon), -1.0]],
            looks: Vec::new(),
            left: vec![[f64::INFINITY; 2]; scene.initial.len()],
            samples: 0,
            points: Points::default(),
            sizes: Vec::new(),
            marks: Vec::new(),
            waves: Vec::new(),
            segments: Vec::new(),
            cells: Vec::new(),
        }
    }

    /// Finds the cells of some springs that are worth a look.
    pub fn find(&mut self, watch: &Watch, springs: Range<usize>) {
        let mut members: Vec<Member> = springs.map(|spring| self.member(watch, spring)).collect();
        self.evaluate_points();
        let mut asked = 0;
        for member in &mut members {
            for front in &mut member.fronts {
                let shapes = &self.points.shape[asked..asked + ASKED];
                front.stairs = Stairs::new(front.order, front.root, shapes, self.scene.horizon);
                asked += ASKED;
            }
            for mark in &self.marks[member.marks.clone()] {
                let sample = self.sample(member, mark);
                member.reach(&sample);
                asked = mark.points.end;
            }
        }
        self.clear_points();
        members.iter_mut().for_each(|member| self.find_windows(watch, member));
        self.evaluate_points();
        members.iter_mut().for_each(|member| self.find_cells(member));
        self.clear_points();
    }

    fn evaluate_points(&mut self) {
        self.points.evaluate();
        self.samples += self.points.len() as u64;
    }

    fn clear_points(&mut self) {
        self.points.clear();
        self.sizes.clear();
        self.marks.clear();
    }

    /// The force at a mark.
    fn sample(&self, member: &Member, mark: &Mark) -> Sample {
        let mut sample = Sample { time: mark.time, value: self.scene.initial[member.spring], ..member.unknown };
        for (size, shape) in self.sizes[mark.points.clone()].iter().zip(&self.points.shape[mark.points.clone()]) {
            sample.value += size * shape.value;
            sample.slope += size * shape.slope;
            sample.fourth += size.abs() * shape.fourth;
            sample.error_estimate += size.abs() * shape.error_estimate;
        }
        sample
    }

    /// A spring's fronts; asks for their steps and for the force at their tops.
    fn member(&mut self, watch: &Watch, spring: usize) -> Member {
        let Scene { force, duration, horizon, .. } = *self.scene;
        self.images.waves(spring, force, &mut self.waves);
        let mut fronts = Vec::new();
        for wave in &self.waves {
            let order = 2.0 * wave.distance as f64;
            let root = order.cbrt();
            if stairs::start(order, root) > horizon {
                break;
            }
            stairs::ask(&mut self.points, order, root);
            fronts.push(Front { order, root, size: wave.size, stairs: Stairs::default() });
        }
        self.sizes.resize(self.points.len(), 0.0);
        let goals = [false, true].map(|negative| Goal::new(watch, spring, negative));
        let steps = if duration < horizon { 2.0 } else { 1.0 };
        let error_estimate = UNSEEN * steps * fronts.iter().map(|f| f.size.abs()).sum::<f64>();
        let unknown = Sample { error_estimate, ..Sample::default() };
        let first = self.marks.len();
        for [delay, _] in self.steps {
            for top in fronts.iter().map(|f| stairs::top(f.order, f.root) + delay).take_while(|&t| t <= horizon) {
                self.mark(&fronts, top, true);
            }
        }
        Member { spring, fronts, goals, unknown, marks: first..self.marks.len() }
    }

    /// Marks where a spring's force is to be sampled.
    fn find_windows(&mut self, watch: &Watch, member: &mut Member) {
        let Scene { duration, horizon, .. } = *self.scene;
        let mut delayed_fronts: Vec<DelayedFront> =
            member.fronts.iter().map(|f| DelayedFront::new(&f.stairs, 0.0, f.size)).collect();
        if duration < horizon {
            delayed_fronts.extend(member.fronts.iter().map(|f| DelayedFront::new(&f.stairs, duration, -f.size)));
        }
        let mut segments = std::mem::take(&mut self.segments);
        stairs::bound_force(&mut delayed_fronts, self.scene.initial[member.spring], duration, horizon, &mut segments);
        for (negative, goal) in [false, true].into_iter().zip(&mut member.goals) {
            segments.iter().for_each(|s| goal.reach(signed([s.low, s.high], negative)[0], s.from));
            if watch.at_rating(member.spring, negative) {
                self.find_departure(watch, (member.spring, negative), &member.fronts, goal, &segments);
            }
        }
        let first = self.marks.len();
        let mut window: Option<[f64; 2]> = None;
        for segment in &segments {
            let is_open = [false, true].into_iter().zip(&member.goals).any(|(negative, goal)| {
                goal.leaves_open(segment.from, signed([segment.low, segment.high], negative)[1])
            });
            if let Some(w) = window.filter(|_| !is_open || segment.from == duration) {
                self.window(&member.fronts, w);
                window = None;
            }
            if is_open {
                window = Some([window.map_or(segment.from, |w| w[0]), segment.to]);
            }
        }
        if let Some(w) = window {
            self.window(&member.fronts, w);
        }
        member.marks = first..self.marks.len();
        self.segments = segments;
    }

    /// A side that stands at its rating: when it has certainly left it, and from when on it matters.
    ///
    /// If the first front relieves it, the force is less than before until that front's top: at any instant fronts that have
    /// further to go are smaller, and images further away come in pairs of opposite sign, or have its sign.
    fn find_departure(
        &mut self,
        watch: &Watch,
        (spring, negative): (usize, bool),
        fronts: &[Front],
        goal: &mut Goal,
        segments: &[Segment],
    ) {
        let is_well_below_rating =
            |s: &&Segment| watch.is_well_below_rating(spring, negative, signed([s.low, s.high], negative)[1]);
        let left = segments.iter().find(is_well_below_rating).map_or(f64::INFINITY, |s| s.from);
        self.left[spring][usize::from(negative)] = left;
        let Some(first) = fronts.first() else { return };
        let is_relieved = (first.size > 0.0) == negative;
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

    /// Asks for samples over a window.
    fn window(&mut self, fronts: &[Front], [from, to]: [f64; 2]) {
        let cells = ((to - from) / self.width(fronts, from, to)).ceil().max(1.0);
        for n in 0..cells as usize {
            self.mark(fronts, from + n as f64 * ((to - from) / cells), false);
        }
        self.mark(fronts, to, true);
    }

    /// How wide cells may be in a window for cubics to be right to the [`CUBIC_ERROR`].
    fn width(&self, fronts: &[Front], from: f64, to: f64) -> f64 {
        let fourth = |time: f64| -> f64 {
            let of_step = |[delay, _]: [f64; 2]| -> f64 {
                let x = 2.0 * (time - delay);
                fronts.iter().take_while(|f| x > f.order).map(|f| forms::fourth_derivative(f.order, f.root, x)).sum()
            };
            self.steps.map(of_step).iter().sum()
        };
        let root = fronts.iter().rev().find(|f| f.order < 2.0 * to).map_or(1.0, |f| f.root);
        let cubic_error = CUBIC_ERROR / (root * root);
        (384.0 * cubic_error / fourth(from).max(fourth(to))).sqrt().sqrt().clamp(NARROWEST, WIDEST)
    }

    /// Asks for a sample.
    fn mark(&mut self, fronts: &[Front], time: f64, last: bool) {
        let first = self.points.len();
        for [delay, sign] in self.steps {
            let x = 2.0 * (time - delay);
            for front in fronts {
                if x < 0.0 || x - front.order <= -AHEAD * front.root {
                    break;
                }
                self.points.push(front.order, front.root, x);
                self.sizes.push(sign * front.size);
            }
        }
        self.marks.push(Mark { time, points: first..self.points.len(), last });
    }

    /// From the samples of a spring: the cells that are worth a look.
    fn find_cells(&mut self, member: &mut Member) {
        let mut cells = std::mem::take(&mut self.cells);
        cells.clear();
        let marks = &self.marks[member.marks.clone()];
        let mut left = Sample::default();
        for (k, mark) in marks.iter().enumerate() {
            let right = self.sample(member, mark);
            member.reach(&right);
            if k > 0 && !marks[k - 1].last {
                let cell = Cell::new(&left, &right);
                for (goal, top) in member.goals.iter_mut().zip(cell.tops()) {
                    goal.reached = goal.reached.max(top - cell.margin);
                }
                cells.push(cell);
            }
            left = right;
        }
        for cell in &cells {
            let open = |tops: [f64; 2]| {
                std::array::from_fn(|side| {
                    let upper = tops[side] + cell.margin;
                    if member.goals[side].leaves_open(cell.from, upper) { upper } else { f64::NEG_INFINITY }
                })
            };
            if open(cell.tops()) == [f64::NEG_INFINITY; 2] {
                continue;
            }
            for part in cell.parts() {
                self.list(member.spring, &part, open(part.tops()));
            }
        }
        self.cells = cells;
    }

    /// Lists a part of a cell for a look, together with the one before it if they touch.
    fn list(&mut self, spring: usize, part: &Cell, upper: [f64; 2]) {
        if upper == [f64::NEG_INFINITY; 2] {
            return;
        }
        let Cell { from, to, .. } = *part;
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

impl Member {
    /// Takes note of a sample.
    fn reach(&mut self, sample: &Sample) {
        let [draft, buff] = &mut self.goals;
        draft.reach(sample.value - sample.error_estimate, sample.time);
        buff.reach(-sample.value - sample.error_estimate, sample.time);
    }
}

impl Cell {
    fn new(left: &Sample, right: &Sample) -> Cell {
        let h = right.time - left.time;
        let fourth = left.fourth.max(right.fourth);
        // The cubic's two slope terms are at most 4/27 of the slopes each.
        let margin =
            left.error_estimate.max(right.error_estimate) * (1.0 + h * 8.0 / 27.0) + h.powi(4) / 384.0 * fourth;
        let ends = [[left.value, left.slope], [right.value, right.slope]];
        Cell { from: left.time, to: right.time, ends, margin }
    }

    /// The cubic's largest value, and that of its negative.
    fn tops(&self) -> [f64; 2] {
        let ([[a, da], [b, db]], h) = (self.ends, self.to - self.from);
        let [top, bottom] = hermite_extremes(h, [a, da], [b, db]);
        [top.value, -bottom.value]
    }

    /// The same cubic on parts of the cell.
    fn parts(&self) -> [Cell; PARTS] {
        let [[a, da], [b, db]] = self.ends;
        let h = self.to - self.from;
        let (rise, p, q) = (b - a, h * da, h * db);
        let (c2, c3) = (3.0 * rise - 2.0 * p - q, p + q - 2.0 * rise);
        let at = |k: usize| match k {
            0 => (self.from, self.ends[0]),
            PARTS => (self.to, self.ends[1]),
            _ => {
                let s = k as f64 / PARTS as f64;
                let slope = (p + s * (2.0 * c2 + s * 3.0 * c3)) / h;
                (self.from + s * h, [a + s * (p + s * (c2 + s * c3)), slope])
            }
        };
        std::array::from_fn(|k| {
            let ((from, left), (to, right)) = (at(k), at(k + 1));
            Cell { from, to, ends: [left, right], margin: self.margin }
        })
    }
}

/// What one side of a spring has to pass to be worth a look.
#[derive(Clone, Copy)]
struct Goal {
    /// What the force certainly reaches.
    reached: f64,
    /// A difference that does not matter.
    min_rise: f64,
    /// To be passed for a first exceedance; infinite where there is one from the beginning.
    rating: f64,
    /// Over this it has certainly exceeded.
    over: f64,
    /// When it has certainly exceeded; and the time before which nothing matters.
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

    fn reach(&mut self, lower: f64, by: f64) {
        self.reached = self.reached.max(lower);
        if lower > self.over {
            self.over_by = self.over_by.min(by);
        }
    }

    fn leaves_open(&self, from: f64, upper: f64) -> bool {
        from >= self.from && (upper > self.reached + self.min_rise || upper > self.rating && from <= self.over_by)
    }
}

fn signed([low, high]: [f64; 2], negative: bool) -> [f64; 2] {
    if negative { [-high, -low] } else { [low, high] }
}
