//! Extremes between the instants of a march: what a method that steps through time shows the watch.
//!
//! A march knows every spring's force G (from the event on) and its rate at both ends of a step. The cubic through them is
//! off by at most `h^4 / 384 max |G''''|`, and the energy of the motion's own derivative, which is conserved, bounds that:
//!
//! ```text
//! |y_i''''| = |(A B w')_i| <= ||row i of A B|| ||w'||,     ||w'||^2 + ||y'||^2 = constant
//! ```
//!
//! Where that bound leaves a doubt, the equations of motion give as many derivatives as are wanted from the neighbours'
//! forces at the same instant. Three at each end make a polynomial of degree 7, which settles most doubts; seven make one
//! of degree 15, which is exact to 2e-14.

use std::sync::OnceLock;

use super::dd::Dd;
use super::local::{COEFFICIENTS, Local, hermite_top};
use super::statics;
use super::watch::Watch;
use crate::chain::Scene;

/// Derivatives used at each end of a step, the value included: for a first look, and to the end.
const FEW: usize = 4;
const ALL: usize = 8;
/// Springs around the one in question that they need, itself included.
const WINDOW: usize = ALL - 1;
/// The error of the polynomial of degree 7 over that of the cubic, for steps of phase 2 at most:
/// `384 (h omega)^4 / (8! 2^8)`.
const FEW_OVER_CUBIC: f64 = 384.0 * 16.0 / (40_320.0 * 256.0);

/// The equations of motion of a scene's springs: `G_i'' = -a_i (G_i - G_{i-1}) - b_i (G_i - G_{i+1}) + drive_i`.
#[derive(Clone, Debug)]
pub struct Motion {
    /// `k_i / m_i`; 0 for a held mass.
    pub ahead: Vec<f64>,
    /// `k_i / m_{i+1}`; 0 for a held mass.
    pub behind: Vec<f64>,
    /// `k_i (p_i / m_i - p_{i+1} / m_{i+1})` for a unit outside force p on the source.
    pub drive: Vec<f64>,
    /// `||row i of A B|| sqrt(k_i)`: bound on `G_i''''` per unit of `||w'||`.
    pub fourth: Vec<f64>,
    /// `1 / sqrt(m_source)`: `||w'||` of the motion that a unit step of force starts.
    pub jolt: f64,
}

impl Motion {
    /// The motion of a scene.
    pub fn new(scene: &Scene) -> Motion {
        let chain = &scene.chain;
        let springs = chain.stiffness.len();
        let inverse = |v: usize| if chain.live(v) { 1.0 / chain.mass[v] } else { 0.0 };
        let ahead: Vec<f64> = (0..springs).map(|i| chain.stiffness[i] * inverse(i)).collect();
        let behind: Vec<f64> = (0..springs).map(|i| chain.stiffness[i] * inverse(i + 1)).collect();
        let mut drive = vec![0.0; springs];
        if scene.source < springs {
            drive[scene.source] = ahead[scene.source];
        }
        if scene.source > 0 {
            drive[scene.source - 1] = -behind[scene.source - 1];
        }
        let fourth = (0..springs).map(|i| fourth_row(&ahead, &behind, &chain.stiffness, i)).collect();
        Motion { ahead, behind, drive, fourth, jolt: inverse(scene.source).sqrt() }
    }
}

/// `sqrt(k_i)` times the norm of row i of A B: A has three entries in a row, B two, so the product has four.
fn fourth_row(ahead: &[f64], behind: &[f64], stiffness: &[f64], i: usize) -> f64 {
    // In force and velocity: G' = k (v_i - v_{i+1}), and w_v = sqrt(m_v) v_v; entry l of the row belongs to mass i - 1 + l.
    let mut row = [0.0; 4];
    let last = stiffness.len() - 1;
    let weight = |s: usize| [(stiffness[s] * ahead[s]).sqrt(), (stiffness[s] * behind[s]).sqrt()];
    let mut add = |s: usize, factor: f64, at: usize| {
        let [near, far] = weight(s);
        row[at] += factor * near;
        row[at + 1] -= factor * far;
    };
    add(i, ahead[i] + behind[i], 1);
    if i > 0 {
        add(i - 1, -ahead[i], 0);
    }
    if i < last {
        add(i + 1, -behind[i], 2);
    }
    row.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// One step of a march, as a spring sees it.
pub struct Step<'a> {
    /// Its beginning.
    pub from: f64,
    /// Its length.
    pub width: f64,
    /// The horizon: what lies behind it does not count.
    pub until: f64,
    /// Outside force on the source during the step.
    pub force: f64,
    /// The equations of motion.
    pub motion: &'a Motion,
    /// Forces before the event.
    pub initial: &'a [f64],
}

