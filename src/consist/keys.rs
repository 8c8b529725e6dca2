//! The keys of a train file.

use crate::keys::{Key, Kind, Shape, Sign, Variant};
use crate::train::{LIMITS, MOST_VEHICLES, SENSES};
use crate::units::{Dimension, UnitSystem};

/// The columns of a gear's table: what they are called first, and what they measure.
pub(super) const GEAR_COLUMNS: [(&str, Dimension, Sign); 3] = [
    ("travel", Dimension::Length, Sign::NotNegative),
    ("loading", Dimension::Force, Sign::NotNegative),
    ("unloading", Dimension::Force, Sign::Any),
];

/// Names of applications.
pub(super) const PRESETS: [&str; 3] = ["AAR", "UIC G", "UIC P"];

/// The columns of a build-up.
pub(super) const BUILD_UP: [(&str, Dimension, Sign); 2] =
    [("time", Dimension::Time, Sign::NotNegative), ("share", Dimension::Share, Sign::NotNegative)];

const fn quantity(of: Dimension, sign: Sign) -> Kind {
    Kind::Quantity { of, sign, share: false }
}

const fn or_share(of: Dimension, sign: Sign) -> Kind {
    Kind::Quantity { of, sign, share: true }
}

/// A gear: a file, or rows of travel, loading and unloading.
const GEAR_TABLE: Kind = Kind::Either(&[Kind::Name, Kind::Rows { of: &GEAR_COLUMNS, least: 2 }]);
/// A brake application: a named one, or its wave and build-up.
const APPLICATION: Kind = Kind::Either(&[Kind::Word(&PRESETS), Kind::Table(&APPLICATION_TABLE)]);
const RATING: Kind = quantity(Dimension::Force, Sign::Positive);
/// A coupler's or vehicle's number.
const NUMBER: Kind = Kind::Whole { from: 1, to: MOST_VEHICLES };
const NUMBERS: Kind = Kind::OneOrMore(&Kind::Either(&[NUMBER, Kind::Table(&BEHIND)]));

/// A coupler by the vehicle ahead of it.
pub(super) static BEHIND: Shape = Shape::new(
    "{ behind = ... }",
    "The coupler behind a vehicle.",
    &[Key::required("behind", Kind::Name, "The label of the vehicle ahead of the coupler.", "coal car 40")],
);

/// The whole file.
pub(crate) static TRAIN: Shape = Shape {
    exactly_one: &["vehicle", "vehicles"],
    ..Shape::new(
        "the train file",
        "A train for trainsafe: its vehicles and couplers, the load before the event, and what is to happen.",
        &[
            Key::optional("name", Kind::Name, "The train's name; the file's name if absent.", "Ore train"),
            Key::optional(
                "units",
                Kind::Word(&UnitSystem::NAMES),
                "The units of the report, of check and of warnings; those in which most quantities of this file are written if absent. The \
                 numbers in files for programs are always in SI.",
                "us",
            ),
            Key::optional(
                "damping_ratio",
                Kind::Ratio,
                "Share of critical damping of every mode of vibration, which no device in a train has; for breaks and rectangular \
                 pulses, and not beside a coupler's damping. The ratios published for draft gears, 0.14 to 0.26, are not this \
                 but c / 2 sqrt(k m) of dashpots: give [coupler] a damping for them.",
                "0.2",
            )
            .or("0"),
            Key::optional(
                "speed",
                quantity(Dimension::Speed, Sign::Positive),
                "The train's speed before the event, where brakes act: they pull backward only as long as a vehicle runs.",
                "50 km/h",
            ),
            Key::required(
                "coupler",
                Kind::Table(&COUPLER),
                "Every coupler, unless [[coupler_override]] or the table of vehicles says otherwise.",
                "{ stiffness = \"30 MN/m\", rated_load = \"1.5 MN\" }",
            ),
            Key::optional(
                "vehicle",
                Kind::Tables(&VEHICLE),
                "The vehicles in order from the head, alike ones as a group with count; at least two vehicles in all.",
                "[{ mass = \"195 t\" }, { count = 104, mass = \"160 t\" }]",
            ),
            Key::optional(
                "vehicles",
                Kind::Name,
                "The vehicles as a table instead: a CSV file beside this one, a row for each, units in its header.",
                "consist.csv",
            ),
            Key::optional(
                "coupler_override",
                Kind::Tables(&OVERRIDE),
                "Couplers that differ from [coupler].",
                "[{ at = 53, rated_load = \"60 %\" }]",
            ),
            Key::optional(
                "load",
                Kind::Table(&LOAD),
                "The steady state before the event; no load if absent.",
                "{ uniform = \"0.6 MN\" }",
            ),
            Key::optional(
                "scenario",
                Kind::Tables(&SCENARIO),
                "What is to happen; each coupler breaks in turn if absent.",
                "[{ kind = \"break\", coupler = 1 }]",
            ),
        ],
    )
};

