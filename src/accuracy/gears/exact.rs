//! A reference for trains with slack, gears and brake waves: a march from event to event in double-double numbers (31 digits), in
//! equations of its own.
//!
//! ```text
//! x_j' = v_j     m_j v_j' = F_{j-1} - F_j + p_j(t)     F_i = the law of coupler i, clamped between its curves over q_i
//! q_i = q_i(0) + x_i - x_{i+1}
//! ```
//!
//! A step is a Taylor series of degree `DEGREE` over a phase of at most `GearReference::PHASE`, whose first term left out is 1e-30 of the
//! motion; it ends at the first event, found by Bernstein coefficients in double precision and by Newton's method in double-double. An
//! event counts once the elongation is 1e-26 of the train's scale past it. Two marches with other steps tell the
//! reference's error: [`GearReference::doubt_n`].

use super::curves::{Curves, Line};
use super::outside::{GearCourse, Outside, Shape};
use super::roots;
use crate::accuracy::bench::difference;
use crate::march::Problem;
use crate::solve::dd::Dd;

/// The series' last power.
const DEGREE: usize = 26;
/// An event counts this share of the scale of elongations past its place.
const PAST: f64 = 1e-26;
/// More steps than this are given up.
const MOST_STEPS: u64 = 3_000_000;

/// One coupler's largest forces, N: of F and of -F.
pub type Largest = [Dd; 2];

/// What a march in double-double numbers found.
#[derive(Clone, Debug)]
pub struct GearFound {
    /// Of each coupler; one that is gone from t = 0 begins with what its vehicles push.
    pub largest: Vec<Largest>,
    /// Forces at the asked instants: a row per instant.
    pub forces: Vec<Vec<Dd>>,
    /// Couplers that parted after t = 0, and when, s.
    pub parted: Vec<(usize, f64)>,
    /// Steps taken.
    pub steps: u64,
}

/// The exact motion of a problem, with what is known of its own error.
#[derive(Clone, Debug)]
pub struct GearReference {
    /// Of the march with the smaller steps.
    pub found: GearFound,
    /// The largest difference of any largest force, or force at an instant, between two marches with other steps, N; infinite where
    /// other couplers parted.
    pub doubt_n: f64,
}

/// More steps than a comparison is worth.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the reference took {MOST_STEPS} steps up to t = {at_s} s")]
pub struct TooManySteps {
    /// Where it was given up, s.
    pub at_s: f64,
}

impl GearReference {
    /// Largest step times the largest rate, of the two marches.
    pub(crate) const PHASE: [f64; 2] = [0.8, 0.61];

    /// Of a problem up to its horizon, with forces at instants, in order.
    ///
    /// # Errors
    /// [`TooManySteps`].
    pub fn new(problem: &Problem, times: &[f64]) -> Result<GearReference, TooManySteps> {
        let [coarse, found] = Self::PHASE.map(|phase| march(problem, times, phase));
        let (coarse, found) = (coarse?, found?);
        let apart = |a: &Dd, b: &Dd| (*a - *b).abs().hi;
        let peaks = coarse.largest.iter().flatten().zip(found.largest.iter().flatten());
        let instants = coarse.forces.iter().flatten().zip(found.forces.iter().flatten());
        let doubt_n = peaks.chain(instants).map(|(a, b)| apart(a, b)).fold(0.0, f64::max);
        let order = |f: &GearFound| f.parted.iter().map(|p| p.0).collect::<Vec<_>>();
        let same = order(&coarse) == order(&found);
        Ok(GearReference { found, doubt_n: if same { doubt_n } else { f64::INFINITY } })
    }

    /// The largest error of given largest F and largest -F of each coupler, N.
    pub fn peak_error_n(&self, largest: &[[f64; 2]]) -> f64 {
        let pairs = self.found.largest.iter().flatten().zip(largest.iter().flatten());
        pairs.map(|(exact, found)| difference(*found, *exact)).fold(0.0, f64::max)
    }
}

