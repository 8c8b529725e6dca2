//! What the report says of couplers that break one after the other.

use super::numbers::{Unit, force_in, given_force_in, percent, time};
use super::words::{count, moment, sense};
use crate::findings::{CascadeBreak, CascadeFindings, CaseFindings, CouplerFindings, PeakForces, ScenarioFindings};
use crate::train::LIMITS;
use crate::units::UnitSystem;

/// Smallest uncertainty of a time that is shown, as a share of it.
const SEEN: f64 = 1e-4;
/// Pieces listed at most; more are counted.
const TOLD: usize = 8;

/// What breaks after the event and what is left of the train; empty where the scenario has no cascade.
pub fn sentence(scenario: &ScenarioFindings) -> String {
    let cascades: Vec<(&CaseFindings, &CascadeFindings)> =
        scenario.cases.iter().filter_map(|c| Some((c, c.cascade.as_ref()?))).collect();
    match cascades[..] {
        [] => String::new(),
        [(case, cascade)] => of_one(case, cascade),
        _ => of_many(&cascades),
    }
}

/// Couplers that break after the event, as a cell: their number, or after how many breaks; or empty.
pub fn brief(scenario: &ScenarioFindings) -> String {
    let further: Vec<usize> =
        scenario.cases.iter().filter_map(|c| Some(c.cascade.as_ref()?.breaks.len())).filter(|n| *n > 0).collect();
    match (&further[..], scenario.cases.len()) {
        ([], _) => String::new(),
        ([n], 1) => n.to_string(),
        (some, all) => format!("after {} of {}", some.len(), count(all, "break")),
    }
}

fn of_one(case: &CaseFindings, cascade: &CascadeFindings) -> String {
    let decided: Vec<&CascadeBreak> = cascade.breaks.iter().filter(|b| is_decided(b, cascade)).collect();
    let breaks = match &decided[..] {
        [] => "No further coupler breaks".to_owned(),
        [first, ..] => {
            let which = format!("coupler {} (between {} and {})", first.coupler, first.between[0], first.between[1]);
            let head = match decided.len() {
                1 => format!("One more coupler breaks: {which}"),
                n => format!("{n} more couplers break, the first of them {which}"),
            };
            format!("{head}, in {}, {}", sense(first.force_n), moment(first.time_s, case))
        }
    };
    let [kept, closed, breaks_at] = [kept(cascade), closed(cascade), breaks_at(cascade)];
    let pieces = pieces(cascade);
    match open(cascade, cascade.breaks.len() - decided.len()) {
        None => format!("{breaks}; {pieces}.{kept}{closed} {breaks_at}"),
        Some(open) => format!("{breaks}.{kept} {open}{pieces}.{closed} {breaks_at}"),
    }
}

/// Whether a break comes before the sequence is in doubt.
fn is_decided(b: &CascadeBreak, cascade: &CascadeFindings) -> bool {
    cascade.undecided_from_s.is_none_or(|from| b.time_s < from)
}

/// Which load breaks a coupler.
fn breaks_at(cascade: &CascadeFindings) -> String {
    let ultimate = cascade.breaks_at.contains(&LIMITS[2]);
    let why = match cascade.breaks_at.len() {
        1 if ultimate => "ultimate load",
        _ if ultimate => "ultimate load, or at its rating where no ultimate load was given",
        _ => "rating, because no ultimate load was given",
    };
    format!("A coupler breaks at its {why}.")
}

/// What the load that breaks a coupler is called.
fn breaking_load(cascade: &CascadeFindings) -> &'static str {
    match (cascade.breaks_at.contains(&LIMITS[2]), cascade.breaks_at.len()) {
        (false, _) => "rating",
        (true, 1) => "ultimate load",
        (true, _) => "breaking load",
    }
}

fn pieces(cascade: &CascadeFindings) -> String {
    let named = |p: &[usize; 2]| if p[0] == p[1] { p[0].to_string() } else { format!("{} to {}", p[0], p[1]) };
    match &cascade.pieces[..] {
        [_] => "the train stays whole".to_owned(),
        all if all.len() > TOLD => format!("the train is left in {} pieces", all.len()),
        all => {
            let names: Vec<String> = all.iter().map(named).collect();
            format!("the train is left in {} pieces: vehicles {}", all.len(), names.join(", "))
        }
    }
}

fn kept(cascade: &CascadeFindings) -> String {
    match cascade.kept_in_buff.len() {
        0 => String::new(),
        n if cascade.buff_breaks => {
            format!(" {} would still pass the {} in buff.", count(n, "coupler"), breaking_load(cascade))
        }
        n => format!(
            " {} of what is left {} the {} in buff on the way, which does not part a coupler here.",
            count(n, "coupler"),
            if n == 1 { "passes" } else { "pass" },
            breaking_load(cascade)
        ),
    }
}

