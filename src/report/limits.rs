//! What the report says of capacities besides the rating.

use super::numbers::{Unit, digits, force_in, force_unit, given_force_in};
use super::words::count;
use crate::findings::{CaseFindings, CouplerFindings, LimitInSense, ScenarioFindings};
use crate::train::{LIMITS, SENSES};
use crate::units::{UnitSystem, one_of};

/// The sign of a force in draft and in buff.
const SENSES_OF_FORCE: [f64; 2] = [1.0, -1.0];

/// A capacity of a coupler in one case.
type Entry<'a> = (&'a CaseFindings, &'a CouplerFindings, &'a LimitInSense);

/// Which capacities couplers pass, which were not given, and the margins: plain sentences; empty where the train has none.
pub fn sentences(scenario: &ScenarioFindings, units: UnitSystem) -> String {
    let couplers = scenario.cases.iter().flat_map(|case| case.couplers.iter().map(move |c| (case, c)));
    let all: Vec<Entry> = couplers.flat_map(|(case, c)| entries(case, c)).collect();
    if all.is_empty() {
        return String::new();
    }
    let of = |limit: &str| all.iter().filter(|(.., l)| l.limit == limit).copied().collect::<Vec<_>>();
    let given = || LIMITS.into_iter().map(|limit| (limit, of(limit))).filter(|(_, entries)| !entries.is_empty());
    let several = scenario.cases.len() > 1;
    let passed = given().map(|(limit, entries)| passed(limit, &entries, several));
    let margins = given().filter_map(|(limit, entries)| margin(limit, &entries, several, units));
    passed.chain(not_given(&all)).chain(margins).collect::<Vec<_>>().join(" ")
}

/// The capacities that couplers pass, as a cell: "fatigue by 26 couplers"; empty for none.
pub fn brief(scenario: &ScenarioFindings) -> String {
    let couplers_of = scenario.cases.iter().flat_map(|case| case.couplers.iter().map(move |c| (case, c)));
    let all: Vec<Entry> = couplers_of.flat_map(|(case, c)| entries(case, c)).collect();
    let passed = LIMITS.into_iter().filter_map(|limit| {
        let n = couplers(&all, |l| l.limit == limit && l.passed == Some(true));
        (n > 0).then(|| format!("{limit} by {}", count(n, "coupler")))
    });
    passed.collect::<Vec<_>>().join(", ")
}

fn entries<'a>(case: &'a CaseFindings, c: &'a CouplerFindings) -> impl Iterator<Item = Entry<'a>> {
    c.limits.iter().flat_map(|l| &l.by_sense).map(move |l| (case, c, l))
}

/// How many couplers pass a test in any case.
fn couplers(entries: &[Entry], test: impl Fn(&LimitInSense) -> bool) -> usize {
    let mut numbers: Vec<usize> = entries.iter().filter(|(.., l)| test(l)).map(|(_, c, _)| c.coupler).collect();
    numbers.sort_unstable();
    numbers.dedup();
    numbers.len()
}

/// How many couplers pass one capacity, in each sense in which it was given.
fn passed(limit: &str, entries: &[Entry], several: bool) -> String {
    let senses = SENSES.into_iter().filter(|sense| entries.iter().any(|(.., l)| l.sense == *sense));
    let senses: Vec<&str> = senses.collect();
    let so = |sense: &str, passed| couplers(entries, |l| l.sense == sense && l.passed == passed);
    let over: Vec<usize> = senses.iter().map(|sense| so(sense, Some(true))).collect();
    let (after, in_some) = if several { (" after any of the breaks", " after some break") } else { ("", "") };
    let mut text = if over.iter().all(|n| *n == 0) {
        let comma = if senses.len() > 1 || several { "," } else { "" };
        let certainly = if entries.iter().any(|(.., l)| l.passed.is_none()) { "certainly " } else { "" };
        format!("No coupler {certainly}passes its {limit} load{after}{comma} in {}.", one_of(&senses))
    } else {
        let by_load = |sense: &str| {
            let before = |(_, c, l): &Entry| {
                l.sense == sense && SENSES_OF_FORCE[usize::from(sense == SENSES[1])] * c.initial_force_n > l.limit_n
            };
            couplers(&entries.iter().filter(|e| before(e)).copied().collect::<Vec<_>>(), |_| true)
        };
        let each = senses.iter().zip(&over).map(|(sense, n)| match (n, by_load(sense)) {
            (0, _) => format!("none in {sense}"),
            (n, 0) => format!("{} in {sense}", count(*n, "coupler")),
            (n, load) if *n == load => {
                format!("{} in {sense}, already under the load before the event", count(*n, "coupler"))
            }
            (n, load) => {
                format!("{} in {sense} ({load} of them under the load before the event)", count(*n, "coupler"))
            }
        });
        format!("The {limit} load is passed{in_some} by {}.", each.collect::<Vec<_>>().join(" and "))
    };
    for sense in senses {
        let open = so(sense, None);
        if open > 0 {
            text += &format!(
                " For {} it cannot be decided whether the {limit} load in {sense} is passed.",
                count(open, "coupler")
            );
        }
    }
    text
}

