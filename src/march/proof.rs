//! A proven error bound for linear couplers, alone or beside sliders of constant friction: the distance of two motions in the norm
//! below never grows there.
//!
//! Couplers are springs k, or kl in series with a spring h beside a slider of constant friction r, without slack; dashpots may lie
//! beside them. For two motions under the same forces in time
//!
//! ```text
//! W = sum m dv^2 + sum k dq^2 + sum (dF^2 / kl + h dw^2),       W' = -2 sum (dF - h dw) dw' - 2 sum c dq'^2 <= 0
//! ```
//!
//! because `F - h w` is in `r Sgn(w')`, a monotone relation. So `sqrt(W) <= integral of the residual`, the force per root of mass that the
//! computed motion would need beside the given ones; and `|dF| <= sqrt(kl W)`, with a dashpot `sqrt(k + c^2 (1 / m + 1 / m')) sqrt(W)`.
//!
//! **The rounding of a step**, in that norm and in unit roundoffs u = 2^-53, is at most `26 b S`, of a step that is cut `29 b S`, with
//! b the step's width and S the norm of the rate of the motion z and of all terms that are added up to it,
//! `S = (1 + 2 r) D + sum J |f|`: D the norm of z' (`dF^2 / kl + h dw^2 = s dq^2` with `s = h kl / (h + kl)` where the slider slips),
//! r = max c / sqrt(k m) the dashpots' share, J = 1 / sqrt(m) of the vehicle on which f acts. A step is no longer than `1 / omega`,
//! omega = sum of the largest angular frequency and damping rate, so that terms fall as `1 / k!`.
//!
//! - First terms: of a speed 7, four differences and sums, `1 / m`, and two products, each of at most `b S`; of an elongation 3. The
//!   forces whose difference it is, of spring and dashpot, are kept with their own rounding errors; the dashpot's three roundings are
//!   at most `6 r D`. The later terms carry them on, `e - 1` times in all: 12.1.
//! - Later terms: of a speed 5 each, and 2 of each coupler's force itself. Each force acts on two vehicles: these count `sqrt(2)` times:
//!   `7.9 sum (k - 1) / k! = 7.9`. Of the dashpot's share of such a force there is one more, which `5 * 2 r D` covers.
//! - A step that is cut at an event multiplies each term by a power: `sum k / k! = 2.8`.
//! - The sum of the terms from the last to the first: `1.72 + 0.72 + 0.22 + ... < 2.8`; the compensated sum with the state 1.8;
//!   the instant of the step's end, `u t`, another 1.
//!
//! Together that is less than 29, without cuts less than 26; the first term left out is 1e-19 of `b S`. Where nothing can cut a step,
//! couplers are linear, stay or have parted for good, and no vehicle stops.
//!
//! **Linear couplers.** D is constant but for the outside forces' own changes: `D <= D(0) + sum J TV(f)`, so that the error is known
//! before the motion is, `|error| <= 29 u S t` (26 where nothing cuts steps). A constant force that the couplers at t = 0 do not
//! balance is the sum of four numbers that were rounded once each, in three more roundings: `4 u` of their magnitudes. What is
//! shown, a force at an instant, rounds 16 times more, by shares of the motion's own norm, which grows by no more than D t.
//!
//! Motion under 1e-24 of the scale (`REST_LIMIT`) at the edges of the part that moves is set to 0 after each step, of at most 11
//! vehicles and couplers at either edge. There are at most 4 steps for each reciprocal of the largest rate, one for each kink of the
//! outside forces, and a few until the width of steps is what it was after a break or a first step that a kink has cut.
//!
//! **Couplers that break** ([`super::breaks`]). The instant of a break is known to within delta, the time in which the computed force is
//! within the bound of the force that breaks the coupler; over that time the computed and the true train differ by that coupler's
//! force T on both its vehicles, so that the error's norm grows by at most `delta T sqrt(1 / m + 1 / m')`. This assumes that the
//! coupler breaks in the true train too, whatever else may break there before it: [`super::certain`] proves that, or reports the
//! sequence as undecided. D is computed again after each break. A parted coupler carries no force from then on.
//!
//! **Constant friction.** The residual of each step is added as the motion has it, of the S of that step, and
//!
//! - force lines over the elongation: 8 u of the terms of each, and 16 u of the place on its curve;
//! - a coupler past its guard by less than the margin of an event: kl times the margin. The travel's error is never
//!   larger than that of the guards, so such errors add up only through the motion;
//! - outside forces: 4 u of each.
//!
//! The proof ends where a stop is reached, or a gap closes whose vehicles then push each other; it does not hold where couplers break
//! and their vehicles may push each other later, and for friction where a coupler parts after t = 0.

