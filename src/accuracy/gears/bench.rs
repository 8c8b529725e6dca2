//! The march and the methods of simulators on one problem: run times, and errors against the reference.

use super::exact::{GearReference, TooManySteps};
use super::peers::GearPeer;
use crate::accuracy::bench::{difference, timed};
use crate::accuracy::peers::Marched;
use crate::accuracy::{AccuracyOptions, Effort, INSTANTS, MethodRow, RowOrigin, WATCHED};
use crate::march::{Bound, MarchOptions, MarchOutcome, Problem, solve};

/// How often a problem is shortened until all of its forces can be predicted.
const CUTS: usize = 8;

/// One problem on which methods are measured.
pub struct Bench {
    /// Up to where forces can be predicted.
    pub problem: Problem,
    /// The exact motion.
    pub reference: GearReference,
    watched: Vec<usize>,
    times: Vec<f64>,
    ask: MarchOptions,
    options: AccuracyOptions,
    /// What was measured.
    pub rows: Vec<MethodRow>,
    /// What was left out, and why.
    pub left_out: Vec<String>,
}

impl Bench {
    /// With the reference found; nothing measured yet. The problem ends where the march says that its forces cannot be predicted to
    /// `tolerance_n` any more, or where a vehicle stops.
    ///
    /// # Errors
    /// The reference's.
    pub fn new(problem: Problem, tolerance_n: f64, options: AccuracyOptions) -> Result<Bench, TooManySteps> {
        let couplers = problem.laws.len();
        let watched: Vec<usize> = (0..couplers).step_by(couplers.div_ceil(WATCHED)).collect();
        let ask = MarchOptions { tolerance_n: Some(tolerance_n), ..MarchOptions::default() };
        let mut problem = problem;
        for _ in 0..CUTS {
            let outcome = solve(&problem, &ask);
            let stops_s = outcome.stopped.map_or(problem.horizon_s, |s| s.1);
            // A little less: in another run the estimate may pass the tolerance slightly earlier.
            let horizon_s = outcome.predictable_until_s.map_or(stops_s, |t| stops_s.min(0.98 * t));
            (problem.horizon_s, problem.mark_s) = (horizon_s, horizon_s);
            if outcome.predictable_until_s.is_none() {
                break;
            }
        }
        let horizon_s = problem.horizon_s;
        let times: Vec<f64> = (1..=INSTANTS).map(|i| horizon_s * i as f64 / INSTANTS as f64).collect();
        let reference = GearReference::new(&problem, &times)?;
        Ok(Bench { problem, reference, watched, times, ask, options, rows: vec![], left_out: vec![] })
    }

    /// The march: as it is used, and one run alone.
    pub fn ours(&mut self) {
        for (setting, tolerance_n) in [("with its error", self.ask.tolerance_n), ("one run", None)] {
            let ask = MarchOptions { tolerance_n, ..MarchOptions::default() };
            let outcome = self.solved(&ask);
            let (run_time_s, runs) = timed(&self.options, || drop(solve(&self.problem, &ask)));
            let setting = match (setting, &outcome.bound) {
                ("with its error", Bound::Estimated(_)) => "three runs, for the estimate",
                ("with its error", _) => "one run, with its proof",
                // It is the row above.
                _ if matches!(outcome.bound, Bound::Proven(_)) => continue,
                _ => setting,
            };
            let row = self.our_row(setting, &outcome, run_time_s, runs);
            self.rows.push(row);
        }
    }

    fn solved(&self, ask: &MarchOptions) -> MarchOutcome {
        let (history, times_s) = (self.watched.clone(), self.times.clone());
        solve(&self.problem, &MarchOptions { history, times_s, ..ask.clone() })
    }

    fn our_row(&self, setting: &str, outcome: &MarchOutcome, run_time_s: f64, runs: usize) -> MethodRow {
        let extremes: Vec<[f64; 2]> = outcome.extremes.iter().map(|e| [e.draft.force_n, -e.buff.force_n]).collect();
        let (bound_n, estimate_n) = match outcome.bound {
            Bound::Proven(bound_n) => (Some(bound_n), None),
            Bound::Estimated(estimate_n) => (None, Some(estimate_n)),
            Bound::None => (None, None),
        };
        MethodRow {
            origin: RowOrigin::March,
            method: "march",
            setting: setting.to_owned(),
            tolerances: None,
            run_time_s,
            runs,
            work: Effort::Steps { steps: outcome.steps, events: outcome.events },
            peak_error_n: self.reference.peak_error_n(&extremes),
            force_error_n: self.force_error_n(|n, place, _| outcome.history[place][n]),
            bound_n,
            estimate_n,
        }
    }

    /// The methods of simulators.
    pub fn peers(&mut self) {
        let has_friction = GearPeer::Verlet { phase: 1.0 }.train(&self.problem).has_friction();
        for peer in GearPeer::all() {
            let name = format!("{}, {}", peer.name(), peer.setting());
            let expected = peer.estimated_accelerations(&self.problem);
            if peer.needs_friction() && !has_friction {
                self.left_out.push(format!("{name}: no coupler has friction"));
            } else if expected > self.options.most_look_ups {
                self.left_out.push(format!("{name}: it would compute some {expected:.0e} accelerations"));
            } else {
                let marched = peer.march(&self.problem, &self.times);
                let timed = timed(&self.options, || drop(peer.march(&self.problem, &[])));
                let row = self.peer_row(peer, &marched, timed);
                self.rows.push(row);
            }
        }
    }

    fn peer_row(&self, peer: GearPeer, marched: &Marched, timed: (f64, usize)) -> MethodRow {
        let peak_error_n = self.reference.peak_error_n(&marched.extremes);
        let force_error_n = self.force_error_n(|n, _, i| marched.forces[n][i]);
        MethodRow::of_peer((peer.name(), peer.setting()), marched, timed, [peak_error_n, force_error_n])
    }

    /// The largest error at the instants; `found` gives the force at an instant of a watched coupler by its place and its number.
    fn force_error_n(&self, found: impl Fn(usize, usize, usize) -> f64) -> f64 {
        let at = |n: usize| {
            let exact = &self.reference.found.forces[n];
            let errors = self.watched.iter().enumerate().map(|(place, &i)| difference(found(n, place, i), exact[i]));
            errors.fold(0.0, f64::max)
        };
        (0..self.times.len()).map(at).fold(0.0, f64::max)
    }
}
