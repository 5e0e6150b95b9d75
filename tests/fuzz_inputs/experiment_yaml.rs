//! Settings of the reproduced experiments (`schema: tribo.reproduce/1`).

use serde::de::DeserializeOwned;
use tribo_experiments::reproduce::uhlmann2023::Uhlmann2023;
use tribo_experiments::reproduce::{Linderoth2013, PushedTool, Roveda2022, Simoni2017, Simoni2019};
use tribo_model::FieldError;

use super::document::{document, names_the_input};

/// Every experiment refuses what is not its own.
pub fn check(input: &[u8]) {
    as_settings(input, Roveda2022::validate);
    as_settings(input, Linderoth2013::validate);
    as_settings(input, Simoni2017::validate);
    as_settings(input, Simoni2019::validate);
    as_settings(input, Uhlmann2023::validate);
    as_settings(input, PushedTool::validate);
}

fn as_settings<C: DeserializeOwned>(input: &[u8], validate: impl Fn(&C) -> Result<(), FieldError>) {
    let Some(document) = document(input) else { return };
    match document.parse::<C>() {
        Ok(settings) => {
            if let Err(error) = validate(&settings) {
                names_the_input(&document.explain(error));
            }
        }
        Err(error) => names_the_input(&error),
    }
}
