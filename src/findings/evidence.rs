//! Forces over time of a scenario's worst case, as reports draw them: found once, by one run of a march for all figures.

use super::field::{self, Frame};
use super::{CaseFindings, CouplerFindings, Field, Of, ScenarioFindings, history, worst_case};
use crate::march::{self, MarchOptions};
use crate::scenario::{self, Motion};
use crate::train::{Rule, Scenario, Train};

/// Instants of a force over time per unit of time sqrt(m / k): about eight in the period of the fastest vibration of equal vehicles.
const PER_UNIT: f64 = 2.5;
/// Fewest and most instants of a force over time in a figure.
const FEWEST: usize = 600;
const MOST: usize = 3000;
/// Instants of the way of a force over its elongation.
const ON_WAY: usize = 4000;

/// What is drawn of a scenario: of many cases, of the one with the worst coupler.
#[derive(Clone, Debug)]
pub struct Evidence {
    /// Forces by place and time after the event alone; `None` where nothing moves, or there is but one coupler.
    pub wave: Option<Field>,
    /// `wave` is left out: it would take long to compute.
    pub wave_left_out: bool,
    /// The rod's.
    pub rod: Option<Field>,
    /// Those when couplers break one after the other, of a scenario with one case.
    pub cascade: Option<Field>,
    /// The stretch of time over which the worst coupler is shown, s: all of it, or, where that is too long to resolve, a window. It begins
    /// at t = 0 if it then holds the peak, and else lies around the peak.
    pub window_s: (f64, f64),
    /// Instants in it, those that the text names among them.
    pub times_s: Vec<f64>,
    /// The force in the worst coupler at these, N.
    pub force_n: Vec<f64>,
    /// The rod's; empty where there is none.
    pub rod_force_n: Vec<f64>,
    /// Elongation, m from the middle of the slack, and force, N, of the worst coupler over the whole time; empty for a
    /// linear one.
    pub way: Vec<[f64; 2]>,
}

impl ScenarioFindings {
    /// What is drawn of the scenario, found when it is first asked for; `None` where no coupler is left to watch. The train is that of
    /// the analysis.
    pub fn evidence(&self, train: &Train) -> Option<&Evidence> {
        let find = || {
            let index = train.scenarios().iter().position(|s| s.name == self.name)?;
            let (case, worst) = worst_case(&self.cases)?;
            Some(evidence(train, index, case, worst, self.cases.len() == 1))
        };
        self.evidence.get_or_init(find).as_ref()
    }
}

fn evidence(train: &Train, index: usize, case: &CaseFindings, worst: &CouplerFindings, is_only: bool) -> Evidence {
    let scenario = &train.scenarios()[index];
    let (broken, coupler) = (case.broken_coupler.map(|b| b - 1), worst.coupler - 1);
    let window_s = window(train, case, worst);
    let times_s = instants(train, case, worst, window_s);
    let several = case.couplers.len() > 1;
    let (wave, force_n, way) = if Motion::of(train, scenario) == Motion::March {
        marched(train, scenario, case, coupler, &times_s)
    } else {
        let wave = if several { field::field(train, index, case, Of::Event) } else { None };
        (wave, history::history(train, index, broken, coupler, &times_s), Vec::new())
    };
    let wave_left_out = several && wave.is_none();
    let wave = wave.filter(|w| several && w.moves());
    let moving = |of: Of| field::field(train, index, case, of).filter(Field::moves);
    let breaks = case.cascade.as_ref().is_some_and(|c| is_only && !c.breaks.is_empty());
    Evidence {
        rod: wave.as_ref().and_then(|_| moving(Of::Rod)),
        cascade: if breaks { moving(Of::Cascade) } else { None },
        wave,
        wave_left_out,
        window_s,
        rod_force_n: history::rod_history(train, index, broken, coupler, &times_s).unwrap_or_default(),
        times_s,
        force_n,
        way,
    }
}

/// Of a march: forces by place and time, the force of a coupler at given instants, and its way if it is not linear.
fn marched(
    train: &Train,
    scenario: &Scenario,
    case: &CaseFindings,
    coupler: usize,
    times_s: &[f64],
) -> (Option<Field>, Vec<f64>, Vec<[f64; 2]>) {
    let peak_s = case.couplers.iter().find(|c| c.coupler == coupler + 1).map(|c| c.peak_time_s);
    let has_way = train.extras().laws.get(coupler).is_some_and(|law| !law.is_linear());
    let even = (0..=ON_WAY).map(|i| case.horizon_s * i as f64 / ON_WAY as f64).chain(peak_s);
    let on_way: Vec<f64> = if has_way { even.collect() } else { Vec::new() };
    let mut watched_s = [times_s, &on_way].concat();
    watched_s.sort_by(f64::total_cmp);
    watched_s.dedup();
    let broken = case.broken_coupler.map(|b| b - 1);
    let problem = scenario::march(train, scenario, broken, [case.horizon_s; 2], Rule::Keep);
    let frame = Frame::new(train, case).filter(|_| !field::takes_long(train, scenario, &problem));
    let ask = MarchOptions { watched: Some((coupler, watched_s.clone())), ..MarchOptions::default() };
    let (wave, outcome) = match frame {
        Some(frame) => {
            let (wave, outcome) = frame.of_march(train, case, &problem, ask, Of::Event);
            (Some(wave), outcome)
        }
        None => (None, march::follow(&problem, &ask, &mut |_, _, _| {})),
    };
    let at = |t: &f64| outcome.watched[watched_s.partition_point(|w| w < t)];
    let force_n = times_s.iter().map(|t| at(t)[1]).collect();
    let way = if has_way { outcome.watched.clone() } else { Vec::new() };
    (wave, force_n, way.into_iter().filter(|p| p.iter().all(|x| x.is_finite())).collect())
}

fn window(train: &Train, case: &CaseFindings, coupler: &CouplerFindings) -> (f64, f64) {
    let longest = MOST as f64 / PER_UNIT * scenario::wave(train).time_unit_s;
    let horizon = case.horizon_s;
    if horizon <= longest || !longest.is_normal() {
        return (0.0, horizon);
    }
    let from = if coupler.peak_time_s < 0.9 * longest { 0.0 } else { coupler.peak_time_s - 0.5 * longest };
    let from = from.min(horizon - longest);
    (from, from + longest)
}

/// Evenly spaced instants, and those that the text names.
fn instants(train: &Train, case: &CaseFindings, coupler: &CouplerFindings, (from, to): (f64, f64)) -> Vec<f64> {
    let count = ((to - from) / scenario::wave(train).time_unit_s * PER_UNIT) as usize;
    let count = count.clamp(FEWEST, MOST);
    let even = (0..=count).map(|i| from + (to - from) * i as f64 / count as f64);
    let named = [Some(coupler.peak_time_s), coupler.first_exceeds_s].into_iter().flatten();
    let mut all: Vec<f64> = even.chain(named.filter(|t| (from..=to).contains(t))).collect();
    // Rounding may put the last one beyond the horizon, where a march has ended.
    all.iter_mut().for_each(|t| *t = t.min(case.horizon_s));
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}
