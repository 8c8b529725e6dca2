//! The force of a coupler against its elongation: an elastic law with a gap, or a gear with friction and a memory.
//!
//! Elongation q is positive in draft and zero in the middle of the slack. An elastic law has no memory. A gear
//! remembers one number, its travel w, and has a stiffness kl in series (wedges locked, or gear closed):
//!
//! ```text
//! F = kl (q - w)     w' > 0 only if F = u(w)     w' < 0 only if F = l(w)     otherwise w' = 0 and l(w) <= F <= u(w)
//! draft (w > s/2):   u = loading(w - s/2),       l = unloading(w - s/2)
//! slack (|w| <= s/2) u = l = 0
//! buff  (w < -s/2):  u = -unloading(-w - s/2),   l = -loading(-w - s/2)
//! ```
//!
//! Beyond the last row of a table the gear is closed: w stands still, and F rises at kl. Neither u nor l falls over w
//! ([`Law::check`]): so the motion of a train is unique, and only work from outside increases its energy.

use std::sync::Arc;

/// One row of a gear's table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GearRow {
    /// Travel of the whole connection from the end of the slack, m.
    pub travel_m: f64,
    /// Force while the travel grows, N.
    pub loading_n: f64,
    /// Force while the travel shrinks, N.
    pub unloading_n: f64,
}

/// A gear's loading and unloading curves, linear between rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Shared by all couplers that have it.
    rows: Arc<[GearRow]>,
}

/// What is wrong with a gear's table; rows count from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CurveProblem {
    /// Fewer than two rows.
    #[error("a gear's table has at least two rows, and this one has {0}")]
    TooFewRows(usize),
    /// A number that is not finite.
    #[error("row {0} has a value that is not a finite number")]
    NotFinite(usize),
    /// The first travel is not zero.
    #[error("the first row's travel is 0, and here it is {0} m")]
    FirstTravel(f64),
    /// A travel that is not larger than the one before.
    #[error("row {0}: its travel has to be larger than that of the row before")]
    TravelFalls(usize),
    /// A loading force under the one before.
    #[error("row {0}: its loading force has to be at least that of the row before")]
    LoadingFalls(usize),
    /// An unloading force under the one before.
    #[error("row {0}: its unloading force has to be at least that of the row before")]
    UnloadingFalls(usize),
    /// More force on the way back than on the way in.
    #[error(
        "row {0}: its unloading force is larger than its loading force, and a gear gives back no more than it takes"
    )]
    Unloading(usize),
    /// A gear that never resists.
    #[error("its loading force is 0 in every row, so that it moves without force")]
    NoForce,
}

impl CurveProblem {
    /// The same with another number for the row that it names.
    pub(crate) fn renumbered(self, number: impl Fn(usize) -> usize) -> CurveProblem {
        match self {
            CurveProblem::NotFinite(row) => CurveProblem::NotFinite(number(row)),
            CurveProblem::TravelFalls(row) => CurveProblem::TravelFalls(number(row)),
            CurveProblem::LoadingFalls(row) => CurveProblem::LoadingFalls(number(row)),
            CurveProblem::UnloadingFalls(row) => CurveProblem::UnloadingFalls(number(row)),
            CurveProblem::Unloading(row) => CurveProblem::Unloading(number(row)),
            of_all => of_all,
        }
    }

    /// The row that it names, from 1; `None` for the whole table.
    pub fn row(&self) -> Option<usize> {
        match *self {
            CurveProblem::NotFinite(row)
            | CurveProblem::TravelFalls(row)
            | CurveProblem::LoadingFalls(row)
            | CurveProblem::UnloadingFalls(row)
            | CurveProblem::Unloading(row) => Some(row),
            CurveProblem::FirstTravel(_) => Some(1),
            CurveProblem::TooFewRows(_) | CurveProblem::NoForce => None,
        }
    }
}

