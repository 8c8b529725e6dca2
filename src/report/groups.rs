//! The inputs repeated: vehicles and couplers in groups of neighbours that are alike.

use super::numbers::{Unit, force_unit, given_force_in};
use crate::law::Law;
use crate::train::{Coupler, LIMITS, Train};
use crate::units::{Dimension, UnitSystem, shown, shown_in, unit_for};

/// Rows of each table, at most.
const ROWS: usize = 40;

/// Headings of those columns in which any group has something, and the groups' rows.
pub struct Groups {
    /// What the table is of.
    pub of: &'static str,
    pub head: Vec<&'static str>,
    pub rows: Vec<Vec<String>>,
    /// How many groups are not shown.
    pub more: usize,
}

/// Vehicles from the head.
pub fn vehicles(train: &Train) -> Groups {
    let units = train.origin().units;
    let outside = |i: usize| train.extras().steady.as_ref().map_or(0.0, |s| s.outside_n[i]);
    let head = [
        "vehicles",
        "label",
        "mass of each",
        "length of each",
        "held",
        "steady force of each",
        "emergency brake of each",
    ];
    // One unit in a column.
    let unit = |dimension, of: &dyn Fn(usize) -> f64| {
        unit_for(units.units(dimension), (0..train.vehicles().len()).map(|i| of(i).abs()).fold(0.0, f64::max))
    };
    let brake_of = |i: usize| train.extras().emergency_brake_n.get(i).filter(|n| **n > 0.0);
    let mass = unit(Dimension::Mass, &|i| train.vehicles()[i].mass_kg);
    let length = unit(Dimension::Length, &|i| train.vehicles()[i].length_m.unwrap_or(0.0));
    let steady = unit(Dimension::Force, &outside);
    let braking = unit(Dimension::Force, &|i| brake_of(i).copied().unwrap_or(0.0));
    let cells = |i: usize| {
        let v = &train.vehicles()[i];
        let force = outside(i);
        let way = if force < 0.0 { "backward" } else { "forward" };
        vec![
            stem(&v.label).to_owned(),
            shown_in(mass, v.mass_kg),
            v.length_m.map_or(String::new(), |l| shown_in(length, l)),
            if v.held { "yes".to_owned() } else { String::new() },
            if force == 0.0 { String::new() } else { format!("{} {way}", given_force_in(steady, force)) },
            brake_of(i).map_or(String::new(), |n| given_force_in(braking, *n)),
        ]
    };
    grouped("Vehicles (equal neighbours are grouped)", &head, train.vehicles().len(), cells)
}

/// Couplers from the head.
pub fn couplers(train: &Train) -> Groups {
    let units = train.origin().units;
    let head =
        ["couplers", "stiffness", "rated in draft", "rated in buff", "dashpot", "limits in draft", "limits in buff"];
    let most = |of: &dyn Fn(&Coupler) -> f64| train.couplers().iter().map(of).fold(0.0, f64::max);
    let stiffness = unit_for(units.units(Dimension::Stiffness), most(&|c| c.stiffness_n_per_m));
    let [draft, buff] = [most(&|c| c.rated_draft_n), most(&|c| c.rated_buff_n)].map(|n| force_unit(units, n));
    let cells = |i: usize| {
        let (c, extras) = (&train.couplers()[i], train.extras());
        let of = |capacities: [Option<f64>; 3], unit: Unit| {
            let limits = LIMITS.iter().zip(capacities);
            let given = limits.filter_map(|(name, n)| Some(format!("{name} {}", given_force_in(unit, n?))));
            given.collect::<Vec<_>>().join(", ")
        };
        let limits = extras.limits.get(i).copied().unwrap_or_default();
        let dashpot = extras.dashpot_n_s_per_m.get(i).filter(|c| **c > 0.0);
        vec![
            extras.laws.get(i).map_or(shown_in(stiffness, c.stiffness_n_per_m), |l| law(units, l)),
            given_force_in(draft, c.rated_draft_n),
            given_force_in(buff, c.rated_buff_n),
            dashpot.map_or(String::new(), |c| shown(units, *c, Dimension::Damping)),
            of(limits.draft_n, draft),
            of(limits.buff_n, buff),
        ]
    };
    grouped("Couplers (equal neighbours are grouped)", &head, train.couplers().len(), cells)
}

/// A coupler's law in short.
fn law(units: UnitSystem, law: &Law) -> String {
    let stiffness = |k: f64| shown(units, k, Dimension::Stiffness);
    let slack = match law.slack_m() {
        0.0 => String::new(),
        s => format!(", slack {}", shown(units, s, Dimension::Length)),
    };
    match law {
        Law::Elastic { draft_n_per_m, buff_n_per_m, .. } if draft_n_per_m == buff_n_per_m => {
            stiffness(*draft_n_per_m) + &slack
        }
        Law::Elastic { draft_n_per_m, buff_n_per_m, .. } => {
            format!("{} in draft, {} in buff{slack}", stiffness(*draft_n_per_m), stiffness(*buff_n_per_m))
        }
        Law::Gear { solid_n_per_m, .. } => format!("a gear in series with {}{slack}", stiffness(*solid_n_per_m)),
    }
}

/// The label without the number that tells alike vehicles apart.
fn stem(label: &str) -> &str {
    let stem = label.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end();
    if stem.is_empty() { label } else { stem }
}

fn grouped(of: &'static str, head: &[&'static str], items: usize, cells: impl Fn(usize) -> Vec<String>) -> Groups {
    let mut groups: Vec<(usize, usize, Vec<String>)> = Vec::new();
    for i in 0..items {
        let these = cells(i);
        match groups.last_mut() {
            Some((_, last, known)) if *known == these => *last = i,
            _ => groups.push((i, i, these)),
        }
    }
    let more = groups.len().saturating_sub(ROWS);
    let used: Vec<usize> = (0..head.len() - 1).filter(|&c| groups.iter().any(|g| !g.2[c].is_empty())).collect();
    let place = |first: usize, last: usize| match last - first {
        0 => format!("{}", first + 1),
        _ => format!("{} to {}", first + 1, last + 1),
    };
    let row = |(first, last, cells): &(usize, usize, Vec<String>)| {
        std::iter::once(place(*first, *last)).chain(used.iter().map(|&c| cells[c].clone())).collect()
    };
    Groups {
        of,
        head: std::iter::once(head[0]).chain(used.iter().map(|&c| head[c + 1])).collect(),
        rows: groups.iter().take(ROWS).map(row).collect(),
        more,
    }
}
