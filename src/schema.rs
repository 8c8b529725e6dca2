//! JSON Schemas of the files that people write, so that editors complete and check them.
//!
//! They are made from the tables that the reader uses. A schema can express neither other files nor arithmetic: it
//! accepts some files that the reader refuses (a coupler that the train does not have). It refuses no file that the
//! reader accepts. Only keywords that have the same meaning in all drafts in use are in it: TOML's language servers
//! know old ones.

use serde_json::{Map, Value, json};

use crate::consist::keys::TRAIN;
use crate::fleet::study_keys::STUDY;
use crate::keys::{Key, Kind, LONGEST_NAME, Shape, Sign, Variant};
use crate::units::{self, Dimension};

/// The schema of a train file.
pub fn train() -> Value {
    whole(&TRAIN)
}

/// The schema of a study file.
pub fn study() -> Value {
    whole(&STUDY)
}

/// The text of the schema of a study file, or of a train file.
pub fn text(of_studies: bool) -> String {
    format!("{:#}\n", if of_studies { study() } else { train() })
}

fn whole(shape: &Shape) -> Value {
    let mut schema = json!({ "$schema": "https://json-schema.org/draft/2020-12/schema", "title": shape.name });
    append(&mut schema, table(shape));
    schema
}

/// Adds the entries of one object to another; those that are there stay.
fn append(to: &mut Value, from: Value) {
    if let (Value::Object(to), Value::Object(from)) = (to, from) {
        from.into_iter().for_each(|(name, value)| {
            to.entry(name).or_insert(value);
        });
    }
}

fn table(shape: &Shape) -> Value {
    let properties: Map<String, Value> =
        shape.keys.iter().map(|key| (key.name.to_owned(), property(shape, key))).collect();
    let required: Vec<&str> = shape.keys.iter().filter(|key| key.required).map(|key| key.name).collect();
    let mut schema = json!({ "description": shape.about, "type": "object", "properties": properties });
    let mut add = |name: &str, value: Value| schema[name] = value;
    add("additionalProperties", json!(false));
    if !required.is_empty() {
        add("required", json!(required));
    }
    if shape.least > required.len() {
        add("minProperties", json!(shape.least));
    }
    if !shape.exactly_one.is_empty() {
        let choices = shape.exactly_one.iter().map(|key| json!({ "required": [key] }));
        add("oneOf", choices.collect());
    }
    if !shape.at_most_one.is_empty() {
        add("not", json!({ "required": shape.at_most_one }));
    }
    if let Some((key, variants)) = shape.variants {
        add("allOf", variants.iter().map(|v| rule(shape, key, v)).collect());
    }
    schema
}

/// What a table must and cannot have once its key has this word.
fn rule(shape: &Shape, key: &str, variant: &Variant) -> Value {
    let foreign: Map<String, Value> =
        shape.foreign(variant.word).map(|(key, _)| (key.to_owned(), json!(false))).collect();
    let needs: Vec<Value> = variant.needs.iter().map(|set| json!({ "required": set })).collect();
    json!({
        "if": { "properties": { key: { "const": variant.word } }, "required": [key] },
        "then": { "properties": foreign, "oneOf": needs },
    })
}

fn property(shape: &Shape, key: &Key) -> Value {
    let mut words = vec![key.about.to_owned()];
    words.extend(units_of(key.kind));
    if !key.default.is_empty() {
        words.push(format!("{} if absent.", key.default));
    }
    let within = if shape.name.starts_with('[') { format!("{} ", shape.name) } else { String::new() };
    let title = within + key.name;
    let mut schema = json!({ "title": title, "description": words.join(" ") });
    if !key.default.is_empty() {
        schema["default"] = literal(key.default);
    }
    schema["examples"] = json!([literal(key.example)]);
    append(&mut schema, value(key.kind));
    schema
}

