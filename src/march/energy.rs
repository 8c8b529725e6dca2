//! The energy of a march: kinetic and stored energy against the work of outside forces.

use super::Energy;
use super::run::Run;
use super::series::{Series, State};

#[derive(Clone, Debug)]
pub struct Audit {
    last: f64,
    work_now: f64,
    pub energy: Energy,
}

impl Audit {
    pub fn new(run: &Run) -> Audit {
        let now = total(run);
        Audit { last: now, work_now: 0.0, energy: Energy { start_j: now, end_j: now, ..Energy::default() } }
    }

    /// A coupler parts and releases this energy.
    pub fn release(&mut self, energy: f64) {
        self.energy.released_j += energy;
        self.last -= energy;
    }

    /// Work of the outside forces in a step.
    pub fn work(&mut self, state: &State, series: &Series, start: &[[f64; 2]], width: f64) {
        let tension = |i: Option<usize>| i.and_then(|i| start.get(i)).map_or(0.0, |s| s[1]);
        // Integral of (time / width)^power times the speed.
        let moment = |v: usize, power: usize| -> f64 {
            series.v[..=series.terms]
                .iter()
                .enumerate()
                .rev()
                .map(|(k, row)| row[v] / (k + power + 1) as f64)
                .sum::<f64>()
                * width
        };
        let mut sum = 0.0;
        for v in state.moving[0]..state.moving[1] {
            let steady = tension(Some(v)) - tension(v.checked_sub(1)) + state.unbalanced[v];
            if state.inverse_mass[v] > 0.0 {
                sum += steady * moment(v, 0);
            }
        }
        for (k, forces) in series.outside.iter().enumerate() {
            sum += forces.iter().map(|&(v, f)| f * moment(v, k)).sum::<f64>();
        }
        self.work_now = sum;
    }

    /// A step has been taken.
    pub fn step(&mut self, run: &Run) {
        let now = total(run);
        self.energy.work_j += self.work_now;
        self.energy.created_j = self.energy.created_j.max(now - self.last - self.work_now);
        (self.last, self.energy.end_j) = (now, now);
    }
}

fn total(run: &Run) -> f64 {
    let state = &run.state;
    let speed = |v: usize| state.v[0][v] + state.v[1][v];
    let moving = |(v, m): (usize, &f64)| if state.inverse_mass[v] > 0.0 { 0.5 * m * speed(v) * speed(v) } else { 0.0 };
    let kinetic: f64 = run.problem.mass_kg.iter().enumerate().map(moving).sum();
    kinetic + run.couplers.iter().enumerate().map(|(i, c)| c.energy(state.elongation(i))).sum::<f64>()
}
