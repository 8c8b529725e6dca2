//! Results of a march: extremes, first instants above capacities, forces at chosen instants.

use super::mode::Coupler;
use super::series::{DEGREE, Series, State};
use super::{Extremes, MarchOptions, Peak, roots};
use crate::solve::dd::Dd;
use crate::solve::local::{Local, reach};
use crate::solve::watch::Watch;

#[derive(Clone, Debug)]
pub struct Record {
    /// Extremes and first instants above capacities; `None`: not looked for.
    pub watch: Option<Watch>,
    to_mark: Option<Watch>,
    pub history: Vec<Vec<f64>>,
    pub watched: Watched,
    wanted: Vec<usize>,
    times: Vec<f64>,
    next: usize,
}

/// Elongation, from the middle of the slack, and force of one coupler at instants of its own.
#[derive(Clone, Debug, Default)]
pub struct Watched {
    pub values: Vec<[f64; 2]>,
    coupler: usize,
    times: Vec<f64>,
}

/// A step that has been taken: the series are cut to it, the state is that at its beginning.
pub struct Taken<'a> {
    pub state: &'a State,
    pub series: &'a Series,
    pub couplers: &'a [Coupler],
    /// Whether a parted coupler can carry a force.
    pub contact: bool,
    pub from: f64,
    /// The end, as the march goes on from it: not quite `from + width`, which is rounded.
    pub to: f64,
    pub width: f64,
}

impl Taken<'_> {
    /// Tension and elongation of a coupler at an instant of the step, less those at t = 0.
    fn tension(&self, i: usize, t: f64) -> f64 {
        self.value(i, t, 0.0, |c| self.series.tension_of(self.state, i, self.width, c))
    }

    fn elongation(&self, i: usize, t: f64) -> f64 {
        self.value(i, t, self.state.elongation(i), |c| self.series.elongation_from(self.state, i, 0.0, 1.0, c))
    }

    /// `at_rest` for a coupler that no wave has reached.
    fn value(&self, i: usize, t: f64, at_rest: f64, series: impl Fn(&mut [f64; DEGREE + 1])) -> f64 {
        if !self.state.couplers().contains(&i) {
            return at_rest;
        }
        let mut c = [0.0; DEGREE + 1];
        series(&mut c);
        roots::at(&c[..=self.series.terms], (t - self.from) / self.width.max(f64::MIN_POSITIVE))
    }

    /// Upper bounds, quick to compute, on the force F of a coupler and on -F over the step.
    fn reaches(&self, i: usize) -> [f64; 2] {
        let Taken { state, series, width, .. } = *self;
        let x = i + 1;
        let (slope, rise) = (state.slope[x], series.q[1][x]);
        let now =
            self.couplers[i].start[1] + state.force[x] + slope * ((series.q[0][x] - state.place[x]) + state.q[1][x]);
        // The change of force: by the law's line, and then by the dashpot.
        let mut reach = slope * series.reach[x];
        let mut first = slope * rise;
        if !state.dashpot.is_empty() {
            let share = state.dashpot[x] / width;
            first += share * rise;
            reach += share * (series.reach_of_speed[x] + rise.abs());
        }
        [now + first.max(0.0) + reach, -now + (-first).max(0.0) + reach]
    }
}

impl Record {
    /// Of the couplers and instants asked for; without a watch of the extremes.
    pub fn new(ask: &MarchOptions) -> Record {
        Record {
            watch: None,
            to_mark: None,
            history: vec![Vec::new(); ask.history.len()],
            watched: ask.watched.clone().map_or_else(Watched::default, |(coupler, times)| Watched {
                values: Vec::with_capacity(times.len()),
                coupler,
                times,
            }),
            wanted: ask.history.clone(),
            times: ask.times_s.clone(),
            next: 0,
        }
    }

    /// Adds a step.
    pub fn add_step(&mut self, taken: &Taken) {
        if taken.width > 0.0
            && let Some(watch) = &mut self.watch
        {
            for i in taken.state.couplers().filter(|&i| taken.contact || !taken.couplers[i].parted) {
                look_for_peaks(watch, taken, i);
            }
        }
        self.sample(taken);
    }

    /// Forces and elongations at the chosen instants in the step.
    fn sample(&mut self, taken: &Taken) {
        while let Some(t) = self.times.get(self.next).copied().filter(|t| *t <= taken.to) {
            for (forces, &i) in self.history.iter_mut().zip(&self.wanted) {
                forces.push(taken.couplers[i].start[1] + taken.tension(i, t));
            }
            self.next += 1;
        }
        let Watched { values, coupler, times } = &mut self.watched;
        while let Some(t) = times.get(values.len()).copied().filter(|t| *t <= taken.to) {
            let [elongation, force] = taken.couplers[*coupler].start;
            values.push([elongation + taken.elongation(*coupler, t), force + taken.tension(*coupler, t)]);
        }
    }

