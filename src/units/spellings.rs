//! The units and every way in which they may be written: data, and the one search that reads it.
//!
//! A unit is made of parts: `kip/in` is a force over a length. Each part stands once in [`PARTS`], with its size and its
//! spellings; [`forms`] says how the units of a dimension are put together. The reader and the patterns of the JSON Schema
//! ([`pattern`]) both go by these tables.
//!
//! Symbols of the metric system are taken in their own case only, because the case decides: `mN` is a thousandth of a
//! newton, `MN` a million newtons. Words and the symbols of US units are taken in any case.
//!
//! A pound is a pound of mass in a mass and a pound of force in a force, a stiffness, a damping or a resistance: `lb`,
//! `lbs`, `klb` and `klbs` are taken in all of them. `lbf`, `kip` and `klbf` are always forces. A `ton` is taken only in a
//! resistance in pounds per ton, where it is the US ton of 2000 lb.

use super::Dimension;

/// Size of a unit: `value in SI = number * 10^exponent * factor / divisor`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    pub exponent: i32,
    pub factor: f64,
    pub divisor: f64,
}

impl Scale {
    const ONE: Scale = Scale { exponent: 0, factor: 1.0, divisor: 1.0 };

    /// Whether the unit only moves the decimal point.
    pub fn is_decimal(&self) -> bool {
        self.factor == 1.0 && self.divisor == 1.0
    }

    fn times(self, other: Scale) -> Scale {
        Scale {
            exponent: self.exponent + other.exponent,
            factor: self.factor * other.factor,
            divisor: self.divisor * other.divisor,
        }
    }

    fn inverse(self) -> Scale {
        Scale { exponent: -self.exponent, factor: self.divisor, divisor: self.factor }
    }
}

/// What a part of a unit measures. Forces are of two kinds, because only newtons may be followed by `s` without a sign; so
/// they have symbols only: "newtons/m" would be a damping. Millinewtons are a force alone: in a stiffness they can only be
/// meant as meganewtons.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Of {
    Mass,
    UsTon,
    MetricForce,
    SmallForce,
    PoundForce,
    Time,
    Length,
    Speed,
    Slope,
}

/// A part of a unit.
struct Part {
    of: Of,
    scale: Scale,
    /// As messages write it.
    symbol: &'static str,
    /// More symbols, in this case only, as the first one.
    symbols: &'static [&'static str],
    /// Words, in any case.
    words: &'static [&'static str],
}

const fn part(
    of: Of,
    [factor, divisor]: [f64; 2],
    exponent: i32,
    symbol: &'static str,
    symbols: &'static [&'static str],
    words: &'static [&'static str],
) -> Part {
    Part { of, scale: Scale { exponent, factor, divisor }, symbol, symbols, words }
}

const ONE: [f64; 2] = [1.0, 1.0];
const POUND: [f64; 2] = [45_359_237.0, 1.0];
const TWO_POUNDS: [f64; 2] = [90_718_474.0, 1.0];
const POUND_FORCE: [f64; 2] = [44_482_216_152_605.0, 1.0];
const GRAVITY: [f64; 2] = [980_665.0, 1.0];

