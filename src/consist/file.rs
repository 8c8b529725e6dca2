//! A train file's tables into a train.

use std::collections::HashMap;
use std::ops::Range;
use std::path::Path;

use toml::de::DeTable;

use super::extras::{Extras, LIMITS, Limits, SENSES};
use super::keys::{BEHIND, COUPLER, TRAIN};
use super::labels::{Labels, numbered};
use super::laws::{LawKeys, secant_n_per_m};
use super::loads::{self, Loads, OwnLoad};
use super::scenarios;
use super::table::Rows;
use super::tree::{Found, Read, Table, Value};
use super::{Coupler, EachCoupler, Files, MOST_VEHICLES, Origin, STDIN, Train};
use crate::error::{Problem, printable, quoted};
use crate::law::Law;
use crate::play::Rule;
use crate::scenario::{self, Scenario};
use crate::units::{Amount, UnitSystem};

/// Reads the whole train, going on after a problem as far as what follows can be judged without it.
///
/// A value that was wrong is replaced by some right one so that the rest is still looked at. The train is good only if no
/// problem has been noted. `rows` are those of the table that the file's `vehicles` names.
/// `each` gives each coupler a `[coupler]` of its own.
pub(super) fn train(
    found: &Found,
    root: &Table,
    rows: Option<Rows>,
    each: Option<EachCoupler>,
    path: &Path,
    files: &Files,
) -> Read<Train> {
    let name = root.get("name").map_or_else(|| Ok(stem(path)), |v| v.name().map(str::to_owned));
    let base = base_coupler(root, path, files).unwrap_or(PLACEHOLDER);
    let (groups, behind) = match rows {
        Some(Rows { groups, behind, doubts }) => {
            doubts.into_iter().for_each(|doubt| found.doubt(doubt));
            (tabled(root, groups)?, behind)
        }
        None => (spelt_out(found, root)?, vec![]),
    };
    let own: Vec<OwnLoad> = groups.iter().flat_map(|g| std::iter::repeat_n(g.load, g.count)).collect();
    let vehicles = numbered(&groups);
    let labels = Labels::new(&vehicles);
    let bases = match each {
        Some(each) => {
            let drawn = |text: &String| drawn_coupler(found, text, path, files);
            each(vehicles.len() - 1).iter().map(drawn).collect::<Read<_>>()?
        }
        None => vec![base; vehicles.len() - 1],
    };
    let mut ratings = bases.clone();
    rate_by_table(&mut ratings, &bases, &groups, &behind);
    if let Some(table) = root.get("vehicles") {
        for (i, rating) in ratings.iter().enumerate() {
            in_order(rating.limits, &table, &format!("the table's coupler {}: ", i + 1))?;
            rating
                .law
                .law()
                .map_err(|(_, title, help)| table.wrong(format!("the table's coupler {}: {title}", i + 1), help))?;
        }
    }
    let ratings = couplers(root, &bases, ratings, &labels, path, files);
    let mut couplers: Vec<Coupler> = ratings.iter().map(Ratings::coupler).collect();
    let weakest_n = couplers.iter().map(|c| c.rated_draft_n).fold(f64::INFINITY, f64::min);
    let laws = laws(root, &ratings)?;
    let load = loads::read(root, &vehicles, &couplers, !laws.is_empty(), &own, weakest_n);
    let mut extras = extras(&ratings, laws);
    extras.emergency_brake_n = loads::emergency_brakes(&own);
    extras.speed_m_per_s = root.get("speed").map(|v| v.quantity()).transpose()?;
    extras.damping_ratio = root.get("damping_ratio").map_or(Ok(0.0), |v| v.ratio())?;
    let initial_force_n: &[f64] = load.as_ref().map_or(&[], |load| &load.couplers_n);
    let traction_n = &loads::tractions(&own);
    let context = scenarios::Context {
        found,
        labels: &labels,
        initial_force_n,
        traction_n,
        weakest_n,
        extras: &extras,
        path,
        files,
    };
    let scenarios = scenarios::read(root, &context)?;
    let Loads { couplers_n: initial_force_n, steady, pulled_to_n } = load?;
    (extras.steady, extras.pulled_to_n) = (steady, pulled_to_n);
    damping_ratio(root, &extras, &scenarios)?;
    let largest_n = initial_force_n.iter().copied().map(f64::abs).fold(0.0, f64::max);
    for (coupler, law) in couplers.iter_mut().zip(&extras.laws) {
        coupler.stiffness_n_per_m = secant_n_per_m(law, largest_n);
    }
    let units = match root.get("units") {
        Some(value) => UnitSystem::from_name(value.word()?).unwrap_or_default(),
        None => found.units(),
    };
    let origin = Origin { by_label: labels.named.take(), units, ..Origin::default() };
    Ok(Train { name: name?, initial_force_n, vehicles, couplers, scenarios, extras, origin })
}

