//! A reference of 30 significant digits and more, proven on construction.
//!
//! ```text
//! F_i(t) = F0_i + P [ R_i(t) - R_i(t - D) ],   R_i(t) = sum_j a_ij (1 - cos omega_j t) for t >= 0, else 0
//! ```
//!
//! Modes are found and summed in binary floating point of 256 bits, more where the scene needs it. How they were
//! found need not be trusted: their residual in the equations of motion is measured in the same arithmetic, and bounds
//! the error of every force (module `modes`). A scene whose bound is not under
//! `Reference::DIGITS` is refused.
//!
//! Extremes are located by a search of its own in `f64` that drops a stretch of time only when a bound says that it
//! cannot hold the largest value (module `scan`); what is left is computed in long arithmetic.

mod check;
mod forces;
pub mod march;
mod modes;
mod real;
mod scan;
#[cfg(test)]
mod tests;

use rayon::prelude::*;

use crate::chain::Scene;
use crate::solve::dd::Dd;
pub use check::ReferenceError;
use check::check;
use modes::Modes;
pub use real::Real;
use real::{Circle, dd, difference, rounded};
use scan::{Found, Piece, Target};

/// Precisions tried in turn; 2,048 bits separate frequencies equal in 500 digits.
const BITS: [usize; 4] = [256, 512, 1024, 2048];
/// Candidates for one largest value computed in long arithmetic.
const MOST_CANDIDATES: usize = 8;

/// The largest value of F, or of -F, in one spring.
#[derive(Clone, Debug)]
pub struct Extreme {
    /// When.
    pub at: f64,
    /// How large.
    pub value: Real,
    /// How much larger it could be at most: 0 unless a force is within `f64` rounding of its largest value at very
    /// many places, or modes of negligible share are too fast to follow.
    pub doubt: f64,
}

impl Extreme {
    /// `|claimed - value|`, subtracted in long arithmetic and rounded once.
    pub fn error_of(&self, claimed: f64) -> f64 {
        difference(claimed, &self.value)
    }

    /// Whether the value is greater than `level`, compared in long arithmetic.
    pub fn is_over(&self, level: f64) -> bool {
        self.value > real::real(level, self.value.precision())
    }
}

/// The exact solution of a scene, to 30 digits and more.
#[derive(Clone, Debug)]
pub struct Reference {
    scene: Scene,
    modes: Modes,
    bits: usize,
    circle: Circle,
    bound: Vec<f64>,
}

impl Reference {
    /// Largest error of a force, relative to the sum of its modes' amplitudes.
    pub(crate) const DIGITS: f64 = 1e-32;

    /// Finds and verifies the modes of a scene.
    ///
    /// # Errors
    /// [`ReferenceError::Scene`] for an invalid scene, [`ReferenceError::Unverified`] if no precision is enough.
    pub fn new(scene: &Scene) -> Result<Reference, ReferenceError> {
        check(scene)?;
        let mut best = f64::INFINITY;
        for bits in BITS {
            let modes = Modes::new(&scene.chain, scene.source, bits);
            let (bound, relative) = error_bounds(scene, &modes, bits);
            if relative <= Self::DIGITS {
                return Ok(Reference { scene: scene.clone(), modes, bits, circle: Circle::new(bits), bound });
            }
            best = best.min(relative);
        }
        Err(ReferenceError::Unverified(best))
    }

    /// Force in a spring at a time (>= 0), rounded once.
    pub fn force(&self, spring: usize, t: f64) -> f64 {
        self.exact_force(spring, t).to_f64().value()
    }

    /// `|claimed - F_spring(t)|`, subtracted in long arithmetic and rounded once.
    pub fn error_of(&self, spring: usize, t: f64, claimed: f64) -> f64 {
        difference(claimed, &self.exact_force(spring, t))
    }

    /// Force and its rate of change, both rounded once.
    pub fn force_and_rate(&self, spring: usize, t: f64) -> [f64; 2] {
        let [force, rate, _] = self.motion(spring, &self.real(t));
        [rounded(&force), rounded(&rate)]
    }

    /// Bound on the error of [`Reference::force`] before rounding, up to the scene's horizon.
    pub fn error_bound(&self, spring: usize) -> f64 {
        self.bound[spring]
    }

