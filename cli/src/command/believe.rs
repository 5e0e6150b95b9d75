//! Whether a log is believed.

use std::path::Path;

use tribo_logs::recognise::{Remark, Use};

use crate::failure::BadInput;

/// Refuses a log that cannot be right for what it is wanted for, with every reason; what only may be wrong goes to standard error.
///
/// # Errors
/// [`BadInput`], one line per reason.
pub fn believe(path: &Path, remarks: &[Remark], wanted: Use, quiet: bool) -> anyhow::Result<()> {
    let name = path.display();
    let refused: Vec<String> = remarks
        .iter()
        .filter(|remark| remark.refuses(wanted))
        .map(|remark| format!("{name}: {}: {remark}", remark.fault.name()))
        .collect();
    if !refused.is_empty() {
        return Err(BadInput(refused.join("\n")).into());
    }
    for remark in remarks.iter().filter(|remark| remark.concerns(wanted) && !quiet) {
        eprintln!("tribo: {name}: {remark}");
    }
    Ok(())
}