/// Whether the damping ratio of every mode fits the rest of the train: neither dashpots nor what only they fit.
fn damping_ratio(root: &Table, extras: &Extras, scenarios: &[Scenario]) -> Read<()> {
    let (Some(value), ratio) = (root.get("damping_ratio"), extras.damping_ratio) else { return Ok(()) };
    if ratio > 0.0 && !extras.laws.is_empty() {
        let help = "a mode of vibration belongs to linear couplers: leave damping_ratio out, or slack, gears and stiffness_in_buff";
        return Err(value.wrong("damping_ratio in a train whose couplers are not linear", help));
    }
    if ratio > 0.0 && !extras.dashpot_n_s_per_m.is_empty() {
        let help = "keep one of them: damping_ratio is of every mode alike, damping of each coupler";
        return Err(value.wrong("damping_ratio beside dashpots", help));
    }
    let beyond = |s: &&Scenario| s.cascade != Rule::Keep || scenario::beyond_steps(&extras.dashpot_n_s_per_m, &s.event);
    match scenarios.iter().find(beyond).filter(|_| ratio > 0.0) {
        None => Ok(()),
        Some(other) => {
            let title = "damping_ratio is for breaks and rectangular pulses without a cascade";
            let help = "give [coupler] a damping = \"200 kN*s/m\" instead, for scenario";
            Err(value.wrong(title, format!("{help} {}", quoted(&other.name))))
        }
    }
}

/// The law of each coupler; none where all are linear springs.
fn laws(root: &Table, ratings: &[Ratings]) -> Read<Vec<Law>> {
    let mut laws: Vec<Option<Law>> = Vec::new();
    for (i, r) in ratings.iter().enumerate() {
        let again = if i > 0 && ratings[i - 1].law == r.law { laws.last().cloned() } else { None };
        // What is wrong has been noted where it is given, or replaced.
        laws.push(again.unwrap_or_else(|| r.law.law().unwrap_or(None)));
    }
    if laws.iter().all(Option::is_none) {
        return Ok(vec![]);
    }
    if let Some(i) = ratings.iter().position(|r| r.damping_n_s_per_m > 0.0) {
        let title = format!("coupler {} has damping in a train whose couplers are not all linear", i + 1);
        let help = "damping is for trains of linear couplers: leave it out, or slack, gears and stiffness_in_buff";
        let at = root.get("coupler").map(|coupler| match coupler.table().ok().and_then(|t| t.get("damping")) {
            Some(damping) => damping.wrong(&*title, help),
            None => coupler.wrong(&*title, help),
        });
        return Err(at.unwrap_or_else(|| root.wrong(title, help)));
    }
    let linear = |k: f64| Law::Elastic { draft_n_per_m: k, buff_n_per_m: k, slack_m: 0.0 };
    let all =
        laws.into_iter().zip(ratings).map(|(law, r)| law.unwrap_or_else(|| linear(r.coupler().stiffness_n_per_m)));
    Ok(all.collect())
}

fn extras(ratings: &[Ratings], laws: Vec<Law>) -> Extras {
    let some = |any: bool| if any { ratings } else { &[] };
    let limited = some(ratings.iter().any(|r| r.limits != Limits::default()));
    let damped = some(ratings.iter().any(|r| r.damping_n_s_per_m > 0.0));
    Extras {
        dashpot_n_s_per_m: damped.iter().map(|r| r.damping_n_s_per_m).collect(),
        limits: limited.iter().map(|r| r.limits).collect(),
        laws,
        ..Extras::default()
    }
}

