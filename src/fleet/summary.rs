//! What the rows of a run come to, gathered as they pass by.

use std::collections::{BTreeMap, BTreeSet};

use super::rows::{BACK, FRONT};

/// Examples of errors that a report shows.
const SHOWN: usize = 20;

/// Worst cases of each train that are kept.
pub const KEPT: usize = 5;

/// Sums over all rows.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    /// One entry per train file with a result, in order.
    pub trains: Vec<TrainSummary>,
    /// Cases that were computed.
    pub cases: usize,
    /// Cases in which some coupler exceeds.
    pub harmful: usize,
    /// Where couplers break: cases, and those in which another coupler exceeds.
    pub breaks: Places,
    /// Where the worst coupler is: cases in which some coupler exceeds, twice.
    pub overloaded: Places,
    /// Smallest safe load factor of each variation of each train; infinite where nothing bounds it.
    pub safe: Vec<f64>,
    /// Each variation's inputs, then its largest utilisation, column by column.
    pub columns: Vec<Vec<f64>>,
    /// Rows of `errors.csv`.
    pub failed: usize,
    /// The first of them: file, what was to be run, error.
    pub errors: Vec<[String; 3]>,
    /// How many trains each kind of doubt is about, and the file of the first, by its code.
    pub doubts: BTreeMap<String, (usize, String)>,
    /// Trains with a doubt.
    pub doubtful: usize,
    inputs: usize,
    unit: Option<Unit>,
}

/// Counts of cases by place along the train: all, and those in which some coupler exceeds.
#[derive(Clone, Debug, Default)]
pub struct Places {
    /// By coupler, which means something where all the cases are of one train.
    pub couplers: BTreeMap<usize, [usize; 2]>,
    /// By tenth of the train's couplers, from the head.
    pub tenths: [[usize; 2]; 10],
}

impl Places {
    /// Counts a case at a coupler of so many, from 1.
    fn add(&mut self, coupler: usize, of: usize, exceeds: bool) {
        let tenth = (10 * (2 * coupler).saturating_sub(1) / (2 * of).max(1)).min(9);
        for counts in [self.couplers.entry(coupler).or_default(), &mut self.tenths[tenth]] {
            *counts = [counts[0] + 1, counts[1] + usize::from(exceeds)];
        }
    }
}

/// What is known of one train.
#[derive(Clone, Debug)]
pub struct TrainSummary {
    /// Its file.
    pub file: String,
    /// Its name.
    pub name: String,
    /// Variations that were computed.
    pub variations: usize,
    /// Variations with an exceedance in some case.
    pub unsafe_variations: usize,
    /// Variations without one, but with a case that is not decided.
    pub undecided_variations: usize,
    /// Cases, and those with an exceedance.
    pub cases: [usize; 2],
    /// Vehicles.
    pub vehicles: String,
    /// The cases with the largest utilisation, the worst first; one at least.
    pub worst: Vec<Case>,
    /// Smallest safe load factor; infinite where nothing bounds it.
    pub safe: f64,
    /// Codes of its doubts.
    pub doubts: BTreeSet<String>,
}

/// A case, as its row tells it.
#[derive(Clone, Debug, Default)]
pub struct Case {
    /// Its largest utilisation.
    pub utilisation: f64,
    /// The variation, empty where there is none.
    pub variation: String,
    /// The scenario.
    pub scenario: String,
    /// The coupler that breaks, empty for a pulse.
    pub broken: String,
    /// The coupler with that utilisation.
    pub coupler: String,
    /// Its force, N.
    pub force_n: f64,
    /// When, s after the event.
    pub time_s: f64,
    /// Couplers that exceed.
    pub exceeding: String,
    /// The safe load factor; infinite where nothing bounds it.
    pub safe: f64,
}

/// Keeps a case if it is among the worst; of equal ones, the first.
fn keep(worst: &mut Vec<Case>, case: Case) {
    let at = worst.partition_point(|other| other.utilisation >= case.utilisation);
    if at < KEPT {
        worst.insert(at, case);
        worst.truncate(KEPT);
    }
}

/// A variation of a train whose rows are passing by.
#[derive(Clone, Debug)]
struct Unit {
    file: String,
    name: String,
    variation: String,
    inputs: Vec<f64>,
    cases: [usize; 2],
    undecided: bool,
    vehicles: String,
    worst: Vec<Case>,
    safe: f64,
    doubts: BTreeSet<String>,
}

impl Summary {
    /// Nothing seen; rows will have this many inputs.
    pub fn new(inputs: usize) -> Summary {
        Summary { inputs, columns: vec![Vec::new(); inputs + 1], ..Summary::default() }
    }

    /// Takes in rows of `fleet.csv` and `errors.csv`.
    pub fn add(&mut self, rows: &[u8], errors: &[u8]) {
        for row in records(rows) {
            self.row(&row);
        }
        for row in records(errors) {
            self.error(&row);
        }
    }

    /// Takes in a row of `errors.csv`.
    pub fn error(&mut self, row: &csv::StringRecord) {
        self.failed += 1;
        if self.errors.len() < SHOWN {
            let cell = |i: usize| row.get(i).unwrap_or_default();
            let variation = if cell(1).is_empty() { String::new() } else { format!("variation {}", cell(1)) };
            let what = [variation, cell(2).to_owned()];
            let what = what.into_iter().filter(|w| !w.is_empty()).collect::<Vec<_>>().join(", ");
            self.errors.push([cell(0).to_owned(), what, cell(4).to_owned()]);
        }
    }

