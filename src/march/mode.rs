//! The states of one coupler between which its force is linear in its elongation, and what ends each.
//!
//! | mode | force | ends when |
//! | --- | --- | --- |
//! | locked at w | `kl (q - w)` | q passes `w + u / kl` or `w + l / kl` |
//! | up | on the loading curve | q' turns negative, or q reaches the knot |
//! | down | on the unloading curve | q' turns positive, or q reaches the knot |
//! | free | on the only curve: slack, or no friction | q reaches either end |
//!
//! In this table q, w, u and l are as in [`crate::law`]. In the code below `q` and forces are less those at t = 0, and so 0 at rest;
//! travels are not.

use super::branches::{Branches, Interval, Line};
use crate::law::{Law, Rest};

/// A jump of a curve at a knot counts above this share of the forces.
const JUMP: f64 = 1e-14;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mode {
    Locked { w: f64 },
    Up(usize),
    Down(usize),
    Free(usize),
}

/// What ended a mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    Upper,
    Lower,
    Turn,
}

#[derive(Clone, Debug)]
pub struct Coupler {
    pub branches: Branches,
    pub mode: Mode,
    /// Force over elongation, both less those at t = 0.
    pub line: Line,
    /// Guards: the mode ends above this elongation or under `lower`.
    pub upper: f64,
    pub lower: f64,
    /// The mode ends when the elongation shrinks (1), grows (-1); 0: neither.
    pub turn: f64,
    pub parted: bool,
    /// Elongation and force at t = 0.
    pub start: [f64; 2],
}

impl Coupler {
    /// Parted, and the vehicles do not touch.
    pub fn is_open(&self) -> bool {
        self.parted && self.mode == Mode::Free(self.branches.intervals.len() - 1)
    }

    /// Energy stored; `q` is relative to t = 0.
    pub fn energy(&self, q: f64) -> f64 {
        let force = self.start[1] + self.force(q);
        0.5 * force * force * self.branches.compliance + self.branches.stored_j(self.travel(q))
    }

    /// At rest.
    pub fn new(law: &Law, rest: &Rest) -> Coupler {
        let branches = Branches::new(law);
        let elastic = branches.compliance == 0.0;
        let start = [law.elongation_m(rest), rest.force_n];
        let w = if elastic { start[0] } else { rest.travel_m };
        let line = Line { place: 0.0, force: 0.0, slope: 0.0 };
        let (upper, lower) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut coupler =
            Coupler { branches, mode: Mode::Locked { w }, line, upper, lower, turn: 0.0, parted: false, start };
        coupler.lock_at(w, 0.0, 0.0);
        if matches!(coupler.mode, Mode::Free(_)) {
            // The force at rest is the given one, to the last digit.
            coupler.line = Line { place: 0.0, force: 0.0, slope: coupler.line.slope };
        }
        coupler
    }

    /// The coupler parts at elongation `q`: from here on it follows the parted form of its law, or `None` carries nothing.
    pub fn part(&mut self, law: Option<&Law>, q: f64) {
        let w = self.travel(q);
        self.branches = law.map_or_else(Branches::nothing, Branches::parted);
        self.parted = true;
        let place = self.start[0] + q;
        let (w, force) = self.branches.at_elongation(w, place);
        self.lock_at(w, q, force - self.start[1]);
    }

    /// Force less that at t = 0.
    pub fn force(&self, q: f64) -> f64 {
        self.line.at(q)
    }

    /// Travel of the gear, or elongation of an elastic law.
    pub fn travel(&self, q: f64) -> f64 {
        match self.mode {
            Mode::Locked { w } => w,
            _ => self.start[0] + q - (self.start[1] + self.force(q)) * self.branches.compliance,
        }
    }

    /// Goes from a mode that ended at elongation `q` to the next.
    pub fn switch(&mut self, end: End, q: f64) {
        match (self.mode, end) {
            (Mode::Locked { w }, End::Upper) => self.enter(self.branches.interval(w, true), true),
            (Mode::Locked { w }, End::Lower) => self.enter(self.branches.interval(w, false), false),
            (Mode::Up(j) | Mode::Down(j) | Mode::Free(j), End::Upper) => self.pass(j, true),
            (Mode::Up(j) | Mode::Down(j) | Mode::Free(j), End::Lower) => self.pass(j, false),
            (_, End::Turn) => self.lock_at(self.travel(q), q, self.force(q)),
        }
    }

    /// Locks at travel `w` with this force at elongation `q`, both less those at t = 0; follows the curve if it has no
    /// friction.
    fn lock_at(&mut self, w: f64, q: f64, force: f64) {
        let (above, under) = (self.branches.interval(w, true), self.branches.interval(w, false));
        let intervals = &self.branches.intervals;
        let total = self.start[1] + force;
        let (first, last) = (intervals[0].from, intervals[intervals.len() - 1].to);
        let c = self.branches.compliance;
        if c == 0.0 || above == under && intervals[above].free && first < w && w < last {
            return self.enter(above, true);
        }
        self.upper = if w >= last { f64::INFINITY } else { q + ((intervals[above].up.at(w) - total) * c).max(0.0) };
        self.lower =
            if w <= first { f64::NEG_INFINITY } else { q + ((intervals[under].down.at(w) - total) * c).min(0.0) };
        self.mode = Mode::Locked { w };
        self.turn = 0.0;
        self.line = Line { place: q, force, slope: 1.0 / c };
    }

