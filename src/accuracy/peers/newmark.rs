//! Newmark's method with average acceleration (beta = 1/4, gamma = 1/2).
//!
//! ```text
//! w = x_n + h v_n + (h^2 / 4) a_n
//! [M + (h^2 / 4) K] a_{n+1} = p - K w
//! x_{n+1} = w + (h^2 / 4) a_{n+1}          v_{n+1} = v_n + (h / 2) (a_n + a_{n+1})
//! ```
//!
//! N. M. Newmark, "A method of computation for structural dynamics", *J. Eng. Mech. Div. ASCE* 85 (1959) 67-94. Stable at
//! any h for linear springs, and of order 2: a mode of frequency omega runs slow by `(h omega)^2 / 12`. The matrix is
//! tridiagonal and is factorised once as L D L^T.

use super::equations::{Equations, State};

/// The rule of a step.
pub fn start<'a>(
    equations: &Equations<'a>,
    state: &State,
    width: f64,
    force: f64,
) -> impl FnMut(&mut State) -> u64 + use<'a> {
    let equations = equations.clone();
    let quarter = 0.25 * width * width;
    let matrix = Factors::new(&equations, quarter);
    let mut acceleration = vec![0.0; state.displacement.len()];
    equations.accelerate(&state.displacement, force, &mut acceleration);
    let mut next = acceleration.clone();
    move |state| {
        for ((x, v), a) in state.displacement.iter_mut().zip(&state.velocity).zip(&acceleration) {
            *x += width * v + quarter * a;
        }
        equations.accelerate(&state.displacement, force, &mut next);
        matrix.solve(&equations.scene.chain.mass, &mut next);
        for v in 0..next.len() {
            state.displacement[v] += quarter * next[v];
            state.velocity[v] += 0.5 * width * (acceleration[v] + next[v]);
        }
        std::mem::swap(&mut acceleration, &mut next);
        1
    }
}

/// `M + q K = L D L^T` on the live masses; a held mass has a row of its own.
struct Factors {
    inverse_pivot: Vec<f64>,
    /// L's entry that couples mass v + 1 to mass v.
    below: Vec<f64>,
}

impl Factors {
    fn new(equations: &Equations, q: f64) -> Factors {
        let chain = &equations.scene.chain;
        let last = chain.mass.len() - 1;
        let (mut inverse_pivot, mut below) = (Vec::with_capacity(last + 1), Vec::with_capacity(last));
        let mut carried = 0.0;
        for v in 0..=last {
            let ahead = if v > 0 { chain.stiffness[v - 1] } else { 0.0 };
            let behind = if v < last { chain.stiffness[v] } else { 0.0 };
            let pivot = if chain.live(v) { chain.mass[v] + q * (ahead + behind) - carried } else { 1.0 };
            inverse_pivot.push(1.0 / pivot);
            if v < last {
                let coupling = if chain.live(v) && chain.live(v + 1) { -q * behind } else { 0.0 };
                below.push(coupling / pivot);
                carried = coupling * coupling / pivot;
            }
        }
        Factors { inverse_pivot, below }
    }

    /// Accelerations from those that the forces alone would give: multiplied by their masses these are the right-hand side.
    fn solve(&self, mass: &[f64], a: &mut [f64]) {
        let last = a.len() - 1;
        a[0] *= mass[0];
        for v in 1..=last {
            a[v] = mass[v] * a[v] - self.below[v - 1] * a[v - 1];
        }
        a[last] *= self.inverse_pivot[last];
        for v in (0..last).rev() {
            a[v] = self.inverse_pivot[v] * a[v] - self.below[v] * a[v + 1];
        }
    }
}
