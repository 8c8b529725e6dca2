//! The columns of the tables that a train file names: of vehicles, of a gear and of a record; and whether a text is such a table.

use super::heading::{Content, Wanted, normal};
use super::keys::{GEAR_COLUMNS, OVERRIDE, VEHICLE};
use super::sheet::{NoSheet, Sheet};
use crate::keys::{Kind, Shape, Sign};
use crate::units::{Dimension, one_of};

/// Which table of the train file a column belongs to.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Of {
    Vehicle,
    Coupler,
    /// The row's own number, which is no key.
    Place,
}

/// A column that is read.
pub(super) struct Slot {
    pub(super) of: Of,
    pub(super) path: Vec<&'static str>,
    pub(super) kind: Kind,
}

/// Other words for a key where they have no other meaning.
const SYNONYMS: [(&str, &[&str]); 13] = [
    ("mass", &["weight"]),
    ("label", &["name", "vehicle", "description"]),
    ("count", &["quantity", "qty"]),
    ("length", &["length_over_couplers", "length_over_buffers"]),
    ("rated_load", &["rating", "rated_draft", "draft_rating", "coupler_rating"]),
    ("rated_buff", &["buff_rating"]),
    ("stiffness", &["coupler_stiffness"]),
    ("tractive_effort", &["traction", "tractive_force"]),
    ("brake_force", &["braking_force"]),
    ("grade", &["gradient"]),
    ("limits_fatigue", &["fatigue", "fatigue_load", "fatigue_limit"]),
    ("limits_proof", &["proof", "proof_load", "proof_limit"]),
    ("limits_ultimate", &["ultimate", "ultimate_load", "ultimate_limit"]),
];

/// Headings of row numbers.
const PLACES: [&str; 10] = ["pos", "position", "#", "no", "number", "nr", "place", "index", "sequence", "order"];

/// Every column that is read, from the keys of the train file; a key of a table within a table is `limits.fatigue`.
pub(super) fn slots() -> Vec<Slot> {
    fn of_shape(of: Of, shape: &'static Shape, within: &[&'static str], into: &mut Vec<Slot>) {
        for key in shape.keys.iter().filter(|key| !(of == Of::Coupler && key.name == "at")) {
            let path: Vec<&'static str> = within.iter().copied().chain([key.name]).collect();
            match key.kind {
                Kind::Table(inner) => of_shape(of, inner, &path, into),
                Kind::Tables(_) => {}
                kind => into.push(Slot { of, path, kind }),
            }
        }
    }
    let mut slots = vec![];
    of_shape(Of::Vehicle, &VEHICLE, &[], &mut slots);
    of_shape(Of::Coupler, &OVERRIDE, &[], &mut slots);
    slots.push(Slot { of: Of::Place, path: vec![PLACES[0]], kind: Kind::Name });
    slots
}

/// What is looked for in the header of a table of vehicles.
pub(super) fn vehicle_columns(slots: &[Slot]) -> Vec<Wanted> {
    let leaf = |slot: &Slot| slot.path.last().copied().unwrap_or_default();
    let one = |slot: &Slot| {
        let mut names = vec![normal(&slot.path.join("."))];
        if slot.path.len() > 1 && slots.iter().filter(|other| leaf(other) == leaf(slot)).count() == 1 {
            names.push(leaf(slot).to_owned());
        }
        let of_key = SYNONYMS.iter().find(|(name, _)| *name == names[0]).map_or(&[][..], |(_, words)| words);
        let others = if slot.of == Of::Place { &PLACES[..] } else { of_key };
        names.extend(others.iter().map(|word| (*word).to_owned()));
        let content = match slot.kind {
            Kind::Quantity { of, share, .. } => Content::Quantity { of, share },
            Kind::Ratio | Kind::Positive | Kind::Whole { .. } => Content::Number,
            _ => Content::Text,
        };
        Wanted { names, content, by_unit: false }
    };
    slots.iter().map(one).collect()
}

/// The names of all columns, as a phrase.
pub(super) fn all_columns(slots: &[Slot]) -> String {
    one_of(slots.iter().filter(|slot| slot.of != Of::Place).map(|slot| slot.path.join(".")))
}

/// Whether a text looks like a table of vehicles.
pub(super) fn is_table(text: &str) -> bool {
    let slots = slots();
    let mass = position(&slots, "mass");
    Sheet::open(text, &vehicle_columns(&slots), &[mass]).is_ok_and(|sheet| sheet.columns[mass].is_some())
}

/// The place of a column of a vehicle among the slots.
pub(super) fn position(slots: &[Slot], name: &str) -> usize {
    slots.iter().position(|slot| slot.of == Of::Vehicle && slot.path == [name]).unwrap_or_default()
}

/// Other words for the columns of a gear's table.
const GEAR_SYNONYMS: [&[&str]; 3] = [
    &["stroke", "displacement", "deflection", "compression", "closure"],
    &["loading_force", "load", "force"],
    &["unloading_force", "unload", "release", "release_force", "recoil"],
];

/// What is looked for in the header of a gear's table.
fn gear_columns() -> Vec<Wanted> {
    let one = |((name, of, _), synonyms): ((&str, Dimension, Sign), &[&str])| Wanted {
        names: std::iter::once(name).chain(synonyms.iter().copied()).map(str::to_owned).collect(),
        content: Content::Quantity { of, share: false },
        by_unit: of == Dimension::Length,
    };
    GEAR_COLUMNS.into_iter().zip(GEAR_SYNONYMS).map(one).collect()
}

/// Whether a text looks like a gear's table.
pub(super) fn is_gear(text: &str) -> bool {
    open_gear(text).is_ok()
}

/// Finds the columns of a gear's table.
pub(super) fn open_gear(text: &str) -> Result<Sheet<'_>, NoSheet> {
    let sheet = Sheet::open(text, &gear_columns(), &[0, 1])?;
    if sheet.columns[..2].iter().all(Option::is_some) { Ok(sheet) } else { Err(None) }
}

/// The columns of a record.
pub(super) const RECORD_COLUMNS: [(&str, Dimension); 2] = [("time", Dimension::Time), ("force", Dimension::Force)];

/// What is looked for in the header of a record.
fn record_columns() -> Vec<Wanted> {
    let one = |(name, of): (&str, Dimension)| Wanted {
        names: vec![name.to_owned(), name[..1].to_owned()],
        content: Content::Quantity { of, share: false },
        by_unit: true,
    };
    RECORD_COLUMNS.into_iter().map(one).collect()
}

/// Finds the columns of a record.
pub(super) fn open_record(text: &str) -> Result<Sheet<'_>, NoSheet> {
    let sheet = Sheet::open(text, &record_columns(), &[0, 1])?;
    if sheet.columns.iter().all(Option::is_some) { Ok(sheet) } else { Err(None) }
}

/// Whether a text looks like a record.
pub(super) fn is_record(text: &str) -> bool {
    open_record(text).is_ok()
}
