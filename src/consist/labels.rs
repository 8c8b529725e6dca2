//! Labels of vehicles: each is unique, and can name the vehicle or the coupler behind it.

use std::cell::{OnceCell, RefCell};
use std::collections::HashMap;

use super::tree::{Read, Value};
use crate::error::quoted;
use crate::train::{Train, Vehicle};

/// Labels that are compared with an unknown one at most.
const COMPARED: usize = 20_000;

/// The vehicles by their names, which are made when one is asked for.
pub(super) struct Labels<'v> {
    /// How many vehicles there are.
    pub(super) count: usize,
    names: Box<dyn Fn() -> Vec<Vehicle> + 'v>,
    vehicles: OnceCell<Vec<Vehicle>>,
    by_label: OnceCell<HashMap<String, usize>>,
    /// What has been named so far, in words.
    pub(super) named: RefCell<Vec<String>>,
}

impl<'v> Labels<'v> {
    pub(super) fn new(count: usize, names: impl Fn() -> Vec<Vehicle> + 'v) -> Self {
        let (vehicles, by_label) = (OnceCell::new(), OnceCell::new());
        Labels { count, names: Box::new(names), vehicles, by_label, named: RefCell::default() }
    }

    /// Those of a train.
    pub(super) fn of(train: &'v Train) -> Self {
        Labels::new(train.vehicles().len(), || train.vehicles().to_vec())
    }

    /// The vehicles with their names.
    pub(super) fn vehicles(&self) -> &[Vehicle] {
        self.vehicles.get_or_init(&self.names)
    }

    /// The vehicle that a value names, as an index from 0; `or` is what else would be right.
    pub(super) fn vehicle(&self, value: &Value, label: &str, or: &str) -> Read<usize> {
        let vehicles = self.vehicles();
        let all = || vehicles.iter().enumerate().map(|(i, v)| (v.label.clone(), i)).collect();
        if let Some(&index) = self.by_label.get_or_init(all).get(label) {
            return Ok(index);
        }
        let numbered = |v: &&Vehicle| {
            let number = v.label.strip_prefix(label).and_then(|rest| rest.strip_prefix(' '));
            let number = number.map(|n| n.strip_prefix('(').and_then(|n| n.strip_suffix(')')).unwrap_or(n));
            number.is_some_and(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit()))
        };
        let some: Vec<&Vehicle> = vehicles.iter().filter(numbered).collect();
        if let [first, .., last] = some.as_slice() {
            let title = format!("{} vehicles have the label {}", some.len(), quoted(label));
            let help = format!("give one with its number, from {} to {}", quoted(&first.label), quoted(&last.label));
            return Err(value.wrong(title, help));
        }
        let mut near: Vec<(usize, &str)> =
            vehicles.iter().take(COMPARED).map(|v| (distance(label, &v.label), &*v.label)).collect();
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
