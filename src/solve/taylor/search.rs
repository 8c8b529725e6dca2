//! Couplers that pass their rating on the way, and what their breaking does to the error.

use super::certain::Step;
use super::gaps::Gaps;
use super::series::{Series, State};
use super::{ROUNDINGS, Rates, U};
use crate::play::{Play, Rule};

/// Roundings of a force that is shown, beside those of its state.
const SHOWN: f64 = 16.0;

/// Couplers that break at one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Breakage {
    /// When.
    pub time: f64,
    /// Which, ascending.
    pub springs: Vec<usize>,
    /// Their forces at that instant.
    pub force: Vec<f64>,
    /// The exact instant of each is no further away than this.
    pub uncertainty: f64,
    /// Speeds of the masses against the steady motion.
    pub velocity: Vec<f64>,
    /// Kinetic energy against the steady motion; breaking does not change it.
    pub kinetic: f64,
    /// Energy of the springs just before and just after.
    pub strain: [f64; 2],
    /// What each of the springs that break had of it.
    pub energy: Vec<f64>,
}

/// What breaks within a step.
pub struct Found {
    /// At which share of the step.
    pub share: f64,
    /// Spring, force, and how far its exact instant may be from that.
    pub(super) broken_now: Vec<(usize, f64, f64)>,
}

/// The search for couplers that break.
pub struct Breaks<'a> {
    pub(super) play: &'a Play,
    rates: Rates,
    /// What broke so far.
    pub breakages: Vec<Breakage>,
    /// Where couplers broke; followed with a rule of breaking only.
    pub gaps: Gaps,
    /// Per coupler and sign: since when it may be over its rating.
    pub(super) near: Vec<[Option<f64>; 2]>,
    /// Per coupler and sign: it has been certainly under its rating.
    pub(super) left_rating: Vec<[bool; 2]>,
    /// A coupler that may have broken before another one did, and so may have kept it from breaking, and since when.
    pub(super) undecided: Option<(usize, f64)>,
    /// Norm of the error, of the motion, and bound on that of its derivative, at `since`.
    error: f64,
    motion: f64,
    derivative: f64,
    since: f64,
}

impl<'a> Breaks<'a> {
    /// At t = 0: breaks what the event breaks, and what the load alone does.
    pub fn new(play: &'a Play, rates: Rates, state: &mut State, series: &mut Series) -> Breaks<'a> {
        let springs = play.scene.initial.len();
        let mut breaks = Breaks {
            play,
            rates,
            breakages: Vec::new(),
            gaps: Gaps::default(),
            near: vec![[None; 2]; springs],
            left_rating: vec![[true; 2]; springs],
            undecided: None,
            error: start_error(play),
            motion: 0.0,
            derivative: 0.0,
            since: 0.0,
        };
        for &b in &play.broken {
            breaks.gaps.add(b, play.scene.initial[b] / state.stiffness[b + 1], 0.0, 0.0);
            state.break_spring(b, play.steady(b));
        }
        let over = |i: usize| breaks.sides().iter().any(|&side| breaks.signed(i, side) > breaks.rating(i, side));
        let broken_now: Vec<_> = (0..springs).filter(|&i| state.whole(i) && over(i)).collect();
        if !broken_now.is_empty() {
            let broken_now = broken_now.into_iter().map(|i| (i, play.scene.initial[i], 0.0)).collect();
            breaks.break_springs(Found { share: 0.0, broken_now }, 0.0, state);
        }
        breaks.measure(state, series);
        let bound = breaks.bound();
        for i in (0..springs).filter(|&i| state.whole(i)) {
            breaks.left_rating[i] = [0, 1].map(|side| breaks.signed(i, side) < breaks.rating(i, side) - bound);
        }
        breaks
    }

    pub(super) fn sides(&self) -> &'static [usize] {
        match self.play.rule {
            Rule::Keep => &[],
            Rule::InDraft => &[0],
            Rule::InBoth => &[0, 1],
        }
    }

