//! A train in double precision as simulators have it: forces from look-up in a coupler's two curves, with the force of the last step as
//! memory.

use super::curves::Curves;
use super::outside::Outside;
use crate::law::Law;
use crate::march::Problem;
use crate::solve::dd::Dd;

/// How a coupler's force is found between its curves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Between {
    /// At the slope kl from the force of the last step, clamped between the curves: exact but for the step.
    Clamp,
    /// The mean of the curves and the share `q' / speed`, at most 1, of half their distance: no memory.
    Smoothed {
        /// m/s
        speed_m_s: f64,
    },
}

/// One coupler.
#[derive(Clone, Debug)]
struct Gear {
    /// Slope between the curves; infinite where there is none.
    solid: f64,
    knots: Vec<f64>,
    /// Place, force and slope of the upper and the lower curve in each interval.
    lines: Vec<[[f64; 3]; 2]>,
    dashpot: f64,
    /// Elongation and force at the end of the last step.
    memory: [f64; 2],
}

impl Gear {
    fn new(curves: &Curves, dashpot: f64, memory: [f64; 2]) -> Gear {
        let line = |l: &super::curves::Line| [l.q.hi, l.force.hi, l.slope.hi];
        Gear {
            solid: curves.solid.map_or(f64::INFINITY, |kl| kl.hi),
            knots: curves.knots.iter().map(|q| q.hi).collect(),
            lines: curves.lines.iter().map(|pair| [line(&pair[0]), line(&pair[1])]).collect(),
            dashpot,
            memory,
        }
    }

    /// Forces of the upper and the lower curve.
    fn bounds(&self, q: f64) -> [f64; 2] {
        let interval = self.knots.iter().take_while(|k| **k <= q).count();
        self.lines[interval].map(|[place, force, slope]| force + slope * (q - place))
    }

    /// Force at an elongation and its rate.
    fn force(&self, q: f64, rate: f64, between: Between) -> f64 {
        let [upper, lower] = self.bounds(q);
        let drag = self.dashpot * rate;
        match between {
            _ if self.solid.is_infinite() => drag + upper,
            Between::Clamp => {
                let [at, force] = self.memory;
                // The lower curve can be over the upper one by rounding only.
                drag + (force + self.solid * (q - at)).min(upper).max(lower.min(upper))
            }
            Between::Smoothed { speed_m_s } => {
                drag + 0.5 * (upper + lower) + 0.5 * (upper - lower) * (rate / speed_m_s).clamp(-1.0, 1.0)
            }
        }
    }

    fn stiffest(&self) -> f64 {
        let slopes = self.lines.iter().flatten().map(|l| l[2]);
        if self.solid.is_finite() { self.solid } else { slopes.fold(0.0, f64::max) }
    }

    /// Half the largest distance of the curves at a knot.
    fn friction(&self) -> f64 {
        let apart = self.knots.iter().map(|&q| self.bounds(q)).map(|[upper, lower]| 0.5 * (upper - lower));
        if self.solid.is_finite() { apart.fold(0.0, f64::max) } else { 0.0 }
    }
}

/// Elongations of the couplers and speeds of the vehicles.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// m
    pub q: Vec<f64>,
    /// m/s
    pub v: Vec<f64>,
}

/// The train.
#[derive(Clone, Debug)]
pub struct Clamped {
    gears: Vec<Gear>,
    between: Between,
    inverse_mass: Vec<f64>,
    outside: Outside,
    steady: Vec<f64>,
    /// At t = 0.
    pub start: State,
    /// What every coupler's extremes begin with: largest F and largest -F.
    pub extremes: Vec<[f64; 2]>,
}

