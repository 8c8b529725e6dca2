//! A coupler's law as two curves of its force over its elongation, and the state between them.
//!
//! With `kl` the stiffness in series, a row of travel w and force F is the point `q = w + F / kl`. The force moves at slope kl between the
//! curves and never leaves them (a clamp): that is the law of [`crate::law`] in other words, and here without its travel.

use crate::law::{GearRow, Law};
use crate::solve::dd::Dd;

/// A straight line through a point.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// Elongation of the point, m.
    pub q: Dd,
    /// Force of the point, N.
    pub force: Dd,
    /// N/m
    pub slope: Dd,
}

impl Line {
    /// Force at an elongation.
    pub fn at(&self, q: Dd) -> Dd {
        self.force + self.slope * (q - self.q)
    }
}

/// Both curves on common knots.
#[derive(Clone, Debug)]
pub struct Curves {
    /// Slope between the curves; `None` where they are one (no friction).
    pub solid: Option<Dd>,
    /// Elongations, in order, at which a curve has a kink.
    pub knots: Vec<Dd>,
    /// Of each interval between knots, the first and the last one infinite: the upper and the lower curve.
    pub lines: Vec<[Line; 2]>,
}

/// One curve: its points, and the slopes before the first and behind the last.
struct Curve {
    points: Vec<[Dd; 2]>,
    ends: [Dd; 2],
}

impl Curve {
    /// Without the points that repeat the one before.
    fn new(points: Vec<[Dd; 2]>, ends: [Dd; 2]) -> Curve {
        let mut curve = Curve { points, ends };
        curve.points.dedup_by(|b, a| a == b);
        curve
    }

    /// The line just above or just under an elongation.
    fn line(&self, q: Dd, under: bool) -> Line {
        let next = self.points.partition_point(|p| if under { p[0] < q } else { p[0] <= q });
        let last = self.points.len();
        let [at, force] = self.points[next.saturating_sub(1).min(last - 1)];
        let slope = match next {
            0 => self.ends[0],
            n if n == last => self.ends[1],
            n => (self.points[n][1] - force) / (self.points[n][0] - at),
        };
        Line { q: at, force, slope }
    }

    /// No force above zero.
    fn without_draft(&self) -> Curve {
        let zero = Dd::ZERO;
        let first = self.points.iter().position(|p| p[1] > zero).unwrap_or(self.points.len());
        let mut points = self.points[..first].to_vec();
        let crossing = match (points.last(), self.points.get(first)) {
            (Some(a), Some(b)) => a[0] - a[1] * (b[0] - a[0]) / (b[1] - a[1]),
            (Some(a), None) => a[0] - a[1] / self.ends[1],
            (None, _) => self.points[0][0] - self.points[0][1] / self.ends[0],
        };
        points.push([crossing, zero]);
        Curve::new(points, [self.ends[0], zero])
    }
}

impl Curves {
    /// Of a whole coupler.
    pub fn new(law: &Law) -> Curves {
        let (upper, lower, solid) = both(law);
        Curves::on_common_knots(&upper, &lower, solid)
    }

    /// Of one that has parted: no draft, and in buff as before but without adhesion.
    pub fn parted(law: &Law) -> Curves {
        let (upper, lower, solid) = both(law);
        Curves::on_common_knots(&upper.without_draft(), &lower.without_draft(), solid)
    }

    fn on_common_knots(upper: &Curve, lower: &Curve, solid: Option<Dd>) -> Curves {
        let mut knots: Vec<Dd> = upper.points.iter().chain(&lower.points).map(|p| p[0]).collect();
        knots.sort_by(|a, b| (a.hi, a.lo).partial_cmp(&(b.hi, b.lo)).unwrap_or(std::cmp::Ordering::Equal));
        knots.dedup();
        let mut lines = vec![[upper.line(knots[0], true), lower.line(knots[0], true)]];
        lines.extend(knots.iter().map(|&q| [upper.line(q, false), lower.line(q, false)]));
        Curves { solid, knots, lines }
    }

    /// The interval of an elongation; at a knot the upper one.
    pub fn interval(&self, q: Dd) -> usize {
        self.knots.partition_point(|k| *k <= q)
    }

