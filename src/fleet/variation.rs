//! The variations of a train: what each sample of a study puts into its file.

use std::path::Path;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::spread::{number, shown};
use super::study::{Draws, Input, Study};
use crate::consist::{self, Train};
use crate::error::InputError;

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
        let smallest = if input.per_coupler { ", smallest" } else { "" };
        format!("{}{unit}{smallest}", input.key)
    };
    study.inputs.iter().map(heading).collect()
}

/// A variation, counted from 0, of the train file with this text.
pub fn vary(study: &Study, variation: usize, text: &str, path: &Path) -> Varied {
    let base = text.parse::<toml::Table>();
    let Ok(mut table) = base else {
        return Varied { cells: vec![String::new(); study.inputs.len()], train: read(text, path) };
    };
    let couplers = match study.inputs.iter().any(|input| input.per_coupler) {
        true => match consist::parse(text, path) {
            Ok(train) => train.couplers.len(),
            Err(e) => return Varied { cells: vec![String::new(); study.inputs.len()], train: Err(e.brief()) },
        },
        false => 0,
    };
    let mut cells = Vec::new();
    let mut missing = Ok(());
    for (k, input) in study.inputs.iter().enumerate() {
        let values = values(study, variation, k, couplers);
        if input.per_coupler {
            cells.push(cell(input, &input.key.put_each(&mut table, values)));
            continue;
        }
        cells.push(cell(input, &values));
        if let Some(value) = values.into_iter().next() {
            missing = missing.and(input.key.put(&mut table, value));
        }
    }
    let train = missing.and_then(|()| {
        // A table that was read can be written.
        let text = toml::to_string(&table).map_err(|e| e.to_string())?;
        // Its places are not those of the file, so they are not told.
        consist::parse(&text, path).map_err(|e| e.titles())
    });
    Varied { cells, train }
}

fn read(text: &str, path: &Path) -> Result<Train, String> {
    consist::parse(text, path).map_err(|e: InputError| e.brief())
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

/// The values of an input in a variation: one, or one for each coupler.
fn values(study: &Study, variation: usize, k: usize, couplers: usize) -> Vec<toml::Value> {
    let input = &study.inputs[k];
    let Some(draws) = study.draws else {
        // The last input changes fastest.
        let faster: usize = study.inputs[k + 1..].iter().map(|i| i.spread.count()).product();
        let count = input.spread.count();
        let index = variation / faster % count;
        return vec![input.spread.at((index as f64 + 0.5) / count as f64)];
    };
    let count = if input.per_coupler { couplers } else { 1 };
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