/// How a coupler's force follows its elongation.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mode {
    /// At slope kl between the curves, up to elongations on either.
    Between([Dd; 2]),
    /// On the upper (0) or the lower (1) curve, in an interval.
    On(usize, usize),
    /// Where both are one, in an interval.
    Free(usize),
}

/// What ends a step.
#[derive(Clone, Copy, Debug)]
enum Event {
    /// Passes the upper (0) or lower (1) end of its mode.
    End(usize),
    /// Reverses on a curve.
    Turn,
    Breaks,
}

struct Coupler {
    curves: Curves,
    mode: Mode,
    line: Line,
    dashpot: Dd,
    /// Elongation at t = 0.
    start: Dd,
    whole: bool,
}

/// Follows a problem with steps of at most a phase.
///
/// # Errors
/// [`TooManySteps`].
pub fn march(problem: &Problem, times: &[f64], phase: f64) -> Result<GearFound, TooManySteps> {
    let mut motion = Motion::new(problem, times, phase);
    while motion.t < motion.end {
        if motion.found.steps == MOST_STEPS {
            return Err(TooManySteps { at_s: motion.t.hi });
        }
        motion.step();
    }
    Ok(motion.found)
}

/// Polynomials over a step of a coupler's elongation, less a place, and of its force.
type Row = [Dd; DEGREE + 1];

struct Motion<'a> {
    problem: &'a Problem,
    times: &'a [f64],
    phase: f64,
    couplers: Vec<Coupler>,
    outside: Outside,
    /// 1/m; 0 for a held vehicle.
    inverse: Vec<Dd>,
    /// Displacements and speeds.
    x: Vec<Dd>,
    v: Vec<Dd>,
    /// Sine and cosine of each half sine, by the place of its force among those of the problem.
    circle: Vec<[Dd; 2]>,
    /// Rows of coefficients over the step.
    series: [Vec<Vec<Dd>>; 2],
    t: Dd,
    end: Dd,
    mean: f64,
    past: f64,
    found: GearFound,
}

