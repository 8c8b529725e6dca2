//! The response of every spring to a unit step or pulse of force, from which every load and every rating can be judged.
//!
//! `F_i(t) = F_i(0) + f R_i(t)`, and R depends on the chain, the source of the force and its duration alone. Of R and of -R the records are
//! kept: each step of a march in which it rises above all that came before, with its largest value there. The largest force is that at the
//! last record; it first passes its rating in the first record over the level `(rating - F_i(0)) / |f|`, and the
//! instant follows from the forces at both ends of that step, as along a march ([`super::pieces`]).
//!
//! A front that passes brings a record in each of many steps, at the ends of all but the last of these. Of such a run the last record
//! is kept; the others are among the forces at the steps' ends, which are kept around the springs with a record.
//!
//! Bound: |f| times that of R, and the rounding of the product and of the sum.

use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

use pulp::Simd;

use super::lanes::{Aligned, LANES, Layout, Rows};
use super::local::{Local, Point};
use super::motion::{Motion, bracket, slopes};
use super::pieces::{Step, around, piece};
use super::propagator::{self, Marched, StepKind, StepObserver, march};
use super::view::View;
use super::watch::{Side, SpringPeaks, bound_of_extremes};
use super::{Ask, Method, Solution, Wanted, Work};
use crate::chain::Scene;

/// A rise under this share of the error bound is no record.
const MIN_RISE: f64 = 0.125;
/// A spring this many error bounds or less under its rating counts as standing at it: it needs a march of its own.
const AT_RATING: f64 = 8.0;

/// The response of a scene's springs to a unit forward force.
#[derive(Debug)]
pub struct UnitResponse {
    motion: Motion,
    horizon: f64,
    /// No value is further than this from that of the exact response.
    bound: f64,
    /// The largest value of any spring.
    largest: f64,
    /// Steps with a record.
    steps: Vec<Kept>,
    forces: Forces,
    /// Records of R and of -R, spring by spring.
    runs: Vec<[Vec<Run>; 2]>,
    /// The horizon and the mark that were asked for last, and the largest R and -R up to them.
    latest: Mutex<Option<([f64; 2], Tops)>>,
}

/// A step, and the number of the instant at its beginning; the next one is at its end.
#[derive(Debug)]
struct Kept {
    step: Step,
    instant: u32,
}

/// Forces at instants, of the springs from the first to the last that are needed, one behind the other.
#[derive(Debug, Default)]
struct Forces {
    values: Vec<f64>,
    /// The first spring of each instant, and the place of its force.
    first: Vec<[u32; 2]>,
}

/// The largest value of a side up to the horizon, and up to the mark: 0 at t = 0 before the first record.
type Top = [Point; 2];

/// Those of R and of -R, spring by spring.
type Tops = Arc<[[Top; 2]]>;

/// Records in steps that follow each other, by their numbers among those that are kept: new largest values, each at the end of its step but
/// for the last one, `top`.
#[derive(Clone, Copy, Debug)]
struct Run {
    first: u32,
    last: u32,
    top: Point,
}

/// How a scene's forces follow from a response: counted from the other end, in other units of time.
#[derive(Clone, Copy, Debug)]
pub struct Mapping {
    /// The response is of the scene counted from the other end, where forward is backward.
    pub mirrored: bool,
    /// The response's unit of time, where it is not the scene's.
    pub time: Option<f64>,
}

/// A side that certainly passes its rating after t = 0: which, and in which of the steps that are kept.
struct Passing {
    spring: usize,
    negative: bool,
    step: u32,
}

