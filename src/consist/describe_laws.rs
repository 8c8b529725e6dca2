//! Couplers with slack and gears, and what brakes and drives do, in words.

use crate::law::{Curve, Law};
use crate::train::{Application, Event, Rule, Scenario, Train, count};
use crate::units::{Dimension, UnitSystem, shown, shown_time};

/// The laws of couplers that are not linear, each kind once with what it does at the load; empty where all are linear.
pub(crate) fn laws(train: &Train) -> Vec<String> {
    let mut kinds: Vec<(Vec<usize>, &Law)> = vec![];
    for (i, law) in train.extras().laws.iter().enumerate() {
        match kinds.iter_mut().find(|(_, known)| *known == law) {
            Some((couplers, _)) => couplers.push(i),
            None => kinds.push((vec![i], law)),
        }
    }
    kinds.into_iter().map(|(couplers, law)| line(train, &couplers, law)).collect()
}

fn line(train: &Train, couplers: &[usize], law: &Law) -> String {
    let which = match couplers {
        _ if couplers.len() == train.couplers().len() => "every coupler".to_owned(),
        [one] => format!("coupler {}", one + 1),
        [first, .., last] => format!("{} couplers from {} to {}", couplers.len(), first + 1, last + 1),
        [] => String::new(),
    };
    let units = train.origin().units;
    let length = |m: f64| shown(units, m, Dimension::Length);
    let slack = match law.slack_m() {
        0.0 => "no slack".to_owned(),
        s => format!("slack {}", length(s)),
    };
    format!("{which}: {}, {slack}{}", kind(law, units), at_the_load(train, couplers, law))
}

fn kind(law: &Law, units: UnitSystem) -> String {
    let stiffness = |k: f64| shown(units, k, Dimension::Stiffness);
    match law {
        Law::Elastic { draft_n_per_m, buff_n_per_m, .. } if draft_n_per_m == buff_n_per_m => {
            format!("a spring of {}", stiffness(*draft_n_per_m))
        }
        Law::Elastic { draft_n_per_m, buff_n_per_m, .. } => {
            format!("a spring of {} in draft, {} in buff", stiffness(*draft_n_per_m), stiffness(*buff_n_per_m))
        }
        Law::Gear { solid_n_per_m, draft, buff, .. } if draft == buff => {
            format!("a gear in series with {} (it {})", stiffness(*solid_n_per_m), gear(draft, units))
        }
        Law::Gear { solid_n_per_m, draft, buff, .. } => {
            let [draft, buff, solid] = [gear(draft, units), gear(buff, units), stiffness(*solid_n_per_m)];
            format!("a gear in series with {solid} (in draft it {draft}; in buff it {buff})")
        }
    }
}

/// Stroke, closing force, work, and the share of the work that is lost.
fn gear(curve: &Curve, units: UnitSystem) -> String {
    format!(
        "closes after {} at {}, and a full stroke takes {}, of which {:.0} % is lost",
        shown(units, curve.stroke_m(), Dimension::Length),
        shown(units, curve.closes_at_n(), Dimension::Force),
        units.energy(curve.absorbed_j()),
        100.0 * curve.lost_share()
    )
}

/// The travel of the couplers at the load, from the end of the slack, and the pull from which they were let down.
fn at_the_load(train: &Train, couplers: &[usize], law: &Law) -> String {
    let load = |&i: &usize| train.initial_force_n()[i];
    let Some(&most) = couplers.iter().max_by(|a, b| load(a).abs().total_cmp(&load(b).abs())) else {
        return String::new();
    };
    let (force_n, units) = (train.initial_force_n()[most], train.origin().units);
    let rest = law.rest(&train.history_n(most));
    if force_n == 0.0 {
        let slack = match law.elongation_m(&rest) {
            _ if law.slack_m() == 0.0 => "",
            0.0 => ", so it starts in the middle of its slack",
            _ => ", let down from a pull, so it starts at the end of its slack",
        };
        return format!("; no load before the event{slack}");
    }
    let travel_m = law.elongation_m(&rest).abs() - 0.5 * law.slack_m();
    let from = train
        .extras()
        .pulled_to_n
        .get(most)
        .filter(|_| force_n > 0.0)
        .map_or(String::new(), |n| format!(", let down from {}", shown(units, *n, Dimension::Force)));
    let sense = if force_n < 0.0 { "buff" } else { "draft" };
    let [travel, force] = [shown(units, travel_m, Dimension::Length), shown(units, force_n.abs(), Dimension::Force)];
    format!("; at {force} in {sense}{from}, the connection is {travel} beyond the slack")
}

