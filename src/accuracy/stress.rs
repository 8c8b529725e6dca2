//! Extreme trains: does the answer hold, and what does it cost, where a solver is most likely to fail?

mod cases;
pub mod gears;

use std::time::Instant;

use comfy_table::{LineStyle, Table, presets};

use super::reference::{Extreme, Reference, ReferenceError};
use crate::chain::Scene;
use crate::solve::{Ask, Solution, solve};
pub use cases::{Case, cases};

/// Longest train whose modes are found in long arithmetic here: the work grows as the square.
const LONGEST: usize = 120;
/// Runs of which the median time is taken, while a run takes less than a second.
const RUNS: usize = 5;

/// What one extreme case came to. Forces are in the scene's own unit, in which ratings are near 1.
#[derive(Clone, Debug)]
pub struct StressRow {
    /// The case.
    pub case: &'static str,
    /// Its couplers.
    pub couplers: usize,
    /// The method that the planner chose; `None` where it refused.
    pub method: Option<&'static str>,
    /// Largest error of any extreme against the reference; `None` without one.
    pub error: Option<f64>,
    /// The bound stated; `None` where the planner refused.
    pub bound: Option<f64>,
    /// Time to solve it, the median of several runs, s.
    pub seconds: f64,
    /// Couplers found to exceed.
    pub exceeding: usize,
    /// Couplers not decided.
    pub undecided: usize,
    /// Why there is no reference, or no answer.
    pub note: String,
}

/// Runs every extreme case through the planner's choice, or the march, and holds it against the reference.
pub fn stress() -> Vec<StressRow> {
    let of_chains = cases();
    let of_gears = gears::cases();
    of_chains.iter().map(run).chain(of_gears.iter().map(gears::run)).collect()
}

/// Runs one case.
pub fn run(case: &Case) -> StressRow {
    let scene = &case.scene;
    let mut row = StressRow {
        case: case.name,
        couplers: scene.initial.len(),
        method: None,
        error: None,
        bound: None,
        seconds: 0.0,
        exceeding: 0,
        undecided: 0,
        note: String::new(),
    };
    let (solution, seconds) = timed(scene);
    row.seconds = seconds;
    let solution = match solution {
        Ok(solution) => solution,
        Err(e) => return StressRow { note: e.to_string(), ..row },
    };
    row.method = Some(solution.method.name());
    row.bound = Some(solution.error_bound);
    for spring in solution.springs.iter().flatten() {
        match (spring.draft.exceeds(), spring.buff.exceeds()) {
            (Some(true), _) | (_, Some(true)) => row.exceeding += 1,
            (Some(false), Some(false)) => {}
            _ => row.undecided += 1,
        }
    }
    match truth(scene) {
        Ok(extremes) => row.error = Some(error(&solution, &extremes)),
        Err(why) => row.note = why,
    }
    row
}

fn timed(scene: &Scene) -> (Result<Solution, crate::solve::SolveError>, f64) {
    let rating = scene.rated_draft.iter().chain(&scene.rated_buff).fold(0.0f64, |a, &r| a.max(r));
    let ask = Ask { tolerance: 1e-9 * rating, ..Ask::default() };
    let mut seconds = Vec::new();
    loop {
        let start = Instant::now();
        let solution = solve(scene, &ask);
        let last = start.elapsed().as_secs_f64();
        seconds.push(last);
        if last > 1.0 || seconds.len() == RUNS {
            seconds.sort_by(f64::total_cmp);
            return (solution, seconds[seconds.len() / 2]);
        }
    }
}

fn truth(scene: &Scene) -> Result<Vec<[Extreme; 2]>, String> {
    if scene.initial.len() > LONGEST {
        return Err(format!("no reference: more than {LONGEST} couplers"));
    }
    let extremes = Reference::new(scene).and_then(|r| r.extremes());
    extremes.map_err(|e: ReferenceError| format!("no reference: {e}"))
}

fn error(solution: &Solution, extremes: &[[Extreme; 2]]) -> f64 {
    let mut worst = 0.0f64;
    for (spring, truth) in solution.springs.iter().zip(extremes) {
        let Some(peaks) = spring else { continue };
        for (side, truth) in [&peaks.draft, &peaks.buff].into_iter().zip(truth) {
            worst = worst.max(truth.error_of(side.best.value) - truth.doubt);
        }
    }
    worst
}

/// The rows as a table for a terminal.
pub fn terminal(rows: &[StressRow]) -> String {
    let mut table = Table::new();
    table.load_style(presets::UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none()));
    table.set_header(["case", "couplers", "method", "error", "bound", "time", "verdict", ""]);
    for row in rows {
        let number = |x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{x:.1e}"));
        let verdict = match (row.exceeding, row.undecided) {
            _ if row.method.is_none() => "refused".to_owned(),
            (exceeding, 0) => format!("{exceeding} exceed"),
            (exceeding, undecided) => format!("{exceeding} exceed, {undecided} not decided"),
        };
        let method = row.method.unwrap_or("-").to_owned();
        let time = format!("{:.2e} s", row.seconds);
        table.add_row([
            row.case.to_owned(),
            row.couplers.to_string(),
            method,
            number(row.error),
            number(row.bound),
            time,
            verdict,
            row.note.clone(),
        ]);
    }
    format!("{table}\n")
}
