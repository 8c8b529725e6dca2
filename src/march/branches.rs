//! A coupler's law as intervals of its travel, each with a line of the loading and one of the unloading curve.
//!
//! `u` is the force at which travel w rises, `l` that at which it falls; over the elongation `q = w + F / kl` the slope of a line
//! h over w is `h / (1 + h / kl)`. An elastic law is the case `1 / kl = 0`, u = l.

use crate::law::{Curve, GearRow, Law};

/// A knot lies on the line of its neighbours if it is off by less than this share of the forces there.
const ON_A_LINE: f64 = 1e-13;

/// A straight piece: `force + slope (w - place)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    pub place: f64,
    pub force: f64,
    pub slope: f64,
}

impl Line {
    fn through(a: [f64; 2], b: [f64; 2]) -> Line {
        Line { place: a[0], force: a[1], slope: (b[1] - a[1]) / (b[0] - a[0]) }
    }

    pub fn at(&self, w: f64) -> f64 {
        self.force + self.slope * (w - self.place)
    }

    /// The line `-line(-w)`.
    fn mirrored(&self) -> Line {
        Line { place: -self.place, force: -self.force, slope: self.slope }
    }

    /// Integral of the positive part from a to b; the line does not fall.
    fn positive(&self, a: f64, b: f64) -> f64 {
        match (self.at(a), self.at(b)) {
            (_, end) if end <= 0.0 => 0.0,
            (begin, end) if begin < 0.0 => 0.5 * end * end / self.slope,
            (begin, end) => 0.5 * (begin + end) * (b - a),
        }
    }
}

/// Travel from `from` to `to` with both curves straight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    pub from: f64,
    pub to: f64,
    pub up: Line,
    pub down: Line,
    /// u = l: no friction here.
    pub free: bool,
}

/// A law in the form that a march needs: intervals in order of travel, without a gap between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Branches {
    pub intervals: Vec<Interval>,
    /// `1 / kl`; 0 for an elastic law.
    pub compliance: f64,
}

impl Branches {
    /// Of a whole coupler.
    pub fn new(law: &Law) -> Branches {
        Branches::of(law, true)
    }

    /// Of a coupler that has parted: no force in draft; in buff the heads push as before but never pull.
    pub fn parted(law: &Law) -> Branches {
        Branches::of(law, false)
    }

    /// Of a parted coupler whose vehicles pass each other: no force at all.
    pub fn nothing() -> Branches {
        let none = Line { place: 0.0, force: 0.0, slope: 0.0 };
        Branches { intervals: vec![straight(f64::NEG_INFINITY, f64::INFINITY, none)], compliance: 0.0 }
    }

    fn of(law: &Law, draft_too: bool) -> Branches {
        let half = 0.5 * law.slack_m();
        let mut intervals = Vec::new();
        let slack_end = if draft_too { half } else { f64::INFINITY };
        let slack = straight(-half, slack_end, Line { place: 0.0, force: 0.0, slope: 0.0 });
        let compliance = match law {
            Law::Elastic { draft_n_per_m, buff_n_per_m, .. } => {
                let line = |place: f64, slope: f64| Line { place, force: 0.0, slope };
                intervals.push(straight(f64::NEG_INFINITY, -half, line(-half, *buff_n_per_m)));
                intervals.extend((slack_end > -half).then_some(slack));
                if draft_too {
                    intervals.push(straight(half, f64::INFINITY, line(half, *draft_n_per_m)));
                }
                0.0
            }
            Law::Gear { solid_n_per_m, draft, buff, .. } => {
                let rows = if draft_too { buff.rows().to_vec() } else { without_adhesion(buff) };
                let mirrored = intervals_of_rows(&rows, half).into_iter().rev().map(|p| Interval {
                    from: -p.to,
                    to: -p.from,
                    up: p.down.mirrored(),
                    down: p.up.mirrored(),
                    free: p.free,
                });
                intervals.extend(mirrored);
                intervals.extend((slack_end > -half).then_some(slack));
                if draft_too {
                    intervals.extend(intervals_of_rows(draft.rows(), half));
                }
                1.0 / solid_n_per_m
            }
        };
        Branches { intervals: merged(intervals), compliance }
    }

