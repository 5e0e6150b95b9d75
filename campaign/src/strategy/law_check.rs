//! Whether the friction law is the right kind of law for this robot.

use std::fmt;

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use tribo_friction::identify::{GlsError, GlsSample, GlsSettings, unexplained_on_held_out};

/// What the best parameters of a law leave of the wrench in free motion, on parts of a log that they were not fitted to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LawCheck {
    /// Part of the friction's wrench, weighted, that stays unexplained [-]; see [`unexplained_on_held_out`].
    pub unexplained: f64,
}

impl fmt::Display for LawCheck {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = 100.0 * self.unexplained;
        write!(
            f,
            "the friction law leaves {percent:.0} % of the wrench unexplained on parts of the first log that it was not fitted to"
        )?;
        f.write_str(if self.passed() { "" } else { ": something else is at work in this robot" })
    }
}

impl LawCheck {
    /// Unexplained part above which something else than this law must be at work.
    pub const LIMIT: f64 = 0.03;

    /// The check on the samples of one trial.
    ///
    /// # Errors
    /// Samples that the fit could not use either.
    pub fn of<const N: usize>(samples: &[GlsSample<N>], settings: &GlsSettings<N>) -> Result<Self, GlsError> {
        Ok(Self { unexplained: unexplained_on_held_out(samples, settings)? })
    }

    /// `{unexplained, passed}`.
    pub fn summary(self) -> Value {
        json!({"unexplained": self.unexplained, "passed": self.passed()})
    }

    /// Whether the law explains the log.
    pub fn passed(&self) -> bool {
        self.unexplained <= Self::LIMIT
    }
}
