//! Makes a train from a train file's tables.

use std::collections::HashSet;
use std::ops::Range;
use std::path::Path;

use super::couplers::{
    Overridden, PLACEHOLDER, apply_table_columns, base_coupler, coupler_table, override_couplers, specs,
    table_takes_precedence,
};
use super::keys::TRAIN;
use super::labels::Labels;
use super::loads::{self, OwnLoad};
use super::scenarios;
use super::table::Rows;
use super::tree::{Found, Read, Reported, Table};
use super::vehicles::{groups_of_table, groups_of_vehicle_tables};
use super::{EachCoupler, Files, STDIN};
use crate::error::{Problem, printable};
use crate::train::{Load, Origin, PulledTo, SpecProblem, Train, TrainSpec, VehicleSpec, numbered};
use crate::units::UnitSystem;

/// Reads the whole train; after a problem it reads on as far as it can.
///
/// A wrong value is replaced by a valid one, so that the rest is still checked. The train is valid only if no problem
/// has been noted. `rows` are those of the table that the file's `vehicles` names.
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
    let common = coupler_table(root);
    let base = common.as_ref().map_or(PLACEHOLDER, |table| base_coupler(root, table, path, files));
    let (groups, behind) = match rows {
        Some(Rows { groups, behind, doubts }) => {
            doubts.into_iter().for_each(|doubt| found.doubt(doubt));
            (groups_of_table(root, groups)?, behind)
        }
        None => (groups_of_vehicle_tables(found, root)?, vec![]),
    };
    let own: Vec<OwnLoad> = groups.iter().flat_map(|g| std::iter::repeat_n(g.load, g.vehicle.count)).collect();
    let couplers = own.len() - 1;
    let bases = match each {
        Some(each) => {
            let mut drawn = Vec::with_capacity(couplers);
            each(couplers, &mut |tree| {
                let root = Table::root(found, tree, &TRAIN);
                drawn.push(coupler_table(&root).map(|table| base_coupler(&root, &table, path, files)));
            });
            drawn.into_iter().collect::<Read<_>>()?
        }
        None => vec![base; couplers],
    };
    let mut ratings = bases.clone();
    apply_table_columns(root, &mut ratings, &bases, &groups, &behind)?;
    let vehicles: Vec<VehicleSpec> = groups.into_iter().map(|group| group.vehicle).collect();
    let labels = Labels::new(own.len(), || numbered(&vehicles).0);
    let overridden = override_couplers(root, &bases, &mut ratings, &labels, path, files);
    if let (Ok(table), Some(i)) = (&common, ratings.iter().position(|r| !r.law.gives_force())) {
        let help = "add stiffness = \"30 MN/m\", that of the whole connection between two vehicles";
        let right = if ratings.iter().any(|r| r.law.gives_force()) {
            format!("{help}, or give coupler {} a stiffness or a gear, as others have", i + 1)
        } else {
            format!("{help}{}", table_takes_precedence(root))
        };
        let _ = table.require("stiffness", &right);
    }
    let weakest_n = ratings.iter().map(|r| r.draft_n).fold(f64::INFINITY, f64::min);
    let load = loads::read(root, &vehicles, &own, &labels, weakest_n);
    let mut by_label = labels.named.take();
    drop((bases, labels));
    let (load, pulled_to) = match load {
        Ok((load, pulled_to)) => (Ok(load), pulled_to),
        Err(reported) => (Err(reported), PulledTo::None),
    };
    let asked = root.get("units").map(|value| value.word()).transpose()?.and_then(UnitSystem::from_name);
    // Units of messages; those of the report are chosen at the end.
    let units = asked.unwrap_or_else(|| found.units());
    let spec = TrainSpec {
        origin: Origin { units, ..Origin::default() },
        name: name.as_ref().map_or_else(|_| String::new(), Clone::clone),
        couplers: specs(ratings),
        load: load.as_ref().map_or(Load::None, Clone::clone),
        pulled_to,
        damping_ratio: root.get("damping_ratio").map_or(Ok(0.0), |v| v.ratio())?,
        speed_m_per_s: root.get("speed").map(|v| v.quantity()).transpose()?,
        vehicles,
        ..TrainSpec::default()
    };
    let (train, wrong) = spec.examine();
    let mut places = Places { found, root, overridden, told: HashSet::new() };
    let wrong = wrong.into_iter().map(|problem| places.note(problem)).last();
    let Some(mut train) = train else { return Err(wrong.unwrap_or_else(|| root.wrong("this is no train", ""))) };
    let labels = Labels::of(&train);
    let traction_n = &loads::tractions(&own);
    let context = scenarios::Context { found, labels: &labels, train: &train, traction_n, weakest_n, path, files };
    let scenarios = scenarios::read(root, &context)?;
    by_label.extend(labels.named.take());
    drop(labels);
    for problem in train.set_scenarios(scenarios) {
        places.note(problem);
    }
    let units = asked.unwrap_or_else(|| found.units());
    name?;
    load?;
    let origin = Origin { by_label, units, ..train.origin().clone() };
    Ok(train.with_origin(origin))
}

/// Finds the place in the file of a problem with the train.
struct Places<'f> {
    found: &'f Found,
    root: &'f Table<'f>,
    overridden: Overridden,
    /// Places and messages that have been noted: a wrong value of many couplers is reported once.
    told: HashSet<(Option<Range<usize>>, String)>,
}

impl Places<'_> {
    /// Notes a problem at the value that it is about.
    fn note(&mut self, problem: SpecProblem) -> Reported {
        let SpecProblem { key, message, help, related, .. } = problem;
        let (at, whose) = self.place(&key);
        if !self.told.insert((at.clone(), message.clone())) {
            return Reported::again();
        }
        let message = whose + &message;
        let Some(at) = at else { return self.found.note(Problem::of_file(message, help)) };
        let problem = Problem::at(at, message, Some(help));
        self.found.note(match related.and_then(|(key, label)| Some((self.root.place(&key)?, label))) {
            Some((other, label)) => problem.and(other, label),
            None => problem,
        })
    }

    /// The place of a key, and words for its coupler where the place does not show it.
    fn place(&self, key: &str) -> (Option<Range<usize>>, String) {
        let of_coupler = key.strip_prefix("coupler[").and_then(|rest| rest.split_once("]."));
        let Some((i, keys)) = of_coupler.and_then(|(i, keys)| Some((i.parse::<usize>().ok()?, keys))) else {
            return (self.root.place(key), String::new());
        };
        let own = self.overridden.get(&(i, keys.split('.').next().unwrap_or(keys)));
        match (own, self.root.get("vehicles")) {
            (Some([_, value]), _) => (Some(value.clone()), format!("coupler {}: ", i + 1)),
            (None, Some(table)) => (Some(table.span()), format!("the table's coupler {}: ", i + 1)),
            (None, None) => (self.root.place(&format!("coupler.{keys}")), String::new()),
        }
    }
}

fn stem(path: &Path) -> String {
    path.file_stem()
        .filter(|stem| *stem != STDIN)
        .map_or_else(|| "train".to_owned(), |s| printable(&s.to_string_lossy()))
}
