//! One step: the Taylor series of every spring and mass about an instant.

use super::DEGREE;
use crate::play::Play;
use crate::solve::local::{COEFFICIENTS, Local};

/// The chain as it is now, and where its motion stands: spring `i` at `i + 1` with a zero at either end, so that mass `v`
/// lies between springs `v` and `v + 1`.
#[derive(Clone, Debug)]
pub struct State {
    /// Of each spring; zero once it is broken.
    pub stiffness: Vec<f64>,
    /// Likewise.
    pub dashpot: Vec<f64>,
    /// 0 for a held mass.
    pub inverse_mass: Vec<f64>,
    /// Spring forces beyond the steady ones, and their rounding errors.
    pub force: [Vec<f64>; 2],
    /// Speeds against the steady motion, and their rounding errors.
    pub velocity: [Vec<f64>; 2],
    /// Mass on which the drive acts.
    pub source: usize,
}

impl State {
    /// At t = 0.
    pub fn new(play: &Play) -> State {
        let chain = &play.scene.chain;
        let masses = chain.mass.len();
        let padded = |x: &[f64]| std::iter::once(0.0).chain(x.iter().copied()).chain([0.0]).collect::<Vec<f64>>();
        State {
            stiffness: padded(&chain.stiffness),
            dashpot: padded(&play.dashpot),
            inverse_mass: (0..masses).map(|v| if chain.live(v) { 1.0 / chain.mass[v] } else { 0.0 }).collect(),
            force: [padded(&play.start), vec![0.0; masses + 1]],
            velocity: [play.velocity.clone(), vec![0.0; masses]],
            source: play.scene.source,
        }
    }

    /// Whether spring `i` is there.
    pub fn whole(&self, i: usize) -> bool {
        self.stiffness[i + 1] > 0.0
    }

    /// Breaks a spring: its force is now 0, which is minus the steady force beyond the steady one.
    pub fn break_spring(&mut self, i: usize, steady: f64) {
        (self.stiffness[i + 1], self.dashpot[i + 1]) = (0.0, 0.0);
        (self.force[0][i + 1], self.force[1][i + 1]) = (-steady, 0.0);
    }
}

/// The series of a step: entry `[k][i]` is the k-th derivative times `width^k / k!`.
#[derive(Clone, Debug)]
pub struct Series {
    /// Of spring forces beyond the steady ones, without dashpots.
    force: Vec<Vec<f64>>,
    velocity: Vec<Vec<f64>>,
    /// Of what dashpots carry.
    drag: Vec<Vec<f64>>,
    outside: [f64; DEGREE + 1],
}

impl Series {
    /// Room for a chain of that many masses.
    pub fn new(masses: usize) -> Series {
        let rows = |n: usize| vec![vec![0.0; n]; DEGREE + 1];
        Series { force: rows(masses + 1), velocity: rows(masses), drag: rows(masses + 1), outside: [0.0; DEGREE + 1] }
    }

    /// Expands the motion about the state under `outside`, the series of the drive.
    ///
    /// ```text
    /// F_i^(k+1) = k_i (v_i - v_{i+1})^(k)                      T_i = F_i + c_i (v_i - v_{i+1})
    /// v_j^(k+1) = (T_{j-1} - T_j + f)^(k) / m_j                (f on the source only)
    /// ```
    pub fn expand(&mut self, state: &State, width: f64, outside: impl FnOnce(&mut [f64])) {
        outside(&mut self.outside);
        for (row, [main, _]) in [(&mut self.force[0], &state.force), (&mut self.velocity[0], &state.velocity)] {
            row.copy_from_slice(main);
        }
        let masses = state.inverse_mass.len();
        for k in 0..=DEGREE {
            let share = width / (k + 1) as f64;
            // The state includes its rounding errors; their differences are taken separately, so that none is lost.
            let rest = (k == 0).then_some((&state.force[1], &state.velocity[1]));
            let (now, next) = self.force.split_at_mut((k + 1).min(DEGREE + 1));
            let (force, mut next) = (&now[k], next.first_mut());
            let (velocity, drag) = (&self.velocity[k], &mut self.drag[k]);
            for i in 1..masses {
                let mut apart = velocity[i - 1] - velocity[i];
                if let Some((_, v)) = rest {
                    apart += v[i - 1] - v[i];
                }
                drag[i] = state.dashpot[i] * apart;
                if let Some(next) = &mut next {
                    next[i] = share * state.stiffness[i] * apart;
                }
            }
            let Some(faster) = self.velocity.get_mut(k + 1) else { break };
            for v in 0..masses {
                let mut push = (force[v] - force[v + 1]) + (drag[v] - drag[v + 1]);
                if let Some((f, _)) = rest {
                    push += f[v] - f[v + 1];
                }
                if v == state.source {
                    push += self.outside[k];
                }
                faster[v] = share * state.inverse_mass[v] * push;
            }
        }
    }

