//! A second reference, for all that a train may have: a march through time in long arithmetic, in equations of its own.
//!
//! Unknowns are displacements and speeds of the vehicles, not forces, in SI units:
//!
//! ```text
//! x_j' = v_j        m_j v_j' = T_{j-1} - T_j + p_j + f(t) on one vehicle        x_j' = v_j' = 0 where it is held
//! T_i = T_i(0) + k_i (x_i - x_{i+1}) + c_i (v_i - v_{i+1}), 0 once it is broken
//! ```
//!
//! with p_j the steady forces from outside. A step is a Taylor series of degree `DEGREE` over at most one unit of phase: the first
//! term left out is `1 / 31! = 1e-34` of the motion, and the arithmetic has `BITS` bits. Every step is kept as the series of every
//! coupler's force, in which extremes, crossings and values at any time are found afterwards.

use std::borrow::Cow;

use super::real::{Real, real, rounded};

/// Bits of the arithmetic: 43 digits.
const BITS: usize = 144;
/// The series' last power.
const DEGREE: usize = 30;
/// Pieces of a step in which extremes and crossings are looked for.
const PIECES: usize = 12;

/// What is followed, in SI units; forces on couplers are positive in draft.
#[derive(Clone, Debug, Default)]
pub struct System {
    /// Masses, kg.
    pub mass: Vec<f64>,
    /// Whether the first and the last vehicle are held.
    pub held: [bool; 2],
    /// Stiffnesses, N/m.
    pub stiffness: Vec<f64>,
    /// Dashpots, N s/m.
    pub dashpot: Vec<f64>,
    /// Share of critical damping of every mode: forces `-D v` on the vehicles, and none in the couplers,
    /// `D = 2 ratio M^(1/2) (M^(-1/2) K M^(-1/2))^(1/2) M^(1/2)`.
    pub ratio: f64,
    /// Forces in the couplers at t = 0, N.
    pub initial: Vec<Real>,
    /// Steady forces on the vehicles from outside, N.
    pub outside: Vec<Real>,
    /// Speeds at t = 0, m/s.
    pub velocity: Vec<f64>,
    /// Vehicle on which the drive acts, from 0.
    pub source: usize,
    /// Its force over time.
    pub drive: Vec<Course>,
    /// The coupler that the event breaks.
    pub broken: Option<usize>,
    /// s
    pub horizon: f64,
}

/// A stretch of the force over time; there is none between stretches.
#[derive(Clone, Debug)]
pub enum Course {
    /// From one instant and force to another, s and N.
    Line([f64; 2], [f64; 2]),
    /// Peak, N, and duration, s, of a half sine from t = 0.
    HalfSine(f64, f64),
}

/// A step: `F_i = sum_q series[i][q] s^q`, 0 <= s <= `end`, s = (t - from) / width; empty for a broken coupler.
#[derive(Clone, Debug)]
pub struct Piece {
    from: Real,
    width: Real,
    end: Real,
    series: Vec<Vec<Real>>,
    short: Vec<Vec<f64>>,
}

/// A coupler that broke.
#[derive(Clone, Debug)]
pub struct Broke {
    /// When, s.
    pub at: f64,
    /// Which, from 0.
    pub coupler: usize,
    /// Its force, N.
    pub force: f64,
}

/// A motion from t = 0 to the horizon.
#[derive(Clone, Debug, Default)]
pub struct March {
    /// Step by step.
    pub pieces: Vec<Piece>,
    /// What broke on the way.
    pub broke: Vec<Broke>,
}

/// A long number.
pub fn long(x: f64) -> Real {
    real(x, BITS)
}