impl Step<'_> {
    /// Shows the watch one spring over the step, if it can matter.
    ///
    /// `at(end, s)` is G and G' of spring s at the beginning (0) or end (1) of the step; `slack` is how far G can pass
    /// the cubic; `last` that no step follows. Returns whether a closer look was needed.
    #[inline]
    pub fn show(
        &self,
        watch: &mut Watch,
        spring: usize,
        slack: f64,
        last: bool,
        at: impl Fn(usize, usize) -> [f64; 2],
    ) -> bool {
        let (left, right) = (at(0, spring), at(1, spring));
        let (mut first, mut local) = (None, None);
        for negative in [false, true] {
            let sign = if negative { -1.0 } else { 1.0 };
            let level = watch.level(spring, negative) - sign * self.initial[spring];
            let ends = [left, right].map(|e| e.map(|x| sign * x));
            if hermite_top(self.width, ends[0], ends[1]).value + slack <= level {
                continue;
            }
            let beyond = ends[1][0] + sign * self.initial[spring];
            let may_cross = watch.peaks[spring].side(negative).first_over.is_none()
                && beyond > watch.cautious_rating(spring, negative);
            if !last && !may_cross && self.only_rises(ends, slack) {
                continue;
            }
            let looked = first.get_or_insert_with(|| self.local::<FEW>(spring, &at));
            if !looked.may_pass(sign, level - FEW_OVER_CUBIC * slack) {
                continue;
            }
            let local = local.get_or_insert_with(|| {
                let mut local = self.local::<ALL>(spring, &at);
                local.coefficient[0] += self.initial[spring];
                local
            });
            let end = ((self.until - local.center) / local.radius).min(1.0);
            let exact = |t: f64| local.value_and_slope((t - local.center) / local.radius).0;
            watch.note(spring, negative, local, end, exact);
        }
        first.is_some()
    }

    /// Whether the force certainly rises through the whole step: then the next step holds whatever this one does.
    ///
    /// A cubic's slope is off by at most `sqrt 3 h^3 / 216 max |G''''|`, which is 3.08 slack / h.
    fn only_rises(&self, [left, right]: [[f64; 2]; 2], slack: f64) -> bool {
        let mean = (right[0] - left[0]) / self.width;
        // The slope's parabola through both ends with that mean: its least value.
        let (d0, d1) = (left[1], right[1]);
        let bend = 3.0 * (d0 + d1 - 2.0 * mean);
        let tilt = -(2.0 * d0 + d1 - 3.0 * mean) * 2.0;
        let s = if bend > 0.0 { (-tilt / (2.0 * bend)).clamp(0.0, 1.0) } else { 0.0 };
        let least = d0.min(d1).min(d0 + s * (tilt + s * bend));
        least > 3.08 * slack / self.width
    }

    /// The polynomial of degree 2 D - 1 through D derivatives at each end, of G.
    fn local<const D: usize>(&self, spring: usize, at: &impl Fn(usize, usize) -> [f64; 2]) -> Local {
        let radius = 0.5 * self.width;
        let left = self.derivatives::<D>(spring, radius, |s| at(0, s));
        let right = self.derivatives::<D>(spring, radius, |s| at(1, s));
        let mut coefficient = [0.0; COEFFICIENTS];
        let [even, odd] = if D == FEW { &two_point().few } else { &two_point().all };
        for q in 0..D {
            let mirrored = if q % 2 == 0 { left[q] } else { -left[q] };
            let (sum, difference) = (0.5 * (right[q] + mirrored), 0.5 * (right[q] - mirrored));
            for m in 0..D {
                coefficient[2 * m] += even[q][m] * sum;
                coefficient[2 * m + 1] += odd[q][m] * difference;
            }
        }
        Local { coefficient, terms: 2 * D, center: self.from + radius, radius }
    }

    /// `G^(q) radius^q / q!`, q < D, at one end of the step, from the forces and rates around the spring.
    fn derivatives<const D: usize>(&self, spring: usize, radius: f64, at: impl Fn(usize) -> [f64; 2]) -> [f64; D] {
        let springs = self.initial.len();
        let reach = (D - 1) / 2;
        let from = spring as isize - reach as isize;
        let inside = |l: usize| usize::try_from(from + l as isize).ok().filter(|&s| s < springs);
        let mut window = [[0.0; 2]; WINDOW];
        for (l, w) in window.iter_mut().enumerate().take(2 * reach + 1) {
            if let Some(s) = inside(l) {
                *w = at(s);
            }
        }
        let mut out = [0.0; D];
        let mut scale = 1.0;
        for q in 0..D {
            out[q] = window[reach][q % 2] * scale;
            scale *= radius / (q + 1) as f64;
            if q % 2 == 0 || q + 1 == D {
                continue;
            }
            let old = window;
            let pair = q / 2;
            for l in pair + 1..2 * reach - pair {
                let Some(s) = inside(l) else { continue };
                let (a, b) = (self.motion.ahead[s], self.motion.behind[s]);
                let turn = |x: usize| -a * (old[l][x] - old[l - 1][x]) - b * (old[l][x] - old[l + 1][x]);
                let drive = if pair == 0 { self.force * self.motion.drive[s] } else { 0.0 };
                window[l] = [turn(0) + drive, turn(1)];
            }
        }
        out
    }
}

