//! The facts of one scenario, ready for the template: every value is text.

use std::collections::BTreeMap;

use serde::Serialize;

use super::cascade;
use super::limits;
use super::markdown::Picture;
use super::numbers::{brief_time, down, force, force_unit, given_force_in, percent, small_force, time};
use super::{variants, words};
use crate::findings::{CaseFindings, CouplerFindings, ScenarioFindings};
use crate::train::Train;
use crate::units::UnitSystem;

/// Rows of a table in the report; the CSV has the rest.
const ROWS: usize = 20;

/// Rows of the table of all breaks.
const BREAKS: usize = 400;

/// What the report says of one scenario; what a scene does not need is empty.
#[derive(Serialize)]
pub struct Section {
    heading: String,
    event: String,
    verdict: String,
    passage: String,
    safe_load: String,
    /// What rating would be enough, where one is exceeded.
    needed: String,
    cascade: String,
    sequence: Option<Table>,
    exceeding: Option<Table>,
    undecided: Option<Table>,
    /// Errors are estimated, not proven.
    estimated: bool,
    breaks: Option<Table>,
    often: Option<Table>,
    /// Each of several breaks, from the head.
    every: Option<Table>,
    limits: String,
    limited: Option<Table>,
    figures: Vec<Figure>,
    rod: String,
    losses_lead: String,
    losses: Vec<Vec<String>>,
    /// The worst case with other couplers, without brakes, or let down from a larger pull.
    variants_lead: String,
    variants: Vec<Vec<String>>,
    /// Couplers left out of all cases because they cannot exceed at any time.
    left_out: usize,
    methods: Vec<String>,
    accuracy: String,
    /// What was computed after each of several breaks: "28 s to 31.2 s".
    horizons: String,
    map: String,
    run_time: String,
}

#[derive(Serialize)]
struct Table {
    rows: Vec<Vec<String>>,
    more: usize,
}

#[derive(Serialize)]
struct Figure {
    file: String,
    caption: String,
}

/// The facts of a scenario.
pub fn section(train: &Train, scenario: &ScenarioFindings, pictures: &[Picture]) -> Section {
    let units = train.origin().units;
    let source = words::source(train, scenario).map(|(_, s)| s);
    let event = source.map(|s| &s.event);
    let cases = &scenario.cases;
    let single = if let [case] = &cases[..] { Some(case) } else { None };
    let factor = cases.iter().filter_map(|c| c.safe_load_factor).reduce(f64::min);
    let no_factor = cases.iter().find_map(|c| c.no_safe_load_factor);
    let search = single.and_then(|c| c.load_factor_search);
    let watched = cases.iter().any(|c| c.worst.is_some());
    Section {
        heading: scenario.name.clone(),
        event: source.map(|s| words::event(train, s)).unwrap_or_default(),
        verdict: words::verdict_of(scenario, units),
        passage: words::passage(scenario, units),
        safe_load: event
            .filter(|_| watched)
            .map(|e| words::safe_load(train, e, factor, no_factor, search))
            .unwrap_or_default(),
        needed: words::needed(scenario, units),
        cascade: cascade::sentence(scenario),
        sequence: single.and_then(|case| sequence(case, units)),
        exceeding: single.and_then(|case| table(words::exceeding(case), |c| exceeding_row(c, case, units))),
        undecided: single.and_then(|case| table(words::undecided(case), |c| undecided_row(c, case, units))),
        estimated: cases.iter().any(|c| c.error_estimate_n.is_some()),
        breaks: if single.is_none() { table(harmful(scenario), |of| break_row(of, units)) } else { None },
        often: if single.is_none() { often(scenario) } else { None },
        every: if single.is_none() { every(train, cases) } else { None },
        limits: limits::sentences(scenario, units),
        limited: single.and_then(|case| table(limits::passing(case), |of| limits::row(of, case, units))),
        figures: pictures.iter().map(|p| Figure { file: p.file.clone(), caption: p.caption.clone() }).collect(),
        rod: words::rod(scenario),
        losses_lead: variants::losses_lead(scenario),
        losses: variants::losses(scenario, units),
        variants_lead: variants::sentences(scenario),
        variants: variants::rows(scenario, units),
        left_out: cases.iter().map(|c| c.left_out).sum(),
        methods: methods(cases),
        accuracy: accuracy(cases, units),
        horizons: if cases.len() > 1 { horizon(cases) } else { String::new() },
        map: words::map_of_breaks(scenario),
        run_time: run_time(cases),
    }
}