use super::branches::Branches;
use super::forces::{balance_rounding, kinks, measures};
use super::mode::{Coupler, Mode};
use super::run::{Run, stiffest};

/// Roundings of a step, and what cutting it adds; see above.
const ROUNDINGS: f64 = 26.0;
const CUT: f64 = 3.0;
/// Roundings of a force that is shown, beside those of its state.
const SHOWN: f64 = 16.0;
/// Vehicles and couplers that are set to rest in a step, at most.
const RESTED: f64 = 22.0;
/// Steps in the time of the reciprocal of the largest rate, at most, and those that a coupler that breaks and the start add.
const STEPS: f64 = 4.0;
const STEPS_OF_BREAK: f64 = 10.0;
const STEPS_AT_START: f64 = 40.0;
/// Unit roundoff u: largest relative error of one rounding, 2^-53.
pub const U: f64 = 0.5 * f64::EPSILON;
/// Least distance to a stop, and least gap, as a share of the elongation.
const CLEARANCE: f64 = 1e-6;

#[derive(Clone, Copy, Debug)]
pub struct Proof {
    /// Bound on `sqrt(W)` at `since`.
    norm: f64,
    since: f64,
    /// For linear couplers its growth per second from then on, the rounding of reported forces included; 0 for friction, where each
    /// step adds to `norm`.
    growth: f64,
    /// Norm of the motion at `since`; 0 for friction.
    motion: f64,
    /// Largest magnitude of a force: for linear couplers at t = 0, for friction over all steps so far.
    largest_n: f64,
    linear: bool,
    holds: bool,
}

impl Proof {
    /// For a march before its first step; `None` without a proof.
    pub fn new(run: &mut Run) -> Option<Proof> {
        let problem = run.problem;
        let in_family = problem.laws.iter().all(|law| Branches::new(law).constant_friction());
        let linear = problem.laws.iter().all(|law| law.is_linear());
        let parts = if problem.contact {
            problem.break_at_n.is_empty() && problem.gone.iter().all(|&i| run.start[i][1] >= 0.0)
        } else {
            linear
        };
        let largest_n = run.start.iter().map(|s| s[1].abs()).fold(0.0, f64::max);
        let mut proof = Proof { norm: 0.0, since: 0.0, growth: 0.0, motion: 0.0, largest_n, linear, holds: true };
        if !(in_family && parts) {
            return None;
        }
        proof.measure(run);
        Some(proof)
    }

    /// Whether the bound is known before the motion, as long as nothing breaks.
    pub fn is_known_before(&self) -> bool {
        self.linear
    }

    /// Adds the error of couplers that break now, each with its force, N, and the error of its instant, s.
    pub fn add_error_of_breaks(&mut self, run: &Run, broken: &[(usize, f64, f64)]) {
        let jolts = broken.iter().map(|(i, force, apart)| apart * force.abs() * run.root_inverse_mass(*i));
        self.norm += self.growth * (run.t - self.since) + jolts.sum::<f64>();
        self.since = run.t;
    }

