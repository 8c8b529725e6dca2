//! Extreme trains with slack and gears, followed by the march and held against a march in numbers of 31 digits.

use std::time::Instant;

use super::super::gears::exact::GearReference;
use super::StressRow;
use crate::law::{Curve, Law, Rest};
use crate::march::{Bound, MarchOptions, MarchOutcome, Problem, solve};

/// A named extreme train.
#[derive(Clone, Debug)]
pub struct GearCase {
    /// What is extreme about it.
    pub name: &'static str,
    /// The train and what happens; every coupler is rated at `PULL`.
    pub problem: Problem,
}

/// Rating of every coupler, and the unit of forces in the rows, N.
pub(crate) const PULL: f64 = 0.6e6;
/// Mass of a car, kg, and stiffness, N/m, of a gear that is loaded to the pull.
const CAR: f64 = 130e3;
const STIFFNESS: f64 = 17.9e6;
/// Speed of 8 mph, m/s.
const EIGHT_MPH: f64 = 8.0 * 0.44704;

/// All of them.
pub fn cases() -> Vec<GearCase> {
    let lists = [grazing(), let_go(), light_and_stiff(), impacts()];
    lists.into_iter().flatten().map(|(name, problem)| GearCase { name, problem }).collect()
}

/// Runs one case: three runs of the march to 1e-6 of the rating.
pub fn run(case: &GearCase) -> StressRow {
    let couplers = case.problem.laws.len();
    let ask = MarchOptions {
        capacity_n: vec![[PULL; 2]; couplers],
        tolerance_n: Some(1e-6 * PULL),
        ..MarchOptions::default()
    };
    let start = Instant::now();
    let outcome = solve(&case.problem, &ask);
    let seconds = start.elapsed().as_secs_f64();
    let horizon_s = outcome.predictable_until_s.unwrap_or(case.problem.horizon_s);
    let cut = Problem { horizon_s, mark_s: horizon_s, ..case.problem.clone() };
    let (bound_n, mut note) = match outcome.bound {
        Bound::Proven(n) => (n, "bound proven".to_owned()),
        Bound::Estimated(n) => (n, "bound is an estimate".to_owned()),
        Bound::None => (f64::INFINITY, "no bound".to_owned()),
    };
    if let Some(until_s) = outcome.predictable_until_s {
        note += &format!(", predictable up to {until_s:.2} of {:.2} s", case.problem.horizon_s);
    }
    let extremes: Vec<[f64; 2]> = outcome.extremes.iter().map(|e| [e.draft.force_n, -e.buff.force_n]).collect();
    let error = match GearReference::new(&cut, &[]) {
        Ok(reference) if reference.doubt_n <= 0.1 * bound_n => Some(reference.peak_error_n(&extremes) / PULL),
        Ok(reference) => {
            note += &format!(", reference known to {:.0e} only", reference.doubt_n / PULL);
            None
        }
        Err(why) => {
            note += &format!(", no reference: {why}");
            None
        }
    };
    let (exceeding, undecided) = verdicts(&outcome);
    StressRow {
        case: case.name,
        couplers,
        method: Some("march"),
        error,
        bound: Some(bound_n / PULL),
        seconds,
        exceeding,
        undecided,
        note,
    }
}

/// Couplers over the rating, and those within ten errors of it.
fn verdicts(outcome: &MarchOutcome) -> (usize, usize) {
    let (mut exceeding, mut undecided) = (0, 0);
    for (e, error_n) in outcome.extremes.iter().zip(&outcome.error_n) {
        let over = [e.draft.force_n - PULL, -e.buff.force_n - PULL];
        if over.iter().zip(error_n).any(|(over, error)| *over > 10.0 * error) {
            exceeding += 1;
        } else if over.iter().zip(error_n).any(|(over, error)| over.abs() <= 10.0 * error) {
            undecided += 1;
        }
    }
    (exceeding, undecided)
}

type Named = (&'static str, Problem);

fn gear(solid_n_per_m: f64, slack_m: f64) -> Law {
    Law::Gear { solid_n_per_m, slack_m, draft: Curve::generic_friction_gears(), buff: Curve::generic_friction_gears() }
}

fn elastic(slack_m: f64) -> Law {
    Law::Elastic { draft_n_per_m: STIFFNESS, buff_n_per_m: STIFFNESS, slack_m }
}

/// Cars behind a held head, all pulled, and the end let go.
fn pulled(cars: usize, law: &Law, horizon_s: f64) -> Problem {
    let start = vec![law.rest(&[PULL]); cars];
    Problem { held_head: true, start, ..Problem::at_rest(vec![CAR; cars + 1], vec![law.clone(); cars], horizon_s) }
}

/// Motions that turn just where a coupler would go over to another curve, again and again.
fn grazing() -> Vec<Named> {
    // A locked gear between 0.3 and 0.6 MN, at which it would unlock.
    let law = gear(2e8, 0.025);
    let locked = Problem {
        held_head: true,
        start: vec![law.rest(&[PULL, 0.5 * PULL])],
        steady_n: vec![0.0, -0.75 * PULL],
        ..Problem::at_rest(vec![CAR; 2], vec![law], 30.0)
    };
    // A car between two held ones swings by the width of the gap.
    let stiffness = 2e7;
    let spring = Law::Elastic { draft_n_per_m: stiffness, buff_n_per_m: stiffness, slack_m: 0.0 };
    let gap = Law::Elastic { draft_n_per_m: stiffness, buff_n_per_m: stiffness, slack_m: 0.2 };
    let contact = Problem {
        held_head: true,
        held_tail: true,
        start: vec![Rest { force_n: 1e6, travel_m: 0.0 }, Rest::default()],
        ..Problem::at_rest(vec![CAR; 3], vec![spring, gap], 60.0)
    };
    vec![("a locked gear that grazes its curve", locked), ("contacts that graze", contact)]
}

fn let_go() -> Vec<Named> {
    // Both halves are mirror images, so that every event comes twice.
    let mut twins = pulled(41, &gear(2e8, 0.025), 10.0);
    twins.held_head = false;
    twins.gone = vec![20];
    (twins.steady_n[0], twins.steady_n[41]) = (PULL, -PULL);
    vec![
        ("symmetric simultaneous events", twins),
        ("gears without slack", pulled(50, &gear(2e8, 0.0), 20.0)),
        ("slack larger than any motion", pulled(50, &gear(2e8, 50.0), 20.0)),
        ("an elastic rattle", pulled(50, &elastic(0.025), 20.0)),
    ]
}

fn light_and_stiff() -> Vec<Named> {
    let mut light = pulled(20, &gear(2e8, 0.025), 4.0);
    light.mass_kg[10] = 1.0;
    vec![
        ("a vehicle of 1 kg between gears", light),
        ("solid stiffness 1e4 times the gear's", pulled(20, &gear(1e4 * STIFFNESS, 0.025), 8.0)),
    ]
}

fn impacts() -> Vec<Named> {
    let rake = |vehicles: usize, law: Law, horizon_s: f64| {
        let half = 0.5 * law.slack_m();
        let mut problem = Problem::at_rest(vec![CAR; vehicles], vec![law; vehicles - 1], horizon_s);
        let joint = vehicles / 2;
        problem.speed_m_s[joint..].fill(EIGHT_MPH);
        problem.start[joint - 1].travel_m = -half;
        problem
    };
    vec![
        ("a stop hit at 8 mph", rake(20, gear(2e8, 0.025), 5.0)),
        ("the same with elastic gaps", rake(20, elastic(0.05), 5.0)),
    ]
}