impl UnitResponse {
    /// Marches through a scene whose force is 1, the unit forward force. Its forces before the event must be 0; its ratings play no part.
    pub fn new(scene: &Scene, omega_max: f64) -> UnitResponse {
        let springs = scene.initial.len();
        let motion = Motion::new(scene);
        let bound = propagator::error_bound(scene, omega_max);
        let min_rise = MIN_RISE * bound;
        let rise = std::iter::repeat_n(min_rise, springs);
        let layout = Layout::new(&[springs]);
        let mut levels = [0, 1].map(|_| Aligned::new(layout.len(), f64::INFINITY));
        levels.iter_mut().for_each(|row| layout.put(row, 0, rise.clone()));
        let (steps, forces, runs) = (Vec::new(), Forces::default(), vec![Default::default(); springs]);
        let (horizon, found, kept) = (scene.horizon, NO_SPRINGS, NO_SPRINGS);
        let mut recorder =
            Recorder { horizon, motion: &motion, levels, min_rise, last: u64::MAX, found, kept, steps, forces, runs };
        let marched = Marched { scene, motion: &motion, omega: omega_max };
        march(&[marched], StepKind::exact(propagator::KICK_TERMS), &mut recorder);
        let Recorder { mut steps, mut forces, mut runs, .. } = recorder;
        steps.shrink_to_fit();
        forces.values.shrink_to_fit();
        forces.first.shrink_to_fit();
        runs.iter_mut().flatten().for_each(Vec::shrink_to_fit);
        let tops = runs.iter().flatten().filter_map(|of_side| Some(of_side.last()?.top.value));
        let largest = tops.fold(0.0, f64::max);
        let latest = Mutex::default();
        UnitResponse { horizon, bound: bound_of_extremes(bound), largest, steps, forces, runs, latest, motion }
    }

    /// Approximate memory, bytes.
    pub fn bytes(&self) -> usize {
        let runs: usize = self.runs.iter().flatten().map(|of_side| size_of_val(of_side.as_slice())).sum();
        let forces = size_of_val(&*self.forces.values) + size_of_val(&*self.forces.first);
        let of_spring = size_of::<[Vec<Run>; 2]>() + size_of::<[Top; 2]>() + size_of::<[f64; 6]>();
        size_of::<UnitResponse>() + runs + forces + size_of_val(&*self.steps) + self.runs.len() * of_spring
    }

