//! A run of coupled vehicles as a chain of masses and springs, and a step or pulse of force on it.
//!
//! Everything here is in one consistent set of units, whatever it is (`m_ref`, `k_ref` and `f_ref` = 1 in the solvers).

/// Masses joined by springs, equal or not: spring `i` lies between mass `i` and mass `i + 1` ([P] figure 1).
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// Masses, from the head; at least one. That of a held end is not used.
    pub mass: Vec<f64>,
    /// Stiffnesses, `mass.len() - 1` of them.
    pub stiffness: Vec<f64>,
    /// The first mass keeps its speed.
    pub held_head: bool,
    /// The last mass keeps its speed.
    pub held_tail: bool,
}

/// A step or rectangular pulse of outside force on one mass of a chain in steady state.
///
/// Spring forces: `F_i(t) = initial_i + force * (R_i(t) - R_i(t - duration))`, with `R_i` the response of spring `i` to
/// a unit forward step of force on mass `source` at t = 0 and `R_i = 0` before.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// The chain.
    pub chain: Chain,
    /// Index of the mass that the force acts on; not held.
    pub source: usize,
    /// Outside force on it, forward (toward the head) positive. A broken coupler's front part feels `+F_b` on its last
    /// mass, the rear part `-F_b` on its first.
    pub force: f64,
    /// How long the force acts; infinite for a step.
    pub duration: f64,
    /// Spring forces before t = 0, tension positive.
    pub initial: Vec<f64>,
    /// Capacity of each spring in tension.
    pub rated_draft: Vec<f64>,
    /// Capacity of each spring in compression, positive.
    pub rated_buff: Vec<f64>,
    /// Forces are followed over 0 <= t <= horizon.
    pub horizon: f64,
}

impl Chain {
    /// Whether mass `v` moves freely.
    pub fn live(&self, v: usize) -> bool {
        !(v == 0 && self.held_head || v + 1 == self.mass.len() && self.held_tail)
    }

    /// Time that a long wave takes from one end to the other: sum over springs of `sqrt(m / k)`.
    ///
    /// For each spring the mean of the roots of its two masses is used, so that a train and its mirror image agree;
    /// held masses are left out. For equal vehicles this is the number of springs over the wave speed `sqrt(k / m)`.
    pub fn transit(&self) -> f64 {
        let spring = |(i, k): (usize, &f64)| {
            let live = [i, i + 1].into_iter().filter(|&v| self.live(v));
            let (sum, count) = live.fold((0.0, 0.0), |(s, c), v| (s + (self.mass[v] / k).sqrt(), c + 1.0));
            if count > 0.0 { sum / count } else { 0.0 }
        };
        let terms: Vec<f64> = self.stiffness.iter().enumerate().map(spring).collect();
        // Equal terms are multiplied: trains of equal vehicles then have whole transits. An empty sum is -0: `abs`.
        terms.chunk_by(|a, b| a == b).map(|run| run.len() as f64 * run[0]).sum::<f64>().abs()
    }
}
