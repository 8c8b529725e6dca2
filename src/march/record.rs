//! Results of a march: extremes, first instants above capacities, forces at chosen instants.

use super::series::{DEGREE, Series, State};
use super::{Extremes, MarchOptions, Peak, roots};

#[derive(Clone, Debug)]
pub struct Record {
    pub extremes: Vec<Extremes>,
    pub to_mark: Option<Vec<Extremes>>,
    pub first_over_s: Vec<[Option<f64>; 2]>,
    pub history: Vec<Vec<f64>>,
    pub watched: Watched,
    capacity: Vec<[f64; 2]>,
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
    pub from: f64,
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
}

impl Record {
    /// With the forces before t = 0.
    pub fn new(start: &[f64], ask: &MarchOptions) -> Record {
        let at_start = |f: &f64| {
            let peak = Peak { force_n: *f, time_s: 0.0 };
            Extremes { draft: peak, buff: peak }
        };
        let capacity =
            if ask.capacity_n.is_empty() { vec![[f64::INFINITY; 2]; start.len()] } else { ask.capacity_n.clone() };
        let over = |(f, c): (&f64, &[f64; 2])| [(*f > c[0]).then_some(0.0), (-f > c[1]).then_some(0.0)];
        Record {
            extremes: start.iter().map(at_start).collect(),
            to_mark: None,
            first_over_s: start.iter().zip(&capacity).map(over).collect(),
            history: vec![Vec::with_capacity(ask.times_s.len()); ask.history.len()],
            watched: ask.watched.clone().map_or_else(Watched::default, |(coupler, times)| Watched {
                values: Vec::with_capacity(times.len()),
                coupler,
                times,
            }),
            capacity,
            wanted: ask.history.clone(),
            times: ask.times_s.clone(),
            next: 0,
        }
    }

    /// Coupler `i` parts at t = 0, and begins with the force that is left.
    pub fn restart_parted(&mut self, i: usize, force_n: f64) {
        let peak = Peak { force_n, time_s: 0.0 };
        self.extremes[i] = Extremes { draft: peak, buff: peak };
        let [draft, buff] = self.capacity[i];
        self.first_over_s[i] = [(force_n > draft).then_some(0.0), (-force_n > buff).then_some(0.0)];
    }

    /// Adds a step; `start`: elongations and forces at t = 0.
    pub fn add_step(&mut self, taken: &Taken, start: &[[f64; 2]]) {
        let Taken { state, series, from, width } = *taken;
        let mut c = [0.0; DEGREE + 1];
        for i in state.couplers() {
            let x = i + 1;
            let (slope, rise) = (state.slope[x], series.q[1][x]);
            let now = start[i][1] + state.force[x] + slope * ((series.q[0][x] - state.place[x]) + state.q[1][x]);
            // Bounds the change of force: by the law's line, and then by the dashpot.
            let mut reach = slope * series.reach[x];
            let mut first = slope * rise;
            if !state.dashpot.is_empty() && width > 0.0 {
                let share = state.dashpot[x] / width;
                first += share * rise;
                reach += share * (series.reach_of_speed[x] + rise.abs());
            }
            let best = &self.extremes[i];
            let over = self.first_over_s[i];
            let level =
                |best: f64, over: Option<f64>, capacity: f64| if over.is_none() { best.min(capacity) } else { best };
            let draft = now + first.max(0.0) + reach > level(best.draft.force_n, over[0], self.capacity[i][0]);
            let buff = -now + (-first).max(0.0) + reach > level(-best.buff.force_n, over[1], self.capacity[i][1]);
            if draft || buff {
                series.tension_of(state, i, width, &mut c);
                c[0] += start[i][1];
                self.update_peaks(i, &mut c[..=series.terms], from, width, [draft, buff]);
            }
        }
        self.sample(taken, start);
    }

    /// Looks for new extremes and crossings of one coupler.
    fn update_peaks(&mut self, i: usize, c: &mut [f64], from: f64, width: f64, senses: [bool; 2]) {
        for (sense, wanted) in senses.into_iter().enumerate() {
            if wanted {
                let best = if sense == 0 { self.extremes[i].draft.force_n } else { -self.extremes[i].buff.force_n };
                if let Some((s, force)) = largest(c, best) {
                    let peak = Peak { force_n: if sense == 0 { force } else { -force }, time_s: from + s * width };
                    if sense == 0 { self.extremes[i].draft = peak } else { self.extremes[i].buff = peak }
                }
                let capacity = self.capacity[i][sense];
                if capacity.is_finite() && self.first_over_s[i][sense].is_none() {
                    c[0] -= capacity;
                    self.first_over_s[i][sense] = roots::first_positive(c).map(|s| from + s * width);
                    c[0] += capacity;
                }
            }
            c.iter_mut().for_each(|c| *c = -*c);
        }
    }