impl<'a> Motion<'a> {
    fn new(problem: &'a Problem, times: &'a [f64], phase: f64) -> Motion<'a> {
        let n = problem.mass_kg.len();
        let held = |v: usize| v == 0 && problem.held_head || v + 1 == n && problem.held_tail;
        let inverse = |v: usize| if held(v) { Dd::ZERO } else { Dd::ONE / Dd::from(problem.mass_kg[v]) };
        let couplers: Vec<Coupler> = (0..n - 1).map(|i| Coupler::new(problem, i)).collect();
        let outside = Outside::new(problem);
        let row = |v: &[f64]| v.iter().map(|v| Dd::from(*v)).collect::<Vec<Dd>>();
        let largest = problem.start.iter().map(|r| [Dd::from(r.force_n), Dd::from(-r.force_n)]).collect();
        let mut motion = Motion {
            times,
            phase,
            inverse: (0..n).map(inverse).collect(),
            x: vec![Dd::ZERO; n],
            v: row(&problem.speed_m_s),
            circle: vec![[Dd::ZERO, Dd::ONE]; problem.forcing.len()],
            outside,
            series: [vec![vec![Dd::ZERO; n]; DEGREE + 1], vec![vec![Dd::ZERO; n]; DEGREE + 1]],
            t: Dd::ZERO,
            end: Dd::from(problem.horizon_s),
            mean: f64::INFINITY,
            past: 0.0,
            found: GearFound { largest, forces: Vec::new(), parted: Vec::new(), steps: 0 },
            couplers,
            problem,
        };
        motion.past = PAST * motion.scale();
        for &i in &problem.gone {
            let c = &mut motion.couplers[i];
            c.part(problem, i, Dd::ZERO);
            let force = c.line.at(c.start);
            motion.found.largest[i] = [force, -force];
        }
        motion
    }

    /// The longest elongation, slack or way between two vehicles in the time of an oscillation, m.
    fn scale(&self) -> f64 {
        let stiffest = |i: usize| self.couplers[i].stiffest();
        let soft = (0..self.couplers.len()).map(stiffest).fold(f64::INFINITY, f64::min);
        let rate = self.rate(|c| c.stiffest());
        let apart = self.v.windows(2).map(|v| (v[0] - v[1]).abs().hi / rate);
        let long = self.couplers.iter().map(|c| c.start.abs().hi);
        let slack = self.problem.laws.iter().map(|law| 0.5 * law.slack_m());
        let of_forces = self.problem.forcing.iter().map(|f| f.1.measures()[0]);
        let steady = self.outside.steady.iter().map(|f| f.abs().hi);
        let forces = of_forces.chain(self.problem.brakes_n()).chain(steady);
        apart.chain(long).chain(slack).chain(forces.map(|f| f / soft)).fold(0.0, f64::max)
    }

    /// Bound on the rate of the motion, 1/s.
    fn rate(&self, slope: impl Fn(&Coupler) -> f64) -> f64 {
        let of = |i: Option<usize>| i.and_then(|i| self.couplers.get(i));
        let around = |v: usize, value: &dyn Fn(&Coupler) -> f64| {
            self.inverse[v].hi * (of(v.checked_sub(1)).map_or(0.0, value) + of(Some(v)).map_or(0.0, value))
        };
        let live = 0..self.inverse.len();
        let stiff = live.clone().map(|v| around(v, &slope)).fold(0.0, f64::max);
        let drag = live.map(|v| around(v, &|c| c.dashpot.hi)).fold(0.0, f64::max);
        let sines =
            self.outside.courses.iter().map(|c| if let Shape::HalfSine(_, d) = c.shape { 4.0 / d } else { 0.0 });
        ((2.0 * stiff).sqrt() + 2.0 * drag).max(sines.fold(0.0, f64::max)).max(1e-300)
    }

    fn step(&mut self) {
        let kink = self.outside.kink(self.t).filter(|k| *k < self.end).unwrap_or(self.end);
        let left = kink - self.t;
        let wanted = (self.phase / self.rate(|c| c.line.slope.hi)).min(2.0 * self.mean);
        let ends = wanted >= left.hi;
        let width = if ends { left } else { left / Dd::from((left.hi / wanted).ceil()) };
        self.expand(width);
        let first = self.first_event();
        let share = first.map_or(Dd::ONE, |f| f.0);
        self.update_largest(share);
        let to = if first.is_none() && ends { kink } else { self.t + width * share };
        self.record(width, to);
        self.advance(width, share);
        self.t = to;
        self.found.steps += 1;
        let taken = (width * share).hi.max(1e-3 * wanted);
        self.mean = if self.mean.is_finite() { 0.8 * self.mean + 0.2 * taken } else { taken };
        if let Some((_, i, event)) = first {
            self.apply_event(i, event);
        }
    }

    /// `x_j^(q+1)`, `v_j^(q+1)` and the forces that make them, power by power.
    fn expand(&mut self, width: Dd) {
        let n = self.inverse.len();
        let [x, v] = &mut self.series;
        x[0].clone_from(&self.x);
        v[0].clone_from(&self.v);
        let courses = self.outside.courses.iter().enumerate();
        let forces: Vec<(usize, Row)> =
            courses.map(|(n, c)| (c.vehicle, in_time(c, self.circle.get(n), self.t, width))).collect();
        for q in 0..DEGREE {
            let share = width / Dd::from((q + 1) as f64);
            let mut ahead = Dd::ZERO;
            for j in 0..n {
                let behind = self.couplers.get(j).map_or(Dd::ZERO, |c| {
                    let stretch = x[q][j] - x[q][j + 1];
                    let force = if q == 0 { c.line.at(c.start + stretch) } else { c.line.slope * stretch };
                    if c.dashpot.hi > 0.0 { force + c.dashpot * (v[q][j] - v[q][j + 1]) } else { force }
                });
                let mut push = ahead - behind;
                if q == 0 {
                    push = push + self.outside.steady[j];
                }
                ahead = behind;
                v[q + 1][j] = push * self.inverse[j] * share;
                x[q + 1][j] = v[q][j] * share;
            }
            for (vehicle, series) in &forces {
                v[q + 1][*vehicle] = v[q + 1][*vehicle] + series[q] * self.inverse[*vehicle] * share;
            }
        }
    }
}

