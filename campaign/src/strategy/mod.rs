//! What chooses the parameters of the next trial.

mod baseline;
mod bayes;
mod best;
mod beyond_box;
mod cma_es;
mod completion;
mod grey_box;
mod identification;
mod iterative_learning;
mod law_change;
mod law_check;
mod replay;
mod standing;

use std::fmt;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use tribo_bayesopt::{Allowed, BayesoptError, ExpectedGain};
use tribo_friction::identify::GlsError;

pub use bayes::observations;
pub use best::BestTrial;
pub use beyond_box::BeyondBox;
pub use grey_box::GreyBox;
pub(crate) use identification::basis_column;
pub use identification::{Identification, identification_samples};
pub use law_change::LawChange;
pub use law_check::LawCheck;
pub use standing::{Standing, standing_sentence};

pub use crate::strategy_name::StrategyName;
use tribo_trial::published_gaz;

use crate::ValidTune;
use tribo_model::FileError;
use tribo_trial::{AbortReason, Cost, EstimatorError, TrialLog};

/// A finished trial as strategies see it.
#[derive(Clone, Debug, PartialEq)]
pub struct FinishedTrial {
    /// Its number, from 0.
    pub number: usize,
    /// Its parameters.
    pub theta: Vec<f64>,
    /// Its cost.
    pub cost: Cost,
    /// Why it was stopped, if it was.
    pub aborted: Option<AbortReason>,
    /// Who chose its parameters.
    pub origin: Origin,
}

impl FinishedTrial {
    /// Whether it was stopped for what its compensator did.
    pub fn failed(&self) -> bool {
        self.aborted.is_some_and(|why| why != AbortReason::Stopped)
    }

    /// How many of the last trials were, one after the other.
    pub(crate) fn failed_in_a_row(finished: &[Self]) -> usize {
        finished.iter().rev().take_while(|trial| trial.failed()).count()
    }
}

/// Who chose a parameter vector.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Origin {
    /// A constant of the strategy.
    Constant,
    /// The initial design or a non-adaptive search.
    Design,
    /// Least squares on past logs.
    LeastSquares,
    /// The Gaussian process.
    Model,
    /// A step of iterative learning.
    Learning,
    /// Any of these, held back by the guard: it asked for more compensation than there is friction.
    Guard,
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Constant => "constant",
            Self::Design => "design",
            Self::LeastSquares => "least squares",
            Self::Model => "model",
            Self::Learning => "learning",
            Self::Guard => "guard",
        })
    }
}

/// A trial that has been handed out and has not come back.
#[derive(Clone, Debug, PartialEq)]
pub struct RunningTrial {
    /// Its number, from 0.
    pub number: usize,
    /// Its parameters.
    pub theta: Vec<f64>,
}

impl From<&FinishedTrial> for RunningTrial {
    /// A trial as it was before it ended.
    fn from(trial: &FinishedTrial) -> Self {
        Self { number: trial.number, theta: trial.theta.clone() }
    }
}

/// What is known before a trial is chosen: the trials before it, each kind by number, and what may be tried.
#[derive(Clone, Copy, Debug, Default)]
pub struct Past<'a> {
    /// Those that have ended.
    pub finished: &'a [FinishedTrial],
    /// Those that run elsewhere at this moment.
    pub running: &'a [RunningTrial],
    /// What the guard lets pass; none without a guard.
    pub allowed: Option<&'a dyn Allowed>,
}

/// A parameter vector to try, and who chose it.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// The parameters.
    pub theta: Vec<f64>,
    /// Who chose them.
    pub origin: Origin,
}

/// Why a strategy has no answer.
#[derive(Debug, thiserror::Error)]
pub enum StrategyError {
    /// The optimiser failed.
    #[error("optimiser: {0}")]
    Bayesopt(#[from] BayesoptError),
    /// Friction could not be identified.
    #[error("identification: {0}")]
    Identification(#[from] GlsError),
    /// The evolution strategy cannot begin.
    #[error("CMA-ES: {0}")]
    CmaEs(String),
    /// The campaign's estimator cannot be had.
    #[error(transparent)]
    Estimator(#[from] EstimatorError),
    /// The published constants are those of another robot.
    #[error("gaz holds the constants of one Panda, which has 7 joints")]
    NotAPanda,
    /// The log of a past trial could not be read.
    #[error(transparent)]
    File(#[from] FileError),
}

/// Where the logs of finished trials come from.
pub trait LogSource<const N: usize> {
    /// The log of a finished trial; none of one that still runs or left no log.
    fn log(&self, number: usize) -> Result<Option<TrialLog<N>>, FileError>;
}

/// Chooses parameters; a pure function of the settings, the trial's number and the trials before it, so that a killed
/// campaign goes on as if nothing had happened.
pub trait Strategy<const N: usize>: Send + Sync {
    /// The parameters of trial `number` where they depend on no other trial; such trials may run in parallel.
    fn design(&self, number: usize) -> Result<Option<Proposal>, StrategyError>;

    /// The parameters of trial `number`, from all that is known of the trials before it.
    fn propose(&self, number: usize, past: Past<'_>, logs: &dyn LogSource<N>) -> Result<Proposal, StrategyError>;

    /// Another friction law, if the last logs speak for it; none of a strategy that identifies no law.
    fn better_law(&self, past: Past<'_>, logs: &dyn LogSource<N>) -> Result<Option<LawChange>, StrategyError> {
        let _ = (past, logs);
        Ok(None)
    }

    /// The best of the finished trials by what their logs say; none of a strategy that looks at nothing but J ([`BestTrial::of`]).
    fn best(&self, past: Past<'_>, logs: &dyn LogSource<N>) -> Result<Option<BestTrial>, StrategyError> {
        let _ = (past, logs);
        Ok(None)
    }

    /// What the trial proposed after these promises; none where a design chooses it, or the strategy has no model of the cost.
    fn expected_gain(&self, past: Past<'_>, logs: &dyn LogSource<N>) -> Result<Option<ExpectedGain>, StrategyError> {
        let _ = (past, logs);
        Ok(None)
    }
}

impl StrategyName {
    /// Whether it says what the next trial promises.
    pub fn expects_gain(self) -> bool {
        matches!(self, Self::Paper | Self::Bo | Self::Composite | Self::GreyBox)
    }

    /// The strategy for these settings, with the identification of the same settings where it looks at logs.
    ///
    /// # Errors
    /// A strategy that has no answer for this robot.
    pub fn build<const N: usize>(
        self,
        tune: &ValidTune<N>,
        identification: &Arc<Identification<N>>,
    ) -> Result<Box<dyn Strategy<N>>, StrategyError> {
        let (space, seed) = (&tune.space, tune.config.seed);
        Ok(match self {
            Self::Zero => Box::new(baseline::Constant(space.zero())),
            Self::Gaz => {
                Box::new(baseline::Constant(space.theta(&published_gaz::<N>().ok_or(StrategyError::NotAPanda)?)))
            }
            Self::Random => Box::new(bayes::Search::random(tune)?),
            Self::Sobol => Box::new(bayes::Search::sobol(tune)?),
            Self::Paper => Box::new(bayes::Search::paper(tune)?),
            Self::Bo => Box::new(bayes::Search::bo(tune)?),
            Self::Composite => Box::new(bayes::Search::composite(tune)?),
            Self::CmaEs => Box::new(cma_es::CmaEs::new(space, seed)?),
            Self::IterativeLearning => Box::new(iterative_learning::IterativeLearning::new(space.clone())),
            Self::GreyBox => Box::new(GreyBox::new(tune, Arc::clone(identification))?),
        })
    }
}