/// Capacities that no coupler has.
fn not_given(all: &[Entry]) -> Vec<String> {
    let absent = |limit: &str, sense: &str| !all.iter().any(|(.., l)| l.limit == limit && l.sense == sense);
    let [draft, buff] = SENSES;
    let named = |test: &dyn Fn(&str) -> bool, place: &str| {
        let names: Vec<&str> = LIMITS.into_iter().filter(|limit| test(limit)).collect();
        (!names.is_empty()).then(|| format!("No {} load was given{place}.", one_of(names)))
    };
    let both = named(&|limit| absent(limit, draft) && absent(limit, buff), "");
    let in_draft = named(&|limit| absent(limit, draft) && !absent(limit, buff), " in draft");
    let in_buff = named(&|limit| absent(limit, buff) && !absent(limit, draft), " in buff");
    both.into_iter().chain(in_draft).chain(in_buff).collect()
}

/// The coupler that comes nearest to one capacity, or is furthest above it.
fn margin(limit: &str, entries: &[Entry], several: bool, units: UnitSystem) -> Option<String> {
    let (case, c, l) = entries.iter().reduce(|a, b| if b.2.margin < a.2.margin { b } else { a })?;
    let after =
        case.broken_coupler.filter(|_| several).map(|b| format!(" after coupler {b} breaks")).unwrap_or_default();
    let loads = {
        let unit = force_unit(units, l.largest_n);
        let largest = force_in(unit, l.largest_n, case.error_n());
        format!("{largest} in {} against {}", l.sense, given_force_in(unit, l.limit_n))
    };
    let share = digits(100.0 * l.margin.abs(), 0.0, 3);
    if l.margin < 0.0 {
        return Some(format!("Coupler {} exceeds its {limit} load most{after}: {loads}, {share} % over.", c.coupler));
    }
    let article = if limit == LIMITS[2] { "an" } else { "a" };
    Some(format!("The smallest margin to {article} {limit} load is {share} %: coupler {}{after}, {loads}.", c.coupler))
}

/// Couplers that pass a capacity, each in one sense, the largest excess over one first.
pub fn passing(case: &CaseFindings) -> Vec<(&CouplerFindings, &'static str)> {
    let sides = case.couplers.iter().flat_map(|c| SENSES.map(|sense| (c, sense)));
    let mut found: Vec<_> = sides.filter(|of| side(*of).any(|l| l.passed == Some(true))).collect();
    let least_margin = |of| side(of).map(|l| l.margin).fold(1.0, f64::min);
    found.sort_by(|a, b| least_margin(*a).total_cmp(&least_margin(*b)).then(a.0.coupler.cmp(&b.0.coupler)));
    found
}

/// A coupler's capacities in one sense.
fn side<'a>((c, sense): (&'a CouplerFindings, &'a str)) -> impl Iterator<Item = &'a LimitInSense> {
    c.limits.iter().flat_map(|l| &l.by_sense).filter(move |l| l.sense == sense)
}

fn largest(of: (&CouplerFindings, &'static str)) -> f64 {
    side(of).map(|l| l.largest_n).fold(0.0, f64::max)
}

/// A row of the table of couplers that pass a capacity.
pub fn row(of: (&CouplerFindings, &'static str), case: &CaseFindings, unit: Unit) -> Vec<String> {
    let (c, sense) = of;
    let margin = |l: &LimitInSense| {
        let word = if l.margin < 0.0 { "over by" } else { "margin" };
        format!("{} {} ({word} {} %)", l.limit, given_force_in(unit, l.limit_n), digits(100.0 * l.margin.abs(), 0.0, 3))
    };
    vec![
        c.coupler.to_string(),
        c.between.join(", "),
        format!("{} in {sense}", force_in(unit, largest(of), case.error_n())),
        side(of).map(margin).collect::<Vec<_>>().join(", "),
    ]
}
