//! Words and short sentences of findings: plain text, shared by the report and the terminal.

use super::numbers::{digits, down, down_to, percent, time};
use crate::findings::{self, CaseFindings, CouplerFindings, LoadSearch, ScenarioFindings};
pub(crate) use crate::train::count;
use crate::train::{Event, Scenario, Train};
use crate::units::UnitSystem;

/// The scenario of the train that a scenario of findings was made from, with its index.
pub fn source<'a>(train: &'a Train, findings: &ScenarioFindings) -> Option<(usize, &'a Scenario)> {
    train.scenarios().iter().enumerate().find(|(_, s)| s.name == findings.name)
}

/// "draft" or "buff", the sign of a force in the railway's words.
pub fn sense(force_n: f64) -> &'static str {
    if force_n < 0.0 { "buff" } else { "draft" }
}

/// The rating that a coupler's peak force is measured against, N.
pub fn rating(c: &CouplerFindings) -> f64 {
    if c.peak_force_n < 0.0 { c.rated_buff_n } else { c.rated_draft_n }
}

/// "coupler 12 (between ore car 11 and ore car 12)".
pub fn place(c: &CouplerFindings) -> String {
    format!("coupler {} (between {} and {})", c.coupler, c.between[0], c.between[1])
}

/// What t = 0 is: "after the break" or "after the force sets in".
pub fn since(case: &CaseFindings) -> &'static str {
    match case.kind {
        "break" => "after the break",
        "impact" => "after the vehicles meet",
        "brake" => "after the brakes are applied",
        _ if case.is_record => "after the record starts",
        _ => "after the force sets in",
    }
}

/// What a time axis counts.
pub fn time_axis(case: &CaseFindings) -> &'static str {
    match case.kind {
        "break" => "time after the break",
        "impact" => "time since the vehicles met",
        "brake" => "time since the brakes were applied",
        _ if case.is_record => "time since the record started",
        _ => "time since the force set in",
    }
}

/// The couplers that exceed, worst first.
pub fn exceeding(case: &CaseFindings) -> Vec<&CouplerFindings> {
    let mut found: Vec<_> = case.couplers.iter().filter(|c| c.exceeds == Some(true)).collect();
    found.sort_by(|a, b| b.utilisation.total_cmp(&a.utilisation).then(a.coupler.cmp(&b.coupler)));
    found
}

/// The coupler that is the first over its rating; of several at once the worst.
pub fn first_to_exceed(case: &CaseFindings) -> Option<&CouplerFindings> {
    let time_of = |c: &CouplerFindings| c.first_exceeds_s.unwrap_or(f64::INFINITY);
    exceeding(case).into_iter().reduce(|a, b| if time_of(b) < time_of(a) { b } else { a })
}

/// The couplers for which the answer is open, worst first.
pub fn undecided(case: &CaseFindings) -> Vec<&CouplerFindings> {
    let mut found: Vec<_> = case.couplers.iter().filter(|c| c.exceeds.is_none()).collect();
    found.sort_by(|a, b| b.utilisation.total_cmp(&a.utilisation).then(a.coupler.cmp(&b.coupler)));
    found
}

/// "4.010 s after the break".
pub fn moment(time_s: f64, case: &CaseFindings) -> String {
    if time_s == 0.0 { "at t = 0".to_owned() } else { format!("{} {}", time(time_s), since(case)) }
}

/// The interval in which a peak force lies, with the digits that it takes to tell its ends apart.
pub fn interval(c: &CouplerFindings, error_n: f64, unit: super::numbers::Unit) -> String {
    let [low, high] = super::numbers::interval(c.peak_force_n.abs() / unit.size, error_n / unit.size);
    format!("between {low} {name} and {high} {name} in {}", sense(c.peak_force_n), name = unit.name)
}

/// What a map over the coupler that breaks says in one sentence: which break leaves the smallest safe load; empty without one.
pub fn map_of_breaks(scenario: &ScenarioFindings) -> String {
    let points = scenario.map.iter().filter(|m| m.over == "broken_coupler").flat_map(|m| &m.points);
    let bounded = points.filter_map(|p| Some((p.at, p.chain?)));
    let Some((at, factor)) = bounded.reduce(|a, b| if b.1 < a.1 { b } else { a }) else { return String::new() };
    format!(
        "Of all couplers that can part, coupler {at} is the worst to break: no coupler would be overloaded up to {} % of this load.",
        down(100.0 * factor)
    )
}

/// The case whose worst coupler has the largest utilisation, with that coupler.
pub fn worst_case(scenario: &ScenarioFindings) -> Option<(&CaseFindings, &CouplerFindings)> {
    findings::worst_case(&scenario.cases)
}

/// What a safe factor multiplies: the load, a pulse's force, an impact's speed.
pub fn cause(event: &Event) -> &'static str {
    match event {
        Event::Pulse(_) => "force",
        Event::Impact { .. } => "speed",
        Event::Break { .. } => "load",
        Event::Brake { .. } => "brake force",
    }
}

