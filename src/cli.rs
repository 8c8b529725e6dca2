//! What can be typed after `trainsafe`: definitions only.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

/// Which couplers of a train exceed their capacity, and when, after another coupler breaks or a shock hits the train.
///
/// Exit status: 0 the analysis ran, whatever it found; 1 a coupler exceeds, with --fail-on-exceed; 2 bad usage or bad input;
/// 4 the results could not be written.
#[derive(Debug, Parser)]
#[command(
    version,
    arg_required_else_help = true,
    after_help = "Example: trainsafe new > train.toml && trainsafe analyze train.toml"
)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Analyse one train: a short table here, the report in a folder
    #[command(after_help = "Example: trainsafe analyze consist.toml --scenario \"the rear is hit\" --out study/rear")]
    Analyze(Analyze),
    /// Show error against run time: every method on this train, and those that engineers know, against 30 digits
    #[command(after_help = "Example: trainsafe accuracy consist.toml --out accuracy/consist")]
    Accuracy(Accuracy),
    /// Say whether a train file is right, and in words what the train is and what will be run
    #[command(after_help = "Example: trainsafe check consist.toml")]
    Check {
        /// The train file
        train: PathBuf,
    },
    /// Print a commented train file to start from
    #[command(after_help = "Example: trainsafe new > consist.toml")]
    New,
}

#[derive(Debug, Args)]
pub struct Analyze {
    /// The train file
    pub train: PathBuf,
    /// Folder for the report [default: reports/<file stem>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Run this scenario only
    #[arg(long, value_name = "NAME")]
    pub scenario: Option<String>,
    /// Print result.json to standard output and nothing else there; write no files
    #[arg(long, conflicts_with = "out")]
    pub json: bool,
    /// Exit with status 1 if some coupler exceeds, or cannot be told not to
    #[arg(long)]
    pub fail_on_exceed: bool,
    /// Add a map to each scenario: the smallest overloading force by duration of the pulse, or the safe load by broken coupler
    #[arg(long)]
    pub map: bool,
    #[command(flatten)]
    pub solver: Solver,
}

#[derive(Debug, Args)]
pub struct Solver {
    /// The error each force may have, as a share of the largest rating
    #[arg(long, value_name = "SHARE", default_value = "1e-9", value_parser = share)]
    pub tolerance: f64,
    /// Compute in this way, whatever it costs [default: the cheapest within the tolerance]
    #[arg(long, value_name = "NAME", value_parser = ["closed-form", "fronts", "modal", "propagator"])]
    pub method: Option<String>,
    /// Leave out couplers that cannot exceed at any time: their all-time bound is under their rating
    #[arg(long)]
    pub verdict_only: bool,
    /// Report the all-time bound of every coupler's force
    #[arg(long)]
    pub all_time_bound: bool,
}

#[derive(Debug, Args)]
pub struct Accuracy {
    /// The train file
    #[arg(required_unless_present = "stress")]
    pub train: Option<PathBuf>,
    /// Folder for the table, its CSV and the figure [default: reports/accuracy/<file stem>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Compare on this scenario [default: the first]
    #[arg(long, value_name = "NAME")]
    pub scenario: Option<String>,
    /// Run the extreme cases instead: case, method chosen, error, bound, time, verdict
    #[arg(long, conflicts_with_all = ["train", "scenario", "out"])]
    pub stress: bool,
}

fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x > 0.0 && x < 1.0 => Ok(x),
        _ => Err("a number between 0 and 1 is needed, such as 1e-9".to_owned()),
    }
}
