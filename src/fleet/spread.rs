//! Values that an input can take: a list, or a distribution.

use statrs::function::erf::{erfc, erfc_inv};

use crate::units::{self, Amount, Dimension};

/// The largest probability that a distribution may have of impossible values, such as a strength below zero: a
/// millionth, 300 times less than the 95 % interval of ten thousand draws can show.
pub(crate) const LARGEST_IMPOSSIBLE: f64 = 1e-6;

/// Values of a list that are tried before the run.
const PROBES: usize = 20;

/// What a varied key ranges over.
#[derive(Clone, Debug)]
pub enum Spread {
    /// These values, all as likely in draws.
    Values(Vec<toml::Value>),
    /// A distribution, in SI units or as a share.
    Distribution {
        /// Which.
        law: Distribution,
        /// What it measures.
        dimension: Dimension,
        /// Its parameters are shares, and so are its draws.
        share: bool,
        /// A draw cannot be below zero.
        not_negative: bool,
    },
}

/// A distribution of one number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Distribution {
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

impl Distribution {
    /// The lognormal law whose own mean and standard deviation are these:
    ///
    /// ```text
    /// sigma^2 = ln(1 + (sd / mean)^2)      mu = ln(mean) - sigma^2 / 2
    /// ```
    pub fn lognormal(mean: f64, sd: f64) -> Distribution {
        let variance = (sd / mean).powi(2).ln_1p();
        Distribution::LogNormal { mu: mean.ln() - 0.5 * variance, sigma: variance.sqrt() }
    }

    /// Whether its limits are in order.
    pub(crate) fn is_ordered(&self) -> bool {
        match *self {
            Distribution::Uniform { low, high } => low < high,
            Distribution::Triangular { low, mode, high } => low <= mode && mode <= high && low < high,
            _ => true,
        }
    }

    /// The value that is not exceeded with probability `p`, 0 < p < 1.
    pub fn quantile(&self, p: f64) -> f64 {
        let normal = || -std::f64::consts::SQRT_2 * erfc_inv(2.0 * p);
        match *self {
            Distribution::Uniform { low, high } => low + (high - low) * p,
            Distribution::Normal { mean, sd } => mean + sd * normal(),
            Distribution::LogNormal { mu, sigma } => (mu + sigma * normal()).exp(),
            Distribution::Weibull { location, scale, shape } => location + scale * (-(-p).ln_1p()).powf(1.0 / shape),
            Distribution::Triangular { low, mode, high } => {
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

impl Distribution {
    /// The probability of a value below 0.
    pub(crate) fn below_zero(&self) -> f64 {
        match *self {
            Distribution::Uniform { low, high } => (-low / (high - low)).clamp(0.0, 1.0),
            Distribution::Normal { mean, sd } => 0.5 * erfc(mean / (sd * std::f64::consts::SQRT_2)),
            Distribution::LogNormal { .. } => 0.0,
            Distribution::Weibull { location, scale, shape } => {
                if location < 0.0 {
                    -(-(-location / scale).powf(shape)).exp_m1()
                } else {
                    0.0
                }
            }
            Distribution::Triangular { low, mode, high } => match (low < 0.0, mode < 0.0) {
                (false, _) => 0.0,
                (true, false) => low * low / ((high - low) * (mode - low)),
                (true, true) => 1.0 - high.max(0.0).powi(2) / ((high - low) * (high - mode)),
            },
        }
    }
}

impl Spread {
    /// The probability of a draw that its key cannot take; 0 for a list, whose values are looked at one by one.
    pub(crate) fn impossible(&self) -> f64 {
        match self {
            Spread::Distribution { law, not_negative: true, .. } => law.below_zero(),
            _ => 0.0,
        }
    }

    /// How many values there are in a list.
    pub fn count(&self) -> usize {
        match self {
            Spread::Values(list) => list.len(),
            Spread::Distribution { .. } => 1,
        }
    }

    /// The value at a place of 0 < p < 1 in the list or the distribution.
    pub fn at(&self, p: f64) -> toml::Value {
        match self {
            Spread::Values(list) => list[((p * list.len() as f64) as usize).min(list.len() - 1)].clone(),
            Spread::Distribution { law, dimension, share, .. } => {
                // Draws below zero, and as many above it, are all replaced by one possible value.
                let least = 2.0 * self.impossible();
                written(law.quantile(p.max(least)), *dimension, *share)
            }
        }
    }

    /// Values of the list or the distribution from end to end, and others near its middle, for a look at what the key changes.
    pub(crate) fn probes(&self, dimension: Option<Dimension>) -> Vec<toml::Value> {
        let mut probes = match self {
            Spread::Values(list) if list.len() > PROBES => {
                (0..PROBES).map(|i| list[i * (list.len() - 1) / (PROBES - 1)].clone()).collect()
            }
            Spread::Values(list) => list.clone(),
            Spread::Distribution { .. } => [0.001, 0.5, 0.999].map(|p| self.at(p)).to_vec(),
        };
        let Some(dimension) = dimension else { return probes };
        let middle = self.at(0.5);
        let parsed = middle.as_str().and_then(|text| units::parse(text, dimension, true).ok());
        let others = |x: f64| if x == 0.0 { [1.0, 2.0] } else { [0.9 * x, 1.1 * x] };
        match parsed {
            Some(Amount::Si(x)) => probes.extend(others(x).map(|x| written(x, dimension, false))),
            Some(Amount::Share(x)) => probes.extend(others(x).map(|x| written(x, dimension, true))),
            None => {}
        }
        probes
    }

    /// The unit that [`shown`] gives its values, where all have the same.
    pub fn unit(&self, dimension: Option<Dimension>) -> Option<&'static str> {
        match self {
            Spread::Distribution { share: true, .. } => Some("%"),
            Spread::Distribution { dimension, .. } => Some(dimension.si()),
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
