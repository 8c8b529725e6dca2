//! Sums over the rows of a run, row by row.

use std::collections::BTreeMap;

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
    /// Those of them in which none does in the first passage.
    pub harmful_later: usize,
    /// Cases in which some coupler passes a limit, in the order of [`LIMITS`](crate::train::LIMITS).
    pub passing: [usize; 3],
    /// Cases in which more couplers break after the event, and the most of one case.
    pub cascades: [usize; 2],
    /// Where couplers break: cases, and those in which another coupler exceeds.
    pub breaks: Places,
    /// Where the worst coupler is: cases in which some coupler exceeds, in both counts.
    pub overloaded: Places,
    /// Smallest safe factors of each variation of each train.
    pub safe: Vec<Factors>,
    /// Each variation's inputs, then its largest utilisation, column by column.
    pub columns: Vec<Vec<f64>>,
    /// Rows of `errors.csv`.
    pub failed: usize,
    /// Variations of each train, by its file, of which something could not be computed.
    pub failed_variations: BTreeMap<String, usize>,
    /// The first of them: file, what was to be run, error.
    pub errors: Vec<[String; 3]>,
    inputs: usize,
    unit: Option<Unit>,
    last_failed: [String; 2],
}

/// The smallest safe factor on each of [`CAUSES`]: infinite where nothing bounds it, `None` without a case that has one.
pub type Factors = [Option<f64>; 3];

/// Kinds of events in `fleet.csv`, each with what its safe factor multiplies: they never share an axis.
pub const CAUSES: [(&str, &str); 3] =
    [("break", "load"), ("pulse", "force of the pulse"), ("impact", "speed of the impact")];

fn smaller(a: Factors, b: Factors) -> Factors {
    std::array::from_fn(|i| match (a[i], b[i]) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    })
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
    /// Cases, those with an exceedance, and those of them without one in the first passage.
    pub cases: [usize; 3],
    /// Vehicles.
    pub vehicles: String,
    /// The cases with the largest utilisation, the worst first; one at least.
    pub worst: Vec<Case>,
    /// Its smallest safe factors.
    pub safe: Factors,
    /// Cases with each kind of doubt.
    pub doubts: BTreeMap<String, usize>,
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
    /// Its safe factor, in the place of its kind.
    pub safe: Factors,
}

/// Keeps a case if it is among the worst; of equal ones, the first.
fn keep(worst: &mut Vec<Case>, utilisation: f64, case: impl FnOnce() -> Case) {
    let at = worst.partition_point(|other| other.utilisation >= utilisation);
    if at < KEPT {
        worst.insert(at, case());
        worst.truncate(KEPT);
    }
}

/// A variation of a train whose rows are being read.
#[derive(Clone, Debug)]
struct Unit {
    file: String,
    name: String,
    variation: String,
    inputs: Vec<f64>,
    cases: [usize; 3],
    undecided: bool,
    vehicles: String,
    worst: Vec<Case>,
    safe: Factors,
    doubts: BTreeMap<String, usize>,
}

impl Summary {
    /// Nothing seen; rows will have this many inputs.
    pub fn new(inputs: usize) -> Summary {
        Summary { inputs, columns: vec![Vec::new(); inputs + 1], ..Summary::default() }
    }

    /// Takes in rows of `fleet.csv` and `errors.csv`.
    pub fn add(&mut self, rows: &[u8], errors: &[u8]) {
        each_record(rows, |row| self.row(row));
        each_record(errors, |row| self.error(row));
    }

