//! The variations of a train: what each sample of a study puts into its file.

use std::collections::BTreeMap;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use toml::de::DeTable;

use super::base::Base;
use super::spread::{number, shown};
use super::study::{Draws, Input, Per, Study};
use crate::consist::{self, tree::without_places};
use crate::train::Train;

/// A variation of a train, with its inputs as cells of a table; or what is wrong with it.
pub struct Varied {
    /// One cell for each input of the study.
    pub cells: Vec<String>,
    /// The train.
    pub train: Result<Train, String>,
    /// The tree of its file, with the values that were put in.
    pub tree: Option<toml::Table>,
}

/// The couplers that take each input, by the input's number; an input that is not there reaches all.
pub type Reached = BTreeMap<usize, Vec<bool>>;

/// The headings of the inputs' columns.
pub fn headings(study: &Study) -> Vec<String> {
    let heading = |input: &Input| {
        let unit = input.spread.unit(input.key.dimension()).map_or(String::new(), |u| format!(" [{u}]"));
        let smallest = if input.per == Per::Train { "" } else { ", smallest" };
        format!("{}{unit}{smallest}", input.key)
    };
    study.inputs.iter().map(heading).collect()
}

/// A variation, counted from 0, of a train file. A cell shows what was put into the train: of several values the smallest that a
/// coupler or vehicle took.
pub fn vary(study: &Study, variation: usize, base: &Base, reached: &Reached) -> Varied {
    let (varied, puts) = varied(study, base, &|k, count| values(study, variation, k, count));
    let cell = |(k, input): (usize, &Input)| {
        let takes = |i: usize| reached.get(&k).is_none_or(|takes| takes.get(i) != Some(&false));
        let taken = puts[k].iter().enumerate().filter(|(i, _)| takes(*i)).map(|(_, value)| value);
        smallest(input, taken)
    };
    let cells = study.inputs.iter().enumerate().map(cell).collect();
    match varied {
        Ok((train, tree)) => Varied { cells, train: Ok(train), tree },
        Err(wrong) => Varied { cells, train: Err(wrong), tree: None },
    }
}

/// The same variation with another value of one input, for every coupler or vehicle that takes it.
pub fn probe(study: &Study, variation: usize, base: &Base, input: usize, value: &toml::Value) -> Result<Train, String> {
    let draw = |k: usize, count| match k == input {
        true => vec![value.clone(); count],
        false => values(study, variation, k, count),
    };
    varied(study, base, &draw).0.map(|(train, _)| train)
}

/// A train, and the tree of its file with the values of a variation.
type VariedTrain = (Train, Option<toml::Table>);

/// A train with values put into its file, and those values by input. `draw(k, n)` gives `n` values of input
/// `k`.
fn varied(
    study: &Study,
    base: &Base,
    draw: &dyn Fn(usize, usize) -> Vec<toml::Value>,
) -> (Result<VariedTrain, String>, Vec<Vec<toml::Value>>) {
    let mut puts = vec![Vec::new(); study.inputs.len()];
    let text = match &base.text {
        Ok(text) => text,
        Err(e) => return (Err(e.brief()), puts),
    };
    let Some(mut tree) = base.tree.clone() else {
        let train = consist::parse_with(text, &base.path, &base.files);
        return (train.map(|train| (train, None)).map_err(|e| e.brief()), puts);
    };
    let of = |per: Per| study.inputs.iter().enumerate().filter(move |(_, input)| input.per == per);
    for (k, input) in of(Per::Train).chain(of(Per::Coupler)) {
        // The first coupler's value stands for the others' until these are known.
        puts[k] = draw(k, 1);
        if let Err(missing) = input.key.put(&mut tree, puts[k][0].clone()) {
            return (Err(missing), puts);
        }
    }
    if let Err(missing) = put_in_vehicles(of(Per::Vehicle), &mut tree, draw, &mut puts) {
        return (Err(missing), puts);
    }
    let drawn = std::cell::RefCell::new(&mut puts);
    let each = |couplers: usize, read: &mut dyn FnMut(&DeTable)| {
        let mut drawn = drawn.borrow_mut();
        for (k, _) in of(Per::Coupler) {
            drawn[k] = draw(k, couplers);
        }
        for i in 0..couplers {
            let own = own_coupler(&tree, of(Per::Coupler).map(|(k, input)| (input, &drawn[k][i])));
            without_places(&own, &mut *read);
        }
    };
    let each: Option<consist::EachCoupler> = if of(Per::Coupler).next().is_some() { Some(&each) } else { None };
    // Values that were put in have no place in the file to report.
    let read = without_places(&tree, |root| consist::read_tree(root, "", &base.path, &base.files, each));
    (read.map(|train| (train, Some(tree))).map_err(|e| e.titles()), puts)
}

