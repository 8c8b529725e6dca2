//! The command line: parse, call the library, set the exit status.

mod cli;
mod manual;
mod run_check;
mod run_fleet;
mod run_serve;
mod signals;

use std::ffi::{OsStr, OsString};
use std::fmt::Display;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, Instant};

use clap::Parser;
use trainsafe::accuracy::{self, AccuracyError};
use trainsafe::doubts::doubts;
use trainsafe::error::{InputError, printable_path};
use trainsafe::findings::CaseFindings;
use trainsafe::report::Format;
use trainsafe::solve::Method;
use trainsafe::{Analysis, Options, Train, consist, findings, report, schema};

use cli::{Cli, Command};

/// Analyses that take longer than this are announced before they start, s.
const LONG_S: f64 = 5.0;

/// Memory above this is announced beforehand too, bytes.
const LARGE: usize = 1 << 30;

/// Exit statuses besides success.
#[derive(Clone, Copy)]
enum Failure {
    Exceeds = 1,
    Input = 2,
    Some = 3,
    Output = 4,
}

/// Whether only errors are printed.
static QUIET: AtomicBool = AtomicBool::new(false);

fn main() -> ExitCode {
    ExitCode::from(run(std::env::args_os()))
}

/// Runs a command line, whose first word is the program's name; the exit status.
pub fn run(args: impl Iterator<Item = OsString>) -> u8 {
    let Cli { command, general } = Cli::try_parse_from(args).unwrap_or_else(|e| usage(e));
    apply_general_options(&general);
    let done = match command {
        Command::Analyze(args) => analyze(&args),
        Command::Fleet(args) => run_fleet::run(&args),
        Command::Accuracy(args) => accuracy(&args),
        Command::Serve(args) => run_serve::run(&args),
        Command::Check(args) => run_check::run(&args),
        Command::New => print(consist::TEMPLATE),
        Command::Import { file, trainset } => import(&file, &trainset),
        Command::Schema { study } => print(&schema::text(study)),
        Command::Completions { shell } => print(&manual::completions(shell)),
        Command::Man { of, out } => man(of.as_deref(), out.as_deref()),
    };
    done.map_or_else(|failure| failure as u8, |()| 0)
}

/// Prints what is wrong with the command line; for a file in the place of a command, what commands take it.
fn usage(error: clap::Error) -> ! {
    use clap::error::{ContextKind, ContextValue, ErrorKind};
    if let (ErrorKind::InvalidSubcommand, Some(ContextValue::String(word))) =
        (error.kind(), error.get(ContextKind::InvalidSubcommand))
        && Path::new(word).exists()
    {
        let shown = printable_path(Path::new(word));
        say(&format!("error: {shown} is a file and no command: type trainsafe analyze {shown}, or check or fleet"));
        std::process::exit(Failure::Input as i32);
    }
    error.exit()
}

/// Applies the options that every command has.
fn apply_general_options(general: &cli::General) {
    QUIET.store(general.quiet, Ordering::Relaxed);
    match general.color.as_str() {
        "always" => anstream::ColorChoice::Always.write_global(),
        "never" => anstream::ColorChoice::Never.write_global(),
        _ => {}
    }
    if let Some(threads) = general.threads {
        // It fails only where threads have started, which none have.
        let _ = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    }
}

fn analyze(args: &cli::Analyze) -> Result<(), Failure> {
    let train = args.units.of(read(&args.train)?);
    let options = Options {
        scenario: args.scenario.clone(),
        verdict_only: args.verdict_only,
        all_time_bound: args.all_time_bound,
        map: args.map,
        damping: true,
        ..options(&args.solver)
    };
    let seconds = findings::estimate_s(&train, &options).map_err(|e| complain(&args.train, &e))?;
    findings::idle_options(&train, &options).iter().for_each(|note| say_unless_quiet(&format!("note: {note}")));
    let known = doubts(&train);
    known.iter().for_each(|warning| say_unless_quiet(&format!("warning: {warning}")));
    let bytes = findings::memory_bytes(&train, &options).unwrap_or_default();
    let memory = if bytes > LARGE { format!(" and {:.1} GB of memory", bytes as f64 / 1e9) } else { String::new() };
    if seconds > LONG_S || bytes > LARGE {
        say_unless_quiet(&format!("this will take about {seconds:.0} s{memory}"));
    }
    let dir = args.out.clone().unwrap_or_else(|| named_after(&args.train, "reports"));
    if !args.json {
        prepare_to_write(&dir)?;
    }
    let analysis =
        with_clock(seconds, || findings::analyze(&train, &options)).map_err(|e| complain(&args.train, &e))?;
    let found = analysis.doubts.iter().filter(|doubt| !known.contains(doubt));
    found.for_each(|warning| say_unless_quiet(&format!("warning: {warning}")));
    if args.json {
        let json = report::json(&analysis).map_err(|e| output_failed(&e))?;
        print(&(json + "\n"))?;
    } else {
        let wanted = |f: &Format| args.format.iter().any(|name| name == f.name());
        let formats: Vec<Format> = Format::ALL.into_iter().filter(wanted).collect();
        let written = report::write(&train, &analysis, &dir, &formats).map_err(|e| output_failed(&e))?;
        summary(&report::terminal(&analysis, &written[written.len() - formats.len()..]))?;
    }
    if args.fail_on_exceed && exceeds(&analysis) { Err(Failure::Exceeds) } else { Ok(()) }
}

