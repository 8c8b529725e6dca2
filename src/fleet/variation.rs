//! The variations of a train: what each sample of a study puts into its file.

use std::path::Path;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::spread::{number, shown, written};
use super::study::{Draws, Input, Per, Study};
use crate::consist::{self, Files, Origin, Train};

/// A variation of a train, with its inputs as cells of a table; or what is wrong with it.
pub struct Varied {
    /// One cell for each input of the study.
    pub cells: Vec<String>,
    /// The train.
    pub train: Result<Train, String>,
}

/// The headings of the inputs' columns.
pub fn headings(study: &Study) -> Vec<String> {
    let heading = |input: &Input| {
        let unit = input.spread.unit(input.key.dimension()).map_or(String::new(), |u| format!(" [{u}]"));
        let smallest = if input.per == Per::Train { "" } else { ", smallest" };
        format!("{}{unit}{smallest}", input.key)
    };
    study.inputs.iter().map(heading).collect()
}

/// A variation, counted from 0, of the train file with this text; `files` has the files that it names.
pub fn vary(study: &Study, variation: usize, text: &str, path: &Path, files: &Files) -> Varied {
    let mut cells = vec![String::new(); study.inputs.len()];
    let Ok(mut table) = text.parse::<toml::Table>() else {
        return Varied { cells, train: consist::parse_with(text, path, files).map_err(|e| e.brief()) };
    };
    let train = put_all(study, variation, &mut table, &mut cells, path, files);
    Varied { cells, train: train.and_then(|()| train_of(&table, path, files)) }
}

/// The train of a changed file. Its places are not those of the file, so they are not told.
fn train_of(table: &toml::Table, path: &Path, files: &Files) -> Result<Train, String> {
    // A table that was read can be written.
    let text = toml::to_string(table).map_err(|e| e.to_string())?;
    consist::parse_with(&text, path, files).map_err(|e| e.titles())
}

/// Puts every input into the table: first those of the train, then those of vehicles and couplers, whose number follows from them.
fn put_all(
    study: &Study,
    variation: usize,
    table: &mut toml::Table,
    cells: &mut [String],
    path: &Path,
    files: &Files,
) -> Result<(), String> {
    let of = |per: Per| study.inputs.iter().enumerate().filter(move |(_, input)| input.per == per);
    for (k, input) in of(Per::Train) {
        let value = values(study, variation, k, 1);
        cells[k] = cell(input, &value);
        value.into_iter().try_for_each(|value| input.key.put(table, value))?;
    }
    // A group that is spelt out moves those behind it.
    let mut groups: Vec<_> = of(Per::Vehicle).collect();
    groups.sort_by_key(|(_, input)| std::cmp::Reverse(input.key.index));
    for (k, input) in groups {
        let missing = || format!("the train file has no [[vehicle]] for {}", input.key);
        let count = input.key.vehicles(table).ok_or_else(missing)?;
        let drawn = values(study, variation, k, count);
        cells[k] = cell(input, &drawn);
        input.key.put_each_vehicle(table, drawn);
    }
    for (k, input) in of(Per::Coupler) {
        let reached = reached_couplers(input, table, path, files)?;
        let drawn = values(study, variation, k, reached.len());
        let put: Vec<Option<toml::Value>> = drawn.into_iter().zip(reached).map(|(v, r)| r.then_some(v)).collect();
        cells[k] = cell(input, &put.iter().flatten().cloned().collect::<Vec<_>>());
        // [coupler] needs a value that can be read, if only for couplers that have their own.
        let readable = |coupler: &toml::Table| {
            let given = coupler.get(input.key.leaf);
            given.is_some_and(|value| number(value, input.key.dimension()).is_some())
        };
        if !table.get("coupler").and_then(toml::Value::as_table).is_some_and(readable) {
            put.iter().flatten().next().cloned().map_or(Ok(()), |value| input.key.put(table, value))?;
        }
        input.key.put_each(table, put.into_iter());
    }
    Ok(())
}

/// Two values of an input that differ.
fn two_values(input: &Input) -> [toml::Value; 2] {
    let ends = [input.spread.at(0.01), input.spread.at(0.99)];
    match (ends[0] == ends[1], input.key.dimension()) {
        (true, Some(dimension)) => {
            let double = number(&ends[0], Some(dimension)).map(|x| 2.0 * x * dimension.si_size());
            let other = double.map_or_else(|| ends[1].clone(), |x| written(x, dimension, false));
            [ends[0].clone(), other]
        }
        _ => ends,
    }
}

/// The trains that two different values of an input give.
fn two_trains(input: &Input, table: &toml::Table, path: &Path, files: &Files) -> Result<[Train; 2], String> {
    let with = |value: toml::Value| -> Result<Train, String> {
        let mut table = table.clone();
        input.key.put(&mut table, value)?;
        let train = train_of(&table, path, files)?;
        Ok(Train { origin: Origin::default(), ..train })
    };
    let [one, other] = two_values(input);
    Ok([with(one)?, with(other)?])
}

