//! Which couplers of a train exceed their capacity, and when, after another coupler breaks or a shock hits it.
//!
//! # Layers
//!
//! From the ground up. A module refers to modules above its own line only; a test reads the sources and fails on any other arrow.
//!
//! ```text
//! error        what can be wrong with an input, and where
//! units        quantities with their units
//! keys         what the keys of a file are: name, kind, sign
//! law          a coupler's force over its elongation, with slack and friction
//! chain        masses and linear springs in units of their own, and a step or pulse of force on one mass
//! forcing      forces over time on a vehicle
//! solve        the largest force in every coupler of a chain under steps of force, with a bound on its error
//! march        all other motion: dashpots, slack, friction, speeds at the start, forces on many vehicles, couplers that break
//! rod          the continuous rod that a long chain approaches
//! train        TrainSpec -> Train: a train is valid by construction, and this is the only way to one
//! scenario     a train and an event as a problem for solve or march
//! doubts       what in a train or scenario is probably not meant
//! findings     utilisations, verdicts, safe load factors of a train's cases
//! consist      files -> TrainSpec: train files (TOML), tables of vehicles, gears, records, workbooks
//! figures      drawing in SVG and PNG
//! report       findings as Markdown, HTML, CSV, JSON, terminal text and figures
//! fleet        many trains and studies: every case of every variation of every train, one row each
//! document     a train file as a value: its text, and the same with another value of a key
//! schema       the keys of train files and studies as JSON Schema
//! accuracy     errors against references of many digits, and marching methods beside this crate's
//! serve        the program behind a page on this machine
//! ```
//!
//! An analysis goes `consist -> train -> scenario -> solve or march -> findings -> report`. To follow one number, start at
//! [`train::TrainSpec`] and read [`scenario`] next.
//!
//! # Words
//!
//! | word | meaning |
//! | --- | --- |
//! | vehicle, coupler | what a train consists of; coupler `i` joins vehicle `i` and `i + 1`. Numbered from 0 in code, from 1 for users |
//! | mass, spring | the same in a [`chain`](chain::Chain), which has no units |
//! | draft, buff | tension (a positive force) and compression (a negative one); the two *senses* of a force |
//! | load, initial force | the steady state before the event; the force of one coupler in it, N |
//! | event, scenario, case | what happens at t = 0; an event with a horizon and what follows it; a scenario with one broken coupler or none |
//! | scene | a chain with a step or pulse of force: a case for [`solve`] |
//! | horizon | how long forces are followed, s |
//! | transit | the time of a long wave from one end of a part to the other, s |
//! | first passage | the time until the first wave is back from the ends |
//! | rating, limit | a coupler's capacity in a sense, N; further capacities: fatigue, proof, ultimate |
//! | peak | the largest force of a coupler over the horizon, in one sense |
//! | utilisation | peak over rating |
//! | exceeds | the peak is over the rating by more than the error bound |
//! | undecided | the rating is within the error bound of the peak |
//! | bound, estimate | an error that is proven not to be larger; one that is not proven |
//! | doubt | a warning: something that is probably not meant, and no error |
//! | problem | an error in an input, with its key and place |
//! | variation, draw | a train with a study's values; one value of a distribution |
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
pub mod forcing;
mod keys;
pub mod law;
pub mod march;
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
