//! What the window shows.

use serde::{Deserialize, Serialize};

use crate::source::Needs;

/// The views.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum View {
    /// Cost, parameters and surrogate model over the trials.
    #[default]
    Campaign,
    /// One trial.
    Trial,
    /// The arm in motion.
    Arm,
    /// Channels and wrench of a log.
    Log,
    /// What the model gets wrong about the log.
    Diagnosis,
    /// Two campaigns side by side.
    Compare,
    /// A robot while it lives.
    Live,
}

impl View {
    /// All views, in the order of their tabs and keys.
    pub const ALL: [Self; 7] =
        [Self::Campaign, Self::Trial, Self::Arm, Self::Log, Self::Diagnosis, Self::Compare, Self::Live];

    /// Name on the tab.
    pub fn name(self) -> &'static str {
        match self {
            Self::Campaign => "Campaign",
            Self::Trial => "Trial",
            Self::Arm => "Arm",
            Self::Log => "Log",
            Self::Diagnosis => "Diagnosis",
            Self::Compare => "Compare",
            Self::Live => "Live",
        }
    }

    /// What has to be worked out for it.
    pub(crate) fn needs(self) -> Needs {
        Needs {
            surrogate: self == Self::Campaign,
            trial: matches!(self, Self::Trial | Self::Arm),
            uncompensated: self == Self::Trial,
        }
    }
}