    /// Norm of the motion's first derivative in energy, `sum (F')^2 / k + m (v')^2`.
    pub fn speed(&self, state: &State, width: f64) -> f64 {
        let pairs = self.force[1].iter().zip(&state.stiffness).filter(|p| *p.1 > 0.0);
        let springs: f64 = pairs.map(|(f, k)| f * f / k).sum();
        let pairs = self.velocity[1].iter().zip(&state.inverse_mass).filter(|p| *p.1 > 0.0);
        let masses: f64 = pairs.map(|(v, m)| v * v / m).sum();
        (springs + masses).sqrt() / width
    }

    /// Moves the state on by a share of the step.
    pub fn advance(&self, state: &mut State, share: f64) {
        let rows = [(&self.force, &mut state.force), (&self.velocity, &mut state.velocity)];
        for (series, [main, rest]) in rows {
            for i in 0..main.len() {
                let change = series[1..].iter().rev().fold(0.0, |sum, row| (sum + row[i]) * share);
                (main[i], rest[i]) = add(main[i], rest[i] + change);
            }
        }
    }

    /// Coefficients of `v_i - v_{i+1}` over the step from 0 to 1.
    pub fn apart(&self, i: usize) -> [f64; DEGREE + 1] {
        std::array::from_fn(|k| self.velocity[k][i] - self.velocity[k][i + 1])
    }

    /// Coefficients of coupler `i`'s force, the steady one included, over the step from 0 to 1.
    pub fn coupler(&self, i: usize, steady: f64) -> [f64; DEGREE + 1] {
        let mut out: [f64; DEGREE + 1] = std::array::from_fn(|k| self.force[k][i + 1] + self.drag[k][i + 1]);
        out[0] += steady;
        out
    }
}

/// The sum and its rounding error (Knuth).
fn add(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    let t = s - a;
    (s, (a - (s - t)) + (b - t))
}

/// The same polynomial about the middle of the step: over -1 <= x <= 1 instead of 0 to 1.
pub fn centred(coefficient: &[f64; DEGREE + 1], from: f64, width: f64) -> Local {
    let mut shifted = *coefficient;
    for j in 0..DEGREE {
        for k in (j..DEGREE).rev() {
            shifted[k] += 0.5 * shifted[k + 1];
        }
    }
    let mut scaled = [0.0; COEFFICIENTS];
    let mut half = 1.0;
    for (s, c) in scaled.iter_mut().zip(shifted) {
        *s = c * half;
        half *= 0.5;
    }
    Local { coefficient: scaled, terms: DEGREE + 1, center: from + 0.5 * width, radius: 0.5 * width }
}

/// A quick bound from above on `sign` times the polynomial over the step.
pub fn reach(coefficient: &[f64; DEGREE + 1], sign: f64) -> f64 {
    let end: f64 = coefficient.iter().rev().sum();
    let bend: f64 = coefficient.iter().enumerate().skip(2).map(|(k, c)| (k * (k - 1)) as f64 * c.abs()).sum();
    (sign * coefficient[0]).max(sign * end) + 0.125 * bend
}