/// A sentence that says from when on the sequence is not decided, and the first words of the next one, which tells the pieces that are left
/// if that coupler holds.
fn open(cascade: &CascadeFindings, later: usize) -> Option<String> {
    let from = cascade.undecided_from_s?;
    let Some(coupler) = cascade.undecided_coupler else {
        return Some(format!(
            "The motion is followed to {} only, and what breaks later is not known. Until then ",
            time(from)
        ));
    };
    let later = match later {
        0 => String::new(),
        1 => "one more breaks later, and ".to_owned(),
        n => format!("{n} more break later, and "),
    };
    Some(format!(
        "Not decided from {} on: coupler {coupler} comes within the error bound of its {}, and whether it breaks then \
         cannot be told. If it holds, {later}",
        time(from),
        breaking_load(cascade)
    ))
}

fn closed(cascade: &CascadeFindings) -> String {
    let (Some(from), Some(coupler)) = (cascade.gap_closes_s, cascade.gap_coupler) else { return String::new() };
    format!(
        " Not valid from {} on: the gap at coupler {coupler} closes then, and its vehicles would push each other, which is not \
         computed.",
        time(from)
    )
}

fn of_many(cascades: &[(&CaseFindings, &CascadeFindings)]) -> String {
    let more = cascades.iter().filter(|(_, c)| !c.breaks.is_empty()).count();
    let open = match cascades.iter().filter(|(_, c)| c.undecided_from_s.is_some()).count() {
        0 => String::new(),
        n => format!(" In {} the sequence is not decided to its end.", count(n, "case")),
    };
    let closed = match cascades.iter().filter(|(_, c)| c.gap_closes_s.is_some()).count() {
        0 => String::new(),
        n => format!(" In {} a gap closes again, and what follows it is not valid.", count(n, "case")),
    };
    let open = open + &closed;
    let most = cascades.iter().reduce(|a, b| if b.1.breaks.len() > a.1.breaks.len() { b } else { a });
    let Some((case, worst)) = most.filter(|_| more > 0) else {
        let at = cascades.first().map(|(_, c)| breaks_at(c)).unwrap_or_default();
        return format!("In none of {} does a further coupler break.{open} {at}", count(cascades.len(), "case"));
    };
    let at = breaks_at(worst);
    format!(
        "In {more} of {} further couplers break; the most after that of coupler {}: {} more.{open} {at}",
        count(cascades.len(), "case"),
        case.broken_coupler.unwrap_or_default(),
        worst.breaks.len()
    )
}

/// A row of the sequence.
pub fn row(b: &CascadeBreak, cascade: &CascadeFindings, units: UnitSystem, unit: Unit) -> Vec<String> {
    let apart = if b.time_uncertainty_s > SEEN * b.time_s {
        format!(" ± {}", time(b.time_uncertainty_s))
    } else {
        String::new()
    };
    let supposed = if is_decided(b, cascade) { "" } else { " (not decided)" };
    vec![
        time(b.time_s) + &apart,
        format!("{}{}{supposed}", b.coupler, if b.together { " (with others)" } else { "" }),
        b.between.join(", "),
        // It breaks at this load, however well the instant is known.
        format!("{} in {}", force_in(unit, b.force_n, 0.0), sense(b.force_n)),
        (if b.breaks_at == LIMITS[2] { "ultimate load" } else { "rating" }).to_owned(),
        units.energy(b.energy_j),
    ]
}

/// A coupler with its largest force in the cascade, N, when it is, s, and its utilisation.
type Force<'a> = (&'a CouplerFindings, &'a PeakForces, (f64, f64, f64));

/// The couplers with their largest forces in the cascade, worst first.
pub fn forces(case: &CaseFindings) -> Vec<Force<'_>> {
    let mut all: Vec<Force> = case
        .couplers
        .iter()
        .filter_map(|c| Some((c, c.cascade.as_ref()?)))
        .filter_map(|(c, peaks)| Some((c, peaks, peaks.most_used(c)?)))
        .collect();
    all.sort_by(|a, b| b.2.2.total_cmp(&a.2.2));
    all
}

/// A row of them.
pub fn force_row(
    (c, peaks, (force_n, at_s, utilisation)): Force,
    cascade: &CascadeFindings,
    unit: Unit,
) -> Vec<String> {
    let error_n = peaks.error_estimate_n.unwrap_or(cascade.error_bound_n);
    let of_time = |b: &&CascadeBreak| b.coupler == c.coupler && b.time_s == at_s;
    let mark = match cascade.breaks.iter().find(of_time) {
        _ if at_s >= cascade.certain_until_s() => " (not decided)",
        Some(_) => " (breaks)",
        None if peaks.exceeds.is_none() => " (not decided)",
        None => "",
    };
    let rating = if force_n < 0.0 { c.rated_buff_n } else { c.rated_draft_n };
    vec![
        c.coupler.to_string(),
        c.between.join(", "),
        format!("{} in {}", force_in(unit, force_n, error_n), sense(force_n)),
        given_force_in(unit, rating),
        format!("{} %{mark}", percent(utilisation)),
        time(at_s),
        format!("{} %", percent(c.utilisation)),
    ]
}
