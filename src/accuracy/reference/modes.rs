//! Modes in long arithmetic, and their residual in the equations of motion.
//!
//! With `y_i = F_i / sqrt(k_i)` and `w_v = sqrt(m_v) x_v'` the motion under a unit force on mass s is
//!
//! ```text
//! y' = B w,    w' = -B^T y + e_s / sqrt(m_s),    y(0) = w(0) = 0
//! ```
//!
//! and the modes stand for `y = sum_j c_j u_j (1 - cos omega_j t) / omega_j`, `w = sum_j c_j v_j sin(omega_j t) / omega_j`
//! with `c_j = v_sj / sqrt(m_s)`. Put into the equations they leave, per unit of time, at most
//!
//! ```text
//! rate = || sum_j c_j v_j + rigid - e_s / sqrt(m_s) || + 3 sum_j |c_j / omega_j| || residual of mode j ||
//! ```
//!
//! and the error, which obeys the same equations driven by that, has an energy norm of at most `rate t`, because B's part
//! is skew. A wrong, lost or doubled mode shows in the first term, whatever went wrong in finding it.

use rayon::prelude::*;

use super::real::{Real, real, rounded};
use crate::chain::Chain;
use crate::solve::path::Path;

/// Frequencies and shares of a unit force.
#[derive(Clone, Debug)]
pub struct Modes {
    /// Frequencies, ascending.
    pub omega: Vec<Real>,
    /// `a_ij`, a row per spring.
    pub share: Vec<Vec<Real>>,
    /// Growth of the error's energy norm per unit of time and force.
    pub rate: f64,
}

/// One eigenvector on the line, of norm sqrt 2.
struct Mode {
    omega: Real,
    node: Vec<Real>,
    residual: f64,
}

impl Modes {
    /// All modes of a chain with their shares of a unit forward force on mass `source`.
    pub fn new(chain: &Chain, source: usize, bits: usize) -> Modes {
        let line = Line::new(chain, bits);
        let start = Path::new(chain).frequencies();
        let modes: Vec<Mode> = (0..start.len())
            .into_par_iter()
            .map(|j| line.mode(line.frequency(j, real(start[j].hi, bits) + real(start[j].lo, bits))))
            .collect();
        let root_mass = real(chain.mass[source], bits).sqrt();
        let drive: Vec<Real> = modes.iter().map(|m| &m.node[line.mass_node(source)] / &root_mass).collect();
        let row = |i: usize| -> Vec<Real> {
            let root = signed(real(chain.stiffness[i], bits).sqrt(), i + source);
            let node = line.spring_node(i);
            modes.iter().zip(&drive).map(|(m, c)| &root * &m.node[node] * c / &m.omega).collect()
        };
        let share = (0..chain.stiffness.len()).map(row).collect();
        let rate = missing(chain, source, &line, &modes, &drive) + residuals(&modes, &drive);
        Modes { omega: modes.into_iter().map(|m| m.omega).collect(), share, rate }
    }
}

/// The line's weights are all positive; the signs of B come back with the alternating signs of masses and springs.
fn signed(x: Real, place: usize) -> Real {
    if place.is_multiple_of(2) { x } else { -x }
}

/// `|| sum_j c_j v_j + rigid - e_s / sqrt(m_s) ||`
fn missing(chain: &Chain, source: usize, line: &Line, modes: &[Mode], drive: &[Real]) -> f64 {
    let zero = real(0.0, line.bits);
    let total = chain.mass.iter().fold(zero.clone(), |sum, &m| sum + real(m, line.bits));
    let rigid = !chain.held_head && !chain.held_tail;
    let square = |v: usize| {
        let root = real(chain.mass[v], line.bits).sqrt();
        let node = line.mass_node(v);
        let mut sum = modes.iter().zip(drive).fold(zero.clone(), |sum, (m, c)| sum + c * &m.node[node]);
        if rigid {
            sum += signed(&root / &total, v + source);
        }
        if v == source {
            sum -= real(1.0, line.bits) / root;
        }
        rounded(&sum).powi(2)
    };
    (0..chain.mass.len()).filter(|&v| chain.live(v)).map(square).sum::<f64>().sqrt()
}

fn residuals(modes: &[Mode], drive: &[Real]) -> f64 {
    modes.iter().zip(drive).map(|(m, c)| 3.0 * m.residual * rounded(&(c / &m.omega)).abs()).sum()
}

/// Live masses and springs in the order in which they stand: a symmetric matrix with a zero diagonal and `sqrt(k / m)`
/// beside it, whose positive eigenvalues are the frequencies.
struct Line {
    /// `k / m` between node l and node l + 1.
    square: Vec<Real>,
    /// Its root.
    root: Vec<Real>,
    /// Nodes before the first mass's spring: 1 if the first mass is live.
    lead: usize,
    bits: usize,
}

