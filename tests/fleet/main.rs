//! Fleets, studies, shares of workers, and what is resumed.

#[path = "../helpers/fleets.rs"]
mod fleets;

mod doubts;
mod faults;
mod folders;
mod html;
mod passages;
mod provenance;
mod resume_sources;
mod studies;
mod study_cases;
mod study_draws;
mod study_reach;
mod workers;
