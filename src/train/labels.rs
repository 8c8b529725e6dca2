//! Names of vehicles: each has one of its own.

use std::collections::{HashMap, HashSet};

use super::{Doubt, Vehicle, VehicleSpec};

/// The groups spelt out, with numbers after a label that more than one vehicle has: "car 1", or "wagon 31 (1)" of the label "wagon 31". No two vehicles have the same name: numbers are left
/// out that would make the label of another, and the first of them is a doubt.
pub(crate) fn numbered(groups: &[VehicleSpec]) -> (Vec<Vehicle>, Option<Doubt>) {
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
    let (mut vehicles, mut left_out) = (Vec::new(), None);
    for group in groups {
        for _ in 0..group.count {
            let label = match group.label.as_deref() {
                None => {
                    let name = by_place(vehicles.len());
                    let others = (2..).map(|i| format!("{name} (no label, {i})"));
                    let mut names = [name.clone(), format!("{name} (no label)")].into_iter().chain(others);
                    names.find(|name| !totals.contains_key(name.as_str())).unwrap_or(name)
                }
                // A vehicle without a label that has this name by its place gets another.
                Some(label) if totals.get(label) == Some(&1) => label.to_owned(),
                Some(label) => {
                    let number = used.entry(label).or_default();
                    loop {
                        *number += 1;
                        let name = with_number(label, *number);
                        if free(&name) {
                            break name;
                        }
                        left_out.get_or_insert((label, *number));
                    }
                }
            };
            vehicles.push(Vehicle { label, mass_kg: group.mass_kg, held: group.held, length_m: group.length_m });
        }
    }
    let text = |(label, number)| {
        format!(
            "vehicles with the label {label:?} are numbered without {number}, because another vehicle is called {:?}; check which \
             is meant where it is named",
            with_number(label, number)
        )
    };
    (vehicles, left_out.map(|skipped| Doubt::of_train("label-numbers", text(skipped))))
}

/// A label with a number behind it, in brackets where the label itself ends in a digit.
fn with_number(label: &str, number: usize) -> String {
    if label.ends_with(|c: char| c.is_ascii_digit()) {
        format!("{label} ({number})")
    } else {
        format!("{label} {number}")
    }
}
