//! What the report says of the scenarios.

use std::collections::BTreeMap;

use super::block::Side::{Left, Right};
use super::block::{Block, Side, Span, Table, lines};
use super::numbers::{
    Unit, brief_time, down, force_in, force_unit, given_force_in, interval, percent, small_force, time,
};
use super::pictures::Shown;
use super::{cascade, events, limits, variants, verdict, words};
use crate::findings::{CaseFindings, CouplerFindings, ScenarioFindings};
use crate::train::Train;
use crate::units::UnitSystem;

/// Rows of a table in the report; the CSV has the rest.
const ROWS: usize = 20;

/// Rows of the table of all breaks.
const BREAKS: usize = 400;

/// Files that have all rows of a table.
const CSV: Option<&str> = Some("couplers.csv");
const JSON: Option<&str> = Some("result.json");

type Head<'a> = &'a [(&'a str, Side)];

/// What the report says of the scenario of an index, which can be one of several.
pub fn section(
    train: &Train,
    scenario: &ScenarioFindings,
    index: usize,
    several: bool,
    shown: Option<&Shown>,
) -> Vec<Block> {
    let cases = &scenario.cases;
    let mut all = verdict(train, scenario, index, several);
    match &cases[..] {
        [case] => all.extend(of_case(case, train.origin().units)),
        _ => all.extend(of_breaks(scenario, train.origin().units)),
    }
    all.extend(over_limits(scenario, train.origin().units));
    let left_out: usize = cases.iter().map(|c| c.left_out).sum();
    if left_out > 0 {
        let text = format!(
            "Couplers whose bound over all time is below their rating cannot exceed it at any time and are not listed: {left_out} in\n\
             all cases together. The safe factor takes their bounds for their largest forces; the true one may be larger."
        );
        all.push(Block::Paragraph("Left out", lines(&text)));
    }
    let pictures = shown.map_or_else(Vec::new, Shown::pictures);
    all.extend(pictures.into_iter().map(|picture| Block::Figure(Some(index), picture)));
    all.extend(titled("Continuum model", words::rod(scenario)));
    all.extend(changed(scenario, train.origin().units));
    if cases.len() != 1 {
        all.extend(every(train, cases));
    }
    all.extend(titled("Method", methods(cases)));
    let accuracy = accuracy(train, cases);
    all.push(Block::titled("Accuracy", format!("{accuracy} Run time {}.", run_time(cases))));
    all
}

/// A paragraph, unless there is nothing to say.
fn titled(title: &'static str, text: String) -> Option<Block> {
    (!text.is_empty()).then(|| Block::titled(title, text))
}

/// The verdict, what breaks next, and the event with the safe load.
fn verdict(train: &Train, scenario: &ScenarioFindings, index: usize, several: bool) -> Vec<Block> {
    let (units, extras, cases) = (train.origin().units, train.extras(), &scenario.cases);
    let source = words::source(train, scenario).map(|(_, s)| s);
    let factor = cases.iter().filter_map(|c| c.safe_load_factor).reduce(f64::min);
    let no_factor = cases.iter().find_map(|c| c.no_safe_load_factor);
    let search = if let [case] = &cases[..] { case.load_factor_search } else { None };
    let watched = source.filter(|_| cases.iter().any(|c| c.worst.is_some()));
    let safe = watched.map_or_else(String::new, |s| words::safe_load(train, &s.event, factor, no_factor, search));
    let mut more = String::new();
    if !safe.is_empty() && cases.len() > 1 {
        more += &format!(" After each break {} were computed.", horizon(cases));
    }
    if !safe.is_empty() && extras.dashpot_n_s_per_m.is_empty() && extras.damping_ratio <= 0.0 && extras.laws.is_empty()
    {
        more += " The model has no damping, so a force after the horizon can be larger than those computed.";
    }
    let next = match cascade::sentence(scenario) {
        next if next.is_empty() => next,
        next if cascade::brief(scenario).is_empty() => next,
        next => {
            next + " But for the tables of these breaks and of the forces with them, this section covers the event alone and ignores the later breaks."
        }
    };
    let name = if several { String::new() } else { format!("Scenario \"{}\". ", scenario.name) };
    let event = source.map(|s| events::event(train, s)).unwrap_or_default();
    let map = match words::map_of_breaks(scenario) {
        map if map.is_empty() => map,
        map => format!(" {map}"),
    };
    let mut all = vec![Block::Verdict(index, verdict::verdict_of(scenario, units), more)];
    all.extend(titled("Largest forces", verdict::passage(scenario, units)));
    all.extend(titled("What breaks next", next));
    if let [case] = &cases[..] {
        all.extend(sequence(case, units));
    }
    all.push(Block::plain(format!("{name}{event} {safe}{}{map}", words::needed(scenario, units))));
    all
}

/// The first columns of a table of couplers with their largest forces.
const FORCES: [(&str, Side); 6] = [
    ("coupler", Right),
    ("between", Left),
    ("demand", Right),
    ("capacity", Right),
    ("utilisation", Right),
    ("peak at", Right),
];

/// The couplers that exceed or are not decided in the one case of a scenario.
fn of_case(case: &CaseFindings, units: UnitSystem) -> Vec<Block> {
    let more = [("over its rating from", Right), ("carries this with a rating above", Left)];
    let head = [&FORCES[..], &more].concat();
    let unit = column_unit(words::exceeding(case).into_iter(), units);
    let row = |c| exceeding_row(c, case, unit);
    let mut all = table("Couplers over their rating, worst first", &head, words::exceeding(case), ROWS, CSV, row);
    let within = if case.error_estimate_n.is_some() { "ten estimates of the error" } else { "the error bound" };
    let caption = format!("Not decided, because the rating lies within {within} of the peak");
    let head: Head = &[
        ("coupler", Right),
        ("between", Left),
        ("peak", Left),
        ("rating", Left),
        ("certainly carries this with a rating above", Left),
    ];
    let unit = column_unit(words::undecided(case).into_iter(), units);
    all.extend(table(&caption, head, words::undecided(case), ROWS, CSV, |c| undecided_row(c, case, unit)));
    all
}

/// The breaks that overload a coupler, and the couplers that they overload most often.
fn of_breaks(scenario: &ScenarioFindings, units: UnitSystem) -> Vec<Block> {
    let head: Head = &[
        ("coupler that breaks", Right),
        ("couplers over", Right),
        ("worst coupler", Left),
        ("demand", Right),
        ("utilisation", Right),
        ("peak at", Right),
        ("safe share of the load", Right),
    ];
    let caption = "Breaks that overload another coupler, worst first";
    let unit = column_unit(harmful(scenario).into_iter().map(|of| of.1), units);
    let mut all = table(caption, head, harmful(scenario), ROWS, JSON, |of| break_row(of, unit));
    all.extend(often(scenario, units));
    all
}

fn over_limits(scenario: &ScenarioFindings, units: UnitSystem) -> Vec<Block> {
    let mut all: Vec<Block> = titled("Other limits", limits::sentences(scenario, units)).into_iter().collect();
    if let [case] = &scenario.cases[..] {
        let head: Head =
            &[("coupler", Right), ("between", Left), ("largest force", Right), ("limits in that sense", Left)];
        let caption = "Couplers that pass a limit, the largest excess over one first";
        let unit = column_unit(limits::passing(case).into_iter().map(|of| of.0), units);
        all.extend(table(caption, head, limits::passing(case), ROWS, CSV, |of| limits::row(of, case, unit)));
    }
    all
}

/// The worst case with losses, with other couplers, without brakes, or let down from a larger pull.
fn changed(scenario: &ScenarioFindings, units: UnitSystem) -> Vec<Block> {
    let head = |first| {
        let names = ["couplers over", "worst coupler", "its largest force", "share of its rating", "time of it"];
        std::iter::once(first).chain(names.map(|name| (name, Right))).collect::<Vec<_>>()
    };
    let mut all = Vec::new();
    let rows = variants::losses(scenario, units);
    if !rows.is_empty() {
        let head = head(("dashpots c / 2√(km)", Right)).into_iter().map(|(name, side)| (name.to_owned(), side));
        let caption = variants::losses_lead(scenario);
        all.push(Block::Table(Table { title: "Losses", caption, head: head.collect(), rows }));
    }
    let rows = variants::rows(scenario, units);
    if !rows.is_empty() {
        all.push(Block::titled("Other couplers, brakes and loads", variants::sentences(scenario)));
        all.push(Block::table("The worst coupler of each train", &head(("train", Left)), rows));
    }
    all
}

/// The verdicts on all scenarios in figures; limits and further breaks where some scenario has them.
pub fn overview(train: &Train, scenarios: &[ScenarioFindings]) -> Block {
    let mut head = vec![
        ("scenario", Left),
        ("over their rating", Left),
        ("in the first passage", Left),
        ("worst coupler", Left),
        ("its largest force", Left),
        ("time of it", Right),
        ("safe factor", Left),
        ("horizon", Left),
    ];
    let unit = column_unit(scenarios.iter().filter_map(words::worst_case).map(|of| of.1), train.origin().units);
    let mut rows: Vec<Vec<String>> = scenarios.iter().map(|scenario| overview_row(train, scenario, unit)).collect();
    let of_each = |cell: fn(&ScenarioFindings) -> String| scenarios.iter().map(cell).collect::<Vec<_>>();
    let more = [("limits passed", of_each(limits::brief)), ("further couplers break", of_each(cascade::brief))];
    for (name, cells) in more {
        if cells.iter().any(|cell| !cell.is_empty()) {
            head.push((name, Left));
            rows.iter_mut().zip(cells).for_each(|(row, cell)| row.push(cell));
        }
    }
    Block::table("The verdict on each scenario", &head, rows)
}

/// A row of the table of all scenarios: the verdict in figures.
fn overview_row(train: &Train, scenario: &ScenarioFindings, unit: Unit) -> Vec<String> {
    let exceeding = |of: fn(&CaseFindings) -> usize| match &scenario.cases[..] {
        [case] => of(case).to_string(),
        cases => format!("{} of {}", cases.iter().filter(|c| of(c) > 0).count(), words::count(cases.len(), "break")),
    };
    let worst = words::worst_case(scenario).map_or([const { String::new() }; 3], |(case, c)| {
        let after = case.broken_coupler.filter(|_| scenario.cases.len() > 1);
        let after = after.map_or(String::new(), |b| format!(", when {b} breaks"));
        [
            format!("{}{after}", c.coupler),
            format!("{}, {} %", demand(c, case, unit), percent(c.utilisation)),
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
fn sequence(case: &CaseFindings, units: UnitSystem) -> Vec<Block> {
    let Some(found) = &case.cascade else { return Vec::new() };
    let head: Head = &[
        ("time", Right),
        ("coupler that breaks", Right),
        ("between", Left),
        ("force", Right),
        ("breaks at its", Left),
        ("energy set free", Right),
    ];
    let breaks = found.breaks.iter().collect();
    let unit = force_unit(units, found.breaks.iter().map(|b| b.force_n.abs()).fold(0.0, f64::max));
    let row = |b| cascade::row(b, found, units, unit);
    let mut all = table("Couplers that break, in order", head, breaks, ROWS, JSON, row);
    if !found.breaks.is_empty() {
        let head = [&FORCES[..], &[("utilisation if no other breaks", Right)]].concat();
        let forces = cascade::forces(case);
        let unit = force_unit(units, forces.iter().map(|of| of.2.0.abs()).fold(0.0, f64::max));
        let caption =
            "Largest force of every coupler when these break, up to its own break, the largest utilisation first";
        let row = |of| cascade::force_row(of, found, unit);
        all.extend(table(caption, &head, forces, ROWS, CSV, row));
    }
    all
}

/// A table of the first of some items, if there are any, and how many more there are; a file may have all.
fn table<T>(
    caption: &str,
    head: Head,
    items: Vec<T>,
    most: usize,
    file: Option<&'static str>,
    row: impl Fn(T) -> Vec<String>,
) -> Vec<Block> {
    if items.is_empty() {
        return Vec::new();
    }
    let more = items.len().saturating_sub(most);
    let mut all = vec![Block::table(caption, head, items.into_iter().take(most).map(row).collect())];
    if more > 0 {
        all.push(match file {
            Some(file) => Block::Paragraph(
                "",
                vec![
                    Span::Plain(format!("{more} more not shown; ")),
                    Span::Link(file),
                    Span::Plain(" has all.".to_owned()),
                ],
            ),
            None => Block::plain(format!("{more} more not shown.")),
        });
    }
    all
}

/// One unit for the largest forces of a column.
fn column_unit<'a>(of: impl Iterator<Item = &'a CouplerFindings>, units: UnitSystem) -> Unit {
    force_unit(units, of.map(|c| c.peak_force_n.abs()).fold(0.0, f64::max))
}

fn exceeding_row(c: &CouplerFindings, case: &CaseFindings, unit: Unit) -> Vec<String> {
    vec![
        c.coupler.to_string(),
        c.between.join(", "),
        demand(c, case, unit),
        given_force_in(unit, words::rating(c)),
        format!("{} %", percent(c.utilisation)),
        time(c.peak_time_s),
        c.first_exceeds_s
            .map(|t| format!("{}, in {}", time(t), c.first_exceeds_in.unwrap_or_default()))
            .unwrap_or_default(),
        words::enough(c, case.margin_n(), unit),
    ]
}

fn undecided_row(c: &CouplerFindings, case: &CaseFindings, unit: Unit) -> Vec<String> {
    // The upper end of the interval, with the digits that tell it from the lower one.
    let [_, enough] = interval(c.peak_force_n.abs() / unit.size, case.margin_n() / unit.size);
    let enough = format!("{enough} {} in {}", unit.name, words::sense(c.peak_force_n));
    let (between, peak) = (c.between.join(", "), words::interval(c, case.margin_n(), unit));
    vec![c.coupler.to_string(), between, peak, given_force_in(unit, words::rating(c)), enough]
}

fn demand(c: &CouplerFindings, case: &CaseFindings, unit: Unit) -> String {
    format!("{} in {}", force_in(unit, c.peak_force_n, case.error_n()), words::sense(c.peak_force_n))
}

/// Cases in which some coupler exceeds, worst first.
fn harmful(scenario: &ScenarioFindings) -> Vec<(&CaseFindings, &CouplerFindings)> {
    let over = scenario.cases.iter().filter(|c| c.exceeding > 0);
    let mut over: Vec<_> = over.filter_map(|case| Some((case, case.worst.as_ref()?))).collect();
    over.sort_by(|a, b| b.1.utilisation.total_cmp(&a.1.utilisation));
    over
}

fn break_row((case, worst): (&CaseFindings, &CouplerFindings), unit: Unit) -> Vec<String> {
    vec![
        case.broken_coupler.map(|b| b.to_string()).unwrap_or_default(),
        case.exceeding.to_string(),
        format!("{} ({})", worst.coupler, worst.between.join(", ")),
        demand(worst, case, unit),
        format!("{} %", percent(worst.utilisation)),
        time(worst.peak_time_s),
        case.safe_load_factor.map(|f| format!("{} %", down(100.0 * f))).unwrap_or_default(),
    ]
}

/// What each break does, whether or not a coupler exceeds, from the head.
fn every(train: &Train, cases: &[CaseFindings]) -> Vec<Block> {
    let head: Head = &[
        ("coupler that breaks", Right),
        ("between", Left),
        ("couplers over", Right),
        ("worst coupler", Right),
        ("demand", Right),
        ("utilisation", Right),
        ("peak at", Right),
        ("largest utilisation in the first passage", Right),
    ];
    let caption = "Every break, from the head, with the worst coupler after it";
    let unit = column_unit(cases.iter().filter_map(|case| case.worst.as_ref()), train.origin().units);
    let of: Vec<_> = cases.iter().filter_map(|c| Some((c, c.broken_coupler?, c.worst.as_ref()?))).collect();
    table(caption, head, of, BREAKS, JSON, |(case, broken, worst)| {
        let [ahead, behind] = [broken - 1, broken].map(|v| train.vehicles()[v].label.as_str());
        let early = case.worst_first_passage.as_ref();
        vec![
            broken.to_string(),
            format!("{ahead}, {behind}"),
            case.exceeding.to_string(),
            format!("{} ({})", worst.coupler, worst.between.join(", ")),
            demand(worst, case, unit),
            format!("{} %", percent(worst.utilisation)),
            time(worst.peak_time_s),
            early.map(|w| format!("{} %", percent(w.utilisation))).unwrap_or_default(),
        ]
    })
}

/// Couplers by how many breaks overload them, most first.
fn often(scenario: &ScenarioFindings, units: UnitSystem) -> Vec<Block> {
    let mut breaks: BTreeMap<usize, (usize, CouplerFindings)> = BTreeMap::new();
    let margin_n = scenario.cases.iter().map(CaseFindings::margin_n).fold(0.0, f64::max);
    for c in scenario.cases.iter().flat_map(|case| &case.couplers).filter(|c| c.exceeds == Some(true)) {
        let (count, most) = breaks.entry(c.coupler).or_insert_with(|| (0, c.clone()));
        *count += 1;
        most.peak_draft_n = [most.peak_draft_n, c.peak_draft_n].into_iter().flatten().reduce(f64::max);
        most.peak_buff_n = [most.peak_buff_n, c.peak_buff_n].into_iter().flatten().reduce(f64::min);
    }
    let mut found: Vec<_> = breaks.into_values().collect();
    found.sort_by_key(|(n, c)| (std::cmp::Reverse(*n), c.coupler));
    let unit = column_unit(found.iter().map(|(_, c)| c), units);
    let head: Head = &[
        ("coupler", Right),
        ("between", Left),
        ("breaks that overload it", Right),
        ("carries all of them with a rating above", Left),
    ];
    let caption = "Couplers overloaded by the most breaks";
    let row = |(n, c): (usize, CouplerFindings)| {
        vec![c.coupler.to_string(), c.between.join(", "), n.to_string(), words::enough(&c, margin_n, unit)]
    };
    table(caption, head, found, ROWS / 2, None, row)
}

/// Each method with its reason, once; of many cases without the counts, which differ from case to case.
fn methods(cases: &[CaseFindings]) -> String {
    let mut said: Vec<(String, usize)> = Vec::new();
    for case in cases {
        let whole = case.method_reason.as_str();
        let reason = if cases.len() > 1 { whole.split(" (work of the others").next().unwrap_or(whole) } else { whole };
        let reason = if reason.is_empty() { String::new() } else { format!(": {reason}") };
        let text = format!("{}{reason}", case.method);
        match said.iter_mut().find(|(known, _)| *known == text) {
            Some((_, n)) => *n += 1,
            None => said.push((text, 1)),
        }
    }
    let several = said.len() > 1;
    let count = |n: usize| if several { format!(" ({})", words::count(n, "case")) } else { String::new() };
    let told: Vec<String> =
        said.iter().map(|(text, n)| format!("Computed with {}{}.", text.trim_end_matches('.'), count(*n))).collect();
    told.join(" ")
}

fn horizon(cases: &[CaseFindings]) -> String {
    let (low, high) = cases.iter().fold((f64::INFINITY, 0.0f64), |(l, h), c| (l.min(c.horizon_s), h.max(c.horizon_s)));
    if low < high { format!("{} to {}", brief_time(low), brief_time(high)) } else { brief_time(high) }
}

fn run_time(cases: &[CaseFindings]) -> String {
    let total = time(cases.iter().map(|c| c.run_time_s).sum());
    if cases.len() > 1 { format!("{total}, summed over {} cases", cases.len()) } else { total }
}

fn accuracy(train: &Train, cases: &[CaseFindings]) -> String {
    let units = train.origin().units;
    if cases.iter().any(|c| c.error_estimate_n.is_some()) {
        return estimate(cases, units) + &endings(train, cases);
    }
    let bound = cases.iter().map(|c| c.error_bound_n).fold(0.0, f64::max);
    let asked = cases.iter().map(|c| c.tolerance_n).fold(0.0, f64::max);
    let write = |f: f64| small_force(units, f);
    let met = if cases.iter().all(|c| c.error_bound_n <= c.tolerance_n) { "asked for" } else { "not met; asked for" };
    format!(
        "The error bound {NOT_OF_A_TRAIN} No reported force is further than {} from the exact solution of the model; the bound covers rounding, truncation \
         and the search for peaks between instants ({met}: {}).",
        write(bound),
        write(asked)
    ) + &endings(train, cases)
}

/// End of a sentence about accuracy.
const NOT_OF_A_TRAIN: &str = "is that of the computation, not the difference between the model and a real train.";

/// The accuracy of marches for which nothing is proven.
fn estimate(cases: &[CaseFindings], units: UnitSystem) -> String {
    let estimate = cases.iter().filter_map(|c| c.error_estimate_n).fold(0.0, f64::max);
    let write = |f: f64| small_force(units, f);
    let asked = cases.iter().map(|c| c.tolerance_n).fold(0.0, f64::max);
    format!(
        "The error estimate {NOT_OF_A_TRAIN} The error of the reported forces against the exact solution of the model is estimated at {} \
         (asked for: {} or less). This is an estimate, not a bound: the motion is computed twice more, with other steps and with small changes \
         in the last digits of every elongation, every speed and the couplers' constants; the estimate is ten times the largest difference. \
         Where a rating lies within ten times the estimate of a peak, the verdict is \"not decided\".",
        write(estimate),
        write(asked)
    )
}

/// Where marches end before their horizon, and why.
fn endings(train: &Train, cases: &[CaseFindings]) -> String {
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
            " The report ends {of_cases}at {}: {} would come to a stand then, and a standing vehicle is not computed.",
            time(at_s),
            train.place_of(vehicle)
        );
    }
    text
}
