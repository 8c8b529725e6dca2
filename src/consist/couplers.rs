//! The couplers of a train file: `[coupler]`, what a table of vehicles says of them, and `[[coupler_override]]`.

use std::collections::HashMap;
use std::ops::Range;
use std::path::Path;

use super::Files;
use super::keys::{BEHIND, COUPLER};
use super::labels::Labels;
use super::laws::LawKeys;
use super::tree::{Read, Table, Value};
use super::vehicles::Group;
use crate::error::quoted;
use crate::law::Law;
use crate::train::{CouplerSpec, LIMITS, Limits, SENSES};
use crate::units::Amount;

/// What a table says of some couplers beyond `[coupler]`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct OwnKeys {
    law: LawKeys,
    draft: Option<Amount>,
    buff: Option<Amount>,
    limits: Option<Limits>,
    damping_n_s_per_m: Option<f64>,
}

impl OwnKeys {
    /// Reads a table; files that it names stand beside the train file `path`.
    pub(super) fn read(table: &Table, path: &Path, files: &Files) -> Read<OwnKeys> {
        let damping = table.get("damping").map(|v| v.quantity()).transpose();
        let law = LawKeys::read(table, path, files);
        let [draft, buff] = ["rated_load", "rated_buff"].map(|key| table.get(key).map(|v| v.amount()).transpose());
        let limits = table.get("limits").as_ref().map(limits).transpose();
        Ok(OwnKeys { law: law?, draft: draft?, buff: buff?, limits: limits?, damping_n_s_per_m: damping? })
    }

    /// Whether it says anything.
    pub(super) fn gives_anything(&self) -> bool {
        let OwnKeys { law, draft, buff, limits, damping_n_s_per_m } = self;
        let rated = draft.is_some() || buff.is_some() || limits.is_some();
        rated || law.gives_anything() || damping_n_s_per_m.is_some()
    }

    /// Overrides a coupler's values; a share in `rated_load` is of `[coupler]`'s.
    fn apply(&self, base: &CouplerValues, coupler: &mut CouplerValues) {
        if self.law.gives_anything() {
            coupler.law = self.law.or(&coupler.law);
        }
        coupler.buff = self.buff.unwrap_or(coupler.buff);
        coupler.damping_n_s_per_m = self.damping_n_s_per_m.unwrap_or(coupler.damping_n_s_per_m);
        coupler.draft_n = match self.draft {
            Some(Amount::Si(value)) => value,
            Some(Amount::Share(share)) => share * base.draft_n,
            None => coupler.draft_n,
        };
        if let Some(own) = self.limits {
            coupler.limits = own.or(&coupler.limits);
        }
    }
}

/// A `limits` table: its capacities are of both senses, unless its table of a sense gives another.
fn limits(value: &Value) -> Read<Limits> {
    let table = value.table()?;
    let both = capacities(value, &table);
    let own = SENSES.map(|sense| match table.get(sense) {
        None => Ok([None; 3]),
        Some(value) => value.table().and_then(|table| capacities(&value, &table)),
    });
    let ([draft, buff], both) = (own, both?);
    let own = Limits { draft_n: draft?, buff_n: buff? };
    for (l, name) in LIMITS.into_iter().enumerate() {
        if let (Some(plain), Some(_), Some(_)) = (table.get(name), own.draft_n[l], own.buff_n[l]) {
            let title = format!("{name} is given for draft and for buff as well, so this one has no effect");
            return Err(plain.wrong(title, "remove it, or one of the two in limits.draft and limits.buff"));
        }
    }
    Ok(own.or(&Limits::both(both)))
}

/// The capacities that a table has by name.
fn capacities(value: &Value, table: &Table) -> Read<[Option<f64>; 3]> {
    let [fatigue, proof, ultimate] = LIMITS.map(|key| table.get(key).map(|v| v.quantity()).transpose());
    if table.is_empty() {
        let title = format!("{} is empty", value.name_of_key());
        return Err(value.wrong(title, "give it fatigue, proof or ultimate: fatigue = \"970 kN\""));
    }
    Ok([fatigue?, proof?, ultimate?])
}

