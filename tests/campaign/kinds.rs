//! Random trains of every kind of scenario, all that an analysis says of them against the reference march.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::findings::Judge;
use super::trains::{Drawn, Kind, Rated, draw};
use trainsafe::accuracy::reference::march::{March, System, march};
use trainsafe::consist;
use trainsafe::findings::{CaseFindings, MapPoint};
use trainsafe::findings::{Options, analyze};
use trainsafe::solve::Wanted;

/// What is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quantity {
    Load,
    Peak,
    Time,
    Verdict,
    VerdictOnly,
    FirstExceedance,
    FirstPassage,
    Limit,
    SafeFactor,
    AllTimeBound,
    Map,
    Break,
    BreakTime,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Quantity; 13] = [
        Quantity::Load,
        Quantity::Peak,
        Quantity::Time,
        Quantity::Verdict,
        Quantity::VerdictOnly,
        Quantity::FirstExceedance,
        Quantity::FirstPassage,
        Quantity::Limit,
        Quantity::SafeFactor,
        Quantity::AllTimeBound,
        Quantity::Map,
        Quantity::Break,
        Quantity::BreakTime,
    ];

    /// In the table.
    pub fn name(self) -> &'static str {
        match self {
            Quantity::Load => "load before",
            Quantity::Peak => "peak",
            Quantity::Time => "time of peak",
            Quantity::Verdict => "verdict",
            Quantity::VerdictOnly => "verdict only",
            Quantity::FirstExceedance => "first exceedance",
            Quantity::FirstPassage => "first passage",
            Quantity::Limit => "limit",
            Quantity::SafeFactor => "safe factor",
            Quantity::AllTimeBound => "all-time bound",
            Quantity::Map => "map",
            Quantity::Break => "break",
            Quantity::BreakTime => "time of break",
        }
    }
}

/// What was compared, of one kind or one quantity.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// Scenes.
    pub scenes: usize,
    /// Comparisons.
    pub compared: usize,
    /// Numbers beyond their bounds and verdicts that are not so: seed and what is wrong.
    pub wrong: Vec<(u64, String)>,
    /// Verdicts left undecided.
    pub undecided: usize,
    /// Largest error over its bound, and the seed.
    pub worst: (f64, u64),
}

impl Tally {
    /// Adds another one's counts.
    pub fn add(&mut self, other: &Tally) {
        self.scenes += other.scenes;
        self.compared += other.compared;
        self.wrong.extend(other.wrong.iter().cloned());
        self.undecided += other.undecided;
        if other.worst.0 > self.worst.0 {
            self.worst = other.worst;
        }
    }
}

/// Every comparison, by kind and quantity.
pub type Tallies = BTreeMap<(Kind, Quantity), Tally>;

/// Compares the trains of many seeds; scenes of each kind beside.
pub fn run(seeds: &[u64]) -> (BTreeMap<Kind, usize>, Tallies) {
    let all: Vec<(Kind, Tallies)> = seeds.par_iter().map(|seed| scene(*seed)).collect();
    let (mut scenes, mut tallies) = (BTreeMap::new(), Tallies::new());
    for (kind, found) in all {
        *scenes.entry(kind).or_default() += 1;
        for (key, tally) in found {
            tallies.entry(key).or_default().add(&tally);
        }
    }
    (scenes, tallies)
}

/// Compares one train.
pub fn scene(seed: u64) -> (Kind, Tallies) {
    let mut drawn = draw(seed);
    let truth = kept(&drawn.system);
    let rated = drawn.rated(&truth);
    let mut judge = Judge::new(seed, &drawn, &rated, &truth);
    if let Some(Analyzed { case, quick, map }) = analyzed(&drawn, &rated, &mut judge) {
        judge.case(&case);
        judge.verdict_only(&quick, &case);
        if drawn.kind.cascades() {
            judge.cascade(&case);
        }
        map.into_iter().for_each(|point| judge.map_point(&case, &point));
    }
    (drawn.kind, judge.tallies)
}

/// A case as the program has it.
struct Analyzed {
    case: CaseFindings,
    /// The same with the verdict alone asked for, of every second train as a fleet asks.
    quick: CaseFindings,
    /// Some points of its map.
    map: Vec<MapPoint>,
}

/// The case as the program has it, from the file's text.
fn analyzed(drawn: &Drawn, rated: &Rated, judge: &mut Judge) -> Option<Analyzed> {
    let folder = tempfile::tempdir().ok()?;
    let (text, record) = drawn.text(rated);
    std::fs::write(folder.path().join("record.csv"), record).ok()?;
    let train = match consist::parse(&text, &folder.path().join("a.toml")) {
        Ok(train) => train,
        Err(e) => {
            judge.fail(Quantity::Load, format!("refused: {e}\n{text}"));
            return None;
        }
    };
    let steps = matches!(drawn.kind, Kind::Break | Kind::Rectangle | Kind::HalfSine);
    let map = steps && judge.seed.is_multiple_of(3);
    let full = Options { all_time_bound: drawn.system.ratio == 0.0, map, ..Options::default() };
    let quick = Options { verdict_only: true, map: false, wanted: wanted(judge.seed), ..full.clone() };
    match (analyze(&train, &full), analyze(&train, &quick)) {
        (Ok(mut analysis), Ok(mut quick)) => {
            judge.loads(train.initial_force_n());
            let mut found = analysis.scenarios.pop()?;
            let points = found.map.map_or(vec![], |m| m.points);
            let every = (points.len() / 3).max(1);
            let map = points.into_iter().step_by(every).collect();
            Some(Analyzed { case: found.cases.pop()?, quick: quick.scenarios.pop()?.cases.pop()?, map })
        }
        (Err(e), _) | (_, Err(e)) => {
            judge.fail(Quantity::Peak, format!("not analysed: {e}"));
            None
        }
    }
}

/// Which couplers the quick answer to a scene tells of.
pub fn wanted(seed: u64) -> Wanted {
    if seed.is_multiple_of(2) { Wanted::Worst } else { Wanted::Everything }
}

/// A system in which the event's part is `factor` times as large: its forces over time and speeds.
pub fn with_factor(system: &System, factor: f64) -> System {
    System { velocity: system.velocity.iter().map(|v| factor * v).collect(), ..system.clone() }
}

/// The same motion where nothing breaks.
pub fn kept(system: &System) -> March {
    march(system, &vec![[f64::INFINITY; 2]; system.stiffness.len()])
}