    /// Extremes of the springs of a scene whose response this is, of those alone that matter where the worst is wanted; `None` where its
    /// bound is over the tolerance, or a spring's force before the event is its rating, or less by no more than a few bounds.
    pub fn solution(&self, scene: &Scene, ask: &Ask, mapping: Mapping) -> Option<Solution> {
        let size = scene.force.abs();
        let bound = self.bound_of(scene, mapping);
        if bound > ask.tolerance {
            return None;
        }
        let springs = scene.initial.len();
        let turned = (scene.force < 0.0) != mapping.mirrored;
        let place = |i: usize| if mapping.mirrored { springs - 1 - i } else { i };
        let (unit, mark) = (mapping.time.unwrap_or(1.0), ask.mark.unwrap_or(scene.horizon));
        let tops = self.tops([scene.horizon, mark].map(|until| mapping.in_its_unit(until)));
        // Up to the horizon and to the mark: the largest utilisation.
        let (mut most, mut least_rating) = ([0.0f64; 2], f64::INFINITY);
        for i in 0..springs {
            for negative in [false, true] {
                let (before, rating) = before(scene, i, negative);
                if before <= rating && before > rating - AT_RATING * bound {
                    return None;
                }
                let top = &tops[place(i)][usize::from(negative != turned)];
                most = [0, 1].map(|until| most[until].max((before + size * top[until].value) / rating));
                least_rating = least_rating.min(rating);
            }
        }
        // Of the worst alone: a spring below these, and below its rating, is certainly not wanted.
        let least = most.map(|most| most - 4.0 * bound / least_rating);
        let is_wanted = |i: usize| {
            [false, true].into_iter().any(|negative| {
                let (before, rating) = before(scene, i, negative);
                let top = &tops[place(i)][usize::from(negative != turned)];
                let reaches =
                    |until: usize| before + size * top[until].value >= (least[until] * rating).min(rating - bound);
                before > rating || reaches(0) || reaches(1)
            })
        };
        let mut peaks = vec![None; springs];
        let mut to_mark = vec![None; if ask.mark.is_some() { springs } else { 0 }];
        let (mut passing, mut over_at_once) = (Vec::new(), false);
        for i in (0..springs).filter(|&i| ask.wanted == Wanted::Everything || is_wanted(i)) {
            let of_spring = &tops[place(i)];
            let mut side = |negative: bool| {
                let top = &of_spring[usize::from(negative != turned)];
                let (before, rating) = before(scene, i, negative);
                let largest = |top: Point, until: f64| {
                    let value = before + size * top.value;
                    Point { at: if value > before { (unit * top.at).min(until) } else { 0.0 }, value }
                };
                let (best, first) = (largest(top[0], scene.horizon), (before > rating).then_some(0.0));
                over_at_once |= first.is_some();
                if first.is_none() && best.value > rating + bound {
                    let over = |value: f64| before + size * value > rating + bound;
                    let step = self.first_over(place(i), negative != turned, over);
                    passing.push(Passing { spring: i, negative, step });
                }
                let up_to = |best: Point| Side::known(best, first, best.value > rating - bound);
                [up_to(best), up_to(largest(top[1], mark))]
            };
            let [draft, buff] = [side(false), side(true)];
            peaks[i] = Some(SpringPeaks { draft: draft[0], buff: buff[0] });
            if let Some(to_mark) = to_mark.get_mut(i) {
                *to_mark = Some(SpringPeaks { draft: draft[1], buff: buff[1] });
            }
        }
        // For the worst only the earliest exceedance of all must be exact.
        let earliest = if over_at_once { None } else { passing.iter().map(|p: &Passing| p.step).min() };
        for Passing { spring, negative, step } in passing {
            let is_exact = ask.wanted == Wanted::Everything || Some(step) == earliest;
            let at = if is_exact {
                let (before, rating) = before(scene, spring, negative);
                self.passes(step, place(spring), negative != turned, (rating - before) / size)
            } else {
                self.steps[step as usize].step.end()
            };
            let over = |peaks: &mut SpringPeaks, until: f64| {
                let side = if negative { &mut peaks.buff } else { &mut peaks.draft };
                side.first_over = Some((unit * at).min(until));
            };
            peaks[spring].iter_mut().for_each(|peaks| over(peaks, scene.horizon));
            let rating = before(scene, spring, negative).1;
            let by_mark = |peaks: &&mut SpringPeaks| peaks.side(negative).best.value > rating + bound;
            to_mark.get_mut(spring).into_iter().flatten().filter(by_mark).for_each(|peaks| over(peaks, mark));
        }
        Some(Solution {
            method: Method::Propagator,
            reason: "from the response to a unit force, which other loads and ratings share".to_owned(),
            error_bound: bound,
            springs: peaks,
            to_mark,
            only_worst: false,
            all_time_bounds: None,
            work: Work::default(),
        })
    }

    /// Bound on the error of a scene's forces.
    ///
    /// In other units of time the response is that of a horizon which is moved by six roundings of it, for each of a pulse's two steps,
    /// and of a duration moved by as much; R changes by at most 1 per unit of time: a unit impulse gives a unit mass the energy 1/2,
    /// and a spring of stiffness 1 never stores more.
    fn bound_of(&self, scene: &Scene, mapping: Mapping) -> f64 {
        let size = scene.force.abs();
        let initial = scene.initial.iter().fold(0.0f64, |a, f| a.max(f.abs()));
        let units = mapping.time.map_or(0.0, |_| f64::EPSILON * (2.0 * self.largest + 12.0 * self.horizon));
        size * (self.bound + units) + f64::EPSILON * (initial + 2.0 * size * self.largest)
    }

