//! The keys of a train file that the page has controls for.

use serde::Serialize;
use toml::{Table, Value};

use crate::consist::keys::TRAIN;
use crate::keys::{Key, Kind, Shape};

/// A key that can be changed, as a study names it.
#[derive(Serialize)]
pub(super) struct Control {
    key: String,
    /// The value as the file has it; `None` where it has none.
    value: Option<String>,
    about: &'static str,
    example: &'static str,
    /// It is a number without a unit.
    plain: bool,
}

/// Every quantity of the tables of which a file has one, such as `[coupler]` and `[load]`, and those of a scenario, from 0.
pub(super) fn controls(tree: &Table, scenario: Option<usize>) -> Vec<Control> {
    let mut all = Vec::new();
    for key in TRAIN.keys {
        match key.kind {
            Kind::Ratio => all.extend(control(key, "", tree.get(key.name))),
            Kind::Table(shape) => {
                let table = tree.get(key.name).and_then(Value::as_table);
                all.extend(of_table(shape, table, &format!("{}.", key.name)));
            }
            Kind::Tables(shape) if shape.variants.is_some() => {
                let index = scenario.unwrap_or(usize::MAX);
                let table = tree.get(key.name).and_then(|all| all.as_array()?.get(index)?.as_table());
                all.extend(
                    table.into_iter().flat_map(|t| of_table(shape, Some(t), &format!("{}[{index}].", key.name))),
                );
            }
            _ => {}
        }
    }
    all
}

fn of_table(shape: &'static Shape, table: Option<&Table>, path: &str) -> Vec<Control> {
    let get = |name: &str| table.and_then(|table| table.get(name));
    let word = shape.variants.and_then(|(key, _)| get(key)?.as_str()).unwrap_or_default();
    let foreign: Vec<&str> = shape.foreign(word).map(|(key, _)| key).collect();
    let own = shape.keys.iter().filter(|key| !foreign.contains(&key.name));
    own.filter_map(|key| control(key, path, get(key.name))).collect()
}

fn control(key: &'static Key, path: &str, value: Option<&Value>) -> Option<Control> {
    let plain = matches!(key.kind, Kind::Ratio);
    if !plain && !matches!(key.kind, Kind::Quantity { .. }) {
        return None;
    }
    let value = value.map(|value| value.as_str().map_or_else(|| value.to_string(), str::to_owned));
    Some(Control { key: format!("{path}{}", key.name), value, about: key.about, example: key.example, plain })
}
