//! `fleet.md`: what a run came to.

use minijinja::Error;
use serde::Serialize;

use super::doubts;
use super::parts::Run;
use super::statistics::{clopper_pearson, rank_correlation};
use super::summary::{Case, Places, Summary, TrainSummary};
use crate::report::figures;
use crate::report::markdown::render;
use crate::report::numbers::{digits, down, percent, without_zeros};
use crate::report::words::count;

const TEMPLATE: &str = include_str!("fleet.md.jinja");
/// Rows of a table at most.
const LISTED: usize = 50;
/// Rows of a table of couplers at most.
const COUPLERS: usize = 20;
/// What comes after the first passage.
const LATER: &str = "Only later: the forces that exceed come from reflections after the first passage, which the losses of a real train \
                     would reduce.";

#[derive(Serialize)]
struct Report {
    title: String,
    verdict: Vec<String>,
    notes: Vec<String>,
    figure: Option<&'static str>,
    caption: String,
    tables: Vec<Table>,
}

#[derive(Serialize)]
struct Table {
    title: &'static str,
    text: Vec<String>,
    head: Vec<&'static str>,
    rows: Vec<Vec<String>>,
}

/// The distribution of safe load factors, if there are any.
pub fn figure(summary: &Summary, name: &str) -> Option<String> {
    let some = summary.safe.iter().any(|f| f.is_finite());
    some.then(|| figures::safe_load(&summary.safe, units(summary), name))
}

/// What the figure shows.
pub fn caption(summary: &Summary) -> String {
    let what = units(summary);
    format!("Share of {what} whose smallest safe load factor is below x. Left of 1 a coupler is overloaded.")
}

/// The report; `figure` is the file that the figure is in.
///
/// # Errors
/// None are known: the template and the facts are this crate's own.
pub fn markdown(run: &Run, summary: &Summary, figure: Option<&'static str>) -> Result<String, Error> {
    let probabilities = run.variations.map(|_| probabilities(run, summary));
    let inputs = run.variations.and_then(|_| correlations(run, summary));
    let doubts = doubtful(summary);
    let tables = [probabilities, inputs, worst(summary), breaks(summary), overloaded(summary), doubts, errors(summary)];
    let report = Report {
        title: format!("Fleet of {}", count(run.trains, "train")),
        verdict: verdict(run, summary),
        notes: run.notes.clone(),
        figure,
        caption: caption(summary),
        tables: tables.into_iter().flatten().collect(),
    };
    Ok(render(TEMPLATE, report)?.trim_end().to_owned() + "\n")
}

/// What the run came to, as sentences of plain text.
pub fn verdict(run: &Run, summary: &Summary) -> Vec<String> {
    let seen = summary.trains.len();
    let harmful = summary.unsafe_trains().len();
    let varied = run.variations.map_or(String::new(), |n| format!(" in {} each", count(n, "variation")));
    let mut text = vec![format!(
        "{harmful} of {}{varied} would overload a coupler in some case{}; {} of {} {}{}.",
        count(seen, "train"),
        passages(harmful, summary.unsafe_later()),
        summary.harmful,
        count(summary.cases, "case"),
        if summary.harmful == 1 { "does" } else { "do" },
        passages(summary.harmful, summary.harmful_later),
    )];
    if let Some(doubts) = doubts::sentence(summary) {
        // Part of the first sentence, so that no fleet is called safe whose loads were forgotten.
        text[0].pop();
        text[0] += &format!("; {doubts}");
    }
    if let ([train], true) = (summary.trains.as_slice(), run.drawn) {
        let shares = Shares::of(run, summary, train);
        let draws = if shares.computed == shares.draws {
            count(shares.draws, "draw")
        } else {
            format!("{} draws, {} of which could be computed", shares.draws, shares.computed)
        };
        text.push(format!("Probability of an exceedance: {} ({} of {draws}).", shares.estimate(), shares.harmful));
    }
    if summary.harmful_later > 0 {
        text.push(LATER.to_owned());
    }
    match summary.undecided_trains() {
        0 => {}
        n => text.push(format!("For {n} more it is not decided: a rating lies within the error bound of a peak.")),
    }
    match summary.failed {
        0 => {}
        1 => text.push("1 train or case could not be computed: see errors.csv.".to_owned()),
        n => text.push(format!("{n} trains or cases could not be computed: see errors.csv.")),
    }
    text
}