fn import(file: &Path, trainsets: &[PathBuf]) -> Result<(), Failure> {
    let imported = consist::import(file, trainsets).map_err(|e| {
        say(&e.render(true));
        Failure::Input
    })?;
    print(&imported.text)?;
    imported.missing.iter().for_each(|what| say_unless_quiet(&format!("missing: {what}")));
    imported.doubts.iter().for_each(|warning| say_unless_quiet(&format!("warning: {warning}")));
    Ok(())
}

/// Does work, and if it is long prints the elapsed time at intervals.
fn with_clock<T: Send>(estimate_s: f64, work: impl FnOnce() -> T + Send) -> T {
    if estimate_s <= LONG_S {
        return work();
    }
    let (done, wait) = mpsc::channel::<()>();
    let start = Instant::now();
    std::thread::scope(|scope| {
        scope.spawn(move || {
            while let Err(RecvTimeoutError::Timeout) = wait.recv_timeout(Duration::from_secs_f64(2.0 * LONG_S)) {
                say_unless_quiet(&format!("{:.0} s of about {estimate_s:.0} s", start.elapsed().as_secs_f64()));
            }
        });
        let result = work();
        drop(done);
        result
    })
}

fn accuracy(args: &cli::Accuracy) -> Result<(), Failure> {
    let Some(path) = &args.train else {
        return print(&accuracy::stress::terminal(&accuracy::stress::stress()));
    };
    let train = read(path)?;
    let dir = args.out.clone().unwrap_or_else(|| named_after(path, "reports/accuracy"));
    prepare_to_write(&dir)?;
    let options = accuracy::AccuracyOptions::default();
    let compared = accuracy::run(&train, args.scenario.as_deref(), &options).map_err(|e| complain(path, &e))?;
    accuracy::write(&compared, &dir).map_err(|e| match e {
        AccuracyError::Write(_) => output_failed(&e),
        _ => complain(path, &e),
    })?;
    summary(&format!("{}\nReport: {}\n", accuracy::terminal(&compared, None), printable_path(&dir.join("accuracy.md"))))
}

/// Refuses a folder that cannot be written before the work rather than after it, and lets signals wait while files are replaced.
fn prepare_to_write(dir: &Path) -> Result<(), Failure> {
    signals::handle_signals(|| ());
    report::can_write(dir).map_err(|e| output_failed(&e))
}

fn man(of: Option<&str>, out: Option<&Path>) -> Result<(), Failure> {
    let pages = manual::pages().map_err(|e| output_failed(&e))?;
    if let Some(dir) = out {
        return report::write_all(dir, &pages).map(|_| ()).map_err(|e| output_failed(&e));
    }
    let name = of.map_or("trainsafe.1".to_owned(), |of| format!("trainsafe-{of}.1"));
    match pages.into_iter().find(|(page, _)| *page == name) {
        Some((_, page)) => print(&String::from_utf8_lossy(&page)),
        None => {
            say(&format!("error: trainsafe has no command {:?}; trainsafe --help lists them", of.unwrap_or_default()));
            Err(Failure::Input)
        }
    }
}

/// How each case is to be solved.
fn options(solver: &cli::Solver) -> Options {
    let method = solver.method.as_deref().and_then(Method::from_name);
    Options { tolerance: solver.tolerance, method, ..Options::default() }
}

/// Whether some coupler exceeds, or is not decided up to the horizon.
fn exceeds(analysis: &Analysis) -> bool {
    let open = |c: &CaseFindings| c.exceeding + c.undecided > 0 || c.predictable_until_s.is_some();
    analysis.scenarios.iter().flat_map(|s| &s.cases).any(open)
}

/// The folder of a train's results within another, named after the train file.
fn named_after(train: &Path, within: &str) -> PathBuf {
    Path::new(within).join(stem(train).unwrap_or("train".as_ref()))
}

/// A file's stem as the name of a folder; not one that leads elsewhere, as that of "...toml".
fn stem(path: &Path) -> Option<&OsStr> {
    path.file_stem().filter(|stem| !["-", ".", ".."].contains(&stem.to_string_lossy().as_ref()))
}

/// The train of a file, or of standard input.
fn read_train(path: &Path) -> Result<Train, InputError> {
    match path.to_str() {
        Some("-") => consist::read_from(&mut io::stdin().lock(), consist::STDIN.as_ref()),
        _ => consist::read(path),
    }
}

/// The train, or its problems on standard error.
fn read(path: &Path) -> Result<Train, Failure> {
    read_train(path).map_err(|e| {
        say(&e.render(true));
        Failure::Input
    })
}

fn complain(path: &Path, error: &dyn Display) -> Failure {
    say(&format!("error: {}: {error}", printable_path(path)));
    Failure::Input
}

fn output_failed(error: &dyn Display) -> Failure {
    say(&format!("error: {error}"));
    Failure::Output
}

fn quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// A note, a warning or the progress, on standard error; nothing with `--quiet`.
fn say_unless_quiet(text: &str) {
    if !quiet() {
        say(text);
    }
}

/// What a command has done, on standard output; nothing with `--quiet`.
fn summary(text: &str) -> Result<(), Failure> {
    if quiet() { Ok(()) } else { print(text) }
}

/// A line on standard error, with colours where asked for. If that fails, there is no other place to report it.
fn say(text: &str) {
    let _ = writeln!(anstream::stderr(), "{}", text.trim_end());
}

/// Text on standard output. A reader that has seen enough and closed the pipe is no failure.
fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => {
            Err(output_failed(&format!("cannot write to standard output: {e}")))
        }
        _ => Ok(()),
    }
}
