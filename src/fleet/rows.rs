//! Rows of `fleet.csv` and `errors.csv`.

use std::borrow::Cow;
use std::path::Path;

use super::inputs::file_cell;
use crate::findings::CaseFindings;
use crate::report::cells::{number, optional, text};
use crate::train::{Doubt, LIMITS, Scenario, Train};

/// Columns before those of a study's inputs.
pub const FRONT: [&str; 4] = ["file", "train", "vehicles", "variation"];

/// Columns after those of a study's inputs, named as in `couplers.csv` and `result.json`.
pub const BACK: [&str; 41] = [
    "scenario",
    "kind",
    "broken_coupler",
    "worst_coupler",
    "between_front",
    "between_rear",
    "rated_draft_n",
    "rated_buff_n",
    "initial_force_n",
    "peak_force_n",
    "peak_time_s",
    "utilisation",
    "first_coupler",
    "first_exceeds_s",
    "exceeding",
    "undecided",
    "first_passage_s",
    "exceeding_first_passage",
    "first_passage_worst_coupler",
    "first_passage_utilisation",
    "first_passage_peak_force_n",
    "first_passage_peak_draft_n",
    "first_passage_peak_draft_time_s",
    "first_passage_peak_buff_n",
    "first_passage_peak_buff_time_s",
    "first_passage_exceeds",
    "passing_fatigue",
    "passing_proof",
    "passing_ultimate",
    "undecided_limits",
    "further_breaks",
    "pieces",
    "cascade_undecided_from_s",
    "safe_load_factor",
    "error_bound_n",
    "error_estimate_n",
    "predictable_until_s",
    "horizon_s",
    "method",
    "rod_exceeding",
    "doubts",
];

/// Columns of `errors.csv`.
pub const ERRORS: [&str; 5] = ["file", "variation", "scenario", "broken_coupler", "error"];

/// Columns of text, here and in `errors.csv`.
pub const TEXTS: [&str; 10] = [
    "file",
    "train",
    "scenario",
    "kind",
    "between_front",
    "between_rear",
    "method",
    "first_passage_exceeds",
    "doubts",
    "error",
];

/// Columns of whole numbers.
#[cfg(feature = "parquet")]
pub const WHOLE: [&str; 16] = [
    "vehicles",
    "variation",
    "broken_coupler",
    "worst_coupler",
    "first_coupler",
    "exceeding",
    "undecided",
    "exceeding_first_passage",
    "first_passage_worst_coupler",
    "passing_fatigue",
    "passing_proof",
    "passing_ultimate",
    "undecided_limits",
    "further_breaks",
    "pieces",
    "rod_exceeding",
];

/// The rows of a chunk of cases, without headings.
#[derive(Default)]
pub struct Chunk {
    rows: Lines,
    errors: Lines,
    /// Cases and trains that could not be computed.
    pub failed: usize,
}

/// CSV in memory; rows may differ in length.
pub struct Lines(csv::Writer<Vec<u8>>);

/// Which variation of which train rows belong to.
pub struct Place {
    /// The train file, as it was given.
    file: String,
    /// Counted from 1; empty without a study.
    variation: String,
    /// The study's inputs.
    inputs: Vec<String>,
    /// What is doubtful about the train and its scenarios.
    pub doubts: Vec<Doubt>,
}

impl Place {
    /// Of a train file; its variation, counted from 1, where there is a study, and the study's inputs. No doubts are known yet.
    pub fn new(file: &Path, variation: Option<usize>, inputs: &[String]) -> Place {
        // A number is no formula.
        let input = |cell: &String| if cell.parse::<f64>().is_ok() { cell.clone() } else { text(cell).into_owned() };
        let inputs = inputs.iter().map(input).collect();
        Place { file: file_cell(file), variation: whole(variation), inputs, doubts: vec![] }
    }

    /// The cells that begin every row of its train.
    pub fn cells<'a>(&'a self, train: &'a Train) -> impl Iterator<Item = Cow<'a, str>> {
        let vehicles = train.vehicles().len().to_string();
        let front = [self.file.as_str().into(), text(train.name()), vehicles.into(), self.variation.as_str().into()];
        front.into_iter().chain(self.inputs.iter().map(|cell| cell.as_str().into()))
    }

    /// The codes of the doubts about the train and one of its scenarios, and of those that a case has, each once.
    fn codes(&self, scenario: &Scenario, found: &[Doubt]) -> String {
        let about = |d: &&Doubt| d.scenario.as_ref().is_none_or(|name| *name == scenario.name);
        let mut codes: Vec<&str> = self.doubts.iter().filter(about).chain(found).map(|d| d.code).collect();
        codes.sort_unstable();
        codes.dedup();
        codes.join(" ")
    }
}

impl Default for Lines {
    fn default() -> Lines {
        Lines(csv::WriterBuilder::new().flexible(true).from_writer(Vec::new()))
    }
}

impl Lines {
    /// Appends a line.
    pub fn add<'a>(&mut self, cells: impl Iterator<Item = Cow<'a, str>>) {
        // Nothing can fail in memory: the writer has no limit.
        for cell in cells {
            let _ = self.0.write_field(cell.as_bytes());
        }
        let _ = self.0.write_record(None::<&[u8]>);
    }

    /// All lines.
    pub fn into_bytes(self) -> Vec<u8> {
        self.0.into_inner().unwrap_or_default()
    }
}

impl Chunk {
    /// The rows of cases and those of errors.
    pub fn into_bytes(self) -> [Vec<u8>; 2] {
        [self.rows, self.errors].map(Lines::into_bytes)
    }

