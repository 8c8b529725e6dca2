//! Random trains and scenes, each method's extremes against the reference: does every stated bound hold?

mod draw;
mod findings;
pub mod gears;
mod judge;
pub mod kinds;
pub mod row;
pub mod trains;

use rayon::prelude::*;

pub use draw::{scene, with_ratings};
pub use judge::{Fault, Verdict, judge};
use trainsafe::accuracy::reference::{Reference, ReferenceError};
use trainsafe::chain::Scene;
use trainsafe::solve::responses::{Responses, Shared};
use trainsafe::solve::watch::SpringPeaks;
use trainsafe::solve::{Ask, Method, Solution, Wanted};

/// As many scenes as are marched side by side.
const LANES: usize = 8;

/// How a scene is solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum By {
    /// By a method that is asked for.
    Method(Method),
    /// As the planner chooses.
    Choice,
    /// From the response to a unit force, where that can tell.
    Response,
    /// Together with others like it, which are marched side by side.
    Together,
}

/// Every way, in the order of the table.
pub const WAYS: [By; 6] = [
    By::Method(Method::Fronts),
    By::Method(Method::Modal),
    By::Method(Method::Propagator),
    By::Choice,
    By::Response,
    By::Together,
];

/// One way on one scene.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The scene's seed.
    pub seed: u64,
    /// How it is solved.
    pub by: By,
    /// The bound that the method states.
    pub bound: f64,
    /// What the reference says of its results.
    pub verdict: Verdict,
}

/// One line of the table: a way over all its scenes.
#[derive(Clone, Debug)]
pub struct CampaignRow {
    /// How it is solved.
    pub by: By,
    /// Scenes that it was run on.
    pub scenes: usize,
    /// Largest true error over stated bound: over 1 means that the bound does not hold.
    pub worst: f64,
    /// The seed of that scene.
    pub worst_seed: u64,
    /// Median over scenes of stated bound over true error, where the error is not 0.
    pub median: f64,
    /// Scenes with no error at all.
    pub exact: usize,
    /// What is against the truth, with the seeds of the scenes concerned.
    pub wrong: Vec<(Fault, Vec<u64>)>,
    /// Couplers left undecided.
    pub undecided: usize,
    /// Of those, couplers whose peak is further from the rating than twice the bound.
    pub needless: usize,
}

impl CampaignRow {
    /// The way's name.
    pub fn name(&self) -> &'static str {
        match self.by {
            By::Method(method) => method.name(),
            By::Choice => "(chosen)",
            By::Response => "(response)",
            By::Together => "(together)",
        }
    }
}

/// A campaign's outcome.
#[derive(Clone, Debug)]
pub struct Campaign {
    /// A row per way that was taken at all.
    pub rows: Vec<CampaignRow>,
    /// Scenes without a reference, and why.
    pub refused: Vec<(u64, ReferenceError)>,
}

/// A scene solved in one way; `None` where that does not apply.
fn solved(scene: &Scene, by: By, wanted: Wanted) -> Option<Solution> {
    let method = match by {
        By::Method(method) => Some(method),
        By::Together => Some(Method::Propagator),
        By::Choice | By::Response => None,
    };
    let rating = scene.rated_draft.iter().chain(&scene.rated_buff).fold(0.0f64, |a, &r| a.max(r));
    // A method asked for by name is held to what it can do at best, the planner to its default tolerance.
    let tolerance = if method.is_some() { f64::MIN_POSITIVE } else { 1e-9 * rating };
    let ask = Ask { tolerance, method, verdict_only: false, all_time_bound: false, wanted, mark: None };
    let responses = Responses::new(0);
    let shared = if by == By::Response { Shared::EveryChain(&responses) } else { Shared::Nothing };
    let others = (1..if by == By::Together { LANES } else { 1 }).map(|n| {
        let share = 0.5 + 0.1 * n as f64;
        Scene { horizon: share * scene.horizon, force: -share * scene.force, ..scene.clone() }
    });
    let others: Vec<Scene> = others.collect();
    let all: Vec<(&Scene, Ask)> = others.iter().chain([scene]).map(|scene| (scene, ask)).collect();
    shared.solve_all(&all).pop()?.ok()
}

