//! The methods that engineers march trains with, on trains with slack and gears: none of them looks for the instants at which a coupler
//! goes from one curve to another.
//!
//! Extremes are the best of the values at whole steps. Forces at given instants come from elongations by the cubic through both ends of
//! a step, and the law from the step's start; the method that chooses its steps ends one there.

use super::clamp::{Between, Clamped, State};
use crate::accuracy::peers::Marched;
use crate::march::Problem;

/// A way to march in time; `phase` is the step times the bound on the motion's rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GearPeer {
    /// Velocity Verlet with the clamp: one force a step, of order 2 but for the kinks.
    Verlet {
        /// Phase of a step.
        phase: f64,
    },
    /// The classical Runge-Kutta method with the clamp.
    RungeKutta4 {
        /// Phase of a step.
        phase: f64,
    },
    /// Dormand and Prince's method of order 5 with the error estimate of order 4, with the clamp, without events.
    DormandPrince5 {
        /// Estimated error of a step, as a share of the state.
        tolerance: f64,
    },
    /// Friction that depends on the speed of the elongation up to a limit, by Runge-Kutta 4.
    Smoothed {
        /// The limit, m/s.
        speed_m_s: f64,
    },
    /// Verlet with the clamp, and the stiffness in series divided.
    Softened {
        /// By which number.
        divisor: f64,
    },
}

/// Phase of the steps of methods whose error has another cause.
const FINE: f64 = 0.03;
/// The same of smoothed friction, which is stiff.
const STIFF: f64 = 0.5;
/// Shares of a step at which stages are, Dormand and Prince's rows, and the differences of the weights of both orders.
const NODES: [f64; 7] = [0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0];
const ROWS: [&[f64]; 7] = [
    &[],
    &[1.0 / 5.0],
    &[3.0 / 40.0, 9.0 / 40.0],
    &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
    &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
    &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
    &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
const DIFFERENCES: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0];
/// Runge and Kutta's nodes and weights.
const HALVES: [f64; 4] = [0.0, 0.5, 0.5, 1.0];
const WEIGHTS: [f64; 4] = [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0];

impl GearPeer {
    /// Every method from coarse to fine.
    pub fn all() -> Vec<GearPeer> {
        let phases = [1.0, 0.3, 0.1, 0.03, 0.01, 0.003, 0.001];
        let verlet = phases.map(|phase| GearPeer::Verlet { phase });
        let runge_kutta = phases[..6].iter().map(|&phase| GearPeer::RungeKutta4 { phase });
        let chosen = [1e-3, 1e-5, 1e-7, 1e-9].map(|tolerance| GearPeer::DormandPrince5 { tolerance });
        let smoothed = [0.1, 0.01, 0.001].map(|speed_m_s| GearPeer::Smoothed { speed_m_s });
        let softened = [8.0, 4.0, 2.0].map(|divisor| GearPeer::Softened { divisor });
        verlet.into_iter().chain(runge_kutta).chain(chosen).chain(smoothed).chain(softened).collect()
    }

