//! Values that an input can take: a list, or a distribution.

use statrs::function::erf::{erfc, erfc_inv};

use crate::units::{self, Amount, Dimension};

/// What a varied key ranges over.
#[derive(Clone, Debug)]
pub enum Spread {
    /// These values, all as likely in draws.
    Values(Vec<toml::Value>),
    /// A distribution, in SI units or as a share.
    Law {
        /// Which.
        law: Law,
        /// What it measures.
        dimension: Dimension,
        /// Its parameters are shares, and so are its draws.
        share: bool,
    },
}

/// A distribution of one number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// All between two limits as likely.
    Uniform {
        /// Lower limit.
        low: f64,
        /// Upper limit.
        high: f64,
    },
    /// Gauss's.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation.
        sd: f64,
    },
    /// Its logarithm is normal.
    LogNormal {
        /// Mean of the logarithm.
        mu: f64,
        /// Standard deviation of the logarithm.
        sigma: f64,
    },
    /// `P(X <= x) = 1 - exp(-((x - location) / scale)^shape)`.
    Weibull {
        /// Smallest value.
        location: f64,
        /// Scale.
        scale: f64,
        /// Weibull modulus.
        shape: f64,
    },
    /// A density that rises from `low` to `mode` and falls to `high` on straight lines.
    Triangular {
        /// Lower limit.
        low: f64,
        /// Likeliest value.
        mode: f64,
        /// Upper limit.
        high: f64,
    },
}

impl Law {
    /// The lognormal law whose own mean and standard deviation are these:
    ///
    /// ```text
    /// sigma^2 = ln(1 + (sd / mean)^2)      mu = ln(mean) - sigma^2 / 2
    /// ```
    pub fn lognormal(mean: f64, sd: f64) -> Law {
        let variance = (sd / mean).powi(2).ln_1p();
        Law::LogNormal { mu: mean.ln() - 0.5 * variance, sigma: variance.sqrt() }
    }

    /// Whether its limits are in order.
    pub fn is_ordered(&self) -> bool {
        match *self {
            Law::Uniform { low, high } => low < high,
            Law::Triangular { low, mode, high } => low <= mode && mode <= high && low < high,
            _ => true,
        }
    }

    /// The probability of a value of 0 or below.
    pub fn not_positive(&self) -> f64 {
        match *self {
            Law::Uniform { low, high } => (-low / (high - low)).clamp(0.0, 1.0),
            Law::Normal { mean, sd } => 0.5 * erfc(mean / sd * std::f64::consts::FRAC_1_SQRT_2),
            Law::LogNormal { .. } => 0.0,
            Law::Weibull { location, .. } if location >= 0.0 => 0.0,
            Law::Weibull { location, scale, shape } => -(-(-location / scale).powf(shape)).exp_m1(),
            Law::Triangular { low, .. } if low >= 0.0 => 0.0,
            Law::Triangular { high, .. } if high <= 0.0 => 1.0,
            Law::Triangular { low, mode, high } if mode >= 0.0 => low * low / ((high - low) * (mode - low)),
            Law::Triangular { low, mode, high } => 1.0 - high * high / ((high - low) * (high - mode)),
        }
    }

    /// The value that is not exceeded with probability `p`, 0 < p < 1.
    pub fn quantile(&self, p: f64) -> f64 {
        let normal = || -std::f64::consts::SQRT_2 * erfc_inv(2.0 * p);
        match *self {
            Law::Uniform { low, high } => low + (high - low) * p,
            Law::Normal { mean, sd } => mean + sd * normal(),
            Law::LogNormal { mu, sigma } => (mu + sigma * normal()).exp(),
            Law::Weibull { location, scale, shape } => location + scale * (-(-p).ln_1p()).powf(1.0 / shape),
            Law::Triangular { low, mode, high } => {
                let rising = (mode - low) / (high - low);
                if p < rising {
                    low + (p * (high - low) * (mode - low)).sqrt()
                } else {
                    high - ((1.0 - p) * (high - low) * (high - mode)).sqrt()
                }
            }
        }
    }
}

impl Spread {
    /// How many values there are in a list.
    pub fn count(&self) -> usize {
        match self {
            Spread::Values(list) => list.len(),
            Spread::Law { .. } => 1,
        }
    }

    /// The value at a place of 0 < p < 1 in the list or the distribution.
    pub fn at(&self, p: f64) -> toml::Value {
        match self {
            Spread::Values(list) => list[((p * list.len() as f64) as usize).min(list.len() - 1)].clone(),
            Spread::Law { law, dimension, share } => written(law.quantile(p), *dimension, *share),
        }
    }

    /// The unit that [`shown`] gives its values, where all have the same.
    pub fn unit(&self, dimension: Option<Dimension>) -> Option<&'static str> {
        match self {
            Spread::Law { share: true, .. } => Some("%"),
            Spread::Law { dimension, .. } => Some(dimension.si()),
            Spread::Values(list) => {
                let dimension = dimension?;
                let unit = |v: &toml::Value| match units::parse(v.as_str()?, dimension, true).ok()? {
                    Amount::Si(_) => Some(dimension.si()),
                    Amount::Share(_) => Some("%"),
                };
                let first = unit(list.first()?)?;
                list.iter().all(|v| unit(v) == Some(first)).then_some(first)
            }
        }
    }
}

/// A value in SI units, or a share, as a train file has it.
pub fn written(value: f64, dimension: Dimension, share: bool) -> toml::Value {
    let in_its_unit = |value: f64| format!("{:e} {}", value / dimension.si_size(), dimension.si());
    toml::Value::String(if share { format!("{:e} %", 100.0 * value) } else { in_its_unit(value) })
}

/// A value as a number in the units of the tables or in per cent, where it is one.
pub fn number(value: &toml::Value, dimension: Option<Dimension>) -> Option<f64> {
    match (value, dimension) {
        (toml::Value::Integer(n), _) => Some(*n as f64),
        (toml::Value::Float(x), _) => Some(*x),
        (toml::Value::String(text), Some(dimension)) => match units::parse(text, dimension, true).ok()? {
            Amount::Si(value) => Some(value / dimension.si_size()),
            Amount::Share(share) => Some(100.0 * share),
        },
        _ => None,
    }
}

/// A value as a cell of a table shows it.
pub fn shown(value: &toml::Value, dimension: Option<Dimension>) -> String {
    match (number(value, dimension), value) {
        (Some(number), toml::Value::Integer(_)) => format!("{number}"),
        (Some(number), _) => format!("{number:?}"),
        (None, toml::Value::String(text)) => text.clone(),
        (None, other) => other.to_string(),
    }
}
