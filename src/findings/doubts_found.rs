//! Doubts that only an analysis can find.

use std::collections::BTreeMap;

use super::{CaseFindings, CouplerFindings};
use crate::law::Law;
use crate::train::{Doubt, Scenario, Train, more};
use crate::units::{Dimension, shown, shown_time};

/// Every doubt that the cases of a scenario have.
pub fn found(train: &Train, scenario: &Scenario, cases: &[CaseFindings]) -> Vec<Doubt> {
    let doubts = [
        closing_gap(scenario, cases),
        not_predictable(scenario, cases),
        stops(train, scenario, cases),
        closing_gears(train, scenario, cases),
    ];
    doubts.into_iter().flatten().collect()
}

/// Gears that the event closes, where the load did not.
fn closing_gears(train: &Train, scenario: &Scenario, cases: &[CaseFindings]) -> Option<Doubt> {
    let over_n = |c: &CouplerFindings| {
        let Law::Gear { draft, buff, .. } = train.extras().laws.get(c.coupler - 1)? else { return None };
        let closed = |force_n: f64| force_n.abs() > if force_n < 0.0 { buff } else { draft }.closes_at_n();
        let largest = [c.peak_draft_n, c.peak_buff_n].into_iter().flatten().filter(|f| closed(*f)).map(f64::abs);
        largest.reduce(f64::max).filter(|_| !closed(c.initial_force_n))
    };
    let mut largest_n = BTreeMap::new();
    for (coupler, n) in cases.iter().flat_map(|case| &case.couplers).filter_map(|c| Some((c.coupler, over_n(c)?))) {
        let kept = largest_n.entry(coupler).or_insert(n);
        *kept = n.max(*kept);
    }
    let (coupler, n) = largest_n.iter().max_by(|a, b| a.1.total_cmp(b.1))?;
    let text = format!(
        "the gear of coupler {coupler}{} closes: the force goes to {}, over the last row of its table, and from there on depends on \
         solid_stiffness alone",
        more(largest_n.len() - 1, "coupler"),
        shown(train.origin().units, *n, Dimension::Force)
    );
    Some(Doubt::of_scenario("gear-closes", scenario, text))
}

/// The end of known forces, where small differences grow.
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
fn stops(train: &Train, scenario: &Scenario, cases: &[CaseFindings]) -> Option<Doubt> {
    let mut stops = cases.iter().filter_map(|c| Some((c.stopped_at_s?, c.stopped_vehicle?)));
    let first = stops.next()?;
    let others = stops.clone().count();
    let (at_s, vehicle) = stops.fold(first, |a, b| if b.0 < a.0 { b } else { a });
    let text = format!(
        "{} would come to a stand at {}{}: a standing vehicle is not computed, and nothing later is reported",
        train.place_of(vehicle),
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
        "the gap at coupler {coupler} closes at {}{after}: from then on its vehicles would push each other, which is not \
         computed, so that later results are not valid",
        shown_time(time_s)
    );
    Some(Doubt::of_scenario("gap-closes", scenario, text))
}
