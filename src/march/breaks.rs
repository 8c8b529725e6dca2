//! Couplers that break on the way where a bound is proven, and the gaps that they leave.
//!
//! ```text
//! q: distance of the vehicles beyond that of the unloaded coupler, a gap where it has parted, closed where q < 0
//! ```
//!
//! Where the vehicles of a parted coupler do not push each other ([`super::Problem::contact`]) the motion is not the train's once a gap
//! closes; the first that certainly does is told.
//!
//! After the break of one coupler that carries the draft F_b, and nothing more, its gap never closes, whatever the masses,
//! springs and dampers: against the steady motion the front part is driven by the constant force F_b on its last vehicle, at
//! displacement x, and by nothing else. That force has done the work F_b x(t), which the part has stored or lost,
//! so that F_b x(t) >= 0 at every instant; likewise for the rear part, whose first vehicle is driven by -F_b. Both vehicles are
//! therefore never nearer than at the break. So only couplers that break in buff, for which q < 0 from the start, and several
//! breaks, or breaks under other forces, can close a gap.

use super::certain::Step;
use super::proof::{Proof, root_inverse_mass};
use super::series::DEGREE;
use super::step::{March, stiffest};
use crate::solve::local::{Local, reach};

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
    /// Per coupler and sense: it has been certainly under that force.
    pub left_limit: Vec<[bool; 2]>,
    /// A coupler that may have broken before another one did, and so may have kept it from breaking, and since when.
    pub undecided: Option<(usize, f64)>,
    /// The last instant at which something broke.
    pub last: f64,
}

impl Breaks {
    /// At t = 0, when what the event and the load alone break is gone.
    pub fn new(march: &March, bound: f64) -> Breaks {
        let couplers = march.couplers.len();
        let mut breaks = Breaks {
            near: vec![[None; 2]; couplers],
            left_limit: vec![[true; 2]; couplers],
            undecided: None,
            last: 0.0,
        };
        for i in (0..couplers).filter(|&i| !march.couplers[i].parted) {
            breaks.left_limit[i] = [0, 1].map(|side| SIGN[side] * march.start[i][1] < march.limit_n(i, side) - bound);
        }
        breaks
    }

    /// The first coupler that may have passed its limit and was not seen to, and when: at t = 0 if it stood there and never left.
    pub fn open(&self) -> Option<(usize, f64)> {
        let since = |i: usize, side: usize| if self.left_limit[i][side] { self.near[i][side] } else { Some(0.0) };
        let sides = (0..self.near.len()).flat_map(|i| [0, 1].map(|side| (i, side)));
        let near = sides.filter_map(|(i, side)| Some((i, since(i, side)?)));
        near.chain(self.undecided).min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The first couplers that break within a step.
    pub fn find(&mut self, step: &Step) -> Option<Found> {
        let plain = self.passing(step, &[]);
        let waiting = self.undecided.is_none() && self.near.iter().flatten().any(Option::is_some);
        let (passing, broken) =
            if plain.is_empty() && !waiting { (plain, Vec::new()) } else { self.decide(step, plain) };
        let found = (!broken.is_empty()).then(|| step.found(broken.iter().map(|&n| &passing[n])));
        let share = found.as_ref().map_or(1.0, |f| f.share);
        let until = step.march.t + share * step.march.width;
        for p in passing.iter().filter(|p| p.from <= until) {
            self.near[p.coupler][p.side].get_or_insert(p.from);
        }
        for i in (0..self.left_limit.len()).filter(|&i| !step.march.couplers[i].parted) {
            for side in [0, 1] {
                if !self.left_limit[i][side] {
                    let value = SIGN[side] * at(&step.force(i), share);
                    self.left_limit[i][side] = value < step.march.limit_n(i, side) - 4.0 * step.bound;
                }
            }
        }
        found
    }

    /// Couplers broke.
    pub fn note(&mut self, couplers: &[(usize, f64, f64)], time: f64) {
        self.last = time;
        for &(i, ..) in couplers {
            (self.near[i], self.left_limit[i]) = ([None; 2], [true; 2]);
        }
    }
}

/// Value of a polynomial, lowest power first.
pub fn at(c: &[f64], s: f64) -> f64 {
    super::roots::at(c, s)
}

impl March<'_> {
    /// The force at which a coupler breaks in one sense, positive; infinite for never.
    pub fn limit_n(&self, i: usize, side: usize) -> f64 {
        self.problem.break_at_n.get(i).map_or(f64::INFINITY, |limits| limits[side])
    }

