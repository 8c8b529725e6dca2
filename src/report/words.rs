//! What the findings come to, in sentences: plain text, shared by the report and the terminal.

use super::numbers::{brief_time, digits, down, down_to, given_force, percent, time};
use crate::consist;
use crate::findings::{self, CaseFindings, CouplerFindings, LoadSearch, ScenarioFindings};
pub(crate) use crate::train::count;
use crate::train::{Application, Event, Pulse, PulseShape, Scenario, Train, more};
use crate::units::{Dimension, UnitSystem, shown, shown_time};

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

/// "after coupler 53 breaks", "under the pulse".
fn after(case: &CaseFindings) -> String {
    match case.broken_coupler {
        Some(b) => format!("after coupler {b} breaks"),
        None if case.kind == "impact" => "in the impact".to_owned(),
        None if case.kind == "brake" => "while the brakes are applied".to_owned(),
        None => "under the pulse".to_owned(),
    }
}

/// The event, in one sentence, and what brakes and drives do after it.
pub fn event(train: &Train, scenario: &Scenario) -> String {
    happens(train, scenario) + &consist::response(train, scenario)
}

fn happens(train: &Train, scenario: &Scenario) -> String {
    match &scenario.event {
        Event::Break { couplers } => match couplers[..] {
            [b] => {
                let load = train.initial_force_n()[b];
                let names = [b, b + 1].map(|v| train.vehicles()[v].label.as_str());
                let carried = match load {
                    0.0 => "which carries no force".to_owned(),
                    _ => format!("which carries {} in {}", given_force(train.origin().units, load), sense(load)),
                };
                format!("Coupler {}, between {} and {}, {carried}, breaks at t = 0.", b + 1, names[0], names[1])
            }
            _ if couplers.len() == train.couplers().len() => {
                "Each coupler in turn breaks at t = 0, always from the intact train.".to_owned()
            }
            _ => {
                let left_out = match scenario.left_out_in_buff.len() {
                    0 => String::new(),
                    n => format!("; {} that carry buff are left out, because nothing parts there", count(n, "coupler")),
                };
                format!("{} computed, each at t = 0 and from the intact train{left_out}.", are(couplers.len(), "break"))
            }
        },
        Event::Pulse(Pulse { vehicle, force_n, duration_s, shape }) => {
            let way = if *force_n < 0.0 { "backward" } else { "forward" };
            let label = &train.vehicles()[*vehicle].label;
            let (size, lasting) = (given_force(train.origin().units, *force_n), shown_time(*duration_s));
            let of = format!("vehicle {} ({label})", vehicle + 1);
            match shape {
                PulseShape::Rectangle => {
                    format!("A constant force of {size} acts {way} on {of} from t = 0 for {lasting}.")
                }
                shape => format!(
                    "A force pulls {of} {way} with up to {size} from t = 0 to {lasting}, its course over time: {}.",
                    shape.name()
                ),
            }
        }
        Event::Brake { from, emergency, application: a } => applied(train, from, *emergency, a),
        Event::Impact { vehicles, at_head, speed_m_per_s } => {
            let end = if *at_head { "head" } else { "tail" };
            let speed = shown(train.origin().units, *speed_m_per_s, Dimension::Speed);
            let before = match scenario.event.joint(train.vehicles().len()) {
                Some(joint) if train.initial_force_n().iter().any(|f| *f != 0.0) => {
                    format!(
                        "before the impact each part carries its own load, and coupler {}, which joins the parts, carries none",
                        joint + 1
                    )
                }
                _ => "no coupler carries a force before".to_owned(),
            };
            format!(
                "At t = 0 the {} at the {end} run into the others at {speed} and couple; the others stand, and {before}.",
                count(*vehicles, "vehicle")
            )
        }
    }
}

/// "1 break is", "2 breaks are".
fn are(n: usize, what: &str) -> String {
    format!("{} {}", count(n, what), if n == 1 { "is" } else { "are" })
}

