//! The march itself: from event to event.

use super::breaks::Breaks;
use super::energy::Audit;
use super::events::{Event, terms, unbalanced};
use super::forces::Forces;
use super::mode::{Coupler, End};
use super::proof::Proof;
use super::record::{Record, Taken};
use super::series::{Series, State};
use super::{MarchOptions, Parting, Problem};
use crate::law::Law;

/// An event counts only once the elongation is past its guard by this share of the train's longest scale: about 1e-15
/// m where elongations are some 40 mm. The law is continuous, so this changes a force by at most that distance times
/// kl.
const GUARD_MARGIN: f64 = 2.5e-14;
/// At the edge of the part that moves, motion under this share of the scale is 0.
const REST_LIMIT: f64 = 1e-24;
/// Steps shorter than this share of the reciprocal of the largest rate take no time.
const NO_TIME: f64 = 1e-10;
/// After so many events in a row that take no time, for each coupler, rounding decides between two modes: the margin
/// past guards is then doubled.
const STALLED: usize = 64;
/// A step is tried with at most so many times the mean width of the last ones.
const MAX_WIDENING: f64 = 2.5;

/// Settings of a run: runs of one problem with other settings give its error.
#[derive(Clone, Copy, Debug)]
pub struct RunSettings {
    /// Largest step times the largest rate.
    pub phase: f64,
    /// Seed and size of noise on every elongation and speed at every step, in units of their rounding.
    pub noise: Option<(u64, f64)>,
    /// How many times [`GUARD_MARGIN`] an event needs past its guard.
    pub margin: f64,
}

pub struct March<'a> {
    pub problem: &'a Problem,
    pub settings: RunSettings,
    pub couplers: Vec<Coupler>,
    /// Elongation and force of each coupler at t = 0.
    pub start: Vec<[f64; 2]>,
    pub state: State,
    pub series: Series,
    pub forces: Forces,
    pub record: Record,
    pub partings: Vec<Parting>,
    pub closures: Vec<(usize, f64)>,
    pub stopped: Option<(usize, f64)>,
    pub audit: Option<Audit>,
    pub proof: Option<Proof>,
    /// Where the proof follows couplers that break.
    pub breaks: Option<Breaks>,
    pub t: f64,
    pub events: u64,
    pub steps: u64,
    /// Common acceleration that is subtracted.
    pub common_m_s2: f64,
    /// How far past its guard an event is.
    pub guard_margin: f64,
    /// Elongation and speed that count as 0 at the edge of what moves.
    pub rest_limits: [f64; 2],
    mean_width: f64,
    /// Events in a row that took no time.
    stalled_events: usize,
    /// Width of the step as tried.
    pub width: f64,
    pub random: u64,
}

/// What ends a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EventKind {
    Mode(End),
    Breaks,
    Stops,
}

