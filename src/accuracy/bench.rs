//! Methods on one scene: run times, and errors against the reference.

use std::time::Instant;

use rayon::prelude::*;

use super::peers::{Marched, Peer};
use super::reference::{Extreme, Reference, ReferenceError};
use super::{AccuracyOptions, Effort, INSTANTS, MethodRow, RowOrigin, WATCHED};
use crate::chain::Scene;
use crate::solve::dd::Dd;
use crate::solve::watch::{Side, SpringPeaks};
use crate::solve::{Ask, Method, Solution, SolveError, solve};

/// Shares of the largest rating that this crate's methods are asked for.
const TOLERANCES: [f64; 4] = [1e-3, 1e-6, 1e-9, 1e-12];

/// One scene on which methods are measured.
pub struct Bench<'a> {
    scene: &'a Scene,
    reference: Reference,
    /// Every spring's largest F and largest -F.
    pub extremes: Vec<[Extreme; 2]>,
    /// Springs and instants at which a march's forces are compared, and the forces there: a row per instant.
    watched: Vec<usize>,
    times: Vec<f64>,
    exact: Vec<Vec<Dd>>,
    force_n: f64,
    rating_n: f64,
    options: AccuracyOptions,
    /// What was measured.
    pub rows: Vec<MethodRow>,
    /// What was left out, and why.
    pub left_out: Vec<String>,
}