fn applied(train: &Train, from: &[usize], emergency: bool, application: &Application) -> String {
    let what = if emergency { "Emergency" } else { "Service" };
    let (place, course) = (consist::place(train, from), consist::application(application, train.origin().units));
    format!("{what} brakes are applied from {place} at t = 0 ({course}).")
}

/// Whether the load alone is over a coupler's rating.
fn over_before(c: &CouplerFindings) -> bool {
    c.initial_force_n > c.rated_draft_n || -c.initial_force_n > c.rated_buff_n
}

/// Whether a coupler exceeds its rating in draft at one time and in buff at another.
fn exceeds_both_ways(c: &CouplerFindings) -> bool {
    c.peak_draft_n.is_some_and(|f| f > c.rated_draft_n) && c.peak_buff_n.is_some_and(|f| -f > c.rated_buff_n)
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

/// ", within the 8 s that were computed".
fn within(case: &CaseFindings) -> String {
    format!(", within the {} that were computed", brief_time(case.horizon_s))
}

/// The verdict on one case, in one sentence.
fn verdict(case: &CaseFindings, units: UnitSystem) -> String {
    let Some(worst) = &case.worst else {
        return match case.left_out {
            0 => "No coupler is left to exceed anything.".to_owned(),
            1 => "The coupler cannot exceed its rating: its all-time bound lies under it.".to_owned(),
            n => format!("No coupler can exceed its rating: the all-time bounds of all {n} lie under theirs."),
        };
    };
    if case.exceeding > 0 {
        return verdict_exceeding(case, units);
    }
    let (when, within) = (after(case), within(case));
    if case.undecided > 0 {
        let open = undecided(case);
        let first = open.first().copied().unwrap_or(worst);
        return format!(
            "Not decided {when} for {}: {} peaks {}, and its rating lies inside.",
            count(case.undecided, "coupler"),
            place(first),
            interval(first, case.margin_n(), super::numbers::force_unit(units, first.peak_force_n)),
        );
    }
    if worst.utilisation == 0.0 {
        return format!("No coupler would exceed its rating {when}{within}: no force arises in any.");
    }
    format!(
        "No coupler would exceed its rating {when}{within}: the most used is {}, {}, a margin of {} %.{}",
        place(worst),
        most_used(worst, case, units),
        digits(100.0 * (1.0 - worst.utilisation), 0.0, 3),
        share_of_load(worst),
    )
}

/// "1.339 MN in draft, 75.3 % of its rating, 4.010 s after the break".
fn most_used(worst: &CouplerFindings, case: &CaseFindings, units: UnitSystem) -> String {
    let force = super::numbers::force(units, worst.peak_force_n, case.error_n());
    let (share, at) = (percent(worst.utilisation), moment(worst.peak_time_s, case));
    format!("{force} in {}, {share} % of its rating, {at}", sense(worst.peak_force_n))
}

/// What the load alone does to a coupler, where that is most of its largest force; empty where it is not.
fn share_of_load(worst: &CouplerFindings) -> String {
    let (load, peak) = (worst.initial_force_n, worst.peak_force_n);
    match load / peak {
        share if worst.peak_time_s == 0.0 && share >= 1.0 => {
            " This is the load it already carried; the event does not increase it.".to_owned()
        }
        share if share >= 0.9 && worst.peak_time_s > 0.0 => {
            format!(" Its load before the event is already {} % of its rating.", percent((load / rating(worst)).abs()))
        }
        _ => String::new(),
    }
}

fn verdict_exceeding(case: &CaseFindings, units: UnitSystem) -> String {
    let others = case.couplers.len() + case.left_out;
    let which = count(others, if case.broken_coupler.is_some() { "other coupler" } else { "coupler" });
    let whose = if case.exceeding == 1 { "its" } else { "their" };
    let head = format!("{} of {which} would exceed {whose} rating {}{}", case.exceeding, after(case), within(case));
    let first = first_to_exceed(case).map_or(String::new(), |c| {
        let when = match c.first_exceeds_s {
            Some(0.0) if case.kind == "impact" && !over_before(c) => "at once, as the vehicles meet".to_owned(),
            Some(0.0) => "before anything happens, under the load alone".to_owned(),
            Some(t) => moment(t, case),
            None => "at a time not found".to_owned(),
        };
        let word = if case.exceeding == 1 { "it is" } else { "the first is" };
        let sense = c.first_exceeds_in.unwrap_or(sense(c.peak_force_n));
        let later = match sense {
            _ if !exceeds_both_ways(c) => "",
            "draft" => ", and later in buff",
            _ => ", and later in draft",
        };
        format!("; {word} {}, in {sense}, {when}{later}", place(c))
    });
    let open = match case.undecided {
        0 => String::new(),
        n => format!("; for {n} more it is not decided"),
    };
    // An impact's sentences name its largest draft and buff anyway.
    let worst = case.worst.as_ref().filter(|_| case.kind != "impact").map_or(String::new(), |worst| {
        let which = match first_to_exceed(case) {
            Some(first) if first.coupler == worst.coupler && case.exceeding == 1 => "Its largest force is".to_owned(),
            Some(first) if first.coupler == worst.coupler => "It is also the worst:".to_owned(),
            _ => format!("The worst is {}:", place(worst)),
        };
        format!(" {which} {}.{}", most_used(worst, case, units), share_of_load(worst))
    });
    format!("{head}{first}{open}.{worst}")
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

/// The verdict on a scenario: over the horizon, over the first passage where that differs, and both senses of an impact.
pub fn verdict_of(scenario: &ScenarioFindings, units: UnitSystem) -> String {
    let lead = supposed(scenario);
    let [case] = &scenario.cases[..] else { return lead + &verdict_each(scenario, units) + &first_passages(scenario) };
    lead + &verdict(case, units) + &first_passage(case) + &impact(case, units) + &meetings(case)
}

/// What the verdict supposes where further couplers break or a gap closes, as the sentence before it; empty elsewhere.
fn supposed(scenario: &ScenarioFindings) -> String {
    const SUPPOSED: &str = "the forces given here are computed as if none did";
    let all = || scenario.cases.iter().filter_map(|c| c.cascade.as_ref());
    let breaking = all().filter(|c| !c.breaks.is_empty()).count();
    let closing = all().filter(|c| c.gap_closes_s.is_some()).count();
    if scenario.cases.len() > 1 {
        let of = |n: usize| format!("{n} of {}", count(scenario.cases.len(), "break"));
        let more = format!("After {} further couplers break (see \"What breaks next\"); {SUPPOSED}. ", of(breaking));
        let gaps = format!("After {} a gap closes, and later results are not valid. ", of(closing));
        return [more, gaps]
            .into_iter()
            .zip([breaking, closing])
            .filter(|(_, n)| *n > 0)
            .map(|(text, _)| text)
            .collect();
    }
    let Some(cascade) = all().next() else { return String::new() };
    let more = match cascade.breaks.len() {
        0 => String::new(),
        1 => format!("1 further coupler breaks (see \"What breaks next\"); {SUPPOSED}. "),
        n => format!("{n} further couplers break (see \"What breaks next\"); {SUPPOSED}. "),
    };
    let gap = cascade.gap_closes_s.zip(cascade.gap_coupler);
    more + &gap.map_or(String::new(), |(at, coupler)| {
        format!("Results from {} on are not valid, because the gap at coupler {coupler} closes then. ", time(at))
    })
}

/// Where parted vehicles meet again and push each other; empty where none do, or where that is not computed.
fn meetings(case: &CaseFindings) -> String {
    let mut couplers: Vec<usize> = case.gap_closures.iter().map(|closure| closure.coupler).collect();
    couplers.sort_unstable();
    couplers.dedup();
    let Some(first) = case.gap_closures.iter().min_by(|a, b| a.time_s.total_cmp(&b.time_s)) else {
        return String::new();
    };
    format!(
        " The vehicles that part at coupler {}{} meet again at {} and push each other, which is computed.",
        first.coupler,
        more(couplers.len() - 1, "coupler"),
        time(first.time_s)
    )
}

const LOSSES: &str = "after reflections from the ends, which the losses of a real train reduce";

/// Words for exceedances after the first passage: a march includes the file's losses and brakes.
fn later_ones(case: &CaseFindings) -> &'static str {
    if case.method == "march" { "after it" } else { LOSSES }
}

/// What differs in the first passage; empty where nothing does.
fn first_passage(case: &CaseFindings) -> String {
    let later = case.exceeding.saturating_sub(case.exceeding_first_passage);
    let (Some(worst), true) = (&case.worst_first_passage, later > 0) else { return String::new() };
    let end = time(case.first_passage_s);
    let largest = format!(
        "the largest force there is {} % of its rating in {}, in {}, {}",
        percent(worst.utilisation),
        sense(worst.peak_force_n),
        place(worst),
        moment(worst.peak_time_s, case)
    );
    match case.exceeding_first_passage {
        0 => format!(
            " In the first passage, to {end}, none exceeds: {largest}. The exceedances come {}.",
            later_ones(case)
        ),
        n => {
            let exceed = if n == 1 { "exceeds" } else { "exceed" };
            let others = if later == 1 { "other comes" } else { "others come" };
            let later = later_ones(case);
            format!(" In the first passage, to {end}, {n} of them {exceed}; {largest}. The {others} {later}.")
        }
    }
}

/// The same of several breaks.
fn first_passages(scenario: &ScenarioFindings) -> String {
    let harmful = |of: fn(&CaseFindings) -> usize| scenario.cases.iter().filter(|c| of(c) > 0).count();
    let (all, early) = (harmful(|c| c.exceeding), harmful(|c| c.exceeding_first_passage));
    match all - early.min(all) {
        0 => String::new(),
        later => {
            let other = count(later, "other break");
            let later = scenario.cases.first().map_or(LOSSES, later_ones);
            format!(" In the first passage, {early} would; the exceedances after the {other} come {later}.")
        }
    }
}

/// The largest draft and buff of the first passage of a single case, beside those over all that was computed; empty for several
/// cases, whose passages end at different times.
pub fn passage(scenario: &ScenarioFindings, units: UnitSystem) -> String {
    type Peak = (usize, f64, f64);
    let [case] = &scenario.cases[..] else { return String::new() };
    let largest = |peak: &dyn Fn(&CouplerFindings) -> Option<(f64, f64)>| -> Option<Peak> {
        let all = case.couplers.iter().filter_map(|c| peak(c).map(|(f, t)| (c.coupler, f, t)));
        all.reduce(|a, b| if b.1.abs() > a.1.abs() { b } else { a })
    };
    let early = |c: &CouplerFindings| c.first_passage.clone();
    let first = [
        largest(&|c| early(c).and_then(|p| p.peak_draft_n.zip(p.peak_draft_time_s))),
        largest(&|c| early(c).and_then(|p| p.peak_buff_n.zip(p.peak_buff_time_s))),
    ];
    let all =
        [largest(&|c| c.peak_draft_n.zip(c.peak_draft_time_s)), largest(&|c| c.peak_buff_n.zip(c.peak_buff_time_s))];
    let unit =
        super::numbers::force_unit(units, first.iter().chain(&all).flatten().map(|p| p.1.abs()).fold(0.0, f64::max));
    let told = |sense: &str, peak: Option<Peak>| match peak {
        None => format!("no {sense} in any coupler"),
        Some((coupler, f, t)) => {
            let force = super::numbers::force_in(unit, f, case.error_n());
            format!("largest {sense} {force} in coupler {coupler}, at {}", time(t))
        }
    };
    let both = |[draft, buff]: [Option<Peak>; 2]| format!("{}; {}", told("draft", draft), told("buff", buff));
    if first == [None, None] && all == [None, None] {
        return String::new();
    }
    let (end, whole) = (time(case.first_passage_s), brief_time(case.horizon_s));
    if case.first_passage_s >= case.horizon_s {
        return format!("Over all {whole}, which end before the wave has come back from the far end: {}.", both(all));
    }
    let passage =
        format!("In the first passage, until the wave has come back from the far end at {end}: {}.", both(first));
    match first == all {
        true => passage + " No later force is larger.",
        false => format!("{passage} Over all {whole}: {}.", both(all)),
    }
}

/// The largest shares of a rating in buff and in draft of an impact: those of the collision and of the rebound.
fn impact(case: &CaseFindings, units: UnitSystem) -> String {
    if case.kind != "impact" {
        return String::new();
    }
    let largest = |value: fn(&CouplerFindings) -> Option<(f64, f64, f64)>| {
        let found = case.couplers.iter().filter_map(|c| value(c).map(|v| (c, v)));
        found.reduce(|a, b| if b.1.2 > a.1.2 { b } else { a })
    };
    let buff = largest(|c| Some((c.peak_buff_n?, c.peak_buff_time_s?, -c.peak_buff_n? / c.rated_buff_n)));
    let draft = largest(|c| Some((c.peak_draft_n?, c.peak_draft_time_s?, c.peak_draft_n? / c.rated_draft_n)));
    let forces = [&buff, &draft].into_iter().flatten().map(|(_, value)| value.0.abs());
    let unit = super::numbers::force_unit(units, forces.fold(0.0, f64::max));
    let told = |(c, (newtons, at, share)): (&CouplerFindings, (f64, f64, f64))| {
        let force = super::numbers::force_in(unit, newtons, case.error_n());
        format!("{} % ({force}) in coupler {}, {}", percent(share), c.coupler, moment(at, case))
    };
    let of = |sense: &str, found: Option<_>| {
        found.map_or(String::new(), |f| format!(" Largest share of a rating in {sense}: {}.", told(f)))
    };
    let rebound = if draft.is_some() && case.method != "march" {
        " The draft after the collision includes the rebound of the springs. A real draft gear absorbs up to 87 % of the work, so this \
         draft is too large unless the damping in the file represents that loss."
    } else {
        ""
    };
    of("buff", buff) + &of("draft", draft) + rebound
}

/// The verdict on a scenario of many cases, in one sentence.
fn verdict_each(scenario: &ScenarioFindings, units: UnitSystem) -> String {
    if scenario.cases.is_empty() {
        let couplers = count(scenario.left_out_in_buff.len(), "coupler");
        return format!("No break is computed: {couplers} would break in turn, but carry buff, so that nothing parts.");
    }
    let breaks = count(scenario.cases.len(), "break");
    let harmful = scenario.cases.iter().filter(|c| c.exceeding > 0).count();
    let open = scenario.cases.iter().filter(|c| c.exceeding == 0 && c.undecided > 0).count();
    let open = if open > 0 { format!("; for {open} it is not decided") } else { String::new() };
    let Some((case, worst)) = worst_case(scenario) else {
        return format!("None of {breaks} leaves a coupler to watch{open}.");
    };
    let broken = case.broken_coupler.unwrap_or_default();
    let extreme = format!("{}, when coupler {broken} breaks: {}", place(worst), most_used(worst, case, units));
    let load = share_of_load(worst);
    match harmful {
        0 => format!(
            "None of {breaks} would overload another coupler{open}. The nearest to its rating is {extreme}.{load}"
        ),
        n => format!("{n} of {breaks} would overload another coupler{open}. The worst is {extreme}.{load}"),
    }
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

/// The ratings that a coupler needs in the senses in which its largest force, with its error, is over the rating: "1.509 N in draft".
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