/// Follows a system; `breaks_at` gives the loads, N, at which each coupler breaks in draft and in buff, infinite for never.
pub fn march(system: &System, breaks_at: &[[f64; 2]]) -> March {
    let mut motion = Motion::new(system);
    let mut march = March::default();
    let mut ends: Vec<Real> = system.drive.iter().flat_map(Course::ends).chain([system.horizon]).map(long).collect();
    ends.retain(|t| rounded(t) > 0.0 && rounded(t) <= system.horizon);
    ends.sort();
    let mut now = long(0.0);
    for end in ends {
        while now < end {
            let steps = (rounded(&(&end - &now)) * motion.rate).ceil().max(1.0);
            let width = (&end - &now) / long(steps);
            let mut piece = motion.expand(&now, &width);
            let last = steps == 1.0;
            if let Some((coupler, share)) = first_break(&piece, breaks_at) {
                piece.end = share;
                let force = rounded(&value(&piece.series[coupler], &piece.end));
                motion.advance(&piece.end);
                now = &now + &piece.end * &width;
                motion.whole[coupler] = false;
                march.broke.push(Broke { at: rounded(&now), coupler, force });
            } else {
                motion.advance(&piece.end);
                now = if last { end.clone() } else { &now + &width };
            }
            march.pieces.push(piece);
        }
    }
    march
}

impl Course {
    fn ends(&self) -> [f64; 2] {
        match self {
            Course::Line(a, b) => [a[0], b[0]],
            Course::HalfSine(_, duration) => [0.0, *duration],
        }
    }

    /// Its series about `at` over `width`, if it acts there.
    fn series(&self, at: &Real, width: &Real) -> Option<Vec<Real>> {
        let [from, to] = self.ends();
        let middle = at + width * long(0.5);
        if middle < long(from) || middle > long(to) {
            return None;
        }
        let mut out = vec![long(0.0); DEGREE + 1];
        match self {
            Course::Line(a, b) => {
                let slope = (long(b[1]) - long(a[1])) / (long(b[0]) - long(a[0]));
                out[0] = long(a[1]) + &slope * (at - long(a[0]));
                out[1] = slope * width;
            }
            Course::HalfSine(peak, duration) => {
                let omega = long(-1.0).acos() / long(*duration);
                let (sine, cosine) = (&omega * at).sin_cos();
                let mut power = long(*peak);
                for (q, out) in out.iter_mut().enumerate() {
                    let turn = [&sine, &cosine][q % 2] * long([1.0, 1.0, -1.0, -1.0][q % 4]);
                    *out = &power * turn;
                    power = power * &omega * width / long((q + 1) as f64);
                }
            }
        }
        Some(out)
    }
}

/// The state, and the series of the step from it.
struct Motion<'a> {
    system: &'a System,
    whole: Vec<bool>,
    state: [Vec<Real>; 2],
    series: [Vec<Vec<Real>>; 2],
    inverse: Vec<Option<Real>>,
    /// D of the damping ratio; empty without one.
    drag: Vec<Vec<Real>>,
    /// Steps per second.
    rate: f64,
}

