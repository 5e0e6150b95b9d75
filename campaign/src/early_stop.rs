//! The end of a campaign that has nothing left to gain.

use std::fmt;
use std::path::Path;

use serde::{Deserialize, Serialize};
use tribo_bayesopt::StopRule;
use tribo_files::write_atomic;
use tribo_model::{FileError, YamlDocument, to_yaml};

use crate::friction_limit::{Allowance, FrictionLimit};
use crate::strategy::{FinishedTrial, LogSource, Past, Strategy, StrategyError};

/// Why a campaign ended before its last trial: `early_stop.yaml` in its directory.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EarlyStop {
    /// Trials that were run.
    pub trials: usize,
    /// Expected improvement of J by the next trial [N + Nm].
    pub expected_gain: f64,
    /// Below this the campaign ends [N + Nm].
    pub least_gain: f64,
    /// Deviation of J that the model takes for noise [N + Nm].
    pub repeatability: f64,
    /// The last trials, if these were stopped one after the other for what their compensators did.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub stopped_in_a_row: usize,
}

fn is_zero(number: &usize) -> bool {
    *number == 0
}

const NAME: &str = "early_stop.yaml";

impl EarlyStop {
    /// Whether the campaign ends before trial `next`, by this rule. A function of the trials before it, so that a resumed campaign ends
    /// where it would have ended.
    ///
    /// # Errors
    /// A strategy without an answer.
    pub(crate) fn before<const N: usize>(
        next: usize,
        rule: &StopRule,
        strategy: &dyn Strategy<N>,
        finished: &[FinishedTrial],
        (limit, logs): (&FrictionLimit<N>, &dyn LogSource<N>),
    ) -> Result<Option<Self>, StrategyError> {
        let promise = |number: usize| {
            let allowed = limit.before(number, logs)?;
            let allowed = allowed.as_ref().map(Allowance::as_dyn);
            let before: Vec<FinishedTrial> = finished.iter().filter(|trial| trial.number < number).cloned().collect();
            strategy.expected_gain(Past { finished: &before, running: &[], allowed }, logs)
        };
        let ended = rule.ends_before(next, promise)?;
        Ok(ended.map(|at| Self {
            trials: finished.len(),
            expected_gain: at.gain,
            least_gain: rule.least_gain(&at),
            repeatability: at.repeatability,
            stopped_in_a_row: FinishedTrial::failed_in_a_row(finished),
        }))
    }

    /// What the campaign of a directory has left; a missing or damaged file is as good as none, and tells of a campaign that goes on.
    pub fn read(campaign: &Path) -> Option<Self> {
        Self::parse(&YamlDocument::read(&campaign.join(NAME)).ok()?)
    }

    /// What a file of this kind says; none where it is damaged: not of this form, no trial, or a gain that is no number of at least 0.
    pub fn parse(document: &YamlDocument) -> Option<Self> {
        let stop: Self = document.parse().ok()?;
        let sizes = [stop.expected_gain, stop.least_gain, stop.repeatability];
        (stop.trials > 0 && sizes.iter().all(|size| size.is_finite() && *size >= 0.0)).then_some(stop)
    }

    /// Leaves it in the directory of its campaign, or nothing where the campaign goes on.
    pub(crate) fn leave(stop: Option<&Self>, campaign: &Path) -> Result<(), FileError> {
        let path = campaign.join(NAME);
        match (stop, std::fs::remove_file(&path)) {
            (Some(stop), _) => stop.write(campaign),
            (None, Err(error)) if error.kind() != std::io::ErrorKind::NotFound => Err(FileError::io(&path)(error)),
            (None, _) => Ok(()),
        }
    }

    /// Leaves it in the directory of its campaign.
    pub(crate) fn write(&self, campaign: &Path) -> Result<(), FileError> {
        let path = campaign.join(NAME);
        let text = to_yaml(self).map_err(FileError::io(&path))?;
        Ok(write_atomic(&path, |file| file.write_all(text.as_bytes()))?)
    }
}

impl fmt::Display for EarlyStop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { trials, expected_gain, least_gain, stopped_in_a_row, .. } = self;
        if *stopped_in_a_row > 1 && *expected_gain == 0.0 {
            return write!(
                f,
                "the last {stopped_in_a_row} of {trials} trials were stopped for what their compensators did"
            );
        }
        write!(
            f,
            "after {trials} trials another is expected to gain {} of J, less than {}",
            short(*expected_gain),
            short(*least_gain)
        )
    }
}

/// Two significant digits, whole numbers at least.
fn short(value: f64) -> String {
    if value == 0.0 {
        return "nothing".to_owned();
    }
    let decimals = (1.0 - value.abs().log10().floor()).clamp(0.0, 12.0) as usize;
    format!("{value:.decimals$}")
}
