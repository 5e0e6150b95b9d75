//! `tribo estimate`.

use crate::arguments::{Common, Estimate};

/// Runs the estimators over a log.
pub fn run(arguments: &Estimate, common: &Common) -> anyhow::Result<()> {
    let _ = (arguments, common);
    Ok(())
}