impl Curve {
    /// A table of rows in order of travel.
    ///
    /// # Errors
    /// [`CurveProblem`]: fewer than two rows, a number that is not finite, a first travel other than 0, a travel that does
    /// not rise, a force that falls, an unloading force over the loading force, or no loading force at all.
    ///
    /// ```
    /// use trainsafe::law::{Curve, CurveProblem, GearRow};
    /// let row = |travel_m, loading_n, unloading_n| GearRow { travel_m, loading_n, unloading_n };
    /// assert!(Curve::new(vec![row(0.0, 0.0, 0.0), row(0.05, 9e5, 2e5)]).is_ok());
    /// let wrong = Curve::new(vec![row(0.0, 0.0, 0.0), row(0.05, 2e5, 9e5)]);
    /// assert_eq!(wrong, Err(CurveProblem::Unloading(2)));
    /// ```
    pub fn new(rows: Vec<GearRow>) -> Result<Curve, CurveProblem> {
        if rows.len() < 2 {
            return Err(CurveProblem::TooFewRows(rows.len()));
        }
        for (i, r) in rows.iter().enumerate() {
            if ![r.travel_m, r.loading_n, r.unloading_n].iter().all(|x| x.is_finite()) {
                return Err(CurveProblem::NotFinite(i + 1));
            }
            if r.unloading_n > r.loading_n {
                return Err(CurveProblem::Unloading(i + 1));
            }
        }
        if rows[0].travel_m != 0.0 {
            return Err(CurveProblem::FirstTravel(rows[0].travel_m));
        }
        for (i, pair) in rows.windows(2).enumerate() {
            let row = i + 2;
            if pair[1].travel_m <= pair[0].travel_m {
                return Err(CurveProblem::TravelFalls(row));
            } else if pair[1].loading_n < pair[0].loading_n {
                return Err(CurveProblem::LoadingFalls(row));
            } else if pair[1].unloading_n < pair[0].unloading_n {
                return Err(CurveProblem::UnloadingFalls(row));
            }
        }
        if rows[rows.len() - 1].loading_n <= 0.0 {
            return Err(CurveProblem::NoForce);
        }
        Ok(Curve { rows: rows.into() })
    }

    /// A pair of North American friction draft gears: generic, no maker's curve. The rows are those of
    /// `trains/gears/aar-friction-pair.csv`, which has their sources.
    pub(crate) fn generic_friction_gears() -> Curve {
        const ROWS: [[f64; 3]; 5] =
            [[0.0, 0.0, 0.0], [7.0, 120.0, 60.0], [38.0, 680.0, 172.0], [114.0, 1350.0, 300.0], [149.0, 2520.0, 360.0]];
        let row = |[mm, loading_kn, unloading_kn]: [f64; 3]| GearRow {
            travel_m: mm / 1e3,
            loading_n: loading_kn * 1e3,
            unloading_n: unloading_kn * 1e3,
        };
        Curve { rows: ROWS.map(row).into() }
    }

    /// The rows, in order of travel.
    pub fn rows(&self) -> &[GearRow] {
        &self.rows
    }

    /// The travel at which the gear is closed, m.
    pub(crate) fn stroke_m(&self) -> f64 {
        self.rows[self.rows.len() - 1].travel_m
    }

    /// Work that a full stroke takes up, J: the area under the loading curve.
    pub(crate) fn absorbed_j(&self) -> f64 {
        self.area(|r| r.loading_n)
    }

    /// Force of loading at which it closes.
    pub(crate) fn closes_at_n(&self) -> f64 {
        self.rows.last().map_or(0.0, |row| row.loading_n)
    }

    /// Stiffness in loading over the whole stroke, N/m: what it rises by, over the travel.
    pub(crate) fn mean_n_per_m(&self) -> f64 {
        (self.closes_at_n() - self.rows[0].loading_n) / self.stroke_m()
    }

    /// Share of the work of a full stroke that is lost to friction.
    pub(crate) fn lost_share(&self) -> f64 {
        1.0 - self.area(|r| r.unloading_n) / self.absorbed_j()
    }

    fn area(&self, force: impl Fn(&GearRow) -> f64) -> f64 {
        self.rows.windows(2).map(|p| 0.5 * (force(&p[0]) + force(&p[1])) * (p[1].travel_m - p[0].travel_m)).sum()
    }
}

