//! The work as numbered chunks of cases, the same for every thread, worker and attempt.

use std::ops::Range;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

#[cfg(feature = "parquet")]
use super::couplers::Couplers;
use super::inputs::{DoubtTexts, Inputs, file_cell};
use super::rows::{Chunk, Place};
use super::variation::Varied;
use super::{FleetError, REMEMBERED, Request};
use crate::doubts::doubts;
use crate::findings::{self, Options, cases, require_case};
use crate::solve::Wanted;
use crate::solve::responses::{Responses, Shared};
use crate::train::{Doubt, Scenario, Train};

/// Chunks of a run, if their size is within the limits that follow.
const CHUNKS: u64 = 1000;
const FEWEST_CASES: u64 = 8;
const MOST_CASES: u64 = 500;

/// With so many variations of loads and ratings of one chain, or more, its response is computed once and shared.
const LEAST_REPEATS: usize = 10;
/// Memory of a chain's response, roughly, bytes per square of its springs, and the limit for those of a train.
const SPRING_BYTES: usize = 26;
const MOST_BYTES: usize = REMEMBERED / 2;

/// Cases of all variations of all trains, in order, cut into chunks.
pub struct Plan<'a> {
    inputs: &'a Inputs,
    /// Tolerance and method of each case, and whether only its worst coupler is asked for.
    pub options: Options,
    /// Whether every coupler of every case is kept.
    #[cfg(feature = "parquet")]
    couplers: bool,
    /// Which scenes are solved from responses.
    shared: Shared<'a>,
    /// The number of cases up to and with each unit, a unit being a variation of a train.
    ends: Vec<u64>,
    /// Cases in each chunk but the last.
    pub chunk_cases: u64,
    doubts: Mutex<DoubtTexts>,
}

/// What the cases of a chunk come to.
#[derive(Default)]
pub struct Computed {
    /// Their rows.
    pub rows: Chunk,
    /// Every coupler of theirs, where they are asked for.
    #[cfg(feature = "parquet")]
    pub couplers: Option<Couplers>,
}

