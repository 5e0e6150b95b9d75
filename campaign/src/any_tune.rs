//! What can be done with a campaign of any robot.

use tribo_robot::JointNames;
use tribo_trial::EstimatorError;

use crate::{AnyTune, ParameterSpace, References, TuneConfig, TunedLaw, references};

impl AnyTune {
    /// The settings.
    pub fn config(&self) -> &TuneConfig {
        match self {
            Self::Six(tune) => &tune.config,
            Self::Seven(tune) => &tune.config,
        }
    }

    /// The parameters that are tuned.
    pub fn space(&self) -> &ParameterSpace {
        match self {
            Self::Six(tune) => &tune.space,
            Self::Seven(tune) => &tune.space,
        }
    }

    /// Name of the arm.
    pub fn robot(&self) -> &str {
        match self {
            Self::Six(tune) => &tune.trial.model.name,
            Self::Seven(tune) => &tune.trial.model.name,
        }
    }

    /// Names of the arm's joints.
    pub fn joint_names(&self) -> &JointNames {
        match self {
            Self::Six(tune) => &tune.trial.model.joint_names,
            Self::Seven(tune) => &tune.trial.model.joint_names,
        }
    }

    /// [`references`].
    ///
    /// # Errors
    /// Those of the estimator.
    pub fn references(&self) -> Result<References, EstimatorError> {
        match self {
            Self::Six(tune) => references(tune),
            Self::Seven(tune) => references(tune),
        }
    }

    /// [`ValidTune::true_parameters`](crate::ValidTune::true_parameters).
    pub fn true_parameters(&self) -> Option<Vec<f64>> {
        match self {
            Self::Six(tune) => tune.true_parameters(),
            Self::Seven(tune) => tune.true_parameters(),
        }
    }

    /// Goes over to another friction law.
    pub fn change_law(&mut self, law: TunedLaw) {
        match self {
            Self::Six(tune) => tune.change_law(law),
            Self::Seven(tune) => tune.change_law(law),
        }
    }

    /// Gives the campaign another number of trials.
    pub fn set_trials(&mut self, trials: usize) {
        match self {
            Self::Six(tune) => tune.config.trials = trials,
            Self::Seven(tune) => tune.config.trials = trials,
        }
    }
}
