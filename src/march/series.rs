//! One step: the Taylor series of every elongation and speed about an instant, row by row.

use crate::solve::dd::two_sum;

/// The series' last power.
pub const DEGREE: usize = 20;

/// Terms are left out where they are under this share of the first.
const LAST_TERM: f64 = 1e-19;

/// The state of motion. Lists of couplers hold coupler `i` at `i + 1`, between zeros: vehicle `v` lies between entries
/// `v` and `v + 1`.
#[derive(Clone, Debug)]
pub struct State {
    /// Elongations less those at t = 0, and their rounding errors.
    pub q: [Vec<f64>; 2],
    /// Speeds, and their rounding errors.
    pub v: [Vec<f64>; 2],
    /// Each coupler's force less that at t = 0: `force + slope (q - place)`.
    pub place: Vec<f64>,
    pub force: Vec<f64>,
    pub slope: Vec<f64>,
    /// Dashpots; none if empty.
    pub dashpot: Vec<f64>,
    /// 0 for a held vehicle.
    pub inverse_mass: Vec<f64>,
    /// Steady force on each vehicle that the couplers' at t = 0 do not balance.
    pub unbalanced: Vec<f64>,
    /// Vehicles `from..to` move; the others, and the couplers beyond, are at rest.
    pub moving: [usize; 2],
}

/// Rows of coefficients: `[k][i]` is the k-th derivative times `width^k / k!`, indices as in [`State`].
#[derive(Clone, Debug)]
pub struct Series {
    pub q: Vec<Vec<f64>>,
    pub v: Vec<Vec<f64>>,
    pub terms: usize,
    /// Outside forces in time: vehicle and coefficient of each power.
    pub outside: Vec<Vec<(usize, f64)>>,
    /// Current power of each force less that at t = 0; and, of the power 0, its rounding error.
    tension: [Vec<f64>; 2],
    /// Per coupler: sum of the magnitudes of the powers from 2 on, and of each times its power.
    pub reach: Vec<f64>,
    pub reach_of_speed: Vec<f64>,
}

impl State {
    /// Elongation less that at t = 0.
    pub fn elongation(&self, i: usize) -> f64 {
        self.q[0][i + 1] + self.q[1][i + 1]
    }

    /// Force less that at t = 0.
    pub fn tension(&self, i: usize) -> f64 {
        let x = i + 1;
        let drag = if self.dashpot.is_empty() { 0.0 } else { self.dashpot[x] * self.speed_difference(i) };
        self.force[x] + self.slope[x] * ((self.q[0][x] - self.place[x]) + self.q[1][x]) + drag
    }

    /// Rate of the elongation.
    pub fn speed_difference(&self, i: usize) -> f64 {
        (self.v[0][i] - self.v[0][i + 1]) + (self.v[1][i] - self.v[1][i + 1])
    }

    /// Couplers beside vehicles that move.
    pub fn couplers(&self) -> std::ops::Range<usize> {
        self.moving[0].saturating_sub(1)..self.moving[1].min(self.v[0].len() - 1)
    }

    /// Upper bound on the rate of the motion (largest angular frequency plus damping rate) at the present slopes, 1/s.
    pub fn rate(&self) -> f64 {
        let (mut stiff, mut drag) = (0.0f64, 0.0f64);
        for v in self.moving[0]..self.moving[1] {
            stiff = stiff.max(self.inverse_mass[v] * (self.slope[v] + self.slope[v + 1]));
            if !self.dashpot.is_empty() {
                drag = drag.max(self.inverse_mass[v] * (self.dashpot[v] + self.dashpot[v + 1]));
            }
        }
        (2.0 * stiff).sqrt() + 2.0 * drag
    }
}

impl Series {
    pub fn new(vehicles: usize) -> Series {
        let rows = |n: usize| vec![vec![0.0; n]; DEGREE + 1];
        Series {
            q: rows(vehicles + 1),
            v: rows(vehicles),
            terms: DEGREE,
            outside: vec![Vec::new(); DEGREE + 1],
            tension: [vec![0.0; vehicles + 1], vec![0.0; vehicles + 1]],
            reach: vec![0.0; vehicles + 1],
            reach_of_speed: vec![0.0; vehicles + 1],
        }
    }