impl Motion<'_> {
    /// Elongation of a coupler less a place, over the step.
    fn elongation(&self, i: usize, place: Dd) -> Row {
        let x = &self.series[0];
        let mut row = std::array::from_fn(|q| x[q][i] - x[q][i + 1]);
        row[0] = row[0] + (self.couplers[i].start - place);
        row
    }

    /// Force of a coupler over the step.
    fn force(&self, i: usize) -> Row {
        let c = &self.couplers[i];
        let mut row = self.elongation(i, c.line.q).map(|q| c.line.slope * q);
        row[0] = row[0] + c.line.force;
        if c.dashpot.hi > 0.0 {
            let v = &self.series[1];
            row.iter_mut().enumerate().for_each(|(q, f)| *f = *f + c.dashpot * (v[q][i] - v[q][i + 1]));
        }
        row
    }

    /// The earliest event in the step: its share of it, the coupler, and what it is.
    fn first_event(&self) -> Option<(Dd, usize, Event)> {
        let mut first: Option<(Dd, usize, Event)> = None;
        let mut take = |row: &Row, past: f64, i: usize, event: Event| {
            if let Some(share) = first_over(row, past).filter(|s| first.is_none_or(|f| *s < f.0)) {
                first = Some((share, i, event));
            }
        };
        for (i, c) in self.couplers.iter().enumerate() {
            let ends = c.ends();
            let q = self.elongation(i, Dd::ZERO);
            let short = q.map(|q| q.hi);
            let swing: f64 = short[1..].iter().map(|c| c.abs()).sum();
            for (side, end) in ends.into_iter().enumerate().filter(|(_, end)| end.hi.is_finite()) {
                let sign = Dd::from([1.0, -1.0][side]);
                if ((q[0] - end) * sign).hi + swing > 0.0 {
                    let mut row = q.map(|q| q * sign);
                    row[0] = (q[0] - end) * sign;
                    take(&row, self.past, i, Event::End(side));
                }
            }
            if let Mode::On(side, _) = c.mode {
                let sign = Dd::from([-1.0, 1.0][side]);
                let mut rate: Row =
                    std::array::from_fn(
                        |k| {
                            if k < DEGREE { q[k + 1] * Dd::from((k + 1) as f64) * sign } else { Dd::ZERO }
                        },
                    );
                rate[DEGREE] = Dd::ZERO;
                take(&rate, self.past, i, Event::Turn);
            }
            let limits = self.problem.break_at_n.get(i).filter(|_| c.whole);
            for (side, limit) in limits.into_iter().flatten().enumerate().filter(|(_, limit)| limit.is_finite()) {
                let sign = Dd::from([1.0, -1.0][side]);
                let mut row = self.force(i).map(|f| f * sign);
                row[0] = row[0] - Dd::from(*limit);
                take(&row, 0.0, i, Event::Breaks);
            }
        }
        first
    }

    /// Takes the step up to a share of it into the largest forces.
    fn update_largest(&mut self, share: Dd) {
        for i in 0..self.couplers.len() {
            let row = self.force(i);
            let short = row.map(|f| f.hi);
            let bend: f64 = short[1..].iter().map(|c| c.abs()).sum();
            for side in [0, 1] {
                let sign = [1.0, -1.0][side];
                if sign * short[0] + bend >= self.found.largest[i][side].hi {
                    let force = row.map(|f| f * Dd::from(sign));
                    let top = largest(&force, share);
                    if top > self.found.largest[i][side] {
                        self.found.largest[i][side] = top;
                    }
                }
            }
        }
    }

    /// Forces at the asked instants up to the end of the step.
    fn record(&mut self, width: Dd, to: Dd) {
        while let Some(&time) = self.times.get(self.found.forces.len()).filter(|time| Dd::from(**time) <= to) {
            let s = if width.hi > 0.0 { (Dd::from(time) - self.t) / width } else { Dd::ZERO };
            let forces = (0..self.couplers.len()).map(|i| value(&self.force(i), s)).collect();
            self.found.forces.push(forces);
        }
    }

    /// Moves the state to a share of the step.
    fn advance(&mut self, width: Dd, share: Dd) {
        for (course, circle) in self.outside.courses.iter().zip(&mut self.circle) {
            if let Shape::HalfSine(_, duration) = course.shape {
                *circle = turned(*circle, duration, width).map(|row| value(&row, share));
            }
        }
        let [x, v] = &self.series;
        for (state, rows) in [(&mut self.x, x), (&mut self.v, v)] {
            for (j, state) in state.iter_mut().enumerate() {
                *state = rows.iter().rev().fold(Dd::ZERO, |sum, row| sum * share + row[j]);
            }
        }
    }
}

