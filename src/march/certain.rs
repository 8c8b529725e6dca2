//! Which couplers certainly break, whatever else may have broken shortly before.
//!
//! A side of a coupler *may* be over its limit from the instant at which its computed force comes within the bound of the limit, and
//! *certainly* is over it once the force is over the limit by more than the bound. Between these instants the coupler may have parted
//! in the true train, but not in the computed one. With T_j the forces of such couplers, each missing for at most the time tau_j
//! since it may be over, the force of another coupler differs by at most
//!
//! ```text
//! drift_i = J_i sum_{j != i} T_j J_j (k_i tau_j^2 / 2 + c_i tau_j)        J = sqrt(1 / m + 1 / m')
//! ```
//!
//! because the norm of the difference of the motions, `|z| <= sum T_j J_j tau_j`, bounds the difference of every relative speed by
//! `J_i |z|`. So every bound is widened by the drift. A coupler that passes its limit by more than the widened bound before the end of
//! these times breaks in the true train as well; couplers for which this holds and whose times overlap break together. Where it holds
//! for none, the sequence is undecided from the beginning of that time on.

use super::breaks::{Breaks, Coefficients, Found, Passing, SIGN, Step};
use super::roots;
use super::run::stiffest;
use crate::solve::local::{Local, reach};
use crate::solve::watch::PUSH;

/// Attempts to find a drift that is not smaller than the drift that follows from it.
const ROUNDS: usize = 40;

impl Breaks {
    /// The first couplers that break within a step; also notes the sides that come near their limits before that.
    pub fn find(&mut self, step: &Step) -> Option<Found> {
        let plain = self.passing(step, &[]);
        let waiting = self.undecided.is_none() && self.near.iter().flatten().any(Option::is_some);
        let (passing, broken) =
            if plain.is_empty() && !waiting { (plain, Vec::new()) } else { self.decide(step, plain) };
        let found = (!broken.is_empty()).then(|| step.found(broken.iter().map(|&n| &passing[n])));
        let share = found.as_ref().map_or(1.0, |f| f.share);
        let until = step.run.t + share * step.run.width;
        for p in passing.iter().filter(|p| p.from <= until) {
            self.near[p.coupler][p.side].get_or_insert(p.from);
        }
        for i in (0..self.left_limit.len()).filter(|&i| !step.run.couplers[i].parted) {
            for side in [0, 1] {
                if !self.left_limit[i][side] {
                    let value = SIGN[side] * roots::at(&step.force(i), share);
                    self.left_limit[i][side] = value < step.run.limit_n(i, side) - 4.0 * step.bound;
                }
            }
        }
        found
    }

    /// All sides that may be over their limits within a step, each bound widened by the coupler's drift; an empty `drift` is zero.
    pub fn passing(&self, step: &Step, drift: &[f64]) -> Vec<Passing> {
        let mut passing = Vec::new();
        for i in step.run.state.couplers().filter(|&i| !step.run.couplers[i].parted) {
            let force = step.force(i);
            let bound = step.bound + drift.get(i).unwrap_or(&0.0);
            for side in [0, 1] {
                if reach(&force, SIGN[side]) > step.run.limit_n(i, side) - bound {
                    passing.extend(self.passes(step, [i, side], force, bound));
                }
            }
        }
        passing
    }

    /// When a side passes the levels around its limit within a step.
    ///
    /// A side that stood at its limit at t = 0, and is not pushed above it, does not count until its force has been
    /// certainly under the limit.
    fn passes(&self, step: &Step, [coupler, side]: [usize; 2], force: Coefficients, bound: f64) -> Option<Passing> {
        let (from, width) = (step.run.t, step.run.width);
        let local = Local::of_step(&force.map(|c| SIGN[side] * c), from, width);
        let over = |level: f64| local.first_over(-1.0, 1.0, level).map(|x| from + 0.5 * (x + 1.0) * width);
        let limit = step.run.limit_n(coupler, side);
        let mut earliest = over(limit - bound)?;
        if !self.left_limit[coupler][side] {
            if !is_pushed_on(step, coupler, side) {
                return None;
            }
            earliest = 0.0;
        }
        let earliest = self.near[coupler][side].map_or(earliest, |t| t.min(earliest));
        let until = over(limit + bound);
        let at = until.and_then(|_| over(limit)).unwrap_or(from);
        Some(Passing { coupler, side, from: earliest, until, at, force })
    }

