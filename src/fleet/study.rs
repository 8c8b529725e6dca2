//! A study file: which trains, and what to vary in them.
//!
//! ```toml
//! trains = ["trains/*.toml"]        # files, folders or globs, from the study file's folder
//! samples = 10000                   # absent: every combination of the lists and ranges
//! seed = 7                          # 1 if absent
//! latin_hypercube = true            # false if absent
//!
//! [[vary]]
//! key = "coupler.rated_load"        # a key of the train file; lists of tables are indexed from 0
//! distribution = "normal"
//! mean = "1.5 MN"
//! sd = "0.1 MN"
//! per = "coupler"                   # or "vehicle"; "train" if absent
//!
//! [[vary]]
//! key = "load.uniform"
//! values = ["0.5 MN", "0.6 MN"]     # or from, to and steps
//! ```

use std::path::Path;

use toml::de::{DeTable, DeValue};

use super::key::{Key, Measure};
use super::spread::{Distribution, LARGEST_IMPOSSIBLE, Spread};
use super::study_keys::{LARGEST_SEED, MOST_STEPS, MOST_VARIATIONS, STUDY, VARY};
use crate::consist;
use crate::consist::tree::{Found, Read, Table, Value};
use crate::error::InputError;
use crate::keys::Sign;
use crate::units::Amount;

/// What a study file says.
#[derive(Clone, Debug)]
pub struct Study {
    /// Files, folders and globs, from the study file's folder.
    pub trains: Vec<String>,
    /// `None`: every combination.
    pub draws: Option<Draws>,
    /// What is varied; the first changes slowest where every combination is run.
    pub inputs: Vec<Input>,
}

/// How variations are drawn.
#[derive(Clone, Copy, Debug)]
pub struct Draws {
    /// Variations of each train.
    pub samples: usize,
    /// Seed of the draws.
    pub seed: u64,
    /// Whether each input's draws are stratified over the samples.
    pub latin_hypercube: bool,
}

/// A key that is varied.
#[derive(Clone, Debug)]
pub struct Input {
    /// Which.
    pub key: Key,
    /// Over what.
    pub spread: Spread,
    /// What has a draw of its own.
    pub per: Per,
}

/// What has a draw of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Per {
    /// The train.
    Train,
    /// Each coupler that has no value of its own.
    Coupler,
    /// Each vehicle of a group.
    Vehicle,
}

impl Study {
    /// How many variations each train has.
    pub fn variations(&self) -> usize {
        let grid = || self.inputs.iter().map(|input| input.spread.count()).product();
        self.draws.map_or_else(grid, |draws| draws.samples)
    }

    /// How many variations have the same masses, stiffnesses and events but for their forces.
    pub(crate) fn chain_repeats(&self) -> usize {
        let is_load = |input: &&Input| {
            let table = input.key.table.unwrap_or_default();
            LOADS.iter().any(|(of, leaves)| *of == table && leaves.contains(&input.key.leaf))
        };
        match self.draws {
            Some(draws) if self.inputs.iter().all(|input| is_load(&input)) => draws.samples,
            Some(_) => 1,
            None => self.inputs.iter().filter(is_load).map(|input| input.spread.count()).product(),
        }
    }
}

/// Keys of a train file that change loads, forces and ratings alone, by table.
const LOADS: [(&str, &[&str]); 5] = [
    ("load", &["uniform", "pulled_to", "rolling_resistance", "grade"]),
    ("vehicle", &["rolling_resistance", "grade", "tractive_effort"]),
    ("coupler", &["rated_load", "rated_buff", "fatigue", "proof", "ultimate"]),
    ("coupler_override", &["rated_load", "rated_buff", "fatigue", "proof", "ultimate"]),
    ("scenario", &["force"]),
];

/// Whether a file's text is a study rather than a train.
pub fn is_study(text: &str) -> bool {
    DeTable::parse(text).is_ok_and(|root| consist::is_study(root.get_ref()))
}

