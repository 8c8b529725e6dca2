//! Reads a train file and analyzes it over and over: median time in seconds, largest utilisation, and the bound on its
//! error. Reading the file is not timed.
//!
//! ```text
//! cargo run --release --example time_analyze -- TRAIN.toml [RUNS [TOLERANCE]]
//! ```

use std::path::Path;
use std::time::Instant;

use trainsafe::findings::CaseFindings;
use trainsafe::{Options, analyze, consist};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("usage: time_analyze TRAIN.toml [RUNS [TOLERANCE]]")?;
    let runs: usize = arguments.next().map_or(Ok(7), |text| text.parse())?;
    let train = consist::read(Path::new(&path))?;
    let mut options = Options::default();
    options.tolerance = arguments.next().map_or(Ok(options.tolerance), |text| text.parse())?;
    let mut analysis = analyze(&train, &options)?;
    let mut seconds = Vec::with_capacity(runs);
    for _ in 0..runs.max(1) {
        let start = Instant::now();
        analysis = analyze(&train, &options)?;
        seconds.push(start.elapsed().as_secs_f64());
    }
    seconds.sort_by(f64::total_cmp);
    let cases = || analysis.scenarios.iter().flat_map(|s| &s.cases);
    let use_of = |case: &CaseFindings| case.worst.as_ref().map_or(0.0, |w| w.utilisation);
    let worst = cases().max_by(|a, b| use_of(a).total_cmp(&use_of(b))).ok_or("the train has no case to run")?;
    let bound_n = cases().map(|c| c.error_bound_n).fold(0.0, f64::max);
    let rating_n = train.couplers().iter().map(|c| c.rated_draft_n.max(c.rated_buff_n)).fold(0.0, f64::max);
    println!(
        "seconds {:.6}  utilisation {:.12}  broken {}  bound {:.1e}  method {}",
        seconds[seconds.len() / 2],
        use_of(worst),
        worst.broken_coupler.map_or("none".to_owned(), |b| b.to_string()),
        bound_n / rating_n,
        worst.method,
    );
    Ok(())
}