    /// The name in tables and figures.
    pub fn name(self) -> &'static str {
        match self {
            GearPeer::Verlet { .. } => "Verlet with a clamp",
            GearPeer::RungeKutta4 { .. } => "Runge-Kutta 4 with a clamp",
            GearPeer::DormandPrince5 { .. } => "Dormand-Prince 5(4) with a clamp",
            GearPeer::Smoothed { .. } => "friction smoothed by speed",
            GearPeer::Softened { .. } => "softened lock",
        }
    }

    /// The setting in tables.
    pub fn setting(self) -> String {
        match self {
            GearPeer::Verlet { phase } | GearPeer::RungeKutta4 { phase } => format!("h ω_max = {phase}"),
            GearPeer::DormandPrince5 { tolerance } => format!("tolerance {tolerance:e}"),
            GearPeer::Smoothed { speed_m_s } => format!("below {speed_m_s} m/s"),
            GearPeer::Softened { divisor } => format!("solid stiffness / {divisor}"),
        }
    }

    /// Whether it differs from the others only where there is friction.
    pub(crate) fn needs_friction(self) -> bool {
        matches!(self, GearPeer::Smoothed { .. } | GearPeer::Softened { .. })
    }

    /// The train as the method has it.
    pub fn train(self, problem: &Problem) -> Clamped {
        match self {
            GearPeer::Smoothed { speed_m_s } => Clamped::new(problem, Between::Smoothed { speed_m_s }, 1.0),
            GearPeer::Softened { divisor } => Clamped::new(problem, Between::Clamp, divisor),
            _ => Clamped::new(problem, Between::Clamp, 1.0),
        }
    }

    /// Accelerations that a march is going to compute; a guess where the method chooses its steps.
    pub(crate) fn estimated_accelerations(self, problem: &Problem) -> f64 {
        let per_radian = match self {
            GearPeer::Verlet { phase } => 1.0 / phase,
            GearPeer::RungeKutta4 { phase } => 4.0 / phase,
            GearPeer::DormandPrince5 { tolerance } => 7.0 * (1e-3 / tolerance).powf(0.2),
            GearPeer::Smoothed { .. } => 4.0 / STIFF,
            GearPeer::Softened { .. } => 1.0 / FINE,
        };
        problem.horizon_s * self.train(problem).rate() * per_radian * problem.mass_kg.len() as f64
    }

    /// Marches a problem without later partings to its horizon; `times` ascend.
    pub fn march(self, problem: &Problem, times: &[f64]) -> Marched {
        let train = self.train(problem);
        let rate = train.rate();
        let mut run = Run { train, times, forces: Vec::new(), stages: Vec::new(), accelerations: 0 };
        match self {
            GearPeer::Verlet { phase } => run.equal_steps(problem.horizon_s, phase / rate, Run::verlet),
            GearPeer::RungeKutta4 { phase } => run.equal_steps(problem.horizon_s, phase / rate, Run::runge_kutta),
            GearPeer::Smoothed { .. } => run.equal_steps(problem.horizon_s, STIFF / rate, Run::runge_kutta),
            GearPeer::Softened { .. } => run.equal_steps(problem.horizon_s, FINE / rate, Run::verlet),
            GearPeer::DormandPrince5 { tolerance } => run.chosen_steps(problem.horizon_s, tolerance, rate),
        }
        Marched { extremes: run.train.extremes, forces: run.forces, accelerations: run.accelerations }
    }
}

struct Run<'a> {
    train: Clamped,
    times: &'a [f64],
    forces: Vec<Vec<f64>>,
    /// Rates of elongations and speeds at the stages of a step.
    stages: Vec<State>,
    accelerations: u64,
}

