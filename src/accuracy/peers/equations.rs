//! The equations of motion in displacements, and what every march over them has in common.

use super::Marched;
use crate::chain::Scene;

/// Displacements and velocities of the masses; held ones stay at 0.
#[derive(Clone, Debug)]
pub struct State {
    /// From the steady state, forward positive.
    pub displacement: Vec<f64>,
    /// Its rate.
    pub velocity: Vec<f64>,
}

/// The masses and springs of a scene.
#[derive(Clone, Debug)]
pub struct Equations<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// 0 for a held mass.
    pub inverse_mass: Vec<f64>,
}

impl<'a> Equations<'a> {
    /// Those of a scene.
    pub fn new(scene: &'a Scene) -> Equations<'a> {
        let inverse = |v: usize| if scene.chain.live(v) { 1.0 / scene.chain.mass[v] } else { 0.0 };
        Equations { scene, inverse_mass: (0..scene.chain.mass.len()).map(inverse).collect() }
    }

    /// Accelerations under a forward force on the source.
    pub fn accelerate(&self, displacement: &[f64], force: f64, acceleration: &mut [f64]) {
        let stiffness = &self.scene.chain.stiffness;
        let mut ahead = 0.0;
        for v in 0..stiffness.len() {
            let behind = stiffness[v] * (displacement[v] - displacement[v + 1]);
            acceleration[v] = self.inverse_mass[v] * (ahead - behind);
            ahead = behind;
        }
        acceleration[stiffness.len()] = self.inverse_mass[stiffness.len()] * ahead;
        acceleration[self.scene.source] += self.inverse_mass[self.scene.source] * force;
    }

    /// Stretches of time under constant force: from, to, force.
    pub fn stretches(&self) -> Vec<(f64, f64, f64)> {
        let Scene { force, duration, horizon, .. } = *self.scene;
        if duration < horizon {
            vec![(0.0, duration, force), (duration, horizon, 0.0)]
        } else {
            vec![(0.0, horizon, force)]
        }
    }
}

/// Records the forces of a march.
pub struct Recorder<'a> {
    scene: &'a Scene,
    times: &'a [f64],
    marched: Marched,
}

impl<'a> Recorder<'a> {
    /// Before the event.
    pub fn new(scene: &'a Scene, times: &'a [f64]) -> Recorder<'a> {
        let extremes = scene.initial.iter().map(|&f| [f, -f]).collect();
        let forces = Vec::with_capacity(times.len());
        Recorder { scene, times, marched: Marched { extremes, forces, accelerations: 0 } }
    }

    /// The next instant asked for, if it is at most `to`.
    pub fn next_until(&self, to: f64) -> Option<f64> {
        self.times.get(self.marched.forces.len()).copied().filter(|&t| t <= to)
    }

    /// Records the forces of `displacement` as those of the next instant asked for.
    pub fn take(&mut self, displacement: &[f64]) {
        let force = |(i, &f): (usize, &f64)| f + self.since_event(displacement, i);
        let forces = self.scene.initial.iter().enumerate().map(force).collect();
        self.marched.forces.push(forces);
    }

    /// Adds the forces of `displacement` to the extremes.
    pub fn add_to_extremes(&mut self, displacement: &[f64]) {
        let springs = self.scene.chain.stiffness.iter().zip(&self.scene.initial).zip(displacement.windows(2));
        for (((k, f), x), [draft, buff]) in springs.zip(&mut self.marched.extremes) {
            let force = f + k * (x[0] - x[1]);
            *draft = draft.max(force);
            *buff = buff.max(-force);
        }
    }

    /// What was recorded, with the work; instants beyond the last step get its forces.
    pub fn finish(mut self, last: &[f64], accelerations: u64) -> Marched {
        while self.marched.forces.len() < self.times.len() {
            self.take(last);
        }
        Marched { accelerations, ..self.marched }
    }

    fn since_event(&self, displacement: &[f64], spring: usize) -> f64 {
        self.scene.chain.stiffness[spring] * (displacement[spring] - displacement[spring + 1])
    }
}

/// Marches in equal steps of at most `width` under each constant force.
///
/// `start` makes a step's rule from the equations, the state at the start, the step's width and the force; the rule takes
/// the state one step on and returns how often it computed all accelerations.
pub fn equal_steps<'a, R>(
    scene: &'a Scene,
    width: f64,
    times: &[f64],
    start: impl Fn(&Equations<'a>, &State, f64, f64) -> R,
) -> Marched
where
    R: FnMut(&mut State) -> u64,
{
    let equations = Equations::new(scene);
    let rest = vec![0.0; scene.chain.mass.len()];
    let mut state = State { displacement: rest.clone(), velocity: rest };
    let mut recorder = Recorder::new(scene, times);
    let mut accelerations = 0;
    for (from, to, force) in equations.stretches() {
        let count = ((to - from) / width).ceil().max(1.0);
        let width = (to - from) / count;
        let mut step = start(&equations, &state, width, force);
        for n in 0..count as u64 {
            let (begin, end) = (from + n as f64 * width, from + (n + 1) as f64 * width);
            let before = recorder.next_until(end).map(|_| state.clone());
            accelerations += step(&mut state) * scene.chain.mass.len() as u64;
            if let Some(before) = before {
                while let Some(t) = recorder.next_until(end) {
                    recorder.take(&between(&before, &state, width, (t - begin) / width));
                }
            }
            recorder.add_to_extremes(&state.displacement);
        }
    }
    recorder.finish(&state.displacement, accelerations)
}

/// Displacements at the share `x` of a step, by the cubic through both ends' displacements and velocities.
fn between(before: &State, after: &State, width: f64, x: f64) -> Vec<f64> {
    let ends = before.displacement.iter().zip(&before.velocity).zip(after.displacement.iter().zip(&after.velocity));
    let cubic = |((p, v), (q, w)): ((&f64, &f64), (&f64, &f64))| {
        let (slope, end_slope, rise) = (width * v, width * w, q - p);
        p + x * (slope + x * (3.0 * rise - 2.0 * slope - end_slope + x * (slope + end_slope - 2.0 * rise)))
    };
    ends.map(cubic).collect()
}
