//! The text of an imported train file.

use std::collections::{BTreeMap, HashMap};
use std::fmt::Write as _;

use super::{Draft, Given, Group};
use crate::consist::keys::COUPLER;
use crate::error::{harmless, printable, quoted};
use crate::keys::Key;

/// Comments start in this column, where the value leaves room.
const COLUMN: usize = 44;

/// Couplers, from 0, by key: their value and where it comes from.
type ByKey<'d> = BTreeMap<&'d str, BTreeMap<usize, &'d Given>>;

/// The file's text, and what is missing in it.
pub(super) fn write(draft: &Draft) -> (String, Vec<String>) {
    let groups = together(&draft.groups);
    let by_key = couplers(&draft.groups);
    let total: usize = draft.groups.iter().map(|g| g.count).sum();
    let mut missing = vec![];
    let mut body = coupler_table(&by_key, total.saturating_sub(1), &mut missing);
    for group in &groups {
        body += "\n[[vehicle]]\n";
        for given in &group.vehicle {
            line(&mut body, &format!("{} = {}", given.key, given.value), &given.from);
        }
        if group.count > 1 {
            line(&mut body, &format!("count = {}", group.count), "alike, one behind the other");
        }
        for [key, why] in &group.missing {
            line(&mut body, &format!("# {key} = \"...\""), &format!("MISSING: {why}"));
            missing.push(format!("{key} of a vehicle: {why}"));
        }
    }
    body += &overrides(&by_key, total.saturating_sub(1));
    body += &load(draft);
    (head(draft, &missing) + &body, missing)
}

fn head(draft: &Draft, missing: &[String]) -> String {
    let source = quoted(&printable(&draft.source));
    let mut text = format!("# Made from {source} by trainsafe {}.\n", env!("CARGO_PKG_VERSION"));
    text += "# The comment behind each value names its source; missing values are marked MISSING.\n";
    for what in missing {
        let _ = writeln!(text, "# MISSING: {}", harmless(what));
    }
    for remark in &draft.remarks {
        let _ = writeln!(text, "# {}", harmless(remark));
    }
    for doubt in &draft.doubts {
        let _ = writeln!(text, "# Doubtful: {}", harmless(&doubt.text));
    }
    text += "\n";
    line(&mut text, &format!("name = {}", toml_string(&draft.name)), &format!("of {source}"));
    text
}

/// Neighbours with the same values, in one group; their sources as a range of rows.
fn together(groups: &[Group]) -> Vec<Group> {
    let values = |g: &Group| g.vehicle.iter().map(|v| (v.key.clone(), v.value.clone())).collect::<Vec<_>>();
    let mut all: Vec<(Group, Vec<String>)> = vec![];
    for group in groups {
        let alike = |last: &Group| values(last) == values(group) && last.missing == group.missing;
        let first_source = group.vehicle.first().map_or(String::new(), |v| v.from.clone());
        match all.last_mut().filter(|(last, _)| alike(last) && !held(last)) {
            Some((last, sources)) => {
                last.count += group.count;
                sources.push(first_source);
            }
            None => {
                let Group { count, vehicle, missing, .. } = group;
                let group =
                    Group { count: *count, vehicle: vehicle.clone(), coupler: vec![], missing: missing.clone() };
                all.push((group, vec![first_source]));
            }
        }
    }
    let told = all.into_iter().map(|(mut group, sources)| {
        if let [_, .., last] = sources.as_slice() {
            let upto = last.split(',').next().unwrap_or_default();
            for given in &mut group.vehicle {
                given.from = format!("{}, and alike to {upto}", given.from);
            }
        }
        group
    });
    told.collect()
}

fn held(group: &Group) -> bool {
    group.vehicle.iter().any(|v| v.key == "held" && v.value == "true")
}

/// The values given for each coupler; behind the last vehicle there is none.
fn couplers(groups: &[Group]) -> ByKey<'_> {
    let total: usize = groups.iter().map(|g| g.count).sum();
    let mut by_key = ByKey::new();
    let mut at = 0;
    for group in groups {
        for coupler in at..(at + group.count).min(total.saturating_sub(1)) {
            for given in &group.coupler {
                by_key.entry(&given.key).or_default().insert(coupler, given);
            }
        }
        at += group.count;
    }
    by_key
}

