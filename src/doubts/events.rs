//! Doubts about scenarios.

use std::ops::Range;

use super::overloaded;
use super::plausible::{brake_wave, faint_build_up};
use crate::law::Law;
use crate::scenario::{
    horizon_s, initial_force_n, is_proportional, last_change_s, longest_horizon_s, longest_transit_s,
};
use crate::train::{Doubt, Event, Pulse, PulseShape, Scenario, Train, more};
use crate::units::{Dimension, shown, shown_time, shown_time_up};

/// Above this acceleration, m/s2, a part of a train cannot be standing.
const MOVES_M_PER_S2: f64 = 0.05;
/// A record that starts or ends at more than this share of its largest force counts as cut off there.
const CUT: f64 = 0.01;

/// Every doubt about a scenario.
pub(super) fn of_scenario(train: &Train, scenario: &Scenario) -> Vec<Doubt> {
    let found = match &scenario.event {
        Event::Break { couplers } => breaks(train, scenario, couplers),
        Event::Pulse(of_event) => pulse(train, scenario, of_event),
        Event::Impact { .. } => impact(train, scenario),
        Event::Brake { .. } => vec![],
    };
    let of_application = |applied| [brake_wave(train, applied), faint_build_up(applied)];
    let applied = scenario.applications().flat_map(of_application).flatten();
    let found = found.into_iter().chain(applied).chain(changes(train, scenario)).chain(stands(train, scenario));
    let found = found.map(|(code, text)| Doubt::of_scenario(code, scenario, text));
    found.chain(short_horizon(train, scenario)).collect()
}

fn breaks(train: &Train, scenario: &Scenario, couplers: &[usize]) -> Vec<(&'static str, String)> {
    let mut found = vec![];
    let load = |b: usize| train.initial_force_n()[b];
    if train.couplers().len() == 1 && !couplers.is_empty() {
        found.push((
            "nothing-left",
            "the train has one coupler only: after its break there is none left to examine".to_owned(),
        ));
    } else if let [first, others @ ..] = &couplers.iter().filter(|&&b| load(b) == 0.0).collect::<Vec<_>>()[..] {
        let advice = if train.extras().steady.is_some() {
            "check the forces on the vehicles: a tractive_effort, a brake_force or a held vehicle may be missing"
        } else {
            "give [load] a uniform force"
        };
        found.push((
            "no-load",
            format!(
                "coupler {}{} carries no load, so its break changes nothing; {advice}",
                *first + 1,
                more(others.len(), "coupler")
            ),
        ));
    }
    let mut in_buff = couplers.iter().filter(|&&b| load(b) < 0.0);
    if let Some(first) = in_buff.next() {
        let which = format!("coupler {}{}", first + 1, more(in_buff.count(), "coupler"));
        let text = match !is_proportional(train, scenario) {
            true => {
                "carries buff: when it breaks its vehicles stay pressed together, and part once the force there turns to draft"
            }
            false => {
                "carries buff and breaks as if the parts could pass through each other; in a train they stay pressed together"
            }
        };
        found.push(("breaks-in-buff", format!("{which} {text}")));
    }
    let left_out = &scenario.left_out_in_buff;
    if let Some(first) = left_out.first() {
        let which = format!("coupler {}{}", first + 1, more(left_out.len() - 1, "coupler"));
        let text = format!(
            "{which} is left out: it carries buff, and its vehicles stay pressed together when it breaks; \
             buff_breaks = true computes it as if the parts could pass through each other"
        );
        found.push(("breaks-in-buff-left-out", text));
    }
    found
}

