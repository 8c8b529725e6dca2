//! Spring forces as sums over modes.
//!
//! ```text
//! step, t < D         F_i(t) = F0_i + P [ s_i - sum_j a_ij cos(omega_j t) ]
//! pulse over, t >= D  F_i(t) = F0_i + P sum_j a_ij 2 sin(omega_j D / 2) sin(omega_j (t - D / 2))
//! ```
//!
//! [P] eqs (19) and (29), with a_ij the static share of mode j and s_i their sum. The second line is (29)'s difference of
//! cosines as a product: a pulse far shorter than a period loses no digits.
//!
//! Their extremes are found in [`super::search`].

use nalgebra::{DMatrix, DVector};

use super::dd::{Dd, LANES};
use super::local::{COEFFICIENTS, Local};
use super::statics;
use crate::chain::Scene;

/// Unit roundoff of `f64`.
pub(super) const ROUNDOFF: f64 = f64::EPSILON / 2.0;
/// A mode is resolved by a Taylor polynomial over a half width r while omega r is under this.
pub(super) const RESOLVED: f64 = 2.0;

/// Frequencies, ascending, and how each mode shares a unit force among the springs.
#[derive(Clone, Debug)]
pub struct Modes {
    /// Frequencies, > 0.
    pub omega: Vec<Dd>,
    /// `a_ij`: springs x modes.
    pub share: DMatrix<f64>,
    /// Per unit of force and time, a bound on each spring's force error from the residuals of the modes in the
    /// equations of motion.
    pub defect: Vec<f64>,
}

/// A stretch of time under constant outside force: each mode is a cosine, or a sine, of `omega_j (t - reference)`.
#[derive(Clone)]
pub(super) struct Stretch {
    pub(super) from: f64,
    pub(super) to: f64,
    reference: f64,
    /// Sines (after a pulse), not cosines.
    sine: bool,
    /// Amplitude of each mode.
    pub(super) amplitude: Vec<f64>,
    /// Force about which each spring swings.
    pub(super) mean: Vec<f64>,
}

impl Stretch {
    /// A part of it.
    pub(super) fn part(&self, from: f64, to: f64) -> Stretch {
        Stretch { from, to, ..self.clone() }
    }
}

/// A mode at an instant, per unit of its share `a_ij`: the change of the force since the event, and the oscillation's q and q' / omega.
pub(super) type Coordinates = [f64; 3];

/// Removes modes that together change no force by more than `allowed`, a force; returns a bound on their joint change of any force.
pub(crate) fn leave_out(scene: &Scene, modes: &mut Modes, allowed: f64) -> f64 {
    let size = |j: usize| swing(scene, modes.omega[j]) * modes.share.column(j).amax();
    let mut by_size: Vec<(f64, usize)> = (0..modes.omega.len()).map(|j| (size(j), j)).collect();
    by_size.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut joint = 0.0;
    let within = |(size, _): &&(f64, usize)| {
        joint += size;
        joint <= allowed
    };
    let mut out: Vec<usize> = by_size.iter().take_while(within).map(|m| m.1).collect();
    out.sort_unstable();
    modes.share = std::mem::replace(&mut modes.share, DMatrix::zeros(0, 0)).remove_columns_at(&out);
    let mut j = 0;
    modes.omega.retain(|_| {
        j += 1;
        out.binary_search(&(j - 1)).is_err()
    });
    by_size[..out.len()].iter().map(|m| m.0).sum()
}

/// Bound on the change of force by a mode of unit share, `|P| min(omega D, 2)`: it is `|P| (1 - cos)` while the outside force acts and
/// at most `2 |P| |sin(omega D / 2)|` after it.
fn swing(scene: &Scene, omega: Dd) -> f64 {
    scene.force.abs() * (omega.hi * scene.duration).min(2.0)
}