/// A row of the table of all scenarios: the verdict in figures.
pub fn overview_row(train: &Train, scenario: &ScenarioFindings) -> Vec<String> {
    let exceeding = |of: fn(&CaseFindings) -> usize| match &scenario.cases[..] {
        [case] => of(case).to_string(),
        cases => format!("{} of {}", cases.iter().filter(|c| of(c) > 0).count(), words::count(cases.len(), "break")),
    };
    let worst = words::worst_case(scenario).map_or([const { String::new() }; 3], |(case, c)| {
        let after = case.broken_coupler.filter(|_| scenario.cases.len() > 1);
        let after = after.map_or(String::new(), |b| format!(", when {b} breaks"));
        [
            format!("{}{after}", c.coupler),
            format!("{}, {} %", demand(c, case, train.origin().units), percent(c.utilisation)),
            time(c.peak_time_s),
        ]
    });
    let factor = scenario.cases.iter().filter_map(|c| c.safe_load_factor).reduce(f64::min).map_or(String::new(), down);
    let of = words::source(train, scenario).map_or("", |(_, s)| words::cause(&s.event));
    let factor = if factor.is_empty() { factor } else { format!("{factor} on the {of}") };
    let head = [scenario.name.clone(), exceeding(|c| c.exceeding), exceeding(|c| c.exceeding_first_passage)];
    head.into_iter().chain(worst).chain([factor, horizon(&scenario.cases)]).collect()
}

/// The couplers that break after the event, in order.
fn sequence(case: &CaseFindings, units: UnitSystem) -> Option<Table> {
    let found = case.cascade.as_ref()?;
    table(found.breaks.iter().collect(), |b| cascade::row(b, found, units))
}

fn table<T>(items: Vec<T>, row: impl Fn(T) -> Vec<String>) -> Option<Table> {
    table_of(items, ROWS, row)
}

fn table_of<T>(items: Vec<T>, most: usize, row: impl Fn(T) -> Vec<String>) -> Option<Table> {
    let more = items.len().saturating_sub(most);
    let rows: Vec<_> = items.into_iter().take(most).map(row).collect();
    (!rows.is_empty()).then_some(Table { rows, more })
}

fn exceeding_row(c: &CouplerFindings, case: &CaseFindings, units: UnitSystem) -> Vec<String> {
    vec![
        c.coupler.to_string(),
        c.between.join(", "),
        demand(c, case, units),
        // In the unit of the force beside it.
        given_force_in(force_unit(units, c.peak_force_n), words::rating(c)),
        format!("{} %", percent(c.utilisation)),
        time(c.peak_time_s),
        c.first_exceeds_s
            .map(|t| format!("{}, in {}", time(t), c.first_exceeds_in.unwrap_or_default()))
            .unwrap_or_default(),
    ]
}

fn undecided_row(c: &CouplerFindings, case: &CaseFindings, units: UnitSystem) -> Vec<String> {
    let unit = force_unit(units, 0.0);
    let rating = format!("{} {}", words::rating(c) / unit.size, unit.name);
    vec![c.coupler.to_string(), c.between.join(", "), words::interval(c, case.margin_n(), units), rating]
}

fn demand(c: &CouplerFindings, case: &CaseFindings, units: UnitSystem) -> String {
    format!("{} in {}", force(units, c.peak_force_n, case.error_n()), words::sense(c.peak_force_n))
}

/// Cases in which some coupler exceeds, worst first.
fn harmful(scenario: &ScenarioFindings) -> Vec<(&CaseFindings, &CouplerFindings)> {
    let over = scenario.cases.iter().filter(|c| c.exceeding > 0);
    let mut over: Vec<_> = over.filter_map(|case| Some((case, case.worst.as_ref()?))).collect();
    over.sort_by(|a, b| b.1.utilisation.total_cmp(&a.1.utilisation));
    over
}

fn break_row((case, worst): (&CaseFindings, &CouplerFindings), units: UnitSystem) -> Vec<String> {
    vec![
        case.broken_coupler.map(|b| b.to_string()).unwrap_or_default(),
        case.exceeding.to_string(),
        format!("{} ({})", worst.coupler, worst.between.join(", ")),
        demand(worst, case, units),
        format!("{} %", percent(worst.utilisation)),
        time(worst.peak_time_s),
        case.safe_load_factor.map(|f| format!("{} %", down(100.0 * f))).unwrap_or_default(),
    ]
}

/// What each break does, whether or not a coupler exceeds.
fn every(train: &Train, cases: &[CaseFindings]) -> Option<Table> {
    let units = train.origin().units;
    let of: Vec<_> = cases.iter().filter_map(|c| Some((c, c.broken_coupler?, c.worst.as_ref()?))).collect();
    table_of(of, BREAKS, |(case, broken, worst)| {
        let [ahead, behind] = [broken - 1, broken].map(|v| train.vehicles()[v].label.as_str());
        let early = case.worst_first_passage.as_ref();
        vec![
            broken.to_string(),
            format!("{ahead}, {behind}"),
            case.exceeding.to_string(),
            format!("{} ({})", worst.coupler, worst.between.join(", ")),
            demand(worst, case, units),
            format!("{} %", percent(worst.utilisation)),
            time(worst.peak_time_s),
            early.map(|w| format!("{} %", percent(w.utilisation))).unwrap_or_default(),
        ]
    })
}

