//! The reference costs of a campaign on disk.

use std::path::Path;

use serde::{Deserialize, Serialize};
use tribo_files::write_atomic;
use tribo_model::{FileError, YamlDocument, to_yaml};
use tribo_trial::AbortReason;

use crate::References;

/// Name of the file in a campaign's directory.
pub const NAME: &str = "references.yaml";
/// Schema name of reference costs.
const SCHEMA: &str = "tribo.references/1";

/// `references.yaml`: what the costs of a campaign are to be compared with, for whoever watches it; three simulated trials
/// that nobody has to run again while the campaign needs the computer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ReferencesFile {
    /// `tribo.references/1`.
    schema: String,
    /// J without compensation [N + Nm].
    uncompensated: f64,
    /// J with the true friction [N + Nm].
    oracle: f64,
    /// J of an arm without friction [N + Nm].
    frictionless: f64,
    /// Why the trial with the true friction was stopped, if it was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    oracle_failed: Option<AbortReason>,
}

impl References {
    /// The reference costs that a campaign has left in its directory. A missing or damaged file is as good as none: they
    /// follow from the settings.
    pub fn read(campaign: &Path) -> Option<Self> {
        Self::parse(&YamlDocument::read(&campaign.join(NAME)).ok()?)
    }

    /// The reference costs in a document.
    pub fn parse(document: &YamlDocument) -> Option<Self> {
        let file: ReferencesFile = document.parse().ok()?;
        let ReferencesFile { schema, uncompensated, oracle, frictionless, oracle_failed } = file;
        let usable = [uncompensated, oracle, frictionless].iter().all(|cost| cost.is_finite() && *cost >= 0.0);
        (schema == SCHEMA && usable).then_some(Self { uncompensated, oracle, frictionless, oracle_failed })
    }

    /// Leaves the reference costs in the directory of their campaign.
    pub(crate) fn write(&self, campaign: &Path) -> Result<(), FileError> {
        let path = campaign.join(NAME);
        let Self { uncompensated, oracle, frictionless, oracle_failed } = *self;
        let file = ReferencesFile { schema: SCHEMA.to_owned(), uncompensated, oracle, frictionless, oracle_failed };
        let text = to_yaml(&file).map_err(FileError::io(&path))?;
        Ok(write_atomic(&path, |file| file.write_all(text.as_bytes()))?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comes_back_to_the_last_bit_and_is_not_believed_when_damaged() {
        let dir = tempfile::tempdir().unwrap();
        assert_eq!(References::read(dir.path()), None);
        let mut known =
            References { uncompensated: 24.2 / 3.0, oracle: 0.1 + 0.2, frictionless: 1e-17, oracle_failed: None };
        for failed in [Some(AbortReason::Oscillation), None] {
            known.oracle_failed = failed;
            known.write(dir.path()).unwrap();
            assert_eq!(References::read(dir.path()), Some(known));
        }
        let path = dir.path().join(NAME);
        let text = std::fs::read_to_string(&path).unwrap();
        for damage in ["references/1", "0.30000000000000004", "oracle"] {
            assert!(text.contains(damage), "{text}");
            std::fs::write(&path, text.replace(damage, "-7")).unwrap();
            assert_eq!(References::read(dir.path()), None, "{damage}");
        }
    }
}
