//! From errors to exit codes.

use tribo_campaign::CampaignError;
use tribo_campaign::strategy::StrategyError;
use tribo_export::ExportError;
use tribo_fci::ConnectionError;
use tribo_files::LogError;
use tribo_model::{ConfigError, FileError};
use tribo_ros2::ListenError;

/// A failed quality check that was asked for with `--check`.
#[derive(Debug)]
pub struct CheckFailed(pub String);

impl std::fmt::Display for CheckFailed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "check failed: {}", self.0)
    }
}

impl std::error::Error for CheckFailed {}

/// Input that cannot be used, found by the command itself.
#[derive(Debug)]
pub struct BadInput(pub String);

impl std::fmt::Display for BadInput {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for BadInput {}

/// Somebody pressed Ctrl-C before there was a result; what is there, and how to go on.
#[derive(Debug)]
pub struct Stopped(pub String);

impl Stopped {
    /// Of a command that writes its files at its end.
    pub fn empty_handed() -> Self {
        Self("stopped; nothing is written".to_owned())
    }
}

impl std::fmt::Display for Stopped {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Stopped {}

/// 1 failed check, 2 bad input, 3 internal; 130 stopped, as shells have it.
pub fn exit_code(error: &anyhow::Error) -> u8 {
    if error.is::<Stopped>() {
        return 130;
    }
    if error.is::<CheckFailed>() {
        return 1;
    }
    if error.is::<ConnectionError>()
        || error.is::<BadInput>()
        || error.is::<FileError>()
        || error.is::<ConfigError>()
        || error.is::<LogError>()
        || error.is::<ListenError>()
    {
        return 2;
    }
    if let Some(error) = error.downcast_ref::<ExportError>() {
        return if matches!(error, ExportError::Serialise(_)) { 3 } else { 2 };
    }
    match error.downcast_ref::<CampaignError>() {
        Some(CampaignError::Config(_) | CampaignError::File(_)) => 2,
        Some(CampaignError::Strategy { source: StrategyError::File(_) | StrategyError::Identification(_), .. }) => 2,
        _ => 3,
    }
}

/// The error and its causes, each told once: the messages of our libraries quote their cause already.
pub fn describe(error: &anyhow::Error) -> String {
    error
        .chain()
        .skip(1)
        .map(ToString::to_string)
        .fold(error.to_string(), |text, cause| if text.contains(&cause) { text } else { format!("{text}: {cause}") })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cause_that_is_quoted_is_not_repeated() {
        let io = || std::io::Error::other("disk on fire");
        let quoting = anyhow::Error::from(FileError::io("a.yaml")(io()));
        assert_eq!(describe(&quoting), "a.yaml: disk on fire");
        let silent = anyhow::Error::from(io()).context("writing");
        assert_eq!(describe(&silent), "writing: disk on fire");
    }
}