impl Motion<'_> {
    fn new(system: &System) -> Motion<'_> {
        let n = system.mass.len();
        let held = |v: usize| v == 0 && system.held[0] || v + 1 == n && system.held[1];
        let inverse: Vec<_> = (0..n).map(|v| (!held(v)).then(|| long(1.0) / long(system.mass[v]))).collect();
        // Gershgorin's bounds on the square of a frequency and on a damping rate; a sine's own frequency.
        let around = |of: &[f64], v: usize| {
            let before = if v > 0 { of[v - 1] } else { 0.0 };
            2.0 * (before + of.get(v).unwrap_or(&0.0)) / system.mass[v]
        };
        let live = || (0..n).filter(|&v| !held(v));
        let stiff = live().map(|v| around(&system.stiffness, v)).fold(0.0, f64::max).sqrt();
        let drag = live().map(|v| around(&system.dashpot, v)).fold(0.0, f64::max);
        let sine = system.drive.iter().map(|c| if let Course::HalfSine(_, d) = c { 4.0 / d } else { 0.0 });
        Motion {
            system,
            whole: (0..n - 1).map(|i| Some(i) != system.broken).collect(),
            state: [vec![long(0.0); n], system.velocity.iter().map(|v| long(*v)).collect()],
            series: [vec![], vec![]],
            drag: if system.ratio > 0.0 { modal_drag(system, &inverse) } else { vec![] },
            inverse,
            rate: (stiff * (1.0 + system.ratio) + drag).max(sine.fold(0.0, f64::max)),
        }
    }

    fn expand(&mut self, now: &Real, width: &Real) -> Piece {
        let System { stiffness, dashpot, initial, outside, source, drive, .. } = self.system;
        let (n, zero) = (self.inverse.len(), long(0.0));
        let drive: Vec<Vec<Real>> = drive.iter().filter_map(|c| c.series(now, width)).collect();
        let [mut x, mut v] = self.state.clone().map(|row| vec![row]);
        let mut force: Vec<Vec<Real>> = vec![Vec::with_capacity(DEGREE + 1); n - 1];
        for q in 0..=DEGREE {
            for i in 0..n - 1 {
                let mut f = long(stiffness[i]) * (&x[q][i] - &x[q][i + 1]);
                if dashpot[i] > 0.0 {
                    f += long(dashpot[i]) * (&v[q][i] - &v[q][i + 1]);
                }
                if q == 0 {
                    f += &initial[i];
                }
                force[i].push(if self.whole[i] { f } else { zero.clone() });
            }
            let share = width / long((q + 1) as f64);
            let faster = |j: usize| {
                let Some(inverse) = &self.inverse[j] else { return zero.clone() };
                let mut push = if j > 0 { force[j - 1][q].clone() } else { zero.clone() };
                if j + 1 < n {
                    push -= &force[j][q];
                }
                if q == 0 {
                    push += &outside[j];
                }
                if let Some(row) = self.drag.get(j) {
                    row.iter().zip(&v[q]).for_each(|(d, v)| push -= d * v);
                }
                if j == *source {
                    drive.iter().for_each(|d| push += &d[q]);
                }
                push * inverse * &share
            };
            let next = (0..n).map(faster).collect();
            // A held vehicle moves on at the speed that it has.
            let moved = v[q].iter().map(|v| v * &share);
            x.push(moved.collect());
            v.push(next);
        }
        self.series = [x, v];
        for i in (0..n - 1).filter(|&i| !self.whole[i]) {
            force[i].clear();
        }
        let short = force.iter().map(|f| f.iter().map(rounded).collect()).collect();
        Piece { from: now.clone(), width: width.clone(), end: long(1.0), series: force, short }
    }

    fn advance(&mut self, share: &Real) {
        for (state, series) in self.state.iter_mut().zip(&self.series) {
            for (j, state) in state.iter_mut().enumerate() {
                *state = series.iter().rev().fold(long(0.0), |sum, row| sum * share + &row[j]);
            }
        }
    }
}

