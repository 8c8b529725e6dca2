//! What is probably not meant, and the words that doubts and descriptions share.

use std::fmt;

use serde::Serialize;

use super::Scenario;

/// Something that is probably not meant.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[non_exhaustive]
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

/// A number of things, in English.
pub(crate) fn count(number: usize, thing: &str) -> String {
    format!("{number} {thing}{}", if number == 1 { "" } else { "s" })
}

/// " (and 3 more couplers)"; empty for none.
pub(crate) fn more(others: usize, thing: &str) -> String {
    if others == 0 {
        String::new()
    } else {
        format!(" (and {others} more {thing}{})", if others == 1 { "" } else { "s" })
    }
}
