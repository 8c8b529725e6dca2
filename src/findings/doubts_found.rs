//! Doubts that only an analysis can find.

use super::CaseFindings;
use crate::train::{Doubt, Scenario, more};
use crate::units::shown_time;

/// Every doubt that the cases of a scenario have.
pub fn found(scenario: &Scenario, cases: &[CaseFindings]) -> Vec<Doubt> {
    [closing_gap(scenario, cases), not_predictable(scenario, cases), stops(scenario, cases)]
        .into_iter()
        .flatten()
        .collect()
}

/// The end of what can be told of a motion in which small differences grow.
fn not_predictable(scenario: &Scenario, cases: &[CaseFindings]) -> Option<Doubt> {
    let mut ends = cases.iter().filter_map(|c| c.predictable_until_s);
    let first = ends.next()?;
    let at = shown_time(ends.clone().fold(first, f64::min));
    let text = format!(
        "forces are reported up to {at} only{}: from then on small differences grow beyond the error that was asked for; with a \
         larger --tolerance, or more friction at small forces, forces are reported for longer",
        more(ends.count(), "case")
    );
    Some(Doubt::of_scenario("not-predictable", scenario, text))
}

/// A vehicle that its brakes would bring to a stand.
fn stops(scenario: &Scenario, cases: &[CaseFindings]) -> Option<Doubt> {
    let mut stops = cases.iter().filter_map(|c| Some((c.stopped_at_s?, c.stopped_vehicle?)));
    let first = stops.next()?;
    let others = stops.clone().count();
    let (at_s, vehicle) = stops.fold(first, |a, b| if b.0 < a.0 { b } else { a });
    let text = format!(
        "vehicle {vehicle} would come to a stand at {}{}: a standing vehicle is not computed, and nothing later is reported",
        shown_time(at_s),
        more(others, "case")
    );
    Some(Doubt::of_scenario("vehicle-stops", scenario, text))
}

/// A gap at a broken coupler that closes in one of these cases of a scenario: what comes later is not computed.
fn closing_gap(scenario: &Scenario, cases: &[CaseFindings]) -> Option<Doubt> {
    let closes = |c: &CaseFindings| Some((c.cascade.as_ref()?.gap_closes_s?, c.cascade.as_ref()?.gap_coupler?));
    let mut closing = cases.iter().filter_map(|c| Some((closes(c)?, c.broken_coupler)));
    let ((time_s, coupler), broken) = closing.next()?;
    let after = match broken.filter(|_| cases.len() > 1) {
        Some(broken) => format!(" after the break of coupler {broken}{}", more(closing.count(), "case")),
        None => String::new(),
    };
    let text = format!(
        "the gap at coupler {coupler} closes at {}{after}: its vehicles would push each other from then on, which is not \
         computed, so that nothing later holds",
        shown_time(time_s)
    );
    Some(Doubt::of_scenario("gap-closes", scenario, text))
}
