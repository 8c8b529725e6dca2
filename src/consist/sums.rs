//! Rows of a table of vehicles that hold sums or means of the others.

use super::vehicles::Group;
use crate::train::VehicleSpec;

/// Labels of rows with sums or means.
const SUMS: [&str; 12] = [
    "total",
    "totals",
    "grand total",
    "sum",
    "summe",
    "gesamt",
    "somme",
    "average",
    "mean",
    "subtotal",
    "sub-total",
    "zwischensumme",
];

/// Rows that are probably sums or means of the others and no vehicles, and why: the first one and the last ones by their mass, any by
/// its label.
pub(super) fn sums(groups: &[Group]) -> Vec<(usize, &'static str)> {
    let groups: Vec<&VehicleSpec> = groups.iter().map(|group| &group.vehicle).collect();
    let labelled = |at: usize| {
        let label = groups[at].label.as_deref().unwrap_or_default().trim_end_matches(':').to_lowercase();
        SUMS.contains(&label.as_str())
    };
    let near = |sum: f64, value: f64| (sum - value).abs() <= 1e-3 * value;
    let is_sum = |at: usize, least_others: usize| {
        let others: Vec<_> = (0..groups.len()).filter(|&i| i != at && !labelled(i)).map(|i| groups[i]).collect();
        let sum = |of: &dyn Fn(&VehicleSpec) -> f64| others.iter().map(|g| of(g)).sum::<f64>();
        let lengths = groups[at].length_m.is_none_or(|length| {
            near(sum(&|g| g.length_m.unwrap_or(0.0) * g.count as f64), length)
                || near(sum(&|g| g.length_m.unwrap_or(0.0)), length)
        });
        let masses = [sum(&|g| g.mass_kg), sum(&|g| g.mass_kg * g.count as f64)];
        others.len() >= least_others && lengths && masses.iter().any(|sum| near(*sum, groups[at].mass_kg))
    };
    let last = groups.len().saturating_sub(1);
    let why = |at: usize| match at {
        _ if at == last && is_sum(at, 2) => Some("the mass of the last row is the sum of the others"),
        // A locomotive may weigh as much as two wagons.
        0 if is_sum(0, 3) => Some("the mass of the first row is the sum of the others"),
        _ if at == last && labelled(at) => Some("the last row is labelled as a sum"),
        _ if labelled(at) => Some("a row is labelled as a sum"),
        _ if (at + 1..groups.len()).all(labelled) && is_sum(at, 2) => {
            Some("the mass of a row is the sum of the others")
        }
        _ => None,
    };
    (0..groups.len()).filter_map(|at| Some((at, why(at)?))).collect()
}