/// A coupler's law, ratings, limits and damping, as read so far; a share in `buff` is of the coupler's own draft rating.
#[derive(Clone)]
pub(super) struct CouplerValues {
    pub(super) law: LawKeys,
    pub(super) draft_n: f64,
    buff: Amount,
    limits: Limits,
    damping_n_s_per_m: f64,
}

/// Stands in for a `[coupler]` that was wrong, so that what refers to it can still be looked at.
pub(super) const PLACEHOLDER: CouplerValues = CouplerValues {
    law: LawKeys::linear(1.0),
    draft_n: 1.0,
    buff: Amount::Share(1.0),
    limits: Limits::both([None; 3]),
    damping_n_s_per_m: 0.0,
};

/// For a message about a key missing from `[coupler]`: that a row of the table of vehicles overrides it, if there is such a table.
pub(super) fn table_takes_precedence(root: &Table) -> &'static str {
    if root.get("vehicles").is_some() { "; what a coupler's row of the table has goes before it" } else { "" }
}

pub(super) fn coupler_table<'s>(root: &Table<'s>) -> Read<Table<'s>> {
    let right = format!("add a [coupler] table with stiffness and rated_load{}", table_takes_precedence(root));
    root.require("coupler", &right)?.table()
}

/// The values of `[coupler]`, whose stiffness or gear may be left out where every coupler has one of its own; where some are wrong,
/// those of the placeholder with its law.
pub(super) fn base_coupler(root: &Table, table: &Table, path: &Path, files: &Files) -> CouplerValues {
    let damping = table.get("damping").map(|v| v.quantity()).transpose();
    let law = LawKeys::read(table, path, files).and_then(|law| checked_law(table, law)).unwrap_or(PLACEHOLDER.law);
    let draft = table
        .require(
            "rated_load",
            &format!("add rated_load = \"1.5 MN\", the capacity in draft{}", table_takes_precedence(root)),
        )
        .and_then(|v| v.quantity());
    let buff = table.get("rated_buff").map_or(Ok(Amount::Share(1.0)), |v| v.amount());
    let limits = table.get("limits").as_ref().map_or(Ok(Limits::default()), limits);
    match (draft, buff, limits, damping) {
        (Ok(draft_n), Ok(buff), Ok(limits), Ok(damping)) => {
            CouplerValues { law, draft_n, buff, limits, damping_n_s_per_m: damping.unwrap_or(0.0) }
        }
        _ => CouplerValues { law, ..PLACEHOLDER },
    }
}

/// Checks that the keys of a law are consistent, if they give a force; else notes the problem at its key in the table.
fn checked_law(table: &Table, law: LawKeys) -> Read<LawKeys> {
    if !law.gives_force() {
        return Ok(law);
    }
    match law.law() {
        Ok(_) => Ok(law),
        Err((key, title, help)) => Err(match table.get(key) {
            Some(value) => value.wrong(title, help),
            None => table.wrong(title, help),
        }),
    }
}

/// What a table of vehicles says of the couplers behind them.
pub(super) fn apply_table_columns(
    root: &Table,
    ratings: &mut [CouplerValues],
    bases: &[CouplerValues],
    groups: &[Group],
    behind: &[OwnKeys],
) -> Read<()> {
    let own = groups.iter().zip(behind).flat_map(|(group, own)| std::iter::repeat_n(own, group.vehicle.count));
    ratings.iter_mut().zip(bases).zip(own).for_each(|((coupler, base), own)| own.apply(base, coupler));
    let Some(table) = root.get("vehicles") else { return Ok(()) };
    for (i, rating) in ratings.iter().enumerate().filter(|(_, rating)| rating.law.gives_force()) {
        let wrong = |(_, title, help)| table.wrong(format!("the table's coupler {}: {title}", i + 1), help);
        rating.law.law().map_err(wrong)?;
    }
    Ok(())
}

/// Applies the overrides, and says where each key of each coupler is overridden.
pub(super) fn override_couplers(
    root: &Table,
    bases: &[CouplerValues],
    ratings: &mut [CouplerValues],
    labels: &Labels,
    path: &Path,
    files: &Files,
) -> Overridden {
    let overrides = root.get("coupler_override").and_then(|v| v.tables().ok());
    let mut overridden = HashMap::new();
    for table in overrides.into_iter().flatten() {
        // A problem in it has been noted: the other overrides can be read all the same.
        let own = OwnKeys::read(&table, path, files);
        let _ = apply_override(&table, own, bases, ratings, labels, &mut overridden);
    }
    overridden
}