/// Every part. Two spellings of the same dimension never mean different sizes.
const PARTS: &[Part] = &[
    part(Of::Mass, ONE, 0, "kg", &[], &["kg", "kgs", "kilogram", "kilograms"]),
    part(Of::Mass, ONE, 3, "t", &[], &["tonne", "tonnes", "metric ton", "metric tons"]),
    part(Of::Mass, POUND, -8, "lb", &[], &["lb", "lbs", "lbm", "pound", "pounds"]),
    part(Of::Mass, POUND, -5, "klb", &[], &["klb", "klbs", "klbm"]),
    part(
        Of::Mass,
        TWO_POUNDS,
        -5,
        "ton_us",
        &[],
        &["ton_us", "tons_us", "us ton", "us tons", "short ton", "short tons"],
    ),
    part(Of::UsTon, TWO_POUNDS, -5, "ton_us", &[], &["ton", "tons"]),
    part(Of::MetricForce, ONE, 0, "N", &[], &[]),
    part(Of::SmallForce, ONE, -3, "mN", &[], &[]),
    part(Of::MetricForce, ONE, 1, "daN", &[], &[]),
    part(Of::MetricForce, ONE, 3, "kN", &[], &[]),
    part(Of::MetricForce, ONE, 6, "MN", &[], &[]),
    part(Of::PoundForce, POUND_FORCE, -13, "lbf", &[], &["lbf", "lb", "lbs", "pound", "pounds"]),
    part(Of::PoundForce, POUND_FORCE, -10, "kip", &[], &["kip", "kips", "klbf", "klb", "klbs"]),
    part(Of::PoundForce, GRAVITY, -5, "kgf", &[], &["kgf"]),
    part(Of::PoundForce, GRAVITY, -2, "tf", &[], &[]),
    part(Of::Time, ONE, 0, "s", &[], &["sec", "secs", "second", "seconds"]),
    part(Of::Time, ONE, -3, "ms", &[], &["msec", "msecs", "millisecond", "milliseconds"]),
    // The micro sign and the Greek letter look alike.
    part(Of::Time, ONE, -6, "\u{b5}s", &["\u{3bc}s", "us"], &["usec", "microsecond", "microseconds"]),
    part(Of::Time, [60.0, 1.0], 0, "min", &[], &["min", "mins", "minute", "minutes"]),
    part(Of::Time, [3600.0, 1.0], 0, "h", &[], &["hr", "hrs", "hour", "hours"]),
    part(Of::Length, ONE, 0, "m", &[], &["metre", "metres", "meter", "meters"]),
    part(Of::Length, ONE, -3, "mm", &[], &["millimetre", "millimetres", "millimeter", "millimeters"]),
    part(Of::Length, ONE, -2, "cm", &[], &["centimetre", "centimetres", "centimeter", "centimeters"]),
    part(Of::Length, ONE, 3, "km", &[], &["kilometre", "kilometres", "kilometer", "kilometers"]),
    part(Of::Length, [3048.0, 1.0], -4, "ft", &[], &["ft", "foot", "feet"]),
    part(Of::Length, [254.0, 1.0], -4, "in", &[], &["in", "inch", "inches"]),
    part(Of::Length, [1_609_344.0, 1.0], -3, "mi", &[], &["mi", "mile", "miles"]),
    part(Of::Speed, [44_704.0, 1.0], -5, "mph", &[], &["mph"]),
    part(Of::Speed, [1.0, 3600.0], 3, "km/h", &[], &["kmh", "kph", "kmph"]),
    part(Of::Slope, ONE, -2, "%", &[], &["%", "percent", "per cent", "pct"]),
    part(Of::Slope, ONE, -3, "\u{2030}", &[], &["permille", "per mille", "o/oo"]),
];

/// A piece of a form.
#[derive(Clone, Copy)]
enum Piece {
    /// A part of one of these kinds.
    Of(&'static [Of]),
    /// `*`, another sign of a product, or a blank.
    Times,
    /// `/` or `per`: what follows divides, and after a second one multiplies again, as in `N/(m/s)`.
    Over,
    /// `(`
    Open,
    /// `)`
    Close,
}

use Piece::{Close, Open, Over, Times};

const MASS: Piece = Piece::Of(&[Of::Mass]);
const FORCE: Piece = Piece::Of(&[Of::MetricForce, Of::PoundForce]);
const TIME: Piece = Piece::Of(&[Of::Time]);
const LENGTH: Piece = Piece::Of(&[Of::Length]);

/// How the units of a dimension are put together.
fn forms(dimension: Dimension) -> &'static [&'static [Piece]] {
    match dimension {
        Dimension::Mass => &[&[MASS]],
        Dimension::Force => &[&[FORCE], &[Piece::Of(&[Of::SmallForce])]],
        Dimension::Stiffness => &[&[FORCE, Over, LENGTH]],
        Dimension::Time => &[&[TIME]],
        Dimension::Length => &[&[LENGTH]],
        Dimension::Speed => &[&[Piece::Of(&[Of::Speed])], &[LENGTH, Over, TIME]],
        Dimension::Damping => &[
            &[FORCE, Times, TIME, Over, LENGTH],
            // "kNs/m", but not "lbs/in", which is a stiffness.
            &[Piece::Of(&[Of::MetricForce]), TIME, Over, LENGTH],
            &[FORCE, Over, Open, LENGTH, Over, TIME, Close],
        ],
        Dimension::Resistance => {
            &[&[FORCE, Over, MASS], &[Piece::Of(&[Of::PoundForce]), Over, Piece::Of(&[Of::UsTon])]]
        }
        Dimension::Grade => &[&[Piece::Of(&[Of::Slope])], &[LENGTH, Over, LENGTH]],
        Dimension::Share => &[&[Piece::Of(&[Of::Slope])]],
    }
}

