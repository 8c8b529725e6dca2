//! The worst case of a scenario on the same train with one change: what the report says of losses, gears, slack and brakes.

use super::numbers::{Unit, digits, force_in, force_unit, percent, time};
use super::words;
use crate::findings::variants::{GENERIC_SLACK_M, LET_DOWN};
use crate::findings::{CaseFindings, Changed, CouplerFindings, ScenarioFindings, Variant, VariantFindings};
use crate::units::{Dimension, UnitSystem, rounded};

/// What the table of losses is of.
pub fn losses_lead(scenario: &ScenarioFindings) -> String {
    format!(
        "{} with dashpots in every coupler (published models of draft gears have ratios of 0.14 to 0.26)",
        same_event(scenario)
    )
}

/// The event that is computed again, as the beginning of a sentence.
fn same_event(scenario: &ScenarioFindings) -> String {
    let broken = words::worst_case(scenario).and_then(|(case, _)| case.broken_coupler);
    match broken.filter(|_| scenario.cases.len() > 1) {
        Some(b) => format!("The break of coupler {b}, the worst of these,"),
        None => "The same event".to_owned(),
    }
}

/// The worst case without losses and with dashpots of each ratio.
pub fn losses(scenario: &ScenarioFindings, units: UnitSystem) -> Vec<Vec<String>> {
    let Some((case, worst)) = words::worst_case(scenario).filter(|_| !scenario.damping.is_empty()) else {
        return Vec::new();
    };
    let given = as_given(case, worst);
    let unit = unit_of(std::iter::once(&given).chain(scenario.damping.iter().map(|d| &d.found)), units);
    let with = scenario.damping.iter().map(|d| row(d.damping_ratio.to_string(), &d.found, unit));
    std::iter::once(row("0".to_owned(), &given, unit)).chain(with).collect()
}

/// The worst case as given, and of each variant.
pub fn rows(scenario: &ScenarioFindings, units: UnitSystem) -> Vec<Vec<String>> {
    let Some((case, worst)) = words::worst_case(scenario).filter(|_| !scenario.variants.is_empty()) else {
        return Vec::new();
    };
    let given = as_given(case, worst);
    let unit = unit_of(std::iter::once(&given).chain(scenario.variants.iter().map(|v| &v.found)), units);
    let with = scenario.variants.iter().map(|v| row(name(v.variant, units), &v.found, unit));
    std::iter::once(row("as given".to_owned(), &given, unit)).chain(with).collect()
}

/// What the table of variants is of, and what is left of the overload of linear couplers.
pub fn sentences(scenario: &ScenarioFindings) -> String {
    let Some((_, worst)) = words::worst_case(scenario).filter(|_| !scenario.variants.is_empty()) else {
        return String::new();
    };
    let generic = |v: &VariantFindings| matches!(v.variant, Variant::GenericGears | Variant::GenericGearsAndSlack);
    let mut text = format!("{} on the same train with one change.", same_event(scenario));
    let given = worst.utilisation;
    let linear = scenario.variants.iter().find(|v| v.variant == Variant::LinearCouplers);
    if let Some(linear) = linear.map(|v| v.found.utilisation) {
        let [of_linear, own] = [linear, given].map(percent);
        text += &match (linear > 1.0, given > 1.0) {
            (true, false) => {
                format!(
                    " Linear couplers without slack would be overloaded ({of_linear} % of a rating); the couplers of this train are not ({own} %)."
                )
            }
            (true, true) => {
                let left = digits(100.0 * (given - 1.0) / (linear - 1.0), 0.0, 3);
                format!(
                    " Linear couplers without slack would reach {of_linear} % of a rating, those of this train reach {own} %: the part over \
                     100 % is {left} % of that of linear couplers."
                )
            }
            (false, true) => {
                format!(
                    " Linear couplers without slack would not be overloaded ({of_linear} % of a rating); the couplers of this train are ({own} %)."
                )
            }
            (false, false) => {
                format!(
                    " Linear couplers without slack would reach {of_linear} % of a rating, those of this train reach {own} %."
                )
            }
        };
    }
    let largest = scenario
        .variants
        .iter()
        .filter(|v| generic(v))
        .reduce(|a, b| if b.found.utilisation > a.found.utilisation { b } else { a });
    if let Some(of) = largest.map(|v| &v.found) {
        let in_sense = |c: &CouplerFindings| {
            if of.peak_force_n < 0.0 {
                -c.peak_buff_n.unwrap_or(0.0) / c.rated_buff_n
            } else {
                c.peak_draft_n.unwrap_or(0.0) / c.rated_draft_n
            }
        };
        let given =
            words::worst_case(scenario).map_or(0.0, |(case, _)| case.couplers.iter().map(in_sense).fold(0.0, f64::max));
        text += &format!(
            " With generic friction gears the largest share of a rating in {} is {} %, {} % of this train.",
            words::sense(of.peak_force_n),
            percent(of.utilisation),
            if of.utilisation > given { "more than the " } else { "not more than the " }.to_owned() + &percent(given)
        );
    }
    if scenario.variants.iter().any(generic) {
        text += " The gears of this table are generic, a pair of North American friction gears in every coupler and no maker's curve: \
                 they show in which direction gears change the result, not by how much in this train.";
    }
    text
}

fn name(variant: Variant, units: UnitSystem) -> String {
    match variant {
        Variant::LinearCouplers => "linear couplers of the mean stiffness in loading, no slack".to_owned(),
        Variant::WithoutBrakes => "without the brakes and the change of tractive effort".to_owned(),
        Variant::LetDown => format!("let down to its load from {LET_DOWN} times the load"),
        Variant::GenericGears => "generic friction gears".to_owned(),
        Variant::GenericGearsAndSlack => {
            format!("generic friction gears and {} of slack", rounded(units, GENERIC_SLACK_M, Dimension::Length))
        }
    }
}

fn as_given(case: &CaseFindings, worst: &CouplerFindings) -> Changed {
    Changed {
        exceeding: case.exceeding,
        coupler: worst.coupler,
        peak_force_n: worst.peak_force_n,
        peak_time_s: worst.peak_time_s,
        utilisation: worst.utilisation,
        error_bound_n: Some(case.error_bound_n).filter(|n| n.is_finite()),
        error_estimate_n: case.error_estimate_n,
    }
}

/// One unit for the forces of a column.
fn unit_of<'a>(of: impl Iterator<Item = &'a Changed>, units: UnitSystem) -> Unit {
    force_unit(units, of.map(|c| c.peak_force_n.abs()).fold(0.0, f64::max))
}

fn row(first: String, of: &Changed, unit: Unit) -> Vec<String> {
    let error_n = of.error_bound_n.or(of.error_estimate_n).unwrap_or(0.0);
    let size = format!("{} in {}", force_in(unit, of.peak_force_n, error_n), words::sense(of.peak_force_n));
    let share = format!("{} %", percent(of.utilisation));
    vec![first, of.exceeding.to_string(), of.coupler.to_string(), size, share, time(of.peak_time_s)]
}
