//! What the report says of capacities besides the rating.

use super::numbers::{force, given_force};
use super::words::count;
use crate::consist::{LIMITS, Train};
use crate::findings::{CaseFindings, CouplerFindings, LimitFindings, ScenarioFindings};

/// How many couplers pass each limit, in one sentence; empty where the train has no limits.
pub fn sentence(scenario: &ScenarioFindings) -> String {
    let found: Vec<(usize, &LimitFindings)> = scenario
        .cases
        .iter()
        .flat_map(|case| &case.couplers)
        .filter_map(|c| Some((c.coupler, c.limits.as_ref()?)))
        .collect();
    if found.is_empty() {
        return String::new();
    }
    let couplers = |test: &dyn Fn(&LimitFindings) -> bool| {
        let mut numbers: Vec<usize> = found.iter().filter(|(_, l)| test(l)).map(|(n, _)| *n).collect();
        numbers.sort_unstable();
        numbers.dedup();
        numbers.len()
    };
    let passing = LIMITS.map(|name| {
        let open = match couplers(&|l| l.undecided.contains(&name)) {
            0 => String::new(),
            n => format!(" (for {n} it is not decided)"),
        };
        match couplers(&|l| l.passed.contains(&name)) {
            0 => format!("{name} by none{open}"),
            n => format!("{name} by {}{open}", count(n, "coupler")),
        }
    });
    let when = if scenario.cases.len() > 1 { "after some break" } else { "in this event" };
    format!("Passed {when}, by the largest force of either sense: {}.", passing.join(", "))
}

/// Couplers that pass a limit, the largest force first.
pub fn passing(case: &CaseFindings) -> Vec<&CouplerFindings> {
    let largest = |c: &CouplerFindings| c.limits.as_ref().map_or(0.0, |l| l.largest_n);
    let over = |c: &&CouplerFindings| c.limits.as_ref().is_some_and(|l| !l.passed.is_empty());
    let mut found: Vec<_> = case.couplers.iter().filter(over).collect();
    found.sort_by(|a, b| largest(b).total_cmp(&largest(a)).then(a.coupler.cmp(&b.coupler)));
    found
}

/// A row of the table of couplers that pass a limit.
pub fn row(train: &Train, c: &CouplerFindings, case: &CaseFindings) -> Vec<String> {
    let limits = train.extras.limits.get(c.coupler - 1).copied().unwrap_or_default();
    let found = c.limits.as_ref();
    vec![
        c.coupler.to_string(),
        c.between.join(", "),
        found.map(|l| force(l.largest_n, case.error_bound_n)).unwrap_or_default(),
        found.map(|l| l.passed.join(", ")).unwrap_or_default(),
        limits.0.map(|n| n.map_or("-".to_owned(), given_force)).join(", "),
    ]
}
