//! Parts of the `expected.json` that `tribo reproduce --check` compares with.

use serde::de::DeserializeOwned;
use tribo_experiments::reproduce::uhlmann2023::{VariantResult, VariantSummary};
use tribo_experiments::reproduce::{CellResult, PushRow, QuantitySummary, RowSummary, SeedRun};

/// Every part refuses what is not its own.
pub fn check(input: &[u8]) {
    fn part<T: DeserializeOwned>(input: &[u8]) {
        if let Err(error) = serde_json::from_slice::<T>(input) {
            assert!(error.line() > 0 || error.is_eof() || error.is_data(), "{error}");
        }
    }
    part::<CellResult>(input);
    part::<RowSummary>(input);
    part::<SeedRun>(input);
    part::<QuantitySummary>(input);
    part::<PushRow>(input);
    part::<VariantResult>(input);
    part::<VariantSummary>(input);
}
