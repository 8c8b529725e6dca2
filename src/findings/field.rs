//! Force in every coupler over time: what a picture of the wave shows.

use std::collections::HashMap;

use super::CaseFindings;
use crate::march::{self, MarchOptions, MarchOutcome, Problem};
use crate::rod::Rod;
use crate::scenario::{self, Motion, Scales};
use crate::solve::field;
use crate::train::{Rule, Scenario, Train};

/// Most values kept: a picture cannot show more, and they would slow down a page.
const MOST_VALUES: usize = 400_000;
/// Most rows of a picture: several couplers share one.
const ROWS: usize = 2000;
/// Most instants kept.
const MOST_KEPT: usize = 1600;
/// Most values computed.
const MOST_COMPUTED: f64 = 1e8;
/// Seconds that the march of linear couplers may take for a picture.
const MOST_SECONDS: f64 = 2.0;
/// The most instants, for their memory.
const MOST_INSTANTS: f64 = 4e6;
/// Instants per unit of time sqrt(m / k): about eight in the period of the fastest vibration of equal vehicles; and the fewest
/// that make a picture.
const PER_UNIT: f64 = 2.5;
const SPARSEST: f64 = 0.4;
/// Fewest instants of a picture.
const FEWEST: f64 = 400.0;

/// Which forces are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Of {
    /// Those of the couplers after the event alone.
    Event,
    /// Those of the couplers when they break one after the other.
    Cascade,
    /// Those of the elastic rod at the couplers' places.
    Rod,
}

/// Forces by place and time.
#[derive(Clone, Debug)]
pub struct Field {
    /// Neighbouring couplers that share a row; of them, and of the instants that share a column, the largest utilisation is kept.
    pub couplers_per_row: usize,
    /// Instants that share a column; 1 if each has its own.
    pub instants_per_column: usize,
    /// Middle of each column, s after the event.
    pub times_s: Vec<f64>,
    /// Utilisation with the force's sign (draft positive), by rows from the head; no number where there is no coupler.
    pub share: Vec<f32>,
    /// Of each row, whether all its couplers have slack; empty where the slack of couplers means nothing.
    pub slack: Vec<bool>,
}

impl Field {
    /// A row's utilisations.
    pub fn row(&self, row: usize) -> &[f32] {
        &self.share[row * self.times_s.len()..(row + 1) * self.times_s.len()]
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.share.len() / self.times_s.len()
    }

    /// Whether couplers of these rows with this utilisation are open: their force is zero while they pass their slack.
    pub fn is_open(&self, mut rows: impl Iterator<Item = usize>, share: f32) -> bool {
        share == 0.0 && rows.all(|row| self.slack.get(row) == Some(&true))
    }

    /// Whether any coupler is open at any time.
    pub fn opens(&self) -> bool {
        (0..self.rows()).any(|row| self.row(row).iter().any(|share| self.is_open(row..=row, *share)))
    }

    /// The largest utilisation.
    pub fn largest(&self) -> f32 {
        self.share.iter().fold(0.0, |m: f32, s| m.max(s.abs()))
    }

    /// Whether there is something to see: in half a percent of the picture the force differs visibly from that at t = 0.
    pub fn moves(&self) -> bool {
        let visible = 0.01 * self.largest();
        let moved = |r: usize| {
            let row = self.row(r);
            row.iter().filter(|s| (**s - row[0]).abs() > visible).count()
        };
        (0..self.rows()).map(moved).sum::<usize>() > self.share.len() / 200
    }

    /// The same with `by` columns in one.
    pub fn folded(&self, by: usize) -> Field {
        let by = by.max(1);
        let times_s: Vec<f64> = self.times_s.chunks(by).map(middle).collect();
        let fold = |of: &[f32]| of.iter().copied().fold(f32::NAN, larger);
        let share = (0..self.rows()).flat_map(|r| self.row(r).chunks(by).map(fold)).collect();
        Field { times_s, share, slack: self.slack.clone(), instants_per_column: self.instants_per_column * by, ..*self }
    }

    fn keep(&mut self, row: usize, column: usize, share: f32) {
        let kept = &mut self.share[row * self.times_s.len() + column];
        *kept = larger(*kept, share);
    }