/// D of a damping ratio, by Jacobi's rotations.
fn modal_drag(system: &System, inverse: &[Option<Real>]) -> Vec<Vec<Real>> {
    let n = inverse.len();
    let zero = || long(0.0);
    let roots: Vec<Real> = inverse.iter().map(|m| m.as_ref().map_or_else(zero, |m| m.sqrt())).collect();
    let mut a = vec![vec![zero(); n]; n];
    for (i, &k) in system.stiffness.iter().enumerate().filter(|(i, _)| Some(*i) != system.broken) {
        for (row, column, sign) in [(i, i, 1.0), (i + 1, i + 1, 1.0), (i, i + 1, -1.0), (i + 1, i, -1.0)] {
            a[row][column] += long(sign * k) * &roots[row] * &roots[column];
        }
    }
    let mut vectors: Vec<Vec<Real>> =
        (0..n).map(|i| (0..n).map(|j| long(f64::from(u8::from(i == j)))).collect()).collect();
    for (p, q) in (0..14).flat_map(|_| (0..n).flat_map(|p| (p + 1..n).map(move |q| (p, q)))) {
        if a[p][q] == zero() {
            continue;
        }
        let theta = (&a[q][q] - &a[p][p]) / (long(2.0) * &a[p][q]);
        let size = if theta < zero() { -theta.clone() } else { theta.clone() } + (&theta * &theta + long(1.0)).sqrt();
        let t = long(if theta < zero() { -1.0 } else { 1.0 }) / size;
        let c = long(1.0) / (&t * &t + long(1.0)).sqrt();
        let s = &t * &c;
        let turn = |x: &Real, y: &Real| (&c * x - &s * y, &s * x + &c * y);
        for row in a.iter_mut().chain(&mut vectors) {
            (row[p], row[q]) = turn(&row[p], &row[q]);
        }
        let (above, below) = a.split_at_mut(q);
        for (x, y) in above[p].iter_mut().zip(&mut below[0]) {
            (*x, *y) = turn(x, y);
        }
    }
    let largest = (0..n).map(|j| rounded(&a[j][j])).fold(0.0, f64::max);
    let omega = |j: usize| if rounded(&a[j][j]) > 1e-30 * largest { a[j][j].sqrt() } else { zero() };
    let omega: Vec<Real> = (0..n).map(omega).collect();
    let mass = |v: usize| inverse[v].as_ref().map_or_else(zero, |_| long(system.mass[v]).sqrt());
    let entry = |i: usize, j: usize| {
        let sum = (0..n).fold(zero(), |sum, q| sum + &vectors[i][q] * &omega[q] * &vectors[j][q]);
        long(2.0 * system.ratio) * mass(i) * sum * mass(j)
    };
    (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect()
}

fn value(series: &[Real], s: &Real) -> Real {
    series.iter().rev().fold(long(0.0), |sum, c| sum * s + c)
}

/// Value, slope and bend of a short series.
fn at(series: &[f64], s: f64) -> [f64; 3] {
    series.iter().rev().fold([0.0; 3], |[f, d, b], c| [f * s + c, d * s + f, b * s + 2.0 * d])
}

/// The first coupler over a load that breaks it within a step, and when.
fn first_break(piece: &Piece, breaks_at: &[[f64; 2]]) -> Option<(usize, Real)> {
    let whole = (0..piece.series.len()).filter(|&i| !piece.series[i].is_empty());
    let sides = whole.flat_map(|i| [0, 1].map(|side| (i, side, breaks_at[i][side])));
    let found = sides
        .filter(|(.., load)| load.is_finite())
        .filter_map(|(i, side, load)| Some((i, piece.crossing(i, side, &long(load))?)));
    found.reduce(|a, b| if b.1 < a.1 { b } else { a })
}

impl Piece {
    /// Instants, as shares of the step, between which a force of one sense is monotonic as near as double precision tells.
    fn marks(&self, coupler: usize, sign: f64) -> Vec<f64> {
        let (series, end) = (&self.short[coupler], rounded(&self.end));
        let mut marks = vec![0.0];
        for n in 0..PIECES {
            let [mut a, mut b] = [n, n + 1].map(|n| end * n as f64 / PIECES as f64);
            let last = b;
            if sign * at(series, a)[1] > 0.0 && sign * at(series, b)[1] < 0.0 {
                for _ in 0..60 {
                    let middle = 0.5 * (a + b);
                    if sign * at(series, middle)[1] > 0.0 { a = middle } else { b = middle }
                }
                marks.push(a);
            }
            marks.push(last);
        }
        marks
    }

    /// The error of a force in double precision.
    fn rounding(&self, coupler: usize) -> f64 {
        1e-13 * self.short[coupler].iter().map(|c| c.abs()).sum::<f64>()
    }

    /// The top next to a mark: Newton's steps on the slope, kept within the step.
    fn top(&self, coupler: usize, mark: f64) -> Real {
        let (series, end) = (&self.series[coupler], rounded(&self.end));
        let mut s = if mark >= end { self.end.clone() } else { long(mark) };
        for _ in 0..2 {
            let [_, slope, bend] = derivatives(series, &s);
            let next = if bend == long(0.0) { return s } else { &s - slope / bend };
            if !(mark > 0.0 && mark < end) || (rounded(&next) - mark).abs() > 1e-6 {
                return s;
            }
            s = next;
        }
        s
    }

    /// Where a force of one sense is first over a level.
    fn crossing(&self, coupler: usize, side: usize, level: &Real) -> Option<Real> {
        let sign = [1.0, -1.0][side];
        let long_sign = long(sign);
        let (series, short, rough) = (&self.series[coupler], &self.short[coupler], rounded(level));
        let (bend, end) = (
            short.iter().enumerate().map(|(q, c)| (q * q.saturating_sub(1)) as f64 * c.abs()).sum::<f64>(),
            rounded(&self.end),
        );
        if (sign * short[0]).max(sign * at(short, end)[0]) + 0.125 * bend + self.rounding(coupler) < rough {
            return None;
        }
        let over = |s: &Real| value(series, s) * &long_sign > *level;
        let start = long(0.0);
        if over(&start) || value(series, &start) * &long_sign == *level && over(&long(1e-9)) {
            return Some(start);
        }
        let mut before = start;
        for mark in self.marks(coupler, sign) {
            if sign * at(short, mark)[0] + self.rounding(coupler) < rough {
                before = long(mark);
                continue;
            }
            let mark = self.top(coupler, mark);
            if over(&mark) {
                // Halving to 2^-140 of the step: Newton's method would need fewer, but is less sure.
                let (mut low, mut high) = (before, mark);
                for _ in 0..BITS {
                    let middle = (&low + &high) * long(0.5);
                    if over(&middle) { high = middle } else { low = middle }
                }
                return Some(high);
            }
            before = mark;
        }
        None
    }
}

/// Value and first two derivatives.
fn derivatives(series: &[Real], s: &Real) -> [Real; 3] {
    let zero = || long(0.0);
    series.iter().rev().fold([zero(), zero(), zero()], |[f, d, b], c| {
        let bend = b * s + &d * long(2.0);
        let slope = d * s + &f;
        [f * s + c, slope, bend]
    })
}

impl March {
    /// The largest force of a coupler in one sense (0: F, 1: -F) up to a time, and when.
    pub fn largest(&self, coupler: usize, side: usize, until: f64) -> (f64, Real) {
        let sign = [1.0, -1.0][side];
        let mut best: Option<(f64, Real)> = None;
        for piece in self.up_to(until).filter(|p| !p.series[coupler].is_empty()) {
            let (short, least) = (&piece.short[coupler], best.as_ref().map_or(f64::NEG_INFINITY, |b| rounded(&b.1)));
            let bend: f64 = short.iter().enumerate().map(|(q, c)| (q * q.saturating_sub(1)) as f64 * c.abs()).sum();
            let rounding = piece.rounding(coupler);
            if (sign * short[0]).max(sign * at(short, rounded(&piece.end))[0]) + 0.125 * bend + rounding < least {
                continue;
            }
            for mark in piece.marks(coupler, sign) {
                let known = best.as_ref().map_or(f64::NEG_INFINITY, |b| rounded(&b.1));
                if sign * at(short, mark)[0] + rounding >= known {
                    let s = piece.top(coupler, mark);
                    let force = value(&piece.series[coupler], &s) * long(sign);
                    if best.as_ref().is_none_or(|b| force > b.1) {
                        best = Some((rounded(&(&piece.from + s * &piece.width)), force));
                    }
                }
            }
        }
        best.unwrap_or_else(|| (0.0, long(f64::MIN)))
    }

    /// When a coupler's force in one sense is first over a level, s.
    pub fn first_over(&self, coupler: usize, side: usize, level: &Real) -> Option<f64> {
        let whole = self.pieces.iter().filter(|p| !p.series[coupler].is_empty());
        let mut found = whole.filter_map(|p| Some(rounded(&(&p.from + p.crossing(coupler, side, level)? * &p.width))));
        found.next()
    }

    /// Force and slope of a coupler at a time.
    pub fn force(&self, coupler: usize, t: f64) -> Option<(Real, f64)> {
        let t = long(t);
        let piece = self.pieces.iter().rev().find(|p| p.from <= t)?;
        let series = piece.series.get(coupler).filter(|s| !s.is_empty())?;
        let s = (&t - &piece.from) / &piece.width;
        let [force, slope, _] = derivatives(series, &s);
        Some((force, rounded(&(slope / &piece.width))))
    }

    /// Steps up to a time, the last one cut.
    fn up_to(&self, until: f64) -> impl Iterator<Item = Cow<'_, Piece>> {
        let until = long(until);
        let within = self.pieces.iter().enumerate().take_while({
            let until = until.clone();
            move |(n, p)| *n == 0 || p.from < until
        });
        within.map(move |(_, piece)| {
            let end = (&until - &piece.from) / &piece.width;
            if end < piece.end { Cow::Owned(Piece { end, ..piece.clone() }) } else { Cow::Borrowed(piece) }
        })
    }
}
