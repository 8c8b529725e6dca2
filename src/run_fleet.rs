//! `trainsafe fleet`.

use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::thread::available_parallelism;

use trainsafe::fleet::{self, Estimate, FleetError, Format, Outcome, Request};

use crate::{Failure, cli, options, print, say};

pub fn run(args: &cli::Fleet) -> Result<(), Failure> {
    let request = Request {
        paths: args.paths.clone(),
        options: options(&args.solver),
        shard: args.shard,
        resume: args.resume,
        formats: args.format.iter().filter_map(|name| Format::from_name(name)).collect(),
        memo_bytes: None,
    };
    if args.dry_run {
        return fleet::estimate(&request).map_err(|e| failed(&e)).and_then(|estimate| print(&told(&estimate)));
    }
    let dir = args.out.clone().unwrap_or_else(|| default_dir(&args.paths));
    let outcome = if args.json {
        match fleet::stream(&request, &mut io::stdout().lock()) {
            // A reader that has seen enough and closed the pipe is no failure.
            Err(FleetError::Output(e)) if e.kind() == ErrorKind::BrokenPipe => return Ok(()),
            other => other,
        }
    } else if args.merge {
        fleet::merge(&dir, &request.formats)
    } else {
        fleet::run(&request, &dir)
    };
    let outcome = outcome.map_err(|e| failed(&e))?;
    if !args.json {
        print(&summary(&outcome, &dir, outcome.verdict.is_empty()))?;
    }
    if outcome.scenes.0 > 0 {
        say(&format!(
            "{} parts of trains solved, {} more were the same as one of them",
            outcome.scenes.1, outcome.scenes.0
        ));
    }
    match outcome {
        Outcome { computed: 0, .. } => Err(Failure::Input),
        Outcome { failed: 1.., .. } => Err(Failure::Some),
        Outcome { exceeding: 1.., .. } if args.fail_on_exceed => Err(Failure::Exceeds),
        _ => Ok(()),
    }
}

fn default_dir(paths: &[PathBuf]) -> PathBuf {
    let name = match paths {
        [one] => one.file_stem().filter(|_| one.exists()),
        _ => None,
    };
    Path::new("reports").join(name.unwrap_or("fleet".as_ref()))
}

fn summary(outcome: &Outcome, dir: &Path, is_share: bool) -> String {
    if is_share {
        return format!("this share is done; when all are: trainsafe fleet --merge --out {}\n", dir.display());
    }
    let (what, path) = match &outcome.report {
        Some(report) => ("report", report.as_path()),
        None => ("results", dir),
    };
    format!("{}\n{what}: {}\n", outcome.verdict.join("\n"), path.display())
}

fn told(estimate: &Estimate) -> String {
    let Estimate { trains, variations, cases, seconds } = estimate;
    let threads = available_parallelism().map_or(1, |n| n.get());
    let time = |s: f64| match s {
        s if s < 90.0 => format!("{s:.0} s"),
        s if s < 5400.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} hours", s / 3600.0),
    };
    let on_all = time(seconds / threads as f64);
    format!("{trains} trains, {variations} variations of each, {cases} cases\nabout {on_all} on {threads} threads\n")
}

fn failed(error: &FleetError) -> Failure {
    match error {
        FleetError::Study(study) => {
            say(&study.render(true));
            Failure::Input
        }
        FleetError::Usage(_) | FleetError::Changed(_) => {
            say(&format!("error: {error}"));
            Failure::Input
        }
        FleetError::Write(_) | FleetError::Output(_) => {
            say(&format!("error: {error}"));
            Failure::Output
        }
    }
}