/// Matrices, by columns, that turn derivatives at x = 1 of an even (odd) polynomial into its coefficients.
struct TwoPoint {
    few: [[[f64; ALL]; ALL]; 2],
    all: [[[f64; ALL]; ALL]; 2],
}

fn two_point() -> &'static TwoPoint {
    static TABLE: OnceLock<TwoPoint> = OnceLock::new();
    TABLE.get_or_init(|| TwoPoint { few: [inverse(FEW, 0), inverse(FEW, 1)], all: [inverse(ALL, 0), inverse(ALL, 1)] })
}

/// Inverse of the matrix of binomials C(2 m + odd, q), m and q < count, transposed; by elimination in double-double.
fn inverse(count: usize, odd: usize) -> [[f64; ALL]; ALL] {
    let binomial = |n: usize, q: usize| (0..q).fold(1.0, |c, i| c * (n as f64 - i as f64) / (i + 1) as f64);
    let mut a = [[Dd::ZERO; 2 * ALL]; ALL];
    for (q, row) in a.iter_mut().enumerate() {
        for (m, entry) in row.iter_mut().enumerate().take(count) {
            *entry = Dd::from(binomial(2 * m + odd, q).round());
        }
        row[ALL + q] = Dd::ONE;
    }
    for column in 0..count {
        let pivot = (column..count).max_by(|&i, &j| a[i][column].abs().hi.total_cmp(&a[j][column].abs().hi));
        a.swap(column, pivot.unwrap_or(column));
        let head = a[column];
        for (r, row) in a.iter_mut().enumerate().take(count) {
            if r == column {
                row.iter_mut().for_each(|x| *x = *x / head[column]);
            } else {
                let factor = row[column] / head[column];
                row.iter_mut().zip(&head).for_each(|(x, &h)| *x = *x - factor * h);
            }
        }
    }
    std::array::from_fn(|q| std::array::from_fn(|m| a[m][ALL + q].hi))
}

/// Largest difference from the static share that the energy allows, per unit force: `sqrt(k_i) ||y_static||`, twice.
pub fn energy_radius(scene: &Scene) -> f64 {
    let share = statics::unit_force(&scene.chain, scene.source);
    share.iter().zip(&scene.chain.stiffness).map(|(s, k)| s * s / k).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Exact for any polynomial of degree 15: here x^15 and x^8.
    #[test]
    fn two_point_polynomial_is_exact_to_degree_15() {
        let [even, odd] = &two_point().all;
        let binomial = |n: usize, q: usize| (0..q).fold(1.0, |c, i| c * (n - i) as f64 / (i + 1) as f64);
        let apply = |columns: &[[f64; ALL]; ALL], n: usize, m: usize| -> f64 {
            (0..ALL.min(n + 1)).map(|q| columns[q][m] * binomial(n, q)).sum()
        };
        for m in 0..ALL {
            // Entries of the inverse times the binomials reach 1e6 or so: 1e-9 is their rounding.
            assert!((apply(odd, 15, m) - f64::from(u8::from(m == 7))).abs() < 1e-9);
            assert!((apply(even, 8, m) - f64::from(u8::from(m == 4))).abs() < 1e-9);
        }
    }
}
