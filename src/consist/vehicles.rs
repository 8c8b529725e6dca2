//! The vehicles of a train file, in groups of alike ones.

use super::loads::{self, OwnLoad};
use super::tree::{Found, Read, Table};
use crate::error::Problem;
use crate::train::{MOST_VEHICLES, VehicleSpec, many};

/// The groups of a table.
pub(super) fn groups_of_table(root: &Table, groups: Vec<Group>) -> Read<Vec<Group>> {
    if let (Some(spelt_out), Some(table)) = (root.key_span("vehicle"), root.key_span("vehicles")) {
        let title = "the train has its vehicles twice, as a table and as [[vehicle]]";
        return Err(root.note_because(spelt_out, title, "keep one of the two", table, "the table"));
    }
    Ok(groups)
}

/// Vehicles alike that follow each other: a `[[vehicle]]` table, or a row of a table of vehicles.
pub(super) struct Group {
    pub(super) vehicle: VehicleSpec,
    pub(super) load: OwnLoad,
}

/// The groups of the `[[vehicle]]` tables.
pub(super) fn groups_of_vehicle_tables(found: &Found, root: &Table) -> Read<Vec<Group>> {
    if let Some(table) = root.get("vehicles") {
        return Err(table.wrong_type("expected the name of a table: vehicles = \"consist.csv\""));
    }
    let tables = root.get("vehicle").map_or(Ok(vec![]), |value| value.tables())?;
    let groups = tables.iter().map(group).collect::<Vec<_>>().into_iter().collect::<Read<Vec<Group>>>()?;
    let vehicles: Vec<VehicleSpec> = groups.iter().map(|group| group.vehicle.clone()).collect();
    let wrong = many(&vehicles).into_iter().map(|bad| {
        found.note(match root.place(&bad.key) {
            Some(at) => Problem::at(at, bad.message, Some(bad.help)),
            None => Problem::of_file(bad.message, bad.help),
        })
    });
    wrong.last().map_or(Ok(groups), Err)
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
        vehicle: VehicleSpec {
            label: label.unwrap_or(None).map(|label| label.trim().to_owned()),
            count,
            mass_kg: mass.unwrap_or(1.0),
            held: held.unwrap_or(false),
            length_m: length.unwrap_or(None),
            emergency_brake_n: load.emergency_brake_n,
        },
        load,
    })
}
