//! The chain as a weighted path, and its frequencies and modes to full relative accuracy.
//!
//! Live masses and springs alternate along the train. With `y_i = F_i / sqrt(k_i)` and `w_v = sqrt(m_v) x_v'` the
//! equations of motion are `y' = B w`, `w' = -B^T y`, and B couples a spring only to the two masses beside it. Put masses
//! and springs in the order in which they stand in the train: the matrix [[0, B^T], [B, 0]] becomes tridiagonal with a
//! zero diagonal and the entries `g = sqrt(k / m)` beside it (G. Golub, W. Kahan, *SIAM J. Numer. Anal. B* 2 (1965)
//! 205-224). Free and held ends differ only in whether the path ends in a mass or in a spring. Its eigenvalues are
//! +omega, -omega, and 0 when the path has an odd number of nodes (the rigid motion, or the preload between two held ends).
//!
//! Every step below perturbs each `g^2` by a few units in its last place and nothing else, and such perturbations move
//! every eigenvalue, however small, by a few units in its own last place (J. Demmel, W. Kahan, *SIAM J. Sci. Stat. Comput.*
//! 11 (1990) 873-912). No product `B B^T` is ever formed: it would square the ratio of stiff to soft.

use rayon::prelude::*;

use super::dd::{Dd, LANES, Lanes};
use crate::chain::Chain;

/// A frequency is alone where others are further away than this share of it: a thousand times a bracket's width.
const ALONE: f64 = 1e-9;
/// The iteration has converged when a step is under this share of the frequency.
const NO_CHANGE: f64 = 1e-28;
/// After this many steps the iteration is replaced by bisection.
const MOST_ROUNDS: usize = 5;

/// The weighted path of a chain.
#[derive(Clone, Debug)]
pub struct Path {
    /// `g^2 = k / m` between node l and node l + 1.
    weight: Vec<Dd>,
    /// `g`
    root: Vec<Dd>,
    /// The first node is a mass (the head is free).
    begins_with_mass: bool,
}

/// One mode: a pair of equal and opposite eigenvalues of the path.
#[derive(Clone, Debug)]
pub struct Mode {
    /// Frequency, > 0.
    pub omega: Dd,
    /// Eigenvector on the nodes, of norm sqrt 2: its springs, and its masses, each have norm 1.
    pub node: Vec<Dd>,
    /// Norm of the residual of the eigen-equation for that vector.
    pub residual: f64,
}

impl Path {
    /// The path of a chain; a chain of held masses without a live one has no mode.
    pub fn new(chain: &Chain) -> Path {
        let mut weight = Vec::with_capacity(2 * chain.stiffness.len());
        let last = chain.mass.len() - 1;
        for (i, &k) in chain.stiffness.iter().enumerate() {
            if !(i == 0 && chain.held_head) {
                weight.push(Dd::quotient(k, chain.mass[i]));
            }
            if !(i + 1 == last && chain.held_tail) {
                weight.push(Dd::quotient(k, chain.mass[i + 1]));
            }
        }
        let root = weight.iter().map(|w| w.sqrt()).collect();
        Path { weight, root, begins_with_mass: !chain.held_head }
    }

    /// Number of nodes: live masses and springs.
    pub fn nodes(&self) -> usize {
        self.weight.len() + 1
    }

    /// Node of mass `v`, a live one.
    pub(crate) fn mass_node(&self, v: usize) -> usize {
        if self.begins_with_mass { 2 * v } else { 2 * v - 1 }
    }

    /// Node of spring `i`.
    pub(crate) fn spring_node(&self, i: usize) -> usize {
        if self.begins_with_mass { 2 * i + 1 } else { 2 * i }
    }

    /// An upper bound on the largest frequency: the largest row sum.
    pub(crate) fn omega_bound(&self) -> f64 {
        let g = |l: Option<&Dd>| l.map_or(0.0, |w| w.hi.sqrt());
        let row = |l: usize| g(l.checked_sub(1).and_then(|p| self.weight.get(p))) + g(self.weight.get(l));
        (0..self.nodes()).map(row).fold(0.0, f64::max) * (1.0 + 1e-15)
    }