/// Reads a study file's text; `path` is what messages call it.
///
/// # Errors
/// Every problem in the text that can be seen at once, with its place and what would be right.
pub fn parse(text: &str, path: &Path) -> Result<Study, InputError> {
    let root = DeTable::parse(text).map_err(|e| consist::not_toml(e, text, path))?;
    let found = Found::default();
    let study = study(&Table::root(&found, root.get_ref(), &STUDY));
    let (problems, _) = found.into_parts();
    match study {
        Ok(study) if problems.is_empty() => Ok(study),
        _ => Err(InputError::new(path, text, problems).with_keys(root.get_ref())),
    }
}

/// Each input of a study file's text: its key, its values or distribution as they are written, and what has a draw of its own; none
/// of a text that is no study.
pub fn written(text: &str) -> Vec<[String; 3]> {
    const VALUES: usize = 10;
    let root: toml::Table = text.parse().unwrap_or_default();
    let word = |value: &toml::Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    let values = |value: &toml::Value| match value.as_array() {
        Some(list) if list.len() > VALUES => {
            let first: Vec<String> = list.iter().take(VALUES).map(word).collect();
            format!("{} and {} more", first.join(", "), list.len() - VALUES)
        }
        Some(list) => list.iter().map(word).collect::<Vec<_>>().join(", "),
        None => word(value),
    };
    let input = |table: &toml::Value| {
        let of = |key: &str| table.get(key).map(&values);
        let names = VARY.keys.iter().map(|key| key.name).filter(|name| !["key", "per"].contains(name));
        let spread: Vec<String> = names.filter_map(|name| Some(format!("{name} {}", of(name)?))).collect();
        [of("key").unwrap_or_default(), spread.join("; "), of("per").unwrap_or_else(|| "train".to_owned())]
    };
    root.get("vary").and_then(toml::Value::as_array).into_iter().flatten().map(input).collect()
}

fn study(root: &Table) -> Read<Study> {
    let trains = root.require("trains", "add trains = [\"trains/*.toml\"]: files, folders or globs").and_then(|list| {
        let names: Vec<String> = list.items().map(|v| v.file_name().map(str::to_owned)).collect::<Read<_>>()?;
        if names.is_empty() { Err(list.wrong("trains is empty", "name a file, a folder or a glob")) } else { Ok(names) }
    });
    let draws = draws(root);
    let vary = root.require("vary", "add a [[vary]] table for each key to vary");
    let tables = vary.and_then(|v| Ok((v.tables()?, v)));
    let (tables, value) = tables?;
    let draws = draws?;
    let inputs = tables.iter().map(|table| input(table, draws.is_some())).collect::<Vec<_>>();
    let inputs = inputs.into_iter().collect::<Read<Vec<Input>>>()?;
    if inputs.is_empty() {
        return Err(value.wrong("nothing is varied", "add a [[vary]] table for each key to vary"));
    }
    for (i, input) in inputs.iter().enumerate() {
        if inputs[..i].iter().any(|earlier| earlier.key == input.key) {
            let help = "a key is varied in one way at a time";
            return Err(tables[i].wrong(format!("{} is varied twice", input.key), help));
        }
    }
    let study = Study { trains: trains?, draws, inputs };
    let counts = study.inputs.iter().map(|input| input.spread.count());
    if study.draws.is_none() && counts.fold(1usize, |all, n| all.saturating_mul(n)) > MOST_VARIATIONS {
        let title = format!("there are more than {MOST_VARIATIONS} combinations");
        return Err(value.wrong(title, "name fewer values, or draw some of the combinations: samples = 10000"));
    }
    Ok(study)
}

fn draws(root: &Table) -> Read<Option<Draws>> {
    let whole = |key: &'static str, most: usize| {
        let right = format!("expected a whole number from 1 to {most}");
        root.get(key).map(|v| v.number(most, |n| format!("{key} is {n}"), &right)).transpose()
    };
    let samples = whole("samples", MOST_VARIATIONS)?;
    let seed = whole("seed", LARGEST_SEED)?;
    let latin = root.get("latin_hypercube").map(|v| v.flag()).transpose()?;
    match (samples, seed.is_some() || latin.is_some()) {
        (None, true) => Err(root.wrong("seed and latin_hypercube need a number of samples", "add samples = 10000")),
        (None, false) => Ok(None),
        (Some(samples), _) => {
            let seed = seed.unwrap_or(1) as u64;
            Ok(Some(Draws { samples, seed, latin_hypercube: latin.unwrap_or(false) }))
        }
    }
}

