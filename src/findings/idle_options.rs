//! Options that do nothing for a train.

use super::{Options, limits, march};
use crate::scenario::{Motion, is_proportional};
use crate::train::{Event, Scenario, Train};

/// What to tell of options that are given and change nothing, scenario by scenario: one sentence each without its full stop.
pub fn idle_options(train: &Train, options: &Options) -> Vec<String> {
    let chosen = train.scenarios().iter().filter(|s| options.scenario.as_ref().is_none_or(|name| *name == s.name));
    chosen.flat_map(|s| of_scenario(train, s, options).into_iter().map(|text| format!("{}: {text}", s.name))).collect()
}

fn of_scenario(train: &Train, scenario: &Scenario, options: &Options) -> Vec<String> {
    let mut told = vec![];
    if options.map && matches!(scenario.event, Event::Impact { .. }) {
        let factor = match is_proportional(train, scenario) {
            true => "its safe factor on the speed",
            false => "the factor on its speed from which couplers exceed, which is searched for,",
        };
        told.push(format!("--map does nothing for an impact: {factor} says all that a map would"));
    }
    if !is_proportional(train, scenario) {
        let why = "forces with slack, friction or brakes are not proportional to their cause";
        let event = if train.extras().laws.is_empty() { "brakes and drives" } else { "couplers with slack or gears" };
        for (given, option) in [
            (options.map && !matches!(scenario.event, Event::Impact { .. }), "--map"),
            (options.all_time_bound, "--all-time-bound"),
            (options.verdict_only, "--verdict-only"),
        ] {
            if given {
                told.push(format!("{option} does nothing for {event}: {why}"));
            }
        }
        if options.tolerance < march::TOLERANCE && options.tolerance != Options::default().tolerance {
            let [asked, least] = [options.tolerance, march::TOLERANCE];
            told.push(format!("--tolerance {asked:e} is taken as {least:e}, the least for {event}"));
        }
        return told;
    }
    let damped = train.extras().damping_ratio > 0.0;
    if options.verdict_only && limits::any_below_rating(train) {
        let why = "which of its limits a coupler passes below its rating is told by its largest force only";
        told.push(format!("--verdict-only leaves out no coupler of a train with limits under the ratings: {why}"));
    }
    if Motion::of(train, scenario) == Motion::Steps {
        return told;
    }
    let event = match &scenario.event {
        Event::Impact { .. } => "an impact",
        Event::Pulse(_) => "a pulse of this shape",
        _ if damped => "a train with a damping_ratio",
        _ => "a train with dashpots",
    };
    for (given, option) in [(options.all_time_bound, "--all-time-bound"), (options.verdict_only, "--verdict-only")] {
        if given {
            let why = "bounds over all time are known for undamped breaks and rectangular pulses only";
            told.push(format!("{option} does nothing for {event}: {why}"));
        }
    }
    if options.tolerance != Options::default().tolerance {
        told.push(format!("--tolerance does nothing for {event}: its forces are always computed to within rounding"));
    }
    told
}