    /// The highest frequency.
    pub fn omega_max(&self) -> f64 {
        self.modes.omega.last().map_or(0.0, rounded)
    }

    /// Frequencies, ascending, each rounded once.
    pub fn frequencies(&self) -> Vec<f64> {
        self.modes.omega.iter().map(rounded).collect()
    }

    /// Of every spring the largest F and the largest -F over 0 <= t <= horizon, the initial force included.
    ///
    /// # Errors
    /// [`ReferenceError::TooLong`].
    pub fn extremes(&self) -> Result<Vec<[Extreme; 2]>, ReferenceError> {
        let springs = self.scene.initial.len();
        let targets: Vec<Target> =
            (0..springs).flat_map(|spring| [false, true].map(|negative| Target { spring, negative })).collect();
        let all = self.largest(&targets, self.scene.horizon)?;
        let mut all = all.into_iter();
        Ok((0..springs).filter_map(|_| Some([all.next()?, all.next()?])).collect())
    }

    /// The largest F (or -F) of one spring over 0 <= t <= `until`.
    ///
    /// # Errors
    /// [`ReferenceError::TooLong`].
    pub fn largest_until(&self, spring: usize, negative: bool, until: f64) -> Result<Extreme, ReferenceError> {
        let mut found = self.largest(&[Target { spring, negative }], until)?;
        Ok(found.remove(0))
    }

    fn largest(&self, targets: &[Target], until: f64) -> Result<Vec<Extreme>, ReferenceError> {
        let omega: Vec<Dd> = self.modes.omega.iter().map(dd).collect();
        let start: Vec<f64> = targets.iter().map(|t| t.sign() * self.scene.initial[t.spring]).collect();
        let found =
            scan::find(&self.pieces(&omega, until), &omega, targets, &start).map_err(ReferenceError::TooLong)?;
        Ok(targets.par_iter().zip(found).map(|(target, found)| self.largest_candidate(target, found, until)).collect())
    }

    /// The stretches of constant force, in the form that the search takes.
    fn pieces(&self, omega: &[Dd], until: f64) -> Vec<Piece> {
        let Scene { force, duration, .. } = self.scene;
        let share: Vec<Vec<f64>> = self.modes.share.iter().map(|row| row.iter().map(rounded).collect()).collect();
        let total = |i: usize| self.modes.share[i].iter().fold(self.real(0.0), |s, a| s + a).to_f64().value();
        let mean = (0..share.len()).map(|i| self.scene.initial[i] + force * total(i)).collect();
        let times = |row: &Vec<f64>, by: &dyn Fn(usize) -> f64| (0..row.len()).map(|j| row[j] * by(j)).collect();
        let mut pieces = vec![Piece {
            from: 0.0,
            to: until.min(duration),
            reference: 0.0,
            sine: false,
            mean,
            weight: share.iter().map(|row| times(row, &|_| -force)).collect(),
        }];
        if duration < until {
            let swing = |j: usize| 2.0 * force * omega[j].phase(0.5 * duration).sin();
            pieces.push(Piece {
                from: duration,
                to: until,
                reference: 0.5 * duration,
                sine: true,
                mean: self.scene.initial.clone(),
                weight: share.iter().map(|row| times(row, &swing)).collect(),
            });
        }
        pieces
    }

    /// The largest of the candidates and the initial force, in long arithmetic.
    fn largest_candidate(&self, target: &Target, mut found: Found, until: f64) -> Extreme {
        let initial = self.real(target.sign() * self.scene.initial[target.spring]);
        let mut best = Extreme { at: 0.0, value: initial, doubt: found.unseen };
        if found.candidates.len() > MOST_CANDIDATES {
            found.candidates.sort_by(|a, b| b.value.total_cmp(&a.value));
            found.candidates.truncate(MOST_CANDIDATES);
            best.doubt += 2.0 * found.rounding;
        }
        for candidate in &found.candidates {
            let (at, value) = if candidate.is_concave {
                self.polish(target, candidate.at, until)
            } else {
                (candidate.at, self.exact_force(target.spring, candidate.at) * self.real(target.sign()))
            };
            if value > best.value {
                (best.at, best.value) = (at, value);
            }
        }
        best
    }

