//! The solvers against references that share no code with them: tests/reference holds the scripts and their data.

#[path = "common/scenes.rs"]
mod scenes;

use scenes::*;

#[test]
fn unequal_trains_to_forty_digits() {
    let found: Vec<String> = references(include_str!("reference/unequal.json")).iter().flat_map(all_departures).collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
}
