//! Which couplers of a train exceed their capacity, and when, after another coupler breaks or a shock hits it.
//!
//! Data flows one way:
//!
//! ```text
//! consist -> chain -> scenario -> solve -> findings -> report
//! ```
//!
//! Nothing below knows what is above it. [`consist`] reads and validates a train file; [`chain`] holds coupled masses
//! and springs in the model's own units; [`scenario`] cuts a train and an event into scenes; [`solve`] finds every
//! coupler's largest force in a scene, with a bound on its error; [`findings`] turns those into utilisations and
//! verdicts; [`report`] writes them down. [`fleet`] does all of it for many trains and what-ifs. [`play`] is a scene with all
//! that the paper's chain has not: dashpots, speeds, forces of any shape, couplers that break one after the other.
#![doc = include_str!("equations.md")]

pub mod accuracy;
pub mod chain;
pub mod consist;
pub mod error;
pub mod findings;
pub mod fleet;
mod keys;
pub mod play;
pub mod report;
pub mod rod;
pub mod scenario;
pub mod schema;
pub mod solve;
pub mod units;

pub use consist::Train;
pub use findings::{Analysis, Options, analyze};
