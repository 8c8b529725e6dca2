//! What is read: train files, tables, records, units, names, and the messages of what is wrong with them.

#[path = "../helpers/trains.rs"]
mod common;
#[path = "../helpers/fleets.rs"]
mod fleets;

mod bad_trains;
mod consist;
mod conventions;
mod every_key;
mod every_option;
mod exports;
mod faults;
mod fuzz_found;
mod hostile;
mod import;
mod limits;
mod limits_by_sense;
mod loads;
mod names;
mod plausibility;
mod schema;
mod table;
mod train_spec;
mod units;
mod units_spellings;
