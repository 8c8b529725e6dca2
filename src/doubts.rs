//! What in a train or scenario is probably not meant. A doubt stops nothing; every command tells the same ones, from this one list.

mod events;
mod options;
mod plausible;

use std::fmt;

use serde::Serialize;

use crate::consist::{Coupler, Train, count};
use crate::scenario::Scenario;

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
    found.extend(lengths(train));
    found.extend(plausible::of_train(train));
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