/// Signs of a product.
const PRODUCT: [char; 7] = ['*', '\u{b7}', '\u{22c5}', '\u{2219}', '\u{2022}', '.', '-'];

impl Piece {
    /// What follows this piece, which is no part, in a text that starts with it.
    fn skip(self, text: &str) -> Option<&str> {
        let inner = text.trim_start();
        match self {
            Piece::Of(_) => None,
            Times if inner.starts_with(PRODUCT) => {
                Some(inner.trim_start_matches(|c: char| PRODUCT.contains(&c)).trim_start())
            }
            Times => (inner.len() < text.len()).then_some(inner),
            Over => {
                let per = inner.strip_prefix("per").filter(|rest| rest.starts_with(char::is_whitespace));
                inner.strip_prefix('/').or(per).map(str::trim_start)
            }
            Open => inner.strip_prefix('(').map(str::trim_start),
            Close => inner.strip_prefix(')'),
        }
    }

    /// The same as a regular expression.
    fn pattern(self) -> String {
        match self {
            Piece::Of(kinds) => {
                let spellings: Vec<String> = parts(kinds).flat_map(Part::patterns).collect();
                format!("({})", spellings.join("|"))
            }
            Times => format!("(\\s*[{}]+\\s*|\\s+)", PRODUCT.iter().map(|c| escaped(*c)).collect::<String>()),
            Over => "\\s*(/|per\\s)\\s*".to_owned(),
            Open => "\\s*\\(\\s*".to_owned(),
            Close => "\\s*\\)".to_owned(),
        }
    }
}

fn parts(kinds: &'static [Of]) -> impl Iterator<Item = &'static Part> {
    PARTS.iter().filter(|part| kinds.contains(&part.of))
}

impl Part {
    /// What follows the part in a text that starts with it, for each of its spellings that does.
    fn rests<'t>(&self, text: &'t str, any_case: bool) -> impl Iterator<Item = &'t str> {
        let symbols = std::iter::once(&self.symbol).chain(self.symbols).map(move |s| (*s, any_case));
        let words = self.words.iter().map(|w| (*w, true));
        symbols.chain(words).filter_map(move |(spelling, any_case)| {
            let (start, rest) = text.split_at_checked(spelling.len())?;
            (start == spelling || any_case && start.eq_ignore_ascii_case(spelling)).then_some(rest)
        })
    }

    fn patterns(&self) -> impl Iterator<Item = String> {
        let either_case = |c: char| format!("[{}{}]", c.to_ascii_uppercase(), c.to_ascii_lowercase());
        let any_case = move |c: char| if c.is_ascii_alphabetic() { either_case(c) } else { escaped(c) };
        let symbols = std::iter::once(&self.symbol).chain(self.symbols);
        let exact = symbols.filter(|s| !self.words.contains(s)).map(|s| s.chars().map(escaped).collect());
        exact.chain(self.words.iter().map(move |w| w.chars().map(any_case).collect()))
    }
}

/// A character as a regular expression has it, also within brackets.
fn escaped(c: char) -> String {
    if matches!(c, '*' | '.' | '-') { format!("\\{c}") } else { c.to_string() }
}

/// The unit in a text.
pub(super) struct Match {
    /// Empty unless letters may be of any case.
    pub symbol: String,
    pub scale: Scale,
}

