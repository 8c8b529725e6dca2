//! What can be typed after `trainsafe`: definitions only.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use trainsafe::Train;
use trainsafe::fleet;
use trainsafe::report;
use trainsafe::units::UnitSystem;

const MOST_THREADS: usize = 1024;

const STATUS: &str = "\
Exit status: 0 the analysis ran, whatever it found; 1 a coupler exceeds, with --fail-on-exceed;
2 bad usage or bad input; 3 some trains failed; 4 the results could not be written.

Example: trainsafe new > train.toml && trainsafe analyze train.toml";

const FLEET: &str = "\
fleet.csv, errors.csv, fleet.md and figures are written into the folder, or the files that --format
names. An interrupted run can be continued with --resume. Machines that share the folder can compute
a run together: start the same command with --work on each, then join the results with --merge.

Example: trainsafe fleet trains --out reports/yard";

const SERVE: &str = "\
Only browsers on this machine can open the page, and only with the full address, which holds a
random number. On a machine with other users, --no-open keeps the address out of the list of running
programs. The train file is written only when Save is pressed; files that it names are read only in
its own folder.

Example: trainsafe serve trains/ore-train.toml";

const CHECK: &str = "\
Exit status 2 if some file is wrong. In the JSON, files has an entry for each file: problems (path,
line, column, span in bytes, key, message, help, related) and doubts (code, scenario, text).

Example: trainsafe check trains/ore-train.toml trains/paper-figure-4.toml";

const IMPORT: &str = "\
A comment behind each number says where it comes from. What is missing is marked MISSING and listed
here; the file cannot be analysed before it is filled in. The vehicles of a consist are looked for
beside it, in TRAINSET and in ../TRAINSET.

Example: echo \"mass [t],90,80\" | tr , '\\n' > cars.csv && trainsafe import cars.csv > train.toml";

/// Which couplers of a train exceed their capacity, and when, after another coupler breaks or a shock hits the train
#[derive(Debug, Parser)]
#[command(name = "trainsafe", version = trainsafe::VERSION, arg_required_else_help = true, after_help = STATUS)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
    #[command(flatten)]
    pub general: General,
}

#[derive(Debug, Args)]
pub struct General {
    /// Print only errors; --json and commands that print a file still print it
    #[arg(short, long, global = true, display_order = 100)]
    pub quiet: bool,
    /// Number of threads [default: the number of processors]
    #[arg(short = 'j', long, value_name = "N", global = true, value_parser = threads, display_order = 100)]
    pub threads: Option<usize>,
    /// Colours in messages: auto, always or never
    #[arg(long, value_name = "WHEN", global = true, default_value = "auto", hide_default_value = true,
          value_parser = ["auto", "always", "never"], hide_possible_values = true, display_order = 100)]
    pub color: String,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Analyse one train: a short table here, the report in a folder
    #[command(
        after_help = "Example: trainsafe analyze trains/ore-train.toml --scenario \"the rear is hit\" --out study/rear"
    )]
    Analyze(Analyze),
    /// Analyse many trains and what-ifs: one row for each case, and a report on all trains
    #[command(after_help = FLEET, mut_arg("units", |arg| arg.help("Units of fleet.html and of full reports: si or us")))]
    Fleet(Fleet),
    /// Compare the error and run time of all methods and of common simulation methods on one train
    #[command(after_help = "Example: trainsafe accuracy trains/paper-figure-4.toml --out accuracy/figure-4")]
    Accuracy(Accuracy),
    /// Open a train's report as a page that computes every change at once (needs the feature serve)
    #[command(after_help = SERVE)]
    Serve(Serve),
    /// Check train files: print what is wrong or doubtful, describe each train, and say what will be computed
    #[command(after_help = CHECK, mut_arg("units", |arg| arg.help("Units of what is printed: si or us [default: the file's]")))]
    Check(Check),
    /// Print a commented train file to start from
    #[command(after_help = "Example: trainsafe new > train.toml")]
    New,
    /// Print a commented train file made from a table of vehicles or a consist of Open Rails
    #[command(after_help = IMPORT)]
    Import {
        /// The table (CSV, or a workbook: consist.xlsx#Sheet1), or the consist (.con)
        file: PathBuf,
        /// Look for the vehicles of a consist in this folder too
        #[arg(long, value_name = "DIR")]
        trainset: Vec<PathBuf>,
    },
    /// Print the JSON Schema of train files, by which editors complete and check them
    #[command(after_help = "\