/// Extremes found in one way, and the bound stated; `None` where that does not apply.
pub fn run_way(scene: &Scene, by: By) -> Option<(Vec<SpringPeaks>, f64)> {
    let solution = solved(scene, by, Wanted::Everything)?;
    Some((solution.springs.into_iter().collect::<Option<_>>()?, solution.error_bound))
}

/// What a row of a fleet says of a scene, if that is not what comes of asking for everything.
pub fn wrong_row(scene: &Scene, by: By) -> Option<String> {
    let [everything, worst] = [Wanted::Everything, Wanted::Worst]
        .map(|wanted| solved(scene, by, wanted).map(|solution| row::WorstRow::of(scene, &solution)));
    let (everything, worst) = (everything?, worst?);
    (!worst.agrees(&everything, scene)).then(|| format!("{worst:?} instead of {everything:?}"))
}

/// All ways on the scene of one seed.
///
/// # Errors
/// [`ReferenceError`] where there is no reference.
pub fn trials(seed: u64) -> Result<Vec<Trial>, ReferenceError> {
    let bare = scene(seed);
    let reference = Reference::new(&bare)?;
    let extremes = reference.extremes()?;
    let scene = with_ratings(bare, &extremes, seed);
    let trial = |&by: &By| {
        let (peaks, bound) = run_way(&scene, by)?;
        let verdict = judge(&scene, &reference, &extremes, &peaks, bound).map(|mut verdict| {
            verdict.wrong.extend(wrong_row(&scene, by).map(|row| (Fault::Row, row)));
            Trial { seed, by, bound, verdict }
        });
        Some(verdict)
    };
    WAYS.iter().filter_map(trial).collect()
}

/// All ways on the scenes of many seeds, in parallel; the outcome does not depend on how many threads there are.
pub fn run(seeds: &[u64]) -> Campaign {
    let outcomes: Vec<(u64, Result<Vec<Trial>, ReferenceError>)> =
        seeds.par_iter().map(|&seed| (seed, trials(seed))).collect();
    let mut all = Vec::new();
    let mut refused = Vec::new();
    for (seed, outcome) in outcomes {
        match outcome {
            Ok(trials) => all.extend(trials),
            Err(e) => refused.push((seed, e)),
        }
    }
    Campaign { rows: WAYS.iter().filter_map(|&by| row(by, &all)).collect(), refused }
}

fn row(by: By, all: &[Trial]) -> Option<CampaignRow> {
    let trials: Vec<&Trial> = all.iter().filter(|t| t.by == by).collect();
    let ratio = |t: &Trial| t.verdict.error / t.bound;
    let worst = trials.iter().copied().reduce(|a, b| if ratio(b) > ratio(a) { b } else { a })?;
    let mut slack: Vec<f64> = trials.iter().filter(|t| t.verdict.error > 0.0).map(|t| 1.0 / ratio(t)).collect();
    slack.sort_by(f64::total_cmp);
    Some(CampaignRow {
        by,
        scenes: trials.len(),
        worst: ratio(worst),
        worst_seed: worst.seed,
        median: slack.get(slack.len() / 2).copied().unwrap_or(f64::NAN),
        exact: trials.len() - slack.len(),
        wrong: Fault::ALL.map(|f| (f, at_fault(&trials, f))).into_iter().filter(|w| !w.1.is_empty()).collect(),
        undecided: trials.iter().map(|t| t.verdict.undecided).sum(),
        needless: trials.iter().map(|t| t.verdict.needless).sum(),
    })
}

fn at_fault(trials: &[&Trial], fault: Fault) -> Vec<u64> {
    trials.iter().filter(|t| t.verdict.wrong.iter().any(|w| w.0 == fault)).map(|t| t.seed).collect()
}
