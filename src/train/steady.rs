//! The couplers' forces under steady forces on the vehicles.
//!
//! ```text
//! a   = sum p_v / sum m_v        where no vehicle is held, 0 where one is
//! F_v = F_{v-1} + p_v - m_v a
//! ```
//!
//! A held end takes whatever force it needs. With both ends held the couplers share the forces as their compliances allow: the
//! ends keep the distance at which the train without a load is unstretched.
//!
//! Where large forces cancel, their rounding error is no force: a sum that is smaller than [`NOISE`] times the sum of
//! the magnitudes in it is 0.

use super::{Coupler, Vehicle};
use crate::solve::dd::Dd;

/// Each term has a rounding error of a few `u = EPSILON / 2`; a sum of terms is off by no more than that share of their magnitudes.
const NOISE: f64 = 8.0 * f64::EPSILON;

/// A sum of terms with these magnitudes in all; 0 if it is no more than their rounding.
pub(crate) fn without_noise(sum: f64, magnitudes: f64) -> f64 {
    if sum.abs() <= NOISE * magnitudes { 0.0 } else { sum }
}

/// A double holds a sum exactly if its low part is under this share of the magnitudes in it.
const EXACT: f64 = 1e-28;

/// The couplers' forces under steady forces from outside, N, draft positive; how far each may be from the exact one, N, 0 where a
/// double holds it exactly; and the train's acceleration, m/s2.
///
/// `outside_n` holds a force for each vehicle, N, forward positive; that of a held vehicle is ignored. Sums are in
/// double-double and rounded once; what is only the rounding of the given forces is 0.
pub fn steady_forces(vehicles: &[Vehicle], couplers: &[Coupler], outside_n: &[f64]) -> (Vec<f64>, Vec<f64>, f64) {
    let last = vehicles.len() - 1;
    let free = !vehicles[0].held && !vehicles[last].held;
    let sum = |terms: &mut dyn Iterator<Item = f64>| terms.fold(Dd::ZERO, |s, x| s + Dd::from(x));
    let live = || (0..=last).filter(|&v| !vehicles[v].held);
    let magnitudes: f64 = live().map(|v| outside_n[v].abs()).sum();
    let total = sum(&mut live().map(|v| outside_n[v]));
    let acceleration = if free && without_noise(total.to_f64(), magnitudes) != 0.0 {
        total / sum(&mut vehicles.iter().map(|v| v.mass_kg))
    } else {
        Dd::ZERO
    };
    let push = |v: usize| Dd::from(outside_n[v]) - Dd::from(vehicles[v].mass_kg) * acceleration;
    let mut force = Dd::ZERO;
    // Up to a constant: the force on a held head, which is not known yet, is left out.
    let mut forces: Vec<Dd> = Vec::with_capacity(couplers.len());
    for (v, vehicle) in vehicles[..last].iter().enumerate() {
        if !vehicle.held {
            force = force + push(v);
        }
        forces.push(force);
    }
    let offset = match (vehicles[0].held, vehicles[last].held) {
        (false, _) => Dd::ZERO,
        // The last vehicle's own balance: F_last = -p_last.
        (true, false) => -(force + push(last)),
        (true, true) => {
            let compliance = |c: &Coupler| Dd::quotient(1.0, c.stiffness_n_per_m);
            let stretch = forces.iter().zip(couplers).fold(Dd::ZERO, |s, (&f, c)| s + f * compliance(c));
            -(stretch / couplers.iter().fold(Dd::ZERO, |s, c| s + compliance(c)))
        }
    };
    let force = |f: &Dd| without_noise((*f + offset).to_f64(), magnitudes);
    let error = |f: &Dd| if (*f + offset).lo.abs() <= EXACT * magnitudes { 0.0 } else { NOISE * magnitudes };
    (forces.iter().map(force).collect(), forces.iter().map(error).collect(), acceleration.to_f64())
}