    /// Forces and elongations at the chosen instants in the step.
    fn sample(&mut self, taken: &Taken, start: &[[f64; 2]]) {
        let until = taken.from + taken.width;
        while let Some(t) = self.times.get(self.next).copied().filter(|t| *t <= until) {
            for (forces, &i) in self.history.iter_mut().zip(&self.wanted) {
                forces.push(start[i][1] + taken.tension(i, t));
            }
            self.next += 1;
        }
        let Watched { values, coupler, times } = &mut self.watched;
        while let Some(t) = times.get(values.len()).copied().filter(|t| *t <= until) {
            let [elongation, force] = start[*coupler];
            values.push([elongation + taken.elongation(*coupler, t), force + taken.tension(*coupler, t)]);
        }
    }

    /// Keeps the extremes so far as those up to the mark.
    pub fn mark(&mut self) {
        self.to_mark = Some(self.extremes.clone());
    }

    /// Removes what is later than an instant; `extremes` and `over` are those up to it.
    pub fn rewind(&mut self, until: f64, extremes: Vec<Extremes>, over: Vec<[Option<f64>; 2]>) {
        (self.extremes, self.first_over_s) = (extremes, over);
        let known = self.times.iter().take_while(|t| **t <= until).count();
        self.history.iter_mut().for_each(|h| h.truncate(known));
        self.watched.values.truncate(self.watched.times.iter().take_while(|t| **t <= until).count());
    }

    /// Fills unknown values with NaN; peaks under `none(coupler)`, which an event can leave, become 0.
    pub fn finish(&mut self, none: impl Fn(usize) -> f64) {
        for (i, e) in self.extremes.iter_mut().enumerate().chain(self.to_mark.iter_mut().flatten().enumerate()) {
            for peak in [&mut e.draft, &mut e.buff].into_iter().filter(|p| p.force_n.abs() <= none(i)) {
                peak.force_n = 0.0;
            }
        }
        self.history.iter_mut().for_each(|h| h.resize(self.times.len(), f64::NAN));
        self.watched.values.resize(self.watched.times.len(), [f64::NAN; 2]);
        if self.to_mark.is_none() {
            self.to_mark = Some(self.extremes.clone());
        }
    }
}

/// Where in 0..=1 the polynomial is largest, and its value, if above `best`.
fn largest(c: &[f64], best: f64) -> Option<(f64, f64)> {
    let mut found: Option<(f64, f64)> = None;
    let mut take = |s: f64| {
        let value = roots::at(c, s);
        if value > found.map_or(best, |f| f.1) {
            found = Some((s, value));
        }
    };
    take(0.0);
    take(1.0);
    // At a maximum inside, the slope turns from positive to negative: all are tried, from left to right.
    let mut slope = [0.0; DEGREE + 1];
    let n = c.len();
    let bend: f64 = c.iter().enumerate().skip(2).map(|(k, c)| k as f64 * c.abs()).sum();
    if c.get(1).is_none_or(|c| c.abs() > bend) {
        return found;
    }
    let (mut at, mut falling) = (0.0, false);
    for _ in 0..n {
        for (k, s) in slope[..n - 1].iter_mut().enumerate() {
            *s = (k + 1) as f64 * c[k + 1];
        }
        if at == 0.0 {
            falling = slope[0] < 0.0;
        } else {
            roots::restrict_to(&mut slope[..n - 1], at, 1.0);
            slope[0] = 0.0;
        }
        // Looks for the next instant at which the slope has the other sign.
        let sign = if falling { 1.0 } else { -1.0 };
        slope[..n - 1].iter_mut().for_each(|s| *s *= sign);
        let Some(s) = roots::first_positive(&slope[..n - 1]) else { break };
        at += s * (1.0 - at);
        if !falling {
            take(at);
        }
        falling = !falling;
        if at >= 1.0 {
            break;
        }
    }
    found
}