impl Run<'_> {
    fn equal_steps(&mut self, horizon: f64, width: f64, step: fn(&mut Self, f64, f64, &mut State)) {
        let count = (horizon / width).ceil().max(1.0);
        let width = horizon / count;
        let mut state = self.train.start.clone();
        for n in 0..count as u64 {
            // The last step ends at the horizon but for rounding.
            let (begin, end) = (n as f64 * width, (n + 1) as f64 * width * (1.0 + 1e-12));
            let before = self.due(end).map(|_| (state.clone(), self.train.clone()));
            step(self, begin, width, &mut state);
            if let Some((before, train)) = before {
                while let Some(t) = self.due(end) {
                    let at = between(&before, &state, width, (t - begin) / width);
                    self.forces.push((0..at.q.len()).map(|i| train.force(&at, i)).collect());
                }
            }
        }
    }

    /// The next instant asked for, if it is at most `end`.
    fn due(&self, end: f64) -> Option<f64> {
        self.times.get(self.forces.len()).copied().filter(|t| *t <= end)
    }

    fn accelerate(&mut self, t: f64, state: &State) -> Vec<f64> {
        let mut out = vec![0.0; state.v.len()];
        self.train.accelerate(t, state, &mut out);
        self.accelerations += out.len() as u64;
        out
    }

    fn verlet(&mut self, t: f64, width: f64, state: &mut State) {
        // The first half kick of a step repeats the forces of the last one's end.
        let kick = |state: &mut State, a: &[f64]| state.v.iter_mut().zip(a).for_each(|(v, a)| *v += 0.5 * width * a);
        let a = match self.stages.pop() {
            Some(last) => last.v,
            None => self.accelerate(t, state),
        };
        kick(state, &a);
        for i in 0..state.q.len() {
            state.q[i] += width * (state.v[i] - state.v[i + 1]);
        }
        let a = self.accelerate(t + width, state);
        kick(state, &a);
        self.train.commit(state);
        self.stages.push(State { q: Vec::new(), v: a });
    }

    fn runge_kutta(&mut self, t: f64, width: f64, state: &mut State) {
        self.stages.clear();
        for (n, node) in HALVES.into_iter().enumerate() {
            let at = match self.stages.last() {
                Some(last) => moved(state, &[(node * width, last)]),
                None => state.clone(),
            };
            self.stage(t + node * width, &at);
            debug_assert_eq!(self.stages.len(), n + 1);
        }
        let parts: Vec<(f64, &State)> = WEIGHTS.iter().map(|w| w * width).zip(&self.stages).collect();
        *state = moved(state, &parts);
        self.train.commit(state);
    }

    fn stage(&mut self, t: f64, at: &State) {
        let v = self.accelerate(t, at);
        let q = at.v.windows(2).map(|v| v[0] - v[1]).collect();
        self.stages.push(State { q, v });
    }

    /// Steps whose estimated error is under the tolerance of what elongations and speeds can be.
    fn chosen_steps(&mut self, horizon: f64, tolerance: f64, rate: f64) {
        let mut state = self.train.start.clone();
        let long = state.q.iter().fold(0.0f64, |a, q| a.max(q.abs()));
        let fast = state.v.windows(2).map(|v| (v[0] - v[1]).abs()).fold(long * rate, f64::max);
        let (long, fast) = (long.max(fast / rate), fast);
        let (mut t, mut width) = (0.0, 0.1 / rate);
        while t < horizon {
            let end = self.due(horizon).filter(|at| *at > t).unwrap_or(horizon);
            let last = t + width >= end;
            let taken = if last { end - t } else { width };
            let (next, error) = self.tried(t, taken, &state, [tolerance * long, tolerance * fast]);
            if error <= 1.0 || taken <= 1e-9 / rate {
                state = next;
                t = if last { end } else { t + taken };
                self.train.commit(&state);
                while self.due(t).is_some() {
                    self.forces.push((0..state.q.len()).map(|i| self.train.force(&state, i)).collect());
                }
            }
            let factor = (0.9 * error.max(1e-10).powf(-0.2)).clamp(0.2, 5.0);
            width = if last && error <= 1.0 { width.max(factor * taken) } else { factor * taken };
        }
    }

    /// The state a step on, and the error of the step as a share of what it may be.
    fn tried(&mut self, t: f64, width: f64, state: &State, [long, fast]: [f64; 2]) -> (State, f64) {
        self.stages.clear();
        let mut next = state.clone();
        for (node, row) in NODES.into_iter().zip(ROWS) {
            let parts: Vec<(f64, &State)> = row.iter().map(|a| a * width).zip(&self.stages).collect();
            next = moved(state, &parts);
            self.stage(t + node * width, &next);
        }
        let zero = State { q: vec![0.0; state.q.len()], v: vec![0.0; state.v.len()] };
        let parts: Vec<(f64, &State)> = DIFFERENCES.iter().map(|d| d * width).zip(&self.stages).collect();
        let off = moved(&zero, &parts);
        let squares = off.q.iter().map(|q| (q / long).powi(2)).chain(off.v.iter().map(|v| (v / fast).powi(2)));
        (next, (squares.sum::<f64>() / (off.q.len() + off.v.len()) as f64).sqrt())
    }
}

/// A state plus multiples of rates.
fn moved(state: &State, parts: &[(f64, &State)]) -> State {
    let mut next = state.clone();
    for (share, rates) in parts {
        next.q.iter_mut().zip(&rates.q).for_each(|(q, r)| *q += share * r);
        next.v.iter_mut().zip(&rates.v).for_each(|(v, r)| *v += share * r);
    }
    next
}

/// The state at a share of a step: elongations by the cubic through both ends, speeds by a line.
fn between(before: &State, after: &State, width: f64, x: f64) -> State {
    let rate = |s: &State, i: usize| width * (s.v[i] - s.v[i + 1]);
    let cubic = |i: usize| {
        let (a, b, rise) = (rate(before, i), rate(after, i), after.q[i] - before.q[i]);
        before.q[i] + x * (a + x * (3.0 * rise - 2.0 * a - b + x * (a + b - 2.0 * rise)))
    };
    let v = before.v.iter().zip(&after.v).map(|(a, b)| a + x * (b - a)).collect();
    State { q: (0..before.q.len()).map(cubic).collect(), v }
}
