//! Reports, pages, figures, the command line, the README, and the order of the modules.

#[path = "../helpers/trains.rs"]
mod common;
#[path = "../helpers/fleets.rs"]
mod fleets;

mod accuracy;
mod cli;
mod figures;
mod help;
mod layers;
mod markdown;
mod page;
mod readme;