fn pulse(train: &Train, scenario: &Scenario, pulse: &Pulse) -> Vec<(&'static str, String)> {
    let mut found = vec![];
    let drive = pulse.drive();
    let (end_s, until_s) = (last_change_s(train, scenario, None), longest_horizon_s(train, scenario));
    if end_s > until_s {
        let [begins_s, peaks_s] = [drive.begins_at(), drive.peaks_at()];
        let unseen = if begins_s >= until_s {
            format!("begins after the horizon of {}, so it has no effect", shown_time(until_s))
        } else if peaks_s >= until_s {
            format!("has not reached its largest value at the horizon of {}", shown_time(until_s))
        } else {
            format!(
                "lasts longer than the horizon of {}, so the effect of its end is not computed",
                shown_time(until_s)
            )
        };
        let whole_s = horizon_s(train, &Scenario { horizon_s: None, ..scenario.clone() }, None);
        found.push((
            "pulse-beyond-horizon",
            format!("the pulse {unseen}; a horizon of {} covers it", shown_time_up(whole_s)),
        ));
        if train.vehicles().iter().all(|v| !v.held) {
            let text = "the force does not end within the horizon and no vehicle is held, so the whole train is accelerated all that time";
            found.push(("force-never-ends", format!("{text}; hold an end, or let the force end")));
        }
    }
    found.extend(super::plausible::faint_pulse(train, pulse.force_n));
    if let PulseShape::Record(_) = pulse.shape {
        let cut = |end_n: f64| {
            (end_n.abs() > CUT * pulse.force_n.abs()).then(|| shown(train.origin().units, end_n, Dimension::Force))
        };
        found.extend(cut(drive.first_force()).map(|force| {
            let text = format!(
                "the record starts at {force}, and the force jumps there from 0; begin it with a row of force 0"
            );
            ("record-starts-at-a-force", text)
        }));
        found.extend(cut(drive.last_force()).map(|force| {
            let end = shown_time(pulse.duration_s);
            let text = format!(
                "the record ends at {force}, and the force drops to 0 there, at {end}; end it with a row of force 0"
            );
            ("record-ends-at-a-force", text)
        }));
    }
    found
}

/// A train that the forces on its vehicles slow down, and bring to a stand before the horizon; not if brakes are
/// computed.
fn stands(train: &Train, scenario: &Scenario) -> Option<(&'static str, String)> {
    let extras = train.extras();
    let (speed, slowing) = (extras.speed_m_per_s?, -extras.steady.as_ref()?.acceleration_m_per_s2);
    let (at_s, until_s) = (speed / slowing, longest_horizon_s(train, scenario));
    let text = || {
        format!(
            "the forces on the vehicles bring the train to a stand at {}, before the horizon of {}; forces go on here as if it ran",
            shown_time(at_s),
            shown_time(until_s)
        )
    };
    (slowing > 0.0 && at_s < until_s && !scenario.applies_brakes()).then(|| ("train-stands", text()))
}

/// Brakes and tractive efforts that change nothing, or go on changing after the horizon.
fn changes(train: &Train, scenario: &Scenario) -> Option<(&'static str, String)> {
    let until_s = longest_horizon_s(train, scenario);
    let efforts = &scenario.response.efforts;
    if !efforts.is_empty() && efforts.iter().all(|f| f.points.iter().all(|p| p[1] == 0.0)) {
        let text = "the schedule of tractive efforts changes none of them, and so nothing";
        return Some(("efforts-unchanged", text.to_owned()));
    }
    let ends = match &scenario.event {
        Event::Break { couplers } => vec![couplers.iter().min().copied(), couplers.iter().max().copied()],
        Event::Brake { .. } => vec![None],
        Event::Pulse(_) | Event::Impact { .. } => return None,
    };
    let last_s = ends.into_iter().map(|b| last_change_s(train, scenario, b)).fold(0.0, f64::max);
    let text = || {
        format!(
            "brakes or tractive efforts go on changing until {}, after the horizon of {}: what that does is not seen",
            shown_time(last_s),
            shown_time(until_s)
        )
    };
    (last_s > until_s).then(|| ("changes-beyond-horizon", text()))
}