impl Clamped {
    /// Of a problem without later partings; `softer` divides the stiffness in series with the gears.
    pub fn new(problem: &Problem, between: Between, softer: f64) -> Clamped {
        let n = problem.mass_kg.len();
        let held = |v: usize| v == 0 && problem.held_head || v + 1 == n && problem.held_tail;
        let outside = Outside::new(problem);
        let gear = |i: usize| {
            let law = match &problem.laws[i] {
                Law::Gear { solid_n_per_m, slack_m, draft, buff } => Law::Gear {
                    solid_n_per_m: solid_n_per_m / softer,
                    slack_m: *slack_m,
                    draft: draft.clone(),
                    buff: buff.clone(),
                },
                elastic => elastic.clone(),
            };
            let rest = &problem.start[i];
            let whole = Gear::new(&Curves::new(&law), 0.0, [law.elongation_m(rest), rest.force_n]);
            if !problem.gone.contains(&i) {
                let dashpot = problem.dashpot_n_s_per_m.get(i).copied().unwrap_or(0.0);
                return Gear { dashpot, ..whole };
            }
            let parted = Gear::new(&Curves::parted(&law), 0.0, whole.memory);
            let force = parted.force(whole.memory[0], 0.0, Between::Clamp);
            Gear { memory: [whole.memory[0], force], ..parted }
        };
        let gears: Vec<Gear> = (0..n - 1).map(gear).collect();
        Clamped {
            between,
            inverse_mass: (0..n).map(|v| if held(v) { 0.0 } else { 1.0 / problem.mass_kg[v] }).collect(),
            steady: outside.steady.iter().map(|f: &Dd| f.hi).collect(),
            outside,
            start: State { q: gears.iter().map(|g| g.memory[0]).collect(), v: problem.speed_m_s.clone() },
            extremes: gears.iter().map(|g| [g.memory[1], -g.memory[1]]).collect(),
            gears,
        }
    }

    /// Bound on the rate of the motion, 1/s.
    pub fn rate(&self) -> f64 {
        let around = |v: usize, of: &dyn Fn(&Gear) -> f64| {
            let value = |i: Option<usize>| i.and_then(|i| self.gears.get(i)).map_or(0.0, of);
            self.inverse_mass[v] * (value(v.checked_sub(1)) + value(Some(v)))
        };
        let largest =
            |of: &dyn Fn(&Gear) -> f64| (0..self.inverse_mass.len()).map(|v| around(v, of)).fold(0.0, f64::max);
        let drag = largest(&|g| match self.between {
            Between::Smoothed { speed_m_s } => g.dashpot + g.friction() / speed_m_s,
            Between::Clamp => g.dashpot,
        });
        (2.0 * largest(&|g| g.stiffest())).sqrt() + 2.0 * drag
    }

    /// Whether any coupler has friction.
    pub(crate) fn has_friction(&self) -> bool {
        self.gears.iter().any(|g| g.friction() > 0.0)
    }

    /// Force of a coupler.
    pub fn force(&self, state: &State, i: usize) -> f64 {
        self.gears[i].force(state.q[i], state.v[i] - state.v[i + 1], self.between)
    }

    /// Rates of speeds at an instant.
    pub fn accelerate(&self, t: f64, state: &State, out: &mut [f64]) {
        out.copy_from_slice(&self.steady);
        self.outside.add_at(t, out);
        for i in 0..self.gears.len() {
            let force = self.force(state, i);
            out[i] -= force;
            out[i + 1] += force;
        }
        out.iter_mut().zip(&self.inverse_mass).for_each(|(a, m)| *a *= m);
    }

    /// Makes a state the one of the last step: its forces are the memory, and may be extremes.
    pub(crate) fn commit(&mut self, state: &State) {
        for i in 0..self.gears.len() {
            let force = self.force(state, i);
            let without_drag = force - self.gears[i].dashpot * (state.v[i] - state.v[i + 1]);
            self.gears[i].memory = [state.q[i], without_drag];
            let [draft, buff] = &mut self.extremes[i];
            (*draft, *buff) = (draft.max(force), buff.max(-force));
        }
    }
}