    /// Norms of the motion and its rate as they are now, and the error's growth that follows from them.
    pub fn measure(&mut self, run: &mut Run) {
        if !self.linear {
            return;
        }
        let [rate, motion] = run.norms();
        let (problem, state) = (run.problem, &run.state);
        let (mut all, mut varied) = (0.0, 0.0);
        for (v, [largest, variation]) in measures(problem) {
            all += state.inverse_mass[v].sqrt() * largest;
            varied += state.inverse_mass[v].sqrt() * variation;
        }
        let norm = |force: &dyn Fn(usize) -> f64| -> f64 {
            (0..state.v[0].len()).map(|v| force(v).powi(2) * state.inverse_mass[v]).sum::<f64>().sqrt()
        };
        let unbalanced = norm(&|v| state.unbalanced[v]);
        let drag = |(i, law): (usize, &crate::law::Law)| {
            let masses = state.inverse_mass[i].max(state.inverse_mass[i + 1]);
            dashpot(run, i) * (masses / stiffest(law)).sqrt()
        };
        let drag = problem.laws.iter().enumerate().map(drag).fold(0.0, f64::max);
        let size = (1.0 + 2.0 * drag) * (rate + varied) + all + unbalanced;
        let balanced =
            4.0 * U * norm(&|v| balance_rounding(problem, &run.start, run.common_m_s2, &state.unbalanced, v));
        let single = kinks(problem) as f64 + STEPS_OF_BREAK * problem.laws.len() as f64 + STEPS_AT_START;
        let steps = STEPS * run.fastest() + single / problem.horizon_s.max(f64::MIN_POSITIVE);
        let cut = if problem.contact || !problem.break_at_n.is_empty() { CUT } else { 0.0 };
        self.growth = (ROUNDINGS + cut + SHOWN) * U * size + balanced + RESTED * steps * run.rest_norm();
        self.motion = motion;
    }

    /// Adds the residual of a step; the series are those cut to the step.
    pub fn step(&mut self, run: &Run, width: f64) {
        if width <= 0.0 {
            return;
        }
        let (state, series) = (&run.state, &run.series);
        if self.linear && !run.problem.contact {
            return;
        }
        let mut off = 0.0;
        // Of linear couplers, only whether gaps stay open.
        let linear = self.linear;
        for i in state.couplers().filter(|&i| !linear || run.couplers[i].parted) {
            let force = self.force_error(run, i);
            off += 2.0 * (state.inverse_mass[i] + state.inverse_mass[i + 1]) * force * force;
        }
        if self.linear {
            return;
        }
        let [from, to] = state.moving;
        let mut rate = 0.0;
        for v in (from..to).filter(|&v| state.inverse_mass[v] > 0.0) {
            rate += series.v[1][v] * series.v[1][v] / state.inverse_mass[v];
        }
        rate += state.couplers().map(|i| state.slope[i + 1] * series.q[1][i + 1].powi(2)).sum::<f64>();
        let (mut change, mut outside) = (0.0, 0.0);
        for (k, forces) in series.outside.iter().enumerate() {
            let sum: f64 = forces.iter().map(|&(v, f)| f.abs() * state.inverse_mass[v].sqrt()).sum();
            *(if k == 0 { &mut outside } else { &mut change }) += sum;
        }
        let speed = rate.sqrt() / width + change;
        self.norm += width * ((ROUNDINGS + CUT) * U * speed + off.sqrt() + 4.0 * U * (outside + change));
    }

    /// How far the computed force of a coupler may be from the law over the step; clears `holds` if the proof fails.
    fn force_error(&mut self, run: &Run, i: usize) -> f64 {
        let (state, series, coupler) = (&run.state, &run.series, &run.couplers[i]);
        let x = i + 1;
        let swing = series.q[1][x].abs() + series.reach[x];
        let now = series.q[0][x] + state.q[1][x];
        let place = coupler.start[0].abs() + now.abs() + swing;
        let span = (now - state.place[x]).abs() + swing;
        let sizes = state.force[x].abs() + coupler.start[1].abs() + state.slope[x] * span;
        self.largest_n = self.largest_n.max(if self.linear { 0.0 } else { sizes });
        let mut off = 8.0 * U * sizes;
        let past = run.guard_margin + 16.0 * U * place;
        let c = coupler.branches.compliance;
        match coupler.mode {
            Mode::Locked { .. } if now + swing >= coupler.upper - past || now - swing <= coupler.lower + past => {
                off += past / c
            }
            Mode::Locked { .. } => {}
            _ if coupler.is_open() => self.holds &= now - swing > coupler.lower + CLEARANCE * place || run.t == 0.0,
            _ => {
                off += 16.0 * U * state.slope[x] * place;
                // A coupler whose one interval ends here has reached its stop.
                self.holds &=
                    now + swing < coupler.upper - CLEARANCE * place && now - swing > coupler.lower + CLEARANCE * place;
            }
        }
        off
    }

