//! Trains with slack, gears and brake waves: a reference of its own, and the methods that simulators use, beside the march.

pub mod bench;
pub mod clamp;
pub mod curves;
pub mod exact;
pub mod outside;
pub mod peers;
mod roots;
#[cfg(test)]
mod tests;