/// How many of some exceed in the first passage, and how many only later; empty for none.
fn passages(all: usize, later: usize) -> String {
    if all == 0 { String::new() } else { format!(" ({} in the first passage, {later} only later)", all - later) }
}

fn units(summary: &Summary) -> &'static str {
    if summary.safe.len() > summary.trains.len() { "variations" } else { "trains" }
}

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

    /// The share, or between what it lies.
    fn estimate(&self) -> String {
        let share = |k: usize| digits(k as f64 / self.draws as f64, 0.0, 4);
        match self.open {
            0 => share(self.harmful),
            open => format!("{} to {}", share(self.harmful), share(self.harmful + open)),
        }
    }
}

/// The share of each train's variations with an exceedance, for draws with its confidence interval.
fn probabilities(run: &Run, summary: &Summary) -> Table {
    let row = |train: &TrainSummary| {
        let shares = Shares::of(run, summary, train);
        let Shares { draws: n, computed, harmful: k, open } = shares;
        let rests_on = if computed == n { n.to_string() } else { format!("{computed} of {n}") };
        let mut row = vec![train.name.clone(), rests_on, k.to_string(), shares.estimate()];
        if run.drawn {
            let (low, high) = (clopper_pearson(k, n, 0.05).0, clopper_pearson(k + open, n, 0.05).1);
            row.push(format!("{} to {}", digits(low, 0.0, 4), digits(high, 0.0, 4)));
        }
        row
    };
    let mut head = vec!["train", "variations", "with an exceedance", "share"];
    let mut text = Vec::new();
    if run.drawn {
        head[3] = "probability";
        head.push("95 % confidence");
        text.push("At least one coupler exceeds its rating in at least one case of the train. The interval is Clopper and Pearson's.".to_owned());
        if run.latin_hypercube {
            text.push(
                "The interval takes samples as independent; those of a Latin hypercube usually scatter less."
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
    let rows = trains.into_iter().take(LISTED).map(row).collect();
    Table { title: if run.drawn { "Probability of an exceedance" } else { "Variations" }, text, head, rows }
}

/// How each input goes together with the largest utilisation, strongest first.
fn correlations(run: &Run, summary: &Summary) -> Option<Table> {
    let (utilisation, inputs) = summary.columns.split_last()?;
    let mut found: Vec<(f64, &String)> = run
        .inputs
        .iter()
        .zip(inputs)
        .filter(|(_, column)| column.iter().all(|x| x.is_finite()))
        .filter_map(|(name, column)| Some((rank_correlation(column, utilisation)?, name)))
        .collect();
    found.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
    let text = "Spearman's rank correlation of each input with the largest utilisation of a variation in any of its cases: \
                near 1 or -1 it rules, near 0 it does not matter, or not in one direction only. Where a train has several \
                scenarios, one that rules hides what matters in the others."
        .to_owned();
    let rows: Vec<_> = found.into_iter().map(|(r, name)| vec![name.clone(), format!("{r:.3}")]).collect();
    let head = vec!["input", "rank correlation"];
    (!rows.is_empty()).then_some(Table { title: "Which inputs matter most", text: vec![text], head, rows })
}

fn worst(summary: &Summary) -> Option<Table> {
    let trains = summary.unsafe_trains();
    let row = |t: &&TrainSummary| {
        let w = &t.worst[0];
        let case = case_words(w);
        let safe = if t.safe.is_finite() { down(t.safe) } else { String::new() };
        let harmful = format!("{} of {}", t.cases[1], t.cases[0]);
        let later = t.cases[2].to_string();
        vec![t.name.clone(), t.file.clone(), percent(w.utilisation), w.coupler.clone(), case, safe, harmful, later]
    };
    let mut text = Vec::new();
    more(&mut text, trains.len(), LISTED, "unsafe trains");
    let head = vec![
        "train",
        "file",
        "utilisation, %",
        "coupler",
        "case",
        "smallest safe load factor of all cases",
        "cases with an exceedance",
        "only after the first passage",
    ];
    let rows: Vec<_> = trains.iter().take(LISTED).map(row).collect();
    (!rows.is_empty()).then_some(Table { title: "Unsafe trains, worst first", text, head, rows })
}

/// "coupler 12 breaks, variation 7".
pub fn case_words(case: &Case) -> String {
    let event = match case.broken.as_str() {
        "" => case.scenario.clone(),
        broken => format!("coupler {broken} breaks"),
    };
    if case.variation.is_empty() { event } else { format!("{event}, variation {}", case.variation) }
}

fn breaks(summary: &Summary) -> Option<Table> {
    let share = |[all, harmful]: [usize; 2]| match all {
        0 => String::new(),
        _ => without_zeros(&digits(100.0 * harmful as f64 / all as f64, 0.0, 3)),
    };
    let row = |place: String, c: [usize; 2]| vec![place, c[1].to_string(), c[0].to_string(), share(c)];
    let mut text = Vec::new();
    let rows: Vec<_> =
        places(summary, &summary.breaks, &mut text).into_iter().map(|(place, counts)| row(place, counts)).collect();
    let head = vec![place_head(summary), "breaks that overload another", "breaks examined", "share, %"];
    (!rows.is_empty()).then_some(Table { title: "Where a break overloads another coupler", text, head, rows })
}

fn overloaded(summary: &Summary) -> Option<Table> {
    let mut text = Vec::new();
    let rows: Vec<_> = places(summary, &summary.overloaded, &mut text)
        .into_iter()
        .map(|(place, [cases, _])| vec![place, cases.to_string()])
        .collect();
    let head = vec![place_head(summary), "cases in which the worst coupler is there"];
    (!rows.is_empty()).then_some(Table { title: "Where couplers are overloaded most", text, head, rows })
}

fn place_head(summary: &Summary) -> &'static str {
    if summary.trains.len() > 1 { "place along the train" } else { "coupler" }
}

/// Counts by coupler of the one train, most harmful first; or by tenths of different trains, whose numbers of couplers tell
/// nothing side by side. None where nothing exceeds.
fn places(summary: &Summary, counts: &Places, text: &mut Vec<String>) -> Vec<(String, [usize; 2])> {
    if summary.trains.len() > 1 {
        text.push("Of each train's couplers, from the head.".to_owned());
        let some = counts.tenths.iter().any(|[_, harmful]| *harmful > 0);
        let tenth = |i: usize| format!("{} to {} %", 10 * i, 10 * (i + 1));
        return counts.tenths.iter().enumerate().filter(|_| some).map(|(i, c)| (tenth(i), *c)).collect();
    }
    let mut found: Vec<_> = counts.couplers.iter().filter(|(_, [_, harmful])| *harmful > 0).collect();
    found.sort_by_key(|(_, [_, harmful])| std::cmp::Reverse(*harmful));
    more(text, found.len(), COUPLERS, "couplers");
    found.into_iter().take(COUPLERS).map(|(coupler, c)| (coupler.to_string(), *c)).collect()
}

/// The doubts about each train.
fn doubtful(summary: &Summary) -> Option<Table> {
    let rows = doubt_rows(summary);
    let mut text =
        vec!["What is probably not meant; trainsafe check and trainsafe analyze explain it for each train.".to_owned()];
    more(&mut text, rows.len(), LISTED, "doubts");
    let head = vec!["train", "file", "doubt", "cases with it"];
    let some = !rows.is_empty();
    let rows = rows.into_iter().take(LISTED).collect();
    some.then_some(Table { title: "Doubts", text, head, rows })
}

/// A row for each train and kind of doubt: name, file, kind, cases with it.
pub fn doubt_rows(summary: &Summary) -> Vec<Vec<String>> {
    let row = |train: &TrainSummary, code: &String, cases: usize| {
        vec![train.name.clone(), train.file.clone(), code.clone(), format!("{cases} of {}", train.cases[0])]
    };
    summary.trains.iter().flat_map(|t| t.doubts.iter().map(move |(code, cases)| row(t, code, *cases))).collect()
}

fn errors(summary: &Summary) -> Option<Table> {
    let mut text = Vec::new();
    if summary.failed > summary.errors.len() {
        text.push(format!("The first {} of {}; errors.csv has all.", summary.errors.len(), summary.failed));
    }
    let rows: Vec<_> = summary.errors.iter().map(|e| e.to_vec()).collect();
    let head = vec!["file", "what", "error"];
    (!rows.is_empty()).then_some(Table { title: "Not computed", text, head, rows })
}

/// Says that a table is cut short.
fn more(text: &mut Vec<String>, all: usize, shown: usize, what: &str) {
    if all > shown {
        text.push(format!("The first {shown} of {all} {what}; fleet.csv has all."));
    }
}
