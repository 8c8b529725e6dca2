//! What a study says: how often a coupler exceeds, how well that is known, and which inputs it depends on.

use super::parts::Run;
use super::section::{LISTED, more, section};
use super::statistics::{clopper_pearson, rank_correlation};
use super::summary::{Summary, TrainSummary};
use crate::report::block::{Block, Picture};
use crate::report::figures;
use crate::report::numbers::percent;
use crate::report::words::count;

/// The file of the figure of influences.
pub const INFLUENCES: &str = "figure-influences.svg";
/// Inputs that the figure and the table of influences show.
const SHOWN: usize = 20;
/// Probability that the interval misses.
const MISS: f64 = 0.05;

/// How many of a train's variations exceed.
struct Shares {
    draws: usize,
    computed: usize,
    harmful: usize,
    /// Not decided, or not computed.
    open: usize,
}

impl Shares {
    fn of(run: &Run, summary: &Summary, train: &TrainSummary) -> Shares {
        let draws = run.variations.unwrap_or(train.variations);
        let failed = summary.failed_variations.get(&train.file).copied().unwrap_or(0);
        let harmful = train.unsafe_variations;
        let open = (train.undecided_variations + failed).min(draws - harmful);
        Shares { draws, computed: draws - failed.min(draws), harmful, open }
    }

    /// The share, or its range.
    fn estimate(&self) -> String {
        let share = |k: usize| percent(k as f64 / self.draws as f64);
        match self.open {
            0 => format!("{} %", share(self.harmful)),
            open => format!("{} to {} %", share(self.harmful), share(self.harmful + open)),
        }
    }

    /// The interval of 95 % confidence.
    fn interval(&self) -> String {
        let low = clopper_pearson(self.harmful, self.draws, MISS).0;
        let high = clopper_pearson(self.harmful + self.open, self.draws, MISS).1;
        format!("{} to {} %", percent(low), percent(high))
    }
}

/// The probability of an exceedance with its interval and the draws that it rests on: of the one train, or of those with the
/// smallest and the largest. `None` of variations that are not drawn.
pub fn sentence(run: &Run, summary: &Summary) -> Option<String> {
    let found: Vec<Shares> = summary.trains.iter().filter(|_| run.drawn).map(|t| Shares::of(run, summary, t)).collect();
    let share = |s: &Shares| s.harmful as f64 / s.draws as f64;
    let told = |s: &Shares| {
        let computed = match s.computed == s.draws {
            true => count(s.draws, "draw"),
            false => format!("{} draws, {} of which could be computed", s.draws, s.computed),
        };
        format!("{} ({} of {computed}; 95 % confidence: {})", s.estimate(), s.harmful, s.interval())
    };
    let largest = found.iter().max_by(|a, b| share(a).total_cmp(&share(b)))?;
    let smallest = found.iter().min_by(|a, b| share(a).total_cmp(&share(b)))?;
    Some(match found.len() {
        1 => format!("Probability of an exceedance: {}.", told(largest)),
        _ => format!("Probability of an exceedance: from {} to {}, by train.", told(smallest), told(largest)),
    })
}

/// The share of each train's variations with an exceedance, for draws with its confidence interval.
pub fn shares(run: &Run, summary: &Summary) -> Vec<Block> {
    let row = |train: &TrainSummary| {
        let shares = Shares::of(run, summary, train);
        let (n, computed) = (shares.draws, shares.computed);
        let rests_on = if computed == n { n.to_string() } else { format!("{computed} of {n}") };
        let interval = run.drawn.then(|| shares.interval());
        let front = vec![train.name.clone(), shares.estimate()];
        front.into_iter().chain(interval).chain([shares.harmful.to_string(), rests_on]).collect()
    };
    let mut text = Vec::new();
    if run.drawn {
        text.push("At least one coupler exceeds its rating in at least one case of the train. The 95 % interval is that of Clopper and Pearson.".to_owned());
        if run.latin_hypercube {
            text.push(
                "The interval assumes independent draws; with a Latin hypercube the true uncertainty is usually smaller."
                    .to_owned(),
            );
        }
        if !summary.failed_variations.is_empty() {
            let failed = "Draws that could not be computed are listed in errors.csv. The probability lies between what it is if \
                          none of them exceeds and if all do.";
            text.push(failed.to_owned());
        }
    }
    let mut trains: Vec<&TrainSummary> = summary.trains.iter().collect();
    let share = |t: &TrainSummary| t.unsafe_variations as f64 / t.variations as f64;
    trains.sort_by(|a, b| share(b).total_cmp(&share(a)));
    more(&mut text, trains.len(), LISTED, "trains");
    let (title, head): (_, &[&str]) = match run.drawn {
        true => (
            "Probability of an exceedance",
            &["train", "probability", "95 % confidence", "draws with an exceedance", "draws"],
        ),
        false => ("Variations", &["train", "share", "variations with an exceedance", "variations"]),
    };
    section(title, text, None, head, trains.into_iter().take(LISTED).map(row).collect())
}

/// Correlation of each input with the largest utilisation, strongest first.
pub fn influences(run: &Run, summary: &Summary) -> Vec<Block> {
    let Some((utilisation, inputs)) = summary.columns.split_last() else { return Vec::new() };
    let mut found: Vec<(String, f64)> = run
        .inputs
        .iter()
        .zip(inputs)
        .filter(|(_, column)| column.iter().all(|x| x.is_finite()))
        .filter_map(|(name, column)| Some((name.clone(), rank_correlation(column, utilisation)?)))
        .collect();
    found.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    let mut text = vec![
        "Spearman's rank correlation of each input with the largest utilisation of a variation in any of its cases. Near 1 or \
         \u{2212}1 the input dominates; near 0 it has little influence, or one that changes direction. Where a train has \
         several scenarios, only the one with the largest utilisation counts; an input that matters in another can be missed."
            .to_owned(),
    ];
    if found.len() > SHOWN {
        text.push(format!("The {SHOWN} strongest of {} inputs.", found.len()));
        found.truncate(SHOWN);
    }
    if found.is_empty() {
        return Vec::new();
    }
    let rows = found.iter().map(|(name, r)| vec![name.clone(), format!("{r:.3}").replace('-', "\u{2212}")]).collect();
    let caption = "Rank correlation with the largest utilisation: to the right, the larger the input, the larger the utilisation.";
    let svg = figures::influences(&found, INFLUENCES.trim_end_matches(".svg"));
    let alt = "Influence of each input".to_owned();
    let figure = Picture { file: INFLUENCES.to_owned(), alt, caption: caption.to_owned(), svg };
    section("Which inputs matter most", text, Some(figure), &["input", "rank correlation"], rows)
}