An editor with a TOML language server uses the schema if the first line of the file is
#:schema ./train.schema.json

Example: trainsafe schema > train.schema.json")]
    Schema {
        /// The schema of study files instead
        #[arg(long)]
        study: bool,
    },
    /// Print a shell completion script
    #[command(after_help = "Example: trainsafe completions bash > trainsafe.bash")]
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
    /// Print the manual page, or write those of all commands into a folder
    #[command(after_help = "Example: trainsafe man --out man1")]
    Man {
        /// Print the page of this command
        #[arg(value_name = "COMMAND")]
        of: Option<String>,
        /// Folder for trainsafe.1, trainsafe-analyze.1 and the others
        #[arg(short, long, value_name = "DIR", conflicts_with = "of")]
        out: Option<PathBuf>,
    },
}

#[derive(Debug, Args)]
pub struct Check {
    /// The train files; - reads standard input
    #[arg(required = true, value_name = "TRAIN")]
    pub trains: Vec<PathBuf>,
    /// Print what is wrong and what is doubtful as JSON, with places by line, column and bytes
    #[arg(long, conflicts_with = "units")]
    pub json: bool,
    #[command(flatten)]
    pub units: Units,
}

#[derive(Debug, Args)]
pub struct Units {
    /// Units of what is printed and of the report: si or us [default: the file's]
    #[arg(long, value_name = "SYSTEM", value_parser = UnitSystem::NAMES, hide_possible_values = true)]
    units: Option<String>,
}

impl Units {
    /// Those that were asked for.
    pub fn asked(&self) -> Option<UnitSystem> {
        self.units.as_deref().and_then(UnitSystem::from_name)
    }

    /// The train with these units, or as it is.
    pub fn of(&self, train: Train) -> Train {
        match self.asked() {
            Some(units) => train.with_units(units),
            None => train,
        }
    }
}

#[derive(Debug, Args)]
pub struct Analyze {
    /// The train file; - reads standard input
    pub train: PathBuf,
    /// Folder for the report [default: reports/<file stem>]
    #[arg(short, long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Forms of the report: md, html, or both
    #[arg(long, value_name = "LIST", default_value = "md,html", value_delimiter = ',',
          value_parser = report::Format::ALL.map(report::Format::name), conflicts_with = "json")]
    pub format: Vec<String>,
    #[command(flatten)]
    pub units: Units,
    /// Run this scenario only
    #[arg(long, value_name = "NAME")]
    pub scenario: Option<String>,
    /// Print result.json to standard output; write no files
    #[arg(long, conflicts_with_all = ["out", "units"])]
    pub json: bool,
    /// Exit with status 1 if a coupler exceeds its rating, or if it is not decided whether one does
    #[arg(long)]
    pub fail_on_exceed: bool,
    /// Leave out couplers that cannot exceed their rating at any time; leaves out none where limits are below ratings
    #[arg(long)]
    pub verdict_only: bool,
    /// Report a bound on every coupler's force over all time
    #[arg(long)]
    pub all_time_bound: bool,
    /// Also compute the smallest overloading force for each duration of a pulse, or the safe load for each broken coupler
    #[arg(long)]
    pub map: bool,
    #[command(flatten)]
    pub solver: Solver,
}

