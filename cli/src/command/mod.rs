//! One file per command.

pub mod convert;
pub mod estimate;
pub mod export;
pub mod reproduce;
pub mod shell;
pub mod simulate;
pub mod tune;

use std::path::Path;

use serde::de::DeserializeOwned;
use tribo_experiments::files::YamlDocument;
use tribo_experiments::{ConfigError, TuneConfig, ValidTune};

use crate::arguments::Scenario;

/// The value of an option whose spelling clap has checked.
fn named<T: DeserializeOwned>(name: &str) -> anyhow::Result<T> {
    Ok(serde_json::from_value(serde_json::Value::String(name.to_owned()))?)
}

/// Puts an option's value, if given, over a field.
fn set<T: DeserializeOwned>(field: &mut T, name: Option<&String>) -> anyhow::Result<()> {
    if let Some(name) = name {
        *field = named(name)?;
    }
    Ok(())
}

impl Scenario {
    /// Puts the flags that were given over the settings.
    fn apply(&self, config: &mut TuneConfig) -> anyhow::Result<()> {
        set(&mut config.truth, self.truth.as_ref())?;
        set(&mut config.velocity, self.velocity.as_ref())?;
        config.seed = self.seed.unwrap_or(config.seed);
        config.pose = self.pose.map_or(config.pose, usize::from);
        Ok(())
    }
}

/// Settings from a file (or the defaults), changed by `overrides`, validated; errors name the file where it is to blame.
fn configured(
    path: Option<&Path>,
    overrides: impl FnOnce(&mut TuneConfig) -> anyhow::Result<()>,
) -> anyhow::Result<ValidTune> {
    let document = path.map(YamlDocument::read).transpose()?;
    let mut config = document.as_ref().map(YamlDocument::parse::<TuneConfig>).transpose()?.unwrap_or_default();
    overrides(&mut config)?;
    let valid = config.validate().map_err(|error| match (error, &document) {
        (ConfigError::Field(field), Some(document)) if document.line_of(&field.field).is_some() => {
            ConfigError::File(document.explain(field))
        }
        (error, _) => error,
    })?;
    Ok(valid)
}