    /// Computes `terms` powers of the series over a width; `outside` is already that of the same step.
    ///
    /// Forces at the beginning of the step are kept with the rounding errors of `slope (q - place)` and of the sum with the dashpot's
    /// force, so that on lines with `force` 0 the rounding of a difference of two forces is a share of that difference, not of the
    /// forces.
    ///
    /// ```text
    /// q_i^(k+1) = (v_i - v_{i+1})^(k)        v_j^(k+1) = (F_{j-1} - F_j + f_j)^(k) / m_j
    /// ```
    pub fn expand(&mut self, state: &State, width: f64) {
        let [from, to] = state.moving;
        self.q[0][from..=to].copy_from_slice(&state.q[0][from..=to]);
        self.v[0][from..to].copy_from_slice(&state.v[0][from..to]);
        for x in from..=to {
            let (product, left) = two_product(state.slope[x], state.q[0][x] - state.place[x]);
            self.tension[0][x] = state.force[x] + product;
            self.tension[1][x] = left + state.slope[x] * state.q[1][x];
        }
        for k in 0..self.terms {
            let share = width / (k + 1) as f64;
            if k > 0 {
                let (tension, q, slope) =
                    (&mut self.tension[0][from..=to], &self.q[k][from..=to], &state.slope[from..=to]);
                tension.iter_mut().zip(q).zip(slope).for_each(|((t, q), s)| *t = s * q);
            }
            let next = &mut self.q[k + 1];
            speed_difference(&self.v[k], if k == 0 { Some(&state.v[1]) } else { None }, [from, to], next);
            if !state.dashpot.is_empty() {
                add_drag(&mut self.tension, state, next, k == 0, [from, to]);
            }
            next[from..=to].iter_mut().for_each(|x| *x *= share);
            let next = &mut self.v[k + 1][from..to];
            let [tension, left] = &self.tension;
            let pairs = tension[from..to].iter().zip(&tension[from + 1..=to]);
            let masses = state.inverse_mass[from..to].iter();
            if k > 0 {
                for ((v, m), (ahead, behind)) in next.iter_mut().zip(masses).zip(pairs) {
                    *v = share * m * (ahead - behind);
                }
            } else {
                let left = left[from..to].iter().zip(&left[from + 1..=to]);
                let forces = pairs.zip(left).zip(&state.unbalanced[from..to]);
                for ((v, m), (((ahead, behind), (of_ahead, of_behind)), f)) in next.iter_mut().zip(masses).zip(forces) {
                    *v = share * m * (((ahead - behind) + (of_ahead - of_behind)) + f);
                }
            }
            for &(v, f) in &self.outside[k] {
                next[v - from] += share * state.inverse_mass[v] * f;
            }
        }
        self.sum_reaches([from, to]);
    }

    fn sum_reaches(&mut self, [from, to]: [usize; 2]) {
        let (reach, fast) = (&mut self.reach[from..=to], &mut self.reach_of_speed[from..=to]);
        reach.fill(0.0);
        fast.fill(0.0);
        for k in (2..=self.terms).rev() {
            let row = &self.q[k][from..=to];
            for ((r, f), c) in reach.iter_mut().zip(fast.iter_mut()).zip(row) {
                *r += c.abs();
                *f += k as f64 * c.abs();
            }
        }
    }

    /// Cuts the step to a share of its width.
    pub fn cut(&mut self, state: &State, share: f64) {
        let [from, to] = state.moving;
        let mut power = 1.0;
        for k in 1..=self.terms {
            power *= share;
            self.q[k][from..=to].iter_mut().for_each(|c| *c *= power);
            self.v[k][from..to].iter_mut().for_each(|c| *c *= power);
            self.outside[k].iter_mut().for_each(|c| c.1 *= power);
        }
        self.sum_reaches([from, to]);
    }

