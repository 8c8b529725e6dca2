//! One run of a march: the train as it is at an instant.

use super::forces::{Forces, unbalanced};
use super::mode::Coupler;
use super::series::{DEGREE, Series, State};
use super::{Parting, Problem};
use crate::law::Law;

/// A mode ends only once the elongation is past its guard by this share of the largest length scale of the elongations:
/// about 1e-15 m where they are some 40 mm. The law is continuous, so this changes a force by at most that
/// distance times kl.
const GUARD_MARGIN: f64 = 2.5e-14;
/// At the edge of the part that moves, motion under this share of the scale is 0.
const REST_LIMIT: f64 = 1e-24;

/// Settings of a run: the differences between runs of one problem with different settings give the error estimate.
#[derive(Clone, Copy, Debug)]
pub struct RunSettings {
    /// Largest step times the largest rate.
    pub phase: f64,
    /// Seed of the noise on every elongation and speed at every step, and its size in unit roundoffs (2^-53 of the value).
    pub noise: Option<(u64, f64)>,
    /// How many times [`GUARD_MARGIN`] an event needs past its guard.
    pub margin: f64,
}

/// The train as it is, and what has happened to it.
pub struct Run<'a> {
    pub problem: &'a Problem,
    pub settings: RunSettings,
    pub couplers: Vec<Coupler>,
    /// Elongation and force of each coupler at t = 0.
    pub start: Vec<[f64; 2]>,
    pub state: State,
    /// Of the step as tried or cut.
    pub series: Series,
    pub forces: Forces,
    pub partings: Vec<Parting>,
    pub closures: Vec<(usize, f64)>,
    pub stopped: Option<(usize, f64)>,
    pub t: f64,
    /// Common acceleration that is subtracted.
    pub common_m_s2: f64,
    /// How far past its guard an event is.
    pub guard_margin: f64,
    /// Elongation and speed that count as 0 at the edge of what moves.
    pub rest_limits: [f64; 2],
    /// Width of the step as tried.
    pub width: f64,
    random: u64,
}