    /// An upper bound on the largest frequency within 0.2 %: three rounds of counting, each of which divides the bracket by 9.
    pub fn omega_max(&self) -> f64 {
        let weight: Vec<f64> = self.weight.iter().map(|w| w.hi).collect();
        let (mut lo, mut hi) = (0.5 * self.omega_bound(), self.omega_bound() * (1.0 + 1e-14));
        for _ in 0..3 {
            let step = (hi - lo) / (LANES + 1) as f64;
            let shift = std::array::from_fn(|k| lo + (k + 1) as f64 * step);
            let found = below(&weight, &shift);
            let all = found.iter().take_while(|&&n| n < self.nodes()).count();
            (lo, hi) = (lo + all as f64 * step, if all < LANES { shift[all] } else { hi });
        }
        hi
    }

    /// All frequencies, ascending, each to about 30 digits of its own size.
    pub fn frequencies(&self) -> Vec<Dd> {
        self.modes().into_iter().map(|mode| mode.omega).collect()
    }

    /// All modes, by ascending frequency.
    pub fn modes(&self) -> Vec<Mode> {
        let brackets = self.bisect();
        let first: Vec<usize> = (0..brackets.len()).step_by(LANES).collect();
        let group = |first: usize| super::vectors::widest().dispatch(Group { path: self, brackets: &brackets, first });
        first.into_par_iter().flat_map_iter(group).collect()
    }

    /// A mode of a frequency from [`Path::modes`], by the factorisation about its `copy`-th twist node, from 0 (`Path::twisted`).
    pub fn mode(&self, omega: Dd, copy: usize) -> Option<Mode> {
        let omega = Lanes::splat(omega);
        self.normalized(&self.twisted(&omega, copy), &omega, 1).pop()
    }

    /// The modes of at most [`LANES`] brackets, side by side.
    ///
    /// With no other frequency near: Rayleigh quotient iteration, whose error is cubed each time. With others near, or when that
    /// iteration leaves the bracket: bisection in double-double, which always converges.
    #[inline(always)]
    fn group(&self, brackets: &[[f64; 2]], first: usize) -> Vec<Mode> {
        let count = (brackets.len() - first).min(LANES);
        let index = |lane: usize| first + lane.min(count - 1);
        let bisected = |lane: usize| {
            let [lo, hi] = brackets[index(lane)];
            self.bisect_in_dd(index(lane), Dd::from(lo * (1.0 - 1e-14)), Dd::from(hi * (1.0 + 1e-14)))
        };
        let alone = |lane: usize| {
            let (j, [lo, hi]) = (index(lane), brackets[index(lane)]);
            (j == 0 || lo - brackets[j - 1][1] > ALONE * hi)
                && brackets.get(j + 1).is_none_or(|next| next[0] - hi > ALONE * hi)
        };
        let mut open = [0; LANES].map(|_| true);
        let mut omega = Lanes::ZERO;
        for lane in 0..LANES {
            let [lo, hi] = brackets[index(lane)];
            open[lane] = alone(lane);
            omega.set(lane, if open[lane] { Dd::from(0.5 * (lo + hi)) } else { bisected(lane) });
        }
        let mut rounds = 0;
        loop {
            let twisted = self.twisted(&omega, 0);
            let change = twisted.gamma / twisted.norm_squared;
            for lane in 0..LANES {
                let (now, change) = (omega.get(lane), change.get(lane));
                open[lane] &= change.hi.abs() > NO_CHANGE * now.hi;
                if open[lane] {
                    let next = now + change;
                    let [lo, hi] = brackets[index(lane)];
                    let converges =
                        rounds < MOST_ROUNDS && next.hi >= lo * (1.0 - 1e-15) && next.hi <= hi * (1.0 + 1e-15);
                    omega.set(lane, if converges { next } else { bisected(lane) });
                }
            }
            if open == [false; LANES] || rounds > MOST_ROUNDS {
                return self.normalized(&twisted, &omega, count);
            }
            rounds += 1;
        }
    }