/// Bound on |F_i| over all time, rounded up.
///
/// The sizes are sums in `f64`: of shares (5 roundings each), their swings (3), masses or compliances (m + 2) and of m + 2 terms. That
/// is less than `(16 + 2 m) eps / 2` of all of them together. The error of numerical modes is counted up to the horizon
/// only, not over all time.
pub fn all_time_bounds(scene: &Scene, modes: &Modes) -> Vec<f64> {
    let mean = statics::unit_force(&scene.chain, scene.source);
    let bound = |i: usize| {
        let added = |j: usize| modes.share[(i, j)].abs() * swing(scene, modes.omega[j]);
        let before = scene.initial[i].abs();
        let pulse = before + (0..modes.omega.len()).map(added).sum::<f64>();
        let step = (scene.initial[i] + scene.force * mean[i]).abs()
            + scene.force.abs() * modes.share.row(i).iter().map(|a| a.abs()).sum::<f64>();
        let (bound, sizes) = if scene.duration.is_finite() {
            (pulse, pulse)
        } else {
            (step.max(before), step + 2.0 * (before + scene.force.abs() * mean[i].abs()))
        };
        bound + (8.0 + modes.omega.len() as f64) * f64::EPSILON * sizes + missed(scene, modes, i)
    };
    (0..scene.initial.len()).map(bound).collect()
}

/// Forces of one spring at given times (>= 0).
pub fn history(scene: &Scene, modes: &Modes, spring: usize, times: &[f64]) -> Vec<f64> {
    let field = Field::new(scene, modes);
    let stretches = field.stretches();
    let at = |&t: &f64| {
        let stretch = stretches.iter().rev().find(|s| t >= s.from).unwrap_or(&stretches[0]);
        field.value(stretch, spring, Dd::from(t))
    };
    times.iter().map(at).collect()
}

/// Forces of every spring at given times, ascending: calls `see(index of the time, spring, force)` for each.
pub fn field(scene: &Scene, modes: &Modes, times: &[f64], see: &mut dyn FnMut(usize, usize, f64)) {
    let field = Field::new(scene, modes);
    let stretches = field.stretches();
    for (n, &t) in times.iter().enumerate() {
        let stretch = stretches.iter().rev().find(|s| t >= s.from).unwrap_or(&stretches[0]);
        let added = field.coordinates(stretch, Dd::from(t)).into_iter().map(|c| c[0]);
        let change = &modes.share * DVector::from_iterator(modes.omega.len(), added);
        scene.initial.iter().zip(&change).enumerate().for_each(|(s, (steady, c))| see(n, s, steady + c));
    }
}

/// Bound on the error of every force that [`super::search::peaks`] reports, up to the scene's horizon.
pub fn error_bound(scene: &Scene, modes: &Modes) -> f64 {
    let m = modes.omega.len() as f64;
    let spring = |i: usize| {
        let size: f64 =
            modes.omega.iter().zip(modes.share.row(i).iter()).map(|(&w, a)| a.abs() * swing(scene, w)).sum();
        // Rounding of a_ij (5), the amplitude (2), the reduced phase (2), its sine (1), the product (1), and the sum by halves.
        let swing = size * (11.0 + m.min(PAIRWISE as f64) + (m / PAIRWISE as f64).max(1.0).log2() + 1.0);
        (swing + 2.0 * scene.initial[i].abs()) * ROUNDOFF + missed(scene, modes, i)
    };
    (0..scene.initial.len()).map(spring).fold(0.0, larger_bound)
}

/// The larger of two bounds; NaN is no bound.
pub(super) fn larger_bound(a: f64, b: f64) -> f64 {
    if b.is_nan() { f64::INFINITY } else { a.max(b) }
}

/// Error from the part of the force that the modes miss, while it acts, and from their residuals at all times.
pub(super) fn missed(scene: &Scene, modes: &Modes, spring: usize) -> f64 {
    let fastest = modes.omega.last().map_or(0.0, |&w| swing(scene, w));
    let acting = scene.force.abs() * scene.duration.min(scene.horizon);
    modes.defect[spring] * (acting + fastest * scene.horizon)
}