impl<'a> March<'a> {
    pub fn new(problem: &'a Problem, ask: &MarchOptions, settings: RunSettings) -> March<'a> {
        let n = problem.mass_kg.len();
        let live = |v: usize| !(v == 0 && problem.held_head || v + 1 == n && problem.held_tail);
        let couplers: Vec<Coupler> = problem.laws.iter().zip(&problem.start).map(|(l, r)| Coupler::new(l, r)).collect();
        let start: Vec<[f64; 2]> = couplers.iter().map(|c| c.start).collect();
        let (unbalanced, common_m_s2) = unbalanced(problem, &start);
        let zeros = || vec![0.0; n + 1];
        let dashpot = &problem.dashpot_n_s_per_m;
        let dashpot =
            if dashpot.iter().all(|c| *c == 0.0) { Vec::new() } else { [&[0.0], &dashpot[..], &[0.0]].concat() };
        let state = State {
            q: [zeros(), zeros()],
            v: [problem.speed_m_s.clone(), vec![0.0; n]],
            place: zeros(),
            force: zeros(),
            slope: zeros(),
            dashpot,
            inverse_mass: (0..n).map(|v| if live(v) { 1.0 / problem.mass_kg[v] } else { 0.0 }).collect(),
            unbalanced,
            moving: [0, n],
        };
        let mut march = March {
            settings,
            couplers,
            start,
            state,
            series: Series::new(n),
            forces: Forces::of(problem),
            record: Record::new(ask),
            partings: Vec::new(),
            closures: Vec::new(),
            stopped: None,
            audit: None,
            proof: None,
            breaks: None,
            t: 0.0,
            events: 0,
            steps: 0,
            common_m_s2: common_m_s2 + problem.common_m_s2,
            guard_margin: 0.0,
            rest_limits: [0.0; 2],
            mean_width: f64::INFINITY,
            stalled_events: 0,
            width: 0.0,
            random: settings.noise.map_or(0, |n| n.0),
            problem,
        };
        (0..march.couplers.len()).for_each(|i| march.set_line(i));
        march.set_scales();
        march.audit = ask.audit.then(|| Audit::new(&march));
        for &i in &problem.gone {
            march.part(i, f64::INFINITY);
        }
        march.shrink();
        march
    }

    /// Sets the margin past guards and the limits of rest.
    fn set_scales(&mut self) {
        let softest = self.problem.laws.iter().map(stiffest).fold(f64::INFINITY, f64::min);
        let rate = self.fastest();
        let speed_difference = self.state.v[0].windows(2).map(|v| (v[0] - v[1]).abs()).fold(0.0, f64::max);
        let mut scale = if speed_difference > 0.0 && rate > 0.0 { speed_difference / rate } else { 0.0 };
        for (s, law) in self.start.iter().zip(&self.problem.laws) {
            scale = scale.max(s[0].abs()).max(0.5 * law.slack_m());
        }
        if softest > 0.0 && softest.is_finite() {
            let drive = |d: &(usize, crate::forcing::Drive)| d.1.measures()[0];
            let force = self.problem.forcing.iter().map(drive).chain(self.state.unbalanced.iter().map(|f| f.abs()));
            scale = scale.max(force.chain(self.problem.brakes_n()).fold(0.0, f64::max) / softest);
        }
        self.guard_margin = self.settings.margin * GUARD_MARGIN * scale;
        self.rest_limits = [REST_LIMIT * scale, REST_LIMIT * scale * rate];
    }

    /// The largest rate that the motion can have, every coupler at its stiffest, 1/s.
    pub fn fastest(&self) -> f64 {
        let laws = &self.problem.laws;
        let stiffness = |i: Option<usize>| i.and_then(|i| laws.get(i)).map_or(0.0, stiffest);
        let of = |(v, m): (usize, &f64)| m * (stiffness(v.checked_sub(1)) + stiffness(Some(v)));
        let damping = |(v, m): (usize, &f64)| {
            let c = &self.problem.dashpot_n_s_per_m;
            m * (v.checked_sub(1).and_then(|i| c.get(i)).unwrap_or(&0.0) + c.get(v).unwrap_or(&0.0))
        };
        let masses = || self.state.inverse_mass.iter().enumerate();
        (2.0 * masses().map(of).fold(0.0, f64::max)).sqrt() + 2.0 * masses().map(damping).fold(0.0, f64::max)
    }

    fn set_line(&mut self, i: usize) {
        let line = self.couplers[i].line;
        (self.state.place[i + 1], self.state.force[i + 1], self.state.slope[i + 1]) =
            (line.place, line.force, line.slope);
    }

    /// Coupler `i` parts now, or by so much earlier or later.
    pub fn part(&mut self, i: usize, uncertainty_s: f64) {
        let force_n = self.start[i][1] + self.state.tension(i);
        let q = self.state.elongation(i);
        let before_j = self.couplers[i].energy(q);
        self.couplers[i].part(Some(&self.problem.laws[i]).filter(|_| self.problem.contact), q);
        let energy_j = before_j - self.couplers[i].energy(q);
        if let Some(audit) = &mut self.audit {
            audit.release(energy_j);
        }
        if let Some(c) = self.state.dashpot.get_mut(i + 1) {
            *c = 0.0;
        }
        self.set_line(i);
        self.partings.push(Parting { coupler: i, time_s: self.t, force_n, energy_j, uncertainty_s });
        if let Some(emergency) = &self.problem.emergency {
            self.forces.apply_from_coupler(emergency, self.problem.direction(), i, self.t);
        }
    }

    /// Goes on to an instant, or to where the march ends.
    pub fn advance_to(&mut self, end: f64) {
        while self.t < end && self.stopped.is_none() {
            self.step(end);
        }
    }

    fn step(&mut self, end: f64) {
        self.forces.pass(self.t);
        self.grow();
        self.disturb();
        let kink = self.forces.next_kink(self.t).min(end);
        let rate = self.state.rate().max(self.forces.rate(self.t));
        let wanted = (self.settings.phase / rate).min(MAX_WIDENING * self.mean_width);
        let left = kink - self.t;
        // The last steps to a kink are equally wide.
        let mut width = if wanted >= left { left } else { left / (left / wanted).ceil() };
        self.series.terms = terms(rate * width);
        self.width = width;
        self.expand(width);
        let found: Vec<Event> = self.first_event(width);
        let broken = self.find_breaks();
        let mut next = if width == left { kink } else { self.t + width };
        if let Some(share) = found.iter().map(|e| e.0).chain(broken.as_ref().map(|b| b.share)).reduce(f64::min) {
            width *= share;
            next = self.t + width;
            self.series.cut(&self.state, share);
        }
        let taken = Taken {
            state: &self.state,
            series: &self.series,
            couplers: &self.couplers,
            contact: self.problem.contact,
            from: self.t,
            to: next,
            width,
        };
        self.record.add_step(&taken);
        self.follow_gaps(width);
        if let Some(audit) = &mut self.audit {
            audit.work(&self.state, &self.series, &self.start, width);
        }
        if let Some(mut proof) = self.proof.take() {
            proof.step(self, width);
            self.proof = Some(proof);
        }
        self.series.advance(&mut self.state);
        self.t = next;
        self.stalled_events = if width * rate > NO_TIME { 0 } else { self.stalled_events + found.len() };
        if self.stalled_events > STALLED * self.couplers.len() {
            self.guard_margin = (2.0 * self.guard_margin).max(self.rest_limits[0]);
            self.stalled_events = 0;
        }
        self.steps += 1;
        self.mean_width = if self.steps == 1 { width } else { 0.8 * self.mean_width + 0.2 * width }
            .max(1e-3 * self.settings.phase / rate);
        self.audit_step();
        for (_, i, what) in found {
            self.happens(i, what);
        }
        if let Some(broken) = broken {
            self.events += broken.couplers.len() as u64;
            self.break_now(&broken);
        }
        self.shrink();
    }

    fn audit_step(&mut self) {
        if let Some(mut audit) = self.audit.take() {
            audit.step(self);
            self.audit = Some(audit);
        }
    }

    fn happens(&mut self, i: usize, what: EventKind) {
        self.events += 1;
        match what {
            EventKind::Mode(end) => {
                let q = self.state.elongation(i);
                let coupler = &mut self.couplers[i];
                let open = coupler.is_open();
                coupler.switch(end, q);
                if open && !coupler.is_open() {
                    self.closures.push((i, self.t));
                }
                self.set_line(i);
            }
            EventKind::Breaks => self.part(i, f64::INFINITY),
            EventKind::Stops => self.stopped = Some((i, self.t)),
        }
    }

    fn expand(&mut self, width: f64) {
        let Series { outside, terms, .. } = &mut self.series;
        outside.iter_mut().for_each(Vec::clear);
        let from = self.state.moving[0];
        let [a, b] = self.state.moving;
        self.forces.expand(self.t, width, *terms, |v, k, f| {
            debug_assert!(f == 0.0 || (a..b).contains(&v), "a force acts on a vehicle at rest");
            if f != 0.0 && v >= from && v < b {
                outside[k].push((v, f));
            }
        });
        self.series.expand(&self.state, width);
    }
}

/// The largest slope of a law.
pub fn stiffest(law: &Law) -> f64 {
    match law {
        Law::Elastic { draft_n_per_m, buff_n_per_m, .. } => draft_n_per_m.max(*buff_n_per_m),
        Law::Gear { solid_n_per_m, .. } => *solid_n_per_m,
    }
}
