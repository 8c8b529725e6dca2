//! Names of vehicles: each has one of its own, and a vehicle or the coupler behind it can be named by it.

use std::cell::{OnceCell, RefCell};
use std::collections::{HashMap, HashSet};

use super::Vehicle;
use super::file::Group;
use super::tree::{Read, Value};
use crate::error::quoted;

/// So many names are compared with one that is unknown.
const COMPARED: usize = 20_000;

/// The groups spelt out, with numbers after a label that more than one vehicle has. No two vehicles have the same name: numbers are left
/// out that would make the label of another.
pub(super) fn numbered(groups: &[Group]) -> Vec<Vehicle> {
    let mut totals: HashMap<&str, usize> = HashMap::new();
    for group in groups {
        *totals.entry(group.label.as_deref().unwrap_or_default()).or_default() += group.count;
    }
    let places = groups.iter().scan(0, |next, group| {
        *next += group.count;
        Some((*next - group.count, group))
    });
    let nameless: Vec<usize> =
        places.filter(|(_, g)| g.label.is_none()).flat_map(|(first, g)| first..first + g.count).collect();
    let by_place = |place: usize| format!("vehicle {}", place + 1);
    let taken: HashSet<String> = nameless.into_iter().map(by_place).collect();
    let free = |name: &str| !totals.contains_key(name) && !taken.contains(name);
    let mut used: HashMap<&str, usize> = HashMap::new();
    let mut vehicles = Vec::new();
    for group in groups {
        for _ in 0..group.count {
            let label = match group.label.as_deref() {
                None => {
                    let name = by_place(vehicles.len());
                    let mut others =
                        std::iter::once(name.clone()).chain((1..).map(|i| format!("{name} (no label {i})")));
                    others.find(|name| !totals.contains_key(name.as_str())).unwrap_or(name)
                }
                Some(label) if totals.get(label) == Some(&1) && !taken.contains(label) => label.to_owned(),
                Some(label) => {
                    let number = used.entry(label).or_default();
                    loop {
                        *number += 1;
                        let name = format!("{label} {number}");
                        if free(&name) {
                            break name;
                        }
                    }
                }
            };
            vehicles.push(Vehicle { label, mass_kg: group.mass_kg, held: group.held, length_m: group.length_m });
        }
    }
    vehicles
}

/// The vehicles by their names.
pub(super) struct Labels<'v> {
    pub(super) vehicles: &'v [Vehicle],
    by_label: OnceCell<HashMap<&'v str, usize>>,
    /// What has been named so far, in words.
    pub(super) named: RefCell<Vec<String>>,
}

impl<'v> Labels<'v> {
    pub(super) fn new(vehicles: &'v [Vehicle]) -> Self {
        Labels { vehicles, by_label: OnceCell::new(), named: RefCell::default() }
    }

    /// The vehicle that a value names, as an index from 0; `or` is what is right beside a label.
    pub(super) fn vehicle(&self, value: &Value, label: &str, or: &str) -> Read<usize> {
        let all = self.by_label.get_or_init(|| self.vehicles.iter().enumerate().map(|(i, v)| (&*v.label, i)).collect());
        if let Some(&index) = all.get(label) {
            return Ok(index);
        }
        let numbered = |v: &&Vehicle| {
            let number = v.label.strip_prefix(label).and_then(|rest| rest.strip_prefix(' '));
            number.is_some_and(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit()))
        };
        let some: Vec<&Vehicle> = self.vehicles.iter().filter(numbered).collect();
        if let [first, .., last] = some.as_slice() {
            let title = format!("{} vehicles have the label {}", some.len(), quoted(label));
            let help = format!("give one with its number, from {} to {}", quoted(&first.label), quoted(&last.label));
            return Err(value.wrong(title, help));
        }
        let mut near: Vec<(usize, &str)> =
            self.vehicles.iter().take(COMPARED).map(|v| (distance(label, &v.label), &*v.label)).collect();
        near.sort();
        let near: Vec<String> = near.iter().take(3).map(|(_, name)| quoted(name)).collect();
        let help = format!("the nearest labels are {}; or give {or}", near.join(", "));
        Err(value.wrong(format!("no vehicle has the label {}", quoted(label)), help))
    }

    /// Notes which coupler or vehicle a label names, for `check` to print.
    pub(super) fn note(&self, text: String) {
        let mut named = self.named.borrow_mut();
        if named.len() < 100 && !named.contains(&text) {
            named.push(text);
        }
    }
}

fn distance(label: &str, known: &str) -> usize {
    if known.len() > 60 || label.len() > 60 {
        60
    } else {
        strsim::damerau_levenshtein(&label.to_lowercase(), &known.to_lowercase())
    }
}
