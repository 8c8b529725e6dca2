//! Functions of `X = h^2 A` as power series over one step's phases.

use std::sync::OnceLock;

use super::dd::Dd;

/// Largest phase of a step, h omega_max.
pub(crate) const PHASE: f64 = 1.5;
/// Powers of X that [`table`]'s functions need for 1e-16 up to the largest phase.
pub(crate) const POWERS: usize = 14;
/// Coefficients of z, even and odd each, for the same.
pub(crate) const DEGREE: usize = 9;

/// Coefficients of X's powers in the two functions of [`super::pieces`], for each power of z.
pub struct Table {
    /// Of `cos(z theta/2) / cos(theta/2)`: z^0, z^2, ...
    pub even: [[f64; POWERS]; DEGREE],
    /// Of `sin(z theta/2) / sin(theta/2)`: z^1, z^3, ...
    pub odd: [[f64; POWERS]; DEGREE],
}

/// The table, made once.
pub fn table() -> &'static Table {
    static TABLE: OnceLock<Table> = OnceLock::new();
    TABLE.get_or_init(|| {
        // With phi = theta / 2: (-1)^m phi^2m / (2m)! / cos(phi), and (-1)^m phi^2m / (2m+1)! phi / sin(phi).
        let quarter = Dd::from(0.25);
        let fit = |m: usize, odd: usize| {
            let power =
                |x: Dd| (1..=2 * m + odd).fold(Dd::ONE, |p, q| p / Dd::from(q as f64)) * signed_power(x * quarter, m);
            let over = |x: Dd| if odd == 1 { sine_over_root(x * quarter) } else { cosine_of_root(x * quarter) };
            polynomial(POWERS, PHASE, |x| power(x) / over(x))
        };
        let fits =
            |odd: usize| std::array::from_fn(|m| fit(m, odd).try_into().expect("as many coefficients as powers"));
        Table { even: fits(0), odd: fits(1) }
    })
}

fn signed_power(x: Dd, m: usize) -> Dd {
    (0..m).fold(Dd::ONE, |p, _| -(p * x))
}

/// `cos(sqrt x)`
pub(crate) fn cosine_of_root(x: Dd) -> Dd {
    (0..16).rev().fold(Dd::ONE, |sum, k| Dd::ONE - x * sum / Dd::from(f64::from((2 * k + 1) * (2 * k + 2))))
}

/// `sin(sqrt x) / sqrt x`
pub(crate) fn sine_over_root(x: Dd) -> Dd {
    (0..16).rev().fold(Dd::ONE, |sum, k| Dd::ONE - x * sum / Dd::from(f64::from((2 * k + 2) * (2 * k + 3))))
}

/// The polynomial of `terms` terms through `f` at the Chebyshev points of 0 <= x <= phase^2, in powers of x.
pub(crate) fn polynomial(terms: usize, phase: f64, f: impl Fn(Dd) -> Dd) -> Vec<f64> {
    let top = phase * phase;
    let point = |k: usize| {
        let angle = std::f64::consts::PI * (2 * k + 1) as f64 / (2 * terms) as f64;
        Dd::from(0.5 * top * (1.0 + angle.cos()))
    };
    let x: Vec<Dd> = (0..terms).map(point).collect();
    let mut difference: Vec<Dd> = x.iter().map(|&x| f(x)).collect();
    for order in 1..terms {
        for k in (order..terms).rev() {
            difference[k] = (difference[k] - difference[k - 1]) / (x[k] - x[k - order]);
        }
    }
    // Newton's form to powers of x.
    let mut power = vec![Dd::ZERO; terms];
    for k in (0..terms).rev() {
        for m in (0..terms).rev() {
            let lower = if m > 0 { power[m - 1] } else { difference[k] };
            power[m] = lower - x[k] * power[m];
        }
    }
    power.into_iter().map(Dd::to_f64).collect()
}

#[cfg(test)]
mod tests;