    /// Bound on the error's norm up to the horizon, if nothing more breaks.
    pub fn norm_to(&self, horizon_s: f64) -> f64 {
        self.norm + self.growth * (horizon_s - self.since)
    }

    /// The bound on every force up to the horizon, if nothing more breaks, N.
    pub fn bound_n(&self, run: &Run) -> f64 {
        let stiffness = |c: &Coupler| if c.branches.compliance > 0.0 { 1.0 / c.branches.compliance } else { 0.0 };
        let mut factor = 0.0f64;
        for (i, (c, law)) in run.couplers.iter().zip(&run.problem.laws).enumerate() {
            let slopes = c.branches.intervals.iter().map(|p| p.up.slope).fold(stiffness(c), f64::max);
            let slopes = if self.linear { stiffest(law) } else { slopes };
            let masses = run.state.inverse_mass[i] + run.state.inverse_mass[i + 1];
            factor = factor.max((slopes + dashpot(run, i).powi(2) * masses).sqrt());
        }
        let past = run.couplers.iter().map(|c| stiffness(c) * run.guard_margin).fold(0.0, f64::max);
        let norm = self.norm_to(run.problem.horizon_s) + SHOWN * U * self.motion;
        factor * norm + SHOWN * U * self.largest_n + past
    }

    /// Whether the proof has held up to here.
    pub fn has_held(&self, run: &Run) -> bool {
        let no_contact = !run.problem.contact;
        let parted_later = run.partings.iter().any(|p| p.time_s > 0.0);
        self.holds && (no_contact || run.closures.is_empty() && !parted_later)
    }
}

/// The dashpot of a coupler that is whole.
fn dashpot(run: &Run, i: usize) -> f64 {
    run.problem.dashpot_n_s_per_m.get(i).copied().unwrap_or(0.0)
}

impl Run<'_> {
    /// Norms of the rate of the motion without the outside forces that change, and of the motion itself.
    fn norms(&mut self) -> [f64; 2] {
        self.grow();
        let width = 1.0 / self.fastest();
        if !width.is_finite() {
            return [0.0; 2];
        }
        self.series.outside.iter_mut().for_each(Vec::clear);
        self.series.terms = 1;
        self.series.expand(&self.state, width);
        let (state, series) = (&self.state, &self.series);
        let [from, to] = state.moving;
        let mut sums = [0.0; 2];
        for v in (from..to).filter(|&v| state.inverse_mass[v] > 0.0) {
            sums[0] += series.v[1][v].powi(2) / state.inverse_mass[v];
            sums[1] += state.v[0][v].powi(2) / state.inverse_mass[v];
        }
        for i in state.couplers() {
            sums[0] += state.slope[i + 1] * series.q[1][i + 1].powi(2);
            sums[1] += state.slope[i + 1] * state.q[0][i + 1].powi(2);
        }
        [sums[0].sqrt() / width, sums[1].sqrt()]
    }

    /// The norm of one vehicle or coupler at the limits of rest.
    fn rest_norm(&self) -> f64 {
        let [elongation, speed] = self.rest_limits;
        let solid = self.problem.laws.iter().map(stiffest).fold(0.0, f64::max);
        let heaviest = self.problem.mass_kg.iter().copied().fold(0.0, f64::max);
        solid.sqrt() * elongation + heaviest.sqrt() * speed
    }
}