/// What the safe load factor means, in one sentence.
pub fn safe_load(
    train: &Train,
    event: &Event,
    factor: Option<f64>,
    none: Option<&str>,
    search: Option<LoadSearch>,
) -> String {
    let cause = cause(event);
    if let Some(why) = none {
        let search = search.map_or_else(|| " Vary it in a study.".to_owned(), |s| searched(cause, &s));
        return format!("There is no safe {cause} factor: {why}.{search}");
    }
    let what = match event {
        Event::Break { .. } if train.initial_force_n().iter().all(|&f| f >= 0.0) => "pull",
        Event::Break { .. } if train.initial_force_n().iter().all(|&f| f <= 0.0) => "push",
        _ => cause,
    };
    match factor {
        None => format!("Nothing bounds the {cause}: no force in any coupler grows with it."),
        Some(0.0) => format!("Some coupler is at or over its rating however small the {cause} is."),
        Some(f) => {
            let share = down(100.0 * f);
            format!(
                "No coupler would be overloaded if the {what} were {share} % of this, or less (safe {cause} factor {}).",
                down(f)
            )
        }
    }
}

/// The rating that the worst coupler would need; empty where none exceeds.
pub fn needed(scenario: &ScenarioFindings, units: UnitSystem) -> String {
    let over = worst_case(scenario).filter(|(_, worst)| worst.exceeds == Some(true));
    over.map_or(String::new(), |(case, worst)| {
        format!(
            " To carry this event, the worst coupler, coupler {}, needs a rating above {} (now {}).",
            worst.coupler,
            enough(worst, case.margin_n(), super::numbers::force_unit(units, worst.peak_force_n)),
            super::numbers::given_force_in(super::numbers::force_unit(units, worst.peak_force_n), rating(worst))
        )
    })
}

/// The ratings that a coupler needs in the senses in which its largest force, with its error, is over the rating: "1.509 MN in draft".
pub fn enough(c: &CouplerFindings, error_n: f64, unit: super::numbers::Unit) -> String {
    let senses = [(c.peak_draft_n, c.rated_draft_n), (c.peak_buff_n, c.rated_buff_n)];
    let senses = senses.into_iter().filter_map(|(peak_n, rated_n)| Some((peak_n?, rated_n)));
    let over = senses.filter(|(peak_n, rated_n)| peak_n.abs() + error_n > *rated_n);
    let needed = over.map(|(peak_n, _)| {
        format!("{} {} in {}", super::numbers::up((peak_n.abs() + error_n) / unit.size), unit.name, sense(peak_n))
    });
    needed.collect::<Vec<_>>().join(", ")
}

/// What a search for the factor at which couplers begin to exceed has found.
fn searched(cause: &str, search: &LoadSearch) -> String {
    let LoadSearch { none_exceeds_at, exceeds_at, tried } = *search;
    let at = |factor: f64| down(100.0 * factor);
    // Both shares with the digits that tell them apart.
    let apart = |low: f64, high: f64| {
        let both = |most: i32| [down_to(100.0 * low, most), digits(100.0 * high, 0.0, most)];
        (3..17).map(both).find(|[a, b]| a != b).unwrap_or_else(|| both(17))
    };
    match exceeds_at {
        None => format!(
            " {tried} factors up to {} % of the {cause} were tried, and no coupler exceeded its rating at any of them. Factors between them were not tried.",
            at(none_exceeds_at)
        ),
        Some(over) if none_exceeds_at == 0.0 => {
            format!(
                " A coupler exceeded its rating at {} % of the {cause}, the smallest share that was tried.",
                at(over)
            )
        }
        Some(over) => {
            let [none, some] = apart(none_exceeds_at, over);
            format!(
                " {tried} factors were tried: no coupler exceeded its rating up to {none} % of the {cause}, and one did at {some} %. Factors \
                 between them were not tried."
            )
        }
    }
}

/// The chain and the rod side by side, in one sentence; empty where there is no rod.
pub fn rod(scenario: &ScenarioFindings) -> String {
    let cases: Vec<_> = scenario.cases.iter().filter_map(|c| Some((c, c.rod.as_ref()?))).collect();
    let Some(largest) = cases.iter().map(|(_, rod)| rod.utilisation).reduce(f64::max) else { return String::new() };
    let by_chain = |c: &CaseFindings| c.worst.as_ref().map_or(0.0, |w| w.utilisation);
    let chain_largest = cases.iter().map(|(c, _)| by_chain(c)).fold(0.0, f64::max);
    let rod: usize = cases.iter().map(|(_, rod)| rod.exceeding).sum();
    let chain: usize = cases.iter().map(|(c, _)| c.exceeding).sum();
    let (lead, over) = match (scenario.cases.len(), &cases[..]) {
        (1, _) => (String::new(), String::new()),
        (all, some) if all == some.len() => (String::new(), format!(", summed over all {all} breaks")),
        (all, [(only, _)]) => {
            let broken = only.broken_coupler.unwrap_or_default();
            (
                format!(
                    "For the break of coupler {broken}, the only one of {all} that leaves parts of equal vehicles and couplers: "
                ),
                String::new(),
            )
        }
        (all, some) => {
            let lead =
                format!("For the {} of {all} breaks that leave parts of equal vehicles and couplers: ", some.len());
            (lead, ", summed over them".to_owned())
        }
    };
    let an = if lead.is_empty() { "An" } else { "an" };
    let overloads = |n: usize| if n == 0 { "no coupler".to_owned() } else { count(n, "coupler") };
    format!(
        "{lead}{an} elastic rod of the same mass and stiffness reaches a utilisation of {} % and overloads {}, the chain reaches {} % and \
         overloads {}{over}.",
        percent(largest),
        overloads(rod),
        percent(chain_largest),
        overloads(chain)
    )
}