/// A coupler's force against its elongation.
#[derive(Clone, Debug, PartialEq)]
pub enum Law {
    /// A spring, which may be of another stiffness in buff, with a gap between draft and buff. No memory.
    Elastic {
        /// Stiffness in draft, N/m.
        draft_n_per_m: f64,
        /// Stiffness in buff, N/m.
        buff_n_per_m: f64,
        /// Free play between draft and buff, m.
        slack_m: f64,
    },
    /// A gear with friction.
    Gear {
        /// Stiffness of what is in series with the gear, N/m.
        solid_n_per_m: f64,
        /// Free play between draft and buff, m.
        slack_m: f64,
        /// Table in draft.
        draft: Curve,
        /// Table in buff, its forces and travels positive.
        buff: Curve,
    },
}

/// What is wrong with a law whose tables are right.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LawProblem {
    /// A stiffness that is not positive and finite.
    #[error("a stiffness has to be positive and finite, and this one is {0} N/m")]
    Stiffness(f64),
    /// A slack that is negative or not finite.
    #[error("slack has to be finite and not negative, and this one is {0} m")]
    Slack(f64),
    /// A pull while the gear is in buff, or the reverse, with slack, which carries no force.
    #[error("with slack the unloading force of the first row cannot be negative, and here it is {0} N")]
    NegativeBesideSlack(f64),
    /// At travel 0 the force of one sense lies past that of the other, so that it would fall while the coupler gets longer.
    #[error(
        "without slack the unloading force of the first row in one sense cannot lie under minus the loading force of the first \
             row in the other, and here {unloading_n} N lies under -{loading_n} N"
    )]
    Crossed {
        /// Of the first row in one sense, N.
        unloading_n: f64,
        /// Of the first row in the other, N.
        loading_n: f64,
    },
}

/// A coupler at rest: its force, and the travel that it remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rest {
    /// Force, N, draft positive.
    pub force_n: f64,
    /// Travel w of a gear, m, signed as the elongation and with half the slack. For an elastic law, the part of the
    /// elongation that is slack, `-slack / 2 ..= slack / 2`.
    pub travel_m: f64,
}

impl LawProblem {
    /// What would be right.
    pub(crate) fn help(&self) -> &'static str {
        match self {
            LawProblem::NegativeBesideSlack(_) => "give it 0 or more, or leave slack out",
            LawProblem::Crossed { .. } => "with these two curves the force would fall while the coupler gets longer",
            LawProblem::Stiffness(_) => "expected a value above zero",
            LawProblem::Slack(_) => "expected zero or more",
        }
    }
}

impl Law {
    /// A linear spring of this stiffness, N/m.
    pub const fn linear(stiffness_n_per_m: f64) -> Law {
        Law::Elastic { draft_n_per_m: stiffness_n_per_m, buff_n_per_m: stiffness_n_per_m, slack_m: 0.0 }
    }

    /// Whether the force is proportional to the elongation.
    pub(crate) fn is_linear(&self) -> bool {
        matches!(self, Law::Elastic { draft_n_per_m, buff_n_per_m, slack_m } if draft_n_per_m == buff_n_per_m && *slack_m == 0.0)
    }

    /// Whether a cycle can lose work, so that the force depends on what was before.
    pub(crate) fn has_friction(&self) -> bool {
        let loses = |c: &Curve| c.rows.iter().any(|r| r.unloading_n < r.loading_n);
        matches!(self, Law::Gear { draft, buff, .. } if loses(draft) || loses(buff))
    }

    /// Free play between draft and buff, m.
    pub fn slack_m(&self) -> f64 {
        match self {
            Law::Elastic { slack_m, .. } | Law::Gear { slack_m, .. } => *slack_m,
        }
    }

    /// Checks that neither curve falls over the whole travel, and that stiffnesses and slack are valid.
    ///
    /// # Errors
    /// [`LawProblem`].
    pub fn check(&self) -> Result<(), LawProblem> {
        let stiffness = |k: f64| if k > 0.0 && k.is_finite() { Ok(()) } else { Err(LawProblem::Stiffness(k)) };
        let slack = self.slack_m();
        if !(slack >= 0.0 && slack.is_finite()) {
            return Err(LawProblem::Slack(slack));
        }
        match self {
            Law::Elastic { draft_n_per_m, buff_n_per_m, .. } => stiffness(*draft_n_per_m).and(stiffness(*buff_n_per_m)),
            Law::Gear { solid_n_per_m, draft, buff, .. } => {
                stiffness(*solid_n_per_m)?;
                for (one, other) in [(draft, buff), (buff, draft)] {
                    let (unloading_n, loading_n) = (one.rows[0].unloading_n, other.rows[0].loading_n);
                    if slack > 0.0 && unloading_n < 0.0 {
                        return Err(LawProblem::NegativeBesideSlack(unloading_n));
                    }
                    if unloading_n < -loading_n {
                        return Err(LawProblem::Crossed { unloading_n, loading_n });
                    }
                }
                Ok(())
            }
        }
    }