/// A coupler's keys beside `rated_load`.
const STIFFNESS: &str = "Stiffness of the whole connection between two vehicles: couplers and draft gears in series.";
const BUFF: Key = Key::optional(
    "rated_buff",
    or_share(Dimension::Force, Sign::Positive),
    "Capacity in buff (compression), or a share of the same coupler's capacity in draft; equal to that if absent.",
    "2.0 MN",
);
const OWN_LIMITS: Key = Key::optional(
    "limits",
    Kind::Table(&LIMITS_TABLE),
    "More capacities, in draft and in buff or in each; the report says which each coupler passes. In a cascade a coupler \
     breaks at its ultimate load.",
    "{ fatigue = \"0.9 MN\", proof = \"1.8 MN\", ultimate = \"2.9 MN\" }",
);
const STIFFNESS_IN_BUFF: Key = Key::optional(
    "stiffness_in_buff",
    quantity(Dimension::Stiffness, Sign::Positive),
    "Stiffness in buff, where it differs from that in draft; equal to it if absent.",
    "40 MN/m",
);
const SLACK: Key = Key::optional(
    "slack",
    quantity(Dimension::Length, Sign::NotNegative),
    "Free play between draft and buff, of the whole connection; none if absent.",
    "25 mm",
);
const GEAR: Key = Key::optional(
    "gear",
    GEAR_TABLE,
    "Instead of stiffness, the draft gears of the whole connection as a table of travel, force of loading and force of unloading: a \
     CSV file beside this one, or rows. The table counts from the end of the slack.",
    "gear.csv",
);
const GEAR_IN_BUFF: Key = Key::optional(
    "gear_in_buff",
    GEAR_TABLE,
    "The table in buff where it differs, as with side buffers, its travel and forces positive; that of draft if absent.",
    "buffers.csv",
);
const FRICTION: Key = Key::optional(
    "friction",
    quantity(Dimension::Share, Sign::NotNegative),
    "Of a gear whose table has no unloading: the share by which unloading lies under loading.",
    "75 %",
);
const SOLID: Key = Key::optional(
    "solid_stiffness",
    quantity(Dimension::Stiffness, Sign::Positive),
    "Stiffness of what is in series with the gear: bodies and yokes, with the wedges locked or the gear closed; needed with a gear.",
    "200 MN/m",
);
const DAMPING: Key = Key::optional(
    "damping",
    quantity(Dimension::Damping, Sign::NotNegative),
    "A dashpot c beside each connection's spring; none if absent. Published damping ratios z of draft gears are this: \
     c = 2 z sqrt(k m).",
    "200 kN*s/m",
);

pub(super) static COUPLER: Shape = Shape {
    at_most_one: &["stiffness", "gear"],
    ..Shape::new(
        "[coupler]",
        "Every coupler: the whole connection between two vehicles as one linear spring, or as a gear with friction, with two ratings.",
        &[
            Key::optional("stiffness", quantity(Dimension::Stiffness, Sign::Positive), STIFFNESS, "30 MN/m"),
            Key::required("rated_load", RATING, "Capacity in draft (tension).", "1.5 MN"),
            BUFF,
            OWN_LIMITS,
            DAMPING,
            STIFFNESS_IN_BUFF,
            SLACK,
            GEAR,
            GEAR_IN_BUFF,
            FRICTION,
            SOLID,
        ],
    )
};

