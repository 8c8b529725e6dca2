//! The motion of linear trains against references, bounds, and what must hold for every train.

#[allow(dead_code)] // The example `campaign` prints more of it.
#[path = "../campaign/mod.rs"]
mod campaign;
#[path = "../helpers/scenes.rs"]
mod scenes;

mod bounds;
mod buff_breaks;
mod cascade;
mod damped_modes;
mod extremes;
mod field;
mod first_passage;
mod horizon;
mod impact_load;
mod invariants;
mod linear;
mod map;
mod marched;
mod motions;
mod oracles;
mod planner;
mod random_trains;
mod responses;
mod same;
mod worst;
