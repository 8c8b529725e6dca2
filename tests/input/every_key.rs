//! Nothing that is stated is lost: each key of a train file or study, each column of a table of vehicles and each option changes the
//! answer or the doubts, or is refused by name, in every kind of train that may have it. The lists of keys are the schema's: a key
//! without a sample fails.

mod bases;
mod samples;

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use rayon::prelude::*;
use serde_json::Value;
use tempfile::TempDir;
use trainsafe::{Options, Train, analyze, consist, findings, schema};

/// What a file says of itself or how it was computed, and what only repeats a key.
const ECHOES: [&str; 11] = [
    "program",
    "date",
    "inputs",
    "options",
    "method",
    "method_reason",
    "run_time_s",
    "tolerance_n",
    "horizon_s",
    "rated_draft_n",
    "rated_buff_n",
];

fn without_echoes(value: &mut Value) {
    match value {
        Value::Object(fields) => {
            fields.retain(|name, _| !ECHOES.contains(&name.as_str()));
            fields.values_mut().for_each(without_echoes);
        }
        Value::Array(items) => items.iter_mut().for_each(without_echoes),
        _ => {}
    }
}

/// The answer with its doubts and notes of options, or the complaint.
fn answer(train: Result<Train, String>, options: &Options) -> Result<String, String> {
    let train = train?;
    let analysis = analyze(&train, options).map_err(|e| e.to_string())?;
    let mut value = serde_json::to_value(&analysis).expect("JSON");
    without_echoes(&mut value);
    Ok(value.to_string() + &findings::idle_options(&train, options).join("\n"))
}

fn of_text(text: &str, folder: &Path) -> Result<String, String> {
    let train = consist::parse(text, &folder.join("train.toml")).map_err(|e| e.to_string());
    answer(train, &Options::default())
}

fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in bases::BESIDE {
        fs::write(folder.path().join(name), text).expect("a file");
    }
    folder
}

/// The leaves below a schema as samples name them, with the words that a key may have.
fn leaves(schema: &Value, path: &str, into: &mut BTreeSet<String>) {
    let Some(properties) = schema["properties"].as_object() else { return };
    let kinds: Vec<&Value> = schema["allOf"].as_array().into_iter().flatten().collect();
    if kinds.is_empty() {
        properties.iter().for_each(|(key, property)| leaf(property, &format!("{path}{key}"), into));
    }
    for rule in kinds {
        let (by, word) = rule["if"]["properties"].as_object().and_then(|o| o.iter().next()).expect("a word");
        let word = word["const"].as_str().expect("a word");
        for (key, property) in properties.iter().filter(|(key, _)| *key != by) {
            if rule["then"]["properties"].get(key).is_none() {
                let within = path.strip_suffix("[].").expect("a list of tables");
                leaf(property, &format!("{within}[{word}].{key}"), into);
            }
        }
    }
}

fn leaf(property: &Value, path: &str, into: &mut BTreeSet<String>) {
    let (mut tables, mut words, mut others) = (vec![], vec![], false);
    let mut open = vec![property];
    while let Some(schema) = open.pop() {
        let alternatives = schema["anyOf"].as_array();
        open.extend(alternatives.into_iter().flatten());
        if schema["properties"].is_object() {
            tables.push((schema, false));
        } else if schema["items"]["properties"].is_object() {
            tables.push((&schema["items"], true));
        } else if let Some(choices) = schema["enum"].as_array() {
            words.extend(choices.iter().filter_map(Value::as_str));
        } else if schema["items"].is_object() {
            open.push(&schema["items"]);
        } else {
            others |= alternatives.is_none();
        }
    }
    tables
        .iter()
        .for_each(|(table, is_list)| leaves(table, &format!("{path}{}.", if *is_list { "[]" } else { "" }), into));
    into.extend(words.iter().map(|word| format!("{path}={word}")));
    if others {
        into.insert(path.to_owned());
    }
}