    /// The sides that may be over, and the places in that list of those that certainly break first.
    ///
    /// Where nothing is certain, the first to be over by the bound breaks, and the sequence is undecided from then on.
    pub fn decide(&mut self, step: &Step, plain: Vec<Passing>) -> (Vec<Passing>, Vec<usize>) {
        if self.undecided.is_none() {
            let overlooked = plain.iter().any(|p| self.was_overlooked(p));
            let proven = [true, false].into_iter().find_map(|together| self.proven(step, &plain, together));
            if let Some(proven) = proven.filter(|_| !overlooked) {
                return proven;
            }
            let before = self.near.iter().enumerate().flat_map(|(i, n)| n.iter().flatten().map(move |t| (i, *t)));
            let now = plain.iter().map(|p| (p.coupler, p.from));
            self.undecided = before.chain(now).min_by(|a, b| a.1.total_cmp(&b.1));
        }
        let untils = plain.iter().enumerate().filter_map(|(n, p)| Some((n, p.until?)));
        let first = untils.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(n, _)| n);
        (plain, first.into_iter().collect())
    }

    /// Whether a side may have been over before something else broke, and was not considered then.
    fn was_overlooked(&self, p: &Passing) -> bool {
        let last = self.last;
        p.from < last && self.near[p.coupler][p.side].is_none()
    }

    /// The sides that may be over, with bounds widened by the drift, and those that certainly break: if `together`, all certain
    /// ones that may be over before the first of them is certainly over, else the first alone. `None` where none is certain any more,
    /// or no drift is found that covers its result.
    fn proven(&self, step: &Step, plain: &[Passing], together: bool) -> Option<(Vec<Passing>, Vec<usize>)> {
        let was_certain = plain.iter().any(|p| p.until.is_some());
        let mut drift = vec![0.0; self.near.len()];
        let mut passing = plain.to_vec();
        for _ in 0..ROUNDS {
            let first = passing.iter().filter_map(|p| p.until).reduce(f64::min);
            let broken =
                |p: &Passing| p.until.is_some_and(|u| if together { Some(p.from) <= first } else { Some(u) == first });
            let end = passing.iter().filter(|p| broken(p)).filter_map(|p| p.until).reduce(f64::max);
            if was_certain && end.is_none() {
                return None;
            }
            let due = self.drift(step, &passing, end.unwrap_or(step.run.t + step.run.width));
            if due.iter().zip(&drift).all(|(due, has)| due <= has) {
                let broken = (0..passing.len()).filter(|&n| broken(&passing[n])).collect();
                return Some((passing, broken));
            }
            // The time grows with the drift: doubling soon covers it.
            drift.iter_mut().zip(due).for_each(|(has, due)| *has = has.max(2.0 * due));
            passing = self.passing(step, &drift);
        }
        None
    }

    /// How far each force may differ at `end` because couplers that may have broken before are missing, N.
    fn drift(&self, step: &Step, passing: &[Passing], end: f64) -> Vec<f64> {
        let run = step.run;
        // Of each coupler `T J tau` and `T J tau^2`.
        let mut push = vec![[0.0f64; 2]; self.near.len()];
        let now = passing.iter().filter(|p| p.from <= end).map(|p| (p.coupler, p.from));
        let before = self.near.iter().enumerate().flat_map(|(i, n)| n.iter().flatten().map(move |t| (i, *t)));
        for (i, from) in before.chain(now) {
            let course = step.force(i);
            let force = SIGN.map(|sign| reach(&course, sign)).into_iter().fold(0.0, f64::max);
            let limits = [0, 1].map(|side| run.limit_n(i, side)).into_iter().filter(|limit| limit.is_finite());
            let (size, tau) = (limits.fold(force, f64::max) * run.root_inverse_mass(i), end - from);
            push[i] = [push[i][0].max(size * tau), push[i][1].max(size * tau * tau)];
        }
        let all = push.iter().fold([0.0; 2], |sum, p| [sum[0] + p[0], sum[1] + p[1]]);
        let moved = |i: usize| {
            if run.couplers[i].parted {
                return 0.0;
            }
            let [once, twice] = [0, 1].map(|q| (all[q] - push[i][q]).max(0.0));
            let dashpot = run.problem.dashpot_n_s_per_m.get(i).unwrap_or(&0.0);
            run.root_inverse_mass(i) * (dashpot * once + 0.5 * stiffest(&run.problem.laws[i]) * twice)
        };
        (0..push.len()).map(moved).collect()
    }
}

/// Whether the force of a side that stood at its limit rises above it: at first after t = 0, or at either end of the step. Only the
/// change since t = 0 is used: added to the load, a small rise would be lost in rounding.
fn is_pushed_on(step: &Step, coupler: usize, side: usize) -> bool {
    let moved = step.change(coupler).map(|c| SIGN[side] * c);
    let first = if step.run.t == 0.0 { moved.iter().find(|c| **c != 0.0) } else { None };
    let least = PUSH * step.bound;
    first.is_some_and(|c| *c > 0.0) || moved[0] > least || roots::at(&moved, 1.0) > least
}