impl<'a> Bench<'a> {
    /// Finds the reference, and measures nothing yet.
    ///
    /// # Errors
    /// The reference's.
    pub fn new(
        scene: &'a Scene,
        force_n: f64,
        rating_n: f64,
        options: AccuracyOptions,
    ) -> Result<Bench<'a>, ReferenceError> {
        let reference = Reference::new(scene)?;
        let extremes = reference.extremes()?;
        let springs = scene.initial.len();
        let watched: Vec<usize> = (0..springs).step_by(springs.div_ceil(WATCHED)).collect();
        let times: Vec<f64> = (1..=INSTANTS).map(|i| scene.horizon * i as f64 / INSTANTS as f64).collect();
        let exact = reference.forces(&watched, &times);
        let (rows, left_out) = (vec![], vec![]);
        Ok(Bench { scene, reference, extremes, watched, times, exact, force_n, rating_n, options, rows, left_out })
    }

    /// This crate's methods that fit the scene, and the planner's choice; tolerances with one result share a row.
    ///
    /// # Errors
    /// The planner's, when it finds no method.
    pub fn ours(&mut self) -> Result<(), SolveError> {
        let methods = [Method::Fronts, Method::Modal, Method::Propagator];
        for method in methods.into_iter().map(Some).chain([None]) {
            let from = self.rows.len();
            for tolerance in TOLERANCES {
                match (self.solution(method, tolerance), method) {
                    (Ok(solution), _) => self.add(method, tolerance, &solution, from),
                    // A method for equal chains, pulled at an end, has no row on another.
                    (Err(SolveError::NotEqual(_) | SolveError::NotAtEnd), Some(_)) => break,
                    (Err(error), Some(method)) => {
                        self.left_out.push(format!("{}: {error}", method.name()));
                        break;
                    }
                    (Err(error), None) => return Err(error),
                }
            }
        }
        Ok(())
    }

    fn solution(&self, method: Option<Method>, tolerance: f64) -> Result<Solution, SolveError> {
        let tolerance = tolerance * self.rating_n / self.force_n;
        solve(self.scene, &Ask { tolerance, method, ..Ask::default() })
    }

    /// A row for a solution, or a wider range of tolerances for the same one among the rows from `from` on.
    fn add(&mut self, method: Option<Method>, tolerance: f64, solution: &Solution, from: usize) {
        let bound_n = solution.error_bound * self.force_n;
        let same = |row: &&mut MethodRow| {
            row.method == solution.method.name()
                && row.work == Effort::Counted(solution.work)
                && row.bound_n == Some(bound_n)
        };
        if let Some(row) = self.rows[from..].last_mut().filter(same) {
            let loosest = row.tolerances.map_or(tolerance, |t| t[0]);
            row.tolerances = Some([loosest, tolerance]);
            row.setting = format!("tolerance {loosest:e} to {tolerance:e}");
            return;
        }
        let (run_time_s, runs) = timed(&self.options, || drop(self.solution(method, tolerance)));
        let row = self.our_row(method.is_none(), tolerance, solution, run_time_s, runs);
        self.rows.push(row);
    }

    fn our_row(&self, planner: bool, tolerance: f64, solution: &Solution, run_time_s: f64, runs: usize) -> MethodRow {
        let method = solution.method;
        let peaks = solution.springs.iter().zip(&self.extremes).map(|(found, [draft, buff])| match found {
            Some(found) => draft.error_of(found.draft.best.value).max(buff.error_of(found.buff.best.value)),
            None => 0.0,
        });
        let forces = self.watched.par_iter().map(|&i| match solution.springs[i] {
            Some(SpringPeaks { draft: Side { best: draft, .. }, buff: Side { best: buff, .. } }) => {
                let in_draft = self.reference.error_of(i, draft.at, draft.value);
                in_draft.max(self.reference.error_of(i, buff.at, -buff.value))
            }
            None => 0.0,
        });
        let (peak, force) = (peaks.fold(0.0, f64::max), forces.reduce(|| 0.0, f64::max));
        MethodRow {
            origin: if planner { RowOrigin::Planner(method) } else { RowOrigin::Ours(method) },
            method: method.name(),
            setting: format!("tolerance {tolerance:e}"),
            tolerances: Some([tolerance; 2]),
            run_time_s,
            runs,
            work: Effort::Counted(solution.work),
            peak_error_n: peak * self.force_n,
            force_error_n: force * self.force_n,
            bound_n: Some(solution.error_bound * self.force_n),
            estimate_n: None,
        }
    }

    /// The marching methods.
    pub fn peers(&mut self) {
        for peer in Peer::all() {
            let name = format!("{}, {}", peer.name(), peer.setting());
            let expected = peer.estimated_accelerations(self.scene);
            if expected > self.options.most_accelerations {
                self.left_out.push(format!("{name}: it would compute some {expected:.0e} accelerations"));
                continue;
            }
            let marched = match peer.march(self.scene, &self.times) {
                Ok(marched) => marched,
                Err(error) => {
                    self.left_out.push(format!("{name}: {error}"));
                    continue;
                }
            };
            let timed = timed(&self.options, || drop(peer.march(self.scene, &[])));
            let row = self.peer_row(peer, &marched, timed);
            self.rows.push(row);
        }
    }

    fn peer_row(&self, peer: Peer, marched: &Marched, timed: (f64, usize)) -> MethodRow {
        let pairs = self.extremes.iter().flatten().zip(marched.extremes.iter().flatten());
        let peak = pairs.map(|(exact, &found)| exact.error_of(found)).fold(0.0, f64::max);
        let instants =
            self.exact.iter().zip(&marched.forces).flat_map(|(exact, found)| {
                exact.iter().zip(&self.watched).map(|(exact, &i)| difference(found[i], *exact))
            });
        let force = instants.fold(0.0, f64::max);
        let errors_n = [peak * self.force_n, force * self.force_n];
        MethodRow::of_peer((peer.name(), peer.setting()), marched, timed, errors_n)
    }
}

/// Median run time, s, and the number of runs.
pub fn timed(options: &AccuracyOptions, run: impl Fn()) -> (f64, usize) {
    let begin = Instant::now();
    let mut seconds = Vec::with_capacity(options.runs);
    while seconds.is_empty() || seconds.len() < options.runs && begin.elapsed() < options.row_time {
        let start = Instant::now();
        run();
        seconds.push(start.elapsed().as_secs_f64());
    }
    seconds.sort_by(f64::total_cmp);
    (seconds[seconds.len() / 2], seconds.len())
}

/// The error; infinite if `found` is not finite.
pub fn difference(found: f64, exact: Dd) -> f64 {
    if found.is_finite() { (Dd::from(found) - exact).abs().hi } else { f64::INFINITY }
}