#[test]
fn every_key_has_a_sample() {
    let mut keys = BTreeSet::new();
    leaves(&schema::train(), "", &mut keys);
    assert!(keys.len() > 60, "{keys:?}");
    let samples: BTreeSet<String> = samples::TRAIN.iter().map(|(path, _)| (*path).to_owned()).collect();
    let missing: Vec<_> = keys.difference(&samples).collect();
    assert!(missing.is_empty(), "add samples to tests/every_key/samples.rs: {missing:?}");
    // Of an impact "at" is a word alone, which no schema of one property says.
    let unknown: Vec<_> = samples.difference(&keys).collect();
    assert!(unknown.is_empty(), "no such keys: {unknown:?}");
    let kinds = schema::train()["properties"]["scenario"]["items"]["properties"]["kind"]["enum"].clone();
    for kind in kinds.as_array().expect("kinds") {
        let is_base = |(_, text): &(&str, String)| text.contains(&format!("kind = {kind}"));
        assert!(bases::all().iter().any(is_base), "add a base file with kind = {kind}");
    }
}

/// Sets a key where its table is there or can be, the last of a list; `false` where it cannot, or has that value already.
fn set(table: &mut toml::Table, path: &str, value: &toml::Value) -> bool {
    let (first, rest) = path.split_once('.').map_or((path, None), |(first, rest)| (first, Some(rest)));
    let Some(rest) = rest else {
        let key = first.split('=').next().unwrap_or_default().to_owned();
        return table.insert(key, value.clone()).as_ref() != Some(value);
    };
    let Some((name, kind)) = first.split_once('[') else {
        let inner = table.entry(first).or_insert_with(|| toml::Table::new().into());
        if !inner.is_table() {
            *inner = toml::Table::new().into();
        }
        return inner.as_table_mut().is_some_and(|inner| set(inner, rest, value));
    };
    let kind = kind.trim_end_matches(']');
    let Some(last) = table.get_mut(name).and_then(|list| list.as_array_mut()?.last_mut()?.as_table_mut()) else {
        return false;
    };
    let is_kind = last.get("kind").and_then(toml::Value::as_str).is_none_or(|other| other == kind);
    is_kind && set(last, rest, value)
}

fn value(text: &str) -> toml::Value {
    format!("x = {text}").parse::<toml::Table>().expect("TOML").remove("x").expect("a value")
}

/// Where a key changes nothing: with the reason.
const WITHOUT_EFFECT: &[(&str, &str, &str)] = &[
    ("scenario[pulse].shape=rectangle", "pulse", "the default"),
    ("scenario[pulse].shape=rectangle", "pulse, cascade", "the default"),
    ("speed", "emergency of a hauled train", "no vehicle stops"),
    ("speed", "emergency brakes", "no vehicle stops"),
    ("speed", "emergency brakes, throttle", "no vehicle stops"),
    ("speed", "emergency brakes, power cut", "no vehicle stops"),
    ("speed", "service brakes", "no vehicle stops"),
    ("coupler.rated_buff", "emergency brakes", "draft alone"),
    ("coupler.rated_buff", "service brakes", "draft alone"),
    ("coupler.gear_in_buff", "service brakes", "draft alone"),
    ("vehicle[].length", "gear, emergency", "of the last vehicle, which has no brakes"),
    ("vehicle[].length", "emergency of a hauled train", "of the last vehicle, which has no brakes"),
];

/// Samples that no base file takes alone: with the reason.
const NOT_ALONE: &[(&str, &str)] = &[
    ("scenario[impact].at", "an impact is at an end: a number is refused"),
    ("scenario[pulse].shape=trapezoid", "it needs a rise"),
];

#[test]
fn every_key_changes_the_answer_or_is_named() {
    let folder = folder();
    let bases = bases::all();
    let plain: Vec<String> = bases
        .par_iter()
        .map(|(name, text)| of_text(text, folder.path()).unwrap_or_else(|e| panic!("{name}: {e}")))
        .collect();
    let of_sample = |(path, text): &(&str, &str)| {
        if path.starts_with("units=") {
            // Of the text of reports alone, which is not compared here.
            return vec![];
        }
        let value = value(text);
        let (mut used, mut silent) = (0, vec![]);
        for ((name, base), plain) in bases.iter().zip(&plain) {
            let mut tree = base.parse::<toml::Table>().expect("TOML");
            if !set(&mut tree, path, &value) {
                continue;
            }
            let names_it =
                |message: &str| path.split(['.', '[', ']', '=']).any(|word| !word.is_empty() && message.contains(word));
            match of_text(&tree.to_string(), folder.path()) {
                Ok(answer) if answer == *plain => silent.push(format!("{path} = {text} in {name}")),
                Ok(_) => used += 1,
                Err(message) if names_it(&message) => {}
                Err(message) => silent.push(format!("{path} = {text} in {name} is not named by: {message}")),
            }
            let known = |(p, n, _): &&(&str, &str, &str)| p == path && n == name;
            if WITHOUT_EFFECT.iter().any(|entry| known(&entry)) {
                silent.pop().unwrap_or_else(|| panic!("{path} has an effect in {name}"));
            }
        }
        if used == 0 && NOT_ALONE.iter().all(|(other, _)| other != path) {
            silent.push(format!("{path} is used in no base file"));
        }
        silent
    };
    let silent: Vec<String> = samples::TRAIN.par_iter().flat_map(of_sample).collect();
    assert!(silent.is_empty(), "{}", silent.join("\n"));
}