    fn column(&self, time_s: f64) -> Option<usize> {
        let width = self.times_s.get(1)? - self.times_s[0];
        let column = ((time_s - self.times_s[0]) / width).round().max(0.0) as usize;
        (time_s <= self.times_s[self.times_s.len() - 1] + width).then(|| column.min(self.times_s.len() - 1))
    }
}

/// The utilisation of larger magnitude; NaN is ignored.
pub(crate) fn larger(a: f32, b: f32) -> f32 {
    if a.is_nan() || b.abs() > a.abs() { b } else { a }
}

fn middle(of: &[f64]) -> f64 {
    0.5 * (of[0] + of[of.len() - 1])
}

/// The instants at which forces are looked at, and the field that they fill.
pub(super) struct Frame {
    pub times_s: Vec<f64>,
    field: Field,
}

impl Frame {
    /// `None` without a positive finite horizon.
    pub fn new(train: &Train, case: &CaseFindings) -> Option<Frame> {
        let couplers = train.couplers().len();
        let times_s = instants(train, case.horizon_s)?;
        let couplers_per_row = couplers.div_ceil(ROWS);
        let rows = couplers.div_ceil(couplers_per_row);
        let instants_per_column = times_s.len().div_ceil((MOST_VALUES / rows).min(MOST_KEPT));
        let columns: Vec<f64> = times_s.chunks(instants_per_column).map(middle).collect();
        let share = vec![f32::NAN; rows * columns.len()];
        Some(Frame {
            times_s,
            field: Field { couplers_per_row, instants_per_column, times_s: columns, share, slack: vec![] },
        })
    }

    fn add(&mut self, train: &Train, instant: usize, coupler: usize, force_n: f64) {
        let Field { couplers_per_row, instants_per_column, .. } = self.field;
        self.field.keep(coupler / couplers_per_row, instant / instants_per_column, use_of(train, coupler, force_n));
    }

    /// Filled by a march, whose outcome is given as well; `ask` may want more of it.
    pub fn of_march(
        mut self,
        train: &Train,
        case: &CaseFindings,
        problem: &Problem,
        ask: MarchOptions,
        of: Of,
    ) -> (Field, MarchOutcome) {
        let broken = case.broken_coupler.map(|b| b - 1).filter(|_| of == Of::Event);
        let breaks = case.cascade.iter().filter(|_| of == Of::Cascade).flat_map(|c| &c.breaks);
        let parted_s: HashMap<usize, f64> = breaks.map(|b| (b.coupler - 1, b.time_s)).collect();
        let times_s = self.times_s.clone();
        let ask = MarchOptions { history: (0..train.couplers().len()).collect(), times_s: times_s.clone(), ..ask };
        let outcome = march::follow(problem, &ask, &mut |t, i, force_n| {
            // A parted coupler is not shown as open slack; it has a force only while its vehicles push each other.
            let parted = parted_s.get(&i).is_some_and(|at_s| times_s[t] >= *at_s);
            if Some(i) != broken && (force_n != 0.0 || !parted) {
                self.add(train, t, i, force_n);
            }
        });
        let has_slack: Vec<bool> = train.extras().laws.iter().map(|law| law.slack_m() > 0.0).collect();
        self.field.slack =
            has_slack.chunks(self.field.couplers_per_row).map(|row| row.iter().all(|has| *has)).collect();
        (self.finish(train, case, of), outcome)
    }

    /// Puts the exact largest forces in.
    fn finish(mut self, train: &Train, case: &CaseFindings, of: Of) -> Field {
        for c in &case.couplers {
            let peaks = match (of, &c.cascade) {
                (Of::Event, _) => [(c.peak_draft_n, c.peak_draft_time_s), (c.peak_buff_n, c.peak_buff_time_s)],
                (Of::Cascade, Some(p)) => [(p.peak_draft_n, p.peak_draft_time_s), (p.peak_buff_n, p.peak_buff_time_s)],
                _ => continue,
            };
            for (force_n, time_s) in peaks.into_iter().filter_map(|(f, t)| Some((f?, t?))) {
                if let Some(column) = self.field.column(time_s) {
                    let row = (c.coupler - 1) / self.field.couplers_per_row;
                    self.field.keep(row, column, use_of(train, c.coupler - 1, force_n));
                }
            }
        }
        self.field
    }
}