    /// Index of the interval that travel w is in; at a knot, of the upper one if `upper`.
    pub fn interval(&self, w: f64, upper: bool) -> usize {
        let inside = |p: &Interval| if upper { w < p.to } else { w <= p.to };
        self.intervals.iter().position(inside).unwrap_or(self.intervals.len() - 1)
    }

    /// Energy stored in the gear at travel w: integral from w = 0 of the force between l and u that is nearest to 0.
    pub fn stored_j(&self, w: f64) -> f64 {
        let (from, to) = (w.min(0.0), w.max(0.0));
        let part = |p: &Interval| {
            let (a, b) = (p.from.max(from), p.to.min(to));
            if b > a { p.down.positive(a, b) - p.up.mirrored().positive(-b, -a) } else { 0.0 }
        };
        self.intervals.iter().map(part).sum::<f64>() * if w < 0.0 { -1.0 } else { 1.0 }
    }

    /// Whether the law is a spring, alone or beside a slider of constant friction without slack, up to the stops.
    pub fn constant_friction(&self) -> bool {
        let [p] = self.intervals[..] else { return false };
        let (scale, slope_difference) =
            (p.up.at(p.to).abs().max(p.down.at(p.from).abs()), (p.up.slope - p.down.slope).abs());
        slope_difference == 0.0 || slope_difference * (p.to - p.from) <= ON_A_LINE * scale
    }
}

fn straight(from: f64, to: f64, line: Line) -> Interval {
    Interval { from, to, up: line, down: line, free: true }
}

/// Intervals of a table in draft, shifted by half the slack.
fn intervals_of_rows(rows: &[GearRow], half: f64) -> Vec<Interval> {
    let point = |r: &GearRow, force: f64| [half + r.travel_m, force];
    let interval = |pair: &[GearRow]| {
        let (a, b) = (&pair[0], &pair[1]);
        let up = Line::through(point(a, a.loading_n), point(b, b.loading_n));
        let down = Line::through(point(a, a.unloading_n), point(b, b.unloading_n));
        let free = a.loading_n == a.unloading_n && b.loading_n == b.unloading_n;
        Interval { from: half + a.travel_m, to: half + b.travel_m, up, down, free }
    };
    rows.windows(2).map(interval).collect()
}

/// A table whose unloading curve is zero where it would be negative: heads that are not coupled cannot pull.
fn without_adhesion(curve: &Curve) -> Vec<GearRow> {
    let mut rows: Vec<GearRow> = Vec::new();
    for row in curve.rows() {
        if let Some(last) = rows.last().copied().filter(|_| row.unloading_n > 0.0) {
            let under = curve.rows().iter().rev().find(|r| r.travel_m <= last.travel_m).map_or(0.0, |r| r.unloading_n);
            if under < 0.0 {
                let share = -under / (row.unloading_n - under);
                let between = |a: f64, b: f64| a + share * (b - a);
                let travel_m = between(last.travel_m, row.travel_m);
                rows.push(GearRow { travel_m, loading_n: between(last.loading_n, row.loading_n), unloading_n: 0.0 });
            }
        }
        rows.push(GearRow { unloading_n: row.unloading_n.max(0.0), ..*row });
    }
    // A negative loading force, which a law may have at its middle, becomes 0 too.
    rows.into_iter().map(|r| GearRow { loading_n: r.loading_n.max(0.0), ..r }).collect()
}

/// Joins neighbours whose curves are on the same lines.
fn merged(intervals: Vec<Interval>) -> Vec<Interval> {
    let mut out: Vec<Interval> = Vec::new();
    for next in intervals.into_iter().filter(|p| p.to > p.from) {
        match out.last_mut() {
            Some(last)
                if last.free == next.free
                    && continues(&last.up, &next.up, &next)
                    && continues(&last.down, &next.down, &next) =>
            {
                last.to = next.to;
            }
            _ => out.push(next),
        }
    }
    out
}

/// Whether both are one line over the interval of `next`.
fn continues(last: &Line, next: &Line, interval: &Interval) -> bool {
    let near = |w: f64| (last.at(w) - next.at(w)).abs() <= ON_A_LINE * last.at(w).abs().max(next.at(w).abs());
    if interval.to.is_finite() {
        near(interval.from) && near(interval.to)
    } else {
        near(interval.from) && (last.slope - next.slope).abs() <= ON_A_LINE * last.slope.max(next.slope)
    }
}