    /// Brackets of all frequencies, ascending, by counting sign changes (Sturm), eight at a time.
    fn bisect(&self) -> Vec<[f64; 2]> {
        let count = self.nodes() / 2;
        let not_positive = self.nodes() - count;
        let weight: Vec<f64> = self.weight.iter().map(|w| w.hi).collect();
        let top = self.omega_bound() * (1.0 + 1e-14);
        let mut bottom = top;
        while below(&weight, &[bottom; LANES])[0] > not_positive {
            bottom *= 0.5f64.powi(10);
        }
        let mut brackets = vec![[bottom, top]; count];
        for (block, group) in brackets.chunks_mut(LANES).enumerate() {
            loop {
                let mut shift = [top; LANES];
                let mut open = false;
                for (s, [lo, hi]) in shift.iter_mut().zip(group.iter()) {
                    let wide = *hi > 2.0 * lo;
                    *s = if wide { (lo * hi).sqrt() } else { 0.5 * (lo + hi) };
                    // From this near, one Rayleigh quotient is enough.
                    open |= hi - lo > 1e-12 * lo;
                }
                if !open {
                    break;
                }
                let found = below(&weight, &shift);
                for (k, bracket) in group.iter_mut().enumerate() {
                    let side = usize::from(found[k] > not_positive + block * LANES + k);
                    bracket[side] = shift[k];
                }
            }
        }
        brackets
    }

    #[inline(always)]
    fn bisect_in_dd(&self, index: usize, mut lo: Dd, mut hi: Dd) -> Dd {
        let target = self.nodes() - self.nodes() / 2 + index;
        while (hi - lo).hi > 1e-31 * hi.hi {
            let middle = (lo + hi) * Dd::from(0.5);
            let mut d = -middle;
            let mut negative = usize::from(d.hi < 0.0);
            for &w in &self.weight {
                let pivot = if d.hi == 0.0 { middle * Dd::from(-1e-60) } else { d };
                d = -middle - w / pivot;
                negative += usize::from(d.hi < 0.0);
            }
            *(if negative > target { &mut hi } else { &mut lo }) = middle;
        }
        (lo + hi) * Dd::from(0.5)
    }

    /// In each lane, the vector z that solves `(T - omega) z = gamma e_r` exactly, with z_r = 1, for a node r where |gamma| is least.
    ///
    /// Twisted factorisation (K. V. Fernando, *SIAM J. Matrix Anal. Appl.* 18 (1997) 1013-1034; B. N. Parlett, I. S. Dhillon,
    /// *Linear Algebra Appl.* 267 (1997) 247-279): no component is a difference, so small ones are as accurate as large
    /// ones. Modes of one frequency in separate places of the train are distinguished by `copy`, from 0: r is the node of
    /// the copy-th least local minimum of |gamma|.
    #[inline(always)]
    fn twisted(&self, omega: &Lanes, copy: usize) -> Twisted {
        let n = self.nodes();
        // Eliminating from either end: the pivot, and from it the ratio of a node's component to the next node's.
        let (mut left, mut right) = (-*omega, -*omega);
        let (mut from_left, mut from_right) = (vec![Lanes::ZERO; n], vec![Lanes::ZERO; n]);
        let (mut gamma, mut other) = (vec![left; n], vec![right; n]);
        for l in 1..n {
            let r = n - 1 - l;
            let (g, h) = (Lanes::splat(self.root[l - 1]), Lanes::splat(self.root[r]));
            let (p, q) = (-(g / nonzero(&left, omega)), -(h / nonzero(&right, omega)));
            (from_left[l - 1], from_right[r + 1]) = (p, q);
            (left, right) = (g * p - *omega, h * q - *omega);
            (gamma[l], other[r]) = (left, right);
        }
        gamma.iter_mut().zip(&other).for_each(|(p, q)| *p = *p + *q + *omega);
        let twist: [usize; LANES] = std::array::from_fn(|lane| choose_twist(&gamma, lane, copy));
        let mut least = Lanes::ZERO;
        (0..LANES).for_each(|lane| least.set(lane, gamma[twist[lane]].get(lane)));
        // The rows of gamma become z.
        let mut z = gamma;
        let one = Lanes::splat(Dd::ONE);
        z[n - 1] = one;
        for l in (0..n - 1).rev() {
            z[l] = one.where_or(from_left[l] * z[l + 1], |lane| l >= twist[lane]);
        }
        let mut before = z[0];
        let mut norm_squared = before * before;
        for l in 1..n {
            before = z[l].where_or(from_right[l] * before, |lane| l <= twist[lane]);
            z[l] = before;
            norm_squared = norm_squared + before * before;
        }
        Twisted { gamma: least, node: z, norm_squared }
    }

