//! Every method against the reference on random trains: `cargo run --release --example campaign -- 2000`; with `--kinds`, analyses
//! of trains with every kind of scenario.

use std::process::ExitCode;

use trainsafe::accuracy::campaign::{self, kinds, kinds::Quantity, kinds::Tally, trains::Kind};

fn main() -> ExitCode {
    let (named, numbers): (Vec<String>, Vec<String>) = std::env::args().skip(1).partition(|a| a == "--kinds");
    let mut args = numbers.iter().map(|a| a.parse::<u64>());
    let (count, first) = match (args.next().unwrap_or(Ok(2000)), args.next().unwrap_or(Ok(0))) {
        (Ok(count), Ok(first)) => (count, first),
        _ => {
            eprintln!("usage: campaign [--kinds] [NUMBER OF SCENES] [FIRST SEED]");
            return ExitCode::from(2);
        }
    };
    if !named.is_empty() {
        return all_kinds(&(first..first + count).collect::<Vec<u64>>());
    }
    let outcome = campaign::run(&(first..first + count).collect::<Vec<u64>>());
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