    /// The largest R and -R up to a horizon and up to a mark.
    fn tops(&self, until: [f64; 2]) -> Tops {
        let mut latest = self.latest.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, tops)) = latest.as_ref().filter(|(known, _)| *known == until) {
            return tops.clone();
        }
        let springs = 0..self.runs.len();
        let [horizon, mark] = until.map(|until| {
            // Steps that end by then; the last one may round to end just before or behind the horizon.
            let is_all = until >= self.horizon * (1.0 - 8.0 * f64::EPSILON);
            let ended = self.steps.partition_point(|kept| is_all || kept.step.end() <= until);
            let top = |s: usize, negative: bool| self.top(s, negative, ended as u32, until);
            springs.clone().map(|s| [top(s, false), top(s, true)]).collect::<Vec<_>>()
        });
        let tops: Tops = springs.map(|s| [0, 1].map(|side| [horizon[s][side], mark[s][side]])).collect();
        *latest = Some((until, tops.clone()));
        tops
    }

    /// The largest value of a side up to an instant by which `ended` kept steps have ended.
    fn top(&self, spring: usize, negative: bool, ended: u32, until: f64) -> Point {
        let runs = &self.runs[spring][usize::from(negative)];
        let (begun, later) = runs.split_at(runs.partition_point(|run| run.first < ended));
        let best = begun.last().map_or(Point { at: 0.0, value: 0.0 }, |run| {
            if run.last < ended {
                run.top
            } else {
                self.forces.at_end(&self.steps[ended as usize - 1], spring, negative)
            }
        });
        let is_cut =
            begun.last().is_some_and(|run| run.last >= ended) || later.first().is_some_and(|run| run.first == ended);
        let cut = is_cut.then(|| self.force(ended, spring, negative)).and_then(|local| {
            let end = ((until - local.center) / local.radius).min(1.0);
            let top = if end > -1.0 { local.largest(-1.0, end, best.value) } else { None }?;
            Some(Point { at: local.time(top.at), value: top.value })
        });
        cut.unwrap_or(best)
    }

    /// The first step with a record of a side for whose value `over` holds; the last record is one.
    fn first_over(&self, spring: usize, negative: bool, over: impl Fn(f64) -> bool) -> u32 {
        let runs = &self.runs[spring][usize::from(negative)];
        let run = runs.partition_point(|run| !over(run.top.value)).min(runs.len() - 1);
        let Run { first, last, .. } = runs[run];
        let is_under = |kept: &Kept| !over(self.forces.at_end(kept, spring, negative).value);
        first + self.steps[first as usize..last as usize].partition_point(is_under) as u32
    }

    /// A side's response over a step in which it has a record.
    fn force(&self, step: u32, spring: usize, negative: bool) -> Local {
        let Kept { step, instant } = &self.steps[step as usize];
        let local = piece(&self.motion, step, spring, |end, s| self.forces.at(*instant as usize + end, s));
        if negative { local.negated() } else { local }
    }

    /// When a side passes a level, which it does in a step with a record.
    fn passes(&self, step: u32, spring: usize, negative: bool, level: f64) -> f64 {
        let local = self.force(step, spring, negative);
        local.time(local.first_over(-1.0, 1.0, level).unwrap_or(1.0))
    }
}

impl Mapping {
    /// A time in the response's unit. Whole transits are whole numbers but for roundoff.
    pub(crate) fn in_its_unit(self, time: f64) -> f64 {
        let Some(unit) = self.time else { return time };
        let (own, whole) = (time / unit, (time / unit).round());
        if (own - whole).abs() <= 4.0 * f64::EPSILON * whole { whole } else { own }
    }
}

/// A side's force before the event, and its rating.
fn before(scene: &Scene, spring: usize, negative: bool) -> (f64, f64) {
    if negative {
        (-scene.initial[spring], scene.rated_buff[spring])
    } else {
        (scene.initial[spring], scene.rated_draft[spring])
    }
}

impl Forces {
    fn at(&self, instant: usize, spring: usize) -> f64 {
        let [first, place] = self.first[instant];
        self.values[place as usize + spring - first as usize]
    }

    /// A side's response at the end of a step.
    fn at_end(&self, Kept { step, instant }: &Kept, spring: usize, negative: bool) -> Point {
        let value = self.at(*instant as usize + 1, spring);
        Point { at: step.end(), value: if negative { -value } else { value } }
    }

    fn add(&mut self, springs: &Range<usize>, force: impl Fn(usize) -> f64) {
        self.first.push([springs.start as u32, self.values.len() as u32]);
        self.values.extend(springs.clone().map(force));
    }
}

/// The springs from the first to the last of two ranges.
fn hull(a: &Range<usize>, b: &Range<usize>) -> Range<usize> {
    a.start.min(b.start)..a.end.max(b.end)
}

