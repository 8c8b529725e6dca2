//! Forces over time on a vehicle.

/// A force over time, forward positive; none before t = 0 and after the last instant.
#[derive(Clone, Debug, PartialEq)]
pub enum Drive {
    /// Straight lines between instants, in order and none negative; two at one instant are a jump.
    Lines(Vec<[f64; 2]>),
    /// `peak sin(pi t / duration)`
    HalfSine {
        /// Largest force.
        peak: f64,
        /// How long.
        duration: f64,
    },
}

impl Drive {
    /// No force at all.
    pub fn none() -> Drive {
        Drive::Lines(Vec::new())
    }

    /// A constant force from t = 0 to a duration.
    pub fn rectangle(force: f64, duration: f64) -> Drive {
        Drive::Lines(vec![[0.0, force], [duration, force]])
    }

    /// The same in other units.
    pub fn scaled(&self, time: f64, force: f64) -> Drive {
        match self {
            Drive::Lines(points) => Drive::Lines(points.iter().map(|p| [p[0] * time, p[1] * force]).collect()),
            Drive::HalfSine { peak, duration } => Drive::HalfSine { peak: peak * force, duration: duration * time },
        }
    }

    /// `[largest |f|, total variation with the jumps from and to 0]` over all time.
    pub fn measures(&self) -> [f64; 2] {
        match self {
            Drive::HalfSine { peak, .. } => [peak.abs(), 2.0 * peak.abs()],
            Drive::Lines(points) => {
                let sup = points.iter().fold(0.0f64, |a, p| a.max(p[1].abs()));
                let steps: f64 = points.windows(2).map(|p| (p[1][1] - p[0][1]).abs()).sum();
                let ends = [points.first(), points.last()].into_iter().flatten().map(|p| p[1].abs()).sum::<f64>();
                [sup, steps + ends]
            }
        }
    }

    /// When it starts to differ from 0; infinite without a force.
    pub(crate) fn begins_at(&self) -> f64 {
        match self {
            Drive::HalfSine { .. } => 0.0,
            Drive::Lines(points) => match points.iter().position(|p| p[1] != 0.0) {
                None => f64::INFINITY,
                Some(first) => points[first.saturating_sub(1)][0],
            },
        }
    }

    /// When its magnitude is first the largest.
    pub(crate) fn peaks_at(&self) -> f64 {
        match self {
            Drive::HalfSine { duration, .. } => 0.5 * duration,
            Drive::Lines(points) => {
                let largest = points.iter().map(|p| p[1].abs()).fold(0.0, f64::max);
                points.iter().find(|p| p[1].abs() == largest).map_or(0.0, |p| p[0])
            }
        }
    }

    /// The force to which it jumps from 0 at its start, at t = 0.
    pub(crate) fn first_force(&self) -> f64 {
        match self {
            Drive::HalfSine { .. } => 0.0,
            Drive::Lines(points) => points.first().filter(|p| p[0] == 0.0).map_or(0.0, |p| p[1]),
        }
    }

    /// The force from which it drops to 0 at its end.
    pub(crate) fn last_force(&self) -> f64 {
        match self {
            Drive::HalfSine { .. } => 0.0,
            Drive::Lines(points) => points.last().map_or(0.0, |p| p[1]),
        }
    }

    /// The last instant at which it changes: its end, or where it becomes 0 for good before that. 0 without a force.
    pub(crate) fn last_change(&self) -> f64 {
        match self {
            Drive::HalfSine { duration, .. } => *duration,
            Drive::Lines(points) => match points.iter().rposition(|p| p[1] != 0.0) {
                None => 0.0,
                Some(last) => points.get(last + 1).unwrap_or(&points[last])[0],
            },
        }
    }

    /// Its value; at a jump, that after it.
    pub fn value(&self, t: f64) -> f64 {
        match self {
            Drive::HalfSine { peak, duration } if (0.0..*duration).contains(&t) => {
                peak * (std::f64::consts::PI * t / duration).sin()
            }
            Drive::HalfSine { .. } => 0.0,
            Drive::Lines(points) => {
                let on = |pair: &&[[f64; 2]]| pair[0][0] <= t && t < pair[1][0];
                let between = |pair: &[[f64; 2]]| {
                    let [[from, start], [to, end]] = [pair[0], pair[1]];
                    start + (end - start) / (to - from) * (t - from)
                };
                points.windows(2).find(on).map_or(0.0, between)
            }
        }
    }
}

#[cfg(test)]
mod tests;
