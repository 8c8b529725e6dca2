//! Forces from outside that change over time, each on one vehicle, and the brakes that a parting sets off.

use super::{Brakes, Problem};
use crate::forcing::Drive;

/// An unbalanced steady force under this share of the largest force counts as 0.
const BALANCE: f64 = 1e-12;

/// A force over time on one vehicle.
#[derive(Clone, Debug)]
struct Source {
    vehicle: usize,
    course: Course,
}

#[derive(Clone, Debug)]
enum Course {
    /// Straight lines between points; after the last, its value if `holds`, else 0. `next` is the index of the next
    /// point.
    Lines { points: Vec<[f64; 2]>, holds: bool, next: usize },
    /// `peak sin(omega t)` until an instant.
    Sine { peak: f64, omega: f64, until: f64 },
}

/// All forces of a march.
#[derive(Clone, Debug, Default)]
pub struct Forces {
    sources: Vec<Source>,
    /// When the brake of each vehicle begins to act.
    braked_from: Vec<f64>,
}

impl Source {
    /// The next instant after `t` at which the course has a kink; infinite for none.
    fn next_kink(&self, t: f64) -> f64 {
        match &self.course {
            Course::Lines { points, next, .. } => points.get(*next).map_or(f64::INFINITY, |p| p[0]),
            Course::Sine { until, .. } if t < *until => *until,
            Course::Sine { .. } => f64::INFINITY,
        }
    }

    /// Moves on beyond points up to `t`.
    fn pass(&mut self, t: f64) {
        if let Course::Lines { points, next, .. } = &mut self.course {
            while points.get(*next).is_some_and(|p| p[0] <= t) {
                *next += 1;
            }
        }
    }

    /// Adds the terms `f^(k) width^k / k!` at `t`.
    fn add(&self, t: f64, width: f64, mut term: impl FnMut(usize, f64), terms: usize) {
        match &self.course {
            Course::Lines { points, holds, next } => {
                match (next.checked_sub(1).map(|n| points[n]), points.get(*next)) {
                    (Some([from, a]), Some([to, b])) => {
                        let slope = (b - a) / (to - from);
                        term(0, a + slope * (t - from));
                        term(1, slope * width);
                    }
                    (Some([_, a]), None) if *holds => term(0, a),
                    _ => {}
                }
            }
            Course::Sine { peak, omega, until } if t < *until => {
                let (sin, cos) = (omega * t).sin_cos();
                let mut power = *peak;
                for k in 0..terms {
                    term(k, power * [sin, cos, -sin, -cos][k % 4]);
                    power *= omega * width / (k + 1) as f64;
                }
            }
            Course::Sine { .. } => {}
        }
    }

    /// Whether it is 0 until its next kink.
    fn is_zero(&self, t: f64) -> bool {
        match &self.course {
            Course::Lines { points, holds, next } => {
                match (next.checked_sub(1).map(|n| points[n]), points.get(*next)) {
                    (Some([_, a]), Some([_, b])) => a == 0.0 && *b == 0.0,
                    (Some([_, a]), None) => !holds || a == 0.0,
                    (None, _) => true,
                }
            }
            Course::Sine { until, .. } => t >= *until,
        }
    }
}

impl Forces {
    /// Those of a problem before anything parts.
    pub fn of(problem: &Problem) -> Forces {
        let mut forces = Forces::new(&problem.forcing, problem.mass_kg.len());
        if let Some((brakes, places_m)) = &problem.application {
            for &place_m in places_m {
                forces.apply(brakes, problem.direction(), place_m, 0.0);
            }
        }
        forces
    }

    fn new(forcing: &[(usize, Drive)], vehicles: usize) -> Forces {
        let source = |(vehicle, drive): &(usize, Drive)| {
            let course = match drive {
                Drive::Lines(points) => Course::Lines { points: points.clone(), holds: false, next: 0 },
                Drive::HalfSine { peak, duration } => {
                    Course::Sine { peak: *peak, omega: std::f64::consts::PI / duration, until: *duration }
                }
            };
            Source { vehicle: *vehicle, course }
        };
        let mut forces =
            Forces { sources: forcing.iter().map(source).collect(), braked_from: vec![f64::INFINITY; vehicles] };
        forces.pass(0.0);
        forces
    }

    /// The pipe opens at coupler `c` at `t`: the wave runs both ways, and each vehicle brakes
    /// from its first arrival on, against the `direction` of the motion (1 or -1).
    pub fn apply_from_coupler(&mut self, emergency: &Brakes, direction: f64, c: usize, t: f64) {
        self.apply(emergency, direction, emergency.length_m[..=c].iter().sum(), t);
    }

    /// Brakes are applied at a place, m from the front of the train, at `t`.
    fn apply(&mut self, brakes: &Brakes, direction: f64, place_m: f64, t: f64) {
        let mut end = 0.0;
        for (v, (full, length)) in brakes.full_n.iter().zip(&brakes.length_m).enumerate() {
            end += length;
            let from = t + (end - 0.5 * length - place_m).abs() / brakes.wave_m_s;
            if *full == 0.0 || from >= self.braked_from[v] {
                continue;
            }
            self.braked_from[v] = from;
            let force = -direction * full;
            let points = brakes.build_up.iter().map(|p| [from + p[0], force * p[1]]).collect();
            self.sources.retain(|s| s.vehicle != v || !matches!(s.course, Course::Lines { holds: true, .. }));
            self.sources.push(Source { vehicle: v, course: Course::Lines { points, holds: true, next: 0 } });
        }
        self.pass(t);
    }