fn impact(train: &Train, scenario: &Scenario) -> Vec<(&'static str, String)> {
    let (mut found, units) = (vec![], train.origin().units);
    let before = initial_force_n(train, &scenario.event);
    found.extend(overloaded(train, &before).map(|text| ("load-over-rating", text)));
    let joint = scenario.event.joint(train.vehicles().len());
    let (Some(joint), Event::Impact { speed_m_per_s, at_head, .. }) = (joint, &scenario.event) else { return found };
    found.extend(super::plausible::fast_impact(train, *speed_m_per_s));
    found.extend(standing_part_moves(train, if *at_head { joint + 1..train.vehicles().len() } else { 0..joint + 1 }));
    let extras = train.extras();
    let loses = extras.laws.iter().any(Law::has_friction) || extras.dashpot_n_s_per_m.iter().any(|c| *c > 0.0);
    if !is_proportional(train, scenario) && !loses {
        let text = "no coupler absorbs work, so that the draft after the collision includes the whole rebound of the springs; a real \
                    draft gear absorbs up to 87 % of the work: give the couplers a gear";
        found.push(("elastic-rebound", text.to_owned()));
    }
    if let Some(&c) = extras.dashpot_n_s_per_m.get(joint).filter(|c| **c > 0.0) {
        let force = shown(units, c * speed_m_per_s, Dimension::Force);
        let text = format!(
            "at the instant of contact the dashpot of coupler {} carries {force}, its damping times the speed; the force of a real draft \
             gear starts at 0: compute the impact without damping as well",
            joint + 1
        );
        found.push(("dashpot-at-contact", text));
    }
    found
}

/// Vehicles that stand before an impact, and that the forces on them would move.
fn standing_part_moves(train: &Train, standing: Range<usize>) -> Option<(&'static str, String)> {
    let part = &train.vehicles()[standing.clone()];
    let mass_kg: f64 = part.iter().map(|v| v.mass_kg).sum();
    let force_n: f64 = train.extras().steady.as_ref()?.outside_n[standing].iter().sum();
    let text = || {
        format!(
            "the forces on the vehicles that stand come to {}, which would move them before the collision; check them (a brake holds a \
             standing vehicle and does not push it), or hold an end",
            shown(train.origin().units, force_n, Dimension::Force)
        )
    };
    let moves = part.iter().all(|v| !v.held) && force_n.abs() > MOVES_M_PER_S2 * mass_kg;
    moves.then(|| ("standing-part-moves", text()))
}

/// A horizon that ends before a wave has crossed the train, or, where the forces from outside have stopped changing, before the first
/// passage does.
fn short_horizon(train: &Train, scenario: &Scenario) -> Option<Doubt> {
    let (ends, what) = match &scenario.event {
        Event::Break { couplers } => ([couplers.iter().min(), couplers.iter().max()], "the longest part"),
        _ => ([None; 2], "the train"),
    };
    let longest_s = |of: &dyn Fn(Option<usize>) -> f64| ends.iter().map(|b| of(b.copied())).fold(0.0, f64::max);
    let transit_s = longest_s(&|b| longest_transit_s(train, b));
    let change_s = longest_s(&|b| last_change_s(train, scenario, b));
    let passage_s = longest_s(&|b| last_change_s(train, scenario, b) + 2.0 * longest_transit_s(train, b));
    let horizon_s = longest_horizon_s(train, scenario);
    let [horizon, transit, passage] = [horizon_s, transit_s, passage_s].map(shown_time);
    if horizon_s < transit_s {
        let text = format!("the horizon of {horizon} ends before a wave has crossed {what}, {transit}");
        return Some(Doubt::of_scenario("short-horizon", scenario, text));
    }
    // A horizon before the last change of the outside force is reported by `pulse` and `changes`.
    let within = scenario.horizon_s.is_some() && (change_s..passage_s).contains(&horizon_s);
    let text =
        format!("the horizon of {horizon} ends before the first passage does, at {passage}: a larger force can follow");
    within.then(|| Doubt::of_scenario("horizon-in-first-passage", scenario, text))
}