/// The commonest value of a key and its count, if all couplers have one and it may stand in `[coupler]`.
fn common<'d>(of: &BTreeMap<usize, &'d Given>, couplers: usize, key: &str) -> Option<(&'d Given, usize)> {
    // A share needs the rating in [coupler], which is not known.
    let share = key == "rated_load" && of.values().any(|given| given.value.contains('%'));
    if of.len() < couplers || share {
        return None;
    }
    let mut counts: HashMap<&str, usize> = HashMap::new();
    of.values().for_each(|given| *counts.entry(&given.value).or_default() += 1);
    let most = counts.values().copied().max()?;
    let first = of.values().find(|given| counts[given.value.as_str()] == most)?;
    Some((*first, most))
}

fn coupler_table(by_key: &ByKey, couplers: usize, missing: &mut Vec<String>) -> String {
    let mut text = "\n[coupler]\n".to_owned();
    // A coupler without a gear has a stiffness.
    let needed = |key: &&Key| key.required || key.name == "stiffness" && !by_key.contains_key("gear");
    for key in COUPLER.keys.iter().filter(needed) {
        if by_key.get(key.name).and_then(|of| common(of, couplers, key.name)).is_none() {
            let known = by_key.get(key.name).map_or(0, BTreeMap::len);
            let of = if known == 0 { "no coupler".to_owned() } else { format!("{known} of {couplers} couplers") };
            line(
                &mut text,
                &format!("# {} = \"{}\"", key.name, key.example),
                "MISSING: this is an example, not a value of this train",
            );
            missing.push(format!("coupler.{}: given for {of}", key.name));
        }
    }
    for (key, of) in by_key {
        if let Some((given, count)) = common(of, couplers, key) {
            let of_all =
                if count == couplers { "all couplers".into() } else { format!("{count} of {couplers} couplers") };
            line(&mut text, &format!("{key} = {}", given.value), &format!("{of_all}; {}", given.from));
        }
    }
    text
}

/// Couplers that differ from `[coupler]`, those alike together.
fn overrides(by_key: &ByKey, couplers: usize) -> String {
    let mut own: BTreeMap<usize, Vec<&Given>> = BTreeMap::new();
    for (key, of) in by_key {
        let base = common(of, couplers, key).map(|(given, _)| &given.value);
        for (coupler, given) in of.iter().filter(|(_, given)| Some(&given.value) != base) {
            own.entry(*coupler).or_default().push(given);
        }
    }
    let mut alike: Vec<(Vec<&Given>, Vec<usize>)> = vec![];
    let mut known: HashMap<Vec<(&str, &str)>, usize> = HashMap::new();
    for (coupler, given) in own {
        let values = given.iter().map(|g| (g.key.as_str(), g.value.as_str())).collect();
        let at = *known.entry(values).or_insert(alike.len());
        if at == alike.len() {
            alike.push((given, vec![]));
        }
        alike[at].1.push(coupler + 1);
    }
    let mut text = String::new();
    for (given, at) in alike {
        let list: Vec<String> = at.iter().map(usize::to_string).collect();
        let _ = write!(text, "\n[[coupler_override]]\nat = [{}]\n", list.join(", "));
        let first = if at.len() > 1 { "the first: " } else { "" };
        for given in given {
            line(&mut text, &format!("{} = {}", given.key, given.value), &format!("{first}{}", given.from));
        }
    }
    text
}

/// Load and scenarios, which no table gives.
fn load(draft: &Draft) -> String {
    let forces = ["tractive_effort", "brake_force", "rolling_resistance", "grade"];
    let given = draft.groups.iter().flat_map(|g| &g.vehicle).any(|v| forces.contains(&v.key.as_str()));
    let load = if given {
        "\n# The load before the event follows from the forces on the vehicles.\n"
    } else {
        "\n# The load before the event is not given: without one the couplers carry no force, and a break has no effect.\n\
         # [load]\n# uniform = \"0.6 MN\"\n"
    };
    format!("{load}\n# Without a [[scenario]] each coupler breaks in turn; `trainsafe new` shows the others.\n")
}

fn line(text: &mut String, what: &str, comment: &str) {
    let _ = writeln!(text, "{what:<COLUMN$}# {}", harmless(comment));
}

/// A string as TOML has it.
pub(super) fn toml_string(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
