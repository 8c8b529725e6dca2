//! The safe factor on the speed of an impact under forces that go on acting.
//!
//! ```text
//! F_i(t) = R_i(t) + factor V_i(t)        R: from speeds 0, under the forces on the vehicles        V: from the speeds alone
//! ```
//!
//! Where the two parts had one acceleration, R_i(t) is the load before the impact and [`super::safe_factor`] has the
//! factor from the peaks. Else R changes with time, and peaks at one factor do not give another's: the motion is
//! computed at several. The largest excess over a rating, of all couplers and instants, is a maximum of straight lines
//! in the factor, so convex: it has one root above a factor that is safe, and a chord through two safe factors meets 0
//! at a factor that is not.

use crate::march::{self, MarchOptions, Problem};

/// Factors that are computed: at most, and usually.
const MOST_FACTORS: usize = 60;
pub(super) const USUAL_FACTORS: f64 = 14.0;
/// Relative error of the factor, at most.
const RELATIVE_ERROR: f64 = 1e-10;

/// The largest factor on the speeds at which no coupler exceeds; 0 where one does without any speed.
pub(super) fn find(problem: &Problem, ratings_n: &[[f64; 2]]) -> f64 {
    let ask = MarchOptions { capacity_n: ratings_n.to_vec(), ..MarchOptions::default() };
    let excess = |factor: f64| {
        let speed_m_s = problem.speed_m_s.iter().map(|v| factor * v).collect();
        let largest = march::solve(&Problem { speed_m_s, ..problem.clone() }, &ask).extremes;
        let over = largest
            .iter()
            .zip(ratings_n)
            .flat_map(|(e, [draft, buff])| [e.draft.force_n / draft - 1.0, -e.buff.force_n / buff - 1.0]);
        over.fold(f64::NEG_INFINITY, f64::max)
    };
    let (mut low, mut high) = ((0.0, excess(0.0)), (1.0, excess(1.0)));
    if low.1 > 0.0 {
        return 0.0;
    }
    let chord = |a: (f64, f64), b: (f64, f64)| a.0 - a.1 * (b.0 - a.0) / (b.1 - a.1);
    let mut tried = 2;
    while high.1 <= 0.0 && tried < MOST_FACTORS {
        let next = if high.1 > low.1 { chord(low, high) * (1.0 + RELATIVE_ERROR) } else { 2.0 * high.0 };
        (low, high) = (high, (next, excess(next)));
        tried += 1;
    }
    // Regula falsi, with half the weight of an end that stays (Illinois).
    let (mut weight, mut stayed) = ([low.1, high.1], 0);
    while high.0 - low.0 > RELATIVE_ERROR * high.0 && tried < MOST_FACTORS {
        let at = chord((low.0, weight[0]), (high.0, weight[1])).clamp(low.0, high.0);
        let found = excess(at);
        tried += 1;
        if found <= 0.0 {
            weight[1] *= if stayed == 1 { 0.5 } else { 1.0 };
            (low, weight[0], stayed) = ((at, found), found, 1);
        } else {
            weight[0] *= if stayed == -1 { 0.5 } else { 1.0 };
            (high, weight[1], stayed) = ((at, found), found, -1);
        }
    }
    low.0
}
