//! A proven bound for linear couplers, alone or beside sliders of constant friction: two motions never move apart
//! there.
//!
//! Couplers are springs k, or kl in series with a spring h beside a slider of constant friction r, without slack. For two
//! motions under the same forces in time
//!
//! ```text
//! W = sum m dv^2 + sum k dq^2 + sum (dF^2 / kl + h dw^2),       W' = -2 sum (dF - h dw) dw' <= 0
//! ```
//!
//! because `F - h w` is in `r Sgn(w')`, a monotone relation. So `sqrt(W) <= integral of the residual`, the force per root of mass that the
//! computed motion would need beside the given ones; and `|dF| <= sqrt(kl W)`. The residual is, in units u of half a last place:
//!
//! - `24 u S`, S the norm of the motion's rate, which the current stiffnesses give (`dF^2 / kl + h dw^2 = s dq^2` with
//!   `s = h kl / (h + kl)` where the slider slips): differences, products and sums of the series, as in `solve/taylor.rs`;
//! - force lines over the elongation: 8 u of the terms of each, and 16 u of the place on its curve;
//! - a coupler past its guard by less than the margin of an event: kl times the margin. The travel's error is never
//!   larger than that of the guards, so such errors add up only through the motion;
//! - outside forces: 4 u of each.
//!
//! The proof ends where a stop is reached, a gap closes, or a coupler parts after t = 0.

use super::mode::Mode;
use super::step::March;

const ROUNDINGS: f64 = 24.0;
/// Half a unit in the last place.
const U: f64 = 0.5 * f64::EPSILON;
/// Least distance to a stop, and least gap, as a share of the elongation.
const CLEARANCE: f64 = 1e-6;

#[derive(Clone, Debug)]
pub struct Proof {
    /// Bound on `sqrt(W)`.
    norm: f64,
    holds: bool,
}

impl Proof {
    /// For a march before its first step; `None` without a proof.
    pub fn new(march: &March) -> Option<Proof> {
        let problem = march.problem;
        let in_family = problem.laws.iter().all(|law| super::branches::Branches::new(law).constant_friction());
        let pulled = problem.gone.iter().all(|&i| march.start[i][1] >= 0.0);
        (in_family && pulled && problem.break_at_n.is_empty()).then_some(Proof { norm: 0.0, holds: true })
    }

    /// Adds the residual of a step; the series are those cut to the step.
    pub fn step(&mut self, march: &March, width: f64) {
        if width <= 0.0 {
            return;
        }
        let (state, series) = (&march.state, &march.series);
        let [from, to] = state.moving;
        let mut rate = 0.0;
        for v in (from..to).filter(|&v| state.inverse_mass[v] > 0.0) {
            rate += series.v[1][v] * series.v[1][v] / state.inverse_mass[v];
        }
        let mut off = 0.0;
        for i in state.couplers() {
            let x = i + 1;
            rate += state.slope[x] * series.q[1][x] * series.q[1][x];
            let force = self.force_error(march, i);
            off += 2.0 * (state.inverse_mass[i] + state.inverse_mass[x]) * force * force;
        }
        let (mut change, mut outside) = (0.0, 0.0);
        for (k, forces) in series.outside.iter().enumerate() {
            let sum: f64 = forces.iter().map(|&(v, f)| f.abs() * state.inverse_mass[v].sqrt()).sum();
            *(if k == 0 { &mut outside } else { &mut change }) += sum;
        }
        let speed = rate.sqrt() / width + change;
        self.norm += width * (ROUNDINGS * U * speed + off.sqrt() + 4.0 * U * (outside + change));
    }

    /// How far the computed force of a coupler may be from the law over the step; clears `holds` if the proof fails.
    fn force_error(&mut self, march: &March, i: usize) -> f64 {
        let (state, series, coupler) = (&march.state, &march.series, &march.couplers[i]);
        let x = i + 1;
        let swing = series.q[1][x].abs() + series.reach[x];
        let now = series.q[0][x] + state.q[1][x];
        let place = coupler.start[0].abs() + now.abs() + swing;
        let span = (now - state.place[x]).abs() + swing;
        let mut off = 8.0 * U * (state.force[x].abs() + coupler.start[1].abs() + state.slope[x] * span);
        let past = march.guard_margin + 16.0 * U * place;
        let c = coupler.branches.compliance;
        match coupler.mode {
            Mode::Locked { .. } if now + swing >= coupler.upper - past || now - swing <= coupler.lower + past => {
                off += past / c
            }
            Mode::Locked { .. } => {}
            _ if coupler.is_open() => self.holds &= now - swing > coupler.lower + CLEARANCE * place || march.t == 0.0,
            _ => {
                off += 16.0 * U * state.slope[x] * place;
                // A coupler whose one interval ends here has reached its stop.
                self.holds &=
                    now + swing < coupler.upper - CLEARANCE * place && now - swing > coupler.lower + CLEARANCE * place;
            }
        }
        off
    }

    /// The bound on every force, N.
    pub fn bound(&self, march: &March) -> Option<f64> {
        let holds = self.holds && march.closures.is_empty() && march.partings.iter().all(|p| p.time_s == 0.0);
        let stiffness =
            |c: &super::mode::Coupler| if c.branches.compliance > 0.0 { 1.0 / c.branches.compliance } else { 0.0 };
        let mut factor = 0.0f64;
        let mut rounding = 0.0f64;
        let dashpot = |i: usize| march.problem.dashpot_n_s_per_m.get(i).copied().unwrap_or(0.0);
        for (i, c) in march.couplers.iter().enumerate() {
            let slopes = c.branches.intervals.iter().map(|p| p.up.slope).fold(stiffness(c), f64::max);
            let masses = march.state.inverse_mass[i] + march.state.inverse_mass[i + 1];
            factor = factor.max((slopes + dashpot(i) * dashpot(i) * masses).sqrt());
            let peak = &march.record.extremes[i];
            rounding = rounding.max(peak.draft.force_n.abs().max(peak.buff.force_n.abs()) + c.start[1].abs());
        }
        let past = march.couplers.iter().map(|c| stiffness(c) * march.guard_margin).fold(0.0, f64::max);
        holds.then_some(factor * self.norm + 16.0 * U * rounding + past)
    }
}