/// A TOML value, or a string without its quotes.
fn literal(text: &str) -> Value {
    let parsed = format!("x = {text}").parse::<toml::Table>().ok().and_then(|mut t| t.remove("x"));
    parsed.and_then(|v| serde_json::to_value(v).ok()).unwrap_or_else(|| json!(text))
}

/// The units that a value has, as a sentence.
fn units_of(kind: Kind) -> Option<String> {
    match kind {
        Kind::Quantity { of, share, .. } => {
            Some(format!("A {of} in {}{}.", of.choices(), if share { ", or a share in %" } else { "" }))
        }
        Kind::AnyQuantity(_) => Some("In a unit of what the key measures, or in %.".to_owned()),
        _ => None,
    }
}

fn value(kind: Kind) -> Value {
    match kind {
        Kind::Quantity { of, sign, share } => {
            let share = (share && !of.is_in_per_cent()).then(units::per_cent_pattern);
            string(&quantity(sign, std::iter::once(of.pattern()).chain(share)))
        }
        Kind::AnyQuantity(sign) => string(&quantity(sign, Dimension::ALL.into_iter().map(Dimension::pattern))),
        Kind::Positive => json!({ "type": "number", "exclusiveMinimum": 0 }),
        Kind::Ratio => json!({ "type": "number", "minimum": 0, "exclusiveMaximum": 1 }),
        Kind::Whole { from, to } => json!({ "type": "integer", "minimum": from, "maximum": to }),
        Kind::Name => {
            // Something other than white space, and no control character.
            let mut schema = string(&format!("^[^{CONTROL}]*[^{CONTROL}\\s][^{CONTROL}]*$"));
            schema["maxLength"] = json!(LONGEST_NAME);
            schema
        }
        Kind::Pattern(of) => string(&of()),
        Kind::Flag => json!({ "type": "boolean" }),
        Kind::Word(words) => json!({ "type": "string", "enum": words }),
        Kind::AnyValue => json!({ "type": ["string", "number", "boolean", "array"] }),
        Kind::Either(kinds) => json!({ "anyOf": kinds.iter().map(|kind| value(*kind)).collect::<Vec<_>>() }),
        Kind::OneOrMore(kind) => {
            let one = value(*kind);
            json!({ "anyOf": [one, { "type": "array", "items": one, "minItems": 1 }] })
        }
        Kind::Rows { of, least } => {
            let cell: Vec<Value> =
                of.iter().map(|(_, of, sign)| string(&quantity(*sign, [of.pattern()].into_iter()))).collect();
            let row = json!({ "type": "array", "minItems": least, "maxItems": of.len(), "items": { "anyOf": cell } });
            json!({ "type": "array", "items": row, "minItems": 2 })
        }
        Kind::Table(shape) => table(shape),
        Kind::Tables(shape) => json!({ "type": "array", "items": table(shape) }),
    }
}

const CONTROL: &str = "\\x00-\\x1f\\x7f-\\x9f";

fn string(pattern: &str) -> Value {
    json!({ "type": "string", "pattern": pattern })
}

/// A regular expression of a number with a unit of one of these patterns.
fn quantity(sign: Sign, units: impl Iterator<Item = String>) -> String {
    let any = "([0-9]+\\.?[0-9]*|\\.[0-9]+)";
    let nonzero = "([0-9]*[1-9][0-9]*\\.?[0-9]*|[0-9]*\\.[0-9]*[1-9][0-9]*)";
    let number = match sign {
        Sign::Positive => format!("\\+?{nonzero}"),
        Sign::NonZero => format!("[+-]?{nonzero}"),
        // Minus zero is zero.
        Sign::NotNegative => format!("(\\+?{any}|-(0+\\.?0*|\\.0+))"),
        Sign::Any => format!("[+-]?{any}"),
    };
    let units: Vec<String> = units.collect();
    format!("^\\s*{number}([eE][+-]?[0-9]+)?\\s*({})\\s*$", units.join("|"))
}