/// The utilisation, with the force's sign.
fn use_of(train: &Train, coupler: usize, force_n: f64) -> f32 {
    let c = &train.couplers()[coupler];
    (force_n / if force_n < 0.0 { c.rated_buff_n } else { c.rated_draft_n }) as f32
}

/// Forces in every coupler of a case; `scenario` is an index into the train's scenarios. `None` where it would take long, or
/// without a rod.
///
/// Up to the horizon, or as far as is affordable. Every coupler's exact largest draft and buff are among the values, whatever
/// the instants in between.
pub fn field(train: &Train, scenario: usize, case: &CaseFindings, of: Of) -> Option<Field> {
    let scenario = train.scenarios().get(scenario)?;
    let mut frame = Frame::new(train, case)?;
    if of != Of::Rod && (of == Of::Cascade || Motion::of(train, scenario) == Motion::March) {
        let until_s = frame.times_s[frame.times_s.len() - 1];
        let rule = if of == Of::Cascade { scenario.cascade } else { Rule::Keep };
        let broken = case.broken_coupler.map(|b| b - 1);
        let problem = scenario::march(train, scenario, broken, [until_s; 2], rule);
        return (!takes_long(train, scenario, &problem))
            .then(|| frame.of_march(train, case, &problem, MarchOptions::default(), of).0);
    }
    let times_s = frame.times_s.clone();
    compute(train, scenario, case, of, &times_s, &mut |t, i, f| frame.add(train, t, i, f))
        .then(|| frame.finish(train, case, of))
}

/// Whether the march of linear couplers takes too long for a picture.
pub(super) fn takes_long(train: &Train, scenario: &Scenario, problem: &Problem) -> bool {
    scenario::is_proportional(train, scenario) && march::estimate_s(problem, &MarchOptions::default()) > MOST_SECONDS
}

/// Even instants from 0 to the horizon, or as far as there may be enough of them.
fn instants(train: &Train, horizon_s: f64) -> Option<Vec<f64>> {
    let unit_s = scenario::wave(train).time_unit_s;
    let most = (MOST_COMPUTED / train.couplers().len() as f64).min(MOST_INSTANTS);
    let units = (horizon_s / unit_s).min(most / SPARSEST);
    let count = (PER_UNIT * units).clamp(FEWEST, most.max(FEWEST));
    let to = horizon_s.min(units * unit_s);
    let usable = to > 0.0 && to.is_finite() && count.is_finite();
    let step = |i: usize| to * i as f64 / count.floor();
    usable.then(|| (0..=count as usize).map(step).collect())
}

/// Gives `see` the force, N, in every coupler at every instant, without a march; false if it would take long, needs a march, or has
/// no rod.
fn compute(
    train: &Train,
    scenario: &Scenario,
    case: &CaseFindings,
    of: Of,
    times_s: &[f64],
    see: &mut dyn FnMut(usize, usize, f64),
) -> bool {
    let scales = Scales::of(train);
    let broken = case.broken_coupler.map(|b| b - 1);
    let times: Vec<f64> = times_s.iter().map(|t| t / scales.time_s).collect();
    // Nothing beyond the last instant is wanted.
    let until_s = times_s[times_s.len() - 1];
    if Motion::of(train, scenario) == Motion::March {
        return false;
    }
    let damping_ratio = train.extras().damping_ratio;
    scenario::parts(train, &scenario.event, broken, until_s).iter().all(|part| {
        let mut see = |t: usize, i: usize, f: f64| see(t, part.first_coupler + i, f * scales.force_n);
        if of != Of::Rod {
            return field::of_scene(&part.scene, damping_ratio, &times, &mut see);
        }
        let Some(rod) = Rod::new(&part.scene).filter(|_| damping_ratio == 0.0) else { return false };
        for i in 0..part.scene.initial.len() {
            rod.history(i, &times).into_iter().enumerate().for_each(|(t, f)| see(t, i, f));
        }
        true
    })
}
