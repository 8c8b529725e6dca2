//! The doubts about the trains of a fleet: what a run says of them, beside the column `doubts` of its rows.

use std::collections::BTreeMap;

use super::inputs::DoubtTexts;
use super::summary::Summary;
use crate::train::count;

/// Lines on standard error, at most.
const LINES: usize = 20;

/// How many trains have each doubt, those of most trains first: `no-load: 12, short-horizon: 1`; empty for none.
pub fn totals<'a>(codes: impl Iterator<Item = &'a String>) -> String {
    let mut trains: BTreeMap<&String, usize> = BTreeMap::new();
    codes.for_each(|code| *trains.entry(code).or_default() += 1);
    let mut trains: Vec<_> = trains.into_iter().collect();
    trains.sort_by_key(|(_, trains)| std::cmp::Reverse(*trains));
    trains.into_iter().map(|(code, trains)| format!("{code}: {trains}")).collect::<Vec<_>>().join(", ")
}

/// The sentence of the verdict that says how many trains have doubts; `None` if no train has.
pub fn sentence(summary: &Summary) -> Option<String> {
    let trains = summary.trains.iter().filter(|train| !train.doubts.is_empty()).count();
    let have = if trains == 1 { "has" } else { "have" };
    let totals = totals(summary.trains.iter().flat_map(|train| train.doubts.keys()));
    (trains > 0).then(|| format!("{} {have} doubts ({totals}).", count(trains, "train")))
}

/// A line for each train and kind of doubt, and beyond [`LINES`] the totals. A run that only joins parts has no texts
/// of doubts, but codes.
pub fn lines(summary: &Summary, words: &DoubtTexts) -> Vec<String> {
    let kinds = summary.trains.iter().flat_map(|train| train.doubts.iter().map(move |doubt| (train, doubt)));
    let line = |(train, (code, cases)): (&super::summary::TrainSummary, (&String, &usize))| {
        let what = words.get(&(train.file.clone(), code.clone()));
        let what = what.map_or_else(
            || format!("{code}, which `trainsafe analyze` explains"),
            |(_, doubt)| format!("{doubt} [{code}]"),
        );
        format!("{}: {what} ({cases} of {})", train.file, count(train.cases[0], "case"))
    };
    let mut lines: Vec<String> = kinds.clone().take(LINES).map(line).collect();
    let rest: Vec<&String> = kinds.skip(LINES).map(|(_, (code, _))| code).collect();
    if !rest.is_empty() {
        let (more, totals) = (count(rest.len(), "more doubt"), totals(rest.into_iter()));
        lines.push(format!("{more} ({totals}): the column doubts of fleet.csv has them"));
    }
    lines
}

/// The same for one worker's part of a run.
pub fn lines_of_share(words: &DoubtTexts) -> Vec<String> {
    let line = |((file, code), (_, doubt)): (&(String, String), &(usize, crate::train::Doubt))| {
        format!("{file}: {doubt} [{code}]")
    };
    let mut lines: Vec<String> = words.iter().take(LINES).map(line).collect();
    if words.len() > LINES {
        let totals = totals(words.keys().skip(LINES).map(|(_, code)| code));
        lines.push(format!("{} ({totals})", count(words.len() - LINES, "more doubt")));
    }
    lines
}