    /// Moves the state on to the end of the step.
    pub fn advance(&self, state: &mut State) {
        let [from, to] = state.moving;
        let rows = [(&self.q, &mut state.q, from..to + 1), (&self.v, &mut state.v, from..to)];
        for (series, [main, rest], range) in rows {
            let mut change = [0.0; 64];
            // In blocks that stay in registers and the nearest cache.
            for start in range.clone().step_by(change.len()) {
                let block = start..(start + change.len()).min(range.end);
                let change = &mut change[..block.len()];
                change.fill(0.0);
                for row in series[1..=self.terms].iter().rev() {
                    change.iter_mut().zip(&row[block.clone()]).for_each(|(sum, c)| *sum += c);
                }
                for (i, change) in block.zip(change) {
                    [main[i], rest[i]] = two_sum(main[i], rest[i] + *change);
                }
            }
        }
    }

    /// Coefficients of `sign (elongation i - place)` over the step.
    pub fn elongation_from(&self, state: &State, i: usize, place: f64, sign: f64, out: &mut [f64; DEGREE + 1]) {
        let x = i + 1;
        out[0] = sign * ((state.q[0][x] - place) + state.q[1][x]);
        for (k, c) in out.iter_mut().enumerate().take(self.terms + 1).skip(1) {
            *c = sign * self.q[k][x];
        }
    }

    /// Coefficients of the rate of elongation `i` times the width, over the step.
    pub fn rate_of(&self, i: usize, sign: f64, out: &mut [f64; DEGREE + 1]) {
        for (k, row) in self.q.iter().enumerate().take(self.terms + 1).skip(1) {
            out[k - 1] = sign * k as f64 * row[i + 1];
        }
        out[self.terms] = 0.0;
    }

    /// Coefficients of coupler `i`'s force less that at t = 0, over a step of that width.
    pub fn tension_of(&self, state: &State, i: usize, width: f64, out: &mut [f64; DEGREE + 1]) {
        let x = i + 1;
        self.elongation_from(state, i, state.place[x], state.slope[x], out);
        out[0] += state.force[x];
        if !state.dashpot.is_empty() && width > 0.0 {
            for (k, row) in self.q.iter().enumerate().take(self.terms + 1).skip(1) {
                out[k - 1] += state.dashpot[x] * k as f64 * row[x] / width;
            }
        }
    }
}

/// Terms of a step; `phase`: width times the largest rate.
pub fn terms(phase: f64) -> usize {
    let mut term = 1.0;
    for k in 1..=DEGREE {
        term *= phase / k as f64;
        if term < LAST_TERM {
            return k.max(4);
        }
    }
    DEGREE
}

/// `v_i - v_{i+1}` for the couplers beside vehicles `from..to`; vehicles beyond stand still.
fn speed_difference(v: &[f64], rest: Option<&Vec<f64>>, [from, to]: [usize; 2], out: &mut [f64]) {
    let differences = |v: &[f64], out: &mut [f64]| {
        let pairs = v[from..to - 1].iter().zip(&v[from + 1..to]);
        out[from + 1..to].iter_mut().zip(pairs).for_each(|(o, (a, b))| *o += a - b);
        if from > 0 {
            out[from] -= v[from];
        }
        if to < v.len() {
            out[to] += v[to - 1];
        }
    };
    out[from..=to].fill(0.0);
    differences(v, out);
    if let Some(rest) = rest {
        differences(rest, out);
    }
}

/// Adds the dashpots' forces; at the `beginning` of a step with the rounding errors of the sums.
fn add_drag(
    [tension, left]: &mut [Vec<f64>; 2],
    state: &State,
    difference: &[f64],
    beginning: bool,
    [from, to]: [usize; 2],
) {
    for x in from..=to {
        let drag = state.dashpot[x] * difference[x];
        if beginning {
            let [sum, rest] = two_sum(tension[x], drag);
            (tension[x], left[x]) = (sum, left[x] + rest);
        } else {
            tension[x] += drag;
        }
    }
}

/// The product and its rounding error (Dekker, with Veltkamp's halves).
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let halves = |x: f64| {
        let high = 134_217_729.0 * x;
        let high = high - (high - x);
        (high, x - high)
    };
    let (product, (a, a_low), (b, b_low)) = (a * b, halves(a), halves(b));
    (product, ((a * b - product) + a * b_low + a_low * b) + a_low * b_low)
}

#[cfg(test)]
mod tests;
