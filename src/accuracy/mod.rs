//! Error against run time: every method of this crate and those that engineers know, against a reference of 30 digits and more.

pub mod campaign;
pub mod reference;
pub mod stress;