    /// Takes in a row of `errors.csv`.
    pub fn error(&mut self, row: &csv::StringRecord) {
        self.failed += 1;
        let variation = [0, 1].map(|i| row.get(i).unwrap_or_default().to_owned());
        if variation != self.last_failed {
            *self.failed_variations.entry(variation[0].clone()).or_default() += 1;
            self.last_failed = variation;
        }
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
        let front = FRONT.len() + self.inputs;
        let back = |name: &str| {
            let at = BACK.iter().position(|column| *column == name);
            at.map_or("", |at| cell(front + at))
        };
        let is_new = self.unit.as_ref().is_none_or(|u| u.file != cell(0) || u.variation != cell(3));
        let exceeds = back("exceeding") != "0";
        let later = exceeds && back("exceeding_first_passage") == "0";
        let doubts = back("doubts");
        // Where forces can be told only for a part of the time, nothing is decided for the rest.
        let undecided = back("undecided") != "0" || !back("predictable_until_s").is_empty();
        let utilisation: f64 = back("utilisation").parse().unwrap_or(0.0);
        // A march has no such factor; others leave out an infinite one.
        let factor = match back("safe_load_factor").parse() {
            Ok(factor) => Some(factor),
            Err(_) => (back("method") != "march").then_some(f64::INFINITY),
        };
        let safe = CAUSES.map(|(kind, _)| factor.filter(|_| kind == back("kind")));
        let case = || Case {
            utilisation,
            variation: cell(3).to_owned(),
            scenario: back("scenario").to_owned(),
            broken: back("broken_coupler").to_owned(),
            coupler: back("worst_coupler").to_owned(),
            force_n: back("peak_force_n").parse().unwrap_or(0.0),
            time_s: back("peak_time_s").parse().unwrap_or(0.0),
            exceeding: back("exceeding").to_owned(),
            safe,
        };
        self.cases += 1;
        for (cases, passing) in self.passing.iter_mut().zip(["passing_fatigue", "passing_proof", "passing_ultimate"]) {
            *cases += usize::from(back(passing).parse().is_ok_and(|couplers: usize| couplers > 0));
        }
        let breaks: usize = back("further_breaks").parse().unwrap_or(0);
        self.cascades = [self.cascades[0] + usize::from(breaks > 0), self.cascades[1].max(breaks)];
        self.harmful += usize::from(exceeds);
        self.harmful_later += usize::from(later);
        let couplers = cell(2).parse::<usize>().map_or(1, |vehicles| vehicles.saturating_sub(1));
        if let Ok(broken) = back("broken_coupler").parse() {
            self.breaks.add(broken, couplers, exceeds);
        }
        if let Some(worst) = back("worst_coupler").parse().ok().filter(|_| exceeds) {
            self.overloaded.add(worst, couplers, true);
        }
        if is_new {
            self.close();
            let inputs = (0..self.inputs).map(|i| cell(FRONT.len() + i).parse().unwrap_or(f64::NAN)).collect();
            let [file, name, vehicles, variation] = [0, 1, 2, 3].map(|i| cell(i).to_owned());
            let (cases, worst) = ([0; 3], Vec::new());
            let (safe, doubts) = (Factors::default(), BTreeMap::new());
            let undecided = false;
            self.unit = Some(Unit { file, name, vehicles, variation, inputs, cases, undecided, worst, safe, doubts });
        }
        if let Some(unit) = &mut self.unit {
            unit.cases = plus(unit.cases, [1, usize::from(exceeds), usize::from(later)]);
            unit.undecided |= undecided;
            unit.safe = smaller(unit.safe, safe);
            for code in doubts.split_whitespace() {
                *unit.doubts.entry(code.to_owned()).or_default() += 1;
            }
            keep(&mut unit.worst, utilisation, case);
        }
    }

    /// Adds the variation whose rows are complete.
    pub fn close(&mut self) {
        let Some(unit) = self.unit.take() else { return };
        self.safe.push(unit.safe);
        for (column, value) in self.columns.iter_mut().zip(unit.inputs.iter().chain([&unit.worst[0].utilisation])) {
            column.push(*value);
        }
        match self.trains.last_mut().filter(|train| train.file == unit.file) {
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

    /// Trains with an exceedance, but none in the first passage.
    pub fn unsafe_later(&self) -> usize {
        self.trains.iter().filter(|t| t.unsafe_variations > 0 && t.cases[1] == t.cases[2]).count()
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
        self.cases = plus(self.cases, other.cases);
        self.safe = smaller(self.safe, other.safe);
        for (code, cases) in other.doubts {
            *self.doubts.entry(code).or_default() += cases;
        }
        other.worst.into_iter().for_each(|case| keep(&mut self.worst, case.utilisation, || case));
    }
}

fn plus(a: [usize; 3], b: [usize; 3]) -> [usize; 3] {
    std::array::from_fn(|i| a[i] + b[i])
}

/// Gives the rows of a part, which this program has written, one after the other.
fn each_record(bytes: &[u8], mut take: impl FnMut(&csv::StringRecord)) {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(bytes);
    let mut row = csv::StringRecord::new();
    while reader.read_record(&mut row).is_ok_and(|is_there| is_there) {
        take(&row);
    }
}
