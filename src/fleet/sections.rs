//! What the reports of a run say: the verdict, then sections, each a heading with texts, a figure and a table. Markdown and HTML are
//! written from them.

use super::doubts;
use super::parts::Run;
use super::probability;
use super::section::{LISTED, listed, more, section};
use super::summary::{CAUSES, Case, Factors, Places, Summary, TrainSummary};
use crate::report::block::{Block, Picture};
use crate::report::figures;
use crate::report::numbers::{digits, down, percent, without_zeros};
use crate::report::words::count;
use crate::train::LIMITS;

/// Rows of a table of couplers at most.
const COUPLERS: usize = 20;
/// What comes after the first passage.
const LATER: &str = "\"Only later\" means that a rating is exceeded only after the first passage, by reflected waves, which the losses \
                     of a real train would reduce.";
/// The file of the figure of safe factors.
pub const SAFE_FACTORS: &str = "figure-safe-factors.svg";

/// What stands before the trains: of a study the probabilities and what they depend on, then the safe factors.
pub fn before(run: &Run, summary: &Summary) -> Vec<Block> {
    let studied = run.variations.map(|_| [probability::shares(run, summary), probability::influences(run, summary)]);
    studied.into_iter().flatten().chain([safe_factors(summary)]).flatten().collect()
}

/// What stands after the trains.
pub fn after(summary: &Summary) -> Vec<Block> {
    [breaks(summary), overloaded(summary), doubtful(summary), errors(summary)].into_iter().flatten().collect()
}

