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
//! [`law`] is a coupler's force with slack and friction, and [`march`] the motion of trains that have them.
//! [`schema`] makes of the reader's tables of keys a JSON Schema for editors.
//!
//! Features, both on by default: `cli` builds the program, `accuracy` the module of that name. `parquet` lets a fleet write
//! `fleet.parquet`, `serve` builds the module of that name.
//!
//! ```
//! let train = trainsafe::consist::read("trains/paper-figure-4.toml".as_ref())?;
//! let analysis = trainsafe::analyze(&train, &trainsafe::Options::default())?;
//! let case = &analysis.scenarios[0].cases[0];
//! let worst = case.worst.as_ref().expect("50 couplers are left");
//! // The paper's overload of a half, in draft at the held end, long after that coupler was first over its rating in buff.
//! assert_eq!((worst.coupler, case.exceeding), (1, 48));
//! assert!((worst.utilisation - 1.508).abs() < 1e-3 && worst.peak_force_n > 0.0);
//! assert_eq!(worst.first_exceeds_in, Some("buff"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![doc = include_str!("equations.md")]

#[cfg(feature = "accuracy")]
pub mod accuracy;
pub mod chain;
pub mod consist;
pub mod document;
pub mod doubts;
pub mod error;
#[cfg_attr(not(feature = "accuracy"), allow(dead_code))]
mod figures;
pub mod findings;
pub mod fleet;
mod keys;
pub mod law;
pub mod march;
pub mod play;
pub mod report;
pub mod rod;
pub mod scenario;
pub mod schema;
#[cfg(feature = "serve")]
pub mod serve;
pub mod solve;
pub mod train;
pub mod units;

/// The version of this crate.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

pub use findings::{Analysis, Options, analyze};
pub use train::Train;
