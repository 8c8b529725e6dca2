//! Forces from outside over time, as the equations of motion of a comparison need them.

use crate::forcing::Drive;
use crate::march::{Brakes, Problem};
use crate::solve::dd::Dd;

/// A force over time on one vehicle.
#[derive(Clone, Debug)]
pub struct GearCourse {
    /// From 0.
    pub vehicle: usize,
    /// The force over time.
    pub shape: Shape,
    /// Of a brake that a parting sets off: when it begins to act, s.
    wave_s: Option<f64>,
}

/// A course in time.
#[derive(Clone, Debug)]
pub enum Shape {
    /// Straight lines between points of time, s, and force, N; nothing before the first, and behind the last if it does not hold.
    Lines {
        /// Time and force.
        points: Vec<[Dd; 2]>,
        /// The last one holds.
        holds: bool,
    },
    /// Half a sine from t = 0: peak, N, and duration, s.
    HalfSine(f64, f64),
}

impl GearCourse {
    /// Force and its slope just after `t`; of a half sine none.
    pub fn line(&self, t: Dd) -> [Dd; 2] {
        let Shape::Lines { points, holds } = &self.shape else { return [Dd::ZERO; 2] };
        let next = points.partition_point(|p| p[0] <= t);
        match (next.checked_sub(1).map(|n| points[n]), points.get(next)) {
            (Some([from, a]), Some([to, b])) => {
                let slope = (*b - a) / (*to - from);
                [a + slope * (t - from), slope]
            }
            (Some([_, a]), None) if *holds => [a, Dd::ZERO],
            _ => [Dd::ZERO; 2],
        }
    }

    /// The first kink after `t`.
    fn kink(&self, t: Dd) -> Option<Dd> {
        match &self.shape {
            Shape::Lines { points, .. } => points.iter().map(|p| p[0]).find(|kink| *kink > t),
            Shape::HalfSine(_, duration) => Some(Dd::from(*duration)).filter(|end| *end > t),
        }
    }
}

/// All of them.
#[derive(Clone, Debug)]
pub struct Outside {
    /// Each on its vehicle.
    pub courses: Vec<GearCourse>,
    /// Steady force on each vehicle, N, less what the common acceleration at t = 0 takes.
    pub steady: Vec<Dd>,
}

impl Outside {
    /// Those of a problem, and the brakes that the couplers that are gone set off at t = 0.
    pub fn new(problem: &Problem) -> Outside {
        let one = |(vehicle, drive): &(usize, Drive)| {
            let shape = match drive {
                Drive::Lines(points) => {
                    Shape::Lines { points: points.iter().map(|p| p.map(Dd::from)).collect(), holds: false }
                }
                Drive::HalfSine { peak, duration } => Shape::HalfSine(*peak, *duration),
            };
            GearCourse { vehicle: *vehicle, shape, wave_s: None }
        };
        let mut outside = Outside { courses: problem.forcing.iter().map(one).collect(), steady: steady(problem) };
        if let Some((brakes, places_m)) = &problem.application {
            places_m.iter().for_each(|&place| outside.apply(problem, brakes, Dd::from(place), Dd::ZERO));
        }
        problem.gone.iter().for_each(|&i| outside.part(problem, i, Dd::ZERO));
        outside
    }

    /// Coupler `c` parts.
    pub fn part(&mut self, problem: &Problem, c: usize, t: Dd) {
        let Some(emergency) = &problem.emergency else { return };
        let gap = emergency.length_m[..=c].iter().fold(Dd::ZERO, |sum, &l| sum + Dd::from(l));
        self.apply(problem, emergency, gap, t);
    }

    /// Brakes are applied at a place, m from the front of the train: each vehicle brakes from when the wave first comes to its middle.
    fn apply(&mut self, problem: &Problem, brakes: &Brakes, place: Dd, t: Dd) {
        let sign = if problem.common_speed_m_s.unwrap_or(1.0) < 0.0 { 1.0 } else { -1.0 };
        let length = |v: usize| Dd::from(brakes.length_m[v]);
        let before = |v: usize| (0..v).fold(Dd::ZERO, |sum, v| sum + length(v));
        for (vehicle, full) in brakes.full_n.iter().enumerate().filter(|(_, full)| **full != 0.0) {
            let way = (before(vehicle) + length(vehicle) * Dd::from(0.5) - place).abs();
            let from = t + way / Dd::from(brakes.wave_m_s);
            let of_wave = |course: &GearCourse| course.vehicle == vehicle && course.wave_s.is_some();
            if self.courses.iter().any(|course| of_wave(course) && course.wave_s.is_some_and(|at| at <= from.hi)) {
                continue;
            }
            self.courses.retain(|course| !of_wave(course));
            let force = Dd::from(sign) * Dd::from(*full);
            let points = brakes.build_up.iter().map(|p| [from + Dd::from(p[0]), force * Dd::from(p[1])]).collect();
            self.courses.push(GearCourse {
                vehicle,
                shape: Shape::Lines { points, holds: true },
                wave_s: Some(from.hi),
            });
        }
    }

    /// The first kink of any force after `t`, if there is one.
    pub(crate) fn kink(&self, t: Dd) -> Option<Dd> {
        self.courses.iter().filter_map(|c| c.kink(t)).reduce(|a, b| if b < a { b } else { a })
    }

    /// Adds the forces just after `t` in double precision; half sines included.
    pub(crate) fn add_at(&self, t: f64, forces: &mut [f64]) {
        for course in &self.courses {
            forces[course.vehicle] += match course.shape {
                Shape::HalfSine(peak, duration) if t < duration => peak * (std::f64::consts::PI * t / duration).sin(),
                Shape::HalfSine(..) => 0.0,
                Shape::Lines { .. } => course.line(Dd::from(t))[0].hi,
            };
        }
    }
}

/// Steady forces without the common acceleration; one within 1e-12 of the largest force from balance with the
/// couplers' forces at t = 0 is taken as in balance.
fn steady(problem: &Problem) -> Vec<Dd> {
    let n = problem.mass_kg.len();
    let sum = |of: &[f64]| of.iter().fold(Dd::ZERO, |sum, x| sum + Dd::from(*x));
    let free = !problem.held_head && !problem.held_tail;
    let common = if free { sum(&problem.steady_n) / sum(&problem.mass_kg) } else { Dd::ZERO };
    let force = |i: Option<usize>| i.and_then(|i| problem.start.get(i)).map_or(Dd::ZERO, |r| Dd::from(r.force_n));
    let all = problem.start.iter().map(|r| r.force_n).chain(problem.steady_n.iter().copied());
    let balance = 1e-12 * all.fold(0.0f64, |a, f| a.max(f.abs()));
    let one = |v: usize| {
        let acts = Dd::from(problem.steady_n[v]) - common * Dd::from(problem.mass_kg[v]);
        let balanced = force(Some(v)) - force(v.checked_sub(1));
        if (acts - balanced).abs().hi <= balance { balanced } else { acts }
    };
    (0..n).map(one).collect()
}