#[derive(Debug, Args)]
pub struct Fleet {
    /// Train files, folders of them, globs in quotes, or one study file
    #[arg(required_unless_present = "merge", value_name = "PATH", conflicts_with = "merge")]
    pub paths: Vec<PathBuf>,
    /// Folder for the results [default: reports/<stem of the only path>, or reports/fleet]
    #[arg(short, long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print one line of JSON for each case to standard output; write no files
    #[arg(long, conflicts_with_all = ["out", "resume", "work", "merge", "couplers"])]
    pub json: bool,
    /// Files to write, separated by commas; the others are made from fleet.csv and errors.csv, which are always written
    #[arg(long, value_name = "LIST", default_value = "csv,md", value_delimiter = ',',
          value_parser = fleet::FleetFormat::ALL.map(fleet::FleetFormat::name), conflicts_with_all = ["json", "work"])]
    pub format: Vec<String>,
    /// Write the full reports of the N worst trains as well, in trains/ in the folder; fleet.html links to them
    #[arg(long, value_name = "N", default_value_t = 0, conflicts_with_all = ["json", "work"])]
    pub reports: usize,
    #[command(flatten)]
    pub units: Units,
    /// Continue the run in the folder: compute only what is missing
    #[arg(long, conflicts_with = "merge")]
    pub resume: bool,
    /// Write every coupler of every case too: Parquet files in couplers/ in the folder, one for each part of the run
    #[arg(long, conflicts_with = "merge")]
    pub couplers: bool,
    /// Compute cases of the run in the folder that no other worker has taken, until none is left
    #[arg(long, conflicts_with_all = ["merge", "resume"])]
    pub work: bool,
    /// Join the results of the workers in the folder into the files of one run
    #[arg(long, requires = "out", conflicts_with_all = ["tolerance", "method"])]
    pub merge: bool,
    /// Print the number of cases and about how long they will take, and stop
    #[arg(long, conflicts_with_all = ["json", "merge"])]
    pub dry_run: bool,
    /// Exit with status 1 if a coupler exceeds its rating, or if it is not decided whether one does
    #[arg(long, conflicts_with = "work")]
    pub fail_on_exceed: bool,
    #[command(flatten)]
    pub solver: Solver,
}

#[derive(Debug, Args)]
pub struct Serve {
    /// The train file
    pub train: PathBuf,
    /// Listen on this port of 127.0.0.1 [default: a free one]
    #[arg(long, value_name = "PORT", default_value_t = 0, hide_default_value = true)]
    pub port: u16,
    /// Print the address and open no browser
    #[arg(long)]
    pub no_open: bool,
}

#[derive(Debug, Args)]
pub struct Solver {
    /// The error each force may have, as a share of the largest rating; with slack, gears or brakes at least 1e-6
    #[arg(long, value_name = "SHARE", default_value = "1e-9", value_parser = share)]
    pub tolerance: f64,
    /// Compute by this method [default: the cheapest that reaches the tolerance]
    #[arg(long, value_name = "NAME", value_parser = ["fronts", "modal", "propagator"])]
    pub method: Option<String>,
}

#[derive(Debug, Args)]
pub struct Accuracy {
    /// The train file; - reads standard input
    #[arg(required_unless_present = "stress")]
    pub train: Option<PathBuf>,
    /// Folder for the table, its CSV and the figure [default: reports/accuracy/<file stem>]
    #[arg(short, long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Compare on this scenario [default: the first]
    #[arg(long, value_name = "NAME")]
    pub scenario: Option<String>,
    /// Run the extreme cases instead: method, error, bound, time and verdict of each
    #[arg(long, conflicts_with_all = ["train", "scenario", "out"])]
    pub stress: bool,
}

fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x > 0.0 && x < 1.0 => Ok(x),
        _ => Err("a number between 0 and 1 is needed, such as 1e-9".to_owned()),
    }
}

fn threads(text: &str) -> Result<usize, String> {
    let number = text.parse().ok().filter(|n| (1..=MOST_THREADS).contains(n));
    number.ok_or_else(|| format!("a number from 1 to {MOST_THREADS} is needed"))
}