    /// Follows a curve of interval `j`.
    fn enter(&mut self, j: usize, up: bool) {
        let p: Interval = self.branches.intervals[j];
        let curve = if up { p.up } else { p.down };
        let c = self.branches.compliance;
        let elongation = |w: f64| w + curve.at(w) * c - self.start[0];
        (self.mode, self.turn) = match (p.free, up) {
            (true, _) => (Mode::Free(j), 0.0),
            (false, true) => (Mode::Up(j), 1.0),
            (false, false) => (Mode::Down(j), -1.0),
        };
        let end = |w: f64| if w.is_finite() { elongation(w) } else { f64::copysign(f64::INFINITY, w) };
        self.upper = if up || p.free { end(p.to) } else { f64::INFINITY };
        self.lower = if !up || p.free { end(p.from) } else { f64::NEG_INFINITY };
        let slope = curve.slope / (1.0 + curve.slope * c);
        self.line = Line { place: elongation(curve.place), force: curve.force - self.start[1], slope };
    }

    /// Passes the upper or lower end of interval `j`.
    fn pass(&mut self, j: usize, up: bool) {
        let intervals = &self.branches.intervals;
        let p = intervals[j];
        let (w, here) = if up { (p.to, p.up.at(p.to)) } else { (p.from, p.down.at(p.from)) };
        let next = if up { intervals.get(j + 1) } else { j.checked_sub(1).and_then(|j| intervals.get(j)) };
        let there = next.map(|n| if up { n.up.at(n.from) } else { n.down.at(n.to) });
        match there {
            Some(there) if (there - here).abs() <= JUMP * there.abs().max(here.abs()) => {
                self.enter(if up { j + 1 } else { j - 1 }, up);
            }
            _ => self.lock_at(w, w + here * self.branches.compliance - self.start[0], here - self.start[1]),
        }
    }
}

impl Branches {
    /// Travel and force at elongation `q` of a coupler whose gear was at travel `w`.
    fn at_elongation(&self, w: f64, q: f64) -> (f64, f64) {
        let c = self.compliance;
        let curve = |p: &Interval, up: bool| if up { p.up } else { p.down };
        let on = |p: &Interval, up: bool| {
            let line = curve(p, up);
            // w + c u(w) = q
            let w = (q - c * (line.force - line.slope * line.place)) / (1.0 + c * line.slope);
            (w, line.at(w))
        };
        let (above, under) = (self.interval(w, true), self.interval(w, false));
        for (up, j) in [(true, above), (false, under)] {
            let beyond = |x: f64, f: f64| if up { q > x + f * c } else { q < x + f * c };
            if !beyond(w, curve(&self.intervals[j], up).at(w)) {
                continue;
            }
            let rest: Vec<&Interval> =
                if up { self.intervals[j..].iter().collect() } else { self.intervals[..=j].iter().rev().collect() };
            let mut stop = w;
            for p in rest {
                let (near, far) = if up { (p.from, p.to) } else { (p.to, p.from) };
                if !beyond(near, curve(p, up).at(near)) && near != w {
                    return (near, (q - near) / c);
                }
                if !beyond(far, curve(p, up).at(far)) {
                    return on(p, up);
                }
                stop = far;
            }
            return (stop, (q - stop) / c);
        }
        (w, if c > 0.0 { (q - w) / c } else { curve(&self.intervals[above], true).at(q) })
    }
}

#[cfg(test)]
#[allow(clippy::excessive_precision)] // Reference numbers are given with all their digits.
pub mod tests {
    use super::*;
    use crate::law::{Curve, GearRow};

    /// Moves a coupler to an elongation, mode by mode; its force there.
    pub fn moved(c: &mut Coupler, from: f64, to: f64) -> f64 {
        let grows = to > from;
        if c.turn != 0.0 && (c.turn > 0.0) != grows {
            c.switch(End::Turn, from);
        }
        while grows && to > c.upper || !grows && to < c.lower {
            let (end, at) = if grows { (End::Upper, c.upper) } else { (End::Lower, c.lower) };
            c.switch(end, at);
        }
        c.start[1] + c.force(to)
    }

    /// A pair of friction gears with slack along a path of elongations, against 40 digits.
    #[test]
    fn memory_along_a_path() {
        let rows = [[0., 0., 0.], [7., 120., 120.], [38., 680., 172.], [114., 1350., 300.], [149., 2520., 360.]];
        let row = |r: &[f64; 3]| GearRow { travel_m: r[0] / 1e3, loading_n: r[1] * 1e3, unloading_n: r[2] * 1e3 };
        let gear = Curve::new(rows.iter().map(row).collect()).expect("a table");
        let law = Law::Gear { solid_n_per_m: 2e8, slack_m: 0.025, draft: gear.clone(), buff: gear };
        let path = [
            (0.030, 284023.66863905325444),
            (0.050, 615384.61538461538462),
            (0.049, 415384.61538461538462),
            (0.050, 615384.61538461538462),
            (0.060, 731505.98613736609956),
            (0.0575, 231505.98613736609956),
            (0.040, 153103.00703774792067),
            (0.0405, 253103.00703774792067),
            (0.0, 0.0),
            (-0.040, -449704.14201183431953),
            (-0.0385, -150607.80550223928343),
            (-0.020, -118421.05263157894737),
            (0.010, 0.0),
        ];
        let mut coupler = Coupler::new(&law, &Rest::default());
        let mut last = 0.0;
        for (q, want) in path {
            let force = moved(&mut coupler, last, q);
            // Elongations are rounded to 4e-18 m; times kl.
            assert!((force - want).abs() < 5e-9, "{q}: {force} for {want}");
            last = q;
        }
    }
}
