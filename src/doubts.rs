//! What in a train or scenario is probably not meant, or does not hold. A doubt stops nothing; every command tells the same ones, from
//! this one list, but for those that only an analysis can find.

mod events;
mod found;
mod laws;
mod options;
mod plausible;

use std::fmt;

use serde::Serialize;

use crate::consist::{Coupler, Limits, SENSES, Train, count};
use crate::scenario::Scenario;

pub use found::found;
pub use options::idle_options;
pub(crate) use plausible::STEEP;

/// Something that is probably not meant.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Doubt {
    /// Which kind: a stable word for programs, such as `no-load`.
    pub code: &'static str,
    /// The scenario that it is about; `None` for one about the train.
    pub scenario: Option<String>,
    /// What it is, and what can be done: one sentence without its full stop.
    pub text: String,
}

impl Doubt {
    /// A doubt about the train.
    pub fn of_train(code: &'static str, text: impl Into<String>) -> Doubt {
        Doubt { code, scenario: None, text: text.into() }
    }

    /// A doubt about a scenario.
    pub fn of_scenario(code: &'static str, scenario: &Scenario, text: impl Into<String>) -> Doubt {
        Doubt { code, scenario: Some(scenario.name.clone()), text: text.into() }
    }
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.scenario {
            Some(scenario) => write!(f, "{scenario}: {}", self.text),
            None => f.write_str(&self.text),
        }
    }
}

/// Every doubt about a train and its scenarios: those of its reader first.
pub fn doubts(train: &Train) -> Vec<Doubt> {
    let mut found = train.origin.doubts.clone();
    if train.scenarios.iter().any(|s| s.event.kind() != "impact") {
        let text = overloaded(train, &train.initial_force_n);
        found.extend(text.map(|text| Doubt::of_train("load-over-rating", text)));
    }
    found.extend(limit_order(train));
    found.extend(lengths(train));
    found.extend(plausible::of_train(train));
    found.extend(laws::of_train(train));
    for scenario in &train.scenarios {
        found.extend(events::of_scenario(train, scenario));
    }
    found
}

/// How many couplers the load overloads by itself.
fn overloaded(train: &Train, load_n: &[f64]) -> Option<String> {
    let over = |(force, c): &(&f64, &Coupler)| **force > c.rated_draft_n || -**force > c.rated_buff_n;
    let over = load_n.iter().zip(&train.couplers).filter(over).count();
    let couplers = count(train.couplers.len(), "coupler");
    (over > 0).then(|| format!("the load is over the rating of {over} of {couplers} before anything happens"))
}

/// Couplers that are rated above the load that breaks them.
fn limit_order(train: &Train) -> Option<Doubt> {
    let rated = |c: &Coupler| [c.rated_draft_n, c.rated_buff_n];
    let above = |(limits, c): (&Limits, &Coupler)| -> Vec<usize> {
        let over = |side: &usize| limits.ultimate_n()[*side].is_some_and(|ultimate| rated(c)[*side] > ultimate);
        (0..2).filter(over).collect()
    };
    let sides = train.extras.limits.iter().zip(&train.couplers).map(above);
    let found: Vec<(usize, Vec<usize>)> = sides.enumerate().filter(|(_, sides)| !sides.is_empty()).collect();
    let (first, senses) = found.first()?;
    let sense = SENSES[senses[0]];
    let others = if found.len() > 1 { format!(", and of {} more", found.len() - 1) } else { String::new() };
    let text = format!(
        "the rating of coupler {} in {sense} is above its ultimate load in {sense}{others}: a coupler would break before it \
         reaches its rating; check both, or give limits.draft and limits.buff apart",
        first + 1
    );
    Some(Doubt::of_train("limit-order", text))
}

fn lengths(train: &Train) -> Option<Doubt> {
    let live = train.vehicles.iter().filter(|v| !v.held);
    let (with, without) = live.partition::<Vec<_>, _>(|v| v.length_m.is_some());
    let what = count(without.len(), "vehicle");
    let text = format!("no length is given for {what}, so there are no speeds in m/s and no places along the train");
    (!with.is_empty() && !without.is_empty()).then(|| Doubt::of_train("some-lengths", text))
}

/// " (and 3 more couplers)"; empty for none.
pub(crate) fn more(others: usize, thing: &str) -> String {
    if others == 0 {
        String::new()
    } else {
        format!(" (and {others} more {thing}{})", if others == 1 { "" } else { "s" })
    }
}
