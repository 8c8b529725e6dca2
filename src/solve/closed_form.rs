//! The modes of equal chains by the paper's closed forms: equal masses, equal stiffnesses, any ends, force on any mass.
//!
//! With the head held, N live masses and the force on the last one, [P] eqs (10), (13), (27) and (29):
//!
//! ```text
//! omega_j = 2 sin(beta_j / 2)      beta_j = pi (2j - 1) / (2N + 1)
//! a_ij    = (4 / (2N + 1)) cos((i - 1/2) beta_j) sin(N beta_j) / omega_j
//! ```
//!
//! which is (29)'s a_j r_ij / omega_j with a_j from (27). (27) labels its right-hand side b_j = a_j omega_j; it is a_j. For a
//! force on mass v put v for N in the sine, and change no sign: `share` below has the sign of a forward force.
//! The other ends have the same shape with other angles:
//!
//! ```text
//! both free, n masses           beta_j = pi j / n         masses cos((v - 1/2) beta), springs sin(i beta)
//! both held, N live masses      beta_j = pi j / (N + 1)   masses sin(v beta),         springs cos((i - 1/2) beta)
//! ```
//!
//! Every angle is a whole multiple of one small angle, so all cosines come from one table.

use nalgebra::DMatrix;

use super::dd::{Dd, sin_pi};
use super::sums::Modes;
use crate::chain::{Chain, Scene};

/// The common mass and stiffness of a chain whose live masses and stiffnesses are equal to the last bit.
pub fn equal(chain: &Chain) -> Option<(f64, f64)> {
    let last = chain.mass.len() - 1;
    let from = usize::from(chain.held_head);
    let live = chain.mass.get(from..=last - usize::from(chain.held_tail && last > 0))?;
    let (&mass, &stiffness) = (live.first()?, chain.stiffness.first()?);
    let alike = live.iter().all(|m| *m == mass) && chain.stiffness.iter().all(|k| *k == stiffness);
    alike.then_some((mass, stiffness))
}

/// All modes of an equal chain; `None` for any other.
pub fn modes(scene: &Scene) -> Option<Modes> {
    let (mass, stiffness) = equal(&scene.chain)?;
    let unit = Dd::quotient(stiffness, mass).sqrt();
    let shape = Shape::new(&scene.chain, scene.source);
    let springs = scene.chain.stiffness.len();
    let omega_over_unit: Vec<Dd> =
        (0..shape.modes).map(|j| Dd::from(2.0) * sin_pi(shape.half_angle(j), shape.circle)).collect();
    let table: Vec<f64> = (0..2 * shape.circle).map(|m| sin_pi(m, shape.circle).hi).collect();
    let share = DMatrix::from_fn(springs, shape.modes, |i, j| shape.share(i, j, &table) / omega_over_unit[j].hi);
    let omega = omega_over_unit.into_iter().map(|w| w * unit).collect();
    Some(Modes { omega, share, defect: vec![0.0; springs] })
}

/// The angles of one kind of ends: all are multiples of pi / circle.
struct Shape {
    modes: usize,
    /// pi is this many of the small angle.
    circle: usize,
    /// Mode j's beta / 2 is `2 j + 1` small angles (one end held); otherwise `j + 1`.
    odd: bool,
    held_head: bool,
    held_tail: bool,
    source: usize,
    springs: usize,
    /// Twice the norm factor: 4 / (2N + 1), 2 / n, 2 / (N + 1).
    norm: f64,
}

impl Shape {
    fn new(chain: &Chain, source: usize) -> Shape {
        let Chain { held_head, held_tail, .. } = *chain;
        let springs = chain.stiffness.len();
        let one_held = held_head != held_tail;
        let modes = match (held_head, held_tail) {
            (true, true) => springs - 1,
            _ => springs,
        };
        // beta / 2 = pi (2j - 1) / (4N + 2), or pi j / 2n, or pi j / 2(N + 1).
        let circle = if one_held {
            4 * springs + 2
        } else if held_head {
            2 * springs
        } else {
            2 * (springs + 1)
        };
        let norm = if one_held { 8.0 } else { 4.0 } / circle as f64;
        Shape { modes, circle, odd: one_held, held_head, held_tail, source, springs, norm }
    }

    /// Mode j's beta / 2 in small angles, j from 0.
    fn half_angle(&self, j: usize) -> usize {
        if self.odd { 2 * j + 1 } else { j + 1 }
    }

    /// `omega_j a_ij` in units of the chain, signed for a forward force.
    fn share(&self, spring: usize, mode: usize, sine: &[f64]) -> f64 {
        let half = self.half_angle(mode);
        let full = 2 * self.circle;
        let sin = |m: usize| sine[(m * half) % full];
        let cos = |m: usize| sine[(m * half + self.circle / 2) % full];
        // A chain held at the tail alone is the mirror image of one held at the head: springs keep their sign under
        // mirroring, forces on masses turn theirs.
        let mirrored = self.held_tail && !self.held_head;
        let (i, v, turn) = if mirrored {
            (self.springs - 1 - spring, self.springs - self.source, -1.0)
        } else {
            (spring, self.source, 1.0)
        };
        if self.held_head || mirrored {
            -turn * self.norm * cos(2 * i + 1) * sin(2 * v)
        } else {
            self.norm * sin(2 * (i + 1)) * cos(2 * v + 1)
        }
    }
}
