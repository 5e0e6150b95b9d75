//! A friction law that fits the robot better than the one asked for.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::TunedLaw;

/// The campaign goes on with another law: with it least squares on the last logs promises to lower J.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LawChange {
    /// The new law.
    pub law: TunedLaw,
    /// First trial with it.
    pub from_trial: usize,
    /// Expected J with the law before [N + Nm, or N of the robust cost].
    pub cost: f64,
    /// By how much the new law is expected to lower it [the same].
    pub expected_gain: f64,
}

impl fmt::Display for LawChange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let law = match self.law {
            TunedLaw::CoulombViscous => "Coulomb-viscous",
            TunedLaw::Stribeck => "Stribeck",
            TunedLaw::GazSigmoid => "sigmoid",
        };
        write!(
            f,
            "from trial {} on the friction law is {law}: it is expected to lower J from {:.2} to {:.2}",
            self.from_trial,
            self.cost,
            self.cost - self.expected_gain
        )
    }
}