impl Motion<'_> {
    fn apply_event(&mut self, i: usize, event: Event) {
        let q = self.couplers[i].start + self.x[i] - self.x[i + 1];
        match event {
            Event::End(side) => self.couplers[i].pass(side),
            Event::Turn => self.couplers[i].turn(q),
            Event::Breaks => {
                self.couplers[i].part(self.problem, i, self.x[i] - self.x[i + 1]);
                self.outside.part(self.problem, i, self.t);
                self.found.parted.push((i, self.t.hi));
            }
        }
    }
}

impl Coupler {
    /// At rest.
    fn new(problem: &Problem, i: usize) -> Coupler {
        let (law, rest) = (&problem.laws[i], &problem.start[i]);
        let curves = Curves::new(law);
        let force = Dd::from(rest.force_n);
        let elastic = if rest.force_n > 0.0 { curves.lines[curves.lines.len() - 1][0] } else { curves.lines[0][0] };
        let start = Dd::from(rest.travel_m) + force / curves.solid.unwrap_or(elastic.slope);
        let dashpot = Dd::from(problem.dashpot_n_s_per_m.get(i).copied().unwrap_or(0.0));
        let line = Line { q: start, force, slope: Dd::ZERO };
        let mut coupler = Coupler { curves, mode: Mode::Free(0), line, dashpot, start, whole: true };
        coupler.stand(start, force);
        coupler
    }

    /// Its largest stiffness.
    fn stiffest(&self) -> f64 {
        let lines = self.curves.lines.iter().flatten();
        self.curves.solid.map_or_else(|| lines.map(|line| line.slope.hi).fold(0.0, f64::max), |kl| kl.hi)
    }

    /// Elongations at which its mode ends, above and under.
    fn ends(&self) -> [Dd; 2] {
        let far = [f64::INFINITY, f64::NEG_INFINITY].map(Dd::from);
        let above = |k: usize| self.curves.knots.get(k).copied().unwrap_or(far[0]);
        let under = |k: usize| k.checked_sub(1).map_or(far[1], |k| self.curves.knots[k]);
        match self.mode {
            Mode::Between(ends) => ends,
            Mode::On(0, k) => [above(k), far[1]],
            Mode::On(_, k) => [far[0], under(k)],
            Mode::Free(k) => [above(k), under(k)],
        }
    }

    /// Stands at an elongation and a force between its curves.
    fn stand(&mut self, q: Dd, force: Dd) {
        let k = self.curves.interval(q);
        match self.curves.solid.filter(|_| !self.curves.is_one(k)) {
            None => self.enter(k, 0),
            Some(slope) => {
                self.line = Line { q, force, slope };
                self.mode = Mode::Between(self.curves.reach(&self.line));
            }
        }
    }

    /// Goes along a curve of an interval.
    fn enter(&mut self, k: usize, side: usize) {
        self.mode = if self.curves.is_one(k) { Mode::Free(k) } else { Mode::On(side, k) };
        self.line = self.curves.lines[k][side];
    }

    /// Passes the upper (0) or lower (1) end of its mode.
    fn pass(&mut self, side: usize) {
        let k = match self.mode {
            Mode::Between(ends) if side == 0 => self.curves.interval(ends[0]),
            Mode::Between(ends) => self.curves.knots.partition_point(|k| *k < ends[1]),
            Mode::On(_, k) | Mode::Free(k) if side == 0 => k + 1,
            Mode::On(_, k) | Mode::Free(k) => k - 1,
        };
        self.enter(k, side);
    }