/// The forces as functions of time.
pub(super) struct Field<'a> {
    pub(super) scene: &'a Scene,
    pub(super) modes: &'a Modes,
    pub(super) omega: Vec<f64>,
    pub(super) mean: Vec<f64>,
}

impl<'a> Field<'a> {
    pub(super) fn new(scene: &'a Scene, modes: &'a Modes) -> Field<'a> {
        // From the modes that are summed: some of the chain's may be left out.
        let row = |i: usize| pairwise(&|j| modes.share[(i, j)], 0, modes.omega.len());
        let mean = (0..scene.initial.len()).map(row).collect();
        let omega = modes.omega.iter().map(|w| w.hi).collect();
        Field { scene, modes, omega, mean }
    }

    /// The one or two stretches of constant force within the horizon.
    pub(super) fn stretches(&self) -> Vec<Stretch> {
        let Scene { force, duration, horizon, .. } = *self.scene;
        let modes = self.omega.len();
        let mean = self.mean.iter().zip(&self.scene.initial).map(|(s, f)| f + force * s).collect();
        let amplitude = vec![-force; modes];
        let step = Stretch { from: 0.0, to: horizon.min(duration), reference: 0.0, sine: false, amplitude, mean };
        if duration >= horizon {
            return vec![step];
        }
        let half = |w: &Dd| 2.0 * force * w.phase(0.5 * duration).sin();
        let after = Stretch {
            from: duration,
            to: horizon,
            reference: 0.5 * duration,
            sine: true,
            amplitude: self.modes.omega.iter().map(half).collect(),
            mean: self.scene.initial.clone(),
        };
        vec![step, after]
    }

    /// Every mode at an instant.
    ///
    /// While the force acts, `1 - cos` is computed as `2 sin^2` of half the phase: short pulses lose no digits.
    pub(super) fn coordinates(&self, stretch: &Stretch, t: Dd) -> Vec<Coordinates> {
        let tau = t - Dd::from(stretch.reference);
        let phases = super::vectors::widest().dispatch(Phases { omega: &self.modes.omega, time: tau });
        let at = |(phase, &a): (f64, &f64)| {
            let (sin, cos) = phase.sin_cos();
            if stretch.sine {
                [a * sin, a * sin, a * cos]
            } else {
                [-2.0 * a * (0.5 * phase).sin().powi(2), a * cos, -a * sin]
            }
        };
        phases.into_iter().zip(&stretch.amplitude).map(at).collect()
    }

    /// One spring's force at an instant, all modes, to rounding.
    pub(super) fn value(&self, stretch: &Stretch, spring: usize, t: Dd) -> f64 {
        let coordinates = self.coordinates(stretch, t);
        let row = self.modes.share.row(spring);
        self.scene.initial[spring] + pairwise(&|j| row[j] * coordinates[j][0], 0, coordinates.len())
    }

    /// Taylor polynomial of a spring's force about a cell's centre, and the joint amplitude of the unresolved modes.
    pub(super) fn local(
        &self,
        stretch: &Stretch,
        spring: usize,
        coordinates: &[Coordinates],
        resolved: usize,
        center: f64,
        radius: f64,
    ) -> (Local, f64) {
        let share = self.modes.share.row(spring);
        let mut modes = vec![[[0.0; LANES]; 5]; resolved.div_ceil(LANES)];
        for (j, &[added, c, s]) in coordinates.iter().enumerate().take(resolved) {
            let of = [self.omega[j] * radius, share[j], added, c, s];
            (0..5).for_each(|n| modes[j / LANES][n][j % LANES] = of[n]);
        }
        let terms = terms(resolved.checked_sub(1).map_or(0.0, |last| self.omega[last] * radius));
        let mut coefficient = super::vectors::widest().dispatch(Series { modes: &modes, terms });
        // Unresolved modes count with their average.
        let fast = resolved..self.omega.len();
        let average = |j: usize| if stretch.sine { 0.0 } else { -stretch.amplitude[j] * share[j] };
        coefficient[0] += self.scene.initial[spring] + fast.clone().map(average).sum::<f64>();
        let margin = fast.map(|j| (share[j] * stretch.amplitude[j]).abs()).sum();
        (Local { coefficient, terms, center, radius }, margin)
    }
}

