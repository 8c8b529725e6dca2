//! The methods that engineers march trains with, as yardsticks: error and run time beside this crate's.
//!
//! All of them follow displacements from the steady state before the event:
//!
//! ```text
//! m_v x_v'' = G_{v-1} - G_v + p_v      G_i = k_i (x_i - x_{i+1})      F_i = F_i(0) + G_i
//! ```
//!
//! A held mass stays at 0. Extremes are the best of the values at whole steps, as a simulator reports them: a peak between
//! two steps is missed by up to `h^2 / 8 max |F''|`, whatever the method's own order. Forces at given instants are cubics
//! through the values and rates at both ends of a step (error of order h^4); the method that chooses its steps ends one there.
//!
//! None of them gives its error.

mod dormand_prince;
mod equations;
mod newmark;
mod runge_kutta;
mod verlet;

use crate::chain::Scene;
use crate::solve::propagator;
use equations::equal_steps;

/// A way to march in time, and what fixes its cost and its accuracy.
///
/// `phase` is `h omega_max`: the step against the chain's fastest oscillation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Peer {
    /// Newmark's average acceleration: implicit, never unstable, order 2.
    Newmark {
        /// Largest phase of a step.
        phase: f64,
    },
    /// Störmer-Verlet (leapfrog): explicit, stable for phases under 2, order 2.
    Verlet {
        /// Largest phase of a step.
        phase: f64,
    },
    /// The classical Runge-Kutta method: explicit, stable for phases under 2 sqrt 2, order 4.
    RungeKutta4 {
        /// Largest phase of a step.
        phase: f64,
    },
    /// Dormand and Prince's explicit method of order 8, which chooses its steps.
    DormandPrince8 {
        /// The estimated error that a step may have, as a share of the state.
        tolerance: f64,
    },
}

/// A march's results.
#[derive(Clone, Debug, PartialEq)]
pub struct Marched {
    /// Of every coupler the largest F and the largest -F at whole steps over 0 <= t <= horizon.
    pub extremes: Vec<[f64; 2]>,
    /// Every coupler's F at each of the instants asked for.
    pub forces: Vec<Vec<f64>>,
    /// Accelerations computed: one for each vehicle, each time.
    pub accelerations: u64,
}

/// A method that chooses its steps gave up.
#[derive(Debug, thiserror::Error)]
#[error("{method} gave up: {why}")]
pub struct GaveUp {
    /// Its name.
    pub method: &'static str,
    /// Its message.
    pub why: String,
}

impl Peer {
    /// Every method from coarse to fine.
    pub fn all() -> Vec<Peer> {
        let phases = [1.0, 0.3, 0.1, 0.03, 0.01];
        let fixed = |of: fn(f64) -> Peer| phases.map(of);
        let newmark = fixed(|phase| Peer::Newmark { phase });
        let verlet = fixed(|phase| Peer::Verlet { phase });
        let runge_kutta = fixed(|phase| Peer::RungeKutta4 { phase });
        let chosen = [1e-3, 1e-6, 1e-9, 1e-12].map(|tolerance| Peer::DormandPrince8 { tolerance });
        newmark.into_iter().chain(verlet).chain(runge_kutta).chain(chosen).collect()
    }

    /// The name in tables and figures.
    pub fn name(self) -> &'static str {
        match self {
            Peer::Newmark { .. } => "Newmark",
            Peer::Verlet { .. } => "Störmer-Verlet",
            Peer::RungeKutta4 { .. } => "Runge-Kutta 4",
            Peer::DormandPrince8 { .. } => "Dormand-Prince 8(5,3)",
        }
    }

    /// The setting in tables.
    pub fn setting(self) -> String {
        match self {
            Peer::Newmark { phase } | Peer::Verlet { phase } | Peer::RungeKutta4 { phase } => {
                format!("h ω_max = {phase}")
            }
            Peer::DormandPrince8 { tolerance } => format!("tolerance {tolerance:e}"),
        }
    }

    /// Accelerations that a march is going to compute; a guess where the method chooses its steps.
    pub(crate) fn estimated_accelerations(self, scene: &Scene) -> f64 {
        let per_radian = match self {
            Peer::Newmark { phase } | Peer::Verlet { phase } => 1.0 / phase,
            Peer::RungeKutta4 { phase } => 4.0 / phase,
            // Fifteen a step; its steps have a phase of about 5 at 1e-3, falling with the eighth root of the tolerance.
            Peer::DormandPrince8 { tolerance } => 3.0 * (1e-3 / tolerance).powf(0.125),
        };
        scene.horizon * propagator::omega_max(scene) * per_radian * scene.chain.mass.len() as f64
    }

    /// Marches a scene to its horizon; `times` ascend.
    ///
    /// # Errors
    /// [`GaveUp`] from a method that chooses its steps.
    pub fn march(self, scene: &Scene, times: &[f64]) -> Result<Marched, GaveUp> {
        let width = |phase: f64| phase / propagator::omega_max(scene);
        match self {
            Peer::Newmark { phase } => Ok(equal_steps(scene, width(phase), times, newmark::start)),
            Peer::Verlet { phase } => Ok(equal_steps(scene, width(phase), times, verlet::start)),
            Peer::RungeKutta4 { phase } => Ok(equal_steps(scene, width(phase), times, runge_kutta::start)),
            Peer::DormandPrince8 { tolerance } => {
                dormand_prince::march(scene, tolerance, times).map_err(|why| GaveUp { method: self.name(), why })
            }
        }
    }
}
