//! Events that end a step.

use super::mode::End;
use super::roots;
use super::run::Run;
use super::series::DEGREE;

/// Events whose times since the start of the step differ by less than this share are at one instant.
const TOGETHER: f64 = 4.0 * f64::EPSILON;

/// What ends a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EventKind {
    Mode(End),
    Breaks,
    Stops,
}

/// An event: its share of the step, its coupler or vehicle, its kind.
pub type Event = (f64, usize, EventKind);

/// The events that come first, all at one instant.
struct Earliest {
    share: f64,
    events: Vec<Event>,
}

impl Earliest {
    fn take(&mut self, share: f64, i: usize, what: EventKind) {
        if share > self.share * (1.0 + TOGETHER) {
            return;
        }
        if share < self.share * (1.0 - TOGETHER) {
            self.events.clear();
        }
        self.share = self.share.min(share);
        if !self.events.iter().any(|e| e.1 == i) {
            self.events.push((share, i, what));
        }
    }
}

impl Run<'_> {
    /// All events at the first instant of the step that has any; `breaks`: whether breaks count, false where [`super::certain`]
    /// finds them.
    pub fn first_events(&self, width: f64, breaks: bool) -> Vec<Event> {
        let mut first = Earliest { share: 1.0, events: Vec::new() };
        if breaks {
            self.breaks(width, &mut first);
        }
        self.ends_of_modes(&mut first);
        self.stops(&mut first);
        first.events
    }

    fn ends_of_modes(&self, first: &mut Earliest) {
        let (state, series, past) = (&self.state, &self.series, self.guard_margin);
        let mut c = [0.0; DEGREE + 1];
        let n = series.terms;
        for i in state.couplers() {
            let coupler = &self.couplers[i];
            let (q, rise, reach) = (state.elongation(i), series.q[1][i + 1], series.reach[i + 1]);
            if q + rise.max(0.0) + reach > coupler.upper + past {
                series.elongation_from(state, i, coupler.upper + past, 1.0, &mut c);
                if let Some(s) = roots::first_positive(&c[..=n]) {
                    first.take(s, i, EventKind::Mode(End::Upper));
                }
            }
            if q + rise.min(0.0) - reach < coupler.lower - past {
                series.elongation_from(state, i, coupler.lower - past, -1.0, &mut c);
                if let Some(s) = roots::first_positive(&c[..=n]) {
                    first.take(s, i, EventKind::Mode(End::Lower));
                }
            }
            if coupler.turn != 0.0 && -coupler.turn * rise + series.reach_of_speed[i + 1] > 0.0 {
                series.rate_of(i, -coupler.turn, &mut c);
                if let Some(s) = roots::first_positive(&c[..n]) {
                    first.take(s, i, EventKind::Mode(End::Turn));
                }
            }
        }
    }

    /// Couplers that pass the force at which they break, where no bound is proven.
    fn breaks(&self, width: f64, first: &mut Earliest) {
        let mut c = [0.0; DEGREE + 1];
        let n = self.series.terms;
        let whole = |i: &usize| !self.couplers[*i].parted;
        for i in self.state.couplers().filter(|i| whole(i) && *i < self.problem.break_at_n.len()) {
            self.series.tension_of(&self.state, i, width, &mut c);
            let total = c[0] + self.start[i][1];
            for (sense, limit) in self.problem.break_at_n[i].iter().enumerate() {
                let sign = if sense == 0 { 1.0 } else { -1.0 };
                let mut over = c.map(|c| sign * c);
                over[0] = sign * total - limit;
                if limit.is_finite()
                    && let Some(s) = roots::first_positive(&over[..=n])
                {
                    first.take(s, i, EventKind::Breaks);
                }
            }
        }
    }

    /// Braked vehicles that come to a stand.
    fn stops(&self, first: &mut Earliest) {
        let Some(common) = self.problem.common_speed_m_s else { return };
        let sign = self.problem.direction();
        let [from, to] = self.state.moving;
        for v in (from..to).filter(|&v| self.forces.brakes(v, self.t)) {
            let n = self.series.terms;
            let mut c = [0.0; DEGREE + 1];
            for (c, row) in c.iter_mut().zip(&self.series.v).take(n + 1) {
                *c = -sign * row[v];
            }
            c[0] -= sign * (common + self.common_m_s2 * self.t);
            c[1] -= sign * self.common_m_s2 * self.width;
            if let Some(s) = roots::first_positive(&c[..=n]) {
                first.take(s, v, EventKind::Stops);
            }
        }
    }
}