const NO_SPRINGS: Range<usize> = Range { start: usize::MAX, end: 0 };

/// Takes the records out of a march.
struct Recorder<'a> {
    horizon: f64,
    motion: &'a Motion,
    /// Per sign and spring: what R, or -R, has to pass for a record; laid out in lanes.
    levels: [Aligned; 2],
    min_rise: f64,
    /// The step whose end is the last instant of the forces.
    last: u64,
    /// The springs that records of this step need, and those of the last step that is kept.
    found: Range<usize>,
    kept: Range<usize>,
    steps: Vec<Kept>,
    forces: Forces,
    runs: Vec<[Vec<Run>; 2]>,
}

impl StepObserver for Recorder<'_> {
    #[inline(always)]
    fn see<S: Simd, const H: usize>(&mut self, rows: Rows<S, H>, view: &View) {
        let whole = view.whole_energy();
        for block in 0..view.layout.blocks() {
            let bounds = view.norms(block, whole);
            for row in view.open_rows(rows, &self.levels, block, bounds[0]) {
                let Some((open, remainders)) = view.open_springs([&self.levels; 2], row, bounds, [false; LANES]) else {
                    continue;
                };
                for lane in (0..LANES).filter(|&lane| open[lane] > 0.0) {
                    self.record(view, view.layout.number(row, lane), remainders[lane]);
                }
            }
        }
        if !self.found.is_empty() {
            self.keep(view);
        }
    }
}

impl Recorder<'_> {
    /// Notes a spring's records in a step.
    #[inline]
    fn record(&mut self, view: &View, spring: usize, remainder: f64) {
        let step = &view.step(0);
        let at = |end: usize, s: usize| view.force(end, 0, s);
        let place = view.layout.place(0, spring);
        let ends = view.even_derivatives(self.motion, [0, spring]);
        for negative in [false, true] {
            let sign = if negative { -1.0 } else { 1.0 };
            let ends = ends.map(|even_derivatives| even_derivatives.map(|x| sign * x));
            let level = self.levels[usize::from(negative)][place];
            if bracket(ends, remainder)[1] <= level {
                continue;
            }
            let top = if slopes(ends, remainder)[0] > 0.0 {
                Some(Point { at: step.end(), value: ends[1][0] }).filter(|end| end.value > level)
            } else {
                let local = piece(self.motion, step, spring, at);
                let local = if negative { local.negated() } else { local };
                let end = ((self.horizon - local.center) / local.radius).min(1.0);
                local.largest(-1.0, end, level).map(|top| Point { at: local.time(top.at), value: top.value })
            };
            let Some(top) = top else { continue };
            self.levels[usize::from(negative)][place] = top.value + self.min_rise;
            self.found = hull(&self.found, &around(self.runs.len(), spring).1);
            let this = self.steps.len() as u32;
            let runs = &mut self.runs[spring][usize::from(negative)];
            match (runs.last_mut(), self.steps.last()) {
                // The record in the step before is at its end.
                (Some(run), Some(before))
                    if run.last + 1 == this && run.top == self.forces.at_end(before, spring, negative) =>
                {
                    (run.last, run.top) = (this, top);
                }
                _ => runs.push(Run { first: this, last: this, top }),
            }
        }
    }

    /// Keeps the forces at both ends of a step, around springs with a record in it.
    fn keep(&mut self, view: &View) {
        let step = view.step(0);
        let mut before = self.found.clone();
        // The end of the step before is the beginning of this one.
        if step.number > 0 && self.last == step.number - 1 {
            before = hull(&before, &self.kept);
            let place = self.forces.first.pop().map_or(0, |[_, place]| place);
            self.forces.values.truncate(place as usize);
        }
        self.steps.push(Kept { step, instant: self.forces.first.len() as u32 });
        self.forces.add(&before, |s| view.force(0, 0, s));
        self.forces.add(&self.found, |s| view.force(1, 0, s));
        (self.last, self.kept) = (step.number, std::mem::replace(&mut self.found, NO_SPRINGS));
    }
}

#[cfg(test)]
mod tests;