    /// Gives the histories so far to `see`, by instant and place in the list of those asked for, and forgets them.
    pub fn drain(&mut self, see: &mut dyn FnMut(usize, usize, f64)) {
        for (k, forces) in self.history.iter_mut().enumerate() {
            let first = self.next - forces.len();
            forces.drain(..).enumerate().for_each(|(n, force)| see(first + n, k, force));
        }
    }

    /// Keeps what was seen so far as that up to the mark, and goes on to the horizon.
    pub fn mark(&mut self, horizon_s: f64) {
        self.to_mark = self.watch.clone();
        self.watch = self.watch.take().map(|watch| watch.until(horizon_s));
    }

    /// Removes what is later than an instant; `watch` is what was seen up to it.
    pub fn rewind(&mut self, until: f64, watch: Option<Watch>) {
        self.watch = watch;
        let known = self.times.iter().take_while(|t| **t <= until).count();
        self.history.iter_mut().for_each(|h| h.truncate(known));
        self.watched.values.truncate(self.watched.times.iter().take_while(|t| **t <= until).count());
    }

    /// Decides the sides that stood at their ratings to the end, and fills unknown values with NaN; returns the watches up to the
    /// mark and up to the end.
    pub fn finish(&mut self) -> [Option<Watch>; 2] {
        self.history.iter_mut().for_each(|h| h.resize(self.times.len(), f64::NAN));
        self.watched.values.resize(self.watched.times.len(), [f64::NAN; 2]);
        let decided = |mut watch: Watch| {
            watch.decide_all_at_rating();
            watch
        };
        let whole = self.watch.take().map(decided);
        [self.to_mark.take().map(decided).or_else(|| whole.clone()), whole]
    }
}

/// Looks for new extremes and crossings of one coupler in a step.
fn look_for_peaks(watch: &mut Watch, taken: &Taken, i: usize) {
    let reaches = taken.reaches(i);
    let open = [false, true].map(|negative| reaches[usize::from(negative)] > watch.level(i, negative));
    let at_rating = [false, true].map(|negative| watch.at_rating(i, negative));
    if open == [false; 2] && at_rating == [false; 2] {
        return;
    }
    let mut c = [0.0; DEGREE + 1];
    taken.series.tension_of(taken.state, i, taken.width, &mut c);
    let c = &mut c[..=taken.series.terms];
    let start_n = taken.couplers[i].start[1];
    let push: f64 = c.iter().rev().sum();
    c[0] += start_n;
    let bend: f64 = c.iter().enumerate().skip(2).map(|(k, c)| k as f64 * c.abs()).sum();
    for side in [0, 1] {
        let negative = side == 1;
        let sign = if negative { -1.0 } else { 1.0 };
        if at_rating[side] {
            watch.note_push(i, negative, sign * push, sign * (start_n + push));
        }
        if open[side] && c[1].abs() > bend {
            note_monotonic(watch, taken, (i, negative), c);
        } else if open[side] && reach(c, sign) > watch.level(i, negative) {
            note(watch, taken, (i, negative), c);
        }
        if at_rating[side] {
            watch.note_left_rating(i, negative, sign * (start_n + push));
        }
    }
}

/// A force that rises or falls all through a step is largest at an end of it.
fn note_monotonic(watch: &mut Watch, taken: &Taken, (i, negative): (usize, bool), c: &[f64]) {
    let sign = if negative { -1.0 } else { 1.0 };
    let (at, value) = if sign * c[1] > 0.0 { (taken.to, sign * roots::at(c, 1.0)) } else { (taken.from, sign * c[0]) };
    let is_over = watch.peaks[i].side(negative).first_over.is_some();
    if value <= watch.level(i, negative) {
        return;
    }
    if is_over || value < watch.cautious_rating(i, negative) {
        watch.note_value(i, negative, at.min(watch.horizon()), value);
    } else {
        note(watch, taken, (i, negative), c);
    }
}

fn note(watch: &mut Watch, taken: &Taken, (i, negative): (usize, bool), c: &[f64]) {
    let local = Local::of_step(c, taken.from, taken.width);
    let exact = |t: Dd| roots::at(c, (t - Dd::from(taken.from)).to_f64() / taken.width);
    watch.note(i, negative, &local, 1.0, exact);
}

/// The extremes that a watch has seen.
pub fn extremes(watch: &Watch) -> Vec<Extremes> {
    let of = |peaks: &crate::solve::watch::SpringPeaks| Extremes {
        draft: Peak { force_n: peaks.draft.best.value, time_s: peaks.draft.best.at },
        buff: Peak { force_n: -peaks.buff.best.value, time_s: peaks.buff.best.at },
    };
    watch.peaks.iter().map(of).collect()
}
