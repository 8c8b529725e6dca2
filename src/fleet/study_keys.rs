//! The keys of a study file.

use super::key::Key as Path;
use crate::keys::{Key, Kind, Shape, Sign, Variant};

/// More variations of a train than this are refused.
pub(super) const MOST_VARIATIONS: usize = 10_000_000;
/// More values of a range than this are refused.
pub(super) const MOST_STEPS: usize = 1_000_000;
pub(super) const LARGEST_SEED: usize = u32::MAX as usize;

/// The whole file.
pub(crate) static STUDY: Shape = Shape::new(
    "the study file",
    "A study for trainsafe fleet: train files, and what to vary in them.",
    &[
        Key::required(
            "trains",
            Kind::OneOrMore(&Kind::Name),
            "Train files, folders or globs, from this file's folder.",
            "[\"trains/*.toml\"]",
        ),
        Key::optional(
            "samples",
            Kind::Whole { from: 1, to: MOST_VARIATIONS },
            "How many variations of each train are drawn; every combination of the lists and ranges if absent.",
            "10000",
        ),
        Key::optional("seed", Kind::Whole { from: 1, to: LARGEST_SEED }, "Seed of the draws; with samples.", "7")
            .or("1"),
        Key::optional(
            "latin_hypercube",
            Kind::Flag,
            "Whether the draws of each key are spread evenly over its distribution; with samples.",
            "true",
        )
        .or("false"),
        Key::required(
            "vary",
            Kind::Tables(&VARY),
            "The keys to vary.",
            "[{ key = \"load.uniform\", values = [\"0.6 MN\"] }]",
        ),
    ],
);

const PARAMETER: Kind = Kind::AnyQuantity(Sign::Any);

pub(super) static VARY: Shape = Shape {
    exactly_one: &["values", "from", "distribution"],
    variants: Some((
        "distribution",
        &[
            Variant { word: "uniform", own: &["low", "high"], needs: &[&["low", "high"]] },
            Variant { word: "normal", own: &["mean", "sd"], needs: &[&["mean", "sd"]] },
            Variant { word: "lognormal", own: &["mean", "sd"], needs: &[&["mean", "sd"]] },
            Variant { word: "weibull", own: &["scale", "shape", "location"], needs: &[&["scale", "shape"]] },
            Variant { word: "triangular", own: &["low", "mode", "high"], needs: &[&["low", "mode", "high"]] },
        ],
    )),
    ..Shape::new(
        "[[vary]]",
        "A key of the train files, and what it ranges over: a list, a range or a distribution.",
        &[
            Key::required(
                "key",
                Kind::Pattern(Path::pattern),
                "The key; lists of tables are indexed from 0: \"vehicle[1].mass\" is of the second [[vehicle]].",
                "coupler.rated_load",
            ),
            Key::optional("values", Kind::OneOrMore(&Kind::AnyValue), "A list of values.", "[\"0.5 MN\", \"0.6 MN\"]"),
            Key::optional("from", PARAMETER, "The first value of a range.", "0.4 MN"),
            Key::optional("to", PARAMETER, "The last value of a range.", "0.8 MN"),
            Key::optional(
                "steps",
                Kind::Whole { from: 2, to: MOST_STEPS },
                "How many values a range has, with both ends.",
                "5",
            ),
            Key::optional(
                "distribution",
                Kind::Word(&["uniform", "normal", "lognormal", "weibull", "triangular"]),
                "The distribution to draw from; with samples.",
                "weibull",
            ),
            Key::optional("low", PARAMETER, "Lower limit of a uniform or triangular distribution.", "1.2 MN"),
            Key::optional("high", PARAMETER, "Upper limit of a uniform or triangular distribution.", "1.8 MN"),
            Key::optional("mean", PARAMETER, "Mean of a normal or lognormal distribution.", "1.5 MN"),
            Key::optional(
                "sd",
                Kind::AnyQuantity(Sign::Positive),
                "Standard deviation of a normal or lognormal distribution.",
                "0.1 MN",
            ),
            Key::optional("scale", Kind::AnyQuantity(Sign::Positive), "Scale of a Weibull distribution.", "1.5 MN"),
            Key::optional("shape", Kind::Positive, "Weibull modulus.", "12"),
            Key::optional("mode", PARAMETER, "Likeliest value of a triangular distribution.", "1.5 MN"),
            Key::optional("location", PARAMETER, "Smallest value of a Weibull distribution; zero if absent.", "0.5 MN"),
            Key::optional(
                "per",
                Kind::Word(&["train", "coupler", "vehicle"]),
                "Whether every coupler, for a key of [coupler], or every vehicle of a group, for a key of a [[vehicle]] table, has a draw of \
                 its own; with samples. What has a value of its own in the train file keeps it.",
                "coupler",
            )
            .or("train"),
        ],
    )
};
