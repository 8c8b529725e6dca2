//! The march itself: from event to event.

use super::breaks::{Breaks, Found, Step};
use super::energy::Audit;
use super::events::{Event, EventKind};
use super::proof::Proof;
use super::record::{Record, Taken};
use super::run::{Run, RunSettings, stiffest};
use super::series::terms;
use super::{MarchOptions, Problem};

/// Steps shorter than this share of the reciprocal of the largest rate count as steps of no width.
const NO_TIME: f64 = 1e-10;
/// After this number times the number of couplers of events in a row in steps of no width, a coupler switches between two modes by
/// rounding alone: the margin past guards is then doubled.
const STALLED: usize = 64;
/// A step is tried with at most so many times the mean width of the last ones.
const MAX_WIDENING: f64 = 2.5;

/// A run with what is noted of it.
pub struct March<'a> {
    pub run: Run<'a>,
    pub record: Record,
    pub audit: Option<Audit>,
    pub proof: Option<Proof>,
    /// Only where the bound is proven across breaks; elsewhere breaks are events of the run.
    pub breaks: Option<Breaks>,
    pub events: u64,
    pub steps: u64,
    mean_width: f64,
    /// Events in a row that took no time.
    stalled_events: usize,
}

impl<'a> March<'a> {
    pub fn new(problem: &'a Problem, ask: &MarchOptions, settings: RunSettings) -> March<'a> {
        let run = Run::new(problem, settings);
        let mut march = March {
            record: Record::new(ask),
            audit: ask.audit.then(|| Audit::new(&run)),
            proof: None,
            breaks: None,
            events: 0,
            steps: 0,
            mean_width: f64::INFINITY,
            stalled_events: 0,
            run,
        };
        for &i in &problem.gone {
            march.part(i, f64::INFINITY);
        }
        march.run.shrink();
        march
    }

    /// Coupler `i` parts now, or by so much earlier or later.
    fn part(&mut self, i: usize, uncertainty_s: f64) {
        let energy_j = self.run.part(i, uncertainty_s);
        if let Some(audit) = &mut self.audit {
            audit.release(energy_j);
        }
    }

    /// Goes on to an instant, or to where the march ends.
    pub fn advance_to(&mut self, end: f64) {
        while self.run.t < end && self.run.stopped.is_none() {
            self.step(end);
        }
    }

    fn step(&mut self, end: f64) {
        self.run.forces.pass(self.run.t);
        self.run.grow();
        self.run.disturb();
        let rate = self.run.state.rate().max(self.run.forces.rate(self.run.t));
        let (mut width, mut next) = self.width_and_end(rate, end);
        self.run.series.terms = terms(rate * width);
        self.run.width = width;
        self.run.expand(width);
        let found: Vec<Event> = self.run.first_events(width, self.breaks.is_none());
        let broken = self.find_breaks();
        if let Some(share) = found.iter().map(|e| e.0).chain(broken.as_ref().map(|b| b.share)).reduce(f64::min) {
            width *= share;
            next = self.run.t + width;
            self.run.series.cut(&self.run.state, share);
        }
        let taken = Taken {
            state: &self.run.state,
            series: &self.run.series,
            couplers: &self.run.couplers,
            contact: self.run.problem.contact,
            from: self.run.t,
            to: next,
            width,
        };
        self.record.add_step(&taken);
        if let Some(proof) = self.proof.filter(|_| self.breaks.is_some()) {
            self.run.follow_gaps(proof.norm_to(self.run.problem.horizon_s), width);
        }
        if let Some(audit) = &mut self.audit {
            audit.work(&self.run.state, &self.run.series, &self.run.start, width);
        }
        if let Some(proof) = &mut self.proof {
            proof.step(&self.run, width);
        }
        self.run.series.advance(&mut self.run.state);
        self.run.t = next;
        self.stalled_events = if width * rate > NO_TIME { 0 } else { self.stalled_events + found.len() };
        if self.stalled_events > STALLED * self.run.couplers.len() {
            self.run.guard_margin = (2.0 * self.run.guard_margin).max(self.run.rest_limits[0]);
            self.stalled_events = 0;
        }
        self.count(width, rate);
        if let Some(audit) = &mut self.audit {
            audit.step(&self.run);
        }
        for (_, i, what) in found {
            self.apply_event(i, what);
        }
        if let Some(broken) = broken {
            self.events += broken.couplers.len() as u64;
            self.break_now(&broken);
        }
        self.run.shrink();
    }

    /// Width and end of the next step; `rate`: the largest of the motion and the forces, 1/s.
    fn width_and_end(&self, rate: f64, end: f64) -> (f64, f64) {
        let kink = self.run.forces.next_kink(self.run.t).min(end);
        let wanted = (self.run.settings.phase / rate).min(MAX_WIDENING * self.mean_width);
        let left = kink - self.run.t;
        if wanted >= left {
            return (left, kink);
        }
        // The last steps to a kink are equally wide.
        let width = left / (left / wanted).ceil();
        (width, if width == left { kink } else { self.run.t + width })
    }

    /// Counts a step, and takes its width into the mean.
    fn count(&mut self, width: f64, rate: f64) {
        self.steps += 1;
        let mean = if self.steps == 1 { width } else { 0.8 * self.mean_width + 0.2 * width };
        self.mean_width = mean.max(1e-3 * self.run.settings.phase / rate);
    }

    fn apply_event(&mut self, i: usize, what: EventKind) {
        self.events += 1;
        match what {
            EventKind::Mode(end) => {
                let q = self.run.state.elongation(i);
                let coupler = &mut self.run.couplers[i];
                let open = coupler.is_open();
                coupler.switch(end, q);
                if open && !coupler.is_open() {
                    self.run.closures.push((i, self.run.t));
                }
                self.run.set_line(i);
            }
            EventKind::Breaks => self.part(i, f64::INFINITY),
            EventKind::Stops => self.run.stopped = Some((i, self.run.t)),
        }
    }

    /// Sets up the proof of the error bound, if the problem has one, and the search for breaks that goes with it; couplers whose load
    /// at t = 0 is over their limit part at once.
    pub fn start_proof(&mut self) {
        let Some(mut proof) = Proof::new(&mut self.run) else { return };
        if !self.run.problem.break_at_n.is_empty() {
            let over = |i: &usize| {
                let load_n = self.run.start[*i][1];
                !self.run.couplers[*i].parted && (load_n > self.run.limit_n(*i, 0) || -load_n > self.run.limit_n(*i, 1))
            };
            let broken: Vec<_> =
                (0..self.run.couplers.len()).filter(over).map(|i| (i, self.run.start[i][1], 0.0)).collect();
            broken.iter().for_each(|(i, ..)| self.part(*i, 0.0));
            proof.measure(&mut self.run);
            self.breaks = Some(Breaks::new(&self.run, proof.bound_n(&self.run)));
        }
        self.proof = Some(proof);
        if self.breaks.is_some() {
            let gaps: Vec<(usize, f64)> = self.run.partings.iter().map(|p| (p.coupler, 0.0)).collect();
            self.run.note_closed(gaps);
        }
    }

    /// What certainly breaks in the step as tried.
    fn find_breaks(&mut self) -> Option<Found> {
        let breaks = self.breaks.as_mut()?;
        let bound = self.proof.map_or(0.0, |proof| proof.bound_n(&self.run));
        breaks.find(&Step { run: &self.run, bound })
    }

    /// Couplers break now.
    fn break_now(&mut self, found: &Found) {
        let Some((mut proof, mut breaks)) = self.proof.take().zip(self.breaks.take()) else { return };
        proof.add_error_of_breaks(&self.run, &found.couplers);
        let error = proof.norm_to(self.run.problem.horizon_s);
        found.couplers.iter().for_each(|&(i, _, apart)| self.part(i, apart));
        proof.measure(&mut self.run);
        breaks.note(&found.couplers, self.run.t);
        (self.proof, self.breaks) = (Some(proof), Some(breaks));
        let laws = &self.run.problem.laws;
        self.run.note_closed(found.couplers.iter().map(|&(i, ..)| (i, error / stiffest(&laws[i]).sqrt())));
    }
}
