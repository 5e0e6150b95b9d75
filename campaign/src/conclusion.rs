//! What the trials of a campaign amount to.

use serde::{Deserialize, Serialize};
use tribo_robot::JointNames;

use crate::chooser::Chooser;
use crate::strategy::{
    BestTrial, BeyondBox, FinishedTrial, LawCheck, LogSource, Standing, StrategyError, StrategyName, standing_sentence,
};
use crate::{TunedLaw, ValidTune};

/// The best trial so far, and whether the friction law explains the robot. What is known of the logs is worked out once, by whoever runs the
/// campaign, and stands in its journal for all who look at it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Conclusion {
    /// Trials that had finished.
    pub trials: usize,
    /// The best of them; none before a trial was seen to its end.
    pub best: Option<BestTrial>,
    /// What the first log that is long enough says of the friction law; none of a law that least squares does not know.
    pub law_check: Option<LawCheck>,
    /// Joints that stood still in the last logs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub standing: Vec<Standing>,
    /// Parameters of which the last logs speak for more than may be tried.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub beyond_box: Vec<BeyondBox>,
}

impl Conclusion {
    /// From the trials that have finished.
    ///
    /// # Errors
    /// A log that cannot be read; an optimiser without an answer.
    #[inline(never)]
    pub(crate) fn of<const N: usize>(
        tune: &ValidTune<N>,
        Chooser { strategy, identification, .. }: &Chooser<N>,
        finished: &[FinishedTrial],
        logs: &dyn LogSource<N>,
    ) -> Result<Self, StrategyError> {
        let next = finished.iter().map(|trial| trial.number + 1).max().unwrap_or(0);
        let best = BestTrial::of(tune, strategy.as_ref(), finished, logs)?;
        let known = Self { trials: finished.len(), best, ..Self::default() };
        if tune.space.law == TunedLaw::GazSigmoid || tune.config.strategy == StrategyName::Zero {
            return Ok(known);
        }
        let fit = identification.before(next, logs)?;
        Ok(Self {
            law_check: identification.law_check(next, logs)?,
            standing: identification.standing(next, logs)?,
            beyond_box: fit.map_or_else(Vec::new, |fit| BeyondBox::of(&tune.space, &fit)),
            ..known
        })
    }

    /// What there is to say of the arm beside the best trial: friction beyond the box, joints that stand, and a friction law that does not
    /// explain it.
    pub fn remarks(&self, names: &JointNames) -> Vec<String> {
        let beyond = self.beyond_box.iter().map(|beyond| beyond.sentence(names));
        let standing = (!self.standing.is_empty()).then(|| standing_sentence(&self.standing, names));
        let law = self.law_check.filter(|check| !check.passed()).map(|check| check.to_string());
        beyond.chain(standing).chain(law).collect()
    }

    /// The best trial, if this is about the trials that have finished by now; else the cheapest of these.
    pub fn best_of<'a>(
        recorded: Option<&Self>,
        finished: impl Iterator<Item = &'a FinishedTrial> + Clone,
    ) -> Option<BestTrial> {
        match recorded {
            Some(conclusion) if conclusion.trials == finished.clone().count() => conclusion.best,
            _ => BestTrial::least(finished),
        }
    }
}