    /// A case that was computed, and the doubts that it has.
    pub fn add(&mut self, place: &Place, train: &Train, scenario: &Scenario, case: &CaseFindings, found: &[Doubt]) {
        let codes = place.codes(scenario, found);
        self.rows.add(place.cells(train).chain(back(scenario, case, codes).into_iter().map(Cow::from)));
    }

    /// A train or a case that could not be computed.
    pub fn fail(&mut self, place: &Place, case: Option<(&Scenario, Option<usize>)>, error: &str) {
        self.failed += 1;
        let scenario = case.map_or("".into(), |(scenario, _)| text(&scenario.name));
        let broken = whole(case.and_then(|(_, broken)| broken).map(|b| b + 1));
        let place = [&place.file, &place.variation].map(|cell| cell.as_str().into());
        self.errors.add(place.into_iter().chain([scenario, broken.into(), text(error)]));
    }
}

/// Headings of `fleet.csv`, with those of a study's inputs.
pub fn headings(inputs: &[String]) -> Vec<String> {
    FRONT.map(str::to_owned).into_iter().chain(inputs.iter().cloned()).chain(BACK.map(str::to_owned)).collect()
}

/// Every column but a study's inputs, as one text: a run with others cannot be continued.
pub fn columns() -> String {
    FRONT.iter().chain(&BACK).chain(&ERRORS).copied().collect::<Vec<_>>().join(" ")
}

fn back(scenario: &Scenario, case: &CaseFindings, doubts: String) -> [String; BACK.len()] {
    let (worst, passage) = (case.worst.as_ref(), case.worst_first_passage.as_ref());
    let value = |of: fn(&crate::findings::CouplerFindings) -> f64| optional(worst.map(of));
    // Not always the worst one: a weaker wave may have met another coupler before.
    let times = case.couplers.iter().filter_map(|c| Some((c.first_exceeds_s?, c.coupler)));
    let first = times.min_by(|a, b| a.0.total_cmp(&b.0));
    let limits = || case.couplers.iter().filter_map(|c| c.limits.as_ref());
    let has = |limit: &str| limits().any(|l| l.by_sense.iter().any(|of| of.limit == limit));
    let passing = |limit: &str| has(limit).then(|| limits().filter(|l| l.passed.contains(&limit)).count());
    let [fatigue, proof, ultimate] = LIMITS.map(|limit| whole(passing(limit)));
    let undecided_limits = limits().next().map(|_| limits().filter(|l| !l.undecided.is_empty()).count());
    let cascade = case.cascade.as_ref();
    let between = |end: usize| worst.map_or(String::new(), |w| text(&w.between[end]).into_owned());
    [
        text(&scenario.name).into_owned(),
        scenario.event.kind().to_owned(),
        whole(case.broken_coupler),
        whole(worst.map(|w| w.coupler)),
        between(0),
        between(1),
        value(|w| w.rated_draft_n),
        value(|w| w.rated_buff_n),
        value(|w| w.initial_force_n),
        value(|w| w.peak_force_n),
        value(|w| w.peak_time_s),
        value(|w| w.utilisation),
        whole(first.map(|(_, coupler)| coupler)),
        optional(first.map(|(time_s, _)| time_s)),
        case.exceeding.to_string(),
        case.undecided.to_string(),
        number(case.first_passage_s),
        case.exceeding_first_passage.to_string(),
        whole(passage.map(|w| w.coupler)),
        optional(passage.map(|w| w.utilisation)),
        optional(passage.map(|w| w.peak_force_n)),
        optional(passage.and_then(|w| w.peak_draft_n)),
        optional(passage.and_then(|w| w.peak_draft_time_s)),
        optional(passage.and_then(|w| w.peak_buff_n)),
        optional(passage.and_then(|w| w.peak_buff_time_s)),
        passage.and_then(|w| w.exceeds).map(|e| e.to_string()).unwrap_or_default(),
        fatigue,
        proof,
        ultimate,
        whole(undecided_limits),
        whole(cascade.map(|c| c.breaks.len())),
        whole(cascade.map(|c| c.pieces.len())),
        optional(cascade.and_then(|c| c.undecided_from_s)),
        optional(case.safe_load_factor),
        number(case.error_bound_n),
        optional(case.error_estimate_n),
        optional(case.predictable_until_s),
        number(case.horizon_s),
        case.method.to_owned(),
        whole(case.rod.as_ref().map(|rod| rod.exceeding)),
        doubts,
    ]
}

fn whole(number: Option<usize>) -> String {
    number.map(|n| n.to_string()).unwrap_or_default()
}

/// Lines of CSV as lines of JSON; an empty cell is `null`, a number is a number.
pub fn json<S: AsRef<str>>(headings: &[S], lines: &[u8]) -> String {
    let records = csv::ReaderBuilder::new().has_headers(false).from_reader(lines).into_records();
    let mut text = String::new();
    for record in records.flatten() {
        let pairs = headings.iter().zip(record.iter());
        let object: serde_json::Map<_, _> =
            pairs.map(|(heading, cell)| (heading.as_ref().to_owned(), json_cell(heading.as_ref(), cell))).collect();
        text += &serde_json::Value::Object(object).to_string();
        text.push('\n');
    }
    text
}

fn json_cell(heading: &str, cell: &str) -> serde_json::Value {
    if TEXTS.contains(&heading) && !cell.is_empty() {
        return cell.into();
    }
    let whole = cell.parse::<u64>().map(serde_json::Value::from);
    let number = || cell.parse::<f64>().ok().filter(|x| x.is_finite()).map(serde_json::Value::from);
    match cell {
        "" => serde_json::Value::Null,
        _ => whole.ok().or_else(number).unwrap_or_else(|| cell.into()),
    }
}
