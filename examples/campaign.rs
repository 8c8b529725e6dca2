//! Every method against the reference on random trains: `cargo run --release --example campaign -- 2000`; with `--kinds`, analyses
//! of trains with every kind of scenario; with `--gears`, the error estimate of trains with slack, gears and brakes.

use std::process::ExitCode;

#[allow(dead_code)] // Tests use more of it.
#[path = "../tests/campaign/mod.rs"]
mod campaign;

use campaign::{gears, kinds, kinds::Quantity, kinds::Tally, trains::Kind};

fn main() -> ExitCode {
    let (named, numbers): (Vec<String>, Vec<String>) = std::env::args().skip(1).partition(|a| a.starts_with("--"));
    let mut args = numbers.iter().map(|a| a.parse::<u64>());
    let (count, first) = match (args.next().unwrap_or(Ok(2000)), args.next().unwrap_or(Ok(0))) {
        (Ok(count), Ok(first)) => (count, first),
        _ => {
            return usage();
        }
    };
    let seeds: Vec<u64> = (first..first + count).collect();
    match named.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => {}
        ["--kinds"] => return all_kinds(&seeds),
        ["--gears"] => return with_gears(&seeds),
        _ => return usage(),
    }
    let outcome = campaign::run(&seeds);
    println!(
        "{:12} {:>7} {:>12} {:>12} {:>6} {:>6} {:>10} {:>9}",
        "method", "scenes", "worst", "median", "exact", "wrong", "undecided", "needless"
    );
    for row in &outcome.rows {
        println!(
            "{:12} {:7} {:12.3e} {:12.1} {:6} {:6} {:10} {:9}",
            row.name(),
            row.scenes,
            row.worst,
            row.median,
            row.exact,
            row.wrong.len(),
            row.undecided,
            row.needless
        );
    }
    for row in outcome.rows.iter().filter(|r| !r.wrong.is_empty()) {
        for (fault, seeds) in &row.wrong {
            println!("{}: {} wrong on seeds {seeds:?}", row.name(), fault.name());
        }
        println!("{}: worst seed {}", row.name(), row.worst_seed);
    }
    for (seed, why) in &outcome.refused {
        println!("seed {seed}: {why}");
    }
    ExitCode::from(u8::from(outcome.rows.iter().any(|r| !r.wrong.is_empty())))
}

fn usage() -> ExitCode {
    eprintln!("usage: campaign [--kinds | --gears] [NUMBER OF SCENES] [FIRST SEED]");
    ExitCode::from(2)
}

/// The march's error estimate and bound, by what happens to the trains.
fn with_gears(seeds: &[u64]) -> ExitCode {
    let tallies = gears::run(seeds);
    let line = |name: &str, t: &gears::GearTally| {
        let (ratio, seed) = t.worst;
        println!(
            "{name:24} {:>6} {:>7} {:>7} {:>9.4} {ratio:>12.3e} {seed:>7} {:>9.1e} {:>9.1e} {:>7} {:>12.3e} {:>6} {:>7} {:>6} {:>8}",
            t.trains,
            t.peaks,
            t.missed.len(),
            100.0 * t.coverage(),
            t.quantile(0.5),
            t.quantile(0.99),
            t.proven,
            t.worst_proven.0,
            t.lost,
            t.parted,
            t.other_order.len(),
            t.without_reference.len()
        );
    };
    println!(
        "{:24} {:>6} {:>7} {:>7} {:>9} {:>12} {:>7} {:>9} {:>9} {:>7} {:>12} {:>6} {:>7} {:>6} {:>8}",
        "kind",
        "trains",
        "peaks",
        "missed",
        "covered%",
        "error/est",
        "seed",
        "median",
        "99 %",
        "proven",
        "error/bound",
        "ended",
        "parted",
        "order",
        "no truth"
    );
    let mut all = gears::GearTally::default();
    for (kind, tally) in &tallies {
        line(kind.name(), tally);
        all.add(tally);
    }
    line("all", &all);
    for (seed, coupler, ratio) in all.missed.iter().take(40) {
        println!("seed {seed}: coupler {coupler} is off by {ratio:.2} estimates");
    }
    println!("other order of partings: {:?}; without a reference: {:?}", all.other_order, all.without_reference);
    let good = all.coverage() >= 0.999 && all.worst.0 <= 2.0 && all.worst_proven.0 <= 1.0 && all.other_order.is_empty();
    ExitCode::from(u8::from(!good))
}

/// All that analyses say, by kind of scenario and by quantity.
fn all_kinds(seeds: &[u64]) -> ExitCode {
    let (scenes, tallies) = kinds::run(seeds);
    let mut wrong = 0;
    let line = |name: &str, tally: &Tally| {
        let (share, seed) = tally.worst;
        println!(
            "{name:18} {:>7} {:>9} {:>6} {:>10} {share:>12.3e} {seed:>7}",
            tally.scenes,
            tally.compared,
            tally.wrong.len(),
            tally.undecided
        );
    };
    println!(
        "{:18} {:>7} {:>9} {:>6} {:>10} {:>12} {:>7}",
        "kind", "scenes", "compared", "wrong", "undecided", "error/bound", "seed"
    );
    for kind in Kind::ALL {
        let mut sum = Tally { scenes: scenes.get(&kind).copied().unwrap_or(0), ..Tally::default() };
        tallies.iter().filter(|(key, _)| key.0 == kind).for_each(|(_, tally)| sum.add(tally));
        line(kind.name(), &sum);
        wrong += sum.wrong.len();
    }
    for quantity in Quantity::ALL {
        let mut sum = Tally::default();
        tallies.iter().filter(|(key, _)| key.1 == quantity).for_each(|(_, tally)| sum.add(tally));
        line(quantity.name(), &sum);
    }
    for ((kind, _), tally) in &tallies {
        tally.wrong.iter().take(12).for_each(|(seed, what)| println!("seed {seed}, {}: {what}", kind.name()));
    }
    ExitCode::from(u8::from(wrong > 0))
}