/// Where each key of each coupler was overridden: the key and its value.
pub(super) type Overridden = HashMap<(usize, &'static str), [Range<usize>; 2]>;

fn apply_override(
    table: &Table,
    own: Read<OwnKeys>,
    bases: &[CouplerValues],
    ratings: &mut [CouplerValues],
    labels: &Labels,
    overridden: &mut Overridden,
) -> Read<()> {
    // A misspelt key has been noted, and is the reason.
    if COUPLER.names().all(|key| table.key_span(key).is_none()) && !table.has_unknown_keys() {
        table.wrong("[[coupler_override]] overrides nothing", "give it a key of [coupler], such as rated_load");
    }
    let right = format!("expected a coupler's number from 1 to {}, or a list of them", ratings.len());
    let at = table.require("at", &right).and_then(|v| coupler_list(&v, labels, &right));
    let (at, own) = (at?, own?);
    for i in at {
        for key in COUPLER.names() {
            let (Some(span), Some(value)) = (table.key_span(key), table.get(key)) else { continue };
            if let Some([earlier, _]) = overridden.insert((i, key), [span.clone(), value.span()]) {
                let title = format!("coupler {} has its {key} overridden twice", i + 1);
                return Err(table.note_because(span, title, "keep one of the two", earlier, "overridden here before"));
            }
        }
        own.apply(&bases[i], &mut ratings[i]);
        if own.law.gives_anything() {
            checked_law(table, ratings[i].law.clone())?;
        }
    }
    Ok(())
}

/// Couplers, one or a list, each once and by its number or the vehicle ahead of it; as indices from 0.
pub(super) fn coupler_list(value: &Value, labels: &Labels, right: &str) -> Read<Vec<usize>> {
    let mut seen: HashMap<usize, Range<usize>> = HashMap::new();
    let mut numbers = vec![];
    for item in value.items() {
        let number = coupler(&item, labels, right)?;
        if let Some(earlier) = seen.insert(number, item.span()) {
            let title = format!("coupler {number} is listed twice");
            return Err(item.wrong_because(title, "list it once", earlier, "listed here before"));
        }
        numbers.push(number - 1);
    }
    if numbers.is_empty() {
        return Err(value.wrong("the list of couplers is empty", right));
    }
    Ok(numbers)
}

/// A coupler's number, from 1.
fn coupler(item: &Value, labels: &Labels, right: &str) -> Read<usize> {
    let count = labels.count - 1;
    let Some(table) = item.table_if(&BEHIND) else {
        return item.number(count, |n| format!("the train has no coupler {n}"), right);
    };
    let behind = table?.require("behind", "add behind, the label of the vehicle ahead of the coupler")?;
    let label = behind.name()?;
    let number = labels.vehicle(&behind, label, "the coupler's number instead of { behind = ... }")? + 1;
    if number > count {
        let help = "name the vehicle ahead of the coupler";
        return Err(behind.wrong(format!("no coupler is behind {}, the last vehicle", quoted(label)), help));
    }
    labels.note(format!("coupler {number} is behind {}", quoted(label)));
    Ok(number)
}

/// The couplers with their laws.
pub(super) fn specs(ratings: Vec<CouplerValues>) -> Vec<CouplerSpec> {
    let mut all: Vec<CouplerSpec> = Vec::with_capacity(ratings.len());
    let mut before: Option<LawKeys> = None;
    for r in ratings {
        let again = all.last().filter(|_| before.as_ref() == Some(&r.law)).map(|coupler| coupler.law.clone());
        // A wrong law has been noted or replaced before.
        let law = again.unwrap_or_else(|| r.law.law().unwrap_or(Law::linear(1.0)));
        let rated_buff_n = match r.buff {
            Amount::Si(value) => value,
            Amount::Share(share) => share * r.draft_n,
        };
        let (limits, dashpot_n_s_per_m) = (r.limits, r.damping_n_s_per_m);
        all.push(CouplerSpec { law, rated_draft_n: r.draft_n, rated_buff_n, limits, dashpot_n_s_per_m });
        before = Some(r.law);
    }
    all
}