/// Longer build-ups show their last point only.
const POINTS: usize = 8;

/// A brake application in words: name, wave and brake force.
pub(crate) fn application(of: &Application, units: UnitSystem) -> String {
    let named = of.name.map_or(String::new(), |name| format!("{name}: "));
    let point = |p: &[f64; 2]| format!("{} after {}", shown(units, p[1], Dimension::Share), shown_time(p[0]));
    // A named or long build-up shows its last point only, others all but the first, which is 0.
    let skipped = if of.name.is_some() || of.build_up.len() > POINTS { of.build_up.len().saturating_sub(1) } else { 1 };
    let course: Vec<String> = of.build_up.iter().skip(skipped).map(point).collect();
    format!("{named}wave {}, brake force {}", units.wave_speed(of.wave_m_per_s), course.join(", "))
}

/// What a scenario's brakes and drives do beside its event: a clause that starts with `; `, or nothing.
pub(super) fn response(train: &Train, scenario: &Scenario) -> String {
    let (mut text, units) = (String::new(), train.origin().units);
    if let Some(emergency) = &scenario.response.emergency {
        text += &format!("; each parting sets off emergency brakes both ways ({})", application(emergency, units));
    }
    if let (Event::Brake { emergency, .. }, true) = (&scenario.event, scenario.cascade != Rule::Keep) {
        text += match emergency {
            true => "; each parting sets off these brakes too, both ways from where it is",
            false => {
                "; a parting sets off no emergency brakes, because a service application gives none: in a train it does"
            }
        };
    }
    let efforts = &scenario.response.efforts;
    let ends = |of: fn(&[[f64; 2]]) -> Option<&[f64; 2]>| efforts.iter().filter_map(move |f| of(&f.points));
    let [first_s, last_s] =
        [ends(<[_]>::first).map(|p| p[0]).reduce(f64::min), ends(<[_]>::last).map(|p| p[0]).reduce(f64::max)];
    if let (Some(first_s), Some(last_s)) = (first_s, last_s) {
        let by_n: f64 = ends(<[_]>::last).map(|p| p[1]).sum();
        text += &format!(
            "; the tractive effort of {} changes from {} to {}, by {} in all",
            count(efforts.len(), "vehicle"),
            shown_time(first_s),
            shown_time(last_s),
            shown(units, by_n, Dimension::Force)
        );
    }
    if let Some(speed) = train.extras().speed_m_per_s.filter(|_| scenario.applies_brakes()) {
        text += &format!("; the train runs at {}", shown(units, speed, Dimension::Speed));
    }
    text
}

/// The same as sentences of a report.
pub(crate) fn response_sentences(train: &Train, scenario: &Scenario) -> String {
    let sentence = |clause: &str| {
        let mut letters = clause.chars();
        letters.next().map_or(String::new(), |first| format!(" {}{}.", first.to_uppercase(), letters.as_str()))
    };
    response(train, scenario).split("; ").filter(|clause| !clause.is_empty()).map(sentence).collect()
}

/// Where an application starts: "the head", "both ends", "vehicle 12 (car 11)".
pub(crate) fn place(train: &Train, from: &[usize]) -> String {
    match from {
        [0] => "the head".to_owned(),
        [v] if v + 1 == train.vehicles().len() => "the tail".to_owned(),
        [v] => format!("vehicle {} ({})", v + 1, train.vehicles()[*v].label),
        _ => "both ends".to_owned(),
    }
}
