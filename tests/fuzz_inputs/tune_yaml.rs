//! Settings of campaigns (`schema: tribo.tune/1`), simulated ones and those whose trials the user runs.

use tribo_campaign::{AnyTune, TuneConfig};
use tribo_model::{ConfigError, to_yaml};

use super::document::{document, names_the_input, written};

/// Settings are refused with their field, or are what `campaign.yaml` gives back.
pub fn check(input: &[u8]) {
    let Some(document) = document(input) else { return };
    let config = match document.parse::<TuneConfig>() {
        Ok(config) => config,
        Err(error) => return names_the_input(&error),
    };
    let resolved = match config.validate_any() {
        Ok(tune) => tune.config().clone(),
        Err(ConfigError::Field(error)) => return names_the_input(&document.explain(error)),
        // The files that settings name are not there; their errors name them.
        Err(ConfigError::File(_)) => return,
    };
    let text = to_yaml(&resolved).expect("settings can be written");
    let again: TuneConfig = written(&text).parse().expect("settings that were written are read");
    assert_eq!(again, resolved, "{text}");
    let valid: AnyTune = again.validate_any().expect("and are as valid");
    assert_eq!(*valid.config(), resolved);
}