    /// The coupler at rest after its force rose or fell to each of `forces_n` in turn, N, draft positive, from no
    /// force in the middle of the slack. Loaded to a, then reduced to b: `rest(&[a, b])`.
    ///
    /// The travel of a gear changes only as far as the force requires; else it is locked.
    ///
    /// ```
    /// use trainsafe::law::{Curve, Law, GearRow};
    /// let row = |mm: f64, kn: f64, back_kn: f64| GearRow { travel_m: mm / 1e3, loading_n: kn * 1e3, unloading_n: back_kn * 1e3 };
    /// let gear = Curve::new(vec![row(0.0, 0.0, 0.0), row(7.0, 120.0, 60.0), row(38.0, 680.0, 172.0)])?;
    /// let law = Law::Gear { solid_n_per_m: 2e8, slack_m: 0.0, draft: gear.clone(), buff: gear };
    /// let (pulled, locked) = (law.rest(&[6e5]), law.rest(&[6e5, 3e5]));
    /// assert_eq!(pulled.travel_m, locked.travel_m);
    /// assert!((law.elongation_m(&locked) - (pulled.travel_m + 3e5 / 2e8)).abs() < 1e-12);
    /// # Ok::<(), trainsafe::law::CurveProblem>(())
    /// ```
    pub fn rest(&self, forces_n: &[f64]) -> Rest {
        let mut rest = Rest::default();
        for &force_n in forces_n {
            rest = self.after_force(rest, force_n);
        }
        rest
    }

    /// Elongation of a coupler at rest, m.
    pub fn elongation_m(&self, rest: &Rest) -> f64 {
        let k = match self {
            Law::Elastic { draft_n_per_m, .. } if rest.force_n > 0.0 => draft_n_per_m,
            Law::Elastic { buff_n_per_m, .. } => buff_n_per_m,
            Law::Gear { solid_n_per_m, .. } => solid_n_per_m,
        };
        rest.travel_m + rest.force_n / k
    }

    /// The coupler after its force went from that of `rest` to another.
    fn after_force(&self, rest: Rest, force_n: f64) -> Rest {
        let half = 0.5 * self.slack_m();
        let Law::Gear { draft, buff, .. } = self else {
            let travel_m = if force_n == 0.0 { rest.travel_m } else { half.copysign(force_n) };
            return Rest { force_n, travel_m };
        };
        // A fall is the mirror image of a rise, with the tables exchanged.
        let w = rest.travel_m;
        let up = travel_after_rise(w, force_n, half, draft, buff);
        let down = -travel_after_rise(-w, -force_n, half, buff, draft);
        Rest { force_n, travel_m: if up > w { up } else { w.min(down) } }
    }
}

/// The smallest travel, not below w, at which u is at least `force`; the stop if u is less everywhere.
fn travel_after_rise(w: f64, force: f64, half: f64, draft: &Curve, buff: &Curve) -> f64 {
    // Knots and u from the stop in buff to that in draft, up to the first where u reaches the force.
    let mut place = f64::NEG_INFINITY;
    let mut reached = -half - buff.stroke_m();
    let mut last = f64::NEG_INFINITY;
    let in_buff = buff.rows.iter().rev().map(|r| (-half - r.travel_m, -r.unloading_n));
    let slack = [(-half, 0.0), (half, 0.0)].into_iter().filter(|_| half > 0.0);
    let in_draft = draft.rows.iter().map(|r| (half + r.travel_m, r.loading_n));
    for (x, u) in in_buff.chain(slack).chain(in_draft) {
        if u >= force {
            reached =
                if last.is_infinite() || u == last { x } else { place + (x - place) * (force - last) / (u - last) };
            return w.max(reached);
        }
        (place, last) = (x, u);
        reached = x;
    }
    w.max(reached)
}

#[cfg(test)]
#[allow(clippy::excessive_precision)] // Reference numbers are given with all their digits.
mod tests;
