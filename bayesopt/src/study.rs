//! Ask and tell.

use serde::{Deserialize, Serialize};

use crate::suggest::{Suggestion, suggest};
use crate::{BayesoptError, Domain, History, Outcome, Settings};

/// `ask → x_n`, `tell(n, y_n)`: a history with the arguments of [`suggest`] beside it. Nothing else is stored,
/// so a study rebuilt by [`Study::resume`] asks the same bits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Study {
    settings: Settings,
    domain: Domain,
    history: History,
    seed: u64,
}

impl Study {
    /// A study without trials.
    ///
    /// # Errors
    /// A setting out of range.
    pub fn new(settings: Settings, domain: Domain, seed: u64) -> Result<Self, BayesoptError> {
        Self::resume(settings, domain, seed, History::new())
    }

    /// A study with the trials of a journal.
    ///
    /// # Errors
    /// A setting out of range, a trial that does not fit the domain.
    pub fn resume(settings: Settings, domain: Domain, seed: u64, history: History) -> Result<Self, BayesoptError> {
        settings.validate(&domain)?;
        for trial in &history.trials {
            domain.to_unit(&trial.point)?;
        }
        Ok(Self { settings, domain, history, seed })
    }

    /// The next trial, entered as pending. Asking again before telling gives a further trial.
    ///
    /// # Errors
    /// Those of [`suggest`].
    pub fn ask(&mut self) -> Result<Suggestion, BayesoptError> {
        let suggestion = suggest(&self.settings, &self.domain, &self.history, self.seed)?;
        self.history.push(suggestion.point.clone(), Outcome::Pending);
        Ok(suggestion)
    }

    /// The outcome of a pending trial.
    ///
    /// # Errors
    /// `NotPending` for a trial never asked for, or told before.
    pub fn tell(&mut self, trial: usize, outcome: Outcome) -> Result<(), BayesoptError> {
        match self.history.trials.get_mut(trial) {
            Some(entry) if entry.outcome.is_pending() => {
                entry.outcome = outcome;
                Ok(())
            }
            _ => Err(BayesoptError::NotPending { trial }),
        }
    }

    /// All trials so far.
    pub fn history(&self) -> &History {
        &self.history
    }

    /// The box that is searched.
    pub fn domain(&self) -> &Domain {
        &self.domain
    }

    /// What kind of search this is.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Best trial that did not fail, with its cost.
    pub fn incumbent(&self) -> Option<(usize, f64)> {
        self.history.incumbent()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_pending_trials_can_be_told() {
        let mut study = Study::new(Settings::sobol(), Domain::unit_cube(2).unwrap(), 1).unwrap();
        assert_eq!(study.tell(0, Outcome::Value(1.0)), Err(BayesoptError::NotPending { trial: 0 }));
        let first = study.ask().unwrap();
        let second = study.ask().unwrap();
        assert_ne!(first.point, second.point);
        study.tell(second.trial, Outcome::Value(2.0)).unwrap();
        assert_eq!(study.incumbent(), Some((1, 2.0)));
        assert_eq!(study.tell(1, Outcome::Value(1.0)), Err(BayesoptError::NotPending { trial: 1 }));
    }
}
