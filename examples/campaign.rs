//! Every method against the reference on random trains: `cargo run --release --example campaign -- 2000`.

use std::process::ExitCode;

use trainsafe::accuracy::campaign;

fn main() -> ExitCode {
    let mut args = std::env::args().skip(1).map(|a| a.parse::<u64>());
    let (count, first) = match (args.next().unwrap_or(Ok(2000)), args.next().unwrap_or(Ok(0))) {
        (Ok(count), Ok(first)) => (count, first),
        _ => {
            eprintln!("usage: campaign [NUMBER OF SCENES] [FIRST SEED]");
            return ExitCode::from(2);
        }
    };
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
