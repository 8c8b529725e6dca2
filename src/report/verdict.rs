//! The verdict on a scenario, in sentences: over the horizon, over the first passage, and in both senses of an impact.

use super::numbers::{brief_time, digits, percent, time};
use super::words::{count, first_to_exceed, interval, moment, place, rating, sense, undecided, worst_case};
use crate::findings::{CaseFindings, CouplerFindings, ScenarioFindings};
use crate::train::more;
use crate::units::UnitSystem;

/// "after coupler 53 breaks", "under the pulse".
fn after(case: &CaseFindings) -> String {
    match case.broken_coupler {
        Some(b) => format!("after coupler {b} breaks"),
        None if case.kind == "impact" => "in the impact".to_owned(),
        None if case.kind == "brake" => "while the brakes are applied".to_owned(),
        None => "under the pulse".to_owned(),
    }
}

/// Whether the load alone is over a coupler's rating.
fn over_before(c: &CouplerFindings) -> bool {
    c.initial_force_n > c.rated_draft_n || -c.initial_force_n > c.rated_buff_n
}

/// Whether a coupler exceeds its rating in draft at one time and in buff at another.
fn exceeds_both_ways(c: &CouplerFindings) -> bool {
    c.peak_draft_n.is_some_and(|f| f > c.rated_draft_n) && c.peak_buff_n.is_some_and(|f| -f > c.rated_buff_n)
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

/// The verdict on a scenario: over the horizon, over the first passage where that differs, and both senses of an impact.
pub fn verdict_of(scenario: &ScenarioFindings, units: UnitSystem) -> String {
    let lead = assumption(scenario);
    let [case] = &scenario.cases[..] else { return lead + &verdict_each(scenario, units) + &first_passages(scenario) };
    lead + &verdict(case, units) + &first_passage(case) + &impact(case, units) + &meetings(case)
}

/// What the verdict supposes where further couplers break or a gap closes, as the sentence before it; empty elsewhere.
fn assumption(scenario: &ScenarioFindings) -> String {
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

/// How many of several breaks lead to an exceedance within the first passage; empty if none does later.
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
