//! The gaps that couplers leave where they part and a bound is proven.
//!
//! ```text
//! q: distance of the vehicles beyond that of the unloaded coupler, a gap where it has parted, closed where q < 0
//! ```
//!
//! Where the vehicles of a parted coupler do not push each other ([`super::Problem::contact`]) the motion is not the train's once a gap
//! closes; the first that certainly closes is reported.
//!
//! If a single coupler breaks in steady motion under the draft F_b, and no other force changes, its gap never closes, whatever the
//! masses, springs and dampers: relative to the steady motion the only force on the front part is the constant F_b on its last
//! vehicle. With x the displacement of that vehicle, the force has done the work F_b x(t), which the part has stored or dissipated,
//! so that F_b x(t) >= 0 at every instant; likewise for the rear part, with -F_b on its first vehicle. The two vehicles are
//! therefore never nearer than at the break. So a gap can close only where a coupler breaks in buff (q < 0 from the start), where
//! several couplers break, or under other forces.

use super::run::{Run, stiffest};
use super::series::DEGREE;
use crate::solve::local::{Local, reach};

impl Run<'_> {
    /// Of couplers that part now, each with the error of its elongation, m, notes the first whose gap is certainly closed.
    pub fn note_closed(&mut self, gaps: impl IntoIterator<Item = (usize, f64)>) {
        if !self.closures.is_empty() {
            return;
        }
        let closed = |&(i, error): &(usize, f64)| self.start[i][0] + self.state.elongation(i) < -error;
        let first = gaps.into_iter().find(closed).map(|(i, _)| (i, self.t));
        self.closures.extend(first);
    }

    /// Follows the gaps over the step as cut, with the bound on the norm of the error up to the horizon; notes the first that certainly
    /// closes.
    pub fn follow_gaps(&mut self, norm: f64, width: f64) {
        if !self.closures.is_empty() {
            return;
        }
        let horizon = self.problem.horizon_s;
        let mut c = [0.0; DEGREE + 1];
        let mut first: Option<(usize, f64)> = None;
        for i in self.partings.iter().map(|p| p.coupler) {
            let error =
                norm * (1.0 / stiffest(&self.problem.laws[i]).sqrt() + 2.0 * horizon * self.root_inverse_mass(i));
            self.series.elongation_from(&self.state, i, -self.start[i][0], -1.0, &mut c);
            let c = &c[..=self.series.terms];
            if self.state.couplers().contains(&i) && reach(c, 1.0) > error {
                let at = Local::of_step(c, self.t, width).first_over(-1.0, 1.0, error);
                let at = at.map(|x| (i, self.t + 0.5 * (x + 1.0) * width));
                first = first.into_iter().chain(at).reduce(|a, b| if b.1 < a.1 { b } else { a });
            }
        }
        self.closures.extend(first);
    }
}
