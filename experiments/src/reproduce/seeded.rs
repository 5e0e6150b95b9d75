//! Experiments that are a list of numbers per seed.

use serde::de::DeserializeOwned;

use super::{ExperimentError, Linderoth2013, Quantity, SeedRun, Simoni2017, Simoni2019};
use tribo_model::FieldError;

/// An experiment with settings of `schema: tribo.reproduce/1` that measures the same quantities for every seed.
pub trait SeededExperiment: DeserializeOwned + Sync {
    /// Checks every field.
    ///
    /// # Errors
    /// The first field outside its range.
    fn validate(&self) -> Result<(), FieldError>;

    /// Number of seeds, from 1.
    fn seeds(&mut self) -> &mut u64;

    /// What is measured.
    fn quantities(&self) -> Vec<Quantity>;

    /// Measures it for one seed: same seed, same bits.
    ///
    /// # Errors
    /// Where an identification fails.
    fn measure(&self, seed: u64) -> Result<SeedRun, ExperimentError>;
}

macro_rules! seeded {
    ($experiment:ty) => {
        impl SeededExperiment for $experiment {
            fn validate(&self) -> Result<(), FieldError> {
                self.validate()
            }

            fn seeds(&mut self) -> &mut u64 {
                &mut self.seeds
            }

            fn quantities(&self) -> Vec<Quantity> {
                self.quantities()
            }

            fn measure(&self, seed: u64) -> Result<SeedRun, ExperimentError> {
                self.run(seed).map(|measured| measured.0)
            }
        }
    };
}

seeded!(Linderoth2013);
seeded!(Simoni2017);
seeded!(Simoni2019);
