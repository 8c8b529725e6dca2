//! Couplers with slack and gears: the march from event to event.

mod breaks;
mod cli;
mod gears;
mod hard;
mod invariants;
mod oracles;
mod published;
mod tables;
mod verlet;