/// The tree of a coupler's own `[coupler]`.
fn own_coupler<'i>(tree: &toml::Table, own: impl Iterator<Item = (&'i Input, &'i toml::Value)>) -> toml::Table {
    let common = tree.get("coupler").cloned().map(|coupler| ("coupler".to_owned(), coupler));
    let mut tree: toml::Table = common.into_iter().collect();
    for (input, value) in own {
        // It succeeds, as it did in the whole train.
        let _ = input.key.put(&mut tree, value.clone());
    }
    tree
}

/// Gives each vehicle of a group its own value: the group is written out, a table for each of its vehicles.
fn put_in_vehicles<'i>(
    inputs: impl Iterator<Item = (usize, &'i Input)>,
    tree: &mut toml::Table,
    draw: &dyn Fn(usize, usize) -> Vec<toml::Value>,
    puts: &mut [Vec<toml::Value>],
) -> Result<(), String> {
    let mut by_group: BTreeMap<usize, Vec<(usize, &Input)>> = BTreeMap::new();
    for (k, input) in inputs {
        by_group.entry(input.key.index.unwrap_or(0)).or_default().push((k, input));
    }
    // From the last, so that the numbers of those before it stay.
    for (index, inputs) in by_group.into_iter().rev() {
        let group = tree.get("vehicle").and_then(|v| v.as_array()?.get(index)?.as_table());
        let count = group.and_then(|group| group.get("count")).and_then(toml::Value::as_integer).unwrap_or(1);
        // The reader refuses what is no number of vehicles.
        let count = usize::try_from(count).ok().filter(|n| (1..=crate::train::MOST_VEHICLES).contains(n)).unwrap_or(1);
        for &(k, input) in &inputs {
            puts[k] = draw(k, count);
            input.key.put(tree, puts[k][0].clone())?;
        }
        let Some(groups) = tree.get_mut("vehicle").and_then(toml::Value::as_array_mut) else { continue };
        let Some(group) = groups[index].as_table().filter(|_| count > 1).cloned() else { continue };
        let one = |i: usize| {
            let mut vehicle = group.clone();
            vehicle.remove("count");
            vehicle.extend(inputs.iter().map(|&(k, input)| (input.key.leaf.to_owned(), puts[k][i].clone())));
            toml::Value::Table(vehicle)
        };
        groups.splice(index..=index, (0..count).map(one));
    }
    Ok(())
}

/// The value, or of several the smallest.
fn smallest<'v>(input: &Input, values: impl Iterator<Item = &'v toml::Value>) -> String {
    let dimension = input.key.dimension();
    let smaller = |a: &&toml::Value, b: &&toml::Value| {
        let [a, b] = [a, b].map(|v| number(v, dimension).unwrap_or(f64::INFINITY));
        a.total_cmp(&b)
    };
    values.min_by(smaller).map_or(String::new(), |value| shown(value, dimension))
}

/// So many values of an input in a variation; one unless each coupler or vehicle has its own.
fn values(study: &Study, variation: usize, k: usize, count: usize) -> Vec<toml::Value> {
    let input = &study.inputs[k];
    let Some(draws) = study.draws else {
        // The last input changes fastest.
        let faster: usize = study.inputs[k + 1..].iter().map(|i| i.spread.count()).product();
        let count = input.spread.count();
        let index = variation / faster % count;
        return vec![input.spread.at((index as f64 + 0.5) / count as f64)];
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
mod tests;