/// Couplers by how many breaks overload them, most first.
fn often(scenario: &ScenarioFindings) -> Option<Table> {
    let mut breaks: BTreeMap<usize, (usize, &CouplerFindings)> = BTreeMap::new();
    for c in scenario.cases.iter().flat_map(|case| &case.couplers).filter(|c| c.exceeds == Some(true)) {
        breaks.entry(c.coupler).or_insert((0, c)).0 += 1;
    }
    let mut found: Vec<_> = breaks.into_values().collect();
    found.sort_by_key(|&(n, c)| (std::cmp::Reverse(n), c.coupler));
    let mut table = table(found, |(n, c)| vec![c.coupler.to_string(), c.between.join(", "), n.to_string()])?;
    let surplus = table.rows.len().saturating_sub(ROWS / 2);
    table.rows.truncate(ROWS / 2);
    table.more += surplus;
    Some(table)
}

/// Each method with its reason, once; of many cases without the counts, which differ from case to case.
fn methods(cases: &[CaseFindings]) -> Vec<String> {
    let mut said: Vec<(String, usize)> = Vec::new();
    for case in cases {
        let whole = case.method_reason.as_str();
        let reason = if cases.len() > 1 { whole.split(" (counted work").next().unwrap_or(whole) } else { whole };
        let reason = if reason.is_empty() { String::new() } else { format!(": {reason}") };
        let text = format!("{}{reason}", case.method);
        match said.iter_mut().find(|(known, _)| *known == text) {
            Some((_, n)) => *n += 1,
            None => said.push((text, 1)),
        }
    }
    let several = said.len() > 1;
    let count = |n: usize| if several { format!(" ({})", words::count(n, "case")) } else { String::new() };
    said.iter().map(|(text, n)| format!("{}{}.", text.trim_end_matches('.'), count(*n))).collect()
}

fn horizon(cases: &[CaseFindings]) -> String {
    let (low, high) = cases.iter().fold((f64::INFINITY, 0.0f64), |(l, h), c| (l.min(c.horizon_s), h.max(c.horizon_s)));
    if low < high { format!("{} to {}", brief_time(low), brief_time(high)) } else { brief_time(high) }
}

fn run_time(cases: &[CaseFindings]) -> String {
    let total = time(cases.iter().map(|c| c.run_time_s).sum());
    if cases.len() > 1 { format!("{total}, summed over {} cases", cases.len()) } else { total }
}

fn accuracy(cases: &[CaseFindings], units: UnitSystem) -> String {
    if cases.iter().any(|c| c.error_estimate_n.is_some()) {
        return estimate(cases, units) + &endings(cases);
    }
    let bound = cases.iter().map(|c| c.error_bound_n).fold(0.0, f64::max);
    let asked = cases.iter().map(|c| c.tolerance_n).fold(0.0, f64::max);
    let write = |f: f64| small_force(units, f);
    let met = if cases.iter().all(|c| c.error_bound_n <= c.tolerance_n) { "asked for" } else { "not met; asked for" };
    format!(
        "No reported force is further than {} from the exact solution of the model; the bound covers rounding, truncation \
         and the search for peaks between instants ({met}: {}).",
        write(bound),
        write(asked)
    ) + &endings(cases)
}

/// The accuracy of marches for which nothing is proven.
fn estimate(cases: &[CaseFindings], units: UnitSystem) -> String {
    let estimate = cases.iter().filter_map(|c| c.error_estimate_n).fold(0.0, f64::max);
    let write = |f: f64| small_force(units, f);
    let asked = cases.iter().map(|c| c.tolerance_n).fold(0.0, f64::max);
    format!(
        "The error of the reported forces against the exact solution of the model is estimated at {} or less (asked for: {}). This is an \
         estimate, not a bound: the motion is computed three times, with other steps, with noise in the last places of every elongation and \
         speed, and with the couplers' constants moved in their last places; it is ten times the largest difference. A rating within ten \
         estimates of a peak is not decided.",
        write(estimate),
        write(asked)
    )
}

/// Where marches end before their horizon, and why.
fn endings(cases: &[CaseFindings]) -> String {
    let lost = cases.iter().filter_map(|c| c.predictable_until_s).reduce(f64::min);
    let stopped = cases.iter().filter_map(|c| Some((c.stopped_at_s?, c.stopped_vehicle?)));
    let stopped = stopped.reduce(|a, b| if b.0 < a.0 { b } else { a });
    let of_cases = if cases.len() > 1 { "in one of the cases, at the earliest " } else { "" };
    let mut text = String::new();
    if let Some(at_s) = lost {
        text += &format!(
            " The report ends {of_cases}at {}: from then on small differences grow until no force can be told.",
            time(at_s)
        );
    }
    if let Some((at_s, vehicle)) = stopped {
        text += &format!(
            " The report ends {of_cases}at {}: vehicle {vehicle} would come to a stand then, and a standing vehicle is not computed.",
            time(at_s)
        );
    }
    text
}
