//! Events that end a step, the part of the train that moves, and preparations of a step.

use super::Problem;
use super::mode::{Coupler, End, Mode};
use super::roots;
use super::series::DEGREE;
use super::step::{EventKind, March};

/// Terms are left out where they are under this share of the first.
const LAST_TERM: f64 = 1e-19;
/// Events closer than this share of their time are at one instant.
const TOGETHER: f64 = 4.0 * f64::EPSILON;
/// An unbalanced steady force under this share of the largest force counts as 0.
const BALANCE: f64 = 1e-12;

/// An event: its share of the step, its coupler or vehicle, its kind.
pub type Event = (f64, usize, EventKind);

/// The events that come first, all at one instant.
struct Earliest {
    share: f64,
    events: Vec<Event>,
}

impl Earliest {
    fn take(&mut self, share: f64, i: usize, what: EventKind) {
        if share > self.share * (1.0 + TOGETHER) {
            return;
        }
        if share < self.share * (1.0 - TOGETHER) {
            self.events.clear();
        }
        self.share = self.share.min(share);
        if !self.events.iter().any(|e| e.1 == i) {
            self.events.push((share, i, what));
        }
    }
}

impl March<'_> {
    /// The events of the first instant in the step of that width that has any.
    pub fn first_event(&self, width: f64) -> Vec<Event> {
        let mut first = Earliest { share: 1.0, events: Vec::new() };
        self.breaks(width, &mut first);
        self.ends_of_modes(&mut first);
        self.stops(&mut first);
        first.events
    }

    fn ends_of_modes(&self, first: &mut Earliest) {
        let (state, series, past) = (&self.state, &self.series, self.guard_margin);
        let mut c = [0.0; DEGREE + 1];
        let n = series.terms;
        for i in state.couplers() {
            let coupler = &self.couplers[i];
            let (q, rise, reach) = (state.elongation(i), series.q[1][i + 1], series.reach[i + 1]);
            if q + rise.max(0.0) + reach > coupler.upper + past {
                series.elongation_from(state, i, coupler.upper + past, 1.0, &mut c);
                if let Some(s) = roots::first_positive(&c[..=n]) {
                    first.take(s, i, EventKind::Mode(End::Upper));
                }
            }
            if q + rise.min(0.0) - reach < coupler.lower - past {
                series.elongation_from(state, i, coupler.lower - past, -1.0, &mut c);
                if let Some(s) = roots::first_positive(&c[..=n]) {
                    first.take(s, i, EventKind::Mode(End::Lower));
                }
            }
            if coupler.turn != 0.0 && -coupler.turn * rise + series.reach_of_speed[i + 1] > 0.0 {
                series.rate_of(i, -coupler.turn, &mut c);
                if let Some(s) = roots::first_positive(&c[..n]) {
                    first.take(s, i, EventKind::Mode(End::Turn));
                }
            }
        }
    }

    /// Couplers that pass the force at which they break, where no bound is proven.
    fn breaks(&self, width: f64, first: &mut Earliest) {
        let mut c = [0.0; DEGREE + 1];
        let n = self.series.terms;
        let whole = |i: &usize| self.breaks.is_none() && !self.couplers[*i].parted;
        for i in self.state.couplers().filter(|i| whole(i) && *i < self.problem.break_at_n.len()) {
            self.series.tension_of(&self.state, i, width, &mut c);
            let total = c[0] + self.start[i][1];
            for (sense, limit) in self.problem.break_at_n[i].iter().enumerate() {
                let sign = if sense == 0 { 1.0 } else { -1.0 };
                let mut over = c.map(|c| sign * c);
                over[0] = sign * total - limit;
                if limit.is_finite()
                    && let Some(s) = roots::first_positive(&over[..=n])
                {
                    first.take(s, i, EventKind::Breaks);
                }
            }
        }
    }

    /// Braked vehicles that come to a stand.
    fn stops(&self, first: &mut Earliest) {
        let Some(common) = self.problem.common_speed_m_s else { return };
        let sign = self.problem.direction();
        let [from, to] = self.state.moving;
        for v in (from..to).filter(|&v| self.forces.brakes(v, self.t)) {
            let n = self.series.terms;
            let mut c = [0.0; DEGREE + 1];
            for (c, row) in c.iter_mut().zip(&self.series.v).take(n + 1) {
                *c = -sign * row[v];
            }
            c[0] -= sign * (common + self.common_m_s2 * self.t);
            c[1] -= sign * self.common_m_s2 * self.width;
            if let Some(s) = roots::first_positive(&c[..=n]) {
                first.take(s, v, EventKind::Stops);
            }
        }
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

impl Coupler {
    /// Parted, and the vehicles do not touch.
    pub fn is_open(&self) -> bool {
        self.parted && self.mode == Mode::Free(self.branches.intervals.len() - 1)
    }
}

/// Terms of a step; `phase`: width times the largest rate.
pub fn terms(phase: f64) -> usize {
    let mut term = 1.0;
    for k in 1..=DEGREE {
        term *= phase / k as f64;
        // Two in place of one: an elongation takes two powers for each vehicle.
        if term < LAST_TERM {
            return k.max(4);
        }
    }
    DEGREE
}

/// Steady force on each vehicle that the couplers' at t = 0 do not balance, and the common acceleration.
pub fn unbalanced(problem: &Problem, start: &[[f64; 2]]) -> (Vec<f64>, f64) {
    let n = problem.mass_kg.len();
    let free = !problem.held_head && !problem.held_tail;
    let total: f64 = problem.steady_n.iter().sum();
    let common = if free { total / problem.mass_kg.iter().sum::<f64>() } else { 0.0 };
    let largest = start.iter().map(|s| s[1].abs()).chain(problem.steady_n.iter().map(|f| f.abs())).fold(0.0, f64::max);
    let tension = |i: Option<usize>| i.and_then(|i| start.get(i)).map_or(0.0, |s| s[1]);
    let mut left: Vec<f64> = (0..n)
        .map(|v| tension(v.checked_sub(1)) - tension(Some(v)) + problem.steady_n[v] - common * problem.mass_kg[v])
        .collect();
    left.iter_mut().filter(|f| f.abs() <= BALANCE * largest).for_each(|f| *f = 0.0);
    let small = common.abs() * problem.mass_kg.iter().copied().fold(0.0, f64::max) <= BALANCE * largest;
    (left, if small { 0.0 } else { common })
}

/// The magnitudes of what the unbalanced force on a vehicle is the sum of; 0 where that counts as 0.
pub fn balance_rounding(
    problem: &Problem,
    start: &[[f64; 2]],
    common_m_s2: f64,
    unbalanced: &[f64],
    vehicle: usize,
) -> f64 {
    if unbalanced[vehicle] == 0.0 {
        return 0.0;
    }
    let tension = |i: Option<usize>| i.and_then(|i| start.get(i)).map_or(0.0, |s| s[1].abs());
    let inertia = (common_m_s2 * problem.mass_kg[vehicle]).abs();
    tension(vehicle.checked_sub(1)) + tension(Some(vehicle)) + problem.steady_n[vehicle].abs() + inertia
}