fn input(table: &Table, drawn: bool) -> Read<Input> {
    let value = table.require("key", "add key = \"coupler.stiffness\", or another key of the train file")?;
    let key = Key::parse(value.name()?).map_err(|bad| value.wrong(bad.title, bad.help))?;
    let per = table.get("per").map_or(Ok(Per::Train), |v| per(&v, &key, drawn))?;
    let ways = ["values", "from", "distribution"].map(|key| table.get(key));
    let spread = match ways {
        [Some(list), None, None] => values(&list, &key),
        [None, Some(from), None] => range(table, &from, &key),
        [None, None, Some(name)] if drawn => law(table, &name, &key),
        [None, None, Some(name)] => {
            Err(name.wrong("a distribution has no combinations to run", "add samples = 10000 at the top of the file"))
        }
        [None, None, None] => {
            Err(table.wrong("nothing says how to vary it", "add values, from and to, or distribution"))
        }
        _ => Err(table.wrong(
            "values, from and to, and distribution cannot be used together",
            "keep one of them; a uniform distribution takes low and high",
        )),
    };
    Ok(Input { key, spread: spread?, per })
}

fn per(value: &Value, key: &Key, drawn: bool) -> Read<Per> {
    let (per, fits, right) = match value.word()? {
        "coupler" => (Per::Coupler, key.of_every_coupler(), "only keys of [coupler] have per = \"coupler\""),
        "vehicle" => {
            let right = "only quantities of a [[vehicle]] have per = \"vehicle\", such as vehicle[1].mass";
            (Per::Vehicle, key.of_every_vehicle(), right)
        }
        _ => return Ok(Per::Train),
    };
    let word = value.word()?;
    if !fits {
        return Err(value.wrong(format!("{key} is no key of every {word}"), right));
    }
    if !drawn {
        return Err(value.wrong(format!("every {word} has its own value only in draws"), "add samples = 10000"));
    }
    Ok(per)
}

fn values(list: &Value, key: &Key) -> Read<Spread> {
    let one = |item: Value| -> Read<toml::Value> {
        if let Some(Measure { of, sign, share }) = key.measure() {
            item.amount_of(of, sign, share)?;
        }
        plain(item.raw())
            .ok_or_else(|| item.wrong("this is no value of a train file's key", "expected a string or a number"))
    };
    let all = list.items().map(one).collect::<Read<Vec<_>>>()?;
    if all.is_empty() { Err(list.wrong("values is empty", "name at least one")) } else { Ok(Spread::Values(all)) }
}

/// The value without its places; `None` for what no key of a train file has.
fn plain(value: &DeValue) -> Option<toml::Value> {
    Some(match value {
        DeValue::String(text) => toml::Value::String(text.to_string()),
        DeValue::Integer(number) => toml::Value::Integer(i64::from_str_radix(number.as_str(), number.radix()).ok()?),
        DeValue::Boolean(flag) => toml::Value::Boolean(*flag),
        DeValue::Array(items) => toml::Value::Array(items.iter().map(|i| plain(i.get_ref())).collect::<Option<_>>()?),
        DeValue::Float(number) => toml::Value::Float(number.as_str().replace('_', "").parse().ok()?),
        DeValue::Datetime(_) | DeValue::Table(_) => return None,
    })
}

fn range(table: &Table, from: &Value, key: &Key) -> Read<Spread> {
    let right = format!("add steps = 9, the number of values with both ends, from 2 to {MOST_STEPS}");
    let steps = table.require("steps", &right)?;
    let steps = match steps.number(MOST_STEPS, |n| format!("steps is {n}"), &right)? {
        1 => return Err(steps.wrong("steps is 1", right)),
        steps => steps,
    };
    let to = table.require("to", "add to, the last value")?;
    let Measure { of: dimension, sign, share } = measure(key, from)?;
    let ends = [from.amount_of(dimension, sign, share)?, to.amount_of(dimension, sign, share)?];
    let ([Amount::Si(low), Amount::Si(high)] | [Amount::Share(low), Amount::Share(high)]) = ends else {
        return Err(to.wrong("one end is a share and the other is none", "give both in the same way"));
    };
    let share = matches!(ends[0], Amount::Share(_));
    // The last value is the one that was written, without a rounding.
    let at = |i: usize| if i + 1 == steps { high } else { low + (high - low) * (i as f64 / (steps - 1) as f64) };
    Ok(Spread::Values((0..steps).map(|i| super::spread::written(at(i), dimension, share)).collect()))
}