    pub(super) fn signed(&self, spring: usize, side: usize) -> f64 {
        SIGN[side] * self.play.scene.initial[spring]
    }

    /// The force at which a side breaks.
    pub(super) fn rating(&self, spring: usize, side: usize) -> f64 {
        let rated = || [&self.play.scene.rated_draft, &self.play.scene.rated_buff][side][spring];
        self.play.break_at.get(spring).map_or_else(rated, |at| at[side])
    }

    /// Norms of the motion and its derivative as they are now.
    fn measure(&mut self, state: &State, series: &mut Series) {
        let width = 1.0 / self.rates.largest;
        series.expand(state, width, |out| out.fill(0.0));
        let variation = self.play.drive.measures()[1];
        self.derivative = series.speed(state, width) + self.rates.root_inverse_mass * variation;
        self.motion = (2.0 * (kinetic(state) + strain(state, &vec![0.0; self.play.scene.initial.len()]))).sqrt();
    }

    /// Growth of the error's norm per unit of time, with the roundings of what is shown.
    fn growth(&self) -> f64 {
        let sup = self.play.drive.measures()[0];
        let rate = (1.0 + 2.0 * self.rates.drag) * self.derivative + self.rates.root_inverse_mass * sup;
        (ROUNDINGS + SHOWN) * U * rate
    }

    /// Bound on the error of every force up to the horizon if nothing more breaks.
    pub fn bound(&self) -> f64 {
        let sizes = (0..self.near.len()).map(|i| self.play.scene.initial[i].abs().max(self.play.steady(i).abs()));
        let steady = sizes.fold(0.0, f64::max);
        self.rates.force * (self.norm_error() + SHOWN * U * self.motion) + SHOWN * U * steady
    }

    /// Follows the gaps over a share of a step.
    pub fn follow_gaps(&mut self, state: &State, series: &Series, from: f64, width: f64, share: f64) {
        if self.sides().is_empty() {
            return;
        }
        let (error, horizon) = (self.norm_error(), self.play.scene.horizon);
        let stiffness = &self.play.scene.chain.stiffness;
        self.gaps.follow(series, from, width, share, |i| {
            error * (1.0 / stiffness[i].sqrt() + 2.0 * horizon * root_inverse_mass(state, i))
        });
    }

    /// Bound on the norm of the error up to the horizon if nothing more breaks.
    fn norm_error(&self) -> f64 {
        self.error + self.growth() * (self.play.scene.horizon - self.since)
    }

