//! Störmer-Verlet, leapfrog, central differences: one method under many names, here as kick, drift, kick.
//!
//! ```text
//! v <- v + (h / 2) a(x)      x <- x + h v      v <- v + (h / 2) a(x)
//! ```
//!
//! L. Verlet, *Phys. Rev.* 159 (1967) 98-103; E. Hairer, C. Lubich, G. Wanner, "Geometric numerical integration
//! illustrated by the Störmer-Verlet method", *Acta Numerica* 12 (2003) 399-450. Stable for `h omega_max < 2`, of order 2:
//! a mode of frequency omega runs fast by `(h omega)^2 / 24`.

use super::equations::{Equations, State};

/// The rule of a step.
pub fn start<'a>(
    equations: &Equations<'a>,
    state: &State,
    width: f64,
    force: f64,
) -> impl FnMut(&mut State) -> u64 + use<'a> {
    let equations = equations.clone();
    let mut acceleration = vec![0.0; state.displacement.len()];
    equations.accelerate(&state.displacement, force, &mut acceleration);
    move |state| {
        for ((x, v), a) in state.displacement.iter_mut().zip(&mut state.velocity).zip(&acceleration) {
            *v += 0.5 * width * a;
            *x += width * *v;
        }
        equations.accelerate(&state.displacement, force, &mut acceleration);
        for (v, a) in state.velocity.iter_mut().zip(&acceleration) {
            *v += 0.5 * width * a;
        }
        1
    }
}