    /// Reverses on a curve.
    fn turn(&mut self, q: Dd) {
        let slope = self.curves.solid.unwrap_or(self.line.slope);
        self.line = Line { q, force: self.line.at(q), slope };
        self.mode = Mode::Between(self.curves.reach(&self.line));
    }

    /// Parts, so many metres longer than at t = 0.
    fn part(&mut self, problem: &Problem, i: usize, longer: Dd) {
        let q = self.start + longer;
        self.curves = Curves::parted(&problem.laws[i]);
        let [upper, lower] = self.curves.bounds(q);
        let force = self.line.at(q);
        let force = if force > upper { upper } else { force };
        let force = if force < lower { lower } else { force };
        (self.whole, self.dashpot) = (false, Dd::ZERO);
        self.stand(q, force);
    }
}

/// A force over time over the step.
fn in_time(course: &GearCourse, circle: Option<&[Dd; 2]>, t: Dd, width: Dd) -> Row {
    let mut row = [Dd::ZERO; DEGREE + 1];
    match (&course.shape, circle) {
        (Shape::HalfSine(peak, duration), Some(circle)) if t < Dd::from(*duration) => {
            let [sine, _] = turned(*circle, *duration, width);
            row = sine.map(|s| s * Dd::from(*peak));
        }
        (Shape::HalfSine(..), _) => {}
        (Shape::Lines { .. }, _) => {
            let [force, slope] = course.line(t);
            (row[0], row[1]) = (force, slope * width);
        }
    }
    row
}

/// Sine and cosine of a half sine's phase over the step, from those at its start.
fn turned([sine, cosine]: [Dd; 2], duration: f64, width: Dd) -> [Row; 2] {
    let phase = Dd::TWO_PI * Dd::from(0.5) / Dd::from(duration) * width;
    let mut rows = [[Dd::ZERO; DEGREE + 1]; 2];
    (rows[0][0], rows[1][0]) = (sine, cosine);
    for q in 0..DEGREE {
        let share = phase / Dd::from((q + 1) as f64);
        (rows[0][q + 1], rows[1][q + 1]) = (rows[1][q] * share, -(rows[0][q] * share));
    }
    rows
}

fn value(row: &Row, s: Dd) -> Dd {
    row.iter().rev().fold(Dd::ZERO, |sum, c| sum * s + *c)
}

/// The first share of the step at which a polynomial is over `past`.
fn first_over(row: &Row, past: f64) -> Option<Dd> {
    let mut row = *row;
    row[0] = row[0] - Dd::from(past);
    let short = row.map(|c| c.hi);
    let bracket = roots::first_positive(&short)?;
    if bracket[1] == 0.0 {
        return Some(Dd::ZERO);
    }
    let mut s = Dd::from(roots::halved(&short, bracket));
    for _ in 0..4 {
        let slope: f64 = short.iter().enumerate().skip(1).rev().fold(0.0, |sum, (q, c)| sum * s.hi + q as f64 * c);
        let step = value(&row, s) / Dd::from(slope);
        if !(slope > 0.0 && step.abs().hi < 1e-8) {
            break;
        }
        s = s - step;
    }
    Some(if s < Dd::ZERO {
        Dd::ZERO
    } else if s > Dd::ONE {
        Dd::ONE
    } else {
        s
    })
}

/// The largest value up to a share of the step.
fn largest(row: &Row, share: Dd) -> Dd {
    let mut slope = [0.0; DEGREE];
    slope.iter_mut().enumerate().for_each(|(q, s)| *s = (q + 1) as f64 * row[q + 1].hi);
    let inside = roots::all(&slope).into_iter().filter(|s| *s < share.hi).map(Dd::from);
    let values = inside.chain([Dd::ZERO, share]).map(|s| value(row, s));
    values.reduce(|a, b| if b > a { b } else { a }).unwrap_or(row[0])
}