    /// Force of the upper and the lower curve.
    pub fn bounds(&self, q: Dd) -> [Dd; 2] {
        self.lines[self.interval(q)].map(|line| line.at(q))
    }

    /// Whether the curves are one over an interval.
    pub(crate) fn is_one(&self, interval: usize) -> bool {
        let [upper, lower] = &self.lines[interval];
        let at = |n: Option<usize>| n.and_then(|n| self.knots.get(n)).map(|&q| (upper.at(q) - lower.at(q)).abs().hi);
        let apart = at(interval.checked_sub(1)).unwrap_or(0.0).max(at(Some(interval)).unwrap_or(0.0));
        let scale = upper.force.abs().hi.max(lower.force.abs().hi);
        self.solid.is_none()
            || apart <= 1e-28 * scale && (upper.slope - lower.slope).abs().hi <= 1e-28 * upper.slope.abs().hi
    }

    /// How far a line of slope kl through a point stays under the upper and over the lower curve; infinite if endless.
    pub fn reach(&self, through: &Line) -> [Dd; 2] {
        let end = |side: usize| {
            // How far the curve is ahead of the line: falls with q on the upper one, rises on the lower one.
            let ahead = |line: &Line, q: Dd| line.at(q) - through.at(q);
            let mut knots: Vec<(usize, Dd)> = self.knots.iter().copied().enumerate().collect();
            if side == 1 {
                knots.reverse();
            }
            let beyond = |gap: Dd| if side == 0 { gap < Dd::ZERO } else { gap > Dd::ZERO };
            let far = Dd::from(if side == 0 { f64::INFINITY } else { f64::NEG_INFINITY });
            let found = knots.iter().find(|(n, q)| beyond(ahead(&self.lines[*n][side], *q)));
            // The interval in which the line meets the curve, and a place in it.
            let (interval, q) = match found {
                Some(&(n, q)) => (if side == 0 { n } else { n + 1 }, q),
                None => (if side == 0 { self.knots.len() } else { 0 }, knots[knots.len() - 1].1),
            };
            let curve = &self.lines[interval][side];
            let closing = through.slope - curve.slope;
            match closing.hi > 1e-25 * through.slope.hi {
                true => q + ahead(curve, q) / closing,
                // The line is the curve up to this knot, or without end.
                false => found.map_or(far, |_| q),
            }
        };
        let [upper, lower] = [end(0), end(1)];
        [if upper < through.q { through.q } else { upper }, if lower > through.q { through.q } else { lower }]
    }
}

/// Upper and lower curve of a law, and the slope between them.
fn both(law: &Law) -> (Curve, Curve, Option<Dd>) {
    let half = Dd::from(0.5) * Dd::from(law.slack_m());
    let slack = [[-half, Dd::ZERO], [half, Dd::ZERO]];
    match law {
        Law::Elastic { draft_n_per_m, buff_n_per_m, .. } => {
            let ends = [Dd::from(*buff_n_per_m), Dd::from(*draft_n_per_m)];
            let curve = || Curve::new(slack.to_vec(), ends);
            (curve(), curve(), None)
        }
        Law::Gear { solid_n_per_m, draft, buff, .. } => {
            let solid = Dd::from(*solid_n_per_m);
            let point =
                |r: &GearRow, force: f64| [half + Dd::from(r.travel_m) + Dd::from(force) / solid, Dd::from(force)];
            let curve = |in_draft: fn(&GearRow) -> f64, in_buff: fn(&GearRow) -> f64| {
                let mirrored = buff.rows().iter().rev().map(|r| point(r, in_buff(r)).map(|x| -x));
                let middle = slack.iter().copied().filter(|_| half > Dd::ZERO);
                let all = mirrored.chain(middle).chain(draft.rows().iter().map(|r| point(r, in_draft(r))));
                Curve::new(all.collect(), [solid; 2])
            };
            (curve(|r| r.loading_n, |r| r.unloading_n), curve(|r| r.unloading_n, |r| r.loading_n), Some(solid))
        }
    }
}