    /// Newton's method for the zero of the rate next to `at`, kept between t = 0, the end of the pulse and the horizon.
    fn polish(&self, target: &Target, at: f64, until: f64) -> (f64, Real) {
        let duration = self.scene.duration;
        let (from, to) = if at < duration { (0.0, until.min(duration)) } else { (duration, until) };
        let sign = self.real(target.sign());
        let turn = |[f, r, b]: [Real; 3]| [f * &sign, r * &sign, b * &sign];
        let mut t = self.real(at);
        let [mut value, mut rate, mut bend] = turn(self.motion(target.spring, &t));
        let fastest = self.omega_max();
        for _ in 0..6 {
            if rounded(&bend) >= 0.0 {
                break;
            }
            let step = -(&rate / &bend);
            let next = &t + &step;
            let (near, size) = (rounded(&next), rounded(&step).abs() * fastest);
            if near <= from || near >= to || size > 1.0 {
                break;
            }
            if size < 1e-11 {
                // The next term is the cube of this step: under 1e-33 of the force.
                return (near, value - &rate * &rate / (bend * self.real(2.0)));
            }
            let there = turn(self.motion(target.spring, &next));
            if there[0] < value {
                break;
            }
            t = next;
            [value, rate, bend] = there;
        }
        (rounded(&t), value)
    }

    fn real(&self, x: f64) -> Real {
        real::real(x, self.bits)
    }

    fn exact_force(&self, spring: usize, t: f64) -> Real {
        let [force, ..] = self.motion(spring, &self.real(t));
        force
    }

    /// Force, its rate and the rate's rate.
    fn motion(&self, spring: usize, t: &Real) -> [Real; 3] {
        let zero = self.real(0.0);
        let mut swing = self.response(spring, t);
        if self.scene.duration.is_finite() {
            let since = t - self.real(self.scene.duration);
            if since > zero {
                let end = self.response(spring, &since);
                swing = std::array::from_fn(|q| &swing[q] - &end[q]);
            }
        }
        let force = self.real(self.scene.force);
        let [mut value, rate, bend] = swing.map(|x| x * &force);
        value += self.real(self.scene.initial[spring]);
        [value, rate, bend]
    }

    /// R_i and its first two derivatives.
    fn response(&self, spring: usize, t: &Real) -> [Real; 3] {
        let mut sum = [(); 3].map(|()| self.real(0.0));
        let one = self.real(1.0);
        for (omega, share) in self.modes.omega.iter().zip(&self.modes.share[spring]) {
            let (sine, versine) = self.circle.sine_and_versine(&(omega * t));
            let pull = share * omega;
            sum[0] += share * &versine;
            sum[1] += &pull * sine;
            sum[2] += pull * omega * (&one - versine);
        }
        sum
    }
}

/// Bounds on every spring's error up to the horizon, and the largest of them relative to the spring's amplitudes.
fn error_bounds(scene: &Scene, modes: &Modes, bits: usize) -> (Vec<f64>, f64) {
    let steps = if scene.duration.is_finite() { 2.0 } else { 1.0 };
    let fastest = modes.omega.last().map_or(0.0, rounded);
    // Each phase, cosine, product and sum is rounded; the phase's rounding grows with the phase.
    let rounding = 0.5f64.powi(bits as i32) * (8.0 * fastest * scene.horizon + 4.0 * modes.omega.len() as f64 + 32.0);
    let mut worst = 0.0f64;
    let bound = |i: usize| {
        let size: f64 = modes.share[i].iter().map(|a| rounded(a).abs()).sum();
        let unit = modes.rate * scene.chain.stiffness[i].sqrt() * scene.horizon + rounding * size;
        worst = worst.max(if size > 0.0 { unit / size } else { f64::INFINITY });
        steps * scene.force.abs() * unit + scene.initial[i].abs() * 0.5f64.powi(bits as i32)
    };
    let bounds = (0..scene.initial.len()).map(bound).collect();
    (bounds, steps * if worst.is_nan() { f64::INFINITY } else { worst })
}
