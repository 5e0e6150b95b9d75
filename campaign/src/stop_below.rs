//! When another trial is not worth its time.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use tribo_bayesopt::{LeastGain, StopRule};

use crate::strategy_name::StrategyName;

/// Expected gain of the next trial below which a campaign ends before its last trial; in files `never`, `repeatability` or a number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Written", into = "Written")]
pub enum StopBelow {
    /// All trials are run.
    Never,
    /// The standard deviation of J when the same parameters are tried again.
    Repeatability,
    /// This share of the best J, greater than 0 and at most 0.5.
    Share(f64),
}

impl StopBelow {
    /// What a campaign does that was told nothing: least squares ends when the friction is known as well as J can tell, and searches that
    /// know J alone run all their trials.
    pub fn default_of(strategy: StrategyName) -> Self {
        if strategy == StrategyName::GreyBox { Self::Repeatability } else { Self::Never }
    }

    /// The rule for a strategy; none of a campaign that runs all its trials. A Gaussian process may promise little by a whim, so that it
    /// must do so three times in a row; least squares promises what the last logs say.
    pub(crate) fn rule(self, strategy: StrategyName) -> Option<StopRule> {
        let consecutive = if strategy == StrategyName::GreyBox { 1 } else { 3 };
        let gain_below = match self {
            Self::Never => return None,
            Self::Repeatability => LeastGain::Repeatability,
            Self::Share(share) => LeastGain::Share(share),
        };
        Some(StopRule { gain_below, consecutive })
    }
}

/// As it stands in a file.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Written {
    Number(f64),
    Word(String),
}

const ALLOWED: &str = "never, repeatability, or a share of the best J greater than 0 and at most 0.5";

impl TryFrom<Written> for StopBelow {
    type Error = String;

    fn try_from(written: Written) -> Result<Self, String> {
        match written {
            Written::Number(share) if share > 0.0 && share <= 0.5 => Ok(Self::Share(share)),
            Written::Number(number) => Err(format!("stop_below is {number}; allowed: {ALLOWED}")),
            Written::Word(word) => word.parse(),
        }
    }
}

impl From<StopBelow> for Written {
    fn from(stop: StopBelow) -> Self {
        match stop {
            StopBelow::Share(share) => Self::Number(share),
            word => Self::Word(word.to_string()),
        }
    }
}

impl FromStr for StopBelow {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "never" => Ok(Self::Never),
            "repeatability" => Ok(Self::Repeatability),
            other => match other.parse() {
                Ok(number) => Written::Number(number).try_into(),
                Err(_) => Err(format!("stop_below is {other:?}; allowed: {ALLOWED}")),
            },
        }
    }
}

impl fmt::Display for StopBelow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Never => f.write_str("never"),
            Self::Repeatability => f.write_str("repeatability"),
            Self::Share(share) => write!(f, "{share}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back_and_nonsense_is_refused() {
        for stop in [StopBelow::Never, StopBelow::Repeatability, StopBelow::Share(0.01)] {
            let text = serde_json::to_string(&stop).unwrap();
            assert_eq!(serde_json::from_str::<StopBelow>(&text).unwrap(), stop);
            assert_eq!(stop.to_string().parse::<StopBelow>().unwrap(), stop);
        }
        for nonsense in ["0", "-1", "0.6", "nan", "always", ""] {
            let message = nonsense.parse::<StopBelow>().unwrap_err();
            assert!(message.contains("repeatability"), "{message}");
        }
    }
}