fn measure(key: &Key, at: &Value) -> Read<Measure> {
    key.measure()
        .ok_or_else(|| at.wrong(format!("{key} has no unit, so no range and no distribution"), "list its values"))
}

fn law(table: &Table, name: &Value, key: &Key) -> Read<Spread> {
    let Measure { of: dimension, sign: possible, share: takes_share } = measure(key, name)?;
    let not_negative = matches!(possible, Sign::Positive | Sign::NotNegative);
    let word = name.word()?;
    let mut share = None;
    let mut quantity = |key: &'static str, sign: Sign| -> Read<f64> {
        let value = table.require(key, &format!("a {word} distribution has {}", parameters(word)))?;
        let (amount, is_share) = match value.amount_of(dimension, sign, takes_share)? {
            Amount::Si(x) => (x, false),
            Amount::Share(x) => (x, true),
        };
        if *share.get_or_insert(is_share) != is_share {
            return Err(value.wrong("one parameter is a share and another is none", "give all in the same way"));
        }
        Ok(amount)
    };
    let law = match word {
        "uniform" => Distribution::Uniform { low: quantity("low", Sign::Any)?, high: quantity("high", Sign::Any)? },
        "normal" => Distribution::Normal { mean: quantity("mean", Sign::Any)?, sd: quantity("sd", Sign::Positive)? },
        "lognormal" => Distribution::lognormal(quantity("mean", Sign::Positive)?, quantity("sd", Sign::Positive)?),
        "weibull" => {
            let scale = quantity("scale", Sign::Positive)?;
            let location = if table.get("location").is_some() { quantity("location", Sign::Any)? } else { 0.0 };
            let shape =
                table.require("shape", "add shape, the Weibull modulus, a number without a unit")?.positive()?;
            Distribution::Weibull { location, scale, shape }
        }
        _ => {
            let (low, mode) = (quantity("low", Sign::Any)?, quantity("mode", Sign::Any)?);
            Distribution::Triangular { low, mode, high: quantity("high", Sign::Any)? }
        }
    };
    if !law.is_ordered() {
        return Err(
            name.wrong("the limits of the distribution are not in order", "low is below high, and mode between")
        );
    }
    only(table, word);
    let spread = Spread::Distribution { law, dimension, share: share.unwrap_or(false), not_negative };
    let impossible = spread.impossible();
    if impossible > LARGEST_IMPOSSIBLE {
        let what = if possible == Sign::Positive { "zero or below" } else { "below zero" };
        let percent = 100.0 * impossible;
        // Three digits, however small it is.
        let decimals = (2.0 - percent.log10().floor()).max(0.0) as usize;
        let title = format!("{percent:.decimals$} % of this distribution is {what}, where no {} can be", key.leaf);
        return Err(
            name.wrong(title, "use one that stays above zero: lognormal, weibull, or triangular with low above zero")
        );
    }
    Ok(spread)
}

fn parameters(word: &str) -> String {
    VARY.variants().iter().filter(|v| v.word == word).flat_map(|v| v.own).copied().collect::<Vec<_>>().join(", ")
}

/// Notes parameters that belong to another distribution.
fn only(table: &Table, word: &str) {
    let of_a_range = ["to", "steps"];
    for key in VARY.foreign(word).map(|(key, _)| key).chain(of_a_range) {
        if let Some(span) = table.key_span(key) {
            let help = format!("a {word} distribution has {}", parameters(word));
            table.note_at(span, format!("{key} is no parameter of a {word} distribution"), help);
        }
    }
}