pub(super) static OVERRIDE: Shape = Shape {
    least: 2,
    ..Shape::new(
        "[[coupler_override]]",
        "Couplers that differ: their numbers, and any key of [coupler].",
        &[
            Key::required(
                "at",
                NUMBERS,
                "The couplers' numbers: coupler i is between vehicle i and i+1, counted from 1 at the head. Or { behind = \"car 40\" }, \
                 the coupler behind the vehicle with that label.",
                "[53]",
            ),
            Key::optional("stiffness", quantity(Dimension::Stiffness, Sign::Positive), STIFFNESS, "25 MN/m"),
            Key::optional(
                "rated_load",
                or_share(Dimension::Force, Sign::Positive),
                "Capacity in draft (tension), or a share of [coupler]'s.",
                "60 %",
            ),
            BUFF,
            OWN_LIMITS,
            DAMPING,
            STIFFNESS_IN_BUFF,
            SLACK,
            GEAR,
            GEAR_IN_BUFF,
            FRICTION,
            SOLID,
        ],
    )
};

const FATIGUE: Key = Key::optional(LIMITS[0], RATING, "The force that the coupler bears again and again.", "0.9 MN");
const PROOF: Key = Key::optional(LIMITS[1], RATING, "The force that leaves no lasting deformation.", "1.8 MN");
const ULTIMATE: Key = Key::optional(
    LIMITS[2],
    RATING,
    "The force at which the coupler breaks, also in a cascade; if absent, a cascade uses the rating.",
    "2.9 MN",
);

pub(super) static LIMITS_TABLE: Shape = Shape {
    least: 1,
    ..Shape::new(
        "limits",
        "Capacities beside the rating: of both senses, or of draft or buff alone. In rising order: fatigue, proof, ultimate.",
        &[
            FATIGUE,
            PROOF,
            ULTIMATE,
            Key::optional(
                SENSES[0],
                Kind::Table(&LIMITS_IN_DRAFT),
                "Those in draft, where they differ.",
                "{ ultimate = \"2.9 MN\" }",
            ),
            Key::optional(
                SENSES[1],
                Kind::Table(&LIMITS_IN_BUFF),
                "Those in buff, where they differ.",
                "{ ultimate = \"3.5 MN\" }",
            ),
        ],
    )
};

static LIMITS_IN_DRAFT: Shape = Shape {
    least: 1,
    ..Shape::new("limits.draft", "Capacities in draft beside the rating.", &[FATIGUE, PROOF, ULTIMATE])
};

static LIMITS_IN_BUFF: Shape = Shape {
    least: 1,
    ..Shape::new("limits.buff", "Capacities in buff beside the rating.", &[FATIGUE, PROOF, ULTIMATE])
};

/// Two keys that a vehicle may have of its own, and the load for all.
const RESISTANCE: Key = Key::optional(
    "rolling_resistance",
    quantity(Dimension::Resistance, Sign::NotNegative),
    "Running resistance, backward, in proportion to the mass; a vehicle's own value replaces that of [load].",
    "15 N/t",
);
const GRADE: Key = Key::optional(
    "grade",
    quantity(Dimension::Grade, Sign::Any),
    "Grade of the track, uphill positive; a vehicle's own value replaces that of [load].",
    "1.2 %",
);

pub(super) static VEHICLE: Shape = Shape::new(
    "[[vehicle]]",
    "A vehicle, or several alike that follow each other.",
    &[
        Key::optional(
            "label",
            Kind::Name,
            "What reports call it, numbered where the train has it more than once; \"vehicle 1\" and so on if absent.",
            "ore car",
        ),
        Key::optional("count", NUMBER, "How many alike follow each other.", "104").or("1"),
        Key::required("mass", quantity(Dimension::Mass, Sign::Positive), "Mass of each.", "160 t"),
        Key::optional(
            "held",
            Kind::Flag,
            "It keeps its speed whatever the couplers do; the first and the last vehicle of the train only.",
            "true",
        )
        .or("false"),
        Key::optional(
            "length",
            quantity(Dimension::Length, Sign::Positive),
            "Length over couplers, for places along the train and speeds in m/s.",
            "10.9 m",
        ),
        Key::optional(
            "tractive_effort",
            quantity(Dimension::Force, Sign::Any),
            "Force of its drive, forward positive, negative in dynamic braking; not on a held vehicle.",
            "420 kN",
        ),
        RESISTANCE,
        GRADE,
        Key::optional(
            "brake_force",
            quantity(Dimension::Force, Sign::NotNegative),
            "Force of its brakes, backward; not on a held vehicle.",
            "10 kN",
        ),
        Key::optional(
            "emergency_brake",
            quantity(Dimension::Force, Sign::NotNegative),
            "Its full brake force in an emergency application, backward, beyond what its brakes give before; not on a held vehicle.",
            "45 kN",
        ),
    ],
);