impl Line {
    fn new(chain: &Chain, bits: usize) -> Line {
        let mut square = Vec::new();
        for (i, &k) in chain.stiffness.iter().enumerate() {
            for v in [i, i + 1] {
                if chain.live(v) {
                    square.push(real(k, bits) / real(chain.mass[v], bits));
                }
            }
        }
        let root = square.iter().map(Real::sqrt).collect();
        Line { square, root, lead: usize::from(!chain.held_head), bits }
    }

    fn nodes(&self) -> usize {
        self.square.len() + 1
    }

    fn mass_node(&self, v: usize) -> usize {
        2 * v + self.lead - 1
    }

    fn spring_node(&self, i: usize) -> usize {
        2 * i + self.lead
    }

    fn zero(&self) -> Real {
        real(0.0, self.bits)
    }

    /// A pivot, or a negligible number in place of 0.
    fn pivot(&self, d: Real, omega: &Real) -> Real {
        if d == self.zero() { -(omega.clone() >> (2 * self.bits as isize)) } else { d }
    }

    /// How many eigenvalues are less than `shift`: the count of negative pivots is exact for weights changed by a few
    /// units in the last bit, and those move no eigenvalue by more than as many of its own units.
    fn below(&self, shift: &Real) -> usize {
        let mut d = -shift.clone();
        let mut negative = 1;
        for w in &self.square {
            d = -shift - w / self.pivot(d, shift);
            negative += usize::from(d < self.zero());
        }
        negative
    }

    /// The index-th positive eigenvalue: Rayleigh quotient iteration from a start, proved by two counts, or bisection.
    fn frequency(&self, index: usize, start: Real) -> Real {
        let target = self.nodes() - self.nodes() / 2 + index;
        let relative_width = real(0.5f64.powi(self.bits as i32 - 16) * self.nodes() as f64, self.bits);
        let mut omega = start.clone();
        for _ in 0..8 {
            let (gamma, z) = self.twisted(&omega);
            let change = gamma / squared(&z, self.zero());
            omega += &change;
            let small = rounded(&change).abs() <= rounded(&omega) * 0.5f64.powi(self.bits as i32 - 10);
            if small || omega <= self.zero() {
                break;
            }
        }
        let width = &omega * &relative_width;
        let (lo, hi) = (&omega - &width, &omega + &width);
        if omega > self.zero() && self.below(&lo) == target && self.below(&hi) == target + 1 {
            return omega;
        }
        self.bisect(target, start)
    }

    /// The eigenvalue with `target` others under it, from a bracket widened about `start` until it holds it.
    fn bisect(&self, target: usize, start: Real) -> Real {
        let (mut lo, mut hi) = (start.clone(), start);
        while self.below(&lo) > target {
            lo >>= 1;
        }
        while self.below(&hi) <= target {
            hi <<= 1;
        }
        for _ in 0..self.bits + 64 {
            let middle = (&lo + &hi) >> 1;
            let over = self.below(&middle) > target;
            *(if over { &mut hi } else { &mut lo }) = middle;
        }
        hi
    }

    /// `z` with `(T - omega) z = gamma e_r`, `z_r = 1`, r where |gamma| is least.
    fn twisted(&self, omega: &Real) -> (Real, Vec<Real>) {
        let n = self.nodes();
        let (mut left, mut right) = (vec![self.pivot(-omega, omega); n], vec![self.pivot(-omega, omega); n]);
        for l in 1..n {
            left[l] = self.pivot(-omega - &self.square[l - 1] / &left[l - 1], omega);
            let r = n - 1 - l;
            right[r] = self.pivot(-omega - &self.square[r] / &right[r + 1], omega);
        }
        let gamma: Vec<Real> = left.iter().zip(&right).map(|(p, q)| p + q + omega).collect();
        let size: Vec<f64> = gamma.iter().map(|g| rounded(g).abs()).collect();
        let twist = (0..n).fold(0, |best, l| if size[l] < size[best] { l } else { best });
        let mut z = vec![real(1.0, self.bits); n];
        for l in (0..twist).rev() {
            z[l] = -(&self.root[l] * &z[l + 1]) / &left[l];
        }
        for l in twist + 1..n {
            z[l] = -(&self.root[l - 1] * &z[l - 1]) / &right[l];
        }
        (gamma[twist].clone(), z)
    }

    /// The eigenvector of a frequency, and the norm of its residual, found by multiplying out.
    fn mode(&self, omega: Real) -> Mode {
        let (_, z) = self.twisted(&omega);
        let scale = (real(2.0, self.bits) / squared(&z, self.zero())).sqrt();
        let node: Vec<Real> = z.into_iter().map(|x| x * &scale).collect();
        let square = |l: usize| {
            let mut left_over = -(&omega * &node[l]);
            if l > 0 {
                left_over += &self.root[l - 1] * &node[l - 1];
            }
            if l + 1 < node.len() {
                left_over += &self.root[l] * &node[l + 1];
            }
            rounded(&left_over).powi(2)
        };
        let residual = (0..node.len()).map(square).sum::<f64>().sqrt();
        Mode { omega, node, residual }
    }
}

fn squared(z: &[Real], zero: Real) -> Real {
    z.iter().fold(zero, |sum, x| sum + x * x)
}