/// The size of a unit of the dimension; `None` if the text is none.
pub(super) fn find(dimension: Dimension, text: &str) -> Option<Scale> {
    if let (Dimension::Grade, Some(run)) = (dimension, run_of_one(text)) {
        return Some(Scale { divisor: run, ..Scale::ONE });
    }
    all(dimension, text, false).into_iter().next().map(|found| found.scale)
}

/// The per cent, of a share or of a grade.
fn per_cent() -> impl Iterator<Item = &'static Part> {
    PARTS.iter().filter(|part| part.symbol == "%")
}

/// Whether a unit is the per cent.
pub(super) fn is_per_cent(text: &str) -> bool {
    per_cent().any(|part| part.rests(text, false).any(str::is_empty))
}

/// The same as a regular expression.
pub(super) fn per_cent_pattern() -> String {
    per_cent().flat_map(Part::patterns).collect::<Vec<_>>().join("|")
}

/// The units of the dimension that the text is but for the case of its letters, each once.
pub(super) fn in_any_case(dimension: Dimension, text: &str) -> Vec<String> {
    let mut symbols: Vec<String> = all(dimension, text, true).into_iter().map(|found| found.symbol).collect();
    symbols.dedup();
    symbols
}

fn all(dimension: Dimension, text: &str, any_case: bool) -> Vec<Match> {
    let mut found = Vec::new();
    for form in forms(dimension) {
        let nothing = Match { symbol: String::new(), scale: Scale::ONE };
        follow(form, text, any_case, (nothing, false), &mut found);
    }
    found
}

/// Adds what the text is if its rest follows these pieces; `divides` says whether the next part divides.
fn follow(pieces: &[Piece], text: &str, any_case: bool, (so_far, divides): (Match, bool), found: &mut Vec<Match>) {
    let Some((piece, later)) = pieces.split_first() else {
        if text.is_empty() {
            found.push(so_far);
        }
        return;
    };
    if let Piece::Of(kinds) = piece {
        for part in parts(kinds) {
            for rest in part.rests(text, any_case) {
                let scale = if divides { part.scale.inverse() } else { part.scale };
                let symbol = joined(&so_far.symbol, part.symbol, any_case);
                follow(later, rest, any_case, (Match { symbol, scale: so_far.scale.times(scale) }, divides), found);
            }
        }
    } else if let Some(rest) = piece.skip(text) {
        let sign = match piece {
            Times => "*",
            Over => "/",
            Open => "(",
            _ => ")",
        };
        let symbol = joined(&so_far.symbol, sign, any_case);
        let divides = divides ^ matches!(piece, Over);
        follow(later, rest, any_case, (Match { symbol, scale: so_far.scale }, divides), found);
    }
}

/// A symbol with more behind it, if symbols are asked for: building them takes longer than the search.
fn joined(symbol: &str, more: &str, asked: bool) -> String {
    if asked { format!("{symbol}{more}") } else { String::new() }
}

/// Of a grade written as a ratio, `1 in 100` or `1:100`, what follows the 1: the run.
fn run_of_one(text: &str) -> Option<f64> {
    let after_word = text.strip_prefix("in").filter(|rest| rest.starts_with(char::is_whitespace));
    let number = after_word.or_else(|| text.strip_prefix([':', '/']))?.trim_start();
    let plain = number.bytes().all(|b| b.is_ascii_digit() || b == b'.');
    number.parse().ok().filter(|run: &f64| plain && (1e-9..=1e9).contains(run))
}

/// A regular expression of all that may follow a number as its unit, so that nothing is refused that [`find`] takes.
pub(super) fn pattern(dimension: Dimension) -> String {
    let form = |form: &&[Piece]| form.iter().map(|piece| piece.pattern()).collect::<String>();
    let mut all: Vec<String> = forms(dimension).iter().map(form).collect();
    if dimension == Dimension::Grade {
        all.push("(in\\s|[:/])\\s*[0-9.]*[1-9][0-9.]*".to_owned());
    }
    all.join("|")
}

#[cfg(test)]
mod tests;