/// How a brake application runs through the train and builds up in a vehicle.
pub(super) static APPLICATION_TABLE: Shape = Shape::new(
    "{ wave = ..., build_up = ... }",
    "A brake application: how fast it runs along the train, and how the force of a vehicle's brakes builds up once it is there.",
    &[
        Key::required(
            "wave",
            quantity(Dimension::Speed, Sign::Positive),
            "How fast the application runs along the train, both ways.",
            "290 m/s",
        ),
        Key::required(
            "build_up",
            Kind::Rows { of: &BUILD_UP, least: 2 },
            "Times since it reached the vehicle, each with the share of emergency_brake that acts then, straight lines between.",
            "[[\"0 s\", \"0 %\"], [\"1.5 s\", \"30 %\"], [\"8 s\", \"100 %\"]]",
        ),
    ],
);

/// How tractive efforts fall to zero.
pub(super) static CUT_POWER: Shape = Shape::new(
    "{ after = ..., over = ... }",
    "Tractive efforts that fall to zero in a straight line.",
    &[
        Key::required(
            "after",
            quantity(Dimension::Time, Sign::NotNegative),
            "When they begin to fall, after the event.",
            "3 s",
        ),
        Key::optional("over", quantity(Dimension::Time, Sign::NotNegative), "How long they fall.", "2 s").or("0 s"),
    ],
);

pub(super) static LOAD: Shape = Shape::new(
    "[load]",
    "The steady state before the event: uniform, or the forces on the vehicles from which the couplers' follow.",
    &[
        Key::optional(
            "uniform",
            or_share(Dimension::Force, Sign::Any),
            "The force in every coupler, draft positive, or a share of the weakest coupler's capacity in draft.",
            "0.6 MN",
        ),
        RESISTANCE,
        GRADE,
        Key::optional(
            "pulled_to",
            or_share(Dimension::Force, Sign::Positive),
            "The largest pull before, which was then reduced to this load, or a share of the weakest coupler's capacity in \
             draft: couplers with friction remember it. The load itself if absent. Where the load follows from forces on the vehicles it is that \
             of the coupler that pulls most, and the others pulled more in the same proportion.",
            "0.8 MN",
        ),
    ],
);