/// What the run came to, as sentences of plain text; of drawn variations the probability first.
pub fn verdict(run: &Run, summary: &Summary) -> Vec<String> {
    let seen = summary.trains.len();
    let harmful = summary.unsafe_trains().len();
    let varied = run.variations.map_or(String::new(), |n| format!(" in {} each", count(n, "variation")));
    let mut text: Vec<String> = probability::sentence(run, summary).into_iter().collect();
    text.push(format!(
        "{harmful} of {}{varied} would overload a coupler in some case{}; {} of {} {}{}.",
        count(seen, "train"),
        passages(harmful, summary.unsafe_later()),
        summary.harmful,
        count(summary.cases, "case"),
        if summary.harmful == 1 || summary.cases == 1 { "does" } else { "do" },
        passages(summary.harmful, summary.harmful_later),
    ));
    if let Some(doubts) = doubts::sentence(summary) {
        // Part of the first sentence, so that no fleet is called safe whose loads were forgotten.
        text[0].pop();
        text[0] += &format!("; {doubts}");
    }
    if summary.harmful_later > 0 {
        text.push(LATER.to_owned());
    }
    for (limit, cases) in LIMITS.into_iter().zip(summary.passing) {
        if cases > 0 {
            text.push(format!("In {} some coupler passes its {limit} load.", count(cases, "case")));
        }
    }
    let [cases, most] = summary.cascades;
    if cases > 0 {
        let cases = count(cases, "case");
        text.push(format!("In {cases} more couplers break after the event, up to {most} in one case."));
    }
    match summary.undecided_trains() {
        0 => {}
        n => text.push(format!("For {n} more it is not decided: a rating lies within the error of a peak, or forces cannot be told up to the horizon.")),
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

/// The distributions of the safe factors, one for each of their causes, if any of them is bounded.
fn safe_factors(summary: &Summary) -> Vec<Block> {
    let units = if summary.safe.len() > summary.trains.len() { "variations" } else { "trains" };
    let of = |i: usize| summary.safe.iter().filter_map(|f| f[i]).collect::<Vec<f64>>();
    let found: Vec<_> = (0..CAUSES.len()).map(|i| (CAUSES[i].1, of(i))).collect();
    let found: Vec<_> = found.into_iter().filter(|(_, f)| f.iter().any(|x| x.is_finite())).collect();
    if found.is_empty() {
        return Vec::new();
    }
    let caption = format!(
        "Share of the {units} with a smaller safe factor than the value on the axis. Below 1 a coupler is overloaded without any increase."
    );
    let text = "The safe factor is the largest factor on the cause at which no coupler exceeds its rating.".to_owned();
    let svg = figures::safe_factors(&found, units, SAFE_FACTORS.trim_end_matches(".svg"));
    let figure =
        Picture { file: SAFE_FACTORS.to_owned(), alt: "Distribution of safe factors".to_owned(), caption, svg };
    section("Safe factors", vec![text], Some(figure), &[], vec![])
}

/// The causes of which some train has a safe factor.
pub fn causes(summary: &Summary) -> Vec<usize> {
    (0..CAUSES.len()).filter(|&i| summary.trains.iter().any(|t| t.safe[i].is_some())).collect()
}

/// A safe factor, rounded down; nothing where there is none, or where nothing bounds it.
pub fn factor(safe: &Factors, cause: usize) -> String {
    safe[cause].filter(|f| f.is_finite()).map_or_else(String::new, down)
}

/// The trains, the worst first, safe ones with what is left of the rating.
pub fn trains(summary: &Summary) -> Vec<Block> {
    let causes = causes(summary);
    let row = |t: &&TrainSummary| {
        let w = &t.worst[0];
        let mut row = vec![t.name.clone(), t.file.clone(), percent(w.utilisation), percent(1.0 - w.utilisation)];
        row.extend([w.coupler.clone(), case_words(w)]);
        row.extend(causes.iter().map(|&i| factor(&t.safe, i)));
        row.extend([format!("{} of {}", t.cases[1], t.cases[0]), t.cases[2].to_string()]);
        row
    };
    let trains = summary.worst_first();
    let mut text = vec!["The margin is what is left of the rating; it is negative where a coupler exceeds.".to_owned()];
    more(&mut text, trains.len(), LISTED, "trains");
    let factors: Vec<String> = causes.iter().map(|&i| format!("safe factor on the {}", CAUSES[i].1)).collect();
    let mut head = vec!["train", "file", "largest utilisation, %", "margin, %", "coupler", "case"];
    head.extend(factors.iter().map(String::as_str));
    head.extend(["cases with an exceedance", "only after the first passage"]);
    listed("Trains, worst first", text, &head, trains.iter().take(LISTED).map(row).collect())
}

/// "coupler 12 breaks, variation 7".
pub fn case_words(case: &Case) -> String {
    let event = match case.broken.as_str() {
        "" => case.scenario.clone(),
        broken => format!("coupler {broken} breaks"),
    };
    if case.variation.is_empty() { event } else { format!("{event}, variation {}", case.variation) }
}

fn breaks(summary: &Summary) -> Vec<Block> {
    let share = |[all, harmful]: [usize; 2]| match all {
        0 => String::new(),
        _ => without_zeros(&digits(100.0 * harmful as f64 / all as f64, 0.0, 3)),
    };
    let row = |place: String, c: [usize; 2]| vec![place, c[1].to_string(), c[0].to_string(), share(c)];
    let mut text = Vec::new();
    let rows: Vec<_> =
        places(summary, &summary.breaks, &mut text).into_iter().map(|(place, counts)| row(place, counts)).collect();
    let head = [place_head(summary), "breaks that overload another", "breaks examined", "share, %"];
    listed("Where a break overloads another coupler", text, &head, rows)
}

fn overloaded(summary: &Summary) -> Vec<Block> {
    let mut text = Vec::new();
    let rows: Vec<_> = places(summary, &summary.overloaded, &mut text)
        .into_iter()
        .map(|(place, [cases, _])| vec![place, cases.to_string()])
        .collect();
    let head = [place_head(summary), "cases in which it is the worst coupler"];
    listed("Where couplers are overloaded most", text, &head, rows)
}

fn place_head(summary: &Summary) -> &'static str {
    if summary.trains.len() > 1 { "place along the train" } else { "coupler" }
}

/// Counts by coupler of the one train, most harmful first; or by tenths of several trains, whose couplers cannot be
/// compared by number. None where nothing exceeds.
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

/// The doubts about each train: a row for each train and kind of doubt.
fn doubtful(summary: &Summary) -> Vec<Block> {
    let row = |train: &TrainSummary, code: &String, cases: usize| {
        vec![train.name.clone(), train.file.clone(), code.clone(), format!("{cases} of {}", train.cases[0])]
    };
    let doubts = |t: &TrainSummary| t.doubts.iter().map(|(code, cases)| row(t, code, *cases)).collect::<Vec<_>>();
    let mut rows: Vec<_> = summary.trains.iter().flat_map(doubts).collect();
    let mut text =
        vec!["What is probably not meant; trainsafe check and trainsafe analyze explain it for each train.".to_owned()];
    more(&mut text, rows.len(), LISTED, "doubts");
    rows.truncate(LISTED);
    listed("Doubts", text, &["train", "file", "doubt", "cases with it"], rows)
}

/// What the run was made from, and the study's inputs; `date` is that of the report.
pub fn made_from(run: &Run, date: &str) -> Vec<Block> {
    let of = &run.made_from;
    let method = of.method.as_ref().map_or("chosen by the program".to_owned(), |m| format!("{m}, as asked for"));
    let mut text = vec![format!(
        "Made by trainsafe {} on {date}; tolerance {} of the largest rating (with slack, gears or brakes at least 1e-6), method {method}.",
        run.trainsafe, of.tolerance
    )];
    let varied = run.variations.map(|n| match of.seed {
        Some(seed) => {
            let latin = if run.latin_hypercube { ", a Latin hypercube" } else { "" };
            format!("The study has {} of each train, with the seed {seed}{latin}.", count(n, "sample"))
        }
        None => format!("The study has every combination of its values: {} of each train.", count(n, "variation")),
    });
    text.extend(varied);
    if of.file_count > of.files.len() {
        text.push(format!(
            "The first {} of {} files that were read; the list of all, a line \"SHA-256  path\" of each as sha256sum writes it, has the \
             SHA-256 {}.",
            of.files.len(),
            of.file_count,
            of.list_sha256
        ));
    }
    let inputs = of.inputs.iter().map(|row| row.to_vec()).collect();
    let files = of.files.iter().map(|row| row.to_vec()).collect();
    let mut all = listed("Inputs of the study", vec![], &["key", "values or distribution", "drawn for each"], inputs);
    all.extend(section("What this report was made from", text, None, &["file", "SHA-256"], files));
    all
}

fn errors(summary: &Summary) -> Vec<Block> {
    let mut text = Vec::new();
    if summary.failed > summary.errors.len() {
        text.push(format!("The first {} of {}; errors.csv has all.", summary.errors.len(), summary.failed));
    }
    let rows: Vec<_> = summary.errors.iter().map(|e| e.to_vec()).collect();
    listed("Not computed", text, &["file", "what", "error"], rows)
}