    /// Whether the brake of a vehicle acts.
    pub fn brakes(&self, vehicle: usize, t: f64) -> bool {
        t >= self.braked_from[vehicle]
    }

    /// The next kink after `t`.
    pub fn next_kink(&self, t: f64) -> f64 {
        self.sources.iter().map(|s| s.next_kink(t)).fold(f64::INFINITY, f64::min)
    }

    /// Moves on beyond kinks up to `t`.
    pub fn pass(&mut self, t: f64) {
        self.sources.iter_mut().for_each(|s| s.pass(t));
    }

    /// Vehicles that some force acts on until the next kink.
    pub fn forced_vehicles(&self, t: f64) -> impl Iterator<Item = usize> {
        self.sources.iter().filter(move |s| !s.is_zero(t)).map(|s| s.vehicle)
    }

    /// Largest angular frequency of the half sines that act at `t`, 1/s; 0 without one.
    pub fn rate(&self, t: f64) -> f64 {
        let omega = |s: &Source| match s.course {
            Course::Sine { omega, until, .. } if t < until => omega,
            _ => 0.0,
        };
        self.sources.iter().map(omega).fold(0.0, f64::max)
    }

    /// Calls `term(vehicle, k, f^(k) width^k / k!)` for every force that acts.
    pub fn expand(&self, t: f64, width: f64, terms: usize, mut term: impl FnMut(usize, usize, f64)) {
        for s in &self.sources {
            s.add(t, width, |k, x| term(s.vehicle, k, x), terms);
        }
    }
}

/// The largest magnitude and the variation of every outside force that changes, with its vehicle; of brakes, whether or not they
/// are applied.
pub fn measures(problem: &Problem) -> Vec<(usize, [f64; 2])> {
    let drives = problem.forcing.iter().map(|(v, drive)| (*v, drive.measures()));
    let applied = problem.application.iter().map(|(brakes, _)| brakes);
    let brakes = problem.emergency.iter().chain(applied).flat_map(|brakes| {
        let largest = brakes.build_up.iter().map(|p| p[1].abs()).fold(0.0, f64::max);
        let first = brakes.build_up.first().map_or(0.0, |p| p[1].abs());
        let variation = first + brakes.build_up.windows(2).map(|p| (p[1][1] - p[0][1]).abs()).sum::<f64>();
        brakes.full_n.iter().enumerate().map(move |(v, full)| (v, [full * largest, full * variation]))
    });
    drives.chain(brakes).collect()
}

/// The most kinks that the outside forces can have.
pub fn kinks(problem: &Problem) -> usize {
    let of_drive = |drive: &Drive| if let Drive::Lines(points) = drive { points.len() } else { 1 };
    let applied = problem.application.iter().map(|(brakes, _)| brakes);
    let of_brakes = problem.emergency.iter().chain(applied).map(|b| b.build_up.len() * b.full_n.len());
    problem.forcing.iter().map(|(_, drive)| of_drive(drive)).sum::<usize>() + of_brakes.sum::<usize>()
}

/// Steady force on each vehicle that the couplers' at t = 0 do not balance, and the common acceleration.
pub fn unbalanced(problem: &Problem, start: &[[f64; 2]]) -> (Vec<f64>, f64) {
    let n = problem.mass_kg.len();
    let free = !problem.held_head && !problem.held_tail;
    let total: f64 = problem.steady_n.iter().sum();
    let common = if free { total / problem.mass_kg.iter().sum::<f64>() } else { 0.0 };
    let largest = start.iter().map(|s| s[1].abs()).chain(problem.steady_n.iter().map(|f| f.abs())).fold(0.0, f64::max);
    let tension = |i: Option<usize>| i.and_then(|i| start.get(i)).map_or(0.0, |s| s[1]);
    let mut left: Vec<f64> = (0..n)
        .map(|v| tension(v.checked_sub(1)) - tension(Some(v)) + problem.steady_n[v] - common * problem.mass_kg[v])
        .collect();
    left.iter_mut().filter(|f| f.abs() <= BALANCE * largest).for_each(|f| *f = 0.0);
    let small = common.abs() * problem.mass_kg.iter().copied().fold(0.0, f64::max) <= BALANCE * largest;
    (left, if small { 0.0 } else { common })
}

/// Sum of the magnitudes of the terms whose sum is the unbalanced force on a vehicle; 0 where that force counts as 0.
pub fn balance_rounding(
    problem: &Problem,
    start: &[[f64; 2]],
    common_m_s2: f64,
    unbalanced: &[f64],
    vehicle: usize,
) -> f64 {
    if unbalanced[vehicle] == 0.0 {
        return 0.0;
    }
    let tension = |i: Option<usize>| i.and_then(|i| start.get(i)).map_or(0.0, |s| s[1].abs());
    let inertia = (common_m_s2 * problem.mass_kg[vehicle]).abs();
    tension(vehicle.checked_sub(1)) + tension(Some(vehicle)) + problem.steady_n[vehicle].abs() + inertia
}

#[cfg(test)]
#[allow(clippy::excessive_precision)] // Reference numbers are given with all their digits.
mod tests;