fn stem(path: &Path) -> String {
    path.file_stem()
        .filter(|stem| *stem != STDIN)
        .map_or_else(|| "train".to_owned(), |s| printable(&s.to_string_lossy()))
}

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

    /// Puts it in the place of what a coupler had; a share of the draft rating is one of `[coupler]`'s.
    fn apply(&self, base: &Ratings, coupler: &mut Ratings) {
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

/// A `limits` table: a capacity of its own is of both senses, but where the table of a sense has another.
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

/// The limits of a coupler, which rise from fatigue to ultimate; `whose` says which coupler's they are.
fn in_order(limits: Limits, value: &Value, whose: &str) -> Read<Limits> {
    let right = "the order is fatigue, proof, ultimate, and none is above the next";
    match limits.disorder() {
        Some(disorder) => Err(value.wrong(format!("{whose}{disorder}"), right)),
        None => Ok(limits),
    }
}

/// The ratings that hold unless overridden; a share in `buff` is of whichever draft rating the coupler has.
#[derive(Clone)]
struct Ratings {
    law: LawKeys,
    draft_n: f64,
    buff: Amount,
    limits: Limits,
    damping_n_s_per_m: f64,
}

/// Stands in for a `[coupler]` that was wrong, so that what refers to it can still be looked at.
const PLACEHOLDER: Ratings = Ratings {
    law: LawKeys::linear(1.0),
    draft_n: 1.0,
    buff: Amount::Share(1.0),
    limits: Limits::both([None; 3]),
    damping_n_s_per_m: 0.0,
};

impl Ratings {
    fn coupler(&self) -> Coupler {
        let rated_buff_n = match self.buff {
            Amount::Si(value) => value,
            Amount::Share(share) => share * self.draft_n,
        };
        let stiffness_n_per_m = self.law.stiffness_n_per_m.unwrap_or(1.0);
        Coupler { stiffness_n_per_m, rated_draft_n: self.draft_n, rated_buff_n }
    }
}

fn base_coupler(root: &Table, path: &Path, files: &Files) -> Read<Ratings> {
    let value = root.require("coupler", "add a [coupler] table with stiffness and rated_load")?;
    let table = value.table()?;
    let damping = table.get("damping").map(|v| v.quantity()).transpose();
    let law = match table.get("gear") {
        Some(_) => LawKeys::read(&table, path, files),
        None => table
            .require("stiffness", "add stiffness = \"30 MN/m\", that of the whole connection between two vehicles")
            .and_then(|_| LawKeys::read(&table, path, files)),
    };
    let law = law.and_then(|law| together(&table, law));
    let draft =
        table.require("rated_load", "add rated_load = \"1.5 MN\", the capacity in draft").and_then(|v| v.quantity());
    let buff = table.get("rated_buff").map_or(Ok(Amount::Share(1.0)), |v| v.amount());
    let own = |value: &Value| limits(value).and_then(|limits| in_order(limits, value, ""));
    let limits = table.get("limits").as_ref().map_or(Ok(Limits::default()), own);
    Ok(Ratings { law: law?, draft_n: draft?, buff: buff?, limits: limits?, damping_n_s_per_m: damping?.unwrap_or(0.0) })
}

/// Keys of a law that go together; else notes at the key of the table what does not.
fn together(table: &Table, law: LawKeys) -> Read<LawKeys> {
    match law.law() {
        Ok(_) => Ok(law),
        Err((key, title, help)) => Err(match table.get(key) {
            Some(value) => value.wrong(title, help),
            None => table.wrong(title, help),
        }),
    }
}

/// The `[coupler]` that a study gives one coupler.
fn drawn_coupler(found: &Found, text: &str, path: &Path, files: &Files) -> Read<Ratings> {
    let wrong = |e: toml::de::Error| found.note(Problem::of_file(format!("not TOML: {}", e.message()), ""));
    let root = DeTable::parse(text).map_err(wrong)?;
    base_coupler(&Table::root(found, root.get_ref(), &TRAIN), path, files)
}

/// What a table of vehicles says of the couplers behind them.
fn rate_by_table(ratings: &mut [Ratings], bases: &[Ratings], groups: &[Group], behind: &[OwnKeys]) {
    let own = groups.iter().zip(behind).flat_map(|(group, own)| std::iter::repeat_n(own, group.count));
    ratings.iter_mut().zip(bases).zip(own).for_each(|((coupler, base), own)| own.apply(base, coupler));
}

fn couplers(
    root: &Table,
    bases: &[Ratings],
    mut ratings: Vec<Ratings>,
    labels: &Labels,
    path: &Path,
    files: &Files,
) -> Vec<Ratings> {
    let overrides = root.get("coupler_override").and_then(|v| v.tables().ok());
    let mut seen = HashMap::new();
    for table in overrides.into_iter().flatten() {
        // A problem in it has been noted: the other overrides can be read all the same.
        let own = OwnKeys::read(&table, path, files);
        let _ = apply_override(&table, own, bases, &mut ratings, labels, &mut seen);
    }
    ratings
}

/// Where each key of each coupler was overridden.
type Seen = HashMap<(usize, &'static str), Range<usize>>;

fn apply_override(
    table: &Table,
    own: Read<OwnKeys>,
    bases: &[Ratings],
    ratings: &mut [Ratings],
    labels: &Labels,
    seen: &mut Seen,
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
            let Some(span) = table.key_span(key) else { continue };
            if let Some(earlier) = seen.insert((i, key), span.clone()) {
                let title = format!("coupler {} has its {key} overridden twice", i + 1);
                return Err(table.note_because(span, title, "keep one of the two", earlier, "overridden here before"));
            }
        }
        own.apply(&bases[i], &mut ratings[i]);
        if let Some(value) = table.get("limits") {
            in_order(ratings[i].limits, &value, &format!("coupler {}: ", i + 1))?;
        }
        if own.law.gives_anything() {
            together(table, ratings[i].law.clone())?;
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
    let count = labels.vehicles.len() - 1;
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

/// The groups of a table.
fn tabled(root: &Table, groups: Vec<Group>) -> Read<Vec<Group>> {
    if let (Some(spelt_out), Some(table)) = (root.key_span("vehicle"), root.key_span("vehicles")) {
        let title = "the train has its vehicles twice, as a table and as [[vehicle]]";
        return Err(root.note_because(spelt_out, title, "keep one of the two", table, "the table"));
    }
    Ok(groups)
}

/// Vehicles alike that follow each other: a `[[vehicle]]` table, or a row of a table of vehicles.
pub(super) struct Group {
    pub(super) label: Option<String>,
    pub(super) count: usize,
    pub(super) mass_kg: f64,
    pub(super) held: bool,
    pub(super) length_m: Option<f64>,
    load: OwnLoad,
}

/// The groups of the `[[vehicle]]` tables.
fn spelt_out(found: &Found, root: &Table) -> Read<Vec<Group>> {
    let right = "add a [[vehicle]] table for each vehicle or group alike, from the head: at least two vehicles";
    if let Some(table) = root.get("vehicles") {
        return Err(table.wrong_type("expected the name of a table: vehicles = \"consist.csv\""));
    }
    let Some(value) = root.get("vehicle") else {
        return Err(found.note(Problem::of_file("the train has no vehicles", right)));
    };
    let tables = value.tables()?;
    let groups = tables.iter().map(group).collect::<Vec<_>>().into_iter().collect::<Read<Vec<Group>>>()?;
    let mut total = 0usize;
    for (group, table) in groups.iter().zip(&tables) {
        total = total.saturating_add(group.count);
        if total > MOST_VEHICLES {
            let title = format!("the train has more than {MOST_VEHICLES} vehicles up to here");
            return Err(table.wrong(title, "a train has at most that many"));
        }
    }
    match total {
        0 => return Err(value.wrong("the train has no vehicles", right)),
        1 => return Err(tables[0].wrong("the train has one vehicle, so no coupler", right)),
        _ => {}
    }
    for (index, title, help) in wrongly_held(&groups, "a [[vehicle]] of its own, without count") {
        if let Some(held) = tables[index].get("held") {
            held.wrong(title, help);
        }
    }
    Ok(groups)
}

/// Reads a group: a `[[vehicle]]`, or a row of a table of vehicles, which has the same keys.
pub(super) fn group(table: &Table) -> Read<Group> {
    let label = table.get("label").map(|v| v.name()).transpose();
    let right = format!("expected a whole number from 1 to {MOST_VEHICLES}, how many of them follow each other");
    let count = table.get("count").map_or(Ok(1), |v| v.number(MOST_VEHICLES, |n| format!("count is {n}"), &right));
    let mass = table.require("mass", "add mass = \"160 t\", that of each vehicle of the group");
    let mass = mass.and_then(|v| v.quantity());
    let length = table.get("length").map(|v| v.quantity()).transpose();
    let held = table.get("held").map_or(Ok(false), |v| v.flag());
    let load = loads::own(table, held.as_ref().is_ok_and(|held| *held));
    let count = count?;
    Ok(Group {
        label: label.unwrap_or(None).map(|label| label.trim().to_owned()),
        count,
        mass_kg: mass.unwrap_or(1.0),
        held: held.unwrap_or(false),
        length_m: length.unwrap_or(None),
        load: load.unwrap_or_default(),
    })
}

/// Groups that cannot be held: each with what is wrong and what would be right.
pub(super) fn wrongly_held(groups: &[Group], own: &str) -> Vec<(usize, String, String)> {
    let right = "only the first and the last vehicle of the train can be held";
    let mut wrong = vec![];
    for (i, group) in groups.iter().enumerate().filter(|(_, group)| group.held) {
        if i > 0 && i + 1 < groups.len() {
            wrong.push((i, "a vehicle in the middle of the train is held".to_owned(), right.to_owned()));
        } else if group.count > 1 {
            let title = format!("a group of {} vehicles is held", group.count);
            wrong.push((i, title, format!("{right}: give it {own}")));
        }
    }
    if let ([Group { held: true, count: 1, .. }, Group { held: true, count: 1, .. }], true) = (groups, wrong.is_empty())
    {
        let title = "both vehicles of the train are held, so nothing in it moves";
        wrong.push((1, title.to_owned(), "hold one of them, or none".to_owned()));
    }
    wrong
}