    /// The first coupler that may have passed its rating and was not seen to, and when: at t = 0 if it stood there and never left.
    pub fn open(&self) -> Option<(usize, f64)> {
        let since = |i: usize, side: usize| if self.left_rating[i][side] { self.near[i][side] } else { Some(0.0) };
        let sides = (0..self.near.len()).flat_map(|i| self.sides().iter().map(move |&side| (i, side)));
        let near = sides.filter_map(|(i, side)| Some((i, since(i, side)?)));
        near.chain(self.undecided).min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The first breakage within a step, if there is one.
    pub fn find(&mut self, state: &State, series: &Series, from: f64, width: f64) -> Option<Found> {
        if self.sides().is_empty() {
            return None;
        }
        let step = Step { state, series, from, width };
        let plain = self.passing(&step, &[]);
        let waiting = self.undecided.is_none() && self.near.iter().flatten().any(Option::is_some);
        let (passing, broken_now) =
            if plain.is_empty() && !waiting { (plain, Vec::new()) } else { self.decide(&step, plain) };
        let found = (!broken_now.is_empty()).then(|| step.found(broken_now.iter().map(|&n| &passing[n])));
        let until = from + found.as_ref().map_or(1.0, |f| f.share) * width;
        for p in passing.iter().filter(|p| p.from <= until) {
            self.near[p.spring][p.side].get_or_insert(p.from);
        }
        self.note_departures(state, series, (until - from) / width, self.bound());
        found
    }

    fn note_departures(&mut self, state: &State, series: &Series, share: f64, bound: f64) {
        for i in 0..self.left_rating.len() {
            for &side in self.sides() {
                if !self.left_rating[i][side] && state.whole(i) {
                    let coefficient = series.coupler(i, self.play.steady(i));
                    let value = SIGN[side] * coefficient.iter().rev().fold(0.0, |sum, c| sum * share + c);
                    self.left_rating[i][side] = value < self.rating(i, side) - 4.0 * bound;
                }
            }
        }
    }

    /// Breaks what was found and goes on from there.
    pub fn apply(&mut self, found: Found, time: f64, state: &mut State, series: &mut Series) {
        let late = self.growth() * (time - self.since);
        let broken_now: f64 =
            found.broken_now.iter().map(|(i, force, apart)| apart * force.abs() * root_inverse_mass(state, *i)).sum();
        self.error += late + broken_now;
        self.since = time;
        self.break_springs(found, time, state);
        self.measure(state, series);
    }

    fn break_springs(&mut self, found: Found, time: f64, state: &mut State) {
        let steady: &[f64] = &(0..self.near.len()).map(|i| self.play.steady(i)).collect::<Vec<_>>();
        let before = strain(state, steady);
        let own = |i: usize| 0.5 * (steady[i] + state.force[0][i + 1]).powi(2) / state.stiffness[i + 1];
        let energy = found.broken_now.iter().map(|t| own(t.0)).collect();
        let error = self.norm_error();
        for (i, ..) in &found.broken_now {
            let k = state.stiffness[i + 1];
            self.gaps.add(*i, (steady[*i] + state.force[0][i + 1]) / k, time, error / k.sqrt());
            state.break_spring(*i, steady[*i]);
            (self.near[*i], self.left_rating[*i]) = ([None; 2], [true; 2]);
        }
        self.breakages.push(Breakage {
            time,
            springs: found.broken_now.iter().map(|t| t.0).collect(),
            force: found.broken_now.iter().map(|t| t.1).collect(),
            uncertainty: found.broken_now.iter().map(|t| t.2).fold(0.0, f64::max),
            velocity: state.velocity[0].clone(),
            kinetic: kinetic(state),
            strain: [before, strain(state, steady)],
            energy,
        });
    }
}

/// Of draft and buff.
pub(super) const SIGN: [f64; 2] = [1.0, -1.0];

/// Norm of what rounding did to the start: the forces at t = 0 and the steady ones were each rounded once, and so was their
/// difference. Where there is no difference the two are one number.
fn start_error(play: &Play) -> f64 {
    let off = |i: usize| match play.start[i] {
        0.0 => 0.0,
        start => U * (play.scene.initial[i].abs() + play.steady(i).abs() + start.abs()),
    };
    play.scene.chain.stiffness.iter().enumerate().map(|(i, k)| off(i).powi(2) / k).sum::<f64>().sqrt()
}

/// `sqrt(1 / m + 1 / m')` of the masses at a spring.
pub(super) fn root_inverse_mass(state: &State, i: usize) -> f64 {
    (state.inverse_mass[i] + state.inverse_mass[i + 1]).sqrt()
}

fn kinetic(state: &State) -> f64 {
    let pairs = state.velocity[0].iter().zip(&state.inverse_mass).filter(|p| *p.1 > 0.0);
    0.5 * pairs.map(|(v, m)| v * v / m).sum::<f64>()
}

/// Energy of the whole springs under their steady forces and what has come on top of them.
fn strain(state: &State, steady: &[f64]) -> f64 {
    let whole = (0..steady.len()).filter(|&i| state.whole(i));
    0.5 * whole.map(|i| (steady[i] + state.force[0][i + 1]).powi(2) / state.stiffness[i + 1]).sum::<f64>()
}
