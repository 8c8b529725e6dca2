//! `trainsafe fleet`.

use std::io::{self, ErrorKind, IsTerminal};
use std::path::{Path, PathBuf};

use trainsafe::error::printable_path;
use trainsafe::fleet::{self, Estimate, FleetError, FleetFormat, Outcome, Request, Worker};

use super::{Failure, cli, options, print, quiet, say, say_unless_quiet, signals, stem, summary};

pub fn run(args: &cli::Fleet) -> Result<(), Failure> {
    let request = Request {
        paths: args.paths.clone(),
        options: options(&args.solver),
        worker: args.work.then(Worker::new),
        couplers: args.couplers,
        units: args.units.asked(),
        resume: args.resume,
        formats: args.format.iter().filter_map(|name| FleetFormat::from_name(name)).collect(),
        reports: args.reports,
        response_bytes: None,
        progress: if quiet() { fleet::ProgressTarget::Nothing } else { fleet::ProgressTarget::Terminal },
    };
    if args.dry_run {
        return fleet::estimate(&request).map_err(|e| failed(&e)).and_then(|estimate| {
            estimate.notes.iter().for_each(|note| say_unless_quiet(&format!("note: {note}")));
            print(&estimate_text(&estimate))
        });
    }
    let dir = args.out.clone().unwrap_or_else(|| default_dir(&args.paths));
    if !args.json {
        let (how_to_continue, worker, dir) = (how_to_continue(args), request.worker.clone(), dir.clone());
        signals::handle_signals(move || {
            worker.iter().for_each(|worker| worker.leave(&dir));
            let line = if io::stderr().is_terminal() { "\n" } else { "" };
            say(&format!("{line}stopped; {how_to_continue}"));
        });
    }
    let outcome = if args.json {
        match fleet::stream(&request, &mut io::stdout().lock()) {
            // A reader that has seen enough and closed the pipe is no failure.
            Err(FleetError::Output(e)) if e.kind() == ErrorKind::BrokenPipe => return Ok(()),
            other => other,
        }
    } else if args.merge {
        fleet::merge(&request, &dir)
    } else {
        fleet::run(&request, &dir)
    };
    let outcome = outcome.map_err(|e| {
        let failure = failed(&e);
        if matches!(e, FleetError::Write(_)) && fleet::is_begun(&dir) {
            say(&how_to_continue(args));
        }
        failure
    })?;
    if !args.json {
        summary(&outcome_text(&outcome, &dir, outcome.verdict.is_empty()))?;
    }
    outcome.notes.iter().for_each(|note| say_unless_quiet(&format!("note: {note}")));
    match outcome.computed {
        0 => outcome.warnings.iter().for_each(|warning| say(&format!("error: {warning}"))),
        _ => outcome.warnings.iter().for_each(|warning| say_unless_quiet(&format!("warning: {warning}"))),
    }
    if outcome.scenes.0 > 0 {
        say_unless_quiet(
            &format!("{} made, {} more reused", count(outcome.scenes.1, "calculation"), outcome.scenes.0,),
        );
    }
    match outcome {
        Outcome { computed: 0, .. } => Err(Failure::Input),
        Outcome { failed: 1.., .. } => Err(Failure::Some),
        Outcome { exceeding: 1.., .. } if args.fail_on_exceed => Err(Failure::Exceeds),
        _ => Ok(()),
    }
}

/// How to go on after a run was cut short.
fn how_to_continue(args: &cli::Fleet) -> String {
    let with = if args.work || args.merge || args.resume { "again" } else { "with --resume" };
    format!("cases that are done are kept: to go on, give the same command {with}")
}

fn default_dir(paths: &[PathBuf]) -> PathBuf {
    let name = match paths {
        [one] if one.exists() => stem(one),
        _ => None,
    };
    Path::new("reports").join(name.unwrap_or("fleet".as_ref()))
}

fn outcome_text(outcome: &Outcome, dir: &Path, is_worker: bool) -> String {
    if is_worker {
        return format!("every part is done; to join them: trainsafe fleet --merge --out {}\n", printable_path(dir));
    }
    let (what, path) = match &outcome.report {
        Some(report) => ("report", report.as_path()),
        None => ("results", dir),
    };
    format!("{}\n{what}: {}\n", outcome.verdict.join("\n"), printable_path(path))
}

fn estimate_text(estimate: &Estimate) -> String {
    let Estimate { trains, variations, cases, seconds: [least, most], threads, .. } = *estimate;
    let (unit, length) = match most {
        s if s < 90.0 => ("s", 1.0),
        s if s < 5400.0 => ("min", 60.0),
        _ => ("hours", 3600.0),
    };
    let time = match (least / length, most / length) {
        (_, most) if most < 1.0 => format!("less than 1 {unit}"),
        // An estimate has at most two digits.
        (least, most) if most < 10.0 => format!("about {least:.1} to {most:.1} {unit}"),
        (least, most) => format!("about {least:.0} to {most:.0} {unit}"),
    };
    let varied = if variations == 1 { String::new() } else { format!("{variations} variations of each, ") };
    let [trains, threads] = [count(trains as u64, "train"), count(threads as u64, "thread")];
    format!("{trains}, {varied}{}\n{time} on {threads}\n", count(cases, "case"))
}

fn count(n: u64, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

fn failed(error: &FleetError) -> Failure {
    match error {
        FleetError::Study(study) => {
            say(&study.render(true));
            Failure::Input
        }
        FleetError::Usage(_) | FleetError::Changed(_) | FleetError::Stopped(_) => {
            say(&format!("error: {error}"));
            Failure::Input
        }
        FleetError::Write(_) | FleetError::Output(_) => {
            say(&format!("error: {error}"));
            Failure::Output
        }
    }
}
