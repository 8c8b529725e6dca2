//! Numbers with units, as in Open Rails' files: `90t`, `5.1e6N`, `20cm`.

/// What a number measures.
#[derive(Clone, Copy)]
pub(super) enum Of {
    Mass,
    Length,
    Force,
    Stiffness,
}

/// A number as a train file writes it, and in SI units.
pub(super) struct Read {
    pub(super) value: f64,
    pub(super) unit: &'static str,
    pub(super) si: f64,
}

/// A unit of the game in small letters, the factor to the train file's unit, that unit, and the factor from it to SI.
/// A mass in the place of a force stands for its weight.
type Unit = (&'static str, f64, &'static str, f64);

const POUND_KG: f64 = 0.453_592_37;
const POUND_N: f64 = 4.448_221_615_260_5;
const LONG_TON_T: f64 = 1.016_046_908_8;

const MASS: [Unit; 6] = [
    ("", 1.0, "kg", 1.0),
    ("kg", 1.0, "kg", 1.0),
    ("t", 1.0, "t", 1e3),
    ("t-uk", LONG_TON_T, "t", 1e3),
    ("t-us", 1.0, "ton_us", 2000.0 * POUND_KG),
    ("lb", 1.0, "lb", POUND_KG),
];
const LENGTH: [Unit; 7] = [
    ("", 1.0, "m", 1.0),
    ("m", 1.0, "m", 1.0),
    ("cm", 0.01, "m", 1.0),
    ("mm", 1.0, "mm", 1e-3),
    ("ft", 1.0, "ft", 0.3048),
    ("'", 1.0, "ft", 0.3048),
    ("in", 1.0, "in", 0.0254),
];
const FORCE: [Unit; 5] = [
    ("", 1.0, "N", 1.0),
    ("n", 1.0, "N", 1.0),
    ("kn", 1.0, "kN", 1e3),
    ("lbf", 1.0, "lbf", POUND_N),
    ("lb", 1.0, "lbf", POUND_N),
];
const STIFFNESS: [Unit; 4] = [
    ("", 1.0, "N/m", 1.0),
    ("n/m", 1.0, "N/m", 1.0),
    ("kn/m", 1.0, "kN/m", 1e3),
    ("lbf/in", 1.0, "lbf/in", POUND_N / 0.0254),
];

/// Reads a number with its unit; `None` for a sum or a product, and for a unit that is not known.
pub(super) fn read(text: &str, of: Of) -> Option<Read> {
    let units = match of {
        Of::Mass => &MASS[..],
        Of::Length => &LENGTH[..],
        Of::Force => &FORCE[..],
        Of::Stiffness => &STIFFNESS[..],
    };
    let text = text.trim().trim_end_matches(',').to_lowercase();
    // The longest start that is a number: of 1e6n it is 1e6.
    let end = (1..=text.len()).rev().find(|&end| {
        text.is_char_boundary(end)
            && text[..end].ends_with(|c: char| c.is_ascii_digit() || c == '.')
            && text[..end].parse::<f64>().is_ok_and(f64::is_finite)
    })?;
    let number: f64 = text[..end].parse().ok()?;
    let (_, factor, unit, si) = units.iter().find(|(written, ..)| *written == text[end..].trim())?;
    let value = number * factor;
    Some(Read { value, unit, si: value * si })
}