#[test]
fn every_column_changes_the_answer_or_is_named() {
    let mut keys = BTreeSet::new();
    for table in ["vehicle", "coupler_override"] {
        leaves(&schema::train()["properties"][table]["items"], "", &mut keys);
    }
    let names: BTreeSet<String> = samples::COLUMNS.iter().map(|(name, ..)| (*name).to_owned()).collect();
    let missing: Vec<_> = keys.difference(&names).filter(|key| !key.starts_with("at")).collect();
    assert!(missing.is_empty(), "add samples to tests/every_key/samples.rs: {missing:?}");
    let (_, base) = bases::all().into_iter().find(|(name, _)| *name == "table").expect("a base");
    let without_uniform = base.replace("uniform = \"0.6 MN\"", "grade = \"1 %\"");
    // The locomotive, the cars and what follows; a count or a held vehicle is of the last alone.
    let answer = |heading: &str, cells: [&str; 3], base: &str| {
        let folder = folder();
        let head = if heading.is_empty() { String::new() } else { format!(";{heading}") };
        let cells = cells.map(|cell| if heading.is_empty() { String::new() } else { format!(";{cell}") });
        let rows = ["engine;190;1;yes", "car;90;6;", "caboose;60;1;"]
            .into_iter()
            .zip(cells)
            .map(|(row, cell)| row.to_owned() + &cell + "\n");
        let mut table = format!("label;mass [t];count;held{head}\n") + &rows.collect::<String>();
        for own in ["label", "mass [t]", "count", "held"] {
            // The column itself, not twice.
            if heading.to_lowercase().starts_with(own.split(' ').next().unwrap_or_default()) {
                table = table.replacen(own, "note", 1);
            }
        }
        fs::write(folder.path().join("consist.csv"), table).expect("a table");
        let shorter = |text: String| {
            text.replace(&folder.path().display().to_string(), "")
                .replace(&format!("column {heading}"), "column HEADING")
                .replace(&format!("\"{heading}\""), "\"HEADING\"")
        };
        of_text(base, folder.path()).map(shorter).map_err(shorter)
    };
    let mut silent = vec![];
    for (name, unit, value) in samples::COLUMNS {
        let base = if ["tractive_effort", "rolling_resistance", "grade", "brake_force"].contains(name) {
            &without_uniform
        } else {
            &base
        };
        let before = match *name {
            "mass" => ["190", "90", "60"],
            "count" => ["1", "6", "1"],
            "label" => ["engine", "car", "caboose"],
            "held" => ["yes", "", ""],
            "pos" => ["1", "2", "8"],
            _ => [""; 3],
        };
        let after = match *name {
            "pos" => ["1", "8", *value],
            _ => [before[0], if before[1].is_empty() && *name != "held" { value } else { before[1] }, value],
        };
        let upper = name.to_uppercase();
        let with_unit = |name: &str| match *unit {
            "" => vec![name.to_owned()],
            unit => vec![format!("{name} [{unit}]"), format!("{name} ({unit})"), format!("{name}_{unit}")],
        };
        let headings: Vec<String> = [*name, upper.as_str()].into_iter().flat_map(with_unit).collect();
        let first = answer(&headings[0], after, base);
        for heading in &headings {
            let (plain, found) = (answer(heading, before, base), answer(heading, after, base));
            if found == plain || found != first {
                silent.push(format!(
                    "{heading}: {}",
                    if found == plain { "changes nothing" } else { "is read in another way" }
                ));
            }
            let text = found.unwrap_or_else(|e| e);
            if text.contains("\"HEADING\"") && text.contains("not read") {
                silent.push(format!("{heading} is not read"));
            }
        }
    }
    assert!(silent.is_empty(), "{}", silent.join("\n"));
}