/// Which couplers a key of `[coupler]` reaches: those that it changes, and not those that have a value of their own from the table
/// of vehicles or from `[[coupler_override]]`.
fn reached_couplers(input: &Input, table: &toml::Table, path: &Path, files: &Files) -> Result<Vec<bool>, String> {
    let [one, other] = two_trains(input, table, path, files)?;
    let dashpot = |train: &Train, i: usize| train.extras.dashpot_n_s_per_m.get(i).copied();
    let changes = |i: usize| one.couplers[i] != other.couplers[i] || dashpot(&one, i) != dashpot(&other, i);
    Ok((0..one.couplers.len()).map(changes).collect())
}

/// Whether an input changes anything in a train; `None` where that cannot be told because the train cannot be read.
pub fn has_effect(study: &Study, k: usize, text: &str, path: &Path, files: &Files) -> Option<bool> {
    let mut table = text.parse::<toml::Table>().ok()?;
    let input = &study.inputs[k];
    for (_, other) in study.inputs.iter().enumerate().filter(|(other, _)| *other != k) {
        other.key.put(&mut table, other.spread.at(0.5)).ok()?;
    }
    let [one, other] = two_trains(input, &table, path, files).ok()?;
    let [a, b] = two_values(input);
    Some(one != other || a == b)
}

/// The value, or of several the smallest.
fn cell(input: &Input, values: &[toml::Value]) -> String {
    let dimension = input.key.dimension();
    let smaller = |a: &&toml::Value, b: &&toml::Value| {
        let [a, b] = [a, b].map(|v| number(v, dimension).unwrap_or(f64::INFINITY));
        a.total_cmp(&b)
    };
    values.iter().min_by(smaller).map_or(String::new(), |value| shown(value, dimension))
}

/// So many values of an input in a variation.
fn values(study: &Study, variation: usize, k: usize, count: usize) -> Vec<toml::Value> {
    let input = &study.inputs[k];
    let Some(draws) = study.draws else {
        // The last input changes fastest.
        let faster: usize = study.inputs[k + 1..].iter().map(|i| i.spread.count()).product();
        let choices = input.spread.count();
        let index = variation / faster % choices;
        return vec![input.spread.at((index as f64 + 0.5) / choices as f64)];
    };
    let mut random = generator(draws.seed, k);
    random.set_stream(variation as u64);
    (0..count)
        .map(|i| {
            let inside = unit_interval(random.next_u64());
            let p = if draws.latin_hypercube { stratum(draws, variation, k, i, inside) } else { inside };
            input.spread.at(p)
        })
        .collect()
}

/// Random numbers of one input: a stream for each variation, whatever other inputs and variations draw.
fn generator(seed: u64, k: usize) -> ChaCha8Rng {
    let mut bytes = [0; 32];
    bytes[..8].copy_from_slice(&seed.to_le_bytes());
    bytes[8..16].copy_from_slice(&(k as u64).to_le_bytes());
    ChaCha8Rng::from_seed(bytes)
}

/// A number strictly between 0 and 1 from the upper 53 bits.
fn unit_interval(bits: u64) -> f64 {
    ((bits >> 11) as f64 + 0.5) * f64::exp2(-53.0)
}

/// A place in this variation's stratum of a Latin hypercube: over all variations each of `samples` strata is hit once
/// (M. D. McKay, R. J. Beckman, W. J. Conover, *Technometrics* 21 (1979) 239-245).
fn stratum(draws: Draws, variation: usize, k: usize, i: usize, inside: f64) -> f64 {
    let key = mix(draws.seed ^ mix(((k as u64) << 32) | i as u64));
    let stratum = permuted(variation as u64, draws.samples as u64, key);
    let p = (stratum as f64 + inside) / draws.samples as f64;
    p.min(1.0 - f64::EPSILON)
}

/// A permutation of 0..count, one for each key, without a table: a Feistel network on the next even number of bits, walked
/// until it comes back into the range (J. Black and P. Rogaway, *Topics in Cryptology, CT-RSA 2002*, 114-130).
fn permuted(index: u64, count: u64, key: u64) -> u64 {
    let half = (64 - (count - 1).leading_zeros()).div_ceil(2).max(1);
    let mask = (1u64 << half) - 1;
    let mut at = index;
    loop {
        let (mut left, mut right) = (at >> half, at & mask);
        for round in 0..6 {
            (left, right) = (right, left ^ (mix(key ^ mix((round << 48) | right)) & mask));
        }
        at = (left << half) | right;
        if at < count {
            return at;
        }
    }
}

/// The finaliser of SplitMix64 (G. L. Steele, D. Lea, C. H. Flood, *OOPSLA 2014*, 453-472).
fn mix(z: u64) -> u64 {
    let z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::permuted;

    #[test]
    fn every_stratum_is_hit_once() {
        for count in [1, 2, 3, 10, 100, 1000, 4097] {
            let mut hit: Vec<u64> = (0..count).map(|i| permuted(i, count, 7 * count)).collect();
            hit.sort_unstable();
            assert!(hit.iter().copied().eq(0..count), "{count}");
        }
    }
}