    /// Takes in a row of `fleet.csv`.
    pub fn row(&mut self, row: &csv::StringRecord) {
        let cell = |i: usize| row.get(i).unwrap_or_default();
        let back = |name: &str| {
            let at = BACK.iter().position(|column| *column == name);
            at.map_or("", |at| cell(FRONT.len() + self.inputs + at))
        };
        let is_new = self.unit.as_ref().is_none_or(|u| u.file != cell(0) || u.variation != cell(3));
        let exceeds = back("exceeding") != "0";
        let undecided = back("undecided") != "0";
        let utilisation: f64 = back("utilisation").parse().unwrap_or(0.0);
        let safe = back("safe_load_factor").parse().unwrap_or(f64::INFINITY);
        let (broken, worst) = (back("broken_coupler").to_owned(), back("worst_coupler").to_owned());
        let case = Case {
            utilisation,
            variation: cell(3).to_owned(),
            scenario: back("scenario").to_owned(),
            broken,
            coupler: worst,
            force_n: back("peak_force_n").parse().unwrap_or(0.0),
            time_s: back("peak_time_s").parse().unwrap_or(0.0),
            exceeding: back("exceeding").to_owned(),
            safe,
        };
        let doubts: Vec<String> = back("doubts").split_whitespace().map(str::to_owned).collect();
        self.cases += 1;
        self.harmful += usize::from(exceeds);
        let couplers = cell(2).parse::<usize>().map_or(1, |vehicles| vehicles.saturating_sub(1));
        if let Ok(broken) = case.broken.parse() {
            self.breaks.add(broken, couplers, exceeds);
        }
        if let Some(worst) = case.coupler.parse().ok().filter(|_| exceeds) {
            self.overloaded.add(worst, couplers, true);
        }
        if is_new {
            self.close();
            let inputs = (0..self.inputs).map(|i| cell(FRONT.len() + i).parse().unwrap_or(f64::NAN)).collect();
            let [file, name, vehicles, variation] = [0, 1, 2, 3].map(|i| cell(i).to_owned());
            let (cases, worst) = ([0, 0], Vec::new());
            let safe = f64::INFINITY;
            let (undecided, doubts) = (false, BTreeSet::new());
            self.unit = Some(Unit { file, name, vehicles, variation, inputs, cases, undecided, worst, safe, doubts });
        }
        if let Some(unit) = &mut self.unit {
            unit.cases = [unit.cases[0] + 1, unit.cases[1] + usize::from(exceeds)];
            unit.undecided |= undecided;
            unit.doubts.extend(doubts);
            unit.safe = unit.safe.min(safe);
            keep(&mut unit.worst, case);
        }
    }

    /// Counts the variation whose rows have all passed.
    pub fn close(&mut self) {
        let Some(unit) = self.unit.take() else { return };
        self.safe.push(unit.safe);
        for (column, value) in self.columns.iter_mut().zip(unit.inputs.iter().chain([&unit.worst[0].utilisation])) {
            column.push(*value);
        }
        let known = self.trains.last_mut().filter(|train| train.file == unit.file);
        let told = known.as_ref().map(|train| train.doubts.clone()).unwrap_or_default();
        self.doubtful += usize::from(told.is_empty() && !unit.doubts.is_empty());
        for code in unit.doubts.difference(&told) {
            self.doubts.entry(code.clone()).or_insert_with(|| (0, unit.file.clone())).0 += 1;
        }
        match known {
            Some(train) => train.add(unit),
            None => self.trains.push(TrainSummary::new(unit)),
        }
    }

    /// All trains, worst first.
    pub fn worst_first(&self) -> Vec<&TrainSummary> {
        let mut found: Vec<&TrainSummary> = self.trains.iter().collect();
        found.sort_by(|a, b| b.worst[0].utilisation.total_cmp(&a.worst[0].utilisation));
        found
    }

    /// Trains with an exceedance, worst first.
    pub fn unsafe_trains(&self) -> Vec<&TrainSummary> {
        self.worst_first().into_iter().filter(|t| t.unsafe_variations > 0).collect()
    }

    /// Trains without an exceedance, but with a case that is not decided.
    pub fn undecided_trains(&self) -> usize {
        self.trains.iter().filter(|t| t.unsafe_variations == 0 && t.undecided_variations > 0).count()
    }
}

impl TrainSummary {
    fn new(unit: Unit) -> TrainSummary {
        let exceeds = unit.cases[1] > 0;
        TrainSummary {
            variations: 1,
            unsafe_variations: usize::from(exceeds),
            undecided_variations: usize::from(!exceeds && unit.undecided),
            file: unit.file,
            name: unit.name,
            vehicles: unit.vehicles,
            cases: unit.cases,
            worst: unit.worst,
            safe: unit.safe,
            doubts: unit.doubts,
        }
    }

    fn add(&mut self, unit: Unit) {
        let other = TrainSummary::new(unit);
        self.variations += other.variations;
        self.unsafe_variations += other.unsafe_variations;
        self.undecided_variations += other.undecided_variations;
        self.cases = [self.cases[0] + other.cases[0], self.cases[1] + other.cases[1]];
        self.safe = self.safe.min(other.safe);
        self.doubts.extend(other.doubts);
        other.worst.into_iter().for_each(|case| keep(&mut self.worst, case));
    }
}

/// The rows of a part, which this program has written.
fn records(bytes: &[u8]) -> impl Iterator<Item = csv::StringRecord> + '_ {
    csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(bytes).into_records().flatten()
}