impl<'a> Run<'a> {
    /// Before anything parts.
    pub fn new(problem: &'a Problem, settings: RunSettings) -> Run<'a> {
        let n = problem.mass_kg.len();
        let live = |v: usize| !(v == 0 && problem.held_head || v + 1 == n && problem.held_tail);
        let couplers: Vec<Coupler> = problem.laws.iter().zip(&problem.start).map(|(l, r)| Coupler::new(l, r)).collect();
        let start: Vec<[f64; 2]> = couplers.iter().map(|c| c.start).collect();
        let (unbalanced, common_m_s2) = unbalanced(problem, &start);
        let zeros = || vec![0.0; n + 1];
        let dashpot = &problem.dashpot_n_s_per_m;
        let dashpot =
            if dashpot.iter().all(|c| *c == 0.0) { Vec::new() } else { [&[0.0], &dashpot[..], &[0.0]].concat() };
        let state = State {
            q: [zeros(), zeros()],
            v: [problem.speed_m_s.clone(), vec![0.0; n]],
            place: zeros(),
            force: zeros(),
            slope: zeros(),
            dashpot,
            inverse_mass: (0..n).map(|v| if live(v) { 1.0 / problem.mass_kg[v] } else { 0.0 }).collect(),
            unbalanced,
            moving: [0, n],
        };
        let mut run = Run {
            settings,
            couplers,
            start,
            state,
            series: Series::new(n),
            forces: Forces::of(problem),
            partings: Vec::new(),
            closures: Vec::new(),
            stopped: None,
            t: 0.0,
            common_m_s2: common_m_s2 + problem.common_m_s2,
            guard_margin: 0.0,
            rest_limits: [0.0; 2],
            width: 0.0,
            random: settings.noise.map_or(0, |n| n.0),
            problem,
        };
        (0..run.couplers.len()).for_each(|i| run.set_line(i));
        run.set_scales();
        run
    }

    /// Sets the margin past guards and the limits of rest.
    fn set_scales(&mut self) {
        let softest = self.problem.laws.iter().map(stiffest).fold(f64::INFINITY, f64::min);
        let rate = self.fastest();
        let speed_difference = self.state.v[0].windows(2).map(|v| (v[0] - v[1]).abs()).fold(0.0, f64::max);
        let mut scale = if speed_difference > 0.0 && rate > 0.0 { speed_difference / rate } else { 0.0 };
        for (s, law) in self.start.iter().zip(&self.problem.laws) {
            scale = scale.max(s[0].abs()).max(0.5 * law.slack_m());
        }
        if softest > 0.0 && softest.is_finite() {
            let drive = |d: &(usize, crate::forcing::Drive)| d.1.measures()[0];
            let force = self.problem.forcing.iter().map(drive).chain(self.state.unbalanced.iter().map(|f| f.abs()));
            scale = scale.max(force.chain(self.problem.brakes_n()).fold(0.0, f64::max) / softest);
        }
        self.guard_margin = self.settings.margin * GUARD_MARGIN * scale;
        self.rest_limits = [REST_LIMIT * scale, REST_LIMIT * scale * rate];
    }

    /// Upper bound on the rate of the motion (largest angular frequency plus damping rate), every coupler at its stiffest, 1/s.
    pub fn fastest(&self) -> f64 {
        let laws = &self.problem.laws;
        let stiffness = |i: Option<usize>| i.and_then(|i| laws.get(i)).map_or(0.0, stiffest);
        let of = |(v, m): (usize, &f64)| m * (stiffness(v.checked_sub(1)) + stiffness(Some(v)));
        let damping = |(v, m): (usize, &f64)| {
            let c = &self.problem.dashpot_n_s_per_m;
            m * (v.checked_sub(1).and_then(|i| c.get(i)).unwrap_or(&0.0) + c.get(v).unwrap_or(&0.0))
        };
        let masses = || self.state.inverse_mass.iter().enumerate();
        (2.0 * masses().map(of).fold(0.0, f64::max)).sqrt() + 2.0 * masses().map(damping).fold(0.0, f64::max)
    }

    pub fn set_line(&mut self, i: usize) {
        let line = self.couplers[i].line;
        (self.state.place[i + 1], self.state.force[i + 1], self.state.slope[i + 1]) =
            (line.place, line.force, line.slope);
    }

    /// Coupler `i` parts now, an instant with this error; returns the energy that it releases, J.
    pub fn part(&mut self, i: usize, uncertainty_s: f64) -> f64 {
        let force_n = self.start[i][1] + self.state.tension(i);
        let q = self.state.elongation(i);
        let before_j = self.couplers[i].energy(q);
        self.couplers[i].part(Some(&self.problem.laws[i]).filter(|_| self.problem.contact), q);
        let energy_j = before_j - self.couplers[i].energy(q);
        if let Some(c) = self.state.dashpot.get_mut(i + 1) {
            *c = 0.0;
        }
        self.set_line(i);
        self.partings.push(Parting { coupler: i, time_s: self.t, force_n, energy_j, uncertainty_s });
        if let Some(emergency) = &self.problem.emergency {
            self.forces.apply_from_coupler(emergency, self.problem.direction(), i, self.t);
        }
        energy_j
    }

    /// The force at which a coupler breaks in one sense, positive; infinite for never.
    pub fn limit_n(&self, i: usize, side: usize) -> f64 {
        self.problem.break_at_n.get(i).map_or(f64::INFINITY, |limits| limits[side])
    }

    /// `sqrt(1 / m + 1 / m')` of the vehicles at a coupler.
    pub fn root_inverse_mass(&self, i: usize) -> f64 {
        (self.state.inverse_mass[i] + self.state.inverse_mass[i + 1]).sqrt()
    }

    /// The series of a step of that width.
    pub fn expand(&mut self, width: f64) {
        let Series { outside, terms, .. } = &mut self.series;
        outside.iter_mut().for_each(Vec::clear);
        let [from, to] = self.state.moving;
        self.forces.expand(self.t, width, *terms, |v, k, f| {
            debug_assert!(f == 0.0 || (from..to).contains(&v), "a force acts on a vehicle at rest");
            if f != 0.0 && (from..to).contains(&v) {
                outside[k].push((v, f));
            }
        });
        self.series.expand(&self.state, width);
    }

    /// Extends the part that moves as far as the series of one step reaches.
    pub fn grow(&mut self) {
        let n = self.state.v[0].len();
        let [from, to] = self.state.moving;
        let (mut from, mut to) = (from, to);
        for v in self.forces.forced_vehicles(self.t) {
            (from, to) = (from.min(v), to.max(v + 1));
        }
        let margin = DEGREE / 2 + 1;
        self.state.moving = [from.saturating_sub(margin), (to + margin).min(n)];
    }

    /// Leaves out what is at rest at either end of the part that moves.
    pub fn shrink(&mut self) {
        let [mut from, mut to] = self.state.moving;
        while to - from > 1 && self.set_at_rest(from, from) {
            from += 1;
        }
        while to - from > 1 && self.set_at_rest(to - 1, to) {
            to -= 1;
        }
        self.state.moving = [from, to];
    }

    /// Whether vehicle `v` and the coupler at entry `x` beside it are at rest; if so, sets both to 0.
    fn set_at_rest(&mut self, v: usize, x: usize) -> bool {
        let s = &mut self.state;
        let [q, speed] = self.rest_limits;
        let tension = s.force[x] + s.slope[x] * ((s.q[0][x] - s.place[x]) + s.q[1][x]);
        let rests = s.v[0][v].abs() <= speed
            && s.unbalanced[v] == 0.0
            && s.q[0][x].abs() <= q
            && tension.abs() <= s.slope[x] * q;
        if rests {
            (s.v[0][v], s.v[1][v], s.q[0][x], s.q[1][x]) = (0.0, 0.0, 0.0, 0.0);
        }
        rests
    }

    /// Adds noise like rounding to every elongation and speed in motion.
    pub fn disturb(&mut self) {
        let Some((_, size)) = self.settings.noise else { return };
        let unit = size * 0.5 * f64::EPSILON;
        for i in self.state.couplers() {
            // Ahead of the wave, noise must not set vehicles in motion.
            let moved = self.state.q[0][i + 1];
            let scale = (self.start[i][0] + moved).abs().min(1e3 * moved.abs());
            self.state.q[1][i + 1] += unit * scale * self.noise();
        }
        for v in self.state.moving[0]..self.state.moving[1] {
            self.state.v[1][v] += unit * self.state.v[0][v] * self.noise();
        }
    }

    /// Uniform from -1 to 1 (xorshift64*).
    fn noise(&mut self) -> f64 {
        let x = &mut self.random;
        *x ^= *x >> 12;
        *x ^= *x << 25;
        *x ^= *x >> 27;
        let bits = x.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11;
        bits as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// The largest slope of a law.
pub fn stiffest(law: &Law) -> f64 {
    match law {
        Law::Elastic { draft_n_per_m, buff_n_per_m, .. } => draft_n_per_m.max(*buff_n_per_m),
        Law::Gear { solid_n_per_m, .. } => *solid_n_per_m,
    }
}
