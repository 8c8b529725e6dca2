//! What in a train or scenario is probably not meant. A doubt stops nothing; every command tells the same ones, from this one list.

use std::fmt;

use serde::Serialize;

use crate::consist::{Coupler, Limits, SENSES, Train, count};
use crate::scenario::{Event, Scenario, longest_horizon_s};
use crate::units::{Dimension, shown};

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
    found.extend(overloaded(train));
    found.extend(limit_order(train));
    found.extend(lengths(train));
    for scenario in &train.scenarios {
        found.extend(of_scenario(train, scenario));
    }
    found
}

fn overloaded(train: &Train) -> Option<Doubt> {
    let over = |(force, c): &(&f64, &Coupler)| **force > c.rated_draft_n || -**force > c.rated_buff_n;
    let over = train.initial_force_n.iter().zip(&train.couplers).filter(over).count();
    let couplers = count(train.couplers.len(), "coupler");
    let text = format!("the load is over the rating of {over} of {couplers} before anything happens");
    (over > 0).then(|| Doubt::of_train("load-over-rating", text))
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

fn of_scenario(train: &Train, scenario: &Scenario) -> Vec<Doubt> {
    let mut found = vec![];
    let mut doubt = |code, text: String| found.push(Doubt::of_scenario(code, scenario, text));
    let default = Scenario { horizon_s: None, ..scenario.clone() };
    let transit_s = longest_horizon_s(train, &default) / 4.0;
    let horizon_s = longest_horizon_s(train, scenario);
    match &scenario.event {
        Event::Break { .. } if train.couplers.len() == 1 => {
            let text = "once its only coupler is broken the train has none left to look at";
            doubt("nothing-left", text.to_owned());
        }
        Event::Break { couplers } if couplers.iter().any(|&b| train.initial_force_n[b] == 0.0) => {
            let text = "a coupler without load breaks and nothing changes; give [load] a uniform force";
            doubt("no-load", text.to_owned());
        }
        Event::Pulse { duration_s, .. } | Event::Shaped { duration_s, .. } if *duration_s > horizon_s => {
            let text = "the pulse outlasts the horizon, so what its end does is not seen";
            doubt("pulse-beyond-horizon", text.to_owned());
        }
        _ => {}
    }
    if horizon_s < transit_s {
        let [horizon, transit] = [horizon_s, transit_s].map(|t| shown(t, Dimension::Time));
        let what = if scenario.event.kind() == "break" { "the longest part" } else { "the train" };
        doubt("short-horizon", format!("the horizon of {horizon} ends before a wave has crossed {what}, {transit}"));
    }
    found
}