/// Number of Taylor terms of a mode whose phase over the radius is `phase`: the first term left out is no larger than that of the full
/// series at the largest resolved phase, [`RESOLVED`].
fn terms(phase: f64) -> usize {
    let last = COEFFICIENTS - 1;
    let least = RESOLVED.powi(COEFFICIENTS as i32) * INVERSE_FACTORIAL[last] / COEFFICIENTS as f64;
    let (mut terms, mut term) = (1, phase);
    // `Series` adds terms in pairs: the number is even, or all.
    while terms < COEFFICIENTS && (term > least || terms % 2 == 1) {
        terms += 1;
        term *= phase / terms as f64;
    }
    terms
}

/// Phases of modes at an instant, compiled for the widest vector unit at hand, as is [`Series`].
struct Phases<'a> {
    omega: &'a [Dd],
    time: Dd,
}

impl pulp::WithSimd for Phases<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Vec<f64> {
        let mut out = vec![0.0; self.omega.len()];
        out.iter_mut().zip(self.omega).for_each(|(phase, w)| *phase = w.phase_of(self.time));
        out
    }
}

/// Taylor coefficients of the sum of modes: each with its phase over the radius, its share, what it has added, and q and q' / omega.
struct Series<'a> {
    modes: &'a [[[f64; LANES]; 5]],
    terms: usize,
}

impl pulp::WithSimd for Series<'_> {
    type Output = [f64; COEFFICIENTS];

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> [f64; COEFFICIENTS] {
        let mut sums = [[0.0; LANES]; COEFFICIENTS + 1];
        let mut constant = [0.0; LANES];
        for [x, share, added, c, s] in self.modes {
            // Derivatives of q in units of omega: q, q', -q, -q', ...
            let (mut even, mut odd, mut turn) = (*share, *share, *x);
            for l in 0..LANES {
                constant[l] += share[l] * added[l];
                odd[l] *= x[l];
                turn[l] *= -x[l];
            }
            for pair in sums[..(self.terms + 1).min(COEFFICIENTS + 1)].chunks_exact_mut(2) {
                let (mut first, mut second) = (pair[0], pair[1]);
                for l in 0..LANES {
                    first[l] = even[l].mul_add(c[l], first[l]);
                    second[l] = odd[l].mul_add(s[l], second[l]);
                    even[l] *= turn[l];
                    odd[l] *= turn[l];
                }
                (pair[0], pair[1]) = (first, second);
            }
        }
        sums[0] = constant;
        let mut out = [0.0; COEFFICIENTS];
        for q in 0..COEFFICIENTS {
            out[q] = INVERSE_FACTORIAL[q] * sums[q].iter().sum::<f64>();
        }
        out
    }
}

/// 1 / q!
const INVERSE_FACTORIAL: [f64; COEFFICIENTS] = {
    let mut table = [1.0; COEFFICIENTS];
    let mut factorial = 1.0;
    let mut q = 1;
    while q < COEFFICIENTS {
        factorial *= q as f64;
        table[q] = 1.0 / factorial;
        q += 1;
    }
    table
};

/// Terms summed in a row.
const PAIRWISE: usize = 8;

/// Sum of `term(j)` over [from, to) by halves: its rounding grows as the logarithm of the number of terms.
fn pairwise(term: &dyn Fn(usize) -> f64, from: usize, to: usize) -> f64 {
    if to - from <= PAIRWISE {
        return (from..to).map(term).sum();
    }
    let middle = from + (to - from) / 2;
    pairwise(term, from, middle) + pairwise(term, middle, to)
}