    /// The modes in the first `count` lanes, scaled to norm sqrt 2.
    #[inline(always)]
    fn normalized(&self, twisted: &Twisted, omega: &Lanes, count: usize) -> Vec<Mode> {
        let rounding = 1e-31 * self.omega_bound();
        let mode = |lane: usize| {
            let scale = (Dd::from(2.0) / twisted.norm_squared.get(lane)).sqrt();
            let node = twisted.node.iter().map(|z| z.get(lane) * scale).collect();
            Mode { omega: omega.get(lane), node, residual: (twisted.gamma.get(lane).abs() * scale).hi + rounding }
        };
        (0..count).map(mode).collect()
    }
}

/// The modes of a group of brackets, compiled for the widest vector unit at hand.
struct Group<'a> {
    path: &'a Path,
    brackets: &'a [[f64; 2]],
    first: usize,
}

impl pulp::WithSimd for Group<'_> {
    type Output = Vec<Mode>;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Vec<Mode> {
        self.path.group(self.brackets, self.first)
    }
}

/// Vectors z of [`Path::twisted`], node by node, one in each lane.
struct Twisted {
    gamma: Lanes,
    node: Vec<Lanes>,
    norm_squared: Lanes,
}

/// The pivot, or a tiny number in place of 0.
#[inline(always)]
fn nonzero(pivot: &Lanes, omega: &Lanes) -> Lanes {
    let mut out = *pivot;
    let [hi, omega] = [pivot.0[0].0, omega.0[0].0];
    for l in 0..LANES {
        out.0[0].0[l] = if hi[l] == 0.0 { -1e-60 * omega[l] } else { hi[l] };
    }
    out
}

/// The node of the `copy`-th least local minimum of |gamma| in a lane.
fn choose_twist(gamma: &[Lanes], lane: usize, copy: usize) -> usize {
    let size = |l: usize| gamma[l].get(lane).hi.abs();
    if copy == 0 {
        return (1..gamma.len()).fold(0, |least, l| if size(l) < size(least) { l } else { least });
    }
    let mut minima: Vec<usize> = (0..gamma.len())
        .filter(|&l| (l == 0 || size(l) <= size(l - 1)) && (l + 1 == gamma.len() || size(l) < size(l + 1)))
        .collect();
    minima.sort_by(|&a, &b| size(a).total_cmp(&size(b)));
    minima.get(copy).or(minima.first()).copied().unwrap_or(0)
}

/// How many eigenvalues of the path lie below each shift.
fn below(weight: &[f64], shift: &[f64; LANES]) -> [usize; LANES] {
    super::vectors::widest().dispatch(Below { weight, shift })
}

struct Below<'a> {
    weight: &'a [f64],
    shift: &'a [f64; LANES],
}

impl pulp::WithSimd for Below<'_> {
    type Output = [usize; LANES];

    /// Counts sign changes (Sturm).
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> [usize; LANES] {
        let shift = *self.shift;
        let mut d = shift.map(|s| -s);
        let mut negative = [1.0f64; LANES];
        for &w in self.weight {
            for k in 0..LANES {
                let pivot = if d[k] == 0.0 { -1e-60 * shift[k] } else { d[k] };
                d[k] = -shift[k] - w / pivot;
                negative[k] += if d[k] < 0.0 { 1.0 } else { 0.0 };
            }
        }
        negative.map(|n| n as usize)
    }
}

#[cfg(test)]
mod tests;