    /// The proof, and what couplers break where one follows them; those whose load is over their limit break at once.
    pub fn prove(&mut self) {
        let Some(mut proof) = Proof::new(self) else { return };
        if !self.problem.break_at_n.is_empty() {
            let over = |i: &usize| {
                let load_n = self.start[*i][1];
                !self.couplers[*i].parted && (load_n > self.limit_n(*i, 0) || -load_n > self.limit_n(*i, 1))
            };
            let broken: Vec<_> = (0..self.couplers.len()).filter(over).map(|i| (i, self.start[i][1], 0.0)).collect();
            broken.iter().for_each(|(i, ..)| self.part(*i, 0.0));
            proof.measure(self);
            self.breaks = Some(Breaks::new(self, proof.bound_n(self)));
        }
        let gaps: Vec<(usize, f64)> = self.partings.iter().map(|p| (p.coupler, 0.0)).collect();
        self.proof = Some(proof);
        self.note_closed(&gaps);
    }

    /// What certainly breaks in the step as tried.
    pub fn find_breaks(&mut self) -> Option<Found> {
        let mut breaks = self.breaks.take()?;
        let bound = self.proof.map_or(0.0, |proof| proof.bound_n(self));
        let found = breaks.find(&Step { march: self, bound });
        self.breaks = Some(breaks);
        found
    }

    /// Couplers break now.
    pub fn break_now(&mut self, found: &Found) {
        let Some((mut proof, mut breaks)) = self.proof.take().zip(self.breaks.take()) else { return };
        proof.delay(self, &found.couplers);
        let error = proof.norm_to(self.problem.horizon_s);
        found.couplers.iter().for_each(|&(i, _, apart)| self.part(i, apart));
        proof.measure(self);
        breaks.note(&found.couplers, self.t);
        (self.proof, self.breaks) = (Some(proof), Some(breaks));
        let gaps = found.couplers.iter().map(|&(i, ..)| (i, error / stiffest(&self.problem.laws[i]).sqrt()));
        self.note_closed(&gaps.collect::<Vec<_>>());
    }

    /// Gaps that are closed when their couplers part, each with the error of its opening.
    fn note_closed(&mut self, gaps: &[(usize, f64)]) {
        if self.breaks.is_none() || !self.closures.is_empty() {
            return;
        }
        let closed = |&&(i, error): &&(usize, f64)| self.start[i][0] + self.state.elongation(i) < -error;
        if let Some(&(i, _)) = gaps.iter().find(closed) {
            self.closures.push((i, self.t));
        }
    }

    /// Follows the gaps over the step as cut; the first that certainly closes is noted.
    pub fn follow_gaps(&mut self, width: f64) {
        if self.breaks.is_none() || !self.closures.is_empty() {
            return;
        }
        let horizon = self.problem.horizon_s;
        let norm = self.proof.map_or(0.0, |proof| proof.norm_to(horizon));
        let mut c = [0.0; DEGREE + 1];
        let mut first: Option<(usize, f64)> = None;
        for i in self.partings.iter().map(|p| p.coupler) {
            let stiffness = stiffest(&self.problem.laws[i]);
            let error = norm * (1.0 / stiffness.sqrt() + 2.0 * horizon * root_inverse_mass(self, i));
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
