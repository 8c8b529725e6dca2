//! Couplers that break on the way where a bound is proven.

use super::proof::U;
use super::roots;
use super::run::Run;
use super::series::DEGREE;

/// The two senses of a force: draft and buff.
pub const SIGN: [f64; 2] = [1.0, -1.0];

/// What breaks within a step.
pub struct Found {
    /// At which share of the step.
    pub share: f64,
    /// Coupler, force, and how far its exact instant may be from that, s.
    pub couplers: Vec<(usize, f64, f64)>,
}

/// What is known of couplers that may break.
#[derive(Clone, Debug)]
pub struct Breaks {
    /// Per coupler and sense: since when it may be over the force that breaks it.
    pub near: Vec<[Option<f64>; 2]>,
    /// Per coupler and sense: it has been certainly under that force at some instant.
    pub left_limit: Vec<[bool; 2]>,
    /// A coupler that may have broken before another one did, and so may have kept it from breaking, and since when.
    pub undecided: Option<(usize, f64)>,
    /// The last instant at which something broke.
    pub last: f64,
}

impl Breaks {
    /// At t = 0, when what the event and the load alone break is gone.
    pub fn new(run: &Run, bound: f64) -> Breaks {
        let couplers = run.couplers.len();
        let mut breaks = Breaks {
            near: vec![[None; 2]; couplers],
            left_limit: vec![[true; 2]; couplers],
            undecided: None,
            last: 0.0,
        };
        for i in (0..couplers).filter(|&i| !run.couplers[i].parted) {
            breaks.left_limit[i] = [0, 1].map(|side| SIGN[side] * run.start[i][1] < run.limit_n(i, side) - bound);
        }
        breaks
    }

    /// The first coupler that may have passed its limit and did not certainly do so, and since when: t = 0 if it stood at its limit
    /// then and was never certainly under it.
    pub fn first_undecided(&self) -> Option<(usize, f64)> {
        let since = |i: usize, side: usize| if self.left_limit[i][side] { self.near[i][side] } else { Some(0.0) };
        let sides = (0..self.near.len()).flat_map(|i| [0, 1].map(|side| (i, side)));
        let near = sides.filter_map(|(i, side)| Some((i, since(i, side)?)));
        near.chain(self.undecided).min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Couplers broke.
    pub fn note(&mut self, couplers: &[(usize, f64, f64)], time: f64) {
        self.last = time;
        for &(i, ..) in couplers {
            (self.near[i], self.left_limit[i]) = ([None; 2], [true; 2]);
        }
    }
}

/// The coefficients of a force over a step.
pub type Coefficients = [f64; DEGREE + 1];

/// A step as tried, and the bound on every force up to the horizon, N, if nothing breaks.
pub struct Step<'a> {
    pub run: &'a Run<'a>,
    pub bound: f64,
}

/// A side of a coupler that may pass its limit within a step: it may be over the limit from the instant `from` on, certainly is
/// over it at `until`, and its computed force passes the limit at `at`.
#[derive(Clone)]
pub struct Passing {
    pub coupler: usize,
    pub side: usize,
    pub from: f64,
    pub until: Option<f64>,
    pub at: f64,
    pub force: Coefficients,
}

impl Step<'_> {
    /// The force of a coupler over the step.
    pub fn force(&self, i: usize) -> Coefficients {
        let mut c = self.change(i);
        c[0] += self.run.start[i][1];
        c
    }

    /// The same less that at t = 0.
    pub fn change(&self, i: usize) -> Coefficients {
        let (run, mut c) = (self.run, [0.0; DEGREE + 1]);
        if run.state.couplers().contains(&i) {
            run.series.tension_of(&run.state, i, run.width, &mut c);
            c[run.series.terms + 1..].fill(0.0);
        }
        c
    }

    /// The couplers that break, from the sides that pass.
    pub fn found<'p>(&self, broken: impl Iterator<Item = &'p Passing> + Clone) -> Found {
        let time = broken.clone().map(|p| p.at).fold(f64::INFINITY, f64::min);
        let share = ((time - self.run.t) / self.run.width).clamp(0.0, 1.0);
        let apart = |p: &Passing| (p.until.unwrap_or(time) - time).max(time - p.from) + 4.0 * U * time;
        Found { share, couplers: broken.map(|p| (p.coupler, roots::at(&p.force, share), apart(p))).collect() }
    }
}
