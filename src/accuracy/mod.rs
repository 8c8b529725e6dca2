//! Error against run time: this crate's methods beside those that engineers march trains with.

pub mod peers;