pub(super) static SCENARIO: Shape = Shape {
    variants: Some((
        "kind",
        &[
            Variant {
                word: "break",
                own: &["coupler", "emergency", "cut_power", "throttle"],
                needs: &[&["coupler"]],
            },
            Variant {
                word: "pulse",
                own: &["at", "force", "duration", "shape", "rise", "fall", "record"],
                needs: &[&["at", "force", "duration"], &["at", "record"]],
            },
            Variant { word: "impact", own: &["at", "vehicles", "speed"], needs: &[&["at", "vehicles", "speed"]] },
            Variant {
                word: "brake",
                own: &["at", "emergency", "service", "cut_power", "throttle"],
                needs: &[&["at", "emergency"], &["at", "service"]],
            },
        ],
    )),
    ..Shape::new(
        "[[scenario]]",
        "Something that happens to the train: a coupler breaks, a force strikes a vehicle, vehicles run into an end, brakes are \
         applied.",
        &[
            Key::optional("name", Kind::Name, "Made from what happens if absent.", "the knuckle breaks"),
            Key::required("kind", Kind::Word(&["break", "pulse", "impact", "brake"]), "What happens.", "break"),
            Key::optional(
                "coupler",
                Kind::Either(&[Kind::Word(&["each"]), NUMBERS]),
                "Of a break: the coupler's number or { behind = \"car 40\" }, the label of the vehicle ahead of it; a list of them in turn, \
                 or \"each\".",
                "53",
            ),
            Key::optional(
                "at",
                Kind::Either(&[Kind::Word(&["head", "tail"]), NUMBER, Kind::Name]),
                "Of a pulse, the vehicle that is struck: \"head\", \"tail\", its number or its label. Of an impact, the end that is \
                 struck: \"head\" or \"tail\". Of a brake application, where it starts: \"head\", \"tail\", \"both ends\", or a vehicle.",
                "tail",
            ),
            Key::optional(
                "force",
                or_share(Dimension::Force, Sign::NonZero),
                "Of a pulse: the outside force on that vehicle, forward positive, or a share of the weakest coupler's \
                 capacity in draft.",
                "-1.2 MN",
            ),
            Key::optional(
                "duration",
                quantity(Dimension::Time, Sign::Positive),
                "Of a pulse: how long the force acts.",
                "60 ms",
            ),
            Key::optional(
                "shape",
                Kind::Word(&["rectangle", "half-sine", "triangle", "trapezoid"]),
                "Of a pulse: the force over time.",
                "trapezoid",
            )
            .or("rectangle"),
            Key::optional(
                "rise",
                quantity(Dimension::Time, Sign::Positive),
                "Of a trapezoid, which needs it: the time until the force is full.",
                "10 ms",
            ),
            Key::optional(
                "fall",
                quantity(Dimension::Time, Sign::Positive),
                "Of a trapezoid: the time from the full force to none; as long as the rise if absent.",
                "20 ms",
            ),
            Key::optional(
                "record",
                Kind::Name,
                "Of a pulse, instead of force, duration and shape: a CSV file beside this one with the columns \
                 time_ms,force_kn (or other units).",
                "pulse.csv",
            ),
            Key::optional(
                "vehicles",
                NUMBER,
                "Of an impact: how many of the train's vehicles arrive together, and couple; at least one stands. The load of \
                 either part stays, and the coupler that joins them carries none before.",
                "3",
            ),
            Key::optional(
                "speed",
                quantity(Dimension::Speed, Sign::Positive),
                "Of an impact: how fast they arrive.",
                "6 mph",
            ),
            Key::optional(
                "emergency",
                APPLICATION,
                "Of a break: the emergency application that each parting sets off, both ways. Of a brake application: an emergency one. A \
                 named one (\"AAR\", \"UIC G\", \"UIC P\") or its wave and build-up; needs lengths, emergency_brake and the train's speed.",
                "{ wave = \"290 m/s\", build_up = [[\"0 s\", \"0 %\"], [\"8 s\", \"100 %\"]] }",
            ),
            Key::optional(
                "service",
                APPLICATION,
                "Of a brake application: a service one, in the same way; its build-up is a share of emergency_brake as well.",
                "AAR",
            ),
            Key::optional(
                "cut_power",
                Kind::Table(&CUT_POWER),
                "Tractive efforts that pull fall to zero.",
                "{ after = \"3 s\", over = \"2 s\" }",
            ),
            Key::optional(
                "throttle",
                Kind::Name,
                "Tractive efforts after the event: a CSV file beside this one with the columns time [s] and share [%] or force [kN], and \
                 vehicle where not all are meant.",
                "throttle.csv",
            ),
            Key::optional(
                "horizon",
                quantity(Dimension::Time, Sign::Positive),
                "How long forces are followed; if absent, to the last change of the outside force and four transits of a wave \
                 through the longest part beyond it.",
                "8 s",
            ),
            Key::optional(
                "cascade",
                Kind::Flag,
                "Couplers that pass their ultimate load in draft, or their rating where none is given, break, one after the \
                 other; else they are reported.",
                "true",
            )
            .or("false"),
            Key::optional(
                "buff_breaks",
                Kind::Flag,
                "Couplers in buff break as well: in a cascade, and, in a train without slack and gears, of a break the couplers \
                 that carry buff, as if the parts could pass through each other; else these are refused or left out of \"each\".",
                "true",
            )
            .or("false"),
        ],
    )
};
