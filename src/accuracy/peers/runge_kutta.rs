//! The classical Runge-Kutta method of order 4.
//!
//! ```text
//! y = (x, v), f(y) = (v, a(x))
//! k1 = f(y)   k2 = f(y + h k1 / 2)   k3 = f(y + h k2 / 2)   k4 = f(y + h k3)
//! y <- y + (h / 6) (k1 + 2 k2 + 2 k3 + k4)
//! ```
//!
//! W. Kutta, *Z. Math. Phys.* 46 (1901) 435-453; E. Hairer, S. P. Nørsett, G. Wanner, *Solving Ordinary Differential
//! Equations I*, 2nd ed., Springer 1993, table II.1.2. Stable for `h omega_max < 2 sqrt 2`; each step takes a share
//! `(h omega)^6 / 144` of a mode's energy.

use super::equations::{Equations, State};

/// Where each stage looks, and its weight, in steps.
const STAGES: [(f64, f64); 4] = [(0.0, 1.0 / 6.0), (0.5, 1.0 / 3.0), (0.5, 1.0 / 3.0), (1.0, 1.0 / 6.0)];

/// The rule of a step.
pub fn start<'a>(
    equations: &Equations<'a>,
    state: &State,
    width: f64,
    force: f64,
) -> impl FnMut(&mut State) -> u64 + use<'a> {
    let equations = equations.clone();
    let zero = vec![0.0; state.displacement.len()];
    let still = State { displacement: zero.clone(), velocity: zero };
    // `rate` is the last stage's k, `stage` where the next one is taken, `sum` the weighted mean of the k.
    let (mut rate, mut stage, mut sum) = (still.clone(), still.clone(), still);
    move |state| {
        for (n, &(ahead, weight)) in STAGES.iter().enumerate() {
            let first = n == 0;
            advance(&state.displacement, ahead * width, &rate.displacement, &mut stage.displacement);
            advance(&state.velocity, ahead * width, &rate.velocity, &mut stage.velocity);
            rate.displacement.copy_from_slice(&stage.velocity);
            equations.accelerate(&stage.displacement, force, &mut rate.velocity);
            collect(&mut sum.displacement, weight, &rate.displacement, first);
            collect(&mut sum.velocity, weight, &rate.velocity, first);
        }
        for (x, k) in state.displacement.iter_mut().zip(&sum.displacement) {
            *x += width * k;
        }
        for (v, k) in state.velocity.iter_mut().zip(&sum.velocity) {
            *v += width * k;
        }
        STAGES.len() as u64
    }
}

/// `out = y + by k`
fn advance(y: &[f64], by: f64, k: &[f64], out: &mut [f64]) {
    for ((out, y), k) in out.iter_mut().zip(y).zip(k) {
        *out = y + by * k;
    }
}

/// `sum <- sum + weight k`, from 0 at the first stage.
fn collect(sum: &mut [f64], weight: f64, k: &[f64], first: bool) {
    let keep = if first { 0.0 } else { 1.0 };
    for (s, k) in sum.iter_mut().zip(k) {
        *s = keep * *s + weight * k;
    }
}