impl<'a> Plan<'a> {
    /// Counts the cases.
    pub fn new(inputs: &'a Inputs, request: &Request, responses: &'a Responses) -> Plan<'a> {
        let variations = inputs.variations();
        let mut total = 0;
        let ends = (0..inputs.files.len() * variations).map(|unit| {
            total += u64::from(inputs.cases(unit / variations, unit % variations));
            total
        });
        let ends: Vec<u64> = ends.collect();
        let total = ends.last().copied().unwrap_or(0);
        let cases = (total / CHUNKS).clamp(FEWEST_CASES, MOST_CASES);
        // A chunk holds whole variations, if all are equally long: half ones would be read twice.
        let of_one = ends.first().map_or(1, |first| (*first).max(1));
        let chunk_cases = if cases > of_one { cases - cases % of_one } else { cases };
        // A row has the worst coupler, and counts the others.
        let wanted = if request.couplers { Wanted::Everything } else { Wanted::Worst };
        let repeats = inputs.study.as_ref().is_some_and(|study| study.chain_repeats() >= LEAST_REPEATS);
        let shared = if repeats { Shared::EveryChain(responses) } else { Shared::EqualChains(responses) };
        let options = Options { wanted, ..request.options.clone() };
        Plan {
            inputs,
            #[cfg(feature = "parquet")]
            couplers: request.couplers,
            options,
            shared,
            ends,
            chunk_cases,
            doubts: Mutex::default(),
        }
    }

    /// All cases.
    pub fn cases(&self) -> u64 {
        self.ends.last().copied().unwrap_or(0)
    }

    /// How many chunks there are.
    pub fn chunks(&self) -> usize {
        self.cases().div_ceil(self.chunk_cases) as usize
    }

    /// The cases of a chunk.
    pub fn range(&self, chunk: usize) -> Range<u64> {
        let from = chunk as u64 * self.chunk_cases;
        from..(from + self.chunk_cases).min(self.cases())
    }

    /// All variations of all trains.
    pub fn units(&self) -> usize {
        self.ends.len()
    }

    /// The unit that a case is of, and its index in it.
    pub fn place(&self, case: u64) -> (usize, usize) {
        let unit = self.ends.partition_point(|end| *end <= case);
        let start = if unit == 0 { 0 } else { self.ends[unit - 1] };
        (unit, (case - start) as usize)
    }

    /// The train of a unit.
    ///
    /// # Errors
    /// As for [`Inputs::load`].
    pub fn load(&self, unit: usize) -> Result<Varied, FleetError> {
        let variations = self.inputs.variations();
        self.inputs.load(unit / variations, unit % variations)
    }

    /// Computes a chunk's cases.
    ///
    /// # Errors
    /// As for [`Inputs::load`].
    pub fn compute(&self, chunk: usize) -> Result<Computed, FleetError> {
        let range = self.range(chunk);
        let mut done = Computed::default();
        #[cfg(feature = "parquet")]
        if self.couplers {
            done.couplers = Some(Couplers::new(self.inputs.study.as_ref()));
        }
        let mut at = range.start;
        while at < range.end {
            let (unit, index) = self.place(at);
            let count = self.ends[unit].min(range.end) - at;
            self.unit(unit, index..index + count as usize, &mut done)?;
            at += count;
        }
        Ok(done)
    }

    /// Keeps the texts of doubts: of each kind that of a train's first variation with it.
    fn keep(&self, file: &Path, variation: usize, doubts: &[Doubt]) {
        if doubts.is_empty() {
            return;
        }
        let file = file_cell(file);
        let mut kept = self.doubts.lock().unwrap_or_else(PoisonError::into_inner);
        for doubt in doubts {
            let first = kept.entry((file.clone(), doubt.code.to_owned())).or_insert((variation, doubt.clone()));
            // Chunks of one variation end in any order.
            if (variation, &doubt.text) < (first.0, &first.1.text) {
                *first = (variation, doubt.clone());
            }
        }
    }

    /// The words of the doubts that were met, by train and kind.
    pub fn doubts(self) -> DoubtTexts {
        self.doubts.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    /// Which of a train's scenes are solved from responses: of all chains, if the train's are kept together.
    pub fn shared(&self, train: &Train) -> Shared<'a> {
        let springs = train.couplers().len();
        match self.shared {
            Shared::EveryChain(responses)
                if all_cases(train).count() * springs * springs * SPRING_BYTES > MOST_BYTES =>
            {
                Shared::EqualChains(responses)
            }
            shared => shared,
        }
    }

    /// Some cases of a unit.
    fn unit(&self, unit: usize, range: Range<usize>, done: &mut Computed) -> Result<(), FleetError> {
        let variations = self.inputs.variations();
        let (file, variation) = (unit / variations, unit % variations);
        let varied = self.load(unit)?;
        let is_varied = self.inputs.study.is_some() && !self.inputs.fails_as_a_whole(file);
        let path = &self.inputs.files[file];
        let mut place = Place::new(path, is_varied.then_some(variation + 1), &varied.cells);
        let train = match varied.train {
            Ok(train) => train,
            Err(error) => {
                // Reported once, with the first of its cases.
                if range.start == 0 {
                    done.rows.fail(&place, None, &error);
                }
                return Ok(());
            }
        };
        if let Err(error) = require_case(train.scenarios()) {
            done.rows.fail(&place, None, &error.to_string());
            return Ok(());
        }
        place.doubts = doubts(&train);
        self.keep(path, variation, &place.doubts);
        let shared = self.shared(&train);
        let all: Vec<(&Scenario, Option<usize>)> = all_cases(&train).skip(range.start).take(range.len()).collect();
        for of_scenario in all.chunk_by(|a, b| std::ptr::eq(a.0, b.0)) {
            let scenario = of_scenario[0].0;
            for some in of_scenario.chunks(findings::cases_at_once(&train, scenario)) {
                self.options.stop.check()?;
                let broken: Vec<Option<usize>> = some.iter().map(|(_, broken)| *broken).collect();
                let found = findings::cases_findings(&train, scenario, &broken, &self.options, shared);
                for (case, broken) in found.into_iter().zip(broken) {
                    let case = match case {
                        Ok(case) => case,
                        Err(error) => {
                            done.rows.fail(&place, Some((scenario, broken)), &error.to_string());
                            continue;
                        }
                    };
                    let found = findings::found(&train, scenario, std::slice::from_ref(&case));
                    self.keep(path, variation, &found);
                    #[cfg(feature = "parquet")]
                    if let Some(couplers) = &mut done.couplers {
                        couplers.add(&place, &train, &scenario.name, &case);
                    }
                    done.rows.add(&place, &train, scenario, &case, &found);
                }
            }
        }
        Ok(())
    }
}

/// The cases of a train: each scenario with each coupler that breaks in it.
fn all_cases(train: &Train) -> impl Iterator<Item = (&Scenario, Option<usize>)> {
    train.scenarios().iter().flat_map(|s| cases(&s.event).into_iter().map(move |broken| (s, broken)))
}
