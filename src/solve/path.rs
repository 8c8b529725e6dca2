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

use super::dd::Dd;
use crate::chain::Chain;

/// Shifts counted side by side, one in each lane of the widest vector unit.
const LANES: usize = 8;

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
            let found = pulp::Arch::new().dispatch(|| below(&weight, &shift));
            let all = found.iter().take_while(|&&n| n < self.nodes()).count();
            (lo, hi) = (lo + all as f64 * step, if all < LANES { shift[all] } else { hi });
        }
        hi
    }

    /// All frequencies, ascending, each to about 30 digits of its own size.
    pub fn frequencies(&self) -> Vec<Dd> {
        let brackets = pulp::Arch::new().dispatch(|| self.bisect());
        (0..brackets.len())
            .map(|j| {
                let [lo, hi] = brackets[j];
                let width = 1e-5 * hi;
                let alone = (j == 0 || lo - brackets[j - 1][1] > width)
                    && (j + 1 == brackets.len() || brackets[j + 1][0] - hi > width);
                pulp::Arch::new().dispatch(|| self.refine(j, lo, hi, alone))
            })
            .collect()
    }

    /// The mode of a frequency from [`Path::frequencies`]; `copy` counts modes of the same frequency before it.
    pub fn mode(&self, omega: Dd, copy: usize) -> Mode {
        pulp::Arch::new().dispatch(|| {
            let (gamma, node) = self.twisted(omega, copy);
            let norm = norm_squared(&node).sqrt();
            let scale = Dd::from(2.0).sqrt() / norm;
            let node = node.into_iter().map(|z| z * scale).collect();
            Mode { omega, node, residual: (gamma.abs() * scale).hi + 1e-31 * omega.hi }
        })
    }

    /// Brackets of all frequencies, ascending, by counting sign changes (Sturm), eight at a time.
    #[inline(always)]
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

    /// A bracketed frequency to double-double accuracy.
    ///
    /// With no other frequency near: Rayleigh quotient iteration, whose error is cubed each time. With others near, or when that
    /// iteration leaves the bracket: bisection in double-double, which always converges.
    #[inline(always)]
    fn refine(&self, index: usize, lo: f64, hi: f64, alone: bool) -> Dd {
        if alone {
            let mut omega = Dd::from(0.5 * (lo + hi));
            for _ in 0..4 {
                let (gamma, node) = self.twisted(omega, 0);
                let change = gamma / norm_squared(&node);
                omega = omega + change;
                if !(omega.hi >= lo * (1.0 - 1e-15) && omega.hi <= hi * (1.0 + 1e-15)) {
                    break;
                }
                if change.hi.abs() < 1e-11 * omega.hi {
                    return omega;
                }
            }
        }
        self.bisect_in_dd(index, Dd::from(lo * (1.0 - 1e-14)), Dd::from(hi * (1.0 + 1e-14)))
    }

    #[inline(always)]
    fn bisect_in_dd(&self, index: usize, mut lo: Dd, mut hi: Dd) -> Dd {
        let target = self.nodes() - self.nodes() / 2 + index;
        while (hi - lo).hi > 1e-31 * hi.hi {
            let middle = (lo + hi) * Dd::from(0.5);
            let mut d = -middle;
            let mut negative = usize::from(d.hi < 0.0);
            for &w in &self.weight {
                d = -middle - w / nonzero(d, middle);
                negative += usize::from(d.hi < 0.0);
            }
            *(if negative > target { &mut hi } else { &mut lo }) = middle;
        }
        (lo + hi) * Dd::from(0.5)
    }

    /// The vector z that solves `(T - omega) z = gamma e_r` exactly, with z_r = 1, for a node r where |gamma| is least.
    ///
    /// Twisted factorisation (K. V. Fernando, *SIAM J. Matrix Anal. Appl.* 18 (1997) 1013-1034; B. N. Parlett, I. S. Dhillon,
    /// *Linear Algebra Appl.* 267 (1997) 247-279): no component is a difference, so small ones are as accurate as large
    /// ones. Modes of one frequency in separate places of the train are distinguished: for the copy-th of them, r is
    /// the copy-th least local minimum of |gamma|.
    #[inline(always)]
    fn twisted(&self, omega: Dd, copy: usize) -> (Dd, Vec<Dd>) {
        let n = self.nodes();
        let (mut left, mut right) = (vec![-omega; n], vec![-omega; n]);
        for l in 1..n {
            left[l] = -omega - self.weight[l - 1] / nonzero(left[l - 1], omega);
            let r = n - 1 - l;
            right[r] = -omega - self.weight[r] / nonzero(right[r + 1], omega);
        }
        let gamma: Vec<Dd> = left.iter().zip(&right).map(|(&p, &q)| p + q + omega).collect();
        let twist = choose_twist(&gamma, copy);
        let mut z = vec![Dd::ONE; n];
        for l in (0..twist).rev() {
            z[l] = -(self.root[l] * z[l + 1]) / nonzero(left[l], omega);
        }
        for l in twist + 1..n {
            z[l] = -(self.root[l - 1] * z[l - 1]) / nonzero(right[l], omega);
        }
        (gamma[twist], z)
    }
}

/// The pivot, or a tiny number in place of 0.
#[inline(always)]
fn nonzero(pivot: Dd, omega: Dd) -> Dd {
    if pivot.hi == 0.0 { omega * Dd::from(-1e-60) } else { pivot }
}

#[inline(always)]
fn norm_squared(z: &[Dd]) -> Dd {
    z.iter().fold(Dd::ZERO, |sum, &x| sum + x * x)
}

/// The node of the `copy`-th least local minimum of |gamma|.
fn choose_twist(gamma: &[Dd], copy: usize) -> usize {
    let size = |l: usize| gamma[l].abs();
    let mut minima: Vec<usize> = (0..gamma.len())
        .filter(|&l| (l == 0 || size(l) <= size(l - 1)) && (l + 1 == gamma.len() || size(l) < size(l + 1)))
        .collect();
    minima.sort_by(|&a, &b| size(a).partial_cmp(&size(b)).unwrap_or(std::cmp::Ordering::Equal));
    minima.get(copy).or(minima.first()).copied().unwrap_or(0)
}

/// How many eigenvalues of the path lie below each shift.
#[inline(always)]
fn below(weight: &[f64], shift: &[f64; LANES]) -> [usize; LANES] {
    let mut d = shift.map(|s| -s);
    let mut negative = [1.0f64; LANES];
    for &w in weight {
        for k in 0..LANES {
            let pivot = if d[k] == 0.0 { -1e-60 * shift[k] } else { d[k] };
            d[k] = -shift[k] - w / pivot;
            negative[k] += f64::from(u8::from(d[k] < 0.0));
        }
    }
    negative.map(|n| n as usize)
}
