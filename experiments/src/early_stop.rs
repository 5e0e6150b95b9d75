//! The end of a campaign that has nothing left to gain.

use std::fmt;
use std::path::Path;

use serde::{Deserialize, Serialize};
use tribo_bayesopt::{LeastGain, StopRule};
use tribo_logs::write_atomic;

use crate::files::{FileError, YamlDocument, to_yaml};
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
}

/// Suggestions in a row that must promise too little.
const CONSECUTIVE: usize = 3;
const NAME: &str = "early_stop.yaml";

impl EarlyStop {
    /// Whether the campaign ends before trial `next`, once three trials in a row promise less than `stop_below` of the best J. A function of
    /// the trials before it, so that a resumed campaign ends where it would have ended.
    ///
    /// # Errors
    /// A strategy without an answer.
    pub(crate) fn before<const N: usize>(
        next: usize,
        stop_below: f64,
        strategy: &dyn Strategy<N>,
        trials: &[Option<FinishedTrial>],
        (limit, logs): (&FrictionLimit<N>, &dyn LogSource<N>),
    ) -> Result<Option<Self>, StrategyError> {
        let rule = StopRule { gain_below: LeastGain::Share(stop_below), consecutive: CONSECUTIVE };
        let finished: Vec<FinishedTrial> = trials[..next].iter().flatten().cloned().collect();
        let promise = |number: usize| {
            let allowed = limit.before(number, logs)?;
            let allowed = allowed.as_ref().map(Allowance::as_dyn);
            strategy.expected_gain(Past { finished: &finished[..number], running: &[], allowed }, logs)
        };
        let ended = rule.ends_before(next, promise)?;
        Ok(ended.map(|at| Self {
            trials: next,
            expected_gain: at.gain,
            least_gain: rule.least_gain(&at),
            repeatability: at.repeatability,
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

    /// Leaves it in the directory of its campaign.
    pub(crate) fn write(&self, campaign: &Path) -> Result<(), FileError> {
        let path = campaign.join(NAME);
        let text = to_yaml(self).map_err(FileError::io(&path))?;
        Ok(write_atomic(&path, |file| file.write_all(text.as_bytes()))?)
    }
}

impl fmt::Display for EarlyStop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { trials, expected_gain, least_gain, .. } = self;
        write!(
            f,
            "ended after {trials} trials: the next is expected to gain {expected_gain:.2e} of J, less than {least_gain:.2e}"
        )
    }
}
